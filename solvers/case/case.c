/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a case step by step: controlDict, the mesh, the medium's dictionaries, the time to start from, its state
 * (case.h). */
#define _XOPEN_SOURCE 700 /* realpath */
#include "solvers/case/case.h"

#include "solvers/case/changes.h"

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
    struct polymesh_geometry g;
    status e = status_note(polymesh_check_geometry(m, &g), "%s", path);
    if (!e) s->checksum = polymesh_checksum(m);
    if (!e) e = lattice_recognise(m, &s->lattice, s->why);
    if (!e) {
        s->centre = g.cell_centre;
        s->volume = g.volume;
        s->face_area = g.face_area;
        g.cell_centre = g.volume = g.face_area = NULL;
    }
    if (!e && s->lattice) lattice_centres(s->lattice, s->centre);
    polymesh_geometry_free(&g);
    return e;
}

status setup_grid(struct setup *s, bool polyhedral, int rings) {
    return grid_make(polyhedral ? NULL : s->lattice, s->mesh, s->centre, s->volume, s->comm, rings, &s->grid);
}

int setup_lines(const struct setup *s, int quantity) {
    const struct medium_type *type = s->medium->type;
    return type->quantity[quantity].components == 1 ? 1 : quantity == type->axial ? 3 : s->components;
}

/* Puts the axes along which nothing moves behind the others. */
static void complete_axes(struct setup *s) {
    int n = s->components;
    for (int x = 0; x < 3; x++) {
        bool known = false;
        for (int k = 0; k < s->components; k++) known |= s->axis[k] == x;
        if (!known) s->axis[n++] = x;
    }
}

static status read_setup(struct setup *s, const struct medium_type *type) {
    TRY(control_read(s->dir, type->application, &s->control));
    s->warnings.accepted = s->control->accepted;
    TRY(read_mesh(s));
    s->dim = s->components = polymesh_axes(s->mesh, s->axis);
    TRY(type->read(s));
    TRY(warn_header(&s->warnings, s->control->dict));
    for (int i = 0; i < s->nfiles; i++) TRY(warn_header(&s->warnings, s->file[i].dict));
    TRY(version_warn(s));
    return type->check_control ? type->check_control(s->medium, s->control) : OK;
}

static status read_state(struct setup *s) {
    if (s->control->stop_at == STOP_END_TIME && s->control->end_time < s->start.t - 1e-9 * fabs(s->start.t))
        return dict_fail(s->control->dict, "endTime", "the run would start after that, from time %s", s->start.name);
    TRY(changes_check_mesh(s));
    TRY(s->medium->type->state(s));
    complete_axes(s);
    return OK;
}

static void set_name(struct setup *s) {
    char full[PATH_MAX];
    const char *path = realpath(s->dir, full) ? full : s->dir, *slash = strrchr(path, '/');
    snprintf(s->name, sizeof s->name, "%s", slash && slash[1] ? slash + 1 : "case");
}

/* Refuses links that a run would have to write through, when it begins and not hours later. */
static status check_links(const struct setup *s) {
    static const char *const names[] = {"postProcessing", "VTK"};
    char path[TIME_PATH + 32];
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", s->dir, names[i]);
        if (path_is_link(path)) return file_link_error(path);
    }
    return OK;
}

status case_read(const char *dir, const struct medium_type *type, struct reading how, const struct comm *c,
                 struct setup **out) {
    struct setup *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "case"));
    s->comm = c;
    s->warnings = (struct warnings){.strict = how.strict, .silent = !comm_root(c)};
    snprintf(s->dir, sizeof s->dir, "%s", dir);
    set_name(s);
    status e = comm_agree(c, folder_mark(dir, &s->mark));
    if (!e) e = comm_agree(c, comm_root(c) ? check_links(s) : OK);
    if (!e) e = comm_agree(c, read_setup(s, type));
    if (!e) e = comm_agree(c, comm_root(c) ? times_start(dir, s->control, how.afresh, &s->start) : OK);
    if (!e) comm_broadcast(c, &s->start, sizeof s->start);
    if (!e) e = comm_agree(c, read_state(s));
    free(s->face_area);
    s->face_area = NULL;
    if (e) {
        case_free(s);
        return e;
    }
    *out = s;
    return OK;
}

void case_free(struct setup *s) {
    if (!s) return;
    if (s->medium) s->medium->type->free(s->medium);
    grid_free(s->grid);
    lattice_free(s->lattice);
    polymesh_free(s->mesh);
    control_free(s->control);
    free(s->centre);
    free(s->volume);
    free(s);
}

status case_here(const struct setup *s) {
    return folder_check(s->dir, &s->mark);
}

status case_make_folders(const struct setup *s, const char *path) {
    TRY(case_here(s));
    return make_folders(path);
}

status case_table(const struct setup *s, const char *folder, const char *file, FILE **out) {
    char path[2 * TIME_PATH];
    snprintf(path, sizeof path, "%s/postProcessing/%s", s->dir, folder);
    TRY(case_make_folders(s, path));
    size_t length = strlen(path);
    snprintf(path + length, sizeof path - length, "/%s", file);
    int why = file_create_stream(path, out);
    return why ? file_error(path, "cannot be written", why) : OK;
}

double case_memory(const struct setup *s) {
    double cells = s->mesh->ncells, faces = s->mesh->nfaces, points = s->mesh->npoints;
    double mesh = points * 24 + faces * (5 * 4 + 2 * 4) + cells * (32 + 28);
    double fields = cells * 8 * 12;
    return (mesh + fields) * comm_size(s->comm) + s->medium->type->memory(s->medium);
}
