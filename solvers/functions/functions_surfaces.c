/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object surfaces writes what planes cut out of the mesh, and surfaces where a field has a value, as polygons
 * with values of fields: a legacy VTK file for each surface and time. The root gathers the fields and makes the
 * surfaces alone, so that files are the same on any number of ranks; a surface may be empty at a time. */
#include "solvers/functions/functions_private.h"

#include "mesh/grid/slices.h"
#include "solvers/output/output.h"
#include "solvers/output/vtk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLANE, LEVEL };
struct one { /* entry of `surfaces` */
    char name[128];
    int type;                   /* PLANE, LEVEL */
    bool interpolate;           /* are values given at corners? Else of the cell, in each polygon */
    double point[3], normal[3]; /* of a plane */
    int field;                  /* quantity of a level set */
    double level;
    struct slice slice; /* on the root; that of a plane is made once */
};
struct surfaces {
    bool ascii, interpolate;
    int n;
    struct one *one;           /* [n] */
    struct vicinity *vicinity; /* on the root; made by the first execution, as is values */
    double *values;            /* on the root: [3 ncells] of the field at hand */
    double *level_values;      /* on the root: of the field that a level set is of, as values */
};

static const char *const formats[] = {"vtk", NULL}, *const write_formats[] = {"binary", "ascii", NULL},
                         *const schemes[] = {"cellPoint", NULL}, *const types[] = {"cuttingPlane", "isoSurface", NULL},
                         *const plane_types[] = {"pointAndNormal", NULL};
