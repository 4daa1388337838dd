/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Families of problems that might have no end: gas that open sides feed, meshes of cells that differ by many orders,
 * and beds that have settled, over long times. They may end with a stated cause, but must end. */
#include "tests/stress/problem.h"

#include <string.h>

/* ---- open sides */

static const char *one_of(struct seed *s, int n) {
    static const char *const kinds[] = {"zeroGradient", "fixedValue", "inletOutlet"};
    return kinds[seed_below(s, n)];
}

/* Each of density, velocity and temperature, or pressure, free, held, or held while gas comes in: all 27, and 36 with a
 * pressure. Gas from outside is as thin as 1e-8 or as dense as 1e-4 below packing, at up to Mach 10. */
static struct gate draw_gate(const struct problem *p, struct seed *s) {
    struct gate g = {.shut = seed_chance(s, 0.2)};
    const double most = p->densest, thin = seed_power(s, -8, -1), flat = seed_uniform(s, 0.1, 1);
    const double alpha = larger(seed_below(s, 2) ? thin * most : flat * most, 1.01 * p->alpha_floor);
    const double T = grains_T(p) * seed_power(s, -3, 3), mach = seed_power(s, -2, 1);
    double unit, c2;
    g.density = one_of(s, 3);
    g.velocity = one_of(s, 3);
    g.temperature = one_of(s, 3);
    g.pressure = seed_below(s, 4) == 0;
    problem_per_energy(p, alpha, &unit, &c2);
    g.rho = problem_density(p, alpha);
    g.T = g.pressure ? unit * T / (p->material.gamma - 1) : T;
    for (int k = 0; k < p->dim; k++)
        g.u[k] = mach * problem_sound(p, alpha, unit * T / (p->material.gamma - 1)) * seed_uniform(s, -1, 1);
    return g;
}

void gates_draw(struct problem *p, struct seed *s) {
    for (int i = 0; i < 6; i++) p->gate[i] = draw_gate(p, s);
}

void open_draw(struct problem *p, struct seed *s) {
    inelastic_box(p, s);
    inelastic_material(p, s);
    const bool viscous = seed_chance(s, 0.4), falls = seed_chance(s, 0.5);
    if (viscous) inelastic_transport(p, s);
    inelastic_walls(p, s);
    grains_scene(p, s);
    p->walls_along = p->walls_along && falls;
    p->edge = OPEN_ENDED;
    gates_draw(p, s);
    p->duration *= 4;
    p->patience = 4;
    p->stated = true;
}

/* ---- extreme meshes */

enum { GUESTS = 8 };
static bool conducts(const struct problem *p) {
    return p->seed % 5 < 2;
}

void extreme_at(const struct problem *p, const struct place *where, struct point *out) {
    if (conducts(p))
        grains_at(p, where, out);
    else
        family_table[p->seed / 5 % GUESTS].at(p, where, out);
}

/* Lattices of flat boxes; triangles, quads, tetrahedra, hexahedra whose widths grow by up to 1e6, which are flat by up
 * to 1e6, or of whose corners some lie 1e-8 of the way beside others; in the last case with V/A to 1e-8 of the others.
 */
void extreme_draw(struct problem *p, struct seed *s) {
    if (conducts(p))
        inelastic_draw(p, s);
    else
        family_table[p->seed / 5 % GUESTS].draw(p, s);
    if (p->dim == 1) p->dim = 2;
    const bool lattice = seed_below(s, 4) == 0, boxes = seed_below(s, 2);
    const int spoilt = 1 + seed_below(s, 7);
    const double stretch = seed_power(s, 0, 6), squash = seed_power(s, 0, 6), gap = seed_power(s, -8, -1);
    p->polyhedral = !lattice;
    p->shape = p->dim == 2 ? (boxes ? QUADS : TRIANGLES) : boxes ? HEXES : TETS;
    p->cells = 1;
    for (int k = 0; k < 3; k++) {
        const int n = p->dim == 2 ? 9 + seed_below(s, 4) : 4;
        p->n[k] = k < p->dim ? n : 1;
        p->cells *= p->n[k];
    }
    p->noise = seed_uniform(s, 0, 0.1);
    p->stretch = spoilt & 1 ? stretch : 1;
    p->squash = spoilt & 2 || lattice ? squash : 1;
    p->sliver = spoilt & 4 ? 1 - gap : 0;
    p->through =
        conducts(p) ? 16 : 1; /* flat cells: all heat of a line of 12 may pass through each, and is rounded there */
    p->stated = true;
}

/* ---- settled beds */

/* Grains of any kind under gravity at their hydrostatic pressure, under thin gas; e < 1 mostly with a threshold speed.
 * Up to twenty times as long as the fall through the bed. */
void settled_draw(struct problem *p, struct seed *s) {
    const int dim = seed_below(s, 4) ? 1 : 2;
    inelastic_box(p, s);
    p->dim = dim;
    p->polyhedral = dim == 2 && seed_below(s, 2);
    p->shape = seed_below(s, 2) ? TRIANGLES : QUADS;
    for (int k = 0; k < 3; k++) {
        const int n = dim == 1 ? 10 + seed_below(s, 11) : 5 + seed_below(s, 3);
        p->n[k] = k < dim ? n : 1;
        p->direction[k] = k == 0;
    }
    p->cells = p->n[0] * p->n[1];
    inelastic_material(p, s);
    const double e = seed_uniform(s, 0.3, 0.99), pressure = p->p0;
    if (p->material.restitution == 1) p->material.restitution = e;
    p->source.cooling = cooling_find(seed_below(s, 2) ? "Haff" : "GarzoDufty");
    const bool viscous = seed_chance(s, 0.5), still = seed_chance(s, 0.8);
    if (viscous) inelastic_transport(p, s);
    inelastic_walls(p, s);
    p->size = seed_uniform(s, 0.2, 0.7); /* depth */
    const double falls = seed_power(s, 0, 1.3), packed = seed_uniform(s, 0.6, 0.99), thin = seed_power(s, -7, -2),
                 above = seed_power(s, -4, -1);
    p->side[0] = (struct point){.alpha = packed * smaller(p->densest, 0.99), .p = pressure};
    p->side[1] = (struct point){.alpha = larger(thin, 1.01 * p->alpha_floor), .p = above * pressure};
    const double pull = pressure / (problem_density(p, p->side[0].alpha) * p->size), slow = seed_power(s, -2, -0.5);
    p->source.gravity[0] = -pull;
    p->material.threshold = still ? slow * sqrt(pull * p->size) : 0;
    p->walls_along = true;
    p->edge = seed_below(s, 2) ? CLOSED : PERIODIC;
    p->end = falls * sqrt(2 * p->size / pull);
    p->patience = 160;
    p->stated = true;
}

void settled_at(const struct problem *p, const struct place *where, struct point *out) {
    const double under = 1 - where->x[0] / p->size; /* share of the bed that lies above */
    *out = p->side[under <= 0];
    if (under > 0) out->p = p->side[1].p + under * p->side[0].p;
}
