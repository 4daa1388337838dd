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
    double (*part)[BATCH]; /* as faces of chunks: weights of the means over faces, over their areas */
    double *inverse; /* [size] 1/r of centres, of mirrors 1/r of their faces; on the axis that of the cell inside */
    double *widens;  /* [ncells] u_r/r */
    double *spin;    /* [size], a batch of lanes longer: w, 1/s; NULL: there is no swirl */
    double *around;  /* [faces] u_r/r */
    double *hoop;    /* [faces] tau_ss times the area */
    double *rate[2]; /* [nown] of cells_turn_rates: by the stress around the axis; and that of the swirl, or 0 */
};

void cells_turn_free(struct cells_turn *t) {
    if (!t) return;
    free(t->part);
    free(t->inverse);
    free(t->widens);
    free(t->spin);
    free(t->around);
    free(t->hoop);
    for (int i = 0; i < 2; i++) free(t->rate[i]);
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

static status make_parts(const struct gas *g, struct cells_turn *t) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *part;
    TRY(allocate(&part, m->face_start[m->nown], sizeof *part, "diffusion"));
    for (int i = 0; i < m->nown; i++) set_parts(m, i, part);
    const status s = cells_sides_weights(g->cells, part, &t->part);
    free(part);
    return s;
}

status cells_turn_make(const struct gas *g, struct cells_turn **out) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_turn *t;
    TRY(allocate(out, 1, sizeof **out, "diffusion"));
    t = *out;
    TRY(allocate(&t->inverse, m->size, sizeof(double), "diffusion"));
    TRY(allocate(&t->widens, m->ncells, sizeof(double), "diffusion"));
    TRY(allocate(&t->around, m->face.n + SLACK, sizeof(double), "diffusion"));
    TRY(allocate(&t->hoop, m->face.n + SLACK, sizeof(double), "diffusion"));
    for (int i = 0; i < 2; i++) TRY(allocate(&t->rate[i], m->nown, sizeof(double), "diffusion"));
    if (g->models.swirl) TRY(allocate(&t->spin, m->size + LANES, sizeof(double), "diffusion"));
    for (int i = 0; i < m->ncells; i++) t->inverse[i] = 1 / (m->centre[m->round.radial][i] - m->round.at);
    for (int i = 0; i < m->mirror.n; i++) {
        const double rim = m->round.rim[i];
        t->inverse[m->ncells + i] = rim < NO_RADIUS ? t->inverse[m->mirror.cell[i]] : 1 / rim;
    }
    return make_parts(g, t);
}

void cells_turn_see(const struct gas *g, const struct cells_turn *t, int from, int to, double **S) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *u = S[m->round.radial], *swirl = S[g->models.swirl];
    for (int i = from; i < to && i < m->ncells; i++) t->widens[i] = u[i] * t->inverse[i];
    for (int i = from; i < to && t->spin; i++) t->spin[i] = swirl[i] * t->inverse[i];
    if (t->spin) S[g->models.swirl] = t->spin;
}

double cells_turn_out(const struct gas *g, const struct cells_turn *t, int mirror) {
    const struct polyhedra *m = g->cells->polyhedra;
    return t->inverse[m->mirror.cell[mirror]] / t->inverse[m->ncells + mirror];
}

KERNEL static void mix_widens(int n, const int *restrict left, const int *restrict right, const double *restrict share,
                              const double *restrict widens, double *restrict around) {
    for (int i = 0; i < n; i++) {
        const double a = widens[left[i]];
        around[i] = a + share[i] * (widens[right[i]] - a);
    }
}

void cells_turn_faces(const struct gas *g, struct cells_turn *t, int at, int n, const double *u, const double **around,
                      double **hoop) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int inside = at + n < m->face.ninternal ? n : m->face.ninternal > at ? m->face.ninternal - at : 0;
    mix_widens(inside, m->face.left + at, m->face.right + at, g->cells->diffuser->share + at, t->widens,
               t->around + at);
    for (int i = at + inside; i < at + n; i++) {
        const int left = m->face.left[i];
        const double reach = m->round.reach[i];
        t->around[i] = reach < NO_RADIUS ? t->widens[left] : 0.5 * (u[left] + u[m->face.right[i]]) / reach;
    }
    *around = t->around + at;
    *hoop = t->hoop + at;
}

void cells_turn_push(const struct gas *g, const struct cells_turn *t, int v, int at, int n, double *M) {
    double sum[BATCH];
    if (t->spin && v == g->models.swirl) cells_round_torque(g, at, n, g->cells->flux[v], M);
    if (v != g->cells->polyhedra->round.radial) return;
    cells_sides_sum(g->cells, at, (const double(*)[BATCH])t->part, t->hoop, t->hoop, sum);
    for (int i = 0; i < n; i++) M[i] -= cells_round_side(g, at + i) * sum[i];
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

void cells_turn_rates(const struct gas *g, struct cells_turn *t) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *const *face = g->cells->diffuser->face, *all = t->hoop, sum[BATCH];
    for (int f = 0; f < m->face.n; f++) all[f] = face[0][f] + 2 * face[1][f];
    for (int at = 0; at < m->nown; at += BATCH) {
        cells_sides_sum(g->cells, at, (const double(*)[BATCH])t->part, all, all, sum);
        for (int i = at; i < m->nown && i < at + BATCH; i++)
            t->rate[0][i] = sum[i - at] * cells_round_side(g, i) * t->inverse[i] / g->cells->inverse_volume[i];
    }
    for (int i = 0; i < m->nown && t->spin; i++) t->rate[1][i] = rate_around(g, t, i);
}

double cells_turn_rate(const struct cells_turn *t, int i, double plane) {
    return larger(plane + t->rate[0][i], t->rate[1][i]);
}
