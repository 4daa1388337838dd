/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works on rows of cells alike on a lattice and on polyhedra: velocities and temperatures, the fields that the outside
 * asks for, sources, the check of admissibility. */
#include "libcore/gas/gas_private.h"

/* The squares are summed from the last axis so that two of three commute under a swap of axes. */
ALWAYS_INLINE void velocity_dim(const int dim, int n, long size, const double *restrict U, double *const *velocity,
                                double *restrict eps) {
    double *const u[MAX_DIM] = {velocity[0], velocity[dim > 1 ? 1 : 0], velocity[dim > 2 ? 2 : 0]};
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const double inverse = 1 / U[i];
        double square = 0;
        for (int k = dim - 1; k >= 0; k--) {
            const double uk = U[(k + 1) * size + i] * inverse;
            u[k][i] = uk;
            square += uk * uk;
        }
        eps[i] = U[(dim + 1) * size + i] * inverse - 0.5 * square;
    }
}
KERNEL static void find_velocity(int n, int dim, long size, const double *restrict U, double *const *velocity,
                                 double *restrict eps) {
    if (dim == 1) velocity_dim(1, n, size, U, velocity, eps);
    if (dim == 2) velocity_dim(2, n, size, U, velocity, eps);
    if (dim == 3) velocity_dim(3, n, size, U, velocity, eps);
}

KERNEL static void take_roots(int n, double *restrict c) {
    for (int i = 0; i < n; i++) c[i] = sqrt(c[i]);
}

/* velocity_row, root_row and update_rows wrap kernels: functions with clones cannot be called from other files, as
 * clang leaves their names undefined there. */
void velocity_row(int n, int dim, long size, const double *restrict U, double *const *velocity, double *restrict eps) {
    find_velocity(n, dim, size, U, velocity, eps);
}
void root_row(int n, double *restrict c) {
    take_roots(n, c);
}

KERNEL static void update_lines(int n, int nvar, long size, const struct advance *restrict s) {
    const double *U0 = s->U0, *from = s->from, *residual = s->residual;
    double *to = s->to;
    const double a = s->a, dt = s->dt;
    const long each = s->each;
    for (int v = 0; v < nvar; v++)
        for (int i = 0; i < n; i++) {
            const double moved = from[v * size + i] + dt * residual[v * each + i];
            to[v * size + i] = moved + a * (U0[v * size + i] - moved);
        }
}

void update_rows(const struct gas *g, int n, const struct advance *s) {
    update_lines(n, g->nvar, g->size, s);
}

/* Returns the power of gravity rho u.g, summed from the last axis on: of three terms two then commute to the bit. */
ALWAYS_INLINE double power_of(const int dim, long size, const double *restrict mom, const double g[MAX_DIM], int i) {
    double sum = mom[(dim - 1) * size + i] * g[dim - 1];
    if (dim > 2) sum += mom[size + i] * g[1];
    if (dim > 1) sum += mom[i] * g[0];
    return sum;
}

/* Does what update_lines does, and adds gravity to the residuals of momentum and energy where `share` is 1; where it is
 * 0 nothing is added. */
ALWAYS_INLINE void update_falling_dim(const int dim, const bool some, int n, long size,
                                      const struct advance *restrict s, const double *gravity,
                                      const double *restrict share) {
    const double *U0 = s->U0, *from = s->from, *residual = s->residual;
    double *to = s->to;
    const double a = s->a, dt = s->dt;
    const long each = s->each;
    const double g[MAX_DIM] = {gravity[0], gravity[1], gravity[2]};
    for (int v = 0; v < dim + 2; v++) {
        const double one = v >= 1 && v <= dim ? g[v - 1] : 0;
        for (int i = 0; i < n; i++) {
            const double part = some ? share[i] : 1, all[MAX_DIM] = {part * g[0], part * g[1], part * g[2]};
            const double pull = v == 0     ? 0
                                : v <= dim ? from[i] * (part * one)
                                           : power_of(dim, size, from + size, all, i);
            const double gain = v == 0 ? residual[i] : residual[v * each + i] + pull;
            const double moved = from[v * size + i] + dt * gain;
            to[v * size + i] = moved + a * (U0[v * size + i] - moved);
        }
    }
}
KERNEL static void update_falling(int n, int dim, long size, const struct advance *restrict s, const double *gravity,
                                  const double *restrict share) {
#define EACH(axes, some)                                                                                               \
    if (dim == axes) update_falling_dim(axes, some, n, size, s, gravity, share)
    if (share) {
        EACH(1, true);
        EACH(2, true);
        EACH(3, true);
    } else {
        EACH(1, false);
        EACH(2, false);
        EACH(3, false);
    }
#undef EACH
}

