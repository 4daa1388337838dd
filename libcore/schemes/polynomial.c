/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies fits to batches of polyhedral cells (polynomial.h): limited linear polynomials and CWENO3, which cite their
 * sources below; polynomial_fit.c makes the weights. */
#include "libcore/schemes/polynomial_fit.h"

#include "libcore/schemes/limit.h"

#define EACH_LANE for (int l = 0; l < LANES; l++)
static const double SMALL = 1e-6; /* squared ratio of variation to scale below which nothing is limited */
/* The epsilon of CWENO3's weights: a variation by 1 % of the scale per cell is smooth. */
static const double EPSILON = 1e-4;
static const double OVER = 0.2;    /* how far CWENO3 may leave the range of its stencil, in units of that range */
static const double TINY = 1e-300; /* keeps 0/0 away, in any unit */
/* Share of an average's distance that is more than KEPT by any round-off: what is surely kept is kept. */
static const double SURE = 1.001 * KEPT;

ALWAYS_INLINE void own_values(const struct fit *f, int batch, const double *restrict q, double *restrict own) {
    int first = batch * LANES, n = f->polyhedra->nnear - first < LANES ? f->polyhedra->nnear - first : LANES;
    memcpy(own, q + first, (size_t)n * sizeof *own);
    for (int l = n; l < LANES; l++) own[l] = q[first];
}
ALWAYS_INLINE void differences(const int *restrict cell, const double *restrict q, const double *restrict own,
                               double *restrict d) {
    EACH_LANE d[l] = q[cell[l]] - own[l];
}

/* The state that is taken from the values of a variable (fit_rest). */
struct rest_state {
    const double *rest; /* NULL: nothing is taken */
    double own[LANES], near[LANES];
};
ALWAYS_INLINE void find_rest(const struct fit *f, int batch, int v, struct rest_state *restrict c) {
    c->rest = f->rest[v];
    if (!c->rest) return;
    own_values(f, batch, c->rest, c->own);
    own_values(f, batch, f->near, c->near);
}
ALWAYS_INLINE void take_rest(const int *restrict cell, const struct rest_state *restrict c, double *restrict d) {
    if (!c->rest) return;
    EACH_LANE d[l] -= c->near[l] * (c->rest[cell[l]] - c->own[l]);
}

/* Limiters and weights act in the frame that moves with the cell: m' = m - u rho, E' = E - u.m + |u|^2/2 rho with the
 * cell's own u. This map is linear, so it takes polynomials to polynomials of the same degree, and cell averages to
 * averages; what is done in this frame cannot depend on the observer's speed, and at high Mach numbers it sees the
 * internal energy, which in E is no more than the noise. There E' = rho eps, and the variables have scales. */
struct moving_frame {
    double velocity[MAX_DIM][LANES], half_square[LANES];
    double square[MAX_VAR][LANES]; /* squares of the scales rho, rho sqrt(2 eps), rho eps */
    double energy[LANES];          /* rho eps */
};
ALWAYS_INLINE void find_frame(int m, double (*restrict own)[LANES], struct moving_frame *restrict f) {
    EACH_LANE {
        double rho = own[0][l], sum = 0;
        for (int k = 0; k < m; k++) {
            f->velocity[k][l] = own[k + 1][l] / rho;
            sum += f->velocity[k][l] * f->velocity[k][l];
        }
        double energy = own[m + 1][l] - 0.5 * rho * sum;
        f->half_square[l] = 0.5 * sum;
        f->energy[l] = energy;
        f->square[0][l] = rho * rho;
        for (int k = 0; k < m; k++) f->square[k + 1][l] = fabs(2 * rho * energy);
        f->square[m + 1][l] = energy * energy;
    }
}
/* Moves lines of (rho, m, E), or of their differences, into the frame (sign -1) or out of it (1). */
ALWAYS_INLINE void boost(int m, double sign, const struct moving_frame *restrict f, double *const *line) {
    double *restrict rho = line[0], *restrict E = line[m + 1], dot[LANES] = {0};
    for (int k = 0; k < m; k++) {
        double *restrict q = line[k + 1];
        EACH_LANE {
            dot[l] += f->velocity[k][l] * q[l];
            q[l] = fma(sign * f->velocity[k][l], rho[l], q[l]);
        }
    }
    EACH_LANE E[l] = fma(f->half_square[l], rho[l], E[l] + sign * dot[l]);
}

