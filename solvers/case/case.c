/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a case step by step: controlDict, the mesh, the medium's dictionaries, the time to start from, its state
 * (case.h). */
#define _XOPEN_SOURCE 700 /* realpath */
#include "solvers/case/case.h"

#include "solvers/case/blockmesh.h"
#include "solvers/case/changes.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void take_cells(struct setup *s, struct polymesh_geometry *g) {
    s->centre = g->cell_centre;
    s->volume = g->volume;
    g->cell_centre = g->volume = NULL;
}

/* Computes centres and volumes of the cells of a mesh with arrays. */
static status measure_cells(struct setup *s) {
    const struct polymesh *m = s->mesh;
    struct polymesh_geometry g = {0};
    const status e = polymesh_geometry_make(m, &g);
    if (!e) take_cells(s, &g);
    polymesh_geometry_free(&g);
    return e;
}

static void drop_cells(struct setup *s) {
    free(s->centre);
    free(s->volume);
    s->centre = s->volume = NULL;
}

/* Checks a mesh with arrays, and finds whether it is a lattice; keeps what the check computed of cells and faces. */
static status check_cells(struct setup *s) {
    struct polymesh_geometry g;
    status e = status_note(polymesh_check_geometry(s->mesh, &g), "%s", s->mesh_path);
    if (!e) e = lattice_recognise(s->mesh, &s->lattice, s->why);
    if (!e) take_cells(s, &g);
    if (!e && !s->lattice) {
        s->face_area = g.face_area;
        g.face_area = NULL;
    }
    polymesh_geometry_free(&g);
    return e;
}

/* Is a mesh that is spread no lattice? Else each rank reads the whole of it. */
static status look_for_lattice(struct setup *s) {
    const struct mesh_part *h = &s->spread->home;
    const struct lattice_part part = {s->comm, &h->mesh, h->whole, h->cell, h->face, s->mesh->ncells, s->mesh->nfaces};
    bool ruled_out;
    TRY(lattice_rule_out(&part, &ruled_out, s->why));
    if (ruled_out) return OK;
    spread_free(s->spread);
    polymesh_free(s->mesh);
    s->spread = NULL;
    s->mesh = NULL;
    return comm_agree(s->comm, polymesh_read(s->mesh_path, &s->mesh));
}

/* Is the mesh a lattice of which each rank knows slices? */
static bool has_sites(const struct setup *s) {
    return s->mesh->outline && s->mesh->outline->sites;
}

static status read_mesh(struct setup *s, bool whole) {
    struct case_mesh read;
    const bool drawn = control_has(s->control, "vtk"); /* it writes points and faces */
    const status e = whole ? case_mesh_read(s->dir, &read) : case_mesh_spread(s->dir, s->comm, drawn, &read);
    s->mesh = read.mesh;
    s->spread = read.spread;
    memcpy(s->mesh_path, read.path, sizeof s->mesh_path);
    TRY(e);
    if (read.older)
        TRY(warn(
            &s->warnings, WARN_OLD_MESH,
            "%s/system/blockMeshDict: it was changed after constant/polyMesh, which counts: run blockMesh, or remove "
            "constant/polyMesh and the dictionary itself is read",
            s->dir));
    if (s->mesh->boxes) {
        s->checksum = polymesh_checksum(s->mesh);
        boxes_centre(s->mesh->boxes, 0, s->first);
        return lattice_of_boxes(s->mesh, &s->lattice);
    }
    if (has_sites(s)) {
        s->kept = s->mesh->points != NULL;
        s->checksum = polymesh_checksum(s->mesh);
        memcpy(s->first, s->mesh->outline->sites->middle, sizeof s->first);
        return lattice_of_sites(s->mesh, &s->lattice);
    }
    if (s->spread) TRY(look_for_lattice(s));
    if (!s->spread) TRY(check_cells(s));
    s->checksum = polymesh_checksum(s->mesh);
    if (s->spread) return OK;
    if (s->lattice) {
        lattice_centres(s->lattice, s->centre);
        free(s->volume);
        s->volume = NULL;
    }
    memcpy(s->first, s->centre, sizeof s->first);
    return OK;
}

status setup_complete(const struct setup *s) {
    ((struct setup *)(uintptr_t)s)->wanted = true;
    return setup_borrow(s);
}

void setup_settle(struct setup *s) {
    if (s->spread) spread_trim(s->spread);
    if (has_sites(s)) sites_drop(s->mesh->outline->sites);
    grid_settle(s->grid);
    release_freed();
}

void setup_release(struct setup *s) {
    struct polymesh *m = s->mesh;
    spread_free(s->spread);
    s->spread = NULL;
    if (!m->outline || s->wanted) return;
    if (!s->kept) polymesh_drop(m);
    drop_cells(s);
    if (s->lattice) lattice_drop(s->lattice);
}

status setup_borrow(const struct setup *s) {
    struct setup *to = (struct setup *)(uintptr_t)s; /* what is added was there in the files */
    if (s->centre && s->volume) return OK;
    if (s->mesh->boxes || has_sites(s)) TRY(lattice_complete(to->lattice, to->mesh));
    TRY(polymesh_complete(to->mesh));
    drop_cells(to);
    TRY(measure_cells(to));
    if (s->lattice) lattice_centres(s->lattice, to->centre);
    return OK;
}

