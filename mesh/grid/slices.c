/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts planes and level sets out of cells (slices.h). Level sets are those of the linear functions in the simplices of
 * vicinity_cut: marching tetrahedra. */
#include "mesh/grid/slices.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const double ON = 1e-10; /* points nearer to a plane than this part of the mesh's size lie on it */
enum { MOST_CORNERS = 100000000 };

struct slice_maker {
    const struct vicinity *v;
    struct slice *out;
    int copies; /* of each corner, at the ends of empty axes */
    double low[3], high[3];
    int *table; /* [table_size] corners by their nodes, -1: free; open addressing */
    long table_size;
    const struct vicinity_field *field; /* of a level set */
    double level;
    const double *distance; /* of a plane */
};

/* ---- the polygons ---- */

static status grow(void *list, int count, int *room, size_t size) {
    void **items = list;
    if (count < *room) return OK;
    if (count > MOST_CORNERS) return fail(ERR_SYSTEM, "a surface with more than %d corners", (int)MOST_CORNERS);
    const int more = *room ? 2 * *room : 256;
    void *wider = realloc(*items, (size_t)more * size);
    if (!wider) return fail(ERR_SYSTEM, "out of memory: a surface");
    *items = wider;
    *room = more;
    return OK;
}

void slice_free(struct slice *s) {
    free(s->corner);
    free(s->x);
    free(s->start);
    free(s->around);
    free(s->cell);
    *s = (struct slice){0};
}

static long hash(const struct slice_maker *m, const struct slice_corner *c) {
    uint64_t h = (uint64_t)c->a * 0x9E3779B97F4A7C15u ^ ((uint64_t)c->b + 0x7F4A7C15u) * 0xBF58476D1CE4E5B9u;
    return (long)((h ^ h >> 29) % (uint64_t)m->table_size);
}

static long find(const struct slice_maker *m, const struct slice_corner *c) {
    long at = hash(m, c);
    while (m->table[at] >= 0) {
        const struct slice_corner *d = &m->out->corner[m->table[at]];
        if (d->a == c->a && d->b == c->b) break;
        at = (at + 1) % m->table_size;
    }
    return at;
}

/* Keeps the table at most half full. */
static status widen(struct slice_maker *m) {
    if (2L * (m->out->ncorners / m->copies + 1) < m->table_size) return OK;
    free(m->table);
    m->table_size = 2 * m->table_size + 1021;
    TRY(allocate(&m->table, m->table_size, sizeof *m->table, "a surface"));
    for (long i = 0; i < m->table_size; i++) m->table[i] = -1;
    for (int i = 0; i < m->out->ncorners; i += m->copies) m->table[find(m, &m->out->corner[i])] = i;
    return OK;
}

static status add_place(struct slice_maker *m, int cell, const struct slice_corner *c) {
    const struct vicinity *v = m->v;
    struct slice *s = m->out;
    double a[3], b[3], x[3];
    if (m->distance) { /* planes cut the mesh as it is, along empty axes, too */
        memcpy(a, v->mesh->points + 3 * c->a, sizeof a);
        memcpy(b, v->mesh->points + 3 * c->b, sizeof b);
    } else {
        vicinity_place(v, cell, c->a, a);
        vicinity_place(v, cell, c->b, b);
    }
    for (int k = 0; k < 3; k++) x[k] = a[k] + c->share * (b[k] - a[k]);
    for (int i = 0; i < m->copies; i++) {
        TRY(grow(&s->corner, s->ncorners, &s->corner_room, sizeof *s->corner));
        TRY(grow(&s->x, s->ncorners, &s->x_room, sizeof *s->x));
        s->corner[s->ncorners] = *c;
        memcpy(s->x[s->ncorners], x, sizeof x);
        for (int k = 0, bit = 1; m->copies > 1 && k < 3; k++) {
            bool solved = false;
            for (int d = 0; d < v->dim; d++) solved |= v->axis[d] == k;
            if (solved) continue;
            s->x[s->ncorners][k] = i & bit ? m->high[k] : m->low[k];
            bit *= 2;
        }
        s->ncorners++;
    }
    return OK;
}

