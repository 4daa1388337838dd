/* Transport in a bed: what the face velocities U carry (bed.h, part 3 and the theorem). */
#include "libcore/acoustics/bed_private.h"

static const double LEFT = 0.1;

/* A face as a cell sees it: the volume that leaves through it, as a part of the cell. */
static double leaving(const struct bed *b, double dt, int axis, int face, bool above) {
    return (above ? 1 : -1) * (dt / b->width[axis]) * b->lines->U[face];
}

/* Slopes of rho, u and eps along an axis; 0 in cells beside faces that lead out of the bed. */
static void find_slopes(struct bed *b, int axis) {
    const struct bed_lines *x = b->lines;
    const int last = b->dim + 1;
    for (int i = 0; i < b->cells; i++) {
        const int low = b->low[axis][i], high = b->high[axis][i];
        const int below = b->kind[low] == BED_INNER ? b->left[low] : i,
                  above = b->kind[high] == BED_INNER ? b->right[high] : i;
        for (int v = 0; v <= last; v++) {
            const double *q = x->after[v];
            const bool mirrored = v == axis + 1;
            double under = q[i] - q[below], over = q[above] - q[i];
            if (mirrored && b->kind[low] == BED_WALL) under = 2 * q[i];
            if (mirrored && b->kind[high] == BED_WALL) over = -2 * q[i];
            x->slope[axis][v][i] = limited(under, over);
        }
    }
}

/* The conserved state that leaves a cell through a face: the mean over the volume that leaves, a part |out| of it. */
static void face_state(const struct bed *b, int cell, int axis, bool above, double out, double V[MAX_VAR]) {
    const struct bed_lines *x = b->lines;
    const double part = (above ? 0.5 : -0.5) * (1 - fabs(out));
    const int last = b->dim + 1;
    double square = 0;
    V[0] = x->after[0][cell] + part * x->slope[axis][0][cell];
    for (int k = b->dim; k >= 1; k--) {
        V[k] = x->after[k][cell] + part * x->slope[axis][k][cell];
        square += V[k] * V[k];
        V[k] *= V[0];
    }
    V[last] = V[0] * (x->after[last][cell] + part * x->slope[axis][last][cell] + 0.5 * square);
}

static bool admissible(const struct bed *b, const double V[MAX_VAR], double volume) {
    double square = 0;
    for (int k = b->dim; k >= 1; k--) square += V[k] * V[k];
    return V[0] > 0 && V[0] < b->limit * volume && V[b->dim + 1] * V[0] - 0.5 * square > 0;
}

/* Sets the slopes of a cell to 0 where what stays behind is not admissible. Returns whether little enough flows in and
 * out. */
static bool settle_cell(struct bed *b, double dt, int i) {
    const struct bed_lines *x = b->lines;
    double in = 0, out = 0, growth = 0, stays[MAX_VAR] = {0}, V[MAX_VAR];
    for (int k = b->dim - 1; k >= 0; k--)
        for (int above = 0; above < 2; above++) {
            const double part = leaving(b, dt, k, above ? b->high[k][i] : b->low[k][i], above);
            growth += part;
            in += part < 0 ? -part : 0;
            out += part > 0 ? part : 0;
            if (!(part > 0)) continue;
            face_state(b, i, k, above, part, V);
            for (int v = 0; v < b->dim + 2; v++) stays[v] -= part * V[v];
        }
    double square = 0;
    for (int k = b->dim; k >= 1; k--) square += x->after[k][i] * x->after[k][i];
    const double mass = (1 + growth) * x->after[0][i];
    stays[0] += mass;
    for (int k = 1; k <= b->dim; k++) stays[k] += mass * x->after[k][i];
    stays[b->dim + 1] += mass * (x->after[b->dim + 1][i] + 0.5 * square);
    if (!admissible(b, stays, 1 - in))
        for (int k = 0; k < b->dim; k++)
            for (int v = 0; v < b->dim + 2; v++) x->slope[k][v][i] = 0;
    return in < MOST_OUT && out < MOST_OUT;
}

/* What crosses a face towards higher places, per area and dt/h: U_f V_f, or what was kept without the pressure's part,
 * which acoustics has moved. */
