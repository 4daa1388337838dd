/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The balance of pressure and weight at the faces of a lattice, so that gas at rest stays so to round-off
 * (docs/physics.md 7.4).
 *
 * A row of cells whose pressures differ by the weight of half of either cell,
 *     p_1 - p_0 = h/2 (rho_0 g + rho_1 g),
 * is at rest if each face has the pressure that both its cells have there, P = p_0 + h/2 rho_0 g = p_1 - h/2 rho_1 g:
 * then the pressures on a cell's two faces differ by its weight, which advance_row adds. So the pressure P_m of gas at
 * rest is taken from the fluxes of momentum of a stencil's cells m,
 *     k_m = h/2 (rho_m g + rho_(m+1) g),  P_(m+1) = P_m + k_m, but P_0 = P - a, P_1 = P + b,
 *     P = (p_0 + a + p_1 - b)/2,  a = h/2 rho_0 g,  b = h/2 rho_1 g,  k_0 = a + b,
 * what remains is reconstructed and upwinded, and P is added to the result. At rest nothing remains, and no face moves
 * mass (Kaeppeli & Mishra, Astron. Astrophys. 587, A94, 2016, do so with states). Beyond a wall lies a mirror image, of
 * gravity, too: on the wall P = p_0 - a, and k is 0. Any k and a are consistent, so they are less where gas is not at
 * rest:
 * - they exceed neither pressure of the two cells, since cold gas, which carries no weight, would else be pulled by
 * dense gas beside it;
 * - they fade where gas crosses the face at more than half of the speed of sound, and are 0 from that speed on, so that
 *   fluxes take nothing from downwind there;
 * - nothing is taken at the face between two equal cells (on = 0), so that uniform gas, which falls freely, keeps its
 *   bits. Beyond an open patch the ghosts, which carry no weight, count like cells: gas that leaves falls freely. */
#include "libcore/lattice/tiles.h"

#include <limits.h>

bool balance_acts(const struct gas *g, int axis) {
    return g->models.source.gravity[axis] != 0;
}

ALWAYS_INLINE double clip(double x, double most) {
    return smaller(larger(x, -most), most);
}

/* The share of the weight that two cells carry: 1 to 0 as the speed across the face goes from c/2 to c. */
ALWAYS_INLINE double share_at(double u0, double u1, double c0, double c1) {
    return smaller(larger(2 - 2 * (fabs(u0) + fabs(u1)) / (c0 + c1), 0), 1);
}

struct balance {            /* what a face takes */
    double rise, low, high; /* k, a, b */
    bool on;
};
/* k = a + b and a - b are clipped, k to the larger pressure, a - b to k. share: h/2 g times share_at */
ALWAYS_INLINE struct balance balance_at(double share, double rho0, double rho1, double p0, double p1) {
    const double a = share * rho0, b = share * rho1, most = larger(p0, p1);
    const double k = clip(a + b, most), skew = clip(a - b, fabs(k));
    const bool clipped = fabs(a + b) > most;
    return (struct balance){k, clipped ? 0.5 * (k + skew) : a, clipped ? 0.5 * (k - skew) : b,
                            (share != 0) & ((rho0 != rho1) | (p0 != p1))};
}
/* The same where share is 1 and nothing is clipped. */
ALWAYS_INLINE struct balance balance_of_slow(double half, double rho0, double rho1, double p0, double p1) {
    const double a = half * rho0, b = half * rho1;
    return (struct balance){a + b, a, b, (rho0 != rho1) | (p0 != p1)};
}
/* The same on a wall, where b = -a, of the cell inside. */
ALWAYS_INLINE struct balance balance_on_wall(double half, bool high, double rho, double p, double u, double c) {
    const double a = clip(half * share_at(u, u, c, c) * rho, p);
    return (struct balance){0, high ? a : -a, high ? -a : a, true};
}

/* Keeps what a face takes, with P, P_0 and P_1; all 0 where nothing is taken: then its flux is that without gravity. */
ALWAYS_INLINE void keep_balance(const struct balance b, double p0, double p1, double *restrict rise,
                                double *restrict on, double *restrict face, double *restrict left,
                                double *restrict right) {
    const double P = 0.5 * ((p0 + b.low) + (p1 - b.high));
    *rise = b.rise;
    *on = b.on ? 1 : 0;
    *face = b.on ? P : 0;
    *left = b.on ? P - b.low : 0;
    *right = b.on ? P + b.high : 0;
}

