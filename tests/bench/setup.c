/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The set-up of one rank out of many on a lattice, without the others: on a mesh of boxes by bench_setup n0 n1 n2 ranks
 * rank (n2 = 1: two dimensions), on the lattice of a case by bench_setup -case DIR ranks rank. Prints time, memory, the
 * rank's share of the cells, its neighbours and the cells that it sends to them. -all in place of the rank: a table of
 * all ranks. `even` behind that: tiles as for a gas with transport (lattice.h). */
#include "mesh/format/boxes.h"
#include "mesh/grid/grid.h"
#include "mesh/lattice/forest_private.h"
#include "solvers/case/blockmesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double megabytes(void) { /* the most that this process had */
    struct rusage use;
    getrusage(RUSAGE_SELF, &use);
    return (double)use.ru_maxrss * 1024e-6;
}

/* An L of three blocks, with walls around it and, in two dimensions, empty sides. */
static status make_mesh(const int n[3], struct polymesh **out) {
    double vertex[16][3];
    struct boxes_block block[3] = {
        {{0, 1, 4, 3, 8, 9, 12, 11}, {0}}, {{1, 2, 5, 4, 9, 10, 13, 12}, {0}}, {{3, 4, 7, 6, 11, 12, 15, 14}, {0}}};
    int empty[6][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {8, 9, 12, 11}, {9, 10, 13, 12}, {11, 12, 15, 14}};
    const struct boxes_patch patch[2] = {{"flat", "empty", NULL, n[2] == 1 ? 6 : 0, empty, NULL},
                                         {"walls", "wall", NULL, 0, NULL, NULL}};
    for (int v = 0; v < 16; v++) {
        const int i = v % 8 < 6 ? v % 8 % 3 : v % 8 - 6, j = v % 8 < 6 ? v % 8 / 3 : 2;
        vertex[v][0] = i * (n[0] / 2) * 1e-3;
        vertex[v][1] = j * (n[1] / 2) * 1e-3;
        vertex[v][2] = v / 8 * n[2] * 1e-3;
    }
    for (int b = 0; b < 3; b++)
        for (int k = 0; k < 3; k++) block[b].n[k] = k < 2 ? n[k] / 2 : n[k];
    struct boxes *boxes;
    int culprit;
    TRY(boxes_place(vertex[0], 3, block, &boxes, &culprit));
    return boxes_mesh(boxes, block, 2, patch, out);
}

/* Sets up one rank on lattice l of mesh m, and prints its share: a row of a table, or a sentence. `start` and `before`
 * are the time and the memory before the mesh was there. */
static status set_up(const struct lattice *l, const struct polymesh *m, int ranks, int rank, bool row, double start,
                     double before) {
    struct comm *c;
    struct forest *f;
    TRY(comm_pretend(rank, ranks, &c));
    TRY(forest_make(l, m, c, grid_tile_size(l->dim), &f));
    long mine = 0, sent = 0;
    for (int t = 0; t < f->ntiles; t++) mine += (long)f->tile[t].n[0] * f->tile[t].n[1] * f->tile[t].n[2];
    const int links = f->hidden->nlinks;
    for (int i = 0; i < links; i++) sent += f->hidden->link[i].n; /* of one layer */
    if (row)
        printf("%d,%ld,%d,%d,%ld\n", rank, mine, f->ntiles, links, sent);
    else
        printf("%d cells in %d tiles: rank %d of %d has %ld cells in %d tiles, and sends %ld cells a layer to %d "
               "others; %.2f s, %.1f MB more memory than before\n",
               m->ncells, f->ntiles_all, rank, ranks, mine, f->ntiles, sent, links, seconds() - start,
               megabytes() - before);
    forest_free(f);
    comm_alone_free(c);
    return OK;
}

static status set_up_all(const struct lattice *l, const struct polymesh *m, int ranks) {
    printf("rank,cells,tiles,neighbours,sent\n");
    for (int r = 0; r < ranks; r++) TRY(set_up(l, m, ranks, r, true, 0, 0));
    return OK;
}

/* Reads the mesh of a case, which must be a lattice. */
static status read_mesh(const char *dir, struct polymesh **m, struct lattice **l) {
    struct case_mesh read;
    char why[256];
    const status e = case_mesh_read(dir, &read);
    *m = read.mesh;
    TRY(e);
    if (read.mesh->boxes) return lattice_of_boxes(read.mesh, l);
    TRY(status_note(polymesh_check(read.mesh), "%s", read.path));
    TRY(lattice_recognise(read.mesh, l, why));
    return *l ? OK
              : fail(ERR_INPUT, "%s is no lattice (%s): only lattices are set up without the others", read.path, why);
}

static status run(const char *dir, const int n[3], int ranks, const char *which, bool even) {
    struct polymesh *m;
    struct lattice *l;
    const double start = seconds(), before = megabytes();
    if (dir) {
        TRY(read_mesh(dir, &m, &l));
    } else {
        TRY(make_mesh(n, &m));
        TRY(lattice_of_boxes(m, &l));
    }
    l->even = even;
    if (!strcmp(which, "-all"))
        TRY(set_up_all(l, m, ranks));
    else
        TRY(set_up(l, m, ranks, atoi(which), false, start, before));
    lattice_free(l);
    polymesh_free(m);
    return OK;
}

int main(int argc, char **argv) {
    int n[3] = {0};
    struct comm *world;
    const bool even = argc > 1 && !strcmp(argv[argc - 1], "even");
    const int words = argc - even;
    const bool of_case = words == 5 && !strcmp(argv[1], "-case");
    const int ranks = words > 3 ? atoi(argv[words - 2]) : 0, rank = words > 3 ? atoi(argv[words - 1]) : 0;
    if ((!of_case && words != 6) || ranks < 1 || rank < 0 || rank >= ranks) {
        fprintf(stderr, "usage: bench_setup n0 n1 n2 RANKS RANK [even]; bench_setup -case DIR RANKS RANK [even]; "
                        "-all for RANK\n");
        return 1;
    }
    for (int k = 0; k < 3 && !of_case; k++) n[k] = atoi(argv[1 + k]);
    const char *dir = of_case ? argv[2] : NULL, *which = argv[words - 1];
    status s = comm_start(&argc, &argv, &world);
    if (!s) s = run(dir, n, ranks, which, even);
    const int code = status_print(s, true);
    comm_finish(world);
    return code;
}
