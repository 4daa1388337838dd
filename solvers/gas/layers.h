/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layer of grains at rest under gravity (docs/physics.md 7.4) at the start, by the dictionaries `settledLayer` and
 * `perturbation` in 0.orig/alpha or rho of granularGas.
 *
 *   settledLayer { depth 6; packing 0.82; hydrostatic yes; background 1e-6; }
 *   perturbation { modes 20; amplitude 1e-3; seed 1; of density; axis x; }
 *
 * The layer lies on the side of the box that gravity points to and holds depth * diameter * packing of grains per area,
 * to round-off. If it is `hydrostatic`, alpha falls with height so that dp/dh = -rho g at the case's T, by the model's
 * own equation of state; otherwise alpha is `laidAt` up to the depth that the mass asks. Where all cells lie in layers,
 * as on every lattice, a hydrostatic layer is at rest by the scheme itself, and T may differ from layer to layer; on
 * other meshes T is uniform and cells hold means over their height. The waves, 1 + amplitude sum_k sin(2 pi (k x/L +
 * phase_k)), multiply the density, or the mass of each column (`of depth`: then the perturbed layer is in equilibrium,
 * too). Layers are computed on the cells of the polyMesh, for every engine alike; polyhedra keep them at rest (rest.h).
 */
#ifndef SOLVERS_LAYERS_H
#define SOLVERS_LAYERS_H

#include "libcore/gas/gas.h"
#include "solvers/case/fields.h"
#include <stdio.h>

struct layers;
/* Reads a field of the gas as field_read does. Files of rho and alpha may have the dictionaries of layers: *layers says
 * what they ask for, which is not yet in the field's values (field->plan); it may not outlive the field. NULL: there
 * are none. */
status layers_read_field(const char *path, enum field_id id, const struct field_place *place, struct layers **layers,
                         struct field **field);
void layers_free(struct layers *l);
/* Takes the waves away; returns whether what remains is at rest: a hydrostatic settledLayer, where alpha is above its
 * *background. l may be NULL. */
bool layers_flatten(struct layers *l, double *background);
void layers_list(FILE *f);                /* prints keys, defaults, ranges */
void layers_keywords(struct keywords *k); /* goes through the same, for the reference */

/* Sets the cells' values of f (rho or alpha, whose file said l). T: the field of T, NULL if the case gives p. */
status layers_apply(const struct layers *l, struct field *f, const struct field_place *place, int dim,
                    const int axis[3], const struct gas_models *models, const struct field *T);

/* An isothermal layer in equilibrium: mass w per area (kg/m^2) above the height h. */
struct column;
/* Makes the curve of masses up to `most` per area below the height `lid` (m), at temperature T (m^2/s^2) under g > 0
 * (m/s^2). */
status column_make(const struct gas_models *models, double g, double T, double most, double lid, struct column **out);
void column_free(struct column *c);
/* Returns the mass per area above h if `bottom` lies above the floor. */
double column_above(const struct column *c, double bottom, double h);
/* Returns the mass per area above the floor, with what lies above the lid, of a column with `mass` between floor and
 * lid. */
double column_bottom(const struct column *c, double mass);

/* Columns of gas at rest by the scheme itself, on a mesh whose cells lie in layers. */
struct resting;
/* thick, T: [layers] m, m^2/s^2, from the floor up; g > 0: m/s^2. */
status resting_make(const struct gas_models *models, double g, int layers, const double *thick, const double *T,
                    struct resting **out);
void resting_free(struct resting *r);
/* Computes rho of n columns that hold mass[n] per area (kg/m^2): column i at out[i layers ..]. */
void resting_columns(const struct resting *r, int n, const double *mass, double *out);

#endif
