/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the faces that follow a rule of their own (flux_private.h; docs/physics.md 6.12), and computes the flux of
 * contacts. */
#include "libcore/schemes/flux_private.h"

#define PACKED 16. /* Grueneisen coefficient above which expansions are damped more and more */

/* The loops below go over n faces from face `from` on, a group: with as many as a vector holds they are one. */

ALWAYS_INLINE double most_of(const double *restrict q, long s) {
    return larger(larger(q[-s], q[2 * s]), larger(q[0], q[s]));
}
ALWAYS_INLINE double least_of(const double *restrict q, long s) {
    return smaller(smaller(q[-s], q[2 * s]), smaller(q[0], q[s]));
}

enum { SHOCK = 1, EXPANSION = 2, CONTACT = 4 }; /* bits of a set of rules */

/* Finds the rules that each face may follow, and returns those that any may: the six cells of a shock differ in p and
 * are compressed, those of an expansion differ in p; contacts are found themselves. */
ALWAYS_INLINE uint64_t look(int n, long s, const double *restrict p, const double *restrict u, const double *restrict g,
                            uint64_t *restrict may) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        const double *q = p + i, *v = u + i, *h = g + i;
        const double most = most_of(q, s), high = larger(most, larger(q[-2 * s], q[3 * s]));
        const double least = least_of(q, s), low = smaller(least, smaller(q[-2 * s], q[3 * s]));
        const uint64_t compressed = is(v[-s] > v[0]) | is(v[0] > v[s]) | is(v[s] > v[2 * s]);
        const uint64_t contact = is(most < STEEP * least) & is(most_of(h, s) > DENSER * least_of(h, s));
        may[i] =
            (is(high > STRONG * low) & compressed & SHOCK) | (is(high > STEEP * low) & EXPANSION) | (contact & CONTACT);
        any |= may[i];
    }
    return any;
}

/* Do the waves of the face run both ways? */
ALWAYS_INLINE int runs_both_ways(const struct winds *restrict w, int i) {
    return (w->speed[MINUS][i] != UPWIND_LEFT) & (w->speed[PLUS][i] != UPWIND_RIGHT);
}

/* Is there a strong shock between the ends a and b of four cells, the face in whose middle lies right of cell `mid`?
 * Its jumps fulfil du^2 = dp (1/rho_low - 1/rho_high), roughly so while it lies within a few cells. */
ALWAYS_INLINE int is_shock(const int dim, const double *restrict rho, const double *restrict p,
                           const double *restrict u0, const double *restrict u1, const double *restrict u2, long mid,
                           long s) {
    const long a = mid - s, b = mid + 2 * s;
    const double du = u0[a] - u0[b], d1 = dim > 1 ? u1[a] - u1[b] : 0, d2 = dim > 2 ? u2[a] - u2[b] : 0;
    const double du2 = du * du + (d1 * d1 + d2 * d2);
    return (du > 0) & near_hugoniot(du2, rho[a], rho[b], p[a], p[b]) & (u0[mid] > u0[mid + s]);
}

/* Marks shocks; no bit of the result is set if there are none. (The other two likewise.) */
ALWAYS_INLINE uint64_t mark_shocks(const int dim, int from, const int n, const struct faces *f,
                                   const struct winds *restrict w, double *restrict mark) {
    const double *rho = f->state[0], *p = f->p, *u0 = f->velocity[0];
    const double *u1 = dim > 1 ? f->velocity[1] : u0, *u2 = dim > 2 ? f->velocity[2] : u0;
    const long s = f->stride;
    uint64_t any = 0;
    EACH_ALONE
    for (int i = from; i < from + n; i++) {
        const int shock = is_shock(dim, rho, p, u0, u1, u2, i - s, s) | is_shock(dim, rho, p, u0, u1, u2, i, s) |
                          is_shock(dim, rho, p, u0, u1, u2, i + s, s);
        mark[i] = (shock & runs_both_ways(w, i)) ? 1 : 0;
        any |= bits_of(mark[i]);
    }
    return any;
}

/* Marks expansions. */
ALWAYS_INLINE uint64_t mark_expansions(int from, const int n, const struct faces *f, const struct winds *restrict w,
                                       struct rules *restrict r) {
    const double *rho = f->state[0], *p = f->p, *u = f->velocity[0], *c = f->c;
    const long s = f->stride;
    uint64_t any = 0;
    EACH_ALONE
    for (int i = from; i < from + n; i++) {
        const double impedance[2] = {rho[i] * c[i], rho[i + s] * c[i + s]};
        const int apart = expands(u[i + s] - u[i], c[i], c[i + s], impedance, p[i], p[i + s]);
        r->expansion[i] = (apart & runs_both_ways(w, i) & !(r->shock[i] > 0)) ? 1 : 0;
        any |= bits_of(r->expansion[i]);
    }
    return any;
}

