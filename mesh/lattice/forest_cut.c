/* Cuts a lattice into the tiles of the forest (forest.h): finds the planes where the boundary or its patch changes,
 * cuts every axis into pieces between them, and numbers the solid boxes of the pieces' tensor product along a Morton
 * curve. */
#include "mesh/lattice/forest_private.h"

#include <stdint.h>
#include <stdlib.h>

struct cutter {
    const struct lattice *l;
    const struct polymesh *m;
    const int *patch_of;
    bool *plane[3]; /* [n + 1] must tiles end at this plane? */
};

static long at(const int n[3], const int i[3]) {
    return i[0] + n[0] * (i[1] + (long)n[1] * i[2]);
}

static int side_face(const struct cutter *c, const int i[3], int side) {
    return c->l->face[6 * (long)c->l->cell[at(c->l->n, i)] + side];
}

/* Returns the patch at a side of the solid cell i, or -1 where another cell follows. */
static int side_patch(const struct cutter *c, const int i[3], int side) {
    int face = side_face(c, i, side);
    return face < c->m->ninternal ? -1 : c->patch_of[face - c->m->ninternal];
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
    int face = side_face(c, i, side), k = side / 2;
    if (face < c->m->ninternal || c->patch_of[face - c->m->ninternal] >= 0) return OK;
    int image[3] = {i[0], i[1], i[2]}, edge = side % 2 ? l->n[k] - 1 : 0;
    image[k] = l->n[k] - 1 - edge;
    if (i[k] == edge && l->periodic[k] && l->cell[at(l->n, image)] >= 0) return OK;
    return fail(ERR_INPUT,
                "constant/polyMesh: face %d at %c = %g is cyclic, but there is no cell at the opposite edge of the "
                "mesh; cyclic patches must join two opposite edges of the whole mesh; make this one a wall",
                face, axis_name(l, k), position(l, k, i[k] + side % 2));
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
            if (k == side / 2 || ++next[k] == c->l->n[k] || c->l->cell[at(c->l->n, next)] < 0) continue;
            if (side_patch(c, next, side) != patch) c->plane[k][next[k]] = true;
        }
    }
    return OK;
}

static status find_planes(struct cutter *c) {
    const int *n = c->l->n;
    for (int k = 0; k < 3; k++) {
        TRY(allocate(&c->plane[k], n[k] + 1L, sizeof *c->plane[k], "the cut planes"));
        c->plane[k][0] = c->plane[k][n[k]] = true;
    }
    for (int i[3] = {0}; i[2] < n[2]; i[2]++)
        for (i[1] = 0; i[1] < n[1]; i[1]++)
            for (i[0] = 0; i[0] < n[0]; i[0]++)
                if (c->l->cell[at(n, i)] >= 0) TRY(mark_planes(c, i));
    return OK;
}

/* Cuts axis k between its planes into pieces of nearly equal length: of at most tile_size cells, but no shorter than
 * GHOSTS where the planes allow it. */
