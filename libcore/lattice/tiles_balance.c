/* The balance of pressure and weight at the faces of a lattice, so that gas at rest stays so to round-off.
 *
 * A row of cells whose pressures differ by the weight of half of either cell,
 *     p_1 - p_0 = h/2 (rho_0 g + rho_1 g),
 * is at rest if each face has the pressure that both its cells have there, P = p_0 + h/2 rho_0 g = p_1 - h/2 rho_1 g:
 * then the pressures on a cell's two faces differ by its weight, which weigh_row adds. So the pressure P_m in gas at
 * rest is taken from the nodal fluxes of the stencil, with the lifts a_m = minmod(h/2 rho_m g, p_(m+1) - p_m),  b_m =
 * minmod(h/2 rho_(m+1) g, p_(m+1) - p_m), P_0 = P - a_0,  P_1 = P + b_0,  P_(m+1) = P_m + a_m + b_m,  P = (p_0 + a_0 +
 * p_1 - b_0)/2, what remains is reconstructed and upwinded, and P is added again. At rest nothing remains, and no face
 * moves mass. (Kaeppeli & Mishra, Astron. Astrophys. 587, A94, 2016, do so with states.) With the minmod P lies between
 * the pressures of the two cells, and where these have no reason to differ, as in gas that falls freely, nothing is
 * taken out. Beyond a wall lies a mirror image, of gravity, too; the lift to the wall is that to the opposite face of
 * the cell. */
#include "libcore/lattice/tiles.h"

enum { CELLS = 2 * REACH + 2 }; /* of a stencil */

bool balance_acts(const struct gas *g, int axis) {
    return g->models.source.gravity[axis] != 0;
}

ALWAYS_INLINE double clip(double x, double most) {
    return smaller(larger(x, -most), most);
}

KERNEL static void lift_line(int n, double half, long stride, const double *restrict rho, const double *restrict p,
                             double *restrict left, double *restrict right) {
    for (int i = 0; i < n; i++) {
        const double a = half * rho[i], b = half * rho[i + stride];
        const double rise = clip(a + b, larger(p[i], p[i + stride])), skew = clip(a - b, fabs(rise));
        left[i] = 0.5 * (rise + skew);
        right[i] = 0.5 * (rise - skew);
    }
}

/* Computes the lifts of n faces, from face `first` of the strip on. */
static void plain_lifts(const struct gas *g, const double *U, const struct strip *s, int first, int n, bool mirrored,
                        double *left, double *right) {
    const double half = 0.5 * g->forest->width[s->axis] * g->gravity[s->axis];
    const long at = s->offset + first;
    if (n > 0)
        lift_line(n, mirrored ? -half : half, g->forest->stride[s->axis], U + at, g->tiles->work.p + at, left + first,
                  right + first);
}

/* As plain_lifts, on a wall at the low or the high side. */
static void wall_lifts(const struct gas *g, const double *U, const struct strip *s, int first, int n, bool high,
                       double *left, double *right) {
    const double half = 0.5 * g->forest->width[s->axis] * g->gravity[s->axis];
    const long at = s->offset + first + (high ? 0 : g->forest->stride[s->axis]);
    for (int i = 0; i < n; i++) {
        const double lift = clip(half * U[at + i], g->tiles->work.p[at + i]);
        left[first + i] = high ? lift : -lift;
        right[first + i] = -left[first + i];
    }
}

static bool wall_beyond(const struct gas *g, const struct strip *s, int high) {
    const int patch = g->forest->tile[s->tile].side[2 * s->axis + high].patch;
    return patch >= 0 && patch_is_wall(&g->rules[patch]);
}

/* The lifts of faces that lie at one place along the axis. */
static void lifts_across(const struct gas *g, const double *U, const struct strip *s, double *left, double *right) {
    const int last = g->forest->tile[s->tile].n[s->axis] - 1;
    const bool low = wall_beyond(g, s, 0), high = wall_beyond(g, s, 1);
    if (low && s->from == -1)
        wall_lifts(g, U, s, 0, s->n, false, left, right);
    else if (high && s->from == last)
        wall_lifts(g, U, s, 0, s->n, true, left, right);
    else
        plain_lifts(g, U, s, 0, s->n, (low && s->from < -1) || (high && s->from > last), left, right);
}

