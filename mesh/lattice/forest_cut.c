/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts a lattice into the tiles of the forest (forest.h): finds the planes where the boundary or its patch changes,
 * cuts every axis into pieces between them, and numbers the solid boxes of the pieces' tensor product, the blocks,
 * along a Morton curve. A block is a tile, too, unless it lies behind another along a uniform axis. */
#include "mesh/lattice/forest_private.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Of a lattice with holes and at most MANY tiles two ranks have at most FAIR of WORTHY cells or more each, if pieces of
 * the last axis that are some ten cells long allow it. */
enum { MANY = 16, WORTHY = 2048 };
static const double FAIR = 0.6;

struct cutter {
    const struct lattice *l;
    const struct polymesh *m;
    bool *plane[3]; /* [n + 1] must tiles end at this plane? */
};

static long at(const int n[3], const int i[3]) {
    return i[0] + n[0] * (i[1] + (long)n[1] * i[2]);
}

static bool is_cyclic(const struct cutter *c, int patch) {
    return !strcmp(c->m->patch[patch].type, "cyclic");
}

/* Returns the patch at a side of the solid cell i, or -1 where another cell follows. */
static int side_patch(const struct cutter *c, const int i[3], int side) {
    long face;
    const int patch = lattice_patch(c->l, c->m, i, side, &face);
    return patch >= 0 && is_cyclic(c, patch) ? -1 : patch;
}

static double position(const struct lattice *l, int k, int plane) {
    return l->origin[k] + l->width[k] * plane;
}

static char axis_name(const struct lattice *l, int k) {
    return "xyz"[l->axis[k]];
}

/* Checks that a cyclic face leads across the whole lattice to a cell on its other edge. */
static status check_cyclic(const struct cutter *c, const int i[3], int side) {
    const struct lattice *l = c->l;
    long face;
    const int patch = lattice_patch(l, c->m, i, side, &face), k = side / 2;
    if (patch < 0 || !is_cyclic(c, patch)) return OK;
    int image[3] = {i[0], i[1], i[2]}, edge = side % 2 ? l->n[k] - 1 : 0;
    image[k] = l->n[k] - 1 - edge;
    if (i[k] == edge && l->periodic[k] && lattice_cell(l, image) >= 0) return OK;
    return fail(ERR_INPUT,
                "constant/polyMesh: face %ld of patch '%s' at %c = %g is cyclic, but there is no cell at the opposite "
                "edge of the mesh; cyclic patches must join two opposite edges of the whole mesh; make this one a wall",
                face, c->m->patch[patch].name, axis_name(l, k), position(l, k, i[k] + side % 2));
}

/* Marks the planes at which cell i makes tiles end: a side of the cell with a patch, and the plane to a next cell that
 * has another patch, or none, on the same side. */
static status mark_planes(struct cutter *c, const int i[3]) {
    for (int side = 0; side < 2 * c->l->dim; side++) {
        TRY(check_cyclic(c, i, side));
        int patch = side_patch(c, i, side);
        if (patch >= 0) c->plane[side / 2][i[side / 2] + side % 2] = true;
        for (int k = 0; k < c->l->dim; k++) {
            int next[3] = {i[0], i[1], i[2]};
            if (k == side / 2 || ++next[k] == c->l->n[k] || lattice_cell(c->l, next) < 0) continue;
            if (side_patch(c, next, side) != patch) c->plane[k][next[k]] = true;
        }
    }
    return OK;
}

/* Does the same for the cells of a block of a mesh of boxes, whose sides are each wholly of one patch. */
static void mark_box(struct cutter *c, const struct brick *b) {
    const struct boxes *all = c->l->boxes;
    for (int k = 0; k < c->l->dim; k++) {
        const int x = c->l->axis[k], end = b->low[x] + b->n[x], next = b->side[2 * x + 1].next;
        for (int high = 0; high < 2; high++) {
            const int patch = b->side[2 * x + high].patch;
            if (patch >= 0 && !is_cyclic(c, patch)) c->plane[k][high ? end : b->low[x]] = true;
        }
        for (int other = 0; other < c->l->dim && next >= 0; other++)
            for (int high = 0; high < 2 && other != k; high++) {
                const int side = 2 * c->l->axis[other] + high, one = b->side[side].patch,
                          two = all->box[next].side[side].patch;
                const bool wall = one >= 0 && !is_cyclic(c, one), wall_there = two >= 0 && !is_cyclic(c, two);
                if (wall != wall_there || (wall && one != two)) c->plane[k][end] = true;
            }
    }
}

