#include "tests/stress/watch.h"

#include "libcore/lattice/tiles.h"
#include "libcore/polyhedral/cells.h"

#include <stdio.h>
#include <stdlib.h>

void watch_cells(const struct gas *g, const struct state *s, watch_visitor *visit, void *context) {
    const struct forest *f = g->forest;
    double U[MAX_VAR];
    long cell = 0;
    for (int t = 0; f && t < f->ntiles; t++) {
        const int *n = f->tile[t].n;
        activity_store_all(g, t, s);
        for (int k = 0; k < n[2]; k++)
            for (int j = 0; j < n[1]; j++)
                for (int i = 0; i < n[0]; i++) {
                    long at = f->first + i + j * f->stride[1] + k * f->stride[2];
                    for (int v = 0; v < g->nvar; v++) U[v] = s->block[t][v * f->size + at];
                    visit(context, cell++, f->volume, U);
                }
    }
    for (int i = 0; !f && i < g->cells->polyhedra->nown; i++) {
        for (int v = 0; v < g->nvar; v++) U[v] = s->block[0][v * g->cells->polyhedra->size + i];
        visit(context, cell++, g->cells->polyhedra->volume[i], U);
    }
}

static long double kinetic(int dim, const double U[MAX_VAR]) {
    long double square = 0;
    for (int k = 1; k <= dim; k++) square += (long double)U[k] * U[k];
    return square / (2 * (long double)U[0]);
}

struct look {
    const struct gas *g;
    char *why;
    size_t size;
    long bad;
};

static void look_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct look *l = context;
    const struct gas *g = l->g;
    const struct material *m = &g->models.material;
    (void)volume;
    bool fine = isgreater(U[0], 0);
    for (int v = 0; v < g->nvar; v++) fine = fine && isfinite(U[v]);
    long double nu = 3.14159265358979323846L / 6 * U[0] * m->diameter * m->diameter * m->diameter / m->mass;
    /* the bound on rho is itself rounded, once or twice */
    if (fine && g->models.eos->bounded) fine = nu / m->alpha_max < 1 + 4 * 0x1p-52L;
    long double energy = fine ? U[g->dim + 1] - kinetic(g->dim, U) : 0;
    if (fine && energy > 0) return;
    if (!l->bad++)
        snprintf(l->why, l->size, "cell %ld: rho %.17g, alpha/alphaMax - 1 %.3Lg, E %.17g of which internal %.3Lg",
                 cell, U[0], nu / m->alpha_max - 1, U[g->dim + 1], energy);
}

static long look(struct watch *w, struct gas *g, const struct state *s) {
    struct look l = {.g = g, .why = w->why, .size = sizeof w->why};
    watch_cells(g, s, look_visit, &l);
    return l.bad;
}

/* Every state that a later one is made from, and no other, is looked at: those of an attempt that was thrown away are
 * forgotten when the next one starts. */
static void look_on(struct watch *w, struct gas *g, const struct state *s) {
    if (!w->bad) w->bad = look(w, g, s);
}

struct tally {
    const struct gas *g;
    long double sum[MAX_VAR], magnitude[3];
};

/* What one stage rounds is a multiple of eps times the variables and times dt/h fluxes; the Courant number bounds the
 * latter by rho, rho (|u| + c) and E + p. */
static void tally_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct tally *t = context;
    const struct gas *g = t->g;
    double eps = (double)((U[g->dim + 1] - kinetic(g->dim, U)) / U[0]), p, c2, gruneisen;
    (void)cell;
    g->models.eos->state(&g->models.material, 1, U, &eps, &p, &c2, &gruneisen);
    long double speed = sqrtl(2 * kinetic(g->dim, U) / U[0]) + sqrtl(c2);
    for (int v = 0; v < g->nvar; v++) t->sum[v] += (long double)volume * U[v];
    t->magnitude[0] += (long double)volume * U[0];
    t->magnitude[1] += volume * U[0] * speed;
    t->magnitude[2] += (long double)volume * (U[g->dim + 1] + p);
}

