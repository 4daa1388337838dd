/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of segregation on a lattice: lines of tridiagonal systems by axes (Beam & Warming 1976). segregation_lattice.h
 * has the scheme. */
#include "libcore/segregation/segregation_lattice_private.h"
#include "libcore/segregation/segregation_private.h"

static const double ROUND = 1e-15; /* an excess of phi beyond 0 or 1 up to this is round-off */

/* ---- (I + late dt J_k) change = change along the lines of axis k; flux_k += late J_k change ---- */

struct lines {
    int k, count;              /* axis; lines of the batch */
    long n, step;              /* cells of a line; stride along it */
    long cell, face;           /* first cell and face of the first line */
    long cell_next, face_next; /* stride from line to line */
};

KERNEL static void assemble_lines(long count, double per_width, const struct jacobian_lines *restrict l) {
    const double *a = l->below, *b = l->above, *u = l->u, *f = l->f, *D = l->D;
    double *up = l->up, *down = l->down;
    for (long i = 0; i < count; i++) {
        double g = D[i] * per_width;
        up[i] = 0.5 * (u[i] + f[i] * (1 - 2 * a[i])) + g;
        down[i] = 0.5 * (u[i] + f[i] * (1 - 2 * b[i])) - g;
    }
}
void segregation_assemble(long count, double per_width, const struct jacobian_lines *l) {
    assemble_lines(count, per_width, l);
}

/* Solves LINES tridiagonal systems abreast by Thomas' elimination without pivots. */
KERNEL static void eliminate_first(double part, const double *restrict ease, const double *restrict up,
                                   const double *restrict down, double *restrict above, double *restrict right) {
    for (int c = 0; c < LINES; c++) {
        double k = part * ease[c], inverse = 1 / (1 + k * (up[LINES + c] - down[c]));
        above[c] = k * down[LINES + c] * inverse;
        right[c] *= inverse;
    }
}
KERNEL static void eliminate_row(double part, const double *restrict ease, const double *restrict up,
                                 const double *restrict down, const double *restrict above_before,
                                 const double *restrict right_before, double *restrict above, double *restrict right) {
    for (int c = 0; c < LINES; c++) {
        double k = part * ease[c], below = -k * up[c];
        double pivot = (1 + k * (up[LINES + c] - down[c])) - below * above_before[c], inverse = 1 / pivot;
        above[c] = k * down[LINES + c] * inverse;
        right[c] = (right[c] - below * right_before[c]) * inverse;
    }
}
void segregation_forward(long n, double part, const double *ease, const double *up, const double *down,
                         const double *before, double *above, double *right) {
    if (before)
        eliminate_row(part, ease, up, down, before, before + LINES, above, right);
    else
        eliminate_first(part, ease, up, down, above, right);
    for (long i = LINES; i < n * LINES; i += LINES)
        eliminate_row(part, ease + i, up + i, down + i, above + i - LINES, right + i - LINES, above + i, right + i);
}
KERNEL static void solve_row(const double *restrict above, const double *restrict behind, double *restrict right) {
    for (int c = 0; c < LINES; c++) right[c] -= above[c] * behind[c];
}
void segregation_backward(long n, const double *above, const double *behind, double *right) {
    const long last = (n - 1) * LINES;
    if (behind) solve_row(above + last, behind, right + last);
    for (long i = last - LINES; i >= 0; i -= LINES) solve_row(above + i, right + i + LINES, right + i);
}
static void eliminate_lines(long n, double part, const double *ease, const double *up, const double *down,
                            double *above, double *right) {
    segregation_forward(n, part, ease, up, down, NULL, above, right);
    segregation_backward(n, above, NULL, right);
}

/* Solves lines whose last cells border on the first ones (Sherman & Morrison). up and down of the seam stand in front
 * and behind; those behind are put in order again. */
static void eliminate_cyclic(long n, double part, const double *ease, double *up, double *down, double *above,
                             double *right, double *seam) {
    const long last = (n - 1) * LINES;
    double corner[LINES];
    memset(seam, 0, (size_t)n * LINES * sizeof *seam);
    for (int c = 0; c < LINES; c++) {
        const double first = part * ease[c], end = part * ease[last + c];
        const double shift = -(1 + first * (up[LINES + c] - down[c])), far = end * down[n * LINES + c];
        corner[c] = -first * up[c] / shift;
        seam[c] = shift;
        seam[last + c] = far;
        down[c] += first > 0 ? shift / first : 0;
        up[n * LINES + c] -= end > 0 ? far * corner[c] / end : 0;
    }
    eliminate_lines(n, part, ease, up, down, above, right);
    eliminate_lines(n, part, ease, up, down, above, seam);
    for (int c = 0; c < LINES; c++) {
        const double factor = (right[c] + corner[c] * right[last + c]) / (1 + seam[c] + corner[c] * seam[last + c]);
        for (long i = c; i < n * LINES; i += LINES) right[i] -= factor * seam[i];
        down[c] = down[n * LINES + c];
        up[n * LINES + c] = up[c];
    }
}

