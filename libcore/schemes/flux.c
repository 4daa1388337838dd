/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characteristic fluxes in the form of Shu & Osher (1989): project the nodal fluxes (and, where a field is split, the
 * states) of the stencil on an eigenbasis of the face, reconstruct each field from its upwind side, project back. The
 * fluxes below differ in the basis and in which fields are split (docs/physics.md 6.2); their sources are cited beside
 * them. A batch is cut into runs of faces that need the same work; the flux of a face does not depend on its run. */
#include "libcore/schemes/flux_private.h"

#define FAINT 0x1p-40 /* part of c that a speed must exceed to be split, if the flow has a direction */

/* always: fields of one direction are split, too. */
ALWAYS_INLINE double wind(double l, double r, const bool always, double least) {
    const double low = smaller(l, r), high = larger(l, r), alpha = larger(larger(high, -low), least);
    const double from_right = high < 0 ? UPWIND_RIGHT : alpha;
    return always ? alpha : low > 0 ? UPWIND_LEFT : from_right;
}
ALWAYS_INLINE void winds(int n, const double *restrict ul, const double *restrict cl, const double *restrict ur,
                         const double *restrict cr, const bool always, double least, struct winds *restrict w) {
    double *restrict minus = w->speed[MINUS], *restrict entropy = w->speed[ENTROPY], *restrict plus = w->speed[PLUS];
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const double u = ul[i], c = cl[i], v = ur[i], d = cr[i];
        minus[i] = wind(u - c, v - d, always, least);
        const double flow = wind(u, v, always, least), side = u + v > 0 ? UPWIND_LEFT : UPWIND_RIGHT;
        const uint64_t faint = is(flow >= 0) & is(flow <= FAINT * smaller(c, d)) & is(u + v != 0);
        entropy[i] = always ? flow : select_masked(faint, side, flow);
        plus[i] = wind(u + c, v + d, always, least);
    }
}
/* Finds the winds by Marquina's rule (Serna & Marquina, (19)-(23)): a field whose speed has one sign on both sides is
 * upwinded, others are split with the larger speed; a zero product splits. But gas at rest moves by round-off, now one
 * way and now the other: a split, which reconstructs the entropy and the shears twice, says no more there than the side
 * that the mean comes from. `always`: split all fields; `least`: smallest alpha of a split. */
KERNEL static void find_winds(int n, const double *restrict ul, const double *restrict cl, const double *restrict ur,
                              const double *restrict cr, bool always, double least, struct winds *restrict w) {
    if (always)
        winds(n, ul, cl, ur, cr, true, least, w);
    else
        winds(n, ul, cl, ur, cr, false, least, w);
}

/* Finds what the faces of each group of a batch have in common (enum faces_kind), as far as `known` tells them apart.
 * The speed of a field that is not split is negative, so that its sign bit is set, and bit 62 tells UPWIND_RIGHT from
 * UPWIND_LEFT: the bits of all faces of a group are joined by `and`, in a loop of its own, as compilers else make
 * scalars of both loops. */
KERNEL static void find_kinds(int n, const struct winds *restrict w, int known, int *restrict kind) {
    const double *restrict m = w->speed[MINUS], *restrict e = w->speed[ENTROPY], *restrict p = w->speed[PLUS];
    ALIGNED uint64_t face[BATCH];
    for (int i = 0; i < n; i++) {
        const uint64_t minus = bits_of(m[i]), entropy = bits_of(e[i]), plus = bits_of(p[i]);
        face[i] = minus >> 63 << MINUS | entropy >> 63 << ENTROPY | plus >> 63 << PLUS | (~minus >> 62 & 1) << 3 |
                  (plus >> 62 & 1) << 4;
    }
    for (int from = 0; from < n; from += GROUP) {
        const int end = n - from < GROUP ? n : from + GROUP;
        uint64_t all = SPLITS | ALL_LEFT | ALL_RIGHT;
        for (int i = from; i < end; i++) all &= face[i];
        const int splits = (int)(~all & SPLITS);
        const int side = (int)(all & (ALL_LEFT | ALL_RIGHT));
        kind[from / GROUP] = known & (splits ? splits : side ? side : MIXED);
    }
}

/* Computes the eigenvectors of docs/physics.md 6.1 for a velocity, a static enthalpy eps + p/rho, c and g = p_eps/rho:
 * total enthalpy h, b1 = g/c^2, b2 = 1 + b1 (u^2 - h); one division serves all. */
ALWAYS_INLINE void close_basis(const int dim, const double *u, double enthalpy, double c, double g,
                               struct bases *restrict b, int i) {
    double inverse = 1 / (c * g), inverse_c = g * inverse, b1 = g * inverse_c * inverse_c, t = 0;
    if (dim == 2) t = u[1] * u[1];
    if (dim == 3) t = u[1] * u[1] + u[2] * u[2];
    double square = u[0] * u[0] + t, h = fma(0.5, square, enthalpy);
    b->u[0][i] = u[0];
    if (dim > 1) b->u[1][i] = u[1];
    if (dim > 2) b->u[2][i] = u[2];
    b->c[i] = c;
    b->h[i] = h;
    b->half_b1[i] = 0.5 * b1;
    b->half_b2[i] = 0.5 * fma(b1, square - h, 1);
    b->inverse_b1[i] = c * c * (c * inverse);
    b->half_inverse_c[i] = 0.5 * inverse_c;
}

