/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the sites of a lattice (sites.h) in the slices of its polyMesh. A face lies on the grid by its corners, and so
 * says where the cells on both sides of it are. The rank that has a cell in its slice gets what the six faces say, in
 * rounds of so many faces a rank that messages stay small. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/base/sorted.h"
#include "mesh/spread/sites_private.h"

enum { ROUND = 1 << 16, HOLES = 64, ALL_SIDES = 63, CLAIM = 3, FIRST = 5, HEXAHEDRA = 3 };
/* HOLES: most places of the grid per cell (lattice.c). CLAIM: numbers of a claim: cell, place, side. FIRST: numbers of
 * a face of cell 0: its own, four corners. HEXAHEDRA: place in the outline's counts of shapes. */

/* The farthest that a point may lie beside the grid, in parts of the least width of a cell. Cells are then closed,
 * their faces level, and halves of cyclic patches alike, within what polymesh_check and lattice_recognise allow. */
static const double NEAR = 1e-7;
static const double NARROW = 1e-60; /* m: of narrower cells volumes might be no numbers */

/* ---- the grid ---------------------------------------------------------------------------------------------------- */

/* Gives all ranks the faces of cell 0, which owns them. Returns by *n how many there are. */
static status share_first(const struct finder *f, int out[6 * FIRST], long *n) {
    const struct lists *s = f->lists;
    const struct comm *c = s->faces.comm;
    int mine[6 * FIRST], k = 0, *count;
    for (long i = 0; i < s->faces.end - s->faces.first; i++) {
        if (s->owner[i] != 0) continue;
        if (k < 6) mine[FIRST * k] = (int)(s->faces.first + i);
        if (k < 6) memcpy(mine + FIRST * k + 1, s->corner + s->start[i], 4 * sizeof *mine);
        k++;
    }
    *n = k;
    comm_sum_long(c, n, 1);
    if (*n != 6) return OK;
    TRY(comm_agree(c, allocate(&count, 2L * comm_size(c) + 1, sizeof *count, "the first cell")));
    const status e = comm_share_count(c, (long)FIRST * k, count, count + comm_size(c));
    if (!e) comm_share_int(c, mine, count, count + comm_size(c), out);
    free(count);
    return e;
}

/* Computes the centre of cell 0 as polymesh_cell_geometry does, and how long it is. */
static status measure_first(const struct finder *f, double size[3], bool *good) {
    int face[6 * FIRST], name[24], start[7], corner[24], owner[6] = {0};
    double x[24 * 3];
    long n;
    TRY(share_first(f, face, &n));
    *good = n == 6;
    if (!*good) return OK;
    for (int i = 0; i < 24; i++) name[i] = face[FIRST * (i / 4) + 1 + i % 4];
    for (int i = 0; i < 24; i++) corner[i] = i;
    for (int i = 0; i < 7; i++) start[i] = 4 * i;
    TRY(share_fetch(&f->lists->points, 3, f->lists->point, 24, name, x));
    const struct polymesh first = {.npoints = 24,
                                   .nfaces = 6,
                                   .ncells = 1,
                                   .points = x,
                                   .face_start = start,
                                   .face_points = corner,
                                   .owner = owner};
    struct polymesh_geometry g;
    const status e = polymesh_geometry_make(&first, &g);
    if (!e) memcpy(f->sites->middle, g.cell_centre, sizeof f->sites->middle);
    polymesh_geometry_free(&g);
    for (int k = 0; k < 3; k++) {
        double low = x[k], high = x[k];
        for (int i = 1; i < 24; i++) {
            low = fmin(low, x[3 * i + k]);
            high = fmax(high, x[3 * i + k]);
        }
        size[k] = high - low;
    }
    return comm_agree(f->lists->faces.comm, e);
}

