/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step of a bed: the remap of what the face velocities U carry (bed.h, part 3 and the theorem; docs/physics.md
 * 9.1). */
#include "libcore/acoustics/bed_private.h"

static const double LEFT = 0.1;

/* Returns the part of a cell's volume that leaves through one of its faces; negative: it enters. */
static double leaving(const struct bed *b, double dt, const struct bed_side *s, int cell) {
    return s->sign * dt * b->set.shapes->area[s->shape] / b->set.shapes->volume[b->set.body[cell]] *
           b->lines->U[s->face];
}

/* Returns the mean over dt of a variable at a face of a cell, less its value in the cell, by the cell's slopes. On
 * boxes a layer of the depth |U| dt leaves, and the mean over that layer along the axis is taken. */
static double change_at(const struct bed *b, double dt, const struct bed_side *s, int cell, int v) {
    const struct bed_lines *x = b->lines;
    const double reach = bed_reach(b, s, cell, v);
    if (!b->set.shapes->boxes) return reach + bed_drift(b, x->after + 1, dt, cell, v);
    return reach * (1 - dt * fabs(x->U[s->face]) / (2 * b->set.shapes->depth[s->right][s->shape]));
}

/* Computes the conserved state that leaves a cell through a face. */
static void face_state(const struct bed *b, double dt, const struct bed_side *s, int cell, double V[MAX_VAR]) {
    double *const *after = b->lines->after;
    const int last = b->components + 1;
    double square = 0;
    V[0] = after[0][cell] + change_at(b, dt, s, cell, 0);
    for (int k = b->components; k >= 1; k--) {
        V[k] = after[k][cell] + change_at(b, dt, s, cell, k);
        square += V[k] * V[k];
        V[k] *= V[0];
    }
    V[last] = V[0] * (after[last][cell] + change_at(b, dt, s, cell, last) + 0.5 * square);
}

static bool admissible(const struct bed *b, const double V[MAX_VAR], double volume) {
    double square = 0;
    for (int k = b->components; k >= 1; k--) square += V[k] * V[k];
    return V[0] > 0 && V[0] < b->limit * volume && V[b->components + 1] * V[0] - 0.5 * square > 0;
}

/* Computes the conserved state of a cell after acoustics. */
static void cell_state(const struct bed *b, int i, double rho, double V[MAX_VAR]) {
    const struct bed_lines *x = b->lines;
    const int last = b->components + 1;
    double square = 0;
    for (int k = b->components; k >= 1; k--) {
        V[k] = rho * x->after[k][i];
        square += x->after[k][i] * x->after[k][i];
    }
    V[0] = rho;
    V[last] = rho * (x->after[last][i] + 0.5 * square);
}

/* Sets the slopes of a cell to 0 where what stays behind is not admissible. Returns whether little enough flows in and
 * out. */
static bool settle_cell(struct bed *b, double dt, int i) {
    const struct bed_lines *x = b->lines;
    double in = 0, out = 0, growth = 0, gone[MAX_VAR] = {0}, V[MAX_VAR];
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double part = leaving(b, dt, &s, i);
        growth += part;
        in += part < 0 ? -part : 0;
        out += part > 0 ? part : 0;
        if (!(part > 0)) continue;
        face_state(b, dt, &s, i, V);
        for (int v = 0; v < b->components + 2; v++) gone[v] += part * V[v];
    }
    cell_state(b, i, (1 + growth) * x->after[0][i], V);
    for (int v = 0; v < b->components + 2; v++) V[v] -= gone[v];
    if (!admissible(b, V, 1 - in))
        for (int k = 0; k < b->dim; k++)
            for (int v = 0; v < b->components + 2; v++) x->slope[k][v][i] = 0;
    return in < MOST_OUT && out < MOST_OUT;
}

/* Computes the flux from left to right through a face, per area and time: U_f W_f; on a face with a kept flux that flux
 * without its pressure, which the acoustics has passed on. */
static void face_flux(const struct bed *b, double dt, int face, double F[MAX_VAR]) {
    const struct bed_lines *x = b->lines;
    const double U = x->U[face];
    const int last = b->components + 1, shape = b->set.shape[face],
              from = U > 0 ? b->set.left[face] : b->set.right[face];
    const struct bed_side s = {face, shape, U > 0 ? 0 : 1, U > 0 ? 1 : -1};
    for (int v = 0; v <= last; v++) F[v] = 0;
    if (b->set.kind[face] == BED_KEPT) {
        for (int v = 0; v <= last; v++) F[v] = b->set.kept[v][face];
        for (int k = 0; k < b->dim; k++) F[k + 1] -= x->p_face[face] * b->set.shapes->normal[k][shape];
        F[last] -= x->p_face[face] * U;
        return;
    }
    if (b->set.kind[face] == BED_WALL || U == 0) return;
    if (from >= 0) face_state(b, dt, &s, from, F);
    for (int v = 0; v <= last; v++) F[v] = U * (from >= 0 ? F[v] : b->set.outside[v][face]);
}

