/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes, resumes and advances hard grains (grains.h): checks of the input, the loop over events, and what callers
 * ask. */
#include "libcore/grains/grains_private.h"

#include <stdlib.h>
#include <string.h>

void grains_free(struct grains *g) {
    if (!g) return;
    free(g->grain);
    free(g->event);
    free(g->id);
    free(g->order);
    free(g->list);
    free(g->vacant);
    free(g->kind);
    for (int k = 0; k < 3; k++) free(g->cells.row[k]);
    free(g->cells.slot);
    free(g->cells.next);
    facet_cells_free(&g->walls);
    free(g->impulse);
    calendar_free(g->queue);
    free(g);
}

static status check_box(const struct grain_box *box, const struct grain_law *law) {
    const double d = law->diameter;
    if (box->dim != 2 && box->dim != 3) return fail(ERR_INPUT, "grains move in 2 or 3 dimensions, not in %d", box->dim);
    if (!(d > 0 && d < HUGE_VAL)) return fail(ERR_INPUT, "a diameter of %g m; it must be above 0", d);
    if (!(law->mass > 0 && law->mass < HUGE_VAL))
        return fail(ERR_INPUT, "a mass of %g kg; it must be above 0", law->mass);
    if (!(law->restitution >= 0 && law->restitution <= 1))
        return fail(ERR_INPUT, "a restitution of %g; it must lie in 0 to 1", law->restitution);
    if (!(law->threshold >= 0))
        return fail(ERR_INPUT, "a threshold of %g m/s; it must not be negative", law->threshold);
    if (box->facets && 0.5 * d > box->facets->space.reach * (1 + 1e-9))
        return fail(ERR_INPUT, "the walls are made for grains of at most %g m", 2 * box->facets->space.reach);
    for (int k = 0; k < box->dim; k++) {
        double length = box->high[k] - box->low[k];
        if (!(length < HUGE_VAL && isfinite(box->low[k])))
            return fail(ERR_INPUT, "the box is not finite along axis %d", k);
        if (box->periodic[k] && !(length >= 3 * d * (1 + 1e-9)))
            return fail(ERR_INPUT,
                        "the box is %g m long along axis %d, which is periodic; grains of %g m need at least %g m",
                        length, k, d, 3 * d);
        if (!box->periodic[k] && !(length >= d))
            return fail(ERR_INPUT, "the walls of axis %d are %g m apart; a grain takes %g m", k, length, d);
        for (int side = 0; side < 2 && !box->periodic[k]; side++)
            if (!(box->restitution[k][side] >= 0 && box->restitution[k][side] <= 1))
                return fail(ERR_INPUT, "a wall's restitution of %g; it must lie in 0 to 1", box->restitution[k][side]);
        if (!(isfinite(law->gravity[k]) && isfinite(box->shake[k]) && isfinite(box->omega) && isfinite(box->phase)))
            return fail(ERR_INPUT, "gravity or the shaking along axis %d is not finite", k);
        if (law->growth != 0 && (law->gravity[k] != 0 || is_shaken(box, k)))
            return fail(ERR_INPUT, "grains can grow only in a box at rest without gravity");
    }
    return OK;
}

double grains_volume(const struct grain_box *box) {
    double volume = 1;
    for (int k = 0; k < box->dim; k++) volume *= box->high[k] - box->low[k];
    return box->facets ? box->facets->space.volume : volume;
}

/* Sheared boxes are periodic along all axes, at rest, without gravity, and have four cells along an axis. */
static status check_shear(const struct grain_box *box, const struct grain_law *law) {
    if (box->shear == 0) return OK;
    if (!isfinite(box->shear) || law->growth != 0) return fail(ERR_INPUT, "a shear rate of %g 1/s", box->shear);
    for (int k = 0; k < box->dim; k++) {
        const double length = box->high[k] - box->low[k];
        if (!box->periodic[k] || box->shake[k] != 0 || law->gravity[k] != 0)
            return fail(ERR_INPUT, "a sheared box is periodic along all axes, at rest and without gravity");
        if (k < 2 && !(length >= 4 * law->diameter * (1 + 1e-9)))
            return fail(ERR_INPUT, "a sheared box is at least 4 diameters, %g m, long along axis %d; it is %g m",
                        4 * law->diameter, k, length);
    }
    return OK;
}

