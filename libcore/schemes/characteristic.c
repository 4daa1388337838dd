/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characteristic upwinding (docs/physics.md 6.2): projects the stencils of faces on eigenbases and reconstructs field
 * by field from the upwind side. With s and d (halves of the sound, see project) in the cells of the stencils, which
 * stay in the cache, each field is a factor of the face times one line plus another: no loop here knows a
 * reconstruction, and none of a reconstruction knows the dimension. */
#include "libcore/schemes/flux_private.h"

enum { CELLS = 6, LEFT = 2 }; /* cells of a stencil; place of the left one */
static const ALIGNED double ones[BATCH] = {
#define EIGHT 1, 1, 1, 1, 1, 1, 1, 1
    EIGHT, EIGHT, EIGHT, EIGHT, EIGHT,
    EIGHT, EIGHT, EIGHT
#undef EIGHT
};

struct sound { /* s and d in the cells of stencils */
    ALIGNED double s[CELLS][BATCH], d[CELLS][BATCH];
};

struct rest { /* the lines of struct faces that hold the pressure of gas at rest */
    const double *left, *right, *rise, *on;
    long stride;
};
ALWAYS_INLINE struct rest rest_of(const struct faces *f) {
    return (struct rest){f->base[0], f->base[1], f->rise, f->on, f->stride};
}
/* Sets P to this pressure in the cells of the stencil of face i. Where `on` is 0 or 1 the products are exact. */
ALWAYS_INLINE void rest_at(const struct rest *r, int i, double P[CELLS]) {
    const long s = r->stride;
    P[2] = r->left[i];
    P[1] = fma(-r->on[i], r->rise[i - s], P[2]);
    P[0] = fma(-r->on[i], r->rise[i - 2 * s], P[1]);
    P[3] = r->right[i];
    P[4] = fma(r->on[i], r->rise[i + s], P[3]);
    P[5] = fma(r->on[i], r->rise[i + 2 * s], P[4]);
}

/* Projects `cells` cells of the stencils of faces; calm: without the pressure of gas at rest. */
ALWAYS_INLINE void sounds_dim(const int dim, const int cells, const bool calm, int from, int to, const struct faces *f,
                              const struct bases *restrict b, const double *const q[MAX_VAR],
                              struct sound *restrict out) {
    const int first = LEFT + 1 - cells / 2;
    const double *q0 = q[0], *qn = q[1], *q2 = dim > 1 ? q[2] : q0, *q3 = dim > 2 ? q[3] : q0, *E = q[dim + 1];
    const struct rest rest = rest_of(f);
    const long stride = f->stride;
    EACH_ALONE
    for (int i = from; i < to; i++) {
        const double u0 = b->u[0][i], u1 = dim > 1 ? b->u[1][i] : 0, u2 = dim > 2 ? b->u[2][i] : 0;
        const double half_b1 = b->half_b1[i], half_b2 = b->half_b2[i];
        double P[CELLS] = {0};
        if (calm) rest_at(&rest, i, P);
        for (int k = first; k < first + cells; k++) {
            const long m = i + (k - LEFT) * stride;
            const double momentum = qn[m] - P[k];
            double work = fma(u0, momentum, -E[m]);
            if (dim == 2) work += u1 * q2[m];
            if (dim == 3) work += u1 * q2[m] + u2 * q3[m];
            out->s[k][i] = fma(half_b2, q0[m], -(half_b1 * work));
            out->d[k][i] = fma(-u0, q0[m], momentum);
        }
    }
}

#define SOUNDS(name, cells, calm)                                                                                      \
    KERNEL static void name(int from, int to, const struct faces *f, const struct bases *restrict b,                   \
                            const double *const q[MAX_VAR], struct sound *restrict out) {                              \
        if (f->dim == 1) sounds_dim(1, cells, calm, from, to, f, b, q, out);                                           \
        if (f->dim == 2) sounds_dim(2, cells, calm, from, to, f, b, q, out);                                           \
        if (f->dim == 3) sounds_dim(3, cells, calm, from, to, f, b, q, out);                                           \
    }
SOUNDS(sounds_two, 2, false)
SOUNDS(sounds_four, 4, false)
SOUNDS(sounds_six, 6, false)
SOUNDS(calm_two, 2, true)
SOUNDS(calm_four, 4, true)
SOUNDS(calm_six, 6, true)

KERNEL static void take_rest(const struct faces *f, const double *q, double (*restrict out)[BATCH]) {
    const struct rest rest = rest_of(f);
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        double P[CELLS];
        rest_at(&rest, i, P);
        for (int k = 0; k < CELLS; k++) out[k][i] = q[i + (k - LEFT) * rest.stride] - P[k];
    }
}
void faces_take_rest(const struct faces *f, const double *q, double (*out)[BATCH]) {
    take_rest(f, q, out);
}

struct projection { /* of the fluxes or states of faces of a batch on a basis */
    const struct faces *f;
    const double *const *q;
    const struct bases *b;
    struct sound sound;
};

/* The end of the run of groups that starts at face `from` and is alike in the bits `same` of their kinds. */
static int run_end(int to, const int *kind, int same, int from) {
    int end = from + GROUP;
    while (end < to && (kind[end / GROUP] & same) == (kind[from / GROUP] & same)) end += GROUP;
    return end < to ? end : to;
}

/* Projects the faces from .. to - 1; calm: without the pressure of gas at rest. project_groups leaves out the groups
 * whose kinds have none of `bits`. */
