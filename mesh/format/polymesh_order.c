/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts faces into OpenFOAM's order (polymesh_order): internal faces by owner and neighbour, then patch by patch; turns
 * faces so that normals point out of the owner; orders the second half of a cyclic pair as the first. */
#include "mesh/format/polymesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct key {
    int patch; /* -1: an internal face; these come first */
    int owner, neighbour, face;
};
struct place {
    double s; /* coordinate along GENERAL, a direction in general position: no two faces of a lattice have the same */
    int face;
};
static const double GENERAL[3] = {0.5406, 0.6713, 0.5071};
static const double MATCH = 1e-4; /* OpenFOAM's matchTolerance, times the square root of the area */

static int key_order(const void *a, const void *b) {
    const struct key *p = a, *q = b;
    if (p->patch != q->patch) return p->patch < q->patch ? -1 : 1;
    if (p->owner != q->owner) return p->owner < q->owner ? -1 : 1;
    if (p->neighbour != q->neighbour) return p->neighbour < q->neighbour ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

static int place_order(const void *a, const void *b) {
    double p = ((const struct place *)a)->s, q = ((const struct place *)b)->s;
    return (p > q) - (p < q);
}

/* Makes the owner the lower of the two cells and turns the face until its normal points out of the owner, that is away
 * from the mean of the owner's face centres. */
static status orient(struct polymesh *m, double *centre, double *area) {
    double *mean;
    int *count;
    TRY(allocate(&mean, 3L * m->ncells, sizeof *mean, "cells"));
    status s = allocate(&count, m->ncells, sizeof *count, "cells");
    if (s) {
        free(mean);
        return s;
    }
    for (long f = 0; f < m->nfaces; f++) {
        int o = m->owner[f], n = m->neighbour[f];
        if (n >= 0 && n < o) m->owner[f] = n, m->neighbour[f] = o;
        for (int side = 0; side < (n >= 0 ? 2 : 1); side++) {
            long c = side ? m->neighbour[f] : m->owner[f];
            for (int k = 0; k < 3; k++) mean[3 * c + k] += centre[3 * f + k];
            count[c]++;
        }
    }
    for (long f = 0; f < m->nfaces; f++) {
        long c = m->owner[f];
        double out = 0;
        for (int k = 0; k < 3; k++) out += area[3 * f + k] * (centre[3 * f + k] - mean[3 * c + k] / count[c]);
        if (out >= 0) continue;
        for (int i = m->face_start[f] + 1, j = m->face_start[f + 1] - 1; i < j; i++, j--) {
            int p = m->face_points[i];
            m->face_points[i] = m->face_points[j];
            m->face_points[j] = p;
        }
        for (int k = 0; k < 3; k++) area[3 * f + k] = -area[3 * f + k];
    }
    free(mean);
    free(count);
    return OK;
}

/* ---- cyclic halves ----------------------------------------------------------------------------------------------- */

struct halves {
    struct polymesh *m;
    const double *centre, *area;
    const char *name[2];
    double shift[3]; /* m, from the first half to the second */
};

static double distance(const double *a, const double *shift, const double *b) {
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = a[k] + shift[k] - b[k];
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static double face_tolerance(const struct halves *h, long f) {
    const double *a = h->area + 3 * f;
    return MATCH * sqrt(sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
}

/* Turns the points of face b so that its point 0 lies opposite to point 0 of face a; false: the points do not match. */
static bool turn(const struct halves *h, long a, long b) {
    struct polymesh *m = h->m;
    int n = m->face_start[a + 1] - m->face_start[a];
    int *pa = m->face_points + m->face_start[a], *pb = m->face_points + m->face_start[b];
    if (m->face_start[b + 1] - m->face_start[b] != n) return false;
    double tolerance = face_tolerance(h, a);
    int first = 0;
    while (first < n && distance(m->points + 3L * pa[0], h->shift, m->points + 3L * pb[first]) > tolerance) first++;
    if (first == n) return false;
    for (int turns = 0; turns < first; turns++) {
        int p = pb[0];
        memmove(pb, pb + 1, (size_t)(n - 1) * sizeof *pb);
        pb[n - 1] = p;
    }
    for (int i = 0; i < n; i++)
        if (distance(m->points + 3L * pa[i], h->shift, m->points + 3L * pb[(n - i) % n]) > tolerance) return false;
    return true;
}

static int find_partner(const struct halves *h, long a, const struct place *place, int n) {
    double tolerance = face_tolerance(h, a), s = 0;
    for (int k = 0; k < 3; k++) s += GENERAL[k] * (h->centre[3 * a + k] + h->shift[k]);
    int low = 0, high = n;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (place[middle].s < s - tolerance)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < n && place[low].s <= s + tolerance; low++)
        if (place[low].face >= 0 &&
            distance(h->centre + 3 * a, h->shift, h->centre + 3L * place[low].face) <= tolerance)
            return low;
    return -1;
}

static status pair_faces(struct halves *h, const struct key *first, struct key *second, int n, struct place *place) {
    for (int i = 0; i < n; i++) {
        const double *a = h->centre + 3L * first[i].face, *b = h->centre + 3L * second[i].face;
        for (int k = 0; k < 3; k++) h->shift[k] += (b[k] - a[k]) / n;
        place[i].face = second[i].face;
        for (int k = 0; k < 3; k++) place[i].s += GENERAL[k] * b[k];
    }
    qsort(place, (size_t)n, sizeof *place, place_order);
    for (int i = 0; i < n; i++) {
        long a = first[i].face;
        const double *c = h->centre + 3 * a;
        int found = find_partner(h, a, place, n);
        if (found < 0 || !turn(h, a, place[found].face))
            return fail(
                ERR_INPUT,
                "cyclic patches '%s' and '%s': the face at (%g, %g, %g) of '%s' has no partner at a distance of "
                "(%g, %g, %g); the halves must be equal but for a translation: give both the same mesh "
                "(gmsh: Periodic Curve/Surface)",
                h->name[0], h->name[1], c[0], c[1], c[2], h->name[0], h->shift[0], h->shift[1], h->shift[2]);
        second[i].face = place[found].face;
        second[i].owner = h->m->owner[second[i].face];
        /* a matched face is taken: no second partner may find it */
        place[found].face = -1;
    }
    return OK;
}

static status pair_halves(struct polymesh *m, const double *centre, const double *area, struct key *key) {
    for (int i = 0; i < m->npatches; i++) {
        struct patch *p = &m->patch[i];
        if (strcmp(p->type, "cyclic") != 0) continue;
        int j = p->neighbour ? polymesh_find_patch(m, p->neighbour) : -1;
        if (j < 0 || j == i || strcmp(m->patch[j].type, "cyclic") != 0 || !m->patch[j].neighbour ||
            strcmp(m->patch[j].neighbour, p->name) != 0)
            return fail(ERR_INPUT,
                        "cyclic patch '%s' has neighbourPatch '%s'; each half must be cyclic and name the other one",
                        p->name, p->neighbour ? p->neighbour : "(none)");
        struct patch *q = &m->patch[j];
        if (p->nfaces != q->nfaces)
            return fail(ERR_INPUT,
                        "cyclic patch '%s' has %d faces and '%s' has %d; both halves need the same mesh "
                        "(gmsh: Periodic Curve/Surface)",
                        p->name, p->nfaces, q->name, q->nfaces);
        if (j < i || p->nfaces == 0) continue;
        struct halves h = {.m = m, .centre = centre, .area = area, .name = {p->name, q->name}};
        struct place *place;
        TRY(allocate(&place, p->nfaces, sizeof *place, "cyclic faces"));
        status s = pair_faces(&h, key + p->start, key + q->start, p->nfaces, place);
        free(place);
        TRY(s);
    }
    return OK;
}

/* ---- the order --------------------------------------------------------------------------------------------------- */

static status check_input(const struct polymesh *m, const int *patch_of_face) {
    for (int f = 0; f < m->nfaces; f++) {
        bool inside = m->neighbour[f] >= 0;
        if (m->owner[f] < 0 || m->owner[f] >= m->ncells || m->neighbour[f] >= m->ncells ||
            m->owner[f] == m->neighbour[f] || (!inside && (patch_of_face[f] < 0 || patch_of_face[f] >= m->npatches)))
            return fail(ERR_INPUT, "face %d: owner %d, neighbour %d, patch %d; there are %d cells and %d patches", f,
                        m->owner[f], m->neighbour[f], patch_of_face[f], m->ncells, m->npatches);
    }
    return OK;
}

static void sort_keys(struct polymesh *m, const int *patch_of_face, struct key *key) {
    m->ninternal = 0;
    for (int i = 0; i < m->npatches; i++) m->patch[i].nfaces = 0;
    for (int f = 0; f < m->nfaces; f++) {
        bool inside = m->neighbour[f] >= 0;
        key[f] = (struct key){inside ? -1 : patch_of_face[f], m->owner[f], m->neighbour[f], f};
        if (inside)
            m->ninternal++;
        else
            m->patch[patch_of_face[f]].nfaces++;
    }
    for (int i = 0, start = m->ninternal; i < m->npatches; start += m->patch[i++].nfaces) m->patch[i].start = start;
    if (m->nfaces) qsort(key, (size_t)m->nfaces, sizeof *key, key_order);
}

static status permute(struct polymesh *m, const struct key *key) {
    int *start = NULL, *points = NULL, *owner = NULL, *neighbour = NULL;
    status s = allocate(&start, m->nfaces + 1L, sizeof *start, "faces");
    if (!s) s = allocate(&points, m->face_start[m->nfaces], sizeof *points, "faces");
    if (!s) s = allocate(&owner, m->nfaces, sizeof *owner, "faces");
    if (!s) s = allocate(&neighbour, m->ninternal, sizeof *neighbour, "faces");
    if (s) {
        free(start);
        free(points);
        free(owner);
        return s;
    }
    for (int i = 0; i < m->nfaces; i++) {
        int f = key[i].face, n = m->face_start[f + 1] - m->face_start[f];
        start[i + 1] = start[i] + n;
        memcpy(points + start[i], m->face_points + m->face_start[f], (size_t)n * sizeof *points);
        owner[i] = m->owner[f];
        if (i < m->ninternal) neighbour[i] = m->neighbour[f];
    }
    free(m->face_start);
    free(m->face_points);
    free(m->owner);
    free(m->neighbour);
    m->face_start = start;
    m->face_points = points;
    m->owner = owner;
    m->neighbour = neighbour;
    return OK;
}

status polymesh_order(struct polymesh *m, const int *patch_of_face) {
    TRY(check_input(m, patch_of_face));
    double *geometry;
    struct key *key;
    TRY(allocate(&geometry, 6L * m->nfaces, sizeof *geometry, "faces"));
    status s = allocate(&key, m->nfaces, sizeof *key, "faces");
    if (!s) {
        double *centre = geometry, *area = geometry + 3L * m->nfaces;
        polymesh_face_geometry(m, centre, area);
        s = orient(m, centre, area);
        if (!s) {
            sort_keys(m, patch_of_face, key);
            s = pair_halves(m, centre, area, key);
        }
        if (!s) s = permute(m, key);
        free(key);
    }
    free(geometry);
    return s;
}