struct bounds {
    double low[LANES], high[LANES]; /* range of the stencil's values, less the cell's */
};
ALWAYS_INLINE void extend(struct bounds *restrict b, const double *restrict d) {
    EACH_LANE {
        b->low[l] = smaller(d[l], b->low[l]);
        b->high[l] = larger(d[l], b->high[l]);
    }
}

/* Limits a gradient, which comes from least squares with weights 1/distance^2, by the limiter of Barth & Jespersen
 * (AIAA 89-0366, 1989): values halfway to first-ring members stay within the values of the stencil, and face values are
 * cut to these bounds one by one, too. On a linear field the bounds are twice as far away as the values halfway,
 * whatever the mesh: the more room there is, the less is cut. Where the stencil varies by less than 1e-3 of the scale
 * the limiter does not act, and it fades in up to sqrt(2) times that variation: smooth extrema keep their order (the
 * switch of Michalak & Ollivier-Gooch, J. Comput. Phys. 228, 2009, made independent of units). */
ALWAYS_INLINE void limit(int dim, const struct entries *halfway, int batch, const double *restrict square,
                         struct bounds *restrict b, double (*restrict a)[LANES]) {
    double least[LANES] = {0}, most[LANES] = {0};
    for (int j = halfway->start[batch]; j < halfway->start[batch + 1]; j++) {
        const double *x = halfway->data + (long)j * dim * LANES;
        EACH_LANE {
            double change = 0;
            for (int k = 0; k < dim; k++) change += x[k * LANES + l] * a[k][l];
            least[l] = smaller(change, least[l]);
            most[l] = larger(change, most[l]);
        }
    }
    EACH_LANE {
        double low = b->low[l], high = b->high[l], range = high - low, small = SMALL * square[l];
        double above = 2 * most[l] > high ? high / most[l] : 2, below = 2 * least[l] < low ? low / least[l] : 2;
        double room = smaller(above, below), limiter = smaller(room, 1);
        double y = larger(smaller((range * range - small) / (small + TINY), 1), 0);
        double off = fma(y * y, fma(2, y, -3), 1), wider = larger(off, room - 1) * range;
        limiter = fma(off, 1 - limiter, limiter);
        b->low[l] = low - wider;
        b->high[l] = high + wider;
        for (int k = 0; k < dim; k++) a[k][l] *= limiter;
    }
}

struct batch {
    double own[MAX_VAR][LANES]; /* averages of the cells */
    struct moving_frame frame;
    struct bounds bounds[MAX_VAR]; /* in their frames */
};
ALWAYS_INLINE double *change_of(const struct fit *f, int j, int v) { /* of the batch's entry j of `member` */
    return f->change + ((long)j * f->nvar + v) * LANES;
}

KERNEL static void find_changes(const struct fit *f, int batch, const double *const *U, struct batch *restrict c) {
    const int n = f->member.start[batch + 1] - f->member.start[batch];
    for (int v = 0; v < f->nvar; v++) {
        const int *cell = f->member.cell + (long)f->member.start[batch] * LANES;
        struct rest_state rest;
        own_values(f, batch, U[v], c->own[v]);
        find_rest(f, batch, v, &rest);
        for (int j = 0; j < n; j++, cell += LANES) {
            differences(cell, U[v], c->own[v], change_of(f, j, v));
            take_rest(cell, &rest, change_of(f, j, v));
        }
    }
}

