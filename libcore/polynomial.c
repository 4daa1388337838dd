#include "libcore/polynomial_fit.h"

#define EACH_LANE for (int l = 0; l < LANES; l++)
static const double SMALL = 1e-6;   /* squared ratio of variation to value below which nothing is limited */
static const double EPSILON = 1e-4; /* of the weights of CWENO3: what varies by 1 % of the value a cell is smooth */
static const double OVER = 0.2;     /* what CWENO3 may leave the range of its stencil by, as a part of that range */
static const double TINY = 1e-100;  /* keeps 0/0 away */

ALWAYS_INLINE void own_values(const struct fit *f, int batch, const double *restrict q, double *restrict own) {
    int first = batch * LANES, n = f->mosaic->nnear - first < LANES ? f->mosaic->nnear - first : LANES;
    memcpy(own, q + first, (size_t)n * sizeof *own);
    for (int l = n; l < LANES; l++) own[l] = q[first];
}
ALWAYS_INLINE void differences(const int *restrict cell, const double *restrict q, const double *restrict own,
                               double *restrict d) {
    EACH_LANE d[l] = q[cell[l]] - own[l];
}

struct bounds {
    double low[LANES], high[LANES]; /* less the cell's value */
};
ALWAYS_INLINE void extend(struct bounds *restrict b, const double *restrict d) {
    EACH_LANE {
        b->low[l] = smaller(d[l], b->low[l]);
        b->high[l] = larger(d[l], b->high[l]);
    }
}

/* Gradient by least squares, weights 1/distance^2, times the limiter of Barth & Jespersen (AIAA 89-0366, 1989): values
 * halfway to first-ring members stay within the values of the stencil, and face values are cut to these bounds one by
 * one, too. On a linear field the bounds are twice as far away as the values halfway, whatever the mesh: the more room
 * there is, the less is cut. Where the stencil varies by less than 1e-3 of the value nothing acts, and it fades in to
 * sqrt(2) times that: smooth extrema keep their order (the switch of Michalak & Ollivier-Gooch, J. Comput. Phys. 228,
 * 2009, made independent of units). */
