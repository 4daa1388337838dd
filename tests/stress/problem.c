/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/problem.h"

#include "tests/defaults.h"

#include <string.h>

static double limit_alpha(const struct problem *p) {
    return p->material.alpha_max;
}

double problem_density(const struct problem *p, double alpha) {
    return alpha / packing_per_density(&p->material);
}

void problem_per_energy(const struct problem *p, double alpha, double *pressure, double *c2) {
    double rho = problem_density(p, alpha), one = 1, gruneisen;
    p->eos->state(&p->material, 1, &rho, &one, pressure, c2, &gruneisen);
}

double problem_sound(const struct problem *p, double alpha, double pressure) {
    double unit, c2;
    problem_per_energy(p, alpha, &unit, &c2);
    return sqrt(c2 * (pressure / unit));
}

/* Over all of what is allowed: log-uniform from 1e-10, uniform, and close to packing. */
static double any_alpha(const struct problem *p, struct seed *s) {
    int kind = seed_below(s, 8);
    double exponent = seed_uniform(s, -10, 0), flat = seed_uniform(s, 1e-3, 0.9999), gap = seed_power(s, -4, -1);
    return limit_alpha(p) * (kind < 3 ? 0.9999 * power(10, exponent) : kind < 6 ? flat : 1 - gap);
}
static double thin_alpha(const struct problem *p, struct seed *s) {
    return limit_alpha(p) * seed_power(s, -10, -4);
}
static double dense_alpha(const struct problem *p, struct seed *s) {
    double flat = seed_uniform(s, 0.4, 0.999), gap = seed_power(s, -4, -1);
    return limit_alpha(p) * (seed_below(s, 2) ? flat : 1 - gap);
}
/* The order of two calls in one expression is the compiler's choice: draws are statements of their own. */
static struct point drawn(const struct problem *p, struct seed *s,
                          double (*alpha)(const struct problem *p, struct seed *s), double low, double high) {
    struct point q = {.alpha = alpha(p, s)};
    q.p = p->p0 * seed_power(s, low, high);
    return q;
}

/* A velocity of the given Mach number of a state, mostly along the problem's direction. */
static void set_mach(const struct problem *p, struct point *q, double mach, struct seed *s) {
    double c = problem_sound(p, q->alpha, q->p), aside = p->dim > 1 && seed_chance(s, 0.3) ? mach * c : 0;
    for (int k = 0; k < p->dim; k++) {
        double turn = seed_uniform(s, -1, 1);
        q->u[k] = mach * c * p->direction[k] + aside * turn;
    }
}
static double any_mach(struct seed *s) { /* 0, or 1e-3 .. 1000 */
    double mach = seed_power(s, -3, 3), sign = seed_sign(s);
    return seed_chance(s, 0.3) ? 0 : sign * mach;
}
static struct point any_point(const struct problem *p, struct seed *s) {
    struct point q = drawn(p, s, any_alpha, -5, 5);
    double mach = any_mach(s);
    set_mach(p, &q, mach, s);
    return q;
}

static bool in_ball(const struct problem *p, const struct place *where) {
    double square = 0;
    for (int k = 0; k < p->dim; k++) square += (where->x[k] - p->centre[k]) * (where->x[k] - p->centre[k]);
    return square < p->size * p->size;
}

/* A smooth function of period 1 with values -1 .. 1. */
static double ripple(double x) {
    double f = x - floor(x);
    return f < 0.5 ? 16 * f * (0.5 - f) : -16 * (f - 0.5) * (1 - f);
}
static double random_field(const struct problem *p, int v, const double x[3]) {
    const double *w = p->wave[v];
    double sum = 0;
    for (int k = 0; k < p->dim; k++)
        sum += ripple(x[k] + w[k]) * (0.3 + 0.7 * fabs(ripple(2 * x[(k + 1) % 3] + w[k + 3])));
    return sum / p->dim;
}
static void draw_fields(struct problem *p, struct seed *s) {
    for (int v = 0; v < MAX_VAR; v++)
        for (int i = 0; i < 6; i++) p->wave[v][i] = seed_uniform(s, 0, 1);
}