double setup_volume(const struct setup *s, long cell) {
    if (s->lattice) return lattice_volume(s->lattice);
    return s->volume ? s->volume[cell] : spread_volume(s->spread, cell);
}

void setup_place(const struct setup *s, long cell, double x[3]) {
    memcpy(x, s->first, sizeof s->first);
    if (s->grid->polyhedra)
        polyhedra_place(s->grid->polyhedra, cell, x);
    else if (has_sites(s))
        forest_place(s->grid->forest, cell, x);
    else
        lattice_centre(s->lattice, cell, x);
}

status setup_grid(struct setup *s, bool polyhedral, int rings, bool sized) {
    const bool forest = s->lattice && !polyhedral;
    if (s->spread) return grid_make_spread(s->mesh, s->spread, rings, sized, &s->grid);
    if (!forest) TRY(setup_complete(s));
    TRY(grid_make(forest ? s->lattice : NULL, s->mesh, s->centre, s->comm, rings, sized, &s->grid));
    if (!forest || s->medium->type->whole) return OK;
    lattice_drop_faces(s->lattice);
    drop_cells(s);
    return OK;
}

int setup_lines(const struct setup *s, int quantity) {
    const struct medium *m = s->medium;
    return m->fields.quantity[quantity].components == 1 ? 1 : quantity == m->type->axial ? 3 : s->components;
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
    TRY(read_mesh(s, type->whole));
    release_freed();
    if (type->whole) TRY(setup_complete(s));
    s->dim = s->components = polymesh_axes(s->mesh, s->axis);
    TRY(round_read(s));
    if (s->mesh->round.on && !type->round) return round_refuse(s, type->application, "run granularGas");
    TRY(type->read(s));
    if (!s->medium->fields.quantity) s->medium->fields = type->fields;
    TRY(warn_header(&s->warnings, s->control->dict, "dictionary"));
    TRY(warn_passed(&s->warnings, s->control->dict));
    for (int i = 0; i < s->nfiles; i++)
        TRY(warn_header(&s->warnings, s->file[i].dict,
                        strcmp(s->file[i].name, "g") ? "dictionary" : "uniformDimensionedVectorField"));
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

static status warn_beside(struct setup *s) {
    if (!s->start.beside) return OK;
    return warn(&s->warnings, WARN_BESIDE,
                "%s/%s: it is the start, and not " TIME_ORIGINAL ", as no run wrote it and it is newer (setFields and "
                "mapFields make such folders); remove it to start from " TIME_ORIGINAL,
                s->dir, s->start.name);
}

status case_read(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c,
                 struct setup **out) {
    struct setup *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "case"));
    s->comm = c;
    s->ranks = how.ranks > 1 ? how.ranks : 1;
    s->warnings = (struct warnings){.strict = how.strict, .silent = !comm_root(c), .cures = how.cures};
    snprintf(s->dir, sizeof s->dir, "%s", dir);
    set_name(s);
    status e = comm_agree(c, folder_mark(dir, &s->mark));
    if (!e) e = comm_agree(c, comm_root(c) ? check_links(s) : OK);
    if (!e) e = comm_agree(c, read_setup(s, type));
    if (!e) e = comm_agree(c, comm_root(c) ? times_start(dir, s->control, how.afresh, &s->start) : OK);
    if (!e) comm_broadcast(c, &s->start, sizeof s->start);
    if (!e) e = comm_agree(c, warn_beside(s));
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
    spread_free(s->spread);
    lattice_free(s->lattice);
    polymesh_free(s->mesh);
    control_free(s->control);
    if (s->mesh_dict) dict_free(s->mesh_dict);
    drop_cells(s);
    free(s);
}

status case_here(const struct setup *s) {
    return folder_check(s->dir, &s->mark);
}

status case_make_folders(const struct setup *s, const char *path) {
    TRY(case_here(s));
    return make_folders(path);
}

status case_table(const struct setup *s, const char *owner, const char *folder, const char *file, FILE **out) {
    char path[2 * TIME_PATH];
    snprintf(path, sizeof path, "%s/postProcessing/%s/%s", s->dir, owner, folder);
    TRY(case_make_folders(s, path));
    size_t length = strlen(path);
    snprintf(path + length, sizeof path - length, "/%s", file);
    int why = file_create_stream(path, out);
    return why ? file_error(path, "cannot be written", why) : OK;
}

status case_end_row(const char *owner, FILE *file) {
    if (fprintf(file, "\n") >= 0 && !fflush(file) && !ferror(file)) return OK;
    return fail(ERR_SYSTEM, "postProcessing/%s: cannot be written (disk full?)", owner);
}

double case_memory(const struct setup *s) {
    double cells = s->mesh->ncells, faces = s->mesh->nfaces, points = s->mesh->npoints;
    const double copies = s->mesh->outline ? 1.2 : comm_size(s->comm); /* of a mesh that is spread, with its halos */
    double mesh = (s->mesh->boxes || has_sites(s)) && !s->mesh->points
                      ? 0
                      : points * 24 + faces * (5 * 4 + 2 * 4) + cells * (32 + 28);
    const bool sliced = s->grid && (s->grid->forest || s->mesh->outline) &&
                        !s->medium->type->whole; /* the ranks share the fields of the start */
    const double fields = cells * 8 * 12 * (sliced ? 1 : comm_size(s->comm));
    return mesh * copies + fields + s->medium->type->memory(s->medium);
}
