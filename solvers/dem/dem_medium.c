/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Soft spheres with friction as a medium (medium.h) of granularDEM: LAMMPS moves them (lammps.h), haff places, samples
 * and writes them as it does hard grains. */
#include "solvers/dem/dem_table.h"
#include "solvers/grains/grains_box.h"
#include "solvers/grains/grains_contact.h"
#include "solvers/output/clouds.h"
#include "solvers/output/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { P_COMPONENTS = GRAINS_QUANTITIES, P_SHEAR, SPIN, QUANTITIES };
static const int written[] = {0, 1, 2, 3, 4, 5, P_COMPONENTS, P_SHEAR, SPIN, -1};
static const enum coarse_field coarse_of[] = {COARSE_P_AXES, COARSE_P_SHEAR, COARSE_SPIN};

struct dem_run_medium {
    struct medium base;
    struct pool pool;
    struct dem_run run;
    struct dem_table table;
    int *place;                                       /* [ncells] index of a cell in the lattice, or in the mesh */
    double *value[QUANTITIES][3], valued[QUANTITIES]; /* [cells] of fields, and the time they are of */
};
/* Those of hard grains, the pressure tensor as its components along the axes and (xy xz yz), and the mean spin. */
static const struct quantity quantities[] = {
    GRAINS_QUANTITY_ROWS,
    [P_COMPONENTS] = {"pComponents", 3, {1, -1, -2, 0, 0, 0, 0}, false},
    [P_SHEAR] = {"pShear", 3, {1, -1, -2, 0, 0, 0, 0}, false},
    [SPIN] = {"omega", 3, {0, 0, -1, 0, 0, 0, 0}, false},
};
static int components(const struct setup *s, int quantity) {
    return quantity == SPIN ? 3 : quantities[quantity].components == 3 ? s->dim : 1;
}

static struct dem_run_medium *of(const struct medium *m) {
    return (struct dem_run_medium *)(uintptr_t)m;
}

static status medium_check_control(const struct medium *m, const struct control *c) {
    (void)m;
    if (!c->write_processors) return OK;
    return dict_fail(c->dict, "writeProcessors", "granularDEM writes no processorN; leave it out");
}

static status medium_read(struct setup *s) {
    struct dem_run_medium *x;
    TRY(allocate(&x, 1, sizeof *x, "the grains"));
    x->base = (struct medium){.type = &dem_medium, .setup = s};
    s->medium = &x->base;
    if (comm_size(s->comm) > 1)
        return fail(ERR_INPUT,
                    "granularDEM runs on one rank and starts LAMMPS on several: say  granularDEM -np %d  "
                    "without mpirun",
                    comm_size(s->comm));
    TRY(grains_models_read(s->dir, s->mesh, s->dim, s->axis, s->control, true, &x->run.models));
    grains_files(s, x->run.models);
    return OK;
}

static status medium_state(struct setup *s) {
    return dem_run_state(s, &of(s->medium)->run);
}

static status make_values(struct dem_run_medium *x) {
    const struct setup *s = x->base.setup;
    const struct lattice *l = x->run.mesh ? NULL : s->lattice;
    const long cells = l ? (long)l->n[0] * l->n[1] * l->n[2] : s->mesh->ncells;
    TRY(pool_take(&x->pool, &x->place, s->mesh->ncells, sizeof *x->place, "cells"));
    for (int i = 0; i < cells; i++)
        if (!l || l->cell[i] >= 0) x->place[l ? l->cell[i] : i] = i;
    for (int f = 0; f < QUANTITIES; f++) {
        x->valued[f] = NAN;
        for (int k = 0; k < components(s, f); k++)
            TRY(pool_take(&x->pool, &x->value[f][k], cells, sizeof(double), "fields"));
    }
    return OK;
}

static status medium_start(struct medium *m) {
    TRY(dem_run_start(&of(m)->run));
    return make_values(of(m));
}

static void medium_free(struct medium *m) {
    dem_table_close(&of(m)->table);
    dem_run_free(&of(m)->run);
    pool_free(&of(m)->pool);
    free(m);
}

