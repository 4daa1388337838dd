/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hard disks or spheres as a medium (medium.h) of granularMD. Its state are grains that move by events
 * (libcore/grains/grains.h); the fields it writes are means over them. */
#include "solvers/grains/grains_medium.h"

#include "solvers/gas/scales.h"
#include "solvers/grains/grains_averages.h"
#include "solvers/grains/grains_box.h"
#include "solvers/grains/grains_forces.h"
#include "solvers/grains/grains_inlets.h"
#include "solvers/grains/grains_start.h"
#include "solvers/grains/grains_state.h"
#include "solvers/grains/grains_table.h"
#include "solvers/output/clouds.h"
#include "solvers/output/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
enum { STEP_EVENTS = 1 << 17 }; /* take about a tenth of a second: so soon a signal is heard */

struct grains_run {
    struct medium base;
    struct pool pool;
    struct grains_models *models;
    struct grains_start start;
    struct grains_state saved; /* n = 0: the start has none; freed once the grains hold it */
    struct grains_mesh *mesh;  /* NULL: equal cells fill a box */
    struct grain_box box;
    struct grain_law law;
    struct grains *grains;
    struct grains_inlets *inlets; /* NULL: no grains come in */
    struct averages *averages;
    struct grains_forces *forces; /* NULL: no one asks for them */
    struct grain_start placed;    /* how the grains were placed; its lists are freed */
    bool kept;                    /* do the averages go on from the saved state? */
    bool changed;                 /* have box or law changed since the saved state? */
    double energy;                /* J: kinetic, potential and lost when counting began */
    int *place;                   /* [ncells] index in the lattice of each polyMesh cell */
    struct grains_fields fields;
    double *value[MAX_QUANTITIES][3], valued[MAX_QUANTITIES]; /* [cells] of fields, and the time they are of */
    double spent;                                             /* s of the clock spent in steps of this run */
    struct grains_table table;                                /* its start is that of this run */
    struct grain_counts last;                                 /* counts at the last log entry */
    double last_spent;
    bool collapsed; /* was the collapse warned of? */
};
static struct grains_run *of(const struct medium *m) {
    return (struct grains_run *)(uintptr_t)m;
}

static const enum field_id file_of[] = {FIELD_RHO, FIELD_ALPHA, FIELD_U, FIELD_T, FIELD_P, FIELD_T};

static status medium_check_control(const struct medium *m, const struct control *c) {
    (void)m;
    if (!c->write_processors) return OK;
    return dict_fail(c->dict, "writeProcessors", "granularMD runs on one rank and writes no processorN; leave it out");
}

static status medium_read(struct setup *s) {
    struct grains_run *x;
    TRY(allocate(&x, 1, sizeof *x, "the grains"));
    x->base = (struct medium){.type = &grains_medium, .setup = s};
    s->medium = &x->base;
    if (comm_size(s->comm) > 1)
        return fail(
            ERR_INPUT,
            "granularMD runs on one rank, not on %d: leave out -np or mpirun; -ensemble %d runs as many members "
            "side by side",
            comm_size(s->comm), comm_size(s->comm));
    TRY(grains_models_read(s->dir, s->mesh, s->dim, s->axis, s->control, false, &x->models));
    x->base.fields = grains_fields_offer(&x->fields, x->models);
    grains_files(s, x->models);
    return OK;
}

static struct grain_law law_of(const struct grains_models *m) {
    const double *g = m->forces.source.gravity;
    return (struct grain_law){.diameter = m->grain.diameter,
                              .mass = m->grain.mass,
                              .restitution = m->grain.restitution,
                              .threshold = m->grain.threshold,
                              .gravity = {g[0], g[1], g[2]},
                              .kinds = m->kinds};
}

