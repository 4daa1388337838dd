/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws that ask for the shear rate get it on both engines: exact where u is linear, at walls too, whatever its axes
 * are; in steps of second order, with the same bits on any ranks and after a restart. */
#include "libcore/models/kernel.h"

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;

/* ---- laws ----------------------------------------------------------------------------------------------------------
 */

static double unit; /* 1/s: the shear rate at which the coefficients are those of CONSTANT */
static void shearing_law(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                         double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        const double part = cells->shear_rate[i] / unit;
        bulk[i] = BULK_VISCOSITY * part;
        shear[i] = VISCOSITY * part;
        heat[i] = CONDUCTION * part;
    }
}
static const struct transport SHEARING = {.needs = NEEDS_SHEAR_RATE, .coefficients = shearing_law};

static void no_law(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                   double *restrict shear, double *restrict heat) {
    (void)params;
    assert_null(cells->shear_rate); /* no law wants it */
    for (int i = 0; i < cells->n; i++) bulk[i] = shear[i] = heat[i] = 0;
}
static const struct transport NONE = {.coefficients = no_law};

/* dT/dt = -shear_rate T/4 */
static void shear_cools(const struct own_params *params, const struct closure_line *cells, double dt,
                        double *restrict eps) {
    (void)params;
    for (int i = 0; i < cells->n; i++) eps[i] *= exponential(-0.25 * cells->shear_rate[i] * dt);
}
static const struct cooling COOLING = {.needs = NEEDS_SHEAR_RATE, .step = shear_cools};

/* ---- scenes --------------------------------------------------------------------------------------------------------
 */

static double slope[3][3]; /* du_c/dx_k at [c][k] */
static int along;          /* axes of the mesh */
static double moved;       /* of a box: by so much the corners of HEXAHEDRA are moved, in less than three dimensions */
static void linear(const double x[3], double *rho, double u[3], double *T) {
    *rho = 2;
    *T = 1;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < along; k++) u[c] += slope[c][k] * (x[k] - 0.5);
}

enum shape { LATTICE, HEXAHEDRA, SIMPLICES, SHAPES };
static const char *const shape_name[] = {"lattice", "polyhedral boxes", "triangles"};

/* A unit box of 8^dim boxes, periodic along the axes from `periodic` on. */
static void open_scene(struct scene *s, const struct comm *c, enum shape shape, int dim, int periodic) {
    const bool cyclic[3] = {periodic <= 0, periodic <= 1, periodic <= 2};
    along = dim;
    if (shape == LATTICE) {
        open_box(s, c, dim, (int[3]){8, 8, 8}, (double[3]){1, 1, 1}, cyclic, 4);
        return;
    }
    struct cells_recipe r = {"", dim, shape == HEXAHEDRA ? BOXES : dim == 2 ? PRISMS : TETS, {8, 1, 1}, {0, 1, 2},
                             0,  {0}};
    for (int k = 0; k < dim; k++) r.n[k] = 8;
    r.noise = shape == HEXAHEDRA && dim < 3 ? moved : 0; /* in 3D faces would not be plane, and gradients not exact */
    memcpy(r.cyclic, cyclic, sizeof cyclic);
    open_cells(s, c, &r);
}

struct check { /* context of check_row */
    const struct gas *g;
    double wanted, margin, error; /* margin: cells nearer to the sides of the box are left out */
    int cells;
};
static void check_row(void *context, const struct row *row) {
    struct check *x = context;
    for (int i = 0; i < row->n; i++) {
        double place[3];
        bool inside = true;
        x->g->engine->state.place(x->g, row->block, row->at + i, place);
        for (int k = 0; k < x->g->dim; k++) inside = inside && fabs(place[k] - 0.5) < 0.5 - x->margin;
        if (!inside) continue;
        x->error = fmax(x->error, fabs(x->g->diffusion.shear_rate.now[row->block][row->at + i] - x->wanted));
        x->cells++;
    }
}

