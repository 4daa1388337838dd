/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes through the faces of patches on polyhedra (libcore/gas/tally.h). The lines have the order of the faces; they
 * hold fluxes through whole faces. */
#include "libcore/polyhedral/cells_diffuser.h"

void cells_tally_stage(struct gas *g) {
    const struct tally *t = g->books.tally;
    for (int v = 0; v < g->nvar; v++)
        memcpy(t->stage[v], g->cells->flux[v] + g->cells->polyhedra->face.ninternal, (size_t)t->faces * sizeof(double));
}

status cells_tally_rest(struct gas *g, double weight, double *force) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int face = f->ninternal; face < f->n && g->cells->rest; face++) {
        const double missed = weight * cells_rest_of_wall(g, face) * f->area[face];
        for (int k = 0; k < g->dim; k++)
            g->books.tally->flow[k + 1][face - f->ninternal] -= missed * f->normal[k][face];
    }
    for (int k = 0; k < g->dim && force && g->cells->rest; k++) {
        cells_rest_added(g, k, g->cells->line);
        TRY(sum_raised(g, g->cells->line, &force[k]));
    }
    return OK;
}

void cells_tally_diffusion(struct gas *g, enum diffusing what, double dt) {
    const struct tally *t = g->books.tally;
    const int first = g->cells->polyhedra->face.ninternal;
    for (int v = 0; v <= g->components && what == VISCOUS; v++)
        tally_add(t, v < g->components ? 1 : 1 / dt, g->cells->flux[v] + first, t->passed[v]);
    if (what == HEAT) tally_add(t, 1, g->cells->flux[0] + first, t->passed[energy_at(g)]);
}

void cells_tally_cross(struct gas *g, double dt) {
    const double *cross = g->cells->diffuser->cross + g->cells->polyhedra->face.ninternal;
    tally_add(g->books.tally, dt, cross, g->books.tally->passed[energy_at(g)]);
}

static void visit_face(const struct gas *g, int face, edge_face_visitor *visit, void *context) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int at = face - m->face.ninternal;
    struct gas_face out = {.patch = m->face.patch[at], .area = m->thickness * m->face.area[face]};
    for (int k = 0; k < g->dim; k++) {
        out.normal[k] = m->face.normal[k][face];
        out.centre[k] = m->centre[k][m->face.left[face]] + cells_arm(m, face, 0, k);
    }
    visit(context, at, m->thickness, &out);
}

void cells_edges(const struct gas *g, int block, edge_face_visitor *visit, void *context) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = m->block_start[block]; i < m->block_start[block + 1]; i++) {
        const int cell = m->block_cell[i];
        for (int j = m->face_start[cell]; j < m->face_start[cell + 1]; j++)
            if (m->face_of_cell[j] >= m->face.ninternal) visit_face(g, m->face_of_cell[j], visit, context);
    }
}
