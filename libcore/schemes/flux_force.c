/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The centred fluxes of Shakeri et al. (their (4.7)-(4.9); docs/physics.md 6.7): FORCE, and MUSTA, which begins with
 * it.
 *
 * FORCE (Toro 1996) is the mean of the fluxes of Lax & Friedrichs and of Lax & Wendroff (two-step) of a face's states,
 *     F = (f_l + f_r + 2 f(U*) - (U_r - U_l)/k)/4,  U* = (U_l + U_r)/2 - k/2 (f_r - f_l),  k = dt/dx.
 * (In print the last term has k for 1/k, which is no such mean and has no dimension of a flux: docs/physics.md H2.) It
 * asks for no waves; a wave of speed s is damped as by the speed s (1 + nu^2)/(2 nu), nu = s k: no less than upwinding
 * does, and the more the shorter the step is. MUSTA (Titarev & Toro 2004) goes on as if the two states were two cells,
 *     U_l -= k (F - f_l),  U_r -= k (f_r - F),
 * with F of the new states, until F changes by less than `tolerance` of itself, at most `stages` times: the waves leave
 * the face, both states become the one between them, and F becomes Godunov's flux.
 *
 * dt is that of the Runge-Kutta step, and k is no more than 1/s, s the larger |u| + c of both states: beyond nu = 1 the
 * part of Lax & Wendroff amplifies; there F damps as Rusanov's. Where U* is not admissible F is that of Lax &
 * Friedrichs, and states that would no longer be so are not advanced. U_l and U_r are reconstructed from rho, u and T.
 * On a lattice, whose cells hold values at their centres, F gets besides what the reconstructions of the nodal fluxes
 * differ by from f_l and f_r (force_add): without that it would be of second order. At first order, and on polyhedra
 * with their Gauss points, there is no such difference. */
#include "libcore/schemes/flux_private.h"

struct riemann {                                       /* the states on both sides of n faces, left (0) and right (1) */
    int n, dim;                                        /* dim: components of u */
    double U[2][MAX_VAR][BATCH], f[2][MAX_VAR][BATCH]; /* conserved variables; physical fluxes less `base` */
    double F[MAX_VAR][BATCH];                          /* the flux of FORCE less `middle` */
    double pace[BATCH], inverse[BATCH], fastest[BATCH]; /* k, 1/k, s */
    double base[2][BATCH], middle[BATCH];               /* pressures of force_bases; their mean */
    struct face_states s[2];
};

/* U = (rho, rho u .., rho (eps + u^2/2)) */
KERNEL static void force_conserved(int n, int dim, const struct face_states *restrict s, double (*restrict U)[BATCH]) {
    for (int i = 0; i < n; i++) {
        double across = 0;
        for (int k = dim - 1; k > 0; k--) across += s->u[k][i] * s->u[k][i];
        U[0][i] = s->rho[i];
        U[dim + 1][i] = s->rho[i] * (s->eps[i] + 0.5 * (s->u[0][i] * s->u[0][i] + across));
    }
    for (int k = 0; k < dim; k++)
        for (int i = 0; i < n; i++) U[k + 1][i] = s->rho[i] * s->u[k][i];
}

/* The state of U; where it is not admissible `good` is 0, and the state is that of `instead`. */
KERNEL static void force_state(int n, int dim, double limit, const double (*restrict U)[BATCH],
                               const struct face_states *restrict instead, struct face_states *restrict s) {
    for (int i = 0; i < n; i++) {
        double inverse = 1 / U[0][i], u = U[1][i] * inverse, across = 0;
        for (int k = dim - 1; k > 0; k--) across += (U[k + 1][i] * inverse) * (U[k + 1][i] * inverse);
        double eps = U[dim + 1][i] * inverse - 0.5 * (u * u + across);
        bool good = U[0][i] > 0 && U[0][i] < limit && eps > 0;
        s->rho[i] = good ? U[0][i] : instead->rho[i];
        s->eps[i] = good ? eps : instead->eps[i];
        s->good[i] = good ? 1 : 0;
        for (int k = 0; k < dim; k++) s->u[k][i] = good ? U[k + 1][i] * inverse : instead->u[k][i];
    }
}

/* f = u_n U + p (0, 1, 0 .., u_n), less the pressure `base` */
KERNEL static void force_nodal(int n, int dim, const double (*restrict U)[BATCH], const struct face_states *restrict s,
                               const double *restrict base, double (*restrict f)[BATCH]) {
    const double *restrict u = s->u[0], *restrict p = s->p;
    for (int i = 0; i < n; i++) f[0][i] = U[1][i];
    for (int i = 0; i < n; i++) f[1][i] = U[1][i] * u[i] + (p[i] - base[i]);
    for (int k = 1; k < dim; k++)
        for (int i = 0; i < n; i++) f[k + 1][i] = U[k + 1][i] * u[i];
    for (int i = 0; i < n; i++) f[dim + 1][i] = (U[dim + 1][i] + p[i]) * u[i];
}

