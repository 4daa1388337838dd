/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/watch.h"

#include "libcore/lattice/tiles.h"
#include "libcore/polyhedral/cells.h"

#include <stdio.h>
#include <stdlib.h>

static long cells_of_mesh(const struct gas *g) {
    return g->forest ? g->forest->ncells_all : g->blocks.grid->ncells_all;
}

/* Calls visit for each cell of this rank: its number here, and its place in a line of a block. */
typedef void place_visitor(void *context, long cell, int block, long at);
static void watch_places(const struct gas *g, place_visitor *visit, void *context) {
    const struct forest *f = g->forest;
    long cell = 0;
    for (int t = 0; f && t < f->ntiles; t++) {
        const int *n = f->tile[t].n;
        for (int k = 0; k < n[2]; k++)
            for (int j = 0; j < n[1]; j++)
                for (int i = 0; i < n[0]; i++)
                    visit(context, cell++, t, f->first + i + j * f->stride[1] + k * f->stride[2]);
    }
    for (int i = 0; !f && i < g->cells->polyhedra->nown; i++) visit(context, cell++, 0, i);
}

struct case_reading { /* of a state */
    const struct gas *g;
    const struct state *s;
    watch_visitor *visit;
    void *context;
};

/* Volumes of round bodies are those of the full turn, as in budgets. */
static double volume_of(const struct gas *g, int block, long at) {
    const struct forest *f = g->forest;
    const struct polyhedra *m = f ? NULL : g->cells->polyhedra;
    if (m) return m->volume[at] * (m->round.radial >= 0 ? m->thickness : 1);
    return f->volume * (f->radial < 0 ? 1 : forest_radius(f, forest_place_along(f, block, at, f->radial) + 0.5));
}

static void read_place(void *context, long cell, int block, long at) {
    const struct case_reading *r = context;
    const struct gas *g = r->g;
    double U[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) U[v] = r->s->block[block][v * g->size + at];
    r->visit(r->context, cell, volume_of(g, block, at), U);
}

void watch_cells(const struct gas *g, const struct state *s, watch_visitor *visit, void *context) {
    for (int t = 0; g->forest && t < g->forest->ntiles; t++) activity_store_all(g, t, s);
    watch_places(g, read_place, &(struct case_reading){g, s, visit, context});
}

static long double kinetic(int components, const double U[MAX_VAR]) {
    long double square = 0;
    for (int k = 1; k <= components; k++) square += (long double)U[k] * U[k];
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
    const int d = m->disks ? 2 : 3;
    long double nu = 3.14159265358979323846L / (2 * d) * U[0] * powl(m->diameter, d) / m->mass;
    /* the bound on rho is itself rounded, once or twice */
    if (fine && isfinite(g->limits.most)) fine = nu / m->alpha_max < 1 + 4 * 0x1p-52L;
    long double energy = fine ? U[g->components + 1] - kinetic(g->components, U) : 0;
    if (fine && energy > 0) return;
    if (!l->bad++)
        snprintf(l->why, l->size, "cell %ld: rho %.17g, alpha/alphaMax - 1 %.3Lg, E %.17g of which internal %.3Lg",
                 cell, U[0], nu / m->alpha_max - 1, U[g->components + 1], energy);
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

struct census {
    const struct gas *g;
    long double sum[MAX_VAR], magnitude[4];
};

/* The arm of the angular momentum of cell i of a body of revolution. */
static long double arm_of(const struct gas *g, long i, double volume) {
    if (!g->models.swirl) return 0;
    if (!g->forest) return polyhedra_arm(g->cells->polyhedra, (int)i);
    const long double r = volume / g->forest->volume, h = g->forest->width[g->forest->radial];
    return r + h * h / (4 * r);
}

/* What one stage rounds is a multiple of eps times the variables and times dt/h fluxes; the Courant number bounds the
 * latter by rho, rho (|u| + c) and E + p. */
static void tally_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct census *t = context;
    const struct gas *g = t->g;
    double eps = (double)((U[g->components + 1] - kinetic(g->components, U)) / U[0]), p, c2, gruneisen;
    g->models.eos->state(&g->models.material, 1, U, &eps, &p, &c2, &gruneisen);
    long double speed = sqrtl(2 * kinetic(g->components, U) / U[0]) + sqrtl(c2);
    const long double arm = arm_of(g, cell, volume);
    for (int v = 0; v < g->nvar; v++)
        t->sum[v] += (long double)volume * U[v] * (g->models.swirl && v == g->models.swirl + 1 ? arm : 1);
    t->magnitude[0] += (long double)volume * U[0];
    t->magnitude[1] += volume * U[0] * speed;
    t->magnitude[3] += volume * U[0] * speed * arm;
    t->magnitude[2] += (long double)volume * (U[g->components + 1] + p);
}

