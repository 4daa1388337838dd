/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characteristic upwinding (docs/physics.md 6.2). A kernel projects the stencils of faces on eigenbases and writes them
 * as columns, with their cells in upwind order: one column for each field of each face, and a second one for fields
 * that faces split. One loop of the reconstruction then runs over all columns of a batch: no loop here knows a
 * reconstruction, and none of a reconstruction knows the dimension or from which side a field comes. */
#include "libcore/schemes/flux_private.h"

enum {
    CELLS = 6,             /* of a stencil; a reconstruction reads the five on the upwind side */
    LEFT = 2,              /* place of the left one */
    NEXT = COLUMNS + BATCH /* from one cell of a column to the next one */
};
struct stencils { /* the columns of a batch; the last BATCH ones are scratch, which no code reads */
    ALIGNED double cell[CELLS][NEXT];
    int flats, flat[COLUMNS]; /* how many columns are those of flat faces (struct faces), and which */
};

/* Where `on` is 0 or 1 the products are exact. */
KERNEL static void take_rest(const struct faces *f, const double *q, double (*restrict out)[BATCH]) {
    const double *left = f->base[0], *right = f->base[1], *rise = f->rise, *on = f->on;
    const long s = f->stride;
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const double one = fma(-on[i], rise[i - s], left[i]), four = fma(on[i], rise[i + s], right[i]);
        out[0][i] = q[i - 2 * s] - fma(-on[i], rise[i - 2 * s], one);
        out[1][i] = q[i - s] - one;
        out[2][i] = q[i] - left[i];
        out[3][i] = q[i + s] - right[i];
        out[4][i] = q[i + 2 * s] - four;
        out[5][i] = q[i + 3 * s] - fma(on[i], rise[i + 2 * s], four);
    }
}
void faces_take_rest(const struct faces *f, const double *q, double (*out)[BATCH]) {
    take_rest(f, q, out);
}

struct cell_lines { /* fluxes or states: as in struct faces, but the normal component has a stride of its own */
    const double *const *q, *normal; /* read as they are: a copy of what was just written would wait for it */
    long stride, normal_stride;
};
struct task { /* n faces of a batch from face `at` on, and the columns of their fields */
    int at, n, dim;
    const double *flat; /* as in struct faces */
    struct cell_lines flux, state;
    const struct bases *b[2]; /* of the left and of the right side */
    const struct winds *w;
    double *first[MAX_VAR], *second[MAX_VAR]; /* cell 0; second: of the part from the right */
};

ALWAYS_INLINE struct fields cell_of(const int dim, const struct eigenrows l, const struct cell_lines *c, int i, int k) {
    return project(dim, l, c->q, i + (k - LEFT) * c->stride, c->normal[i + (k - LEFT) * c->normal_stride]);
}
ALWAYS_INLINE double field_of(const int dim, const struct fields f, int v) {
    return v == 0 ? f.minus : v == dim + 1 ? f.plus : v == 1 ? f.entropy : f.shear[v - 2];
}
ALWAYS_INLINE int family_of(const int dim, int field) {
    return field == 0 ? MINUS : field == dim + 1 ? PLUS : ENTROPY;
}

struct wind { /* of a field q, u that of the states: part q +- alpha u comes from the left and from the right */
    double part, alpha;
    bool right; /* does all of it come from the right? */
};
ALWAYS_INLINE struct wind wind_at(double speed) {
    return (struct wind){speed >= 0 ? 0.5 : 1, speed >= 0 ? 0.5 * speed : 0, speed == UPWIND_RIGHT};
}
struct face_winds { /* members, no array: see EACH_SURE */
    struct wind minus, entropy, plus;
};
ALWAYS_INLINE struct wind wind_of(const int dim, const struct face_winds *w, int field) {
    return field == 0 ? w->minus : field == dim + 1 ? w->plus : w->entropy;
}

/* Writes one cell of the columns of a face: q[0] and u[0] if the field comes from the left, q[1] and u[1] if from the
 * right. */
ALWAYS_INLINE void put(const int dim, const bool split, const struct face_winds *w, const struct fields q[2],
                       const struct fields u[2], double *const *first, double *const *second, long at) {
    UNROLL
    for (int v = 0; v < dim + 2; v++) {
        const struct wind x = wind_of(dim, w, v);
        double left = field_of(dim, q[0], v), right = field_of(dim, q[1], v);
        if (split) {
            left = fma(x.alpha, field_of(dim, u[0], v), x.part * left);
            right = fma(-x.alpha, field_of(dim, u[1], v), x.part * right);
            second[v][at] = right;
        }
        first[v][at] = x.right ? right : left;
    }
}

/* Writes cells from .. from + pairs - 1 <= LEFT of the columns, and their mirror images. split: some faces split
 * fields; two: the bases of both sides differ. */
