/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on polyhedra: links between cells, matrix entries, unknowns. The matrix,
 * from which the preconditioner is made, is that of the jumps along the lines of centres: what gradients add to the
 * fluxes is left out, and so is what couples the components. */
#include <stdlib.h>

#include "libcore/polyhedral/cells_diffuser.h"

/* The face of entry j of the cells' lists of faces, and the cell across it: of this rank, a ghost or a mirror. */
static int cell_across(const struct polyhedra *m, int j, int *face) {
    const bool right = m->face_of_cell[j] < 0;
    *face = right ? ~m->face_of_cell[j] : m->face_of_cell[j];
    return right ? m->face.left[*face] : m->face.right[*face];
}

static void link_cells(const struct polyhedra *m, const double *number, struct links *out) {
    int n = 0, face;
    for (int i = 0; i < m->nown; i++) {
        out->column[n++] = (int)number[i];
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int other = cell_across(m, j, &face);
            if (face < m->face.ninternal) out->column[n++] = (int)number[other];
        }
        out->first[++out->cells] = n;
    }
}

status cells_implicit_pattern(struct gas *g, struct links *out) {
    struct polyhedra *m = g->cells->polyhedra;
    double *number, skewed = g->cells->diffuser->skewed;
    long first;
    comm_max(g->comm, &skewed, 1);
    out->symmetric = skewed == 0;
    TRY(implicit_first(g, m->nown, &first));
    TRY(allocate(&out->first, m->nown + 1, sizeof(int), "the links of cells"));
    TRY(allocate(&out->column, (long)m->nown + m->face_start[m->nown], sizeof(int), "the links of cells"));
    TRY(allocate(&number, m->size, sizeof(double), "the links of cells"));
    for (int i = 0; i < m->nown; i++) number[i] = (double)(first + i);
    polyhedra_fill_start(m, 1, &number);
    polyhedra_fill_finish(m);
    link_cells(m, number, out);
    free(number);
    return OK;
}

/* Component c of the flux that a jump between its two cells makes through face i. */
static double passed(const struct gas *g, enum diffusing what, int i, int c, const double jump[MAX_DIM]) {
    const struct cells_diffuser *d = g->cells->diffuser;
    double *const *normal = g->cells->polyhedra->face.normal, along = 0;
    if (what == HEAT) return d->face[2][i] * d->inverse[i] * jump[0];
    for (int k = 0; k < g->dim; k++) along += normal[k][i] * jump[k];
    if (c >= g->dim) return d->face[1][i] * jump[c] * d->inverse[i];
    return (d->face[1][i] * jump[c] + (d->face[0][i] + d->face[1][i]) * normal[c][i] * along) * d->inverse[i];
}

/* Writes the weights of the links of unknown c; returns where the next weights go. */
static double *weigh_links(const struct gas *g, enum diffusing what, int c, double per, const double *mass,
                           double *const *S, double *weight) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = 0, face; i < m->nown; i++) {
        double *self = weight++;
        *self = mass[i];
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int other = cell_across(m, j, &face);
            const bool inside = face < m->face.ninternal;
            double jump[MAX_DIM] = {0};
            jump[c] = 1;
            for (int k = 0; k < (what == VISCOUS ? g->components : 1) && !inside; k++) jump[k] -= S[k][other];
            const double w = per * passed(g, what, face, c, jump);
            *self += w;
            if (inside) *weight++ = -w;
        }
    }
    return weight;
}

/* Computes the matrix. At patches its entries follow from S beyond the patch for S = 1 inside and values of 0; the last
 * S is free at this time, and holds that 1. */
void cells_implicit_matrix(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double *mass,
                           double *E, double *weight) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    const int unknowns = what == VISCOUS ? g->components : 1;
    const double per = what == HEAT ? temperature_of(&g->models.material, factor) : factor;
    double *const *S = d->sum[d->last], *U[MAX_VAR];
    cells_lines(g, Y0, U);
    for (int i = 0; i < m->nown; i++) {
        mass[i] = m->volume[i] * U[0][i];
        E[i] = m->volume[i] * U[g->components + 1][i];
    }
    for (int c = 0; c < unknowns; c++) {
        for (int k = 0; k < unknowns; k++)
            for (int i = 0; i < m->nown; i++) S[k][i] = k == c;
        cells_mirror_sums(g, what, 0, 0, m->face.n - m->face.ninternal, what == VISCOUS ? d->wall.drag : d->wall.heat,
                          d->wall.lift, (const double *const *)d->start, S);
        weight = weigh_links(g, what, c, per, mass, S, weight);
    }
}

void cells_implicit_move(struct gas *g, enum diffusing what, double *x, bool to_sums) {
    const struct cells_diffuser *d = g->cells->diffuser;
    const int unknowns = what == VISCOUS ? g->components : 1, nown = g->cells->polyhedra->nown;
    for (int c = 0; c < unknowns; c++) {
        double *S = d->sum[d->last][c];
        for (int i = 0; i < nown; i++) {
            if (to_sums)
                S[i] = x[i * unknowns + c];
            else
                x[i * unknowns + c] = S[i];
        }
    }
}
