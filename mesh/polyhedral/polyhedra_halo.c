/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deals a polyhedral mesh to the ranks and exchanges ghosts: METIS cuts the mesh into blocks and the blocks into ranks;
 * one message per neighbour rank fills the ghosts. */
#include <metis.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_private.h"

enum { BLOCK = 500, SEED = 1 };

/* ---- blocks and ranks -------------------------------------------------------------------------------------------- */

struct graph {
    int n;
    int *start, *to, *weight, *vertex_weight; /* weights of edges and vertices may be NULL */
};

static void graph_free(struct graph *g) {
    free(g->start);
    free(g->to);
    free(g->weight);
    free(g->vertex_weight);
}

/* Is the graph connected? METIS refuses to look for contiguous parts of a graph that is not. */
static status find_connected(const struct graph *g, bool *connected) {
    int *queue, *seen, n = 1;
    TRY(allocate(&queue, 2L * g->n, sizeof *queue, "the graph of the cells"));
    seen = queue + g->n;
    seen[0] = 1;
    for (int out = 0; out < n; out++)
        for (int i = g->start[queue[out]]; i < g->start[queue[out] + 1]; i++)
            if (!seen[g->to[i]]++) queue[n++] = g->to[i];
    *connected = n == g->n;
    free(queue);
    return OK;
}

static status graph_cut(const struct graph *g, int parts, bool by_bisection, int *part) {
    if (parts == 1 || g->n == 0) return OK; /* part is all zeros already */
    idx_t options[METIS_NOPTIONS], n = g->n, constraints = 1, nparts = parts, cut;
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = SEED;
    options[METIS_OPTION_NUMBERING] = 0;
    bool contiguous = false;
    if (!by_bisection) TRY(find_connected(g, &contiguous));
    options[METIS_OPTION_CONTIG] = contiguous;
    int result = (by_bisection ? METIS_PartGraphRecursive : METIS_PartGraphKway)(
        &n, &constraints, g->start, g->to, g->vertex_weight, NULL, g->weight, &nparts, NULL, NULL, options, &cut, part);
    return result == METIS_OK
               ? OK
               : fail(ERR_SYSTEM, "METIS cannot cut a graph of %d into %d: error %d", g->n, parts, result);
}

static status graph_of_cells(const struct links *l, struct graph *g) {
    const int ncells = l->mesh->ncells;
    g->n = ncells;
    TRY(allocate(&g->start, ncells + 1L, sizeof *g->start, "the graph of the cells"));
    TRY(allocate(&g->to, l->cell_start[ncells], sizeof *g->to, "the graph of the cells"));
    int n = 0, image;
    for (int c = 0; c < ncells; c++) {
        for (int i = l->cell_start[c]; i < l->cell_start[c + 1]; i++) {
            int to = links_cross(l, l->cell_link[i], 0, &image);
            if (to >= 0 && to != c) g->to[n++] = to;
        }
        g->start[c + 1] = n;
    }
    return OK;
}

/* Lists the cells by block, in the order of the polyMesh; blocks without cells are dropped. */
static status list_blocks(struct cut *cut, int ncells) {
    int *number, n = 0;
    TRY(allocate(&cut->start, cut->nblocks + 2L, sizeof *cut->start, "the blocks"));
    TRY(allocate(&cut->order, ncells, sizeof *cut->order, "the blocks"));
    TRY(allocate(&number, cut->nblocks, sizeof *number, "the blocks"));
    for (int c = 0; c < ncells; c++) number[cut->block_of[c]] = 1;
    for (int b = 0; b < cut->nblocks; b++) number[b] = number[b] ? n++ : -1;
    cut->nblocks = n;
    int *start = cut->start + 1; /* start[b]: place of the next cell of block b while `order` fills */
    for (int c = 0; c < ncells; c++) {
        cut->block_of[c] = number[cut->block_of[c]];
        start[cut->block_of[c] + 1]++;
    }
    for (int b = 0; b < n; b++) start[b + 1] += start[b];
    for (int c = 0; c < ncells; c++) cut->order[start[cut->block_of[c]]++] = c;
    free(number);
    return OK;
}

/* Orders the cells of each block breadth first from its lowest cell, so that neighbours stand near each other. */
static status order_blocks(const struct links *l, struct cut *cut) {
    int *queue, *done;
    const int ncells = l->mesh->ncells;
    TRY(allocate(&queue, 2L * ncells, sizeof *queue, "the order of the cells"));
    done = queue + ncells;
    int in = 0, image;
    for (int b = 0; b < cut->nblocks; b++)
        for (int k = cut->start[b], out = in; k < cut->start[b + 1]; k++) {
            if (done[cut->order[k]]) continue;
            done[cut->order[k]] = 1;
            for (queue[in++] = cut->order[k]; out < in; out++)
                for (int c = queue[out], i = l->cell_start[c]; i < l->cell_start[c + 1]; i++) {
                    int to = links_cross(l, l->cell_link[i], 0, &image);
                    if (to < 0 || done[to] || cut->block_of[to] != b) continue;
                    done[to] = 1;
                    queue[in++] = to;
                }
        }
    memcpy(cut->order, queue, (size_t)ncells * sizeof *queue);
    free(queue);
    return OK;
}

