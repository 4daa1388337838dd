/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains in motion against published theory: pressure of elastic disks and spheres, cooling of inelastic ones. */
#include "libcore/grains/packing.h"

#include "tests/checks.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

struct virial { /* sum of impulse * branch over the impacts of pairs */
    struct grain_observer listen;
    double sum;
    int64_t pairs;
};

static void add(struct grain_observer *self, const struct grain_impact *i) {
    struct virial *v = (struct virial *)self;
    double branch = 0;
    for (int k = 0; k < 3; k++) branch += (i->x[1][k] - i->x[0][k]) * i->normal[k];
    if (i->b >= 0) v->sum += i->impulse * branch, v->pairs++;
}

struct gas {
    int dim, n;
    double packing;
    double (*x)[3], (*u)[3];
    struct grain_box box;
    struct grains *grains;
};

/* n grains of diameter 1 and mass 1 at T = 1 in a periodic box, or a walled one; added at random, not yet an
 * equilibrium
 */
static struct gas gas_make(int dim, int n, double packing, bool periodic) {
    struct gas g = {.dim = dim, .n = n, .packing = packing, .box = {.dim = dim}};
    double volume = n * (dim == 2 ? PI / 4 : PI / 6) / packing, T = 1;
    for (int k = 0; k < dim; k++) {
        g.box.high[k] = dim == 2 ? sqrt(volume) : cbrt(volume);
        g.box.periodic[k] = periodic;
        g.box.restitution[k][0] = g.box.restitution[k][1] = 1;
    }
    struct packing_field f = {.n = {1, 1, 1}, .T = &T};
    struct packing_report report;
    struct grain_law law = {.diameter = 1, .mass = 1, .restitution = 1};
    g.x = calloc((size_t)n, sizeof *g.x);
    g.u = calloc((size_t)n, sizeof *g.u);
    ok(packing_places(&g.box, 1, &f, n, 3, g.x, &report));
    packing_velocities(&g.box, &f, n, 3, (const double(*)[3])g.x, g.u);
    ok(grains_make(&g.box, &law, n, (const double(*)[3])g.x, (const double(*)[3])g.u, 0, &g.grains));
    return g;
}

static void gas_free(struct gas *g) {
    grains_free(g->grains);
    free(g->x);
    free(g->u);
}

static double temperature(const struct gas *g) {
    double kinetic, potential, momentum[3];
    grains_energy(g->grains, &kinetic, &potential, momentum);
    return 2 * kinetic / (g->dim * g->n);
}

static double polynomial(double y, const double *a, const int *power, int terms) {
    double sum = 0;
    for (int k = 0; k < terms; k++) sum += a[k] * pow(y / (1 - y), power[k]);
    return sum;
}

/* Fits of p/(n T) to simulations, good to 0.03 %: Kolafa & Rottner, Mol. Phys. 104 (2006) 3435 for
 * disks below 0.69, Kolafa, Labik & Malijevsky, Phys. Chem. Chem. Phys. 6 (2004) 2335 for spheres. */
static double compressibility(int dim, double y) {
    static const double disks[] = {1,
                                   2,
                                   1.12801775,
                                   0.00181895291,
                                   -0.0526134737,
                                   0.0504951668,
                                   -0.0325433846,
                                   0.0133946531,
                                   0.00174265604,
                                   -0.00944632202,
                                   0.00851111768,
                                   -0.0035963525,
                                   0.000577345106,
                                   -1.06399127e-7};
    static const double spheres[] = {1,          4,          6,           2.3647684,   -0.8698551, 1.1062803,
                                     -1.1014221, 0.66605866, -0.03633431, -0.20965164, 0.10555569, -0.00872380};
    static const int of_disks[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 19};
    static const int of_spheres[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 14, 22};
    return dim == 2 ? polynomial(y, disks, of_disks, 14) : polynomial(y, spheres, of_spheres, 12);
}

static double contact_value(int dim, double packing) {
    return (compressibility(dim, packing) - 1) / packing / (dim == 2 ? 2 : 4);
}
static double impact_rate(int dim, double packing) { /* of a grain at T = 1 */
    return (dim == 2 ? 8 : 24) * packing * contact_value(dim, packing) / sqrt(PI);
}

/* p = (n - 1)/n of the ideal gas (no momentum) + collisions. Over 250 impacts of each of 4000 grains the standard
 * deviation of p is 0.2 %, of the number of impacts 0.15 %. */