static void riemann_draw(struct problem *p, struct seed *s) {
    for (int i = 0; i < 2; i++) p->side[i] = any_point(p, s);
    p->size = seed_uniform(s, 0.2, 0.8);
}
static void two_sides(const struct problem *p, const struct place *where, struct point *out) {
    *out = p->side[where->along >= p->size];
}

static void blast_draw(struct problem *p, struct seed *s) {
    p->side[0] = drawn(p, s, dense_alpha, 0, 5);
    p->side[1] = drawn(p, s, thin_alpha, -5, -1);
    p->size = seed_uniform(s, 0.1, 0.45);
    for (int k = 0; k < 3; k++) p->centre[k] = seed_uniform(s, 0.3, 0.7);
}
static void ball(const struct problem *p, const struct place *where, struct point *out) {
    *out = p->side[!in_ball(p, where)];
}

static void rarefaction_draw(struct problem *p, struct seed *s) {
    double mach = seed_power(s, -1, 3);
    p->side[0] = drawn(p, s, any_alpha, -5, 5);
    p->side[1] = p->side[0];
    double c = problem_sound(p, p->side[0].alpha, p->side[0].p);
    for (int k = 0; k < p->dim; k++) {
        p->side[0].u[k] = -mach * c * p->direction[k];
        p->side[1].u[k] = mach * c * p->direction[k];
    }
    p->size = 0.5;
    p->edge = seed_below(s, 2) ? OPEN_ENDED : CLOSED;
}

static void implosion_draw(struct problem *p, struct seed *s) {
    double mach = seed_power(s, 0, 3), centre = 0.5 * seed_below(s, 2);
    p->side[0] = drawn(p, s, any_alpha, -5, 5);
    p->side[0].u[0] = -mach * problem_sound(p, p->side[0].alpha, p->side[0].p);
    for (int k = 0; k < 3; k++) p->centre[k] = centre;
    p->edge = CLOSED;
}
static void inwards(const struct problem *p, const struct place *where, struct point *out) {
    double square = 1e-30, d[3] = {0};
    for (int k = 0; k < p->dim; k++) {
        d[k] = where->x[k] - p->centre[k];
        square += d[k] * d[k];
    }
    *out = p->side[0];
    for (int k = 0; k < p->dim; k++) out->u[k] = p->side[0].u[0] * d[k] / sqrt(square);
}

static void beds_draw(struct problem *p, struct seed *s) {
    for (int i = 0; i < 2; i++) {
        p->side[i] = drawn(p, s, dense_alpha, -5, 0);
        double mach = seed_power(s, 0, 3);
        set_mach(p, &p->side[i], i ? -mach : mach, s);
    }
    p->size = seed_uniform(s, 0, 0.3); /* of the gap */
    p->wave[0][0] = thin_alpha(p, s);
    p->wave[0][1] = p->p0 * seed_power(s, -5, 0);
}
static void beds(const struct problem *p, const struct place *where, struct point *out) {
    double off = where->along - 0.5;
    *out = p->side[off >= 0];
    if (fabs(off) < 0.5 * p->size || fabs(off) > 0.45)
        *out = (struct point){.alpha = p->wave[0][0], .p = p->wave[0][1]};
}

static void column_draw(struct problem *p, struct seed *s) {
    p->side[0] = drawn(p, s, dense_alpha, -3, 1);
    p->side[1] = drawn(p, s, thin_alpha, -5, 0);
    p->size = seed_uniform(s, 0.1, 0.7);
    double c = problem_sound(p, p->side[0].alpha, p->side[0].p), pull = seed_power(s, -2, 4) * c * c;
    for (int k = 0; k < p->dim; k++) p->source.gravity[k] = k ? pull * seed_uniform(s, -0.3, 0.3) : -pull;
    p->source.amplitude = seed_chance(s, 0.8) ? seed_uniform(s, 0, 10) : 0;
    p->source.frequency = seed_power(s, -1, 2) * sqrt(pull);
    p->source.phase = seed_uniform(s, 0, 6);
    p->edge = seed_below(s, 3) ? CLOSED : PERIODIC; /* closed along gravity all the same */
    p->walls_along = true;
    p->direction[0] = 1;
    p->direction[1] = p->direction[2] = 0;
}

