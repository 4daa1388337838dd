/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Heat that inelastic spheres conduct, with what grad rho adds to it, also under their weight: steady between walls of
 * each kind that heat crosses, on both mesh engines. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;

/* ---- the exact profile ---------------------------------------------------------------------------------------------
 */

enum { STEPS = 2000 };
static const double FLUX = 1.2; /* heat that flows along x */
static double weight;           /* m/s^2 against x */
static struct { double rho, T; } profile[STEPS + 1];

/* d rho/dx and dT/dx from heat dT/dx + cross d rho/dx = -FLUX and p_rho d rho/dx + p_T dT/dx = -rho weight. */
static void slopes(const struct gas_models *m, const double q[2], double out[2]) {
    const double eps = q[1] / (m->material.gamma - 1);
    double p, c2, gruneisen, bulk, shear, heat, cross;
    m->eos->state(&m->material, 1, &q[0], &eps, &p, &c2, &gruneisen);
    m->transport->coefficients(&m->transport_params,
                               &(struct closure_line){m->eos, &m->material, 1, &q[0], &q[1], NULL, NULL, false}, &bulk,
                               &shear, &heat);
    m->transport->cross(&m->transport_params,
                        &(struct closure_line){m->eos, &m->material, 1, &q[0], &q[1], NULL, NULL, false}, &cross);
    const double per_rho = c2 - p * gruneisen / q[0], per_T = p / q[1], det = heat * per_rho - cross * per_T;
    out[1] = (-FLUX * per_rho + cross * q[0] * weight) / det;
    out[0] = (-heat * q[0] * weight + FLUX * per_T) / det;
}

/* Runge and Kutta's, from the wall at x = 0 on. */
static void find_profile(const struct gas_models *m) {
    const double h = 1. / STEPS;
    double q[2] = {2, 3};
    for (int i = 0; i <= STEPS; i++) {
        double k[4][2], at[2];
        profile[i].rho = q[0];
        profile[i].T = q[1];
        for (int j = 0; j < 4; j++) {
            for (int v = 0; v < 2; v++) at[v] = j ? q[v] + h * (j == 3 ? 1 : 0.5) * k[j - 1][v] : q[v];
            slopes(m, at, k[j]);
        }
        for (int v = 0; v < 2; v++) q[v] += h / 6 * (k[0][v] + 2 * k[1][v] + 2 * k[2][v] + k[3][v]);
    }
}

static void conducting(const double x[3], double *rho, double u[3], double *T) {
    const double at = x[0] * STEPS;
    const int i = at < STEPS ? (int)at : STEPS - 1;
    (void)u;
    *rho = profile[i].rho + (at - i) * (profile[i + 1].rho - profile[i].rho);
    *T = profile[i].T + (at - i) * (profile[i + 1].T - profile[i].T);
}

/* Restitution of a wall at x = 1 that takes the heat: (1 - e^2) p sqrt(T/(2 pi)) = FLUX. */
static double taking(const struct gas_models *m) {
    const double rho = profile[STEPS].rho, T = profile[STEPS].T, eps = T / (m->material.gamma - 1);
    double p, c2, gruneisen;
    m->eos->state(&m->material, 1, &rho, &eps, &p, &c2, &gruneisen);
    return sqrt(1 - FLUX / (p * sqrt(T / TWO_PI)));
}

/* ---- what the schemes make of it -----------------------------------------------------------------------------------
 */

