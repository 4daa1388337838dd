/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solvers/dict/expr.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    struct expr *e;
    double v;
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = 0;
    if (accepted(expr_compile(text, &e))) {
        const double a = expr_value(e, 0.5, -2, 1e300, 3), x[] = {1, 2, 3, 0.5, -2, 1e300};
        double b[2];
        expr_values(e, 2, x, 3, b);
        PROMISE(a == b[1] || (isnan(a) && isnan(b[1])), "an expression has one value at a point, alone or not");
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
