/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Crank-Nicolson steps of segregation on a line, iterated by Newton or Picard; equation numbers are those of Christov
 * (2018). segregation.h has the scheme on a line, docs/physics.md 11.1 the closures. */
#include "libcore/segregation/segregation_private.h"

#include <lapacke.h>
#include <stdlib.h>

static status line_check(const struct segregation_line *l, enum segregation_closure closure) {
    const int n = l->n;
    if (n < 3) return fail(ERR_INPUT, "a line of %d cells; it needs 3", n);
    for (int i = 0; i < n; i++) {
        if (!(l->face[i] <= l->node[i] && l->node[i] <= l->face[i + 1] && l->face[i] < l->face[i + 1]) ||
            (i && !(l->node[i - 1] < l->node[i])))
            return fail(ERR_INPUT, "cell %d of the line: faces at %g and %g, node at %g; they must ascend", i,
                        l->face[i], l->face[i + 1], l->node[i]);
    }
    if (closure == SEGREGATION_CONSERVATIVE || (l->node[0] == l->face[0] && l->node[n - 1] == l->face[n])) return OK;
    return fail(ERR_INPUT, "closures other than conservative need values on the walls");
}

/* Is the central flux monotone on all faces? */
static bool is_resolved(const struct segregation *s) {
    for (int i = 1; i < s->line.n; i++)
        if (segregation_coarse(s, i)) return false;
    return true;
}

static void shape(struct segregation *s) {
    const struct segregation_line *l = &s->line;
    s->thinnest = HUGE_VAL;
    for (int i = 0; i < l->n; i++) {
        s->width[i] = l->face[i + 1] - l->face[i];
        s->thinnest = smaller(s->width[i], s->thinnest);
        s->fastest = larger(fabs(l->speed[i]), s->fastest);
    }
    for (int i = 1; i < l->n; i++) {
        s->nearness[i] = 1 / (l->node[i] - l->node[i - 1]);
        s->share[i] = (l->face[i] - l->node[i - 1]) * s->nearness[i];
    }
    if (!l->law) memcpy(s->diffusivity, l->diffusivity, (size_t)(l->n + 1) * sizeof(double));
    s->resolved = is_resolved(s);
}

status segregation_make(const struct segregation_line *line, const struct segregation_scheme *scheme,
                        struct segregation **out) {
    struct segregation *s = NULL;
    *out = NULL;
    TRY(line_check(line, scheme->closure));
    TRY(allocate(&s, 1, sizeof *s, "a line"));
    s->line = *line;
    s->scheme = *scheme;
    double **const arrays[] = {
        &s->width,    &s->share,  &s->nearness,     &s->diffusivity,     &s->flux,         &s->upward,
        &s->downward, &s->mean,   &s->value,        &s->slope,           &s->found,        &s->low,
        &s->low_flux, &s->excess, &s->part,         &s->least,           &s->most,         &s->before,
        &s->whole,    &s->halves, &s->matrix.below, &s->matrix.diagonal, &s->matrix.above, &s->matrix.right};
    enum { ARRAYS = sizeof arrays / sizeof *arrays };
    const long stride = (line->n + 1 + 7) / 8 * 8;
    status e = allocate(&s->room, ARRAYS * stride, sizeof(double), "a line");
    if (!e) e = allocate(&s->watched, line->n, sizeof(bool), "a line");
    if (e) {
        segregation_free(s);
        return e;
    }
    for (int i = 0; i < ARRAYS; i++) *arrays[i] = s->room + i * stride;
    shape(s);
    *out = s;
    return OK;
}

void segregation_free(struct segregation *s) {
    if (!s) return;
    free(s->room);
    free(s->watched);
    free(s);
}

struct segregation_counts segregation_counts(const struct segregation *s) {
    return s->counts;
}

double segregation_mass(const struct segregation *s, const double *phi) {
    double mass = 0;
    for (int i = 0; i < s->line.n; i++) mass += s->width[i] * phi[i];
    return mass;
}

/* Computes N = f P (1 - P) at P = (1 - late) phi + late found, and its slope: dN/dfound (Newton), or the factor that
 * (4) has there (Picard, which keeps one factor of found^2). */
