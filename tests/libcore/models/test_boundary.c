/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every boundary type: the ghost values it makes of a line of cells, and what walls do to a gas with transport. */
#include "tests/libcore/oracle.h"

#include "libcore/models/boundary.h"

static void ghosts_of(const char *name, int components, int normal, const double values[][3], double out[3][4]) {
    static const double x[] = {1, -2, 3, 4}, y[] = {5, 6, -7, 8}, z[] = {-9, 10, 11, 12}, outflow[] = {1, -1, 0, -2};
    static const double rho[] = {1, 2, 4, 8};
    static const int face[] = {3, 2, 1, 0};
    struct rule rule = {.type = boundary_find(name), .uniform = {70, 80, 90}, .values = values ? &values[0][0] : NULL};
    struct ghost_line line = {.n = 4,
                              .components = components,
                              .face = face,
                              .inner = {x, y, z},
                              .outflow = outflow,
                              .rho = rho,
                              .normal = normal,
                              .ghost = {out[0], out[1], out[2]}};
    rule.type->ghost(&rule, &line);
}

static void check(double out[3][4], int c, double a, double b, double d, double e) {
    const double expected[] = {a, b, d, e};
    for (int i = 0; i < 4; i++) assert_true(out[c][i] == expected[i]);
}

static void walls(void **state) {
    (void)state;
    double out[3][4];
    for (int k = 0; k < boundary_count; k++) {
        if (!boundary_table[k].wall) continue;
        const char *name = boundary_table[k].model.name;
        const struct patch_rules wall = {.velocity = {.type = &boundary_table[k]}};
        const bool whole = wall_holds(&wall); /* gas that sticks to the wall turns round, other gas is mirrored */
        ghosts_of(name, 3, 1, NULL, out);
        check(out, 1, -5, -6, 7, -8);
        if (whole)
            check(out, 0, -1, 2, -3, -4);
        else
            check(out, 0, 1, -2, 3, 4);
        if (boundary_table[k].scalar) {
            ghosts_of(name, 1, -1, NULL, out);
            check(out, 0, 1, -2, 3, 4);
        }
    }
}

static void open_ends(void **state) {
    (void)state;
    double out[3][4];
    ghosts_of("zeroGradient", 2, 0, NULL, out);
    check(out, 1, 5, 6, -7, 8);
    ghosts_of("fixedValue", 3, 0, NULL, out);
    check(out, 2, 90, 90, 90, 90);
    ghosts_of("inletOutlet", 2, 0, NULL, out); /* outflow > 0, < 0, = 0, < 0 */
    check(out, 0, 1, 70, 3, 70);
    check(out, 1, 5, 80, -7, 80);
    ghosts_of("flowRateInletVelocity", 2, 0, NULL, out); /* the values are rho u */
    check(out, 0, 70, 35, 17.5, 8.75);
    check(out, 1, 80, 40, 20, 10);
}

/* Where values change in time ghosts lie on a line through the value on the patch, 70, 80, 90 here, unless the cells
 * disagree; scalars keep half of it. */
static void slopes(void **state) {
    (void)state;
    static const double first[] = {72, 72, 72, 60}, second[] = {80, 73, 71, 10}, outflow[] = {-1, -1, -1, 1};
    static const int face[] = {0, 0, 0, 0};
    static const char *const names_of[] = {"fixedValue", "uniformFixedValue", "exprFixedValue", "inletOutlet"};
    for (int k = 0; k < 4; k++) {
        double out[4];
        struct rule rule = {.type = boundary_find(names_of[k]), .uniform = {70}, .changes = true};
        struct ghost_line line = {.n = 4,
                                  .components = 1,
                                  .face = face,
                                  .inner = {first},
                                  .outflow = outflow,
                                  .layer = 2,
                                  .next = {second},
                                  .normal = -1,
                                  .ghost = {out}};
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 70 - 3 * 2 && out[1] == 70 - 3 * 0.5 && out[2] == 70);
        assert_true(out[3] == (k == 3 ? 60 : 70 + 3 * 10));
        line.next[0] = NULL; /* no second cell is known */
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 64 && out[1] == 64 && out[2] == 64);
        line.layer = 0; /* on the patch */
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 70 && out[1] == 70 && out[2] == 70);
        line.layer = 2;
        rule.changes = false; /* values that stay are the state beyond, at any distance */
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 70 && out[1] == 70 && out[2] == 70);
        rule = (struct rule){.type = rule.type, .uniform = {1}, .changes = true};
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 0.5);
        rule.uniform[0] = 300;
        rule.type->ghost(&rule, &line);
        assert_true(out[0] == 450);
    }
}

