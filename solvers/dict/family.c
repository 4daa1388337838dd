/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, prints and lists families of models (family.h). */
#include "solvers/dict/family.h"

#include "solvers/dict/params.h"

#include <math.h>
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

static bool is_offered(const struct family *k, int i) {
    return !k->offered || k->offered(row_of(k, i));
}

const struct model *family_row(const struct family *k, int i) {
    return is_offered(k, i) ? row_of(k, i) : NULL;
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

/* d NULL: the row was chosen without a dictionary, and its parameters are the defaults. */
static status read_params(const struct family *k, struct dict *d, const struct model *row, void *params) {
    struct dict *sub = NULL, *none = NULL;
    char name[128];
    for (int p = 0; k->flat && d && p < row->nparam; p++) dict_belongs(d, row->param[p].name, k->sub);
    if (d && k->flat) return params_read(d, row->param, row->nparam, params);
    if (d) TRY(find_coeffs(d, row, &sub));
    snprintf(name, sizeof name, "%sCoeffs", row->name);
    for (int p = 0; d && p < row->nparam; p++) dict_belongs(d, row->param[p].name, name);
    if (!sub) TRY(dict_from_text(name, "", &none));
    status s = params_read(sub ? sub : none, row->param, row->nparam, params);
    dict_free(none);
    return s;
}

/* No offered row has the name: the error says which there are, and the nearest. */
static status no_row(const struct family *k, const struct dict *d, const char *word) {
    const char **names;
    int n = 0;
    TRY(allocate(&names, *k->count, sizeof *names, "names of models"));
    for (int i = 0; i < *k->count; i++)
        if (is_offered(k, i)) names[n++] = row_of(k, i)->name;
    const status e = dict_unknown(d, k->key, word, names, n);
    free(names);
    return e;
}

/* A row that is named in a list: its dictionary must be there if one of its parameters has no default. */
static status read_named(const struct family *k, struct dict *d, const char *word, bool *on, struct own_params *own) {
    struct dict *sub;
    int i = 0;
    while (i < *k->count && (!is_offered(k, i) || strcmp(row_of(k, i)->name, word))) i++;
    if (i == *k->count) return no_row(k, d, word);
    if (on[i]) return dict_fail(d, k->key, "%s stands there twice", word);
    const struct model *row = row_of(k, i);
    on[i] = true;
    TRY(find_coeffs(d, row, &sub));
    for (int p = 0; p < row->nparam && !sub; p++)
        if (isnan(row->param[p].standard))
            return dict_fail(d, k->key, "%s needs the dictionary  %sCoeffs { %s ..; }", word, word, row->param[p].name);
    return row->nparam > 0 ? read_params(k, d, row, &own[i]) : OK;
}

static status read_list(const struct family *k, struct dict *d, void *base) {
    bool *on = (void *)((char *)base + k->chosen);
    struct own_params *own = (void *)((char *)base + k->params);
    const char *const *words;
    struct dict *sub;
    int n = 0;
    if (dict_has(d, k->key)) TRY(dict_words(d, k->key, &n, &words));
    for (int i = 0; i < *k->count; i++) on[i] = false;
    for (int i = 0; i < n; i++) TRY(read_named(k, d, words[i], on, own));
    for (int i = 0; i < *k->count; i++) {
        if (on[i] || row_of(k, i)->nparam == 0) continue;
        TRY(find_coeffs(d, row_of(k, i), &sub));
        if (sub) dict_mark_used(sub);
    }
    return OK;
}

/* Marks the parameters of all rows, which stand beside a row of a flat family that has none. */
static void pass_params(const struct family *k, const struct dict *d) {
    for (int i = 0; i < *k->count; i++)
        for (int p = 0; p < row_of(k, i)->nparam; p++) (void)dict_has(d, row_of(k, i)->param[p].name);
}

static status read_one(const struct family *k, struct dict *d, void *base) {
    const struct model *row;
    TRY(choose(k, d, &row));
    memcpy((char *)base + k->chosen, &row, sizeof row);
    if (k->suits) TRY(k->suits(d, base));
    if (d && k->flat && row->nparam == 0) pass_params(k, d);
    if (d && !k->flat) TRY(leave_coeffs(k, d, row));
    return row && row->nparam > 0 ? read_params(k, d, row, (char *)base + k->params) : OK;
}

status family_read(const struct family *k, struct dict *d, void *base) {
    if (k->sub) TRY(dict_sub_optional(d, k->sub, &d));
    TRY(k->list ? read_list(k, d, base) : read_one(k, d, base));
    return k->holds ? k->holds(d, base) : OK;
}

status family_leave(const struct family *k, struct dict *d) {
    if (k->sub) TRY(dict_sub_optional(d, k->sub, &d));
    if (d && k->sub) dict_mark_used(d);
    if (k->sub) return OK;
    (void)dict_has(d, k->key);
    return leave_coeffs(k, d, NULL);
}

static void list_row(FILE *f, const struct family *k, const struct model *row) {
    fprintf(f, "  %-20s %s", row->name, row->about);
    if (row->nparam > 0 && !k->flat) fprintf(f, "; %sCoeffs { }", row->name);
    fprintf(f, "%s\n", !k->sub && k->standard && !strcmp(row->name, k->standard) ? " (default)" : "");
    params_print(f, row->param, row->nparam);
}

void family_list(FILE *f, const struct family *k) {
    fprintf(f, "\n%s", k->title);
    if (k->sub) fprintf(f, "; %s if it is not given", k->standard);
    fprintf(f, "\n");
    if (k->none) fprintf(f, "  %-20s %s\n", "none", k->none);
    for (int i = 0; i < *k->count; i++)
        if (is_offered(k, i)) list_row(f, k, row_of(k, i));
}

static void print_list(FILE *f, const struct family *k, const void *base) {
    const bool *on = (const void *)((const char *)base + k->chosen);
    const struct own_params *own = (const void *)((const char *)base + k->params);
    for (int i = 0; i < *k->count; i++) {
        const struct model *row = row_of(k, i);
        if (!on[i]) continue;
        fprintf(f, "    %-22s %s\n", k->key, row->name);
        params_print_values(f, row->param, row->nparam, &own[i]);
    }
}

void family_print(FILE *f, const struct family *k, const void *base) {
    if (k->list) {
        print_list(f, k, base);
        return;
    }
    const struct model *row = chosen_of(k, base);
    if (k->tacit && (!row || !strcmp(row->name, "none"))) return;
    fprintf(f, "    %-22s %s\n", k->sub ? k->sub : k->key, row ? row->name : "none");
    if (row) params_print_values(f, row->param, row->nparam, (const char *)base + k->params);
}
