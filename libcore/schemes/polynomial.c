/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies fits to batches of polyhedral cells (polynomial.h): limited linear polynomials and CWENO3, which cite their
 * sources below; polynomial_fit.c makes the weights. */
#include "libcore/schemes/polynomial_fit.h"

#include "libcore/schemes/limit.h"

#define EACH_LANE for (int l = 0; l < LANES; l++)
#ifdef __clang__
#define UNROLL_ALL _Pragma("clang loop unroll(full)")
#else
#define UNROLL_ALL _Pragma("GCC unroll 32")
#endif
static const double SMALL = 1e-6; /* squared ratio of variation to scale below which nothing is limited */
/* The epsilon of CWENO3's weights: a variation by 1 % of the scale per cell is smooth. */
static const float EPSILON = 1e-4F;
static const double OVER = 0.2;     /* how far CWENO3 may leave the range of its stencil, in units of that range */
static const double TINY = 1e-300;  /* keeps 0/0 away, in any unit */
static const double SHORT = 1e-150; /* the same, its square is one */
static const float FAR = 1e18F;     /* bounds the ratios in the weights of sectors: their squares stay finite */
static const float LITTLE = 1e-30F; /* the same in single precision */
static const double NEAR = 1e-15;   /* the least scale of sectors, over the changes: so do the squares of these */
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
/* Moves (rho, m, E) of a lane, or their differences, into the frame (sign -1) or out of it (1). */
ALWAYS_INLINE void boost(int m, double sign, const double *restrict velocity, double half_square, double *restrict q) {
    double dot = 0;
    UNROLL_ALL for (int k = 0; k < m; k++) {
        dot += velocity[k] * q[k + 1];
        q[k + 1] = fma(sign * velocity[k], q[0], q[k + 1]);
    }
    q[m + 1] = fma(half_square, q[0], q[m + 1] + sign * dot);
}

struct bounds {
    double low[LANES], high[LANES]; /* range of the stencil's values, less the cell's */
};
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
        ahead_ask(f);
        own_values(f, batch, U[v], c->own[v]);
        find_rest(f, batch, v, &rest);
        for (int j = 0; j < n; j++, cell += LANES) {
            differences(cell, U[v], c->own[v], change_of(f, j, v));
            take_rest(cell, &rest, change_of(f, j, v));
        }
    }
}

/* Moves the changes into the frames of the cells, and finds their bounds (loops as in add_near). */
ALWAYS_INLINE void move_all(int m, const struct fit *f, int batch, struct batch *restrict c) {
    const long n = f->member.start[batch + 1] - f->member.start[batch];
    double *restrict change = f->change;
    EACH_ALONE
    EACH_LANE {
        double u[MAX_DIM], low[MAX_VAR], high[MAX_VAR];
        const double half = c->frame.half_square[l];
        long j = 0;
        UNROLL_ALL for (int k = 0; k < m; k++) u[k] = c->frame.velocity[k][l];
        UNROLL_ALL for (int v = 0; v < m + 2; v++) low[v] = high[v] = 0;
        do {
            double q[MAX_VAR];
            UNROLL_ALL for (int v = 0; v < m + 2; v++) q[v] = change[(j * (m + 2) + v) * LANES + l];
            boost(m, -1, u, half, q);
            UNROLL_ALL for (int v = 0; v < m + 2; v++) {
                change[(j * (m + 2) + v) * LANES + l] = q[v];
                low[v] = smaller(q[v], low[v]);
                high[v] = larger(q[v], high[v]);
            }
        } while (++j < n);
        UNROLL_ALL for (int v = 0; v < m + 2; v++) {
            c->bounds[v].low[l] = low[v];
            c->bounds[v].high[l] = high[v];
        }
    }
}
KERNEL static void move_changes(int m, const struct fit *f, int batch, struct batch *restrict c) {
    if (m == 1) move_all(1, f, batch, c);
    if (m == 2) move_all(2, f, batch, c);
    if (m == 3) move_all(3, f, batch, c);
}

