/* Finds the cells that hold points, for function objects that sample there, and gathers fields at the points. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void bounding_box(const struct polymesh *m, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = HUGE_VAL;
        high[a] = -HUGE_VAL;
        for (int i = 0; i < m->npoints; i++) {
            low[a] = fmin(low[a], m->points[3 * (long)i + a]);
            high[a] = fmax(high[a], m->points[3 * (long)i + a]);
        }
        double slack = 1e-9 * (high[a] - low[a]);
        low[a] -= slack;
        high[a] += slack;
    }
}

status spots_add(struct spots *s, const struct function *f, struct dict *d, const char *key, int n,
                 const double *points, bool allow_outside) {
    if (n > MOST_SPOTS - s->n)
        return dict_fail(d, key, "more than %d points in one function object; give several", (int)MOST_SPOTS);
    struct spot *more = realloc(s->at, (size_t)(s->n + n + 1) * sizeof *more);
    if (!more) return fail(ERR_SYSTEM, "out of memory");
    s->at = more;
    double low[3], high[3]; /* needed as grid_locate looks at the solved axes only */
    bounding_box(f->setup->mesh, low, high);
    for (int i = 0; i < n; i++) {
        struct spot *p = &s->at[s->n++];
        memcpy(p->x, points + 3 * (long)i, sizeof p->x);
        grid_locate(f->setup->grid, p->x, &p->block, &p->cell);
        double found = p->block >= 0;
        for (int a = 0; a < 3; a++)
            if (p->x[a] < low[a] || p->x[a] > high[a]) found = 0;
        if (found == 0) p->block = -1;
        comm_max(f->setup->comm, &found, 1);
        p->inside = found > 0;
        if (!p->inside && !allow_outside)
            return dict_fail(d, key, "the point (%g %g %g) lies outside the mesh; move it, or say  allowOutside yes;",
                             p->x[0], p->x[1], p->x[2]);
    }
    return OK;
}

status spots_sample(const struct spots *s, const struct function *f, int field, double **out) {
    const struct grid *grid = f->setup->grid;
    int m = quantity_of(f, field)->components;
    double *lines[3];
    TRY(allocate(out, (long)(s->n + 1) * m, sizeof(double), "samples"));
    for (long i = 0; i < (long)s->n * m; i++) (*out)[i] = -HUGE_VAL;
    for (int b = 0; b < grid->nblocks; b++) {
        bool wanted = false;
        for (int i = 0; i < s->n; i++) wanted |= s->at[i].block == b;
        if (!wanted) continue;
        function_block(f, b, field, lines);
        for (int i = 0; i < s->n; i++) {
            if (s->at[i].block != b) continue;
            double *to = *out + (long)i * m;
            if (m == 1)
                *to = lines[0][s->at[i].cell];
            else
                for (int x = 0; x < 3; x++) to[x] = 0;
            for (int k = 0; m == 3 && k < setup_lines(f->setup, field); k++) to[f->setup->axis[k]] = lines[k][s->at[i].cell];
        }
    }
    comm_max(f->setup->comm, *out, s->n * m); /* one rank has each value, the others -infinity */
    for (int i = 0; i < s->n; i++)
        for (int c = 0; c < m && !s->at[i].inside; c++) (*out)[(long)i * m + c] = -1e300; /* as OpenFOAM does */
    return OK;
}

void spots_free(struct spots *s) {
    free(s->at);
}
