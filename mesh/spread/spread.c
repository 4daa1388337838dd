/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a polyMesh in slices (spread.h): slices of its faces, which know cells by numbers, become slices of cells with
 * all their faces. */
#include "mesh/spread/spread.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/spread/spread_private.h"
#include "mesh/spread/wedge.h"

/* ---- faces on their way ------------------------------------------------------------------------------------------ */

/* Faces for each rank; they are counted first and then written. */
struct post {
    bool counts;
    int *count; /* [ranks] ints for each rank */
    long *next; /* [ranks] where the next one goes */
    int *out;
};

static void post_face(struct post *p, int rank, int face, int owner, int neighbour, int n, const int *corner,
                      const int *name) {
    if (p->counts) {
        p->count[rank] += RECORD + n;
        return;
    }
    int *to = p->out + p->next[rank];
    const int head[RECORD] = {face, owner, neighbour, n};
    memcpy(to, head, sizeof head);
    for (int i = 0; i < n; i++) to[RECORD + i] = name ? name[corner[i]] : corner[i];
    p->next[rank] += RECORD + n;
}

typedef void poster(struct post *p, void *context);

/* Sends what `put` posts, and receives what comes. */
static status deliver(const struct comm *c, poster *put, void *context, int **in, long *ints) {
    struct post p = {.counts = true};
    const int size = comm_size(c);
    int *arriving = NULL;
    *in = NULL;
    *ints = 0;
    status e = allocate(&p.count, size, sizeof *p.count, "faces for other ranks");
    if (!e) e = allocate(&p.next, size + 1L, sizeof *p.next, "faces for other ranks");
    if (!e) e = allocate(&arriving, size, sizeof *arriving, "faces for other ranks");
    if (!e) put(&p, context);
    for (int r = 0; !e && r < size; r++) p.next[r + 1] = p.next[r] + p.count[r];
    if (!e) e = allocate(&p.out, p.next[size], sizeof *p.out, "faces for other ranks");
    e = comm_agree(c, e);
    p.counts = false;
    if (!e) put(&p, context);
    if (!e) e = comm_deliver_int(c, p.out, p.count, in, arriving);
    for (int r = 0; !e && r < size; r++) *ints += arriving[r];
    free(p.count);
    free(p.next);
    free(p.out);
    free(arriving);
    return e;
}

/* ---- from slices of faces to slices of cells --------------------------------------------------------------------- */

struct dealing {
    const struct polymesh *all;
    const struct lists *lists;
    struct share cells;
    double *other; /* [faces of the slice] owner of the other half of a cyclic face; -1: the face is not cyclic */
};

/* Lists the faces of the slice that are on cyclic patches, by their places in the slice, and the numbers of their other
 * halves; counts them alone if face is NULL. */
static long list_halves(const struct dealing *d, int *face, int *half) {
    const struct share *f = &d->lists->faces;
    long n = 0;
    for (int i = 0; i < d->all->npatches; i++) {
        const struct patch *p = &d->all->patch[i];
        const int j = p->neighbour ? polymesh_find_patch(d->all, p->neighbour) : -1;
        const long from = p->start > f->first ? p->start : f->first,
                   end = (long)p->start + p->nfaces < f->end ? (long)p->start + p->nfaces : f->end;
        for (long k = from; j >= 0 && k < end; k++, n++) {
            if (!face) continue;
            face[n] = (int)(k - f->first);
            half[n] = (int)(k - p->start + d->all->patch[j].start);
        }
    }
    return n;
}

/* Finds the owners of the other halves of cyclic faces. */
static status find_others(struct dealing *d) {
    const struct share *f = &d->lists->faces;
    const long n = list_halves(d, NULL, NULL), mine = f->end - f->first;
    int *face = NULL, *half = NULL;
    double *owner = NULL, *found = NULL;
    status e = allocate(&d->other, mine, sizeof *d->other, "cyclic faces");
    if (!e) e = allocate(&face, n, sizeof *face, "cyclic faces");
    if (!e) e = allocate(&half, n, sizeof *half, "cyclic faces");
    if (!e) e = allocate(&found, n, sizeof *found, "cyclic faces");
    if (!e) e = allocate(&owner, mine, sizeof *owner, "cyclic faces");
    e = comm_agree(f->comm, e);
    if (!e) list_halves(d, face, half);
    for (long i = 0; !e && i < mine; i++) owner[i] = d->lists->owner[i];
    if (!e) e = share_fetch(f, 1, owner, n, half, found);
    for (long i = 0; !e && i < mine; i++) d->other[i] = -1;
    for (long i = 0; !e && i < n; i++) d->other[face[i]] = found[i];
    free(face);
    free(half);
    free(owner);
    free(found);
    return e;
}

