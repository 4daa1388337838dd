/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes states beyond a patch: applies the boundary types of density, velocity and temperature (or pressure) to a
 * line of cells, on the conserved variables; and sums of diffusion beyond it. */
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
    double kinetic[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH], *energy = q[energy_at(g)];
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
    double p[BATCH], c2[BATCH], gruneisen[BATCH], *energy = q[energy_at(g)];
    eos_unit_state(g->models.eos, &g->models.material, n, q[0], p, c2, gruneisen);
    for (int i = 0; i < n; i++) {
        double eps = pressure ? eps_at_pressure(energy[i], p[i], 1) : eps_of(&g->models.material, energy[i]);
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
        if (!(ghost[0][i] < PACKED * g->limits.most)) ghost[0][i] = plain[0][i];
}

void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]) {
    int last = energy_at(g);
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

/* ---- values on a patch itself (docs/physics.md 5.8) ---- */

/* T of the gas on a wall that takes heat in proportion to T, with gravity left out: to first order in the cell. A law
 * that asks for the shear rate gets that of gas which the wall holds. */
static void surface_temperature(const struct gas *g, const struct patch_rules *r, int n, const int *face,
                                const double *gap, const double *rho, const double *slip, double *T) {
    const struct gas_models *m = &g->models;
    double bulk[BATCH], shear[BATCH], heat[BATCH], cross[BATCH], none[BATCH] = {0}, share[2][BATCH], rate[BATCH];
    const bool sees = m->transport->needs & NEEDS_SHEAR_RATE;
    for (int i = 0; i < n && sees; i++) rate[i] = wall_drags(r) ? 2 * sqrt(slip[i]) / gap[i] : 0;
    const struct closure_line cells = {
        .eos = m->eos, .material = &m->material, .n = n, .rho = rho, .T = T, .shear_rate = sees ? rate : NULL};
    transport_row(g, &cells, bulk, shear, heat);
    if (g->diffusion.terms.cross) m->transport->cross(&m->transport_params, &cells, cross);
    struct wall_line line = {.n = n,
                             .face = face,
                             .eos = m->eos,
                             .material = &m->material,
                             .rho = rho,
                             .T = T,
                             .push = none,
                             .d = gap,
                             .shear = shear,
                             .heat = heat,
                             .slip = slip,
                             .cross = g->diffusion.terms.cross ? cross : NULL};
    wall_shares(r, &line, share[0], share[1]);
    memcpy(T, line.surface, (size_t)n * sizeof *T);
}

/* Gas on a wall has the wall's velocity where the wall drags it, else its own along the wall; and T of the wall, or of
 * gas that gives heat to it. */
static void wall_values(const struct gas *g, const struct patch_rules *r, int n, const int *face,
                        double *const normal[3], const double *gap, double *const q[MAX_VAR]) {
    double slip[BATCH], *T = q[g->components + 1];
    for (int i = 0; i < n; i++) {
        double w[MAX_DIM], through = 0, square = 0;
        wall_velocity(r, g->components, face[i], w);
        for (int k = 0; k < g->components; k++) through += q[k + 1][i] * normal[k][i];
        for (int k = 0; k < g->components; k++) {
            const double along = q[k + 1][i] - through * normal[k][i];
            square += (along - w[k]) * (along - w[k]);
            q[k + 1][i] = wall_drags(r) ? w[k] : along;
        }
        slip[i] = square;
    }
    if (!g->models.transport || !wall_conducts(r)) return;
    if (!r->temperature.type->temperature) surface_temperature(g, r, n, face, gap, q[0], slip, T);
    for (int i = 0; i < n && r->temperature.type->temperature; i++) T[i] = wall_temperature(r, face[i]);
}

/* Gas on an open patch has the state beyond the patch, on it: layer 0. */
static void open_values(const struct gas *g, const struct patch_rules *r, int n, const int *face,
                        double *const normal[3], double *const q[MAX_VAR]) {
    const int last = energy_at(g);
    const struct material *material = &g->models.material;
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH], per[BATCH];
    const struct patch_line line = {.n = n, .face = face, .outflow = outflow};
    for (int v = 0; v < g->nvar; v++) memcpy(inner[v], q[v], (size_t)n * sizeof(double));
    pressure_per_temperature(g->models.eos, material, n, q[0], per);
    for (int i = 0; i < n; i++) {
        outflow[i] = 0;
        for (int k = 0; k < g->components; k++) outflow[i] += normal[k][i] * q[k + 1][i];
        if (r->pressure) inner[last][i] *= per[i];
    }
    apply(&r->density, &line, 0, 1, -1, NULL, inner, ghost);
    apply(&r->velocity, &line, 1, g->components, 0, ghost[0], inner, ghost);
    apply(&r->temperature, &line, last, 1, -1, NULL, inner, ghost);
    pressure_per_temperature(g->models.eos, material, n, ghost[0], per);
    for (int i = 0; i < n && r->pressure; i++) ghost[last][i] /= per[i];
    for (int v = 0; v < g->nvar; v++) memcpy(q[v], ghost[v], (size_t)n * sizeof(double));
}