status grains_check_shape(struct setup *s, const struct grains_models *m) {
    const char *name;
    TRY(dict_word_or(m->granular, "equationOfState", "", &name));
    const struct eos *eos = eos_find(name);
    if (!eos || !eos->bounded || eos->disks == (s->dim == 2)) return OK;
    return warn(
        &s->warnings, WARN_SHAPE,
        "%s:%d: equationOfState %s is of %s, and on %d solved axes grains are %s: alpha and the flow mean another "
        "thing than in the gas",
        dict_path(m->granular), dict_line(m->granular, "equationOfState"), name, eos->disks ? "disks" : "spheres",
        s->dim, s->dim == 2 ? "disks" : "spheres");
}

/* Warns of grains and forces that are hardly meant (solvers/gas/scales.h). */
static status check_scales(struct setup *s, const struct grains_run *x) {
    const struct grains_models *m = x->models;
    struct material grain = m->grain;
    grain.disks = s->dim == 2;
    TRY(scales_grain(s, m->granular, &grain));
    TRY(scales_forces(s, &m->forces, &grain));
    double T = 0, square = 0;
    if (!x->start.T) return OK; /* the grains' own state was read in its place */
    for (int c = 0; c < s->mesh->ncells; c++) {
        double own = 0;
        for (int k = 0; k < s->dim; k++) own += x->start.u[k][c] * x->start.u[k][c];
        T = fmax(T, x->start.T[c]);
        square = fmax(square, own);
    }
    return scales_threshold(s, m->granular, &grain, T, fmax(sqrt(square), scales_fall(s, &m->forces.source)));
}

static status medium_state(struct setup *s) {
    struct grains_run *x = of(s->medium);
    char path[2 * TIME_PATH];
    TRY(grains_box_check(s));
    TRY(grains_check_shape(s, x->models));
    snprintf(path, sizeof path, "%s/%s/uniform/grains", s->dir, s->start.folder);
    const bool saved = field_exists(path);
    TRY(grains_start_read(s, x->models, saved, &x->start));
    for (int i = 0; i < FIELD_COUNT; i++) TRY(warn_field(&s->warnings, x->start.field[i], time_is_original(&s->start)));
    TRY(grains_start_walls(s, &x->start, x->models));
    bool fed;
    const bool open = grains_box_open(s, x->start.field[FIELD_U], x->models->open);
    TRY(grains_inlets_find(s, &x->start, x->models, &fed));
    if (open || fed || !grains_box_is_full(s, x->models))
        TRY(grains_mesh_make(s, x->models->grain.diameter, x->models->open, &x->mesh));
    TRY(grains_start_take(s, x->models, x->mesh, saved, &x->start));
    TRY(grains_box_make(s, x->models, x->start.field[FIELD_U], x->mesh, &x->box));
    TRY(grains_start_check(s, x->models, &x->start));
    TRY(check_scales(s, x));
    if (saved) TRY(grains_state_read(path, &x->saved));
    x->law = law_of(x->models);
    return setup_grid(s, x->mesh != NULL, 1, false);
}

/* Returns the sum of column k over the walls in a block of rows of grains_impulses: 1 of grains that left, 2 of those
 * that came. */
static double sum_of_walls(const struct grains_run *x, int block, int k) {
    const int walls = x->box.facets && x->box.facets->opens ? x->box.facets->space.walls : 0;
    double sum = 0;
    for (int w = 0; w < walls; w++) sum += grains_impulses(x->grains)[block * walls + w][k];
    return sum;
}

/* Returns the energy (J) of the grains that have left, less that of those that came. */
static double gone_energy(const struct grains_run *x) {
    double sum = 0;
    for (int k = 1; k < 3; k++) sum += sum_of_walls(x, 1, k) - (x->box.fed ? sum_of_walls(x, 2, k) : 0);
    return sum;
}

static double energy_now(const struct grains_run *x) {
    double kinetic, potential, momentum[3];
    grains_energy(x->grains, &kinetic, &potential, momentum);
    return kinetic + potential + grains_counted(x->grains)->lost - grains_work(x->grains) + gone_energy(x);
}

