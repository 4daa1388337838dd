/* SPDX-License-Identifier: GPL-3.0-or-later */
/* constant/segregationProperties with system/fvSchemes, system/fvSolution and constant/g: numbers, laws, choices. */
#include "solvers/segregation/segregation_models.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void try_laws(const struct segregation_models *m) {
    const double x[3] = {0.5, -0.25, 0};
    PROMISE(m->velocity_law || m->percolation != PERCOLATION_EXPRESSION, "an expression is compiled");
    if (m->velocity_law) (void)expr_value(m->velocity_law, x[0], x[1], x[2], 0);
    if (accepted(segregation_diffusivity_check(m, x, 3)))
        PROMISE(segregation_diffusivity(m, x, 0.5, 3) >= 0, "what was checked is 0 or more");
    PROMISE(!m->sheared || m->diffusivity_law, "a shear rate stands in a law");
}

static void try_models(const struct segregation_models *m) {
    const double *d = m->direction, numbers[] = {m->velocity,         m->diffusivity,   m->A, m->B, m->q, m->rho,
                                                 m->scheme.tolerance, m->time_tolerance};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) PROMISE(isfinite(numbers[i]), "numbers are finite");
    PROMISE(m->diffusivity >= 0 && m->time_tolerance > 0 && m->scheme.most > 0 && m->damped >= 0,
            "numbers are in range");
    PROMISE(!m->has_direction || fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-9, "a direction has length 1");
    PROMISE(isnan(m->time) || isfinite(m->time), "a time is one or the latest");
    PROMISE(m->scheme.closure == SEGREGATION_CONSERVATIVE || (m->on_walls && m->scheme.unbounded),
            "closures of the paper have values on the walls and no bounds");
    try_laws(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {"system/fvSchemes", "system/fvSolution"};
    char path[256];
    struct segregation_models *m;
    scratch_unpack("case", "constant/segregationProperties", data, size);
    for (int i = 0; i < 2; i++) { /* both may be left out of an input */
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        if (!field_exists(path)) scratch_write(path + strlen(scratch()) + 1, "", 0);
    }
    snprintf(path, sizeof path, "%s/case", scratch());
    if (accepted(segregation_models_read(path, &m))) {
        FILE *nowhere = fopen("/dev/null", "w");
        try_models(m);
        if (nowhere) {
            segregation_models_print(nowhere, m);
            fclose(nowhere);
        }
        segregation_models_free(m);
    }
    scratch_clear();
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        remove(path);
    }
    return 0;
}
