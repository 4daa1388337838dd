/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bidisperse mixture as a medium (medium.h) of granularSegregation: phi, the concentration of the small grains, on a
 * line of cells or, carried by a flow U, on a lattice. Of a lattice each rank has a slab; a line, which is too small to
 * share, is computed by every rank. */
#include "solvers/output/report.h"
#include "solvers/output/totals.h"
#include "solvers/segregation/segregation_box.h"
#include "solvers/segregation/segregation_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PHI, U, PERCOLATION, DIFFUSIVITY, QUANTITIES };

struct mixture {
    struct medium base;
    struct segregation_models *models;
    struct field *field;
    struct pool pool;
    struct segregation_flow flow;
    struct segregation_setup line; /* used with one solved axis */
    struct segregation *solver;
    struct segregation_places places; /* these four are used with more */
    struct segregation_box box;
    struct segregation_field *carried;
    /* [lines][cells of this rank's blocks] of each quantity that derive has made ready on a lattice; NULL: none yet */
    double *ready[QUANTITIES];
    double *phi;                      /* [cells] along the line, or of the slab */
    struct first_total first;         /* content at the start of the case */
    double rate;                      /* 1/s: Courant number / dt */
    long steps;                       /* since the start of the case */
    struct segregation_counts counts; /* their values at the last log entry */
};
static struct mixture *of(const struct medium *m) {
    return (struct mixture *)(uintptr_t)m;
}

static const struct quantity quantities[] = {
    [PHI] = {"phi", 1, {0, 0, 0, 0, 0, 0, 0}, true},
    [U] = {"U", 3, {0, 1, -1, 0, 0, 0, 0}, true},
    [PERCOLATION] = {"percolation", 1, {0, 1, -1, 0, 0, 0, 0}, false},
    [DIFFUSIVITY] = {"diffusivity", 1, {0, 2, -1, 0, 0, 0, 0}, false},
};
static const int written[] = {PHI, U, -1}, shown[] = {PHI, -1};

static status mixture_read(struct setup *s) {
    struct mixture *x;
    TRY(allocate(&x, 1, sizeof *x, "the mixture"));
    x->base = (struct medium){.type = &segregation_medium, .setup = s};
    s->medium = &x->base;
    TRY(segregation_models_read(s->dir, &x->models));
    s->file[s->nfiles++] = (struct setup_file){"system", "fvSchemes", x->models->schemes};
    s->file[s->nfiles++] = (struct setup_file){"system", "fvSolution", x->models->solution};
    s->file[s->nfiles++] = (struct setup_file){"constant", "segregationProperties", x->models->properties};
    s->file[s->nfiles++] = (struct setup_file){"constant", "g", x->models->g};
    return OK;
}

static bool on_line(const struct mixture *x) {
    return x->base.setup->dim == 1;
}
/* Checks phi in the cells that this rank has read. */
static status check_phi(const struct mixture *x, const struct field_place *place) {
    const bool free_of_bounds = x->models->scheme.unbounded && x->base.setup->start.step > 0;
    for (long i = 0; i < field_ncells(place) && !free_of_bounds; i++)
        if (!(x->field->values[i] >= 0 && x->field->values[i] <= 1))
            return field_fail(x->field, place, i, "it must lie between 0 and 1");
    return OK;
}

static status read_phi(struct setup *s, struct mixture *x) {
    char path[2 * TIME_PATH];
    const struct field_place line = {s->mesh, x->line.centre, s->start.t, NULL, NULL},
                             lattice = {s->mesh, s->centre, s->start.t, &x->places.share, NULL},
                             *place = on_line(x) ? &line : &lattice;
    snprintf(path, sizeof path, "%s/%s/phi", s->dir, s->start.folder);
    TRY(field_agree(place, field_read(path, &segregation_phi, place, &x->field)));
    TRY(warn_field(&s->warnings, x->field, time_is_original(&s->start)));
    TRY(field_agree(place, check_phi(x, place)));
    for (int p = 0; on_line(x) && p < s->mesh->npatches; p++) {
        const struct patch_field *q = &x->field->patch[p];
        if (strcmp(q->type, "noFlux") && strcmp(q->type, "empty"))
            return fail(ERR_INPUT, "%s:%d: patch %s: a line of cells ends in walls: noFlux", dict_path(x->field->dict),
                        q->line, s->mesh->patch[p].name);
    }
    return OK;
}

