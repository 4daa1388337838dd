#include "libcore/boundary.h"

#include <stddef.h>
#include <string.h>

static void copy(const struct rule *rule, const struct ghost_line *l) {
    (void)rule;
    for (int c = 0; c < l->components; c++) memcpy(l->ghost[c], l->inner[c], (size_t)l->n * sizeof(double));
}

static void flip_normal(const struct rule *rule, const struct ghost_line *l) {
    copy(rule, l);
    if (l->components == 1 && l->normal < 0) return; /* a scalar */
    for (int i = 0; i < l->n; i++) l->ghost[l->normal][i] = -l->inner[l->normal][i];
}

static void flip(const struct rule *rule, const struct ghost_line *l) {
    (void)rule;
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = -l->inner[c][i];
}

static double value_of(const struct rule *rule, const struct ghost_line *l, int i, int c) {
    return rule->values ? rule->values[l->face[i] * l->components + c] : rule->uniform[c];
}

static void fixed(const struct rule *rule, const struct ghost_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = value_of(rule, l, i, c);
}

static void inlet_outlet(const struct rule *rule, const struct ghost_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = l->outflow[i] >= 0 ? l->inner[c][i] : value_of(rule, l, i, c);
}

const struct boundary_type boundary_table[] = {
    {"slip", "reflecting wall without friction", true, true, true, NULL, flip_normal},
    {"symmetry", "mirror, as slip", true, true, true, NULL, flip_normal},
    {"symmetryPlane", "mirror on a plane, as slip", true, true, true, NULL, flip_normal},
    {"noSlip", "reflecting wall that turns the whole velocity", false, true, true, NULL, flip},
    {"zeroGradient", "in- or outflow of the cell's own state", true, true, false, NULL, copy},
    {"fixedValue", "given value", true, true, false, "value", fixed},
    {"inletOutlet", "zeroGradient outwards, given value inwards", true, true, false, "inletValue", inlet_outlet},
};
const int boundary_count = sizeof boundary_table / sizeof *boundary_table;

const struct boundary_type *boundary_find(const char *name) {
    for (int i = 0; i < boundary_count; i++)
        if (!strcmp(name, boundary_table[i].name)) return &boundary_table[i];
    return NULL;
}
