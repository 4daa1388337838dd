/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields from grains: what the grains have, the fields have; kernels against brute force; impacts. */
#include "libcore/grains/coarse.h"
#include "libcore/grains/grains.h"

#include <math.h>
#include <stdlib.h>

#include "tests/checks.h" /* after what it would hide */

enum { GRAINS = 300, CELLS = 10 * 7 * 5 };
static const double round_off = 1e-12;

static double uniform(unsigned long *seed) {
    *seed = *seed * 6364136223846793005UL + 1442695040888963407UL;
    return (double)(*seed >> 11) / (double)(1UL << 53);
}

struct cloud {
    double x[GRAINS][3], u[GRAINS][3];
};
static const struct coarse_grid standard = {.dim = 3,
                                            .n = {10, 7, 5},
                                            .low = {-1, 0.5, 2},
                                            .h = {0.3, 0.2, 0.25},
                                            .periodic = {true, false, false},
                                            .mass = 3e-3,
                                            .diameter = 0.11};
static struct coarse_grid grid_of(int dim, enum coarse_kernel kernel, double width) {
    struct coarse_grid g = standard;
    g.dim = dim;
    if (dim == 2) g.n[2] = 1;
    g.kernel = kernel;
    g.width = width;
    return g;
}
static int cells_of(const struct coarse_grid *g) {
    return g->n[0] * g->n[1] * g->n[2];
}
static double volume_of(const struct coarse_grid *g) {
    return g->h[0] * g->h[1] * (g->dim == 3 ? g->h[2] : 1);
}
static void cloud_make(struct cloud *c, const struct coarse_grid *g, unsigned long seed) {
    for (int i = 0; i < GRAINS; i++)
        for (int k = 0; k < 3; k++) {
            c->x[i][k] = k < g->dim ? g->low[k] + g->n[k] * g->h[k] * uniform(&seed) : 0;
            c->u[i][k] = k < g->dim ? 2 * uniform(&seed) - 0.7 : 0;
        }
}

/* C11 does not let arrays become arrays of const by themselves. */
static void sample(struct coarse *c, struct cloud *cloud, int from, int n) {
    coarse_sample(c, n, (const double(*)[3])(cloud->x + from), (const double(*)[3])(cloud->u + from), NULL);
}

struct fields {
    double rho[CELLS], alpha[CELLS], T[CELLS], p[CELLS], u[3][CELLS], axes[3][CELLS];
};
static struct fields *fields_of(const struct coarse *c, double tau) {
    struct fields *f = calloc(1, sizeof *f);
    double *scalar[4] = {f->rho, f->alpha, f->T, f->p};
    const enum coarse_field id[4] = {COARSE_RHO, COARSE_ALPHA, COARSE_T, COARSE_P};
    for (int i = 0; i < 4; i++) coarse_value(c, tau, id[i], (double *const[3]){scalar[i], NULL, NULL});
    coarse_value(c, tau, COARSE_U, (double *const[3]){f->u[0], f->u[1], f->u[2]});
    coarse_value(c, tau, COARSE_T_AXES, (double *const[3]){f->axes[0], f->axes[1], f->axes[2]});
    return f;
}
static void near(double found, double expected, double scale, double most) {
    if (!(fabs(found - expected) <= most * scale))
        fail_msg("%.17g, not %.17g (off by %.3g)", found, expected, found - expected);
}

