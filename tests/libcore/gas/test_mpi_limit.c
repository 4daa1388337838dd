/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The theorem of libcore/schemes/limit.h on both mesh engines: one limited Euler stage from random admissible cells
 * with K <= 1 is admissible everywhere, conserves, and has the same bits on all ranks; smooth flow keeps its order. */
#include "libcore/lattice/tiles.h"
#include "libcore/polyhedral/cells.h"
#include "tests/defaults.h"

#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;

static uint64_t seed;
static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

static void set_models(struct scene *s, const char *eos, const char *flux, const char *scheme) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find(eos),
        .flux = flux_find(flux),
        .flux_params = own_defaults(&flux_find(flux)->model),
        .reconstruct = reconstruct_find(scheme),
        .polynomial = polynomial_find(scheme),
        .stepper = stepper_find("SSPRK3"),
        .skip_uniform = true};
    set_walls(s, "slip");
}

static void open_lattice(struct scene *s, const struct comm *c, int dim, const int n[3], bool periodic) {
    open_box(s, c, dim, n, (double[3]){1, 1.5, 0.7}, (bool[3]){periodic, periodic, periodic}, dim == 1 ? 16 : 8);
}

/* Near vacuum, near packing, between; Mach numbers to 1000. */
static void start_at_random(struct scene *s, uint64_t from) {
    const int n = s->cells;
    const double limit = s->gas->limits.most;
    double *all = malloc(5 * (size_t)n * sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    seed = from;
    for (int i = 0; i < n; i++) {
        double kind = uniform(0, 3), T = pow(10, uniform(-3, 3)), mach = pow(10, uniform(-2, 3));
        all[i] = limit * (kind < 1   ? pow(10, uniform(-10, -0.1))
                          : kind < 2 ? 1 - pow(10, uniform(-4, -1))
                                     : uniform(0.1, 0.9));
        for (int k = 0; k < 3; k++) u[k][i] = mach * sqrt(T) * uniform(-1, 1);
        all[4 * n + i] = T;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

/* |v| + c of a state, and v; normal: unit. */
static double speed_of(const struct gas *g, const double *U, long size, const double *normal, double *v) {
    double velocity[MAX_DIM], *line[MAX_DIM] = {&velocity[0], &velocity[1], &velocity[2]}, eps, p, c2, gruneisen;
    velocity_row(1, g->dim, size, U, line, &eps);
    g->models.eos->state(&g->models.material, 1, U, &eps, &p, &c2, &gruneisen);
    *v = 0;
    for (int k = 0; k < g->dim; k++) *v += velocity[k] * normal[k];
    return fabs(*v) + sqrt(c2);
}

static double face_speed(const struct gas *g, const double *l, const double *r, long size, const double *normal) {
    double vl, vr, s = speed_of(g, l, size, normal, &vl);
    s = fmax(s, speed_of(g, r, size, normal, &vr));
    return fmax(s, (*l * vl - *r * vr) / (g->limits.most - fmax(*l, *r)));
}

struct rates { /* sum of A s / V: K is dt times that */
    struct gas *g;
    const double *U;
    double most;
};

static void rate_visit(void *context, long offset, int n) {
    struct rates *r = context;
    const struct forest *f = r->g->forest;
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int k = 0; k < f->dim; k++) {
            const double *here = r->U + offset + i, normal[3] = {k == 0, k == 1, k == 2};
            sum += face_speed(r->g, here - f->stride[k], here, f->size, normal) / f->width[k];
            sum += face_speed(r->g, here, here + f->stride[k], f->size, normal) / f->width[k];
        }
        r->most = fmax(r->most, sum);
    }
}

/* The largest dt with K <= 1 in all cells; the ghosts of U are filled. */
static double largest_step(struct gas *g) {
    struct rates r = {.g = g};
    for (int t = 0; g->forest && t < g->forest->ntiles; t++) {
        r.U = g->U.block[t];
        runs_visit(g->forest, &g->forest->tile[t], 0, rate_visit, &r);
    }
    if (g->cells) {
        const struct polyhedra *m = g->cells->polyhedra;
        double *sum = calloc((size_t)m->size, sizeof *sum);
        for (int i = 0; i < m->face.n; i++) {
            const double *U = g->U.block[0];
            double normal[3] = {0, 0, 0};
            for (int k = 0; k < g->dim; k++) normal[k] = m->face.normal[k][i];
            double s = m->face.area[i] * face_speed(g, U + m->face.left[i], U + m->face.right[i], m->size, normal);
            sum[m->face.left[i]] += s / m->volume[m->face.left[i]];
            sum[m->face.right[i]] += s / m->volume[m->face.right[i]];
        }
        for (int i = 0; i < m->nown; i++) r.most = fmax(r.most, sum[i]);
        free(sum);
    }
    comm_max(g->comm, &r.most, 1);
    return 1 / r.most;
}

static void flag_all(struct gas *g) {
    for (int t = 0; g->forest && t < g->forest->ntiles; t++)
        for (long i = 0; i < g->forest->size; i++) g->limits.flags.cells[t][i] = 1;
    for (int i = 0; g->cells && i < g->cells->polyhedra->nown; i++) g->limits.flags.cells[0][i] = 1;
    (void)flags_send(g);
}

/* U <- an Euler stage from U (a, U0: of a Runge-Kutta stage) with every face limited; dt 0: as large as K <= 1 allows.
 * Returns the number of faces that were moved. */
static long limited_stage(struct gas *g, struct state *U0, double a, double dt) {
    struct gas_speed speed;
    gas_speed(g, &speed);
    for (int k = 0; k < 3; k++) g->step.fastest[k] = speed.axis[k];
    g->engine->stage.fronts(g, &speed);
    g->step.dt = dt > 0 ? dt : largest_step(g);
    (void)g->engine->stage.stage(g, U0, &g->U, &g->W, a, dt, NULL);
    if (dt == 0) dt = largest_step(g);
    flag_all(g);
    g->engine->stage.redo(g, U0, &g->U, &g->W, a, dt);
    flags_clear(g);
    struct state old = g->U;
    g->U = g->W;
    g->W = old;
    g->step.speed_known = false;
    long faces = g->limits.faces;
    comm_sum_long(g->comm, &faces, 1);
    return faces;
}

/* From many random states: admissible, conserved, and on all ranks together what one rank finds. */
static void stages_from_random_states(struct scene *s, struct scene *one, bool periodic, const char *name) {
    long faces = 0;
    for (uint64_t trial = 1; trial <= 4; trial++) {
        double before[MAX_VAR], after[MAX_VAR];
        start_at_random(s, trial);
        start_at_random(one, trial);
        ok(gas_totals(s->gas, before));
        faces = limited_stage(s->gas, &s->gas->U, 0, 0);
        assert_int_equal(limited_stage(one->gas, &one->gas->U, 0, 0), faces);
        assert_true(faces > 0);
        status bad = gas_check(s->gas);
        if (bad) fail_msg("%s: %s", name, status_text(bad));
        ok(gas_totals(s->gas, after));
        for (int v = 0; v < s->dim + 2; v++) {
            bool momentum = v > 0 && v <= s->dim;
            if (momentum && !periodic) continue;
            double scale = momentum ? sqrt(2 * before[0] * before[s->dim + 1]) : before[v];
            if (!(fabs(after[v] - before[v]) <= 1e-13 * scale))
                fail_msg("%s: variable %d: %.17g becomes %.17g", name, v, before[v], after[v]);
        }
        double *U = state_of(s, world), *V = state_of(one, alone);
        assert_memory_equal(U, V, (size_t)((s->dim + 2) * s->cells) * sizeof *U);
        free(U);
        free(V);
    }
}

static void lattices(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++)
        for (int dim = 1; dim <= 3; dim++)
            for (int periodic = 0; periodic < 2; periodic++) {
                struct scene s, one;
                const int n[3] = {dim == 1 ? 200 : 22, 19, 11};
                set_models(&s, "GoldshteinShapiro", flux_table[flux].model.name, "WENO5");
                one = s;
                open_lattice(&s, world, dim, n, periodic);
                open_lattice(&one, alone, dim, n, periodic);
                stages_from_random_states(&s, &one, periodic, flux_table[flux].model.name);
                close_scene(&s);
                close_scene(&one);
            }
}

