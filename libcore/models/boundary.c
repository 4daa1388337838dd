#include "libcore/models/boundary.h"

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

#define FIELDS(s, v) .scalar = s, .vector = v
#define SLIPS        FIELDS(true, true), .reflects = true, .ghost = flip_normal
#define DRAGS        FIELDS(false, true), .reflects = true, .drags = true, .ghost = flip

const struct boundary_type boundary_table[] = {
    {.name = "slip", .about = "reflecting wall without friction", SLIPS},
    {.name = "symmetry", .about = "mirror, as slip", SLIPS},
    {.name = "symmetryPlane", .about = "mirror on a plane, as slip", SLIPS},
    {.name = "noSlip", .about = "wall at rest that the gas sticks to (without transport: turns the velocity)", DRAGS},
    {.name = "translatingWallVelocity",
     .about = "the same, moving along itself: U (ux uy uz);",
     .value = "U",
     .plain = true,
     .viscous = true,
     DRAGS},
    {.name = "granularWall",
     .about = "T at a wall that takes what impacts lose: restitution e; 0 to 1 (OpenFOAM's tools want a value, too)",
     FIELDS(true, false),
     .value = "restitution",
     .plain = true,
     .viscous = true,
     .absorbs = true,
     .ghost = copy},
    {.name = "zeroGradient", .about = "in- or outflow of the cell's own state", FIELDS(true, true), .ghost = copy},
    {.name = "fixedValue", .about = "given value", FIELDS(true, true), .value = "value", .ghost = fixed},
    {.name = "inletOutlet",
     .about = "zeroGradient outwards, given value inwards",
     FIELDS(true, true),
     .value = "inletValue",
     .ghost = inlet_outlet},
};
const struct boundary_type *const boundary_mirror = &boundary_table[0];
const int boundary_count = sizeof boundary_table / sizeof *boundary_table;

const struct boundary_type *boundary_find(const char *name) {
    for (int i = 0; i < boundary_count; i++)
        if (!strcmp(name, boundary_table[i].name)) return &boundary_table[i];
    return NULL;
}
