/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Does what gas.h promises on any mesh, by the engine of the mesh. */
#include "libcore/gas/gas_private.h"

#include "libcore/schemes/flux_rules.h"

#include <stdlib.h>

/* The lines of blocks that both engines have. */
struct wanted_line {
    double ***line;
    bool wanted;
};
enum { LINES = 11 };
static void list_lines(struct gas *g, struct wanted_line out[LINES]) {
    const bool falls = source_falls(&g->models.source, g->components), diffuses = g->models.transport != NULL;
    const bool sees = needs_shear_rate(&g->models);
    const struct wanted_line all[LINES] = {{&g->limits.flags.cells, true},
                                           {&g->limits.flags.limited, true},
                                           {&g->limits.flags.kept, true},
                                           {&g->limits.flags.mark, diffuses},
                                           {&g->diffusion.warm, diffuses},
                                           {&g->diffusion.friction, diffuses},
                                           {&g->diffusion.cooled, diffuses},
                                           {&g->diffusion.dilation, g->diffusion.terms.dilation},
                                           {&g->falling.cells, falls},
                                           {&g->diffusion.shear_rate.now, sees},
                                           {&g->diffusion.shear_rate.rise, sees && diffuses}};
    memcpy(out, all, sizeof all);
}

status line_make(const struct gas *g, double ***out) {
    TRY(allocate(out, g->blocks.n, sizeof **out, "the gas"));
    for (int b = 0; b < g->blocks.n; b++) TRY(allocate(&(*out)[b], g->size + SLACK, sizeof(double), "the gas"));
    return OK;
}

void line_free(const struct gas *g, double **line) {
    for (int b = 0; line && b < g->blocks.n; b++) free(line[b]);
    free(line);
}

static status make_lines(struct gas *g) {
    struct wanted_line l[LINES];
    list_lines(g, l);
    for (int i = 0; i < LINES; i++)
        if (l[i].wanted) TRY(line_make(g, l[i].line));
    TRY(allocate(&g->limits.flags.blocks, g->blocks.n, sizeof *g->limits.flags.blocks, "the gas"));
    TRY(allocate(&g->blocks.sums, (long)g->nvar * grid_blocks(g), sizeof *g->blocks.sums, "the gas"));
    if (g->falling.cells) TRY(allocate(&g->falling.dropped, g->floors.places, sizeof *g->falling.dropped, "the gas"));
    if (g->falling.cells) TRY(allocate(&g->falling.blocks, g->blocks.n, sizeof *g->falling.blocks, "the gas"));
    return floors_make(g);
}

static void free_lines(struct gas *g) {
    struct wanted_line l[LINES];
    list_lines(g, l);
    for (int i = 0; i < LINES; i++) line_free(g, *l[i].line);
    free(g->limits.flags.blocks);
    free(g->blocks.sums);
    free(g->falling.dropped);
    free(g->falling.blocks);
    free(g->patches.side);
    floors_free(g);
}

const char *gas_local_lacks(const struct gas_models *m, bool polyhedral, bool round, const char **cure) {
    const struct wanted_rules on = rules_of(m->flux, &m->flux_params, false, false);
    const struct {
        bool is;
        const char *what, *cure;
    } hurdle[] = {
        {!polyhedral, "a lattice", "say  meshEngine polyhedral;"},
        {polyhedral && m->polynomial->degree > 1, "a polyReconstruct of quadratics", "say  polyReconstruct linear;"},
        {round, "a body of revolution", NULL},
        {m->flux->paced, "a fluxScheme that depends on the time step", "say  fluxScheme common;"},
        {on.shocks || on.expansions || on.contacts, "rules of single faces but fronts",
         "take them out of commonCoeffs"},
        {gas_may_be_dense(m), "implicit acoustics", "say  acoustics { type explicit; }  in system/fvSolution"},
        {m->ncarried > 0, "carried quantities", NULL},
    };
    for (unsigned i = 0; i < sizeof hurdle / sizeof *hurdle && m->stepper->local; i++)
        if (hurdle[i].is) {
            *cure = hurdle[i].cure;
            return hurdle[i].what;
        }
    return NULL;
}