/* The shear rate of the linear flow is `wanted` in all cells but those nearer to the sides than `margin`. */
static void check_rate(struct scene *s, double wanted, double margin) {
    struct check x = {.g = s->gas, .wanted = wanted, .margin = margin};
    s->gas->engine->state.shear_rate(s->gas, &s->gas->U);
    s->gas->engine->state.rows(s->gas, EVERY_CELL, &s->gas->U, check_row, &x);
    double count = x.cells;
    comm_max(world, &count, 1);
    assert_true(count > 0);
    assert_near(x.error, 0, 1e-13 * wanted + 1e-15); /* round-off of differences over a cell of 1/8 */
}

static struct scene asking(const char *eos, const char *wall) {
    struct scene s = {.models = grains_models(eos, 0.9, 0.1, &SHEARING, "RKL2")};
    unit = 1;
    set_walls(&s, wall);
    return s;
}

/* ---- exact in linear flow ------------------------------------------------------------------------------------------
 */

/* sqrt(2 D':D') of the slopes along the axes of the mesh, by its definition; d: dimensions of the grains. */
static double by_definition(int dim, int d) {
    double trace = 0, sum = 0;
    for (int k = 0; k < dim; k++) trace += slope[k][k];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const double D = 0.5 * ((b < dim ? slope[a][b] : 0) + (a < dim ? slope[b][a] : 0));
            const double deviatoric = D - (a == b && a < d ? trace / d : 0);
            sum += 2 * deviatoric * deviatoric;
        }
    return sqrt(sum);
}

static void linear_flow_is_exact(void **state) {
    (void)state;
    moved = 0.2;
    static const double all[3][3] = {{0.7, -1.3, 0.4}, {2.1, -0.2, 0.9}, {-0.6, 1.1, 0.5}};
    for (enum shape shape = 0; shape < SHAPES; shape++)
        for (int dim = 1; dim <= 3; dim++)
            for (int components = dim; components <= 3; components++) {
                const bool disks = dim < 3 && components == dim;
                struct scene s = asking(disks ? "TorquatoDisks" : "TorquatoSpheres", "slip");
                if (dim == 1 && shape == SIMPLICES) continue;
                for (int c = 0; c < 3; c++)
                    for (int k = 0; k < 3; k++) slope[c][k] = c < components ? all[c][k] : 0;
                s.models.components = components;
                open_scene(&s, world, shape, dim, 3);
                start(&s, linear);
                check_rate(&s, by_definition(dim, disks ? 2 : 3), 0.27);
                close_scene(&s);
            }
}

/* A shear flow gamma y along x, turned by two angles, that rotates as a whole besides: the shear rate is |gamma|. */
static void rotated_shear_is_shear(void **state) {
    (void)state;
    moved = 0.2;
    const double gamma = -1.7, a = 0.6, b = 1.1, spin_all[3] = {0.4, -0.9, 1.3};
    for (enum shape shape = 0; shape < SHAPES; shape++)
        for (int dim = 2; dim <= 3; dim++) {
            const double tilt = dim == 3 ? b : 0;
            const double flow[3] = {cos(a), sin(a) * cos(tilt), sin(a) * sin(tilt)},
                         across[3] = {-sin(a), cos(a) * cos(tilt), cos(a) * sin(tilt)};
            struct scene s = asking("TorquatoSpheres", "slip");
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++) slope[c][k] = gamma * flow[c] * across[k];
            for (int k = 0; k < 3; k++) {
                const double turn_rate = dim == 3 || k == 2 ? spin_all[k] : 0;
                slope[(k + 2) % 3][(k + 1) % 3] += turn_rate;
                slope[(k + 1) % 3][(k + 2) % 3] -= turn_rate;
            }
            open_scene(&s, world, shape, dim, 3);
            start(&s, linear);
            check_rate(&s, -gamma, 0.27);
            close_scene(&s);
        }
}

/* Between walls that hold the gas and move with it, and between walls that it slips along: in every cell. The flow
 * leads along the next axis, which in one dimension the mesh lacks. */
