/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Advances soft grains in pieces, samples them and keeps their account (dem_run.h). */
#include "solvers/dem/dem_run.h"

#include "solvers/grains/grains_box.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PIECE = 0.15; /* s of the clock: so soon a signal is heard */
enum { FIRST_PIECE = 200 };

void dem_run_free(struct dem_run *r) {
    dem_engine_free(r->engine);
    averages_free(r->averages);
    dem_moment_free(&r->moment);
    dem_state_free(&r->saved);
    grains_start_free(&r->start);
    grains_mesh_free(r->mesh);
    grains_models_free(r->models);
    free(r->stress);
}

static struct coarse_grid grid_of(const struct dem_run *r) {
    struct coarse_grid g = grains_grid(r->setup, r->models, r->mesh);
    g.rough = true;
    return g;
}

double dem_run_energy(const struct dem_run *r) {
    const struct dem_sums *s = &r->sums;
    return s->kinetic + s->spin + s->potential + s->normal_spring + s->tangent_spring;
}

double dem_run_friction(const struct dem_run *r) {
    return r->account.drag - r->account.tangent - r->sums.tangent_spring;
}

struct averages_moment dem_run_averaged(const struct dem_run *r) {
    const struct dem_moment *m = &r->moment;
    return (struct averages_moment){.t = r->moment_t,
                                    .n = m->n,
                                    .x = (const double(*)[3])m->x,
                                    .u = (const double(*)[3])m->u,
                                    .spin = (const double(*)[3])m->spin,
                                    .ncontacts = m->ncontacts,
                                    .contact = r->stress};
}

/* Computes what follows from the moment. */
static status digest(struct dem_run *r) {
    const struct dem_moment *m = &r->moment;
    if (m->ncontacts > r->stresses) {
        free(r->stress);
        r->stresses = 0;
        TRY(allocate(&r->stress, m->ncontacts, sizeof *r->stress, "contacts"));
        r->stresses = m->ncontacts;
    }
    dem_stresses(m, r->stress);
    dem_sums(&r->law, m, &r->sums);
    return OK;
}

/* ---- start ---- */

static double *list_of(const struct dem_moment *m, int k) {
    return k == 0 ? m->x[0] : k == 1 ? m->u[0] : m->spin[0];
}

static status take_saved(struct dem_run *r) {
    const struct dem_state *s = &r->saved;
    double law[DEM_LAW];
    TRY(dem_moment_make(s->nold, &r->moment));
    r->moment.n = s->n;
    memcpy(r->moment.id, s->id, (size_t)s->n * sizeof *s->id);
    for (int k = 0; k < 3; k++) memcpy(list_of(&r->moment, k), s->list[k], 3 * (size_t)s->n * sizeof(double));
    dem_state_law(&r->law, law);
    r->changed = memcmp(law, s->law, sizeof law) != 0;
    if (!r->changed) r->account = s->account;
    return OK;
}

static status overlaps(const struct dem_run *r, int i, const char *patch) {
    const double *x = r->moment.x[i];
    return fail(
        ERR_INPUT,
        "%s/%s: grain %d at (%g %g %g) overlaps a wall of patch %s; let alpha be 0 within half a diameter of walls "
        "inside of the box",
        r->setup->dir, r->setup->start.folder, r->moment.id[i], x[0], x[1], x[2], patch);
}

static bool is_inside(const struct dem_run *r, const double x[3]) {
    bool inside;
    if (!r->mesh) return grains_box_cell(r->setup, NULL, x) >= 0;
    (void)r->mesh->base.locate(&r->mesh->base, x, &inside);
    return inside;
}

static status check_overlaps(const struct dem_run *r) {
    const struct dem_moment *m = &r->moment;
    for (int i = 0; i < m->n; i++) {
        if (!is_inside(r, m->x[i])) return overlaps(r, i, "behind which the mesh has a hole");
        for (int j = 0; j < r->walls.n; j++) {
            double near[3], away = 0;
            dem_wall_nearest(&r->walls, j, m->x[i], near);
            for (int k = 0; k < r->walls.dim; k++) away += (m->x[i][k] - near[k]) * (m->x[i][k] - near[k]);
            if (sqrt(away) < (0.5 - 1e-3) * r->law.diameter)
                return overlaps(r, i, r->setup->mesh->patch[r->walls.wall[j].patch].name);
        }
    }
    return OK;
}

