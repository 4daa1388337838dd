/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lattices that are found in slices of their polyMesh, with any numbers of cells, points and faces: sites, lattices and
 * forests are those that the whole mesh has; what is no lattice, or not sound, is left alone. */
#define _GNU_SOURCE /* mkdtemp */
#include "mesh/lattice/forest_private.h"
#include "mesh/spread/spread.h"

#include "tests/mesh/meshes.h"
#include "tests/mesh/spread/outlines.h"

static bool step_and_island(int i, int j, int k) {
    (void)k;
    return (i >= 12 && j < 5) || (i >= 4 && i < 8 && j >= 5 && j < 9);
}

static bool tower(int i, int j, int k) {
    return k >= 6 && !(i >= 3 && i < 8 && j >= 4);
}

static bool ledge(int i, int j, int k) {
    return k == 0 && i >= 5 && j == 1;
}

#define CYCLIC "cyclic", "cyclic"
#define EMPTY  "empty", "empty"
static const struct recipe recipes[] = {
    {.n = {23, 1, 1}, .origin = {1, 2, 3}, .width = {0.1, 1, 2}, .type = {NULL, NULL, EMPTY, EMPTY}},
    {.n = {1, 23, 1}, .width = {0.3, 0.1, 2}, .type = {EMPTY, CYCLIC, EMPTY}},
    {.n = {20, 13, 1}, .width = {0.1, 0.2, 1}, .hole = step_and_island, .type = {NULL, "wall", NULL, NULL, EMPTY}},
    {.n = {17, 1, 9}, .origin = {-1, 0, 5}, .width = {0.1, 3, 0.1}, .type = {CYCLIC, EMPTY, "wall", "symmetry"}},
    {.n = {16, 14, 1}, .width = {0.1, 0.1, 0.1}, .type = {CYCLIC, CYCLIC, EMPTY}},
    {.n = {1, 14, 6}, .width = {3, 0.1, 0.1}, .type = {EMPTY, "wall", "wall", CYCLIC}},
    {.n = {7, 8, 6}, .origin = {1e3, 0, 0}, .width = {0.1, 0.2, 0.3}, .type = {CYCLIC, NULL, NULL, CYCLIC}},
    {.n = {11, 8, 9}, .width = {1, 1, 1}, .hole = tower},
    {.n = {9, 7, 1}, .width = {1, 1, 1}, .type = {CYCLIC}}, /* one cell thick, and not empty there */
    {.n = {9, 9, 1},
     .width = {1, 1, 1},
     .hole = ledge,
     .type = {NULL, NULL, NULL, NULL, EMPTY}}, /* too thin for tiles */
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

/* A number that a number becomes when n are shuffled: i -> (a i + b) mod n, a prime that does not divide n. */
static int shuffled(int i, int n) {
    const long prime = n % 7919 ? 7919 : 7907;
    return (int)((prime * i + n / 3) % n);
}

/* Sorts the faces again, so that the mesh is as OpenFOAM's would be with these numbers. */
static void sort_again(struct polymesh *m) {
    int *patch = calloc((size_t)m->nfaces, sizeof *patch), *neighbour = malloc((size_t)m->nfaces * sizeof *neighbour);
    for (int f = 0; f < m->nfaces; f++) neighbour[f] = f < m->ninternal ? m->neighbour[f] : -1;
    for (int p = 0; p < m->npatches; p++) {
        for (int f = m->patch[p].start; f < m->patch[p].start + m->patch[p].nfaces; f++) patch[f] = p;
        m->patch[p].start = m->patch[p].nfaces = 0;
    }
    free(m->neighbour);
    m->neighbour = neighbour;
    m->ninternal = 0;
    ok(polymesh_order(m, patch));
    free(patch);
}

/* Gives cells and points other numbers. */
static void shuffle(struct polymesh *m) {
    double *points = calloc(3 * (size_t)m->npoints, sizeof *points);
    for (int i = 0; i < m->npoints; i++)
        memcpy(points + 3 * shuffled(i, m->npoints), m->points + 3 * i, 3 * sizeof *points);
    free(m->points);
    m->points = points;
    for (int i = 0; i < m->face_start[m->nfaces]; i++) m->face_points[i] = shuffled(m->face_points[i], m->npoints);
    for (int f = 0; f < m->nfaces; f++) m->owner[f] = shuffled(m->owner[f], m->ncells);
    for (int f = 0; f < m->ninternal; f++) m->neighbour[f] = shuffled(m->neighbour[f], m->ncells);
    sort_again(m);
}

static struct polymesh *make(const struct recipe *r, bool mix) {
    struct polymesh *m;
    ok(mesh_make(r, &m));
    if (mix) shuffle(m);
    ok(polymesh_check(m));
    return m;
}

/* Reads the mesh in the folder, which must have sites. */
static struct polymesh *read_sites(void) {
    struct polymesh *m;
    struct spread *s;
    ok(spread_read(folder, world, true, false, &s, &m));
    assert_true(m && !s && m->outline->sites);
    return m;
}

static long index_of(const struct lattice *l, const int at[3]) {
    return at[0] + l->n[0] * (at[1] + (long)l->n[1] * at[2]);
}

static void same_lattice(const struct lattice *l, const struct lattice *of_sites) {
    assert_true(l->dim == of_sites->dim && l->thickness == of_sites->thickness);
    assert_memory_equal(l->axis, of_sites->axis, sizeof l->axis);
    assert_memory_equal(l->n, of_sites->n, sizeof l->n);
    assert_memory_equal(l->origin, of_sites->origin, sizeof l->origin);
    assert_memory_equal(l->width, of_sites->width, sizeof l->width);
    assert_memory_equal(l->periodic, of_sites->periodic, sizeof l->periodic);
}

/* Cells of the slice, and cells at all places, which each rank asks for. */
static void same_cells(const struct lattice *l, const struct lattice *of_sites, const struct polymesh *m) {
    const struct share *cells = &of_sites->sites->cells;
    const long places = (long)l->n[0] * l->n[1] * l->n[2];
    int *row = malloc((size_t)places * sizeof *row), *before = malloc((size_t)m->ncells * sizeof *before), at[3] = {0};
    for (; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++) lattice_row(of_sites, at, l->n[0], row + index_of(l, at));
    ok(lattice_name(of_sites, places, row));
    assert_memory_equal(row, l->cell, (size_t)places * sizeof *row);
    for (long c = cells->first; c < cells->end; c++) {
        double x[3], y[3];
        lattice_at(of_sites, c, at);
        assert_int_equal(l->cell[index_of(l, at)], c);
        sites_centre(of_sites->sites, c, x);
        lattice_centre(l, c, y);
        for (int k = 0; k < l->dim; k++) assert_true(x[l->axis[k]] == y[l->axis[k]]);
    }
    for (int k = 0; k < l->dim; k++) {
        ok(lattice_before(of_sites, k, before));
        for (long c = cells->first; c < cells->end; c++) {
            lattice_at(of_sites, c, at);
            const int other = at[k]-- > 0 ? l->cell[index_of(l, at)] : -1;
            assert_int_equal(before[c - cells->first], other);
        }
    }
    free(row);
    free(before);
}

static void same_walls(const struct lattice *l, const struct polymesh *m, const struct lattice *of_sites,
                       const struct polymesh *outline) {
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++)
            for (at[0] = 0; at[0] < l->n[0]; at[0]++)
                for (int side = 0; side < 2 * l->dim && l->cell[index_of(l, at)] >= 0; side++) {
                    long one, other;
                    assert_int_equal(lattice_patch(l, m, at, side, &one),
                                     lattice_patch(of_sites, outline, at, side, &other));
                    assert_int_equal(one, other);
                }
}