/* Stages are counted with room for the two ends of a super step in each half of a step; more ends round more. */
enum { FEW = 4 };

static void tally(struct watch *w, const struct gas *g) {
    struct census t = {.g = g};
    watch_cells(g, &g->U, tally_visit, &t);
    memcpy(w->budget.now, t.sum, sizeof t.sum);
    for (int i = 0; i < 4; i++) {
        w->budget.magnitude[i] = t.magnitude[i];
        w->budget.largest = t.magnitude[2] > w->budget.largest ? t.magnitude[2] : w->budget.largest;
        w->budget.rounding[i] += (g->models.stepper->stages + (w->ends > FEW ? w->ends - FEW : 0)) * t.magnitude[i];
    }
}

struct sourced {
    struct watch *w;
    const struct gas *g;
    const struct source_plan *plan;
    bool first; /* half of the step */
    long double *gained;
};

static void before_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct sourced *s = context;
    (void)volume;
    for (int v = 0; v < s->g->nvar; v++) s->w->before[MAX_VAR * cell + v] = U[v];
}

/* Torquato's contact value of disks (d = 2) or spheres, or its derivatives, on one of its branches (docs/physics.md
 * 2.4): (1 - a nu)/(1 - nu)^d below freezing. */
static long double branch(int d, bool dense, int derivative, long double nu, long double f, long double c) {
    const long double a = d == 2 ? 0.436L : 0.5L, r = 1 - nu, rest = 1 - a * nu;
    const long double chi = (1 - a * f) / powl(1 - f, d) * (c - f) / (c - nu);
    if (dense) return derivative == 0 ? chi : derivative == 1 ? chi / (c - nu) : 2 * chi / ((c - nu) * (c - nu));
    if (derivative == 0) return rest / powl(r, d);
    if (derivative == 1) return (-a * r + d * rest) / powl(r, d + 1);
    return (-2 * a * d * r + d * (d + 1) * rest) / powl(r, d + 2);
}

static long double torquato(int d, const struct material *m, long double nu) {
    const long double f = m->freezing, c = m->alpha_max, w = m->smoothing, h = 2 * w, t = w > 0 ? (nu - f + w) / h : 0;
    if (w == 0 || t <= 0 || t >= 1) return branch(d, w > 0 ? t >= 1 : nu >= f, 0, nu, f, c);
    const long double c0 = branch(d, false, 0, f - w, f, c), c1 = h * branch(d, false, 1, f - w, f, c),
                      c2 = h * h * branch(d, false, 2, f - w, f, c) / 2,
                      d0 = branch(d, true, 0, f + w, f, c) - c0 - c1 - c2,
                      d1 = h * branch(d, true, 1, f + w, f, c) - c1 - 2 * c2,
                      d2 = h * h * branch(d, true, 2, f + w, f, c) - 2 * c2;
    const long double c3 = 10 * d0 - 4 * d1 + d2 / 2, c4 = -15 * d0 + 7 * d1 - d2, c5 = 6 * d0 - 3 * d1 + d2 / 2;
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))));
}

