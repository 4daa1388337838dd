/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Families of gases with viscosity and heat conduction, T over six decades, in one cell or between bed and gas: disks
 * by Jenkins & Richman, disks and spheres by Garzo & Dufty. */
#include "tests/stress/problem.h"

#include "tests/defaults.h"

enum { TILES, BED, HALVES };

double grains_T(const struct problem *p) {
    return p->p0 / problem_density(p, 0.1);
}

static struct point grains_point(const struct problem *p, struct seed *s, double thinnest, double densest, double low,
                                 double high) {
    struct point q = {.alpha = larger(seed_power(s, thinnest, densest), 1.01 * p->alpha_floor)};
    q.alpha = smaller(q.alpha, p->densest);
    double unit, c2, T = grains_T(p) * seed_power(s, low, high), mach = p->size * seed_uniform(s, -1, 1);
    problem_per_energy(p, q.alpha, &unit, &c2);
    q.p = unit * T / (p->material.gamma - 1);
    for (int k = 0; k < p->dim; k++) q.u[k] = mach * problem_sound(p, q.alpha, q.p) * seed_uniform(s, -1, 1);
    return q;
}

void grains_scene(struct problem *p, struct seed *s) {
    p->pattern = seed_below(s, 3);
    p->size = seed_power(s, -2, 1); /* Mach number */
    const double pull = grains_T(p) * seed_power(s, -2, 2);
    p->wave[0][0] = seed_uniform(s, 0.1, 0.7);
    if (p->pattern == BED || seed_chance(s, 0.3)) {
        p->source.gravity[0] = -pull;
        p->source.amplitude = seed_chance(s, 0.8) ? seed_uniform(s, 0, 10) : 0;
        p->source.frequency = seed_power(s, -1, 2) * sqrt(pull);
        p->walls_along = true;
    }
    if (p->pattern == BED) {
        for (int k = 0; k < 3; k++) p->direction[k] = k == 0;
        p->side[0] = grains_point(p, s, -0.5, -0.05, -3, 0);
        p->side[1] = grains_point(p, s, -7, -2, 0, 3);
    }
    if (p->pattern == HALVES) {
        p->side[0] = grains_point(p, s, -0.3, -0.05, -3, -1);
        p->side[1] = grains_point(p, s, -3, -0.3, 1, 3);
    }
    p->wave[0][1] = p->pattern;
    p->pattern = 1 + seed_below(s, 4);
    p->duration *= 0.5;
}

void grains_at(const struct problem *p, const struct place *where, struct point *out) {
    struct seed s = seed_start(100 + p->family, p->seed * 65537 + (uint64_t)where->tile);
    if (p->wave[0][1] != TILES)
        *out = p->side[where->along >= p->wave[0][0]];
    else if (seed_below(&s, 2))
        *out = grains_point(p, &s, -7, -2, -3, 3);
    else
        *out = grains_point(p, &s, -1, -0.05, -3, 3);
}

/* ---- disks by Jenkins & Richman */

static void disks_walls(struct problem *p, struct seed *s) {
    static const char *const velocity[] = {"slip", "noSlip", "translatingWallVelocity"};
    static const char *const temperature[] = {"zeroGradient", "fixedValue", "granularWall"};
    const double T = grains_T(p);
    for (int i = 0; i < 6; i++) {
        struct wall *w = &p->wall[i];
        int kind = seed_below(s, 3), heat = seed_below(s, 3);
        double speed = sqrt(T) * seed_power(s, -1, 1.5), hot = T * seed_power(s, -4, 3), e = seed_uniform(s, -0.2, 1.2);
        w->velocity = velocity[p->dim > 1 ? kind : kind % 2];
        w->temperature = temperature[heat];
        w->along = kind == 2 ? seed_sign(s) * speed : 0;
        w->value = heat == 2 ? smaller(larger(e, 0), 1) : hot;
    }
}

static void disks_material(struct problem *p, struct seed *s) {
    double e = seed_uniform(s, 0.5, 1);
    p->eos = eos_find("TorquatoDisks");
    p->material = (struct material){.disks = true, .mass = 1, .gamma = 2};
    model_defaults(&p->eos->model, &p->material);
    p->material.diameter = seed_power(s, -3, -1);
    p->material.restitution = seed_chance(s, 0.2) ? 1 : e;
    p->source.cooling = p->material.restitution < 1 && seed_chance(s, 0.85) ? cooling_find("Haff") : NULL;
    p->p0 = problem_density(p, 0.1) * seed_power(s, -2, 2);
    p->transport = transport_find("JenkinsRichman");
    p->transport_params = own_defaults(&p->transport->model);
    model_put(&p->transport->model, &p->transport_params, "alphaMin",
              seed_chance(s, 0.5) ? 1e-4 : seed_power(s, -5, -2));
    model_put(&p->transport->model, &p->transport_params, "bulk", seed_below(s, 2));
    p->diffusion = diffusion_find(seed_below(s, 3) ? "RKJ2" : "RKL2");
    p->alpha_floor = seed_chance(s, 0.3) ? seed_power(s, -8, -4) : 0;
    p->material.tangent = p->seed % 5 == 0; /* without a bound: beyond packing, too */
    p->densest = p->material.tangent ? 1 : 0.999 * p->material.alpha_max;
}

