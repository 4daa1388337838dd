/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, checks and writes OpenFOAM's field files (fields.h). */
#include "solvers/case/fields.h"

#include "libcore/models/boundary.h"
#include "mesh/format/boxes.h"
#include "mesh/format/sites.h"
#include "solvers/dict/expr.h"
#include "solvers/dict/params.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH = 4096, TYPES = 32, AT_ONCE = 1 << 14 }; /* points that expressions take at once */

const struct field_kind field_kinds[FIELD_COUNT] = {
    {"rho", 1, {1, -3, 0, 0, 0, 0, 0}, "density", NULL, true},
    {"alpha", 1, {0, 0, 0, 0, 0, 0, 0}, "packing fraction", NULL, true},
    {"U", 3, {0, 1, -1, 0, 0, 0, 0}, "velocity", NULL, true},
    {"T", 1, {0, 2, -2, 0, 0, 0, 0}, "granular temperature per unit mass", NULL, true},
    {"p", 1, {1, -1, -2, 0, 0, 0, 0}, "pressure", NULL, true},
};

/* ---- keywords ---- */
#define VALUE_TYPE "uniform VALUE, or nonuniform List<scalar> or List<vector>"
static const struct param field_param[] = {
    NOTED("dimensions", "dimensions", NULL, "exponents of kg m s K mol A cd", "dimensions [0 1 -1 0 0 0 0];"),
    NOTED("internalField", VALUE_TYPE, "required without an expression", "the cells' values",
          "internalField uniform 0.3;"),
    NOTED("expression", "expression of x, y, z, t; of a vector three: (\"..\" \"..\" \"..\")", "none",
          "the values of the cells; it replaces internalField; constants pi, e; functions as in C",
          "expression \"0.1 + 0.2*exp(-y^2)\";"),
    NOTED("boundaryField", "dictionary", NULL, "a dictionary for each patch of the mesh, by its name",
          "boundaryField { \"front|back\" { type empty; } }"),
};
static const struct param type_param[] = {
    NOTED("type", "word", NULL, "boundary condition", "type empty;"),
    IGNORED("value", "the values of a type that needs none: written by OpenFOAM"),
    IGNORED("phi", "written by OpenFOAM"),
    IGNORED("rho", "written by OpenFOAM"),
};
#define PATCH_DICT   "boundaryField/PATCH"
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static const struct {
    const char *type, *scalar, *vector; /* as a user writes it; examples */
} forms[] = {
    [BY_LIST] = {VALUE_TYPE, "uniform 0.3", "uniform (1 0 0)"},
    [BY_FUNCTION] = {"VALUE, or table ((t VALUE) (t VALUE) ..)", "0.3", "(1 0 0)"},
    [BY_EXPRESSION] = {"expression of pos(), time()", "\"0.3\"", "\"vector(1, 0, 0)\""},
    [BY_RATE] = {"number in kg/s, or table ((t v) (t v) ..)", "0.3", "0.3"},
    [BY_ROTATION] = {"number in rad/s, table ((t v) (t v) ..), or \"expression of t\"", "0.3", "0.3"},
};

/* Writes the whole entry of a patch in a file of scalars (components 1) or of U (3). A type with parameters is one that
 * OpenFOAM does not know: its tools want a value of it in any case. */
static void patch_entry(char entry[KEYWORD_TEXT], const struct boundary_type *b, int components) {
    const char *key = boundary_value(b, components);
    const char *value = components == 1 ? forms[b->giving].scalar : forms[b->giving].vector;
    snprintf(entry, KEYWORD_TEXT, "type %s;", b->model.name);
    keywords_entries(entry, b->model.param, b->model.nparam);
    varying_entry(entry, b);
    const size_t used = strlen(entry);
    if (key)
        snprintf(entry + used, KEYWORD_TEXT - used, " %s %s;", key, b->model.nparam ? "uniform (0 0 0)" : value);
    else if (b->model.nparam)
        snprintf(entry + used, KEYWORD_TEXT - used, " value uniform %s;", components == 1 ? "0.3" : "(0 0 0)");
}

/* Is a scalar that has it T, for it says what heat crosses a wall? */
static bool is_of_heat(const struct boundary_type *b) {
    return b->heat && !boundary_value(b, 1);
}

