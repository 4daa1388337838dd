/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conjugate gradients, preconditioned by a K-cycle of aggregates (Notay 2008): each level's correction is the best
 * combination of two, but where one is good. Smoothing is a sweep forward before and one backward after. */
#include "libcore/acoustics/multigrid_private.h"

/* x = M^-1 r with M = D + L in each block, from x = 0. */
static void sweep_forward(const struct level *l) {
    double *x = l->x;
    for (int i = 0; i < l->rows; i++) {
        double sum = l->r[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 1]; k++) sum += l->weight[k] * x[l->link[k]];
        x[i] = sum * l->inverse[i];
    }
}

static double outside(const struct level *l, int e) {
    const int i = l->edge[e];
    double sum = l->damp[e] * l->x[i];
    for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) sum += l->weight[k] * l->x[l->link[k]];
    return sum;
}

/* Sums the residual after sweep_forward, r - A x = (M - A) x, over the aggregates. */
static void restrict_residual(const struct level *l, int parts, double *r) {
    for (int i = 0; i < parts; i++) r[i] = 0;
    for (int i = 0; i < l->rows; i++) {
        double sum = 0;
        if (l->part[i] < 0) continue;
        for (int k = l->first[3 * i + 1]; k < l->first[3 * i + 2]; k++) sum += l->weight[k] * l->x[l->link[k]];
        r[l->part[i]] += sum;
    }
    for (int e = 0; e < l->edges; e++)
        if (l->part[l->edge[e]] >= 0) r[l->part[l->edge[e]]] += outside(l, e);
}

/* Improves x by M' = D + U; other blocks' values are those from before. */
static void sweep_backward(const struct level *l) {
    double *x = l->x;
    for (int e = 0; e < l->edges; e++) {
        l->kept[e] = l->r[l->edge[e]];
        l->r[l->edge[e]] += outside(l, e);
    }
    for (int i = l->rows - 1; i >= 0; i--) {
        double sum = l->r[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 2]; k++) sum += l->weight[k] * x[l->link[k]];
        x[i] = sum * l->inverse[i];
    }
    for (int e = 0; e < l->edges; e++) l->r[l->edge[e]] = l->kept[e];
}

static void apply(const struct level *l, const double *x, double *out) {
    for (int i = 0; i < l->rows; i++) {
        double sum = l->diagonal[i] * x[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 3]; k++) sum -= l->weight[k] * x[l->link[k]];
        out[i] = sum;
    }
}

static void correct(struct multigrid *m, int level);

/* Computes x = B r on a level by one cycle. */
static void cycle(struct multigrid *m, int level) {
    struct level *l = &m->level[level];
    const bool spread = level < m->spread, gather = level + 1 == m->spread && m->ranks > 1;
    struct level *next = gather ? &m->local : l + 1;
    sweep_forward(l);
    if (spread) multigrid_exchange(m, l, l->x);
    restrict_residual(l, next->rows, next->r);
    if (gather) multigrid_gather_residual(m);
    correct(m, level + 1);
    if (gather) multigrid_take_correction(m);
    for (int i = 0; i < l->rows; i++)
        if (l->part[i] >= 0) l->x[i] += next->c[l->part[i]];
    if (spread) multigrid_exchange(m, l, l->x);
    sweep_backward(l);
}

/* Computes c, the correction for r: the best multiple of the result of one cycle, or combination of two cycles, if one
 * leaves more than a quarter of r. */
