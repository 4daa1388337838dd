/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous stress and heat conduction on polyhedra, second order. The gradient on a face is the mean of those of its two
 * cells (libcore/polyhedral/cells_gradient.c), changed along the normal until it agrees with the jump along
 * the line of centres e:
 *     n.grad q = (q_R - q_L)/(n.e) + r.mean,  r = n - e/(n.e).
 * Where the centres lie across the face r is 0, so on boxes the fluxes are those of the tiles; linear fields are exact
 * on any mesh, and so a rigid rotation has no stress. */
#include <stdlib.h>

#include "libcore/polyhedral/cells_diffuser.h"

static const double STEEP = 0.2;    /* n.e counts as no less than this fraction of |e| */
static const double CLOSEST = 0.05; /* least distance of a centre to the face, over that of both centres */

static int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->components : 1;
}

static status lines_allocate(double **line, int count, long n) {
    for (int i = 0; i < count; i++) TRY(allocate(&line[i], n, sizeof(double), "diffusion"));
    return OK;
}

static void lines_drop(double **line, int count) {
    for (int i = 0; i < count; i++) free(line[i]);
}

/* e: from the left centre to the right one; across: its part along the normal, as it counts; share: which part of that
 * lies on the left. The share is of the true length: of what counts, left and right would not add up to 1. */
static void measure_face(const struct polyhedra *m, int face, double e[MAX_DIM], double *across, double *share) {
    double length = 0, before = 0;
    *across = 0;
    for (int k = 0; k < m->dim; k++) {
        const double arm[2] = {cells_arm(m, face, 0, k), cells_arm(m, face, 1, k)};
        e[k] = arm[0] - arm[1];
        length += e[k] * e[k];
        *across += e[k] * m->face.normal[k][face];
        before += arm[0] * m->face.normal[k][face];
    }
    *share = *across > 0 ? before / *across : 0.5;
    *across = larger(*across, STEEP * sqrt(length));
}

static void measure_faces(const struct polyhedra *m, struct cells_diffuser *d) {
    const double round_off = 1e-12;
    for (int i = 0; i < m->face.n; i++) {
        double e[MAX_DIM], across, share, most = 0;
        measure_face(m, i, e, &across, &share);
        d->inverse[i] = 1 / across;
        d->share[i] = smaller(larger(share, CLOSEST), 1 - CLOSEST);
        if (i >= m->face.ninternal || fabs(d->share[i] - 0.5) < round_off) d->share[i] = 0.5;
        for (int k = 0; k < m->dim; k++) {
            d->oblique[k][i] = m->face.normal[k][i] - e[k] / across;
            most = larger(most, fabs(d->oblique[k][i]));
        }
        const bool straight = i >= m->face.ninternal || most < round_off;
        for (int k = 0; k < m->dim && straight; k++) d->oblique[k][i] = 0;
        d->skewed = d->skewed || !straight;
    }
}

status cells_diffuser_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const long size = m->size + LANES, faces = m->face.n + SLACK;
    struct cells_diffuser *d;
    TRY(allocate(&d, 1, sizeof *d, "diffusion"));
    g->cells->diffuser = d;
    for (int i = 0; i < 2; i++) {
        TRY(lines_allocate(d->sum[i], 1, g->components * size));
        for (int c = 1; c < g->components; c++) d->sum[i][c] = d->sum[i][0] + c * size;
        g->diffusion.sum[i] = d->sum[i];
    }
    g->diffusion.wide = size;
    TRY(lines_allocate(d->start, g->components, size));
    TRY(lines_allocate(d->gradient, g->dim * g->components, size));
    TRY(lines_allocate(d->cell, 3, size));
    TRY(lines_allocate(&d->T, 1, size));
    TRY(lines_allocate(&d->wall.drag, 1, m->mirror.n));
    TRY(lines_allocate(&d->wall.heat, 1, m->mirror.n));
    TRY(lines_allocate(&d->wall.lift, 1, m->mirror.n));
    TRY(lines_allocate(&d->wall.stays, 1, m->mirror.n));
    for (int i = 0; i < m->mirror.n; i++) {
        const struct patch_rules *r = &g->patches.rules[m->mirror.patch[i]];
        d->slides |= wall_slides(r);
        d->lifts |= wall_slides(r) || (g->diffusion.terms.cross && wall_conducts(r));
    }
    if (g->diffusion.terms.cross) TRY(cells_cross_make(g, d));
    if (m->round.radial >= 0) TRY(cells_turn_make(g, &d->turn));
    TRY(lines_allocate(d->face, 3, faces));
    TRY(lines_allocate(d->oblique, g->dim, faces));
    TRY(lines_allocate(&d->inverse, 1, faces));
    TRY(lines_allocate(&d->share, 1, faces));
    measure_faces(m, d);
    g->diffusion.oblique = d->skewed;
    if (d->skewed) TRY(lines_allocate(&d->alike, 1, size));
    if (d->skewed) TRY(lines_allocate(&d->keep, 1, faces));
    return OK;
}

