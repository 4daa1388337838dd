/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, checks and prints the choices for a segregation from its dictionaries (segregation_models.h). */
#include "solvers/segregation/segregation_models.h"

#include "libcore/models/boundary.h"
#include "solvers/dict/params.h"

#include <math.h>
#include <stdlib.h>

enum { PATH = 4096 };
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static const char *const percolation_names[] = {"constant", "expression", "exponential", "kineticStress", NULL};
static const char *const diffusivity_names[] = {"constant", "expression", NULL};
static const char *const closure_names[] = {"conservative", "paper", "neumann", NULL};
static const char *const iteration_names[] = {"Picard", "Newton", NULL};
static const char *const wall_names[] = {"cell", "wall", NULL};
static const char *const weight_names[] = {"uniform", "rho", NULL};

struct gravity {
    double value[3];
};
#define PARAM_STRUCT struct gravity
static const struct param gravity_param[] = {
    VECTOR("value", value, REQUIRED_AS("value (0 -9.81 0);"), ANY_NUMBER, UNIT(0, 1, -2),
           "against which f is counted; the rest of the file is not read"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct segregation_models
#define CASE_OF_GAS(use)                                                                                               \
    NOTED("case", "path, relative to the case", NULL, use, "case \"../gas\";"),                                        \
        NOTED("time", "number in s, or latestTime", "latestTime", "time folder of that case", "time latestTime;")
static const struct param properties_param[] = {
    NOTED("percolation", "dictionary", NULL, "velocity f at which small grains fall through large ones",
          "percolation { type constant; velocity -0.1; }"),
    NOTED("diffusivity", "dictionary", NULL, "of the small grains among the large ones",
          "diffusivity { type constant; value 1e-3; }"),
    NOTED("velocity", "dictionary", "the start folder's U, at rest without one", "the flow that carries the grains",
          "velocity { case \"../gas\"; }"),
};
static const struct param percolation_param[] = {
    CHOICE("type", percolation, REQUIRED, percolation_names, "what f is"),
    NOTED("direction", "vector", "against constant/g", "along which f is counted; any length", "direction (0 1 0);"),
};
static const struct param velocity_param[] = {
    NUMBER("velocity", velocity, REQUIRED, ANY_NUMBER, UNIT(0, 1, -1),
           "f, along the solved axis, or direction (x y z) (default: against constant/g)"),
};
static const struct param velocity_law_param[] = {
    NOTED("velocity", "expression of x, y, z", NULL, "f in m/s", "velocity \"-0.1*exp(-y)\";"),
};
static const struct param exponential_param[] = {
    NUMBER("A", A, REQUIRED, FROM_TO(0, HUGE_VAL), UNIT(1, -1, -2), "kinetic stress A exp(B|y|)"),
    NUMBER("B", B, REQUIRED, ANY_NUMBER, UNIT(0, -1, 0), "of A exp(B|y|)"),
    NUMBER("q", q, REQUIRED, ANY_NUMBER, UNIT(0, 0, 1), "f = (q/rho) d/dy A exp(B|y|)"),
    NUMBER("rho", rho, REQUIRED, POSITIVE, UNIT(1, -3, 0), "density of the grains"),
};
static const struct param stress_param[] = {
    NUMBER("q", q, REQUIRED, ANY_NUMBER, UNIT(0, 0, 1), "f = (q/rho) d(rho T)/dy of that run's fields"),
    NUMBER("rho", rho, REQUIRED, POSITIVE, UNIT(1, -3, 0), "density of the grains"),
    CASE_OF_GAS("of granularGas; on lines the mean over the other axes"),
};
static const struct param flow_param[] = {
    EITHER("weight", weighted, false, weight_names,
           "rho: (rho phi)_t + div(rho U phi) + ..: of a steady gas rho U has no divergence"),
    CASE_OF_GAS("of granularGas, whose U carries; on lines the mean over the other axes, for the shear rate"),
};
static const struct param diffusivity_type[] = {
    CHOICE("type", diffusivity_kind, REQUIRED, diffusivity_names, "what D is"),
};
static const struct param diffusivity_param[] = {
    NUMBER("value", diffusivity, REQUIRED_AS("value 1e-3;"), FROM_TO(0, HUGE_VAL), UNIT(0, 2, -1), "D"),
};
static const struct param diffusivity_law_param[] = {
    NOTED("value", "expression of x, y, z, phi, shearRate", NULL, "D in m^2/s; shearRate is sqrt(2 S:S) of the flow",
          "value \"1e-3*(1 + shearRate)\";"),
};
static const struct param schemes_param[] = {
    CHOICE("closure", scheme.closure, 0, closure_names, "of the end cells"),
    EITHER("wallValues", on_walls, false, wall_names,
           "where the values of the end cells stand: at their centres, or on the walls (half cells, the paper's line)"),
    NOTED("bounded", "switch", "on with closure conservative, else off", "0 <= phi <= 1 whatever D", "bounded on;"),
    IGNORED("ddtSchemes", "for OpenFOAM"),
    IGNORED("gradSchemes", "for OpenFOAM"),
    IGNORED("divSchemes", "for OpenFOAM"),
    IGNORED("laplacianSchemes", "for OpenFOAM"),
    IGNORED("interpolationSchemes", "for OpenFOAM"),
    IGNORED("snGradSchemes", "for OpenFOAM"),
};
static const struct param solution_param[] = {
    EITHER("iteration", scheme.newton, true, iteration_names,
           "for the nonlinear equations of a step; Picard: the paper's"),
    NUMBER("tolerance", scheme.tolerance, 1e-8, FROM_TO(1e-15, 1), NO_UNIT,
           "largest change of an iteration / largest phi"),
    WHOLE("maxIterations", scheme.most, 100, FROM_TO(1, 1e6), "iterations a step may take"),
    WHOLE("dampedSteps", damped, 1, FROM_TO(0, 1e6),
          "first steps by two implicit Euler halves, which end the ringing of a start that does not meet the walls"),
    NUMBER("timeTolerance", time_tolerance, 1e-6, POSITIVE, NO_UNIT, "with adjustTimeStep: mean error of a step"),
};
static const char *const closure_about[] = {"no flux through the walls: conserves to round-off (default)",
                                            "f phi (1 - phi) = D phi_y at the walls, one-sided: does not conserve",
                                            "phi_y = 0 at the walls, one-sided: for the kink"};

static const char *const phi_types[] = {"noFlux", "fixedValue", "zeroGradient", NULL};
static const char *const phi_about[] = {
    "a wall: nothing goes through; all that a line of cells takes",
    "phi on the patch is the value (needs value): U phi, percolation and diffusion go through. Wanted where U leads "
    "in. "
    "Where cells are too wide for D, (|U| + |f|) h > 2 D, waves that run out carry phi of the cell out",
    "phi on the patch is that of the cell: U phi and percolation go through, diffusion does not. Not where U leads in"};
static const struct param phi_param[] = {
    NOTED("value", "uniform VALUE, or nonuniform List<scalar>", NULL, "phi on the faces of the patch",
          "value uniform 0.3;"),
};
const struct field_kind segregation_phi = {"phi",     1,    {0, 0, 0, 0, 0, 0, 0}, "concentration of the small grains",
                                           phi_types, false};

static status read_law(struct dict *d, const char *key, bool mixture, struct expr **out) {
    const char *text;
    TRY(dict_word(d, key, &text));
    return dict_note_expression(d, key, text, mixture ? expr_compile_mixture(text, out) : expr_compile(text, out));
}

/* Scales v to length 1; returns false if it is 0. The squares of the largest and the least numbers are none, so that
 * such a v is divided by its largest component first. */
static bool make_unit(double v[3]) {
    const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    const double scale = most > 0 && (most > 1e150 || most < 1e-100) ? most : 1;
    for (int k = 0; k < 3; k++) v[k] /= scale;
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3 && most > 0; k++) v[k] /= length;
    return most > 0;
}

static status read_direction(struct dict *d, struct segregation_models *m) {
    double *v = m->direction;
    m->has_direction = dict_has(d, "direction");
    if (!m->has_direction) return OK;
    TRY(dict_vector(d, "direction", NULL, v));
    return make_unit(v) ? OK : dict_fail(d, "direction", "it must not be (0 0 0)");
}

/* Reads constant/g: without a direction f is counted against gravity. */
static status read_gravity(struct dict *d, struct segregation_models *m) {
    struct gravity g;
    dict_mark_used(d);
    TRY(params_read(d, gravity_param, COUNT(gravity_param), &g));
    if (m->has_direction || !make_unit(g.value)) return OK;
    m->has_direction = true;
    for (int k = 0; k < 3; k++) m->direction[k] = -g.value[k];
    return OK;
}

/* Reads `time`, a number or latestTime, which is the default. */
static status read_time(struct dict *d, double *out) {
    static const char *const names[] = {"latestTime"};
    static const signed char unit[3] = {0, 0, 1};
    int latest;
    *out = NAN;
    if (!dict_has(d, "time")) return OK;
    status number = dict_number(d, "time", unit, out);
    if (!number) return OK;
    status word = dict_choice(d, "time", names, 1, &latest);
    status_free(word ? word : number);
    return word ? number : OK;
}

static status read_velocity(struct dict *d, struct segregation_models *m) {
    TRY(dict_word(d, "case", &m->velocity_case));
    TRY(read_time(d, &m->velocity_time));
    return params_read(d, flow_param, COUNT(flow_param), m);
}

static status read_percolation(struct dict *d, struct segregation_models *m) {
    TRY(params_read(d, percolation_param, COUNT(percolation_param), m));
    TRY(read_direction(d, m));
    if (m->percolation == PERCOLATION_EXPRESSION) return read_law(d, "velocity", false, &m->velocity_law);
    if (m->percolation == PERCOLATION_EXPONENTIAL)
        return params_read(d, exponential_param, COUNT(exponential_param), m);
    if (m->percolation == PERCOLATION_CONSTANT) return params_read(d, velocity_param, COUNT(velocity_param), m);
    TRY(dict_word(d, "case", &m->case_dir));
    TRY(read_time(d, &m->time));
    return params_read(d, stress_param, COUNT(stress_param), m);
}

static status read_properties(struct dict *d, struct segregation_models *m) {
    struct dict *percolation, *diffusivity, *velocity = NULL;
    TRY(dict_sub(d, "percolation", &percolation));
    TRY(read_percolation(percolation, m));
    TRY(dict_sub(d, "diffusivity", &diffusivity));
    TRY(params_read(diffusivity, diffusivity_type, COUNT(diffusivity_type), m));
    if (m->diffusivity_kind == 1)
        TRY(read_law(diffusivity, "value", true, &m->diffusivity_law));
    else
        TRY(params_read(diffusivity, diffusivity_param, COUNT(diffusivity_param), m));
    m->sheared = m->diffusivity_law && expr_uses(m->diffusivity_law, EXPR_SHEAR_RATE);
    TRY(dict_sub_optional(d, "velocity", &velocity));
    if (velocity) TRY(read_velocity(velocity, m));
    return dict_check_used(d);
}

static status read_schemes(struct dict *d, struct segregation_models *m) {
    bool bounded;
    TRY(params_read(d, schemes_param, COUNT(schemes_param), m));
    TRY(dict_switch_or(d, "bounded", m->scheme.closure == SEGREGATION_CONSERVATIVE, &bounded));
    m->scheme.unbounded = !bounded;
    if (m->scheme.closure != SEGREGATION_CONSERVATIVE && !m->on_walls)
        return dict_fail(d, "closure",
                         "it needs values on the walls: add  wallValues wall;  or say  closure conservative;");
    if (m->scheme.closure != SEGREGATION_CONSERVATIVE && bounded)
        return dict_fail(d, "bounded", "closure %s keeps no bounds; leave it out, or say  closure conservative;",
                         closure_names[m->scheme.closure]);
    return dict_check_used(d);
}

static status read_solution(struct dict *d, struct segregation_models *m) {
    TRY(params_read(d, solution_param, COUNT(solution_param), m));
    return dict_check_used(d);
}

static status open_in(const char *case_dir, const char *name, struct dict **out) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", case_dir, name);
    return dict_read(path, out);
}

