/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bed of implicit acoustics on polyhedra: which cells it holds, their lists, and what goes to and from the cells.
 */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

/* A cell's centre counts as so far from a face, at least, as a part of its distance from the face's centre. */
static const double SKEWEST = 0.05;

struct cells_bed {
    struct bed_shapes shapes; /* of the mesh: each face and each cell has a shape of its own */
    double *memory;           /* of the arms and depths */
    double *listed;           /* [ncells] the parts for which the bed was listed */
    int *index;               /* [ncells] the bed's cell or ghost; -1: of the rest */
    int *face;                /* [faces] the bed's face; -1: none */
    int *seat;                /* [ncells] the cells of the bed, then its ghosts */
};

/* A mirror's centre is the cell's, reflected in the plane of the face. */
static void measure_face(const struct polyhedra *m, struct bed_shapes *s, int f) {
    double to[2][MAX_DIM], across = 0;
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < m->dim; k++) to[side][k] = cells_arm(m, f, side, k);
    for (int k = 0; k < m->dim; k++) across += to[0][k] * m->face.normal[k][f];
    for (int k = 0; k < m->dim && f >= m->face.ninternal; k++) to[1][k] = to[0][k] - 2 * across * m->face.normal[k][f];
    for (int side = 0; side < 2; side++) {
        double depth = 0, square = 0;
        for (int k = 0; k < m->dim; k++) {
            depth += (side ? -1 : 1) * to[side][k] * m->face.normal[k][f];
            square += to[side][k] * to[side][k];
            s->arm[side][k][f] = to[side][k];
        }
        s->depth[side][f] = larger(depth, SKEWEST * sqrt(square));
    }
}

static status make_shapes(struct gas *g, struct cells_bed *b) {
    const struct polyhedra *m = g->cells->polyhedra;
    const long faces = m->face.n;
    struct bed_shapes *s = &b->shapes;
    TRY(allocate(&b->memory, 2 * (g->dim + 1) * faces, sizeof(double), "the bed"));
    *s = (struct bed_shapes){.volume = m->volume, .area = m->face.area};
    for (int k = 0; k < g->dim; k++) s->normal[k] = m->face.normal[k];
    for (int side = 0; side < 2; side++) {
        s->depth[side] = b->memory + side * (g->dim + 1) * faces;
        for (int k = 0; k < g->dim; k++) s->arm[side][k] = s->depth[side] + (k + 1) * faces;
    }
    for (int f = 0; f < m->face.n; f++) measure_face(m, s, f);
    g->dense->bed.shapes = s;
    return OK;
}

status cells_bed_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_bed *b;
    TRY(allocate(&b, 1, sizeof *b, "the bed"));
    g->cells->bed = b;
    TRY(allocate(&g->dense->part, 1, sizeof(double *), "the bed"));
    TRY(allocate(&g->dense->part[0], m->size, sizeof(double), "the bed"));
    TRY(allocate(&b->listed, m->ncells, sizeof(double), "the bed"));
    int **lists[] = {&b->index, &b->seat};
    for (int i = 0; i < 2; i++) TRY(allocate(lists[i], m->ncells, sizeof(int), "the bed"));
    TRY(allocate(&b->face, m->face.n, sizeof(int), "the bed"));
    return make_shapes(g, b);
}

void cells_bed_free(struct gas *g) {
    struct cells_bed *b = g->cells ? g->cells->bed : NULL;
    if (g->dense->part) free(g->dense->part[0]);
    free(g->dense->part);
    if (!b) return;
    free(b->memory);
    free(b->listed);
    free(b->index);
    free(b->face);
    free(b->seat);
    free(b);
}

/* ---- the parts ---- */

long cells_bed_find(struct gas *g, double above) {
    const double *rho = g->U.block[0];
    double *part = g->dense->part[0];
    long count = 0;
    for (int i = 0; i < g->cells->polyhedra->nown; i++) {
        part[i] = rho[i] > g->dense->hard ? BED_HARD : rho[i] > above ? BED_DENSE : 0;
        count += rho[i] > above;
    }
    return count;
}

