/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas by the blocks of the grid, which do not depend on the number of ranks: sets and gets the state, gets fields,
 * sums over the domain. The engine says where the cells of a block are (state_hooks.cells). */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

struct block_batch { /* n <= BATCH cells of a block of the grid, from its cell `from` on */
    int block;       /* of the state */
    int from, n;
    const int *at;    /* [n] places in the lines of the state's block; NULL: from `first` on, `step` apart */
    long first, step; /* both 0: the cells are the background */
};
static inline long place_of(const struct block_batch *b, int i) {
    return b->at ? b->at[i] : b->first + i * b->step;
}
typedef void batch_visitor(void *context, const struct block_batch *batch);

/* Visits n cells of a row, behind those that were visited. */
static void visit_run(struct block_batch *b, int n, batch_visitor *visit, void *context) {
    for (; n > 0; n -= b->n) {
        b->n = n < BATCH ? n : BATCH;
        visit(context, b);
        b->from += b->n;
        if (b->at)
            b->at += b->n;
        else
            b->first += b->n * b->step;
    }
}

/* The cells of row (j, k) of a block that are not the background: all or none between images of one cell. */
static struct span span_of_row(const struct block_cells *c, int j, int k) {
    const struct span s = c->varied[j * c->row[0] + k * c->row[1]];
    return s.low >= s.high ? (struct span){0, 0} : c->step[0] ? s : (struct span){0, c->n[0]};
}

/* Visits the cells of a block of the grid in its order; those of s outside of its spans as the background (s NULL: all
 * by themselves). */
static void visit_block(const struct gas *g, int block, const struct state *s, batch_visitor *visit, void *context) {
    struct block_cells c;
    g->engine->state.cells(g, block, s, &c);
    struct block_batch b = {.block = c.block, .at = c.at};
    for (int k = 0; k < c.n[2]; k++)
        for (int j = 0; j < c.n[1]; j++) {
            struct span own = {0, c.n[0]};
            if (c.varied) own = span_of_row(&c, j, k);
            b.first = b.step = 0;
            visit_run(&b, own.low, visit, context);
            b.step = c.step[0];
            b.first = c.first + own.low * c.step[0] + j * c.step[1] + k * c.step[2];
            visit_run(&b, own.high - own.low, visit, context);
            b.first = b.step = 0;
            visit_run(&b, c.n[0] - own.high, visit, context);
        }
}

int grid_blocks(const struct gas *g) {
    return g->forest ? g->forest->nblocks : g->blocks.grid->nblocks;
}

/* Returns the polyMesh's numbers of the cells of a block, and how many they are. */
static const int *mesh_cells(const struct gas *g, int block, int *n) {
    if (!g->forest) {
        *n = g->blocks.grid->block[block].ncells;
        return g->blocks.grid->block[block].cell;
    }
    const struct forest_block *b = &g->forest->block[block];
    *n = b->n[0] * b->n[1] * b->n[2];
    return b->cell;
}

static long cells_of_rank(const struct gas *g) {
    long cells = 0;
    for (int b = 0, n; b < grid_blocks(g); b++) {
        (void)mesh_cells(g, b, &n);
        cells += n;
    }
    return cells;
}

/* ---- values in and out ---- */

struct block_lines { /* n lines of blocks, from `first` on, and their values */
    double *const *block;
    long size;
    int first, n;
    const int *cell; /* where `in` has the values of the block's cells; NULL: one behind the other, from `next` on */
    long next;
    const double *const *in;
    double *const *out;
};

static void put_batch(void *lines, const struct block_batch *b) {
    const struct block_lines *l = lines;
    for (int v = 0; v < l->n; v++) {
        double *line = l->block[b->block] + (l->first + v) * l->size;
        for (int i = 0; i < b->n; i++)
            line[place_of(b, i)] = l->in[v][l->cell ? l->cell[b->from + i] : l->next + b->from + i];
    }
}

static void take_batch(void *lines, const struct block_batch *b) {
    const struct block_lines *l = lines;
    for (int v = 0; v < l->n; v++) {
        const double *line = l->block[b->block] + (l->first + v) * l->size;
        for (int i = 0; i < b->n; i++) l->out[v][b->from + i] = line[place_of(b, i)];
    }
}

/* Sets lines of blocks, which `l` names, from arrays of this rank's cells (own), or from arrays in polyMesh order. */
static void put_lines(const struct gas *g, bool own, struct block_lines l) {
    l.size = g->size;
    for (int b = 0, cells; b < grid_blocks(g); b++, l.next += cells) {
        const int *cell = mesh_cells(g, b, &cells);
        l.cell = own ? NULL : cell;
        visit_block(g, b, NULL, put_batch, &l);
    }
}

void state_set(struct gas *g, bool own, const double *const U[MAX_VAR]) {
    spans_unfold(g, &g->U, NULL);
    put_lines(g, own, (struct block_lines){.block = g->U.block, .n = g->nvar, .in = U});
}