static status read_all(const char *dir, struct segregation_models *m) {
    TRY(open_in(dir, "constant/segregationProperties", &m->properties));
    TRY(read_properties(m->properties, m));
    TRY(open_in(dir, "system/fvSchemes", &m->schemes));
    TRY(read_schemes(m->schemes, m));
    TRY(open_in(dir, "system/fvSolution", &m->solution));
    TRY(read_solution(m->solution, m));
    char path[PATH];
    snprintf(path, sizeof path, "%s/constant/g", dir);
    if (field_exists(path)) {
        TRY(dict_read(path, &m->g));
        TRY(read_gravity(m->g, m));
    }
    if (m->scheme.closure == SEGREGATION_PAPER && !m->diffusivity_law && m->diffusivity == 0)
        return dict_fail(m->schemes, "closure",
                         "f phi (1 - phi) = D phi_y at the walls needs D > 0; say  closure conservative;");
    return OK;
}

status segregation_models_read(const char *case_dir, struct segregation_models **out) {
    struct segregation_models *m = NULL;
    *out = NULL;
    TRY(allocate(&m, 1, sizeof *m, "models"));
    status s = read_all(case_dir, m);
    if (s) {
        segregation_models_free(m);
        return s;
    }
    *out = m;
    return OK;
}

void segregation_models_free(struct segregation_models *m) {
    if (!m) return;
    expr_free(m->velocity_law);
    expr_free(m->diffusivity_law);
    dict_free(m->g);
    dict_free(m->properties);
    dict_free(m->schemes);
    dict_free(m->solution);
    free(m);
}

