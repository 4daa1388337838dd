/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bed of implicit acoustics on a lattice: which cells it holds, their lists, and what goes to and from the tiles.
 */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

#include <stdlib.h>

struct tiles_bed {
    /* In the plane the cells are one box, and a face has the shape of its axis. Volumes are 1, and areas 1/width.
     * Cells of a body of revolution have the shape of their place along the radius, and faces that of axis + dim place,
     * where the place of a face across the radius is that of the cell above it. All have the weight r. */
    struct bed_shapes shapes;
    struct bed_round round;
};

static const double NOTHING = 1e-200; /* m: the radius of a face on the axis, as pressures on it are divided by areas */

/* Returns how many cells a round lattice has along the radius; else 1. */
static int places_of(const struct gas *g) {
    const struct forest *f = g->forest;
    double most = 1;
    for (int t = 0; t < f->ntiles && f->radial >= 0; t++)
        most = larger(most, f->tile[t].low[f->radial] + f->tile[t].n[f->radial]);
    comm_max(g->comm, &most, 1);
    return (int)most;
}

static void make_shape(const struct gas *g, struct tiles_bed *b, int place, int k) {
    const struct forest *f = g->forest;
    const int shape = k + g->dim * place;
    const double half = 0.5 * f->width[k];
    double weight = 1;
    if (f->radial >= 0) weight = larger(forest_radius(f, place + (k == f->radial ? 0 : 0.5)), NOTHING);
    b->shapes.area[shape] = weight / f->width[k];
    b->shapes.depth[0][shape] = half;
    b->shapes.normal[k][shape] = 1;
    for (int side = 0; side < 2; side++) b->shapes.arm[side][k][shape] = side ? -half : half;
    if (f->radial < 0) return;
    b->round.flat[shape] = 1 / f->width[k];
    b->round.body[0][shape] = k == f->radial ? place - 1 : place;
    b->round.body[1][shape] = place;
}

static status make_shapes(struct gas *g, struct tiles_bed *b) {
    const struct forest *f = g->forest;
    const int places = places_of(g), all = f->radial >= 0 ? places + 1 : 1;
    const long faces = (long)g->dim * all;
    struct bed_shapes *s = &b->shapes;
    struct pool *pool = &g->dense->pool;
    double *memory;
    int *body;
    TRY(comm_agree(g->comm, pool_take(pool, &memory, all + (3 + 3 * g->dim) * faces, sizeof(double), "the bed")));
    TRY(comm_agree(g->comm, pool_take(pool, &body, 2 * faces, sizeof(int), "the bed")));
    double *at = memory + all;
    *s = (struct bed_shapes){.boxes = true, .volume = memory, .area = at, .depth = {at + faces, at + faces}};
    b->round = (struct bed_round){f->radial, memory, at + 2 * faces, .body = {body, body + faces}};
    at += 3 * faces;
    for (int k = 0; k < g->dim; k++, at += 3 * faces) {
        s->normal[k] = at;
        for (int side = 0; side < 2; side++) s->arm[side][k] = b->round.mid[side][k] = at + (1 + side) * faces;
    }
    if (f->radial >= 0) s->round = &b->round;
    for (int i = 0; i < all; i++) {
        s->volume[i] = f->radial >= 0 ? forest_radius(f, i + 0.5) : 1;
        for (int k = 0; k < g->dim; k++) make_shape(g, b, i, k);
    }
    g->dense->bed.home->shapes = s;
    return OK;
}

/* A block of the bed, which ranks are dealt, is this number of rows of a tile along the last axis. */
enum { BLOCK_ROWS = 8 };

static int blocks_of_tile(const struct gas *g, int tile) {
    return g->dim > 1 ? (g->forest->tile[tile].n[g->dim - 1] + BLOCK_ROWS - 1) / BLOCK_ROWS : 1;
}

status tiles_bed_make(struct gas *g) {
    const struct forest *f = g->forest;
    struct tiles_bed *b;
    int blocks = 0;
    for (int t = 0; t < f->ntiles; t++) {
        const int *n = f->tile[t].n;
        blocks += blocks_of_tile(g, t);
        g->dense->own += (long)n[0] * n[1] * n[2];
    }
    TRY(bed_make(&g->dense->bed, blocks));
    TRY(pool_take(&g->dense->pool, &b, 1, sizeof *b, "the bed"));
    TRY(pool_take(&g->dense->pool, &g->dense->place, blocks, sizeof(int), "the bed"));
    g->dense->sides = 2 * g->dim;
    return make_shapes(g, b);
}

/* ---- the lists ---- */

/* A number over all ranks: no tile has as many rows as its memory has room for. */
static int block_number(const struct forest *f, int tile, int block) {
    const int room = (int)(f->size / f->stride[f->dim - 1]) / BLOCK_ROWS + 1;
    return f->tile[tile].id * room + block;
}

struct listing { /* lists the cells of a tile: how many there are; or, if `bed` is set, their rows and numbers */
    const struct gas *g;
    struct dense *bed;
    int tile, rows, cells, *block_end; /* block_end: the cells up to the end of each block of the tile */
};

