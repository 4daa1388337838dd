/* What the sums S of diffusion.h are beyond a patch, by the rules of velocity and temperature: on both mesh engines. */
#include "libcore/state.h"

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

/* Beyond a wall of a given temperature: the mean of both sides is that of the wall. */
static void isothermal(const struct rule *rule, const struct sum_line *l) {
    for (int i = 0; i < l->n; i++) {
        const double T = rule->values ? rule->values[l->face[i]] : rule->uniform[0];
        l->ghost[0][i] = 2 * l->weight * T - l->inner[0][i];
    }
}

void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    const struct rule *rule = &rules->velocity;
    if (what != VISCOUS || !rule->type->drags || !rule->type->value) return;
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] += 2 * l->weight * rule->uniform[c];
}

void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l) {
    const bool given = what == HEAT && rules->temperature.type->value;
    if (rules->velocity.type->reflects && given)
        isothermal(&rules->temperature, l);
    else if (given || (what == VISCOUS && rules->velocity.type->value && !rules->velocity.type->reflects))
        hold(l);
    else
        reflect_sums(rules, l);
}
