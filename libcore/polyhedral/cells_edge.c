/* The edge of polyhedra: mirror cells for the stencils, and the states beyond the faces of patches. Reflecting rules
 * act in the frame of the face, others in the axes of the polyhedra, in which their values are given. */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells.h"

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

/* Vector i of a batch between the axes of the polyhedra and the frame. */
static void into_frame(int dim, const struct frame *f, double (*q)[BATCH], int i) {
    double m[MAX_DIM];
    for (int k = 0; k < dim; k++) m[k] = q[k][i];
    for (int t = 0; t < dim; t++) {
        double sum = 0;
        for (int k = 0; k < dim; k++) sum += f->axis[t][k] * m[k];
        q[t][i] = sum;
    }
}

static void out_of_frame(int dim, const struct frame *f, double (*q)[BATCH], int i) {
    double m[MAX_DIM];
    for (int t = 0; t < dim; t++) m[t] = q[t][i];
    for (int k = 0; k < dim; k++) {
        double sum = 0;
        for (int t = 0; t < dim; t++) sum += f->axis[t][k] * m[t];
        q[k][i] = sum;
    }
}

static void mirror_run(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->rules[m->mirror.patch[from]];
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH];
    struct patch_line line = {.n = n, .face = m->mirror.place + from, .outflow = outflow};
    const bool reflects = r->velocity.type->reflects;
    for (int i = 0; i < n; i++) {
        struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        outflow[i] = 0;
        for (int v = 0; v < g->nvar; v++) inner[v][i] = U[v][m->mirror.cell[from + i]];
        for (int k = 0; k < g->dim; k++) outflow[i] += f.axis[0][k] * inner[k + 1][i] / inner[0][i];
        if (reflects) into_frame(g->dim, &f, inner + 1, i);
    }
    patch_ghosts(g, r, &line, inner, ghost);
    for (int i = 0; i < n; i++) {
        struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        if (reflects) out_of_frame(g->dim, &f, ghost + 1, i);
        for (int v = 0; v < g->nvar; v++) U[v][m->ncells + from + i] = ghost[v][i];
    }
}

/* The gas at a wall that drags has the wall's velocity w: with 2 w - u beyond it polynomials keep the slope that
 * friction makes. (Fluxes through the wall itself see a plain mirror: they pass on pressure alone.) */
static void drag_run(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *w = g->rules[m->mirror.patch[from]].velocity.uniform;
    for (int i = from; i < from + n; i++) {
        const int cell = m->mirror.cell[i], mirror = m->ncells + i;
        const double rho = U[0][cell];
        double work = 0;
        for (int k = 0; k < g->dim; k++) {
            work += w[k] * (rho * w[k] - U[k + 1][cell]);
            U[k + 1][mirror] = 2 * rho * w[k] - U[k + 1][cell];
        }
        U[0][mirror] = rho;
        U[g->dim + 1][mirror] = U[g->dim + 1][cell] + 2 * work;
    }
}

/* How many mirrors from `from` on, before `to`, are of one patch: a batch at most. */
static int patch_run(const struct gas *g, int from, int to) {
    const int *patch = g->cells->polyhedra->mirror.patch;
    int end = from + 1;
    while (end < to && end < from + BATCH && patch[end] == patch[from]) end++;
    return end - from;
}

void cells_mirrors(const struct gas *g, int from, int to, double *const U[MAX_VAR]) {
    for (int n; from < to; from += n) {
        n = patch_run(g, from, to);
        if (g->models.transport && g->rules[g->cells->polyhedra->mirror.patch[from]].velocity.type->drags)
            drag_run(g, from, n, U);
        else
            mirror_run(g, from, n, U);
    }
}

void cells_beyond(const struct gas *g, int patch, int n, const int *face, const int *place, double (*q)[BATCH],
                  double (*ghost)[BATCH]) {
    const struct polyhedra_faces *faces = &g->cells->polyhedra->face;
    const struct patch_rules *r = &g->rules[patch];
    double inner[MAX_VAR][BATCH], outflow[BATCH];
    struct patch_line line = {.n = n, .face = place, .outflow = outflow};
    const bool reflects = r->velocity.type->reflects;
    for (int i = 0; i < n; i++) {
        for (int v = 0; v < g->nvar; v++) inner[v][i] = q[v][i];
        outflow[i] = q[1][i] / q[0][i];
        if (reflects) continue;
        struct frame f = frame_of(g->dim, faces->normal, faces->tangent, face[i]);
        out_of_frame(g->dim, &f, inner + 1, i);
    }
    patch_ghosts(g, r, &line, inner, ghost);
    for (int i = 0; i < n && !reflects; i++) {
        struct frame f = frame_of(g->dim, faces->normal, faces->tangent, face[i]);
        into_frame(g->dim, &f, ghost + 1, i);
    }
}