const char *boundary_fields(const struct boundary_type *b) {
    const bool U = boundary_takes(b, 3);
    if (!boundary_takes(b, 1)) return "U";
    if (is_of_heat(b)) return U ? "T, U" : "T";
    return U ? "scalars, U" : "scalars";
}

/* Returns those of several files that may have it; NULL: all. */
static const char *files_with(const struct boundary_type *b, const char *file) {
    if (!strchr(file, ',')) return NULL;
    if (!boundary_takes(b, 1)) return "0.orig/U";
    if (!is_of_heat(b)) return NULL;
    return boundary_takes(b, 3) ? "0.orig/U, 0.orig/T" : "0.orig/T";
}

/* The word of a boundary condition, with the fields that take it and whole entries. */
static void boundary_word(struct keywords *k, const struct boundary_type *b) {
    const bool U = boundary_takes(b, 3), scalars = boundary_takes(b, 1);
    char about[KEYWORD_TEXT], one[KEYWORD_TEXT] = "", other[KEYWORD_TEXT] = "", both[KEYWORD_ENTRY];
    snprintf(about, sizeof about, "%s: %s", boundary_fields(b), b->model.about);
    if (scalars) patch_entry(one, b, 1);
    if (U) patch_entry(other, b, 3);
    snprintf(both, sizeof both, "%s    in U: %s", one, other);
    k->only = files_with(b, k->file);
    keywords_word(k, "type", b->model.name, about,
                  !U || (scalars && !strcmp(one, other)) ? one
                  : scalars                              ? both
                                                         : other);
    k->only = NULL;
}

/* The parameters and values of a boundary condition. */
static void boundary_keywords(struct keywords *k, const char *file, const struct boundary_type *b) {
    const char *scalar = boundary_value(b, 1), *value = scalar ? scalar : boundary_value(b, 3);
    char entry[80];
    keywords_at(k, file, PATCH_DICT, b->model.name);
    k->only = files_with(b, file);
    keywords_params(k, b->model.param, b->model.nparam);
    varying_keywords(k, b);
    k->only = NULL;
    if (!value) return;
    snprintf(entry, sizeof entry, "%s %s;", value, scalar ? forms[b->giving].scalar : forms[b->giving].vector);
    const struct param row = NOTED(value, forms[b->giving].type, NULL,
                                   scalar ? "on the faces of the patch" : "of U on the faces of the patch", entry);
    keywords_params(k, &row, 1);
}

void fields_keywords(struct keywords *k, const char *file, bool (*offered)(const struct boundary_type *b)) {
    keywords_at(k, file, "", NULL);
    keywords_params(k, field_param, COUNT(field_param));
    keywords_at(k, file, PATCH_DICT, NULL);
    keywords_params(k, type_param, 1);
    keywords_word(k, "type", "empty", "the axis is not solved; on patches of type empty", NULL);
    keywords_word(k, "type", "cyclic", "periodic; on patches of type cyclic", NULL);
    for (int i = 0; i < boundary_count; i++)
        if (!offered || offered(&boundary_table[i])) boundary_word(k, &boundary_table[i]);
    keywords_params(k, type_param + 1, COUNT(type_param) - 1);
    for (int i = 0; i < boundary_count; i++)
        if (!offered || offered(&boundary_table[i])) boundary_keywords(k, file, &boundary_table[i]);
}

bool field_exists(const char *path) {
    char zipped[PATH];
    snprintf(zipped, sizeof zipped, "%s.gz", path);
    return !access(path, F_OK) || !access(zipped, F_OK);
}

static status check_dimensions(struct dict *d, const struct field_kind *kind) {
    signed char found[7];
    const signed char *k = kind->dimensions;
    TRY(dict_dimensions(d, "dimensions", found));
    if (memcmp(found, k, 7))
        return dict_fail(d, "dimensions", "%s (%s) needs [%d %d %d %d %d %d %d]%s", kind->name, kind->about, k[0], k[1],
                         k[2], k[3], k[4], k[5], k[6],
                         found[3] ? "; it is no kelvin, but the mean square speed of grains along an axis" : "");
    return OK;
}

struct range { /* of the entries of a list that has `count` of them */
    long first, end, count;
};

