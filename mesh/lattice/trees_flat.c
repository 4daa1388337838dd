/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets p4est deal the tiles of a lattice to the ranks (trees.h). This file is compiled twice: as it stands for p4est
 * (1D, 2D), and through trees_solid.c for p8est (3D), where p4est_to_p8est.h renames p4est's functions. */
#include "mesh/lattice/trees.h"

#include <stdlib.h>

#ifndef P4_TO_P8
#include <p4est_bits.h>
#include <p4est_extended.h>
#define ENGINE trees_flat
#else
#include <p8est_bits.h>
#include <p8est_extended.h>
#define ENGINE trees_solid
#endif

struct trees_state {
    p4est_connectivity_t *connectivity;
    p4est_t *forest;
};
struct load { /* what `weight` needs */
    const struct trees_tile *all;
    long largest;
};

static void make_vertices(p4est_connectivity_t *k, const struct trees_tile *tile, int t) {
    for (int corner = 0; corner < P4EST_CHILDREN; corner++) {
        int vertex = t * P4EST_CHILDREN + corner;
        k->tree_to_vertex[vertex] = vertex;
        for (int a = 0; a < 3; a++) k->vertices[3 * vertex + a] = tile->low[a] + (corner >> a & 1) * tile->n[a];
    }
}

/* Makes p4est's table of neighbours. Trees are joined at faces only, because the ghost layers have no corners. Vertices
 * only serve pictures; each tree has its own. */
static p4est_connectivity_t *make_connectivity(const struct trees_tile *all, int nall) {
#ifndef P4_TO_P8
    p4est_connectivity_t *k = p4est_connectivity_new(nall * P4EST_CHILDREN, nall, 0, 0);
#else
    p4est_connectivity_t *k = p4est_connectivity_new(nall * P4EST_CHILDREN, nall, 0, 0, 0, 0);
#endif
    for (int t = 0; t < nall; t++) {
        make_vertices(k, &all[t], t);
        for (int face = 0; face < P4EST_FACES; face++) {
            int neighbour = all[t].neighbour[face];
            k->tree_to_tree[t * P4EST_FACES + face] = neighbour < 0 ? t : neighbour;
            k->tree_to_face[t * P4EST_FACES + face] = (int8_t)(neighbour < 0 ? face : face ^ 1);
        }
    }
    return k;
}

static int weight(p4est_t *forest, p4est_topidx_t tree, p4est_quadrant_t *quadrant) {
    const struct load *load = forest->user_pointer;
    (void)quadrant;
    return trees_weight(&load->all[tree], load->largest);
}

static status start(struct trees *t, const struct comm *c, const struct trees_tile *all, int nall) {
    TRY(comm_agree(c, allocate(&t->state, 1, sizeof *t->state, "the p4est objects")));
    struct trees_state *s = t->state;
    struct load load = {all, trees_largest(all, nall)};
    sc_set_log_defaults(NULL, NULL, SC_LP_ERROR);
    s->connectivity = make_connectivity(all, nall);
    if (!p4est_connectivity_is_valid(s->connectivity))
        return fail(ERR_SYSTEM, "p4est finds the neighbours of the tiles inconsistent: please report this mesh");
    s->forest = p4est_new_ext(*(sc_MPI_Comm *)comm_handle(c), s->connectivity, 0, 0, 1, 0, NULL, &load);
    p4est_partition(s->forest, 0, weight);
    s->forest->user_pointer = NULL;
    t->count = s->forest->local_num_quadrants;
    TRY(comm_agree(c, allocate(&t->start, comm_size(c) + 1L, sizeof *t->start, "the first tiles of the ranks")));
    for (int r = 0; r <= comm_size(c); r++) t->start[r] = (int)s->forest->global_first_quadrant[r];
    t->first = t->start[comm_rank(c)];
    return OK;
}

static void stop(struct trees *t) {
    struct trees_state *s = t->state;
    if (!s) return;
    if (s->forest) p4est_destroy(s->forest);
    if (s->connectivity) p4est_connectivity_destroy(s->connectivity);
    free(s);
}

const struct trees_engine ENGINE = {start, stop};
