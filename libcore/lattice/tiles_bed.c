/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bed of implicit acoustics on a lattice: which cells it holds, their lists, and what goes to and from the tiles.
 */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

#include <stdlib.h>

struct seat { /* a place in the tiles: of a cell, of a ghost's layer, of the cell below a face */
    int tile;
    long at;
};
/* Memory of the lattice for the bed: g->tiles->bed. */
struct tiles_bed {
    bool *holds;     /* [ntiles] has the tile a cell of the bed? */
    double **listed; /* [ntiles] of [size]: the parts for which the bed was listed */
    /* [ntiles] of [dim][nvar][size]: fluxes of the last stage, by axis and the cell below; NULL: no bed yet */
    double **fluxes;
    struct seat *seat, *face; /* [cells], then [ghosts]; [faces] */
    int *outer, outers;       /* [outers] the faces that are not BED_INNER */
    long room;
    /* The cells are one box, and a face has the shape of its axis. Volumes are 1, and areas 1/width. */
    struct bed_shapes shapes;
    double one, area[MAX_DIM], half[MAX_DIM], to[2][MAX_DIM][MAX_DIM], normal[MAX_DIM][MAX_DIM];
};

static void make_shapes(const struct gas *g, struct tiles_bed *b) {
    struct bed_shapes *s = &b->shapes;
    *s = (struct bed_shapes){.boxes = true, .volume = &b->one, .area = b->area, .depth = {b->half, b->half}};
    b->one = 1;
    for (int k = 0; k < g->dim; k++) {
        s->normal[k] = b->normal[k];
        b->normal[k][k] = 1;
        b->area[k] = 1 / g->forest->width[k];
        b->half[k] = 0.5 * g->forest->width[k];
        for (int side = 0; side < 2; side++) {
            s->arm[side][k] = b->to[side][k];
            b->to[side][k][k] = side ? -b->half[k] : b->half[k];
        }
    }
    g->dense->bed.shapes = s;
}

status tiles_bed_make(struct gas *g) {
    struct tiles_bed *b;
    TRY(blocks_make(g->forest, 1, &g->dense->part));
    TRY(allocate(&b, 1, sizeof *b, "the bed"));
    g->tiles->bed = b;
    make_shapes(g, b);
    TRY(blocks_make(g->forest, 1, &b->listed));
    TRY(allocate(&b->holds, g->forest->ntiles, sizeof(bool), "tiles"));
    return allocate(&b->fluxes, g->forest->ntiles, sizeof(double *), "tiles");
}

void tiles_bed_free(struct gas *g) {
    struct tiles_bed *b = g->tiles ? g->tiles->bed : NULL;
    blocks_free(g->forest, g->dense->part);
    if (!b) return;
    blocks_free(g->forest, b->fluxes);
    blocks_free(g->forest, b->listed);
    free(b->holds);
    free(b->seat);
    free(b->outer);
    free(b);
}

/* ---- the parts ---- */

struct finding { /* marks the dense cells of a tile */
    const double *rho;
    double *part, above, hard;
    long count;
};

KERNEL static double bed_largest(int n, const double *restrict rho) {
    double most = 0;
    for (int i = 0; i < n; i++) most = larger(most, rho[i]);
    return most;
}

KERNEL static double bed_smallest(int n, const double *restrict rho) {
    double least = HUGE_VAL;
    for (int i = 0; i < n; i++) least = smaller(least, rho[i]);
    return least;
}

static void find_visit(void *finding, long offset, int n) {
    struct finding *f = finding;
    if (!(bed_largest(n, f->rho + offset) > f->above)) return;
    for (int i = 0; i < n; i++) {
        f->part[offset + i] = f->rho[offset + i] > f->hard ? BED_HARD : f->rho[offset + i] > f->above ? BED_DENSE : 0;
        f->count += f->rho[offset + i] > f->above;
    }
}

/* A tile whose background is dense is written out. */
long tiles_bed_find(struct gas *g, double above) {
    const struct forest *f = g->forest;
    long count = 0;
    for (int t = 0; t < f->ntiles; t++) {
        struct finding find = {g->U.block[t], g->dense->part[t], above, g->dense->hard, 0};
        if (g->tiles->bed->holds[t]) memset(find.part, 0, (size_t)f->size * sizeof(double));
        if (activity_has_background(g, t, &g->U) && g->U.block[t][0] > above) activity_unfold(g, t, &g->U);
        varied_visit(g, t, &g->U, find_visit, &find);
        g->tiles->bed->holds[t] = find.count > 0;
        count += find.count;
    }
    return count;
}

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