/* Fails if a saved state belongs to other walls, or to another shear rate; else gives it those of the case. */
static status fit_saved(struct grains_run *x) {
    struct grains_state *s = &x->saved;
    const struct setup *of = x->base.setup;
    double walls[3];
    grains_state_walls(&x->box, walls);
    if ((walls[2] == -1 || s->walls[2] == -1) && walls[1] != s->walls[1])
        return fail(
            ERR_INPUT,
            "%s/%s/uniform/grains: the shearRate was %g and is %g now: the images would jump; a run goes on with "
            "the same",
            of->dir, of->start.name, s->walls[2] == -1 ? s->walls[1] : 0, x->box.shear);
    if (walls[0] != s->walls[0] || walls[1] != s->walls[1])
        return fail(ERR_INPUT,
                    "%s/%s/uniform/grains: the walls of the mesh have changed since; remove it to start from "
                    "lagrangian/grains or the fields",
                    of->dir, of->start.name);
    s->box.facets = x->box.facets;
    s->box.shear = x->box.shear;
    s->box.fed = x->box.fed;
    s->box.wall_restitution = x->box.wall_restitution;
    s->box.rough = x->box.rough;
    s->box.seed = x->box.seed;
    return OK;
}

static status resume(struct grains_run *x) {
    const struct grains_state *s = &x->saved;
    struct grains *old = NULL;
    TRY(fit_saved(x));
    grains_models_count(x->models, s->n);
    if (x->models->kinds.n == s->law.kinds.n) /* grains keep their kinds */
        memcpy(x->models->kinds.first, s->law.kinds.first, sizeof s->law.kinds.first);
    x->law.kinds = x->models->kinds;
    const struct grain_save save = {s->n,
                                    s->t,
                                    s->grain,
                                    s->event,
                                    s->id,
                                    &s->counts,
                                    (const double(*)[3])s->impulse,
                                    s->law.kinds.n ? s->kind : NULL};
    TRY(status_note(grains_resume(&s->box, &s->law, &save, &old), "%s/%s/uniform/grains", x->base.setup->dir,
                    x->base.setup->start.name));
    x->changed = !grains_state_same(s, &x->box, &x->law);
    x->energy = s->energy;
    if (!x->changed) {
        x->grains = old;
        return OK;
    }
    const status e = grain_start_anew(&x->box, &x->law, old, s->law.kinds.n, &x->grains);
    x->models->kinds = x->law.kinds;
    grains_free(old);
    TRY(e);
    x->energy = energy_now(x);
    return OK;
}

static status place(struct grains_run *x) {
    const struct setup *s = x->base.setup;
    struct grain_start *p = &x->placed;
    status e = grain_start_make(s, x->models, &x->box, &x->start, p);
    x->law.kinds = x->models->kinds;
    if (!e && !p->from_cloud && x->box.shear != 0 && s->start.t != 0)
        e = dict_fail(x->models->properties, "shearRate",
                      "grains of a sheared box are put in place at time 0, not at %s", s->start.name);
    if (!e) {
        e = grains_make(&x->box, &x->law, p->n, (const double(*)[3])p->x, (const double(*)[3])p->u, s->start.t,
                        &x->grains);
        e = p->from_cloud ? status_note(e, "%s/%s/lagrangian/grains/positions", s->dir, s->start.folder)
                          : status_note(e, "%s", s->mesh_path);
    }
    free(p->x);
    free(p->u);
    free(p->spin);
    p->x = p->u = p->spin = NULL;
    TRY(e);
    x->energy = energy_now(x);
    return OK;
}

static status make_averages(struct grains_run *x) {
    const struct grains_models *m = x->models;
    const struct coarse_grid grid = grains_grid(x->base.setup, x->models, x->mesh);
    const bool goes_on = x->saved.n && !x->changed;
    return status_note(averages_resume(&grid, m->window, m->samples, x->base.setup->start.t, grains_number(x->grains),
                                       goes_on ? &x->saved.averages : NULL, &x->averages, &x->kept),
                       "%s: coarseGraining", m->properties ? dict_path(m->properties) : "constant/particleProperties");
}

