/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous stress and heat conduction on polyhedra: order on perturbed meshes, what linear fields must do exactly, bits,
 * what must not happen; against the tiles. */
#include "libcore/polyhedral/cells.h"

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;

/* law: of disks; NULL: inelastic grains by a law for them */
static void choose(struct scene *s, int dim, const char *wall, const struct transport *law) {
    *s = (struct scene){.dim = dim, .models = law ? disks_models(law, "RKL2") : models_of(dim, "RKL2")};
    set_walls(s, wall);
}

/* dt at which an Euler step of the faster of both kinds is just stable */
static double stable(struct scene *s) {
    return 1 / fastest(s, world);
}

#define CYCLIC                                                                                                         \
    { true, true, true }
#define OPEN                                                                                                           \
    { false, false, false }

/* ---- order ---------------------------------------------------------------------------------------------------------
 */

/* The mean error of the manufactured fields: stress, heat and dilation of grains with a made-up law; or whole steps of
 * falling and cooling spheres with the law of Garzo & Dufty. */
static double driven_error(const struct cells_recipe *r, int components, bool whole, int count) {
    struct scene s;
    double error[2];
    choose(&s, r->dim, "slip", &COMPLETE);
    if (whole) {
        s.models = spheres_models(0.8, 0.5, true, "RKJ2");
        s.models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {3, -5, 2}};
        s.models.polynomial = polynomial_find("CWENO3");
    }
    s.models.components = components;
    open_cells(&s, world, r);
    drive(&s, world, whole ? OF_ALL : OF_DIFFUSION, 0.02, count, error);
    close_scene(&s);
    return error[1];
}

static void driven_gas_stays_at_second_order(void **state) {
    (void)state;
    if (comm_size(world) > 1) skip(); /* other ranks have the same bits */
    /* In whole steps the errors of convection, alone of order 2.5, and of diffusion, alone 2.1, cancel in part, and do
     * so most on coarse meshes: 3D orders rise with the number of cells (tetrahedra from 13 to 20 boxes: 1.9). */
    static const struct {
        struct cells_recipe recipe;
        int components;  /* of u: more than axes, those that the mesh does not resolve */
        int fine, count; /* steps of the coarse mesh; as many more as there are cells in a square of the fine one */
        struct {
            double order, most;
        } diffusion, whole;
    } cases[] = {
        {{"line", 1, BOXES, {32, 1, 1}, {0, 1, 2}, 0.3, CYCLIC}, 1, 128, 48, {1.9, 0.001}, {1.7, 0.0008}},
        {{"line", 1, BOXES, {32, 1, 1}, {0, 1, 2}, 0.3, CYCLIC}, 3, 128, 48, {1.9, 0.001}, {1.7, 0.0008}},
        {{"quads", 2, BOXES, {16, 16, 1}, {0, 1, 2}, 0.2, CYCLIC}, 2, 32, 48, {1.9, 0.009}, {1.9, 0.007}},
        {{"triangles", 2, PRISMS, {12, 12, 1}, {0, 1, 2}, 0.15, CYCLIC}, 2, 24, 48, {1.9, 0.01}, {1.9, 0.014}},
        {{"triangles", 2, PRISMS, {12, 12, 1}, {0, 1, 2}, 0.15, CYCLIC}, 3, 24, 48, {1.9, 0.01}, {1.9, 0.014}},
        {{"hexahedra", 3, BOXES, {8, 8, 8}, {0, 1, 2}, 0.15, CYCLIC}, 3, 12, 24, {1.9, 0.07}, {1.9, 0.045}},
        {{"mixed", 3, MIXED, {8, 8, 8}, {0, 1, 2}, 0.1, CYCLIC}, 3, 12, 24, {1.9, 0.04}, {1.65, 0.06}},
        {{"tetrahedra", 3, TETS, {9, 9, 9}, {0, 1, 2}, 0.1, CYCLIC}, 3, 15, 24, {1.6, 0.035}, {1.65, 0.035}},
    };
    for (int c = 0; c < 2 * (int)(sizeof cases / sizeof *cases); c++) {
        const bool whole = c % 2;
        struct cells_recipe fine = cases[c / 2].recipe;
        const int count = cases[c / 2].count / (whole ? 2 : 1);
        const double ratio = (double)cases[c / 2].fine / fine.n[0];
        for (int k = 0; k < fine.dim; k++) fine.n[k] = cases[c / 2].fine;
        const double coarse = driven_error(&cases[c / 2].recipe, cases[c / 2].components, whole, count),
                     error = driven_error(&fine, cases[c / 2].components, whole, (int)(ratio * ratio * count));
        const double order = log(coarse / error) / log(ratio);
        print_message("%s, %d components, %s: %.3g, %.3g: order %.2f\n", fine.name, cases[c / 2].components,
                      whole ? "whole steps" : "diffusion", coarse, error, order);
        assert_true(order > (whole ? cases[c / 2].whole.order : cases[c / 2].diffusion.order));
        assert_true(error < (whole ? cases[c / 2].whole.most : cases[c / 2].diffusion.most));
    }
}

