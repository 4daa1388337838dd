/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the functions and operators of expressions compute, of one point and of many (expr.h).
 *
 * Many points are taken in portions: each step of the stack machine is a loop over a portion, and a single operation
 * where its operands are the same at all points. Either way the operations of a point are those of expr_value, so its
 * value has the same bits. */
#include "solvers/dict/expr_private.h"

#include "libcore/models/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- functions and operators ---- */

/* Defines a function of one or two numbers, and that of lines of them. */
#define ONE(name, value)                                                                                               \
    static double name(double a) {                                                                                     \
        return value;                                                                                                  \
    }                                                                                                                  \
    static void name##_line(int n, const double *p, double *out) {                                                     \
        EACH_ALONE for (int i = 0; i < n; i++) {                                                                       \
            const double a = p[i];                                                                                     \
            out[i] = value;                                                                                            \
        }                                                                                                              \
    }
#define TWO(name, value)                                                                                               \
    static double name(double a, double b) {                                                                           \
        return value;                                                                                                  \
    }                                                                                                                  \
    static void name##_lines(int n, const double *p, const double *q, double *out) {                                   \
        EACH_ALONE for (int i = 0; i < n; i++) {                                                                       \
            const double a = p[i], b = q[i];                                                                           \
            out[i] = value;                                                                                            \
        }                                                                                                              \
    }
