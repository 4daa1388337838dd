/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the cells around points, and gradients and values by them (vicinity.h). */
#include "mesh/grid/vicinity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_IMAGES = 256, MOST_PARTNERS = 64 };

struct point_pair { /* a point on a cyclic patch, and the point that lies on it when `image` is added */
    int point, partner, patch;
};
struct vicinity_maker {
    struct pool pool; /* has the lists */
    struct vicinity *v;
    int npairs, nimages;
    struct point_pair *pair; /* [npairs] sorted by point */
    double (*step)[3];       /* [npatches] shift from the other half to a cyclic patch */
    int *first;              /* [npoints + 1] into pair */
    int *around, *inside;    /* [npoints + 1], cells that have the point, without images */
};
struct image_of { /* a point that lies on another one if shifted */
    int point;
    double shift[3];
};

static bool has_type(const struct patch *p, const char *type) {
    return !strcmp(p->type, type);
}

static void mean_of_face(const struct polymesh *m, int face, double x[3]) {
    const int n = m->face_start[face + 1] - m->face_start[face];
    x[0] = x[1] = x[2] = 0;
    for (int i = m->face_start[face]; i < m->face_start[face + 1]; i++)
        for (int k = 0; k < 3; k++) x[k] += m->points[3L * m->face_points[i] + k];
    for (int k = 0; k < 3; k++) x[k] /= n;
}

/* ---- points of cells, cells of points ---- */

/* Counts each cell's points or, if `list`, lists them; seen[npoints] is scratch. */
static void points_of_cells(struct vicinity *v, int *seen, bool list) {
    const struct polymesh *m = v->mesh;
    for (int p = 0; p < m->npoints; p++) seen[p] = -1;
    int n = 0;
    for (int c = 0; c < m->ncells; c++) {
        for (int i = v->cell_start[c]; i < v->cell_start[c + 1]; i++)
            for (int j = m->face_start[v->face[i]]; j < m->face_start[v->face[i] + 1]; j++) {
                const int p = m->face_points[j];
                if (seen[p] == c) continue;
                seen[p] = c;
                if (list) v->point[n] = p;
                n++;
            }
        v->own_start[c + 1] = n;
    }
}

static status list_points(struct vicinity_maker *k) {
    struct vicinity *v = k->v;
    const struct polymesh *m = v->mesh;
    TRY(pool_take(&v->pool, &v->own_start, m->ncells + 1L, sizeof(int), "cells around points"));
    TRY(pool_take(&k->pool, &k->around, m->npoints + 2L, sizeof(int), "cells around points"));
    points_of_cells(v, k->around, false);
    const long n = v->own_start[m->ncells];
    TRY(pool_take(&v->pool, &v->point, n, sizeof(int), "cells around points"));
    TRY(pool_take(&k->pool, &k->inside, n, sizeof(int), "cells around points"));
    points_of_cells(v, k->around, true);
    memset(k->around, 0, (size_t)(m->npoints + 2) * sizeof(int));
    for (long i = 0; i < n; i++) k->around[v->point[i] + 2]++;
    for (int p = 0; p < m->npoints; p++) k->around[p + 2] += k->around[p + 1];
    for (int c = 0; c < m->ncells; c++)
        for (int i = v->own_start[c]; i < v->own_start[c + 1]; i++) k->inside[k->around[v->point[i] + 1]++] = c;
    return OK;
}

/* ---- cyclic patches ---- */

static int by_point(const void *a, const void *b) {
    const struct point_pair *p = a, *q = b;
    return p->point != q->point       ? (p->point > q->point) - (p->point < q->point)
           : p->partner != q->partner ? (p->partner > q->partner) - (p->partner < q->partner)
                                      : p->patch - q->patch;
}