enum {
    GROUP = 8,         /* faces that are treated alike: a vector */
    LINE = BATCH + 16, /* most faces of a row, in whole vectors */
};

/* fast[i] has its sign bit cleared where gas crosses the face so fast that nothing is taken. Returns whether that is so
 * everywhere. */
ALWAYS_INLINE bool find_fast(int n, long stride, const double *restrict u, const double *restrict c,
                             uint64_t *restrict fast) {
    uint64_t signs = 0;
    for (int i = 0; i < n; i++) {
        fast[i] = bits_of((fabs(u[i]) + fabs(u[i + stride])) - (c[i] + c[i + stride]));
        signs |= fast[i];
    }
    return signs >> 63 == 0;
}
/* The same of faces of which balance_of_slow is true. */
ALWAYS_INLINE void find_slow(int n, double half, long stride, const double *restrict rho, const double *restrict p,
                             const double *restrict u, const double *restrict c, uint64_t *restrict slow) {
    for (int i = 0; i < n; i++) {
        const long j = i + stride;
        slow[i] = bits_of((c[i] + c[j]) - 2 * (fabs(u[i]) + fabs(u[j]))) |
                  bits_of(larger(p[i], p[j]) - fabs(half * rho[i] + half * rho[j]));
    }
}
ALWAYS_INLINE bool is_all(const uint64_t *s) {
    return (s[0] | s[1] | s[2] | s[3] | s[4] | s[5] | s[6] | s[7]) >> 63 == 0;
}

struct balance_lines { /* cells below and above faces, `stride` apart; what the faces take, as keep_balance sets it */
    const double *restrict rho, *restrict p, *restrict u, *restrict c;
    double *restrict rise, *restrict on, *restrict face, *restrict left, *restrict right;
};
/* The balance of n faces that are no walls; returns whether anything is taken. Else `rise` alone is set. */
KERNEL static bool balance_line(int n, double half, long stride, const struct balance_lines *restrict l) {
    const double *rho = l->rho, *p = l->p, *u = l->u, *c = l->c;
    double *rise = l->rise, *on = l->on, *face = l->face, *left = l->left, *right = l->right;
    ALIGNED uint64_t fast[LINE], slow[LINE];
    uint64_t any = 0;
    if (find_fast(n, stride, u, c, fast)) {
        for (int i = 0; i < n; i++) rise[i] = 0;
        return false;
    }
    find_slow(n, half, stride, rho, p, u, c, slow);
    for (int from = 0; from < n; from += GROUP) {
        if (is_all(fast + from)) {
            for (int i = from; i < from + GROUP; i++) rise[i] = on[i] = face[i] = left[i] = right[i] = 0;
        } else if (is_all(slow + from)) {
            for (int i = from; i < from + GROUP; i++)
                keep_balance(balance_of_slow(half, rho[i], rho[i + stride], p[i], p[i + stride]), p[i], p[i + stride],
                             &rise[i], &on[i], &face[i], &left[i], &right[i]);
        } else {
            for (int i = from; i < from + GROUP; i++)
                keep_balance(balance_at(half * share_at(u[i], u[i + stride], c[i], c[i + stride]), rho[i],
                                        rho[i + stride], p[i], p[i + stride]),
                             p[i], p[i + stride], &rise[i], &on[i], &face[i], &left[i], &right[i]);
        }
    }
    for (int i = 0; i < n; i++) any |= bits_of(on[i]);
    return any != 0;
}

struct row_of_faces { /* along an axis, above n cells from `offset` on */
    const struct gas *g;
    const double *U;
    int axis, n;
    long offset;
    double half; /* h/2 g */
};

static bool balance_faces(const struct row_of_faces *r) {
    const struct work *w = &r->g->tiles->work;
    const struct axis_lines *l = &w->along[r->axis];
    const long at = r->offset, to = at - l->origin;
    const struct balance_lines lines = {r->U + at,    w->p + at,       w->velocity[r->axis] + at,
                                        w->c + at,    l->rise + to,    l->on + to,
                                        l->face + to, l->base[0] + to, l->base[1] + to};
    return balance_line(whole_vectors(r->n), r->half, r->g->forest->stride[r->axis], &lines);
}

