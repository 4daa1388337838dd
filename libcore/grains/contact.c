/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes numbers of the contact laws (contact.h). */
#include "libcore/grains/contact.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Returns E* of two grains of the same material. */
static double stiff(const struct soft_contact *c) {
    return c->young / (2 * (1 - c->poisson * c->poisson));
}

/* Returns 8 G*, the factor of Mindlin's stiffness, G* = E/(4 (2 - nu)(1 + nu)). */
static double mindlin(const struct soft_contact *c) {
    return 2 * c->young / ((2 - c->poisson) * (1 + c->poisson));
}

/* Tsuji's alpha as LAMMPS fits it to the coefficient it is given. */
static double tsuji_fit(double e) {
    static const double a[] = {1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218};
    double sum = 0;
    for (int i = 7; i--;) sum = sum * e + a[i];
    return sum;
}

/* Returns the coefficient for which that fit has the alpha of the exact restitution e, by bisection: the fit falls. */
static double tsuji_coefficient(double e) {
    const double l = -log(e), alpha = sqrt(5) * l / sqrt(l * l + PI * PI);
    double low = -1, high = 1;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (tsuji_fit(middle) > alpha)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static struct contact_law law_of(const struct soft_contact *c, double radius, double mass, double e, double mu) {
    struct contact_law l = {.contact = c, .radius = radius, .mass = mass, .chi = c->chi, .friction = mu, .kt = c->kt};
    const double loss = e > 0 && e < 1 ? -log(e) : 0;
    if (c->type == CONTACT_LINEAR) {
        l.k = c->stiffness;
        l.eta = 2 * loss * sqrt(l.k * mass / (PI * PI + loss * loss));
        if (l.kt < 0) l.kt = 2. / 7 * l.k;
        return l;
    }
    l.k = 4. / 3 * stiff(c);
    l.tsuji = loss > 0;
    l.eta = l.tsuji ? tsuji_coefficient(e) : e < 0 ? 1.5 * l.k * c->dissipation / mass : 0;
    if (c->tangent == TANGENT_MINDLIN && l.kt < 0) l.kt = mindlin(c);
    return l;
}

struct contact_law contact_pair(const struct soft_contact *c, double diameter, double mass) {
    return law_of(c, diameter / 4, mass / 2, c->restitution, c->friction);
}
struct contact_law contact_wall(const struct soft_contact *c, double diameter, double mass, double e, double mu) {
    return law_of(c, diameter / 2, mass, e, mu);
}

double contact_time(const struct contact_law *l, double speed) {
    if (l->contact->type == CONTACT_LINEAR) return PI * sqrt(l->mass / l->k);
    const double E = stiff(l->contact);
    return 2.87 * pow(l->mass * l->mass / (l->radius * E * E * speed), 0.2);
}

double contact_mindlin(const struct soft_contact *c, double diameter, double mass, double speed) {
    const double R = diameter / 4, K = 4. / 3 * stiff(c) * sqrt(R);
    return mindlin(c) * sqrt(R * pow(1.25 * (mass / 2) * speed * speed / K, 0.4));
}

double contact_elastic(const struct contact_law *l, double overlap) {
    if (l->contact->type == CONTACT_LINEAR) return 0.5 * l->k * overlap * overlap;
    return 0.4 * l->k * sqrt(l->radius * overlap) * overlap * overlap;
}

double contact_rest(const struct contact_law *l, double force) {
    if (l->contact->type == CONTACT_LINEAR) return force / l->k;
    return pow(force / (l->k * sqrt(l->radius)), 2. / 3);
}

double contact_damper(const struct contact_law *l, double overlap) {
    if (l->contact->type == CONTACT_LINEAR) return l->eta;
    const double a = sqrt(l->radius * overlap);
    return l->eta * (l->tsuji ? sqrt(l->mass * l->k * a) : l->mass * a);
}

double contact_spring(const struct contact_law *l, double overlap) {
    return l->contact->type == CONTACT_HERTZ && l->contact->tangent == TANGENT_MINDLIN
               ? l->kt * sqrt(l->radius * overlap)
               : l->kt;
}
