/* Velocities and energies of a bed after acoustics (bed.h, part 2). */
#include "libcore/acoustics/bed_private.h"

/* z is STIFF rho h/dt at most, so that q is stable at any dt: it takes less than all of a difference of velocities. */
static const double STIFF = 0.4;

/* The difference of u across a face of cell i along an axis, as the slope sees it. A wall mirrors u; beyond other faces
 * of the bed u is not known: *known is false. */
static double difference(const struct bed *b, int axis, int cell, int face, bool above, bool *known) {
    const double *u = b->lines->u[axis];
    if (b->kind[face] == BED_WALL) return above ? -2 * u[cell] : 2 * u[cell];
    if (b->kind[face] != BED_INNER) *known = false;
    return b->kind[face] == BED_INNER ? u[b->right[face]] - u[b->left[face]] : 0;
}

static void find_tilts(struct bed *b) {
    const struct bed_lines *x = b->lines;
    for (int k = 0; k < b->dim; k++)
        for (int i = 0; i < b->cells; i++) {
            bool known = true;
            const double below = difference(b, k, i, b->low[k][i], false, &known);
            const double above = difference(b, k, i, b->high[k][i], true, &known);
            x->tilt[k][i] = known ? limited(below, above) : 0;
        }
    bed_fill(b, b->dim, x->tilt);
}

/* Returns q = -z du/2 of a face, from the densities and impedances of its two sides, the sum of their speeds, and
 * stiff = h/dt. z is small where both are slow, so that slow flow is not braked (bed.h: soft). */
static double friction(double rho_l, double rho_r, double z_l, double z_r, double speeds, double du, double stiff,
                       double soft) {
    const double rho = smaller(rho_l, rho_r), sound = 2 * z_l * z_r / (z_l + z_r);
    const double slow = rho * (speeds + fabs(du) + soft * stiff);
    return -0.5 * du * smaller(smaller(sound, STIFF * stiff * rho), slow);
}

static double inner_pressure(const struct bed *b, int face, int axis, double stiff) {
    const struct bed_lines *x = b->lines;
    const int l = b->left[face], r = b->right[face];
    const double *u = x->u[axis], *tilt = x->tilt[axis], rho_l = x->rho[l], rho_r = x->rho[r];
    const double du = (u[r] - 0.5 * tilt[r]) - (u[l] + 0.5 * tilt[l]);
    return (rho_r * x->p[l] + rho_l * x->p[r]) / (rho_l + rho_r) +
           friction(rho_l, rho_r, rho_l * x->c[l], rho_r * x->c[r], fabs(u[l]) + fabs(u[r]), du, stiff, b->params.soft);
}

/* A wall carries the weight of half a cell, and mirrors its velocity. */
static double wall_pressure(const struct bed *b, int face, int axis, double stiff, double gravity) {
    const struct bed_lines *x = b->lines;
    const bool low = b->left[face] < 0;
    const int i = low ? b->right[face] : b->left[face];
    const double rho = x->rho[i], weight = 0.5 * rho * gravity * b->width[axis], z = rho * x->c[i];
    const double u = x->u[axis][i], at = low ? u - 0.5 * x->tilt[axis][i] : -(u + 0.5 * x->tilt[axis][i]);
    return (low ? x->p[i] - weight : x->p[i] + weight) +
           friction(rho, rho, z, z, 2 * fabs(u), 2 * at, stiff, b->params.soft);
}

static double open_pressure(const struct bed *b, int face) {
    const struct bed_lines *x = b->lines;
    const int i = b->left[face] >= 0 ? b->left[face] : b->right[face];
    const double rho = x->rho[i], outside = b->outside[0][face];
    const double beyond = b->kind[face] == BED_FREE ? x->p[i] : x->beyond[face];
    return (outside * x->p[i] + rho * beyond) / (rho + outside);
}

static void find_face_pressures(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    const struct bed_lines *x = b->lines;
    for (int k = 0; k < b->dim; k++) {
        const double stiff = b->width[k] / dt;
        for (int f = b->axis_first[k]; f < b->axis_first[k + 1]; f++) switch (b->kind[f]) {
            case BED_INNER:
                x->p_face[f] = inner_pressure(b, f, k, stiff);
                break;
            case BED_WALL:
                x->p_face[f] = wall_pressure(b, f, k, stiff, gravity[k]);
                break;
            case BED_KEPT:
                x->p_face[f] = b->kept[k + 1][f] - b->kept[0][f] * x->U[f];
                break;
            default:
                x->p_face[f] = open_pressure(b, f);
            }
    }
}

/* The state of a cell after acoustics. Gravity works on what crosses the cell, the mean of its faces' velocities:
 * then the hydrostatic parts of p_f do no work on the internal energy. The gas of a cell at the surface of a bed has
 * room to fall within the cell, and (*) presses it together; so eps is compared with that of (*) or of the start,
 * whichever is less. Returns the J/m^3 that lifting eps added; *work: those of gravity. */
static double update_cell(const struct bed *b, double dt, const double gravity[MAX_DIM], int i, double *work) {
    const struct bed_lines *x = b->lines;
    double growth = 0, power = 0, given = 0, before = 0, now = 0;
    for (int k = b->dim - 1; k >= 0; k--) {
        const int low = b->low[k][i], high = b->high[k][i];
        const double lambda = dt / b->width[k], U_low = x->U[low], U_high = x->U[high], u = x->u[k][i];
        const double force = lambda * (x->p_face[high] - x->p_face[low]) / x->rho[i],
                     moved = u + (dt * gravity[k] - force);
        growth += lambda * (U_high - U_low);
        power += lambda * (x->p_face[high] * U_high - x->p_face[low] * U_low);
        given += dt * gravity[k] * (0.5 * (U_low + U_high));
        before += u * u;
        now += moved * moved;
        x->after[k + 1][i] = moved;
    }
    const double rho = x->rho[i],
                 least = (1 - b->params.keep) * (x->eps[i] - larger(x->p[i] * (1 / x->root[i] - 1 / rho), 0));
    const double eps = x->eps[i] + 0.5 * (before - now) - power / rho + given;
    x->after[0][i] = rho / (1 + growth);
    x->after[b->dim + 1][i] = larger(eps, least);
    *work += rho * given;
    return eps < least ? rho * (least - eps) : 0;
}

bool bed_update(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    bool fine = true;
    find_tilts(b);
    find_face_pressures(b, dt, gravity);
    b->lifted = 0;
    for (int block = 0; block < b->blocks; block++) {
        b->lift[block] = b->work[block] = 0;
        for (int i = b->first[block]; i < b->first[block + 1]; i++) {
            const double lift = update_cell(b, dt, gravity, i, &b->work[block]);
            b->lift[block] += lift;
            b->lifted += lift > 0;
            fine &= lift == 0 || lift <= bed_energy_near(b, i);
        }
    }
    bed_fill(b, b->dim + 2, b->lines->after);
    return fine;
}
