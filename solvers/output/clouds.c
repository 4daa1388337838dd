/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads grains as an OpenFOAM cloud, and writes them as VTK points (clouds.h). */
#include "solvers/output/clouds.h"

#include "solvers/case/fields.h"
#include "solvers/case/times.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POSITIONS, VELOCITY, ID, DIAMETER, SPIN, SPECIES, FILES };
static const char *const files[FILES] = {"lagrangian/grains/positions", "lagrangian/grains/U",
                                         "lagrangian/grains/id",        "lagrangian/grains/d",
                                         "lagrangian/grains/omega",     "lagrangian/grains/species"};
static const char *const classes[FILES] = {
    "Cloud<passiveParticle>", "vectorField", "labelField", "scalarField", "vectorField", "labelField"};

status cloud_make(int n, struct cloud *c) {
    *c = (struct cloud){.n = n};
    TRY(allocate(&c->x, n, sizeof *c->x, "places of grains"));
    TRY(allocate(&c->u, n, sizeof *c->u, "velocities of grains"));
    return allocate(&c->cell, n, sizeof *c->cell, "cells of grains");
}

void cloud_free(struct cloud *c) {
    free(c->x);
    free(c->u);
    free(c->cell);
    free(c->id);
    free(c->spin);
    free(c->size);
    free(c->species);
    *c = (struct cloud){.n = 0};
}

static void print_positions(struct sink *s, const struct cloud *c) {
    sink_printf(s, "\n%d\n(\n", c->n);
    for (int i = 0; i < c->n; i++)
        sink_printf(s, "(%.17g %.17g %.17g) %d\n", c->x[i][0], c->x[i][1], c->x[i][2], c->cell[i]);
    sink_printf(s, ")\n");
}

static status print_list(struct sink *s, const struct cloud *c, int file, const struct foam_format *f) {
    if (file == VELOCITY || file == SPIN) {
        foam_list_write_doubles(s, f, 3, c->n, file == SPIN ? c->spin[0] : c->u[0]);
        return OK;
    }
    if (file == SPECIES) {
        foam_list_write_labels(s, f, c->n, c->species);
        return OK;
    }
    void *list = NULL;
    TRY(allocate(&list, c->n, file == ID ? sizeof(int) : sizeof(double), "a field of grains"));
    int *label = list;
    double *number = list;
    for (int i = 0; i < c->n; i++)
        if (file == ID)
            label[i] = c->id ? c->id[i] : i;
        else
            number[i] = c->size ? c->diameter * c->size[i] : c->diameter;
    if (file == ID)
        foam_list_write_labels(s, f, c->n, label);
    else
        foam_list_write_doubles(s, f, 1, c->n, number);
    free(list);
    return OK;
}

status cloud_write(const struct cloud *c, const char *folder, const char *location, const struct foam_format *format,
                   struct checksums *sums) {
    char path[2 * TIME_PATH], where[TIME_NAME + 32];
    if (!c->n) return OK;
    snprintf(path, sizeof path, "%s/lagrangian/grains", folder);
    snprintf(where, sizeof where, "%s/lagrangian/grains", location);
    TRY(make_folders(path));
    for (int k = 0; k < FILES; k++) {
        struct foam_format f = *format;
        struct sink *s;
        struct file_sum sum;
        if ((k == SPIN && !c->spin) || (k == SPECIES && !c->species)) continue;
        f.precision = 17; /* all digits, because a start may be made from the file */
        if (k == POSITIONS) f.binary = false;
        snprintf(path, sizeof path, "%s/%s", folder, files[k]);
        TRY(sink_open(path, f.compress, &s));
        foam_header_write(s, &f, classes[k], where, strrchr(files[k], '/') + 1, NULL);
        if (k == POSITIONS) print_positions(s, c);
        status e = k == POSITIONS ? OK : print_list(s, c, k, &f);
        foam_end_write(s);
        status closed = sink_close_sum(s, &sum);
        if (e) {
            status_free(closed);
            return e;
        }
        TRY(closed);
        TRY(checksums_add(sums, files[k], sum));
    }
    return OK;
}

static void path_of(const char *folder, int file, char path[2 * TIME_PATH]) {
    snprintf(path, 2 * TIME_PATH, "%s/%s", folder, files[file]);
}

bool cloud_exists(const char *folder) {
    char path[2 * TIME_PATH];
    path_of(folder, POSITIONS, path);
    return field_exists(path);
}

static status read_number(struct lexer *l, double *out) {
    struct token t;
    TRY(lexer_next(l, &t));
    if (t.kind != TOKEN_NUMBER) return lexer_fail(l, &t, "a number is expected; a grain is  (x y z) cell");
    *out = t.number;
    return OK;
}

static status read_position(struct lexer *l, int ncells, double x[3], int *cell) {
    struct token t;
    TRY(lexer_expect(l, '('));
    for (int k = 0; k < 3; k++) TRY(read_number(l, &x[k]));
    TRY(lexer_expect(l, ')'));
    TRY(lexer_next(l, &t));
    *cell = t.kind == TOKEN_NUMBER && t.number >= 0 && t.number < ncells ? (int)t.number : -1;
    if (*cell >= 0 && t.number == *cell) return OK;
    return lexer_fail(l, &t, "the cell of a grain is a whole number from 0 to %d; a grain is  (x y z) cell",
                      ncells - 1);
}