/* Finds the corner where a value, which is p at node a and q at b, is 0; one of them is below 0. A new corner is made
 * where there is none. */
static status corner_at(struct slice_maker *m, int cell, long a, double p, long b, double q, int *out) {
    struct slice_corner c = {a, b, p / (p - q)};
    if (a > b) c = (struct slice_corner){b, a, q / (q - p)};
    if (p == 0 || q == 0) c = (struct slice_corner){p == 0 ? a : b, p == 0 ? a : b, 0};
    TRY(widen(m));
    const long at = find(m, &c);
    if (m->table[at] < 0) {
        const int first = m->out->ncorners;
        TRY(add_place(m, cell, &c));
        m->table[at] = first;
    }
    *out = m->table[at];
    return OK;
}

static status add_polygon(struct slice_maker *m, int cell, int n, const int *corner) {
    struct slice *s = m->out;
    const int used = s->npolygons ? s->start[s->npolygons] : 0;
    for (int i = 0; i < n; i++) {
        TRY(grow(&s->around, used + i, &s->around_room, sizeof *s->around));
        s->around[used + i] = corner[i];
    }
    TRY(grow(&s->cell, s->npolygons, &s->cell_room, sizeof *s->cell));
    TRY(grow(&s->start, s->npolygons + 1, &s->start_room, sizeof *s->start));
    s->cell[s->npolygons++] = cell;
    s->start[0] = 0;
    s->start[s->npolygons] = used + n;
    return OK;
}

/* ---- planes ---- */

status slice_distances(const struct polymesh *m, const double point[3], const double normal[3], double **out) {
    double low[3], high[3], size = 0;
    polymesh_bounds(m, low, high);
    for (int k = 0; k < 3; k++) size = fmax(size, high[k] - low[k]);
    TRY(allocate(out, m->npoints, sizeof **out, "points"));
    for (long i = 0; i < m->npoints; i++) {
        double off = 0;
        for (int k = 0; k < 3; k++) off += (m->points[3 * i + k] - point[k]) * normal[k];
        (*out)[i] = fabs(off) < ON * size ? 0 : off;
    }
    return OK;
}

bool slice_face(const struct polymesh *m, const double *distance, int face, int *at, struct slice_segment *out) {
    const int *p = m->face_points + m->face_start[face], n = m->face_start[face + 1] - m->face_start[face];
    for (; *at < n; ++*at) {
        const int i = *at;
        if (!(distance[p[i]] >= 0 && distance[p[(i + 1) % n]] < 0)) continue;
        int j = (i + 1) % n;
        while (distance[p[(j + 1) % n]] < 0) j = (j + 1) % n;
        *out = (struct slice_segment){{p[i], p[(i + 1) % n]}, {p[j], p[(j + 1) % n]}};
        ++*at;
        return true;
    }
    return false;
}

struct segment { /* of the polygon that a plane cuts out of a cell */
    int from, to;
};

/* Lists the segments of a cell's outline, right-handed about the plane's normal: faces go around their normal. */
static status outline(struct slice_maker *m, int cell, int *n, int *room, struct segment **list) {
    const struct polymesh *mesh = m->v->mesh;
    const double *d = m->distance;
    struct slice_segment s;
    *n = 0;
    for (int i = m->v->cell_start[cell]; i < m->v->cell_start[cell + 1]; i++) {
        const int face = m->v->face[i];
        for (int at = 0; slice_face(mesh, d, face, &at, &s);) {
            int from, to;
            TRY(corner_at(m, cell, s.down[0], d[s.down[0]], s.down[1], d[s.down[1]], &from));
            TRY(corner_at(m, cell, s.up[0], d[s.up[0]], s.up[1], d[s.up[1]], &to));
            if (from == to) continue;
            TRY(grow(list, *n, room, sizeof **list));
            (*list)[(*n)++] = mesh->owner[face] == cell ? (struct segment){from, to} : (struct segment){to, from};
        }
    }
    return OK;
}