/* Marks contacts. */
ALWAYS_INLINE uint64_t mark_contacts(int from, const int n, const struct faces *f, struct rules *restrict r) {
    const double *p = f->p, *g = f->gruneisen;
    const long s = f->stride;
    uint64_t any = 0;
    EACH_ALONE
    for (int i = from; i < from + n; i++) {
        const int varies = most_of(g + i, s) > DENSER * least_of(g + i, s);
        const int level = most_of(p + i, s) < STEEP * least_of(p + i, s);
        r->contact[i] = (varies & level & !(r->shock[i] > 0)) ? 1 : 0;
        any |= bits_of(r->contact[i]);
    }
    return any;
}

/* Marks the faces of a group that follow the rules `on`, and returns the rules that some follow. each[i]: the rules
 * that a face may follow. */
ALWAYS_INLINE uint64_t find_group(const int dim, int from, const int n, const struct faces *f, uint64_t on,
                                  const uint64_t *restrict each, const struct winds *restrict w,
                                  struct rules *restrict r) {
    uint64_t may = 0, any = 0;
    for (int i = from; i < from + n; i++) {
        may |= on & each[i];
        r->shock[i] = r->expansion[i] = r->contact[i] = 0;
    }
    if (may & SHOCK && mark_shocks(dim, from, n, f, w, r->shock)) any |= SHOCK;
    if (may & EXPANSION && mark_expansions(from, n, f, w, r)) any |= EXPANSION;
    if (may & CONTACT && mark_contacts(from, n, f, r)) any |= CONTACT;
    return any;
}

/* Most batches have no face that may follow a rule, and in others most groups have none. The last group overlaps the
 * one before, so that it is as long. */
ALWAYS_INLINE uint64_t find_dim(const int dim, const struct faces *f, uint64_t on, const struct winds *restrict w,
                                struct rules *restrict r) {
    const int last = f->n - GROUP;
    ALIGNED uint64_t may[BATCH];
    uint64_t any = 0;
    if (!(on & look(f->n, f->stride, f->p, f->velocity[0], f->gruneisen, may))) return 0;
    if (last < 0) return find_group(dim, 0, f->n, f, on, may, w, r);
    for (int from = 0; from < f->n; from += GROUP)
        any |= find_group(dim, from < last ? from : last, GROUP, f, on, may, w, r);
    return any;
}

KERNEL static uint64_t find_rules(const struct faces *f, uint64_t on, const struct winds *restrict w,
                                  struct rules *restrict r) {
    if (f->dim == 1) return find_dim(1, f, on, w, r);
    if (f->dim == 2) return find_dim(2, f, on, w, r);
    return find_dim(3, f, on, w, r);
}

/* Returns a span of whole groups, where the batch has as many, that holds all faces that are marked. */
static struct face_span marked(int n, const double *mark) {
    struct face_span s = {0, n};
    while (s.to > 0 && !(mark[s.to - 1] > 0)) s.to--;
    while (s.from < s.to && !(mark[s.from] > 0)) s.from++;
    const int length = (s.to - s.from + GROUP - 1) / GROUP * GROUP;
    if (length > n) return (struct face_span){0, n};
    if (s.from > n - length) s.from = n - length;
    return (struct face_span){s.from, s.from + length};
}

/* Returns the share of the larger speed that damps an expansion: 0.5 in dilute gas, less where the isentrope is steep
 * (d ln T = g d ln rho), and nearly 1 near packing, where less would ask for limited faces. g: of the cell where it is
 * larger. */
ALWAYS_INLINE double damping(double g) {
    const double share = fma(0.14, smaller(1, 1 / g), 0.36);
    return 1 - (1 - share) * smaller(1, PACKED / g);
}

/* Gives expansions their winds. */
KERNEL static void bend(const struct faces *f, const struct rules *restrict r, struct winds *restrict w) {
    const double *restrict gl = f->gruneisen, *restrict gr = gl + f->stride;
    const double *restrict ul = f->velocity[0], *restrict ur = ul + f->stride;
    const double *restrict cl = f->c, *restrict cr = cl + f->stride;
    const int n = f->n;
    for (int side = -1; side <= 1; side += 2) {
        double *restrict speed = w->speed[side < 0 ? MINUS : PLUS];
        for (int i = 0; i < n; i++) {
            const double own = larger(fabs(fma(side, cl[i], ul[i])), fabs(fma(side, cr[i], ur[i])));
            speed[i] = r->expansion[i] > 0 ? damping(larger(gl[i], gr[i])) * own : speed[i];
        }
    }
}