/* Reads `uniform v` or `nonuniform List<...> n (...)`; *values is NULL for the first, else those of the range. */
static status read_value(struct dict *d, const char *key, int components, struct range r, double uniform[3],
                         double **values) {
    struct lexer l;
    struct token t;
    *values = NULL;
    TRY(dict_raw(d, key, &l));
    TRY(lexer_next(&l, &t));
    if (token_is(&t, "uniform")) {
        if (components == 3) TRY(lexer_expect(&l, '('));
        for (int c = 0; c < components; c++) {
            TRY(lexer_next(&l, &t));
            if (t.kind != TOKEN_NUMBER || !isfinite(t.number))
                return lexer_fail(&l, &t, "%s of '%s' wants a finite number",
                                  components == 3 ? "a vector" : "the value", key);
            uniform[c] = t.number;
        }
        if (components == 3) TRY(lexer_expect(&l, ')'));
        return lexer_expect(&l, ';');
    }
    if (!token_is(&t, "nonuniform"))
        return lexer_fail(&l, &t, "'%s' is  uniform %s;  or  nonuniform List<%s> N ( ... );", key,
                          components == 3 ? "(x y z)" : "VALUE", components == 3 ? "vector" : "scalar");
    TRY(lexer_next(&l, &t));
    if (!token_is(&t, components == 3 ? "List<vector>" : "List<scalar>"))
        return lexer_fail(&l, &t, "this field takes List<%s>", components == 3 ? "vector" : "scalar");
    long n = 0;
    TRY(foam_list_read_part(&l, dict_header(d), components, r.count, r.first, r.end, &n, values));
    if (n != r.count) {
        free(*values);
        *values = NULL;
        return dict_fail(d, key, "it holds %ld values; the mesh wants %ld", n, r.count);
    }
    return OK;
}

long field_first(const struct field_place *at) {
    return at->share ? at->share->first : 0;
}
long field_ncells(const struct field_place *at) {
    return at->share ? at->share->end - at->share->first : at->mesh->ncells;
}
status field_agree(const struct field_place *at, status mine) {
    return at->share ? comm_agree(at->share->comm, mine) : mine;
}

void field_centre(const struct field_place *at, long cell, double x[3]) {
    if (at->spread)
        spread_centre(at->spread, cell, x);
    else if (at->centre)
        memcpy(x, at->centre + 3 * cell, 3 * sizeof *x);
    else if (at->mesh->boxes)
        boxes_centre(at->mesh->boxes, cell, x);
    else
        sites_centre(at->mesh->outline->sites, cell, x);
}

struct points {
    long n;
    const double *x; /* [n][3] m; NULL: those of `cells`, n of them */
    const struct field_place *cells;
    double t;
};

/* Evaluates an expression, for every components-th number of `out`; room[4 * AT_ONCE] or [4 * points]. */
static status evaluate(struct dict *d, const struct expr *e, const struct points *p, int components, double *room,
                       double *out) {
    for (long from = 0, n; from < p->n; from += n) {
        n = p->n - from < AT_ONCE ? p->n - from : AT_ONCE;
        const double *x = p->x ? p->x + 3 * from : room;
        double *v = room + 3 * n;
        for (long i = 0; i < n && !p->x; i++) field_centre(p->cells, field_first(p->cells) + from + i, room + 3 * i);
        expr_values(e, n, x, p->t, v);
        for (long i = 0; i < n; i++, x += 3) {
            if (isfinite(out[(from + i) * components] = v[i])) continue;
            char in[40] = "";
            if (!p->x) snprintf(in, sizeof in, " in cell %ld", field_first(p->cells) + from + i);
            return dict_fail(d, "expression", "it gives %g%s at (%g %g %g), t = %g", v[i], in, *x, x[1], x[2], p->t);
        }
    }
    return OK;
}

static status read_expression(struct dict *d, int components, const struct points *p, double *out) {
    const char *const *texts;
    double *room;
    int n;
    TRY(dict_words(d, "expression", &n, &texts));
    if (n != components)
        return dict_fail(d, "expression", "it holds %d expressions; the field has %d component%s", n, components,
                         components == 1 ? "" : "s: (\"u\" \"v\" \"w\")");
    status s = allocate(&room, 4 * (p->n < AT_ONCE ? p->n : AT_ONCE), sizeof *room, "points of an expression");
    for (int c = 0; c < components && !s; c++) {
        struct expr *e;
        s = dict_note_expression(d, "expression", texts[c], expr_compile(texts[c], &e));
        if (!s) s = evaluate(d, e, p, components, room, out + c);
        expr_free(e);
    }
    free(room);
    return s;
}

