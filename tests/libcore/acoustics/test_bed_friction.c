/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction in the step of a bed (libcore/acoustics/bed_friction.c): what gas that turns, is sheared, rests or slides
 * must do by the equations of docs/physics.md 9.3. */
#include "tests/libcore/acoustics/friction_bed.h"

/* Sets a cell to move with the velocity gradient G[axis][component] about a point. */
static void set_linear(struct box *x, int i, double alpha, double G[3][3], const double about[3]) {
    double u[3] = {0};
    for (int k = 0; k < x->bed.dim; k++)
        for (int m = 0; m < x->bed.components; m++) u[m] += G[k][m] * (x->centre[i][k] - about[k]);
    set_moving(x, i, alpha, 1, u);
    x->bed.set.pressure[i] = PRESSURE; /* everywhere the same: nothing else pushes */
}

/* Returns false for a packed cell whose packed neighbours lie on a line or in a plane: nothing tells the derivatives
 * across that. */
static bool spanned(const struct box *x, const double *rho, int i) {
    const struct bed *b = &x->bed;
    double A[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < b->dim; k++) A[k][k] = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const int other = bed_across(b, &s);
        if (other < 0 || rho[other] * packing_per_density(&x->material) < 0.5) continue;
        for (int k = 0; k < b->dim; k++)
            for (int l = 0; l < b->dim; l++)
                A[k][l] += (x->centre[other][k] - x->centre[i][k]) * (x->centre[other][l] - x->centre[i][l]);
    }
    return rho[i] * packing_per_density(&x->material) < 0.5 ||
           A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1]) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
                   A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]) >
               1e-6;
}

/* Sets a disc or ball of packed gas that turns in thin gas. Cells whose packed neighbours lie on a line are thin, too.
 */
static void set_turning(struct box *x, double radius, double G[3][3], const double about[3]) {
    for (int i = 0; i < x->bed.set.cells; i++)
        set_linear(x, i, distance(x, i, about) < radius ? PACKED : THIN, G, about);
    for (int i = 0; i < x->bed.set.cells; i++)
        if (!spanned(x, x->bed.set.U[0], i)) {
            set_linear(x, i, THIN, G, about);
            i = -1; /* its neighbours have one less */
        }
}

/* Gas that turns as a solid has no strain, so no friction, also at its surface. */
static void test_rigid_rotation_feels_no_friction(void **state) {
    (void)state;
    static const struct box_form form[] = {{.n = {12, 12, 1}, .width = 1},
                                           {.n = {12, 12, 1}, .width = 1, .triangles = true},
                                           {.n = {11, 11, 11}, .width = 1}};
    for (int k = 0; k < 3; k++) {
        struct box x;
        struct box_form f = form[k];
        const double about[3] = {6.1, 5.9, 5.7}, w[3] = {k == 2 ? 0.02 : 0, k == 2 ? -0.01 : 0, 0.03}, dt = 0.05;
        double G[3][3] = {{0, w[2], -w[1]}, {-w[2], 0, w[0]}, {w[1], -w[0], 0}}, speed = 0;
        f.friction = law("muI", 0.38);
        make(&x, &f);
        set_turning(&x, 4.2, G, about);
        rub(&x, dt);
        for (int i = 0; i < x.bed.set.cells; i++)
            for (int m = 0; m < x.bed.dim; m++) speed = larger(speed, fabs(x.bed.lines->rubbed[m][i]));
        assert_true(speed < 1e-15);
        for (int t = 0; t < bed_tensors(x.bed.components); t++)
            for (int e = 0; e < x.bed.set.faces; e++)
                assert_true(fabs(x.bed.set.stress[t][e]) < 1e-12 * modulus_of(&x) * dt * 0.04);
        box_free(&x);
    }
}

/* Checks that faces between packed cells have the stress 2 G dt D' of a velocity gradient. */
static void assert_strain(const struct box *x, double dt, double G[3][3]) {
    const struct bed_set *b = &x->bed.set;
    const int C = x->bed.components;
    double trace = 0, size = 0;
    int rubbed = 0;
    for (int k = 0; k < x->bed.dim; k++) trace += G[k][k];
    for (int i = 0; i < C; i++)
        for (int j = 0; j < C; j++) size = larger(size, fabs(G[i][j]));
    for (int f = 0; f < b->faces; f++) {
        if (b->kind[f] != BED_INNER) continue;
        const double *rho = x->bed.lines->rho, l = rho[b->left[f]], r = rho[b->right[f]];
        const double stiff = 2 * modulus_of(x) * dt * smaller(l, r) / x->bed.limit;
        if (smaller(l, r) < 0.5 * x->bed.limit || !spanned(x, rho, b->left[f]) || !spanned(x, rho, b->right[f]))
            continue;
        rubbed++;
        for (int i = 0, t = 0; i < C; i++)
            for (int j = i; j < C; j++, t++) {
                const double D = 0.5 * (G[i][j] + G[j][i]) - (i == j ? trace / (x->material.disks ? 2 : 3) : 0);
                assert_true(fabs(b->stress[t][f] / stiff - D) < 1e-11 * size);
            }
    }
    assert_true(rubbed > 3);
}

