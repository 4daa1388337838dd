/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiles arithmetic expressions by recursive descent to steps of a stack machine (expr.h). */
#include "solvers/dict/expr_private.h"

#include "mesh/format/foamfile.h"
#include "solvers/dict/dict.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH = 64, LENGTH = 4096 };

struct compiler {
    const char *text, *p;
    int depth, stack;
    bool mixture;  /* are phi and shearRate known? */
    bool foam;     /* is it OpenFOAM's grammar? */
    int component; /* of the vector that the expression gives; -1: it gives a scalar */
    bool vector;   /* is what was compiled last a vector? */
    struct expr *e;
};

static void blanks(struct compiler *c) {
    while (isspace((unsigned char)*c->p)) c->p++;
}

static status complain(const struct compiler *c, const char *what) {
    int length = 0;
    while (isalnum((unsigned char)c->p[length]) || c->p[length] == '_') length++;
    if (!length && *c->p) length = 1;
    return fail(ERR_INPUT, "expression '%.200s', column %d: found '%.*s'; %s", c->text, (int)(c->p - c->text) + 1,
                length, length ? c->p : "", what);
}

static status emit(struct compiler *c, struct step step) {
    static const int change[] = {[NUMBER] = 1, [VARIABLE] = 1, [CALL1] = 0, [CALL2] = -1, [SELECT] = -2};
    c->stack += change[step.op];
    if (c->stack > EXPR_STACK) return complain(c, "the expression is nested too deeply");
    c->e->step[c->e->count++] = step;
    return OK;
}

static const char *const mixture_names[] = {"phi", "shearRate"};

static status ternary(struct compiler *c);

static status bracket(struct compiler *c, char which, const char *what) {
    blanks(c);
    if (*c->p != which) return complain(c, what);
    c->p++;
    return OK;
}

/* Compiles what must be a scalar. */
static status scalar(struct compiler *c) {
    TRY(ternary(c));
    return c->vector ? complain(c, "what stands before it is a vector; a scalar is wanted: .x(), .y() or .z() of pos()")
                     : OK;
}

static status call(struct compiler *c, const struct expr_function *f) {
    TRY(bracket(c, '(', "expected '(' after the name of a function"));
    TRY(scalar(c));
    if (f->what.two) {
        TRY(bracket(c, ',', "expected ',' and a second argument"));
        TRY(scalar(c));
    }
    TRY(bracket(c, ')', f->what.two ? "expected ')' after two arguments" : "expected ')' after one argument"));
    return emit(c, (struct step){.op = f->what.two ? CALL2 : CALL1, .what = &f->what});
}

/* ---- OpenFOAM's grammar ---- */

static const char foam_known[] = "known are pos().x() pos().y() pos().z() time() pi() vector(a, b, c) and functions "
                                 "like sin, sqr, pow, min";

/* Moves behind `text` if the input goes on with it, blanks aside; returns whether it does. */
static bool follows(struct compiler *c, const char *text) {
    const char *p = c->p;
    for (; *text; text++) {
        while (isspace((unsigned char)*p)) p++;
        if (*p++ != *text) return false;
    }
    c->p = p;
    return true;
}

/* vector(a, b, c): of the three only the component that is wanted stays. */
static status foam_vector(struct compiler *c) {
    if (c->component < 0) return complain(c, "this is a vector; the field is a scalar");
    c->p += 6;
    TRY(bracket(c, '(', "expected vector(a, b, c)"));
    for (int i = 0; i < 3; i++) {
        const int count = c->e->count, stack = c->stack;
        TRY(scalar(c));
        if (i != c->component) {
            c->e->count = count;
            c->stack = stack;
        }
        TRY(bracket(c, i < 2 ? ',' : ')', "expected vector(a, b, c)"));
    }
    c->vector = true;
    return OK;
}

/* pos() is the place of a face, pos().x() a component of it. */
static status foam_place(struct compiler *c) {
    static const char *const component[] = {".x()", ".y()", ".z()"};
    for (int i = 0; i < 3; i++)
        if (follows(c, component[i])) return emit(c, (struct step){.op = VARIABLE, .variable = i});
    if (c->component < 0) return complain(c, "pos() is a vector; the field is a scalar: pos().x()");
    c->vector = true;
    return emit(c, (struct step){.op = VARIABLE, .variable = c->component});
}