/* Makes the graph of blocks: blocks that share faces are joined, with the number of these faces as weight. */
static status graph_of_blocks(const struct links *l, const struct cut *cut, struct graph *g) {
    int *place, n = 0, image, room = l->cell_start[l->mesh->ncells];
    g->n = cut->nblocks;
    TRY(allocate(&g->start, g->n + 1L, sizeof *g->start, "the graph of the blocks"));
    TRY(allocate(&g->vertex_weight, g->n, sizeof *g->vertex_weight, "the graph of the blocks"));
    TRY(allocate(&g->to, room, sizeof *g->to, "the graph of the blocks"));
    TRY(allocate(&g->weight, room, sizeof *g->weight, "the graph of the blocks"));
    TRY(allocate(&place, g->n, sizeof *place, "the graph of the blocks"));
    for (int b = 0; b < g->n; b++) place[b] = -1;
    for (int b = 0; b < g->n; b++) {
        for (int k = cut->start[b]; k < cut->start[b + 1]; k++)
            for (int c = cut->order[k], i = l->cell_start[c]; i < l->cell_start[c + 1]; i++) {
                int to = links_cross(l, l->cell_link[i], 0, &image);
                if (to < 0 || cut->block_of[to] == b) continue;
                int other = cut->block_of[to];
                if (place[other] < g->start[b]) {
                    place[other] = n;
                    g->to[n++] = other;
                }
                g->weight[place[other]]++;
            }
        g->vertex_weight[b] = cut->start[b + 1] - cut->start[b];
        g->start[b + 1] = n;
    }
    free(place);
    return OK;
}

/* Gives each rank without a block one of the rank that has most; with fewer blocks than ranks some stay without. */
static status fill_ranks(struct cut *cut, int ranks) {
    int *count;
    TRY(allocate(&count, ranks, sizeof *count, "the ranks"));
    for (int b = 0; b < cut->nblocks; b++) count[cut->rank_of[b]]++;
    for (int r = 0; r < ranks; r++) {
        int most = 0, b = 0;
        for (int i = 1; i < ranks; i++)
            if (count[i] > count[most]) most = i;
        if (count[r] || count[most] < 2) continue;
        while (cut->rank_of[b] != most) b++;
        cut->rank_of[b] = r;
        count[most]--;
        count[r]++;
    }
    free(count);
    return OK;
}

static status cut_to_blocks(const struct links *l, struct cut *cut) {
    struct graph g = {0};
    status s = graph_of_cells(l, &g);
    if (!s) s = graph_cut(&g, cut->nblocks, false, cut->block_of);
    graph_free(&g);
    return s;
}

static status cut_to_ranks(const struct links *l, int ranks, struct cut *cut) {
    struct graph g = {0};
    status s = graph_of_blocks(l, cut, &g);
    if (!s) s = graph_cut(&g, ranks, true, cut->rank_of);
    graph_free(&g);
    return s ? s : fill_ranks(cut, ranks);
}

/* Cuts the cells into blocks and the blocks into ranks. Only the root asks METIS, so that all ranks have the same
 * answer. */
status cut_cells(const struct links *l, const struct comm *c, struct cut *cut) {
    const int ncells = l->mesh->ncells, wanted = ncells / BLOCK > 1 ? ncells / BLOCK : 1;
    *cut = (struct cut){.nblocks = wanted};
    status s = allocate(&cut->block_of, ncells, sizeof *cut->block_of, "the blocks");
    if (!s) s = allocate(&cut->rank_of, wanted, sizeof *cut->rank_of, "the blocks");
    if (!s && comm_root(c)) s = cut_to_blocks(l, cut);
    TRY(comm_agree(c, s));
    comm_broadcast(c, cut->block_of, ncells * (long)sizeof *cut->block_of);
    s = list_blocks(cut, ncells);
    if (!s) s = order_blocks(l, cut);
    if (!s && comm_root(c) && comm_size(c) > 1) s = cut_to_ranks(l, comm_size(c), cut);
    TRY(comm_agree(c, s));
    comm_broadcast(c, cut->rank_of, cut->nblocks * (long)sizeof *cut->rank_of);
    return OK;
}

void cut_cells_free(struct cut *cut) {
    free(cut->block_of);
    free(cut->rank_of);
    free(cut->start);
    free(cut->order);
}

/* ---- ghosts ------------------------------------------------------------------------------------------------------ */

