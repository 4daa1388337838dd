/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the fields of a start of granularMD and puts grains in place from them or from a cloud (grains_start.h). */
#include "solvers/grains/grains_start.h"

#include "libcore/models/boundary.h"
#include "solvers/gas/layers.h"
#include "solvers/output/clouds.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static void path_of(const struct setup *s, const char *name, char path[2 * TIME_PATH]) {
    snprintf(path, 2 * TIME_PATH, "%s/%s/%s", s->dir, s->start.folder, name);
}
static bool there(const struct setup *s, const char *name) {
    char path[2 * TIME_PATH];
    path_of(s, name, path);
    return field_exists(path);
}

void grains_files(struct setup *s, const struct grains_models *m) {
    s->file[s->nfiles++] = (struct setup_file){"constant", "granularProperties", m->granular};
    s->file[s->nfiles++] = (struct setup_file){"constant", "particleProperties", m->properties};
    s->file[s->nfiles++] = (struct setup_file){"constant", "g", m->forces.g};
    s->file[s->nfiles++] = (struct setup_file){"constant", "shaking", m->forces.shaking};
}

static status check_files(const struct setup *s, bool saved) {
    const bool written = there(s, "uniform/time"), placed = there(s, "lagrangian/grains/positions");
    if (!there(s, "U"))
        return fail(ERR_INPUT, "%s/%s/U: no such file; it says which patches are walls%s", s->dir, s->start.folder,
                    saved ? "" : ", and the velocity");
    if (saved || (placed && there(s, "lagrangian/grains/U"))) return OK;
    if (there(s, "rho") && there(s, "alpha") && !written)
        return fail(ERR_INPUT, "%s/%s: both rho and alpha are given; remove one: it follows from the other", s->dir,
                    s->start.folder);
    if (!there(s, "rho") && !there(s, "alpha") && !placed)
        return fail(ERR_INPUT,
                    "%s/%s: neither rho nor alpha is there; give one of them, or lagrangian/grains/positions", s->dir,
                    s->start.folder);
    if (there(s, "T")) return OK;
    return fail(ERR_INPUT, "%s/%s/T: no such file; the start needs the temperature%s", s->dir, s->start.folder,
                there(s, "p") ? " (p says it of a gas only)" : "");
}

/* Takes one component of a field, times scale, in the order of the cells of the lattice, or of the mesh. */
static status take(const struct setup *s, const struct grains_mesh *mesh, const struct field *f, int component,
                   double scale, double **out) {
    const struct lattice *l = s->lattice;
    const long cells = mesh ? s->mesh->ncells : (long)l->n[0] * l->n[1] * l->n[2];
    TRY(allocate(out, cells, sizeof(double), f->kind->name));
    for (long i = 0; i < cells; i++) { /* 0 in the holes of a lattice */
        const long cell = mesh ? i : l->cell[i];
        if (cell >= 0) (*out)[i] = scale * f->values[cell * f->kind->components + component];
    }
    return OK;
}

static status check_cells(const struct setup *s, const struct field *f, double most, const char *what) {
    const struct field_place place = {s->mesh, s->centre, s->start.t, NULL, NULL};
    for (int i = 0; i < s->mesh->ncells; i++)
        if (!(f->values[i] >= 0 && f->values[i] < most)) return field_fail(f, &place, i, "%s", what);
    return OK;
}

static status check_velocity(const struct setup *s, const struct field *U) {
    const struct field_place place = {s->mesh, s->centre, s->start.t, NULL, NULL};
    bool solved[3] = {false, false, false};
    for (int k = 0; k < s->dim; k++) solved[s->axis[k]] = true;
    for (int x = 0; x < 3; x++)
        for (int i = 0; i < s->mesh->ncells && !solved[x]; i++)
            if (U->values[3L * i + x] != 0)
                return field_fail(U, &place, i, "its %c component must be 0: 'empty' patches take that axis away",
                                  "xyz"[x]);
    return OK;
}

