/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step of a bed, implicit acoustics: Newton's method for the pressures (bed.h, part 1; docs/physics.md 9.1). */
#include "libcore/acoustics/bed_private.h"

enum {
    NEWTON_MOST = 30, /* iterations; 2 to 5 are usual */
    MORE = 6,         /* iterations below CLOSE while a cell would be packed or denser */
    ROOT_MOST = 30,   /* iterations for the root of (*) */
    LINEAR_MOST = 200
};
static const double CLOSE = 1e-8; /* residual over diagonal times p at which Newton's method ends */
/* Newton's method ends only where residuals, parts of a cell's volume, are below CLOSE/VOLUME too: where kept faces
 * bring in more than there is room for, p rises without end, and any residual is small beside it. */
static const double VOLUME = 1e-2;
/* Residuals are differences of numbers around 1: so much of one is rounding. Close to packing, where a density that is
 * off by its last digit is off by far more in p, no iteration goes below it. */
static const double NOISE = 8 * 0x1p-52;
/* An iteration of Newton's method squares the residual, over diagonal times p, and Newton's method ends at CLOSE. A
 * linear residual of SHARE of both is small beside them. AT_REST: the part that is left of a residual below CLOSE. */
static const double SHARE = 0.1, AT_REST = 1e-4;
static const double LIKE = 2; /* p of a cell changes by no more than this factor over the sources and the diffusion */
static const double FALL = 0.1, RISE = 1e4; /* bounds of p over its old value in one iteration */

/* Returns u.n of the gas beyond a face. */
static double beyond_speed(const struct bed *b, int face) {
    double u[MAX_DIM];
    for (int k = 0; k < b->dim; k++) u[k] = b->set.outside[k + 1][face] / b->set.outside[0][face];
    return bed_along(b, b->set.shapes->normal, b->set.shape[face], u);
}

static double pressure_beyond(const struct bed *b, int face) {
    double square = 0, p, c2, gruneisen;
    const double rho = b->set.outside[0][face];
    for (int k = b->components; k >= 1; k--) square += b->set.outside[k][face] * b->set.outside[k][face];
    const double eps = (b->set.outside[b->components + 1][face] - 0.5 * square / rho) / rho;
    b->eos->state(b->material, 1, &rho, &eps, &p, &c2, &gruneisen);
    return p;
}

/* Returns the velocity U with which the gas of the upwind side makes the mass flux that is kept for the face. */
static double kept_speed(const struct bed *b, int face) {
    const double mass = b->set.kept[0][face];
    const int left = b->set.left[face], right = b->set.right[face];
    const bool from_bed = mass > 0 ? left >= 0 : right >= 0;
    return mass / (from_bed ? b->lines->rho[left >= 0 ? left : right] : b->set.outside[0][face]);
}

/* Finds drift and give of a face that gas passes, U_f = drift - give (p_R - p_L): the weights, by which P_R - P_L
 * differs from p_R - p_L, are in drift. */
static void find_open_drift(struct bed *b, int f, double dt, const double gravity[MAX_DIM]) {
    const struct bed_lines *x = b->lines;
    const int l = b->set.left[f], r = b->set.right[f], shape = b->set.shape[f];
    const bool inner = b->set.kind[f] == BED_INNER;
    const double rho_l = l >= 0 ? x->rho[l] : b->set.outside[0][f], rho_r = r >= 0 ? x->rho[r] : b->set.outside[0][f];
    const double u_l = l >= 0 ? bed_normal_speed(b, x->u, l, shape) : beyond_speed(b, f);
    const double u_r = r >= 0 ? bed_normal_speed(b, x->u, r, shape) : beyond_speed(b, f);
    const double both = rho_l + rho_r, apart = b->set.shapes->depth[0][shape] + b->set.shapes->depth[1][shape];
    const double weight = bed_weight(b, f, 0, rho_l, gravity) - bed_weight(b, f, 1, rho_r, gravity);
    const double give = dt / (0.5 * both * apart);
    x->drift[f] = (rho_l * u_l + rho_r * u_r) / both + give * weight;
    if (b->rub) x->drift[f] += x->push[f];
    if (inner ? l != r : b->set.holds[f] > 0) x->give[f] = give;
    if (!inner) x->beyond[f] = b->set.holds[f] > 0 ? pressure_beyond(b, f) : x->p[l >= 0 ? l : r];
}

static void find_drift(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    const struct bed_lines *x = b->lines;
    for (int f = 0; f < b->set.faces; f++) {
        x->give[f] = x->beyond[f] = x->drift[f] = 0;
        if (b->set.kind[f] == BED_KEPT)
            x->drift[f] = kept_speed(b, f);
        else if (b->set.kind[f] != BED_WALL)
            find_open_drift(b, f, dt, gravity);
    }
}

