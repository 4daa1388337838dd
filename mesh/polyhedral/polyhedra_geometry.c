/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry of a polyhedral mesh: moments of cells, frames and quadrature points of faces, mirror cells. All come from
 * the polyMesh alone, so that every rank that holds a cell or a face has the same bits. Integrals over a cell are sums
 * over simplices about a point inside it. */
#include <math.h>
#include <stdlib.h>

#include "mesh/polyhedral/polyhedra_private.h"

static const double ON_AXIS = 1e-7;   /* m: radius of a face on the axis, times its length, that is round-off */
static const double NOTHING = 1e-200; /* m: the radius that it counts with, as fluxes are divided by areas */

status lines_make(struct polyhedra *m, double **line, int count, long n, const char *what) {
    for (int k = 0; k < count; k++) TRY(pool_take(&m->pool, &line[k], n, sizeof *line[k], what));
    return OK;
}

/* The computational axis along the radius of a body of revolution; -1: the mesh is none. */
static int radial_of(const struct links *l) {
    for (int k = 0; k < l->dim && l->all->round.on; k++)
        if (l->axis[k] == l->all->round.radial) return k;
    return -1;
}

static const double *point_of(const struct links *l, int p) {
    return l->mesh->points + 3L * p;
}

static void cross(const double *a, const double *b, double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- cells ------------------------------------------------------------------------------------------------------- */

struct shape { /* a cell; sums about `origin` while it is made */
    int dim;
    int radial;      /* axis along the radius of a body of revolution; -1: the mesh is none */
    double at, flat; /* m: where its axis lies along that; m^dim: volume in the plane */
    double origin[3], volume, first[3], second[POLYHEDRA_MOMENTS];
};

static int moment_of(int dim, int a, int b) {
    return a * dim - a * (a - 1) / 2 + b - a;
}

/* Does what add_simplex does, with the weight r = r_0 + x_r of a body of revolution (docs/physics.md 1.4). With Q_ab =
 * sum_i v_ia v_ib, C_abc = sum_i v_ia v_ib v_ic int x_a x_b x_c = V (S_a S_b S_c + S_a Q_bc + S_b Q_ac + S_c Q_ab + 2
 * C_abc) / ((d + 1) (d + 2) (d + 3)). */
static void add_round_simplex(struct shape *s, const double v[3][3], double volume) {
    const int d = s->dim, r = s->radial;
    const double r0 = s->origin[r] - s->at, third = volume / ((d + 1) * (d + 2) * (d + 3));
    double S[3] = {0}, Q[3][3] = {{0}}, second[3][3];
    for (int i = 0; i < d; i++)
        for (int a = 0; a < d; a++) {
            S[a] += v[i][a];
            for (int b = 0; b < d; b++) Q[a][b] += v[i][a] * v[i][b];
        }
    for (int a = 0; a < d; a++)
        for (int b = 0; b < d; b++) second[a][b] = volume * (S[a] * S[b] + Q[a][b]) / ((d + 1) * (d + 2));
    s->flat += volume;
    s->volume += volume * (r0 + S[r] / (d + 1));
    for (int a = 0; a < d; a++) s->first[a] += r0 * (volume * S[a] / (d + 1)) + second[a][r];
    for (int a = 0; a < d; a++)
        for (int b = a; b < d; b++) {
            double C = 0;
            for (int i = 0; i < d; i++) C += v[i][a] * v[i][b] * v[i][r];
            s->second[moment_of(d, a, b)] += r0 * second[a][b] + third * (S[a] * S[b] * S[r] + S[a] * Q[b][r] +
                                                                          S[b] * Q[a][r] + S[r] * Q[a][b] + 2 * C);
        }
}

/* Adds the simplex of the origin and d corners v_i, of volume V. With the sum S of the corners
 *   int x_a = V S_a / (d + 1),   int x_a x_b = V (sum_i v_ia v_ib + S_a S_b) / ((d + 1) (d + 2)). */
static void add_simplex(struct shape *s, const double v[3][3], double volume) {
    const int d = s->dim;
    double sum[3] = {0};
    if (s->radial >= 0) {
        add_round_simplex(s, v, volume);
        return;
    }
    s->volume += volume;
    for (int a = 0; a < d; a++) {
        for (int i = 0; i < d; i++) sum[a] += v[i][a];
        s->first[a] += volume * sum[a] / (d + 1);
    }
    for (int a = 0; a < d; a++)
        for (int b = a; b < d; b++) {
            double x = sum[a] * sum[b];
            for (int i = 0; i < d; i++) x += v[i][a] * v[i][b];
            s->second[moment_of(d, a, b)] += volume * x / ((d + 1) * (d + 2));
        }
}

static void add_tet(struct shape *s, const double *p, const double *q, const double *r, double sign) {
    double v[3][3], n[3];
    for (int k = 0; k < 3; k++) {
        v[0][k] = p[k] - s->origin[k];
        v[1][k] = q[k] - s->origin[k];
        v[2][k] = r[k] - s->origin[k];
    }
    cross(v[0], v[1], n);
    add_simplex(s, (const double(*)[3])v, sign * dot(n, v[2]) / 6);
}

static void add_face_3d(struct shape *s, const struct links *l, int face, double sign) {
    const int *p = l->mesh->face_points + l->mesh->face_start[face];
    int n = l->mesh->face_start[face + 1] - l->mesh->face_start[face];
    if (n == 3) {
        add_tet(s, point_of(l, p[0]), point_of(l, p[1]), point_of(l, p[2]), sign);
        return;
    }
    for (int i = 0; i < n; i++)
        add_tet(s, l->face_centre + 3L * face, point_of(l, p[i]), point_of(l, p[(i + 1) % n]), sign);
}

static void add_face_2d(struct shape *s, const struct links *l, int face, double sign) {
    double v[3][3] = {{0}};
    int p, q;
    if (!links_edge(l, face, &p, &q)) return; /* links_make has refused such a face */
    for (int k = 0; k < 2; k++) {
        v[0][k] = point_of(l, p)[l->axis[k]] - s->origin[k];
        v[1][k] = point_of(l, q)[l->axis[k]] - s->origin[k];
    }
    add_simplex(s, (const double(*)[3])v, sign * (v[0][0] * v[1][1] - v[0][1] * v[1][0]) / 2);
}

static void add_face_1d(struct shape *s, const struct links *l, int face, double sign) {
    double v[3][3] = {{point_of(l, l->mesh->face_points[l->mesh->face_start[face]])[l->axis[0]] - s->origin[0]}};
    add_simplex(s, (const double(*)[3])v, l->face_area[3L * face + l->axis[0]] * sign > 0 ? v[0][0] : -v[0][0]);
}

/* Measures polyMesh cell c: volume, centre (in `first`) and mean second moments about the centre; weighted by the
 * radius if there is one. */
static void measure_shape(const struct links *l, int c, int radial, struct shape *s) {
    static void (*const add_face[])(struct shape *, const struct links *, int, double) = {add_face_1d, add_face_2d,
                                                                                          add_face_3d};
    const int from = l->cell_start[c], to = l->cell_start[c + 1], d = l->dim;
    bool outward;
    *s = (struct shape){.dim = d, .radial = radial, .at = l->all->round.at};
    for (int i = from; i < to; i++)
        for (int k = 0; k < d; k++)
            s->origin[k] += l->face_centre[3L * links_face(l, l->cell_link[i], &outward) + l->axis[k]] / (to - from);
    for (int i = from; i < to; i++) {
        int face = links_face(l, l->cell_link[i], &outward);
        add_face[d - 1](s, l, face, outward ? 1 : -1);
    }
    for (int a = 0; a < d; a++) s->first[a] /= s->volume;
    for (int a = 0; a < d; a++)
        for (int b = a; b < d; b++) {
            double *x = &s->second[moment_of(d, a, b)];
            *x = *x / s->volume - s->first[a] * s->first[b];
        }
    for (int a = 0; a < d; a++) s->first[a] += s->origin[a];
}

static status make_round(struct polyhedra *m, const struct links *l) {
    m->round.radial = radial_of(l);
    m->round.at = l->all->round.at;
    if (m->round.radial < 0) return OK;
    m->thickness *= 6.283185307179586477 / l->all->round.depth;
    TRY(pool_take(&m->pool, &m->round.reach, m->face.n, sizeof *m->round.reach, "the faces"));
    TRY(pool_take(&m->pool, &m->round.rim, m->mirror.n, sizeof *m->round.rim, "the mirrors"));
    TRY(pool_take(&m->pool, &m->round.radius, m->size, sizeof *m->round.radius, "the cells"));
    return lines_make(m, m->round.lag, m->dim, m->nown, "the cells");
}

/* Notes the mean radius of cell i, which has the shape s, and of my cells the way to the centre in the plane. */
static void note_round(struct polyhedra *m, const struct links *l, int i, const struct shape *s) {
    struct shape flat;
    m->round.radius[i] = s->volume / s->flat;
    if (i >= m->nown) return;
    measure_shape(l, m->cell[i], -1, &flat);
    for (int k = 0; k < m->dim; k++) m->round.lag[k][i] = flat.first[k] - s->first[k];
}

static status make_cells(struct polyhedra *m, const struct links *l) {
    const int nmoments = m->dim * (m->dim + 1) / 2;
    TRY(pool_take(&m->pool, &m->volume, m->size, sizeof *m->volume, "the cells"));
    TRY(lines_make(m, m->centre, m->dim, m->size, "the cells"));
    TRY(lines_make(m, m->moment, nmoments, m->size, "the cells"));
    for (int i = 0; i < m->ncells; i++) {
        struct shape s;
        measure_shape(l, m->cell[i], m->round.radial, &s);
        if (!(s.volume > 0)) {
            bool outward;
            const double *x = l->face_centre + 3L * links_face(l, l->cell_link[l->cell_start[m->cell[i]]], &outward);
            return fail(ERR_INPUT, "constant/polyMesh: cell %d near (%g, %g, %g) has the volume %g; run checkMesh",
                        links_cell_name(l, m->cell[i]), x[0], x[1], x[2], s.volume);
        }
        m->volume[i] = s.volume;
        if (m->round.radial >= 0) note_round(m, l, i, &s);
        for (int k = 0; k < m->dim; k++) m->centre[k][i] = s.first[k];
        for (int k = 0; k < nmoments; k++) m->moment[k][i] = s.second[k];
    }
    return OK;
}

/* ---- faces ------------------------------------------------------------------------------------------------------- */

struct frame { /* a polyMesh face; centre and normal in computational axes */
    double centre[3], area, normal[3], tangent[2][3];
};

/* Completes the frame: the first tangent is the axis most nearly normal to n, made exactly so. */
static void complete_frame(struct frame *f) {
    const double *n = f->normal;
    int a = fabs(n[1]) <= fabs(n[0]) ? 1 : 0;
    if (fabs(n[2]) < fabs(n[a])) a = 2;
    double *t = f->tangent[0], size;
    for (int k = 0; k < 3; k++) t[k] = (k == a) - n[a] * n[k];
    size = sqrt(dot(t, t));
    for (int k = 0; k < 3; k++) t[k] /= size;
    cross(n, t, f->tangent[1]);
}

static void measure_face(const struct links *l, int face, struct frame *f) {
    const double *area = l->face_area + 3L * face;
    *f = (struct frame){.area = 1};
    if (l->dim == 1) {
        f->centre[0] = point_of(l, l->mesh->face_points[l->mesh->face_start[face]])[l->axis[0]];
        f->normal[0] = area[l->axis[0]] > 0 ? 1 : -1;
    } else if (l->dim == 2) {
        int p, q;
        if (!links_edge(l, face, &p, &q)) return; /* links_make has refused such a face */
        const double *a = point_of(l, p), *b = point_of(l, q);
        const double x = b[l->axis[0]] - a[l->axis[0]], y = b[l->axis[1]] - a[l->axis[1]];
        for (int k = 0; k < 2; k++) f->centre[k] = 0.5 * (a[l->axis[k]] + b[l->axis[k]]);
        f->area = sqrt(x * x + y * y);
        f->normal[0] = y / f->area;
        f->normal[1] = -x / f->area;
        f->tangent[0][0] = -f->normal[1];
        f->tangent[0][1] = f->normal[0];
    } else {
        f->area = sqrt(dot(area, area));
        for (int k = 0; k < 3; k++) f->centre[k] = l->face_centre[3L * face + k], f->normal[k] = area[k] / f->area;
        complete_frame(f);
    }
}

/* The mean radius of a face of a body of revolution; 1 if the mesh is none. */
static double radius_of(const struct polyhedra *m, const struct frame *f) {
    if (m->round.radial < 0) return 1;
    const double r = f->centre[m->round.radial] - m->round.at;
    return r > ON_AXIS * f->area ? r : NOTHING;
}

static status make_faces(struct polyhedra *m, const struct links *l, const int *link_of) {
    struct polyhedra_faces *face = &m->face;
    TRY(pool_take(&m->pool, &face->area, face->n, sizeof *face->area, "the faces"));
    TRY(lines_make(m, face->normal, m->dim, face->n, "the faces"));
    TRY(lines_make(m, face->shift, m->dim, face->n, "the faces"));
    for (int t = 0; t < m->dim - 1; t++) TRY(lines_make(m, face->tangent[t], m->dim, face->n, "the faces"));
    for (int i = 0; i < face->n; i++) {
        struct frame f;
        int image;
        measure_face(l, l->face[link_of[i]], &f);
        links_cross(l, link_of[i], 0, &image);
        face->area[i] = f.area * radius_of(m, &f);
        if (m->round.radial >= 0) m->round.reach[i] = radius_of(m, &f);
        for (int k = 0; k < m->dim; k++) {
            face->normal[k][i] = f.normal[k];
            face->shift[k][i] = l->image[image][k];
            for (int t = 0; t < m->dim - 1; t++) face->tangent[t][k][i] = f.tangent[t][k];
        }
    }
    return OK;
}

/* ---- mirrors ----------------------------------------------------------------------------------------------------- */

/* Makes cell `to` the image of cell `from` in the plane of f: R = 1 - 2 n n^T, moments R M R. */
static void reflect(struct polyhedra *m, int from, int to, const struct frame *f) {
    const int d = m->dim;
    const double *n = f->normal;
    double depth = 0, second[3][3], turned[3][3] = {{0}};
    m->volume[to] = m->volume[from];
    if (m->round.radial >= 0) m->round.radius[to] = m->round.radius[from];
    for (int k = 0; k < d; k++) depth += (f->centre[k] - m->centre[k][from]) * n[k];
    for (int k = 0; k < d; k++) m->centre[k][to] = m->centre[k][from] + 2 * depth * n[k];
    for (int a = 0; a < d; a++)
        for (int b = 0; b < d; b++) second[a][b] = m->moment[a < b ? moment_of(d, a, b) : moment_of(d, b, a)][from];
    for (int side = 0; side < 2; side++) /* R (R M)^T = R M R: M is symmetric */
        for (int a = 0; a < d; a++)
            for (int b = 0; b < d; b++) {
                const double(*x)[3] = side ? (const double(*)[3])turned : (const double(*)[3])second;
                double along = 0;
                for (int k = 0; k < d; k++) along += n[k] * x[k][b];
                if (side == 0)
                    turned[b][a] = x[a][b] - 2 * n[a] * along;
                else if (a <= b)
                    m->moment[moment_of(d, a, b)][to] = x[a][b] - 2 * n[a] * along;
            }
}

static status make_mirrors(struct polyhedra *m, const struct links *l, const int *mirror_link) {
    struct polyhedra_mirrors *mirror = &m->mirror;
    TRY(lines_make(m, mirror->normal, m->dim, mirror->n, "the mirrors"));
    for (int t = 0; t < m->dim - 1; t++) TRY(lines_make(m, mirror->tangent[t], m->dim, mirror->n, "the mirrors"));
    for (int i = 0; i < mirror->n; i++) {
        struct frame f;
        measure_face(l, l->face[mirror_link[i]], &f);
        if (m->round.radial >= 0) m->round.rim[i] = radius_of(m, &f);
        for (int k = 0; k < m->dim; k++) {
            mirror->normal[k][i] = f.normal[k];
            for (int t = 0; t < m->dim - 1; t++) mirror->tangent[t][k][i] = f.tangent[t][k];
        }
        reflect(m, mirror->cell[i], m->ncells + i, &f);
    }
    return OK;
}

/* ---- quadrature -------------------------------------------------------------------------------------------------- */

struct face_rule {
    int n, room;
    double (*x)[3], *weight;
};

static void add_point(struct face_rule *r, const double *x, double weight) {
    for (int k = 0; k < 3; k++) r->x[r->n][k] = x[k];
    r->weight[r->n++] = weight;
}

/* Adds three points, exact for quadratic functions, weighted by the triangle's area along the normal. */
static void add_triangle(struct face_rule *r, const double *a, const double *b, const double *c, const double *normal) {
    const double *v[3] = {a, b, c};
    double u[3], w[3], n[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], w[k] = c[k] - a[k];
    cross(u, w, n);
    for (int i = 0; i < 3; i++) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = (4 * v[i][k] + v[(i + 1) % 3][k] + v[(i + 2) % 3][k]) / 6;
        add_point(r, x, dot(n, normal) / 6);
    }
}

