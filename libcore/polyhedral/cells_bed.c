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
    struct bed_round round;
    double *memory, *flat; /* of the arms and depths; of what `round` has of faces */
    int *face;             /* [faces] the bed's face; -1: none */
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

/* A face's points are weighted by the radius: its middle lies h^2/(12 r) below its centre, with h its extent along the
 * radius, and likewise along the axis. The radius is at least h/2; faces on the axis have no h. */
static void measure_round(const struct polyhedra *m, struct cells_bed *b, int f) {
    const double L = m->face.area[f] / m->round.reach[f];
    const double *n[2] = {m->face.normal[0], m->face.normal[1]};
    const int radial = m->round.radial, axial = 1 - radial;
    b->round.flat[f] = L;
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < m->dim; k++) b->round.mid[side][k][f] = b->shapes.arm[side][k][f];
    if (m->dim < 2) return;
    const double per = L * L / (12 * larger(m->round.reach[f], 0.5 * L * fabs(n[axial][f])));
    for (int side = 0; side < 2; side++) {
        b->round.mid[side][radial][f] -= per * n[axial][f] * n[axial][f];
        b->round.mid[side][axial][f] += per * n[axial][f] * n[radial][f];
    }
}

static status make_round(struct gas *g, struct cells_bed *b) {
    const struct polyhedra *m = g->cells->polyhedra;
    const long faces = m->face.n;
    if (m->round.radial < 0) return OK;
    TRY(allocate(&b->flat, (1 + 2 * g->dim) * faces, sizeof(double), "the bed"));
    b->round = (struct bed_round){.radial = m->round.radial, .radius = m->round.radius, .flat = b->flat};
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < g->dim; k++) b->round.mid[side][k] = b->flat + (1 + side * g->dim + k) * faces;
    for (int f = 0; f < m->face.n; f++) measure_round(m, b, f);
    b->shapes.round = &b->round;
    return OK;
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
    g->dense->bed.home->shapes = s;
    return make_round(g, b);
}

status cells_bed_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_bed *b;
    g->dense->own = m->nown;
    TRY(bed_make(&g->dense->bed, m->nblocks));
    TRY(allocate(&b, 1, sizeof *b, "the bed"));
    g->cells->bed = b;
    for (int i = 0; i < m->nown; i++) {
        const int sides = m->face_start[i + 1] - m->face_start[i];
        g->dense->sides = sides > g->dense->sides ? sides : g->dense->sides;
    }
    TRY(allocate(&b->face, m->face.n, sizeof(int), "the bed"));
    return make_shapes(g, b);
}

void cells_bed_free(struct gas *g) {
    struct cells_bed *b = g->cells ? g->cells->bed : NULL;
    if (!b) return;
    free(b->memory);
    free(b->flat);
    free(b->face);
    free(b);
}

/* ---- the parts ---- */

static void fill_lines(struct gas *g, int n, double *const *line) {
    polyhedra_fill_start(g->cells->polyhedra, n, line);
    polyhedra_fill_finish(g->cells->polyhedra);
}

/* Marks the frozen, live and outer cells around the dense ones (enum bed_part). Mirrors belong to no part. */
void cells_bed_rings(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *part = g->dense->part[0];
    for (int level = BED_FROZEN; level >= BED_OUTER; level--) {
        const double least = level == BED_FROZEN ? BED_DENSE : level;
        fill_lines(g, 1, g->dense->part);
        for (int i = 0; i < m->nown; i++) {
            if (part[i] > 0) continue;
            for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++)
                if (part[cells_across(m, j)] > least) part[i] = level;
            g->dense->holds[0] |= part[i] > 0;
        }
    }
    fill_lines(g, 1, g->dense->part);
}

/* flow = sum_k |u_k| girth_k, thin = flow + c total_girth (cells.c: rate_line) */
void cells_bed_speeds(struct gas *g, const struct row *row, struct bed_speeds *out) {
    const struct cells *c = g->cells;
    struct cells_primitives q;
    cells_primitives(g, row->n, g->U.block[0] + row->at, &q);
    for (int i = 0; i < row->n; i++) {
        const long at = row->at + i;
        out->eps[i] = q.eps[i];
        out->p[i] = q.p[i];
        out->flow[i] = 0;
        for (int k = 0; k < g->dim; k++) out->flow[i] += fabs(q.velocity[k][i]) * c->girth[k][at];
        out->thin[i] = out->flow[i] + q.c[i] * c->total_girth[at];
    }
}

/* ---- the lists ---- */