static void fill_lines(struct gas *g, int n, double *const *line) {
    polyhedra_fill_start(g->cells->polyhedra, n, line);
    polyhedra_fill_finish(g->cells->polyhedra);
}

/* Dilates the dense part by three rings of neighbours. Mirrors belong to no part. */
static void find_rings(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *part = g->dense->part[0];
    for (int i = 0; i < m->nown; i++) part[i] = part[i] < BED_DENSE ? 0 : part[i];
    for (int level = BED_FROZEN; level >= BED_OUTER; level--) {
        const double least = level == BED_FROZEN ? BED_DENSE : level;
        fill_lines(g, 1, g->dense->part);
        for (int i = 0; i < m->nown; i++) {
            if (part[i] > 0) continue;
            for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++)
                if (part[cells_across(m, j)] > least) part[i] = level;
        }
    }
    fill_lines(g, 1, g->dense->part);
}

/* flow = sum_k |u_k| girth_k, thin = flow + c total_girth (cells.c: rate_line) of n cells */
static void find_rates(const struct gas *g, int at, int n, struct cells_primitives *q, double *flow, double *thin) {
    const struct cells *c = g->cells;
    cells_primitives(g, n, g->U.block[0] + at, q);
    for (int i = 0; i < n; i++) {
        flow[i] = 0;
        for (int k = 0; k < g->dim; k++) flow[i] += fabs(q->velocity[k][i]) * c->girth[k][at + i];
        thin[i] = flow[i] + q->c[i] * c->total_girth[at + i];
    }
}

void cells_bed_parts(struct gas *g, double dt, double thin, struct bed_rates *mine) {
    const int nown = g->cells->polyhedra->nown;
    find_rings(g);
    *mine = (struct bed_rates){0};
    for (int at = 0, n; at < nown; at += n) {
        struct cells_primitives q;
        double flow[BATCH], fast[BATCH];
        n = nown - at < BATCH ? nown - at : BATCH;
        find_rates(g, at, n, &q, flow, fast);
        dense_rates(g, dt, thin,
                    &(struct bed_row){n, 0, at, g->U.block[0] + at, q.eps, q.p, fast, flow, g->dense->part[0] + at},
                    mine);
    }
}

long cells_bed_include(struct gas *g, double thin, double rate) {
    const int nown = g->cells->polyhedra->nown;
    const double *rho = g->U.block[0];
    double *part = g->dense->part[0];
    long count = 0;
    for (int at = 0, n; at < nown; at += n) {
        struct cells_primitives q;
        double flow[BATCH], fast[BATCH];
        n = nown - at < BATCH ? nown - at : BATCH;
        find_rates(g, at, n, &q, flow, fast);
        for (int i = at; i < at + n; i++) {
            if (!(part[i] < BED_FROZEN && rho[i] < thin && fast[i - at] > rate)) continue;
            part[i] = BED_DENSE;
            count++;
        }
    }
    return count;
}

/* ---- the lists ---- */

/* Is the bed that of the last list, on all ranks? Else its parts are noted. Finds also whether any cell moves in the
 * stages. */
static bool is_listed(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *part = g->dense->part[0];
    double changes[2] = {0, 0}, *listed = g->cells->bed->listed;
    for (int i = 0; i < m->ncells; i++) {
        if (listed[i] != part[i]) changes[0] = 1;
        if (i < m->nown && part[i] == 0) changes[1] = 1;
        listed[i] = part[i];
    }
    comm_max(g->comm, changes, 2);
    g->dense->alone = changes[1] == 0;
    return changes[0] == 0 && g->dense->bed.kind;
}

static status make_room(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *part = g->dense->part[0];
    int cells = 0, ghosts = 0, sides = 0;
    for (int i = 0; i < m->nnear; i++) {
        if (!(part[i] > 0)) continue;
        *(i < m->nown ? &cells : &ghosts) += 1;
        if (i < m->nown) sides += m->face_start[i + 1] - m->face_start[i];
    }
    return bed_size(&g->dense->bed, m->nblocks, cells, ghosts, sides, sides);
}

