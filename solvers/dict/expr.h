/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arithmetic expressions in x, y, z, t, for `#eval` and initial fields. They are compiled once and evaluated often; no
 * code is executed. */
#ifndef SOLVERS_EXPR_H
#define SOLVERS_EXPR_H

#include "mesh/base/status.h"

struct expr;
/* Compiles an expression. Known are + - * / % ^ comparison && || ! ?: ( ) numbers, pi e, x y z t, and exp log log10
 * sqr sqrt cbrt sin cos tan asin acos atan atan2 sinh cosh tanh pow min max abs mag floor ceil round sign pos neg mod
 * hypot.
 * Depth and length are bounded. The error names the column, what was found, what is known. */
status expr_compile(const char *text, struct expr **out);
void expr_free(struct expr *e);
double expr_value(const struct expr *e, double x, double y, double z, double t);
/* Sets out[n] to the values at the points x[n][3] (m), with the bits of expr_value, some ten times as fast. */
void expr_values(const struct expr *e, long n, const double *x, double t, double *out);
/* Compiles one component (0 .. 2) of an expression for a vector, or an expression for a scalar (component -1), in the
 * part of OpenFOAM's grammar that exprFixedValue needs here: pos() and its .x() .y() .z(), time(), pi(), vector(a, b,
 * c), numbers, the functions above, + - * / % comparison && || ! ?: ( ). A vector may be added to one and multiplied by
 * scalars. */
status expr_compile_foam(const char *text, int component, struct expr **out);
/* Compile and evaluate expressions with two more variables, phi and shearRate. */
enum { EXPR_PHI = 4, EXPR_SHEAR_RATE };
status expr_compile_mixture(const char *text, struct expr **out);
double expr_value_mixture(const struct expr *e, double x, double y, double z, double t, double phi, double shear_rate);
bool expr_uses(const struct expr *e, int variable);
status expr_constant(const char *text, double *out); /* fails if text has variables */

#endif