static void gather(const struct lines *b, long n, long start, long next, const double *from, double *to) {
    if (next == 1) {
        for (long i = 0; i < n; i++) memcpy(to + i * LINES, from + start + i * b->step, (size_t)b->count * sizeof *to);
        return;
    }
    for (int c = 0; c < b->count; c++)
        for (long i = 0; i < n; i++) to[i * LINES + c] = from[start + c * next + i * b->step];
}

/* Sets the Jacobian of the fluxes at both ends of lines that are not cyclic. */
static void set_ends(const struct segregation_field *s, const struct lines *b, const double *phi, double *up,
                     double *down) {
    const long last = b->n * LINES;
    for (int c = 0; c < LINES; c++) {
        const long face = b->face + c * b->face_next, in = c < b->count;
        up[c] = down[last + c] = 0;
        down[c] = in ? segregation_edge(s, b->k, false, face, phi[c]).slope : 0;
        up[last + c] = in ? segregation_edge(s, b->k, true, face + b->n * b->step, phi[last - LINES + c]).slope : 0;
    }
}

static void solve_lines(struct segregation_field *s, double dt, double late, const struct lines *b, const double *phi) {
    const struct segregation_lattice *l = &s->lattice;
    const long n = b->n;
    const int k = b->k;
    const bool cyclic = l->cyclic[k];
    double *phi_line = s->line_phi, *up = s->line_up, *down = s->line_down, *right = s->line_right;
    double *u = s->line_above, *f = u + (n + 1) * LINES, *D = f + (n + 1) * LINES, *above = u;
    gather(b, n, b->cell, b->cell_next, phi, phi_line);
    gather(b, n, b->cell, b->cell_next, s->change, right);
    gather(b, n, b->cell, b->cell_next, s->ease, s->line_ease);
    gather(b, n + 1, b->face, b->face_next, l->u[k], u);
    gather(b, n + 1, b->face, b->face_next, l->f[k], f);
    gather(b, n + 1, b->face, b->face_next, l->D[k], D);
    if (!cyclic) set_ends(s, b, phi_line, up, down);
    assemble_lines((n - 1) * LINES, 1 / l->width[k],
                   &(struct jacobian_lines){phi_line, phi_line + LINES, u + LINES, f + LINES, D + LINES, up + LINES,
                                            down + LINES});
    if (cyclic) {
        assemble_lines(LINES, 1 / l->width[k],
                       &(struct jacobian_lines){phi_line + (n - 1) * LINES, phi_line, u, f, D, up, down});
        memcpy(up + n * LINES, up, LINES * sizeof *up);
        memcpy(down + n * LINES, down, LINES * sizeof *down);
        eliminate_cyclic(n, late * dt / l->width[k], s->line_ease, up, down, above, right, s->line_seam);
    } else {
        eliminate_lines(n, late * dt / l->width[k], s->line_ease, up, down, above, right);
    }
    for (int c = 0; c < b->count; c++) {
        double *change = s->change + b->cell + c * b->cell_next, *flux = s->flux[k] + b->face + c * b->face_next;
        for (long i = 0; i < n; i++) change[i * b->step] = right[i * LINES + c];
        for (long i = 0; i <= n; i++) {
            double below = i > 0 ? right[(i - 1) * LINES + c] : cyclic ? right[(n - 1) * LINES + c] : 0;
            double beyond = i < n ? right[i * LINES + c] : cyclic ? right[c] : 0;
            flux[i * b->step] += late * (up[i * LINES + c] * below + down[i * LINES + c] * beyond);
        }
    }
}

