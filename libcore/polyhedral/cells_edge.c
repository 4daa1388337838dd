/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The boundary of a polyhedral mesh: mirror cells for the stencils, states beyond the faces of patches, and S and its
 * gradients beyond them. Walls act in the frame of the face, other rules in the axes of the mesh, in which their values
 * are given. */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells_diffuser.h"

/* The frames of n faces or mirrors from `from` on: the normals, then the tangents; of faces at[n] if that is not NULL.
 */
static void find_frames(int dim, int n, const int *at, int from, double *const normal[3], double *const tangent[2][3],
                        double (*axis)[MAX_DIM][BATCH]) {
    for (int t = 0; t < dim; t++)
        for (int k = 0; k < dim; k++) {
            const double *line = t ? tangent[t - 1][k] : normal[k];
            for (int i = 0; i < n; i++) axis[t][k][i] = line[at ? at[i] : from + i];
        }
}

static void mirror_frames(const struct gas *g, int from, int n, double (*axis)[MAX_DIM][BATCH]) {
    const struct polyhedra_mirrors *m = &g->cells->polyhedra->mirror;
    find_frames(g->dim, n, NULL, from, m->normal, m->tangent, axis);
}

static void mirror_run(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->patches.rules[m->mirror.patch[from]];
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH] = {0}, axis[MAX_DIM][MAX_DIM][BATCH];
    struct patch_line line = {.n = n, .face = m->mirror.place + from, .outflow = outflow, .layer = 1};
    const bool reflects = patch_is_wall(r);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) inner[v][i] = U[v][m->mirror.cell[from + i]];
    for (int k = 0; k < g->dim; k++)
        for (int i = 0; i < n; i++) outflow[i] += m->mirror.normal[k][from + i] * inner[k + 1][i] / inner[0][i];
    if (reflects) mirror_frames(g, from, n, axis);
    if (reflects) cells_turn_vectors(n, g->dim, false, axis, inner + 1);
    patch_ghosts(g, r, &line, inner, ghost);
    if (reflects) cells_turn_vectors(n, g->dim, true, axis, ghost + 1);
    for (int v = 0; v < g->nvar; v++) memcpy(U[v] + m->ncells + from, ghost[v], (size_t)n * sizeof(double));
}

/* The gas on a wall that holds it has the wall's velocity w: with 2 w - u beyond it polynomials keep the slope that
 * friction makes. (Fluxes through the wall itself see a plain mirror: they pass on pressure alone.) */
static void held_run(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = from; i < from + n; i++) {
        const int cell = m->mirror.cell[i], mirror = m->ncells + i;
        const double rho = U[0][cell];
        double work = 0, w[MAX_DIM];
        wall_velocity(&g->patches.rules[m->mirror.patch[from]], g->components, m->mirror.place[i], w);
        for (int k = 0; k < g->components; k++) {
            work += w[k] * (rho * w[k] - U[k + 1][cell]);
            U[k + 1][mirror] = 2 * rho * w[k] - U[k + 1][cell];
        }
        U[0][mirror] = rho;
        U[energy_at(g)][mirror] = U[energy_at(g)][cell] + 2 * work;
    }
}

/* The number of mirrors from `from` on, before `to`, that are of one patch; a batch at most. */
static int patch_run(const struct gas *g, int from, int to) {
    const int *patch = g->cells->polyhedra->mirror.patch;
    int end = from + 1;
    while (end < to && end < from + BATCH && patch[end] == patch[from]) end++;
    return end - from;
}

void cells_mirrors(const struct gas *g, int from, int to, double *const U[MAX_VAR]) {
    for (int n; from < to; from += n) {
        const struct patch_rules *r = &g->patches.rules[g->cells->polyhedra->mirror.patch[from]];
        const bool held = g->models.transport && wall_holds(r);
        n = patch_run(g, from, to);
        (held ? held_run : mirror_run)(g, from, n, U);
        if (g->models.swirl && patch_is_wall(r)) cells_round_beyond(g, from, n, held, U);
    }
}

void cells_beyond(const struct gas *g, int patch, int n, const int *face, const int *place, double (*q)[BATCH],
                  double (*ghost)[BATCH]) {
    const struct polyhedra_faces *faces = &g->cells->polyhedra->face;
    const struct patch_rules *r = &g->patches.rules[patch];
    double inner[MAX_VAR][BATCH], outflow[BATCH], axis[MAX_DIM][MAX_DIM][BATCH];
    struct patch_line line = {.n = n, .face = place, .outflow = outflow};
    const bool reflects = patch_is_wall(r);
    for (int v = 0; v < g->nvar; v++) memcpy(inner[v], q[v], (size_t)n * sizeof(double));
    for (int i = 0; i < n; i++) outflow[i] = q[1][i] / q[0][i];
    if (!reflects) find_frames(g->dim, n, face, 0, faces->normal, faces->tangent, axis);
    if (!reflects) cells_turn_vectors(n, g->dim, true, axis, inner + 1);
    patch_ghosts(g, r, &line, inner, ghost);
    if (!reflects) cells_turn_vectors(n, g->dim, false, axis, ghost + 1);
}

