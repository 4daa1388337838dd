/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the sums S of diffusion.h beyond a patch, by the rules of velocity and temperature, for both engines;
 * patch.h has the formulas. */
#include "libcore/gas/patch.h"

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