static void face_flux(const struct bed *b, double dt, int face, int axis, double F[MAX_VAR]) {
    const struct bed_lines *x = b->lines;
    const double U = x->U[face];
    const int from = U > 0 ? b->left[face] : b->right[face];
    for (int v = 0; v < b->dim + 2; v++) F[v] = 0;
    if (b->kind[face] == BED_KEPT) {
        for (int v = 0; v < b->dim + 2; v++) F[v] = b->kept[v][face];
        F[axis + 1] = b->kept[0][face] * U;
        F[b->dim + 1] -= x->p_face[face] * U;
        return;
    }
    if (b->kind[face] == BED_WALL || U == 0) return;
    if (from >= 0) face_state(b, from, axis, U > 0, dt / b->width[axis] * U, F);
    for (int v = 0; v < b->dim + 2; v++) F[v] = U * (from >= 0 ? F[v] : b->outside[v][face]);
}

static void start_cell(struct bed *b, int i) {
    const struct bed_lines *x = b->lines;
    double square = 0;
    for (int k = b->dim; k >= 1; k--) {
        b->U[k][i] = x->rho[i] * x->after[k][i];
        square += x->after[k][i] * x->after[k][i];
    }
    b->U[0][i] = x->rho[i];
    b->U[b->dim + 1][i] = x->rho[i] * (x->after[b->dim + 1][i] + 0.5 * square);
}

/* Carries along one axis: the fluxes of its faces, then the differences in the cells. The fluxes go to the lines of
 * `kept`, each of which was read for its own face before. */
static void carry(struct bed *b, double dt, int axis) {
    const double lambda = dt / b->width[axis];
    for (int f = b->axis_first[axis]; f < b->axis_first[axis + 1]; f++) {
        double F[MAX_VAR];
        face_flux(b, dt, f, axis, F);
        for (int v = 0; v < b->dim + 2; v++) b->kept[v][f] = F[v];
    }
    for (int v = 0; v < b->dim + 2; v++)
        for (int i = 0; i < b->cells; i++)
            b->U[v][i] -= lambda * (b->kept[v][b->high[axis][i]] - b->kept[v][b->low[axis][i]]);
}

static bool is_beside_rest(const struct bed *b, int i) {
    bool beside = false;
    for (int k = 0; k < b->dim; k++) beside |= b->kind[b->low[k][i]] == BED_KEPT || b->kind[b->high[k][i]] == BED_KEPT;
    return beside;
}

/* The fluxes that were kept are those of other velocities than U. In cold gas that is faster than sound they may take
 * more of E than the cell can spare; then eps is lifted to a share LEFT of what it was before the remap. Returns
 * whether no cell was lifted by more than all its energy. */
static bool lift_beside_rest(struct bed *b) {
    const int last = b->dim + 1;
    bool fine = true;
    for (int block = 0; block < b->blocks; block++)
        for (int i = b->first[block]; i < b->first[block + 1]; i++) {
            const double rho = b->U[0][i], least = LEFT * rho * b->lines->after[last][i];
            double square = 0;
            if (!(rho > 0) || !is_beside_rest(b, i)) continue;
            for (int k = b->dim; k >= 1; k--) square += b->U[k][i] * b->U[k][i];
            const double internal = b->U[last][i] - 0.5 * square / rho;
            if (!(internal < least)) continue;
            const double before = b->U[last][i];
            b->U[last][i] += least - internal;
            b->lift[block] += b->U[last][i] - before;
            b->lifted++;
            fine &= least - internal <= bed_energy_near(b, i);
        }
    return fine;
}

bool bed_remap(struct bed *b, double dt) {
    bool fine = true;
    for (int k = 0; k < b->dim; k++) find_slopes(b, k);
    for (int i = 0; i < b->cells; i++) fine &= settle_cell(b, dt, i);
    for (int k = 0; k < b->dim; k++) bed_fill(b, b->dim + 2, b->lines->slope[k]);
    for (int i = 0; i < b->cells; i++) start_cell(b, i);
    for (int k = 0; k < b->dim; k++) carry(b, dt, k);
    return lift_beside_rest(b) && fine;
}
