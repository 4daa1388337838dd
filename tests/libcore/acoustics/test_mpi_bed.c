/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed that is dealt to ranks (libcore/acoustics/bed_deal.c): whoever is home to its cells, the bits of one rank, and
 * each rank works on its share. */
#include "tests/libcore/acoustics/box_bed.h"

enum { ROWS = 2, STEPS = 3 };

static struct comm *world, *alone;

/* Cuts the cells of a box into blocks of ROWS rows, the last one of what is left. Blocks bear odd numbers. */
static void cut(struct box *x, int rows) {
    struct bed_set *b = &x->bed.set;
    const int each = b->cells / rows * ROWS;
    b->blocks = 0;
    for (int at = 0; at < b->cells; at += each) {
        b->number[b->blocks] = 2 * b->blocks + 1;
        b->first[b->blocks++] = at;
    }
    b->first[b->blocks] = b->cells;
}

/* Turns walls into open faces, which hold a pressure or do not, and kept ones, with gas beyond. */
static void open_walls(struct box *x, unsigned *seed) {
    static const enum bed_kind kind[] = {BED_WALL, BED_OPEN, BED_OPEN, BED_KEPT};
    struct bed_set *b = &x->bed.set;
    const int dim = x->bed.dim;
    b->balanced = x->form.triangles;
    for (int f = 0; f < b->faces; f++) {
        const int inside = b->left[f] < 0 ? b->right[f] : b->left[f];
        for (int side = 0; side < 2; side++) b->balance[side][f] = 1e-4 * (chance(seed) - 0.5);
        if (b->kind[f] == BED_INNER) continue;
        b->kind[f] = (unsigned char)kind[f % 4];
        b->holds[f] = f % 4 == 1;
        for (int v = 0; v < dim + 2; v++) {
            b->outside[v][f] = b->U[v][inside] * (v == 0 || v > dim ? 0.9 : 1);
            b->kept[v][f] = v == 0 || v > dim ? 0 : 1e-3 * x->shapes.normal[v - 1][b->shape[f]];
        }
    }
}

/* Which rank is home to block j of n: by `way` the last one to all, each to every other one, or each to a part. */
static int home_of(int way, int j, int n) {
    const int ranks = comm_size(world);
    return way == 0 ? ranks - 1 : way == 1 ? j % ranks : j * ranks / n;
}

struct part { /* the cells of a box that this rank is home to */
    struct bed bed;
    int *cell, *face; /* of the box, by those of the part */
};

/* Numbers the cells over all ranks in the order of their homes. */
static void number_all(const struct box *x, int way, int *number) {
    const struct bed_set *b = &x->bed.set;
    int next = 0;
    for (int r = 0; r < comm_size(world); r++)
        for (int j = 0; j < b->blocks; j++)
            for (int i = b->first[j]; i < b->first[j + 1] && home_of(way, j, b->blocks) == r; i++) number[i] = next++;
}

/* Lists the faces of this rank's cells. */
static void list_faces(struct part *p, const struct bed_set *whole, const int *number) {
    struct bed_set *b = p->bed.home;
    int *place = calloc((size_t)whole->faces, sizeof *place), entry = 0;
    assert_non_null(place);
    b->faces = 0;
    for (int i = 0; i < b->cells; i++) {
        const int c = p->cell[i];
        b->face_start[i] = entry;
        b->body[i] = whole->body[c];
        for (int j = whole->face_start[c]; j < whole->face_start[c + 1]; j++) {
            const int listed = whole->face_of_cell[j], of = listed < 0 ? ~listed : listed;
            if (place[of] == 0) {
                const int f = b->faces++;
                p->face[f] = of;
                place[of] = f + 1;
                b->left[f] = whole->left[of] < 0 ? -1 : number[whole->left[of]];
                b->right[f] = whole->right[of] < 0 ? -1 : number[whole->right[of]];
                b->kind[f] = whole->kind[of];
                b->shape[f] = whole->shape[of];
            }
            b->face_of_cell[entry++] = listed < 0 ? ~(place[of] - 1) : place[of] - 1;
        }
    }
    b->face_start[b->cells] = entry;
    free(place);
}

/* Lists the part, and deals it. */
static void part_lists(struct part *p, const struct box *x, int way) {
    const struct bed_set *whole = &x->bed.set;
    struct bed_set *b = p->bed.home;
    int *number = malloc((size_t)whole->cells * sizeof *number), cells = 0;
    b->blocks = 0;
    for (int j = 0; j < whole->blocks; j++) {
        if (home_of(way, j, whole->blocks) != comm_rank(world)) continue;
        b->number[b->blocks] = whole->number[j];
        b->first[b->blocks++] = cells;
        for (int i = whole->first[j]; i < whole->first[j + 1]; i++) p->cell[cells++] = i;
    }
    b->first[b->blocks] = cells;
    ok(bed_list(&p->bed, whole->face_start[whole->cells]));
    b->balanced = whole->balanced;
    number_all(x, way, number);
    assert_true(cells == 0 || b->low == number[p->cell[0]]);
    list_faces(p, whole, number);
    free(number);
}

