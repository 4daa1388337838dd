/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The memory of a bed, its primitive variables, and the order of the parts of a step. */
#include "libcore/acoustics/bed_friction_private.h"

#include <stdlib.h>

/* Cuts lines of n numbers each from `at` on; returns the place behind them. */
static double *cut_lines(double *at, long n, double **line, int lines) {
    for (int i = 0; i < lines; i++, at += n) line[i] = at;
    return at;
}

status bed_set_blocks(struct bed_set *s, int blocks) {
    TRY(ARRAYS_GROW(&s->arrays, s->first, 2L * blocks + 1));
    TRY(ARRAYS_GROW(&s->arrays, s->lift, 5L * blocks));
    TRY(ARRAYS_GROW(&s->arrays, s->peak_cell, blocks));
    s->number = s->first + blocks + 1;
    s->work = s->lift + blocks;
    s->rubbed = s->work + blocks;
    s->pushed = s->rubbed + blocks;
    s->peak = s->pushed + blocks;
    return OK;
}

/* Makes room for what friction keeps. */
static status friction_size(const struct bed *b, struct bed_set *s, int faces) {
    const int tensors = bed_tensors(b->components);
    if (!b->rub) return OK;
    TRY(ARRAYS_GROW(&s->arrays, s->pressure, s->cells));
    TRY(ARRAYS_GROW(&s->arrays, s->stress[0], (tensors + b->components + 1L) * faces));
    double *at = cut_lines(s->stress[0], faces, s->stress, tensors);
    at = cut_lines(at, faces, s->wall_speed, b->components);
    s->wall_friction = at;
    return OK;
}

status bed_set_size(const struct bed *b, struct bed_set *s, int faces, int sides) {
    const int variables = b->components + 2;
    const long cells = (long)s->cells + s->ghosts;
    double *at;
    TRY(ARRAYS_GROW(&s->arrays, s->body, 2 * cells + 1));
    TRY(ARRAYS_GROW(&s->arrays, s->shape, 3L * faces));
    TRY(ARRAYS_GROW(&s->arrays, s->kind, faces));
    TRY(ARRAYS_GROW(&s->arrays, s->face_of_cell, sides));
    TRY(ARRAYS_GROW(&s->arrays, s->cell_lines, 2 * variables * cells));
    TRY(ARRAYS_GROW(&s->arrays, s->face_lines, (2L * variables + 3) * faces));
    s->face_start = s->body + cells;
    s->left = s->shape + faces;
    s->right = s->left + faces;
    cut_lines(cut_lines(s->cell_lines, cells, s->U, variables), cells, s->start, variables);
    at = cut_lines(s->face_lines, faces, s->kept, variables);
    at = cut_lines(at, faces, s->outside, variables);
    s->holds = cut_lines(at, faces, s->balance, 2);
    return friction_size(b, s, faces);
}

void bed_find_bodies(struct bed_set *s) {
    for (int f = 0; f < s->faces; f++) {
        if (s->left[f] >= 0) s->body[s->left[f]] = s->shapes->round->body[0][s->shape[f]];
        if (s->right[f] >= 0) s->body[s->right[f]] = s->shapes->round->body[1][s->shape[f]];
    }
}

