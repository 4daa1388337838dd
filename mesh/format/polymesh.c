/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The polyMesh in memory: look-up, checksum, the faces of cells, and the geometry of faces and cells, which follows
 * OpenFOAM's primitiveMesh (triangles about the mean of a face's points, pyramids about the mean of a cell's face
 * centres). */
#include "mesh/format/polymesh.h"

#include "mesh/format/boxes.h"
#include "mesh/format/sites.h"

#include <libdeflate.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void outline_free(struct outline *o, int npatches) {
    if (!o) return;
    for (int i = 0; i < npatches; i++) {
        if (o->cell) free(o->cell[i]);
        if (o->face) free(o->face[i]);
    }
    free(o->cell);
    free(o->face);
    free(o->dir);
    sites_free(o->sites);
    free(o);
}

void polymesh_free(struct polymesh *m) {
    if (!m) return;
    outline_free(m->outline, m->npatches);
    for (int i = 0; i < m->npatches && m->patch; i++) {
        free(m->patch[i].name);
        free(m->patch[i].type);
        free(m->patch[i].neighbour);
        free(m->patch[i].groups);
    }
    free(m->patch);
    polymesh_drop(m);
    boxes_free(m->boxes);
    free(m);
}

void points_bounds(long n, const double *points, double low[3], double high[3]) {
    double least[3] = {low[0], low[1], low[2]}, most[3] = {high[0], high[1], high[2]};
    for (long i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            const double x = points[3 * i + k];
            least[k] = x < least[k] ? x : least[k];
            most[k] = x > most[k] ? x : most[k];
        }
    memcpy(low, least, sizeof least);
    memcpy(high, most, sizeof most);
}

void polymesh_bounds(const struct polymesh *m, double low[3], double high[3]) {
    const struct outline *o = m->outline;
    for (int k = 0; k < 3; k++) {
        low[k] = m->boxes ? m->boxes->low[k] : o ? o->low[k] : HUGE_VAL;
        high[k] = m->boxes ? m->boxes->high[k] : o ? o->high[k] : -HUGE_VAL;
    }
    if (m->points && !o) points_bounds(m->npoints, m->points, low, high);
}

const char *polymesh_boundary_file(const struct polymesh *m) {
    return m->boxes ? "system/blockMeshDict" : "constant/polyMesh/boundary";
}

/* Is a word one of a text of words with blanks between? */
static bool has_word(const char *text, const char *word) {
    const size_t n = strlen(word);
    for (const char *at = text; n && at && (at = strstr(at, word)); at += n)
        if ((at == text || at[-1] == ' ') && (!at[n] || at[n] == ' ')) return true;
    return false;
}

bool patch_in_group(const struct patch *p, const char *group) {
    return (strcmp(p->type, "patch") != 0 && !strcmp(p->type, group)) || has_word(p->groups, group);
}

void patch_write_groups(struct sink *s, const struct patch *p) {
    const char *groups = p->groups ? p->groups : "",
               *type = strcmp(p->type, "patch") != 0 && !has_word(groups, p->type) ? p->type : "";
    int n = (*groups != 0) + (*type != 0);
    for (const char *c = groups; *c; c++) n += *c == ' ';
    if (n) sink_printf(s, "        inGroups        %d(%s%s%s);\n", n, groups, *groups && *type ? " " : "", type);
}

int polymesh_find_patch(const struct polymesh *m, const char *name) {
    for (int i = 0; i < m->npatches; i++)
        if (strcmp(m->patch[i].name, name) == 0) return i;
    return -1;
}

/* Leaves the arrays to someone else. */
static void forget(struct polymesh *m) {
    m->points = NULL;
    m->face_start = m->face_points = m->owner = m->neighbour = NULL;
}

/* Reads the arrays of a mesh that is spread; they must be those that were read before. */
static status read_again(struct polymesh *m) {
    struct polymesh *whole;
    TRY(polymesh_read(m->outline->dir, &whole));
    const unsigned long sum = polymesh_checksum(whole);
    if (sum != polymesh_checksum(m)) {
        polymesh_free(whole);
        return fail(ERR_INPUT, "%s: it has changed since the run began; start the run anew", m->outline->dir);
    }
    m->points = whole->points;
    m->face_start = whole->face_start;
    m->face_points = whole->face_points;
    m->owner = whole->owner;
    m->neighbour = whole->neighbour;
    forget(whole);
    polymesh_free(whole);
    return OK;
}