/* Moves the changes into the frames of the cells, and finds their bounds. */
ALWAYS_INLINE void move_all(int m, const struct fit *f, int batch, struct batch *restrict c) {
    double *line[MAX_VAR];
    for (int v = 0; v < m + 2; v++) EACH_LANE c->bounds[v].low[l] = c->bounds[v].high[l] = 0;
    for (int j = 0; j < f->member.start[batch + 1] - f->member.start[batch]; j++) {
        for (int v = 0; v < m + 2; v++) line[v] = change_of(f, j, v);
        boost(m, -1, &c->frame, line);
        for (int v = 0; v < m + 2; v++) extend(&c->bounds[v], line[v]);
    }
}
KERNEL static void move_changes(int m, const struct fit *f, int batch, struct batch *restrict c) {
    if (m == 1) move_all(1, f, batch, c);
    if (m == 2) move_all(2, f, batch, c);
    if (m == 3) move_all(3, f, batch, c);
}

/* Computes sum[k] = sum_j w[j][k] change[used[j]] of n members, whose changes are `apart`. NEAR lanes at a time: their
 * sums stay in registers. */
ALWAYS_INLINE void add_near(int ncoef, int n, const double *restrict w, const int *restrict used,
                            const double *restrict change, long apart, double *restrict sum) {
    enum { NEAR = 16 };
    for (int from = 0; from < LANES; from += NEAR) {
        double a[MAX_COEFFICIENT * NEAR];
        for (int i = 0; i < ncoef * NEAR; i++) a[i] = 0;
        for (int j = 0; j < n; j++)
            for (int k = 0; k < ncoef; k++)
                for (int l = 0; l < NEAR; l++)
                    a[k * NEAR + l] = fma(w[((long)j * ncoef + k) * LANES + from + l],
                                          change[used[j] * apart + from + l], a[k * NEAR + l]);
        for (int k = 0; k < ncoef; k++)
            for (int l = 0; l < NEAR; l++) sum[k * LANES + from + l] = a[k * NEAR + l];
    }
}
KERNEL static void add_changes(int ncoef, int n, const double *w, const int *used, const double *change, long apart,
                               double *sum) {
    if (ncoef == 1) add_near(1, n, w, used, change, apart, sum);
    if (ncoef == 2) add_near(2, n, w, used, change, apart, sum);
    if (ncoef == 3) add_near(3, n, w, used, change, apart, sum);
    if (ncoef == 5) add_near(5, n, w, used, change, apart, sum);
    if (ncoef == 9) add_near(9, n, w, used, change, apart, sum);
}

/* Computes the coefficients a of the polynomials of the whole stencils, in the frames of the cells. */
ALWAYS_INLINE void add_members(int m, int ncoef, const struct fit *f, int batch, struct batch *restrict c,
                               double (*restrict a)[MAX_COEFFICIENT][LANES]) {
    const int first = f->member.start[batch], n = f->member.start[batch + 1] - first;
    move_changes(m, f, batch, c);
    for (int v = 0; v < m + 2; v++)
        add_changes(ncoef, n, f->member.data + (long)first * ncoef * LANES, f->all, change_of(f, 0, v), f->nvar * LANES,
                    a[v][0]);
}

/* The line of a variable's values in entry j of `point`. */
ALWAYS_INLINE double *values_of(const struct fit *f, int batch, int v, int j) {
    return f->value + v * f->nvalues + (long)(f->slot[batch] + j - f->point.start[batch]) * LANES;
}

/* Do the bounds of the changes alone, widened by `over` of their range, say that all states keep their distance? In
 * smooth gas they do, and no point is looked at. */