void advance_row(const struct gas *g, int n, const struct advance *s, const double *falls, const double *flag) {
    double line[BATCH], *share = falls || flag ? line : NULL;
    for (int i = 0; i < n && share; i++) share[i] = (falls && falls[i] > 0) || (flag && flag[i] > 0) ? 0 : 1;
    if (g->falling.cells)
        update_falling(n, g->components, g->size, s, g->falling.gravity, share);
    else
        update_rows(g, n, s);
}

KERNEL static void weigh_all(int n, double gravity, const double *restrict rho, const double *restrict mom,
                             double *restrict force, double *restrict power) {
    for (int i = 0; i < n; i++) {
        force[i] += rho[i] * gravity;
        power[i] += mom[i] * gravity;
    }
}

KERNEL static void add_power(int n, const double *restrict power, double *restrict residual) {
    for (int i = 0; i < n; i++) residual[i] += power[i];
}

KERNEL static void weigh_some(int n, double gravity, const double *restrict share, const double *restrict rho,
                              const double *restrict mom, double *restrict force, double *restrict power) {
    for (int i = 0; i < n; i++) {
        force[i] += rho[i] * (share[i] * gravity);
        power[i] += mom[i] * (share[i] * gravity);
    }
}

void weigh_row(const struct gas *g, int n, const double *const U[MAX_VAR], const double *falls, const double *flag,
               double *const residual[MAX_VAR]) {
    double share[BATCH], power[BATCH] = {0}; /* summed from the last axis, so that two axes of three commute */
    const bool some = falls || flag;
    for (int i = 0; i < n && some; i++) share[i] = (falls && falls[i] > 0) || (flag && flag[i] > 0) ? 0 : 1;
    for (int k = g->components - 1; k >= 0; k--)
        if (some)
            weigh_some(n, g->falling.gravity[k], share, U[0], U[k + 1], residual[k + 1], power);
        else if (g->models.source.gravity[k] != 0)
            weigh_all(n, g->falling.gravity[k], U[0], U[k + 1], residual[k + 1], power);
    add_power(n, power, residual[energy_at(g)]);
}

const double *row_radius(const struct gas *g, int block, long at, int n, double *room) {
    const struct forest *f = g->forest;
    if (!f || f->radial < 0) return NULL;
    const double place = forest_place_along(f, block, at, f->radial) + 0.5;
    for (int i = 0; i < n; i++) room[i] = forest_radius(f, f->radial == 0 ? place + i : place);
    return room;
}

double face_radius(const struct gas *g, int block, long face) {
    const struct forest *f = g->forest;
    if (!f || f->radial < 0) return 1;
    const double shift = face / f->size == f->radial ? 0 : 0.5;
    return forest_radius(f, forest_place_along(f, block, face % f->size, f->radial) + shift);
}

void drop_begin(const struct gas *g) {
    if (g->falling.dropped) memset(g->falling.dropped, 0, (size_t)g->floors.places * sizeof *g->falling.dropped);
    if (g->falling.denser) memset(g->falling.denser, 0, (size_t)g->floors.places * sizeof *g->falling.denser);
}

