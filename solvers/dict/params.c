#include "solvers/dict/params.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static status check_range(const struct dict *d, const struct param *p, double v) {
    bool inside = p->open ? v > p->low && v < p->high : v >= p->low && v <= p->high;
    if (inside) return OK;
    if (isinf(p->high) && isfinite(p->low))
        return fail(ERR_INPUT, "%s:%d: %s is %g; it must be %s %g", dict_path(d), dict_line(d, p->name), p->name, v,
                    p->open ? "greater than" : "at least", p->low);
    const char *edges = p->open ? " (both excluded)" : "";
    return fail(ERR_INPUT, "%s:%d: %s is %g; allowed is %g .. %g%s", dict_path(d), dict_line(d, p->name), p->name, v,
                p->low, p->high, edges);
}

static status missing(struct dict *d, const struct param *p) {
    double none;
    status cause = dict_number(d, p->name, p->unit, &none); /* it says where, and what it may be misspelt as */
    status s = fail(ERR_INPUT, "%s (%s)", status_text(cause), p->meaning);
    status_free(cause);
    return s;
}

static status read_one(struct dict *d, const struct param *p, void *member) {
    bool given = dict_has(d, p->name);
    double v[3] = {p->standard, p->standard, p->standard};
    if (!given && isnan(p->standard)) return missing(d, p);
    if (p->kind == PARAM_SWITCH) return dict_switch_or(d, p->name, p->standard != 0, member);
    if (given && p->kind == PARAM_VECTOR)
        TRY(dict_vector(d, p->name, p->unit, v));
    else if (given)
        TRY(dict_number(d, p->name, p->unit, v));
    int components = p->kind == PARAM_VECTOR ? 3 : 1;
    for (int i = 0; given && i < components; i++) TRY(check_range(d, p, v[i]));
    if (p->kind == PARAM_COUNT) {
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

static void print_unit(char text[64], const signed char unit[3]) {
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

void params_print(FILE *f, const struct param *table, int n) {
    for (int i = 0; i < n; i++) {
        const struct param *p = &table[i];
        char unit[64], standard[32], range[64];
        print_unit(unit, p->unit);
        snprintf(standard, sizeof standard, "%g", p->standard);
        if (isnan(p->standard)) snprintf(standard, sizeof standard, "required");
        if (p->kind == PARAM_SWITCH && !isnan(p->standard))
            snprintf(standard, sizeof standard, "%s", p->standard != 0 ? "on" : "off");
        snprintf(range, sizeof range, p->open ? "%g < .. < %g" : "%g .. %g", p->low, p->high);
        fprintf(f, "    %-20s %-10s %-16s %-10s %s\n", p->name, standard, p->kind == PARAM_SWITCH ? "on, off" : range,
                unit, p->meaning);
    }
}