/* Pairs the points of a face with those of the face of the other half. */
static void pair_face(struct vicinity_maker *k, int patch, int face, int other) {
    const struct polymesh *m = k->v->mesh;
    const double *step = k->step[patch];
    for (int i = m->face_start[face]; i < m->face_start[face + 1]; i++) {
        const double *a = m->points + 3L * m->face_points[i];
        double least = HUGE_VAL;
        struct point_pair *p = &k->pair[k->npairs++];
        *p = (struct point_pair){m->face_points[i], 0, patch};
        for (int j = m->face_start[other]; j < m->face_start[other + 1]; j++) {
            const double *b = m->points + 3L * m->face_points[j];
            double away = 0;
            for (int x = 0; x < 3; x++) away += (b[x] + step[x] - a[x]) * (b[x] + step[x] - a[x]);
            if (away >= least) continue;
            least = away;
            p->partner = m->face_points[j];
        }
    }
}

/* Finds the mean shift from a cyclic patch's other half to it. */
static void find_step(const struct polymesh *m, const struct patch *p, const struct patch *q, double step[3]) {
    step[0] = step[1] = step[2] = 0;
    for (int i = 0; i < p->nfaces; i++) {
        double a[3], b[3];
        mean_of_face(m, p->start + i, a);
        mean_of_face(m, q->start + i, b);
        for (int x = 0; x < 3; x++) step[x] += (a[x] - b[x]) / p->nfaces;
    }
}

static status pair_points(struct vicinity_maker *k) {
    const struct polymesh *m = k->v->mesh;
    long n = 0;
    for (int p = 0; p < m->npatches; p++)
        if (has_type(&m->patch[p], "cyclic"))
            n += m->face_start[m->patch[p].start + m->patch[p].nfaces] - m->face_start[m->patch[p].start];
    TRY(pool_take(&k->pool, &k->pair, n + 1, sizeof *k->pair, "cells around points"));
    TRY(pool_take(&k->pool, &k->step, m->npatches + 1, sizeof *k->step, "cells around points"));
    TRY(pool_take(&k->pool, &k->first, m->npoints + 2L, sizeof(int), "cells around points"));
    for (int p = 0; p < m->npatches; p++) {
        const struct patch *one = &m->patch[p];
        const int other = one->neighbour ? polymesh_find_patch(m, one->neighbour) : -1;
        if (!has_type(one, "cyclic") || other < 0 || m->patch[other].nfaces != one->nfaces) continue;
        find_step(m, one, &m->patch[other], k->step[p]);
        for (int i = 0; i < one->nfaces; i++) pair_face(k, p, one->start + i, m->patch[other].start + i);
    }
    qsort(k->pair, (size_t)k->npairs, sizeof *k->pair, by_point);
    for (int i = 0; i < k->npairs; i++) k->first[k->pair[i].point + 1]++;
    for (int p = 0; p < m->npoints; p++) k->first[p + 1] += k->first[p];
    return OK;
}

/* Lists the points that lie on point p when shifted, itself first; each once. */
static int find_images(const struct vicinity_maker *k, int p, struct image_of image[MOST_PARTNERS]) {
    int n = 1;
    image[0] = (struct image_of){p, {0, 0, 0}};
    for (int at = 0; at < n; at++)
        for (int i = k->first[image[at].point]; i < k->first[image[at].point + 1]; i++) {
            const struct point_pair *q = &k->pair[i];
            bool known = n == MOST_PARTNERS;
            for (int j = 0; j < n; j++) known |= image[j].point == q->partner;
            if (known) continue;
            image[n] = image[at];
            image[n].point = q->partner;
            for (int x = 0; x < 3; x++) image[n].shift[x] += k->step[q->patch][x];
            n++;
        }
    return n;
}

/* Returns the number of a shift in the table, which grows; the last one if that is full. */
static int image_number(struct vicinity_maker *k, const double shift[3]) {
    double(*table)[3] = k->v->shift;
    for (int i = 0; i < k->nimages; i++) {
        double away = 0, size = 0;
        for (int x = 0; x < 3; x++) {
            away += fabs(table[i][x] - shift[x]);
            size += fabs(table[i][x]) + fabs(shift[x]);
        }
        if (away <= 1e-9 * size) return i;
    }
    if (k->nimages == MOST_IMAGES) return MOST_IMAGES - 1;
    memcpy(table[k->nimages], shift, 3 * sizeof(double));
    return k->nimages++;
}

