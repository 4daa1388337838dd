/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes that tiles take from each other: the same bits for all cuts of a box, whether tiles have seams on all sides or
 * on none, are computed in part, or limited. */
#include "libcore/gas/gas_private.h"
#include "libcore/lattice/tiles.h"
#include "tests/defaults.h"

#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world;

enum { CELLS = 32 * 16 * 16 };
static const int SIZE[3] = {32, 16, 16};

typedef void initial(double x, double y, double z, double *rho, double *T, double u[3]);

static void everywhere(double x, double y, double z, double *rho, double *T, double u[3]) {
    *rho = 200 + 90 * sin(6 * x + 12 * y) * cos(6 * z);
    *T = 2 + sin(6 * (x - z));
    for (int k = 0; k < 3; k++) u[k] = 4 * sin(6 * (x + y + z) + k) + 1;
}

/* Of tiles of 8 cells the second of a row is uniform, the third begins so, and the last one moves everywhere. */
static void in_one_half(double x, double y, double z, double *rho, double *T, double u[3]) {
    everywhere(x, y, z, rho, T, u);
    if (x < 0.1 || x > 0.6) return;
    *rho = 150;
    *T = 2;
    for (int k = 0; k < 3; k++) u[k] = 3;
}

/* The first three cells of a row of 32 differ from the others, which are alike. */
static void at_one_end(double x, double y, double z, double *rho, double *T, double u[3]) {
    everywhere(x, y, z, rho, T, u);
    if (x < 0.09) return;
    *rho = 150;
    *T = 2;
    for (int k = 0; k < 3; k++) u[k] = 3;
}

/* Lumps near packing fly into each other through a near vacuum, at one end: faces there are limited. */
static void violent(double x, double y, double z, double *rho, double *T, double u[3]) {
    everywhere(x, y, z, rho, T, u);
    if (x > 0.3) return;
    *rho = y > 0.3 && y < 0.6 ? 1100 : 1e-3;
    *T = 1e-6;
    u[1] = y < 0.5 ? 5 : -5;
}

static void open_gas(struct scene *s, const bool periodic[3], const char *flux, int tile) {
    *s = (struct scene){
        .models = {.material = {.diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65},
                   .eos = eos_find("GoldshteinShapiro"),
                   .flux = flux_find(flux),
                   .flux_params = own_defaults(&flux_find(flux)->model),
                   .reconstruct = reconstruct_find("WENO5"),
                   .stepper = stepper_find("SSPRK3"),
                   .source = {.cooling = cooling_find("Haff"), .gravity = {3, -20, 7}},
                   .skip_uniform = true}};
    set_walls(s, "slip");
    open_box(s, world, 3, SIZE, (double[3]){2, 1, 1}, periodic, tile);
}

static void start(struct scene *s, initial *at) {
    double *all = calloc(5 * (size_t)CELLS, sizeof *all), *u[3] = {all + CELLS, all + 2 * CELLS, all + 3 * CELLS};
    for (int i = 0; i < CELLS; i++) {
        const double *x = s->centre + 3 * i;
        double v[3];
        at(x[0] / 2, x[1], x[2], &all[i], &all[4 * CELLS + i], v);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * CELLS));
    free(all);
}

/* How many of this rank's seams are known after a stage. */
static long known_seams(const struct gas *g) {
    long n = 0;
    for (int i = 0; i < MAX_DIM * g->forest->ntiles; i++) n += g->tiles->seams.known[i];
    return n;
}

/* The state after some steps on tiles of one size; *known: seams of all ranks, *limited: cells. */
static double *state_after(const bool periodic[3], const char *flux, initial *at, int tile, long *known,
                           long *limited) {
    struct scene s;
    open_gas(&s, periodic, flux, tile);
    start(&s, at);
    run(&s, 4, 0.5);
    *known = known_seams(s.gas);
    comm_sum_long(world, known, 1);
    *limited = gas_counts(s.gas).cells;
    double *U = state_of(&s, world);
    close_scene(&s);
    return U;
}