/* Sum of cells x volume against the grains, for a snapshot and for two of different energy. */
static void totals(void **state) {
    (void)state;
    static const double widths[] = {1e-3, 0.05, 0.21, 0.9};
    for (int dim = 2; dim <= 3; dim++)
        for (int kernel = 0; kernel < 3; kernel++)
            for (int w = 0; w < 4; w++) {
                const struct coarse_grid g = grid_of(dim, (enum coarse_kernel)kernel, widths[w]);
                struct cloud cloud[2];
                struct coarse *c;
                ok(coarse_make(&g, &c));
                double mass = 0, energy = 0, momentum[3] = {0}, collisional = 0;
                for (int moment = 0; moment < 2; moment++) {
                    cloud_make(&cloud[moment], &g, (unsigned long)(31 * moment + w));
                    sample(c, &cloud[moment], 0, GRAINS);
                    for (int i = 0; i < GRAINS; i++)
                        for (int k = 0; k < dim; k++) {
                            momentum[k] += 0.5 * g.mass * cloud[moment].u[i][k];
                            energy += 0.25 * g.mass * cloud[moment].u[i][k] * cloud[moment].u[i][k];
                        }
                }
                const double still = energy;
                struct fields *f = fields_of(c, 0);
                mass = -GRAINS * g.mass;
                for (int i = 0; i < cells_of(&g); i++) {
                    const double m = f->rho[i] * volume_of(&g);
                    mass += m;
                    energy -= 0.5 * m * dim * f->T[i];
                    near(f->p[i], f->rho[i] * f->T[i], f->p[i], 1e-15);
                    near(f->alpha[i] * g.mass, f->rho[i] * acos(-1) * pow(g.diameter, dim) / (dim == 2 ? 4 : 6), g.mass,
                         1e-14);
                    for (int k = 0; k < dim; k++) {
                        energy -= 0.5 * m * f->u[k][i] * f->u[k][i];
                        momentum[k] -= m * f->u[k][i];
                    }
                    collisional += f->p[i];
                }
                assert_true(collisional > 0);
                near(mass, 0, GRAINS * g.mass, round_off);
                near(energy, 0, still, round_off);
                for (int k = 0; k < dim; k++) near(momentum[k], 0, GRAINS * g.mass, round_off);
                free(f);
                coarse_free(c);
            }
}

/* Image `image` of the row of cells (or of a coordinate) along a periodic or walled axis of n cells. */
static double image_of(const struct coarse_grid *g, int k, double x, int image) {
    const double length = g->n[k] * g->h[k];
    if (g->periodic[k] || image % 2 == 0) return x + image * length;
    return g->low[k] * 2 + (image + 1) * length - x;
}
static double bell(double s) {
    return erf(fmax(-3, fmin(3, s)) / sqrt(2)) / (2 * erf(3 / sqrt(2)));
}
/* Share of a grain at x in a cell, by all images of the grain. */
static double brute_share(const struct coarse_grid *g, const double x[3], int cell) {
    const int at[3] = {cell % g->n[0], cell / g->n[0] % g->n[1], cell / g->n[0] / g->n[1]};
    double product = 1;
    for (int k = 0; k < g->dim; k++) {
        double sum = 0;
        for (int image = -6; image <= 6; image++) {
            const double from = g->low[k] + at[k] * g->h[k] - image_of(g, k, x[k], image);
            sum += bell((from + g->h[k]) / g->width) - bell(from / g->width);
        }
        product *= sum;
    }
    return product;
}
/* Number of images of the grain whose distance to the cell's centre is below the width. */
static double brute_count(const struct coarse_grid *g, const double x[3], int cell) {
    const int at[3] = {cell % g->n[0], cell / g->n[0] % g->n[1], cell / g->n[0] / g->n[1]};
    int count = 0;
    for (int all = 0; all < (g->dim == 3 ? 343 : 49); all++) {
        const int image[3] = {all % 7 - 3, all / 7 % 7 - 3, all / 49 - 3};
        double square = 0;
        for (int k = 0; k < g->dim; k++) {
            const double away = g->low[k] + (at[k] + 0.5) * g->h[k] - image_of(g, k, x[k], image[k]);
            square += away * away;
        }
        count += square < g->width * g->width;
    }
    return count;
}
/* Shares of a grain in all cells. */
static void brute_shares(const struct coarse_grid *g, const double x[3], double w[CELLS]) {
    double all = 0;
    for (int i = 0; i < cells_of(g); i++)
        all += w[i] = g->kernel == COARSE_GAUSSIAN ? brute_share(g, x, i) : brute_count(g, x, i);
    for (int i = 0; g->kernel == COARSE_HEAVISIDE && i < cells_of(g); i++) w[i] /= all;
}