/* D' of linear velocities is exact, also in cells at a surface, whatever thin gas beside them does. dt is so short that
 * friction does not change it. */
static void test_strain_of_linear_velocities_is_exact(void **state) {
    (void)state;
    static const struct box_form form[] = {
        {.n = {12, 1, 1}, .width = 1},
        {.n = {12, 1, 1}, .width = 1, .components = 2},
        {.n = {12, 1, 1}, .width = 1, .components = 3},
        {.n = {9, 8, 1}, .width = 1},
        {.n = {9, 8, 1}, .width = 1, .components = 3},
        {.n = {9, 8, 1}, .width = 1, .triangles = true},
        {.n = {9, 8, 1}, .width = 1, .triangles = true, .components = 3},
        {.n = {8, 8, 8}, .width = 1},
    };
    unsigned seed = 3;
    for (int k = 0; k < (int)(sizeof form / sizeof *form); k++) {
        struct box x;
        struct box_form f = form[k];
        const double about[3] = {4.2, 3.8, 4.1}, dt = 1e-9;
        double G[3][3] = {{0}};
        f.friction = law("Coulomb", 0.38);
        make(&x, &f);
        for (int i = 0; i < x.bed.dim; i++)
            for (int j = 0; j < x.bed.components; j++) G[i][j] = 0.1 * (chance(&seed) - 0.5);
        for (int i = 0; i < x.bed.set.cells; i++) {
            const double wild[3] = {chance(&seed), chance(&seed), chance(&seed)};
            set_linear(&x, i, 0.58 + 0.04 * chance(&seed), G, about);
            if (distance(&x, i, about) > 3.3) set_moving(&x, i, THIN, 1, wild);
        }
        rub(&x, dt);
        assert_strain(&x, dt, G);
        box_free(&x);
    }
}

/* A rough wall that moves with the gas along it, as linear shear does: its stress is G du/dy, and where gas moves
 * towards it or away from it that of the strain across it, too. */
static void test_strain_at_rough_walls_is_exact(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        struct box x;
        const double dt = 1e-9, about[3] = {0}, y = 0.03, height = 5, towards = k < 2 ? 0 : 0.02;
        double G[3][3] = {{0}, {y, 0, 0.5 * y}};
        make(&x, &(struct box_form){.n = {4, 5, 1},
                                    .width = 1,
                                    .components = 3,
                                    .periodic = {true},
                                    .triangles = k % 2,
                                    .friction = law("Coulomb", 0.38)});
        for (int i = 0; i < x.bed.set.cells; i++) {
            set_linear(&x, i, PACKED, G, about);
            x.bed.set.U[2][i] += towards * x.bed.set.U[0][i];
        }
        for (int f = 0; f < x.bed.set.faces; f++) {
            const bool top = x.bed.set.left[f] >= 0;
            const double normal = x.shapes.normal[1][x.bed.set.shape[f]], up = top ? normal : -normal;
            if (x.bed.set.kind[f] != BED_WALL) continue;
            x.bed.set.wall_friction[f] = HUGE_VAL;
            x.bed.set.wall_speed[0][f] = up > 0 ? y * height : 0;
            x.bed.set.wall_speed[2][f] = up > 0 ? 0.5 * y * height : 0;
        }
        rub(&x, dt);
        if (towards == 0) assert_strain(&x, dt, G);
        const double shear = modulus_of(&x) * dt * PACKED / packing_per_density(&x.material) / x.bed.limit * y;
        for (int f = 0; f < x.bed.set.faces; f++) {
            if (x.bed.set.kind[f] != BED_WALL) continue;
            const double normal = x.shapes.normal[1][x.bed.set.shape[f]];
            assert_true(fabs(x.bed.set.stress[1][f] - shear) < 1e-11 * shear);
            const double away = x.bed.set.left[f] < 0 ? normal : -normal; /* upwards from the floor */
            const double stretch =
                2 * shear / y * away * towards / x.shapes.depth[x.bed.set.left[f] < 0][x.bed.set.shape[f]];
            assert_true(fabs(x.bed.set.stress[0][f] + stretch / 3) < 1e-11 * shear);
            assert_true(fabs(x.bed.set.stress[3][f] - stretch * 2 / 3) < 1e-11 * shear);
            assert_true(fabs(x.bed.lines->traction[0][f] - normal * shear) < 1e-11 * shear);
            assert_true(fabs(x.bed.lines->traction[2][f] - normal * 0.5 * shear) < 1e-11 * shear);
        }
        box_free(&x);
    }
}

