/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules of single faces of the flux `common`: which faces they take, which flux those get, and that all other faces
 * keep theirs. */
#include "libcore/schemes/flux_rules.h"

#include "tests/libcore/oracle.h"

#include "tests/libcore/schemes/strip.h"

enum { FACE = 5 }; /* the jump of the strips below lies between the cells FACE and FACE + 1 */

struct gas_state {
    double nu, u, p;
};

static double density_of(double nu) {
    return nu / packing_per_density(&granular);
}

/* Returns eps of a state: p is proportional to it. */
static double energy_of(struct gas_state q) {
    const double rho = density_of(q.nu), one = 1;
    double p, c2, g;
    eos_find("GoldshteinShapiro")->state(&granular, 1, &rho, &one, &p, &c2, &g);
    return q.p / p;
}

static struct strip jump(int dim, struct gas_state left, struct gas_state right, double across) {
    struct strip s = {.dim = dim};
    for (int i = 0; i < CELLS; i++) {
        const struct gas_state q = i <= FACE ? left : right;
        s.U[0][i] = density_of(q.nu);
        s.eps[i] = energy_of(q);
        s.u[0][i] = q.u;
        for (int k = 1; k < dim; k++) s.u[k][i] = k * across;
    }
    close_strip(&s);
    return s;
}

/* The flux of one face, with the rules of the given names (`all`, `none`, or one of them). */
static void flux_by(struct strip *s, const char *rule, const char *reconstruct, int face) {
    const struct flux *common = flux_find("common");
    struct own_params params = {{0}};
    for (int i = 0; i < common->model.nparam; i++) {
        const char *name = common->model.param[i].name;
        model_put(&common->model, &params, name, !strcmp(rule, "all") || !strcmp(rule, name));
    }
    flux_with(s, common, reconstruct_find(reconstruct), face, 1, &params);
}

static bool differ(struct strip *s, const char *a, const char *b, const char *reconstruct, int face) {
    struct strip other = *s;
    bool same = true;
    flux_by(s, a, reconstruct, face);
    flux_by(&other, b, reconstruct, face);
    for (int v = 0; v < s->dim + 2; v++) same &= s->out[v][0] == other.out[v][0];
    return !same;
}

/* A contact of dense and dilute gas has the flux of the gas that crosses the face, in every dimension. Without the rule
 * the momentum is wrong by a part of the pressure. */
static void contacts_are_carried(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int right = 0; right < 2; right++) {
            const double u = right ? -0.7 : 0.7;
            struct strip s = jump(dim, (struct gas_state){0.6, u, 1e4}, (struct gas_state){0.0006, u, 1e4}, 0.3);
            flux_by(&s, "contacts", "firstOrder", FACE);
            for (int v = 0; v < dim + 2; v++)
                assert_near(s.out[v][0], s.F[v][FACE + right], 1e-9 * fabs(s.F[v][FACE + right]));
            flux_by(&s, "none", "firstOrder", FACE);
            assert_true(fabs(s.out[1][0] / s.F[1][FACE + right] - 1) > 0.05);
        }
}

/* Gas at rest with a jump of g stays at rest. */
static void contacts_at_rest_stay(void **state) {
    (void)state;
    struct strip s = jump(2, (struct gas_state){0.6, 0, 3}, (struct gas_state){0.01, 0, 3}, 0);
    flux_by(&s, "contacts", "WPENO5", FACE);
    assert_true(fabs(s.out[0][0]) < 1e-13 && fabs(s.out[3][0]) < 1e-13);
    assert_near(s.out[1][0], 3, 1e-14);
}

/* Gas that all moves along a contact has the flux of the same gas without, seen by who moves along. */
static void contacts_may_slide(void **state) {
    (void)state;
    const double w = 10;
    for (int dim = 2; dim <= 3; dim++) {
        struct strip s = jump(dim, (struct gas_state){0.6, 0.7, 1e4}, (struct gas_state){0.006, 0.7, 1e4}, 0), moved;
        for (int i = 0; i < CELLS; i++) s.u[1][i] = 0.1 * sin(0.9 * i * i);
        moved = s;
        move_along(&moved, w);
        flux_by(&s, "contacts", "WPENO5", FACE);
        flux_by(&moved, "contacts", "WPENO5", FACE);
        assert_true(differ(&s, "contacts", "none", "WPENO5", FACE));
        assert_true(off_by_motion(&s, &moved, w, 1) < 1e-12);
    }
}