/* Finds the grid that cell 0 and the box around all points say (find_grid of lattice.c). */
static status find_grid(struct finder *f, bool *good) {
    struct sites *s = f->sites;
    const struct outline *o = f->mesh->outline;
    double size[3], places = 1, least = HUGE_VAL;
    TRY(measure_first(f, size, good));
    for (int k = 0; k < 3 && *good; k++) {
        const double extent = o->high[k] - o->low[k], cells = extent / size[k];
        *good = size[k] > 0 && cells < INT_MAX / 2;
        if (!*good) continue;
        s->low[k] = o->low[k];
        s->extent[k] = extent;
        s->n[k] = (int)(cells + 0.5) > 1 ? (int)(cells + 0.5) : 1;
        s->width[k] = extent / s->n[k];
        places *= s->n[k];
        least = fmin(least, s->width[k]);
    }
    *good = *good && least >= NARROW && places <= INT_MAX && places <= HOLES * (double)s->cells.n + 1e6;
    if (!*good) return OK;
    for (int k = 0; k < 3; k++) f->near[k] = NEAR * least / s->width[k];
    s->places = share_make(s->cells.comm, (long)places);
    return OK;
}

/* ---- faces ------------------------------------------------------------------------------------------------------- */

/* Puts the points of a round on the grid. */
static void place_points(const struct finder *f, long n) {
    const struct sites *s = f->sites;
    for (long i = 0; i < n; i++) {
        bool on = true;
        for (int k = 0; k < 3; k++) {
            const double x = (f->x[3 * i + k] - s->low[k]) / s->width[k];
            const int at = x < INT_MAX / 2 ? (int)(x + 0.5) : 0; /* x >= 0 */
            on &= fabs(x - at) <= f->near[k];
            f->node[3 * i + k] = at;
        }
        if (!on) f->node[3 * i] = -1;
    }
}

/* Puts a face of four corners on the grid: it must be a side of a place, its corners one after the other. */
static bool place_face(const struct finder *f, const int *corner, struct placed *out) {
    int at[4][3], same[3] = {0, 0, 0}, turn = 0;
    for (int i = 0; i < 4; i++) {
        memcpy(at[i], f->node + 3L * corner[i], sizeof at[i]);
        if (at[i][0] < 0) return false;
        for (int k = 0; k < 3; k++) same[k] += at[i][k] == at[0][k];
    }
    const int k = same[2] == 4 ? 2 : same[1] == 4 ? 1 : 0, a = (k + 1) % 3, b = (k + 2) % 3;
    for (int i = 0; i < 4; i++) {
        const int *p = at[i], *q = at[(i + 1) % 4], *r = at[(i + 2) % 4];
        const int u[2] = {q[a] - p[a], q[b] - p[b]}, v[2] = {r[a] - q[a], r[b] - q[b]};
        if (abs(u[0]) + abs(u[1]) != 1 || u[0] * v[0] + u[1] * v[1] != 0) return false;
        turn += u[0] * v[1] - u[1] * v[0];
    }
    if (same[k] != 4 || abs(turn) != 4) return false;
    out->axis = k;
    out->up = turn > 0;
    for (int j = 0; j < 3; j++) out->at[j] = at[0][j] < at[2][j] ? at[0][j] : at[2][j];
    out->turn = (at[0][a] > out->at[a]) + 2 * (at[0][b] > out->at[b]);
    return true;
}

/* Notes what a face says of the cell below its plane or above it. */
static bool claim(struct finder *f, const struct placed *p, bool above, int cell) {
    int at[3] = {p->at[0], p->at[1], p->at[2]};
    at[p->axis] -= !above;
    if (at[p->axis] < 0 || at[p->axis] >= f->sites->n[p->axis]) return false;
    int *to = f->claim + CLAIM * f->nclaims++;
    to[0] = cell;
    to[1] = (int)sites_place(f->sites, at);
    to[2] = 2 * p->axis + !above;
    return true;
}

