/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The faces on patches of a lattice that is found in slices (sites_private.h): what each rank knows of them, and
 * whether empty and cyclic patches are those of a lattice (lattice.c) and sound (polymesh_check). */
#include <stdlib.h>
#include <string.h>

#include "mesh/spread/sites_private.h"

static bool is_empty(const struct patch *p) {
    return !strcmp(p->type, "empty");
}

/* Computes centre and area of a face of the round. */
static void measure(const struct finder *f, const int *corner, double centre[3], double area[3]) {
    double x[4][3];
    int start[2] = {0, 4}, around[4] = {0, 1, 2, 3};
    for (int i = 0; i < 4; i++) memcpy(x[i], f->x + 3L * corner[i], sizeof x[i]);
    const struct polymesh one = {.nfaces = 1, .points = x[0], .face_start = start, .face_points = around};
    polymesh_one_face(&one, 0, centre, area);
}

status wall_add(struct finder *f, long face, const int *corner, const int claim[3], int turn) {
    const struct polymesh *m = f->mesh;
    while (face >= m->patch[f->patch].start + m->patch[f->patch].nfaces) f->patch++;
    const struct patch *p = &m->patch[f->patch];
    const int axis = claim[2] / 2;
    f->closed[axis] |= is_empty(p);
    f->walled[axis] |= !is_empty(p);
    if (is_empty(p)) return OK;
    if (f->nwalls == f->wall_room) {
        f->wall_room = 2 * f->wall_room + 1024;
        double *more = realloc(f->wall, (size_t)f->wall_room * WALL * sizeof *more);
        if (!more) return fail(ERR_SYSTEM, "no memory for %ld faces on patches", f->wall_room);
        f->wall = more;
    }
    double *to = f->wall + WALL * f->nwalls++;
    const double head[WALL_CENTRE] = {f->patch, (double)(face - p->start), claim[0], claim[1], claim[2], turn};
    memcpy(to, head, sizeof head);
    measure(f, corner, to + WALL_CENTRE, to + WALL_CENTRE + 3);
    return OK;
}

/* ---- empty patches, walls without thickness ---------------------------------------------------------------------- */

/* Finds the axes that empty patches close. Across such an axis the mesh is one cell thick, and no other patch lies. */
static bool take_axes(struct finder *f) {
    double all[6];
    bool good = true;
    int left = 0;
    for (int k = 0; k < 3; k++) {
        all[k] = f->closed[k];
        all[3 + k] = f->walled[k];
    }
    comm_max(f->sites->cells.comm, all, 6);
    for (int k = 0; k < 3; k++) {
        f->sites->closed[k] = all[k] > 0;
        left += !f->sites->closed[k];
        good = good && (all[k] == 0 || (all[3 + k] == 0 && f->sites->n[k] == 1));
    }
    return good && left > 0;
}

/* Is there no cell beyond a patch? */
static status look_beyond(const struct finder *f, bool *good) {
    const struct sites *s = f->sites;
    int *beyond;
    long n = 0;
    TRY(comm_agree(s->cells.comm, allocate(&beyond, f->nwalls, sizeof *beyond, "faces on patches")));
    for (long i = 0; i < f->nwalls; i++) {
        const double *w = f->wall + WALL * i;
        const int side = (int)w[4], k = side / 2;
        int at[3];
        sites_at(s, (long)w[3], at);
        at[k] += side % 2 ? 1 : -1;
        if (at[k] >= 0 && at[k] < s->n[k]) beyond[n++] = (int)sites_place(s, at);
    }
    const status e = sites_name(s, n, beyond);
    for (long i = 0; i < n && !e; i++) *good = *good && beyond[i] < 0;
    free(beyond);
    lists_agree(s->cells.comm, good);
    return e;
}

/* ---- cyclic patches ---------------------------------------------------------------------------------------------- */

/* Do both halves fill opposite ends of the grid, face i at (0, j, k) beside face i at (n - 1, j, k), first point beside
 * first point? */
static bool check_halves(struct sites *s, const struct patch *p, const struct site_face *a, const struct site_face *b) {
    for (int i = 0; i < p->nfaces; i++) {
        const int side = a[i].side, k = side / 2, end = s->n[k] - 1;
        int here[3], there[3];
        sites_at(s, a[i].place, here);
        sites_at(s, b[i].place, there);
        bool good = b[i].side == (side ^ 1) && k == a[0].side / 2 && a[i].turn == b[i].turn;
        for (int j = 0; j < 3; j++)
            good =
                good && (j != k ? here[j] == there[j] : here[j] == (side & 1 ? end : 0) && there[j] == end - here[j]);
        if (!good) return false;
        s->periodic[k] = true;
    }
    return true;
}

/* Is no other patch at the ends of a cyclic axis? */
static bool check_ends(const struct sites *s, const struct patch *p, const struct site_face *face) {
    for (int i = 0; i < p->nfaces; i++) {
        const int side = face[i].side, k = side / 2;
        int at[3];
        sites_at(s, face[i].place, at);
        if (s->periodic[k] && at[k] == (side & 1 ? s->n[k] - 1 : 0)) return false;
    }
    return true;
}

/* The faces stand in the order of their patches. first: [npatches] where those of a patch begin */
static bool check_patches(struct sites *s, const struct polymesh *m, const int *first) {
    bool good = true;
    for (int i = 0; i < m->npatches && good; i++) {
        const struct patch *p = &m->patch[i];
        if (strcmp(p->type, "cyclic") != 0) continue;
        const int j = polymesh_find_patch(m, p->neighbour);
        good = m->patch[j].nfaces == p->nfaces && !strcmp(m->patch[j].type, "cyclic") &&
               check_halves(s, p, s->face + first[i], s->face + first[j]);
    }
    for (int i = 0; i < m->npatches && good; i++)
        if (strcmp(m->patch[i].type, "cyclic") != 0 && !is_empty(&m->patch[i]))
            good = check_ends(s, &m->patch[i], s->face + first[i]);
    return good;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

/* Makes the list of all faces on patches, which come in the order of their numbers. */
static status list_faces(struct sites *s, long n, const double *wall) {
    s->nfaces = (int)n;
    TRY(allocate(&s->face, n, sizeof *s->face, "faces on patches"));
    for (long i = 0; i < n; i++) {
        const double *w = wall + WALL * i;
        s->face[i] = (struct site_face){
            .patch = (int)w[0], .face = (int)w[1], .place = (int)w[3], .side = (short)w[4], .turn = (short)w[5]};
    }
    return OK;
}

status walls_take(struct finder *f, bool *good) {
    struct sites *s = f->sites;
    struct polymesh *m = f->mesh;
    double *all = NULL;
    int *first = NULL;
    long n = 0;
    *good = take_axes(f);
    if (!*good) return OK;
    TRY(look_beyond(f, good));
    if (!*good) return OK;
    TRY(outline_walls(s->cells.comm, m, f->wall, f->nwalls, &all, &n));
    status e = list_faces(s, n, all);
    free(all);
    if (!e) e = allocate(&first, m->npatches + 1L, sizeof *first, "patches");
    for (int p = 0; p < m->npatches && !e; p++)
        first[p + 1] = first[p] + (is_empty(&m->patch[p]) ? 0 : m->patch[p].nfaces);
    *good = !e && check_patches(s, m, first);
    if (!e) sites_sort(s);
    free(first);
    return comm_agree(s->cells.comm, e);
}
