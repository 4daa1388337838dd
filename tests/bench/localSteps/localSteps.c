/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A prototype of local time steps in powers of two on polyhedra, for inviscid gas without sources and `linear`, on one
 * rank. docs/speed.md ("Local time steps") has what it measured, and what the solver would need.
 *   bench_localSteps vortex [boxes a side]: a vortex on a graded periodic mesh of triangles: error, change of the sums
 *   bench_localSteps CASE TIME [renewals]: air at Mach 3 on the mesh of cases/sphere3D, from rest to TIME (s), with new
 *   levels at equal intervals; distance of rho from a run of SSPRK43 with a quarter of the step
 * Each prints CPU time for SSPRK43, for the prototype with equal steps, and with local ones.
 *
 * A cell of level l takes steps of 2^-l of the longest ones. At the start t_i of its step it is fitted, and the fluxes
 * through its faces give its rise R_i = -div F. From there on its face values are U_i(x) + (t - t_i) R_i. A face passes
 * one flux in a step of its faster cell, of the states on both sides in the middle of that step: so the scheme is of
 * second order. The faster cell takes what has passed at once, the slower one at the end of its step, so that sums over
 * the domain do not change. In steady flow R is 0, and the result does not depend on the steps. A stencil that reads a
 * slower cell amid its step sees the average U_i + (t - t_i) R_i. */
#include "tests/bench/clock.h"
#include "tests/defaults.h"

/* the prototype calls its functions of batches of faces */
#include "libcore/polyhedral/cells_stage.c"

#include <stdio.h>
#include <stdlib.h>

#include "tests/mesh/polyhedral/cells.h" /* last */

enum { MOST = 6 };                      /* levels */
struct levels {                         /* of a mesh whose cells stand level by level, in whole chunks */
    int n;                              /* level 0 takes the longest steps */
    int cell[MOST + 1], face[MOST + 1]; /* the first ones of each level; a face has that of its faster cell */
    int (*edge)[MOST + 1];              /* [patches] the same of the faces on a patch */
    int *of;                            /* [size] level of a cell */
    int *seen[MOST], nseen[MOST];       /* slower cells that the stencils of this level and of higher ones read */
};
struct local {
    struct gas *g;
    struct levels level;
    double *rise[MAX_VAR];          /* [size] dU/dt at the start of the step of each cell */
    double *flux[MAX_VAR];          /* [faces + 1] at that time */
    double *passed[2][MAX_VAR];     /* [faces + 1] through a face since its left or right cell began its step */
    double (*weight)[BATCH];        /* -1/V on the left of a face, 1/V on the right */
    double start[MOST], step[MOST]; /* s: of the steps in hand of each level */
    double *S[MAX_VAR];             /* what fits read; in slower cells the averages at the start of their steps */
    long fits, fluxes;
};

/* ---- levels ------------------------------------------------------------------------------------------------------ */

static void find_rates(struct gas *g, double *rate) {
    const int n = g->cells->polyhedra->nown;
    struct row_speeds speeds;
    for (int at = 0; at < n; at += BATCH) {
        const struct row row = {0, at, n - at < BATCH ? n - at : BATCH};
        g->engine->state.speeds(g, &g->U, &row, &speeds);
        memcpy(rate + at, speeds.rate, (size_t)row.n * sizeof *rate);
    }
}

/* Lowers numbers of cells until those of neighbours differ by one at most. */
static void grade(const struct polyhedra *m, int *slack) {
    const struct polyhedra_faces *f = &m->face;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < f->ninternal; i++) {
            int *low = &slack[f->left[i]], *high = &slack[f->right[i]];
            if (*low > *high + 1) *low = *high + 1, changed = true;
            if (*high > *low + 1) *high = *low + 1, changed = true;
        }
    }
}

