#include "solvers/gas/models.h"

#include "solvers/case/fields.h"
#include "solvers/dict/params.h"
#include "solvers/gas/layers.h"
#include "solvers/gas/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PATH = 4096, NAMES = 32 };

static const struct param shaking_param[] = {
    {"amplitude",
     PARAM_NUMBER,
     offsetof(struct sources, amplitude),
     NAN,
     -HUGE_VAL,
     HUGE_VAL,
     true,
     {0, 0, 0},
     "of g(t) = g (1 + amplitude cos(2 pi frequency t + phase)); or  table ((t a) (t a) ..);"},
    {"frequency", PARAM_NUMBER, offsetof(struct sources, frequency), NAN, 0, HUGE_VAL, true, {0, 0, -1}, "Hz"},
    {"phase", PARAM_NUMBER, offsetof(struct sources, phase), 0, -HUGE_VAL, HUGE_VAL, true, {0, 0, 0}, "rad"},
};
static const struct param limits_param[] = {
    {"minDeltaTFraction",
     PARAM_NUMBER,
     offsetof(struct case_models, min_fraction),
     1e-3,
     0,
     1,
     true,
     {0, 0, 0},
     "the run has collapsed when dt falls below this part of what calm cells allow"},
    {"alphaFloor", /* the last: not printed where it is off */
     PARAM_NUMBER,
     offsetof(struct case_models, gas.alpha_floor),
     0,
     0,
     1,
     false,
     {0, 0, 0},
     "alpha stays above it: mass is added, and counted, where the fluxes cannot help; 0: off"},
};
static const struct param solution_param[] = {
    {"skipUniform",
     PARAM_SWITCH,
     offsetof(struct case_models, gas.skip_uniform),
     1,
     0,
     1,
     false,
     {0, 0, 0},
     "leave out cells whose surroundings are uniform to the bit; the result has the same bits"},
};
static const char *const cooling_names[] = {"none", "Haff"};
static const char *const bulk_names[] = {"corrected", "paper"};
static const char *const engine_names[] = {"lattice", "polyhedral"};
static const char *const shaking_names[] = {"none", "sinusoidal"};

/* Of fvSchemes, where it is silent: least time to a given error among those that also hold at shocks, walls and near
 * vacuum, by postprocessing/reports/workPrecision.md. */
static const char flux_standard[] = "common", reconstruct_standard[] = "WPENO5", stepper_standard[] = "SSPRK43",
                  polynomial_standard[] = "CWENO3";

#define COUNT(table) ((int)(sizeof table / sizeof *table))

/* The row of a model table that `key` names; index 0 of the names where the key is missing, unless it must be there. */
#define TABLE_CHOICE(d, key, table, count, standard, out)                                                              \
    do {                                                                                                               \
        const char *names_[NAMES];                                                                                     \
        for (int i_ = 0; i_ < count && i_ < NAMES; i_++) names_[i_] = table[i_].name;                                  \
        TRY(choice_or(d, key, names_, count, standard, out));                                                          \
    } while (0)

static status choice_or(struct dict *d, const char *key, const char *const *names, int count, const char *standard,
                        int *out) {
    if (standard && !dict_has(d, key)) {
        for (*out = 0; *out < count - 1 && strcmp(names[*out], standard);) ++*out;
        return OK;
    }
    return dict_choice(d, key, names, count, out);
}

static status read_grains(struct dict *d, struct gas_models *m) {
    struct dict *sub;
    char coeffs[128];
    int i;
    TRY(dict_sub(d, "grain", &sub));
    TRY(params_read(sub, grain_param, grain_nparam, &m->material));
    TABLE_CHOICE(d, "equationOfState", eos_table, eos_count, NULL, &i);
    m->eos = &eos_table[i];
    m->material.disks = m->eos->disks;
    for (i = 0; i < eos_count; i++) { /* coefficients of the models not chosen may stay in the file */
        snprintf(coeffs, sizeof coeffs, "%sCoeffs", eos_table[i].name);
        TRY(dict_sub_optional(d, coeffs, &sub));
        if (sub && &eos_table[i] != m->eos) dict_mark_used(sub);
    }
    snprintf(coeffs, sizeof coeffs, "%sCoeffs", m->eos->name);
    TRY(dict_sub_optional(d, coeffs, &sub));
    struct dict *none = NULL;
    if (!sub) TRY(dict_from_text(coeffs, "", &none));
    status s = params_read(sub ? sub : none, m->eos->param, m->eos->nparam, &m->material);
    dict_free(none);
    TRY(s);
    const char *objection = eos_objection(m->eos, &m->material);
    return objection ? dict_fail(d, "equationOfState", "%s", objection) : OK;
}

