/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and evaluates values of patches that follow a rule (varying.h), and those of walls that rotate (docs/physics.md
 * 5.3). */
#include "solvers/case/varying.h"

#include "solvers/dict/expr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- keywords ---- */

static const struct param varying_param[] = {
    NOTED("expression", "expression of x, y, z, t; of a vector three: (\"..\" \"..\" \"..\")", "none",
          "replaces the values", "expression \"0.3\";"),
    NOTED("expression", "three expressions of x, y, z, t: (\"..\" \"..\" \"..\")", "none", "of U instead of the values",
          "expression (\"0.3\" \"0\" \"0\");"),
};
static const struct param rate_param[] = {
    NOTED("volumetricFlowRate", "number in m^3/s, or table ((t v) (t v) ..)", "none",
          "by volume; instead of massFlowRate", "volumetricFlowRate 0.3;"),
    NOTED("extrapolateProfile", "switch: off", "off", "the velocity is uniform", "extrapolateProfile off;"),
    IGNORED("rhoInlet", "for OpenFOAM: rho on the patch is that of the field rho or alpha"),
};
/* Of walls that rotate, with omega last, which rotatingWallVelocity has as its value. */
static const struct param rotation_param[] = {
    NOTED("origin", "vector (x y z) in m", "required with omega", "a point on the axis", "origin (0 0 0);"),
    NOTED("axis", "vector (x y z)", "required with omega", "the axis, of any length: omega turns right-handed about it",
          "axis (0 1 0);"),
    NOTED("omega", "number in rad/s, table ((t v) (t v) ..), or \"expression of t\"", "none",
          "of a wall of gas that rotates, a surface of revolution; it replaces the velocity", "omega 0.3;"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

void varying_keywords(struct keywords *k, const struct boundary_type *type) {
    const bool scalar = boundary_value(type, 1), value = scalar || boundary_value(type, 3);
    if (type->giving == BY_RATE) keywords_params(k, rate_param, COUNT(rate_param));
    if (type->giving == BY_LIST && (value || type->velocity)) keywords_params(k, &varying_param[scalar ? 0 : 1], 1);
    if (strchr(k->file, ',')) k->only = "0.orig/U";
    if (boundary_rotates(type))
        keywords_params(k, rotation_param, COUNT(rotation_param) - (type->giving == BY_ROTATION));
}

void varying_entry(char entry[KEYWORD_TEXT], const struct boundary_type *type) {
    if (type->giving == BY_ROTATION) keywords_entries(entry, rotation_param, COUNT(rotation_param) - 1);
}

struct varying {
    struct dict *dict;
    const char *key, *patch; /* the entry, and the patch's name */
    int line, components, nfaces;
    struct expr *expr[3];
    const char *const *text; /* [components] of `expression`, [1] of valueExpr; NULL: a function of time */
    int ntexts;
    int knots, width; /* rows of the function, and their length: time and values, or time and a rate */
    const double *table;
    bool rate, wall;
    double *centre, *normal; /* [nfaces][3] m; unit, out of the domain */
    double area;             /* m^2 of the patch */
    /* Of a wall that rotates, whose function or expression is its angular velocity: */
    bool rotates;
    double origin[3], axis[3]; /* m; as given, of any length */
    double *lever;             /* [nfaces][3] m: the velocity of the wall at 1 rad/s */
    double *size;              /* [nfaces] m: the root of the area */
};

/* The keyword of a wall's own velocity, a parameter; NULL: the type has none. */
static const char *wall_motion(const struct boundary_type *t) {
    const struct model *m = &t->model;
    return t->wall && t->velocity && m->nparam && m->param->kind == PARAM_VECTOR ? m->param->name : NULL;
}

/* Does the rule depend on x, y, z or t (0 .. 3)? */
static bool uses(const struct varying *v, int variable) {
    bool any = false;
    for (int c = 0; c < v->components; c++) any |= v->expr[c] && expr_uses(v->expr[c], variable);
    return any;
}

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* ---- reading ---- */

static status take_geometry(struct varying *v, const struct polymesh *m, int patch) {
    const int nfaces = m->patch[patch].nfaces;
    TRY(allocate(&v->centre, 10L * nfaces + 1, sizeof *v->centre, "faces of a patch"));
    v->normal = v->centre + 3L * nfaces;
    v->lever = v->normal + 3L * nfaces;
    v->size = v->lever + 3L * nfaces;
    for (int i = 0; i < nfaces; i++) {
        double A[3];
        polymesh_patch_face(m, patch, i, v->centre + 3L * i, A);
        const double size = length(A);
        for (int k = 0; k < 3; k++) v->normal[3L * i + k] = A[k] / size;
        v->size[i] = sqrt(size);
        v->area += size * round_turn(&m->round, v->centre + 3L * i);
    }
    return OK;
}

/* Sets the velocity at face i of a wall that rotates at 1 rad/s; returns its component along the normal. */
static double find_lever(const struct varying *v, long i, double *lever) {
    const double *n = v->normal + 3 * i, size = length(v->axis);
    double through = 0;
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double *x = v->centre + 3 * i;
        lever[k] = (v->axis[a] * (x[b] - v->origin[b]) - v->axis[b] * (x[a] - v->origin[a])) / size;
    }
    for (int k = 0; k < 3; k++) through += n[k] * lever[k];
    return through;
}

/* Finds the velocities of a wall that rotates, at 1 rad/s. A surface of revolution rotates along itself, a mesh of it
 * but for the size of its faces: a triangle on a cylinder of radius r is turned about the axis by less than its size
 * over r, and what leads through it is left out. Sections of such a surface have no turn, because edges are chords. */
static status find_levers(struct varying *v, bool section) {
    for (long i = 0; i < v->nfaces; i++) {
        const double *x = v->centre + 3 * i, *n = v->normal + 3 * i;
        double *lever = v->lever + 3 * i;
        const double through = find_lever(v, i, lever);
        if (leads_along(3, lever, through)) continue;
        if (section || fabs(through) > 0.5 * v->size[i])
            return fail(ERR_INPUT,
                        "%s:%d: patch %s: a wall that rotates about the axis (%g %g %g) through (%g %g %g) would push "
                        "the gas at the face at (%g %g %g); it must be a surface of revolution about that axis: check "
                        "origin and axis, or give what does not rotate a patch of its own",
                        dict_path(v->dict), v->line, v->patch, v->axis[0], v->axis[1], v->axis[2], v->origin[0],
                        v->origin[1], v->origin[2], x[0], x[1], x[2]);
        for (int k = 0; k < 3; k++) lever[k] -= through * n[k];
    }
    return OK;
}

static status compile_one(struct varying *v, const char *text, int component, bool foam) {
    status s = foam ? expr_compile_foam(text, v->components == 3 ? component : -1, &v->expr[component])
                    : expr_compile(text, &v->expr[component]);
    return dict_note_expression(v->dict, v->key, text, s);
}

static status read_expressions(struct varying *v, bool foam) {
    TRY(dict_words(v->dict, v->key, &v->ntexts, &v->text));
    const int wanted = foam ? 1 : v->components;
    if (v->ntexts != wanted)
        return dict_fail(v->dict, v->key, "it holds %d expressions; wanted %s %s", v->ntexts,
                         wanted == 1 ? "is one:" : "are three:", wanted == 1 ? "\"...\"" : "(\"u\" \"v\" \"w\")");
    for (int c = 0; c < v->components; c++) TRY(compile_one(v, v->text[foam ? 0 : c], c, foam));
    return OK;
}

static status read_rate(struct varying *v) {
    const bool volume = dict_has(v->dict, "volumetricFlowRate");
    bool extrapolate;
    if (volume && dict_has(v->dict, v->key))
        return dict_fail(v->dict, v->key, "volumetricFlowRate is there, too; remove one");
    if (volume) v->key = "volumetricFlowRate";
    (void)dict_has(v->dict, "rhoInlet"); /* for OpenFOAM's tools: rho on the patch is that of the field rho or alpha */
    TRY(dict_switch_or(v->dict, "extrapolateProfile", false, &extrapolate));
    if (extrapolate)
        return dict_fail(v->dict, "extrapolateProfile",
                         "the profile is uniform here; for another one give the velocity "
                         "itself, as by exprFixedValue");
    TRY(dict_function(v->dict, v->key, 1, &v->knots, &v->table));
    v->rate = true;
    v->width = 2;
    return OK;
}

static status read_function(struct varying *v) {
    v->width = 1 + v->components;
    return dict_function(v->dict, v->key, v->components, &v->knots, &v->table);
}

/* Reads the angular velocity, a function of time or an expression of t, and the axis. */
static status read_rotation(struct varying *v) {
    struct lexer l;
    struct token t;
    v->rotates = true;
    v->line = dict_line(v->dict, v->key);
    TRY(dict_vector(v->dict, "origin", (const signed char[3]){0, 1, 0}, v->origin));
    TRY(dict_vector(v->dict, "axis", (const signed char[3]){0, 0, 0}, v->axis));
    if (length(v->axis) == 0) return dict_fail(v->dict, "axis", "a direction has a length");
    if (dict_has(v->dict, "expression"))
        return dict_fail(v->dict, "expression", "%s says how the wall moves; remove one of the two", v->key);
    TRY(dict_raw(v->dict, v->key, &l));
    TRY(lexer_next(&l, &t));
    v->width = 2;
    if (t.kind != TOKEN_STRING) return dict_function(v->dict, v->key, 1, &v->knots, &v->table);
    TRY(dict_words(v->dict, v->key, &v->ntexts, &v->text));
    TRY(compile_one(v, v->text[0], 0, false));
    return uses(v, 0) || uses(v, 1) || uses(v, 2) ? dict_fail(v->dict, v->key, "it may depend on t alone") : OK;
}

/* Reads the entry at v->key, which the type's row says how to read. */
static status read_entry(struct varying *v, const struct boundary_type *type) {
    const bool expression = !strcmp(v->key, "expression");
    if (!strcmp(v->key, "omega")) return read_rotation(v);
    if (type->giving == BY_RATE) TRY(read_rate(v));
    v->line = dict_line(v->dict, v->key);
    if (expression || type->giving == BY_EXPRESSION) return read_expressions(v, !expression);
    return type->giving == BY_RATE ? OK : read_function(v);
}

/* Does the value begin with the word `table`? */
static status find_table(struct dict *d, const char *key, bool *is_table) {
    struct lexer l;
    struct token t;
    *is_table = false;
    if (!dict_has(d, key)) return OK;
    TRY(dict_raw(d, key, &l));
    TRY(lexer_next(&l, &t));
    *is_table = token_is(&t, "table");
    return OK;
}

/* Finds the entry that gives a rule; NULL: there is none. */
static status find_key(struct dict *d, int components, const struct boundary_type *type, const char **key) {
    const char *value = boundary_value(type, components), *motion = components == 3 ? wall_motion(type) : NULL;
    bool table = false;
    *key = type->giving != BY_LIST                                             ? value
           : components == 3 && boundary_rotates(type) && dict_has(d, "omega") ? "omega"
                                                                               : NULL;
    if (*key || (!value && !motion)) return OK;
    if (motion && !value) TRY(find_table(d, motion, &table));
    if (table && dict_has(d, "expression"))
        return dict_fail(d, "expression", "%s is a table; remove one of the two", motion);
    *key = table ? motion : dict_has(d, "expression") ? "expression" : NULL;
    return OK;
}

status varying_read(struct dict *d, int components, const struct boundary_type *type, const struct polymesh *m,
                    int patch, struct varying **out) {
    const char *key;
    struct varying *v;
    *out = NULL;
    TRY(find_key(d, components, type, &key));
    if (!key) return OK;
    TRY(allocate(&v, 1, sizeof *v, "values of a patch"));
    *v = (struct varying){.dict = d,
                          .key = key,
                          .patch = m->patch[patch].name,
                          .components = components,
                          .nfaces = m->patch[patch].nfaces,
                          .wall = type->wall};
    status s = read_entry(v, type);
    if (!s) s = take_geometry(v, m, patch);
    if (!s && v->rotates && m->round.on && v->nfaces) /* the cells lie in a half plane through the axis */
        v->origin[3 - m->round.axial - m->round.radial] = v->centre[3 - m->round.axial - m->round.radial];
    if (!s && v->rotates) s = find_levers(v, polymesh_axes(m, (int[3]){0}) < 3);
    if (s)
        varying_free(v);
    else
        *out = v;
    return s;
}

void varying_free(struct varying *v) {
    if (!v) return;
    for (int c = 0; c < 3; c++) expr_free(v->expr[c]);
    free(v->centre);
    free(v);
}

/* ---- questions ---- */

bool varying_in_time(const struct varying *v) {
    return v->text ? uses(v, 3) : v->knots > 1;
}

bool varying_in_space(const struct varying *v) {
    return v->rate || v->rotates || uses(v, 0) || uses(v, 1) || uses(v, 2);
}

bool varying_leads(const struct varying *v, int x) {
    bool any = false;
    if (v->rate) return false; /* it leads along the normals, which the mesh has */
    for (long i = 0; i < v->nfaces && v->rotates; i++) any |= v->lever[3 * i + x] != 0;
    if (v->rotates) return any;
    if (v->text) {
        for (int i = 0; i < 4; i++) any |= expr_uses(v->expr[x], i);
        return any || expr_value(v->expr[x], 0, 0, 0, 0) != 0;
    }
    for (int i = 0; i < v->knots; i++) any |= v->table[i * v->width + 1 + x] != 0;
    return any;
}

bool varying_alike(const struct varying *v, long a, long b) {
    if (v->rate) return !memcmp(v->normal + 3 * a, v->normal + 3 * b, 3 * sizeof *v->normal);
    if (v->rotates) return !memcmp(v->lever + 3 * a, v->lever + 3 * b, 3 * sizeof *v->lever);
    for (int k = 0; k < 3; k++)
        if (uses(v, k) && v->centre[3 * a + k] != v->centre[3 * b + k]) return false;
    return true;
}

void varying_lead_note(struct varying_lead *lead, const double u[3], const double normal[3]) {
    const double through = u[0] * normal[0] + u[1] * normal[1] + u[2] * normal[2];
    *(leads_along(3, u, through) ? &lead->along : &lead->through) = true;
    lead->still |= u[0] == 0 && u[1] == 0 && u[2] == 0;
}

/* Of expressions in time only this is known: which components are 0 at all times. */
static void timed_lead(const struct varying *v, struct varying_lead *out) {
    out->along = out->still = true;
    for (long i = 0; i < 3L * v->nfaces; i++)
        out->through |= fabs(v->normal[i]) > 1e-6 && varying_leads(v, (int)(i % 3));
}

struct varying_lead varying_lead(const struct varying *v) {
    struct varying_lead out = {v->rate, false, false};
    if (v->text && varying_in_time(v)) timed_lead(v, &out);
    for (long i = 0; i < v->nfaces && v->text && !varying_in_time(v); i++) {
        const double *x = v->centre + 3 * i;
        double u[3];
        for (int c = 0; c < 3; c++) u[c] = expr_value(v->expr[c], x[0], x[1], x[2], 0);
        varying_lead_note(&out, u, v->normal + 3 * i);
    }
    for (int k = 0; k < v->knots && !v->rate; k++)
        for (long i = 0; i < v->nfaces; i++) varying_lead_note(&out, v->table + k * v->width + 1, v->normal + 3 * i);
    return out;
}

bool varying_is_volumetric(const struct varying *v) {
    return v->rate && strcmp(v->key, "massFlowRate") != 0;
}

const char *varying_key(const struct varying *v) {
    return v->key;
}

double varying_knot(const struct varying *v, double t) {
    for (int i = 0; i < v->knots && v->knots > 1; i++)
        if (v->table[i * v->width] > t + 1e-12 * fabs(t)) return v->table[i * v->width];
    return HUGE_VAL;
}

/* ---- values ---- */

/* Computes the columns of the table at time t: linear in between, constant outside. */
static void look_up(const struct varying *v, double t, double *out) {
    const double *row = v->table;
    int i = 1;
    while (i < v->knots && v->table[i * v->width] <= t) i++;
    row += (i - 1) * v->width;
    const bool between = i < v->knots && t > row[0];
    const double part = between ? (t - row[0]) / (row[v->width] - row[0]) : 0;
    for (int c = 1; c < v->width; c++) out[c - 1] = between ? row[c] + part * (row[v->width + c] - row[c]) : row[c];
}

/* The velocities of a wall that rotates. */
static void rotate(const struct varying *v, double t, double *out) {
    double omega;
    if (v->text)
        omega = expr_value(v->expr[0], 0, 0, 0, t);
    else
        look_up(v, t, &omega);
    for (long i = 0; i < 3L * v->nfaces; i++) out[i] = omega * v->lever[i];
}

void varying_at(const struct varying *v, double t, double *out) {
    const int n = varying_in_space(v) ? v->nfaces : 1;
    double row[3];
    if (v->rotates) {
        rotate(v, t, out);
        return;
    }
    if (!v->text) look_up(v, t, v->rate ? row : out);
    for (long i = 0; i < n && v->text; i++)
        for (int c = 0; c < v->components; c++) {
            const double *x = v->centre + 3 * i;
            out[i * v->components + c] = expr_value(v->expr[c], x[0], x[1], x[2], t);
        }
    for (long i = 0; i < 3L * n && v->rate; i++) out[i] = -v->normal[i] * (row[0] / v->area);
}

/* Returns the error for the values of face i. */
static status wrong(const struct varying *v, double t, const double *value, long i, const char *allowed,
                    enum status_kind kind) {
    const double *x = v->centre + 3 * i;
    char text[100];
    if (v->components == 3)
        snprintf(text, sizeof text, "(%g %g %g)", value[0], value[1], value[2]);
    else
        snprintf(text, sizeof text, "%g", value[0]);
    return fail(kind, "%s:%d: patch %s: %s gives %s at the face at (%g %g %g), t = %.10g; it must %s",
                dict_path(v->dict), v->line, v->patch, v->key, text, x[0], x[1], x[2], t, allowed);
}

status varying_check(const struct varying *v, double t, const double *values, const struct varying_range *range,
                     enum status_kind kind) {
    const bool each = varying_in_space(v) || v->wall; /* a wall has as many normals as faces */
    const int m = v->components;
    for (long i = 0; i < (each ? v->nfaces : 1); i++) {
        const double *q = values + (varying_in_space(v) ? i * m : 0), *n = v->normal + 3 * i;
        for (int c = 0; c < m; c++)
            if (!(fabs(q[c]) <= MOST_NUMBER)) return wrong(v, t, q, i, "lie between -1e60 and 1e60", kind);
        if (m == 1 && !(q[0] > range->low && q[0] < range->high)) return wrong(v, t, q, i, range->allowed, kind);
        if (m == 1) continue;
        const double along = q[0] * n[0] + q[1] * n[1] + q[2] * n[2];
        if (v->wall && !leads_along(3, q, along)) return wrong(v, t, q, i, "lead along the wall, not through it", kind);
        if (v->rate && along > 0) return wrong(v, t, q, i, "lead into the domain: a rate of 0 or more", kind);
    }
    return OK;
}

status varying_check_table(const struct varying *v, const struct varying_range *range) {
    double *values;
    status s = OK;
    TRY(allocate(&values, (long)v->nfaces * v->components + 3, sizeof *values, "values of a patch"));
    for (int i = 0; i < v->knots && !s; i++) {
        varying_at(v, v->table[i * v->width], values);
        s = varying_check(v, v->table[i * v->width], values, range, ERR_INPUT);
    }
    free(values);
    return s;
}

/* ---- printing ---- */

static void print_item(struct sink *s, int n, const double *value) {
    if (n == 3)
        sink_printf(s, "(%.17g %.17g %.17g)", value[0], value[1], value[2]);
    else
        sink_printf(s, "%.17g", value[0]);
}

static void print_vector(struct sink *s, const char *key, const double *value) {
    sink_printf(s, "        %-15s ", key);
    print_item(s, 3, value);
    sink_printf(s, ";\n");
}

void varying_print(struct sink *s, const struct varying *v) {
    const bool table = v->knots > 1;
    if (v->rotates) {
        print_vector(s, "origin", v->origin);
        print_vector(s, "axis", v->axis);
    }
    sink_printf(s, "        %-15s %s", v->key, v->text ? v->ntexts > 1 ? "(" : "" : table ? "table (" : "constant ");
    for (int i = 0; i < v->ntexts; i++) sink_printf(s, "%s\"%s\"", i ? " " : "", v->text[i]);
    for (int i = 0; i < v->knots; i++) {
        if (table) sink_printf(s, "%s(%.17g ", i ? " " : "", v->table[i * v->width]);
        print_item(s, v->width - 1, v->table + i * v->width + 1);
        if (table) sink_printf(s, ")");
    }
    sink_printf(s, "%s;\n", table || v->ntexts > 1 ? ")" : "");
}