/* level[] <- that of each cell of the polyMesh, by the present state; returns their number. */
static status find_levels(struct gas *g, int *level, int *n) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *rate, most = 0;
    int *slack, largest = 0;
    TRY(allocate(&rate, m->nown, sizeof *rate, "rates"));
    TRY(allocate(&slack, m->nown, sizeof *slack, "levels"));
    find_rates(g, rate);
    for (int i = 0; i < m->nown; i++) most = larger(most, rate[i]);
    for (int i = 0; i < m->nown; i++) slack[i] = (int)smaller(MOST - 1, floor(log2(most / rate[i])));
    grade(m, slack);
    for (int i = 0; i < m->nown; i++) largest = slack[i] > largest ? slack[i] : largest;
    for (int i = 0; i < m->nown; i++) level[m->cell[i]] = largest - slack[i];
    *n = largest + 1;
    free(rate);
    free(slack);
    return OK;
}

static int end_of(const struct polyhedra_faces *f, int from, int patch) {
    while (from < f->n && f->patch[from - f->ninternal] == patch) from++;
    return from;
}

static status list_levels(const struct gas *g, const int *level, int n, struct levels *l) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct polyhedra_faces *f = &m->face;
    l->n = n;
    TRY(allocate(&l->of, m->size, sizeof *l->of, "levels"));
    TRY(allocate(&l->edge, g->patches.n, sizeof *l->edge, "levels"));
    for (int k = 0; k <= MOST; k++) {
        int at = 0, face = 0, edge = f->ninternal;
        while (at < m->nown && level[m->cell[at]] < k) at++;
        l->cell[k] = at = k < n ? at / BATCH * BATCH : m->nown;
        while (face < f->ninternal && f->left[face] < at && f->right[face] < at) face++;
        l->face[k] = face;
        for (int p = 0; p < g->patches.n; p++) {
            const int end = end_of(f, edge, p);
            while (edge < end && f->left[edge] < at) edge++;
            l->edge[p][k] = edge;
            edge = end;
        }
        for (int i = at; i < m->nown; i++) l->of[i] = k;
    }
    return OK;
}

static status list_seen(const struct polyhedra *m, struct levels *l) {
    char *seen;
    TRY(allocate(&seen, m->size, 1, "levels"));
    for (int k = 1; k < l->n; k++) {
        const int first = l->cell[k];
        for (int j = m->stencil_start[first]; j < m->stencil_start[m->nown]; j++) seen[m->stencil[j]] = 1;
        TRY(allocate(&l->seen[k], first, sizeof *l->seen[k], "levels"));
        for (int i = 0; i < first; i++)
            if (seen[i]) l->seen[k][l->nseen[k]++] = i;
        memset(seen, 0, (size_t)m->size);
    }
    free(seen);
    return OK;
}

/* ---- the step ---------------------------------------------------------------------------------------------------- */

static status local_make(struct gas *g, const int *level, int n, struct local *l) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    double *weight;
    *l = (struct local){.g = g};
    TRY(list_levels(g, level, n, &l->level));
    TRY(list_seen(m, &l->level));
    fit_free(c->fit); /* whose values last for a turn */
    TRY(fit_make(m, g->models.polynomial, g->components, NULL, &c->fit));
    fit_keep(c->fit, g->limits.least, g->limits.most);
    TRY(allocate(&weight, m->face_start[m->nown], sizeof *weight, "weights"));
    for (int i = 0; i < m->nown; i++)
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++)
            weight[j] = (m->face_of_cell[j] < 0 ? 1 : -1) * c->inverse_volume[i];
    TRY(cells_sides_weights(c, weight, &l->weight));
    free(weight);
    for (int v = 0; v < g->nvar; v++) {
        double **line[] = {&l->flux[v], &l->passed[0][v], &l->passed[1][v]};
        for (int i = 0; i < 3; i++) TRY(allocate(line[i], m->face.n + 1L, sizeof(double), "fluxes"));
        TRY(allocate(&l->rise[v], m->size + BATCH, sizeof(double), "rises"));
    }
    cells_lines(g, &g->V, l->S);
    return OK;
}