/* Does the same for a face on a patch of a mesh with sites, and for the cells before and behind its own. */
static void mark_face(struct cutter *c, const struct site_face *f) {
    const struct lattice *l = c->l;
    int place[3], i[3], side = 0;
    sites_at(l->sites, f->place, place);
    for (int k = 0; k < 3; k++) {
        i[k] = place[l->axis[k]];
        if (l->axis[k] == f->side / 2) side = 2 * k + f->side % 2;
    }
    const int patch = is_cyclic(c, f->patch) ? -1 : f->patch;
    if (patch >= 0) c->plane[side / 2][i[side / 2] + side % 2] = true;
    for (int way = 0; way < 2 * l->dim; way++) {
        const int k = way / 2, high = way % 2;
        int next[3] = {i[0], i[1], i[2]};
        long face;
        next[k] += high ? 1 : -1;
        if (k == side / 2 || next[k] < 0 || next[k] == l->n[k] || lattice_patch(l, c->m, i, way, &face) >= 0) continue;
        if (side_patch(c, next, side) != patch) c->plane[k][high ? next[k] : i[k]] = true;
    }
}

static status find_planes(struct cutter *c) {
    const int *n = c->l->n;
    for (int k = 0; k < 3; k++) {
        TRY(allocate(&c->plane[k], n[k] + 1L, sizeof *c->plane[k], "the cut planes"));
        c->plane[k][0] = c->plane[k][n[k]] = true;
    }
    for (int i = 0; c->l->boxes && i < c->l->boxes->nboxes; i++) mark_box(c, &c->l->boxes->box[i]);
    for (int i = 0; !lattice_is_local(c->l) && i < c->l->sites->nfaces; i++) mark_face(c, &c->l->sites->face[i]);
    if (c->l->boxes || !lattice_is_local(c->l)) return OK;
    for (int i[3] = {0}; i[2] < n[2]; i[2]++)
        for (i[1] = 0; i[1] < n[1]; i[1]++)
            for (i[0] = 0; i[0] < n[0]; i[0]++)
                if (lattice_cell(c->l, i) >= 0) TRY(mark_planes(c, i));
    return OK;
}

enum { DEEP = 32 }; /* most cells of a tile along the last of three axes: thinner tiles are as fast, and more to deal */

static int most_uncut(int k, int tile_size) {
    return k == 2 && tile_size > DEEP ? DEEP : tile_size;
}

/* 3, 5 or 7 tiles cannot be dealt evenly to two ranks; then those of an even lattice are cut in two along the last
 * axis, which leaves their rows as long as they are. Returns into how many pieces that axis is cut then, else 0. */
static int halves(const struct lattice *l, int tile_size) {
    const int last = l->dim - 1;
    int tiles = 1, pieces = 1;
    for (int a = 0; a < l->dim; a++) {
        const int most = most_uncut(a, tile_size);
        pieces = l->uniform[a] ? 1 : (l->n[a] + most - 1) / most; /* in the end of the last axis */
        tiles *= pieces;
    }
    const bool uneven = tiles % 2 == 1 && tiles >= 3 && tiles <= 7;
    const bool thick = last > 0 && !l->uniform[last] && l->n[last] / (2 * pieces) >= 4 * GHOSTS;
    return l->even && uneven && thick ? 2 * pieces : 0;
}

/* Returns the most cells that a tile shall have along axis k. */
static int most_along(const struct lattice *l, int k, int tile_size) {
    const int pieces = k == l->dim - 1 ? halves(l, tile_size) : 0;
    return pieces ? (l->n[k] + pieces - 1) / pieces : most_uncut(k, tile_size);
}

