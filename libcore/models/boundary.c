/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of boundary conditions (boundary.h): the ghosts of each row, mirror walls (docs/physics.md 5.1) and open
 * patches (docs/physics.md 5.2), and the shares in which walls of a gas with transport drag it and exchange heat with
 * it (docs/physics.md 5.3). */
#include "libcore/models/boundary.h"

static const double PI = 3.14159265358979323846;

/* ---- states beyond a patch ---- */

static void copy(const struct rule *rule, const struct ghost_line *l) {
    (void)rule;
    for (int c = 0; c < l->components; c++) memcpy(l->ghost[c], l->inner[c], (size_t)l->n * sizeof(double));
}

static void flip_normal(const struct rule *rule, const struct ghost_line *l) {
    copy(rule, l);
    if (l->components == 1 && l->normal < 0) return; /* a scalar */
    for (int i = 0; i < l->n; i++) l->ghost[l->normal][i] = -l->inner[l->normal][i];
}

static void flip(const struct rule *rule, const struct ghost_line *l) {
    (void)rule;
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = -l->inner[c][i];
}

static double value_of(const struct rule *rule, int components, int face, int c) {
    return rule->values ? rule->values[face * components + c] : rule->uniform[c];
}

/* Returns the state beyond the patch at ghost i. Where the value g on the patch changes in time, what has come in has a
 * slope, which goes on beyond the patch: the line through g and the first cell, or if that of the first two cells is
 * less steep, that slope; g, if they disagree. (With g itself high orders see a kink at the patch, and do not
 * converge.) Scalars change by half of g at most. */
static double beyond(const struct rule *rule, const struct ghost_line *l, int c, int i) {
    const double g = value_of(rule, l->components, l->face[i], c);
    if (!rule->changes || l->layer == 0) return g;
    const double first = l->inner[c][i] - g, most = 0.5 * g / (2 * l->layer - 1); /* slopes by half a width */
    const double second = l->next[0] ? 0.5 * (l->next[c][i] - l->inner[c][i]) : first;
    double slope = first * second <= 0 ? 0 : fabs(first) < fabs(second) ? first : second;
    if (l->normal < 0) slope = larger(smaller(slope, most), -most);
    return g - (2 * l->layer - 1) * slope;
}

static void fixed(const struct rule *rule, const struct ghost_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = beyond(rule, l, c, i);
}

static void inlet_outlet(const struct rule *rule, const struct ghost_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++) l->ghost[c][i] = l->outflow[i] >= 0 ? l->inner[c][i] : beyond(rule, l, c, i);
}

/* Makes ghosts of the velocity from values of rho u, so that the same mass flows in at any density, or of u. */
static void fed(const struct rule *rule, const struct ghost_line *l) {
    for (int c = 0; c < l->components; c++)
        for (int i = 0; i < l->n; i++)
            l->ghost[c][i] = value_of(rule, l->components, l->face[i], c) / (rule->volume ? 1 : l->rho[i]);
}

/* ---- walls of a gas with transport ---- */

/* Computes the pressure on the wall itself, p of the cell + rho push d/2: gas that stays at a wall has dp/dn = rho push
 * there. */
static void find_pressure(const struct wall_line *l, double p[BATCH]) {
    double eps[BATCH] = {0}, square[BATCH], gruneisen[BATCH];
    for (int i = 0; i < l->n; i++) eps[i] = eps_of(l->material, l->T[i]);
    l->eos->state(l->material, l->n, l->rho, eps, p, square, gruneisen);
    for (int i = 0; i < l->n; i++)
        p[i] = larger(p[i] + 0.5 * l->d[i] * l->rho[i] * l->push[i], 0); /* 0: the wall leaves the gas behind */
}

/* Sets the share to 2, that of a wall whose velocity or temperature the gas on it has: the jump from the cell to the
 * wall lies in d/2. */
static void half_way(const struct rule *rule, const struct wall_line *l, double *share) {
    (void)rule;
    for (int i = 0; i < l->n; i++) share[i] = 2;
}

static double temperature_given(const struct rule *rule, int face) {
    return value_of(rule, 1, face, 0);
}

struct moving_wall {
    double U[3];
};
OWN_PARAMS_FIT(struct moving_wall);
#define PARAM_STRUCT struct moving_wall
static const struct param moving_param[] = {
    VECTOR("U", U, REQUIRED, ANY_NUMBER, UNIT(0, 1, -1), "of the wall, along itself"),
};
#undef PARAM_STRUCT