double segregation_diffusivity(const struct segregation_models *m, const double x[3], double phi, double shear_rate) {
    if (!m->diffusivity_law) return m->diffusivity;
    return expr_value_mixture(m->diffusivity_law, x[0], x[1], x[2], 0, phi, shear_rate);
}
status segregation_diffusivity_check(const struct segregation_models *m, const double x[3], double shear_rate) {
    enum { SAMPLES = 21 };
    for (int k = 0; m->diffusivity_law && k < SAMPLES; k++) {
        const double phi = k / (SAMPLES - 1.), D = segregation_diffusivity(m, x, phi, shear_rate);
        if (D >= 0 && isfinite(D)) continue;
        return fail(ERR_INPUT, "%s: diffusivity: the expression gives %g at (%g %g %g), phi = %g; it must be 0 or more",
                    dict_path(m->properties), D, x[0], x[1], x[2], phi);
    }
    return OK;
}

void segregation_models_list(FILE *f) {
    fprintf(f, "constant/segregationProperties\n\npercolation { type .. }\n  constant\n");
    params_print(f, velocity_param, COUNT(velocity_param));
    fprintf(f, "  expression\n    velocity \"..\" of x, y, z, in m/s\n  exponential\n");
    params_print(f, exponential_param, COUNT(exponential_param));
    fprintf(
        f,
        "  kineticStress\n    case, time (latestTime): of a granularGas run; on lines the mean over the other axes\n");
    params_print(f, stress_param, COUNT(stress_param));
    fprintf(f, "\ndiffusivity { type .. }\n  constant\n");
    params_print(f, diffusivity_param, COUNT(diffusivity_param));
    fprintf(f,
            "  expression\n    value \"..\" of x, y, z, phi, shearRate (sqrt(2 S:S) of the flow), in m^2/s\n"
            "\nvelocity { } (default: the start folder's U, at rest without one)\n"
            "    case, time (latestTime): of a granularGas run whose U carries, of its cell at each centre; on lines "
            "the mean over the\n"
            "      other axes, for the shear rate\n"
            "    weight (uniform): or rho: (rho phi)_t + div(rho U phi) + ..: of a steady gas rho U has no divergence\n"
            "\nsystem/fvSchemes\n");
    params_print(f, schemes_param, COUNT(schemes_param));
    for (int i = 0; closure_names[i]; i++) fprintf(f, "  closure %-12s %s\n", closure_names[i], closure_about[i]);
    fprintf(f, "  bounded on, off      0 <= phi <= 1 whatever D; on with conservative\n\nsystem/fvSolution\n");
    params_print(f, solution_param, COUNT(solution_param));
}

