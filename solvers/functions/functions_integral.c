/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object volFieldValue writes integrals, averages, sums and extremes of fields over all cells. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct integral {
    int operation; /* VOL_INTEGRATE .. MAXIMUM */
    double volume; /* m^3, of all blocks; found by the first execution, as is */
    double *kept;  /* [fields][3][blocks][2] a value that filled a block, and its sum then */
};

enum { VOL_INTEGRATE, VOL_AVERAGE, SUM, MINIMUM, MAXIMUM };
static const char *const operation_names[] = {"volIntegrate", "volAverage", "sum", "min", "max", NULL};
static const char *const regions[] = {"all", NULL};
#define PARAM_STRUCT struct integral
static const struct param integral_param[] = {
    CHOICE("operation", operation, REQUIRED, operation_names, "over all cells"),
    ONLY("regionType", 0, regions, "the whole mesh"),
};

/* Have all cells the same volume? */
static bool are_alike(const struct grid *g) {
    return g->forest && g->forest->radial < 0;
}

/* Sums a component of a field over a block, cell by cell. Where the block is uniform (n = 1) and has the value of the
 * last such call, the sum is that of then. */
static double sum_block(const struct function *f, int field, int b, int component, int n, const double *v) {
    const struct integral *own = f->own;
    const struct grid_block *block = &f->setup->grid->block[b];
    const struct grid *grid = f->setup->grid;
    double *kept = own->kept + 2 * ((3L * field + component) * grid->nblocks + b), total = 0;
    if (n == 1 && !memcmp(kept, v, sizeof *v)) return kept[1];
    for (int i = 0; i < block->ncells && own->operation == SUM; i++) total += v[n > 1 ? i : 0];
    const bool alike = are_alike(grid);
    const double same = alike ? grid->forest->volume : 0;
    for (int i = 0; i < block->ncells && own->operation != SUM; i++)
        total += (alike ? same : grid_volume(grid, b, i)) * v[n > 1 ? i : 0];
    if (n > 1) return total;
    kept[0] = *v;
    return kept[1] = total;
}

/* Reduces one block: to the sums of a field's m components, or to extremes. */
static void reduce_block(const struct function *f, int field, int b, int m, double sum[3], double extreme[3]) {
    const int operation = ((const struct integral *)f->own)->operation;
    double *lines[3];
    const int n = function_values(f, b, f->field[field], lines);
    for (int c = 0; c < m; c++) {
        const double *v = lines[c];
        if (operation <= SUM) sum[c] = sum_block(f, field, b, c, n, v);
        for (int i = 0; i < n && operation > SUM; i++)
            extreme[c] = fmin(extreme[c], operation == MAXIMUM ? -v[i] : v[i]);
    }
}

/* Reduces a field. Sums run cell by cell within a block and block by block over all ranks, so that they have the same
 * bits on any number of ranks. */
static status reduce(const struct function *f, int field, double out[3]) {
    const struct grid *grid = f->setup->grid;
    const struct integral *own = f->own;
    const int operation = own->operation, m = setup_lines(f->setup, f->field[field]);
    bool vector = quantity_of(f, f->field[field])->components == 3;
    double *per_block, sum[3] = {0}, result[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    TRY(allocate(&per_block, m * (grid->nblocks + 1L), sizeof(double), "sums of blocks"));
    for (int b = 0; b < grid->nblocks; b++) {
        reduce_block(f, field, b, m, sum, result);
        for (int c = 0; c < m; c++) per_block[(long)c * grid->nblocks + b] = sum[c];
    }
    status s = OK;
    for (int c = 0; c < m && operation <= SUM && !s; c++)
        s = grid_sum(grid, per_block + (long)c * grid->nblocks, &sum[c]);
    free(per_block);
    if (operation > SUM) comm_min(f->setup->comm, result, m);
    for (int x = 0; x < 3; x++) out[x] = 0;
    for (int c = 0; c < m; c++)
        out[vector ? f->setup->axis[c] : 0] = operation == VOL_AVERAGE ? sum[c] / own->volume
                                              : operation <= SUM       ? sum[c]
                                              : operation == MAXIMUM   ? -result[c]
                                                                       : result[c];
    return s;
}

static status find_volumes(const struct function *f, struct integral *v) {
    const struct grid *grid = f->setup->grid;
    const long most = 6L * f->nfields * grid->nblocks;
    double *per_block;
    TRY(pool_take(f->pool, &v->kept, most + 1, sizeof *v->kept, "sums of blocks"));
    for (long i = 0; i < most; i++) v->kept[i] = NAN;
    TRY(allocate(&per_block, grid->nblocks + 1L, sizeof(double), "sums of blocks"));
    for (int b = 0; b < grid->nblocks; b++)
        for (int i = 0; i < grid->block[b].ncells; i++) per_block[b] += grid_volume(grid, b, i);
    status s = grid_sum(grid, per_block, &v->volume);
    free(per_block);
    return s;
}

static void integral_head(const struct function *f, int which, FILE *o) {
    const struct integral *v = f->own;
    const struct grid *grid = f->setup->grid;
    double volume = 0, part = 0;
    (void)which;
    if (!are_alike(grid)) volume = v->volume;
    for (int i = 0; are_alike(grid) && i < grid->ncells_all;
         i++) { /* in pieces, which keep the digits of equal volumes */
        part += grid->forest->volume;
        if (i % 1000 != 999) continue;
        volume += part;
        part = 0;
    }
    fprintf(o, "# Region type : all\n# Cells  : %d\n# Volume : %.12g\n# Time          ", grid->ncells_all,
            volume + part);
    for (int k = 0; k < f->nfields; k++)
        fprintf(o, "\t%s(%s)", operation_names[v->operation], quantity_of(f, f->field[k])->name);
    fprintf(o, "\n");
}

static status integral_execute(struct function *f, const struct moment *now, const char *time) {
    struct integral *own = f->own;
    FILE *o;
    (void)time;
    TRY(comm_agree(f->setup->comm, own->kept ? OK : find_volumes(f, own)));
    status s = function_row(f, 0, now->t, &o);
    for (int k = 0; k < f->nfields; k++) {
        double v[3];
        status reduced = reduce(f, k, v);
        if (!s) s = reduced;
        if (!o || s) continue;
        function_value(o, '\t', 15, quantity_of(f, f->field[k])->components, v);
        if (f->log)
            printf("    %s: %s(%s) = %.12g\n", f->name, operation_names[own->operation],
                   quantity_of(f, f->field[k])->name, v[0]);
    }
    return comm_agree(f->setup->comm, s ? s : function_end_row(f, o));
}

const struct function_type function_integral = {
    .name = "volFieldValue",
    .about = "volIntegrate, volAverage, sum, min or max over all cells",
    FUNCTION_PARAMS(integral_param),
    .size = sizeof(struct integral),
    .execute = integral_execute,
    .table = {"volFieldValue.dat"},
    .head = integral_head,
    .width = 16,
};
