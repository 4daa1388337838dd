/* SPDX-License-Identifier: GPL-3.0-or-later */
/* constant/granularProperties with system/fvSchemes, system/fvSolution, constant/g and constant/shaking: the models of
 * the gas and their parameters. */
#include "solvers/gas/models.h"
#include "tests/fuzz/target.h"

#include "solvers/case/fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The parameters of a chosen row lie in its ranges; those of an equation of state are members of the material. */
static void try_row(const struct model *row, const void *base) {
    for (int i = 0; i < row->nparam; i++) {
        const struct param *p = &row->param[i];
        const void *member = (const char *)base + p->offset;
        double x[3] = {0};
        int word;
        if (p->kind == PARAM_CHOICE) {
            memcpy(&word, member, sizeof word);
            PROMISE(word == 0 || p->words[word], "a word is one of the list");
            for (int k = 0; k < word; k++) PROMISE(p->words[k], "a word is one of the list");
        }
        if (p->kind == PARAM_NUMBER) memcpy(x, member, sizeof *x);
        if (p->kind == PARAM_VECTOR) memcpy(x, member, sizeof x);
        for (int k = 0; k < 3; k++) PROMISE(isfinite(x[k]), "numbers are finite");
        if (p->kind == PARAM_NUMBER) PROMISE(x[0] >= p->low && x[0] <= p->high, "numbers are in range");
    }
}

static void try_models(const struct case_models *m) {
    const struct gas_models *g = &m->gas;
    const struct material *grain = &g->material;
    PROMISE(g->eos && g->flux && g->reconstruct && g->stepper && g->polynomial && g->diffusion, "schemes are chosen");
    PROMISE(grain->diameter >= 0 && grain->mass > 0 && grain->restitution >= 0 && grain->restitution <= 1,
            "grains are sound");
    PROMISE(!eos_objection(g->eos, grain), "parameters go with each other");
    PROMISE(!g->transport || (grain->diameter > 0 && g->transport->valid & shape_of(grain)),
            "transport of such grains");
    PROMISE(grain->restitution == 1 || dict_has(m->properties, "cooling"), "cooling is said");
    try_row(&g->eos->model, grain);
    if (g->transport) try_row(&g->transport->model, &g->transport_params);
    for (int i = 0; i < source_count; i++)
        if (g->source.on[i]) try_row(&source_table[i].model, &g->source.params[i]);
}

/* In three dimensions, or in x and z alone. */
static void try_case(const char *path, int dim) {
    static const int axis[2][3] = {{0, 1, 2}, {0, 2, 1}};
    struct case_models *m;
    if (!accepted(models_read(path, dim, axis[dim == 2], &m))) return;
    FILE *nowhere = fopen("/dev/null", "w");
    try_models(m);
    if (nowhere) {
        models_print(nowhere, m, dim == 3);
        fclose(nowhere);
    }
    models_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {"system/fvSchemes", "system/fvSolution"};
    char path[256];
    scratch_unpack("case", "constant/granularProperties", data, size);
    for (int i = 0; i < 2; i++) { /* both may be left out of an input */
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        if (!field_exists(path)) scratch_write(path + strlen(scratch()) + 1, "", 0);
    }
    snprintf(path, sizeof path, "%s/case", scratch());
    for (int dim = 2; dim <= 3; dim++) try_case(path, dim);
    scratch_clear();
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        remove(path);
    }
    return 0;
}
