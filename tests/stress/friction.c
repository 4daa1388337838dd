/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packed gas with friction (docs/physics.md 9.3) on lattices and on polyhedra: layers on slopes, columns, heaps, drops,
 * layers that are sheared, drained and shaken, and patches of packed gas in a void. */
#include "tests/stress/problem.h"

#include "tests/defaults.h"

enum scene { LAYER, COLUMN, HEAP, DROP, SHEAR, DRAIN, SHAKEN, PATCHES, SCENES };
static int scene_of(const struct problem *p) {
    return (int)(p->seed % SCENES);
}

static void friction_box(struct problem *p, struct seed *s) {
    static const int dims[6] = {1, 2, 2, 2, 3, 3};
    p->material.disks = seed_below(s, 4) == 0;
    const int dim = dims[seed_below(s, p->material.disks ? 4 : 6)], boxes = seed_below(s, 3);
    const bool cells = seed_below(s, 2), beyond = seed_below(s, 4) == 0;
    p->dim = dim;
    p->polyhedral = dim > 1 && cells;
    p->shape = dim == 2 ? (boxes ? TRIANGLES : QUADS) : boxes ? TETS : HEXES;
    p->noise = seed_uniform(s, 0, dim == 2 ? 0.3 : 0.15);
    if (beyond && dim < (p->material.disks ? 2 : 3)) p->components = dim + 1;
    p->cells = 1;
    for (int k = 0; k < 3; k++) {
        const int n = dim == 1 ? 12 + seed_below(s, 29) : dim == 2 ? 8 + seed_below(s, 9) : 4 + seed_below(s, 3);
        const int coarse = dim == 2 ? 7 + seed_below(s, 5) : 3 + seed_below(s, 2);
        p->n[k] = k >= dim ? 1 : p->polyhedral ? coarse : n;
        p->cells *= p->n[k];
        p->direction[k] = k == 0;
    }
}

static void friction_material(struct problem *p, struct seed *s) {
    inelastic_material(p, s);
    const double e = seed_uniform(s, 0.5, 1);
    const int kind = seed_below(s, 8), law = seed_below(s, 4);
    if (!p->eos->bounded || p->eos == eos_find("GoldshteinShapiro")) {
        p->eos = eos_find(seed_below(s, 3) ? "GoldshteinShapiro" : "VescoviSpheres");
        p->material.tangent = false;
        model_defaults(&p->eos->model, &p->material);
        if (p->eos->packing && p->material.alpha_max == 0)
            p->material.alpha_max = p->eos->packing(p->material.friction);
        p->densest = (1 - seed_power(s, -4, -0.5)) * p->material.alpha_max;
    }
    p->material.restitution = kind == 0 ? 1 : e;
    p->source.cooling = p->material.restitution == 1 || law == 0 ? NULL : cooling_find(law < 3 ? "Haff" : "GarzoDufty");
}

/* Half of the problems have the usual parameters but for the angle; in the others they lie anywhere in their ranges. */
static void friction_law(struct problem *p, struct seed *s) {
    struct own_params own;
    const struct friction *f = p->friction = friction_find(seed_below(s, 2) ? "Coulomb" : "muI");
    const bool usual = seed_below(s, 2), rate = f == friction_find("muI");
    const double mu = seed_uniform(s, 0, 1), angle = seed_uniform(s, 0, 40), more = seed_uniform(s, 0, 1),
                 I0 = seed_power(s, -3, 0), low = seed_uniform(s, 0.1, 0.95), full = seed_uniform(s, low, 1),
                 modulus = seed_power(s, 0, 4), sticks = p->p0 * seed_power(s, -4, 0), surface = seed_power(s, -1, 1),
                 heating = seed_uniform(s, -0.3, 1.3);
    own = own_defaults(&f->model);
    if (seed_below(s, 2))
        model_put(&f->model, &own, "frictionAngle", angle);
    else
        model_put(&f->model, &own, "muStatic", mu);
    struct friction_params given = friction_params(&own, &p->material);
    if (rate) model_put(&f->model, &own, "muDynamic", given.mu_static + more);
    if (seed_below(s, 2)) model_put(&f->model, &own, "frictionalHeating", smaller(larger(heating, 0), 1));
    if (!usual) {
        if (rate) model_put(&f->model, &own, "I0", I0);
        model_put(&f->model, &own, "alphaFriction", low * p->material.alpha_max);
        model_put(&f->model, &own, "alphaSolid", larger(full, low + 0.01) * p->material.alpha_max);
        model_put(&f->model, &own, "shearModulus", modulus);
        if (seed_below(s, 3) == 0) model_put(&f->model, &own, "cohesion", sticks);
        model_put(&f->model, &own, "surfaceCohesion", seed_below(s, 2) ? surface : 0);
    }
    p->friction_params = friction_params(&own, &p->material);
}

