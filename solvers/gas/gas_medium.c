/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The granular gas as the medium (medium.h) of granularGas. */
#include "solvers/gas/initial.h"
#include "solvers/gas/limiter.h"
#include "solvers/gas/models.h"
#include "solvers/gas/quantities.h"
#include "solvers/gas/scales.h"
#include "solvers/gas/uniform.h"
#include "solvers/output/report.h"
#include "solvers/output/totals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The part of a period of shaking that a step may last. Steps know the mean of g(t): in their frame the floor is where
 * it should be but for (2 pi STROKE)^2/12 = 0.13 % of its amplitude. */
static const double STROKE = 0.02;
/* Dense flow is slow below this inertial number (docs/physics.md 4.8; GDR MiDi, Eur. Phys. J. E 14, 341, 2004: there
 * the friction of lasting contacts rules); the log says so after SLOW_STEPS steps of it. */
static const double SLOWEST = 1e-2;
enum { SLOW_STEPS = 1000 };

struct gas_state {
    struct medium base;
    struct case_models *models;
    struct initial *initial;
    struct gas *gas;
    struct gas_view view; /* what function objects see */
    struct gas_fields fields;
    struct limiter_table limiter;
    struct friction_files friction;
    struct gas_speed speed;      /* wave speeds of the last plan */
    double fall;                 /* s: the longest step that gravity allows; HUGE_VAL: any */
    struct first_total first[2]; /* mass and energy at the start of the case */
    struct gas_counts counts;    /* counts at the last log entry */
    bool audited;                /* is a budget kept? */
    bool damps;                  /* was it said that implicit acoustics damps, or would damp, waves? */
    long slow;                   /* steps in a row in which dense gas was slow; -1: it was said */
    long refused;                /* of limiter_note_beds */
    bool unknown;                /* is the start gone that would say what is at rest? */
};
static struct gas_state *of(const struct medium *m) {
    return (struct gas_state *)(uintptr_t)m;
}

static status gas_check_control(const struct medium *m, const struct control *c) {
    const struct stepper *stepper = of(m)->models->gas.stepper;
    if (c->max_co <= stepper->courant) return OK;
    return dict_fail(c->dict, "maxCo", "timeScheme %s allows %g at most", stepper->model.name, stepper->courant);
}

static status gas_read(struct setup *s) {
    struct gas_state *g;
    TRY(allocate(&g, 1, sizeof *g, "the gas"));
    g->base = (struct medium){.type = &gas_medium, .setup = s};
    s->medium = &g->base;
    TRY(models_read(s->dir, s->dim, s->axis, &g->models));
    if (s->mesh->round.on) TRY(models_round(s, g->models));
    const struct case_models *m = g->models;
    g->base.fields = gas_fields_offer(&g->fields, &m->gas);
    const struct setup_file files[] = {{"system", "fvSchemes", m->schemes},
                                       {"system", "fvSolution", m->solution},
                                       {"constant", "granularProperties", m->properties},
                                       {"constant", "g", m->forces.g},
                                       {"constant", "shaking", m->forces.shaking}};
    memcpy(s->file, files, sizeof files);
    s->nfiles = 5;
    return OK;
}

/* Reads the state to start from, which says the components of the velocity. */
static status read_initial(struct setup *s, struct gas_state *g, const struct field_place *place) {
    struct case_models *m = g->models;
    bool moved[3];
    models_move(m, moved);
    TRY(initial_read(s->dir, &s->start, place, s->dim, s->axis, moved, &m->gas, &g->initial));
    m->gas.components = s->components = g->initial->components;
    memcpy(s->axis, g->initial->axis, sizeof s->axis);
    models_turn(m, s->components, s->axis);
    for (int k = s->dim; k < s->components && s->mesh->round.on; k++)
        if (s->axis[k] != s->mesh->round.axial) m->gas.swirl = k;
    if (m->gas.swirl) TRY(models_swirl(s, m));
    if (m->gas.material.disks && s->components == 3)
        return dict_fail(
            m->properties, "equationOfState",
            "%s is for disks, which move in a plane, but U, a wall or a source in the case leads along %c, "
            "out of it: take that component away, or choose spheres",
            m->gas.eos->model.name, "xyz"[s->axis[2]]);
    return OK;
}

