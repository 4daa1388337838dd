/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/run.h"

#include "libcore/models/boundary.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- units and axes ---- */

const struct problem *view_origin(const struct problem *p) {
    return p->seen ? p->seen : p;
}
int view_axis(const struct problem *p, int axis) {
    return p->view && !p->polyhedral ? p->view->axis[axis] : axis;
}
int view_patch(const struct problem *p, int patch) {
    if (!p->view || p->polyhedral || patch / 2 >= p->dim) return patch;
    return 2 * p->view->axis[patch / 2] + ((patch & 1) ^ p->view->flip[patch / 2]);
}
long view_cell(const struct problem *p, long cells, long cell) {
    if (p->polyhedral && p->view && p->view->reversed) return cells - 1 - cell;
    if (!p->view || p->polyhedral) return cell;
    const int *n = p->n, *old = p->seen->n;
    const long at[3] = {cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]};
    long was[3];
    for (int k = 0; k < 3; k++) was[p->view->axis[k]] = p->view->flip[k] ? n[k] - 1 - at[k] : at[k];
    return was[0] + old[0] * (was[1] + old[1] * was[2]);
}
void view_turn(const struct problem *p, double x[3]) {
    const double old[3] = {x[0], x[1], x[2]};
    for (int k = 0; k < 3 && p->view; k++) x[k] = p->view->flip[k] ? -old[p->view->axis[k]] : old[p->view->axis[k]];
}

static double to(double base, int exponent) {
    double x = 1;
    for (int i = 0; i < abs(exponent); i++) x = exponent > 0 ? x * base : x / base;
    return x;
}
static double unit(const struct view *v, int kg, int m, int s) {
    return to(v->kg, kg) * to(v->m, m) * to(v->s, s);
}
static double density_unit(const struct problem *p) {
    return unit(p->view, 1, p->material.disks ? -2 : -3, 0);
}

/* Parameters of a row, by the units of its table. */
static void see_params(const struct problem *p, const struct model *row, struct own_params *own) {
    for (int i = 0; i < row->nparam; i++) {
        const struct param *q = &row->param[i];
        double *x = (double *)((char *)own + q->offset);
        if (q->kind != PARAM_NUMBER && q->kind != PARAM_VECTOR) continue;
        for (int k = 0; k < (q->kind == PARAM_VECTOR ? 3 : 1); k++)
            x[k] *= unit(p->view, q->unit[0], q->unit[1], q->unit[2]);
        if (q->kind == PARAM_VECTOR) view_turn(p, x);
    }
}

/* The drag pulls towards gas that moves along, too. */
static void move_along(struct problem *q) {
    const struct model *row = source_count ? &source_table[0].model : NULL;
    q->components = (int)larger(q->components, q->dim + 1);
    for (int s = 0; s < source_count; s++, row = &source_table[s].model)
        for (int i = 0; i < row->nparam && q->source.on[s]; i++)
            if (row->param[i].kind == PARAM_VECTOR && !strcmp(row->param[i].name, "velocity"))
                ((double *)((char *)&q->source.params[s] + row->param[i].offset))[q->dim] += q->view->along;
}

void view_rules(const struct problem *p, struct patch_rules *rules) {
    struct rule *u = &rules->velocity;
    if (!p->view || p->view->along == 0) return;
    if (u->type == boundary_find("slip") || u->type == boundary_find("zeroGradient")) return;
    if (u->type == boundary_find("noSlip")) u->type = boundary_find("translatingWallVelocity");
    u->uniform[p->dim] += p->view->along;
    if (u->type != boundary_find("JohnsonJacksonSlip")) u->params.room[p->dim] += p->view->along;
}

static void see_edges(struct problem *q) {
    const struct view *v = q->view;
    const double speed = unit(v, 0, 1, -1), heat = unit(v, 0, 2, -2), rho = density_unit(q);
    for (int i = 0; i < 6; i++) {
        struct wall *w = &q->wall[i];
        struct gate *g = &q->gate[i];
        w->along *= speed;
        if (w->temperature && !strcmp(w->temperature, "fixedValue")) w->value *= heat;
        g->rho *= rho;
        for (int k = 0; k < 3; k++) g->u[k] *= speed;
        g->T *= g->pressure ? rho * heat : heat;
    }
}