/* ---- linear fields -------------------------------------------------------------------------------------------------
 */

static const struct cells_recipe rough[] = {
    {"quads", 2, BOXES, {12, 12, 1}, {0, 1, 2}, 0.3, OPEN},
    {"triangles", 2, PRISMS, {10, 10, 1}, {0, 1, 2}, 0.2, OPEN},
    {"tetrahedra", 3, TETS, {6, 6, 6}, {0, 1, 2}, 0.15, OPEN},
};
enum { ROUGH = sizeof rough / sizeof *rough };

/* Neither force nor heat from rigid rotation, whatever the axis and the viscosities; away from the walls, which do not
 * turn. */
static void rotation_makes_no_heat(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        struct scene s;
        double most = 0;
        choose(&s, rough[b].dim, "noSlip", &VARIED);
        turn(rough[b].dim);
        open_cells(&s, world, &rough[b]);
        start(&s, turning);
        double *before = state_of(&s, world), *after;
        shear(&s, 0.1 * stable(&s));
        after = state_of(&s, world);
        for (int i = 0; i < s.cells; i++) {
            bool near = false;
            for (int k = 0; k < s.dim; k++) near |= fabs(s.centre[3 * i + k] - 0.5) > (s.dim == 3 ? 0.1 : 0.25);
            for (int v = 0; v < s.dim + 2; v++) {
                const double change = fabs(after[v * s.cells + i] - before[v * s.cells + i]);
                if (!near && !(change < 1e-14)) fail_msg("%s: %g", rough[b].name, change);
                most = larger(most, change);
            }
        }
        assert_true(most > 1e-6); /* something was done */
        free(before);
        free(after);
        close_scene(&s);
    }
}

static void between_walls(const double x[3], double *rho, double u[3], double *T) {
    (void)u;
    *rho = 0.7;
    *T = 2 + 3 * x[0];
}

/* The steady profile between isothermal walls is linear: exact on any mesh. */
static void linear_temperature_is_steady(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        struct scene s;
        choose(&s, rough[b].dim, "noSlip", &CONSTANT);
        for (int p = 0; p < 2; p++)
            s.rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {p ? 5 : 2}};
        open_cells(&s, world, &rough[b]);
        start(&s, between_walls);
        double *before = state_of(&s, world), *after;
        spread(&s, 1, 30 * stable(&s));
        after = state_of(&s, world);
        for (int i = 0; i < (s.dim + 2) * s.cells; i++)
            if (!(fabs(after[i] - before[i]) < 1e-12)) fail_msg("%s: %g", rough[b].name, after[i] - before[i]);
        free(before);
        free(after);
        close_scene(&s);
    }
}

static const double BOUNDARY = 0.5 * (0.2 + 0.8 * 0.5); /* of layers: where a face of the graded meshes lies */
static double conductivity[2];                          /* of both layers: left, right */

/* Layers differ in density. */
static void law_of_layers(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                          double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = shear[i] = 1;
        heat[i] = conductivity[cells->rho[i] > 0.8];
    }
}
static const struct transport LAYERS = {.coefficients = law_of_layers};

/* The same heat flows through both layers, from a wall of T = 2 to one of T = 5. */
static void through_layers(const double x[3], double *rho, double u[3], double *T) {
    const double flux = 3 / (BOUNDARY / conductivity[0] + (1 - BOUNDARY) / conductivity[1]);
    (void)u;
    *rho = x[0] < BOUNDARY ? 0.7 : 0.9;
    *T = x[0] < BOUNDARY ? 2 + flux / conductivity[0] * x[0] : 5 - flux / conductivity[1] * (1 - x[0]);
}

/* The steady profile through two layers is linear in each: exact where faces do not lie in the middle between centres,
 * too, as the resistances of both ways to the face add up. */