void disks_draw(struct problem *p, struct seed *s) {
    p->dim = p->dim > 1 ? 2 : 1;
    p->n[0] = p->dim == 1 ? 30 + seed_below(s, 41) : 9 + seed_below(s, 6);
    p->n[1] = p->dim == 1 ? 1 : 9 + seed_below(s, 6);
    p->n[2] = 1;
    p->cells = p->n[0] * p->n[1];
    if (p->dim < 3 && p->direction[2] > 0) p->direction[0] = p->direction[1] = sqrt(0.5);
    p->direction[2] = 0;
    disks_material(p, s);
    disks_walls(p, s);
    grains_scene(p, s);
    p->polyhedral = p->dim == 2 && seed_chance(s, 0.4);
    p->shape = seed_below(s, 3) ? TRIANGLES : QUADS;
    p->noise = seed_uniform(s, 0, 0.25);
}

/* ---- disks and spheres by Garzo & Dufty, in 1D, 2D and 3D */

void inelastic_box(struct problem *p, struct seed *s) {
    static const int dims[8] = {1, 1, 2, 2, 2, 3, 3, 3};
    p->material.disks = seed_below(s, 3) == 0;
    const int dim = dims[seed_below(s, p->material.disks ? 5 : 8)];
    const bool cells = seed_below(s, 2);
    p->dim = dim;
    p->polyhedral = dim > 1 && cells;
    const int boxes = seed_below(s, 3);
    p->shape = dim == 2 ? (boxes ? TRIANGLES : QUADS) : boxes ? TETS : HEXES;
    p->noise = seed_uniform(s, 0, dim == 2 ? 0.25 : 0.15);
    p->cells = 1;
    for (int k = 0; k < 3; k++) {
        const bool coarse = p->polyhedral && p->shape == TETS;
        const int n = dim == 1   ? 30 + seed_below(s, 41)
                      : dim == 2 ? 9 + seed_below(s, 6)
                      : coarse   ? 3 + seed_below(s, 2)
                                 : 4 + seed_below(s, 3);
        p->n[k] = k < dim ? n : 1;
        p->cells *= p->n[k];
    }
    const bool diagonal = dim > 1 && seed_chance(s, 0.6);
    for (int k = 0; k < 3; k++) p->direction[k] = k >= dim ? 0 : diagonal ? 1 / sqrt((double)dim) : k == 0;
}

void inelastic_material(struct problem *p, struct seed *s) {
    static const char *const spheres[] = {"TorquatoSpheres", "TorquatoSpheres", "GoldshteinShapiro", "perfectGas"};
    const bool disks = p->material.disks;
    const int kind = seed_below(s, 4), law = seed_below(s, 7);
    const double e = seed_uniform(s, 0.2, 1), gap = seed_power(s, -4, -0.5), gamma = seed_uniform(s, 1.2, 2.5);
    p->eos = eos_find(disks ? "TorquatoDisks" : spheres[kind]);
    p->material = (struct material){.disks = disks, .mass = 1};
    model_defaults(&p->eos->model, &p->material);
    if (kind == 3) p->material.gamma = gamma;
    if (seed_chance(s, 0.2)) p->material.smoothing = 0;
    p->material.diameter = seed_power(s, -3, -1);
    p->material.restitution = seed_chance(s, 0.15) ? 1 : seed_chance(s, 0.1) ? 0.2 : e;
    p->source.cooling = p->material.restitution == 1 || law == 0 ? NULL : cooling_find(law < 3 ? "Haff" : "GarzoDufty");
    p->p0 = problem_density(p, 0.1) * seed_power(s, -2, 2);
    p->alpha_floor = seed_chance(s, 0.3) ? seed_power(s, -8, -4) : 0;
    p->densest = p->material.alpha_max > 0 ? (1 - gap) * p->material.alpha_max : 1;
    if (p->eos == eos_find("GoldshteinShapiro") || !seed_chance(s, 0.2)) return;
    p->material.tangent = true; /* without a bound: beyond packing */
    p->densest = 1;
}

/* The coefficients of a thin gas are bounded by alphaMin or knudsenCut in most problems; steps of Heun's method are too
 * many if not. */
void inelastic_transport(struct problem *p, struct seed *s) {
    static const char *const schemes[8] = {"RKJ2", "RKL2", "explicit", "RKJ2", "RKL2", "RKJ2", "RKJ2", "implicit"};
    const struct transport *t = p->transport = transport_find("GarzoDufty");
    const int kind = seed_below(s, 10);
    double low = kind < 2 ? 0 : kind < 5 ? 1e-4 : seed_power(s, -5, -1);
    double cut = seed_below(s, 2) ? seed_power(s, -5, 0) : 0;
    p->diffusion = diffusion_find(schemes[p->seed % 8]);
    if (!strcmp(p->diffusion->model.name, "explicit")) {
        p->material.diameter *= 0.1;
        low = larger(low, 3e-3);
    }
    if (low == 0 && cut == 0) p->alpha_floor = 1e-4;
    p->transport_params = own_defaults(&t->model);
    model_put(&t->model, &p->transport_params, "alphaMin", low);
    model_put(&t->model, &p->transport_params, "knudsenCut", cut);
    model_put(&t->model, &p->transport_params, "zetaU", seed_below(s, 3));
    const bool diagonal = seed_below(s, 3) == 0;
    model_put(&t->model, &p->transport_params, "stress", diagonal && !p->polyhedral);
}