static void part_make(struct part *p, const struct box *x, int way) {
    const struct bed *whole = &x->bed;
    p->cell = malloc((size_t)whole->set.cells * sizeof *p->cell);
    p->face = malloc((size_t)whole->set.faces * sizeof *p->face);
    p->bed = (struct bed){.eos = whole->eos,
                          .material = whole->material,
                          .comm = world,
                          .params = whole->params,
                          .dim = whole->dim,
                          .components = whole->components,
                          .limit = whole->limit,
                          .friction = whole->friction};
    ok(bed_make(&p->bed, whole->set.blocks));
    p->bed.home->shapes = whole->set.shapes;
    part_lists(p, x, way);
}

static void part_free(struct part *p) {
    bed_free(&p->bed);
    free(p->cell);
    free(p->face);
}

static void give_friction(struct part *p, const struct bed_set *whole) {
    struct bed_set *b = p->bed.home;
    for (int i = 0; i < b->cells; i++) b->pressure[i] = whole->pressure[p->cell[i]];
    for (int f = 0; f < b->faces; f++) {
        for (int t = 0; t < bed_tensors(p->bed.components); t++) b->stress[t][f] = whole->stress[t][p->face[f]];
        for (int k = 0; k < p->bed.components; k++) b->wall_speed[k][f] = whole->wall_speed[k][p->face[f]];
        b->wall_friction[f] = whole->wall_friction[p->face[f]];
    }
}

static void give(struct part *p, const struct bed_set *whole) {
    struct bed_set *b = p->bed.home;
    if (p->bed.rub) give_friction(p, whole);
    for (int v = 0; v < p->bed.dim + 2; v++) {
        for (int i = 0; i < b->cells; i++) b->U[v][i] = whole->U[v][p->cell[i]];
        for (int f = 0; f < b->faces; f++) {
            b->outside[v][f] = whole->outside[v][p->face[f]];
            b->kept[v][f] = whole->kept[v][p->face[f]];
        }
    }
    for (int f = 0; f < b->faces; f++) {
        b->holds[f] = whole->holds[p->face[f]];
        for (int side = 0; side < 2; side++) b->balance[side][f] = whole->balance[side][p->face[f]];
    }
}

static void assert_bits(double a, double b) {
    assert_memory_equal(&a, &b, sizeof a);
}

static void compare_friction(const struct part *p, const struct bed_set *whole) {
    const struct bed_set *b = p->bed.home;
    for (int i = 0; i < b->cells; i++) assert_bits(b->pressure[i], whole->pressure[p->cell[i]]);
    for (int f = 0; f < b->faces; f++)
        for (int t = 0; t < bed_tensors(p->bed.components); t++)
            assert_bits(b->stress[t][f], whole->stress[t][p->face[f]]);
}

static void compare(struct part *p, struct bed *one, double dt, const double gravity[MAX_DIM]) {
    struct bed_set *b = p->bed.home, *whole = &one->set;
    long sum = p->bed.lifted;
    assert_int_equal(p->bed.newton, one->newton);
    assert_int_equal(p->bed.linear, one->linear);
    comm_sum_long(world, &sum, 1);
    assert_int_equal(sum, one->lifted);
    for (int v = 0; v < one->dim + 2; v++) {
        for (int i = 0; i < b->cells; i++) assert_bits(b->U[v][i], whole->U[v][p->cell[i]]);
        for (int f = 0; f < b->faces; f++)
            if (b->kind[f] != BED_INNER) assert_bits(b->kept[v][f], whole->kept[v][p->face[f]]);
    }
    if (p->bed.rub) compare_friction(p, whole);
    bed_push(&p->bed, dt, gravity, 1);
    bed_push(one, dt, gravity, 1);
    for (int j = 0; j < b->blocks; j++) {
        const int of = (b->number[j] - 1) / 2;
        assert_bits(b->lift[j], whole->lift[of]);
        assert_bits(b->work[j], whole->work[of]);
        assert_bits(b->pushed[j], whole->pushed[of]);
        assert_bits(b->rubbed[j], whole->rubbed[of]);
        assert_int_equal(b->peak_cell[j], whole->peak_cell[of]);
    }
}

/* No rank computes more than its share, but for a block: together with what home takes, a fifth of each cell. */
static void assert_shared(const struct bed *b, const struct bed_set *whole) {
    const int ranks = comm_size(world), block = whole->first[1];
    long cells = b->set.cells;
    assert_true(ranks == 1 || cells <= 1.2 * whole->cells / ranks + block);
    comm_sum_long(world, &cells, 1);
    assert_int_equal(cells, whole->cells);
}