/* Compiles a name that only OpenFOAM's grammar has; *done: it was one. */
static status foam_name(struct compiler *c, int length, bool *done) {
    const struct step pi = {.op = NUMBER, .number = acos(-1)}, time = {.op = VARIABLE, .variable = 3};
    const bool is_pos = length == 3 && !memcmp(c->p, "pos", 3), single = length == 1 && strchr("xyzte", *c->p);
    *done = true;
    if (length == 6 && !memcmp(c->p, "vector", 6)) return foam_vector(c);
    if (is_pos && follows(c, "pos()")) return foam_place(c);
    if (length == 4 && follows(c, "time()")) return emit(c, time);
    if (length == 2 && follows(c, "pi()")) return emit(c, pi);
    if (single || (length == 2 && !memcmp(c->p, "pi", 2))) return complain(c, foam_known);
    *done = false;
    return OK;
}

/* Finds the type, scalar or vector, of the result of an operator on two operands. */
static status foam_types(struct compiler *c, const char *operator, bool left) {
    const bool right = c->vector;
    const char which = operator[1] ? 'c' : * operator;
    if (!left && !right) return OK;
    c->vector = true;
    if ((which == '+' || which == '-') && left && right) return OK;
    if ((which == '*' && left != right) || (which == '/' && left && !right)) return OK;
    return complain(c, "before it, a vector stands where OpenFOAM's grammar here has none: vectors are added to "
                       "vectors, and multiplied or divided by scalars");
}

static status name(struct compiler *c) {
    int length = 0;
    while (isalnum((unsigned char)c->p[length]) || c->p[length] == '_') length++;
    const char *word = c->p, *variable = length == 1 ? strchr("xyzt", *word) : NULL;
    bool done = false;
    if (c->foam) TRY(foam_name(c, length, &done));
    if (done) return OK;
    struct step step = {.op = NUMBER, .number = acos(-1)};
    for (int i = 0; c->mixture && i < 2; i++)
        if (strlen(mixture_names[i]) == (size_t)length && !memcmp(word, mixture_names[i], (size_t)length)) {
            c->p += length;
            return emit(c, (struct step){.op = VARIABLE, .variable = EXPR_PHI + i});
        }
    if (variable) step = (struct step){.op = VARIABLE, .variable = *word == 't' ? 3 : *word - 'x'};
    if (length == 1 && *word == 'e') step.number = exp(1);
    if (variable || (length == 1 && *word == 'e') || (length == 2 && !memcmp(word, "pi", 2))) {
        c->p += length;
        return emit(c, step);
    }
    for (int i = 0; i < EXPR_FUNCTIONS; i++)
        if (strlen(expr_functions[i].name) == (size_t)length && !memcmp(expr_functions[i].name, word, (size_t)length)) {
            c->p += length;
            return call(c, &expr_functions[i]);
        }
    const char *names[EXPR_FUNCTIONS + 2];
    char text[32];
    int n = 0;
    for (; n < EXPR_FUNCTIONS; n++) names[n] = expr_functions[n].name;
    for (int i = 0; c->mixture && i < 2; i++) names[n++] = mixture_names[i];
    snprintf(text, sizeof text, "%.*s", length, word);
    char meant[MEANT];
    if (length > 2 && *name_question(text, names, n, meant)) return complain(c, meant + strlen("; "));
    if (c->foam) return complain(c, foam_known);
    return complain(
        c, "known are x y z t pi e exp log log10 sqr sqrt cbrt sin cos tan asin acos atan atan2 sinh cosh tanh pow "
           "min max abs mag floor ceil round sign pos neg mod hypot degToRad radToDeg");
}

/* Reads a number: foam_number wants a blank or bracket behind it, but here an operator may follow. */
static status number(struct compiler *c) {
    char copy[64];
    int n = 0;
    const char *p = c->p;
    for (; n < 63 && (isdigit((unsigned char)*p) || *p == '.' ||
                      ((*p == 'e' || *p == 'E') && (isdigit((unsigned char)p[1]) ||
                                                    ((p[1] == '+' || p[1] == '-') && isdigit((unsigned char)p[2])))) ||
                      ((*p == '+' || *p == '-') && n && (p[-1] == 'e' || p[-1] == 'E')));
         p++)
        copy[n++] = *p;
    copy[n] = 0;
    double v;
    if (!foam_number(copy, &v) || !isfinite(v) || isalpha((unsigned char)*p)) return complain(c, "this is no number");
    c->p = p;
    return emit(c, (struct step){.op = NUMBER, .number = v});
}

static status unary(struct compiler *c);

static status primary(struct compiler *c) {
    blanks(c);
    c->vector = false;
    if (*c->p == '(') {
        c->p++;
        TRY(ternary(c));
        TRY(bracket(c, ')', "expected ')'"));
    } else if (isdigit((unsigned char)*c->p) || *c->p == '.') {
        TRY(number(c));
    } else if (isalpha((unsigned char)*c->p)) {
        TRY(name(c));
    } else {
        return complain(c, "expected a number, a name or '('");
    }
    blanks(c);
    if (*c->p != '^') return OK;
    if (c->foam) return complain(c, "OpenFOAM's grammar has pow(a, b)");
    c->p++;
    TRY(unary(c));
    return emit(c, (struct step){.op = CALL2, .what = &expr_power});
}