/* coefficients: its "JenkinsRichmanCoeffs", or an empty one */
static status read_numbers(struct dict *coefficients, struct gas_models *m) {
    int i;
    TRY(params_read(coefficients, m->transport->param, m->transport->nparam, &m->numbers));
    TRY(choice_or(coefficients, "bulk", bulk_names, COUNT(bulk_names), bulk_names[0], &i));
    m->numbers.bulk_factor = 1 + i;
    return OK;
}

static status read_transport(struct dict *d, struct gas_models *m) {
    const char *names[NAMES] = {"none"};
    struct dict *sub, *none = NULL;
    char coeffs[128];
    int chosen;
    for (int i = 0; i < transport_count && i + 1 < NAMES; i++) names[i + 1] = transport_table[i].name;
    TRY(choice_or(d, "transport", names, 1 + transport_count, "none", &chosen));
    for (int i = 0; i < transport_count; i++) {
        snprintf(coeffs, sizeof coeffs, "%sCoeffs", transport_table[i].name);
        TRY(dict_sub_optional(d, coeffs, &sub));
        if (sub && i + 1 != chosen) dict_mark_used(sub);
        if (i + 1 != chosen) continue;
        m->transport = &transport_table[i];
        if (m->transport->disks != m->material.disks)
            return dict_fail(d, "transport", "%s is for %s, equationOfState %s for %s", m->transport->name,
                             m->transport->disks ? "disks" : "spheres", m->eos->name,
                             m->material.disks ? "disks" : "spheres");
        if (m->material.diameter == 0)
            return dict_fail(d, "transport", "grains without a diameter do not collide: say  transport none;");
        if (!sub) TRY(dict_from_text(coeffs, "", &none));
        status s = read_numbers(sub ? sub : none, m);
        dict_free(none);
        TRY(s);
    }
    return OK;
}

static status read_properties(struct dict *d, struct gas_models *m) {
    int i;
    TRY(read_grains(d, m));
    if (!dict_has(d, "cooling") && m->material.restitution < 1)
        return fail(ERR_INPUT,
                    "%s: keyword 'cooling' is missing; with restitution %g say  cooling Haff;  or  cooling none;",
                    dict_path(d), m->material.restitution);
    TRY(choice_or(d, "cooling", cooling_names, COUNT(cooling_names), "none", &i));
    m->source.cooling = i == 1;
    TRY(read_transport(d, m));
    return dict_check_used(d);
}

static void mark_subs(struct dict *d, const char *const *names, int n) {
    for (int i = 0; i < n; i++) {
        struct dict *sub = NULL;
        if (!dict_has(d, names[i])) continue;
        status s = dict_sub_optional(d, names[i], &sub);
        if (!s && sub) dict_mark_used(sub);
        status_free(s);
    }
}

static status read_schemes(struct dict *d, struct case_models *all) {
    static const char *const others[] = {"ddtSchemes",           "gradSchemes",   "divSchemes",  "laplacianSchemes",
                                         "interpolationSchemes", "snGradSchemes", "fluxRequired"};
    struct gas_models *m = &all->gas;
    int i;
    if (dict_has(d, "meshEngine")) {
        TRY(dict_choice(d, "meshEngine", engine_names, COUNT(engine_names), &i));
        all->engine = i ? ENGINE_POLYHEDRAL : ENGINE_LATTICE;
    }
    TABLE_CHOICE(d, "fluxScheme", flux_table, flux_count, flux_standard, &i);
    m->flux = &flux_table[i];
    TABLE_CHOICE(d, "reconstruct", reconstruct_table, reconstruct_count, reconstruct_standard, &i);
    m->reconstruct = &reconstruct_table[i];
    TABLE_CHOICE(d, "timeScheme", stepper_table, stepper_count, stepper_standard, &i);
    m->stepper = &stepper_table[i];
    TABLE_CHOICE(d, "polyReconstruct", polynomial_table, polynomial_count, polynomial_standard, &i);
    m->polynomial = &polynomial_table[i];
    mark_subs(d, others, COUNT(others));
    return dict_check_used(d);
}