/* The centre of cell 0 along closed axes is that of the whole mesh, to the bit. */
static void same_middle(const struct polymesh *m, const struct sites *s) {
    struct polymesh_geometry g;
    ok(polymesh_geometry_make(m, &g));
    for (int k = 0; k < 3; k++)
        if (s->closed[k]) assert_true(s->middle[k] == g.cell_centre[k]);
    polymesh_geometry_free(&g);
}

static void sites_are_those_of_the_whole(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++)
        for (int form = 0; form < 8; form++) {
            struct polymesh *m = make(&recipes[r], form / 4);
            struct lattice *l, *of_sites;
            char why[256];
            write_mesh(m, form % 4);
            struct polymesh *outline = read_sites();
            same_outline(m, outline);
            ok(lattice_recognise(m, &l, why));
            ok(lattice_of_sites(outline, &of_sites));
            same_lattice(l, of_sites);
            same_cells(l, of_sites, m);
            same_walls(l, m, of_sites, outline);
            same_middle(m, outline->outline->sites);
            assert_false(lattice_is_local(of_sites));
            ok(lattice_complete(of_sites, outline));
            assert_true(lattice_is_local(of_sites));
            assert_memory_equal(l->face, of_sites->face, 6 * (size_t)m->ncells * sizeof *l->face);
            lattice_drop(of_sites);
            lattice_free(l);
            lattice_free(of_sites);
            polymesh_free(m);
            polymesh_free(outline);
            ok(comm_agree(world, OK));
        }
}

