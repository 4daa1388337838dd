/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strain and force of friction in a bed whose cells are no boxes (docs/physics.md 9.3): a pair of adjoint operators, as
 * in the hybrid schemes of Eymard, Gallouet & Herbin (IMA J. Numer. Anal. 30, 2010, p. 1009).
 *
 * The velocity on a face is extrapolated from both cells by gradients that are exact for linear velocities
 * (bed_strain.c). Gauss's theorem makes a gradient G of these in each cell. On a face, with r from the centre of a cell
 * K to that of the face and d_K the distance along the normal,
 *     grad u = sum_K d_K/d G_K + n (u_R - u_L - r_L.G_L + r_R.G_R)/d,   d = d_L + d_R.
 * The work of the stresses is W(u) = sum_f A d/dim tau:D'(u), and the force on a cell is -dW/du. So the operator that
 * friction is solved with is symmetric, and it only takes energy. D' is exact for linear velocities, and a uniform
 * stress makes no force inside, as sum A d_K = dim V and sum A n r = V. A cell of the lesser share s counts less: G of
 * the other cell stands for the rest.
 *
 * Of a body of revolution (docs/physics.md 1.4) gradients are those of the plane, A in W has the weight r, and the hoop
 * component of the rate of strain is u_r/r on the face. */
#include "libcore/acoustics/bed_friction_private.h"

/* A cell whose neighbours do not tell its gradient counts TOLD times as much as others. */
static const double TOLD = 1e-16;

/* Sets w and c of a face. */
static void find_parts(const struct bed *b, const struct face_view *v, struct askew_face *out) {
    const struct bed_shapes *h = b->set.shapes;
    memset(out->w, 0, sizeof out->w);
    memset(out->c, 0, sizeof out->c);
    if (v->left < 0 || v->right < 0) {
        const int side = v->left < 0;
        out->w[side] = 1;
        memcpy(out->c[side], v->to, (size_t)b->dim * sizeof *v->to);
        return;
    }
    const double s[2] = {b->rub->share[v->left], b->rub->share[v->right]}, most = larger(s[0], s[1]);
    const double a[2] = {s[0] / most, s[1] / most};
    for (int side = 0; side < 2; side++) {
        const double own = h->depth[side][v->shape] / v->depth, others = h->depth[!side][v->shape] / v->depth;
        const double sign = side ? -1 : 1;
        out->w[side] = a[side] * own + (1 - a[!side]) * others;
        for (int k = 0; k < b->dim; k++)
            out->c[side][k] = sign * (a[side] * bed_middle(b, side)[k][v->shape] -
                                      (1 - a[!side]) * bed_middle(b, !side)[k][v->shape]);
    }
}

/* Returns how well the neighbours of a cell tell its gradient, 0 .. 1: 0 if they lie on a line or in a plane. */
static double told(const struct bed *b, int i) {
    double *const *B = b->rub->inverse;
    if (b->dim < 2) return 1;
    const double trace = B[0][i] + (b->dim > 2 ? B[3][i] + B[5][i] : B[2][i]);
    double ratio = 4 * (B[0][i] * B[2][i] - B[1][i] * B[1][i]) / (trace * trace);
    if (b->dim > 2)
        ratio = 27 / (trace * trace * trace) *
                (B[0][i] * (B[3][i] * B[5][i] - B[4][i] * B[4][i]) - B[1][i] * (B[1][i] * B[5][i] - B[4][i] * B[2][i]) +
                 B[2][i] * (B[1][i] * B[4][i] - B[3][i] * B[2][i]));
    return ratio > 0 ? ratio * ratio : 0;
}