/* Checks phi on patches with a value. */
static status check_patches(const struct setup *s, const struct field *f) {
    for (int p = 0; p < s->mesh->npatches; p++) {
        const struct patch_field *q = &f->patch[p];
        if (strcmp(q->type, "fixedValue")) continue;
        for (int i = 0; i < (q->values ? s->mesh->patch[p].nfaces : 1); i++) {
            const double v = q->values ? q->values[i] : q->uniform[0];
            if (!(v >= 0 && v <= 1))
                return fail(ERR_INPUT, "%s:%d: patch %s: value of phi is %g; it must lie between 0 and 1",
                            dict_path(f->dict), q->value_line, s->mesh->patch[p].name, v);
        }
    }
    return OK;
}

static status line_state(struct setup *s, struct mixture *x) {
    TRY(setup_complete(s));
    TRY(segregation_setup_make(&x->pool, s, x->models, &x->line));
    TRY(segregation_flow_read(s, x->models, NULL, &x->flow));
    TRY(segregation_setup_laws(s, &x->flow, &x->line));
    TRY(read_phi(s, x));
    TRY(setup_grid(s, false, 1, false));
    return setup_complete(s); /* the grid drops what a lattice does without */
}

static status lattice_state(struct setup *s, struct mixture *x) {
    TRY(segregation_box_check(s, x->models));
    TRY(segregation_places_make(s, &x->places));
    TRY(read_phi(s, x));
    TRY(check_patches(s, x->field));
    TRY(segregation_flow_read(s, x->models, &x->places, &x->flow));
    TRY(segregation_box_make(&x->pool, s, x->models, &x->places, x->field, &x->flow, &x->box));
    return setup_grid(s, false, 1, false);
}

static status mixture_state(struct setup *s) {
    struct mixture *x = of(s->medium);
    return on_line(x) ? line_state(s, x) : lattice_state(s, x);
}

/* Sums what the cells of a lattice hold in the order of their numbers, one rank after the other, in pieces of 1000,
 * which keeps the digits of many equal cells. */
static status lattice_content(const struct mixture *x, double *out) {
    const struct setup *s = x->base.setup;
    const struct segregation_places *p = &x->places;
    const double *density = x->flow.density ? x->flow.density + p->own_first : NULL;
    double *own = NULL, *slice = NULL, sums[2] = {0, 0}; /* of this piece, of those before */
    status e = allocate(&own, p->nown, sizeof *own, "the content of cells");
    if (!e) e = allocate(&slice, p->share.end - p->share.first, sizeof *slice, "the content of cells");
    e = comm_agree(s->comm, e);
    for (long i = 0; i < p->nown && !e; i++)
        own[i] = (density ? density[i] * lattice_volume(s->lattice) : lattice_volume(s->lattice)) * x->phi[i];
    if (!e) e = segregation_places_store(p, 1, own, slice);
    if (!e) comm_take_turn(s->comm, sums, 2);
    for (long i = p->share.first; i < p->share.end && !e; i++) {
        sums[0] += slice[i - p->share.first];
        if (i % 1000 != 999) continue;
        sums[1] += sums[0];
        sums[0] = 0;
    }
    if (!e) comm_end_turn(s->comm, sums, 2);
    free(own);
    free(slice);
    *out = sums[1] + sums[0];
    return e;
}
static status content(const struct mixture *x, double *out) {
    if (!on_line(x)) return lattice_content(x, out);
    *out = segregation_mass(x->solver, x->phi);
    return OK;
}

static status start_line(struct mixture *x) {
    const struct segregation_line *l = &x->line.line;
    TRY(pool_take(&x->pool, &x->phi, l->n, sizeof(double), "phi"));
    TRY(segregation_make(l, &x->models->scheme, &x->solver));
    for (int i = 0; i < l->n; i++) x->phi[x->line.place[i]] = x->field->values[i];
    for (int i = 0; i < l->n; i++) x->rate = fmax(x->rate, fabs(l->speed[i]) / (l->face[i + 1] - l->face[i]));
    return OK;
}