/* Returns the gas behind a shock that runs to the right into `ahead`, which has `ratio` times its pressure. */
static struct gas_state behind(struct gas_state ahead, double ratio) {
    const double rho0 = density_of(ahead.nu), e0 = energy_of(ahead), p = ratio * ahead.p;
    double low = ahead.nu, high = 0.64;
    for (int i = 0; i < 200; i++) { /* Hugoniot: e - e0 = (p + p0)/2 (1/rho0 - 1/rho), bisected in nu */
        const double nu = 0.5 * (low + high), work = 0.5 * (p + ahead.p) * (1 / rho0 - 1 / density_of(nu));
        const bool thin = energy_of((struct gas_state){nu, 0, p}) - e0 > work;
        low = thin ? nu : low;
        high = thin ? high : nu;
    }
    return (struct gas_state){low, ahead.u + sqrt((p - ahead.p) * (1 / rho0 - 1 / density_of(low))), p};
}

struct fields_of_face { /* eigenvectors of the means of the two cells, and the jumps of state and flux */
    double left[MAX_VAR][MAX_VAR], right[MAX_VAR][MAX_VAR], dU[MAX_VAR], dF[MAX_VAR];
};
static struct fields_of_face fields_of(int dim, const struct strip *s) {
    struct fields_of_face q = {.dU = {0}};
    struct basis b = {.u = {0}};
    double c2 = 0, g = 0;
    for (int i = FACE; i <= FACE + 1; i++) {
        c2 += 0.5 * s->c[i] * s->c[i];
        g += 0.5 * s->g[i];
        b.h += 0.5 * (s->eps[i] + s->p[i] / s->U[0][i]);
        for (int k = 0; k < dim; k++) b.u[k] += 0.5 * s->u[k][i];
    }
    b.c = sqrt(c2);
    for (int k = 0; k < dim; k++) b.h += 0.5 * b.u[k] * b.u[k];
    b.b1 = g / c2;
    flux_eigenvectors(dim, &b, q.left, q.right);
    for (int v = 0; v < dim + 2; v++) {
        q.dU[v] = s->U[v][FACE + 1] - s->U[v][FACE];
        q.dF[v] = s->F[v][FACE + 1] - s->F[v][FACE];
    }
    return q;
}

static double dot(int n, const double *a, const double *b) {
    double sum = 0;
    for (int v = 0; v < n; v++) sum += a[v] * b[v];
    return sum;
}

/* At strong shocks and the faces beside, and only there, the entropy is split with max(|u| + c) where it is upwinded
 * from the left else: at first order its part changes by (l.dF - max(|u| + c) l.dU)/2. */
static void shocks_are_damped(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        const struct gas_state ahead = {0.1, 0.05, 1}, hot = behind(ahead, 200), weak = behind(ahead, 25);
        struct strip s = jump(dim, hot, ahead, 0.4), own = s;
        const struct fields_of_face q = fields_of(dim, &s);
        const double fast = larger(hot.u + s.c[FACE], ahead.u + s.c[FACE + 1]);
        const double more = 0.5 * (dot(dim + 2, q.left[1], q.dF) - fast * dot(dim + 2, q.left[1], q.dU));
        flux_by(&s, "shocks", "firstOrder", FACE);
        flux_by(&own, "none", "firstOrder", FACE);
        for (int v = 0; v < dim + 2; v++)
            assert_near(s.out[v][0], own.out[v][0] + more * q.right[v][1], 1e-11 * fabs(s.F[v][FACE]) + 1e-12);
        /* The faces ahead of it and behind it are its own, too, but not where the gas ahead runs faster than sound. */
        for (int runs = 0; runs < 2; runs++) {
            const double shift = runs ? hot.u - ahead.u : 0;
            s = jump(dim, (struct gas_state){hot.nu, hot.u - shift, hot.p},
                     (struct gas_state){ahead.nu, ahead.u - shift, ahead.p}, 0.4);
            for (int i = 0; i < CELLS; i++) s.U[0][i] *= 1 + 0.01 * sin(2 * i);
            close_strip(&s);
            for (int at = -2; at <= 2; at++)
                assert_true(differ(&s, "shocks", "none", "WPENO5", FACE + at) == (at >= -1 && at <= !runs));
        }
        s = jump(dim, weak, ahead, 0.4);
        assert_false(differ(&s, "shocks", "none", "WPENO5", FACE));
        struct gas_state slow = hot;
        slow.u = 0.15; /* no shock: the pressures burst */
        s = jump(dim, slow, ahead, 0.4);
        assert_false(differ(&s, "shocks", "none", "WPENO5", FACE));
    }
}

