/* The gas, whatever mesh it is on: what gas.h promises, handed to the engine of the mesh. */
#include "libcore/gas/state.h"

#include "libcore/schemes/limit.h"

#include <stdlib.h>

status floors_make(struct gas *g) {
    TRY(allocate(&g->raised, g->nraised, sizeof(double), "the floors"));
    for (int v = 0; v < 2 && g->least > 0; v++) TRY(allocate(&g->fill[v], g->nraised, sizeof(double), "the floors"));
    return OK;
}

void floors_free(struct gas *g) {
    free(g->raised);
    for (int v = 0; v < 2; v++) free(g->fill[v]);
}

static void fill_cells(struct gas *g, int n, long size, double *U, double *bad, int place, int step) {
    double added[2][BATCH];
    g->filled += raise_density(n, g->dim, size, g->least, g->limit, U, bad, added);
    for (int v = 0; v < 2; v++)
        for (int i = 0; i < n; i++) g->fill[v][place + i * step] += g->share * added[v][i];
}

long floors_apply(struct gas *g, int n, long size, double *U, int place, int step) {
    double bad[BATCH], raised[BATCH];
    long left = 0;
    if (!find_bad(n, g->dim, size, g->least, g->limit, U, bad)) return 0;
    if (g->least > 0) fill_cells(g, n, size, U, bad, place, step);
    g->floored += raise_energy(n, g->dim, size, g->least, g->limit, U, bad, raised);
    for (int i = 0; i < n; i++) {
        g->raised[place + i * step] += raised[i];
        left += bad[i] > 0;
    }
    return left;
}

const char *density_hint(const struct gas *g) {
    return g->least > 0
               ? "; the least density is that of alphaFloor in `limits` of system/fvSolution: raise the field, "
                 "or lower alphaFloor"
               : "";
}

static status make(const struct gas *like, struct gas **out) {
    struct gas *g;
    TRY(allocate(&g, 1, sizeof *g, "the gas"));
    *g = *like;
    g->nvar = g->dim + 2;
    g->first_order = reconstruct_find("firstOrder");
    if (g->models.transport) g->models.skip_uniform = false;
    g->limit = density_limit(g->models.eos, &g->models.material);
    if (g->models.alpha_floor > 0)
        g->least = g->models.alpha_floor / packing_per_density(&g->models.material) * (1 - ROUND);
    status s = g->engine->make(g);
    if (!s && g->models.transport && !g->models.diffusion->plan) s = implicit_make(g, &g->implicit);
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
                          .ncells_all = f->ncells_all,
                          .models = *models,
                          .npatches = npatches,
                          .rules = rules};
    return make(&g, out);
}

status gas_make_polyhedral(const struct grid *grid, const struct gas_models *models, int npatches,
                           const struct patch_rules *rules, struct gas **out) {
    const struct gas g = {.engine = &engine_polyhedral,
                          .grid = grid,
                          .comm = grid->comm,
                          .dim = grid->dim,
                          .ncells_all = grid->ncells_all,
                          .models = *models,
                          .npatches = npatches,
                          .rules = rules};
    return make(&g, out);
}

void gas_free(struct gas *g) {
    if (!g) return;
    implicit_free(g->implicit);
    g->engine->free(g);
    audit_free(g->audit);
    free(g);
}

int gas_variables(const struct gas *g) {
    return g->nvar;
}

void gas_set_conserved(struct gas *g, const double *const U[MAX_VAR]) {
    g->engine->set_conserved(g, U);
    g->speed_known = false;
    g->guarded = 0;
    g->slow = -1;
}

status gas_set(struct gas *g, const double *rho, const double *const u[3], const double *T) {
    long n = g->ncells_all;
    double *all, *U[MAX_VAR];
    TRY(allocate(&all, g->nvar * n, sizeof(double), "the initial state"));
    for (int v = 0; v < g->nvar; v++) U[v] = all + v * n;
    for (long i = 0; i < n; i++) {
        double square = 0;
        for (int k = g->dim - 1; k >= 0; k--) {
            U[k + 1][i] = rho[i] * u[k][i];
            square += u[k][i] * u[k][i];
        }
        U[0][i] = rho[i];
        U[g->dim + 1][i] = rho[i] * (T[i] / (g->models.material.gamma - 1) + 0.5 * square);
    }
    gas_set_conserved(g, (const double *const *)U);
    free(all);
    return OK;
}

status gas_get_conserved(const struct gas *g, double *const U[MAX_VAR]) {
    return g->engine->get_conserved(g, U);
}

void gas_block_field(const struct gas *g, int block, enum gas_field field, double *const out[3]) {
    g->engine->block_field(g, block, field, out);
}

status gas_field(const struct gas *g, enum gas_field field, double *const out[3]) {
    return g->engine->field(g, field, out);
}

status gas_check(const struct gas *g) {
    return g->engine->check(g);
}

void gas_speed(struct gas *g, struct gas_speed *speed) {
    if (!g->speed_known) {
        struct gas_speed mine;
        g->engine->speed(g, &mine);
        (void)speed_share(g, &mine, false);
    }
    *speed = g->speed;
}

void gas_fastest_place(struct gas *g, const struct gas_speed *speed, double place[3]) {
    g->engine->fastest_place(g, speed, place);
}

void first_place_share(const struct gas *g, const struct first_place *p, double place[3]) {
    double least = p->order;
    comm_min(g->comm, &least, 1);
    for (int k = 0; k < 3; k++) place[k] = p->order == least ? p->place[k] : HUGE_VAL;
    comm_min(g->comm, place, 3);
}

status gas_totals(const struct gas *g, double totals[MAX_VAR]) {
    return g->engine->totals(g, &g->U, totals);
}