ALWAYS_INLINE bool bounds_kept(int m, const struct fit *f, const double *restrict mean,
                               const struct moving_frame *restrict frame, const struct bounds *restrict b,
                               double over) {
    double square[LANES] = {0}, lost[LANES], any = 0;
    for (int k = 1; k <= m; k++) EACH_LANE {
            const double wider = over * (b[k].high[l] - b[k].low[l]), most = wider + larger(b[k].high[l], -b[k].low[l]);
            square[l] += most * most;
        }
    EACH_LANE {
        const double wider = over * (b[0].high[l] - b[0].low[l]), rho = mean[l] + (b[0].low[l] - wider);
        const double energy =
            (1 - SURE) * frame->energy[l] + (b[m + 1].low[l] - over * (b[m + 1].high[l] - b[m + 1].low[l]));
        const double low = smaller(f->least + SURE * (mean[l] - f->least), mean[l]);
        const bool kept = (rho > low) & (b[0].high[l] + wider < (1 - SURE) * (f->most - mean[l])) & (energy > 0) &
                          (energy * rho > 0.5 * square[l]);
        lost[l] = kept ? 0 : 1;
    }
    EACH_LANE any += lost[l];
    return any == 0;
}

/* Do the states at all face points of the cells keep their distance from the edge of the admissible set? (NaN: no) */
ALWAYS_INLINE bool all_kept(int m, const struct fit *f, int batch, const double *restrict mean,
                            const struct moving_frame *restrict frame) {
    double low[LANES], high[LANES], warm[LANES], lost[LANES] = {0};
    EACH_LANE {
        low[l] = smaller(f->least + KEPT * (mean[l] - f->least), mean[l]) - mean[l];
        high[l] = (1 - KEPT) * (f->most - mean[l]);
        warm[l] = KEPT * frame->energy[l];
    }
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++) {
        const double *restrict line[MAX_VAR];
        double square[LANES] = {0};
        for (int v = 0; v < m + 2; v++) line[v] = values_of(f, batch, v, j);
        for (int k = 1; k <= m; k++) EACH_LANE square[l] += line[k][l] * line[k][l];
        EACH_LANE {
            const double rho = mean[l] + line[0][l], over = frame->energy[l] - warm[l] + line[m + 1][l];
            const bool kept = (line[0][l] >= low[l]) & (line[0][l] <= high[l]) & (over * rho >= 0.5 * square[l]);
            lost[l] = kept ? lost[l] : 1;
        }
    }
    double any = 0;
    EACH_LANE any += lost[l];
    return any == 0;
}

/* Draws the changes at the face points of each cell to 0, all by one factor, until all states keep their distance: with
 * factors of their own, more mass would leave a cell at all its faces than it has (docs/physics.md 7.3). rho e is
 * concave: on the way to the average it rises at least linearly. */
ALWAYS_INLINE void draw_points(int m, const struct fit *f, int batch, const double *restrict mean,
                               const struct moving_frame *restrict frame) {
    double theta[LANES];
    EACH_LANE theta[l] = frame->energy[l] > 0 ? 1 : 0;
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++) {
        double *line[MAX_VAR];
        for (int v = 0; v < m + 2; v++) line[v] = values_of(f, batch, v, j);
        EACH_LANE {
            const double change = line[0][l], low = smaller(f->least + KEPT * (mean[l] - f->least), mean[l]) - mean[l];
            const double high = (1 - KEPT) * (f->most - mean[l]), edge = change < low ? low : high;
            const bool inside = (change >= low) & (change <= high);
            const double here = inside ? 1 : edge / change;
            double square = 0;
            for (int k = 1; k <= m; k++) square += line[k][l] * line[k][l];
            const double e =
                frame->energy[l] + here * line[m + 1][l] - 0.5 * here * here * square / (mean[l] + here * change);
            const double warm = KEPT * frame->energy[l], some = (frame->energy[l] - warm) / (frame->energy[l] - e);
            const double share = here * (e >= warm ? 1 : some);
            theta[l] = share < theta[l] ? share : share >= theta[l] ? theta[l] : 0; /* NaN: 0 */
        }
    }
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++)
        for (int v = 0; v < m + 2; v++) {
            double *restrict line = values_of(f, batch, v, j);
            EACH_LANE {
                const double drawn = theta[l] * line[l];
                line[l] = theta[l] > 0 ? drawn : 0;
            }
        }
}

