/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, prints and lists the choices of the dictionaries (models.h): models by one loop over the table of families,
 * and the parameters that belong to no row of them. */
#include "solvers/gas/models.h"

#include "solvers/case/case.h"
#include "solvers/case/fields.h"
#include "solvers/dict/family.h"
#include "solvers/dict/params.h"
#include "solvers/gas/layers.h"
#include "solvers/gas/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
enum { PATH = 4096 };
#define COUNT(table) ((int)(sizeof table / sizeof *table))

#define PARAM_STRUCT struct forces
static const struct param gravity_param[] = {
    NOTED("dimensions", "dimensions", "none", "checked where they are given", "dimensions [0 1 -2 0 0 0 0];"),
    VECTOR("value", gravity, REQUIRED_AS("value (0 -9.81 0);"), ANY_NUMBER, UNIT(0, 1, -2),
           "acceleration; 0 along the axes that 'empty' patches take away, but where the gas may move along them"),
};
static const char *const shaking_names[] = {"none", "sinusoidal", NULL};
static const struct param shaking_type[] = {
    CHOICE("type", shaken, REQUIRED_AS("type sinusoidal;"), shaking_names,
           "sinusoidal: gravity is g (1 + amplitude cos(2 pi frequency t + phase))"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct sources
static const struct param shaking_param[] = {
    NUMBER("amplitude", amplitude, REQUIRED_AS("amplitude table ((0 2.75) (2 2.75) (4 2));"), TABLE_OR_NUMBER, NO_UNIT,
           "of g(t) = g (1 + amplitude cos(2 pi frequency t + phase)), in units of g and not of length: a plate that "
           "moves by +-A m has A (2 pi frequency)^2/g; or, in granularGas,  table ((t a) (t a) ..);"),
    NUMBER("frequency", frequency, REQUIRED_AS("frequency 10;"), POSITIVE, UNIT(0, 0, -1),
           "of the shaking, in Hz and not in rad/s"),
    NUMBER("phase", phase, 0, ANY_NUMBER, NO_UNIT, "of the shaking at t = 0, in rad"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct case_models
static const struct param properties_param[] = {
    NOTED("grain", "dictionary", NULL, "the grains", "grain { diameter 1e-3; restitution 0.9; }"),
    NOTED("friction", "dictionary", "none", "of grains that stay in contact", "friction { type muI; muStatic 0.38; }"),
    NOTED("carried", "dictionary", "none", "scalars that ride with the gas, by the names of their fields",
          "carried { dye { type passive; } }"),
};
static const struct param limits_param[] = {
    NUMBER("minDeltaTFraction", min_fraction, 1e-3, BETWEEN(0, 1), NO_UNIT,
           "the run has collapsed when dt falls below this part of what calm cells allow"),
    NUMBER("alphaFloor", gas.alpha_floor, 0, FROM_TO(0, 1), NO_UNIT, /* the last row: not printed if 0 */
           "alpha stays above it: mass is added, and counted, where the fluxes cannot help; 0: off"),
};
static const struct param solution_param[] = {
    SWITCH("skipUniform", gas.skip_uniform, true,
           "leave out cells whose surroundings are uniform to the bit; the result has the same bits"),
    SWITCH("skipUniformAxes", skip_axes, true,
           "compute one layer of cells along a periodic axis along which all is uniform to the bit; the same bits"),
    NOTED("diffusion", "dictionary", "none", "how transport is integrated", "diffusion { type RKJ2; }"),
    NOTED("acoustics", "dictionary", "none", "how sound is integrated", "acoustics { type implicit; }"),
    NOTED("limits", "dictionary", "none", "where a run ends, or mass is added", "limits { minDeltaTFraction 1e-4; }"),
    IGNORED("solvers", "for OpenFOAM"),
    IGNORED("SIMPLE", "for OpenFOAM"),
    IGNORED("PIMPLE", "for OpenFOAM"),
    IGNORED("PISO", "for OpenFOAM"),
    IGNORED("relaxationFactors", "for OpenFOAM"),
};
static const struct param schemes_param[] = {
    IGNORED("ddtSchemes", "for OpenFOAM"),           IGNORED("gradSchemes", "for OpenFOAM"),
    IGNORED("divSchemes", "for OpenFOAM"),           IGNORED("laplacianSchemes", "for OpenFOAM"),
    IGNORED("interpolationSchemes", "for OpenFOAM"), IGNORED("snGradSchemes", "for OpenFOAM"),
    IGNORED("fluxRequired", "for OpenFOAM"),
};
static const struct mesh_engine engine_table[] = {
    {MODEL("lattice", "tiles of equal boxes, with `reconstruct` (default where the mesh is one)"), false},
    {MODEL("polyhedral", "any cells, with `polyReconstruct` (default where the mesh is no lattice)"), true},
};
static const int engine_count = COUNT(engine_table);

/* The hooks `suits` and `holds` of families below; base is a struct case_models. */
static status eos_suits(struct dict *d, void *base) {
    struct gas_models *m = &((struct case_models *)base)->gas;
    (void)d;
    m->material.disks = m->eos->disks;
    return OK;
}
static status eos_holds(struct dict *d, void *base) {
    struct gas_models *m = &((struct case_models *)base)->gas;
    if (m->eos->packing && m->material.alpha_max == 0) m->material.alpha_max = m->eos->packing(m->material.friction);
    const char *objection = eos_objection(m->eos, &m->material);
    return objection ? dict_fail(d, "equationOfState", "%s", objection) : OK;
}

static status cooling_suits(struct dict *d, void *base) {
    const struct case_models *m = base;
    const struct material *grains = &m->gas.material;
    const struct cooling *law = m->source.cooling;
    if (law && !(law->valid & shape_of(grains)))
        return dict_fail(d, "cooling", "%s is for %s, equationOfState %s for %s", law->model.name,
                         grains->disks ? "spheres" : "disks", m->gas.eos->model.name,
                         grains->disks ? "disks" : "spheres");
    if (dict_has(d, "cooling") || effective_restitution(grains) >= 1) return OK;
    return fail(ERR_INPUT,
                "%s: keyword 'cooling' is missing; with restitution %g say  cooling Haff;  or  cooling none;",
                dict_path(d), effective_restitution(grains));
}

/* Is the source chosen by name? A source that has an entry of its own is not. */
static bool source_offered(const struct model *row) {
    return !((const struct source_type *)row)->active;
}

static status transport_suits(struct dict *d, void *base) {
    const struct gas_models *m = &((struct case_models *)base)->gas;
    const bool disks = m->material.disks;
    if (!m->transport) return OK;
    if (!(m->transport->valid & shape_of(&m->material)))
        return dict_fail(d, "transport", "%s is for %s, equationOfState %s for %s", m->transport->model.name,
                         disks ? "spheres" : "disks", m->eos->model.name, disks ? "disks" : "spheres");
    if (m->material.diameter == 0)
        return dict_fail(d, "transport", "grains without a diameter do not collide: say  transport none;");
    return OK;
}

static status friction_suits(struct dict *d, void *base) {
    const struct gas_models *m = &((struct case_models *)base)->gas;
    if (!friction_acts(m->friction) || m->eos->bounded) return OK;
    return dict_fail(d, "type",
                     "friction is for gas near packing, and %s has no alphaMax: say  type none;  or choose "
                     "another equationOfState",
                     m->eos->model.name);
}

static status friction_holds(struct dict *d, void *base) {
    struct case_models *m = base;
    m->gas.friction_params = friction_params(&m->friction, &m->gas.material);
    if (!friction_acts(m->gas.friction)) return OK;
    if (dict_has(d, "muStatic") && dict_has(d, "frictionAngle"))
        return dict_fail(d, "frictionAngle", "muStatic = sin frictionAngle is given, too: leave one of them out");
    friction_complete(&m->friction, &m->gas.material);
    const char *objection = friction_objection(&m->gas.friction_params);
    return objection ? dict_fail(d, "type", "%s", objection) : OK;
}

static status diffusion_suits(struct dict *d, void *base) {
    struct gas_models *m = &((struct case_models *)base)->gas;
    status missing = m->transport && !m->diffusion->plan ? linear_load(&m->linear) : OK, s = OK;
    if (missing) s = dict_fail(d, "type", "%s", status_text(missing));
    status_free(missing);
    return s;
}

static status acoustics_suits(struct dict *d, void *base) {
    const struct gas_models *m = &((struct case_models *)base)->gas;
    if (friction_acts(m->friction) && !m->acoustics->implicit)
        return dict_fail(
            d, "type",
            "friction %s lets packed gas rest in implicit acoustic steps: say  type automatic;  or  type implicit;  "
            "or  friction { type none; }  in constant/granularProperties",
            m->friction->model.name);
    if (!m->acoustics->implicit || m->acoustics->automatic || m->eos->bounded) return OK;
    return dict_fail(d, "type",
                     "implicit acoustics are for gas near packing, and %s has no alphaMax: say  type explicit;",
                     m->eos->model.name);
}

#define PROPERTIES "constant/granularProperties"
#define SCHEMES    "system/fvSchemes"
#define SOLUTION   "system/fvSolution"
#define MEMBER(m)  offsetof(struct case_models, m)
/* Families of a file are read and listed in this order. The defaults of fvSchemes take the least time to a given error
 * among those that also hold at shocks, walls and near vacuum, by postprocessing/reports/workPrecision.md. */
enum {
    EOS,
    COOLING,
    TRANSPORT,
    FRICTION,
    SOURCES,
    FLUX,
    RECONSTRUCT,
    STEPPER,
    ENGINE,
    POLYNOMIAL,
    DIFFUSION,
    ACOUSTICS,
    FAMILIES
};
static const struct family families[FAMILIES] = {
    [EOS] = {PROPERTIES, "equationOfState", .meaning = "equation of state", FAMILY_ROWS(eos), .key = "equationOfState",
             .must = true, .chosen = MEMBER(gas.eos), .params = MEMBER(gas.material), .suits = eos_suits,
             .holds = eos_holds},
    [COOLING] = {PROPERTIES, "cooling", .meaning = "energy lost in impacts",
                 .usual = "required with restitution below 1", FAMILY_ROWS(cooling), .key = "cooling",
                 .none = "no energy sink", .chosen = MEMBER(source.cooling), .params = MEMBER(source.cooling_params),
                 .suits = cooling_suits},
    [TRANSPORT] = {PROPERTIES, "transport", .meaning = "viscosity and heat conduction", FAMILY_ROWS(transport),
                   .key = "transport", .none = "inviscid", .tacit = true, .chosen = MEMBER(gas.transport),
                   .params = MEMBER(gas.transport_params), .suits = transport_suits},
    [FRICTION] = {PROPERTIES, "friction { type .. }", .meaning = "friction of grains that stay in contact",
                  .usual = "none without the dictionary", FAMILY_ROWS(friction), .sub = "friction", .key = "type",
                  .standard = "none", .flat = true, .tacit = true, .chosen = MEMBER(gas.friction),
                  .params = MEMBER(friction), .suits = friction_suits, .holds = friction_holds},
    [SOURCES] = {PROPERTIES, "sources ( .. )", .meaning = "what acts on the gas besides gravity and impacts",
                 FAMILY_ROWS(source), .key = "sources", .list = true, .offered = source_offered,
                 .chosen = MEMBER(source.on), .params = MEMBER(source.params)},
    [FLUX] = {SCHEMES, "system/fvSchemes: fluxScheme", .meaning = "numerical flux between cells", FAMILY_ROWS(flux),
              .key = "fluxScheme", .standard = "common", .chosen = MEMBER(gas.flux), .params = MEMBER(gas.flux_params)},
    [RECONSTRUCT] = {SCHEMES, "system/fvSchemes: reconstruct",
                     .meaning = "reconstruction within the cells of a lattice", FAMILY_ROWS(reconstruct),
                     .key = "reconstruct", .standard = "WPENO5", .chosen = MEMBER(gas.reconstruct)},
    [STEPPER] = {SCHEMES, "system/fvSchemes: timeScheme", .meaning = "Runge-Kutta scheme of a step",
                 FAMILY_ROWS(stepper), .key = "timeScheme", .standard = "SSPRK43", .chosen = MEMBER(gas.stepper)},
    [ENGINE] = {SCHEMES, "system/fvSchemes: meshEngine", .meaning = "insists on one of the two kinds of mesh",
                .usual = "as the mesh is", FAMILY_ROWS(engine), .key = "meshEngine", .chosen = MEMBER(engine)},
    [POLYNOMIAL] = {SCHEMES, "system/fvSchemes: polyReconstruct", .meaning = "reconstruction within polyhedral cells",
                    FAMILY_ROWS(polynomial), .key = "polyReconstruct", .standard = "CWENO3",
                    .chosen = MEMBER(gas.polynomial)},
    [DIFFUSION] = {SOLUTION, "system/fvSolution: diffusion { type .. }",
                   .meaning = "integration in time of viscosity and heat conduction",
                   .usual = "RKJ2 without the dictionary", FAMILY_ROWS(diffusion), .sub = "diffusion", .key = "type",
                   .standard = "RKJ2", .chosen = MEMBER(gas.diffusion), .suits = diffusion_suits},
    [ACOUSTICS] = {SOLUTION, "system/fvSolution: acoustics { type .. }", .meaning = "integration in time of sound",
                   .usual = "automatic without the dictionary", FAMILY_ROWS(acoustics), .sub = "acoustics",
                   .key = "type", .standard = "automatic", .chosen = MEMBER(gas.acoustics),
                   .params = MEMBER(gas.acoustics_params), .suits = acoustics_suits},
};

static bool stands_in(const struct family *k, const char *file) {
    return !strcmp(k->file, file);
}
static status read_families(const char *file, struct dict *d, struct case_models *m) {
    for (int i = 0; i < FAMILIES; i++)
        if (stands_in(&families[i], file)) TRY(family_read(&families[i], d, m));
    return OK;
}
static void list_families(FILE *f, const char *file) {
    for (int i = 0; i < FAMILIES; i++)
        if (stands_in(&families[i], file)) family_list(f, &families[i]);
}
status models_leave(struct dict *properties) {
    struct dict *carried;
    TRY(dict_sub_optional(properties, "carried", &carried));
    if (carried) dict_mark_used(carried);
    for (int i = 0; i < FAMILIES; i++)
        if (stands_in(&families[i], PROPERTIES)) TRY(family_leave(&families[i], properties));
    return OK;
}

static status read_properties(struct dict *d, struct case_models *m) {
    struct dict *grain;
    TRY(dict_sub(d, "grain", &grain));
    TRY(params_read(grain, grain_param, grain_nparam, &m->gas.material));
    for (int i = 0; i < grain_nparam; i++) dict_belongs(d, grain_param[i].name, "grain");
    TRY(read_families(PROPERTIES, d, m));
    TRY(carried_read(d, m));
    return dict_check_used(d);
}

status models_equation(struct dict *properties, struct gas_models *out) {
    struct case_models m = {.engine = NULL};
    struct dict *grain;
    TRY(dict_sub(properties, "grain", &grain));
    TRY(params_read(grain, grain_param, grain_nparam, &m.gas.material));
    TRY(family_read(&families[EOS], properties, &m));
    *out = m.gas;
    return OK;
}

static status read_schemes(struct dict *d, struct case_models *m) {
    /* asked for first, so that messages that list the known keywords begin with it */
    (void)dict_has(d, families[ENGINE].key);
    TRY(read_families(SCHEMES, d, m));
    TRY(params_read(d, schemes_param, COUNT(schemes_param), m));
    return dict_check_used(d);
}

static status read_solution(struct dict *d, struct case_models *m) {
    struct dict *limits, *none = NULL;
    TRY(params_read(d, solution_param, COUNT(solution_param), m));
    TRY(read_families(SOLUTION, d, m));
    TRY(dict_sub_optional(d, "limits", &limits));
    if (!limits) TRY(dict_from_text("limits", "", &none));
    status s = params_read(limits ? limits : none, limits_param, COUNT(limits_param), m);
    dict_free(none);
    TRY(s);
    return dict_check_used(d);
}

/* Turns a vector to computational axes. */
static void turn_vector(int components, const int axis[3], const double physical[3], double turned[3]) {
    for (int k = 0; k < 3; k++) turned[k] = k < components ? physical[axis[k]] : 0;
}

static status read_gravity(struct dict *d, struct forces *m) {
    static const signed char expected[7] = {0, 1, -2, 0, 0, 0, 0};
    signed char dimensions[7];
    if (dict_has(d, "dimensions")) {
        TRY(dict_dimensions(d, "dimensions", dimensions));
        if (memcmp(dimensions, expected, 7)) return dict_fail(d, "dimensions", "gravity needs [0 1 -2 0 0 0 0]");
    }
    TRY(status_note(params_read(d, gravity_param, COUNT(gravity_param), m),
                    "%s: gravity is a vector; downwards along y is  value (0 -9.81 0);", dict_path(d)));
    return dict_check_used(d);
}

static status read_shaking(struct dict *d, struct forces *m) {
    TRY(params_read(d, shaking_type, COUNT(shaking_type), m));
    if (m->shaken) {
        if (!m->g) return dict_fail(d, "type", "shaking modulates gravity; constant/g is missing");
        if (dict_has(d, "amplitude")) TRY(dict_table(d, "amplitude", &m->source.knots, &m->source.ramp));
        const int ramped = m->source.knots > 0; /* a table stands in place of the first row, the amplitude */
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

static status read_forces(const char *dir, struct forces *m) {
    TRY(open_in(dir, "constant/g", true, &m->g));
    if (m->g) TRY(read_gravity(m->g, m));
    TRY(open_in(dir, "constant/shaking", true, &m->shaking));
    return m->shaking ? read_shaking(m->shaking, m) : OK;
}

status forces_read(const char *dir, int dim, const int axis[3], struct forces *m) {
    bool solved[3] = {false, false, false};
    TRY(read_forces(dir, m));
    turn_vector(dim, axis, m->gravity, m->source.gravity);
    for (int k = 0; k < dim; k++) solved[axis[k]] = true;
    for (int x = 0; x < 3; x++)
        if (!solved[x] && m->gravity[x] != 0)
            return dict_fail(m->g, "value", "its %c component must be 0: 'empty' patches take that axis away",
                             "xyz"[x]);
    return OK;
}

void forces_free(struct forces *f) {
    dict_free(f->g);
    dict_free(f->shaking);
}

/* Returns where parameter i of a row, a vector, begins in own_params.room; -1: it is none. */
static int vector_at(const struct model *row, int i) {
    return row->param[i].kind == PARAM_VECTOR ? (int)(row->param[i].offset / sizeof(double)) : -1;
}

void models_turn(struct case_models *m, int components, const int axis[3]) {
    struct sources *all = &m->gas.source;
    *all = m->forces.source;
    turn_vector(components, axis, m->forces.gravity, all->gravity);
    all->cooling = m->source.cooling;
    all->cooling_params = m->source.cooling_params;
    memcpy(all->on, m->source.on, sizeof all->on);
    memcpy(all->params, m->source.params, sizeof all->params);
    for (int row = 0; row < source_count; row++)
        for (int i = 0; i < source_table[row].model.nparam && all->on[row]; i++) {
            const int at = vector_at(&source_table[row].model, i);
            if (at >= 0) turn_vector(components, axis, m->source.params[row].room + at, all->params[row].room + at);
        }
}

void models_move(const struct case_models *m, bool along[3]) {
    for (int x = 0; x < 3; x++) along[x] = m->forces.gravity[x] != 0;
    for (int row = 0; row < source_count; row++)
        for (int i = 0; i < source_table[row].model.nparam && m->source.on[row]; i++) {
            const int at = vector_at(&source_table[row].model, i);
            for (int x = 0; x < 3 && at >= 0; x++) along[x] |= m->source.params[row].room[at + x] != 0;
        }
}

static status read_all(const char *dir, int dim, const int axis[3], struct case_models *m) {
    TRY(open_in(dir, PROPERTIES, false, &m->properties));
    TRY(read_properties(m->properties, m));
    if (m->gas.material.disks && dim == 3)
        return dict_fail(m->properties, "equationOfState",
                         "%s is for disks, which move in one or two dimensions; an 'empty' patch takes an axis away",
                         m->gas.eos->model.name);
    TRY(open_in(dir, SCHEMES, false, &m->schemes));
    TRY(read_schemes(m->schemes, m));
    TRY(open_in(dir, SOLUTION, false, &m->solution));
    TRY(read_solution(m->solution, m));
    TRY(read_forces(dir, &m->forces));
    models_turn(m, dim, axis);
    return carried_check(m);
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

status models_round(const struct setup *s, struct case_models *m) {
    const struct revolution *r = &s->mesh->round;
    const bool disks = m->gas.material.disks;
    bool moved[3];
    models_move(m, moved);
    if (disks)
        return dict_fail(m->properties, "equationOfState",
                         "%s is for disks, which move in a plane, but `axis` of "
                         "system/meshDict makes a body of revolution of the mesh: choose spheres",
                         m->gas.eos->model.name);
    for (int x = 0; x < 3; x++)
        if (moved[x] && x != r->axial)
            return round_refuse(s, "gravity, or another source, across the axis",
                                "it would not be the same all around; let it act along the axis");
    if (gas_rubs(&m->gas) && s->dim < 2)
        return round_refuse(s, "friction on radial cells alone", "give the mesh cells along the axis, too");
    return OK;
}

status models_swirl(const struct setup *s, struct case_models *m) {
    if (gas_rubs(&m->gas))
        return round_refuse(s, "friction beside swirl, a velocity around the axis,", "take that velocity away");
    if (m->gas.acoustics && m->gas.acoustics->implicit && !m->gas.acoustics->automatic)
        return round_refuse(s, "acoustics implicit beside swirl, a velocity around the axis,",
                            "say  acoustics { type explicit; }  in system/fvSolution");
    m->gas.acoustics = model_find(acoustics_table, sizeof *acoustics_table, acoustics_count, "explicit");
    return OK;
}

/* ---- local time steps ---- */

status models_local(const struct setup *s, const struct case_models *m) {
    const char *cure, *what = gas_local_lacks(&m->gas, s->grid->polyhedra != NULL, s->mesh->round.on, &cure);
    if (!what) return OK;
    return dict_fail(m->schemes, "timeScheme", "local is not there for %s: %s%ssay  timeScheme SSPRK43;", what,
                     cure ? cure : "", cure ? ", or " : "");
}

/* ---- listing and printing ---- */

void forces_list(FILE *f) {
    fprintf(f, "\nconstant/shaking, type sinusoidal\n");
    params_print(f, shaking_param, COUNT(shaking_param));
}

void models_list(FILE *f) {
    fprintf(f, "%s\n\ngrain { }\n", PROPERTIES);
    params_print(f, grain_param, grain_nparam);
    list_families(f, PROPERTIES);
    carried_list(f);
    forces_list(f);
    fprintf(f, "\n%s: defaults by measurement, postprocessing/reports/workPrecision.md\n", SCHEMES);
    list_families(f, SCHEMES);
    fprintf(f, "\n%s\n", SOLUTION);
    params_print(f, solution_param, COUNT(solution_param));
    list_families(f, SOLUTION);
    fprintf(f, "\n%s: limits { }\n", SOLUTION);
    params_print(f, limits_param, COUNT(limits_param));
    layers_list(f);
}

/* Goes through a file of the models, whose other keywords are top[n]. */
static void go_through(struct keywords *k, const char *file, const struct param *top, int n) {
    for (int i = 0; i < FAMILIES; i++)
        if (stands_in(&families[i], file) && !families[i].sub) keywords_family(k, &families[i]);
    keywords_at(k, file, "", NULL);
    keywords_params(k, top, n);
    if (!strcmp(file, PROPERTIES)) {
        grain_keywords(k);
        carried_keywords(k, file);
    }
    for (int i = 0; i < FAMILIES; i++) {
        if (!stands_in(&families[i], file)) continue;
        if (families[i].sub) keywords_family(k, &families[i]);
        keywords_coeffs(k, &families[i]);
    }
}

void models_leave_keywords(struct keywords *k) {
    keywords_at(k, PROPERTIES, "", NULL);
    for (int i = 0; i < FAMILIES; i++) {
        const struct param row = IGNORED(families[i].sub ? families[i].sub : families[i].key,
                                         i == EOS ? "for granularGas and a settledLayer" : "for granularGas");
        if (stands_in(&families[i], PROPERTIES) && !families[i].list) keywords_params(k, &row, 1);
    }
    const struct param carried = IGNORED("carried", "for granularGas");
    keywords_params(k, &carried, 1);
}

void grain_keywords(struct keywords *k) {
    keywords_at(k, PROPERTIES, "grain", NULL);
    keywords_params(k, grain_param, grain_nparam);
}

void forces_keywords(struct keywords *k) {
    keywords_at(k, "constant/g", "", NULL);
    keywords_params(k, gravity_param, COUNT(gravity_param));
    keywords_at(k, "constant/shaking", "", NULL);
    keywords_params(k, shaking_type, COUNT(shaking_type));
    keywords_at(k, "constant/shaking", "", shaking_names[1]);
    keywords_params(k, shaking_param, COUNT(shaking_param));
}

void models_keywords(struct keywords *k) {
    go_through(k, PROPERTIES, properties_param, COUNT(properties_param));
    forces_keywords(k);
    go_through(k, SCHEMES, schemes_param, COUNT(schemes_param));
    go_through(k, SOLUTION, solution_param, COUNT(solution_param));
    keywords_at(k, SOLUTION, "limits", NULL);
    keywords_params(k, limits_param, COUNT(limits_param));
    round_keywords(k);
    fields_keywords(k, FIELD_FILES, NULL);
    layers_keywords(k);
}

void boundaries_list(FILE *f) {
    for (int i = 0; i < boundary_count; i++) {
        const struct boundary_type *b = &boundary_table[i];
        const char *value = boundary_value(b, boundary_takes(b, 3) ? 3 : 1);
        fprintf(f, "  %-24s %-11s %s%s%s\n", b->model.name, boundary_fields(b), b->model.about, value ? "; needs " : "",
                value ? value : "");
    }
    fprintf(f, "  %-24s %-11s %s\n", "cyclic", "scalars, U", "periodic; on patches of type cyclic");
    fprintf(f, "  %-24s %-11s %s\n", "empty", "scalars, U", "the axis is not solved; on patches of type empty");
    fprintf(f, "  %-24s %-11s %s\n", "calculated", "scalars", "in a written field that is not read again");
    fprintf(f, "beside value, inletValue, or U of a moving wall:  expression \"..\";  in x, y, z, t, of U  "
               "(\"u\" \"v\" \"w\")\n");
}

struct plate forces_plate(const struct forces *f) {
    const struct sources *s = &f->source;
    struct plate p = {.amplitude = fabs(s->amplitude)};
    if (!source_shaken(s)) return (struct plate){0};
    for (int i = 0; i < s->knots; i++) p.amplitude = fmax(p.amplitude, fabs(s->ramp[2 * i + 1]));
    const double *g = f->gravity, omega = 2 * PI * s->frequency;
    p.acceleration = p.amplitude * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    p.speed = p.acceleration / omega;
    p.way = p.speed / omega;
    return p;
}

void forces_print(FILE *f, const struct forces *m) {
    fprintf(f, "    %-22s (%g %g %g)\n", "gravity", m->gravity[0], m->gravity[1], m->gravity[2]);
    if (!source_shaken(&m->source)) return;
    const int ramped = m->source.knots > 0;
    if (ramped) fprintf(f, "    %-22s table (", shaking_param[0].name);
    for (int i = 0; i < m->source.knots; i++)
        fprintf(f, "%s(%.10g %.10g)", i ? " " : "", m->source.ramp[2 * i], m->source.ramp[2 * i + 1]);
    if (ramped) fprintf(f, ")\n");
    params_print_values(f, shaking_param + ramped, COUNT(shaking_param) - ramped, &m->source);
    const struct plate p = forces_plate(m);
    fprintf(f, "    %-22s moves by +-%.4g m, at most %.4g m/s and %.4g m/s^2\n", "plate", p.way, p.speed,
            p.acceleration);
}

void models_print(FILE *f, const struct case_models *m, bool polyhedral) {
    fprintf(f, "Models\n");
    for (int i = 0; i < FAMILIES; i++) {
        if (!stands_in(&families[i], PROPERTIES)) continue;
        family_print(f, &families[i], m);
        if (i == EOS) params_print_values(f, grain_param, grain_nparam, &m->gas.material);
    }
    if (m->gas.transport) family_print(f, &families[DIFFUSION], m);
    family_print(f, &families[FLUX], m);
    fprintf(f, "    %-22s %s\n", families[ENGINE].key, engine_table[polyhedral].model.name);
    family_print(f, &families[polyhedral ? POLYNOMIAL : RECONSTRUCT], m);
    family_print(f, &families[STEPPER], m);
    family_print(f, &families[ACOUSTICS], m);
    params_print_values(f, solution_param, COUNT(solution_param), m);
    params_print_values(f, limits_param, COUNT(limits_param) - (m->gas.alpha_floor > 0 ? 0 : 1), m);
    carried_print(f, m);
    forces_print(f, &m->forces);
}

/* ---- memory ---- */

/* Returns the doubles of a bed (libcore/acoustics/bed_private.h) that holds these numbers of cells and faces, with its
 * room to grow. */
static double bed_memory(int dim, int components, double cells, double faces) {
    const int nvar = components + 2;
    return 1.5 * (cells * (13 + components + nvar * (3 + dim)) + faces * (17 + 2 * nvar));
}

/* Returns what friction adds to that (libcore/acoustics/bed_friction_private.h), and what it keeps of all cells from
 * step to step; faces: of one cell. */
static double friction_memory(const struct gas_models *g, int dim, int components, double cells, double faces) {
    const int u = components, tensors = u * (u + 1) / 2;
    if (!gas_rubs(g)) return 0;
    const double of_cell = 4 + u * (6 + dim), of_face = 5.5 + 2 * tensors + 6 * u;
    return cells * (1.5 * (of_cell + faces * (dim + 0.5 * of_face)) + 1 + faces * tensors);
}

double models_memory(const struct setup *s, const struct gas_models *g) {
    const struct forest *f = s->grid->forest;
    const struct polyhedra *m = s->grid->polyhedra;
    const struct transport_terms terms = transport_terms(g->transport, &g->transport_params);
    if (f) { /* five variables of states and scratch; with transport also struct diffuser */
        const int further = (terms.cross ? f->dim + 1 : 0) + terms.dilation;
        const double sheets = 8. * f->dim * (f->dim - 1) * (double)f->sheet / (double)f->size;
        const double diffuser = g->transport ? 3 * s->components + 5 * f->dim + 5 + further + sheets : 0;
        const double bed =
            gas_may_be_dense(g) ? 2 + f->dim * (s->components + 2) + bed_memory(f->dim, s->components, 1, f->dim) : 0;
        return (double)f->ntiles_all * (double)f->size *
               (5 * 5 + diffuser + bed + friction_memory(g, f->dim, s->components, 1, 2 * f->dim) +
                carried_memory(g, f->dim)) *
               8;
    }
    const int dim = m->dim, degree = g->polynomial->degree, u = s->components;
    const int coefficients = degree == 0 ? 0 : degree == 1 ? dim : dim * (dim + 3) / 2;
    double members = m->nnear ? m->stencil_start[m->nnear] * 1. / m->nnear : 0, faces = s->mesh->nfaces,
           sides = m->face.n ? m->point.n * 1. / m->face.n : 1;
    const bool transport = g->transport != NULL;
    const double diffuser = transport ? 8. * (u * (dim + 3) + 5) + (dim + 1.) * (8 * dim + 4) : 0;
    double cell =
        diffuser + (2 + u) * 8. * (5 + coefficients) + members * (8 * (coefficients + dim) + 8) + 8 * (1 + dim) + 48;
    const double bed = gas_may_be_dense(g)
                           ? s->mesh->ncells * 3. + faces * (2 * dim + 2) + bed_memory(dim, u, s->mesh->ncells, faces)
                           : 0;
    const double friction = friction_memory(g, dim, u, s->mesh->ncells, 2 * faces / s->mesh->ncells);
    /* struct cells_local, and the values at the points of faces that fits keep */
    const double local = g->stepper->local ? s->mesh->ncells * (8. + u) + faces * (4. * (2 + u) + 3) : 0;
    return 8 * (bed + friction + local) + s->mesh->ncells * (cell + 8 * carried_memory(g, dim)) +
           faces * (40 + 8 * dim * (dim + 1) + (transport ? 8 * (dim + 6 + terms.cross) : 0) +
                    sides * 8 * (1 + 2 * dim + 2 * coefficients));
}
