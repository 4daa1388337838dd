/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the flow of a mixture from the start folder or another case, its shear rate, and the slope of the kinetic
 * stress (segregation_flow.h). */
#include "solvers/segregation/segregation_flow.h"

#include "solvers/segregation/segregation_gas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Copies q of the cells from[n] of another mesh, with `components` each, to out[n]; -1: 0. */
static status spread(long n, const int *from, int components, const double *q, double **out) {
    TRY(allocate(out, components * n, sizeof(double), "a flow"));
    for (long i = 0; i < n; i++)
        if (from[i] >= 0)
            memcpy(*out + components * i, q + (long)components * from[i], (size_t)components * sizeof(double));
    return OK;
}

static struct cell_centres centres_of(const struct gas_time *g) {
    return (struct cell_centres){g->mesh, g->geometry.cell_centre, g->geometry.face_centre, g->dim, g->axis};
}

static status take_shear_rate(const struct cell_centres *at, const double *U, double **out) {
    const long n = at->mesh->ncells;
    double *room;
    TRY(allocate(&room, 15 * n, sizeof(double), "shear rates"));
    status e = allocate(out, n, sizeof(double), "shear rates");
    double *g[3] = {room, room + 3 * n, room + 6 * n};
    for (int i = 0; i < 3 && !e; i++) cell_gradients(at, 3, U + i, g[i], room + 9 * n);
    for (long c = 0; c < n && !e; c++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                const double twice = g[i][3 * c + k] + g[k][3 * c + i];
                sum += 0.5 * twice * twice;
            }
        (*out)[c] = sqrt(sum);
    }
    free(room);
    return e;
}

/* Computes the shear rate from U of all cells, and keeps that of the places (NULL: of all). */
static status own_shear_rate(const struct setup *s, const struct segregation_places *p, const double *U, double **out) {
    double *room, *rate = NULL;
    TRY(allocate(&room, 6L * s->mesh->nfaces, sizeof(double), "geometry"));
    polymesh_face_geometry(s->mesh, room, room + 3L * s->mesh->nfaces);
    status e = take_shear_rate(&(struct cell_centres){s->mesh, s->centre, room, s->dim, s->axis}, U, &rate);
    free(room);
    if (!e && p) e = segregation_places_take(p, 1, rate, out);
    if (p)
        free(rate);
    else
        *out = rate;
    return e;
}

/* ---- the start folder's U ---- */

/* Finds the folder with U: the start folder, else that which the case began with (the U of a line is not written
 * again). */
static status find_own(const struct setup *s, char name[TIME_NAME]) {
    struct instant *all = NULL;
    char path[2 * TIME_PATH];
    int n = 0;
    const char *const folders[] = {s->start.folder, TIME_ORIGINAL};
    for (int i = 0; i < 2; i++) {
        snprintf(name, TIME_NAME, "%s", folders[i]);
        snprintf(path, sizeof path, "%s/%s/U", s->dir, name);
        if (field_exists(path)) return OK;
    }
    TRY(times_list(s->dir, &n, &all));
    if (n) memcpy(name, all[0].name, TIME_NAME);
    free(all);
    return OK;
}

/* Leaves of U what counts: on a line nothing may flow along it, on a lattice only the solved axes do. */
static status settle_own(const struct setup *s, const struct field_place *place, struct field *f) {
    bool solved[3] = {s->dim == 1, s->dim == 1, s->dim == 1};
    for (int k = 0; k < s->dim; k++) solved[s->axis[k]] = true;
    for (long i = 0; i < field_ncells(place); i++) {
        double *U = f->values + 3 * i;
        if (s->dim == 1 && U[s->axis[0]] != 0)
            return field_fail(f, place, i, "along %c it must be 0: the line ends in walls", "xyz"[s->axis[0]]);
        for (int k = 0; k < 3; k++) U[k] = solved[k] ? U[k] : 0;
    }
    return OK;
}

static status read_own(const struct setup *s, const struct segregation_models *m, const struct segregation_places *p,
                       struct segregation_flow *f) {
    char path[2 * TIME_PATH], name[TIME_NAME];
    const bool whole = !p || m->sheared;
    TRY(find_own(s, name));
    snprintf(path, sizeof path, "%s/%s/U", s->dir, name);
    if (!field_exists(path)) return OK;
    if (whole) TRY(setup_borrow(s));
    const struct field_place place = {s->mesh, s->centre, s->start.t, whole ? NULL : &p->share, NULL};
    snprintf(f->source, sizeof f->source, "%s/U", name);
    TRY(field_agree(&place, field_read(path, &field_kinds[FIELD_U], &place, &f->given)));
    TRY(field_steady(f->given, s->mesh));
    TRY(field_agree(&place, settle_own(s, &place, f->given)));
    if (m->sheared) TRY(own_shear_rate(s, p, f->given->values, &f->shear_rate));
    if (p)
        TRY(whole ? segregation_places_take(p, 3, f->given->values, &f->U)
                  : segregation_places_fetch(p, 3, f->given->values, &f->U));
    if (!p) {
        f->U = f->given->values;
        f->given->values = NULL;
    }
    field_drop_cells(f->given);
    return OK;
}

/* ---- a time of another case ---- */

static status line_flow(const struct setup *s, const struct gas_time *g, const double *U, struct segregation_flow *f) {
    struct segregation_column *c = NULL;
    int n;
    status e = allocate(&f->U, 3L * s->mesh->ncells, sizeof(double), "a flow");
    if (!e) e = gas_time_columns(g, s->axis[0], 3, U, &n, &c);
    for (int i = 0; !e && i < s->mesh->ncells; i++)
        for (int k = 0; k < 3; k++)
            f->U[3L * i + k] = k == s->axis[0] ? 0 : column_value(n, c, k, s->centre[3L * i + s->axis[0]]);
    free(c);
    return e;
}