static void print_walls(FILE *f, const struct dem_run *r) {
    const struct setup *s = r->setup;
    for (int k = 0; k < r->walls.dim; k++)
        if (r->walls.periodic[k]) fprintf(f, "    %c %-20s periodic\n", "xyz"[s->axis[k]], "");
    for (int i = 0; i < r->walls.n; i++) {
        const struct dem_wall *w = &r->walls.wall[i];
        if (r->walls.facets) {
            fprintf(f, "    %-22s triangles, friction %g\n", s->mesh->patch[w->patch].name, w->law.friction);
            continue;
        }
        fprintf(f, "    %-22s %s, normal (%.4g %.4g %.4g), friction %g\n", s->mesh->patch[w->patch].name,
                w->axis >= 0 ? "side of the box" : "rectangle", w->normal[0], w->normal[1], w->normal[2],
                w->law.friction);
    }
    if (r->walls.facets)
        fprintf(f, "    %-22s their friction springs begin anew at each written time (fix surface/global)\n",
                "triangles");
}

static void print_start(FILE *f, const struct dem_run *r) {
    const struct setup *s = r->setup;
    const struct packing_report *p = &r->packing;
    if (!r->from_cloud && !p->seconds && !p->added)
        fprintf(f, "    as time %s has them%s\n", s->start.name,
                r->changed ? "; box, contacts or gravity have changed, so contacts and averages begin anew"
                : r->kept  ? ", to the bit on the same number of ranks"
                           : "; cells, kernel or windows have changed, so averages begin anew");
    else if (r->from_cloud)
        fprintf(f, "    from lagrangian/grains of time %s\n", s->start.name);
    else if (p->added < 1)
        fprintf(f, "    put in place at %.3g of their diameter and grown by %lld impacts (%.2g s)\n", p->added,
                (long long)p->impacts, p->seconds);
    else
        fprintf(f, "    put in place at random\n");
}

static void medium_describe(const struct medium *m, FILE *f) {
    const struct dem_run *r = &of(m)->run;
    const double d = r->law.diameter, speed = r->account.speed, time = contact_time(&r->law.pair, speed);
    grains_models_print(f, r->models);
    grains_contact_print(f, r->models);
    fprintf(f, "    %-22s %.4g s at %.4g m/s, steps of at most %.4g s\n", "contact time", time, speed, r->longest);
    print_walls(f, r);
    fprintf(f, "Grains\n    %d %s of %.4g m, moved by LAMMPS on %d rank%s\n", r->moment.n,
            r->walls.dim == 2 ? "disks" : "spheres", d, m->setup->ranks, m->setup->ranks > 1 ? "s" : "");
    print_start(f, r);
}

static void medium_provenance(const struct medium *m, struct sink *o) {
    const struct dem_run *r = &of(m)->run;
    sink_printf(o, "grains          %d;\nkernel          %s;\nwindow          %.17g;\nlongestStep     %.17g;\n",
                r->moment.n, grains_kernel_name(r->models), r->models->window, r->longest);
}

static double medium_memory(const struct medium *m) {
    const struct dem_run *r = &of(m)->run;
    long sums;
    (void)averages_sums(r->averages, 0, &sums);
    return 1500. * r->moment.nold + 16. * (double)sums; /* most of it in LAMMPS: neighbours and histories */
}

static void medium_plan(struct medium *m, const struct control *c, struct pace *out) {
    (void)m;
    (void)c;
    *out = (struct pace){.stable = HUGE_VAL, .limit = "nothing", .early = "pieces of time"};
}

static status medium_step(struct medium *m, const struct control *c, double t, double *dt) {
    struct dem_run_medium *x = of(m);
    struct dem_run *r = &x->run;
    /* without anything to end at, a step would last for ever */
    const double until = isfinite(*dt) ? m->end : t + (r->models->window > 0 ? r->models->window : 1);
    bool sampled;
    (void)c;
    if (!x->table.file) TRY(dem_table_row(&x->table, r));
    do {
        TRY(dem_run_piece(r, until, &sampled));
        if (sampled) TRY(dem_table_row(&x->table, r));
    } while (r->account.t <= t || averages_next(r->averages) <= r->account.t);
    if (until == m->end && r->account.t == until) return OK;
    *dt = r->account.t - t;
    return OK;
}

