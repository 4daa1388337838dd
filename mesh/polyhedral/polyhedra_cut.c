/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deals a polyhedral mesh to the ranks: cells are sorted along a space-filling curve through their centres and cut into
 * blocks of equal length, the same for any number of ranks; METIS deals the blocks, so that ranks share few faces. Each
 * rank sorts a stretch of the curve. */
#include <limits.h>
#include <metis.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_private.h"

enum { BLOCK = 500, SEED = 1, HALF = 31, BINS = 1 << 16, BIN_BITS = 16, SENT = 3 };

/* ---- the curve --------------------------------------------------------------------------------------------------- */

/* Returns the place on Hilbert's curve of a point of a grid of 2^bits cells a side (J. Skilling, Programming the
 * Hilbert curve, AIP Conf. Proc. 707, 381, 2004). */
static uint64_t hilbert(uint32_t x[3], int dim, int bits) {
    if (dim == 1) return x[0];
    for (uint32_t q = (uint32_t)1 << (bits - 1); q > 1; q >>= 1)
        for (int i = 0; i < dim; i++) {
            const uint32_t t = x[i] & q ? 0 : (x[0] ^ x[i]) & (q - 1);
            x[0] ^= x[i] & q ? q - 1 : t;
            if (!(x[i] & q)) x[i] ^= t;
        }
    for (int i = 1; i < dim; i++) x[i] ^= x[i - 1];
    uint32_t t = 0;
    for (uint32_t q = (uint32_t)1 << (bits - 1); q > 1; q >>= 1)
        if (x[dim - 1] & q) t ^= q - 1;
    for (int i = 0; i < dim; i++) x[i] ^= t;
    uint64_t key = 0;
    for (int b = bits - 1; b >= 0; b--)
        for (int i = 0; i < dim; i++) key = key << 1 | (x[i] >> b & 1);
    return key;
}

static int bits_of(int dim) {
    return dim == 3 ? 20 : HALF;
}

/* Returns the key of a cell: the curve fills a cube of the mesh's longest side. */
static uint64_t key_of(const struct cut_mesh *m, const double *centre) {
    const int bits = bits_of(m->dim);
    const double cells = (double)((uint32_t)1 << bits);
    double side = 0;
    uint32_t x[3] = {0, 0, 0};
    for (int k = 0; k < m->dim; k++)
        if (m->high[m->axis[k]] - m->low[m->axis[k]] > side) side = m->high[m->axis[k]] - m->low[m->axis[k]];
    for (int k = 0; k < m->dim; k++) {
        const double at = (centre[m->axis[k]] - m->low[m->axis[k]]) / side * cells;
        x[k] = !(at > 0) ? 0 : at < cells ? (uint32_t)at : (uint32_t)(cells - 1);
    }
    return hilbert(x, m->dim, bits);
}

static int bin_of(const struct cut_mesh *m, uint64_t key) {
    return (int)(key >> (bits_of(m->dim) * m->dim - BIN_BITS));
}

/* ---- sorting ----------------------------------------------------------------------------------------------------- */

struct curve_place { /* a cell on the curve */
    uint64_t key;
    int cell;
};

static int by_key(const void *a, const void *b) {
    const struct curve_place *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    return (p->cell > q->cell) - (p->cell < q->cell);
}

struct sorting {
    const struct cut_mesh *m;
    long *before;  /* [BINS + 1] cells of all ranks on the curve before a bin */
    uint64_t *key; /* [cells of the slice] */
    struct curve_place *place;
    long n, first; /* cells that this rank sorts; those before them */
};

/* The rank that sorts a bin: each gets about as many cells. */
static int rank_of_bin(const struct sorting *s, int bin) {
    return (int)((double)s->before[bin] * comm_size(s->m->cells.comm) / ((double)s->m->cells.n + 1));
}