static void kernels(void **state) {
    (void)state;
    enum { FEW = 25 };
    static struct cloud cloud;
    for (int dim = 2; dim <= 3; dim++)
        for (int kernel = COARSE_HEAVISIDE; kernel <= COARSE_GAUSSIAN; kernel++) {
            const struct coarse_grid g = grid_of(dim, (enum coarse_kernel)kernel, 0.43);
            static double w[FEW][CELLS];
            struct coarse *c;
            cloud_make(&cloud, &g, 5);
            ok(coarse_make(&g, &c));
            sample(c, &cloud, 0, FEW);
            struct fields *f = fields_of(c, 0);
            for (int i = 0; i < FEW; i++) brute_shares(&g, cloud.x[i], w[i]);
            for (int j = 0; j < cells_of(&g); j++) {
                double number = 0, u[3] = {0}, square[3] = {0};
                for (int i = 0; i < FEW; i++) {
                    number += w[i][j];
                    for (int k = 0; k < dim; k++) u[k] += w[i][j] * cloud.u[i][k];
                }
                near(f->rho[j] * volume_of(&g) / g.mass, number, 1, round_off);
                if (number < 1e-6) continue;
                for (int i = 0; i < FEW; i++)
                    for (int k = 0; k < dim; k++)
                        square[k] += w[i][j] * (cloud.u[i][k] - u[k] / number) * (cloud.u[i][k] - u[k] / number);
                for (int k = 0; k < dim; k++) near(f->u[k][j] * number, u[k], 1, round_off);
                near(f->T[j] * dim * number, square[0] + square[1] + square[2], 1, round_off);
                for (int k = 0; k < 3; k++) near(f->axes[k][j] * number, square[k], 1, round_off);
            }
            free(f);
            coarse_free(c);
        }
}

/* A grain at a wall, in a corner and at a periodic side; a narrow kernel is the cell's. */
static void narrow(void **state) {
    (void)state;
    static struct cloud cloud;
    struct coarse *a, *b;
    for (int kernel = COARSE_HEAVISIDE; kernel <= COARSE_GAUSSIAN; kernel++) {
        const struct coarse_grid g = grid_of(3, COARSE_CELL, 0), thin = grid_of(3, (enum coarse_kernel)kernel, 1e-9);
        ok(coarse_make(&g, &a));
        ok(coarse_make(&thin, &b));
        cloud_make(&cloud, &g, 77);
        for (int k = 0; k < 3; k++) cloud.x[0][k] = g.low[k] + g.n[k] * g.h[k]; /* upper corner */
        memcpy(cloud.x[1], g.low, sizeof g.low);
        sample(a, &cloud, 0, 2);
        struct fields *f = fields_of(a, 0);
        const double one = g.mass / volume_of(&g);
        near(f->rho[0], one, one, 1e-14);
        near(f->rho[CELLS - 10], one, one, 1e-14); /* periodic along 0, walls along 1 and 2 */
        free(f);
        for (int i = 2; i < GRAINS; i++) { /* well inside their cells: elsewhere round-off decides */
            sample(a, &cloud, i, 1);
            sample(b, &cloud, i, 1);
        }
        sample(b, &cloud, 0, 2);
        struct fields *fa = fields_of(a, 0), *fb = fields_of(b, 0);
        for (int j = 1; kernel == COARSE_HEAVISIDE && j < CELLS; j++) near(fa->rho[j], fb->rho[j], one, 1e-13);
        for (int j = 20; j < 30; j++) near(fa->T[j], fb->T[j], 1, 1e-13);
        free(fa);
        free(fb);
        coarse_free(a);
        coarse_free(b);
    }
}

/* u_x = 1e5 + 3 y of a lattice of grains: U is linear away from the walls, where a kernel sees the mirror; T has
 * nothing of U but its variance over the lattice in a cell, shared by two components. */