/* ---- forests ----------------------------------------------------------------------------------------------------- */

static void same_tiles(const struct forest *f, const struct forest *g) {
    assert_true(f->ntiles == g->ntiles && f->ntiles_all == g->ntiles_all && f->nblocks == g->nblocks);
    for (int t = 0; t < f->ntiles; t++) {
        const struct tile *a = &f->tile[t], *b = &g->tile[t];
        assert_true(a->id == b->id && a->remote == b->remote);
        assert_memory_equal(a->low, b->low, sizeof a->low);
        assert_memory_equal(a->n, b->n, sizeof a->n);
        for (int side = 0; side < 2 * f->dim; side++) {
            const long faces = (long)a->n[0] * a->n[1] * a->n[2] / a->n[side / 2];
            assert_int_equal(a->side[side].patch, b->side[side].patch);
            assert_int_equal(a->side[side].neighbour, b->side[side].neighbour);
            if (a->side[side].patch >= 0)
                assert_memory_equal(a->side[side].face, b->side[side].face, (size_t)faces * sizeof(int));
        }
    }
    for (int b = 0; b < f->nblocks; b++) {
        const struct forest_block *one = &f->block[b], *other = &g->block[b];
        assert_true(one->id == other->id && one->tile == other->tile);
        assert_memory_equal(one->n, other->n, sizeof one->n);
        assert_memory_equal(one->cell, other->cell, (size_t)one->n[0] * one->n[1] * one->n[2] * sizeof(int));
    }
}

static void forests_are_those_of_the_whole(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++)
        for (int uniform = 0; uniform < 2; uniform++) {
            struct polymesh *m = make(&recipes[r], true), *outline;
            struct lattice *l, *of_sites;
            struct forest *f, *g;
            char why[256];
            write_mesh(m, 1);
            outline = read_sites();
            ok(lattice_recognise(m, &l, why));
            ok(lattice_of_sites(outline, &of_sites));
            for (int k = 0; k < l->dim; k++)
                l->uniform[k] = of_sites->uniform[k] = uniform && lattice_may_be_uniform(l, m, k);
            const status one = forest_make(l, m, world, 5, &f), other = forest_make(of_sites, outline, world, 5, &g);
            assert_true(!one == !other && !one == (r != RECIPES - 1));
            if (one) assert_string_equal(status_text(one), status_text(other));
            status_free(one);
            status_free(other);
            if (f) same_tiles(f, g);
            sites_drop(outline->outline->sites);
            for (int c = 0; f && c < m->ncells; c += 7) {
                double x[3], y[3];
                lattice_centre(l, c, x);
                forest_place(g, c, y);
                for (int k = 0; k < l->dim; k++) assert_true(x[l->axis[k]] == y[l->axis[k]]);
            }
            forest_free(f);
            forest_free(g);
            lattice_free(l);
            lattice_free(of_sites);
            polymesh_free(m);
            polymesh_free(outline);
            ok(comm_agree(world, OK));
        }
}

/* ---- what is no lattice, or not sound ---------------------------------------------------------------------------- */

enum defect {
    NONE,
    MOVED,
    LONGER,
    BOWTIE,
    FLIPPED,
    OWNER,
    ORPHAN,
    TURNED,
    HALVES,
    PARTLY,
    HALF_EMPTY,
    DOUBLE,
    SHORT,
    OPEN,
    DEFECTS
};

static int *corners(const struct polymesh *m, int face) {
    return m->face_points + m->face_start[face];
}

static void swap(int *a, int *b) {
    const int c = *a;
    *a = *b;
    *b = c;
}

