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
    double *flat;
    TRY(pool_take(&g->dense->pool, &flat, (1 + 2 * g->dim) * faces, sizeof(double), "the bed"));
    b->round = (struct bed_round){.radial = m->round.radial, .radius = m->round.radius, .flat = flat};
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < g->dim; k++) b->round.mid[side][k] = flat + (1 + side * g->dim + k) * faces;
    for (int f = 0; f < m->face.n; f++) measure_round(m, b, f);
    b->shapes.round = &b->round;
    return OK;
}

static status make_shapes(struct gas *g, struct cells_bed *b) {
    const struct polyhedra *m = g->cells->polyhedra;
    const long faces = m->face.n;
    struct bed_shapes *s = &b->shapes;
    double *memory;
    TRY(pool_take(&g->dense->pool, &memory, 2 * (g->dim + 1) * faces, sizeof(double), "the bed"));
    *s = (struct bed_shapes){.volume = m->volume, .area = m->face.area};
    for (int k = 0; k < g->dim; k++) s->normal[k] = m->face.normal[k];
    for (int side = 0; side < 2; side++) {
        s->depth[side] = memory + side * (g->dim + 1) * faces;
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
    TRY(pool_take(&g->dense->pool, &b, 1, sizeof *b, "the bed"));
    for (int i = 0; i < m->nown; i++) {
        const int sides = m->face_start[i + 1] - m->face_start[i];
        g->dense->sides = sides > g->dense->sides ? sides : g->dense->sides;
    }
    TRY(pool_take(&g->dense->pool, &g->dense->place, m->nblocks, sizeof(int), "the bed"));
    TRY(pool_take(&g->dense->pool, &g->cells->spared, m->nnear, sizeof *g->cells->spared, "the bed"));
    g->dense->flux[0] = g->cells->flux[0];
    return make_shapes(g, b);
}

/* ---- in the stages ---- */

const double *cells_kept(const struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    return g->step.hybrid && !g->limits.flags.blocks[0] && m->point.n == m->face.n ? g->dense->part[0] : NULL;
}

/* Through patches the bed finds its fluxes itself. */
static bool lies_deep(const struct polyhedra *m, const double *part, int i) {
    bool deep = part[i] >= BED_FROZEN;
    for (int j = m->face_start[i]; j < m->face_start[i + 1] && deep; j++) {
        const int across = cells_across(m, j);
        deep = across >= m->ncells || part[across] >= BED_FROZEN;
    }
    return deep;
}

void cells_spare(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *part = cells_kept(g);
    unsigned char *spared = g->cells->spared;
    for (int i = 0; i < m->nown && part; i++) spared[i] = lies_deep(m, part, i);
    fit_spare(g->cells->fit, part ? spared : NULL);
}

/* ---- the lists ---- */

/* Rows hold cells of a block that lie one behind the other. */
void cells_bed_blocks(const struct gas *g, bed_block_visitor *visit, void *context) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int b = 0; b < m->nblocks; b++) {
        const int *cell = m->block_cell + m->block_start[b], n = m->block_start[b + 1] - m->block_start[b];
        for (int i = 0, end; i < n; i = end) {
            for (end = i + 1; end < n && end - i < BATCH && cell[end] == cell[end - 1] + 1; end++) continue;
            visit(context, m->block_id[b], cell[0], &(struct row){0, cell[i], end - i});
        }
    }
}

/* A state at rest has the pressures of the explicit scheme on its faces. */
void cells_bed_balance(struct gas *g, const struct state *from) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct bed_set *bed = g->dense->bed.home;
    double *U[MAX_VAR];
    bed->balanced = g->cells->rest != NULL;
    if (!bed->balanced) return;
    cells_lines(g, from, U);
    cells_rest_find(g, 0, m->nnear, (const double *const *)U, NULL);
    for (int f = 0; f < bed->faces; f++)
        for (int side = 0; side < 2; side++) {
            const int face = bed->shape[f], cell = side ? m->face.right[face] : m->face.left[face];
            double fall = 0;
            for (int k = 0; k < g->dim; k++) fall += g->models.source.gravity[k] * bed->shapes->arm[side][k][face];
            bed->balance[side][f] = cell < m->nnear ? cells_rest_miss(g, face, cell, fall) : 0;
        }
}