/* Adds the four Gauss points of the bilinear patch, weighted by its Jacobian along the normal. They are exact for
 * quadratic functions on a plane quadrilateral, as function times Jacobian is cubic along either coordinate. */
static void add_quad(struct face_rule *r, const double *v[4], const double *normal) {
    const double g = 0.5 - 0.5 / sqrt(3.0);
    for (int i = 0; i < 4; i++) { /* the point nearest to corner i */
        double s = i == 1 || i == 2 ? 1 - g : g, t = i >= 2 ? 1 - g : g, x[3], xs[3], xt[3], n[3];
        for (int k = 0; k < 3; k++) {
            x[k] = (1 - s) * (1 - t) * v[0][k] + s * (1 - t) * v[1][k] + s * t * v[2][k] + (1 - s) * t * v[3][k];
            xs[k] = (1 - t) * (v[1][k] - v[0][k]) + t * (v[2][k] - v[3][k]);
            xt[k] = (1 - s) * (v[3][k] - v[0][k]) + s * (v[2][k] - v[1][k]);
        }
        cross(xs, xt, n);
        add_point(r, x, dot(n, normal) / 4);
    }
}

static int count_points(const struct links *l, int face, int order) {
    int n = l->mesh->face_start[face + 1] - l->mesh->face_start[face];
    if (order == 1 || l->dim == 1) return 1;
    if (l->dim == 2) return 2;
    return n <= 4 ? n : 3 * n;
}

