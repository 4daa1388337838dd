/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Amplitudes of characteristic fields at faces: the cells of a stencil are projected on the eigenvectors of a face
 * (docs/physics.md 6.1), and each field is reconstructed from its upwind side (docs/physics.md 6.2). flux.c makes the
 * bases. */
#ifndef LIBCORE_CHARACTERISTIC_H
#define LIBCORE_CHARACTERISTIC_H

#include "libcore/schemes/flux.h"

enum { GROUP = 8 };                      /* faces that are kept together in a batch: a vector */
enum { MINUS, ENTROPY, PLUS, FAMILIES }; /* families of fields by their speeds: u - c; u (entropy and shears); u + c */
/* What faces have in common: bit k is set where some of them split the fields of family k; where none does, whether all
 * fields of all of them come from one side. */
enum faces_kind {
    SPLIT_MINUS = 1 << MINUS,
    SPLIT_ENTROPY = 1 << ENTROPY,
    SPLIT_PLUS = 1 << PLUS,
    SPLITS = SPLIT_MINUS | SPLIT_ENTROPY | SPLIT_PLUS,
    ALL_LEFT = 8,
    ALL_RIGHT = 16,
    MIXED = 32 /* neither of these */
};

struct bases { /* eigenbases of faces, as lines; b1 and b2 (docs/physics.md 6.1) are halved */
    ALIGNED double u[MAX_DIM][BATCH], c[BATCH], h[BATCH], half_b1[BATCH], half_b2[BATCH], half_inverse_c[BATCH];
    double inverse_b1[BATCH];
};
/* The speed of a field at a face: from which side it comes, or the speed alpha >= 0 of a Lax-Friedrichs split. */
#define UPWIND_LEFT  (-1.)
#define UPWIND_RIGHT (-2.)

struct winds { /* per family: UPWIND_LEFT, UPWIND_RIGHT, or the speed alpha >= 0 of a Lax-Friedrichs split */
    ALIGNED double speed[FAMILIES][BATCH];
};

struct fields { /* amplitudes of one cell in the fields u - c, entropy, shears, u + c */
    double minus, entropy, shear[2], plus;
};
struct eigenrows { /* left eigenvectors of one face */
    double u[MAX_DIM], half_b1, half_b2, half_inverse_c;
};

ALWAYS_INLINE struct eigenrows rows_at(const int dim, const struct bases *restrict b, int i) {
    struct eigenrows l = {{b->u[0][i], 0, 0}, b->half_b1[i], b->half_b2[i], b->half_inverse_c[i]};
    if (dim > 1) l.u[1] = b->u[1][i];
    if (dim > 2) l.u[2] = b->u[2][i];
    return l;
}

/* Projects cell i of q, with q_n in place of q[1][i], on the left eigenvectors. With s = (b2 q0 - b1 (u.q - q_E))/2 and
 * d = (q_n - u_n q0)/(2c), the rows of L (docs/physics.md 6.1) are l_- q = s - d,  l_0 q = q0 - 2 s,  l_j q = q_j - u_j
 * q0,  l_+ q = s + d. The compiler drops the fields that are not used. */
ALWAYS_INLINE struct fields project(const int dim, const struct eigenrows l, const double *const q[MAX_VAR], long i,
                                    double qn) {
    double q0 = q[0][i], work = fma(l.u[0], qn, -q[dim + 1][i]);
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

/* Takes the pressure of gas at rest from a line q of cells (f->rise): out[m] [n] gets cell m - 2 of the faces'
 * stencils. */
void faces_take_rest(const struct faces *f, const double *q, double (*out)[BATCH]);

/* Compute amplitudes of the nodal fluxes of faces, reconstructed by r; kind: of each group of faces. That of field v at
 * face i stands at v n + i in arrays of COLUMNS numbers, n faces in all. Of the faces from .. to - 1, on one basis a
 * face: */
enum { COLUMNS = 2 * MAX_VAR * BATCH };
void characteristic_common(const struct reconstruct *r, int from, int to, const int *kind, const struct faces *f,
                           const struct bases *b, const struct winds *w, double *a);
/* On two bases, b[0] of the left and b[1] of the right, the parts that come from these sides; where all fields of a
 * group come from one side, `left` holds them, whichever side it is. */
void characteristic_apart(const struct reconstruct *r, const int *kind, const struct faces *f, const struct bases *b,
                          const struct winds *w, double *left, double *right);

#endif
