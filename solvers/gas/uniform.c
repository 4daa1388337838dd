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

/* Do the same values hold on two faces of a patch? */
static bool same_faces(const struct initial *s, int p, long a, long b) {
    for (int i = 0; i < 3; i++) {
        const double *values = s->values[3 * p + i];
        const struct varying *v = initial_varying(s, p, i);
        if (v && !varying_alike(v, a, b)) return false;
        const long n = i == 1 ? s->components : 1;
        if (values && memcmp(values + a * n, values + b * n, (size_t)n * sizeof *values)) return false;
    }
    return true;
}

/* Have the cells at two places the same cells or patches, with the same values, beyond their sides across other axes?
 */
static bool same_sides(const struct polymesh *m, const struct initial *s, const struct lattice *l, int axis,
                       const int at[3], const int before[3]) {
    for (int side = 0; side < 2 * l->dim; side++) {
        long a, b;
        if (side / 2 == axis || (at[side / 2] != (side % 2 ? l->n[side / 2] - 1 : 0))) continue;
        const int p = lattice_patch(l, m, at, side, &a), q = lattice_patch(l, m, before, side, &b);
        if (p != q || (p >= 0 && !same_faces(s, p, a, b))) return false;
    }
    return true;
}

static bool is_uniform(const struct polymesh *m, const struct initial *s, const struct lattice *l, int axis) {
    const double *state[MAX_VAR];
    const int nstate = list_state(s, state);
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++)
            for (at[0] = 0; at[0] < l->n[0]; at[0]++) {
                int before[3] = {at[0], at[1], at[2]};
                if (before[axis]-- == 0) continue;
                const long a = lattice_cell(l, at), b = lattice_cell(l, before);
                for (int v = 0; v < nstate; v++)
                    if (memcmp(&state[v][a], &state[v][b], sizeof(double))) return false;
                if (!same_sides(m, s, l, axis, at, before)) return false;
            }
    return true;
}

void uniform_find(const struct polymesh *m, const struct initial *s, struct lattice *l) {
    for (int k = 0; k < l->dim; k++) l->uniform[k] = lattice_may_be_uniform(l, m, k) && is_uniform(m, s, l, k);
}