/* Returns the weight of a cell's extrapolation in the velocity of a face. */
static double weight_on(const struct bed *b, const struct bed_side *s, int i) {
    if (b->set.kind[s->face] != BED_INNER) return !bed_rubs_at(b, s->face);
    const double *depth[2] = {b->set.shapes->depth[0], b->set.shapes->depth[1]};
    const int other = bed_across(b, s);
    if (!(b->rub->share[i] > 0 && b->rub->share[other] > 0)) return b->rub->share[i] > 0;
    const double mine = larger(told(b, i), TOLD) * b->rub->share[i] * depth[!s->right][s->shape],
                 others = larger(told(b, other), TOLD) * b->rub->share[other] * depth[s->right][s->shape];
    return mine / (mine + others);
}

/* Sets what `fit` of the cell across a side of cell i is for the difference across it. */
static void find_back(const struct bed *b, const struct bed_side *s, int i, double fit[MAX_DIM]) {
    const struct bed_side back = {s->face, s->shape, !s->right, -s->sign};
    const int other = bed_across(b, s);
    double to[MAX_DIM];
    if (b->set.kind[s->face] != BED_INNER || !(b->rub->share[other] > 0)) return;
    const double w = bed_fit_weight(b, &back, i, to);
    for (int k = 0; k < b->dim; k++) fit[k] = 0;
    for (int k = 0, at = 0; k < b->dim; k++)
        for (int l = k; l < b->dim; l++, at++) {
            fit[k] += b->rub->inverse[at][other] * w * to[l];
            if (l != k) fit[l] += b->rub->inverse[at][other] * w * to[k];
        }
}

void bed_weigh_askew(const struct bed *b) {
    const struct bed_friction *r = b->rub;
    for (int e = 0; e < r->faces; e++) {
        const struct face_view v = bed_view(b, r->face[e], b->dim);
        find_parts(b, &v, &r->askew[v.face]);
    }
    for (int f = 0; f < b->set.faces; f++)
        for (int right = 0; right < 2; right++) {
            const int i = right ? b->set.right[f] : b->set.left[f];
            const struct bed_side s = {f, b->set.shape[f], right, right ? -1 : 1};
            if (i >= 0) r->askew[f].on[right] = weight_on(b, &s, i);
        }
    for (int i = 0; i < b->set.cells; i++)
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            find_back(b, &s, i, r->back[j]);
        }
}

static bool slips(const struct bed *b, int f) {
    return b->set.kind[f] == BED_WALL && !bed_rubs_at(b, f);
}

/* Takes from a vector its part along the normal of a face. */
static void flatten(const struct bed *b, int f, double *a) {
    const double along = bed_along(b, b->set.shapes->normal, b->set.shape[f], a);
    for (int k = 0; k < b->dim; k++) a[k] -= along * b->set.shapes->normal[k][b->set.shape[f]];
}

/* The same on walls with friction that are not rough: they have none across them. */
static void flatten_if_smooth(const struct bed *b, int f, double *a) {
    if (b->set.kind[f] == BED_WALL && !bed_is_rough(b, f)) flatten(b, f, a);
}

/* Sets u to the velocity on a face: on a wall with friction that of the wall, across one that is not rough of the cell.
 */