static bool take_face(struct finder *f, long i, const int *corner, status *e) {
    const struct lists *s = f->lists;
    struct placed p;
    if (!place_face(f, corner, &p) || !claim(f, &p, !p.up, s->owner[i])) return false;
    if (s->neighbour[i] >= 0) return claim(f, &p, p.up, s->neighbour[i]);
    *e = wall_add(f, s->faces.first + i, corner, f->claim + CLAIM * (f->nclaims - 1), p.turn);
    return !*e;
}

/* Makes the corners of the faces of a round numbers of points that are here. */
static status fetch_points(struct finder *f, long from, long n) {
    const struct lists *s = f->lists;
    const int *corner = s->corner + s->start[from];
    long names = 4 * n;
    memcpy(f->corner, corner, (size_t)names * sizeof *corner);
    if (comm_size(s->faces.comm) == 1) return OK; /* they are */
    memcpy(f->name, corner, (size_t)names * sizeof *corner);
    status e = sorted_make(f->name, &names);
    if (!e) e = sorted_places(f->name, names, f->corner, 4 * n);
    TRY(comm_agree(s->faces.comm, e));
    TRY(share_fetch(&s->points, 3, s->point, names, f->name, f->fetched));
    place_points(f, names);
    return OK;
}

/* ---- cells ------------------------------------------------------------------------------------------------------- */

/* Has each claim its own side, and do those of a cell name one place? */
static bool take_claims(struct finder *f, long n, const int *claim) {
    const struct sites *s = f->sites;
    for (long i = 0; i < n; i++) {
        const int *c = claim + CLAIM * i, bit = 1 << c[2];
        if (c[0] >= s->cells.n) return false;
        int *place = &s->place[c[0] - s->cells.first];
        char *sides = &f->sides[c[0] - s->cells.first];
        if (*sides & bit || (*sides && *place != c[1])) return false;
        *place = c[1];
        *sides = (char)(*sides | bit);
    }
    return true;
}

/* Sends the claims of a round to the ranks whose slices have the cells. */
static status send_claims(struct finder *f, bool *good) {
    const struct share *cells = &f->sites->cells;
    struct delivery sent;
    if (comm_size(cells->comm) == 1) {
        *good = *good && take_claims(f, f->nclaims, f->claim);
        return OK;
    }
    const status e = share_deliver(cells, f->nclaims, CLAIM, f->claim, "the cells of a lattice", &sent);
    *good = !e && take_claims(f, sent.arrived, sent.in) && *good;
    delivery_free(&sent);
    return e;
}

static status take_round(struct finder *f, long from, long n, bool *good) {
    status e = OK;
    TRY(fetch_points(f, from, n));
    f->nclaims = 0;
    for (long i = 0; i < n && *good; i++) *good = take_face(f, from + i, f->corner + 4 * i, &e);
    TRY(comm_agree(f->lists->faces.comm, e));
    TRY(send_claims(f, good));
    lists_agree(f->lists->faces.comm, good);
    return OK;
}

static status make_room(struct finder *f) {
    struct sites *s = f->sites;
    const bool one = comm_size(s->cells.comm) == 1;
    const long most = share_at_rank(&f->lists->faces, 0).end, faces = most < ROUND ? most : ROUND;
    const long points = f->lists->points.end - f->lists->points.first;
    TRY(allocate(&s->place, s->cells.end - s->cells.first, sizeof *s->place, "the cells of a lattice"));
    TRY(allocate(&f->sides, s->cells.end - s->cells.first, 1, "the cells of a lattice"));
    TRY(allocate(&f->corner, 4 * faces, sizeof *f->corner, "the faces of a lattice"));
    TRY(allocate(&f->claim, 2 * CLAIM * faces, sizeof *f->claim, "the faces of a lattice"));
    if (!one) TRY(allocate(&f->name, 4 * faces, sizeof *f->name, "the faces of a lattice"));
    if (!one) TRY(allocate(&f->fetched, 3 * 4 * faces, sizeof *f->fetched, "the faces of a lattice"));
    TRY(allocate(&f->node, 3 * (one ? points : 4 * faces), sizeof *f->node, "the points of a lattice"));
    f->x = one ? f->lists->point : f->fetched;
    if (one) place_points(f, points);
    return OK;
}

