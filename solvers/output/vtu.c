/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes XML files of VTK (.vtu), as the VTK file formats document describes them: little-endian arrays behind the XML,
 * each in blocks that zlib's format compresses (vtk_private.h). */
#include "solvers/output/vtk_private.h"

#include <libdeflate.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* BLOCK: bytes that are compressed together. LEVEL of 1 .. 12: at 2 caseToVTK -vtu of riemann2D takes 0.7 of the time,
 * and its files are 8 % larger. GRID_ARRAYS: points, connectivity, offsets, types, faces, faceoffsets. */
enum { BLOCK = 1 << 18, LEVEL = 6, GRID_ARRAYS = 6, FIELDS = 64 };

struct packed { /* an array, compressed */
    const char *type, *name;
    int components;
    unsigned char *data; /* numbers of blocks and bytes, then the blocks */
    size_t bytes;
};

struct vtu {                 /* a file */
    const char *path, *data; /* data: CellData or PointData */
    double t;
    long step, npoints, ncells;
    struct libdeflate_compressor *compressor;
    int n, grid; /* arrays; those of the grid, which come first */
    struct packed array[GRID_ARRAYS + FIELDS];
};

void vtu_head(struct sink *o, const char *kind, bool compressed, double t, long step) {
    sink_printf(o, "<?xml version=\"1.0\"?>\n<!-- " VTK_TITLE "%.17g, step %ld -->\n", t, step);
    sink_printf(o, "<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"%s>\n", kind,
                compressed ? " compressor=\"vtkZLibDataCompressor\"" : "");
}

/* Adds an array of this number of bytes. */
static status pack(struct vtu *u, const char *type, const char *name, int components, const void *data, size_t bytes) {
    const size_t blocks = (bytes + BLOCK - 1) / BLOCK, head = (3 + blocks) * sizeof(uint64_t);
    const size_t most = libdeflate_zlib_compress_bound(u->compressor, BLOCK);
    struct packed *a = &u->array[u->n];
    *a = (struct packed){.type = type, .name = name, .components = components, .bytes = head};
    TRY(allocate(&a->data, (long)(head + blocks * most), 1, "a compressed array"));
    u->n++;
    uint64_t *size = (uint64_t *)(void *)a->data;
    size[0] = blocks;
    size[1] = BLOCK;
    size[2] = bytes % BLOCK;
    for (size_t b = 0; b < blocks; b++) {
        const size_t part = b + 1 < blocks || !size[2] ? BLOCK : size[2];
        size[3 + b] =
            libdeflate_zlib_compress(u->compressor, (const char *)data + b * BLOCK, part, a->data + a->bytes, most);
        a->bytes += size[3 + b];
    }
    void *less = realloc(a->data, a->bytes);
    if (less) a->data = less;
    return OK;
}

static status pack_ints(struct vtu *u, const char *name, long n, const int *values) {
    return pack(u, "Int32", name, 1, values, (size_t)n * sizeof *values);
}

struct vtu_cells {         /* of a grid, as XML files have them */
    int *points, *end;     /* points of each cell; where those of the next cell begin */
    int *faces, *face_end; /* streams of faces of polyhedra; where a stream ends, -1 of other cells */
    long npoints, nfaces;
    unsigned char *type;
};

/* Adds a point to those of a polyhedron, from place `first` on, unless it is there. */
static void add_point(struct vtu_cells *c, long first, int point) {
    for (long i = first; i < c->npoints; i++)
        if (c->points[i] == point) return;
    c->points[c->npoints++] = point;
}

static void add_polyhedron(struct vtu_cells *c, const int *stream, int length) {
    const long first = c->npoints;
    memcpy(c->faces + c->nfaces, stream, (size_t)length * sizeof *stream);
    c->nfaces += length;
    for (int at = 1, face = 0; face < stream[0]; face++, at += 1 + stream[at])
        for (int i = 1; i <= stream[at]; i++) add_point(c, first, stream[at + i]);
}

static status list_cells(const struct vtk_grid *g, struct vtu_cells *c) {
    const int n = g->mesh->ncells;
    TRY(allocate(&c->points, g->start[n], sizeof(int), "VTK cells"));
    TRY(allocate(&c->end, n, sizeof(int), "VTK cells"));
    TRY(allocate(&c->faces, g->start[n], sizeof(int), "VTK cells"));
    TRY(allocate(&c->face_end, n, sizeof(int), "VTK cells"));
    TRY(allocate(&c->type, n, 1, "VTK cells"));
    for (int i = 0; i < n; i++) {
        const int *ids = g->ids + g->start[i], length = ids[0];
        c->type[i] = (unsigned char)g->type[i];
        if (g->type[i] == POLYHEDRON) {
            add_polyhedron(c, ids + 1, length);
        } else {
            memcpy(c->points + c->npoints, ids + 1, (size_t)length * sizeof *ids);
            c->npoints += length;
        }
        c->end[i] = (int)c->npoints;
        c->face_end[i] = g->type[i] == POLYHEDRON ? (int)c->nfaces : -1;
    }
    return OK;
}

