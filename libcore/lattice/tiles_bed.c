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

struct dealing { /* hands the rows of a tile to a visitor */
    const struct gas *g;
    int tile;
    bed_block_visitor *visit;
    void *context;
};

static void deal_visit(void *dealing, long offset, int n) {
    const struct dealing *d = dealing;
    const struct forest *f = d->g->forest;
    const long row = d->g->dim > 1 ? (offset - f->first) / f->stride[d->g->dim - 1] : 0;
    d->visit(d->context, block_number(f, d->tile, (int)row / BLOCK_ROWS), d->tile, &(struct row){d->tile, offset, n});
}

void tiles_bed_blocks(const struct gas *g, bed_block_visitor *visit, void *context) {
    struct dealing d = {g, 0, visit, context};
    for (d.tile = 0; d.tile < g->forest->ntiles; d.tile++)
        if (g->dense->holds[d.tile]) runs_visit(g->forest, &g->forest->tile[d.tile], 0, deal_visit, &d);
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