static void find_speeds(struct bed *b) {
    const struct bed_lines *x = b->lines;
    for (int f = 0; f < b->set.faces; f++) {
        const int l = b->set.left[f], r = b->set.right[f];
        const double p_l = l >= 0 ? x->p[l] : x->beyond[f], p_r = r >= 0 ? x->p[r] : x->beyond[f];
        x->U[f] = x->drift[f] - x->give[f] * (p_r - p_l);
    }
}

/* Does one step of Newton's method for h(rho) = rho S - 1 - 1/Gamma(rho) = 0, which is (*), with S = tau^n + eps^n/p;
 * c2 is that at eps = 1, for rho Gamma'. h rises, and is all but linear both in dilute gas and near packing. A cell
 * that has converged keeps its bits, and those of c2 and gruneisen, whichever cells share its batch. Returns whether a
 * cell has not converged. */
KERNEL static bool bed_root_step(int n, double limit, const double *restrict S, const double *restrict c2,
                                 const double *restrict gruneisen, double *restrict root, double *restrict open) {
    double any = 0;
    for (int i = 0; i < n; i++) {
        const double G = gruneisen[i], rho = root[i];
        const double h = rho * S[i] - 1 - 1 / G, steep = S[i] + gruneisen_slope(c2[i], G) / (rho * G * G);
        double next = rho - h / steep;
        next = next < limit ? next : 0.5 * (rho + limit);
        next = next > 0 ? next : 0.5 * rho;
        const double moves = fabs(next - rho) > 4e-16 * rho ? open[i] : 0;
        root[i] = moves > 0 ? next : rho;
        open[i] = moves;
        any += moves;
    }
    return any > 0;
}

/* Computes slack = -tau'(p) = (eps^n/p^2)/(1 + 1/Gamma + rho Gamma'/Gamma^2) */
KERNEL static void bed_slack(int n, const double *restrict eps, const double *restrict p, const double *restrict c2,
                             const double *restrict gruneisen, double *restrict slack) {
    for (int i = 0; i < n; i++) {
        const double G = gruneisen[i];
        slack[i] = eps[i] / (p[i] * p[i]) / (1 + 1 / G + gruneisen_slope(c2[i], G) / (G * G));
    }
}

/* Finds the root of (*) for the present p in n cells of a block, and slack. */
static void find_root(struct bed *b, int at, int n) {
    const struct bed_lines *x = b->lines;
    double S[BATCH], open[BATCH], p[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < n; i++) {
        S[i] = 1 / x->rho[at + i] + x->eps[at + i] / x->p[at + i];
        open[i] = 1;
    }
    bool any = true;
    for (int times = 0; any && times < ROOT_MOST; times++) {
        eos_unit_state(b->eos, b->material, n, x->root + at, p, c2, gruneisen);
        any = bed_root_step(n, b->limit, S, c2, gruneisen, x->root + at, open);
    }
    bed_slack(n, x->eps + at, x->p + at, c2, gruneisen, x->slack + at);
}

/* How far p is from the solution. */
struct distance {
    double worst; /* the largest residual above rounding over diagonal times p, or times VOLUME */
    bool sound;   /* is p a number everywhere? */
    bool crowded; /* would a cell be packed or denser? Cold gas at rest has less room than CLOSE leaves open */
};

/* Finds the residual and the diagonal of the Jacobian, times V, of this rank's cells, and sets worst and crowded. */
static void find_residual(struct bed *b, double dt, struct distance *off) {
    const struct bed_lines *x = b->lines;
    find_speeds(b);
    for (int at = 0; at < b->set.cells; at += BATCH)
        find_root(b, at, b->set.cells - at < BATCH ? b->set.cells - at : BATCH);
    for (int i = 0; i < b->set.cells; i++) {
        double out = 0, weights = 0;
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            const double swept = dt * b->set.shapes->area[s.shape];
            out += s.sign * swept * x->U[s.face];
            weights += swept * x->give[s.face];
        }
        const double V = b->set.shapes->volume[b->set.body[i]];
        x->residual[i] = V * (x->rho[i] / x->root[i] - 1) - out;
        x->diagonal[i] = V * x->rho[i] * x->slack[i] + weights;
        const double above = fabs(x->residual[i]) - NOISE * V, change = above / (x->diagonal[i] * x->p[i]),
                     most = larger(VOLUME * above / V, change);
        off->worst = most <= off->worst ? off->worst : most; /* also if it is no number */
        off->crowded |= !(x->rho[i] < b->limit * (1 + out / V));
    }
}

/* Finds residuals for the present p; sound: is it a number everywhere on this rank? Returns what holds on all. */
static struct distance check_pressure(struct bed *b, double dt, bool sound) {
    struct distance off = {0, sound, false};
    bed_fill(b, 1, &b->lines->p);
    if (sound) find_residual(b, dt, &off);
    double all[] = {off.worst, !off.sound, off.crowded};
    comm_max(b->comm, all, 3);
    return (struct distance){all[0], all[1] == 0, all[2] > 0};
}

static bool is_link(const struct bed *b, const struct bed_side *s, int cell) {
    return b->set.kind[s->face] == BED_INNER && bed_across(b, s) != cell;
}

