/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conjugate gradients, preconditioned by a K-cycle of aggregates (Notay 2008): each level combines two cycles
 * with the best weights; it makes only one if that is good enough. Smoothing is a sweep forward before and one backward
 * after. */
#include "libcore/multigrid/multigrid_private.h"

/* Blocks do not see each other in a sweep. So rows of several of them are done in turn: the processor need not wait for
 * the row before. */
enum { AT_ONCE = 4 };

struct turns { /* of blocks with rows that are left: at < end */
    int next, at[AT_ONCE], end[AT_ONCE];
};

/* Gives turn t another block where it has done its own; returns whether it has a row. */
ALWAYS_INLINE bool has_row(const struct level *l, struct turns *s, int t) {
    for (; s->at[t] == s->end[t] && s->next < l->blocks; s->next++) {
        s->at[t] = l->block[s->next];
        s->end[t] = l->block[s->next + 1];
    }
    return s->at[t] < s->end[t];
}

ALWAYS_INLINE double sum_links(const struct level *l, int first, int end, double sum) {
    for (int k = first; k < end; k++) sum += l->weight[k] * l->x[l->link[k]];
    return sum;
}

/* x = M^-1 r with M = D + L in each block, from x = 0. */
static void sweep_forward(const struct level *l) {
    struct turns s = {0};
    for (bool any = true; any;) {
        any = false;
        for (int t = 0; t < AT_ONCE; t++) {
            if (!has_row(l, &s, t)) continue;
            const int i = s.at[t]++;
            l->x[i] = sum_links(l, l->first[3 * i], l->first[3 * i + 1], l->r[i]) * l->inverse[i];
            any = true;
        }
    }
}

static double outside(const struct level *l, int e) {
    const int i = l->edge[e];
    double sum = l->damp[e] * l->x[i];
    for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) sum += l->weight[k] * l->x[l->link[k]];
    return sum;
}

/* Sums the residual after sweep_forward, r - A x = (M - A) x, over the aggregates: that inside the blocks. */
static void restrict_inside(const struct level *l, int parts, double *r) {
    for (int i = 0; i < parts; i++) r[i] = 0;
    for (int i = 0; i < l->rows; i++) {
        double sum = 0;
        if (l->aggregate[i] < 0) continue;
        for (int k = l->first[3 * i + 1]; k < l->first[3 * i + 2]; k++) sum += l->weight[k] * l->x[l->link[k]];
        r[l->aggregate[i]] += sum;
    }
}

static void restrict_outside(const struct level *l, double *r) {
    for (int e = 0; e < l->edges; e++)
        if (l->aggregate[l->edge[e]] >= 0) r[l->aggregate[l->edge[e]]] += outside(l, e);
}

/* Improves x by M' = D + U; other blocks' values are those from before. */
static void sweep_backward(const struct level *l) {
    struct turns s = {0};
    for (int e = 0; e < l->edges; e++) {
        l->kept[e] = l->r[l->edge[e]];
        l->r[l->edge[e]] += outside(l, e);
    }
    for (bool any = true; any;) {
        any = false;
        for (int t = 0; t < AT_ONCE; t++) {
            if (!has_row(l, &s, t)) continue;
            const int i = --s.end[t];
            l->x[i] = sum_links(l, l->first[3 * i], l->first[3 * i + 2], l->r[i]) * l->inverse[i];
            any = true;
        }
    }
    for (int e = 0; e < l->edges; e++) l->r[l->edge[e]] = l->kept[e];
}

/* Computes out = A x, and x of the ghosts. Rows sum what lies in their blocks while that of others is on its way. */
static void apply(const struct multigrid *m, const struct level *l, double *x, double *out) {
    multigrid_send(m, l, x);
    for (int i = 0; i < l->rows; i++) {
        double sum = l->diagonal[i] * x[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 2]; k++) sum -= l->weight[k] * x[l->link[k]];
        out[i] = sum;
    }
    multigrid_receive(m, l, x);
    for (int e = 0; e < l->edges; e++) {
        const int i = l->edge[e];
        for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) out[i] -= l->weight[k] * x[l->link[k]];
    }
}

static void correct(struct multigrid *m, int level);

/* Computes x = B r on a level by one cycle. Ghosts of x are received once: what is added to them then, the corrections
 * of their aggregates, this rank knows. */
static void cycle(struct multigrid *m, int level) {
    struct level *l = &m->level[level];
    const bool gather = level + 1 == m->spread && m->ranks > 1;
    struct level *next = gather ? &m->local : l + 1;
    sweep_forward(l);
    multigrid_send(m, l, l->x);
    restrict_inside(l, next->rows, next->r);
    multigrid_receive(m, l, l->x);
    restrict_outside(l, next->r);
    if (gather) multigrid_gather_residual(m);
    correct(m, level + 1);
    if (gather) multigrid_take_correction(m);
    for (int i = 0; i < l->rows + l->ghosts; i++)
        if (l->aggregate[i] >= 0) l->x[i] += next->c[l->aggregate[i]];
    sweep_backward(l);
}