static double total(const struct box *x, int v) {
    double sum = 0;
    for (int i = 0; i < x->bed.set.cells; i++) sum += x->bed.set.U[v][i] * volume_of(x, i);
    return sum;
}

static void step(struct box *x, double dt, const double gravity[MAX_DIM]) {
    bool done;
    ok(bed_step(&x->bed, dt, gravity, &done));
    assert_true(done);
}

/* The velocity (a x, -a y) slips along walls at x = 0 and y = 0. Beside the walls across from these it passes through
 * them, so D' is not exact there. */
static void test_strain_at_smooth_walls_is_exact(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        struct box x;
        const double dt = 1e-9, about[3] = {0}, a = 0.03;
        double G[3][3] = {{a, 0}, {0, -a}};
        make(&x, &(struct box_form){.n = {6, 6, 1}, .width = 1, .triangles = triangles, .friction = law("Coulomb", 1)});
        for (int i = 0; i < x.bed.set.cells; i++) set_linear(&x, i, PACKED, G, about);
        rub(&x, dt);
        const struct bed_set *b = &x.bed.set;
        const double want = 2 * modulus_of(&x) * dt * x.bed.lines->rho[0] / x.bed.limit * a;
        int inside = 0;
        for (int f = 0; f < b->faces; f++) {
            if (b->kind[f] != BED_INNER) continue;
            const double *l = x.centre[b->left[f]], *r = x.centre[b->right[f]];
            if (larger(larger(l[0], l[1]), larger(r[0], r[1])) > 4.9) continue;
            assert_true(fabs(b->stress[0][f] - want) < 1e-11 * want && fabs(b->stress[2][f] + want) < 1e-11 * want);
            inside++;
        }
        assert_true(inside > 30);
        box_free(&x);
    }
}

/* Velocities of second degree make a uniform force: each component of div 2 G D' from the second derivatives. */
static void test_force_of_bent_velocities_is_exact(void **state) {
    (void)state;
    static const struct box_form form[] = {{.n = {7, 7, 1}, .width = 1, .components = 3}, {.n = {7, 7, 7}, .width = 1}};
    for (int k = 0; k < 2; k++) {
        struct box x;
        struct box_form f = form[k];
        const double dt = 1e-9, a[3] = {0.01, 0.02, -0.03};
        f.friction = law("Coulomb", 1);
        make(&x, &f);
        for (int i = 0; i < x.bed.set.cells; i++) {
            double u[3] = {0}, *c = x.centre[i];
            for (int m = 0; m < 3; m++) u[m] = a[m] * (c[0] * c[0] + 2 * c[1] * c[1] + 3 * c[2] * c[2] + c[0] * c[1]);
            set_moving(&x, i, PACKED, 1, u);
            x.bed.set.pressure[i] = PRESSURE;
        }
        rub(&x, dt);
        const int middle = x.bed.set.cells / 2;
        const double rho = x.bed.lines->rho[middle], per = 2 * modulus_of(&x) * dt * dt / x.bed.limit;
        const double bend[3][3] = {{2, 1, 0}, {1, 4, 0}, {0, 0, k ? 6 : 0}}; /* second derivatives of u/a */
        for (int m = 0; m < 3; m++) {
            double force = 0; /* (laplacian u + grad div u)/2 - grad div u/3 */
            for (int n = 0; n < 3; n++) force += 0.5 * a[m] * bend[n][n] + (0.5 - 1. / 3) * a[n] * bend[m][n];
            assert_true(rho > 0 && fabs(x.bed.lines->rubbed[m][middle] - per * force) < 1e-10 * per * 0.1);
        }
        box_free(&x);
    }
}

/* The velocities for which friction is solved have what pressure and weight give to the cells: stress is that of the
 * velocities which a short step without friction makes. */