/* How many times component k of the velocity of a cell is at the face of a mirror what it is in the cell: swirl of a
 * rigid rotation is so far from the axis. */
static double turn_out(const struct gas *g, int k, int mirror) {
    return k == g->models.swirl && k > 0 ? cells_turn_out(g, g->cells->diffuser->turn, mirror) : 1;
}

/* Square of the velocity of the gas along the wall at a mirror, less the wall's own. */
static double slip_at(const struct gas *g, const struct patch_rules *r, int mirror, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int cell = m->mirror.cell[mirror];
    double w[MAX_DIM], square = 0, across = 0;
    wall_velocity(r, g->components, m->mirror.place[mirror], w);
    for (int k = 0; k < g->components; k++) {
        const double s = turn_out(g, k, mirror) * (U[k + 1][cell] / U[0][cell]) - w[k];
        square += s * s;
        if (k < g->dim) across += s * m->mirror.normal[k][mirror];
    }
    return larger(square - across * across, 0);
}

/* Sets the shares at an open patch. */
static void note_inflow(const struct gas *g, int from, int n, double *const U[MAX_VAR], const struct cells_walls *out) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = from; i < from + n; i++) {
        const int at = m->mirror.cell[i];
        double through = 0;
        for (int k = 0; k < g->dim; k++) through += U[k + 1][at] * m->mirror.normal[k][i];
        out->drag[i] = out->heat[i] = inflow_share(through);
    }
}

static void wall_shares_run(const struct gas *g, int from, int n, double *const U[MAX_VAR], const double *T,
                            double *const cell[3], const double *cross, const struct cells_walls *out) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->patches.rules[m->mirror.patch[from]];
    double inner[5][BATCH], push[BATCH], d[BATCH], slip[BATCH];
    struct wall_line line = {.n = n,
                             .face = m->mirror.place + from,
                             .eos = g->models.eos,
                             .material = &g->models.material,
                             .rho = inner[0],
                             .T = inner[1],
                             .push = push,
                             .d = d,
                             .shear = inner[2],
                             .heat = inner[3],
                             .slip = slip,
                             .cross = cross ? inner[4] : NULL};
    for (int i = 0; i < n; i++) {
        const int at = m->mirror.cell[from + i];
        inner[0][i] = U[0][at];
        inner[1][i] = T[at];
        inner[2][i] = cell[1][at];
        inner[3][i] = cell[2][at];
        inner[4][i] = cross ? cross[at] : 0;
        d[i] = push[i] = out->drag[from + i] = out->heat[from + i] = out->lift[from + i] = 0;
        for (int k = 0; k < g->dim; k++) {
            push[i] += g->diffusion.pull[k] * m->mirror.normal[k][from + i];
            d[i] += (m->centre[k][m->ncells + from + i] - m->centre[k][at]) * m->mirror.normal[k][from + i];
        }
        slip[i] = wall_slides(r) ? slip_at(g, r, from + i, U) : 0;
    }
    if (!patch_is_wall(r)) {
        note_inflow(g, from, n, U, out);
        return;
    }
    wall_shares(r, &line, out->drag + from, out->heat + from);
    memcpy(out->lift + from, line.lift, (size_t)n * sizeof(double));
    memcpy(out->stays + from, line.stays, (size_t)n * sizeof(double));
    for (int i = 0; i < n && cross; i++) {
        out->through[from + i] = line.through[i] / line.heat[i];
        out->fed[from + i] = line.fed[i];
        out->denser[from + i] = line.denser[i];
    }
}

void cells_wall_shares(const struct gas *g, double *const U[MAX_VAR], const double *T, double *const cell[3],
                       const double *cross, const struct cells_walls *out) {
    const int mirrors = g->cells->polyhedra->mirror.n;
    for (int n, from = 0; from < mirrors; from += n) {
        n = patch_run(g, from, mirrors);
        wall_shares_run(g, from, n, U, T, cell, cross, out);
    }
}

