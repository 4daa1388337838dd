/* A layer of grains at the start: the dictionaries `settledLayer` and `perturbation` in 0/alpha or 0/rho of
 * granularGas.
 *
 *   settledLayer { depth 6; packing 0.82; hydrostatic yes; background 1e-6; }
 *   perturbation { modes 20; amplitude 1e-3; seed 1; of density; axis x; }
 *
 * The layer lies on the side of the box that gravity points to and holds depth * diameter * packing of grains per area,
 * to round-off. `hydrostatic`: alpha falls with height as dp/dh = -rho g wants it at the case's (uniform) T, by the
 * model's own equation of state; otherwise it is uniform at `laidAt`. Cells hold means over their height. The waves,
 * 1 + amplitude sum_k sin(2 pi (k x/L + phase_k)), multiply the density, or the mass of each column (`of depth`: then
 * the perturbed layer is in equilibrium, too). The work is done on polyhedral cells, for every engine alike. */
#ifndef SOLVERS_LAYERS_H
#define SOLVERS_LAYERS_H

#include "libcore/gas/gas.h"
#include "solvers/case/fields.h"
#include <stdio.h>

struct layers;
/* Reads a field of the gas as field_read does. Files of rho and alpha may have the dictionaries of layers: *layers is
 * what they say, which is not yet in the field's values (field->plan) and may not outlive the field; NULL: there are
 * none. */
status layers_read_field(const char *path, enum field_id id, const struct field_place *place, struct layers **layers,
                         struct field **field);
void layers_free(struct layers *l);
void layers_list(FILE *f); /* keys, defaults, ranges */

/* f (rho or alpha, whose file said l) gets its cells' values; T: of the cells, NULL where the case gives p. */
status layers_apply(const struct layers *l, struct field *f, const struct field_place *place, int dim,
                    const int axis[3], const struct gas_models *models, const struct field *T);

/* Isothermal layer in equilibrium: mass w per area (kg/m^2) above the height h. */
struct column;
/* For masses up to `most` per area below the height `lid`, at temperature T under g > 0. */
status column_make(const struct gas_models *models, double g, double T, double most, double lid, struct column **out);
void column_free(struct column *c);
/* What lies above h when `bottom` lies above the floor. */
double column_above(const struct column *c, double bottom, double h);
/* The `bottom` (what lies above the lid included) of a column with `mass` between floor and lid. */
double column_bottom(const struct column *c, double mass);

#endif
