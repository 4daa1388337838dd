/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Batches of face points on polyhedra: frames, states beyond patches, primitives (cells_points_private.h). */
#include "libcore/polyhedral/cells_points_private.h"

#include "libcore/gas/patch.h"

KERNEL static void gather_points(int n, const int *restrict index, const double *restrict q, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = q[index[i]];
}
void points_gather(int n, const int *index, const double *q, double *out) {
    gather_points(n, index, q, out);
}

KERNEL static void cells_of_points(int n, const int *restrict face, const int *restrict side, int *restrict cell) {
    for (int i = 0; i < n; i++) cell[i] = side[face[i]];
}
/* cell <- the cells on one side of n faces */
void points_cells(int n, const int *face, const int *side, int *cell) {
    cells_of_points(n, face, side, cell);
}

KERNEL static void turn_normals(int n, double (*restrict axis)[MAX_DIM][BATCH]) {
    for (int i = 0; i < n; i++) {
        axis[1][0][i] = -axis[0][1][i];
        axis[1][1][i] = axis[0][0][i];
    }
}
KERNEL static void cross_axes(int n, double (*restrict axis)[MAX_DIM][BATCH]) {
    for (int i = 0; i < n; i++) {
        axis[2][0][i] = axis[0][1][i] * axis[1][2][i] - axis[0][2][i] * axis[1][1][i];
        axis[2][1][i] = axis[0][2][i] * axis[1][0][i] - axis[0][0][i] * axis[1][2][i];
        axis[2][2][i] = axis[0][0][i] * axis[1][1][i] - axis[0][1][i] * axis[1][0][i];
    }
}

/* In 2D the tangent is the normal, turned by a right angle; in 3D the second one is normal to both others. */
void points_frames(const struct polyhedra *m, struct points *p) {
    const struct polyhedra_faces *f = &m->face;
    for (int k = 0; k < m->dim; k++) points_gather(p->n, p->face, f->normal[k], p->axis[0][k]);
    for (int k = 0; k < m->dim && m->dim > 2; k++) points_gather(p->n, p->face, f->tangent[0][k], p->axis[1][k]);
    if (m->dim == 2) turn_normals(p->n, p->axis);
    if (m->dim == 3) cross_axes(p->n, p->axis);
}

/* `back` exchanges the entries of the axes; components beyond dim are the same in every frame. */
KERNEL static void turn_vectors(int n, int dim, bool back, double (*restrict axis)[MAX_DIM][BATCH],
                                double (*restrict q)[BATCH]) {
    double *restrict m0 = q[0], *restrict m1 = q[1], *restrict m2 = q[2];
    const double *restrict xx = axis[0][0], *restrict xy = back ? axis[1][0] : axis[0][1];
    const double *restrict xz = back ? axis[2][0] : axis[0][2], *restrict yx = back ? axis[0][1] : axis[1][0];
    const double *restrict yy = axis[1][1], *restrict yz = back ? axis[2][1] : axis[1][2];
    const double *restrict zx = back ? axis[0][2] : axis[2][0], *restrict zy = back ? axis[1][2] : axis[2][1];
    const double *restrict zz = axis[2][2];
    if (dim == 1)
        for (int i = 0; i < n; i++) m0[i] *= xx[i];
    if (dim == 2)
        for (int i = 0; i < n; i++) {
            double a = m0[i], b = m1[i];
            m0[i] = a * xx[i] + b * xy[i];
            m1[i] = a * yx[i] + b * yy[i];
        }
    if (dim == 3)
        for (int i = 0; i < n; i++) {
            double a = m0[i], b = m1[i], c = m2[i];
            m0[i] = a * xx[i] + b * xy[i] + c * xz[i];
            m1[i] = a * yx[i] + b * yy[i] + c * yz[i];
            m2[i] = a * zx[i] + b * zy[i] + c * zz[i];
        }
}
void cells_turn_vectors(int n, int dim, bool back, double (*axis)[MAX_DIM][BATCH], double (*q)[BATCH]) {
    turn_vectors(n, dim, back, axis, q);
}
void points_into_frames(const struct gas *g, struct points *p, double (*q)[BATCH]) {
    turn_vectors(p->n, g->dim, false, p->axis, q + 1);
}
void points_out_of_frames(const struct gas *g, struct points *p, double (*q)[BATCH]) {
    turn_vectors(p->n, g->dim, true, p->axis, q + 1);
}

