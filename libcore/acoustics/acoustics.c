/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of the family `acoustics` and their parameters: which cells take implicit steps, and when (docs/physics.md
 * 9.2). */
#include "libcore/acoustics/acoustics.h"

#include <string.h>

#define PARAM_STRUCT struct acoustics_params
#define BED_PARAMS(gain_by_default)                                                                                    \
    NUMBER("dense", dense, 0.9, BETWEEN(0, 1), NO_UNIT,                                                                \
           "alpha/alphaMax above which cells, and those beside them, are implicit"),                                   \
        NUMBER(                                                                                                        \
            "thin", thin, 1e-3, FROM_TO(0, 1), NO_UNIT,                                                                \
            "alpha/alphaMax below which cells are implicit, too, where they would limit dt: hot remains above a bed"), \
        NUMBER("gain", gain, gain_by_default, FROM_TO(1, 1e6), NO_UNIT,                                                \
               "a step is implicit if it is at least this number of times as long as the explicit one"),               \
        NUMBER("governor", governor, 1, BETWEEN(0, 1e6), NO_UNIT,                                                      \
               "most of dt times the cooling rate of dense cells: less resolves impacts of a bed better"),             \
        NUMBER("soft", soft, 0.2, BETWEEN(0, 1), NO_UNIT,                                                              \
               "friction between neighbouring cells, in h/dt: less keeps slow flow longer"),                           \
        NUMBER("keep", keep, 0.05, FROM_TO(0, 1), NO_UNIT,                                                             \
               "part of its energy that a cell may lose in a step beyond p dV")
static const struct param implicit_param[] = {BED_PARAMS(4)}, automatic_param[] = {BED_PARAMS(8)};
#undef PARAM_STRUCT
OWN_PARAMS_FIT(struct acoustics_params);

const struct acoustics acoustics_table[] = {
    {MODEL("explicit", "sound limits the time step everywhere"), false, false},
    {MODEL_WITH("implicit", "dense gas takes implicit acoustic steps, as long as the flow allows", implicit_param),
     true, false},
    {MODEL_WITH(
         "automatic",
         "implicit steps of beds that thresholdSpeed lets rest, where cooling does not hold them; else explicit ones",
         automatic_param),
     true, true},
};
const int acoustics_count = sizeof acoustics_table / sizeof *acoustics_table;

const struct acoustics *acoustics_find(const char *name) {
    return model_find(acoustics_table, sizeof *acoustics_table, acoustics_count, name);
}

struct acoustics_params acoustics_params(const struct own_params *own) {
    struct acoustics_params p;
    memcpy(&p, own, sizeof p);
    return p;
}
