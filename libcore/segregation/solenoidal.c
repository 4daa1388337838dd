/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the Poisson equation of the projection (solenoidal.h), -div grad p = div u on the open faces, by conjugate
 * gradients with Jacobi's preconditioner. */
#include "libcore/segregation/solenoidal.h"

#include <stdlib.h>

/* Arrays of cells: p, the residual, the search direction, its image, the diagonal; one piece of memory at p. */
struct poisson {
    const struct face_flow *flow;
    long cells, stride[MAX_DIM];
    double *p, *rest, *way, *image, *diagonal;
};

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

/* Computes out = -div(grad p on open faces), which shall become div u; with p NULL the diagonal of that operator. */
static void apply(const struct poisson *a, const double *p, double *out) {
    const struct face_flow *l = a->flow;
    for (long c = 0; c < a->cells; c++) out[c] = 0;
    for (int k = 0; k < l->dim; k++) {
        const long across = a->stride[k], n = l->n[k] * across;
        const double per = 1 / (l->width[k] * l->width[k]);
        for (long o = 0; o < runs(a, k); o++) {
            const bool *open = l->open[k] + o * (n + across) + across;
            double *to = out + o * n;
            const double *from = p ? p + o * n : NULL;
            for (long i = 0; i < n - across; i++) {
                double jump = !open[i] ? 0 : !from ? per : per * (from[i] - from[i + across]);
                to[i] += jump;
                to[i + across] += from ? -jump : jump;
            }
            for (long i = 0, last = n - across; i < across && l->cyclic[k]; i++) {
                double jump = !open[i - across] ? 0 : !from ? per : per * (from[last + i] - from[i]);
                to[last + i] += jump;
                to[i] += from ? -jump : jump;
            }
        }
    }
}

static double product(long n, const double *a, const double *b) {
    double sum = 0;
    for (long i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}
static double largest(long n, const double *a) {
    double most = 0;
    for (long i = 0; i < n; i++) most = larger(fabs(a[i]), most);
    return most;
}

/* Iterates p by conjugate gradients, scaled by the diagonal. The mean of p in each closed room is free and stays as it
 * is. */
static int solve(struct poisson *a, double enough) {
    const long n = a->cells;
    double rho = 0, before;
    int k = 0;
    for (; k < 20000 && largest(n, a->rest) > enough; k++) {
        for (long c = 0; c < n; c++) a->image[c] = a->diagonal[c] > 0 ? a->rest[c] / a->diagonal[c] : 0;
        before = rho;
        rho = product(n, a->rest, a->image);
        for (long c = 0; c < n; c++) a->way[c] = a->image[c] + (k ? rho / before : 0) * a->way[c];
        apply(a, a->way, a->image);
        double bend = product(n, a->way, a->image);
        if (!(bend > 0)) break;
        for (long c = 0; c < n; c++) {
            a->p[c] += rho / bend * a->way[c];
            a->rest[c] -= rho / bend * a->image[c];
        }
    }
    return k;
}

/* Adds grad p to u on the open faces; returns the largest change. */
static double take_gradient(const struct poisson *a) {
    const struct face_flow *l = a->flow;
    double most = 0;
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
            for (long i = 0, last = n - across; i < across && l->cyclic[k]; i++) {
                const double *p = a->p + o * n;
                double change = open[i - across] ? (p[i] - p[last + i]) / l->width[k] : 0;
                u[i - across] = u[last + i] += change;
                most = larger(fabs(change), most);
            }
        }
    }
    return most;
}

/* Scales the outflow through the boundary to equal the inflow. */
static status balance(const struct poisson *a, double *scaled) {
    const struct face_flow *l = a->flow;
    double in = 0, out = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < l->dim; k++) {
            const long across = a->stride[k], n = l->n[k] * across;
            for (long o = 0; o < runs(a, k) && !l->cyclic[k]; o++)
                for (long i = 0; i < 2 * across; i++) {
                    const bool low = i < across;
                    double *u = l->u[k] + o * (n + across) + (low ? i : n + i - across);
                    double leaving = (low ? -*u : *u) / l->width[k];
                    if (pass && leaving > 0)
                        *u *= *scaled;
                    else if (!pass)
                        *(leaving > 0 ? &out : &in) += fabs(leaving);
                }
        }
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
    divergence(a, a->rest);
    change->before = largest(a->cells, a->rest);
    double speed = 0;
    for (int k = 0; k < a->flow->dim; k++) {
        long faces = a->cells / a->flow->n[k] * (a->flow->n[k] + 1);
        speed = larger(speed, largest(faces, a->flow->u[k]) / a->flow->width[k]);
    }
    change->iterations = solve(a, 1e-14 * speed);
    change->largest = take_gradient(a);
    divergence(a, a->rest);
    change->after = largest(a->cells, a->rest);
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
    TRY(allocate(&a.p, 5 * a.cells, sizeof(double), "a flow's pressure"));
    a.rest = a.p + a.cells;
    a.way = a.rest + a.cells;
    a.image = a.way + a.cells;
    a.diagonal = a.image + a.cells;
    status e = project(&a, change);
    free(a.p);
    return e;
}
