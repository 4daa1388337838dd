/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adds up energies and forces of soft grains (dem_sums.h). */
#include "solvers/dem/dem_sums.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Sets the velocity of a contact's point of a relative to b, along the tangent; returns the speed along the normal. */
static double sliding(const struct dem_law *law, const struct dem_moment *m, const struct dem_contact *c,
                      double out[3]) {
    const double *spin = m->spin[c->a], *other = c->b < 0 ? NULL : m->spin[c->b],
                 *from = c->b < 0 ? law->walls->wall[-1 - c->b].velocity : m->u[c->b];
    double n[3], w[3], normal = 0;
    const double radius = 0.5 * law->diameter;
    const double r = sqrt(dot(c->branch, c->branch));
    for (int k = 0; k < 3; k++) {
        n[k] = c->branch[k] / r;
        w[k] = radius * (spin[k] + (other ? other[k] : 0));
        out[k] = m->u[c->a][k] - from[k];
        normal += out[k] * n[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] += -normal * n[k] - (w[(k + 1) % 3] * n[(k + 2) % 3] - w[(k + 2) % 3] * n[(k + 1) % 3]);
    return normal;
}

static void add_contact(const struct dem_law *law, const struct dem_moment *m, const struct dem_contact *c,
                        struct dem_sums *s) {
    const struct contact_law *l = c->b < 0 ? &law->walls->wall[-1 - c->b].law : &law->pair;
    const double overlap = fmax(c->overlap, 0), gamma = contact_damper(l, overlap), kt = contact_spring(l, overlap);
    double slide[3], stretch[3];
    const double speed = sliding(law, m, c, slide);
    s->contacts++;
    s->normal_spring += contact_elastic(l, overlap);
    s->normal_loss += gamma * speed * speed;
    if (c->b < 0)
        for (int k = 0; k < 3; k++) {
            s->force[-1 - c->b][k] -= c->push[k] + c->drag[k];
            s->work += (c->push[k] + c->drag[k]) * law->walls->wall[-1 - c->b].velocity[k];
        }
    if (!(l->friction > 0) || !(kt > 0)) return;
    for (int k = 0; k < 3; k++) stretch[k] = c->drag[k] + l->chi * gamma * slide[k];
    const double most = l->friction * sqrt(dot(c->push, c->push)), is = sqrt(dot(c->drag, c->drag));
    s->tangent_spring += 0.5 * dot(stretch, stretch) / kt;
    s->drag -= dot(c->drag, slide);
    if (is < most * (1 - 1e-6)) s->tangent_loss += l->chi * gamma * dot(slide, slide);
}

void dem_sums(const struct dem_law *law, const struct dem_moment *m, struct dem_sums *out) {
    const int dim = law->walls->dim;
    const double r = 0.5 * law->diameter, inertia = (dim == 2 ? 0.5 : 0.4) * law->mass * r * r;
    double square = 0, mean = 0;
    *out = (struct dem_sums){.n = m->n};
    for (int i = 0; i < m->n; i++) {
        square += dot(m->u[i], m->u[i]);
        out->spin += 0.5 * inertia * dot(m->spin[i], m->spin[i]);
        for (int k = 0; k < dim; k++) {
            out->momentum[k] += law->mass * m->u[i][k];
            out->potential -= law->mass * law->gravity->gravity[k] * m->x[i][k];
        }
    }
    out->kinetic = 0.5 * law->mass * square;
    for (int k = 0; k < dim; k++) mean += out->momentum[k] * out->momentum[k];
    const double all = law->mass * fmax(m->n, 1);
    out->T = (2 * out->kinetic / all - mean / (all * all)) / dim;
    for (long i = 0; i < m->ncontacts; i++) add_contact(law, m, &m->contact[i], out);
}

void dem_stresses(const struct dem_moment *m, struct coarse_contact *out) {
    for (long i = 0; i < m->ncontacts; i++) {
        const struct dem_contact *c = &m->contact[i];
        for (int k = 0; k < 3; k++) {
            out[i].x[k] = m->x[c->a][k];
            out[i].branch[k] = c->branch[k];
            out[i].force[k] = c->push[k] + c->drag[k];
        }
    }
}
