/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each scene is a lattice with holes and patches, described by hand and cut into tiles; every ghost cell of every tile
 * is compared with the lattice cell that belongs there. */
#include "mesh/lattice/forest_private.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

struct scene {
    const char *name;
    int dim, n[3], tile_size;
    bool periodic[3];
    int hole_low[3], hole_high[3]; /* cells low <= i < high are missing */
    int switch_plane;              /* low side of axis 1: another patch from here on along axis 0; 0: none */
    int tiles;                     /* expected */
    bool uniform[3], even;
};
enum { EDGE = 0, WALL = 6, OTHER, CYCLIC, PATCHES }; /* EDGE + side: an edge of the domain; WALL: of the hole */

static struct comm *world;
static const double absent = -12345;

static const struct scene scenes[] = {
    {"1D", 1, {37, 1, 1}, 8, {false}, {0}, {0}, 0, 5, {false}, false},
    {"1D periodic", 1, {37, 1, 1}, 8, {true}, {0}, {0}, 0, 5, {false}, false},
    {"1D one tile, its own image", 1, {20, 1, 1}, 32, {true}, {0}, {0}, 0, 1, {false}, false},
    {"1D tiles that would be thin", 1, {5, 1, 1}, 4, {false}, {0}, {0}, 0, 1, {false}, false},
    {"2D box", 2, {23, 17, 1}, 7, {false}, {0}, {0}, 0, 12, {false}, false},
    {"2D fewer tiles than ranks", 2, {9, 6, 1}, 7, {false, true}, {0}, {0}, 0, 2, {false}, false},
    {"2D patch change", 2, {30, 20, 1}, 10, {false}, {0}, {0}, 5, 8, {false}, false},
    {"2D step", 2, {40, 16, 1}, 8, {false}, {12, 0, 0}, {40, 5, 1}, 0, 14, {false}, false},
    {"2D block inside, periodic", 2, {40, 22, 1}, 8, {true, true}, {12, 5, 0}, {20, 13, 1}, 0, 23, {false}, false},
    {"2D one cell high, its own image", 2, {30, 1, 1}, 8, {false, true}, {0}, {0}, 0, 4, {false}, false},
    {"2D thin between patches", 2, {30, 2, 1}, 8, {true, false}, {0}, {0}, 0, 4, {false}, false},
    {"3D box", 3, {9, 11, 7}, 4, {false}, {0}, {0}, 0, 18, {false}, false},
    {"3D periodic", 3, {9, 12, 8}, 4, {true, true, true}, {0}, {0}, 0, 18, {false}, false},
    {"3D step, thin own image", 3, {16, 12, 2}, 6, {false, false, true}, {8, 0, 0}, {16, 6, 2}, 0, 6, {false}, false},
    {"2D uniform along x", 2, {37, 22, 1}, 8, {true, false}, {0}, {0}, 0, 3, {true, false}, false},
    {"2D uniform along z, both periodic", 2, {22, 17, 1}, 8, {true, true}, {0}, {0}, 0, 3, {false, true}, false},
    {"3D uniform along x and z", 3, {9, 11, 8}, 4, {true, false, true}, {0}, {0}, 0, 3, {true, false, true}, false},
    {"3D uniform along y", 3, {9, 11, 8}, 4, {false, true, false}, {0}, {0}, 0, 6, {false, true, false}, false},
    {"3D uniform", 3, {9, 12, 8}, 4, {true, true, true}, {0}, {0}, 0, 1, {true, true, true}, false},
    {"2D even, else three", 2, {50, 24, 1}, 24, {true}, {0}, {0}, 0, 6, {false}, true},
    {"2D even, else five along z", 2, {24, 150, 1}, 30, {false}, {0}, {0}, 0, 10, {false}, true},
    {"2D even, too thin for it", 2, {50, 20, 1}, 24, {false}, {0}, {0}, 0, 3, {false}, true},
    {"2D even, one tile", 2, {20, 24, 1}, 24, {false}, {0}, {0}, 0, 1, {false}, true},
    {"2D even, uniform along x", 2, {50, 75, 1}, 25, {true}, {0}, {0}, 0, 6, {true}, true},
    {"1D even", 1, {37, 1, 1}, 16, {false}, {0}, {0}, 0, 3, {false}, true},
    {"3D even, else three", 3, {60, 6, 24}, 24, {false}, {0}, {0}, 0, 6, {false}, true},
    {"2D rows that fill vectors", 2, {100, 9, 1}, 63, {false}, {0}, {0}, 0, 2, {false}, false},
    {"2D silo", 2, {32, 90, 1}, 63, {false}, {8, 24, 0}, {32, 30, 1}, 0, 11, {false}, false},
};
enum { SCENES = sizeof scenes / sizeof *scenes };

