/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes legacy VTK files as the VTK file formats document describes them: cells in VTK's order of points, big-endian
 * numbers, series (vtk.h). vtu.c writes XML files. */
#include "solvers/output/vtk_private.h"

#include "libcore/models/kernel.h"
#include "mesh/format/files.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH = 4096 };

static int face_size(const struct polymesh *m, int f) {
    return m->face_start[f + 1] - m->face_start[f];
}

/* Returns point i of face f, counted with the face's normal out of cell c. */
static int face_point(const struct polymesh *m, int f, int c, int i) {
    int n = face_size(m, f);
    i = (i + n) % n;
    return m->face_points[m->face_start[f] + (m->owner[f] == c ? i : n - 1 - i)];
}

static int kind_of(const struct vtk_grid *g, int c, int *base) {
    const struct polymesh *m = g->mesh;
    int n = g->cell_start[c + 1] - g->cell_start[c], triangles = 0, quads = 0;
    const int *faces = g->cell_faces + g->cell_start[c];
    *base = faces[0];
    for (int i = 0; i < n; i++) {
        int size = face_size(m, faces[i]);
        if (size == 3)
            triangles++;
        else if (size == 4)
            quads++;
        else
            return POLYHEDRON;
    }
    if (n == 4 && triangles == 4) return TETRAHEDRON;
    if (n == 6 && quads == 6) return HEXAHEDRON;
    int type = n == 5 && triangles == 4 && quads == 1   ? PYRAMID
               : n == 5 && triangles == 2 && quads == 3 ? WEDGE
                                                        : POLYHEDRON;
    for (int i = n; i--;)
        if (type != POLYHEDRON && face_size(m, faces[i]) == (type == PYRAMID ? 4 : 3)) *base = faces[i];
    return type;
}

/* Returns the point that an edge of cell c joins to point `from` of face `base`, off that face; -1: none. */
static int edge_away(const struct vtk_grid *g, int c, int base, int from) {
    const struct polymesh *m = g->mesh;
    for (int i = g->cell_start[c]; i < g->cell_start[c + 1]; i++) {
        int f = g->cell_faces[i], n = face_size(m, f);
        if (f == base) continue;
        for (int j = 0; j < n; j++) {
            if (face_point(m, f, c, j) != from) continue;
            for (int side = -1; side <= 1; side += 2) {
                int other = face_point(m, f, c, j + side);
                bool on_base = false;
                for (int k = 0; k < face_size(m, base); k++) on_base |= face_point(m, base, c, k) == other;
                if (!on_base) return other;
            }
        }
    }
    return -1;
}

/* Lists the points of a cell in VTK's order: the base's normal points into a hexahedron, pyramid and tetrahedron, out
 * of a wedge; then the points above the base. Returns their number, 0 if the cell has not the shape that the sizes of
 * its faces suggest. */
static int simple_cell(const struct vtk_grid *g, int c, int type, int base, int ids[8]) {
    const struct polymesh *m = g->mesh;
    int n = face_size(m, base), top = type == HEXAHEDRON || type == WEDGE ? n : 1;
    for (int i = 0; i < n; i++) ids[i] = face_point(m, base, c, type == WEDGE ? i : n - 1 - i);
    for (int i = 0; i < top; i++)
        if ((ids[n + i] = edge_away(g, c, base, ids[i])) < 0) return 0;
    for (int i = 0; i < top; i++)
        for (int j = 0; j < i; j++)
            if (ids[n + i] == ids[n + j]) return 0;
    return n + top;
}

static int polyhedron(const struct vtk_grid *g, int c, int *ids) {
    int n = 0, faces = g->cell_start[c + 1] - g->cell_start[c];
    ids[n++] = faces;
    for (int i = 0; i < faces; i++) {
        int f = g->cell_faces[g->cell_start[c] + i], size = face_size(g->mesh, f);
        ids[n++] = size;
        for (int j = 0; j < size; j++) ids[n++] = face_point(g->mesh, f, c, j);
    }
    return n;
}