static void forget_rings(struct gas *g) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        double *part = g->dense->part[t];
        for (long i = 0; i < g->forest->size && g->tiles->bed->holds[t]; i++)
            part[i] = select_double(part[i] < BED_DENSE, 0, part[i]);
    }
}

/* Dilates the dense part by three rings of neighbours. */
static void find_rings(struct gas *g) {
    struct forest *f = g->forest;
    forget_rings(g);
    for (int level = BED_FROZEN; level >= BED_OUTER; level--) {
        forest_fill_layers(f, 1, 1, g->dense->part);
        for (int t = 0; t < f->ntiles; t++) {
            struct ringing r = {f, g->dense->part[t], g->dim, level, false};
            if (!g->tiles->bed->holds[t] && !beside_bed(g, t)) continue;
            runs_visit(f, &f->tile[t], 0, ring_visit, &r);
            g->tiles->bed->holds[t] = r.found;
        }
    }
    forest_fill_layers(f, 1, 1, g->dense->part);
}

struct rating { /* finds the rates of a tile */
    struct gas *g;
    const double *U, *part; /* part: NULL in tiles without a bed */
    double dt, thin;
    int tile;
    struct bed_rates most;
};

static void rate_visit(void *rating, long offset, int n) {
    struct rating *r = rating;
    const struct gas *g = r->g;
    const struct work *w = &g->tiles->work;
    double thin[BATCH] = {0}, flow[BATCH] = {0};
    primitives_of_row(g, r->U, offset, n);
    for (int k = 0; k < g->dim; k++) {
        const double inverse = 1 / g->forest->width[k], *u = w->velocity[k] + offset, *c = w->c + offset;
        for (int i = 0; i < n; i++) {
            flow[i] += fabs(u[i]) * inverse;
            thin[i] += (fabs(u[i]) + c[i]) * inverse;
        }
    }
    const struct bed_row row = {n,
                                r->tile,
                                offset,
                                r->U + offset,
                                w->eps + offset,
                                w->p + offset,
                                thin,
                                flow,
                                r->part ? r->part + offset : NULL};
    dense_rates(g, r->dt, r->thin, &row, &r->most);
}

/* No cell is left out as uniform in a step with a bed. */
void tiles_bed_parts(struct gas *g, double dt, double thin, struct bed_rates *mine) {
    const struct forest *f = g->forest;
    struct rating r = {.g = g, .dt = dt, .thin = thin};
    find_rings(g);
    for (int t = 0; t < f->ntiles; t++) {
        activity_unfold(g, t, &g->U);
        r.tile = t;
        r.U = g->U.block[t];
        r.part = g->tiles->bed->holds[t] ? g->dense->part[t] : NULL;
        runs_visit(f, &f->tile[t], 0, rate_visit, &r);
    }
    *mine = r.most;
}

struct inclusion { /* near vacuum that becomes dense */
    struct gas *g;
    const double *U;
    double *part, thin, rate;
    long found;
};

static void include_visit(void *inclusion, long offset, int n) {
    struct inclusion *c = inclusion;
    const struct work *w = &c->g->tiles->work;
    if (!(bed_smallest(n, c->U + offset) < c->thin)) return;
    primitives_of_row(c->g, c->U, offset, n);
    for (long i = offset; i < offset + n; i++) {
        double rate = 0;
        for (int k = 0; k < c->g->dim; k++) rate += (fabs(w->velocity[k][i]) + w->c[i]) / c->g->forest->width[k];
        if (c->part[i] >= BED_FROZEN || !(c->U[i] < c->thin) || !(rate > c->rate)) continue;
        c->part[i] = BED_DENSE;
        c->found++;
    }
}

long tiles_bed_include(struct gas *g, double thin, double rate) {
    const struct forest *f = g->forest;
    long count = 0;
    for (int t = 0; t < f->ntiles; t++) {
        struct inclusion c = {g, g->U.block[t], g->dense->part[t], thin, rate, 0};
        runs_visit(f, &f->tile[t], 0, include_visit, &c);
        g->tiles->bed->holds[t] |= c.found > 0;
        count += c.found;
    }
    return count;
}

