/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the lattice of a segregation in two or three dimensions: checks, faces, boundary, the projection of the flow
 * (segregation_box.h). */
#include "solvers/segregation/segregation_box.h"

#include "libcore/models/boundary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct builder {
    const struct setup *s;
    const struct segregation_models *m;
    const struct field *phi;
    const struct segregation_flow *flow;
    struct segregation_box *b;
};

static status check(const struct builder *a) {
    const struct segregation_models *m = a->m;
    const struct setup *s = a->s;
    if (!s->lattice)
        return fail(ERR_INPUT, "%s: with %d solved axes segregation takes a lattice of equal boxes: %s", s->mesh_path,
                    s->dim, s->why);
    if (m->scheme.closure != SEGREGATION_CONSERVATIVE || m->on_walls)
        return dict_fail(m->schemes, m->on_walls ? "wallValues" : "closure",
                         "with %d solved axes only  closure conservative; wallValues cell;", s->dim);
    if (m->scheme.unbounded)
        return dict_fail(m->schemes, "bounded", "with %d solved axes phi is always bounded", s->dim);
    if (!m->scheme.newton)
        return dict_fail(m->solution, "iteration", "with %d solved axes a step is one factored Newton iteration",
                         s->dim);
    if (m->percolation == PERCOLATION_EXPONENTIAL)
        return fail(ERR_INPUT, "%s: percolation: with %d solved axes it is constant, expression or kineticStress",
                    dict_path(m->properties), s->dim);
    if (!m->has_direction)
        return fail(ERR_INPUT,
                    "%s: percolation: with %d solved axes f needs a direction: add  direction (x y z);  or constant/g, "
                    "against which it is counted then",
                    dict_path(m->properties), s->dim);
    return OK;
}

static double mean_of(const double *cells, int one, int other, double standard) {
    return cells ? 0.5 * (cells[one] + cells[other]) : standard;
}

/* Sets percolation and diffusion on a face between two cells; x is its place. */
static status set_laws(const struct builder *a, int one, int other, const double x[3], int k, long at) {
    const struct segregation_models *m = a->m;
    const struct segregation_flow *flow = a->flow;
    const double weight = mean_of(flow->density, one, other, 1), shear = mean_of(flow->shear_rate, one, other, 0);
    double f = m->velocity_law ? expr_value(m->velocity_law, x[0], x[1], x[2], 0) : m->velocity;
    f = mean_of(flow->percolation, one, other, f);
    if (!isfinite(f))
        return fail(ERR_INPUT, "%s: percolation: f is %g at (%g %g %g)", dict_path(m->properties), f, x[0], x[1], x[2]);
    TRY(segregation_diffusivity_check(m, x, shear));
    a->b->f[k][at] = weight * f * m->direction[a->s->axis[k]];
    a->b->D[k][at] = weight * segregation_diffusivity(m, x, 0, shear);
    if (a->b->around[k]) memcpy(a->b->around[k] + 5 * at, (double[]){x[0], x[1], x[2], shear, weight}, 5 * sizeof *x);
    return OK;
}

static status inner_face(const struct builder *a, int one, int other, const double x[3], int k, long at) {
    const struct segregation_flow *flow = a->flow;
    const int axis = a->s->axis[k];
    TRY(set_laws(a, one, other, x, k, at));
    a->b->open[k][at] = true;
    if (!flow->U) return OK;
    const double below = flow->U[3L * one + axis], above = flow->U[3L * other + axis];
    a->b->u[k][at] =
        flow->density ? 0.5 * (flow->density[one] * below + flow->density[other] * above) : 0.5 * (below + above);
    return OK;
}

static void diffusivity_law(const void *context, int k, const double *phi, double *D) {
    const struct segregation_box *b = context;
    const long faces = b->cells / b->lattice.n[k] * (b->lattice.n[k] + 1);
    for (long i = 0; i < faces; i++) {
        const double *around = b->around[k] + 5 * i;
        const bool passes = b->open[k][i] || b->fixed[k][i];
        D[i] = passes ? around[4] * larger(0, segregation_diffusivity(b->models, around, phi[i], around[3])) : 0;
    }
}

