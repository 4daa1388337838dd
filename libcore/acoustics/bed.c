/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The memory of a bed, its primitive variables, and the order of the parts of a step. */
#include "libcore/acoustics/bed_private.h"

#include <stdlib.h>

status bed_make(struct bed *b) {
    TRY(allocate(&b->lines, 1, sizeof *b->lines, "the bed"));
    return comm_size(b->comm) > 1 ? bed_deal_make(b) : multigrid_make(b->comm, &b->multigrid);
}

static void free_lines(struct bed *b) {
    struct bed_lines *x = b->lines;
    free(x->memory_cells);
    free(x->memory_faces);
    free(x->whole_cells);
    free(x->whole_faces);
    free(x->whole_sides);
    free(b->first);
    free(b->kind);
    free(b->lift);
    x->memory_cells = x->memory_faces = NULL;
    x->whole_cells = x->whole_faces = x->whole_sides = b->first = NULL;
    b->kind = NULL;
    b->lift = NULL;
}

void bed_free(struct bed *b) {
    if (b->lines) free_lines(b);
    free(b->lines);
    multigrid_free(b->multigrid);
    bed_halo_free(b->halo);
    bed_deal_free(b->deal);
}

/* Deals the lines of cells, each of n numbers, from one memory; returns how many there are. Cells that others work on
 * have states alone. */
static int deal_cells(struct bed *b, double *memory, long n) {
    struct bed_lines *x = b->lines;
    int used = 0;
    double **single[] = {&x->rho,      &x->eps,      &x->p,      &x->c,      &x->root,   &x->slack,
                         &x->residual, &x->diagonal, &x->change, &x->growth, &x->first_p};
    for (int v = 0; v < b->components + 2; v++) {
        b->U[v] = memory + used++ * n;
        b->start[v] = memory + used++ * n;
    }
    if (b->deal) return used;
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) *single[i] = memory + used++ * n;
    for (int v = 0; v < b->components + 2; v++) {
        x->after[v] = memory + used++ * n;
        for (int k = 0; k < b->dim; k++) x->slope[k][v] = memory + used++ * n;
    }
    for (int k = 0; k < b->components; k++) x->u[k] = memory + used++ * n;
    return used;
}

static int deal_faces(struct bed *b, double *memory, long n) {
    struct bed_lines *x = b->lines;
    int used = 0;
    double **single[] = {&x->drift, &x->give, &x->beyond,  &x->U,      &x->p_face,
                         &x->P[0],  &x->P[1], &x->heat[0], &x->heat[1]};
    for (int side = 0; side < 2; side++) b->balance[side] = memory + used++ * n;
    for (int v = 0; v < b->components + 2; v++) {
        b->kept[v] = memory + used++ * n;
        b->outside[v] = memory + used++ * n;
    }
    for (size_t i = 0; i < sizeof single / sizeof *single && !b->deal; i++) *single[i] = memory + used++ * n;
    return used;
}

static void deal_lists(struct bed *b, const long room[4]) {
    struct bed_lines *x = b->lines;
    b->number = b->first + room[0] + 1;
    b->work = b->lift + room[0];
    b->pushed = b->work + room[0];
    b->peak = b->pushed + room[0];
    b->peak_cell = b->peak + room[0];
    x->block_sums = b->peak_cell + room[0];
    b->body = x->whole_cells;
    b->face_start = b->body + room[1];
    x->link_first = b->face_start + room[1] + 1;
    b->shape = x->whole_faces;
    b->left = b->shape + room[2];
    b->right = b->left + room[2];
    b->face_of_cell = x->whole_sides;
    x->link = b->face_of_cell + room[3];
}

/* Makes room for half as much again as is needed, so that a growing bed seldom allocates. */
static status grow(struct bed *b, const long wanted[4]) {
    struct bed_lines *x = b->lines;
    long room[4];
    free_lines(b);
    for (int i = 0; i < 4; i++) room[i] = b->room[i] = wanted[i] + wanted[i] / 2 + 16;
    const long cells = deal_cells(b, NULL, 0) * room[1];
    TRY(allocate(&x->memory_cells, cells + room[3], sizeof(double), "the bed"));
    TRY(allocate(&x->memory_faces, deal_faces(b, NULL, 0) * room[2], sizeof(double), "the bed"));
    TRY(allocate(&x->whole_cells, 3 * room[1] + 2, sizeof(int), "the bed"));
    TRY(allocate(&x->whole_faces, 3 * room[2], sizeof(int), "the bed"));
    TRY(allocate(&x->whole_sides, 2 * room[3], sizeof(int), "the bed"));
    TRY(allocate(&b->first, 2 * room[0] + 1, sizeof(int), "the bed"));
    TRY(allocate(&b->kind, room[2], 1, "the bed"));
    TRY(allocate(&b->lift, (5 + BLUR_SUMS) * room[0], sizeof(double), "the bed"));
    (void)deal_cells(b, x->memory_cells, room[1]);
    (void)deal_faces(b, x->memory_faces, room[2]);
    x->weight = x->memory_cells + cells;
    deal_lists(b, room);
    return OK;
}