bool gas_on_patch(const struct gas *g, int patch, int n, const int *face, double *const normal[3], const double *gap,
                  double *const q[MAX_VAR]) {
    const struct patch_rules *r = &g->patches.rules[patch];
    for (int at = 0; at < n && r->velocity.type; at += BATCH) {
        const int m = n - at < BATCH ? n - at : BATCH;
        double *const to[3] = {normal[0] + at, normal[1] + at, normal[2] + at}, *part[MAX_VAR] = {NULL};
        for (int v = 0; v < g->nvar; v++) part[v] = q[v] + at;
        if (patch_is_wall(r))
            wall_values(g, r, m, face + at, to, gap + at, part);
        else
            open_values(g, r, m, face + at, to, part);
    }
    return r->velocity.type && patch_is_wall(r);
}

double patch_wall_friction(const struct gas *g, int patch, int face, double velocity[MAX_DIM]) {
    const struct patch_rules *r = &g->patches.rules[patch];
    for (int k = 0; k < g->components; k++) velocity[k] = 0;
    if (!r->velocity.type || !patch_is_wall(r)) return 0;
    wall_velocity(r, g->components, face, velocity);
    return wall_friction(r);
}

/* ---- patches that give mass ---- */

/* Computes E + p of states, where a state gives its work, too. */
static void find_enthalpy(const struct gas *g, int n, double (*q)[BATCH], double *out) {
    double eps[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < n; i++) {
        double kinetic = 0;
        for (int k = 1; k <= g->components; k++) kinetic += 0.5 * (q[k][i] / q[0][i]) * (q[k][i] / q[0][i]);
        eps[i] = q[energy_at(g)][i] / q[0][i] - kinetic;
    }
    g->models.eos->state(&g->models.material, n, q[0], eps, p, c2, gruneisen);
    for (int i = 0; i < n; i++) out[i] = q[energy_at(g)][i] + p[i];
}

/* Computes the density that gas which flows in has on the patch. */
static void find_density(const struct patch_rules *r, int n, const int *face, double *inner, double *out) {
    double inwards[BATCH];
    const struct ghost_line line = {
        .n = n, .components = 1, .face = face, .inner = {inner}, .outflow = inwards, .normal = -1, .ghost = {out}};
    for (int i = 0; i < n; i++) inwards[i] = -1;
    r->density.type->ghost(&r->density, &line);
}

static void take_cells(const struct gas *g, const double *U, int n, const int *at, double (*out)[BATCH]) {
    out[0][0] = U[at[0]]; /* else gcc warns of a line without numbers */
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) out[v][i] = U[v * g->size + at[i]];
}

void feed_fluxes(const struct gas *g, const struct patch_rules *r, const struct fed_faces *f) {
    const int last = energy_at(g), n = f->n;
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], enthalpy[BATCH], rho[BATCH], mass[BATCH];
    double(*flux)[BATCH] = f->flux;
    take_cells(g, f->U, n, f->in, inner);
    take_cells(g, f->U, n, f->beyond, ghost);
    find_enthalpy(g, n, ghost, enthalpy);
    find_density(r, n, f->face, inner[0], rho);
    memcpy(mass, flux[0], (size_t)n * sizeof *mass);
    patch_feed_mass(r, g->components, n, f->face, f->into, rho, mass);
    for (int i = 0; i < n; i++) {
        const double more = mass[i] - flux[0][i];
        const double part = more / (more > 0 ? ghost[0][i] : inner[0][i]);
        for (int k = 1; k <= g->components; k++) flux[k][i] += part * (more > 0 ? ghost[k][i] : inner[k][i]);
        flux[last][i] += part * (more > 0 ? enthalpy[i] : inner[last][i]);
        flux[0][i] = mass[i];
    }
}

/* ---- the sums S of diffusion.h, by the rules of velocity and temperature; patch.h has the formulas ---- */

void reflect_sums(const struct patch_rules *rules, const struct sum_line *l) {
    const bool reflects = patch_is_wall(rules) && l->normal >= 0;
    for (int c = 0; c < l->components; c++)
        if (!reflects)
            memcpy(l->ghost[c], l->inner[c], (size_t)l->n * sizeof(double));
        else
            for (int i = 0; i < l->n; i++)
                l->ghost[c][i] = c == l->normal ? -l->inner[c][i] : (1 - l->share[i]) * l->inner[c][i];
}

/* Beyond a patch with values q stays q_0, so that S = weight q_0. Where a rule gives values to inflow alone, gas that
 * flows out has S of the cell: conduction out of q_0, that of the step's start, would heat cells that cool. */
static void hold(const struct rule *rule, const struct sum_line *l) {
    const bool switches = rule_switches(rule);
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++)
            l->ghost[c][i] = switches && l->share[i] == 0 ? l->inner[c][i] : l->weight * l->start[c][i];
}

void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    if (what != VISCOUS || !wall_works(rules)) return;
    for (int i = 0; i < l->n; i++) {
        double w[MAX_DIM];
        wall_velocity(rules, l->components, l->face[i], w);
        for (int c = 0; c < l->components; c++) l->ghost[c][i] += l->share[i] * l->weight * w[c];
    }
}

void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    const struct rule *rule = what == HEAT ? &rules->temperature : &rules->velocity;
    if (what == HEAT && wall_conducts(rules))
        for (int i = 0; i < l->n; i++) l->ghost[0][i] = l->weight * wall_temperature(rules, l->face[i]);
    else if (!patch_is_wall(rules) && rule_holds(rule))
        hold(rule, l);
    else
        reflect_sums(rules, l);
}