static void test_pressure_and_weight_act_beside_friction(void **state) {
    (void)state;
    const double dt = 1e-7, gravity[MAX_DIM] = {3, -5, 2};
    for (int triangles = 0; triangles < 2; triangles++) {
        struct box one, two;
        struct box_form f = {.n = {5, 5, 1}, .width = 1, .components = 3, .triangles = triangles};
        unsigned seed = 9;
        double most = 0, size = 0;
        f.friction = law("Coulomb", 1);
        f.friction.params.cohesion = 1e9;
        make(&one, &f);
        make(&two, &f);
        const int cells = one.bed.set.cells;
        for (int i = 0; i < cells; i++)
            set_moving(&one, i, 0.58 + 0.04 * chance(&seed), 1 + 0.1 * chance(&seed), (const double[]){0, 0, 0});
        step(&one, dt, gravity);
        for (int i = 0; i < cells; i++) most = larger(most, one.bed.lines->first_p[i]);
        for (int i = 0; i < cells; i++) {
            double u[3];
            for (int m = 0; m < 3; m++)
                u[m] = one.bed.lines->after[m + 1][i] - one.bed.lines->u[m][i] - one.bed.lines->rubbed[m][i];
            set_moving(&two, i, one.bed.lines->rho[i] * packing_per_density(&one.material), 1, u);
            two.bed.set.pressure[i] = most;
        }
        rub(&two, dt);
        for (int t = 0; t < 6; t++)
            for (int e = 0; e < one.bed.set.faces; e++) size = larger(size, fabs(two.bed.set.stress[t][e]));
        for (int t = 0; t < 6; t++)
            for (int e = 0; e < one.bed.set.faces; e++)
                assert_true(fabs(one.bed.set.stress[t][e] - two.bed.set.stress[t][e]) < 1e-4 * size);
        assert_true(size > 0);
        box_free(&one);
        box_free(&two);
    }
}

/* Uniform shear that yields has the stress mu(I) p; where s < 1 the part s of it. */
static void test_sheared_gas_has_the_yield_stress(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        struct box x;
        const double rate = 3 * (1 + k % 3), height = 5, alpha = k < 3 ? PACKED : 0.53, s = k < 3 ? 1 : 0.03 / 0.076;
        double G[3][3] = {{0}, {rate}};
        make(&x, &(struct box_form){.n = {2, 5, 1}, .width = 1, .periodic = {true}, .friction = law("muI", 0.38)});
        for (int i = 0; i < x.bed.set.cells; i++) set_linear(&x, i, alpha, G, (const double[]){0, 0, 0});
        for (int f = 0; f < x.bed.set.faces; f++) {
            const bool low = x.bed.set.left[f] < 0;
            x.bed.set.wall_friction[f] = HUGE_VAL;
            x.bed.set.wall_speed[0][f] = low ? 0 : rate * height;
        }
        rub(&x, 0.1);
        const double I = rate * x.bed.friction.grain / sqrt(PRESSURE), yield = 0.38 + 0.19 / (1 + 0.279 / I);
        for (int f = 0; f < x.bed.set.faces; f++) {
            const double size = hypot(x.bed.set.stress[0][f], x.bed.set.stress[1][f]);
            assert_true(fabs(size - s * yield * PRESSURE) < 1e-12 * PRESSURE);
        }
        box_free(&x);
    }
}

/* Returns the yield stress of a face by docs/physics.md 9.3: mu_static 0.38, cohesion 100, k = 0.5; on walls that
 * grains slip on muWall 0.2 and no cohesion. p: of the cells. */
static double yield_of_face(const struct box *x, const double *p, int f, double g) {
    const struct bed_set *b = &x->bed.set;
    const bool across = b->shape[f] == 1;
    double share = 0, contact = 1, light = HUGE_VAL, P = 0, weights = 0, depth = 0;
    for (int right = 0; right < 2; right++) {
        const int i = right ? b->right[f] : b->left[f], other = right ? b->left[f] : b->right[f];
        if (i < 0) continue;
        const double rho = x->bed.lines->rho[i], s = (rho * packing_per_density(&x->material) - 0.5) / 0.076;
        const double weight = x->bed.lines->rho[other < 0 ? i : other];
        share = larger(share, smaller(larger(s, 0), 1));
        contact = smaller(contact, larger(s, 0));
        P += weight * (p[i] + (across ? (right ? 0.5 : -0.5) * rho * g : 0));
        weights += weight;
        light = smaller(light, rho);
        depth += 0.5;
    }
    P = larger(P / weights, 0);
    const double weight = light * g * depth, k = light > 0.1 * x->bed.limit ? 0.5 : 0;
    if (b->kind[f] == BED_WALL && b->wall_friction[f] < HUGE_VAL) return 0.2 * share * P;
    return share * P > 0 ? 0.38 * share * P + 100 * contact + k * weight * larger(0, 1 - P / (2 * weight)) : 0;
}