/* U* of one variable. */
KERNEL static void force_middle(int n, const double *restrict pace, const double *restrict ul,
                                const double *restrict ur, const double *restrict fl, const double *restrict fr,
                                double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = 0.5 * (ul[i] + ur[i]) - 0.5 * pace[i] * (fr[i] - fl[i]);
}

/* F of variable v; good: is U* admissible? */
KERNEL static void force_mean(const struct riemann *x, int v, const double *restrict good,
                              const double *restrict middle, double *restrict out) {
    const double *restrict ul = x->U[0][v], *restrict ur = x->U[1][v];
    const double *restrict fl = x->f[0][v], *restrict fr = x->f[1][v], *restrict inverse = x->inverse;
    const int n = x->n;
    for (int i = 0; i < n; i++) {
        double both = fl[i] + fr[i], jump = inverse[i] * (ur[i] - ul[i]);
        out[i] = good[i] > 0 ? 0.25 * (both + 2 * middle[i] - jump) : 0.5 * (both - jump);
    }
}

/* Sets s, k and 1/k of each face. */
KERNEL static void force_pace(int n, const double *restrict given, const struct face_states *restrict left,
                              const struct face_states *restrict right, double *restrict fastest, double *restrict pace,
                              double *restrict inverse) {
    for (int i = 0; i < n; i++) {
        fastest[i] = larger(fabs(left->u[0][i]) + sqrt(left->c[i]), fabs(right->u[0][i]) + sqrt(right->c[i]));
        pace[i] = smaller(given[i], 1 / fastest[i]);
        inverse[i] = 1 / pace[i];
    }
}

/* F of the states on both sides. */
static void force_flux(struct riemann *x, const struct eos *eos, const struct material *m, double (*F)[BATCH]) {
    const int n = x->n, nvar = x->dim + 2;
    struct face_states s;
    double U[MAX_VAR][BATCH], f[MAX_VAR][BATCH];
    for (int v = 0; v < nvar; v++) force_middle(n, x->pace, x->U[0][v], x->U[1][v], x->f[0][v], x->f[1][v], U[v]);
    force_state(n, x->dim, density_limit(eos, m), (const double(*)[BATCH])U, &x->s[0], &s);
    eos->state(m, n, s.rho, s.eps, s.p, s.c, s.gruneisen);
    force_nodal(n, x->dim, (const double(*)[BATCH])U, &s, x->middle, f);
    for (int v = 0; v < nvar; v++) force_mean(x, v, s.good, f[v], F[v]);
}

/* Are the states of face i reconstructed? */
ALWAYS_INLINE bool is_reconstructed(const struct faces *f, const struct reconstruct *r, int i) {
    return r->reach > 0 && !(f->flat && f->flat[i] > 0);
}

/* The pressure of gas at rest that is taken from the fluxes of momentum of both sides: on the face, where the states
 * are reconstructed to it, else in the cells. */
static void force_bases(const struct faces *f, const struct reconstruct *r, struct riemann *x) {
    for (int i = 0; i < f->n; i++) {
        for (int side = 0; side < 2; side++)
            x->base[side][i] = !f->rise ? 0 : is_reconstructed(f, r, i) ? f->rest[i] : f->base[side][i];
        x->middle[i] = 0.5 * (x->base[0][i] + x->base[1][i]);
    }
}

/* Reconstructs the states of the faces f, with F. */
static void force_begin(const struct faces *f, const struct eos *eos, const struct material *m,
                        const struct reconstruct *r, struct riemann *x) {
    x->n = f->n;
    x->dim = f->dim;
    force_bases(f, r, x);
    for (int side = 0; side < 2; side++) {
        flux_sided_states(f, eos, m, side ? -1 : 1, r, &x->s[side]);
        force_conserved(f->n, f->dim, &x->s[side], x->U[side]);
        force_nodal(f->n, f->dim, (const double(*)[BATCH])x->U[side], &x->s[side], x->base[side], x->f[side]);
    }
    force_pace(f->n, f->pace, &x->s[0], &x->s[1], x->fastest, x->pace, x->inverse);
    force_flux(x, eos, m, x->F);
}

/* Adds to one variable of the flux the correction of high order, of both sides' differences between reconstructed nodal
 * fluxes and fluxes of reconstructed states the lesser, where they differ by less than that. Where the flow is smooth
 * they differ by the error of the reconstruction alone; at shocks the mean of both would make the flow overshoot. */