static void mirror_sums_run(const struct gas *g, const struct mirror_sums *s, int from, int n) {
    const enum diffusing what = s->what;
    const double *share = s->share, *const *start = s->start;
    double *const *S = s->S;
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->patches.rules[m->mirror.patch[from]];
    const int lines = what == VISCOUS ? g->components : 1;
    const bool turn = patch_is_wall(r) && what == VISCOUS;
    double inner[MAX_DIM][BATCH], beyond[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH], axis[MAX_DIM][MAX_DIM][BATCH];
    const struct sum_line line = {
        n, lines, what == VISCOUS ? 0 : -1, m->mirror.place + from, s->weight, share + from, inner, beyond, ghost};
    for (int c = 0; c < lines; c++) {
        for (int i = 0; i < n; i++) inner[c][i] = S[c][m->mirror.cell[from + i]];
        for (int i = 0; i < n && what == VISCOUS && c > 0 && c == g->models.swirl; i++)
            inner[c][i] *= turn_out(g, c, from + i);
        memcpy(beyond[c], start[c] + m->ncells + from, (size_t)n * sizeof(double));
    }
    if (turn) {
        mirror_frames(g, from, n, axis);
        cells_turn_vectors(n, g->dim, false, axis, inner);
        cells_turn_vectors(n, g->dim, false, axis, beyond);
    }
    sums_beyond(r, what, &line);
    if (turn) cells_turn_vectors(n, g->dim, true, axis, ghost);
    carry_sums(r, what, &line);
    if (what == HEAT && wall_conducts(r))
        for (int i = 0; i < n; i++) ghost[0][i] = inner[0][i] + share[from + i] * (ghost[0][i] - inner[0][i]);
    if (what == HEAT && patch_is_wall(r))
        for (int i = 0; i < n; i++) ghost[0][i] += s->weight * s->lift[from + i];
    for (int c = 0; c < lines; c++) memcpy(S[c] + m->ncells + from, ghost[c], (size_t)n * sizeof(double));
}

void cells_mirror_sums(const struct gas *g, const struct mirror_sums *s, int from, int to) {
    for (int n; from < to; from += n) {
        n = patch_run(g, from, to);
        mirror_sums_run(g, s, from, n);
    }
}

/* Gives mirrors their derivatives along the wall; those across the wall are the cell's. Derivatives of velocities along
 * the wall are the cell's, too. Those of the velocity across the wall are turned where gas slips, as that velocity is 0
 * on the wall; where gas is held they are the cell's, which keeps the operator symmetric
 * (libcore/polyhedral/cells_gradient.c); between these two the share of drag decides. Components beyond dim need
 * none: on the faces of patches r is 0 (libcore/polyhedral/cells_diffusion.c). */
static void mirror_gradients_run(const struct gas *g, int from, int n, const double *share, double *const *gradient) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->patches.rules[m->mirror.patch[from]];
    const int dim = g->dim, lines = g->components;
    double in[MAX_DIM][MAX_DIM][BATCH], along[MAX_DIM][BATCH], axis[MAX_DIM][MAX_DIM][BATCH];
    mirror_frames(g, from, n, axis);
    for (int k = 0; k < dim; k++) {
        for (int c = 0; c < dim; c++)
            for (int i = 0; i < n; i++) in[c][k][i] = gradient[k * lines + c][m->mirror.cell[from + i]];
        for (int c = 0; c < dim; c++) memcpy(along[c], in[c][k], (size_t)n * sizeof(double));
        cells_turn_vectors(n, dim, false, axis, along);
        for (int c = 0; c < dim; c++) memcpy(in[c][k], along[c], (size_t)n * sizeof(double));
    }
    for (int c = 0; c < dim; c++) cells_turn_vectors(n, dim, false, axis, in[c]);
    for (int t = 1; t < dim && patch_is_wall(r); t++)
        for (int i = 0; i < n; i++) in[0][t][i] *= share[from + i] - 1;
    for (int c = 0; c < dim; c++) cells_turn_vectors(n, dim, true, axis, in[c]);
    for (int k = 0; k < dim; k++) {
        for (int c = 0; c < dim; c++) memcpy(along[c], in[c][k], (size_t)n * sizeof(double));
        cells_turn_vectors(n, dim, true, axis, along);
        for (int c = 0; c < dim; c++)
            memcpy(gradient[k * lines + c] + m->ncells + from, along[c], (size_t)n * sizeof(double));
    }
}

/* The walls that gas slips along get of the work of the stress f on it what f does on the wall itself, and heat: of
 * what is left, which the mean of both cells' velocities counts as lost, a part stays in the gas. */
void cells_slide(const struct gas *g, double weight, const double *stays, double *const *S) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = 0; i < m->face.n - m->face.ninternal; i++) {
        const struct patch_rules *r = &g->patches.rules[m->mirror.patch[i]];
        const int face = m->face.ninternal + i;
        double w[MAX_DIM], drag = 0;
        if (!wall_slides(r)) continue;
        wall_velocity(r, g->components, m->mirror.place[i], w);
        for (int k = 0; k < g->components; k++) {
            const double inside = turn_out(g, k, i) * S[k][m->mirror.cell[i]];
            const double work = weight * w[k] - 0.5 * (inside + S[k][m->ncells + i]);
            const bool around = k == g->models.swirl && k > 0;
            const double arm = around ? cells_round_levers(g)[face] / m->round.reach[face] : 1;
            drag += g->cells->flux[k][face] * (around ? arm * work : work);
        }
        g->cells->flux[g->components][face] += stays[i] * drag;
    }
}

void cells_mirror_gradients(const struct gas *g, int from, int to, const double *share, double *const *gradient) {
    for (int n; from < to; from += n) {
        n = patch_run(g, from, to);
        mirror_gradients_run(g, from, n, share, gradient);
    }
}
