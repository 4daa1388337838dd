/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object sets writes values along lines, one file per line and time. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct line { /* one entry of `sets` */
    char name[128];
    int axis;     /* coordinate that is written: 0 x, 1 y, 2 z, 3 distance from the start (m), 4 x y z */
    int first, n; /* first spot, and number of spots */
};
struct sets {
    struct spots spots; /* points of all lines */
    int nlines;
    struct line *line; /* [nlines] */
    int scheme;        /* SPOT_CELL .. */
};

static const char *const axis_names[] = {"x", "y", "z", "distance", "xyz", NULL};
static const char *const types[] = {"uniform", NULL}, *const formats[] = {"raw", NULL};
struct line_ends { /* what a line's dictionary says beside its axis */
    double start[3], end[3];
    int n;
};
#define PARAM_STRUCT struct line
static const struct param axis_param[] = {
    ONLY("type", REQUIRED, types, "points at equal distances"),
    CHOICE("axis", axis, REQUIRED, axis_names, "coordinate that is written"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct line_ends
static const struct param ends_param[] = {
    VECTOR("start", start, REQUIRED_AS("start (0.01 0 0);"), ANY_NUMBER, UNIT(0, 1, 0), "first point"),
    VECTOR("end", end, REQUIRED_AS("end (0.01 0.04 0);"), ANY_NUMBER, UNIT(0, 1, 0), "last point"),
    WHOLE("nPoints", n, REQUIRED_AS("nPoints 100;"), FROM_TO(2, MOST_SPOTS), "points; those off the mesh are left out"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct sets
static const struct param sets_param[] = {
    ONLY("setFormat", 0, formats, "columns of text"),
    CHOICE(
        "interpolationScheme", scheme, SPOT_CELL, spot_schemes,
        "values are those of the cell; or linear inside it, of second order, exact for linear fields, and on patches "
        "what these give"),
    NOTED("sets", "dictionary", NULL, "a dictionary for each line; its name, which is yours, is that of the file",
          "sets { upwards { type uniform; axis y; start (0.01 0 0); end (0.01 0.04 0); nPoints 100; } }"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static void sets_keywords(struct keywords *k) {
    keywords_at(k, FUNCTION_FILE, FUNCTION_DICT "/sets/LINE", NULL);
    keywords_params(k, axis_param, COUNT(axis_param));
    keywords_params(k, ends_param, COUNT(ends_param));
}

static status set_make(struct function *f, struct sets *sets, const char *name, struct dict *d) {
    struct line *l = &sets->line[sets->nlines];
    struct line_ends ends;
    double *points;
    TRY(params_read(d, axis_param, COUNT(axis_param), l));
    TRY(params_read(d, ends_param, COUNT(ends_param), &ends));
    const double *start = ends.start, *end = ends.end;
    const long n = ends.n;
    snprintf(l->name, sizeof l->name, "%s", name);
    l->first = sets->spots.n;
    l->n = ends.n;
    TRY(allocate(&points, 3 * n, sizeof(double), "points of a line"));
    for (long i = 0; i < n; i++)
        for (int x = 0; x < 3; x++)
            points[3 * i + x] = i == n - 1 ? end[x] : start[x] + (end[x] - start[x]) * (double)i / (double)(n - 1);
    /* points off the mesh are left out, as OpenFOAM does */
    status s = spots_add(&sets->spots, f, d, "start", (int)n, points, true);
    free(points);
    sets->nlines++;
    bool any = false;
    for (int i = 0; !s && i < (int)n; i++) any |= sets->spots.at[l->first + i].inside;
    return s ? s : any ? OK : dict_fail(d, "start", "no point of the line lies in the mesh");
}

static status sets_make(struct function *f, struct dict *d) {
    struct dict *all, *one;
    struct sets *sets = f->own;
    TRY(dict_sub(d, "sets", &all));
    int n = dict_count(all);
    if (!n) return dict_fail(d, "sets", "it is empty");
    TRY(pool_take(f->pool, &sets->line, n, sizeof *sets->line, "lines"));
    for (int i = 0; i < n; i++) {
        TRY(dict_sub(all, dict_key(all, i), &one));
        TRY(function_name(all, dict_key(all, i)));
        TRY(set_make(f, sets, dict_key(all, i), one));
    }
    return sets->scheme == SPOT_CELL_POINT ? spots_interpolate(&sets->spots, f) : OK;
}

static void print_place(FILE *file, const struct line *l, const struct spot *first, const struct spot *p) {
    double away = hypot(hypot(p->x[0] - first->x[0], p->x[1] - first->x[1]), p->x[2] - first->x[2]);
    if (l->axis == 4)
        fprintf(file, "%.12g\t%.12g\t%.12g", p->x[0], p->x[1], p->x[2]);
    else
        fprintf(file, "%.12g", l->axis == 3 ? away : p->x[l->axis]);
}

/* Writes one file with all scalars (a_alpha_T.xy), or one with the vector field `only` (a_U.xy). */
static status write_line(const struct function *f, const struct line *l, double *const *values, const char *time,
                         bool vectors, int only) {
    const struct sets *sets = f->own;
    const struct spot *spot = sets->spots.at;
    char name[512];
    FILE *file;
    int length = snprintf(name, sizeof name, "%s", l->name);
    for (int k = 0; k < f->nfields; k++)
        if (vectors ? k == only : quantity_of(f, f->field[k])->components == 1)
            length += snprintf(name + length, sizeof name - (size_t)length, "_%s", quantity_of(f, f->field[k])->name);
    snprintf(name + length, sizeof name - (size_t)length, ".xy");
    TRY(function_open(f, time, name, &file));
    for (int i = l->first; i < l->first + l->n; i++) {
        if (!spot[i].inside) continue;
        print_place(file, l, &spot[l->first], &spot[i]);
        for (int k = 0; k < f->nfields; k++) {
            if (!vectors && quantity_of(f, f->field[k])->components == 1) fprintf(file, "\t%.12g", values[k][i]);
            for (int x = 0; vectors && k == only && x < 3; x++) fprintf(file, "\t%.12g", values[k][3 * (long)i + x]);
        }
        fprintf(file, "\n");
    }
    bool bad = ferror(file);
    return fclose(file) || bad ? fail(ERR_SYSTEM, "postProcessing/%s/%s/%s: cannot be written", f->name, time, name)
                               : OK;
}

static status sets_execute(struct function *f, const struct moment *now, const char *time) {
    const struct sets *sets = f->own;
    (void)now;
    double *values[MAX_QUANTITIES] = {NULL};
    bool scalars = false;
    status s = OK;
    for (int k = 0; k < f->nfields; k++) {
        status sampled = spots_sample(&sets->spots, f, f->field[k], &values[k]);
        if (!s) s = sampled;
        scalars |= quantity_of(f, f->field[k])->components == 1;
    }
    for (int i = 0; !s && comm_root(f->setup->comm) && i < sets->nlines; i++) {
        if (scalars) s = write_line(f, &sets->line[i], values, time, false, -1);
        for (int k = 0; !s && k < f->nfields; k++)
            if (quantity_of(f, f->field[k])->components == 3) s = write_line(f, &sets->line[i], values, time, true, k);
    }
    for (int k = 0; k < f->nfields; k++) free(values[k]);
    return comm_agree(f->setup->comm, s);
}

static void sets_free(void *own) {
    spots_free(&((struct sets *)own)->spots);
}

const struct function_type function_sets = {
    .name = "sets",
    .about = "values along lines, one file per line and time",
    FUNCTION_PARAMS(sets_param),
    .size = sizeof(struct sets),
    .keywords = sets_keywords,
    .make = sets_make,
    .execute = sets_execute,
    .free = sets_free,
};
