/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and prints parameters by their tables (params.h). */
#include "solvers/dict/params.h"

#include <limits.h>
#include <math.h>
#include <string.h>

status param_check_size(const struct dict *d, const char *key, double v) {
    if (v == 0 || (fabs(v) >= LEAST_NUMBER && fabs(v) <= MOST_NUMBER)) return OK;
    return dict_fail(d, key, "a number is 0, or between %g and %g, or minus such a number: is its unit right?",
                     LEAST_NUMBER, MOST_NUMBER);
}

static status check_range(const struct dict *d, const struct param *p, double v) {
    bool inside = p->open ? v > p->low && v < p->high : v >= p->low && v <= p->high;
    if (inside) return param_check_size(d, p->name, v);
    if (isinf(p->high) && isfinite(p->low))
        return fail(ERR_INPUT, "%s:%d: %s is %g; it must be %s %g", dict_path(d), dict_line(d, p->name), p->name, v,
                    p->open ? "greater than" : "at least", p->low);
    const char *edges = p->open ? " (both excluded)" : "";
    return fail(ERR_INPUT, "%s:%d: %s is %g; allowed is %g .. %g%s", dict_path(d), dict_line(d, p->name), p->name, v,
                p->low, p->high, edges);
}

static int count_words(const struct param *p) {
    int n = 0;
    while (p->words[n]) n++;
    return n;
}

static status missing(struct dict *d, const struct param *p) {
    double none;
    int index;
    /* the error of reading says where the key is missing and how it may be misspelt */
    status cause =
        p->words ? dict_choice(d, p->name, p->words, count_words(p), &index) : dict_number(d, p->name, p->unit, &none);
    status s = fail(ERR_INPUT, "%s (%s)", status_text(cause), p->meaning);
    status_free(cause);
    return s;
}

static status read_choice(struct dict *d, const struct param *p, bool given, void *member) {
    int index = given ? 0 : (int)p->standard;
    if (given) TRY(dict_choice(d, p->name, p->words, count_words(p), &index));
    const bool odd = index % 2;
    if (p->kind == PARAM_EITHER) memcpy(member, &odd, sizeof odd);
    if (p->kind == PARAM_CHOICE) memcpy(member, &index, sizeof index);
    return OK;
}

/* Makes the key, and all below it, known: it is for other programs. */
static status ignore(struct dict *d, const struct param *p) {
    struct dict *sub = NULL;
    status not_a_dictionary = dict_sub_optional(d, p->name, &sub);
    status_free(not_a_dictionary);
    if (sub) dict_mark_used(sub);
    return OK;
}

static status read_one(struct dict *d, const struct param *p, void *member) {
    if (p->kind == PARAM_NOTED) return OK;
    if (p->kind == PARAM_IGNORED) return ignore(d, p);
    const bool given = dict_has(d, p->name);
    double v[3] = {p->standard, p->standard, p->standard};
    if (!given && isnan(p->standard)) return missing(d, p);
    if (p->words) return read_choice(d, p, given, member);
    if (p->kind == PARAM_SWITCH) return dict_switch_or(d, p->name, p->standard != 0, member);
    if (given && p->kind == PARAM_VECTOR)
        TRY(dict_vector(d, p->name, p->unit, v));
    else if (given)
        TRY(dict_number(d, p->name, p->unit, v));
    int components = p->kind == PARAM_VECTOR ? 3 : 1;
    for (int i = 0; given && i < components; i++) TRY(check_range(d, p, v[i]));
    if (p->kind == PARAM_WHOLE) {
        if (v[0] != floor(v[0]) || fabs(v[0]) > INT_MAX) return dict_fail(d, p->name, "expected a whole number");
        int n = (int)v[0];
        memcpy(member, &n, sizeof n);
    } else {
        memcpy(member, v, (size_t)components * sizeof *v);
    }
    return OK;
}

status params_read(struct dict *d, const struct param *table, int n, void *base) {
    for (int i = 0; i < n; i++) TRY(read_one(d, &table[i], (char *)base + table[i].offset));
    return OK;
}

