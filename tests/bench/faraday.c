/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Run time against error of the schemes of viscous stress and heat conduction over a Faraday scene, that of
 * cases/faraday in a box of 38 with one wave:
 *     bench_faraday [periods, default 7 [diffusion timeScheme maxCo]...]
 * without schemes all but `explicit`, which takes 3e5 steps a period, with SSPRK3, and RKJ2 with SSPRK43, too, all at
 * some Courant numbers; steps are at most 1.5e-3 maxCo. CPU time of the process; errors against the first scheme at a
 * small Courant number. Heights are those of the columns' centres of mass. */
#include "libcore/gas/gas.h"
#include "mesh/lattice/box.h"
#include "solvers/gas/linear.h"
#include "tests/bench/clock.h"
#include "tests/defaults.h"

#include <stdio.h>

#define PI      3.14159265358979323846
#define FINE    0.04   /* Courant number of the reference */
#define LONGEST 1.5e-3 /* step at Courant number 1 */
enum { ROWS = 60, COLUMNS = 19, CELLS = ROWS * COLUMNS, TILE = 60, MOST = 20, GROWTH = 2 };

struct scheme {
    const struct diffusion *diffusion;
    const struct stepper *stepper;
    double courant;
};

struct result {
    double mean[2 * MOST + 1]; /* height at t = n T/2 */
    double wave[2 * MOST + 1]; /* amplitude in it */
    double seconds;
    long steps;
    struct gas_counts counts;
};