static status start_lattice(struct mixture *x) {
    const struct segregation_places *p = &x->places;
    double *all;
    TRY(segregation_field_make(&x->box.lattice, &x->carried));
    TRY(segregation_places_fetch(p, 1, x->field->values, &all));
    status e = pool_take(&x->pool, &x->phi, p->nown, sizeof(double), "phi");
    if (!e) memcpy(x->phi, all + p->own_first, (size_t)p->nown * sizeof *all);
    free(all);
    x->rate = segregation_field_rate(x->carried);
    return comm_agree(p->share.comm, e);
}

static status mixture_start(struct medium *m) {
    struct mixture *x = of(m);
    const struct setup *s = m->setup;
    TRY(on_line(x) ? start_line(x) : start_lattice(x));
    field_drop_cells(x->field);
    x->first = (struct first_total){.name = "small"};
    TRY(content(x, &x->first.value));
    x->steps = s->start.step;
    if (s->control->adjust) m->next = s->start.delta_t;
    return totals_resume(s, &x->first, 1);
}

static void mixture_free(struct medium *m) {
    struct mixture *x = of(m);
    segregation_free(x->solver);
    segregation_field_free(x->carried);
    segregation_places_free(&x->places);
    segregation_flow_free(&x->flow);
    segregation_models_free(x->models);
    field_free(x->field);
    pool_free(&x->pool);
    free(x);
}

static void mixture_describe(const struct medium *m, FILE *f) {
    const struct mixture *x = of(m);
    const struct face_flow_change *c = &x->box.change;
    const struct setup *s = m->setup;
    const int ranks = comm_size(s->comm);
    segregation_models_print(f, x->models);
    if (ranks > 1 && on_line(x)) fprintf(f, "    %-22s each computes the whole line\n", "ranks");
    if (ranks > 1 && !on_line(x))
        fprintf(f, "    %-22s each has a slab of %d to %d layers along %c\n", "ranks",
                s->lattice->n[s->dim - 1] / ranks, x->places.layers, "xyz"[s->axis[s->dim - 1]]);
    if (x->box.flows)
        fprintf(f, "    %-22s divergence %.3g %s, made %.3g by changes of %.3g %s at most; outflow times %.6g\n",
                x->flow.density ? "mass flow rho U" : "velocity U", c->before, x->flow.density ? "kg/m^3/s" : "1/s",
                c->after, c->largest, x->flow.density ? "kg/m^2/s" : "m/s", c->scaled);
}

static void mixture_provenance(const struct medium *m, struct sink *o) {
    const struct segregation_models *models = of(m)->models;
    sink_printf(o, "closure         %s;\niteration       %s;\n", segregation_closure_name(models),
                segregation_iteration_name(models));
}

static double mixture_memory(const struct medium *m) {
    const struct mixture *x = of(m);
    return 40. * 8 * m->setup->mesh->ncells * (on_line(x) ? comm_size(m->setup->comm) : 1);
}

/* Plans a step: without one to go on from, a Courant number of 1, which the error estimate then corrects. */
static void mixture_plan(struct medium *m, const struct control *c, struct pace *out) {
    const struct mixture *x = of(m);
    const double first = x->rate > 0 ? 1 / x->rate : 1;
    *out = (struct pace){.stable = m->next > 0 ? m->next : first, .rate = x->rate, .limit = "timeTolerance"};
    if (!c->adjust) out->stable = HUGE_VAL; /* the scheme is implicit */
}

static status advance(struct mixture *x, const struct control *c, double *dt, double *next) {
    const double allowed = x->models->time_tolerance;
    const bool damped = x->steps < x->models->damped;
    if (on_line(x))
        return c->adjust ? segregation_advance(x->solver, allowed, dt, next, x->phi)
                         : segregation_step(x->solver, *dt, damped, x->phi);
    return c->adjust ? segregation_field_advance(x->carried, allowed, dt, next, x->phi)
                     : segregation_field_step(x->carried, *dt, damped, x->phi);
}

static status mixture_step(struct medium *m, const struct control *c, double t, double *dt) {
    struct mixture *x = of(m);
    double next = 0;
    status e = advance(x, c, dt, &next);
    if (e) return status_note(e, "at t = %.10g", t);
    m->next = next;
    x->steps++;
    return OK;
}