/* Joins segments to polygons, which it takes out of the list; `corner` has room for all. */
static status join(struct slice_maker *m, int cell, int n, struct segment *list, int *corner) {
    while (n > 0) {
        const int first = list[n - 1].from;
        int k = 0, end = list[n - 1].to;
        corner[k++] = first;
        n--;
        while (end != first) {
            int next = n - 1;
            while (next >= 0 && list[next].from != end) next--;
            if (next < 0) break; /* faces that do not close: the mesh would not have passed */
            corner[k++] = end;
            end = list[next].to;
            list[next] = list[--n];
        }
        if (k > 2) TRY(add_polygon(m, cell, k, corner));
    }
    return OK;
}

static status cut_cells(struct slice_maker *m) {
    struct segment *list = NULL;
    int *corner = NULL, room = 0, corner_room = 0;
    status e = OK;
    for (int cell = 0, n; !e && cell < m->v->mesh->ncells; cell++) {
        bool above = false, below = false;
        for (int i = m->v->own_start[cell]; i < m->v->own_start[cell + 1]; i++) {
            above |= m->distance[m->v->point[i]] >= 0;
            below |= m->distance[m->v->point[i]] < 0;
        }
        if (!above || !below) continue;
        e = outline(m, cell, &n, &room, &list);
        while (!e && corner_room < n) e = grow(&corner, corner_room, &corner_room, sizeof *corner);
        if (!e) e = join(m, cell, n, list, corner);
    }
    free(list);
    free(corner);
    return e;
}

status slice_plane(const struct vicinity *v, const double point[3], const double normal[3], struct slice *out) {
    struct slice_maker m = {.v = v, .out = out, .copies = 1};
    const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    const double unit[3] = {normal[0] / size, normal[1] / size, normal[2] / size};
    double *distance = NULL;
    status e = slice_distances(v->mesh, point, unit, &distance);
    m.distance = distance;
    if (!e) e = cut_cells(&m);
    free(distance);
    free(m.table);
    return e;
}

/* ---- level sets ---- */

/* Sets above[] to the values at the nodes of a simplex, less the level. Returns a bit for each node not below. */
static int heights(const struct slice_maker *m, int n, const long *node, double above[4]) {
    int bits = 0;
    for (int i = 0; i < n; i++) {
        above[i] = vicinity_at_node(m->field, node[i]) - m->level;
        bits |= (above[i] >= 0) << i;
    }
    return bits;
}

/* Are four nodes, three of them seen from the first, right-handed? */
static bool right_handed(const struct slice_maker *m, int cell, const long node[4]) {
    double x[4][3], volume = 0;
    for (int i = 0; i < 4; i++) vicinity_place(m->v, cell, node[i], x[i]);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, n = (k + 2) % 3;
        volume += (x[3][k] - x[0][k]) *
                  ((x[1][l] - x[0][l]) * (x[2][n] - x[0][n]) - (x[1][n] - x[0][n]) * (x[2][l] - x[0][l]));
    }
    return volume > 0;
}

static status add_triangle(struct slice_maker *m, int cell, int a, int b, int c) {
    const int corner[3] = {a, b, c};
    if (a == b || b == c || a == c) return OK; /* it has shrunk to a node or an edge: so have those beside it */
    return add_polygon(m, cell, 3, corner);
}

static status cut_tetrahedron(struct slice_maker *m, int cell, const long node[4]) {
    /* by the bits of the nodes above: even permutations that begin with the odd one out, or with those above */
    static const int order[16][4] = {{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 3, 1},
                                     {1, 2, 0, 3}, {3, 0, 2, 1}, {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 0, 1, 3},
                                     {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 1, 2, 3}};
    long n[4] = {node[0], node[1], node[2], node[3]};
    double above[4];
    int corner[4], bits = heights(m, 4, n, above), count = 0;
    if (bits == 0 || bits == 15) return OK;
    if (!right_handed(m, cell, n)) {
        n[2] = node[3];
        n[3] = node[2];
        bits = heights(m, 4, n, above);
    }
    for (int i = 0; i < 4; i++) count += bits >> i & 1;
    const int *o = order[bits];
    const int pair[4][2] = {
        {o[0], o[count == 2 ? 2 : 1]}, {o[0], o[count == 2 ? 3 : 2]}, {o[count == 2 ? 1 : 0], o[3]}, {o[1], o[2]}};
    for (int i = 0; i < (count == 2 ? 4 : 3); i++)
        TRY(corner_at(m, cell, n[pair[i][0]], above[pair[i][0]], n[pair[i][1]], above[pair[i][1]], &corner[i]));
    if (count == 3) return add_triangle(m, cell, corner[0], corner[2], corner[1]);
    TRY(add_triangle(m, cell, corner[0], corner[1], corner[2]));
    return count == 2 ? add_triangle(m, cell, corner[0], corner[2], corner[3]) : OK;
}