ALWAYS_INLINE void state_bases_dim(const int dim, int n, const struct face_states *restrict s,
                                   struct bases *restrict b) {
    for (int i = 0; i < n; i++) {
        double u[MAX_DIM] = {s->u[0][i], dim > 1 ? s->u[1][i] : 0, dim > 2 ? s->u[2][i] : 0};
        close_basis(dim, u, enthalpy_of(s->eps[i], s->gruneisen[i]), sqrt(s->c[i]), s->gruneisen[i], b, i);
    }
}

KERNEL static void state_bases(int dim, int n, const struct face_states *restrict s, struct bases *restrict b) {
    if (dim == 1) state_bases_dim(1, n, s, b);
    if (dim == 2) state_bases_dim(2, n, s, b);
    if (dim == 3) state_bases_dim(3, n, s, b);
}

struct pair { /* values of a face's two cells */
    double l, r;
};
/* Both values are the upwind cell's where `left` or `right` has all bits set. */
ALWAYS_INLINE struct pair upwind_pair(const double *q, long i, long stride, uint64_t left, uint64_t right) {
    const double l = q[i], r = q[i + stride];
    return (struct pair){select_masked(right, r, l), select_masked(left, l, r)};
}

ALWAYS_INLINE void common_bases_dim(const int dim, const struct faces *f, const struct winds *restrict w,
                                    struct bases *restrict b) {
    const double *restrict minus = w->speed[MINUS], *restrict plus = w->speed[PLUS];
    const double *eps = f->eps, *c = f->c, *g = f->gruneisen, *u0 = f->velocity[0];
    const double *u1 = dim > 1 ? f->velocity[1] : u0, *u2 = dim > 2 ? f->velocity[2] : u0;
    const long s = f->stride;
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const uint64_t left = -(uint64_t)(minus[i] == UPWIND_LEFT), right = -(uint64_t)(plus[i] == UPWIND_RIGHT);
        const struct pair e = upwind_pair(eps, i, s, left, right), a = upwind_pair(c, i, s, left, right);
        const struct pair G = upwind_pair(g, i, s, left, right), U = upwind_pair(u0, i, s, left, right);
        const struct pair V = upwind_pair(u1, i, s, left, right), W = upwind_pair(u2, i, s, left, right);
        const double u[MAX_DIM] = {0.5 * (U.l + U.r), 0.5 * (V.l + V.r), 0.5 * (W.l + W.r)};
        close_basis(dim, u, 0.5 * (enthalpy_of(e.l, G.l) + enthalpy_of(e.r, G.r)), sqrt(0.5 * (a.l * a.l + a.r * a.r)),
                    0.5 * (G.l + G.r), b, i);
    }
}

/* Computes one basis per face, the common basis (docs/physics.md 6.3), from the means of the two cells' u, static
 * enthalpy, c^2 and g. For the perfect gas this
 * is the basis of the mean (u, T), which keeps contacts exactly; for other equations of state it is as accurate as the
 * basis of the mean state, without evaluating them. Where all speeds have one sign both states are the upwind cell's,
 * so that nothing downwind of a supersonic face touches its flux, not even by round-off. */
KERNEL static void common_bases(const struct faces *f, const struct winds *restrict w, struct bases *restrict b) {
    if (f->dim == 1) common_bases_dim(1, f, w, b);
    if (f->dim == 2) common_bases_dim(2, f, w, b);
    if (f->dim == 3) common_bases_dim(3, f, w, b);
}

/* Projects back: F = sum over the fields of amplitude times column of R, added to `out` if `add`. n: of the amplitudes'
 * faces. */
ALWAYS_INLINE void back(const int dim, int from, int to, const struct bases *restrict b, int n,
                        const double *restrict a, const bool add, double *const out[MAX_VAR]) {
    const double *restrict minus = a, *restrict entropy = a + n, *restrict plus = a + (dim + 1) * n;
    const double *restrict shear = a + 2 * n, *restrict other = a + 3 * n;
    double *restrict f0 = out[0], *restrict fn = out[1], *restrict fe = out[dim + 1];
    double *restrict f2 = dim > 1 ? out[2] : f0, *restrict f3 = dim > 2 ? out[3] : f0;
    EACH_ALONE
    for (int i = from; i < to; i++) {
        double sum = minus[i] + plus[i] + entropy[i], swing = b->c[i] * (plus[i] - minus[i]), t = 0;
        double u0 = b->u[0][i], u1 = dim > 1 ? b->u[1][i] : 0, u2 = dim > 2 ? b->u[2][i] : 0;
        if (dim == 2) t = u1 * shear[i];
        if (dim == 3) t = u1 * shear[i] + u2 * other[i];
        double re = fma(b->h[i], sum, -(b->inverse_b1[i] * entropy[i])) + fma(u0, swing, t);
        double rn = fma(u0, sum, swing), r2 = dim > 1 ? fma(u1, sum, shear[i]) : 0;
        double r3 = dim > 2 ? fma(u2, sum, other[i]) : 0;
        f0[i] = add ? f0[i] + sum : sum;
        fn[i] = add ? fn[i] + rn : rn;
        if (dim > 1) f2[i] = add ? f2[i] + r2 : r2;
        if (dim > 2) f3[i] = add ? f3[i] + r3 : r3;
        fe[i] = add ? fe[i] + re : re;
    }
}