/* Computes c, the correction for r, of rows and ghosts: the best multiple of the result of one cycle, or combination of
 * two cycles, if one leaves more than a quarter of r. */
static void correct(struct multigrid *m, int level) {
    struct level *l = &m->level[level];
    const int all = l->rows + l->ghosts;
    if (level == m->levels - 1) {
        multigrid_direct_solve(&m->direct, l->r, l->c);
        return;
    }
    cycle(m, level);
    double *const c = l->x, *const v = l->v, sum[5];
    l->x = l->c;
    l->c = c;
    apply(m, l, c, v);
    multigrid_dots(m, l, 5, (const double *const[]){c, c, l->r, l->r, v}, (const double *const[]){v, l->r, l->r, v, v},
                   sum);
    const double bend = sum[0], step = bend > 0 ? sum[1] / bend : 0;
    const double left = sum[2] - 2 * step * sum[3] + step * step * sum[4];
    if (!(left > 0.0625 * sum[2]) || !(bend > 0)) {
        for (int i = 0; i < all; i++) c[i] *= step;
        return;
    }
    for (int i = 0; i < l->rows; i++) l->r[i] -= step * v[i];
    cycle(m, level);
    double *const x = l->x;
    apply(m, l, x, v);
    multigrid_dots(m, l, 3, (const double *const[]){x, c, x}, (const double *const[]){l->r, v, v}, sum);
    const double gain = sum[0], along = sum[1], across = sum[2] - along * along / bend;
    const double second = across > 0 ? gain / across : 0, first = step - along / bend * second;
    for (int i = 0; i < all; i++) c[i] = first * c[i] + second * x[i];
}

/* Sums of products of z = B r, w = A z, r, and q = A p of the last direction p; those from RR on are taken over d. */
enum { ZQ, ZW, ZR, RR, RW, RQ, WW, WQ, SUMS, LANES = 8 };

ALWAYS_INLINE void add_products(double (*s)[LANES], int k, double z, double w, double r, double q, double d) {
    const double over = 1 / d, r_over = r * over, w_over = w * over;
    s[ZQ][k] += z * q;
    s[ZW][k] += z * w;
    s[ZR][k] += z * r;
    s[RR][k] += r * r_over;
    s[RW][k] += w * r_over;
    s[RQ][k] += q * r_over;
    s[WW][k] += w * w_over;
    s[WQ][k] += q * w_over;
}

KERNEL static void multigrid_products(int n, const double *restrict z, const double *restrict w,
                                      const double *restrict r, const double *restrict q, const double *restrict d,
                                      double *restrict sum) {
    double s[SUMS][LANES] = {{0}};
    int i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int k = 0; k < LANES; k++) add_products(s, k, z[i + k], w[i + k], r[i + k], q[i + k], d[i + k]);
    for (int k = 0; i + k < n; k++) add_products(s, k, z[i + k], w[i + k], r[i + k], q[i + k], d[i + k]);
    for (int j = 0; j < SUMS; j++)
        sum[j] = ((s[j][0] + s[j][1]) + (s[j][2] + s[j][3])) + ((s[j][4] + s[j][5]) + (s[j][6] + s[j][7]));
}

/* Conjugate gradients with one sum over the ranks an iteration (Chronopoulos & Gear 1989): q follows p, so that all
 * products are known before the direction is. The coefficient of the last direction is that for preconditioners that
 * depend on r, as the cycle does: z'q/p'q. */
static int iterate(struct multigrid *m, double reduction, int most, double *x) {
    struct level *l = &m->level[0];
    double *r = l->r, *w = l->v, *p = m->p, *q = m->q, sum[SUMS], bend = 0, size = 0, goal = 0, left = HUGE_VAL;
    int n = 0;
    for (int i = 0; i < l->rows; i++) p[i] = q[i] = 0;
    for (; n < most && left > goal; n++) {
        cycle(m, 0);
        const double *z = l->x;
        apply(m, l, l->x, w);
        for (int k = 0; k < l->blocks; k++) {
            const int at = l->block[k];
            multigrid_products(l->block[k + 1] - at, z + at, w + at, r + at, q + at, l->diagonal + at,
                               m->world.mine + k * SUMS);
        }
        multigrid_add(m, l, SUMS, sum);
        const double back = bend > 0 ? sum[ZQ] / bend : 0;
        bend = sum[ZW] - back * sum[ZQ];
        if (!(bend > 0)) break;
        const double step = sum[ZR] / bend;
        for (int i = 0; i < l->rows; i++) {
            p[i] = z[i] - back * p[i];
            q[i] = w[i] - back * q[i];
            x[i] += step * p[i];
            r[i] -= step * q[i];
        }
        if (n == 0) goal = reduction * reduction * sum[RR];
        size = sum[WW] - 2 * back * sum[WQ] + back * back * size;
        left = sum[RR] - 2 * step * (sum[RW] - back * sum[RQ]) + step * step * size;
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
