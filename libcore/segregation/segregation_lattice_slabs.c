/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tridiagonal systems of segregation on a lattice along its last axis, whose lines go through several ranks: batch
 * after batch the elimination runs from rank to rank and back, so that a rank works on one batch while those behind it
 * work on the batches before (segregation_lattice.c has the same on one rank). */
#include "libcore/segregation/segregation_lattice_private.h"

/* What stands in arrays that are free meanwhile: [faces] the Jacobian to the cells below and above, [cells] the
 * eliminated matrix, and the solution that closes cyclic lines (Sherman & Morrison). */
struct slab_sweep {
    struct segregation_field *s;
    const struct comm *comm;
    double part; /* late dt / width */
    bool cyclic;
    int k, rank, ranks;
    long n, across, first; /* layers; lines; first line of the batch */
    size_t bytes;          /* of a batch's values in a layer */
    double *up, *down, *above, *seam;
};

static void load(const struct slab_sweep *w, long n, const double *from, double *to) {
    for (long i = 0; i < n; i++) memcpy(to + i * LINES, from + i * w->across + w->first, w->bytes);
}
static void store(const struct slab_sweep *w, long n, const double *from, double *to) {
    for (long i = 0; i < n; i++) memcpy(to + i * w->across + w->first, from + i * LINES, w->bytes);
}

/* Sets the Jacobian on all faces, 0 towards cells that are not there. */
static void assemble(const struct slab_sweep *w, const double *phi) {
    const struct segregation_field *s = w->s;
    const struct segregation_lattice *l = &s->lattice;
    const double *u = l->u[w->k], *f = l->f[w->k], *D = l->D[w->k], per = 1 / l->width[w->k];
    const long across = w->across, end = w->n * across;
    segregation_assemble(end - across, per,
                         &(struct jacobian_lines){phi, phi + across, u + across, f + across, D + across, w->up + across,
                                                  w->down + across});
    if (s->slab.low)
        segregation_assemble(across, per, &(struct jacobian_lines){s->slab.below, phi, u, f, D, w->up, w->down});
    if (s->slab.high)
        segregation_assemble(across, per,
                             &(struct jacobian_lines){phi + end - across, s->slab.above, u + end, f + end, D + end,
                                                      w->up + end, w->down + end});
    for (long i = 0; i < across && !s->slab.low; i++) {
        w->up[i] = 0;
        w->down[i] = segregation_edge(s, w->k, false, i, phi[i]).slope;
    }
    for (long i = 0; i < across && !s->slab.high; i++) {
        w->up[end + i] = segregation_edge(s, w->k, true, end + i, phi[end - across + i]).slope;
        w->down[end + i] = 0;
    }
}

/* Returns what stands in the corner of a cyclic matrix, for a line of rank 0, and the first entry of its seam. */
static double corner_of(const struct slab_sweep *w, long line, double *shift) {
    const double first = w->part * w->s->ease[line];
    *shift = -(1 + first * (w->up[w->across + line] - w->down[line]));
    return -first * w->up[line] / *shift;
}

/* Begins the seam of cyclic lines on rank 0 and ends it on the last rank, and takes its share off the matrix. */
static void set_seam(const struct slab_sweep *w, double *corner, double *up, double *down) {
    double *seam = w->s->line_seam;
    const double *ease = w->s->line_ease;
    const long last = (w->n - 1) * LINES, count = (long)(w->bytes / sizeof *corner);
    memset(seam, 0, (size_t)w->n * LINES * sizeof *seam);
    for (long c = 0; c < count && w->rank == 0; c++) {
        const double first = w->part * ease[c];
        corner[c] = corner_of(w, w->first + c, &seam[c]);
        down[c] += first > 0 ? seam[c] / first : 0;
    }
    for (long c = 0; c < count && w->rank == w->ranks - 1; c++) {
        const double end = w->part * ease[last + c], far = end * down[last + LINES + c];
        seam[last + c] = far;
        up[last + LINES + c] -= end > 0 ? far * corner[c] / end : 0;
    }
}

/* Eliminates a batch from the first layer to the last. A message holds `above` and `right` of the layer before, and of
 * cyclic lines again `above`, the seam and the corner. */
static void go_up(const struct slab_sweep *w) {
    struct segregation_field *s = w->s;
    double message[5 * LINES] = {0}, *corner = message + 4 * LINES, *right = s->line_right, *up = s->line_up;
    double *above = s->line_above, *down = s->line_down;
    const long last = (w->n - 1) * LINES, size = (w->cyclic ? 5 : 2) * LINES;
    const double *before = w->rank > 0 ? message : NULL;
    load(w, w->n, s->change, right);
    load(w, w->n, s->ease, s->line_ease);
    load(w, w->n + 1, w->up, up);
    load(w, w->n + 1, w->down, down);
    if (before) comm_get(w->comm, w->rank - 1, message, size);
    if (w->cyclic) set_seam(w, corner, up, down);
    segregation_forward(w->n, w->part, s->line_ease, up, down, before, above, right);
    if (w->cyclic)
        segregation_forward(w->n, w->part, s->line_ease, up, down, before ? message + 2 * LINES : NULL, above,
                            s->line_seam);
    for (int half = 0; half < 2; half++) {
        memcpy(message + 2 * half * LINES, above + last, LINES * sizeof *message);
        memcpy(message + (2 * half + 1) * LINES, (half ? s->line_seam : right) + last, LINES * sizeof *message);
    }
    if (w->rank < w->ranks - 1) comm_put(w->comm, w->rank + 1, message, size);
    store(w, w->n, right, s->change);
    store(w, w->n, above, w->above);
    if (w->cyclic) store(w, w->n, s->line_seam, w->seam);
}