static status take_density(const struct setup *s, const struct grains_models *m, struct grains_start *p) {
    const double d = m->grain.diameter, packed = s->dim == 2 ? PI / sqrt(12) : PI / sqrt(18);
    double per = (s->dim == 2 ? PI / 4 * d * d : PI / 6 * d * d * d) / m->grain.mass; /* alpha / rho */
    if (m->kinds.n) per *= grains_mean_size(&m->kinds, s->dim) / grains_mean_mass(&m->kinds);
    const bool alpha = p->field[FIELD_ALPHA] != NULL;
    const struct field *f = p->field[alpha ? FIELD_ALPHA : FIELD_RHO];
    char what[128];
    if (!f) return OK;
    snprintf(what, sizeof what, "it must lie between 0 and %.4g, close packing of %s%s", alpha ? packed : packed / per,
             s->dim == 2 ? "disks" : "spheres", alpha ? "" : " in the unit of rho");
    TRY(check_cells(s, f, alpha ? packed : packed / per, what));
    return take(s, p->mesh, f, 0, alpha ? 1 : per, &p->alpha);
}

/* Lays a settledLayer, with its waves, as granularGas does: by the equation of state, if it is hydrostatic. */
static status lay(const struct setup *s, const struct grains_models *m, const struct layers *l, struct field *density,
                  const struct field *T) {
    const struct field_place place = {s->mesh, s->centre, s->start.t, NULL, NULL};
    struct gas_models gas;
    if (!l) return OK;
    TRY(models_equation(m->granular, &gas));
    gas.source = m->forces.source;
    return layers_apply(l, density, &place, s->dim, s->axis, &gas, T);
}

static status read_fields(const struct setup *s, const struct grains_models *m, bool saved, struct grains_start *p) {
    const struct field_place place = {s->mesh, s->centre, s->start.t, NULL, NULL};
    struct layers *layers[FIELD_COUNT] = {NULL};
    status e = OK;
    for (int i = 0; i < FIELD_COUNT && !e; i++) {
        char path[2 * TIME_PATH];
        path_of(s, field_kinds[i].name, path);
        if (field_exists(path)) e = layers_read_field(path, (enum field_id)i, &place, &layers[i], &p->field[i]);
    }
    const enum field_id density = p->field[FIELD_ALPHA] ? FIELD_ALPHA : FIELD_RHO;
    if (!e && !saved) e = lay(s, m, layers[density], p->field[density], p->field[FIELD_T]);
    for (int i = 0; i < FIELD_COUNT; i++) layers_free(layers[i]);
    return e;
}

status grains_start_read(const struct setup *s, const struct grains_models *m, bool saved, struct grains_start *p) {
    *p = (struct grains_start){.mesh = NULL};
    TRY(check_files(s, saved));
    return read_fields(s, m, saved, p);
}

status grains_start_take(const struct setup *s, const struct grains_models *m, const struct grains_mesh *mesh,
                         bool saved, struct grains_start *p) {
    p->mesh = mesh;
    if (saved) return OK;
    TRY(take_density(s, m, p));
    TRY(check_velocity(s, p->field[FIELD_U]));
    for (int k = 0; k < s->dim; k++) TRY(take(s, p->mesh, p->field[FIELD_U], s->axis[k], 1, &p->u[k]));
    if (!p->field[FIELD_T]) return OK;
    TRY(check_cells(s, p->field[FIELD_T], HUGE_VAL, "it must be 0 or greater"));
    return take(s, p->mesh, p->field[FIELD_T], 0, 1, &p->T);
}

static bool is_rough(const struct boundary_type *type) {
    return type && type == boundary_find("JohnsonJacksonSlip");
}

