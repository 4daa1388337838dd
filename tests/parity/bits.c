/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints a checksum of the state after some steps, for every flux and reconstruction in 1D, 2D and 3D, and for every
 * polynomial on triangles and tetrahedra; of flows that need the limiter; last of grains and their fields. CTest
 * compares what the program prints when it is built with clones for the machine's vectors, and without them at -O0. */
#include "libcore/gas/gas.h"
#include "libcore/grains/coarse.h"
#include "libcore/grains/packing.h"
#include "mesh/lattice/box.h"
#include "tests/defaults.h"

#include <stdio.h>

#include "tests/mesh/polyhedral/cells.h" /* last: cmocka.h defines fail() */

static bool harsh; /* which start */

static void splash(int i, const int n[3], double *rho, double *T, double u[3]) {
    double x = (double)(i % n[0]) / n[0], y = (double)(i / n[0] % n[1]) / n[1], z = (double)(i / n[0] / n[1]) / n[2];
    bool inside = (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) < 0.07; /* no libm: the start has the same bits, too */
    *rho = (inside ? 700 : 100) + 40 * x * (1 - x) + 90 * y * z;
    *T = inside ? 3 : 1 + x;
    for (int k = 0; k < 3; k++) u[k] = 8 * (x - 0.5) * (y - 0.3) + (k == 0 ? 4 * (z - 0.4) : y);
}

/* Lumps near packing that fly at Mach 5000 into each other through a near vacuum. */
static void lumps(int i, const int n[3], double *rho, double *T, double u[3]) {
    double x = (double)(i % n[0]) / n[0], y = (double)(i / n[0] % n[1]) / n[1];
    *rho = x > 0.4 && x < 0.6 ? 1100 : 1e-3;
    *T = 1e-6;
    for (int k = 0; k < 3; k++) u[k] = k == 0 ? (x < 0.5 ? 5 : -5) : 3 * x * y;
}

static uint64_t sum_of(long n, const double *v) {
    uint64_t sum = 1469598103934665603u; /* FNV-1a */
    for (long i = 0; i < n; i++) sum = (sum ^ bits_of(v[i])) * 1099511628211u;
    return sum;
}

static status checksum(const struct gas *g, int cells, uint64_t *sum) {
    double *all, *U[MAX_VAR];
    TRY(allocate(&all, (long)MAX_VAR * cells, sizeof *all, "the state"));
    for (int v = 0; v < MAX_VAR; v++) U[v] = all + (long)v * cells;
    status s = gas_get_conserved(g, U);
    *sum = sum_of((long)gas_variables(g) * cells, all);
    free(all);
    return s;
}

