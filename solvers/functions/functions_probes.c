/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object probes writes values at given points, one file per field with a row per time. */
#include "solvers/functions/functions_private.h"

#include <stdlib.h>

struct probes {
    struct spots spots;
    int scheme;   /* SPOT_CELL .. */
    bool outside; /* may points lie outside the mesh? */
};

#define PARAM_STRUCT struct probes
static const struct param probes_param[] = {
    NOTED("probeLocations", "list of vectors", NULL, "the points", "probeLocations ((0.01 0.02 0));"),
    SWITCH("allowOutside", outside, false,
           "points outside the mesh give -1e300, as in OpenFOAM; else they are an error"),
    CHOICE(
        "interpolationScheme", scheme, SPOT_CELL, spot_schemes,
        "values are those of the cell; or linear inside it, of second order, exact for linear fields, and on patches "
        "what these give"),
    IGNORED("fixedLocations", "for OpenFOAM: points stay where they are"),
};

static status probes_make(struct function *f, struct dict *d) {
    struct probes *p = f->own;
    const double *points;
    int n;
    TRY(dict_vectors(d, "probeLocations", &n, &points));
    if (n < 1) return dict_fail(d, "probeLocations", "it is empty; give ((x y z) ...)");
    TRY(spots_add(&p->spots, f, d, "probeLocations", n, points, p->outside));
    return p->scheme == SPOT_CELL_POINT ? spots_interpolate(&p->spots, f) : OK;
}

static void probes_head(const struct function *f, int i, FILE *o) {
    const struct probes *p = f->own;
    (void)i;
    for (int k = 0; k < p->spots.n; k++) {
        const struct spot *s = &p->spots.at[k];
        fprintf(o, "# Probe %d (%.12g %.12g %.12g)%s\n", k, s->x[0], s->x[1], s->x[2],
                s->inside ? "" : "  # Not Found");
    }
    fprintf(o, "#       Time\n");
}

static status probes_execute(struct function *f, const struct moment *now, const char *time) {
    struct probes *p = f->own;
    (void)time;
    for (int k = 0; k < f->nfields; k++) {
        const int m = quantity_of(f, f->field[k])->components;
        double *values;
        FILE *o;
        TRY(spots_sample(&p->spots, f, f->field[k], &values));
        status s = function_row(f, k, now->t, &o);
        for (int i = 0; i < p->spots.n; i++) function_value(o, ' ', 12, m, values + (long)m * i);
        if (!s) s = function_end_row(f, o);
        free(values);
        TRY(comm_agree(f->setup->comm, s));
    }
    return OK;
}

static void probes_free(void *own) {
    spots_free(&((struct probes *)own)->spots);
}

const struct function_type function_probes = {
    .name = "probes",
    .about = "values at given points, one row per time",
    FUNCTION_PARAMS(probes_param),
    .size = sizeof(struct probes),
    .make = probes_make,
    .execute = probes_execute,
    .free = probes_free,
    .head = probes_head,
};
