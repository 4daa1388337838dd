/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The implicit acoustic step of a bed (libcore/acoustics/bed.h): rest, conservation, bounds at any step, and the orders
 * that the header promises. */
#include "libcore/acoustics/bed_private.h"
#include "mesh/base/comm.h"

#include <math.h>
#include <stdlib.h>

#include "tests/checks.h"

static struct comm *comm;
static const double DEEP = 9.81; /* m/s^2 */

struct box { /* a bed of n[0] x n[1] boxes, or pairs of triangles, in a box of walls, or periodic along x */
    struct material material;
    struct bed bed;
    int n[2];
    bool periodic, triangles;
    double width;
    struct bed_shapes shapes;
    double *memory, (*centre)[2]; /* [cells] of triangles */
};

static void make_shapes(struct box *x, int cells, int faces) {
    struct bed_shapes *s = &x->shapes;
    double **lines[] = {&s->area,      &s->depth[0],  &s->depth[1],  &s->normal[0], &s->normal[1],
                        &s->arm[0][0], &s->arm[0][1], &s->arm[1][0], &s->arm[1][1]};
    *s = (struct bed_shapes){.boxes = !x->triangles};
    s->volume = x->memory = calloc((size_t)(cells + 9 * faces), sizeof(double));
    assert_non_null(x->memory);
    for (int i = 0; i < 9; i++) *lines[i] = x->memory + cells + i * faces;
    x->centre = calloc((size_t)cells, sizeof *x->centre);
    assert_non_null(x->centre);
}

/* The faces of boxes along an axis: the lower ones of each line of cells, then one above each cell. */
static int link_boxes(struct box *x, int axis, int faces) {
    struct bed *b = &x->bed;
    const int n = x->n[axis], step = axis ? x->n[0] : 1;
    const bool periodic = x->periodic && axis == 0;
    for (int i = 0; i < b->cells; i++)
        for (int above = i / step % n > 0 || periodic; above < 2; above++) {
            const bool end = i / step % n == n - 1 && above;
            const int other = !above || (end && !periodic) ? -1 : end ? i - (n - 1) * step : i + step, f = faces++;
            b->left[f] = above ? i : -1;
            b->right[f] = above ? other : i;
            b->kind[f] = above && other >= 0 ? BED_INNER : BED_WALL;
            b->shape[f] = axis;
            b->face_of_cell[2 * (b->dim * i + axis) + above] = above ? f : ~f;
            if (above && other >= 0) b->face_of_cell[2 * (b->dim * other + axis)] = ~f;
        }
    return faces;
}

static int make_boxes(struct box *x) {
    struct bed_shapes *s = &x->shapes;
    int faces = 0;
    for (int i = 0; i < x->bed.cells; i++) x->bed.body[i] = 0;
    for (int i = 0; i <= x->bed.cells; i++) x->bed.face_start[i] = 2 * x->bed.dim * i;
    s->volume[0] = x->width * x->width;
    for (int k = 0; k < x->bed.dim; k++) {
        s->area[k] = x->width;
        s->normal[k][k] = 1;
        for (int side = 0; side < 2; side++) {
            s->depth[side][k] = 0.5 * x->width;
            s->arm[side][k][k] = side ? -0.5 * x->width : 0.5 * x->width;
        }
        faces = link_boxes(x, k, faces);
    }
    return faces;
}

/* Finds the face whose middle is at m, along x perhaps a period away; -1: there is none. */
static int face_at(const struct box *x, const double (*middle)[2], int faces, const double m[2]) {
    const double period = x->n[0] * x->width;
    for (int f = 0; f < faces; f++) {
        const double off = fabs(middle[f][0] - m[0]);
        if (fabs(middle[f][1] - m[1]) < 1e-9 && (off < 1e-9 || (x->periodic && fabs(off - period) < 1e-9))) return f;
    }
    return -1;
}

