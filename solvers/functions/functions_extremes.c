/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object fieldMinMax writes the smallest and the largest value of fields, and their places. */
#include "solvers/functions/functions_private.h"

#include "libcore/models/kernel.h"

#include <limits.h>
#include <math.h>
#include <string.h>

struct reached { /* a cell and its centre, m; found by a search, in which all ranks take part */
    int cell;
    double x[3];
};
struct extremes {
    int *lowest;          /* [blocks] the lowest polyMesh cell of each block; made by the first execution */
    struct reached *spot; /* [fields][2] where the extremes were last; made likewise */
};

static const char *const modes[] = {"magnitude", NULL};
static const struct param extremes_param[] = {
    ONLY("mode", 0, modes, "of a vector: its magnitude"),
    IGNORED("location", "for OpenFOAM: places are written"),
};

/* Replaces a vector's first component by its magnitude. */
static void magnitudes(int components, int n, double *const lines[3]) {
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = 0; k < components; k++) square += lines[k][i] * lines[k][i];
        lines[0][i] = sqrt(square);
    }
}

/* Finds the least and the largest of n values, eight lanes at a time: minima and maxima do not depend on the order. */
KERNEL static void range_of(int n, const double *restrict v, double range[2]) {
    double low[8], high[8];
    int i = 0;
    for (int j = 0; j < 8; j++) high[j] = -(low[j] = HUGE_VAL);
    for (; i + 8 <= n; i += 8)
        for (int j = 0; j < 8; j++) {
            low[j] = v[i + j] < low[j] ? v[i + j] : low[j];
            high[j] = v[i + j] > high[j] ? v[i + j] : high[j];
        }
    for (; i < n; i++) {
        low[0] = v[i] < low[0] ? v[i] : low[0];
        high[0] = v[i] > high[0] ? v[i] : high[0];
    }
    range[0] = low[0];
    range[1] = high[0];
    for (int j = 1; j < 8; j++) {
        range[0] = low[j] < range[0] ? low[j] : range[0];
        range[1] = high[j] > range[1] ? high[j] : range[1];
    }
}

/* Finds the index of the cell with the lowest number below a bound among those that have the value; -1: there is
 * none. */
static int lowest_cell(int n, const double *v, double value, const int *cell, double below) {
    int lowest = below < INT_MAX ? (int)below : INT_MAX, found = -1;
    for (int i = 0; i < n; i++)
        if (cell[i] < lowest && v[i] == value) {
            lowest = cell[i];
            found = i;
        }
    return found;
}

/* Finds a field's extremes (of a vector: those of its magnitude) and the lowest polyMesh cell that reaches each. */
static void find_extremes(const struct function *f, int field, double value[2], int cell[2]) {
    const struct grid *grid = f->setup->grid;
    const int *lowest = ((const struct extremes *)f->own)->lowest;
    const bool vector = quantity_of(f, field)->components == 3;
    double best[2] = {HUGE_VAL, HUGE_VAL}, where[2] = {HUGE_VAL, HUGE_VAL}, mine[2], range[2], *lines[3];
    for (int b = 0; b < grid->nblocks; b++) {
        const int n = function_values(f, b, field, lines), *numbers = n > 1 ? grid->block[b].cell : &lowest[b];
        if (vector) magnitudes(setup_lines(f->setup, field), n, lines);
        range_of(n, lines[0], range);
        for (int end = 0; end < 2; end++) {
            const double w = end ? -range[1] : range[0];
            if (w > best[end] || (w == best[end] && lowest[b] >= where[end])) continue;
            const int i = lowest_cell(n, lines[0], range[end], numbers, w < best[end] ? HUGE_VAL : where[end]);
            if (i < 0) continue;
            best[end] = end ? -lines[0][i] : lines[0][i]; /* a zero keeps the sign that it has in that cell */
            where[end] = numbers[i];
        }
    }
    memcpy(mine, best, sizeof mine);
    comm_min(f->setup->comm, best, 2);
    for (int end = 0; end < 2; end++)
        if (mine[end] != best[end]) where[end] = HUGE_VAL;
    comm_min(f->setup->comm, where, 2);
    for (int end = 0; end < 2; end++) {
        value[end] = end ? -best[end] : best[end];
        cell[end] = isfinite(where[end]) ? (int)where[end] : 0;
    }
}

static status find_lowest(const struct function *f, int **out) {
    const struct grid *grid = f->setup->grid;
    TRY(pool_take(f->pool, out, grid->nblocks + 1L, sizeof **out, "blocks"));
    for (int b = 0; b < grid->nblocks; b++) {
        (*out)[b] = INT_MAX;
        for (int i = 0; i < grid->block[b].ncells; i++)
            if (grid->block[b].cell[i] < (*out)[b]) (*out)[b] = grid->block[b].cell[i];
    }
    return OK;
}

/* Returns the centre of a cell, which every rank names. */
static const double *place_of(const struct function *f, int cell, struct reached *spot) {
    if (spot->cell != cell) setup_place(f->setup, cell, spot->x);
    spot->cell = cell;
    return spot->x;
}

static status begin(const struct function *f, struct extremes *e) {
    TRY(pool_take(f->pool, &e->spot, 2L * f->nfields + 1, sizeof *e->spot, "places"));
    for (int i = 0; i < 2 * f->nfields; i++) e->spot[i].cell = -1;
    return find_lowest(f, &e->lowest);
}

static void extremes_head(const struct function *f, int i, FILE *o) {
    (void)f;
    (void)i;
    fprintf(o, "# Field minima and maxima\n# Time          \tfield\tmin\tlocation(min)\tmax\tlocation(max)\n");
}

/* Writes the row of a field: value and place of its least and its largest value. */
static status write_row(struct function *f, double t, const char *name, const double v[2], const double *const at[2]) {
    FILE *o;
    TRY(function_row(f, 0, t, &o));
    if (o) fprintf(o, "\t%s", name);
    for (int end = 0; end < 2; end++) {
        function_value(o, '\t', 12, 1, &v[end]);
        function_value(o, '\t', 12, 3, at[end]);
    }
    TRY(function_end_row(f, o));
    if (o && f->log) printf("    %s: min(%s) = %g, max(%s) = %g\n", f->name, name, v[0], name, v[1]);
    return OK;
}

static status extremes_execute(struct function *f, const struct moment *now, const char *time) {
    struct extremes *e = f->own;
    (void)time;
    status s = e->lowest ? OK : begin(f, e);
    TRY(comm_agree(f->setup->comm, s));
    for (int k = 0; k < f->nfields; k++) {
        double v[2];
        int cell[2];
        find_extremes(f, f->field[k], v, cell);
        const double *const at[2] = {place_of(f, cell[0], &e->spot[2 * k]), place_of(f, cell[1], &e->spot[2 * k + 1])};
        if (!s) s = write_row(f, now->t, quantity_of(f, f->field[k])->name, v, at);
    }
    return comm_agree(f->setup->comm, s);
}

const struct function_type function_extremes = {
    .name = "fieldMinMax",
    .about = "smallest and largest value and where",
    FUNCTION_PARAMS(extremes_param),
    .size = sizeof(struct extremes),
    .execute = extremes_execute,
    .table = {"fieldMinMax.dat"},
    .head = extremes_head,
    .width = 16,
};