KERNEL static void project_back(int dim, int from, int to, const struct bases *restrict b, int n,
                                const double *restrict a, bool add, double *const out[MAX_VAR]) {
    if (dim == 1 && !add) back(1, from, to, b, n, a, false, out);
    if (dim == 2 && !add) back(2, from, to, b, n, a, false, out);
    if (dim == 3 && !add) back(3, from, to, b, n, a, false, out);
    if (dim == 1 && add) back(1, from, to, b, n, a, true, out);
    if (dim == 2 && add) back(2, from, to, b, n, a, true, out);
    if (dim == 3 && add) back(3, from, to, b, n, a, true, out);
}

/* Splits the entropy of the faces of shocks with max(|u| + c), by PHM (if the user's reconstruction is not of first
 * order), in the amplitudes a of the other fields' run. */
static void damp_shocks(int from, int to, const struct faces *f, const struct bases *b, const struct winds *w,
                        const double *shock, const struct reconstruct *r, double *a) {
    struct winds fast = *w;
    double damped[COLUMNS], *entropy = a + f->n, *split = damped + (to - from);
    int kind[BATCH / GROUP];
    for (int k = 0; k < BATCH / GROUP; k++) kind[k] = SPLIT_ENTROPY;
    for (int i = from; i < to; i++) {
        const double *u = f->velocity[0] + i, *c = f->c + i;
        const double most = larger(fabs(u[0]) + c[0], fabs(u[f->stride]) + c[f->stride]);
        fast.speed[ENTROPY][i] = shock[i] > 0 ? most : w->speed[ENTROPY][i];
    }
    characteristic_common(r->reach > 0 ? reconstruct_find("PHM") : r, from, to, kind, f, b, &fast, damped);
    for (int i = from; i < to; i++) entropy[i] = shock[i] > 0 ? split[i - from] : entropy[i];
}

/* rules: NULL where the flux has none. */
static void one_basis(const struct faces *f, const struct reconstruct *r, const struct winds *w,
                      const struct rules *rules) {
    struct bases b;
    ALIGNED double a[COLUMNS];
    int kind[BATCH / GROUP];
    common_bases(f, w, &b);
    find_kinds(f->n, w, SPLITS, kind);
    characteristic_common(r, 0, f->n, kind, f, &b, w, a);
    if (rules && rules->shocks.from < rules->shocks.to)
        damp_shocks(rules->shocks.from, rules->shocks.to, f, &b, w, rules->shock, r, a);
    project_back(f->dim, 0, f->n, &b, f->n, a, false, f->out);
}

static void winds_of_cells(const struct faces *f, bool always, double least, struct winds *w) {
    const long d = f->stride;
    find_winds(f->n, f->velocity[0], f->c, f->velocity[0] + d, f->c + d, always, least, w);
}

/* The common flux with the rules of single faces. */
static void nonlinear(const struct faces *f, const struct eos *eos, const struct material *m,
                      const struct reconstruct *r) {
    struct winds w;
    struct rules rules;
    winds_of_cells(f, false, 0, &w);
    rules_find(f, &w, &rules);
    if (f->floor) rules_fronts(f, &w);
    one_basis(f, r, &w, &rules);
    rules_contacts(f, eos, m, r, &rules);
}

/* Takes values of q where marked. */
KERNEL static void take_marked(int n, const double *restrict mark, const double *restrict q, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = mark[i] > 0 ? q[i] : out[i];
}

/* Runs that hold rough faces take the nonlinear flux, and smooth faces the linear one. */
static void hybrid(const struct faces *f, const struct eos *eos, const struct material *m,
                   const struct reconstruct *r) {
    double rough[BATCH];
    struct face_span s = {0, 0};
    const int count = smooth_find(f, rough);
    if (count == f->n) {
        nonlinear(f, eos, m, r);
        return;
    }
    while (count > 0 && smooth_ends(f->n, rough, &s)) {
        const struct faces part = faces_of_span(f, s);
        nonlinear(&part, eos, m, r);
    }
    smooth_through(f, rough);
}