KERNEL static void list_points(int n, int k, const int *restrict start, const double *restrict all, int *restrict point,
                               double *restrict weight) {
    for (int i = 0; i < n; i++) {
        const int last = start[i + 1] - 1, here = start[i] + k;
        point[i] = here < last ? here : last;
    }
    for (int i = 0; i < n; i++) weight[i] = all[point[i]];
    for (int i = 0; i < n; i++) weight[i] = start[i + 1] - start[i] > k ? weight[i] : 0;
}
void points_list(const struct polyhedra *m, int first, int last, int k, struct point_states *s) {
    const int n = last - first;
    list_points(n, k, m->face.point_start + first, m->point.weight, s->point, s->weight);
    for (int i = n; i < (n + 7) / 8 * 8; i++) {
        s->point[i] = s->point[n - 1];
        s->weight[i] = s->weight[n - 1];
    }
}

ALWAYS_INLINE void add_line(const bool first, int n, const double *restrict w, const double *restrict q,
                            double *restrict sum) {
    for (int i = 0; i < n; i++) sum[i] = fma(w[i], q[i], first ? 0 : sum[i]);
}
ALWAYS_INLINE void add_all(const bool first, int n, int axes, int components, const double (*restrict normal)[BATCH],
                           const struct point_states *restrict s, struct point_means *restrict sum) {
    double part[BATCH], push[BATCH];
    for (int i = 0; i < n; i++) part[i] = 0;
    for (int k = 0; k < axes; k++)
        for (int i = 0; i < n; i++) part[i] += s->velocity[k][i] * normal[k][i];
    for (int i = 0; i < n; i++) {
        part[i] *= s->weight[i];
        push[i] = s->weight[i] * s->p[i];
    }
    add_line(first, n, s->weight, s->eps, sum->eps);
    add_line(first, n, s->weight, s->c2, sum->c2);
    add_line(first, n, s->weight, s->gruneisen, sum->gruneisen);
    for (int v = 0; v < components + 2; v++) {
        add_line(first, n, s->weight, s->at[v], sum->state[v]);
        add_line(first, n, part, s->at[v], sum->flux[v]);
    }
    for (int k = 0; k < axes; k++) add_line(false, n, push, normal[k], sum->flux[k + 1]);
    add_line(false, n, part, s->p, sum->flux[components + 1]);
}
KERNEL static void add_means(bool first, int n, int axes, int components, const double (*normal)[BATCH],
                             const struct point_states *s, struct point_means *sum) {
    if (first)
        add_all(true, n, axes, components, normal, s, sum);
    else
        add_all(false, n, axes, components, normal, s, sum);
}
void points_add(const struct gas *g, const struct points *p, bool first, struct point_states *s,
                struct point_means *sum) {
    const struct gas_models *m = &g->models;
    double *velocity[MAX_DIM] = {s->velocity[0], s->velocity[1], s->velocity[2]};
    velocity_row(p->n, g->components, BATCH, s->at[0], velocity, s->eps);
    m->eos->state(&m->material, p->n, s->at[0], s->eps, s->p, s->c2, s->gruneisen);
    add_means(first, p->n, g->dim, g->components, (const double(*)[BATCH])p->axis[0], s, sum);
}

/* F_n = u_n U + p (0, 1, u_n) */
KERNEL static void nodal_line(int n, int dim, long size, const double *restrict U, const double *restrict u,
                              const double *restrict p, double *restrict flux) {
    for (int v = 0; v < dim + 2; v++) {
        const double *restrict q = U + v * size;
        double *restrict F = flux + v * size;
        if (v == 0)
            for (int i = 0; i < n; i++) F[i] = U[size + i];
        else if (v == dim + 1)
            for (int i = 0; i < n; i++) F[i] = (q[i] + p[i]) * u[i];
        else if (v == 1)
            for (int i = 0; i < n; i++) F[i] = q[i] * u[i] + p[i];
        else
            for (int i = 0; i < n; i++) F[i] = q[i] * u[i];
    }
}

bool points_reflect(const struct gas *g, const struct points *p) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    return patch_is_wall(&g->patches.rules[f->patch[p->face[0] - f->ninternal]]);
}

void points_beyond(const struct gas *g, double (*inner)[BATCH], struct points *p) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    double ghost[MAX_VAR][BATCH];
    int place[BATCH];
    for (int i = 0; i < p->n; i++) place[i] = f->place[p->face[i] - f->ninternal];
    cells_beyond(g, f->patch[p->face[0] - f->ninternal], p->n, p->face, place, inner, ghost);
    for (int v = 0; v < g->nvar; v++) memcpy(p->state[v][RIGHT], ghost[v], (size_t)p->n * sizeof(double));
}