bool field_has_expression(const struct field *f) {
    return dict_has(f->dict, "expression") && !f->plan.changes;
}
status field_evaluate(const struct field *f, long npoints, const double *points, double t, double *out) {
    return read_expression(f->dict, f->kind->components, &(struct points){npoints, points, NULL, t}, out);
}

static status read_cells(struct field *f, const struct field_place *at) {
    const int m = f->kind->components;
    const long n = field_ncells(at), first = field_first(at);
    if (dict_has(f->dict, "expression")) {
        (void)dict_has(f->dict, "internalField");
        TRY(allocate(&f->values, n * m, sizeof(double), f->kind->name));
        return read_expression(f->dict, m, &(struct points){n, NULL, at, at->t}, f->values);
    }
    double uniform[3] = {0, 0, 0};
    if (!f->plan.fills || dict_has(f->dict, "internalField"))
        TRY(read_value(f->dict, "internalField", m, (struct range){first, first + n, at->mesh->ncells}, uniform,
                       &f->values));
    if (f->values) return OK;
    TRY(allocate(&f->values, n * m, sizeof(double), f->kind->name));
    for (long i = 0; i < n * m; i++) f->values[i] = uniform[i % m];
    return OK;
}

/* Is it a type that mesh and field must share? */
static bool constraint(const char *type) {
    static const char *const names[] = {"empty", "cyclic", "symmetry", "symmetryPlane"};
    for (int i = 0; i < 4; i++)
        if (!strcmp(type, names[i])) return true;
    return false;
}

static status check_type(struct dict *d, const struct field_kind *kind, const struct polymesh *m, int patch,
                         const char *type) {
    const struct patch *p = &m->patch[patch];
    const char *names[TYPES], *file = polymesh_boundary_file(m);
    int n = 0;
    bool known = false;
    names[n++] = "empty";
    names[n++] = "cyclic";
    for (int i = 0; kind->types && kind->types[i]; i++) names[n++] = kind->types[i];
    if (kind->components == 1 && !kind->types) names[n++] = "calculated";
    for (int i = 0; !kind->types && i < boundary_count && n < TYPES; i++)
        if (boundary_takes(&boundary_table[i], kind->components)) names[n++] = boundary_table[i].model.name;
    for (int i = 0; i < n; i++) known |= !strcmp(type, names[i]);
    if (!known) { /* the message of dict_choice lists the names and suggests one */
        int index;
        return dict_choice(d, "type", names, n, &index);
    }
    if (constraint(p->type) && strcmp(p->type, type))
        return dict_fail(d, "type", "patch %s is of type %s in %s; field %s must have type %s there", p->name, p->type,
                         file, kind->name, p->type);
    if (constraint(type) && strcmp(p->type, type))
        return dict_fail(d, "type",
                         "patch %s is of type %s in %s; change it there to %s, or give field %s another type here",
                         p->name, p->type, file, type, kind->name);
    const struct boundary_type *row = boundary_find(type);
    if (row && row->giving == BY_RATE && !strcmp(p->type, "wall"))
        return dict_fail(d, "type", "patch %s is a wall in %s, and nothing flows through it; make it a `patch` there",
                         p->name, file);
    return OK;
}

static const struct varying_range any_value = {-MOST_NUMBER, MOST_NUMBER, "lie between -1e60 and 1e60"};

/* Returns where a patch keeps values that follow a rule: one for each face, or one for all, which may be the parameter
 * of a type that has no other values. */
static double *values_of(struct patch_field *q) {
    const struct boundary_type *type = boundary_find(q->type);
    const bool parameter = !type->value[0] && !type->value[1];
    return q->values ? q->values : parameter ? q->params.room + type->model.param->offset / sizeof(double) : q->uniform;
}

