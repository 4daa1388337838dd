/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Million cell-stages per second and rank of the polyhedral engine, beside the tiles on the same mesh of quads, whose
 * second-order time per cell is the measure: bench_polyhedral [boxes a side, default 316] [steps [words]]. On two ranks
 * (mpirun -np 2) the same figures show how well it scales: 2 x 316 x 316 are 200,000 triangles. Of the words behind
 * these `rules` turns the rules of single faces on; others (`triangles`, `linear`) choose the rows that have them all.
 *
 * The gas of bench_throughput: disturbed everywhere, with cooling and gravity, periodic; the fastest of the steps, CPU
 * time of this process. */
#include "libcore/gas/gas.h"
#include "tests/bench/clock.h"
#include "tests/defaults.h"

#include "tests/mesh/polyhedral/cells.h" /* last */

struct scheme {
    const char *name;
    enum cell_shape shape;
    int dim;
    const char *polynomial; /* NULL: PHM on tiles */
};
struct subject {
    struct polymesh *mesh;
    double *centre, *volume;
    struct grid *grid;
    struct gas *gas;
};

static struct own_params common_params(bool rules) {
    const struct model *m = &flux_find("common")->model;
    struct own_params own = own_defaults(m);
    for (int i = 0; i < m->nparam; i++) model_put(m, &own, m->param[i].name, rules);
    return own;
}

static status subject_make(const struct scheme *k, const struct comm *c, int side, bool rules, struct subject *s) {
    static struct patch_rules none[6];
    const struct cells_recipe recipe = {
        k->name, k->dim, k->shape, {side, side, k->dim > 2 ? side : 1}, {0, 1, 2}, 0, {true, true, k->dim > 2}};
    const struct gas_models models = {
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.97, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux_find("common"),
        .flux_params = common_params(rules),
        .reconstruct = reconstruct_find("PHM"),
        .polynomial = polynomial_find(k->polynomial ? k->polynomial : "linear"),
        .stepper = stepper_find("SSPRK3"),
        .source = {.cooling = cooling_find("Haff"), .gravity = {980, -980, 0}}};
    struct lattice *lattice = NULL;
    double *face;
    char why[256];
    s->mesh = cells_make(&recipe);
    TRY(allocate(&face, 6L * s->mesh->nfaces, sizeof *face, "faces"));
    TRY(allocate(&s->centre, 4L * s->mesh->ncells, sizeof *s->centre, "cells"));
    s->volume = s->centre + 3L * s->mesh->ncells;
    polymesh_face_geometry(s->mesh, face, face + 3L * s->mesh->nfaces);
    status measured = polymesh_cell_geometry(s->mesh, face, face + 3L * s->mesh->nfaces, s->centre, s->volume);
    free(face);
    TRY(measured);
    if (!k->polynomial) TRY(lattice_recognise(s->mesh, &lattice, why));
    TRY(grid_make(lattice, s->mesh, s->centre, c, models.polynomial->rings, false, &s->grid));
    lattice_free(lattice);
    if (k->polynomial) return gas_make_polyhedral(s->grid, &models, 6, none, &s->gas);
    return gas_make(s->grid->forest, &models, 6, none, &s->gas);
}

static void subject_free(struct subject *s) {
    gas_free(s->gas);
    grid_free(s->grid);
    free(s->centre);
    polymesh_free(s->mesh);
}

static status fill(const struct subject *s, int dim, int side) {
    long n = s->mesh->ncells;
    double *all, *u[3];
    TRY(allocate(&all, 5 * n, sizeof *all, "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2 + k) * n;
    for (long i = 0; i < n; i++) {
        double x = 62.83185307 * s->centre[3 * i] / side, y = 31.41592654 * s->centre[3 * i + 1] / side;
        all[i] = 200 + 60 * sin(2 * x + y);
        all[n + i] = 20 + 5 * cos(x - 2 * y);
        for (int k = 0; k < dim; k++) u[k][i] = 30 * sin(x + y + k) + 5;
    }
    status e = gas_set(s->gas, all, (const double *const *)u, all + n);
    free(all);
    return e;
}

static status time_scheme(const struct scheme *k, const struct comm *c, int side, int steps, bool rules) {
    struct subject s = {0};
    double t = 0, best = HUGE_VAL;
    TRY(subject_make(k, c, side, rules, &s));
    TRY(fill(&s, k->dim, side));
    for (int i = -1; i < steps; i++) { /* the first one warms up */
        double start = cpu_seconds();
        struct gas_speed speed;
        gas_speed(s.gas, &speed);
        double dt = 0.5 / speed.rate;
        TRY(gas_step(s.gas, t, &dt, 0.5, 0, 1e-3, &speed));
        t += dt;
        if (i >= 0) best = fmin(best, cpu_seconds() - start);
    }
    comm_max(c, &best, 1);
    if (comm_root(c))
        printf("%-10s %-18s %7d cells: %6.2f M cell-stages/s and rank\n", k->name,
               k->polynomial ? k->polynomial : "tiles, PHM", s.mesh->ncells,
               3e-6 * s.mesh->ncells / comm_size(c) / best);
    subject_free(&s);
    return OK;
}

/* Does the row of a scheme have all the words, but for `rules`? */
static bool wanted(const struct scheme *k, int n, char **word) {
    for (int i = 0; i < n; i++)
        if (strcmp(word[i], "rules") != 0 && strcmp(word[i], k->name) != 0 &&
            strcmp(word[i], k->polynomial ? k->polynomial : "PHM") != 0)
            return false;
    return true;
}

int main(int argc, char **argv) {
    static const struct scheme schemes[] = {{"quads", BOXES, 2, NULL},          {"quads", BOXES, 2, "linear"},
                                            {"quads", BOXES, 2, "CWENO3"},      {"triangles", PRISMS, 2, "linear"},
                                            {"triangles", PRISMS, 2, "CWENO3"}, {"hexahedra", BOXES, 3, "linear"},
                                            {"tetrahedra", TETS, 3, "linear"},  {"tetrahedra", TETS, 3, "CWENO3"}};
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    int side = argc > 1 ? atoi(argv[1]) : 316, steps = argc > 2 ? atoi(argv[2]) : 8;
    bool rules = false;
    for (int i = 3; i < argc; i++) rules |= strcmp(argv[i], "rules") == 0;
    for (int i = 0; !s && i < (int)(sizeof schemes / sizeof *schemes); i++)
        if (wanted(&schemes[i], argc - 3, argv + 3))
            s = time_scheme(&schemes[i], c, schemes[i].dim < 3 ? side : side / 11, steps, rules);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
