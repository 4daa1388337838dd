/* The edge of a mosaic: mirror cells for the stencils, and the states beyond the faces of patches. Reflecting rules act
 * in the frame of the face, others in the axes of the mosaic, in which their values are given. */
#include "libcore/cells.h"

struct frame { /* of one face: normal, tangents */
    double axis[MAX_DIM][MAX_DIM];
};

static struct frame frame_of(int dim, double *const normal[3], double *const tangent[2][3], int i) {
    struct frame f;
    for (int k = 0; k < dim; k++) {
        f.axis[0][k] = normal[k][i];
        for (int t = 1; t < dim; t++) f.axis[t][k] = tangent[t - 1][k][i];
    }
    return f;
}

/* The momentum of state i between the axes of the mosaic and the frame. */
static void into_frame(int dim, const struct frame *f, double (*q)[BATCH], int i) {
    double m[MAX_DIM];
    for (int k = 0; k < dim; k++) m[k] = q[k + 1][i];
    for (int t = 0; t < dim; t++) {
        double sum = 0;
        for (int k = 0; k < dim; k++) sum += f->axis[t][k] * m[k];
        q[t + 1][i] = sum;
    }
}

static void out_of_frame(int dim, const struct frame *f, double (*q)[BATCH], int i) {
    double m[MAX_DIM];
    for (int t = 0; t < dim; t++) m[t] = q[t + 1][i];
    for (int k = 0; k < dim; k++) {
        double sum = 0;
        for (int t = 0; t < dim; t++) sum += f->axis[t][k] * m[t];
        q[k + 1][i] = sum;
    }
}

static void mirror_run(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct mosaic *m = g->cells->mosaic;
    const struct patch_rules *r = &g->rules[m->mirror.patch[from]];
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH];
    struct patch_line line = {.n = n, .face = m->mirror.place + from, .outflow = outflow};
    const bool reflects = r->velocity.type->reflects;
    for (int i = 0; i < n; i++) {
        struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        outflow[i] = 0;
        for (int v = 0; v < g->nvar; v++) inner[v][i] = U[v][m->mirror.cell[from + i]];
        for (int k = 0; k < g->dim; k++) outflow[i] += f.axis[0][k] * inner[k + 1][i] / inner[0][i];
        if (reflects) into_frame(g->dim, &f, inner, i);
    }
    patch_ghosts(g, r, &line, inner, ghost);
    for (int i = 0; i < n; i++) {
        struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        if (reflects) out_of_frame(g->dim, &f, ghost, i);
        for (int v = 0; v < g->nvar; v++) U[v][m->ncells + from + i] = ghost[v][i];
    }
}

void cells_mirrors(const struct gas *g, int from, int to, double *const U[MAX_VAR]) {
    const int *patch = g->cells->mosaic->mirror.patch;
    for (int end; from < to; from = end) {
        for (end = from + 1; end < to && end < from + BATCH && patch[end] == patch[from];) end++;
        mirror_run(g, from, end - from, U);
    }
}

void cells_beyond(const struct gas *g, int patch, int n, const int *face, const int *place, double (*q)[BATCH],
                  double (*ghost)[BATCH]) {
    const struct mosaic_faces *faces = &g->cells->mosaic->face;
    const struct patch_rules *r = &g->rules[patch];
    double inner[MAX_VAR][BATCH], outflow[BATCH];
    struct patch_line line = {.n = n, .face = place, .outflow = outflow};
    const bool reflects = r->velocity.type->reflects;
    for (int i = 0; i < n; i++) {
        for (int v = 0; v < g->nvar; v++) inner[v][i] = q[v][i];
        outflow[i] = q[1][i] / q[0][i];
        if (reflects) continue;
        struct frame f = frame_of(g->dim, faces->normal, faces->tangent, face[i]);
        out_of_frame(g->dim, &f, inner, i);
    }
    patch_ghosts(g, r, &line, inner, ghost);
    for (int i = 0; i < n && !reflects; i++) {
        struct frame f = frame_of(g->dim, faces->normal, faces->tangent, face[i]);
        into_frame(g->dim, &f, ghost, i);
    }
}