static void local_free(struct local *l) {
    free(l->level.of);
    free(l->level.edge);
    for (int k = 0; k < MOST; k++) free(l->level.seen[k]);
    free(l->weight);
    for (int v = 0; v < MAX_VAR; v++) {
        free(l->flux[v]);
        free(l->rise[v]);
        for (int side = 0; side < 2; side++) free(l->passed[side][v]);
    }
}

/* The states on one side of the n faces of p from `first` on, at time t. */
static void states_at(const struct local *l, int side, int first, double t, struct points *p) {
    const struct gas *g = l->g;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    double average[MAX_VAR][BATCH], at[MAX_VAR][BATCH], rise[BATCH], late[BATCH], theta[BATCH], *out[MAX_VAR];
    int cell[BATCH];
    gather_cells(p->n, p->face, side ? f->right : f->left, cell);
    for (int i = 0; i < p->n; i++) late[i] = t - l->start[l->level.of[cell[i]]];
    for (int v = 0; v < g->nvar; v++) out[v] = at[v];
    fit_points(g->cells->fit, side, first, p->n, (const double *const *)l->S, out);
    for (int v = 0; v < g->nvar; v++) {
        gather_line(p->n, cell, l->S[v], average[v]);
        gather_line(p->n, cell, l->rise[v], rise);
        for (int i = 0; i < p->n; i++) at[v][i] += late[i] > 0 ? late[i] * rise[i] : 0;
    }
    limit_towards(p->n, g->components, g->limits.least, g->limits.most, (const double(*)[BATCH])average, at, theta);
    into_frames(g, p, at);
    for (int v = 0; v < g->nvar; v++) memcpy(p->state[v][side ? RIGHT : LEFT], at[v], (size_t)p->n * sizeof(double));
}

/* p->out <- fluxes at time t through n faces, all internal or all of one patch. */
static void fluxes_at(const struct local *l, int first, int n, double t, struct points *p) {
    const struct gas *g = l->g;
    const struct polyhedra *m = g->cells->polyhedra;
    p->n = n;
    for (int i = 0; i < n; i++) p->face[i] = first + i;
    find_frames(m, p);
    states_at(l, 0, first, t, p);
    if (first < m->face.ninternal)
        states_at(l, 1, first, t, p);
    else
        states_beyond(g, (const double *const *)l->S, p);
    struct faces faces = point_primitives(g, p);
    if (cells_fronts_floor(g, n, p->face, p->floor)) set_floors(p, &faces);
    g->models.flux->through(&faces, g->models.eos, &g->models.material, g->limits.first_order);
    out_of_frames(g, p, p->out);
}

/* The fluxes at time t, when cells begin their steps. */
static void begin_faces(struct local *l, int first, int last, double t) {
    const double *area = l->g->cells->polyhedra->face.area;
    struct points p;
    for (int n; first < last; first += n) {
        n = last - first < BATCH ? last - first : BATCH;
        fluxes_at(l, first, n, t, &p);
        for (int v = 0; v < l->g->nvar; v++) sum_single(n, area + first, p.out[v], l->flux[v] + first);
    }
}

/* What passes in a step of level k from t on is added to what has passed since a slower cell began its step. */
static void pass_faces(struct local *l, int first, int last, int k, double t) {
    const struct polyhedra *m = l->g->cells->polyhedra;
    struct points p;
    l->fluxes += last - first;
    for (int n; first < last; first += n) {
        n = last - first < BATCH ? last - first : BATCH;
        fluxes_at(l, first, n, t + 0.5 * l->step[k], &p);
        for (int side = 0; side < 2; side++)
            for (int i = 0; i < n; i++) {
                const int face = first + i, cell = side ? m->face.right[face] : m->face.left[face];
                const bool amid = t > l->start[l->level.of[cell]];
                for (int v = 0; v < l->g->nvar; v++) {
                    double *sum = &l->passed[side][v][face];
                    *sum = (amid ? *sum : 0) + l->step[k] * m->face.area[face] * p.out[v][i];
                }
            }
    }
}