/* Warns of a reconstruction that is given for the other kind of mesh. */
static status check_scheme(struct setup *s, const struct gas_state *g) {
    const char *const names[2] = {"reconstruct", "polyReconstruct"};
    const struct dict *d = g->models->schemes;
    const bool polyhedral = s->grid->polyhedra != NULL;
    const bool given = dict_has(d, names[polyhedral]); /* with meshEngine, both are there to choose between the two */
    if (!dict_has(d, names[!polyhedral]) || (given && g->models->engine)) return OK;
    return warn(&s->warnings, WARN_SCHEME,
                "%s:%d: %s is not used: it is for %s, and this run is on %s, where %s counts (now %s%s", dict_path(d),
                dict_line(d, names[!polyhedral]), names[!polyhedral], polyhedral ? "lattices" : "polyhedra",
                polyhedral ? "polyhedra" : "a lattice", names[polyhedral],
                polyhedral ? g->models->gas.polynomial->model.name : g->models->gas.reconstruct->model.name,
                given ? "); remove it" : ", the default); give that, too");
}

static status gas_read_state(struct setup *s) {
    struct gas_state *g = of(s->medium);
    const struct gas_models *models = &g->models->gas;
    if (g->models->engine && g->models->engine->polyhedral) TRY(setup_complete(s));
    TRY(scales_longest_fall(s, g->models, &g->fall));
    const struct share slices = share_make(s->comm, s->mesh->ncells);
    const bool sliced = s->spread || (s->lattice && !(g->models->engine && g->models->engine->polyhedral));
    const struct field_place place = {s->mesh, s->centre, s->start.t, sliced ? &slices : NULL, s->spread};
    TRY(read_initial(s, g, &place));
    for (int i = 0; i < FIELD_COUNT; i++)
        TRY(warn_field(&s->warnings, g->initial->field[i], time_is_original(&s->start)));
    for (int i = 0; i < g->initial->carried.n; i++)
        TRY(warn_field(&s->warnings, g->initial->carried.field[i], time_is_original(&s->start)));
    TRY(initial_warn(g->initial, models->transport != NULL, &s->warnings));
    TRY(scales_grain(s, g->models->properties, &models->material));
    TRY(scales_forces(s, &g->models->forces, &models->material));
    if (g->models->engine && !g->models->engine->polyhedral && !s->lattice)
        return dict_fail(g->models->schemes, "meshEngine",
                         "the mesh is no lattice of equal boxes: %s; leave the key out or say  meshEngine polyhedral;",
                         s->why);
    /* the sums of implicit diffusion go over all unknowns, so that there the bits would depend on their number */
    const bool implicit = models->transport && !models->diffusion->plan;
    if (s->lattice && g->models->skip_axes && !implicit) TRY(uniform_find(s->mesh, g->initial, s->lattice));
    if (s->lattice) s->lattice->even = models->transport && !implicit;
    TRY(setup_grid(s, g->models->engine && g->models->engine->polyhedral, models->polynomial->rings,
                   models->stepper->local));
    TRY(check_scheme(s, g));
    TRY(models_local(s, g->models));
    if (s->grid->polyhedra && transport_terms(models->transport, &models->transport_params).diagonal)
        return dict_fail(g->models->properties, "transport",
                         "stress diagonal is for lattices: on other meshes it would depend on how faces lie; say  "
                         "stress full;");
    if (s->grid->polyhedra && models->polynomial->degree > 1)
        TRY(field_agree(&place, initial_average(g->initial, &place, s->dim, models)));
    initial_drop_fields(g->initial);
    return OK;
}