KERNEL static void percolation_line(int n, const struct segregation *s, double late, const double *restrict phi,
                                    double *restrict P, double *restrict value, double *restrict slope) {
    const double *f = s->line.speed, *found = s->found;
    const double kept = s->scheme.newton ? 2 * late : late, old = 2 * (1 - late);
    for (int i = 0; i < n; i++) {
        P[i] = (1 - late) * phi[i] + late * found[i];
        value[i] = f[i] * (P[i] * (1 - P[i]));
        slope[i] = f[i] * late * (1 - kept * found[i] - old * phi[i]);
    }
}

KERNEL static void central_flux(int n, const struct segregation *s, double late) {
    const double *restrict share = s->share, *restrict nearness = s->nearness, *restrict D = s->diffusivity;
    const double *restrict P = s->mean, *restrict value = s->value, *restrict slope = s->slope;
    double *restrict flux = s->flux, *restrict upward = s->upward, *restrict downward = s->downward;
    for (int i = 1; i < n; i++) {
        double g = D[i] * nearness[i];
        flux[i] = ((1 - share[i]) * value[i - 1] + share[i] * value[i]) - g * (P[i] - P[i - 1]);
        upward[i] = (1 - share[i]) * slope[i - 1] + late * g;
        downward[i] = share[i] * slope[i] - late * g;
    }
}

/* Computes P + add at the faces; at a wall P is that of the cell beside it. */
static void at_faces(const struct segregation *s, double add, double *out) {
    const double *P = s->mean, *share = s->share;
    const int n = s->line.n;
    for (int i = 1; i < n; i++) out[i] = (1 - share[i]) * P[i - 1] + share[i] * P[i] + add;
    out[0] = P[0] + add;
    out[n] = P[n - 1] + add;
}

/* Sets D from the law at the present P, where D depends on phi. */
static void use_law(struct segregation *s) {
    const struct segregation_line *l = &s->line;
    at_faces(s, 0, s->part);
    l->law(l->context, l->n + 1, s->part, s->diffusivity);
}
/* Adds dD/dphi to the slopes of the flux, for Newton's iteration. */
static void use_law_slope(struct segregation *s, double late) {
    const double small = 1e-7;
    const struct segregation_line *l = &s->line;
    at_faces(s, small, s->part);
    l->law(l->context, l->n + 1, s->part, s->excess);
    for (int i = 1; i < l->n; i++) {
        double bend = (s->excess[i] - s->diffusivity[i]) / small * s->nearness[i] * (s->mean[i] - s->mean[i - 1]);
        s->upward[i] -= late * (1 - s->share[i]) * bend;
        s->downward[i] -= late * s->share[i] * bend;
    }
}

static void take_flux(struct segregation *s, double late, const double *phi) {
    const int n = s->line.n;
    percolation_line(n, s, late, phi, s->mean, s->value, s->slope);
    if (s->line.law) use_law(s);
    central_flux(n, s, late);
    if (s->line.law && s->scheme.newton) use_law_slope(s, late);
}

KERNEL static void segregation_line_rows(const struct segregation *s, double dt, const double *restrict phi,
                                         const double *restrict found, const double *restrict flux,
                                         const double *restrict up, const double *restrict down) {
    const double *restrict width = s->width;
    double *restrict diagonal = s->matrix.diagonal, *restrict right = s->matrix.right;
    double *restrict below = s->matrix.below, *restrict above = s->matrix.above;
    const int n = s->line.n;
    for (int j = 0; j < n; j++) {
        double k = dt / width[j];
        right[j] = (phi[j] - found[j]) - k * (flux[j + 1] - flux[j]);
        diagonal[j] = 1 + k * (up[j + 1] - down[j]);
        above[j] = k * down[j + 1]; /* the last one is 0 and is not used */
    }
    for (int j = 0; j < n - 1; j++) below[j] = -(dt / width[j + 1]) * up[j + 1];
}
void segregation_rows(struct segregation *s, double dt, const double *phi, const double *found) {
    segregation_line_rows(s, dt, phi, found, s->flux, s->upward, s->downward);
}