/* The balance of the i-th face of a row, and n - 1 more, on a wall. */
static void balance_wall(const struct row_of_faces *r, int i, int n, bool high) {
    const struct work *w = &r->g->tiles->work;
    const struct axis_lines *l = &w->along[r->axis];
    const long stride = r->g->forest->stride[r->axis];
    for (long at = r->offset + i; at < r->offset + i + n; at++) {
        const long in = high ? at : at + stride, to = at - l->origin;
        const struct balance b = balance_on_wall(r->half, high, r->U[in], w->p[in], w->velocity[r->axis][in], w->c[in]);
        keep_balance(b, w->p[at], w->p[at + stride], &l->rise[to], &l->on[to], &l->face[to], &l->base[0][to],
                     &l->base[1][to]);
    }
}

/* Sets what balance_line leaves when nothing is taken. */
static void take_nothing(const struct row_of_faces *r) {
    const struct axis_lines *l = &r->g->tiles->work.along[r->axis];
    double *const line[] = {l->on, l->face, l->base[0], l->base[1]};
    for (int i = 0; i < 4; i++)
        memset(line[i] + r->offset - l->origin, 0, (size_t)whole_vectors(r->n) * sizeof(double));
}

/* The balance of a row along axis 0, from place j on: its walls are faces in it. */
static bool balance_along(const struct row_of_faces *r, const struct walls *walls, int j) {
    const struct axis_lines *l = &r->g->tiles->work.along[0];
    double *rise = l->rise + r->offset - l->origin;
    const int low = walls->low[0] - j, high = walls->high[0] - j;
    const bool at_low = low >= 0 && low < r->n, at_high = high >= 0 && high < r->n, taken = balance_faces(r);
    for (int i = 0; i < low && i < r->n; i++) rise[i] = -rise[i];
    for (int i = high < 0 ? 0 : high + 1; i < r->n; i++) rise[i] = -rise[i];
    if ((at_low || at_high) && !taken) take_nothing(r);
    if (at_low) balance_wall(r, low, 1, false);
    if (at_high) balance_wall(r, high, 1, true);
    return taken || at_low || at_high;
}

void balance_walls(const struct gas *g, int tile, struct walls *walls) {
    const struct tile *t = &g->forest->tile[tile];
    for (int k = 0; k < g->dim; k++) {
        const int low = t->side[2 * k].patch, high = t->side[2 * k + 1].patch;
        walls->low[k] = low >= 0 && patch_is_wall(&g->patches.rules[low]) ? -1 : INT_MIN / 2;
        walls->high[k] = high >= 0 && patch_is_wall(&g->patches.rules[high]) ? t->n[k] - 1 : INT_MAX / 2;
    }
}

bool balance_row(const struct gas *g, const struct walls *walls, const double *U, int axis, int j, long offset, int n) {
    const double half = 0.5 * g->forest->width[axis] * g->falling.gravity[axis];
    struct row_of_faces r = {g, U, axis, n, offset, half};
    const int low = walls->low[axis], high = walls->high[axis];
    if (axis == 0) return balance_along(&r, walls, j);
    if (j == low || j == high) {
        balance_wall(&r, 0, n, j == high);
        return true;
    }
    if (j < low || j > high) r.half = -half; /* between ghosts */
    return balance_faces(&r);
}

/* Where nothing was taken nothing is added, not even a zero, which would change the sign of another. */
KERNEL static void add_line(int n, const double *restrict P, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = P[i] != 0 ? out[i] + P[i] : out[i];
}

void balance_through(const struct gas *g, const struct strip *s, const struct faces *given,
                     const struct reconstruct *r) {
    const struct axis_lines *l = &g->tiles->work.along[s->axis];
    const long at = s->offset - l->origin;
    struct faces f = *given;
    f.on = l->on + at;
    f.base[0] = l->base[0] + at;
    f.base[1] = l->base[1] + at;
    f.rise = l->rise + at;
    f.rest = l->face + at;
    flux_undamped(g->models.flux, &f, g->models.eos, &g->models.material, r);
    add_line(f.n, f.rest, f.out[1]);
}