static status load_module(const struct dict *diffusion, const struct linear_module **out) {
    status missing = linear_load(out), s = OK;
    if (missing) s = dict_fail(diffusion, "type", "%s", status_text(missing));
    status_free(missing);
    return s;
}

static status read_solution(struct dict *d, struct case_models *m) {
    static const char *const others[] = {"solvers", "SIMPLE", "PIMPLE", "PISO", "relaxationFactors"};
    struct dict *limits, *diffusion, *none = NULL;
    int i = 0;
    TRY(params_read(d, solution_param, COUNT(solution_param), m));
    TRY(dict_sub_optional(d, "diffusion", &diffusion));
    if (diffusion) TABLE_CHOICE(diffusion, "type", diffusion_table, diffusion_count, NULL, &i);
    m->gas.diffusion = &diffusion_table[i];
    if (m->gas.transport && !m->gas.diffusion->plan) TRY(load_module(diffusion, &m->gas.linear));
    TRY(dict_sub_optional(d, "limits", &limits));
    if (!limits) TRY(dict_from_text("limits", "", &none));
    status s = params_read(limits ? limits : none, limits_param, COUNT(limits_param), m);
    dict_free(none);
    TRY(s);
    mark_subs(d, others, COUNT(others));
    return dict_check_used(d);
}

static status read_gravity(struct dict *d, int dim, const int axis[3], struct forces *m) {
    static const signed char unit[3] = {0, 1, -2}, expected[7] = {0, 1, -2, 0, 0, 0, 0};
    signed char dimensions[7];
    if (dict_has(d, "dimensions")) {
        TRY(dict_dimensions(d, "dimensions", dimensions));
        if (memcmp(dimensions, expected, 7)) return dict_fail(d, "dimensions", "gravity needs [0 1 -2 0 0 0 0]");
    }
    TRY(dict_vector(d, "value", unit, m->gravity));
    for (int x = 0; x < 3; x++) {
        bool solved = false;
        for (int k = 0; k < dim; k++)
            if (axis[k] == x) {
                m->source.gravity[k] = m->gravity[x];
                solved = true;
            }
        if (!solved && m->gravity[x] != 0)
            return dict_fail(d, "value", "its %c component must be 0: 'empty' patches take that axis away", "xyz"[x]);
    }
    return dict_check_used(d);
}

static status read_shaking(struct dict *d, struct forces *m) {
    int type;
    TRY(dict_choice(d, "type", shaking_names, COUNT(shaking_names), &type));
    if (type == 1) {
        if (!m->g) return dict_fail(d, "type", "shaking modulates gravity; constant/g is missing");
        if (dict_has(d, "amplitude")) TRY(dict_table(d, "amplitude", &m->source.knots, &m->source.ramp));
        const int ramped = m->source.knots > 0; /* then the row of the amplitude is left out */
        TRY(params_read(d, shaking_param + ramped, COUNT(shaking_param) - ramped, &m->source));
    } else {
        dict_mark_used(d);
    }
    return dict_check_used(d);
}

static status open_in(const char *case_dir, const char *name, bool optional, struct dict **out) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", case_dir, name);
    if (optional && !field_exists(path)) return OK;
    return dict_read(path, out);
}

status forces_read(const char *dir, int dim, const int axis[3], struct forces *m) {
    TRY(open_in(dir, "constant/g", true, &m->g));
    if (m->g) TRY(read_gravity(m->g, dim, axis, m));
    TRY(open_in(dir, "constant/shaking", true, &m->shaking));
    return m->shaking ? read_shaking(m->shaking, m) : OK;
}

void forces_free(struct forces *f) {
    dict_free(f->g);
    dict_free(f->shaking);
}

