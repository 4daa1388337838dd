/* An implicit acoustic step of dense gas: a bed, which is any set of equal boxes of a lattice.
 *
 * Near packing sound is 100 to 10,000 times as fast as the flow. So in a bed the step is split into acoustics and
 * transport (Lagrange-projection: Chalons, Kestener, Kokh & Stauffert, Commun. Comput. Phys. 20, 188, 2016; here the
 * acoustics is nonlinear). With lambda = dt/h, tau = 1/rho and f a face between L and R with the normal n:
 *
 * 1. Acoustics, implicit in the pressures p of the cells:
 *        U_f   = (rho_L u_L + rho_R u_R)/(rho_L + rho_R) + dt g_n - dt (p_R - p_L)/(rho_f h),  rho_f = (rho_L +
 * rho_R)/2 tau   = tau^n L,  L = 1 + lambda sum_f U_f     (outwards) eps   = eps^n - p (tau - tau^n) with p = p(tau,
 * eps). For given p the latter two and p = Gamma eps/tau (Gamma: Grueneisen coefficient) say tau (1 + 1/Gamma(1/tau)) =
 * tau^n + eps^n/p                                                              (*) which has one root tau(p) for any p
 * > 0, with tau > tau of packing, as Gamma diverges there, and eps = p tau/Gamma > 0. It remains to find p with rho^n
 * tau(p) - 1 - lambda sum_f U_f(p) = 0, whose Jacobian is a symmetric M-matrix, as tau' < 0: Newton's method
 * (bed_pressure.c).
 * 2. Velocity and energy, conservative, by the face pressures p_f = (rho_R p_L + rho_L p_R)/(rho_L + rho_R) + q_f,
 * which give exactly 0 where all U_f = 0 (bed_update.c). Gas at rest under gravity, p_R - p_L = (rho_L + rho_R) g h/2,
 * has U_f = 0 and stays at rest to round-off. q_f = -z [u]/2 damps velocities of cells that their faces do not see.
 * 3. Remap: what U_f carries goes to the neighbour, with limited slopes (bed_remap.c).
 *
 * Theorem. If the step succeeds, 0 < rho < rho of packing and eps > 0 in all cells that have no kept face. Proof: after
 * 2 the density is rho^n/L = 1/tau(p) to the tolerance of Newton's method, and checked; eps is kept above (1 - b) times
 * that of (*). In 3 a cell's new state, of density, momentum and energy, is
 *     (1 - lambda sum_in |U_f|) B + lambda sum_in |U_f| (state of the face, upwind),
 * where B = [L V - lambda sum_out U_f V_f]/(1 - lambda sum_in |U_f|) is what stays behind, V is the cell's state after
 * 2 and V_f its face values. If lambda sum_in |U_f| < 1 this is a convex combination. Face values with limited
 * slopes lie between those of two cells, component by component of (rho, u, eps), so they are admissible; B is V if the
 * slopes are 0, and the slopes of a cell are set to 0 where its B is not admissible. The step fails, and must be done
 * with a shorter dt, if more than MOST_OUT of a cell is carried in or out, or a cell is lifted by more energy than it
 * and its neighbours had. Cells with kept faces are lifted where they would have no energy left; their densities are
 * checked by the caller. */
#ifndef LIBCORE_BED_H
#define LIBCORE_BED_H

#include "libcore/acoustics/acoustics.h"
#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"
#include "mesh/base/comm.h"

enum bed_kind {
    BED_INNER, /* between two cells of the bed */
    BED_WALL,  /* no gas passes */
    BED_KEPT,  /* towards a cell beside the bed: the flux is given (kept) */
    BED_HELD,  /* towards an open patch whose gas (outside) has a given pressure */
    BED_FREE   /* towards an open patch with the cell's own pressure */
};

struct bed_lines; /* the work memory */
struct multigrid;
struct bed {
    /* Set once, before bed_make: */
    const struct eos *eos;
    const struct material *material;
    const struct comm *comm;
    struct acoustics_params params;
    int dim;
    double width[MAX_DIM]; /* m, along the axes */
    double limit;          /* kg/m^3: densities stay below it */
    /* Copies lines of this rank's cells to the ghosts of the same lines; collective. NULL: there is one rank. */
    void (*fill)(void *context, int n, double *const *line);
    void *context;

    /* The cells of this rank, block by block (tile by tile), then ghosts: cells of other ranks. Set by the caller after
     * bed_size whenever the set changes. */
    int blocks, cells, ghosts, faces;
    int *first, *number;         /* [blocks + 1] first cell of a block; [blocks] number of the block over all ranks */
    int axis_first[MAX_DIM + 1]; /* faces are sorted by their axis; first face of each */
    int *left, *right;           /* [faces] cell or ghost below and above; -1: none of the bed */
    unsigned char *kind;         /* [faces] enum bed_kind */
    int *low[MAX_DIM], *high[MAX_DIM]; /* [cells] the face below and above a cell along each axis */

    /* Set by the caller in every step; SI units, per volume: */
    double *U[MAX_VAR];       /* [cells + ghosts] rho, rho u, E of the cells at the start; in the end the result */
    double *kept[MAX_VAR];    /* [faces] BED_KEPT: the fluxes of U along the axis, mean over the step */
    double *outside[MAX_VAR]; /* [faces] BED_KEPT, BED_HELD, BED_FREE: U of the gas beyond the face, at the start */

    /* Results of bed_step */
    int newton, linear, lifted; /* iterations of Newton's method, of its linear solver; cells of this rank lifted */
    double *lift, *work;        /* [blocks] J/m^3: sums of the energy that lifting and gravity gave to the cells */

    struct bed_lines *lines;
    struct multigrid *multigrid;
    bool linked, laid; /* are the links listed, and laid out by the multigrid, for the present set? */
    long room[3];      /* blocks, cells with ghosts, faces that the memory has room for */
};

status bed_make(struct bed *b);
void bed_free(struct bed *b);
/* Makes room for a set of so many blocks, cells, ghosts and faces of this rank. */
status bed_size(struct bed *b, int blocks, int cells, int ghosts, int faces);
/* Advances the bed by dt with the mean acceleration gravity[dim]. *done: false, on all ranks, if the step must be done
 * again with a shorter dt; then U is lost. Collective. */
status bed_step(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done);

#endif
