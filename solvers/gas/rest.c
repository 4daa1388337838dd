/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the state at rest (initial.h) in the folder of the start, and gives it to the gas. */
#include "solvers/gas/initial.h"

#include "solvers/case/case.h"

#include <stdlib.h>

static bool has_file(const struct setup *s, const struct instant *at, const char *name, char path[TIME_PATH]) {
    snprintf(path, TIME_PATH, "%.3900s/%s/%s", s->dir, at->folder, name);
    return field_exists(path);
}

/* Finds the newest folder up to s->start that no run has written, 0.orig among them; its name stays empty if there is
 * none. */
static status find_start(const struct setup *s, struct instant *out) {
    char path[TIME_PATH];
    struct instant *list;
    int n;
    memset(out, 0, sizeof *out);
    if (s->start.t >= 0) (void)time_original(s->dir, out);
    TRY(times_list(s->dir, &n, &list));
    for (int i = 0; i < n && list[i].t <= s->start.t; i++)
        if (!has_file(s, &list[i], "uniform/time", path) && (!*out->name || list[i].t > out->t)) *out = list[i];
    free(list);
    return OK;
}

/* Has the folder a settledLayer? */
static status finds_layer(const struct setup *s, const struct instant *at, bool *out) {
    const char *const names[] = {"rho", "alpha"};
    char path[TIME_PATH];
    *out = false;
    for (int i = 0; i < 2; i++) {
        struct dict *d = NULL;
        if (!has_file(s, at, names[i], path)) continue;
        TRY(dict_read(path, &d));
        *out |= dict_has(d, "settledLayer");
        dict_free(d);
    }
    return OK;
}

static status read_rest(const struct setup *s, const struct instant *at, const struct gas_models *models,
                        struct initial **out) {
    bool layer;
    TRY(finds_layer(s, at, &layer));
    if (layer) TRY(setup_borrow(s));
    const struct field_place place = {s->mesh, s->centre, at->t, NULL, NULL};
    return layer ? initial_rest(s->dir, at, &place, s->dim, s->components, s->axis, models, out) : OK;
}

status rest_lay(const struct setup *s, const struct gas_models *models, struct gas *g, bool *missing) {
    struct instant at;
    struct initial *i = NULL;
    status e = OK;
    *missing = false;
    if (!s->grid->polyhedra || s->mesh->round.on || !source_falls(&models->source, s->dim)) return OK;
    TRY(comm_agree(s->comm, comm_root(s->comm) ? find_start(s, &at) : OK));
    comm_broadcast(s->comm, &at, sizeof at);
    *missing = !at.name[0];
    if (*missing) return OK;
    TRY(comm_agree(s->comm, read_rest(s, &at, models, &i)));
    if (i && i->conserved[0])
        gas_set_conserved(g, (const double *const *)i->conserved);
    else if (i)
        e = gas_set(g, i->rho, (const double *const *)i->u, i->T);
    e = comm_agree(s->comm, e);
    if (!e && i) e = gas_rest(g, i->rests);
    initial_free(i);
    return e;
}