static void correct(struct multigrid *m, int level) {
    struct level *l = &m->level[level];
    if (level == m->levels - 1) {
        multigrid_direct_solve(&m->direct, l->r, l->c);
        return;
    }
    cycle(m, level);
    double *const c = l->x, sum[5];
    l->x = l->c;
    l->c = c;
    if (level < m->spread) multigrid_exchange(m, l, c);
    apply(l, c, l->v);
    multigrid_dots(m, l, 5, (const double *const[]){c, c, l->r, l->r, l->v},
                   (const double *const[]){l->v, l->r, l->r, l->v, l->v}, sum);
    const double bend = sum[0], step = bend > 0 ? sum[1] / bend : 0;
    const double left = sum[2] - 2 * step * sum[3] + step * step * sum[4];
    if (!(left > 0.0625 * sum[2]) || !(bend > 0)) {
        for (int i = 0; i < l->rows; i++) c[i] *= step;
        return;
    }
    for (int i = 0; i < l->rows; i++) l->r[i] -= step * l->v[i];
    cycle(m, level);
    if (level < m->spread) multigrid_exchange(m, l, l->x);
    multigrid_dots(m, l, 2, (const double *const[]){l->x, l->x}, (const double *const[]){l->v, l->r}, sum);
    const double along = sum[0], gain = sum[1];
    apply(l, l->x, l->v);
    multigrid_dots(m, l, 1, (const double *const[]){l->x}, (const double *const[]){l->v}, sum);
    const double rest = sum[0] - along * along / bend, second = rest > 0 ? gain / rest : 0;
    const double first = step - along / bend * second;
    for (int i = 0; i < l->rows; i++) c[i] = first * c[i] + second * l->x[i];
}

/* Returns the sum of r^2/d, taken by blocks; writes r/d to `scratch`. */
static double measure(const struct multigrid *m, const struct level *l, const double *r, double *scratch) {
    double sum;
    for (int i = 0; i < l->rows; i++) scratch[i] = l->diagonal[i] > 0 ? r[i] / l->diagonal[i] : 0;
    multigrid_dots(m, l, 1, (const double *const[]){r}, (const double *const[]){scratch}, &sum);
    return sum;
}

/* Makes the next direction p, conjugate to the last one. The coefficient is that for preconditioners that depend on r,
 * as the cycle does. */
static void turn(const struct multigrid *m, const struct level *l, double bend) {
    double sum[1] = {0}, *z = l->x;
    if (bend > 0) multigrid_dots(m, l, 1, (const double *const[]){z}, (const double *const[]){m->q}, sum);
    const double back = bend > 0 ? sum[0] / bend : 0;
    for (int i = 0; i < l->rows; i++) m->p[i] = bend > 0 ? z[i] - back * m->p[i] : z[i];
}

static int iterate(struct multigrid *m, double reduction, int most, double *x) {
    struct level *l = &m->level[0];
    double *r = l->r, bend = 0, sum[2];
    const double goal = reduction * reduction * measure(m, l, r, l->v);
    int n = 0;
    for (; n < most && goal >= 0 && measure(m, l, r, l->v) > goal; n++) {
        cycle(m, 0);
        turn(m, l, bend);
        multigrid_exchange(m, l, m->p);
        apply(l, m->p, m->q);
        multigrid_dots(m, l, 2, (const double *const[]){m->p, m->p}, (const double *const[]){m->q, r}, sum);
        bend = sum[0];
        if (!(bend > 0)) break;
        const double step = sum[1] / bend;
        for (int i = 0; i < l->rows; i++) {
            x[i] += step * m->p[i];
            r[i] -= step * m->q[i];
        }
    }
    return n;
}

static int solve_directly(struct multigrid *m, const double *b, double *x) {
    const struct level *l = &m->local, *all = &m->level[0];
    double largest = 0;
    for (int i = 0; i < l->rows; i++) l->r[i] = b[i];
    if (m->ranks > 1)
        multigrid_gather_residual(m);
    else
        memcpy(all->r, l->r, (size_t)l->rows * sizeof *b);
    for (int i = 0; i < all->rows; i++) largest = larger(fabs(all->r[i]), largest);
    multigrid_direct_solve(&m->direct, all->r, all->c);
    if (m->ranks > 1)
        multigrid_take_correction(m);
    else
        memcpy(l->c, all->c, (size_t)l->rows * sizeof *x);
    for (int i = 0; i < l->rows; i++) x[i] = l->c[i];
    return largest > 0;
}

bool multigrid_is_direct(const struct multigrid *m) {
    return m->spread == 0;
}

status multigrid_solve(struct multigrid *m, const struct multigrid_rows *rows, const double *b, double reduction,
                       int most, double *x, int *iterations) {
    if (m->spread == 0) {
        *iterations = solve_directly(m, b, x);
        return OK;
    }
    m->level[0].own = rows;
    for (int i = 0; i < rows->rows; i++) {
        x[i] = 0;
        m->level[0].r[i] = b[i];
    }
    *iterations = iterate(m, reduction, most, x);
    return OK;
}