ALWAYS_INLINE void find_value(const struct bed *b, int f, double *const *V, struct sizes n, double u[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    for (int m = 0; m < MAX_DIM; m++) u[m] = 0;
    for (int right = 0; right < 2; right++) {
        const int i = right ? b->set.right[f] : b->set.left[f];
        if (i < 0) continue;
        if (b->set.kind[f] == BED_WALL && !slips(b, f)) {
            for (int m = 0; m < n.components; m++) u[m] = b->set.wall_speed[m][f] - V[m][i];
            flatten_if_smooth(b, f, u);
            for (int m = 0; m < n.components; m++) u[m] += V[m][i];
            return;
        }
        const double w = r->askew[f].on[right];
        for (int m = 0; m < n.components && w > 0 && r->share[i] > 0; m++) {
            double at = V[m][i];
            for (int k = 0; k < n.dim; k++) at += bed_middle(b, right)[k][b->set.shape[f]] * r->gradient[k][m][i];
            u[m] += w * at;
        }
    }
    if (slips(b, f)) flatten(b, f, u);
}

ALWAYS_INLINE void gauss_with(const struct bed *b, double *const *V, struct sizes n) {
    const struct bed_friction *r = b->rub;
    for (int f = 0; f < b->set.faces; f++) {
        double u[MAX_DIM];
        find_value(b, f, V, n, u);
        for (int m = 0; m < n.components; m++) r->value[m][f] = u[m];
    }
    for (int i = 0; i < b->set.cells; i++) {
        const double per = 1 / bed_flat_volume(b, i);
        double G[MAX_DIM][MAX_DIM] = {{0}};
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1] && r->share[i] > 0; j++) {
            const struct bed_side s = bed_side(b, j);
            for (int k = 0; k < n.dim; k++) {
                const double An = s.sign * per * bed_flat_area(b, s.shape) * b->set.shapes->normal[k][s.shape];
                for (int m = 0; m < n.components; m++) G[k][m] += An * (r->value[m][s.face] - V[m][i]);
            }
        }
        for (int k = 0; k < n.dim; k++)
            for (int m = 0; m < n.components; m++) r->gradient[k][m][i] = G[k][m];
    }
    for (int k = 0; k < n.dim; k++) bed_fill(b, n.components, r->gradient[k]);
}

void bed_gauss_gradients(const struct bed *b, double *const *V){WITH_SIZES(gauss_with, b, V)}

ALWAYS_INLINE void look_with(const struct bed *b, const struct face_view *v, double *const *V, struct sizes n,
                             double jump[MAX_DIM], double mean[MAX_DIM][MAX_DIM]) {
    const struct askew_face p = b->rub->askew[v->face];
    const int cell[2] = {v->left, v->right};
    for (int m = 0; m < n.components; m++) jump[m] = 0;
    for (int side = 0; side < 2; side++) {
        const double sign = side ? 1 : -1;
        if (cell[side] < 0) { /* a wall, relative to its cell */
            for (int m = 0; m < n.components; m++)
                jump[m] += sign * (b->set.wall_speed[m][v->face] - V[m][cell[!side]]);
            continue;
        }
        if (cell[!side] < 0) continue;
        for (int m = 0; m < n.components; m++) jump[m] += sign * V[m][cell[side]];
    }
    flatten_if_smooth(b, v->face, jump);
    for (int k = 0; k < n.dim; k++)
        for (int m = 0; m < n.components; m++) {
            mean[k][m] = 0;
            for (int side = 0; side < 2; side++) {
                if (cell[side] < 0) continue;
                const double G = b->rub->gradient[k][m][cell[side]];
                mean[k][m] += p.w[side] * G;
                jump[m] -= p.c[side][k] * G;
            }
        }
}

void bed_look_askew(const struct bed *b, const struct face_view *v, double *const *V, double jump[MAX_DIM],
                    double mean[MAX_DIM][MAX_DIM]) {
    if (b->dim == 2 && b->components == 2)
        look_with(b, v, V, (struct sizes){2, 2}, jump, mean);
    else
        look_with(b, v, V, (struct sizes){b->dim, b->components}, jump, mean);
}

/* ---- the adjoint ---- */

/* Returns tau'[k][m] of a face. */
ALWAYS_INLINE double tensor_at(const struct bed *b, int f, struct sizes n, int k, int m) {
    const int i = k < m ? k : m, j = k < m ? m : k;
    return b->rub->tensor[i * n.components - i * (i - 1) / 2 + j - i][f];
}