static status check_local(const struct gas *g) {
    const char *cure,
        *what =
            gas_local_lacks(&g->models, !g->forest,
                            g->forest ? g->forest->radial >= 0 : g->blocks.grid->polyhedra->round.radial >= 0, &cure);
    return what ? fail(ERR_INPUT, "time scheme local is not there for %s", what) : OK;
}

static status make(const struct gas *like, struct gas **out) {
    struct gas *g;
    TRY(allocate(&g, 1, sizeof *g, "the gas"));
    *g = *like;
    if (g->components < g->dim) g->components = g->dim; /* models->components is 0: as many as the mesh has axes */
    g->nvar = g->components + 2;
    g->limits.first_order = reconstruct_find("firstOrder");
    if (g->models.transport || needs_shear_rate(&g->models)) g->models.skip_uniform = false;
    g->diffusion.terms = transport_terms(g->models.transport, &g->models.transport_params);
    g->limits.most = density_limit(g->models.eos, &g->models.material);
    g->limits.crowds = !gas_can_collapse(g);
    for (int p = 0; p < g->patches.n; p++) g->patches.fed |= patch_feeds(&g->patches.rules[p]);
    if (g->models.alpha_floor > 0)
        g->limits.least = g->models.alpha_floor / packing_per_density(&g->models.material) * (1 - ROUND);
    status s = check_local(g);
    if (!s) s = make_lines(g);
    if (!s) s = dense_make(g);
    if (!s) s = g->engine->state.make(g);
    if (!s) s = sides_make(g);
    if (!s && g->models.transport && !g->models.diffusion->plan) s = implicit_make(g, &g->diffusion.implicit);
    if (!s) s = dense_kept(g);
    if (!s) s = carried_make(g);
    if (s)
        gas_free(g);
    else
        *out = g;
    return s;
}

status gas_make(struct forest *f, const struct gas_models *models, int npatches, const struct patch_rules *rules,
                struct gas **out) {
    const struct gas g = {.engine = &engine_lattice,
                          .forest = f,
                          .comm = f->comm,
                          .dim = f->dim,
                          .components = models->components,
                          .counts = {.images = f->images},
                          .size = f->size,
                          .floors = {.places = f->ntiles},
                          .blocks = {.n = f->ntiles, .unit = f->volume, .faces = f->dim * f->size},
                          .models = *models,
                          .patches = {.n = npatches, .rules = rules}};
    return make(&g, out);
}

status gas_make_polyhedral(const struct grid *grid, const struct gas_models *models, int npatches,
                           const struct patch_rules *rules, struct gas **out) {
    const struct gas g = {.engine = &engine_polyhedral,
                          .comm = grid->comm,
                          .dim = grid->dim,
                          .components = models->components,
                          .counts = {.images = 1},
                          .size = grid->polyhedra->size,
                          .floors = {.places = grid->polyhedra->nown, .step = 1},
                          .blocks = {.n = 1,
                                     .grid = grid,
                                     .volume = grid->polyhedra->volume,
                                     .unit = grid->polyhedra->thickness,
                                     .area = grid->polyhedra->face.area,
                                     .faces = grid->polyhedra->face.n + SLACK},
                          .models = *models,
                          .patches = {.n = npatches, .rules = rules}};
    return make(&g, out);
}

void gas_free(struct gas *g) {
    if (!g) return;
    implicit_free(g->diffusion.implicit);
    dense_free(g);
    carried_free(g);
    g->engine->state.free(g);
    books_free(g);
    status_free(g->patches.failed);
    free_lines(g);
    free(g);
}

int gas_variables(const struct gas *g) {
    return g->nvar;
}

/* Forgets what was known of the state before. */
static void forget_state(struct gas *g) {
    g->step.speed_known = false;
    g->step.guarded = 0;
    g->step.slow = -1;
}

void gas_set_conserved(struct gas *g, const double *const U[MAX_VAR]) {
    state_set(g, false, U);
    forget_state(g);
}

void gas_set_own_conserved(struct gas *g, const double *const U[MAX_VAR]) {
    state_set(g, true, U);
    forget_state(g);
}

