/* Ghost cells at patches: the boundary types applied to lines of cells along a side. */
#include "libcore/state.h"

struct line { /* a run of cells along a side of a tile */
    int n;
    long step;        /* from cell to cell */
    long first, from; /* offsets of the first cell inside and of the cell that the ghost is made from */
    long ghost;
    const int *face;
    int axis;   /* of the normal */
    double out; /* +1 at the high side, -1 at the low side */
};

static void gather(const double *q, long step, int n, double *line) {
    for (int i = 0; i < n; i++) line[i] = q[i * step];
}
static void scatter(const double *line, long step, int n, double *q) {
    for (int i = 0; i < n; i++) q[i * step] = line[i];
}

static void apply(const struct rule *rule, const struct line *l, int components, int normal, double (*inner)[BATCH],
                  const double *outflow, double (*ghost)[BATCH]) {
    struct ghost_line line = {
        .n = l->n, .components = components, .face = l->face, .outflow = outflow, .normal = normal};
    for (int c = 0; c < components; c++) {
        line.inner[c] = inner[c];
        line.ghost[c] = ghost[c];
    }
    rule->type->ghost(rule, &line);
}

/* No type needs a value: the rules act on the conserved variables themselves, so that a mirror image is exact. */
static void copy_line(const struct gas *g, const struct patch_rules *r, const struct line *l, double *U) {
    const long size = g->forest->size;
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH];
    for (int v = 0; v < g->nvar; v++) gather(U + v * size + l->from, l->step, l->n, inner[v]);
    apply(&r->velocity, l, g->dim, l->axis, inner + 1, NULL, ghost + 1);
    scatter(inner[0], l->step, l->n, U + l->ghost);
    for (int k = 1; k <= g->dim; k++) scatter(ghost[k], l->step, l->n, U + k * size + l->ghost);
    scatter(inner[g->dim + 1], l->step, l->n, U + (g->dim + 1) * size + l->ghost);
}

/* rho, u, T (or p) of the cells at `offset`: q[0], q[1..dim], q[dim + 1] */
static void primitive_line(const struct gas *g, bool pressure, const double *U, long offset, const struct line *l,
                           double (*q)[BATCH]) {
    const long size = g->forest->size;
    double kinetic[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH], *energy = q[g->dim + 1];
    for (int v = 0; v < g->nvar; v++) gather(U + v * size + offset, l->step, l->n, q[v]);
    for (int k = 1; k <= g->dim; k++)
        for (int i = 0; i < l->n; i++) {
            q[k][i] /= q[0][i];
            kinetic[i] += 0.5 * q[k][i] * q[k][i];
        }
    for (int i = 0; i < l->n; i++) energy[i] = energy[i] / q[0][i] - kinetic[i]; /* eps */
    g->models.eos->state(&g->models.material, l->n, q[0], energy, p, c2, gruneisen);
    for (int i = 0; i < l->n; i++) energy[i] = pressure ? p[i] : (g->models.material.gamma - 1) * energy[i];
}

static void conserve_line(const struct gas *g, bool pressure, double (*q)[BATCH], const struct line *l, double *U) {
    const long size = g->forest->size;
    double p[BATCH], c2[BATCH], gruneisen[BATCH], one[BATCH], *energy = q[g->dim + 1];
    for (int i = 0; i < l->n; i++) one[i] = 1;
    g->models.eos->state(&g->models.material, l->n, q[0], one, p, c2, gruneisen);
    for (int i = 0; i < l->n; i++) {
        double eps = pressure ? energy[i] / p[i] : energy[i] / (g->models.material.gamma - 1); /* p is linear in eps */
        double kinetic = 0;
        for (int k = 1; k <= g->dim; k++) kinetic += 0.5 * q[k][i] * q[k][i];
        energy[i] = q[0][i] * (eps + kinetic);
        for (int k = 1; k <= g->dim; k++) q[k][i] *= q[0][i];
    }
    for (int v = 0; v < g->nvar; v++) scatter(q[v], l->step, l->n, U + v * size + l->ghost);
}

static void value_line(const struct gas *g, const struct patch_rules *r, const struct line *l, double *U) {
    double inner[MAX_VAR][BATCH], first[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH];
    int last = g->dim + 1;
    primitive_line(g, r->pressure, U, l->first, l, first);
    primitive_line(g, r->pressure, U, l->from, l, inner);
    for (int i = 0; i < l->n; i++) outflow[i] = l->out * first[1 + l->axis][i];
    apply(&r->density, l, 1, -1, inner, outflow, ghost);
    apply(&r->velocity, l, g->dim, l->axis, inner + 1, outflow, ghost + 1);
    apply(&r->temperature, l, 1, -1, inner + last, outflow, ghost + last);
    conserve_line(g, r->pressure, ghost, l, U);
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
    bool values = r->density.type->value || r->velocity.type->value || r->temperature.type->value;
    long inward = high ? -f->stride[axis] : f->stride[axis];
    for (int k = 0; k < t->n[deep]; k++)
        for (int start = 0; start < t->n[across]; start += BATCH)
            for (int m = 1; m <= GHOSTS; m++) {
                struct line l = {.step = f->stride[across], .axis = axis, .out = high ? 1 : -1};
                l.n = t->n[across] - start < BATCH ? t->n[across] - start : BATCH;
                l.first = f->first + (high ? (t->n[axis] - 1) * f->stride[axis] : 0) + k * f->stride[deep] +
                          start * f->stride[across];
                l.from = l.first + (r->velocity.type->reflects ? image(m, t->n[axis]) : 0) * inward;
                l.ghost = l.first - m * inward;
                l.face = side->face + (long)k * t->n[across] + start;
                if (values)
                    value_line(g, r, &l, U);
                else
                    copy_line(g, r, &l, U);
            }
}

void ghosts_of_patches(const struct gas *g, int tile, double *U) {
    const struct tile *t = &g->forest->tile[tile];
    for (int axis = 0; axis < g->dim; axis++)
        for (int high = 0; high < 2; high++)
            if (t->side[2 * axis + high].patch >= 0) side_ghosts(g, t, axis, high, U);
}
