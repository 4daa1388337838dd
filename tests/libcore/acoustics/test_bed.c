/* The implicit acoustic step of a bed (libcore/acoustics/bed.h): rest, conservation, bounds at any step, and the orders
 * that the header promises. */
#include "libcore/acoustics/bed_private.h"
#include "mesh/base/comm.h"

#include <math.h>
#include <stdlib.h>

#include "tests/checks.h"

static struct comm *comm;
static const double DEEP = 9.81; /* m/s^2 */

struct box { /* a bed of n[0] x n[1] cells in a box of walls, or periodic along x */
    struct material material;
    struct bed bed;
    int n[2];
    bool periodic;
    struct bed_shapes shapes;
    double width, one, area[2], half[2], to[2][2][2], normal[2][2]; /* one shape of cells, two of faces */
};

static int face_between(struct bed *b, int kind, int left, int right, int axis, int *faces) {
    const int f = (*faces)++;
    b->left[f] = left;
    b->right[f] = right;
    b->kind[f] = (unsigned char)kind;
    b->shape[f] = axis;
    if (left >= 0) b->face_of_cell[2 * (b->dim * left + axis) + 1] = f;
    if (right >= 0) b->face_of_cell[2 * (b->dim * right + axis)] = ~f;
    return f;
}

/* The faces along an axis: the lower ones of each line of cells, then one above each cell. */
static void link_axis(struct box *x, int axis, int *faces) {
    struct bed *b = &x->bed;
    const int n = x->n[axis], step = axis ? x->n[0] : 1;
    const bool periodic = x->periodic && axis == 0;
    for (int i = 0; i < b->cells; i++) {
        const int place = i / step % n;
        if (place == 0 && !periodic) face_between(b, BED_WALL, -1, i, axis, faces);
        if (place < n - 1)
            face_between(b, BED_INNER, i, i + step, axis, faces);
        else
            face_between(b, periodic ? BED_INNER : BED_WALL, i, periodic ? i - (n - 1) * step : -1, axis, faces);
    }
}

static void make_shapes(struct box *x, double width) {
    x->shapes = (struct bed_shapes){.boxes = true, .volume = &x->one, .area = x->area, .depth = {x->half, x->half}};
    x->width = width;
    x->one = width * width;
    for (int k = 0; k < 2; k++) {
        x->area[k] = width;
        x->half[k] = 0.5 * width;
        x->shapes.normal[k] = x->normal[k];
        x->normal[k][k] = 1;
        for (int side = 0; side < 2; side++) {
            x->shapes.arm[side][k] = x->to[side][k];
            x->to[side][k][k] = side ? -0.5 * width : 0.5 * width;
        }
    }
}

static void box_make(struct box *x, const char *eos, double e, int nx, int ny, double width, bool periodic) {
    const struct eos *row = eos_find(eos);
    *x = (struct box){.n = {nx, ny}, .periodic = periodic};
    x->material = (struct material){.diameter = 1,
                                    .mass = 1,
                                    .restitution = e,
                                    .gamma = 5. / 3,
                                    .alpha_max = 0.64,
                                    .freezing = 0.49,
                                    .smoothing = 0.01,
                                    .disks = row->disks};
    if (row->disks) x->material.gamma = 2;
    const int dim = ny > 1 ? 2 : 1, cells = nx * ny;
    x->bed = (struct bed){.eos = row,
                          .material = &x->material,
                          .comm = comm,
                          .dim = dim,
                          .components = dim,
                          .shapes = &x->shapes,
                          .limit = density_limit(row, &x->material),
                          .params = {.dense = 0.9, .gain = 4, .governor = 1, .soft = 0.2, .keep = 0.05}};
    make_shapes(x, width);
    ok(bed_make(&x->bed));
    ok(bed_size(&x->bed, 1, cells, 0, 2 * dim * cells, 2 * dim * cells));
    for (int i = 0; i <= cells; i++) x->bed.face_start[i] = 2 * dim * i;
    for (int i = 0; i < cells; i++) x->bed.body[i] = 0;
    int faces = 0;
    for (int k = 0; k < dim; k++) link_axis(x, k, &faces);
    x->bed.faces = faces;
    x->bed.first[0] = x->bed.number[0] = 0;
    x->bed.first[1] = cells;
}

