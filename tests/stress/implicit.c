/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dense gas with implicit acoustics (libcore/acoustics/bed.h) on lattices and on polyhedra: beds at rest, falling, hit,
 * sheared, drained, cooled to collapse, and shaken, of every equation of state that has a packing limit. */
#include "tests/stress/problem.h"

#include "tests/defaults.h"

enum scene { REST, BLOCK, HIT, SHEAR, DRAIN, COLLAPSE, SHAKEN, SCENES };
static int scene_of(const struct problem *p) {
    return (int)(p->seed % SCENES);
}

static void implicit_box(struct problem *p, struct seed *s) {
    static const int dims[6] = {1, 1, 2, 2, 2, 3};
    p->material.disks = seed_below(s, 3) == 0;
    const int dim = dims[seed_below(s, p->material.disks ? 5 : 6)];
    p->dim = dim;
    p->polyhedral = false;
    p->cells = 1;
    for (int k = 0; k < 3; k++) {
        const int n = dim == 1 ? 20 + seed_below(s, 41) : dim == 2 ? 8 + seed_below(s, 13) : 4 + seed_below(s, 4);
        p->n[k] = k < dim ? n : 1;
        p->cells *= p->n[k];
        p->direction[k] = k == 0;
    }
}

/* Triangles or quads, tetrahedra or hexahedra, perturbed. */
static void implicit_cells(struct problem *p, struct seed *s) {
    const bool simplices = seed_below(s, 4) > 0, disks = p->material.disks;
    p->dim = disks || seed_below(s, 4) ? 2 : 3;
    p->polyhedral = true;
    p->shape = p->dim == 2 ? (simplices ? TRIANGLES : QUADS) : simplices ? TETS : HEXES;
    p->noise = seed_uniform(s, 0, p->dim == 2 ? 0.3 : 0.15);
    p->cells = 1;
    for (int k = 0; k < 3; k++) {
        const int n = p->dim == 2 ? 9 + seed_below(s, 4) : 4;
        p->n[k] = k < p->dim ? n : 1;
        p->cells *= p->n[k];
    }
}

/* Any row with a packing limit, with a tangent or without; e from 0 to 1, Haff's or Garzo & Dufty's law or none. */
static void implicit_material(struct problem *p, struct seed *s) {
    inelastic_material(p, s);
    const double e = seed_uniform(s, 0, 1), gap = seed_power(s, -5, -0.5);
    const int kind = seed_below(s, 12);
    if (!p->eos->bounded) {
        p->eos = eos_find("GoldshteinShapiro");
        model_defaults(&p->eos->model, &p->material);
        p->material.tangent = false; /* of other rows: that one diverges */
        p->densest = (1 - gap) * p->material.alpha_max;
    }
    p->material.restitution = kind == 0 ? 1 : kind == 1 ? 0 : e;
    const bool haff = seed_below(s, 2);
    p->source.cooling = p->material.restitution == 1 || kind == 2 ? NULL : cooling_find(haff ? "Haff" : "GarzoDufty");
}

/* The parameters, anywhere in their ranges, but mostly near what is usual. One problem in three has the row
 * `automatic`, drawn from a stream of its own, as problems are known by their seeds; there impacts are elastic up to a
 * speed at which many beds rest. */
static void implicit_acoustics(struct problem *p, struct seed *s, double pull) {
    struct seed own = seed_start(200 + p->family, p->seed);
    const bool automatic = seed_below(&own, 3) == 0;
    const struct acoustics *a = p->acoustics = acoustics_find(automatic ? "automatic" : "implicit");
    if (automatic) p->material.threshold = seed_power(&own, -1.5, 0) * sqrt(2 * pull * p->size);
    const bool usual = seed_chance(s, 0.3);
    const double dense = seed_uniform(s, 0.05, 0.99), gap = seed_power(s, -4, -0.5), thin = seed_power(s, -5, 0),
                 gain = seed_power(s, 0, 2), governor = seed_power(s, -2, 2), soft = seed_uniform(s, 0.001, 0.999),
                 keep = seed_uniform(s, -0.2, 1.2);
    p->acoustics_params = own_defaults(&a->model);
    if (usual) return;
    model_put(&a->model, &p->acoustics_params, "dense", seed_below(s, 3) ? dense : 1 - gap);
    model_put(&a->model, &p->acoustics_params, "thin", seed_chance(s, 0.3) ? 0 : thin);
    model_put(&a->model, &p->acoustics_params, "gain", seed_chance(s, 0.2) ? 1 : gain);
    model_put(&a->model, &p->acoustics_params, "governor", governor);
    model_put(&a->model, &p->acoustics_params, "soft", soft);
    model_put(&a->model, &p->acoustics_params, "keep", smaller(larger(keep, 0), 1));
}

double bed_lay(struct problem *p, double dense, double thin, double above) {
    const double alpha = dense * smaller(p->densest, p->material.alpha_max);
    p->side[0] = (struct point){.alpha = alpha, .p = p->p0};
    p->side[1] = (struct point){.alpha = larger(thin * alpha, 1.01 * p->alpha_floor), .p = above * p->p0};
    return p->p0 / (problem_density(p, alpha) * p->size);
}

/* A bed of p0 at its bottom, under thin gas; pull: the gravity that it carries. */
static double implicit_bed(struct problem *p, struct seed *s) {
    const double flat = seed_uniform(s, 0.3, 0.99), gap = seed_power(s, -4, -0.5), thin = seed_power(s, -7, -1),
                 above = seed_power(s, -4, 0);
    const bool loose = seed_below(s, 2);
    p->size = seed_uniform(s, 0.15, 0.8); /* depth, or size of a block */
    return bed_lay(p, loose ? flat : 1 - gap, thin, above);
}