/* Returns the counts of the solver. On a lattice a step is one sweep along each axis, without iteration. */
static struct segregation_counts counts_of(const struct mixture *x) {
    if (on_line(x)) return segregation_counts(x->solver);
    const struct segregation_lattice_counts n = segregation_field_counts(x->carried);
    return (struct segregation_counts){n.steps, n.steps, n.bounded, 0, n.corrected, n.rejected};
}

static void fill_row(const struct segregation_counts *n, double low, double high, double mass, double change,
                     struct log_row *row) {
    *row = (struct log_row){
        8,
        {"phiMin", "phiMax", "small", "smallChange", "solves", "iterations", "boundedFaces", "rejectedSteps"},
        {low, high, mass, change, (double)n->steps, (double)n->iterations, (double)n->corrected, (double)n->rejected}};
}

static status mixture_log(struct medium *m, FILE *f, struct log_row *row) {
    struct mixture *x = of(m);
    const struct segregation_counts n = counts_of(x), was = x->counts;
    const int *cell = on_line(x) ? x->line.cell : x->places.cell + x->places.own_first;
    double mass, low = 1, high = 0;
    TRY(content(x, &mass));
    for (long i = 0; i < (on_line(x) ? x->line.line.n : x->places.nown); i++)
        if (cell[i] >= 0) {
            low = fmin(low, x->phi[i]);
            high = fmax(high, x->phi[i]);
        }
    comm_min(m->setup->comm, &low, 1);
    comm_max(m->setup->comm, &high, 1);
    fill_row(&n, low, high, mass, relative_change(mass, x->first.value), row);
    if (!f) return OK;
    x->counts = n;
    if (!comm_root(m->setup->comm)) return OK;
    fprintf(f, "    phi %.6g .. %.6g  small grains %.10g (%s %+.2e)  iterations %ld in %ld solves\n", low, high, mass,
            x->box.through ? "change" : "drift", relative_change(mass, x->first.value), n.iterations - was.iterations,
            n.steps - was.steps);
    if (n.corrected > was.corrected)
        fprintf(f, "    bounded: %ld faces of %ld solves (in all %ld)\n", n.corrected - was.corrected,
                n.bounded - was.bounded, n.corrected);
    if (n.rejected > was.rejected)
        fprintf(f, "    rejected: %ld steps (in all %ld)\n", n.rejected - was.rejected, n.rejected);
    return OK;
}

static status mixture_finish(struct medium *m, FILE *f) {
    const struct segregation_counts n = counts_of(of(m));
    if (comm_root(m->setup->comm) && n.steps)
        fprintf(f, "%ld solves, %.3g iterations each; %ld with bounds; %ld steps rejected\n", n.steps,
                (double)n.iterations / (double)n.steps, n.bounded, n.rejected);
    return OK;
}

/* Returns a component of a quantity in cell `at` of the line. */
static double value_on_line(const struct mixture *x, int quantity, int cell, int component) {
    const struct setup *s = x->base.setup;
    const int i = x->line.place[cell];
    if (quantity == PHI) return x->phi[i];
    if (quantity == U) return x->flow.U ? x->flow.U[3L * cell + s->axis[component]] : 0;
    if (quantity == PERCOLATION) return x->line.speed[i];
    return segregation_diffusivity(x->models, s->centre + 3L * cell, x->phi[i],
                                   x->flow.shear_rate ? x->flow.shear_rate[cell] : 0);
}
/* Returns a component of a quantity in a place of the slab. */
static double value_in_slab(const struct mixture *x, int quantity, long i, int component) {
    const struct segregation_models *m = x->models;
    const struct segregation_flow *flow = &x->flow;
    const long place = x->places.own_first + i;
    double at[3];
    if (quantity == PHI) return x->phi[i];
    if (quantity == U) return flow->U ? flow->U[3 * place + x->base.setup->axis[component]] : 0;
    if (quantity == PERCOLATION && flow->percolation) return flow->percolation[place];
    segregation_places_centre(&x->places, place, at);
    if (quantity == PERCOLATION)
        return m->velocity_law ? expr_value(m->velocity_law, at[0], at[1], at[2], 0) : m->velocity;
    return segregation_diffusivity(m, at, x->phi[i], flow->shear_rate ? flow->shear_rate[place] : 0);
}
static int lines_of(const struct medium *m, int quantity) {
    return quantity == U ? m->setup->dim : 1;
}