/* The batch of n faces that a flux sees. */
static struct faces faces_of(const struct gas *g, int n, struct points *p) {
    struct faces f = {.n = n,
                      .dim = g->components,
                      .stride = BATCH,
                      .fastest = g->step.fastest[0],
                      .pace = p->pace,
                      .params = &g->models.flux_params};
    for (int v = 0; v < g->nvar; v++) {
        f.state[v] = p->state[v][LEFT];
        f.flux[v] = p->flux[v][LEFT];
        f.out[v] = p->out[v];
    }
    for (int k = 0; k < g->components; k++) f.velocity[k] = p->velocity[k][LEFT];
    f.eps = p->eps[LEFT];
    f.c = p->c[LEFT];
    f.gruneisen = p->gruneisen[LEFT];
    return f;
}

struct faces points_primitives(const struct gas *g, struct points *p) {
    const struct gas_models *m = &g->models;
    const long size = STENCIL * BATCH;
    const int n = (p->n + 7) / 8 * 8; /* whole vectors, filled up with the last state */
    for (int v = 0; v < g->nvar; v++)
        for (int side = LEFT; side <= RIGHT; side++)
            for (int i = p->n; i < n; i++) p->state[v][side][i] = p->state[v][side][p->n - 1];
    for (int side = LEFT; side <= RIGHT; side++) {
        double *velocity[MAX_DIM] = {p->velocity[0][side], p->velocity[1][side], p->velocity[2][side]};
        velocity_row(n, g->components, size, p->state[0][side], velocity, p->eps[side]);
        m->eos->state(&m->material, n, p->state[0][side], p->eps[side], p->p[side], p->c[side], p->gruneisen[side]);
        root_row(n, p->c[side]);
        nodal_line(n, g->components, size, p->state[0][side], p->velocity[0][side], p->p[side], p->flux[0][side]);
    }
    return faces_of(g, n, p);
}

struct faces points_of_means(const struct gas *g, struct point_means mean[2], struct points *p) {
    const int n = p->n;
    for (int side = LEFT; side <= RIGHT; side++) {
        struct point_means *q = &mean[side - LEFT];
        double *velocity[MAX_DIM] = {p->velocity[0][side], p->velocity[1][side], p->velocity[2][side]};
        points_into_frames(g, p, q->state);
        points_into_frames(g, p, q->flux);
        velocity_row(n, g->components, BATCH, q->state[0], velocity, p->eps[side]);
        root_row(n, q->c2);
        for (int v = 0; v < g->nvar; v++) {
            memcpy(p->state[v][side], q->state[v], sizeof q->eps);
            memcpy(p->flux[v][side], q->flux[v], sizeof q->eps);
        }
        memcpy(p->eps[side], q->eps, sizeof q->eps);
        memcpy(p->c[side], q->c2, sizeof q->eps);
        memcpy(p->gruneisen[side], q->gruneisen, sizeof q->eps);
    }
    return faces_of(g, n, p);
}

/* Gives the batch the floors of its faces. */
void points_floors(struct points *p, struct faces *faces) {
    for (int i = p->n; i < faces->n; i++) p->floor[i] = 0;
    faces->floor = p->floor;
}

void points_flatten(const struct gas *g, const struct points *p, const double *rho, const double (*average)[BATCH],
                    double (*at)[BATCH]) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int i = 0; i < p->n; i++)
        if (larger(rho[f->left[p->face[i]]], rho[f->right[p->face[i]]]) > PACKED * g->limits.most)
            for (int v = 0; v < g->nvar; v++) at[v][i] = average[v][i];
}

void points_feed(const struct gas *g, int n, const int *face, const double *U, double (*flux)[BATCH]) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct patch_rules *r = &g->patches.rules[f->patch[face[0] - f->ninternal]];
    double into[BATCH];
    int place[BATCH], in[BATCH], beyond[BATCH];
    points_cells(n, face, f->left, in);
    points_cells(n, face, f->right, beyond);
    for (int i = 0; i < n; i++) {
        place[i] = f->place[face[i] - f->ninternal];
        into[i] = 0;
        for (int k = 0; k < g->dim; k++) into[i] -= f->normal[k][face[i]] * patch_feed(r, g->components, place[i], k);
        for (int v = 0; v < g->nvar; v++) flux[v][i] = -flux[v][i];
    }
    feed_fluxes(g, r, &(struct fed_faces){n, place, into, U, in, beyond, flux});
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) flux[v][i] = -flux[v][i];
}