static status build_cells(struct vtk_grid *g) {
    const struct polymesh *m = g->mesh;
    long most = 2L * m->ncells;
    for (int f = 0; f < m->nfaces; f++) most += (f < m->ninternal ? 2L : 1L) * (1 + face_size(m, f));
    TRY(allocate(&g->type, m->ncells, sizeof(int), "VTK cells"));
    TRY(allocate(&g->start, m->ncells + 1L, sizeof(int), "VTK cells"));
    TRY(allocate(&g->ids, most, sizeof(int), "VTK cells"));
    for (int c = 0; c < m->ncells; c++) {
        int base, *ids = g->ids + g->start[c] + 1, simple[8];
        int type = kind_of(g, c, &base), n = type == POLYHEDRON ? 0 : simple_cell(g, c, type, base, simple);
        g->type[c] = n ? type : POLYHEDRON;
        if (n)
            memcpy(ids, simple, (size_t)n * sizeof(int));
        else
            n = polyhedron(g, c, ids);
        ids[-1] = n;
        g->start[c + 1] = g->start[c] + 1 + n;
    }
    return OK;
}

status vtk_grid_make(const struct polymesh *m, struct vtk_grid **out) {
    struct vtk_grid *g = NULL;
    *out = NULL;
    TRY(allocate(&g, 1, sizeof *g, "VTK grid"));
    g->mesh = m;
    status s = polymesh_cell_faces(m, &g->cell_start, &g->cell_faces);
    if (!s) s = build_cells(g);
    if (s) {
        vtk_grid_free(g);
        return s;
    }
    *out = g;
    return OK;
}

void vtk_grid_free(struct vtk_grid *g) {
    if (!g) return;
    free(g->cell_start);
    free(g->cell_faces);
    free(g->type);
    free(g->start);
    free(g->ids);
    free(g);
}

enum { CHUNK = 1 << 17 }; /* bytes: more than a sink copies to its buffer */

struct out { /* numbers on their way to a file */
    struct sink *sink;
    bool ascii;
};

static status open_out(const char *path, bool ascii, struct out *o) {
    *o = (struct out){.ascii = ascii};
    TRY(sink_open(path, false, &o->sink));
    sink_unsummed(o->sink);
    return OK;
}

/* Turns the bytes of n numbers round. */
KERNEL static void turn_ints(long n, const int *restrict values, uint32_t *restrict swapped) {
    for (long i = 0; i < n; i++) swapped[i] = __builtin_bswap32((uint32_t)values[i]);
}

/* Writes n numbers, `per_line` (or all) on a line of a text. */
static void put_ints(struct out *o, long n, long per_line, const int *values) {
    uint32_t swapped[CHUNK / 4];
    for (long i = 0; o->ascii && i < n; i++)
        sink_printf(o->sink, "%d%c", values[i], i + 1 == n || (i + 1) % per_line == 0 ? '\n' : ' ');
    for (long at = 0, part; !o->ascii && at < n; at += part) {
        part = n - at < CHUNK / 4 ? n - at : CHUNK / 4;
        turn_ints(part, values + at, swapped);
        sink_write(o->sink, swapped, (size_t)part * 4);
    }
}

KERNEL static void turn_doubles(long n, const double *restrict values, uint64_t *restrict swapped) {
    for (long i = 0; i < n; i++) swapped[i] = __builtin_bswap64(bits_of(values[i]));
}

static void put_doubles(struct out *o, long n, int per_line, const double *values) {
    uint64_t swapped[CHUNK / 8];
    for (long i = 0; o->ascii && i < n; i++)
        sink_printf(o->sink, "%.17g%c", values[i], (i + 1) % per_line ? ' ' : '\n');
    for (long at = 0, part; !o->ascii && at < n; at += part) {
        part = n - at < CHUNK / 8 ? n - at : CHUNK / 8;
        turn_doubles(part, values + at, swapped);
        sink_write(o->sink, swapped, (size_t)part * 8);
    }
    sink_printf(o->sink, "\n");
}