/* Brings a component of a quantity from the slabs to the cells of this rank's blocks. `own` and `slice` are room. */
static status bring(const struct mixture *x, int quantity, int component, double *own, double *slice, double *out) {
    const struct segregation_places *p = &x->places;
    long n;
    const int *cell = grid_cells(x->base.setup->grid, &n);
    for (long i = 0; i < p->nown; i++)
        own[i] = p->cell[p->own_first + i] < 0 ? 0 : value_in_slab(x, quantity, i, component);
    TRY(segregation_places_store(p, 1, own, slice));
    return share_fetch(&p->share, 1, slice, n, cell, out);
}

static status mixture_derive(struct medium *m, int quantity) {
    struct mixture *x = of(m);
    const struct segregation_places *p = &x->places;
    double *own = NULL, *slice = NULL;
    long n;
    if (on_line(x)) return OK;
    (void)grid_cells(m->setup->grid, &n);
    status e = allocate(&own, p->nown, sizeof *own, "a field of a slab");
    if (!e) e = allocate(&slice, p->share.end - p->share.first, sizeof *slice, "a slice of a field");
    if (!e && !x->ready[quantity])
        e = pool_take(&x->pool, &x->ready[quantity], n * lines_of(m, quantity), sizeof *own,
                      "a field of this rank's blocks");
    e = comm_agree(m->setup->comm, e);
    for (int k = 0; k < lines_of(m, quantity) && !e; k++)
        e = bring(x, quantity, k, own, slice, x->ready[quantity] + k * n);
    free(own);
    free(slice);
    return e;
}

static void mixture_block(const struct medium *m, int block, int quantity, double *const out[3]) {
    const struct mixture *x = of(m);
    const struct grid_block *b = &m->setup->grid->block[block];
    long n;
    const int *cells = grid_cells(m->setup->grid, &n);
    for (int k = 0; k < lines_of(m, quantity); k++)
        if (on_line(x))
            for (int i = 0; i < b->ncells; i++) out[k][i] = value_on_line(x, quantity, b->cell[i], k);
        else
            memcpy(out[k], x->ready[quantity] + k * n + (b->cell - cells), (size_t)b->ncells * sizeof *out[k]);
}

static bool mixture_present(const struct medium *m, int quantity) {
    return quantity != U || (of(m)->flow.U && !on_line(of(m)));
}

static const struct patch_field *mixture_patch(const struct medium *m, int quantity, int patch) {
    const struct field *f = quantity == PHI ? of(m)->field : quantity == U ? of(m)->flow.given : NULL;
    return f ? &f->patch[patch] : NULL;
}

static status mixture_save(const struct medium *m, const char *folder, const char *location, struct checksums *sums) {
    return totals_save(&of(m)->first, 1, folder, location, sums);
}

static const struct medium_help help = {
    .about = "Solves the segregation of small from large grains on the case in DIR (default: here):\n\n"
             "    phi_t + div (U phi + f phi (1 - phi) d - D grad phi) = 0, without flux through walls,\n\n"
             "on a line of cells by the implicit scheme of Christov (2018); on a lattice factored by axes, cyclic axes "
             "among\n"
             "them, and carried by a flow U: of the start folder, or of a time of a granularGas case\n"
             "(velocity { case ..; time ..; }), with its density as weight if asked for.\n"
             "Second order in time and space, conservative and bounded.\n",
    .usage = "[-np N]",
    .own = "  -np N        on N ranks, with the same results: each has a slab of a lattice; every rank computes a line "
           "whole\n",
    .end = "Signals, stopAt, the lock and the exit codes are those of granularGas.\n",
};

const struct medium_type segregation_medium = {
    .application = "granularSegregation",
    .help = &help,
    .list_models = segregation_models_list,
    .list_boundaries = segregation_boundaries_list,
    .keywords = segregation_models_keywords,
    .fields = {quantities, QUANTITIES, written, shown},
    .slabs = true,
    .read = mixture_read,
    .state = mixture_state,
    .start = mixture_start,
    .free = mixture_free,
    .describe = mixture_describe,
    .provenance = mixture_provenance,
    .memory = mixture_memory,
    .plan = mixture_plan,
    .step = mixture_step,
    .log = mixture_log,
    .finish = mixture_finish,
    .derive = mixture_derive,
    .block = mixture_block,
    .present = mixture_present,
    .patch = mixture_patch,
    .save = mixture_save,
};