static status gas_start(struct medium *m) {
    struct gas_state *g = of(m);
    struct setup *s = m->setup;
    const struct gas_models *models = &g->models->gas;
    const struct initial *i = g->initial;
    setup_settle(s);
    if (s->start.step == 0) TRY(scales_check(s, models, i));
    g->limiter.fills = models->alpha_floor > 0;
    TRY(s->grid->forest ? gas_make(s->grid->forest, models, s->mesh->npatches, i->rules, &g->gas)
                        : gas_make_polyhedral(s->grid, models, s->mesh->npatches, i->rules, &g->gas));
    g->view = (struct gas_view){.setup = s, .models = models, .gas = g->gas};
    gas_heed(g->gas, m->asked);
    if (i->varies) gas_vary(g->gas, initial_renew, g->initial);
    TRY(rest_lay(s, models, g->gas, &g->unknown));
    TRY(comm_agree(s->comm, initial_set(g->initial, s->grid, g->gas)));
    TRY(comm_agree(s->comm, limiter_resume(&g->limiter, s, g->gas)));
    TRY(comm_agree(s->comm, friction_resume(&g->friction, s, g->gas)));
    g->counts = gas_counts(g->gas);
    TRY(comm_agree(s->comm, gas_check(g->gas)));
    initial_drop_cells(g->initial);
    double totals[MAX_VAR];
    TRY(gas_totals(g->gas, totals));
    g->first[0] = (struct first_total){"mass", totals[0]};
    g->first[1] = (struct first_total){"energy", totals[1 + s->components]};
    setup_release(s);
    return totals_resume(s, g->first, 2);
}

static void gas_medium_free(struct medium *m) {
    struct gas_state *g = of(m);
    limiter_close(&g->limiter);
    friction_files_free(&g->friction);
    gas_view_free(&g->view);
    gas_free(g->gas);
    initial_free(g->initial);
    models_free(g->models);
    free(g);
}

/* Names the patches whose values follow a rule. */
static void describe_patches(FILE *f, const struct polymesh *m, const struct initial *s) {
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; i < 3; i++) {
            const struct varying *v = initial_varying(s, p, i);
            if (!v || !(varying_in_time(v) || varying_in_space(v))) continue;
            const bool both = varying_in_time(v) && varying_in_space(v);
            fprintf(f, "    %-22s %s changes%s%s%s (%s)\n", m->patch[p].name, s->field[s->from[p][i]]->kind->name,
                    varying_in_time(v) ? " in time" : "", both ? " and" : "",
                    varying_in_space(v) ? " from face to face" : "", varying_key(v));
        }
}

static void gas_describe(const struct medium *m, FILE *f) {
    const struct setup *s = m->setup;
    models_print(f, of(m)->models, s->grid->polyhedra != NULL);
    describe_patches(f, s->mesh, of(m)->initial);
    const struct revolution *r = &s->mesh->round;
    if (r->on)
        fprintf(f, "    %-22s along %c at %c = %g: sums and forces are those of a full turn%s\n", "axis",
                "xyz"[r->axial], "xyz"[r->radial], r -> at,
                of(m) -> models -> gas.swirl ? "; acoustics are explicit beside swirl" : "");
    for (int k = s->dim; k < s->components; k++)
        fprintf(f, "    %-22s along %c, too, an axis without cells\n", "velocity", "xyz"[s->axis[k]]);
    if (of(m)->unknown)
        fprintf(f,
                "    the start is gone: if it was a settledLayer, gas rests to the error of the scheme only (keep its "
                "time folder)\n");
    if (of(m)->friction.lost)
        fprintf(f, "    friction starts without stress: time %s has no %s\n", s->start.name, of(m)->friction.name[0]);
}

static void gas_provenance(const struct medium *m, struct sink *o) {
    const struct gas_models *g = &of(m)->models->gas;
    bool polyhedral = m->setup->grid->polyhedra != NULL;
    sink_printf(o, "equationOfState %s;\nfluxScheme      %s;\ntimeScheme      %s;\n", g->eos->model.name,
                g->flux->model.name, g->stepper->model.name);
    if (g->transport)
        sink_printf(o, "transport       %s;\ndiffusion       %s;\n", g->transport->model.name,
                    g->diffusion->model.name);
    sink_printf(o, "meshEngine      %s;\n%s %s;\n", polyhedral ? "polyhedral" : "lattice",
                polyhedral ? "polyReconstruct" : "reconstruct    ",
                polyhedral ? g->polynomial->model.name : g->reconstruct->model.name);
}

static double gas_memory(const struct medium *m) {
    return models_memory(m->setup, &of(m)->models->gas);
}

/* Would grains under gravity hold each other by a friction that the case does not have? */
static bool lacks_friction(const struct gas_state *g) {
    return !friction_acts(g->models->gas.friction) && source_falls(&g->models->gas.source, gas_variables(g->gas) - 2);
}