/* Do cells reach all ends of the grid? Points that no face has may lie beyond them. */
static bool reach_ends(const struct sites *s) {
    double ends[6] = {0};
    bool all = true;
    for (long i = 0; i < s->cells.end - s->cells.first; i++) {
        int at[3];
        sites_at(s, s->place[i], at);
        for (int k = 0; k < 3; k++) {
            if (at[k] == 0) ends[k] = 1;
            if (at[k] == s->n[k] - 1) ends[3 + k] = 1;
        }
    }
    comm_max(s->cells.comm, ends, 6);
    for (int i = 0; i < 6; i++) all = all && ends[i] > 0;
    return all;
}

/* Finds the places of all cells, each of which must have one face on each of its sides. */
static status find_places(struct finder *f, bool *good) {
    const struct share *faces = &f->lists->faces, most = share_at_rank(faces, 0);
    const long mine = faces->end - faces->first;
    TRY(comm_agree(faces->comm, make_room(f)));
    for (long from = 0; from < most.end && *good; from += ROUND) {
        const long left = mine - from, n = left < 0 ? 0 : left < ROUND ? left : ROUND;
        TRY(take_round(f, n ? from : 0, n, good));
    }
    for (long i = 0; i < f->sites->cells.end - f->sites->cells.first; i++) *good = *good && f->sides[i] == ALL_SIDES;
    lists_agree(faces->comm, good);
    *good = *good && reach_ends(f->sites);
    return OK;
}

/* Puts the cells in their places, which must be one for each. */
static status fill_places(struct finder *f, bool *good) {
    struct sites *s = f->sites;
    const long n = s->cells.end - s->cells.first, places = s->places.end - s->places.first;
    double *name = NULL;
    status e = allocate(&s->cell, places, sizeof *s->cell, "the cells of a lattice");
    if (!e) e = allocate(&name, n, sizeof *name, "the cells of a lattice");
    e = comm_agree(s->cells.comm, e);
    long filled = 0;
    for (long i = 0; i < places && !e; i++) s->cell[i] = -1;
    for (long i = 0; i < n && !e; i++) name[i] = (double)(s->cells.first + i);
    if (!e) e = share_store(&s->places, 1, n, s->place, name, s->cell);
    for (long i = 0; i < places && !e; i++) filled += s->cell[i] >= 0;
    free(name);
    TRY(e);
    comm_sum_long(s->cells.comm, &filled, 1);
    *good = filled == s->cells.n;
    return OK;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static bool has_quads(const struct lists *s) {
    bool quads = true;
    for (long i = 0; i < s->faces.end - s->faces.first; i++) quads = quads && s->start[i + 1] - s->start[i] == 4;
    return quads;
}

static status find(struct finder *f, bool *good) {
    const struct comm *c = f->lists->faces.comm;
    TRY(comm_agree(c, allocate(&f->sites, 1, sizeof *f->sites, "a lattice")));
    f->sites->cells = share_make(c, f->lists->ncells);
    *good = has_quads(f->lists);
    lists_agree(c, good);
    if (*good) TRY(find_grid(f, good));
    if (*good) TRY(find_places(f, good));
    if (*good) TRY(fill_places(f, good));
    return *good ? walls_take(f, good) : OK;
}

status sites_find(const struct lists *s, struct polymesh *m, bool *found) {
    struct finder f = {.lists = s, .mesh = m};
    *found = false;
    outline_box(s, m->outline);
    const status e = find(&f, found);
    void *const all[] = {f.sides, f.corner, f.claim, f.name, f.fetched, f.node, f.wall};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *found = *found && !e;
    if (*found) {
        m->outline->sites = f.sites;
        m->outline->shape[HEXAHEDRA] = m->ncells;
        memcpy(m->outline->closed, f.sites->closed, sizeof f.sites->closed);
    } else {
        sites_free(f.sites);
    }
    return e;
}
