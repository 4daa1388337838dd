/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders the cells of a line, checks that they form one, and sets percolation and diffusivity on it
 * (segregation_line.h). */
#include "solvers/segregation/segregation_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct sorted {
    double at;
    int index;
};
static int by_place(const void *a, const void *b) {
    const struct sorted *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

static double face_at(const struct polymesh *m, int face, int axis) {
    const int first = m->face_start[face], last = m->face_start[face + 1];
    double sum = 0;
    for (int i = first; i < last; i++) sum += m->points[3L * m->face_points[i] + axis];
    return sum / (last - first);
}

static status order_cells(const struct setup *s, struct segregation_setup *l) {
    const int n = s->mesh->ncells;
    struct sorted *order;
    TRY(allocate(&order, n, sizeof *order, "the order of the cells"));
    for (int i = 0; i < n; i++) order[i] = (struct sorted){s->centre[3L * i + l->axis], i};
    qsort(order, (size_t)n, sizeof *order, by_place);
    for (int i = 0; i < n; i++) {
        l->cell[i] = order[i].index;
        l->place[order[i].index] = i;
        l->node[i] = order[i].at;
    }
    free(order);
    return OK;
}

/* Places the faces. The neighbours of each cell must be the cells before and behind it, and the ends must be walls. */
static status place_faces(const struct setup *s, struct segregation_setup *l) {
    const struct polymesh *m = s->mesh;
    const int n = m->ncells;
    int walls = 0;
    for (int f = 0; f < m->ninternal; f++) {
        const int a = l->place[m->owner[f]], b = l->place[m->neighbour[f]];
        if (abs(a - b) != 1)
            return fail(ERR_INPUT,
                        "%s: cells %d and %d share a face but do not follow each other along %c: "
                        "the mesh is no line",
                        s->mesh_path, m->owner[f], m->neighbour[f], "xyz"[l->axis]);
        l->face[a > b ? a : b] = face_at(m, f, l->axis);
    }
    for (int p = 0; p < m->npatches; p++) {
        if (!strcmp(m->patch[p].type, "empty")) continue;
        if (!strcmp(m->patch[p].type, "cyclic"))
            return fail(ERR_INPUT, "%s/%s: patch %s is cyclic; segregation runs between walls", s->dir,
                        polymesh_boundary_file(m), m->patch[p].name);
        for (int f = m->patch[p].start; f < m->patch[p].start + m->patch[p].nfaces; f++, walls++)
            l->face[l->place[m->owner[f]] == 0 ? 0 : n] = face_at(m, f, l->axis);
    }
    if (m->ninternal == n - 1 && walls == 2) return OK;
    return fail(ERR_INPUT, "%s: %d cells with %d internal faces and %d walls; a line has %d and 2", s->mesh_path, n,
                m->ninternal, walls, n - 1);
}

/* Moves the end nodes to the walls: the paper's nodes are equally spaced, the first and the last on the walls, with
 * half cells there. */
static status move_to_walls(const struct setup *s, struct segregation_setup *l) {
    const int n = l->line.n;
    const double step = (l->face[n] - l->face[0]) / (n - 1);
    for (int i = 1; i < n; i++)
        if (fabs(l->face[i] - (l->face[0] + (i - 0.5) * step)) > 1e-6 * step)
            return dict_fail(
                l->models->schemes, "wallValues",
                "the first and the last of the %d cells must be half as wide as the others, %g; in the .geo three "
                "lines: 1 cell of %g, %d of %g, 1 of %g (cases/kink/mesh.geo)",
                n, step, step / 2, n - 2, step, step / 2);
    l->node[0] = l->face[0];
    l->node[n - 1] = l->face[n];
    l->centre[3L * l->cell[0] + l->axis] = l->face[0];
    l->centre[3L * l->cell[n - 1] + l->axis] = l->face[n];
    (void)s;
    return OK;
}

status segregation_setup_make(struct pool *pool, const struct setup *s, const struct segregation_models *m,
                              struct segregation_setup *out) {
    const int n = s->mesh->ncells;
    *out = (struct segregation_setup){.pool = pool, .axis = s->axis[0], .models = m};
    if (s->dim != 1)
        return fail(ERR_INPUT,
                    "%s: %d axes are solved; granularSegregation takes lines of cells, with "
                    "'empty' patches along the other axes",
                    s->mesh_path, s->dim);
    TRY(pool_take(pool, &out->cell, n, sizeof(int), "a line"));
    TRY(pool_take(pool, &out->place, n, sizeof(int), "a line"));
    TRY(pool_take(pool, &out->centre, 3L * n, sizeof(double), "a line"));
    TRY(pool_take(pool, &out->face, n + 1, sizeof(double), "a line"));
    TRY(pool_take(pool, &out->node, n, sizeof(double), "a line"));
    TRY(pool_take(pool, &out->speed, n, sizeof(double), "a line"));
    TRY(pool_take(pool, &out->diffusivity, n + 1, sizeof(double), "a line"));
    memcpy(out->centre, s->centre, 3 * (size_t)n * sizeof(double));
    memcpy(out->origin, s->centre, 3 * sizeof(double));
    TRY(order_cells(s, out));
    TRY(place_faces(s, out));
    out->line = (struct segregation_line){n, out->face, out->node, out->speed, out->diffusivity, NULL, NULL};
    return m->on_walls ? move_to_walls(s, out) : OK;
}

static void point(const struct segregation_setup *l, double at, double x[3]) {
    memcpy(x, l->origin, 3 * sizeof *x);
    x[l->axis] = at;
}

static double diffusivity_at(const struct segregation_setup *l, int face, double phi) {
    double x[3];
    point(l, l->face[face], x);
    return segregation_diffusivity(l->models, x, phi, l->shear_rate ? l->shear_rate[face] : 0);
}

static void diffusivity_law(const void *context, int nfaces, const double *phi, double *diffusivity) {
    for (int i = 0; i < nfaces; i++) diffusivity[i] = larger(0, diffusivity_at(context, i, phi[i]));
}

/* Sets the shear rate on each face to the mean of both cells. */
static status set_shear_rate(struct segregation_setup *l, const double *cells) {
    const int n = l->line.n;
    TRY(pool_take(l->pool, &l->shear_rate, n + 1, sizeof(double), "a line"));
    for (int i = 0; i <= n; i++)
        l->shear_rate[i] = 0.5 * (cells[l->cell[i > 0 ? i - 1 : 0]] + cells[l->cell[i < n ? i : n - 1]]);
    return OK;
}

static status set_diffusivity(struct segregation_setup *l) {
    const int n = l->line.n;
    if (l->models->diffusivity_law) {
        l->line.law = diffusivity_law;
        l->line.context = l;
    }
    for (int i = 0; i <= n; i++) {
        double x[3];
        point(l, l->face[i], x);
        TRY(segregation_diffusivity_check(l->models, x, l->shear_rate ? l->shear_rate[i] : 0));
        l->diffusivity[i] = l->models->diffusivity;
    }
    return OK;
}

static void set_exponential(struct segregation_setup *l) {
    const struct segregation_models *m = l->models;
    for (int i = 0; i < l->line.n; i++) {
        const double y = l->node[i];
        l->speed[i] = y == 0 ? 0 : copysign(m->q / m->rho * m->A * m->B * exp(m->B * fabs(y)), y * m->B * m->q);
    }
}

status segregation_setup_laws(const struct setup *s, const struct segregation_flow *flow, struct segregation_setup *l) {
    const struct segregation_models *m = l->models;
    const int n = l->line.n;
    double x[3];
    if (m->percolation == PERCOLATION_EXPONENTIAL) set_exponential(l);
    if (m->percolation == PERCOLATION_STRESS) TRY(stress_velocity(s, m, l->axis, n, l->node, l->speed));
    for (int i = 0; i < n; i++) {
        point(l, l->node[i], x);
        if (m->percolation == PERCOLATION_CONSTANT) l->speed[i] = m->velocity;
        if (m->percolation == PERCOLATION_EXPRESSION) l->speed[i] = expr_value(m->velocity_law, x[0], x[1], x[2], 0);
        if (!isfinite(l->speed[i]))
            return fail(ERR_INPUT, "%s: percolation: f is %g at (%g %g %g)", dict_path(m->properties), l->speed[i],
                        x[0], x[1], x[2]);
    }
    if (flow->shear_rate) TRY(set_shear_rate(l, flow->shear_rate));
    return set_diffusivity(l);
}