static void plan_step(struct medium *m, const struct control *c, struct pace *out) {
    struct gas_state *g = of(m);
    const double most = c->adjust ? c->max_co : g->models->gas.stepper->courant;
    const double fall = c->adjust ? g->fall : HUGE_VAL; /* stability does not ask for it */
    gas_speed(g->gas, &g->speed);
    *out = (struct pace){.stable = most / g->speed.rate, .rate = g->speed.rate};
    if (fall < out->stable) {
        out->stable = fall;
        out->limit = "free fall";
    }
    const char *limit;
    const double bed = gas_bed_step(g->gas, c->max_co, &g->speed, g->fall, &limit);
    limiter_note_beds(&g->refused, g->gas, comm_root(m->setup->comm));
    if (g->slow >= 0) g->slow = bed > 0 && lacks_friction(g) && gas_inertia(g->gas) < SLOWEST ? g->slow + 1 : 0;
    if (!(bed > 0)) return;
    out->stable = c->adjust ? bed : HUGE_VAL; /* what limits the step of a bed is accuracy */
    out->limit = limit;
}

static void gas_plan(struct medium *m, const struct control *c, struct pace *out) {
    const struct sources *s = &of(m)->models->gas.source;
    plan_step(m, c, out);
    if (!c->adjust || !source_shaken(s) || !(out->stable * s->frequency > STROKE)) return;
    out->stable = STROKE / s->frequency;
    out->limit = "stroke";
}

static double gas_knot(const struct medium *m, double t) {
    return initial_knot(of(m)->initial, t);
}

static void gas_limiting_cell(struct medium *m, char *text, size_t size) {
    (void)limiter_cell(of(m)->gas, &of(m)->speed, text, size);
}

static void gas_bound(struct medium *m, char *text, size_t size) {
    limiter_bound(of(m)->gas, &of(m)->speed, &of(m)->models->gas, text, size);
}

static status gas_medium_step(struct medium *m, const struct control *c, double t, double *dt) {
    struct gas_state *g = of(m);
    gas_view_forget(&g->view);
    const status e = gas_step(g->gas, t, dt, c->max_co, c->min_delta_t, g->models->min_fraction, &g->speed);
    const status late = initial_renew(g->initial, e ? t : t + *dt); /* what is written with the state */
    if (!e) return late;
    status_free(late);
    return e;
}

static status gas_after(struct medium *m, const struct moment *now) {
    TRY(initial_renew(of(m)->initial, now->t)); /* it may miss t + dt by a bit */
    return limiter_record(&of(m)->limiter, m->setup, of(m)->gas, now);
}

/* Returns the word for a change of mass or energy in the log: a conserved quantity drifts; a quantity that flows in or
 * out, or that a source takes, changes. */
static const char *word_for(const struct gas_state *g, bool energy) {
    const bool dilates = transport_terms(g->models->gas.transport, &g->models->gas.transport_params).dilation;
    if (g->models->gas.alpha_floor > 0) return "change";
    for (int p = 0; p < g->base.setup->mesh->npatches; p++) {
        const struct patch_rules *r = &g->initial->rules[p];
        if (!r->velocity.type) continue;
        if (!patch_is_wall(r) || (energy && (wall_works(r) || wall_conducts(r)))) return "change";
    }
    return energy && (source_active(&g->models->gas.source, &g->models->gas.material) || dilates) ? "change" : "drift";
}

static void print_totals(FILE *f, const struct gas_state *g, const double now[MAX_VAR]) {
    int dim = g->base.setup->components;
    const struct first_total *first = g->first;
    fprintf(f, "    mass %.10g (%s %+.2e)  momentum (", now[0], word_for(g, false),
            relative_change(now[0], first[0].value));
    for (int k = 0; k < dim; k++) fprintf(f, "%s%.6g", k ? " " : "", now[1 + k]);
    fprintf(f, ")  energy %.10g (%s %+.2e)\n", now[1 + dim], word_for(g, true),
            relative_change(now[1 + dim], first[1].value));
}

static const char *plural(long n) {
    return n == 1 ? "" : "s";
}