double grains_mean_size(const struct grain_kinds *k, int dim) {
    double sum = 0;
    for (int i = 0; i < k->n; i++)
        sum += (k->first[i + 1] - k->first[i]) * (dim == 2 ? 1 : k->size[i]) * k->size[i] * k->size[i];
    return k->n ? sum / k->first[k->n] : 1;
}

double grains_mean_mass(const struct grain_kinds *k) {
    double sum = 0;
    for (int i = 0; i < k->n; i++) sum += (k->first[i + 1] - k->first[i]) * k->mass[i];
    return k->n ? sum / k->first[k->n] : 1;
}

static status check_number(const struct grain_box *box, const struct grain_law *law, int n) {
    const double pi = 3.14159265358979323846, d = law->diameter;
    const double share = grains_mean_size(&law->kinds, box->dim);
    double volume = grains_volume(box), grain = (box->dim == 2 ? pi / 4 * d * d : pi / 6 * d * d * d) * share,
           most = law->kinds.n    ? 1
                  : box->dim == 2 ? 0.9069
                                  : 0.7405;
    if (n < 1) return fail(ERR_INPUT, "there are no grains; at least one is needed");
    if (!box->fed && n * grain > most * volume)
        return fail(ERR_INPUT,
                    "%d grains would fill %.4f of the box; %.4f is the densest of all packings (at most %.0f grains)",
                    n, n * grain / volume, most, floor(most * volume / grain));
    return OK;
}

static void set_scales(struct grains *g) {
    double all = 0, omega = g->box.omega;
    for (int k = 0; k < 3; k++) {
        bool periodic = k < g->dim && g->box.periodic[k];
        g->period[k] = periodic ? g->box.high[k] - g->box.low[k] : 0;
        g->half[k] = periodic ? 0.5 * g->period[k] : HUGE_VAL;
        if (g->box.shear != 0 && k == 1) { /* grains_shear.c knows its images */
            g->period[k] = 0;
            g->half[k] = HUGE_VAL;
        }
        g->pull[k] = k < g->dim ? fabs(g->law.gravity[k]) + fabs(g->box.shake[k]) * omega * omega : 0;
        all += g->pull[k];
    }
    for (int k = 0; k < g->dim; k++) {
        g->falls = g->falls || g->law.gravity[k] != 0;
        g->swings = g->swings || is_shaken(&g->box, k);
    }
    g->pull_all = sqrt(g->pull[0] * g->pull[0] + g->pull[1] * g->pull[1] + g->pull[2] * g->pull[2]);
    g->gentle = 1e-7 * sqrt(all * g->law.diameter);
}

status grains_make_empty(const struct grain_box *box, const struct grain_law *law, int n, double t,
                         struct grains **out) {
    struct grains *g;
    TRY(check_box(box, law));
    TRY(check_shear(box, law));
    TRY(check_number(box, law, n));
    TRY(allocate(&g, 1, sizeof *g, "grains"));
    *out = g;
    *g = (struct grains){.box = *box, .law = *law, .n = n, .dim = box->dim, .start = t, .time = t};
    for (int k = g->dim; k < 3; k++) {
        g->law.gravity[k] = g->box.shake[k] = 0;
        g->box.periodic[k] = false;
    }
    set_scales(g);
    TRY(allocate(&g->grain, n, sizeof *g->grain, "grains"));
    TRY(allocate(&g->event, n, sizeof *g->event, "events"));
    TRY(allocate(&g->id, n, sizeof *g->id, "grains"));
    TRY(allocate(&g->order, n, sizeof *g->order, "grains"));
    TRY(allocate(&g->list, n + (long)ROOM, sizeof *g->list, "neighbours"));
    TRY(calendar_make(n, &g->queue));
    g->opens = box->facets && box->facets->opens && !box->shut;
    if (grains_rows(box) > 0) TRY(allocate(&g->impulse, grains_rows(box), sizeof *g->impulse, "walls"));
    if (box->fed) TRY(grains_vacant_make(g));
    if (law->kinds.n) TRY(allocate(&g->kind, n, sizeof *g->kind, "grains"));
    return grains_cells_make(g);
}

double grains_wrap(const struct grain_box *box, int k, double x) {
    double length = box->high[k] - box->low[k];
    x -= length * floor((x - box->low[k]) / length);
    return x < box->low[k] || x >= box->high[k] ? box->low[k] : x;
}

