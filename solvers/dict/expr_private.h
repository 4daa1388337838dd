/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a compiled expression, which expr.c makes and expr_values.c evaluates. */
#ifndef SOLVERS_EXPR_PRIVATE_H
#define SOLVERS_EXPR_PRIVATE_H

#include "solvers/dict/expr.h"

enum { EXPR_STACK = 64, EXPR_RANKS = 5, EXPR_FUNCTIONS = 31, EXPR_OPERATORS = 13 };

/* A function of one or two numbers, and the same function of n of them. */
struct expr_operation {
    double (*one)(double);
    double (*two)(double, double);
    void (*line)(int n, const double *a, double *out); /* NULL: a function of the C library */
    void (*lines)(int n, const double *a, const double *b, double *out);
};
enum op { NUMBER, VARIABLE, CALL1, CALL2, SELECT };
struct step {
    enum op op;
    int variable;
    double number;
    const struct expr_operation *what;
};
struct expr {
    int count;
    struct step step[];
};

struct expr_function {
    const char *name;
    struct expr_operation what;
};
struct infix {
    const char *name;
    int rank;
    struct expr_operation what;
};
extern const struct expr_function expr_functions[EXPR_FUNCTIONS];
/* Binary operators by rank; all but ^ group to the left. Longer names stand first. */
extern const struct infix expr_operators[EXPR_OPERATORS];
extern const struct expr_operation expr_power, expr_minus, expr_not;

#endif