static void common(const struct faces *f, const struct eos *eos, const struct material *m,
                   const struct reconstruct *r) {
    const bool smooth = f->p && r->reach > 1 && rules_wanted(f->params, true, f->falls).smooth;
    (smooth ? hybrid : nonlinear)(f, eos, m, r);
}
static void local_lax_friedrichs(const struct faces *f, const struct eos *eos, const struct material *m,
                                 const struct reconstruct *r) {
    (void)eos, (void)m;
    struct winds w;
    winds_of_cells(f, true, 0, &w);
    one_basis(f, r, &w, NULL);
}
static void global_lax_friedrichs(const struct faces *f, const struct eos *eos, const struct material *m,
                                  const struct reconstruct *r) {
    (void)eos, (void)m;
    struct winds w;
    winds_of_cells(f, true, f->fastest, &w);
    one_basis(f, r, &w, NULL);
}

/* Replaces a reconstructed state that is not admissible by the cell's state. */
KERNEL static void admit(int n, int dim, double limit, const double *restrict rho, const double *const u[MAX_DIM],
                         const double *restrict eps, struct face_states *restrict s) {
    for (int i = 0; i < n; i++) {
        bool good = s->rho[i] > 0 && s->rho[i] < limit && s->eps[i] > 0;
        s->rho[i] = good ? s->rho[i] : rho[i];
        s->eps[i] = good ? s->eps[i] : eps[i];
        s->good[i] = good ? 1 : 0;
    }
    for (int k = 0; k < dim; k++) {
        const double *restrict uk = u[k];
        for (int i = 0; i < n; i++) s->u[k][i] = s->good[i] > 0 ? s->u[k][i] : uk[i];
    }
}

void flux_reconstruct_lines(const struct faces *f, const struct reconstruct *r, const double *const line[5],
                            double *out) {
    r->face(f->n, line, out);
    if (f->flat) take_marked(f->n, f->flat, line[2], out);
}

void flux_reconstruct(const struct faces *f, const double *q, int side, const struct reconstruct *r, double *out) {
    const double *line[5];
    for (int m = 0; m < 5; m++) line[m] = q + (side > 0 ? m - 2 : 3 - m) * f->stride;
    flux_reconstruct_lines(f, r, line, out);
}

KERNEL static void velocity_from(int n, const double *restrict q, const double *restrict from, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = q[i] - from[i];
}

void flux_sided_velocity(const struct faces *f, int k, int side, const struct reconstruct *r, double *out) {
    double line[5][BATCH];
    const double *u = f->velocity[k], *cell = u + (side > 0 ? 0 : f->stride);
    if (k == 0 || r->reach < 2) {
        flux_reconstruct(f, u, side, r, out);
        return;
    }
    for (int m = 0; m < 5; m++) velocity_from(f->n, u + (side > 0 ? m - 2 : 3 - m) * f->stride, cell, line[m]);
    flux_reconstruct_lines(f, r, (const double *const[]){line[0], line[1], line[2], line[3], line[4]}, out);
    for (int i = 0; i < f->n; i++) out[i] += cell[i];
}

void flux_sided_states(const struct faces *f, const struct eos *eos, const struct material *m, int side,
                       const struct reconstruct *r, struct face_states *s) {
    int n = f->n, dim = f->dim;
    long cell = side > 0 ? 0 : f->stride;
    const double *u[MAX_DIM] = {0};
    flux_reconstruct(f, f->state[0], side, r, s->rho);
    flux_reconstruct(f, f->eps, side, r, s->eps);
    for (int k = 0; k < dim; k++) {
        flux_sided_velocity(f, k, side, r, s->u[k]);
        u[k] = f->velocity[k] + cell;
    }
    admit(n, dim, density_limit(eos, m), f->state[0] + cell, u, f->eps + cell, s);
    eos->state(m, n, s->rho, s->eps, s->p, s->c, s->gruneisen);
}

struct two_bases { /* states and bases to the left (0) and to the right (1) of the faces */
    struct face_states s[2];
    struct bases b[2];
    struct winds w;
    ALIGNED double on[BATCH], base[2][BATCH]; /* under gravity, as in struct faces: what is taken (ease_dim) */
    double restored[BATCH];                   /* what is added to the flux, less the caller's */
    double rests[BATCH];                      /* part (1 - moves) of ease_dim */
};

/* Eases what two bases take of the pressure P of gas at rest (docs/physics.md 7.4). The cells m of a stencil lose
 *     part (P_m - moves P) in place of P_m, and part (1 - moves) P is added in place of P,
 *     moves = 2 rho c |u_n|/(weight of half of either cell) - 1,   part = 2 - 2 rho u^2/p,   both from 0 to 1.
 * For two bases do not give back a uniform pressure: (Q_l + Q_r)(0, P, 0 ..) is (0, P, 0 ..) and a part of the order of
 * the jump (struct excess). That part holds down the heating of walls, and cells beside them zigzag without it; at rest
 * it would move mass. So it is there as soon as the pressure of the motion's sound reaches the weight, and not at all
 * up to half of that, where it would make noise grow. Gas whose dynamic pressure exceeds its pressure is not carried by
 * it, and has the flux without gravity, that of the paper. */
