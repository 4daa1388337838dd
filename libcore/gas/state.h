/* Inside of the gas: what its engines and step.c share, and the engine of the tiles. */
#ifndef LIBCORE_STATE_H
#define LIBCORE_STATE_H

#include "libcore/gas/audit.h"
#include "libcore/gas/gas.h"
#include "libcore/gas/implicit.h"
#include "libcore/schemes/limit.h"

#define PACKED 0.99  /* of the density limit: cells above it are packed */
enum { SLACK = 16 }; /* doubles behind every block: the last line is read in whole vectors */

struct work { /* scratch of one tile, [size] each: stays in L2 through a stage */
    double *velocity[MAX_DIM], *eps, *p, *c, *gruneisen;
    double *flux[MAX_VAR];     /* nodal fluxes along the axis in turn */
    double *residual[MAX_VAR]; /* -div F */
};
struct span { /* columns low <= i < high of a row */
    int low, high;
};
#define SPAN_EMPTY ((struct span){1 << 20, -(1 << 20)})
static inline bool span_empty(struct span s) {
    return s.low >= s.high;
}
static inline struct span span_join(struct span a, struct span b) {
    return (struct span){a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}
/* The state of all tiles. A tile has a background, the values that many of its cells share
 * (libcore/lattice/tiles_activity.c), and a span for each of its rows: the cells outside it equal the background, and
 * their memory is not kept up. */
struct state {
    double **block;       /* [ntiles] of [nvar][size]; offset 0 belongs to no cell: it holds the background */
    struct span **varied; /* [ntiles] of [nspans] */
};
struct activity { /* of the tile in hand: what differs from its background, what a stage computes, what that needs */
    int rows;     /* of a tile with its ghosts, along axis 1 */
    int nspans;   /* rows * rows along axis 2 */
    struct span *differ, *active, *needed;
    bool *quiet; /* [ntiles * 6] sides whose ghost layers equal the tile's background and are not kept up either */
};
struct ending {               /* of a step, behind its last stage */
    bool sources;             /* are there any? */
    double dt, kick[MAX_DIM]; /* their half step */
    struct gas_speed speed;   /* out: of the final state, of this rank's cells */
};
enum diffusing { VISCOUS, HEAT };
struct links { /* between cells that share a face, of this rank's */
    int cells;
    int *first;     /* [cells + 1] into `column` */
    int *column;    /* number over all ranks of the cell itself, and of those it is linked to, perhaps twice */
    bool symmetric; /* is the operator of heat, as far as links go and beyond? the same on all ranks */
};
struct gas;
struct engine {                    /* one kind of mesh: how it holds the state, and its part of what gas.h promises */
    status (*make)(struct gas *g); /* the states and the work memory of g, all else being set */
    void (*free)(struct gas *g);   /* of what make made, perhaps in part */
    void (*set_conserved)(struct gas *g, const double *const U[MAX_VAR]);
    status (*get_conserved)(const struct gas *g, double *const U[MAX_VAR]);
    void (*block_field)(const struct gas *g, int block, enum gas_field field, double *const out[3]);
    status (*field)(const struct gas *g, enum gas_field field, double *const out[3]);
    status (*check)(const struct gas *g);
    void (*speed)(struct gas *g, struct gas_speed *speed); /* of this rank's cells */
    void (*fastest_place)(struct gas *g, const struct gas_speed *speed, double place[3]);
    status (*totals)(const struct gas *g, const struct state *s, double totals[MAX_VAR]);
    /* to = the sources applied to from, over dt; kick: the velocity gained. Returns the number of cells that are not
     * admissible then. */
    long (*sources)(struct gas *g, double dt, const double kick[MAX_DIM], const struct state *from,
                    const struct state *to);
    /* One stage: to = W + a (U0 - W), W = from + dt L(from), in all cells of this rank; returns the number of cells
     * that are not admissible and raises their flags. */
    long (*stage)(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                  double dt);
    /* The last stage of a step, and the step's ending block by block while a block is in the cache. Like stage, it does
     * no harm when `from` holds inadmissible cells (NaN, too): all is thrown away then. NULL: none, step.c does it. */
    long (*last_stage)(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                       double a, double dt, struct ending *ending);
    /* Sends the flags to the neighbours; returns the number of flagged cells of all ranks. */
    long (*share_flags)(struct gas *g);
    /* The stage again where flags are near, with the faces of flagged cells limited (libcore/schemes/limit.h); those
     * are counted in g->faces. Flags what is not admissible. */
    void (*redo)(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt);
    /* Raises the density of cells to its floor, counted in g->filled and noted, times g->share, in g->fill; and the
     * energy to the round-off floor, counted in g->floored and noted in g->raised; returns the number of cells that
     * are not admissible all the same. */
    long (*floor)(struct gas *g, const struct state *s);
    status (*sum_raised)(const struct gas *g, double *raised, double *sum); /* of g->raised or fill of all ranks */
    void (*note_limited)(struct gas *g, double place[3]); /* adds the flags to the field; where is the first? */
    void (*clear_flags)(struct gas *g);
    /* U0 and U of struct stepper's exchange: from start and state to next (start itself, or another) and state. */
    void (*exchange)(struct gas *g, const struct state *start, const struct state *next, const struct state *state);
    /* With transport, see libcore/gas/diffusion.h. rates: freezes the coefficients of Y0, fills its ghosts; most[2]:
     * the largest rates of this rank's cells, viscous and of heat. cooled: notes by how much T fell, by cooling, from
     * one state to another; of NULL: by nothing. friction: notes by how much T rose, by the stress, less that. begin:
     * q_0 from Y0, of heat less `rest` of friction, less cooled if g->late, and S_1 = factor q_0. stage: the next S, by
     * its c[5] with dt in all but the first two, the last one for friction; weight: of S when q is 1. end: to (perhaps
     * Y0 itself) = Y0 moved by S over dt; returns the number of cells that are not admissible, and marks them. flags:
     * makes the marks flags, if they are to be kept, which leave the tangential derivatives out of the stress on their
     * faces (on polyhedra all but the jumps across them, of heat, too); drops them else. Returns the number of flagged
     * cells of all ranks. */
    int diffusion_stages; /* at most, in one super step: operators that are not quite symmetric; 0: any number */
    void (*diffusion_rates)(struct gas *g, const struct state *Y0, double most[2]);
    /* Notes by how much T rose to `to` from the state of the last rates; if g->ahead, rates sees T of Y0 risen by as
     * much. NULL: g->ahead is never set. */
    void (*diffusion_ahead)(struct gas *g, const struct state *to);
    void (*diffusion_cooled)(struct gas *g, const struct state *from, const struct state *to);
    void (*diffusion_friction)(struct gas *g, const struct state *from, const struct state *to);
    void (*diffusion_begin)(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double rest);
    void (*diffusion_stage)(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                            double weight);
    long (*diffusion_end)(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                          double weight);
    long (*diffusion_flags)(struct gas *g, bool keep);
    /* For implicit diffusion (libcore/gas/implicit.h). pattern: cells of this rank and whom each is linked to, itself
     * first. matrix: mass and energy of the cells, and the weights of links, of one unknown of each cell after the
     * other, in mass - factor volume L without what couples the components; volumes that are all the same may be left
     * out. move: S of the last stage from or to x, whose unknowns of a cell follow each other. */
    status (*implicit_pattern)(struct gas *g, struct links *out);
    void (*implicit_matrix)(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double *mass,
                            double *E, double *weight);
    void (*implicit_move)(struct gas *g, enum diffusing what, double *x, bool to_sums);
};
extern const struct engine engine_lattice, engine_polyhedral;

/* The maxima over the ranks to g->speed, unless one of them says that its own are void: then it returns false. */
bool speed_share(struct gas *g, const struct gas_speed *mine, bool is_void);

/* to = from moved by viscous stress and heat conduction over dt, in the first or the second half of a
 * step. bad: cells of `from` on this rank that are not admissible. false, on all ranks: there are some on a rank, or
 * would be in `to`. */
bool diffuse(struct gas *g, const struct state *from, const struct state *to, double dt, bool second, long bad);

struct lapse { /* dt, in which heat takes `part` of a friction, of which Y0 has `rest` though it is yet to heat */
    double dt, rest, part;
};

/* As what from Y0 to `to` by one implicit step, of backward Euler if `monotone`; returns this rank's number of cells
 * that are not admissible: all if it was not solved. */
long implicit_step(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to,
                   const struct lapse *l, bool monotone);

/* For the patterns: the number over all ranks of this one's first cell. */
status implicit_first(const struct gas *g, int cells, long *first);

struct sum_line {              /* n <= BATCH cells along a patch and what lies beyond them */
    int n, components, normal; /* component along the normal; of a scalar -1 */
    const int *face;           /* [n] within the patch */
    double weight;             /* of S when q is 1 */
    double (*inner)[BATCH], (*start)[BATCH], (*ghost)[BATCH]; /* S inside, q_0 beyond; the result */
};
/* S beyond a patch, by its rules; reflect_sums: as for a velocity without a value. Where a rule reflects, components
 * are in the frame of the face, else in the axes of the mesh (libcore/polyhedral/cells_edge.c). carry_sums comes after
 * sums_beyond, in the axes of the mesh: it adds the wall's own velocity to `ghost`.
 * Heat crosses some walls (wall_conducts): of these sums_beyond gives S of the wall itself, and the heat that enters is
 *     share * heat (S_wall - S)/d,  d: from the cell to its mirror image,
 * share from wall_shares, by the density and the temperature inside that the coefficients are those of; push: what
 * pulls the gas onto the wall, m/s^2. */
void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
bool wall_conducts(const struct patch_rules *rules);
void wall_shares(const struct gas *g, const struct patch_rules *rules, int n, const double *rho, const double *T,
                 const double *push, const double *d, const double *heat, double *share);
void reflect_sums(const struct patch_rules *rules, const struct sum_line *l);

struct diffuser {      /* of the tiles: [ntiles] of so many lines of [size] */
    double **sum[2];   /* dim: S of the last stage, with one layer of ghosts, and of the one before */
    double **start;    /* dim: q_0, the same */
    double **friction; /* T that the stress of this half step made, less cooled */
    double **cooled;   /* T that cooling took in the first half; both 0 in ghosts */
    double **gradient; /* dim * dim: at k dim + c half of dS_c/dx_k, in ghosts and along the sides only */
    double **face;     /* of each axis FACE_LINES: coefficients of the face below a cell */
    double **light;    /* 1/rho */
    double **keep;     /* of each axis, if `plain`: 0 where the tangential derivatives do not count, else 1 */
    double **mark;     /* 1: cells that were not admissible */
    double **warm;     /* T of the coefficients, or what it rose by; with one layer of ghosts */
    bool marked;       /* any? */
    bool plain;        /* until the next rates */
    int last;          /* sum of the last stage */
};

struct gas {
    const struct engine *engine;
    const struct comm *comm;
    struct gas_models models;
    int dim, nvar, npatches, ncells_all;
    const struct patch_rules *rules; /* [npatches] */
    const struct reconstruct *first_order;
    struct state U;
    struct state U0;         /* after the first half of the sources: the start of the Runge-Kutta step */
    struct state V, W;       /* stages */
    double fastest[MAX_DIM]; /* max |u_k| + c, from the last gas_speed */
    double least, limit;     /* least < rho < limit; least: 0, or the density floor less round-off */
    struct gas_speed speed;  /* of U, if speed_known */
    bool speed_known;
    int guarded; /* so many steps are still looked at stage by stage (libcore/gas/step.c) */
    int slow;    /* so many steps in a row were tiny; slow_dt: an earlier one and the last; < 0: not known */
    double slow_dt[2];
    struct gas_counts counts;
    double pull[MAX_DIM]; /* m/s^2, with transport: mean acceleration by the sources in the half step in hand */
    bool late;            /* diffusion is in the second half of the step, before cooling */
    bool
        ahead; /* the coefficients of diffusion are to be those at the end of the half step (libcore/gas/diffusion.c) */
    long faces;     /* limited in the last redo, on this rank */
    long floored;   /* cells raised to the round-off floor by this attempt at a step, on this rank */
    double *raised; /* [nraised] J/m^3 of this attempt: of tiles, or of cells of the polyhedra */
    int nraised;
    long filled;         /* cells raised to the density floor by this attempt, on this rank */
    double *fill[2];     /* [nraised] the mass and energy of that in the step's result, per m^3; NULL without a floor */
    double share;        /* of what is added to a stage in that result */
    long computed, all;  /* cells times stages on this rank */
    struct audit *audit; /* NULL: off */

    struct forest *forest; /* from here on: of the tiles */
    double **flag;         /* [ntiles] of [size]: > 0 where faces are to be limited (numbers travel like variables) */
    double **limited;      /* [ntiles] of [size]: how often that was so */
    bool *flagged;         /* [ntiles] does the tile, or its ghost layer, hold a flag? */
    double *sums;          /* [ntiles] */
    struct work work;
    struct activity activity;
    struct diffuser diffuser;  /* empty without transport */
    struct implicit *implicit; /* NULL: diffusion is explicit */

    const struct grid *grid; /* of the polyhedra */
    struct cells *cells;     /* libcore/polyhedral/cells.h */
};

long tiles_sources(struct gas *g, double dt, const double kick[MAX_DIM], const struct state *from,
                   const struct state *to);
long tiles_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt);
long tiles_last_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                      double dt, struct ending *ending);
long tiles_share_flags(struct gas *g);
void tiles_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt);
long tiles_floor(struct gas *g, const struct state *s);
status tiles_sum_raised(const struct gas *g, double *raised, double *sum);
void tiles_note_limited(struct gas *g, double place[3]);
void tiles_clear_flags(struct gas *g);
void tiles_exchange(struct gas *g, const struct state *start, const struct state *next, const struct state *state);