static const char *const walls[] = {"fixedValue", "granularWall", "JohnsonJacksonSlip"};
static const struct {
    struct cells_recipe recipe; /* n: of the coarse mesh */
    bool lattice, whole;        /* whole: also in whole steps */
    double most;
} meshes[] = {
    {{"1D lattice", 1, BOXES, {16, 1, 1}, {0, 1, 2}, 0, {false, true, true}}, true, true, 3e-5},
    {{"3D lattice", 3, BOXES, {16, 4, 4}, {0, 1, 2}, 0, {false, true, true}}, true, false, 3e-5},
    {{"line", 1, BOXES, {16, 1, 1}, {0, 1, 2}, 0.2, {false, true, true}}, false, true, 3e-5},
    {{"hexahedra", 3, BOXES, {8, 4, 4}, {0, 1, 2}, 0.15, {false, true, true}}, false, false, 1.1e-4},
    {{"mixed", 3, MIXED, {9, 3, 3}, {0, 1, 2}, 0.1, {false, true, true}}, false, false, 3e-5},
    {{"tetrahedra", 3, TETS, {6, 3, 3}, {0, 1, 2}, 0.1, {false, true, true}}, false, true, 4e-5},
};
enum { MESHES = sizeof meshes / sizeof *meshes };

static void open_mesh_of(struct scene *s, int mesh, int fine, int wall, const char *diffusion) {
    struct cells_recipe r = meshes[mesh].recipe;
    *s = (struct scene){.dim = r.dim, .models = spheres_models(0.7, 0.5, false, diffusion)};
    s->models.polynomial = polynomial_find("CWENO3");
    find_profile(&s->models);
    set_walls(s, "slip");
    const double restitution = taking(&s->models);
    s->rules[0].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {profile[0].T}};
    s->rules[1].temperature = (struct rule){.type = boundary_find(walls[wall])};
    if (wall == 0) s->rules[1].temperature.uniform[0] = profile[STEPS].T;
    if (wall == 1) s->rules[1].temperature.params.room[0] = restitution;
    if (wall == 2) {
        s->rules[1].temperature.params.room[0] = 0.3;
        s->rules[1].temperature.params.room[1] = restitution;
        s->rules[1].velocity = s->rules[1].temperature;
    }
    for (int k = 0; k < r.dim; k++) r.n[k] *= fine;
    if (meshes[mesh].lattice)
        open_box(s, world, r.dim, r.n, (double[3]){1, 1, 1}, r.cyclic, 8);
    else
        open_cells(s, world, &r);
    start(s, conducting);
}

/* The mean error after a time in which heat crosses the box, of whole steps without weight, or of diffusion alone with
 * the pull of weight on the walls: flow under gravity leaves a layer in the cells at a wall, in proportion to dt. */
static double error_of(int mesh, int fine, int wall, bool pulled) {
    struct scene s;
    weight = pulled ? 1.5 : 0;
    open_mesh_of(&s, mesh, fine, wall, "RKJ2");
    const int steps = (meshes[mesh].lattice || pulled ? 4 : 10) * meshes[mesh].recipe.n[0] * fine;
    double error = 0, *before = state_of(&s, world), *after;
    s.gas->diffusion.pull[0] = -weight;
    if (pulled)
        spread(&s, steps, 0.25 / steps);
    else
        go(&s, steps, 0.25 / steps);
    after = state_of(&s, world);
    for (int i = 0; i < s.cells; i++)
        for (int v = 0; v < s.dim + 2; v += s.dim + 1)
            error += fabs(after[v * s.cells + i] - before[v * s.cells + i]) / s.cells;
    free(before);
    free(after);
    close_scene(&s);
    return error;
}

static void conduction_is_steady(void **state) {
    (void)state;
    if (comm_size(world) > 1) skip(); /* other ranks have the same bits */
    for (int pulled = 0; pulled < 2; pulled++)
        for (int mesh = 0; mesh < MESHES; mesh++)
            for (int wall = 0; wall < (pulled ? 2 : 3) && (pulled || meshes[mesh].whole); wall++) {
                const double coarse = error_of(mesh, 1, wall, pulled), fine = error_of(mesh, 2, wall, pulled);
                print_message("%s%s, %s: %.3g, %.3g: order %.2f\n", pulled ? "weight, " : "", meshes[mesh].recipe.name,
                              walls[wall], coarse, fine, log2(coarse / fine));
                assert_true(log2(coarse / fine) > 1.9);
                assert_true(fine < meshes[mesh].most);
            }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(conduction_is_steady),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