/* Stress beyond the yield stress falls to it at once, whatever stands beside a face. */
static void test_stress_falls_to_the_yield_stress(void **state) {
    (void)state;
    enum { N = 54 };
    const double g = 3, gravity[MAX_DIM] = {0, -g}, kinds[] = {THIN, 0.25, 0.53, PACKED};
    double p[N];
    int yields = 0;
    struct box x;
    unsigned seed = 4;
    bool done;
    struct box_form f = {.n = {6, 9, 1}, .width = 1, .friction = law("muI", 0.38)};
    f.friction.params.cohesion = 100;
    f.friction.params.surface_cohesion = 0.5;
    make(&x, &f);
    for (int i = 0; i < N; i++) {
        set_moving(&x, i, kinds[(int)(4 * chance(&seed))], 1, (const double[]){0, 0});
        x.bed.set.pressure[i] = p[i] = 2 + 8 * chance(&seed);
    }
    for (int e = 0; e < x.bed.set.faces; e++) {
        x.bed.set.wall_friction[e] = x.bed.set.kind[e] == BED_WALL ? (e % 2 ? HUGE_VAL : 0.2) : 0;
        x.bed.set.stress[1][e] = 1e3;
    }
    ok(bed_step(&x.bed, 1e-12, gravity, &done));
    for (int e = 0; e < x.bed.set.faces; e++) {
        const double want = yield_of_face(&x, p, e, g);
        assert_true(fabs(x.bed.set.stress[1][e] - want) < 1e-9);
        yields += want > 0;
    }
    assert_true(yields > 50);
    box_free(&x);
}

/* Packed gas that is sheared and shaken, on rough walls. */
static void set_shaken(struct box *x, unsigned seed) {
    for (int i = 0; i < x->bed.set.cells; i++) {
        double u[3];
        for (int k = 0; k < 3; k++) u[k] = 0.02 * (chance(&seed) - 0.5) + 0.01 * x->centre[i][1];
        set_moving(x, i, 0.56 + 0.05 * chance(&seed), 1e-4, u);
    }
    for (int f = 0; f < x->bed.set.faces; f++)
        x->bed.set.wall_friction[f] = x->bed.set.kind[f] == BED_WALL ? (f % 2 ? HUGE_VAL : 0.2) : 0;
}

static const struct box_form SHAKEN[] = {{.n = {8, 7, 1}, .width = 1, .periodic = {true}},
                                         {.n = {8, 7, 1}, .width = 1, .components = 3},
                                         {.n = {8, 6, 1}, .width = 1, .periodic = {true}, .triangles = true},
                                         {.n = {5, 5, 5}, .width = 1, .periodic = {true, false, true}}};
enum { SHAKEN_FORMS = sizeof SHAKEN / sizeof *SHAKEN };

/* What friction gives to the cells is the traction of the walls. */
static void assert_momentum(const struct box *x, double dt) {
    const struct bed_set *b = &x->bed.set;
    double most = 0;
    for (int m = 0; m < x->bed.components; m++) {
        double cells = 0, walls = 0, size = 0;
        for (int i = 0; i < b->cells; i++) {
            const double gain = x->bed.lines->rho[i] * volume_of(x, i) * x->bed.lines->rubbed[m][i];
            cells += gain;
            size += fabs(gain);
        }
        for (int f = 0; f < b->faces; f++)
            if (b->kind[f] == BED_WALL)
                walls += (b->left[f] < 0 ? -dt : dt) * x->shapes.area[b->shape[f]] * x->bed.lines->traction[m][f];
        assert_true(fabs(cells - walls) < 1e-13 * size);
        most = larger(most, fabs(walls) / size);
    }
    assert_true(most > 1e-3);
}

/* No stress is beyond muDynamic times the larger of the pressures p beside it. */
static void assert_bounded(const struct box *x, const double *p) {
    const int C = x->bed.components;
    for (int f = 0; f < x->bed.set.faces; f++) {
        const int l = x->bed.set.left[f], r = x->bed.set.right[f];
        const double most = larger(l < 0 ? 0 : p[l], r < 0 ? 0 : p[r]);
        double square = 0;
        for (int i = 0, t = 0; i < C; i++)
            for (int j = i; j < C; j++, t++)
                square += (i == j ? 0.5 : 1) * x->bed.set.stress[t][f] * x->bed.set.stress[t][f];
        assert_true(sqrt(square) <= 1.5 * 0.38 * most * (1 + 1e-12));
    }
}

/* The energy that a step takes from gas between walls at rest is what friction takes. Friction that starts without
 * stress never gives more than it has taken. `heating` leaves that part of it in the gas, and nothing that was not
 * taken, but for what elastic gas has as it springs back. */