/* Gives the velocity of a wall that moves along itself: by its values, if it has any because it does not move alike
 * everywhere, else its parameter U. */
static void moving_velocity(const struct rule *rule, int components, int face, double out[3]) {
    struct moving_wall own;
    memcpy(&own, &rule->params, sizeof own);
    for (int c = 0; c < components; c++) out[c] = rule->values ? value_of(rule, components, face, c) : own.U[c];
}

/* Walls that take what impacts lose (docs/physics.md 5.4). A wall of restitution e takes the heat q = c p sqrt(T_w), c
 * = (1 - e^2)/sqrt(2 pi), with T_w of the gas on it: per area and time n sqrt(T_w/2 pi) grains hit it with a mean
 * normal energy of m T_w each, and n m T_w = p at a wall. The cell conducts 2 heat/d (T - T_w) to the wall. Both are
 * equal if s = sqrt(T_w) solves
 *     s^2 + 2 B s - T = 0,  B = c p d/(4 heat).
 * With B/s kept from the start the wall takes the share 4 B/(s + 2 B) of heat T/d, which is linear in T, and less than
 * a wall of T = 0 takes.
 * A gas without conduction has no such wall: heat would reach it only from the cell beside it, which is cold within
 * d/sqrt(T), so that the loss would vanish with d. */
static void absorbed_shares(double restitution, const struct wall_line *l, double *share) {
    const double c = (1 - restitution * restitution) / sqrt(2 * PI);
    double p[BATCH];
    find_pressure(l, p);
    for (int i = 0; i < l->n; i++) {
        const double T = l->T[i] + l->warmth[i];
        const double B = c * p[i] * l->d[i] / (4 * l->through[i]), s = T / (B + sqrt(B * B + T));
        share[i] = 4 / (s / B + 2); /* 0 if B = 0 */
    }
}

enum { UNSAID = -1 }; /* a coefficient of friction that is not given */
#define WALL_ABOUT "coefficient of friction of packed gas on the wall; with `friction` in constant/granularProperties"

struct granular_wall {
    double restitution, mu;
};
OWN_PARAMS_FIT(struct granular_wall);
#define PARAM_STRUCT struct granular_wall
static const struct param granular_param[] = {
    NUMBER("restitution", restitution, REQUIRED, FROM_TO(0, 1), NO_UNIT,
           "of impacts on the wall, which JohnsonJacksonSlip calls restitutionCoefficient; that of two grains is in "
           "grain"),
    NUMBER("muWall", mu, USUALLY(UNSAID, "that of U"), FROM_TO(0, HUGE_VAL), NO_UNIT, WALL_ABOUT),
};
#undef PARAM_STRUCT

static struct granular_wall granular_of(const struct rule *rule) {
    struct granular_wall own;
    memcpy(&own, &rule->params, sizeof own);
    return own;
}

static double granular_friction(const struct rule *rule) {
    return granular_of(rule).mu;
}

static void granular_heat(const struct rule *rule, const struct wall_line *l, double *share) {
    absorbed_shares(granular_of(rule).restitution, l, share);
}

/* The wall with friction of Johnson & Jackson (J. Fluid Mech. 176, 1987, p. 67; docs/physics.md 5.5). At a wall of hard
 * grains n_w m T = p at every density, and p/(m sqrt(2 pi T)) grains hit it per area and time. On average an impact
 * gives the wall the part phi, the specularity, of the grain's momentum along it, which is m s in gas that slips at s
 * on the wall itself:
 *     tau = phi p/sqrt(2 pi T) s,  q = (1 - e^2) p sqrt(T/(2 pi)),
 * with q as above. The wall gets the work tau u_w of its own motion, and q. The rest of what the stress takes off the
 * gas, tau s, stays there as heat, so that with n into the gas
 *     heat dT/dn = q - tau s.
 *
 * Johnson & Jackson estimate how often a grain in a layer on the wall hits it, sqrt(3 T) over a mean distance. For
 * spheres that gives, with A = rho_p alpha g0/alpha_max,
 *     tau = sqrt(3) pi/6 phi A sqrt(T) s,  q = sqrt(3) pi/4 (1 - e^2) A T^(3/2);
 * for disks, whose layer has alpha^(1/2) in place of alpha^(2/3) and which move at sqrt(2 T), it would give
 *     tau = sqrt(2) pi/4 phi A sqrt(T) s,  q = sqrt(2) pi/4 (1 - e^2) A T^(3/2).
 * In dense gas, where p = 4 rho_p alpha^2 g0 T (disks: 2), the factor of phi rho_p alpha g0 sqrt(T) s is 1.60 alpha
 * here (disks: 0.80 alpha) and 0.91/alpha_max there (1.11/alpha_max): close to alpha_max = 0.64 it is 1.02 against
 * 1.42, and 0.65 against 1.35 of disks close to 0.82; their q is twice ours there. In thin gas, where the frequency of
 * impacts is not in doubt, their tau is 3.6 times ours (disks: 3.4). The count of impacts above is exact for elastic
 * grains at all densities, and the same for disks and spheres, so it is taken for both; coefficients that were fitted
 * with their factors are to be scaled. */