static void wall_draw(struct problem *p, struct seed *s) {
    p->side[0] = drawn(p, s, any_alpha, -5, 5);
    double mach = seed_power(s, 1, 3);
    set_mach(p, &p->side[0], mach, s);
    p->side[1] = p->side[0];
    p->size = 0.5;
    p->edge = CLOSED;
}

static void tiles_draw(struct problem *p, struct seed *s) {
    p->pattern = 1 + seed_below(s, 4);
    double fastest = seed_below(s, 2) ? 1 : 3;
    p->size = seed_power(s, -2, fastest); /* Mach number */
}
/* The state of a tile is drawn from a stream of its own: cells may ask in any order. */
static void tiles(const struct problem *p, const struct place *where, struct point *out) {
    struct seed s = seed_start(100 + p->family, p->seed * 65537 + (uint64_t)where->tile);
    *out = drawn(p, &s, seed_below(&s, 2) ? thin_alpha : dense_alpha, -5, 5);
    double speed = p->size * problem_sound(p, out->alpha, out->p);
    for (int k = 0; k < p->dim; k++) out->u[k] = speed * seed_uniform(&s, -1, 1);
}

static void cooling_draw(struct problem *p, struct seed *s) {
    draw_fields(p, s);
    p->side[0] = (struct point){.alpha = limit_alpha(p) * seed_uniform(s, 0.01, 0.7), .p = p->p0};
    p->size = seed_power(s, -1, 1); /* Mach number */
    p->material.restitution = seed_uniform(s, 0, 0.95);
    p->source.cooling = cooling_find("Haff");
    p->edge = PERIODIC;
    p->duration *= 2;
}
static void fields(const struct problem *p, const struct place *where, struct point *out) {
    const double *x = where->x;
    *out = p->side[0];
    out->alpha *= 1 + 0.4 * random_field(p, 0, x);
    out->p *= 1 + 0.8 * random_field(p, 1, x);
    double c = problem_sound(p, out->alpha, out->p);
    for (int k = 0; k < p->dim; k++) out->u[k] = p->size * c * random_field(p, 2 + k, x);
}

enum { GUESTS = 8, FIRST_POLYHEDRAL = 10, DISKS = 13 };
static int guest(const struct problem *p) {
    return (int)(p->seed % GUESTS);
}
static void guest_draw(struct problem *p, struct seed *s) {
    family_table[guest(p)].draw(p, s);
    p->polyhedral = true;
}
static void guest_at(const struct problem *p, const struct place *where, struct point *out) {
    family_table[guest(p)].at(p, where, out);
}
static void triangles_draw(struct problem *p, struct seed *s) {
    guest_draw(p, s);
    p->shape = seed_below(s, 4) ? TRIANGLES : QUADS;
    p->noise = seed_uniform(s, 0, 0.3);
}
static void tetrahedra_draw(struct problem *p, struct seed *s) {
    guest_draw(p, s);
    p->shape = seed_below(s, 4) ? TETS : HEXES;
    p->noise = seed_uniform(s, 0, 0.15);
}
static void bad_cells_draw(struct problem *p, struct seed *s) {
    guest_draw(p, s);
    bool boxes = seed_below(s, 3) == 0;
    p->shape = p->dim == 2 ? (boxes ? QUADS : TRIANGLES) : boxes ? HEXES : TETS;
    p->noise = seed_uniform(s, 0, p->dim == 2 ? 0.25 : 0.12);
    p->stretch = seed_below(s, 2) ? seed_power(s, 0, 2) : 1;
    p->squash = seed_below(s, 2) ? seed_power(s, 0, 2.5) : 1;
    p->sliver = seed_below(s, 2) ? 1 - seed_power(s, -3, -0.5) : 0;
}