/* ---- the lists ---- */

/* A block of the bed is what lies in so many rows of a tile along the last axis: it is what ranks are dealt. */
enum { BLOCK_ROWS = 8 };

static int blocks_of_tile(const struct gas *g, int tile) {
    return g->dim > 1 ? (g->forest->tile[tile].n[g->dim - 1] + BLOCK_ROWS - 1) / BLOCK_ROWS : 1;
}

/* A number over all ranks: no tile has as many rows as its memory has room for. */
static int block_number(const struct forest *f, int tile, int block) {
    const int room = (int)(f->size / f->stride[f->dim - 1]) / BLOCK_ROWS + 1;
    return f->tile[tile].id * room + block;
}

struct listing { /* counts or lists the cells of a tile */
    const struct gas *g;
    const double *part;
    double *number;                     /* numbers over all ranks, from 1 on, go here; NULL: cells are counted */
    struct seat *seat, *face;           /* [cells], then [ghosts]; [faces] */
    int tile, count, block, *block_end; /* block_end: the cells up to the end of each block; NULL: are not counted */
    double first;
};

static void list_visit(void *listing, long offset, int n) {
    struct listing *l = listing;
    const struct forest *f = l->g->forest;
    const long row = l->g->dim > 1 ? (offset - f->first) / f->stride[l->g->dim - 1] : 0;
    for (int i = 0; i < n; i++) {
        if (!(l->part[offset + i] > 0)) continue;
        if (l->number) l->number[offset + i] = l->first + l->count;
        if (l->seat) l->seat[l->count] = (struct seat){l->tile, offset + i};
        l->count++;
    }
    if (l->block_end) l->block_end[l->block + row / BLOCK_ROWS] = l->count;
}

static int count_cells(const struct gas *g, int *blocks) {
    const struct forest *f = g->forest;
    struct listing l = {.g = g};
    *blocks = 0;
    for (int t = 0; t < f->ntiles; t++) {
        if (!g->tiles->bed->holds[t]) continue;
        l.part = g->dense->part[t];
        runs_visit(f, &f->tile[t], 0, list_visit, &l);
        *blocks += blocks_of_tile(g, t);
    }
    return l.count;
}

static status make_seats(struct gas *g, long cells, long faces) {
    struct tiles_bed *b = g->tiles->bed;
    const long n = cells + 2 * faces; /* ghosts are as many as faces at most */
    if (n > b->room) {
        free(b->seat);
        free(b->outer);
        b->seat = NULL;
        b->outer = NULL;
        b->room = 0;
        TRY(allocate(&b->seat, n + n / 2, sizeof *b->seat, "the bed"));
        TRY(allocate(&b->outer, n + n / 2, sizeof *b->outer, "the bed"));
        b->room = n + n / 2;
    }
    b->face = b->seat + cells + faces;
    return OK;
}

/* Numbers the cells in line 0 of W from 1 on, ghosts too. */
static void number_cells(struct gas *g, double first) {
    const struct forest *f = g->forest;
    struct bed *bed = &g->dense->bed;
    struct listing l = {.g = g, .first = first, .block_end = bed->first + 1};
    bed->first[0] = 0;
    for (int t = 0; t < f->ntiles; t++) {
        const int blocks = blocks_of_tile(g, t);
        memset(g->W.block[t], 0, (size_t)f->size * sizeof(double));
        if (!g->tiles->bed->holds[t]) continue;
        for (int i = 0; i < blocks; i++) bed->number[l.block + i] = block_number(f, t, i);
        l.part = g->dense->part[t];
        l.number = g->W.block[t];
        runs_visit(f, &f->tile[t], 0, list_visit, &l);
        l.block += blocks;
    }
    forest_fill_layers(g->forest, 1, 1, g->W.block);
}

static void seat_cells(struct gas *g, struct seat *seat) {
    struct listing l = {.g = g, .seat = seat};
    for (l.tile = 0; l.tile < g->forest->ntiles; l.tile++) {
        l.part = g->dense->part[l.tile];
        if (g->tiles->bed->holds[l.tile]) runs_visit(g->forest, &g->forest->tile[l.tile], 0, list_visit, &l);
    }
}