static void wall_shares_run(const struct gas *g, int from, int n, const double *rho, const double *T,
                            const double *heat, double *share) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->rules[m->mirror.patch[from]];
    double inner[3][BATCH], push[BATCH], d[BATCH];
    for (int i = 0; i < n; i++) {
        const int cell = m->mirror.cell[from + i];
        inner[0][i] = rho[cell];
        inner[1][i] = T[cell];
        inner[2][i] = heat[cell];
        d[i] = push[i] = share[from + i] = 0;
        for (int k = 0; k < g->dim; k++) {
            push[i] += g->pull[k] * m->mirror.normal[k][from + i];
            d[i] += (m->centre[k][m->ncells + from + i] - m->centre[k][cell]) * m->mirror.normal[k][from + i];
        }
    }
    if (wall_conducts(r)) wall_shares(g, r, n, inner[0], inner[1], push, d, inner[2], share + from);
}

void cells_wall_shares(const struct gas *g, const double *rho, const double *T, const double *heat, double *share) {
    const int mirrors = g->cells->polyhedra->mirror.n;
    for (int n, from = 0; from < mirrors; from += n) {
        n = patch_run(g, from, mirrors);
        wall_shares_run(g, from, n, rho, T, heat, share);
    }
}

static void mirror_sums_run(const struct gas *g, enum diffusing what, double weight, int from, int n,
                            const double *share, const double *const *start, double *const *S) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->rules[m->mirror.patch[from]];
    const int lines = what == VISCOUS ? g->dim : 1;
    const bool turn = r->velocity.type->reflects && what == VISCOUS;
    double inner[MAX_DIM][BATCH], beyond[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH];
    const struct sum_line line = {n,      lines, what == VISCOUS ? 0 : -1, m->mirror.place + from, weight, inner,
                                  beyond, ghost};
    for (int i = 0; i < n; i++) {
        const struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        for (int c = 0; c < lines; c++) {
            inner[c][i] = S[c][m->mirror.cell[from + i]];
            beyond[c][i] = start[c][m->ncells + from + i];
        }
        if (!turn) continue;
        into_frame(g->dim, &f, inner, i);
        into_frame(g->dim, &f, beyond, i);
    }
    sums_beyond(r, what, &line);
    for (int i = 0; i < n; i++) {
        const struct frame f = frame_of(g->dim, m->mirror.normal, m->mirror.tangent, from + i);
        if (turn) out_of_frame(g->dim, &f, ghost, i);
    }
    carry_sums(r, what, &line);
    if (what == HEAT && wall_conducts(r))
        for (int i = 0; i < n; i++) ghost[0][i] = inner[0][i] + share[from + i] * (ghost[0][i] - inner[0][i]);
    for (int i = 0; i < n; i++)
        for (int c = 0; c < lines; c++) S[c][m->ncells + from + i] = ghost[c][i];
}

void cells_mirror_sums(const struct gas *g, enum diffusing what, double weight, int from, int to, const double *share,
                       const double *const *start, double *const *S) {
    for (int n; from < to; from += n) {
        n = patch_run(g, from, to);
        mirror_sums_run(g, what, weight, from, n, share, start, S);
    }
}

/* Of the derivatives along the wall; the one across it is the cell's. Where a wall drags all are the cell's: those
 * along it are 0 on the wall itself, but the cell's keep the operator symmetric (libcore/polyhedral/cells_gradient.c).
 */
static void mirror_gradients_run(const struct gas *g, int from, int n, double *const *gradient) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct patch_rules *r = &g->rules[m->mirror.patch[from]];
    const int dim = g->dim;
    double in[MAX_DIM][MAX_DIM][BATCH], along[MAX_DIM][MAX_DIM][BATCH], ghost[MAX_DIM][BATCH];
    for (int i = 0; i < n; i++) {
        const struct frame f = frame_of(dim, m->mirror.normal, m->mirror.tangent, from + i);
        for (int k = 0; k < dim; k++) {
            for (int c = 0; c < dim; c++) in[k][c][i] = gradient[k * dim + c][m->mirror.cell[from + i]];
            into_frame(dim, &f, in[k], i);
        }
        for (int t = 0; t < dim; t++)
            for (int c = 0; c < dim; c++) {
                along[t][c][i] = 0;
                for (int k = 0; k < dim; k++) along[t][c][i] += f.axis[t][k] * in[k][c][i];
            }
    }
    for (int t = 1; t < dim; t++) {
        const struct sum_line line = {
            .n = n, .components = dim, .face = m->mirror.place + from, .inner = along[t], .ghost = ghost};
        if (r->velocity.type->drags) continue;
        reflect_sums(r, &line);
        memcpy(along[t], ghost, sizeof ghost);
    }
    for (int i = 0; i < n; i++) {
        const struct frame f = frame_of(dim, m->mirror.normal, m->mirror.tangent, from + i);
        for (int k = 0; k < dim; k++) {
            for (int c = 0; c < dim; c++) {
                ghost[c][i] = 0;
                for (int t = 0; t < dim; t++) ghost[c][i] += f.axis[t][k] * along[t][c][i];
            }
            out_of_frame(dim, &f, ghost, i);
            for (int c = 0; c < dim; c++) gradient[k * dim + c][m->ncells + from + i] = ghost[c][i];
        }
    }
}

void cells_mirror_gradients(const struct gas *g, int from, int to, double *const *gradient) {
    for (int n; from < to; from += n) {
        n = patch_run(g, from, to);
        mirror_gradients_run(g, from, n, gradient);
    }
}