ALWAYS_INLINE void ease_dim(const int dim, int n, const struct faces *f, struct two_bases *restrict t) {
    const double *restrict on = f->on, *restrict P = f->rest, *restrict low = f->base[0], *restrict high = f->base[1];
    const struct face_states *restrict l = &t->s[0], *restrict r = &t->s[1];
    for (int i = 0; i < n; i++) {
        double left = 0, right = 0; /* u^2, from the last axis of the mesh on */
        for (int k = dim - f->beyond - 1; k >= 0; k--) {
            left += l->u[k][i] * l->u[k][i];
            right += r->u[k][i] * r->u[k][i];
        }
        const double weight = fabs(P[i] - low[i]) + fabs(P[i] - high[i]);
        const double sound =
            0.125 * (l->rho[i] + r->rho[i]) * (t->b[0].c[i] + t->b[1].c[i]) * (fabs(l->u[0][i]) + fabs(r->u[0][i]));
        const double dynamic = l->rho[i] * left + r->rho[i] * right, p = l->p[i] + r->p[i];
        const double part = 2 * dynamic > p ? larger(2 - 2 * dynamic / p, 0) : 1;
        const double moves = sound < weight ? larger(2 * sound / weight - 1, 0) : 1;
        t->on[i] = part * on[i];
        t->base[0][i] = part * (low[i] - moves * P[i]);
        t->base[1][i] = part * (high[i] - moves * P[i]);
        t->rests[i] = t->on[i] * (1 - moves);
        t->restored[i] = t->rests[i] * P[i] - P[i];
    }
}

KERNEL static void ease(int dim, int n, const struct faces *f, struct two_bases *restrict t) {
    if (dim == 1) ease_dim(1, n, f, t);
    if (dim == 2) ease_dim(2, n, f, t);
    if (dim == 3) ease_dim(3, n, f, t);
}

static bool is_any(int n, const double *q) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) any |= is(q[i] != 0);
    return any != 0;
}

/* A zero is not added: it would change the sign of another. */
KERNEL static void restore(int n, const double *restrict restored, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = restored[i] != 0 ? out[i] + restored[i] : out[i];
}

/* Computes the fluxes from the amplitudes of both sides. */
static void back_apart(const struct faces *f, const struct two_bases *t, const int *kind, const double *left,
                       const double *right) {
    for (int from = 0, to; from < f->n; from = to) {
        const int side = kind[from / GROUP] & (ALL_LEFT | ALL_RIGHT);
        for (to = from + GROUP; to < f->n && (kind[to / GROUP] & (ALL_LEFT | ALL_RIGHT)) == side;) to += GROUP;
        to = to < f->n ? to : f->n;
        project_back(f->dim, from, to, &t->b[side == ALL_RIGHT], f->n, left, false, f->out);
        if (!side) project_back(f->dim, from, to, &t->b[1], f->n, right, true, f->out);
    }
}

static void two_bases_flux(const struct faces *given, const struct eos *eos, const struct material *m,
                           const struct reconstruct *r, struct two_bases *t) {
    const struct faces *f = given;
    const struct bases *b = t->b;
    struct faces eased = *given;
    int kind[BATCH / GROUP];
    ALIGNED double left[COLUMNS], right[COLUMNS];
    for (int s = 0; s < 2; s++) {
        flux_sided_states(f, eos, m, s == 0 ? 1 : -1, r, &t->s[s]);
        state_bases(f->dim, f->n, &t->s[s], &t->b[s]);
    }
    if (given->rise) {
        ease(f->dim, f->n, f, t);
        eased.on = t->on;
        eased.base[0] = t->base[0];
        eased.base[1] = t->base[1];
        eased.rise = is_any(f->n, t->on) ? f->rise : NULL;
        f = &eased;
    }
    find_winds(f->n, b[0].u[0], b[0].c, b[1].u[0], b[1].c, false, 0, &t->w);
    find_kinds(f->n, &t->w, SPLITS | ALL_LEFT | ALL_RIGHT | MIXED, kind);
    characteristic_apart(r, kind, f, b, &t->w, left, right);
    back_apart(f, t, kind, left, right);
    if (given->rise) restore(f->n, t->restored, f->out[1]);
}

/* Marquina's flux (docs/physics.md 6.4): Donat & Marquina (1996), Serna & Marquina (19)-(23) with w_r in phi_-
 * (docs/physics.md S6). The bases belong
 * to the reconstructed face states: with the cells' states the flux is first order only. */
static void marquina(const struct faces *f, const struct eos *eos, const struct material *m,
                     const struct reconstruct *r) {
    struct two_bases t;
    two_bases_flux(f, eos, m, r, &t);
}