/* Prints what kept the state admissible since the last entry. */
static void print_limited(FILE *f, const struct gas_counts *was, const struct gas_counts *n) {
    const long faces = n->faces - was->faces, cells = n->cells - was->cells, rejected = n->rejected - was->rejected;
    const long floored = n->floored - was->floored, staged = n->staged - was->staged;
    if (cells > 0)
        fprintf(f,
                "    limited: %ld face%s of %ld cell%s, the last at (%.6g %.6g %.6g) (in all %ld faces, %ld cells)\n",
                faces, plural(faces), cells, plural(cells), n->place[0], n->place[1], n->place[2], n->faces, n->cells);
    if (staged > 0)
        fprintf(f, "    by stages: %ld step%s (in all %ld) that local steps would leave inadmissible\n", staged,
                plural(staged), n->staged);
    if (rejected > 0) fprintf(f, "    rejected: %ld step%s (in all %ld)\n", rejected, plural(rejected), n->rejected);
    if (floored > 0)
        fprintf(f, "    round-off floor: %ld cell%s, energy +%.3g (in all %ld, +%.3g)\n", floored, plural(floored),
                n->energy - was->energy, n->floored, n->energy);
    const long filled = n->filled - was->filled;
    if (filled > 0)
        fprintf(f, "    density floor: %ld cell%s, mass +%.3g, energy +%.3g (in all %ld, +%.3g, +%.3g)\n", filled,
                plural(filled), n->fill[0] - was->fill[0], n->fill[1] - was->fill[1], n->filled, n->fill[0],
                n->fill[1]);
}

/* Prints how many cells took the last step at once, how many in halves, and so on. */
static void print_levels(FILE *f, const struct gas_counts *n) {
    int most = GAS_LEVELS - 1;
    while (most >= 0 && n->levels[most] == 0) most--;
    if (most < 0) return; /* no step yet */
    fprintf(f, "    local steps: %ld cells take deltaT", n->levels[0]);
    for (int k = 1; k <= most; k++) fprintf(f, ", %ld deltaT/%d", n->levels[k], 1 << k);
    fprintf(f, "\n");
}

static void print_beds(FILE *f, const struct gas_counts *was, const struct gas_counts *n) {
    const long beds = n->beds - was->beds, newton = n->newton - was->newton;
    if (beds == 0) return;
    fprintf(f, "    implicit acoustics: %ld step%s, %ld cells; %.3g Newton iterations a step, %.3g linear ones each\n",
            beds, plural(beds), n->bed_cells, (double)newton / (double)beds,
            newton > 0 ? (double)(n->linear - was->linear) / (double)newton : 0);
    if (n->lifted > was->lifted)
        fprintf(f, "    lifted: %ld cells, energy +%.3g (in all %ld, +%.3g)\n", n->lifted - was->lifted,
                n->lift - was->lift, n->lifted, n->lift);
}

static void print_diffusion(FILE *f, const struct gas_counts *was, const struct gas_counts *n) {
    const double halves = (double)(n->halves - was->halves);
    const long repeated = n->repeated - was->repeated, plain = n->plain - was->plain;
    if (halves > 0)
        fprintf(f, "    diffusion: a half step in %.4g stages of viscous stress, %.4g of heat conduction\n",
                (double)(n->stages[0] - was->stages[0]) / halves, (double)(n->stages[1] - was->stages[1]) / halves);
    if (repeated > 0)
        fprintf(f,
                "    repeated: %ld half step%s, for %ld cell%s that would have been inadmissible (in all %ld half "
                "steps, %ld cells)\n",
                repeated, plural(repeated), plain, plural(plain), n->repeated, n->plain);
}

struct gas_numbers { /* of a log entry */
    double alpha[2], speed[2], T[2], mach[2], totals[MAX_VAR], computed;
    struct gas_counts counts;
};

static status find_numbers(const struct gas_state *g, struct gas_numbers *x) {
    const struct setup *s = g->base.setup;
    TRY(report_extremes(s, GAS_ALPHA, x->alpha));
    TRY(report_extremes(s, GAS_U, x->speed));
    TRY(report_extremes(s, GAS_T, x->T));
    TRY(report_extremes(s, GAS_MACH, x->mach));
    x->computed = gas_computed_share(g->gas);
    x->counts = gas_counts(g->gas);
    return gas_totals(g->gas, x->totals);
}