static void place_points_3d(const struct links *l, int face, const struct frame *f, struct face_rule *r) {
    const int *p = l->mesh->face_points + l->mesh->face_start[face];
    int n = l->mesh->face_start[face + 1] - l->mesh->face_start[face];
    if (n == 3)
        add_triangle(r, point_of(l, p[0]), point_of(l, p[1]), point_of(l, p[2]), f->normal);
    else if (n == 4)
        add_quad(r, (const double *[]){point_of(l, p[0]), point_of(l, p[1]), point_of(l, p[2]), point_of(l, p[3])},
                 f->normal);
    else
        for (int i = 0; i < n; i++)
            add_triangle(r, f->centre, point_of(l, p[i]), point_of(l, p[(i + 1) % n]), f->normal);
}

/* Places the points of an edge in the plane by the weight r: the two Gauss points are exact for cubic functions, so
 * that they are for quadratic ones times r; one point at their mean is exact for linear ones. */
static void place_round(const struct links *l, const struct frame *f, int order, int radial, struct face_rule *r) {
    const double at = l->all->round.at, along = 0.5 / sqrt(3.0) * f->area;
    double x[2][3] = {{0}}, weight[2], sum = 0, mean[3] = {0};
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) x[i][k] = f->centre[k] + (i ? along : -along) * f->tangent[0][k];
        weight[i] = f->centre[radial] - at > ON_AXIS * f->area ? x[i][radial] - at : 0.5;
        sum += weight[i];
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) mean[k] += weight[i] / sum * x[i][k];
        if (order > 1) add_point(r, x[i], weight[i]);
    }
    if (order == 1) add_point(r, mean, 1);
}

