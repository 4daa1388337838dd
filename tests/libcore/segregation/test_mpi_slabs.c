/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segregation on a lattice and the projection of a flow in slabs, one a rank: the bits of the whole on one rank. */
#include "libcore/segregation/segregation_lattice.h"
#include "libcore/segregation/solenoidal.h"

#include "tests/checks.h" /* after what it would hide */

#include <stdlib.h>
#include <string.h>

static struct comm *world;

struct variant {
    const char *name;
    int dim, n[3];
    bool cyclic[3];
    double D; /* m^2/s */
    bool law, fixed, weighted, adaptive;
};
static const struct variant variants[] = {
    {"plane", 2, {37, 29, 1}, {false}, 0.05, .fixed = true},
    {"plane without diffusion", 2, {70, 9, 1}, {false}, 0, .weighted = true},
    {"plane, cyclic", 2, {12, 17, 1}, {true, true}, 1e-3, .weighted = true},
    {"plane, law, steps chosen", 2, {20, 16, 1}, {false, true}, 0.02, .law = true, .adaptive = true},
    {"solid", 3, {9, 7, 11}, {true, false, false}, 1e-3, .fixed = true, .law = true},
    {"solid, cyclic, steps chosen", 3, {6, 12, 8}, {false, false, true}, 0.01, .weighted = true, .adaptive = true},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

struct box { /* the whole, or the slab of this rank */
    struct segregation_lattice as;
    struct face_flow flow;
    long cells, faces[3];
    double *u[3], *f[3], *D[3], *value[3], *weight, *phi;
    bool *open[3], *fixed[3];
    double factor; /* of the law */
};

/* A number in 0 .. 1 that belongs to i. */
static double noise(long i, int salt) {
    unsigned long x = (unsigned long)i * 2654435761u + (unsigned long)salt * 40503u + 12345u;
    x = (x ^ x >> 15) * 2246822519u % 4294967296u;
    return (double)((x ^ x >> 13) % 100000) / 1e5;
}

static void thinning(const void *context, int k, const double *phi, double *D) {
    const struct box *b = context;
    for (long i = 0; i < b->faces[k]; i++)
        D[i] = b->open[k][i] || b->fixed[k][i] ? b->factor * (1 + phi[i] * phi[i]) : 0;
}

/* Sets a face of the whole, number i along axis k of at most n; `other` is its number among those that are one with
 * it. */
static void set_face(struct box *b, const struct variant *v, int k, long here, long other, int i) {
    const bool end = i == 0 || i == v->n[k], inner = !end || v->cyclic[k];
    const bool through = end && !inner && v->fixed && k == 0;
    b->open[k][here] = inner;
    if (!inner && !through) return;
    b->u[k][here] = inner ? noise(other, k) - 0.5 : 0.2;
    b->f[k][here] = k == v->dim - 1 ? -0.7 : 0.3;
    b->D[k][here] = v->D;
    b->fixed[k][here] = through;
    b->value[k][here] = 0.25 + 0.5 * noise(other, 7);
}

static void fill(struct box *b, const struct variant *v, int first, int layers) {
    const int last = v->dim - 1;
    for (int k = 0; k < v->dim; k++) {
        long stride = 1, across = 1;
        for (int a = 0; a < k; a++) stride *= v->n[a];
        for (int a = 0; a < last; a++) across *= v->n[a] + (a == k);
        for (long j = 0; j < across * (layers + (k == last)); j++) {
            const long whole = j + across * first;
            const int i = (int)(whole / stride % (v->n[k] + 1));
            const long seam = v->cyclic[k] && i == v->n[k] ? whole - stride * v->n[k] : whole;
            set_face(b, v, k, j, seam, i);
        }
    }
    for (long c = 0; c < b->cells; c++) {
        const long whole = c + first * (b->cells / layers);
        b->phi[c] = noise(whole, 3) > 0.6 ? 1 : 0.8 * noise(whole, 4);
        if (b->weight) b->weight[c] = 0.5 + noise(whole, 5);
    }
}

static void box_make(struct box *b, const struct variant *v, const struct comm *c, int first, int layers) {
    const int last = v->dim - 1;
    *b = (struct box){.cells = 1, .factor = v->D};
    b->as.dim = b->flow.dim = v->dim;
    b->as.comm = b->flow.comm = c;
    for (int k = 0; k < 3; k++) {
        b->as.n[k] = b->flow.n[k] = k == last ? layers : v->n[k];
        b->as.width[k] = b->flow.width[k] = 1. / v->n[k];
        b->as.cyclic[k] = b->flow.cyclic[k] = v->cyclic[k];
        b->cells *= b->as.n[k];
    }
    for (int k = 0; k < v->dim; k++) {
        b->faces[k] = b->cells / b->as.n[k] * (b->as.n[k] + 1);
        double **arrays[] = {&b->u[k], &b->f[k], &b->D[k], &b->value[k]};
        for (int i = 0; i < 4; i++) ok(allocate(arrays[i], b->faces[k], sizeof(double), "faces"));
        ok(allocate(&b->open[k], b->faces[k], sizeof(bool), "faces"));
        ok(allocate(&b->fixed[k], b->faces[k], sizeof(bool), "faces"));
        b->as.u[k] = b->flow.u[k] = b->u[k];
        b->as.f[k] = b->f[k];
        b->as.D[k] = b->D[k];
        b->as.fixed[k] = b->fixed[k];
        b->as.value[k] = b->value[k];
        b->flow.open[k] = b->open[k];
    }
    ok(allocate(&b->phi, b->cells, sizeof(double), "phi"));
    if (v->weighted) ok(allocate(&b->weight, b->cells, sizeof(double), "weight"));
    b->as.capacity = b->weight;
    if (v->law) {
        b->as.law = thinning;
        b->as.context = b;
    }
    fill(b, v, first, layers);
}
static void box_free(struct box *b) {
    for (int k = 0; k < 3; k++) {
        void *all[] = {b->u[k], b->f[k], b->D[k], b->value[k], b->open[k], b->fixed[k]};
        for (int i = 0; i < 6; i++) free(all[i]);
    }
    free(b->weight);
    free(b->phi);
}

struct outcome {
    struct face_flow_change change;
    struct segregation_lattice_counts counts;
    double rate, dt;
};
static void advance(struct box *b, const struct variant *v, struct outcome *out) {
    struct segregation_field *s;
    *out = (struct outcome){.dt = 0.02};
    ok(face_flow_project(&b->flow, &out->change));
    ok(segregation_field_make(&b->as, &s));
    for (int i = 0; i < 6; i++) {
        double dt = out->dt;
        if (v->adaptive)
            ok(segregation_field_advance(s, 1e-4, &dt, &out->dt, b->phi));
        else
            ok(segregation_field_step(s, dt, i == 0, b->phi));
    }
    out->counts = segregation_field_counts(s);
    out->rate = segregation_field_rate(s);
    segregation_field_free(s);
}

static void same_bits(void **state) {
    (void)state;
    for (int i = 0; i < VARIANTS; i++) {
        const struct variant *v = &variants[i];
        const int last = v->dim - 1, layers = v->n[last], rank = comm_rank(world), size = comm_size(world);
        const int first = layers * rank / size, end = layers * (rank + 1) / size;
        struct box whole, slab;
        struct outcome one, many;
        box_make(&whole, v, NULL, 0, layers);
        box_make(&slab, v, world, first, end - first);
        advance(&whole, v, &one);
        advance(&slab, v, &many);
        if (memcmp(whole.phi + first * (slab.cells / (end - first)), slab.phi, (size_t)slab.cells * sizeof(double)) ||
            memcmp(&one, &many, sizeof one)) {
            print_error("%s: rank %d of %d differs\n", v->name, rank, size);
            assert_true(false);
        }
        assert_true(one.counts.bounded > 0 || v->D > 0.01);
        assert_true(one.change.iterations > 5);
        box_free(&whole);
        box_free(&slab);
    }
}

/* A layer a rank is enough. */
static void thin_slabs(void **state) {
    (void)state;
    const int size = comm_size(world);
    for (int cyclic = 0; cyclic < 2; cyclic++) {
        const struct variant v = {"thin", 2, {65, size > 1 ? size : 2, 1}, {false, cyclic}, 1e-3, .weighted = true};
        const int layers = v.n[1] / size, first = layers * comm_rank(world);
        struct box whole, slab;
        struct outcome one, many;
        box_make(&whole, &v, NULL, 0, v.n[1]);
        box_make(&slab, &v, world, first, layers);
        advance(&whole, &v, &one);
        advance(&slab, &v, &many);
        assert_memory_equal(whole.phi + 65 * first, slab.phi, (size_t)slab.cells * sizeof(double));
        assert_memory_equal(&one, &many, sizeof one);
        box_free(&whole);
        box_free(&slab);
    }
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(same_bits), cmocka_unit_test(thin_slabs)};
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