/* Turns changes at face points, in the frame of the cell, into values. */
ALWAYS_INLINE void finish_points(int m, const struct fit *f, int batch, const struct batch *restrict c, double over) {
    const double(*own)[LANES] = c->own;
    const struct moving_frame *frame = &c->frame;
    if (f->most > 0 && !bounds_kept(m, f, own[0], frame, c->bounds, over) && !all_kept(m, f, batch, own[0], frame))
        draw_points(m, f, batch, own[0], frame);
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++) {
        double *line[MAX_VAR];
        for (int v = 0; v < m + 2; v++) line[v] = values_of(f, batch, v, j);
        boost(m, 1, frame, line);
        for (int v = 0; v < m + 2; v++) EACH_LANE line[v][l] += own[v][l];
    }
}

/* The pieces below are functions of their own, so that each is compiled once for a dimension or a number of components,
 * not once for every pair of them and every way to fit. */
KERNEL static void finish_cells(int m, const struct fit *f, int batch, const struct batch *restrict c, double over) {
    if (m == 1) finish_points(1, f, batch, c, over);
    if (m == 2) finish_points(2, f, batch, c, over);
    if (m == 3) finish_points(3, f, batch, c, over);
}

ALWAYS_INLINE void linear_changes(int dim, const struct fit *f, int batch, int v, const struct bounds *restrict b,
                                  double (*restrict a)[LANES]) {
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++) {
        const double *restrict x = f->point.data + (long)j * dim * LANES;
        double *restrict out = values_of(f, batch, v, j);
        EACH_LANE {
            double change = 0;
            for (int k = 0; k < dim; k++) change += x[k * LANES + l] * a[k][l];
            out[l] = larger(smaller(change, b->high[l]), b->low[l]);
        }
    }
}

#define LIMITED(dim)                                                                                                   \
    limit(dim, &f->halfway, batch, square, b, a);                                                                      \
    linear_changes(dim, f, batch, v, b, a)
KERNEL static void limited_changes(int dim, const struct fit *f, int batch, int v, const double *restrict square,
                                   struct bounds *restrict b, double (*restrict a)[LANES]) {
    if (dim == 1) {
        LIMITED(1);
    } else if (dim == 2) {
        LIMITED(2);
    } else {
        LIMITED(3);
    }
}

ALWAYS_INLINE void linear(int dim, int m, const struct fit *f, int batch, const double *const *U) {
    double a[MAX_VAR][MAX_COEFFICIENT][LANES];
    struct batch c;
    find_changes(f, batch, U, &c);
    find_frame(m, c.own, &c.frame);
    add_members(m, dim, f, batch, &c, a);
    for (int v = 0; v < m + 2; v++) limited_changes(dim, f, batch, v, c.frame.square[v], &c.bounds[v], a[v]);
    finish_cells(m, f, batch, &c, 0);
}

/* CWENO of Levy, Puppo & Russo (SIAM J. Sci. Comput. 22, 2000; docs/physics.md 6.11) with the quadratic of the whole
 * stencil as the optimal polynomial P_opt and linear polynomials, one per sector, as in Dumbser, Boscheri, Semplice &
 * Russo (SIAM J. Sci. Comput. 39, 2017):
 *   P = w_0/d_0 (P_opt - sum d_s P_s) + sum w_s P_s,   w_s ~ d_s (1 + (tau/(I_s + epsilon))^2)
 * with the Z weights of Cravero, Semplice & Visconti (SIAM J. Numer. Anal. 57, 2019). I is the sum over the derivatives
 * of the mean over the cell (taken as a cube) of their square, in units of the squared scales of the frame, and over
 * the variables: one set of weights for all variables makes less noise behind shocks than one for each, as their
 * profiles keep together. epsilon = 1e-4: a smooth wave keeps the quadratic alone from 30 cells a length on. tau = mean
 * |I_s - I_opt| is large wherever one sector is smooth and another is not, while a difference of means cancels at some
 * jumps. The bounds count where no sector is smooth: in wedges at a wall. */