/* G = nu chi, and how much larger its rounding is than eps: next to packing a difference cancels. */
static long double contact(const struct gas *g, long double rho, long double *condition) {
    const struct material *m = &g->models.material;
    const struct eos *eos = g->models.eos;
    const int d = m->disks ? 2 : 3;
    const long double pi = 3.14159265358979323846L, c = m->alpha_max;
    const long double last = m->tangent ? EOS_PACKING * c : (1 - 0x1p-52L) * c;
    const long double nu = pi / (2 * d) * rho * powl(m->diameter, d) / m->mass, a = 4 * c / 3;
    *condition = 1;
    if (eos->bounded && !m->freezing) { /* Goldshtein & Shapiro */
        const long double free = 1 - powl(nu / c, a);
        *condition = 1 + a / free;
        return nu / free;
    }
    if (!m->freezing) return nu;
    *condition = 1 + c / (c - (nu < last ? nu : last));
    if (nu < last) return nu * torquato(d, m, nu);
    const long double chi = torquato(d, m, last); /* the tangent */
    return last * chi + (nu - last) * (chi + last * branch(d, true, 1, last, m->freezing, c));
}

/* What Garzo & Dufty's law has times Haff's rate: 1 + 3 a2/16 with a2 of van Noije & Ernst. */
static long double sonine(const struct material *m) {
    const long double e = m->restitution, top = 16 * (1 - e) * (1 - 2 * e * e), end = 30 * e * e * (1 - e);
    return 1 + 3 * top / (16 * (m->disks ? 57 - 25 * e + end : 81 - 17 * e + end));
}

/* 1 + B sqrt(T) dt/2 of the cooling law. */
static long double slowing(const struct gas *g, double dt, double rho, long double eps, long double *condition) {
    const struct material *m = &g->models.material;
    const long double G = contact(g, rho, condition), T = (m->gamma - 1) * eps;
    if (m->restitution >= 1 || T <= 0) return 1;
    long double loss = 1 - (long double)m->restitution * m->restitution;
    loss *= (m->disks ? 4 : 12) / sqrtl(3.14159265358979323846L) / m->diameter * G;
    if (!strcmp(g->models.source.cooling->model.name, "GarzoDufty")) loss *= sonine(m);
    return 1 + (m->gamma - 1) * loss * sqrtl(T) * dt / 2;
}

struct exact {                     /* of a cell */
    long double rho, mom[MAX_DIM]; /* momentum */
    long double low, high;         /* between which eps lies: both the same, unless there is a threshold speed */
    long double room[MAX_VAR];     /* what rounding adds, in units of eps */
};

static long double kinetic_of(const struct exact *x, int components) {
    long double square = 0;
    for (int k = 0; k < components; k++) square += x->mom[k] * x->mom[k];
    return square / (2 * x->rho);
}

/* One source, by its row of source_table and the parameters that it was given. */
static void exact_source(const struct gas *g, const struct source_step *step, bool falls, struct exact *x) {
    const char *name = step->row->model.name;
    const double *own = step->params->room, dt = step->dt;
    if (!strcmp(name, "cooling")) {
        long double condition, slow = slowing(g, dt, (double)x->rho, x->high, &condition), old = x->high;
        const bool spared =
            g->models.material.threshold > 0; /* its step is of second order: only cooler, and above 0 */
        x->high = spared ? x->high : x->high / (slow * slow);
        x->low = spared ? 0 : x->high;
        x->room[g->components + 1] += condition * x->rho * old * (slow - 1) / (slow * slow);
    } else if (!strcmp(name, "gravity")) {
        if (!falls) return;
        for (int k = 0; k < g->components; k++) x->mom[k] += x->rho * step->kick[k];
    } else if (!strcmp(name, "linearDrag")) {
        const long double decay = expl(-(long double)own[0] * dt > -300 ? -(long double)own[0] * dt : -300);
        for (int k = 0; k < g->components; k++)
            x->mom[k] = x->rho * own[1 + k] + (x->mom[k] - x->rho * own[1 + k]) * decay;
        for (int k = 0; k < g->components; k++) x->room[1 + k] += fabsl(x->rho * own[1 + k]);
        for (int k = 0; k < g->components; k++)
            x->room[g->components + 1] += fabsl(own[1 + k] * x->mom[k]); /* u times that */
        x->low *= decay * decay;
        x->high *= decay * decay;
    } else {
        x->low += own[0] * dt / (g->models.material.gamma - 1);
        x->high += own[0] * dt / (g->models.material.gamma - 1);
    }
    for (int k = 0; k < g->components; k++) x->room[1 + k] += fabsl(x->mom[k]);
    x->room[g->components + 1] += x->rho * x->high + kinetic_of(x, g->components);
}

