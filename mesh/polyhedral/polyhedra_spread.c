/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the struct polyhedra of a rank where the mesh is spread over the ranks (mesh/spread): deals the cells, and
 * fetches those around a rank's own until their stencils are complete. */
#include <stdlib.h>
#include <string.h>

#include "mesh/base/sorted.h"
#include "mesh/polyhedral/polyhedra_make_private.h"

static status cut_spread(struct work *w, const struct polymesh *all) {
    const struct spread *s = w->spread;
    struct cut_mesh m = {.mesh = &s->home.mesh,
                         .whole = s->home.whole,
                         .cell = s->home.cell,
                         .cells = s->cells,
                         .centre = s->geometry.cell_centre + 3L * s->base};
    m.dim = polymesh_axes(all, m.axis);
    polymesh_bounds(all, m.low, m.high);
    return cut_cells(&m, s->comm, &w->cut);
}

/* Sends each rank the cells of its blocks. */
static status send_blocks(struct polyhedra *m, struct work *w) {
    const struct cut *cut = &w->cut;
    const long n = cut->cells.end - cut->cells.first;
    struct delivery d;
    status s = delivery_begin(m->comm, n, 2, "the blocks", &d);
    for (long i = 0; !s && i < n; i++) {
        d.rank[i] = cut->rank_of[cut->block[i]];
        d.record[2 * i] = cut->block[i];
        d.record[2 * i + 1] = (int)(cut->cells.first + i);
    }
    if (!s) s = delivery_send(&d);
    if (!s) s = comm_agree(m->comm, work_blocks(m, w, d.arrived, (int(*)[2])(void *)d.in));
    delivery_free(&d);
    return s;
}

struct known { /* cells by their numbers in the whole mesh, ascending */
    int *cell;
    long n;
};

/* Adds n cells. */
static status know(struct known *k, long n, const int *cell) {
    int *more = realloc(k->cell, (size_t)(k->n + n + 1) * sizeof *more);
    if (!more) return fail(ERR_SYSTEM, "no memory for a list of %ld cells", k->n + n);
    k->cell = more;
    if (n) memcpy(k->cell + k->n, cell, (size_t)n * sizeof *cell);
    k->n += n;
    return sorted_make(k->cell, &k->n);
}

/* Lists the cells of a part that are not whole there and not known. */
static status list_beyond(const struct mesh_part *p, const struct known *k, struct known *out) {
    *out = (struct known){.n = 0};
    TRY(allocate(&out->cell, p->mesh.ncells, sizeof *out->cell, "the cells around those of a rank"));
    for (int c = 0; c < p->mesh.ncells; c++)
        if (!p->whole[c] && sorted_find(k->cell, k->n, p->cell[c]) < 0) out->cell[out->n++] = p->cell[c];
    return OK;
}

/* Finds my cells and those in `depth` rings around them. */
static status find_rings(struct polyhedra *m, struct work *w, const struct polymesh *all, int depth, struct known *k) {
    struct known ring = {.n = 0};
    status s = comm_agree(m->comm, know(k, m->nown, w->mine));
    if (!s) s = comm_agree(m->comm, know(&ring, m->nown, w->mine));
    for (int i = 0; i < depth && !s; i++) {
        struct mesh_part p;
        s = spread_part(w->spread, all, ring.n, ring.cell, &p);
        free(ring.cell);
        ring.cell = NULL;
        if (!s) s = list_beyond(&p, k, &ring);
        part_free(&p);
        if (!s) s = know(k, ring.n, ring.cell);
        s = comm_agree(m->comm, s);
    }
    free(ring.cell);
    return s;
}

/* Makes the links of the cells that are known, with my cells by their numbers there. */
static status join_part(struct polyhedra *m, struct work *w, const struct polymesh *all, const struct known *k) {
    double *block = NULL, *mine = NULL;
    const struct cut *cut = &w->cut;
    const long n = cut->cells.end - cut->cells.first;
    part_free(w->part);
    TRY(spread_part(w->spread, all, k->n, k->cell, w->part));
    status s = links_make(&w->pool, all, w->part, &w->links);
    const int ncells = w->part->mesh.ncells;
    if (!s) s = pool_take(&w->pool, &w->block_of, ncells, sizeof *w->block_of, "the blocks");
    if (!s) s = allocate(&block, ncells, sizeof *block, "the blocks");
    if (!s) s = allocate(&mine, n, sizeof *mine, "the blocks");
    s = comm_agree(m->comm, s);
    for (long i = 0; !s && i < n; i++) mine[i] = cut->block[i];
    if (!s) s = share_fetch(&cut->cells, 1, mine, ncells, w->part->cell, block);
    for (int c = 0; !s && c < ncells; c++) w->block_of[c] = (int)block[c];
    for (int i = 0; !s && i < m->nown; i++) w->mine[i] = (int)part_cell(w->part, w->mine[i]);
    free(block);
    free(mine);
    return s;
}

/* Adds members of stencils that are not whole to the known cells; *lacks: has this rank such members? */
static status know_members(const struct work *w, struct known *k, bool *lacks) {
    int *cell = NULL;
    long n = 0;
    TRY(allocate(&cell, w->nghosts, sizeof *cell, "the cells around those of a rank"));
    for (int i = 0; i < w->nghosts; i++)
        if (!w->part->whole[w->ghost[i].cell]) cell[n++] = w->part->cell[w->ghost[i].cell];
    const status s = know(k, n, cell);
    free(cell);
    *lacks = n > 0;
    return s;
}

/* Frees what was made of too few cells. */
static void start_again(struct polyhedra *m, struct work *w) {
    for (int i = 0; i < m->nown; i++) w->mine[i] = links_cell_name(&w->links, w->mine[i]);
    pool_free(&w->pool);
    w->nghosts = 0;
}

/* Fetches cells until all stencils are there: a few grow by further rings. */
static status fetch_cells(struct polyhedra *m, struct work *w, const struct polymesh *all, int rings, struct known *k) {
    for (double lacking = 1; lacking > 0;) {
        bool lacks = false;
        TRY(join_part(m, w, all, k));
        status s = work_cells(m, w, rings);
        if (!s) s = know_members(w, k, &lacks);
        TRY(comm_agree(m->comm, s));
        lacking = lacks;
        comm_max(m->comm, &lacking, 1);
        if (lacking > 0) start_again(m, w);
    }
    return OK;
}

status work_spread(struct polyhedra *m, const struct polymesh *all, struct work *w, int rings) {
    struct known k = {.n = 0};
    TRY(cut_spread(w, all));
    TRY(send_blocks(m, w));
    status s = find_rings(m, w, all, 1 + rings, &k);
    if (!s) s = fetch_cells(m, w, all, rings, &k);
    free(k.cell);
    TRY(s);
    return comm_agree(m->comm, work_local(m, w, rings));
}
