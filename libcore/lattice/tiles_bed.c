/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bed of implicit acoustics on a lattice: which cells it holds, their lists, and what goes to and from the tiles.
 */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

#include <stdlib.h>

/* Memory of the lattice for the bed: g->tiles->bed. */
struct tiles_bed {
    /* [ntiles] of [dim][nvar][size]: fluxes of the last stage, by axis and the cell below; NULL: no bed yet */
    double **fluxes;
    /* In the plane the cells are one box, and a face has the shape of its axis. Volumes are 1, and areas 1/width.
     * Cells of a body of revolution have the shape of their place along the radius, and faces that of axis + dim place,
     * where the place of a face across the radius is that of the cell above it. All have the weight r. */
    struct bed_shapes shapes;
    struct bed_round round;
    double *memory;
    int *body; /* the memory of round.body */
};

static const double NOTHING = 1e-200; /* m: the radius of a face on the axis, as pressures on it are divided by areas */

/* Returns how many cells a round lattice has along the radius; else 1. */
static int places_of(const struct gas *g) {
    const struct forest *f = g->forest;
    double most = 1;
    for (int t = 0; t < f->ntiles && f->radial >= 0; t++)
        most = larger(most, f->tile[t].low[f->radial] + f->tile[t].n[f->radial]);
    comm_max(g->comm, &most, 1);
    return (int)most;
}

static void make_shape(const struct gas *g, struct tiles_bed *b, int place, int k) {
    const struct forest *f = g->forest;
    const int shape = k + g->dim * place;
    const double half = 0.5 * f->width[k];
    double weight = 1;
    if (f->radial >= 0) weight = larger(forest_radius(f, place + (k == f->radial ? 0 : 0.5)), NOTHING);
    b->shapes.area[shape] = weight / f->width[k];
    b->shapes.depth[0][shape] = half;
    b->shapes.normal[k][shape] = 1;
    for (int side = 0; side < 2; side++) b->shapes.arm[side][k][shape] = side ? -half : half;
    if (f->radial < 0) return;
    b->round.flat[shape] = 1 / f->width[k];
    b->round.body[0][shape] = k == f->radial ? place - 1 : place;
    b->round.body[1][shape] = place;
}

static status make_shapes(struct gas *g, struct tiles_bed *b) {
    const struct forest *f = g->forest;
    const int places = places_of(g), all = f->radial >= 0 ? places + 1 : 1;
    const long faces = (long)g->dim * all;
    struct bed_shapes *s = &b->shapes;
    TRY(comm_agree(g->comm, allocate(&b->memory, all + (3 + 3 * g->dim) * faces, sizeof(double), "the bed")));
    TRY(comm_agree(g->comm, allocate(&b->body, 2 * faces, sizeof(int), "the bed")));
    double *at = b->memory + all;
    *s = (struct bed_shapes){.boxes = true, .volume = b->memory, .area = at, .depth = {at + faces, at + faces}};
    b->round = (struct bed_round){f->radial, b->memory, at + 2 * faces, .body = {b->body, b->body + faces}};
    at += 3 * faces;
    for (int k = 0; k < g->dim; k++, at += 3 * faces) {
        s->normal[k] = at;
        for (int side = 0; side < 2; side++) s->arm[side][k] = b->round.mid[side][k] = at + (1 + side) * faces;
    }
    if (f->radial >= 0) s->round = &b->round;
    for (int i = 0; i < all; i++) {
        s->volume[i] = f->radial >= 0 ? forest_radius(f, i + 0.5) : 1;
        for (int k = 0; k < g->dim; k++) make_shape(g, b, i, k);
    }
    g->dense->bed.home->shapes = s;
    return OK;
}

/* A block of the bed, which ranks are dealt, is this number of rows of a tile along the last axis. */
enum { BLOCK_ROWS = 8 };

static int blocks_of_tile(const struct gas *g, int tile) {
    return g->dim > 1 ? (g->forest->tile[tile].n[g->dim - 1] + BLOCK_ROWS - 1) / BLOCK_ROWS : 1;
}

status tiles_bed_make(struct gas *g) {
    const struct forest *f = g->forest;
    struct tiles_bed *b;
    int blocks = 0;
    for (int t = 0; t < f->ntiles; t++) {
        const int *n = f->tile[t].n;
        blocks += blocks_of_tile(g, t);
        g->dense->own += (long)n[0] * n[1] * n[2];
    }
    TRY(bed_make(&g->dense->bed, blocks));
    TRY(allocate(&b, 1, sizeof *b, "the bed"));
    g->tiles->bed = b;
    TRY(make_shapes(g, b));
    g->dense->sides = 2 * g->dim;
    return allocate(&b->fluxes, f->ntiles, sizeof(double *), "tiles");
}