/* What a half step of the plan makes of a cell, which falls or does not. */
static struct exact exact_step(const struct sourced *s, const long double old[MAX_VAR], bool falls) {
    const int components = s->g->components, last = components + 1;
    double start[MAX_VAR];
    struct exact x = {.rho = old[0]};
    for (int v = 0; v <= last; v++) start[v] = (double)old[v];
    for (int v = 1; v <= last; v++) x.room[v] = fabsl(old[v]);
    for (int k = 0; k < components; k++) x.mom[k] = old[1 + k];
    x.low = x.high = (old[last] - kinetic(components, start)) / old[0];
    for (int i = 0; i < s->plan->n; i++) exact_source(s->g, &s->plan->step[i], falls, &x);
    return x;
}

static long double momentum_off(const struct exact *x, int components, const double U[MAX_VAR]) {
    long double sum = 0;
    for (int k = 0; k < components; k++) sum += fabsl(x->mom[k] - U[1 + k]);
    return sum;
}

/* Does a cell fall, by its state before the step? Where eps is that of the threshold but for rounding, either will do:
 * then what the cell did says which it was. */
static bool does_fall(const struct sourced *s, const long double old[MAX_VAR], const double U[MAX_VAR]) {
    const int components = s->g->components;
    struct exact start = {.rho = old[0]};
    for (int k = 0; k < components; k++) start.mom[k] = old[1 + k];
    const long double moving = kinetic_of(&start, components),
                      off = (old[components + 1] - moving) / old[0] - s->plan->warm;
    if (fabsl(off) > 8 * 0x1p-52L * (old[components + 1] + moving) / old[0]) return off < 0;
    const struct exact x[2] = {exact_step(s, old, false), exact_step(s, old, true)};
    return momentum_off(&x[1], components, U) < momentum_off(&x[0], components, U);
}

/* The exact step cell by cell; what the step gave is summed up for the budget. */
static void after_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    struct sourced *s = context;
    const int components = s->g->components, last = components + 1;
    const long double *old = s->w->before + MAX_VAR * cell, unit = 16 * 0x1p-52L;
    if (s->first) s->w->falls[cell] = does_fall(s, old, U);
    const struct exact x = exact_step(s, old, s->w->falls[cell]);
    s->gained[0] += volume * ((long double)U[0] - old[0]);
    for (int k = 1; k <= components; k++) {
        const long double off = fabsl(x.mom[k - 1] - U[k]);
        if (off > 0) s->w->trial = fmax(s->w->trial, (double)(off / (unit * x.room[k])));
        s->gained[k] += volume * (x.mom[k - 1] - old[k]);
    }
    const long double least = x.rho * x.low + kinetic_of(&x, components),
                      most = x.rho * x.high + kinetic_of(&x, components);
    const long double off = U[last] < least ? least - U[last] : U[last] > most ? U[last] - most : 0;
    s->w->trial = fmax(s->w->trial, (double)(off / (unit * x.room[last])));
    s->gained[last] += volume * ((long double)U[last] - old[last]);
}

/* Notes the kick of gravity in a half step. After the second one the kicks of all stages must have been those of both,
 * in a scheme of second order at least. */