enum { VECTOR = 8 }; /* numbers that a sweep works on at once */

/* Returns where piece p of `length` cells along axis 0 begins, or -1 where such pieces would be longer than tile_size:
 * n cells in a row have n + 1 faces along it, which shall fill vectors. In space cells fill them where their number
 * allows it: most faces lie along other axes, and a row of whole vectors takes the first of its own from the tile
 * before. The first pieces are the longer ones: a rank begins with the first tile before which its share lies
 * (trees.h), so that of two tiles each of two ranks gets one. */
static int row_start(int length, int parts, int p, int dim, int tile_size) {
    const int ends = dim > 2 && length % VECTOR == 0 ? 0 : 1; /* faces that a row has more than cells */
    const int vectors = (length + ends * parts + VECTOR - 1) / VECTOR;
    const int spare = VECTOR * vectors - ends * parts - length;
    const int longest = VECTOR * ((vectors + parts - 1) / parts) - ends;
    if (longest > tile_size || tile_size < 4 * VECTOR) return -1;
    return VECTOR * (int)(((long)vectors * p + parts - 1) / parts) - ends * p - spare * p / parts;
}

/* Cuts axis k between its planes into pieces of at most tile_size cells, but no shorter than GHOSTS where the planes
 * allow it: of nearly equal length, but along axis 0 large tiles get rows that fill vectors. */
static status cut_axis(struct forest_private *h, const bool *plane, int k, int dim, int tile_size) {
    TRY(pool_take(&h->pool, &h->start[k], h->n[k] + 1L, sizeof *h->start[k], "the pieces of an axis"));
    int low = 0;
    for (int high = 1; high <= h->n[k]; high++) {
        if (!plane[high]) continue;
        int length = high - low, parts = (length + tile_size - 1) / tile_size;
        if (parts > length / GHOSTS) parts = length < GHOSTS ? 1 : length / GHOSTS;
        for (int p = 0; p < parts; p++) {
            const int along = k == 0 && parts > 1 ? row_start(length, parts, p, dim, tile_size) : -1;
            h->start[k][h->pieces[k]++] = low + (along < 0 ? (int)((long)length * p / parts) : along);
        }
        low = high;
    }
    h->start[k][h->pieces[k]] = h->n[k];
    return OK;
}

static uint64_t morton(const int i[3]) {
    uint64_t key = 0;
    for (int bit = 0; bit < 21; bit++)
        for (int k = 0; k < 3; k++) key |= (uint64_t)(i[k] >> bit & 1) << (3 * bit + k);
    return key;
}

struct seat {
    uint64_t key;
    int piece[3];
};

static int by_key(const void *a, const void *b) {
    uint64_t p = ((const struct seat *)a)->key, q = ((const struct seat *)b)->key;
    return (p > q) - (p < q);
}

/* Are there cells in the block that begins at a place? `before`: are there in the block before it along axis 0? Without
 * a table of cells faces on patches tell, of which each row of cells has one at either end. */
static bool is_solid(const struct cutter *c, const int low[3], bool before) {
    const int last[3] = {low[0] - 1, low[1], low[2]};
    long face;
    if (lattice_is_local(c->l)) return lattice_cell(c->l, low) >= 0;
    return lattice_patch(c->l, c->m, low, 0, &face) >= 0 || (before && lattice_patch(c->l, c->m, last, 1, &face) < 0);
}

/* Numbers the solid blocks along the curve, which runs through one half of a lattice cut in two before the other, so
 * that each of two ranks gets a half; seat[id] is a block's place in their grid. */
