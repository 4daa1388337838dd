/* The balance of pressure and weight at the faces of a lattice, so that gas at rest stays so to round-off.
 *
 * A row of cells whose pressures differ by the weight of half of either cell,
 *     p_1 - p_0 = h/2 (rho_0 g + rho_1 g),
 * is at rest if each face has the pressure that both its cells have there, P = p_0 + h/2 rho_0 g = p_1 - h/2 rho_1 g:
 * then the pressures on a cell's two faces differ by its weight, which weigh_row adds. So the pressure P_m of gas at
 * rest is taken from the fluxes of momentum of a stencil's cells m,
 *     k_m = h/2 (rho_m g + rho_(m+1) g),  P_(m+1) = P_m + k_m,  P_0 = P - a,
 *     P = (p_0 + a + p_1 - (k_0 - a))/2,  a = h/2 rho_0 g,
 * what remains is reconstructed and upwinded, and P is added to the result. At rest nothing remains, and no face moves
 * mass (Kaeppeli & Mishra, Astron. Astrophys. 587, A94, 2016, do so with states). A rise k_m exceeds neither pressure
 * of its two cells, since cold gas, which cannot carry weight, would else be pulled by dense gas beside it. Beyond a
 * wall lies a mirror image, of gravity, too: on the wall P = p_0 - a, and k is 0. */
#include "libcore/lattice/tiles.h"

bool balance_acts(const struct gas *g, int axis) {
    return g->models.source.gravity[axis] != 0;
}

ALWAYS_INLINE double clip(double x, double most) {
    return smaller(larger(x, -most), most);
}

KERNEL static void rise_line(int n, double half, long stride, const double *restrict rho, const double *restrict p,
                             double *restrict rise) {
    for (int i = 0; i < n; i++) rise[i] = clip(half * rho[i] + half * rho[i + stride], larger(p[i], p[i + stride]));
}

/* P and P_0 of faces that are no walls. */
KERNEL static void base_line(int n, double half, long stride, const double *restrict rho, const double *restrict p,
                             const double *restrict rise, double *restrict P, double *restrict base) {
    for (int i = 0; i < n; i++) {
        const double skew = clip(half * rho[i] - half * rho[i + stride], fabs(rise[i]));
        P[i] = 0.5 * ((p[i] + p[i + stride]) + skew);
        base[i] = P[i] - 0.5 * (rise[i] + skew);
    }
}

/* P and P_0 of n faces on a wall, whose cells inside begin at rho and p. */
static void wall_line(int n, double half, bool high, const double *rho, const double *p, double *P, double *base) {
    for (int i = 0; i < n; i++) {
        const double lift = clip(half * rho[i], p[i]);
        P[i] = high ? p[i] + lift : p[i] - lift;
        base[i] = p[i];
    }
}

static double half_weight(const struct gas *g, int axis) {
    return 0.5 * g->forest->width[axis] * g->gravity[axis];
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

/* The rises above n cells of one kind. */
static void rises(const struct gas *g, const double *U, int axis, int kind, long offset, int n) {
    const struct work *w = &g->tiles->work;
    if (kind == 0)
        for (int i = 0; i < n; i++) w->rise[offset + i] = 0;
    else
        rise_line(n, kind * half_weight(g, axis), g->forest->stride[axis], U + offset, w->p + offset, w->rise + offset);
}

void balance_rises(const struct gas *g, int tile, const double *U, int axis, int j, long offset, int n) {
    if (axis > 0) {
        rises(g, U, axis, kind_of(g, tile, axis, j), offset, n);
        return;
    }
    const int sides[] = {-1 - j, -j, g->forest->tile[tile].n[0] - 1 - j, g->forest->tile[tile].n[0] - j, n};
    for (int i = 0, from = 0; i < 5 && from < n; i++) { /* ghosts, face, cells, face, ghosts */
        const int to = sides[i] < n ? sides[i] : n;
        if (to <= from) continue;
        rises(g, U, 0, kind_of(g, tile, 0, j + from), offset + from, to - from);
        from = to;
    }
}

/* P and P_0 of the faces of a strip. */
static void find_base(const struct gas *g, const double *U, const struct strip *s, double *P, double *base) {
    const struct work *w = &g->tiles->work;
    const int n = g->forest->tile[s->tile].n[s->axis];
    const double half = half_weight(g, s->axis), *rho = U + s->offset, *p = w->p + s->offset;
    const long stride = g->forest->stride[s->axis];
    const bool low = kind_of(g, s->tile, s->axis, -1) == 0, high = kind_of(g, s->tile, s->axis, n - 1) == 0;
    if (s->axis > 0 && ((low && s->from == -1) || (high && s->from == n - 1))) {
        const long inside = s->from == -1 ? stride : 0;
        wall_line(s->n, half, s->from != -1, rho + inside, p + inside, P, base);
        return;
    }
    base_line(s->n, half, stride, rho, p, w->rise + s->offset, P, base);
    if (s->axis == 0 && low && s->from == -1) wall_line(1, half, false, rho + 1, p + 1, P, base);
    if (s->axis == 0 && high && s->from + s->n == n)
        wall_line(1, half, true, rho + s->n - 1, p + s->n - 1, P + s->n - 1, base + s->n - 1);
}

KERNEL static void add_line(int n, const double *restrict P, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] += P[i];
}

void balance_through(const struct gas *g, const double *U, const struct strip *s, const struct faces *given,
                     const struct reconstruct *r) {
    struct faces f = *given;
    double P[BATCH], base[BATCH];
    const int n = s->n;
    find_base(g, U, s, P, base);
    for (int i = n; i < f.n; i++) base[i] = 0;
    f.base = base;
    f.rise = g->tiles->work.rise + s->offset;
    g->models.flux->through(&f, g->models.eos, &g->models.material, r);
    add_line(n, P, f.out[1]);
}
