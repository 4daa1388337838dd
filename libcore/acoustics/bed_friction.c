/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction in a bed: Coulomb's law |tau| <= Y with the pressure that the bed has, solved with the forces that act on it
 * (docs/physics.md 9.3; bed_friction_private.h).
 *
 * Each face keeps a stress tau, a symmetric tensor without trace, from step to step. In a step
 *     tau' = th (tau + 2 G dt D'(V)),   th = min(1, Y/|tau + 2 G dt D'(u)|),   |a| = sqrt(a:a/2),
 *     rho (V - u)/dt = F + div tau',     F: pressure and weight, by the pressures of the last acoustic step,
 * D' the rate of strain without its trace. Where th = 1 the bed is elastic: gas at rest keeps the stress that carries
 * it and does not creep. The system is linear in V. One step of a damped Chebyshev method (RKC) from u stands for its
 * solution: gas at rest is a fixed point of it, whatever the number of stages, and it needs no sums over all cells. Its
 * damping is needed: stress and velocity together multiply a mode by E +- sqrt(E^2 - E), E the method's polynomial,
 * which is stable for -1/3 <= E <= 1 alone.
 *
 * On a face D comes from the difference between its cells and, along the face, from the gradients of both. On boxes
 * cells gain what the faces' tractions give, on other meshes by the adjoint of D (bed_adjoint.c): momentum is kept. The
 * faces' own velocities U, which carry the gas, gain
 *     push = mean of the cells' gains by friction + held (mean of the cells' gains by F - the face's own gain by F),
 * held: 1 where nothing yields; the second term is bounded by what Y bears on the face. So a face between cells at rest
 * is at rest, although the forces on it are not the mean of those on its cells.
 *
 * Of a body of revolution (docs/physics.md 1.4) D has u_r/r around the axis. The stress there is minus the sum of the
 * others on the diagonal. It pulls along the radius by -tau/r, the adjoint of u_r/r. */
#include "libcore/acoustics/bed_friction_private.h"

/* Faces whose lighter cell is less dense than packed gas have a modulus lower by that ratio, for else thin gas beside
 * packed gas would need many stages. Stages: rates are bounded from above by those of the differences across faces,
 * times SAFE, for the differences along them; on other meshes than boxes, where these reach farther, SAFE_ASKEW. */
static const double SAFE = 1.2, SAFE_ASKEW = 2;
/* |RKC's polynomial| is at most 1/DAMPED where it no longer falls with the rate. */
static const double DAMPED = 10;
/* A step that would take more stages fails: half of it takes half as many. */
enum { MOST_STAGES = 1000 };

/* The cohesion of the surface reaches DEPTH cells down; cells denser than COHERES times packing have it. */
static const double DEPTH = 2, COHERES = 0.1;

/* ---- what is known of a face ---- */

static struct face_view view_of(const struct bed *b, int f) {
    return bed_view(b, f, b->dim);
}

/* Sets jump to the difference of the velocity V from the left to the right of a face, across a wall that is not rough
 * none, and mean to the gradients along the face. */
ALWAYS_INLINE void look_at_face(const struct bed *b, const struct face_view *v, double *const *V, struct sizes n,
                                double jump[MAX_DIM], double mean[MAX_DIM][MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    const int l = v->left, q = v->right;
    if (l >= 0 && q >= 0) {
        const double all = r->share[l] + r->share[q], w = r->share[l] / all;
        for (int m = 0; m < n.components; m++) jump[m] = V[m][q] - V[m][l];
        for (int k = 0; k < n.dim; k++)
            for (int m = 0; m < n.components; m++)
                mean[k][m] = w * r->gradient[k][m][l] + (1 - w) * r->gradient[k][m][q];
        return;
    }
    const int i = l >= 0 ? l : q;
    double across = 0;
    for (int k = 0; k < n.dim && !bed_is_rough(b, v->face); k++)
        across += v->n[k] * (b->set.wall_speed[k][v->face] - V[k][i]);
    for (int m = 0; m < n.components; m++) {
        const double change = b->set.wall_speed[m][v->face] - V[m][i] - (m < n.dim ? across * v->n[m] : 0);
        jump[m] = l >= 0 ? change : -change;
    }
    for (int k = 0; k < n.dim; k++)
        for (int m = 0; m < n.components; m++) mean[k][m] = 0;
}

/* Returns the hoop component of the rate of strain on a face, u_r/r; 0 on boxes where hoop_instead counts for it. */
ALWAYS_INLINE double hoop_strain(const struct bed *b, const struct face_view *v, double *const *V) {
    const struct bed_shapes *h = b->set.shapes;
    const int k = h->round->radial, cell[2] = {v->left, v->right};
    double sum = 0;
    if (!h->boxes) return b->rub->value[k][v->face] * h->round->flat[v->shape] / h->area[v->shape];
    if (b->set.kind[v->face] == BED_WALL && !bed_is_rough(b, v->face)) return 0;
    for (int side = 0; side < 2; side++)
        if (cell[side] >= 0) sum += hoop_share(b, v->shape, side, cell[side]) * V[k][cell[side]];
    return sum * b->dim / (h->area[v->shape] * v->depth);
}

/* Computes D' on a face, the numbers [tensors] in rows of the upper half. */
ALWAYS_INLINE void strain_with(const struct bed *b, const struct face_view *v, double *const *V, struct sizes n,
                               double D[TENSOR]) {
    double jump[MAX_DIM], G[MAX_DIM][MAX_DIM] = {{0}}, trace = 0;
    const double axes = b->material->disks ? 2 : 3;
    if (b->set.shapes->boxes)
        look_at_face(b, v, V, n, jump, G);
    else
        bed_look_askew(b, v, V, jump, G);
    for (int m = 0; m < n.components; m++) {
        for (int k = 0; k < n.dim && b->set.shapes->boxes; k++) jump[m] -= v->to[k] * G[k][m];
        jump[m] /= v->depth;
    }
    for (int m = 0; m < n.components; m++)
        for (int k = 0; k < n.dim; k++) G[k][m] += v->n[k] * jump[m];
    for (int k = 0; k < n.dim; k++) trace += G[k][k];
    if (b->set.shapes->round) trace += hoop_strain(b, v, V);
    for (int i = 0, at = 0; i < n.components; i++)
        for (int j = i; j < n.components; j++, at++)
            D[at] = i == j ? G[i][i] - trace / axes : 0.5 * (G[i][j] + G[j][i]);
}

static void strain_of(const struct bed *b, const struct face_view *v, double *const *V, double D[TENSOR]) {
    strain_with(b, v, V, (struct sizes){b->dim, b->components}, D);
}

/* Returns |a| = sqrt(a:a/2) of a tensor without trace. */
static double size_of(const struct bed *b, const double a[TENSOR]) {
    const int missing = (b->material->disks ? 2 : 3) - b->components;
    double sum = 0, trace = 0;
    for (int i = 0, at = 0; i < b->components; i++)
        for (int j = i; j < b->components; j++, at++) {
            sum += i == j ? 0.5 * a[at] * a[at] : a[at] * a[at];
            trace += i == j ? a[at] : 0;
        }
    if (missing > 0) sum += 0.5 * trace * trace / missing;
    return sqrt(sum);
}

/* Computes a n. */
ALWAYS_INLINE void apply(struct sizes of, const double a[TENSOR], const double n[MAX_DIM], double out[MAX_DIM]) {
    for (int m = 0; m < of.components; m++) out[m] = 0;
    for (int i = 0, at = 0; i < of.components; i++)
        for (int j = i; j < of.components; j++, at++) {
            if (i < of.dim) out[j] += n[i] * a[at];
            if (j != i && j < of.dim) out[i] += n[j] * a[at];
        }
}

/* ---- forces ---- */

/* Returns P, the pressure of a cell at one of its faces, by the pressures of the last step. */
static double load_at(const struct bed *b, int f, int right, const double gravity[MAX_DIM]) {
    const int cell = right ? b->set.right[f] : b->set.left[f];
    return b->rub->p[cell] + bed_weight(b, f, right, b->lines->rho[cell], gravity);
}

/* Returns the gain of u.n of a face by pressure and weight. */
static double fall_of_face(const struct bed *b, int f, double dt, const double gravity[MAX_DIM]) {
    const double *rho = b->lines->rho;
    const int shape = b->set.shape[f];
    const double apart = b->set.shapes->depth[0][shape] + b->set.shapes->depth[1][shape];
    return -dt * (load_at(b, f, 1, gravity) - load_at(b, f, 0, gravity)) /
           (0.5 * (rho[b->set.left[f]] + rho[b->set.right[f]]) * apart);
}

/* Finds the gains of the cells' velocities by pressure and weight, as move_cell of bed_update.c does; other faces than
 * inner ones give none. */
static void find_drive(const struct bed *b, double dt, const double gravity[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    const double *rho = b->lines->rho;
    for (int i = 0; i < b->set.cells; i++) {
        const double per = dt / b->set.shapes->volume[b->set.body[i]] / rho[i];
        double gain[MAX_DIM] = {0};
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            if (b->set.kind[s.face] != BED_INNER) continue;
            const double l = rho[b->set.left[s.face]], q = rho[b->set.right[s.face]];
            const double rise = load_at(b, s.face, 1, gravity) - load_at(b, s.face, 0, gravity);
            const double over = s.right ? -q / (l + q) * rise : l / (l + q) * rise; /* p_f - P */
            for (int k = 0; k < b->dim; k++)
                gain[k] -= s.sign * per * b->set.shapes->area[s.shape] * over * b->set.shapes->normal[k][s.shape] *
                           bed_tilt(b, s.shape, i, k);
        }
        for (int k = 0; k < b->components; k++) r->drive[k][i] = k < b->dim ? gain[k] : dt * gravity[k];
    }
    bed_fill(b, b->components, r->drive);
}

/* ---- the yield stress ---- */

static double norm_of(const struct bed *b, const double *a) {
    double square = 0;
    for (int k = b->dim - 1; k >= 0; k--) square += a[k] * a[k];
    return sqrt(square);
}

struct load { /* on a face: the pressure on it; s times that; the lesser s and density of its cells */
    double p, carried, contact, light;
};
static double lightest(const struct bed *b, const struct face_view *v) {
    return smaller(b->lines->rho[v->left < 0 ? v->right : v->left], b->lines->rho[v->right < 0 ? v->left : v->right]);
}

/* The pressure is that with which the acoustics moves the cells, p_f (bed.h): at a free surface that of the lighter
 * side. With the larger P of both sides a steep front would hang on the packed gas behind it. */
static struct load load_of(const struct bed *b, const struct face_view *v, const double gravity[MAX_DIM]) {
    const int first = v->left < 0 ? v->right : v->left, last = v->right < 0 ? v->left : v->right;
    const double rho[2] = {b->lines->rho[first], b->lines->rho[last]};
    const double P[2] = {load_at(b, v->face, v->left < 0, gravity), load_at(b, v->face, v->right >= 0, gravity)};
    const double p = larger((rho[1] * P[0] + rho[0] * P[1]) / (rho[0] + rho[1]), 0);
    const double s[2] = {b->rub->share[first], b->rub->share[last]};
    return (struct load){p, larger(s[0], s[1]) * p, smaller(s[0], s[1]), lightest(b, v)};
}

/* Is a face on a wall that grains slip on before they yield? Grains do not cohere with it. */
static bool slips_at(const struct bed *b, int f) {
    return b->set.kind[f] == BED_WALL && b->set.wall_friction[f] < HUGE_VAL;
}

/* Returns the cohesion of the surface, by which a step of one cell stands. */
static double surface_cohesion(const struct bed *b, const struct face_view *v, const struct load *l,
                               const double gravity[MAX_DIM]) {
    const double step = l->light * norm_of(b, gravity) * v->depth;
    return step > 0 && l->light > COHERES * b->limit
               ? b->friction.params.surface_cohesion * step * larger(1 - l->p / (DEPTH * step), 0)
               : 0;
}

/* Returns Y of a face: s mu(I) P and cohesion, where both of its cells are packed. */
static double yield_of(const struct bed *b, const struct face_view *v, const double gravity[MAX_DIM], double strain) {
    const struct friction_params *f = &b->friction.params;
    const struct load l = load_of(b, v, gravity);
    double mu, inertia;
    if (!(l.carried > 0)) return 0;
    inertia = 2 * strain * b->friction.grain / sqrt(l.p);
    b->friction.law->coefficient(f, 1, &inertia, &mu);
    if (slips_at(b, v->face)) return smaller(mu, b->set.wall_friction[v->face]) * l.carried;
    return mu * l.carried + l.contact * f->cohesion + surface_cohesion(b, v, &l, gravity);
}

/* Freezes th and the coefficients of all faces, with the rates of strain of the velocity at the start. */
static void freeze(const struct bed *b, double dt, const double gravity[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    double most = 0;
    for (int i = 0; i < b->set.cells; i++) most = larger(most, r->share[i] * r->p[i]);
    comm_max(b->comm, &most, 1);
    const double modulus = 2 * b->friction.params.modulus * most * dt;
    for (int e = 0; e < r->faces; e++) {
        const int f = r->face[e];
        const struct face_view v = view_of(b, f);
        double D[TENSOR], T[TENSOR];
        strain_of(b, &v, b->lines->u, D);
        const double c = modulus * smaller(1, lightest(b, &v) / b->limit), Y = yield_of(b, &v, gravity, size_of(b, D));
        for (int i = 0; i < r->tensors; i++) T[i] = b->set.stress[i][f] + c * D[i];
        const double size = size_of(b, T), part = !(Y > 0) ? 0 : size > Y ? Y / size : 1;
        r->part[f] = part;
        r->stiff[f] = part * c;
        r->bears[f] = Y;
        for (int i = 0; i < r->tensors; i++) r->base[i][f] = part * b->set.stress[i][f];
    }
}

/* ---- the stages ---- */

/* Lists the faces with friction. */
static void list_faces(const struct bed *b) {
    struct bed_friction *r = b->rub;
    r->faces = 0;
    for (int f = 0; f < b->set.faces; f++) {
        const int l = b->set.left[f], q = b->set.right[f];
        r->part[f] = r->stiff[f] = r->bears[f] = 0;
        if (r->hoop) r->hoop[f] = 0;
        for (int i = 0; i < LINES && r->hoop; i++) r->through[i][b->components][f] = 0;
        for (int k = 0; k < b->components; k++) {
            r->traction[k][f] = 0;
            for (int i = 0; i < LINES; i++) r->through[i][k][f] = 0;
        }
        for (int i = 0; i < r->tensors && !b->set.shapes->boxes; i++) {
            r->tensor[i][f] = 0;
            for (int j = 0; j < LINES; j++) r->mean[j][i][f] = 0;
        }
        if (bed_rubs_at(b, f) && ((l >= 0 && r->share[l] > 0) || (q >= 0 && r->share[q] > 0))) r->face[r->faces++] = f;
    }
}

/* Returns what the hoop component adds to a cell's sum of A/d by one of its sides. */
static double hoop_rate(const struct bed *b, const struct bed_side *s, const struct face_view *v, int i) {
    const struct bed_shapes *h = b->set.shapes;
    if (!h->round) return 0;
    if (h->boxes) return hoop_instead(b, i) * hoop_share(b, s->shape, s->right, i) / h->round->radius[b->set.body[i]];
    return h->round->flat[s->shape] * h->round->flat[s->shape] / h->area[s->shape] * v->depth / b->dim;
}

/* Returns the largest rate of a cell times dt. */
static double find_rate(const struct bed *b, double dt) {
    const struct bed_friction *r = b->rub;
    const double safe = b->set.shapes->boxes ? SAFE : SAFE_ASKEW;
    double most = 0;
    for (int i = 0; i < b->set.cells; i++) {
        double sum = 0;
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            if (r->stiff[s.face] == 0) continue;
            const struct face_view v = view_of(b, s.face);
            sum += 4. / 3 * b->set.shapes->area[s.shape] * r->stiff[s.face] / v.depth;
            if (r->hoop) sum += 4. / 3 * r->stiff[s.face] * hoop_rate(b, &s, &v, i);
        }
        most = larger(most, safe * sum * dt / (b->lines->rho[i] * b->set.shapes->volume[b->set.body[i]]));
    }
    comm_max(b->comm, &most, 1);
    return most;
}

ALWAYS_INLINE void tractions_with(const struct bed *b, double *const *V, struct sizes n) {
    const struct bed_friction *r = b->rub;
    const int tensors = n.components * (n.components + 1) / 2;
    for (int e = 0; e < r->faces; e++) {
        const int f = r->face[e];
        double D[TENSOR], t[MAX_DIM];
        if (r->part[f] == 0) continue;
        const struct face_view v = bed_view(b, f, n.dim);
        strain_with(b, &v, V, n, D);
        for (int i = 0; i < tensors; i++) D[i] = r->base[i][f] + r->stiff[f] * D[i];
        apply(n, D, v.n, t);
        for (int k = 0; k < n.components; k++) r->traction[k][f] = t[k];
        if (n.dim == 2 && n.components == 2 && r->hoop) r->hoop[f] = -(D[0] + D[2]);
        for (int i = 0; i < tensors && !b->set.shapes->boxes; i++) r->tensor[i][f] = D[i];
    }
}

/* Finds the tractions for V, whose gradients are known. */
static void find_tractions(const struct bed *b, double *const *V) {
    WITH_SIZES(tractions_with, b, V)
    if (!b->set.shapes->boxes) bed_find_pull(b);
}

struct combined { /* gain = before[0] of the last stage, before[1] of that before, now times dt div tau/rho */
    double last, older, now;
};

/* Moves what acts through faces on by a stage: stresses on them, and tractions of walls, on other meshes than boxes
 * also of those that slip. */
static void find_through(const struct bed *b, int j, struct combined c) {
    const struct bed_friction *r = b->rub;
    const bool boxes = b->set.shapes->boxes, heats = b->friction.params.heating > 0;
    const int now = j % LINES, last = (j + LINES - 1) % LINES, older = (j + LINES - 2) % LINES;
    for (int f = 0; f < b->set.faces; f++) {
        const bool wall = b->set.kind[f] == BED_WALL;
        double t[MAX_DIM];
        if (!(wall || (heats && b->set.kind[f] == BED_INNER))) continue;
        for (int i = 0; i < r->tensors && !boxes; i++)
            r->mean[now][i][f] =
                c.last * r->mean[last][i][f] + c.older * r->mean[older][i][f] + c.now * r->tensor[i][f];
        for (int k = 0; k < b->components; k++) t[k] = r->traction[k][f];
        if (wall && !boxes) bed_wall_pull(b, f, t);
        for (int k = 0; k < b->components; k++)
            r->through[now][k][f] = c.last * r->through[last][k][f] + c.older * r->through[older][k][f] + c.now * t[k];
        if (r->hoop)
            r->through[now][b->components][f] = c.last * r->through[last][b->components][f] +
                                                c.older * r->through[older][b->components][f] + c.now * r->hoop[f];
    }
}

/* Finds the gain of stage j by friction, in lines j mod LINES. */
static void find_gains(const struct bed *b, double dt, int j, struct combined c) {
    const struct bed_friction *r = b->rub;
    double *const *to = r->gain[j % LINES], *const *one = r->gain[(j + LINES - 1) % LINES],
                  *const *two = r->gain[(j + LINES - 2) % LINES];
    for (int i = 0; i < b->set.cells; i++) {
        double sum[MAX_DIM] = {0}, hoop = 0;
        if (!b->set.shapes->boxes) bed_pull(b, i, sum);
        for (int e = b->set.face_start[i]; e < b->set.face_start[i + 1] && b->set.shapes->boxes; e++) {
            const struct bed_side s = bed_side(b, e);
            if (r->part[s.face] == 0) continue;
            for (int k = 0; k < b->components; k++)
                sum[k] += s.sign * b->set.shapes->area[s.shape] * r->traction[k][s.face];
            if (r->hoop) hoop += hoop_share(b, s.shape, s.right, i) * r->hoop[s.face];
        }
        if (hoop != 0) sum[b->set.shapes->round->radial] -= hoop_instead(b, i) * hoop;
        const double per = c.now * dt / (b->lines->rho[i] * b->set.shapes->volume[b->set.body[i]]);
        for (int k = 0; k < b->components; k++) to[k][i] = c.last * one[k][i] + c.older * two[k][i] + per * sum[k];
    }
    find_through(b, j, c);
}

static void find_velocity(const struct bed *b, double fallen, double *const *gain) {
    const struct bed_friction *r = b->rub;
    for (int k = 0; k < b->components; k++)
        for (int i = 0; i < b->set.cells; i++) r->V[k][i] = b->lines->u[k][i] + fallen * r->drive[k][i] + gain[k][i];
}

/* Solves for V; returns which lines of gain hold the result, -1: that takes too many stages. With T_j Chebyshev's
 * polynomials, T_s(w) = DAMPED and z = -rate/s'th, stage j has the polynomial T_j(w + w1 z)/T_j(w), w1 =
 * T_s(w)/T_s'(w). */
static int solve(const struct bed *b, double dt, double rate) {
    const struct bed_friction *r = b->rub;
    const double root = sqrt(DAMPED * DAMPED - 1), log_damped = logarithm(DAMPED + root);
    int stages = 1;
    double w, w1;
    do {
        if (stages == MOST_STAGES) return -1;
        const double m = exponential_minus_one(log_damped / ++stages); /* libm's cosh has other bits at -O0 */
        w = 1 + 0.5 * (m * m / (1 + m));
        w1 = DAMPED * (0.5 * (m + m / (1 + m))) / (stages * root);
    } while ((w + 1) / w1 < rate);
    double T[3] = {0, 1, w}, fallen[3] = {0, 0, w1 / w};
    for (int k = 0; k < b->components; k++)
        for (int i = 0; i < LINES; i++) memset(r->gain[i][k], 0, (size_t)b->set.cells * sizeof(double));
    for (int j = 1; j <= stages; j++) {
        struct combined c = {1, 0, w1 / w};
        if (j > 1) {
            const double next = 2 * w * T[2] - T[1];
            c = (struct combined){2 * w * T[2] / next, -T[1] / next, 2 * w1 * T[2] / next};
            const double now = c.last * fallen[2] + c.older * fallen[1] + c.now;
            T[1] = T[2];
            T[2] = next;
            fallen[1] = fallen[2];
            fallen[2] = now;
        }
        find_velocity(b, j > 1 ? fallen[1] : 0, r->gain[(j + LINES - 1) % LINES]);
        bed_find_gradients(b, r->V);
        find_tractions(b, r->V);
        find_gains(b, dt, j, c);
    }
    return stages % LINES;
}

/* ---- the results ---- */

/* A cell is held as far as none of its faces yields. */
static void find_held(const struct bed *b) {
    const struct bed_friction *r = b->rub;
    for (int i = 0; i < b->set.cells; i++) {
        double least = 2;
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            if (r->part[s.face] > 0) least = smaller(least, r->part[s.face]);
        }
        r->held[i] = least > 1 ? 0 : least;
    }
    bed_fill(b, 1, &r->held);
}

static double mean_at(const struct bed *b, int f, double *const *of) {
    const int l = b->set.left[f], q = b->set.right[f], shape = b->set.shape[f];
    const double rho_l = b->lines->rho[l], rho_r = b->lines->rho[q];
    return (rho_l * bed_normal_speed(b, of, l, shape) + rho_r * bed_normal_speed(b, of, q, shape)) / (rho_l + rho_r);
}

static void find_push(const struct bed *b, double dt, const double gravity[MAX_DIM], double *const *gain) {
    const struct bed_friction *r = b->rub;
    const double *rho = b->lines->rho;
    for (int f = 0; f < b->set.faces; f++) {
        b->lines->push[f] = 0;
        if (b->set.kind[f] != BED_INNER) continue;
        const int l = b->set.left[f], q = b->set.right[f];
        const double held = (rho[l] * r->held[l] + rho[q] * r->held[q]) / (rho[l] + rho[q]);
        b->lines->push[f] = mean_at(b, f, gain);
        if (!(held > 0)) continue;
        const int shape = b->set.shape[f];
        const double lacks = held * (mean_at(b, f, r->drive) - fall_of_face(b, f, dt, gravity)),
                     most =
                         dt * r->bears[f] /
                         (0.5 * (rho[l] + rho[q]) * (b->set.shapes->depth[0][shape] + b->set.shapes->depth[1][shape]));
        b->lines->push[f] += larger(-most, smaller(lacks, most));
    }
}

void bed_move_stress(struct bed *b, const double gravity[MAX_DIM]) { /* tau' for V, no more than it may be */
    const struct bed_friction *r = b->rub;
    if (!r) return;
    for (int i = 0; i < r->tensors; i++)
        for (int f = 0; f < b->set.faces; f++)
            if (r->part[f] == 0) b->set.stress[i][f] = 0;
    for (int e = 0; e < r->faces; e++) {
        const int f = r->face[e];
        double D[TENSOR];
        if (r->part[f] == 0) continue;
        const struct face_view v = view_of(b, f);
        strain_of(b, &v, r->V, D);
        const double Y = yield_of(b, &v, gravity, size_of(b, D));
        for (int i = 0; i < r->tensors; i++) D[i] = r->base[i][f] + r->stiff[f] * D[i];
        const double size = size_of(b, D), part = size > Y ? Y / size : 1;
        for (int i = 0; i < r->tensors; i++) b->set.stress[i][f] = part * D[i];
    }
}

/* Returns g h of a cell, h its extent along gravity. */
static double fall_of_cell(const struct bed *b, int i, const double gravity[MAX_DIM]) {
    double low = 0, high = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double at = bed_along(b, b->set.shapes->arm[s.right], s.shape, gravity);
        low = smaller(low, at);
        high = larger(high, at);
    }
    return high - low;
}

