/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local time steps in powers of two on polyhedra (docs/physics.md 7.1; struct stepper's `local`).
 *
 * A cell of level l takes steps of 2^-l of the step of the gas. At the start t_i of its step it is fitted, and the
 * fluxes through its faces give its rise R_i = -div F/V. From there on its values at the faces are U_i(x) + (t - t_i)
 * R_i. A face passes one flux in a step of its faster cell, of the states on both sides in the middle of that step: so
 * the scheme is of second order. The faster cell takes what has passed at once, the slower one at the end of its step,
 * so that sums over the domain do not change. In steady flow R is 0, and the result does not depend on the steps. A
 * stencil that reads a slower cell amid its step sees the average U_i + (t - t_i) R_i. Gravity is a part of R_i, and
 * acts at the end of a step with the mean of both states.
 *
 * Levels follow from the state and the step alone, cell by cell, so that a restart, and any number of ranks, has the
 * same bits. Fits go by batches of LANES cells: where only some of them begin a step, the others keep their values
 * (fit_due). Cells stand in the order of their sizes (grid_make), so that this is seldom. */
#include "libcore/polyhedral/cells_points_private.h"
#include "libcore/schemes/polynomial_fit.h"

#include <stdlib.h>

enum { LEVELS = GAS_LEVELS };
static const double ROUNDED = 1e-9; /* of dt times a rate: by so little no cell changes its level */

struct cells_local {
    int n;                      /* levels of the step in hand */
    double dt[LEVELS];          /* s: their steps */
    int *level;                 /* [size] of each cell; 0 in mirrors */
    double *start;              /* [size] s since the start of the step of the gas: each cell began its own step then */
    double *rate, *own;         /* [size] 1/s, m/s: of each own cell in that state */
    double *speed, *wider;      /* [size] m/s: the largest one that reaches each cell, scratch */
    double *reach;              /* [size] m/s: that within the longest step from the state of the last `longest` */
    double *rise[MAX_VAR];      /* [size] dU/dt at the start of the step of each cell */
    double *passed[2][MAX_VAR]; /* [faces + 1] through a face since its left or right cell began its step */
    double (*weight)[BATCH];    /* -1/V on the left of a face, 1/V on the right */
    int *face;                  /* [faces] level by level, in their order within each */
    int first[LEVELS + 1];      /* face of each level in `face` */
    int *chunk;                 /* [chunks] highest level of BATCH cells */
    bool *due;                  /* [nnear + LANES] does the cell begin a step now? */
};

status cells_local_make(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    const long entries = m->face_start[m->nown], chunks = m->nown / BATCH + 1;
    struct cells_local *l;
    double *weight;
    if (!g->models.stepper->local) return OK;
    TRY(allocate(&l, 1, sizeof *l, "local time steps"));
    c->local = l;
    TRY(allocate(&l->level, m->size, sizeof *l->level, "local time steps"));
    double **line[] = {&l->start, &l->rate, &l->own, &l->speed, &l->wider, &l->reach};
    for (int i = 0; i < 6; i++) TRY(allocate(line[i], m->size + BATCH, sizeof(double), "local time steps"));
    TRY(allocate(&l->face, m->face.n, sizeof *l->face, "local time steps"));
    TRY(allocate(&l->chunk, chunks, sizeof *l->chunk, "local time steps"));
    TRY(allocate(&l->due, m->nnear + LANES, sizeof *l->due, "local time steps"));
    for (int v = 0; v < g->nvar; v++) {
        for (int side = 0; side < 2; side++)
            TRY(allocate(&l->passed[side][v], m->face.n + 1L, sizeof(double), "local time steps"));
        TRY(allocate(&l->rise[v], m->size, sizeof(double), "local time steps"));
    }
    TRY(allocate(&weight, entries, sizeof *weight, "local time steps"));
    for (int i = 0; i < m->nown; i++)
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++)
            weight[j] = (m->face_of_cell[j] < 0 ? 1 : -1) * c->inverse_volume[i];
    const status s = cells_sides_weights(c, weight, &l->weight);
    free(weight);
    return s ? s : fit_hold(c->fit);
}

