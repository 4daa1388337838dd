/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the Poisson equation of the projection (solenoidal.h), -div grad p = div u on the open faces, by conjugate
 * gradients with Jacobi's preconditioner. */
#include "libcore/segregation/solenoidal.h"

#include "libcore/segregation/slab.h"

#include <stdlib.h>

/* Arrays of cells: p, the residual, the search direction, its image, the diagonal; one piece of memory at p. */
struct poisson {
    const struct face_flow *flow;
    long cells, stride[MAX_DIM];
    double *p, *residual, *way, *image, *diagonal;
    struct slab slab;
};

/* Does another rank have what lies beyond this end of the axis? */
static bool joined(const struct poisson *a, int k, bool high) {
    return k == a->flow->dim - 1 && (high ? a->slab.high : a->slab.low);
}
/* Are the first and the last faces of the axis one, and both on this rank? */
static bool wraps(const struct poisson *a, int k) {
    return a->flow->cyclic[k] && !joined(a, k, false);
}
/* Gets the outer layers of q from the ranks beside. */
static void swap(struct poisson *a, const double *q) {
    slab_swap(&a->slab, q, q + a->cells - a->stride[a->flow->dim - 1]);
}

/* Returns the number of runs of axis k: the cells within one outer index, whose faces along k are contiguous. */
static long runs(const struct poisson *a, int k) {
    return a->cells / (a->flow->n[k] * a->stride[k]);
}

static void divergence(const struct poisson *a, double *out) {
    const struct face_flow *l = a->flow;
    for (long c = 0; c < a->cells; c++) out[c] = 0;
    for (int k = 0; k < l->dim; k++) {
        const long across = a->stride[k], n = l->n[k] * across;
        for (long o = 0; o < runs(a, k); o++) {
            const double *low = l->u[k] + o * (n + across);
            for (long i = 0; i < n; i++) out[o * n + i] += (low[i + across] - low[i]) / l->width[k];
        }
    }
}

/* Adds to the outer layer at one end of the last axis what goes through the faces to the next rank. */
static void apply_joined(const struct poisson *a, bool high, const double *p, double *out) {
    const struct face_flow *l = a->flow;
    const int k = l->dim - 1;
    const long across = a->stride[k], cell = high ? a->cells - across : 0;
    const bool *open = l->open[k] + (high ? a->cells : 0);
    const double per = 1 / (l->width[k] * l->width[k]);
    for (long i = 0; i < across; i++) {
        const double below = !p ? 0 : high ? p[cell + i] : a->slab.below[i];
        const double above = !p ? 0 : high ? a->slab.above[i] : p[i];
        const double jump = !open[i] ? 0 : !p ? per : per * (below - above);
        out[cell + i] += p && !high ? -jump : jump;
    }
}

/* Computes out = -div(grad p on open faces), which shall become div u; with p NULL the diagonal of that operator. A
 * cell gets its terms axis by axis, that of the lower face first, but those of a seam last. */
static void apply(struct poisson *a, const double *p, double *out) {
    const struct face_flow *l = a->flow;
    const int last_axis = l->dim - 1;
    const bool seam = l->cyclic[last_axis] && a->slab.comm && comm_rank(a->slab.comm) == 0;
    if (p) swap(a, p);
    for (long c = 0; c < a->cells; c++) out[c] = 0;
    for (int k = 0; k < l->dim; k++) {
        const long across = a->stride[k], n = l->n[k] * across;
        const double per = 1 / (l->width[k] * l->width[k]);
        if (joined(a, k, false) && !seam) apply_joined(a, false, p, out);
        for (long o = 0; o < runs(a, k); o++) {
            const bool *open = l->open[k] + o * (n + across) + across;
            double *to = out + o * n;
            const double *from = p ? p + o * n : NULL;
            for (long i = 0; i < n - across; i++) {
                double jump = !open[i] ? 0 : !from ? per : per * (from[i] - from[i + across]);
                to[i] += jump;
                to[i + across] += from ? -jump : jump;
            }
            for (long i = 0, last = n - across; i < across && wraps(a, k); i++) {
                double jump = !open[i - across] ? 0 : !from ? per : per * (from[last + i] - from[i]);
                to[last + i] += jump;
                to[i] += from ? -jump : jump;
            }
        }
        if (joined(a, k, true)) apply_joined(a, true, p, out);
        if (joined(a, k, false) && seam) apply_joined(a, false, p, out);
    }
}

static double product(const struct poisson *a, const double *q, const double *r) {
    double sum = 0;
    slab_take_turn(&a->slab, &sum, 1);
    for (long i = 0; i < a->cells; i++) sum += q[i] * r[i];
    slab_end_turn(&a->slab, &sum, 1);
    return sum;
}
static double largest(const struct poisson *a, long n, const double *q) {
    double most = 0;
    for (long i = 0; i < n; i++) most = larger(fabs(q[i]), most);
    slab_max(&a->slab, &most, 1);
    return most;
}

/* Iterates p by conjugate gradients, scaled by the diagonal. The mean of p in each closed room is free and stays as it
 * is. */
