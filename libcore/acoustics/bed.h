/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An implicit acoustic step of dense gas: a bed, which is any set of cells of a mesh (docs/physics.md 9.1).
 *
 * Near packing sound is 100 to 10,000 times as fast as the flow. So in a bed the step is split into acoustics and
 * transport (Lagrange-projection: Chalons, Girardin & Kokh, Commun. Comput. Phys. 20, 188, 2016; here the acoustics is
 * nonlinear). Let V be the volume of a cell K, A and n the area and the normal of a face f between L and
 * R, d_f = (x_R - x_L).n the distance of the centres along it, tau = 1/rho, and let P_K = p_K + rho_K g.(x_f - x_K) be
 * the pressure of cell K at the face, under its own weight.
 *
 * 1. Acoustics, implicit in the pressures p of the cells:
 *        U_f   = (rho_L u_L + rho_R u_R).n/(rho_L + rho_R) - dt (P_R - P_L)/(rho_f d_f),  rho_f = (rho_L + rho_R)/2
 *        tau   = tau^n L,  L = 1 + dt/V sum_f A U_f     (outwards)
 *        eps   = eps^n - p (tau - tau^n)   with   p = p(tau, eps).
 * For given p the latter two and p = Gamma eps/tau (Gamma: Grueneisen coefficient) say
 *        tau (1 + 1/Gamma(1/tau)) = tau^n + eps^n/p                                                  (*)
 * which has one root tau(p) for any p > 0, with tau > tau of packing, as Gamma diverges there, and eps = p tau/Gamma >
 * 0. It remains to find p with V (rho^n tau(p) - 1) - dt sum_f A U_f(p) = 0, whose Jacobian is a symmetric M-matrix, as
 * tau' < 0: Newton's method (bed_pressure.c). On meshes whose faces do not cross the line of centres at right angles
 * U_f misses a part of dt (g - grad p/rho): an error of first order in dt of what the next step starts from anew.
 * 2. Velocity and energy, conservative, by the face pressures p_f = (rho_R P_L + rho_L P_R)/(rho_L + rho_R) + q_f,
 * which give exactly 0 where all U_f = 0 (bed_update.c). Gas at rest under gravity, P_R = P_L, has U_f = 0 and stays at
 * rest to round-off. q_f = -z [u.n]/2 damps velocities of cells that their faces do not see.
 * Where p_f would cool a cell below its bound, its neighbours give it of the heat that they have of the same faces.
 * 3. Remap: what U_f carries goes to the neighbour, with limited slopes (bed_remap.c).
 *
 * Theorem. If the step succeeds, 0 < rho < rho of packing and eps > 0 in all cells that have no kept face. Proof: after
 * 2 the density is rho^n/L = 1/tau(p) to the tolerance of Newton's method, and checked; eps is kept above (1 - b) times
 * that of (*). In 3 a cell's new state, of density, momentum and energy, is, with lambda = dt A/V,
 *     (1 - sum_in lambda |U_f|) B + sum_in lambda |U_f| (state of the face, upwind),
 * where B = [L W - sum_out lambda U_f W_f]/(1 - sum_in lambda |U_f|) is what stays behind, W is the cell's state after
 * 2 and W_f its face values. If sum_in lambda |U_f| < 1 this is a convex combination. Face values with limited slopes
 * lie between those of a cell and those around it, component by component of (rho, u, eps), so they are admissible; B
 * is W if the slopes are 0, and the slopes of a cell are set to 0 where its B is not admissible. The step fails, and
 * must be done with a shorter dt, if more than MOST_OUT of a cell is carried in or out, or a cell is lifted by more
 * energy than it and its neighbours had. Cells with kept faces are lifted where they would have no energy left; their
 * densities are checked by the caller. */
#ifndef LIBCORE_BED_H
#define LIBCORE_BED_H

#include "libcore/acoustics/acoustics.h"
#include "libcore/models/eos.h"
#include "libcore/models/friction.h"
#include "libcore/models/kernel.h"
#include "libcore/multigrid/arrays.h"
#include "mesh/base/comm.h"

enum bed_kind {
    BED_INNER, /* between two cells of the bed */
    BED_WALL,  /* no gas passes */
    BED_KEPT,  /* towards a cell beside the bed: the flux is given (kept) */
    BED_OPEN   /* towards an open patch */
};

/* Of a body of revolution (docs/physics.md 1.4): areas and volumes have the weight r. The pressure on the sides of a
 * cell is the mean of those on its faces, so that the gradient of p along the radius is that of the plane. */