/* Lists the blocks; returns how many sides their cells have. */
static int list_blocks(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed_set *bed = g->dense->bed.home;
    int n = 0, sides = 0;
    for (int block = 0; block < m->nblocks; block++) {
        bed->first[block] = n;
        bed->number[block] = m->block_id[block];
        for (int j = m->block_start[block]; j < m->block_start[block + 1]; j++) {
            const int cell = m->block_cell[j];
            if (!(g->dense->part[0][cell] > 0)) continue;
            sides += m->face_start[cell + 1] - m->face_start[cell];
            n++;
        }
    }
    bed->blocks = m->nblocks;
    bed->first[bed->blocks] = n;
    return sides;
}

/* Numbers the cells block by block, and lists them as rows. */
static void list_cells(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct dense *d = g->dense;
    struct row *row = NULL;
    int n = 0;
    for (int j = 0; j < m->nown; j++) {
        const int cell = m->block_cell[j];
        if (!(d->part[0][cell] > 0)) continue;
        d->bed.home->body[n] = cell;
        d->number[0][cell] = d->bed.home->low + ++n;
        if (row && row->n < BATCH && cell == row->at + row->n) {
            row->n++;
        } else {
            row = &d->row[d->rows++];
            *row = (struct row){0, cell, 1};
        }
    }
}

/* Returns the bed's face for a face of the mesh, which is made. */
static int list_face(struct gas *g, int face) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct cells_bed *b = g->cells->bed;
    struct dense *d = g->dense;
    struct bed_set *bed = d->bed.home;
    if (b->face[face] >= 0) return b->face[face];
    const int at = b->face[face] = bed->faces++, left = f->left[face], right = f->right[face];
    bed->shape[at] = face;
    bed->left[at] = d->number[0][left] - 1;
    bed->right[at] = d->number[0][right] - 1;
    bed->kind[at] = BED_INNER;
    if (bed->left[at] >= 0 && bed->right[at] >= 0) return at;
    const int i = face - f->ninternal;
    const struct patch_face patch = i < 0 ? (struct patch_face){-1, 0} : (struct patch_face){f->patch[i], f->place[i]};
    bed->kind[at] = (unsigned char)dense_kind(g, patch.patch);
    const bool in = bed->left[at] >= 0;
    d->border[d->borders++] = (struct dense_border){at, 0, in ? left : right, in ? right : left, patch};
    return at;
}

static void list_faces(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed_set *bed = g->dense->bed.home;
    int entry = 0;
    for (int i = 0; i < m->face.n; i++) g->cells->bed->face[i] = -1;
    for (int i = 0; i < bed->cells; i++) {
        bed->face_start[i] = entry;
        for (int j = m->face_start[bed->body[i]]; j < m->face_start[bed->body[i] + 1]; j++) {
            const int face = m->face_of_cell[j];
            bed->face_of_cell[entry++] = face < 0 ? ~list_face(g, ~face) : list_face(g, face);
        }
    }
    bed->face_start[bed->cells] = entry;
}

status cells_bed_list(struct gas *g) {
    const int sides = list_blocks(g);
    const struct bed_set *bed = g->dense->bed.home;
    TRY(dense_list(g, OK, bed->first[bed->blocks], sides));
    list_cells(g);
    polyhedra_fill_int(g->cells->polyhedra, g->dense->number[0]);
    list_faces(g);
    return OK;
}

/* ---- to and from the cells ---- */

void cells_bed_fill(struct gas *g, const struct state *from) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *U[MAX_VAR];
    cells_lines(g, from, U);
    fill_lines(g, g->nvar, U);
    cells_mirrors(g, 0, m->face.n - m->face.ninternal, U);
}

/* A state at rest has the pressures of the explicit scheme on its faces. */
void cells_bed_balance(struct gas *g, const struct state *from) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed_set *bed = g->dense->bed.home;
    double *U[MAX_VAR];
    bed->balanced = g->cells->rest != NULL;
    if (!bed->balanced) return;
    cells_lines(g, from, U);
    cells_rest_find(g, 0, m->nnear, (const double *const *)U);
    for (int f = 0; f < bed->faces; f++)
        for (int side = 0; side < 2; side++) {
            const int face = bed->shape[f], cell = side ? m->face.right[face] : m->face.left[face];
            double fall = 0;
            for (int k = 0; k < g->dim; k++) fall += g->models.source.gravity[k] * bed->shapes->arm[side][k][face];
            bed->balance[side][f] = cell < m->nnear ? cells_rest_miss(g, face, cell, fall) : 0;
        }
}

void cells_bed_keep(struct gas *g, double weight) {
    const struct bed_set *bed = g->dense->bed.home;
    for (int i = 0; i < g->dense->borders; i++) {
        const int f = g->dense->border[i].face, face = bed->shape[f];
        if (bed->kind[f] != BED_KEPT) continue;
        for (int v = 0; v < g->nvar; v++)
            bed->kept[v][f] += weight * g->cells->flux[v][face] / g->cells->polyhedra->face.area[face];
    }
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
