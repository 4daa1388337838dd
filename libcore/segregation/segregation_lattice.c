/* Steps of segregation on a lattice: fluxes, lines of tridiagonal systems by axes (Beam & Warming 1976), bounds
 * (Zalesak 1979). segregation_lattice.h has the scheme. */
#include "libcore/segregation/segregation_lattice.h"
#include "libcore/segregation/segregation_private.h"

#include <stdlib.h>

enum { LINES = BATCH }; /* lines of cells that are solved at a time */

static const double ROUND = 1e-15; /* an excess of phi beyond 0 or 1 up to this is round-off */

struct segregation_field {
    struct segregation_lattice lattice;
    struct segregation_lattice_counts counts;
    long cells, faces[MAX_DIM], stride[MAX_DIM];
    double rate, advance_rate; /* 1/s: largest rate of the flow; of the flow and diffusion */
    bool coarse;               /* is the central flux on any face not monotone? */
    double *room;
    /* [faces] fluxes, means over the step; share of `flux` let through */
    double *flux[MAX_DIM], *low_flux[MAX_DIM], *part[MAX_DIM];
    /* [cells] change of phi; phi' of Crank-Nicolson, of the monotone steps; bounds of phi' */
    double *change, *next, *low, *least, *most;
    /* [cells] 1 / capacity; room of struct segregation_steps */
    double *ease, *before, *whole, *halves;
    double *D[MAX_DIM]; /* [faces] D from the law; NULL without one */
    /* [cells] does the cell limit its faces; is it beside a coarse face? */
    bool *watched, *sharp;
    double *line_phi, *line_right, *line_up, *line_down, *line_above, *line_ease; /* [longest + 1][LINES] */
    double *line_seam;
};

/* The inner faces of an axis within one outer index: they are contiguous, and so are the cells below and above them. */
struct run {
    long cell, face, n;
};
static long outer_count(const struct segregation_field *s, int k) {
    return s->cells / (s->lattice.n[k] * s->stride[k]);
}
static struct run inner_run(const struct segregation_field *s, int k, long outer) {
    const long across = s->stride[k], n = s->lattice.n[k];
    return (struct run){outer * n * across, outer * (n + 1) * across + across, (n - 1) * across};
}

KERNEL static void central_flux_lattice(long n, double per_width, const double *restrict below,
                                        const double *restrict above, const double *restrict u,
                                        const double *restrict f, const double *restrict D, double *restrict flux) {
    for (long i = 0; i < n; i++) {
        double a = below[i], b = above[i];
        flux[i] = 0.5 * (u[i] * (a + b) + f[i] * (a * (1 - a) + b * (1 - b))) - D[i] * per_width * (b - a);
    }
}

/* Computes the Engquist-Osher flux: g = u phi + f phi (1 - phi) turns at `turn`. */
KERNEL static void monotone_flux_lattice(long n, double per_width, const double *restrict below,
                                         const double *restrict above, const double *restrict u,
                                         const double *restrict f, const double *restrict D, double *restrict flux) {
    for (long i = 0; i < n; i++) {
        double a = below[i], b = above[i], bend = f[i], half = bend != 0 ? 0.5 * (u[i] + bend) / bend : 0;
        double turn = bend != 0 ? half : u[i] >= 0 ? 1 : 0;
        turn = smaller(larger(turn, 0), 1);
        double from = (bend >= 0) == (a < turn) ? a : turn, to = (bend >= 0) == (b > turn) ? b : turn;
        double g =
            from * (u[i] + bend * (1 - from)) + (to * (u[i] + bend * (1 - to)) - turn * (u[i] + bend * (1 - turn)));
        flux[i] = g - D[i] * per_width * (b - a);
    }
}

typedef void flux_function(long, double, const double *restrict, const double *restrict, const double *restrict,
                           const double *restrict, const double *restrict, double *restrict);