status grains_start_check(const struct setup *s, const struct grains_models *m, const struct grains_start *p) {
    const struct polymesh *mesh = s->mesh;
    for (int k = 0; k < mesh->npatches; k++) {
        const struct boundary_type *wall = boundary_find(p->field[FIELD_U]->patch[k].type);
        for (int i = 0; i < FIELD_COUNT; i++) {
            const struct field *f = i == FIELD_U ? NULL : p->field[i];
            const struct boundary_type *type = f ? boundary_find(f->patch[k].type) : NULL;
            if (m->soft && boundary_is_wall(type)) continue; /* its restitution counts */
            if (i == FIELD_T && is_rough(type) && type == wall) continue;
            if (boundary_is_wall(wall) && boundary_gives(type) && type != boundary_find("granularWall"))
                return fail(ERR_INPUT,
                            "%s:%d: patch %s: U is '%s', a wall; walls of grains give no heat: %s cannot be '%s' "
                            "there, use zeroGradient, or granularWall for T",
                            dict_path(f->dict), f->patch[k].line, mesh->patch[k].name, wall->model.name, f->kind->name,
                            type->model.name);
        }
    }
    return OK;
}

/* Returns the parameter `key` of a patch; NULL: its type has none. */
static const double *parameter(const struct patch_field *q, const char *key) {
    const struct boundary_type *type = boundary_find(q->type);
    for (int i = 0; type && i < type->model.nparam; i++)
        if (!strcmp(type->model.param[i].name, key))
            return q->params.room + type->model.param[i].offset / sizeof(double);
    return NULL;
}

/* Returns the restitution that T, or U, gives on a patch: granularWall and JohnsonJacksonSlip; NULL: none. */
static const double *restitution_of(const struct patch_field *q) {
    return parameter(q, is_rough(boundary_find(q->type)) ? "restitutionCoefficient" : "restitution");
}

/* Takes from U how rough a wall is, and its velocity, which is the same everywhere and along the wall. */
static status take_rough(const struct setup *s, const struct grains_start *p, int k, struct grain_rough *out) {
    const struct field *U = p->field[FIELD_U], *T = p->field[FIELD_T];
    const struct patch_field *q = &U->patch[k];
    const char *file = dict_path(U->dict), *patch = s->mesh->patch[k].name;
    if (!is_rough(boundary_find(q->type))) return OK;
    *out = (struct grain_rough){.phi = *parameter(q, "specularityCoefficient")};
    for (int a = 0; a < s->dim; a++) out->u[a] = (q->values ? q->values : q->uniform)[s->axis[a]];
    bool alike = !q->varying || !varying_in_time(q->varying);
    for (int i = 0; i < (q->values ? 3 * s->mesh->patch[k].nfaces : 0); i++)
        alike = alike && q->values[i] == q->values[i % 3];
    if (!alike)
        return fail(ERR_INPUT, "%s:%d: patch %s: rough walls of grains move as a whole: give  value uniform (..);",
                    file, q->line, patch);
    const double *e = T ? restitution_of(&T->patch[k]) : NULL,
                 *phi = T ? parameter(&T->patch[k], "specularityCoefficient") : NULL;
    if ((e && *e != *restitution_of(q)) || (phi && *phi != out->phi))
        return fail(ERR_INPUT, "%s:%d: patch %s: U and T have other coefficients of impacts: give the same", file,
                    q->line, patch);
    for (int i = 0; i < s->mesh->patch[k].nfaces; i++) {
        double centre[3], area[3], across = 0, square = 0, speed = 0;
        polymesh_one_face(s->mesh, s->mesh->patch[k].start + i, centre, area);
        for (int a = 0; a < s->dim; a++) {
            across += area[s->axis[a]] * out->u[a];
            square += area[s->axis[a]] * area[s->axis[a]];
            speed += out->u[a] * out->u[a];
        }
        if (fabs(across) > 1e-9 * sqrt(square * speed))
            return fail(ERR_INPUT, "%s:%d: patch %s: a wall moves along itself, but this value leads across a face",
                        file, q->value_line, patch);
    }
    return OK;
}