static status read_positions(struct lexer *l, int ncells, struct cloud *c) {
    double count = 0;
    struct token t;
    TRY(lexer_peek(l, &t));
    if (t.kind != TOKEN_NUMBER) return lexer_fail(l, &t, "the number of grains is expected:  N ( (x y z) cell ... )");
    TRY(read_number(l, &count));
    const double most = (double)(l->source->size - l->position) / 9; /* the shortest grain takes 9 bytes */
    if (!(count >= 1 && count <= fmin(most, INT_MAX)) || count != floor(count))
        return lexer_fail(l, &t, "the number of grains that follow is expected, 1 or more");
    TRY(cloud_make((int)count, c));
    TRY(lexer_expect(l, '('));
    for (int i = 0; i < c->n; i++) TRY(read_position(l, ncells, c->x[i], &c->cell[i]));
    return lexer_expect(l, ')');
}

static status open_file(const char *folder, int file, struct source **source, struct lexer *l, struct foam_header *h) {
    char path[2 * TIME_PATH];
    path_of(folder, file, path);
    TRY(source_open(path, source));
    *l = lexer_start(*source);
    TRY(foam_header_read(l, h));
    if (h->present && strcmp(h->class_name, classes[file]))
        return fail(ERR_INPUT, "%s: class '%s'; this file has class %s", path, h->class_name, classes[file]);
    if (file == POSITIONS && h->binary) return fail(ERR_INPUT, "%s: it is binary; write it in ascii", path);
    return OK;
}

static status take_diameters(const double *values, struct cloud *c) {
    bool alike = true;
    c->diameter = values[0];
    for (int i = 0; i < c->n; i++) alike = alike && values[i] == values[0];
    if (alike) return OK;
    c->diameter = 1;
    TRY(allocate(&c->size, c->n, sizeof *c->size, "diameters of grains"));
    memcpy(c->size, values, (size_t)c->n * sizeof *values);
    return OK;
}

/* Reads a field beside the positions if its file is there. */
static status read_beside(const char *folder, int file, struct cloud *c) {
    char path[2 * TIME_PATH];
    struct source *source = NULL;
    struct lexer l;
    struct foam_header h;
    double *values = NULL;
    long n = 0;
    path_of(folder, file, path);
    if (!field_exists(path)) {
        if (file != VELOCITY) return OK;
        free(c->u);
        c->u = NULL;
        return OK;
    }
    status e = open_file(folder, file, &source, &l, &h);
    int **labels = file == ID ? &c->id : file == SPECIES ? &c->species : NULL;
    if (!e && labels) e = foam_list_read_labels(&l, &h, c->n, &n, labels);
    if (!e && !labels) e = foam_list_read_doubles(&l, &h, file == DIAMETER ? 1 : 3, c->n, &n, &values);
    if (!e && n != c->n) e = fail(ERR_INPUT, "%s: it holds %ld values; there are %d grains", path, n, c->n);
    if (!e && file == VELOCITY) memcpy(c->u, values, (size_t)n * sizeof *c->u);
    if (!e && file == SPIN) e = allocate(&c->spin, n, sizeof *c->spin, "spins of grains");
    if (!e && file == SPIN) memcpy(c->spin, values, (size_t)n * sizeof *c->spin);
    if (!e && file == DIAMETER) e = take_diameters(values, c);
    free(values);
    source_free(source);
    return e;
}

status cloud_read(const char *folder, int ncells, struct cloud *out) {
    struct source *source = NULL;
    struct lexer l;
    struct foam_header h;
    *out = (struct cloud){.n = 0};
    status e = open_file(folder, POSITIONS, &source, &l, &h);
    if (!e) e = read_positions(&l, ncells, out);
    source_free(source);
    for (int k = VELOCITY; !e && k < FILES; k++) e = read_beside(folder, k, out);
    if (e) cloud_free(out);
    return e;
}

status cloud_write_vtk(const struct cloud *c, const char *folder, const char *name, const char *time,
                       enum vtk_form form, double t, long step) {
    char path[2 * TIME_PATH];
    double *number = NULL;
    if (!c->n) return OK;
    snprintf(path, sizeof path, "%s/%s-grains_%s%s", folder, name, time, vtk_ending(form));
    TRY(allocate(&number, 3L * c->n, sizeof(double), "VTK fields"));
    for (int i = 0; i < c->n; i++) {
        number[i] = c->id ? c->id[i] : i;
        number[c->n + i] = c->size ? c->diameter * c->size[i] : c->diameter;
        number[2L * c->n + i] = c->species ? c->species[i] : 0;
    }
    struct vtk_field fields[5] = {{"id", 1, number}, {"d", 1, number + c->n}};
    int n = 2;
    if (c->u) fields[n++] = (struct vtk_field){"U", 3, c->u[0]};
    if (c->spin) fields[n++] = (struct vtk_field){"omega", 3, c->spin[0]};
    if (c->species) fields[n++] = (struct vtk_field){"species", 1, number + 2L * c->n};
    const status e = vtk_write_points(path, form, t, step, c->n, c->x[0], n, fields);
    free(number);
    return e;
}