static void shear(void **state) {
    (void)state;
    enum { SIDE = 10 }; /* grains along a side of each cell */
    for (int kernel = 0; kernel < 3; kernel++) {
        const struct coarse_grid g = grid_of(2, (enum coarse_kernel)kernel, 0.12);
        struct coarse *c;
        ok(coarse_make(&g, &c));
        for (int i = 0; i < 10 * SIDE; i++)
            for (int j = 0; j < 7 * SIDE; j++) {
                const double x[1][3] = {{g.low[0] + (i + 0.5) * 0.3 / SIDE, g.low[1] + (j + 0.5) * 0.2 / SIDE, 0}};
                const double u[1][3] = {{1e5 + 3 * x[0][1], -7, 0}};
                coarse_sample(c, 1, x, u, NULL);
            }
        struct fields *f = fields_of(c, 0);
        for (int i = 0; i < 70; i++) {
            const int row = i / 10;
            if (kernel == COARSE_CELL || (row >= 2 && row <= 4))
                near(f->u[0][i], 1e5 + 3 * (g.low[1] + (row + 0.5) * 0.2), 1e5, 1e-14);
            near(f->u[1][i], -7, 7, 1e-14);
            if (kernel == COARSE_CELL) near(f->T[i], 9 * 0.2 * 0.2 / 12 * (1 - 1. / (SIDE * SIDE)) / 2, f->T[i], 1e-9);
            near(f->axes[0][i], 2 * f->T[i], f->T[i], 1e-14); /* all of T is in the direction of the stream */
            assert_true(f->axes[1][i] == 0);
        }
        free(f);
        coarse_free(c);
    }
}

/* A fast cold stream: T is 0, not the round-off of its energy. */
static void cold(void **state) {
    (void)state;
    static struct cloud cloud;
    struct coarse *c;
    for (int kernel = 0; kernel < 3; kernel++) {
        const struct coarse_grid g = grid_of(3, (enum coarse_kernel)kernel, 0.2);
        ok(coarse_make(&g, &c));
        cloud_make(&cloud, &g, 3);
        for (int i = 0; i < GRAINS; i++) cloud.u[i][0] = 1234.567, cloud.u[i][1] = -1. / 3, cloud.u[i][2] = 0.1;
        sample(c, &cloud, 0, GRAINS);
        struct fields *f = fields_of(c, 0);
        for (int i = 0; i < CELLS; i++) {
            assert_true(f->T[i] == 0 && f->axes[0][i] == 0 && f->axes[1][i] == 0 && f->axes[2][i] == 0);
            assert_true(f->rho[i] == 0 || f->u[0][i] == 1234.567);
        }
        free(f);
        coarse_free(c);
    }
}

/* By hand: cells 0.3 wide, two grains 0.11 apart across the face at -0.7 (end 1 : middle 4 : end 1), a wall, a
 * periodic side. */
static void impacts(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        const struct coarse_grid g = grid_of(dim, COARSE_CELL, 0);
        struct coarse *c;
        ok(coarse_make(&g, &c));
        struct grain_observer *o = coarse_observer(c);
        const double z = dim == 3 ? 2.1 : 0, V = volume_of(&g), tau = 7;
        struct grain_impact i = {.x = {{-0.74, 0.6, z}, {-0.63, 0.6, z}}, .normal = {1, 0, 0}, .impulse = 0.02, .b = 1};
        o->impact(o, &i);
        struct fields *f = fields_of(c, tau);
        const double all = 0.02 * 0.11 / (dim * V * tau);
        near(f->p[0], all * 1 / 6, all, 1e-14); /* the end at -0.74 lies in cell 0, the middle at -0.685 in 1 */
        near(f->p[1], all * 5 / 6, all, 1e-14);
        assert_true(f->T[0] == 0 && f->rho[0] == 0);
        free(f);
        f = fields_of(c, 0);
        assert_true(f->p[0] == 0);
        free(f);
        coarse_clear(c);
        i = (struct grain_impact){
            .x = {{1.99, 0.6, z}, {2.10, 0.6, z}}, .normal = {1, 0, 0}, .impulse = 0.02, .b = 1}; /* side at 2 */
        o->impact(o, &i);
        f = fields_of(c, tau);
        near(f->p[9], all * 1 / 6, all, 1e-14);
        near(f->p[0], all * 5 / 6, all, 1e-14);
        free(f);
        coarse_clear(c);
        i = (struct grain_impact){
            .x = {{0.1, 0.555, z}, {0.1, 0.555, z}}, .normal = {0, -1, 0}, .impulse = 0.02, .b = -1 - 2}; /* low y */
        o->impact(o, &i);
        f = fields_of(c, tau);
        near(f->p[3], all / 2, all, 1e-14); /* the radius is the branch */
        double rest = 0;
        for (int j = 0; j < cells_of(&g); j++) rest += f->p[j];
        near(rest, all / 2, all, 1e-14);
        free(f);
        coarse_free(c);
    }
}