/* Puts the mesh once more where it is: cells lie on each other. */
static void double_up(struct polymesh *m) {
    const size_t f = (size_t)m->nfaces, p = (size_t)m->npoints;
    m->points = realloc(m->points, 6 * p * sizeof *m->points);
    memcpy(m->points + 3 * p, m->points, 3 * p * sizeof *m->points);
    m->face_start = realloc(m->face_start, (2 * f + 1) * sizeof *m->face_start);
    m->face_points = realloc(m->face_points, 8 * f * sizeof *m->face_points);
    m->owner = realloc(m->owner, 2 * f * sizeof *m->owner);
    int *neighbour = malloc(2 * f * sizeof *neighbour), *patch = calloc(2 * f, sizeof *patch);
    for (int i = 0; i < m->npatches; i++) {
        for (int j = m->patch[i].start; j < m->patch[i].start + m->patch[i].nfaces; j++) patch[j] = i;
        m->patch[i].nfaces = 0;
    }
    for (int i = 0; i < m->nfaces; i++) {
        neighbour[i] = i < m->ninternal ? m->neighbour[i] : -1;
        neighbour[m->nfaces + i] = i < m->ninternal ? m->neighbour[i] + m->ncells : -1;
        patch[m->nfaces + i] = patch[i];
        m->owner[m->nfaces + i] = m->owner[i] + m->ncells;
    }
    for (int i = 0; i <= m->nfaces; i++) m->face_start[m->nfaces + i] = m->face_start[m->nfaces] + m->face_start[i];
    for (int i = 0; i < 4 * m->nfaces; i++) m->face_points[4 * m->nfaces + i] = m->face_points[i] + m->npoints;
    free(m->neighbour);
    m->neighbour = neighbour;
    m->nfaces *= 2;
    m->npoints *= 2;
    m->ncells *= 2;
    m->ninternal = 0;
    ok(polymesh_order(m, patch));
    free(patch);
}

static void rename_patch(struct patch *p, const char *name, const char *type) {
    free(p->name);
    free(p->type);
    free(p->neighbour);
    p->name = strdup(name);
    p->type = strdup(type);
    p->neighbour = NULL;
}

/* Adds a point that no face has. */
static void add_stray(struct polymesh *m, const double x[3]) {
    m->points = realloc(m->points, 3 * ((size_t)m->npoints + 1) * sizeof *m->points);
    memcpy(m->points + 3 * m->npoints, x, 3 * sizeof *m->points);
    m->npoints++;
}

static void damage(struct polymesh *m, enum defect kind) {
    const int face = m->ninternal / 2, start = m->patch[0].start, n = m->patch[0].nfaces;
    int *p = corners(m, face);
    if (kind == MOVED) m->points[3 * p[0]] += 0.4e-6 * 0.1; /* lattice_recognise still takes it for one */
    for (int i = 0; kind == LONGER && i < m->npoints; i++)
        if (m->points[3 * i] > 0.65) m->points[3 * i] += 0.02;
    if (kind == BOWTIE) swap(&p[0], &p[1]);
    if (kind == FLIPPED) swap(&p[0], &p[2]);
    if (kind == OWNER) swap(&m->owner[start], &m->owner[start + n - 1]);
    if (kind == ORPHAN) add_stray(m, (const double[3]){0.9, 0, 0});
    p = corners(m, start + n / 2);
    const int first[4] = {p[0], p[1], p[2], p[3]};
    for (int i = 0; kind == TURNED && i < 4; i++) p[i] = first[(i + 1) % 4];
    for (int i = 0; kind == HALVES && i < 4; i++) swap(&corners(m, start)[i], &corners(m, start + n - 1)[i]);
    if (kind == HALVES) swap(&m->owner[start], &m->owner[start + n - 1]);
    if (kind == PARTLY) { /* the last faces of the second half become the first of the next patch */
        m->patch[1].nfaces -= 3;
        m->patch[2].start -= 3;
        m->patch[2].nfaces += 3;
    }
    if (kind == HALF_EMPTY) rename_patch(&m->patch[4], "z0", "empty");
    if (kind == DOUBLE) double_up(m);
    if (kind == SHORT) m->npoints -= 1;                     /* the last points are named no more */
    for (int i = 0; kind == OPEN && i < m->npatches; i++) { /* the last face is gone: its cell lacks a side */
        struct patch *last = &m->patch[i];
        if (last->start + last->nfaces == m->nfaces) *(last->nfaces > 0 ? &last->nfaces : &last->start) -= 1;
    }
    m->nfaces -= kind == OPEN;
}