static status fill(struct gas *g) {
    double *all, *u[3];
    TRY(allocate(&all, 5 * CELLS, sizeof(double), "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2 + k) * CELLS;
    for (int i = 0; i < CELLS; i++) {
        const int row = i / COLUMNS;
        const double x = (i % COLUMNS + 0.5) / COLUMNS, alpha = row < 6 ? 0.76 : row < 7 ? 0.36 : 1e-6;
        all[i] = alpha * (1 + 1e-3 * sin(2 * PI * x)) * 4 / PI;
        all[CELLS + i] = 30;
    }
    status s = gas_set(g, all, (const double *const *)u, all + CELLS);
    free(all);
    return s;
}

static status measure(const struct gas *g, double *mean, double *wave) {
    double *rho, sum[3] = {0, 0, 0};
    TRY(allocate(&rho, CELLS, sizeof *rho, "density"));
    status s = gas_field(g, GAS_RHO, (double *const[3]){rho});
    for (int i = 0; i < COLUMNS; i++) {
        double mass = 0, moment = 0, at = 2 * PI * (i + 0.5) / COLUMNS;
        for (int j = 0; j < ROWS; j++) {
            mass += rho[j * COLUMNS + i];
            moment += (j + 0.5) * rho[j * COLUMNS + i];
        }
        const double weight[3] = {1, 2 * sin(at), 2 * cos(at)};
        for (int k = 0; k < 3; k++) sum[k] += weight[k] * moment / mass / COLUMNS;
    }
    free(rho);
    *mean = sum[0];
    *wave = sqrt(sum[1] * sum[1] + sum[2] * sum[2]);
    return s;
}

static status advance(struct gas *g, int periods, double frequency, double courant, struct result *r) {
    double t = 0;
    for (int n = 0; n <= 2 * periods; n++) {
        const double end = n * 0.5 / frequency;
        while (t < end) {
            struct gas_speed speed;
            gas_speed(g, &speed);
            const double steps = ceil((end - t) * larger(speed.rate, 1 / LONGEST) / courant);
            double dt = (end - t) / steps;
            const double asked = dt;
            TRY(gas_step(g, t, &dt, courant, 1e-12, 1e-3, &speed));
            t = steps == 1 && dt == asked ? end : t + dt;
            r->steps++;
        }
        TRY(measure(g, &r->mean[n], &r->wave[n]));
    }
    return OK;
}

static struct gas_models models_of(const struct scheme *s) {
    struct gas_models m = {.material = {.diameter = 1, .mass = 1, .restitution = 0.75, .threshold = 1, .disks = true},
                           .eos = eos_find("TorquatoDisks"),
                           .flux = flux_find("common"),
                           .reconstruct = reconstruct_find("WPENO5"),
                           .stepper = s->stepper,
                           .transport = transport_find("JenkinsRichman"),
                           .diffusion = s->diffusion,
                           .source = {.cooling = cooling_find("Haff"),
                                      .gravity = {0, -981, 0},
                                      .amplitude = 2.74588290437239,
                                      .frequency = 3.5,
                                      .phase = PI / 2}};
    model_defaults(&m.eos->model, &m.material);
    m.transport_params = own_defaults(&m.transport->model);
    return m;
}

static status run(const struct comm *c, int periods, const struct scheme *s, struct result *r) {
    struct gas_models m = models_of(s);
    struct patch_rules rules[6];
    struct box box;
    struct forest *f;
    struct gas *g;
    if (!s->diffusion->plan) TRY(linear_load(&m.linear));
    memset(rules, 0, sizeof rules);
    for (int p = 0; p < 6; p++) {
        rules[p] = (struct patch_rules){.density = {.type = NULL}};
        rules[p].density.type = rules[p].temperature.type = boundary_find("zeroGradient");
        rules[p].velocity.type = boundary_find("slip");
    }
    *r = (struct result){.seconds = -cpu_seconds()};
    TRY(box_make(&box, 2, (int[3]){COLUMNS, ROWS, 1}, (double[3]){2 * COLUMNS, ROWS, 1},
                 (bool[3]){true, false, false}));
    TRY(forest_make(&box.lattice, &box.mesh, c, TILE, &f));
    TRY(gas_make(f, &m, 6, rules, &g));
    TRY(fill(g));
    TRY(advance(g, periods, m.source.frequency, s->courant, r));
    r->seconds += cpu_seconds();
    r->counts = gas_counts(g);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

/* Per period, over the last ones at t = nT. */
static double growth(const struct result *r, int periods) {
    return pow(r->wave[2 * periods] / r->wave[2 * (periods - GROWTH)], 1. / GROWTH);
}

static double worst(const struct result *r, const struct result *exact, int periods) {
    double error = 0;
    for (int n = 1; n <= 2 * periods; n++) error = fmax(error, fabs(r->mean[n] / exact->mean[n] - 1));
    return error;
}

static status row(const struct comm *c, int periods, const struct scheme *s, struct result *exact) {
    struct result r;
    TRY(run(c, periods, s, &r));
    if (!exact->steps) *exact = r;
    const double halves = larger(1, (double)r.counts.halves);
    printf("%-8s %-8s %5g %8.2f %8ld %7.1f %7.1f %8ld   %8.1e", s->diffusion->model.name, s->stepper->model.name,
           s->courant, r.seconds, r.steps, (double)r.counts.stages[0] / halves, (double)r.counts.stages[1] / halves,
           r.counts.repeated, worst(&r, exact, periods));
    if (periods > GROWTH)
        printf("  %7.4f %8.1e", growth(&r, periods), growth(&r, periods) / growth(exact, periods) - 1);
    printf("\n");
    return fflush(stdout) ? fail(ERR_SYSTEM, "output") : OK;
}

static status all_rows(const struct comm *c, int periods, struct result *exact) {
    static const double courants[] = {0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 1.6};
    for (int i = -1; i < diffusion_count; i++) {
        struct scheme s = {&diffusion_table[i < 0 ? 0 : i], stepper_find(i < 0 ? "SSPRK43" : "SSPRK3"), 0};
        if (!strcmp(s.diffusion->model.name, "explicit")) continue;
        for (int k = i < 0 ? 3 : 0; k < (i < 0 ? 7 : 5); k++) {
            s.courant = courants[k];
            TRY(row(c, periods, &s, exact));
        }
    }
    return OK;
}

static status bench(const struct comm *c, int argc, char **argv) {
    const int periods = argc > 1 ? atoi(argv[1]) : 7;
    struct result exact = {.steps = 0};
    if (periods < 1 || periods > MOST) return fail(ERR_INPUT, "periods: 1 .. %d", MOST);
    printf(
        "diffusion and timeScheme, maxCo, CPU s, steps, stages of stress, of heat, repeated, error of heights, growth, "
        "its error\n");
    TRY(row(c, periods, &(struct scheme){&diffusion_table[0], stepper_find("SSPRK3"), FINE}, &exact));
    if (argc < 3) return all_rows(c, periods, &exact);
    for (int i = 2; i + 2 < argc; i += 3) {
        const struct scheme s = {diffusion_find(argv[i]), stepper_find(argv[i + 1]), atof(argv[i + 2])};
        if (!s.diffusion || !s.stepper) return fail(ERR_INPUT, "no such scheme: %s %s", argv[i], argv[i + 1]);
        TRY(row(c, periods, &s, &exact));
    }
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    if (!s) s = bench(c, argc, argv);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
