/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the lattice of a segregation in two or three dimensions: checks, faces, boundary, the projection of the flow
 * (segregation_box.h). */
#include "solvers/segregation/segregation_box.h"

#include "libcore/models/boundary.h"

#include <math.h>
#include <string.h>

struct builder {
    const struct setup *s;
    const struct segregation_models *m;
    const struct segregation_places *p;
    const struct field *phi;
    const struct segregation_flow *flow;
    struct segregation_box *b;
};

status segregation_box_check(const struct setup *s, const struct segregation_models *m) {
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

/* `one` and `other` are places. */
static double mean_of(const double *cells, long one, long other, double standard) {
    return cells ? 0.5 * (cells[one] + cells[other]) : standard;
}

/* Sets percolation and diffusion on a face between two cells; x is its place. */
static status set_laws(const struct builder *a, long one, long other, const double x[3], int k, long at) {
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

static status inner_face(const struct builder *a, long one, long other, const double x[3], int k, long at) {
    const struct segregation_flow *flow = a->flow;
    const int axis = a->s->axis[k];
    TRY(set_laws(a, one, other, x, k, at));
    a->b->open[k][at] = true;
    if (!flow->U) return OK;
    const double below = flow->U[3 * one + axis], above = flow->U[3 * other + axis];
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

/* Returns the velocity along axis k on face i of patch p, beside a place. */
static double patch_velocity(const struct builder *a, int p, long i, int k, long place) {
    const struct segregation_flow *flow = a->flow;
    const struct patch_field *U = flow->given ? &flow->given->patch[p] : NULL;
    const int axis = a->s->axis[k];
    if (U && !strcmp(U->type, "fixedValue")) return (U->values ? U->values + 3 * i : U->uniform)[axis];
    return flow->U ? flow->U[3 * place + axis] : 0;
}

struct cell_side { /* of a place */
    long place;
    int k;         /* axis */
    long at;       /* number of the face among those of the axis in the slab */
    bool high;     /* does the axis lead out there? */
    int patch;     /* -1: another cell follows */
    long in_patch; /* number of the face in the patch */
};

/* Sets a face on the boundary. */
static status outer_face(const struct builder *a, const struct cell_side *f) {
    struct segregation_box *b = a->b;
    const struct patch_field *phi = &a->phi->patch[f->patch];
    const double sign = f->high ? 1 : -1;
    if (!strcmp(phi->type, "noFlux")) return OK;
    TRY(check_open(a, f->patch));
    const double u = patch_velocity(a, f->patch, f->in_patch, f->k, f->place);
    double x[3];
    segregation_places_centre(a->p, f->place, x);
    x[a->s->axis[f->k]] += 0.5 * sign * a->s->lattice->width[f->k];
    TRY(set_laws(a, f->place, f->place, x, f->k, f->at));
    b->u[f->k][f->at] = a->flow->density ? a->flow->density[f->place] * u : u;
    b->fixed[f->k][f->at] = !strcmp(phi->type, "fixedValue");
    b->through = true;
    if (b->fixed[f->k][f->at]) b->value[f->k][f->at] = phi->values ? phi->values[f->in_patch] : phi->uniform[0];
    if (b->fixed[f->k][f->at] || u * sign >= 0) return OK;
    return fail(ERR_INPUT, "%s:%d: patch %s: U leads in there; phi must be fixedValue", dict_path(a->phi->dict),
                phi->line, a->s->mesh->patch[f->patch].name);
}

/* Sets a face between two places, of which `upper` is beyond it along the axis. */
static status face_between(const struct builder *a, long lower, long upper, int k, long at) {
    double x[3], y[3];
    segregation_places_centre(a->p, lower, x);
    segregation_places_centre(a->p, upper, y);
    for (int i = 0; i < 3; i++) x[i] = 0.5 * (x[i] + y[i]);
    return inner_face(a, lower, upper, x, k, at);
}

/* Sets one of the two ends of a cyclic axis, which are one face. */
static status seam(const struct builder *a, long lower, long upper, int k, long at) {
    double x[3];
    segregation_places_centre(a->p, upper, x);
    x[a->s->axis[k]] -= 0.5 * a->s->lattice->width[k];
    return inner_face(a, lower, upper, x, k, at);
}

/* Sets a side of a place with a cell: each face inside the slab once, from the place below it. */
static status set_side(const struct builder *a, const struct cell_side *f, long stride, bool at_end) {
    const struct segregation_lattice *l = &a->b->lattice;
    const bool seam_here = f->patch >= 0 && !strcmp(a->s->mesh->patch[f->patch].type, "cyclic");
    const bool joined = f->k == l->dim - 1 && at_end && (f->high ? a->p->above : a->p->below);
    const long step = f->high ? stride : -stride;
    const long other = !seam_here || joined ? f->place + step : f->place - step * (l->n[f->k] - 1);
    const long lower = f->high ? f->place : other, upper = f->high ? other : f->place;
    if (f->patch >= 0 && !seam_here) return outer_face(a, f);
    if (seam_here) return l->cyclic[f->k] ? seam(a, lower, upper, f->k, f->at) : OK;
    return f->high || joined ? face_between(a, lower, upper, f->k, f->at) : OK;
}

/* Sets the faces of a cell; i: its position in the slab. */
static status set_cell(const struct builder *a, const int i[3], long place) {
    const int *n = a->b->lattice.n;
    int at[3];
    segregation_places_at(a->p, place, at);
    for (int k = 0; k < a->b->lattice.dim; k++) {
        long stride = 1, first = 0;
        for (int axis = 0, size = 1; axis < 3; axis++) {
            if (axis == k) stride = size;
            first += (long)i[axis] * size;
            size *= n[axis] + (axis == k);
        }
        for (int high = 0; high < 2; high++) {
            struct cell_side f = {.place = place, .k = k, .at = first + high * stride, .high = high};
            f.patch = lattice_patch(a->s->lattice, a->s->mesh, at, 2 * k + high, &f.in_patch);
            TRY(set_side(a, &f, stride, i[k] == (high ? n[k] - 1 : 0)));
        }
    }
    return OK;
}

static status fill(const struct builder *a) {
    const int *n = a->b->lattice.n;
    int i[3];
    long index = 0;
    for (i[2] = 0; i[2] < n[2]; i[2]++)
        for (i[1] = 0; i[1] < n[1]; i[1]++)
            for (i[0] = 0; i[0] < n[0]; i[0]++, index++) {
                const long place = a->p->own_first + index;
                if (a->p->cell[place] < 0) continue;
                if (a->b->weight) a->b->weight[index] = a->flow->density[place];
                TRY(set_cell(a, i, place));
            }
    return OK;
}

static status make_arrays(const struct builder *a) {
    const struct setup *s = a->s;
    struct segregation_box *b = a->b;
    const struct lattice *l = s->lattice;
    const bool law = a->m->diffusivity_law && expr_uses(a->m->diffusivity_law, EXPR_PHI);
    b->cells = a->p->nown;
    b->lattice.dim = l->dim;
    b->lattice.comm = s->comm;
    if (a->flow->density) TRY(pool_take(b->pool, &b->weight, b->cells, sizeof(double), "a lattice"));
    for (long i = 0; b->weight && i < b->cells; i++) b->weight[i] = 1;
    b->lattice.capacity = b->weight;
    if (law) {
        b->lattice.law = diffusivity_law;
        b->lattice.context = b;
    }
    for (int k = 0; k < 3; k++) {
        b->lattice.n[k] = k == l->dim - 1 ? a->p->layers : l->n[k];
        b->lattice.width[k] = l->width[k];
        if (k >= l->dim) continue;
        const long faces = b->cells / b->lattice.n[k] * (b->lattice.n[k] + 1);
        TRY(pool_take(b->pool, &b->u[k], faces, sizeof(double), "faces"));
        TRY(pool_take(b->pool, &b->f[k], faces, sizeof(double), "faces"));
        TRY(pool_take(b->pool, &b->D[k], faces, sizeof(double), "faces"));
        TRY(pool_take(b->pool, &b->value[k], faces, sizeof(double), "faces"));
        TRY(pool_take(b->pool, &b->open[k], faces, sizeof(bool), "faces"));
        TRY(pool_take(b->pool, &b->fixed[k], faces, sizeof(bool), "faces"));
        if (law) TRY(pool_take(b->pool, &b->around[k], 5 * faces, sizeof(double), "faces"));
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
    const struct comm *c = b->lattice.comm;
    struct face_flow flow = {.dim = b->lattice.dim, .comm = c};
    double any[2] = {0, b->through};
    for (int k = 0; k < 3; k++) {
        flow.n[k] = b->lattice.n[k];
        flow.width[k] = b->lattice.width[k];
        flow.u[k] = b->u[k];
        flow.open[k] = b->open[k];
        flow.cyclic[k] = b->lattice.cyclic[k];
        const long faces = k < flow.dim ? b->cells / flow.n[k] * (flow.n[k] + 1) : 0;
        for (long i = 0; i < faces && !any[0]; i++) any[0] = b->u[k][i] != 0;
    }
    comm_max(c, any, 2);
    b->flows = any[0] > 0;
    b->through = any[1] > 0;
    return b->flows ? face_flow_project(&flow, &b->change) : OK;
}

status segregation_box_make(struct pool *pool, const struct setup *s, const struct segregation_models *m,
                            const struct segregation_places *p, const struct field *phi,
                            const struct segregation_flow *flow, struct segregation_box *out) {
    const struct builder a = {s, m, p, phi, flow, out};
    *out = (struct segregation_box){.pool = pool, .models = m};
    status e = make_arrays(&a);
    if (!e) e = fill(&a);
    TRY(comm_agree(s->comm, e));
    return status_note(make_solenoidal(out), "%s: the flow of %s", s->dir, flow->source);
}
