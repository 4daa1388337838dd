/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of the bed, which its files share: lines of work memory and the parts of a step. */
#ifndef LIBCORE_BED_PRIVATE_H
#define LIBCORE_BED_PRIVATE_H

#include "libcore/acoustics/bed.h"
#include "libcore/multigrid/multigrid.h"

enum { BLUR_SUMS = 4 + MAX_DIM }; /* of each block (bed_blur.c) */
#define MOST_OUT 0.95             /* most of a cell's volume that may flow in, or out, in a step */

struct bed_lines {
    /* [cells + ghosts] of the start */
    double *rho, *u[MAX_DIM], *eps, *p, *c, *first_p; /* Newton's method moves p, first_p stays */
    double *start_p; /* [cells + ghosts] p of the cells at the start of the whole step */
    /* [cells + ghosts] of Newton's method: root rho and -tau' of (*), residual and diagonal times V, change of p */
    double *root, *slack, *residual, *diagonal, *change;
    /* [cells + ghosts] after acoustics: rho, u, eps; L - 1 */
    double *after[MAX_VAR], *growth;
    double *slope[MAX_DIM][MAX_VAR]; /* [cells + ghosts] limited derivatives of rho, u, eps along each axis, 1/m */
    /* [faces] U without pressures; dt/(rho_f d_f), 0 where U does not depend on p; pressure beyond the face; U;
     * p_f; of the cells on the left and on the right: P, and their heat, J/(m^2 s) */
    double *drift, *give, *beyond, *U, *p_face, *P[2], *heat[2];
    /* of friction; without it NULL: [faces] gain of U by it, traction (Pa) on the left side, of inner faces only where
     * it heats; [cells + ghosts] gain of u */
    double *push, *traction[MAX_DIM], *rubbed[MAX_DIM];
    /* the links of the linear system */
    int *link_first, *link;
    double *weight;
    /* of slopes on meshes other than boxes (bed_slopes.c): [sides][dim] 1/m, [cells][dim][dim]; are there slopes? */
    double *pull, *inverse;
    unsigned char *sloped; /* [cells] */
    bool weighed;          /* do these belong to the present set? */
    double *block_sums;    /* [blocks][BLUR_SUMS] */
    double *cells, *faces; /* the memory of the lines above */
    struct arrays arrays;
};

/* A face as one of its cells sees it. */
struct bed_side {
    int face, shape, right; /* right: is the cell on the right of the face? */
    double sign;            /* 1 or -1: a flux from left to right leaves the cell, or enters it */
};
ALWAYS_INLINE struct bed_side bed_side(const struct bed *b, int entry) {
    const int listed = b->set.face_of_cell[entry], right = listed < 0, face = right ? ~listed : listed;
    return (struct bed_side){face, b->set.shape[face], right, right ? -1 : 1};
}
ALWAYS_INLINE int bed_across(const struct bed *b, const struct bed_side *s) {
    return s->right ? b->set.left[s->face] : b->set.right[s->face];
}

/* Returns a.b of a vector of each shape, such as a normal, and b[dim]. On a lattice most components are 0. */
ALWAYS_INLINE double bed_along(const struct bed *b, double *const *vector, int shape, const double *with) {
    double sum = 0;
    for (int k = 0; k < b->dim; k++)
        if (vector[k][shape] != 0) sum += vector[k][shape] * with[k];
    return sum;
}

/* Returns P - p of a cell at a face. */
ALWAYS_INLINE double bed_weight(const struct bed *b, int face, int right, double rho, const double gravity[MAX_DIM]) {
    const double weight = rho * bed_along(b, b->set.shapes->arm[right], b->set.shape[face], gravity);
    return b->set.balanced ? weight + b->set.balance[right][face] : weight;
}

/* Returns u.n of a cell. */
ALWAYS_INLINE double bed_normal_speed(const struct bed *b, double *const *u, int cell, int shape) {
    double *const *normal = b->set.shapes->normal, sum = 0;
    for (int k = 0; k < b->dim; k++)
        if (normal[k][shape] != 0) sum += normal[k][shape] * u[k][cell];
    return sum;
}

/* Returns the area with which a face pushes a cell along an axis, over its area: along the radius of a body of
 * revolution that in the plane, at the radius of the cell. */
ALWAYS_INLINE double bed_tilt(const struct bed *b, int shape, int cell, int axis) {
    const struct bed_shapes *h = b->set.shapes;
    if (!h->round || axis != h->round->radial) return 1;
    return h->round->radius[b->set.body[cell]] * h->round->flat[shape] / h->area[shape];
}
/* Returns u.n of a cell at a face, by these areas: with it the pressure on the face works on the cell. */
ALWAYS_INLINE double bed_pushed_speed(const struct bed *b, double *const *u, int cell, int shape) {
    double *const *normal = b->set.shapes->normal, sum = 0;
    for (int k = 0; k < b->dim; k++)
        if (normal[k][shape] != 0) sum += normal[k][shape] * u[k][cell] * bed_tilt(b, shape, cell, k);
    return sum;
}

