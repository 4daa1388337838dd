/* Function objects over all cells: fieldMinMax, volFieldValue, vtk. */
#include "solvers/functions/functions_private.h"

#include "libcore/models/kernel.h"
#include "solvers/output/clouds.h"
#include "solvers/output/output.h"
#include "solvers/output/vtk.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static status finish_row(const struct function *f, FILE *file) {
    if (fprintf(file, "\n") < 0 || fflush(file) || ferror(file))
        return fail(ERR_SYSTEM, "postProcessing/%s: cannot be written (disk full?)", f->name);
    return OK;
}

status extremes_make(struct function *f, struct dict *d) {
    static const char *const modes[] = {"magnitude"};
    int index;
    (void)f;
    (void)dict_has(d, "location");
    if (dict_has(d, "mode")) TRY(dict_choice(d, "mode", modes, 1, &index));
    return OK;
}

/* A vector's magnitudes, in place of its first component. */
static void magnitudes(int dim, int n, double *const lines[3]) {
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = 0; k < dim; k++) square += lines[k][i] * lines[k][i];
        lines[0][i] = sqrt(square);
    }
}

/* The least and the largest of n values, eight lanes at a time: they do not depend on the order. */
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

/* The index of the lowest cell below a bound that has the value; -1: none. */
static int lowest_cell(int n, const double *v, double value, const int *cell, double below) {
    int lowest = below < INT_MAX ? (int)below : INT_MAX, found = -1;
    for (int i = 0; i < n; i++)
        if (cell[i] < lowest && v[i] == value) {
            lowest = cell[i];
            found = i;
        }
    return found;
}