static void walls_keep_the_slope(void **state) {
    (void)state;
    moved = 0.2;
    const double gamma = 1.3;
    for (enum shape shape = 0; shape < SHAPES; shape++)
        for (int dim = 1; dim <= 3; dim++)
            for (int slides = 0; slides < 2; slides++) {
                struct scene s = asking("TorquatoSpheres", "slip");
                if (dim == 1 && shape == SIMPLICES) continue;
                memset(slope, 0, sizeof slope);
                slope[1][0] = gamma;
                s.models.components = dim == 1 ? 2 : dim;
                for (int side = 0; side < 2; side++) {
                    const double w = slides ? 0 : gamma * (side - 0.5);
                    struct rule *u = &s.rules[side].velocity;
                    u->type = boundary_find(slides ? "JohnsonJacksonSlip" : "translatingWallVelocity");
                    u->params = slides ? (struct own_params){{0.3, 0.8}} : (struct own_params){{0, w, 0}};
                    if (slides) s.rules[side].temperature = *u;
                }
                open_scene(&s, world, shape, dim, 1);
                start(&s, linear);
                check_rate(&s, gamma, 0);
                close_scene(&s);
            }
}

static void uniform_gas_has_no_shear(void **state) {
    (void)state;
    for (enum shape shape = 0; shape < SHAPES; shape++) {
        struct scene s = asking("TorquatoSpheres", "slip");
        open_scene(&s, world, shape, 2, 0);
        start(&s, uniform);
        s.gas->engine->state.shear_rate(s.gas, &s.gas->U);
        for (long i = 0; i < s.gas->size; i++) assert_true(s.gas->diffusion.shear_rate.now[0][i] == 0);
        close_scene(&s);
    }
}

/* ---- what laws make of it ------------------------------------------------------------------------------------------
 */

/* A shear flow between walls that move with it, of the shear rate 1.3. */
static void open_couette(struct scene *s, const struct comm *c, enum shape shape, const struct transport *law,
                         const struct cooling *cooling) {
    *s = (struct scene){.models = disks_models(law, "RKL2")};
    s->models.source.cooling = cooling;
    unit = 1.3;
    moved = 0;
    memset(slope, 0, sizeof slope);
    slope[1][0] = unit;
    set_walls(s, "slip");
    for (int side = 0; side < 2; side++)
        s->rules[side].velocity =
            (struct rule){.type = boundary_find("translatingWallVelocity"), .params = {{0, unit * (side - 0.5), 0}}};
    open_scene(s, c, shape, 2, 1);
    start(s, linear);
}

/* A law that is proportional to the shear rate is, in this flow, the law with constant coefficients. */
static void transport_sees_the_flow(void **state) {
    (void)state;
    for (enum shape shape = 0; shape < SHAPES; shape++) {
        double *end[2];
        int numbers = 0;
        for (int i = 0; i < 2; i++) {
            struct scene s;
            open_couette(&s, world, shape, i ? &SHEARING : &CONSTANT, NULL);
            assert_true(!s.gas->diffusion.shear_rate.now == !i);
            spread(&s, 6, 0.02);
            end[i] = state_of(&s, world);
            numbers = 4 * s.cells;
            close_scene(&s);
        }
        for (int k = 0; k < numbers; k++) assert_near(end[1][k], end[0][k], 1e-12);
        free(end[0]);
        free(end[1]);
    }
}

/* T falls by exp(-shear_rate t/4), exactly, in whole steps. (On triangles the flow crosses faces, which heat it.) */
static void cooling_sees_the_flow(void **state) {
    (void)state;
    for (enum shape shape = 0; shape < SIMPLICES; shape++) {
        struct scene s;
        open_couette(&s, world, shape, &NONE, &COOLING);
        go(&s, 5, 0.002);
        double *end = state_of(&s, world);
        for (int i = 0; i < s.cells; i++) assert_near(temperature(end, 2, s.cells, i), exp(-0.25 * unit * 0.01), 1e-11);
        free(end);
        close_scene(&s);
    }
}