static status cut_axis(struct forest_private *h, const bool *plane, int k, int tile_size) {
    TRY(allocate(&h->start[k], h->n[k] + 1L, sizeof *h->start[k], "the pieces of an axis"));
    int low = 0;
    for (int high = 1; high <= h->n[k]; high++) {
        if (!plane[high]) continue;
        int length = high - low, parts = (length + tile_size - 1) / tile_size;
        if (parts > length / GHOSTS) parts = length < GHOSTS ? 1 : length / GHOSTS;
        for (int p = 0; p < parts; p++) h->start[k][h->pieces[k]++] = low + (int)((long)length * p / parts);
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

/* Numbers the solid tiles along the curve; seat[id] is a tile's place in the tile grid. */
static void number_tiles(struct forest_private *h, const struct cutter *c, struct seat *seat) {
    const int *pieces = h->pieces;
    for (int p[3] = {0}; p[2] < pieces[2]; p[2]++)
        for (p[1] = 0; p[1] < pieces[1]; p[1]++)
            for (p[0] = 0; p[0] < pieces[0]; p[0]++) {
                int low[3] = {h->start[0][p[0]], h->start[1][p[1]], h->start[2][p[2]]};
                h->id[at(pieces, p)] = -1;
                if (c->l->cell[at(h->n, low)] >= 0) seat[h->nall++] = (struct seat){morton(p), {p[0], p[1], p[2]}};
            }
    qsort(seat, (size_t)h->nall, sizeof *seat, by_key);
    for (int t = 0; t < h->nall; t++) h->id[at(pieces, seat[t].piece)] = t;
}

static void describe_tile(struct forest_private *h, const struct cutter *c, const int piece[3], struct trees_tile *t) {
    for (int k = 0; k < 3; k++) {
        t->low[k] = h->start[k][piece[k]];
        t->n[k] = h->start[k][piece[k] + 1] - t->low[k];
    }
    for (int side = 0; side < 6; side++) {
        int k = side / 2, corner[3] = {t->low[0], t->low[1], t->low[2]}, next[3] = {piece[0], piece[1], piece[2]};
        if (side % 2) corner[k] += t->n[k] - 1;
        next[k] = (next[k] + (side % 2 ? 1 : h->pieces[k] - 1)) % h->pieces[k];
        bool patch = k >= c->l->dim || side_patch(c, corner, side) >= 0;
        t->neighbour[side] = patch ? -1 : h->id[at(h->pieces, next)];
    }
}

/* Refuses tile t if a neighbour tile takes ghost layers from it and it has fewer than GHOSTS cells there. A tile that
 * is its own periodic image may be thinner: it wraps round as often as it must. */
static status check_thickness(const struct forest_private *h, const struct lattice *l, int t) {
    const struct trees_tile *tile = &h->all[t];
    for (int side = 0; side < 2 * l->dim; side++) {
        int k = side / 2, neighbour = tile->neighbour[side];
        if (tile->n[k] >= GHOSTS || neighbour < 0 || neighbour == t) continue;
        char x = axis_name(l, k);
        return fail(ERR_INPUT,
                    "constant/polyMesh: only %d cell%s along %c between %c = %g and %c = %g, planes where the boundary "
                    "or its patch changes; at least %d are needed; refine the mesh along %c by a factor of %d, or move "
                    "one of these planes",
                    tile->n[k], tile->n[k] > 1 ? "s" : "", x, x, position(l, k, tile->low[k]), x,
                    position(l, k, tile->low[k] + tile->n[k]), GHOSTS, x, (GHOSTS + tile->n[k] - 1) / tile->n[k]);
    }
    return OK;
}

static status make_tiles(struct forest_private *h, const struct cutter *c) {
    long places = (long)h->pieces[0] * h->pieces[1] * h->pieces[2];
    TRY(allocate(&h->id, places, sizeof *h->id, "the tile grid"));
    struct seat *seat;
    TRY(allocate(&seat, places, sizeof *seat, "the curve of the tiles"));
    number_tiles(h, c, seat);
    status s = allocate(&h->all, h->nall, sizeof *h->all, "the tiles");
    for (int t = 0; !s && t < h->nall; t++) describe_tile(h, c, seat[t].piece, &h->all[t]);
    free(seat);
    for (int t = 0; !s && t < h->nall; t++) s = check_thickness(h, c->l, t);
    return s;
}

status cut_make(struct forest_private *h, const struct lattice *l, const struct polymesh *m, const int *patch_of,
                int tile_size) {
    struct cutter c = {.l = l, .m = m, .patch_of = patch_of};
    if (tile_size < GHOSTS)
        return fail(ERR_INPUT, "tile size %d; a tile has at least %d cells a side", tile_size, GHOSTS);
    for (int k = 0; k < 3; k++) h->n[k] = l->n[k];
    status s = find_planes(&c);
    for (int k = 0; !s && k < 3; k++) s = cut_axis(h, c.plane[k], k, tile_size);
    if (!s) s = make_tiles(h, &c);
    for (int k = 0; k < 3; k++) free(c.plane[k]);
    return s;
}

void cut_free(struct forest_private *h) {
    for (int k = 0; k < 3; k++) free(h->start[k]);
    free(h->id);
    free(h->all);
}
