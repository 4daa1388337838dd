/* Ghost cells at patches: the boundary types applied to lines of cells along a side. */
#include "libcore/gas/state.h"

static void apply(const struct rule *rule, const struct patch_line *l, int components, int normal,
                  double (*inner)[BATCH], double (*ghost)[BATCH]) {
    struct ghost_line line = {
        .n = l->n, .components = components, .face = l->face, .outflow = l->outflow, .normal = normal};
    for (int c = 0; c < components; c++) {
        line.inner[c] = inner[c];
        line.ghost[c] = ghost[c];
    }
    rule->type->ghost(rule, &line);
}

/* rho, rho u, E -> rho, u, T (or p), in place */
static void to_primitive(const struct gas *g, bool pressure, int n, double (*q)[BATCH]) {
    double kinetic[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH], *energy = q[g->dim + 1];
    for (int k = 1; k <= g->dim; k++)
        for (int i = 0; i < n; i++) {
            q[k][i] /= q[0][i];
            kinetic[i] += 0.5 * q[k][i] * q[k][i];
        }
    for (int i = 0; i < n; i++) energy[i] = energy[i] / q[0][i] - kinetic[i]; /* eps */
    g->models.eos->state(&g->models.material, n, q[0], energy, p, c2, gruneisen);
    for (int i = 0; i < n; i++) energy[i] = pressure ? p[i] : (g->models.material.gamma - 1) * energy[i];
}

static void to_conserved(const struct gas *g, bool pressure, int n, double (*q)[BATCH]) {
    double p[BATCH], c2[BATCH], gruneisen[BATCH], one[BATCH] = {0}, *energy = q[g->dim + 1];
    for (int i = 0; i < n; i++) one[i] = 1;
    g->models.eos->state(&g->models.material, n, q[0], one, p, c2, gruneisen);
    for (int i = 0; i < n; i++) {
        double eps = pressure ? energy[i] / p[i] : energy[i] / (g->models.material.gamma - 1); /* p is linear in eps */
        double kinetic = 0;
        for (int k = 1; k <= g->dim; k++) kinetic += 0.5 * q[k][i] * q[k][i];
        energy[i] = q[0][i] * (eps + kinetic);
        for (int k = 1; k <= g->dim; k++) q[k][i] *= q[0][i];
    }
}

bool patch_needs_values(const struct patch_rules *r) {
    if (r->velocity.type->reflects) return false; /* the temperature of a wall is felt by conduction only */
    return r->density.type->value || r->velocity.type->value || r->temperature.type->value;
}

void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]) {
    int last = g->dim + 1;
    if (!patch_needs_values(r)) { /* on the conserved variables themselves, so that a mirror image is exact */
        memcpy(ghost[0], inner[0], (size_t)l->n * sizeof(double));
        const struct rule mirror = {.type = boundary_mirror};
        apply(g->models.transport && r->velocity.type->reflects ? &mirror : &r->velocity, l, g->dim, l->normal,
              inner + 1, ghost + 1);
        memcpy(ghost[last], inner[last], (size_t)l->n * sizeof(double));
        return;
    }
    to_primitive(g, r->pressure, l->n, inner);
    apply(&r->density, l, 1, -1, inner, ghost);
    apply(&r->velocity, l, g->dim, l->normal, inner + 1, ghost + 1);
    apply(&r->temperature, l, 1, -1, inner + last, ghost + last);
    to_conserved(g, r->pressure, l->n, ghost);
}

struct line { /* a run of cells along a side of a tile */
    struct patch_line patch;
    long step;        /* from cell to cell */
    long first, from; /* offsets of the first cell inside and of the cell that the ghost is made from */
    long ghost;
    double out; /* +1 at the high side, -1 at the low side */
};

static void fill_line(const struct gas *g, const struct patch_rules *r, struct line *l, double *U) {
    const long size = g->forest->size;
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH];
    int n = l->patch.n;
    if (patch_needs_values(r)) {
        const double *rho = U + l->first, *mom = U + (l->patch.normal + 1) * size + l->first;
        for (int i = 0; i < n; i++) outflow[i] = l->out * (mom[i * l->step] / rho[i * l->step]);
        l->patch.outflow = outflow;
    }
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) inner[v][i] = U[v * size + l->from + i * l->step];
    patch_ghosts(g, r, &l->patch, inner, ghost);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) U[v * size + l->ghost + i * l->step] = ghost[v][i];
}

/* The cell, counted from the side, whose image is ghost layer m = 1, 2, ..: mirrored again by a side closer than m. */
static int image(int m, int n) {
    int at = (m - 1) % (2 * n);
    return at < n ? at : 2 * n - 1 - at;
}

static void side_ghosts(const struct gas *g, const struct tile *t, int axis, int high, double *U) {
    const struct forest *f = g->forest;
    const struct side *side = &t->side[2 * axis + high];
    const struct patch_rules *r = &g->rules[side->patch];
    int across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2; /* the other axes */
    long inward = high ? -f->stride[axis] : f->stride[axis];
    for (int k = 0; k < t->n[deep]; k++)
        for (int start = 0; start < t->n[across]; start += BATCH)
            for (int m = 1; m <= GHOSTS; m++) {
                struct line l = {.step = f->stride[across], .out = high ? 1 : -1, .patch = {.normal = axis}};
                l.patch.n = t->n[across] - start < BATCH ? t->n[across] - start : BATCH;
                l.first = f->first + (high ? (t->n[axis] - 1) * f->stride[axis] : 0) + k * f->stride[deep] +
                          start * f->stride[across];
                l.from = l.first + (r->velocity.type->reflects ? image(m, t->n[axis]) : 0) * inward;
                l.ghost = l.first - m * inward;
                l.patch.face = side->face + (long)k * t->n[across] + start;
                fill_line(g, r, &l, U);
            }
}

void ghosts_of_patches(const struct gas *g, int tile, double *U) {
    const struct tile *t = &g->forest->tile[tile];
    for (int axis = 0; axis < g->dim; axis++)
        for (int high = 0; high < 2; high++)
            if (t->side[2 * axis + high].patch >= 0) side_ghosts(g, t, axis, high, U);
}