/* The lifts of faces one behind the other along axis 0. */
static void lifts_along(const struct gas *g, const double *U, const struct strip *s, double *left, double *right) {
    const bool low = wall_beyond(g, s, 0), high = wall_beyond(g, s, 1);
    /* the faces at the tile's sides, by their places in the strip */
    const int first = -1 - s->from, last = first + g->forest->tile[s->tile].n[0];
    const int from = low && first >= 0 ? first + 1 : 0, to = high && last < s->n ? last : s->n;
    plain_lifts(g, U, s, from, to - from, false, left, right);
    if (low) plain_lifts(g, U, s, 0, first, true, left, right);
    if (high) plain_lifts(g, U, s, last + 1, s->n - last - 1, true, left, right);
    if (low && first >= 0 && first < s->n) wall_lifts(g, U, s, first, 1, false, left, right);
    if (high && last >= 0 && last < s->n) wall_lifts(g, U, s, last, 1, true, left, right);
}

void balance_lifts(const struct gas *g, const double *U, const struct strip *s, double *left, double *right) {
    (s->axis == 0 ? lifts_along : lifts_across)(g, U, s, left, right);
}

/* Takes P_m from the stencils' fluxes of momentum along the normal, F, into `out`, whose cells lie stride_out apart. */
KERNEL static void take_pressure(int n, long stride, long stride_out, const double *restrict p,
                                 const double *restrict F, const double *const *left, const double *const *right,
                                 double *restrict P, double *restrict out) {
    const double *restrict a = left[REACH], *restrict b = right[REACH];
    for (int i = 0; i < n; i++) P[i] = 0.5 * ((p[i] + a[i]) + (p[i + stride] - b[i]));
    double low[BATCH], high[BATCH];
    for (int i = 0; i < n; i++) {
        low[i] = P[i] - a[i];
        high[i] = P[i] + b[i];
        out[i] = F[i] - low[i];
        out[i + stride_out] = F[i + stride] - high[i];
    }
    for (int m = 1; m <= REACH; m++) {
        const double *restrict la = left[REACH - m], *restrict lb = right[REACH - m];
        const double *restrict ha = left[REACH + m], *restrict hb = right[REACH + m];
        const double *restrict Fl = F - m * stride, *restrict Fh = F + (m + 1) * stride;
        double *restrict ol = out - m * stride_out, *restrict oh = out + (m + 1) * stride_out;
        for (int i = 0; i < n; i++) {
            low[i] -= la[i] + lb[i];
            high[i] += ha[i] + hb[i];
            ol[i] = Fl[i] - low[i];
            oh[i] = Fh[i] - high[i];
        }
    }
}

/* Adds P to the flux of momentum, and nothing else: the faces were computed without it. */
static void add_pressure(int n, const double *P, double *out) {
    for (int i = 0; i < n; i++) out[i] += P[i];
}

struct stencils { /* lines of the cells of stencils, one cell of each behind the other */
    double state[MAX_VAR][CELLS][BATCH], flux[MAX_VAR][CELLS][BATCH], velocity[MAX_DIM][CELLS][BATCH];
    double eps[CELLS][BATCH], c[CELLS][BATCH], gruneisen[CELLS][BATCH];
};

/* Copies the cells of the stencils of n faces that lie side by side; returns where the left cells are. */
static const double *spread(int n, const double *q, double (*out)[BATCH]) {
    for (int m = 0; m < CELLS; m++) memcpy(out[m], q + m - REACH, (size_t)n * sizeof(double));
    return out[REACH];
}

/* Along axis 0 the stencils of faces overlap in memory, and each has its own P_m. */
static void spread_faces(struct faces *f, struct stencils *s) {
    for (int v = 0; v < f->dim + 2; v++) {
        f->state[v] = spread(f->n, f->state[v], s->state[v]);
        if (v != 1) f->flux[v] = spread(f->n, f->flux[v], s->flux[v]);
    }
    for (int k = 0; k < f->dim; k++) f->velocity[k] = spread(f->n, f->velocity[k], s->velocity[k]);
    f->eps = spread(f->n, f->eps, s->eps);
    f->c = spread(f->n, f->c, s->c);
    f->gruneisen = spread(f->n, f->gruneisen, s->gruneisen);
    f->stride = BATCH;
}

void balance_through(const struct gas *g, const struct strip *s, const struct stencil_lifts *lifts,
                     const struct faces *given, const struct reconstruct *r) {
    struct faces f = *given;
    struct stencils spread;
    double P[BATCH], *normal = s->axis == 0 ? spread.flux[1][REACH] : g->tiles->work.normal + REACH * f.stride;
    take_pressure(f.n, f.stride, s->axis == 0 ? BATCH : f.stride, g->tiles->work.p + s->offset, f.flux[1], lifts->left,
                  lifts->right, P, normal);
    if (s->axis == 0) spread_faces(&f, &spread);
    f.flux[1] = normal;
    g->models.flux->through(&f, g->models.eos, &g->models.material, r);
    add_pressure(f.n, P, f.out[1]);
}
