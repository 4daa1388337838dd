/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the gas on polyhedra: what libcore/polyhedral/cells*.c share. */
#ifndef LIBCORE_CELLS_H
#define LIBCORE_CELLS_H

#include "libcore/gas/gas_private.h"
#include "libcore/schemes/polynomial.h"
#include "libcore/schemes/polynomial_fit.h"

/* Most stages of a super step of diffusion. The discrete operator on polyhedra has slightly complex eigenvalues; with
 * imaginary parts up to r times its largest rate, RKJ2 is unstable above about 3/r stages, and RKL2 a little earlier.
 * Limits of RKJ2 and RKL2 by the eigenvalues of the stress on some hundred cells between walls that hold the gas:
 *   boxes moved by 0.2 in 2D 1633, 1399, in 3D none below 3000; sheared by 45 degrees, too  316, 283
 *   right triangles 358, 313; moved by 0.2  586, 537; sheared, too  117, 115; sheared and all alike  50, 35
 *   prisms moved by 0.2  1538, 1399; sheared and all alike  29, 21
 *   six tetrahedra a cube 203, 189, without walls 157, 135; moved by 0.2  444, 391; flat (5 : 1) 68, 53; sheared 16, 13
 *   gmsh's tetrahedra from 306, 257; flat (5 : 1) from 71, 53; sheared by 27 degrees from 77, 63; by 45 from 23, 17
 * More super steps of fewer stages cost in proportion, so that the limit is that of common meshes: 51 stages cost 2.5
 * times as much as 127 for a ratio of 3000. */
enum { CELLS_STAGES = 127, CELLS_STAGES_3D = 51 };

struct cells_sweep { /* libcore/polyhedral/cells_sweep.c */
    int n;           /* turns */
    int *cells;      /* [n] the inner cells that are fitted when the fluxes of a turn begin */
    int *faces;      /* [n] the local faces that have their fluxes when the turn ends */
    int *start;      /* [n + 2] into chunk: chunks that can be updated after a turn, or (n) after all faces */
    int *chunk;      /* chunks of BATCH cells */
};
struct cells_sides { /* libcore/polyhedral/cells_sweep.c: the faces of chunks of BATCH cells */
    int *start;      /* [chunks + 1] */
    int *face;       /* [start[chunks]][BATCH] as face_of_cell; beyond all faces where a cell has no more */
    int *number;     /* the same without the mark of the right side: a condition on a place keeps loops from vectors */
};
struct cells { /* what the engine of polyhedra owns, g->cells; size, nown, faces, nblocks: of struct polyhedra */
    struct polyhedra *polyhedra;
    const struct grid *grid;
    struct fit *fit;
    struct cells_sweep sweep;
    struct cells_sides sides;
    double *inverse_volume;  /* [nown] 1/V, 1/m^dim */
    double *girth[MAX_DIM];  /* [dim][nown] sum over the faces of A |n_k| / (2 V), 1/m */
    double *total_girth;     /* [nown] sum over the faces of A / (2 V), 1/m */
    double *flux[MAX_VAR];   /* [faces + 1] through the whole face, from left to right, in the axes of the polyhedra */
    double *line;            /* [nown] scratch */
    struct entries gradient; /* weights of the gradients (cells_gradient.h), for those who want them */
    struct cells_diffuser *diffuser;     /* libcore/polyhedral/cells_diffusion.c; NULL without transport */
    struct cells_weight *weight;         /* libcore/polyhedral/cells_weight.c; NULL: there is no gravity */
    struct cells_rest *rest;             /* libcore/polyhedral/cells_rest.c; NULL: no state is known to be at rest */
    struct cells_fronts *fronts;         /* libcore/polyhedral/cells_fronts.c; NULL: nothing is done about fronts */
    struct cells_rules *rules;           /* libcore/polyhedral/cells_rules.c; NULL: no face follows a rule of its own */
    struct cells_shear_rate *shear_rate; /* libcore/polyhedral/cells_shear_rate.c; NULL: no law asks for it */
    struct cells_carried *carried;       /* libcore/polyhedral/cells_carried.c; NULL: the gas carries nothing */
    struct cells_round *round;           /* libcore/polyhedral/cells_round.c; NULL: the mesh is not round */
    struct cells_local *local;           /* libcore/polyhedral/cells_local.c; NULL: all cells take the same steps */
    struct cells_still *still;           /* libcore/polyhedral/cells_still.c; NULL: no cell is looked at */
    unsigned char *spared; /* [nnear] cells that lie deep in a bed (libcore/polyhedral/cells_bed.c); NULL without one */
};

struct cells_primitives { /* of a batch of cells */
    double velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH], gruneisen[BATCH];
};
/* Finds those of n <= BATCH cells, whose variables lie g->size apart from U on. */
void cells_primitives(const struct gas *g, int n, const double *U, struct cells_primitives *q);

