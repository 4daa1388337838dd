/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the blocks of each rank as hexahedra, in the XML files of VTK with appended binary data (vtk_pieces.h). */
#include "solvers/output/vtk_pieces.h"

#include "solvers/output/output.h"
#include "solvers/output/vtk_private.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { CORNERS = 8 };

/* Returns the number of corners of a block; of its cells, where a cell has no corner more than itself. */
static long count(const struct forest_block *b, int more) {
    return (long)(b->n[0] + more) * (b->n[1] + more) * (b->n[2] + more);
}

static long count_all(const struct setup *s, int more) {
    long n = 0;
    for (int b = 0; b < s->grid->nblocks; b++) n += count(&s->grid->forest->block[b], more);
    return n;
}

/* Begins the appended data of an array: its length. */
static void begin(struct sink *o, long bytes) {
    const uint64_t length = (uint64_t)bytes;
    sink_write(o, &length, sizeof length);
}

static void write_points(const struct setup *s, struct sink *o) {
    const struct lattice *l = s->lattice;
    begin(o, count_all(s, 1) * 3 * (long)sizeof(double));
    for (int b = 0; b < s->grid->nblocks; b++) {
        const struct forest_block *f = &s->grid->forest->block[b];
        for (int i[3] = {0, 0, 0}; i[2] <= f->n[2]; i[2]++)
            for (i[1] = 0; i[1] <= f->n[1]; i[1]++)
                for (i[0] = 0; i[0] <= f->n[0]; i[0]++) {
                    double x[3];
                    for (int k = 0; k < 3; k++) x[l->axis[k]] = l->origin[k] + l->width[k] * (f->low[k] + i[k]);
                    sink_write(o, x, sizeof x);
                }
    }
}

/* Writes the corners of the cells. Where the axes of the lattice are an odd permutation of x, y, z, floor and lid of a
 * hexahedron change places. */
static void write_corners(const struct setup *s, struct sink *o) {
    const int *axis = s->lattice->axis;
    const bool odd = (axis[1] - axis[0] + 3) % 3 != 1;
    int64_t first = 0;
    begin(o, count_all(s, 0) * CORNERS * (long)sizeof(int64_t));
    for (int b = 0; b < s->grid->nblocks; b++) {
        const struct forest_block *f = &s->grid->forest->block[b];
        const int64_t row = f->n[0] + 1, plane = row * (f->n[1] + 1);
        for (int k = 0; k < f->n[2]; k++)
            for (int j = 0; j < f->n[1]; j++)
                for (int i = 0; i < f->n[0]; i++) {
                    const int64_t at = first + i + row * j + plane * k, floor = at + (odd ? plane : 0),
                                  lid = at + (odd ? 0 : plane);
                    const int64_t corner[CORNERS] = {floor, floor + 1, floor + row + 1, floor + row,
                                                     lid,   lid + 1,   lid + row + 1,   lid + row};
                    sink_write(o, corner, sizeof corner);
                }
        first += count(f, 1);
    }
}

static void write_cells(const struct setup *s, struct sink *o) {
    const long n = count_all(s, 0);
    const unsigned char type = HEXAHEDRON;
    write_corners(s, o);
    begin(o, n * (long)sizeof(int64_t));
    for (int64_t i = 1; i <= n; i++) sink_write(o, &(int64_t){CORNERS * i}, sizeof i);
    begin(o, n);
    for (long i = 0; i < n; i++) sink_write(o, &type, 1);
}

/* Prints the entry of an array; in a piece with its place in the appended data, which moves on by the number of bytes.
 */
static void print_array(struct sink *o, const char *type, const char *name, int components, long *at, long bytes) {
    sink_printf(o, "<%sDataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\"", at ? "" : "P", type, name,
                components);
    if (at) sink_printf(o, " format=\"appended\" offset=\"%ld\"", *at);
    sink_printf(o, "/>\n");
    if (at) *at += bytes + (long)sizeof(uint64_t);
}

