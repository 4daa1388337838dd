/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object surfaceFieldValue writes sums, averages, integrals and extremes of fields over patches, or over a
 * plane through the mesh, in the file surfaceFieldValue.dat of OpenFOAM; and what flows through it: phi, phiU and phiE
 * are mass (kg/s), momentum by flow, pressure and stress (N) and energy (W).
 *
 * Through patches these are what the last step took out of the gas by its own fluxes, over the length of the step.
 * Through a plane they are integrals of rho u.n, rho u u.n + p n, (rho E + p) u.n of the present state, of second
 * order; stress and conduction are not in them. */
#include "solvers/functions/functions_pieces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MASS_FLOW, MOMENTUM_FLOW, ENERGY_FLOW, FLOWS };
static const char *const flow_names[FLOWS] = {"phi", "phiU", "phiE"};
enum region { PATCH, PLANE };
enum operation {
    SUM,
    SUM_MAG,
    AVERAGE,
    AREA_AVERAGE,
    AREA_INTEGRATE,
    AREA_NORMAL_AVERAGE,
    AREA_NORMAL_INTEGRATE,
    WEIGHTED_SUM,
    WEIGHTED_AVERAGE,
    WEIGHTED_AREA_AVERAGE,
    WEIGHTED_AREA_INTEGRATE,
    MINIMUM,
    MAXIMUM
};
static const char *const operation_names[] = {"sum",
                                              "sumMag",
                                              "average",
                                              "areaAverage",
                                              "areaIntegrate",
                                              "areaNormalAverage",
                                              "areaNormalIntegrate",
                                              "weightedSum",
                                              "weightedAverage",
                                              "weightedAreaAverage",
                                              "weightedAreaIntegrate",
                                              "min",
                                              "max",
                                              NULL};
static const char *const region_names[] = {"patch", "sampledSurface", NULL};

struct surface_value {
    int region, operation; /* of the enums */
    bool area;             /* is the area written, too? */
    double scale;
    char name[128]; /* of the patches or the plane, for the file */
    int nfields;
    struct {
        int quantity, flow; /* one of the two; the other is -1 */
    } field[MAX_QUANTITIES + FLOWS];
    int weight; /* quantity; -1: none */
    bool flows; /* is any field a flow? */
    struct patch_choice patches;
    struct surface surface;
};

struct plane { /* what its dictionary says */
    double point[3], normal[3];
};