status grains_start_walls(const struct setup *s, const struct grains_start *p, struct grains_models *m) {
    const struct polymesh *mesh = s->mesh;
    const struct field *T = p->field[FIELD_T], *U = p->field[FIELD_U];
    for (int k = 0; T && k < mesh->npatches; k++) {
        const double *given = restitution_of(&T->patch[k]);
        if (!m->soft) TRY(take_rough(s, p, k, &m->rough[k]));
        if (!m->soft && !given && is_rough(boundary_find(U->patch[k].type))) given = restitution_of(&U->patch[k]);
        const double e = given ? *given : 0;
        if (!given) continue;
        if (m->restitution_line[k] && m->restitution[k] != e)
            return fail(ERR_INPUT,
                        "%s:%d: patch %s: restitution is %g here, and %g in line %d of constant/particleProperties; "
                        "remove one of them",
                        dict_path(T->dict), T->patch[k].line, mesh->patch[k].name, e, m->restitution[k],
                        m->restitution_line[k]);
        m->restitution[k] = e;
    }
    return OK;
}

void grains_start_drop(struct grains_start *p) {
    double **all[] = {&p->alpha, &p->T, &p->u[0], &p->u[1], &p->u[2]};
    for (int i = 0; i < 5; i++) {
        free(*all[i]);
        *all[i] = NULL;
    }
    for (int i = 0; i < FIELD_COUNT; i++) {
        if (!p->field[i]) continue;
        free(p->field[i]->values);
        p->field[i]->values = NULL;
    }
}
void grains_start_free(struct grains_start *p) {
    grains_start_drop(p);
    for (int i = 0; i < FIELD_COUNT; i++) field_free(p->field[i]);
}

static struct packing_field field_of(const struct setup *s, const struct grains_models *m,
                                     const struct grains_start *p) {
    struct packing_field f = {.alpha = p->alpha, .T = p->T, .u = {p->u[0], p->u[1], p->u[2]}};
    if (m->kinds.n) f.kinds = &m->kinds;
    if (p->mesh) f.mesh = &p->mesh->base;
    for (int k = 0; k < 3; k++) f.n[k] = p->mesh ? 1 : s->lattice->n[k];
    return f;
}

static status make_room(struct grain_start *out, int n) {
    out->n = n;
    TRY(allocate(&out->x, n, sizeof *out->x, "places of grains"));
    return allocate(&out->u, n, sizeof *out->u, "velocities of grains");
}

static status take_cloud(const struct setup *s, struct grains_models *m, const struct cloud *c,
                         struct grain_start *out) {
    if (m->number && m->number != c->n)
        return dict_fail(m->properties, "N", "lagrangian/grains/positions of time %s holds %d grains; leave N out",
                         s->start.folder, c->n);
    TRY(make_room(out, c->n));
    grains_models_count(m, c->n);
    out->from_cloud = true;
    if (c->spin) TRY(allocate(&out->spin, c->n, sizeof *out->spin, "spins of grains"));
    for (int i = 0; c->spin && i < c->n; i++)
        for (int k = 0; k < 3; k++) out->spin[i][k] = c->spin[i][s->axis[k]];
    for (int i = 0; i < c->n; i++)
        for (int k = 0; k < s->dim; k++) {
            out->x[i][k] = c->x[i][s->axis[k]];
            out->u[i][k] = c->u ? c->u[i][s->axis[k]] : 0;
        }
    return OK;
}

static status count_grains(const struct setup *s, const struct grains_models *m, const struct grain_box *box,
                           const struct packing_field *f, int *n) {
    const double many = m->number ? m->number : packing_number(box, m->grain.diameter, f);
    *n = many <= INT_MAX ? (int)many : 0;
    if (*n > 0) return OK;
    if (many > 0)
        return fail(ERR_INPUT,
                    "%s/%s: the packing fraction is that of %.3g grains, more than can be computed (%d): "
                    "is their diameter, %g m, right?",
                    s->dir, s->start.folder, many, INT_MAX, m->grain.diameter);
    return fail(ERR_INPUT, "%s/%s: the packing fraction is that of less than one grain in the box; give a greater one",
                s->dir, s->start.folder);
}