void drop_row(const struct gas *g, int n, const struct advance *s, const double *falls, const double *flag,
              const double *part, double *dropped) {
    const long size = g->size;
    const double a = s->a, dt = s->dt;
    for (int i = 0; i < n; i++) {
        if ((falls && falls[i] > 0) || !(flag[i] > 0)) continue;
        const double rho = s->from[i] + dt * s->residual[i];
        double work = 0, more = 0;
        for (int k = g->components - 1; k >= 0; k--) {
            const double kick = dt * g->falling.gravity[k], moved = dt * s->residual[(k + 1) * s->each + i];
            s->to[(k + 1) * size + i] += (1 - a) * (rho * kick);
            work += kick * (s->from[(k + 1) * size + i] + moved + 0.5 * rho * kick);
            more += kick * (moved + 0.5 * rho * kick);
        }
        s->to[energy_at(g) * size + i] += (1 - a) * work;
        if (part && part[i] > 0) continue;
        const double weight = s->weight ? s->weight[i] : 1;
        dropped[i * g->floors.step] += weight * more;
        if (g->falling.denser)
            g->falling.denser[dropped - g->falling.dropped + i * g->floors.step] += weight * (dt * (rho - s->from[i]));
    }
}

void freeze_row(const struct gas *g, int n, const struct advance *s, const double *part) {
    for (int v = 0; v < g->nvar; v++) {
        const double *U0 = s->U0 + v * g->size;
        double *to = s->to + v * g->size;
        for (int i = 0; i < n; i++) to[i] = part[i] >= BED_FROZEN ? U0[i] : to[i];
    }
}

/* Takes the heat q = dt dilation div u from E, with coefficients of the beginning or of the end of a half step, whose
 * errors cancel in a whole step. In place of q it takes I z/sqrt(1 + z^2), z = q/I, with I the internal energy before
 * the stress: that is q but for terms of third order, and never more than I, as q would be in packed gas, where zeta_U
 * is large. */
KERNEL static void take_dilation(int n, double dt, const double *restrict dilation, const double *restrict spread,
                                 const double *restrict rho, const double *restrict eps, double *restrict E) {
    for (int i = 0; i < n; i++) {
        const double internal = rho[i] * eps[i], heat = dt * dilation[i] * spread[i];
        const double z = smaller(larger(heat / internal, -1e100), 1e100); /* squared it does not overflow */
        E[i] -= internal > 0 ? internal * (z / sqrt(1 + z * z)) : 0;
    }
}

void dilate_row(const struct gas *g, int n, double dt, const double *dilation, const double *spread, const double *U,
                double *E) {
    double velocity[MAX_DIM][BATCH], eps[BATCH], *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    velocity_row(n, g->components, g->size, U, u, eps);
    take_dilation(n, dt, dilation, spread, U, eps, E);
}

static int raise_marks(int n, const double *bad, double *marks) {
    int count = 0;
    for (int i = 0; i < n; i++) {
        count += bad[i] > 0;
        if (marks) marks[i] += bad[i];
    }
    return count;
}

int row_inadmissible(const struct gas *g, const double *U, long offset, int n, double *marks) {
    double bad[BATCH];
    if (!find_bad(n, g->components, g->size, g->limits.least, g->limits.most, U + offset, bad)) return 0;
    return raise_marks(n, bad, marks ? marks + offset : NULL);
}

int row_limited(const struct gas *g, int n, const double *from, const double *to, double *flags) {
    double bad[BATCH];
    const bool out = find_bad(n, g->components, g->size, g->limits.least, g->limits.most, to, bad);
    const bool crowded = g->limits.crowds && find_crowded(n, g->limits.most, from, to, bad);
    return out || crowded ? raise_marks(n, bad, flags) : 0;
}

void start_row(const struct gas *g, enum diffusing what, const struct state *Y0, const struct row *row, double pending,
               double *const *q) {
    const double *friction = g->diffusion.friction[row->block] + row->at,
                 *cooled = g->diffusion.cooled[row->block] + row->at;
    double velocity[MAX_DIM][BATCH], eps[BATCH], *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    velocity_row(row->n, g->components, g->size, Y0->block[row->block] + row->at, what == VISCOUS ? q : u, eps);
    for (int i = 0; i < row->n && what == HEAT; i++)
        q[0][i] =
            temperature_of(&g->models.material, eps[i]) - pending * friction[i] - (g->diffusion.late ? cooled[i] : 0);
}