struct bed_round {
    int radial;              /* solved axis along the radius */
    double *radius;          /* [shapes of cells] m: the volume over that in the plane */
    double *flat;            /* [shapes of faces] m^(dim-1), > 0: area in the plane */
    double *mid[2][MAX_DIM]; /* [left or right][shapes of faces] m: `arm` to the middle of the face in the plane */
    int *body[2];            /* [left or right][shapes of faces] of boxes: shape of the cell there; else NULL */
};

/* The shapes of cells and faces, which the engine owns; equal ones are listed once. Vectors are along the axes that are
 * solved. Areas and volumes may have a common factor. */
struct bed_shapes {
    bool boxes;              /* do the faces of a cell come in opposite pairs, axis by axis, the lower one first? */
    double *volume;          /* [shapes of cells] m^dim */
    double *area;            /* [shapes of faces] m^(dim-1) */
    double *normal[MAX_DIM]; /* [shapes of faces] unit, from left to right */
    /* [left or right][shapes of faces] m: from the centre of the cell on that side to the face's; beyond patches that
     * of the mirror image of the cell within */
    double *arm[2][MAX_DIM];
    double *depth[2]; /* [left or right][shapes of faces] m: distance of the cell's centre from the face, > 0 */
    const struct bed_round *round; /* NULL: flow in the plane */
};

/* What a step takes from a bed's sound. Backward Euler for rho u_t = -grad p, p_t = -rho c^2 div u takes exactly
 *     L = sum V/2 (rho |du|^2 + dp^2/(rho c^2))
 * of acoustic energy in a step that changes u by du and p by dp, whatever the wave's amplitude and phase. Here du and
 * dp are the changes by acoustics or those since the start of the whole step, the less of the two, and du also without
 * gravity's: in a bed at rest cooling and stress take what the weight gives back in every step, which is no wave. The
 * energy of motion is that about the mean velocity of the bed, so that sound in a stream counts as sound. */
struct bed_blur {
    double whole; /* L over the energy of motion of the bed ahead of acoustics */
    double local; /* the same of the block where it is greatest: a wave in a corner of a bed that moves elsewhere */
};

/* Cells and their faces, block by block (tile by tile): what a rank gets of them, and gives back. Cell i has the
 * number low + i; other numbers are cells of other ranks. Numbers per volume are in SI units. */
struct bed_set {
    /* Lists, which hold until the set changes. */
    int blocks, cells, ghosts, faces, low; /* ghosts: cells of other ranks behind the cells, if their states are here */
    int *first, *number; /* [blocks + 1] first cell of a block; [blocks] number of the block over all ranks */
    int *body, *shape;   /* [cells + ghosts], [faces] shapes */
    int *left, *right;   /* [faces] numbers of the cells on either side; -1: none of the bed */
    unsigned char *kind; /* [faces] enum bed_kind */
    int *face_start, *face_of_cell; /* [cells + 1] into the lists of the cells' faces; ~face if the cell is right */
    const struct bed_shapes *shapes;

    /* States, which are set in every step. */
    double *U[MAX_VAR];       /* [cells + ghosts] rho, rho u, E of the cells at the start; in the end the result */
    double *start[MAX_VAR];   /* [cells] U at the start of the whole step, ahead of its sources (bed_note_start) */
    double *outside[MAX_VAR]; /* [faces] BED_KEPT, BED_OPEN: U of the gas beyond the face, at the start */
    double *holds; /* [faces] BED_OPEN: 1 if the gas beyond has a given pressure, 0: if it has the cell's own */
    /* [faces] BED_KEPT: the fluxes of U from left to right, per area and time, mean over the step. In the end those of
     * all faces but BED_INNER. On a wall they are without `balance`, which stands for the pressure that it carries. */
    double *kept[MAX_VAR];
    /* [left or right][faces] numbers that are added to P. They make P_L = P_R in a state that is known to be at rest,
     * though its own P_L and P_R differ. `balanced`: are there such numbers? */
    bool balanced;
    double *balance[2];

    /* Friction alone; without it NULL. */
    double *pressure;  /* [cells] Pa, of the last step of a bed; 0: there was none. In the end that of this step */
    double *stress[6]; /* [tensors][faces] Pa, kept from the last step, likewise; rows of the upper half of a tensor */
    double *wall_friction;       /* [faces] of walls: coefficient; HUGE_VAL: that of the grains; 0: none */
    double *wall_speed[MAX_DIM]; /* [faces] m/s, of walls */