static void layers_conduct_one_behind_the_other(void **state) {
    (void)state;
    for (int b = 0; b < 6; b++) {
        const int dim = 1 + b / 2;
        const struct cells_recipe r = {"graded",  dim, BOXES, {12, dim > 1 ? 4 : 1, dim > 2 ? 4 : 1},
                                       {0, 1, 2}, 0,   OPEN};
        struct scene s;
        conductivity[b % 2] = 1;
        conductivity[1 - b % 2] = 10;
        choose(&s, dim, "slip", &LAYERS);
        for (int p = 0; p < 2; p++)
            s.rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {p ? 5 : 2}};
        open_reshaped(&s, world, &r, true, 0);
        start(&s, through_layers);
        double *before = state_of(&s, world), *after;
        spread(&s, 1, 30 * stable(&s));
        after = state_of(&s, world);
        for (int i = 0; i < (dim + 2) * s.cells; i++)
            if (!(fabs(after[i] - before[i]) < 1e-12)) fail_msg("%d dimensions: %g", dim, after[i] - before[i]);
        free(before);
        free(after);
        close_scene(&s);
    }
}

/* Between a wall at rest, x = 0, and one that moves. */
static void sheared(const double x[3], double *rho, double u[3], double *T) {
    *rho = 0.7;
    *T = 2;
    u[1] = 3 * x[0];
}

/* What polynomials read beyond walls that drag continues the flow that friction makes there: linear, if it is. */
static void mirrors_continue_shear(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        struct scene s;
        double *U[MAX_VAR];
        int walls = 0;
        choose(&s, rough[b].dim, "noSlip", &CONSTANT);
        s.rules[1].velocity = (struct rule){.type = boundary_find("translatingWallVelocity"), .params = {{0, 3}}};
        open_cells(&s, world, &rough[b]);
        start(&s, sheared);
        const struct polyhedra *m = s.gas->cells->polyhedra;
        cells_lines(s.gas, &s.gas->U, U);
        cells_mirrors(s.gas, 0, m->face.n - m->face.ninternal, U);
        for (int i = 0; i < m->face.n - m->face.ninternal; i++) {
            const int mirror = m->ncells + i;
            double x[3] = {m->centre[0][mirror]}, rho, u[3] = {0, 0, 0}, T;
            if (m->mirror.patch[i] > 1) continue;
            sheared(x, &rho, u, &T);
            const double E = rho * (T / (s.models.material.gamma - 1) + 0.5 * u[1] * u[1]);
            walls++;
            assert_true(U[0][mirror] == rho);
            for (int k = 0; k < s.dim; k++) assert_true(fabs(U[k + 1][mirror] - rho * u[k]) < 1e-13);
            assert_true(fabs(U[s.dim + 1][mirror] - E) < 1e-13 * E);
        }
        assert_true(walls > 0 || comm_size(world) > 1);
        close_scene(&s);
    }
}

/* ---- walls with friction -------------------------------------------------------------------------------------------
 */

static struct rule rubbing(double specularity, double restitution, double along) {
    return (struct rule){
        .type = boundary_find("JohnsonJacksonSlip"), .params = {{specularity, restitution}}, .uniform = {0, along}};
}

/* Between walls x = 0 and 1 that drag gas of T = 2 with the stress of a linear velocity: exact on any mesh. */
static void linear_slip_is_steady(void **state) {
    (void)state;
    const double rho = 0.7, T = 2, rate = 3, specularity = 0.4;
    for (int b = 0; b < ROUGH; b++) {
        struct cells_recipe r = rough[b];
        struct scene s;
        double eps = T, p, square, gruneisen;
        r.cyclic[1] = r.cyclic[2] = true;
        choose(&s, r.dim, "slip", &CONSTANT);
        eps /= s.models.material.gamma - 1;
        s.models.eos->state(&s.models.material, 1, &rho, &eps, &p, &square, &gruneisen);
        const double slip = VISCOSITY * rate / (specularity * p / sqrt(2 * acos(-1) * T));
        for (int i = 0; i < 2; i++) {
            s.rules[i].velocity = rubbing(specularity, 1, i ? rate + slip : -slip);
            s.rules[i].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {T}};
        }
        open_cells(&s, world, &r);
        start(&s, sheared);
        double *before = state_of(&s, world), *after;
        shear(&s, 0.5 * stable(&s));
        after = state_of(&s, world);
        for (int i = 0; i < (s.dim + 1) * s.cells; i++)
            if (!(fabs(after[i] - before[i]) < 1e-13)) fail_msg("%s: %g", r.name, after[i] - before[i]);
        free(before);
        free(after);
        close_scene(&s);
    }
}