static void fill_row(const struct gas_state *g, const struct gas_numbers *x, struct log_row *row) {
    static const char *const ends[4][2] = {
        {"alphaMin", "alphaMax"}, {"magUMin", "magUMax"}, {"TMin", "TMax"}, {"MaMin", "MaMax"}};
    static const char *const momenta[3] = {"momentum_x", "momentum_y", "momentum_z"};
    const double *const range[4] = {x->alpha, x->speed, x->T, x->mach};
    const struct setup *s = g->base.setup;
    const struct gas_counts *n = &x->counts;
    const double energy = x->totals[1 + s->components];
    double momentum[3] = {0};
    for (int k = 0; k < s->components; k++) momentum[s->axis[k]] = x->totals[1 + k];
    for (int i = 0; i < 8; i++) log_column(row, ends[i / 2][i % 2], range[i / 2][i % 2]);
    log_column(row, "mass", x->totals[0]);
    for (int k = 0; k < 3; k++) log_column(row, momenta[k], momentum[k]);
    log_column(row, "energy", energy);
    log_column(row, "massChange", relative_change(x->totals[0], g->first[0].value));
    log_column(row, "energyChange", relative_change(energy, g->first[1].value));
    const struct {
        const char *title;
        long n;
    } counts[] = {{"limitedFaces", n->faces},   {"limitedCells", n->cells},      {"rejectedSteps", n->rejected},
                  {"flooredCells", n->floored}, {"filledCells", n->filled},      {"bedSteps", n->beds},
                  {"bedCells", n->bed_cells},   {"newtonIterations", n->newton}, {"linearIterations", n->linear}};
    for (int i = 0; i < 9; i++) {
        if (i == 5) log_column(row, "computed", x->computed);
        log_column(row, counts[i].title, (double)counts[i].n);
    }
}

static void print_state(FILE *f, const struct gas_state *g, const struct gas_counts *was, const struct gas_numbers *x) {
    const struct gas_counts *n = &x->counts;
    fprintf(f, "    alpha %.6g .. %.6g  T %.6g .. %.6g  Ma %.6g .. %.6g\n", x->alpha[0], x->alpha[1], x->T[0], x->T[1],
            x->mach[0], x->mach[1]);
    print_totals(f, g, x->totals);
    if (g->models->gas.stepper->local) print_levels(f, n);
    print_limited(f, was, n);
    print_diffusion(f, was, n);
    print_beds(f, was, n);
}

static status gas_log(struct medium *m, FILE *f, struct log_row *row) {
    struct gas_state *g = of(m);
    struct gas_numbers numbers;
    TRY(find_numbers(g, &numbers));
    fill_row(g, &numbers, row);
    if (!f) return OK;
    if (comm_root(m->setup->comm)) print_state(f, g, &g->counts, &numbers);
    g->counts = numbers.counts;
    TRY(limiter_note_damped(&g->damps, m->setup, g->models, &g->counts, f));
    if (g->slow >= SLOW_STEPS) {
        g->slow = -1;
        TRY(warn(&m->setup->warnings, WARN_FRICTION,
                 "%s:1: dense gas has been slow for %d steps (inertial number below %g, now %.2g): real grains "
                 "would hold each other by friction there; without  friction { type muI; }  a heap goes flat",
                 dict_path(g->models->properties), SLOW_STEPS, SLOWEST, gas_inertia(g->gas)));
    }
    return OK;
}

static status gas_finish(struct medium *m, FILE *f) {
    double share = gas_computed_share(of(m)->gas);
    const struct gas_counts counts = gas_counts(of(m)->gas);
    TRY(limiter_note_damped(&of(m)->damps, m->setup, of(m)->models, &counts, NULL));
    if (share < 1 && comm_root(m->setup->comm))
        fprintf(f, "%.3g %% of the cell updates were computed; the rest was uniform\n", 100 * share);
    return OK;
}

static const char *gas_lacks(const struct medium *m, int quantity) {
    return gas_view_lacks(&of(m)->models->gas, quantity);
}

static status gas_derive(struct medium *m, int quantity) {
    return gas_view_derive(&of(m)->view, quantity);
}

static void gas_block(const struct medium *m, int block, int quantity, double *const out[3]) {
    gas_view_block(&of(m)->view, block, quantity, out);
}

static void gas_edge_values(const struct medium *m, int quantity, int patch, int n, const struct edge_face *face,
                            double *values) {
    gas_view_edge(&of(m)->view, &of(m)->initial->rules[patch], quantity, patch, n, face, values);
}

