/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects the cells of a stencil on the eigenvectors of a face (docs/physics.md 6.1) and reconstructs the projected
 * fields from their upwind sides (docs/physics.md 6.2), in one loop over the faces: flux.c makes the bases,
 * reconstruct.c instantiates the loops below for each row of its table. */
#ifndef LIBCORE_CHARACTERISTIC_H
#define LIBCORE_CHARACTERISTIC_H

#include "libcore/schemes/flux.h"

enum { MINUS, ENTROPY, PLUS, FAMILIES }; /* families of fields by their speeds: u - c; u (entropy and shears); u + c */
#define UPWIND_LEFT  (-1.)
#define UPWIND_RIGHT (-2.)
/* What faces have in common: bit k is set where some of them split the fields of family k; where none does, whether all
 * fields of all of them come from one side. */
enum faces_kind {
    SPLIT_MINUS = 1 << MINUS,
    SPLIT_ENTROPY = 1 << ENTROPY,
    SPLIT_PLUS = 1 << PLUS,
    SPLITS = SPLIT_MINUS | SPLIT_ENTROPY | SPLIT_PLUS,
    ALL_LEFT = 8,
    ALL_RIGHT = 16
};

struct bases { /* eigenbases of faces, as lines; b1 and b2 (docs/physics.md 6.1) are halved */
    ALIGNED double u[MAX_DIM][BATCH], c[BATCH], h[BATCH], half_b1[BATCH], half_b2[BATCH], half_inverse_c[BATCH];
    double inverse_b1[BATCH];
};
struct winds { /* per family: UPWIND_LEFT, UPWIND_RIGHT, or the speed alpha >= 0 of a Lax-Friedrichs split */
    ALIGNED double speed[FAMILIES][BATCH];
};

/* Returns the value of one field at the right face of cell c, from five cells in a row. */
typedef double face_value(double a, double b, double c, double d, double e);

struct fields { /* amplitudes of one cell in the fields u - c, entropy, shears, u + c */
    double minus, entropy, shear[2], plus;
};
struct rows { /* left eigenvectors of one face */
    double u[MAX_DIM], half_b1, half_b2, half_inverse_c;
};

ALWAYS_INLINE struct rows rows_at(const int dim, const struct bases *restrict b, int i) {
    struct rows l = {{b->u[0][i], 0, 0}, b->half_b1[i], b->half_b2[i], b->half_inverse_c[i]};
    if (dim > 1) l.u[1] = b->u[1][i];
    if (dim > 2) l.u[2] = b->u[2][i];
    return l;
}

/* Projects cell i of q, less the pressure P in q_n, on the left eigenvectors. With s = (b2 q0 - b1 (u.q - q_E))/2 and d
 * = (q_n - u_n q0)/(2c), the rows of L (docs/physics.md 6.1) are l_- q = s - d,  l_0 q = q0 - 2 s,  l_j q = q_j - u_j
 * q0,  l_+ q = s + d. */
ALWAYS_INLINE struct fields project(const int dim, const struct rows l, const double *const q[MAX_VAR], long i,
                                    double P) {
    double q0 = q[0][i], qn = q[1][i] - P, work = fma(l.u[0], qn, -q[dim + 1][i]);
    struct fields w = {0};
    if (dim == 2) work += l.u[1] * q[2][i];
    if (dim == 3) work += l.u[1] * q[2][i] + l.u[2] * q[3][i];
    double s = fma(l.half_b2, q0, -(l.half_b1 * work)), d = fma(-l.u[0], q0, qn);
    w.minus = fma(-d, l.half_inverse_c, s);
    w.entropy = fma(-2, s, q0);
    if (dim > 1) w.shear[0] = fma(-l.u[1], q0, q[2][i]);
    if (dim > 2) w.shear[1] = fma(-l.u[2], q0, q[3][i]);
    w.plus = fma(d, l.half_inverse_c, s);
    return w;
}