static bool is_hole(const struct lattice *l, long i, int k, int by) {
    long stride = 1;
    for (int a = 0; a < k; a++) stride *= l->n[a];
    const long at = i / stride % l->n[k] + by;
    return at >= 0 && at < l->n[k] && l->cell[i + by * stride] < 0;
}

/* Empties cells beside holes of the lattice: grains are put anywhere in a cell, and walls of the box alone are heeded.
 */
static void keep_off_holes(struct dem_run *r) {
    const struct lattice *l = r->setup->lattice;
    const long cells = r->mesh ? 0 : (long)l->n[0] * l->n[1] * l->n[2];
    for (long i = 0; r->start.alpha && i < cells; i++)
        for (int k = 0; k < l->dim; k++)
            if (is_hole(l, i, k, -1) || is_hole(l, i, k, 1)) r->start.alpha[i] = 0;
}

static status place(struct dem_run *r) {
    const struct dem_walls *w = &r->walls;
    struct grain_box box = {.dim = w->dim, .facets = r->mesh ? r->mesh->facets : NULL};
    struct grain_start p = {.n = 0};
    for (int k = 0; k < w->dim; k++) {
        box.low[k] = w->low[k];
        box.high[k] = w->high[k];
        box.periodic[k] = w->periodic[k];
        box.restitution[k][0] = box.restitution[k][1] = 1;
    }
    keep_off_holes(r);
    status e = grain_start_make(r->setup, r->models, &box, &r->start, &p);
    if (!e) e = dem_moment_make(p.n, &r->moment);
    for (int i = 0; !e && i < p.n; i++)
        for (int k = 0; k < 3; k++) {
            r->moment.x[i][k] = k < w->dim ? p.x[i][k] : 0.5 * (w->low[k] + w->high[k]);
            r->moment.u[i][k] = k < w->dim ? p.u[i][k] : 0;
            r->moment.spin[i][k] = p.spin ? p.spin[i][k] : 0;
        }
    r->from_cloud = p.from_cloud;
    r->packing = p.packing;
    free(p.x);
    free(p.u);
    free(p.spin);
    return e ? e : check_overlaps(r);
}

static status make_averages(struct dem_run *r) {
    const struct grains_models *m = r->models;
    const struct coarse_grid grid = grid_of(r);
    const bool goes_on = r->saved.nold && !r->changed;
    return status_note(averages_resume(&grid, m->window, m->samples, r->setup->start.t, r->moment.nold,
                                       goes_on ? &r->saved.averages : NULL, &r->averages, &r->kept),
                       "%s: coarseGraining", dict_path(m->properties));
}

status dem_run_start(struct dem_run *r) {
    const bool saved = r->saved.nold > 0;
    TRY(saved ? take_saved(r) : place(r));
    r->moment_t = r->setup->start.t;
    TRY(digest(r));
    if (!saved || r->changed) r->account.energy = dem_run_energy(r);
    r->account.t = r->setup->start.t;
    TRY(make_averages(r));
    dem_state_free(&r->saved);
    grains_start_drop(&r->start);
    return OK;
}

/* ---- pieces ---- */

/* Fails if grains that a user placed overlap. */
static status check_pairs(struct dem_run *r) {
    const struct dem_moment *m = &r->moment;
    dem_engine_pace(r->engine, r->account.t, r->longest, true);
    TRY(dem_engine_run(r->engine, 0));
    TRY(dem_engine_moment(r->engine, &r->moment));
    for (long i = 0; i < m->ncontacts; i++) {
        const struct dem_contact *c = &m->contact[i];
        if (c->b < 0 || c->overlap < 1e-3 * r->law.diameter) continue;
        return fail(
            ERR_INPUT,
            "%s/%s/lagrangian/grains/positions: grains %d and %d overlap by %.3g diameters at the start; 1e-3 is "
            "allowed",
            r->setup->dir, r->setup->start.folder, m->id[c->a], m->id[c->b], c->overlap / r->law.diameter);
    }
    return digest(r);
}

static status launch(struct dem_run *r) {
    const struct setup *s = r->setup;
    struct lammps_abilities can;
    char folder[TIME_PATH + 16], restart[2 * TIME_PATH];
    snprintf(folder, sizeof folder, "%s/dem", s->dir);
    snprintf(restart, sizeof restart, "%s/%s/uniform/lammps", s->dir, s->start.folder);
    if (!r->lammps) TRY(lammps_ask(&can));
    TRY(case_make_folders(s, folder));
    const bool goes_on = !r->changed && field_exists(restart);
    TRY(dem_engine_make(&r->law, s->ranks, s->medium->asked, folder, &r->moment, goes_on ? restart : NULL, &r->engine));
    return r->from_cloud ? check_pairs(r) : OK;
}

