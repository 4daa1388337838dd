/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solvers/gas/layers.h"
#include "solvers/segregation/segregation_models.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static struct patch patches[] = {
    {"inlet", "patch", NULL, 5, 2, NULL, NULL},         {"wall", "wall", NULL, 7, 2, NULL, NULL},
    {"left", "cyclic", "right", 9, 2, NULL, NULL},      {"right", "cyclic", "left", 11, 2, NULL, NULL},
    {"frontAndBack", "empty", NULL, 13, 8, NULL, NULL}, {"axis", "symmetry", NULL, 21, 0, NULL, NULL},
};
#define THRICE(...) __VA_ARGS__, __VA_ARGS__, __VA_ARGS__
static double points[54] = {0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1};
static int face_start[22] = {0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64, 68, 72, 76, 80, 84},
           face_points[84] = {
               THRICE(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3)};
static const struct polymesh mesh = {.npoints = 18,
                                     .nfaces = 21,
                                     .ninternal = 5,
                                     .ncells = 4,
                                     .npatches = 6,
                                     .points = points,
                                     .face_start = face_start,
                                     .face_points = face_points,
                                     .patch = patches};
static const double centre[12] = {0.5, 0.5, 0.5, 1.5, 0.5, 0.5, 0.5, 1.5, 0.5, 1.5, 1.5, 0.5};

static const struct field_place place = {.mesh = &mesh, .centre = centre, .t = 0.25};

static void try_field(struct field *f) {
    const struct field_kind *kind = f->kind;
    const int n = 4 * kind->components;
    double out[12];
    for (int i = 0; i < n; i++) PROMISE(isfinite(f->values[i]), "values are finite");
    for (int p = 0; p < f->npatches; p++)
        for (int i = 0; f->patch[p].values && i < patches[p].nfaces * kind->components; i++)
            PROMISE(isfinite(f->patch[p].values[i]), "values of patches are finite");
    (void)accepted(field_fail(f, &place, 3, "no"));
    if (kind->components == 1) (void)accepted(field_check_range(f, &place, 0, INFINITY, ""));
    for (int p = 0; p < f->npatches; p++)
        if (f->patch[p].varying) (void)accepted(field_renew(f, p, 1.5, ERR_STATE));
    (void)accepted(field_steady(f, &mesh));
    if (field_has_expression(f)) (void)accepted(field_evaluate(f, 4, centre, 1, out));
    field_free(f);
}

/* As granularGas reads it: rho and alpha may have layers. */
static void try_gas_field(const char *path, enum field_id id) {
    struct layers *layers;
    struct field *f;
    if (!accepted(layers_read_field(path, id, &place, &layers, &f))) return;
    PROMISE(f->plan.changes == (layers != NULL), "layers, and nothing else, change the values");
    try_field(f);
    layers_free(layers);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    int components;
    double *values = NULL;
    struct field *f;
    scratch_unpack("case", "0/f", data, size);
    snprintf(path, sizeof path, "%s/case/0/f", scratch());
    try_gas_field(path, FIELD_T);
    try_gas_field(path, FIELD_U);
    try_gas_field(path, FIELD_ALPHA);
    if (accepted(field_read(path, &segregation_phi, &place, &f))) try_field(f);
    if (accepted(field_read_values(path, 4, &components, &values))) {
        for (int i = 0; i < 4 * components; i++) PROMISE(isfinite(values[i]), "values are finite");
        free(values);
    }
    scratch_clear();
    return 0;
}