static status fill(struct gas *g, int cells, const int n[3]) {
    double *all, *u[3], v[3];
    TRY(allocate(&all, 5L * cells, sizeof *all, "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2L + k) * cells;
    for (int i = 0; i < cells; i++) {
        (harsh ? lumps : splash)(i, n, &all[i], &all[cells + i], v);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    status s = gas_set(g, all, (const double *const *)u, all + cells);
    free(all);
    return s;
}

static status advance(struct gas *g) {
    double t = 0;
    for (int i = 0; i < 4; i++) {
        struct gas_speed speed;
        gas_speed(g, &speed);
        double dt = 0.4 / speed.rate;
        TRY(gas_step(g, t, &dt, 0.4, 0, 0, &speed));
        t += dt;
    }
    return OK;
}

static struct gas_models models_of(const struct flux *flux) {
    return (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux,
        .flux_params = own_defaults(&flux->model),
        .stepper = stepper_find("SSPRK3"),
        .source = {.cooling = cooling_find("Haff"), .gravity = {10, -20, 30}}};
}

static status print_scheme(const struct comm *c, int dim, const struct flux *flux, const struct reconstruct *r) {
    struct box box;
    struct forest *f;
    struct gas *g;
    uint64_t sum = 0;
    int n[3] = {dim == 1 ? 100 : dim == 2 ? 22 : 14, dim == 1 ? 1 : dim == 2 ? 18 : 7, dim > 2 ? 6 : 1};
    TRY(box_make(&box, dim, n, (double[3]){1, 1, 1}, (bool[3]){true, true, true}));
    struct gas_models m = models_of(flux);
    m.reconstruct = r;
    m.material.threshold = dim == 2 ? 2 : 0; /* both sinks */
    TRY(forest_make(&box.lattice, &box.mesh, c, 12, &f));
    TRY(gas_make(f, &m, 0, NULL, &g));
    TRY(fill(g, box.mesh.ncells, n));
    TRY(advance(g));
    TRY(checksum(g, box.mesh.ncells, &sum));
    if (harsh && !gas_counts(g).faces) return (fail)(ERR_STATE, "nothing was limited");
    if (comm_root(c)) printf("%dD %s %s %016llx\n", dim, flux->model.name, r->model.name, (unsigned long long)sum);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

static struct gas_models disks_of(const struct diffusion *diffusion) {
    struct gas_models m = models_of(flux_find("common"));
    m.material = (struct material){.diameter = 0.036,
                                   .mass = 1,
                                   .restitution = 0.9,
                                   .gamma = 2,
                                   .alpha_max = 0.82,
                                   .disks = true,
                                   .freezing = 0.69,
                                   .smoothing = 0.01};
    m.eos = eos_find("TorquatoDisks");
    m.transport = transport_find("JenkinsRichman");
    m.transport_params = own_defaults(&m.transport->model);
    m.diffusion = diffusion;
    return m;
}

/* Inelastic spheres with all terms of their transport. */
static struct gas_models spheres_of(const struct diffusion *diffusion) {
    struct gas_models m = models_of(flux_find("common"));
    m.eos = eos_find("TorquatoSpheres");
    model_defaults(&m.eos->model, &m.material);
    m.transport = transport_find("GarzoDufty");
    m.transport_params = own_defaults(&m.transport->model);
    model_put(&m.transport->model, &m.transport_params, "zetaU", 2);
    m.diffusion = diffusion;
    return m;
}

/* Walls that hold the gas, those around spheres (`takes`) also take heat. */
static void viscous_walls(bool takes, struct patch_rules walls[6]) {
    for (int k = 0; k < 6; k++) {
        walls[k] =
            (struct patch_rules){.density = {.type = boundary_find("zeroGradient")},
                                 .velocity = {.type = boundary_find("noSlip")},
                                 .temperature = {.type = boundary_find(takes ? "granularWall" : "zeroGradient")}};
        walls[k].temperature.params.room[0] = 0.8; /* restitution */
    }
}

/* Disks or spheres with viscosity and heat conduction. */
static status print_diffusion(const struct comm *c, int dim, bool spheres, const struct diffusion *diffusion) {
    struct box box;
    struct forest *f;
    struct gas *g;
    uint64_t sum = 0;
    int n[3] = {dim == 1 ? 100 : dim == 2 ? 22 : 14, dim == 1 ? 1 : dim == 2 ? 18 : 7, dim > 2 ? 6 : 1};
    struct patch_rules walls[6];
    viscous_walls(spheres, walls);
    TRY(box_make(&box, dim, n, (double[3]){1, 1, 1}, (bool[3]){true, false, false}));
    struct gas_models m = spheres ? spheres_of(diffusion) : disks_of(diffusion);
    m.reconstruct = reconstruct_find("WENO5");
    TRY(forest_make(&box.lattice, &box.mesh, c, 12, &f));
    TRY(gas_make(f, &m, 6, walls, &g));
    TRY(fill(g, box.mesh.ncells, n));
    TRY(advance(g));
    TRY(checksum(g, box.mesh.ncells, &sum));
    if (comm_root(c))
        printf("%dD %s %s %016llx\n", dim, m.transport->model.name, diffusion->model.name, (unsigned long long)sum);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

static status print_polynomial(const struct comm *c, const struct cells_recipe *r, const struct polynomial *p,
                               const struct diffusion *diffusion) {
    struct polymesh *mesh = cells_make(r);
    const bool spheres = diffusion && r->dim == 3;
    struct patch_rules walls[6];
    struct grid *grid;
    struct gas *g;
    uint64_t sum = 0;
    struct gas_models m = spheres     ? spheres_of(diffusion)
                          : diffusion ? disks_of(diffusion)
                                      : models_of(flux_find("common"));
    m.polynomial = p;
    viscous_walls(spheres, walls);
    for (int k = 0; k < 6 && !diffusion; k++) walls[k].velocity.type = boundary_find("slip");
    TRY(grid_make(NULL, mesh, NULL, c, p->rings, false, &grid));
    TRY(gas_make_polyhedral(grid, &m, 6, walls, &g));
    TRY(fill(g, mesh->ncells, (int[3]){mesh->ncells, 1, 1}));
    TRY(advance(g));
    TRY(checksum(g, mesh->ncells, &sum));
    if (harsh && !gas_counts(g).faces) return (fail)(ERR_STATE, "nothing was limited");
    if (comm_root(c))
        printf("%s %s %s %016llx\n", r->name, p->model.name, diffusion ? diffusion->model.name : "",
               (unsigned long long)sum);
    gas_free(g);
    grid_free(grid);
    polymesh_free(mesh);
    return OK;
}

/* Grown from small ones, on a shaken floor, with impacts and places summed on cells. */
static status print_grains(const struct comm *c, int dim, enum coarse_kernel kernel) {
    enum { GRAINS = 400 };
    static double x[GRAINS][3], u[GRAINS][3];
    const double side = dim == 2 ? 26 : 8;
    struct grain_box box = {
        .dim = dim, .high = {side, side, side}, .periodic = {true, false, true}, .omega = 3, .phase = 1};
    const struct grain_law law = {
        .diameter = 1, .mass = 1, .restitution = 0.9, .threshold = 0.01, .gravity = {0, -1, 0}};
    const struct coarse_grid cells = {.dim = dim,
                                      .n = {9, 9, dim == 2 ? 1 : 9},
                                      .h = {side / 9, side / 9, side / 9},
                                      .periodic = {true, false, true},
                                      .kernel = kernel,
                                      .width = 1.3,
                                      .mass = 1,
                                      .diameter = 1};
    const double T = 1;
    const struct packing_field start = {.n = {1, 1, 1}, .T = &T};
    struct packing_report report;
    struct grains *g;
    struct coarse *sums;
    TRY(packing_places(&box, law.diameter, &start, GRAINS, 7, x, &report));
    packing_velocities(&box, &start, GRAINS, 7, (const double(*)[3])x, u);
    box.restitution[1][0] = box.restitution[1][1] = 0.8;
    box.shake[1] = 0.3;
    TRY(grains_make(&box, &law, GRAINS, (const double(*)[3])x, (const double(*)[3])u, 0, &g));
    TRY(coarse_make(&cells, &sums));
    for (int i = 1; i <= 20; i++) {
        while (grains_time(g) < 0.25 * i) grains_advance(g, 0.25 * i, 1000, coarse_observer(sums));
        grains_at(g, 0.25 * i, x, u);
        coarse_sample(sums, GRAINS, (const double(*)[3])x, (const double(*)[3])u, NULL);
    }
    if (comm_root(c))
        printf("grains %d %d %ld impacts %016llx %016llx\n", dim, (int)kernel, (long)grains_counted(g)->pairs,
               (unsigned long long)sum_of(3L * GRAINS, x[0]),
               (unsigned long long)sum_of(coarse_size(sums), coarse_sums(sums)));
    coarse_free(sums);
    grains_free(g);
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    for (int dim = 1; dim <= 3; dim++)
        for (int f = 0; f < flux_count; f++)
            for (int r = 0; r < reconstruct_count && !s; r++)
                s = print_scheme(c, dim, &flux_table[f], &reconstruct_table[r]);
    for (int dim = 1; dim <= 3; dim++)
        for (int i = 0; i < diffusion_count && !s; i++)
            if (diffusion_table[i].plan) s = print_diffusion(c, dim, dim == 3, &diffusion_table[i]);
    static const struct cells_recipe meshes[] = {
        {"triangles", 2, PRISMS, {34, 34, 1}, {0, 1, 2}, 0.2, {false, true, false}},
        {"tetrahedra", 3, TETS, {7, 7, 7}, {0, 1, 2}, 0.1, {false, true, false}}};
    for (int i = 0; i < 2; i++)
        for (int p = 0; p < polynomial_count && !s; p++)
            s = print_polynomial(c, &meshes[i], &polynomial_table[p], NULL);
    for (int i = 0; i < 2 && !s; i++)
        s = print_polynomial(c, &meshes[i], polynomial_find("linear"), diffusion_find("RKL2"));
    harsh = true;
    for (int dim = 1; dim <= 3 && !s; dim++) s = print_scheme(c, dim, flux_find("common"), reconstruct_find("WENO5"));
    for (int i = 0; i < 2 && !s; i++) s = print_polynomial(c, &meshes[i], polynomial_find("CWENO3"), NULL);
    for (int dim = 2; dim <= 3; dim++)
        for (int k = COARSE_CELL; k <= COARSE_GAUSSIAN && !s; k++) s = print_grains(c, dim, (enum coarse_kernel)k);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
