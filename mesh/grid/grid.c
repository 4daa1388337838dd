/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the grid of a run from a lattice or a polyhedral mesh (grid.h), and gathers, sums and finds values by block. */
#include "mesh/grid/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/base/share.h"
#include "mesh/grid/search.h"
#include "mesh/spread/spread.h"

struct grid_private {
    int *block_order; /* root: [nblocks_all] the blocks' ids, rank by rank */
    double middle[3]; /* m, of a lattice: where axes of one cell have their cells */

    int *cell;                   /* polyhedral: [nown] cells, block by block */
    const struct polymesh *mesh; /* polyhedral: the mesh, or the part of it in which cells are searched for */
    struct mesh_part part;       /* of a mesh that is spread: the cells of this rank and those around */
    const double *centre;        /* [cells of that mesh][3] m */
    double *own_centre;          /* those of the part */
    int *place;                  /* [cells of that mesh] where a cell stands in `cell`, -1: on another rank */
    bool *mine;                  /* [cells of the part] is it of this rank? */
    struct search *search;       /* made when it is wanted */
};

/* A row of 63 cells has 64 faces, which fill one batch of libcore; in 3D planes of 40 x 40 cells stay in L2. */
int grid_tile_size(int dim) {
    return dim == 3 ? 40 : 63;
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
    for (int i = 0; i < m->nown; i++) h->cell[i] = m->cell[m->block_cell[i]];
    for (int b = 0; b < m->nblocks; b++)
        g->block[b] =
            (struct grid_block){m->block_id[b], m->block_start[b + 1] - m->block_start[b], h->cell + m->block_start[b]};
    return OK;
}

static status take_polyhedra(struct grid *g) {
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

static status begin(const struct polymesh *m, const struct comm *c, struct grid **out) {
    struct grid *g = NULL;
    status s = allocate(&g, 1, sizeof *g, "the grid");
    if (!s) s = allocate(&g->hidden, 1, sizeof *g->hidden, "the grid");
    if (!s) {
        g->mesh = m;
        g->comm = c;
        g->ncells_all = m->ncells;
        g->hidden->mesh = m;
    }
    *out = g;
    return comm_agree(c, s);
}

/* Hands the grid over to the caller, or frees it if e is an error. */
static status end(struct grid *g, status e, struct grid **out) {
    if (!e) e = find_order(g);
    *out = e ? NULL : g;
    if (e) grid_free(g);
    return e ? status_up(e, __FILE__, __LINE__) : OK;
}

status grid_make(const struct lattice *l, const struct polymesh *m, const double *centre, const struct comm *c,
                 int rings, bool sized, struct grid **out) {
    struct grid *g;
    status s = begin(m, c, &g);
    if (!s) g->hidden->centre = centre;
    if (!s && l) s = take_forest(g, l);
    if (!s && !l) s = (sized ? polyhedra_make_sized : polyhedra_make)(m, c, rings, &g->polyhedra);
    if (!s && !l) s = take_polyhedra(g);
    return end(g, s, out);
}

status grid_make_spread(const struct polymesh *m, const struct spread *spread, int rings, bool sized,
                        struct grid **out) {
    struct grid *g;
    status s = begin(m, spread->comm, &g);
    if (!s) g->hidden->mesh = &g->hidden->part.mesh;
    if (!s) s = polyhedra_make_spread(m, spread, rings, sized, &g->hidden->part, &g->polyhedra);
    if (!s) s = take_polyhedra(g);
    return end(g, s, out);
}

void grid_settle(struct grid *g) {
    struct grid_private *h = g->hidden;
    free(h->place);
    free(h->mine);
    free(h->own_centre);
    part_free(&h->part);
    search_free(h->search);
    h->place = NULL;
    h->mine = NULL;
    h->own_centre = NULL;
    h->search = NULL;
}

void grid_free(struct grid *g) {
    if (!g) return;
    if (g->hidden) {
        grid_settle(g);
        free(g->hidden->block_order);
        free(g->hidden->cell);
        free(g->hidden);
    }
    forest_free(g->forest);
    polyhedra_free(g->polyhedra);
    free(g->block);
    free(g);
}

double grid_volume(const struct grid *g, int block, int i) {
    const struct polyhedra *m = g->polyhedra;
    const struct forest *f = g->forest;
    if (f && f->radial >= 0) return f->volume * forest_block_radius(f, &f->block[block], i);
    if (f) return f->volume;
    const int cell = m->block_cell[m->block_start[block] + i];
    return m->round.radial >= 0 ? m->thickness * m->volume[cell] : m->extent[cell];
}

void grid_centre(const struct grid *g, int block, int i, double x[3]) {
    if (g->polyhedra) {
        const struct polyhedra *m = g->polyhedra;
        memcpy(x, m->middle[m->block_cell[m->block_start[block] + i]], 3 * sizeof *x);
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

status grid_gather(const struct grid *g, const double *values, double *all) {
    const struct share s = share_make(g->comm, g->ncells_all);
    long n;
    const int *cell = grid_cells(g, &n);
    return share_gather(&s, 1, n, cell, values, all);
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

/* Computes the centres of the cells of the part, those of this rank right. */
static status measure_part(struct grid_private *h) {
    struct polymesh_geometry geometry;
    const status s = polymesh_geometry_make(h->mesh, &geometry);
    h->centre = h->own_centre = geometry.cell_centre;
    geometry.cell_centre = NULL;
    polymesh_geometry_free(&geometry);
    return s;
}

/* Makes the search: through the whole mesh, or among the cells of this rank in its part. */
static status make_search(const struct grid *g) {
    struct grid_private *h = g->hidden;
    const bool part = h->mesh != g->mesh;
    const int n = h->mesh->ncells;
    TRY(allocate(&h->place, n, sizeof *h->place, "the search for a cell"));
    TRY(allocate(&h->mine, n, sizeof *h->mine, "the search for a cell"));
    for (int c = 0; c < n; c++) h->place[c] = -1;
    for (int i = 0; i < g->polyhedra->nown; i++) {
        const long c = part ? part_cell(&h->part, h->cell[i]) : h->cell[i];
        h->place[c] = i;
        h->mine[c] = true;
    }
    if (part) TRY(measure_part(h));
    return search_make_among(h->mesh, h->centre, g->dim, g->axis, part ? h->mine : NULL, &h->search);
}

/* Finds the lowest of the cells of all ranks that hold the point. */
static status locate_in_polyhedra(const struct grid *g, const double point[3], int *block, int *cell) {
    const struct grid_private *h = g->hidden;
    *block = *cell = -1;
    TRY(comm_agree(g->comm, h->search ? OK : make_search(g)));
    int found = search_cell(h->search, point), place = found < 0 ? -1 : h->place[found];
    const double name = place < 0 ? HUGE_VAL : h->cell[place];
    double lowest = name;
    comm_min(g->comm, &lowest, 1);
    if (place < 0 || name > lowest) return OK;
    const int *start = g->polyhedra->block_start;
    for (*block = 0; start[*block + 1] <= place;) ++*block;
    *cell = place - start[*block];
    return OK;
}

status grid_locate(const struct grid *g, const double point[3], int *block, int *cell) {
    if (g->polyhedra) return locate_in_polyhedra(g, point, block, cell);
    forest_locate(g->forest, point, block, cell);
    return OK;
}