/* Takes the rules that the caller has found; but where all waves run one way there is no shock and no expansion. */
static void take_rules(const struct faces *f, struct winds *w, struct rules *r) {
    bool bent = false;
    for (int i = 0; i < f->n; i++) {
        const bool both = w->speed[MINUS][i] != UPWIND_LEFT && w->speed[PLUS][i] != UPWIND_RIGHT;
        r->shock[i] = f->rule[i] == SHOCK_RULE && both ? 1 : 0;
        r->expansion[i] = f->rule[i] == EXPANSION_RULE && both ? 1 : 0;
        r->contact[i] = f->rule[i] == CONTACT_RULE ? 1 : 0;
        bent |= r->expansion[i] > 0;
    }
    r->shocks = marked(f->n, r->shock);
    r->contacts = marked(f->n, r->contact);
    if (bent) bend(f, r, w);
}

void rules_find(const struct faces *f, struct winds *w, struct rules *r) {
    const struct wanted_rules wanted = rules_wanted(f->params, true, f->falls);
    const uint64_t on =
        (wanted.shocks ? SHOCK : 0) | (wanted.expansions ? EXPANSION : 0) | (wanted.contacts ? CONTACT : 0);
    r->shocks = r->contacts = (struct face_span){0, 0};
    if (f->rule) take_rules(f, w, r);
    if (f->rule || !f->p || !on) return;
    const uint64_t any = find_rules(f, on, w, r);
    if (any & SHOCK) r->shocks = marked(f->n, r->shock);
    if (any & CONTACT) r->contacts = marked(f->n, r->contact);
    if (any & EXPANSION) bend(f, r, w);
}

/* Splits entropy and shears with the floor, if that is the larger speed. Cells that are equal need no damping, and
 * where all cells around are, none may be there, even by round-off: they may have been left out (skipUniform). */
ALWAYS_INLINE void raise_dim(const int dim, const struct faces *f, struct winds *restrict w) {
    const double *u = f->velocity[0], *floor = f->floor;
    const long s = f->stride;
    double *restrict entropy = w->speed[ENTROPY];
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const double most = larger(fabs(u[i]), fabs(u[i + s]));
        uint64_t raised = is(floor[i] > most) & -(uint64_t)runs_both_ways(w, i), differs = 0;
        for (int v = 0; v < dim + 2; v++) differs |= is(f->state[v][i] != f->state[v][i + s]);
        entropy[i] = select_masked(raised & differs, floor[i], entropy[i]);
    }
}

KERNEL static void raise_floors(const struct faces *f, struct winds *restrict w) {
    if (f->dim == 2) raise_dim(2, f, w);
    if (f->dim == 3) raise_dim(3, f, w);
}

void rules_fronts(const struct faces *f, struct winds *w) {
    raise_floors(f, w);
}

void flux_sided_pressure(const struct faces *f, int side, const struct reconstruct *r, double *out) {
    double taken[6][BATCH];
    const double *line[5];
    if (!f->rise) {
        flux_reconstruct(f, f->p, side, r, out);
        return;
    }
    faces_take_rest(f, f->p, taken);
    for (int k = 0; k < 5; k++) line[k] = taken[side > 0 ? k : 5 - k];
    flux_reconstruct_lines(f, r, line, out);
    for (int i = 0; i < f->n; i++) out[i] += f->rest[i];
}

struct side { /* states rho, u, p on one side of the faces, with E */
    double rho[BATCH], u[MAX_DIM][BATCH], p[BATCH], c[BATCH], E[BATCH];
};

/* Closes the states q, which take the place of a cell's where they are not admissible: c, and E from
 * eps of p. unit: c^2 by eos_unit_state. */
KERNEL static void close_side(int n, int dim, const double *restrict unit, const double *restrict g,
                              struct side *restrict q) {
    for (int i = 0; i < n; i++) {
        const double t = dim > 2   ? q->u[1][i] * q->u[1][i] + q->u[2][i] * q->u[2][i]
                         : dim > 1 ? q->u[1][i] * q->u[1][i]
                                   : 0;
        const double eps = eps_of_pressure(q->p[i], q->rho[i], g[i]);
        q->c[i] = sqrt(unit[i] * eps);
        q->E[i] = q->rho[i] * (eps + 0.5 * (q->u[0][i] * q->u[0][i] + t));
    }
}