/* Returns all energy, with what was lost by the samples, less that of the start, over what the grains have and lost. */
static double imbalance(const struct dem_run *r) {
    const struct dem_sums *s = &r->sums;
    const double lost = r->account.normal + r->account.tangent + dem_run_friction(r);
    return (dem_run_energy(r) + lost - r->account.work - r->account.energy) /
           fmax(fabs(r->account.energy), s->kinetic + s->spin + lost);
}

static void fill_row(const struct dem_run *r, struct log_row *row) {
    static const char *const names[] = {"momentum_x", "momentum_y", "momentum_z"};
    const struct dem_sums *s = &r->sums;
    double momentum[3] = {0};
    for (int k = 0; k < r->walls.dim; k++) momentum[r->setup->axis[k]] = s->momentum[k];
    log_column(row, "sampleTime", r->moment_t);
    log_column(row, "grains", s->n);
    log_column(row, "contacts", (double)s->contacts);
    log_column(row, "T", s->T);
    log_column(row, "kinetic", s->kinetic);
    log_column(row, "spin", s->spin);
    log_column(row, "potential", s->potential);
    log_column(row, "springs", s->normal_spring + s->tangent_spring);
    log_column(row, "lostNormal", r->account.normal);
    log_column(row, "lostTangential", r->account.tangent);
    log_column(row, "lostFriction", dem_run_friction(r));
    log_column(row, "wallWork", r->account.work);
    log_column(row, "energyChange", imbalance(r));
    for (int k = 0; k < 3; k++) log_column(row, names[k], momentum[k]);
}

static status medium_log(struct medium *m, FILE *f, struct log_row *row) {
    const struct dem_run *r = &of(m)->run;
    const struct dem_sums *s = &r->sums;
    fill_row(r, row);
    if (!f) return OK;
    fprintf(f, "    steps of %.4g s, limited by %s; at t = %.10g: grains %d  contacts %ld  T %.6g\n", r->span.dt,
            r->span.dt < 0.999 * r->longest ? "the next sample or write" : "the contact time", r->moment_t, s->n,
            s->contacts, s->T);
    fprintf(f, "    energy: kinetic %.6g  spin %.6g  potential %.6g  springs %.6g", s->kinetic, s->spin, s->potential,
            s->normal_spring + s->tangent_spring);
    if (r->account.normal > 0)
        fprintf(f, "  lost by the samples: normal %.6g  tangential %.6g  friction %.6g", r->account.normal,
                r->account.tangent, dem_run_friction(r));
    if (r->spent > 0) fprintf(f, "  %.3g million grain steps/s", 1e-6 * s->n * (double)r->steps / r->spent);
    fprintf(f, "\n");
    return OK;
}

static status medium_finish(struct medium *m, FILE *f) {
    const struct dem_run *r = &of(m)->run;
    if (r->spent > 0)
        fprintf(f, "%ld steps of %d grains: %.2f s in LAMMPS, %.2f s for samples\n", r->steps, r->moment.n, r->spent,
                r->sampled);
    return OK;
}

static status medium_derive(struct medium *m, int quantity) {
    struct dem_run_medium *x = of(m);
    struct dem_run *r = &x->run;
    if (x->valued[quantity] == r->account.t) return OK;
    if (!averages_mark(r->averages)->complete) TRY(dem_run_look(r));
    const struct averages_moment now = dem_run_averaged(r);
    const enum coarse_field field =
        quantity < GRAINS_QUANTITIES ? grains_coarse_of[quantity] : coarse_of[quantity - GRAINS_QUANTITIES];
    averages_value_soft(r->averages, &now, field, x->value[quantity]);
    x->valued[quantity] = r->account.t;
    return OK;
}