/* Returns how many steps there are to be in a time. In the windows of averages all are as long as in half the time
 * between two samples: a new length makes LAMMPS begin once more. */
static double steps_in(const struct dem_run *r, double time) {
    const struct averages_mark *mark = averages_mark(r->averages);
    const double half = mark->window / (2. * mark->samples), halves = half > 0 ? round(time / half) : 0;
    if (halves >= 1 && fabs(time - halves * half) < 1e-9 * half)
        return halves * fmax(1, ceil(half / r->longest - 1e-9));
    return fmax(1, ceil(time / r->longest - 1e-9));
}

/* Plans equal steps from now to a time. */
static void plan(struct dem_run *r, double to) {
    struct dem_span *p = &r->span;
    if (p->done < p->n && p->to == to) return;
    const double t = r->account.t, n = steps_in(r, to - t);
    *p = (struct dem_span){.from = t, .to = to, .dt = (to - t) / n, .n = (long)n};
    dem_engine_pace(r->engine, t, p->dt, false);
}

static long piece_steps(const struct dem_run *r) {
    const long left = r->span.n - r->span.done;
    const double most = r->pace > 0 ? PIECE * r->pace : FIRST_PIECE;
    return left < most ? left : most > 1 ? (long)most : 1;
}

static status sample(struct dem_run *r) {
    const struct averages_mark *mark = averages_mark(r->averages);
    const bool closes = mark->taken == mark->samples;
    if (!closes) {
        const double every = mark->window / mark->samples;
        TRY(dem_run_look(r));
        r->account.normal += every * r->sums.normal_loss;
        r->account.tangent += every * r->sums.tangent_loss;
        r->account.drag += every * r->sums.drag;
        r->account.work += every * r->sums.work;
    }
    const struct averages_moment now = dem_run_averaged(r);
    averages_take_soft(r->averages, &now);
    return OK;
}

status dem_run_piece(struct dem_run *r, double until, bool *sampled) {
    /* below the slack two times are the same, computed in two ways */
    const double due = averages_next(r->averages), slack = 1e-12 * fabs(until);
    const double target = due < until - slack ? due : until;
    struct dem_span *p = &r->span;
    *sampled = false;
    if (!r->engine) TRY(launch(r));
    if (target > r->account.t) {
        plan(r, target);
        const long steps = piece_steps(r);
        const double clock = clock_now();
        TRY(dem_engine_run(r->engine, steps));
        const double spent = clock_now() - clock;
        r->pace = (double)steps / spent;
        r->spent += spent;
        r->steps += steps;
        p->done += steps;
        r->account.t = p->done == p->n ? p->to : p->from + (double)p->done * p->dt;
    }
    if (r->account.t < target || due > target + slack) return OK;
    *sampled = averages_mark(r->averages)->taken < averages_mark(r->averages)->samples;
    return sample(r);
}

status dem_run_look(struct dem_run *r) {
    if (r->moment_t == r->account.t || !r->engine) return OK;
    const double clock = clock_now();
    TRY(dem_engine_moment(r->engine, &r->moment));
    r->moment_t = r->account.t;
    r->sampled += clock_now() - clock;
    return digest(r);
}

status dem_run_save(struct dem_run *r, const char *folder, const char *location, struct checksums *sums) {
    char path[2 * TIME_PATH], where[TIME_NAME + 16];
    struct file_sum sum;
    TRY(dem_run_look(r));
    struct dem_state s = {.n = r->moment.n, .nold = r->moment.nold, .account = r->account, .id = r->moment.id};
    for (int k = 0; k < 3; k++) s.list[k] = list_of(&r->moment, k);
    averages_save(r->averages, &s.averages);
    dem_state_law(&r->law, s.law);
    snprintf(path, sizeof path, "%s/uniform/softGrains", folder);
    snprintf(where, sizeof where, "%s/uniform", location);
    TRY(dem_state_write(&s, path, where, r->setup->control->format.compress, &sum));
    TRY(checksums_add(sums, "uniform/softGrains", sum));
    if (!r->engine) return OK; /* the run begins from the grains, and so does one that starts here */
    snprintf(path, sizeof path, "%s/uniform/lammps", folder);
    TRY(dem_engine_save(r->engine, path));
    r->span.n = r->span.done; /* the steps behind are planned anew, as a restart plans them */
    TRY(file_sum_read(path, &sum));
    return checksums_add(sums, "uniform/lammps", sum);
}