void cells_diffuser_free(struct cells_diffuser *d) {
    if (!d) return;
    for (int i = 0; i < 2; i++) free(d->sum[i][0]);
    lines_drop(d->start, MAX_DIM);
    lines_drop(d->gradient, MAX_DIM * MAX_DIM);
    lines_drop(d->cell, 3);
    lines_drop(d->face, 3);
    lines_drop(d->oblique, MAX_DIM);
    cells_turn_free(d->turn);
    free(d->T);
    free(d->wall.drag);
    free(d->wall.heat);
    free(d->wall.lift);
    free(d->wall.stays);
    free(d->wall.through);
    free(d->wall.fed);
    free(d->wall.denser);
    free(d->cross);
    free(d->alike);
    free(d->keep);
    free(d->inverse);
    free(d->share);
    free(d);
}

/* ---- coefficients and rates ---------------------------------------------------------------------------------------
 */

static void fill_state(struct gas *g, const struct state *s, double *U[MAX_VAR]) {
    cells_lines(g, s, U);
    g->engine->state.fill(g, GHOSTS, g->nvar, s->block);
    cells_mirrors(g, 0, g->cells->polyhedra->mirror.n, U);
}

void cells_near_ghosts(struct gas *g, const struct state *s) {
    double *U[MAX_VAR];
    fill_state(g, s, U);
}

static void cell_coefficients(struct gas *g, const double *rho) {
    struct cells_diffuser *d = g->cells->diffuser;
    const int size = g->cells->polyhedra->size;
    for (int at = 0; at < size; at += BATCH) {
        const int n = size - at < BATCH ? size - at : BATCH;
        double *T = d->T + at;
        temperature_row(g, n, rho + at, T);
        for (int i = 0; i < n; i++) T[i] = larger(T[i], COLDEST);
        for (int i = 0; i < n && g->diffusion.ahead; i++) T[i] *= g->diffusion.warm[0][at + i];
        for (int i = 0; i < n && !g->diffusion.ahead; i++) g->diffusion.warm[0][at + i] = T[i];
        const struct gas_models *models = &g->models;
        const struct closure_line cells = {.eos = models->eos,
                                           .material = &models->material,
                                           .n = n,
                                           .rho = rho + at,
                                           .T = T,
                                           .shear_rate = shear_rate_at(g, models->transport->needs, 0, at)};
        transport_row(g, &cells, d->cell[0] + at, d->cell[1] + at, d->cell[2] + at);
        if (g->diffusion.dilation)
            models->transport->dilation(&models->transport_params, &cells, g->diffusion.dilation[0] + at);
    }
}

KERNEL static void mix_coefficients(int n, double trace, const int *restrict left, const int *restrict right,
                                    const double *restrict area, const double *restrict share, double *const *cell,
                                    double *const *face) {
    const double *restrict bulk = cell[0], *restrict shear = cell[1], *restrict heat = cell[2];
    double *restrict lambda = face[0], *restrict mu = face[1], *restrict kappa = face[2];
    for (int i = 0; i < n; i++) {
        const double s = harmonic(share[i], shear[left[i]], shear[right[i]]);
        lambda[i] = area[i] * (harmonic(share[i], bulk[left[i]], bulk[right[i]]) - trace * s);
        mu[i] = area[i] * s;
        kappa[i] = area[i] * harmonic(share[i], heat[left[i]], heat[right[i]]);
    }
}