/* Adds a rectangle so that its normal points to lower values; `above` belongs to n nodes of its simplex. */
static status add_rectangle(struct slice_maker *m, int cell, const int around[4], int n, const long *node,
                            const double *above) {
    const double *a = m->out->x[around[0]], *b = m->out->x[around[1]], *c = m->out->x[around[2]];
    const int back[4] = {around[3], around[2], around[1], around[0]};
    double x[3], along = 0;
    int far = 0;
    for (int i = 1; i < n; i++)
        if (fabs(above[i]) > fabs(above[far])) far = i;
    vicinity_place(m->v, cell, node[far], x);
    for (int d = 0; d < m->v->dim; d++) {
        const int k = m->v->axis[d], l = (k + 1) % 3, o = (k + 2) % 3;
        along += (a[k] - x[k]) * ((b[l] - a[l]) * (c[o] - b[o]) - (b[o] - a[o]) * (c[l] - b[l]));
    }
    return add_polygon(m, cell, 4, (along > 0) == (above[far] > 0) ? around : back);
}

/* The level set of a triangle is a segment, and along the empty axis a rectangle. */
static status cut_triangle(struct slice_maker *m, int cell, const long node[3]) {
    double above[4];
    int corner[2], bits = heights(m, 3, node, above), found = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        if ((bits >> i & 1) == (bits >> j & 1)) continue;
        TRY(corner_at(m, cell, node[i], above[i], node[j], above[j], &corner[found]));
        found++;
    }
    if (found < 2 || corner[0] == corner[1]) return OK;
    const int around[4] = {corner[0], corner[1], corner[1] + 1, corner[0] + 1};
    return add_rectangle(m, cell, around, 3, node, above);
}

static status cut_simplex(void *context, int cell, const long node[4]) {
    struct slice_maker *m = context;
    double above[4];
    int corner;
    if (m->v->dim == 3) return cut_tetrahedron(m, cell, node);
    if (m->v->dim == 2) return cut_triangle(m, cell, node);
    const int bits = heights(m, 2, node, above);
    if (bits == 0 || bits == 3) return OK;
    TRY(corner_at(m, cell, node[0], above[0], node[1], above[1], &corner));
    const int around[4] = {corner, corner + 1, corner + 3, corner + 2};
    return add_rectangle(m, cell, around, 2, node, above);
}

/* Does the level lie between values at the cell's points and centre? Means of faces lie between those of points. */
static bool is_cut(const struct slice_maker *m, int cell) {
    double low = m->field->value[(long)m->field->stride * cell], high = low;
    for (int i = m->v->own_start[cell]; i < m->v->own_start[cell + 1]; i++) {
        const double there = vicinity_at_point(m->field, m->v->point[i]);
        low = fmin(low, there);
        high = fmax(high, there);
    }
    return low <= m->level && high >= m->level;
}

status slice_level(const struct vicinity_field *f, double level, struct slice *out) {
    const struct vicinity *v = f->v;
    struct slice_maker m = {.v = v, .out = out, .copies = 1 << (3 - v->dim), .field = f, .level = level};
    status e = OK;
    polymesh_bounds(v->mesh, m.low, m.high);
    for (int cell = 0; !e && cell < v->mesh->ncells; cell++)
        if (is_cut(&m, cell)) e = vicinity_cut(v, cell, cut_simplex, &m);
    free(m.table);
    return e;
}

double slice_value(const struct vicinity_field *f, const struct slice_corner *c) {
    const double a = vicinity_at_node(f, c->a);
    return c->a == c->b ? a : a + c->share * (vicinity_at_node(f, c->b) - a);
}