/* Lists the cells around each point, with those of its images. */
static status surround(struct vicinity_maker *k) {
    struct vicinity *v = k->v;
    const int npoints = v->mesh->npoints;
    struct image_of image[MOST_PARTNERS];
    TRY(pool_take(&v->pool, &v->start, npoints + 1L, sizeof(int), "cells around points"));
    TRY(pool_take(&v->pool, &v->shift, MOST_IMAGES, sizeof *v->shift, "cells around points"));
    k->nimages = 1;
    for (int p = 0; p < npoints; p++) {
        const int n = find_images(k, p, image);
        v->start[p + 1] = v->start[p];
        for (int i = 0; i < n; i++) v->start[p + 1] += k->around[image[i].point + 1] - k->around[image[i].point];
    }
    TRY(pool_take(&v->pool, &v->cell, v->start[npoints] + 1L, sizeof(int), "cells around points"));
    TRY(pool_take(&v->pool, &v->image, v->start[npoints] + 1L, 1, "cells around points"));
    for (int p = 0, to = 0; p < npoints; p++) {
        const int n = find_images(k, p, image);
        for (int i = 0; i < n; i++) {
            const int number = i ? image_number(k, image[i].shift) : 0;
            for (int j = k->around[image[i].point]; j < k->around[image[i].point + 1]; j++, to++) {
                v->cell[to] = k->inside[j];
                v->image[to] = (unsigned char)number;
            }
        }
    }
    return OK;
}

static status find_border(struct vicinity *v) {
    const struct polymesh *m = v->mesh;
    TRY(pool_take(&v->pool, &v->border, m->npoints + 1L, sizeof *v->border, "cells around points"));
    for (int p = 0; p < m->npatches; p++) {
        const struct patch *one = &m->patch[p];
        if (!one->nfaces || has_type(one, "cyclic") || has_type(one, "empty")) continue;
        for (int i = m->face_start[one->start]; i < m->face_start[one->start + one->nfaces]; i++)
            v->border[m->face_points[i]] = true;
    }
    return OK;
}

static status fill(struct vicinity_maker *k) {
    TRY(polymesh_cell_faces(k->v->mesh, &k->v->cell_start, &k->v->face));
    TRY(list_points(k));
    TRY(pair_points(k));
    TRY(surround(k));
    return find_border(k->v);
}

status vicinity_make(const struct polymesh *m, const double *centre, int dim, const int axis[3],
                     struct vicinity **out) {
    struct vicinity_maker k = {.npairs = 0};
    *out = NULL;
    TRY(allocate(&k.v, 1, sizeof *k.v, "cells around points"));
    *k.v = (struct vicinity){.mesh = m, .centre = centre, .dim = dim};
    for (int a = 0; a < dim; a++) k.v->axis[a] = axis[a];
    const status e = fill(&k);
    pool_free(&k.pool);
    if (e) {
        vicinity_free(k.v);
        return e;
    }
    *out = k.v;
    return OK;
}

void vicinity_free(struct vicinity *v) {
    if (!v) return;
    free(v->cell_start);
    free(v->face);
    pool_free(&v->pool);
    free(v);
}

/* ---- gradients and values at points ---- */