/* Posts each face of the slice to the ranks that have a cell at it, or one at its other half. */
static void post_slice(struct post *p, void *context) {
    const struct dealing *d = context;
    const struct lists *s = d->lists;
    for (long i = 0; i < s->faces.end - s->faces.first; i++) {
        const int cell[3] = {s->owner[i], s->neighbour[i], (int)d->other[i]};
        int rank[3], n = 0;
        for (int k = 0; k < 3; k++) {
            const int to = cell[k] < 0 ? -1 : share_rank(&d->cells, cell[k]);
            bool sent = to < 0;
            for (int j = 0; j < n; j++) sent |= rank[j] == to;
            if (sent) continue;
            rank[n++] = to;
            post_face(p, to, (int)(s->faces.first + i), cell[0], cell[1], s->start[i + 1] - s->start[i],
                      s->corner + s->start[i], NULL);
        }
    }
}

/* Marks the cells of the slice, which must all have come. */
static void mark_home(struct spread *s, bool *sound) {
    const long n = s->cells.end - s->cells.first;
    const struct mesh_part *h = &s->home;
    while (s->base < h->mesh.ncells && h->cell[s->base] < s->cells.first) s->base++;
    *sound = s->base + n <= h->mesh.ncells && (n == 0 || h->cell[s->base + n - 1] == s->cells.end - 1);
    for (long i = 0; *sound && i < n; i++) h->whole[s->base + i] = true;
}

static status deal(struct spread *s, const struct polymesh *all, const struct lists *lists, bool *sound) {
    struct dealing d = {.all = all, .lists = lists, .cells = s->cells};
    int *records = NULL;
    long ints = 0;
    status e = find_others(&d);
    if (!e) e = deliver(s->comm, post_slice, &d, &records, &ints);
    free(d.other);
    if (!e) e = comm_agree(s->comm, part_of_faces(all, ints, records, &s->home));
    free(records);
    TRY(e);
    mark_home(s, sound);
    return part_places(&s->home, &s->points, s->point);
}

/* ---- parts ------------------------------------------------------------------------------------------------------- */

struct asking { /* what the ranks ask this one for */
    const struct spread *spread;
    struct delivery cells; /* that they ask for */
    int *sent; /* [faces of home] the rank that a face was posted to last, and one, with the sign of the pass */
};

/* Returns the other half of a face of home on a cyclic patch, or -1. */
static int half_of(const struct polymesh *m, int face) {
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        if (!p->neighbour || face < p->start || face >= p->start + p->nfaces) continue;
        return face - p->start + m->patch[polymesh_find_patch(m, p->neighbour)].start;
    }
    return -1;
}

static void post_home(struct asking *a, struct post *p, int rank, int face) {
    const struct mesh_part *h = &a->spread->home;
    const struct polymesh *m = &h->mesh;
    const int mark = p->counts ? rank + 1 : -(rank + 1);
    if (face < 0 || a->sent[face] == mark) return;
    a->sent[face] = mark;
    post_face(p, rank, h->face[face], h->cell[m->owner[face]], face < m->ninternal ? h->cell[m->neighbour[face]] : -1,
              m->face_start[face + 1] - m->face_start[face], m->face_points + m->face_start[face], h->point);
}

static void post_cells(struct post *p, void *context) {
    struct asking *a = context;
    const struct spread *s = a->spread;
    const int *next = a->cells.in;
    for (int r = 0; r < comm_size(s->comm); r++)
        for (int i = 0; i < a->cells.arriving[r]; i++) {
            const long cell = *next++ - s->cells.first + s->base;
            for (int k = s->cell_start[cell]; k < s->cell_start[cell + 1]; k++) {
                const int face = s->cell_face[k];
                post_home(a, p, r, face);
                if (face >= s->home.mesh.ninternal) post_home(a, p, r, half_of(&s->home.mesh, face));
            }
        }
}

status spread_part(const struct spread *s, const struct polymesh *all, long n, const int *cell, struct mesh_part *out) {
    struct asking a = {.spread = s};
    int *records = NULL;
    long ints = 0;
    *out = (struct mesh_part){.mesh.nfaces = 0};
    status e = share_deliver(&s->cells, n, 1, cell, "the cells of a part", &a.cells);
    if (!e) e = comm_agree(s->comm, allocate(&a.sent, s->home.mesh.nfaces, sizeof *a.sent, "the cells of a part"));
    if (!e) e = deliver(s->comm, post_cells, &a, &records, &ints);
    free(a.sent);
    delivery_free(&a.cells);
    if (!e) e = comm_agree(s->comm, part_of_faces(all, ints, records, out));
    free(records);
    TRY(e);
    for (long i = 0; i < n; i++) out->whole[part_cell(out, cell[i])] = true;
    return part_places(out, &s->points, s->point);
}