void cells_local_free(struct cells_local *l) {
    if (!l) return;
    free(l->level);
    free(l->start);
    free(l->rate);
    free(l->own);
    free(l->speed);
    free(l->wider);
    free(l->reach);
    free(l->face);
    free(l->chunk);
    free(l->due);
    free(l->weight);
    for (int v = 0; v < MAX_VAR; v++) {
        free(l->rise[v]);
        for (int side = 0; side < 2; side++) free(l->passed[side][v]);
    }
    free(l);
}

/* ---- levels ------------------------------------------------------------------------------------------------------ */

/* Raises numbers of cells until those of neighbours differ by one at most, over all ranks: the least ones that do. */
static void grade(struct gas *g, int *level) {
    struct polyhedra *m = g->cells->polyhedra;
    const struct polyhedra_faces *f = &m->face;
    for (long raised = 1; raised;) {
        raised = 0;
        polyhedra_fill_int(m, level);
        for (bool again = true; again; raised += again) {
            again = false;
            for (int i = 0; i < f->ninternal; i++) {
                int *a = &level[f->left[i]], *b = &level[f->right[i]];
                if (*a < *b - 1) *a = *b - 1, again = true;
                if (*b < *a - 1) *b = *a - 1, again = true;
            }
        }
        comm_sum_long(g->comm, &raised, 1);
    }
}

/* The least level at which a cell of that rate takes no longer steps than `pace`/rate, if the step of level 0 is so. */
static int level_of(double rate, double pace) {
    int level = 0;
    for (; level < LEVELS && rate > pace; level++) rate *= 0.5;
    return level;
}

/* Finds the rates of the cells, the speeds |u| + c that go with them, and the largest rate of all ranks. */
static double find_rates(struct gas *g, const struct state *s) {
    struct cells_local *l = g->cells->local;
    const int n = g->cells->polyhedra->nown;
    double most = 0;
    for (int at = 0; at < n; at += BATCH) {
        const int here = n - at < BATCH ? n - at : BATCH;
        cells_rates(g, s, at, here, l->rate + at, l->own + at);
        for (int i = at; i < at + here; i++) most = larger(most, l->rate[i]);
    }
    memcpy(l->speed, l->own, (size_t)n * sizeof *l->speed);
    comm_max(g->comm, &most, 1);
    return most;
}

/* speed <- the largest one of each cell and of those in `rings` rings of faces around it. */
static void spread_speeds(struct gas *g, int rings) {
    struct cells_local *l = g->cells->local;
    struct polyhedra *m = g->cells->polyhedra;
    for (; rings > 0; rings--) {
        double *swap = l->speed;
        l->speed = l->wider;
        l->wider = swap;
        polyhedra_fill_start(m, 1, &l->wider);
        polyhedra_fill_finish(m);
        memcpy(l->speed, l->wider, (size_t)m->ncells * sizeof *l->speed);
        for (int i = 0; i < m->face.ninternal; i++) {
            const int a = m->face.left[i], b = m->face.right[i];
            l->speed[a] = larger(l->speed[a], l->wider[b]);
            l->speed[b] = larger(l->speed[b], l->wider[a]);
        }
    }
}

/* Sets the levels at which cells take no longer steps than their rates allow, with the speed that reaches them, if the
 * longest step is of pace/rate. *slow, *enough: does a cell of this rank stay at level 0, before levels are graded, and
 * are there enough levels for all? */
static void set_levels(const struct gas *g, const double *speed, double pace, bool *slow, bool *enough) {
    struct cells_local *l = g->cells->local;
    *slow = false;
    *enough = true;
    for (int i = 0; i < g->cells->polyhedra->nown; i++) {
        const int level = level_of(l->rate[i] * (speed[i] / l->own[i]), pace);
        *slow |= level == 0;
        *enough &= level < LEVELS;
        l->level[i] = level < LEVELS ? level : LEVELS - 1;
    }
}