static status make_values(struct grains_run *x) {
    const struct setup *s = x->base.setup;
    const long cells = s->mesh->ncells;
    TRY(pool_take(&x->pool, &x->place, cells, sizeof *x->place, "cells"));
    for (int i = 0; i < cells; i++) x->place[x->mesh ? i : s->lattice->cell[i]] = i;
    for (int f = 0; f < x->base.fields.noffered; f++) {
        x->valued[f] = NAN;
        for (int k = 0; k < grains_components(s, f); k++)
            TRY(pool_take(&x->pool, &x->value[f][k], cells, sizeof(double), "fields"));
    }
    return OK;
}

/* Makes the inlets, and room for the first grains that come in. */
static status make_inlets(struct grains_run *x) {
    const struct grains_inflow *saved = x->saved.n && x->saved.fed && !x->changed ? &x->saved.inflow : NULL;
    if (!x->box.fed) return OK;
    if (!saved) {
        const int n = grains_number(x->grains);
        TRY(grains_grow(&x->grains, n + n / 4 + 64));
    }
    return grains_inlets_make(x->base.setup, x->models, &x->start, &x->box, x->base.setup->start.t, saved, &x->inlets);
}

static status medium_start(struct medium *m) {
    struct grains_run *x = of(m);
    TRY(x->saved.n ? resume(x) : place(x));
    TRY(make_inlets(x));
    TRY(make_averages(x));
    TRY(make_values(x));
    x->placed.n = x->saved.n ? 0 : x->placed.n;
    grains_state_free(&x->saved);
    grains_start_drop(&x->start);
    x->table.start = grains_totals(x->grains, &x->box, x->law.mass);
    x->last = x->table.start.counts;
    x->table.kinds = x->law.kinds.n;
    x->table.kind_name = x->models->kind_name;
    if (x->table.start.impulse) { /* the start's own: the grains' go on */
        double rows[3];
        grains_state_walls(&x->box, rows);
        const long walls = (long)rows[0];
        double(*impulse)[3];
        TRY(pool_take(&x->pool, &impulse, walls, sizeof *impulse, "walls"));
        memcpy(impulse, x->table.start.impulse, (size_t)walls * sizeof *impulse);
        x->table.start.impulse = (const double(*)[3])impulse;
    }
    return OK;
}

static void medium_free(struct medium *m) {
    struct grains_run *x = of(m);
    grains_table_close(&x->table);
    grains_free(x->grains);
    averages_free(x->averages);
    grains_inlets_free(x->inlets);
    grains_forces_free(x->forces);
    grains_state_free(&x->saved);
    grains_start_free(&x->start);
    grains_models_free(x->models);
    grains_mesh_free(x->mesh);
    pool_free(&x->pool);
    free(x);
}

static void medium_describe(const struct medium *m, FILE *f) {
    const struct grains_run *x = of(m);
    const struct grain_start *p = &x->placed;
    const double d = x->law.diameter;
    const int n = x->inlets ? grains_present(x->grains) : grains_number(x->grains);
    grains_models_print(f, x->models);
    grains_box_print(f, m->setup, x->models, &x->box);
    fprintf(f, "Grains\n    %d %s, packing fraction %.6g\n", n, x->box.dim == 2 ? "disks" : "spheres",
            n * grains_mean_size(&x->law.kinds, x->box.dim) * (x->box.dim == 2 ? PI / 4 * d * d : PI / 6 * d * d * d) /
                grains_volume(&x->box));
    if (!p->n)
        fprintf(f, "    as time %s has them%s\n", m->setup->start.name,
                x->changed ? "; box, gravity or grains have changed, so counts and averages begin anew"
                : x->kept  ? ", to the bit"
                           : ", to the bit; cells, kernel or windows have changed, so averages begin anew");
    else if (p->from_cloud)
        fprintf(f, "    from lagrangian/grains of time %s\n", m->setup->start.name);
    else if (p->packing.added < 1)
        fprintf(f, "    put in place at %.3g of their diameter and grown by %lld impacts (%.2g s)\n", p->packing.added,
                (long long)p->packing.impacts, p->packing.seconds);
    else
        fprintf(f, "    put in place at random\n");
}