void param_unit(char text[64], const signed char unit[3]) {
    static const char *const names[] = {"kg", "m", "s"};
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < 3; k++) {
        if (!unit[k]) continue;
        used += (size_t)snprintf(text + used, 64 - used, "%s%s", used ? " " : "", names[k]);
        if (unit[k] != 1) used += (size_t)snprintf(text + used, 64 - used, "^%d", unit[k]);
    }
    if (!used) snprintf(text, 64, "-");
}

/* Lists the words of a choice but the one that is chosen where the key is missing: "or paper". */
static void print_words(const struct param *p, int standard, char *text, size_t size) {
    const char *before = standard < 0 ? "" : "or ";
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; p->words[i] && used < size; i++) {
        if (i == standard) continue;
        used += (size_t)snprintf(text + used, size - used, "%s%s", before, p->words[i]);
        before = ", ";
    }
}

/* Writes the default and the values that are allowed. */
static void print_allowed(const struct param *p, char standard[32], char allowed[128]) {
    const int chosen = isnan(p->standard) ? -1 : (int)fmax(-1, fmin(p->standard, INT_MAX));
    snprintf(standard, 32, "%g", p->standard);
    snprintf(allowed, 128, p->open ? "%g < .. < %g" : "%g .. %g", p->low, p->high);
    if (p->kind == PARAM_SWITCH) {
        snprintf(standard, 32, "%s", chosen ? "on" : "off");
        snprintf(allowed, 128, "on, off");
    } else if (p->words) {
        snprintf(standard, 32, "%s", chosen < 0 ? "-" : p->words[chosen]);
        print_words(p, chosen, allowed, 128);
    }
    if (p->usual) snprintf(standard, 32, "%s", p->usual);
    if (isnan(p->standard)) snprintf(standard, 32, "required");
}

bool param_fills(const struct param *p) {
    return p->kind < PARAM_ONLY;
}

void params_print(FILE *f, const struct param *table, int n) {
    for (int i = 0; i < n; i++) {
        const struct param *p = &table[i];
        if (!param_fills(p)) continue;
        char unit[64], standard[32], allowed[128];
        param_unit(unit, p->unit);
        print_allowed(p, standard, allowed);
        fprintf(f, "    %-20s %-10s %-16s %-10s %s\n", p->name, standard, allowed, unit, p->meaning);
    }
}

void param_value(char text[PARAM_VALUE], const struct param *p, const void *base) {
    const char *member = (const char *)base + p->offset;
    double v[3] = {0, 0, 0};
    int whole = 0;
    bool on = false;
    if (p->kind == PARAM_NUMBER || p->kind == PARAM_VECTOR)
        memcpy(v, member, (p->kind == PARAM_VECTOR ? 3 : 1) * sizeof *v);
    else if (p->kind == PARAM_SWITCH || p->kind == PARAM_EITHER)
        memcpy(&on, member, sizeof on);
    else
        memcpy(&whole, member, sizeof whole);
    if (p->kind == PARAM_NUMBER) snprintf(text, PARAM_VALUE, "%.10g", v[0]);
    if (p->kind == PARAM_WHOLE) snprintf(text, PARAM_VALUE, "%d", whole);
    if (p->kind == PARAM_SWITCH) snprintf(text, PARAM_VALUE, "%s", on ? "yes" : "no");
    if (p->kind == PARAM_VECTOR) snprintf(text, PARAM_VALUE, "(%.10g %.10g %.10g)", v[0], v[1], v[2]);
    if (p->kind == PARAM_CHOICE) snprintf(text, PARAM_VALUE, "%s", whole < 0 ? "-" : p->words[whole]);
    if (p->kind == PARAM_EITHER) snprintf(text, PARAM_VALUE, "%s", p->words[on]);
}

void params_print_values(FILE *f, const struct param *table, int n, const void *base) {
    char value[PARAM_VALUE];
    for (int i = 0; i < n; i++) {
        if (!param_fills(&table[i])) continue;
        param_value(value, &table[i], base);
        fprintf(f, "    %-22s %s\n", table[i].name, value);
    }
}
