#include "solvers/segregation_box.h"

#include "libcore/boundary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct builder {
    const struct setup *s;
    const struct segregation_models *m;
    const struct field *phi, *U;
    struct segregation_box *b;
};

static status check(const struct builder *a) {
    const struct segregation_models *m = a->m;
    const struct setup *s = a->s;
    if (!s->lattice)
        return fail(ERR_INPUT,
                    "%s/constant/polyMesh: with %d solved axes segregation takes a lattice of equal boxes: %s", s->dir,
                    s->dim, s->why);
    for (int k = 0; k < s->dim; k++)
        if (s->lattice->periodic[k])
            return fail(ERR_INPUT,
                        "%s/constant/polyMesh/boundary: %c is cyclic; segregation runs between walls, inlets and "
                        "outlets",
                        s->dir, "xyz"[s->axis[k]]);
    if (m->scheme.closure != SEGREGATION_CONSERVATIVE || m->on_walls)
        return dict_fail(m->schemes, m->on_walls ? "wallValues" : "closure",
                         "with %d solved axes only  closure conservative; wallValues cell;", s->dim);
    if (m->scheme.unbounded)
        return dict_fail(m->schemes, "bounded", "with %d solved axes phi is always bounded", s->dim);
    if (!m->scheme.newton)
        return dict_fail(m->solution, "iteration", "with %d solved axes a step is one factored Newton iteration",
                         s->dim);
    if (m->percolation > PERCOLATION_EXPRESSION)
        return fail(ERR_INPUT, "%s: percolation: with %d solved axes it is constant or expression",
                    dict_path(m->properties), s->dim);
    if (!m->has_direction)
        return fail(ERR_INPUT, "%s: percolation: with %d solved axes add  direction (x y z);  along which f is counted",
                    dict_path(m->properties), s->dim);
    return OK;
}

static status law_at(const struct builder *a, const double x[3], double *f, double *D) {
    const struct segregation_models *m = a->m;
    *f = m->velocity_law ? expr_value(m->velocity_law, x[0], x[1], x[2], 0) : m->velocity;
    *D = m->diffusivity;
    if (m->diffusivity_law) {
        *D = expr_value_phi(m->diffusivity_law, x[0], x[1], x[2], 0, 0);
        if (*D != expr_value_phi(m->diffusivity_law, x[0], x[1], x[2], 0, 1))
            return fail(ERR_INPUT, "%s: diffusivity: with two or three solved axes it does not depend on phi",
                        dict_path(m->properties));
    }
    if (isfinite(*f) && *D >= 0 && isfinite(*D)) return OK;
    return fail(ERR_INPUT, "%s: f = %g, D = %g at (%g %g %g); f must be finite, D 0 or more", dict_path(m->properties),
                *f, *D, x[0], x[1], x[2]);
}

static status inner_face(const struct builder *a, int face, int k, long at) {
    const struct polymesh *mesh = a->s->mesh;
    const int axis = a->s->axis[k], one = mesh->owner[face], other = mesh->neighbour[face];
    double x[3], f, D;
    for (int i = 0; i < 3; i++) x[i] = 0.5 * (a->s->centre[3L * one + i] + a->s->centre[3L * other + i]);
    TRY(law_at(a, x, &f, &D));
    a->b->f[k][at] = f * a->m->direction[axis];
    a->b->D[k][at] = D;
    a->b->open[k][at] = true;
    if (a->U) a->b->u[k][at] = 0.5 * (a->U->values[3L * one + axis] + a->U->values[3L * other + axis]);
    return OK;
}

