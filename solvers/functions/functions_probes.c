/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object probes writes values at given points, one file per field with a row per time. */
#include "solvers/functions/functions_private.h"

#include <stdlib.h>

struct probes {
    struct spots spots;
    FILE *file[MAX_QUANTITIES]; /* [fields] on the root; opened by the first execution */
    int scheme;                 /* SPOT_CELL .. */
    bool outside;               /* may points lie outside the mesh? */
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
    struct probes *p;
    const double *points;
    int n;
    TRY(allocate(&p, 1, sizeof *p, "probes"));
    f->own = p;
    TRY(params_read(d, f->type->param, f->type->nparam, p));
    TRY(dict_vectors(d, "probeLocations", &n, &points));
    if (n < 1) return dict_fail(d, "probeLocations", "it is empty; give ((x y z) ...)");
    TRY(spots_add(&p->spots, f, d, "probeLocations", n, points, p->outside));
    return p->scheme == SPOT_CELL_POINT ? spots_interpolate(&p->spots, f) : OK;
}

static status probes_open(const struct function *f, int field) {
    struct probes *p = f->own;
    TRY(function_open(f, f->setup->start.name, quantity_of(f, f->field[field])->name, &p->file[field]));
    for (int i = 0; i < p->spots.n; i++) {
        const struct spot *s = &p->spots.at[i];
        fprintf(p->file[field], "# Probe %d (%.12g %.12g %.12g)%s\n", i, s->x[0], s->x[1], s->x[2],
                s->inside ? "" : "  # Not Found");
    }
    fprintf(p->file[field], "#       Time\n");
    return OK;
}

static status probes_execute(struct function *f, const struct moment *now, const char *time) {
    struct probes *p = f->own;
    (void)time;
    for (int k = 0; k < f->nfields; k++) {
        double *values;
        int m = quantity_of(f, f->field[k])->components;
        TRY(spots_sample(&p->spots, f, f->field[k], &values));
        status s = OK;
        if (comm_root(f->setup->comm)) {
            if (!p->file[k]) s = probes_open(f, k);
            if (!s) fprintf(p->file[k], "%.12g", now->t);
            for (int i = 0; !s && i < p->spots.n; i++)
                if (m == 1)
                    fprintf(p->file[k], " %.12g", values[i]);
                else
                    fprintf(p->file[k], " (%.12g %.12g %.12g)", values[3 * i], values[3 * i + 1], values[3 * i + 2]);
            if (!s) s = function_end_row(f, p->file[k]);
        }
        free(values);
        TRY(comm_agree(f->setup->comm, s));
    }
    return OK;
}

static void probes_free(void *own) {
    struct probes *p = own;
    for (int k = 0; k < MAX_QUANTITIES; k++)
        if (p->file[k]) fclose(p->file[k]);
    spots_free(&p->spots);
    free(p);
}

const struct function_type function_probes = {
    .name = "probes",
    .about = "values at given points, one row per time",
    FUNCTION_PARAMS(probes_param),
    .make = probes_make,
    .execute = probes_execute,
    .free = probes_free,
};