static void solve_axis(struct segregation_field *s, double dt, double late, int k, const double *phi) {
    const long across = s->stride[k], n = s->lattice.n[k], outer = outer_count(s, k);
    struct lines b = {.k = k, .n = n, .step = across};
    const long lines = k ? across : outer; /* number of lines that lie side by side */
    b.cell_next = k ? 1 : n;
    b.face_next = k ? 1 : n + 1;
    for (long o = 0; o < (k ? outer : 1); o++)
        for (long first = 0; first < lines; first += LINES) {
            b.count = (int)(lines - first < LINES ? lines - first : LINES);
            b.cell = o * n * across + first * b.cell_next;
            b.face = o * (n + 1) * across + first * b.face_next;
            solve_lines(s, dt, late, &b, phi);
        }
}
/* Makes a step from phi with D as it is: s->flux, s->next. late: 1/2 Crank-Nicolson, 1 implicit Euler. */
static void central_step(struct segregation_field *s, double dt, double late, const double *phi) {
    segregation_take_flux(s, false, phi, s->flux);
    memset(s->change, 0, (size_t)s->cells * sizeof *s->change);
    segregation_subtract(s, dt, s->flux, s->change);
    for (int k = 0; k < s->lattice.dim; k++)
        if (joined(s, k, false) || joined(s, k, true))
            segregation_solve_slabs(s, dt, late, phi);
        else
            solve_axis(s, dt, late, k, phi);
    memcpy(s->next, phi, (size_t)s->cells * sizeof *phi);
    segregation_subtract(s, dt, s->flux, s->next);
}

static void find_rates(struct segregation_field *s);
KERNEL static void face_means(long n, const double *restrict below, const double *restrict above,
                              double *restrict out) {
    for (long i = 0; i < n; i++) out[i] = 0.5 * (below[i] + above[i]);
}
/* Sets D from the law at phi. */
static void take_law(struct segregation_field *s, const double *phi) {
    const struct segregation_lattice *l = &s->lattice;
    slab_swap(&s->slab, phi, phi + s->cells - s->stride[l->dim - 1]);
    for (int k = 0; k < l->dim; k++) {
        const long across = s->stride[k], n = l->n[k] * across;
        double *at = s->part[k];
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            const double *cells = phi + outer * n;
            double *low = at + outer * (n + across);
            const double *end = cells + n - across;
            face_means(n - across, cells, cells + across, low + across);
            face_means(across, cells, joined(s, k, false) ? s->slab.below : l->cyclic[k] ? end : cells, low);
            face_means(across, end, joined(s, k, true) ? s->slab.above : l->cyclic[k] ? cells : end, low + n);
            for (long i = 0; i < across && l->fixed[k]; i++) {
                const long face = outer * (n + across) + i;
                if (l->fixed[k][face]) at[face] = l->value[k][face];
                if (l->fixed[k][face + n]) at[face + n] = l->value[k][face + n];
            }
        }
        l->law(l->context, k, at, s->D[k]);
    }
    find_rates(s);
}

static status step(struct segregation_field *s, double dt, double late, double *phi) {
    double under = 0, most = 1, none = 0;
    if (s->lattice.law) {
        take_law(s, phi);
        central_step(s, dt, late, phi);
        for (long c = 0; c < s->cells; c++) s->low[c] = 0.5 * (phi[c] + smaller(larger(s->next[c], 0), 1));
        take_law(s, s->low);
    }
    central_step(s, dt, late, phi);
    for (long c = 0; c < s->cells; c++) {
        under = larger(-s->next[c], under);
        most = larger(s->next[c], most);
        none += 0 * s->next[c];
    }
    double worst[3] = {under, most, !(none == 0)};
    slab_max(&s->slab, worst, 3);
    if (worst[2] > 0) return fail(ERR_STATE, "the step of %g s is too long for the lines' systems", dt);
    s->counts.steps++;
    if (s->coarse || worst[0] > ROUND || worst[1] > 1 + ROUND) segregation_bound_lattice(s, dt, phi);
    for (long c = 0; c < s->cells; c++) phi[c] = smaller(larger(s->next[c], 0), 1); /* round-off */
    return OK;
}

static status lattice_step(void *lattice, double dt, double late, double *phi) {
    return step(lattice, dt, late, phi);
}
static struct segregation_steps steps_of(struct segregation_field *s) {
    return (struct segregation_steps){s,         lattice_step, s->cells, &s->slab, s->lattice.capacity,
                                      s->before, s->whole,     s->halves};
}

status segregation_field_step(struct segregation_field *s, double dt, bool damped, double *phi) {
    const struct segregation_steps steps = steps_of(s);
    return damped ? segregation_damped(&steps, dt, phi) : step(s, dt, 0.5, phi);
}

status segregation_field_advance(struct segregation_field *s, double allowed, double *dt, double *next, double *phi) {
    const struct segregation_steps steps = steps_of(s);
    return segregation_adapt(&steps, allowed, dt, next, &s->counts.rejected, phi);
}

/* ---- making ---- */