static void test_momentum_and_energy(void **state) {
    (void)state;
    const double none[MAX_DIM] = {0};
    for (int k = 0; k < 3 * SHAKEN_FORMS; k++) {
        struct box x;
        struct box_form f = SHAKEN[k % SHAKEN_FORMS];
        const double heating = 0.5 * (k / SHAKEN_FORMS);
        f.friction = law("muI", 0.38);
        f.friction.params.heating = heating;
        make(&x, &f);
        set_shaken(&x, 3);
        double rubbed = 0, lifted = 0;
        const int E = x.bed.components + 1;
        const double before = total(&x, E);
        for (int n = 0; n < 60; n++) {
            double p[150];
            assert_true(x.bed.set.cells <= 150);
            memcpy(p, x.bed.set.pressure, (size_t)x.bed.set.cells * sizeof *p);
            step(&x, 0.2, none);
            assert_momentum(&x, 0.2);
            assert_bounded(&x, n > 0 ? p : x.bed.lines->first_p);
            rubbed += x.bed.set.rubbed[0];
            lifted += x.bed.set.lift[0];
            assert_true(heating > 0 || rubbed < 0);
        }
        assert_true(heating < 1 ? -rubbed > 0.1 * before : fabs(rubbed) < 0.01 * before);
        assert_true(fabs(total(&x, E) - before - rubbed - lifted) < 1e-12 * before);
        box_free(&x);
    }
}

/* A layer of packed gas of uniform temperature whose pressure carries its weight across a floor: 20 cells high, under a
 * smooth lid. */
static double lay_layer(struct box *x, double floor, const double gravity[MAX_DIM]) {
    static const struct box_form form = {.n = {2, 20, 1}, .width = 1, .periodic = {true}};
    const int rows = form.n[1], each = form.n[0];
    const double still[3] = {0}, T = 40;
    double alpha = 0.63, bottom = 0;
    struct box_form rough = form;
    rough.friction = law("muI", 0.38);
    make(x, &rough);
    for (int row = 0; row < rows; row++) {
        const double rho = alpha / packing_per_density(&x->material), eps = eps_of(&x->material, T);
        double p, c2, gruneisen;
        x->bed.eos->state(&x->material, 1, &rho, &eps, &p, &c2, &gruneisen);
        if (row == 0) bottom = p - 0.5 * rho * gravity[1] * x->form.width;
        for (int i = 0; i < each; i++) set_moving(x, row * each + i, alpha, T, still);
        alpha = above(x, p, rho, T, -0.5 * gravity[1] * x->form.width);
    }
    for (int f = 0; f < x->bed.set.faces; f++) {
        const bool low = x->bed.set.kind[f] == BED_WALL && x->bed.set.left[f] < 0;
        x->bed.set.wall_friction[f] = low && x->bed.set.shape[f] == 1 ? floor : 0;
    }
    return bottom;
}

static const double STEEP = 150; /* the lid bears about twice the weight */

/* Below the angle of friction a layer on a rough floor comes to rest: friction carries its weight to round-off. */
static void test_a_layer_rests_below_the_angle(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0.3 * STEEP, -STEEP};
    struct box x;
    lay_layer(&x, HUGE_VAL, gravity);
    for (int n = 0; n < 100; n++) step(&x, 0.01, gravity);
    for (int i = 0; i < x.bed.set.cells; i++) {
        assert_true(fabs(x.bed.set.U[1][i] / x.bed.set.U[0][i]) < 1e-13 * sqrt(20 * STEEP));
        assert_true(fabs(x.bed.lines->rubbed[0][i] + 0.01 * gravity[0]) < 1e-11 * 0.01 * gravity[0]);
    }
    for (int f = 0; f < x.bed.set.faces; f++)
        if (x.bed.set.wall_friction[f] > 0) {
            const double weight = gravity[0] * total(&x, 0) / 2;
            assert_true(fabs(x.bed.lines->traction[0][f] / weight - 1) < 1e-11);
        }
    box_free(&x);
}

/* The same on triangles, whose cells have forces of their own, other than those of their faces: the faces' velocities,
 * which carry the gas, are 0, too. */