static void cell_rates(const struct gas *g, int i, double rho, double rate[2]) {
    const struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    const struct cells_diffuser *d = c->diffuser;
    double sum[2] = {0, 0};
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
        sum[0] += (d->face[0][face] + 2 * d->face[1][face]) * d->inverse[face];
        const double wall = face < m->face.ninternal ? 0 : d->wall.heat[face - m->face.ninternal];
        sum[1] += (wall > 0 ? wall : 1) * d->face[2][face] * d->inverse[face];
    }
    if (d->turn) sum[0] = cells_turn_rate(d->turn, i, sum[0]);
    const double per = c->inverse_volume[i] / rho;
    rate[0] = per * sum[0];
    rate[1] = temperature_of(&g->models.material, per) * sum[1];
}

static void find_rates(const struct gas *g, const double *rho, double most[2], double *each) {
    double rate[2];
    most[0] = most[1] = 0;
    for (int i = 0; i < g->cells->polyhedra->nown; i++) {
        cell_rates(g, i, rho[i], rate);
        for (int what = 0; what < 2; what++) most[what] = larger(rate[what], most[what]);
        for (int what = 0; what < 2 && each; what++) each[what * g->size + i] = rate[what];
    }
}

void cells_diffusion_rates(struct gas *g, const struct state *Y0, double most[2], const struct state *each) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_diffuser *d = g->cells->diffuser;
    double *U[MAX_VAR];
    fill_state(g, Y0, U);
    cell_coefficients(g, U[0]);
    mix_coefficients(m->face.n, trace_share(&g->models.material), m->face.left, m->face.right, m->face.area, d->share,
                     d->cell, d->face);
    if (d->keep) cells_find_keep(g, U[0], d->T, d->alike, d->keep);
    if (d->cross) cells_cross_coefficients(g, U[0]);
    cells_wall_shares(g, U, d->T, d->cell, d->cross ? d->start[0] : NULL, &d->wall);
    if (d->cross) cells_cross_faces(g, U[0]);
    if (d->turn) cells_turn_rates(g, d->turn);
    find_rates(g, U[0], most, each ? each->block[0] : NULL);
}

/* ---- S and its gradients ------------------------------------------------------------------------------------------
 */

/* q_0 and S_1 are set in ghosts and mirrors, too: rules may take q_0 from beyond a patch, and the mirrors of near
 * ghosts are made from the ghosts. */
void cells_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double pending) {
    struct cells_diffuser *d = g->cells->diffuser;
    const int size = g->cells->polyhedra->size;
    cells_near_ghosts(g, Y0);
    if (what == VISCOUS && g->diffusion.plain && d->cross) cells_cross_drop(g);
    for (int at = 0; at < size; at += BATCH) {
        const int n = size - at < BATCH ? size - at : BATCH;
        double *q[MAX_DIM] = {NULL};
        for (int v = 0; v < lines_of(g, what); v++) q[v] = d->start[v] + at;
        start_row(g, what, Y0, &(struct row){0, at, n}, pending, q);
        for (int v = 0; v < lines_of(g, what); v++)
            for (int i = 0; i < n; i++) d->sum[g->diffusion.last][v][at + i] = factor * q[v][i];
    }
}

static void find_gradients(struct gas *g, enum diffusing what, double *const *S, int from, int to) {
    const struct cells_diffuser *d = g->cells->diffuser;
    if (g->dim == 1 || from >= to || (what == HEAT && !d->skewed)) return;
    cells_gradients(g->dim, &g->cells->gradient, lines_of(g, what), from, to, S, d->gradient);
}

/* ---- fluxes and what they move ------------------------------------------------------------------------------------
 */

struct face_batch { /* a batch of faces, and the cells on both sides */
    int n;
    const int *left, *right;
    const double *share, *inverse,
        *keep; /* keep: 0 on faces that leave out the gradients, else 1; NULL: all take them */
    const double *normal[MAX_DIM], *oblique[MAX_DIM];
    const double *face[3];
    const double *around; /* of bodies of revolution, as all behind: u_r/r on the faces */
    double *hoop;         /* stress around the axis, times the area */
    int swirl;            /* component whose lines hold u_s/r; 0: none */
    const double *lever;
};