KERNEL static void force_add(int n, const double *restrict left, const double *restrict right,
                             const double *restrict fl, const double *restrict fr, double *restrict F) {
    for (int i = 0; i < n; i++) {
        double a = left[i] - fl[i], b = right[i] - fr[i], least = fabs(a) < fabs(b) ? a : b;
        F[i] += fabs(a - b) < fabs(least) ? least : 0;
    }
}

/* Writes F to the faces, at high order on a lattice where states are reconstructed. first: the fluxes of the
 * reconstructed states */
static void force_end(const struct faces *f, const struct reconstruct *r, const struct riemann *x,
                      double (*const first[2])[BATCH]) {
    double balanced[6][BATCH], left[BATCH], right[BATCH];
    if (f->rise && r->reach) faces_take_rest(f, f->flux[1], balanced);
    for (int v = 0; v < f->dim + 2; v++) {
        const double *cell[6], *back[5];
        memcpy(f->out[v], x->F[v], (size_t)f->n * sizeof(double));
        if (r->reach == 0) continue;
        for (int k = 0; k < 6; k++) cell[k] = f->rise && v == 1 ? balanced[k] : f->flux[v] + (k - 2) * f->stride;
        for (int k = 0; k < 5; k++) back[k] = cell[5 - k];
        r->face(f->n, cell, left);
        r->face(f->n, back, right);
        force_add(f->n, left, right, first[0][v], first[1][v], f->out[v]);
        for (int i = 0; i < f->n && f->flat; i++)
            if (!is_reconstructed(f, r, i)) f->out[v][i] = x->F[v][i];
    }
}

void flux_force(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r) {
    struct riemann x;
    force_begin(f, eos, m, r, &x);
    force_end(f, r, &x, (double(*const[])[BATCH]){x.f[0], x.f[1]});
}

/* U -= side k (F - f) of one variable of the states on one side. */
KERNEL static void musta_move(int n, double side, const double *restrict pace, const double *restrict F,
                              const double *restrict f, double *restrict U) {
    for (int i = 0; i < n; i++) U[i] -= side * pace[i] * (F[i] - f[i]);
}

/* Faces whose states are not admissible do not go on. */
KERNEL static void musta_admit(int n, const double *restrict good, double *restrict going) {
    for (int i = 0; i < n; i++) going[i] *= good[i];
}

/* Advances the states on both sides. */
static void musta_advance(struct riemann *x, const struct eos *eos, const struct material *m, double *going) {
    for (int side = 0; side < 2; side++) {
        struct face_states s;
        for (int v = 0; v < x->dim + 2; v++)
            musta_move(x->n, side ? -1 : 1, x->pace, x->F[v], x->f[side][v], x->U[side][v]);
        force_state(x->n, x->dim, density_limit(eos, m), (const double(*)[BATCH])x->U[side], &x->s[side], &s);
        eos->state(m, x->n, s.rho, s.eps, s.p, s.c, s.gruneisen);
        force_nodal(x->n, x->dim, (const double(*)[BATCH])x->U[side], &s, x->base[side], x->f[side]);
        musta_admit(x->n, s.good, going);
    }
}

/* Takes the flux `next` of the faces that go on. They go on until the change of F is less than `tolerance` of F, in
 * the largest of (F_rho s^2, F_u s, F_E). Returns whether any goes on. */
KERNEL static bool musta_take(struct riemann *restrict x, double tolerance, const double (*restrict next)[BATCH],
                              double *restrict going) {
    const int last = x->dim + 1;
    bool any = false;
    for (int i = 0; i < x->n; i++) {
        const double s = x->fastest[i];
        double change = 0, size = fabs(next[1][i] + x->middle[i]) * s;
        for (int v = 0; v <= last; v++) {
            const double unit = v == 0 ? s * s : v < last ? s : 1;
            change = larger(change, fabs(next[v][i] - x->F[v][i]) * unit);
            if (v != 1) size = larger(size, fabs(next[v][i]) * unit);
            x->F[v][i] = going[i] > 0 ? next[v][i] : x->F[v][i];
        }
        going[i] = change < tolerance * size ? 0 : going[i];
        any |= going[i] > 0;
    }
    return any;
}

void flux_musta(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r) {
    struct musta own;
    struct riemann x;
    double first[2][MAX_VAR][BATCH], next[MAX_VAR][BATCH], going[BATCH];
    memcpy(&own, f->params, sizeof own);
    force_begin(f, eos, m, r, &x);
    memcpy(first, x.f, sizeof first);
    for (int i = 0; i < x.n; i++) going[i] = 1;
    for (int stage = 0; stage < own.stages; stage++) {
        musta_advance(&x, eos, m, going);
        force_flux(&x, eos, m, next);
        if (!musta_take(&x, own.tolerance, (const double(*)[BATCH])next, going)) break;
    }
    force_end(f, r, &x, (double(*const[])[BATCH]){first[0], first[1]});
}