/* Makes room to compute the present set. */
static status make_lines(struct bed *b) {
    struct bed_lines *x = b->lines;
    const struct bed_set *s = &b->set;
    const long cells = (long)s->cells + s->ghosts, sides = s->face_start[s->cells];
    const int variables = b->components + 2;
    double **of_cell[] = {&x->rho,  &x->eps,   &x->p,        &x->c,        &x->first_p, &x->start_p,
                          &x->root, &x->slack, &x->residual, &x->diagonal, &x->change,  &x->growth};
    double **of_face[] = {&x->drift, &x->give, &x->beyond,  &x->U,      &x->p_face,
                          &x->P[0],  &x->P[1], &x->heat[0], &x->heat[1]};
    enum { OF_CELL = sizeof of_cell / sizeof *of_cell, OF_FACE = sizeof of_face / sizeof *of_face };
    TRY(ARRAYS_GROW(&x->arrays, x->cells, (OF_CELL + b->components + (1 + b->dim) * variables) * cells));
    TRY(ARRAYS_GROW(&x->arrays, x->faces, (long)OF_FACE * s->faces));
    TRY(ARRAYS_GROW(&x->arrays, x->link_first, s->cells + 1L + sides));
    TRY(ARRAYS_GROW(&x->arrays, x->weight, sides));
    TRY(ARRAYS_GROW(&x->arrays, x->block_sums, (long)BLUR_SUMS * s->blocks));
    if (!s->shapes->boxes) {
        TRY(ARRAYS_GROW(&x->arrays, x->pull, sides * b->dim));
        TRY(ARRAYS_GROW(&x->arrays, x->inverse, (long)s->cells * b->dim * b->dim));
        TRY(ARRAYS_GROW(&x->arrays, x->sloped, s->cells));
    }
    x->weighed = false;
    x->link = x->link_first + s->cells + 1;
    for (int i = 0; i < OF_CELL; i++) *of_cell[i] = x->cells + i * cells;
    for (int i = 0; i < OF_FACE; i++) *of_face[i] = x->faces + (long)i * s->faces;
    if (b->rub) {
        TRY(ARRAYS_GROW(&x->arrays, x->push, (1L + b->components) * s->faces));
        TRY(ARRAYS_GROW(&x->arrays, x->rubbed[0], b->components * cells));
        cut_lines(x->push + s->faces, s->faces, x->traction, b->components);
        cut_lines(x->rubbed[0], cells, x->rubbed, b->components);
    }
    double *at = cut_lines(x->cells + OF_CELL * cells, cells, x->u, b->components);
    at = cut_lines(at, cells, x->after, variables);
    for (int k = 0; k < b->dim; k++) at = cut_lines(at, cells, x->slope[k], variables);
    return OK;
}

status bed_list(struct bed *b, int sides) {
    struct bed_set *s = b->home;
    s->cells = s->first[s->blocks];
    b->stage = BED_NEW;
    TRY(comm_agree(b->comm, bed_set_size(b, s, sides, sides)));
    return bed_deal_blocks(b, sides);
}

status bed_make(struct bed *b, int blocks) {
    TRY(allocate(&b->lines, 1, sizeof *b->lines, "the bed"));
    TRY(bed_friction_make(b));
    TRY(multigrid_make(b->comm, &b->multigrid));
    b->home = &b->set;
    if (comm_size(b->comm) > 1) TRY(bed_deal_make(b));
    return bed_set_blocks(b->home, blocks);
}

void bed_free(struct bed *b) {
    if (b->lines) arrays_free(&b->lines->arrays);
    free(b->lines);
    bed_friction_free(b->rub);
    arrays_free(&b->set.arrays);
    multigrid_free(b->multigrid);
    bed_halo_free(b->halo);
    bed_deal_free(b->deal);
}