static void percolation_keywords(struct keywords *k, const char *file) {
    keywords_at(k, file, "percolation", NULL);
    keywords_params(k, percolation_param, COUNT(percolation_param));
    keywords_at(k, file, "percolation", percolation_names[PERCOLATION_CONSTANT]);
    keywords_params(k, velocity_param, COUNT(velocity_param));
    keywords_at(k, file, "percolation", percolation_names[PERCOLATION_EXPRESSION]);
    keywords_params(k, velocity_law_param, COUNT(velocity_law_param));
    keywords_at(k, file, "percolation", percolation_names[PERCOLATION_EXPONENTIAL]);
    keywords_params(k, exponential_param, COUNT(exponential_param));
    keywords_at(k, file, "percolation", percolation_names[PERCOLATION_STRESS]);
    keywords_params(k, stress_param, COUNT(stress_param));
}

static void properties_keywords(struct keywords *k, const char *file) {
    keywords_at(k, file, "", NULL);
    keywords_params(k, properties_param, COUNT(properties_param));
    percolation_keywords(k, file);
    keywords_at(k, file, "diffusivity", NULL);
    keywords_params(k, diffusivity_type, COUNT(diffusivity_type));
    keywords_at(k, file, "diffusivity", diffusivity_names[0]);
    keywords_params(k, diffusivity_param, COUNT(diffusivity_param));
    keywords_at(k, file, "diffusivity", diffusivity_names[1]);
    keywords_params(k, diffusivity_law_param, COUNT(diffusivity_law_param));
    keywords_at(k, file, "velocity", NULL);
    keywords_params(k, flow_param, COUNT(flow_param));
}