const struct family family_table[FAMILIES] = {
    {"riemann", "two random states", riemann_draw, two_sides},
    {"tiles", "patches of cells near vacuum and near packing", tiles_draw, tiles},
    {"vacuum", "a dense hot ball in near vacuum", blast_draw, ball},
    {"rarefaction", "two halves that part (123), Mach 0.1 to 1000", rarefaction_draw, two_sides},
    {"implosion", "Noh's: all moves to a point or a corner, Mach 1 to 1000", implosion_draw, inwards},
    {"beds", "cold dense beds that collide, Mach 1 to 1000", beds_draw, beds},
    {"wall", "a stream onto a wall, Mach 10 to 1000", wall_draw, two_sides},
    {"column", "a bed under shaken gravity in a closed box", column_draw, two_sides},
    {"cooling", "random fields in a periodic box that cool to collapse", cooling_draw, fields},
    {"elastic", "two random states of the dilute elastic gas", riemann_draw, two_sides},
    {"triangles", "the first eight on perturbed triangles or quads", triangles_draw, guest_at},
    {"tetrahedra", "the same on perturbed tetrahedra or warped hexahedra", tetrahedra_draw, guest_at},
    {"badCells", "the same on slivers, flat cells, and tiny cells beside large ones", bad_cells_draw, guest_at},
    {"disks", "disks with viscosity and heat conduction between walls of all kinds", disks_draw, grains_at},
    {"inelastic", "disks and spheres by Garzo & Dufty, all walls and sources, in 1D, 2D and 3D", inelastic_draw,
     grains_at},
    {"open", "disks and spheres in boxes with open sides of every kind", open_draw, grains_at},
    {"extreme", "the first eight, or grains that conduct, on cells flat, thin and small by many orders", extreme_draw,
     extreme_at},
    {"settled", "beds that have settled, between all walls, over long times", settled_draw, settled_at},
    {"implicit", "beds with implicit acoustics: at rest, falling, hit, sheared, drained, collapsing, shaken",
     implicit_draw, implicit_at},
    {"implicitCells", "the same on perturbed triangles, quads, tetrahedra or warped hexahedra", implicit_cells_draw,
     implicit_at},
    {"sections", "the disks and spheres of `inelastic` in 1D and 2D that move along axes the mesh lacks, too",
     sections_draw, sections_at},
    {"friction", "packed gas with friction: slopes, columns, heaps, drops, sheared, drained, shaken", friction_draw,
     friction_at},
    {"round", "the first eight, fields that cool, and open sides as bodies of revolution, with swirl", round_draw,
     round_at},
};

int family_find(const char *name) {
    for (int i = 0; i < FAMILIES; i++)
        if (!strcmp(family_table[i].name, name)) return i;
    return -1;
}

static void draw_material(struct problem *p, struct seed *s) {
    static const double gammas[3] = {5. / 3, 2, 1.4};
    int kind = seed_below(s, 4), ratio = seed_below(s, 6);
    double e = seed_uniform(s, 0, 1);
    p->material.diameter = seed_power(s, -4, -0.5);
    p->material.mass = 1;
    p->material.restitution = kind == 0 ? 1 : kind == 1 && e < 0.3 ? 0 : e;
    p->material.gamma = gammas[ratio < 3 ? ratio : 0];
    p->material.alpha_max = seed_uniform(s, 0.5, 0.75);
    p->eos = eos_find(seed_below(s, 4) ? "GoldshteinShapiro" : "perfectGas");
    p->source.cooling = p->material.restitution < 1 && seed_chance(s, 0.8) ? cooling_find("Haff") : NULL;
    p->p0 = problem_density(p, 0.1) * seed_power(s, -3, 3);
}