ALWAYS_INLINE int quadratics(int dim) {
    return dim * (dim + 1) / 2;
}
ALWAYS_INLINE int product(int dim, int i, int j) { /* place of x_i x_j, i <= j, among the coefficients */
    return dim + i * dim - i * (i - 1) / 2 + j - i;
}

ALWAYS_INLINE void boost_all(int m, int each, const struct moving_frame *restrict frame, double (*restrict g)[LANES]) {
    double *line[MAX_VAR];
    for (int i = 0; i < each; i++) {
        for (int v = 0; v < m + 2; v++) line[v] = g[v * each + i];
        boost(m, -1, frame, line);
    }
}
KERNEL static void boost_sectors(int m, int each, const struct moving_frame *restrict frame,
                                 double (*restrict g)[LANES]) {
    if (m == 1) boost_all(1, each, frame, g);
    if (m == 2) boost_all(2, each, frame, g);
    if (m == 3) boost_all(3, each, frame, g);
}

/* Computes the gradients [v][s][k] of the sectors in the frame of the cell, from changes that are not in it. */
static void sector_gradients(int dim, int m, const struct fit *f, int batch, const struct batch *c) {
    const int first = f->share.start[batch], sectors = f->share.start[batch + 1] - first;
    double(*g)[LANES] = (double(*)[LANES])f->gradient;
    for (int s = 0, at = f->sector.start[batch]; s < sectors; at += f->uses[first + s++])
        for (int v = 0; v < m + 2; v++)
            add_changes(dim, f->uses[first + s], f->sector.data + (long)at * dim * LANES, f->used + at,
                        change_of(f, 0, v), f->nvar * LANES, g[(v * sectors + s) * dim]);
    boost_sectors(m, sectors * dim, &c->frame, g);
}

/* Adds to I the smoothness of the quadratic a, |gradient|^2 + (1 + 1/12) |second derivatives|^2, over the squared
 * scale. */
ALWAYS_INLINE void add_smoothness(int dim, double (*restrict a)[LANES], const double *restrict inverse,
                                  double *restrict I) {
    EACH_LANE {
        double first = 0, second = 0;
        for (int k = 0; k < dim; k++) first += a[k][l] * a[k][l];
        /* j starts at 0: from i on compilers do not unroll these loops, which would cost vectors */
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++)
                if (j >= i) second += (i == j ? 4. : 2.) * (a[product(dim, i, j)][l] * a[product(dim, i, j)][l]);
        I[l] = fma(fma(13. / 12, second, first), inverse[l], I[l]);
    }
}

/* Turns the smoothness I of the quadratic and w of the sectors into nonlinear weights: `central` becomes w_0/d_0, w
 * becomes w_s - d_s w_0/d_0. */
ALWAYS_INLINE void weigh(const double *restrict share, int sectors, const double *restrict I,
                         double (*restrict w)[LANES], double *restrict central) {
    double tau[LANES] = {0}, shares[LANES] = {0}, sum[LANES];
    for (int s = 0; s < sectors; s++) EACH_LANE {
            tau[l] = fma(share[s * LANES + l], fabs(w[s][l] - I[l]), tau[l]);
            shares[l] += share[s * LANES + l];
        }
    EACH_LANE {
        tau[l] /= larger(shares[l], TINY);
        double ratio = tau[l] / (I[l] + EPSILON);
        central[l] = fma(ratio, ratio, 1);
        sum[l] = (1 - shares[l]) * central[l];
    }
    for (int s = 0; s < sectors; s++) EACH_LANE {
            double ratio = tau[l] / (w[s][l] + EPSILON);
            w[s][l] = share[s * LANES + l] * fma(ratio, ratio, 1);
            sum[l] += w[s][l];
        }
    EACH_LANE {
        sum[l] = 1 / sum[l];
        central[l] *= sum[l];
    }
    for (int s = 0; s < sectors; s++) EACH_LANE w[s][l] = fma(w[s][l], sum[l], -central[l] * share[s * LANES + l]);
}

