/* Reads, prints and lists families of models (family.h). */
#include "solvers/dict/family.h"

#include "solvers/dict/params.h"

#include <stdlib.h>
#include <string.h>

static const struct model *row_of(const struct family *k, int i) {
    return (const void *)((const char *)k->rows + (size_t)i * k->stride);
}

static const struct model *chosen_of(const struct family *k, const void *base) {
    const struct model *row;
    memcpy(&row, (const char *)base + k->chosen, sizeof row);
    return row;
}

/* Reads the row whose name is the value of the keyword; *row is NULL for the word `none`. */
static status read_name(const struct family *k, struct dict *d, const struct model **row) {
    const int none = k->none ? 1 : 0, n = *k->count + none;
    const char **names;
    int i = 0;
    TRY(allocate(&names, n, sizeof *names, "names of models"));
    names[0] = "none";
    for (i = none; i < n; i++) names[i] = row_of(k, i - none)->name;
    status s = dict_choice(d, k->key, names, n, &i);
    free(names);
    TRY(s);
    *row = i < none ? NULL : row_of(k, i - none);
    return OK;
}

static status choose(const struct family *k, struct dict *d, const struct model **row) {
    *row = NULL;
    if (d && (dict_has(d, k->key) || k->must || k->sub)) return read_name(k, d, row);
    if (k->standard) *row = model_find(k->rows, k->stride, *k->count, k->standard);
    return OK;
}

/* Finds the dictionary NAMECoeffs of a row; *out is NULL if it is missing. */
static status find_coeffs(struct dict *d, const struct model *row, struct dict **out) {
    char name[128];
    snprintf(name, sizeof name, "%sCoeffs", row->name);
    return dict_sub_optional(d, name, out);
}

static status leave_coeffs(const struct family *k, struct dict *d, const struct model *but) {
    struct dict *sub;
    for (int i = 0; i < *k->count; i++) {
        if (row_of(k, i)->nparam == 0) continue;
        TRY(find_coeffs(d, row_of(k, i), &sub));
        if (sub && row_of(k, i) != but) dict_mark_used(sub);
    }
    return OK;
}

static status read_params(struct dict *d, const struct model *row, void *params) {
    struct dict *sub, *none = NULL;
    char name[128];
    TRY(find_coeffs(d, row, &sub));
    snprintf(name, sizeof name, "%sCoeffs", row->name);
    if (!sub) TRY(dict_from_text(name, "", &none));
    status s = params_read(sub ? sub : none, row->param, row->nparam, params);
    dict_free(none);
    return s;
}

status family_read(const struct family *k, struct dict *d, void *base) {
    const struct model *row;
    if (k->sub) TRY(dict_sub_optional(d, k->sub, &d));
    TRY(choose(k, d, &row));
    memcpy((char *)base + k->chosen, &row, sizeof row);
    if (k->suits) TRY(k->suits(d, base));
    if (d) TRY(leave_coeffs(k, d, row));
    if (d && row && row->nparam > 0) TRY(read_params(d, row, (char *)base + k->params));
    return k->holds ? k->holds(d, base) : OK;
}

status family_leave(const struct family *k, struct dict *d) {
    (void)dict_has(d, k->key);
    return leave_coeffs(k, d, NULL);
}

static void list_row(FILE *f, const struct family *k, const struct model *row) {
    fprintf(f, "  %-20s %s", row->name, row->about);
    if (row->nparam > 0) fprintf(f, "; %sCoeffs { }", row->name);
    fprintf(f, "%s\n", !k->sub && k->standard && !strcmp(row->name, k->standard) ? " (default)" : "");
    params_print(f, row->param, row->nparam);
}

void family_list(FILE *f, const struct family *k) {
    fprintf(f, "\n%s", k->title);
    if (k->sub) fprintf(f, "; %s if it is not given", k->standard);
    fprintf(f, "\n");
    if (k->none) fprintf(f, "  %-20s %s\n", "none", k->none);
    for (int i = 0; i < *k->count; i++) list_row(f, k, row_of(k, i));
}

void family_print(FILE *f, const struct family *k, const void *base) {
    const struct model *row = chosen_of(k, base);
    if (!row && k->tacit) return;
    fprintf(f, "    %-22s %s\n", k->sub ? k->sub : k->key, row ? row->name : "none");
    if (row) params_print_values(f, row->param, row->nparam, (const char *)base + k->params);
}
