/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Systems on cells of a grid that is cut into blocks, for the tests and the benchmark of the multigrid: links between
 * neighbours with weights 1/rho of rho that jumps from cell to cell, and holes. */
#ifndef TESTS_MULTIGRID_GRID_H
#define TESTS_MULTIGRID_GRID_H

#include "libcore/multigrid/multigrid.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct mg_case {
    int dim, n[3], block[3];
    bool periodic;
    double contrast; /* of rho, largest over smallest */
    double shift;    /* row sums as parts of the sum of weights */
    double holes;    /* part of the cells that is absent */
    bool dealt;      /* are blocks dealt out to the ranks in turn? else in pieces */
};

struct mg_grid {
    const struct mg_case *o;
    struct multigrid_rows rows;
    int *first, *number, *link_first, *link, *cell; /* cell: [rows + ghosts] in the whole grid */
    double *weight, *diagonal, *b, *x;
    int links, *owner, *place; /* [cells] rank, -1: absent; index on this rank, -1: not there */
    int nlinks;
    struct comm_link *exchange_link;
    int **send;
    int *send_count, *ghost_count;
    struct comm_exchange *exchange;
};

/* A number in [0, 1) for i. */
static inline double mg_random(uint64_t i) {
    i = (i + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    i = (i ^ (i >> 29)) * 0x94d049bb133111ebu;
    i = (i ^ (i >> 32)) * 0xbf58476d1ce4e5b9u;
    return (double)((i ^ (i >> 30)) >> 11) / 9007199254740992.0;
}

static inline long mg_cells(const struct mg_case *o) {
    return (long)o->n[0] * o->n[1] * o->n[2];
}

/* The neighbour of a cell on side s of axis s/2; -1 if there is none. */
static inline long mg_neighbour(const struct mg_grid *g, long c, int s) {
    const struct mg_case *o = g->o;
    long stride[3] = {1, o->n[0], (long)o->n[0] * o->n[1]};
    const int k = s / 2;
    long i = c / stride[k] % o->n[k], to = i + (s % 2 ? 1 : -1);
    if (o->periodic && o->n[k] > 1) to = (to + o->n[k]) % o->n[k];
    if (to < 0 || to >= o->n[k]) return -1;
    c += (to - i) * stride[k];
    return g->owner[c] < 0 ? -1 : c;
}

static inline double mg_weight(const struct mg_case *o, long a, long b) {
    const double ra = pow(o->contrast, mg_random((uint64_t)a)), rb = pow(o->contrast, mg_random((uint64_t)b));
    return 2 / (ra + rb);
}

static inline void mg_send(void *context, const double *x) {
    struct mg_grid *g = context;
    for (int k = 0; k < g->nlinks; k++)
        for (long i = 0; i < g->send_count[k]; i++) g->exchange_link[k].out[i] = x[g->send[k][i]];
    comm_exchange_start(g->exchange, 1);
}

static inline void mg_receive(void *context, double *x) {
    struct mg_grid *g = context;
    comm_exchange_finish(g->exchange);
    for (int k = 0, to = g->rows.rows; k < g->nlinks; k++)
        for (long i = 0; i < g->ghost_count[k]; i++) x[to++] = g->exchange_link[k].in[i];
}

static inline void mg_find_rows(struct mg_grid *g, const struct comm *c) {
    const struct mg_case *o = g->o;
    int blocks[3], all = 1, b[3], rank = comm_rank(c), size = comm_size(c);
    for (int k = 0; k < 3; k++) all *= blocks[k] = (o->n[k] + o->block[k] - 1) / o->block[k];
    g->first = calloc((size_t)all + 1, sizeof(int));
    g->number = calloc((size_t)all + 1, sizeof(int));
    for (int j = 0; j < all; j++) {
        const int owner = o->dealt ? j % size : (int)((long)j * size / all);
        b[0] = j % blocks[0] * o->block[0];
        b[1] = j / blocks[0] % blocks[1] * o->block[1];
        b[2] = j / blocks[0] / blocks[1] * o->block[2];
        for (int z = b[2]; z < b[2] + o->block[2] && z < o->n[2]; z++)
            for (int y = b[1]; y < b[1] + o->block[1] && y < o->n[1]; y++)
                for (int x = b[0]; x < b[0] + o->block[0] && x < o->n[0]; x++) {
                    const long i = x + o->n[0] * (y + (long)o->n[1] * z);
                    if (mg_random((uint64_t)(i + mg_cells(o))) < o->holes) continue;
                    g->owner[i] = owner;
                    if (owner != rank) continue;
                    g->cell[g->rows.rows] = (int)i;
                    g->place[i] = g->rows.rows++;
                }
        if (owner != rank) continue;
        g->number[g->rows.blocks++] = 3 * j + 1;
        g->first[g->rows.blocks] = g->rows.rows;
    }
}

/* Ghosts lie rank by rank, in the order of the whole grid. */
static inline void mg_find_ghosts(struct mg_grid *g, const struct comm *c) {
    const int rank = comm_rank(c);
    g->exchange_link = calloc((size_t)comm_size(c), sizeof *g->exchange_link);
    g->send = calloc((size_t)comm_size(c), sizeof *g->send);
    g->send_count = calloc(2 * (size_t)comm_size(c), sizeof(int));
    g->ghost_count = g->send_count + comm_size(c);
    for (int q = 0; q < comm_size(c); q++) {
        struct comm_link *l = &g->exchange_link[g->nlinks];
        int *send = calloc((size_t)g->rows.rows + 1, sizeof *send), n = 0, ghosts = 0;
        for (long i = 0; i < mg_cells(g->o) && q != rank; i++) {
            bool linked = false;
            const bool mine = g->owner[i] == rank, theirs = g->owner[i] == q;
            for (int s = 0; s < 2 * g->o->dim && (mine || theirs); s++) {
                const long j = mg_neighbour(g, i, s);
                linked |= j >= 0 && g->owner[j] == (mine ? q : rank);
            }
            if (linked && mine) send[n++] = g->place[i];
            if (!linked || mine) continue;
            g->cell[g->rows.rows + g->rows.ghosts] = (int)i;
            g->place[i] = g->rows.rows + g->rows.ghosts++;
            ghosts++;
        }
        if (n) { /* both ways the same length, as a comm_link has */
            const int most = n > ghosts ? n : ghosts;
            *l =
                (struct comm_link){q, most, calloc((size_t)most, sizeof(double)), calloc((size_t)most, sizeof(double))};
            g->send_count[g->nlinks] = n;
            g->ghost_count[g->nlinks] = ghosts;
            g->send[g->nlinks++] = send;
        } else {
            free(send);
        }
    }
}

static inline void mg_find_links(struct mg_grid *g) {
    const struct mg_case *o = g->o;
    g->link_first = calloc((size_t)g->rows.rows + 1, sizeof(int));
    g->link = calloc(6 * (size_t)g->rows.rows + 1, sizeof(int));
    g->weight = calloc(6 * (size_t)g->rows.rows + 1, sizeof(double));
    g->diagonal = calloc((size_t)g->rows.rows + 1, sizeof(double));
    g->b = calloc((size_t)g->rows.rows + 1, sizeof(double));
    g->x = calloc((size_t)(g->rows.rows + g->rows.ghosts) + 1, sizeof(double));
    for (int i = 0; i < g->rows.rows; i++) {
        double sum = 0;
        for (int s = 0; s < 2 * o->dim; s++) {
            const long j = mg_neighbour(g, g->cell[i], s);
            if (j < 0) continue;
            g->link[g->links] = g->place[j];
            sum += g->weight[g->links++] = mg_weight(o, g->cell[i], j);
        }
        g->link_first[i + 1] = g->links;
        g->diagonal[i] = sum > 0 ? sum * (1 + o->shift) : 1;
        g->b[i] = mg_random((uint64_t)(g->cell[i] + 7 * mg_cells(o))) - 0.5;
    }
}

static inline void mg_open(struct mg_grid *g, const struct mg_case *o, const struct comm *c) {
    *g = (struct mg_grid){.o = o};
    const size_t n = (size_t)mg_cells(o);
    g->owner = malloc(n * sizeof(int));
    g->place = malloc(n * sizeof(int));
    g->cell = malloc(n * sizeof(int));
    for (size_t i = 0; i < n; i++) g->owner[i] = g->place[i] = -1;
    mg_find_rows(g, c);
    mg_find_ghosts(g, c);
    mg_find_links(g);
    g->rows.first = g->first;
    g->rows.number = g->number;
    g->rows.link_first = g->link_first;
    g->rows.link = g->link;
    g->rows.weight = g->weight;
    g->rows.diagonal = g->diagonal;
    g->rows.send = mg_send;
    g->rows.receive = mg_receive;
    g->rows.context = g;
    if (comm_exchange_make(c, g->nlinks, g->exchange_link, &g->exchange)) abort();
}

static inline void mg_close(struct mg_grid *g) {
    for (int k = 0; k < g->nlinks; k++) {
        free(g->exchange_link[k].in);
        free(g->exchange_link[k].out);
        free(g->send[k]);
    }
    free(g->exchange_link);
    free(g->send);
    free(g->send_count);
    comm_exchange_free(g->exchange);
    free(g->owner);
    free(g->place);
    free(g->cell);
    free(g->first);
    free(g->number);
    free(g->link_first);
    free(g->link);
    free(g->weight);
    free(g->diagonal);
    free(g->b);
    free(g->x);
}

#endif