struct rest { /* the pressure of gas at rest in the six cells of a stencil, 0 where none is taken */
    double P[6];
};
/* Where `on` is 0 or 1 its products are exact. */
ALWAYS_INLINE struct rest rest_at(const bool balanced, const struct faces *f, int i, long stride) {
    struct rest r = {{0}};
    if (!balanced) return r;
    r.P[2] = f->base[0][i];
    r.P[1] = fma(-f->on[i], f->rise[i - stride], r.P[2]);
    r.P[0] = fma(-f->on[i], f->rise[i - 2 * stride], r.P[1]);
    r.P[3] = f->base[1][i];
    r.P[4] = fma(f->on[i], f->rise[i + stride], r.P[3]);
    r.P[5] = fma(f->on[i], f->rise[i + 2 * stride], r.P[4]);
    return r;
}
/* The same from one side: beyond the face the stencil is read backwards. */
ALWAYS_INLINE struct rest rest_from(const bool balanced, const struct faces *f, int i, double side) {
    struct rest r = rest_at(balanced, f, i, f->stride), back = r;
    for (int m = 0; m < 6; m++) back.P[m] = r.P[5 - m];
    return side > 0 ? r : back;
}

/* The fields of the six cells of a stencil; the compiler drops the cells that a reconstruction does not use. */
#define PROJECT_STENCIL(dim, l, q, i, stride, r)                                                                       \
    {                                                                                                                  \
        project(dim, l, q, (i)-2 * (stride), (r).P[0]), project(dim, l, q, (i) - (stride), (r).P[1]),                  \
            project(dim, l, q, i, (r).P[2]), project(dim, l, q, (i) + (stride), (r).P[3]),                             \
            project(dim, l, q, (i) + 2 * (stride), (r).P[4]), project(dim, l, q, (i) + 3 * (stride), (r).P[5])         \
    }
#define NO_REST            ((struct rest){{0}})
#define LEFT_OF(w, field)  w[0].field, w[1].field, w[2].field, w[3].field, w[4].field
#define RIGHT_OF(w, field) w[5].field, w[4].field, w[3].field, w[2].field, w[1].field
#define ALL_OF(w, field)   LEFT_OF(w, field), w[5].field

struct lines { /* the lines that the loops read, as local pointers */
    const double *flux[MAX_VAR], *state[MAX_VAR];
};
ALWAYS_INLINE struct lines lines_of(const struct faces *f, const int dim, long offset) {
    struct lines l = {{0}, {0}};
    for (int v = 0; v < dim + 2; v++) {
        l.flux[v] = f->flux[v] + offset;
        l.state[v] = f->state[v] + offset;
    }
    return l;
}

/* Has all bits set where a field comes from the right. */
ALWAYS_INLINE uint64_t from_right(double speed) {
    return -(uint64_t)(speed == UPWIND_RIGHT);
}
/* Returns a field's face value from its upwind side. */
ALWAYS_INLINE double upwind_value(face_value *value, uint64_t right, double a, double b, double c, double d, double e,
                                  double f) {
    return value(select_masked(right, f, a), select_masked(right, e, b), select_masked(right, d, c),
                 select_masked(right, c, d), select_masked(right, b, e));
}

/* Computes the amplitudes a[field] at faces that split no field. */
ALWAYS_INLINE void upwind(const int dim, const bool balanced, face_value *value, int from, int to,
                          const struct faces *f, const struct bases *restrict b, const struct winds *restrict w,
                          double (*restrict a)[BATCH]) {
    const struct lines q = lines_of(f, dim, 0);
    const long stride = f->stride;
    EACH_ALONE
    for (int i = from; i < to; i++) {
        const struct rows l = rows_at(dim, b, i);
        const struct rest rest = rest_at(balanced, f, i, stride);
        const struct fields phi[6] = PROJECT_STENCIL(dim, l, q.flux, i, stride, rest);
        const uint64_t entropy = from_right(w->speed[ENTROPY][i]);
        a[0][i] = upwind_value(value, from_right(w->speed[MINUS][i]), ALL_OF(phi, minus));
        a[1][i] = upwind_value(value, entropy, ALL_OF(phi, entropy));
        if (dim > 1) a[2][i] = upwind_value(value, entropy, ALL_OF(phi, shear[0]));
        if (dim > 2) a[3][i] = upwind_value(value, entropy, ALL_OF(phi, shear[1]));
        a[dim + 1][i] = upwind_value(value, from_right(w->speed[PLUS][i]), ALL_OF(phi, plus));
    }
}

