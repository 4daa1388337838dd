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
           "least packing of a cell; counted in the mass of the layer, of which it may add 1 %"),
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
          "a layer at rest on the side of the box that gravity points to; it replaces internalField",
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

bool layers_flatten(struct layers *l, double *background) {
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
    long first;                /* of the cells that are read: those of a slice, or all */
    int n, up;                 /* how many they are; the axis of gravity, or -1 */
    double low[3], high[3], g; /* corners of the box; m/s^2 */
    bool down;                 /* does gravity point to the low side of the axis? */
    /* [n] volume of a cell; its lower and upper height above the floor; factor of the waves there */
    double *volume, (*reach)[2], *factor;
    struct column *column;         /* the isothermal column; NULL: the layer is uniform, or at rest in layers */
    struct resting *resting;       /* NULL: the cells do not lie in layers */
    int layers, columns;           /* of all cells; of these cells */
    int *layer;                    /* [n] of each cell */
    double *factors;               /* [columns] of the waves, in rising order */
    int *column_start, *by_column; /* [columns + 1]; [n] the cells, column by column */
    double *rest;                  /* [n] rho at rest */
    double *term;                  /* [n] of a sum over all cells */
    double per, area, laid;        /* alpha / rho; m^2: of the floor; packing of a uniform layer */
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

/* What holds on one rank holds on all: an error, the least number, the sum of numbers in the order of the cells. */
static status agree(const struct bed *b, status e) {
    return field_agree(b->place, e);
}

static double least(const struct bed *b, double x) {
    if (b->place->share) comm_min(b->place->share->comm, &x, 1);
    return x;
}

static double sum_terms(const struct bed *b) {
    const struct comm *all = b->place->share ? b->place->share->comm : NULL;
    double sum = 0;
    if (all) comm_take_turn(all, &sum, 1);
    for (int i = 0; i < b->n; i++) sum += b->term[i];
    if (all) comm_end_turn(all, &sum, 1);
    return sum;
}

/* Sets volume and heights of the cells of a mesh of boxes. */
static void take_boxes(struct bed *b, const struct boxes *boxes) {
    const int up = b->up;
    for (int i = 0; i < b->n; i++) {
        int at[3];
        b->volume[i] = boxes->width[0] * boxes->width[1] * boxes->width[2];
        if (up < 0) continue;
        boxes_at(boxes, b->first + i, at);
        const double bottom = boxes_plane(boxes, up, at[up]), top = boxes_plane(boxes, up, at[up] + 1);
        b->reach[i][0] = b->down ? bottom - b->low[up] : b->high[up] - top;
        b->reach[i][1] = b->down ? top - b->low[up] : b->high[up] - bottom;
    }
}

/* Sets volume and heights of the cells from arrays of a mesh in which they stand from number `base` on, and in which
 * cells have the volumes given. */
static void take_arrays(struct bed *b, const struct polymesh *m, int base, const double *volume) {
    memcpy(b->volume, volume + base, (size_t)b->n * sizeof *volume);
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
                const int i = sides[s] - base;
                if (i < 0 || i >= b->n) continue;
                b->reach[i][0] = fmin(b->reach[i][0], h);
                b->reach[i][1] = fmax(b->reach[i][1], h);
            }
        }
}

static status take_whole(struct bed *b, const struct polymesh *m) {
    double *face = NULL, *centre, *volume;
    TRY(allocate(&face, 6L * m->nfaces + 4L * m->ncells, sizeof(double), "a layer"));
    centre = face + 6L * m->nfaces;
    volume = centre + 3L * m->ncells;
    polymesh_face_geometry(m, face, face + 3L * m->nfaces);
    const status e = polymesh_cell_geometry(m, face, face + 3L * m->nfaces, centre, volume);
    if (!e) take_arrays(b, m, 0, volume);
    free(face);
    return e;
}

/* Takes the cells of a slice from the mesh spread over the ranks; a lattice of which each rank knows slices of sites is
 * read so for that. */
static status take_slice(struct bed *b) {
    const struct polymesh *m = b->place->mesh;
    const struct spread *s = b->place->spread;
    struct spread *read = NULL;
    struct polymesh *again = NULL;
    if (!s) TRY(spread_read(m->outline->dir, b->place->share->comm, false, false, &read, &again));
    const bool same = s || (again && polymesh_checksum(again) == polymesh_checksum(m));
    if (!s) s = read;
    if (same) take_arrays(b, &s->home.mesh, s->base, s->geometry.volume);
    spread_free(read);
    polymesh_free(again);
    if (same) return OK;
    return fail(ERR_INPUT, "%s: it has changed since the run began; start the run anew", m->outline->dir);
}

