/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums the impulses of impacts on walls over the faces of the mesh (grains_forces.h). */
#include "solvers/grains/grains_forces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct grains_forces {
    struct grain_observer observer, *next; /* observer first */
    const struct setup *setup;
    const struct grains_mesh *mesh;
    const struct grain_box *box;
    double depth;     /* m: of a plane mesh, else 1 */
    double dt;        /* s: length of the last step */
    double (*sum)[4]; /* [faces of patches] kg m/s along the solved axes, per depth; the last one energy lost, J */
};

/* The face of the mesh that an impact on a wall hit, and the restitution there. */
static int face_of(const struct grains_forces *f, const struct grain_impact *i, double *restitution) {
    const struct facet *facet = grains_facet_of(f->box, i->b);
    if (facet) {
        *restitution = f->box->wall_restitution[facet->wall];
        return facet->face;
    }
    const int side = -1 - i->b; /* 2 axis + side */
    *restitution = f->box->restitution[side / 2][side & 1];
    return f->setup->lattice->face[6L * grains_box_cell(f->setup, f->mesh, i->x[0]) + side];
}

/* An impact at the speed v gives the impulse m (1 + e) v and takes m (1 - e^2) v^2/2. */
static void observe(struct grain_observer *self, const struct grain_impact *i) {
    const struct grains_forces *f = (const struct grains_forces *)self;
    if (f->next) f->next->impact(f->next, i);
    if (i->b >= 0) return;
    double e;
    double *sum = f->sum[face_of(f, i, &e) - f->setup->mesh->ninternal];
    for (int k = 0; k < f->box->dim; k++) sum[k] += i->impulse * i->normal[k];
    for (int k = 0; k < f->box->dim && f->box->rough; k++) sum[k] += i->drag[k];
    sum[3] += 0.5 * (1 - e) / (1 + e) * i->impulse * i->impulse / i->mass - i->work;
}

status grains_forces_make(const struct setup *s, const struct grains_mesh *mesh, const struct grain_box *box,
                          struct grains_forces **out) {
    double low[3], high[3];
    const long faces = s->mesh->nfaces - s->mesh->ninternal;
    TRY(allocate(out, 1, sizeof **out, "forces"));
    **out = (struct grains_forces){.setup = s, .mesh = mesh, .box = box, .depth = 1};
    (*out)->observer.impact = observe;
    polymesh_bounds(s->mesh, low, high);
    for (int k = s->dim; k < 3; k++) (*out)->depth *= high[s->axis[k]] - low[s->axis[k]];
    const status e = allocate(&(*out)->sum, faces, sizeof *(*out)->sum, "forces");
    if (!e) return OK;
    grains_forces_free(*out);
    *out = NULL;
    return e;
}

void grains_forces_free(struct grains_forces *f) {
    if (!f) return;
    free(f->sum);
    free(f);
}

void grains_forces_begin(struct grains_forces *f) {
    memset(f->sum, 0, (size_t)(f->setup->mesh->nfaces - f->setup->mesh->ninternal) * sizeof *f->sum);
}
void grains_forces_end(struct grains_forces *f, double dt) {
    f->dt = dt;
}
double grains_forces_step(const struct grains_forces *f) {
    return f->dt;
}

struct grain_observer *grains_forces_observer(struct grains_forces *f, struct grain_observer *next) {
    f->next = next;
    return &f->observer;
}

/* What the last step gave to a face, per time. */
static struct crossing crossing_of(const struct grains_forces *f, int patch, int face) {
    const struct setup *s = f->setup;
    const double *sum = f->sum[face - s->mesh->ninternal];
    struct crossing out = {.patch = patch, .energy = sum[3] * f->depth / f->dt};
    double area[3], square = 0;
    polymesh_one_face(s->mesh, face, out.centre, area);
    for (int k = 0; k < 3; k++) square += area[k] * area[k];
    out.area = sqrt(square);
    for (int k = 0; k < 3; k++) out.normal[k] = area[k] / out.area;
    for (int k = 0; k < s->dim; k++) out.pressure[s->axis[k]] = sum[k] * f->depth / f->dt;
    return out;
}

void grains_forces_visit(const struct grains_forces *f, crossing_visitor *visit, void *context) {
    const struct polymesh *m = f->setup->mesh;
    for (int p = 0; p < m->npatches && f->dt > 0; p++)
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            if (!strcmp(m->patch[p].type, "empty") || !strcmp(m->patch[p].type, "cyclic")) break;
            const struct crossing c = crossing_of(f, p, m->patch[p].start + i);
            visit(context, &c);
        }
}
