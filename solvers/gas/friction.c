/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of what friction keeps (quantities.h; docs/physics.md 9.3). A file goes from cells to slices and back, one
 * after the other, so that no rank holds a whole field. */
#include "solvers/gas/quantities.h"
#include "solvers/output/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITEM = 6 }; /* numbers of a symmetric tensor: xx xy xz yy yz zz */

static status name_files(struct friction_files *f, const struct setup *s, int sides) {
    const bool lattice = s->grid->forest != NULL;
    TRY(allocate(&f->name, sides + 1L, sizeof *f->name, "friction"));
    f->n = 1 + sides;
    snprintf(f->name[0], FRICTION_NAME, "uniform/frictionPressure");
    for (int i = 0; i < sides; i++)
        if (lattice)
            snprintf(f->name[1 + i], FRICTION_NAME, "uniform/frictionStress%c%s", "XYZ"[s->axis[i / 2]],
                     i % 2 ? "High" : "Low");
        else
            snprintf(f->name[1 + i], FRICTION_NAME, "uniform/frictionStress%d", i);
    return OK;
}

void friction_files_free(struct friction_files *f) {
    free(f->name);
    f->name = NULL;
}

/* The place in an item of the entry in row i and column j along the gas's axes. */
static int entry_of(const struct setup *s, int i, int j) {
    const int a = s->axis[i] < s->axis[j] ? s->axis[i] : s->axis[j], b = s->axis[i] + s->axis[j] - a;
    return 3 * a - a * (a + 1) / 2 + b;
}

static int tensors_of(const struct setup *s) {
    return s->components * (s->components + 1) / 2;
}

static int lines_of(const struct setup *s, int file) {
    return file ? tensors_of(s) : 1;
}

static int first_line(const struct setup *s, int file) {
    return file ? 1 + (file - 1) * tensors_of(s) : 0;
}

/* Copies n cells from items of a file to its lines, or back. */
static void turn(const struct setup *s, int file, long n, double *items, double *const *line, bool back) {
    if (!file) memcpy(back ? items : line[0], back ? line[0] : items, (size_t)n * sizeof *items);
    for (int i = 0, at = 0; i < s->components && file; i++)
        for (int j = i; j < s->components; j++, at++)
            for (long c = 0; c < n; c++) {
                double *item = items + ITEM * c + entry_of(s, i, j);
                *(back ? item : &line[at][c]) = *(back ? &line[at][c] : item);
            }
}

/* Allocates the lines and items of n cells; *line[0] has the memory. */
static status make_lines(const struct setup *s, int file, long n, double **line, double **items) {
    const int lines = lines_of(s, file);
    TRY(allocate(&line[0], n * (lines + (file ? ITEM : 1)), sizeof(double), "friction"));
    for (int i = 1; i < lines; i++) line[i] = line[0] + i * n;
    *items = line[0] + lines * n;
    return OK;
}

/* ---- reading ---- */

static void path_of(const struct friction_files *f, const struct setup *s, int file, char *path) {
    snprintf(path, 2 * TIME_PATH, "%s/%s/%s", s->dir, s->start.folder, f->name[file]);
}

/* Reads the values of a slice. */
static status read_slice(const char *path, const struct share *share, int components, double **slice) {
    struct dict *d;
    struct lexer l;
    struct token t = {.text = ""};
    char list[24];
    long n = 0;
    TRY(dict_read_shared(path, share, &d));
    snprintf(list, sizeof list, "List<%s>", field_item(components));
    status e = dict_raw(d, "internalField", &l);
    if (!e) e = lexer_next(&l, &t);
    if (!e && token_is(&t, "nonuniform")) e = lexer_next(&l, &t);
    if (!e && !token_is(&t, list)) e = lexer_fail(&l, &t, "a restart wants what a run wrote:  nonuniform %s", list);
    if (!e) e = foam_list_read_part(&l, dict_header(d), components, share->n, share->first, share->end, &n, slice);
    if (!e && n != share->n) e = dict_fail(d, "internalField", "it holds %ld values; the mesh wants %ld", n, share->n);
    dict_free(d);
    return e;
}

static status read_file(const struct friction_files *f, const struct setup *s, struct gas *g, int file) {
    const struct share share = share_make(s->comm, s->mesh->ncells);
    const int components = file ? ITEM : 1;
    char path[2 * TIME_PATH];
    double *slice = NULL, *line[ITEM] = {NULL}, *items = NULL;
    long n;
    const int *cell = grid_cells(s->grid, &n);
    path_of(f, s, file, path);
    status e = read_slice(path, &share, components, &slice);
    if (!e) e = make_lines(s, file, n, line, &items);
    e = comm_agree(s->comm, e);
    if (!e) e = share_fetch(&share, components, slice, n, cell, items);
    if (!e) {
        turn(s, file, n, items, line, false);
        gas_set_friction(g, first_line(s, file), lines_of(s, file), (const double *const *)line);
    }
    free(slice);
    free(line[0]);
    return e;
}

status friction_resume(struct friction_files *f, const struct setup *s, struct gas *g) {
    const int sides = gas_friction_sides(g);
    char path[2 * TIME_PATH];
    if (sides == 0) return OK;
    TRY(comm_agree(s->comm, name_files(f, s, sides)));
    bool all = true;
    for (int i = 0; i < f->n && all; i++) {
        path_of(f, s, i, path);
        all = field_exists(path);
    }
    f->lost = !all && s->start.step > 0;
    for (int i = 0; i < f->n && all; i++) TRY(read_file(f, s, g, i));
    return OK;
}

/* ---- writing ---- */

