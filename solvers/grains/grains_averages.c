/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects moments of the grains and their impacts over windows of time (grains_averages.h); libcore/grains/coarse.h
 * has the formulas. */
#include "solvers/grains/grains_averages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct quantity grains_quantity[] = {GRAINS_QUANTITY_ROWS};
const enum coarse_field grains_coarse_of[] = {COARSE_RHO, COARSE_ALPHA, COARSE_U, COARSE_T, COARSE_P, COARSE_T_AXES};
const int grains_written[] = {0, 1, 2, 3, 4, 5, -1};
static const int of_kinds[KIND_QUANTITIES] = {1, 2, 3}; /* alpha U T */

/* Returns the quantity of all grains that one of a kind belongs to; *kind: that kind, -1: all. */
static int quantity_of_all(int quantity, int *kind) {
    const int behind = quantity - GRAINS_QUANTITIES;
    *kind = behind < 0 ? -1 : behind / KIND_QUANTITIES;
    return behind < 0 ? quantity : of_kinds[behind % KIND_QUANTITIES];
}

struct offered grains_fields_offer(struct grains_fields *f, const struct grains_models *m) {
    const int n = GRAINS_QUANTITIES + m->kinds.n * KIND_QUANTITIES;
    for (int q = 0; q < n; q++) {
        int kind;
        f->quantity[q] = grains_quantity[quantity_of_all(q, &kind)];
        f->written[q] = q;
        if (kind < 0) continue;
        char *name = f->name[q - GRAINS_QUANTITIES];
        snprintf(name, sizeof f->name[0], "%s.%s", f->quantity[q].name, m->kind_name[kind]);
        f->quantity[q].name = name;
    }
    f->written[n] = -1;
    return (struct offered){f->quantity, n, f->written, f->written};
}

int grains_components(const struct setup *s, int quantity) {
    int kind;
    return grains_quantity[quantity_of_all(quantity, &kind)].components == 3 ? s->dim : 1;
}

struct averages {
    struct averages_mark mark;
    struct coarse *sum[2];   /* sums of the running window; of the last complete one, or of a moment */
    double (*x)[3], (*u)[3]; /* [grains] */
    uint8_t *kind;           /* [grains] */
    double moment;           /* s: time of sum[1] before a window is complete; NAN: it is empty */
    double grid[16];         /* as in struct averages_saved */
};

static void grid_numbers(const struct coarse_grid *g, double v[16]) {
    int n = 0;
    v[n++] = g->dim;
    for (int k = 0; k < 3; k++) {
        v[n++] = g->n[k];
        v[n++] = g->low[k];
        v[n++] = g->h[k];
    }
    v[n++] = g->periodic[0] + 2 * g->periodic[1] + 4 * g->periodic[2];
    v[n++] = g->kernel;
    v[n++] = g->width;
    v[n++] = g->mass;
    v[n++] = g->diameter;
    while (n < 16) v[n++] = 0;
}

struct coarse_grid grains_grid(const struct setup *s, const struct grains_models *m, const struct grains_mesh *mesh) {
    const struct lattice *l = s->lattice;
    struct coarse_grid g = {.dim = s->dim,
                            .kernel = m->kernel,
                            .width = m->width,
                            .mass = m->grain.mass,
                            .diameter = m->grain.diameter,
                            .kinds = m->kinds.n ? &m->kinds : NULL,
                            .mesh = mesh ? &mesh->base : NULL};
    for (int k = 0; k < 3; k++) {
        const bool solved = k < g.dim;
        g.n[k] = mesh ? 1 : l->n[k];
        g.low[k] = !solved ? 0 : mesh ? mesh->low[k] : l->origin[k];
        g.h[k] = !solved ? 1 : mesh ? mesh->high[k] - mesh->low[k] : l->width[k];
        g.periodic[k] = solved && (mesh ? mesh->periodic[k] : l->periodic[k]);
    }
    return g;
}

static double sample_time(const struct averages_mark *m) {
    return ((double)m->index + (m->taken + 0.5) / m->samples) * m->window;
}

static void begin(struct averages_mark *m, double t) {
    const double k = floor(t / m->window + 1e-9);
    m->index = (int64_t)k;
    m->whole = fabs(t - k * m->window) <= 1e-9 * m->window;
    while (m->taken < m->samples && sample_time(m) < t) m->taken++;
}

status averages_make(const struct coarse_grid *grid, double window, int samples, double t, int grains,
                     struct averages **out) {
    struct averages *a = NULL;
    *out = NULL;
    TRY(allocate(&a, 1, sizeof *a, "averages"));
    *out = a;
    a->mark = (struct averages_mark){.window = window, .samples = samples};
    a->moment = NAN;
    grid_numbers(grid, a->grid);
    if (window > 0) begin(&a->mark, t);
    TRY(coarse_make(grid, &a->sum[0]));
    TRY(coarse_make(grid, &a->sum[1]));
    return averages_room(a, grains);
}