static void compare_kicks(struct watch *w, const struct gas *g, const struct source_step *step, bool first) {
    const long double unit = 16 * 0x1p-52L;
    for (int k = 0; k < g->components; k++) {
        w->kick[!first][k] = step->kick[k];
        if (first || g->models.stepper->stages == 1) continue;
        const long double room = fabsl(w->kick[0][k]) + fabsl(w->kick[1][k]);
        const long double off = fabsl(w->kick[0][k] + w->kick[1][k] - w->impulse[k]);
        if (off > 0) w->trial = fmax(w->trial, (double)(off / (unit * room)));
    }
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
    const bool first = from == &g->U;
    struct sourced s = {.w = w, .g = g, .plan = h->plan, .first = first, .gained = w->budget.gained[!first]};
    for (int v = 0; v < MAX_VAR; v++) s.gained[v] = 0;
    if (first) w->trial = 0;
    if (!first) look_on(w, (struct gas *)(uintptr_t)g, from); /* what the last stage left */
    watch_cells(g, from, before_visit, &s);
    w->inner->state.rows(g, extent, from, visit, context);
    spans_keep_as(g, from, h->to);
    watch_cells(g, h->to, after_visit, &s);
    for (int i = 0; i < h->plan->n; i++)
        if (!strcmp(h->plan->step[i].row->model.name, "gravity")) compare_kicks(w, g, &h->plan->step[i], first);
}

/* The fraction of what a stage adds that the result of the step holds. */
static long double carried(const struct stepper *s, int stage) {
    long double start = 0, state = 1 - (long double)s->a[stage];
    for (int i = stage; i < s->stages; i++) {
        if (i > stage) state += s->a[i] * (start - state);
        if (i + 1 != s->exchange) continue;
        const long double old = start;
        start = (old + 9 * state) / 10;
        state = (6 * old + 4 * state) / 10;
    }
    return state;
}

struct weighing { /* what gravity gives the cells in a stage */
    struct watch *w;
    const struct gas *g;
    double a, dt;
    long double part; /* carried */
    long double *gained;
};

/* All cells but those that fall, by the state that the stage starts from: rho g dt and rho u.g dt. */
static void weigh_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    const struct weighing *s = context;
    if (s->w->falls[cell] || s->w->flagged[cell]) return;
    for (int k = 0; k < s->g->components; k++) {
        const long double kick = s->part * volume * s->dt * s->g->falling.gravity[k];
        s->gained[1 + k] += kick * U[0];
        s->gained[s->g->components + 1] += kick * U[1 + k];
    }
}

static void start_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    const struct weighing *s = context;
    (void)volume;
    for (int v = 0; v < s->g->nvar; v++) s->w->before[MAX_VAR * cell + v] = U[v];
}

/* Flagged cells fall in W = (to - a U0)/(1 - a): of the momentum m there they had m - rho dt g before. */
static void drop_visit(void *context, long cell, double volume, const double U[MAX_VAR]) {
    const struct weighing *s = context;
    const long double *start = s->w->before + MAX_VAR * cell, rest = 1 - (long double)s->a;
    if (s->w->falls[cell] || !s->w->flagged[cell]) return;
    const long double rho = (U[0] - s->a * start[0]) / rest;
    for (int k = 0; k < s->g->components; k++) {
        const long double kick = (long double)s->dt * s->g->falling.gravity[k],
                          mom = (U[1 + k] - s->a * start[1 + k]) / rest;
        s->gained[1 + k] += s->part * volume * rho * kick;
        s->gained[s->g->components + 1] += s->part * volume * kick * (mom - rho * kick / 2);
    }
}

/* Books what gravity gave in the stage in hand, which may be done again. */
static void book_stage(struct watch *w, const struct gas *g, const struct state *U0, const struct state *from,
                       const struct state *to, double a, double dt) {
    struct weighing s = {w, g, a, dt, carried(g->models.stepper, w->stage), w->budget.weighed[w->stage]};
    for (int v = 0; v < MAX_VAR; v++) s.gained[v] = 0;
    if (!source_falls(&g->models.source, g->components)) return;
    watch_cells(g, from, weigh_visit, &s);
    if (!to) return;
    watch_cells(g, U0, start_visit, &s);
    watch_cells(g, to, drop_visit, &s);
}