static int solve(struct poisson *a, double enough) {
    const long n = a->cells;
    double rho = 0, before;
    int k = 0;
    for (; k < 20000 && largest(a, n, a->residual) > enough; k++) {
        for (long c = 0; c < n; c++) a->image[c] = a->diagonal[c] > 0 ? a->residual[c] / a->diagonal[c] : 0;
        before = rho;
        rho = product(a, a->residual, a->image);
        for (long c = 0; c < n; c++) a->way[c] = a->image[c] + (k ? rho / before : 0) * a->way[c];
        apply(a, a->way, a->image);
        double bend = product(a, a->way, a->image);
        if (!(bend > 0)) break;
        for (long c = 0; c < n; c++) {
            a->p[c] += rho / bend * a->way[c];
            a->residual[c] -= rho / bend * a->image[c];
        }
    }
    return k;
}

/* Adds grad p to u on the faces to the next rank at one end of the last axis; returns the largest change. */
static double take_gradient_joined(const struct poisson *a, bool high) {
    const struct face_flow *l = a->flow;
    const int k = l->dim - 1;
    const long across = a->stride[k], face = high ? a->cells : 0;
    const double *below = high ? a->p + a->cells - across : a->slab.below, *above = high ? a->slab.above : a->p;
    double most = 0;
    for (long i = 0; i < across; i++) {
        const double change = l->open[k][face + i] ? (above[i] - below[i]) / l->width[k] : 0;
        l->u[k][face + i] += change;
        most = larger(fabs(change), most);
    }
    return most;
}

/* Adds grad p to u on the open faces; returns the largest change. */
static double take_gradient(struct poisson *a) {
    const struct face_flow *l = a->flow;
    double most = 0;
    swap(a, a->p);
    for (int high = 0; high < 2; high++)
        if (joined(a, l->dim - 1, high)) most = larger(take_gradient_joined(a, high), most);
    for (int k = 0; k < l->dim; k++) {
        const long across = a->stride[k], n = l->n[k] * across;
        for (long o = 0; o < runs(a, k); o++) {
            const bool *open = l->open[k] + o * (n + across) + across;
            double *u = l->u[k] + o * (n + across) + across;
            for (long i = 0; i < n - across; i++) {
                double change = open[i] ? (a->p[o * n + i + across] - a->p[o * n + i]) / l->width[k] : 0;
                u[i] += change;
                most = larger(fabs(change), most);
            }
            for (long i = 0, last = n - across; i < across && wraps(a, k); i++) {
                const double *p = a->p + o * n;
                double change = open[i - across] ? (p[i] - p[last + i]) / l->width[k] : 0;
                u[i - across] = u[last + i] += change;
                most = larger(fabs(change), most);
            }
        }
    }
    slab_max(&a->slab, &most, 1);
    return most;
}

/* Scales the outflow through the boundary to equal the inflow. */
static status balance(const struct poisson *a, double *scaled) {
    const struct face_flow *l = a->flow;
    double through[2] = {0, 0}; /* in, out */
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < l->dim; k++) {
            const long across = a->stride[k], n = l->n[k] * across;
            if (!pass) slab_take_turn(&a->slab, through, 2);
            for (long o = 0; o < runs(a, k) && !l->cyclic[k]; o++)
                for (long i = 0; i < 2 * across; i++) {
                    const bool low = i < across;
                    if (joined(a, k, !low)) continue;
                    double *u = l->u[k] + o * (n + across) + (low ? i : n + i - across);
                    double leaving = (low ? -*u : *u) / l->width[k];
                    if (pass && leaving > 0)
                        *u *= *scaled;
                    else if (!pass)
                        through[leaving > 0] += fabs(leaving);
                }
            if (!pass) slab_end_turn(&a->slab, through, 2);
        }
        const double in = through[0], out = through[1];
        if (in == 0 && out == 0) return OK;
        if (!(in > 0 && out > 0))
            return fail(ERR_INPUT, "the flow %s the domain and never %s it", in > 0 ? "enters" : "leaves",
                        in > 0 ? "leaves" : "enters");
        *scaled = in / out;
    }
    return OK;
}

static status project(struct poisson *a, struct face_flow_change *change) {
    TRY(balance(a, &change->scaled));
    apply(a, NULL, a->diagonal);
    divergence(a, a->residual);
    change->before = largest(a, a->cells, a->residual);
    double speed = 0;
    for (int k = 0; k < a->flow->dim; k++) {
        long faces = a->cells / a->flow->n[k] * (a->flow->n[k] + 1);
        speed = larger(speed, largest(a, faces, a->flow->u[k]) / a->flow->width[k]);
    }
    change->iterations = solve(a, 1e-14 * speed);
    change->largest = take_gradient(a);
    divergence(a, a->residual);
    change->after = largest(a, a->cells, a->residual);
    if (change->after <= 1e-11 * speed) return OK;
    return fail(ERR_INPUT, "a part of the domain that walls close off has an inlet or an outlet");
}

status face_flow_project(struct face_flow *flow, struct face_flow_change *change) {
    struct poisson a = {.flow = flow, .cells = 1};
    *change = (struct face_flow_change){.scaled = 1};
    for (int k = 0; k < flow->dim; k++) {
        a.stride[k] = a.cells;
        a.cells *= flow->n[k];
    }
    status e = allocate(&a.p, 5 * a.cells, sizeof(double), "a flow's pressure");
    if (flow->comm) e = comm_agree(flow->comm, e);
    TRY(e);
    a.residual = a.p + a.cells;
    a.way = a.residual + a.cells;
    a.image = a.way + a.cells;
    a.diagonal = a.image + a.cells;
    e = slab_make(flow->comm, flow->cyclic[flow->dim - 1], a.stride[flow->dim - 1], &a.slab);
    if (!e) e = project(&a, change);
    slab_free(&a.slab);
    free(a.p);
    return e;
}