void tiles_bed_free(struct gas *g) {
    struct tiles_bed *b = g->tiles ? g->tiles->bed : NULL;
    if (!b) return;
    blocks_free(g->forest, b->fluxes);
    free(b->memory);
    free(b->body);
    free(b);
}

/* ---- the parts ---- */

struct ringing { /* marks the ring around the parts above `level` */
    const struct forest *f;
    double *part;
    int dim, level;
    bool found;
};

KERNEL static void bed_around(int n, const double *restrict below, const double *restrict above,
                              double *restrict most) {
    for (int i = 0; i < n; i++) most[i] = larger(most[i], larger(below[i], above[i]));
}

/* Gives `level` to those of n <= BATCH cells without a part beside which there is more than `least`; returns whether
 * any has a part. */
KERNEL static bool bed_ring(int n, double least, double level, const double *restrict most, double *restrict part) {
    uint64_t found = 0; /* the bits of parts, which are not negative: a loop over them is one of vectors */
    for (int i = 0; i < n; i++) {
        part[i] = select_double((part[i] == 0) & (most[i] > least), level, part[i]);
        found |= bits_of(part[i]);
    }
    return found != 0;
}

static void ring_visit(void *ringing, long offset, int n) {
    struct ringing *r = ringing;
    double *part = r->part + offset, most[BATCH] = {0};
    for (int k = 0; k < r->dim; k++) bed_around(n, part - r->f->stride[k], part + r->f->stride[k], most);
    r->found |= bed_ring(n, r->level == BED_FROZEN ? BED_DENSE : r->level, r->level, most, part);
}

/* Has a tile without cells of the bed a neighbour's in its ghosts? */
static bool beside_bed(const struct gas *g, int tile) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    for (int side = 0; side < 2 * g->dim; side++) {
        const int axis = side / 2, across[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
        const long first = f->first + (side % 2 ? t->n[axis] : -1) * f->stride[axis];
        for (int k = 0; k < t->n[across[1]] && t->side[side].patch < 0; k++)
            for (int j = 0; j < t->n[across[0]]; j++)
                if (g->dense->part[tile][first + j * f->stride[across[0]] + k * f->stride[across[1]]] > 0) return true;
    }
    return false;
}

/* Marks the frozen, live and outer cells around the dense ones (enum bed_part). */
void tiles_bed_rings(struct gas *g) {
    struct forest *f = g->forest;
    bool *holds = g->dense->holds;
    for (int level = BED_FROZEN; level >= BED_OUTER; level--) {
        forest_fill_layers(f, 1, 1, g->dense->part);
        for (int t = 0; t < f->ntiles; t++) {
            struct ringing r = {f, g->dense->part[t], g->dim, level, false};
            if (!holds[t] && !beside_bed(g, t)) continue;
            runs_visit(f, &f->tile[t], 0, ring_visit, &r);
            holds[t] = r.found;
        }
    }
    forest_fill_layers(f, 1, 1, g->dense->part);
    for (int t = 0; t < f->ntiles; t++) activity_unfold(g, t, &g->U);
}

void tiles_bed_speeds(struct gas *g, const struct row *row, struct bed_speeds *out) {
    const struct work *w = &g->tiles->work;
    const size_t bytes = (size_t)row->n * sizeof(double);
    primitives_of_row(g, g->U.block[row->block], row->at, row->n);
    memcpy(out->eps, w->eps + row->at, bytes);
    memcpy(out->p, w->p + row->at, bytes);
    memset(out->thin, 0, bytes);
    memset(out->flow, 0, bytes);
    for (int k = 0; k < g->dim; k++) {
        const double inverse = 1 / g->forest->width[k], *u = w->velocity[k] + row->at, *c = w->c + row->at;
        for (int i = 0; i < row->n; i++) {
            out->flow[i] += fabs(u[i]) * inverse;
            out->thin[i] += (fabs(u[i]) + c[i]) * inverse;
        }
    }
}

/* ---- the lists ---- */

/* A number over all ranks: no tile has as many rows as its memory has room for. */
static int block_number(const struct forest *f, int tile, int block) {
    const int room = (int)(f->size / f->stride[f->dim - 1]) / BLOCK_ROWS + 1;
    return f->tile[tile].id * room + block;
}

struct listing { /* lists the cells of a tile: how many there are; or, if `bed` is set, their rows and numbers */
    const struct gas *g;
    struct dense *bed;
    int tile, rows, cells, *block_end; /* block_end: the cells up to the end of each block of the tile */
};