struct rough_wall {
    double specularity, restitution, mu;
};
OWN_PARAMS_FIT(struct rough_wall);
#define PARAM_STRUCT struct rough_wall
static const struct param rough_param[] = {
    NUMBER("specularityCoefficient", specularity, REQUIRED, FROM_TO(0, 1), NO_UNIT,
           "mean part of a grain's momentum along the wall that an impact gives to it"),
    NUMBER("restitutionCoefficient", restitution, REQUIRED, FROM_TO(0, 1), NO_UNIT,
           "of impacts on the wall, which granularWall calls restitution; that of two grains is restitution in grain"),
    NUMBER("muWall", mu, USUALLY(UNSAID, "rough: packed gas yields before it slips"), FROM_TO(0, HUGE_VAL), NO_UNIT,
           WALL_ABOUT),
};
#undef PARAM_STRUCT

static struct rough_wall rough_of(const struct rule *rule) {
    struct rough_wall own;
    memcpy(&own, &rule->params, sizeof own);
    return own;
}

/* Computes the share a of the stress tau = a shear u/d. At the wall the gas slips at (1 - a/2) u, with u of the cell,
 * so that a = 2 B/(1 + B), B = phi p/sqrt(2 pi T) d/(2 shear). */
static void rough_drag(const struct rule *rule, const struct wall_line *l, double *share) {
    const double phi = rough_of(rule).specularity;
    double p[BATCH];
    find_pressure(l, p);
    for (int i = 0; i < l->n; i++) {
        const double B = phi * p[i] / sqrt(2 * PI * l->surface[i]) * l->d[i] / (2 * l->shear[i]);
        share[i] = 2 / (1 + 1 / B); /* 0 if B = 0 */
    }
}

static double rough_friction(const struct rule *rule) {
    return rough_of(rule).mu;
}

static void rough_heat(const struct rule *rule, const struct wall_line *l, double *share) {
    absorbed_shares(rough_of(rule).restitution, l, share);
}

static void velocity_given(const struct rule *rule, int components, int face, double out[3]) {
    for (int c = 0; c < components; c++) out[c] = value_of(rule, components, face, c);
}

/* Objects unless U and T have the same coefficients, as one wall has one set, or T is held: e has no use then. */
static const char *rough_objection(const struct patch_rules *r) {
    const struct rule *U = &r->velocity, *T = &r->temperature;
    if (U->type == T->type && !memcmp(&U->params, &T->params, sizeof U->params)) return NULL;
    if (U->type->drag != rough_drag) return "U must be that, too, with the same coefficients";
    return T->type->temperature ? NULL : "T must be that, too, with the same coefficients, or fixedValue";
}

/* ---- walls of packed gas with friction (docs/physics.md 5.9) ---- */

struct rubbing_wall {
    struct moving_wall moving; /* first, as moving_velocity reads it */
    double mu;
};
OWN_PARAMS_FIT(struct rubbing_wall);
#define PARAM_STRUCT struct rubbing_wall
static const struct param rubbing_param[] = {
    VECTOR("U", moving.U, 0, ANY_NUMBER, UNIT(0, 1, -1), "of the wall, along itself"),
    NUMBER("muWall", mu, REQUIRED_AS("muWall 0.3;"), FROM_TO(0, HUGE_VAL), NO_UNIT, WALL_ABOUT),
};
#undef PARAM_STRUCT

static double rubbing_friction(const struct rule *rule) {
    struct rubbing_wall own;
    memcpy(&own, &rule->params, sizeof own);
    return own.mu;
}

/* ---- the table ---- */

#define FIELDS(s, v) .scalar = s, .vector = v
#define SLIPS        FIELDS(true, true), .wall = true, .ghost = flip_normal
#define HOLDS        FIELDS(false, true), .wall = true, .ghost = flip, .drag = half_way
#define VALUES(key)  .value = {key, key}

