/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the grid of a run from a lattice or a polyhedral mesh (grid.h), and gathers, sums and finds values by block. */
#include "mesh/grid/grid.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/base/share.h"
#include "mesh/grid/search.h"

struct grid_private {
    int *block_order; /* root: [nblocks_all] the blocks' ids, rank by rank */
    double middle[3]; /* m, of a lattice: where axes of one cell have their cells */

    int *cell;             /* polyhedral: [nown] cells, block by block */
    int *place;            /* [ncells_all] where a cell stands in `cell`, -1: on another rank */
    struct search *search; /* searches the whole mesh, so that every rank finds the same cell */
};

/* A row of 63 cells has 64 faces, which fill one batch of libcore; in 3D planes of 32 x 32 cells stay in L2. */
int grid_tile_size(int dim) {
    return dim == 3 ? 32 : 63;
}

static status take_forest(struct grid *g, const struct lattice *l) {
    TRY(forest_make(l, g->mesh, g->comm, grid_tile_size(l->dim), &g->forest));
    const struct forest *f = g->forest;
    double low[3], high[3];
    polymesh_bounds(g->mesh, low, high);
    for (int x = 0; x < 3; x++) g->hidden->middle[x] = 0.5 * (low[x] + high[x]);
    g->dim = f->dim;
    memcpy(g->axis, f->axis, sizeof g->axis);
    g->nblocks_all = f->nblocks_all;
    g->nblocks = f->nblocks;
    status s = allocate(&g->block, f->nblocks, sizeof *g->block, "the blocks of the grid");
    for (int b = 0; !s && b < f->nblocks; b++) {
        const struct forest_block *here = &f->block[b];
        g->block[b] = (struct grid_block){here->id, here->n[0] * here->n[1] * here->n[2], here->cell};
    }
    return comm_agree(g->comm, s);
}

static status list_blocks(struct grid *g) {
    const struct polyhedra *m = g->polyhedra;
    struct grid_private *h = g->hidden;
    TRY(allocate(&g->block, m->nblocks, sizeof *g->block, "the blocks of the grid"));
    TRY(allocate(&h->cell, m->nown, sizeof *h->cell, "the cells of the blocks"));
    TRY(allocate(&h->place, g->ncells_all, sizeof *h->place, "the cells of the blocks"));
    for (int c = 0; c < g->ncells_all; c++) h->place[c] = -1;
    for (int i = 0; i < m->nown; i++) {
        h->cell[i] = m->cell[m->block_cell[i]];
        h->place[h->cell[i]] = i;
    }
    for (int b = 0; b < m->nblocks; b++)
        g->block[b] =
            (struct grid_block){m->block_id[b], m->block_start[b + 1] - m->block_start[b], h->cell + m->block_start[b]};
    return search_make(g->mesh, g->centre, g->dim, g->axis, &h->search);
}

static status take_polyhedra(struct grid *g, int rings) {
    TRY(polyhedra_make(g->mesh, g->comm, rings, &g->polyhedra));
    const struct polyhedra *m = g->polyhedra;
    g->dim = m->dim;
    memcpy(g->axis, m->axis, sizeof g->axis);
    g->nblocks_all = m->nblocks_all;
    g->nblocks = m->nblocks;
    return comm_agree(g->comm, list_blocks(g));
}

/* Tells the root in which order blocks arrive when it gathers. */
static status find_order(struct grid *g) {
    int *ids = NULL;
    status s = comm_agree(g->comm, allocate(&ids, g->nblocks, sizeof *ids, "the blocks of the grid"));
    for (int b = 0; !s && b < g->nblocks; b++) ids[b] = g->block[b].id;
    if (!s) s = comm_gather_int(g->comm, ids, g->nblocks, &g->hidden->block_order, NULL);
    free(ids);
    return s;
}

static status build(struct grid *g, const struct lattice *l, int rings) {
    if (l)
        TRY(take_forest(g, l));
    else
        TRY(take_polyhedra(g, rings));
    return find_order(g);
}