/* The rates (1/s) of n <= BATCH cells of a state, as of struct gas_speed, and |u| + c. */
void cells_rates(const struct gas *g, const struct state *s, int from, int n, double *rate, double *fast);

/* line[v] <- the line of variable v of a state */
void cells_lines(const struct gas *g, const struct state *s, double *line[MAX_VAR]);

/* Turns n vectors q[dim][BATCH] from the axes of the mesh into the frames of faces, whose axes are the normal and the
 * tangents; `back`: out of them. */
void cells_turn_vectors(int n, int dim, bool back, double (*axis)[MAX_DIM][BATCH], double (*q)[BATCH]);
/* Writes the states of the mirrors from <= i < to into U. */
void cells_mirrors(const struct gas *g, int from, int to, double *const U[MAX_VAR]);
/* States beyond n points of a patch's faces: q -> ghost, conserved variables in the frames of the faces (normal first);
 * face, place: of each point. */
void cells_beyond(const struct gas *g, int patch, int n, const int *face, const int *place, double (*q)[BATCH],
                  double (*ghost)[BATCH]);

/* Component k of the vector from the centre of the cell on a side (left or right) of a face to the face's centre, the
 * mean of its points. */
ALWAYS_INLINE double cells_arm(const struct polyhedra *m, int face, int side, int k) {
    double arm = 0;
    for (int p = m->face.point_start[face]; p < m->face.point_start[face + 1]; p++)
        arm += m->point.weight[p] * m->point.arm[side][k][p];
    return arm;
}

/* The cell or mirror across an entry of face_of_cell. */
ALWAYS_INLINE int cells_across(const struct polyhedra *m, int entry) {
    const int face = m->face_of_cell[entry];
    return face < 0 ? m->face.left[~face] : m->face.right[face];
}

struct cells_walls {     /* [mirrors] what wall_shares says; 0 where a patch is no wall */
    double *drag, *heat; /* shares */
    double *stays;       /* of struct wall_line */
    double *lift; /* what friction on the wall, and the gradient of rho there, add to the T of the mirror, so that
                   * gradients see the slope of T that these make */
    double *through, *fed, *denser; /* of struct wall_line, through as a fraction of heat; NULL: there is no cross */
};
/* U, T, cell (bulk, shear, heat), cross: [size]; cross may be NULL */
void cells_wall_shares(const struct gas *g, double *const U[MAX_VAR], const double *T, double *const cell[3],
                       const double *cross, const struct cells_walls *out);
struct mirror_sums { /* share, lift: of wall_shares; start: q_0 */
    enum diffusing what;
    double weight;
    const double *share, *lift, *const *start;
    double *const *S;
};
/* S of mirrors from <= i < to of the polyhedra; gradients dS_c/dx_k, at k components + c, likewise. Beyond walls that
 * conduct S is such that the jump to it times the coefficient is the heat that enters, and weight lift more. */
void cells_mirror_sums(const struct gas *g, const struct mirror_sums *s, int from, int to);
void cells_mirror_gradients(const struct gas *g, int from, int to, const double *share, double *const *gradient);
/* Gives the gas in the fluxes of energy the heat of friction on walls that it slips along. */
void cells_slide(const struct gas *g, double weight, const double *stays, double *const *S);

/* -(sum of the fluxes out of the cell)/V of n <= BATCH cells, a chunk, in the order of their faces; flux[faces] must be
 * 0. */
void cells_residuals(const struct cells *c, int from, int n, const double *flux, double *residual);

/* ---- the order of a stage (libcore/polyhedral/cells_sweep.c) ---- */

/* fit: takes turns (fit_turns); NULL: it keeps the values of all cells. */
status cells_sweep_make(const struct polyhedra *m, struct fit *fit, struct cells_sweep *s);
void cells_sweep_free(struct cells_sweep *s);
status cells_sides_make(const struct polyhedra *m, struct cells_sides *s);
void cells_sides_free(struct cells_sides *s);
/* Makes of the weight[face_start[nown]] of the entries of face_of_cell those of the faces of chunks; the caller frees.
 */
status cells_sides_weights(const struct cells *c, const double *weight, double (**out)[BATCH]);
/* out[BATCH] <- the sums over the faces, in their order, of the cells of the chunk that begins at `from`, of weight
 * times left[faces + 1] where the cell is on the left of the face, elsewhere right[faces + 1]. */
void cells_sides_sum(const struct cells *c, int from, const double (*weight)[BATCH], const double *left,
                     const double *right, double *out);

/* ---- the bed (libcore/polyhedral/cells_bed.c) ---- */

/* Returns part [size] of struct dense where the stages may leave out what lies between two frozen cells: if no cell is
 * flagged and each face has one point; else NULL. */