static long index_of(const int n[3], const int i[3]) {
    return i[0] + n[0] * (i[1] + (long)n[1] * i[2]);
}

static bool is_solid(const struct scene *s, const int i[3]) {
    bool hole = true;
    for (int k = 0; k < 3; k++) hole = hole && i[k] >= s->hole_low[k] && i[k] < s->hole_high[k];
    return !hole;
}

/* The lattice index of the cell beyond a side of a solid cell, wrapped, or -1; *patch: of the face between, if any. */
static long beyond(const struct scene *s, const int i[3], int side, int *patch) {
    int k = side / 2, next[3] = {i[0], i[1], i[2]};
    next[k] += side % 2 ? 1 : -1;
    bool edge = next[k] < 0 || next[k] == s->n[k];
    if (edge && s->periodic[k]) {
        next[k] = (next[k] + s->n[k]) % s->n[k];
        *patch = CYCLIC;
        return index_of(s->n, next);
    }
    *patch = edge ? EDGE + side : WALL;
    if (edge && side == 2 && s->switch_plane && i[0] >= s->switch_plane) *patch = OTHER;
    return edge || !is_solid(s, next) ? -1 : index_of(s->n, next);
}

/* Cells are numbered backwards, so that no order of the lattice can pass for the polyMesh's. */
static void make_cells(const struct scene *s, struct lattice *l, struct polymesh *m) {
    l->cell = malloc((size_t)(s->n[0] * s->n[1] * s->n[2]) * sizeof *l->cell);
    for (int i[3] = {0, 0, s->n[2] - 1}; i[2] >= 0; i[2]--)
        for (i[1] = s->n[1] - 1; i[1] >= 0; i[1]--)
            for (i[0] = s->n[0] - 1; i[0] >= 0; i[0]--) l->cell[index_of(s->n, i)] = is_solid(s, i) ? m->ncells++ : -1;
}

/* Numbers the faces of one patch; PATCHES: the internal ones. */
static void number_faces(const struct scene *s, struct lattice *l, struct polymesh *m, int wanted) {
    for (int i[3] = {0}; i[2] < s->n[2]; i[2]++)
        for (i[1] = 0; i[1] < s->n[1]; i[1]++)
            for (i[0] = 0; i[0] < s->n[0]; i[0]++)
                for (int side = 0; is_solid(s, i) && side < 2 * s->dim; side++) {
                    int patch, *face = &l->face[6 * l->cell[index_of(s->n, i)] + side];
                    long next = beyond(s, i, side, &patch);
                    if (next >= 0 && patch != CYCLIC) patch = PATCHES;
                    if (patch != wanted) continue;
                    bool seen = patch == PATCHES && side % 2 == 0;
                    *face = seen ? l->face[6 * l->cell[next] + side + 1] : m->nfaces++;
                }
}

static void scene_make(const struct scene *s, struct lattice *l, struct polymesh *m) {
    static char wall[] = "wall", cyclic[] = "cyclic";
    *l = (struct lattice){.dim = s->dim, .axis = {0, 1, 2}, .thickness = 1, .even = s->even};
    if (s->dim == 2) l->axis[1] = 2, l->axis[2] = 1; /* x and z */
    *m = (struct polymesh){.npatches = PATCHES};
    for (int k = 0; k < 3; k++) {
        l->n[k] = s->n[k];
        l->origin[k] = -1.0 - k;
        l->width[k] = 0.1 * (k + 1);
        l->periodic[k] = s->periodic[k];
        l->uniform[k] = s->uniform[k];
    }
    make_cells(s, l, m);
    l->face = malloc(6 * (size_t)m->ncells * sizeof *l->face);
    for (int i = 0; i < 6 * m->ncells; i++) l->face[i] = -1;
    number_faces(s, l, m, PATCHES);
    m->ninternal = m->nfaces;
    m->patch = calloc(PATCHES, sizeof *m->patch);
    for (int p = 0; p < PATCHES; p++) {
        m->patch[p].start = m->nfaces;
        m->patch[p].type = p == CYCLIC ? cyclic : wall;
        number_faces(s, l, m, p);
        m->patch[p].nfaces = m->nfaces - m->patch[p].start;
    }
}