#define PARAM_STRUCT struct surfaces
static const struct param surfaces_param[] = {
    ONLY("surfaceFormat", 0, formats, "legacy VTK files of polygons"),
    EITHER("writeFormat", ascii, false, write_formats, "of the VTK files"),
    SWITCH("interpolate", interpolate, true,
           "are values given at the corners of polygons, of second order? Else those of cells, in polygons"),
    ONLY("interpolationScheme", 0, schemes, "linear in cells"),
    NOTED("surfaces", "list of dictionaries, or dictionary", NULL,
          "a dictionary for each surface; its name, which is yours, is that of the file",
          "surfaces ( cut { type cuttingPlane; planeType pointAndNormal; pointAndNormalDict { point (0.01 0.01 0.01); "
          "normal (1 0 0); } } );"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct one
static const struct param one_param[] = {
    CHOICE("type", type, REQUIRED, types, "a plane, or where a field has a value"),
    NOTED("interpolate", "switch", "that of the function object", "as there, for this surface", "interpolate true;"),
};
static const struct param plane_param[] = {
    ONLY("planeType", REQUIRED, plane_types, "how the plane is given"),
    NOTED("pointAndNormalDict", "dictionary", NULL, "the plane",
          "pointAndNormalDict { point (0.01 0.01 0.01); normal (1 0 0); }"),
};
static const struct param normal_param[] = {
    VECTOR("point", point, REQUIRED_AS("point (0.01 0.01 0.01);"), ANY_NUMBER, UNIT(0, 1, 0), "a point of the plane"),
    VECTOR("normal", normal, REQUIRED_AS("normal (1 0 0);"), ANY_NUMBER, NO_UNIT, "its normal, of any length"),
};
static const struct param level_param[] = {
    NOTED("isoField", "word", NULL, "scalar field", "isoField alpha;"),
    NUMBER("isoValue", level, REQUIRED_AS("isoValue 0.3;"), ANY_NUMBER, NO_UNIT, "that it has on the surface"),
    IGNORED("regularise", "for OpenFOAM"),
    IGNORED("mergeTol", "for OpenFOAM"),
};
#undef PARAM_STRUCT
#define COUNT(table) ((int)(sizeof table / sizeof *table))
#define SURFACE      FUNCTION_DICT "/surfaces/SURFACE"

static void surfaces_keywords(struct keywords *k) {
    keywords_at(k, FUNCTION_FILE, SURFACE, NULL);
    keywords_params(k, one_param, COUNT(one_param));
    keywords_at(k, FUNCTION_FILE, SURFACE, types[PLANE]);
    keywords_params(k, plane_param, COUNT(plane_param));
    keywords_at(k, FUNCTION_FILE, SURFACE "/pointAndNormalDict", NULL);
    keywords_params(k, normal_param, COUNT(normal_param));
    keywords_at(k, FUNCTION_FILE, SURFACE, types[LEVEL]);
    keywords_params(k, level_param, COUNT(level_param));
}

/* ---- reading ---- */

static status read_plane(const struct function *f, struct one *one, struct dict *d) {
    const struct polymesh *mesh = f->setup->mesh;
    struct dict *sub;
    double *distance, size = 0;
    bool above = false, below = false;
    TRY(params_read(d, plane_param, COUNT(plane_param), one));
    TRY(dict_sub(d, "pointAndNormalDict", &sub));
    TRY(params_read(sub, normal_param, COUNT(normal_param), one));
    for (int k = 0; k < 3; k++) size = hypot(size, one->normal[k]);
    if (!(size > 0)) return dict_fail(sub, "normal", "a normal has a length");
    for (int k = 0; k < 3; k++) one->normal[k] /= size;
    TRY(setup_complete(f->setup));
    TRY(slice_distances(mesh, one->point, one->normal, &distance));
    for (int i = 0; i < mesh->npoints; i++) {
        above |= distance[i] >= 0;
        below |= distance[i] < 0;
    }
    free(distance);
    return above && below ? OK : dict_fail(sub, "point", "the plane through it does not cut the mesh");
}

static status read_level(struct function *f, struct one *one, struct dict *d) {
    const char *word;
    TRY(params_read(d, level_param, COUNT(level_param), one));
    TRY(dict_word(d, "isoField", &word));
    TRY(function_field(f, d, "isoField", word, &one->field));
    return quantity_of(f, one->field)->components == 1 ? OK : dict_fail(d, "isoField", "it has to be a scalar field");
}

static status read_one(struct function *f, struct surfaces *s, const char *name, struct dict *d) {
    struct one *one = &s->one[s->n++];
    snprintf(one->name, sizeof one->name, "%s", name);
    TRY(params_read(d, one_param, COUNT(one_param), one));
    TRY(dict_switch_or(d, "interpolate", s->interpolate, &one->interpolate));
    return one->type == PLANE ? read_plane(f, one, d) : read_level(f, one, d);
}

static status surfaces_make(struct function *f, struct dict *d) {
    struct dict *all, *sub;
    struct surfaces *s = f->own;
    TRY(dict_sub(d, "surfaces", &all));
    const int n = dict_count(all);
    if (!n) return dict_fail(d, "surfaces", "it is empty");
    TRY(pool_take(f->pool, &s->one, n, sizeof *s->one, "surfaces"));
    for (int i = 0; i < n; i++) {
        TRY(dict_sub(all, dict_key(all, i), &sub));
        TRY(function_name(all, dict_key(all, i)));
        TRY(read_one(f, s, dict_key(all, i), sub));
    }
    return OK;
}

/* ---- writing ---- */

static status prepare(const struct function *f) {
    const struct setup *setup = f->setup;
    struct surfaces *s = f->own;
    if (s->vicinity) return OK;
    TRY(setup_complete(setup));
    TRY(vicinity_make(setup->mesh, setup->centre, setup->dim, setup->axis, &s->vicinity));
    TRY(pool_take(f->pool, &s->values, 3L * setup->mesh->ncells, sizeof(double), "a surface"));
    TRY(pool_take(f->pool, &s->level_values, 3L * setup->mesh->ncells, sizeof(double), "a surface"));
    for (int i = 0; i < s->n; i++)
        if (s->one[i].type == PLANE) TRY(slice_plane(s->vicinity, s->one[i].point, s->one[i].normal, &s->one[i].slice));
    return OK;
}

static status find_level(const struct surfaces *s, struct one *one) {
    struct vicinity_field values;
    slice_free(&one->slice);
    status e = vicinity_field_make(s->vicinity, s->level_values, 1, &values);
    if (!e) e = slice_level(&values, one->level, &one->slice);
    vicinity_field_free(&values);
    return e;
}

/* Finds the values of a component at the corners of a surface, or in its polygons. */
static void find_values(const struct one *one, const struct vicinity_field *values, double *out, int stride) {
    const struct slice *slice = &one->slice;
    for (long i = 0; one->interpolate && i < slice->ncorners; i++)
        out[stride * i] = slice_value(values, &slice->corner[i]);
    for (long i = 0; !one->interpolate && i < slice->npolygons; i++)
        out[stride * i] = values->value[(long)values->stride * slice->cell[i]];
}

/* Fills out[surface][MAX_QUANTITIES] with the values of field k in s->values. */
static status find_field(const struct function *f, int k, double *(*out)[MAX_QUANTITIES]) {
    const struct surfaces *s = f->own;
    const int components = quantity_of(f, f->field[k])->components;
    status e = OK;
    for (int i = 0; !e && i < s->n; i++) {
        const struct slice *slice = &s->one[i].slice;
        e = allocate(&out[i][k], 1 + (long)components * (s->one[i].interpolate ? slice->ncorners : slice->npolygons),
                     sizeof(double), "values on a surface");
    }
    for (int x = 0; !e && x < components; x++) {
        struct vicinity_field values;
        e = vicinity_field_make(s->vicinity, s->values + x, components, &values);
        for (int i = 0; !e && i < s->n; i++) find_values(&s->one[i], &values, out[i][k] + x, components);
        vicinity_field_free(&values);
    }
    return e;
}

static status write_one(const struct function *f, const struct one *one, double *const *values,
                        const struct moment *now, const char *time) {
    const struct surfaces *s = f->own;
    const struct slice *slice = &one->slice;
    const struct vtk_polygons p = {slice->ncorners, slice->npolygons, (const double *)slice->x, slice->start,
                                   slice->around};
    struct vtk_field fields[MAX_QUANTITIES];
    char folder[2 * TIME_PATH], path[3 * TIME_PATH];
    for (int k = 0; k < f->nfields; k++) {
        const struct quantity *q = quantity_of(f, f->field[k]);
        fields[k] = (struct vtk_field){q->name, q->components, values[k]};
    }
    snprintf(folder, sizeof folder, "%s/postProcessing/%s/%s", f->setup->dir, f->name, time);
    snprintf(path, sizeof path, "%s/%s.vtk", folder, one->name);
    TRY(case_make_folders(f->setup, folder));
    return vtk_write_polygons(path, s->ascii, now->t, now->step, &p, !one->interpolate, f->nfields, fields);
}

/* Makes the level sets of this time, one field after the other. Collective. */
static status find_levels(struct function *f) {
    struct surfaces *s = f->own;
    const bool root = comm_root(f->setup->comm);
    for (int i = 0; i < s->n; i++) {
        bool held = false;
        for (int j = 0; j < i; j++) held |= s->one[j].type == LEVEL && s->one[j].field == s->one[i].field;
        if (s->one[i].type != LEVEL || held) continue;
        TRY(output_gather(f->setup, s->one[i].field, s->level_values));
        status e = OK;
        for (int j = i; root && !e && j < s->n; j++)
            if (s->one[j].type == LEVEL && s->one[j].field == s->one[i].field) e = find_level(s, &s->one[j]);
        TRY(comm_agree(f->setup->comm, e));
    }
    return OK;
}

static status surfaces_execute(struct function *f, const struct moment *now, const char *time) {
    struct surfaces *s = f->own;
    const struct comm *comm = f->setup->comm;
    const bool root = comm_root(comm);
    double *(*values)[MAX_QUANTITIES];
    TRY(comm_agree(comm, root ? prepare(f) : OK));
    TRY(find_levels(f));
    TRY(comm_agree(comm, allocate(&values, s->n, sizeof *values, "values on surfaces")));
    status e = OK;
    for (int k = 0; !e && k < f->nfields; k++) {
        e = output_gather(f->setup, f->field[k], s->values);
        if (!e) e = comm_agree(comm, root ? find_field(f, k, values) : OK);
    }
    for (int i = 0; !e && root && i < s->n; i++) e = write_one(f, &s->one[i], values[i], now, time);
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < f->nfields; k++) free(values[i][k]);
    free(values);
    return comm_agree(comm, e);
}

static void surfaces_free(void *own) {
    struct surfaces *s = own;
    for (int i = 0; s->one && i < s->n; i++) slice_free(&s->one[i].slice);
    vicinity_free(s->vicinity);
}

const struct function_type function_surfaces = {
    .name = "surfaces",
    .about = "planes through the mesh and isosurfaces, VTK files of polygons",
    FUNCTION_PARAMS(surfaces_param),
    .size = sizeof(struct surfaces),
    .keywords = surfaces_keywords,
    .make = surfaces_make,
    .execute = surfaces_execute,
    .free = surfaces_free,
    .with_fields = true,
};
