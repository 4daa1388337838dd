/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the forest of a lattice (forest.h): the memory layout of a tile, this rank's tiles with the faces
 * on their patches, and its blocks with their cells. */
#include "mesh/lattice/forest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/lattice/forest_private.h"

static long round_up(long n, long to) {
    return (n + to - 1) / to * to;
}

/* Lays out the block of one variable of a tile, which has room for the longest tile along each axis. A row's high
 * ghosts and the next row's low ghosts share the padding, so the cells of every row start on a multiple of 8. */
static void lay_out(struct forest *f, const struct lattice *l) {
    int most[3] = {1, 1, 1}, ghosts[3] = {0};
    for (int k = 0; k < 3; k++) {
        ghosts[k] = k < f->dim ? GHOSTS : 0;
        for (int t = 0; t < f->ntiles_all; t++)
            if (f->hidden->all[t].n[k] > most[k]) most[k] = f->hidden->all[t].n[k];
    }
    f->stride[0] = 1;
    f->stride[1] = round_up(most[0] + 2 * ghosts[0], 8);
    f->stride[2] = f->stride[1] * (most[1] + 2 * ghosts[1]);
    f->first = 8 + ghosts[1] * f->stride[1] + ghosts[2] * f->stride[2];
    f->size = 8 + f->stride[2] * (most[2] + 2 * ghosts[2]);
    for (int k = 0; k < 3; k++) {
        const long side = round_up(most[(k + 1) % 3] * most[(k + 2) % 3], 8);
        f->step[k] = l->uniform[k] ? 0 : f->stride[k];
        if (k < f->dim && side > f->sheet) f->sheet = side;
    }
}

/* Lists the cells at the places of a box of the lattice (lattice_row); returns the end of the list. */
static int *list_cells(const struct lattice *l, const int low[3], const int n[3], int *next) {
    for (int i[3] = {low[0], low[1], low[2]}; i[2] < low[2] + n[2]; i[2]++)
        for (i[1] = low[1]; i[1] < low[1] + n[1]; i[1]++, next += n[0]) lattice_row(l, i, n[0], next);
    return next;
}

/* Lists the faces along one side of a tile, numbered within their patch; returns the end of the list. */
static int *list_faces(const struct lattice *l, const struct polymesh *m, const struct tile *t, int side, int *next) {
    int low[3], n[3];
    for (int a = 0; a < 3; a++) {
        low[a] = t->low[a] + (a == side / 2 && side % 2 ? t->n[a] - 1 : 0);
        n[a] = a == side / 2 ? 1 : t->n[a];
    }
    long face;
    for (int i[3] = {low[0], low[1], low[2]}; i[2] < low[2] + n[2]; i[2]++)
        for (i[1] = low[1]; i[1] < low[1] + n[1]; i[1]++)
            for (i[0] = low[0]; i[0] < low[0] + n[0]; i[0]++) {
                lattice_patch(l, m, i, side, &face);
                *next++ = (int)face;
            }
    return next;
}

static void describe_sides(struct tile *t, const struct trees_tile *all, const struct trees *trees,
                           const struct lattice *l, const struct polymesh *m, int **face) {
    long first;
    for (int side = 0; side < 6; side++) {
        int neighbour = side < 2 * l->dim ? all->neighbour[side] - trees->first : -1;
        t->side[side].neighbour = neighbour >= 0 && neighbour < trees->count ? neighbour : -1;
        t->side[side].patch = -1;
        if (side >= 2 * l->dim || all->neighbour[side] >= 0) continue;
        int a = side / 2, corner[3] = {t->low[0], t->low[1], t->low[2]};
        if (side % 2) corner[a] += t->n[a] - 1;
        t->side[side].patch = lattice_patch(l, m, corner, side, &first);
        t->side[side].face = *face;
        *face = list_faces(l, m, t, side, *face);
    }
}

/* Counts the faces of patches on the sides of a tile. */
static long patch_faces(const struct trees_tile *t, int dim) {
    long faces = 0;
    for (int side = 0; side < 2 * dim; side++)
        if (t->neighbour[side] < 0) faces += (long)t->n[0] * t->n[1] * t->n[2] / t->n[side / 2];
    return faces;
}