/* Without specularity walls slip, with all there is they hold the gas. */
static void friction_has_limits(void **state) {
    (void)state;
    for (int kind = 0; kind < 2 * ROUGH; kind++) {
        const bool full = kind % 2;
        double *end[2], most = 0;
        int numbers = 0;
        for (int i = 0; i < 2; i++) {
            struct scene s;
            choose(&s, rough[kind / 2].dim, full ? "noSlip" : "slip", NULL);
            for (int p = 0; p < 6 && i == 0; p++) s.rules[p].velocity = rubbing(full ? 1e40 : 0, 1, 0);
            open_cells(&s, world, &rough[kind / 2]);
            start(&s, manufactured_fields);
            spread(&s, 2, 20 * stable(&s));
            end[i] = state_of(&s, world);
            numbers = (s.dim + 2) * s.cells;
            close_scene(&s);
        }
        for (int i = 0; i < numbers; i++) most = larger(most, fabs(end[0][i] - end[1][i]));
        if (!(most < 1e-11)) fail_msg("%s: %g", rough[kind / 2].name, most);
        free(end[0]);
        free(end[1]);
    }
}

/* What gas that slips along a wall x = 1 gets as energy is its momentum times the wall's speed. */
static void friction_heats_the_gas(void **state) {
    (void)state;
    for (int kind = 0; kind < 2 * ROUGH; kind++) {
        const double speed = kind % 2 ? 0.7 : 0;
        struct cells_recipe r = rough[kind / 2];
        struct scene s;
        double before[MAX_VAR], after[MAX_VAR];
        r.cyclic[1] = r.cyclic[2] = true;
        choose(&s, r.dim, "slip", NULL);
        s.rules[1].velocity = rubbing(0.6, 1, speed);
        open_cells(&s, world, &r);
        start(&s, manufactured_fields);
        ok(gas_totals(s.gas, before));
        spread(&s, 4, 10 * stable(&s));
        run(&s, 2, 0.3);
        ok(gas_totals(s.gas, after));
        const int energy = r.dim + 1;
        assert_true(fabs(after[0] - before[0]) < 1e-14 * before[0]);
        assert_true(fabs(after[2] - before[2]) > 1e-7 * before[0]);
        assert_true(fabs(after[energy] - before[energy] - speed * (after[2] - before[2])) < 1e-13 * before[energy]);
        close_scene(&s);
    }
}

/* ---- against the tiles ---------------------------------------------------------------------------------------------
 */

/* The mean difference between both engines on n boxes along each axis after some time. */
static double difference(int dim, int n, const char *wall, double time) {
    const struct cells_recipe r = {"boxes", dim, BOXES, {n, dim > 1 ? n : 1, dim > 2 ? n : 1}, {0, 1, 2}, 0, OPEN};
    struct scene s[2];
    double *end[2], mean = 0;
    for (int i = 0; i < 2; i++) {
        choose(&s[i], dim, wall, &COMPLETE);
        for (int p = 0; p < 2; p++)
            s[i].rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {3}};
        s[i].rules[3].temperature = (struct rule){.type = boundary_find("granularWall"), .params = {{0.8}}};
        if (strcmp(wall, "JohnsonJacksonSlip") == 0) {
            for (int p = 0; p < 6; p++) s[i].rules[p].velocity = rubbing(0.7, 0.8, 0);
            s[i].rules[3].temperature = rubbing(0.7, 0.8, 0);
        }
        if (strcmp(wall, "noSlip") == 0)
            s[i].rules[2].velocity = (struct rule){.type = boundary_find("translatingWallVelocity"), .params = {{0.5}}};
        if (i)
            open_cells(&s[i], world, &r);
        else
            open_box(&s[i], world, dim, r.n, (double[3]){1, 1, 1}, r.cyclic, 8);
        start(&s[i], manufactured_fields);
        for (int k = 0; k < dim; k++) s[i].gas->diffusion.pull[k] = 5 - 9 * k;
        spread(&s[i], 4, time / 4);
        end[i] = state_of(&s[i], world);
    }
    for (int i = 0; i < s[0].cells; i++) {
        double nearest = HUGE_VAL;
        int same = 0; /* the cells may be in another order */
        for (int j = 0; j < s[1].cells && nearest > 1e-12; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) {
                const double off = s[1].centre[3 * j + k] - s[0].centre[3 * i + k];
                square += off * off;
            }
            if (square < nearest) same = j;
            nearest = smaller(nearest, square);
        }
        for (int v = 0; v < dim + 2; v++)
            mean += fabs(end[0][v * s[0].cells + i] - end[1][v * s[1].cells + same]) / s[0].cells;
    }
    for (int i = 0; i < 2; i++) {
        free(end[i]);
        close_scene(&s[i]);
    }
    return mean;
}

