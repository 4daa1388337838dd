#include "libcore/flux.h"

/* Characteristic fluxes in the form of Shu & Osher: project the nodal fluxes (and, where a field is split, the states)
 * of the stencil on an eigenbasis of the face, reconstruct each field from its upwind side, project back. The fluxes
 * below differ in the basis and in which fields are split. */

enum { STENCIL = 6, HOME = 2 }; /* cells of a stencil; index of the left cell */
enum { MINUS, ENTROPY, PLUS, FAMILIES };
#define UPWIND_LEFT  (-1.)
#define UPWIND_RIGHT (-2.)

struct bases { /* eigenbases of n faces, as lines */
    double u[MAX_DIM][BATCH], c[BATCH], h[BATCH], b1[BATCH];
    double b2[BATCH], half_inverse_c[BATCH], inverse_b1[BATCH];
};
struct fields { /* stencils projected on the fields: u - c, entropy, shears, u + c */
    double line[MAX_VAR][STENCIL][BATCH];
};
struct winds { /* per family: UPWIND_LEFT, UPWIND_RIGHT, or the speed alpha >= 0 of a Lax-Friedrichs split */
    double speed[FAMILIES][BATCH];
    bool left[FAMILIES], right[FAMILIES], split[FAMILIES]; /* does any face of the batch have it? */
};

static int family(int field, int dim) {
    return field == 0 ? MINUS : field == dim + 1 ? PLUS : ENTROPY;
}

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* With s = (b2 q0 - b1 (u.q - q_E))/2 and d = (q_n - u_n q0)/(2c), the rows of L (physics 1.1) are
 *   l_- q = s - d,  l_0 q = q0 - 2 s,  l_j q = q_j - u_j q0,  l_+ q = s + d. */
ALWAYS_INLINE void project_dim(int n, const int dim, const double *const q[MAX_VAR], long offset,
                               const struct bases *restrict b, double (*restrict out)[STENCIL][BATCH], int m) {
    const double *restrict q0 = q[0] + offset, *restrict qn = q[1] + offset, *restrict qe = q[dim + 1] + offset;
    const double *restrict q2 = dim > 1 ? q[2] + offset : q0, *restrict q3 = dim > 2 ? q[3] + offset : q0;
    for (int i = 0; i < n; i++) {
        double t = 0;
        if (dim > 1) t = b->u[1][i] * q2[i];
        if (dim > 2) t += b->u[2][i] * q3[i];
        double s = 0.5 * (b->b2[i] * q0[i] - b->b1[i] * (b->u[0][i] * qn[i] + t - qe[i]));
        double d = (qn[i] - b->u[0][i] * q0[i]) * b->half_inverse_c[i];
        out[0][m][i] = s - d;
        out[1][m][i] = q0[i] - 2 * s;
        if (dim > 1) out[2][m][i] = q2[i] - b->u[1][i] * q0[i];
        if (dim > 2) out[3][m][i] = q3[i] - b->u[2][i] * q0[i];
        out[dim + 1][m][i] = s + d;
    }
}

KERNEL static void project(int n, int dim, const double *const q[MAX_VAR], long stride, int reach,
                           const struct bases *b, struct fields *out) {
    for (int m = HOME - reach; m <= HOME + 1 + reach; m++) {
        long offset = (m - HOME) * stride;
        if (dim == 1) project_dim(n, 1, q, offset, b, out->line, m);
        if (dim == 2) project_dim(n, 2, q, offset, b, out->line, m);
        if (dim == 3) project_dim(n, 3, q, offset, b, out->line, m);
    }
}

