/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local time steps beside SSPRK43 on polyhedra with `linear` (docs/speed.md, "Local time steps").
 *   bench_localSteps [boxes a side]: a vortex on a graded periodic mesh of triangles: CPU time, error, change of the
 * sums
 */
#include "libcore/gas/gas.h"
#include "tests/bench/clock.h"
#include "tests/defaults.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/mesh/polyhedral/cells.h" /* last */

struct subject {
    struct polymesh *mesh;
    struct comm *comm;
    struct gas_models models;
    struct patch_rules *rules; /* [patches] */
    double *centre, *volume;
    double *state[MAX_VAR]; /* conserved, in the order of the polyMesh */
};
struct result {
    double seconds;
    long steps;
    int levels;
};

static double sum_of(const struct subject *s, const double *q) {
    double sum = 0;
    for (int i = 0; i < s->mesh->ncells; i++) sum += s->volume[i] * q[i];
    return sum;
}

/* The vortex of cases/vortex, of which the mesh is 10 x 10. */
static double vortex_at(double t, const double x[2], double u[2], double *p) {
    double d[2], pi = acos(-1);
    for (int k = 0; k < 2; k++) d[k] = remainder(x[k] - 5 - t, 10);
    const double g = 5 / (2 * pi) * exp((1 - d[0] * d[0] - d[1] * d[1]) / 2), theta = 1 - g * g / 7;
    u[0] = 1 - g * d[1];
    u[1] = 1 + g * d[0];
    *p = pow(theta, 3.5);
    return pow(theta, 2.5);
}

/* Boxes from 1/4 to 7/4 of the mean width: in both directions the smallest ones in the middle. */
static status vortex_make(int side, struct subject *s) {
    const struct cells_recipe recipe = {"triangles", 2, PRISMS, {side, side, 1}, {0, 1, 2}, 0.1, {true, true, false}};
    const double length[2] = {0.1 * side, 0.2 * side}, pi = acos(-1);
    s->mesh = cells_make(&recipe);
    for (int i = 0; i < s->mesh->npoints; i++)
        for (int k = 0; k < 2; k++) {
            double *x = &s->mesh->points[3 * i + k];
            *x = 10 * (*x / length[k] + 0.75 / (2 * pi) * sin(2 * pi * *x / length[k]));
        }
    return OK;
}

static status subject_make(struct comm *c, int side, const char *stepper, struct subject *s) {
    double *face;
    s->comm = c;
    s->models =
        (struct gas_models){.material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 1.4, .alpha_max = 1},
                            .eos = eos_find("perfectGas"),
                            .flux = flux_find("common"),
                            .flux_params = own_defaults(&flux_find("common")->model),
                            .polynomial = polynomial_find("linear"),
                            .stepper = stepper_find(stepper)};
    TRY(vortex_make(side, s));
    const struct polymesh *m = s->mesh;
    TRY(allocate(&s->rules, m->npatches, sizeof *s->rules, "patches"));
    TRY(allocate(&face, 6L * m->nfaces, sizeof *face, "faces"));
    TRY(allocate(&s->centre, 4L * m->ncells, sizeof *s->centre, "cells"));
    s->volume = s->centre + 3L * m->ncells;
    polymesh_face_geometry(m, face, face + 3L * m->nfaces);
    TRY(polymesh_cell_geometry(m, face, face + 3L * m->nfaces, s->centre, s->volume));
    free(face);
    for (int v = 0; v < 4; v++) TRY(allocate(&s->state[v], m->ncells, sizeof(double), "the state"));
    for (int i = 0; i < m->ncells; i++) {
        double u[2], p;
        const double rho = vortex_at(0, s->centre + 3L * i, u, &p);
        s->state[0][i] = rho;
        for (int k = 0; k < 2; k++) s->state[k + 1][i] = rho * u[k];
        s->state[3][i] = p / 0.4 + 0.5 * rho * (u[0] * u[0] + u[1] * u[1]);
    }
    return OK;
}

static void subject_free(struct subject *s) {
    for (int v = 0; v < 4; v++) free(s->state[v]);
    free(s->centre);
    free(s->rules);
    polymesh_free(s->mesh);
}

/* Runs to `end`, where the state of the subject is then. Seconds are those of steps, without set-up. */
static status run(struct subject *s, double maxCo, double end, struct result *out) {
    struct grid *grid;
    struct gas *g;
    struct gas_speed speed;
    TRY(grid_make(NULL, s->mesh, s->centre, s->comm, 1, s->models.stepper->local, &grid));
    TRY(gas_make_polyhedral(grid, &s->models, s->mesh->npatches, s->rules, &g));
    gas_set_conserved(g, (const double *const *)s->state);
    const double clock = cpu_seconds();
    for (double t = 0, dt; t < end * (1 - 1e-12); t += dt, out->steps++) {
        gas_speed(g, &speed);
        out->levels = 1 + speed.levels;
        dt = smaller(maxCo / speed.rate, end - t);
        TRY(gas_step(g, t, &dt, maxCo, 0, 1e-3, &speed));
    }
    out->seconds = cpu_seconds() - clock;
    TRY(gas_get_conserved(g, s->state));
    gas_free(g);
    grid_free(grid);
    return OK;
}

static status vortex(struct comm *c, int side, const char *stepper, double maxCo) {
    struct subject s = {.comm = c};
    struct result r = {.steps = 0};
    double u[2], p, error = 0, before[4], drift = 0;
    TRY(subject_make(c, side, stepper, &s));
    for (int v = 0; v < 4; v++) before[v] = sum_of(&s, s.state[v]);
    TRY(run(&s, maxCo, 2, &r));
    for (int v = 0; v < 4; v++) drift = larger(drift, fabs(sum_of(&s, s.state[v]) / before[v] - 1));
    for (int i = 0; i < s.mesh->ncells; i++)
        error += s.volume[i] * fabs(s.state[0][i] - vortex_at(2, s.centre + 3L * i, u, &p));
    printf("%-8s maxCo %4g %7d triangles, levels %d: %5ld steps, %6.2f s, error %.3e, sums changed by %.0e\n", stepper,
           maxCo, s.mesh->ncells, r.levels, r.steps, r.seconds, error / 100, drift);
    subject_free(&s);
    return OK;
}

int main(int argc, char **argv) {
    static const struct {
        const char *stepper;
        double maxCo;
    } rows[] = {{"SSPRK43", 1}, {"SSPRK43", 2}, {"local", 0.5}, {"local", 1}};
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    for (int i = 0; !s && i < 4; i++) s = vortex(c, argc > 1 ? atoi(argv[1]) : 40, rows[i].stepper, rows[i].maxCo);
    const int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