static void find_state(const struct bed *b, const double gravity[MAX_DIM]) {
    const struct bed_friction *r = b->rub;
    const int all = b->set.cells + b->set.ghosts;
    const double per_eps = b->material->disks ? 1 : 2. / 3;
    for (int i = 0; i < b->set.cells; i++) r->p[i] = b->set.pressure[i] > 0 ? b->set.pressure[i] : b->lines->p[i];
    bed_fill(b, 1, &r->p);
    for (int at = 0; at < all; at += BATCH)
        friction_share(&b->friction.params, b->material, all - at < BATCH ? all - at : BATCH, b->lines->rho + at,
                       r->share + at);
    for (int i = 0; i < b->set.cells; i++) {
        const double fall = fall_of_cell(b, i, gravity), T = per_eps * b->lines->eps[i];
        r->share[i] = larger(r->share[i], lying_share(T, fall, b->lines->rho[i] / b->limit));
    }
    bed_fill(b, 1, &r->share);
}

static void find_end(const struct bed *b) { /* the velocity V that friction leaves, and its gradients */
    find_velocity(b, 1, b->rub->gain[b->rub->last]);
    bed_find_gradients(b, b->rub->V);
}

status bed_rub(struct bed *b, double dt, const double gravity[MAX_DIM], bool driven, bool *done) {
    struct bed_friction *r = b->rub;
    *done = true;
    if (!r) return OK;
    TRY(comm_agree(b->comm, bed_friction_room(b, r)));
    find_state(b, gravity);
    list_faces(b);
    for (int i = 0; i < b->set.cells; i++) bed_fit_cell(b, i);
    if (!b->set.shapes->boxes) {
        bed_fill(b, bed_tensors(b->dim), r->inverse);
        bed_weigh_askew(b);
    }
    if (driven)
        find_drive(b, dt, gravity);
    else
        for (int k = 0; k < b->components; k++)
            memset(r->drive[k], 0, (size_t)(b->set.cells + b->set.ghosts) * sizeof(double));
    bed_find_gradients(b, b->lines->u);
    freeze(b, dt, gravity);
    const int last = solve(b, dt, find_rate(b, dt));
    *done = last >= 0;
    r->last = last;
    if (!*done) return OK;
    find_end(b);
    if (driven || b->friction.params.heating > 0) bed_fill(b, b->components, r->gain[last]);
    if (driven) {
        find_held(b);
        find_push(b, dt, gravity, r->gain[last]);
    }
    for (int k = 0; k < b->components; k++) {
        memcpy(b->lines->rubbed[k], r->gain[last][k], (size_t)(b->set.cells + b->set.ghosts) * sizeof(double));
        memcpy(b->lines->traction[k], r->through[last][k], (size_t)b->set.faces * sizeof(double));
    }
    return OK;
}

