/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uniform gas on polyhedra (docs/physics.md 6.13): fits note which cells have uniform stencils, and do no work for
 * batches of such cells (polynomial.h). Which these are is found before, by labels: cells that equal one of a few
 * states, bit by bit, share its label. The states are those of whole groups of LANES cells that are equal. Where gas is
 * disturbed, there is none, and the search costs one comparison a group. */
#include "libcore/schemes/polynomial_fit.h"

#include <stdlib.h>

enum { VARIED = LABELS }; /* the label of all other cells */

status fit_watch(struct fit *f, bool skip) {
    const struct polyhedra *m = f->polyhedra;
    const long near = (long)f->nbatches * LANES;
    struct calm *c;
    if (!f->kind->cells) return OK;
    TRY(allocate(&f->calm, 1, sizeof *f->calm, "uniform cells"));
    c = f->calm;
    TRY(allocate(&c->uniform, near, sizeof *c->uniform, "uniform cells"));
    if (!skip) return OK;
    TRY(allocate(&c->label, m->size, sizeof *c->label, "uniform cells"));
    TRY(allocate(&c->known, near, sizeof *c->known, "uniform cells"));
    return allocate(&c->still, near, sizeof *c->still, "uniform cells");
}

void calm_free(struct calm *c) {
    if (!c) return;
    free(c->uniform);
    free(c->label);
    free(c->known);
    free(c->still);
    free(c);
}

KERNEL static bool all_equal(int n, double first, const double *restrict q) {
    int differs = 0;
    for (int i = 0; i < n; i++) differs |= q[i] != first;
    return !differs;
}
static bool is_state(int nvar, const double *const *U, int at, int n, const double *state) {
    for (int v = 0; v < nvar; v++)
        if (!all_equal(n, state[v], U[v] + at)) return false;
    return true;
}

/* Lists the states of whole groups; returns their number. */
static int find_states(const struct fit *f, const double *const *U, double (*state)[MAX_VAR]) {
    int n = 0;
    for (int at = 0; at + LANES <= f->polyhedra->nown && n < LABELS; at += LANES) {
        bool listed = false;
        for (int v = 0; v < f->nvar; v++) state[n][v] = U[v][at];
        if (!is_state(f->nvar, U, at, LANES, state[n])) continue;
        for (int k = 0; k < n && !listed; k++) listed = is_state(f->nvar, U, at, 1, state[k]);
        n += !listed;
    }
    return n;
}

KERNEL static void mark_others(int n, const double *restrict q, double state, unsigned char *restrict other) {
    for (int i = 0; i < n; i++) other[i] |= q[i] != state;
}
KERNEL static void label_others(int n, unsigned char k, const unsigned char *restrict other,
                                unsigned char *restrict label) {
    for (int i = 0; i < n; i++) label[i] = other[i] ? label[i] : k;
}
/* Labels cells, ghosts or mirrors from <= i < to. */
static void label_cells(const struct fit *f, const double *const *U, int from, int to) {
    struct calm *c = f->calm;
    memset(c->label + from, VARIED, (size_t)(to - from));
    for (int k = 0; k < c->n; k++)
        for (int at = from, n; at < to; at += n) {
            unsigned char other[BATCH] = {0};
            n = to - at < BATCH ? to - at : BATCH;
            for (int v = 0; v < f->nvar; v++) mark_others(n, U[v] + at, c->state[k][v], other);
            label_others(n, (unsigned char)k, other, c->label + at);
        }
}

static bool has_uniform_stencil(const struct polyhedra *m, const unsigned char *label, int i) {
    const int own = label[i];
    if (own == VARIED) return false;
    for (int j = m->stencil_start[i]; j < m->stencil_start[i + 1]; j++)
        if (label[m->stencil[j]] != own) return false;
    return true;
}
/* Is an own cell known to be uniform, as are those across its faces? */
static bool stays_uniform(const struct polyhedra *m, const unsigned char *known, int i) {
    if (!known[i]) return false;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int face = m->face_of_cell[j], across = face < 0 ? m->face.left[~face] : m->face.right[face];
        if (across < m->nnear && !known[across]) return false;
    }
    return true;
}
static void find_known(const struct fit *f, int from, int to) {
    const struct polyhedra *m = f->polyhedra;
    struct calm *c = f->calm;
    for (int i = from; i < to; i++) c->known[i] = has_uniform_stencil(m, c->label, i);
    for (int i = from; i < to; i++) c->still[i] = i < m->nown ? stays_uniform(m, c->known, i) : c->known[i];
}

void fit_look(struct fit *f, const double *const *U, bool all) {
    const struct polyhedra *m = f->polyhedra;
    const int mirrors = m->ncells + m->face.n - m->face.ninternal;
    struct calm *c = f->calm;
    if (!c || !c->label) return;
    if (!all) {
        c->n = U ? find_states(f, U, c->state) : 0;
        if (c->n == 0) return;
        label_cells(f, U, 0, m->nown);
        label_cells(f, U, m->ncells, mirrors);
        memset(c->known + m->ninner, 0, (size_t)(f->nbatches * LANES - m->ninner));
        memset(c->still + m->ninner, 0, (size_t)(f->nbatches * LANES - m->ninner));
        find_known(f, 0, m->ninner);
    } else if (c->n > 0) {
        label_cells(f, U, m->nown, m->ncells);
        label_cells(f, U, mirrors, m->size);
        find_known(f, m->ninner, m->nnear);
    }
}

void fit_spare(struct fit *f, const unsigned char *spared) {
    f->spared = spared;
}

bool calm_batch(const struct fit *f, int batch, const double *const *U) {
    const struct calm *c = f->calm;
    const int first = batch * LANES, left = f->polyhedra->nnear - first;
    const long n = (long)(f->point.start[batch + 1] - f->point.start[batch]) * LANES;
    const size_t cells = (size_t)(left < LANES ? left : LANES);
    const bool uniform = c && c->n > 0 && !memchr(c->known + first, 0, cells);
    if (!uniform && (!f->spared || memchr(f->spared + first, 0, cells))) return false;
    for (int v = 0; v < f->nvar; v++) {
        double *restrict value = f->value + v * f->nvalues + (long)f->slot[batch] * LANES;
        double own[LANES];
        for (int l = 0; l < LANES; l++) own[l] = U[v][first + (l < left ? l : 0)] + 0;
        for (long i = 0; i < n; i += LANES)
            for (int l = 0; l < LANES; l++) value[i + l] = own[l];
    }
    if (c) memset(c->uniform + first, uniform, LANES);
    return true;
}

const unsigned char *fit_uniform(const struct fit *f) {
    return f->calm ? f->calm->uniform : NULL;
}
const unsigned char *fit_still(const struct fit *f) {
    return f->calm && f->calm->n > 0 ? f->calm->still : NULL;
}