static void medium_provenance(const struct medium *m, struct sink *o) {
    const struct grains_run *x = of(m);
    sink_printf(o, "grains          %d;\nkernel          %s;\nwindow          %.17g;\n", grains_number(x->grains),
                grains_kernel_name(x->models), x->models->window);
}

static double medium_memory(const struct medium *m) {
    const struct grains_run *x = of(m);
    const int n = grains_number(x->grains);
    long sums;
    (void)averages_sums(x->averages, 0, &sums);
    return grains_bytes(n, x->box.dim) + 48. * n + 16. * (double)sums;
}

static void medium_plan(struct medium *m, const struct control *c, struct pace *out) {
    (void)m;
    (void)c;
    *out = (struct pace){.stable = HUGE_VAL, .limit = "nothing", .early = "events"};
}

/* Lets a grain come in; room is made for more of them where that was needed. */
static status take_inflow(struct grains_run *x) {
    const int had = grains_number(x->grains);
    TRY(grains_inlets_take(x->inlets, &x->grains));
    return grains_number(x->grains) > had ? averages_room(x->averages, grains_number(x->grains)) : OK;
}

/* Advances one piece: to `until`, or to the time at which the averages or a grain that comes in are due before. *there:
 * is it `until`? */
static status advance_piece(struct grains_run *x, double until, int64_t *left, double *reached, bool *there) {
    /* below the slack two times are the same, computed in two ways */
    const double due = averages_next(x->averages), slack = 1e-12 * fabs(until);
    const double inflow = x->inlets ? grains_inlets_next(x->inlets) : HUGE_VAL;
    const double wanted = due < until - slack ? due : until, target = fmin(inflow, wanted);
    const int64_t before = grains_counted(x->grains)->events;
    struct grain_observer *observer = averages_observer(x->averages);
    if (x->forces) observer = grains_forces_observer(x->forces, observer);
    *reached = grains_advance(x->grains, target, *left, observer);
    *left -= grains_counted(x->grains)->events - before;
    *there = false;
    if (*reached < target) return OK;
    if (target < wanted) {
        --*left;
        return take_inflow(x);
    }
    if (due <= target + slack) averages_take(x->averages, x->grains);
    *there = target == until;
    return OK;
}

static status medium_step(struct medium *m, const struct control *c, double t, double *dt) {
    struct grains_run *x = of(m);
    const double clock = clock_now();
    /* without anything to end at, a step of grains that never meet would last for ever */
    const double until = isfinite(*dt) ? m->end : t + (x->models->window > 0 ? x->models->window : 1);
    int64_t left = STEP_EVENTS;
    double reached = t;
    bool there = false;
    (void)c;
    if (x->forces) grains_forces_begin(x->forces);
    while (!there && left > 0) TRY(advance_piece(x, until, &left, &reached, &there));
    x->spent += clock_now() - clock;
    if (x->forces) grains_forces_end(x->forces, reached - t);
    if (there && until == m->end) return OK;
    *dt = reached - t;
    if (t + *dt > t) return OK;
    return fail(ERR_STATE,
                "inelastic collapse at t = %.17g: %d events without time going on; let slow impacts be elastic with "
                "grain { thresholdSpeed } of constant/granularProperties (now %g), some hundredths of sqrt(T) or of "
                "sqrt(g diameter)",
                t, STEP_EVENTS, x->law.threshold);
}

static status medium_after(struct medium *m, const struct moment *now) {
    struct grains_run *x = of(m);
    const struct grains_totals p = grains_totals(x->grains, &x->box, x->law.mass);
    (void)now;
    return grains_table_row(&x->table, m->setup, &x->box, &p);
}

/* Returns the number of impacts since the last log entry; *slow is the part of them that was too slow to be inelastic.
 */
static double new_impacts(const struct grains_run *x, const struct grain_counts *now, double *slow) {
    const struct grain_counts *was = &x->last;
    const double impacts = (double)(now->pairs + now->walls - was->pairs - was->walls);
    *slow = (double)(now->elastic - was->elastic) / impacts;
    return impacts;
}

