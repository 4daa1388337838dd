/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object volFieldValue writes integrals, averages, sums and extremes of fields over all cells. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdlib.h>

struct integral {
    int operation; /* VOL_INTEGRATE .. MAXIMUM */
    FILE *file;    /* on the root; opened by the first execution */
};

enum { VOL_INTEGRATE, VOL_AVERAGE, SUM, MINIMUM, MAXIMUM };
static const char *const operation_names[] = {"volIntegrate", "volAverage", "sum", "min", "max", NULL};
static const char *const regions[] = {"all", NULL};
#define PARAM_STRUCT struct integral
static const struct param integral_param[] = {
    CHOICE("operation", operation, REQUIRED, operation_names, "over all cells"),
    ONLY("regionType", 0, regions, "the whole mesh"),
};

static status integral_make(struct function *f, struct dict *d) {
    struct integral *v;
    TRY(allocate(&v, 1, sizeof *v, "an integral"));
    f->own = v;
    return params_read(d, f->type->param, f->type->nparam, v);
}

/* Reduces one block: to the sums of a field's m components and, for an average, of the weights in sum[m]; or to
 * extremes. */
static void reduce_block(const struct function *f, int field, int b, int m, double sum[4], double extreme[3]) {
    const struct grid_block *block = &f->setup->grid->block[b];
    const double *volume = f->setup->grid->volume;
    const int operation = ((const struct integral *)f->own)->operation;
    double *lines[3];
    function_block(f, b, field, lines);
    sum[m] = 0;
    for (int i = 0; i < block->ncells && operation == VOL_AVERAGE; i++) sum[m] += volume[block->cell[i]];
    for (int c = 0; c < m; c++) {
        const double *v = lines[c];
        double total = 0;
        if (operation > SUM)
            for (int i = 0; i < block->ncells; i++) extreme[c] = fmin(extreme[c], operation == MAXIMUM ? -v[i] : v[i]);
        else if (operation == SUM)
            for (int i = 0; i < block->ncells; i++) total += v[i];
        else
            for (int i = 0; i < block->ncells; i++) total += volume[block->cell[i]] * v[i];
        sum[c] = total;
    }
}

/* Reduces a field. Sums run cell by cell within a block and block by block over all ranks, so that they have the same
 * bits on any number of ranks. */
static status reduce(const struct function *f, int field, double out[3]) {
    const struct grid *grid = f->setup->grid;
    const int operation = ((const struct integral *)f->own)->operation;
    bool vector = quantity_of(f, field)->components == 3;
    int m = setup_lines(f->setup, field);
    double *per_block, sum[4] = {0}, result[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    TRY(allocate(&per_block, (m + 1L) * (grid->nblocks + 1), sizeof(double), "sums of blocks"));
    for (int b = 0; b < grid->nblocks; b++) {
        reduce_block(f, field, b, m, sum, result);
        for (int c = 0; c <= m; c++) per_block[(long)c * grid->nblocks + b] = sum[c];
    }
    status s = OK;
    for (int c = 0; c <= m && operation <= SUM && !s; c++)
        s = grid_sum(grid, per_block + (long)c * grid->nblocks, &sum[c]);
    free(per_block);
    if (operation > SUM) comm_min(f->setup->comm, result, m);
    for (int x = 0; x < 3; x++) out[x] = 0;
    for (int c = 0; c < m; c++)
        out[vector ? f->setup->axis[c] : 0] = operation == VOL_AVERAGE ? sum[c] / sum[m]
                                              : operation <= SUM       ? sum[c]
                                              : operation == MAXIMUM   ? -result[c]
                                                                       : result[c];
    return s;
}

static status integral_open(const struct function *f, struct integral *v) {
    const struct grid *grid = f->setup->grid;
    double volume = 0, part = 0;
    TRY(function_open(f, f->setup->start.name, "volFieldValue.dat", &v->file));
    for (int i = 0; i < grid->ncells_all; i++) { /* in pieces, which keep the digits of many equal volumes */
        part += grid->volume[i];
        if (i % 1000 != 999) continue;
        volume += part;
        part = 0;
    }
    fprintf(v->file, "# Region type : all\n# Cells  : %d\n# Volume : %.12g\n# Time          ", grid->ncells_all,
            volume + part);
    for (int k = 0; k < f->nfields; k++)
        fprintf(v->file, "\t%s(%s)", operation_names[v->operation], quantity_of(f, f->field[k])->name);
    fprintf(v->file, "\n");
    return OK;
}

static status integral_execute(struct function *f, const struct moment *now, const char *time) {
    struct integral *own = f->own;
    (void)time;
    bool root = comm_root(f->setup->comm);
    status s = root && !own->file ? integral_open(f, own) : OK;
    if (root && !s) fprintf(own->file, "%-16.12g", now->t);
    for (int k = 0; k < f->nfields; k++) {
        double v[3];
        status reduced = reduce(f, f->field[k], v);
        if (!s) s = reduced;
        if (!root || s) continue;
        if (quantity_of(f, f->field[k])->components == 3)
            fprintf(own->file, "\t(%.15g %.15g %.15g)", v[0], v[1], v[2]);
        else
            fprintf(own->file, "\t%.15g", v[0]);
        if (f->log)
            printf("    %s: %s(%s) = %.12g\n", f->name, operation_names[own->operation],
                   quantity_of(f, f->field[k])->name, v[0]);
    }
    if (root && !s) s = function_end_row(f, own->file);
    return comm_agree(f->setup->comm, s);
}

static void integral_free(void *own) {
    struct integral *v = own;
    if (v->file) fclose(v->file);
    free(v);
}

const struct function_type function_integral = {
    .name = "volFieldValue",
    .about = "volIntegrate, volAverage, sum, min or max over all cells",
    FUNCTION_PARAMS(integral_param),
    .make = integral_make,
    .execute = integral_execute,
    .free = integral_free,
};