/* The patch beyond the face of a cell at `at` along an axis; -1: there is none. */
static int patch_beyond(const struct gas *g, struct seat s, int axis, bool above) {
    const struct tile *t = &g->forest->tile[s.tile];
    const struct forest *f = g->forest;
    long rest = s.at - f->first;
    int place = 0;
    for (int k = 2; k >= axis; k--) {
        if (k >= g->dim) continue;
        place = (int)(rest / f->stride[k]);
        rest -= place * f->stride[k];
    }
    return place == (above ? t->n[axis] - 1 : 0) ? t->side[2 * axis + above].patch : -1;
}

struct weaving { /* faces and ghosts being listed */
    struct gas *g;
    double first; /* number of this rank's first cell */
};

/* The bed's index of the neighbour of cell i: a cell, a ghost that is made, or -1; beyond patches numbers are 0. */
static int neighbour_of(struct weaving *w, int i, int axis, bool above) {
    struct bed *bed = &w->g->dense->bed;
    const struct seat s = w->g->tiles->bed->seat[i];
    const long at = s.at + (above ? 1 : -1) * w->g->forest->stride[axis];
    const double number = w->g->W.block[s.tile][at];
    if (number == 0) return -1;
    if (number >= w->first && number < w->first + bed->cells) return (int)(number - w->first);
    w->g->tiles->bed->seat[bed->cells + bed->ghosts] = (struct seat){s.tile, at};
    return bed->cells + bed->ghosts++;
}

static int kind_of(const struct gas *g, struct seat s, int axis, bool above, int neighbour) {
    if (neighbour >= 0) return BED_INNER;
    const int patch = patch_beyond(g, s, axis, above);
    if (patch < 0) return BED_KEPT;
    return patch_is_wall(&g->patches.rules[patch]) ? BED_WALL : BED_HELD;
}

/* The place of a cell's lower or upper face along an axis in the list of the cells' faces. */
static int side_entry(const struct bed *bed, int cell, int axis, bool above) {
    return 2 * (bed->dim * cell + axis) + above;
}

static void add_face(struct weaving *w, int i, int axis, bool above, int neighbour) {
    struct bed *bed = &w->g->dense->bed;
    const struct seat s = w->g->tiles->bed->seat[i];
    const int f = bed->faces++;
    bed->left[f] = above ? i : neighbour;
    bed->right[f] = above ? neighbour : i;
    bed->kind[f] = (unsigned char)kind_of(w->g, s, axis, above, neighbour);
    if (bed->kind[f] != BED_INNER) w->g->tiles->bed->outer[w->g->tiles->bed->outers++] = f;
    bed->shape[f] = axis;
    bed->face_of_cell[side_entry(bed, i, axis, above)] = above ? f : ~f;
    if (neighbour >= 0 && neighbour < bed->cells) bed->face_of_cell[side_entry(bed, neighbour, axis, false)] = ~f;
    w->g->tiles->bed->face[f] = (struct seat){s.tile, above ? s.at : s.at - w->g->forest->stride[axis]};
}

/* Makes the face above each cell, and that below where no cell of this rank makes it. */
static void weave(struct weaving *w) {
    struct bed *bed = &w->g->dense->bed;
    bed->ghosts = bed->faces = w->g->tiles->bed->outers = 0;
    for (int k = 0; k < bed->dim; k++)
        for (int i = 0; i < bed->cells; i++) {
            add_face(w, i, k, true, neighbour_of(w, i, k, true));
            const int below = neighbour_of(w, i, k, false);
            if (below < 0 || below >= bed->cells) add_face(w, i, k, false, below);
        }
}

static status make_fluxes(struct gas *g) {
    const long doubles = (long)g->dim * g->nvar * g->forest->size + SLACK;
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->tiles->bed->holds[t] && !g->tiles->bed->fluxes[t])
            TRY(allocate(&g->tiles->bed->fluxes[t], doubles, sizeof(double), "the bed"));
    return OK;
}

static status list_here(struct gas *g) {
    struct bed *bed = &g->dense->bed;
    int blocks;
    const int cells = count_cells(g, &blocks);
    const long faces = (long)g->dim * cells * 2;
    TRY(make_fluxes(g));
    TRY(make_seats(g, cells, faces));
    return bed_size(bed, blocks, cells, (int)faces, (int)faces, (int)faces);
}

struct moving { /* looks for cells that the stages move */
    const double *part;
    bool any;
};