/* The columns of R: F += sum over fields of amplitude times r. */
ALWAYS_INLINE void back_dim(int n, const int dim, const struct bases *restrict b, double (*restrict a)[BATCH], bool add,
                            double *const out[MAX_VAR]) {
    double *restrict f0 = out[0], *restrict fn = out[1], *restrict fe = out[dim + 1];
    double *restrict f2 = dim > 1 ? out[2] : f0, *restrict f3 = dim > 2 ? out[3] : f0;
    for (int i = 0; i < n; i++) {
        double acoustic = a[0][i] + a[dim + 1][i], sum = acoustic + a[1][i];
        double swing = b->c[i] * (a[dim + 1][i] - a[0][i]), t = 0;
        double r0 = sum, rn = b->u[0][i] * sum + swing, r2 = 0, r3 = 0;
        if (dim > 1) r2 = b->u[1][i] * sum + a[2][i];
        if (dim > 2) r3 = b->u[2][i] * sum + a[3][i];
        if (dim > 1) t = b->u[1][i] * a[2][i];
        if (dim > 2) t += b->u[2][i] * a[3][i];
        double re = b->h[i] * sum - b->inverse_b1[i] * a[1][i] + b->u[0][i] * swing + t;
        f0[i] = add ? f0[i] + r0 : r0;
        fn[i] = add ? fn[i] + rn : rn;
        if (dim > 1) f2[i] = add ? f2[i] + r2 : r2;
        if (dim > 2) f3[i] = add ? f3[i] + r3 : r3;
        fe[i] = add ? fe[i] + re : re;
    }
}

KERNEL static void project_back(int n, int dim, const struct bases *b, double (*a)[BATCH], bool add,
                                double *const out[MAX_VAR]) {
    if (dim == 1 && !add) back_dim(n, 1, b, a, false, out);
    if (dim == 2 && !add) back_dim(n, 2, b, a, false, out);
    if (dim == 3 && !add) back_dim(n, 3, b, a, false, out);
    if (dim == 1 && add) back_dim(n, 1, b, a, true, out);
    if (dim == 2 && add) back_dim(n, 2, b, a, true, out);
    if (dim == 3 && add) back_dim(n, 3, b, a, true, out);
}

/* The split half of a field: (phi +- alpha w)/2 where the face splits it, phi elsewhere. */
KERNEL static void split_line(int n, const double *restrict phi, const double *restrict w, double sign,
                              const double *restrict speed, double *restrict out) {
    for (int i = 0; i < n; i++)
        out[i] = select_double(speed[i] >= 0, 0.5 * (phi[i] + sign * (speed[i] * w[i])), phi[i]);
}

/* a stays where the face takes this side of the field, else 0. */
KERNEL static void keep_side(int n, const double *restrict speed, double other, double *restrict a) {
    for (int i = 0; i < n; i++) a[i] = select_double(speed[i] == other, 0, a[i]);
}

/* Reconstructs what comes from one side (+1: from the left, -1: from the right) of every field into a[field]. */
static void one_side(int n, int dim, int side, const struct winds *w, const struct fields *phi,
                     const struct fields *state, const struct reconstruct *r, double (*a)[BATCH]) {
    double built[5][BATCH];
    for (int p = 0; p < dim + 2; p++) {
        int kin = family(p, dim);
        bool mine = side > 0 ? w->left[kin] : w->right[kin];
        if (!mine && !w->split[kin]) {
            memset(a[p], 0, (size_t)n * sizeof(double));
            continue;
        }
        const double *line[5];
        for (int m = 0; m < 5; m++) {
            int at = side > 0 ? m : STENCIL - 1 - m;
            line[m] = phi->line[p][at];
            if (!w->split[kin] || m < 2 - r->reach || m > 2 + r->reach) continue;
            split_line(n, line[m], state->line[p][at], side, w->speed[kin], built[m]);
            line[m] = built[m];
        }
        r->face(n, line, a[p]);
        keep_side(n, w->speed[kin], side > 0 ? UPWIND_RIGHT : UPWIND_LEFT, a[p]);
    }
}

/* Marquina's rule (19)-(23): a field whose speed has one sign on both sides is upwinded, others are split with the
 * larger speed; a zero product splits. `always`: split all; `least`: smallest alpha of a split. */
KERNEL static void find_winds(int n, const double *restrict ul, const double *restrict cl, const double *restrict ur,
                              const double *restrict cr, bool always, double least, struct winds *restrict w) {
    for (int k = 0; k < FAMILIES; k++) {
        double sign = k - 1;
        double *restrict speed = w->speed[k];
        for (int i = 0; i < n; i++) {
            double l = ul[i] + sign * cl[i], r = ur[i] + sign * cr[i];
            double alpha = larger(larger(fabs(l), fabs(r)), least);
            speed[i] = l > 0 && r > 0 ? UPWIND_LEFT : l < 0 && r < 0 ? UPWIND_RIGHT : alpha;
            speed[i] = always ? alpha : speed[i];
        }
        int64_t left = 0, right = 0;
        for (int i = 0; i < n; i++) {
            left += speed[i] == UPWIND_LEFT ? 1 : 0;
            right += speed[i] == UPWIND_RIGHT ? 1 : 0;
        }
        w->left[k] = left > 0;
        w->right[k] = right > 0;
        w->split[k] = left + right < n;
    }
}