/* jump <- S_R - S_L; M <- the mean of the gradients of both cells, without those of faces that leave them out. */
ALWAYS_INLINE void gather_sides(int dim, int lines, const struct face_batch *f, double *const *S,
                                double *const *gradient, double (*restrict jump)[BATCH], double (*restrict M)[BATCH]) {
    const int *restrict left = f->left, *restrict right = f->right;
    for (int c = 0; c < lines; c++) {
        const double *restrict q = S[c];
        for (int i = 0; i < f->n; i++) jump[c][i] = q[right[i]] - q[left[i]];
    }
    for (int k = 0; k < dim * lines; k++) {
        const double *restrict q = gradient[k];
        for (int i = 0; i < f->n; i++) M[k][i] = 0.5 * (q[left[i]] + q[right[i]]);
    }
    for (int k = 0; k < dim * lines && f->keep; k++)
        for (int i = 0; i < f->n; i++) M[k][i] *= f->keep[i];
}

/* With the gradient G = M + n (a - n.M) of the head of this file, M the mean and a = n.G: the force of the left cell on
 * the right one, -(lambda tr(G) n + mu (G + G^T) n). The components c of u from dim on, up to m, lie along axes without
 * derivatives: their force is -mu a_c alone; that of a swirl, whose S is u_s/r, -mu times lever a_c. */
ALWAYS_INLINE void viscous_faces(int dim, int m, bool round, const struct face_batch *f, double *const *S,
                                 double *const *gradient, double *const *out) {
    const int slopes = dim > 1 ? dim : 0;
    double jump[MAX_DIM][BATCH], M[MAX_DIM * MAX_DIM][BATCH];
    const struct face_batch g = *f; /* not seen from outside, or compilers expect it to overlap `out` */
    gather_sides(slopes, m, f, S, gradient, jump, M);
    EACH_ALONE
    for (int i = 0; i < g.n; i++) {
        double a[MAX_DIM], stretch = 0, trace = 0;
        UNROLL
        for (int c = 0; c < dim; c++) {
            double along = 0;
            a[c] = jump[c][i] * g.inverse[i];
            UNROLL
            for (int k = 0; k < slopes; k++) {
                a[c] += g.oblique[k][i] * M[k * m + c][i];
                along += g.normal[k][i] * M[k * m + c][i];
            }
            stretch += g.normal[c][i] * (a[c] - along);
            if (dim > 1) trace += M[c * m + c][i];
        }
        if (round) {
            trace += g.around[i];
            g.hoop[i] = g.face[0][i] * (trace + stretch) + 2 * g.face[1][i] * g.around[i];
        }
        UNROLL
        for (int k = 0; k < dim; k++) {
            double across = g.normal[k][i] * stretch;
            UNROLL
            for (int c = 0; c < slopes; c++) across += g.normal[c][i] * M[k * m + c][i];
            const double spread = (trace + stretch) * g.normal[k][i];
            out[k][i] = -(g.face[0][i] * spread + g.face[1][i] * (a[k] + across));
        }
        UNROLL
        for (int c = dim; c < m; c++) {
            double slope = jump[c][i] * g.inverse[i];
            UNROLL
            for (int k = 0; k < slopes; k++) slope += g.oblique[k][i] * M[k * m + c][i];
            out[c][i] = -(g.face[1][i] * slope);
            if (round && c == g.swirl) out[c][i] *= g.lever[i];
        }
    }
}

/* The work of the forces on the mean of both cells, m lines -> out[m]. */
KERNEL static void work_faces(int m, const struct face_batch *f, double *const *S, double *const *out) {
    const struct face_batch g = *f;
    double *restrict work = out[m];
    for (int i = 0; i < g.n; i++) work[i] = 0;
    for (int c = 0; c < m; c++) {
        const double *restrict q = S[c], *restrict force = out[c];
        for (int i = 0; i < g.n; i++) {
            const double a = q[g.left[i]], b = q[g.right[i]];
            double at = a + g.share[i] * (b - a);
            if (g.swirl && c == g.swirl) at *= g.lever[i];
            work[i] += force[i] * at;
        }
    }
}