static void moving_visit(void *moving, long offset, int n) {
    struct moving *m = moving;
    for (int i = 0; i < n; i++) m->any |= m->part[offset + i] == 0;
}

/* Is the bed that of the last list, on all ranks? Else its parts are noted. Finds also whether any cell moves in the
 * stages. */
static bool is_listed(struct gas *g) {
    const size_t bytes = (size_t)g->forest->size * sizeof(double);
    double changes[2] = {0, 0};
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct moving m = {g->dense->part[t], false};
        if (memcmp(g->tiles->bed->listed[t], g->dense->part[t], bytes) != 0) changes[0] = 1;
        memcpy(g->tiles->bed->listed[t], g->dense->part[t], bytes);
        if (g->tiles->bed->holds[t]) runs_visit(g->forest, &g->forest->tile[t], 0, moving_visit, &m);
        if (m.any || !g->tiles->bed->holds[t]) changes[1] = 1;
    }
    comm_max(g->comm, changes, 2);
    g->dense->alone = changes[1] == 0;
    return changes[0] == 0 && g->dense->bed.kind;
}

/* What needs other ranks comes first: a rank with more of the bed has more to list, and less to do in the stages. */
status tiles_bed_list(struct gas *g, const struct state *from) {
    struct bed *bed = &g->dense->bed;
    const struct seat *seat;
    long first;
    forest_fill_layers(g->forest, 1, g->nvar, from->block);
    if (is_listed(g)) return OK;
    TRY(comm_agree(g->comm, list_here(g)));
    TRY(bed_number(bed, bed->cells, &first));
    struct weaving w = {.g = g, .first = (double)first + 1};
    number_cells(g, w.first);
    TRY(bed_meet(bed));
    seat_cells(g, g->tiles->bed->seat);
    weave(&w);
    for (int i = 0; i <= bed->cells; i++) bed->face_start[i] = 2 * bed->dim * i;
    for (int i = 0; i < bed->cells + bed->ghosts; i++) bed->body[i] = 0;
    seat = g->tiles->bed->seat + bed->cells;
    for (int i = 0; i < bed->ghosts; i++) bed->U[0][bed->cells + i] = g->W.block[seat[i].tile][seat[i].at] - 1;
    bed_link(bed, bed->U[0] + bed->cells);
    return OK;
}

/* ---- to and from the tiles ---- */

/* An open patch whose ghosts have the cell's own state lets it out freely. */
static bool same_state(const struct gas *g, const double *U, long a, long b) {
    for (int v = 0; v < g->nvar; v++)
        if (bits_of(U[v * g->forest->size + a]) != bits_of(U[v * g->forest->size + b])) return false;
    return true;
}

static void take_beyond(struct gas *g, const struct state *from) {
    struct bed *bed = &g->dense->bed;
    const struct seat *seat = g->tiles->bed->face;
    for (int i = 0; i < g->tiles->bed->outers; i++) {
        const int f = g->tiles->bed->outer[i];
        const double *U = from->block[seat[f].tile];
        const long below = seat[f].at, above = below + g->forest->stride[bed->shape[f]];
        if (bed->kind[f] == BED_WALL) continue;
        if (bed->kind[f] != BED_KEPT) bed->kind[f] = same_state(g, U, below, above) ? BED_FREE : BED_HELD;
        for (int v = 0; v < g->nvar; v++) {
            bed->outside[v][f] = U[v * g->forest->size + (bed->left[f] < 0 ? below : above)];
            bed->kept[v][f] = 0;
        }
    }
}

/* Returns how many cells of the bed, from `cell` on, lie side by side in a row: at most BATCH. */
static int run_from(const struct gas *g, int cell) {
    const struct seat *seat = g->tiles->bed->seat + cell;
    const int most = g->dense->bed.cells - cell < BATCH ? g->dense->bed.cells - cell : BATCH;
    int n = 1;
    while (n < most && seat[n].tile == seat[0].tile && seat[n].at == seat[0].at + n) n++;
    return n;
}