static status place(struct grains *g, int i, const double x[3], const double u[3]) {
    struct grain *p = &g->grain[i];
    double radius = 0.5 * g->law.diameter * grains_size(g, i), slack = 1e-9 * g->law.diameter;
    p->t = g->time;
    for (int k = 0; k < g->dim; k++) {
        bool periodic = g->box.periodic[k];
        double room = periodic || g->opens ? 0 : radius;
        if (!(x[k] >= g->box.low[k] + room - slack && x[k] <= g->box.high[k] - room + slack))
            return fail(ERR_INPUT,
                        "grain %d is outside: its centre is at (%.9g %.9g %.9g), axis %d allows %.9g to %.9g", i, x[0],
                        x[1], g->dim > 2 ? x[2] : 0, k, g->box.low[k] + room, g->box.high[k] - room);
        if (!isfinite(u[k])) return fail(ERR_INPUT, "grain %d has no finite velocity", i);
        struct swing w = grains_swing(&g->box, k, g->time);
        p->x[k] = periodic ? grains_wrap(&g->box, k, x[k] + w.s) : x[k] + w.s;
        p->u[k] = u[k] + w.v;
    }
    g->event[i].cell = grains_cell_of(g, p->x);
    grains_cell_enter(g, i);
    return OK;
}

static status overlap(const struct grains *g, int a, int b, double distance) {
    const double *x = g->grain[a].x, *y = g->grain[b].x;
    if (a > b) return overlap(g, b, a, distance);
    return fail(ERR_INPUT,
                "grains %d at (%.9g %.9g %.9g) and %d at (%.9g %.9g %.9g) overlap: they are %.9g m apart, their "
                "diameter is %.9g m",
                a, x[0], x[1], x[2], b, y[0], y[1], y[2], distance, g->law.diameter * grains_pair_size(g, a, b));
}

static status check_overlap(const struct grains *g, int i) {
    struct grain_block b;
    double least = g->law.diameter * (1 - 1e-9);
    grains_block(&g->cells, g->event[i].cell, STAYS, &b);
    for (int q = grains_occupants(&g->cells, &b, g->list) - 1; q >= 0; q--) {
        double square = 0, r[3], v[3];
        int j = (int)g->list[q];
        for (int k = 0; k < 3; k++) r[k] = nearest(g, k, g->grain[j].x[k] - g->grain[i].x[k]);
        if (g->box.shear != 0) (void)grains_sheared(g, &g->grain[i], &g->grain[j], g->time, r, v);
        for (int k = 0; k < 3; k++) square += r[k] * r[k];
        const double near = least * grains_pair_size(g, i, j);
        if (j != i && square < near * near) return overlap(g, i, j, sqrt(square));
    }
    return OK;
}

/* Fails if a grain cuts a facet, or lies behind the facets; x is in the frame of the box. */
static status check_facets(const struct grains *g, int i, const double x[3]) {
    const double radius = 0.5 * g->law.diameter * grains_size(g, i), slack = 1e-9 * g->law.diameter;
    const struct facets *f = g->box.facets;
    double at[3] = {0};
    for (int k = 0; k < g->dim; k++) at[k] = g->box.periodic[k] ? grains_wrap(&g->box, k, x[k]) : x[k];
    const double distance = facet_cells_nearest(f, &g->walls, at, !g->opens);
    if (distance < radius - slack)
        return fail(ERR_INPUT,
                    "grain %d at (%.9g %.9g %.9g) cuts a wall: its centre is %.9g m from it, and its radius is %.9g m",
                    i, x[0], x[1], at[2], distance, radius);
    if (facet_cells_inside(f, &g->walls, at, g->opens ? 1e-6 * radius : radius - slack)) return OK;
    return fail(ERR_INPUT, "grain %d at (%.9g %.9g %.9g) is outside the walls", i, x[0], x[1], at[2]);
}

status grains_make(const struct grain_box *box, const struct grain_law *law, int n, const double (*x)[3],
                   const double (*u)[3], double t, struct grains **out) {
    struct grains *g = NULL;
    status s = grains_make_empty(box, law, n, t, &g);
    for (int i = 0; i < n && !s; i++) g->id[i] = i;
    if (!s) grains_set_kinds(g);
    for (int i = 0; i < n && !s; i++) s = place(g, i, x[i], u[i]);
    for (int i = 0; i < n && !s; i++) s = check_overlap(g, i);
    for (int i = 0; i < n && !s && box->facets; i++) s = check_facets(g, i, x[i]);
    if (s) {
        grains_free(g);
        return s;
    }
    grains_sort(g);
    grains_predict_all(g);
    *out = g;
    return OK;
}