    /* Results */
    double *lift, *work; /* [blocks] J: sums of the energy that lifting and gravity gave to the cells */
    double *rubbed;      /* [blocks] J: sums of the energy that friction gave to the cells; 0 without friction */
    double *pushed;      /* [blocks] of bed_push */
    double *peak;        /* [blocks] J/m^3: the greatest L/V of a cell */
    int *peak_cell;      /* [blocks] that cell, from the block's first on */

    double *cell_lines, *face_lines; /* the memory of these */
    struct arrays arrays;
};

struct bed_lines; /* the work memory */
struct bed_friction;
/* Gas under gravity that is so cold that it lies on the bottom of its cell, T < LYING g h, is packed there, although it
 * fills the cell in part: it rubs from FILLS_LOW on, wholly from FILLS_HIGH on, as parts of packing. */
#define LYING      0.2
#define FILLS_LOW  0.1
#define FILLS_HIGH 0.3
static inline double lying_share(double T, double fall, double fills) { /* fall: g h; fills: rho over packing */
    const double cold = 1 - T / (LYING * fall), full = (fills - FILLS_LOW) / (FILLS_HIGH - FILLS_LOW);
    return fall > 0 && cold > 0 && full > 0 ? cold * (full < 1 ? full : 1) : 0;
}
struct friction_use { /* zeroes: there is no friction */
    const struct friction *law;
    struct friction_params params;
    double grain; /* diameter times the root of a grain's density: I = rate grain/sqrt p */
};
struct multigrid;
struct bed_halo;
struct bed_deal;
struct bed {
    /* Set once, before bed_make: */
    const struct eos *eos;
    const struct material *material;
    const struct comm *comm;
    struct acoustics_params params;
    int dim, components; /* solved axes; components of the velocity, which may be more: those are carried along */
    double limit;        /* kg/m^3: densities stay below it */
    bool carries;        /* does kept[0] get the flux of mass of BED_INNER, too, on all ranks? */
    struct friction_use friction;

    struct bed_set *home; /* the cells of this rank's mesh, which the caller lists */
    struct bed_set set;   /* the cells that this rank computes: its share of the bed; on one rank `home` itself */

    /* Results of bed_step */
    int newton, linear, lifted; /* iterations of Newton's method, of its linear solver; cells of this rank lifted */
    struct bed_blur blur;       /* the same bits on any number of ranks */

    enum { BED_NEW, BED_WRITTEN, BED_DEALT, BED_LAID } stage; /* how far are lists, on their way to the multigrid? */
    struct bed_lines *lines;
    struct bed_friction *rub; /* NULL: there is no friction */
    struct multigrid *multigrid;
    struct bed_halo *halo; /* messages from and to ghosts; NULL: none are sent */
    struct bed_deal *deal; /* who computes which cells (bed_deal.c); NULL on one rank */
};

static inline int bed_tensors(int components) { /* numbers of a stress */
    return components * (components + 1) / 2;
}
/* Makes a bed whose home has at most `blocks` blocks; home->shapes is set then. */
status bed_make(struct bed *b, int blocks);
void bed_free(struct bed *b);
/* Begins another set, of the blocks that home->blocks, first and number tell, whose cells have `sides` sides: makes
 * room, and sets home->cells and low. Then the caller lists cells and faces. Collective. */
status bed_list(struct bed *b, int sides);
/* Writes the lists of a new set for the ranks that will compute it. bed_step does so if it was not done before, by a
 * rank that had time. */
void bed_write(struct bed *b);
/* Takes home->U, just set, as that at the start of the whole step. */
void bed_note_start(struct bed *b);
/* Advances the bed by dt with the mean acceleration gravity[components]. *done: false, on all ranks, if the step must
 * be done again with a shorter dt; then U is lost. Collective. */
status bed_step(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done);
/* Lets friction alone act on the bed over dt, behind an explicit step; gravity as in bed_step, for the weight on faces.
 * Sets home->U, `rubbed`, `kept` of walls and what friction keeps. *done as in bed_step. Collective. */
status bed_rub_alone(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done);
/* After a step: sets home->pushed to the momentum along an axis (N s) that gravity and `balance` gave to the cells, the
 * latter on faces that are no walls. */
void bed_push(struct bed *b, double dt, const double gravity[MAX_DIM], int axis);

#endif