/* Bases of the cells at `offset` from the left cells. */
KERNEL static void cell_bases(const struct faces *f, long offset, struct bases *restrict b) {
    int n = f->n, dim = f->dim;
    const double *restrict rho = f->state[0] + offset, *restrict eps = f->eps + offset, *restrict p = f->p + offset;
    const double *restrict c = f->c + offset, *restrict g = f->gruneisen + offset;
    for (int i = 0; i < n; i++) {
        b->c[i] = c[i];
        b->b1[i] = g[i];
        b->h[i] = eps[i] + p[i] / rho[i];
    }
    for (int k = dim - 1; k >= 0; k--) {
        const double *restrict u = f->velocity[k] + offset;
        for (int i = 0; i < n; i++) b->u[k][i] = u[i];
    }
}

/* From h = eps + p/rho and the Grueneisen coefficient in b1: total enthalpy h, b1 = p_eps/(rho c^2),
 * b2 = 1 + b1 (u^2 - h). */
ALWAYS_INLINE void close_dim(int n, const int dim, struct bases *restrict b) {
    for (int i = 0; i < n; i++) {
        double t = 0;
        if (dim > 1) t = b->u[1][i] * b->u[1][i];
        if (dim > 2) t += b->u[2][i] * b->u[2][i];
        double square = b->u[0][i] * b->u[0][i] + t, inverse_c = 1 / b->c[i];
        double h = b->h[i] + 0.5 * square, b1 = b->b1[i] * inverse_c * inverse_c;
        b->h[i] = h;
        b->b1[i] = b1;
        b->inverse_b1[i] = 1 / b1;
        b->b2[i] = 1 + b1 * (square - h);
        b->half_inverse_c[i] = 0.5 * inverse_c;
    }
}

KERNEL static void close_bases(int n, int dim, struct bases *b) {
    if (dim == 1) close_dim(n, 1, b);
    if (dim == 2) close_dim(n, 2, b);
    if (dim == 3) close_dim(n, 3, b);
}

/* Bases of given states (rho, u, eps lines); u is in b->u already. */
KERNEL static void state_bases(int n, const double *restrict rho, const double *restrict eps, const double *restrict p,
                               const double *restrict c2, const double *restrict gruneisen, struct bases *restrict b) {
    for (int i = 0; i < n; i++) {
        b->c[i] = sqrt(c2[i]);
        b->b1[i] = gruneisen[i];
        b->h[i] = eps[i] + p[i] / rho[i];
    }
}

KERNEL static void mean_line(int n, const double *restrict l, const double *restrict r, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = 0.5 * (l[i] + r[i]);
}

KERNEL static void choose_line(int n, const double *restrict first, const double *restrict last,
                               const double *restrict l, const double *restrict r, double *restrict mean) {
    for (int i = 0; i < n; i++) mean[i] = first[i] == UPWIND_LEFT ? l[i] : last[i] == UPWIND_RIGHT ? r[i] : mean[i];
}

/* One basis a face: that of the arithmetic mean of (rho, u, T); where all speeds have one sign that of the upwind cell,
 * so that nothing downwind of a supersonic face touches its flux, not even by round-off. */
