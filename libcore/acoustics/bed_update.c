/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step of a bed: velocities and energies after acoustics (bed.h, part 2; docs/physics.md 9.1). */
#include "libcore/acoustics/bed_friction_private.h"

/* z is STIFF rho h/dt at most, so that q is stable at any dt: it takes less than all of a difference of velocities. */
static const double STIFF = 0.4;

/* Finds the slopes of the velocities, which q_f needs. */
static void find_tilts(struct bed *b) {
    const struct bed_lines *x = b->lines;
    double *velocity[MAX_VAR] = {NULL, x->u[0], x->u[1], x->u[2]};
    bed_slopes(b, velocity, 1, b->dim + 1, 0);
    if (!b->halo) return;
    for (int k = 0; k < b->dim; k++)
        bed_fill(b, b->set.shapes->boxes ? 1 : b->dim, &x->slope[k][b->set.shapes->boxes ? k + 1 : 1]);
}

/* Returns u.n at a face by the slopes of one of its cells. */
static double speed_at(const struct bed *b, const struct bed_side *s, int cell) {
    double sum = 0;
    for (int k = 0; k < b->dim; k++) {
        const double n = b->set.shapes->normal[k][s->shape];
        if (n != 0) sum += n * (b->lines->u[k][cell] + bed_reach(b, s, cell, k + 1));
    }
    return sum;
}

/* Returns q = -z du/2 of a face, from the densities and impedances of its two sides, the sum of their speeds, and
 * stiff = d_f/dt. z is small where both are slow, so that slow flow is not braked (bed.h: soft). */
static double damping(double rho_l, double rho_r, double z_l, double z_r, double speeds, double du, double stiff,
                      double soft) {
    const double rho = smaller(rho_l, rho_r), sound = 2 * z_l * z_r / (z_l + z_r);
    const double slow = rho * (speeds + fabs(du) + soft * stiff);
    return -0.5 * du * smaller(smaller(sound, STIFF * stiff * rho), slow);
}

static struct bed_side side_within(const struct bed *b, int face) {
    const int right = b->set.left[face] < 0;
    return (struct bed_side){face, b->set.shape[face], right, right ? -1 : 1};
}

/* Finds P, the pressures of cells at their faces under their own weight. */
static void find_pressures(struct bed *b, const double gravity[MAX_DIM]) {
    const struct bed_lines *x = b->lines;
    for (int f = 0; f < b->set.faces; f++)
        for (int right = 0; right < 2; right++) {
            const int cell = right ? b->set.right[f] : b->set.left[f];
            if (cell >= 0) x->P[right][f] = x->p[cell] + bed_weight(b, f, right, x->rho[cell], gravity);
        }
}

static double inner_pressure(const struct bed *b, int face, double dt) {
    const struct bed_lines *x = b->lines;
    const int l = b->set.left[face], r = b->set.right[face], shape = b->set.shape[face];
    const struct bed_side left = {face, shape, 0, 1}, right = {face, shape, 1, -1};
    const double rho_l = x->rho[l], rho_r = x->rho[r];
    const double speeds = fabs(bed_normal_speed(b, x->u, l, shape)) + fabs(bed_normal_speed(b, x->u, r, shape));
    const double du = speed_at(b, &right, r) - speed_at(b, &left, l);
    const double stiff = (b->set.shapes->depth[0][shape] + b->set.shapes->depth[1][shape]) / dt;
    return (rho_r * x->P[0][face] + rho_l * x->P[1][face]) / (rho_l + rho_r) +
           damping(rho_l, rho_r, rho_l * x->c[l], rho_r * x->c[r], speeds, du, stiff, b->params.soft);
}

/* Returns p_f on a wall: the pressure P of its cell there, and q_f with the mirror image of the cell's velocity. */
static double wall_pressure(const struct bed *b, int face, double dt) {
    const struct bed_lines *x = b->lines;
    const struct bed_side s = side_within(b, face);
    const int i = s.right ? b->set.right[face] : b->set.left[face];
    const double rho = x->rho[i], z = rho * x->c[i], speed = bed_normal_speed(b, x->u, i, s.shape);
    const double stiff = 2 * b->set.shapes->depth[s.right][s.shape] / dt;
    return x->P[s.right][face] +
           damping(rho, rho, z, z, 2 * fabs(speed), -2 * s.sign * speed_at(b, &s, i), stiff, b->params.soft);
}