struct problem problem_seen(const struct problem *p, const struct view *v) {
    struct problem q = *p;
    q.seen = p;
    q.view = v;
    for (int k = 0; k < 3 && !p->polyhedral; k++) q.n[k] = p->n[v->axis[k]];
    q.material.diameter *= v->m;
    q.material.mass *= v->kg;
    q.material.threshold *= unit(v, 0, 1, -1);
    for (int k = 0; k < 3; k++) q.source.gravity[k] *= unit(v, 0, 1, -2);
    view_turn(&q, q.source.gravity);
    q.source.frequency *= unit(v, 0, 0, -1);
    q.end *= v->s;
    q.friction_params.cohesion *= density_unit(&q) * unit(v, 0, 2, -2);
    for (int i = 0; i < source_count; i++)
        if (p->source.on[i]) see_params(&q, &source_table[i].model, &q.source.params[i]);
    if (p->source.cooling) see_params(&q, &p->source.cooling->model, &q.source.cooling_params);
    if (p->transport) see_params(&q, &p->transport->model, &q.transport_params);
    if (p->acoustics) see_params(&q, &p->acoustics->model, &q.acoustics_params);
    see_edges(&q);
    if (v->along != 0) move_along(&q);
    return q;
}

/* ---- mesh and states ---- */

static status reverse_cells(struct polymesh *m, double *place) {
    int *patch;
    TRY(allocate(&patch, m->nfaces, sizeof *patch, "faces"));
    for (int f = 0; f < m->nfaces; f++) {
        patch[f] = -1;
        m->owner[f] = m->ncells - 1 - m->owner[f];
        if (f < m->ninternal) m->neighbour[f] = m->ncells - 1 - m->neighbour[f];
    }
    for (int i = 0; i < m->npatches; i++)
        for (int f = 0; f < m->patch[i].nfaces; f++) patch[m->patch[i].start + f] = i;
    for (long i = 0; i < m->ncells / 2; i++)
        for (int k = 0; k < 3; k++) {
            double *a = &place[3 * i + k], *b = &place[3 * (m->ncells - 1 - i) + k], keep = *a;
            *a = *b;
            *b = keep;
        }
    int *neighbour; /* as long as polymesh_order wants it */
    status s = allocate(&neighbour, m->nfaces, sizeof *neighbour, "faces");
    for (int f = 0; !s && f < m->nfaces; f++) neighbour[f] = f < m->ninternal ? m->neighbour[f] : -1;
    if (!s) {
        free(m->neighbour);
        m->neighbour = neighbour;
        s = polymesh_order(m, patch);
    }
    free(patch);
    return s;
}

/* Equal numbers change alike, so that plane sides stay plane. */
static double jitter_of(const struct view *v, uint64_t number) {
    return number * 0xd1342543de82ef95u >> 63 ? v->jitter : -v->jitter;
}

static void turn_faces(struct polymesh *m) {
    for (int f = 0; f < m->nfaces; f++)
        for (int i = m->face_start[f] + 1, j = m->face_start[f + 1] - 1; i < j; i++, j--) {
            const int keep = m->face_points[i];
            m->face_points[i] = m->face_points[j];
            m->face_points[j] = keep;
        }
}

status view_mesh(const struct problem *p, struct polymesh *m, double *place) {
    const struct view *v = p->view;
    if (!v) return OK;
    bool odd = v->axis[0] != 0 && v->axis[2] == 2; /* axes are swapped, or go round */
    for (int k = 0; k < 3; k++) odd ^= v->flip[k];
    for (long i = 0; i < m->npoints; i++) {
        double *x = m->points + 3 * i;
        view_turn(p, x);
        for (int k = 0; k < 3; k++) x[k] *= v->m * (1 + jitter_of(v, bits_of(x[k])));
    }
    if (odd) turn_faces(m);
    return v->reversed ? reverse_cells(m, place) : OK;
}

void view_start(const struct problem *p, long cell, double *rho, double u[3], double *T) {
    const struct view *v = p->view;
    if (!v) return;
    const double speed = unit(v, 0, 1, -1), part = 1 + jitter_of(v, (uint64_t)cell);
    *rho *= density_unit(p) * part;
    *T *= speed * speed / part;
    for (int k = 0; k < 3; k++) u[k] *= speed * part;
    view_turn(p, u);
    if (v->along != 0) u[p->dim] += v->along;
}