void polymesh_drop(struct polymesh *m) {
    free(m->points);
    free(m->face_start);
    free(m->face_points);
    free(m->owner);
    free(m->neighbour);
    forget(m);
}

status polymesh_complete(struct polymesh *m) {
    if (m->points) return OK;
    return m->boxes ? boxes_complete(m) : m->outline ? read_again(m) : OK;
}

/* Adds up what a mesh of boxes is made from. */
static uint32_t boxes_checksum(const struct boxes *b) {
    uint32_t sum = 0;
    sum = libdeflate_crc32(sum, b->low, sizeof b->low);
    sum = libdeflate_crc32(sum, b->high, sizeof b->high);
    for (int i = 0; i < b->nboxes; i++) {
        const struct brick *x = &b->box[i];
        sum = libdeflate_crc32(sum, x->low, sizeof x->low);
        sum = libdeflate_crc32(sum, x->n, sizeof x->n);
        for (int k = 0; k < 3; k++) {
            const int axis[2] = {x->cell.axis[k], x->cell.down[k]};
            sum = libdeflate_crc32(sum, axis, sizeof axis);
        }
    }
    for (int i = 0; i < b->nsides; i++) {
        const struct brick_name name = b->side[i];
        const int side[3] = {name.box, name.side, b->box[name.box].side[name.side].patch};
        sum = libdeflate_crc32(sum, side, sizeof side);
    }
    return sum;
}

static uint32_t arrays_checksum(const struct polymesh *m) {
    struct {
        const void *data;
        size_t bytes;
    } part[] = {{m->points, (size_t)m->npoints * 3 * sizeof *m->points},
                {m->face_start, ((size_t)m->nfaces + 1) * sizeof *m->face_start},
                {m->face_points, (size_t)m->face_start[m->nfaces] * sizeof *m->face_points},
                {m->owner, (size_t)m->nfaces * sizeof *m->owner},
                {m->neighbour, (size_t)m->ninternal * sizeof *m->neighbour}};
    uint32_t sum = 0;
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) sum = libdeflate_crc32(sum, part[i].data, part[i].bytes);
    return sum;
}

unsigned long polymesh_checksum(const struct polymesh *m) {
    uint32_t sum = m->boxes ? boxes_checksum(m->boxes) : m->outline ? (uint32_t)m->outline->sum : arrays_checksum(m);
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        sum = libdeflate_crc32(sum, p->name, strlen(p->name) + 1);
        sum = libdeflate_crc32(sum, p->type, strlen(p->type) + 1);
        sum = libdeflate_crc32(sum, &p->nfaces, sizeof p->nfaces);
    }
    return sum;
}

status polymesh_cell_faces(const struct polymesh *m, int **start, int **face) {
    *start = *face = NULL;
    TRY(allocate(start, m->ncells + 2L, sizeof(int), "faces of cells"));
    TRY(allocate(face, m->nfaces + (long)m->ninternal, sizeof(int), "faces of cells"));
    int *next = *start + 1; /* counted one entry late: filling `face` moves every entry to its cell's start */
    for (int f = 0; f < m->nfaces; f++) {
        next[m->owner[f] + 1]++;
        if (f < m->ninternal) next[m->neighbour[f] + 1]++;
    }
    for (int c = 0; c < m->ncells; c++) next[c + 1] += next[c];
    for (int f = 0; f < m->nfaces; f++) {
        (*face)[next[m->owner[f]]++] = f;
        if (f < m->ninternal) (*face)[next[m->neighbour[f]]++] = f;
    }
    return OK;
}

/* Names the shapes of which there are cells. */
static void name_shapes(const long total[5], char text[POLYMESH_SHAPES]) {
    static const char *const names[] = {"tetrahedra", "pyramids", "prisms", "hexahedra", "polyhedra"};
    int length = 0;
    text[0] = 0;
    for (int i = 0; i < 5; i++)
        if (total[i])
            length += snprintf(text + length, (size_t)(POLYMESH_SHAPES - length), "%s%ld %s", length ? ", " : "",
                               total[i], names[i]);
}

