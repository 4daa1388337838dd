/* Arithmetic expressions in x, y, z, t: `#eval`, initial fields. Compiled once, evaluated often; no code execution. */
#ifndef SOLVERS_EXPR_H
#define SOLVERS_EXPR_H

#include "mesh/base/status.h"

struct expr;
/* + - * / % ^ comparison && || ! ?: ( ) numbers, pi e, x y z t, and exp log log10 sqrt cbrt sin cos tan asin acos atan
 * atan2 sinh cosh tanh pow min max abs floor ceil round sign pos neg mod hypot. Depth and length are bounded. */
status expr_compile(const char *text, struct expr **out); /* error: column, what was found, what is known */
void expr_free(struct expr *e);
double expr_value(const struct expr *e, double x, double y, double z, double t);
/* With two more variables, phi and shearRate. */
enum { EXPR_PHI = 4, EXPR_SHEAR_RATE };
status expr_compile_mixture(const char *text, struct expr **out);
double expr_value_mixture(const struct expr *e, double x, double y, double z, double t, double phi, double shear_rate);
bool expr_uses(const struct expr *e, int variable);
status expr_constant(const char *text, double *out); /* no variables allowed */

#endif