/* ---- whole steps ---------------------------------------------------------------------------------------------------
 */

/* Smooth and periodic, with shear everywhere: |D'| has no corner. */
static void gust(const double x[3], double *rho, double u[3], double *T) {
    const double a = TWO_PI * x[0], b = TWO_PI * x[1];
    *rho = 10 + sin(a) * cos(b);
    *T = 1 + 0.2 * cos(a);
    u[0] = 0.3 * sin(a);
    u[1] = 0.2 * sin(a + 1);
    u[2] = 0.3 * cos(a);
}

/* The state at t = 0.1. law: also of transport, or none */
static double *blown(const struct comm *c, enum shape shape, bool law, int steps, bool restarted, bool skip) {
    struct scene s = {.models = disks_models(law ? &SHEARING : &NONE, "RKL2")};
    if (!law) s.models.transport = NULL;
    unit = 10;
    moved = 0.2;
    set_walls(&s, "slip");
    s.models.source.cooling = &COOLING;
    s.models.components = 3;
    s.models.skip_uniform = skip;
    open_scene(&s, c, shape, 2, 0);
    start(&s, gust);
    go(&s, steps / 2, 0.1 / steps);
    if (restarted) {
        double *half = state_of(&s, c);
        const double *U[MAX_VAR];
        for (int v = 0; v < 5; v++) U[v] = half + v * s.cells;
        close_scene(&s);
        s.mesh = NULL;
        s.grid = NULL;
        s.forest = NULL;
        open_scene(&s, c, shape, 2, 0);
        gas_set_conserved(s.gas, U);
        free(half);
    }
    go(&s, steps - steps / 2, 0.1 / steps);
    double *all = state_of(&s, c);
    close_scene(&s);
    return all;
}

static void steps_are_of_second_order(void **state) {
    (void)state;
    const int numbers = 5 * 64;
    for (int law = 0; law < 2; law++) {
        double *fine = blown(world, LATTICE, law, 512, false, false), error[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            double *all = blown(world, LATTICE, law, 32 << k, false, false);
            for (int i = 0; i < numbers; i++) error[k] = fmax(error[k], fabs(all[i] - fine[i]));
            free(all);
        }
        free(fine);
        print_message("%s: %.3g, %.3g: order %.2f\n", law ? "transport and cooling" : "cooling", error[0], error[1],
                      log2(error[0] / error[1]));
        assert_true(log2(error[0] / error[1]) > 1.85);
    }
}

static void bits_stay(void **state) {
    (void)state;
    for (enum shape shape = 0; shape < SHAPES; shape++)
        for (int law = 0; law < 2; law++) {
            double *plain = blown(world, shape, law, 20, false, false),
                   *one = blown(alone, shape, law, 20, false, false),
                   *again = blown(world, shape, law, 20, true, false),
                   *skipped = blown(world, shape, law, 20, false, true);
            const size_t bytes = 5 * (shape == SIMPLICES ? 128 : 64) * sizeof *plain;
            print_message("%s: on all ranks as on one, after a restart, with skipUniform\n", shape_name[shape]);
            assert_memory_equal(plain, one, bytes);
            assert_memory_equal(plain, again, bytes);
            assert_memory_equal(plain, skipped, bytes);
            free(plain);
            free(one);
            free(again);
            free(skipped);
        }
}

int main(int argc, char **argv) {
    if (comm_start(&argc, &argv, &world) || comm_alone(&alone)) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_flow_is_exact),      cmocka_unit_test(rotated_shear_is_shear),
        cmocka_unit_test(walls_keep_the_slope),      cmocka_unit_test(uniform_gas_has_no_shear),
        cmocka_unit_test(transport_sees_the_flow),   cmocka_unit_test(cooling_sees_the_flow),
        cmocka_unit_test(steps_are_of_second_order), cmocka_unit_test(bits_stay),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