status averages_room(struct averages *a, int grains) {
    free(a->x);
    free(a->u);
    free(a->kind);
    a->x = a->u = NULL;
    a->kind = NULL;
    TRY(allocate(&a->x, grains, sizeof *a->x, "averages"));
    TRY(allocate(&a->kind, grains, sizeof *a->kind, "averages"));
    return allocate(&a->u, grains, sizeof *a->u, "averages");
}

status averages_resume(const struct coarse_grid *grid, double window, int samples, double t, int grains,
                       const struct averages_saved *saved, struct averages **out, bool *kept) {
    *kept = false;
    TRY(averages_make(grid, window, samples, t, grains, out));
    struct averages *a = *out;
    if (!saved || saved->nsums != coarse_size(a->sum[0]) || memcmp(a->grid, saved->grid, sizeof a->grid) != 0 ||
        saved->mark.window != a->mark.window || saved->mark.samples != a->mark.samples)
        return OK;
    *kept = true;
    a->mark = saved->mark;
    for (int k = 0; k < 2; k++) memcpy(coarse_sums(a->sum[k]), saved->sums[k], (size_t)saved->nsums * sizeof(double));
    return OK;
}

void averages_save(struct averages *a, struct averages_saved *out) {
    out->mark = a->mark;
    memcpy(out->grid, a->grid, sizeof out->grid);
    for (int k = 0; k < 2; k++) out->sums[k] = averages_sums(a, k, &out->nsums);
}

void averages_free(struct averages *a) {
    if (!a) return;
    coarse_free(a->sum[0]);
    coarse_free(a->sum[1]);
    free(a->x);
    free(a->u);
    free(a->kind);
    free(a);
}

struct grain_observer *averages_observer(struct averages *a) {
    return a->mark.window > 0 ? coarse_observer(a->sum[0]) : NULL;
}

double averages_next(const struct averages *a) {
    const struct averages_mark *m = &a->mark;
    if (!(m->window > 0)) return HUGE_VAL;
    return m->taken < m->samples ? sample_time(m) : (double)(m->index + 1) * m->window;
}

static void sample(struct averages *a, int which, const struct grains *g) {
    grains_at(g, grains_time(g), a->x, a->u);
    grains_kinds_by_number(g, a->kind);
    coarse_sample(a->sum[which], grains_number(g), (const double(*)[3])a->x, (const double(*)[3])a->u, a->kind);
}

static void close_window(struct averages *a) {
    struct coarse *seen = a->sum[0];
    if (a->mark.whole) {
        a->sum[0] = a->sum[1];
        a->sum[1] = seen;
        a->mark.complete = 1;
    }
    coarse_clear(a->sum[0]);
    a->mark.index++;
    a->mark.taken = 0;
    a->mark.whole = 1;
}

/* Closes the window if all its samples are there. */
static bool at_end(struct averages *a) {
    if (a->mark.taken < a->mark.samples) {
        a->mark.taken++;
        return false;
    }
    close_window(a);
    return true;
}

void averages_take(struct averages *a, const struct grains *g) {
    if (!at_end(a)) sample(a, 0, g);
}

void averages_value(struct averages *a, const struct grains *g, int quantity, double *const out[3]) {
    int kind;
    const enum coarse_field f = grains_coarse_of[quantity_of_all(quantity, &kind)];
    if (!a->mark.complete && a->moment != grains_time(g)) {
        coarse_clear(a->sum[1]);
        sample(a, 1, g);
        a->moment = grains_time(g);
    }
    if (kind >= 0)
        coarse_kind(a->sum[1], kind, f, out);
    else
        coarse_value(a->sum[1], a->mark.complete ? a->mark.window : 0, f, out);
}

static void sample_soft(struct averages *a, int which, const struct averages_moment *now) {
    coarse_rough(a->sum[which], now->n, now->x, now->u, now->spin);
    coarse_contacts(a->sum[which], now->ncontacts, now->contact);
}

void averages_take_soft(struct averages *a, const struct averages_moment *now) {
    if (!at_end(a)) sample_soft(a, 0, now);
}

void averages_value_soft(struct averages *a, const struct averages_moment *now, enum coarse_field f,
                         double *const out[3]) {
    if (!a->mark.complete && a->moment != now->t) {
        coarse_clear(a->sum[1]);
        sample_soft(a, 1, now);
        a->moment = now->t;
    }
    coarse_value(a->sum[1], a->mark.complete ? a->mark.samples : 1, f, out);
}

struct averages_mark *averages_mark(struct averages *a) {
    return &a->mark;
}
double *averages_sums(struct averages *a, int which, long *n) {
    *n = coarse_size(a->sum[which]);
    return coarse_sums(a->sum[which]);
}