static void compare(const bool periodic[3], const char *flux, initial *at, bool limits) {
    const int tiles[] = {32, 16, 8, 7};
    double *first = NULL;
    long known, limited;
    for (int t = 0; t < 4; t++) {
        double *U = state_after(periodic, flux, at, tiles[t], &known, &limited);
        assert_true(!limits || limited > 0);
        if (tiles[t] == 32) assert_true(periodic[1] == (known > 0)); /* one tile: only its own neighbour */
        if (tiles[t] == 8 && comm_size(world) == 1) assert_true(known > 0);
        for (int i = 0; i < 5 * CELLS && first; i++)
            if (U[i] != first[i])
                fail_msg("%s, tiles of %d: variable %d of cell %d is %.17g, of %d %.17g", flux, tiles[t], i / CELLS,
                         i % CELLS, U[i], tiles[0], first[i]);
        if (first)
            free(U);
        else
            first = U;
    }
    free(first);
}

static const bool WALLS[3] = {false, false, false}, AROUND[3] = {true, true, true}, CHANNEL[3] = {false, true, false};

static void cuts_change_no_bit(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++) {
        compare(WALLS, flux_table[flux].model.name, everywhere, false);
        compare(AROUND, flux_table[flux].model.name, everywhere, false);
    }
}

static void tiles_with_a_background(void **state) {
    (void)state;
    compare(AROUND, "common", in_one_half, false);
    compare(CHANNEL, "Marquina", in_one_half, false);
}

static void limited_tiles(void **state) {
    (void)state;
    compare(AROUND, "common", violent, true);
    compare(CHANNEL, "Marquina", violent, true);
}

/* On one rank all tiles of a gas that moves everywhere take what they can; tiles of 7 cells, whose rows gain nothing,
 * take nothing along these. */
static void all_seams_are_used(void **state) {
    (void)state;
    const int tiles[] = {8, 7}, along[] = {3 * 2 * 2, 0}; /* of axis 0, between walls */
    for (int t = 0; t < 2 && comm_size(world) == 1; t++) {
        struct scene s;
        int known[MAX_DIM] = {0}, pieces[3];
        open_gas(&s, WALLS, "common", tiles[t]);
        start(&s, everywhere);
        run(&s, 1, 0.5);
        for (int k = 0; k < 3; k++) pieces[k] = (SIZE[k] + tiles[t] - 1) / tiles[t];
        for (int i = 0; i < MAX_DIM * s.forest->ntiles; i++) known[i % MAX_DIM] += s.gas->tiles->seams.known[i];
        assert_int_equal(known[0], along[t]);
        assert_int_equal(known[1], pieces[0] * (pieces[1] - 1) * pieces[2]);
        assert_int_equal(known[2], pieces[0] * pieces[1] * (pieces[2] - 1));
        close_scene(&s);
    }
}

/* A step takes a disturbance 9 cells far: beyond it there are two layers at least of tiles of 4 cells, which say that
 * they are uniform, with the values of their cells, and set nothing behind these. */
static void uniform_tiles_have_one_value(void **state) {
    (void)state;
    enum { MOST = 4 * 4 * 4 };
    struct scene s;
    long uniform = 0;
    open_gas(&s, AROUND, "common", 4);
    start(&s, at_one_end);
    run(&s, 1, 0.5);
    for (int b = 0; b < s.gas->blocks.n; b++) {
        double value[4] = {0, 0, 0, -7}, cells[3][MOST];
        if (!gas_block_uniform(s.gas, b, GAS_U, value)) continue;
        gas_block_field(s.gas, b, GAS_U, (double *const[3]){cells[0], cells[1], cells[2]});
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < MOST; i++) assert_true(value[k] == cells[k][i]);
        assert_true(value[3] == -7);
        uniform++;
    }
    comm_sum_long(world, &uniform, 1);
    assert_true(uniform >= 2 * 4 * 4);
    close_scene(&s);
}

int main(int argc, char **argv) {
    if (status_print(comm_start(&argc, &argv, &world), true)) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_change_no_bit),
        cmocka_unit_test(tiles_with_a_background),
        cmocka_unit_test(limited_tiles),
        cmocka_unit_test(all_seams_are_used),
        cmocka_unit_test(uniform_tiles_have_one_value),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