/* Does a cell of any rank take the whole step if that is of pace/rate, and are there enough levels for all? graded:
 * when levels are graded, too. */
static bool any_is_slow(struct gas *g, double pace, bool graded) {
    struct cells_local *l = g->cells->local;
    bool slow, enough;
    set_levels(g, l->speed, pace, &slow, &enough);
    if (graded) {
        grade(g, l->level);
        slow = false;
        for (int i = 0; i < g->cells->polyhedra->nown; i++) slow |= l->level[i] == 0;
    }
    double is[2] = {slow, !enough};
    comm_max(g->comm, is, 2);
    return is[0] == 1 && is[1] == 0;
}

/* A wave crosses no more than one cell in a step of the shortest kind. So in the longest step, of 2^n of these, it
 * reaches cells that are up to 2^n rings away, and these must be ready for its speed. n is as large as it can be. */
void cells_local_longest(struct gas *g, struct gas_speed *speed) {
    struct cells_local *l = g->cells->local;
    const size_t bytes = (size_t)g->cells->polyhedra->nown * sizeof(double);
    const double most = find_rates(g, &g->U);
    if (!(most > 0 && most < HUGE_VAL)) return;
    spread_speeds(g, 1);
    memcpy(l->reach, l->speed, bytes);
    for (int n = 1; n < LEVELS && any_is_slow(g, ldexp(most, -n), false); n++) {
        spread_speeds(g, 1 << (n - 1));
        if (!any_is_slow(g, ldexp(most, -n), true)) break;
        memcpy(l->reach, l->speed, bytes);
        speed->levels = n;
    }
    speed->rate = ldexp(most, -speed->levels);
    speed->loose = ldexp(speed->loose, -speed->levels);
}

/* That of the faster cell. */
static int level_of_face(const struct cells_local *l, const struct polyhedra_faces *f, int face) {
    const int a = l->level[f->left[face]], b = l->level[f->right[face]];
    return a > b ? a : b;
}

/* Lists the faces level by level. */
static void list_faces(const struct polyhedra *m, struct cells_local *l) {
    const struct polyhedra_faces *f = &m->face;
    int at[LEVELS];
    memset(l->first, 0, sizeof l->first);
    for (int i = 0; i < f->n; i++) l->first[level_of_face(l, f, i) + 1]++;
    for (int k = 0; k < LEVELS; k++) {
        at[k] = l->first[k];
        l->first[k + 1] += l->first[k];
    }
    for (int i = 0; i < f->n; i++) l->face[at[level_of_face(l, f, i)]++] = i;
}

/* Finds the levels of the cells for a step of dt, by the rates of the state from which dt was chosen. Returns false if
 * a cell of this rank would need more than there are. */
static bool find_levels(struct gas *g, double dt) {
    struct cells_local *l = g->cells->local;
    const struct polyhedra *m = g->cells->polyhedra;
    long *of_level = g->counts.now.levels;
    bool slow, enough;
    set_levels(g, l->reach, (1 + ROUNDED) * g->step.courant / dt, &slow, &enough);
    grade(g, l->level);
    memset(l->chunk, 0, (size_t)(m->nown / BATCH + 1) * sizeof *l->chunk);
    memset(of_level, 0, LEVELS * sizeof *of_level);
    for (int i = 0; i < m->nown; i++) {
        int *chunk = &l->chunk[i / BATCH];
        *chunk = l->level[i] > *chunk ? l->level[i] : *chunk;
        of_level[l->level[i]]++;
    }
    comm_sum_long(g->comm, of_level, LEVELS);
    for (l->n = LEVELS; l->n > 1 && of_level[l->n - 1] == 0;) l->n--;
    for (int k = 0; k < LEVELS; k++) l->dt[k] = ldexp(dt, -k);
    list_faces(m, l);
    return enough;
}