/* Fits the cells from level k on, whose steps begin at t. */
static void begin_cells(struct local *l, int k, double t, double *const *U) {
    struct gas *g = l->g;
    const struct levels *level = &l->level;
    const struct polyhedra *m = g->cells->polyhedra;
    const int first = level->cell[k];
    for (int j = k; j < MOST; j++) l->start[j] = t;
    for (int v = 0; v < g->nvar; v++) {
        memcpy(l->S[v] + first, U[v] + first, (size_t)(m->nown - first) * sizeof(double));
        for (int j = 0; j < level->nseen[k]; j++) {
            const int i = level->seen[k][j];
            l->S[v][i] = U[v][i] + (t - l->start[level->of[i]]) * l->rise[v][i];
        }
    }
    for (int p = 0; p < g->patches.n; p++)
        cells_mirrors(g, level->edge[p][k] - m->face.ninternal, level->edge[p][MOST] - m->face.ninternal, l->S);
    fit_cells(g->cells->fit, first, m->nown, (const double *const *)l->S);
    l->fits += m->nown - first;
    for (int v = 0; v < g->nvar; v++)
        for (int j = 0; j < level->nseen[k]; j++) l->S[v][level->seen[k][j]] = U[v][level->seen[k][j]];
}

/* The rises of the cells from level k on. */
static void find_rises(struct local *l, int k, double t) {
    struct gas *g = l->g;
    const struct levels *level = &l->level;
    const struct polyhedra *m = g->cells->polyhedra;
    begin_faces(l, level->face[k], m->face.ninternal, t);
    for (int p = 0; p < g->patches.n; p++) begin_faces(l, level->edge[p][k], level->edge[p][MOST], t);
    for (int at = level->cell[k]; at < m->nown; at += BATCH)
        for (int v = 0; v < g->nvar; v++)
            cells_sides_sum(g->cells, at, (const double(*)[BATCH])l->weight, l->flux[v], l->flux[v], l->rise[v] + at);
}

static void end_cells(struct local *l, int k, double *const *U) {
    struct gas *g = l->g;
    const int nown = g->cells->polyhedra->nown;
    double sum[BATCH];
    for (int at = l->level.cell[k]; at < nown; at += BATCH)
        for (int v = 0; v < g->nvar; v++) {
            cells_sides_sum(g->cells, at, (const double(*)[BATCH])l->weight, l->passed[0][v], l->passed[1][v], sum);
            for (int i = 0; i < BATCH && at + i < nown; i++) U[v][at + i] += sum[i];
        }
}

/* The lowest level that begins a step at a multiple of the shortest one. */
static int level_at(const struct levels *l, int number) {
    int k = l->n - 1;
    for (; k > 0 && number % 2 == 0; number /= 2) k--;
    return k;
}

/* The longest step that the limits of all cells allow, dt at most. */
static double longest(const struct local *l, double maxCo, double dt) {
    struct gas *g = l->g;
    const int nown = g->cells->polyhedra->nown;
    struct row_speeds speeds;
    for (int at = 0; at < nown; at += BATCH) {
        const struct row row = {0, at, nown - at < BATCH ? nown - at : BATCH};
        g->engine->state.speeds(g, &g->U, &row, &speeds);
        for (int i = 0; i < row.n; i++) dt = smaller(dt, maxCo / ldexp(speeds.rate[i], -l->level.of[at + i]));
    }
    return dt;
}

/* Advances the gas by the longest step, dt at most; returns it. */
static double local_step(struct local *l, double maxCo, double dt) {
    struct gas *g = l->g;
    const struct levels *level = &l->level;
    double *U[MAX_VAR];
    struct gas_speed speed;
    dt = longest(l, maxCo, dt);
    g->engine->state.speed(g, &speed); /* gas_speed keeps that of a state before */
    cells_fronts(g, &speed);
    cells_lines(g, &g->U, U);
    for (int k = 0; k < MOST; k++) l->step[k] = ldexp(dt, -k);
    for (int s = 0; s < 1 << (level->n - 1); s++) {
        const double t = s * l->step[level->n - 1];
        const int first = level_at(level, s);
        begin_cells(l, first, t, U);
        find_rises(l, first, t);
        for (int k = first; k < level->n; k++) {
            pass_faces(l, level->face[k], level->face[k + 1], k, t);
            for (int p = 0; p < g->patches.n; p++) pass_faces(l, level->edge[p][k], level->edge[p][k + 1], k, t);
        }
        end_cells(l, level_at(level, s + 1), U);
    }
    return dt;
}