/* Turns a, the coefficients of P_opt, into those of P with the gradients g of the sectors; w is room for their
 * weights. */
ALWAYS_INLINE void combine(int dim, int m, const double *restrict share, int sectors,
                           const struct moving_frame *restrict frame, double (*restrict g)[LANES],
                           double (*restrict w)[LANES], double (*restrict a)[MAX_COEFFICIENT][LANES]) {
    const int each = sectors * dim;
    double I[LANES] = {0}, central[LANES], inverse[MAX_VAR][LANES];
    for (int v = 0; v < m + 2; v++) {
        EACH_LANE inverse[v][l] = 1 / larger(frame->square[v][l], TINY);
        add_smoothness(dim, a[v], inverse[v], I);
    }
    for (int s = 0; s < sectors; s++) {
        EACH_LANE w[s][l] = 0;
        for (int v = 0; v < m + 2; v++) {
            double(*restrict at)[LANES] = g + v * each + s * dim;
            EACH_LANE {
                double sum = 0;
                for (int k = 0; k < dim; k++) sum += at[k][l] * at[k][l];
                w[s][l] = fma(sum, inverse[v][l], w[s][l]);
            }
        }
    }
    weigh(share, sectors, I, w, central);
    for (int v = 0; v < m + 2; v++) {
        for (int k = 0; k < dim + quadratics(dim); k++) EACH_LANE a[v][k][l] *= central[l];
        for (int s = 0; s < sectors; s++)
            for (int k = 0; k < dim; k++) EACH_LANE a[v][k][l] = fma(w[s][l], g[v * each + s * dim + k][l], a[v][k][l]);
    }
}

ALWAYS_INLINE void quadratic_changes(int dim, const struct fit *f, int batch, int v, const struct bounds *restrict b,
                                     double (*restrict a)[LANES]) {
    const double *moment = f->moment.data + (long)batch * quadratics(dim) * LANES;
    double base[LANES], low[LANES], high[LANES];
    EACH_LANE {
        double mean = 0;
        for (int m = 0; m < quadratics(dim); m++) mean = fma(a[dim + m][l], moment[m * LANES + l], mean);
        base[l] = -mean;
        low[l] = fma(OVER, b->low[l] - b->high[l], b->low[l]);
        high[l] = fma(OVER, b->high[l] - b->low[l], b->high[l]);
    }
    for (int p = f->point.start[batch]; p < f->point.start[batch + 1]; p++) {
        const double *restrict x = f->point.data + (long)p * dim * LANES;
        double *restrict out = values_of(f, batch, v, p);
        EACH_LANE {
            double sum = base[l];
            for (int i = 0; i < dim; i++) {
                double slope = a[i][l];
                for (int j = 0; j < dim; j++)
                    if (j >= i) slope = fma(a[product(dim, i, j)][l], x[j * LANES + l], slope);
                sum = fma(slope, x[i * LANES + l], sum);
            }
            out[l] = larger(smaller(sum, high[l]), low[l]);
        }
    }
}

KERNEL static void curved_changes(int dim, const struct fit *f, int batch, int v, const struct bounds *restrict b,
                                  double (*restrict a)[LANES]) {
    if (dim == 1) quadratic_changes(1, f, batch, v, b, a);
    if (dim == 2) quadratic_changes(2, f, batch, v, b, a);
    if (dim == 3) quadratic_changes(3, f, batch, v, b, a);
}