void limited_set(struct gas *g, const double *values) {
    put_lines(g, true, (struct block_lines){.block = g->limits.flags.limited, .n = 1, .in = &values});
}

void gas_block_variables(const struct gas *g, int block, int first, int n, double *const *out) {
    struct block_lines l = {.block = g->U.block, .size = g->size, .first = first, .n = n, .out = out};
    visit_block(g, block, &g->U, take_batch, &l);
}

void gas_set_carried(struct gas *g, int q, bool own, const double *values) {
    put_lines(g, own, (struct block_lines){.block = g->carried->quantity[q].phi, .n = 1, .in = &values});
}

void gas_block_carried(const struct gas *g, int block, int q, double *out) {
    struct block_lines l = {.block = g->carried->quantity[q].phi, .size = g->size, .n = 1, .out = &out};
    visit_block(g, block, NULL, take_batch, &l);
}

int gas_friction_sides(const struct gas *g) {
    return g->dense && g->dense->kept ? g->dense->sides : 0;
}

void gas_set_friction(struct gas *g, int first, int n, const double *const *values) {
    put_lines(g, true, (struct block_lines){.block = g->dense->kept, .first = first, .n = n, .in = values});
}

void gas_block_friction(const struct gas *g, int block, int first, int n, double *const *out) {
    struct block_lines l = {.block = g->dense->kept, .size = g->size, .first = first, .n = n, .out = out};
    visit_block(g, block, NULL, take_batch, &l);
}

struct reading { /* of a field */
    const struct gas *g;
    enum gas_field field;
    int components;
    double *const *out;
    bool known; /* is the value of the background known? */
    double background[3];
};

static void read_background(struct reading *r, const struct block_batch *b) {
    const struct gas *g = r->g;
    double *value[3] = {&r->background[0], &r->background[1], &r->background[2]};
    if (!r->known) field_row(g, r->field, 1, g->size, g->U.block[b->block], value);
    r->known = true;
    for (int k = 0; k < r->components; k++)
        for (int i = 0; i < b->n; i++) r->out[k][b->from + i] = r->background[k];
}

static void read_batch(void *reading, const struct block_batch *b) {
    struct reading *r = reading;
    const struct gas *g = r->g;
    double U[MAX_VAR][BATCH], *out[3] = {NULL, NULL, NULL};
    for (int k = 0; k < r->components; k++) out[k] = r->out[k] + b->from;
    if (!b->at && !b->first) {
        read_background(r, b);
        return;
    }
    if (!b->at && b->step == 1) { /* the cells lie one behind the other: no copy */
        field_row(g, r->field, b->n, g->size, g->U.block[b->block] + b->first, out);
        return;
    }
    for (int v = 0; v < g->nvar; v++) {
        for (int i = 0; i < b->n; i++) U[v][i] = g->U.block[b->block][v * g->size + place_of(b, i)];
        for (int i = b->n; i < BATCH; i++) U[v][i] = 0;
    }
    field_row(g, r->field, b->n, BATCH, U[0], out);
}

void gas_block_field(const struct gas *g, int block, enum gas_field field, double *const out[3]) {
    struct block_lines limited = {.block = g->limits.flags.limited, .size = g->size, .n = 1, .out = out};
    struct reading r = {.g = g, .field = field, .components = field == GAS_U ? g->components : 1, .out = out};
    if (field == GAS_LIMITED)
        visit_block(g, block, NULL, take_batch, &limited);
    else
        visit_block(g, block, &g->U, read_batch, &r);
}

bool gas_block_uniform(const struct gas *g, int block, enum gas_field field, double value[3]) {
    struct block_cells c;
    g->engine->state.cells(g, block, &g->U, &c);
    if (field == GAS_LIMITED || !c.varied) return false;
    for (int k = 0; k < c.n[2] && !g->U.calm[c.block]; k++)
        for (int j = 0; j < c.n[1]; j++)
            if (span_of_row(&c, j, k).high > 0) return false;
    field_row(g, field, 1, g->size, g->U.block[c.block], (double *[]){value, value + 1, value + 2});
    return true;
}

/* Gathers values of this rank's cells in the root's array, in polyMesh order. */
static status gather(const struct gas *g, const double *values, double *all) {
    return g->forest ? forest_gather(g->forest, values, all) : grid_gather(g->blocks.grid, values, all);
}

/* Gathers a conserved variable or, if it is less than 0, carried quantity ~variable. */
static status gather_line(const struct gas *g, int variable, double *all) {
    double *values, *next;
    TRY(comm_agree(g->comm, allocate(&values, cells_of_rank(g), sizeof *values, "the cells of this rank")));
    next = values;
    for (int b = 0, cells; b < grid_blocks(g); b++, next += cells) {
        (void)mesh_cells(g, b, &cells);
        if (variable < 0)
            gas_block_carried(g, b, ~variable, next);
        else
            gas_block_variables(g, b, variable, 1, &next);
    }
    const status s = gather(g, values, all);
    free(values);
    return s;
}

