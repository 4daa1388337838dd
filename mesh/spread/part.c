/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a part of a polyMesh (part.h) of faces that other ranks send. */
#include "mesh/spread/part.h"

#include "mesh/base/sorted.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct arrival { /* a face that has come */
    int face;
    long at; /* its place among the records */
};

static int by_face(const void *a, const void *b) {
    const struct arrival *p = a, *q = b;
    return (p->face > q->face) - (p->face < q->face);
}

/* Lists the faces in the order of their numbers, each once. */
static status list_faces(long ints, const int *records, struct arrival **out, long *n) {
    long count = 0;
    bool sorted = true;
    for (long at = 0; at < ints; at += RECORD + records[at + 3]) count++;
    TRY(allocate(out, count, sizeof **out, "the faces of a part"));
    count = 0;
    for (long at = 0; at < ints; at += RECORD + records[at + 3]) {
        (*out)[count] = (struct arrival){records[at], at};
        sorted = sorted && (count == 0 || (*out)[count - 1].face <= records[at]);
        count++;
    }
    if (!sorted) qsort(*out, (size_t)count, sizeof **out, by_face);
    *n = 0;
    for (long i = 0; i < count; i++)
        if (i == 0 || (*out)[i].face != (*out)[i - 1].face) (*out)[(*n)++] = (*out)[i];
    return OK;
}

/* Fills face_start, face_points, owner and neighbour by numbers in the whole mesh. */
static status take_faces(long n, const struct arrival *face, const int *records, struct mesh_part *p) {
    struct polymesh *m = &p->mesh;
    long corners = 0;
    for (long i = 0; i < n; i++) corners += records[face[i].at + 3];
    if (corners > INT_MAX)
        return fail(ERR_SYSTEM, "the faces of a rank have %ld corners; at most %d can be counted", corners, INT_MAX);
    m->nfaces = (int)n;
    TRY(allocate(&p->face, n, sizeof *p->face, "the faces of a part"));
    TRY(allocate(&m->face_start, n + 1, sizeof *m->face_start, "the faces of a part"));
    TRY(allocate(&m->face_points, corners, sizeof *m->face_points, "the faces of a part"));
    TRY(allocate(&m->owner, n, sizeof *m->owner, "the faces of a part"));
    TRY(allocate(&m->neighbour, n, sizeof *m->neighbour, "the faces of a part"));
    for (int i = 0; i < n; i++) {
        const int *r = records + face[i].at;
        p->face[i] = r[0];
        m->owner[i] = r[1];
        if (r[2] >= 0) m->neighbour[m->ninternal++] = r[2];
        memcpy(m->face_points + m->face_start[i], r + RECORD, (size_t)r[3] * sizeof *r);
        m->face_start[i + 1] = m->face_start[i] + r[3];
    }
    return OK;
}

/* Lists the names that stand in v[n] and w[m], each once, and replaces each by its place in the list. */
static status rename_all(int *v, long n, int *w, long m, int **list, long *count) {
    TRY(allocate(list, n + m, sizeof **list, "the names of a part"));
    memcpy(*list, v, (size_t)n * sizeof *v);
    if (m) memcpy(*list + n, w, (size_t)m * sizeof *w);
    *count = n + m;
    TRY(sorted_make(*list, count));
    int *less = realloc(*list, (size_t)(*count + 1) * sizeof *less);
    if (less) *list = less;
    TRY(sorted_places(*list, *count, v, n));
    return sorted_places(*list, *count, w, m);
}

/* Finds which faces of the part belong to each patch. */
static status take_patches(const struct polymesh *all, struct mesh_part *p) {
    struct polymesh *m = &p->mesh;
    m->npatches = all->npatches;
    TRY(allocate(&m->patch, all->npatches, sizeof *m->patch, "the patches of a part"));
    int f = m->ninternal;
    for (int i = 0; i < all->npatches; i++) {
        const int end = all->patch[i].start + all->patch[i].nfaces;
        m->patch[i] = all->patch[i];
        m->patch[i].start = f;
        while (f < m->nfaces && p->face[f] < end) f++;
        m->patch[i].nfaces = f - m->patch[i].start;
    }
    return OK;
}

status part_of_faces(const struct polymesh *all, long ints, const int *records, struct mesh_part *p) {
    struct arrival *face = NULL;
    struct polymesh *m = &p->mesh;
    long n = 0, cells = 0, points = 0;
    *p = (struct mesh_part){.mesh.nfaces = 0};
    status e = list_faces(ints, records, &face, &n);
    if (!e) e = take_faces(n, face, records, p);
    free(face);
    TRY(e);
    TRY(rename_all(m->owner, n, m->neighbour, m->ninternal, &p->cell, &cells));
    TRY(rename_all(m->face_points, m->face_start[n], NULL, 0, &p->point, &points));
    m->ncells = (int)cells;
    m->npoints = (int)points;
    TRY(allocate(&p->whole, cells, sizeof *p->whole, "the cells of a part"));
    TRY(allocate(&m->points, 3 * points, sizeof *m->points, "the points of a part"));
    return take_patches(all, p);
}

status part_places(struct mesh_part *p, const struct share *points, const double *slice) {
    return share_fetch(points, 3, slice, p->mesh.npoints, p->point, p->mesh.points);
}

long part_cell(const struct mesh_part *p, int cell) {
    return sorted_find(p->cell, p->mesh.ncells, cell);
}

void part_free(struct mesh_part *p) {
    struct polymesh *m = &p->mesh;
    void *const all[] = {p->cell,       p->face,        p->point, p->whole,     m->points,
                         m->face_start, m->face_points, m->owner, m->neighbour, m->patch};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *p = (struct mesh_part){.mesh.nfaces = 0};
}