static void place_points(const struct links *l, int face, int order, struct face_rule *r) {
    struct frame f;
    const int radial = radial_of(l);
    measure_face(l, face, &f);
    r->n = 0;
    if (radial >= 0 && l->dim == 2)
        place_round(l, &f, order, radial, r);
    else if (order == 1 || l->dim == 1)
        add_point(r, f.centre, 1);
    else if (l->dim == 2)
        for (int i = 0; i < 2; i++) {
            double x[3] = {0}, along = (i ? 0.5 : -0.5) / sqrt(3.0) * f.area;
            for (int k = 0; k < 2; k++) x[k] = f.centre[k] + along * f.tangent[0][k];
            add_point(r, x, 0.5);
        }
    else
        place_points_3d(l, face, &f, r);
    double sum = 0;
    for (int i = 0; i < r->n; i++) sum += r->weight[i];
    for (int i = 0; i < r->n; i++) r->weight[i] /= sum;
}

static void store_points(struct polyhedra *m, int face, const struct face_rule *r) {
    const int left = m->face.left[face], right = m->face.right[face];
    for (int i = 0, p = m->face.point_start[face]; i < r->n; i++, p++) {
        m->point.face[p] = face;
        m->point.weight[p] = r->weight[i];
        for (int k = 0; k < m->dim; k++) {
            m->point.arm[0][k][p] = r->x[i][k] - m->centre[k][left];
            m->point.arm[1][k][p] = (r->x[i][k] - m->face.shift[k][face]) - m->centre[k][right];
        }
    }
}