static void number_blocks(struct forest_private *h, const struct cutter *c, int tile_size, struct seat *seat) {
    const int *pieces = h->pieces, last = c->l->dim - 1;
    const bool half = halves(c->l, tile_size) > 0;
    for (int p[3] = {0}; p[2] < pieces[2]; p[2]++)
        for (p[1] = 0; p[1] < pieces[1]; p[1]++) {
            bool solid = false;
            for (p[0] = 0; p[0] < pieces[0]; p[0]++) {
                int low[3] = {h->start[0][p[0]], h->start[1][p[1]], h->start[2][p[2]]};
                h->id[at(pieces, p)] = -1;
                solid = is_solid(c, low, solid);
                if (!solid) continue;
                const uint64_t above = half && 2 * p[last] >= pieces[last];
                seat[h->nblocks++] = (struct seat){above << 63 | morton(p), {p[0], p[1], p[2]}};
            }
        }
    qsort(seat, (size_t)h->nblocks, sizeof *seat, by_key);
    for (int b = 0; b < h->nblocks; b++) h->id[at(pieces, seat[b].piece)] = b;
}

/* Is the block at a place of the grid a tile, too? */
static bool is_tile(const struct cutter *c, const int piece[3]) {
    bool first = true;
    for (int k = 0; k < 3; k++) first &= !c->l->uniform[k] || piece[k] == 0;
    return first;
}

/* Returns the tile that holds the values of the block at a place of the grid; -1: a hole is there. */
static int tile_at(const struct forest_private *h, const struct cutter *c, const int *tile_of, const int piece[3]) {
    int first[3];
    for (int k = 0; k < 3; k++) first[k] = c->l->uniform[k] ? 0 : piece[k];
    const int id = h->id[at(h->pieces, first)];
    return id < 0 ? -1 : tile_of[id];
}

static void describe_tile(struct forest_private *h, const struct cutter *c, const int *tile_of, const int piece[3]) {
    struct trees_tile *t = &h->all[tile_at(h, c, tile_of, piece)];
    for (int k = 0; k < 3; k++) {
        t->low[k] = h->start[k][piece[k]];
        t->n[k] = c->l->uniform[k] ? 1 : h->start[k][piece[k] + 1] - t->low[k];
    }
    for (int side = 0; side < 6; side++) {
        int k = side / 2, corner[3] = {t->low[0], t->low[1], t->low[2]}, next[3] = {piece[0], piece[1], piece[2]};
        if (side % 2) corner[k] += t->n[k] - 1;
        next[k] = (next[k] + (side % 2 ? 1 : h->pieces[k] - 1)) % h->pieces[k];
        bool patch = k >= c->l->dim || side_patch(c, corner, side) >= 0;
        t->neighbour[side] = patch ? -1 : tile_at(h, c, tile_of, next);
    }
}

static int by_tile(const void *a, const void *b) {
    const struct cut_block *p = a, *q = b;
    return p->tile != q->tile ? (p->tile > q->tile) - (p->tile < q->tile) : (p->id > q->id) - (p->id < q->id);
}

/* Numbers the tiles in the order of the blocks that they are, and lists the blocks tile by tile. */
static void describe_all(struct forest_private *h, const struct cutter *c, const struct seat *seat, int *tile_of) {
    for (int b = 0; b < h->nblocks; b++)
        if (is_tile(c, seat[b].piece)) tile_of[b] = h->nall++;
    for (int b = 0; b < h->nblocks; b++) {
        const int *piece = seat[b].piece;
        h->block[b] = (struct cut_block){.id = b, .tile = tile_at(h, c, tile_of, piece)};
        for (int k = 0; k < 3; k++) {
            h->block[b].low[k] = h->start[k][piece[k]];
            h->block[b].n[k] = h->start[k][piece[k] + 1] - h->block[b].low[k];
        }
        if (is_tile(c, piece)) describe_tile(h, c, tile_of, piece);
    }
    qsort(h->block, (size_t)h->nblocks, sizeof *h->block, by_tile);
}

/* Refuses tile t if a neighbour tile takes ghost layers from it and it has fewer than GHOSTS cells there. A tile that
 * is its own periodic image may be thinner: it wraps round as often as it must. */