/* sign: +1 where the axis leads out. */
static status outer_face(const struct builder *a, int face, int k, long at, double sign) {
    const struct polymesh *mesh = a->s->mesh;
    const int axis = a->s->axis[k];
    int p = 0;
    while (face >= mesh->patch[p].start + mesh->patch[p].nfaces) p++;
    const struct patch_field *phi = &a->phi->patch[p], *U = a->U ? &a->U->patch[p] : NULL;
    const long i = face - mesh->patch[p].start;
    if (!U || !strcmp(phi->type, "noFlux")) return OK;
    const struct boundary_type *type = boundary_find(U->type);
    if (type && type->reflects)
        return fail(ERR_INPUT, "%s:%d: patch %s: U is '%s' there, a wall: phi must be noFlux", dict_path(a->phi->dict),
                    phi->line, mesh->patch[p].name, U->type);
    const double *given = U->values ? U->values + 3 * i : U->uniform;
    const double u = type && type->value && !strcmp(type->name, "fixedValue")
                         ? given[axis]
                         : a->U->values[3L * mesh->owner[face] + axis];
    a->b->u[k][at] = u;
    if (u * sign >= 0) return OK;
    if (strcmp(phi->type, "fixedValue"))
        return fail(ERR_INPUT, "%s:%d: patch %s: U leads in there; phi must be fixedValue", dict_path(a->phi->dict),
                    phi->line, mesh->patch[p].name);
    a->b->inflow[k][at] = phi->values ? phi->values[i] : phi->uniform[0];
    return OK;
}

static status set_cell(const struct builder *a, const int at[3], int cell) {
    const struct lattice *l = a->s->lattice;
    for (int k = 0; k < l->dim; k++) {
        long stride[3] = {1, 1, 1}, first = 0;
        for (int i = 0, size = 1; i < 3; i++) {
            stride[i] = size;
            first += (long)at[i] * size;
            size *= l->n[i] + (i == k);
        }
        for (int side = 0; side < 2; side++) {
            const int face = l->face[6L * cell + 2 * k + side];
            if (face >= a->s->mesh->ninternal)
                TRY(outer_face(a, face, k, first + side * stride[k], side ? 1 : -1));
            else if (side)
                TRY(inner_face(a, face, k, first + stride[k]));
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
                TRY(set_cell(a, at, l->cell[index]));
            }
    return OK;
}

static status make_arrays(const struct setup *s, struct segregation_box *b) {
    const struct lattice *l = s->lattice;
    b->cells = (long)l->n[0] * l->n[1] * l->n[2];
    b->lattice.dim = l->dim;
    TRY(allocate(&b->place, s->mesh->ncells, sizeof(int), "a lattice"));
    for (int k = 0; k < 3; k++) {
        b->lattice.n[k] = l->n[k];
        b->lattice.width[k] = l->width[k];
        if (k >= l->dim) continue;
        const long faces = b->cells / l->n[k] * (l->n[k] + 1);
        TRY(allocate(&b->u[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->f[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->D[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->inflow[k], faces, sizeof(double), "faces"));
        TRY(allocate(&b->open[k], faces, sizeof(bool), "faces"));
        b->lattice.u[k] = b->u[k];
        b->lattice.f[k] = b->f[k];
        b->lattice.D[k] = b->D[k];
        b->lattice.inflow[k] = b->inflow[k];
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
        const long faces = k < flow.dim ? b->cells / flow.n[k] * (flow.n[k] + 1) : 0;
        for (long i = 0; i < faces; i++) b->flows = b->flows || b->u[k][i] != 0;
    }
    return b->flows ? face_flow_project(&flow, &b->change) : OK;
}

status segregation_box_make(const struct setup *s, const struct segregation_models *m, const struct field *phi,
                            const struct field *U, struct segregation_box *out) {
    const struct builder a = {s, m, phi, U, out};
    *out = (struct segregation_box){.cells = 0};
    TRY(check(&a));
    TRY(make_arrays(s, out));
    TRY(fill(&a));
    return status_note(make_solenoidal(out), "%s/%s/U", s->dir, s->start.name);
}

void segregation_box_free(struct segregation_box *b) {
    free(b->place);
    for (int k = 0; k < 3; k++) {
        free(b->u[k]);
        free(b->f[k]);
        free(b->D[k]);
        free(b->inflow[k]);
        free(b->open[k]);
    }
}
