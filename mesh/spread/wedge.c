/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flattens OpenFOAM's wedges, bodies of revolution (wedge.h; docs/physics.md 1.4). A point at the distance r from the
 * axis and at half the angle of the wedge keeps its place along the axis, gets r along the radius, and the side of its
 * plane across. */
#include "mesh/spread/wedge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FLAT = 1e-5; /* of a unit normal, or of the extent: points of blockMesh have six digits */
enum { FEW = 8 };                /* room for the corners that faces at the axis gain */

struct wedge {
    struct polymesh *m;
    const char *dir;
    int patch[2];              /* on the low side and on the high side of the middle plane */
    int axial, radial, across; /* axes (0 x, 1 y, 2 z) */
    double axis[2];            /* m: along `radial` and along `across` */
    double half, far;          /* half the angle; the greatest radius, m */
    int *twin;                 /* [npoints] of a point on the axis the number of its copy on the high side; else -1 */
    int twins;
};

bool wedge_has(const struct polymesh *m) {
    bool any = false;
    for (int p = 0; p < m->npatches; p++) any |= !strcmp(m->patch[p].type, "wedge");
    return any;
}

static status refuse(const struct wedge *w, const char *what) {
    return fail(
        ERR_INPUT,
        "%s/boundary: %s; a wedge is one layer of cells between two patches of type wedge, planes that lie "
        "equally far on both sides of a coordinate plane and meet in an axis along x, y or z: mesh it so, or mesh "
        "the plane of (axial, radial) cells and say  axis { direction (1 0 0); }  in system/meshDict",
        w->dir, what);
}

/* ---- the planes ---- */

/* Finds the unit normal of a patch, out of the mesh, and its middle; fails unless it is plane. */
static status find_plane(const struct wedge *w, int patch, double normal[3], double middle[3]) {
    const struct patch *p = &w->m->patch[patch];
    double total = 0;
    memset(normal, 0, 3 * sizeof *normal);
    memset(middle, 0, 3 * sizeof *middle);
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < p->nfaces; i++) {
            double x[3], a[3], cosine = 0;
            polymesh_patch_face(w->m, patch, i, x, a);
            const double size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
            for (int k = 0; k < 3; k++) {
                if (pass == 0) normal[k] += a[k];
                if (pass == 0) middle[k] += size * x[k];
                cosine += normal[k] * a[k] / size;
            }
            if (pass == 0) total += size;
            if (pass == 1 && !(cosine > 1 - FLAT)) return refuse(w, "a patch of type wedge is no plane");
        }
        const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int k = 0; k < 3 && pass == 0; k++) {
            normal[k] /= size;
            middle[k] /= total;
        }
    }
    return OK;
}

/* Finds the axes, the angle and the place of the axis. */
static status find_axes(struct wedge *w) {
    double n[2][3], x[2][3];
    for (int i = 0; i < 2; i++) TRY(find_plane(w, w->patch[i], n[i], x[i]));
    w->axial = w->radial = w->across = -1;
    for (int k = 0; k < 3; k++) {
        if (fabs(n[0][k]) < FLAT && fabs(n[1][k]) < FLAT)
            w->axial = k;
        else if (fabs(n[0][k] + n[1][k]) < FLAT)
            w->across = k;
        else if (fabs(n[0][k] - n[1][k]) < FLAT)
            w->radial = k;
    }
    if (w->axial < 0 || w->radial < 0 || w->across < 0) return refuse(w, "the patches of type wedge lie otherwise");
    if (n[0][w->across] > 0) {
        const int low = w->patch[1];
        w->patch[1] = w->patch[0];
        w->patch[0] = low;
    }
    if (n[0][w->radial] > 0) return refuse(w, "the cells lie on the side of the axis where the radius is negative");
    w->half = asin(-n[0][w->radial]);
    /* both planes: n_r (r - r0) +- n_t (t - t0) = 0 */
    const double r[2] = {x[0][w->radial], x[1][w->radial]}, t[2] = {x[0][w->across], x[1][w->across]};
    const int high = n[0][w->across] > 0 ? 0 : 1;
    const double slope = tan(w->half), rise = (t[high] - t[!high]) / 2;
    w->axis[1] = (t[0] + t[1] - slope * (r[high] - r[!high])) / 2;
    w->axis[0] = (r[0] + r[1]) / 2 - rise / slope;
    return OK;
}

