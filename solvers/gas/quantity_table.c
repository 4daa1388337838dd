/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quantities of every gas: names, components, dimensions (quantities.h). */
#include "solvers/gas/quantities.h"

const struct quantity gas_quantity[GAS_QUANTITIES] = {
    [GAS_RHO] = {"rho", 1, {1, -3, 0, 0, 0, 0, 0}, true},
    [GAS_ALPHA] = {"alpha", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_U] = {"U", 3, {0, 1, -1, 0, 0, 0, 0}, false},
    [GAS_T] = {"T", 1, {0, 2, -2, 0, 0, 0, 0}, false},
    [GAS_P] = {"p", 1, {1, -1, -2, 0, 0, 0, 0}, false},
    [GAS_C] = {"c", 1, {0, 1, -1, 0, 0, 0, 0}, false},
    [GAS_MACH] = {"Ma", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_LIMITED] = {"limited", 1, {0, 0, 0, 0, 0, 0, 0}, true},
    [GAS_VORTICITY] = {"vorticity", 3, {0, 0, -1, 0, 0, 0, 0}, false},
    [GAS_GRAD_ALPHA] = {"gradAlpha", 3, {0, -1, 0, 0, 0, 0, 0}, false},
    [GAS_KNUDSEN] = {"Kn", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_STRESS_RATIO] = {"stressRatio", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_MOMENTUM] = {"rhoU", 3, {1, -2, -1, 0, 0, 0, 0}, true},
    [GAS_ENERGY] = {"rhoE", 1, {1, -1, -2, 0, 0, 0, 0}, true},
};
const int gas_written[] = {GAS_ALPHA, GAS_U, GAS_T, GAS_P, GAS_LIMITED, GAS_RHO, GAS_MOMENTUM, GAS_ENERGY, -1};
const int gas_shown[] = {GAS_RHO, GAS_ALPHA, GAS_U, GAS_T, GAS_P, -1};
