/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quantities that a gas carries: `carried` of constant/granularProperties (models.h), and their fields in a time
 * folder (initial.h). */
#include "solvers/dict/params.h"
#include "solvers/gas/initial.h"
#include "solvers/gas/models.h"
#include "solvers/gas/quantities.h"

#include <stdlib.h>
#include <string.h>

#define CARRIED_DICT "carried/NAME"
static const struct param kind_param[] = {
    NOTED("type", "word", NULL, "kind of the quantity NAME, whose field is 0.orig/NAME", "type passive;"),
};

/* ---- the dictionary ---- */

/* Names are those of files and of fields: not of other fields of the gas. */
static status check_name(const struct dict *d, const char *name) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    static const char *const taken[] = {"massFlux", "momentumFlux", "energyFlux", "grains", "uniform", "polyMesh"};
    if (strspn(name, letters) != strlen(name) || (*name >= '0' && *name <= '9'))
        return dict_fail(d, name, "a quantity has a name of letters, digits and _");
    for (int i = 0; i < GAS_QUANTITIES; i++)
        if (gas_quantity[i].name && !strcmp(gas_quantity[i].name, name))
            return dict_fail(d, name, "the gas has a field of that name; choose another");
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (!strcmp(taken[i], name)) return dict_fail(d, name, "the name means something else here; choose another");
    return OK;
}

static status read_quantity(struct dict *all, const char *name, struct carried_choice *out) {
    const char *names[CARRIED_MOST];
    struct dict *d;
    int kind;
    TRY(check_name(all, name));
    TRY(dict_sub(all, name, &d));
    for (int i = 0; i < carried_count; i++) names[i] = carried_table[i].model.name;
    TRY(dict_choice(d, "type", names, carried_count, &kind));
    *out = (struct carried_choice){.name = name, .kind = &carried_table[kind]};
    return params_read(d, out->kind->model.param, out->kind->model.nparam, &out->params);
}

status carried_read(struct dict *properties, struct case_models *m) {
    struct dict *all;
    TRY(dict_sub_optional(properties, "carried", &all));
    m->gas.carried = m->carried;
    for (int i = 0; all && i < dict_count(all); i++) {
        if (i == CARRIED_MOST) return dict_fail(properties, "carried", "%d quantities at most", CARRIED_MOST);
        TRY(read_quantity(all, dict_key(all, i), &m->carried[i]));
        m->gas.ncarried++;
    }
    return OK;
}

status carried_check(const struct case_models *m) {
    for (int i = 0; i < m->gas.ncarried; i++) {
        const struct carried_choice *c = &m->carried[i];
        const double *g = m->forces.gravity;
        if (!(c->kind->terms(&c->params) & CARRIED_PERCOLATES) || g[0] != 0 || g[1] != 0 || g[2] != 0) continue;
        return dict_fail(m->properties, "carried",
                         "%s percolates along gravity, and there is none: give constant/g, or choose  type passive;",
                         c->name);
    }
    return OK;
}

void carried_list(FILE *f) {
    fprintf(f, "\ncarried { NAME { type ..; } }: scalars that ride with the gas, with fields of their own\n");
    for (int i = 0; i < carried_count; i++) {
        fprintf(f, "  %-20s %s\n", carried_table[i].model.name, carried_table[i].model.about);
        params_print(f, carried_table[i].model.param, carried_table[i].model.nparam);
    }
}

void carried_print(FILE *f, const struct case_models *m) {
    for (int i = 0; i < m->gas.ncarried; i++) {
        const struct carried_choice *c = &m->carried[i];
        fprintf(f, "    %-22s %s, %s\n", "carried", c->name, c->kind->model.name);
        params_print_values(f, c->kind->model.param, c->kind->model.nparam, &c->params);
    }
}

/* Each quantity has a line; they share those of slopes and faces, and five if one of them diffuses or percolates. */
double carried_memory(const struct gas_models *m, int dim) {
    return m->ncarried ? m->ncarried + 1 + 5 * dim + 5 : 0;
}

