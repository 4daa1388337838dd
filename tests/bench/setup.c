/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The set-up of one rank out of many on a mesh of boxes, without the others: bench_setup n0 n1 n2 ranks rank. Prints
 * its time, its share of the cells, and what it takes of memory. n2 = 1: two dimensions. */
#include "mesh/format/boxes.h"
#include "mesh/lattice/forest.h"

#include <stdio.h>
#include <stdlib.h>
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
    const struct boxes_patch patch[2] = {{"flat", "empty", NULL, n[2] == 1 ? 6 : 0, empty},
                                         {"walls", "wall", NULL, 0, NULL}};
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

static status run(const int n[3], int ranks, int rank) {
    struct polymesh *m;
    struct lattice *l;
    struct comm *c;
    struct forest *f;
    const double start = seconds(), before = megabytes();
    TRY(make_mesh(n, &m));
    TRY(lattice_of_boxes(m, &l));
    TRY(comm_pretend(rank, ranks, &c));
    TRY(forest_make(l, m, c, l->dim == 3 ? 24 : 60, &f));
    long mine = 0;
    for (int t = 0; t < f->ntiles; t++) mine += (long)f->tile[t].n[0] * f->tile[t].n[1] * f->tile[t].n[2];
    printf("%d cells in %d tiles: rank %d of %d has %ld cells in %d tiles; %.2f s, %.1f MB more memory than before\n",
           m->ncells, f->ntiles_all, rank, ranks, mine, f->ntiles, seconds() - start, megabytes() - before);
    forest_free(f);
    comm_alone_free(c);
    lattice_free(l);
    polymesh_free(m);
    return OK;
}

int main(int argc, char **argv) {
    int number[5];
    struct comm *world;
    if (argc != 6) {
        fprintf(stderr, "usage: bench_setup n0 n1 n2 ranks rank\n");
        return 1;
    }
    for (int i = 0; i < 5; i++) number[i] = atoi(argv[1 + i]);
    status s = comm_start(&argc, &argv, &world);
    if (!s) s = run(number, number[3], number[4]);
    const int code = status_print(s, true);
    comm_finish(world);
    return code;
}