status diffuser_make(struct gas *g);
void diffuser_free(struct gas *g);
void tiles_diffusion_rates(struct gas *g, const struct state *Y0, double most[2]);
void tiles_diffusion_ahead(struct gas *g, const struct state *to);
void tiles_diffusion_cooled(struct gas *g, const struct state *from, const struct state *to);
void tiles_diffusion_friction(struct gas *g, const struct state *from, const struct state *to);
void tiles_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double rest);
void tiles_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight);
long tiles_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight);
long tiles_diffusion_flags(struct gas *g, bool keep);
status tiles_implicit_pattern(struct gas *g, struct links *out);
void tiles_implicit_matrix(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double *rho,
                           double *E, double *weight);
void tiles_implicit_move(struct gas *g, enum diffusing what, double *x, bool to_sums);

status blocks_make(const struct forest *f, int nvar, double ***out);
void blocks_free(const struct forest *f, double **blocks);

/* Rows: the runs of cells along axis 0 that a pass over a tile visits. margin: ghost cells to include on each active
 * axis, but no corners. Calls visit(context, offset, n) with n <= BATCH. */
typedef void row_visitor(void *context, long offset, int n);
void rows_visit(const struct forest *f, const struct tile *tile, int margin, row_visitor *visit, void *context);

/* Nothing is background: all cells are in memory. */
void activity_reset(const struct gas *g, const struct state *s);
/* Narrows the spans of a tile to the cells that differ; finds a background if there was none. Is there any? */
bool activity_find(const struct gas *g, int tile, const struct state *s);
/* Before a ghost fill: finds the quiet sides, and writes the layers that others will read. */
void activity_prepare(struct gas *g, const struct state *s);
/* After the ghost fill of `from`: the cells that differ from their stencil somewhere, or in U0 (active), and the cells
 * that the fluxes of those need. Returns false if there are none. */