static status read_all(const char *dir, int dim, const int axis[3], struct case_models *m) {
    TRY(open_in(dir, "constant/granularProperties", false, &m->properties));
    TRY(read_properties(m->properties, &m->gas));
    if (m->gas.material.disks && dim == 3)
        return dict_fail(m->properties, "equationOfState",
                         "%s is for disks, which move in one or two dimensions; an 'empty' patch takes an axis away",
                         m->gas.eos->name);
    TRY(open_in(dir, "system/fvSchemes", false, &m->schemes));
    TRY(read_schemes(m->schemes, m));
    TRY(open_in(dir, "system/fvSolution", false, &m->solution));
    TRY(read_solution(m->solution, m));
    TRY(forces_read(dir, dim, axis, &m->forces));
    const bool cooling = m->gas.source.cooling;
    m->gas.source = m->forces.source;
    m->gas.source.cooling = cooling;
    return OK;
}

status models_read(const char *case_dir, int dim, const int axis[3], struct case_models **out) {
    struct case_models *m = NULL;
    *out = NULL;
    TRY(allocate(&m, 1, sizeof *m, "models"));
    status s = read_all(case_dir, dim, axis, m);
    if (s) {
        models_free(m);
        return s;
    }
    *out = m;
    return OK;
}

void models_free(struct case_models *m) {
    if (!m) return;
    dict_free(m->properties);
    dict_free(m->schemes);
    dict_free(m->solution);
    forces_free(&m->forces);
    free(m);
}

#define LIST_TABLE(f, title, table, count, standard)                                                                   \
    do {                                                                                                               \
        fprintf(f, "\n%s\n", title);                                                                                   \
        for (int i_ = 0; i_ < count; i_++)                                                                             \
            fprintf(f, "  %-20s %s%s\n", table[i_].name, table[i_].about,                                              \
                    strcmp(table[i_].name, standard) ? "" : " (default)");                                             \
    } while (0)

void forces_list(FILE *f) {
    fprintf(f, "\nconstant/shaking, type sinusoidal\n");
    params_print(f, shaking_param, COUNT(shaking_param));
}

void models_list(FILE *f) {
    fprintf(f, "constant/granularProperties\n\ngrain { }\n");
    params_print(f, grain_param, grain_nparam);
    fprintf(f, "\nequationOfState\n");
    for (int i = 0; i < eos_count; i++) {
        fprintf(f, "  %-20s %s; %sCoeffs { }\n", eos_table[i].name, eos_table[i].about, eos_table[i].name);
        params_print(f, eos_table[i].param, eos_table[i].nparam);
    }
    fprintf(f, "\ncooling\n  %-20s %s\n  %-20s %s\n", "none", "no energy sink", "Haff",
            "inelastic collisions, integrated exactly; grain.thresholdSpeed spares the slow ones");
    fprintf(f, "\ntransport\n  %-20s %s\n", "none", "inviscid");
    for (int i = 0; i < transport_count; i++) {
        const struct transport *t = &transport_table[i];
        fprintf(f, "  %-20s %s; %sCoeffs { }\n", t->name, t->about, t->name);
        params_print(f, t->param, t->nparam);
        fprintf(f, "    %-20s %-10s %-16s %-10s %s\n", "bulk", bulk_names[0], "or paper", "-",
                "viscosity by the contact integral, or twice that, as printed");
    }
    forces_list(f);
    fprintf(f, "\nsystem/fvSchemes: defaults by measurement, postprocessing/reports/workPrecision.md\n");
    LIST_TABLE(f, "system/fvSchemes: fluxScheme", flux_table, flux_count, flux_standard);
    LIST_TABLE(f, "system/fvSchemes: reconstruct", reconstruct_table, reconstruct_count, reconstruct_standard);
    LIST_TABLE(f, "system/fvSchemes: timeScheme", stepper_table, stepper_count, stepper_standard);
    fprintf(f, "\nsystem/fvSchemes: meshEngine\n  %-20s %s\n  %-20s %s\n", engine_names[0],
            "tiles of equal boxes, with `reconstruct` (default where the mesh is one)", engine_names[1],
            "any cells, with `polyReconstruct` (default where the mesh is no lattice)");
    LIST_TABLE(f, "system/fvSchemes: polyReconstruct", polynomial_table, polynomial_count, polynomial_standard);
    fprintf(f, "\nsystem/fvSolution\n");
    params_print(f, solution_param, COUNT(solution_param));
    fprintf(f, "\nsystem/fvSolution: diffusion { type .. }; %s if it is not given\n", diffusion_table[0].name);
    for (int i = 0; i < diffusion_count; i++)
        fprintf(f, "  %-20s %s\n", diffusion_table[i].name, diffusion_table[i].about);
    fprintf(f, "\nsystem/fvSolution: limits { }\n");
    params_print(f, limits_param, COUNT(limits_param));
    layers_list(f);
}