static void write_grid(const struct vtk_grid *g, struct out *o) {
    const struct polymesh *m = g->mesh;
    sink_printf(o->sink, "POINTS %d double\n", m->npoints);
    put_doubles(o, 3L * m->npoints, 3, m->points);
    sink_printf(o->sink, "CELLS %d %d\n", m->ncells, g->start[m->ncells]);
    for (int c = 0; o->ascii && c < m->ncells; c++)
        put_ints(o, g->start[c + 1] - g->start[c], LONG_MAX, g->ids + g->start[c]);
    if (!o->ascii) put_ints(o, g->start[m->ncells], LONG_MAX, g->ids);
    sink_printf(o->sink, "\nCELL_TYPES %d\n", m->ncells);
    put_ints(o, m->ncells, 1, g->type);
    sink_printf(o->sink, "\n");
}

static const char title[] = VTK_TITLE;

static void write_start(struct out *o, const char *dataset, double t, long step) {
    sink_printf(o->sink, "# vtk DataFile Version 3.0\n%s%.17g\n%s\nDATASET %s\n", title, t,
                o->ascii ? "ASCII" : "BINARY", dataset);
    sink_printf(o->sink, "FIELD FieldData 2\nTimeValue 1 1 double\n");
    put_doubles(o, 1, 1, &t);
    sink_printf(o->sink, "Step 1 1 int\n");
    put_ints(o, 1, 1, &(int){(int)step});
    sink_printf(o->sink, "\n");
}

static void write_fields(struct out *o, long n, int nfields, const struct vtk_field *fields) {
    for (int i = 0; i < nfields; i++) {
        sink_printf(o->sink, "%s %d %ld double\n", fields[i].name, fields[i].components, n);
        put_doubles(o, n * fields[i].components, fields[i].components, fields[i].values);
    }
}

const char *vtk_ending(enum vtk_form form) {
    return form == VTK_XML ? ".vtu" : ".vtk";
}

status vtk_write(const struct vtk_grid *g, const char *path, enum vtk_form form, double t, long step, int nfields,
                 const struct vtk_field *fields) {
    struct out o;
    long n = g->mesh->ncells;
    if (form == VTK_XML) return vtu_write(g, path, t, step, nfields, fields);
    TRY(open_out(path, form == VTK_ASCII, &o));
    write_start(&o, "UNSTRUCTURED_GRID", t, step);
    write_grid(g, &o);
    sink_printf(o.sink, "CELL_DATA %ld\nFIELD attributes %d\n", n, nfields);
    write_fields(&o, n, nfields, fields);
    return sink_close(o.sink);
}

status vtk_write_points(const char *path, enum vtk_form form, double t, long step, int n, const double *x, int nfields,
                        const struct vtk_field *fields) {
    struct out o;
    if (form == VTK_XML) return vtu_write_points(path, t, step, n, x, nfields, fields);
    TRY(open_out(path, form == VTK_ASCII, &o));
    write_start(&o, "POLYDATA", t, step);
    sink_printf(o.sink, "POINTS %d double\n", n);
    put_doubles(&o, 3L * n, 3, x);
    sink_printf(o.sink, "VERTICES %d %ld\n", n, 2L * n);
    for (int i = 0; i < n; i++) put_ints(&o, 2, 2, (const int[]){1, i});
    sink_printf(o.sink, "\nPOINT_DATA %d\nFIELD attributes %d\n", n, nfields);
    write_fields(&o, n, nfields, fields);
    return sink_close(o.sink);
}