static bool gas_gives(const struct medium *m, int quantity, int patch) {
    return gas_rules_give(&of(m)->initial->rules[patch], &of(m)->models->gas, quantity);
}

static bool gas_uniform(const struct medium *m, int block, int quantity, double value[3]) {
    return gas_view_uniform(&of(m)->view, block, quantity, value);
}

static void gas_exact(const struct medium *m, int block, int quantity, double *const out[3]) {
    gas_view_exact(&of(m)->view, block, quantity, out);
}

static bool gas_present(const struct medium *m, int quantity) {
    return quantity != GAS_LIMITED || gas_counts(of(m)->gas).cells > 0;
}

static status gas_save(const struct medium *m, const char *folder, const char *location, struct checksums *sums) {
    TRY(totals_save(of(m)->first, 2, folder, location, sums));
    return limiter_save(of(m)->gas, folder, location, sums);
}

static status gas_keep(const struct medium *m, const struct field_writer *w, struct checksums *sums) {
    return friction_save(&of(m)->friction, m->setup, of(m)->gas, w, sums);
}

static const struct patch_field *gas_patch(const struct medium *m, int quantity, int p) {
    static const enum field_id id[] = {FIELD_RHO, FIELD_ALPHA, FIELD_U, FIELD_T, FIELD_P};
    const struct initial *i = of(m)->initial;
    if (gas_carried(quantity) >= 0) return &i->carried.field[gas_carried(quantity)]->patch[p];
    if (quantity > GAS_P) return NULL;
    for (int k = 0; k < 3; k++)
        if (i->from[p][k] == id[quantity]) return &i->field[id[quantity]]->patch[p];
    return NULL;
}

static const struct medium_help help = {
    .about = "Solves the hydrodynamics of a granular gas on the case in DIR (default: here).\n",
    .usage = "[-np N]",
    .own =
        "  -np N        on N ranks, the same as  mpirun -np N granularGas ...; the results are the same to the bit\n",
    .end = "SIGTERM, SIGINT, SIGHUP, SIGXCPU, SIGUSR1, or stopAt writeNow in system/controlDict: the state is written "
           "and\n"
           "the run ends. One run at a time works on a case (DIR/.haff.lock); checkCase and caseToVTK may read "
           "meanwhile.\n"
           "Exit codes: 0 done or stopped as asked; 1 the case or the command line is wrong, nothing was written; 2 "
           "the gas\n"
           "left the admissible states (e.g. inelastic collapse; the last good state was written); 3 disk, memory or "
           "MPI.\n",
};

static status gas_follow(struct medium *m, double *dt) {
    *dt = gas_tally_step(of(m)->gas);
    return gas_tally(of(m)->gas);
}

struct turning { /* context of turn_face */
    const struct setup *setup;
    crossing_visitor *visit;
    void *context;
};

/* Turns a face's vectors to physical axes. Along axes that are not solved all cells have one place. */
static void turn_face(void *turning, const struct gas_face *face) {
    const struct turning *t = turning;
    const struct setup *s = t->setup;
    struct crossing out = {
        .patch = face->patch, .area = face->area, .mass = face->mass, .energy = face->energy + face->work + face->heat};
    memcpy(out.centre, s->first, sizeof out.centre);
    for (int k = 0; k < s->dim; k++) {
        out.centre[s->axis[k]] = face->centre[k];
        out.normal[s->axis[k]] = face->normal[k];
    }
    for (int k = 0; k < s->components; k++) {
        out.pressure[s->axis[k]] = face->pressure[k];
        out.viscous[s->axis[k]] = face->viscous[k];
    }
    t->visit(t->context, &out);
}

static void gas_crossings(const struct medium *m, int block, crossing_visitor *visit, void *context) {
    gas_tally_faces(of(m)->gas, block, turn_face, &(struct turning){m->setup, visit, context});
}

_Static_assert(12 + SOURCE_MOST + 3 * 7 <= MAX_BUDGET, "the budget has room for every source");
/* Adds energy to the column of a cause, which is made behind the others if there is none. */
static void budget_add(struct budget_row *b, const char *cause, double energy) {
    int i = 0;
    while (i < b->n && strcmp(b->title[i], cause)) i++;
    if (i == b->n) {
        b->title[b->n] = cause;
        b->value[b->n++] = 0;
    }
    b->value[i] += energy;
}