/* Marquina's flux of two states l, r (docs/physics.md 6.5) is that of an upwind scheme with the fluxes measured from f*
 * = (f_l + f_r)/2 (and states from their mean), plus D = (Q_l + Q_r - 1) f*. Q_l f is the part of f that the fields
 * take from the left side on its basis, Q_r f likewise. D is of the order of the jump and belongs to Marquina's flux
 * alone. It damps shocks along the grid and the heating of walls. But it makes entropy in dense gas, at rest above
 * alpha 0.45, and noise grows there (postprocessing/reports/marquinaStability.md). */
struct excess {
    ALIGNED double f[MAX_VAR][BATCH], u[MAX_VAR][BATCH]; /* means of the two sides */
    double jump[MAX_VAR][BATCH], D[MAX_VAR][BATCH];
};

/* rest: the pressure of gas at rest on both sides, which the flux is without. */
ALWAYS_INLINE void means_dim(const int dim, int n, const struct face_states s[2], const double (*rest)[BATCH],
                             struct excess *restrict e) {
    for (int i = 0; i < n; i++) {
        double U[2][MAX_VAR], F[2][MAX_VAR];
        for (int k = 0; k < 2; k++) {
            double rho = s[k].rho[i], u0 = s[k].u[0][i], u1 = dim > 1 ? s[k].u[1][i] : 0,
                   u2 = dim > 2 ? s[k].u[2][i] : 0;
            double t = dim == 2 ? u1 * u1 : dim == 3 ? u1 * u1 + u2 * u2 : 0, p = s[k].p[i];
            U[k][0] = rho;
            U[k][1] = rho * u0;
            if (dim > 1) U[k][2] = rho * u1;
            if (dim > 2) U[k][3] = rho * u2;
            U[k][dim + 1] = rho * (s[k].eps[i] + 0.5 * (u0 * u0 + t));
            for (int v = 0; v < dim + 2; v++) F[k][v] = U[k][v] * u0;
            F[k][1] += p - rest[k][i];
            F[k][dim + 1] += p * u0;
        }
        for (int v = 0; v < dim + 2; v++) {
            e->f[v][i] = 0.5 * (F[0][v] + F[1][v]);
            e->u[v][i] = 0.5 * (U[0][v] + U[1][v]);
            e->jump[v][i] = U[1][v] - U[0][v];
        }
    }
}

KERNEL static void means(int dim, int n, const struct face_states s[2], const double (*rest)[BATCH],
                         struct excess *restrict e) {
    if (dim == 1) means_dim(1, n, s, rest, e);
    if (dim == 2) means_dim(2, n, s, rest, e);
    if (dim == 3) means_dim(3, n, s, rest, e);
}

/* Computes (Q_l + Q_r) f*: first-order upwinding of the means on the two bases. tame_dim subtracts f* to get D. */
static void excess_of(const struct faces *f, const struct two_bases *t, struct excess *e) {
    struct faces mean = {.n = f->n, .dim = f->dim};
    double left[COLUMNS], right[COLUMNS], *D[MAX_VAR];
    int kind[BATCH / GROUP];
    for (int v = 0; v < f->dim + 2; v++) {
        mean.flux[v] = e->f[v];
        mean.state[v] = e->u[v];
        D[v] = e->D[v];
    }
    find_kinds(f->n, &t->w, SPLITS, kind);
    characteristic_apart(reconstruct_find("firstOrder"), kind, &mean, t->b, &t->w, left, right);
    project_back(f->dim, 0, f->n, &t->b[0], f->n, left, false, D);
    project_back(f->dim, 0, f->n, &t->b[1], f->n, right, true, D);
}

/* A change of state as dp/c^2, rho du_n/c, rho du_t, and drho at constant p: in these variables |A| is symmetric. */
struct change {
    double p, normal, tangent[2], entropy;
};
ALWAYS_INLINE struct change change_of(const int dim, const struct eigenrows l, const double *const q[MAX_VAR], int i) {
    const struct fields w = project(dim, l, q, i, q[1][i]);
    return (struct change){w.plus + w.minus, w.plus - w.minus, {w.shear[0], w.shear[1]}, w.entropy};
}
/* Returns the product of two changes that the second derivative of the entropy makes, times -rho T: the entropy's
 * change weighs (c^2/(g^2 eps) - 1). */
ALWAYS_INLINE double product(double c2, double weight, const struct change a, const struct change b) {
    double t = a.tangent[0] * b.tangent[0] + a.tangent[1] * b.tangent[1];
    return c2 * (a.p * b.p + a.normal * b.normal + weight * (a.entropy * b.entropy)) + t;
}
ALWAYS_INLINE double entropy_weight(const struct face_states *s, int i) {
    return s->c[i] / (s->gruneisen[i] * s->gruneisen[i] * s->eps[i]) - 1;
}

/* Removes from the flux the part of D that makes entropy: where D.dv > 0 with the jump dv of the entropy's derivatives,
 * it subtracts the multiple of dU that leaves D.dv = 0. The remaining D is held to half of what upwinding may
 * dissipate, |D| <= s |dU|/4, s = max(|u| + c) + du^2/c (the last term for shocks, where dU says little about D). Else
 * D would grow without bound towards close packing, and the steps would have to be shorter than the speed of sound asks
 * for. Where nothing is removed the flux keeps its bits. */
