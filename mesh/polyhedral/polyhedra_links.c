/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polyMesh, or a part of it, as cells and links, for polyhedral meshes: which axes are solved, how cyclic halves
 * join, which images a periodic domain has. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_private.h"

static const double FLAT = 1e-3;     /* distance of points from the two planes of an empty axis, times the thickness */
static const double SAME = 1e-4;     /* relative difference of two translations that count as one */
static const double NO_SHIFT = 1e-6; /* shift of cyclic halves that lie on each other, times the extent of the mesh */

static bool has_type(const struct patch *p, const char *type) {
    return strcmp(p->type, type) == 0;
}

int links_cell_name(const struct links *l, int cell) {
    return l->part ? l->part->cell[cell] : cell;
}

int links_face_name(const struct links *l, int face) {
    return l->part ? l->part->face[face] : face;
}

/* ---- axes -------------------------------------------------------------------------------------------------------- */

static void find_axes(struct links *l) {
    const struct polymesh *m = l->mesh;
    for (int k = 0; k < 3 && l->all->outline; k++) l->gone[k] = l->all->outline->closed[k];
    for (int i = 0; i < m->npatches && !l->all->outline; i++)
        for (long f = m->patch[i].start; f < m->patch[i].start + m->patch[i].nfaces; f++) {
            if (!has_type(&m->patch[i], "empty")) break;
            const double *a = l->face_area + 3 * f;
            int axis = fabs(a[1]) > fabs(a[0]) ? 1 : 0;
            l->gone[fabs(a[2]) > fabs(a[axis]) ? 2 : axis] = true;
        }
    for (int k = 0; k < 3; k++)
        if (!l->gone[k]) l->axis[l->dim++] = k;
    for (int k = 0, next = l->dim; k < 3; k++)
        if (l->gone[k]) l->axis[next++] = k;
}

static status measure_thickness(struct links *l) {
    const struct polymesh *m = l->mesh;
    double lows[3], highs[3];
    polymesh_bounds(l->all, lows, highs);
    l->thickness = 1;
    for (int k = 0; k < 3; k++) {
        const double low = lows[k], high = highs[k];
        l->middle[k] = 0.5 * (low + high);
        l->extent = fmax(l->extent, high - low);
        if (!l->gone[k]) continue;
        l->thickness *= high - low;
        for (long p = 0; p < m->npoints; p++) {
            const double *x = m->points + 3 * p;
            if (fmin(x[k] - low, high - x[k]) > FLAT * (high - low))
                return fail(ERR_INPUT,
                            "constant/polyMesh: point %ld at (%g, %g, %g) lies between the two planes %c = %g and %g; "
                            "a mesh with empty patches is one cell thick, of the same thickness everywhere",
                            l->part ? l->part->point[p] : p, x[0], x[1], x[2], "xyz"[k], low, high);
        }
    }
    return OK;
}

bool links_edge(const struct links *l, int face, int *p, int *q) {
    const struct polymesh *m = l->mesh;
    const int *point = m->face_points + m->face_start[face], k = l->axis[2];
    int n = m->face_start[face + 1] - m->face_start[face], starts = 0, ends = 0;
    for (int i = 0; i < n; i++) {
        int next = point[(i + 1) % n];
        bool low = m->points[3L * point[i] + k] < l->middle[k], next_low = m->points[3L * next + k] < l->middle[k];
        if (!low && next_low) *p = next, starts++;
        if (low && !next_low) *q = point[i], ends++;
    }
    if (starts != 1 || ends != 1 || *p == *q) return false;
    const double *a = m->points + 3L * *p, *b = m->points + 3L * *q, *area = l->face_area + 3L * face;
    int x = l->axis[0], y = l->axis[1];
    if ((b[y] - a[y]) * area[x] + (a[x] - b[x]) * area[y] < 0) {
        int swap = *p;
        *p = *q;
        *q = swap;
    }
    return true;
}

/* ---- links ------------------------------------------------------------------------------------------------------- */

/* Fills twin[f - ninternal]: the pair's higher face where f is the lower one, -1 where f is the higher one, -2 where f
 * is not cyclic. */
static status pair_faces(const struct polymesh *m, int *twin) {
    for (int f = 0; f < m->nfaces - m->ninternal; f++) twin[f] = -2;
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        if (!has_type(p, "cyclic")) continue;
        int j = p->neighbour ? polymesh_find_patch(m, p->neighbour) : -1;
        if (j < 0 || j == i || m->patch[j].nfaces != p->nfaces)
            return fail(ERR_INPUT, "constant/polyMesh/boundary: the cyclic patch '%s' has no other half of %d faces",
                        p->name, p->nfaces);
        for (int k = 0; k < p->nfaces; k++) {
            int a = p->start + k, b = m->patch[j].start + k;
            twin[a - m->ninternal] = a < b ? b : -1;
        }
    }
    return OK;
}