static double open_pressure(const struct bed *b, int face, const double gravity[MAX_DIM]) {
    const struct bed_lines *x = b->lines;
    const struct bed_side s = side_within(b, face);
    const int i = s.right ? b->set.right[face] : b->set.left[face];
    const double rho = x->rho[i], outside = b->set.outside[0][face];
    const double beyond = (b->set.holds[face] > 0 ? x->beyond[face] : x->p[i]) +
                          outside * bed_along(b, b->set.shapes->arm[!s.right], s.shape, gravity);
    return (outside * x->P[s.right][face] + rho * beyond) / (rho + outside);
}

static double kept_pressure(const struct bed *b, int face) {
    double momentum[MAX_DIM];
    for (int k = 0; k < b->dim; k++) momentum[k] = b->set.kept[k + 1][face];
    return bed_along(b, b->set.shapes->normal, b->set.shape[face], momentum) - b->set.kept[0][face] * b->lines->U[face];
}

static void find_face_pressures(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    double *p = b->lines->p_face;
    for (int f = 0; f < b->set.faces; f++) switch (b->set.kind[f]) {
        case BED_INNER:
            p[f] = inner_pressure(b, f, dt);
            break;
        case BED_WALL:
            p[f] = wall_pressure(b, f, dt);
            break;
        case BED_KEPT:
            p[f] = kept_pressure(b, f);
            break;
        default:
            p[f] = open_pressure(b, f, gravity);
        }
}

/* Finds density and velocity of a cell after acoustics, by the forces p_f - P on its faces. As sum_f A n = 0 and sum_f
 * A n (x_f - x) = V, these add up to the forces of p_f and gravity, and at rest each of them is exactly 0. Along the
 * radius of a body of revolution they have areas in the plane, in which sum_f A n = 0, too. */
static void move_cell(const struct bed *b, double dt, const double gravity[MAX_DIM], int i) {
    const struct bed_lines *x = b->lines;
    const double per = dt / b->set.shapes->volume[b->set.body[i]], rho = x->rho[i];
    double growth = 0, force[MAX_DIM] = {0};
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double swept = s.sign * per * b->set.shapes->area[s.shape],
                     push = swept * (x->p_face[s.face] - x->P[s.right][s.face]);
        growth += swept * x->U[s.face];
        for (int k = 0; k < b->dim; k++)
            if (b->set.shapes->normal[k][s.shape] != 0)
                force[k] += push * b->set.shapes->normal[k][s.shape] * bed_tilt(b, s.shape, i, k);
    }
    x->growth[i] = growth;
    x->after[0][i] = rho / (1 + growth);
    for (int k = 0; k < b->components; k++) {
        const double gain = k < b->dim ? -force[k] / rho : dt * gravity[k];
        x->after[k + 1][i] = x->u[k][i] + (b->rub ? gain + x->rubbed[k][i] : gain);
    }
}

/* Returns the part of p_f - P of a side that friction carries: what it gives to U, but no more than p_f - P. */
static double carried(const struct bed *b, const struct bed_side *s, int cell, double dt) {
    const struct bed_lines *x = b->lines;
    const double over = x->p_face[s->face] - x->P[s->right][s->face];
    if (!b->rub) return 0;
    const double rubs = s->sign * x->rho[cell] * b->set.shapes->depth[s->right][s->shape] * x->push[s->face] / dt;
    return over > 0 ? larger(0, smaller(rubs, over)) : smaller(0, larger(rubs, over));
}

/* Returns the heat (J/(m^2 s)) that a cell gains at a face, -(p_f - P) (U - u.n) outwards: p_f moves the gas on the
 * face with U, and the cell with u, the mean of its velocities before and after acoustics. The part of p_f - P that
 * friction carries makes no heat: it works on U, where it takes energy. */
static double heat_of_side(const struct bed *b, const struct bed_side *s, int cell, double dt) {
    const struct bed_lines *x = b->lines;
    const double mean =
        0.5 * (bed_pushed_speed(b, x->u, cell, s->shape) + bed_pushed_speed(b, x->after + 1, cell, s->shape));
    const double over = x->p_face[s->face] - x->P[s->right][s->face] - carried(b, s, cell, dt);
    return -s->sign * over * (x->U[s->face] - mean);
}