void tiles_bed_take(struct gas *g, const struct state *from, bool again) {
    const struct forest *f = g->forest;
    struct bed *bed = &g->dense->bed;
    struct state *const scratch[] = {&g->V, &g->W};
    for (int t = 0; t < f->ntiles && !again; t++)
        if (g->tiles->bed->holds[t]) ghosts_of_patches(g, t, from->block[t], GHOSTS, NULL);
    for (int i = 0, n; i < bed->cells; i += n) {
        const struct seat seat = g->tiles->bed->seat[i];
        const size_t bytes = (size_t)(n = run_from(g, i)) * sizeof(double);
        for (int v = 0; v < g->nvar; v++) {
            const double *U = from->block[seat.tile] + v * f->size + seat.at;
            memcpy(bed->U[v] + i, U, bytes);
            for (int s = 0; s < 2 && !again; s++)
                memcpy(scratch[s]->block[seat.tile] + v * f->size + seat.at, U, bytes);
        }
    }
    if (!again) take_beyond(g, from);
}

void tiles_note_fluxes(struct gas *g, const struct strip *s, double (*out)[BATCH], int column) {
    double *to = g->tiles->bed->fluxes[s->tile] + (long)s->axis * g->nvar * g->forest->size + s->offset;
    for (int v = 0; v < g->nvar; v++) memcpy(to + v * g->forest->size, out[v] + column, (size_t)s->n * sizeof(double));
}

void tiles_bed_keep(struct gas *g, double weight) {
    struct bed *bed = &g->dense->bed;
    const struct seat *seat = g->tiles->bed->face;
    for (int i = 0; i < g->tiles->bed->outers; i++) {
        const int f = g->tiles->bed->outer[i];
        if (bed->kind[f] != BED_KEPT) continue;
        const long line = (long)bed->shape[f] * g->nvar;
        const double *from = g->tiles->bed->fluxes[seat[f].tile] + line * g->forest->size + seat[f].at;
        for (int v = 0; v < g->nvar; v++) bed->kept[v][f] += weight * from[v * g->forest->size];
    }
}

long tiles_bed_put(struct gas *g, const struct state *to) {
    const struct bed *bed = &g->dense->bed;
    long bad = 0;
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->tiles->bed->holds[t]) activity_unfold(g, t, to);
    for (int i = 0, n; i < bed->cells; i += n) {
        const struct seat seat = g->tiles->bed->seat[i];
        double *U = to->block[seat.tile] + seat.at;
        n = run_from(g, i);
        for (int v = 0; v < g->nvar; v++) memcpy(U + v * g->forest->size, bed->U[v] + i, (size_t)n * sizeof(double));
        bad += row_inadmissible(g, to->block[seat.tile], seat.at, n, NULL);
    }
    return bad;
}

void tiles_tally_bed(struct gas *g, double dt) {
    const struct bed *bed = &g->dense->bed;
    const struct seat *seat = g->tiles->bed->face;
    for (int i = 0; i < g->tiles->bed->outers; i++) {
        const int f = g->tiles->bed->outer[i], axis = bed->shape[f];
        const bool high = bed->left[f] >= 0;
        double flux[MAX_VAR];
        if (bed->kind[f] == BED_KEPT) continue;
        const long inner = high ? seat[f].at : seat[f].at + g->forest->stride[axis];
        const int to = tiles_tally_place(g, seat[f].tile, 2 * axis + high, inner);
        bed_face_flux(bed, f, flux);
        for (int v = 0; v < g->nvar; v++) g->tally->flow[v][to] = high ? dt * flux[v] : -dt * flux[v];
    }
}

long tiles_bed_seat(const struct gas *g, int cell, int *tile) {
    const struct seat seat = g->tiles->bed->seat[cell];
    *tile = seat.tile;
    return seat.at;
}

void tiles_bed_spread(struct gas *g, const double *per_block, double *raised) {
    int block = 0;
    for (int t = 0; t < g->forest->ntiles; t++) {
        raised[t] = 0;
        if (!g->tiles->bed->holds[t]) continue;
        for (int i = blocks_of_tile(g, t); i > 0; i--) raised[t] += per_block[block++];
    }
}

/* ---- in the stages ---- */

bool tiles_hold_bed(const struct gas *g, int tile) {
    return g->step.hybrid && g->tiles->bed->holds[tile];
}

struct span tiles_moving_span(const struct gas *g, int tile, long row, int n) {
    const double *part = g->dense->part[tile] + row;
    struct span s = {0, n};
    while (s.low < n && part[s.low] >= BED_FROZEN) s.low++;
    while (s.high > s.low && part[s.high - 1] >= BED_FROZEN) s.high--;
    return span_empty(s) ? SPAN_EMPTY : s;
}