void bed_find_work(const struct bed *b, double *const *end) {
    const struct bed_friction *r = b->rub;
    const int missing = (b->material->disks ? 2 : 3) - b->components;
    if (b->set.shapes->boxes || b->friction.params.heating == 0) return;
    for (int k = 0; k < b->components; k++)
        for (int i = 0; i < b->set.cells; i++) r->V[k][i] = 0.5 * (b->lines->u[k][i] + end[k][i]);
    bed_find_gradients(b, r->V);
    memset(r->tensor[0], 0, (size_t)b->set.faces * sizeof(double));
    for (int e = 0; e < r->faces; e++) {
        const int f = r->face[e];
        const struct face_view v = view_of(b, f);
        double D[TENSOR], work = 0, trace[2] = {0};
        strain_of(b, &v, r->V, D);
        for (int i = 0, at = 0; i < b->components; i++)
            for (int j = i; j < b->components; j++, at++) {
                work += (i == j ? 1 : 2) * r->mean[r->last][at][f] * D[at];
                trace[0] += i == j ? r->mean[r->last][at][f] : 0;
                trace[1] += i == j ? D[at] : 0;
            }
        if (missing > 0) work += trace[0] * trace[1] / missing;
        r->tensor[0][f] = b->set.shapes->area[v.shape] * v.depth / b->dim * work;
    }
    find_end(b); /* for bed_move_stress */
}