/* Gives every rank the ghosts of all ranks: polyMesh cells in `all`, rank r's from start[r] to start[r + 1]. */
static status share_ghosts(const struct polyhedra *m, int *start, int **all) {
    const int ranks = comm_size(m->comm), nghosts = m->ncells - m->nown;
    int *counts = NULL;
    long total = 0;
    TRY(comm_gather_int(m->comm, &nghosts, 1, &counts, NULL));
    for (int r = 0; counts && r < ranks; r++) start[r + 1] = start[r] + counts[r];
    free(counts);
    comm_broadcast(m->comm, start, (ranks + 1) * (long)sizeof *start);
    TRY(comm_gather_int(m->comm, m->cell + m->nown, nghosts, all, &total));
    status s = *all ? OK : allocate(all, start[ranks], sizeof **all, "the ghosts of all ranks");
    TRY(comm_agree(m->comm, s));
    comm_broadcast(m->comm, *all, start[ranks] * (long)sizeof **all);
    return OK;
}

/* Plans link by link which cells leave (in the order of the receiver's ghosts) and which arrive. */
static status plan(struct polyhedra *m, const int *rank, const int *local, const int *start, const int *all) {
    struct polyhedra_private *h = m->hidden;
    const int ranks = comm_size(m->comm), nghosts = m->ncells - m->nown;
    TRY(allocate(&h->link, ranks, sizeof *h->link, "the exchange of ghosts"));
    TRY(allocate(&h->send_start, ranks + 1L, sizeof *h->send_start, "the exchange of ghosts"));
    TRY(allocate(&h->receive_start, ranks + 1L, sizeof *h->receive_start, "the exchange of ghosts"));
    TRY(allocate(&h->receive, nghosts, sizeof *h->receive, "the exchange of ghosts"));
    TRY(allocate(&h->send, start[ranks], sizeof *h->send, "the exchange of ghosts"));
    for (int r = 0, sent = 0, received = 0; r < ranks; r++) {
        if (r == comm_rank(m->comm)) continue;
        for (int i = start[r]; i < start[r + 1]; i++)
            if (local[all[i]] >= 0 && local[all[i]] < m->nown) h->send[sent++] = local[all[i]];
        for (int i = 0; i < nghosts; i++)
            if (rank[i] == r) h->receive[received++] = m->nown + i;
        int n = sent - h->send_start[h->nlinks], arrive = received - h->receive_start[h->nlinks];
        if (n == 0 && arrive == 0) continue;
        h->link[h->nlinks++] = (struct comm_link){.rank = r, .n = n > arrive ? n : arrive};
        h->send_start[h->nlinks] = sent;
        h->receive_start[h->nlinks] = received;
    }
    return OK;
}

static status make_buffers(struct polyhedra *m) {
    struct polyhedra_private *h = m->hidden;
    for (int i = 0; i < h->nlinks; i++) {
        long n = h->link[i].n * POLYHEDRA_VARIABLES;
        TRY(allocate(&h->link[i].out, n, sizeof *h->link[i].out, "the exchange of ghosts"));
        TRY(allocate(&h->link[i].in, n, sizeof *h->link[i].in, "the exchange of ghosts"));
    }
    return comm_exchange_make(m->comm, h->nlinks, h->link, &h->exchange);
}

status halo_make(struct polyhedra *m, const int *rank, const int *local) {
    int *start = NULL, *all = NULL;
    TRY(comm_agree(m->comm, allocate(&start, comm_size(m->comm) + 1L, sizeof *start, "the ghosts of all ranks")));
    status s = share_ghosts(m, start, &all);
    if (!s) {
        s = plan(m, rank, local, start, all);
        if (!s) s = make_buffers(m);
        s = comm_agree(m->comm, s);
    }
    free(start);
    free(all);
    return s;
}

void halo_free(struct polyhedra_private *h) {
    comm_exchange_free(h->exchange);
    for (int i = 0; i < h->nlinks; i++) {
        free(h->link[i].out);
        free(h->link[i].in);
    }
    free(h->link);
    free(h->send_start);
    free(h->send);
    free(h->receive_start);
    free(h->receive);
}

void polyhedra_fill_start(struct polyhedra *m, int nvar, double *const *data) {
    struct polyhedra_private *h = m->hidden;
    h->nvar = nvar;
    h->data = data;
    for (int i = 0; i < h->nlinks; i++) {
        const int *cell = h->send + h->send_start[i], n = h->send_start[i + 1] - h->send_start[i];
        for (int v = 0; v < nvar; v++)
            for (int j = 0; j < n; j++) h->link[i].out[v * h->link[i].n + j] = data[v][cell[j]];
    }
    comm_exchange_start(h->exchange, nvar);
}

void polyhedra_fill_finish(struct polyhedra *m) {
    struct polyhedra_private *h = m->hidden;
    comm_exchange_finish(h->exchange);
    for (int i = 0; i < h->nlinks; i++) {
        const int *ghost = h->receive + h->receive_start[i], n = h->receive_start[i + 1] - h->receive_start[i];
        for (int v = 0; v < h->nvar; v++)
            for (int j = 0; j < n; j++) h->data[v][ghost[j]] = h->link[i].in[v * h->link[i].n + j];
    }
}