/* Checks that a run can go on with a saved grain: nothing in it leads outside the arrays. */
static status check_saved(const struct grains *g, int i) {
    const struct grain *p = &g->grain[i];
    const struct grain_event *e = &g->event[i];
    bool good = isfinite(p->t) && p->t <= g->time && e->cell >= 0 && !isnan(p->impact) && p->impact >= p->t &&
                e->partner < g->n;
    for (int k = 0; k < 3 && good; k++) {
        int number = cell_number(&g->cells, e->cell, k);
        double slack = 1e-6 * g->cells.width[k];
        good = number < g->cells.n[k] && isfinite(p->u[k]) &&
               p->x[k] >= grains_cell_edge(&g->cells, k, number) - slack &&
               p->x[k] <= grains_cell_edge(&g->cells, k, number + 1) + slack;
    }
    int b = e->partner;
    if (b == GONE && g->opens) good = isfinite(p->t) && p->impact == HUGE_VAL && e->cell >= 0;
    good =
        good && (b >= 0 || (b == GONE && g->opens) || (b == NO_PARTNER && p->impact == HUGE_VAL) || b == LOOK_AGAIN ||
                 (g->box.facets ? grains_facet_of(&g->box, b) != NULL : b < 0 && b >= -2 * g->dim));
    if (!good) return fail(ERR_INPUT, "saved grain %d does not belong to this box, or its file is damaged", i);
    return OK;
}

static status check_ids(const struct grains *g) {
    char *seen;
    status s = OK;
    TRY(allocate(&seen, g->n, 1, "grains"));
    for (int i = 0; i < g->n && !s; i++) {
        int id = g->id[i];
        if (id < 0 || id >= g->n || seen[id]++)
            s = fail(ERR_INPUT, "the number %d of saved grain %d is twice there or too large", id, i);
    }
    free(seen);
    return s;
}

/* Fills the queue from the grains and their events. */
static void schedule_all(struct grains *g) {
    for (int i = 0; i < g->n; i++) calendar_set(g->queue, i, grains_schedule(g, i));
    calendar_start(g->queue, g->time);
}

static status resume(struct grains *g, const struct grain_save *save) {
    if (g->law.growth != 0) return fail(ERR_INPUT, "grains that grow cannot be resumed");
    memcpy(g->grain, save->grain, (size_t)g->n * sizeof *g->grain);
    memcpy(g->event, save->event, (size_t)g->n * sizeof *g->event);
    memcpy(g->id, save->id, (size_t)g->n * sizeof *g->id);
    TRY(check_ids(g));
    if (save->kind)
        memcpy(g->kind, save->kind, (size_t)g->n);
    else
        grains_set_kinds(g);
    for (int i = 0; i < g->n; i++) TRY(check_saved(g, i));
    grains_cells_fill(g);
    grains_vacant_find(g);
    schedule_all(g);
    return OK;
}

status grains_resume(const struct grain_box *box, const struct grain_law *law, const struct grain_save *save,
                     struct grains **out) {
    struct grains *g = NULL;
    status s = grains_make_empty(box, law, save->n, save->t, &g);
    if (!s) s = resume(g, save);
    if (s) {
        grains_free(g);
        return s;
    }
    g->counts = *save->counts;
    if (g->impulse && save->impulse) memcpy(g->impulse, save->impulse, (size_t)grains_rows(box) * sizeof *g->impulse);
    grains_set_sorting(g);
    *out = g;
    return OK;
}

/* Prefetches the memory that coming events will touch: of a later event the grain, of the next one its partner and
 * cells. */
static void fetch(const struct grains *g) {
    const struct grain_cells *c = &g->cells;
    struct grain_block b;
    int next = calendar_next(g->queue, 2), later = calendar_next(g->queue, 4);
    if (later >= 0) {
        __builtin_prefetch(&g->grain[later], 1);
        __builtin_prefetch(&g->event[later], 1);
    }
    if (next < 0) return;
    int partner = g->event[next].partner;
    if (partner >= 0) {
        __builtin_prefetch(&g->grain[partner], 1);
        __builtin_prefetch(&g->event[partner], 1);
    }
    grains_block(c, g->event[next].cell, STAYS, &b);
    for (int z = 0; z < b.to[2]; z++)
        for (int corner = 0; corner < 4; corner++) { /* two by two cells share a line of the cache */
            long q = b.around[0][corner & 2] + b.around[1][2 * (corner & 1)] + b.around[2][z];
            __builtin_prefetch(c->slot + q * SLOTS);
        }
}

