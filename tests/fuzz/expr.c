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
        double a = expr_value(e, 0.5, -2, 1e300, 3), b = expr_value(e, 0.5, -2, 1e300, 3);
        PROMISE(a == b || (isnan(a) && isnan(b)), "an expression has one value");
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
