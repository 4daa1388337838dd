/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small random problem: a family and a seed say all about it, on every machine. */
#ifndef STRESS_PROBLEM_H
#define STRESS_PROBLEM_H

#include "libcore/gas/gas.h"
#include "mesh/format/polymesh.h"
#include "tests/simplices.h"
#include "tests/stress/seed.h"

enum edge { CLOSED, PERIODIC, OPEN_ENDED }; /* slip walls; cyclic; zeroGradient */

struct place { /* where a cell is, 0 <= x < 1 of the box, and where that is in the problem's pattern */
    double x[3];
    double along; /* of the problem's direction, 0 .. 1 */
    int tile;     /* of the pattern */
};
struct point { /* of the gas */
    double alpha, p, u[3];
};

struct wall { /* of a closed side; NULL: slip and zeroGradient */
    const char *velocity, *temperature;
    double along, value; /* its velocity along the second axis, or along the first if it stands across that one */
    double specularity, restitution; /* of JohnsonJacksonSlip */
    double mu;                       /* coefficient of friction of packed gas; < 0: rough */
};

struct gate { /* of an open side; NULL: zeroGradient */
    const char *density, *velocity, *temperature;
    double rho, u[3], T; /* T: of the gas outside, or p */
    bool pressure, shut; /* shut: it is a wall all the same */
};

struct view;
struct problem {
    const struct problem *seen; /* the one that was drawn, if this is seen in another way (view.c); else NULL */
    const struct view *view;    /* NULL: as it was drawn */
    int family;
    uint64_t seed;
    int dim, n[3], cells;
    int components; /* of the velocity, if more than dim; else 0 */
    bool polyhedral;
    int radial;    /* axis along the radius of a body of revolution; -1: the box is what it is */
    double inner;  /* m: radius of its first faces; 0: they lie on the axis */
    int swirl;     /* component around the axis; 0: none */
    bool mirrored; /* is it the mirror image along the axis? */
    enum edge edge;
    enum shape shape; /* polyhedral: */
    double noise, stretch, squash, sliver;
    bool walls_along; /* closed along axis 0, whatever `edge` says */

    struct material material;
    const struct eos *eos;
    struct sources source;
    const struct transport *transport; /* and what it needs */
    struct own_params transport_params;
    const struct diffusion *diffusion;
    const struct acoustics *acoustics; /* NULL: explicit */
    struct own_params acoustics_params;
    const struct friction *friction; /* NULL: none */
    struct friction_params friction_params;
    double alpha_floor, densest; /* densest: alpha of a cell at most, in families with transport */
    struct wall wall[6];
    struct gate gate[6];
    int patience;    /* how many times as many steps as others it may take; 0: one */
    double through;  /* how many times what a cell holds may pass through it in a half step; 0: once */
    bool stated;     /* may it end with a stated cause other than a collapse? */
    double duration; /* in time steps of the initial state at maxCo 1: waves cross much of the box */
    double end;      /* s: the end, in place of duration; 0: that counts */
    int steps; /* it ends after this number of times the first step, if that is sooner than `end`; 0: it does not */

    double p0;               /* pressure scale, Pa */
    double direction[3];     /* unit */
    struct point side[2];    /* states that the family has drawn */
    double size, centre[3];  /* of what is in the box */
    int pattern;             /* cells a tile of the pattern */
    double wave[MAX_VAR][6]; /* phases and amplitudes of random fields */
};

