/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies of revolution: the first eight families, fields that cool, and open sides, in (axial, radial) or radial cells
 * on the axis or beside it, with transport, and with a swirl around it. */
#include "tests/stress/problem.h"

#include "tests/defaults.h"

#include <string.h>

enum { GUESTS = 8, COOLING = 8, GATES = 9, KINDS = 10 };
static int kind_of(const struct problem *p) {
    return (int)(p->seed % KINDS);
}
static bool is_column(const struct problem *p) {
    return kind_of(p) < GUESTS && !strcmp(family_table[kind_of(p)].name, "column");
}

/* Gravity of a column lies along the first axis, which is then the axis of the body. */
static void round_box(struct problem *p, struct seed *s) {
    static const int boxes[8] = {1, 1, 2, 2, 2, 2, 2, 2};
    const int dim = boxes[seed_below(s, 8)], turned = seed_below(s, 2), cells = seed_below(s, 2);
    p->dim = is_column(p) ? 2 : dim;
    p->polyhedral = p->dim == 2 && cells;
    p->radial = p->dim == 1 ? 0 : is_column(p) ? 1 : turned;
    p->shape = seed_below(s, 3) ? TRIANGLES : QUADS;
    p->noise = seed_uniform(s, 0, 0.3);
    for (int k = 0; k < 3; k++) {
        const int n = p->dim == 1     ? 30 + seed_below(s, 31)
                      : p->polyhedral ? 7 + seed_below(s, 4)
                                      : 10 + seed_below(s, 9);
        p->n[k] = k < p->dim ? n : 1;
        p->cells = k ? p->cells * p->n[k] : p->n[k];
    }
    const bool diagonal = p->dim > 1 && seed_chance(s, 0.6);
    for (int k = 0; k < 3; k++) p->direction[k] = k >= p->dim ? 0 : diagonal ? sqrt(0.5) : k == 0;
    const double inner = seed_power(s, -2, 1);
    p->inner = seed_below(s, 2) ? inner : 0;
    p->duration = p->dim == 1 ? seed_power(s, 1, 1.5) : seed_power(s, 0.7, 1.2);
    p->patience = 3;
}

/* Gas in radial cells may also move along the axis. */
static void round_swirl(struct problem *p, struct seed *s) {
    const double speed = sqrt(grains_T(p)) * seed_power(s, -2, 2), along = sqrt(grains_T(p)) * seed_power(s, -2, 2);
    const bool both = p->dim == 1 && seed_below(s, 2);
    if (seed_below(s, 3) == 0) return;
    p->swirl = p->dim;
    p->components = p->dim + 1 + both;
    p->wave[4][p->swirl] = speed * seed_sign(s);
    p->wave[4][0] = both ? along : 0;
}

/* These gases are thinner than any floor: alphaMin bounds the coefficients. */
static void round_transport(struct problem *p, struct seed *s) {
    inelastic_transport(p, s);
    if (p->alpha_floor > 0) model_put(&p->transport->model, &p->transport_params, "alphaMin", 1e-3);
    p->alpha_floor = 0;
}

void round_draw(struct problem *p, struct seed *s) {
    round_box(p, s);
    p->densest = 0.9999 * p->material.alpha_max;
    if (kind_of(p) < GATES) {
        family_table[kind_of(p)].draw(p, s);
    } else {
        p->edge = OPEN_ENDED;
        gates_draw(p, s);
        family_table[0].draw(p, s);
    }
    p->source.gravity[p->radial] = 0;
    p->stated = p->edge == OPEN_ENDED;
    round_swirl(p, s);
    if (p->seed / KINDS % 4 == 2) round_transport(p, s);
}

void round_at(const struct problem *p, const struct place *where, struct point *out) {
    family_table[kind_of(p) < GATES ? kind_of(p) : 0].at(p, where, out);
    if (!p->swirl) return;
    const double phase = 2 * where->x[p->radial] + where->along;
    out->u[p->swirl] = p->wave[4][p->swirl] * (4 * fabs(phase - floor(phase) - 0.5) - 1);
    if (p->swirl + 1 < p->components) out->u[p->swirl + 1] = p->wave[4][0] * where->along;
}

struct problem problem_mirrored(const struct problem *p) {
    struct problem m = *p;
    const int axial = 1 - p->radial, low = 2 * axial;
    m.mirrored = true;
    m.source.gravity[axial] = -m.source.gravity[axial];
    m.gate[low] = p->gate[low + 1];
    m.gate[low + 1] = p->gate[low];
    for (int i = 0; i < 6; i++) m.gate[i].u[axial] = -m.gate[i].u[axial];
    return m;
}
