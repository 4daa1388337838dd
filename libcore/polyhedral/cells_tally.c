/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes through the faces of patches on polyhedra (libcore/gas/tally.h). The lines have the order of the faces; they
 * hold fluxes through whole faces. */
#include "libcore/polyhedral/cells_diffuser.h"

status cells_tally_make(const struct gas *g, struct tally *t) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    t->faces = f->n - f->ninternal;
    t->borrowed = true;
    for (int v = 0; v < g->nvar; v++) t->stage[v] = g->cells->flux[v] + f->ninternal;
    return OK;
}

void cells_tally_still(struct gas *g, double weight) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int face = f->ninternal; face < f->n && g->cells->rest; face++) {
        const double missed = weight * cells_rest_of_wall(g, face) * f->area[face];
        for (int k = 0; k < g->dim; k++)
            g->books.tally->flow[k + 1][face - f->ninternal] -= missed * f->normal[k][face];
    }
}

void cells_tally_bed(struct gas *g, double dt) {
    const struct polyhedra_faces *faces = &g->cells->polyhedra->face;
    const struct bed_set *bed = g->dense->bed.home;
    for (int f = 0; f < bed->faces; f++) {
        const int face = bed->shape[f];
        if (face < faces->ninternal) continue;
        for (int v = 0; v < g->nvar; v++) {
            double *flow = &g->books.tally->flow[v][face - faces->ninternal];
            *flow = (g->step.hybrid ? 0 : *flow) + dt * faces->area[face] * bed->kept[v][f];
        }
    }
}

void cells_tally_diffusion(struct gas *g, enum diffusing what, double dt) {
    const struct tally *t = g->books.tally;
    for (int v = 0; v <= g->components && what == VISCOUS; v++)
        tally_add(t, v < g->components ? 1 : 1 / dt, t->stage[v], t->passed[v]);
    if (what == HEAT) tally_add(t, 1, t->stage[0], t->passed[energy_at(g)]);
}

void cells_tally_cross(struct gas *g, double dt) {
    const double *cross = g->cells->diffuser->cross + g->cells->polyhedra->face.ninternal;
    tally_add(g->books.tally, dt, cross, g->books.tally->passed[energy_at(g)]);
}

static void visit_face(const struct gas *g, int face, gas_face_visitor *visit, void *context) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int at = face - m->face.ninternal;
    struct gas_face out = {.patch = m->face.patch[at], .area = m->thickness * m->face.area[face]};
    for (int k = 0; k < g->dim; k++) {
        out.normal[k] = m->face.normal[k][face];
        out.centre[k] = m->centre[k][m->face.left[face]] + cells_arm(m, face, 0, k);
    }
    tally_face(g, at, m->thickness, &out);
    visit(context, &out);
}

void cells_tally_visit(const struct gas *g, int block, gas_face_visitor *visit, void *context) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int i = m->block_start[block]; i < m->block_start[block + 1]; i++) {
        const int cell = m->block_cell[i];
        for (int j = m->face_start[cell]; j < m->face_start[cell + 1]; j++)
            if (m->face_of_cell[j] >= m->face.ninternal) visit_face(g, m->face_of_cell[j], visit, context);
    }
}