status polymesh_count_shapes(const struct polymesh *m, const bool *counted, long total[5]) {
    int(*count)[2]; /* [ncells][2] faces of a cell without four corners, with four */
    for (int i = 0; i < 5; i++) total[i] = 0;
    TRY(allocate(&count, m->ncells, sizeof *count, "cells"));
    for (int f = 0; f < m->nfaces; f++)
        for (int side = 0; side < (f < m->ninternal ? 2 : 1); side++)
            count[side ? m->neighbour[f] : m->owner[f]][m->face_start[f + 1] - m->face_start[f] == 4]++;
    for (int c = 0; c < m->ncells; c++) {
        int t = count[c][0], q = count[c][1];
        if (counted && !counted[c]) continue;
        total[t == 4 && q == 0 ? 0 : t == 4 && q == 1 ? 1 : t == 2 && q == 3 ? 2 : t == 0 && q == 6 ? 3 : 4]++;
    }
    free(count);
    return OK;
}

status polymesh_shapes(const struct polymesh *m, char text[POLYMESH_SHAPES]) {
    long total[5];
    text[0] = 0;
    if (!m->outline) TRY(polymesh_count_shapes(m, NULL, total));
    name_shapes(m->outline ? m->outline->shape : total, text);
    return OK;
}

/* ---- geometry ---------------------------------------------------------------------------------------------------- */