const struct boundary_type boundary_table[] = {
    {MODEL("slip", "reflecting wall without friction"), SLIPS},
    {MODEL("symmetry", "mirror, as slip"), SLIPS},
    {MODEL("symmetryPlane", "mirror on a plane, as slip"), SLIPS},
    {MODEL("noSlip", "wall at rest that the gas sticks to (without transport: turns the velocity)"), HOLDS},
    {MODEL_WITH("translatingWallVelocity",
                "the same, moving along itself: U (ux uy uz);  or  U table ((t (ux uy uz)) ..);", moving_param),
     HOLDS, .transport = true, .velocity = moving_velocity},
    {MODEL("rotatingWallVelocity",
           "the same, rotating along itself: origin, axis, omega (rad/s), a constant, table ((t v) ..) or \"..\" of t"),
     HOLDS, .value = {NULL, "omega"}, .giving = BY_ROTATION, .transport = true, .velocity = velocity_given},
    {MODEL_WITH("frictionalSlip",
                "wall that gas slips along, and packed gas rubs on: muWall, and U of a wall that moves along itself",
                rubbing_param),
     FIELDS(false, true), .wall = true, .ghost = flip_normal, .velocity = moving_velocity,
     .friction = rubbing_friction},
    {MODEL_WITH("granularWall",
                "wall that takes what impacts lose: restitution e; 0 to 1 (OpenFOAM's tools want a value, too)",
                granular_param),
     FIELDS(true, false), .transport = true, .ghost = copy, .heat = granular_heat, .friction = granular_friction},
    {MODEL_WITH("JohnsonJacksonSlip",
                "wall with friction: specularityCoefficient and restitutionCoefficient, 0 to 1, in U and in T alike",
                rough_param),
     FIELDS(true, true), .value = {NULL, "value"}, .wall = true, .transport = true, .ghost = flip_normal,
     .velocity = velocity_given, .drag = rough_drag, .heat = rough_heat, .friction = rough_friction,
     .objection = rough_objection},
    {MODEL("zeroGradient", "in- or outflow of the cell's own state"), FIELDS(true, true), .ghost = copy},
    {MODEL("fixedValue", "given value"), FIELDS(true, true), VALUES("value"), .ghost = fixed, .heat = half_way,
     .temperature = temperature_given},
    {MODEL("uniformFixedValue", "given value, a constant or  table ((t v) ..)  in time"), FIELDS(true, true),
     VALUES("uniformValue"), .giving = BY_FUNCTION, .ghost = fixed, .heat = half_way, .temperature = temperature_given},
    {MODEL("exprFixedValue", "given value, \"..\" of pos().x(), pos().y(), pos().z(), time(); of U  vector(a, b, c)"),
     FIELDS(true, true), VALUES("valueExpr"), .giving = BY_EXPRESSION, .ghost = fixed, .heat = half_way,
     .temperature = temperature_given},
    {MODEL("inletOutlet", "zeroGradient outwards, given value inwards"), FIELDS(true, true), VALUES("inletValue"),
     .ghost = inlet_outlet},
    {MODEL("uniformInletOutlet", "the same, a constant or  table ((t v) ..)  in time"), FIELDS(true, true),
     VALUES("uniformInletValue"), .giving = BY_FUNCTION, .ghost = inlet_outlet},
    {MODEL("flowRateInletVelocity",
           "mass (or volumetricFlowRate) that flows in, a constant or  table ((t v) ..)  in time"),
     FIELDS(false, true), .value = {NULL, "massFlowRate"}, .giving = BY_RATE, .ghost = fed},
};
const struct boundary_type *const boundary_mirror = &boundary_table[0];
const int boundary_count = sizeof boundary_table / sizeof *boundary_table;

const struct boundary_type *boundary_find(const char *name) {
    return model_find(boundary_table, sizeof *boundary_table, boundary_count, name);
}

bool boundary_is_wall(const struct boundary_type *t) {
    return t && t->wall;
}

bool boundary_is_smooth(const struct boundary_type *t) {
    return t && t->wall && !t->drag && !t->friction;
}

bool boundary_rotates(const struct boundary_type *t) {
    return t && t->velocity && (t->friction || t->giving == BY_ROTATION);
}

bool boundary_takes(const struct boundary_type *t, int components) {
    return t && (components == 3 ? t->vector : t->scalar);
}

const char *boundary_value(const struct boundary_type *t, int components) {
    return t ? t->value[components == 3] : NULL;
}