/* The momentum along an axis, by cause, behind the other columns. */
static void budget_momentum(struct budget_row *row, const struct gas_budget *b, int component, int axis) {
    static const char *const titles[3][7] = {{"momentum_x", "momentumGravity_x", "momentumWalls_x", "momentumFlow_x",
                                              "momentumSources_x", "momentumFloors_x", "momentumResidual_x"},
                                             {"momentum_y", "momentumGravity_y", "momentumWalls_y", "momentumFlow_y",
                                              "momentumSources_y", "momentumFloors_y", "momentumResidual_y"},
                                             {"momentum_z", "momentumGravity_z", "momentumWalls_z", "momentumFlow_z",
                                              "momentumSources_z", "momentumFloors_z", "momentumResidual_z"}};
    double weight = 0, others = 0;
    for (int i = 0; i < source_count; i++) *(i == source_gravity_row() ? &weight : &others) += b->pushed[i][component];
    const double values[] = {b->momentum[component],
                             weight,
                             b->through[GAS_WALLS][component],
                             b->through[GAS_OPEN][component],
                             others,
                             b->given[component],
                             b->strayed[component]};
    for (int i = 0; i < 7; i++) {
        row->title[row->n] = titles[axis][i];
        row->value[row->n++] = values[i];
    }
}

static status gas_medium_budget(struct medium *m, struct budget_row *out) {
    struct gas_state *g = of(m);
    struct gas_budget b;
    if (!g->audited) TRY(gas_audit(g->gas));
    g->audited = true;
    TRY(gas_budget(g->gas, &b));
    *out = (struct budget_row){12,
                               {"mass", "massFlow", "massFloor", "massResidual", "energy", "cooling", "gravity", "heat",
                                "wallWork", "flow", "floors", "residual"},
                               {b.mass, b.flowed, b.filled, b.lost[0], b.energy, 0, 0, b.gained[GAS_HEAT],
                                b.gained[GAS_FRICTION], b.gained[GAS_FLOW], b.gained[GAS_FLOORS], b.lost[1]}};
    const struct gas_models *models = &g->models->gas;
    for (int i = 0; i < source_count; i++)
        if (source_row_active(&models->source, &models->material, i))
            budget_add(out, source_table[i].cause, b.sourced[i]);
    if (gas_rubs(models)) budget_add(out, "friction", b.gained[GAS_CONTACTS]);
    budget_add(out, "cooling", b.gained[GAS_DILATION]); /* it is the part of cooling that goes with div u */
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < m->setup->components; k++)
            if (m->setup->axis[k] == axis) budget_momentum(out, &b, k, axis);
    return OK;
}

static int gas_medium_seconds(const struct medium *m, struct part_seconds out[PARTS_TIMED]) {
    return gas_seconds(of(m)->gas, out);
}

const struct medium_type gas_medium = {
    .application = "granularGas",
    .help = &help,
    .list_models = models_list,
    .list_boundaries = boundaries_list,
    .keywords = models_keywords,
    .axial = GAS_VORTICITY,
    .round = true,
    .fields = {gas_quantity, GAS_CARRIED, gas_written, gas_shown},
    .read = gas_read,
    .state = gas_read_state,
    .start = gas_start,
    .free = gas_medium_free,
    .check_control = gas_check_control,
    .describe = gas_describe,
    .provenance = gas_provenance,
    .memory = gas_memory,
    .plan = gas_plan,
    .knot = gas_knot,
    .cell = gas_limiting_cell,
    .bound = gas_bound,
    .step = gas_medium_step,
    .after = gas_after,
    .log = gas_log,
    .seconds = gas_medium_seconds,
    .finish = gas_finish,
    .lacks = gas_lacks,
    .derive = gas_derive,
    .block = gas_block,
    .uniform = gas_uniform,
    .exact = gas_exact,
    .present = gas_present,
    .patch = gas_patch,
    .edge = gas_edge_values,
    .edge_state = gas_edge_state,
    .gives = gas_gives,
    .follow = gas_follow,
    .crossings = gas_crossings,
    .budget = gas_medium_budget,
    .save = gas_save,
    .keep = gas_keep,
};