static status check_thickness(const struct forest_private *h, const struct cutter *c, int t) {
    const struct lattice *l = c->l;
    const struct trees_tile *tile = &h->all[t];
    for (int side = 0; side < 2 * l->dim; side++) {
        int k = side / 2, neighbour = tile->neighbour[side];
        if (tile->n[k] >= GHOSTS || neighbour < 0 || neighbour == t) continue;
        char x = axis_name(l, k);
        return fail(ERR_INPUT,
                    "%s: only %d cell%s along %c between %c = %g and %c = %g, planes where the boundary "
                    "or its patch changes; at least %d are needed; refine the mesh along %c by a factor of %d, or move "
                    "one of these planes",
                    c->m->boxes ? "system/blockMeshDict" : "constant/polyMesh", tile->n[k], tile->n[k] > 1 ? "s" : "",
                    x, x, position(l, k, tile->low[k]), x, position(l, k, tile->low[k] + tile->n[k]), GHOSTS, x,
                    (GHOSTS + tile->n[k] - 1) / tile->n[k]);
    }
    return OK;
}

static status make_tiles(struct forest_private *h, const struct cutter *c, int tile_size) {
    long places = (long)h->pieces[0] * h->pieces[1] * h->pieces[2];
    TRY(pool_take(&h->pool, &h->id, places, sizeof *h->id, "the grid of blocks"));
    struct seat *seat;
    int *tile_of = NULL;
    TRY(allocate(&seat, places, sizeof *seat, "the curve of the tiles"));
    number_blocks(h, c, tile_size, seat);
    status s = pool_take(&h->pool, &h->block, h->nblocks, sizeof *h->block, "the blocks");
    if (!s) s = pool_take(&h->pool, &h->all, h->nblocks, sizeof *h->all, "the tiles");
    if (!s) s = allocate(&tile_of, h->nblocks, sizeof *tile_of, "the tiles");
    if (!s) describe_all(h, c, seat, tile_of);
    free(tile_of);
    free(seat);
    for (int t = 0; !s && t < h->nall; t++) s = check_thickness(h, c, t);
    return s;
}

/* Of a lattice with holes tiles may differ much: has one of two ranks more than its share then, although there are
 * cells enough for both? */
static bool is_lopsided(const struct forest_private *h) {
    const bool holes = h->nblocks < h->pieces[0] * h->pieces[1] * h->pieces[2];
    long cells[2] = {0, 0};
    int start[3];
    if (!holes || h->nall > MANY) return false;
    trees_deal(h->all, h->nall, 2, start);
    for (int t = 0; t < h->nall; t++) cells[t >= start[1]] += (long)h->all[t].n[0] * h->all[t].n[1] * h->all[t].n[2];
    const long most = cells[0] > cells[1] ? cells[0] : cells[1];
    return cells[0] + cells[1] >= WORTHY && (double)most > FAIR * (double)(cells[0] + cells[1]);
}

static int longest_piece(const struct forest_private *h, int k) {
    int longest = 0;
    for (int p = 0; p < h->pieces[k]; p++) {
        const int length = h->start[k][p + 1] - h->start[k][p];
        if (length > longest) longest = length;
    }
    return longest;
}

status cut_make(struct forest_private *h, const struct lattice *l, const struct polymesh *m, int tile_size) {
    struct cutter c = {.l = l, .m = m};
    if (tile_size < GHOSTS)
        return fail(ERR_INPUT, "tile size %d; a tile has at least %d cells a side", tile_size, GHOSTS);
    for (int k = 0; k < 3; k++) h->n[k] = l->n[k];
    status s = find_planes(&c);
    for (int k = 0; !s && k < 3; k++) s = cut_axis(h, c.plane[k], k, l->dim, most_along(l, k, tile_size));
    if (!s) s = make_tiles(h, &c, tile_size);
    const int last = l->dim - 1, longest = s ? 0 : longest_piece(h, last);
    for (int parts = 2; !s && last > 0 && longest / parts >= 4 * GHOSTS && is_lopsided(h); parts++) {
        h->pieces[last] = h->nblocks = h->nall = 0;
        s = cut_axis(h, c.plane[last], last, l->dim, (longest + parts - 1) / parts);
        if (!s) s = make_tiles(h, &c, tile_size);
    }
    for (int k = 0; k < 3; k++) free(c.plane[k]);
    return s;
}