/* Friction acts in the upper rows alone. */
static void fill(struct box *x, unsigned *seed) {
    for (int i = 0; i < x->bed.set.cells; i++)
        set(x, i, 0.56 + 0.07 * chance(seed) * i / x->bed.set.cells, 1e-3 * (1 + chance(seed)),
            0.02 * (chance(seed) - 0.5), 0.02 * (chance(seed) - 0.5));
}

/* No stress yet; walls that are rough, smooth or between, and move. */
static void start_friction(struct box *x) {
    struct bed_set *b = &x->bed.set;
    for (int i = 0; i < b->cells; i++) b->pressure[i] = 0;
    for (int f = 0; f < b->faces; f++) {
        b->wall_friction[f] = f % 3 == 0 ? HUGE_VAL : f % 3 == 1 ? 0.2 : 0;
        for (int k = 0; k < x->bed.components; k++) b->wall_speed[k][f] = 0.01 * (k + 1);
        for (int t = 0; t < bed_tensors(x->bed.components); t++) b->stress[t][f] = 0;
    }
}

/* Some steps of a box by the parts of all ranks and by one rank alone. Returns how many could be made. */
static int steps_beside_one_rank(int nx, int ny, bool periodic, bool triangles, int way, bool rubs) {
    const struct friction_use none = {.law = NULL}, law = {friction_find("muI"),
                                                           {.mu_static = 0.38,
                                                            .mu_dynamic = 0.64,
                                                            .I0 = 0.279,
                                                            .alpha_friction = 0.58,
                                                            .alpha_solid = 0.62,
                                                            .modulus = 3e7, /* for many stages */
                                                            .surface_cohesion = 0.5},
                                                           .grain = 0.7};
    const double gravity[MAX_DIM] = {-1, -9.81};
    unsigned seed = 11;
    struct box x;
    struct part p;
    int made = 0;
    box_make_of(&x, alone, "TorquatoSpheres", 0.9,
                &(struct box_form){.n = {nx, ny, 1},
                                   .width = 0.5,
                                   .periodic = {periodic},
                                   .triangles = triangles,
                                   .friction = rubs ? law : none});
    cut(&x, ny);
    fill(&x, &seed);
    open_walls(&x, &seed);
    if (rubs) start_friction(&x);
    part_make(&p, &x, way);
    for (int step = 0; step < STEPS; step++) {
        const double dt = 2e-3 * (1 + step);
        bool done, alike;
        open_walls(&x, &seed);
        give(&p, &x.bed.set);
        ok(bed_step(&p.bed, dt, gravity, &alike));
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(alike == done);
        if (!done) break;
        compare(&p, &x.bed, dt, gravity);
        assert_shared(&p.bed, &x.bed.set);
        made++;
    }
    part_free(&p);
    box_free(&x);
    return made;
}

static void test_a_dealt_bed_has_the_bits_of_one_rank(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        const int way = i / 2;
        const bool rubs = i % 2;
        assert_int_equal(steps_beside_one_rank(20, 30, false, false, way, rubs), STEPS);
        assert_int_equal(steps_beside_one_rank(2, 40, true, false, way, rubs), STEPS);
        assert_int_equal(steps_beside_one_rank(1, 16, true, false, way, rubs), STEPS);
        assert_int_equal(steps_beside_one_rank(14, 17, false, true, way, rubs), STEPS);
        assert_int_equal(steps_beside_one_rank(16, 12, true, true, way, rubs), STEPS);
    }
}

/* The set changes: another one is dealt, and the first one again. */
static void test_another_set_is_dealt_anew(void **state) {
    const double gravity[MAX_DIM] = {-1, -9.81};
    unsigned seed = 5;
    struct box x;
    struct part p;
    bool done;
    (void)state;
    box_make(&x, alone, "TorquatoSpheres", 0.9, 20, 30, 0.5, false, false);
    cut(&x, 30);
    fill(&x, &seed);
    open_walls(&x, &seed);
    part_make(&p, &x, 0);
    for (int way = 1; way < 4; way++) {
        part_lists(&p, &x, way % 3);
        open_walls(&x, &seed);
        give(&p, &x.bed.set);
        ok(bed_step(&p.bed, 2e-3, gravity, &done));
        ok(bed_step(&x.bed, 2e-3, gravity, &done));
        assert_true(done);
        compare(&p, &x.bed, 2e-3, gravity);
    }
    part_free(&p);
    box_free(&x);
}

static int start(void **state) {
    int argc = 0;
    char **argv = NULL;
    (void)state;
    ok(comm_start(&argc, &argv, &world));
    ok(comm_alone(&alone));
    return 0;
}
static int finish(void **state) {
    (void)state;
    comm_alone_free(alone);
    comm_finish(world);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_dealt_bed_has_the_bits_of_one_rank),
        cmocka_unit_test(test_another_set_is_dealt_anew),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