/* Lists the cells block by block, then the ghosts across their faces. */
static void seat_cells(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_bed *b = g->cells->bed;
    struct bed *bed = &g->dense->bed;
    const double *part = g->dense->part[0];
    int n = 0;
    for (int block = 0; block < m->nblocks; block++) {
        bed->first[block] = n;
        bed->number[block] = m->block_id[block];
        for (int j = m->block_start[block]; j < m->block_start[block + 1]; j++)
            if (part[m->block_cell[j]] > 0) b->seat[n++] = m->block_cell[j];
    }
    bed->first[m->nblocks] = n;
    for (int i = 0; i < m->ncells; i++) b->index[i] = -1;
    for (int i = 0; i < n; i++) b->index[b->seat[i]] = i;
    for (int i = 0; i < bed->cells; i++)
        for (int j = m->face_start[b->seat[i]]; j < m->face_start[b->seat[i] + 1]; j++) {
            const int other = cells_across(m, j);
            if (other < m->nown || other >= m->nnear || !(part[other] > 0) || b->index[other] >= 0) continue;
            b->index[other] = n;
            b->seat[n++] = other;
        }
    bed->ghosts = n - bed->cells;
    for (int i = 0; i < n; i++) bed->body[i] = b->seat[i];
}

static int kind_of(const struct gas *g, int face, int left, int right) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    if (face < f->ninternal) return left < 0 || right < 0 ? BED_KEPT : BED_INNER;
    return patch_is_wall(&g->patches.rules[f->patch[face - f->ninternal]]) ? BED_WALL : BED_HELD;
}

/* Returns the bed's face for a face of the mesh, which is made. */
static int list_face(struct gas *g, int face) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct cells_bed *b = g->cells->bed;
    struct bed *bed = &g->dense->bed;
    if (b->face[face] >= 0) return b->face[face];
    const int at = b->face[face] = bed->faces++;
    bed->shape[at] = face;
    bed->left[at] = b->index[f->left[face]];
    bed->right[at] = face < f->ninternal ? b->index[f->right[face]] : -1;
    bed->kind[at] = (unsigned char)kind_of(g, face, bed->left[at], bed->right[at]);
    return at;
}

static void list_faces(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_bed *b = g->cells->bed;
    struct bed *bed = &g->dense->bed;
    int entry = 0;
    for (int i = 0; i < m->face.n; i++) b->face[i] = -1;
    bed->faces = 0;
    for (int i = 0; i < bed->cells; i++) {
        bed->face_start[i] = entry;
        for (int j = m->face_start[b->seat[i]]; j < m->face_start[b->seat[i] + 1]; j++) {
            const int face = m->face_of_cell[j];
            bed->face_of_cell[entry++] = face < 0 ? ~list_face(g, ~face) : list_face(g, face);
        }
    }
    bed->face_start[bed->cells] = entry;
}

/* ---- to and from the cells ---- */

/* Tells the bed the numbers of its ghosts over all ranks, which come in line 0 of W. */
static status link_ghosts(struct gas *g) {
    struct bed *bed = &g->dense->bed;
    const int *seat = g->cells->bed->seat;
    double *W[MAX_VAR];
    long first;
    TRY(bed_number(bed, bed->cells, &first));
    TRY(bed_meet(bed));
    cells_lines(g, &g->W, W);
    for (int i = 0; i < bed->cells; i++) W[0][seat[i]] = (double)(first + i);
    fill_lines(g, 1, W);
    for (int i = 0; i < bed->ghosts; i++) bed->U[0][bed->cells + i] = W[0][seat[bed->cells + i]];
    bed_link(bed, bed->U[0] + bed->cells);
    return OK;
}

status cells_bed_list(struct gas *g, const struct state *from) {
    double *U[MAX_VAR];
    cells_lines(g, from, U);
    fill_lines(g, g->nvar, U);
    if (is_listed(g)) return OK;
    TRY(comm_agree(g->comm, make_room(g)));
    seat_cells(g);
    list_faces(g);
    return link_ghosts(g);
}