/* The rows that need no interchange, as a rule all, are eliminated here, with the operations and the bits of LAPACK's
 * dgtsv, which keeps its sums in memory from row to row; dgtsv takes what follows from the first row that needs one. */
bool segregation_solve(struct segregation *s) {
    struct tridiagonal *m = &s->matrix;
    const int n = s->line.n;
    double *restrict diagonal = m->diagonal, *restrict right = m->right, d = diagonal[0], x = right[0];
    int i = 0;
    for (; i < n - 1 && fabs(d) >= fabs(m->below[i]) && d != 0; i++) {
        const double factor = m->below[i] / d;
        diagonal[i + 1] = d = diagonal[i + 1] - factor * m->above[i];
        right[i + 1] = x = right[i + 1] - factor * x;
    }
    if (LAPACKE_dgtsv_work(LAPACK_COL_MAJOR, n - i, 1, m->below + i, diagonal + i, m->above + i, right + i, n - i))
        return false;
    for (x = right[i--]; i >= 0; i--) right[i] = x = (right[i] - m->above[i] * x) / diagonal[i];
    return true;
}

/* Makes the row of a wall from closure (5) or (7), at the new time as in the paper: c0 phi0 + c1 phi1 + c2 phi2 of the
 * nodes from the wall on; the next row eliminates phi2. */
static void close_wall(struct segregation *s, bool top, const double *found) {
    const struct segregation_line *l = &s->line;
    struct tridiagonal *m = &s->matrix;
    const int n = l->n, wall = top ? n - 1 : 0, step = top ? -1 : 1, next = wall + step, third = next + step;
    const double near = l->node[next] - l->node[wall], far = l->node[third] - l->node[wall];
    double c0 = -(near + far) / far, c1 = far / (far - near), c2 = -near * near / (far * (far - near));
    double left = c0 * found[wall] + c1 * found[next] + c2 * found[third]; /* near * phi_y */
    if (s->scheme.closure == SEGREGATION_PAPER) {
        double rate = near * l->speed[wall] / s->diffusivity[top ? n : 0], kept = s->scheme.newton ? 2 : 1;
        left -= rate * found[wall] * (1 - found[wall]);
        c0 -= rate * (1 - kept * found[wall]);
    }
    double *to_third = top ? &m->below[next - 1] : &m->above[next];
    double *to_wall = top ? &m->above[next] : &m->below[wall];
    double *from_wall = top ? &m->below[next] : &m->above[wall];
    const double times = c2 / *to_third;
    m->diagonal[wall] = c0 - times * *to_wall;
    *from_wall = c1 - times * m->diagonal[next];
    m->right[wall] = -left - times * m->right[next];
}

/* Returns the largest |x|; not a number if one of them is none. */
KERNEL static double largest_magnitude(int n, const double *restrict x) {
    enum { LANES = 32 }; /* as many as hide the latency of a maximum */
    double most[LANES] = {0}, none[LANES] = {0};
    int i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int k = 0; k < LANES; k++) {
            most[k] = larger(fabs(x[i + k]), most[k]);
            none[k] += 0 * x[i + k];
        }
    for (int k = 0; i < n; i++, k++) {
        most[k] = larger(fabs(x[i]), most[k]);
        none[k] += 0 * x[i];
    }
    for (int k = 1; k < LANES; k++) {
        most[0] = larger(most[0], most[k]);
        none[0] += none[k];
    }
    return most[0] + none[0];
}

/* Returns the factor c such that Newton's iteration leaves a residual of at most c change^2 in the balance, which is
 * quadratic. */
static double leftover(const struct segregation *s, double dt, double late) {
    return 2 * late * late * dt * s->fastest / s->thinnest;
}

/* Iterates s->found; returns false if it did not settle. The paper's criterion: the last change is below tolerance *
 * largest phi; with Newton and D independent of phi the size of the next change is known and counts instead. */
