/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stress around the axis in bodies of revolution on polyhedra (docs/physics.md 1.4). Areas and volumes have the
 * weight r, so that the stress through the faces of a cell leaves the force of tau_ss on its sides along the radius,
 * -tau_ss A_2/V (libcore/polyhedral/cells_round.c). tau_ss is found on the faces, with the coefficients and derivatives
 * of the stress there: uniform stress is in balance to round-off. The cell has the mean of its faces, each with the
 * part of the cell between its centre and the face. The rate of strain u_r/r is the cells' own, with r of their
 * centres, between both; on patches it is u_r of the face over r. So u_r = a r is exact on any mesh.
 *
 * The stress of a swirl is mu r grad w, w = u_s/r, and rigid rotation has none: gradients and jumps are those of w,
 * with r of the centres of cells and, beyond patches, of the face. The flux through a face is that of the momentum at
 * its lever, as in cells_round.c; its work is that of the torque with w on the face. */
#include <stdlib.h>

#include "libcore/polyhedral/cells_diffuser.h"

struct cells_turn {
    double *part;    /* [entries of face_of_cell] weights of the means over faces */
    double *inverse; /* [size] 1/r of centres, of mirrors 1/r of their faces; on the axis that of the cell inside */
    double *spin;    /* [size], a batch of lanes longer: w, 1/s; NULL: there is no swirl */
    double *around;  /* [faces] u_r/r */
    double *hoop;    /* [faces] tau_ss times the area */
};

void cells_turn_free(struct cells_turn *t) {
    if (!t) return;
    free(t->part);
    free(t->inverse);
    free(t->spin);
    free(t->around);
    free(t->hoop);
    free(t);
}

/* Sets the weights of the faces of cell i, over their areas. */
static void set_parts(const struct polyhedra *m, int i, double *part) {
    double sum = 0;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int right = m->face_of_cell[j] < 0, face = right ? ~m->face_of_cell[j] : m->face_of_cell[j];
        double far = 0;
        for (int k = 0; k < m->dim; k++) far += cells_arm(m, face, right, k) * m->face.normal[k][face];
        part[j] = larger(right ? -far : far, 0);
        sum += part[j] * m->face.area[face];
    }
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) part[j] /= sum;
}

status cells_turn_make(const struct gas *g, struct cells_turn **out) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_turn *t;
    TRY(allocate(out, 1, sizeof **out, "diffusion"));
    t = *out;
    TRY(allocate(&t->part, m->face_start[m->nown], sizeof(double), "diffusion"));
    TRY(allocate(&t->inverse, m->size, sizeof(double), "diffusion"));
    TRY(allocate(&t->around, m->face.n + SLACK, sizeof(double), "diffusion"));
    TRY(allocate(&t->hoop, m->face.n + SLACK, sizeof(double), "diffusion"));
    for (int i = 0; i < m->nown; i++) set_parts(m, i, t->part);
    if (g->models.swirl) TRY(allocate(&t->spin, m->size + LANES, sizeof(double), "diffusion"));
    for (int i = 0; i < m->ncells; i++) t->inverse[i] = 1 / (m->centre[m->round.radial][i] - m->round.at);
    for (int i = 0; i < m->mirror.n; i++) {
        const double rim = m->round.rim[i];
        t->inverse[m->ncells + i] = rim < NO_RADIUS ? t->inverse[m->mirror.cell[i]] : 1 / rim;
    }
    return OK;
}

double *cells_turn_spin(const struct gas *g, const struct cells_turn *t, double *const *S, int from, int to) {
    for (int i = from; i < to; i++) t->spin[i] = S[g->models.swirl][i] * t->inverse[i];
    return t->spin;
}

double cells_turn_out(const struct gas *g, const struct cells_turn *t, int mirror) {
    const struct polyhedra *m = g->cells->polyhedra;
    return t->inverse[m->mirror.cell[mirror]] / t->inverse[m->ncells + mirror];
}

void cells_turn_faces(const struct gas *g, struct cells_turn *t, int at, int n, double *const *S, const double **around,
                      double **hoop) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *share = g->cells->diffuser->share, *u = S[m->round.radial];
    for (int i = at; i < at + n; i++) {
        const int left = m->face.left[i], right = m->face.right[i];
        const double a = u[left] * t->inverse[left], reach = m->round.reach[i];
        if (i < m->face.ninternal)
            t->around[i] = a + share[i] * (u[right] * t->inverse[right] - a);
        else
            t->around[i] = reach < NO_RADIUS ? a : 0.5 * (u[left] + u[right]) / reach;
    }
    *around = t->around + at;
    *hoop = t->hoop + at;
}

void cells_turn_push(const struct gas *g, const struct cells_turn *t, int v, int at, int n, double *M) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = 0; i < n && g->models.swirl && v == g->models.swirl; i++)
        M[i] = cells_round_torque(g, at + i, g->cells->flux[v]);
    if (v != m->round.radial) return;
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int j = m->face_start[at + i]; j < m->face_start[at + i + 1]; j++)
            sum += t->part[j] * t->hoop[m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j]];
        M[i] -= cells_round_side(g, at + i) * sum;
    }
}

/* The sum over the faces of cell i that bounds the rate of the swirl. */
static double rate_around(const struct gas *g, const struct cells_turn *t, int i) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    const double *lever = cells_round_levers(g);
    double sum = 0;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
        sum += d->face[1][face] * d->inverse[face] * (lever[face] * lever[face]);
    }
    return sum * t->inverse[i] / polyhedra_arm(m, i);
}

double cells_turn_rate(const struct gas *g, const struct cells_turn *t, int i, double plane) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    double sum = 0;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
        sum += t->part[j] * (d->face[0][face] + 2 * d->face[1][face]);
    }
    sum = plane + sum * cells_round_side(g, i) * t->inverse[i] / g->cells->inverse_volume[i];
    return g->models.swirl ? larger(sum, rate_around(g, t, i)) : sum;
}