void gas_resume(struct gas *g, const struct gas_counts *counts, const double *limited) {
    g->counts.before = *counts;
    g->counts.now.energy = counts->energy;
    memcpy(g->counts.now.fill, counts->fill, sizeof counts->fill);
    memcpy(g->counts.now.place, counts->place, sizeof counts->place);
    if (g->dense) {
        g->dense->pause = counts->pause[0];
        g->dense->paused = counts->pause[1];
    }
    if (limited) limited_set(g, limited);
}

/* Sets the state of n cells by `set`, which takes conserved variables. */
static status set_state(struct gas *g, long n, const double *rho, const double *const u[3], const double *T,
                        void (*set)(struct gas *g, const double *const U[MAX_VAR])) {
    double *all, *U[MAX_VAR];
    TRY(allocate(&all, g->nvar * n, sizeof(double), "the initial state"));
    for (int v = 0; v < g->nvar; v++) U[v] = all + v * n;
    for (long i = 0; i < n; i++) {
        double square = 0;
        for (int k = g->components - 1; k >= 0; k--) {
            U[k + 1][i] = rho[i] * u[k][i];
            square += u[k][i] * u[k][i];
        }
        U[0][i] = rho[i];
        U[energy_at(g)][i] = rho[i] * (eps_of(&g->models.material, T[i]) + 0.5 * square);
    }
    set(g, (const double *const *)U);
    free(all);
    return OK;
}

status gas_set(struct gas *g, const double *rho, const double *const u[3], const double *T) {
    return set_state(g, g->forest ? g->forest->ncells_all : g->blocks.grid->ncells_all, rho, u, T, gas_set_conserved);
}

status gas_set_own(struct gas *g, long cells, const double *rho, const double *const u[3], const double *T) {
    return set_state(g, cells, rho, u, T, gas_set_own_conserved);
}

status gas_rest(struct gas *g, const bool *rests) {
    return g->engine->state.rest && g->falling.cells ? g->engine->state.rest(g, rests) : OK;
}

status gas_get_conserved(const struct gas *g, double *const U[MAX_VAR]) {
    return gas_get_variables(g, 0, g->nvar, U);
}

struct first_bad { /* the result of bad_row: the first cell that is not admissible */
    const struct gas *g;
    bool found;
    struct row cell;
};

static void bad_row(void *first_bad, const struct row *row) {
    struct first_bad *b = first_bad;
    const double *U = b->g->U.block[row->block];
    if (b->found || !row_inadmissible(b->g, U, row->at, row->n, NULL)) return;
    for (int i = 0; i < row->n && !b->found; i++) {
        b->cell = (struct row){row->block, row->at + i, 1};
        b->found = row_inadmissible(b->g, U, b->cell.at, 1, NULL);
    }
}

/* What helps against a state that is not admissible. E = rho (eps + u^2/2) has 16 digits. */
static const char *cure_of(const struct gas *g, const double *U, double T) {
    if (!(T > 0) && U[0] > 0 && U[(g->components + 1) * g->size] > 0)
        return "; u^2/2 takes all digits of the energy: lower U, or raise T above 1e-15 u^2";
    return g->limits.least > 0 ? "; the least density is that of alphaFloor in `limits` of system/fvSolution: raise "
                                 "the field, or lower alphaFloor"
                               : "";
}

status gas_check(const struct gas *g) {
    struct first_bad b = {.g = g};
    status s = OK;
    g->engine->state.rows(g, EVERY_CELL, &g->U, bad_row, &b);
    if (b.found) {
        const double *U = g->U.block[b.cell.block] + b.cell.at;
        double T, place[3];
        temperature_row(g, 1, U, &T);
        g->engine->state.place(g, b.cell.block, b.cell.at, place);
        s = fail(ERR_STATE,
                 "inadmissible state at (%.8g %.8g %.8g): rho = %.8g (allowed %.8g .. %.8g), T = %.8g (allowed > 0)%s",
                 place[0], place[1], place[2], U[0], g->limits.least, g->limits.most, T, cure_of(g, U, T));
    }
    return comm_agree(g->comm, s);
}

