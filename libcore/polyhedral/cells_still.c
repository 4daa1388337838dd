/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uniform gas on polyhedra stays uniform to the bit, and costs little (docs/physics.md 6.13). The fluxes of a uniform
 * cell sum to round-off, as areas times normals do, and that noise would spread by three cells a stage. So a stage
 * changes nothing where the stencils of a cell and of those across its faces are uniform, nor where it changes less
 * than the round-off of its fluxes. Both are decided cell by cell, so that no bit depends on ranks. What fits know to
 * be so beforehand (libcore/schemes/polynomial_calm.c) is left out: faces, sums, and updates but for sources. */
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

/* Of density, of energy, and of momentum in units of sqrt(2 rho E): fluxes through some four faces, each with the
 * round-off of its own. */
static const double NOTHING = 0x1p-51;

struct cells_still {
    int (*across)[BATCH]; /* as the faces of chunks: places in fit_uniform of the cells across; those that count as
                           * uniform there (mirrors: the stencil has them, no face) lead to the cell itself */
};

/* Uniform gas of round bodies is pushed along the radius; transport has fluxes of its own, as beds have (is_on);
 * patches that feed give mass, not a state. Gravity is a source. Local steps have one fit for many updates. */
static bool is_wanted(const struct gas *g) {
    return !g->models.transport && !needs_shear_rate(&g->models) && !g->cells->round && !g->patches.fed &&
           !g->models.stepper->local && g->models.polynomial->degree > 0;
}

status cells_still_make(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    const int *start = c->sides.start, chunks = (m->nown + BATCH - 1) / BATCH;
    if (!is_wanted(g)) return OK;
    TRY(fit_watch(c->fit, g->models.skip_uniform && !g->models.ncarried));
    TRY(allocate(&c->still, 1, sizeof *c->still, "uniform cells"));
    TRY(allocate(&c->still->across, start[chunks], sizeof *c->still->across, "uniform cells"));
    for (int chunk = 0; chunk < chunks; chunk++)
        for (int j = start[chunk]; j < start[chunk + 1]; j++)
            for (int i = 0; i < BATCH; i++) {
                const int cell = chunk * BATCH + i, face = c->sides.face[(long)j * BATCH + i];
                const int other = face < 0 ? m->face.left[~face] : face < m->face.n ? m->face.right[face] : m->size;
                c->still->across[j][i] = other < m->nnear ? other : cell < m->nown ? cell : 0;
            }
    return OK;
}

/* Steps with a bed are left alone; all others have the same bits, whether a bed is looked for or not. */
static bool is_on(const struct gas *g) {
    return g->cells->still && !g->cells->rest && !g->step.hybrid;
}

void cells_still_look(struct gas *g, const double *const *U, bool all) {
    fit_look(g->cells->fit, is_on(g) ? U : NULL, all);
}

void cells_still_free(struct cells_still *s) {
    if (!s) return;
    free(s->across);
    free(s);
}

bool cells_left_out(const struct gas *g, int at) {
    const struct cells *c = g->cells;
    const int left = c->polyhedra->nown - at;
    const unsigned char *still = is_on(g) ? fit_still(c->fit) : NULL;
    return still && !memchr(still + at, 0, (size_t)(left < BATCH ? left : BATCH));
}

KERNEL static void find_minute(int n, int components, long size, double dt, const double *restrict U,
                               const double (*restrict residual)[BATCH], uint64_t *restrict still) {
    double square[BATCH];
    const double *restrict E = U + (components + 1) * size;
    for (int i = 0; i < n; i++) square[i] = 0;
    for (int k = 1; k <= components; k++)
        for (int i = 0; i < n; i++) square[i] = fma(residual[k][i], residual[k][i], square[i]);
    for (int i = 0; i < n; i++)
        still[i] = is(dt * fabs(residual[0][i]) <= NOTHING * U[i]) &
                   is(dt * fabs(residual[components + 1][i]) <= NOTHING * E[i]) &
                   is((dt * dt) * square[i] <= (NOTHING * NOTHING) * (2 * U[i] * E[i]));
}
/* Is any of the cells uniform? Then sets the bits of those that are, as are all cells across. */
KERNEL static void add_uniform(int rows, int n, const unsigned char *restrict own,
                               const unsigned char *restrict uniform, const int (*restrict across)[BATCH],
                               uint64_t *restrict still) {
    int all[BATCH];
    for (int i = 0; i < n; i++) all[i] = own[i];
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < n; i++) all[i] &= uniform[across[j][i]];
    for (int i = 0; i < n; i++) still[i] |= is(all[i] != 0);
}
KERNEL static void clear_still(int n, int nvar, const uint64_t *restrict still, double (*restrict residual)[BATCH]) {
    for (int v = 0; v < nvar; v++)
        for (int i = 0; i < n; i++) residual[v][i] = double_of(bits_of(residual[v][i]) & ~still[i]);
}

void cells_still(const struct gas *g, int at, int n, double dt, const double *U, double (*residual)[BATCH]) {
    const struct cells *c = g->cells;
    const int *start = c->sides.start + at / BATCH;
    const unsigned char *uniform = fit_uniform(c->fit);
    ALIGNED uint64_t still[BATCH];
    if (!is_on(g)) return;
    find_minute(n, g->components, g->size, dt, U, (const double(*)[BATCH])residual, still);
    if (memchr(uniform + at, 1, (size_t)n))
        add_uniform(start[1] - start[0], n, uniform + at, uniform, (const int(*)[BATCH])c->still->across + start[0],
                    still);
    clear_still(n, g->nvar, still, residual);
}