void view_end(const struct problem *p, long cells, int variables, double *const U[MAX_VAR], double *out) {
    const struct view *v = p->view;
    for (long i = 0; i < cells; i++)
        for (int x = 0; x < variables; x++) {
            const int k = x - 1;
            const bool vector = x > 0 && k < 3 && x + 1 < variables;
            const int old = v && vector ? 1 + v->axis[k] : x;
            double value = U[x][i];
            if (v)
                value /= density_unit(p) * unit(v, 0, 1, -1) *
                         (x == 0   ? 1 / unit(v, 0, 1, -1)
                          : vector ? 1
                                   : unit(v, 0, 1, -1));
            if (v && vector && v->flip[k]) value = -value;
            out[old * cells + (v ? view_cell(p, cells, i) : i)] = 0 + value; /* 0 + x makes -0 to 0 */
        }
    for (long i = 0; v && v->along != 0 && i < cells; i++) {
        double *m = &out[(1 + p->dim) * cells + i], *E = &out[(variables - 1) * cells + i];
        *E -= v->along * (*m - 0.5 * v->along * out[i]);
        *m -= v->along * out[i];
    }
}

/* ---- comparisons ---- */

enum { JITTERS = 3, BINARY = JITTERS, FOURTH, DECIMAL, MIRROR, SWAP, TURN, REVERSED, ALONG, VIEWS };
static const struct view views[VIEWS] = {
    {"values in other last digits", 1, 1, 1, {0, 1, 2}, {false, false, false}, false, 0x1p-43, 0},
    {"values in other last digits", 1, 1, 1, {0, 1, 2}, {false, false, false}, false, -0x1p-43, 0},
    {"values in other last digits", 1, 1, 1, {0, 1, 2}, {false, false, false}, false, 0x1.8p-43, 0},
    {"units of powers of two", 0x1p-20, 0x1p7, 0x1p-9, {0, 1, 2}, {false, false, false}, false, 0, 0},
    {"units of powers of four", 0x1p10, 0x1p4, 0x1p-6, {0, 1, 2}, {false, false, false}, false, 0, 0},
    {"units of powers of ten", 1e-3, 1e2, 1e1, {0, 1, 2}, {false, false, false}, false, 0, 0},
    {"the mirror image", 1, 1, 1, {0, 1, 2}, {true, false, false}, false, 0, 0},
    {"axes swapped", 1, 1, 1, {1, 0, 2}, {false, false, false}, false, 0, 0},
    {"turned by 90 degrees", 1, 1, 1, {1, 0, 2}, {true, false, false}, false, 0, 0},
    {"cells in the opposite order", 1, 1, 1, {0, 1, 2}, {false, false, false}, true, 0, 0},
    {"all in motion along an axis that the mesh lacks", 1, 1, 1, {0, 1, 2}, {false, false, false}, false, 0, 0},
};

/* Can all move along an axis that the mesh lacks? Without transport noSlip turns the velocity, and is at rest. */
static bool has_room_along(const struct problem *p) {
    bool turned = false;
    for (int i = 0; i < 2 * p->dim && !p->transport; i++)
        turned |= p->wall[i].velocity && !strcmp(p->wall[i].velocity, "noSlip");
    return !turned && p->dim < (p->material.disks ? 2 : 3);
}

/* Is a view one of this problem? */
static bool applies(const struct problem *p, int view) {
    const bool flat = p->stretch > 1 || p->squash > 1 || p->sliver > 0; /* fits drop what depends on the axes before */
    if (view == ALONG) return has_room_along(p);
    if (view == SWAP || view == TURN) return p->dim > 1 && !(p->polyhedral && flat);
    return view != REVERSED || p->polyhedral;
}

/* Must the bits be the same? Sums over three axes follow the order of the axes. A bed is solved to a tolerance, and its
 * sums follow the order of cells; PETSc's, too. */
static bool keeps_bits(const struct problem *p, const struct outcome *first, int view) {
    const bool solved = first->beds > 0 || p->friction || (p->diffusion && !p->diffusion->plan);
    if (view == BINARY) return !first->beds && !p->friction; /* roots of pivots and densities */
    const int axes = p->components > p->dim ? p->components : p->dim;
    if (view == FOURTH) return true;
    return (view == MIRROR || ((view == SWAP || view == TURN) && axes < 3)) && !p->polyhedral && !solved;
}

/* The largest sum of differences of a variable, over the sum of its magnitudes; momenta over rho (|u| + sqrt(E/rho)).
 * A momentum that b alone has must be 0. */