static void set(struct box *x, int i, double alpha, double T, double u, double v) {
    double **U = x->bed.U;
    const double rho = alpha / packing_per_density(&x->material);
    const int last = x->bed.dim + 1;
    U[0][i] = rho;
    U[1][i] = rho * u;
    if (last > 2) U[2][i] = rho * v;
    U[last][i] = rho * (eps_of(&x->material, T) + 0.5 * (u * u + v * v));
}

static double total(const struct box *x, int v) {
    double sum = 0;
    for (int i = 0; i < x->bed.cells; i++) sum += x->bed.U[v][i];
    return sum;
}

static double alpha_of(const struct box *x, int i) {
    return x->bed.U[0][i] * packing_per_density(&x->material);
}

static double eps_at(const struct box *x, int i) {
    double square = 0;
    for (int k = 1; k <= x->bed.dim; k++) square += x->bed.U[k][i] * x->bed.U[k][i];
    return (x->bed.U[x->bed.dim + 1][i] - 0.5 * square / x->bed.U[0][i]) / x->bed.U[0][i];
}

/* Finds alpha of the cell above one of pressure p and density rho, both of temperature T, by bisection, so that
 * p - p_above = (rho + rho_above) g h/2. */
static double above(const struct box *x, double p, double rho, double T) {
    const double weight = 0.5 * DEEP * x->width, eps = eps_of(&x->material, T);
    double low = 0, high = rho;
    for (int times = 0; times < 200; times++) {
        const double middle = 0.5 * (low + high);
        double q, c2, gruneisen;
        x->bed.eos->state(&x->material, 1, &middle, &eps, &q, &c2, &gruneisen);
        *(q + weight * middle > p - weight * rho ? &high : &low) = middle;
    }
    return 0.5 * (low + high) * packing_per_density(&x->material);
}

/* A column at rest in which T is uniform, and its step of 300 times that of sound. */
static double lay_column(struct box *x, double alpha, double T) {
    double fastest = 0;
    for (int i = 0; i < x->bed.cells; i++) {
        double p, c2, gruneisen;
        const double rho = alpha / packing_per_density(&x->material), eps = eps_of(&x->material, T);
        set(x, i, alpha, T, 0, 0);
        x->bed.eos->state(&x->material, 1, &rho, &eps, &p, &c2, &gruneisen);
        fastest = larger(fastest, sqrt(c2));
        alpha = above(x, p, rho, T);
    }
    return 300 * x->width / fastest;
}

static void test_a_column_at_rest_stays_so(void **state) {
    (void)state;
    static const char *const eos[] = {"GoldshteinShapiro", "TorquatoSpheres"};
    const double gravity[MAX_DIM] = {-DEEP};
    for (int k = 0; k < 2; k++) {
        struct box x;
        box_make(&x, eos[k], 1, 30, 1, 1, false);
        const double T = 40, dt = lay_column(&x, 0.63, T), mass = total(&x, 0);
        for (int step = 0; step < 200; step++) {
            bool done;
            ok(bed_step(&x.bed, dt, gravity, &done));
            assert_true(done);
        }
        for (int i = 0; i < x.bed.cells; i++) {
            assert_true(fabs(x.bed.U[1][i] / x.bed.U[0][i]) < 1e-9 * sqrt(T));
            assert_true(fabs(temperature_of(&x.material, eps_at(&x, i)) - T) < 1e-9 * T);
        }
        assert_true(fabs(total(&x, 0) - mass) < 1e-13 * mass);
        bed_free(&x.bed);
    }
}

/* A number in 0 .. 1 that looks random. */
static double chance(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.;
}

/* Gas of any packing and temperature that rushes about, with steps far beyond that of sound: if a step succeeds, all is
 * admissible; mass, momentum and energy of a periodic box are conserved but for what lifting added. */