status grid_make(const struct lattice *l, const struct polymesh *m, const double *centre, const double *volume,
                 const struct comm *c, int rings, struct grid **out) {
    struct grid *g = NULL;
    *out = NULL;
    status s = allocate(&g, 1, sizeof *g, "the grid");
    if (!s) s = allocate(&g->hidden, 1, sizeof *g->hidden, "the grid");
    s = comm_agree(c, s);
    if (!s) {
        g->mesh = m;
        g->centre = centre;
        g->volume = volume;
        g->comm = c;
        g->ncells_all = m->ncells;
        s = build(g, l, rings);
    }
    if (s) {
        grid_free(g);
        return status_up(s, __FILE__, __LINE__);
    }
    *out = g;
    return OK;
}

void grid_free(struct grid *g) {
    if (!g) return;
    if (g->hidden) {
        free(g->hidden->block_order);
        free(g->hidden->cell);
        free(g->hidden->place);
        search_free(g->hidden->search);
        free(g->hidden);
    }
    forest_free(g->forest);
    polyhedra_free(g->polyhedra);
    free(g->block);
    free(g);
}

double grid_volume(const struct grid *g, int cell) {
    return g->forest ? g->forest->volume : g->volume[cell];
}

void grid_centre(const struct grid *g, int block, int i, double x[3]) {
    if (g->polyhedra) {
        memcpy(x, g->centre + 3L * g->block[block].cell[i], 3 * sizeof *x);
        return;
    }
    const struct forest *f = g->forest;
    const struct forest_block *b = &f->block[block];
    const int at[3] = {i % b->n[0], i / b->n[0] % b->n[1], i / b->n[0] / b->n[1]};
    memcpy(x, g->hidden->middle, 3 * sizeof *x);
    for (int k = 0; k < f->dim; k++) x[f->axis[k]] = f->origin[k] + f->width[k] * (b->low[k] + at[k] + 0.5);
}

const int *grid_cells(const struct grid *g, long *n) {
    *n = 0;
    for (int b = 0; b < g->nblocks; b++) *n += g->block[b].ncells;
    return g->nblocks ? g->block[0].cell : NULL;
}

status grid_gather(const struct grid *g, const double *const *values, double *all) {
    const struct share s = share_make(g->comm, g->ncells_all);
    double *mine = NULL;
    long n;
    const int *cell = grid_cells(g, &n);
    TRY(comm_agree(g->comm, allocate(&mine, n, sizeof *mine, "the cells of this rank")));
    double *next = mine;
    for (int b = 0; b < g->nblocks; next += g->block[b++].ncells)
        memcpy(next, values[b], (size_t)g->block[b].ncells * sizeof *mine);
    const status e = share_gather(&s, 1, n, cell, mine, all);
    free(mine);
    return e;
}

status grid_sum(const struct grid *g, const double *per_block, double *sum) {
    double *gathered = NULL, *ordered = NULL;
    *sum = 0;
    TRY(comm_gather(g->comm, per_block, g->nblocks, &gathered, NULL));
    status s = gathered ? allocate(&ordered, g->nblocks_all, sizeof *ordered, "sums of the blocks") : OK;
    for (int b = 0; !s && ordered && b < g->nblocks_all; b++) ordered[g->hidden->block_order[b]] = gathered[b];
    for (int b = 0; !s && ordered && b < g->nblocks_all; b++) *sum += ordered[b];
    free(gathered);
    free(ordered);
    TRY(comm_agree(g->comm, s));
    comm_broadcast(g->comm, sum, sizeof *sum);
    return OK;
}

static void locate_in_polyhedra(const struct grid *g, const double point[3], int *block, int *cell) {
    int found = search_cell(g->hidden->search, point), place = found < 0 ? -1 : g->hidden->place[found];
    *block = *cell = -1;
    if (place < 0) return;
    const int *start = g->polyhedra->block_start;
    for (*block = 0; start[*block + 1] <= place;) ++*block;
    *cell = place - start[*block];
}

void grid_locate(const struct grid *g, const double point[3], int *block, int *cell) {
    if (g->polyhedra)
        locate_in_polyhedra(g, point, block, cell);
    else
        forest_locate(g->forest, point, block, cell);
}