static status pack_cells(struct vtu *u, const struct vtu_cells *c, long n) {
    TRY(pack_ints(u, "connectivity", c->npoints, c->points));
    TRY(pack_ints(u, "offsets", n, c->end));
    TRY(pack(u, "UInt8", "types", 1, c->type, (size_t)n));
    if (!c->nfaces) return OK;
    TRY(pack_ints(u, "faces", c->nfaces, c->faces));
    return pack_ints(u, "faceoffsets", n, c->face_end);
}

static void free_cells(struct vtu_cells *c) {
    free(c->points);
    free(c->end);
    free(c->faces);
    free(c->face_end);
    free(c->type);
}

/* Prints the entries of arrays `from` .. `to` - 1, the first of which is `at` bytes into the data, and moves `at` on.
 */
static void print_arrays(struct sink *o, const struct vtu *u, int from, int to, size_t *at) {
    for (int i = from; i < to; i++) {
        const struct packed *a = &u->array[i];
        sink_printf(
            o, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%zu\"/>\n",
            a->type, a->name, a->components, *at);
        *at += a->bytes;
    }
}

static void print_all(struct sink *o, const struct vtu *u) {
    size_t at = 0;
    vtu_head(o, "UnstructuredGrid", true, u->t, u->step);
    sink_printf(
        o,
        "<UnstructuredGrid>\n<FieldData>\n"
        "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">%.17g</DataArray>\n"
        "<DataArray type=\"Int32\" Name=\"Step\" NumberOfTuples=\"1\" format=\"ascii\">%ld</DataArray>\n"
        "</FieldData>\n<Piece NumberOfPoints=\"%ld\" NumberOfCells=\"%ld\">\n<Points>\n",
        u->t, u->step, u->npoints, u->ncells);
    print_arrays(o, u, 0, 1, &at);
    sink_printf(o, "</Points>\n<Cells>\n");
    print_arrays(o, u, 1, u->grid, &at);
    sink_printf(o, "</Cells>\n<%s>\n", u->data);
    print_arrays(o, u, u->grid, u->n, &at);
    sink_printf(o, "</%s>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_", u->data);
    for (int i = 0; i < u->n; i++) sink_write(o, u->array[i].data, u->array[i].bytes);
    sink_printf(o, "\n</AppendedData>\n</VTKFile>\n");
}

static status pack_all(struct vtu *u, const double *x, const struct vtu_cells *c, int nfields,
                       const struct vtk_field *f) {
    TRY(pack(u, "Float64", "Points", 3, x, (size_t)u->npoints * 3 * sizeof *x));
    TRY(pack_cells(u, c, u->ncells));
    u->grid = u->n;
    for (int i = 0; i < nfields; i++)
        TRY(pack(u, "Float64", f[i].name, f[i].components, f[i].values,
                 (size_t)(u->ncells * f[i].components) * sizeof(double)));
    return OK;
}

static status write_all(struct vtu *u, const double *x, const struct vtu_cells *c, int nfields,
                        const struct vtk_field *f) {
    struct sink *o;
    if (nfields > FIELDS) return fail(ERR_INPUT, "%s: more than %d fields", u->path, FIELDS);
    if (!(u->compressor = libdeflate_alloc_compressor(LEVEL))) return fail(ERR_SYSTEM, "out of memory");
    status s = pack_all(u, x, c, nfields, f);
    libdeflate_free_compressor(u->compressor);
    if (!s) s = sink_open(u->path, false, &o);
    if (!s) {
        sink_unsummed(o);
        print_all(o, u);
        s = sink_close(o);
    }
    for (int i = 0; i < u->n; i++) free(u->array[i].data);
    return s;
}

status vtu_write(const struct vtk_grid *g, const char *path, double t, long step, int nfields,
                 const struct vtk_field *fields) {
    struct vtu u = {.path = path, .data = "CellData", .t = t, .step = step};
    struct vtu_cells c = {.npoints = 0};
    u.npoints = g->mesh->npoints;
    u.ncells = g->mesh->ncells;
    status s = list_cells(g, &c);
    if (!s) s = write_all(&u, g->mesh->points, &c, nfields, fields);
    free_cells(&c);
    return s;
}

status vtu_write_points(const char *path, double t, long step, int n, const double *x, int nfields,
                        const struct vtk_field *fields) {
    struct vtu u = {.path = path, .data = "PointData", .t = t, .step = step, .npoints = n, .ncells = n};
    struct vtu_cells c = {.npoints = n};
    status s = allocate(&c.points, n, sizeof(int), "VTK cells");
    if (!s) s = allocate(&c.end, n, sizeof(int), "VTK cells");
    if (!s) s = allocate(&c.type, n, 1, "VTK cells");
    for (int i = 0; !s && i < n; i++) {
        c.points[i] = i;
        c.end[i] = i + 1;
        c.type[i] = VERTEX;
    }
    if (!s) s = write_all(&u, x, &c, nfields, fields);
    free_cells(&c);
    return s;
}