#define PARAM_STRUCT struct surface_value
static const struct param value_param[] = {
    NOTED("fields", "list of words: as all, and phi, phiU, phiE", NULL,
          "fields; flows of mass, momentum and energy: out of a patch, or along the normal of a plane", "fields (U);"),
    CHOICE("regionType", region, REQUIRED, region_names, "patches, or a plane"),
    NOTED("name", "list of words", "required for patch", "the patches: names, groups, or quoted regular expressions",
          "name \".*\";"),
    CHOICE("operation", operation, REQUIRED, operation_names,
           "of values on the faces of a patch, by its rules, or in what a plane cuts out of cells; flows have sum"),
    NOTED("weightField", "word", "none", "scalar field that weighted operations multiply by", "weightField none;"),
    NUMBER("scaleFactor", scale, 1, ANY_NUMBER, NO_UNIT, "that all values are multiplied by"),
    SWITCH("writeArea", area, false, "is the area written, too?"),
    IGNORED("surfaceFormat", "for OpenFOAM: no surfaces are written"),
    NOTED("sampledSurfaceDict", "dictionary", "required for sampledSurface", "the plane",
          "sampledSurfaceDict { type plane; basePoint (0.01 0.01 0); normalVector (1 0 0); }"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct plane
static const char *const plane_types[] = {"plane", NULL};
static const struct param plane_param[] = {
    ONLY("type", REQUIRED, plane_types, "a plane"),
    VECTOR("basePoint", point, REQUIRED_AS("basePoint (0.01 0.01 0);"), ANY_NUMBER, UNIT(0, 1, 0), "a point of it"),
    VECTOR("normalVector", normal, REQUIRED_AS("normalVector (1 0 0);"), ANY_NUMBER, NO_UNIT,
           "its normal, of any length; flows along it are positive"),
    IGNORED("interpolate", "for OpenFOAM: values are of second order"),
    IGNORED("source", "for OpenFOAM"),
};
#undef PARAM_STRUCT
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static void value_keywords(struct keywords *k) {
    keywords_at(k, FUNCTION_FILE, FUNCTION_DICT "/sampledSurfaceDict", NULL);
    keywords_params(k, plane_param, COUNT(plane_param));
}

/* ---- reading ---- */

static int flow_named(const struct medium *m, const char *name) {
    for (int k = 0; k < FLOWS && m->type->follow; k++)
        if (!strcmp(flow_names[k], name)) return k;
    return -1;
}

static status unknown_field(const struct function *f, struct dict *d, const char *key, const char *word, bool flows) {
    const struct medium *m = f->setup->medium;
    const char *names[MAX_QUANTITIES + FLOWS];
    int n = 0;
    for (int k = 0; k < m->fields.noffered; k++) names[n++] = m->fields.quantity[k].name;
    for (int k = 0; k < FLOWS && flows && m->type->follow; k++) names[n++] = flow_names[k];
    return dict_unknown(d, key, word, names, n);
}

static status read_fields(struct function *f, struct surface_value *v, struct dict *d) {
    const struct medium *m = f->setup->medium;
    const char *const *words;
    int n;
    TRY(dict_words(d, "fields", &n, &words));
    if (!n) return dict_fail(d, "fields", "it is empty");
    for (int i = 0; i < n; i++) {
        const int quantity = quantity_named(&m->fields, words[i]), flow = flow_named(m, words[i]);
        if (quantity < 0 && flow < 0) return unknown_field(f, d, "fields", words[i], true);
        for (int j = 0; j < v->nfields; j++)
            if (v->field[j].quantity == quantity && v->field[j].flow == flow)
                return dict_fail(d, "fields", "'%s' is listed twice", words[i]);
        if (flow >= 0 && v->operation != SUM)
            return dict_fail(d, "fields",
                             "'%s' is a flow through the whole surface, which goes with  operation sum;  alone",
                             words[i]);
        if (quantity >= 0) TRY(function_take(f, d, "fields", quantity));
        v->field[v->nfields].quantity = quantity;
        v->field[v->nfields++].flow = flow;
        v->flows |= flow >= 0;
    }
    return OK;
}

static bool is_weighted(const struct surface_value *v) {
    return v->operation >= WEIGHTED_SUM && v->operation <= WEIGHTED_AREA_INTEGRATE;
}

static status read_weight(struct function *f, struct surface_value *v, struct dict *d) {
    const struct medium *m = f->setup->medium;
    const char *word;
    v->weight = -1;
    TRY(dict_word_or(d, "weightField", "none", &word));
    if (strcmp(word, "none")) {
        v->weight = quantity_named(&m->fields, word);
        if (v->weight < 0) return unknown_field(f, d, "weightField", word, false);
        if (m->fields.quantity[v->weight].components != 1) return dict_fail(d, "weightField", "weights are numbers");
        TRY(function_take(f, d, "weightField", v->weight));
        if (!is_weighted(v)) return dict_fail(d, "weightField", "the operation has no weights; say  weighted..");
    } else if (is_weighted(v)) {
        return dict_missing(d, "weightField", "a weighted operation needs it: weightField rho;");
    }
    return OK;
}

static status read_plane(const struct function *f, struct surface_value *v, struct dict *d) {
    struct dict *sub;
    struct plane p;
    TRY(dict_sub(d, "sampledSurfaceDict", &sub));
    TRY(params_read(sub, plane_param, COUNT(plane_param), &p));
    if (!(p.normal[0] != 0 || p.normal[1] != 0 || p.normal[2] != 0))
        return dict_fail(sub, "normalVector", "a normal has a length");
    TRY(surface_of_plane(f, p.point, p.normal, &v->surface));
    if (!v->surface.n) return dict_fail(sub, "basePoint", "the plane through it does not cut the mesh");
    return OK;
}

/* Patches have no use for the dictionary of a plane, which may stand there all the same. */
static status skip_plane(struct dict *d) {
    struct dict *sub;
    TRY(dict_sub_optional(d, "sampledSurfaceDict", &sub));
    if (sub) dict_mark_used(sub);
    return OK;
}

static status read_name(struct surface_value *v, struct dict *d) {
    const char *const *words;
    int n, length = 0;
    TRY(dict_words(d, "name", &n, &words));
    for (int i = 0; i < n && length < (int)sizeof v->name; i++)
        length += snprintf(v->name + length, sizeof v->name - (size_t)length, "%s%s", i ? " " : "", words[i]);
    return OK;
}

static status value_make(struct function *f, struct dict *d) {
    struct surface_value *v = f->own;
    TRY(read_fields(f, v, d));
    TRY(read_weight(f, v, d));
    if (v->region == PATCH || dict_has(d, "name")) TRY(read_name(v, d));
    if (v->region == PLANE) return read_plane(f, v, d);
    TRY(skip_plane(d));
    TRY(patches_read(f, d, "name", &v->patches));
    return surface_of_patches(f, &v->patches, &v->surface);
}

/* ---- values ---- */

struct reduction { /* of the values of a surface */
    const struct surface *surface;
    int operation, components;
    const double *value, *weight; /* [n][components], [n] or NULL */
};

static bool is_normal(int operation) {
    return operation == AREA_NORMAL_AVERAGE || operation == AREA_NORMAL_INTEGRATE;
}

/* Returns the term of piece i in the sum of component k; *share: its term in the sum of weights, by which averages
 * divide. */
static double counted(const struct reduction *r, int i, int k, double *share) {
    const struct piece *p = &r->surface->piece[i];
    const double *v = r->value + (long)i * r->components, weight = r->weight ? r->weight[i] : 1;
    double normal = 0;
    *share = weight;
    switch (r->operation) {
    case AREA_AVERAGE:
    case AREA_INTEGRATE:
    case WEIGHTED_AREA_AVERAGE:
    case WEIGHTED_AREA_INTEGRATE:
        *share = weight * p->area;
        break;
    case AREA_NORMAL_AVERAGE:
    case AREA_NORMAL_INTEGRATE:
        for (int x = 0; x < r->components; x++) normal += v[x] * p->normal[x];
        *share = p->area;
        return normal * p->area;
    case SUM_MAG:
        return fabs(v[k]);
    default:
        break;
    }
    return *share * v[k];
}

static double reduce(const struct reduction *r, int k) {
    const bool extreme = r->operation == MINIMUM || r->operation == MAXIMUM;
    double sum = 0, whole = 0, least = HUGE_VAL, share;
    for (int i = 0; i < r->surface->n && !extreme; i++) {
        sum += counted(r, i, k, &share);
        whole += share;
    }
    for (int i = 0; i < r->surface->n && extreme; i++) {
        const double v = r->value[(long)i * r->components + k];
        least = fmin(least, r->operation == MAXIMUM ? -v : v);
    }
    switch (r->operation) {
    case MINIMUM:
        return least;
    case MAXIMUM:
        return -least;
    case AVERAGE:
    case AREA_AVERAGE:
    case AREA_NORMAL_AVERAGE:
    case WEIGHTED_AVERAGE:
    case WEIGHTED_AREA_AVERAGE:
        return sum / whole;
    default:
        return sum;
    }
}

struct flow { /* through a surface: mass, momentum, energy */
    double sum[1 + 3 + 1];
};

static void add_flow(const void *none, const struct crossing *face, double *sum) {
    (void)none;
    sum[0] += face->mass;
    for (int k = 0; k < 3; k++) sum[1 + k] += face->pressure[k] + face->viscous[k];
    sum[4] += face->energy;
}

static int written_quantity(const struct offered *m, const char *name) {
    for (const int *q = m->written; *q >= 0; q++)
        if (!strcmp(m->quantity[*q].name, name)) return *q;
    return -1;
}

static status flow_of_plane(const struct function *f, const struct surface *s, struct flow *out) {
    static const char *const names[] = {"rho", "U", "p", "rhoE"};
    double *q[4] = {NULL};
    status e = OK;
    for (int i = 0; i < 4; i++) {
        const status sampled = surface_sample(s, f, written_quantity(&f->setup->medium->fields, names[i]), &q[i]);
        if (!e)
            e = sampled;
        else
            status_free(sampled);
    }
    e = comm_agree(f->setup->comm, e);
    for (int i = 0; i < s->n && !e; i++) {
        const struct piece *p = &s->piece[i];
        const double *u = q[1] + 3L * i, speed = u[0] * p->normal[0] + u[1] * p->normal[1] + u[2] * p->normal[2];
        out->sum[0] += p->area * (q[0][i] * speed);
        for (int k = 0; k < 3; k++) out->sum[1 + k] += p->area * (q[0][i] * speed * u[k] + q[2][i] * p->normal[k]);
        out->sum[4] += p->area * ((q[3][i] + q[2][i]) * speed);
    }
    for (int i = 0; i < 4; i++) free(q[i]);
    return e;
}

static status find_flow(const struct function *f, const struct surface_value *v, struct flow *out) {
    double sum[PATCH_SUMS];
    *out = (struct flow){{0}};
    if (!v->flows) return OK;
    if (v->region == PLANE) return flow_of_plane(f, &v->surface, out);
    TRY(patches_sum(f, &v->patches, add_flow, NULL, 5, sum));
    memcpy(out->sum, sum, sizeof out->sum);
    return OK;
}

/* ---- output ---- */

static const char *field_name(const struct function *f, int i) {
    const struct surface_value *v = f->own;
    const int flow = v->field[i].flow;
    return flow >= 0 ? flow_names[flow] : f->setup->medium->fields.quantity[v->field[i].quantity].name;
}

static void value_head(const struct function *f, int which, FILE *o) {
    const struct surface_value *v = f->own;
    (void)which;
    fprintf(o, "# Region type : %s %s\n# %-12s: %d\n# %-12s: %.12g\n# %-12s: %.12g\n", region_names[v->region], v->name,
            "Faces", v->surface.n, "Area", v->surface.area, "Scale factor", v->scale);
    if (v->weight >= 0) fprintf(o, "# %-12s: %s\n", "Weight field", quantity_of(f, v->weight)->name);
    fprintf(o, "# %-12s", "Time");
    if (v->area) fprintf(o, "\tArea");
    for (int i = 0; i < v->nfields; i++) fprintf(o, "\t%s(%s)", operation_names[v->operation], field_name(f, i));
    fprintf(o, "\n");
}

static void write_value(const struct function *f, FILE *o, int i, const double *value, int components) {
    const struct surface_value *v = f->own;
    double scaled[3];
    for (int k = 0; k < components; k++) scaled[k] = v->scale * value[k];
    function_value(o, '\t', 15, components, scaled);
    if (!f->log) return;
    printf("    %s: %s(%s) =", f->name, operation_names[v->operation], field_name(f, i));
    function_value(stdout, ' ', 12, components, scaled);
    printf("\n");
}

/* Writes a field's column; all ranks sample it, the root writes. */
static status write_field(const struct function *f, FILE *o, int i, const struct flow *flow, const double *weight) {
    static const int first[FLOWS] = {0, 1, 4}, size[FLOWS] = {1, 3, 1};
    const struct surface_value *v = f->own;
    double *values, out[3];
    if (v->field[i].flow >= 0) {
        const int which = v->field[i].flow;
        if (o) write_value(f, o, i, flow->sum + first[which], size[which]);
        return OK;
    }
    const int m = quantity_of(f, v->field[i].quantity)->components;
    const status sampled = surface_sample(&v->surface, f, v->field[i].quantity, &values);
    if (!sampled && o) {
        const struct reduction r = {&v->surface, v->operation, m, values, weight};
        const int columns = is_normal(v->operation) ? 1 : m;
        for (int k = 0; k < columns; k++) out[k] = reduce(&r, k);
        write_value(f, o, i, out, columns);
    }
    free(values);
    return comm_agree(f->setup->comm, sampled);
}

static status write_row(struct function *f, double t, const struct flow *flow, const double *weight) {
    const struct surface_value *v = f->own;
    FILE *o;
    TRY(comm_agree(f->setup->comm, function_row(f, 0, t, &o)));
    if (v->area) function_value(o, '\t', 15, 1, &v->surface.area);
    for (int i = 0; i < v->nfields; i++) TRY(write_field(f, o, i, flow, weight));
    return comm_agree(f->setup->comm, function_end_row(f, o));
}

/* Before the first step nothing has flowed through patches: there is no row then. */
static status value_execute(struct function *f, const struct moment *now, const char *time) {
    struct surface_value *v = f->own;
    struct flow flow;
    double dt = 1, *weight = NULL;
    (void)time;
    if (v->flows && v->region == PATCH) TRY(patches_follow(f, &dt));
    if (dt == 0 || function_again(f, now->t)) return OK;
    TRY(find_flow(f, v, &flow));
    TRY(surface_renew(&v->surface));
    if (v->weight >= 0) TRY(comm_agree(f->setup->comm, surface_sample(&v->surface, f, v->weight, &weight)));
    const status e = write_row(f, now->t, &flow, weight);
    free(weight);
    return e;
}

static void value_free(void *own) {
    surface_free(&((struct surface_value *)own)->surface);
}

const struct function_type function_surface_value = {
    .name = "surfaceFieldValue",
    .about = "sums, averages, integrals, extremes over patches or a plane; flows of mass, momentum, energy",
    FUNCTION_PARAMS(value_param),
    .size = sizeof(struct surface_value),
    .keywords = value_keywords,
    .make = value_make,
    .execute = value_execute,
    .free = value_free,
    .table = {"surfaceFieldValue.dat"},
    .head = value_head,
    .width = 14,
    .no_fields = true,
};