const double *cells_kept(const struct gas *g);
/* Lets the fits of a stage leave out frozen cells that lie among frozen cells alone. */
void cells_spare(struct gas *g);

/* ---- uniform gas (libcore/polyhedral/cells_still.c) ---- */

/* After the round body and the sides of chunks. */
status cells_still_make(struct gas *g);
void cells_still_free(struct cells_still *s);
/* Looks for uniform cells of a stage's state, as fit_look. */
void cells_still_look(struct gas *g, const double *const *U, bool all);
/* Is it known before any work is done that the chunk that begins at a cell is uniform, and stays so but for sources? */
bool cells_left_out(const struct gas *g, int at);
/* Clears those residuals of n <= BATCH cells, whose variables lie g->size apart from U on, that are nothing but
 * round-off. */
void cells_still(const struct gas *g, int at, int n, double dt, const double *U, double (*residual)[BATCH]);

/* ---- weight on walls (libcore/polyhedral/cells_weight.c) ---- */

status cells_weight_make(struct gas *g);
void cells_weight_free(struct cells_weight *w);
/* Gives the mirrors beyond walls, plain images so far, what gas at rest has at their place: those of inner cells, or of
 * the others, once their ghosts are known. For the stages alone. */
void cells_weigh(const struct gas *g, bool inner, double *const U[MAX_VAR]);

/* ---- gas at rest (libcore/polyhedral/cells_rest.c) ---- */

/* Does what gas_rest promises. Collective. */
status cells_rest(struct gas *g, const bool *rests);
void cells_rest_free(struct cells_rest *r);
/* Finds how near the cells from <= i < to (<= nnear) of U are to the state at rest, for the calls below; due: those
 * where it is true alone, or NULL. */
void cells_rest_find(const struct gas *g, int from, int to, const double *const *U, const bool *due);
/* Adds to n states of polynomials at points point[n], in cells cell[n], what fit_rest leaves out. */
void cells_rest_add(const struct gas *g, const int *point, int n, const int *cell, double (*at)[BATCH]);
/* Notes the states on one side of these points, while the state at rest is being found: the left (0) side comes first.
 */
void cells_rest_note(const struct gas *g, int side, int from, int n, const int *face, double (*at)[BATCH]);
/* Adds to the residuals of the momentum of n <= BATCH cells what they miss at rest; not where weigh_row adds no
 * gravity. */
void cells_rest_weigh(const struct gas *g, int at, int n, const double *falls, const double *flag,
                      double *const residual[MAX_VAR]);

/* Adds share[n] of that to momentum[dim][n] in local steps, and notes it with the weight per * share: what is noted is
 * forgotten when these begin. */
void cells_rest_push(const struct gas *g, int at, int n, const double *share, double per,
                     double *const momentum[MAX_DIM]);
void cells_rest_forget(const struct gas *g);

/* What the last stage added, if fluxes through patches are kept: along an axis, out[nown] N/m^dim, less the part that
 * walls carry; and that part, the pressure that a wall's face has beyond the flux there (Pa, subtracted from it). */
void cells_rest_added(const struct gas *g, int axis, double *out);
double cells_rest_of_wall(const struct gas *g, int face);
/* Returns, for an own cell or a near ghost, what the mean pressure of U* on a face is above p* + rho* fall, fall being
 * g.(x_f - x), times the w of the last cells_rest_find. */
double cells_rest_miss(const struct gas *g, int face, int cell, double fall);

/* The pressures of U* at n points from <= i < from + n. */
void cells_rest_pressures(const struct gas *g, int from, int n, double *out);
/* How near a cell < nnear is to U*, the w of the last cells_rest_find, and p* there. */
double cells_rest_near(const struct gas *g, int cell, double *p);

/* ---- bodies of revolution (libcore/polyhedral/cells_round.c) ---- */

status cells_round_make(struct gas *g);
void cells_round_free(struct cells_round *r);
double cells_round_side(const struct gas *g, int i); /* A_2/V of cell i, 1/m */
/* Notes p + rho u_s^2 on both sides of the points of faces first <= i < last. */
void cells_round_note(const struct gas *g, int first, int last, const double *left, const double *right);
/* Adds the pressure along the radius to the residuals of n <= BATCH cells, whose variables lie g->size apart from U on,
 * once all their faces are noted, and makes of that of a swirl what the torques of c->flux do. flag[n]: as of
 * gas_limits, or NULL. */
void cells_round_push(const struct gas *g, int at, int n, const double *U, const double *flag,
                      double *const residual[MAX_VAR]);
/* With a swirl: lets the rotation of the cells go on in the plain mirrors from <= i < from + n (<= BATCH) of a wall,
 * and the pressure that it makes, that alone where walls hold the gas; beyond the axis the swirl changes its sign. */