/* Finds velocity and eps of n states from place `at` on. */
KERNEL static void bed_velocities(const struct bed *b, int at, int n) {
    const struct bed_lines *x = b->lines;
    const double *restrict rho = b->set.U[0] + at, *restrict E = b->set.U[b->components + 1] + at;
    double square[BATCH];
    for (int i = 0; i < n; i++) square[i] = 0;
    for (int k = b->components - 1; k >= 0; k--) {
        const double *restrict mom = b->set.U[k + 1] + at;
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
    bed_fill(b, b->components + 2, b->set.U);
    for (int at = 0; at < b->set.cells + b->set.ghosts; at += BATCH) {
        const int n = b->set.cells + b->set.ghosts - at < BATCH ? b->set.cells + b->set.ghosts - at : BATCH;
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
    return b->set.shapes->volume[b->set.body[cell]];
}

/* Beyond the bed volumes are taken to be those of boxes. */
double bed_energy_near(const struct bed *b, int cell) {
    double sum = volume_of(b, cell) * energy_of(b, cell);
    for (int j = b->set.face_start[cell]; j < b->set.face_start[cell + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const int other = bed_across(b, &s);
        const double box = 2 * b->set.shapes->depth[!s.right][s.shape] * b->set.shapes->area[s.shape];
        if (b->set.kind[s.face] == BED_WALL) continue;
        sum += other < 0 ? box * b->set.outside[b->components + 1][s.face] : volume_of(b, other) * energy_of(b, other);
    }
    return sum / volume_of(b, cell);
}

/* Readies a new set: deals it out, and lists the links of its cells. */
static status prepare(struct bed *b) {
    bed_write(b);
    TRY(bed_deal_lists(b));
    TRY(comm_agree(b->comm, make_lines(b)));
    bed_find_links(b);
    b->stage = BED_DEALT;
    return OK;
}

/* Friction may give a bed this part of its energy in a step; else the step is found again, ROUNDS times at most. */
static const double MOST_GIVEN = 0.01;
enum { ROUNDS = 8 };

/* Returns the work (J/m^3) of walls that move on a cell over dt. */
static double walls_work(const struct bed *b, double dt, int i) {
    double sum = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        if (b->set.kind[s.face] != BED_WALL) continue;
        for (int k = 0; k < b->components; k++)
            sum += s.sign * b->set.shapes->area[s.shape] * b->lines->traction[k][s.face] * b->set.wall_speed[k][s.face];
    }
    return dt * sum / volume_of(b, i);
}

/* Has friction given the bed energy? It is found with the pressures of the step before. Where those move the gas far
 * more than the pressures of this step do, it stops a motion that does not come, and drives the gas: then all is found
 * again, with the pressures of this step. Some energy is elastic, from the stress that was kept. */
static bool drags(struct bed *b, double dt) {
    double all[2];
    if (!b->rub) return false;
    for (int block = 0; block < b->set.blocks; block++) {
        double *sum = b->lines->block_sums + 2 * block;
        sum[0] = b->set.rubbed[block];
        sum[1] = 0;
        for (int i = b->set.first[block]; i < b->set.first[block + 1]; i++) {
            sum[0] -= volume_of(b, i) * walls_work(b, dt, i);
            sum[1] += volume_of(b, i) * energy_of(b, i);
        }
    }
    multigrid_sum_blocks(b->multigrid, b->set.blocks, 2, b->lines->block_sums, all);
    if (!(all[0] > MOST_GIVEN * all[1])) return false;
    memcpy(b->set.pressure, b->lines->p, (size_t)b->set.cells * sizeof(double));
    return true;
}

static status advance(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done) {
    bool updated = false;
    memcpy(b->lines->first_p, b->lines->p, (size_t)b->set.cells * sizeof(double));
    bed_find_start(b);
    for (int round = 0; round == 0 || (round < ROUNDS && drags(b, dt)); round++) {
        TRY(bed_rub(b, dt, gravity, true, done));
        if (!*done) return OK;
        TRY(bed_find_pressure(b, dt, gravity, round > 0, done));
        if (!*done) return OK;
        updated = bed_update(b, dt, gravity);
    }
    bed_move_stress(b, gravity);
    bed_find_blur(b, dt, gravity);
    const bool moved = bed_remap(b, dt);
    double failed = !updated || !moved;
    comm_max(b->comm, &failed, 1);
    *done = failed == 0;
    if (b->rub) memcpy(b->set.pressure, b->lines->p, (size_t)b->set.cells * sizeof(double));
    return OK;
}

status bed_ready(struct bed *b) {
    if (b->stage < BED_DEALT) TRY(prepare(b));
    bed_deal_states(b);
    find_primitives(b);
    return OK;
}

status bed_step(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done) {
    TRY(bed_ready(b));
    TRY(advance(b, dt, gravity, done));
    if (*done) bed_deal_results(b);
    return OK;
}