/* A row whose values a case gives in another way has the functions of the row with lists. */
static void values_by_rules(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"uniformFixedValue", "fixedValue"}, {"exprFixedValue", "fixedValue"}, {"uniformInletOutlet", "inletOutlet"}};
    for (int i = 0; i < 3; i++) {
        const struct boundary_type *a = boundary_find(pairs[i][0]), *b = boundary_find(pairs[i][1]);
        assert_true(a->giving != BY_LIST && b->giving == BY_LIST);
        assert_true(a->ghost == b->ghost && a->heat == b->heat && a->temperature == b->temperature && !a->wall);
    }
}

/* Only a patch that gives mass feeds; then its values are that mass, along each axis. */
static void feeding(void **state) {
    (void)state;
    const double values[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
    for (int k = 0; k < boundary_count; k++) {
        const struct patch_rules r = {.velocity = {.type = &boundary_table[k], .values = values[0]}};
        assert_int_equal(patch_feeds(&r), boundary_table[k].giving == BY_RATE);
        if (patch_feeds(&r)) assert_true(patch_feed(&r, 3, 2, 1) == 8);
    }
    assert_false(patch_feeds(&(struct patch_rules){.pressure = false})); /* an empty patch */
}

/* By volume the mass is rho u. A patch that shuts lets nothing through faces where its velocity is 0, nor where that
 * leads along them, unless the whole state is given, that of the gas outside. */
static void feeding_faces(void **state) {
    (void)state;
    const double values[4][3] = {{2, 5, 1}, {0, 5, 1}, {0, 0, 0}, {-3, 0, 0}}, into[] = {2, 0, 0, -3},
                 rho[] = {7, 7, 7, 7};
    const struct boundary_type *rate = boundary_find("flowRateInletVelocity"), *fixed = boundary_find("fixedValue"),
                               *free = boundary_find("zeroGradient");
    const struct {
        struct rule velocity, density;
        double want[4];
    } row[] = {{{.type = rate}, {.type = fixed}, {2, 0, 0, -3}},
               {{.type = rate, .volume = true}, {.type = free}, {14, 0, 0, -21}},
               {{.type = fixed, .shuts = true}, {.type = free}, {40, 0, 0, 43}},
               {{.type = fixed, .shuts = true}, {.type = fixed}, {40, 41, 0, 43}}};
    for (int k = 0; k < 4; k++) {
        struct patch_rules r = {.velocity = row[k].velocity, .density = row[k].density, .temperature = {.type = fixed}};
        double flux[] = {40, 41, 42, 43};
        r.velocity.values = values[0];
        assert_true(patch_feeds(&r));
        patch_feed_mass(&r, 3, 4, (const int[]){0, 1, 2, 3}, into, rho, flux);
        for (int i = 0; i < 4; i++) assert_true(flux[i] == row[k].want[i]);
    }
}

/* A wall that does not move alike everywhere has values, which count before its parameter. */
static void moving_walls(void **state) {
    (void)state;
    const double values[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
    struct patch_rules r = {.velocity = {.type = boundary_find("translatingWallVelocity"), .params = {{21, 22, 23}}}};
    double w[3];
    wall_velocity(&r, 3, 2, w);
    assert_true(w[0] == 21 && w[1] == 22 && w[2] == 23);
    r.velocity.values = values[0];
    wall_velocity(&r, 3, 2, w);
    assert_true(w[0] == 7 && w[1] == 8 && w[2] == 9);
    r.velocity.type = boundary_find("rotatingWallVelocity"); /* has values alone */
    wall_velocity(&r, 3, 3, w);
    assert_true(w[0] == 10 && w[1] == 11 && w[2] == 12 && wall_holds(&r) && wall_works(&r) && !rule_holds(&r.velocity));
    for (int k = 0; k < boundary_count; k++) {
        const char *name = boundary_table[k].model.name;
        assert_true(boundary_rotates(&boundary_table[k]) ==
                    (!strcmp(name, "rotatingWallVelocity") || !strcmp(name, "frictionalSlip") ||
                     !strcmp(name, "JohnsonJacksonSlip")));
    }
}

static void values_per_face(void **state) {
    (void)state;
    const double values[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
    double out[3][4];
    ghosts_of("fixedValue", 3, 0, values, out);
    check(out, 0, 10, 7, 4, 1);
    check(out, 2, 12, 9, 6, 3);
}

static void names(void **state) {
    (void)state;
    assert_int_equal(boundary_count, 16); /* a new row needs its test here */
    for (int k = 0; k < boundary_count; k++) {
        assert_ptr_equal(boundary_find(boundary_table[k].model.name), &boundary_table[k]);
        assert_true(boundary_table[k].scalar || boundary_table[k].vector);
    }
    assert_null(boundary_find("wall"));
}

/* What a case must give for each row fits the room of a rule: numbers and vectors, with a range. */
static void parameters(void **state) {
    (void)state;
    for (int k = 0; k < boundary_count; k++)
        for (int i = 0; i < boundary_table[k].model.nparam; i++) {
            const struct param *p = &boundary_table[k].model.param[i];
            const size_t size = p->kind == PARAM_VECTOR ? 3 * sizeof(double) : sizeof(double);
            assert_true(p->kind == PARAM_VECTOR || p->kind == PARAM_NUMBER);
            assert_true(p->offset % sizeof(double) == 0 && p->offset + size <= sizeof(struct own_params));
            assert_true(p->low < p->high);
        }
}

/* Packed gas: muWall of the velocity or else of the temperature; without it walls that drag are rough. */
static void friction_of_packed_gas(void **state) {
    (void)state;
    const struct {
        const char *U, *T;
        double of_U[4], of_T[4], mu; /* of_U: parameters in the order of the row's struct */
    } walls[] = {{"slip", "zeroGradient", {0}, {0}, 0},
                 {"noSlip", "fixedValue", {0}, {0}, HUGE_VAL},
                 {"translatingWallVelocity", "zeroGradient", {1, 0, 0}, {0}, HUGE_VAL},
                 {"frictionalSlip", "zeroGradient", {1, 2, 3, 0.3}, {0}, 0.3},
                 {"frictionalSlip", "granularWall", {0, 0, 0, 0}, {0.9, 0.4}, 0},
                 {"JohnsonJacksonSlip", "fixedValue", {0.5, 0.9, 0.25}, {0}, 0.25},
                 {"JohnsonJacksonSlip", "fixedValue", {0.5, 0.9, -1}, {0}, HUGE_VAL},
                 {"noSlip", "granularWall", {0}, {0.9, 0.4}, 0.4},
                 {"slip", "granularWall", {0}, {0.9, -1}, 0}};
    for (size_t i = 0; i < sizeof walls / sizeof *walls; i++) {
        struct patch_rules r = {.velocity = {.type = boundary_find(walls[i].U)},
                                .temperature = {.type = boundary_find(walls[i].T)}};
        memcpy(&r.velocity.params, walls[i].of_U, sizeof walls[i].of_U);
        memcpy(&r.temperature.params, walls[i].of_T, sizeof walls[i].of_T);
        assert_true(wall_friction(&r) == walls[i].mu);
    }
    struct rule moving = {.type = boundary_find("frictionalSlip"), .params = {{1, 2, 3, 0.3}}};
    double w[3];
    wall_velocity(&(struct patch_rules){.velocity = moving}, 3, 0, w);
    assert_true(w[0] == 1 && w[1] == 2 && w[2] == 3 && rule_rubs(&moving));
    moving.type = boundary_find("noSlip");
    assert_false(rule_rubs(&moving));
}

/* ---- walls of a gas with transport ---- */

enum { CELLS = 4 };
static const double RHO[CELLS] = {30, 60, 1, 80}, TEMPERATURE[CELLS] = {1, 0.3, 20, 1e-3}, PUSH[CELLS] = {0, 3, -2, 0},
                    SLIP[CELLS] = {4, 0.01, 100, 0}, SHEAR[CELLS] = {0.7, 3, 0.2, 1}, HEAT[CELLS] = {2, 5, 0.8, 3};

struct found { /* at walls of the rules, cells at d/2 from them */
    double drag[CELLS], heat[CELLS], surface[CELLS], pressure[CELLS];
};
static struct found at_walls(const struct patch_rules *r, double distance) {
    static const int face[CELLS] = {0, 1, 2, 3};
    const struct eos *eos = eos_find("TorquatoDisks");
    const struct material m = grains_of(eos, 0.9, 0.1);
    double d[CELLS], eps[CELLS], square[CELLS], gruneisen[CELLS];
    struct wall_line line = {.n = CELLS,
                             .face = face,
                             .eos = eos,
                             .material = &m,
                             .rho = RHO,
                             .T = TEMPERATURE,
                             .push = PUSH,
                             .d = d,
                             .shear = SHEAR,
                             .heat = HEAT,
                             .slip = SLIP};
    struct found f;
    for (int i = 0; i < CELLS; i++) {
        d[i] = distance;
        eps[i] = TEMPERATURE[i] / (m.gamma - 1);
    }
    wall_shares(r, &line, f.drag, f.heat);
    eos->state(&m, CELLS, RHO, eps, f.pressure, square, gruneisen);
    for (int i = 0; i < CELLS; i++) {
        f.surface[i] = line.surface[i];
        f.pressure[i] += 0.5 * distance * RHO[i] * PUSH[i];
    }
    return f;
}

/* Rules of a wall, all parameters 0.3, all values 0.5. */
static struct patch_rules rules_of(const struct boundary_type *U, const struct boundary_type *T) {
    const struct rule rule = {.params = {{0.3, 0.3, 0.3}}, .uniform = {0.5, 0.5, 0.5}};
    struct patch_rules r = {.velocity = rule, .temperature = rule};
    r.velocity.type = U;
    r.temperature.type = T;
    return r;
}

/* Each wall with each row for T: shares are those of a jump to the wall at half the distance at most, and what walls
 * say of themselves holds. */
static void shares(void **state) {
    (void)state;
    int sliding = 0;
    for (int u = 0; u < boundary_count; u++)
        for (int t = 0; t < boundary_count; t++) {
            const struct boundary_type *U = &boundary_table[u], *T = &boundary_table[t];
            const struct patch_rules r = rules_of(U, T);
            if (!U->vector || !T->scalar || !patch_is_wall(&r)) continue;
            assert_false(patch_needs_values(&r));
            assert_true(wall_drags(&r) == (!boundary_is_smooth(U) && strcmp(U->model.name, "frictionalSlip") != 0));
            sliding += wall_slides(&r);
            const struct found f = at_walls(&r, 0.1);
            for (int i = 0; i < CELLS; i++) {
                assert_true(wall_drags(&r) ? f.drag[i] > 0 && f.drag[i] <= 2 : f.drag[i] == 0);
                assert_true(wall_holds(&r) == (f.drag[i] == 2));
                assert_true(wall_conducts(&r) ? f.heat[i] > 0 && f.heat[i] <= 2 : f.heat[i] == 0);
                assert_true(f.surface[i] > 0);
            }
        }
    assert_true(sliding > 0);
}

/* The stress on the wall of Johnson & Jackson is that of impacts with gas that slips there, and of the heat that comes
 * with it impacts take theirs: up to what three rounds leave. */
static void friction_and_losses_balance(void **state) {
    (void)state;
    const double phi = 0.6, e = 0.7, pi = acos(-1);
    const struct boundary_type *rough = boundary_find("JohnsonJacksonSlip");
    struct patch_rules r = rules_of(rough, rough);
    double most[2] = {0, 0};
    memcpy(&r.velocity.params, (double[]){phi, e}, 2 * sizeof(double));
    memcpy(&r.temperature.params, (double[]){phi, e}, 2 * sizeof(double));
    for (int fine = 0; fine < 2; fine++) {
        const double d = fine ? 0.005 : 0.01;
        const struct found f = at_walls(&r, d);
        for (int i = 0; i < CELLS - 1; i++) { /* the last one does not slip */
            const double u = sqrt(SLIP[i]), stress = f.drag[i] * SHEAR[i] * u / d;
            const double slip = u - stress * d / (2 * SHEAR[i]);
            const double hits = f.pressure[i] / sqrt(2 * pi * f.surface[i]);
            const double loss = (1 - e * e) * hits * f.surface[i];
            const double into = 2 * HEAT[i] / d * (TEMPERATURE[i] - f.surface[i]) + stress * slip;
            most[fine] = larger(most[fine], larger(fabs(stress / (phi * hits * slip) - 1), fabs(into / loss - 1)));
        }
    }
    print_message("rest: %.2g, %.2g\n", most[0], most[1]);
    assert_true(most[1] < 1e-3);
    assert_true(most[1] < most[0] / 4);
}

/* In both limits, to the bit; a wall of the same restitution takes the same heat. */
static void friction_has_limits(void **state) {
    (void)state;
    const struct boundary_type *rough = boundary_find("JohnsonJacksonSlip"), *takes = boundary_find("granularWall");
    struct patch_rules r = rules_of(rough, rough), other = rules_of(boundary_find("slip"), takes);
    for (int full = 0; full < 2; full++) {
        r.velocity.params.room[0] = full ? 1e40 : 0;
        if (full) other.velocity.type = boundary_find("noSlip");
        const struct found a = at_walls(&r, 0.1), b = at_walls(&other, 0.1);
        assert_memory_equal(a.drag, b.drag, sizeof a.drag);
        assert_memory_equal(a.heat, b.heat, sizeof a.heat);
    }
}

/* One wall, one set of coefficients. */
static void rough_walls_object(void **state) {
    (void)state;
    const struct boundary_type *rough = boundary_find("JohnsonJacksonSlip");
    struct patch_rules r = rules_of(rough, rough);
    assert_null(rough->objection(&r));
    r.temperature.params.room[1] = 0.31;
    assert_non_null(rough->objection(&r));
    r.temperature.type = boundary_find("granularWall");
    assert_non_null(rough->objection(&r));
    r.temperature.type = boundary_find("fixedValue");
    assert_null(rough->objection(&r));
    r = rules_of(boundary_find("noSlip"), rough);
    assert_non_null(rough->objection(&r));
}

/* A row gives something if it has parameters, or a value of a scalar or of a vector, be it one of them alone. */
static void what_rows_give(void **state) {
    (void)state;
    int one = 0;
    for (int i = 0; i < boundary_count; i++) {
        const struct boundary_type *t = &boundary_table[i];
        const bool scalar = boundary_value(t, 1), vector = boundary_value(t, 3);
        assert_true(boundary_gives(t) == (t->model.nparam > 0 || scalar || vector));
        one += t->model.nparam == 0 && scalar != vector;
    }
    assert_true(one > 0);
    assert_false(boundary_gives(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls),
        cmocka_unit_test(open_ends),
        cmocka_unit_test(values_per_face),
        cmocka_unit_test(slopes),
        cmocka_unit_test(values_by_rules),
        cmocka_unit_test(feeding),
        cmocka_unit_test(feeding_faces),
        cmocka_unit_test(moving_walls),
        cmocka_unit_test(names),
        cmocka_unit_test(parameters),
        cmocka_unit_test(friction_of_packed_gas),
        cmocka_unit_test(shares),
        cmocka_unit_test(friction_and_losses_balance),
        cmocka_unit_test(friction_has_limits),
        cmocka_unit_test(rough_walls_object),
        cmocka_unit_test(what_rows_give),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