/* Notes the cells whose stencils are uniform: the frame takes no change to 0 but 0. */
KERNEL static void find_uniform(int nvar, const struct batch *restrict c, unsigned char *restrict uniform) {
    EACH_LANE {
        int differs = 0;
        for (int v = 0; v < nvar; v++) differs |= (c->bounds[v].low[l] != 0) | (c->bounds[v].high[l] != 0);
        uniform[l] = (unsigned char)!differs;
    }
}

/* Computes sum[v][k] = sum_j w[j][k] change[j][v] over n > 0 entries for `part` coefficients. All sums stay in
 * registers, so that weights and changes are read once. gcc makes vectors of such a loop if the one inside ends by
 * `while` and all strides are constants. */
ALWAYS_INLINE void add_near(int part, int nvar, int n, const double *restrict w, const double *restrict change,
                            double *restrict sum) {
    EACH_ALONE
    for (int l = 0; l < VECTOR; l++) {
        double a[MAX_VAR * 5];
        long j = 0;
        UNROLL_ALL for (int i = 0; i < nvar * part; i++) a[i] = 0;
        do {
            double x[5];
            UNROLL_ALL for (int k = 0; k < part; k++) x[k] = w[(j * part + k) * VECTOR + l];
            UNROLL_ALL for (int v = 0; v < nvar; v++) {
                const double d = change[(j * nvar + v) * LANES + l];
                UNROLL_ALL for (int k = 0; k < part; k++) a[v * part + k] = fma(x[k], d, a[v * part + k]);
            }
        } while (++j < n);
        UNROLL_ALL for (int v = 0; v < nvar; v++) UNROLL_ALL for (int k = 0; k < part; k++)
            sum[(v * MAX_COEFFICIENT + k) * LANES + l] = a[v * part + k];
    }
}
/* The same for all lanes and coefficients. */
ALWAYS_INLINE void add_parts(int part, int ncoef, const struct fit *f, int nvar, int n, const double *restrict w,
                             double *restrict sum) {
    for (int from = 0; from < LANES; from += VECTOR) {
        ahead_ask(f);
        for (int k = 0; k < ncoef; k += part, w += (long)n * part * VECTOR)
            add_near(part, nvar, n, w, f->change + from, sum + k * LANES + from);
    }
}
#define PARTS(coefficients, variables)                                                                                 \
    if (ncoef == (coefficients) && nvar == (variables))                                                                \
    add_parts(PART(coefficients), coefficients, f, variables, n, w, sum)
KERNEL static void add_changes(int ncoef, const struct fit *f, int nvar, int n, const double *w, double *sum) {
    PARTS(1, 3);
    PARTS(1, 4);
    PARTS(1, 5);
    PARTS(2, 3);
    PARTS(2, 4);
    PARTS(2, 5);
    PARTS(3, 5);
    PARTS(5, 4);
    PARTS(5, 5);
    PARTS(9, 5);
}