/* Every kernel keeps the sum of impulse * branch; the Gaussian against brute force at the three points. */
static void impact_kernels(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++)
        for (int kernel = 0; kernel < 3; kernel++) {
            const struct coarse_grid g = grid_of(dim, (enum coarse_kernel)kernel, 0.35);
            const struct grain_impact i = {.x = {{1.95, 0.6, dim == 3 ? 2.2 : 0}, {2.016, 0.688, dim == 3 ? 2.2 : 0}},
                                           .normal = {0.6, 0.8, 0},
                                           .impulse = 0.3,
                                           .b = 4};
            struct coarse *c;
            ok(coarse_make(&g, &c));
            for (int k = 0; k < 5; k++) coarse_observer(c)->impact(coarse_observer(c), &i);
            struct fields *f = fields_of(c, 2);
            const double all = 5 * 0.3 * 0.11 / (dim * volume_of(&g) * 2);
            double sum = 0, w[3][CELLS];
            for (int point = 0; kernel != COARSE_CELL && point < 3; point++) {
                const double s = 0.055 * point, x[3] = {i.x[0][0] + s * 0.6, i.x[0][1] + s * 0.8, i.x[0][2]};
                brute_shares(&g, x, w[point]);
            }
            for (int j = 0; j < cells_of(&g); j++) {
                if (kernel != COARSE_CELL) near(f->p[j], all * (w[0][j] + 4 * w[1][j] + w[2][j]) / 6, all, round_off);
                sum += f->p[j];
            }
            near(sum, all, all, round_off);
            free(f);
            coarse_free(c);
        }
}

static void order(void **state) {
    (void)state;
    static struct cloud cloud, back;
    for (int kernel = 0; kernel < 3; kernel++) {
        const struct coarse_grid g = grid_of(3, (enum coarse_kernel)kernel, 0.3);
        struct coarse *a, *b;
        ok(coarse_make(&g, &a));
        ok(coarse_make(&g, &b));
        cloud_make(&cloud, &g, 9);
        for (int i = 0; i < GRAINS; i++) {
            memcpy(back.x[i], cloud.x[GRAINS - 1 - i], sizeof back.x[i]);
            memcpy(back.u[i], cloud.u[GRAINS - 1 - i], sizeof back.u[i]);
        }
        sample(a, &cloud, 0, GRAINS);
        sample(b, &back, 0, GRAINS);
        struct fields *fa = fields_of(a, 0), *fb = fields_of(b, 0);
        for (int j = 0; j < CELLS; j++) {
            near(fa->rho[j], fb->rho[j], g.mass / volume_of(&g), round_off);
            near(fa->T[j], fb->T[j], 1, round_off);
            near(fa->rho[j] * fa->u[1][j], fb->rho[j] * fb->u[1][j], g.mass / volume_of(&g), round_off);
        }
        free(fa);
        free(fb);
        coarse_free(a);
        coarse_free(b);
    }
}

/* The sums go on elsewhere, to the bit. */
static void resumed(void **state) {
    (void)state;
    static struct cloud cloud;
    const struct coarse_grid g = grid_of(2, COARSE_GAUSSIAN, 0.1);
    struct coarse *a, *b;
    ok(coarse_make(&g, &a));
    ok(coarse_make(&g, &b));
    cloud_make(&cloud, &g, 4);
    sample(a, &cloud, 0, 100);
    memcpy(coarse_sums(b), coarse_sums(a), (size_t)coarse_size(a) * sizeof(double));
    sample(a, &cloud, 100, 200);
    sample(b, &cloud, 100, 200);
    assert_memory_equal(coarse_sums(a), coarse_sums(b), (size_t)coarse_size(a) * sizeof(double));
    assert_true(coarse_sums(a)[coarse_size(a) - 1] == 2);
    coarse_clear(a);
    for (long i = 0; i < coarse_size(a); i++) assert_true(coarse_sums(a)[i] == 0);
    coarse_free(a);
    coarse_free(b);
}