ALWAYS_INLINE void tame_dim(const int dim, int n, const struct two_bases *restrict x, const struct bases *restrict mean,
                            struct excess *restrict e, double *const out[MAX_VAR]) {
    const double *restrict minus = x->w.speed[MINUS], *restrict plus = x->w.speed[PLUS];
    const double *D[MAX_VAR], *dU[MAX_VAR];
    for (int v = 0; v < dim + 2; v++) {
        for (int i = 0; i < n; i++) e->D[v][i] -= e->f[v][i];
        D[v] = e->D[v];
        dU[v] = e->jump[v];
    }
    for (int i = 0; i < n; i++) {
        const struct eigenrows l = rows_at(dim, mean, i);
        const struct change a = change_of(dim, l, D, i), b = change_of(dim, l, dU, i);
        double c = mean->c[i], weight = 0.5 * (entropy_weight(&x->s[0], i) + entropy_weight(&x->s[1], i));
        double ab = product(c * c, weight, a, b), bb = product(c * c, weight, b, b);
        bool active = bb > 0 && minus[i] != UPWIND_LEFT && plus[i] != UPWIND_RIGHT;
        double made = active && ab > 0 ? ab / bb : 0, du = x->s[1].u[0][i] - x->s[0].u[0][i];
        double fast = larger(fabs(x->s[0].u[0][i]) + x->b[0].c[i], fabs(x->s[1].u[0][i]) + x->b[1].c[i]);
        double most = 0.25 * (fast + du * du / c), left = product(c * c, weight, a, a) - made * ab;
        double keep = active && left > most * most * bb ? sqrt(most * most * bb / left) : 1;
        double drop = 1 - keep, shift = keep * made;
        for (int v = 0; v < dim + 2; v++) out[v][i] -= drop * D[v][i] + shift * dU[v][i];
    }
}

KERNEL static void tame(int dim, int n, const struct two_bases *restrict x, const struct bases *restrict mean,
                        struct excess *restrict e, double *const out[MAX_VAR]) {
    if (dim == 1) tame_dim(1, n, x, mean, e, out);
    if (dim == 2) tame_dim(2, n, x, mean, e, out);
    if (dim == 3) tame_dim(3, n, x, mean, e, out);
}

/* The pressure of gas at rest in both reconstructed states: what the flux takes from their cells, and what p of the
 * states differs by from p that is reconstructed without it, so that nothing is left of gas at rest. */
static void rests_of_states(const struct faces *f, const struct two_bases *t, const struct reconstruct *r,
                            double (*rest)[BATCH]) {
    double p[BATCH];
    const bool any = is_any(f->n, t->rests);
    for (int side = 0; side < 2; side++) {
        memcpy(rest[side], t->base[side], (size_t)f->n * sizeof(double));
        if (!any) continue;
        flux_sided_pressure(f, side ? -1 : 1, r, p);
        for (int i = 0; i < f->n; i++)
            rest[side][i] += t->rests[i] * ((t->s[side].p[i] - f->base[side][i]) - (p[i] - f->rest[i]));
    }
}

static bool all_one_way(int n, const struct winds *w) {
    for (int i = 0; i < n; i++)
        if (w->speed[MINUS][i] != UPWIND_LEFT && w->speed[PLUS][i] != UPWIND_RIGHT) return false;
    return true;
}

static void marquina_stable(const struct faces *f, const struct eos *eos, const struct material *m,
                            const struct reconstruct *r) {
    struct two_bases t;
    struct excess e;
    struct bases mean;
    double rest[2][BATCH] = {{0}};
    two_bases_flux(f, eos, m, r, &t);
    if (all_one_way(f->n, &t.w)) return;
    if (f->rise) rests_of_states(f, &t, r, rest);
    means(f->dim, f->n, t.s, (const double(*)[BATCH])rest, &e);
    excess_of(f, &t, &e);
    common_bases(f, &t.w, &mean);
    tame(f->dim, f->n, &t, &mean, &e, f->out);
}

static const char *const rule_words[] = {"off", "on", "lattices", NULL};
#define PARAM_STRUCT     struct common_rules
#define RULE(name, text) CHOICE(#name, name, RULE_LATTICES, rule_words, text)
static const struct param common_param[] = {
    RULE(shocks, "strong shocks are damped in entropy, too, so that they leave less noise behind"),
    RULE(expansions, "steep expansions are damped less, so that they heat dense gas less; not under gravity"),
    RULE(contacts, "contacts of dense gas get the flux HLLC, which keeps their pressure"),
    CHOICE("fronts", fronts, RULE_ON, rule_words,
           "entropy and shears are damped beside fronts of shocks, so that these stay straight (2D, 3D)"),
    SWITCH("smooth", smooth, true,
           "where the gas varies smoothly, fluxes are linear of fifth order, which is faster and more accurate; for "
           "WPENO5, WENO5, WENOZ and TENO5 on lattices without gravity"),
};
#undef RULE
#undef PARAM_STRUCT