double bed_warms(const struct bed *b, double dt, int i, double *const *end, double more) {
    const struct bed_lines *x = b->lines;
    double sum = 0;
    if (b->friction.params.heating == 0) return 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const int other = bed_across(b, &s);
        const double area = b->set.shapes->area[s.shape];
        if (!bed_rubs_at(b, s.face)) continue;
        if (!b->set.shapes->boxes) sum += (other < 0 ? 1 : 0.5) * b->rub->tensor[0][s.face];
        for (int k = 0; k < b->components && b->set.shapes->boxes; k++) {
            const double mine = 0.5 * (x->u[k][i] + end[k][i]);
            const double slips =
                other < 0 ? b->set.wall_speed[k][s.face] - mine : 0.5 * (0.5 * (x->u[k][other] + end[k][other]) - mine);
            sum += s.sign * area * x->traction[k][s.face] * slips;
        }
        if (b->set.shapes->boxes && b->rub->hoop) {
            const int k = b->set.shapes->round->radial;
            sum += hoop_instead(b, i) * hoop_share(b, s.shape, s.right, i) *
                   b->rub->through[b->rub->last][b->components][s.face] * 0.5 * (x->u[k][i] + end[k][i]);
        }
    }
    return b->friction.params.heating * larger(dt / b->set.shapes->volume[b->set.body[i]] * sum + more, 0);
}