static void tally(struct watch *w, const struct gas *g) {
    struct tally t = {.g = g};
    watch_cells(g, &g->U, tally_visit, &t);
    memcpy(w->budget.now, t.sum, sizeof t.sum);
    for (int i = 0; i < 3; i++) {
        w->budget.magnitude[i] = t.magnitude[i];
        w->budget.rounding[i] += g->models.stepper->stages * t.magnitude[i];
    }
}

struct sourced {
    struct watch *w;
    const struct gas *g;
    double dt, kick[MAX_DIM];
    long double *gained;
};

static void before_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct sourced *s = context;
    (void)volume;
    for (int v = 0; v < s->g->nvar; v++) s->w->before[MAX_VAR * cell + v] = U[v];
}

/* Torquato's contact value of disks or its derivatives on one of its branches (shared/physics.md 2.1). */
static long double branch(bool dense, int derivative, long double nu, long double f, long double c) {
    const long double chi = (1 - 0.436L * f) / ((1 - f) * (1 - f)) * (c - f) / (c - nu), r = 1 - nu;
    if (dense) return derivative == 0 ? chi : derivative == 1 ? chi / (c - nu) : 2 * chi / ((c - nu) * (c - nu));
    if (derivative == 0) return (1 - 0.436L * nu) / (r * r);
    if (derivative == 1) return (-0.436L * r + 2 * (1 - 0.436L * nu)) / (r * r * r);
    return (-1.744L * r + 6 * (1 - 0.436L * nu)) / (r * r * r * r);
}

static long double torquato(const struct material *m, long double nu) {
    const long double f = m->freezing, c = m->alpha_max, w = m->smoothing, h = 2 * w, t = (nu - f + w) / h;
    if (t <= 0 || t >= 1) return branch(t >= 1, 0, nu, f, c);
    const long double c0 = branch(false, 0, f - w, f, c), c1 = h * branch(false, 1, f - w, f, c),
                      c2 = h * h * branch(false, 2, f - w, f, c) / 2, d0 = branch(true, 0, f + w, f, c) - c0 - c1 - c2,
                      d1 = h * branch(true, 1, f + w, f, c) - c1 - 2 * c2,
                      d2 = h * h * branch(true, 2, f + w, f, c) - 2 * c2;
    const long double c3 = 10 * d0 - 4 * d1 + d2 / 2, c4 = -15 * d0 + 7 * d1 - d2, c5 = 6 * d0 - 3 * d1 + d2 / 2;
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))));
}

/* G = nu chi of disks, its tangent where packing is next. */
static long double disks_contact(const struct material *m, long double nu, long double *condition) {
    const long double c = m->alpha_max, last = EOS_PACKING * c;
    *condition = 1 + c / (c - (nu < last ? nu : last));
    if (nu < last) return nu * torquato(m, nu);
    const long double chi = torquato(m, last);
    return last * chi + (nu - last) * (chi + last * branch(true, 1, last, m->freezing, c));
}

/* 1 + B sqrt(T) dt/2 of Haff's law, and how much larger its rounding is than eps: 1 - x cancels near packing. */
static long double slowing(const struct gas *g, double dt, double rho, long double eps, long double *condition) {
    const struct material *m = &g->models.material;
    const long double pi = 3.14159265358979323846L;
    long double nu = pi / 6 * rho * m->diameter * m->diameter * m->diameter / m->mass, a = 4 * m->alpha_max / 3.0L;
    long double free = g->models.eos->bounded ? 1 - powl(nu / m->alpha_max, a) : 1, T = (m->gamma - 1) * eps;
    long double contact = nu / free;
    *condition = 1 + a / free;
    if (m->disks) contact = disks_contact(m, pi / 4 * rho * m->diameter * m->diameter / m->mass, condition);
    if (!g->models.source.cooling || m->restitution >= 1 || T <= 0) return 1;
    long double loss = 1 - (long double)m->restitution * m->restitution;
    loss *= (m->disks ? 4 : 12) / sqrtl(pi) / m->diameter * contact;
    return 1 + (m->gamma - 1) * loss * sqrtl(T) * dt / 2;
}