/* Turns the coefficients a of the quadratics of the whole stencils into those of CWENO3. */
ALWAYS_INLINE void combine_dim(int dim, int m, struct fit *f, int batch, const struct batch *restrict c,
                               double (*restrict a)[MAX_COEFFICIENT][LANES]) {
    const int first = f->share.start[batch], sectors = f->share.start[batch + 1] - first;
    combine(dim, m, f->share.data + (long)first * LANES, sectors, &c->frame, (double(*)[LANES])f->gradient,
            (double(*)[LANES])f->weight, a);
}
KERNEL static void combine_sectors(int dim, int m, struct fit *f, int batch, const struct batch *restrict c,
                                   double (*restrict a)[MAX_COEFFICIENT][LANES]) {
    if (dim == 1) combine_dim(1, m, f, batch, c, a);
    if (dim == 2) combine_dim(2, m, f, batch, c, a);
    if (dim == 3) combine_dim(3, m, f, batch, c, a);
}

ALWAYS_INLINE void cweno3(int dim, int m, struct fit *f, int batch, const double *const *U) {
    double a[MAX_VAR][MAX_COEFFICIENT][LANES];
    struct batch c;
    find_changes(f, batch, U, &c);
    find_frame(m, c.own, &c.frame);
    sector_gradients(dim, m, f, batch, &c);
    add_members(m, dim + quadratics(dim), f, batch, &c, a);
    combine_sectors(dim, m, f, batch, &c, a);
    for (int v = 0; v < m + 2; v++) curved_changes(dim, f, batch, v, &c.bounds[v], a[v]);
    finish_cells(m, f, batch, &c, OVER);
}

/* One function for every dimension and every number of components of u: loops over coefficients unroll. Meshes of one
 * axis are too small to need one for each number of components. */
#define EACH(kind, axes, components)                                                                                   \
    if (f->polyhedra->dim == (axes) && f->nvar == (components) + 2) kind(axes, components, f, batch, U)
#define CELLS(kind)                                                                                                    \
    KERNEL static void kind##_cells(struct fit *f, int batch, const double *const *U) {                                \
        if (f->polyhedra->dim == 1) kind(1, f->nvar - 2, f, batch, U);                                                 \
        EACH(kind, 2, 2);                                                                                              \
        EACH(kind, 2, 3);                                                                                              \
        EACH(kind, 3, 3);                                                                                              \
    }
CELLS(linear)
CELLS(cweno3)

const struct polynomial polynomial_table[] = {
    {MODEL("firstOrder", "the cell's value"), 1, 0, NULL},
    {MODEL("linear", "second order: least-squares gradients, limited (Barth & Jespersen 1989)"), 1, 1, linear_cells},
    {MODEL("CWENO3", "third order on smooth flow: a quadratic, near shocks linear polynomials of sectors "
                     "(Levy, Puppo & Russo 2000; Dumbser et al. 2017)"),
     2, 2, cweno3_cells},
};
const int polynomial_count = sizeof polynomial_table / sizeof *polynomial_table;

const struct polynomial *polynomial_find(const char *name) {
    return model_find(polynomial_table, sizeof *polynomial_table, polynomial_count, name);
}

void fit_rest(struct fit *f, const double *rho, const double *E, const double *near) {
    f->rest[0] = rho;
    f->rest[f->nvar - 1] = E;
    f->near = near;
}

void fit_keep(struct fit *f, double least, double most) {
    f->least = least;
    f->most = most;
}

void fit_cells(struct fit *f, int from, int to, const double *const *U) {
    if (f->kind->cells && from < to)
        for (int b = from / LANES; b <= (to - 1) / LANES; b++) f->kind->cells(f, b, U);
}

KERNEL static void gather(int n, const int *restrict place, const double *restrict from, double *restrict to) {
    for (int i = 0; i < n; i++) to[i] = from[place[i]];
}
void fit_points(const struct fit *f, int side, int from, int n, const double *const *U, double *const *out) {
    for (int v = 0; v < f->nvar; v++)
        gather(n, f->place[side] + from, f->kind->cells ? f->value + v * f->nvalues : U[v], out[v]);
}