static void find_heat(struct bed *b, double dt) {
    const struct bed_lines *x = b->lines;
    for (int f = 0; f < b->set.faces; f++) {
        const int l = b->set.left[f], r = b->set.right[f], shape = b->set.shape[f];
        const struct bed_side left = {f, shape, 0, 1}, right = {f, shape, 1, -1};
        x->heat[0][f] = l >= 0 ? heat_of_side(b, &left, l, dt) : 0;
        x->heat[1][f] = r >= 0 ? heat_of_side(b, &right, r, dt) : 0;
    }
}

/* Returns the heat (J/kg) that a cell gains at its faces in the step. */
static double heat_of_cell(const struct bed *b, double dt, int i) {
    double sum = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        sum += b->set.shapes->area[s.shape] * b->lines->heat[s.right][s.face];
    }
    return dt / b->set.shapes->volume[b->set.body[i]] * sum / b->lines->rho[i];
}

/* Returns the heat of a face that the cell across it can give to the cell on side `right`, which the face cools. */
static double spare(const struct bed *b, int face, int right) {
    const double mine = b->lines->heat[right][face], others = b->lines->heat[!right][face];
    return b->set.kind[face] == BED_INNER && mine < 0 && others > 0 ? smaller(-mine, others) : 0;
}

/* Returns the least eps that a cell may be left with: 1 - b of that of (*), or of that at the start if this is less.
 * For in a cell at the surface of a bed the gas has room to fall within the cell, and (*) presses it together. */
static double least_of(const struct bed *b, int i) {
    const struct bed_lines *x = b->lines;
    return (1 - b->params.keep) * (x->eps[i] - larger(x->p[i] * (1 / x->root[i] - 1 / x->rho[i]), 0));
}

/* Returns eps of a cell after acoustics, eps^n - p (tau - tau^n) + heat. */
static double eps_after(const struct bed *b, double dt, int i) {
    const struct bed_lines *x = b->lines;
    return x->eps[i] - x->p[i] * x->growth[i] / x->rho[i] + heat_of_cell(b, dt, i);
}

/* Gives a cell that would fall below its bound what it lacks, out of the heat that its neighbours gain at the faces
 * that cool it. Together two cells gain at their face U_p (U_p - [change of u.n]/2) rho_f d_f/dt + z du^2/2, U_p the
 * part of U that the pressures make: that is hardly ever negative. But one of them may lose, and a cold cell has
 * nothing to lose. */
static void pass_heat(struct bed *b, double dt) {
    const struct bed_lines *x = b->lines;
    double *lacks = x->change; /* part of what could be given to the cell */
    for (int i = 0; i < b->set.cells; i++) {
        const double lack = least_of(b, i) - eps_after(b, dt, i);
        double all = 0;
        lacks[i] = 0;
        if (!(lack > 0)) continue;
        for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(b, j);
            all += b->set.shapes->area[s.shape] * spare(b, s.face, s.right);
        }
        all *= dt / b->set.shapes->volume[b->set.body[i]] / x->rho[i];
        lacks[i] = all > lack ? lack / all : all > 0;
    }
    bed_fill(b, 1, &lacks);
    for (int f = 0; f < b->set.faces; f++)
        for (int right = 0; right < 2; right++) {
            const double give = spare(b, f, right);
            if (!(give > 0)) continue;
            const double given = give * lacks[right ? b->set.right[f] : b->set.left[f]];
            x->heat[right][f] += given;
            x->heat[!right][f] -= given;
            break;
        }
}

/* Returns the work (J/m^3) of gravity, and of the balance of a state at rest, on the gas that moves through a cell: the
 * sum over its faces of (P - p) A U dt/V. So the hydrostatic parts of p_f do no work on eps. */
static double work_on_cell(const struct bed *b, double dt, const double gravity[MAX_DIM], int i) {
    const struct bed_lines *x = b->lines;
    double sum = 0, carried = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        sum += s.sign * b->set.shapes->area[s.shape] * x->U[s.face] * (x->P[s.right][s.face] - x->p[i]);
    }
    for (int k = b->dim; k < b->components; k++) carried += gravity[k] * (x->u[k][i] + x->after[k + 1][i]);
    return dt * (sum / b->set.shapes->volume[b->set.body[i]] + 0.5 * x->rho[i] * carried);
}