static void triangle_normal(const double *a, const double *b, const double *c, double n[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

/* Computes the geometry of a face of n points. */
static inline void outline_geometry(const double *points, const int *p, int n, double *centre, double *area) {
    double mean[3] = {0}, sum_n[3] = {0}, sum_a = 0, sum_ac[3] = {0};
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) mean[k] += points[3L * p[i] + k];
    for (int k = 0; k < 3; k++) mean[k] /= n;
    if (n == 3) {
        triangle_normal(points + 3L * p[0], points + 3L * p[1], points + 3L * p[2], sum_n);
    } else {
        for (int i = 0; i < n; i++) {
            const double *a = points + 3L * p[i], *b = points + 3L * p[i + 1 < n ? i + 1 : 0];
            double t[3];
            triangle_normal(a, b, mean, t);
            double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
            sum_a += size;
            for (int k = 0; k < 3; k++) sum_n[k] += t[k], sum_ac[k] += size * (a[k] + b[k] + mean[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        area[k] = 0.5 * sum_n[k];
        centre[k] = n > 3 && sum_a > 0 ? sum_ac[k] / sum_a / 3 : mean[k];
    }
}

void polymesh_one_face(const struct polymesh *m, int f, double centre[3], double area[3]) {
    const int *p = m->face_points + m->face_start[f], n = m->face_start[f + 1] - m->face_start[f];
    if (n == 4) /* the most frequent number of points is a constant, by which the loops unroll */
        outline_geometry(m->points, p, 4, centre, area);
    else
        outline_geometry(m->points, p, n, centre, area);
}

void polymesh_face_geometry(const struct polymesh *m, double *centre, double *area) {
    for (int f = 0; f < m->nfaces; f++) polymesh_one_face(m, f, centre + 3L * f, area + 3L * f);
}

int polymesh_patch_cell(const struct polymesh *m, int patch, int i) {
    int at[3], side;
    if (m->outline && !m->owner) return m->outline->cell[patch][i];
    if (!m->boxes) return m->owner[m->patch[patch].start + i];
    boxes_face_at(m->boxes, patch, i, at, &side);
    return (int)boxes_cell(m->boxes, at);
}

void polymesh_patch_face(const struct polymesh *m, int patch, int i, double centre[3], double area[3]) {
    static const int order[4] = {0, 1, 2, 3};
    if (m->boxes) {
        double corner[4][3];
        int at[3], side;
        boxes_face_at(m->boxes, patch, i, at, &side);
        boxes_corners(m->boxes, at, side, corner);
        outline_geometry(corner[0], order, 4, centre, area);
        return;
    }
    if (m->outline && !m->points) {
        memcpy(centre, m->outline->face[patch] + 6L * i, 3 * sizeof *centre);
        memcpy(area, m->outline->face[patch] + 6L * i + 3, 3 * sizeof *area);
        return;
    }
    polymesh_one_face(m, m->patch[patch].start + i, centre, area);
}

/* Finds which axes `empty` patches close. An axis that is closed at all is closed at each cell (polymesh_check), so
 * that the faces of cell 0 tell. */
static void closed_axes(const struct polymesh *m, bool closed[3]) {
    const struct boxes *b = m->boxes;
    for (int k = 0; k < 3 && m->outline; k++) closed[k] = m->outline->closed[k];
    for (int p = 0; p < m->npatches && !m->outline; p++) {
        if (strcmp(m->patch[p].type, "empty") != 0) continue;
        for (int i = b ? b->first[p] : 0; b && i < b->first[p + 1]; i++) closed[b->side[i].side / 2] = true;
        for (int f = 0; !b && f < m->patch[p].nfaces; f++) {
            double centre[3], a[3];
            if (m->owner[m->patch[p].start + f] != 0) continue;
            polymesh_patch_face(m, p, f, centre, a);
            int k = fabs(a[1]) > fabs(a[0]) ? 1 : 0;
            closed[fabs(a[2]) > fabs(a[k]) ? 2 : k] = true;
        }
    }
}

int polymesh_axes(const struct polymesh *m, int axis[3]) {
    bool closed[3] = {false};
    int dim = 0;
    closed_axes(m, closed);
    for (int x = 0; x < 3; x++)
        if (!closed[x]) axis[dim++] = x;
    return dim;
}

static void add_pyramid(const double *mean, const double *fc, const double *fa, double sign, double *centre,
                        double *v) {
    double volume = 0;
    for (int k = 0; k < 3; k++) volume += sign * fa[k] * (fc[k] - mean[k]);
    for (int k = 0; k < 3; k++) centre[k] += volume * (0.75 * fc[k] + 0.25 * mean[k]);
    *v += volume;
}

/* Finds the mean of the face centres of every cell; `volume` counts the faces meanwhile. */
static void cell_means(const struct polymesh *m, const double *face_centre, double *mean, double *volume) {
    memset(mean, 0, (size_t)m->ncells * 3 * sizeof *mean);
    memset(volume, 0, (size_t)m->ncells * sizeof *volume);
    for (int f = 0; f < m->nfaces; f++)
        for (int side = 0; side < 2 - (f >= m->ninternal); side++) {
            long c = side ? m->neighbour[f] : m->owner[f];
            for (int k = 0; k < 3; k++) mean[3 * c + k] += face_centre[3L * f + k];
            volume[c] += 1;
        }
    for (long c = 0; c < m->ncells; c++)
        for (int k = 0; k < 3; k++) mean[3 * c + k] /= volume[c];
}

status polymesh_cell_geometry(const struct polymesh *m, const double *face_centre, const double *face_area,
                              double *centre, double *volume) {
    double *mean;
    TRY(allocate(&mean, 3L * m->ncells, sizeof *mean, "cell centres"));
    cell_means(m, face_centre, mean, volume);
    memset(centre, 0, (size_t)m->ncells * 3 * sizeof *centre);
    memset(volume, 0, (size_t)m->ncells * sizeof *volume);
    for (long f = 0; f < m->nfaces; f++) {
        const double *fc = face_centre + 3 * f, *fa = face_area + 3 * f;
        long c = m->owner[f];
        add_pyramid(mean + 3 * c, fc, fa, 1, centre + 3 * c, volume + c);
        if (f >= m->ninternal) continue;
        c = m->neighbour[f];
        add_pyramid(mean + 3 * c, fc, fa, -1, centre + 3 * c, volume + c);
    }
    for (long c = 0; c < m->ncells; c++) {
        for (int k = 0; k < 3; k++)
            centre[3 * c + k] = fabs(volume[c]) > 1e-300 ? centre[3 * c + k] / volume[c] : mean[3 * c + k];
        volume[c] /= 3;
    }
    free(mean);
    return OK;
}

status polymesh_geometry_make(const struct polymesh *m, struct polymesh_geometry *g) {
    *g = (struct polymesh_geometry){0};
    TRY(allocate(&g->face_centre, 3L * m->nfaces, sizeof(double), "face centres"));
    TRY(allocate(&g->face_area, 3L * m->nfaces, sizeof(double), "face areas"));
    TRY(allocate(&g->cell_centre, 3L * m->ncells, sizeof(double), "cell centres"));
    TRY(allocate(&g->volume, m->ncells, sizeof(double), "cell volumes"));
    polymesh_face_geometry(m, g->face_centre, g->face_area);
    return polymesh_cell_geometry(m, g->face_centre, g->face_area, g->cell_centre, g->volume);
}

void polymesh_geometry_free(struct polymesh_geometry *g) {
    free(g->face_centre);
    free(g->face_area);
    free(g->cell_centre);
    free(g->volume);
    *g = (struct polymesh_geometry){0};
}