/* Works off the first event, which is grain i's. */
static void take(struct grains *g, int i, double t, struct grain_observer *observer) {
    struct grain *p = &g->grain[i];
    const struct grain_event e = g->event[i];
    if (g->n > CACHED) fetch(g);
    int exit = t < p->impact ? grains_exit(g, i) : STAYS;
    bring(g, p, t);
    if (exit != STAYS) {
        grains_cell_cross(g, i, exit);
        grains_predict_beyond(g, i, t, exit);
    } else if (e.partner >= 0 && g->event[e.partner].changes == e.known) {
        bring(g, &g->grain[e.partner], t);
        grains_collide(g, i, e.partner, t, observer);
        grains_predict(g, i, t);
        grains_predict(g, e.partner, t);
        if (g->counts.pairs != g->sort_at) return;
        grains_sort(g);
        schedule_all(g);
    } else {
        if (e.partner < 0 && e.partner >= -6) grains_rebound(g, i, e.partner, t, observer);
        if (e.partner <= FIRST_FACET) {
            if (g->opens && grains_facet_of(&g->box, e.partner)->open) {
                grains_depart(g, i, e.partner);
                return;
            }
            grains_rebound_facet(g, i, e.partner, t, observer);
        }
        grains_predict(g, i, t);
    }
}

/* Makes wider cells for grains that have grown to the width of the old ones; returns false if there is no room. */
static bool regrow(struct grains *g) {
    g->time = g->outgrown;
    for (int i = 0; i < g->n; i++) bring(g, &g->grain[i], g->time);
    if (!grains_cells_widen(g)) return false;
    grains_predict_all(g);
    return true;
}

double grains_advance(struct grains *g, double until, int64_t most, struct grain_observer *observer) {
    for (int64_t taken = 0; taken < most; taken++) {
        int i = calendar_first(g->queue);
        double t = calendar_time(g->queue, i);
        if (g->outgrown < HUGE_VAL && g->outgrown <= fmin(t, until)) {
            if (!regrow(g)) return g->time;
            continue;
        }
        if (!(t <= until) || t == HUGE_VAL) { /* never: nothing will happen, time stays where it is */
            if (until < HUGE_VAL) g->time = fmax(until, g->time);
            return g->time;
        }
        g->counts.events++;
        g->time = t;
        take(g, i, t, observer);
    }
    return g->time;
}

void grains_at(const struct grains *g, double t, double (*x)[3], double (*u)[3]) {
    struct swing w[3];
    for (int k = 0; k < 3; k++) w[k] = grains_swing(&g->box, k, t);
    for (int i = 0; i < g->n; i++) {
        double *to = x[g->id[i]], *speed = u[g->id[i]];
        if (is_gone(g, i)) {
            for (int k = 0; k < 3; k++) {
                to[k] = NAN;
                speed[k] = 0;
            }
            continue;
        }
        fly(g, &g->grain[i], t, to, speed);
        for (int k = 0; k < 3; k++) {
            to[k] -= w[k].s;
            speed[k] -= w[k].v;
            if (g->box.shear != 0 && k == 1) /* it has left by round-off alone */
                to[k] = fmax(g->box.low[k], fmin(to[k], g->box.high[k]));
            else if (g->box.periodic[k])
                to[k] = grains_wrap(&g->box, k, to[k]);
        }
    }
}

void grains_energy(const struct grains *g, double *kinetic, double *potential, double momentum[3]) {
    struct swing w[3];
    double speeds = 0, height = 0, sum[3] = {0};
    for (int k = 0; k < 3; k++) w[k] = grains_swing(&g->box, k, g->time);
    for (int i = 0; i < g->n; i++) {
        double x[3], u[3];
        if (is_gone(g, i)) continue;
        fly(g, &g->grain[i], g->time, x, u);
        const double part = g->kind ? g->law.kinds.mass[g->kind[i]] : 1;
        for (int k = 0; k < 3; k++) {
            u[k] -= w[k].v;
            speeds += part * (u[k] * u[k]);
            height -= part * (g->law.gravity[k] * (x[k] - w[k].s));
            sum[k] += part * u[k];
        }
    }
    *kinetic = 0.5 * g->law.mass * speeds;
    *potential = g->law.mass * height;
    for (int k = 0; k < 3; k++) momentum[k] = g->law.mass * sum[k];
}