static void list_visit(void *listing, long offset, int n) {
    struct listing *l = listing;
    const struct forest *f = l->g->forest;
    const double *part = l->g->dense->part[l->tile] + offset;
    const long row = l->g->dim > 1 ? (offset - f->first) / f->stride[l->g->dim - 1] : 0;
    for (int i = 0, end; i < n; i = end + 1) {
        for (end = i; end < n && part[end] > 0; end++)
            if (l->bed) l->bed->number[l->tile][offset + end] = l->bed->bed.home->low + ++l->cells;
        if (end == i) continue;
        if (l->bed)
            l->bed->row[l->rows] = (struct row){l->tile, offset + i, end - i};
        else
            l->cells += end - i;
        l->rows++;
    }
    if (l->block_end) l->block_end[row / BLOCK_ROWS] = l->cells;
}

/* Lists the blocks, or the cells in them. */
static struct listing list_cells(struct gas *g, bool blocks) {
    const struct forest *f = g->forest;
    struct bed_set *bed = g->dense->bed.home;
    struct listing l = {.g = g, .bed = blocks ? NULL : g->dense};
    if (blocks) bed->blocks = bed->first[0] = 0;
    for (l.tile = 0; l.tile < f->ntiles; l.tile++) {
        if (!g->dense->holds[l.tile]) continue;
        l.block_end = blocks ? bed->first + bed->blocks + 1 : NULL;
        runs_visit(f, &f->tile[l.tile], 0, list_visit, &l);
        for (int i = 0; blocks && i < blocks_of_tile(g, l.tile); i++)
            g->dense->place[bed->blocks] = l.tile, bed->number[bed->blocks++] = block_number(f, l.tile, i);
    }
    return l;
}

/* Returns the shape of a face of the cell at `at` of a tile. */
static int face_shape(const struct gas *g, int tile, long at, int axis, bool above) {
    const int radial = g->forest->radial;
    if (radial < 0) return axis;
    return axis + g->dim * (forest_place_along(g->forest, tile, at, radial) + (axis == radial && above));
}

/* Adds the face of cell i of the bed, lane j of `s`, to what has the number `other`. */
static void add_face(struct gas *g, const struct row *row, const struct sides *s, int j, int i, int side, int other) {
    struct bed_set *bed = g->dense->bed.home;
    const bool above = side % 2;
    const int f = bed->faces++;
    bed->left[f] = above ? bed->low + i : other;
    bed->right[f] = above ? other : bed->low + i;
    bed->shape[f] = face_shape(g, row->block, row->at + j, side / 2, above);
    bed->face_of_cell[2 * g->dim * i + side] = above ? f : ~f;
    if (other >= bed->low && other < bed->low + bed->cells)
        bed->face_of_cell[2 * g->dim * (other - bed->low) + side - 1] = ~f;
    dense_border(g, row, s, j, f);
}

/* Makes the face above each cell, and that below where no cell of this rank makes it. */
static void list_faces(struct gas *g) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    struct sides low, high;
    for (int k = 0; k < g->dim; k++)
        for (int r = 0, i = 0; r < d->rows; r++) {
            const int *number = d->number[d->row[r].block];
            (void)g->engine->state.sides(g, &d->row[r], 2 * k, &low);
            (void)g->engine->state.sides(g, &d->row[r], 2 * k + 1, &high);
            for (int j = 0; j < d->row[r].n; j++, i++) {
                const int below = number[low.across[j]] - 1;
                add_face(g, &d->row[r], &high, j, i, 2 * k + 1, number[high.across[j]] - 1);
                if (below < bed->low || below >= bed->low + bed->cells)
                    add_face(g, &d->row[r], &low, j, i, 2 * k, below);
            }
        }
}

/* Sets the shapes of this rank's cells, which on several ranks stand behind cells of others. */
static void find_bodies(struct gas *g) {
    const struct dense *d = g->dense;
    for (int r = 0, i = 0; r < d->rows; r++)
        for (int j = 0; j < d->row[r].n; j++)
            d->bed.home->body[i++] =
                forest_place_along(g->forest, d->row[r].block, d->row[r].at + j, g->forest->radial);
}

/* What needs other ranks comes first: a rank with more of the bed has more to list, and less to do in the stages. */
status tiles_bed_list(struct gas *g) {
    struct bed_set *bed = g->dense->bed.home;
    const struct listing l = list_cells(g, true);
    TRY(dense_list(g, l.rows, 2 * g->dim * l.cells));
    g->dense->rows = list_cells(g, false).rows;
    forest_fill_int(g->forest, g->dense->number);
    list_faces(g);
    for (int i = 0; i <= bed->cells; i++) bed->face_start[i] = 2 * g->dim * i;
    memset(bed->body, 0, (size_t)bed->cells * sizeof *bed->body);
    if (bed->shapes->round) find_bodies(g);
    return OK;
}

/* ---- in the stages ---- */

/* A face stands where the cell above it does. */
void tiles_note_fluxes(struct gas *g, const struct strip *s, double (*out)[BATCH], int column) {
    const struct forest *f = g->forest;
    double *to = g->dense->flux[s->tile] + s->axis * f->size + s->offset + f->stride[s->axis];
    for (int v = 0; v < g->nvar; v++) memcpy(to + v * g->blocks.faces, out[v] + column, (size_t)s->n * sizeof(double));
}

bool tiles_hold_bed(const struct gas *g, int tile) {
    return g->step.hybrid && g->dense->holds[tile];
}

struct span tiles_moving_span(const struct gas *g, int tile, long row, int n) {
    const double *part = g->dense->part[tile] + row;
    struct span s = {0, n};
    while (s.low < n && part[s.low] >= BED_FROZEN) s.low++;
    while (s.high > s.low && part[s.high - 1] >= BED_FROZEN) s.high--;
    return span_empty(s) ? SPAN_EMPTY : s;
}
