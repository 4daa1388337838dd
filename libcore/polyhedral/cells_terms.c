/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the transport law asks for on polyhedra besides stress and conduction: the heat flux -cross grad rho, and the
 * heat that goes with div u (libcore/models/transport.h). */
#include "libcore/polyhedral/cells_diffuser.h"

status cells_cross_make(struct gas *g, struct cells_diffuser *d) {
    const struct polyhedra *m = g->cells->polyhedra;
    double **of_mirrors[] = {&d->wall.through, &d->wall.fed, &d->wall.denser};
    for (int i = 0; i < 3; i++) TRY(allocate(of_mirrors[i], m->mirror.n, sizeof(double), "diffusion"));
    return allocate(&d->cross, m->face.n + 1, sizeof *d->cross, "diffusion");
}

void cells_cross_coefficients(struct gas *g, const double *rho) {
    struct cells_diffuser *d = g->cells->diffuser;
    const struct gas_models *m = &g->models;
    const int size = g->cells->polyhedra->size;
    for (int at = 0; at < size; at += BATCH) {
        const int n = size - at < BATCH ? size - at : BATCH;
        const struct closure_line cells = {.eos = m->eos,
                                           .material = &m->material,
                                           .n = n,
                                           .rho = rho + at,
                                           .T = d->T + at,
                                           .shear_rate = shear_rate_at(g, m->transport->needs, 0, at)};
        m->transport->cross(&m->transport_params, &cells, d->start[0] + at);
    }
}

/* The gradients of rho in the cells, to d->gradient, where faces need them. Beyond walls that conduct rho has the slope
 * of the wall. */
static void find_slopes(struct gas *g, const double *rho) {
    const struct cells_diffuser *d = g->cells->diffuser;
    const struct polyhedra *m = g->cells->polyhedra;
    double *line = d->sum[0][0];
    memcpy(line, rho, (size_t)m->size * sizeof *line);
    for (int i = 0; i < m->mirror.n; i++) line[m->ncells + i] += d->wall.denser[i];
    cells_gradients(g->dim, &g->cells->gradient, 1, 0, m->nnear, &line, d->gradient);
}

/* Through the faces between cells, and through open patches, as heat_faces does with T. */
static void open_faces(struct gas *g, const double *rho, bool skewed) {
    const struct cells_diffuser *d = g->cells->diffuser;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const double *cross = d->start[0], thin = g->diffusion.terms.thin / packing_per_density(&g->models.material);
    for (int i = 0; i < f->n; i++) {
        const int left = f->left[i], right = f->right[i];
        double slope = (rho[right] - rho[left]) * d->inverse[i];
        for (int k = 0; k < g->dim && skewed && i < f->ninternal; k++)
            slope += d->keep[i] * d->oblique[k][i] * (0.5 * (d->gradient[k][left] + d->gradient[k][right]));
        const bool alike = cross[left] * cross[right] > 0; /* else cross passes through 0 between the cells */
        const double most = 2 * harmonic(d->share[i], fabs(cross[left]) * rho[left], fabs(cross[right]) * rho[right]);
        const double mean = alike ? harmonic(d->share[i], cross[left], cross[right]) : 0;
        d->cross[i] = cross_jump(thin, -f->area[i] * mean, slope, smaller(rho[left], rho[right]),
                                 f->area[i] * most * d->inverse[i]);
    }
}

void cells_cross_faces(struct gas *g, const double *rho) {
    struct cells_diffuser *d = g->cells->diffuser;
    const struct polyhedra *m = g->cells->polyhedra;
    const bool skewed = d->skewed && g->dim > 1;
    if (skewed) find_slopes(g, rho);
    open_faces(g, rho, skewed);
    for (int face = m->face.ninternal; face < m->face.n; face++) {
        const int i = face - m->face.ninternal;
        const struct patch_rules *r = &g->patches.rules[m->mirror.patch[i]];
        if (!patch_is_wall(r)) continue;
        d->cross[face] = -m->face.area[face] * d->wall.fed[i];
        if (wall_conducts(r)) d->face[2][face] *= d->wall.through[i];
    }
}

void cells_cross_drop(struct gas *g) {
    const struct cells *c = g->cells;
    const struct polyhedra_faces *f = &c->polyhedra->face;
    for (int i = 0; i < f->n; i++)
        if (g->limits.flags.cells[0][f->left[i]] + g->limits.flags.cells[0][f->right[i]] > 0) c->diffuser->cross[i] = 0;
}

void cells_diffusion_cross(struct gas *g, const struct state *to, double dt) {
    const int nown = g->cells->polyhedra->nown;
    double *U[MAX_VAR], sum[BATCH];
    cells_lines(g, to, U);
    for (int at = 0; at < nown; at += BATCH) {
        const int n = nown - at < BATCH ? nown - at : BATCH;
        double *E = U[energy_at(g)] + at;
        cells_residuals(g->cells, at, n, g->cells->diffuser->cross, sum);
        for (int i = 0; i < n; i++) E[i] += dt * sum[i];
    }
    if (g->books.tally) cells_tally_cross(g, dt);
}

/* The volume that the gas on a face sweeps beyond what the gas of the cell does, so that the sum over the faces of a
 * cell in uniform gas is exactly 0. Gas on a wall sweeps nothing. In a body of revolution the gas of the cell itself
 * sweeps the difference of its sides. */
static double swept_beyond(const struct gas *g, double *const U[MAX_VAR], int cell, int face) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct polyhedra_faces *f = &m->face;
    const bool left = f->left[face] == cell;
    const int other = left ? f->right[face] : f->left[face];
    const bool wall = face >= f->ninternal && patch_is_wall(&g->patches.rules[m->mirror.patch[face - f->ninternal]]);
    const double share = g->cells->diffuser->share[face], part = left ? share : 1 - share;
    double sum = 0;
    for (int k = 0; k < g->dim; k++) {
        const double own = U[k + 1][cell] / U[0][cell];
        sum += f->normal[k][face] * (wall ? -own : part * (U[k + 1][other] / U[0][other] - own));
    }
    return (left ? 1 : -1) * f->area[face] * sum;
}

void cells_diffusion_spread(const struct gas *g, const struct state *from, const struct state *to,
                            const struct row *row, double *spread) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *U[2][MAX_VAR];
    cells_lines(g, from, U[0]);
    cells_lines(g, to, U[1]);
    for (int i = 0; i < row->n; i++) {
        const int cell = (int)row->at + i;
        double sum = 0;
        for (int j = m->face_start[cell]; j < m->face_start[cell + 1]; j++) {
            const int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
            sum += swept_beyond(g, U[0], cell, face) + swept_beyond(g, U[1], cell, face);
        }
        spread[i] = 0.5 * g->cells->inverse_volume[cell] * sum;
        for (int k = 0; k < 2 && g->cells->round; k++)
            spread[i] += 0.5 * cells_round_side(g, cell) * (U[k][m->round.radial + 1][cell] / U[k][0][cell]);
    }
}