/* Carries the state: the fluxes of the faces, then their sums in the cells. The fluxes go to the lines of `kept`, each
 * of which was read for its own face before. */
static void carry(struct bed *b, double dt) {
    for (int f = 0; f < b->set.faces; f++) {
        double F[MAX_VAR];
        face_flux(b, dt, f, F);
        for (int v = 0; v < b->components + 2; v++) b->set.kept[v][f] = F[v];
    }
    for (int i = 0; i < b->set.cells; i++) {
        double V[MAX_VAR];
        cell_state(b, i, b->lines->rho[i], V);
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            const double swept = s.sign * dt * b->set.shapes->area[s.shape] / b->set.shapes->volume[b->set.body[i]];
            for (int v = 0; v < b->components + 2; v++) V[v] -= swept * b->set.kept[v][s.face];
        }
        for (int v = 0; v < b->components + 2; v++) b->set.U[v][i] = V[v];
    }
}

/* Adds the pressures to the fluxes of the faces that are not BED_INNER. */
static void add_pressures(struct bed *b) {
    const struct bed_lines *x = b->lines;
    double *const *F = b->set.kept;
    for (int f = 0; f < b->set.faces; f++) {
        if (b->set.kind[f] == BED_INNER) continue;
        const bool carries = b->set.balanced && b->set.kind[f] == BED_WALL;
        const double p = x->p_face[f] - (carries ? b->set.balance[b->set.left[f] < 0][f] : 0);
        for (int k = 0; k < b->dim; k++) F[k + 1][f] += p * b->set.shapes->normal[k][b->set.shape[f]];
        F[b->components + 1][f] += x->p_face[f] * x->U[f];
    }
}

void bed_add_tractions(struct bed *b) {
    double *const *F = b->set.kept, *const *t = b->lines->traction;
    for (int k = 0; k < b->components && b->rub; k++)
        for (int f = 0; f < b->set.faces; f++) {
            if (b->set.kind[f] != BED_WALL) continue;
            F[k + 1][f] -= t[k][f];
            F[b->components + 1][f] -= t[k][f] * b->set.wall_speed[k][f];
        }
}

static bool is_beside_rest(const struct bed *b, int i) {
    bool beside = false;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++)
        beside |= b->set.kind[bed_side(b, j).face] == BED_KEPT;
    return beside;
}

/* Lifts eps of cells beside kept faces to LEFT of its value before the remap, where it is less. The kept fluxes belong
 * to other velocities than U: in cold gas that moves faster than sound they may take more energy than the cell has to
 * spare. Returns whether no cell was lifted by more energy than it and its neighbours had. */
static bool lift_beside_rest(struct bed *b) {
    const int last = b->components + 1;
    bool fine = true;
    for (int block = 0; block < b->set.blocks; block++)
        for (int i = b->set.first[block]; i < b->set.first[block + 1]; i++) {
            const double rho = b->set.U[0][i], least = LEFT * rho * b->lines->after[last][i];
            double square = 0;
            if (!(rho > 0) || !is_beside_rest(b, i)) continue;
            for (int k = b->components; k >= 1; k--) square += b->set.U[k][i] * b->set.U[k][i];
            const double internal = b->set.U[last][i] - 0.5 * square / rho;
            if (!(internal < least)) continue;
            const double before = b->set.U[last][i];
            b->set.U[last][i] += least - internal;
            b->set.lift[block] += b->set.shapes->volume[b->set.body[i]] * (b->set.U[last][i] - before);
            b->lifted++;
            fine &= least - internal <= bed_energy_near(b, i);
        }
    return fine;
}

bool bed_remap(struct bed *b, double dt) {
    const int n = b->components + 2;
    bool fine = true;
    bed_slopes(b, b->lines->after, 0, n, dt);
    for (int i = 0; i < b->set.cells; i++) fine &= settle_cell(b, dt, i);
    for (int k = 0; k < b->dim && b->halo; k++) bed_fill(b, n, b->lines->slope[k]);
    carry(b, dt);
    add_pressures(b);
    bed_add_tractions(b);
    return lift_beside_rest(b) && fine;
}