void spread_centre(const struct spread *s, long cell, double x[3]) {
    memcpy(x, s->geometry.cell_centre + 3 * (cell - s->cells.first + s->base), 3 * sizeof *x);
}

double spread_volume(const struct spread *s, long cell) {
    return s->geometry.volume[cell - s->cells.first + s->base];
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

/* Computes the geometry of home; centres of cells that are not whole there come from the ranks that have them. */
static status measure(struct spread *s) {
    const struct polymesh *m = &s->home.mesh;
    status e = polymesh_cell_faces(m, &s->cell_start, &s->cell_face);
    if (!e) e = polymesh_geometry_make(m, &s->geometry);
    TRY(comm_agree(s->comm, e));
    double *all = NULL;
    e = comm_agree(s->comm, allocate(&all, 3L * m->ncells, sizeof *all, "the centres of cells"));
    if (!e) e = share_fetch(&s->cells, 3, s->geometry.cell_centre + 3L * s->base, m->ncells, s->home.cell, all);
    if (e) {
        free(all);
        return e;
    }
    free(s->geometry.cell_centre);
    s->geometry.cell_centre = all;
    return OK;
}

static status begin_mesh(const char *dir, const struct lists *s, struct polymesh **out) {
    TRY(allocate(out, 1, sizeof **out, "a mesh"));
    struct polymesh *m = *out;
    m->npoints = (int)s->points.n;
    m->nfaces = (int)s->faces.n;
    m->ninternal = (int)s->ninternal;
    m->ncells = (int)s->ncells;
    TRY(allocate(&m->outline, 1, sizeof *m->outline, "a mesh"));
    TRY(allocate(&m->outline->dir, (long)strlen(dir) + 1, 1, "a mesh"));
    strcpy(m->outline->dir, dir);
    return polymesh_read_patches(dir, m);
}

static status take(struct spread *s, struct lists *lists, struct polymesh *m, bool *sound) {
    s->points = lists->points;
    s->cells = share_make(s->comm, lists->ncells);
    s->point = lists->point;
    lists->point = NULL;
    TRY(deal(s, m, lists, sound));
    lists_agree(s->comm, sound);
    if (!*sound) return OK;
    lists_free(lists);
    TRY(measure(s));
    return outline_make(s, m, sound);
}

/* Makes a mesh of its slices: a lattice with its sites where one is looked for, else one that is spread. */
static status make(const char *dir, struct lists *lists, bool lattice, struct spread **out, struct polymesh **mesh,
                   bool *sound) {
    const struct comm *c = lists->faces.comm;
    bool found = false;
    TRY(comm_agree(c, begin_mesh(dir, lists, mesh)));
    *sound = !wedge_has(*mesh); /* each rank flattens the whole of it */
    if (!*sound) return OK;
    TRY(outline_sum(lists, &(*mesh)->outline->sum));
    outline_box(lists, (*mesh)->outline);
    if (lattice) TRY(sites_find(lists, *mesh, &found));
    if (found) return OK;
    *sound = !lattice || comm_size(c) > 1;
    if (!*sound) return OK;
    TRY(comm_agree(c, allocate(out, 1, sizeof **out, "a mesh")));
    (*out)->comm = c;
    return take(*out, lists, *mesh, sound);
}

/* Gives the mesh its arrays: one rank's slices are all of them. */
static void hand_over(struct lists *s, struct polymesh *m) {
    m->points = s->point;
    m->face_start = s->start;
    m->face_points = s->corner;
    m->owner = s->owner;
    m->neighbour = s->neighbour;
    *s = (struct lists){.ncells = 0};
}

status spread_read(const char *dir, const struct comm *c, bool lattice, bool arrays, struct spread **out,
                   struct polymesh **mesh) {
    struct lists lists;
    bool sound;
    *out = NULL;
    *mesh = NULL;
    status e = lists_read(dir, c, &lists, &sound);
    if (!e && sound) e = make(dir, &lists, lattice, out, mesh, &sound);
    if (!e && arrays && *mesh && (*mesh)->outline->sites && comm_size(c) == 1) hand_over(&lists, *mesh);
    lists_free(&lists);
    if (!e && sound) return OK;
    spread_free(*out);
    polymesh_free(*mesh);
    *out = NULL;
    *mesh = NULL;
    return e;
}

void spread_trim(struct spread *s) {
    double *volume = s->geometry.volume;
    s->geometry.volume = NULL;
    free(s->point);
    part_free(&s->home);
    polymesh_geometry_free(&s->geometry);
    free(s->cell_start);
    free(s->cell_face);
    s->point = NULL;
    s->cell_start = s->cell_face = NULL;
    s->geometry.volume = volume;
}

void spread_free(struct spread *s) {
    if (!s) return;
    spread_trim(s);
    free(s->geometry.volume);
    free(s);
}