status bed_size(struct bed *b, int blocks, int cells, int ghosts, int faces, int sides) {
    const long wanted[4] = {blocks, (long)cells + ghosts, faces, sides};
    bool fits = b->kind != NULL;
    for (int i = 0; i < 4; i++) fits &= wanted[i] <= b->room[i];
    if (!fits) TRY(grow(b, wanted));
    b->blocks = blocks;
    b->cells = cells;
    b->ghosts = ghosts;
    b->faces = faces;
    b->linked = b->laid = false;
    return OK;
}

/* Finds velocity and eps of n states from place `at` on. */
KERNEL static void bed_velocities(const struct bed *b, int at, int n) {
    const struct bed_lines *x = b->lines;
    const double *restrict rho = b->U[0] + at, *restrict E = b->U[b->components + 1] + at;
    double square[BATCH];
    for (int i = 0; i < n; i++) square[i] = 0;
    for (int k = b->components - 1; k >= 0; k--) {
        const double *restrict mom = b->U[k + 1] + at;
        double *restrict u = x->u[k] + at;
        for (int i = 0; i < n; i++) {
            u[i] = mom[i] / rho[i];
            square[i] += u[i] * u[i];
        }
    }
    for (int i = 0; i < n; i++) {
        x->rho[at + i] = rho[i];
        x->eps[at + i] = E[i] / rho[i] - 0.5 * square[i];
    }
}

static void find_primitives(struct bed *b) {
    const struct bed_lines *x = b->lines;
    double gruneisen[BATCH];
    bed_fill(b, b->components + 2, b->U);
    for (int at = 0; at < b->cells + b->ghosts; at += BATCH) {
        const int n = b->cells + b->ghosts - at < BATCH ? b->cells + b->ghosts - at : BATCH;
        bed_velocities(b, at, n);
        b->eos->state(b->material, n, x->rho + at, x->eps + at, x->p + at, x->c + at, gruneisen);
        for (int i = 0; i < n; i++) {
            x->c[at + i] = sqrt(x->c[at + i]);
            x->root[at + i] = x->rho[at + i];
        }
    }
}

static double energy_of(const struct bed *b, int i) {
    const struct bed_lines *x = b->lines;
    double square = 0;
    for (int k = b->components - 1; k >= 0; k--) square += x->u[k][i] * x->u[k][i];
    return x->rho[i] * (x->eps[i] + 0.5 * square);
}

static double volume_of(const struct bed *b, int cell) {
    return b->shapes->volume[b->body[cell]];
}

/* Beyond the bed volumes are taken to be those of boxes. */
double bed_energy_near(const struct bed *b, int cell) {
    double sum = volume_of(b, cell) * energy_of(b, cell);
    for (int j = b->face_start[cell]; j < b->face_start[cell + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const int other = bed_across(b, &s);
        const double box = 2 * b->shapes->depth[!s.right][s.shape] * b->shapes->area[s.shape];
        if (b->kind[s.face] == BED_WALL) continue;
        sum += other < 0 ? box * b->outside[b->components + 1][s.face] : volume_of(b, other) * energy_of(b, other);
    }
    return sum / volume_of(b, cell);
}

status bed_step(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done) {
    if (b->deal) return bed_deal_step(b, dt, gravity, done);
    b->worked = b->cells;
    find_primitives(b);
    memcpy(b->lines->first_p, b->lines->p, (size_t)b->cells * sizeof(double));
    TRY(bed_find_pressure(b, dt, gravity, done));
    if (!*done) return OK;
    const bool updated = bed_update(b, dt, gravity);
    bed_find_blur(b, dt, gravity);
    const bool moved = bed_remap(b, dt);
    double failed = !updated || !moved;
    comm_max(b->comm, &failed, 1);
    *done = failed == 0;
    return OK;
}