void boundaries_list(FILE *f) {
    for (int i = 0; i < boundary_count; i++) {
        const struct boundary_type *b = &boundary_table[i];
        fprintf(f, "  %-24s %-11s %s%s%s\n", b->name,
                b->scalar && b->vector ? "scalars, U"
                : b->vector            ? "U"
                                       : "scalars",
                b->about, b->value && !b->plain ? "; needs " : "", b->value && !b->plain ? b->value : "");
    }
    fprintf(f, "  %-24s %-11s %s\n", "cyclic", "scalars, U", "periodic; on patches of type cyclic");
    fprintf(f, "  %-24s %-11s %s\n", "empty", "scalars, U", "the axis is not solved; on patches of type empty");
    fprintf(f, "  %-24s %-11s %s\n", "calculated", "scalars", "in a written field that is not read again");
}

static void print_values(FILE *f, const struct param *table, int n, const void *base) {
    for (int i = 0; i < n; i++) {
        const char *p = (const char *)base + table[i].offset;
        fprintf(f, "    %-22s ", table[i].name);
        if (table[i].kind == PARAM_NUMBER)
            fprintf(f, "%.10g\n", *(const double *)(const void *)p);
        else if (table[i].kind == PARAM_COUNT)
            fprintf(f, "%d\n", *(const int *)(const void *)p);
        else if (table[i].kind == PARAM_SWITCH)
            fprintf(f, "%s\n", *(const bool *)(const void *)p ? "yes" : "no");
        else
            fprintf(f, "\n");
    }
}

void forces_print(FILE *f, const struct forces *m) {
    fprintf(f, "    %-22s (%g %g %g)\n", "gravity", m->gravity[0], m->gravity[1], m->gravity[2]);
    if (!source_shaken(&m->source)) return;
    const int ramped = m->source.knots > 0;
    if (ramped) fprintf(f, "    %-22s table (", shaking_param[0].name);
    for (int i = 0; i < m->source.knots; i++)
        fprintf(f, "%s(%.10g %.10g)", i ? " " : "", m->source.ramp[2 * i], m->source.ramp[2 * i + 1]);
    if (ramped) fprintf(f, ")\n");
    print_values(f, shaking_param + ramped, COUNT(shaking_param) - ramped, &m->source);
}

void models_print(FILE *f, const struct case_models *m, bool polyhedral) {
    fprintf(f, "Models\n    %-22s %s\n", "equationOfState", m->gas.eos->name);
    print_values(f, m->gas.eos->param, m->gas.eos->nparam, &m->gas.material);
    print_values(f, grain_param, grain_nparam, &m->gas.material);
    fprintf(f, "    %-22s %s\n", "cooling", cooling_names[m->gas.source.cooling]);
    if (m->gas.transport) {
        fprintf(f, "    %-22s %s\n", "transport", m->gas.transport->name);
        print_values(f, m->gas.transport->param, m->gas.transport->nparam, &m->gas.numbers);
        fprintf(f, "    %-22s %s\n", "bulk", bulk_names[m->gas.numbers.bulk_factor > 1]);
        fprintf(f, "    %-22s %s\n", "diffusion", m->gas.diffusion->name);
    }
    fprintf(f, "    %-22s %s\n", "fluxScheme", m->gas.flux->name);
    fprintf(f, "    %-22s %s\n", "meshEngine", engine_names[polyhedral]);
    fprintf(f, "    %-22s %s\n", polyhedral ? "polyReconstruct" : "reconstruct",
            polyhedral ? m->gas.polynomial->name : m->gas.reconstruct->name);
    fprintf(f, "    %-22s %s\n", "timeScheme", m->gas.stepper->name);
    print_values(f, solution_param, COUNT(solution_param), m);
    print_values(f, limits_param, COUNT(limits_param) - (m->gas.alpha_floor > 0 ? 0 : 1), m);
    forces_print(f, &m->forces);
}