static status make_points(struct polyhedra *m, const struct links *l, const int *link_of, int order) {
    struct polyhedra_points *p = &m->point;
    struct face_rule r = {0};
    TRY(pool_take(&m->pool, &m->face.point_start, m->face.n + 1L, sizeof *m->face.point_start,
                  "the points of the faces"));
    for (int i = 0; i < m->face.n; i++) {
        int n = count_points(l, l->face[link_of[i]], order);
        m->face.point_start[i + 1] = m->face.point_start[i] + n;
        if (n > r.room) r.room = n;
    }
    p->n = m->face.point_start[m->face.n];
    TRY(pool_take(&m->pool, &p->face, p->n, sizeof *p->face, "the points of the faces"));
    TRY(pool_take(&m->pool, &p->weight, p->n, sizeof *p->weight, "the points of the faces"));
    for (int side = 0; side < 2; side++) TRY(lines_make(m, p->arm[side], m->dim, p->n, "the points of the faces"));
    TRY(allocate(&r.weight, 4L * r.room, sizeof *r.weight, "the points of a face"));
    r.x = (double(*)[3])(r.weight + r.room);
    for (int i = 0; i < m->face.n; i++) {
        place_points(l, l->face[link_of[i]], order, &r);
        store_points(m, i, &r);
    }
    free(r.weight);
    return OK;
}