/* The same fluxes, but beside walls that drag, where those of derivatives along the wall differ by their error. */
static void boxes_are_a_lattice(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) assert_true(difference(dim, dim == 3 ? 8 : 16, "slip", 0.02) < 1e-12);
    static const char *const drags[] = {"noSlip", "JohnsonJacksonSlip"};
    for (int i = 0; i < 2; i++) {
        const double coarse = difference(2, 16, drags[i], 0.02), fine = difference(2, 32, drags[i], 0.02);
        print_message("at walls of type %s: %g, %g\n", drags[i], coarse, fine);
        assert_true(fine < 0.3 * coarse);
        assert_true(fine < 2e-3);
    }
}

/* ---- what must not happen ------------------------------------------------------------------------------------------
 */

static long repeated; /* for cells that would have become inadmissible: these, too, conserve */

static void totals_stay(const struct cells_recipe *r, const char *wall, const char *diffusion) {
    struct scene s;
    double before[MAX_VAR], after[MAX_VAR];
    choose(&s, r->dim, wall, NULL);
    s.models.diffusion = diffusion_find(diffusion);
    if (!s.models.diffusion->plan) s.models.linear = linear_module();
    open_cells(&s, world, r);
    start(&s, wild);
    ok(gas_totals(s.gas, before));
    for (int i = 0; i < 2; i++) spread(&s, 1, (diffusion[0] == 'e' ? 3 : 50) * stable(&s)); /* 50: one super step */
    ok(gas_totals(s.gas, after));
    repeated += gas_counts(s.gas).repeated;
    const double scale = before[r->dim + 1];
    assert_true(after[0] == before[0]);
    assert_true(fabs(after[r->dim + 1] - scale) < 1e-13 * scale);
    for (int k = 1; k <= r->dim && r->cyclic[0]; k++) assert_true(fabs(after[k] - before[k]) < 1e-13 * scale);
    close_scene(&s);
}

/* The implicit one is slow where ranks share cores (test_mpi_cells_implicit.c). */
static bool is_there(int scheme) {
    return diffusion_table[scheme].plan || (comm_size(world) == 1 && scheme_is_there(scheme));
}

/* In boxes that slip and that do not, and periodic: neither mass nor energy gets lost, nor momentum. */
static void totals_are_conserved(void **state) {
    (void)state;
    for (int scheme = 0; scheme < diffusion_count; scheme++)
        for (int b = 0; b < ROUGH; b++) {
            struct cells_recipe round = rough[b];
            if (!is_there(scheme)) continue;
            for (int k = 0; k < 3; k++) round.cyclic[k] = true;
            totals_stay(&rough[b], "slip", diffusion_table[scheme].model.name);
            totals_stay(&rough[b], "noSlip", diffusion_table[scheme].model.name);
            totals_stay(&round, "slip", diffusion_table[scheme].model.name);
        }
    assert_true(repeated > 0);
}

/* Heat of walls and, of spheres, of zeta_U: nothing else has changed the energy. */
static void budget_closes(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        struct scene s;
        struct gas_budget budget;
        choose(&s, rough[b].dim, "noSlip", NULL);
        if (s.dim == 3) s.models = spheres_models(0.8, 0.2, true, "RKJ2");
        s.rules[0].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {40}};
        s.rules[3].temperature = (struct rule){.type = boundary_find("granularWall"), .params = {{0.8}}};
        open_cells(&s, world, &rough[b]);
        start(&s, wild);
        ok(gas_audit(s.gas));
        run(&s, 4, 0.4);
        ok(gas_budget(s.gas, &budget));
        assert_true(fabs(budget.lost[0]) < 1e-13 * budget.mass);
        assert_true(fabs(budget.lost[1]) < 1e-13 * budget.energy);
        assert_true(fabs(budget.gained[GAS_HEAT]) > 1e-3 * budget.energy);
        assert_true((fabs(budget.gained[GAS_DILATION]) > 1e-4 * budget.energy) == (s.dim == 3));
        close_scene(&s);
    }
}