/* Reads the parameters and values that a type needs besides a rule. */
static status read_given(struct dict *d, const struct field_kind *kind, long nfaces, const struct boundary_type *type,
                         struct patch_field *out) {
    const char *value = boundary_value(type, kind->components);
    const char *rule = out->varying ? varying_key(out->varying) : "";
    const struct model *m = &type->model;
    for (int i = 0; i < m->nparam; i++)
        if (strcmp(rule, m->param[i].name) != 0) TRY(params_read(d, &m->param[i], 1, &out->params));
    if (!value || type->giving != BY_LIST) return OK;
    TRY(read_value(d, value, kind->components, (struct range){0, nfaces, nfaces}, out->uniform, &out->values));
    const double *v = out->values ? out->values : out->uniform;
    for (long i = 0; i < (out->values ? nfaces : 1) * kind->components; i++)
        if (!(fabs(v[i]) <= MOST_NUMBER)) return dict_fail(d, value, "it must %s", any_value.allowed);
    return OK;
}

/* Reads the parameters and values that a type needs. What follows a rule is known at the time of the place. */
static status read_type(struct dict *d, const struct field_kind *kind, const struct field_place *at, int patch,
                        const struct boundary_type *type, struct patch_field *out) {
    const char *value = boundary_value(type, kind->components);
    const long nfaces = at->mesh->patch[patch].nfaces;
    if (kind->varies) TRY(varying_read(d, kind->components, type, at->mesh, patch, &out->varying));
    if (value || type->model.nparam > 0) out->value_line = dict_line(d, value ? value : type->model.param->name);
    TRY(read_given(d, kind, nfaces, type, out));
    if (!out->varying) return OK;
    free(out->values);
    out->values = NULL;
    if (varying_in_space(out->varying))
        TRY(allocate(&out->values, nfaces * kind->components, sizeof(double), "values of a patch"));
    varying_at(out->varying, at->t, values_of(out));
    TRY(varying_check_table(out->varying, &any_value));
    return varying_check(out->varying, at->t, values_of(out), &any_value, ERR_INPUT);
}

static status read_patch(struct dict *d, const struct field_kind *kind, const struct field_place *at, int patch,
                         struct patch_field *out) {
    TRY(dict_word(d, "type", &out->type));
    out->line = dict_line(d, "type");
    const struct patch *p = &at->mesh->patch[patch];
    if (p->said && strcmp(out->type, p->said) != 0)
        return dict_fail(d, "type", "patch %s is of type %s in %s; field %s must have type %s there", p->name, p->said,
                         polymesh_boundary_file(at->mesh), kind->name, p->said);
    if (p->said) out->type = p->type;
    TRY(check_type(d, kind, at->mesh, patch, out->type));
    const struct boundary_type *type = boundary_find(out->type);
    if (type) TRY(read_type(d, kind, at, patch, type, out));
    return params_read(d, type_param, COUNT(type_param), out);
}

/* Returns the key of the entry that is a patch's, in OpenFOAM's order: its name, the last of its groups in the file, a
 * pattern that fits the name. NULL: an `empty` patch has the first two only, and needs none,
 * nor do those that a wedge brings along. */
static const char *entry_of(const struct dict *all, const struct patch *p, bool *exact) {
    const char *group = NULL;
    *exact = true;
    for (int i = dict_count(all) - 1; i >= 0; i--) {
        if (!strcmp(dict_key(all, i), p->name)) return p->name;
        if (!group && patch_in_group(p, dict_key(all, i))) group = dict_key(all, i);
    }
    *exact = group;
    return group ? group : strcmp(p->type, "empty") && !p->said ? p->name : NULL;
}

/* Has an entry no effect, though it may stand there: for a group whose patches all have entries of their own, a pattern
 * that fits such patches, a constraint type of which no patch is? */
static bool is_spare(const struct dict *all, int i, const struct polymesh *m) {
    static const char *const types[] = {"empty", "cyclic",    "symmetry",  "symmetryPlane",
                                        "wedge", "processor", "cyclicAMI", "processorCyclic"};
    bool spare = false;
    for (size_t k = 0; k < sizeof types / sizeof *types; k++) spare |= !strcmp(dict_key(all, i), types[k]);
    for (int p = 0; p < m->npatches; p++)
        spare |= dict_key_fits(all, i, m->patch[p].name) || patch_in_group(&m->patch[p], dict_key(all, i));
    return spare;
}

/* Finds the entries of all patches, which then count as known; what is left may have no effect, or fits nothing. */
static void choose_entries(struct dict *all, const struct polymesh *m) {
    bool exact;
    for (int i = 0; i < m->npatches; i++) {
        const char *key = entry_of(all, &m->patch[i], &exact);
        dict_know(all, m->patch[i].name); /* a key that is left may be misspelt */
        if (key) (void)dict_has(all, key);
    }
    for (int i = 0; i < dict_count(all); i++)
        if (!dict_is_used(all, i) && is_spare(all, i, m)) dict_pass(all, i);
}