/* Computes the coefficients a of the polynomials of the whole stencils, in the frames of the cells. */
static void add_members(int m, int ncoef, const struct fit *f, int batch, double (*a)[MAX_COEFFICIENT][LANES]) {
    const int first = f->member.start[batch], n = f->member.start[batch + 1] - first;
    add_changes(ncoef, f, m + 2, n, f->member.data + (long)first * ncoef * LANES, a[0][0]);
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
    double *restrict out = values_of(f, batch, 0, f->point.start[batch]);
    const long n = f->point.start[batch + 1] - f->point.start[batch], apart = f->nvalues;
    EACH_ALONE
    EACH_LANE {
        double u[MAX_DIM], mean[MAX_VAR];
        const double half = frame->half_square[l];
        long j = 0;
        UNROLL_ALL for (int k = 0; k < m; k++) u[k] = frame->velocity[k][l];
        UNROLL_ALL for (int v = 0; v < m + 2; v++) mean[v] = own[v][l];
        do {
            double q[MAX_VAR];
            UNROLL_ALL for (int v = 0; v < m + 2; v++) q[v] = out[v * apart + j * LANES + l];
            boost(m, 1, u, half, q);
            UNROLL_ALL for (int v = 0; v < m + 2; v++) out[v * apart + j * LANES + l] = q[v] + mean[v];
        } while (++j < n);
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
    ahead_ask(f);
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
    move_changes(m, f, batch, &c);
    if (f->calm) find_uniform(m + 2, &c, f->calm->uniform + (long)batch * LANES);
    add_members(m, dim, f, batch, a);
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

/* The scales of the variables in the frame, and one over each; changes are at most 1/NEAR of them. */
struct scales {
    double of[MAX_VAR][LANES], inverse[MAX_VAR][LANES];
};
ALWAYS_INLINE void find_scales(int m, const struct batch *restrict c, struct scales *restrict s) {
    for (int v = 0; v < m + 2; v++) EACH_LANE {
            const double most = larger(c->bounds[v].high[l], -c->bounds[v].low[l]);
            s->of[v][l] = larger(larger(sqrt(c->frame.square[v][l]), most * NEAR), SHORT);
            s->inverse[v][l] = 1 / s->of[v][l];
        }
}

/* What the sectors see of the changes. */
ALWAYS_INLINE void narrow_all(int m, const struct fit *f, int batch, const struct scales *restrict s) {
    const int entries = f->member.start[batch + 1] - f->member.start[batch];
    for (int j = 0; j < entries; j++)
        for (int v = 0; v < m + 2; v++) {
            const double *restrict change = change_of(f, j, v);
            float *restrict out = f->sector.change + ((long)j * (m + 2) + v) * LANES;
            EACH_LANE out[l] = (float)(change[l] * s->inverse[v][l]);
        }
}
KERNEL static void narrow_changes(int m, const struct fit *f, int batch, const struct scales *s) {
    if (m == 1) narrow_all(1, f, batch, s);
    if (m == 2) narrow_all(2, f, batch, s);
    if (m == 3) narrow_all(3, f, batch, s);
}

/* Computes the gradient g[v][k] of a sector from its n > 0 changes, and its smoothness I = |g|^2 (loops as in
 * add_near). */
ALWAYS_INLINE void add_sector(int dim, int nvar, int n, const float *restrict w, const float *restrict change,
                              float *restrict g, float *restrict I) {
    EACH_ALONE
    EACH_LANE {
        float a[MAX_VAR * MAX_DIM], square = 0;
        long j = 0;
        UNROLL_ALL for (int i = 0; i < nvar * dim; i++) a[i] = 0;
        do {
            float x[MAX_DIM];
            UNROLL_ALL for (int k = 0; k < dim; k++) x[k] = w[(j * dim + k) * LANES + l];
            UNROLL_ALL for (int v = 0; v < nvar; v++) {
                const float d = change[(j * nvar + v) * LANES + l];
                UNROLL_ALL for (int k = 0; k < dim; k++) a[v * dim + k] = fmaf(x[k], d, a[v * dim + k]);
            }
        } while (++j < n);
        UNROLL_ALL for (int i = 0; i < nvar * dim; i++) {
            g[i * LANES + l] = a[i];
            square = fmaf(a[i], a[i], square);
        }
        I[l] = square;
    }
}
ALWAYS_INLINE void add_all(int dim, int m, const struct fit *f, int batch) {
    const struct sectors *s = &f->sector;
    const size_t line = (size_t)(m + 2) * LANES;
    for (int at = s->start[batch]; at < s->start[batch + 1]; at++) {
        const int first = s->first[at], n = s->first[at + 1] - first, i = at - s->start[batch];
        ahead_ask(f);
        for (int j = 0; j < n; j++)
            memcpy(s->taken + (size_t)j * line, s->change + (size_t)s->used[first + j] * line, line * sizeof *s->taken);
        add_sector(dim, m + 2, n, s->data + (long)first * dim * LANES, s->taken,
                   s->gradient + (long)i * (m + 2) * dim * LANES, s->weight + (long)i * LANES);
    }
}
KERNEL static void add_sectors(int dim, int m, const struct fit *f, int batch) {
    if (dim == 1 && m == 1) add_all(1, 1, f, batch);
    if (dim == 1 && m == 2) add_all(1, 2, f, batch);
    if (dim == 1 && m == 3) add_all(1, 3, f, batch);
    if (dim == 2 && m == 2) add_all(2, 2, f, batch);
    if (dim == 2 && m == 3) add_all(2, 3, f, batch);
    if (dim == 3) add_all(3, 3, f, batch);
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
ALWAYS_INLINE float ratio_of(float tau, float I) {
    const float ratio = tau / (I + EPSILON);
    return ratio < FAR ? ratio : FAR;
}
ALWAYS_INLINE void weigh(int sectors, const float *restrict share, const double *restrict I, float *restrict w,
                         double *restrict central) {
    float tau[LANES] = {0}, whole[LANES];
    double shares[LANES] = {0}, sum[LANES];
    EACH_LANE {
        const float smooth = (float)I[l];
        whole[l] = smooth < FAR * FAR ? smooth : FAR * FAR;
    }
    for (int s = 0; s < sectors * LANES; s += LANES) EACH_LANE {
            tau[l] = fmaf(share[s + l], fabsf(w[s + l] - whole[l]), tau[l]);
            shares[l] += (double)share[s + l];
        }
    EACH_LANE {
        tau[l] /= (float)shares[l] + LITTLE;
        const float ratio = ratio_of(tau[l], whole[l]);
        central[l] = (double)fmaf(ratio, ratio, 1);
        sum[l] = (1 - shares[l]) * central[l];
    }
    for (int s = 0; s < sectors * LANES; s += LANES) EACH_LANE {
            const float ratio = ratio_of(tau[l], w[s + l]);
            w[s + l] = share[s + l] * fmaf(ratio, ratio, 1);
            sum[l] += (double)w[s + l];
        }
    EACH_LANE {
        sum[l] = 1 / sum[l];
        central[l] *= sum[l];
    }
    for (int s = 0; s < sectors * LANES; s += LANES) EACH_LANE
    w[s + l] = (float)fma((double)w[s + l], sum[l], -central[l] * (double)share[s + l]);
}

/* Computes sum[v][k], the mean of the gradients of n > 0 sectors with their weights w (loops as in add_near). */
ALWAYS_INLINE void mean_gradients(int count, int n, const float *restrict w, const float *restrict g,
                                  float (*restrict sum)[LANES]) {
    EACH_ALONE
    EACH_LANE {
        float a[MAX_VAR * MAX_DIM];
        long s = 0;
        UNROLL_ALL for (int i = 0; i < count; i++) a[i] = 0;
        do {
            const float here = w[s * LANES + l];
            UNROLL_ALL for (int i = 0; i < count; i++) a[i] = fmaf(here, g[(s * count + i) * LANES + l], a[i]);
        } while (++s < n);
        UNROLL_ALL for (int i = 0; i < count; i++) sum[i][l] = a[i];
    }
}

/* Turns a, the coefficients of P_opt, into those of P with the gradients of the sectors. */
ALWAYS_INLINE void combine(int dim, int m, const struct fit *f, int batch, const struct scales *restrict scales,
                           double (*restrict a)[MAX_COEFFICIENT][LANES]) {
    const struct sectors *s = &f->sector;
    const int first = s->start[batch], sectors = s->start[batch + 1] - first;
    double I[LANES] = {0}, central[LANES], inverse[LANES];
    float mean[MAX_VAR * MAX_DIM][LANES];
    if (sectors == 0) return;
    for (int v = 0; v < m + 2; v++) {
        EACH_LANE inverse[l] = scales->inverse[v][l] * scales->inverse[v][l];
        add_smoothness(dim, a[v], inverse, I);
    }
    weigh(sectors, s->share + (long)first * LANES, I, s->weight, central);
    mean_gradients((m + 2) * dim, sectors, s->weight, s->gradient, mean);
    for (int v = 0; v < m + 2; v++) {
        for (int k = 0; k < dim + quadratics(dim); k++) EACH_LANE a[v][k][l] *= central[l];
        for (int k = 0; k < dim; k++)
            EACH_LANE a[v][k][l] = fma(scales->of[v][l], (double)mean[v * dim + k][l], a[v][k][l]);
    }
}

/* The coefficients of a cell stay in registers (add_near). */
ALWAYS_INLINE void quadratic_changes(int dim, const struct fit *f, int batch, int v, const struct bounds *restrict b,
                                     double (*restrict a)[LANES]) {
    const int first = f->point.start[batch], n = f->point.start[batch + 1] - first;
    ahead_ask(f);
    const double *restrict moment = f->moment.data + (long)batch * quadratics(dim) * LANES;
    const double *restrict x = f->point.data + (long)first * dim * LANES;
    double *restrict out = values_of(f, batch, v, first);
    EACH_ALONE
    EACH_LANE {
        const double least = b->low[l], most = b->high[l];
        const double low = fma(OVER, least - most, least), high = fma(OVER, most - least, most);
        double c[MAX_COEFFICIENT], mean = 0;
        long p = 0;
        UNROLL_ALL for (int k = 0; k < dim + quadratics(dim); k++) c[k] = a[k][l];
        UNROLL_ALL for (int k = 0; k < quadratics(dim); k++) mean = fma(c[dim + k], moment[k * LANES + l], mean);
        do {
            double sum = -mean;
            UNROLL_ALL for (int i = 0; i < dim; i++) {
                double slope = c[i];
                UNROLL_ALL for (int j = 0; j < dim; j++) if (j >= i) slope =
                    fma(c[product(dim, i, j)], x[(p * dim + j) * LANES + l], slope);
                sum = fma(slope, x[(p * dim + i) * LANES + l], sum);
            }
            out[p * LANES + l] = larger(smaller(sum, high), low);
        } while (++p < n);
    }
}

KERNEL static void curved_changes(int dim, const struct fit *f, int batch, int v, const struct bounds *restrict b,
                                  double (*restrict a)[LANES]) {
    if (dim == 1) quadratic_changes(1, f, batch, v, b, a);
    if (dim == 2) quadratic_changes(2, f, batch, v, b, a);
    if (dim == 3) quadratic_changes(3, f, batch, v, b, a);
}

KERNEL static void combine_sectors(int dim, int m, const struct fit *f, int batch, const struct scales *scales,
                                   double (*a)[MAX_COEFFICIENT][LANES]) {
    if (dim == 1 && m == 1) combine(1, 1, f, batch, scales, a);
    if (dim == 1 && m == 2) combine(1, 2, f, batch, scales, a);
    if (dim == 1 && m == 3) combine(1, 3, f, batch, scales, a);
    if (dim == 2 && m == 2) combine(2, 2, f, batch, scales, a);
    if (dim == 2 && m == 3) combine(2, 3, f, batch, scales, a);
    if (dim == 3) combine(3, 3, f, batch, scales, a);
}

ALWAYS_INLINE void cweno3(int dim, int m, struct fit *f, int batch, const double *const *U) {
    double a[MAX_VAR][MAX_COEFFICIENT][LANES];
    struct batch c;
    struct scales scales;
    find_changes(f, batch, U, &c);
    find_frame(m, c.own, &c.frame);
    move_changes(m, f, batch, &c);
    if (f->calm) find_uniform(m + 2, &c, f->calm->uniform + (long)batch * LANES);
    find_scales(m, &c, &scales);
    narrow_changes(m, f, batch, &scales);
    add_sectors(dim, m, f, batch);
    add_members(m, dim + quadratics(dim), f, batch, a);
    combine_sectors(dim, m, f, batch, &scales, a);
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
    calm_free(f->calm);
    f->calm = NULL;
}

void fit_keep(struct fit *f, double least, double most) {
    f->least = least;
    f->most = most;
}

void fit_cells(struct fit *f, int from, int to, const double *const *U) {
    if (!f->kind->cells || from >= to) return;
    for (int b = from / LANES; b <= (to - 1) / LANES; b++)
        if (!calm_batch(f, b, U)) {
            ahead_list(f, b + 1);
            f->kind->cells(f, b, U);
        }
}

KERNEL static void gather(int n, const int *restrict place, const double *restrict from, double *restrict to) {
    for (int i = 0; i < n; i++) to[i] = from[place[i]];
}
void fit_points(const struct fit *f, int side, int from, int n, const double *const *U, double *const *out) {
    for (int v = 0; v < f->nvar; v++)
        gather(n, f->place[side] + from, f->kind->cells ? f->value + v * f->nvalues : U[v], out[v]);
}