static void friction_acoustics(struct problem *p, struct seed *s) {
    const struct acoustics *a = p->acoustics = acoustics_find(seed_below(s, 3) ? "implicit" : "automatic");
    const bool usual = seed_below(s, 3) > 0;
    const double dense = seed_uniform(s, 0.3, 0.99), thin = seed_power(s, -5, 0), gain = seed_power(s, 0, 2),
                 governor = seed_power(s, -1, 2), soft = seed_uniform(s, 0.001, 0.999), keep = seed_uniform(s, 0, 1);
    p->acoustics_params = own_defaults(&a->model);
    if (usual) return;
    model_put(&a->model, &p->acoustics_params, "dense", dense);
    model_put(&a->model, &p->acoustics_params, "thin", thin);
    model_put(&a->model, &p->acoustics_params, "gain", gain);
    model_put(&a->model, &p->acoustics_params, "governor", governor);
    model_put(&a->model, &p->acoustics_params, "soft", soft);
    model_put(&a->model, &p->acoustics_params, "keep", keep);
}

/* Walls of every kind that friction knows; some move along themselves. `granularWall` and `JohnsonJacksonSlip` need
 * transport. */
static void friction_walls(struct problem *p, struct seed *s, double fall) {
    static const char *const kinds[] = {"slip", "noSlip", "frictionalSlip", "translatingWallVelocity",
                                        "JohnsonJacksonSlip"};
    for (int i = 0; i < 6; i++) {
        struct wall *w = &p->wall[i];
        const int kind = seed_below(s, p->transport ? 5 : 3), heat = seed_below(s, 2);
        const bool moves = seed_below(s, 3) == 0 && (p->dim > 1 || p->components > 1) && kind != 1;
        const double mu = seed_uniform(s, -0.3, 1), speed = fall * seed_power(s, -1.5, 0.5), sign = seed_sign(s),
                     e = seed_uniform(s, 0, 1), phi = seed_uniform(s, 0, 1);
        *w =
            (struct wall){.velocity = kinds[kind], .temperature = "zeroGradient", .specularity = phi, .restitution = e};
        w->mu = mu >= 0 || kind == 2 ? larger(mu, 0) : -1; /* else rough */
        if (moves && kind > 1) w->along = sign * speed;
        if (kind == 4)
            w->temperature = kinds[kind];
        else if (p->transport && heat)
            w->temperature = "granularWall", w->value = e;
    }
}

/* A bed of p0 at its bottom, under thin gas; returns the gravity that it carries. Half of the beds are cold. */
static double friction_bed(struct problem *p, struct seed *s) {
    const double flat = seed_uniform(s, 0.3, 0.99), gap = seed_power(s, -4, -0.5), thin = seed_power(s, -7, -1),
                 above = seed_power(s, -6, 0), cold = seed_power(s, -4, 0);
    const bool loose = seed_below(s, 2);
    p->size = seed_uniform(s, 0.2, 0.8);
    p->wave[1][1] = seed_below(s, 2) ? 1 : cold; /* pressure over that which carries the bed */
    return bed_lay(p, loose ? flat : 1 - gap, thin, above);
}