static void test_triangles_rest_below_the_angle(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0.3, -1}, one = 1;
    struct box x;
    make(&x, &(struct box_form){
                 .n = {6, 6, 1}, .width = 1, .periodic = {true}, .triangles = true, .friction = law("muI", 0.38)});
    const double rho = PACKED / packing_per_density(&x.material);
    double p, c2, gruneisen;
    x.bed.eos->state(&x.material, 1, &rho, &one, &p, &c2, &gruneisen);
    for (int i = 0; i < x.bed.set.cells; i++) {
        const double eps = rho * (10 + gravity[1] * x.centre[i][1]) / p;
        set_moving(&x, i, PACKED, temperature_of(&x.material, eps), (const double[]){0, 0, 0});
    }
    for (int f = 0; f < x.bed.set.faces; f++)
        if (x.bed.set.kind[f] == BED_WALL && x.shapes.normal[1][x.bed.set.shape[f]] < 0)
            x.bed.set.wall_friction[f] = HUGE_VAL;
    for (int n = 0; n < 160; n++) step(&x, 0.05, gravity);
    for (int i = 0; i < x.bed.set.cells; i++)
        for (int k = 0; k < 2; k++) assert_true(fabs(x.bed.set.U[k + 1][i]) < 1e-14 * x.bed.set.U[0][i]);
    for (int f = 0; f < x.bed.set.faces; f++) assert_true(fabs(x.bed.lines->U[f]) < 1e-14);
    box_free(&x);
}

/* On a floor that is smoother than the grains it slides as a block, with g sin less what the floor bears times mu. The
 * yield is that of the step before, so friction is too large by the change of the velocity in a step over it. */
static void test_a_layer_slides_on_a_smooth_floor(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0.3 * STEEP, -STEEP}, mu = 0.08, dt = 0.01;
    struct box x;
    lay_layer(&x, mu, gravity);
    const double each = total(&x, 0) / 2;
    for (int n = 0; n < 300; n++) {
        const double before = total(&x, 1), load = x.bed.set.pressure[0] + 0.5 * STEEP * x.bed.set.U[0][0];
        step(&x, dt, gravity);
        const double gain = (total(&x, 1) - before) / (2 * each * dt), floor = mu * load / each;
        if (n > 50) assert_true(fabs(gravity[0] - floor - gain) < 0.5 * floor / n);
    }
    const double bottom = x.bed.set.U[1][0] / x.bed.set.U[0][0], top = x.bed.set.U[1][39] / x.bed.set.U[0][39];
    assert_true(bottom > 20 && fabs(top - bottom) < 1e-4 * top);
    box_free(&x);
}

/* Gas below alphaFriction that is too hot to lie in its cells has the bits of gas without friction. */
static void test_gas_that_is_not_packed_has_no_friction(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {-1, -9.81, 1};
    struct box one, two;
    struct box_form f = SHAKEN[2];
    make(&one, &(struct box_form){
                   .n = {8, 6, 1}, .width = 1, .periodic = {true}, .triangles = true, .friction = law("muI", 1)});
    box_make_of(&two, comm, "TorquatoSpheres", 1, &f);
    unsigned seed = 2;
    for (int i = 0; i < one.bed.set.cells; i++) {
        const double alpha = 0.4 + 0.09 * chance(&seed), u[2] = {chance(&seed), chance(&seed)};
        set_moving(&one, i, alpha, 10, u);
        set_moving(&two, i, alpha, 10, u);
    }
    for (int e = 0; e < one.bed.set.faces; e++)
        one.bed.set.wall_friction[e] = one.bed.set.kind[e] == BED_WALL ? HUGE_VAL : 0;
    for (int n = 0; n < 3; n++) {
        step(&one, 0.02, gravity);
        step(&two, 0.02, gravity);
    }
    for (int v = 0; v < 4; v++)
        assert_memory_equal(one.bed.set.U[v], two.bed.set.U[v], (size_t)one.bed.set.cells * sizeof(double));
    box_free(&one);
    box_free(&two);
}

/* Cold gas under gravity lies on the bottom of its cell (lying_share): it rubs, though it fills the cell in part. */
static void test_cold_gas_lies_in_its_cells(void **state) {
    (void)state;
    assert_true(lying_share(0, 10, 0.3) == 1 && fabs(lying_share(0, 10, 0.2) - 0.5) < 1e-15);
    assert_true(fabs(lying_share(1, 10, 0.3) - 0.5) < 1e-15); /* half of the temperature at which it is a gas */
    assert_true(lying_share(2, 10, 0.3) == 0 && lying_share(0, 10, 0.1) == 0 && lying_share(0, 0, 0.3) == 0);
}

/* A step of more than 1000 stages is not made, and ends soon also where pressures are beyond all bounds. */
static void test_too_long_steps_fail(void **state) {
    (void)state;
    const double none[MAX_DIM] = {0};
    for (int k = 0; k < 2; k++) {
        struct box x;
        bool done = true;
        struct box_form f = SHAKEN[0];
        f.friction = law("muI", 0.38);
        make(&x, &f);
        set_shaken(&x, 3);
        if (k == 1) x.bed.set.pressure[5] = HUGE_VAL;
        ok(bed_step(&x.bed, k == 0 ? 1e4 : 0.2, none, &done));
        assert_false(done);
        box_free(&x);
    }
}

