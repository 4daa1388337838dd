/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seams: the faces between two tiles of this rank. In a stage the tile that comes first keeps the fluxes through them,
 * and the other one takes them, so that a row of 32 cells has 32 faces to compute, not 33: four vectors in place of
 * five. A flux has the same bits on both sides, since it depends on its stencil alone. Tiles of which only some cells
 * are computed, or whose faces may be limited, neither keep nor take. */
#include "libcore/lattice/tiles.h"

#include <stdlib.h>

/* Returns how many rows of faces lie above a tile along an axis; 0 where there is no seam. */
static int rows_above(const struct gas *g, int tile, int axis) {
    const struct tile *t = &g->forest->tile[tile];
    if (axis >= g->dim || t->side[2 * axis + 1].neighbour < 0 || t->n[1] > BATCH) return 0;
    return t->n[axis == 2 ? 1 : 2];
}

status seams_make(struct gas *g) {
    struct seams *s = &g->tiles->seams;
    const int ntiles = g->forest->ntiles;
    if (g->dim < 3) return OK; /* in a plane rows of 63 cells have as many vectors of faces without seams */
    TRY(allocate(&s->above, (long)MAX_DIM * ntiles, sizeof *s->above, "tiles"));
    TRY(allocate(&s->known, (long)MAX_DIM * ntiles, sizeof *s->known, "tiles"));
    for (int i = 0; i < MAX_DIM * ntiles; i++) {
        const int rows = rows_above(g, i / MAX_DIM, i % MAX_DIM);
        if (rows) TRY(allocate(&s->above[i], rows, sizeof *s->above[i], "the fluxes between tiles"));
    }
    return OK;
}

void seams_free(struct gas *g) {
    struct seams *s = &g->tiles->seams;
    for (int i = 0; s->above && i < MAX_DIM * g->forest->ntiles; i++) free(s->above[i]);
    free(s->above);
    free(s->known);
}

void seams_begin(struct gas *g) {
    struct seams *s = &g->tiles->seams;
    if (s->known) memset(s->known, 0, (size_t)MAX_DIM * (size_t)g->forest->ntiles * sizeof *s->known);
}

/* Returns the number of the seam at a side of the tile in hand, or -1. Rows that are not whole vectors have as many
 * vectors of faces with seams as without; both ends of a row that is its own neighbour are in one batch. */
static int seam_at(const struct gas *g, int tile, int side) {
    const int axis = side / 2, *n = g->forest->tile[tile].n;
    if (!g->tiles->seams.above || !g->tiles->activity.whole) return -1;
    const int other = g->forest->tile[tile].side[side].neighbour;
    if (other < 0 || (axis == 0 && (other == tile || n[0] != whole_vectors(n[0])))) return -1;
    const int at = MAX_DIM * (side % 2 ? tile : other) + axis;
    return g->tiles->seams.above[at] ? at : -1;
}

void seams_of_tile(const struct gas *g, int tile, struct seam seam[6]) {
    const struct seams *s = &g->tiles->seams;
    for (int side = 0; side < 6; side++) {
        const int at = seam_at(g, tile, side);
        const bool twice = side % 2 && g->forest->tile[tile].side[side].neighbour == tile; /* it is the low side, too */
        seam[side] = at < 0 ? (struct seam){NULL, false} : (struct seam){s->above[at], s->known[at] || twice};
    }
}

void seams_end(struct gas *g, int tile) {
    for (int side = 0; side < 6; side++) {
        const int at = seam_at(g, tile, side);
        if (at >= 0) g->tiles->seams.known[at] = true;
    }
}