/* Computes the flux on the seam of a cyclic axis: the faces at both ends are one. */
static void seam_flux(const struct segregation_field *s, flux_function *function, int k, const double *phi,
                      double *flux) {
    const struct segregation_lattice *l = &s->lattice;
    const long across = s->stride[k], n = l->n[k];
    for (long outer = 0; outer < outer_count(s, k); outer++) {
        const long low = outer * (n + 1) * across, cell = outer * n * across;
        function(across, 1 / l->width[k], phi + cell + (n - 1) * across, phi + cell, l->u[k] + low, l->f[k] + low,
                 l->D[k] + low, flux + low);
        memcpy(flux + low + n * across, flux + low, (size_t)across * sizeof *flux);
    }
}
/* Computes the flux on the boundary: its faces carry the cell's phi out and the inflow's in. */
static void boundary_flux(const struct segregation_field *s, int k, const double *phi, double *flux) {
    const struct segregation_lattice *l = &s->lattice;
    const long across = s->stride[k], n = l->n[k];
    for (long outer = 0; outer < outer_count(s, k); outer++)
        for (long r = 0; r < across; r++) {
            long low = outer * (n + 1) * across + r, high = low + n * across, cell = outer * n * across + r;
            double in_low = l->inflow[k] ? l->inflow[k][low] : 0, in_high = l->inflow[k] ? l->inflow[k][high] : 0;
            flux[low] = l->u[k][low] * (l->u[k][low] > 0 ? in_low : phi[cell]);
            flux[high] = l->u[k][high] * (l->u[k][high] > 0 ? phi[cell + (n - 1) * across] : in_high);
        }
}
static void take_flux(const struct segregation_field *s, flux_function *function, const double *phi,
                      double *const flux[MAX_DIM]) {
    const struct segregation_lattice *l = &s->lattice;
    for (int k = 0; k < l->dim; k++) {
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            struct run r = inner_run(s, k, outer);
            function(r.n, 1 / l->width[k], phi + r.cell, phi + r.cell + s->stride[k], l->u[k] + r.face,
                     l->f[k] + r.face, l->D[k] + r.face, flux[k] + r.face);
        }
        if (l->cyclic[k])
            seam_flux(s, function, k, phi, flux[k]);
        else
            boundary_flux(s, k, phi, flux[k]);
    }
}

KERNEL static void add_difference(long n, double factor, const double *restrict ease, const double *restrict low,
                                  const double *restrict high, double *restrict out) {
    for (long i = 0; i < n; i++) out[i] -= factor * ease[i] * (high[i] - low[i]);
}
/* Subtracts dt/capacity div flux from out. */
static void subtract_divergence(const struct segregation_field *s, double dt, double *const flux[MAX_DIM],
                                double *out) {
    for (int k = 0; k < s->lattice.dim; k++) {
        const long across = s->stride[k], n = s->lattice.n[k];
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            const double *low = flux[k] + outer * (n + 1) * across;
            add_difference(n * across, dt / s->lattice.width[k], s->ease + outer * n * across, low, low + across,
                           out + outer * n * across);
        }
    }
}

/* ---- (I + late dt J_k) change = change along the lines of axis k; flux_k += late J_k change ---- */

struct lines {
    int k, count;              /* axis; lines of the batch */
    long n, step;              /* cells of a line; stride along it */
    long cell, face;           /* first cell and face of the first line */
    long cell_next, face_next; /* stride from line to line */
};