/* Adds the edge from a to b of a triangle with the centre c. */
static int add_edge(struct box *x, double (*middle)[2], int *faces, int cell, const double a[2], const double b[2],
                    const double c[2]) {
    struct bed_shapes *s = &x->shapes;
    const double m[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
    int f = face_at(x, (const double(*)[2])middle, *faces, m);
    const bool right = f >= 0;
    if (!right) {
        f = (*faces)++;
        memcpy(middle[f], m, sizeof m);
        s->area[f] = hypot(b[0] - a[0], b[1] - a[1]);
        s->normal[0][f] = (b[1] - a[1]) / s->area[f];
        s->normal[1][f] = (a[0] - b[0]) / s->area[f];
        x->bed.shape[f] = f;
        x->bed.kind[f] = BED_WALL;
    }
    for (int k = 0; k < 2; k++) s->arm[right][k][f] = m[k] - c[k];
    s->depth[right][f] = fabs((m[0] - c[0]) * s->normal[0][f] + (m[1] - c[1]) * s->normal[1][f]);
    if (right) x->bed.kind[f] = BED_INNER;
    x->bed.left[f] = right ? x->bed.left[f] : cell;
    x->bed.right[f] = right ? cell : -1;
    return right ? ~f : f;
}

/* Two triangles a box, whose diagonals alternate. The inner points of the grid are moved, alike in every period. */
static int make_triangles(struct box *x) {
    static const int corner[2][2][3] = {{{0, 1, 3}, {0, 3, 2}}, {{0, 1, 2}, {1, 3, 2}}};
    struct bed *b = &x->bed;
    double(*middle)[2] = calloc((size_t)(3 * b->cells), sizeof *middle);
    int faces = 0;
    assert_non_null(middle);
    for (int i = 0; i < b->cells; i++) {
        const int box = i / 2, at[2] = {box % x->n[0], box / x->n[0]}, *use = corner[(at[0] + at[1]) % 2][i % 2];
        double p[3][2], *c = x->centre[i];
        for (int j = 0; j < 3; j++) {
            const int place[2] = {at[0] + use[j] % 2, at[1] + use[j] / 2};
            const bool inner = place[1] > 0 && place[1] < x->n[1] && place[0] % x->n[0] > 0;
            for (int k = 0; k < 2; k++) {
                p[j][k] = x->width * (place[k] + (inner ? 0.15 * sin(7 * place[0] + 3 * place[1] + k) : 0));
                c[k] += p[j][k] / 3;
            }
        }
        b->body[i] = i;
        b->face_start[i] = 3 * i;
        for (int j = 0; j < 3; j++)
            b->face_of_cell[3 * i + j] = add_edge(x, middle, &faces, i, p[j], p[(j + 1) % 3], c);
        x->shapes.volume[i] =
            0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]));
    }
    b->face_start[b->cells] = 3 * b->cells;
    free(middle);
    return faces;
}

/* Beyond walls the arms are those of mirror images. */
static void make_mirrors(struct box *x) {
    struct bed_shapes *s = &x->shapes;
    for (int f = 0; f < x->bed.faces && x->triangles; f++) {
        if (x->bed.right[f] >= 0) continue;
        for (int k = 0; k < 2; k++) s->arm[1][k][f] = s->arm[0][k][f] - 2 * s->depth[0][f] * s->normal[k][f];
        s->depth[1][f] = s->depth[0][f];
    }
}

static void box_make(struct box *x, const char *eos, double e, int nx, int ny, double width, bool periodic,
                     bool triangles) {
    const struct eos *row = eos_find(eos);
    *x = (struct box){.n = {nx, ny}, .periodic = periodic, .triangles = triangles, .width = width};
    x->material = (struct material){.diameter = 1,
                                    .mass = 1,
                                    .restitution = e,
                                    .gamma = 5. / 3,
                                    .alpha_max = 0.64,
                                    .freezing = 0.49,
                                    .smoothing = 0.01,
                                    .disks = row->disks};
    if (row->disks) x->material.gamma = 2;
    const int dim = ny > 1 ? 2 : 1, cells = nx * ny * (triangles ? 2 : 1), sides = cells * (triangles ? 3 : 2 * dim);
    x->bed = (struct bed){.eos = row,
                          .material = &x->material,
                          .comm = comm,
                          .dim = dim,
                          .components = dim,
                          .shapes = &x->shapes,
                          .limit = density_limit(row, &x->material),
                          .params = {.dense = 0.9, .gain = 4, .governor = 1, .soft = 0.2, .keep = 0.05}};
    make_shapes(x, cells, sides);
    ok(bed_make(&x->bed));
    ok(bed_size(&x->bed, 1, cells, 0, sides, sides));
    x->bed.faces = triangles ? make_triangles(x) : make_boxes(x);
    make_mirrors(x);
    x->bed.first[0] = x->bed.number[0] = 0;
    x->bed.first[1] = cells;
}

static void box_free(struct box *x) {
    bed_free(&x->bed);
    free(x->memory);
    free(x->centre);
}