static void common_bases(const struct faces *f, const struct eos *eos, const struct material *m, const struct winds *w,
                         struct bases *b) {
    int n = f->n, dim = f->dim;
    bool all_left = !w->split[MINUS] && !w->right[MINUS], all_right = !w->split[PLUS] && !w->left[PLUS];
    if (all_left || all_right) {
        cell_bases(f, all_left ? 0 : f->stride, b);
    } else {
        double rho[BATCH], eps[BATCH], p[BATCH], c2[BATCH], gruneisen[BATCH];
        mean_line(n, f->state[0], f->state[0] + f->stride, rho);
        mean_line(n, f->eps, f->eps + f->stride, eps);
        for (int k = 0; k < dim; k++) mean_line(n, f->velocity[k], f->velocity[k] + f->stride, b->u[k]);
        eos->state(m, n, rho, eps, p, c2, gruneisen);
        state_bases(n, rho, eps, p, c2, gruneisen, b);
        if (w->left[MINUS] || w->right[PLUS]) {
            struct bases l, r;
            cell_bases(f, 0, &l);
            cell_bases(f, f->stride, &r);
            const double *first = w->speed[MINUS], *last = w->speed[PLUS];
            for (int k = 0; k < dim; k++) choose_line(n, first, last, l.u[k], r.u[k], b->u[k]);
            choose_line(n, first, last, l.c, r.c, b->c);
            choose_line(n, first, last, l.h, r.h, b->h);
            choose_line(n, first, last, l.b1, r.b1, b->b1);
        }
    }
    close_bases(n, dim, b);
}

/* The upwind half of a field on one basis: phi from its own side, (phi + alpha w)/2 from the left where it is split. */
KERNEL static void upwind_line(int n, const double *restrict phi, const double *restrict mirrored,
                               const double *restrict w, const double *restrict speed, double *restrict out) {
    for (int i = 0; i < n; i++) {
        double split = 0.5 * (phi[i] + speed[i] * w[i]);
        out[i] = speed[i] == UPWIND_LEFT ? phi[i] : speed[i] == UPWIND_RIGHT ? mirrored[i] : split;
    }
}

KERNEL static void add_half(int n, const double *restrict speed, const double *restrict half, double *restrict a) {
    for (int i = 0; i < n; i++) a[i] += select_double(speed[i] >= 0, half[i], 0);
}

/* Adds the other half, (phi - alpha w)/2 from the right, of the faces that split the field; where these are few, they
 * are gathered. */
static void add_split(int n, const double *speed, double (*phi)[BATCH], double (*w)[BATCH], const struct reconstruct *r,
                      double *a) {
    double built[5][BATCH], half[BATCH];
    const double *line[5] = {built[0], built[1], built[2], built[3], built[4]};
    int face[BATCH], count = 0;
    for (int i = 0; i < n; i++)
        if (speed[i] >= 0) face[count++] = i;
    bool few = 4 * count < n;
    for (int m = 2 - r->reach; m <= 2 + r->reach; m++) {
        const double *f = phi[STENCIL - 1 - m], *q = w[STENCIL - 1 - m];
        if (!few)
            split_line(n, f, q, -1, speed, built[m]);
        else
            for (int k = 0; k < count; k++) built[m][k] = 0.5 * (f[face[k]] - speed[face[k]] * q[face[k]]);
    }
    r->face(few ? count : n, line, half);
    if (!few)
        add_half(n, speed, half, a);
    else
        for (int k = 0; k < count; k++) a[face[k]] += half[k];
}

/* The amplitude of one field: one reconstruction, and a second one of the split faces only. */
static void upwind_field(int n, const struct winds *w, int kin, double (*phi)[BATCH], double (*state)[BATCH],
                         const struct reconstruct *r, double *a) {
    double built[5][BATCH];
    const double *line[5];
    bool mixed = w->split[kin] || (w->left[kin] && w->right[kin]);
    for (int m = 0; m < 5; m++) {
        line[m] = phi[w->left[kin] ? m : STENCIL - 1 - m];
        if (!mixed || m < 2 - r->reach || m > 2 + r->reach) continue;
        upwind_line(n, phi[m], phi[STENCIL - 1 - m], w->split[kin] ? state[m] : phi[m], w->speed[kin], built[m]);
        line[m] = built[m];
    }
    r->face(n, line, a);
    if (w->split[kin]) add_split(n, w->speed[kin], phi, state, r, a);
}