/* ---- subjects ---------------------------------------------------------------------------------------------------- */

struct subject {
    struct polymesh *mesh;
    struct comm *comm;
    struct gas_models models;
    int dim, cells;
    struct patch_rules *rules; /* [patches] */
    double *centre, *volume;
    double *state[MAX_VAR]; /* conserved, in the order of the polyMesh */
};
enum way { STAGES, EQUAL, LOCAL };
struct plan {
    enum way way;
    double maxCo, end;
    int renewals;
};
struct result {
    double *rho, seconds, levels;
    long steps, fits;
};

/* A gas with the state of the subject; levels: NULL, or where each cell shall stand. */
static status gas_of(const struct subject *s, const int *level, int n, struct grid **grid, struct gas **g) {
    TRY(grid_make(NULL, s->mesh, s->centre, s->comm, 1, grid));
    if (level) {
        polyhedra_free((*grid)->polyhedra);
        TRY(polyhedra_make_levels(s->mesh, s->comm, 1, n, level, &(*grid)->polyhedra));
    }
    TRY(gas_make_polyhedral(*grid, &s->models, s->mesh->npatches, s->rules, g));
    gas_set_conserved(*g, (const double *const *)s->state);
    return OK;
}

static status advance(struct gas *g, struct local *l, const struct plan *plan, double from, double to, long *steps) {
    for (double t = from, dt; t < to * (1 - 1e-12); t += dt, ++*steps)
        if (plan->way == STAGES) {
            struct gas_speed speed;
            gas_speed(g, &speed);
            dt = smaller(plan->maxCo / speed.rate, to - t);
            TRY(gas_step(g, t, &dt, plan->maxCo, 0, 1e-3, &speed));
        } else {
            dt = local_step(l, plan->maxCo, to - t);
            TRY(gas_check(g));
        }
    return OK;
}

/* From the state of the subject, which becomes that at the end. Seconds are those of steps, without set-up. */
static status run(struct subject *s, const struct plan *plan, struct result *out) {
    int *level, n = 1;
    TRY(allocate(&level, s->cells, sizeof *level, "levels"));
    for (int i = 0; i < plan->renewals; i++) {
        struct grid *grid;
        struct gas *g;
        struct local l;
        TRY(gas_of(s, NULL, 0, &grid, &g));
        if (plan->way == LOCAL) TRY(find_levels(g, level, &n));
        gas_free(g);
        grid_free(grid);
        TRY(gas_of(s, plan->way == STAGES ? NULL : level, n, &grid, &g));
        if (plan->way != STAGES) TRY(local_make(g, level, n, &l));
        const double clock = cpu_seconds(), part = plan->end / plan->renewals;
        TRY(advance(g, &l, plan, i * part, (i + 1) * part, &out->steps));
        out->seconds += cpu_seconds() - clock;
        out->levels = n;
        TRY(gas_get_conserved(g, s->state));
        if (plan->way != STAGES) {
            out->fits += l.fits;
            local_free(&l);
        }
        gas_free(g);
        grid_free(grid);
    }
    free(level);
    return OK;
}

static double sum_of(const struct subject *s, const double *q) {
    double sum = 0;
    for (int i = 0; i < s->cells; i++) sum += s->volume[i] * q[i];
    return sum;
}

static double distance(const struct subject *s, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < s->cells; i++) sum += s->volume[i] * fabs(a[i] - b[i]);
    return sum / sum_of(s, b);
}