/* Solves the symmetric A g = b of n unknowns by elimination; a direction in which A has nothing gets g = 0. */
static void solve(int n, double A[3][3], double b[3], double g[3]) {
    double trace = 0;
    bool empty[3] = {false};
    for (int i = 0; i < n; i++) trace += A[i][i];
    for (int i = 0; i < n; i++) {
        empty[i] = !(A[i][i] > 1e-10 * trace);
        for (int j = i + 1; j < n && !empty[i]; j++) {
            const double factor = A[j][i] / A[i][i];
            for (int k = i; k < n; k++) A[j][k] -= factor * A[i][k];
            b[j] -= factor * b[i];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        double sum = b[i];
        for (int k = i + 1; k < n; k++) sum -= A[i][k] * g[k];
        g[i] = empty[i] ? 0 : sum / A[i][i];
    }
}

status vicinity_field_make(const struct vicinity *v, const double *value, int stride, struct vicinity_field *out) {
    *out = (struct vicinity_field){v, value, stride, NULL, NULL};
    TRY(allocate(&out->gradient, v->mesh->ncells, sizeof *out->gradient, "gradients"));
    TRY(allocate(&out->at_point, v->mesh->npoints, sizeof *out->at_point, "values at points"));
    for (int c = 0; c < v->mesh->ncells; c++) out->gradient[c][0] = NAN;
    for (int p = 0; p < v->mesh->npoints; p++) out->at_point[p] = NAN;
    return OK;
}

void vicinity_field_free(struct vicinity_field *f) {
    free(f->gradient);
    free(f->at_point);
    f->gradient = NULL;
    f->at_point = NULL;
}

static void find_gradient(const struct vicinity_field *f, int cell, double gradient[3]) {
    const struct vicinity *v = f->v;
    const double *o = v->centre + 3L * cell, here = f->value[(long)f->stride * cell];
    double A[3][3] = {{0}}, b[3] = {0}, g[3] = {0};
    for (int i = v->own_start[cell]; i < v->own_start[cell + 1]; i++)
        for (int j = v->start[v->point[i]]; j < v->start[v->point[i] + 1]; j++) {
            const int c = v->cell[j];
            const double *shift = v->shift[v->image[j]], *at = v->centre + 3L * c;
            double d[3], square = 0;
            if (c == cell && !v->image[j]) continue;
            for (int k = 0; k < v->dim; k++) {
                d[k] = at[v->axis[k]] + shift[v->axis[k]] - o[v->axis[k]];
                square += d[k] * d[k];
            }
            const double weight = 1 / square, change = f->value[(long)f->stride * c] - here;
            for (int k = 0; k < v->dim; k++) {
                b[k] += weight * d[k] * change;
                for (int l = 0; l < v->dim; l++) A[k][l] += weight * d[k] * d[l];
            }
        }
    solve(v->dim, A, b, g);
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int k = 0; k < v->dim; k++) gradient[v->axis[k]] = g[k];
}

void vicinity_gradient(const struct vicinity_field *f, int cell, double gradient[3]) {
    double *kept = f->gradient ? f->gradient[cell] : gradient;
    if (!f->gradient || isnan(kept[0])) find_gradient(f, cell, kept);
    if (kept != gradient) memcpy(gradient, kept, 3 * sizeof *gradient);
}

double vicinity_at_point(const struct vicinity_field *f, int point) {
    const struct vicinity *v = f->v;
    const double *x = v->mesh->points + 3L * point;
    const int n = v->start[point + 1] - v->start[point];
    double sum = 0, low = HUGE_VAL, high = -HUGE_VAL, g[3];
    if (f->at_point && !isnan(f->at_point[point])) return f->at_point[point];
    for (int i = v->start[point]; i < v->start[point + 1]; i++) {
        const int c = v->cell[i];
        const double *shift = v->shift[v->image[i]], *at = v->centre + 3L * c;
        double there = f->value[(long)f->stride * c];
        vicinity_gradient(f, c, g);
        low = fmin(low, there);
        high = fmax(high, there);
        for (int k = 0; k < v->dim; k++) {
            const int a = v->axis[k];
            there += g[a] * (x[a] - at[a] - shift[a]);
        }
        sum += there;
    }
    const double found = v->border[point] ? sum / n : fmin(fmax(sum / n, low), high);
    if (f->at_point) f->at_point[point] = found;
    return found;
}

