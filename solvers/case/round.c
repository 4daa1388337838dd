/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the axis of a body of revolution (docs/physics.md 1.4), and checks that the mesh lies beside it. */
#include "solvers/case/case.h"
#include "solvers/dict/keywords.h"
#include "solvers/dict/params.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double EXACT = 1e-9; /* of the mesh's extent, or of a direction: less is round-off of the files */

struct axis_entry {
    double origin[3], direction[3];
};
#define PARAM_STRUCT struct axis_entry
static const struct param axis_param[] = {
    VECTOR("origin", origin, 0, ANY_NUMBER, UNIT(0, 1, 0), "a point of the axis"),
    VECTOR("direction", direction, REQUIRED_AS("direction (1 0 0);"), ANY_NUMBER, NO_UNIT, "of the axis: x, y or z"),
};
#undef PARAM_STRUCT
static const struct param file_param[] = {
    NOTED("axis", "dictionary", "none: the mesh is what it is",
          "the mesh of (axial, radial) or radial cells stands for the body of revolution about that axis",
          "axis { direction (1 0 0); }"),
    IGNORED("patches", "for gmshToCase"),
    IGNORED("thickness", "for gmshToCase"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

void round_keywords(struct keywords *k) {
    keywords_at(k, "system/meshDict", "", NULL);
    keywords_params(k, file_param, COUNT(file_param));
    keywords_at(k, "system/meshDict", "axis", NULL);
    keywords_params(k, axis_param, COUNT(axis_param));
}

/* Is physical axis x one along which the mesh has cells? */
static bool is_solved(const struct setup *s, int x) {
    bool solved = false;
    for (int k = 0; k < s->dim; k++) solved |= s->axis[k] == x;
    return solved;
}

/* Finds axial and radial axis. */
static status find_axes(const struct setup *s, const struct dict *d, const double direction[3], struct revolution *r) {
    const double size = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    r->axial = r->radial = -1;
    for (int x = 0; x < 3; x++)
        if (size > 0 && fabs(direction[x]) > (1 - EXACT) * size) r->axial = x;
    if (r->axial < 0)
        return dict_fail(d, "direction", "the axis must lie along x, y or z; turn the mesh so that it does");
    if (s->dim == 3)
        return dict_fail(d, "direction",
                         "the mesh has cells along all three axes, but a body of revolution is meshed in a "
                         "plane of (axial, radial) cells: take `axis` away, or mesh half a section");
    if (is_solved(s, r->axial) != (s->dim == 2))
        return dict_fail(d, "direction",
                         s->dim == 2 ? "the mesh lies across the axis, in (x, y) cells of plane flow: take "
                                       "`axis` away, or choose an axis in the plane of the mesh"
                                     : "the only axis of the mesh is the axis itself, so that there is no "
                                       "radius: choose another direction");
    for (int k = 0; k < s->dim; k++)
        if (s->axis[k] != r->axial) r->radial = s->axis[k];
    return OK;
}

/* Checks a face of a patch against the axis. */
static status check_face(const struct setup *s, const struct dict *d, const struct revolution *r, double near,
                         const struct patch *p, const double centre[3], const double area[3]) {
    const double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    (void)s;
    if (!strcmp(p->type, "cyclic") && fabs(area[r->radial]) > EXACT * size)
        return dict_fail(d, "direction",
                         "patch %s is cyclic across the radius, but nothing repeats along it: make both "
                         "halves walls, or choose another axis",
                         p->name);
    if (centre[r->radial] - r->at < near && strcmp(p->type, "symmetryPlane") && strcmp(p->type, "symmetry"))
        return dict_fail(d, "origin",
                         "patch %s lies on the axis and is of type %s: give those faces a patch of type "
                         "symmetryPlane",
                         p->name, p->type);
    return OK;
}

static status check_mesh(const struct setup *s, const struct dict *d, struct revolution *r) {
    const struct polymesh *m = s->mesh;
    double low[3], high[3], centre[3], area[3];
    polymesh_bounds(m, low, high);
    const int x = r->radial;
    const double near = 1e-6 * (high[x] - low[x]);
    r->depth = high[3 - x - r->axial] - low[3 - x - r->axial];
    if (low[x] < r->at - near && high[x] < r->at + near)
        return dict_fail(d, "origin",
                         "the mesh lies below the axis, %c from %g to %g, where the radius is negative: mirror "
                         "it, or move the origin (now %c = %g)",
                         "xyz"[x], low[x], high[x], "xyz"[x], r -> at);
    if (low[x] < r->at - near)
        return dict_fail(d, "origin",
                         "the mesh lies across the axis, %c from %g to %g (axis at %g): mesh the half with %c "
                         "above it alone, or move the origin",
                         "xyz"[x], low[x], high[x], r -> at, "xyz"[x]);
    for (int p = 0; p < m->npatches; p++) {
        if (!strcmp(m->patch[p].type, "empty")) continue;
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            polymesh_patch_face(m, p, i, centre, area);
            TRY(check_face(s, d, r, near, &m->patch[p], centre, area));
        }
    }
    return OK;
}

status round_read(struct setup *s) {
    char path[TIME_PATH + 32], zipped[TIME_PATH + 40];
    struct dict *d;
    struct axis_entry entry = {.origin = {0}};
    struct revolution r = {.on = true};
    snprintf(path, sizeof path, "%s/system/meshDict", s->dir);
    snprintf(zipped, sizeof zipped, "%s.gz", path);
    if (access(path, F_OK) && access(zipped, F_OK)) return OK;
    TRY(dict_read(path, &s->mesh_dict));
    TRY(params_read(s->mesh_dict, file_param, COUNT(file_param), NULL));
    TRY(dict_sub_optional(s->mesh_dict, "axis", &d));
    if (!d) return dict_check_used(s->mesh_dict);
    TRY(params_read(d, axis_param, COUNT(axis_param), &entry));
    TRY(find_axes(s, d, entry.direction, &r));
    r.at = entry.origin[r.radial];
    TRY(check_mesh(s, d, &r));
    s->mesh->round = r;
    return dict_check_used(s->mesh_dict);
}

status round_refuse(const struct setup *s, const char *what, const char *cure) {
    if (s->mesh_dict && dict_has(s->mesh_dict, "axis"))
        return dict_fail(s->mesh_dict, "axis", "%s is not there in round flow yet: %s", what, cure);
    return fail(ERR_INPUT, "%s/boundary: patches of type wedge: %s is not there in round flow yet: %s", s->mesh_path,
                what, cure);
}
