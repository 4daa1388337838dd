/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lays a layer of grains into the cells at the start (layers.h): reads its dictionaries, measures the box, finds the
 * column's mass. */
#include "solvers/gas/layers.h"

#include "libcore/grains/random.h"
#include "mesh/format/boxes.h"
#include "solvers/dict/params.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.28318530717958647692

struct layers {
    struct dict *file;
    bool settled, perturbed;
    double depth, packing, laid, background; /* as in settled_param; packing, laid: 0 is the default named there */
    bool hydrostatic;
    double amplitude;
    int of_depth;          /* index of of_words */
    int modes, seed, axis; /* axis: -1 the longest that is cyclic and lies across gravity */
};

static const char *const of_words[] = {"density", "depth", NULL}, *const axis_words[] = {"x", "y", "z", NULL};
#define PARAM_STRUCT struct layers
static const struct param settled_param[] = {
    NUMBER("depth", depth, REQUIRED_AS("depth 6;"), POSITIVE, NO_UNIT, "in grain diameters"),
    NUMBER("packing", packing, 0, FROM_TO(0, 1), NO_UNIT,
           "of that depth: both say the mass; 0: alphaMax of the equation of state"),
    SWITCH("hydrostatic", hydrostatic, true,
           "alpha falls with height so that the layer rests at the uniform T of the case"),
    NUMBER("laidAt", laid, 0, FROM_TO(0, 1), NO_UNIT,
           "packing of the uniform layer (hydrostatic no), which is as deep as its mass asks; 0: packing"),
    NUMBER("background", background, 1e-6, BETWEEN(0, 1), NO_UNIT,
           "least packing of a cell; counted in the mass of the layer"),
};
static const struct param perturbation_param[] = {
    WHOLE("modes", modes, 20, FROM_TO(1, 100000), "the longest waves of the box"),
    NUMBER("amplitude", amplitude, REQUIRED_AS("amplitude 1e-3;"), FROM_TO(0, 1), NO_UNIT, "of each, relative"),
    WHOLE("seed", seed, 1, FROM_TO(0, 2147483647), "of their phases"),
    CHOICE("of", of_depth, 0, of_words, "what it multiplies: density, or the mass of each column of a settledLayer"),
    CHOICE("axis", axis, USUALLY(-1, "the longest"), axis_words, "a cyclic one; default the longest across gravity"),
};
static const struct param file_param[] = {
    NOTED("settledLayer", "dictionary", "none",
          "a layer at rest on the side of the box that gravity points to, in place of internalField",
          "settledLayer { depth 6; packing 0.82; }"),
    NOTED("perturbation", "dictionary", "none", "a factor 1 + amplitude sum sin(2 pi (k x/L + random phase))",
          "perturbation { modes 20; amplitude 1e-3; seed 1; }"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static status read_settled(struct dict *d, struct layers *l) {
    TRY(params_read(d, settled_param, COUNT(settled_param), l));
    if (l->hydrostatic && l->laid > 0)
        return dict_fail(d, "laidAt", "it is the packing of a uniform layer; remove it, or say  hydrostatic no;");
    return OK;
}

static status read_perturbation(struct dict *d, struct layers *l) {
    TRY(params_read(d, perturbation_param, COUNT(perturbation_param), l));
    if (l->of_depth && !l->settled) return dict_fail(d, "of", "only a settledLayer has a depth; say  of density;");
    return OK;
}

/* Takes the dictionaries of layers from a field's file: a field_reader, whose context is a struct layers **. */
static status read_layers(void *context, struct dict *d, struct field_plan *plan) {
    struct layers **out = context;
    struct dict *settled = NULL, *perturbation = NULL;
    if (dict_has(d, "settledLayer")) TRY(dict_sub(d, "settledLayer", &settled));
    if (dict_has(d, "perturbation")) TRY(dict_sub(d, "perturbation", &perturbation));
    if (!settled && !perturbation) return OK;
    if (settled && dict_has(d, "expression"))
        return dict_fail(d, "expression", "settledLayer says it all; remove one of them");
    TRY(allocate(out, 1, sizeof **out, "a layer"));
    (*out)->file = d;
    (*out)->settled = settled != NULL;
    (*out)->perturbed = perturbation != NULL;
    (*out)->axis = -1;
    *plan = (struct field_plan){.changes = true, .fills = settled ? "settledLayer" : NULL};
    if (settled) TRY(read_settled(settled, *out));
    return perturbation ? read_perturbation(perturbation, *out) : OK;
}

status layers_read_field(const char *path, enum field_id id, const struct field_place *place, struct layers **layers,
                         struct field **field) {
    *layers = NULL;
    if (id != FIELD_RHO && id != FIELD_ALPHA) return field_read(path, &field_kinds[id], place, field);
    status s = field_read_with(path, &field_kinds[id], place, read_layers, layers, field);
    if (s) {
        layers_free(*layers);
        *layers = NULL;
    }
    return s;
}

void layers_free(struct layers *l) {
    free(l);
}

bool layers_calm(struct layers *l, double *background) {
    if (!l) return false;
    l->perturbed = false;
    *background = l->background;
    return l->settled && l->hydrostatic;
}

void layers_list(FILE *f) {
    fprintf(f, "\n0.orig/alpha or rho: settledLayer { }, at rest on the side of the box that gravity points to\n");
    params_print(f, settled_param, COUNT(settled_param));
    fprintf(f, "\n0.orig/alpha or rho: perturbation { }, 1 + amplitude sum sin(2 pi (k x/L + random phase))\n");
    params_print(f, perturbation_param, COUNT(perturbation_param));
}

void layers_keywords(struct keywords *k) {
    static const char where[] = "0.orig/alpha, 0.orig/rho";
    keywords_at(k, where, "", NULL);
    keywords_params(k, file_param, COUNT(file_param));
    keywords_at(k, where, file_param[0].name, NULL);
    keywords_params(k, settled_param, COUNT(settled_param));
    keywords_at(k, where, file_param[1].name, NULL);
    keywords_params(k, perturbation_param, COUNT(perturbation_param));
}

/* ---- on the cells ---- */

struct bed { /* what the functions below share; lengths in m */
    const struct layers *l;
    const struct field_place *place;
    const struct gas_models *models;
    int n, up;                 /* up: the axis of gravity, or -1 */
    double low[3], high[3], g; /* corners of the box; m/s^2 */
    bool down;                 /* does gravity point to the low side of the axis? */
    /* [n] volume of a cell; its lower and upper height above the floor; factor of the waves there */
    double *volume, (*reach)[2], *factor;
    struct column *column;   /* the isothermal column; NULL: the layer is uniform, or at rest in layers */
    struct resting *resting; /* NULL: the cells do not lie in layers */
    int layers, columns;     /* of it */
    int *layer, *of_column;  /* [n] of each cell */
    double *factors;         /* [columns] of the waves, in rising order */
    double *rho;             /* [columns][layers] */
    double per, area, laid;  /* alpha / rho; m^2: of the floor; packing of a uniform layer */
};

/* Returns the error "FILE:LINE: settledLayer: <format..>". */
static status cannot(const struct layers *l, const char *what, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static status cannot(const struct layers *l, const char *what, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return fail(ERR_INPUT, "%s:%d: %s: %s", dict_path(l->file), dict_line(l->file, what), what, text);
}

/* Finds the axis of gravity; a settled layer needs gravity along exactly one axis. */
static status find_gravity(struct bed *b, int dim, const int axis[3]) {
    const double *g = b->models->source.gravity;
    int along = 0;
    b->up = -1;
    for (int k = 0; k < dim; k++) {
        if (g[k] == 0) continue;
        along++;
        b->up = axis[k];
        b->g = fabs(g[k]);
        b->down = g[k] < 0;
    }
    if (along == 1 || !b->l->settled) return OK;
    return cannot(b->l, "settledLayer", "it needs gravity (constant/g) along one of the axes solved");
}

/* Sets volume and heights of the cells of a mesh of boxes. */
static status take_boxes(struct bed *b, const struct boxes *boxes) {
    const int up = b->up;
    for (int i = 0; i < b->n; i++) {
        int at[3];
        b->volume[i] = boxes->width[0] * boxes->width[1] * boxes->width[2];
        if (up < 0) continue;
        boxes_at(boxes, i, at);
        const double bottom = boxes_plane(boxes, up, at[up]), top = boxes_plane(boxes, up, at[up] + 1);
        b->reach[i][0] = b->down ? bottom - b->low[up] : b->high[up] - top;
        b->reach[i][1] = b->down ? top - b->low[up] : b->high[up] - bottom;
    }
    return OK;
}

/* Measures the box, and volume and heights of every cell. */
static status measure_cells(struct bed *b) {
    const struct polymesh *m = b->place->mesh;
    double *face = NULL, *centre = NULL;
    polymesh_bounds(m, b->low, b->high);
    TRY(allocate(&b->factor, b->n, sizeof(double), "a layer"));
    TRY(allocate(&b->volume, b->n, sizeof(double), "a layer"));
    TRY(allocate(&b->reach, b->n, sizeof *b->reach, "a layer"));
    if (m->boxes) return take_boxes(b, m->boxes);
    TRY(allocate(&face, 6L * m->nfaces + 3L * m->ncells, sizeof(double), "a layer"));
    centre = face + 6L * m->nfaces;
    polymesh_face_geometry(m, face, face + 3L * m->nfaces);
    status e = polymesh_cell_geometry(m, face, face + 3L * m->nfaces, centre, b->volume);
    free(face);
    TRY(e);
    for (int i = 0; i < b->n; i++) {
        b->reach[i][0] = HUGE_VAL;
        b->reach[i][1] = -HUGE_VAL;
    }
    for (int f = 0; b->up >= 0 && f < m->nfaces; f++)
        for (int p = m->face_start[f]; p < m->face_start[f + 1]; p++) {
            const double x = m->points[3L * m->face_points[p] + b->up],
                         h = b->down ? x - b->low[b->up] : b->high[b->up] - x;
            const int sides[2] = {m->owner[f], f < m->ninternal ? m->neighbour[f] : m->owner[f]};
            for (int s = 0; s < 2; s++) {
                b->reach[sides[s]][0] = fmin(b->reach[sides[s]][0], h);
                b->reach[sides[s]][1] = fmax(b->reach[sides[s]][1], h);
            }
        }
    return OK;
}

/* Computes the volume of the mesh. Fails if the mesh is no box: grains that lie over a floor of another shape are no
 * layer. */
static status check_box(const struct bed *b, double *out) {
    double box = 1, sum = 0;
    for (int a = 0; a < 3; a++) box *= b->high[a] - b->low[a];
    for (int i = 0; i < b->n; i++) sum += b->volume[i];
    *out = sum;
    if (fabs(sum - box) < 1e-9 * box) return OK;
    return cannot(b->l, "settledLayer", "the mesh is no box along the axes (%g m^3 of %g); give an expression", sum,
                  box);
}

/* Finds which axes are cyclic: the area vector of the first face of a cyclic patch lies along its axis. */
static void cyclic_axes(const struct polymesh *m, bool cyclic[3]) {
    for (int a = 0; a < 3; a++) cyclic[a] = false;
    for (int p = 0; p < m->npatches; p++) {
        double centre[3], s[3];
        if (strcmp(m->patch[p].type, "cyclic") || !m->patch[p].nfaces) continue;
        polymesh_patch_face(m, p, 0, centre, s);
        int most = fabs(s[1]) > fabs(s[0]) ? 1 : 0;
        cyclic[fabs(s[2]) > fabs(s[most]) ? 2 : most] = true;
    }
}

/* Finds the axis of the waves: the one asked for, or the longest that is cyclic and lies across gravity. */
static status waves_axis(const struct bed *b, int *out) {
    bool cyclic[3];
    cyclic_axes(b->place->mesh, cyclic);
    *out = b->l->axis;
    for (int a = 0; a < 3 && b->l->axis < 0; a++)
        if (cyclic[a] && a != b->up && (*out < 0 || b->high[a] - b->low[a] > b->high[*out] - b->low[*out])) *out = a;
    if (*out >= 0 && cyclic[*out] && *out != b->up) return OK;
    return cannot(b->l, "perturbation", "waves need an axis that is cyclic and lies across gravity: %s%s",
                  *out < 0 ? "none does" : axis_words[*out], *out < 0 ? "" : " does not");
}

/* Computes the factor of the waves in every cell. */
static status make_waves(struct bed *b) {
    const struct layers *l = b->l;
    double *phase = NULL;
    int axis = -1;
    for (int i = 0; i < b->n; i++) b->factor[i] = 1;
    if (!l->perturbed) return OK;
    TRY(waves_axis(b, &axis));
    TRY(allocate(&phase, l->modes, sizeof(double), "waves"));
    struct random r = random_make((uint64_t)l->seed, 0);
    for (int k = 0; k < l->modes; k++) phase[k] = random_uniform(&r);
    bool positive = true;
    for (int i = 0; i < b->n; i++) {
        double centre[3], sum = 0;
        field_centre(b->place, i, centre);
        const double x = (centre[axis] - b->low[axis]) / (b->high[axis] - b->low[axis]);
        for (int k = 0; k < l->modes; k++) sum += sin(TWO_PI * ((k + 1) * x + phase[k]));
        b->factor[i] = 1 + l->amplitude * sum;
        positive = positive && b->factor[i] > 0;
    }
    free(phase);
    return positive ? OK
                    : cannot(b->l, "perturbation", "the waves together leave no density in places; lower amplitude");
}

/* Compares numbers for qsort and bsearch. */
static int in_order(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts n numbers and drops those that exceed the one before by no more than `same`; returns how many are left. */
static int unique(int n, double same, double *x) {
    int left = 0;
    qsort(x, (size_t)n, sizeof *x, in_order);
    for (int i = 0; i < n; i++)
        if (!left || x[i] - x[left - 1] > same) x[left++] = x[i];
    return left;
}

/* Returns the place of the number of a rising list that is nearest to x. */
static int nearest(int n, const double *list, double x) {
    int low = 0, high = n - 1;
    while (high - low > 1) *(list[(low + high) / 2] <= x ? &low : &high) = (low + high) / 2;
    return x - list[low] <= list[high] - x ? low : high;
}

/* Finds the layers in which all cells lie, by their floors: bottom[layers]. None if a cell is higher than its layer. */
static void find_layers(struct bed *b, double *bottom) {
    const double height = b->high[b->up] - b->low[b->up], same = 1e-9 * height;
    for (int i = 0; i < b->n; i++) bottom[i] = b->reach[i][0];
    b->layers = unique(b->n, same, bottom);
    for (int i = 0; i < b->n && b->layers; i++) {
        b->layer[i] = nearest(b->layers, bottom, b->reach[i][0]);
        const double top = b->layer[i] + 1 < b->layers ? bottom[b->layer[i] + 1] : height;
        if (fabs(b->reach[i][1] - top) > same) b->layers = 0;
    }
}

/* Makes the column at rest if all cells lie in layers, each of one T. */
static status make_resting(struct bed *b, const struct field *T) {
    double *bottom = NULL, *thick, *of_layer;
    TRY(allocate(&b->layer, 2L * b->n, sizeof(int), "a layer"));
    TRY(allocate(&b->factors, b->n, sizeof(double), "a layer"));
    TRY(allocate(&bottom, 3L * b->n, sizeof(double), "a layer"));
    thick = bottom + b->n;
    of_layer = thick + b->n;
    b->of_column = b->layer + b->n;
    find_layers(b, bottom);
    for (int j = 0; j < b->layers; j++)
        thick[j] = (j + 1 < b->layers ? bottom[j + 1] : b->high[b->up] - b->low[b->up]) - bottom[j];
    for (int i = b->n - 1; i >= 0 && b->layers; i--) of_layer[b->layer[i]] = T->values[i];
    status s = OK;
    for (int i = 0; i < b->n && b->layers && !s; i++)
        if (!(T->values[i] > 0))
            s = field_fail(T, b->place, i, "it must be greater than 0");
        else if (T->values[i] != of_layer[b->layer[i]])
            s = field_fail(T, b->place, i,
                           "a hydrostatic settledLayer needs one T at each height, and another cell of this height has "
                           "%g; or say in it  hydrostatic no;",
                           of_layer[b->layer[i]]);
    if (!s && b->layers) s = resting_make(b->models, b->g, b->layers, thick, of_layer, &b->resting);
    free(bottom);
    if (s || !b->layers) return s;
    for (int i = 0; i < b->n; i++) b->factors[i] = b->l->of_depth ? b->factor[i] : 1;
    b->columns = unique(b->n, 0, b->factors);
    for (int i = 0; i < b->n; i++) b->of_column[i] = nearest(b->columns, b->factors, b->l->of_depth ? b->factor[i] : 1);
    return allocate(&b->rho, (long)b->columns * b->layers, sizeof(double), "a layer");
}

/* Computes the columns at rest of the mass per area `mass`, times the waves' factors. */
static status rest_columns(const struct bed *b, double mass) {
    double *masses;
    TRY(allocate(&masses, b->columns, sizeof(double), "a layer"));
    for (int c = 0; c < b->columns; c++) masses[c] = mass * b->factors[c];
    resting_columns(b->resting, b->columns, masses, b->rho);
    free(masses);
    return OK;
}

/* Returns alpha of a cell, without background, in a column of `mass` per area (kg/m^2). */
static double packing_of(const struct bed *b, int i, double mass) {
    const double low = b->reach[i][0], high = b->reach[i][1];
    if (b->resting) return b->per * b->rho[(long)b->of_column[i] * b->layers + b->layer[i]];
    if (!b->column) return b->laid * fmin(fmax(mass * b->per / b->laid - low, 0) / (high - low), 1);
    const double bottom = column_bottom(b->column, mass);
    return b->per * (column_above(b->column, bottom, low) - column_above(b->column, bottom, high)) / (high - low);
}

/* Sets alpha of a layer of the nominal `mass` per area; *held is the mass that the box then holds per area of its
 * floor. */
static status fill(const struct bed *b, double mass, double *alpha, double *held) {
    double sum = 0;
    if (b->resting) TRY(rest_columns(b, mass));
    for (int i = 0; i < b->n; i++) {
        const double flat = b->l->of_depth ? 1 : b->factor[i], column = b->l->of_depth ? mass * b->factor[i] : mass;
        alpha[i] = fmax(flat * packing_of(b, i, column), b->l->background);
        sum += alpha[i] * b->volume[i];
    }
    *held = sum / b->area / b->per;
    return OK;
}

/* Sets alpha so that the box holds `mass`. The background, waves that do not sum to zero over uneven cells, and cells
 * that are no boxes change the mass a little, so the nominal mass is moved until the box holds what was asked for. */
static status settle(const struct bed *b, double mass, double *alpha) {
    enum { TRIALS = 100 };
    double nominal = mass, held, missing;
    TRY(fill(b, nominal, alpha, &held));
    missing = mass - held;
    for (int k = 0; k < TRIALS && fabs(missing) > 1e-15 * mass; k++) {
        nominal += missing;
        if (!(nominal > 0)) break;
        TRY(fill(b, nominal, alpha, &held));
        missing = mass - held;
    }
    if (fabs(missing) < 1e-12 * mass) return OK;
    return cannot(b->l, "settledLayer",
                  "the box cannot hold it: of %g kg/m^2 %g are missing; lower depth, or background, or raise the lid",
                  mass, missing);
}

static status make_column(struct bed *b, double mass, const struct field *T) {
    double most = 1;
    if (!T) return cannot(b->l, "settledLayer", "a hydrostatic layer needs T, not p; or say  hydrostatic no;");
    TRY(make_resting(b, T));
    if (b->resting) return OK;
    for (int i = 1; i < b->n; i++)
        if (T->values[i] != T->values[0])
            return field_fail(T, b->place, i,
                              "a hydrostatic settledLayer needs one T everywhere where cells do not lie in layers, and "
                              "cell 0 has %g; or say in it  hydrostatic no;",
                              T->values[0]);
    if (!(T->values[0] > 0)) return field_fail(T, b->place, 0, "it must be greater than 0");
    for (int i = 0; i < b->n; i++) most = fmax(most, b->factor[i]);
    return column_make(b->models, b->g, T->values[0], 1.5 * most * mass, b->high[b->up] - b->low[b->up], &b->column);
}

static status lay(struct bed *b, const struct field *T, double *alpha) {
    const struct material *m = &b->models->material;
    const double height = b->high[b->up] - b->low[b->up], packing = b->l->packing > 0 ? b->l->packing : m->alpha_max;
    double volume;
    TRY(check_box(b, &volume));
    if (m->diameter == 0) return cannot(b->l, "settledLayer", "its depth is in diameters, and grain.diameter is 0");
    b->area = volume / height;
    b->laid = b->l->laid > 0 ? b->l->laid : packing;
    /* thickness of the grains alone, without the space between them */
    const double thickness = packing * b->l->depth * m->diameter;
    if (thickness >= height * (b->l->hydrostatic ? m->alpha_max : b->laid))
        return cannot(b->l, "settledLayer", "it is deeper than the box is high (%g); lower depth", height);
    if (b->l->hydrostatic) TRY(make_column(b, thickness / b->per, T));
    return settle(b, thickness / b->per, alpha);
}

static status apply(struct bed *b, const struct field *T, bool is_alpha, double *values) {
    TRY(measure_cells(b));
    TRY(make_waves(b));
    if (b->l->settled) TRY(lay(b, T, values));
    for (int i = 0; i < b->n; i++) values[i] *= b->l->settled ? (is_alpha ? 1 : 1 / b->per) : b->factor[i];
    return OK;
}

status layers_apply(const struct layers *l, struct field *f, const struct field_place *place, int dim,
                    const int axis[3], const struct gas_models *models, const struct field *T) {
    struct bed b = {.l = l,
                    .place = place,
                    .models = models,
                    .n = place->mesh->ncells,
                    .per = packing_per_density(&models->material)};
    if (!l) return OK;
    TRY(find_gravity(&b, dim, axis));
    status e = apply(&b, T, f->kind == &field_kinds[FIELD_ALPHA], f->values);
    free(b.volume);
    free(b.reach);
    free(b.factor);
    free(b.layer);
    free(b.factors);
    free(b.rho);
    column_free(b.column);
    resting_free(b.resting);
    return e;
}