static void scene_free(struct lattice *l, struct polymesh *m) {
    free(l->cell);
    free(l->face);
    free(m->patch);
}

struct fixture {
    const struct scene *scene;
    struct lattice l;
    struct polymesh m;
    struct forest *f;
    int nvar, layers; /* that are to be filled */
    double **data;
};

static void begin(struct fixture *x, const struct scene *s, int nvar) {
    *x = (struct fixture){.scene = s, .nvar = nvar, .layers = GHOSTS};
    scene_make(s, &x->l, &x->m);
    status fault = forest_make(&x->l, &x->m, world, s->tile_size, &x->f);
    if (fault) fail_msg("%s: %s", s->name, status_text(fault));
    x->data = calloc((size_t)x->f->ntiles + 1, sizeof *x->data);
    for (int t = 0; t < x->f->ntiles; t++) {
        x->data[t] = malloc((size_t)(nvar * x->f->size) * sizeof **x->data);
        for (long i = 0; i < nvar * x->f->size; i++) x->data[t][i] = absent;
    }
}

static void end(struct fixture *x) {
    for (int t = 0; t < x->f->ntiles; t++) free(x->data[t]);
    free(x->data);
    forest_free(x->f);
    scene_free(&x->l, &x->m);
}

/* The lattice index of the cell that holds the values of cell i: the first one along uniform axes. */
static long computed(const struct scene *s, const int i[3]) {
    return index_of(s->n, (const int[3]){s->uniform[0] ? 0 : i[0], s->uniform[1] ? 0 : i[1], s->uniform[2] ? 0 : i[2]});
}

static double value(const struct fixture *x, const int i[3], int v) {
    return 1000000.0 * v + (double)computed(x->scene, i) + 0.5;
}

static long offset_of(const struct forest *f, int i, int j, int k) {
    return f->first + i * f->stride[0] + j * f->stride[1] + k * f->stride[2];
}

static void set_cells(struct fixture *x) {
    for (int t = 0; t < x->f->ntiles; t++) {
        const struct tile *tile = &x->f->tile[t];
        for (int v = 0; v < x->nvar; v++)
            for (int k = 0; k < tile->n[2]; k++)
                for (int j = 0; j < tile->n[1]; j++)
                    for (int i = 0; i < tile->n[0]; i++) {
                        int at[3] = {tile->low[0] + i, tile->low[1] + j, tile->low[2] + k};
                        x->data[t][v * x->f->size + offset_of(x->f, i, j, k)] = value(x, at, v);
                    }
    }
}

/* What must stand at a place of a block after the fill: beyond sides with a patch, at corners and in the padding
 * nothing was written. */
static double expected(const struct fixture *x, const struct tile *tile, const int i[3], int v) {
    int at[3], outside = 0, side = -1;
    for (int k = 0; k < 3; k++) {
        at[k] = tile->low[k] + i[k];
        if (i[k] >= 0 && i[k] < tile->n[k]) continue;
        outside++;
        side = 2 * k + (i[k] >= 0);
        if (k >= x->f->dim || i[k] < -x->layers || i[k] >= tile->n[k] + x->layers) return absent;
    }
    if (outside > 1) return absent;
    if (outside == 0) return value(x, at, v);
    int n = x->scene->n[side / 2];
    at[side / 2] = (at[side / 2] + GHOSTS * n) % n;
    return tile->side[side].patch >= 0 ? absent : value(x, at, v);
}