static status count_bins(struct sorting *s) {
    const struct cut_mesh *m = s->m;
    const long n = m->cells.end - m->cells.first;
    TRY(allocate(&s->before, BINS + 1L, sizeof *s->before, "the blocks"));
    TRY(allocate(&s->key, n, sizeof *s->key, "the blocks"));
    for (long i = 0; i < n; i++) {
        s->key[i] = key_of(m, m->centre + 3 * i);
        s->before[bin_of(m, s->key[i]) + 1]++;
    }
    return OK;
}

/* Sends the cells of the slice to the ranks that sort them. */
static status send_keys(const struct sorting *s, struct delivery *out) {
    const struct share *cells = &s->m->cells;
    TRY(delivery_begin(cells->comm, cells->end - cells->first, SENT, "the blocks", out));
    for (long i = 0; i < out->n; i++) {
        const int record[SENT] = {(int)(s->key[i] >> HALF), (int)(s->key[i] & INT_MAX), (int)(cells->first + i)};
        out->rank[i] = rank_of_bin(s, bin_of(s->m, s->key[i]));
        memcpy(out->record + SENT * i, record, sizeof record);
    }
    return delivery_send(out);
}

/* Sorts what has arrived. */
static status sort_places(struct sorting *s, const struct delivery *d) {
    const int me = comm_rank(s->m->cells.comm);
    s->n = d->arrived;
    TRY(allocate(&s->place, s->n, sizeof *s->place, "the blocks"));
    for (long i = 0; i < s->n; i++) {
        const int *from = d->in + SENT * i;
        s->place[i] = (struct curve_place){(uint64_t)from[0] << HALF | (uint64_t)from[1], from[2]};
    }
    qsort(s->place, (size_t)s->n, sizeof *s->place, by_key);
    int bin = 0;
    while (bin < BINS && rank_of_bin(s, bin) < me) bin++;
    s->first = s->before[bin];
    return OK;
}

/* Sends the blocks of the sorted cells to the ranks whose slices have these. */
static status send_blocks(const struct sorting *s, struct delivery *out) {
    const struct cut_mesh *m = s->m;
    TRY(delivery_begin(m->cells.comm, s->n, 2, "the blocks", out));
    for (long i = 0; i < s->n; i++) {
        out->rank[i] = share_rank(&m->cells, s->place[i].cell);
        out->record[2 * i] = s->place[i].cell;
        out->record[2 * i + 1] = (int)((s->first + i) * m->nblocks / m->cells.n);
    }
    return delivery_send(out);
}

static status sort_cells(struct sorting *s, int *block) {
    const struct cut_mesh *m = s->m;
    const struct comm *c = m->cells.comm;
    struct delivery keys = {.n = 0}, blocks = {.n = 0};
    TRY(comm_agree(c, count_bins(s)));
    comm_sum_long(c, s->before, BINS + 1);
    for (int b = 0; b < BINS; b++) s->before[b + 1] += s->before[b];
    status e = send_keys(s, &keys);
    if (!e) e = comm_agree(c, sort_places(s, &keys));
    delivery_free(&keys);
    if (!e) e = send_blocks(s, &blocks);
    for (long i = 0; !e && i < blocks.arrived; i++) block[blocks.in[2 * i] - m->cells.first] = blocks.in[2 * i + 1];
    delivery_free(&blocks);
    return e;
}

/* Finds the block of each cell of the slice. */
static status find_blocks(const struct cut_mesh *m, int *block) {
    struct sorting s = {.m = m};
    const status e = sort_cells(&s, block);
    free(s.before);
    free(s.key);
    free(s.place);
    return e;
}

/* ---- ranks ------------------------------------------------------------------------------------------------------- */

struct block_pair { /* blocks a < b that share faces */
    int a, b, faces;
};