/* Solves a batch from the last layer to the first. A message holds the solution in the layer behind, and of cyclic
 * lines the seam there, and both in the last layer of all. On rank 0 `factor` becomes the share of the seam that closes
 * the line. */
static void go_down(const struct slab_sweep *w, double *factor) {
    struct segregation_field *s = w->s;
    double message[4 * LINES] = {0}, *right = s->line_right, *seam = s->line_seam;
    const long last = (w->n - 1) * LINES, size = (w->cyclic ? 4 : 1) * LINES;
    const bool at_end = w->rank == w->ranks - 1;
    load(w, w->n, s->change, right);
    load(w, w->n, w->above, s->line_above);
    if (w->cyclic) load(w, w->n, w->seam, seam);
    if (!at_end) comm_get(w->comm, w->rank + 1, message, size);
    segregation_backward(w->n, s->line_above, at_end ? NULL : message, right);
    if (w->cyclic) segregation_backward(w->n, s->line_above, at_end ? NULL : message + LINES, seam);
    for (int half = 0; half < 2; half++) {
        memcpy(message + half * LINES, half ? seam : right, LINES * sizeof *message);
        if (at_end) memcpy(message + (2 + half) * LINES, (half ? seam : right) + last, LINES * sizeof *message);
    }
    if (w->rank > 0) comm_put(w->comm, w->rank - 1, message, size);
    store(w, w->n, right, s->change);
    if (!w->cyclic) return;
    store(w, w->n, seam, w->seam);
    for (long c = 0; w->rank == 0 && c < (long)(w->bytes / sizeof *right); c++) {
        double shift;
        const double corner = corner_of(w, w->first + c, &shift);
        factor[w->first + c] =
            (right[c] + corner * message[2 * LINES + c]) / (1 + seam[c] + corner * message[3 * LINES + c]);
    }
}

KERNEL static void take_seam(long n, const double *restrict factor, const double *restrict seam,
                             double *restrict change) {
    for (long i = 0; i < n; i++) change[i] -= factor[i] * seam[i];
}
KERNEL static void add_implicit_flux(long n, double late, const double *restrict up, const double *restrict down,
                                     const double *restrict below, const double *restrict above,
                                     double *restrict flux) {
    for (long i = 0; i < n; i++) flux[i] += late * (up[i] * below[i] + down[i] * above[i]);
}

static void add_fluxes(const struct slab_sweep *w, double late) {
    struct segregation_field *s = w->s;
    const long across = w->across, end = w->n * across;
    double *change = s->change, *flux = s->flux[w->k];
    slab_swap(&s->slab, change, change + end - across);
    add_implicit_flux(end - across, late, w->up + across, w->down + across, change, change + across, flux + across);
    add_implicit_flux(across, late, w->up, w->down, s->slab.below, change, flux);
    add_implicit_flux(across, late, w->up + end, w->down + end, change + end - across, s->slab.above, flux + end);
}

static void take_batch(struct slab_sweep *w, long first) {
    const long left = w->across - first;
    w->first = first;
    w->bytes = (size_t)(left < LINES ? left : LINES) * sizeof(double);
}

void segregation_solve_slabs(struct segregation_field *s, double dt, double late, const double *phi) {
    const int k = s->lattice.dim - 1;
    struct slab_sweep w = {.s = s,
                           .comm = s->slab.comm,
                           .part = late * dt / s->lattice.width[k],
                           .cyclic = s->lattice.cyclic[k],
                           .k = k,
                           .rank = comm_rank(s->slab.comm),
                           .ranks = comm_size(s->slab.comm),
                           .n = s->lattice.n[k],
                           .across = s->stride[k],
                           .up = s->part[k],
                           .down = s->low_flux[k],
                           .above = s->low,
                           .seam = s->next};
    double *factor = s->low_slab.first; /* [across], free until the next swap */
    assemble(&w, phi);
    for (long first = 0; first < w.across; first += LINES) {
        take_batch(&w, first);
        go_up(&w);
    }
    for (long first = 0; first < w.across; first += LINES) {
        take_batch(&w, first);
        go_down(&w, factor);
    }
    if (w.cyclic) {
        comm_broadcast(w.comm, factor, w.across * (long)sizeof *factor);
        for (long i = 0; i < w.n; i++) take_seam(w.across, factor, w.seam + i * w.across, s->change + i * w.across);
    }
    add_fluxes(&w, late);
}