bool boundary_gives(const struct boundary_type *t) {
    return t && (t->model.nparam > 0 || t->value[0] || t->value[1]);
}

/* ---- rules ---- */

bool rule_holds(const struct rule *rule) {
    const struct boundary_type *t = rule->type;
    return !t->wall && (t->value[0] || t->value[1]); /* the values of a wall are its velocity */
}

bool rule_switches(const struct rule *rule) {
    return rule->type->ghost == inlet_outlet;
}

bool patch_is_wall(const struct patch_rules *r) {
    return r->velocity.type->wall;
}

bool patch_feeds(const struct patch_rules *r) {
    return r->velocity.type && (r->velocity.type->ghost == fed || r->velocity.shuts);
}

double patch_feed(const struct patch_rules *r, int components, int face, int axis) {
    return value_of(&r->velocity, components, face, axis);
}

/* Does the velocity u that is given at a face let nothing through? */
static bool shuts_face(const struct patch_rules *r, int components, const double *u, double through) {
    bool still = true;
    for (int c = 0; c < components; c++) still &= u[c] == 0;
    return still || (!patch_gives_outside(r) && leads_along(components, u, through));
}

void patch_feed_mass(const struct patch_rules *r, int components, int n, const int *face, const double *into,
                     const double *rho, double *flux) {
    const struct rule *u = &r->velocity;
    for (int i = 0; i < n; i++)
        if (!u->shuts)
            flux[i] = u->volume ? rho[i] * into[i] : into[i];
        else if (shuts_face(r, components, u->values ? u->values + (long)face[i] * components : u->uniform, into[i]))
            flux[i] = 0;
}

bool rule_fixes(const struct rule *rule) {
    return rule->type && rule->type->ghost == fixed;
}

bool patch_gives_outside(const struct patch_rules *r) {
    return rule_fixes(&r->velocity) && rule_holds(&r->density) && rule_holds(&r->temperature);
}

bool leads_along(int components, const double *u, double through) {
    double square = 0;
    for (int c = 0; c < components; c++) square += u[c] * u[c];
    return fabs(through) <= 1e-6 * sqrt(square); /* 1e-6: of normals that come from coordinates with few digits */
}

bool patch_needs_values(const struct patch_rules *r) {
    if (patch_is_wall(r)) return false; /* the temperature of a wall is felt by conduction only */
    return rule_holds(&r->density) || rule_holds(&r->velocity) || rule_holds(&r->temperature);
}

bool wall_drags(const struct patch_rules *r) {
    return patch_is_wall(r) && r->velocity.type->drag;
}

bool wall_holds(const struct patch_rules *r) {
    return patch_is_wall(r) && r->velocity.type->drag == half_way;
}

bool wall_slides(const struct patch_rules *r) {
    return wall_drags(r) && !wall_holds(r);
}

bool wall_works(const struct patch_rules *r) {
    return wall_slides(r) || (wall_drags(r) && r->velocity.type->velocity);
}

bool wall_conducts(const struct patch_rules *r) {
    return patch_is_wall(r) && r->temperature.type->heat;
}

void wall_velocity(const struct patch_rules *r, int components, int face, double out[3]) {
    for (int c = 0; c < components; c++) out[c] = 0;
    if (r->velocity.type->velocity) r->velocity.type->velocity(&r->velocity, components, face, out);
}

double wall_temperature(const struct patch_rules *r, int face) {
    const struct rule *rule = &r->temperature;
    return rule->type->temperature ? rule->type->temperature(rule, face) : 0;
}

static double said_friction(const struct rule *rule) {
    return rule->type && rule->type->friction ? rule->type->friction(rule) : UNSAID;
}

bool rule_rubs(const struct rule *rule) {
    return said_friction(rule) >= 0;
}

double wall_friction(const struct patch_rules *r) {
    const double by_velocity = said_friction(&r->velocity), by_temperature = said_friction(&r->temperature);
    return by_velocity >= 0 ? by_velocity : by_temperature >= 0 ? by_temperature : wall_drags(r) ? HUGE_VAL : 0;
}

static void find_share(void (*share_of)(const struct rule *, const struct wall_line *, double *), bool any,
                       const struct rule *rule, const struct wall_line *l, double *share) {
    for (int i = 0; i < l->n; i++) share[i] = 0;
    if (any && share_of) share_of(rule, l, share);
}