ALWAYS_INLINE void limit(int dim, const struct rows *halfway, int batch, const double *restrict own,
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
        double low = b->low[l], high = b->high[l], range = high - low, small = SMALL * own[l] * own[l];
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

ALWAYS_INLINE void linear(int dim, const struct fit *f, int batch, const double *restrict q, double *restrict value) {
    double own[LANES], d[LANES], a[MAX_DIM][LANES] = {{0}};
    struct bounds b = {.low = {0}};
    own_values(f, batch, q, own);
    for (int j = f->member.start[batch]; j < f->member.start[batch + 1]; j++) {
        const double *w = f->member.data + (long)j * dim * LANES;
        differences(f->member.cell + (long)j * LANES, q, own, d);
        extend(&b, d);
        for (int k = 0; k < dim; k++) EACH_LANE a[k][l] = fma(w[k * LANES + l], d[l], a[k][l]);
    }
    limit(dim, &f->halfway, batch, own, &b, a);
    for (int j = f->point.start[batch]; j < f->point.start[batch + 1]; j++) {
        const double *x = f->point.data + (long)j * dim * LANES;
        double *out = value + (long)j * LANES;
        EACH_LANE {
            double change = 0;
            for (int k = 0; k < dim; k++) change += x[k * LANES + l] * a[k][l];
            out[l] = own[l] + larger(smaller(change, b.high[l]), b.low[l]);
        }
    }
}

/* CWENO of Levy, Puppo & Russo (SIAM J. Sci. Comput. 22, 2000) with the quadratic of the whole stencil as the optimal
 * polynomial P_opt and linear ones, one per sector, as in Dumbser, Boscheri, Semplice & Russo (SIAM J. Sci. Comput. 39,
 * 2017):
 *   P = w_0/d_0 (P_opt - sum d_s P_s) + sum w_s P_s,   w_s ~ d_s (1 + (tau/(I_s + epsilon))^2)
 * with the Z weights of Cravero, Semplice & Visconti (SIAM J. Numer. Anal. 57, 2019): I = sum over the derivatives of
 * the mean over the cell (taken as a cube) of their square, epsilon = 1e-4 times the squared largest value of the
 * stencil, so that units do not matter: a smooth wave keeps the quadratic alone from 30 cells a length on, and a strong
 * shock is free of undershoots, which no linear weight gave at once; tau = mean |I_s - I_opt|, which is large wherever
 * one sector is smooth and another is not, while a difference of means cancels at some jumps. The bounds count where no
 * sector is smooth: in wedges at a wall. */
ALWAYS_INLINE int quadratics(int dim) {
    return dim * (dim + 1) / 2;
}
ALWAYS_INLINE int product(int dim, int i, int j) { /* of coordinates i <= j, among the coefficients */
    return dim + i * dim - i * (i - 1) / 2 + j - i;
}

/* Gradients g[s][k] of the sectors. */
ALWAYS_INLINE void sector_gradients(int dim, const struct fit *f, int batch, int sectors, const double *restrict q,
                                    const double *restrict own, double (*restrict g)[LANES]) {
    double d[LANES];
    int j = f->sector.start[batch];
    for (int s = 0; s < sectors; s++, g += dim) {
        for (int k = 0; k < dim; k++) EACH_LANE g[k][l] = 0;
        for (int m = 0; m < f->sector_members[batch]; m++, j++) {
            const double *w = f->sector.data + (long)j * dim * LANES;
            differences(f->sector.cell + (long)j * LANES, q, own, d);
            for (int k = 0; k < dim; k++) EACH_LANE g[k][l] = fma(w[k * LANES + l], d[l], g[k][l]);
        }
    }
}

/* Smoothness of the quadratic a: |gradient|^2 + (1 + 1/12) |second derivatives|^2. */
ALWAYS_INLINE void smoothness(int dim, double (*restrict a)[LANES], double *restrict I) {
    EACH_LANE {
        double first = 0, second = 0;
        for (int k = 0; k < dim; k++) first += a[k][l] * a[k][l];
        for (int i = 0; i < dim; i++) /* from 0, or compilers do not unroll these loops, which would cost vectors */
            for (int j = 0; j < dim; j++)
                if (j >= i) second += (i == j ? 4. : 2.) * (a[product(dim, i, j)][l] * a[product(dim, i, j)][l]);
        I[l] = fma(13. / 12, second, first);
    }
}

/* Nonlinear weights: w_0/d_0 in `central`, w_s - d_s w_0/d_0 in w. */
ALWAYS_INLINE void weigh(int dim, const double *restrict share, int sectors, const double *restrict own,
                         const struct bounds *restrict b, const double *restrict I, double (*restrict g)[LANES],
                         double (*restrict w)[LANES], double *restrict central) {
    double tau[LANES] = {0}, shares[LANES] = {0}, sum[LANES], epsilon[LANES];
    for (int s = 0; s < sectors; s++, share += LANES) EACH_LANE {
            w[s][l] = 0;
            for (int k = 0; k < dim; k++) w[s][l] += g[s * dim + k][l] * g[s * dim + k][l];
            tau[l] = fma(share[l], fabs(w[s][l] - I[l]), tau[l]);
            shares[l] += share[l];
        }
    share -= sectors * LANES;
    EACH_LANE {
        double most = larger(fabs(own[l] + b->low[l]), fabs(own[l] + b->high[l]));
        epsilon[l] = fma(EPSILON * most, most, TINY);
        tau[l] /= larger(shares[l], TINY);
        double ratio = tau[l] / (I[l] + epsilon[l]);
        central[l] = fma(ratio, ratio, 1);
        sum[l] = (1 - shares[l]) * central[l];
    }
    for (int s = 0; s < sectors; s++) EACH_LANE {
            double ratio = tau[l] / (w[s][l] + epsilon[l]);
            w[s][l] = share[s * LANES + l] * fma(ratio, ratio, 1);
            sum[l] += w[s][l];
        }
    EACH_LANE {
        sum[l] = 1 / sum[l];
        central[l] *= sum[l];
    }
    for (int s = 0; s < sectors; s++) EACH_LANE w[s][l] = fma(w[s][l], sum[l], -central[l] * share[s * LANES + l]);
}

/* a <- the coefficients of P, from those of P_opt and the gradients g of the sectors; w: room for their weights. */
ALWAYS_INLINE void combine(int dim, const double *restrict share, int sectors, const double *restrict own,
                           const struct bounds *restrict b, double (*restrict g)[LANES], double (*restrict w)[LANES],
                           double (*restrict a)[LANES]) {
    double I[LANES], central[LANES];
    smoothness(dim, a, I);
    weigh(dim, share, sectors, own, b, I, g, w, central);
    for (int k = 0; k < dim + quadratics(dim); k++) EACH_LANE a[k][l] *= central[l];
    for (int s = 0; s < sectors; s++)
        for (int k = 0; k < dim; k++) EACH_LANE a[k][l] = fma(w[s][l], g[s * dim + k][l], a[k][l]);
}

ALWAYS_INLINE void quadratic_values(int dim, const struct fit *f, int batch, const double *restrict own,
                                    const struct bounds *restrict b, double (*restrict a)[LANES],
                                    double *restrict value) {
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
        double *restrict out = value + (long)p * LANES;
        EACH_LANE {
            double sum = base[l];
            for (int i = 0; i < dim; i++) {
                double slope = a[i][l];
                for (int j = 0; j < dim; j++)
                    if (j >= i) slope = fma(a[product(dim, i, j)][l], x[j * LANES + l], slope);
                sum = fma(slope, x[i * LANES + l], sum);
            }
            out[l] = own[l] + larger(smaller(sum, high[l]), low[l]);
        }
    }
}