static status place_grains(const struct setup *s, struct grains_models *m, const struct grain_box *box,
                           const struct packing_field *f, struct grain_start *out) {
    int n;
    TRY(count_grains(s, m, box, f, &n));
    TRY(make_room(out, n));
    grains_models_count(m, n);
    status e = packing_places(box, m->grain.diameter, f, n, (uint64_t)m->seed, out->x, &out->packing);
    if (m->number) return status_note(e, "%s:%d: N %d", dict_path(m->properties), dict_line(m->properties, "N"), n);
    return status_note(e, "%s/%s/%s: %d grains", s->dir, s->start.folder, there(s, "alpha") ? "alpha" : "rho", n);
}

status grain_start_make(const struct setup *s, struct grains_models *m, const struct grain_box *box,
                        const struct grains_start *fields, struct grain_start *out) {
    const struct packing_field f = field_of(s, m, fields);
    struct cloud cloud = {.n = 0};
    char folder[2 * TIME_PATH];
    bool moving = false;
    path_of(s, "", folder);
    folder[strlen(folder) - 1] = 0;
    if (cloud_exists(folder)) {
        TRY(cloud_read(folder, s->mesh->ncells, &cloud));
        moving = cloud.u != NULL;
        status e = take_cloud(s, m, &cloud, out);
        cloud_free(&cloud);
        TRY(e);
    } else {
        TRY(place_grains(s, m, box, &f, out));
    }
    if (!moving) packing_velocities(box, &f, out->n, (uint64_t)m->seed, (const double(*)[3])out->x, out->u);
    return OK;
}

/* Sets the kind of each grain of `old` by number. */
static void kinds_of(const struct grain_kinds *k, const struct grains *old, int kinds, uint8_t *kind) {
    grains_kinds_by_number(old, kind);
    if (k->n == kinds) return;
    for (int i = 0; i < grains_number(old); i++)
        for (kind[i] = 0; kind[i] + 1 < k->n && i >= k->first[kind[i] + 1];) kind[i]++;
}

static status make_anew(const struct grain_box *box, struct grain_law *law, const struct grains *old, int kinds,
                        struct pool *pool, struct grains **out) {
    const int all = grains_number(old);
    const double t = grains_time(old);
    double(*at)[3], (*u)[3], (*new_at)[3], (*new_u)[3];
    uint8_t *kind;
    int n = 0; /* grains that stay */
    TRY(pool_take(pool, &at, all, sizeof *at, "places of grains"));
    TRY(pool_take(pool, &u, all, sizeof *u, "velocities of grains"));
    TRY(pool_take(pool, &new_at, all, sizeof *at, "places of grains"));
    TRY(pool_take(pool, &new_u, all, sizeof *u, "velocities of grains"));
    TRY(pool_take(pool, &kind, all, sizeof *kind, "kinds of grains"));
    grains_at(old, t, at, u);
    kinds_of(&law->kinds, old, kinds, kind);
    for (int k = 0; k == 0 || k < law->kinds.n; k++) {
        for (int i = 0; i < all; i++) {
            if (kind[i] != k || isnan(at[i][0])) continue;
            memcpy(new_at[n], at[i], sizeof *at);
            memcpy(new_u[n++], u[i], sizeof *u);
        }
        if (law->kinds.n) law->kinds.first[k + 1] = n;
    }
    return grains_make(box, law, n, (const double(*)[3])new_at, (const double(*)[3])new_u, t, out);
}

status grain_start_anew(const struct grain_box *box, struct grain_law *law, const struct grains *old, int kinds,
                        struct grains **out) {
    struct pool pool = {.last = NULL};
    const status e = make_anew(box, law, old, kinds, &pool, out);
    pool_free(&pool);
    return e;
}