status gas_get_variables(const struct gas *g, int first, int n, double *const *out) {
    for (int v = 0; v < n; v++) TRY(gather_line(g, first + v, comm_root(g->comm) ? out[v] : NULL));
    return OK;
}

status gas_get_carried(const struct gas *g, int q, double *out) {
    return gather_line(g, ~q, comm_root(g->comm) ? out : NULL);
}

status gas_field(const struct gas *g, enum gas_field field, double *const out[3]) {
    const int components = field == GAS_U ? g->components : 1;
    const long cells = cells_of_rank(g);
    double *values;
    TRY(comm_agree(g->comm, allocate(&values, cells * components, sizeof *values, "a field")));
    double *at[3] = {values, values + cells, values + 2 * cells};
    for (int b = 0, n; b < grid_blocks(g); b++) {
        (void)mesh_cells(g, b, &n);
        gas_block_field(g, b, field, at);
        for (int k = 0; k < components; k++) at[k] += n;
    }
    status s = OK;
    for (int k = 0; k < components && !s; k++) s = gather(g, values + k * cells, comm_root(g->comm) ? out[k] : NULL);
    free(values);
    return s;
}

/* ---- sums ---- */

status sum_blocks(const struct gas *g, const double *per_block, double *sum) {
    return g->forest ? forest_sum(g->forest, per_block, sum) : grid_sum(g->blocks.grid, per_block, sum);
}

struct summing {
    const struct gas *g;
    const struct state *s;
    int n;     /* lines */
    int block; /* of the grid */
    double sum[MAX_VAR];
};

/* Adds all lines at once, in registers, as each addition waits for the one before. Cells that have their values in
 * common are added one by one, so that uniform axes change no bit. Sums beyond the n lines repeat the first. */
static void sum_batch(void *summing, const struct block_batch *b) {
    struct summing *x = summing;
    const double *line[MAX_VAR], *volume = x->g->blocks.volume;
    const struct forest *f = x->g->forest;
    double sum[MAX_VAR];
    memcpy(sum, x->sum, sizeof sum);
    for (int v = 0; v < MAX_VAR; v++) line[v] = x->s->block[b->block] + (v < x->n ? v : 0) * x->g->size + b->first;
    if (volume)
        for (int i = 0; i < b->n; i++)
            for (int v = 0; v < MAX_VAR; v++) sum[v] += volume[b->at[i]] * line[v][b->at[i]];
    else if (f->radial >= 0)
        for (int i = 0; i < b->n; i++) {
            const double radius = forest_block_radius(f, &f->block[x->block], b->from + i);
            for (int v = 0; v < MAX_VAR; v++) sum[v] += radius * line[v][i * b->step];
        }
    else
        for (int i = 0; i < b->n; i++)
            for (int v = 0; v < MAX_VAR; v++) sum[v] += line[v][i * b->step];
    memcpy(x->sum, sum, sizeof sum);
}

/* Sums n lines of blocks, times volume, over the domain. */
static status integrate(const struct gas *g, const struct state *s, int n, double *total) {
    const int blocks = grid_blocks(g);
    for (int b = 0; b < blocks; b++) {
        struct summing x = {.g = g, .s = s, .n = n, .block = b};
        visit_block(g, b, s, sum_batch, &x);
        for (int v = 0; v < n; v++) g->blocks.sums[v * blocks + b] = x.sum[v];
    }
    for (int v = 0; v < n; v++) {
        TRY(sum_blocks(g, g->blocks.sums + v * blocks, &total[v]));
        total[v] *= g->blocks.unit;
    }
    return OK;
}

status state_totals(const struct gas *g, const struct state *s, double totals[MAX_VAR]) {
    return integrate(g, s, g->nvar, totals);
}

status gas_totals(const struct gas *g, double totals[MAX_VAR]) {
    return state_totals(g, &g->U, totals);
}

/* Sums a number of each block of the state, which the images of its cells have, too. */
static status sum_of_tiles(const struct gas *g, const double *raised, double *sum) {
    for (int b = 0; b < grid_blocks(g); b++) {
        struct block_cells c;
        double images = 1;
        g->engine->state.cells(g, b, NULL, &c);
        for (int k = 0; k < 3; k++) images *= c.step[k] ? 1 : c.n[k];
        g->blocks.sums[b] = raised[c.block] * images;
    }
    TRY(sum_blocks(g, g->blocks.sums, sum));
    *sum *= g->blocks.unit;
    return OK;
}

status sum_raised(const struct gas *g, double *raised, double *sum) {
    return g->floors.step ? integrate(g, &(struct state){.block = &raised}, 1, sum) : sum_of_tiles(g, raised, sum);
}