void vicinity_mark(const struct vicinity *v, int point, bool *wanted) {
    for (int i = v->start[point]; i < v->start[point + 1]; i++)
        for (int j = v->own_start[v->cell[i]]; j < v->own_start[v->cell[i] + 1]; j++)
            for (int k = v->start[v->point[j]]; k < v->start[v->point[j] + 1]; k++) wanted[v->cell[k]] = true;
}

/* ---- simplices ---- */

static long centre_node(const struct vicinity *v, int cell) {
    return v->mesh->npoints + (long)cell;
}
static long face_node(const struct vicinity *v, int face) {
    return v->mesh->npoints + (long)v->mesh->ncells + face;
}

static double apart(const struct vicinity *v, int p, int q) {
    const double *a = v->mesh->points + 3L * p, *b = v->mesh->points + 3L * q;
    double square = 0;
    for (int k = 0; k < v->dim; k++) square += (a[v->axis[k]] - b[v->axis[k]]) * (a[v->axis[k]] - b[v->axis[k]]);
    return square;
}

/* Finds the two points of a face of a 2D mesh that are farthest apart in the plane: the ends of its edge. Of points
 * that lie on each other along the empty axis it takes the one with the lower number, so that faces that share an end
 * agree. */
static void ends_of(const struct vicinity *v, int face, long node[2]) {
    const struct polymesh *m = v->mesh;
    const int *p = m->face_points + m->face_start[face], n = m->face_start[face + 1] - m->face_start[face];
    double most = -1;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++) {
            const double square = apart(v, p[i], p[j]);
            if (square <= most) continue;
            most = square;
            node[0] = p[i];
            node[1] = p[j];
        }
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < n; i++)
            if (p[i] < node[e] && apart(v, p[i], (int)node[e]) < 1e-12 * most) node[e] = p[i];
}

/* Does a face part cells along a solved axis? The others lie on empty patches. */
static bool parts(const struct vicinity *v, int face) {
    const struct polymesh *m = v->mesh;
    if (v->dim == 3 || face < m->ninternal) return true;
    for (int p = 0; p < m->npatches; p++)
        if (face >= m->patch[p].start && face < m->patch[p].start + m->patch[p].nfaces)
            return !has_type(&m->patch[p], "empty");
    return true;
}

static status cut_face(const struct vicinity *v, int cell, int face, vicinity_taker *take, void *context) {
    const struct polymesh *m = v->mesh;
    const int *p = m->face_points + m->face_start[face], n = m->face_start[face + 1] - m->face_start[face];
    long node[4] = {centre_node(v, cell)};
    if (v->dim == 1) {
        node[1] = p[0];
        return take(context, cell, node);
    }
    if (v->dim == 2) {
        ends_of(v, face, node + 1);
        return take(context, cell, node);
    }
    if (n == 3) {
        for (int i = 0; i < 3; i++) node[1 + i] = p[i];
        return take(context, cell, node);
    }
    node[1] = face_node(v, face);
    for (int i = 0; i < n; i++) {
        node[2] = p[i];
        node[3] = p[(i + 1) % n];
        TRY(take(context, cell, node));
    }
    return OK;
}

status vicinity_cut(const struct vicinity *v, int cell, vicinity_taker *take, void *context) {
    for (int i = v->cell_start[cell]; i < v->cell_start[cell + 1]; i++)
        if (parts(v, v->face[i])) TRY(cut_face(v, cell, v->face[i], take, context));
    return OK;
}

void vicinity_place(const struct vicinity *v, int cell, long node, double x[3]) {
    const struct polymesh *m = v->mesh;
    double at[3];
    memcpy(x, v->centre + 3L * cell, 3 * sizeof *x);
    if (node < m->npoints)
        memcpy(at, m->points + 3 * node, sizeof at);
    else if (node < m->npoints + (long)m->ncells)
        memcpy(at, v->centre + 3 * (node - m->npoints), sizeof at);
    else
        mean_of_face(m, (int)(node - m->npoints - m->ncells), at);
    for (int k = 0; k < v->dim; k++) x[v->axis[k]] = at[v->axis[k]];
}