static void one_basis(const struct faces *f, const struct eos *eos, const struct material *m,
                      const struct reconstruct *r, bool always, double least) {
    int n = f->n, dim = f->dim;
    struct winds w;
    struct bases b;
    struct fields phi, state;
    double a[MAX_VAR][BATCH];
    find_winds(n, f->velocity[0], f->c, f->velocity[0] + f->stride, f->c + f->stride, always, least, &w);
    common_bases(f, eos, m, &w, &b);
    project(n, dim, f->flux, f->stride, r->reach, &b, &phi);
    if (w.split[MINUS] || w.split[ENTROPY] || w.split[PLUS]) project(n, dim, f->state, f->stride, r->reach, &b, &state);
    for (int p = 0; p < dim + 2; p++) upwind_field(n, &w, family(p, dim), phi.line[p], state.line[p], r, a[p]);
    project_back(n, dim, &b, a, false, f->out);
}

static void common(const struct faces *f, const struct eos *eos, const struct material *m,
                   const struct reconstruct *r) {
    one_basis(f, eos, m, r, false, 0);
}
static void local_lax_friedrichs(const struct faces *f, const struct eos *eos, const struct material *m,
                                 const struct reconstruct *r) {
    one_basis(f, eos, m, r, true, 0);
}
static void global_lax_friedrichs(const struct faces *f, const struct eos *eos, const struct material *m,
                                  const struct reconstruct *r) {
    one_basis(f, eos, m, r, true, f->fastest);
}

struct face_states { /* of one side of n faces */
    double rho[BATCH], u[MAX_DIM][BATCH], eps[BATCH], c[BATCH];
};

/* Falls back to the cell's state where the reconstructed one is not admissible. */
KERNEL static void admit(int n, int dim, double limit, const double *restrict rho, const double *const u[MAX_DIM],
                         const double *restrict eps, struct face_states *restrict s) {
    for (int i = 0; i < n; i++) {
        bool good = s->rho[i] > 0 && s->rho[i] < limit && s->eps[i] > 0;
        s->rho[i] = good ? s->rho[i] : rho[i];
        s->eps[i] = good ? s->eps[i] : eps[i];
        s->c[i] = good ? 1 : 0;
    }
    for (int k = 0; k < dim; k++) {
        const double *restrict uk = u[k];
        for (int i = 0; i < n; i++) s->u[k][i] = s->c[i] > 0 ? s->u[k][i] : uk[i];
    }
}

static void reconstruct_line(const struct faces *f, const double *q, int side, const struct reconstruct *r,
                             double *out) {
    const double *line[5];
    for (int m = 0; m < 5; m++) line[m] = q + (side > 0 ? m - HOME : STENCIL - 1 - m - HOME) * f->stride;
    r->face(f->n, line, out);
}

/* Bases at the states reconstructed to the faces from one side, (rho, u, T) by the same operator. */
static void sided_bases(const struct faces *f, const struct eos *eos, const struct material *m, int side,
                        const struct reconstruct *r, struct bases *b) {
    int n = f->n, dim = f->dim;
    struct face_states s;
    double p[BATCH], c2[BATCH], gruneisen[BATCH];
    long cell = side > 0 ? 0 : f->stride;
    const double *u[MAX_DIM] = {0};
    reconstruct_line(f, f->state[0], side, r, s.rho);
    reconstruct_line(f, f->eps, side, r, s.eps);
    for (int k = 0; k < dim; k++) {
        reconstruct_line(f, f->velocity[k], side, r, s.u[k]);
        u[k] = f->velocity[k] + cell;
    }
    admit(n, dim, density_limit(eos, m), f->state[0] + cell, u, f->eps + cell, &s);
    eos->state(m, n, s.rho, s.eps, p, c2, gruneisen);
    for (int k = 0; k < dim; k++) memcpy(b->u[k], s.u[k], (size_t)n * sizeof(double));
    state_bases(n, s.rho, s.eps, p, c2, gruneisen, b);
    close_bases(n, dim, b);
}

/* Marquina's flux, Donat & Marquina (1996), Serna & Marquina (19)-(23) with w_r in phi_- (erratum S6), bases at the
 * reconstructed face states: with the cells' states it is first order only (physics 1.2). */