ALWAYS_INLINE void heat_faces(int dim, const struct face_batch *f, double *const *S, double *const *gradient,
                              double *restrict out) {
    double jump[1][BATCH], M[MAX_DIM][BATCH];
    const struct face_batch g = *f;
    gather_sides(dim, 1, f, S, gradient, jump, M);
    EACH_ALONE
    for (int i = 0; i < g.n; i++) {
        double slope = jump[0][i] * g.inverse[i];
        UNROLL
        for (int k = 0; k < dim; k++) slope += g.oblique[k][i] * M[k][i];
        out[i] = slope * -g.face[2][i];
    }
}

/* gradient: NULL where no face is oblique. */
ALWAYS_INLINE void heat_of_faces(int dim, const struct face_batch *f, double *const *S, double *const *gradient,
                                 double *restrict out) {
    if (dim > 1 && gradient)
        heat_faces(dim, f, S, gradient, out);
    else
        heat_faces(0, f, S, NULL, out);
}

#define FACES(dim, m)                                                                                                  \
    KERNEL static void faces_##dim##_##m(enum diffusing what, const struct face_batch *f, double *const *S,            \
                                         double *const *gradient, double *const *out) {                                \
        if (what == VISCOUS)                                                                                           \
            viscous_faces(dim, m, false, f, S, gradient, out);                                                         \
        else                                                                                                           \
            heat_of_faces(dim, f, S, gradient, out[0]);                                                                \
    }
FACES(1, 1)
FACES(1, 2)
FACES(1, 3)
FACES(2, 2)
FACES(2, 3)
FACES(3, 3)
#define ROUND_FACES(dim, m)                                                                                            \
    KERNEL static void round_faces_##dim##_##m(enum diffusing what, const struct face_batch *f, double *const *S,      \
                                               double *const *gradient, double *const *out) {                          \
        if (what == VISCOUS)                                                                                           \
            viscous_faces(dim, m, true, f, S, gradient, out);                                                          \
        else                                                                                                           \
            heat_of_faces(dim, f, S, gradient, out[0]);                                                                \
    }
ROUND_FACES(1, 1)
ROUND_FACES(1, 2)
ROUND_FACES(1, 3)
ROUND_FACES(2, 2)
ROUND_FACES(2, 3)

typedef void faces_function(enum diffusing what, const struct face_batch *f, double *const *S, double *const *gradient,
                            double *const *out);
/* By whether the mesh is round, by the dimension, and by the components of u beyond it. */
static faces_function *const faces_of[2][3][3] = {
    {{faces_1_1, faces_1_2, faces_1_3}, {faces_2_2, faces_2_3, NULL}, {faces_3_3, NULL, NULL}},
    {{round_faces_1_1, round_faces_1_2, round_faces_1_3}, {round_faces_2_2, round_faces_2_3, NULL}}};

/* Sets keep[BATCH] to f->keep, or 1, but for the faces of flagged cells. */
static const double *leave_flagged(const struct face_batch *f, const double *flag, double *keep) {
    for (int i = 0; i < f->n; i++) keep[i] = flag[f->left[i]] + flag[f->right[i]] > 0 ? 0 : f->keep ? f->keep[i] : 1;
    return keep;
}

/* Fluxes of momentum or heat through faces first <= i < last, into the lines c->flux from 0 on; `work`: behind those of
 * momentum that of energy. */
static void find_fluxes(struct gas *g, enum diffusing what, bool work, double *const *S, int first, int last) {
    struct cells *c = g->cells;
    const struct cells_diffuser *d = c->diffuser;
    const struct polyhedra_faces *m = &c->polyhedra->face;
    double keep[BATCH];
    for (int at = first; at < last; at += BATCH) {
        struct face_batch f = {.n = last - at < BATCH ? last - at : BATCH,
                               .left = m->left + at,
                               .right = m->right + at,
                               .share = d->share + at,
                               .inverse = d->inverse + at};
        double *out[MAX_VAR] = {0};
        for (int k = 0; k < g->dim; k++) {
            f.normal[k] = m->normal[k] + at;
            f.oblique[k] = d->oblique[k] + at;
        }
        for (int i = 0; i < 3; i++) f.face[i] = d->face[i] + at;
        for (int v = 0; v <= g->components; v++) out[v] = c->flux[v] + at;
        if (what == HEAT && d->keep) f.keep = d->keep + at;
        if (g->limits.flags.blocks[0]) f.keep = leave_flagged(&f, g->limits.flags.cells[0], keep);
        f.swirl = g->models.swirl;
        if (f.swirl) f.lever = cells_round_levers(g) + at;
        if (d->turn && what == VISCOUS)
            cells_turn_faces(g, d->turn, at, f.n, S[c->polyhedra->round.radial], &f.around, &f.hoop);
        faces_of[d->turn != NULL][g->dim - 1][g->components - g->dim](
            what, &f, S, what == HEAT && !d->skewed ? NULL : (double *const *)d->gradient, out);
        if (work) work_faces(g->components, &f, S, out);
    }
}

