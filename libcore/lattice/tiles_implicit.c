/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on a lattice: links between cells, matrix entries, unknowns. Cells are
 * numbered tile by tile, along rows. */
#include "libcore/lattice/tiles_diffuser.h"

static int cells_of(const struct tile *t) {
    return t->n[0] * t->n[1] * t->n[2];
}

/* Does a patch lie beyond this face of the cell at i? face: 0 .. 2 dim - 1, as the sides of a tile */
ALWAYS_INLINE bool at_patch(const struct tile *t, const int i[3], int face) {
    return t->side[face].patch >= 0 && i[face / 2] == (face % 2 ? t->n[face / 2] - 1 : 0);
}

typedef void cell_visitor(void *context, int tile, long offset, const int i[3]);

static void cells_visit(const struct forest *f, cell_visitor *visit, void *context) {
    for (int t = 0; t < f->ntiles; t++)
        for (int k = 0; k < f->tile[t].n[2]; k++)
            for (int j = 0; j < f->tile[t].n[1]; j++)
                for (int i = 0; i < f->tile[t].n[0]; i++)
                    visit(context, t, f->first + i + j * f->stride[1] + k * f->stride[2], (int[]){i, j, k});
}

struct numbering {
    const struct gas *g;
    struct links *links;
    double **number;
    long next;
};

static void number_cell(void *context, int tile, long offset, const int i[3]) {
    struct numbering *v = context;
    (void)i;
    v->number[tile][offset] = (double)v->next++;
}

static void link_cell(void *context, int tile, long offset, const int i[3]) {
    struct numbering *v = context;
    const struct forest *f = v->g->forest;
    const double *number = v->number[tile] + offset;
    struct links *l = v->links;
    int n = l->first[l->cells];
    l->column[n++] = (int)number[0];
    for (int face = 0; face < 2 * f->dim; face++)
        if (!at_patch(&f->tile[tile], i, face))
            l->column[n++] = (int)number[face % 2 ? f->stride[face / 2] : -f->stride[face / 2]];
    l->first[++l->cells] = n;
}

status tiles_implicit_pattern(struct gas *g, struct links *out) {
    const struct forest *f = g->forest;
    struct numbering v = {.g = g, .links = out};
    int cells = 0;
    out->symmetric = true;
    for (int t = 0; t < f->ntiles; t++) cells += cells_of(&f->tile[t]);
    TRY(implicit_first(g, cells, &v.next));
    TRY(allocate(&out->first, cells + 1, sizeof(int), "the links of cells"));
    TRY(allocate(&out->column, (long)cells * (1 + 2 * f->dim), sizeof(int), "the links of cells"));
    TRY(blocks_make(f, 1, &v.number));
    cells_visit(f, number_cell, &v);
    forest_fill(g->forest, 1, v.number);
    cells_visit(f, link_cell, &v);
    blocks_free(f, v.number);
    return OK;
}

struct filling {
    const struct gas *g;
    enum diffusing what;
    const struct state *Y0;
    double per; /* factor of L in the matrix */
    int unknown;
    double *rho, *E, *weight; /* where the next entries go */
};

/* S beyond a side of the cell at `offset`, by the patch's rule, where S = 1 inside and the rule is given no values. */
static double beyond_one(const struct filling *v, int tile, long offset, int side) {
    const struct gas *g = v->g;
    const struct forest *f = g->forest;
    const struct side *s = &f->tile[tile].side[side];
    const long beyond = offset + (side % 2 ? f->stride[side / 2] : -f->stride[side / 2]);
    double inner[MAX_DIM][BATCH], start[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH];
    const struct sum_line line = {.n = 1,
                                  .components = lines_of(g, v->what),
                                  .normal = v->what == VISCOUS ? side / 2 : -1,
                                  .face = s->face,
                                  .share = g->tiles->diffuser->wall[tile] + DRAG * f->size + beyond,
                                  .inner = inner,
                                  .start = start,
                                  .ghost = ghost};
    for (int c = 0; c < line.components; c++) {
        inner[c][0] = 1;
        start[c][0] = 0;
    }
    sums_beyond(&g->patches.rules[s->patch], v->what, &line);
    return ghost[v->unknown][0];
}

static void weigh_cell(void *context, int tile, long offset, const int i[3]) {
    struct filling *v = context;
    const struct forest *f = v->g->forest;
    const struct tile *t = &f->tile[tile];
    *v->E++ = v->Y0->block[tile][(v->g->components + 1) * f->size + offset];
    double *self = v->weight++, sum = *v->rho++ = v->Y0->block[tile][offset];
    for (int face = 0; face < 2 * f->dim; face++) {
        const int axis = face / 2;
        const long at = offset + (face % 2 ? f->stride[axis] : 0); /* faces stand at the cell above them */
        const int line = v->what == HEAT ? CONDUCTION : axis == v->unknown ? NORMAL : SHEAR;
        const double w = v->per * v->g->tiles->diffuser->face[tile][(FACE_LINES * axis + line) * f->size + at];
        if (at_patch(t, i, face))
            sum += w * (1 - beyond_one(v, tile, offset, face));
        else {
            sum += w;
            *v->weight++ = -w;
        }
    }
    *self = sum;
}

void tiles_implicit_matrix(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double *rho,
                           double *E, double *weight) {
    struct filling v = {.g = g, .what = what, .Y0 = Y0, .weight = weight};
    v.per = what == HEAT ? temperature_of(&g->models.material, factor) : factor;
    for (v.unknown = 0; v.unknown < lines_of(g, what); v.unknown++) {
        v.rho = rho;
        v.E = E;
        cells_visit(g->forest, weigh_cell, &v);
    }
}

void tiles_implicit_move(struct gas *g, enum diffusing what, double *x, bool to_sums) {
    const struct forest *f = g->forest;
    const int unknowns = lines_of(g, what);
    for (int t = 0; t < f->ntiles; t++)
        for (int k = 0; k < f->tile[t].n[2]; k++)
            for (int j = 0; j < f->tile[t].n[1]; j++) {
                const int n = f->tile[t].n[0];
                double *S = g->tiles->diffuser->sum[g->tiles->diffuser->last][t] + f->first + j * f->stride[1] +
                            k * f->stride[2];
                for (int c = 0; c < unknowns; c++, S += f->size)
                    for (int i = 0; i < n; i++) {
                        if (to_sums)
                            S[i] = x[i * unknowns + c];
                        else
                            x[i * unknowns + c] = S[i];
                    }
                x += n * unknowns;
            }
}