/* FORCE and MUSTA (docs/physics.md 6.7) are in flux_force.c. */
#define PARAM_STRUCT struct musta
static const struct param musta_param[] = {
    NUMBER("tolerance", tolerance, 0.01, FROM_TO(0, 1), NO_UNIT, "stops when the flux changes by less of itself"),
    WHOLE("stages", stages, 4, FROM_TO(0, 1000), "most times that the states of a face are advanced; 0: FORCE"),
};
#undef PARAM_STRUCT

/* Rusanov's flux (docs/physics.md 6.6): F = (f_l + f_r)/2 - s (u_r - u_l)/2, s = max(|u_l| + c_l, |u_r| + c_r). */
KERNEL static void rusanov_line(int n, const double *restrict s, const double *restrict fl, const double *restrict fr,
                                const double *restrict ul, const double *restrict ur, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = 0.5 * (fl[i] + fr[i]) - 0.5 * s[i] * (ur[i] - ul[i]);
}

/* The momentum of gas at rest that is taken from both sides. */
KERNEL static void rusanov_rest(int n, const double *restrict left, const double *restrict right,
                                double *restrict out) {
    for (int i = 0; i < n; i++) out[i] -= 0.5 * (left[i] + right[i]);
}

KERNEL static void rusanov_speed(int n, const double *restrict ul, const double *restrict cl, const double *restrict ur,
                                 const double *restrict cr, double *restrict s) {
    for (int i = 0; i < n; i++) s[i] = larger(fabs(ul[i]) + cl[i], fabs(ur[i]) + cr[i]);
}

void flux_rusanov(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r) {
    (void)eos, (void)m, (void)r;
    double s[BATCH];
    rusanov_speed(f->n, f->velocity[0], f->c, f->velocity[0] + f->stride, f->c + f->stride, s);
    for (int v = 0; v < f->dim + 2; v++)
        rusanov_line(f->n, s, f->flux[v], f->flux[v] + f->stride, f->state[v], f->state[v] + f->stride, f->out[v]);
    if (f->rise) rusanov_rest(f->n, f->base[0], f->base[1], f->out[1]);
}

const struct flux flux_table[] = {
    {MODEL_WITH("common", "characteristic upwind on one eigenbasis a face", common_param), .through = common,
     .means = true, .ruled = true},
    {MODEL("Marquina", "two bases at the reconstructed face states (Donat & Marquina 1996); unstable in dense gas"),
     .through = marquina},
    {MODEL("MarquinaStable", "Marquina's without the part that makes entropy: for dense gas, too"),
     .through = marquina_stable},
    {MODEL("FORCE", "centred, from both face states and dt/dx (Toro 1996)"), .through = flux_force, .paced = true,
     .damps = true},
    {MODEL_WITH("MUSTA", "FORCE in stages towards Godunov's flux (Titarev & Toro 2004; Shakeri et al.)", musta_param),
     .through = flux_musta, .paced = true, .damps = true},
    {MODEL("LaxFriedrichs", "characteristic, every field split with the face's speed"), .through = local_lax_friedrichs,
     .means = true, .damps = true},
    {MODEL("globalLaxFriedrichs", "characteristic, every field split with the domain's largest speed"),
     .through = global_lax_friedrichs, .means = true, .damps = true},
    {MODEL("Rusanov", "first order, the most robust (ignores reconstruct)"), .through = flux_rusanov, .means = true,
     .damps = true},
};
const int flux_count = sizeof flux_table / sizeof *flux_table;

const struct flux *flux_find(const char *name) {
    return model_find(flux_table, sizeof *flux_table, flux_count, name);
}

void flux_eigenvectors(int dim, const struct basis *given, double left[MAX_VAR][MAX_VAR],
                       double right[MAX_VAR][MAX_VAR]) {
    struct bases b;
    double kinetic = 0;
    for (int k = 0; k < dim; k++) kinetic += 0.5 * given->u[k] * given->u[k];
    close_basis(dim, given->u, given->h - kinetic, given->c, given->b1 * given->c * given->c, &b, 0);
    for (int v = 0; v < dim + 2; v++) {
        double unit[MAX_VAR] = {0}, column[MAX_VAR];
        unit[v] = 1;
        const double *q[MAX_VAR] = {0};
        double *out[MAX_VAR];
        for (int k = 0; k < dim + 2; k++) {
            q[k] = &unit[k];
            out[k] = &column[k];
        }
        struct fields w = project(dim, rows_at(dim, &b, 0), q, 0, unit[1]);
        project_back(dim, 0, 1, &b, 1, unit, false, out);
        left[0][v] = w.minus;
        left[1][v] = w.entropy;
        for (int k = 2; k <= dim; k++) left[k][v] = w.shear[k - 2];
        left[dim + 1][v] = w.plus;
        for (int k = 0; k < dim + 2; k++) right[k][v] = column[k];
    }
}