static double difference(const struct outcome *a, const struct outcome *b) {
    const long n = a->cells;
    const int last = b->variables - 1, of_a = a->variables - 1;
    double off[MAX_VAR] = {0}, size[MAX_VAR] = {0}, most = 0;
    for (int x = 0; x <= last; x++)
        for (long i = 0; i < n; i++) {
            const double *s = a->state, E = s[of_a * n + i];
            const double value = x == last ? E : x < of_a ? s[x * n + i] : 0;
            off[x] += fabs(value - b->state[x * n + i]);
            size[x] += x == 0 || x == last ? fabs(value) : sqrt(fabs(s[i] * E));
        }
    for (int x = 0; x <= last; x++) most = larger(most, off[x] / larger(size[x], 1e-300));
    return most;
}

/* A speed at which all can move along: the thermal speed at the end, in the mean, but at most ten times the
 * least one, so that E keeps the digits of the energy of cold cells. */
static double speed_along(const struct outcome *first) {
    const long n = first->cells;
    const int last = first->variables - 1;
    const double *s = first->state;
    double mass = 0, heat = 0, least = HUGE_VAL;
    for (long i = 0; i < n; i++) {
        double square = 0;
        for (int k = 1; k < last; k++) square += s[k * n + i] * s[k * n + i];
        const double warm = s[last * n + i] - 0.5 * square / s[i];
        mass += s[i];
        heat += warm;
        least = smaller(least, larger(warm, 0) / s[i]);
    }
    return sqrt(smaller(heat / mass, 100 * least));
}

/* Views solve implicit diffusion to this part of a cell's T, on a path that follows the order of the unknowns; a run
 * has some hundred solutions. */
#define SOLVED    1e-11
#define SOLUTIONS 100

static status see(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                  const struct comm *c, int view, const struct outcome *first, struct outcome *out) {
    struct view v = views[view];
    if (view == ALONG) v.along = speed_along(first);
    const struct problem q = problem_seen(p, &v);
    struct run_options bare = *o;
    bare.bare = bare.keep = true;
    bare.solved = SOLVED;
    return stress_run(&q, scheme, &bare, c, out);
}

/* Where the last digits of the start change the end as much as this, any rounding does. */
#define CHAOS 1e-6
/* Rounding may differ once more at each of some stages: the start's last digits change it at one time alone. */
#define MORE 10
/* Momenta below 1e-25 feel the epsilon of WENO weights, which has a unit; differences of that size do not count. */
#define UNITLESS 1e-30
/* The sectors of CWENO3 are found in single precision, whose round-off depends on the axes and the order of cells. Each
 * step rounds anew, and such errors add up as the root of their number. */
#define SINGLE 0x1p-24

static void judge_view(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                       const struct outcome *first, struct outcome seen[VIEWS], int view, struct outcome *out) {
    const struct outcome *s = &seen[view];
    double off = difference(first, s), jitter = 0;
    for (int i = 0; i < JITTERS; i++) jitter = larger(jitter, difference(first, &seen[i]));
    const bool bits = keeps_bits(p, first, view);
    const double same = view == BINARY || view == FOURTH ? UNITLESS : 0;
    const bool solved = p->diffusion && !p->diffusion->plan;
    const bool single = p->polyhedral && !strcmp(scheme->polynomial, "CWENO3");
    const double least = larger(solved ? SOLUTIONS * SOLVED : 0, single ? MORE * SINGLE * sqrt(first->steps) : 0);
    const double allowed = bits ? same : jitter > CHAOS ? HUGE_VAL : larger(MORE * jitter, least);
    if (o->verbose) printf("  view %s: off by %.3g, allowed %.3g\n", views[view].name, off, allowed);
    if (off <= allowed && (!bits || s->steps == first->steps)) return;
    out->verdict = FAILED;
    snprintf(out->why, sizeof out->why, "%s: off by %.3g after %d steps (%d), %.3g is allowed", views[view].name, off,
             s->steps, first->steps, allowed);
}

status views_compare(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                     const struct comm *c, struct outcome *out) {
    struct outcome seen[VIEWS] = {{0}}, first = {0};
    if (p->radial >= 0 || out->verdict == FAILED) return OK;
    struct run_options bare = *o;
    bare.bare = bare.keep = true;
    bare.solved = SOLVED;
    status e = stress_run(p, scheme, &bare, c, &first);
    for (int i = 0; i < VIEWS && !e && out->verdict != FAILED; i++) {
        if (!applies(p, i)) continue;
        e = see(p, scheme, o, c, i, &first, &seen[i]);
        if (!e && i >= JITTERS) judge_view(p, scheme, o, &first, seen, i, out);
    }
    free(first.state);
    for (int i = 0; i < VIEWS; i++) free(seen[i].state);
    return e;
}