/* Measures the box and, for a layer, volume and heights of the cells. */
static status measure_cells(struct bed *b) {
    const struct polymesh *m = b->place->mesh;
    polymesh_bounds(m, b->low, b->high);
    status e = allocate(&b->factor, b->n, sizeof(double), "a layer");
    if (!e) e = allocate(&b->term, b->n, sizeof(double), "a layer");
    if (!e) e = allocate(&b->volume, b->n, sizeof(double), "a layer");
    if (!e) e = allocate(&b->reach, b->n, sizeof *b->reach, "a layer");
    TRY(agree(b, e));
    if (!b->l->settled) return OK;
    if (m->boxes) take_boxes(b, m->boxes);
    if (m->boxes) return OK;
    return b->place->share ? take_slice(b) : take_whole(b, m);
}

/* Computes the volume of the mesh. Fails if the mesh is no box: grains that lie over a floor of another shape are no
 * layer. */
static status check_box(const struct bed *b, double *out) {
    double box = 1;
    for (int a = 0; a < 3; a++) box *= b->high[a] - b->low[a];
    memcpy(b->term, b->volume, (size_t)b->n * sizeof *b->term);
    const double sum = *out = sum_terms(b);
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
    TRY(agree(b, allocate(&phase, l->modes, sizeof(double), "waves")));
    struct random r = random_make((uint64_t)l->seed, 0);
    for (int k = 0; k < l->modes; k++) phase[k] = random_uniform(&r);
    bool positive = true;
    for (int i = 0; i < b->n; i++) {
        double centre[3], sum = 0;
        field_centre(b->place, b->first + i, centre);
        const double x = (centre[axis] - b->low[axis]) / (b->high[axis] - b->low[axis]);
        for (int k = 0; k < l->modes; k++) sum += sin(TWO_PI * ((k + 1) * x + phase[k]));
        b->factor[i] = 1 + l->amplitude * sum;
        positive = positive && b->factor[i] > 0;
    }
    free(phase);
    positive = least(b, positive) > 0;
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

/* Makes the list of the floors of all cells, rising, those that differ by no more than `same` once. */
static status list_floors(const struct bed *b, double same, int *n, double **out) {
    double *mine = NULL;
    TRY(agree(b, allocate(&mine, b->n, sizeof *mine, "a layer")));
    for (int i = 0; i < b->n; i++) mine[i] = b->reach[i][0];
    *n = unique(b->n, 0, mine);
    *out = mine;
    if (!b->place->share) {
        *n = unique(*n, same, mine);
        return OK;
    }
    const struct comm *c = b->place->share->comm;
    const int size = comm_size(c);
    int *count = NULL;
    *out = NULL;
    status e = comm_agree(c, allocate(&count, 2L * size + 1, sizeof *count, "a layer"));
    if (!e) e = comm_share_count(c, *n, count, count + size);
    if (!e) e = comm_agree(c, allocate(out, count[2 * size], sizeof **out, "a layer"));
    if (!e) comm_share(c, mine, count, count + size, *out);
    if (!e) *n = unique(count[2 * size], same, *out);
    free(count);
    free(mine);
    return e;
}

/* Finds the layers in which all cells lie, by their floors. None if a cell is higher than its layer. */
static status find_layers(struct bed *b, double **bottom) {
    const double height = b->high[b->up] - b->low[b->up], same = 1e-9 * height;
    bool all = true;
    TRY(list_floors(b, same, &b->layers, bottom));
    for (int i = 0; i < b->n && all; i++) {
        b->layer[i] = nearest(b->layers, *bottom, b->reach[i][0]);
        const double top = b->layer[i] + 1 < b->layers ? (*bottom)[b->layer[i] + 1] : height;
        all = fabs(b->reach[i][1] - top) <= same;
    }
    if (least(b, all) == 0) b->layers = 0;
    return OK;
}

/* Finds T of each layer: that of its first cell. first: [layers] room */
static void find_temperatures(const struct bed *b, const double *T, double *first, double *of_layer) {
    const struct comm *c = b->place->share ? b->place->share->comm : NULL;
    for (int j = 0; j < b->layers; j++) first[j] = of_layer[j] = HUGE_VAL;
    for (int i = b->n - 1; i >= 0; i--) {
        first[b->layer[i]] = (double)(b->first + i);
        of_layer[b->layer[i]] = T[i];
    }
    if (!c) return;
    comm_min(c, first, b->layers);
    for (int i = 0; i < b->n; i++) /* another rank has the first cell of the layer */
        if (first[b->layer[i]] < (double)b->first) of_layer[b->layer[i]] = HUGE_VAL;
    comm_min(c, of_layer, b->layers);
}

static status check_temperatures(const struct bed *b, const struct field *T, const double *of_layer) {
    for (int i = 0; i < b->n; i++) {
        const double here = of_layer[b->layer[i]];
        if (!(T->values[i] > 0)) return field_fail(T, b->place, i, "it must be greater than 0");
        if (T->values[i] != here)
            return field_fail(T, b->place, i,
                              "a hydrostatic settledLayer needs one T at each height, and another cell of this height "
                              "has %g; or say in it  hydrostatic no;",
                              here);
    }
    return OK;
}

/* Sorts the cells by the columns that their factors make. */
static status find_columns(struct bed *b) {
    TRY(allocate(&b->factors, b->n, sizeof(double), "a layer"));
    TRY(allocate(&b->by_column, b->n, sizeof *b->by_column, "a layer"));
    TRY(allocate(&b->rest, b->n, sizeof(double), "a layer"));
    for (int i = 0; i < b->n; i++) b->factors[i] = b->l->of_depth ? b->factor[i] : 1;
    b->columns = unique(b->n, 0, b->factors);
    TRY(allocate(&b->column_start, b->columns + 2L, sizeof *b->column_start, "a layer"));
    int *next = b->column_start + 1; /* counted one entry late: filling moves every entry to its column's start */
    for (int fill = 0; fill < 2; fill++) {
        for (int i = 0; i < b->n; i++) {
            const int c = nearest(b->columns, b->factors, b->l->of_depth ? b->factor[i] : 1);
            if (fill)
                b->by_column[next[c]++] = i;
            else
                next[c + 1]++;
        }
        for (int c = 0; c < b->columns && !fill; c++) next[c + 1] += next[c];
    }
    return OK;
}

/* Makes the column at rest if all cells lie in layers, each of one T. */
static status make_resting(struct bed *b, const struct field *T) {
    double *bottom = NULL, *thick = NULL;
    TRY(agree(b, allocate(&b->layer, b->n, sizeof(int), "a layer")));
    status s = find_layers(b, &bottom);
    if (!s && b->layers) s = agree(b, allocate(&thick, 3L * b->layers, sizeof(double), "a layer"));
    if (s || !b->layers) {
        free(bottom);
        return s;
    }
    double *of_layer = thick + b->layers;
    for (int j = 0; j < b->layers; j++)
        thick[j] = (j + 1 < b->layers ? bottom[j + 1] : b->high[b->up] - b->low[b->up]) - bottom[j];
    find_temperatures(b, T->values, of_layer + b->layers, of_layer);
    s = agree(b, check_temperatures(b, T, of_layer));
    if (!s) s = resting_make(b->models, b->g, b->layers, thick, of_layer, &b->resting);
    free(bottom);
    free(thick);
    return s ? s : agree(b, find_columns(b));
}

/* Computes the columns at rest of the mass per area `mass`, times the waves' factors, a batch of them at a time. */
static status rest_columns(const struct bed *b, double mass) {
    double *rho, masses[BATCH];
    TRY(agree(b, allocate(&rho, (long)BATCH * b->layers, sizeof(double), "a layer")));
    for (int from = 0; from < b->columns; from += BATCH) {
        const int n = b->columns - from < BATCH ? b->columns - from : BATCH;
        for (int c = 0; c < n; c++) masses[c] = mass * b->factors[from + c];
        resting_columns(b->resting, n, masses, rho);
        for (int c = 0; c < n; c++)
            for (int k = b->column_start[from + c]; k < b->column_start[from + c + 1]; k++)
                b->rest[b->by_column[k]] = rho[(long)c * b->layers + b->layer[b->by_column[k]]];
    }
    free(rho);
    return OK;
}

/* Returns alpha of a cell, without background, in a column of `mass` per area (kg/m^2). */
static double packing_of(const struct bed *b, int i, double mass) {
    const double low = b->reach[i][0], high = b->reach[i][1];
    if (b->resting) return b->per * b->rest[i];
    if (!b->column) return b->laid * fmin(fmax(mass * b->per / b->laid - low, 0) / (high - low), 1);
    const double bottom = column_bottom(b->column, mass);
    return b->per * (column_above(b->column, bottom, low) - column_above(b->column, bottom, high)) / (high - low);
}

static double packing_with_waves(const struct bed *b, int i, double mass) {
    const double flat = b->l->of_depth ? 1 : b->factor[i], column = b->l->of_depth ? mass * b->factor[i] : mass;
    return flat * packing_of(b, i, column);
}

/* Sets alpha of a layer of the nominal `mass` per area; *held is the mass that the box then holds per area of its
 * floor. */
static status fill(const struct bed *b, double mass, double *alpha, double *held) {
    if (b->resting) TRY(rest_columns(b, mass));
    for (int i = 0; i < b->n; i++) {
        alpha[i] = fmax(packing_with_waves(b, i, mass), b->l->background);
        b->term[i] = alpha[i] * b->volume[i];
    }
    *held = sum_terms(b) / b->area / b->per;
    return OK;
}

/* Fails if the background adds more than 1 % to a layer that fill has laid: it does not rest, and its fall would set
 * the layer in motion. mass: what was asked for per area; nominal: of the layer without background. */
static status check_background(const struct bed *b, double mass, double nominal, const double *alpha) {
    const double most = 0.01 * mass;
    for (int i = 0; i < b->n; i++) {
        const double own = nominal > 0 ? packing_with_waves(b, i, nominal) : 0;
        b->term[i] = fmax(alpha[i] - own, 0) * b->volume[i];
    }
    const double added = sum_terms(b) / b->area / b->per;
    if (added <= most) return OK;
    return cannot(b->l, "settledLayer",
                  "its background of alpha %g is %g of the %g kg/m^2 that the box is to hold, and would fall on the "
                  "layer; say  background %g;",
                  b->l->background, added, mass, pow(10, floor(log10(b->l->background * most / added))));
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
    TRY(check_background(b, mass, nominal, alpha));
    if (fabs(missing) < 1e-12 * mass) return OK;
    return cannot(b->l, "settledLayer",
                  "the box cannot hold it: of %g kg/m^2 %g are missing; lower depth, or raise the lid", mass, missing);
}

static status make_column(struct bed *b, double mass, const struct field *T) {
    if (!T) return cannot(b->l, "settledLayer", "a hydrostatic layer needs T, not p; or say  hydrostatic no;");
    TRY(make_resting(b, T));
    if (b->resting) return OK;
    double most = -1, of_first = b->n ? T->values[0] : 0; /* that of the root counts */
    if (b->place->share) comm_broadcast(b->place->share->comm, &of_first, sizeof of_first);
    status e = OK;
    for (int i = 0; i < b->n && !e; i++)
        if (T->values[i] != of_first)
            e = field_fail(T, b->place, i,
                           "a hydrostatic settledLayer needs one T everywhere where cells do not lie in layers, and "
                           "cell 0 has %g; or say in it  hydrostatic no;",
                           of_first);
    if (!e && !(of_first > 0)) e = field_fail(T, b->place, 0, "it must be greater than 0");
    TRY(agree(b, e));
    for (int i = 0; i < b->n; i++) most = fmin(most, -b->factor[i]);
    most = -least(b, most);
    return column_make(b->models, b->g, of_first, 1.5 * most * mass, b->high[b->up] - b->low[b->up], &b->column);
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
                    .first = field_first(place),
                    .n = (int)field_ncells(place),
                    .per = packing_per_density(&models->material)};
    if (!l) return OK;
    TRY(find_gravity(&b, dim, axis));
    status e = apply(&b, T, f->kind == &field_kinds[FIELD_ALPHA], f->values);
    free(b.volume);
    free(b.reach);
    free(b.factor);
    free(b.term);
    free(b.layer);
    free(b.factors);
    free(b.column_start);
    free(b.by_column);
    free(b.rest);
    column_free(b.column);
    resting_free(b.resting);
    return e;
}