static void check_block(const struct fixture *x, int t) {
    const struct forest *f = x->f;
    const long rows = f->stride[2] / f->stride[1], planes = f->size / f->stride[2];
    const long start =
        f->first - (f->dim > 1 ? GHOSTS * f->stride[1] : 0) - (f->dim > 2 ? GHOSTS * f->stride[2] : 0) - GHOSTS;
    for (int v = 0; v < x->nvar; v++)
        for (long place = 0; place < f->size; place++) {
            long in_rows = place - start; /* a row begins with its low ghosts */
            long row = in_rows < 0 ? -1 : in_rows / f->stride[1];
            int i[3] = {(int)(in_rows - row * f->stride[1]) - GHOSTS, (int)(row % rows), (int)(row / rows)};
            if (f->dim > 1) i[1] -= GHOSTS;
            if (f->dim > 2) i[2] -= GHOSTS;
            double wanted = row < 0 || row >= rows * planes ? absent : expected(x, &f->tile[t], i, v);
            double found = x->data[t][v * f->size + place];
            if (found != wanted)
                fail_msg("%s: tile %d variable %d at (%d, %d, %d): %.17g, not %.17g", x->scene->name, f->tile[t].id, v,
                         i[0], i[1], i[2], found, wanted);
        }
}

static void ghost_layers_hold_the_cells_beyond(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++)
        for (int nvar = 1; nvar <= FILL_VARIABLES; nvar += s % 2 ? 4 : 7) {
            struct fixture x;
            begin(&x, &scenes[s], nvar);
            set_cells(&x);
            for (int round = 0; round < GHOSTS + 1; round++) {
                x.layers = round < GHOSTS ? round + 1 : GHOSTS;
                if (round < GHOSTS)
                    forest_fill_layers(x.f, x.layers, nvar, x.data);
                else
                    forest_fill(x.f, nvar, x.data);
                for (int t = 0; t < x.f->ntiles; t++) check_block(&x, t);
            }
            end(&x);
        }
}

enum { SHEET_LINES = 3 };

/* The place in the sheets of a tile of the cell across a side; `beyond` it or before it. */
static long sheet_place(const struct forest *f, const struct tile *t, int side, bool beyond, int v, int i, int j) {
    return forest_sheet(f, side + (beyond ? 2 * f->dim : 0), SHEET_LINES, v) + j * t->n[side < 2 ? 1 : 0] + i;
}

/* Visits the cells of all sides of a tile: sets what the sheets hold of them, or checks what came from beyond. */
static void visit_sheets(const struct fixture *x, int tile, double *sheets, bool check) {
    const struct tile *t = &x->f->tile[tile];
    for (int side = 0; side < 2 * x->f->dim; side++) {
        const int axis = side / 2, across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2;
        for (int at = 0; at < SHEET_LINES * t->n[across] * t->n[deep]; at++) {
            int cell[3] = {0}, v = at % SHEET_LINES, i = at / SHEET_LINES % t->n[across],
                j = at / SHEET_LINES / t->n[across];
            cell[across] = i;
            cell[deep] = j;
            cell[axis] = side % 2 ? t->n[axis] - !check : -check;
            const double wanted =
                check ? expected(x, t, cell, v)
                      : value(x, (int[3]){t->low[0] + cell[0], t->low[1] + cell[1], t->low[2] + cell[2]}, v);
            double *place = sheets + sheet_place(x->f, t, side, check, v, i, j);
            if (!check)
                *place = wanted;
            else if (*place != wanted)
                fail_msg("%s: tile %d side %d line %d at (%d, %d): %.17g, not %.17g", x->scene->name, t->id, side, v, i,
                         j, *place, wanted);
        }
    }
}

static void sheets_hold_the_cells_beyond(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        x.layers = 1;
        const long length = 4L * x.f->dim * SHEET_LINES * x.f->sheet;
        double **sheets = calloc((size_t)x.f->ntiles + 1, sizeof *sheets);
        for (int t = 0; t < x.f->ntiles; t++) {
            sheets[t] = malloc((size_t)length * sizeof **sheets);
            for (long i = 0; i < length; i++) sheets[t][i] = absent;
            visit_sheets(&x, t, sheets[t], false);
        }
        forest_fill_sheets(x.f, SHEET_LINES, sheets);
        for (int t = 0; t < x.f->ntiles; t++) visit_sheets(&x, t, sheets[t], true);
        for (int t = 0; t < x.f->ntiles; t++) free(sheets[t]);
        free(sheets);
        end(&x);
    }
}

static int whole(double q) {
    return q == absent ? -1 : (int)q;
}