static status unary(struct compiler *c) {
    if (++c->depth > DEPTH) return complain(c, "the expression is nested too deeply");
    blanks(c);
    char sign_ = *c->p;
    if (sign_ == '-' || sign_ == '+' || sign_ == '!') {
        c->p++;
        TRY(unary(c));
        if (sign_ == '!' && c->vector) return complain(c, "what stands before it is a vector");
        if (sign_ != '+') TRY(emit(c, (struct step){.op = CALL1, .what = sign_ == '-' ? &expr_minus : &expr_not}));
    } else {
        TRY(primary(c));
    }
    c->depth--;
    return OK;
}

static const struct infix *find_operator(const char *p, int rank) {
    for (int i = 0; i < EXPR_OPERATORS; i++)
        if (!strncmp(p, expr_operators[i].name, strlen(expr_operators[i].name)))
            return expr_operators[i].rank == rank ? &expr_operators[i] : NULL;
    return NULL;
}

static status binary(struct compiler *c, int rank) {
    if (rank == EXPR_RANKS) return unary(c);
    TRY(binary(c, rank + 1));
    for (;;) {
        blanks(c);
        const struct infix *o = find_operator(c->p, rank);
        if (!o) return OK;
        const bool left = c->vector;
        c->p += strlen(o->name);
        TRY(binary(c, rank + 1));
        TRY(foam_types(c, o->name, left));
        TRY(emit(c, (struct step){.op = CALL2, .what = &o->what}));
    }
}

static status ternary(struct compiler *c) {
    if (++c->depth > DEPTH) return complain(c, "the expression is nested too deeply");
    TRY(binary(c, 0));
    blanks(c);
    if (*c->p == '?') {
        if (c->vector) return complain(c, "what stands before it is a vector");
        c->p++;
        TRY(ternary(c));
        const bool first = c->vector;
        TRY(bracket(c, ':', "expected ':' of '?'"));
        TRY(ternary(c));
        if (c->vector != first) return complain(c, "one branch of '?' is a vector, the other a scalar");
        TRY(emit(c, (struct step){.op = SELECT}));
    }
    c->depth--;
    return OK;
}

static status compile(const char *text, struct compiler c, struct expr **out) {
    *out = NULL;
    size_t length = strlen(text);
    if (length > LENGTH) return fail(ERR_INPUT, "expression '%.60s...' is longer than %d characters", text, LENGTH);
    c.text = c.p = text;
    c.e = calloc(1, sizeof *c.e + (length + 1) * sizeof *c.e->step); /* a step takes one character or more */
    if (!c.e) return fail(ERR_SYSTEM, "no memory for an expression");
    status e = ternary(&c);
    blanks(&c);
    if (!e && *c.p) e = complain(&c, "expected an operator or the end");
    if (!e && c.foam && c.component >= 0 && !c.vector)
        e = fail(ERR_INPUT, "expression '%.200s' gives a scalar; the field is a vector: vector(a, b, c)", text);
    if (e) {
        free(c.e);
        return e;
    }
    *out = c.e;
    return OK;
}

status expr_compile(const char *text, struct expr **out) {
    return compile(text, (struct compiler){.component = -1}, out);
}
status expr_compile_mixture(const char *text, struct expr **out) {
    return compile(text, (struct compiler){.mixture = true, .component = -1}, out);
}
status expr_compile_foam(const char *text, int component, struct expr **out) {
    return compile(text, (struct compiler){.foam = true, .component = component}, out);
}

void expr_free(struct expr *e) {
    free(e);
}

bool expr_uses(const struct expr *e, int variable) {
    for (int i = 0; i < e->count; i++)
        if (e->step[i].op == VARIABLE && e->step[i].variable == variable) return true;
    return false;
}

status expr_constant(const char *text, double *out) {
    struct expr *e;
    TRY(expr_compile(text, &e));
    bool constant = true;
    for (int i = 0; i < e->count; i++) constant = constant && e->step[i].op != VARIABLE;
    if (constant) *out = expr_value(e, 0, 0, 0, 0);
    expr_free(e);
    if (!constant) return fail(ERR_INPUT, "expression '%.200s' has x, y, z or t; here it must be constant", text);
    if (!isfinite(*out)) return fail(ERR_INPUT, "expression '%.200s' gives %g", text, *out);
    return OK;
}