static status subject_make(struct subject *s) {
    double *face;
    s->models =
        (struct gas_models){.material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 1.4, .alpha_max = 1},
                            .eos = eos_find("perfectGas"),
                            .flux = flux_find("common"),
                            .flux_params = own_defaults(&flux_find("common")->model),
                            .polynomial = polynomial_find("linear"),
                            .stepper = stepper_find("SSPRK43")};
    s->cells = s->mesh->ncells;
    TRY(allocate(&s->rules, s->mesh->npatches, sizeof *s->rules, "patches"));
    TRY(allocate(&face, 6L * s->mesh->nfaces, sizeof *face, "faces"));
    TRY(allocate(&s->centre, 4L * s->cells, sizeof *s->centre, "cells"));
    s->volume = s->centre + 3L * s->cells;
    polymesh_face_geometry(s->mesh, face, face + 3L * s->mesh->nfaces);
    TRY(polymesh_cell_geometry(s->mesh, face, face + 3L * s->mesh->nfaces, s->centre, s->volume));
    free(face);
    for (int v = 0; v < s->dim + 2; v++) TRY(allocate(&s->state[v], s->cells, sizeof(double), "the state"));
    return OK;
}

static void subject_free(struct subject *s) {
    for (int v = 0; v < s->dim + 2; v++) free(s->state[v]);
    free(s->centre);
    free(s->rules);
    polymesh_free(s->mesh);
}

static void set_state(const struct subject *s, int i, double rho, const double *u, double p) {
    double square = 0;
    for (int k = 0; k < s->dim; k++) {
        s->state[k + 1][i] = rho * u[k];
        square += u[k] * u[k];
    }
    s->state[0][i] = rho;
    s->state[s->dim + 1][i] = p / 0.4 + 0.5 * rho * square;
}

/* ---- the vortex of cases/vortex, of which the mesh is 10 x 10 ---------------------------------------------------- */

static double vortex_at(double t, const double x[2], double u[2], double *p) {
    double d[2], pi = acos(-1);
    for (int k = 0; k < 2; k++) d[k] = remainder(x[k] - 5 - t, 10);
    const double g = 5 / (2 * pi) * exp((1 - d[0] * d[0] - d[1] * d[1]) / 2), theta = 1 - g * g / 7;
    u[0] = 1 - g * d[1];
    u[1] = 1 + g * d[0];
    *p = pow(theta, 3.5);
    return pow(theta, 2.5);
}

/* Boxes from 1/4 to 7/4 of the mean width: in both directions the smallest ones in the middle. */
static status vortex_make(int side, struct subject *s) {
    const struct cells_recipe recipe = {"triangles", 2, PRISMS, {side, side, 1}, {0, 1, 2}, 0.1, {true, true, false}};
    const double length[2] = {0.1 * side, 0.2 * side}, pi = acos(-1);
    s->dim = 2;
    s->mesh = cells_make(&recipe);
    for (int i = 0; i < s->mesh->npoints; i++)
        for (int k = 0; k < 2; k++) {
            double *x = &s->mesh->points[3 * i + k];
            *x = 10 * (*x / length[k] + 0.75 / (2 * pi) * sin(2 * pi * *x / length[k]));
        }
    return subject_make(s);
}

static status vortex(struct comm *c, int side, double maxCo, enum way way) {
    static const char *const names[] = {"SSPRK43", "equal steps", "local steps"};
    struct subject s = {.comm = c};
    struct result r = {.steps = 0};
    double u[2], p, error = 0, before[4], drift = 0;
    TRY(vortex_make(side, &s));
    for (int i = 0; i < s.cells; i++) {
        const double rho = vortex_at(0, s.centre + 3L * i, u, &p);
        set_state(&s, i, rho, u, p);
    }
    for (int v = 0; v < 4; v++) before[v] = sum_of(&s, s.state[v]);
    TRY(run(&s, &(struct plan){way, maxCo, 2, 1}, &r));
    for (int v = 0; v < 4; v++) drift = larger(drift, fabs(sum_of(&s, s.state[v]) / before[v] - 1));
    for (int i = 0; i < s.cells; i++)
        error += s.volume[i] * fabs(s.state[0][i] - vortex_at(2, s.centre + 3L * i, u, &p));
    printf("%-12s maxCo %4g %7d triangles, levels %g: %5ld steps, %6.2f s, error %.3e, sums changed by %.0e\n",
           names[way], maxCo, s.cells, r.levels, r.steps, r.seconds, error / 100, drift);
    subject_free(&s);
    return OK;
}