/* The jumps to mirrors hold the heat of friction on walls, and that of the gradient of rho there, for the gradients;
 * the gas has had it before conduction, so the faces do not pass it on again. */
static void drop_friction(struct gas *g, double weight) {
    const struct cells_diffuser *d = g->cells->diffuser;
    const int first = g->cells->polyhedra->face.ninternal;
    for (int face = first; face < g->cells->polyhedra->face.n; face++)
        g->cells->flux[0][face] += d->face[2][face] * d->inverse[face] * (weight * d->wall.lift[face - first]);
}

/* Sets the lines of S that gradients and faces see, in cells from <= i < to: of a swirl its angular velocity. */
static void seen_lines(const struct gas *g, enum diffusing what, int from, int to, double **line) {
    const struct cells_diffuser *d = g->cells->diffuser;
    for (int c = 0; c < lines_of(g, what); c++) line[c] = d->sum[g->diffusion.last][c];
    if (d->turn && what == VISCOUS) cells_turn_see(g, d->turn, from, to, line);
}

/* All fluxes of S, and the work if it is wanted: first those that need no ghosts, while the ghosts are under way. */
static void flow(struct gas *g, enum diffusing what, bool work, double weight) {
    struct cells_diffuser *d = g->cells->diffuser;
    struct polyhedra *m = g->cells->polyhedra;
    const int own_mirrors = m->face.n - m->face.ninternal;
    const struct mirror_sums sums = {what,
                                     weight,
                                     what == VISCOUS ? d->wall.drag : d->wall.heat,
                                     d->wall.lift,
                                     (const double *const *)d->start,
                                     d->sum[g->diffusion.last]};
    double *S[MAX_DIM] = {NULL};
    polyhedra_fill_start(m, lines_of(g, what), sums.S);
    cells_mirror_sums(g, &sums, 0, own_mirrors);
    seen_lines(g, what, 0, m->nown, S);
    seen_lines(g, what, m->ncells, m->ncells + own_mirrors, S);
    find_gradients(g, what, S, 0, m->ninner);
    find_fluxes(g, what, work, S, 0, m->face.nlocal);
    polyhedra_fill_finish(m);
    cells_mirror_sums(g, &sums, own_mirrors, m->mirror.n);
    seen_lines(g, what, m->nown, m->ncells, S);
    seen_lines(g, what, m->ncells + own_mirrors, m->size, S);
    find_gradients(g, what, S, m->ninner, m->nnear);
    if (what == VISCOUS && g->dim > 1) cells_mirror_gradients(g, 0, own_mirrors, d->wall.drag, d->gradient);
    find_fluxes(g, what, work, S, m->face.nlocal, m->face.n);
    if (what == HEAT && d->lifts) drop_friction(g, weight);
}

/* q = q_0 + per M/rho, then S of the next stage, which takes the place of the sum before the last. */
KERNEL static void sum_row(int n, const double *restrict c, double per, const double *restrict M,
                           const double *restrict rho, const double *restrict start, const double *restrict last,
                           double *restrict next) {
    if (c[1] == 0)
        for (int i = 0; i < n; i++) next[i] = 0; /* it may hold anything */
    for (int i = 0; i < n; i++) {
        const double q = start[i] + per * M[i] / rho[i];
        next[i] = (c[0] * last[i] + c[1] * next[i]) + (c[2] * q + c[3] * start[i]);
    }
}