enum { FAMILIES = 23 };
struct family {
    const char *name, *about;
    void (*draw)(struct problem *p, struct seed *s);
    void (*at)(const struct problem *p, const struct place *where, struct point *out);
};
extern const struct family family_table[FAMILIES];
int family_find(const char *name); /* -1: none */
/* Rows with transport (tests/stress/transport.c). */
void disks_draw(struct problem *p, struct seed *s);
void inelastic_draw(struct problem *p, struct seed *s);
void sections_draw(struct problem *p, struct seed *s);
void grains_at(const struct problem *p, const struct place *where, struct point *out);
void sections_at(const struct problem *p, const struct place *where, struct point *out);
/* Their parts, for others: what lies where; box; grains, equation of state and cooling; transport; walls. */
void grains_scene(struct problem *p, struct seed *s);
double grains_T(const struct problem *p); /* T that the others are measured by */
void inelastic_box(struct problem *p, struct seed *s);
void inelastic_material(struct problem *p, struct seed *s);
void inelastic_transport(struct problem *p, struct seed *s);
void inelastic_walls(struct problem *p, struct seed *s);
/* Rows of problems that might have no end (tests/stress/endless.c). */
void open_draw(struct problem *p, struct seed *s);
void extreme_draw(struct problem *p, struct seed *s);
void extreme_at(const struct problem *p, const struct place *where, struct point *out);
void gates_draw(struct problem *p, struct seed *s);
void settled_draw(struct problem *p, struct seed *s);
void settled_at(const struct problem *p, const struct place *where, struct point *out);
/* Rows with implicit acoustics (tests/stress/implicit.c). */
void implicit_draw(struct problem *p, struct seed *s);
void implicit_cells_draw(struct problem *p, struct seed *s);
void implicit_at(const struct problem *p, const struct place *where, struct point *out);
/* Their parts, for others: densities and pressures of a bed under thin gas, `dense` times as packed as it may be;
 * returns the gravity that it carries. One open side, the floor or one beside it, of given pressure at times. Shaken
 * gravity. */
double bed_lay(struct problem *p, double dense, double thin, double above);
void bed_drain(struct problem *p, struct seed *s, bool pressures);
void bed_shake(struct problem *p, struct seed *s, double pull);
/* The row with friction (tests/stress/friction.c). */
void friction_draw(struct problem *p, struct seed *s);
void friction_at(const struct problem *p, const struct place *where, struct point *out);
/* The row of bodies of revolution (tests/stress/round.c). */
void round_draw(struct problem *p, struct seed *s);
void round_at(const struct problem *p, const struct place *where, struct point *out);
/* The mirror image along the axis of one with cells along it: walls slip. */
struct problem problem_mirrored(const struct problem *p);

struct problem problem_draw(int family, uint64_t seed);
/* Takes from it all that time scheme `local` is not there for, and a lattice becomes polyhedra. Returns false if it
 * cannot: in 1D, and of bodies of revolution. */
bool problem_spare(struct problem *p);
/* The gas at a cell whose centre is x (fractions of the box): rho, u, T. */
void problem_state(const struct problem *p, const double x[3], double *rho, double u[3], double *T);
double problem_density(const struct problem *p, double alpha);
/* p and c^2 at eps = 1: both are linear in eps. */
void problem_per_energy(const struct problem *p, double alpha, double *pressure, double *c2);
/* Sound speed, m/s. */
double problem_sound(const struct problem *p, double alpha, double pressure);

/* The same problem, seen in other ways (view.c): in other units, mirrored, turned, with its cells in another order.
 * What comes of it must be the same. Bodies of revolution have a mirror image of their own (problem_mirrored). */
struct view {
    const char *name;
    double kg, m, s; /* how many new units one old unit has */
    int axis[3];     /* the old axis that lies along the new axis k */
    bool flip[3];    /* does the new axis k point the other way? */
    bool reversed;   /* of polyhedra: cells and faces in the opposite order */
    double jitter;   /* every value of the start and every coordinate is changed by this part of itself, up or down */
    double along;    /* m/s: velocity that all has besides, along the first axis that the mesh lacks */
};

/* The problem as it is seen; v and p are borrowed. */
struct problem problem_seen(const struct problem *p, const struct view *v);
/* The problem that was drawn. */
const struct problem *view_origin(const struct problem *p);
/* Of a lattice: the old axis, the old patch, the old cell of a new one. */
int view_axis(const struct problem *p, int axis);
int view_patch(const struct problem *p, int patch);
long view_cell(const struct problem *p, long cells, long cell);
/* Turns a vector to the new axes; no units. */
void view_turn(const struct problem *p, double x[3]);
/* Moves the points of polyhedra, and sorts their cells anew. place: [cells][3] the old centres, which are sorted, too.
 */
status view_mesh(const struct problem *p, struct polymesh *m, double *place);
/* A state of a cell of the start: from the old to the new one. cell: the old number. */
void view_start(const struct problem *p, long cell, double *rho, double u[3], double *T);
/* What the velocity `along` makes of the rules of a patch. */
void view_rules(const struct problem *p, struct patch_rules *rules);
/* An end state U[variables][cells] of new cells, as the one who drew the problem sees it: out[variables][cells]. */
void view_end(const struct problem *p, long cells, int variables, double *const U[MAX_VAR], double *out);

#endif