static long watched_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                          double a, double dt, struct ending *ending) {
    struct watch *w = (struct watch *)(uintptr_t)g->engine;
    if (U0 == from) {
        w->bad = w->stage = 0;
        for (int k = 0; k < MAX_DIM; k++) w->impulse[k] = 0;
    } else {
        w->stage++;
    }
    look_on(w, g, from);
    for (int k = 0; k < g->components; k++)
        w->impulse[k] += carried(g->models.stepper, w->stage) * dt * g->falling.gravity[k];
    memset(w->flagged, 0, (size_t)cells_of_mesh(g) * sizeof *w->flagged);
    book_stage(w, g, U0, from, NULL, a, dt);
    return w->inner->stage.stage(g, U0, from, to, a, dt, ending);
}

struct flags {
    struct watch *w;
    const struct gas *g;
};
static void flag_visit(void *context, long cell, int block, long at) {
    const struct flags *f = context;
    const double *flag = f->g->limits.flags.cells[block];
    f->w->flagged[cell] = flag[at] > 0;
}

/* The flags that it raises are for the next time. */
static void watched_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                         double a, double dt) {
    struct watch *w = (struct watch *)(uintptr_t)g->engine;
    watch_places(g, flag_visit, &(struct flags){w, g});
    w->inner->stage.redo(g, U0, from, to, a, dt);
    book_stage(w, g, U0, from, to, a, dt);
}

static long watched_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                        double weight) {
    struct watch *w = (struct watch *)(uintptr_t)g->engine;
    w->ends++;
    return w->inner->diffusion.end(g, what, Y0, to, dt, weight);
}

bool watch_by_steps(const struct gas *g) {
    return g->dense || (g->models.stepper->local && g->falling.cells);
}

status watch_start(struct watch *w, struct gas *g) {
    *w = (struct watch){.engine = *g->engine, .inner = g->engine};
    TRY(allocate(&w->before, (long)MAX_VAR * cells_of_mesh(g), sizeof *w->before, "the watch"));
    TRY(allocate(&w->falls, 2L * cells_of_mesh(g), sizeof *w->falls, "the watch"));
    w->flagged = w->falls + cells_of_mesh(g);
    tally(w, g);
    memcpy(w->budget.start, w->budget.now, sizeof w->budget.now);
    if (watch_by_steps(g)) return OK;
    w->engine.stage.stage = watched_stage;
    w->engine.stage.redo = watched_redo;
    w->engine.stage.ends = false; /* stages.c then leaves the sources by themselves; the bits are the same */
    w->engine.state.rows = watched_rows;
    w->engine.diffusion.end = watched_end;
    g->engine = &w->engine;
    return OK;
}

/* The gas may have been heated before its bed was lifted. A rank of several knows the energy of its own cells only. */
static bool lifts_much(struct watch *w, const struct gas *g, double lift, double before) {
    const double most = fmax(before, (double)w->budget.magnitude[2] - lift);
    if (comm_size(g->comm) > 1 || !(lift > most)) return false;
    snprintf(w->why, sizeof w->why, "a bed was lifted by %.3g, all other energy was %.3g", lift, most);
    return true;
}

bool watch_step_finish(struct watch *w, struct gas *g) {
    if (watch_by_steps(g)) w->bad = 0;
    look_on(w, g, &g->U);
    if (w->bad) return false;
    w->source = fmax(w->source, w->trial);
    for (int v = 0; v < g->nvar; v++) {
        w->budget.gain[v] += w->budget.gained[0][v] + w->budget.gained[1][v];
        for (int i = 0; i < g->models.stepper->stages; i++) w->budget.gain[v] += w->budget.weighed[i][v];
        w->budget.gained[0][v] = w->budget.gained[1][v] = 0;
    }
    const double lift = g->counts.now.lift - w->lift, before = (double)w->budget.magnitude[2];
    tally(w, g);
    w->lift = g->counts.now.lift;
    w->ends = 0;
    return !lifts_much(w, g, lift, before);
}

void watch_free(struct watch *w) {
    free(w->before);
    free(w->falls);
}