static void add_link(struct links *l, int face, int twin, int right, int patch) {
    l->face[l->n] = face;
    l->twin[l->n] = twin;
    l->left[l->n] = l->mesh->owner[face];
    l->right[l->n] = right;
    l->patch[l->n] = patch;
    l->step[l->n++] = -1;
}

static void list_links(struct links *l, const int *twin) {
    const struct polymesh *m = l->mesh;
    for (int f = 0; f < m->ninternal; f++) add_link(l, f, -1, m->neighbour[f], -1);
    for (int i = 0; i < m->npatches; i++)
        for (int f = m->patch[i].start; f < m->patch[i].start + m->patch[i].nfaces; f++) {
            int other = twin[f - m->ninternal];
            if (other == -1 || has_type(&m->patch[i], "empty")) continue;
            if (other >= 0)
                add_link(l, f, other, m->owner[other], -1);
            else
                add_link(l, f, -1, -1, i);
        }
}

static status list_cells(struct links *l) {
    const int ncells = l->mesh->ncells;
    TRY(pool_take(l->pool, &l->cell_start, ncells + 2L, sizeof *l->cell_start, "the links of the cells"));
    int *start = l->cell_start + 1; /* start[c]: place of the next link of cell c while cell_link fills */
    for (int i = 0; i < l->n; i++) {
        start[l->left[i] + 1]++;
        if (l->right[i] >= 0) start[l->right[i] + 1]++;
    }
    for (int c = 0; c < ncells; c++) start[c + 1] += start[c];
    TRY(pool_take(l->pool, &l->cell_link, start[ncells], sizeof *l->cell_link, "the links of the cells"));
    for (int i = 0; i < l->n; i++) {
        l->cell_link[start[l->left[i]]++] = i;
        if (l->right[i] >= 0) l->cell_link[start[l->right[i]]++] = ~i;
    }
    return OK;
}

static status check_links(const struct links *l) {
    for (int i = 0; i < l->n; i++) {
        const double *a = l->face_area + 3L * l->face[i], *c = l->face_centre + 3L * l->face[i];
        int p, q;
        if (!(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] > 0))
            return fail(ERR_INPUT, "constant/polyMesh: face %d at (%g, %g, %g) has no area",
                        links_face_name(l, l->face[i]), c[0], c[1], c[2]);
        if (l->dim == 2 && !links_edge(l, l->face[i], &p, &q))
            return fail(ERR_INPUT,
                        "constant/polyMesh: face %d at (%g, %g, %g) does not stand between the two planes of the empty "
                        "patches; a mesh that is solved in 2D is extruded by one cell (gmsh: Layers{1})",
                        links_face_name(l, l->face[i]), c[0], c[1], c[2]);
    }
    return OK;
}

int links_cross(const struct links *l, int code, int image, int *to_image) {
    int link = code < 0 ? ~code : code, step = l->step[link];
    *to_image = image;
    if (step >= 0) *to_image = l->next[2L * l->ntranslations * image + (code < 0 ? step ^ 1 : step)];
    return code < 0 ? l->left[link] : l->right[link];
}