static void friction_scene(struct problem *p, struct seed *s, double pull) {
    const double fall = sqrt(2 * pull * p->size), fast = seed_power(s, -2, 0.7), falls = seed_power(s, -0.7, 0.7),
                 slow = seed_power(s, -3, -0.3);
    const int scene = scene_of(p), last = larger(p->components, p->dim) - 1;
    p->source.gravity[0] = -pull;
    for (int k = 1; k <= last; k++) {
        const double slope = seed_uniform(s, -0.85, 0.85); /* tan 40 degrees */
        p->source.gravity[k] = scene == LAYER || k >= p->dim || seed_below(s, 3) == 0 ? slope * pull : 0;
    }
    p->wave[1][0] = seed_below(s, 3) ? fast * fall : 0;
    p->wave[1][2] = seed_uniform(s, 0.1, 0.6); /* width */
    for (int k = 0; k < 3; k++) p->centre[k] = seed_uniform(s, 0.3, 0.7);
    p->material.threshold = seed_chance(s, 0.7) ? slow * fall : 0;
    if (scene == SHAKEN) bed_shake(p, s, pull);
    p->walls_along = true;
    p->edge = seed_below(s, 2) ? CLOSED : PERIODIC;
    friction_walls(p, s, fall);
    if (scene == DRAIN) bed_drain(p, s, false);
    for (int i = 0; i < 6; i++) p->gate[i].T *= 1e-3;
    p->end = falls * sqrt(2 * p->size / pull);
}

void friction_draw(struct problem *p, struct seed *s) {
    friction_box(p, s);
    friction_material(p, s);
    if (seed_chance(s, 0.4)) {
        const int components = p->components;
        inelastic_transport(p, s);
        p->components = components;
    }
    friction_law(p, s);
    const double pull = friction_bed(p, s);
    friction_scene(p, s, pull);
    friction_acoustics(p, s);
    p->pattern = scene_of(p) == PATCHES ? 1 + seed_below(s, 4) : 1;
    p->patience = 8;
    p->steps = 20;
    p->stated = true;
}

/* Does the bed of a scene fill a place? */
static bool is_packed(const struct problem *p, const double x[3]) {
    bool inside = x[0] < p->size;
    switch (scene_of(p)) {
    case COLUMN:
        for (int k = 1; k < p->dim; k++) inside &= x[k] < p->wave[1][2];
        break;
    case HEAP:
        for (int k = 1; k < p->dim; k++) inside &= x[0] < p->size * (1 - fabs(x[k] - 0.5) / p->wave[1][2]);
        break;
    case DROP:
        inside = true;
        for (int k = 0; k < p->dim; k++) inside &= fabs(x[k] - p->centre[k]) < 0.5 * p->size;
    default:
        break;
    }
    return inside;
}

/* The state of a patch is drawn from a stream of its own: cells may ask in any order. */
static void patch_at(const struct problem *p, int tile, struct point *out) {
    struct seed s = seed_start(100 + p->family, p->seed * 65537 + (uint64_t)tile);
    const bool packed = seed_below(&s, 2);
    const int components = (int)larger(p->components, p->dim);
    *out = p->side[!packed];
    out->p *= p->wave[1][1] * seed_power(&s, -1, 0);
    for (int k = 0; k < components; k++) out->u[k] = p->wave[1][0] * seed_uniform(&s, -1, 1);
}

void friction_at(const struct problem *p, const struct place *where, struct point *out) {
    const double *x = where->x, speed = p->wave[1][0];
    const int scene = scene_of(p), components = (int)larger(p->components, p->dim);
    if (scene == PATCHES) {
        patch_at(p, where->tile, out);
        return;
    }
    const bool bed = is_packed(p, x);
    *out = p->side[!bed];
    if (!bed) return;
    out->p = p->wave[1][1] * (scene == DROP ? p->p0 : p->side[1].p + larger(1 - x[0] / p->size, 0) * p->p0);
    if (scene == DROP) out->u[0] = -speed;
    for (int k = 1; k < components; k++) {
        if (scene == SHEAR) out->u[k] = speed * (k == 1 ? 1 : -0.5) * (x[0] - 0.5);
        if (scene == LAYER || scene == DRAIN) out->u[k] = speed * x[0];
    }
}
