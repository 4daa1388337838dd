/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solvers/dict/expr.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 1100, KINDS = 8 }; /* enough points for values to be kept by argument */

/* An expression has the same bits at a point, alone or among many. */
static void try_many(const struct expr *e) {
    static const double some[KINDS] = {0.5, -2, 1e300, 0, -0.0, 1, INFINITY, NAN};
    double x[POINTS][3], out[POINTS];
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++) x[i][k] = some[(i >> k) % KINDS];
    expr_values(e, POINTS, x[0], 3, out);
    for (int i = 0; i < POINTS; i++) {
        const double one = expr_value(e, x[i][0], x[i][1], x[i][2], 3);
        PROMISE(!memcmp(&one, &out[i], sizeof one) || (isnan(one) && isnan(out[i])),
                "an expression has one value at a point, alone or not");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    struct expr *e;
    double v;
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = 0;
    if (accepted(expr_compile(text, &e))) {
        try_many(e);
        expr_free(e);
    }
    for (int component = -1; component < 3; component++)
        if (accepted(expr_compile_foam(text, component, &e))) {
            (void)expr_value(e, 0.5, -2, 1e300, 3);
            expr_free(e);
        }
    if (accepted(expr_constant(text, &v))) PROMISE(isfinite(v), "a constant is finite");
    free(text);
    return 0;
}
