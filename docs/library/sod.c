/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shock tube of granular gas by libhaff: dense gas on the left, thin gas on the right, grains that lose energy at
 * collisions. Prints the packing fraction along the tube. Also runs on ranks: mpirun -np 2 sod. */
#include "libcore/gas/gas.h"
#include "mesh/lattice/box.h"

#include <stdio.h>

enum { CELLS = 200 };

static status run(const struct comm *c, double end) {
    struct box box;
    struct forest *forest;
    struct gas *gas;
    const struct rule out = {.type = boundary_find("zeroGradient")};
    const struct patch_rules end_of = {.density = out, .velocity = out, .temperature = out}, ends[2] = {end_of, end_of};
    const struct gas_models models = {
        .material = {.diameter = 0.01, .mass = 1, .restitution = 0.97, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux_find("common"),
        .reconstruct = reconstruct_find("WENO5"),
        .stepper = stepper_find("SSPRK3"),
        .source.cooling = cooling_find("Haff")};
    TRY(box_make(&box, 1, (int[3]){CELLS}, (double[3]){1}, (bool[3]){false}));
    TRY(forest_make(&box.lattice, &box.mesh, c, 50, &forest));
    TRY(gas_make(forest, &models, 2, ends, &gas));
    double rho[CELLS], u[CELLS], T[CELLS], alpha[CELLS], t = 0;
    for (int i = 0; i < CELLS; i++) { /* alpha = 0.3 and 0.03 */
        rho[i] = (i < CELLS / 2 ? 0.3 : 0.03) / packing_per_density(&models.material);
        u[i] = 0, T[i] = 1;
    }
    TRY(gas_set(gas, rho, (const double *const[3]){u}, T));
    while (t < end) {
        struct gas_speed speed;
        gas_speed(gas, &speed);
        double dt = fmin(0.5 / speed.rate, end - t);
        TRY(gas_step(gas, t, &dt, 0.5, 0, 1e-3, &speed));
        t += dt;
    }
    TRY(gas_field(gas, GAS_ALPHA, (double *const[3]){alpha}));
    for (int i = 5; comm_root(c) && i < CELLS; i += 10) printf("%.4f %.6f\n", (i + 0.5) / CELLS, alpha[i]);
    gas_free(gas);
    forest_free(forest);
    box_free(&box);
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    if (!s) s = run(c, 0.1);
    const int code = status_print(s, false);
    status_free(s);
    comm_finish(c);
    return code;
}
