/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the axes along which a run is uniform (uniform.h). */
#include "solvers/gas/uniform.h"

#include <string.h>

/* Lists the arrays from which the gas takes its state; returns their number. */
static int list_state(const struct initial *s, const double *out[MAX_VAR]) {
    int n = 0;
    for (; n < MAX_VAR && s->conserved[n]; n++) out[n] = s->conserved[n];
    if (n > 0) return n;
    out[n++] = s->rho;
    out[n++] = s->T;
    for (int k = 0; k < 3 && s->u[k]; k++) out[n++] = s->u[k];
    return n;
}

/* Are two faces inside the mesh, or on one patch with the same values? */
static bool same_faces(const struct polymesh *m, const struct initial *s, long a, long b) {
    if (a < m->ninternal) return b < m->ninternal;
    int p = 0;
    while (a >= m->patch[p].start + m->patch[p].nfaces) p++;
    const long start = m->patch[p].start;
    if (b < start || b >= start + m->patch[p].nfaces) return false;
    for (int i = 0; i < 3; i++) {
        const double *values = s->values[3 * p + i];
        const struct varying *v = initial_varying(s, p, i);
        if (v && !varying_alike(v, a - start, b - start)) return false;
        const long n = i == 1 ? s->components : 1;
        if (values && memcmp(values + (a - start) * n, values + (b - start) * n, (size_t)n * sizeof *values))
            return false;
    }
    return true;
}

static bool is_uniform(const struct polymesh *m, const struct initial *s, const struct lattice *l, int axis) {
    const double *state[MAX_VAR];
    const int nstate = list_state(s, state);
    const long step = axis == 0 ? 1 : axis == 1 ? l->n[0] : (long)l->n[0] * l->n[1];
    for (long i = 0; i < m->ncells; i++) {
        if (i / step % l->n[axis] == 0) continue;
        const long a = l->cell[i], b = l->cell[i - step];
        for (int v = 0; v < nstate; v++)
            if (memcmp(&state[v][a], &state[v][b], sizeof(double))) return false;
        for (int side = 0; side < 2 * l->dim; side++)
            if (side / 2 != axis && !same_faces(m, s, l->face[6 * a + side], l->face[6 * b + side])) return false;
    }
    return true;
}

void uniform_find(const struct polymesh *m, const struct initial *s, struct lattice *l) {
    for (int k = 0; k < l->dim; k++) l->uniform[k] = lattice_may_be_uniform(l, m, k) && is_uniform(m, s, l, k);
}