/* Returns the velocity along axis 0 of the mean shear at x; 0 in a box that is not sheared. */
static double shear_at(const struct grains *g, const double x[3]) {
    return g->box.shear != 0 ? g->box.shear * (x[1] - 0.5 * (g->box.low[1] + g->box.high[1])) : 0;
}

void grains_kinds_T(const struct grains *g, double T[GRAIN_KINDS]) {
    double kinetic, potential, mean[3], all = 0;
    int count[GRAIN_KINDS] = {0};
    grains_energy(g, &kinetic, &potential, mean);
    for (int k = 0; k < GRAIN_KINDS; k++) T[k] = 0;
    for (int i = 0; i < g->n; i++) {
        double x[3], u[3];
        if (is_gone(g, i)) continue;
        fly(g, &g->grain[i], g->time, x, u);
        all += grains_mass(g, i);
        mean[0] -= grains_mass(g, i) * shear_at(g, x);
    }
    for (int i = 0; i < g->n && g->kind; i++) {
        double x[3], u[3];
        if (is_gone(g, i)) continue;
        fly(g, &g->grain[i], g->time, x, u);
        u[0] -= shear_at(g, x);
        count[g->kind[i]]++;
        for (int k = 0; k < g->dim; k++) {
            const double away = u[k] - grains_swing(&g->box, k, g->time).v - mean[k] / all;
            T[g->kind[i]] += away * away / g->dim;
        }
    }
    for (int k = 0; k < GRAIN_KINDS; k++) T[k] /= count[k] > 0 ? count[k] : 1;
}

double grains_thermal(const struct grains *g) {
    double mean[3] = {0}, square = 0, all = 0;
    for (int i = 0; i < g->n; i++) all += g->kind ? g->law.kinds.mass[g->kind[i]] : 1;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < g->n; i++) {
            double x[3], u[3];
            fly(g, &g->grain[i], g->time, x, u);
            const double part = g->kind ? g->law.kinds.mass[g->kind[i]] : 1;
            u[0] -= shear_at(g, x);
            for (int k = 0; k < 3; k++) {
                mean[k] += pass ? 0 : part * u[k] / all;
                square += pass ? part * ((u[k] - mean[k]) * (u[k] - mean[k])) : 0;
            }
        }
    return 0.5 * g->law.mass * square;
}
double grains_total_mass(const struct grains *g) {
    double sum = 0;
    if (!g->kind) return g->law.mass * grains_present(g);
    for (int i = 0; i < g->n; i++) sum += is_gone(g, i) ? 0 : grains_mass(g, i);
    return sum;
}
int grains_present(const struct grains *g) {
    int n = 0;
    for (int i = 0; i < g->n; i++) n += !is_gone(g, i);
    return n;
}
double grains_work(const struct grains *g) {
    return g->box.shear != 0 ? g->impulse[0][0] + g->impulse[0][1] : 0;
}

int grains_number(const struct grains *g) {
    return g->n;
}
const struct grain *grains_all(const struct grains *g) {
    return g->grain;
}
const struct grain_event *grains_events(const struct grains *g) {
    return g->event;
}
const int32_t *grains_ids(const struct grains *g) {
    return g->id;
}
const uint8_t *grains_kinds(const struct grains *g) {
    return g->kind;
}
int grains_kind_of(const struct grains *g, int i) {
    return g->kind ? g->kind[i] : 0;
}
void grains_kinds_by_number(const struct grains *g, uint8_t *kind) {
    for (int i = 0; i < g->n; i++) kind[g->id[i]] = (uint8_t)grains_kind_of(g, i);
}
const struct grain_counts *grains_counted(const struct grains *g) {
    return &g->counts;
}
const double (*grains_impulses(const struct grains *g))[3] {
    return (const double(*)[3])g->impulse;
}
const struct facet *grains_facet_of(const struct grain_box *box, int b) {
    const int f = FIRST_FACET - b;
    return box->facets && f >= 0 && f < box->facets->n ? &box->facets->facet[f] : NULL;
}
double grains_time(const struct grains *g) {
    return g->time;
}
double grains_bytes(int n, int dim) {
    double cells = dim == 2 ? 1.3 : 2; /* cells per grain, at packing 0.6 and 0.26 */
    double grain = sizeof(struct grain) + sizeof(struct grain_event) + sizeof(uint64_t) + 3 * sizeof(int32_t);
    return n * (grain + cells * SLOTS * sizeof(uint32_t)) + calendar_bytes(n);
}