static void polyhedra(void **state) {
    (void)state;
    static const struct cells_recipe recipes[] = {
        {"triangles", 2, PRISMS, {10, 9, 1}, {0, 2, 1}, 0.2, {false, false, false}},
        {"warped hexahedra", 3, BOXES, {6, 5, 6}, {0, 1, 2}, 0.2, {false, false, false}},
        {"pyramids", 3, PYRAMIDS, {4, 4, 4}, {0, 1, 2}, 0.15, {false, false, false}},
        {"periodic tetrahedra", 3, TETS, {4, 4, 4}, {0, 1, 2}, 0.15, {true, true, true}},
    };
    for (int r = 0; r < 4; r++)
        for (int p = 0; p < polynomial_count; p++) {
            struct scene s, one;
            set_models(&s, "GoldshteinShapiro", p ? "common" : "Marquina", polynomial_table[p].model.name);
            one = s;
            open_polyhedra(&s, world, &recipes[r]);
            open_polyhedra(&one, alone, &recipes[r]);
            stages_from_random_states(&s, &one, recipes[r].cyclic[0], recipes[r].name);
            close_scene(&s);
            close_scene(&one);
        }
}

/* Mean error of a density wave 1 + a sin(2 pi x) at Mach 1 / sqrt(5/3) after a quarter of a period, every face limited
 * or as gas_step does it; the time step is small enough for the error in space to count. */