static void pressure(int dim, double packing) {
    enum { N = 4000 };
    struct gas g = gas_make(dim, N, packing, true);
    double rate = impact_rate(dim, packing), start = grains_advance(g.grains, 40 / rate, INT64_MAX, NULL);
    struct virial v = {.listen = {.impact = add}};
    double end = grains_advance(g.grains, start + 250 / rate, INT64_MAX, &v.listen);
    assert_true(fabs(temperature(&g) - 1) < 1e-12);
    double Z = (N - 1.) / N + v.sum / (end - start) / (dim * N), fit = compressibility(dim, packing);
    double met = 2. * (double)v.pairs / N / (end - start) / rate;
    printf("dim %d, packing %.2f: p/(n T) = %.4f, fit %.4f: %+.2f %%; impacts / theory's: %.4f\n", dim, packing, Z, fit,
           100 * (Z / fit - 1), met);
    assert_true(fabs(Z / fit - 1) < 0.005 && fabs(met - 1) < 0.005);
    gas_free(&g);
}

static void pressures(void **state) {
    (void)state;
    pressure(2, 0.3);
    pressure(2, 0.6);
    pressure(3, 0.1);
    pressure(3, 0.4);
}

/* The push on walls is that of the gas between them, which has a packing above the mean: centres have the room within
 * half a diameter of the walls, and are at least as many beside the walls as in the middle. Standard deviation 0.8 %.
 */
static void walls(void **state) {
    (void)state;
    struct gas g = gas_make(2, 2000, 0.2, false);
    double end = 200 / impact_rate(2, 0.2), L = g.box.high[0], push = 0, room = L * L / (L - 1) / (L - 1);
    grains_advance(g.grains, end, INT64_MAX, NULL);
    const struct grain_counts *c = grains_counted(g.grains);
    for (int k = 0; k < 2; k++) push += c->wall_impulse[k][0] + c->wall_impulse[k][1];
    double p = push / end / (4 * L), mean = g.n / L / L * compressibility(2, 0.2);
    double most = g.n / L / L * room * compressibility(2, 0.2 * room);
    printf("walls: p / p(mean packing) = %.4f, at most %.4f; %lld impacts\n", p / mean, most / mean,
           (long long)c->walls);
    assert_true(p > mean && p < most);
    gas_free(&g);
}

/* The same places and velocities with another restitution */
static void change(struct gas *g, double e) {
    struct grain_law law = {.diameter = 1, .mass = 1, .restitution = e};
    grains_at(g->grains, grains_time(g->grains), g->x, g->u);
    grains_free(g->grains);
    ok(grains_make(&g->box, &law, g->n, (const double(*)[3])g->x, (const double(*)[3])g->u, 0, &g->grains));
}

/* 1/sqrt(T) of Haff's law rises linearly from 1 to sqrt 2; its slope is half the rate of cooling at T = 1, by Enskog's
 * theory in its first Sonine approximation (Garzo & Dufty, Phys. Rev. E 59 (1999) 5895). The start is an elastic gas.
 * Standard deviation 0.3 %; vortices, of which theory does not know, have taken up to 1.5 % by then. */
static void cooling(int dim, double packing) {
    struct gas g = gas_make(dim, 8000, packing, true);
    double e = 0.95, d = dim, rate = impact_rate(dim, packing);
    double a2 = 16 * (1 - e) * (1 - 2 * e * e) / (9 + 24 * d - e * (41 - 8 * d) + 30 * e * e * (1 - e));
    double nu = (dim == 2 ? 8 : 19.2) * packing / sqrt(PI); /* p / eta of the dilute gas */
    double zeta = nu * (d + 2) / (4 * d) * (1 - e * e) * contact_value(dim, packing) * (1 + 3 * a2 / 16);
    grains_advance(g.grains, 10 / rate, INT64_MAX, NULL);
    change(&g, e);
    double end = grains_advance(g.grains, 2 / zeta * (sqrt(2) - 1), INT64_MAX, NULL);
    double measured = 2 * (1 / sqrt(temperature(&g)) - 1) / end;
    printf("dim %d, alpha %.2f: rate of cooling %+.2f %% of Enskog's; T = %.4f\n", dim, packing,
           100 * (measured / zeta - 1), temperature(&g));
    assert_true(fabs(measured / zeta - 1) < 0.02);
    gas_free(&g);
}

static void coolings(void **state) {
    (void)state;
    static const double packing[] = {0.05, 0.1, 0.2, 0.3};
    for (int i = 0; i < 8; i++) cooling(2 + i / 4, packing[i % 4]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(pressures), cmocka_unit_test(walls),
                                       cmocka_unit_test(coolings)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