TWO(add, a + b)
TWO(subtract, a - b)
TWO(multiply, a *b)
TWO(divide, a / b)
TWO(less, a < b)
TWO(greater, a > b)
TWO(at_most, a <= b)
TWO(at_least, a >= b)
TWO(equal, a == b)
TWO(differs, a != b)
TWO(both, a != 0 && b != 0)
TWO(either, a != 0 || b != 0)
TWO(least, a < b ? a : b)
TWO(most, a > b ? a : b)
ONE(negate, -a)
ONE(invert, a == 0)
ONE(sign, a >= 0 ? 1 : -1)
ONE(pos, a > 0)
ONE(neg, a < 0)
ONE(root, sqrt(a))
ONE(absolute, fabs(a))
ONE(square, a *a)
ONE(to_radians, a * 3.14159265358979323846 / 180)
ONE(to_degrees, a * 180 / 3.14159265358979323846)
#define OF_ONE(name)                                                                                                   \
    { .one = name, .line = name##_line }
#define OF_TWO(name)                                                                                                   \
    { .two = name, .lines = name##_lines }

const struct expr_function expr_functions[EXPR_FUNCTIONS] = {
    {"exp", {.one = exp}},
    {"log", {.one = log}},
    {"log10", {.one = log10}},
    {"sqrt", OF_ONE(root)},
    {"cbrt", {.one = cbrt}},
    {"sin", {.one = sin}},
    {"cos", {.one = cos}},
    {"tan", {.one = tan}},
    {"asin", {.one = asin}},
    {"acos", {.one = acos}},
    {"atan", {.one = atan}},
    {"sinh", {.one = sinh}},
    {"cosh", {.one = cosh}},
    {"tanh", {.one = tanh}},
    {"abs", OF_ONE(absolute)},
    {"floor", {.one = floor}},
    {"ceil", {.one = ceil}},
    {"round", {.one = round}},
    {"sign", OF_ONE(sign)},
    {"pos", OF_ONE(pos)},
    {"neg", OF_ONE(neg)},
    {"atan2", {.two = atan2}},
    {"pow", {.two = pow}},
    {"min", OF_TWO(least)},
    {"max", OF_TWO(most)},
    {"mod", {.two = fmod}},
    {"hypot", {.two = hypot}},
    {"sqr", OF_ONE(square)},
    {"mag", OF_ONE(absolute)},
    {"degToRad", OF_ONE(to_radians)},
    {"radToDeg", OF_ONE(to_degrees)},
};

const struct infix expr_operators[EXPR_OPERATORS] = {
    {"||", 0, OF_TWO(either)},  {"&&", 1, OF_TWO(both)},     {"==", 2, OF_TWO(equal)},   {"!=", 2, OF_TWO(differs)},
    {"<=", 2, OF_TWO(at_most)}, {">=", 2, OF_TWO(at_least)}, {"<", 2, OF_TWO(less)},     {">", 2, OF_TWO(greater)},
    {"+", 3, OF_TWO(add)},      {"-", 3, OF_TWO(subtract)},  {"*", 4, OF_TWO(multiply)}, {"/", 4, OF_TWO(divide)},
    {"%", 4, {.two = fmod}},
};
const struct expr_operation expr_power = {.two = pow}, expr_minus = OF_ONE(negate), expr_not = OF_ONE(invert);

/* ---- at one point ---- */

double expr_value(const struct expr *e, double x, double y, double z, double t) {
    return expr_value_mixture(e, x, y, z, t, 0, 0);
}

double expr_value_mixture(const struct expr *e, double x, double y, double z, double t, double phi, double shear_rate) {
    const double variable[] = {x, y, z, t, phi, shear_rate};
    double stack[EXPR_STACK + 1], *top = stack; /* top: the last value on the stack */
    for (const struct step *s = e->step; s < e->step + e->count; s++) {
        switch (s->op) {
        case NUMBER:
            *++top = s->number;
            break;
        case VARIABLE:
            *++top = variable[s->variable];
            break;
        case CALL1:
            *top = s->what->one(*top);
            break;
        case CALL2:
            top--, *top = s->what->two(top[0], top[1]);
            break;
        case SELECT:
            top -= 2, *top = top[0] != 0 ? top[1] : top[2];
            break;
        }
    }
    return *top;
}

/* ---- at many points ---- */

enum { PORTION = 256, KNOWN_BITS = 9, KNOWN = 1 << KNOWN_BITS };

/* The last values that a function of the C library gave, by argument. On boxes, waves along and across the axes have
 * few arguments: there most values are found, and a cosine costs five times what finding it does. */
struct known_value {
    double argument, value;
};
struct operand { /* of a step, at the points of a portion */
    bool same;   /* at all points: v[0] */
    double v[PORTION];
};

struct portion {
    int n;
    double x[3][PORTION], t; /* m, s */
};

static void spread_out(struct operand *l, int n) {
    const double v = l->v[0];
    if (l->same)
        for (int i = 1; i < n; i++) l->v[i] = v;
    l->same = false;
}

/* Returns the place in known[KNOWN] of the values of an argument. */
static struct known_value *find(struct known_value *known, double argument) {
    return &known[(bits_of(argument) * 0x9e3779b97f4a7c15u) >> (64 - KNOWN_BITS)];
}

static void call_one(const struct expr_operation *o, int n, struct known_value *known, struct operand *a) {
    if (a->same)
        a->v[0] = o->one(a->v[0]);
    else if (o->line)
        o->line(n, a->v, a->v);
    else
        for (int i = 0; i < n; i++) {
            struct known_value none, *k = known ? find(known, a->v[i]) : &none;
            if (!known || bits_of(k->argument) != bits_of(a->v[i])) *k = (struct known_value){a->v[i], o->one(a->v[i])};
            a->v[i] = k->value;
        }
}

/* Calls a function of the library whose second argument is b everywhere. */
static void call_with(double (*two)(double, double), int n, struct known_value *known, double *a, double b) {
    for (int i = 0; i < n; i++) {
        struct known_value *k = find(known, a[i]);
        if (bits_of(k->argument) != bits_of(a[i])) *k = (struct known_value){a[i], two(a[i], b)};
        a[i] = k->value;
    }
}

static void call_two(const struct expr_operation *o, int n, struct known_value *known, struct operand *a,
                     struct operand *b) {
    if (a->same && b->same) {
        a->v[0] = o->two(a->v[0], b->v[0]);
        return;
    }
    spread_out(a, n);
    if (!o->lines && b->same && known) {
        call_with(o->two, n, known, a->v, b->v[0]);
        return;
    }
    spread_out(b, n);
    if (o->lines) o->lines(n, a->v, b->v, a->v);
    for (int i = 0; i < n && !o->lines; i++) a->v[i] = o->two(a->v[i], b->v[i]);
}

static void choose(int n, struct operand *a, struct operand *yes, struct operand *no) {
    spread_out(a, n);
    spread_out(yes, n);
    spread_out(no, n);
    for (int i = 0; i < n; i++) a->v[i] = a->v[i] != 0 ? yes->v[i] : no->v[i];
}

static void put(struct operand *l, double number) {
    l->same = true;
    l->v[0] = number;
}

static void load(struct operand *l, int variable, int n, const struct portion *p) {
    if (variable > 2)
        put(l, variable == 3 ? p->t : 0);
    else
        memcpy(l->v, p->x[variable], (size_t)n * sizeof *l->v);
    l->same = variable > 2;
}

/* Is a step the call of a function of the library? */
static bool calls_library(const struct step *s) {
    return (s->op == CALL1 && !s->what->line) || (s->op == CALL2 && !s->what->lines);
}

static void evaluate_portion(const struct expr *e, const struct portion *p, struct operand *stack,
                             struct known_value *known, double *out) {
    const int n = p->n;
    struct operand *top = stack;
    for (const struct step *s = e->step; s < e->step + e->count; s++) {
        switch (s->op) {
        case NUMBER:
            put(++top, s->number);
            break;
        case VARIABLE:
            load(++top, s->variable, n, p);
            break;
        case CALL1:
            call_one(s->what, n, known, top);
            break;
        case CALL2:
            top--, call_two(s->what, n, known, top, top + 1);
            break;
        case SELECT:
            top -= 2, choose(n, top, top + 1, top + 2);
            break;
        }
        if (known && calls_library(s)) known += KNOWN;
    }
    spread_out(top, n);
    memcpy(out, top->v, (size_t)n * sizeof *out);
}

/* Returns room for the known values of each call of the library, NULL: there is none, or too few points would use it.
 * All arguments in it are 0, which is found in the first place alone; so 1 stands there, which is found elsewhere.
 */
static struct known_value *make_known(const struct expr *e, long points) {
    size_t n = 0;
    for (int i = 0; i < e->count; i++) n += calls_library(&e->step[i]);
    struct known_value *known = points >= 2 * KNOWN && n ? calloc(n * KNOWN, sizeof *known) : NULL;
    for (size_t i = 0; known && i < n; i++) known[i * KNOWN].argument = 1;
    return known;
}

void expr_values(const struct expr *e, long n, const double *x, double t, double *out) {
    struct operand stack[EXPR_STACK + 1];
    struct known_value *known = make_known(e, n);
    struct portion p = {.t = t};
    for (long at = 0; at < n; at += p.n) {
        p.n = n - at < PORTION ? (int)(n - at) : PORTION;
        for (int i = 0; i < p.n; i++)
            for (int k = 0; k < 3; k++) p.x[k][i] = x[3 * (at + i) + k];
        evaluate_portion(e, &p, stack, known, out + at);
    }
    free(known);
}