/* Prints rates since the last log entry. */
static void print_rates(FILE *f, const struct grains_run *x, const struct grain_counts *now) {
    const struct grain_counts *was = &x->last;
    const double spent = x->spent - x->last_spent;
    double slow;
    const double impacts = new_impacts(x, now, &slow);
    if (now->elastic > was->elastic && x->law.threshold > 0)
        fprintf(f, "  below thresholdSpeed %.2g %% (in all %lld)", 100 * slow, (long long)now->elastic);
    if (spent > 0)
        fprintf(f, "  %.3g collisions/s, %.3g events/s", impacts / spent, (double)(now->events - was->events) / spent);
    fprintf(f, "\n");
}

/* Warns of inelastic collapse, once. */
static status check_collapse(struct grains_run *x, const struct grain_counts *now) {
    double slow;
    (void)new_impacts(x, now, &slow);
    if (x->collapsed || x->law.threshold > 0 || !(slow > 0.01)) return OK;
    x->collapsed = true;
    return warn(&x->base.setup->warnings, WARN_COLLAPSE,
                "%s:%d: %.2g %% of the impacts are too slow to tell from rest: inelastic collapse. Time hardly goes "
                "on; give grain { thresholdSpeed }, some hundredths of sqrt(T), or of sqrt(g diameter)",
                dict_path(x->models->granular), dict_line(x->models->granular, "grain"), 100 * slow);
}

/* Returns kinetic, potential and lost energy less what they were when counting began, relative to the latter. */
static double imbalance(const struct grains_run *x, const struct grains_totals *p) {
    const double all = p->kinetic + p->potential + p->counts.lost - grains_work(x->grains) + gone_energy(x);
    return (all - x->energy) / fmax(fabs(x->energy), p->kinetic + p->counts.lost);
}

static void fill_row(const struct grains_run *x, const struct grains_totals *p, struct log_row *row) {
    static const char *const names[] = {"momentum_x", "momentum_y", "momentum_z"};
    const struct grain_counts *n = &p->counts;
    double momentum[3] = {0};
    for (int k = 0; k < x->box.dim; k++) momentum[x->base.setup->axis[k]] = p->momentum[k];
    log_column(row, "T", p->T);
    log_column(row, "kinetic", p->kinetic);
    log_column(row, "potential", p->potential);
    log_column(row, "lost", n->lost);
    log_column(row, "energyChange", imbalance(x, p));
    log_column(row, "collisions", (double)n->pairs);
    log_column(row, "wallCollisions", (double)n->walls);
    log_column(row, "elastic", (double)n->elastic);
    log_column(row, "events", (double)n->events);
    for (int k = 0; k < 3; k++) log_column(row, names[k], momentum[k]);
}

static status medium_log(struct medium *m, FILE *f, struct log_row *row) {
    struct grains_run *x = of(m);
    const struct grains_totals p = grains_totals(x->grains, &x->box, x->law.mass);
    const struct grain_counts *n = &p.counts;
    fill_row(x, &p, row);
    if (!f) return OK;
    if (x->inlets)
        fprintf(f, "    %d grains are there; %.0f have come in, %.0f have left, %lld found no room to come in\n",
                grains_present(x->grains), sum_of_walls(x, 2, 0), sum_of_walls(x, 1, 0),
                (long long)grains_inlets_state(x->inlets)->blocked);
    else if (x->box.facets && x->box.facets->opens)
        fprintf(f, "    %d of %d grains are there\n", grains_present(x->grains), grains_number(x->grains));
    fprintf(f, "    T %.6g  collisions %lld (%.4g per grain)  with walls %lld", p.T, (long long)n->pairs,
            2 * (double)n->pairs / grains_number(x->grains), (long long)n->walls);
    print_rates(f, x, n);
    fprintf(f, "    energy: kinetic %.10g  potential %.10g  lost %.10g", p.kinetic, p.potential, n->lost);
    if (x->models->forces.source.amplitude == 0) /* shaken walls do work, so that nothing balances */
        fprintf(f, " (balance %+.2e)", imbalance(x, &p));
    for (int k = 0; k < x->box.dim; k++)
        if (x->box.periodic[k]) fprintf(f, "  momentum %c %.6g", "xyz"[m->setup->axis[k]], p.momentum[k]);
    fprintf(f, "\n");
    const status e = check_collapse(x, n);
    x->last = *n;
    x->last_spent = x->spent;
    return e;
}