KERNEL static void moved_line(int n, double factor, const double *restrict from, const double *restrict M,
                              double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = from[i] + factor * M[i];
}

int move_row(struct gas *g, const struct moved *m) {
    const int n = m->row.n, energy = energy_at(g);
    double moved[BATCH];
    for (int v = 0; v < g->nvar; v++) {
        const bool line = m->what == VISCOUS && v > 0 && v < energy, changes = line || v == energy;
        const double *from = (v == energy ? m->E : m->from + v * g->size) + m->row.at;
        if (changes) {
            const double factor = v == energy && m->what == VISCOUS ? 1 / m->dt : 1;
            moved_line(n, factor, from, m->M[line ? v - 1 : m->what == VISCOUS ? g->components : 0], moved);
        }
        if (changes || m->to != m->from)
            memcpy(m->to + v * g->size + m->row.at, changes ? moved : from, (size_t)n * sizeof(double));
    }
    const int bad = row_inadmissible(g, m->to, m->row.at, n, g->limits.flags.mark[m->row.block]);
    g->limits.flags.marked |= bad > 0;
    return bad;
}

const double *impacts_row(const struct gas *g, int n, const double *rho, double *out) {
    if (!friction_acts(g->models.friction)) return NULL;
    friction_share(&g->models.friction_params, &g->models.material, n, rho, out);
    for (int i = 0; i < n; i++) out[i] = 1 - out[i];
    return out;
}

void transport_row(const struct gas *g, const struct closure_line *cells, double *restrict bulk, double *restrict shear,
                   double *restrict heat) {
    static const double LEAST = 1e-9; /* walls divide by the viscosity */
    const struct gas_models *m = &g->models;
    double room[BATCH];
    const double *by_impacts = impacts_row(g, cells->n, cells->rho, room);
    m->transport->coefficients(&m->transport_params, cells, bulk, shear, heat);
    for (int i = 0; i < cells->n && by_impacts; i++) {
        const double left = larger(by_impacts[i], LEAST);
        bulk[i] *= left;
        shear[i] *= left;
    }
}

void temperature_row(const struct gas *g, int n, const double *U, double *T) {
    double velocity[MAX_DIM][BATCH], *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    velocity_row(n, g->components, g->size, U, u, T);
    for (int i = 0; i < n; i++) T[i] = temperature_of(&g->models.material, T[i]);
}

KERNEL static void scale_row(int n, double factor, const double *restrict q, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = factor * q[i];
}

/* Only what the field needs is computed, because the equation of state costs most. */
void field_row(const struct gas *g, enum gas_field field, int n, long size, const double *U, double *const out[3]) {
    const struct material *m = &g->models.material;
    double velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH], gruneisen[BATCH];
    double *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    if (field >= GAS_U) velocity_row(n, g->components, size, U, u, eps);
    if (field >= GAS_P) {
        g->models.eos->state(m, n, U, eps, p, c, gruneisen);
        root_row(n, c);
    }
    for (int k = 0; k < g->components && field == GAS_U; k++) memcpy(out[k], u[k], (size_t)n * sizeof(double));
    if (field == GAS_RHO) memcpy(out[0], U, (size_t)n * sizeof(double));
    if (field == GAS_ALPHA) scale_row(n, packing_per_density(m), U, out[0]);
    if (field == GAS_T) scale_row(n, temperature_of(m, 1), eps, out[0]);
    if (field == GAS_P) memcpy(out[0], p, (size_t)n * sizeof(double));
    if (field == GAS_C) memcpy(out[0], c, (size_t)n * sizeof(double));
    for (int i = 0; i < n && field == GAS_MACH; i++) {
        double square = 0;
        for (int k = 0; k < g->components; k++) square += u[k][i] * u[k][i];
        out[0][i] = sqrt(square) / c[i];
    }
}

/* Where the marks of a row's cells are, or go; NULL without gravity. */
static double *falls_of(const struct gas *g, const struct row *row) {
    return g->falling.cells ? g->falling.cells[row->block] + row->at : NULL;
}

