/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes states beyond a patch: applies the boundary types of density, velocity and temperature (or pressure) to a
 * line of cells, on the conserved variables. */
#include "libcore/gas/patch.h"

/* Applies the rule of `components` variables from `first` on. */
static void apply(const struct rule *rule, const struct patch_line *l, int first, int components, int normal,
                  const double *rho, double (*inner)[BATCH], double (*ghost)[BATCH]) {
    struct ghost_line line = {.n = l->n,
                              .components = components,
                              .face = l->face,
                              .outflow = l->outflow,
                              .rho = rho,
                              .layer = l->layer,
                              .normal = normal};
    inner += first;
    ghost += first;
    for (int c = 0; c < components; c++) {
        if (l->next) line.next[c] = l->next[first + c];
        line.inner[c] = inner[c];
        line.ghost[c] = ghost[c];
    }
    rule->type->ghost(rule, &line);
}

/* Turns rho, rho u, E into rho, u, T (or p), in place. */
static void to_primitive(const struct gas *g, bool pressure, int n, double (*q)[BATCH]) {
    double kinetic[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH], *energy = q[g->components + 1];
    for (int k = 1; k <= g->components; k++)
        for (int i = 0; i < n; i++) {
            q[k][i] /= q[0][i];
            kinetic[i] += 0.5 * q[k][i] * q[k][i];
        }
    for (int i = 0; i < n; i++) energy[i] = energy[i] / q[0][i] - kinetic[i]; /* eps */
    g->models.eos->state(&g->models.material, n, q[0], energy, p, c2, gruneisen);
    for (int i = 0; i < n; i++) energy[i] = pressure ? p[i] : temperature_of(&g->models.material, energy[i]);
}

static void to_conserved(const struct gas *g, bool pressure, int n, double (*q)[BATCH]) {
    double p[BATCH], c2[BATCH], gruneisen[BATCH], one[BATCH] = {0}, *energy = q[g->components + 1];
    for (int i = 0; i < n; i++) one[i] = 1;
    g->models.eos->state(&g->models.material, n, q[0], one, p, c2, gruneisen);
    for (int i = 0; i < n; i++) {
        double eps = pressure ? energy[i] / p[i] : eps_of(&g->models.material, energy[i]); /* p is linear in eps */
        double kinetic = 0;
        for (int k = 1; k <= g->components; k++) kinetic += 0.5 * q[k][i] * q[k][i];
        energy[i] = q[0][i] * (eps + kinetic);
        for (int k = 1; k <= g->components; k++) q[k][i] *= q[0][i];
    }
}

/* Gives the ghosts of a density that would be packed beyond the patch the density on it. */
static void unpack(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                   double (*ghost)[BATCH]) {
    struct patch_line on = *l;
    double plain[1][BATCH];
    if (!r->density.changes || l->layer == 0) return;
    on.layer = 0;
    apply(&r->density, &on, 0, 1, -1, NULL, inner, plain);
    for (int i = 0; i < l->n; i++)
        if (!(ghost[0][i] < PACKED * g->limit)) ghost[0][i] = plain[0][i];
}

void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]) {
    int last = g->components + 1;
    if (!patch_needs_values(r)) { /* on the conserved variables themselves, so that a mirror image is exact */
        memcpy(ghost[0], inner[0], (size_t)l->n * sizeof(double));
        const struct rule mirror = {.type = boundary_mirror};
        apply(g->models.transport && patch_is_wall(r) ? &mirror : &r->velocity, l, 1, g->components, l->normal, NULL,
              inner, ghost);
        memcpy(ghost[last], inner[last], (size_t)l->n * sizeof(double));
        return;
    }
    to_primitive(g, r->pressure, l->n, inner);
    if (l->next) to_primitive(g, r->pressure, l->n, l->next);
    apply(&r->density, l, 0, 1, -1, NULL, inner, ghost);
    unpack(g, r, l, inner, ghost);
    apply(&r->velocity, l, 1, g->components, l->normal, ghost[0], inner, ghost);
    apply(&r->temperature, l, last, 1, -1, NULL, inner, ghost);
    to_conserved(g, r->pressure, l->n, ghost);
}

/* Computes E + p of states, where a state gives its work, too. */
static void find_enthalpy(const struct gas *g, int n, double (*q)[BATCH], double *out) {
    double eps[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < n; i++) {
        double kinetic = 0;
        for (int k = 1; k <= g->components; k++) kinetic += 0.5 * (q[k][i] / q[0][i]) * (q[k][i] / q[0][i]);
        eps[i] = q[g->components + 1][i] / q[0][i] - kinetic;
    }
    g->models.eos->state(&g->models.material, n, q[0], eps, p, c2, gruneisen);
    for (int i = 0; i < n; i++) out[i] = q[g->components + 1][i] + p[i];
}

/* Computes the density that gas which flows in has on the patch. */
static void find_density(const struct patch_rules *r, int n, const int *face, double *inner, double *out) {
    double inwards[BATCH];
    const struct ghost_line line = {
        .n = n, .components = 1, .face = face, .inner = {inner}, .outflow = inwards, .normal = -1, .ghost = {out}};
    for (int i = 0; i < n; i++) inwards[i] = -1;
    r->density.type->ghost(&r->density, &line);
}

void feed_fluxes(const struct gas *g, const struct patch_rules *r, int n, const int *face, const double *into,
                 double (*inner)[BATCH], double (*ghost)[BATCH], double (*flux)[BATCH]) {
    const int last = g->components + 1;
    double enthalpy[BATCH], rho[BATCH], mass[BATCH];
    find_enthalpy(g, n, ghost, enthalpy);
    find_density(r, n, face, inner[0], rho);
    memcpy(mass, flux[0], (size_t)n * sizeof *mass);
    patch_feed_mass(r, g->components, n, face, into, rho, mass);
    for (int i = 0; i < n; i++) {
        const double more = mass[i] - flux[0][i];
        const double part = more / (more > 0 ? ghost[0][i] : inner[0][i]);
        for (int k = 1; k <= g->components; k++) flux[k][i] += part * (more > 0 ? ghost[k][i] : inner[k][i]);
        flux[last][i] += part * (more > 0 ? enthalpy[i] : inner[last][i]);
        flux[0][i] = mass[i];
    }
}