/* ---- a sphere in a stream ---------------------------------------------------------------------------------------- */

static status sphere_make(const char *dir, struct subject *s) {
    static const double stream[4] = {38.197186342054884, 100, 0, 0};
    char path[4096];
    snprintf(path, sizeof path, "%s/constant/polyMesh", dir);
    TRY(polymesh_read(path, &s->mesh));
    s->dim = 3;
    TRY(subject_make(s));
    for (int i = 0; i < s->mesh->npatches; i++) {
        const char *name = s->mesh->patch[i].name;
        const bool inlet = !strcmp(name, "inlet"), outlet = !strcmp(name, "outlet");
        const struct boundary_type *type = boundary_find(inlet ? "fixedValue" : "zeroGradient");
        s->rules[i] = (struct patch_rules){
            .density = {.type = type, .uniform = {stream[0]}},
            .velocity = {.type = inlet || outlet ? type : boundary_mirror, .uniform = {stream[1], 0, 0}},
            .temperature = {.type = type, .uniform = {793.6507936507937}}};
    }
    for (int i = 0; i < s->cells; i++) set_state(s, i, stream[0], stream + 1, stream[0] * 793.6507936507937);
    return OK;
}

static status sphere_run(struct comm *c, const char *dir, const struct plan *plan, double **rho, struct result *r) {
    struct subject s = {.comm = c};
    TRY(sphere_make(dir, &s));
    TRY(run(&s, plan, r));
    if (!*rho) {
        *rho = s.state[0];
        s.state[0] = NULL;
    } else
        r->levels = distance(&s, s.state[0], *rho);
    subject_free(&s);
    return OK;
}

static status sphere(struct comm *c, const char *dir, double end, int renewals) {
    static const struct {
        const char *name;
        enum way way;
        double maxCo;
    } rows[] = {{"SSPRK43", STAGES, 0.25}, {"SSPRK43", STAGES, 1},      {"SSPRK43", STAGES, 2},
                {"equal steps", EQUAL, 1}, {"local steps", LOCAL, 0.5}, {"local steps", LOCAL, 1}};
    double *rho = NULL;
    for (int i = 0; i < (int)(sizeof rows / sizeof *rows); i++) {
        const struct plan plan = {rows[i].way, rows[i].maxCo, end, rows[i].way == LOCAL ? renewals : 1};
        struct result r = {.steps = 0};
        TRY(sphere_run(c, dir, &plan, &rho, &r));
        printf("%-12s maxCo %4g: %5ld steps, %9ld fits, %7.2f s", rows[i].name, plan.maxCo, r.steps, r.fits, r.seconds);
        printf(i ? ", distance %.2e\n" : "\n", r.levels);
        fflush(stdout);
    }
    free(rho);
    return OK;
}

int main(int argc, char **argv) {
    static const enum way ways[] = {STAGES, EQUAL, LOCAL, LOCAL};
    struct comm *c;
    const bool round = argc > 1 && !strcmp(argv[1], "vortex");
    if (argc < (round ? 2 : 3)) {
        fprintf(stderr, "usage: bench_localSteps vortex [boxes a side] | CASE TIME [renewals]\n");
        return ERR_INPUT;
    }
    status s = comm_start(&argc, &argv, &c);
    for (int i = 0; !s && round && i < 4; i++) s = vortex(c, argc > 2 ? atoi(argv[2]) : 40, i == 2 ? 0.5 : 1, ways[i]);
    if (!s && !round) s = sphere(c, argv[1], atof(argv[2]), argc > 3 ? atoi(argv[3]) : 6);
    const int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