/* Reconstructs rho, u and p to the faces from one side (+1: left, -1: right). */
static void side_of(const struct faces *f, const struct eos *eos, const struct material *m, int side,
                    const struct reconstruct *r, struct side *q) {
    const int n = f->n;
    const long cell = side > 0 ? 0 : f->stride;
    const double limit = density_limit(eos, m);
    double p[BATCH], unit[BATCH], g[BATCH];
    flux_reconstruct(f, f->state[0], side, r, q->rho);
    for (int k = 0; k < f->dim; k++) flux_sided_velocity(f, k, side, r, q->u[k]);
    flux_sided_pressure(f, side, r, q->p);
    for (int i = 0; i < n; i++) {
        if (q->rho[i] > 0 && q->rho[i] < limit && q->p[i] > 0) continue;
        q->rho[i] = f->state[0][i + cell];
        q->p[i] = f->p[i + cell];
        for (int k = 0; k < f->dim; k++) q->u[k][i] = f->velocity[k][i + cell];
    }
    eos_unit_state(eos, m, n, q->rho, p, unit, g);
    close_side(n, f->dim, unit, g, q);
}

struct fan { /* the speeds of its waves, and its pressure */
    double left, middle, right, p;
};
/* Toro, Spruce & Speares (1994), with the speeds of Davis (1988). p is the mean of what both sides give, so that mirror
 * images keep their bits. */
ALWAYS_INLINE struct fan fan_of(const struct side *restrict l, const struct side *restrict r, int i) {
    const double ul = l->u[0][i], ur = r->u[0][i];
    struct fan w = {.left = smaller(ul - l->c[i], ur - r->c[i]), .right = larger(ul + l->c[i], ur + r->c[i])};
    const double ml = l->rho[i] * (w.left - ul), mr = r->rho[i] * (w.right - ur);
    w.middle = ((r->p[i] - l->p[i]) + (ml * ul - mr * ur)) / (ml - mr);
    w.p = 0.5 * ((l->p[i] + ml * (w.middle - ul)) + (r->p[i] + mr * (w.middle - ur)));
    return w;
}

/* The flux HLLC through one face, less the pressure of gas at rest. Each variable is carried by the speed of the
 * contact, so that no face moves mass where that speed is 0. */
ALWAYS_INLINE void through_contact(int dim, const struct side q[2], int i, double rest, double *const out[MAX_VAR]) {
    const struct fan w = fan_of(&q[0], &q[1], i);
    const bool whole = w.left >= 0 || w.right <= 0, right = whole ? w.left < 0 : w.middle < 0;
    const struct side *s = &q[right];
    const double u = s->u[0][i], outer = right ? w.right : w.left, inverse = 1 / (outer - w.middle);
    const double speed = whole ? u : w.middle, p = whole ? s->p[i] : w.p;
    const double rho = whole ? s->rho[i] : s->rho[i] * (outer - u) * inverse;
    const double E = whole ? s->E[i] : ((outer - u) * s->E[i] + (p * speed - s->p[i] * u)) * inverse;
    out[0][i] = rho * speed;
    out[1][i] = rho * speed * speed + (p - rest);
    for (int k = 1; k < dim; k++) out[k + 1][i] = rho * speed * s->u[k][i];
    out[dim + 1][i] = (E + p) * speed;
}

struct faces faces_of_span(const struct faces *f, struct face_span s) {
    struct faces part = *f;
    part.n = s.to - s.from;
    part.padding = s.to - (f->n - f->padding);
    if (part.padding < 0) part.padding = 0;
    for (int v = 0; v < f->dim + 2; v++) {
        part.state[v] = f->state[v] + s.from;
        part.flux[v] = f->flux[v] + s.from;
        part.out[v] = f->out[v] + s.from;
    }
    for (int k = 0; k < f->dim; k++) part.velocity[k] = f->velocity[k] + s.from;
    part.p = f->p + s.from;
    part.eps = f->eps + s.from;
    part.c = f->c + s.from;
    part.gruneisen = f->gruneisen + s.from;
    part.rule = NULL;
    if (f->floor) part.floor = f->floor + s.from;
    if (f->flat) part.flat = f->flat + s.from;
    if (!f->rise) return part;
    for (int side = 0; side < 2; side++) part.base[side] = f->base[side] + s.from;
    part.rise = f->rise + s.from;
    part.on = f->on + s.from;
    part.rest = f->rest + s.from;
    return part;
}

void rules_contacts(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r,
                    const struct rules *rules) {
    const int from = rules->contacts.from;
    struct side q[2];
    if (from >= rules->contacts.to) return;
    const struct faces part = faces_of_span(f, rules->contacts);
    side_of(&part, eos, m, 1, r, &q[0]);
    side_of(&part, eos, m, -1, r, &q[1]);
    for (int i = 0; i < part.n; i++)
        if (rules->contact[from + i] > 0) through_contact(f->dim, q, i, f->rise ? part.rest[i] : 0, part.out);
}