/* Computes the Jacobian of the flux at phi: `up` to the cell below a face, `down` to the one above. */
KERNEL static void assemble_lines(long count, double per_width, const double *restrict a, const double *restrict b,
                                  const double *restrict u, const double *restrict f, const double *restrict D,
                                  double *restrict up, double *restrict down) {
    for (long i = 0; i < count; i++) {
        double g = D[i] * per_width;
        up[i] = 0.5 * (u[i] + f[i] * (1 - 2 * a[i])) + g;
        down[i] = 0.5 * (u[i] + f[i] * (1 - 2 * b[i])) - g;
    }
}
/* Solves LINES tridiagonal systems abreast by Thomas' elimination without pivots. */
KERNEL static void eliminate_lines(long n, double part, const double *restrict ease, const double *restrict up,
                                   const double *restrict down, double *restrict above, double *restrict right) {
    for (int c = 0; c < LINES; c++) {
        double k = part * ease[c], inverse = 1 / (1 + k * (up[LINES + c] - down[c]));
        above[c] = k * down[LINES + c] * inverse;
        right[c] *= inverse;
    }
    for (long i = 1; i < n; i++) {
        const double *restrict u = up + i * LINES, *restrict d = down + i * LINES;
        for (int c = 0; c < LINES; c++) {
            double k = part * ease[i * LINES + c], below = -k * u[c];
            double pivot = (1 + k * (u[LINES + c] - d[c])) - below * above[(i - 1) * LINES + c], inverse = 1 / pivot;
            above[i * LINES + c] = k * d[LINES + c] * inverse;
            right[i * LINES + c] = (right[i * LINES + c] - below * right[(i - 1) * LINES + c]) * inverse;
        }
    }
    for (long i = n - 2; i >= 0; i--)
        for (int c = 0; c < LINES; c++) right[i * LINES + c] -= above[i * LINES + c] * right[(i + 1) * LINES + c];
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
    for (int c = 0; c < LINES && !cyclic; c++) {
        up[c] = down[n * LINES + c] = 0;
        down[c] = smaller(u[c], 0);
        up[n * LINES + c] = larger(u[n * LINES + c], 0);
    }
    assemble_lines((n - 1) * LINES, 1 / l->width[k], phi_line, phi_line + LINES, u + LINES, f + LINES, D + LINES,
                   up + LINES, down + LINES);
    if (cyclic) {
        assemble_lines(LINES, 1 / l->width[k], phi_line + (n - 1) * LINES, phi_line, u, f, D, up, down);
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

/* ---- bounds ---- */

struct sides { /* faces of a cell along an axis */
    long low, high;
};
static struct sides sides_of(const struct segregation_field *s, int k, long c) {
    const long block = s->lattice.n[k] * s->stride[k], low = c + c / block * s->stride[k];
    return (struct sides){low, low + s->stride[k]};
}

/* Is the flux through an inner face of the cell not monotone? */
static bool beside_coarse(const struct segregation_field *s, int k, long cell, struct sides sides) {
    const struct segregation_lattice *l = &s->lattice;
    const long i = cell / s->stride[k] % l->n[k];
    const double enough = 2 / l->width[k];
    bool low = fabs(l->u[k][sides.low]) + fabs(l->f[k][sides.low]) > enough * l->D[k][sides.low];
    bool high = fabs(l->u[k][sides.high]) + fabs(l->f[k][sides.high]) > enough * l->D[k][sides.high];
    return (low && (i > 0 || l->cyclic[k])) || (high && (i < l->n[k] - 1 || l->cyclic[k]));
}

/* Computes the low fluxes, the mean of as many monotone steps as dt needs, and their phi in s->low. */
static void monotone_steps(struct segregation_field *s, double dt, const double *phi) {
    long steps = (long)ceil(dt * s->advance_rate);
    if (steps < 1) steps = 1;
    memcpy(s->low, phi, (size_t)s->cells * sizeof *phi);
    for (long i = 0; i < steps; i++) {
        take_flux(s, monotone_flux_lattice, s->low, s->part);
        subtract_divergence(s, dt / (double)steps, s->part, s->low);
        for (int k = 0; k < s->lattice.dim; k++)
            for (long j = 0; j < s->faces[k]; j++)
                s->low_flux[k][j] = (i ? s->low_flux[k][j] : 0) + s->part[k][j] / (double)steps;
    }
    s->counts.substeps += steps;
}

static void widen(double *least, double *most, double a, double b) {
    *least = smaller(*least, smaller(a, b));
    *most = larger(*most, larger(a, b));
}
static void find_bounds(struct segregation_field *s, const double *phi) {
    const struct segregation_lattice *l = &s->lattice;
    long i[MAX_DIM] = {0};
    for (long c = 0; c < s->cells; c++) {
        double least = 1, most = 0;
        widen(&least, &most, phi[c], s->low[c]);
        for (int k = 0; k < l->dim && s->sharp[c]; k++) {
            /* 0: the cell itself stands for its neighbour */
            const long around = l->cyclic[k] ? (l->n[k] - 1) * s->stride[k] : 0;
            const long below = i[k] > 0 ? c - s->stride[k] : c + around;
            const long above = i[k] < l->n[k] - 1 ? c + s->stride[k] : c - around;
            widen(&least, &most, phi[below], s->low[below]);
            widen(&least, &most, phi[above], s->low[above]);
        }
        s->least[c] = s->sharp[c] ? larger(least, 0) : 0;
        s->most[c] = s->sharp[c] ? smaller(most, 1) : 1;
        for (int k = 0; k < l->dim && ++i[k] == l->n[k]; k++) i[k] = 0;
    }
}

/* Limits the cell's faces to what keeps it within its bounds whatever the other faces do. */
static void limit_cell(struct segregation_field *s, double dt, long c) {
    double gain = 0, loss = 0;
    for (int k = 0; k < s->lattice.dim; k++) {
        struct sides f = sides_of(s, k, c);
        double per = dt * s->ease[c] / s->lattice.width[k], in = s->flux[k][f.low], out = s->flux[k][f.high];
        gain += per * (larger(in, 0) - smaller(out, 0));
        loss += per * (larger(out, 0) - smaller(in, 0));
    }
    const double room = larger(s->most[c] - s->low[c], 0), stock = larger(s->low[c] - s->least[c], 0);
    const double gains = gain > room ? room / gain : 1, losses = loss > stock ? stock / loss : 1;
    for (int k = 0; k < s->lattice.dim; k++) {
        struct sides f = sides_of(s, k, c);
        s->part[k][f.low] = smaller(s->part[k][f.low], s->flux[k][f.low] > 0 ? gains : losses);
        s->part[k][f.high] = smaller(s->part[k][f.high], s->flux[k][f.high] > 0 ? losses : gains);
    }
}
/* Returns phi' of cell c with the fluxes as limited so far. */
static double limited(const struct segregation_field *s, double dt, long c) {
    double out = s->low[c];
    for (int k = 0; k < s->lattice.dim; k++) {
        struct sides f = sides_of(s, k, c);
        out -= dt * s->ease[c] / s->lattice.width[k] *
               (s->part[k][f.high] * s->flux[k][f.high] - s->part[k][f.low] * s->flux[k][f.low]);
    }
    return out;
}

/* Makes the shares on both copies of a seam's faces equal: the smaller one holds. */
static void join_parts(struct segregation_field *s) {
    for (int k = 0; k < s->lattice.dim; k++) {
        const long across = s->stride[k], n = s->lattice.n[k] * across;
        for (long outer = 0; s->lattice.cyclic[k] && outer < outer_count(s, k); outer++)
            for (long i = 0; i < across; i++) {
                double *low = s->part[k] + outer * (n + across) + i, *high = low + n;
                *low = *high = smaller(*low, *high);
            }
    }
}

/* Brings s->next within its bounds; s->flux becomes its excess over the low flux. */
static void bound(struct segregation_field *s, double dt, const double *phi) {
    s->counts.bounded++;
    monotone_steps(s, dt, phi);
    find_bounds(s, phi);
    for (int k = 0; k < s->lattice.dim; k++)
        for (long j = 0; j < s->faces[k]; j++) {
            s->flux[k][j] -= s->low_flux[k][j];
            s->part[k][j] = 1;
        }
    memset(s->watched, 0, (size_t)s->cells * sizeof *s->watched);
    for (bool again = true; again;) {
        again = false;
        for (long c = 0; c < s->cells; c++) {
            s->next[c] = limited(s, dt, c);
            if (s->watched[c] || (s->next[c] >= s->least[c] && s->next[c] <= s->most[c])) continue;
            s->watched[c] = again = true;
        }
        for (long c = 0; c < s->cells; c++)
            if (s->watched[c]) limit_cell(s, dt, c);
        join_parts(s);
    }
    for (int k = 0; k < s->lattice.dim; k++)
        for (long j = 0; j < s->faces[k]; j++) s->counts.corrected += s->part[k][j] < 1;
}

/* Makes a step from phi with D as it is: s->flux, s->next. late: 1/2 Crank-Nicolson, 1 implicit Euler. */
static void central_step(struct segregation_field *s, double dt, double late, const double *phi) {
    take_flux(s, central_flux_lattice, phi, s->flux);
    memset(s->change, 0, (size_t)s->cells * sizeof *s->change);
    subtract_divergence(s, dt, s->flux, s->change);
    for (int k = 0; k < s->lattice.dim; k++) solve_axis(s, dt, late, k, phi);
    memcpy(s->next, phi, (size_t)s->cells * sizeof *phi);
    subtract_divergence(s, dt, s->flux, s->next);
}

static void find_rates(struct segregation_field *s);
KERNEL static void face_means(long n, const double *restrict below, const double *restrict above,
                              double *restrict out) {
    for (long i = 0; i < n; i++) out[i] = 0.5 * (below[i] + above[i]);
}
/* Sets D from the law at phi. */
static void take_law(struct segregation_field *s, const double *phi) {
    const struct segregation_lattice *l = &s->lattice;
    for (int k = 0; k < l->dim; k++) {
        const long across = s->stride[k], n = l->n[k] * across;
        double *at = s->part[k];
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            const double *cells = phi + outer * n;
            double *low = at + outer * (n + across);
            face_means(n - across, cells, cells + across, low + across);
            face_means(across, cells, l->cyclic[k] ? cells + n - across : cells, low);
            face_means(across, cells + n - across, l->cyclic[k] ? cells : cells + n - across, low + n);
        }
        l->law(l->context, k, at, s->D[k]);
    }
    find_rates(s);
}

static status step(struct segregation_field *s, double dt, double late, double *phi) {
    double least = 0, most = 1, none = 0;
    if (s->lattice.law) {
        take_law(s, phi);
        central_step(s, dt, late, phi);
        for (long c = 0; c < s->cells; c++) s->low[c] = 0.5 * (phi[c] + smaller(larger(s->next[c], 0), 1));
        take_law(s, s->low);
    }
    central_step(s, dt, late, phi);
    for (long c = 0; c < s->cells; c++) {
        least = smaller(s->next[c], least);
        most = larger(s->next[c], most);
        none += 0 * s->next[c];
    }
    if (!(none == 0)) return fail(ERR_STATE, "the step of %g s is too long for the lines' systems", dt);
    s->counts.steps++;
    if (s->coarse || least < -ROUND || most > 1 + ROUND) bound(s, dt, phi);
    for (long c = 0; c < s->cells; c++) phi[c] = smaller(larger(s->next[c], 0), 1); /* round-off */
    return OK;
}

static status lattice_step(void *lattice, double dt, double late, double *phi) {
    return step(lattice, dt, late, phi);
}
static struct segregation_steps steps_of(struct segregation_field *s) {
    return (struct segregation_steps){s, lattice_step, s->cells, s->lattice.capacity, s->before, s->whole, s->halves};
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
            struct sides f = sides_of(s, k, c);
            double out = larger(l->u[k][f.high] + fabs(l->f[k][f.high]), 0),
                   in = larger(fabs(l->f[k][f.low]) - l->u[k][f.low], 0);
            flow += s->ease[c] * (out + in) / l->width[k];
            spread += s->ease[c] * (l->D[k][f.low] + l->D[k][f.high]) / (l->width[k] * l->width[k]);
            s->sharp[c] = s->sharp[c] || beside_coarse(s, k, c, f);
        }
        s->coarse = s->coarse || s->sharp[c];
        s->rate = larger(s->rate, flow);
        s->advance_rate = larger(s->advance_rate, flow + spread);
    }
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
    status e = make_room(s);
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
    free(s->room);
    free(s->watched);
    free(s);
}
struct segregation_lattice_counts segregation_field_counts(const struct segregation_field *s) {
    return s->counts;
}
double segregation_field_rate(const struct segregation_field *s) {
    return s->rate;
}