static void ints_go_where_doubles_go(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        set_cells(&x);
        int **ints = calloc((size_t)x.f->ntiles + 1, sizeof *ints);
        for (int t = 0; t < x.f->ntiles; t++) {
            ints[t] = malloc((size_t)x.f->size * sizeof(int));
            for (long i = 0; i < x.f->size; i++) ints[t][i] = whole(x.data[t][i]);
        }
        forest_fill_layers(x.f, 1, 1, x.data);
        forest_fill_int(x.f, ints);
        for (int t = 0; t < x.f->ntiles; t++) {
            for (long i = 0; i < x.f->size; i++) assert_int_equal(ints[t][i], whole(x.data[t][i]));
            free(ints[t]);
        }
        free(ints);
        end(&x);
    }
}

/* The list of all tiles shows what each of two ranks would have, on any number of ranks. */
static void a_lattice_cut_in_two_is_dealt_by_halves(void **state) {
    (void)state;
    int cut = 0;
    for (int s = 0; s < SCENES; s++) {
        const struct scene *scene = &scenes[s];
        const int last = scene->dim - 1;
        struct fixture x;
        if (!scene->even || !strstr(scene->name, "else")) continue;
        begin(&x, scene, 1);
        for (int id = 0; id < x.f->ntiles_all; id++)
            if ((x.f->hidden->all[id].low[last] >= scene->n[last] / 2) != (id >= x.f->ntiles_all / 2))
                fail_msg("%s: tile %d begins at %d of %d", scene->name, id, x.f->hidden->all[id].low[last],
                         scene->n[last]);
        end(&x);
        cut++;
    }
    assert_int_equal(cut, 3);
}

/* Without cuts along the last axis one of two ranks would have 1920 of the 2736 cells. */
static void two_ranks_share_a_lattice_with_a_hole(void **state) {
    (void)state;
    struct fixture x;
    int start[3];
    long cells[2] = {0, 0};
    begin(&x, &scenes[SCENES - 1], 1);
    trees_deal(x.f->hidden->all, x.f->ntiles_all, 2, start);
    for (int id = 0; id < x.f->ntiles_all; id++) {
        const int *n = x.f->hidden->all[id].n;
        cells[id >= start[1]] += (long)n[0] * n[1] * n[2];
    }
    assert_int_equal(cells[0] + cells[1], 2736);
    assert_true(cells[0] <= 1642 && cells[1] <= 1642);
    end(&x);
}

static void only_remote_tiles_wait_for_finish(void **state) {
    (void)state;
    struct fixture x;
    begin(&x, &scenes[8], 2);
    set_cells(&x);
    forest_fill_start(x.f, GHOSTS, 2, x.data);
    long nremote = 0;
    for (int t = 0; t < x.f->ntiles; t++) {
        nremote += x.f->tile[t].remote;
        if (x.f->tile[t].remote) continue;
        forest_fill_tile(x.f, t, NULL);
        check_block(&x, t);
    }
    forest_fill_finish(x.f);
    for (int t = 0; t < x.f->ntiles; t++) {
        if (x.f->tile[t].remote) forest_fill_tile(x.f, t, NULL);
        check_block(&x, t);
    }
    comm_sum_long(world, &nremote, 1);
    assert_int_equal(nremote > 0, comm_size(world) > 1);
    end(&x);
}

static void check_side(const struct fixture *x, const struct tile *tile, int side) {
    const int *face = tile->side[side].face;
    int k = side / 2, patch, low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = a == k && side % 2 ? tile->n[a] - 1 : 0;
        high[a] = a == k ? low[a] + 1 : tile->n[a];
    }
    if (k >= x->f->dim) {
        assert_true(tile->side[side].patch == -1 && !face);
        return;
    }
    for (int i[3] = {low[0], low[1], low[2]}; i[2] < high[2]; i[2]++)
        for (i[1] = low[1]; i[1] < high[1]; i[1]++)
            for (i[0] = low[0]; i[0] < high[0]; i[0]++) {
                int at[3] = {tile->low[0] + i[0], tile->low[1] + i[1], tile->low[2] + i[2]};
                int cell = x->l.cell[index_of(x->l.n, at)];
                long next = beyond(x->scene, at, side, &patch);
                assert_int_equal(tile->side[side].patch, next < 0 ? patch : -1);
                if (next < 0)
                    assert_int_equal(x->m.patch[patch].start + *face++, x->l.face[6 * cell + side]);
                else
                    assert_null(face);
            }
}