/* An open patch whose mirror has the cell's own state lets it out freely. */
static bool same_state(const struct gas *g, double *const U[MAX_VAR], int a, int b) {
    for (int v = 0; v < g->nvar; v++)
        if (bits_of(U[v][a]) != bits_of(U[v][b])) return false;
    return true;
}

static void take_beyond(struct gas *g, double *const U[MAX_VAR]) {
    const struct polyhedra_faces *faces = &g->cells->polyhedra->face;
    struct bed *bed = &g->dense->bed;
    for (int f = 0; f < bed->faces; f++) {
        const int left = faces->left[bed->shape[f]], right = faces->right[bed->shape[f]];
        if (bed->kind[f] == BED_INNER || bed->kind[f] == BED_WALL) continue;
        if (bed->kind[f] != BED_KEPT) bed->kind[f] = same_state(g, U, left, right) ? BED_FREE : BED_HELD;
        for (int v = 0; v < g->nvar; v++) {
            bed->outside[v][f] = U[v][bed->left[f] < 0 ? left : right];
            bed->kept[v][f] = 0;
        }
    }
}

/* A state at rest has the pressures of the explicit scheme on its faces. */
static void take_balance(struct gas *g, const double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed *bed = &g->dense->bed;
    bed->balanced = g->cells->rest != NULL;
    if (!bed->balanced) return;
    cells_rest_find(g, 0, m->nnear, U);
    for (int f = 0; f < bed->faces; f++)
        for (int side = 0; side < 2; side++) {
            const int face = bed->shape[f], cell = side ? m->face.right[face] : m->face.left[face];
            double fall = 0;
            for (int k = 0; k < g->dim; k++) fall += g->models.source.gravity[k] * bed->shapes->arm[side][k][face];
            bed->balance[side][f] = cell < m->nnear ? cells_rest_miss(g, face, cell, fall) : 0;
        }
}

void cells_bed_take(struct gas *g, const struct state *from, bool again) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed *bed = &g->dense->bed;
    double *U[MAX_VAR];
    cells_lines(g, from, U);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < bed->cells; i++) bed->U[v][i] = U[v][g->cells->bed->seat[i]];
    if (again) return;
    cells_mirrors(g, 0, m->face.n - m->face.ninternal, U);
    take_beyond(g, U);
    take_balance(g, (const double *const *)U);
}

void cells_bed_keep(struct gas *g, double weight) {
    struct bed *bed = &g->dense->bed;
    for (int f = 0; f < bed->faces; f++) {
        const int face = bed->shape[f];
        if (bed->kind[f] != BED_KEPT) continue;
        for (int v = 0; v < g->nvar; v++)
            bed->kept[v][f] += weight * g->cells->flux[v][face] / g->cells->polyhedra->face.area[face];
    }
}

long cells_bed_put(struct gas *g, const struct state *to) {
    const struct bed *bed = &g->dense->bed;
    const int *seat = g->cells->bed->seat;
    double *U[MAX_VAR];
    long bad = 0;
    cells_lines(g, to, U);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < bed->cells; i++) U[v][seat[i]] = bed->U[v][i];
    for (int i = 0; i < bed->cells; i++) bad += row_inadmissible(g, to->block[0], seat[i], 1, NULL);
    return bad;
}

long cells_bed_seat(const struct gas *g, int cell, int *block) {
    *block = 0;
    return g->cells->bed->seat[cell];
}

/* The first cell of a block stands for all of them. */
void cells_bed_spread(struct gas *g, const double *per_block, double *raised) {
    const struct polyhedra *m = g->cells->polyhedra;
    memset(raised, 0, (size_t)m->nown * sizeof *raised);
    for (int b = 0; b < m->nblocks; b++) {
        const int cell = m->block_cell[m->block_start[b]];
        raised[cell] = per_block[b] / m->volume[cell];
    }
}