double vicinity_at_node(const struct vicinity_field *f, long node) {
    const struct polymesh *m = f->v->mesh;
    if (node < m->npoints) return vicinity_at_point(f, (int)node);
    if (node < m->npoints + (long)m->ncells) return f->value[f->stride * (node - m->npoints)];
    const int face = (int)(node - m->npoints - m->ncells), n = m->face_start[face + 1] - m->face_start[face];
    double sum = 0;
    for (int i = m->face_start[face]; i < m->face_start[face + 1]; i++) sum += vicinity_at_point(f, m->face_points[i]);
    return sum / n;
}

void vicinity_mark_node(const struct vicinity *v, long node, bool *wanted) {
    const struct polymesh *m = v->mesh;
    if (node < m->npoints) {
        vicinity_mark(v, (int)node, wanted);
    } else if (node < m->npoints + (long)m->ncells) {
        wanted[node - m->npoints] = true;
    } else {
        const int face = (int)(node - m->npoints - m->ncells);
        for (int i = m->face_start[face]; i < m->face_start[face + 1]; i++) vicinity_mark(v, m->face_points[i], wanted);
    }
}

/* ---- the simplex of a place ---- */

struct finding {
    const struct vicinity *v;
    const double *x;
    double best; /* the least weight of the best simplex so far: none below 0 where it holds x */
    long *node;
    double *weight;
};

/* Solves for the weights of x in a simplex of dim + 1 corners by Cramer's rule; returns the least one, -infinity if the
 * simplex is flat. */
static double weigh(const struct vicinity *v, const double corner[4][3], const double *x, double weight[4]) {
    const int *a = v->axis, n = v->dim;
    double e[3][3] = {{0}}, r[3] = {0}, least = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        r[i] = x[a[i]] - corner[0][a[i]];
        for (int j = 0; j < n; j++) e[i][j] = corner[j + 1][a[i]] - corner[0][a[i]];
    }
    for (int i = n; i < 3; i++) e[i][i] = 1;
    const double minor[3] = {e[1][1] * e[2][2] - e[1][2] * e[2][1], e[1][2] * e[2][0] - e[1][0] * e[2][2],
                             e[1][0] * e[2][1] - e[1][1] * e[2][0]};
    const double all = e[0][0] * minor[0] + e[0][1] * minor[1] + e[0][2] * minor[2];
    if (all == 0) return -HUGE_VAL;
    weight[0] = 1;
    for (int j = 0; j < n; j++) {
        double f[3][3];
        memcpy(f, e, sizeof f);
        for (int i = 0; i < 3; i++) f[i][j] = r[i];
        weight[j + 1] =
            (f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) + f[0][1] * (f[1][2] * f[2][0] - f[1][0] * f[2][2]) +
             f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0])) /
            all;
        weight[0] -= weight[j + 1];
    }
    for (int i = 0; i <= n; i++) least = fmin(least, weight[i]);
    return least;
}

static status take_nearest(void *context, int cell, const long node[4]) {
    struct finding *f = context;
    double corner[4][3], weight[4];
    for (int i = 0; i <= f->v->dim; i++) vicinity_place(f->v, cell, node[i], corner[i]);
    const double least = weigh(f->v, (const double(*)[3])corner, f->x, weight);
    if (!(least > f->best)) return OK;
    f->best = least;
    for (int i = 0; i <= f->v->dim; i++) {
        f->node[i] = node[i];
        f->weight[i] = weight[i];
    }
    return OK;
}

int vicinity_locate(const struct vicinity *v, int cell, const double x[3], long node[4], double weight[4]) {
    struct finding f = {v, x, -HUGE_VAL, node, weight};
    node[0] = centre_node(v, cell);
    weight[0] = 1;
    for (int i = 1; i < 4; i++) weight[i] = 0, node[i] = node[0];
    (void)vicinity_cut(v, cell, take_nearest, &f); /* it has no errors */
    return v->dim + 1;
}