static void marquina(const struct faces *f, const struct eos *eos, const struct material *m,
                     const struct reconstruct *r) {
    int n = f->n, dim = f->dim;
    struct winds w;
    struct bases b[2];
    struct fields phi, state;
    double a[MAX_VAR][BATCH];
    sided_bases(f, eos, m, 1, r, &b[0]);
    sided_bases(f, eos, m, -1, r, &b[1]);
    find_winds(n, b[0].u[0], b[0].c, b[1].u[0], b[1].c, false, 0, &w);
    bool any_split = w.split[MINUS] || w.split[ENTROPY] || w.split[PLUS];
    bool needed[2] = {any_split || w.left[MINUS] || w.left[ENTROPY] || w.left[PLUS],
                      any_split || w.right[MINUS] || w.right[ENTROPY] || w.right[PLUS]};
    for (int s = 0, first = 1; s < 2; s++) {
        if (!needed[s]) continue;
        project(n, dim, f->flux, f->stride, r->reach, &b[s], &phi);
        if (any_split) project(n, dim, f->state, f->stride, r->reach, &b[s], &state);
        one_side(n, dim, s == 0 ? 1 : -1, &w, &phi, &state, r, a);
        project_back(n, dim, &b[s], a, !first, f->out);
        first = 0;
    }
}

/* F = (f_l + f_r)/2 - s (u_r - u_l)/2, s = max(|u_l| + c_l, |u_r| + c_r): Rusanov (1961). */
KERNEL static void rusanov_line(int n, const double *restrict s, const double *restrict fl, const double *restrict fr,
                                const double *restrict ul, const double *restrict ur, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = 0.5 * (fl[i] + fr[i]) - 0.5 * s[i] * (ur[i] - ul[i]);
}

KERNEL static void rusanov_speed(int n, const double *restrict ul, const double *restrict cl, const double *restrict ur,
                                 const double *restrict cr, double *restrict s) {
    for (int i = 0; i < n; i++) s[i] = larger(fabs(ul[i]) + cl[i], fabs(ur[i]) + cr[i]);
}

void flux_rusanov(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r) {
    (void)eos, (void)m, (void)r;
    double s[BATCH];
    rusanov_speed(f->n, f->velocity[0], f->c, f->velocity[0] + f->stride, f->c + f->stride, s);
    for (int v = 0; v < f->dim + 2; v++)
        rusanov_line(f->n, s, f->flux[v], f->flux[v] + f->stride, f->state[v], f->state[v] + f->stride, f->out[v]);
}

const struct flux flux_table[] = {
    {"common", "characteristic upwind on one eigenbasis a face (default)", common},
    {"Marquina", "two bases at the reconstructed face states (Donat & Marquina 1996)", marquina},
    {"LaxFriedrichs", "characteristic, every field split with the face's speed", local_lax_friedrichs},
    {"globalLaxFriedrichs", "characteristic, every field split with the domain's largest speed", global_lax_friedrichs},
    {"Rusanov", "first order, the most robust (ignores reconstruct)", flux_rusanov},
};
const int flux_count = sizeof flux_table / sizeof *flux_table;

const struct flux *flux_find(const char *name) {
    for (int i = 0; i < flux_count; i++)
        if (!strcmp(name, flux_table[i].name)) return &flux_table[i];
    return NULL;
}

void flux_eigenvectors(int dim, const struct basis *given, double left[MAX_VAR][MAX_VAR],
                       double right[MAX_VAR][MAX_VAR]) {
    struct bases b;
    for (int k = 0; k < dim; k++) b.u[k][0] = given->u[k];
    b.c[0] = given->c;
    b.b1[0] = given->b1 * given->c * given->c;
    b.h[0] = given->h;
    double kinetic = 0;
    for (int k = 0; k < dim; k++) kinetic += given->u[k] * given->u[k];
    b.h[0] -= 0.5 * kinetic;
    close_bases(1, dim, &b);
    for (int v = 0; v < dim + 2; v++) {
        struct fields fields;
        double unit[MAX_VAR] = {0}, a[MAX_VAR][BATCH] = {{0}}, column[MAX_VAR];
        unit[v] = 1;
        a[v][0] = 1;
        const double *q[MAX_VAR];
        double *out[MAX_VAR];
        for (int k = 0; k < dim + 2; k++) {
            q[k] = &unit[k];
            out[k] = &column[k];
        }
        project(1, dim, q, 0, 0, &b, &fields);
        project_back(1, dim, &b, a, false, out);
        for (int k = 0; k < dim + 2; k++) {
            left[k][v] = fields.line[k][HOME][0];
            right[k][v] = column[k];
        }
    }
}