/* rho has a gradient at a wall that conducts (docs/physics.md 5.6), as dp/dn = rho push there with n towards the wall:
 *     d rho/dn = (rho push - p_T dT/dn)/p_rho.
 * Hence the heat flux -heat dT/dn - cross d rho/dn towards the wall is
 *     -through dT/dn - Q,  through = heat - cross p_T/p_rho,  Q = cross rho push/p_rho,
 * and Q acts on the wall as if the cell were colder by Q d/(2 through), by T/2 at most: where d is too large for a
 * linear gradient, with rho push d beyond p, the wall would seem colder than 0. `through` stays above a tenth of heat,
 * which only the most inelastic grains near packing ask for. A wall that does not conduct takes no heat, whatever its
 * parts are. */
static void follow_pressure(struct wall_line *l, double per_jump[BATCH], double still[BATCH]) {
    double eps[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < l->n; i++) eps[i] = eps_of(l->material, l->T[i]);
    l->eos->state(l->material, l->n, l->rho, eps, p, c2, gruneisen);
    for (int i = 0; i < l->n; i++) {
        const double p_rho = c2[i] - p[i] * gruneisen[i] / l->rho[i];
        per_jump[i] = -p[i] / (l->T[i] * p_rho);
        still[i] = l->rho[i] * l->push[i] / p_rho;
        l->through[i] = larger(l->heat[i] + l->cross[i] * per_jump[i], 0.1 * l->heat[i]);
        const double most = l->through[i] * l->T[i] / l->d[i];
        l->fed[i] = smaller(larger(l->cross[i] * still[i], -most), most);
        l->warmth[i] = -l->fed[i] * l->d[i] / (2 * l->through[i]);
    }
}

/* A wall of the share a of drag has the stress tau = a shear s/d, with s the velocity of the cell's gas relative to the
 * wall. The gas on the wall itself slips at (1 - a/2) s, and friction makes the heat Q = tau (1 - a/2) s there. The
 * heat goes both ways, into the wall and through d/2 into the cell: it acts on the wall as if the cell had
 * T + Q d/(2 heat) instead of T, and a wall of the share b of heat takes b/2 of Q. So the gas on the wall has
 *     T_s = (1 - b/2) (T + Q d/(2 heat)) + b/2 T_w.
 * The smaller d is, the less a depends on T_s, so that each round from T_s = T on gains an order of d. */
void wall_shares(const struct patch_rules *r, struct wall_line *l, double *drag, double *heat) {
    enum { ROUNDS = 3 };
    const bool slides = wall_slides(r), follows = l->cross && wall_conducts(r);
    double per_jump[BATCH] = {0}, still[BATCH] = {0}, cooler[BATCH];
    for (int i = 0; i < l->n; i++) {
        l->surface[i] = l->T[i];
        l->through[i] = l->heat[i];
        l->warmth[i] = l->fed[i] = l->denser[i] = 0;
    }
    if (follows) follow_pressure(l, per_jump, still);
    memcpy(cooler, l->warmth, sizeof cooler);
    for (int round = 0; round < (slides ? ROUNDS : 1); round++) {
        find_share(r->velocity.type->drag, wall_drags(r), &r->velocity, l, drag);
        for (int i = 0; i < l->n && slides; i++)
            l->warmth[i] = cooler[i] + drag[i] * (1 - 0.5 * drag[i]) * l->shear[i] * l->slip[i] / (2 * l->through[i]);
        find_share(r->temperature.type->heat, wall_conducts(r), &r->temperature, l, heat);
        for (int i = 0; i < l->n; i++)
            l->surface[i] =
                larger((1 - 0.5 * heat[i]) * (l->T[i] + l->warmth[i]) + 0.5 * heat[i] * wall_temperature(r, l->face[i]),
                       COLDEST);
    }
    for (int i = 0; i < l->n; i++) {
        l->lift[i] = (2 - heat[i]) * l->warmth[i];
        l->stays[i] = 1 - 0.5 * heat[i];
    }
    for (int i = 0; i < l->n && follows; i++) {
        l->denser[i] = 2 * per_jump[i] * (l->surface[i] - l->T[i]) + still[i] * l->d[i];
        l->fed[i] *= 0.5 * heat[i];
    }
    if (!follows || r->temperature.type->temperature) return;
    /* a wall that takes heat in proportion to T takes less by `fed`, in proportion to T, too, and never gives any */
    for (int i = 0; i < l->n; i++) {
        l->lift[i] += heat[i] * cooler[i];
        heat[i] *= 1 + cooler[i] / l->T[i];
        l->fed[i] = 0;
    }
}