/* A block has its tile's place and cells, but for uniform axes; blocks stand tile by tile. Returns its cells. */
static long check_cells(const struct fixture *x, const struct forest_block *b) {
    const struct tile *tile = &x->f->tile[b->tile];
    for (int k = 0; k < 3; k++) {
        assert_in_range(b->n[k], 1, x->scene->tile_size + 2);
        assert_int_equal(tile->low[k], x->scene->uniform[k] ? 0 : b->low[k]);
        assert_int_equal(tile->n[k], x->scene->uniform[k] ? 1 : b->n[k]);
        assert_int_equal(x->f->step[k], x->scene->uniform[k] ? 0 : x->f->stride[k]);
    }
    for (int i[3] = {0}; i[2] < b->n[2]; i[2]++)
        for (i[1] = 0; i[1] < b->n[1]; i[1]++)
            for (i[0] = 0; i[0] < b->n[0]; i[0]++) {
                const int at[3] = {b->low[0] + i[0], b->low[1] + i[1], b->low[2] + i[2]};
                assert_int_equal(b->cell[index_of(b->n, i)], x->l.cell[index_of(x->l.n, at)]);
            }
    return (long)b->n[0] * b->n[1] * b->n[2];
}

static void tiles_cover_the_lattice(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        const struct forest *f = x.f;
        long ncells = 0, computed_cells = 0, ntiles = f->ntiles, nblocks = f->nblocks;
        for (int b = 0; b < f->nblocks; b++) {
            ncells += check_cells(&x, &f->block[b]);
            assert_true(b == 0 || f->block[b].tile == f->block[b - 1].tile ||
                        f->block[b].tile == f->block[b - 1].tile + 1);
        }
        for (int t = 0; t < f->ntiles; t++) {
            const struct tile *tile = &f->tile[t];
            computed_cells += (long)tile->n[0] * tile->n[1] * tile->n[2];
            for (int k = 0; k < 3; k++) assert_in_range(tile->n[k], 1, scenes[s].tile_size + 2);
            assert_int_equal(tile->id, f->tile[0].id + t);
            for (int side = 0; side < 6; side++) check_side(&x, tile, side);
        }
        comm_sum_long(world, &ncells, 1);
        comm_sum_long(world, &computed_cells, 1);
        comm_sum_long(world, &ntiles, 1);
        comm_sum_long(world, &nblocks, 1);
        assert_int_equal(ncells, x.m.ncells);
        assert_int_equal(f->ncells_all, x.m.ncells);
        assert_int_equal(computed_cells * f->images, x.m.ncells);
        assert_int_equal(nblocks, f->nblocks_all);
        assert_int_equal(ntiles, f->ntiles_all);
        if (f->ntiles_all != scenes[s].tiles) fail_msg("%s: %d tiles", scenes[s].name, f->ntiles_all);
        assert_true(f->first % 8 == 0 && f->stride[1] % 8 == 0 && f->size % 8 == 0 && f->stride[0] == 1);
        assert_true(fabs(f->volume - 0.006) < 1e-15);
        end(&x);
    }
}

/* 54 + 46 cells have 55 + 47 faces, in 13 vectors; 50 + 50 would have 51 + 51, in 14. Each of two ranks gets one. */
static void rows_fill_vectors(void **state) {
    (void)state;
    struct fixture x;
    int s = 0;
    while (strcmp(scenes[s].name, "2D rows that fill vectors") != 0) s++;
    begin(&x, &scenes[s], 1);
    for (int t = 0; t < x.f->ntiles; t++) assert_true(x.f->tile[t].n[0] == 46 || x.f->tile[t].n[0] == 54);
    if (comm_size(world) == 2) assert_int_equal(x.f->ntiles, 1);
    end(&x);
}

static void values_arrive_at_their_cells(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        const size_t n = (size_t)x.m.ncells;
        double *mine = calloc(n, sizeof *mine), *next = mine, *all = calloc(n, sizeof *all);
        for (int b = 0; b < x.f->nblocks; b++) {
            const struct forest_block *here = &x.f->block[b];
            for (int k = 0; k < here->n[2]; k++)
                for (int j = 0; j < here->n[1]; j++)
                    for (int i = 0; i < here->n[0]; i++)
                        *next++ = value(&x, (int[3]){here->low[0] + i, here->low[1] + j, here->low[2] + k}, 0);
        }
        assert_null(forest_gather(x.f, mine, comm_root(world) ? all : NULL));
        for (int i[3] = {0}; comm_root(world) && i[2] < x.l.n[2]; i[2]++)
            for (i[1] = 0; i[1] < x.l.n[1]; i[1]++)
                for (i[0] = 0; i[0] < x.l.n[0]; i[0]++)
                    if (is_solid(x.scene, i)) assert_true(all[x.l.cell[index_of(x.l.n, i)]] == value(&x, i, 0));
        free(mine);
        free(all);
        end(&x);
    }
}

