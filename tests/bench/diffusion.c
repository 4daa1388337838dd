/* Nanoseconds a cell and stage of viscous stress and of heat conduction on tiles, of what a super step of 25 stages has
 * at its ends, and of a whole half step, on one core: bench_diffusion [rounds]. Disks between two walls, periodic
 * along them, disturbed everywhere. CPU time of the process, the best of the rounds. */
#include "libcore/gas/gas_private.h"
#include "tests/bench/clock.h"
#include "tests/box.h"
#include "tests/defaults.h"

#include <stdio.h>

enum { STAGES = 25 };

static status fill(struct gas *g, int nx, int ny) {
    double *all, *u[3] = {NULL};
    const long cells = (long)nx * ny;
    TRY(allocate(&all, 4 * cells, sizeof(double), "fields"));
    for (int k = 0; k < 2; k++) u[k] = all + (2 + k) * cells;
    for (long i = 0; i < cells; i++) {
        const double x = 6.283185307 * (double)(i % nx) / nx, y = 6.283185307 * (double)(i / nx) / ny;
        all[i] = 0.5 + 0.4 * sin(2 * x + y) * cos(y);
        all[cells + i] = 20 + 5 * cos(x - 2 * y);
        for (int k = 0; k < 2; k++) u[k][i] = 30 * sin(x + y + k);
    }
    status s = gas_set(g, all, (const double *const *)u, all + cells);
    free(all);
    return s;
}

/* Seconds of `super` super steps of that many stages, their last one included. */
static double time_stages(struct gas *g, enum diffusing what, int super, int stages, double dt) {
    const double start = cpu_seconds();
    for (int i = 0; i < super; i++) {
        double c[5];
        g->engine->diffusion.begin(g, what, &g->U, dt, 0);
        for (int j = 2; j <= stages; j++) {
            g->models.diffusion->stage(STAGES, j, c);
            c[2] *= dt;
            c[3] *= dt;
            c[4] = 0;
            g->engine->diffusion.stage(g, what, &g->U, c, dt);
        }
        (void)g->engine->diffusion.end(g, what, &g->U, &g->U0, dt, dt);
    }
    return cpu_seconds() - start;
}

static status time_box(const struct comm *c, int nx, int ny, int rounds) {
    struct box box;
    struct forest *f;
    struct gas *g;
    static struct patch_rules rules[6];

    struct gas_models m = {.material = {.diameter = 1, .mass = 1, .restitution = 0.75, .gamma = 2, .disks = true},
                           .eos = eos_find("TorquatoDisks"),
                           .flux = flux_find("common"),
                           .reconstruct = reconstruct_find("WENO5"),
                           .stepper = stepper_find("SSPRK3"),
                           .transport = transport_find("JenkinsRichman"),
                           .diffusion = diffusion_find("RKL2")};
    model_defaults(&m.eos->model, &m.material);
    m.transport_params = own_defaults(&m.transport->model);
    for (int p = 0; p < 6; p++) {
        rules[p].density.type = rules[p].temperature.type = boundary_find("zeroGradient");
        rules[p].velocity.type = boundary_find("slip");
    }
    box_make(&box, 2, (int[3]){nx, ny, 1}, (double[3]){2. * nx, ny, 1}, (bool[3]){true, false, false});
    TRY(forest_make(&box.lattice, &box.mesh, c, 60, &f));
    TRY(gas_make(f, &m, 6, rules, &g));
    TRY(fill(g, nx, ny));
    const double cells = (double)nx * ny;
    const int super = cells < 1e5 ? 20 : 1;
    double best[4] = {1, 1, 1, 1}, rate[2];
    for (int i = 0; i < rounds; i++) {
        const double start = cpu_seconds();
        g->engine->diffusion.rates(g, &g->U, rate);
        best[3] = smaller(best[3], cpu_seconds() - start);
        const double dt = 1 / larger(rate[0], rate[1]);
        for (int what = 0; what < 2; what++) {
            const double ends = time_stages(g, what, super, 2, dt);
            best[2] = smaller(best[2], ends / super);
            best[what] = smaller(best[what], (time_stages(g, what, super, STAGES, dt) - ends) / super / (STAGES - 2));
        }
    }
    printf("%4d x %-4d ns a cell and stage: viscous %5.2f, heat %5.2f; a super step's ends %5.2f, coefficients %5.2f\n",
           nx, ny, 1e9 * best[VISCOUS] / cells, 1e9 * best[HEAT] / cells, 1e9 * best[2] / cells, 1e9 * best[3] / cells);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    const int rounds = argc > 1 ? atoi(argv[1]) : 20;
    if (!s) s = time_box(c, 75, 60, rounds);
    if (!s && rounds < 100) s = time_box(c, 1000, 1000, rounds / 10 + 1);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
