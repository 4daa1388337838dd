/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds what every rank knows of a mesh that is spread over the ranks (struct outline, polymesh.h), and checks the
 * mesh. */
#include <libdeflate.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "mesh/spread/spread_private.h"

/* Where no cell is narrower than this part of twice the mean, which the median is not above, a run neither refuses the
 * mesh for one (1e-12 of the median) nor warns of one (1e-6). */
static const double LEAST_RATIO = 2e-6;

enum { ARRAYS = 5 }; /* of a checksum */

/* ---- the checksum ------------------------------------------------------------------------------------------------ */

/* Adds up what this rank has of each array: sum[i], and its bytes. The first face begins at 0, and each rank adds where
 * its faces end. */
static status sum_slices(const struct lists *s, double sum[ARRAYS], double bytes[ARRAYS]) {
    const long n = s->faces.end - s->faces.first, left = s->ninternal - s->faces.first,
               inner = left < 0   ? 0
                       : left < n ? left
                                  : n;
    const long none = s->faces.first > 0; /* the first rank begins with a 0 */
    int *start;
    TRY(allocate(&start, n + 1, sizeof *start, "a checksum"));
    for (long i = 0; i <= n; i++) start[i] = s->first_corner + s->start[i];
    const struct {
        const void *data;
        long bytes;
    } part[ARRAYS] = {{s->point, (s->points.end - s->points.first) * 3 * (long)sizeof(double)},
                      {start + none, (n + 1 - none) * (long)sizeof(int)},
                      {s->corner, s->start[n] * (long)sizeof(int)},
                      {s->owner, n * (long)sizeof(int)},
                      {s->neighbour, inner * (long)sizeof(int)}};
    for (int i = 0; i < ARRAYS; i++) {
        sum[i] = libdeflate_crc32(0, part[i].data, (size_t)part[i].bytes);
        bytes[i] = (double)part[i].bytes;
    }
    free(start);
    return OK;
}

status outline_sum(const struct lists *s, unsigned long *out) {
    const struct comm *c = s->faces.comm;
    double mine[2 * ARRAYS], *all = NULL;
    TRY(comm_agree(c, sum_slices(s, mine, mine + ARRAYS)));
    TRY(comm_gather(c, mine, 2 * ARRAYS, &all, NULL));
    *out = 0;
    for (int i = 0; all && i < ARRAYS; i++)
        for (int r = 0; r < comm_size(c); r++) {
            const double *theirs = all + 2L * ARRAYS * r;
            *out = crc32_combine(*out, (unsigned long)theirs[i], (z_off_t)theirs[ARRAYS + i]);
        }
    free(all);
    comm_broadcast(c, out, sizeof *out);
    return OK;
}

/* ---- the box, the axes, shapes and widths ------------------------------------------------------------------------ */

void outline_box(const struct lists *s, struct outline *o) {
    const struct comm *c = s->points.comm;
    for (int k = 0; k < 3; k++) {
        o->low[k] = HUGE_VAL;
        o->high[k] = -HUGE_VAL;
    }
    points_bounds(s->points.end - s->points.first, s->point, o->low, o->high);
    comm_min(c, o->low, 3);
    comm_max(c, o->high, 3);
}

static void find_closed(const struct spread *s, struct outline *o) {
    const struct polymesh *m = &s->home.mesh;
    double closed[3] = {0, 0, 0};
    for (int i = 0; i < m->npatches; i++)
        for (long f = m->patch[i].start; f < m->patch[i].start + m->patch[i].nfaces; f++) {
            if (strcmp(m->patch[i].type, "empty") != 0) break;
            const double *a = s->geometry.face_area + 3 * f;
            const int k = fabs(a[1]) > fabs(a[0]) ? 1 : 0;
            closed[fabs(a[2]) > fabs(a[k]) ? 2 : k] = 1;
        }
    comm_max(s->comm, closed, 3);
    for (int k = 0; k < 3; k++) o->closed[k] = closed[k] > 0;
}

/* Is no cell far narrower than the others? */
static status compare_widths(const struct spread *s, bool *alike) {
    const struct polymesh *m = &s->home.mesh;
    double *width, least = HUGE_VAL, sum = 0, *sums = NULL;
    TRY(comm_agree(s->comm, allocate(&width, m->ncells, sizeof *width, "cells")));
    polymesh_widths(m, s->geometry.face_area, s->geometry.volume, width);
    for (long i = s->base; i < s->base + s->cells.end - s->cells.first; i++) {
        sum += width[i];
        least = fmin(least, width[i]);
    }
    free(width);
    comm_min(s->comm, &least, 1);
    TRY(comm_gather(s->comm, &sum, 1, &sums, NULL));
    for (int r = 1; sums && r < comm_size(s->comm); r++) sum += sums[r];
    free(sums);
    comm_broadcast(s->comm, &sum, sizeof sum);
    *alike = least / (2 * sum / (double)s->cells.n) >= LEAST_RATIO;
    return OK;
}

/* ---- faces on patches -------------------------------------------------------------------------------------------- */