void cells_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight) {
    struct cells_diffuser *d = g->cells->diffuser;
    const int nown = g->cells->polyhedra->nown;
    const double per = what == VISCOUS ? 1 : temperature_of(&g->models.material, 1), *rho = Y0->block[0];
    double M[BATCH];
    flow(g, what, false, weight);
    for (int at = 0; at < nown; at += BATCH) {
        const int n = nown - at < BATCH ? nown - at : BATCH;
        for (int v = 0; v < lines_of(g, what); v++) {
            cells_residuals(g->cells, at, n, g->cells->flux[v], M);
            if (d->turn && what == VISCOUS) cells_turn_push(g, d->turn, v, at, n, M);
            double *next = d->sum[1 - g->diffusion.last][v] + at;
            sum_row(n, c, per, M, rho + at, d->start[v] + at, d->sum[g->diffusion.last][v] + at, next);
            for (int i = 0; i < n && c[4] > 0; i++) next[i] += c[4] * g->diffusion.friction[0][at + i];
        }
    }
    g->diffusion.last = 1 - g->diffusion.last;
}

long cells_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight) {
    struct cells_diffuser *d = g->cells->diffuser;
    const struct polyhedra *m = g->cells->polyhedra;
    const double *from = Y0->block[0];
    double M[MAX_DIM + 1][BATCH];
    long count = 0;
    flow(g, what, what == VISCOUS, weight);
    if (what == VISCOUS && d->slides) cells_slide(g, weight, d->wall.stays, d->sum[g->diffusion.last]);
    if (g->books.tally) cells_tally_diffusion(g, what, dt);
    for (int at = 0; at < m->nown; at += BATCH) {
        const int n = m->nown - at < BATCH ? m->nown - at : BATCH;
        for (int v = 0; v <= (what == VISCOUS ? g->components : 0); v++)
            cells_residuals(g->cells, at, n, g->cells->flux[v], M[v]);
        for (int v = 0; v < g->components && d->turn && what == VISCOUS; v++)
            cells_turn_push(g, d->turn, v, at, n, M[v]);
        const double *E = from + energy_at(g) * g->size;
        count += move_row(g, &(struct moved){what, {0, at, n}, from, E, to->block[0], dt, M});
    }
    return count;
}

/* ---- implicit ---------------------------------------------------------------------------------------------------- */

/* The linear systems of implicit diffusion (hook `weight` of libcore/gas/engine.h). The matrix, from which the
 * preconditioner is made, is that of the jumps along the lines of centres: what gradients add to the fluxes is left
 * out, and so is what couples the components. */

/* The jump of an S that is 1 in component c of the cell at a face, on a patch if `edge` >= 0. */
static void jump_of(struct gas *g, enum diffusing what, int cell, int edge, int c, double jump[MAX_DIM]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    double *const *S = d->sum[g->diffusion.last];
    const int lines = what == VISCOUS ? g->components : 1;
    const struct mirror_sums sums = {
        what, 0, what == VISCOUS ? d->wall.drag : d->wall.heat, d->wall.lift, (const double *const *)d->start, S};
    for (int i = 0; i < lines; i++) jump[i] = i == c;
    if (edge < 0) return;
    for (int i = 0; i < lines; i++) S[i][cell] = i == c;
    cells_mirror_sums(g, &sums, edge, edge + 1);
    for (int i = 0; i < lines; i++) jump[i] -= S[i][m->ncells + edge];
}

/* Component c of the flux that a jump between its two cells makes through face i. */
static double passed(const struct gas *g, enum diffusing what, int i, int c, const double jump[MAX_DIM]) {
    const struct cells_diffuser *d = g->cells->diffuser;
    double *const *normal = g->cells->polyhedra->face.normal, along = 0;
    if (what == HEAT) return d->face[2][i] * d->inverse[i] * jump[0];
    for (int k = 0; k < g->dim; k++) along += normal[k][i] * jump[k];
    if (c >= g->dim) return d->face[1][i] * jump[c] * d->inverse[i]; /* of a swirl but for some h/r */
    return (d->face[1][i] * jump[c] + (d->face[0][i] + d->face[1][i]) * normal[c][i] * along) * d->inverse[i];
}

double cells_implicit_weight(struct gas *g, enum diffusing what, double per, int block, long at, int k, int c) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int entry = m->face_of_cell[m->face_start[at] + k];
    double jump[MAX_DIM] = {0};
    (void)block;
    jump_of(g, what, (int)at, entry < m->face.ninternal ? -1 : entry - m->face.ninternal, c, jump);
    return per * passed(g, what, entry < 0 ? ~entry : entry, c, jump);
}