static void draw_box(struct problem *p, struct seed *s) {
    static const int dims[8] = {1, 1, 1, 1, 2, 2, 2, 3};
    p->dim = p->family == FIRST_POLYHEDRAL       ? 2
             : p->family == FIRST_POLYHEDRAL + 1 ? 3
             : p->family == FIRST_POLYHEDRAL + 2 ? 2 + (seed_below(s, 3) == 0)
                                                 : dims[seed_below(s, 8)];
    bool cells = p->family >= FIRST_POLYHEDRAL && p->family < DISKS;
    for (int k = 0; k < 3; k++) {
        int flat = p->dim == 1 ? 50 + seed_below(s, 51) : p->dim == 2 ? 16 + seed_below(s, 9) : 8;
        int coarse = p->dim == 2 ? 9 + seed_below(s, 4) : 4;
        p->n[k] = k >= p->dim ? 1 : cells ? coarse : flat;
        p->cells = k ? p->cells * p->n[k] : p->n[k];
    }
    int edge = seed_below(s, 10);
    p->edge = edge < 4 ? CLOSED : edge < 8 ? PERIODIC : OPEN_ENDED;
    bool diagonal = p->dim > 1 && seed_chance(s, 0.6);
    for (int k = 0; k < p->dim; k++) p->direction[k] = diagonal ? 1 / sqrt((double)p->dim) : k == 0;
    p->duration = p->dim == 1 ? seed_power(s, 1.6, 2.3) : seed_power(s, 1.3, 1.9);
    p->stretch = p->squash = 1;
    p->pattern = 1;
}

/* `automatic`, the default of cases, changes nothing but where beds can rest: half of the problems of such gases have
 * it. It is drawn from a stream of its own, as problems are known by their seeds. */
static void draw_automatic(struct problem *p) {
    const struct acoustics *a = acoustics_find("automatic");
    struct seed s = seed_start(200 + p->family, p->seed);
    if (p->acoustics || p->radial >= 0 || !p->eos->bounded || !p->source.cooling || p->material.restitution == 1 ||
        p->material.threshold == 0 || seed_below(&s, 2))
        return;
    p->acoustics = a;
    p->acoustics_params = own_defaults(&a->model);
}

struct problem problem_draw(int family, uint64_t number) {
    struct problem p = {.family = family, .seed = number, .radial = -1};
    struct seed s = seed_start(family, number);
    draw_box(&p, &s);
    draw_material(&p, &s);
    if (!strcmp(family_table[family].name, "elastic")) {
        p.material.restitution = 1;
        p.source.cooling = NULL;
        p.eos = eos_find("perfectGas");
        p.edge = CLOSED;
    }
    family_table[family].draw(&p, &s);
    if (p.source.cooling && seed_chance(&s, 0.2)) /* against the thermal speed */
        p.material.threshold = sqrt(p.p0 / problem_density(&p, 0.1)) * seed_power(&s, -4, 0);
    draw_automatic(&p);
    return p;
}

bool problem_spare(struct problem *p) {
    if (p->dim == 1 || p->radial >= 0) return false;
    if (!p->polyhedral) p->shape = p->dim == 2 ? p->seed % 2 ? TRIANGLES : QUADS : p->seed % 2 ? TETS : HEXES;
    p->polyhedral = true;
    p->acoustics = NULL;
    p->friction = NULL;
    for (int i = 0; i < 6 && !p->transport; i++) p->wall[i].velocity = NULL;
    return true;
}

void problem_state(const struct problem *p, const double x[3], double *rho, double u[3], double *T) {
    struct place where = {.x = {x[0], x[1], x[2]}};
    struct point q = {0};
    double unit, c2, longest = 0;
    for (int k = 0, stride = 1; k < p->dim; k++) {
        int across = (p->n[k] + p->pattern - 1) / p->pattern;
        where.along += p->direction[k] * x[k];
        longest += p->direction[k];
        where.tile += stride * (int)(x[k] * p->n[k] / p->pattern);
        stride *= across;
    }
    where.along /= longest;
    family_table[p->family].at(p, &where, &q);
    problem_per_energy(p, q.alpha, &unit, &c2);
    *rho = problem_density(p, q.alpha);
    *T = q.p / unit * (p->material.gamma - 1);
    double square = q.u[0] * q.u[0] + q.u[1] * q.u[1] + q.u[2] * q.u[2], most = 1e12 * *T; /* E rounds the rest away */
    for (int k = 0; k < 3; k++) u[k] = square > most ? q.u[k] * sqrt(most / square) : q.u[k];
}