static void find_rates(struct segregation_field *s) {
    const struct segregation_lattice *l = &s->lattice;
    memset(s->sharp, 0, (size_t)s->cells * sizeof *s->sharp);
    s->coarse = false;
    s->rate = s->advance_rate = 0;
    for (long c = 0; c < s->cells; c++) {
        double flow = 0, spread = 0;
        for (int k = 0; k < l->dim; k++) {
            struct cell_faces f = sides_of(s, k, c);
            double out = larger(l->u[k][f.high] + fabs(l->f[k][f.high]), 0),
                   in = larger(fabs(l->f[k][f.low]) - l->u[k][f.low], 0);
            flow += s->ease[c] * (out + in) / l->width[k];
            /* A phi that is given on a face stands half as far away. */
            const double low = (fixed_on(l, k, f.low) ? 2 : 1) * l->D[k][f.low],
                         high = (fixed_on(l, k, f.high) ? 2 : 1) * l->D[k][f.high];
            spread += s->ease[c] * (low + high) / (l->width[k] * l->width[k]);
            s->sharp[c] = s->sharp[c] || segregation_beside_coarse(s, k, c, f);
        }
        s->coarse = s->coarse || s->sharp[c];
        s->rate = larger(s->rate, flow);
        s->advance_rate = larger(s->advance_rate, flow + spread);
    }
    double most[3] = {s->rate, s->advance_rate, s->coarse};
    slab_max(&s->slab, most, 3);
    s->rate = most[0];
    s->advance_rate = most[1];
    s->coarse = most[2] > 0;
}

static status make_room(struct segregation_field *s) {
    const int dim = s->lattice.dim;
    long longest = 0, doubles = 9 * s->cells;
    for (int k = 0; k < dim; k++) {
        doubles += (s->lattice.law ? 4 : 3) * s->faces[k];
        if (s->lattice.n[k] > longest) longest = s->lattice.n[k];
    }
    const long buffer = (longest + 1) * LINES;
    TRY(allocate(&s->room, doubles + 9 * buffer, sizeof(double), "segregation on a lattice"));
    TRY(allocate(&s->watched, 2 * s->cells, sizeof(bool), "segregation on a lattice"));
    s->sharp = s->watched + s->cells;
    double *at = s->room, **const lines[] = {&s->line_phi,  &s->line_right, &s->line_up,   &s->line_down,
                                             &s->line_seam, &s->line_ease,  &s->line_above},
           **const cells[] = {&s->change, &s->next,   &s->low,   &s->least, &s->most,
                              &s->ease,   &s->before, &s->whole, &s->halves};
    for (int i = 0; i < 7; i++, at += buffer) *lines[i] = at; /* line_above has room for three buffers */
    at += 2 * buffer;
    for (int i = 0; i < 9; i++, at += s->cells) *cells[i] = at;
    for (int k = 0; k < dim; k++) {
        s->flux[k] = at;
        s->low_flux[k] = at + s->faces[k];
        s->part[k] = at + 2 * s->faces[k];
        at += 3 * s->faces[k];
        if (!s->lattice.law) continue;
        s->lattice.D[k] = s->D[k] = at;
        at += s->faces[k];
    }
    return OK;
}

status segregation_field_make(const struct segregation_lattice *lattice, struct segregation_field **out) {
    struct segregation_field *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "segregation on a lattice"));
    s->lattice = *lattice;
    s->cells = 1;
    for (int k = 0; k < lattice->dim; k++) {
        s->stride[k] = s->cells;
        s->cells *= lattice->n[k];
    }
    for (int k = 0; k < lattice->dim; k++) s->faces[k] = s->cells / lattice->n[k] * (lattice->n[k] + 1);
    const int last = lattice->dim - 1;
    status e = make_room(s);
    if (lattice->comm) e = comm_agree(lattice->comm, e);
    if (!e) e = slab_make(lattice->comm, lattice->cyclic[last], s->stride[last], &s->slab);
    if (!e) e = slab_make(lattice->comm, lattice->cyclic[last], s->stride[last], &s->low_slab);
    if (e) {
        segregation_field_free(s);
        return e;
    }
    for (long c = 0; c < s->cells; c++) s->ease[c] = lattice->capacity ? 1 / lattice->capacity[c] : 1;
    find_rates(s);
    *out = s;
    return OK;
}

void segregation_field_free(struct segregation_field *s) {
    if (!s) return;
    slab_free(&s->slab);
    slab_free(&s->low_slab);
    free(s->room);
    free(s->watched);
    free(s);
}
struct segregation_lattice_counts segregation_field_counts(const struct segregation_field *s) {
    struct segregation_lattice_counts all = s->counts;
    if (s->slab.comm) comm_sum_long(s->slab.comm, &all.corrected, 1);
    return all;
}
double segregation_field_rate(const struct segregation_field *s) {
    return s->rate;
}
