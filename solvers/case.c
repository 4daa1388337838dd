#define _XOPEN_SOURCE 700 /* realpath */
#include "solvers/case.h"

#include "solvers/changes.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static status read_mesh(struct setup *s) {
    char path[TIME_PATH];
    snprintf(path, sizeof path, "%.4000s/constant/polyMesh", s->dir);
    if (access(path, F_OK))
        return fail(ERR_INPUT, "%s: no mesh; make it with  gmshToCase MESH.msh -case %.1000s", path, s->dir);
    TRY(polymesh_read(path, &s->mesh));
    const struct polymesh *m = s->mesh;
    TRY(status_note(polymesh_check(m), "%s", path));
    s->checksum = polymesh_checksum(m);
    double *face_centre = NULL, *area = NULL;
    status e = allocate(&face_centre, 3L * m->nfaces, sizeof(double), "face centres");
    if (!e) e = allocate(&area, 3L * m->nfaces, sizeof(double), "face areas");
    if (!e) e = allocate(&s->centre, 3L * m->ncells, sizeof(double), "cell centres");
    if (!e) e = allocate(&s->volume, m->ncells, sizeof(double), "cell volumes");
    if (!e) {
        polymesh_face_geometry(m, face_centre, area);
        polymesh_cell_geometry(m, face_centre, area, s->centre, s->volume);
        e = lattice_recognise(m, &s->lattice, s->why);
    }
    free(face_centre);
    free(area);
    return e;
}

status case_courant(const struct control *c, const struct stepper *stepper) {
    if (c->max_co <= stepper->courant) return OK;
    return dict_fail(c->dict, "maxCo", "timeScheme %s allows %g at most", stepper->name, stepper->courant);
}

static status make_grid(struct setup *s) {
    const struct case_models *m = s->models;
    if (m->engine == ENGINE_LATTICE && !s->lattice)
        return dict_fail(m->schemes, "meshEngine",
                         "the mesh is no lattice of equal boxes: %s; leave the key out or say  meshEngine polyhedral;",
                         s->why);
    const struct lattice *l = m->engine == ENGINE_POLYHEDRAL ? NULL : s->lattice;
    return grid_make(l, s->mesh, s->centre, s->volume, s->comm, m->gas.polynomial->rings, &s->grid);
}

status case_gas(const struct setup *s, struct gas **out) {
    const struct gas_models *m = &s->models->gas;
    const struct patch_rules *rules = s->initial->rules;
    return s->grid->forest ? gas_make(s->grid->forest, m, s->mesh->npatches, rules, out)
                           : gas_make_mosaic(s->grid, m, s->mesh->npatches, rules, out);
}

static status read_setup(struct setup *s, const char *application) {
    TRY(control_read(s->dir, application, &s->control));
    TRY(read_mesh(s));
    int axis[3] = {0}, dim = polymesh_axes(s->mesh, axis);
    TRY(models_read(s->dir, dim, axis, &s->models));
    return case_courant(s->control, s->models->gas.stepper);
}

static status read_state(struct setup *s) {
    int axis[3] = {0}, dim = polymesh_axes(s->mesh, axis);
    if (s->control->stop_at == STOP_END_TIME && s->control->end_time < s->start.t - 1e-9 * fabs(s->start.t))
        return dict_fail(s->control->dict, "endTime", "the run would start after that, from time %s", s->start.name);
    TRY(changes_check_mesh(s));
    const struct field_place place = {s->mesh, s->centre, s->start.t};
    TRY(initial_read(s->dir, &s->start, &place, dim, axis, &s->models->gas, &s->initial));
    TRY(make_grid(s));
    if (s->grid->mosaic && s->models->gas.polynomial->degree > 1)
        return initial_average(s->initial, &place, dim, axis, &s->models->gas);
    return OK;
}

static void set_name(struct setup *s) {
    char full[PATH_MAX];
    const char *path = realpath(s->dir, full) ? full : s->dir, *slash = strrchr(path, '/');
    snprintf(s->name, sizeof s->name, "%s", slash && slash[1] ? slash + 1 : "case");
}

status case_read(const char *dir, const char *application, const struct comm *c, struct setup **out) {
    struct setup *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "case"));
    s->comm = c;
    snprintf(s->dir, sizeof s->dir, "%s", dir);
    set_name(s);
    status e = comm_agree(c, read_setup(s, application));
    if (!e) e = comm_agree(c, comm_root(c) ? times_start(dir, s->control, &s->start) : OK);
    if (!e) comm_broadcast(c, &s->start, sizeof s->start);
    if (!e) e = comm_agree(c, read_state(s));
    if (e) {
        case_free(s);
        return e;
    }
    *out = s;
    return OK;
}

void case_free(struct setup *s) {
    if (!s) return;
    grid_free(s->grid);
    initial_free(s->initial);
    models_free(s->models);
    lattice_free(s->lattice);
    polymesh_free(s->mesh);
    control_free(s->control);
    free(s->centre);
    free(s->volume);
    free(s);
}

/* Bytes of the state and what a step needs with it, of all cells. */
static double memory_of_grid(const struct setup *s) {
    const struct forest *f = s->grid->forest;
    const struct mosaic *m = s->grid->mosaic;
    if (f) return (double)f->ntiles_all * (double)f->size * 5 * 5 * 8;
    const int dim = m->dim, degree = s->models->gas.polynomial->degree;
    const int coefficients = degree == 0 ? 0 : degree == 1 ? dim : dim * (dim + 3) / 2;
    double members = m->nnear ? m->stencil_start[m->nnear] * 1. / m->nnear : 0, faces = s->mesh->nfaces,
           sides = m->face.n ? m->point.n * 1. / m->face.n : 1;
    double cell = (2 + dim) * 8. * (5 + coefficients) + members * (8 * (coefficients + dim) + 8) + 8 * (1 + dim) + 48;
    return s->mesh->ncells * cell + faces * (40 + 8 * dim * (dim + 1) + sides * 8 * (1 + 2 * dim + 2 * coefficients));
}

double case_memory(const struct setup *s) {
    double cells = s->mesh->ncells, faces = s->mesh->nfaces, points = s->mesh->npoints;
    double mesh = points * 24 + faces * (5 * 4 + 2 * 4) + cells * (32 + 28);
    double fields = cells * 8 * 12;
    return (mesh + fields) * comm_size(s->comm) + memory_of_grid(s);
}