static double radius_of(const struct wedge *w, const double *x) {
    return hypot(x[w->radial] - w->axis[0], x[w->across] - w->axis[1]);
}

/* Checks that all points lie on either plane, and finds the copies of those on the axis. */
static status look_at_points(struct wedge *w) {
    const struct polymesh *m = w->m;
    for (int i = 0; i < m->npoints; i++) w->far = fmax(w->far, radius_of(w, m->points + 3L * i));
    for (int i = 0; i < m->npoints; i++) {
        const double *x = m->points + 3L * i, r = radius_of(w, x);
        const double off = fabs(fabs(x[w->across] - w->axis[1]) - r * sin(w->half));
        if (off > FLAT * w->far || x[w->radial] - w->axis[0] < -FLAT * w->far)
            return refuse(w, "the mesh has points between the patches of type wedge, or beyond the axis");
        w->twin[i] = r < FLAT * w->far ? m->npoints + w->twins++ : -1;
    }
    return OK;
}

/* ---- the new faces ---- */

static bool on_high(const struct wedge *w, int point) {
    return w->m->points[3L * point + w->across] > w->axis[1];
}

/* Writes the corners of a face to `to`; returns their number. side: 0 and 1 of faces on the low and the high plane; of
 * others -1: where their corner on the axis joins both planes it becomes two. */
static int new_corners(const struct wedge *w, const int *of, int n, int side, int *to) {
    int count = 0;
    for (int i = 0; i < n; i++) {
        const int point = of[i], before = of[(i + n - 1) % n], behind = of[(i + 1) % n];
        if (w->twin[point] < 0 || side == 0) {
            to[count++] = point;
        } else if (side == 1) {
            to[count++] = w->twin[point];
        } else {
            to[count++] = on_high(w, before) ? w->twin[point] : point;
            if (on_high(w, before) != on_high(w, behind)) to[count++] = on_high(w, behind) ? w->twin[point] : point;
        }
    }
    return count;
}

static int side_of(const struct wedge *w, int face) {
    for (int i = 0; i < 2; i++) {
        const struct patch *p = &w->m->patch[w->patch[i]];
        if (face >= p->start && face < p->start + p->nfaces) return i;
    }
    return -1;
}

/* Adds the faces on the axis, one for each edge there of a face on the low plane; start and corner have room. */
static int add_axis(const struct wedge *w, int *start, int *corner, int *owner) {
    const struct polymesh *m = w->m;
    const struct patch *low = &m->patch[w->patch[0]];
    int n = m->nfaces;
    for (int f = low->start; f < low->start + low->nfaces; f++) {
        const int *of = m->face_points + m->face_start[f], corners = m->face_start[f + 1] - m->face_start[f];
        for (int i = 0; i < corners; i++) {
            const int a = of[i], b = of[(i + 1) % corners];
            if (w->twin[a] < 0 || w->twin[b] < 0) continue;
            const int face[4] = {b, a, w->twin[a], w->twin[b]};
            memcpy(corner + start[n], face, sizeof face);
            owner[n] = m->owner[f];
            start[n + 1] = start[n] + 4;
            n++;
        }
    }
    return n;
}

/* Replaces the faces. */
static status make_faces(struct wedge *w) {
    struct polymesh *m = w->m;
    const long faces = (long)m->nfaces + w->twins, corners = m->face_start[m->nfaces] + (long)FEW * (faces + 1);
    int *start = NULL, *corner = NULL, *owner = NULL;
    status e = allocate(&start, faces + 1, sizeof *start, "faces of a wedge");
    if (!e) e = allocate(&corner, corners, sizeof *corner, "faces of a wedge");
    if (!e) e = allocate(&owner, faces, sizeof *owner, "faces of a wedge");
    if (e) {
        free(start);
        free(corner);
        return e;
    }
    for (int f = 0; f < m->nfaces; f++) {
        const int n = m->face_start[f + 1] - m->face_start[f];
        start[f + 1] =
            start[f] + new_corners(w, m->face_points + m->face_start[f], n, side_of(w, f), corner + start[f]);
        owner[f] = m->owner[f];
    }
    m->nfaces = add_axis(w, start, corner, owner);
    free(m->face_start);
    free(m->face_points);
    free(m->owner);
    m->face_start = start;
    m->face_points = corner;
    m->owner = owner;
    return OK;
}