/* ---- kernels on a mesh: columns of unequal widths, and rows of unequal heights; axis 0 may be periodic */

enum { COLUMNS = 24, ROWS = 9 };
struct uneven {
    struct grain_mesh base; /* first */
    double edge[2][COLUMNS + 1], volume[COLUMNS * ROWS], centre[COLUMNS * ROWS][3];
};
static long uneven_locate(const struct grain_mesh *self, const double x[3], bool *inside) {
    const struct uneven *m = (const struct uneven *)self;
    int at[2] = {0, 0};
    *inside = true;
    while (at[0] < COLUMNS - 1 && x[0] >= m->edge[0][at[0] + 1]) at[0]++;
    while (at[1] < ROWS - 1 && x[1] >= m->edge[1][at[1] + 1]) at[1]++;
    return at[0] + COLUMNS * at[1];
}
static void uneven_make(struct uneven *m, bool even) {
    for (int i = 0; i < COLUMNS; i++) m->edge[0][i + 1] = m->edge[0][i] + (even ? 1 : 1 + i % 3);
    for (int i = 0; i < ROWS; i++) m->edge[1][i + 1] = m->edge[1][i] + (even ? 1 : 1 + i % 2);
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const double *x = &m->edge[0][i % COLUMNS], *y = &m->edge[1][i / COLUMNS];
        m->volume[i] = (x[1] - x[0]) * (y[1] - y[0]);
        m->centre[i][0] = 0.5 * (x[0] + x[1]);
        m->centre[i][1] = 0.5 * (y[0] + y[1]);
    }
    m->base = (struct grain_mesh){.cells = COLUMNS * ROWS, .volume = m->volume, .locate = uneven_locate};
    m->base.centre = (const double(*)[3])m->centre;
}
static struct coarse_grid grid_around(const struct uneven *m, enum coarse_kernel kernel, double width, bool periodic) {
    return (struct coarse_grid){.dim = 2,
                                .n = {1, 1, 1},
                                .h = {m->edge[0][COLUMNS], m->edge[1][ROWS], 1},
                                .periodic = {periodic, false, false},
                                .kernel = kernel,
                                .width = width,
                                .mass = 2,
                                .diameter = 0.1,
                                .mesh = &m->base};
}