int links_face(const struct links *l, int code, bool *outward) {
    int link = code < 0 ? ~code : code, twin = l->twin[link];
    *outward = code >= 0 || twin >= 0;
    return code < 0 && twin >= 0 ? twin : l->face[link];
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

static double distance(const double *a, const double *b, double sign) {
    return sqrt((a[0] - sign * b[0]) * (a[0] - sign * b[0]) + (a[1] - sign * b[1]) * (a[1] - sign * b[1]) +
                (a[2] - sign * b[2]) * (a[2] - sign * b[2]));
}

/* The centre of face f of a patch of the whole mesh, m. */
static const double *centre_of(const struct links *l, const struct patch *p, long f) {
    const struct outline *o = l->all->outline;
    return o && l->part ? o->face[p - l->all->patch] + 6 * f : l->face_centre + 3 * (p->start + f);
}

/* Finds the mean shift from cyclic patch q to its other half p, cleaned of round-off; returns false if they
 * coincide. */
static bool find_shift(const struct links *l, const struct patch *p, const struct patch *q, double shift[3]) {
    double size = 0;
    shift[0] = shift[1] = shift[2] = 0;
    for (int k = 0; k < l->dim; k++) {
        int a = l->axis[k];
        for (long f = 0; f < p->nfaces; f++) shift[k] += centre_of(l, p, f)[a] - centre_of(l, q, f)[a];
        shift[k] /= p->nfaces;
        size += fabs(shift[k]);
    }
    for (int k = 0; k < l->dim; k++)
        if (fabs(shift[k]) < 1e-10 * size) shift[k] = 0;
    return size > NO_SHIFT * l->extent;
}

static int find_translation(struct links *l, const double shift[3]) {
    static const double none[3] = {0};
    for (int i = 0; i < l->ntranslations; i++) {
        double near = SAME * distance(l->translation[i], none, 1);
        if (distance(l->translation[i], shift, 1) < near) return 2 * i;
        if (distance(l->translation[i], shift, -1) < near) return 2 * i + 1;
    }
    memcpy(l->translation[l->ntranslations], shift, sizeof *l->translation);
    return 2 * l->ntranslations++;
}

static status find_steps(struct links *l) {
    const struct polymesh *m = l->mesh, *all = l->all;
    int *step;
    TRY(pool_take(l->pool, &l->translation, m->npatches, sizeof *l->translation, "the cyclic patches"));
    TRY(allocate(&step, m->npatches, sizeof *step, "the cyclic patches"));
    for (int i = 0; i < m->npatches; i++) {
        step[i] = -1;
        double shift[3];
        if (!has_type(&all->patch[i], "cyclic") || !all->patch[i].nfaces) continue;
        const struct patch *q = &all->patch[polymesh_find_patch(all, all->patch[i].neighbour)];
        if (all->patch[i].start < q->start && find_shift(l, &all->patch[i], q, shift))
            step[i] = find_translation(l, shift);
    }
    int patch = 0;
    for (int i = 0; i < l->n; i++) {
        if (l->twin[i] < 0) continue;
        while (l->face[i] < m->patch[patch].start || l->face[i] >= m->patch[patch].start + m->patch[patch].nfaces)
            patch = (patch + 1) % m->npatches;
        l->step[i] = step[patch];
    }
    free(step);
    return OK;
}

static int find_image(struct links *l, const double shift[3]) {
    double near = INFINITY;
    static const double none[3] = {0};
    for (int i = 0; i < l->ntranslations; i++) near = fmin(near, SAME * distance(l->translation[i], none, 1));
    for (int i = 0; i < l->nimages; i++)
        if (distance(l->image[i], shift, 1) < near) return i;
    if (l->nimages == MOST_IMAGES) return -1;
    memcpy(l->image[l->nimages], shift, sizeof *l->image);
    return l->nimages++;
}

/* Finds the images ring by ring of crossings, so that the shift of an image has the same bits on every rank. */
static status find_images(struct links *l) {
    TRY(pool_take(l->pool, &l->image, MOST_IMAGES, sizeof *l->image, "the images of a periodic domain"));
    TRY(pool_take(l->pool, &l->next, 2L * MOST_IMAGES * l->ntranslations, sizeof *l->next,
                  "the images of a periodic domain"));
    l->nimages = 1;
    int from = 0;
    for (int ring = 0; ring < MOST_RINGS; ring++)
        for (int to = l->nimages; from < to; from++)
            for (int s = 0; s < 2 * l->ntranslations; s++) {
                double shift[3];
                for (int k = 0; k < 3; k++) shift[k] = l->image[from][k] + (s % 2 ? -1 : 1) * l->translation[s / 2][k];
                l->next[2L * l->ntranslations * from + s] = find_image(l, shift);
            }
    for (; from < l->nimages; from++)
        for (int s = 0; s < 2 * l->ntranslations; s++) l->next[2L * l->ntranslations * from + s] = -1;
    return OK;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static status measure_faces(struct links *l) {
    const struct polymesh *m = l->mesh;
    TRY(pool_take(l->pool, &l->face_centre, 3L * m->nfaces, sizeof *l->face_centre, "the faces"));
    TRY(pool_take(l->pool, &l->face_area, 3L * m->nfaces, sizeof *l->face_area, "the faces"));
    polymesh_face_geometry(m, l->face_centre, l->face_area);
    find_axes(l);
    if (l->dim == 0)
        return fail(ERR_INPUT, "mesh: empty patches close x, y and z; an axis to solve along must be left");
    return measure_thickness(l);
}

status links_make(struct pool *pool, const struct polymesh *all, const struct mesh_part *part, struct links *l) {
    int *twin;
    const struct polymesh *m = part ? &part->mesh : all;
    *l = (struct links){.pool = pool, .all = all, .mesh = m, .part = part};
    TRY(measure_faces(l));
    int **const list[] = {&l->face, &l->twin, &l->left, &l->right, &l->patch, &l->step};
    for (int i = 0; i < (int)(sizeof list / sizeof *list); i++)
        TRY(pool_take(pool, list[i], m->nfaces, sizeof **list[i], "the links of the cells"));
    TRY(allocate(&twin, m->nfaces - m->ninternal, sizeof *twin, "the cyclic faces"));
    status s = pair_faces(m, twin);
    if (!s) list_links(l, twin);
    free(twin);
    TRY(s);
    TRY(check_links(l));
    TRY(list_cells(l));
    TRY(find_steps(l));
    for (int i = 0; i < l->n; i++)
        if (l->left[i] == l->right[i] && l->step[i] < 0)
            return fail(ERR_INPUT, "constant/polyMesh: face %d has cell %d on both sides",
                        links_face_name(l, l->face[i]), links_cell_name(l, l->left[i]));
    return find_images(l);
}