static bool settle(struct segregation *s, double dt, double late, const double *phi) {
    const int n = s->line.n;
    const bool closed = s->scheme.closure == SEGREGATION_CONSERVATIVE, quadratic = s->scheme.newton && !s->line.law;
    const double next = quadratic ? leftover(s, dt, late) : 0;
    memcpy(s->found, phi, (size_t)n * sizeof *phi);
    for (int k = 0; k < s->scheme.most; k++) {
        take_flux(s, late, phi);
        segregation_rows(s, dt, phi, s->found);
        if (!closed) close_wall(s, false, s->found);
        if (!closed) close_wall(s, true, s->found);
        s->counts.iterations++;
        if (!segregation_solve(s)) return false;
        double change = largest_magnitude(n, s->matrix.right), size = largest_magnitude(n, s->found);
        if (!(change <= 10)) return false; /* also not a number */
        for (int i = 0; i < n; i++) s->found[i] += s->matrix.right[i];
        double left = quadratic ? smaller(change, next * change * change) : change;
        if (left < s->scheme.tolerance * size || change == 0) return true;
    }
    return false;
}

/* Returns by how much phi exceeds 0 .. 1 at most. */
KERNEL static double excess_of(int n, const double *restrict phi) {
    enum { LANES = 32 };
    double most[LANES] = {0};
    int i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int k = 0; k < LANES; k++) most[k] = larger(larger(-phi[i + k], phi[i + k] - 1), most[k]);
    for (int k = 0; i < n; i++, k++) most[k] = larger(larger(-phi[i], phi[i] - 1), most[k]);
    for (int k = 1; k < LANES; k++) most[0] = larger(most[0], most[k]);
    return most[0];
}
/* Moves round-off beyond 0 or 1 to the next cell, and from the last one back. */
static void round_off(const struct segregation *s, double *phi) {
    const int n = s->line.n;
    for (int j = 0; j < n - 1; j++) {
        double now = smaller(larger(phi[j], 0), 1);
        phi[j + 1] += s->width[j] / s->width[j + 1] * (phi[j] - now);
        phi[j] = now;
    }
    for (int j = n - 1; j > 0; j--) {
        double now = smaller(larger(phi[j], 0), 1);
        phi[j - 1] += s->width[j] / s->width[j - 1] * (phi[j] - now);
        phi[j] = now;
    }
    phi[0] = smaller(larger(phi[0], 0), 1);
}

/* Makes one step with the flux at (1 - late) phi + late phi': late 1/2 is Crank-Nicolson, 1 implicit Euler. */
static status step(struct segregation *s, double dt, double late, double *phi) {
    const bool bounds = s->scheme.closure == SEGREGATION_CONSERVATIVE && !s->scheme.unbounded;
    bool settled = settle(s, dt, late, phi);
    if (!settled && !bounds)
        return fail(ERR_STATE, "the iteration has not settled after %d rounds; a smaller deltaT helps", s->scheme.most);
    s->counts.steps++;
    if (s->line.law) s->resolved = is_resolved(s);
    double out = bounds ? excess_of(s->line.n, s->found) : 0;
    if (bounds && (!settled || out > SEGREGATION_ROUND || !s->resolved)) {
        s->counts.unsolved += !settled;
        take_flux(s, late, phi);
        TRY(segregation_bound(s, dt, phi, s->found));
        out = excess_of(s->line.n, s->found);
    }
    if (out > 0) round_off(s, s->found);
    memcpy(phi, s->found, (size_t)s->line.n * sizeof *phi);
    return OK;
}

static status line_step(void *line, double dt, double late, double *phi) {
    return step(line, dt, late, phi);
}
static struct segregation_steps steps_of(struct segregation *s) {
    return (struct segregation_steps){s, line_step, s->line.n, NULL, s->width, s->before, s->whole, s->halves};
}

status segregation_step(struct segregation *s, double dt, bool damped, double *phi) {
    const struct segregation_steps steps = steps_of(s);
    return damped ? segregation_damped(&steps, dt, phi) : step(s, dt, 0.5, phi);
}

status segregation_advance(struct segregation *s, double allowed, double *dt, double *next, double *phi) {
    const struct segregation_steps steps = steps_of(s);
    return segregation_adapt(&steps, allowed, dt, next, &s->counts.rejected, phi);
}
