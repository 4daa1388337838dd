/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, checks and prints the choices for a run of grains from its dictionaries (grains_models.h). */
#include "solvers/grains/grains_models.h"

#include "libcore/models/boundary.h"
#include "solvers/case/fields.h"
#include "solvers/dict/params.h"
#include "solvers/gas/layers.h"
#include "solvers/grains/grains_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PATH = 4096 };
#define COUNT(table) ((int)(sizeof table / sizeof *table))

#define PARAM_STRUCT struct grains_models
static const struct param grains_param[] = {
    WHOLE("N", number, 0, FROM_TO(0, 2e9),
          "grains; 0: as alpha (or rho) of the start says, which else only says where they are denser"),
    WHOLE("seed", seed, 1, FROM_TO(0, 2e9), "of the random places and velocities"),
    NUMBER("shearRate", shear, 0, ANY_NUMBER, UNIT(0, 0, -1),
           "of a box that is cyclic along all axes: the images above the second axis move along the first (Lees & "
           "Edwards)"),
    SWITCH("writeCloud", write_cloud, true, "lagrangian/grains in every written time; restarts do not need it"),
    NOTED("walls", "dictionary", "none", "a dictionary for each patch that is not elastic, by its name",
          "walls { floor { restitution 0.7; } }"),
    NOTED("coarseGraining", "dictionary", "none", "how fields come from grains",
          "coarseGraining { kernel Heaviside; width 2e-3; }"),
};
static const struct param hard_param[] = {
    IGNORED("contact", "for granularDEM: the forces of soft grains"),
    NOTED("species", "dictionary", "none", "the kinds of grains of a mixture, 8 at most, by names",
          "species { big { diameter 2e-3; } small { diameter 1e-3; fraction 4; } }"),
};
static const char *const kernel_names[] = {"cell", "Heaviside", "Gaussian", NULL};
static const struct param coarse_param[] = {
    CHOICE("kernel", kernel, 0, kernel_names, "what a mean is taken over"),
    NUMBER("width", width, 0, FROM_TO(0, HUGE_VAL), UNIT(0, 1, 0),
           "radius of Heaviside, standard deviation of Gaussian; 0: a grain diameter"),
    NUMBER("window", window, 0, FROM_TO(0, HUGE_VAL), UNIT(0, 0, 1),
           "fields are means over windows of this length from t = 0; 0: the write interval"),
    WHOLE("samples", samples, 10, FROM_TO(1, 1e9), "moments of a window, evenly spread"),
};
#undef PARAM_STRUCT
struct wall {
    double restitution, friction;
};
struct kind {
    const char *name;
    double diameter, mass, number, restitution;
};
#define PARAM_STRUCT struct kind
#define SIZE         FROM_TO(0, HUGE_VAL), .example = "diameter 1e-3;"
static const struct param kind_param[] = {
    NUMBER("diameter", diameter, USUALLY(0, "that of grain"), SIZE, UNIT(0, 1, 0), "of these grains"),
    NUMBER("mass", mass, USUALLY(0, "that of grain, as diameter^dim"), FROM_TO(0, HUGE_VAL), UNIT(1, 0, 0), "of one"),
    NUMBER("fraction", number, 1, BETWEEN(0, HUGE_VAL), NO_UNIT,
           "of the number of grains; over the sum of all fractions"),
    NUMBER("restitution", restitution, USUALLY(-1, "that of grain"), FROM_TO(0, 1), NO_UNIT, "of two of this kind"),
    NOTED("with", "dictionary", "the mean of both restitutions", "restitution of this kind and others, by their names",
          "with { added 0.8; }"),
    NOTED("inlets", "dictionary", "fraction", "what counts as fraction at a patch where grains come in, by its name",
          "inlets { lid 2; }"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct wall
static const struct param granular_param[] = {
    NOTED("grain", "dictionary", NULL, "the grains", "grain { diameter 1e-3; restitution 0.9; }"),
    NOTED("sources", "list: ()", "()", "sources of the gas; grains have none", "sources ();"),
};
static const struct param wall_param[] = {
    NUMBER("restitution", restitution, 1, FROM_TO(0, 1), NO_UNIT, "of impacts on that patch"),
    IGNORED("friction", "for granularDEM: hard grains are smooth"),
};
static const struct param soft_wall_param[] = {
    NUMBER("restitution", restitution, USUALLY(-1, "that of two grains"), FROM_TO(0, 1), NO_UNIT,
           "of impacts on that patch"),
    NUMBER("friction", friction, USUALLY(-1, "that of two grains; 0 where U slips"), FROM_TO(0, 1e3), NO_UNIT,
           "Coulomb's coefficient on that patch"),
};
static const char *const kernel_about[] = {"means over the cells of the mesh (default)", "over a ball around a centre",
                                           "over a normal distribution around a centre, cut at 3 width"};

/* The sources of the gas would act on the grains, too, if they were known here. */
static status refuse_sources(struct dict *d) {
    const char *const *names;
    int n = 0;
    if (dict_has(d, "sources")) TRY(dict_words(d, "sources", &n, &names));
    if (n == 0) return OK;
    return dict_fail(d, "sources",
                     "grains know constant/g and constant/shaking alone; say  sources ();  for a run without %s",
                     names[0]);
}

static status read_granular(struct dict *d, struct grains_models *m) {
    struct dict *sub;
    TRY(dict_sub(d, "grain", &sub));
    TRY(params_read(sub, grain_param, grain_nparam, &m->grain));
    if (!(m->grain.diameter > 0)) return dict_fail(sub, "diameter", "hard grains need one greater than 0");
    if (m->grain.friction > 0) return dict_fail(sub, "friction", "hard grains do not rub: say  friction 0;");
    TRY(refuse_sources(d));
    TRY(models_leave(d));
    return dict_check_used(d);
}

static status read_walls(struct dict *d, const struct polymesh *mesh, struct grains_models *m) {
    struct dict *walls, *one;
    struct wall wall = {.friction = 0};
    const struct param *table = m->soft ? soft_wall_param : wall_param;
    TRY(dict_sub_optional(d, "walls", &walls));
    for (int p = 0; p < mesh->npatches; p++) {
        const struct patch *patch = &mesh->patch[p];
        m->restitution[p] = m->soft ? -1 : 1;
        m->friction[p] = -1;
        one = NULL;
        if (walls) TRY(dict_sub_optional(walls, patch->name, &one));
        if (!one) continue;
        m->restitution_line[p] = dict_line(walls, patch->name);
        if (!strcmp(patch->type, "cyclic") || !strcmp(patch->type, "empty"))
            return fail(ERR_INPUT, "%s:%d: walls: patch %s is of type %s in %s: it is no wall", dict_path(d),
                        m->restitution_line[p], patch->name, patch->type, polymesh_boundary_file(mesh));
        TRY(params_read(one, table, COUNT(wall_param), &wall));
        m->restitution[p] = wall.restitution;
        m->friction[p] = wall.friction;
    }
    return OK;
}

static int larger_first(const void *a, const void *b) {
    const struct kind *x = a, *y = b;
    return x->diameter != y->diameter ? (x->diameter > y->diameter ? -1 : 1) : strcmp(x->name, y->name);
}

/* Names of kinds are parts of names of fields and files. */
static status check_kind_name(const struct dict *all, const char *name) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    if (strspn(name, letters) == strlen(name) && strlen(name) <= KIND_NAME) return OK;
    return dict_fail(all, name, "a kind of grains has a name of letters, digits and _, %d at most", KIND_NAME);
}

static status read_kind(struct dict *all, const char *name, const struct material *grain, int dim, struct kind *out) {
    struct dict *d;
    TRY(check_kind_name(all, name));
    TRY(dict_sub(all, name, &d));
    TRY(params_read(d, kind_param, COUNT(kind_param), out));
    (void)dict_has(d, "with");
    (void)dict_has(d, "inlets");
    out->name = name;
    if (out->diameter == 0) out->diameter = grain->diameter;
    const double ratio = out->diameter / grain->diameter;
    if (out->mass == 0) out->mass = grain->mass * ratio * ratio * (dim == 2 ? 1 : ratio);
    if (out->restitution < 0) out->restitution = grain->restitution;
    return OK;
}

/* Reads the restitution of each pair, which either of the two kinds may give. */
static status read_pairs(struct dict *all, const struct kind *kind, struct grain_kinds *out) {
    static const signed char number[3] = {0, 0, 0};
    for (int a = 0; a < out->n; a++) {
        struct dict *d, *with;
        TRY(dict_sub(all, kind[a].name, &d));
        TRY(dict_sub_optional(d, "with", &with));
        for (int b = 0; b < out->n; b++) {
            double *e = &out->restitution[a][b], given;
            if (!with || !dict_has(with, kind[b].name)) continue;
            TRY(dict_number(with, kind[b].name, number, &given));
            if (!(given >= 0 && given <= 1)) return dict_fail(with, kind[b].name, "a restitution lies in 0 to 1");
            *e = out->restitution[b][a] = given;
        }
    }
    return OK;
}

/* Reads the share of each kind in what comes in at each patch. */
static status read_inlets(struct dict *all, const struct kind *kind, const struct polymesh *mesh,
                          struct grains_models *m) {
    static const signed char number[3] = {0, 0, 0};
    for (int a = 0; a < m->kinds.n; a++) {
        struct dict *d, *inlets;
        TRY(dict_sub(all, kind[a].name, &d));
        TRY(dict_sub_optional(d, "inlets", &inlets));
        for (int p = 0; p < mesh->npatches; p++) {
            double *share = &m->inlet_share[p][a];
            *share = kind[a].number;
            if (!inlets || !dict_has(inlets, mesh->patch[p].name)) continue;
            TRY(dict_number(inlets, mesh->patch[p].name, number, share));
            if (!(*share >= 0 && *share < HUGE_VAL))
                return dict_fail(inlets, mesh->patch[p].name, "a fraction is not negative");
            m->inlet_line[p] = dict_line(inlets, mesh->patch[p].name);
        }
    }
    for (int p = 0; p < mesh->npatches; p++) {
        double sum = 0;
        for (int a = 0; a < m->kinds.n; a++) sum += m->inlet_share[p][a];
        if (!(sum > 0))
            return fail(ERR_INPUT, "%s:%d: species: no kind has a fraction above 0 at patch %s", dict_path(all),
                        m->inlet_line[p], mesh->patch[p].name);
        for (int a = 0; a < m->kinds.n; a++) m->inlet_share[p][a] /= sum;
    }
    return OK;
}

/* Reads the kinds of a mixture, the largest first, which stands for `grain` then. */
static status read_species(struct dict *d, int dim, const struct polymesh *mesh, struct grains_models *m) {
    struct kind kind[GRAIN_KINDS];
    struct dict *all = NULL;
    double sum = 0;
    TRY(dict_sub_optional(d, "species", &all));
    const int n = all ? dict_count(all) : 0;
    if (n > GRAIN_KINDS) return dict_fail(d, "species", "%d kinds at most", GRAIN_KINDS);
    for (int k = 0; k < n; k++) {
        TRY(read_kind(all, dict_key(all, k), &m->grain, dim, &kind[k]));
        sum += kind[k].number;
    }
    if (!n) return OK;
    qsort(kind, (size_t)n, sizeof *kind, larger_first);
    m->kinds.n = n;
    m->grain.diameter = kind[0].diameter;
    m->grain.mass = kind[0].mass;
    for (int a = 0; a < n; a++) {
        m->kind_name[a] = kind[a].name;
        m->share[a] = kind[a].number / sum;
        m->kinds.size[a] = kind[a].diameter / kind[0].diameter;
        m->kinds.mass[a] = kind[a].mass / kind[0].mass;
        for (int b = 0; b < n; b++) m->kinds.restitution[a][b] = 0.5 * (kind[a].restitution + kind[b].restitution);
    }
    grains_models_count(m, 1000000);
    TRY(read_pairs(all, kind, &m->kinds));
    return read_inlets(all, kind, mesh, m);
}

void grains_models_count(struct grains_models *m, int n) {
    double sum = 0;
    for (int k = 0; k < m->kinds.n; k++) {
        m->kinds.first[k] = (int)floor(sum * n + 0.5);
        sum += m->share[k];
    }
    m->kinds.first[m->kinds.n] = m->kinds.n ? n : 0;
}

static const double MOST_SAMPLES = 1e12;

static status read_properties(struct dict *d, int dim, const struct polymesh *mesh, const struct control *c,
                              struct grains_models *m) {
    struct dict *coarse = NULL, *none = NULL;
    TRY(params_read(d, grains_param, COUNT(grains_param), m));
    if (m->soft)
        TRY(grains_contact_read(d, m));
    else
        TRY(params_read(d, hard_param, COUNT(hard_param), m));
    if (!m->soft) TRY(read_species(d, dim, mesh, m));
    TRY(read_walls(d, mesh, m));
    TRY(dict_sub_optional(d, "coarseGraining", &coarse));
    if (!coarse) TRY(dict_from_text("coarseGraining", "", &none));
    status s = params_read(coarse ? coarse : none, coarse_param, COUNT(coarse_param), m);
    if (!s && m->window > 0 && isfinite(c->end_time) && fabs(c->end_time) / m->window * m->samples > MOST_SAMPLES)
        s = dict_fail(coarse, "window", "up to endTime it has more than %g samples: is its unit right?", MOST_SAMPLES);
    dict_free(none);
    TRY(s);
    if (m->width == 0) m->width = m->grain.diameter;
    if (m->window == 0 && (c->write.control == WRITE_ADJUSTABLE || c->write.control == WRITE_RUN_TIME))
        m->window = c->write.interval;
    return dict_check_used(d);
}

static status read_all(const char *dir, const struct polymesh *mesh, int dim, const int axis[3],
                       const struct control *c, struct grains_models *m) {
    char path[PATH];
    struct dict *none = NULL;
    TRY(allocate(&m->restitution, mesh->npatches, sizeof(double), "walls"));
    TRY(allocate(&m->open, mesh->npatches, sizeof *m->open, "walls"));
    TRY(allocate(&m->feeds, mesh->npatches, sizeof *m->feeds, "walls"));
    TRY(allocate(&m->restitution_line, mesh->npatches, sizeof(int), "walls"));
    TRY(allocate(&m->friction, mesh->npatches, sizeof(double), "walls"));
    TRY(allocate(&m->inlet_share, mesh->npatches, sizeof *m->inlet_share, "walls"));
    TRY(allocate(&m->rough, mesh->npatches, sizeof *m->rough, "walls"));
    TRY(allocate(&m->inlet_line, mesh->npatches, sizeof(int), "walls"));
    for (int p = 0; p < mesh->npatches; p++) m->inlet_share[p][0] = 1;
    snprintf(path, sizeof path, "%s/constant/granularProperties", dir);
    TRY(dict_read(path, &m->granular));
    TRY(read_granular(m->granular, m));
    TRY(forces_read(dir, dim, axis, &m->forces));
    snprintf(path, sizeof path, "%s/constant/particleProperties", dir);
    if (field_exists(path)) TRY(dict_read(path, &m->properties));
    if (!m->properties) TRY(dict_from_text(path, "", &none));
    status s = read_properties(m->properties ? m->properties : none, dim, mesh, c, m);
    dict_free(none);
    return s;
}

status grains_models_read(const char *case_dir, const struct polymesh *mesh, int dim, const int axis[3],
                          const struct control *control, bool soft, struct grains_models **out) {
    struct grains_models *m = NULL;
    *out = NULL;
    TRY(allocate(&m, 1, sizeof *m, "models"));
    m->soft = soft;
    status s = read_all(case_dir, mesh, dim, axis, control, m);
    if (s) {
        grains_models_free(m);
        return s;
    }
    *out = m;
    return OK;
}

void grains_models_free(struct grains_models *m) {
    if (!m) return;
    forces_free(&m->forces);
    dict_free(m->granular);
    dict_free(m->properties);
    free(m->restitution);
    free(m->open);
    free(m->feeds);
    free(m->restitution_line);
    free(m->friction);
    free(m->inlet_share);
    free(m->inlet_line);
    free(m->rough);
    free(m);
}

const char *grains_kernel_name(const struct grains_models *m) {
    return kernel_names[m->kernel];
}

static void list(FILE *f, bool soft) {
    fprintf(f, "constant/granularProperties (the rest of it is the gas's)\n\ngrain { }\n");
    params_print(f, grain_param, grain_nparam);
    forces_list(f);
    fprintf(f, "\nconstant/particleProperties (may be missing)\n");
    params_print(f, grains_param, COUNT(grains_param));
    if (soft) grains_contact_list(f);
    if (!soft) fprintf(f, "\nspecies { <name> { } }: a mixture\n");
    if (!soft) params_print(f, kind_param, COUNT(kind_param));
    fprintf(f, "\nwalls { <patch> { } }\n");
    params_print(f, soft ? soft_wall_param : wall_param, COUNT(wall_param));
    fprintf(f, "\ncoarseGraining { }: the fields of written times\n");
    params_print(f, coarse_param, COUNT(coarse_param));
    for (int i = 0; kernel_names[i]; i++) fprintf(f, "  kernel %-13s %s\n", kernel_names[i], kernel_about[i]);
}

void grains_models_list(FILE *f) {
    list(f, false);
}
void grains_models_list_soft(FILE *f) {
    list(f, true);
}

/* Is the boundary condition allowed for all grains: for U a smooth wall, for scalars one that such a wall has? */
static bool is_offered_all(const struct boundary_type *b) {
    return boundary_is_smooth(b) || !strcmp(b->model.name, "zeroGradient") || !strcmp(b->model.name, "granularWall");
}

/* Hard grains come in where values are given, and some walls are rough. */
static bool is_offered(const struct boundary_type *b) {
    return is_offered_all(b) || b == boundary_find("JohnsonJacksonSlip") ||
           (!boundary_is_wall(b) && b->giving != BY_RATE && boundary_value(b, 1));
}

/* Walls of soft grains may be rough, but do not rotate. */
static bool is_offered_soft(const struct boundary_type *b) {
    return (boundary_is_wall(b) && b->giving != BY_ROTATION) || is_offered_all(b);
}

static void keywords(struct keywords *k, bool soft) {
    static const char properties[] = "constant/particleProperties";
    keywords_at(k, "constant/granularProperties", "", NULL);
    keywords_params(k, granular_param, COUNT(granular_param));
    models_leave_keywords(k);
    grain_keywords(k);
    forces_keywords(k);
    keywords_at(k, properties, "", NULL);
    keywords_params(k, grains_param, COUNT(grains_param));
    if (soft)
        grains_contact_keywords(k, properties);
    else
        keywords_params(k, hard_param, COUNT(hard_param));
    if (!soft) keywords_at(k, properties, "species/NAME", NULL);
    if (!soft) keywords_params(k, kind_param, COUNT(kind_param));
    keywords_at(k, properties, "walls/PATCH", NULL);
    keywords_params(k, soft ? soft_wall_param : wall_param, COUNT(wall_param));
    keywords_at(k, properties, "coarseGraining", NULL);
    keywords_params(k, coarse_param, 1);
    keywords_words(k, "kernel", kernel_names, kernel_about);
    keywords_params(k, coarse_param + 1, COUNT(coarse_param) - 1);
    fields_keywords(k, FIELD_FILES, soft ? is_offered_soft : is_offered);
    layers_keywords(k);
}

void grains_models_keywords(struct keywords *k) {
    keywords(k, false);
}
void grains_models_keywords_soft(struct keywords *k) {
    keywords(k, true);
}

void grains_boundaries_list(FILE *f) {
    for (int i = 0; i < boundary_count; i++)
        if (boundary_is_smooth(&boundary_table[i]))
            fprintf(f, "  %-14s %-16s smooth wall\n", boundary_table[i].model.name, "U");
    fprintf(f, "  %-14s %-16s %s\n", "zeroGradient", "scalars", "on walls");
    fprintf(f, "  %-14s %-16s %s\n", "zeroGradient", "U", "grains whose centres come there leave");
    fprintf(f, "  %-14s %-16s %s\n", "fixedValue ..", "U, alpha, T",
            "grains of that state come in; also exprFixedValue, uniformFixedValue, inletOutlet");
    fprintf(f, "  %-14s %-16s %s\n", "granularWall", "T",
            "restitution e; of impacts on that wall, as in the gas (or walls of constant/particleProperties; else 1)");
    fprintf(f, "  %-14s %-16s %s\n", "JohnsonJacksonSlip", "U",
            "rough wall: the part specularityCoefficient of the impacts is diffuse; value: its velocity; T alike");
    fprintf(f, "  %-14s %-16s %s\n", "cyclic", "scalars, U", "periodic; on patches of type cyclic");
    fprintf(f, "  %-14s %-16s %s\n", "empty", "scalars, U", "the axis is not solved; on patches of type empty");
}

void grains_models_print(FILE *f, const struct grains_models *m) {
    fprintf(f, "Models\n    %-22s %.10g m, %.10g kg\n    %-22s %.10g\n    %-22s %.10g m/s\n", "grain",
            m->grain.diameter, m->grain.mass, "restitution", m->grain.restitution, "thresholdSpeed",
            m->grain.threshold);
    for (int a = 0; a < m->kinds.n; a++) {
        fprintf(f, "    %-22s %.10g m, %.10g kg, %.4g %% of the grains, restitution", m->kind_name[a],
                m->kinds.size[a] * m->grain.diameter, m->kinds.mass[a] * m->grain.mass, 100 * m->share[a]);
        for (int b = 0; b < m->kinds.n; b++) fprintf(f, " %.6g with %s", m->kinds.restitution[a][b], m->kind_name[b]);
        fprintf(f, "\n");
    }
    forces_print(f, &m->forces);
    if (m->shear != 0) fprintf(f, "    %-22s %.10g 1/s\n", "shearRate", m->shear);
    fprintf(f, "    %-22s %s", "coarse graining", kernel_names[m->kernel]);
    if (m->kernel != COARSE_CELL) fprintf(f, ", width %g m", m->width);
    if (m->window > 0)
        fprintf(f, ", means of %d moments in windows of %g s\n", m->samples, m->window);
    else
        fprintf(f, ", of the moment of writing, without collisional pressure\n");
}
