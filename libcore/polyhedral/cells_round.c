/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pressure of bodies of revolution on polyhedra (struct polyhedra_round; docs/physics.md 1.4). Areas and volumes
 * have the weight r, so that the fluxes through the faces of a cell leave the force of the pressure on its sides along
 * the radius: p A_2/V, A_2 the area of the cell in the plane, p its mean there. A_2 is taken as the sum over the faces
 * of area times normal, which is the same: uniform p is in balance to round-off. The mean is that of a linear p, whose
 * slope comes from the states of the cell's own polynomial on its faces, as the average of a cell stands at another
 * centre. */
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

struct cells_round {
    double *side;      /* [nown] A_2/V, 1/m */
    double *length;    /* [faces] of the faces in the plane, m^(dim-1) */
    double *inside[2]; /* [faces] Pa: p on a face by the polynomial of its left and right cell */
};

void cells_round_free(struct cells_round *r) {
    if (!r) return;
    free(r->side);
    free(r->length);
    for (int side = 0; side < 2; side++) free(r->inside[side]);
    free(r);
}

status cells_round_make(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    if (m->round.radial < 0) return OK;
    TRY(allocate(&c->round, 1, sizeof *c->round, "the cells"));
    TRY(allocate(&c->round->side, m->nown, sizeof(double), "the cells"));
    TRY(allocate(&c->round->length, m->face.n, sizeof(double), "the faces"));
    for (int side = 0; side < 2; side++) TRY(allocate(&c->round->inside[side], m->face.n, sizeof(double), "the faces"));
    for (int face = 0; face < m->face.n; face++) c->round->length[face] = m->face.area[face] / m->round.reach[face];
    for (int i = 0; i < m->nown; i++) {
        double sum = 0;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int entry = m->face_of_cell[j], face = entry < 0 ? ~entry : entry;
            const double part = m->face.area[face] * m->face.normal[m->round.radial][face];
            sum += entry < 0 ? -part : part;
        }
        c->round->side[i] = sum * c->inverse_volume[i];
    }
    return OK;
}

void cells_round_note(const struct gas *g, int first, int last, const double *left, const double *right) {
    const int *start = g->cells->polyhedra->face.point_start;
    const double *const p[2] = {left, right};
    for (int side = 0; side < 2; side++)
        for (int face = first; face < last; face++) {
            double sum = 0;
            for (int i = start[face]; i < start[face + 1]; i++) sum += p[side][i - start[first]];
            g->cells->round->inside[side][face] = sum / (start[face + 1] - start[face]);
        }
}

/* By how much the mean of p in the plane differs from p of the average of cell i. */
static double plane_mean(const struct gas *g, int i) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double volume = m->volume[i] / m->round.radius[i];
    double sum = 0;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int entry = m->face_of_cell[j], face = entry < 0 ? ~entry : entry;
        double along = 0;
        for (int k = 0; k < m->dim; k++) along += m->round.lag[k][i] * m->face.normal[k][face];
        const double part = g->cells->round->length[face] * along * g->cells->round->inside[entry < 0][face];
        sum += entry < 0 ? -part : part;
    }
    return sum / volume;
}

void cells_round_push(const struct gas *g, int at, int n, const double *U, double *const residual[MAX_VAR]) {
    const int radial = g->cells->polyhedra->round.radial;
    struct cells_primitives q;
    cells_primitives(g, n, U, &q);
    for (int i = 0; i < n; i++)
        residual[radial + 1][i] += g->cells->round->side[at + i] * (q.p[i] + plane_mean(g, at + i));
}

double cells_round_side(const struct gas *g, int i) {
    return g->cells->round->side[i];
}
