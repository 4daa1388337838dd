/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of friction and their table (docs/physics.md 4.10). friction.h has the equations. */
#include "libcore/models/friction.h"

#include "libcore/models/kernel.h"

#include <string.h>

static const double DEGREE = 3.14159265358979323846 / 180;

/* Defaults. Those of mu(I) are of glass beads (Jop, Forterre & Pouliquen, Nature 441, 2006, p. 727). */
#define MU_STATIC        0.38
#define MU_DYNAMIC       0.64
#define I_ZERO           0.279
#define MODULUS          300
#define SURFACE_COHESION 0.5
static const double FRICTION_FROM = 0.78, SOLID_FROM = 0.90; /* of alphaMax */

/* What a dictionary says. Where UNSAID stands, friction_params finds the value. */
struct friction_entries {
    struct friction_params p;
    double angle; /* degrees, with sin(angle) = mu_static */
};
OWN_PARAMS_FIT(struct friction_entries);
enum { UNSAID = -1 };
#define UNLESS_GIVEN(text, entry) (UNSAID), .usual = text, .example = entry

#define PARAM_STRUCT struct friction_entries
#define STATIC_PARAM                                                                                                   \
    NUMBER("muStatic", p.mu_static, MU_STATIC, FROM_TO(0, 1), NO_UNIT,                                                 \
           "coefficient of friction at rest: tan of the slope at which a layer starts, sin of frictionAngle")
#define ANGLE_PARAM                                                                                                    \
    NUMBER("frictionAngle", angle, UNLESS_GIVEN("asin muStatic", "frictionAngle 21;"), FROM_TO(0, 90), NO_UNIT,        \
           "degrees: another way to say muStatic = sin frictionAngle")
#define COMMON_PARAMS                                                                                                  \
    NUMBER("alphaFriction", p.alpha_friction, UNLESS_GIVEN("0.78 alphaMax", "alphaFriction 0.5;"), BETWEEN(0, 1),      \
           NO_UNIT, "packing fraction below which contacts do not last: no friction"),                                 \
        NUMBER("alphaSolid", p.alpha_solid, UNLESS_GIVEN("0.90 alphaMax", "alphaSolid 0.576;"), BETWEEN(0, 1),         \
               NO_UNIT, "packing fraction above which all stress is friction, and none is of collisions"),             \
        NUMBER("shearModulus", p.modulus, MODULUS, BETWEEN(0, 1e9), NO_UNIT,                                           \
               "of packed gas, over the greatest pressure of the bed: below 30 a heap sags"),                          \
        NUMBER("cohesion", p.cohesion, 0, FROM_TO(0, HUGE_VAL), UNIT(1, -1, -2), "adds to the yield stress"),          \
        NUMBER("surfaceCohesion", p.surface_cohesion, SURFACE_COHESION, FROM_TO(0, 100), NO_UNIT,                      \
               "numerical cohesion of surface cells over rho g h: holds the steps of a slope"),                        \
        NUMBER("frictionalHeating", p.heating, 0, FROM_TO(0, 1), NO_UNIT,                                              \
               "part of the work of friction that heats the gas; the rest is true heat, which leaves it")
static const struct param coulomb_param[] = {STATIC_PARAM, ANGLE_PARAM, COMMON_PARAMS};
static const struct param mu_I_param[] = {
    STATIC_PARAM,
    NUMBER("muDynamic", p.mu_dynamic, MU_DYNAMIC, FROM_TO(0, 10), NO_UNIT, "coefficient of friction of fast shear"),
    NUMBER("I0", p.I0, I_ZERO, POSITIVE, NO_UNIT, "inertial number at which mu is half way to muDynamic"),
    ANGLE_PARAM,
    COMMON_PARAMS,
};
#undef PARAM_STRUCT

void friction_complete(struct own_params *own, const struct material *m) {
    static const struct friction_params standard = {.mu_static = MU_STATIC,
                                                    .alpha_friction = UNSAID,
                                                    .alpha_solid = UNSAID,
                                                    .modulus = MODULUS,
                                                    .surface_cohesion = SURFACE_COHESION};
    struct friction_entries e;
    memcpy(&e, own, sizeof e);
    if (e.p.modulus == 0) e = (struct friction_entries){standard, UNSAID}; /* the row has no parameters */
    if (e.angle >= 0) e.p.mu_static = sin(e.angle * DEGREE);
    e.angle = asin(smaller(e.p.mu_static, 1)) / DEGREE;
    if (e.p.I0 == 0) { /* the row has one coefficient */
        e.p.I0 = I_ZERO;
        e.p.mu_dynamic = e.p.mu_static;
    }
    if (e.p.alpha_friction < 0) e.p.alpha_friction = FRICTION_FROM * m->alpha_max;
    if (e.p.alpha_solid < 0) e.p.alpha_solid = SOLID_FROM * m->alpha_max;
    memcpy(own, &e, sizeof e);
}

struct friction_params friction_params(const struct own_params *own, const struct material *m) {
    struct own_params all = *own;
    struct friction_params p;
    friction_complete(&all, m);
    memcpy(&p, &all, sizeof p); /* the first member of the entries */
    return p;
}

const char *friction_objection(const struct friction_params *p) {
    if (!(p->mu_dynamic >= p->mu_static))
        return "muDynamic is below muStatic: shear would run away, as faster shear would be held back less";
    if (!(p->alpha_solid > p->alpha_friction)) return "alphaSolid must be above alphaFriction";
    return NULL;
}

void friction_share(const struct friction_params *p, const struct material *m, int n, const double *restrict rho,
                    double *restrict share) {
    const double per = packing_per_density(m), slope = 1 / (p->alpha_solid - p->alpha_friction);
    for (int i = 0; i < n; i++) share[i] = smaller(larger((per * rho[i] - p->alpha_friction) * slope, 0), 1);
}

/* One coefficient at any shear rate. */
static void coulomb(const struct friction_params *p, int n, const double *restrict inertia, double *restrict mu) {
    (void)inertia;
    for (int i = 0; i < n; i++) mu[i] = p->mu_static;
}

/* mu(I) = muStatic + (muDynamic - muStatic)/(1 + I0/I); I = 0 gives muStatic. */
KERNEL static void mu_I(const struct friction_params *p, int n, const double *restrict inertia, double *restrict mu) {
    const double low = p->mu_static, more = p->mu_dynamic - p->mu_static, I0 = p->I0;
    for (int i = 0; i < n; i++) mu[i] = low + more / (1 + I0 / inertia[i]);
}

const struct friction friction_table[] = {
    {MODEL("none", "grains do not rub: nothing rests on a slope"), .on = false},
    {MODEL_WITH("Coulomb", "friction with one coefficient", coulomb_param), .on = true, .coefficient = coulomb},
    {MODEL_WITH("muI", "friction that grows with the shear rate, mu(I) (Jop, Forterre & Pouliquen 2006)", mu_I_param),
     .on = true, .coefficient = mu_I},
};
const int friction_count = sizeof friction_table / sizeof *friction_table;

const struct friction *friction_find(const char *name) {
    return model_find(friction_table, sizeof *friction_table, friction_count, name);
}