static int by_blocks(const void *x, const void *y) {
    const struct block_pair *p = x, *q = y;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

/* Makes one of pairs of the same blocks; returns how many are left. */
static long join_pairs(struct block_pair *pair, long n) {
    long left = 0;
    if (n) qsort(pair, (size_t)n, sizeof *pair, by_blocks);
    for (long i = 0; i < n; i++) {
        if (left && !by_blocks(&pair[left - 1], &pair[i]))
            pair[left - 1].faces += pair[i].faces;
        else
            pair[left++] = pair[i];
    }
    return left;
}

struct pairs {
    struct block_pair *list;
    long n, room;
};

static status add_pair(struct pairs *p, int a, int b) {
    if (a == b) return OK;
    if (p->n == p->room) {
        p->n = join_pairs(p->list, p->n);
        if (2 * p->n >= p->room) {
            const long room = 4 * p->n + 4096;
            struct block_pair *more = realloc(p->list, (size_t)room * sizeof *more);
            if (!more) return fail(ERR_SYSTEM, "no memory for %ld pairs of blocks", room);
            p->list = more;
            p->room = room;
        }
    }
    p->list[p->n++] = (struct block_pair){a < b ? a : b, a < b ? b : a, 1};
    return OK;
}

/* Lists the pairs of blocks that share faces whose owner is in this rank's slice. */
static status list_pairs(const struct cut_mesh *m, const int *block, struct pairs *out) {
    const struct polymesh *mesh = m->mesh;
    for (int f = 0; f < mesh->ninternal; f++)
        if (!m->whole || m->whole[mesh->owner[f]]) TRY(add_pair(out, block[mesh->owner[f]], block[mesh->neighbour[f]]));
    for (int i = 0; i < mesh->npatches; i++) {
        const struct patch *p = &mesh->patch[i];
        const int j = p->neighbour ? polymesh_find_patch(mesh, p->neighbour) : -1;
        for (int k = 0; j > i && k < p->nfaces; k++) {
            const int cell = mesh->owner[p->start + k], other = mesh->owner[mesh->patch[j].start + k];
            if (!m->whole || m->whole[cell]) TRY(add_pair(out, block[cell], block[other]));
        }
    }
    out->n = join_pairs(out->list, out->n);
    return OK;
}

struct graph {
    int n;
    int *start, *to, *weight;
};

static void graph_free(struct graph *g) {
    free(g->start);
    free(g->to);
    free(g->weight);
}

/* Joins blocks that share faces, with the number of these faces as weight; blocks have as many cells, but for one. */
static status graph_make(int nblocks, long n, const struct block_pair *pair, struct graph *g) {
    g->n = nblocks;
    TRY(allocate(&g->start, g->n + 2L, sizeof *g->start, "the graph of the blocks"));
    TRY(allocate(&g->to, 2 * n, sizeof *g->to, "the graph of the blocks"));
    TRY(allocate(&g->weight, 2 * n, sizeof *g->weight, "the graph of the blocks"));
    int *next = g->start + 1;
    for (long i = 0; i < n; i++) next[pair[i].a + 1]++, next[pair[i].b + 1]++;
    for (int b = 0; b < g->n; b++) next[b + 1] += next[b];
    for (long i = 0; i < n; i++)
        for (int side = 0; side < 2; side++) {
            const int at = next[side ? pair[i].b : pair[i].a]++;
            g->to[at] = side ? pair[i].a : pair[i].b;
            g->weight[at] = pair[i].faces;
        }
    return OK;
}

static status graph_cut(const struct graph *g, int parts, int *part) {
    idx_t options[METIS_NOPTIONS], n = g->n, constraints = 1, nparts = parts, cut;
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = SEED;
    options[METIS_OPTION_NUMBERING] = 0;
    const int result = METIS_PartGraphRecursive(&n, &constraints, g->start, g->to, NULL, NULL, g->weight, &nparts, NULL,
                                                NULL, options, &cut, part);
    return result == METIS_OK
               ? OK
               : fail(ERR_SYSTEM, "METIS cannot cut a graph of %d into %d: error %d", g->n, parts, result);
}

/* Gives each rank without a block one of the rank that has most. */
static status fill_ranks(int nblocks, int ranks, int *rank_of) {
    int *count;
    TRY(allocate(&count, ranks, sizeof *count, "the ranks"));
    for (int b = 0; b < nblocks; b++) count[rank_of[b]]++;
    for (int r = 0; r < ranks; r++) {
        int most = 0, b = 0;
        for (int i = 1; i < ranks; i++)
            if (count[i] > count[most]) most = i;
        if (count[r]) continue;
        while (rank_of[b] != most) b++;
        rank_of[b] = r;
        count[most]--;
        count[r]++;
    }
    free(count);
    return OK;
}

static status cut_pairs(const struct cut_mesh *m, int ranks, long n, struct block_pair *pair, int *rank_of) {
    struct graph g = {0};
    for (int b = 0; b < m->nblocks; b++) rank_of[b] = b;
    if (m->nblocks <= ranks) return OK; /* some ranks stay without */
    n = join_pairs(pair, n);
    status s = graph_make(m->nblocks, n, pair, &g);
    if (!s) s = graph_cut(&g, ranks, rank_of);
    graph_free(&g);
    return s ? s : fill_ranks(m->nblocks, ranks, rank_of);
}

/* Deals the blocks; only the root asks METIS, so that all ranks have the same answer. */
static status deal_blocks(const struct cut_mesh *m, const struct comm *c, const int *block, int *rank_of) {
    struct pairs pairs = {0};
    int *all = NULL;
    long ints = 0;
    status s = comm_agree(c, list_pairs(m, block, &pairs));
    if (!s) s = comm_gather_int(m->cells.comm, (int *)(void *)pairs.list, 3 * pairs.n, &all, &ints);
    free(pairs.list);
    if (!s && comm_root(c)) s = cut_pairs(m, comm_size(c), ints / 3, (struct block_pair *)(void *)all, rank_of);
    free(all);
    TRY(comm_agree(c, s));
    comm_broadcast(c, rank_of, m->nblocks * (long)sizeof *rank_of);
    return OK;
}

/* Finds the blocks of all cells of the mesh at hand, from those of the slices. */
static status fetch_blocks(const struct cut_mesh *m, const int *slice, int *block) {
    const long n = m->cells.end - m->cells.first;
    double *mine = NULL, *all = NULL;
    if (!m->whole) {
        memcpy(block, slice, (size_t)n * sizeof *block);
        return OK;
    }
    status e = allocate(&mine, n, sizeof *mine, "the blocks");
    if (!e) e = allocate(&all, m->mesh->ncells, sizeof *all, "the blocks");
    e = comm_agree(m->cells.comm, e);
    for (long i = 0; !e && i < n; i++) mine[i] = slice[i];
    if (!e) e = share_fetch(&m->cells, 1, mine, m->mesh->ncells, m->cell, all);
    for (long i = 0; !e && i < m->mesh->ncells; i++) block[i] = (int)all[i];
    free(mine);
    free(all);
    return e;
}

status cut_cells(struct cut_mesh *m, const struct comm *c, struct cut *cut) {
    const long n = m->cells.end - m->cells.first;
    *cut = (struct cut){.cells = m->cells};
    m->nblocks = (int)(m->cells.n / BLOCK > 1 ? m->cells.n / BLOCK : 1);
    cut->nblocks = m->nblocks;
    int *block = NULL;
    status s = allocate(&cut->block, n, sizeof *cut->block, "the blocks");
    if (!s) s = allocate(&cut->rank_of, m->nblocks, sizeof *cut->rank_of, "the blocks");
    if (!s) s = allocate(&block, m->mesh->ncells, sizeof *block, "the blocks");
    s = comm_agree(c, s);
    if (!s) s = find_blocks(m, cut->block);
    if (!s && comm_size(c) > 1) s = fetch_blocks(m, cut->block, block);
    if (!s && comm_size(c) > 1) s = deal_blocks(m, c, block, cut->rank_of);
    free(block);
    return s;
}

void cut_cells_free(struct cut *cut) {
    free(cut->block);
    free(cut->rank_of);
    *cut = (struct cut){.nblocks = 0};
}