static bool no_boundary(const struct boundary_type *b) {
    (void)b;
    return false;
}
static bool of_velocity(const struct boundary_type *b) {
    return boundary_takes(b, 3);
}

void segregation_models_keywords(struct keywords *k) {
    properties_keywords(k, "constant/segregationProperties");
    keywords_at(k, "constant/g", "", NULL);
    keywords_params(k, gravity_param, COUNT(gravity_param));
    keywords_at(k, "system/fvSchemes", "", NULL);
    keywords_params(k, schemes_param, 1);
    keywords_words(k, "closure", closure_names, closure_about);
    keywords_params(k, schemes_param + 1, COUNT(schemes_param) - 1);
    keywords_at(k, "system/fvSolution", "", NULL);
    keywords_params(k, solution_param, COUNT(solution_param));
    fields_keywords(k, "0.orig/phi", no_boundary);
    for (int i = 0; phi_types[i]; i++) {
        char entry[KEYWORD_TEXT];
        snprintf(entry, sizeof entry, "type %s;", phi_types[i]);
        if (!strcmp(phi_types[i], "fixedValue")) keywords_entries(entry, phi_param, COUNT(phi_param));
        keywords_word(k, "type", phi_types[i], phi_about[i], entry);
    }
    keywords_at(k, k->file, k->dict, "fixedValue");
    keywords_params(k, phi_param, COUNT(phi_param));
    fields_keywords(k, "0.orig/U", of_velocity);
}

void segregation_boundaries_list(FILE *f) {
    for (int i = 0; phi_types[i]; i++) fprintf(f, "  %-14s %s\n", phi_types[i], phi_about[i]);
    fprintf(f, "  %-14s %s\n", "empty", "the axis is not solved; on patches of type empty");
}

static const char *text_of(const struct dict *d, const char *sub, const char *key) {
    struct dict *one = NULL;
    const char *text = "";
    status s = dict_sub((struct dict *)(uintptr_t)d, sub, &one);
    if (!s) s = dict_word(one, key, &text);
    status_free(s);
    return text;
}

static void print_time(FILE *f, const char *case_dir, double time) {
    fprintf(f, isnan(time) ? " of %s, latest time" : " of %s, time %.12g", case_dir, time);
}

void segregation_models_print(FILE *f, const struct segregation_models *m) {
    fprintf(f, "Models\n    %-22s %s", "percolation", percolation_names[m->percolation]);
    if (m->percolation == PERCOLATION_CONSTANT) fprintf(f, " %.10g m/s", m->velocity);
    if (m->percolation == PERCOLATION_EXPRESSION) fprintf(f, " %s", text_of(m->properties, "percolation", "velocity"));
    if (m->percolation == PERCOLATION_EXPONENTIAL) fprintf(f, " (%g/%g) d/dy %g exp(%g |y|)", m->q, m->rho, m->A, m->B);
    if (m->percolation == PERCOLATION_STRESS) print_time(f, m->case_dir, m->time);
    fprintf(f, "\n    %-22s ", "diffusivity");
    if (m->diffusivity_law)
        fprintf(f, "expression %s\n", text_of(m->properties, "diffusivity", "value"));
    else
        fprintf(f, "constant %.10g m^2/s\n", m->diffusivity);
    if (m->velocity_case) {
        fprintf(f, "    %-22s", "velocity");
        print_time(f, m->velocity_case, m->velocity_time);
        fprintf(f, ", weight %s\n", weight_names[m->weighted]);
    }
    fprintf(f, "    %-22s %s\n    %-22s %s\n    %-22s %s\n", "closure", segregation_closure_name(m), "wallValues",
            wall_names[m->on_walls], "bounded", m->scheme.unbounded ? "no" : "yes");
    fprintf(f, "    %-22s %s\n    %-22s %g\n    %-22s %d\n    %-22s %d\n    %-22s %g\n", "iteration",
            segregation_iteration_name(m), "tolerance", m->scheme.tolerance, "maxIterations", m->scheme.most,
            "dampedSteps", m->damped, "timeTolerance", m->time_tolerance);
}

const char *segregation_closure_name(const struct segregation_models *m) {
    return closure_names[m->scheme.closure];
}
const char *segregation_iteration_name(const struct segregation_models *m) {
    return iteration_names[m->scheme.newton];
}