static void medium_block(const struct medium *m, int block, int quantity, double *const out[3]) {
    const struct grid_block *b = &m->setup->grid->block[block];
    for (int k = 0; k < components(m->setup, quantity); k++)
        for (int i = 0; i < b->ncells; i++) out[k][i] = of(m)->value[quantity][k][of(m)->place[b->cell[i]]];
}

static const struct patch_field *medium_patch(const struct medium *m, int quantity, int patch) {
    return quantity < GRAINS_QUANTITIES ? grains_patch(&of(m)->run.start, quantity, patch) : NULL;
}

static status medium_cloud(const struct medium *m, struct cloud *out) {
    struct dem_run *r = &of(m)->run;
    const struct setup *s = m->setup;
    *out = (struct cloud){.n = 0};
    if (!r->models->write_cloud) return OK;
    TRY(dem_run_look(r));
    const struct dem_moment *now = &r->moment;
    if (!now->n) return OK;
    TRY(cloud_make(now->n, out));
    TRY(allocate(&out->id, now->n, sizeof(int), "numbers of grains"));
    TRY(allocate(&out->spin, now->n, sizeof *out->spin, "spins of grains"));
    out->diameter = r->law.diameter;
    for (int i = 0; i < now->n; i++) {
        const long cell = grains_box_cell(s, r->mesh, now->x[i]);
        out->cell[i] = cell < 0 ? 0 : (int)cell;
        out->id[i] = now->id[i] - 1;
        grains_box_place(s, now->x[i], out->x[i]);
        for (int k = 0; k < 3; k++) {
            out->u[i][s->axis[k]] = k < s->dim ? now->u[i][k] : 0;
            out->spin[i][s->axis[k]] = now->spin[i][k];
        }
    }
    return OK;
}

static status medium_save(const struct medium *m, const char *folder, const char *location, struct checksums *sums) {
    return dem_run_save(&of(m)->run, folder, location, sums);
}

/* Lists the boundary conditions: any wall of the gas is one, smooth where U slips. */
static void list_boundaries(FILE *f) {
    fprintf(f, "  %-14s %-16s %s\n", "slip, symmetry", "U", "smooth wall (friction: walls of particleProperties)");
    fprintf(f, "  %-14s %-16s %s\n", "noSlip ..", "U", "wall with the friction of `contact`");
    fprintf(f, "  %-14s %-16s %s\n", "zeroGradient", "U, scalars", "grains leave there; for scalars also on walls");
    fprintf(f, "  %-14s %-16s %s\n", "granularWall", "T", "restitution e; of impacts on that wall, as in the gas");
    fprintf(f, "  %-14s %-16s %s\n", "cyclic, empty", "scalars, U", "on patches of these types");
}

static const struct medium_help help = {
    .about = "Moves soft disks (two solved axes) or spheres (three) with friction on the case in DIR (default: here), "
             "by the\n"
             "program lmp of LAMMPS, which must be in PATH (Debian: apt-get install lammps). The case is one of "
             "granularGas or\n"
             "granularMD, with  application granularDEM;  in system/controlDict and  contact { .. }  in\n"
             "constant/particleProperties. Fields rho alpha U T p TComponents pComponents pShear omega are written as "
             "means\n"
             "over grains and contacts, the grains themselves as lagrangian/grains, and the commands of LAMMPS as\n"
             "dem/in.lammps.\n",
    .usage = "[-np N]",
    .own = "  -np N        LAMMPS runs on N ranks; a restart has the same bits on the same number\n",
    .end = "Signals, stopAt, the lock and the exit codes are those of granularGas.\n",
};

const struct medium_type dem_medium = {
    .application = "granularDEM",
    .help = &help,
    .list_models = grains_models_list_soft,
    .list_boundaries = list_boundaries,
    .keywords = grains_models_keywords_soft,
    .fields = {quantities, QUANTITIES, written, written},
    .axial = SPIN,
    .event_driven = true,
    .whole = true,
    .starts = true,
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
    .log = medium_log,
    .finish = medium_finish,
    .derive = medium_derive,
    .block = medium_block,
    .patch = medium_patch,
    .cloud = medium_cloud,
    .save = medium_save,
};