/* Lists the links of a cell, in the order of its faces. */
void bed_find_links(struct bed *b) {
    const struct bed_lines *x = b->lines;
    int links = 0;
    for (int i = 0; i < b->set.cells; i++) {
        x->link_first[i] = links;
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            if (is_link(b, &s, i)) x->link[links++] = bed_across(b, &s);
        }
    }
    x->link_first[b->set.cells] = links;
}

static void find_weights(struct bed *b, double dt) {
    const struct bed_lines *x = b->lines;
    int links = 0;
    for (int i = 0; i < b->set.cells; i++)
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            if (is_link(b, &s, i)) x->weight[links++] = dt * b->set.shapes->area[s.shape] * x->give[s.face];
        }
}

static void send_one(void *bed, const double *line) {
    bed_fill_send(bed, 1, &line);
}

static void receive_one(void *bed, double *line) {
    bed_fill_receive(bed, 1, &line);
}

/* Returns s = dp/p of a cell, by e = dp/p of Newton's method, which takes the volume of a cell to be linear in p. It is
 * nearly linear in 1/p; linear are the velocities of the faces, the part `across` of the diagonal. So s solves
 * e = across s + (1 - across) s/(1 + s). */
ALWAYS_INLINE double bend(double e, double across) {
    const double half = 0.5 * (1 - e);
    return e / (half + sqrt(larger(half * half + across * e, 0)));
}

/* Moves p by Newton's method, within bounds. Returns whether p is a number everywhere on this rank. */
static bool move_pressure(struct bed *b) {
    const struct bed_lines *x = b->lines;
    bool sound = true;
    for (int i = 0; i < b->set.cells; i++) {
        const double p = x->p[i], own = b->set.shapes->volume[b->set.body[i]] * x->rho[i] * x->slack[i];
        const double change = p * bend(x->change[i] / p, 1 - own / x->diagonal[i]);
        x->p[i] = smaller(larger(p + change, FALL * p), RISE * p);
        sound &= isfinite(x->change[i]) && x->p[i] > 0;
    }
    return sound;
}

/* Begins with the pressures at the start of the whole step: cooling and diffusion have taken from p since what the
 * weight gives back. Where p has changed by more than LIKE, something else moves. */
static void guess_pressure(struct bed *b) {
    const struct bed_lines *x = b->lines;
    for (int i = 0; i < b->set.cells; i++)
        if (x->start_p[i] < LIKE * x->p[i] && LIKE * x->start_p[i] > x->p[i]) x->p[i] = x->start_p[i];
}

/* Returns by how much the linear residual is to fall in an iteration that begins at the residual `worst`. */
static double reduction_at(double worst) {
    return worst > CLOSE ? SHARE * smaller(larger(worst, CLOSE / worst), 1) : AT_REST;
}

/* Solves the linear system of an iteration of Newton's method, which begins at the residual `worst`. again: it is not
 * the first of the step. The first makes the multigrid's aggregates anew, as the first step of a restart must do, which
 * shall have the same bits. */
static status solve(struct bed *b, bool again, double worst, bool *sound) {
    const struct bed_lines *x = b->lines;
    int iterations = 0;
    const struct multigrid_rows rows = {.blocks = b->set.blocks,
                                        .first = b->set.first,
                                        .number = b->set.number,
                                        .rows = b->set.cells,
                                        .ghosts = b->set.ghosts,
                                        .link_first = x->link_first,
                                        .link = x->link,
                                        .weight = x->weight,
                                        .diagonal = x->diagonal,
                                        .send = send_one,
                                        .receive = receive_one,
                                        .context = b};
    TRY(multigrid_setup(b->multigrid, &rows, again || (b->stage == BED_LAID && multigrid_is_direct(b->multigrid))));
    b->stage = BED_LAID;
    TRY(multigrid_solve(b->multigrid, &rows, x->residual, reduction_at(worst), LINEAR_MOST, x->change, &iterations));
    b->linear += iterations;
    *sound = move_pressure(b);
    return OK;
}

/* Finds the pressures by at least one iteration of Newton's method: if they stayed as they were, the step would be an
 * explicit one, far too long, and round-off would grow. */
status bed_find_pressure(struct bed *b, double dt, const double gravity[MAX_DIM], bool again, bool *done) {
    b->newton = b->linear = 0;
    find_drift(b, dt, gravity);
    find_weights(b, dt);
    if (!again) guess_pressure(b);
    struct distance off = check_pressure(b, dt, true);
    for (int more = 0; off.sound && b->newton < NEWTON_MOST; b->newton++) {
        const bool close = b->newton > 0 && off.worst < CLOSE;
        bool sound = true;
        if (close && !(off.crowded && more++ < MORE)) break;
        TRY(solve(b, b->newton > 0, off.worst, &sound));
        off = check_pressure(b, dt, sound);
    }
    *done = off.worst < CLOSE && off.sound;
    return OK;
}