/* Sets a bed of many like layers to the same random state as one of the first `cells` alone, which moves along some
 * axes. */
static void set_layers(struct box *x, int cells, int axes, unsigned seed) {
    for (int i = 0; i < x->bed.set.cells; i++) {
        unsigned own = seed + 77 * (unsigned)(i % cells);
        double u[3];
        chance(&own);
        for (int k = 0; k < 3; k++) u[k] = (k < axes ? 0.1 : 0) * (chance(&own) - 0.5);
        set_moving(x, i, 0.52 + 0.1 * chance(&own), 1e-4, u);
        x->bed.set.pressure[i] = 0.01 * (1 + chance(&own));
    }
    for (int f = 0; f < x->bed.set.faces; f++) {
        if (x->bed.set.kind[f] != BED_WALL) continue;
        x->bed.set.wall_friction[f] = x->bed.set.left[f] < 0 ? HUGE_VAL : 0.2;
        for (int k = 0; k < x->bed.components; k++) x->bed.set.wall_speed[k][f] = k < axes ? 0.01 * k : 0;
    }
}

/* Axes along which all is alike may be missing from the mesh: a line with two or three components, and a plane with
 * three, have the numbers of the full mesh; a plane flow in space those of the plane. dt is so short that each takes
 * two stages. */
static void test_missing_axes(void **state) {
    (void)state;
    static const struct {
        int n[3], components, full[3];
    } pair[] = {{{12, 1, 1}, 1, {12, 3, 1}},
                {{6, 5, 1}, 2, {6, 5, 2}},
                {{12, 1, 1}, 2, {12, 3, 1}},
                {{12, 1, 1}, 3, {12, 2, 2}},
                {{6, 5, 1}, 3, {6, 5, 2}}};
    const double g[MAX_DIM] = {-0.5, 0.3, 0.2}, dt = 0.15;
    for (int k = 0; k < (int)(sizeof pair / sizeof *pair); k++) {
        struct box small, full;
        double most = 0, gravity[MAX_DIM] = {0};
        const int axes = pair[k].components;
        struct box_form f = {.width = 1, .components = axes, .friction = law("muI", 0.38)};
        memcpy(f.n, pair[k].n, sizeof f.n);
        make(&small, &f);
        for (int a = 0; a < 3; a++) f.periodic[a] = pair[k].n[a] == 1;
        memcpy(f.n, pair[k].full, sizeof f.n);
        memcpy(gravity, g, (size_t)axes * sizeof *g);
        f.components = f.n[2] > 1 || axes > 2 ? 3 : 2;
        make(&full, &f);
        const int cells = small.bed.set.cells;
        for (int n = 0; n < 3; n++) { /* the stress is kept */
            set_layers(&small, cells, axes, 5 + n);
            set_layers(&full, cells, axes, 5 + n);
            bool done;
            ok(bed_step(&small.bed, dt, gravity, &done));
            ok(bed_step(&full.bed, dt, gravity, &done));
            for (int i = 0; i < full.bed.set.cells; i++)
                for (int m = 0; m < f.components; m++) {
                    const double u = m < axes ? small.bed.lines->rubbed[m][i % cells] : 0;
                    most = larger(most, fabs(u));
                    assert_true(fabs(full.bed.lines->rubbed[m][i] - u) < 1e-15);
                }
        }
        assert_true(most > 1e-3);
        box_free(&small);
        box_free(&full);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rigid_rotation_feels_no_friction),
        cmocka_unit_test(test_strain_of_linear_velocities_is_exact),
        cmocka_unit_test(test_strain_at_rough_walls_is_exact),
        cmocka_unit_test(test_strain_at_smooth_walls_is_exact),
        cmocka_unit_test(test_force_of_bent_velocities_is_exact),
        cmocka_unit_test(test_pressure_and_weight_act_beside_friction),
        cmocka_unit_test(test_sheared_gas_has_the_yield_stress),
        cmocka_unit_test(test_stress_falls_to_the_yield_stress),
        cmocka_unit_test(test_momentum_and_energy),
        cmocka_unit_test(test_gas_that_is_not_packed_has_no_friction),
        cmocka_unit_test(test_cold_gas_lies_in_its_cells),
        cmocka_unit_test(test_too_long_steps_fail),
        cmocka_unit_test(test_missing_axes),
        cmocka_unit_test(test_a_layer_rests_below_the_angle),
        cmocka_unit_test(test_triangles_rest_below_the_angle),
        cmocka_unit_test(test_a_layer_slides_on_a_smooth_floor),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