/* Whole steps, with walls, on these ranks and on one. */
static void bits_know_no_ranks(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        double *found[2];
        size_t bytes = 0;
        for (int i = 0; i < 2; i++) {
            struct scene s;
            choose(&s, rough[b].dim, "noSlip", NULL);
            if (s.dim == 3) s.models = spheres_models(0.8, 0.2, true, "RKJ2");
            s.models.source.cooling = cooling_find("Haff");
            s.rules[0].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {3}};
            s.rules[1].velocity.type = boundary_find("zeroGradient");
            s.rules[2].velocity = (struct rule){.type = boundary_find("fixedValue"), .uniform = {0.3, 0.2, 0.1}};
            open_cells(&s, i ? alone : world, &rough[b]);
            start(&s, wild);
            run(&s, 2, 0.3);
            assert_true(gas_counts(s.gas).halves >= 4);
            found[i] = state_of(&s, i ? alone : world);
            bytes = (size_t)((s.dim + 2) * s.cells) * sizeof(double);
            close_scene(&s);
        }
        assert_memory_equal(found[0], found[1], bytes);
        free(found[0]);
        free(found[1]);
    }
}

static void uniform_gas_keeps_its_bits(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++)
        for (int dilated = 0; dilated < (rough[b].dim == 3 ? 2 : 1); dilated++) {
            struct scene s;
            struct cells_recipe round = rough[b];
            for (int k = 0; k < 3; k++) round.cyclic[k] = true;
            choose(&s, round.dim, "slip", NULL);
            if (dilated) s.models = spheres_models(0.8, 0.2, true, "RKL2");
            open_cells(&s, world, &round);
            start(&s, uniform);
            double *before = state_of(&s, world);
            spread(&s, 3, 100 * stable(&s));
            double *after = state_of(&s, world);
            for (int i = 0; i < (s.dim + 2) * s.cells; i++)
                if (after[i] != before[i])
                    fail_msg("%s%s: %.17g became %.17g", round.name, dilated ? ", zeta_U" : "", before[i], after[i]);
            free(before);
            free(after);
            close_scene(&s);
        }
}

static void shaking(const double x[3], double *rho, double u[3], double *T) {
    *rho = *T = 1;
    for (int k = 0; k < 3; k++) u[k] = 1e-3 * sin(1e3 * (x[k] + 2 * x[(k + 1) % 3]));
}

/* On flat tetrahedra the operator has eigenvalues with imaginary parts of 5 % of its rate, which super steps of 127
 * stages would multiply by 19: with CELLS_STAGES_3D all modes fade. */
static void modes_do_not_grow(void **state) {
    (void)state;
    const struct cells_recipe r = {"flat", 3, TETS, {4, 4, 4}, {0, 1, 2}, 0, OPEN};
    for (int scheme = 0; scheme < 2; scheme++) {
        struct scene s;
        double before = 0, after = 0;
        choose(&s, 3, "noSlip", &CONSTANT);
        s.models.diffusion = diffusion_find(scheme ? "RKL2" : "RKJ2");
        s.mesh = cells_make(&r);
        for (int i = 0; i < 3 * s.mesh->npoints; i++) s.mesh->points[i] /= i % 3 < 2 ? i % 3 + 1 : 15;
        open_mesh(&s, world);
        start(&s, shaking);
        double *all = state_of(&s, world);
        for (int i = s.cells; i < 4 * s.cells; i++) before += all[i] * all[i];
        free(all);
        spread(&s, 20, 3200 * stable(&s));
        all = state_of(&s, world);
        for (int i = s.cells; i < 4 * s.cells; i++) after += all[i] * all[i];
        free(all);
        assert_true(gas_counts(s.gas).repeated == 0);
        assert_true(after < 1e-12 * before);
        close_scene(&s);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (!s) s = comm_alone(&alone);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(driven_gas_stays_at_second_order),
        cmocka_unit_test(rotation_makes_no_heat),
        cmocka_unit_test(linear_temperature_is_steady),
        cmocka_unit_test(layers_conduct_one_behind_the_other),
        cmocka_unit_test(mirrors_continue_shear),
        cmocka_unit_test(linear_slip_is_steady),
        cmocka_unit_test(friction_has_limits),
        cmocka_unit_test(friction_heats_the_gas),
        cmocka_unit_test(boxes_are_a_lattice),
        cmocka_unit_test(totals_are_conserved),
        cmocka_unit_test(budget_closes),
        cmocka_unit_test(bits_know_no_ranks),
        cmocka_unit_test(uniform_gas_keeps_its_bits),
        cmocka_unit_test(modes_do_not_grow),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