/* Returns the energy (J/m^3) that friction gives to a cell whose velocity it changes alone, over dt. */
static double rub_cell(const struct bed *b, double dt, int i) {
    const struct bed_lines *x = b->lines;
    const int last = b->components + 1;
    double work = 0;
    for (int k = b->components - 1; k >= 0; k--) {
        work += x->rubbed[k][i] * (x->u[k][i] + 0.5 * x->rubbed[k][i]);
        b->set.U[k + 1][i] += x->rho[i] * x->rubbed[k][i];
    }
    work *= x->rho[i];
    const double heat = bed_warms(b, dt, i, b->rub->V, 0);
    b->set.U[last][i] += work + heat;
    return work + heat;
}

status bed_rub_alone(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done) {
    const struct bed_lines *x = b->lines;
    TRY(bed_ready(b));
    TRY(bed_rub(b, dt, gravity, false, done));
    if (!*done) return OK;
    for (int k = 0; k < b->components; k++)
        for (int i = 0; i < b->set.cells + b->set.ghosts; i++) x->after[k + 1][i] = x->u[k][i] + x->rubbed[k][i];
    bed_find_work(b, x->after + 1);
    for (int block = 0; block < b->set.blocks; block++) {
        b->set.lift[block] = b->set.work[block] = b->set.peak[block] = b->set.rubbed[block] = 0;
        b->set.peak_cell[block] = 0;
        for (int i = b->set.first[block]; i < b->set.first[block + 1]; i++)
            b->set.rubbed[block] += b->set.shapes->volume[b->set.body[i]] * rub_cell(b, dt, i);
    }
    for (int v = 0; v < b->components + 2; v++) memset(b->set.kept[v], 0, (size_t)b->set.faces * sizeof(double));
    bed_add_tractions(b);
    memcpy(b->set.pressure, x->p, (size_t)b->set.cells * sizeof(double));
    bed_move_stress(b, gravity);
    bed_deal_results(b);
    return OK;
}
