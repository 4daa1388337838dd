/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts per second of the event-driven grains: bench_grains [disks|spheres|many|bed|layer|all] [impacts]. Lattices
 * with random velocities; the first tenth of the impacts melts them and is not timed. */
#include "libcore/grains/grains.h"
#include "tests/bench/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct scene {
    const char *name;
    int dim, n[3];  /* lattice cells: square with one grain, face-centred cubic with four */
    double packing; /* of the lattice */
    double restitution;
    bool bed; /* gravity 1 along -y, walls below and high above, diameter 1 */
    double T, shake;
    int64_t impacts;
};
static const struct scene scenes[] = {
    {"disks", 2, {50, 60, 1}, 0.5, 1, false, 1, 0, 3000000},
    {"spheres", 3, {15, 10, 5}, 0.26, 1, false, 1, 0, 3000000},
    {"many", 3, {36, 36, 36}, 0.26, 0.9, false, 1, 0, 2500000},
    {"bed", 3, {66, 11, 66}, 0.62, 0.9, true, 0.1, 0, 5000000},
    {"layer", 2, {314, 6, 1}, 0.76, 0.75, true, 0.1, 5.57, 3000000}, /* 2.75 g, where layers show waves */
};

static uint64_t state = 88172645463325252u;
static double uniform(void) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-53;
}

/* A lattice of the packing fraction, grains of diameter 1, and its box */
static int lattice(const struct scene *s, struct grain_box *box, double (*x)[3], double (*u)[3]) {
    static const double fcc[4][3] = {{.25, .25, .25}, {.75, .75, .25}, {.75, .25, .75}, {.25, .75, .75}};
    const double pi = 3.14159265358979323846;
    double a = s->dim == 2 ? sqrt(pi / 4 / s->packing) : cbrt(4 * pi / 6 / s->packing);
    int n = 0, basis = s->dim == 2 ? 1 : 4;
    *box = (struct grain_box){.dim = s->dim, .periodic = {true, true, true}};
    for (int k = 0; k < s->dim; k++) box->high[k] = s->n[k] * a;
    for (int cell = 0; cell < s->n[0] * s->n[1] * s->n[2]; cell++)
        for (int q = 0; q < basis; q++, n++) {
            int at[3] = {cell % s->n[0], cell / s->n[0] % s->n[1], cell / s->n[0] / s->n[1]};
            for (int k = 0; k < s->dim; k++) {
                x[n][k] = (at[k] + (s->dim == 2 ? 0.5 : fcc[q][k])) * a;
                u[n][k] = sqrt(12 * s->T) * (uniform() - 0.5);
            }
        }
    if (s->bed) {
        box->periodic[1] = false;
        for (int i = 0; i < n; i++) x[i][1] += 0.2;
        box->high[1] = s->shake > 0 ? 60 : 5 * box->high[1];
        box->shake[1] = s->shake;
        box->omega = s->shake > 0 ? sqrt(2.75 / s->shake) : 0;
        box->restitution[1][0] = box->restitution[1][1] = s->shake > 0 ? 1 : 0.9;
    }
    for (int i = n - 1; i > 0; i--) { /* in no order, as after a long run */
        int j = (int)(uniform() * (i + 1));
        for (int k = 0; k < 3; k++) {
            double swap = x[i][k];
            x[i][k] = x[j][k];
            x[j][k] = swap;
        }
    }
    return n;
}

/* Kinetic, potential and what impacts took: constant in a box at rest */
static double balance(const struct grains *g) {
    double kinetic, potential, momentum[3];
    grains_energy(g, &kinetic, &potential, momentum);
    return kinetic + potential + grains_counted(g)->lost;
}

static status run(const struct scene *s, int64_t impacts) {
    struct grain_law law = {
        .diameter = 1, .mass = 1, .restitution = s->restitution, .threshold = s->shake > 0 ? 0.03 : 1e-3};
    struct grain_box box;
    struct grains *g;
    double(*x)[3], (*u)[3];
    long most = 4L * s->n[0] * s->n[1] * s->n[2];
    if (s->bed) law.gravity[1] = -1;
    TRY(allocate(&x, most, sizeof *x, "places"));
    TRY(allocate(&u, most, sizeof *u, "velocities"));
    int n = lattice(s, &box, x, u);
    double made = cpu_seconds();
    TRY(grains_make(&box, &law, n, (const double(*)[3])x, (const double(*)[3])u, 0, &g));
    made = cpu_seconds() - made;
    const struct grain_counts *c = grains_counted(g);
    while (c->pairs < impacts / 10) grains_advance(g, HUGE_VAL, n, NULL);
    struct grain_counts old = *c;
    double energy = balance(g), seconds = cpu_seconds();
    while (c->pairs - old.pairs < impacts) grains_advance(g, HUGE_VAL, 10000, NULL);
    seconds = cpu_seconds() - seconds;
    double pairs = (double)(c->pairs - old.pairs), events = (double)(c->events - old.events);
    printf("%-8s %7d grains: %6.3f million impacts/s, %6.3f million events/s (%.2f an impact), %.0f bytes a grain, "
           "made in %.2f s, t = %.6g, lost %.17g",
           s->name, n, 1e-6 * pairs / seconds, 1e-6 * events / seconds, events / pairs, grains_bytes(n, s->dim) / n,
           made, grains_time(g), c->lost);
    if (s->shake == 0) printf(", energy changed by %.2g", balance(g) / energy - 1);
    printf("\n");
    grains_free(g);
    free(x);
    free(u);
    return OK;
}

int main(int argc, char **argv) {
    const char *which = argc > 1 ? argv[1] : "all";
    status s = OK;
    for (int i = 0; !s && i < (int)(sizeof scenes / sizeof *scenes); i++)
        if (!strcmp(which, "all") || !strcmp(which, scenes[i].name))
            s = run(&scenes[i], argc > 2 ? atoll(argv[2]) : scenes[i].impacts);
    int code = status_print(s, true);
    status_free(s);
    return code;
}