/* Sets `gradient` to -dW/dG over V, in cells. */
ALWAYS_INLINE void find_backs(const struct bed *b, struct sizes n) {
    const struct bed_friction *r = b->rub;
    for (int i = 0; i < b->set.cells; i++) {
        const double per = 1 / (n.dim * bed_flat_volume(b, i));
        double B[MAX_DIM][MAX_DIM] = {{0}};
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1] && r->share[i] > 0; j++) {
            const struct bed_side s = bed_side(b, j);
            if (r->part[s.face] == 0) continue;
            const struct face_view v = bed_view(b, s.face, n.dim);
            const struct askew_face p = r->askew[s.face];
            const double A = per * b->set.shapes->area[s.shape];
            for (int k = 0; k < n.dim; k++)
                for (int m = 0; m < n.components; m++)
                    B[k][m] -= A * (v.depth * p.w[s.right] * tensor_at(b, s.face, n, k, m) -
                                    p.c[s.right][k] * r->traction[m][s.face]);
        }
        for (int k = 0; k < n.dim; k++)
            for (int m = 0; m < n.components; m++) r->gradient[k][m][i] = B[k][m];
    }
    for (int k = 0; k < n.dim; k++) bed_fill(b, n.components, r->gradient[k]);
}

/* Sets `value` to -dW/du of faces. */
ALWAYS_INLINE void find_forces(const struct bed *b, struct sizes n) {
    const struct bed_friction *r = b->rub;
    for (int f = 0; f < b->set.faces; f++) {
        const int shape = b->set.shape[f];
        double y[MAX_DIM] = {0};
        for (int right = 0; right < 2; right++) {
            const int i = right ? b->set.right[f] : b->set.left[f];
            if (i < 0 || !(r->share[i] > 0)) continue;
            for (int k = 0; k < n.dim; k++)
                for (int m = 0; m < n.components; m++)
                    y[m] += (right ? -1 : 1) * bed_flat_area(b, shape) * b->set.shapes->normal[k][shape] *
                            r->gradient[k][m][i];
        }
        if (r->hoop && r->part[f] > 0)
            y[b->set.shapes->round->radial] -=
                bed_view(b, f, n.dim).depth / n.dim * bed_flat_area(b, shape) * r->hoop[f];
        for (int m = 0; m < n.components; m++) r->value[m][f] = y[m];
    }
}

/* Sets `gradient` to -dW/dG of the gradients that faces are extrapolated with. */
ALWAYS_INLINE void find_slants(const struct bed *b, struct sizes n) {
    const struct bed_friction *r = b->rub;
    for (int i = 0; i < b->set.cells; i++) {
        double P[MAX_DIM][MAX_DIM] = {{0}};
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1] && r->share[i] > 0; j++) {
            const struct bed_side s = bed_side(b, j);
            const double w = r->askew[s.face].on[s.right];
            double y[MAX_DIM];
            for (int m = 0; m < n.components; m++) y[m] = w * r->value[m][s.face];
            if (slips(b, s.face)) flatten(b, s.face, y);
            for (int k = 0; k < n.dim; k++)
                for (int m = 0; m < n.components; m++) P[k][m] += bed_middle(b, s.right)[k][s.shape] * y[m];
        }
        for (int k = 0; k < n.dim; k++)
            for (int m = 0; m < n.components; m++) r->gradient[k][m][i] = P[k][m];
    }
    for (int k = 0; k < n.dim; k++) bed_fill(b, n.components, r->gradient[k]);
}

ALWAYS_INLINE void find_pull_with(const struct bed *b, double *const *V, struct sizes n) {
    (void)V;
    find_backs(b, n);
    find_forces(b, n);
    find_slants(b, n);
}

void bed_find_pull(const struct bed *b){WITH_SIZES(find_pull_with, b, NULL)}