bool activity_spread(struct gas *g, int tile, const struct state *U0, const struct state *from);
/* Turns the cells of a tile that are background into cells in memory, so that they may change one by one. */
void activity_unfold(const struct gas *g, int tile, const struct state *s);
/* Writes the background where it is to be read: in the spans of rows (margin: with ghosts), or in the whole tile. */
void activity_store(const struct gas *g, int tile, const struct state *s, struct span *spans, int margin);
void activity_store_all(const struct gas *g, int tile, const struct state *s);
struct span *activity_row(const struct activity *a, struct span *spans, int j, int k);
/* As rows_visit, for the span of one row, or of all. */
void row_visit(const struct gas *g, struct span *spans, int j, int k, row_visitor *visit, void *context);
void spans_visit(const struct gas *g, int tile, struct span *spans, int margin, row_visitor *visit, void *context);

/* Of n <= BATCH states whose variables are `size` apart: velocity and eps = E/rho - |u|^2/2; the roots of c^2. */
void velocity_row(int n, int dim, long size, const double *restrict U, double *const *velocity, double *restrict eps);
void root_row(int n, double *restrict c);
/* to = W + a (U0 - W), W = from + dt residual */
void update_row(int n, double a, double dt, const double *restrict U0, const double *restrict from,
                const double *restrict residual, double *restrict to);