/* The lowest level that begins a step at a multiple of the shortest one. */
static int level_at(const struct cells_local *l, int number) {
    int k = l->n - 1;
    for (; k > 0 && number % 2 == 0; number /= 2) k--;
    return k;
}

/* ---- states and fluxes ------------------------------------------------------------------------------------------- */

struct local_walk { /* through a step of the gas */
    struct gas *g;
    struct cells_local *l;
    double *U[MAX_VAR];   /* averages at the start of the step of each cell */
    double *now[MAX_VAR]; /* averages now, as fits read them */
    double t;             /* s since the start of the step of the gas */
    double t0;            /* s: that start */
    long count;           /* inadmissible cells */
};

KERNEL static void add_late(int n, const double *restrict late, const double *restrict rise, double *restrict q) {
    for (int i = 0; i < n; i++) q[i] += late[i] * rise[i];
}

/* The averages, and the rises of the states since then, in the cells on one side of the faces of p, at time t. */
static void side_rises(const struct local_walk *w, int side, double t, const struct points *p, double (*average)[BATCH],
                       double (*at)[BATCH]) {
    const struct polyhedra_faces *f = &w->g->cells->polyhedra->face;
    double rise[BATCH], late[BATCH];
    int cell[BATCH];
    points_cells(p->n, p->face, side ? f->right : f->left, cell);
    points_gather(p->n, cell, w->l->start, late);
    for (int i = 0; i < p->n; i++) late[i] = t - late[i];
    for (int v = 0; v < w->g->nvar; v++) {
        points_gather(p->n, cell, w->U[v], average[v]);
        points_gather(p->n, cell, w->l->rise[v], rise);
        add_late(p->n, late, rise, at[v]);
    }
}

/* Changes the values of fits by what the polynomials do not know. */
static void correct_fits(const struct local_walk *w, int side, const struct points *p, double (*at)[BATCH]) {
    const struct gas *g = w->g;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const bool packs = g->models.material.threshold > 0;
    double average[MAX_VAR][BATCH];
    int cell[BATCH];
    if (!packs && !g->cells->rest) return;
    points_cells(p->n, p->face, side ? f->right : f->left, cell);
    for (int v = 0; v < g->nvar && packs; v++) points_gather(p->n, cell, w->U[v], average[v]);
    if (packs) points_flatten(g, p, w->now[0], (const double(*)[BATCH])average, at);
    if (g->cells->rest) cells_rest_add(g, p->face, p->n, cell, at);
}

/* The states on one side of the faces of p at time t. */
static void states_at(const struct local_walk *w, int side, double t, struct points *p) {
    const struct gas *g = w->g;
    double average[MAX_VAR][BATCH], at[MAX_VAR][BATCH], theta[BATCH], *out[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) out[v] = at[v];
    fit_faces(g->cells->fit, side, p->n, p->face, (const double *const *)w->U, out);
    correct_fits(w, side, p, at);
    side_rises(w, side, t, p, average, at);
    limit_towards(p->n, g->components, g->limits.least, g->limits.most, (const double(*)[BATCH])average, at, theta);
    points_into_frames(g, p, at);
    for (int v = 0; v < g->nvar; v++) memcpy(p->state[v][side ? RIGHT : LEFT], at[v], (size_t)p->n * sizeof(double));
}

/* The states beyond the faces of a patch at time t. */
static void beyond_at(const struct local_walk *w, double t, struct points *p) {
    const struct gas *g = w->g;
    double inner[MAX_VAR][BATCH], average[MAX_VAR][BATCH], theta[BATCH];
    const bool reflects = points_reflect(g, p);
    for (int v = 0; v < g->nvar && reflects; v++) memcpy(inner[v], p->state[v][LEFT], (size_t)p->n * sizeof(double));
    if (!reflects) {
        memset(inner, 0, sizeof inner);
        side_rises(w, 0, t, p, average, inner);
        for (int v = 0; v < g->nvar; v++)
            for (int i = 0; i < p->n; i++) inner[v][i] += average[v][i];
        limit_towards(p->n, g->components, g->limits.least, g->limits.most, (const double(*)[BATCH])average, inner,
                      theta);
        points_into_frames(g, p, inner);
    }
    points_beyond(g, inner, p);
}