static void project_faces(const struct reconstruct *r, const struct faces *f, const double *const *q, bool calm,
                          const struct bases *b, int from, int to, struct projection *p) {
    static void (*const sounds[2][3])(int, int, const struct faces *, const struct bases *restrict,
                                      const double *const *, struct sound *restrict) = {
        {sounds_two, sounds_four, sounds_six}, {calm_two, calm_four, calm_six}};
    p->f = f;
    p->q = q;
    p->b = b;
    sounds[calm && f->rise][r->reach](from, to, f, b, q, &p->sound);
}
static void project_groups(const struct reconstruct *r, const struct faces *f, const double *const *q, bool calm,
                           const struct bases *b, int from, int to, const int *kind, int bits, struct projection *p) {
    for (int at = from, end; at < to; at = end) {
        for (end = at; end < to && kind[end / GROUP] & bits;) end += GROUP;
        end = end < to ? end : to;
        if (at < end)
            project_faces(r, f, q, calm, b, at, end, p);
        else
            end = at + GROUP;
    }
}

static int family_of(const struct faces *f, int field) {
    return field == 0 ? MINUS : field == f->dim + 1 ? PLUS : ENTROPY;
}

/* Field v of a projection from face `at` on. */
static struct projected field_at(const struct projection *p, int v, int at) {
    const double *s = p->sound.s[LEFT] + at, *d = p->sound.d[LEFT] + at, *q0 = p->q[0] + at;
    const double *inverse_c = p->b->half_inverse_c + at;
    const long stride = p->f->stride;
    if (v == 0) return (struct projected){-1, inverse_c, d, s, BATCH, BATCH};
    if (v == 1) return (struct projected){-2, ones, s, q0, BATCH, stride};
    if (v == p->f->dim + 1) return (struct projected){1, inverse_c, d, s, BATCH, BATCH};
    return (struct projected){-1, p->b->u[v - 1] + at, q0, p->q[v] + at, stride, stride};
}
static struct projected mirrored(struct projected f) {
    return (struct projected){f.scale, f.factor, f.x + f.x_stride, f.y + f.y_stride, -f.x_stride, -f.y_stride};
}

void characteristic_common(const struct reconstruct *r, int from, int to, const int *kind, const struct faces *f,
                           const struct bases *b, const struct winds *w, double (*a)[BATCH]) {
    struct projection flux, state;
    project_faces(r, f, f->flux, true, b, from, to, &flux);
    project_groups(r, f, f->state, false, b, from, to, kind, SPLITS, &state);
    for (int v = 0; v < f->dim + 2; v++) {
        const int family = family_of(f, v), split = 1 << family;
        for (int at = from, end; at < to; at = end) {
            end = run_end(to, kind, split, at);
            const struct projected q = field_at(&flux, v, at);
            if (kind[at / GROUP] & split) {
                const struct projected u = field_at(&state, v, at);
                r->split(end - at, w->speed[family] + at, &q, &u, a[v] + at);
            } else
                r->upwind(end - at, w->speed[family] + at, &q, a[v] + at);
        }
    }
}

/* The part of a field that comes from one side s: 0 left, 1 right. */
static void fill_side(const struct reconstruct *r, const struct projection *flux, const struct projection *state, int s,
                      int v, const double *speed, int from, int to, double *a) {
    struct projected q = field_at(flux, v, from), u = field_at(state, v, from);
    if (s) {
        q = mirrored(q);
        u = mirrored(u);
    }
    r->sided(to - from, speed + from, s ? -1 : 1, &q, &u, a + from);
}

void characteristic_apart(const struct reconstruct *r, const int *kind, const struct faces *f, const struct bases *b,
                          const struct winds *w, double (*a[2])[BATCH]) {
    struct projection flux[2], state[2];
    for (int s = 0; s < 2; s++) {
        const int used = SPLITS | MIXED | (s ? ALL_RIGHT : ALL_LEFT);
        project_groups(r, f, f->flux, true, &b[s], 0, f->n, kind, used, &flux[s]);
        project_groups(r, f, f->state, false, &b[s], 0, f->n, kind, SPLITS, &state[s]);
    }
    for (int v = 0; v < f->dim + 2; v++) {
        const int family = family_of(f, v), split = 1 << family;
        const double *speed = w->speed[family];
        for (int at = 0, end; at < f->n; at = end) {
            const int now = kind[at / GROUP], n = (end = run_end(f->n, kind, split | ALL_LEFT | ALL_RIGHT, at)) - at;
            if (now & split) {
                for (int s = 0; s < 2; s++) fill_side(r, &flux[s], &state[s], s, v, speed, at, end, a[s][v]);
            } else if (now & (ALL_LEFT | ALL_RIGHT)) {
                const int s = now & ALL_RIGHT ? 1 : 0;
                const struct projected q = field_at(&flux[s], v, at);
                r->upwind(n, speed + at, &q, a[s][v] + at);
            } else {
                const struct projected q[2] = {field_at(&flux[0], v, at), field_at(&flux[1], v, at)};
                r->apart(n, speed + at, q, a[0][v] + at, a[1][v] + at);
            }
        }
    }
}

void characteristic_sided(const struct reconstruct *r, const struct faces *f, const struct bases *b,
                          const struct winds *w, int s, double (*a)[BATCH]) {
    struct projection flux, state;
    project_faces(r, f, f->flux, true, b, 0, f->n, &flux);
    project_faces(r, f, f->state, false, b, 0, f->n, &state);
    for (int v = 0; v < f->dim + 2; v++) fill_side(r, &flux, &state, s, v, w->speed[family_of(f, v)], 0, f->n, a[v]);
}