static status make_tiles(struct forest *f, const struct lattice *l, const struct polymesh *m) {
    struct forest_private *h = f->hidden;
    const struct trees_tile *all = h->all + h->trees->first;
    long nfaces = 0;
    f->ntiles = h->trees->count;
    for (int t = 0; t < f->ntiles; t++) nfaces += patch_faces(&all[t], l->dim);
    TRY(pool_take(&h->pool, &f->tile, f->ntiles, sizeof *f->tile, "the tiles"));
    TRY(pool_take(&h->pool, &h->face, nfaces, sizeof *h->face, "the faces of the tiles"));
    int *face = h->face;
    for (int t = 0; t < f->ntiles; t++) {
        struct tile *tile = &f->tile[t];
        tile->id = h->trees->first + t;
        memcpy(tile->low, all[t].low, sizeof tile->low);
        memcpy(tile->n, all[t].n, sizeof tile->n);
        describe_sides(tile, &all[t], h->trees, l, m, &face);
    }
    return OK;
}

static status make_blocks(struct forest *f, const struct lattice *l) {
    struct forest_private *h = f->hidden;
    const struct cut_block *mine = h->block;
    while (mine < h->block + h->nblocks && mine->tile < h->trees->first) mine++;
    for (int b = 0; mine + b < h->block + h->nblocks && mine[b].tile < h->trees->first + h->trees->count; b++) {
        h->ncells += (long)mine[b].n[0] * mine[b].n[1] * mine[b].n[2];
        f->nblocks++;
    }
    TRY(pool_take(&h->pool, &f->block, f->nblocks, sizeof *f->block, "the blocks"));
    TRY(pool_take(&h->pool, &h->cell, h->ncells, sizeof *h->cell, "the cells of the blocks"));
    int *cell = h->cell;
    for (int b = 0; b < f->nblocks; b++) {
        f->block[b] = (struct forest_block){.id = mine[b].id, .tile = mine[b].tile - h->trees->first, .cell = cell};
        memcpy(f->block[b].low, mine[b].low, sizeof mine->low);
        memcpy(f->block[b].n, mine[b].n, sizeof mine->n);
        cell = list_cells(l, mine[b].low, mine[b].n, cell);
    }
    return OK;
}

/* Takes the radii of a body of revolution. A lattice lies within its tolerance of the grid, and so does the axis. */
static void describe_round(struct forest *f, const struct revolution *r) {
    f->radial = -1;
    for (int k = 0; k < f->dim && r->on; k++)
        if (f->axis[k] == r->radial) f->radial = k;
    if (f->radial < 0) return;
    f->inner = f->origin[f->radial] - r->at;
    if (fabs(f->inner) < 1e-6 * f->width[f->radial]) f->inner = 0;
    f->volume *= 6.283185307179586477 / r->depth;
}

static void describe_lattice(struct forest *f, const struct lattice *l, const struct polymesh *m) {
    f->dim = l->dim;
    f->volume = 1;
    f->images = 1;
    for (int k = 0; k < 3; k++) {
        f->axis[k] = l->axis[k];
        f->width[k] = l->width[k];
        f->origin[k] = l->origin[k];
        f->volume *= l->width[k];
        if (l->uniform[k]) f->images *= l->n[k];
    }
    describe_round(f, &m->round);
    f->ncells_all = m->ncells;
}

static status build(struct forest *f, const struct lattice *l, const struct polymesh *m, int tile_size) {
    struct forest_private *h = f->hidden;
    TRY(comm_agree(f->comm, cut_make(h, l, m, tile_size)));
    f->ntiles_all = h->nall;
    f->nblocks_all = h->nblocks;
    lay_out(f, l);
    TRY(trees_make(f->comm, l->dim, h->all, h->nall, &h->trees));
    status s = make_tiles(f, l, m);
    if (!s) s = make_blocks(f, l);
    if (!s) s = fill_make(f);
    TRY(comm_agree(f->comm, s));
    return lattice_name(l, h->ncells, h->cell);
}

status forest_make(const struct lattice *l, const struct polymesh *m, const struct comm *c, int tile_size,
                   struct forest **out) {
    struct forest *f = NULL;
    *out = NULL;
    status s = allocate(&f, 1, sizeof *f, "the forest");
    if (!s) s = allocate(&f->hidden, 1, sizeof *f->hidden, "the forest");
    s = comm_agree(c, s);
    if (!s) {
        f->comm = c;
        describe_lattice(f, l, m);
        s = build(f, l, m, tile_size);
    }
    if (s) {
        forest_free(f);
        return status_up(s, __FILE__, __LINE__);
    }
    *out = f;
    return OK;
}

void forest_free(struct forest *f) {
    if (!f) return;
    struct forest_private *h = f->hidden;
    if (h) {
        comm_exchange_free(h->exchange);
        trees_free(h->trees);
        pool_free(&h->pool);
        free(h);
    }
    free(f);
}
