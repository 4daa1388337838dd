/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What LAMMPS answers to granularDEM: the dumps of a moment of a few grains between two walls. */
#define _GNU_SOURCE /* fmemopen */
#include "solvers/dem/dem_answer.h"
#include "solvers/dem/lammps_private.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GRAINS = 6 };
static const double SIDE = 8e-3;

/* An error tells what is wrong, in text without control characters; ours are the machine's, not the user's. */
static bool answered(status s) {
    if (!s) return true;
    PROMISE(*status_text(s), "an error says what is wrong");
    for (const char *c = status_text(s); *c; c++)
        PROMISE((unsigned char)*c >= ' ' || *c == '\n', "an error holds no control characters");
    status_free(s);
    return false;
}

static void try_moment(const struct dem_moment *m, const struct dem_walls *w) {
    PROMISE(m->n >= 0 && m->n <= m->nold && (w->open || m->n == m->nold), "there are as many grains as there can be");
    for (int i = 0; i < m->n; i++) {
        PROMISE(m->id[i] >= 1 && m->id[i] <= m->nold && (i == 0 || m->id[i] > m->id[i - 1]), "numbers ascend");
        for (int k = 0; k < 3; k++)
            PROMISE(isfinite(m->x[i][k]) && isfinite(m->u[i][k]) && isfinite(m->spin[i][k]), "numbers are finite");
        for (int k = 0; k < w->dim; k++)
            PROMISE(m->x[i][k] >= -SIDE * (1 + 1e-9) && m->x[i][k] <= 2 * SIDE * (1 + 1e-9), "grains are near the box");
    }
    for (long i = 0; i < m->ncontacts; i++) {
        const struct dem_contact *c = &m->contact[i];
        PROMISE(c->a >= 0 && c->a < m->n && c->b >= -w->n && c->b < m->n, "those in contact are there");
        for (int k = 0; k < 3; k++)
            PROMISE(isfinite(c->branch[k]) && !isnan(c->push[k]) && !isnan(c->drag[k]), "contacts are of numbers");
    }
}

static void try_answer(const uint8_t *data, size_t size, bool open) {
    const struct dem_walls walls = {
        .dim = 3,
        .high = {SIDE, SIDE, SIDE},
        .periodic = {true, false, true},
        .open = open,
        .n = 2,
        .wall = {{.edge = {{SIDE, 0, 0}, {0, 0, SIDE}}, .axis = 1},
                 {.corner = {0, SIDE, 0}, .edge = {{SIDE, 0, 0}, {0, 0, SIDE}}, .axis = 1, .side = 1}}};
    const struct dem_law law = {.diameter = 1e-3, .mass = 1e-6, .walls = &walls};
    struct lammps *l = calloc(1, sizeof *l);
    struct dem_moment m = {.n = 0};
    int index[GRAINS + 1];
    if (l) l->to = fopen("/dev/null", "w");
    if (l) l->from = size ? fmemopen((void *)(uintptr_t)data, size, "r") : NULL;
    if (l && l->to && l->from && answered(dem_moment_make(GRAINS, &m))) {
        if (answered(dem_answer_take(l, &law, index, &m))) {
            try_moment(&m, &walls);
            (void)answered(lammps_wait(l));
        }
        dem_moment_free(&m);
    }
    lammps_free(l);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    for (int open = 0; open < 2; open++) try_answer(data, size, open);
    return 0;
}