ALWAYS_INLINE void order(const int dim, const int pairs, const bool split, const bool two, const struct task *t,
                         const int from) {
    struct cell_lines flux = t->flux, state = t->state;
    const struct bases *lb = t->b[0], *rb = t->b[1];
    const int at = t->at, n = t->n;
    const double *minus = t->w->speed[MINUS] + at, *entropy = t->w->speed[ENTROPY] + at, *plus = t->w->speed[PLUS] + at;
    const double *q[MAX_VAR], *u[MAX_VAR]; /* copies, which no store can change */
    double *first[MAX_VAR], *second[MAX_VAR];
    for (int v = 0; v < dim + 2; v++) {
        q[v] = flux.q[v];
        u[v] = state.q[v];
        first[v] = t->first[v];
        second[v] = t->second[v];
    }
    flux.q = q;
    state.q = u;
    EACH_SURE
    for (int i = 0; i < n; i++) {
        const int j = at + i;
        const struct eigenrows l = rows_at(dim, lb, j), r = two ? rows_at(dim, rb, j) : l;
        const struct face_winds w = {wind_at(minus[i]), wind_at(entropy[i]), wind_at(plus[i])};
        UNROLL
        for (int pair = 0; pair < pairs; pair++) {
            const int k = from + pair, m = CELLS - 1 - k;
            struct fields phi[4] = {cell_of(dim, l, &flux, j, k), cell_of(dim, r, &flux, j, m)}, psi[4];
            phi[2] = two ? cell_of(dim, l, &flux, j, m) : phi[1];
            phi[3] = two ? cell_of(dim, r, &flux, j, k) : phi[0];
            if (split) {
                psi[0] = cell_of(dim, l, &state, j, k);
                psi[1] = cell_of(dim, r, &state, j, m);
                psi[2] = two ? cell_of(dim, l, &state, j, m) : psi[1];
                psi[3] = two ? cell_of(dim, r, &state, j, k) : psi[0];
            }
            put(dim, split, &w, phi, psi, first, second, i + k * (long)NEXT);
            if (pair > 0 || pairs == 1) put(dim, split, &w, phi + 2, psi + 2, first, second, i + m * (long)NEXT);
        }
    }
}

/* A kernel for all cells that a reconstruction of some reach needs; on two bases one for cell k and its mirror image,
 * as these are rarer, and the compiler's time grows with the cells. */
#define ORDER(name, pairs, split, two, from)                                                                           \
    KERNEL static void name(const struct task *t, int k) {                                                             \
        (void)k;                                                                                                       \
        if (t->dim == 1) order(1, pairs, split, two, t, from);                                                         \
        if (t->dim == 2) order(2, pairs, split, two, t, from);                                                         \
        if (t->dim == 3) order(3, pairs, split, two, t, from);                                                         \
    }
ORDER(upwind_two, 1, false, false, LEFT)
ORDER(upwind_four, 2, false, false, LEFT - 1)
ORDER(upwind_six, 3, false, false, LEFT - 2)
ORDER(split_two, 1, true, false, LEFT)
ORDER(split_four, 2, true, false, LEFT - 1)
ORDER(split_six, 3, true, false, LEFT - 2)
ORDER(apart_upwind, 1, false, true, k)
ORDER(apart_split, 1, true, true, k)

/* The sum of both parts. */
KERNEL static void add_second(int n, const double *restrict speed, const double *restrict second, double *restrict a) {
    for (int i = 0; i < n; i++) a[i] += speed[i] >= 0 ? second[i] : 0;
}
/* The parts of both sides; second: not read where no face splits the field. */
KERNEL static void part_sides(int n, const double *restrict speed, const double *second, double *left, double *right) {
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const uint64_t from_right = is(speed[i] == UPWIND_RIGHT), split = is(speed[i] >= 0);
        const double value = left[i];
        right[i] = select_masked(from_right, value, select_masked(split, second[i], 0));
        left[i] = select_masked(from_right, 0, value);
    }
}

/* The end of the run of groups that starts at face `from` and is alike in the bits `same` of their kinds. */
static int run_end(int to, const int *kind, int same, int from) {
    int end = from + GROUP;
    while (end < to && (kind[end / GROUP] & same) == (kind[from / GROUP] & same)) end += GROUP;
    return end < to ? end : to;
}

/* Notes the columns of flat faces in a run of some kind. */
static void note_flat(const struct task *t, int kind, struct stencils *x) {
    for (int i = 0; i < t->n; i++)
        for (int v = 0; v < t->dim + 2 && t->flat[t->at + i] > 0; v++) {
            x->flat[x->flats++] = (int)(t->first[v] - x->cell[0]) + i;
            if (kind & 1 << family_of(t->dim, v)) x->flat[x->flats++] = (int)(t->second[v] - x->cell[0]) + i;
        }
}