static void sums_have_the_same_bits_on_any_number_of_ranks(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        double *mine = malloc(((size_t)x.f->nblocks + 1) * sizeof *mine), serial = 0, sum;
        for (int b = 0; b < x.f->nblocks; b++) mine[b] = sin(1e4 * x.f->block[b].id) / 3;
        for (int id = 0; id < x.f->nblocks_all; id++) serial += sin(1e4 * id) / 3;
        assert_null(forest_sum(x.f, mine, &sum));
        assert_memory_equal(&sum, &serial, sizeof sum);
        free(mine);
        end(&x);
    }
}

/* How many ranks have the point s (in cells from the origin), and, if one, the lattice index of its cell. */
static long locate(const struct fixture *x, const double s[3], long *index) {
    double point[3] = {0};
    for (int k = 0; k < x->f->dim; k++) point[x->f->axis[k]] = x->f->origin[k] + s[k] * x->f->width[k];
    int block, cell;
    long owner[2] = {0};
    forest_locate(x->f, point, &block, &cell);
    if (block >= 0) {
        owner[0] = 1;
        while (x->l.cell[owner[1]] != x->f->block[block].cell[cell]) owner[1]++;
    }
    comm_sum_long(world, owner, 2);
    *index = owner[1];
    return owner[0];
}

static void points_are_found_by_one_rank(void **state) {
    (void)state;
    for (int s = 0; s < SCENES; s++) {
        struct fixture x;
        begin(&x, &scenes[s], 1);
        const int *n = x.scene->n;
        long index;
        for (long place = 0; place < (long)n[0] * n[1] * n[2]; place += 3) {
            int i[3] = {(int)(place % n[0]), (int)(place / n[0] % n[1]), (int)(place / n[0] / n[1])};
            const double inside[3] = {i[0] + 0.3, i[1] + 0.7, i[2] + 0.5}, corner[3] = {i[0], i[1], i[2]};
            assert_int_equal(locate(&x, inside, &index), is_solid(x.scene, i));
            assert_true(!is_solid(x.scene, i) || index == place);
            long found = locate(&x, corner, &index);
            assert_in_range(found, 0, 1);
            assert_true(!is_solid(x.scene, i) || (found == 1 && index == place));
        }
        const double top[3] = {n[0], n[1], n[2]}, outside[3] = {n[0] + 0.1, 0.5, 0.5}, nowhere[3] = {NAN, 0, 0};
        const int last[3] = {n[0] - 1, n[1] - 1, n[2] - 1};
        assert_int_equal(locate(&x, top, &index), is_solid(x.scene, last));
        assert_true(!is_solid(x.scene, last) || index == index_of(n, last));
        assert_int_equal(locate(&x, outside, &index), 0);
        assert_int_equal(locate(&x, nowhere, &index), 0);
        end(&x);
    }
}

static void check_refusal(const struct scene *s, int tile_size, const char *const *words) {
    struct lattice l;
    struct polymesh m;
    struct forest *f;
    scene_make(s, &l, &m);
    status fault = forest_make(&l, &m, world, tile_size, &f);
    assert_non_null(fault);
    assert_null(f);
    assert_int_equal(status_kind(fault), ERR_INPUT);
    for (; *words; words++)
        if (!strstr(status_text(fault), *words)) fail_msg("no \"%s\" in: %s", *words, status_text(fault));
    status_free(fault);
    scene_free(&l, &m);
}