/* Returns "; 'wal.*' fits no patch" for the first key of boundaryField that no patch has asked for. */
static void name_idle(const struct dict *all, char text[200]) {
    const char *idle = dict_unused(all);
    *text = 0;
    if (idle) snprintf(text, 200, "; the entry '%.100s' fits no patch", idle);
}

/* Fails on sides that no patch of the mesh generator holds: a pattern may fit them by chance. */
static status check_leftover(const struct field *f, const struct patch *p) {
    if (strcmp(p->name, "defaultFaces") != 0 || !strcmp(p->type, "empty") || !p->nfaces) return OK;
    return fail(ERR_INPUT,
                "%s: patch 'defaultFaces' holds %d faces that belong to no named patch; name that part of the boundary "
                "in the mesh generator, or give the patch an entry of its own",
                dict_path(f->dict), p->nfaces);
}

static status read_patches(struct field *f, const struct field_place *at) {
    char idle[200];
    bool exact;
    struct dict *all, *one;
    const struct polymesh *m = at->mesh;
    TRY(allocate(&f->patch, m->npatches, sizeof *f->patch, "patches of a field"));
    f->npatches = m->npatches;
    TRY(dict_sub(f->dict, "boundaryField", &all));
    choose_entries(all, m);
    name_idle(all, idle);
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        const char *key = entry_of(all, p, &exact);
        if (!exact) TRY(check_leftover(f, p));
        f->patch[i] = (struct patch_field){.type = p->type, .line = dict_line(f->dict, "boundaryField")};
        if (!key) continue;
        TRY(status_note(dict_sub(all, key, &one), "%s: no entry for patch '%s' (type %s in %s)%s", dict_path(f->dict),
                        p->name, p->type, polymesh_boundary_file(m), idle));
        TRY(status_note(read_patch(one, f->kind, at, i, &f->patch[i]), "%s: patch %s", dict_path(f->dict), p->name));
    }
    return OK;
}

/* Squares and products of values must be finite. */
static status check_sizes(const struct field *f, const struct field_place *at) {
    for (long i = 0, m = f->kind->components; i < field_ncells(at) * m; i++)
        if (!(fabs(f->values[i]) <= MOST_NUMBER)) return field_fail(f, at, i / m, "it must %s", any_value.allowed);
    return OK;
}

static status read_all(struct field *f, const struct field_place *at, field_reader *read, void *context) {
    TRY(check_dimensions(f->dict, f->kind));
    if (read) TRY(read(context, f->dict, &f->plan));
    TRY(read_cells(f, at));
    TRY(check_sizes(f, at)); /* the caller lets the ranks agree */
    TRY(read_patches(f, at));
    return dict_check_used(f->dict);
}

status field_read_with(const char *path, const struct field_kind *kind, const struct field_place *place,
                       field_reader *read, void *context, struct field **out) {
    *out = NULL;
    struct field *f = NULL;
    TRY(allocate(&f, 1, sizeof *f, "field"));
    f->kind = kind;
    f->range = any_value;
    status s = place->share ? dict_read_shared(path, place->share, &f->dict) : dict_read(path, &f->dict);
    if (!s) s = read_all(f, place, read, context);
    if (s) {
        field_free(f);
        return s;
    }
    *out = f;
    return OK;
}

status field_read(const char *path, const struct field_kind *kind, const struct field_place *place,
                  struct field **out) {
    return field_read_with(path, kind, place, NULL, NULL, out);
}

void field_drop_cells(struct field *f) {
    free(f->values);
    f->values = NULL;
    dict_drop_text(f->dict);
}

void field_free(struct field *f) {
    if (!f) return;
    for (int i = 0; i < f->npatches; i++) {
        varying_free(f->patch[i].varying);
        free(f->patch[i].values);
    }
    free(f->patch);
    free(f->values);
    dict_free(f->dict);
    free(f);
}

status field_read_values(const char *path, int ncells, int *components, double **out) {
    return field_read_slice(path, ncells, NULL, components, out);
}