/* Returns the left eigenvectors of the side that a family of fields comes from, of bases b[0] left, b[1] right. */
ALWAYS_INLINE struct rows rows_of_side(const int dim, const struct bases *restrict b, int i, uint64_t right) {
    const struct rows l = rows_at(dim, &b[0], i), r = rows_at(dim, &b[1], i);
    struct rows x = {.half_b1 = select_masked(right, r.half_b1, l.half_b1),
                     .half_b2 = select_masked(right, r.half_b2, l.half_b2)};
    x.half_inverse_c = select_masked(right, r.half_inverse_c, l.half_inverse_c);
    for (int k = 0; k < dim; k++) x.u[k] = select_masked(right, r.u[k], l.u[k]);
    return x;
}

/* Returns the face values of all fields as if they came from one side, on its basis; the compiler drops the fields that
 * are not used. */
ALWAYS_INLINE struct fields values_of_side(const int dim, face_value *value, const struct rows l,
                                           const double *const q[MAX_VAR], long i, long stride, const struct rest rest,
                                           uint64_t right) {
    const struct fields phi[6] = PROJECT_STENCIL(dim, l, q, i, stride, rest);
    return (struct fields){
        .minus = upwind_value(value, right, ALL_OF(phi, minus)),
        .entropy = upwind_value(value, right, ALL_OF(phi, entropy)),
        .shear = {upwind_value(value, right, ALL_OF(phi, shear[0])), upwind_value(value, right, ALL_OF(phi, shear[1]))},
        .plus = upwind_value(value, right, ALL_OF(phi, plus))};
}

ALWAYS_INLINE void keep_side(uint64_t right, double value, double *restrict left, double *restrict right_side) {
    *left = select_masked(right, 0, value);
    *right_side = select_masked(right, value, 0);
}

/* Computes the amplitudes that come from the left and from the right at faces with two bases that split no field: each
 * field once, on the basis of its side, and 0 for the other. */
ALWAYS_INLINE void apart(const int dim, const bool balanced, face_value *value, int from, int to, const struct faces *f,
                         const struct bases *restrict b, const struct winds *restrict w, double (*restrict left)[BATCH],
                         double (*restrict right)[BATCH]) {
    const struct lines q = lines_of(f, dim, 0);
    const long stride = f->stride;
#define SIDE(side)                   values_of_side(dim, value, rows_of_side(dim, b, i, side), q.flux, i, stride, rest, side)
#define KEEP(field, side, from_side) keep_side(side, from_side, &left[field][i], &right[field][i])
    EACH_ALONE
    for (int i = from; i < to; i++) {
        const struct rest rest = rest_at(balanced, f, i, stride);
        const uint64_t minus = from_right(w->speed[MINUS][i]), entropy = from_right(w->speed[ENTROPY][i]);
        const uint64_t plus = from_right(w->speed[PLUS][i]);
        const struct fields middle = SIDE(entropy);
        KEEP(0, minus, SIDE(minus).minus);
        KEEP(1, entropy, middle.entropy);
        if (dim > 1) KEEP(2, entropy, middle.shear[0]);
        if (dim > 2) KEEP(3, entropy, middle.shear[1]);
        KEEP(dim + 1, plus, SIDE(plus).plus);
    }
#undef SIDE
#undef KEEP
}

/* Returns the part of a field that comes from one side (+1: left, -1: right): the face value of (phi + side alpha w)/2
 * where the face splits the field with the speed alpha, else of phi, or 0 where the field comes from the other side. */
ALWAYS_INLINE double side_value(face_value *value, double speed, double side, double a, double b, double c, double d,
                                double e, double wa, double wb, double wc, double wd, double we) {
    bool split = speed >= 0;
    double part = split ? 0.5 : 1, alpha = split ? side * (0.5 * speed) : 0;
    double v = value(fma(alpha, wa, part * a), fma(alpha, wb, part * b), fma(alpha, wc, part * c),
                     fma(alpha, wd, part * d), fma(alpha, we, part * e));
    return speed == (side > 0 ? UPWIND_RIGHT : UPWIND_LEFT) ? 0 : v;
}