static status medium_finish(struct medium *m, FILE *f) {
    const struct grains_run *x = of(m);
    const struct grain_counts *n = grains_counted(x->grains), *was = &x->table.start.counts;
    const double collisions = (double)(n->pairs + n->walls - was->pairs - was->walls);
    if (x->spent > 0)
        fprintf(f, "%.0f collisions and %lld events in %.2f s: %.3g million collisions per second\n", collisions,
                (long long)(n->events - was->events), x->spent, 1e-6 * collisions / x->spent);
    return OK;
}

static double *const *values_now(struct grains_run *x, int quantity) {
    const double t = grains_time(x->grains);
    if (x->valued[quantity] != t) averages_value(x->averages, x->grains, quantity, x->value[quantity]);
    x->valued[quantity] = t;
    return x->value[quantity];
}

static void medium_block(const struct medium *m, int block, int quantity, double *const out[3]) {
    const struct grid_block *b = &m->setup->grid->block[block];
    double *const *value = values_now(of(m), quantity);
    for (int k = 0; k < grains_components(m->setup, quantity); k++)
        for (int i = 0; i < b->ncells; i++) out[k][i] = value[k][of(m)->place[b->cell[i]]];
}

const struct patch_field *grains_patch(const struct grains_start *start, int quantity, int patch) {
    const struct field *f = quantity < GRAINS_QUANTITIES ? start->field[file_of[quantity]] : NULL;
    return f && strcmp(f->patch[patch].type, "calculated") != 0 ? &f->patch[patch] : NULL;
}

static const struct patch_field *medium_patch(const struct medium *m, int quantity, int patch) {
    return grains_patch(&of(m)->start, quantity, patch);
}

/* Leaves out the grains that have left; then the others have numbers. */
static status keep_present(const struct grains_run *x, struct cloud *c) {
    int n = 0;
    if (!x->box.facets || !x->box.facets->opens) return OK;
    TRY(allocate(&c->id, c->n, sizeof *c->id, "grains"));
    for (int i = 0; i < c->n; i++) {
        if (isnan(c->x[i][0])) continue;
        memcpy(c->x[n], c->x[i], sizeof c->x[n]);
        memcpy(c->u[n], c->u[i], sizeof c->u[n]);
        if (c->size) c->size[n] = c->size[i];
        if (c->species) c->species[n] = c->species[i];
        c->id[n++] = i;
    }
    c->n = n;
    return OK;
}

static status medium_cloud(const struct medium *m, struct cloud *out) {
    const struct grains_run *x = of(m);
    const struct setup *s = m->setup;
    *out = (struct cloud){.n = 0};
    if (!x->models->write_cloud) return OK;
    TRY(cloud_make(grains_number(x->grains), out));
    out->diameter = x->law.diameter;
    if (x->law.kinds.n) TRY(allocate(&out->size, out->n, sizeof *out->size, "diameters of grains"));
    if (x->law.kinds.n) TRY(allocate(&out->species, out->n, sizeof *out->species, "kinds of grains"));
    for (int i = 0; i < out->n && out->size; i++) {
        const int number = grains_ids(x->grains)[i], k = grains_kind_of(x->grains, i);
        out->size[number] = x->law.kinds.size[k];
        out->species[number] = k;
    }
    grains_at(x->grains, grains_time(x->grains), out->x, out->u);
    TRY(keep_present(x, out));
    for (int i = 0; i < out->n; i++) {
        double at[3], u[3] = {0, 0, 0};
        out->cell[i] = (int)grains_box_cell(s, x->mesh, out->x[i]);
        grains_box_place(s, out->x[i], at);
        for (int k = 0; k < s->dim; k++) u[s->axis[k]] = out->u[i][k];
        memcpy(out->x[i], at, sizeof at);
        memcpy(out->u[i], u, sizeof u);
    }
    return OK;
}