/* The patch of a face, -1 inside. */
static int patch_of(const struct polyhedra_faces *f, int face) {
    return face < f->ninternal ? -1 : f->patch[face - f->ninternal];
}

/* p->out <- fluxes at time t through the next faces of a list from `first` on, before `last`: all internal or all of
 * one patch. Returns how many these are. */
static int fluxes_at(const struct local_walk *w, int first, int last, double t, struct points *p) {
    const struct gas *g = w->g;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const int *face = w->l->face + first, patch = patch_of(f, face[0]);
    for (p->n = 0; p->n < BATCH && first + p->n < last && patch_of(f, face[p->n]) == patch; p->n++)
        p->face[p->n] = face[p->n];
    points_frames(g->cells->polyhedra, p);
    states_at(w, 0, t, p);
    if (patch < 0)
        states_at(w, 1, t, p);
    else
        beyond_at(w, t, p);
    struct faces faces = points_primitives(g, p);
    if (cells_fronts_floor(g, p->n, p->face, p->floor)) points_floors(p, &faces);
    g->models.flux->through(&faces, g->models.eos, &g->models.material, g->limits.first_order);
    points_out_of_frames(g, p, p->out);
    if (patch >= 0 && patch_feeds(&g->patches.rules[patch])) points_feed(g, p->n, p->face, w->now[0], p->out);
    return p->n;
}

/* ---- the step ---------------------------------------------------------------------------------------------------- */

/* How many cells the chunk that begins at a cell has. */
static int chunk_cells(const struct gas *g, int at) {
    const int left = g->cells->polyhedra->nown - at;
    return left < BATCH ? left : BATCH;
}

/* Finds the averages now, mirrors of cells that begin a step included; all of them where some carry weight. */
static void look_around(struct local_walk *w, int k) {
    const struct gas *g = w->g;
    const struct cells_local *l = w->l;
    struct polyhedra *m = g->cells->polyhedra;
    polyhedra_fill_start(m, g->nvar, w->U);
    polyhedra_fill_finish(m);
    for (int i = 0; i < m->ncells; i++)
        if (l->level[i] >= k) l->start[i] = w->t;
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < m->ncells; i++) w->now[v][i] = w->U[v][i] + (w->t - l->start[i]) * l->rise[v][i];
    if (g->cells->weight) {
        cells_mirrors(g, 0, m->mirror.n, w->now);
        for (int inner = 1; inner >= 0; inner--) cells_weigh(g, inner, w->now);
        return;
    }
    for (int from = 0, to; from < m->mirror.n; from = to) {
        to = from + 1;
        if (l->level[m->mirror.cell[from]] < k) continue;
        while (to < m->mirror.n && l->level[m->mirror.cell[to]] >= k) to++;
        cells_mirrors(g, from, to, w->now);
    }
}

/* Fits the cells from level k on, whose steps begin now. */
static void begin_cells(struct local_walk *w, int k) {
    struct cells_local *l = w->l;
    const int nnear = w->g->cells->polyhedra->nnear;
    look_around(w, k);
    for (int i = 0; i < nnear; i++) l->due[i] = l->level[i] >= k;
    if (w->g->cells->rest) cells_rest_find(w->g, 0, nnear, (const double *const *)w->now, l->due);
    fit_due(w->g->cells->fit, l->due, (const double *const *)w->now);
}