static void what_is_no_lattice_is_left_alone(void **state) {
    (void)state;
    const struct recipe r = {.n = {8, 7, 5}, .width = {0.1, 0.1, 0.1}, .type = {CYCLIC}};
    for (int kind = 0; kind < DEFECTS; kind++) {
        struct polymesh *m = make(&r, false), *outline;
        struct spread *s;
        damage(m, (enum defect)kind);
        write_mesh(m, 1);
        ok(spread_read(folder, world, true, false, &s, &outline));
        const bool found = outline && outline->outline->sites;
        if (found != (kind == NONE)) fail_msg("defect %d", kind);
        if (comm_size(world) == 1) assert_true(found || (!outline && !s));
        if (outline && s) assert_true(kind != BOWTIE && kind != FLIPPED && kind != TURNED && kind != HALVES);
        spread_free(s);
        polymesh_free(outline);
        polymesh_free(m);
        ok(comm_agree(world, OK));
    }
}

/* Stray points may lie among the cells; beyond them, on any side, the box around all points is not that of the cells.
 * No patch is cyclic here: two halves a cell too near would tell as well. */
static void stray_points_beyond_the_cells_are_seen(void **state) {
    (void)state;
    const struct recipe r = {.n = {4, 3, 5}, .width = {0.1, 0.1, 0.1}};
    for (int side = -1; side < 6; side++) {
        struct polymesh *m = make(&r, false), *outline;
        struct spread *s;
        double x[3] = {0.1, 0.1, 0.1};
        if (side >= 0) x[side / 2] = side % 2 ? 0.1 * (r.n[side / 2] + 1) : -0.1;
        add_stray(m, x);
        write_mesh(m, 1);
        ok(spread_read(folder, world, true, false, &s, &outline));
        const bool found = outline && outline->outline->sites;
        if (found != (side < 0)) fail_msg("side %d", side);
        spread_free(s);
        polymesh_free(outline);
        polymesh_free(m);
        ok(comm_agree(world, OK));
    }
}

static void walls_and_noise_are_no_lattice(void **state) {
    (void)state;
    const struct recipe others[] = {
        {.n = {8, 7, 1}, .width = {1, 1, 1}, .type = {NULL, NULL, NULL, NULL, EMPTY}, .crack = {2, 3}},
        {.n = {8, 7, 1}, .width = {1, 1, 1}, .type = {NULL, NULL, NULL, NULL, EMPTY}, .noise = 1e-6},
        {.n = {4, 3, 5}, .width = {1, 1, 1}, .noise = 0.1},
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct polymesh *m, *outline;
        struct spread *s;
        ok(mesh_make(&others[i], &m));
        write_mesh(m, 0);
        ok(spread_read(folder, world, true, false, &s, &outline));
        assert_true(!outline || !outline->outline->sites);
        spread_free(s);
        polymesh_free(outline);
        polymesh_free(m);
        ok(comm_agree(world, OK));
    }
}

/* One rank has all of the mesh, in ascii and binary; several ranks have none of it. */
static void one_rank_keeps_the_arrays_that_are_wanted(void **state) {
    (void)state;
    const struct recipe r = {.n = {8, 7, 5}, .width = {0.1, 0.1, 0.1}, .type = {CYCLIC}};
    struct polymesh *m = make(&r, true), *kept, *again;
    for (int format = 0; format < 2; format++) {
        struct spread *s;
        write_mesh(m, format);
        ok(spread_read(folder, world, true, true, &s, &kept));
        again = read_sites();
        assert_true(kept->outline->sites && !again->points);
        assert_int_equal(kept->points != NULL, comm_size(world) == 1);
        ok(polymesh_complete(kept));
        ok(polymesh_complete(again));
        assert_memory_equal(kept->points, again->points, 3 * (size_t)m->npoints * sizeof *m->points);
        assert_memory_equal(kept->face_start, again->face_start, ((size_t)m->nfaces + 1) * sizeof *m->face_start);
        assert_memory_equal(kept->face_points, again->face_points,
                            (size_t)m->face_start[m->nfaces] * sizeof *m->face_points);
        assert_memory_equal(kept->owner, again->owner, (size_t)m->nfaces * sizeof *m->owner);
        assert_memory_equal(kept->neighbour, again->neighbour, (size_t)m->ninternal * sizeof *m->neighbour);
        polymesh_free(kept);
        polymesh_free(again);
        ok(comm_agree(world, OK)); /* all have read it */
    }
    polymesh_free(m);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sites_are_those_of_the_whole),     cmocka_unit_test(forests_are_those_of_the_whole),
        cmocka_unit_test(what_is_no_lattice_is_left_alone), cmocka_unit_test(stray_points_beyond_the_cells_are_seen),
        cmocka_unit_test(walls_and_noise_are_no_lattice),   cmocka_unit_test(one_rank_keeps_the_arrays_that_are_wanted),
    };
    int failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    comm_finish(world);
    return failed;
}