/* Moves the points into the plane. */
static status make_points(struct wedge *w) {
    struct polymesh *m = w->m;
    const double depth = w->far * sin(w->half);
    double *points;
    TRY(allocate(&points, 3L * (m->npoints + w->twins), sizeof *points, "points of a wedge"));
    for (int i = 0; i < m->npoints; i++) {
        double *x = points + 3L * i;
        memcpy(x, m->points + 3L * i, 3 * sizeof *x);
        const bool axis = w->twin[i] >= 0;
        x[w->radial] = w->axis[0] + (axis ? 0 : radius_of(w, m->points + 3L * i));
        x[w->across] = w->axis[1] + (!axis && on_high(w, i) ? depth : -depth);
        if (!axis) continue;
        double *twin = points + 3L * w->twin[i];
        memcpy(twin, x, 3 * sizeof *x);
        twin[w->across] = w->axis[1] + depth;
    }
    free(m->points);
    m->points = points;
    m->npoints += w->twins;
    m->round = (struct revolution){true, w->axial, w->radial, w->axis[0], 2 * depth};
    return OK;
}

/* ---- the patches ---- */

static void rename_type(struct patch *p, const char *type, const char *said) {
    p->said = said;
    strcpy(p->type, type); /* "empty" is no longer than "wedge" */
}

static void free_patch(struct patch *p) {
    free(p->name);
    free(p->type);
    free(p->neighbour);
    free(p->groups);
}

/* Adds the patch of the faces from `first` on. */
static status add_patch(struct polymesh *m, int first) {
    const int old = polymesh_find_patch(m, "axis");
    const bool idle = old >= 0 && m->patch[old].nfaces == 0;
    struct patch made = {.start = first, .nfaces = m->nfaces - first, .said = idle ? "empty" : "symmetryPlane"};
    TRY(allocate(&made.name, 16, 1, "a patch"));
    TRY(allocate(&made.type, 16, 1, "a patch"));
    strcpy(made.name, old >= 0 && !idle ? "axisOfWedge" : "axis");
    strcpy(made.type, "symmetryPlane");
    if (idle) {
        free_patch(&m->patch[old]);
        memmove(m->patch + old, m->patch + old + 1, (size_t)(--m->npatches - old) * sizeof *m->patch);
    } else {
        struct patch *all = realloc(m->patch, (size_t)(m->npatches + 1) * sizeof *all);
        if (!all) return fail(ERR_SYSTEM, "no memory for patches");
        m->patch = all;
    }
    m->patch[m->npatches++] = made;
    return OK;
}

static status find_patches(struct wedge *w) {
    int n = 0;
    for (int p = 0; p < w->m->npatches; p++) {
        const struct patch *patch = &w->m->patch[p];
        if (!strcmp(patch->type, "empty") && patch->nfaces > 0)
            return refuse(w, "there are patches of type empty beside those of type wedge");
        if (strcmp(patch->type, "wedge") != 0) continue;
        if (n < 2) w->patch[n] = p;
        n++;
    }
    if (n != 2) return refuse(w, "there are not two patches of type wedge");
    return w->m->patch[w->patch[0]].nfaces == w->m->patch[w->patch[1]].nfaces &&
                   w->m->patch[w->patch[0]].nfaces == w->m->ncells
               ? OK
               : refuse(w, "a patch of type wedge has not one face for each cell");
}

static status flatten(struct wedge *w) {
    const int first = w->m->nfaces;
    TRY(find_patches(w));
    TRY(find_axes(w));
    TRY(look_at_points(w));
    TRY(make_faces(w));
    TRY(make_points(w));
    for (int i = 0; i < 2; i++) rename_type(&w->m->patch[w->patch[i]], "empty", "wedge");
    return w->m->nfaces > first ? add_patch(w->m, first) : OK;
}

status wedge_flatten(struct polymesh *m, const char *dir) {
    struct wedge w = {.m = m, .dir = dir};
    if (!wedge_has(m)) return OK;
    TRY(allocate(&w.twin, m->npoints, sizeof *w.twin, "points of a wedge"));
    const status s = flatten(&w);
    free(w.twin);
    return s;
}