void carried_keywords(struct keywords *k, const char *file) {
    keywords_at(k, file, CARRIED_DICT, NULL);
    keywords_params(k, kind_param, 1);
    for (int i = 0; i < carried_count; i++) {
        const struct model *m = &carried_table[i].model;
        char entry[KEYWORD_TEXT];
        snprintf(entry, sizeof entry, "type %s;", m->name);
        keywords_entries(entry, m->param, m->nparam);
        keywords_word(k, "type", m->name, m->about, entry);
    }
    for (int i = 0; i < carried_count; i++) {
        keywords_at(k, file, CARRIED_DICT, carried_table[i].model.name);
        keywords_params(k, carried_table[i].model.param, carried_table[i].model.nparam);
    }
}

/* ---- the fields ---- */

/* Open patches give it, or it is that of the cell; at walls the latter. */
static const char *const types[] = {"fixedValue",        "zeroGradient",   "inletOutlet",
                                    "uniformFixedValue", "exprFixedValue", "uniformInletOutlet",
                                    "symmetry",          "symmetryPlane",  NULL};

static void take_values(const struct carried_start *s, int p, int i) {
    const struct patch_field *q = &s->field[i]->patch[p];
    struct rule *rule = &s->rule[p * s->n + i];
    rule->uniform[0] = q->uniform[0];
    rule->values = q->values;
}

static void take_rules(const struct carried_start *s, int npatches) {
    for (int p = 0; p < npatches; p++)
        for (int i = 0; i < s->n; i++) {
            const struct patch_field *q = &s->field[i]->patch[p];
            s->rule[p * s->n + i] = (struct rule){.type = boundary_find(q->type)};
            if (s->rule[p * s->n + i].type) take_values(s, p, i);
        }
}

/* A folder of an earlier run that carried nothing lacks the field. */
static status missing(const char *path, const char *name) {
    return fail(ERR_INPUT, "%s: no such file; `carried` of constant/granularProperties names %s, whose start it gives",
                path, name);
}

status carried_start_read(const char *folder, const struct field_place *place, const struct gas_models *models,
                          struct carried_start *s) {
    s->n = models->ncarried;
    for (int i = 0; i < s->n; i++) {
        const struct carried_choice *c = &models->carried[i];
        char path[TIME_PATH];
        snprintf(path, sizeof path, "%s/%s", folder, c->name);
        s->kind[i] = (struct field_kind){c->name, 1, {0, 0, 0, 0, 0, 0, 0}, c->kind->model.about, types, true};
        status e = field_exists(path) ? field_read(path, &s->kind[i], place, &s->field[i]) : missing(path, c->name);
        TRY(field_agree(place, e));
        TRY(field_agree(place, field_check_range(s->field[i], place, c->kind->low, c->kind->high, NULL)));
        s->phi[i] = s->field[i]->values;
        s->field[i]->values = NULL;
    }
    return OK;
}

status carried_start_rules(struct carried_start *s, struct pool *pool, int npatches, struct patch_rules *rules) {
    if (s->n == 0) return OK;
    TRY(pool_take(pool, &s->rule, (long)npatches * s->n, sizeof *s->rule, "boundary rules"));
    for (int p = 0; p < npatches; p++) rules[p].carried = s->rule + p * s->n;
    take_rules(s, npatches);
    return OK;
}

bool carried_start_varies(const struct carried_start *s, int npatches) {
    bool varies = false;
    for (int i = 0; i < s->n; i++)
        for (int p = 0; p < npatches; p++) {
            const struct varying *v = s->field[i]->patch[p].varying;
            varies |= v && varying_in_time(v);
        }
    return varies;
}

status carried_start_renew(struct carried_start *s, int p, double t) {
    for (int i = 0; i < s->n; i++) {
        const struct varying *v = s->field[i]->patch[p].varying;
        if (!v || !varying_in_time(v)) continue;
        TRY(field_renew(s->field[i], p, t, ERR_STATE));
        take_values(s, p, i);
    }
    return OK;
}

double carried_start_knot(const struct carried_start *s, int p, double t) {
    double knot = HUGE_VAL;
    for (int i = 0; i < s->n; i++)
        if (s->field[i]->patch[p].varying) knot = fmin(knot, varying_knot(s->field[i]->patch[p].varying, t));
    return knot;
}

void carried_start_drop(struct carried_start *s) {
    for (int i = 0; i < s->n; i++) {
        free(s->phi[i]);
        s->phi[i] = NULL;
        if (s->field[i]) field_drop_cells(s->field[i]);
    }
}

void carried_start_free(struct carried_start *s) {
    carried_start_drop(s);
    for (int i = 0; i < s->n; i++) field_free(s->field[i]);
}