/* In a steep expansion the flux of first order is the mean of both sides less half of the split fields' jumps: the
 * acoustic ones with (1 - (0.64 - 0.14 min(1, 1/g)) min(1, 16/g)) max |u -+ c|. */
static void expansion_is_damped(double nu) {
    struct strip s = jump(1, (struct gas_state){nu, -0.2, 100}, (struct gas_state){0.2, 0.3, 10}, 0);
    const double *u = s.u[0], *c = s.c, most_g = s.g[FACE];
    const double share = 1 - (0.64 - 0.14 * smaller(1, 1 / most_g)) * smaller(1, 16 / most_g);
    const struct fields_of_face q = fields_of(1, &s);
    flux_by(&s, "expansions", "firstOrder", FACE);
    for (int v = 0; v < 3; v++) {
        double wanted = 0.5 * (s.F[v][FACE] + s.F[v][FACE + 1]);
        for (int k = 0; k < 3; k++) {
            const double most = larger(fabs(u[FACE] + (k - 1) * c[FACE]), fabs(u[FACE + 1] + (k - 1) * c[FACE + 1]));
            wanted -= 0.5 * (k == 1 ? 1 : share) * most * dot(3, q.left[k], q.dU) * q.right[v][k];
        }
        assert_near(s.out[v][0], wanted, 1e-11 * (fabs(s.F[v][FACE]) + fabs(s.F[v][FACE + 1])));
    }
    assert_true(differ(&s, "expansions", "none", "WPENO5", FACE));
}

static void expansions_are_damped_less(void **state) {
    (void)state;
    expansion_is_damped(0.21); /* dilute, dense, close to packing */
    expansion_is_damped(0.4);
    expansion_is_damped(0.63);
    struct strip s = jump(1, (struct gas_state){0.4, -0.2, 14}, (struct gas_state){0.35, 0.3, 10}, 0);
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE)); /* it is mild */
    s = jump(1, (struct gas_state){0.4, 0.3, 100}, (struct gas_state){0.2, -0.2, 10}, 0);
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE)); /* gas closes in */
    s = jump(1, (struct gas_state){0.4, -40, 100}, (struct gas_state){0.2, 40, 10}, 0);
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE)); /* gas parts faster than sound */
    s = jump(1, (struct gas_state){0.4, 0, 100}, (struct gas_state){0.2, 1e-3, 10}, 0);
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE)); /* it has hardly begun to part */
    s = jump(1, (struct gas_state){0.4, 50, 100}, (struct gas_state){0.2, 50.5, 10}, 0);
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE)); /* all waves run one way */
}

/* Under gravity no expansion is damped less, and no other rule stops. */
static void expansions_keep_their_flux_under_gravity(void **state) {
    (void)state;
    struct own_params params = {{0}};
    const struct flux *common = flux_find("common");
    for (int i = 0; i < common->model.nparam; i++)
        model_put(&common->model, &params, common->model.param[i].name, RULE_ON);
    for (int falls = 0; falls < 2; falls++)
        for (int lattice = 0; lattice < 2; lattice++) {
            const struct wanted_rules on = rules_wanted(&params, lattice, falls);
            assert_true(on.shocks && on.contacts && on.fronts && on.expansions == !falls);
        }
    struct strip s = jump(2, (struct gas_state){0.4, -0.2, 100}, (struct gas_state){0.2, 0.3, 10}, 0.2);
    assert_true(differ(&s, "expansions", "none", "WPENO5", FACE));
    s.falls = true;
    assert_false(differ(&s, "expansions", "none", "WPENO5", FACE));
    s = jump(2, (struct gas_state){0.6, 0.7, 1e4}, (struct gas_state){0.0006, 0.7, 1e4}, 0.3);
    s.falls = true;
    assert_true(differ(&s, "contacts", "none", "WPENO5", FACE));
}

/* Does a face for which the caller has found `rule` get the flux of a face that finds the rule of that name itself? */
static bool takes(struct strip s, unsigned char rule, const char *name) {
    struct strip own = s;
    bool same = true;
    s.rule = &rule;
    flux_by(&s, "none", "WPENO5", FACE);
    flux_by(&own, name, "WPENO5", FACE);
    for (int v = 0; v < s.dim + 2; v++) same &= s.out[v][0] == own.out[v][0];
    return same;
}