/* What follows from U for n cells at `offset`, into the workspace: velocity and eps; p, c and gruneisen, too. */
void velocities_of_row(const struct gas *g, const double *U, long offset, int n);
void primitives_of_row(const struct gas *g, const double *U, long offset, int n);

/* Wave speeds: what a row visitor gathers on this rank, U being the tile's block. */
struct speeds {
    struct gas *g;
    double *U;
    struct gas_speed most;
    double wanted; /* looks for the cell with this rate, if > 0 */
    long found;
};
void speed_visit(void *context, long offset, int n);

struct patch_line {        /* ghosts along a patch */
    int n;                 /* <= BATCH */
    int normal;            /* component along the normal, where the patch reflects */
    const int *face;       /* [n] within the patch */
    const double *outflow; /* [n] velocity out of the domain, where the patch needs values */
};
bool patch_needs_values(const struct patch_rules *r);
/* ghost <- the rules of a patch on `inner` (which may be changed): conserved variables [nvar]. */
void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]);

/* Allocates g->nraised places for what the floors add. */
status floors_make(struct gas *g);
void floors_free(struct gas *g);
/* Both floors on n <= BATCH states whose variables are `size` apart; what cell i was given is noted in g->fill and
 * g->raised at place + i step. Returns how many are bad all the same. */