/* Prints the entries of a piece of n cells and its points or, if `at` is NULL, of the index. */
static void print_arrays(const struct setup *s, struct sink *o, const int *quantity, long *at, long n, long points) {
    const char *p = at ? "" : "P";
    sink_printf(o, "<%sPoints>\n", p);
    print_array(o, "Float64", "Points", 3, at, points * 24);
    sink_printf(o, "</%sPoints>\n", p);
    if (at) {
        sink_printf(o, "<Cells>\n");
        print_array(o, "Int64", "connectivity", 1, at, n * CORNERS * 8);
        print_array(o, "Int64", "offsets", 1, at, n * 8);
        print_array(o, "UInt8", "types", 1, at, n);
        sink_printf(o, "</Cells>\n");
    }
    sink_printf(o, "<%sCellData>\n", p);
    for (const int *q = quantity; *q >= 0; q++) {
        const struct quantity *f = &s->medium->fields.quantity[*q];
        print_array(o, "Float64", f->name, f->components, at, n * f->components * 8);
    }
    sink_printf(o, "</%sCellData>\n", p);
}

/* Writes the index, which names the pieces of the ranks that have cells. */
static status write_index(const struct setup *s, const char *path, const char *name, double t, long step,
                          const int *quantity, const int *cells) {
    struct sink *o;
    TRY(sink_open(path, false, &o));
    vtu_head(o, "PUnstructuredGrid", false, t, step);
    sink_printf(o, "<PUnstructuredGrid GhostLevel=\"0\">\n");
    print_arrays(s, o, quantity, NULL, 0, 0);
    for (int r = 0; r < comm_size(s->comm); r++)
        if (cells[r]) sink_printf(o, "<Piece Source=\"%s/%d.vtu\"/>\n", name, r);
    sink_printf(o, "</PUnstructuredGrid>\n</VTKFile>\n");
    return sink_close(o);
}

/* Opens the file of this rank and writes all but the fields. */
static status open_piece(const struct setup *s, const char *path, double t, long step, const int *quantity,
                         struct sink **out) {
    const long n = count_all(s, 0), points = count_all(s, 1);
    long at = 0;
    struct sink *o;
    TRY(sink_open(path, false, &o));
    sink_unsummed(o);
    vtu_head(o, "UnstructuredGrid", false, t, step);
    sink_printf(o, "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%ld\" NumberOfCells=\"%ld\">\n", points, n);
    print_arrays(s, o, quantity, &at, n, points);
    sink_printf(o, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    write_points(s, o);
    write_cells(s, o);
    *out = o;
    return OK;
}

/* Writes the fields and closes the file; o: NULL on a rank without cells. */
static status write_piece(const struct setup *s, struct sink *o, const int *quantity) {
    const long n = count_all(s, 0);
    status e = OK;
    for (const int *q = quantity; *q >= 0 && !e; q++) {
        double *values;
        const long bytes = n * s->medium->fields.quantity[*q].components * (long)sizeof *values;
        e = output_own(s, *q, &values);
        if (!e && o) begin(o, bytes);
        if (!e && o) sink_write(o, values, (size_t)bytes);
        if (!e) free(values);
    }
    if (o) sink_printf(o, "\n</AppendedData>\n</VTKFile>\n");
    const status closed = o ? sink_close(o) : OK;
    if (e && closed) status_free(closed);
    return e ? e : closed;
}

status vtk_pieces_write(const struct setup *s, const char *folder, const char *name, double t, long step,
                        const int *quantity) {
    char path[2 * TIME_PATH];
    struct sink *o = NULL;
    const int cells = (int)count_all(s, 0);
    int *all = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    TRY(comm_agree(s->comm, comm_root(s->comm) ? case_make_folders(s, path) : OK));
    snprintf(path, sizeof path, "%s/%s/%d.vtu", folder, name, comm_rank(s->comm));
    status e = comm_agree(s->comm, cells ? open_piece(s, path, t, step, quantity, &o) : OK);
    if (e && o) status_free(sink_close(o));
    TRY(e);
    TRY(comm_agree(s->comm, write_piece(s, o, quantity)));
    TRY(comm_gather_int(s->comm, &cells, 1, &all, NULL));
    snprintf(path, sizeof path, "%s/%s.pvtu", folder, name);
    e = comm_root(s->comm) ? write_index(s, path, name, t, step, quantity, all) : OK;
    free(all);
    return comm_agree(s->comm, e);
}