/* Computes the amplitudes at faces that split fields on one basis: of the families of `splits` the parts of both sides,
 * of the others their upwind sides. Where one family of sound alone is split, that is the family `first`, which takes
 * the place of MINUS: with 1/c of the other sign both change places, to the bit. */
ALWAYS_INLINE void split(const int dim, const bool balanced, face_value *value, const int splits, int from, int to,
                         int first, const struct faces *f, const struct bases *restrict b,
                         const struct winds *restrict w, double (*restrict a)[BATCH]) {
    const struct lines q = lines_of(f, dim, 0);
    const long stride = f->stride;
    const double *first_speed = w->speed[first], *last_speed = w->speed[PLUS - first], sign = 1 - first;
    double *first_a = a[first == MINUS ? 0 : dim + 1], *last_a = a[first == MINUS ? dim + 1 : 0];
#define BOTH(speed, field)                                                                                             \
    (side_value(value, speed, 1, LEFT_OF(phi, field), LEFT_OF(state, field)) +                                         \
     side_value(value, speed, -1, RIGHT_OF(phi, field), RIGHT_OF(state, field)))
#define FIELD(family, speed, field)                                                                                    \
    (splits & (family) ? BOTH(speed, field) : upwind_value(value, from_right(speed), ALL_OF(phi, field)))
    EACH_ALONE
    for (int i = from; i < to; i++) {
        struct rows l = rows_at(dim, b, i);
        if (splits != SPLITS) l.half_inverse_c *= sign;
        const struct rest rest = rest_at(balanced, f, i, stride);
        const struct fields phi[6] = PROJECT_STENCIL(dim, l, q.flux, i, stride, rest);
        const struct fields state[6] = PROJECT_STENCIL(dim, l, q.state, i, stride, NO_REST);
        double entropy = w->speed[ENTROPY][i];
        first_a[i] = FIELD(SPLIT_MINUS, first_speed[i], minus);
        a[1][i] = FIELD(SPLIT_ENTROPY, entropy, entropy);
        if (dim > 1) a[2][i] = FIELD(SPLIT_ENTROPY, entropy, shear[0]);
        if (dim > 2) a[3][i] = FIELD(SPLIT_ENTROPY, entropy, shear[1]);
        last_a[i] = FIELD(SPLIT_PLUS, last_speed[i], plus);
    }
#undef BOTH
#undef FIELD
}

/* Computes the part of the amplitudes that comes from one side (+1: from the left, -1: from the right). */
ALWAYS_INLINE void sided(const int dim, const bool balanced, face_value *value, int from, int to, const struct faces *f,
                         const struct bases *restrict b, const struct winds *restrict w, double side,
                         double (*restrict a)[BATCH]) {
    const struct lines q = lines_of(f, dim, side > 0 ? 0 : f->stride);
    const long stride = side > 0 ? f->stride : -f->stride;
#define ONE(speed, field) side_value(value, speed, side, LEFT_OF(phi, field), LEFT_OF(state, field))
    EACH_ALONE
    for (int i = from; i < to; i++) {
        const struct rows l = rows_at(dim, b, i);
        const struct rest rest = rest_from(balanced, f, i, side);
        const struct fields phi[6] = PROJECT_STENCIL(dim, l, q.flux, i, stride, rest);
        const struct fields state[6] = PROJECT_STENCIL(dim, l, q.state, i, stride, NO_REST);
        double minus = w->speed[MINUS][i], entropy = w->speed[ENTROPY][i], plus = w->speed[PLUS][i];
        a[0][i] = ONE(minus, minus);
        a[1][i] = ONE(entropy, entropy);
        if (dim > 1) a[2][i] = ONE(entropy, shear[0]);
        if (dim > 2) a[3][i] = ONE(entropy, shear[1]);
        a[dim + 1][i] = ONE(plus, plus);
    }
#undef ONE
}

#endif