static double wave_error(int n, double a, bool force, long *moved) {
    struct scene s;
    double error = 0, h = 1.0 / n, t = 0, end = 0.25;
    set_models(&s, "perfectGas", "common", "WENO5");
    open_lattice(&s, alone, 1, (int[3]){n, 1, 1}, true);
    double *all = malloc(3 * (size_t)n * sizeof *all);
    for (int i = 0; i < n; i++) {
        all[i] = 1 + a * sin(6.283185307179586 * (i + 0.5) * h);
        all[n + i] = 1;
        all[2 * n + i] = 1 / all[i];
    }
    ok(gas_set(s.gas, all, (const double *const[3]){all + n, NULL, NULL}, all + 2 * n));
    *moved = 0;
    for (long steps = 0; t < end; steps++) {
        struct gas_speed speed;
        gas_speed(s.gas, &speed);
        double dt = fmin(0.4 * pow(h, 2. / 3) / speed.rate, end - t);
        if (force) {
            struct state *U0 = &s.gas->U0; /* a copy: stages only swap U and W */
            for (int b = 0; b < s.forest->ntiles; b++) {
                memcpy(U0->block[b], s.gas->U.block[b], (size_t)(3 * s.forest->size) * sizeof(double));
                memcpy(U0->varied[b], s.gas->U.varied[b], (size_t)s.gas->tiles->activity.nspans * sizeof(struct span));
            }
            for (int stage = 0; stage < 3; stage++) *moved += limited_stage(s.gas, U0, s.models.stepper->a[stage], dt);
        } else
            ok(gas_step(s.gas, t, &dt, 1, 0, 0, &speed));
        t += dt;
    }
    if (!force) *moved = gas_counts(s.gas).faces;
    double *U = state_of(&s, alone);
    for (int i = 0; i < n; i++) error += h * fabs(U[i] - 1 - a * sin(6.283185307179586 * ((i + 0.5) * h - end)));
    free(U);
    free(all);
    close_scene(&s);
    return error;
}

/* Order five stays where the limiter looks at every face of smooth flow and, in a wave that all but touches vacuum,
 * where it looks at cells that need it: none. */
static void order_stays(void **state) {
    (void)state;
    for (int force = 0; force < 2; force++) {
        const double a = force ? 0.8 : 0.9999;
        long moved[2];
        double coarse = wave_error(48, a, force, &moved[0]), fine = wave_error(96, a, force, &moved[1]);
        print_message("%s: %.3g, %.3g: order %.2f, faces moved %ld, %ld\n", force ? "all faces limited" : "as it runs",
                      coarse, fine, log2(coarse / fine), moved[0], moved[1]);
        assert_int_equal(moved[0] + moved[1], 0);
        assert_true(log2(coarse / fine) > 4.8);
    }
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    ok(comm_alone(&alone));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lattices),
        cmocka_unit_test(polyhedra),
        cmocka_unit_test(order_stays),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