/* Fails if the patch lets phi through but is a wall of U, or of the mesh where U has no patches. */
static status check_open(const struct builder *a, int p) {
    const struct patch_field *phi = &a->phi->patch[p], *U = a->flow->given ? &a->flow->given->patch[p] : NULL;
    const struct patch *patch = &a->s->mesh->patch[p];
    if (U ? !boundary_is_wall(boundary_find(U->type)) : !strcmp(patch->type, "patch")) return OK;
    return fail(ERR_INPUT, "%s:%d: patch %s: %s is '%s' there, a wall: phi must be noFlux", dict_path(a->phi->dict),
                phi->line, patch->name, U ? "U" : "the mesh", U ? U->type : patch->type);
}

/* Returns the velocity along axis k on face i of patch p. */
static double patch_velocity(const struct builder *a, int p, long i, int k) {
    const struct segregation_flow *flow = a->flow;
    const struct patch_field *U = flow->given ? &flow->given->patch[p] : NULL;
    const int cell = a->s->mesh->owner[a->s->mesh->patch[p].start + i], axis = a->s->axis[k];
    if (U && !strcmp(U->type, "fixedValue")) return (U->values ? U->values + 3 * i : U->uniform)[axis];
    return flow->U ? flow->U[3L * cell + axis] : 0;
}

/* Sets a face on the boundary; sign is +1 where the axis leads out. */
static status outer_face(const struct builder *a, int face, int k, long at, double sign) {
    const struct polymesh *mesh = a->s->mesh;
    struct segregation_box *b = a->b;
    int p = 0;
    while (face >= mesh->patch[p].start + mesh->patch[p].nfaces) p++;
    const struct patch_field *phi = &a->phi->patch[p];
    const long i = face - mesh->patch[p].start;
    const int cell = mesh->owner[face];
    if (!strcmp(phi->type, "noFlux")) return OK;
    TRY(check_open(a, p));
    const double u = patch_velocity(a, p, i, k);
    double x[3];
    memcpy(x, a->s->centre + 3L * cell, sizeof x);
    x[a->s->axis[k]] += 0.5 * sign * a->s->lattice->width[k];
    TRY(set_laws(a, cell, cell, x, k, at));
    b->u[k][at] = a->flow->density ? a->flow->density[cell] * u : u;
    b->fixed[k][at] = !strcmp(phi->type, "fixedValue");
    b->through = true;
    if (b->fixed[k][at]) b->value[k][at] = phi->values ? phi->values[i] : phi->uniform[0];
    if (b->fixed[k][at] || u * sign >= 0) return OK;
    return fail(ERR_INPUT, "%s:%d: patch %s: U leads in there; phi must be fixedValue", dict_path(a->phi->dict),
                phi->line, mesh->patch[p].name);
}

/* Sets the two ends of a cyclic axis, which are one face: the values at the lower end hold at both. */
static status seam(const struct builder *a, const int at[3], int cell, int k, long low, long high) {
    const struct lattice *l = a->s->lattice;
    int end[3] = {at[0], at[1], at[2]};
    end[k] = l->n[k] - 1;
    const int other = l->cell[end[0] + l->n[0] * (end[1] + (long)l->n[1] * end[2])];
    double x[3];
    memcpy(x, a->s->centre + 3L * cell, sizeof x);
    x[a->s->axis[k]] -= 0.5 * l->width[k];
    TRY(inner_face(a, other, cell, x, k, low));
    a->b->u[k][high] = a->b->u[k][low];
    a->b->f[k][high] = a->b->f[k][low];
    a->b->D[k][high] = a->b->D[k][low];
    a->b->open[k][high] = true;
    if (a->b->around[k]) memcpy(a->b->around[k] + 5 * high, a->b->around[k] + 5 * low, 5 * sizeof *x);
    return OK;
}

static status set_cell(const struct builder *a, const int at[3], int cell) {
    const struct lattice *l = a->s->lattice;
    const struct polymesh *mesh = a->s->mesh;
    for (int k = 0; k < l->dim; k++) {
        long stride[3] = {1, 1, 1}, first = 0;
        for (int i = 0, size = 1; i < 3; i++) {
            stride[i] = size;
            first += (long)at[i] * size;
            size *= l->n[i] + (i == k);
        }
        for (int side = 0; side < 2; side++) {
            const int face = l->face[6L * cell + 2 * k + side];
            const long here = first + side * stride[k];
            if (face >= mesh->ninternal && l->periodic[k]) {
                if (!side && a->b->lattice.cyclic[k]) TRY(seam(a, at, cell, k, here, here + l->n[k] * stride[k]));
            } else if (face >= mesh->ninternal) {
                TRY(outer_face(a, face, k, here, side ? 1 : -1));
            } else if (side) {
                const int one = mesh->owner[face], other = mesh->neighbour[face];
                double x[3];
                for (int i = 0; i < 3; i++) x[i] = 0.5 * (a->s->centre[3L * one + i] + a->s->centre[3L * other + i]);
                TRY(inner_face(a, one, other, x, k, here));
            }
        }
    }
    return OK;
}