/* Returns the difference between a variable's value at a face and in the cell, by the cell's slopes. */
ALWAYS_INLINE double bed_reach(const struct bed *b, const struct bed_side *s, int cell, int variable) {
    double *const *arm = b->set.shapes->arm[s->right], sum = 0;
    for (int k = 0; k < b->dim; k++)
        if (arm[k][s->shape] != 0) sum += arm[k][s->shape] * b->lines->slope[k][variable][cell];
    return sum;
}

/* Returns the difference between a variable's mean over dt at a place that gas of the velocity u passes, and its value
 * there at the start, by the cell's slopes. */
ALWAYS_INLINE double bed_drift(const struct bed *b, double *const *u, double dt, int cell, int variable) {
    double sum = 0;
    for (int k = 0; k < b->dim; k++) sum += u[k][cell] * b->lines->slope[k][variable][cell];
    return -0.5 * dt * sum;
}

/* Copies n <= components + 2 lines of this rank's cells to the ghosts of the same lines; collective. Nothing is done on
 * one rank, where halo is NULL. */
void bed_fill(const struct bed *b, int n, double *const *line);
/* The same of one line in two parts: between them the cells may be read, and nothing else is sent. */
void bed_fill_send(const struct bed *b, int n, const double *const *line);
void bed_fill_receive(const struct bed *b, int n, double *const *line);
void bed_halo_free(struct bed_halo *h);
/* Learns of the ghosts, of which each lies across a face of a cell: number[ghosts] over all ranks, of which
 * first[rank] is the first on each rank. */
status bed_halo_link(struct bed *b, const int *first, const int *number);
/* Make room in a set for that number of blocks; for its cells and ghosts, faces and entries of face_of_cell. */
status bed_set_blocks(struct bed_set *s, int blocks);
status bed_set_size(const struct bed *b, struct bed_set *s, int faces, int sides);
/* Sets `body` of boxes of a body of revolution, by the shapes of their faces. */
void bed_find_bodies(struct bed_set *s);
/* Readies the set for a step: lists, states and primitive variables. Collective. */
status bed_ready(struct bed *b);
/* Finds what bed_warms needs on meshes other than boxes: the work of the faces' stresses on the mean of the velocities
 * u and `end`. Collective. */
void bed_find_work(const struct bed *b, double *const *end);
/* Returns the heat (J/m^3) of the gas by the sliding of a cell's grains over dt: `heating` of the work of the faces'
 * tractions on the differences of velocity across them, half of it on either side. end: [cells + ghosts] velocities at
 * the end; more: J/m^3 that friction takes besides. */
double bed_warms(const struct bed *b, double dt, int i, double *const *end, double more);
/* Adds the tractions of walls, and their work, to the fluxes through them. */
void bed_add_tractions(struct bed *b);
/* bed_deal.c. On one rank these do nothing; else they are collective. */
status bed_deal_make(struct bed *b);
void bed_deal_free(struct bed_deal *d);
status bed_deal_blocks(struct bed *b, int sides); /* gathers the blocks of all homes, deals them, numbers the cells */
status bed_deal_lists(struct bed *b);             /* makes b->set of what the homes have written */
void bed_deal_states(struct bed *b);              /* from b->home to b->set */
void bed_deal_results(struct bed *b);             /* back */
void bed_deal_pushed(struct bed *b);              /* back: `pushed` alone */
void bed_find_links(struct bed *b);               /* of the linear system */
/* Finds p, U and root of the step; *done as bed_step. again: x->p is a result of this step. */
status bed_find_pressure(struct bed *b, double dt, const double gravity[MAX_DIM], bool again, bool *done);
void bed_find_start(struct bed *b); /* start_p */
/* Returns the energy (J/m^3) that a cell and those beside it had at the start: a cell that is lifted by more shows that
 * the step is far too long for what hits it. */
double bed_energy_near(const struct bed *b, int cell);
/* Finds the limited slopes of the variables first <= v < end of `of` (rho, u, eps), in the cells of this rank: mirrored
 * at walls; 0 in cells beside faces that lead out of the bed otherwise. dt > 0: the slopes are for what flows out over
 * dt (bed_drift); else, on boxes, derivatives of velocities along their own axes are all that is found. */
void bed_slopes(struct bed *b, double *const *of, int first, int end, double dt);
/* Finds p_face and the state `after` acoustics. Returns whether no cell of this rank was lifted too much. */
bool bed_update(struct bed *b, double dt, const double gravity[MAX_DIM]);
/* Finds b->blur and the peaks, behind bed_update. Collective. */
void bed_find_blur(struct bed *b, double dt, const double gravity[MAX_DIM]);
/* Carries the state with U and puts the result into b->set.U. Returns whether no cell of this rank gains or loses too
 * much. */
bool bed_remap(struct bed *b, double dt);

#endif
