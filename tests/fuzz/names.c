/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names that carried quantities may not have, for the readers; the table itself would bring the writers of fields.
 * A target that has these writers has the table, too: so this one is weak. */
#include "solvers/gas/quantities.h"

__attribute__((weak))
const struct quantity gas_quantity[GAS_QUANTITIES] = {[GAS_RHO] = {.name = "rho"}, [GAS_U] = {.name = "U"}};