void gas_heed(struct gas *g, bool (*asked)(void)) {
    g->step.asked = asked;
}

void gas_vary(struct gas *g, status (*renew)(void *context, double t), void *context) {
    g->patches.renew = renew;
    g->patches.renewer = context;
}

void renew_patches(struct gas *g, double t) {
    if (g->patches.renew && !g->patches.failed) g->patches.failed = g->patches.renew(g->patches.renewer, t);
}

bool speed_agree(struct gas *g, const struct gas_speed *mine, bool is_void) {
    double all[] = {is_void,       mine->rate, mine->loose, mine->axis[0], mine->axis[1],
                    mine->axis[2], -mine->low, mine->high,  mine->levels};
    comm_max(g->comm, all, 9);
    g->step.speed = (struct gas_speed){.rate = all[1],
                                       .loose = all[2],
                                       .axis = {all[3], all[4], all[5]},
                                       .low = -all[6],
                                       .high = all[7],
                                       .levels = (int)all[8]};
    g->step.speed_known = all[0] == 0;
    return g->step.speed_known;
}

void gas_speed(struct gas *g, struct gas_speed *speed) {
    if (!g->step.speed_known) {
        struct gas_speed mine;
        g->engine->state.speed(g, &mine);
        (void)speed_agree(g, &mine, false);
    }
    *speed = g->step.speed;
}

struct search { /* of the cells with a value */
    struct gas *g;
    const struct state *s;
    int v;
    double wanted;
    struct first_place first;
};

static void offer_row(struct search *x, const struct row *row, const double *value) {
    double here[3];
    for (int i = 0; i < row->n; i++) {
        if (value[i] != x->wanted) continue;
        x->g->engine->state.place(x->g, row->block, row->at + i, here);
        first_place_offer(&x->first, here);
    }
}

static void seek_value(void *search, const struct row *row) {
    struct search *x = search;
    offer_row(x, row, x->s->block[row->block] + x->v * x->g->size + row->at);
}

static void seek_speed(void *search, const struct row *row) {
    struct search *x = search;
    struct row_speeds s;
    x->g->engine->state.speeds(x->g, x->s, row, &s);
    offer_row(x, row, s.rate);
}

void place_of_value(struct gas *g, const struct state *s, int v, double wanted, double place[3]) {
    struct search x = {g, s, v, wanted, {.order = HUGE_VAL}};
    g->engine->state.rows(g, EVERY_CELL, s, seek_value, &x);
    first_place_agree(g, &x.first, place);
}

void gas_fastest_place(struct gas *g, const struct gas_speed *speed, double place[3]) {
    struct search x = {g, &g->U, 0, ldexp(speed->rate, speed->levels), {.order = HUGE_VAL}};
    g->engine->state.rows(g, EVERY_CELL, &g->U, seek_speed, &x);
    first_place_agree(g, &x.first, place);
}

void first_place_agree(const struct gas *g, const struct first_place *p, double place[3]) {
    double least = p->order;
    comm_min(g->comm, &least, 1);
    for (int k = 0; k < 3; k++) place[k] = p->order == least ? p->place[k] : HUGE_VAL;
    comm_min(g->comm, place, 3);
}

struct gas_counts gas_counts(const struct gas *g) {
    struct gas_counts c = g->counts.now;
    long *const cells[] = {&c.cells, &c.faces, &c.floored, &c.filled, &c.plain};
    for (int i = 0; i < 5; i++) *cells[i] *= g->counts.images;
    const struct gas_counts *b = &g->counts.before;
    const long before[] = {b->cells, b->faces, b->floored, b->filled, b->plain};
    for (int i = 0; i < 5; i++) *cells[i] += before[i];
    c.rejected += b->rejected;
    c.repeated += b->repeated;
    c.pause[0] = g->dense ? g->dense->pause : 0;
    c.pause[1] = g->dense ? g->dense->paused : 0;
    return c;
}

double gas_computed_share(const struct gas *g) {
    long count[2] = {g->counts.computed, g->counts.all};
    comm_sum_long(g->comm, count, 2);
    return count[1] ? (double)count[0] / (double)(count[1] * g->counts.images) : 1;
}