/* Notes that a cell of the row falls. A background stands for all cells of its tile until their own rows come. */
static void note_falling(const struct gas *g, const struct row *row) {
    double *falls = g->falling.cells[row->block];
    g->falling.blocks[row->block] = true;
    for (long i = 1; g->forest && row->at == 0 && i < g->size; i++) falls[i] = 1;
}

struct cold_search { /* context of find_falling_row */
    const struct gas *g;
    const struct state *s;
    double warm;
};

static void find_falling_row(void *falling, const struct row *row) {
    const struct cold_search *f = falling;
    const struct gas *g = f->g;
    const double *U = f->s->block[row->block] + row->at, *part = g->dense ? g->dense->part[row->block] + row->at : NULL;
    double velocity[MAX_DIM][BATCH], eps[BATCH], *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    double *falls = g->falling.cells[row->block] + row->at;
    if (f->warm >= 0) velocity_row(row->n, g->components, g->size, U, u, eps);
    for (int i = 0; i < row->n; i++) {
        if (f->warm < 0)
            falls[i] = part && part[i] > 0 ? 0 : falls[i];
        else
            falls[i] = eps[i] < f->warm && !(part && part[i] >= BED_FROZEN) ? 1 : 0;
        g->falling.blocks[row->block] |= falls[i] > 0;
    }
}

void find_falling(struct gas *g, double warm, const struct state *s) {
    g->engine->state.rows(g, EVERY_CELL, s, find_falling_row, &(struct cold_search){g, s, warm});
}

/* Takes what the sources made of the last background, if that of the row's tile was the same. Returns false if they
 * are to be applied: then source_row fills h->after if h->known is set. */
static bool take_background(struct half_step *h, const struct row *row) {
    const struct gas *g = h->g;
    const double *from = h->from->block[row->block];
    double *to = h->to->block[row->block];
    bool same = h->known && !(g->falling.cells && g->falling.blocks[row->block]);
    for (int v = 0; v < g->nvar && same; v++) same = bits_of(from[v * g->size]) == bits_of(h->before[v]);
    for (int v = 0; v < g->nvar; v++)
        if (same)
            to[v * g->size] = h->after[v];
        else
            h->before[v] = from[v * g->size];
    h->known = true;
    return same;
}

void source_row(void *half_step, const struct row *row) {
    struct half_step *h = half_step;
    const struct gas *g = h->g;
    const double *from = h->from->block[row->block];
    double *to = h->to->block[row->block], *U[MAX_VAR];
    const bool background = g->forest && row->at == 0;
    if (background && take_background(h, row)) return;
    for (int v = 0; v < g->nvar; v++) {
        U[v] = to + v * g->size + row->at;
        if (from != to) memcpy(U[v], from + v * g->size + row->at, (size_t)row->n * sizeof(double));
    }
    double room[BATCH];
    const double *shear_rate = h->shear_rate ? h->shear_rate[row->block] + row->at : NULL;
    const double *by_impacts = shear_rate ? impacts_row(g, row->n, U[0], room) : NULL;
    const bool find = g->falling.cells && h->plan->warm >= 0;
    const bool acts = find || !h->plan->gravity_alone || g->falling.blocks[row->block];
    const bool falling = acts && source_apply(h->plan, row->n, U, falls_of(g, row), shear_rate, by_impacts);
    if (falling && find) note_falling(g, row);
    const int bad = row_inadmissible(g, to, row->at, row->n, NULL);
    h->bad += bad;
    if (!background) return;
    for (int v = 0; v < g->nvar; v++) h->after[v] = to[v * g->size];
    h->known = !falling && !bad && !(g->falling.cells && g->falling.blocks[row->block]);
}

long sources_apply(struct gas *g, const struct source_plan *plan, const struct state *from, const struct state *to) {
    struct half_step h = {.g = g, .from = from, .to = to, .plan = plan};
    if (sources_ask(g)) h.shear_rate = g->diffusion.shear_rate.now;
    g->engine->state.rows(g, EACH_STATE, from, source_row, &h);
    spans_keep_as(g, from, to);
    return h.bad;
}