/* Uniform grains of one velocity give uniform fields with T = 0; of a random cloud mass, momentum and energy stay */
static void mesh_totals(void **state) {
    (void)state;
    struct uneven *m = calloc(1, sizeof *m);
    uneven_make(m, false);
    for (int i = 0; i < 12; i++) {
        const struct coarse_grid g =
            grid_around(m, i % 2 ? COARSE_GAUSSIAN : COARSE_HEAVISIDE, (double[]){0.3, 1.7, 12}[i / 2 % 3], i >= 6);
        struct coarse *c;
        double rho[COLUMNS * ROWS], T[COLUMNS * ROWS], U[2][COLUMNS * ROWS], mass = 0, energy = 0, momentum = 0;
        ok(coarse_make(&g, &c));
        for (double x = 0.25; x < g.h[0]; x += 0.5) /* four in a unit of volume */
            for (double y = 0.25; y < g.h[1]; y += 0.5)
                coarse_sample(c, 1, (const double[1][3]){{x, y, 0}}, (const double[1][3]){{3e5, -7, 0}}, NULL);
        coarse_sums(c)[coarse_size(c) - 1] = 1; /* at one moment */
        coarse_value(c, 0, COARSE_RHO, (double *const[3]){rho});
        coarse_value(c, 0, COARSE_T, (double *const[3]){T});
        for (int j = 0; j < COLUMNS * ROWS; j++) {
            near(rho[j], 8, 8, 1e-11);
            near(T[j], 0, 1, 0);
        }
        coarse_clear(c);
        unsigned long seed = 5;
        for (int j = 0; j < GRAINS; j++) {
            const double x[1][3] = {{g.h[0] * uniform(&seed), g.h[1] * uniform(&seed), 0}};
            const double u[1][3] = {{uniform(&seed), 3 * uniform(&seed) - 1, 0}};
            coarse_sample(c, 1, x, u, NULL);
            energy -= 0.5 * 2 * (u[0][0] * u[0][0] + u[0][1] * u[0][1]);
            momentum -= 2 * u[0][1];
        }
        const double still = energy;
        coarse_sums(c)[coarse_size(c) - 1] = 1;
        coarse_value(c, 0, COARSE_RHO, (double *const[3]){rho});
        coarse_value(c, 0, COARSE_T, (double *const[3]){T});
        coarse_value(c, 0, COARSE_U, (double *const[3]){U[0], U[1]});
        for (int j = 0; j < COLUMNS * ROWS; j++) {
            const double here = rho[j] * m->volume[j];
            mass += here;
            momentum += here * U[1][j];
            energy += here * (T[j] + 0.5 * (U[0][j] * U[0][j] + U[1][j] * U[1][j]));
        }
        near(mass, 2 * GRAINS, 2 * GRAINS, round_off);
        near(momentum, 0, 2 * GRAINS, round_off);
        near(energy, 0, -still, round_off);
        coarse_free(c);
    }
    free(m);
}

/* One grain in the middle of equal cells: what cells get falls as the kernel does */
static void mesh_shape(void **state) {
    (void)state;
    struct uneven *m = calloc(1, sizeof *m);
    uneven_make(m, true);
    for (int kernel = COARSE_HEAVISIDE; kernel <= COARSE_GAUSSIAN; kernel++) {
        const struct coarse_grid g =
            grid_around(m, (enum coarse_kernel)kernel, kernel == COARSE_GAUSSIAN ? 1.2 : 3.5, true);
        struct coarse *c;
        double rho[COLUMNS * ROWS];
        ok(coarse_make(&g, &c));
        coarse_sample(c, 1, (const double[1][3]){{0.5, 4.5, 0}}, (const double[1][3]){{0}}, NULL);
        coarse_value(c, 0, COARSE_RHO, (double *const[3]){rho});
        const double *row = rho + 4 * COLUMNS;
        for (int j = 1; j < 4; j++) {
            near(row[COLUMNS - j], row[j], row[0], round_off); /* across the periodic end */
            if (kernel == COARSE_GAUSSIAN) near(row[j] / row[0], exp(-0.5 * j * j / 1.44), 1, 1e-2);
            if (kernel == COARSE_HEAVISIDE) near(row[j], row[0], row[0], 0.1);
        }
        near(row[4], 0, row[0], 0.02);
        coarse_free(c);
    }
    free(m);
}

static void refused(void **state) {
    (void)state;
    struct coarse *c;
    struct coarse_grid g = grid_of(3, COARSE_GAUSSIAN, 0);
    says(coarse_make(&g, &c), "width of the kernel is 0 m|positive and at most the box (3 m)");
    g.width = 3.1;
    says(coarse_make(&g, &c), "width of the kernel is 3.1 m");
    g.width = 0.149; /* 298 cells along each axis, in a box of few */
    g.h[0] = g.h[1] = g.h[2] = 0.003;
    g.n[0] = 50;
    g.n[1] = g.n[2] = 1;
    says(coarse_make(&g, &c), "covers more than 16777216 cells|narrower");
    assert_null(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(totals),         cmocka_unit_test(kernels),     cmocka_unit_test(narrow),
        cmocka_unit_test(shear),          cmocka_unit_test(cold),        cmocka_unit_test(impacts),
        cmocka_unit_test(impact_kernels), cmocka_unit_test(order),       cmocka_unit_test(resumed),
        cmocka_unit_test(refused),        cmocka_unit_test(mesh_totals), cmocka_unit_test(mesh_shape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