/* Returns the work (J/m^3) of friction on the velocity of a cell. */
static double rubbed_in_cell(const struct bed *b, int i) {
    const struct bed_lines *x = b->lines;
    double moved = 0;
    for (int k = 0; k < b->components; k++) moved += x->rubbed[k][i] * (x->u[k][i] + x->after[k + 1][i]);
    return 0.5 * x->rho[i] * moved;
}

/* Returns the work (J/m^3) of friction on U, with the heat that the faces of a cell lack by it (heat_of_side). */
static double rubbed_on_faces(const struct bed *b, double dt, int i) {
    const struct bed_lines *x = b->lines;
    double sum = 0;
    for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1]; j++) {
        const struct bed_side s = bed_side(b, j);
        const double mean =
            0.5 * (bed_pushed_speed(b, x->u, i, s.shape) + bed_pushed_speed(b, x->after + 1, i, s.shape));
        sum += s.sign * b->set.shapes->area[s.shape] * carried(b, &s, i, dt) * (x->U[s.face] - mean);
    }
    return dt * sum / b->set.shapes->volume[b->set.body[i]];
}

/* Sets eps behind acoustics, and counts lifting and work. Returns whether no cell was lifted too much. */
static bool find_eps(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    double *after = b->lines->after[b->components + 1];
    bool fine = true;
    b->lifted = 0;
    for (int block = 0; block < b->set.blocks; block++) {
        b->set.lift[block] = b->set.work[block] = b->set.rubbed[block] = 0;
        for (int i = b->set.first[block]; i < b->set.first[block + 1]; i++) {
            const double V = b->set.shapes->volume[b->set.body[i]], least = least_of(b, i);
            const double moved = b->rub ? rubbed_on_faces(b, dt, i) : 0,
                         rubbed = b->rub ? rubbed_in_cell(b, i) + moved : 0,
                         warms = b->rub ? bed_warms(b, dt, i, b->lines->after + 1, -moved) : 0;
            const double eps = b->rub ? eps_after(b, dt, i) + warms / b->lines->rho[i] : eps_after(b, dt, i);
            const double lift = eps < least ? b->lines->rho[i] * (least - eps) : 0;
            after[i] = larger(eps, least);
            b->set.work[block] += V * work_on_cell(b, dt, gravity, i);
            b->set.rubbed[block] += V * (rubbed + warms);
            b->set.lift[block] += V * lift;
            b->lifted += lift > 0;
            fine &= lift == 0 || lift <= bed_energy_near(b, i);
        }
    }
    return fine;
}

bool bed_update(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    find_tilts(b);
    find_pressures(b, gravity);
    find_face_pressures(b, dt, gravity);
    for (int i = 0; i < b->set.cells; i++) move_cell(b, dt, gravity, i);
    bed_fill(b, b->rub && b->friction.params.heating > 0 ? b->components : b->dim, b->lines->after + 1);
    if (b->rub) bed_find_work(b, b->lines->after + 1);
    find_heat(b, dt);
    pass_heat(b, dt);
    const bool fine = find_eps(b, dt, gravity);
    bed_fill(b, b->components + 2, b->lines->after);
    return fine;
}

/* Sums the forces that move_cell adds to those of p_f by taking p_f - P: the weight, as sum_f A n (x_f - x) = V, and
 * `balance`. */
void bed_push(struct bed *b, double dt, const double gravity[MAX_DIM], int axis) {
    for (int block = 0; block < b->set.blocks; block++) {
        b->set.pushed[block] = 0;
        for (int i = b->set.first[block]; i < b->set.first[block + 1]; i++) {
            double force = b->lines->rho[i] * b->set.shapes->volume[b->set.body[i]] * gravity[axis];
            for (int j = b->set.face_start[i]; j < b->set.face_start[i + 1] && b->set.balanced && axis < b->dim; j++) {
                const struct bed_side s = bed_side(b, j);
                if (b->set.kind[s.face] == BED_WALL) continue;
                force += s.sign * b->set.shapes->area[s.shape] * b->set.shapes->normal[axis][s.shape] *
                         b->set.balance[s.right][s.face];
            }
            b->set.pushed[block] += dt * force;
        }
    }
    bed_deal_pushed(b);
}