status field_read_slice(const char *path, int ncells, const struct share *share, int *components, double **out) {
    const struct range r = share ? (struct range){share->first, share->end, ncells} : (struct range){0, ncells, ncells};
    struct dict *d = NULL;
    *out = NULL;
    TRY(share ? dict_read_shared(path, share, &d) : dict_read(path, &d));
    const char *class = dict_header(d)->class_name;
    double uniform[3];
    *components = !strcmp(class, "volVectorField") ? 3 : 1;
    status s = *components == 1 && strcmp(class, "volScalarField")
                   ? fail(ERR_INPUT, "%s: class '%s'; this reads volScalarField and volVectorField", path, class)
                   : read_value(d, "internalField", *components, r, uniform, out);
    dict_free(d);
    if (s || *out) return s;
    TRY(allocate(out, (r.end - r.first) * *components, sizeof(double), path));
    for (long i = 0; i < (r.end - r.first) * *components; i++) (*out)[i] = uniform[i % *components];
    return OK;
}

/* Returns the line of a cell's value; of a binary list, an expression or a uniform value the line of the entry. */
static int cell_line(const struct field *f, long cell) {
    const bool evaluated = f->plan.fills || dict_has(f->dict, "expression");
    const char *key = f->plan.fills ? f->plan.fills : evaluated ? "expression" : "internalField";
    int line = dict_line(f->dict, key);
    long wanted = cell * f->kind->components;
    struct source *whole = NULL;
    struct lexer l;
    struct token t = {.kind = TOKEN_WORD};
    bool inside = false;
    status s = evaluated || dict_header(f->dict)->binary ? OK : dict_raw(f->dict, key, &l);
    if (s || evaluated || dict_header(f->dict)->binary) {
        status_free(s);
        return line;
    }
    if (l.source->components) { /* the text lacks the list, whose place in the file is the same */
        s = source_open(dict_path(f->dict), &whole);
        if (!s) l.source = whole;
    }
    while (!s && t.kind != TOKEN_END && !token_is(&t, ";")) {
        s = lexer_next(&l, &t);
        inside |= !s && token_is(&t, "(");
        if (!s && inside && t.kind == TOKEN_NUMBER && !wanted--) {
            line = t.line;
            break;
        }
    }
    source_free(whole);
    status_free(s);
    return line;
}

status field_fail(const struct field *f, const struct field_place *place, long i, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    const double *v = f->values + i * f->kind->components;
    const long cell = field_first(place) + i;
    double x[3];
    field_centre(place, cell, x);
    int line = cell_line(f, cell);
    if (f->kind->components == 3)
        return fail(ERR_INPUT, "%s:%d: cell %ld at (%g %g %g): %s is (%g %g %g); %s", dict_path(f->dict), line, cell,
                    x[0], x[1], x[2], f->kind->name, v[0], v[1], v[2], text);
    return fail(ERR_INPUT, "%s:%d: cell %ld at (%g %g %g): %s is %g; %s", dict_path(f->dict), line, cell, x[0], x[1],
                x[2], f->kind->name, *v, text);
}

/* Checks the values of a patch: of a rule, at all times of a table and at the time of the place. */
static status check_patch(struct field *f, const struct field_place *place, int p) {
    struct patch_field *q = &f->patch[p];
    const char *value = boundary_value(boundary_find(q->type), f->kind->components);
    if (q->varying) {
        TRY(varying_check_table(q->varying, &f->range));
        return varying_check(q->varying, place->t, values_of(q), &f->range, ERR_INPUT);
    }
    for (int i = 0; value && i < (q->values ? place->mesh->patch[p].nfaces : 1); i++) {
        double v = q->values ? q->values[i] : q->uniform[0];
        if (v > f->range.low && v < f->range.high) continue;
        return fail(ERR_INPUT, "%s:%d: patch %s: %s of %s is %g; it must %s", dict_path(f->dict), q->value_line,
                    place->mesh->patch[p].name, value, f->kind->name, v, f->range.allowed);
    }
    return OK;
}