static status lattice_flow(const struct segregation_places *p, const struct segregation_models *m,
                           const struct gas_time *g, const double *U, struct segregation_flow *f) {
    int *from = NULL;
    double *other = NULL;
    status e = gas_time_cells(g, p, &from);
    if (!e) e = spread(p->n, from, 3, U, &f->U);
    if (!e && m->weighted) e = gas_time_field(g, "rho", 1, &other);
    if (!e && m->weighted) e = spread(p->n, from, 1, other, &f->density);
    free(other);
    other = NULL;
    const struct cell_centres centres = centres_of(g);
    if (!e && m->sheared) e = take_shear_rate(&centres, U, &other);
    if (!e && m->sheared) e = spread(p->n, from, 1, other, &f->shear_rate);
    for (long i = 0; !e && i < p->n; i++)
        if (f->density && from[i] >= 0 && !(f->density[i] > 0))
            e = fail(ERR_INPUT, "%s: velocity: rho of case %s, time %s, is %g in cell %d; a weight must be above 0",
                     dict_path(m->properties), g->dir, g->name, f->density[i], from[i]);
    free(other);
    free(from);
    return e;
}

static status read_other(const struct setup *s, const struct segregation_models *m, const struct segregation_places *p,
                         struct segregation_flow *f) {
    struct gas_time g;
    double *U = NULL;
    if (s->dim == 1 && m->weighted)
        return fail(ERR_INPUT, "%s: velocity: weight rho is for two or three solved axes; a line flows along no axis",
                    dict_path(m->properties));
    status e = gas_time_open(s, m->properties, "velocity", m->velocity_case, m->velocity_time, &g);
    if (!e) snprintf(f->source, sizeof f->source, "time %s", g.name);
    if (!e) e = gas_time_field(&g, "U", 3, &U);
    if (p) e = comm_agree(s->comm, e);
    if (!e) e = p ? lattice_flow(p, m, &g, U, f) : line_flow(s, &g, U, f);
    if (!e && !p && m->sheared) e = own_shear_rate(s, NULL, f->U, &f->shear_rate);
    free(U);
    gas_time_close(&g);
    return e;
}

/* ---- kinetic stress rho T ---- */

static status open_stress(const struct setup *s, const struct segregation_models *m, struct gas_time *g,
                          double **stress) {
    double *T = NULL;
    TRY(gas_time_open(s, m->properties, "percolation", m->case_dir, m->time, g));
    TRY(gas_time_field(g, "rho", 1, stress));
    status e = gas_time_field(g, "T", 1, &T);
    for (int i = 0; !e && i < g->mesh->ncells; i++) (*stress)[i] *= T[i];
    free(T);
    return e;
}

status stress_velocity(const struct setup *s, const struct segregation_models *m, int axis, int n, const double *node,
                       double *out) {
    struct gas_time g;
    struct segregation_column *c = NULL;
    double *stress = NULL;
    int columns = 0;
    status e = open_stress(s, m, &g, &stress);
    if (!e) e = gas_time_columns(&g, axis, 1, stress, &columns, &c);
    for (int i = 0; !e && i < n; i++) out[i] = m->q / m->rho * column_slope(columns, c, node[i]);
    free(c);
    free(stress);
    gas_time_close(&g);
    return e;
}

/* Computes on a lattice the slope along the direction of percolation, from the cell of the other case. */
static status stress_along(const struct setup *s, const struct segregation_models *m,
                           const struct segregation_places *p, double **out) {
    struct gas_time g;
    double *stress = NULL, *room = NULL;
    int *from = NULL;
    status e = comm_agree(s->comm, open_stress(s, m, &g, &stress));
    if (!e) e = gas_time_cells(&g, p, &from);
    if (!e) e = allocate(&room, 9L * g.mesh->ncells, sizeof(double), "a slope");
    if (!e) e = allocate(out, p->n, sizeof(double), "a slope");
    const struct cell_centres centres = centres_of(&g);
    if (!e) cell_gradients(&centres, 1, stress, room, room + 3L * g.mesh->ncells);
    for (long i = 0; !e && i < p->n; i++)
        for (int k = 0; k < 3 && from[i] >= 0; k++)
            (*out)[i] += m->q / m->rho * m->direction[k] * room[3L * from[i] + k];
    free(from);
    free(room);
    free(stress);
    gas_time_close(&g);
    return e;
}

status segregation_flow_read(const struct setup *s, const struct segregation_models *m,
                             const struct segregation_places *p, struct segregation_flow *out) {
    *out = (struct segregation_flow){.given = NULL};
    TRY(comm_agree(s->comm, m->velocity_case ? read_other(s, m, p, out) : read_own(s, m, p, out)));
    if (m->sheared && !out->U)
        return fail(ERR_INPUT, "%s: diffusivity: shearRate needs a flow: %s/U or  velocity { case ..; time ..; }",
                    dict_path(m->properties), s->start.folder);
    return m->percolation == PERCOLATION_STRESS && p ? comm_agree(s->comm, stress_along(s, m, p, &out->percolation))
                                                     : OK;
}

void segregation_flow_free(struct segregation_flow *f) {
    field_free(f->given);
    free(f->U);
    free(f->density);
    free(f->shear_rate);
    free(f->percolation);
}