/* Rules that the caller has found, as on polyhedra, are those that the flux finds; but where all waves run one way the
 * upwind flux stays. */
static void told_rules_are_taken(void **state) {
    (void)state;
    const struct gas_state ahead = {0.1, 0.05, 1}, hot = behind(ahead, 200);
    const struct gas_state bursts = {0.4, -0.2, 100}, thin = {0.2, 0.3, 10};
    struct strip s = jump(2, hot, ahead, 0.4);
    assert_true(takes(s, NO_RULE, "none") && takes(s, SHOCK_RULE, "shocks") && !takes(s, SHOCK_RULE, "none"));
    s = jump(2, bursts, thin, 0.4);
    assert_true(takes(s, EXPANSION_RULE, "expansions") && !takes(s, EXPANSION_RULE, "none"));
    for (int sign = -1; sign <= 1; sign += 2) {
        s = jump(2, (struct gas_state){hot.nu, hot.u + sign * 90, hot.p},
                 (struct gas_state){0.1, ahead.u + sign * 90, 1}, 0.4);
        assert_true(takes(s, SHOCK_RULE, "none") && takes(s, NO_RULE, "shocks"));
        s = jump(2, (struct gas_state){0.4, sign * 90, 100}, (struct gas_state){0.2, sign * 90 + 0.5, 10}, 0.4);
        assert_true(takes(s, EXPANSION_RULE, "none") && takes(s, NO_RULE, "expansions"));
    }
}

/* Each limit of the sensors: values a hundredth of it on either side. */
static void limits_are_where_they_are_told(void **state) {
    (void)state;
    for (int swap = 0; swap < 2;
         swap++) { /* du^2 = (40 - 1) (1/2 - 1/5) of rho 2 and 5, p 1 and 40; within a quarter */
        const double rho[2] = {swap ? 5 : 2, swap ? 2 : 5}, p[2] = {swap ? 40 : 1, swap ? 1 : 40}, du2 = 39 * 0.3;
        for (int side = -1; side <= 1; side += 2) {
            assert_true(near_hugoniot(du2 * (1 + 0.2475 * side), rho[0], rho[1], p[0], p[1]));
            assert_false(near_hugoniot(du2 * (1 + 0.2525 * side), rho[0], rho[1], p[0], p[1]));
        }
        assert_false(near_hugoniot(du2, rho[1], rho[0], p[0], p[1])); /* it is denser where p is low */
        assert_true(near_hugoniot(29.3 * 0.3, rho[0], rho[1], smaller(p[0], 30.3), smaller(p[1], 30.3)));
        assert_false(near_hugoniot(28.7 * 0.3, rho[0], rho[1], smaller(p[0], 29.7), smaller(p[1], 29.7)));
    }
    const double z[2] = {1, 3}; /* 4 du > 0.6 |dp|, du < (1 + 4)/2, p 1.5 times */
    assert_true(expands(2.475, 1, 4, z, 1, 3) && expands(2.475, 4, 1, z, 3, 1));
    assert_false(expands(2.525, 1, 4, z, 1, 3) || expands(-1, 1, 4, z, 1, 3) || expands(0, 1, 4, z, 1, 3));
    assert_true(expands(0.303, 1, 4, z, 1, 3) && expands(0.303, 1, 4, z, 3, 1));
    assert_false(expands(0.297, 1, 4, z, 1, 3) || expands(0.297, 1, 4, z, 3, 1));
    assert_true(expands(1, 1, 4, z, 1, 1.515) && expands(1, 1, 4, z, 1.515, 1));
    assert_false(expands(1, 1, 4, z, 1, 1.485) || expands(1, 1, 4, z, 1.485, 1));
}

/* The flux of first order with a floor, which differs from that without by `part` (0 or 1) of what splitting the fields
 * changes that are upwinded from the left else: the entropy and the shears, by (l.dF - floor l.dU)/2 each. */