/* Adds gravity, and the force that balances gas at rest, to the rises of the cells of a chunk from level k on. */
static void pull_chunk(const struct local_walk *w, int at, int k, double (*rise)[BATCH]) {
    const struct gas *g = w->g;
    const int n = chunk_cells(g, at);
    double share[BATCH], *momentum[MAX_DIM];
    if (!g->falling.cells) return;
    for (int i = 0; i < n; i++) share[i] = w->l->level[at + i] >= k ? 1 : 0;
    for (int d = g->components - 1; d >= 0; d--) {
        const double pull = g->falling.gravity[d];
        momentum[d] = rise[d + 1];
        for (int i = 0; i < n; i++) {
            rise[d + 1][i] += w->U[0][at + i] * pull;
            rise[energy_at(g)][i] += w->U[d + 1][at + i] * pull;
        }
    }
    if (g->cells->rest) cells_rest_push(g, at, n, share, 0, momentum);
}

/* Finds the rises of the cells from level k on. */
static void find_rises(struct local_walk *w, int k) {
    struct gas *g = w->g;
    struct cells_local *l = w->l;
    struct polyhedra *m = g->cells->polyhedra;
    double *const *flux = g->cells->flux, sum[MAX_VAR][BATCH];
    struct points p;
    for (int at = l->first[k], n; at < m->face.n; at += n) {
        n = fluxes_at(w, at, m->face.n, w->t, &p);
        for (int v = 0; v < g->nvar; v++)
            for (int i = 0; i < n; i++) flux[v][p.face[i]] = m->face.area[p.face[i]] * p.out[v][i];
    }
    for (int at = 0; at < m->nown; at += BATCH) {
        if (l->chunk[at / BATCH] < k) continue;
        for (int v = 0; v < g->nvar; v++)
            cells_sides_sum(g->cells, at, (const double(*)[BATCH])l->weight, flux[v], flux[v], sum[v]);
        pull_chunk(w, at, k, sum);
        for (int v = 0; v < g->nvar; v++)
            for (int i = at; i < at + BATCH && i < m->nown; i++)
                if (l->level[i] >= k) l->rise[v][i] = sum[v][i - at];
    }
    polyhedra_fill_start(m, g->nvar, l->rise);
    polyhedra_fill_finish(m);
}

/* Adds what passes in a step of level k from now on to what has passed since each cell began its step. */
static void pass_faces(struct local_walk *w, int k) {
    struct gas *g = w->g;
    struct cells_local *l = w->l;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const int end = l->first[k + 1];
    struct points p;
    for (int at = l->first[k], n; at < end; at += n) {
        n = fluxes_at(w, at, end, w->t + 0.5 * l->dt[k], &p);
        for (int side = 0; side < 2; side++)
            for (int i = 0; i < n; i++) {
                const int face = p.face[i];
                const bool amid = w->t > l->start[side ? f->right[face] : f->left[face]];
                const double share = l->dt[k] * f->area[face];
                for (int v = 0; v < g->nvar; v++) {
                    double *sum = &l->passed[side][v][face];
                    *sum = (amid ? *sum : 0) + share * p.out[v][i];
                }
            }
    }
}

/* Adds to what the cells of a chunk from level k on gain in their steps what gravity does at the mean of their states
 * before and behind: the work is then that of the momentum gained, so that gas that falls freely keeps its T. Notes it
 * for the budget. */