static void list_visit(void *listing, long offset, int n) {
    struct listing *l = listing;
    const struct forest *f = l->g->forest;
    const double *part = l->g->dense->part[l->tile] + offset;
    const long row = l->g->dim > 1 ? (offset - f->first) / f->stride[l->g->dim - 1] : 0;
    for (int i = 0, end; i < n; i = end + 1) {
        for (end = i; end < n && part[end] > 0; end++)
            if (l->bed) l->bed->number[l->tile][offset + end] = l->bed->bed.home->low + ++l->cells;
        if (end == i) continue;
        if (l->bed)
            l->bed->row[l->rows] = (struct row){l->tile, offset + i, end - i};
        else
            l->cells += end - i;
        l->rows++;
    }
    if (l->block_end) l->block_end[row / BLOCK_ROWS] = l->cells;
}

/* Lists the blocks, or the cells in them. */
static struct listing list_cells(struct gas *g, bool blocks) {
    const struct forest *f = g->forest;
    struct bed_set *bed = g->dense->bed.home;
    struct listing l = {.g = g, .bed = blocks ? NULL : g->dense};
    if (blocks) bed->blocks = bed->first[0] = 0;
    for (l.tile = 0; l.tile < f->ntiles; l.tile++) {
        if (!g->dense->holds[l.tile]) continue;
        l.block_end = blocks ? bed->first + bed->blocks + 1 : NULL;
        runs_visit(f, &f->tile[l.tile], 0, list_visit, &l);
        for (int i = 0; blocks && i < blocks_of_tile(g, l.tile); i++)
            bed->number[bed->blocks++] = block_number(f, l.tile, i);
    }
    return l;
}

/* The patch beyond the face of a cell at `at` along an axis, and the face within it; patch -1: there is none. */
static struct patch_face patch_beyond(const struct gas *g, int tile, long at, int axis, bool above) {
    const struct tile *t = &g->forest->tile[tile];
    const struct forest *f = g->forest;
    const struct side *side = &t->side[2 * axis + above];
    long remains = at - f->first;
    int place[3] = {0}, face = 0;
    for (int k = g->dim - 1; k >= 0; k--) {
        place[k] = (int)(remains / f->stride[k]);
        remains -= place[k] * f->stride[k];
    }
    if (side->patch < 0 || place[axis] != (above ? t->n[axis] - 1 : 0)) return (struct patch_face){-1, 0};
    for (int k = g->dim - 1; k >= 0; k--)
        if (k != axis) face = face * t->n[k] + place[k];
    return (struct patch_face){side->patch, side->face[face]};
}

/* The place of a cell's lower or upper face along an axis in the list of the cells' faces. */
static int side_entry(const struct gas *g, int cell, int axis, bool above) {
    return 2 * (g->dim * cell + axis) + above;
}

/* Returns the shape of a face of the cell at `at` of a tile. */
static int face_shape(const struct gas *g, int tile, long at, int axis, bool above) {
    const int radial = g->forest->radial;
    if (radial < 0) return axis;
    return axis + g->dim * (forest_place_along(g->forest, tile, at, radial) + (axis == radial && above));
}

/* Adds the face between cell i of the bed, at `at` of a tile, and what has the number `other`. */
static void add_face(struct gas *g, int tile, long at, int i, int axis, bool above, int other) {
    struct dense *d = g->dense;
    struct bed_set *bed = d->bed.home;
    const int f = bed->faces++;
    bed->left[f] = above ? bed->low + i : other;
    bed->right[f] = above ? other : bed->low + i;
    const struct patch_face beyond = patch_beyond(g, tile, at, axis, above);
    bed->kind[f] = (unsigned char)(other >= 0 ? BED_INNER : dense_kind(g, beyond.patch));
    bed->shape[f] = face_shape(g, tile, at, axis, above);
    bed->face_of_cell[side_entry(g, i, axis, above)] = above ? f : ~f;
    if (other >= bed->low && other < bed->low + bed->cells)
        bed->face_of_cell[side_entry(g, other - bed->low, axis, false)] = ~f;
    if (other < 0)
        d->border[d->borders++] =
            (struct dense_border){f, tile, at, at + (above ? 1 : -1) * g->forest->stride[axis], beyond};
}

/* Makes the face above each cell, and that below where no cell of this rank makes it. */
static void list_faces(struct gas *g) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    for (int k = 0; k < g->dim; k++)
        for (int r = 0, i = 0; r < d->rows; r++) {
            const int tile = d->row[r].block, *number = d->number[tile];
            const long first = d->row[r].at, stride = g->forest->stride[k];
            for (long at = first; at < first + d->row[r].n; at++, i++) {
                const int below = number[at - stride] - 1;
                add_face(g, tile, at, i, k, true, number[at + stride] - 1);
                if (below < bed->low || below >= bed->low + bed->cells) add_face(g, tile, at, i, k, false, below);
            }
        }
}