static double volume_of(const struct box *x, int i) {
    return x->shapes.volume[x->bed.body[i]];
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
    for (int i = 0; i < x->bed.cells; i++) sum += x->bed.U[v][i] * volume_of(x, i);
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
        box_make(&x, eos[k], 1, 30, 1, 1, false, false);
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
        box_free(&x);
    }
}

/* Gas of uniform density whose pressure carries it: P is the same on both sides of every face. */
static void test_gas_on_triangles_at_rest_stays_so(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {-0.3 * DEEP, -DEEP};
    struct box x;
    bool done;
    box_make(&x, "TorquatoSpheres", 1, 6, 5, 1, false, true);
    const double rho = 0.63 / packing_per_density(&x.material), one = 1;
    double p, c2, gruneisen, fastest = 0;
    x.bed.eos->state(&x.material, 1, &rho, &one, &p, &c2, &gruneisen);
    double *eps = calloc((size_t)x.bed.cells, sizeof *eps);
    for (int i = 0; i < x.bed.cells; i++) {
        eps[i] = rho * (1000 + gravity[0] * x.centre[i][0] + gravity[1] * x.centre[i][1]) / p;
        set(&x, i, 0.63, temperature_of(&x.material, eps[i]), 0, 0);
        fastest = larger(fastest, sqrt(c2 * eps[i]));
    }
    const double dt = 300 / fastest;
    for (int step = 0; step < 200; step++) {
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(done);
    }
    for (int i = 0; i < x.bed.cells; i++) {
        assert_true(hypot(x.bed.U[1][i], x.bed.U[2][i]) / x.bed.U[0][i] < 1e-9 * sqrt(1000 * rho / p));
        assert_true(fabs(eps_at(&x, i) - eps[i]) < 1e-9 * eps[i]);
    }
    free(eps);
    box_free(&x);
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
    int stood[2] = {0, 0};
    for (int k = 0; k < 120; k++) {
        struct box x;
        box_make(&x, eos[k % 3], 0.8, 12, 8, 1, true, k >= 60);
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
            assert_true(fabs(total(&x, 3) - before[2] - x.bed.lift[0]) < 1e-10 * before[2]);
            stood[k >= 60]++;
        }
        box_free(&x);
    }
    assert_true(stood[0] > 30 && stood[1] > 20);
}

/* A packed column is thrown at a wall: it stops within a few steps, however long they are, and does not pass
 * packing. */
static void test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0};
    struct box x;
    bool done = false;
    box_make(&x, "TorquatoSpheres", 0.9, 20, 1, 1, false, false);
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
    box_free(&x);
}

/* A wave of density and temperature at uniform pressure is carried along x; returns the mean error of rho. */
static double carried(int n, bool triangles) {
    struct box x;
    const double gravity[MAX_DIM] = {0}, width = 1. / n, u = 1e-3, dt = (triangles ? 0.2 : 0.4) * width / u, T0 = 1;
    box_make(&x, "TorquatoSpheres", 1, n, triangles ? 2 : 1, width, true, triangles);
    const double per = packing_per_density(&x.material), mean = 0.6 / per;
    double p0 = 0, error = 0, *first = malloc((size_t)x.bed.cells * sizeof *first);
    for (int i = 0; i < x.bed.cells; i++) {
        const double place = triangles ? x.centre[i][0] / width : i + 0.5;
        const double rho = (0.6 + 0.02 * sin(2 * acos(-1) * place / n)) / per;
        double p, c2, gruneisen, eps = eps_of(&x.material, T0);
        x.bed.eos->state(&x.material, 1, &rho, &eps, &p, &c2, &gruneisen);
        if (i == 0) p0 = p;
        set(&x, i, rho * per, T0 * p0 / p, u, 0);
        first[i] = rho;
    }
    const int steps = (int)lround(1 / (u * dt));
    for (int s = 0; s < steps; s++) {
        bool done;
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(done);
    }
    for (int i = 0; i < x.bed.cells; i++) error += fabs(x.bed.U[0][i] - first[i]) / (x.bed.cells * mean);
    box_free(&x);
    free(first);
    return error;
}

static void test_slow_flow_is_carried_at_second_order(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        const double coarse = carried(40, triangles), fine = carried(80, triangles);
        assert_true(coarse < 0.01);
        assert_true(coarse / fine > 3);
    }
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
        cmocka_unit_test(test_gas_on_triangles_at_rest_stays_so),
        cmocka_unit_test(test_bounds_and_conservation_at_any_step),
        cmocka_unit_test(test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing),
        cmocka_unit_test(test_slow_flow_is_carried_at_second_order),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