static status fill(const struct builder *a) {
    const struct lattice *l = a->s->lattice;
    int at[3];
    long index = 0;
    for (at[2] = 0; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++)
            for (at[0] = 0; at[0] < l->n[0]; at[0]++, index++) {
                if (l->cell[index] < 0) continue;
                a->b->place[l->cell[index]] = (int)index;
                if (a->b->weight) a->b->weight[index] = a->flow->density[l->cell[index]];
                TRY(set_cell(a, at, l->cell[index]));
            }
    return OK;
}

static status make_arrays(const struct builder *a) {
    const struct setup *s = a->s;
    struct segregation_box *b = a->b;
    const struct lattice *l = s->lattice;
    const bool law = a->m->diffusivity_law && expr_uses(a->m->diffusivity_law, EXPR_PHI);
    b->cells = (long)l->n[0] * l->n[1] * l->n[2];
    b->lattice.dim = l->dim;
    TRY(allocate(&b->place, s->mesh->ncells, sizeof(int), "a lattice"));
    if (a->flow->density) TRY(allocate(&b->weight, b->cells, sizeof(double), "a lattice"));
    for (long i = 0; b->weight && i < b->cells; i++) b->weight[i] = 1;
    b->lattice.capacity = b->weight;
    if (law) {
        b->lattice.law = diffusivity_law;
        b->lattice.context = b;
    }
    for (int k = 0; k < 3; k++) {
        b->lattice.n[k] = l->n[k];
        b->lattice.width[k] = l->width[k];
        if (k >= l->dim) continue;
        const long faces = b->cells / l->n[k] * (l->n[k] + 1);
        TRY(allocate(&b->u[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->f[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->D[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->value[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->open[k], faces, sizeof(bool), "faces"));
        TRY(allocate(&b->fixed[k], faces, sizeof(bool), "faces"));
        if (law) TRY(allocate(&b->around[k], 5 * faces, sizeof(double), "faces"));
        b->lattice.cyclic[k] = l->periodic[k] && l->n[k] > 1; /* on an axis of one cell the flux out is the flux in */
        b->lattice.u[k] = b->u[k];
        b->lattice.f[k] = b->f[k];
        b->lattice.D[k] = b->D[k];
        b->lattice.fixed[k] = b->fixed[k];
        b->lattice.value[k] = b->value[k];
    }
    return OK;
}

static status make_solenoidal(struct segregation_box *b) {
    struct face_flow flow = {.dim = b->lattice.dim};
    for (int k = 0; k < 3; k++) {
        flow.n[k] = b->lattice.n[k];
        flow.width[k] = b->lattice.width[k];
        flow.u[k] = b->u[k];
        flow.open[k] = b->open[k];
        flow.cyclic[k] = b->lattice.cyclic[k];
        const long faces = k < flow.dim ? b->cells / flow.n[k] * (flow.n[k] + 1) : 0;
        for (long i = 0; i < faces; i++) b->flows = b->flows || b->u[k][i] != 0;
    }
    return b->flows ? face_flow_project(&flow, &b->change) : OK;
}

status segregation_box_make(const struct setup *s, const struct segregation_models *m, const struct field *phi,
                            const struct segregation_flow *flow, struct segregation_box *out) {
    const struct builder a = {s, m, phi, flow, out};
    *out = (struct segregation_box){.models = m};
    TRY(check(&a));
    TRY(make_arrays(&a));
    TRY(fill(&a));
    return status_note(make_solenoidal(out), "%s: the flow of %s", s->dir, flow->source);
}

void segregation_box_free(struct segregation_box *b) {
    free(b->place);
    free(b->weight);
    for (int k = 0; k < 3; k++) {
        free(b->u[k]);
        free(b->f[k]);
        free(b->D[k]);
        free(b->value[k]);
        free(b->open[k]);
        free(b->fixed[k]);
        free(b->around[k]);
    }
}