/* The exact step cell by cell; what the step gave is summed up for the budget. */
static void after_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct sourced *s = context;
    const int dim = s->g->dim, last = dim + 1;
    const long double *old = s->w->before + MAX_VAR * cell;
    double start[MAX_VAR];
    long double square = 0, unit = 16 * 0x1p-52L, condition;
    for (int v = 0; v <= last; v++) start[v] = (double)old[v];
    long double eps = (old[last] - kinetic(dim, start)) / old[0];
    long double slow = slowing(s->g, s->dt, U[0], eps, &condition);
    s->gained[0] += volume * ((long double)U[0] - old[0]);
    for (int k = 1; k <= dim; k++) {
        long double exact = old[k] + old[0] * s->kick[k - 1];
        long double room = unit * (fabsl(old[k]) + fabsl(exact));
        square += exact * exact;
        if (room > 0) s->w->trial = fmax(s->w->trial, (double)(fabsl(exact - U[k]) / room));
        s->gained[k] += volume * (exact - old[k]);
    }
    long double exact = old[0] * eps / (slow * slow) + square / (2 * old[0]);
    long double room = unit * (fabsl(old[last]) + fabsl(exact) + condition * old[0] * eps * (slow - 1) / (slow * slow));
    if (s->g->models.material.threshold > 0) { /* its step is of second order: here only cooler, and above zero */
        long double hottest = old[0] * eps + square / (2 * old[0]), least = square / (2 * old[0]);
        exact = U[last] > hottest + room ? hottest : U[last] < least - room ? least : U[last];
    }
    s->w->trial = fmax(s->w->trial, (double)(fabsl(exact - U[last]) / room));
    s->gained[last] += volume * ((long double)U[last] - old[last]);
}

/* The sources go through all rows by source_row: before and after that every cell is looked at. */
static void watched_rows(const struct gas *g, enum extent extent, const struct state *from, row_visitor *visit,
                         void *context) {
    struct watch *w = (struct watch *)(uintptr_t)g->engine;
    const struct half_step *h = context;
    if (visit != source_row) {
        w->inner->state.rows(g, extent, from, visit, context);
        return;
    }
    struct sourced s = {.w = w, .g = g, .dt = h->plan->step[0].dt, .gained = w->budget.gained[from != &g->U]};
    for (int i = 0; i < h->plan->n; i++)
        for (int k = 0; k < MAX_DIM; k++) s.kick[k] += h->plan->step[i].kick[k];
    for (int v = 0; v < MAX_VAR; v++) s.gained[v] = 0;
    if (from == &g->U) w->trial = 0;
    if (from != &g->U) look_on(w, (struct gas *)(uintptr_t)g, from); /* what the last stage left */
    watch_cells(g, from, before_visit, &s);
    w->inner->state.rows(g, extent, from, visit, context);
    if (w->inner->state.keep_as) w->inner->state.keep_as(g, from, h->to);
    watch_cells(g, h->to, after_visit, &s);
}

static long watched_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                          double a, double dt) {
    struct watch *w = (struct watch *)(uintptr_t)g->engine;
    if (U0 == from) w->bad = 0;
    look_on(w, g, from);
    return w->inner->stage.stage(g, U0, from, to, a, dt);
}

status watch_start(struct watch *w, struct gas *g) {
    *w = (struct watch){.engine = *g->engine, .inner = g->engine};
    TRY(allocate(&w->before, (long)MAX_VAR * g->ncells_all, sizeof *w->before, "the watch"));
    w->engine.stage.stage = watched_stage;
    w->engine.stage.last_stage = NULL; /* step.c then calls the sources by themselves; the bits are the same */
    w->engine.state.rows = watched_rows;
    g->engine = &w->engine;
    tally(w, g);
    memcpy(w->budget.start, w->budget.now, sizeof w->budget.now);
    return OK;
}

bool watch_step_finish(struct watch *w, struct gas *g) {
    look_on(w, g, &g->U);
    if (w->bad) return false;
    w->source = fmax(w->source, w->trial);
    for (int v = 0; v < g->nvar; v++) {
        w->budget.gain[v] += w->budget.gained[0][v] + w->budget.gained[1][v];
        w->budget.gained[0][v] = w->budget.gained[1][v] = 0;
    }
    tally(w, g);
    return true;
}

void watch_free(struct watch *w) {
    free(w->before);
}