/* Writes the columns of a run of faces of one kind, the first of n faces being `from`, and the second columns from
 * column `next` on; returns the column behind them. */
static int order_run(const struct reconstruct *r, int kind, int from, int n, struct task *t, struct stencils *x,
                     int next) {
    static void (*const one[2][3])(const struct task *, int) = {{upwind_two, upwind_four, upwind_six},
                                                                {split_two, split_four, split_six}};
    const bool splits = kind & SPLITS;
    for (int v = 0; v < t->dim + 2; v++) {
        const bool split = kind & 1 << family_of(t->dim, v);
        t->first[v] = x->cell[0] + v * n + t->at - from;
        t->second[v] = x->cell[0] + (split ? next : COLUMNS);
        next += split ? t->n : 0;
    }
    if (t->b[0] == t->b[1])
        one[splits][r->reach](t, 0);
    else
        for (int k = LEFT - r->reach; k <= LEFT; k++) (splits ? apart_split : apart_upwind)(t, k);
    if (t->flat) note_flat(t, kind, x);
    return next;
}

/* Sets a task field by field: a copy of it would wait until all of it is written. */
static void task_make(const struct faces *f, const struct winds *w, double (*momentum)[BATCH], struct task *t) {
    t->dim = f->dim;
    t->w = w;
    t->flat = f->flat;
    t->flux.q = f->flux;
    t->flux.normal = f->rise ? momentum[LEFT] : f->flux[1];
    t->flux.normal_stride = f->rise ? BATCH : f->stride;
    t->state.q = f->state;
    t->state.normal = f->state[1];
    t->flux.stride = t->state.stride = t->state.normal_stride = f->stride;
    if (f->rise) take_rest(f, f->flux[1], momentum);
}

static void reconstruct_columns(const struct reconstruct *r, int columns, const struct stencils *x, double *a) {
    const double *line[CELLS];
    for (int k = 0; k < CELLS; k++) line[k] = x->cell[k];
    r->face(columns, line, a);
    for (int i = 0; i < x->flats; i++) a[x->flat[i]] = x->cell[LEFT][x->flat[i]];
}

void characteristic_common(const struct reconstruct *r, int from, int to, const int *kind, const struct faces *f,
                           const struct bases *b, const struct winds *w, double *a) {
    const int n = to - from, first = (f->dim + 2) * n;
    int columns = first;
    struct stencils x;
    x.flats = 0;
    ALIGNED double momentum[CELLS][BATCH];
    struct task t;
    task_make(f, w, momentum, &t);
    t.b[0] = t.b[1] = b;
    for (t.at = from; t.at < to; t.at += t.n) {
        t.n = run_end(to, kind, SPLITS, t.at) - t.at;
        columns = order_run(r, kind[t.at / GROUP], from, n, &t, &x, columns);
    }
    reconstruct_columns(r, columns, &x, a);
    const double *second = a + first;
    for (int at = from, end; at < to; at = end) {
        end = run_end(to, kind, SPLITS, at);
        for (int v = 0; v < f->dim + 2; v++) {
            const int family = family_of(f->dim, v);
            if (!(kind[at / GROUP] & 1 << family)) continue;
            add_second(end - at, w->speed[family] + at, second, a + v * n + at - from);
            second += end - at;
        }
    }
}

void characteristic_apart(const struct reconstruct *r, const int *kind, const struct faces *f, const struct bases *b,
                          const struct winds *w, double *left, double *right) {
    const int n = f->n, first = (f->dim + 2) * n, one_side = ALL_LEFT | ALL_RIGHT, same = SPLITS | one_side;
    int columns = first;
    struct stencils x;
    x.flats = 0;
    ALIGNED double momentum[CELLS][BATCH];
    struct task t;
    task_make(f, w, momentum, &t);
    for (t.at = 0; t.at < n; t.at += t.n) {
        const int now = kind[t.at / GROUP];
        t.n = run_end(n, kind, same, t.at) - t.at;
        t.b[0] = &b[now & ALL_RIGHT ? 1 : 0];
        t.b[1] = &b[now & ALL_LEFT ? 0 : 1];
        columns = order_run(r, now, 0, n, &t, &x, columns);
    }
    reconstruct_columns(r, columns, &x, left);
    const double *second = left + first;
    for (int at = 0, end; at < n; at = end) {
        const int now = kind[at / GROUP];
        end = run_end(n, kind, same, at);
        for (int v = 0; v < f->dim + 2 && !(now & one_side); v++) {
            const int family = family_of(f->dim, v), place = v * n + at;
            const bool split = now & 1 << family;
            part_sides(end - at, w->speed[family] + at, split ? second : left + place, left + place, right + place);
            second += split ? end - at : 0;
        }
    }
}