ALWAYS_INLINE void cweno3(int dim, const struct fit *f, int batch, const double *restrict q, double *restrict value) {
    const int n = dim + quadratics(dim), sectors = f->share.start[batch + 1] - f->share.start[batch];
    double own[LANES], d[LANES], a[MAX_COEFFICIENT][LANES] = {{0}};
    double(*gradient)[LANES] = (double(*)[LANES])f->gradient, (*weight)[LANES] = (double(*)[LANES])f->weight;
    struct bounds b = {.low = {0}};
    own_values(f, batch, q, own);
    for (int j = f->member.start[batch]; j < f->member.start[batch + 1]; j++) {
        const double *w = f->member.data + (long)j * n * LANES;
        differences(f->member.cell + (long)j * LANES, q, own, d);
        extend(&b, d);
        for (int k = 0; k < n; k++) EACH_LANE a[k][l] = fma(w[k * LANES + l], d[l], a[k][l]);
    }
    sector_gradients(dim, f, batch, sectors, q, own, gradient);
    combine(dim, f->share.data + (long)f->share.start[batch] * LANES, sectors, own, &b, gradient, weight, a);
    quadratic_values(dim, f, batch, own, &b, a, value);
}

#define CELLS(kind)                                                                                                    \
    KERNEL static void kind##_cells(struct fit *f, int batch, const double *const *U) {                                \
        for (int v = 0; v < f->nvar; v++) {                                                                            \
            if (f->mosaic->dim == 1) kind(1, f, batch, U[v], f->value + v * f->nvalues);                               \
            if (f->mosaic->dim == 2) kind(2, f, batch, U[v], f->value + v * f->nvalues);                               \
            if (f->mosaic->dim == 3) kind(3, f, batch, U[v], f->value + v * f->nvalues);                               \
        }                                                                                                              \
    }
CELLS(linear)
CELLS(cweno3)

const struct polynomial polynomial_table[] = {
    {"firstOrder", "the cell's value", 1, 0, NULL},
    {"linear", "second order: least-squares gradients, limited (Barth & Jespersen 1989)", 1, 1, linear_cells},
    {"CWENO3",
     "third order on smooth flow: a quadratic, near shocks linear polynomials of sectors "
     "(Levy, Puppo & Russo 2000; Dumbser et al. 2017)",
     2, 2, cweno3_cells},
};
const int polynomial_count = sizeof polynomial_table / sizeof *polynomial_table;

const struct polynomial *polynomial_find(const char *name) {
    for (int i = 0; i < polynomial_count; i++)
        if (!strcmp(name, polynomial_table[i].name)) return &polynomial_table[i];
    return NULL;
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