status field_check_range(struct field *f, const struct field_place *place, double low, double high, const char *cure) {
    const double step = cure ? 0 : HUGE_VAL;
    f->range = (struct varying_range){nextafter(low, low - step), fmin(nextafter(high, high + step), MOST_NUMBER), ""};
    const char *text = isinf(high) ? "be greater than %g and below 1e60" : "lie between %g and %g%s";
    snprintf(f->range.allowed, sizeof f->range.allowed, text, low, high, cure ? cure : "");
    for (long i = 0; i < field_ncells(place); i++)
        if (!(f->values[i] > f->range.low && f->values[i] < f->range.high))
            return field_fail(f, place, i, "it must %s", f->range.allowed);
    for (int p = 0; p < place->mesh->npatches; p++) TRY(check_patch(f, place, p));
    return OK;
}

status field_renew(struct field *f, int patch, double t, enum status_kind kind) {
    struct patch_field *q = &f->patch[patch];
    varying_at(q->varying, t, values_of(q));
    return varying_check(q->varying, t, values_of(q), &f->range, kind);
}

status field_steady(const struct field *f, const struct polymesh *m) {
    for (int p = 0; p < f->npatches; p++)
        if (f->patch[p].varying && varying_in_time(f->patch[p].varying))
            return fail(ERR_INPUT, "%s:%d: patch %s: its values change in time, which this program does not follow",
                        dict_path(f->dict), f->patch[p].line, m->patch[p].name);
    return OK;
}

const char *field_item(int components) {
    return components == 6 ? "symmTensor" : components == 3 ? "vector" : "scalar";
}

static void path_of(const struct field_writer *w, const char *name, char path[PATH]) {
    snprintf(path, PATH, "%s/%s", w->folder, name);
}

/* Opens the file of a field, and writes what stands before the list of the cells' values. */
static status open_field(const struct field_writer *w, const char *name, int components, const signed char *dimensions,
                         struct sink **out) {
    char path[PATH];
    struct sink *s;
    const signed char *k = dimensions;
    path_of(w, name, path);
    TRY(sink_open(path, w->format->compress, &s));
    foam_header_write(s, w->format,
                      components == 6   ? "volSymmTensorField"
                      : components == 3 ? "volVectorField"
                                        : "volScalarField",
                      w->location, name, NULL);
    sink_printf(s, "dimensions      [%d %d %d %d %d %d %d];\n\n", k[0], k[1], k[2], k[3], k[4], k[5], k[6]);
    sink_printf(s, "internalField   nonuniform List<%s> ", field_item(components));
    *out = s;
    return OK;
}

static void print_entry(struct sink *s, const struct field_writer *w, int p, patch_printer *print,
                        const void *context) {
    sink_printf(s, "    %s\n    {\n", w->mesh->patch[p].name);
    print(s, w, p, context);
    sink_printf(s, "    }\n");
}

static const char before_patches[] = ";\n\nboundaryField\n{\n", behind_patches[] = "}\n";

status field_write(const struct field_writer *w, const char *name, int components, const signed char dimensions[7],
                   const double *values, patch_printer *print, const void *context, struct file_sum *sum) {
    struct sink *s;
    TRY(open_field(w, name, components, dimensions, &s));
    foam_list_write_doubles(s, w->format, components, w->mesh->ncells, values);
    sink_write(s, before_patches, sizeof before_patches - 1);
    for (int p = 0; p < w->mesh->npatches; p++) print_entry(s, w, p, print, context);
    sink_write(s, behind_patches, sizeof behind_patches - 1);
    foam_end_write(s);
    return sink_close_sum(s, sum);
}

status field_write_shared(const struct field_writer *w, const char *name, int components,
                          const signed char dimensions[7], const struct share *share, const double *slice,
                          const struct patch_entries *entries, struct file_sum *sum) {
    char path[PATH];
    struct sink *s = NULL;
    path_of(w, name, path);
    TRY(comm_agree(share->comm, comm_root(share->comm) ? open_field(w, name, components, dimensions, &s) : OK));
    status e = foam_list_write_shared(s, path, w->format, components, share, slice);
    if (s) sink_write(s, before_patches, sizeof before_patches - 1);
    for (int p = 0; p < w->mesh->npatches && !e; p++) {
        e = entries->prepare(w, p, entries->context);
        if (s && !e) print_entry(s, w, p, entries->print, entries->context);
    }
    if (s) sink_write(s, behind_patches, sizeof behind_patches - 1);
    if (s) foam_end_write(s);
    const status closed = s ? sink_close_sum(s, sum) : OK;
    if (e && closed) status_free(closed);
    return comm_agree(share->comm, e ? e : closed);
}