static void floor_changes(struct strip s, double floor, double part) {
    struct strip own = s;
    const struct fields_of_face q = fields_of(s.dim, &s);
    s.floor = &floor;
    flux_by(&s, "none", "firstOrder", FACE);
    flux_by(&own, "none", "firstOrder", FACE);
    for (int v = 0; v < s.dim + 2; v++) {
        double more = 0;
        for (int k = 1; k <= s.dim; k++)
            more += 0.5 * (dot(s.dim + 2, q.left[k], q.dF) - floor * dot(s.dim + 2, q.left[k], q.dU)) * q.right[v][k];
        if (part > 0)
            assert_near(s.out[v][0], own.out[v][0] + more, 1e-11 * fabs(s.F[v][FACE]) + 1e-12);
        else
            assert_true(s.out[v][0] == own.out[v][0]);
    }
    assert_true(part == 0 || fabs(s.out[2][0] - own.out[2][0]) > 1e-3 * fabs(own.out[2][0]));
}

/* Beside fronts entropy and shears are split with the floor, where it is the larger speed, waves run both ways, and the
 * cells differ; else the flux keeps its bits. */
static void floors_are_taken(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct strip s = jump(dim, (struct gas_state){0.1, 0.5, 1000}, (struct gas_state){0.11, 0.4, 1200}, 0.4);
        for (int i = FACE + 1; i < CELLS; i++) s.u[dim - 1][i] += 0.3;
        for (int i = FACE + 1; i < CELLS; i++) s.u[1][i] += 0.2;
        close_strip(&s);
        assert_true(s.c[FACE] > 0.6);
        floor_changes(s, 3, 1);
        floor_changes(s, 0.4999, 0);
        floor_changes(s, 0, 0);
        floor_changes(jump(dim, (struct gas_state){0.1, 50, 1000}, (struct gas_state){0.11, 49, 1200}, 0.4), 100, 0);
        floor_changes(jump(dim, (struct gas_state){0.1, 0.5, 1000}, (struct gas_state){0.1, 0.5, 1000}, 0.4), 3, 0);
    }
}

/* The speed that a front gives: half of the closing speed and of the jump of c, where pressures differ twice and the
 * cells close in faster than 0.3 |dp|/(rho c). */
static void fronts_are_told(void **state) {
    (void)state;
    const double impedance[2] = {1, 3};
    assert_near(front_speed(2, 1, 4, impedance, 1, 10), 2.5, 1e-15);
    assert_near(front_speed(2, 4, 1, impedance, 10, 1), 2.5, 1e-15);
    assert_true(front_speed(2, 1, 4, impedance, 1, 1.9) == 0);
    assert_true(front_speed(-2, 1, 4, impedance, 1, 10) == 0);
    assert_true(front_speed(0, 1, 4, impedance, 1, 10) == 0);
    assert_true(front_speed(1.3, 1, 4, impedance, 1, 10) == 0); /* 4 1.3 < 0.6 9: weight, not a front */
    assert_true(front_speed(1.4, 1, 4, impedance, 1, 10) > 0);
}

/* Faces that no jump is near keep their bits, and so do all faces without the rules. */
static void other_faces_keep_their_bits(void **state) {
    (void)state;
    int took = 0;
    for (int r = 0; r < reconstruct_count; r++)
        for (int round = 0; round < 40; round++) {
            struct strip s = {.dim = 2};
            for (int i = 0; i < CELLS; i++) {
                const double x = sin(1.3 * i + round), y = cos(0.7 * i * round);
                s.U[0][i] = 300 + 20 * x;
                s.eps[i] = 2 + 0.1 * y;
                s.u[0][i] = y + round % 7 - 3;
                s.u[1][i] = x;
            }
            close_strip(&s);
            for (int face = 2; face < CELLS - 3; face++)
                assert_false(differ(&s, "all", "none", reconstruct_table[r].model.name, face));
            s.U[0][FACE + 1] = 1;
            close_strip(&s);
            for (int face = 2; face < CELLS - 3; face++)
                took += differ(&s, "all", "none", reconstruct_table[r].model.name, face);
        }
    assert_true(took > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_are_carried),
        cmocka_unit_test(contacts_at_rest_stay),
        cmocka_unit_test(contacts_may_slide),
        cmocka_unit_test(shocks_are_damped),
        cmocka_unit_test(expansions_are_damped_less),
        cmocka_unit_test(expansions_keep_their_flux_under_gravity),
        cmocka_unit_test(told_rules_are_taken),
        cmocka_unit_test(limits_are_where_they_are_told),
        cmocka_unit_test(other_faces_keep_their_bits),
        cmocka_unit_test(floors_are_taken),
        cmocka_unit_test(fronts_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