static void test_bounds_and_conservation_at_any_step(void **state) {
    (void)state;
    static const char *const eos[] = {"GoldshteinShapiro", "TorquatoSpheres", "TorquatoDisks"};
    const double gravity[MAX_DIM] = {0};
    unsigned seed = 7;
    int stood = 0;
    for (int k = 0; k < 60; k++) {
        struct box x;
        box_make(&x, eos[k % 3], 0.8, 12, 8, 1, true);
        for (int i = 0; i < x.bed.cells; i++)
            set(&x, i, chance(&seed) < 0.2 ? 1e-8 : 0.64 * (1 - pow(10, -6 * chance(&seed)) * 0.9),
                pow(10, 4 * chance(&seed) - 2), chance(&seed) - 0.5, chance(&seed) - 0.5);
        const double dt = pow(10, -3 + 3 * chance(&seed)), before[] = {total(&x, 0), total(&x, 1), total(&x, 3)};
        bool done;
        ok(bed_step(&x.bed, dt, gravity, &done));
        for (int i = 0; done && i < x.bed.cells; i++) {
            assert_true(x.bed.U[0][i] > 0 && x.bed.U[0][i] < x.bed.limit);
            assert_true(eps_at(&x, i) > 0);
        }
        if (done) {
            assert_true(fabs(total(&x, 0) - before[0]) < 1e-12 * before[0]);
            assert_true(fabs(total(&x, 1) - before[1]) < 1e-10 * before[2]);
            assert_true(fabs(total(&x, 3) - before[2] - x.bed.lift[0] / x.one) < 1e-10 * before[2]);
            stood++;
        }
        bed_free(&x.bed);
    }
    assert_true(stood > 30);
}

/* A packed column is thrown at a wall: it stops within a few steps, however long they are, and does not pass
 * packing. */
static void test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0};
    struct box x;
    bool done = false;
    box_make(&x, "TorquatoSpheres", 0.9, 20, 1, 1, false);
    for (int i = 0; i < 20; i++) set(&x, i, i < 15 ? 0.6399 : 1e-6, 1e-4, i < 15 ? -1 : 0, 0);
    for (int step = 0; step < 20; step++) {
        for (double dt = 0.2; !done && dt > 1e-4; dt *= 0.5) {
            double kept[3][20];
            for (int v = 0; v < 3; v++) memcpy(kept[v], x.bed.U[v], sizeof kept[v]);
            ok(bed_step(&x.bed, dt, gravity, &done));
            for (int v = 0; v < 3 && !done; v++) memcpy(x.bed.U[v], kept[v], sizeof kept[v]);
        }
        assert_true(done);
        done = false;
        for (int i = 0; i < 20; i++) assert_true(alpha_of(&x, i) < 0.64 && eps_at(&x, i) > 0);
    }
    for (int i = 0; i < 10; i++) assert_true(fabs(x.bed.U[1][i] / x.bed.U[0][i]) < 0.5);
    bed_free(&x.bed);
}

/* A wave of density and temperature at uniform pressure is carried along x; returns the mean error of rho. */
static double carried(int n) {
    struct box x;
    const double gravity[MAX_DIM] = {0}, width = 1. / n, u = 1e-3, dt = 0.4 * width / u, T0 = 1;
    box_make(&x, "TorquatoSpheres", 1, n, 1, width, true);
    double p0 = 0, error = 0, *first = malloc((size_t)n * sizeof *first);
    for (int i = 0; i < n; i++) {
        const double rho = (0.6 + 0.02 * sin(2 * acos(-1) * (i + 0.5) / n)) / packing_per_density(&x.material);
        double p, c2, gruneisen, eps = eps_of(&x.material, T0);
        x.bed.eos->state(&x.material, 1, &rho, &eps, &p, &c2, &gruneisen);
        if (i == 0) p0 = p;
        set(&x, i, rho * packing_per_density(&x.material), T0 * p0 / p, u, 0);
        first[i] = rho;
    }
    const int steps = (int)lround(1 / (u * dt));
    for (int s = 0; s < steps; s++) {
        bool done;
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(done);
    }
    for (int i = 0; i < n; i++) error += fabs(x.bed.U[0][i] - first[i]) / (n * 0.6 / packing_per_density(&x.material));
    bed_free(&x.bed);
    free(first);
    return error;
}

static void test_slow_flow_is_carried_at_second_order(void **state) {
    (void)state;
    const double coarse = carried(40), fine = carried(80);
    assert_true(coarse < 0.01);
    assert_true(coarse / fine > 3);
}

static int start(void **state) {
    int argc = 0;
    char **argv = NULL;
    (void)state;
    ok(comm_start(&argc, &argv, &comm));
    return 0;
}
static int finish(void **state) {
    (void)state;
    comm_finish(comm);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_column_at_rest_stays_so),
        cmocka_unit_test(test_bounds_and_conservation_at_any_step),
        cmocka_unit_test(test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing),
        cmocka_unit_test(test_slow_flow_is_carried_at_second_order),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