/* Does one pass over the faces of near ghosts that are not mine: counts their points, or (r) puts their arms in. */
static void walk_rims(struct polyhedra *m, const struct links *l, const int *local, int order, struct face_rule *r) {
    struct polyhedra_rims *rim = &m->rim;
    for (int i = m->nown, at = 0; i < m->nnear; i++, rim->start[i - m->nown] = at)
        for (int c = m->cell[i], j = l->cell_start[c]; j < l->cell_start[c + 1]; j++) {
            const int code = l->cell_link[j], link = code < 0 ? ~code : code;
            int image, to = links_cross(l, code, 0, &image);
            if (to >= 0 && local[to] >= 0 && local[to] < m->nown) continue;
            (void)links_cross(l, link, 0, &image);
            if (r) place_points(l, l->face[link], order, r);
            for (int p = 0; r && p < r->n; p++)
                for (int k = 0; k < m->dim; k++)
                    rim->arm[k][at + p] = (r->x[p][k] - (code < 0 ? l->image[image][k] : 0)) - m->centre[k][i];
            at += count_points(l, l->face[link], order);
        }
}

static status make_rims(struct polyhedra *m, const struct links *l, const int *local, int order) {
    struct face_rule r = {0};
    const int near = m->nnear - m->nown;
    TRY(pool_take(&m->pool, &m->rim.start, near + 1L, sizeof *m->rim.start, "the points of ghosts"));
    walk_rims(m, l, local, order, NULL);
    TRY(lines_make(m, m->rim.arm, m->dim, m->rim.start[near], "the points of ghosts"));
    for (int i = 0; i < near; i++) {
        const int n = m->rim.start[i + 1] - m->rim.start[i];
        r.room = n > r.room ? n : r.room;
    }
    TRY(allocate(&r.weight, 4L * r.room, sizeof *r.weight, "the points of ghosts"));
    r.x = (double(*)[3])(r.weight + r.room);
    walk_rims(m, l, local, order, &r);
    free(r.weight);
    return OK;
}