/* trees_deal is p4est's partition, and a rank that is alone has the tiles that it has among the others. */
static void one_rank_of_many_is_set_up_alone(void **state) {
    (void)state;
    for (int i = 0; i < SCENES; i++) {
        struct fixture x;
        begin(&x, &scenes[i], 1);
        const struct trees *trees = x.f->hidden->trees;
        int *start = malloc((size_t)(comm_size(world) + 1) * sizeof *start);
        trees_deal(x.f->hidden->all, x.f->hidden->nall, comm_size(world), start);
        assert_memory_equal(start, trees->start, (size_t)(comm_size(world) + 1) * sizeof *start);
        struct comm *alone;
        struct forest *f;
        assert_null(comm_pretend(comm_rank(world), comm_size(world), &alone));
        assert_null(forest_make(&x.l, &x.m, alone, x.scene->tile_size, &f));
        assert_int_equal(f->ntiles, x.f->ntiles);
        assert_int_equal(f->nblocks, x.f->nblocks);
        for (int t = 0; t < f->ntiles; t++) {
            assert_int_equal(f->tile[t].id, x.f->tile[t].id);
            assert_int_equal(f->tile[t].remote, x.f->tile[t].remote);
            assert_memory_equal(f->tile[t].low, x.f->tile[t].low, sizeof f->tile[t].low);
        }
        forest_free(f);
        comm_alone_free(alone);
        free(start);
        end(&x);
    }
}

/* Six tiles that differ by a row are dealt as 3 and 3, and one of half the size weighs half. */
static void tiles_that_differ_by_a_row_weigh_the_same(void **state) {
    (void)state;
    const int length[6] = {42, 43, 42, 43, 43, 43};
    struct trees_tile all[6] = {{{0}, {0}, {0}}};
    int start[4];
    for (int t = 0; t < 6; t++) memcpy(all[t].n, (const int[3]){length[t], 48, 1}, sizeof all[t].n);
    trees_deal(all, 6, 2, start);
    assert_memory_equal(start, ((const int[3]){0, 3, 6}), 3 * sizeof *start);
    trees_deal(all, 6, 3, start);
    assert_memory_equal(start, ((const int[4]){0, 2, 4, 6}), 4 * sizeof *start);
    all[0].n[1] = all[1].n[1] = 24;
    trees_deal(all, 6, 2, start);
    assert_int_equal(start[1], 4);
    all[0].n[0] = all[0].n[1] = 1;
    assert_int_equal(trees_weight(&all[0], trees_largest(all, 6)), 1);
}

static void what_cannot_be_cut_is_refused(void **state) {
    (void)state;
    const struct scene step = {"thin step", 2, {30, 16, 1}, 8, {false}, {10, 0, 0}, {30, 2, 1}, 0, 0, {false}, false};
    const char *const thin[] = {"2 cells along z", "z = -2 and z = -1.6", "at least 3", "factor of 2", NULL};
    check_refusal(&step, 8, thin);
    const struct scene change = {"thin patch", 2, {30, 16, 1}, 8, {false}, {0}, {0}, 1, 0, {false}, false};
    const char *const one[] = {"1 cell along x", "x = -1 and x = -0.9", "factor of 3", NULL};
    check_refusal(&change, 8, one);
    const struct scene half = {
        "hole at one periodic edge", 2, {30, 16, 1}, 8, {true}, {25, 8, 0}, {30, 16, 1}, 0, 0, {false}, false};
    const char *const image[] = {"cyclic", "x = -1", "opposite", NULL};
    check_refusal(&half, 8, image);
    const char *const size[] = {"tile size 2", "at least 3", NULL};
    check_refusal(&scenes[0], 2, size);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ghost_layers_hold_the_cells_beyond),
        cmocka_unit_test(sheets_hold_the_cells_beyond),
        cmocka_unit_test(ints_go_where_doubles_go),
        cmocka_unit_test(a_lattice_cut_in_two_is_dealt_by_halves),
        cmocka_unit_test(two_ranks_share_a_lattice_with_a_hole),
        cmocka_unit_test(only_remote_tiles_wait_for_finish),
        cmocka_unit_test(tiles_cover_the_lattice),
        cmocka_unit_test(rows_fill_vectors),
        cmocka_unit_test(values_arrive_at_their_cells),
        cmocka_unit_test(sums_have_the_same_bits_on_any_number_of_ranks),
        cmocka_unit_test(points_are_found_by_one_rank),
        cmocka_unit_test(one_rank_of_many_is_set_up_alone),
        cmocka_unit_test(tiles_that_differ_by_a_row_weigh_the_same),
        cmocka_unit_test(what_cannot_be_cut_is_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
