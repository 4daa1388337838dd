/* What the sums S of diffusion.h are beyond a patch, by the rules of velocity and temperature: on both mesh engines. */
#include "libcore/gas/patch.h"

/* Reflecting velocities are reflected, all else is copied. */
void reflect_sums(const struct patch_rules *rules, const struct sum_line *l) {
    const struct rule *rule = &rules->velocity;
    struct ghost_line line = {.n = l->n, .components = l->components, .normal = l->normal};
    for (int c = 0; c < l->components; c++) {
        memcpy(l->ghost[c], l->inner[c], (size_t)l->n * sizeof(double));
        line.inner[c] = l->inner[c];
        line.ghost[c] = l->ghost[c];
    }
    if (rule->type->reflects && l->normal >= 0) rule->type->ghost(rule, &line);
}

/* Beyond a patch with values: these do not change. */
static void hold(const struct sum_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = l->weight * l->start[c][i];
}

bool wall_conducts(const struct patch_rules *rules) {
    return rules->velocity.type->reflects && rules->temperature.type->value;
}

/* The sum of a wall's temperature; a wall that absorbs takes heat in proportion to the temperature of the gas alone. */
static void at_wall(const struct rule *rule, const struct sum_line *l) {
    for (int i = 0; i < l->n; i++) {
        const double T = rule->values ? rule->values[l->face[i]] : rule->uniform[0];
        l->ghost[0][i] = rule->type->absorbs ? 0 : l->weight * T;
    }
}

/* A wall of restitution e takes q = c p sqrt(T_w), c = (1 - e^2)/sqrt(2 pi), T_w of the gas at it: per area and time
 * n sqrt(T/2 pi) grains come with a mean normal energy of m T each, and at a wall n m T = p: that of the cell, and the
 * weight of what lies between, as gas that stays at a wall has dp/dn = rho push there. The cell conducts
 * 2 heat/d (T - T_w) to it, which with s = sqrt(T_w) is s^2 + 2 B s - T = 0,  B = c p d/(4 heat). With B/s kept from
 * the start that is the share 4 B/(s + 2 B) of heat T/d: linear, and less than a wall of T = 0 takes.
 * Without conduction there is no such wall: no heat reaches it but from the cell beside it, which is cold within
 * d/sqrt(T), so that what is lost vanishes with d.
 */
static void absorbed_shares(const struct gas *g, double restitution, int n, const double *rho, const double *T,
                            const double *push, const double *d, const double *heat, double *share) {
    const double c = (1 - restitution * restitution) / sqrt(2 * 3.14159265358979323846);
    double eps[BATCH] = {0}, p[BATCH], square[BATCH], gruneisen[BATCH];
    for (int i = 0; i < n; i++) eps[i] = eps_of(&g->models.material, T[i]);
    g->models.eos->state(&g->models.material, n, rho, eps, p, square, gruneisen);
    for (int i = 0; i < n; i++) {
        p[i] = larger(p[i] + 0.5 * d[i] * rho[i] * push[i], 0); /* gas that the wall leaves behind */
        const double B = c * p[i] * d[i] / (4 * heat[i]), s = T[i] / (B + sqrt(B * B + T[i]));
        share[i] = 4 / (s / B + 2); /* B = 0: none */
    }
}

void wall_shares(const struct gas *g, const struct patch_rules *rules, int n, const double *rho, const double *T,
                 const double *push, const double *d, const double *heat, double *share) {
    const struct rule *rule = &rules->temperature;
    if (rule->type->absorbs)
        absorbed_shares(g, rule->uniform[0], n, rho, T, push, d, heat, share);
    else
        for (int i = 0; i < n; i++) share[i] = 2; /* half the distance */
}

void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    const struct rule *rule = &rules->velocity;
    if (what != VISCOUS || !rule->type->drags || !rule->type->value) return;
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] += 2 * l->weight * rule->uniform[c];
}

void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    const bool given = what == HEAT && rules->temperature.type->value;
    if (what == HEAT && wall_conducts(rules))
        at_wall(&rules->temperature, l);
    else if (given || (what == VISCOUS && rules->velocity.type->value && !rules->velocity.type->reflects))
        hold(l);
    else
        reflect_sums(rules, l);
}