/* Lists the faces of this rank's slice of cells that are on patches which are not empty; returns how many. */
static long list_faces(const struct spread *s, const struct polymesh *all, double *out) {
    const struct mesh_part *h = &s->home;
    const struct polymesh *m = &h->mesh;
    long n = 0;
    for (int p = 0; p < m->npatches; p++)
        for (long f = m->patch[p].start; f < m->patch[p].start + m->patch[p].nfaces; f++) {
            if (!strcmp(m->patch[p].type, "empty") || !h->whole[m->owner[f]]) continue;
            double *to = out ? out + WALL * n : NULL;
            n++;
            if (!to) continue;
            to[0] = p;
            to[1] = h->face[f] - all->patch[p].start;
            to[2] = h->cell[m->owner[f]];
            memcpy(to + WALL_CENTRE, s->geometry.face_centre + 3 * f, 3 * sizeof *to);
            memcpy(to + WALL_CENTRE + 3, s->geometry.face_area + 3 * f, 3 * sizeof *to);
        }
    return n;
}

static status make_patches(struct polymesh *m) {
    struct outline *o = m->outline;
    if (o->cell) return OK; /* it was tried whether the mesh is a lattice */
    TRY(allocate(&o->cell, m->npatches, sizeof *o->cell, "faces of patches"));
    TRY(allocate(&o->face, m->npatches, sizeof *o->face, "faces of patches"));
    for (int p = 0; p < m->npatches; p++) {
        if (!strcmp(m->patch[p].type, "empty")) continue;
        TRY(allocate(&o->cell[p], m->patch[p].nfaces, sizeof **o->cell, "faces of patches"));
        TRY(allocate(&o->face[p], 6L * m->patch[p].nfaces, sizeof **o->face, "faces of patches"));
    }
    return OK;
}

status outline_walls(const struct comm *c, struct polymesh *m, const double *mine, long n, double **all, long *nall) {
    const int size = comm_size(c);
    int *count = NULL;
    *all = NULL;
    status e = make_patches(m);
    if (!e) e = allocate(&count, 2L * size + 1, sizeof *count, "faces of patches");
    e = comm_agree(c, e);
    if (!e) e = comm_share_count(c, WALL * n, count, count + size);
    if (!e) e = comm_agree(c, allocate(all, count[2L * size], sizeof **all, "faces of patches"));
    if (!e) comm_share(c, mine, count, count + size, *all);
    *nall = e ? 0 : count[2L * size] / WALL;
    for (long i = 0; i < *nall; i++) {
        const double *face = *all + WALL * i;
        const int p = (int)face[0], place = (int)face[1];
        m->outline->cell[p][place] = (int)face[2];
        memcpy(m->outline->face[p] + 6L * place, face + WALL_CENTRE, 6 * sizeof *face);
    }
    free(count);
    return e;
}

static status find_patches(const struct spread *s, struct polymesh *m) {
    long n = list_faces(s, m, NULL);
    double *mine = NULL, *all = NULL;
    TRY(comm_agree(s->comm, allocate(&mine, WALL * n, sizeof *mine, "faces of patches")));
    list_faces(s, m, mine);
    const status e = outline_walls(s->comm, m, mine, n, &all, &n);
    free(mine);
    free(all);
    return e;
}

/* ---- checks ------------------------------------------------------------------------------------------------------ */

/* Are all cells closed, normals outward, halves of cyclic patches alike (polymesh_check), and has each cell four
 * faces? */
static status check(const struct spread *s, const struct polymesh *m, bool *sound) {
    const struct outline *o = m->outline;
    double(*offset)[3];
    TRY(allocate(&offset, m->npatches, sizeof *offset, "cyclic patches"));
    for (int i = 0; i < m->npatches; i++) {
        const int j = m->patch[i].neighbour ? polymesh_find_patch(m, m->patch[i].neighbour) : -1;
        if (j < 0) continue;
        *sound &= m->patch[j].nfaces == m->patch[i].nfaces;
        for (int k = 0; *sound && k < 3 && m->patch[i].nfaces; k++) offset[i][k] = o->face[j][k] - o->face[i][k];
    }
    for (long i = s->base; i < s->base + s->cells.end - s->cells.first; i++)
        *sound &= s->cell_start[i + 1] - s->cell_start[i] >= 4;
    status e =
        *sound ? polymesh_check_part(&s->home.mesh, &s->geometry, s->home.whole, o->closed, (const double(*)[3])offset)
               : OK;
    free(offset);
    if (e && status_kind(e) == ERR_SYSTEM) return e;
    *sound &= !e;
    status_free(e);
    return OK;
}

status outline_make(const struct spread *s, struct polymesh *m, bool *sound) {
    struct outline *o = m->outline;
    find_closed(s, o);
    TRY(compare_widths(s, sound));
    TRY(find_patches(s, m));
    TRY(comm_agree(s->comm, polymesh_count_shapes(&s->home.mesh, s->home.whole, o->shape)));
    comm_sum_long(s->comm, o->shape, 5);
    TRY(comm_agree(s->comm, check(s, m, sound)));
    lists_agree(s->comm, sound);
    return OK;
}