status vtk_write_polygons(const char *path, bool ascii, double t, long step, const struct vtk_polygons *p,
                          bool in_polygons, int nfields, const struct vtk_field *fields) {
    struct out o;
    const long corners = p->n ? p->start[p->n] : 0, n = in_polygons ? p->n : p->npoints;
    TRY(open_out(path, ascii, &o));
    write_start(&o, "POLYDATA", t, step);
    sink_printf(o.sink, "POINTS %d double\n", p->npoints);
    put_doubles(&o, 3L * p->npoints, 3, p->x);
    sink_printf(o.sink, "POLYGONS %d %ld\n", p->n, p->n + corners);
    for (int i = 0; i < p->n; i++) {
        const int around = p->start[i + 1] - p->start[i];
        if (ascii)
            sink_printf(o.sink, "%d ", around);
        else
            put_ints(&o, 1, 1, &around);
        put_ints(&o, around, LONG_MAX, p->around + p->start[i]);
    }
    sink_printf(o.sink, "\n%s %ld\nFIELD attributes %d\n", in_polygons ? "CELL_DATA" : "POINT_DATA", n, nfields);
    write_fields(&o, n, nfields, fields);
    return sink_close(o.sink);
}

struct series_entry {
    char name[256];
    double t;
};

static bool file_time(const char *folder, const char *name, double *t) {
    char path[PATH], line[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    int file;
    size_t bytes;
    status s = file_open_read(path, &file, &bytes);
    status_free(s);
    FILE *f = s ? NULL : fdopen(file, "rb");
    if (!f) return false;
    const char *found = fgets(line, sizeof line, f) && fgets(line, sizeof line, f) ? strstr(line, title) : NULL;
    const bool ok = found && (found == line || found == line + 5); /* behind <!-- in XML */
    if (ok) *t = strtod(found + sizeof title - 1, NULL);
    fclose(f);
    return ok;
}

static int by_time(const void *a, const void *b) {
    const struct series_entry *p = a, *q = b;
    return p->t < q->t ? -1 : p->t > q->t ? 1 : strcmp(p->name, q->name);
}

static status find_files(const char *folder, const char *name, const char *ending, double latest, int *n,
                         struct series_entry **list) {
    DIR *d = opendir(folder);
    if (!d) return fail(ERR_SYSTEM, "%s: %s", folder, strerror(errno));
    status s = OK;
    const size_t stem = strlen(name), tail = strlen(ending);
    int room = 0;
    for (struct dirent *e; !s && (e = readdir(d));) {
        size_t length = strlen(e->d_name);
        struct series_entry found;
        if (length < stem + 2 + tail || length >= sizeof found.name || strncmp(e->d_name, name, stem) ||
            e->d_name[stem] != '_' || strcmp(e->d_name + length - tail, ending) ||
            !file_time(folder, e->d_name, &found.t) || found.t > latest + 1e-12 * fabs(latest))
            continue;
        memcpy(found.name, e->d_name, length + 1);
        if (*n == room) {
            struct series_entry *more = realloc(*list, (size_t)(room = 2 * room + 16) * sizeof *more);
            if (more)
                *list = more;
            else
                s = fail(ERR_SYSTEM, "out of memory");
        }
        if (!s) (*list)[(*n)++] = found;
    }
    closedir(d);
    if (*n) qsort(*list, (size_t)*n, sizeof **list, by_time);
    return s;
}

status vtk_series_write(const char *folder, const char *name, const char *ending, double latest) {
    int n = 0;
    struct series_entry *list = NULL;
    char path[PATH];
    struct sink *o;
    status s = find_files(folder, name, ending, latest, &n, &list);
    snprintf(path, sizeof path, "%s/%s%s.series", folder, name, ending);
    if (!s) s = sink_open(path, false, &o);
    if (!s) {
        sink_printf(o, "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n");
        for (int i = 0; i < n; i++)
            sink_printf(o, "    { \"name\" : \"%s\", \"time\" : %.17g }%s\n", list[i].name, list[i].t,
                        i + 1 < n ? "," : "");
        sink_printf(o, "  ]\n}\n");
        s = sink_close(o);
    }
    free(list);
    return s;
}