/* Adds what acts on a cell by the velocity of one of its faces. */
ALWAYS_INLINE
    void pull_by_value(const struct bed *b, const struct bed_side *s, int i, struct sizes n, double force[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    double y[MAX_DIM], flat[MAX_DIM];
    for (int m = 0; m < n.components; m++) y[m] = flat[m] = r->value[m][s->face];
    flatten_if_smooth(b, s->face, flat);
    for (int m = 0; m < n.components; m++) {
        if (b->set.kind[s->face] == BED_WALL)
            force[m] += slips(b, s->face) ? flat[m] : y[m] - flat[m];
        else if (r->share[i] > 0)
            force[m] += r->askew[s->face].on[s->right] * y[m];
    }
}

/* Adds what acts on a cell by the gradients that it has a part in across a side. */
ALWAYS_INLINE void pull_by_fit(const struct bed *b, const struct bed_side *s, int entry, int i, struct sizes n,
                               double force[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    double own[MAX_DIM] = {0};
    for (int k = 0; k < n.dim && r->share[i] > 0; k++)
        for (int m = 0; m < n.components; m++) own[m] += r->fit[k][entry] * r->gradient[k][m][i];
    if (slips(b, s->face)) { /* the change there is -2 n (u.n) */
        const double along = bed_along(b, b->set.shapes->normal, s->shape, own);
        for (int k = 0; k < n.dim; k++) force[k] -= 2 * along * b->set.shapes->normal[k][s->shape];
        return;
    }
    if (b->set.kind[s->face] > BED_WALL) return;
    flatten_if_smooth(b, s->face, own);
    for (int m = 0; m < n.components; m++) force[m] -= own[m];
    if (b->set.kind[s->face] != BED_INNER) return;
    const int other = bed_across(b, s);
    if (!(r->share[other] > 0)) return;
    for (int k = 0; k < n.dim; k++)
        for (int m = 0; m < n.components; m++) force[m] += r->back[entry][k] * r->gradient[k][m][other];
}

ALWAYS_INLINE void pull_with(const struct bed *b, int i, struct sizes n, double force[MAX_DIM]) {
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double A = s.sign * b->set.shapes->area[s.shape] / n.dim;
        double t[MAX_DIM];
        for (int m = 0; m < n.components; m++) t[m] = b->rub->part[s.face] > 0 ? A * b->rub->traction[m][s.face] : 0;
        flatten_if_smooth(b, s.face, t);
        for (int m = 0; m < n.components; m++) force[m] += t[m];
        pull_by_value(b, &s, i, n, force);
        pull_by_fit(b, &s, j, i, n, force);
    }
}

void bed_pull(const struct bed *b, int i, double force[MAX_DIM]) {
    if (b->dim == 2 && b->components == 2)
        pull_with(b, i, (struct sizes){2, 2}, force);
    else
        pull_with(b, i, (struct sizes){b->dim, b->components}, force);
}

/* Sets a to its part that a wall bears: all of it on a rough one, that along a wall with `muWall`, that across one that
 * slips. */
static void take_borne(const struct bed *b, int f, double *a) {
    double flat[MAX_DIM];
    memcpy(flat, a, sizeof flat);
    flatten(b, f, flat);
    for (int m = 0; m < b->components && !bed_is_rough(b, f); m++) a[m] = slips(b, f) ? a[m] - flat[m] : flat[m];
}

void bed_wall_pull(const struct bed *b, int f, double traction[MAX_DIM]) {
    const int right = b->set.left[f] < 0, i = right ? b->set.right[f] : b->set.left[f];
    const double A = b->set.shapes->area[b->set.shape[f]], sign = right ? -1 : 1, images = slips(b, f) ? 2 : 1;
    double y[MAX_DIM] = {0}, direct[MAX_DIM] = {0};
    for (int m = 0; m < b->components; m++) {
        y[m] = b->rub->value[m][f];
        direct[m] = b->rub->traction[m][f] / b->dim;
    }
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++)
        for (int k = 0; k < b->dim && bed_side(b, j).face == f && b->rub->share[i] > 0; k++)
            for (int m = 0; m < b->components; m++) y[m] += images * b->rub->fit[k][j] * b->rub->gradient[k][m][i];
    take_borne(b, f, y);
    take_borne(b, f, direct);
    for (int m = 0; m < b->components; m++) traction[m] = direct[m] - sign * y[m] / A;
}