/* Sets the shapes of this rank's cells, which on several ranks stand behind cells of others. */
static void find_bodies(struct gas *g) {
    const struct dense *d = g->dense;
    for (int r = 0, i = 0; r < d->rows; r++)
        for (int j = 0; j < d->row[r].n; j++)
            d->bed.home->body[i++] =
                forest_place_along(g->forest, d->row[r].block, d->row[r].at + j, g->forest->radial);
}

static status make_fluxes(struct gas *g) {
    const long doubles = (long)g->dim * g->nvar * g->forest->size + SLACK;
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->dense->holds[t] && !g->tiles->bed->fluxes[t])
            TRY(allocate(&g->tiles->bed->fluxes[t], doubles, sizeof(double), "the bed"));
    return OK;
}

/* What needs other ranks comes first: a rank with more of the bed has more to list, and less to do in the stages. */
status tiles_bed_list(struct gas *g) {
    struct bed_set *bed = g->dense->bed.home;
    const struct listing l = list_cells(g, true);
    TRY(dense_list(g, make_fluxes(g), l.rows, 2 * g->dim * l.cells));
    g->dense->rows = list_cells(g, false).rows;
    forest_fill_int(g->forest, g->dense->number);
    list_faces(g);
    for (int i = 0; i <= bed->cells; i++) bed->face_start[i] = 2 * g->dim * i;
    memset(bed->body, 0, (size_t)bed->cells * sizeof *bed->body);
    if (bed->shapes->round) find_bodies(g);
    return OK;
}

/* ---- to and from the tiles ---- */

void tiles_bed_fill(struct gas *g, const struct state *from) {
    forest_fill_layers(g->forest, 1, g->nvar, from->block);
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->dense->holds[t]) ghosts_of_patches(g, t, from->block[t], GHOSTS, NULL);
}

void tiles_note_fluxes(struct gas *g, const struct strip *s, double (*out)[BATCH], int column) {
    double *to = g->tiles->bed->fluxes[s->tile] + (long)s->axis * g->nvar * g->forest->size + s->offset;
    for (int v = 0; v < g->nvar; v++) memcpy(to + v * g->forest->size, out[v] + column, (size_t)s->n * sizeof(double));
}

void tiles_bed_keep(struct gas *g, double weight) {
    const struct bed_set *bed = g->dense->bed.home;
    for (int i = 0; i < g->dense->borders; i++) {
        const struct dense_border *b = &g->dense->border[i];
        const int f = b->face;
        if (bed->kind[f] != BED_KEPT) continue;
        const long line = (long)(bed->shape[f] % g->dim) * g->nvar, below = bed->left[f] < 0 ? b->beyond : b->inside;
        const double *from = g->tiles->bed->fluxes[b->block] + line * g->forest->size + below;
        for (int v = 0; v < g->nvar; v++) bed->kept[v][f] += weight * from[v * g->forest->size];
    }
}

void tiles_tally_bed(struct gas *g, double dt) {
    const struct bed_set *bed = g->dense->bed.home;
    for (int i = 0; i < g->dense->borders; i++) {
        const struct dense_border *b = &g->dense->border[i];
        const bool high = bed->left[b->face] >= 0;
        if (bed->kind[b->face] == BED_KEPT) continue;
        const int to = tiles_tally_place(g, b->block, 2 * (bed->shape[b->face] % g->dim) + high, b->inside);
        for (int v = 0; v < g->nvar; v++) {
            const double flux = bed->kept[v][b->face];
            const double left = high ? dt * flux : -dt * flux,
                         before = g->step.hybrid ? 0 : g->books.tally->flow[v][to];
            g->books.tally->flow[v][to] = before + left;
        }
    }
}

void tiles_bed_spread(struct gas *g, const double *per_block, double *raised) {
    int block = 0;
    for (int t = 0; t < g->forest->ntiles; t++) {
        raised[t] = 0;
        if (!g->dense->holds[t]) continue;
        for (int i = blocks_of_tile(g, t); i > 0; i--) raised[t] += per_block[block++];
    }
}

/* ---- in the stages ---- */

bool tiles_hold_bed(const struct gas *g, int tile) {
    return g->step.hybrid && g->dense->holds[tile];
}

struct span tiles_moving_span(const struct gas *g, int tile, long row, int n) {
    const double *part = g->dense->part[tile] + row;
    struct span s = {0, n};
    while (s.low < n && part[s.low] >= BED_FROZEN) s.low++;
    while (s.high > s.low && part[s.high - 1] >= BED_FROZEN) s.high--;
    return span_empty(s) ? SPAN_EMPTY : s;
}