void bed_drain(struct problem *p, struct seed *s, bool pressures) {
    static const char *const kinds[] = {"zeroGradient", "inletOutlet", "fixedValue"};
    const int hole = p->dim > 1 ? seed_below(s, 2 * p->dim) : 0;
    p->edge = OPEN_ENDED;
    p->walls_along = false;
    for (int i = 0; i < 6; i++) {
        struct gate *g = &p->gate[i];
        const int kind = seed_below(s, 3);
        *g = (struct gate){.density = kinds[kind], .velocity = "zeroGradient", .temperature = kinds[kind]};
        g->rho = problem_density(p, p->side[1].alpha);
        g->pressure = pressures && seed_below(s, 2);
        g->shut = i != hole;
        g->T = g->pressure ? p->side[1].p : grains_T(p);
    }
}

void bed_shake(struct problem *p, struct seed *s, double pull) {
    p->source.amplitude = seed_uniform(s, 0.5, 6);
    p->source.frequency = seed_power(s, -0.5, 1.5) * sqrt(pull);
    p->source.phase = seed_uniform(s, 0, 6);
}

/* Rest, block, hit and shaken: how fast what moves does, as a part of the speed of the fall through the depth. */
static void implicit_scene(struct problem *p, struct seed *s, double pull) {
    const double fall = sqrt(2 * pull * p->size), fast = seed_power(s, -2, 1), slow = seed_power(s, -3, -0.3),
                 off = seed_power(s, -4, 1), falls = seed_power(s, -0.5, 1), tilt = seed_uniform(s, -0.3, 0.3);
    const int scene = scene_of(p);
    p->source.gravity[0] = scene == COLLAPSE && seed_below(s, 2) ? 0 : -pull;
    if (p->dim > 1 && seed_chance(s, 0.3)) p->source.gravity[1] = pull * tilt;
    p->wave[1][0] = fast * fall;
    p->wave[1][1] = seed_chance(s, 0.5) ? 1 : off; /* pressure over that which carries the bed */
    for (int k = 0; k < 3; k++) p->centre[k] = seed_uniform(s, 0.3, 0.7);
    const bool still = seed_chance(s, scene == COLLAPSE ? 0.2 : 0.6);
    p->material.threshold = still ? slow * fall : 0;
    if (scene == SHAKEN) bed_shake(p, s, pull);
    p->walls_along = true;
    p->edge = seed_below(s, 2) ? CLOSED : PERIODIC;
    if (scene == DRAIN) bed_drain(p, s, true);
    p->end = falls * sqrt(2 * p->size / pull);
}

static void draw(struct problem *p, struct seed *s, bool cells) {
    implicit_box(p, s);
    if (cells) implicit_cells(p, s);
    implicit_material(p, s);
    if (seed_chance(s, 0.3)) {
        p->material.restitution = larger(p->material.restitution, 0.2);
        inelastic_transport(p, s);
    }
    inelastic_walls(p, s);
    const double pull = implicit_bed(p, s);
    for (int v = 0; v < MAX_VAR; v++)
        for (int i = 0; i < 6; i++) p->wave[v][i] = seed_uniform(s, 0, 1);
    implicit_scene(p, s, pull);
    implicit_acoustics(p, s, pull);
    p->patience = 60;
    p->stated = true;
}

void implicit_draw(struct problem *p, struct seed *s) {
    draw(p, s, false);
}

void implicit_cells_draw(struct problem *p, struct seed *s) {
    draw(p, s, true);
}

/* A ripple of period 1 between -1 and 1. */
static double wave(double x) {
    const double f = x - floor(x);
    return f < 0.5 ? 16 * f * (0.5 - f) : -16 * (f - 0.5) * (1 - f);
}

static bool in_block(const struct problem *p, const double x[3]) {
    bool inside = true;
    for (int k = 0; k < p->dim; k++) inside &= fabs(x[k] - p->centre[k]) < 0.5 * p->size;
    return inside;
}

void implicit_at(const struct problem *p, const struct place *where, struct point *out) {
    const double *x = where->x, under = 1 - x[0] / p->size, speed = p->wave[1][0]; /* under: share that lies above */
    const int scene = scene_of(p), across = p->dim - 1;
    const bool bed = scene == BLOCK ? in_block(p, x) : scene == COLLAPSE || under > 0;
    *out = p->side[!bed];
    if (bed && scene != BLOCK && scene != COLLAPSE) out->p = p->side[1].p + p->wave[1][1] * under * p->side[0].p;
    if (scene == BLOCK || scene == COLLAPSE) out->p *= p->wave[1][1];
    if (scene == BLOCK && bed) out->u[0] = -speed;
    if (scene == HIT && x[0] > p->size && x[0] < p->size + 0.2 && (across == 0 || fabs(x[1] - 0.5) < 0.25)) {
        *out = p->side[0];
        out->u[0] = -speed;
    }
    for (int k = 1; k <= across && scene == SHEAR; k++) out->u[k] = speed * (k == 1 ? 1 : -0.5) * (x[0] - 0.5);
    if (scene != COLLAPSE) return;
    for (int k = 0; k < p->dim; k++) out->u[k] = speed * wave(x[k] + p->wave[2][k]);
    out->alpha *= 1 - 0.3 * (1 + wave(x[0] + p->wave[2][3])) / 2;
}