long floors_apply(struct gas *g, int n, long size, double *U, int place, int step);
const char *density_hint(const struct gas *g); /* behind the message of a state that is not admissible */

/* Of places that ranks found, the first in space; none: HUGE_VAL. Order in space decides, not the rank. */
struct first_place {
    double order, place[3];
};
static inline void first_place_offer(struct first_place *p, const double here[3]) {
    double order = here[0] + 1e-7 * here[1] + 1e-14 * here[2];
    if (!(order < p->order)) return;
    p->order = order;
    memcpy(p->place, here, sizeof p->place);
}
void first_place_share(const struct gas *g, const struct first_place *p, double place[3]);

/* Of a cell of a tile, m. */
void cell_place(const struct gas *g, const struct tile *t, long offset, double place[3]);

/* Ghost layers of one tile's sides that are patches. */
void ghosts_of_patches(const struct gas *g, int tile, double *U);

/* One stage of one tile: to = W + a (U0 - W), W = from + dt L(from); returns the number of cells that are not
 * admissible and raises their flags. */
int stage_of_tile(struct gas *g, int tile, const struct state *U0, const struct state *from, const struct state *to,
                  double a, double dt);

/* Is every cell of the row admissible? Returns how many are not; marks[i] (or NULL) is raised by 1 there. */
int row_inadmissible(const struct gas *g, const double *U, long offset, int n, double *marks);

#endif