/* Saves the exact state; the struct that is written borrows the engine's lists. */
static status medium_save(const struct medium *m, const char *folder, const char *location, struct checksums *sums) {
    const struct grains_run *x = of(m);
    const struct grains *g = x->grains;
    char path[2 * TIME_PATH], where[TIME_NAME + 16];
    struct grains_state s = {.box = x->box,
                             .law = x->law,
                             .n = grains_number(g),
                             .t = grains_time(g),
                             .energy = x->energy,
                             .counts = *grains_counted(g),
                             .grain = (struct grain *)(uintptr_t)grains_all(g),
                             .event = (struct grain_event *)(uintptr_t)grains_events(g),
                             .id = (int32_t *)(uintptr_t)grains_ids(g),
                             .kind = (uint8_t *)(uintptr_t)grains_kinds(g),
                             .impulse = (double(*)[3])(uintptr_t)grains_impulses(g)};
    struct file_sum sum;
    grains_state_walls(&x->box, s.walls);
    averages_save(x->averages, &s.averages);
    s.fed = x->inlets != NULL;
    if (s.fed) s.inflow = *grains_inlets_state(x->inlets);
    snprintf(path, sizeof path, "%s/uniform/grains", folder);
    snprintf(where, sizeof where, "%s/uniform", location);
    TRY(grains_state_write(&s, path, where, m->setup->control->format.compress, &sum));
    return checksums_add(sums, "uniform/grains", sum);
}

static status medium_follow(struct medium *m, double *dt) {
    struct grains_run *x = of(m);
    if (!x->forces) TRY(grains_forces_make(m->setup, x->mesh, &x->box, &x->forces));
    *dt = grains_forces_step(x->forces);
    return OK;
}

/* The first block has the faces of all: there is one rank. */
static void medium_crossings(const struct medium *m, int block, crossing_visitor *visit, void *context) {
    if (block == 0) grains_forces_visit(of(m)->forces, visit, context);
}

static const struct medium_help help = {
    .about =
        "Moves hard disks (two solved axes) or spheres (three) by exact events on the case in DIR (default: here): "
        "smooth\n"
        "inelastic impacts, gravity, walls of any shape, inlets, shaking. The case is one of granularGas, with\n"
        "application granularMD;  in system/controlDict: grains are put where alpha says and move as U and T say;\n"
        "fields rho alpha U T p TComponents (T along each axis) are written as means over grains and impacts,\n"
        "the grains themselves as lagrangian/grains.\n"
        "constant/particleProperties, which may be missing, holds what belongs to grains alone.\n",
    .usage = "[-ensemble N [-np P]]",
    .own = "  -ensemble    runs N members with the seeds 1 .. N, P of them at once, in DIR/ensemble; DIR gets the "
           "means over\n"
           "               all members, and their standard errors as alphaError, UError .. (haff ensemble)\n",
    .end = "A run takes one rank. Signals, stopAt, the lock and the exit codes are those of granularGas.\n",
};

const struct medium_type grains_medium = {
    .application = "granularMD",
    .help = &help,
    .list_models = grains_models_list,
    .list_boundaries = grains_boundaries_list,
    .keywords = grains_models_keywords,
    .fields = {grains_quantity, GRAINS_QUANTITIES, grains_written, grains_written},
    .event_driven = true,
    .whole = true,
    .seeds = true,
    .read = medium_read,
    .state = medium_state,
    .start = medium_start,
    .free = medium_free,
    .check_control = medium_check_control,
    .describe = medium_describe,
    .provenance = medium_provenance,
    .memory = medium_memory,
    .plan = medium_plan,
    .step = medium_step,
    .after = medium_after,
    .log = medium_log,
    .finish = medium_finish,
    .block = medium_block,
    .patch = medium_patch,
    .follow = medium_follow,
    .crossings = medium_crossings,
    .cloud = medium_cloud,
    .save = medium_save,
};
