/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction in the step of a bed, between its files (bed_friction.c; docs/physics.md 9.3). */
#ifndef LIBCORE_BED_FRICTION_PRIVATE_H
#define LIBCORE_BED_FRICTION_PRIVATE_H

#include "libcore/acoustics/bed_private.h"

enum { TENSOR = 6, LINES = 3 };

struct askew_face {             /* of the left and the right cell of a face (bed_adjoint.c) */
    double w[2], c[2][MAX_DIM]; /* the part of G on the face, and m: what is taken from the jump */
    double on[2];               /* weight of the cell's extrapolation in the velocity of the face */
};

struct bed_friction {
    int tensors; /* numbers of a stress */
    /* [cells + ghosts] s, pressure, share of what is held; dt F/rho and its friction: gains of velocity */
    double *share, *p, *held, *drive[MAX_DIM], *gain[LINES][MAX_DIM];
    double *V[MAX_DIM], *gradient[MAX_DIM][MAX_DIM]; /* [cells + ghosts] [axis][component] */
    double *fit[MAX_DIM];                            /* [sides] derivative = sum of fit times differences */
    double *stiff;                                   /* [faces] 2 th G dt */
    double *base[TENSOR], *traction[MAX_DIM];        /* [faces] th tau; tau' n in a stage */
    double *through[LINES][MAX_DIM];                 /* [faces] where it is wanted: their traction, as gain */
    double *part, *bears;                            /* [faces] th; Pa, the most that friction can bear there */
    double *hoop; /* [faces] of bodies of revolution: tau' around the axis in a stage; else NULL */
    /* Meshes other than boxes (bed_adjoint.c), else NULL: [cells + ghosts] the matrices of `fit`, in rows of the
     * upper half; [faces] velocity, then the force on it; tau' in a stage */
    double *inverse[TENSOR], *value[MAX_DIM], *tensor[TENSOR], *mean[LINES][TENSOR]; /* mean: of the stages, for heat */
    struct askew_face *askew;                                                        /* [faces] */
    double (*back)[MAX_DIM]; /* [sides] what `fit` of the cell across is for the difference across the side */
    int last;                /* line of the result */
    int *face, faces;        /* those with friction */
    double *cells, *sides, *of_faces, *askew_cells, *askew_faces; /* the memory of the lines */
    struct arrays arrays;
};

struct sizes { /* solved axes, components of the velocity: constants in the loops of the stages, which so unroll */
    int dim, components;
};
/* Calls a function of the bed, V and sizes with the bed's sizes. */
#define WITH_SIZES(function, b, V)                                                                                     \
    switch (4 * (b)->dim + (b)->components) {                                                                          \
    case 5:                                                                                                            \
        function(b, V, (struct sizes){1, 1});                                                                          \
        break;                                                                                                         \
    case 6:                                                                                                            \
        function(b, V, (struct sizes){1, 2});                                                                          \
        break;                                                                                                         \
    case 7:                                                                                                            \
        function(b, V, (struct sizes){1, 3});                                                                          \
        break;                                                                                                         \
    case 10:                                                                                                           \
        function(b, V, (struct sizes){2, 2});                                                                          \
        break;                                                                                                         \
    case 11:                                                                                                           \
        function(b, V, (struct sizes){2, 3});                                                                          \
        break;                                                                                                         \
    default:                                                                                                           \
        function(b, V, (struct sizes){3, 3});                                                                          \
    }

/* What bodies of revolution have in their plane, others as they are: the area of a face, the volume of a cell, and from
 * the centre of the cell on the left or right of a face to its middle. */
ALWAYS_INLINE double bed_flat_area(const struct bed *b, int shape) {
    const struct bed_round *round = b->set.shapes->round;
    return round ? round->flat[shape] : b->set.shapes->area[shape];
}
ALWAYS_INLINE double bed_flat_volume(const struct bed *b, int cell) {
    const struct bed_round *round = b->set.shapes->round;
    const double volume = b->set.shapes->volume[b->set.body[cell]];
    return round ? volume / round->radius[b->set.body[cell]] : volume;
}
ALWAYS_INLINE double *const *bed_middle(const struct bed *b, int right) {
    const struct bed_round *round = b->set.shapes->round;
    return round ? round->mid[right] : b->set.shapes->arm[right];
}