void inelastic_walls(struct problem *p, struct seed *s) {
    static const char *const velocity[] = {"slip", "noSlip", "translatingWallVelocity", "JohnsonJacksonSlip"};
    static const char *const temperature[] = {"zeroGradient", "fixedValue", "granularWall"};
    const double T = grains_T(p);
    for (int i = 0; i < 6; i++) {
        struct wall *w = &p->wall[i];
        const int kind = seed_below(s, 5), heat = seed_below(s, 3);
        const bool rough = kind >= 3, moves = p->dim > 1 && (kind == 2 || kind == 4);
        const double speed = sqrt(T) * seed_power(s, -1, 1.5), hot = T * seed_power(s, -4, 3), sign = seed_sign(s);
        const double e = seed_uniform(s, -0.2, 1.2), phi = seed_uniform(s, -0.2, 1.2);
        w->velocity = velocity[rough ? 3 : p->dim > 1 ? kind : kind % 2];
        w->temperature = rough && heat != 1 ? velocity[3] : temperature[heat];
        w->along = moves ? sign * speed : 0;
        w->value = heat == 2 ? smaller(larger(e, 0), 1) : hot;
        w->specularity = smaller(larger(phi, 0), 1);
        w->restitution = smaller(larger(e, 0), 1);
    }
}

static void draw_source(struct problem *p, const char *name, double rate, const double velocity[3]) {
    for (int i = 0; i < source_count; i++) {
        if (strcmp(source_table[i].model.name, name) != 0) continue;
        p->source.on[i] = true;
        p->source.params[i] = own_defaults(&source_table[i].model);
        model_put(&source_table[i].model, &p->source.params[i], "rate", rate);
        for (int k = 0; velocity && k < p->dim; k++) p->source.params[i].room[1 + k] = velocity[k];
    }
}

static void inelastic_sources(struct problem *p, struct seed *s) {
    const double T = grains_T(p), drag = sqrt(T) * seed_power(s, -2, 3), heating = T * sqrt(T) * seed_power(s, -3, 2);
    const double speed = sqrt(T) * seed_power(s, -2, 1);
    double velocity[3];
    for (int k = 0; k < 3; k++) velocity[k] = speed * seed_uniform(s, -1, 1);
    if (seed_chance(s, 0.3)) draw_source(p, "linearDrag", drag, velocity);
    if (seed_chance(s, 0.3)) draw_source(p, "uniformHeating", heating, NULL);
}

void inelastic_draw(struct problem *p, struct seed *s) {
    inelastic_box(p, s);
    inelastic_material(p, s);
    inelastic_transport(p, s);
    inelastic_walls(p, s);
    inelastic_sources(p, s);
    grains_scene(p, s);
}

/* ---- the same on lines and in sections, with velocities along the axes that these lack */

void sections_draw(struct problem *p, struct seed *s) {
    inelastic_draw(p, s);
    const int lines = 20 + seed_below(s, 31), most = p->material.disks ? 2 : 3;
    const bool line = p->material.disks || p->dim == 1 || seed_below(s, 3) == 0;
    p->dim = line ? 1 : 2;
    p->components = p->dim + 1 + seed_below(s, most - p->dim);
    p->polyhedral = p->polyhedral && p->dim == 2;
    if (p->dim == 2) p->shape = seed_below(s, 2) ? TRIANGLES : QUADS;
    p->n[0] = line ? lines : 9 + seed_below(s, 6);
    p->n[1] = line ? 1 : 9 + seed_below(s, 6);
    p->n[2] = 1;
    p->cells = p->n[0] * p->n[1];
    p->stated = p->edge == OPEN_ENDED; /* packed gas at an open side without values takes in more and more (seed 5) */
    for (int k = 0; k < 3; k++) p->direction[k] = k >= p->dim ? 0 : k == 0;
    const double fast = sqrt(grains_T(p)) * seed_power(s, -2, 2), pull = seed_power(s, -2, 1);
    for (int k = p->dim; k < p->components; k++) {
        p->wave[4][k] = fast * seed_sign(s);
        if (p->source.gravity[0] != 0) p->source.gravity[k] = pull * p->source.gravity[0];
    }
}

void sections_at(const struct problem *p, const struct place *where, struct point *out) {
    grains_at(p, where, out);
    for (int k = p->dim; k < p->components; k++) {
        const double phase = 0.3 * k + 2 * where->along;
        out->u[k] = p->wave[4][k] * (4 * fabs(phase - floor(phase) - 0.5) - 1);
    }
}