void cells_round_beyond(const struct gas *g, int from, int n, bool held, double *const U[MAX_VAR]);
/* With a swirl: the lever of each face, m; the weights of the points in the flux of rho u_s through a face; and what
 * flux[faces + 1], through the whole face as all are, changes of rho u_s in the n cells of a chunk. */
const double *cells_round_levers(const struct gas *g);
const double *cells_round_weights(const struct gas *g);
void cells_round_torque(const struct gas *g, int at, int n, const double *flux, double *residual);

/* ---- rules of single faces (libcore/polyhedral/cells_rules.c) ---- */

status cells_rules_make(struct gas *g);
void cells_rules_free(struct cells_rules *r);
/* Notes the averages of cells from <= i < to, mirrors included. */
void cells_rules_note(const struct gas *g, int from, int to, const double *const *U);
/* Looks where the neighbourhoods of cells from <= i < to (<= nnear) ask for a rule, once their cells are noted. */
void cells_rules_look(const struct gas *g, int from, int to);
/* Finds the rules of n points of internal faces, face[n]. Returns whether there is any, and then sets rule[n]. */
bool cells_rules_find(const struct gas *g, int n, const int *face, const double *const *U, unsigned char *rule);
/* Sets the pressures p[n] that contacts have on one side of points from <= i < from + n of internal faces. */
void cells_rules_pressures(const struct gas *g, int side, int from, int n, const int *face, double *p);

/* Returns the speed at which the cells of a face part along its normal. */
double cells_parting(const struct gas *g, int face, const double *const *U);

/* ---- local time steps (libcore/polyhedral/cells_local.c) ---- */

status cells_local_make(struct gas *g);
void cells_local_free(struct cells_local *l);
/* The hook `local`. */
long cells_local(struct gas *g, const struct state *from, const struct state *to, double dt);
/* Makes of this rank's largest rates in U those of the longest step that is made of local ones. Collective. */
void cells_local_longest(struct gas *g, struct gas_speed *speed);

/* ---- fronts of shocks (libcore/polyhedral/cells_fronts.c) ---- */

status cells_fronts_make(struct gas *g);
void cells_fronts_free(struct cells_fronts *x);
void cells_fronts(struct gas *g, const struct gas_speed *speed);
/* Finds the floors of n points of faces beside fronts, face[n]; returns whether there is any, and then sets floor[n].
 */
bool cells_fronts_floor(const struct gas *g, int n, const int *face, double *floor);

/* ---- implicit acoustics (libcore/polyhedral/cells_bed.c): the hooks of libcore/gas/engine.h ---- */

status cells_bed_make(struct gas *g);
void cells_bed_blocks(const struct gas *g, bed_block_visitor *visit, void *context);
void cells_bed_balance(struct gas *g, const struct state *from);

/* Carried quantities (libcore/polyhedral/cells_carried.c): the hooks of libcore/gas/carried.h; cells_carry notes the
 * fluxes of mass of a stage. */
status cells_carried_make(struct gas *g);
void cells_carried_free(struct cells_carried *x);
void cells_carried_rise(struct gas *g);
void cells_carried_terms(struct gas *g, double dt);
double cells_carried_most_out(const struct gas *g);
void cells_carried_move(struct gas *g, const struct carried_quantity *q, struct carried_part part);
void cells_carry(struct gas *g);

/* Fluxes through patches (libcore/polyhedral/cells_tally.c): the hooks `edges` and `rest`; the fluxes of a stage; what
 * diffusion passes on, by the fluxes in hand. */
void cells_edges(const struct gas *g, int block, edge_face_visitor *visit, void *context);
status cells_tally_rest(struct gas *g, double weight, double *force);
void cells_tally_stage(struct gas *g);
void cells_tally_diffusion(struct gas *g, enum diffusing what, double dt);
void cells_tally_cross(struct gas *g, double dt);

long cells_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt, struct ending *ending);
void cells_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt);

status cells_shear_rate_make(struct gas *g);
void cells_shear_rate_free(struct cells_shear_rate *x);
void cells_shear_rate(struct gas *g, const struct state *s);

status cells_diffuser_make(struct gas *g);
void cells_diffuser_free(struct cells_diffuser *d);
void cells_diffusion_rates(struct gas *g, const struct state *Y0, double most[2], const struct state *each);
void cells_near_ghosts(struct gas *g, const struct state *s);
void cells_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double pending);
void cells_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight);
long cells_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight);
void cells_diffusion_cross(struct gas *g, const struct state *to, double dt);
void cells_diffusion_spread(const struct gas *g, const struct state *from, const struct state *to,
                            const struct row *row, double *spread);
double cells_implicit_weight(struct gas *g, enum diffusing what, double per, int block, long at, int k, int c);

#endif