struct face_view { /* a face with friction */
    int face, left, right, shape;
    double n[MAX_DIM], to[MAX_DIM], depth; /* normal; between the centres, or from the centre to the wall */
};
ALWAYS_INLINE struct face_view bed_view(const struct bed *b, int f, const int dim) {
    const struct bed_shapes *s = b->set.shapes;
    const int shape = b->set.shape[f];
    struct face_view v = {.face = f, .left = b->set.left[f], .right = b->set.right[f], .shape = shape};
    const bool inner = b->set.kind[f] == BED_INNER, right = v.left < 0;
    double *const *const mid[2] = {bed_middle(b, 0), bed_middle(b, 1)};
    v.depth = inner ? s->depth[0][shape] + s->depth[1][shape] : s->depth[right][shape];
    for (int k = 0; k < dim; k++) {
        v.n[k] = s->normal[k][shape];
        v.to[k] = inner ? mid[0][k][shape] - mid[1][k][shape] : (right ? -mid[1][k][shape] : mid[0][k][shape]);
    }
    return v;
}

/* Does friction act on a face between cells, or on a wall? */
static inline bool bed_rubs_at(const struct bed *b, int f) {
    return b->set.kind[f] == BED_INNER || (b->set.kind[f] == BED_WALL && b->set.wall_friction[f] > 0);
}

/* Does a wall hold the gas at it in every direction? Other walls do so across themselves, without a stress of friction,
 * for muWall bounds what they bear. */
static inline bool bed_is_rough(const struct bed *b, int f) {
    return b->set.kind[f] == BED_WALL && b->set.wall_friction[f] == HUGE_VAL;
}

/* Returns the part that the hoop component of a face has in the volume of one of its cells, over the cell's radius. By
 * the parts of all its faces a cell has its area in the plane. */
ALWAYS_INLINE double hoop_share(const struct bed *b, int shape, int right, int cell) {
    const struct bed_shapes *h = b->set.shapes;
    return h->area[shape] * h->depth[right][shape] / (b->dim * h->round->radius[b->set.body[cell]]);
}

/* Faces of boxes on patches other than rough walls have no hoop stress: they bear pressure and a traction alone.
 * Returns how much more that of the other faces of a cell counts for it. */
static inline double hoop_instead(const struct bed *b, int i) {
    double all = 0, with = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double share = hoop_share(b, s.shape, s.right, i);
        all += share;
        with += b->set.kind[s.face] == BED_INNER || bed_is_rough(b, s.face) ? share : 0;
    }
    return with > 0 ? all / with : 1;
}

status bed_friction_make(struct bed *b); /* nothing, if the bed has no law of friction */
void bed_friction_free(struct bed_friction *r);
status bed_friction_room(const struct bed *b, struct bed_friction *r); /* for the cells and faces that the bed has */
/* Gradients of the velocity in cells (bed_strain.c): bed_fit_cell finds the numbers that bed_find_gradients, which is
 * collective, sums with, for b->rub->gradient. */
void bed_fit_cell(const struct bed *b, int i);
/* Returns the weight of what is across a side, and sets `to`, from the cell's centre to there. */
double bed_fit_weight(const struct bed *b, const struct bed_side *s, int across, double to[MAX_DIM]);
void bed_find_gradients(const struct bed *b, double *const *V);
/* Meshes other than boxes (bed_adjoint.c): turn the gradients that are exact for linear velocities into those by
 * Gauss's theorem; find the jump and the gradient on a face; after `tensor` and `traction` are known, make ready for
 * and find the force (N, over the common factor) of friction on a cell. */
void bed_weigh_askew(const struct bed *b); /* finds `askew` and `back`, which hold as long as the shares of cells do */
void bed_gauss_gradients(const struct bed *b, double *const *V);
void bed_look_askew(const struct bed *b, const struct face_view *v, double *const *V, double jump[MAX_DIM],
                    double mean[MAX_DIM][MAX_DIM]);
void bed_find_pull(const struct bed *b);
void bed_pull(const struct bed *b, int i, double force[MAX_DIM]);
/* Finds the traction (Pa) of a rough wall on the gas, from left to right. */
void bed_wall_pull(const struct bed *b, int f, double traction[MAX_DIM]);
/* Finds what friction does over dt: lines rubbed, push and traction. Its pressures are those of b->set.pressure.
 * driven: are weight and pressure to act in the same step? *done: false, on all ranks, if dt is too long. Collective.
 */
status bed_rub(struct bed *b, double dt, const double gravity[MAX_DIM], bool driven, bool *done);
/* Moves the stress on, b->set.stress, behind bed_rub; nothing without friction. */
void bed_move_stress(struct bed *b, const double gravity[MAX_DIM]);

#endif