static void take_lines(const struct setup *s, const struct gas *g, int file, double *const *line) {
    double *at[ITEM];
    const int lines = lines_of(s, file);
    for (int i = 0; i < lines; i++) at[i] = line[i];
    for (int b = 0; b < s->grid->nblocks; b++) {
        gas_block_friction(g, b, first_line(s, file), lines, at);
        for (int i = 0; i < lines; i++) at[i] += s->grid->block[b].ncells;
    }
}

/* Computes the mean of the sides that carry stress. */
static status find_mean(const struct setup *s, const struct gas *g, long n, double *const *mean) {
    const int tensors = tensors_of(s), sides = gas_friction_sides(g);
    double *line[ITEM] = {NULL}, *count;
    TRY(allocate(&line[0], n * (tensors + 1), sizeof(double), "friction"));
    for (int i = 1; i < tensors; i++) line[i] = line[0] + i * n;
    count = line[0] + tensors * n;
    for (int i = 0; i < tensors; i++) memset(mean[i], 0, (size_t)n * sizeof(double));
    for (int side = 0; side < sides; side++) {
        take_lines(s, g, 1 + side, line);
        for (long c = 0; c < n; c++) {
            bool any = false;
            for (int i = 0; i < tensors; i++) {
                mean[i][c] += line[i][c];
                any |= line[i][c] != 0;
            }
            count[c] += any;
        }
    }
    for (int i = 0; i < tensors; i++)
        for (long c = 0; c < n; c++) mean[i][c] /= count[c] > 0 ? count[c] : 1;
    free(line[0]);
    return OK;
}

/* Returns |tau| of a tensor without trace, whose diagonal goes on beyond the gas's axes. */
static double size_of(const struct setup *s, bool disks, double *const *line, long c) {
    const int missing = (disks ? 2 : 3) - s->components;
    double sum = 0, trace = 0;
    for (int i = 0, at = 0; i < s->components; i++)
        for (int j = i; j < s->components; j++, at++) {
            sum += (i == j ? 0.5 : 1) * line[at][c] * line[at][c];
            trace += i == j ? line[at][c] : 0;
        }
    if (missing > 0) sum += 0.5 * trace * trace / missing;
    return sqrt(sum);
}

status friction_ratio(const struct setup *s, const struct gas *g, const struct gas_models *models, double *out) {
    const double least = models->friction_params.alpha_friction;
    double *line[ITEM] = {NULL}, *alpha = NULL;
    long n;
    (void)grid_cells(s->grid, &n);
    TRY(make_lines(s, 1, n, line, &alpha));
    status e = find_mean(s, g, n, line);
    take_lines(s, g, 0, &out);
    for (int b = 0, at = 0; b < s->grid->nblocks; at += s->grid->block[b++].ncells)
        gas_block_field(g, b, GAS_ALPHA, (double *[]){alpha + at, NULL, NULL});
    for (long c = 0; c < n && !e; c++)
        out[c] = out[c] > 0 && alpha[c] > least ? size_of(s, models->material.disks, line, c) / out[c] : 0;
    free(line[0]);
    return e;
}

/* Computes what a file holds in the cells of this rank's slice; that of the mean stands behind the others. */
static status make_slice(const struct setup *s, const struct gas *g, int file, const struct share *share,
                         double **slice) {
    const int components = file ? ITEM : 1;
    double *line[ITEM] = {NULL}, *items = NULL;
    long n;
    const int *cell = grid_cells(s->grid, &n);
    status e = make_lines(s, file, n, line, &items);
    if (!e && file > gas_friction_sides(g)) e = find_mean(s, g, n, line);
    if (!e) e = allocate(slice, (share->end - share->first) * components, sizeof(double), "friction");
    e = comm_agree(s->comm, e);
    if (!e) {
        if (file <= gas_friction_sides(g)) take_lines(s, g, file, line);
        turn(s, file, n, items, line, true);
        e = share_store(share, components, n, cell, items, *slice);
    }
    free(line[0]);
    return e;
}

static status write_file(const struct setup *s, const struct gas *g, const struct field_writer *w, int file,
                         const char *name, struct file_sum *sum) {
    const struct share share = share_make(s->comm, s->mesh->ncells);
    const struct quantity q = {.name = name, .components = file ? ITEM : 1, .dimensions = {1, -1, -2, 0, 0, 0, 0}};
    double *slice = NULL;
    status e = make_slice(s, g, file, &share, &slice);
    if (!e) e = output_slices(w, &q, &share, slice, sum);
    free(slice);
    return e;
}

status friction_save(const struct friction_files *f, const struct setup *s, const struct gas *g,
                     const struct field_writer *w, struct checksums *sums) {
    struct foam_format exact = *w->format;
    char folder[TIME_PATH + 16], location[TIME_NAME + 16];
    exact.precision = 17;
    snprintf(folder, sizeof folder, "%s/uniform", w->folder);
    snprintf(location, sizeof location, "%s/uniform", w->location);
    const struct field_writer there = {w->mesh, &exact, folder, location};
    for (int i = 0; i < f->n; i++) {
        struct file_sum sum;
        status e = write_file(s, g, &there, i, f->name[i] + strlen("uniform/"), &sum);
        if (!e && comm_root(s->comm)) e = checksums_add(sums, f->name[i], sum);
        TRY(comm_agree(s->comm, e));
    }
    struct file_sum sum;
    if (!f->n) return OK;
    TRY(write_file(s, g, w, f->n, "frictionStress", &sum));
    return comm_agree(s->comm, comm_root(s->comm) ? checksums_add(sums, "frictionStress", sum) : OK);
}