/* Keeps centres and volumes of my cells as OpenFOAM's tools compute them. */
static status make_places(struct polyhedra *m, const struct links *l) {
    double *centre = NULL, *volume = NULL;
    TRY(pool_take(&m->pool, &m->middle, m->nown, sizeof *m->middle, "the cells"));
    TRY(pool_take(&m->pool, &m->extent, m->nown, sizeof *m->extent, "the cells"));
    status e = allocate(&centre, 3L * l->mesh->ncells, sizeof *centre, "the cells");
    if (!e) e = allocate(&volume, l->mesh->ncells, sizeof *volume, "the cells");
    if (!e) e = polymesh_cell_geometry(l->mesh, l->face_centre, l->face_area, centre, volume);
    for (int i = 0; !e && i < m->nown; i++) {
        for (int k = 0; k < 3; k++) m->middle[i][k] = centre[3L * m->cell[i] + k];
        m->extent[i] = volume[m->cell[i]];
    }
    free(centre);
    free(volume);
    return e;
}

status geometry_make(struct polyhedra *m, const struct links *l, const int *local, const int *link_of,
                     const int *mirror_link, int order) {
    TRY(make_places(m, l));
    TRY(make_round(m, l));
    TRY(make_cells(m, l));
    TRY(make_mirrors(m, l, mirror_link));
    TRY(make_faces(m, l, link_of));
    TRY(make_points(m, l, link_of, order));
    return make_rims(m, l, local, order);
}

double polyhedra_arm(const struct polyhedra *m, int cell) {
    const int radial = m->round.radial;
    const double r = m->centre[radial][cell] - m->round.at;
    return r + m->moment[moment_of(m->dim, radial, radial)][cell] / r;
}