/* A field's extremes (of a vector: of its magnitude) and the lowest polyMesh cell that reaches each. */
static void find_extremes(const struct function *f, int field, double value[2], int cell[2]) {
    const struct grid *grid = f->setup->grid;
    const bool vector = quantity_of(f, field)->components == 3;
    double best[2] = {HUGE_VAL, HUGE_VAL}, where[2] = {HUGE_VAL, HUGE_VAL}, mine[2], range[2], *lines[3];
    for (int b = 0; b < grid->nblocks; b++) {
        const struct grid_block *block = &grid->block[b];
        function_block(f, b, field, lines);
        if (vector) magnitudes(grid->dim, block->ncells, lines);
        range_of(block->ncells, lines[0], range);
        for (int end = 0; end < 2; end++) {
            const double w = end ? -range[1] : range[0];
            if (w > best[end]) continue;
            const int i =
                lowest_cell(block->ncells, lines[0], range[end], block->cell, w < best[end] ? HUGE_VAL : where[end]);
            if (i < 0) continue;
            best[end] = end ? -lines[0][i] : lines[0][i]; /* a zero with the sign it has there */
            where[end] = block->cell[i];
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

status extremes_execute(struct function *f, const struct moment *now, const char *time) {
    (void)time;
    bool root = comm_root(f->setup->comm);
    status s = OK;
    if (root && !f->file[0]) {
        s = function_open(f, f->setup->start.name, "fieldMinMax.dat", &f->file[0]);
        if (!s)
            fprintf(f->file[0],
                    "# Field minima and maxima\n# Time          \tfield\tmin\tlocation(min)\tmax\tlocation(max)\n");
    }
    for (int k = 0; k < f->nfields; k++) {
        double v[2];
        int cell[2];
        find_extremes(f, f->field[k], v, cell);
        if (!root || s) continue;
        const double *a = f->setup->centre + 3L * cell[0], *b = f->setup->centre + 3L * cell[1];
        fprintf(f->file[0], "%-16.12g\t%s\t%.12g\t(%.12g %.12g %.12g)\t%.12g\t(%.12g %.12g %.12g)", now->t,
                quantity_of(f, f->field[k])->name, v[0], a[0], a[1], a[2], v[1], b[0], b[1], b[2]);
        s = finish_row(f, f->file[0]);
        if (f->log)
            printf("    %s: min(%s) = %g, max(%s) = %g\n", f->name, quantity_of(f, f->field[k])->name, v[0],
                   quantity_of(f, f->field[k])->name, v[1]);
    }
    return comm_agree(f->setup->comm, s);
}

enum { VOL_INTEGRATE, VOL_AVERAGE, SUM, MINIMUM, MAXIMUM, OPERATIONS };
static const char *const operation_names[OPERATIONS] = {"volIntegrate", "volAverage", "sum", "min", "max"};

status integral_make(struct function *f, struct dict *d) {
    static const char *const regions[] = {"all"};
    int index;
    if (dict_has(d, "regionType")) TRY(dict_choice(d, "regionType", regions, 1, &index));
    return dict_choice(d, "operation", operation_names, OPERATIONS, &f->operation);
}

/* One block: the sums of a field's m components and, for an average, of the weights last; or the extremes. */
static void reduce_block(const struct function *f, int field, int b, int m, double sum[4], double extreme[3]) {
    const struct grid_block *block = &f->setup->grid->block[b];
    const double *volume = f->setup->grid->volume;
    double *lines[3];
    function_block(f, b, field, lines);
    sum[m] = 0;
    for (int i = 0; i < block->ncells && f->operation == VOL_AVERAGE; i++) sum[m] += volume[block->cell[i]];
    for (int c = 0; c < m; c++) {
        const double *v = lines[c];
        double total = 0;
        if (f->operation > SUM)
            for (int i = 0; i < block->ncells; i++)
                extreme[c] = fmin(extreme[c], f->operation == MAXIMUM ? -v[i] : v[i]);
        else if (f->operation == SUM)
            for (int i = 0; i < block->ncells; i++) total += v[i];
        else
            for (int i = 0; i < block->ncells; i++) total += volume[block->cell[i]] * v[i];
        sum[c] = total;
    }
}

/* Sums run cell by cell within a block and block by block over all ranks: the same bits on any number of them. */
static status reduce(const struct function *f, int field, double out[3]) {
    const struct grid *grid = f->setup->grid;
    bool vector = quantity_of(f, field)->components == 3;
    int m = vector ? grid->dim : 1;
    double *per_block, sum[4] = {0}, result[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    TRY(allocate(&per_block, (m + 1L) * (grid->nblocks + 1), sizeof(double), "sums of blocks"));
    for (int b = 0; b < grid->nblocks; b++) {
        reduce_block(f, field, b, m, sum, result);
        for (int c = 0; c <= m; c++) per_block[(long)c * grid->nblocks + b] = sum[c];
    }
    status s = OK;
    for (int c = 0; c <= m && f->operation <= SUM && !s; c++)
        s = grid_sum(grid, per_block + (long)c * grid->nblocks, &sum[c]);
    free(per_block);
    if (f->operation > SUM) comm_min(f->setup->comm, result, m);
    for (int x = 0; x < 3; x++) out[x] = 0;
    for (int c = 0; c < m; c++)
        out[vector ? grid->axis[c] : 0] = f->operation == VOL_AVERAGE ? sum[c] / sum[m]
                                          : f->operation <= SUM       ? sum[c]
                                          : f->operation == MAXIMUM   ? -result[c]
                                                                      : result[c];
    return s;
}

static status integral_open(struct function *f) {
    const struct grid *grid = f->setup->grid;
    double volume = 0, part = 0;
    TRY(function_open(f, f->setup->start.name, "volFieldValue.dat", &f->file[0]));
    for (int i = 0; i < grid->ncells_all; i++) { /* in pieces, which keeps the digits of many equal cells */
        part += grid->volume[i];
        if (i % 1000 != 999) continue;
        volume += part;
        part = 0;
    }
    fprintf(f->file[0], "# Region type : all\n# Cells  : %d\n# Volume : %.12g\n# Time          ", grid->ncells_all,
            volume + part);
    for (int k = 0; k < f->nfields; k++)
        fprintf(f->file[0], "\t%s(%s)", operation_names[f->operation], quantity_of(f, f->field[k])->name);
    fprintf(f->file[0], "\n");
    return OK;
}

status integral_execute(struct function *f, const struct moment *now, const char *time) {
    (void)time;
    bool root = comm_root(f->setup->comm);
    status s = root && !f->file[0] ? integral_open(f) : OK;
    if (root && !s) fprintf(f->file[0], "%-16.12g", now->t);
    for (int k = 0; k < f->nfields; k++) {
        double v[3];
        status reduced = reduce(f, f->field[k], v);
        if (!s) s = reduced;
        if (!root || s) continue;
        if (quantity_of(f, f->field[k])->components == 3)
            fprintf(f->file[0], "\t(%.15g %.15g %.15g)", v[0], v[1], v[2]);
        else
            fprintf(f->file[0], "\t%.15g", v[0]);
        if (f->log)
            printf("    %s: %s(%s) = %.12g\n", f->name, operation_names[f->operation],
                   quantity_of(f, f->field[k])->name, v[0]);
    }
    if (root && !s) s = finish_row(f, f->file[0]);
    return comm_agree(f->setup->comm, s);
}

status vtk_make(struct function *f, struct dict *d) {
    static const char *const formats[] = {"binary", "ascii"};
    int index = 0;
    if (dict_has(d, "writeFormat")) TRY(dict_choice(d, "writeFormat", formats, 2, &index));
    f->ascii = index == 1;
    return OK;
}

static status write_cloud(const struct function *f, const struct moment *now, const char *folder, const char *time) {
    const struct setup *s = f->setup;
    struct cloud cloud;
    char name[sizeof s->name + 16];
    if (!s->medium->type->cloud) return OK;
    status e = s->medium->type->cloud(s->medium, &cloud);
    const bool any = !e && cloud.n > 0;
    if (any) e = cloud_write_vtk(&cloud, folder, s->name, time, f->ascii, now->t, now->step);
    cloud_free(&cloud);
    TRY(e);
    snprintf(name, sizeof name, "%s-grains", s->name);
    return any ? vtk_series_write(folder, name, now->t) : OK;
}

static status write_file(const struct function *f, const struct moment *now, const char *time,
                         const struct vtk_field *fields) {
    char folder[TIME_PATH + 8], path[2 * TIME_PATH];
    snprintf(folder, sizeof folder, "%s/VTK", f->setup->dir);
    TRY(make_folders(folder));
    snprintf(path, sizeof path, "%s/%s_%s.vtk", folder, f->setup->name, time);
    TRY(vtk_write(f->grid, path, f->ascii, now->t, now->step, f->nfields, fields));
    TRY(write_cloud(f, now, folder, time));
    return vtk_series_write(folder, f->setup->name, now->t);
}

status vtk_execute(struct function *f, const struct moment *now, const char *time) {
    struct vtk_field fields[MAX_QUANTITIES];
    const struct setup *s = f->setup;
    long n = s->mesh->ncells;
    bool root = comm_root(s->comm);
    status e = OK;
    if (root && !f->grid) e = vtk_grid_make(s->mesh, &f->grid);
    if (root && !e && !f->all_values) e = allocate(&f->all_values, 3 * n * f->nfields, sizeof(double), "VTK fields");
    TRY(comm_agree(s->comm, e));
    for (int k = 0; k < f->nfields; k++) {
        double *values = root ? f->all_values + 3 * n * k : NULL;
        TRY(output_gather(s, f->field[k], values));
        fields[k] =
            (struct vtk_field){quantity_of(f, f->field[k])->name, quantity_of(f, f->field[k])->components, values};
    }
    return comm_agree(s->comm, root ? write_file(f, now, time, fields) : OK);
}