static void drop_chunk(const struct local_walk *w, int at, int k, double (*sum)[BATCH]) {
    const struct gas *g = w->g;
    const int n = chunk_cells(g, at), last = energy_at(g);
    double share[BATCH], rho[BATCH], work[BATCH], pushed[MAX_DIM][BATCH] = {{0}}, *push[MAX_DIM];
    if (!g->falling.cells) return;
    for (int i = 0; i < n; i++) {
        const int level = w->l->level[at + i];
        share[i] = level >= k ? w->l->dt[level] : 0;
        rho[i] = w->U[0][at + i] + 0.5 * sum[0][i];
        work[i] = 0;
    }
    for (int d = 0; d < g->components; d++) push[d] = pushed[d];
    if (g->cells->rest) cells_rest_push(g, at, n, share, 1 / w->l->dt[0], push);
    for (int d = g->components - 1; d >= 0; d--)
        for (int i = 0; i < n; i++) {
            const double kick = share[i] * g->falling.gravity[d];
            sum[d + 1][i] += rho[i] * kick + pushed[d][i];
            work[i] += kick * (w->U[d + 1][at + i] + 0.5 * sum[d + 1][i]);
        }
    for (int i = 0; i < n; i++) {
        sum[last][i] += work[i];
        g->falling.dropped[at + i] += work[i];
        if (g->falling.denser) g->falling.denser[at + i] += share[i] * rho[i];
    }
}

/* Ends the steps of the cells of a chunk from level k on. */
static void end_chunk(struct local_walk *w, int at, int k) {
    struct gas *g = w->g;
    const struct cells_local *l = w->l;
    const int n = chunk_cells(g, at);
    double sum[MAX_VAR][BATCH], before[BATCH];
    memcpy(before, w->U[0] + at, (size_t)n * sizeof *before);
    for (int v = 0; v < g->nvar; v++)
        cells_sides_sum(g->cells, at, (const double(*)[BATCH])l->weight, l->passed[0][v], l->passed[1][v], sum[v]);
    drop_chunk(w, at, k, sum);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++)
            if (l->level[at + i] >= k) w->U[v][at + i] += sum[v][i];
    w->count += row_limited(g, n, before, w->U[0] + at, g->limits.flags.cells[0] + at);
}

/* Does a step of the shortest kind, the s-th one. */
static void short_step(struct local_walk *w, int s) {
    struct gas *g = w->g;
    struct cells_local *l = w->l;
    const int first = level_at(l, s), last = level_at(l, s + 1);
    w->t = s * l->dt[l->n - 1];
    if (g->patches.renew) renew_patches(g, w->t0 + w->t);
    begin_cells(w, first);
    find_rises(w, first);
    for (int k = first; k < l->n; k++) {
        if (g->patches.renew) renew_patches(g, w->t0 + w->t + 0.5 * l->dt[k]);
        pass_faces(w, k);
    }
    for (int at = 0; at < g->cells->polyhedra->nown; at += BATCH)
        if (l->chunk[at / BATCH] >= last) end_chunk(w, at, last);
    for (int i = 0; i < g->cells->polyhedra->nown; i++) g->counts.computed += l->level[i] >= first;
}

long cells_local(struct gas *g, const struct state *from, const struct state *to, double dt) {
    struct cells *c = g->cells;
    struct cells_local *l = c->local;
    const struct polyhedra *m = c->polyhedra;
    struct local_walk w = {.g = g, .l = l, .t0 = g->step.t};
    const long computed = g->counts.computed;
    cells_lines(g, to, w.U);
    cells_lines(g, &g->V, w.now);
    memcpy(to->block[0], from->block[0], (size_t)g->nvar * (size_t)m->size * sizeof(double));
    if (!find_levels(g, dt)) w.count = 1;
    for (int i = 0; i < m->size; i++) l->start[i] = 0;
    for (int v = 0; v < g->nvar; v++) /* an attempt that failed may have left NaN, and 0 times NaN is none */
        memset(l->rise[v], 0, (size_t)m->size * sizeof(double));
    drop_begin(g);
    if (c->rest) cells_rest_forget(g);
    for (int s = 0; s < 1 << (l->n - 1); s++) short_step(&w, s);
    for (int v = 0; v < g->nvar; v++)
        for (int i = m->face.ninternal; i < m->face.n; i++) c->flux[v][i] = l->passed[1][v][i] / dt;
    if (g->books.tally) cells_tally_stage(g);
    g->counts.all += g->counts.computed - computed;
    return w.count;
}
