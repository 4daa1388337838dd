/* The balance of pressure and weight at the faces of a lattice, so that gas at rest stays so to round-off.
 *
 * A row of cells whose pressures differ by the weight of half of either cell,
 *     p_1 - p_0 = h/2 (rho_0 g + rho_1 g),
 * is at rest if each face has the pressure that both its cells have there, P = p_0 + h/2 rho_0 g = p_1 - h/2 rho_1 g:
 * then the pressures on a cell's two faces differ by its weight, which weigh_row adds. So the pressure P_m of gas at
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

/* k and a - b of n faces that are no walls. */
KERNEL static void rise_line(int n, double half, long stride, const double *restrict rho, const double *restrict p,
                             const double *restrict u, const double *restrict c, double *restrict rise,
                             double *restrict skew, double *restrict on) {
    for (int i = 0; i < n; i++) {
        const double rho0 = rho[i], rho1 = rho[i + stride], p0 = p[i], p1 = p[i + stride];
        const double share = half * share_at(u[i], u[i + stride], c[i], c[i + stride]);
        const double k = clip(share * rho0 + share * rho1, larger(p0, p1));
        rise[i] = k;
        skew[i] = clip(share * rho0 - share * rho1, fabs(k));
        on[i] = ((share == 0) | ((rho0 == rho1) & (p0 == p1))) ? 0 : 1;
    }
}

/* The same of n faces on a wall, where b = -a; all lines begin at the cells inside. */
static void wall_line(int n, double half, bool high, const double *rho, const double *p, const double *u,
                      const double *c, double *rise, double *skew, double *on) {
    for (int i = 0; i < n; i++) {
        const double a = clip(half * share_at(u[i], u[i], c[i], c[i]) * rho[i], p[i]);
        rise[i] = 0;
        skew[i] = high ? 2 * a : -2 * a;
        on[i] = 1;
    }
}

/* Returns what kind of face lies above place j of a tile along an axis: 0 on a wall, -1 between ghosts behind a wall,
 * else 1. */
static int kind_of(const struct gas *g, int tile, int axis, int j) {
    const struct tile *t = &g->forest->tile[tile];
    for (int high = 0; high < 2; high++) {
        const int patch = t->side[2 * axis + high].patch, wall = high ? t->n[axis] - 1 : -1;
        if (patch < 0 || !patch_is_wall(&g->rules[patch])) continue;
        if (j == wall) return 0;
        if (high ? j > wall : j < wall) return -1;
    }
    return 1;
}

/* k and a - b of the faces above n cells, all of one kind. */
static void rises(const struct gas *g, const double *U, int axis, int kind, bool high, long offset, int n) {
    const struct work *w = &g->tiles->work;
    const double half = 0.5 * g->forest->width[axis] * g->gravity[axis];
    const long stride = g->forest->stride[axis], cell = offset + (kind == 0 && !high ? stride : 0);
    const double *rho = U + cell, *p = w->p + cell, *u = w->velocity[axis] + cell, *c = w->c + cell;
    if (kind == 0)
        wall_line(n, half, high, rho, p, u, c, w->rise + offset, w->skew + offset, w->on + offset);
    else
        rise_line(n, kind * half, stride, rho, p, u, c, w->rise + offset, w->skew + offset, w->on + offset);
}

void balance_rises(const struct gas *g, int tile, const double *U, int axis, int j, long offset, int n) {
    if (axis > 0) {
        rises(g, U, axis, kind_of(g, tile, axis, j), j >= 0, offset, n);
        return;
    }
    const int sides[] = {-1 - j, -j, g->forest->tile[tile].n[0] - 1 - j, g->forest->tile[tile].n[0] - j, n};
    for (int i = 0, from = 0; i < 5 && from < n; i++) { /* ghosts, face, cells, face, ghosts */
        const int to = sides[i] < n ? sides[i] : n;
        if (to <= from) continue;
        rises(g, U, 0, kind_of(g, tile, 0, j + from), j + from >= 0, offset + from, to - from);
        from = to;
    }
}

/* P, P_0 and P_1 of n faces; all 0 where `on` is, so that the flux has the bits of one without gravity. */
KERNEL static void base_line(int n, long stride, const double *restrict p, const double *restrict rise,
                             const double *restrict skew, const double *restrict on, double *restrict P,
                             double *restrict left, double *restrict right) {
    for (int i = 0; i < n; i++) {
        const double a = 0.5 * (rise[i] + skew[i]), b = 0.5 * (rise[i] - skew[i]);
        P[i] = on[i] * (0.5 * ((p[i] + a) + (p[i + stride] - b)));
        left[i] = P[i] - on[i] * a;
        right[i] = P[i] + on[i] * b;
    }
}

KERNEL static void add_line(int n, const double *restrict P, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] += P[i];
}

void balance_through(const struct gas *g, const struct strip *s, const struct faces *given,
                     const struct reconstruct *r) {
    const struct work *w = &g->tiles->work;
    struct faces f = *given;
    double P[BATCH], left[BATCH], right[BATCH];
    base_line(f.n, f.stride, w->p + s->offset, w->rise + s->offset, w->skew + s->offset, w->on + s->offset, P, left,
              right);
    f.on = w->on + s->offset;
    f.base[0] = left;
    f.base[1] = right;
    f.rise = w->rise + s->offset;
    g->models.flux->through(&f, g->models.eos, &g->models.material, r);
    add_line(f.n, P, f.out[1]);
}
