/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/run.h"

#include "libcore/polyhedral/cells.h"
#include "mesh/lattice/box.h"
#include "solvers/gas/linear.h"
#include "tests/defaults.h"
#include "tests/stress/contact.h"
#include "tests/stress/watch.h"

#include <stdio.h>

struct scene { /* the mesh and the gas of a problem */
    const struct problem *problem;
    const struct comm *comm;
    struct gas_models models;
    struct patch_rules rules[6];
    int cells;
    struct box box;
    struct forest *forest;
    struct sample sample;
    double *centre, *volume; /* polyhedral: [cells][3], [cells] */
    double *place;           /* [cells][3] centres of polyhedra as they were drawn */
    struct grid *grid;
    struct gas *gas;
};

static bool is_periodic(const struct problem *p, int axis) {
    return p->edge == PERIODIC && axis != p->radial && !(view_axis(p, axis) == 0 && p->walls_along);
}

static void set_wall(const struct wall *w, int axis, struct patch_rules *rules) {
    const struct own_params rough = {{w->specularity, w->restitution, w->mu}};
    struct rule *u = &rules->velocity, *T = &rules->temperature;
    *u = (struct rule){.type = boundary_find(w->velocity)};
    *T = (struct rule){.type = boundary_find(w->temperature), .params = {{w->value, w->mu}}, .uniform = {w->value}};
    u->uniform[axis == 0] = u->params.room[axis == 0] = w->along;
    if (u->type == boundary_find("frictionalSlip")) u->params.room[3] = w->mu;
    if (u->type == boundary_find("JohnsonJacksonSlip")) u->params = rough;
    if (T->type == u->type) T->params = rough;
}

static void set_gate(const struct gate *g, struct patch_rules *rules) {
    rules->density = (struct rule){.type = boundary_find(g->density), .uniform = {g->rho}};
    rules->velocity = (struct rule){.type = boundary_find(g->velocity), .uniform = {g->u[0], g->u[1], g->u[2]}};
    rules->temperature = (struct rule){.type = boundary_find(g->temperature), .uniform = {g->T}};
    rules->pressure = g->pressure;
}

/* Implicit diffusion needs PETSc's module; where there is none, RKJ2 takes its place. */
static void set_linear(struct gas_models *m) {
    if (!m->diffusion || m->diffusion->plan) return;
    status missing = linear_load(&m->linear);
    if (missing) m->diffusion = diffusion_find("RKJ2");
    status_free(missing);
}

static void set_models(struct scene *s, const struct scheme *scheme, const struct run_options *o) {
    const struct problem *p = s->problem;
    s->models = (struct gas_models){.material = p->material,
                                    .eos = p->eos,
                                    .source = p->source,
                                    .flux = flux_find(scheme->flux),
                                    .flux_params = own_defaults(&flux_find(scheme->flux)->model),
                                    .reconstruct = reconstruct_find(scheme->reconstruct),
                                    .stepper = stepper_find(scheme->stepper),
                                    .polynomial = polynomial_find(scheme->polynomial),
                                    .transport = p->transport,
                                    .transport_params = p->transport_params,
                                    .friction = o->explicit ? NULL : p->friction,
                                    .friction_params = p->friction_params,
                                    .diffusion = p->diffusion,
                                    .linear_error = o->solved,
                                    .acoustics = o->explicit ? NULL : p->acoustics,
                                    .acoustics_params = p->acoustics_params,
                                    .alpha_floor = p->alpha_floor,
                                    .skip_uniform = !o->full,
                                    .components = p->components,
                                    .swirl = p->swirl};
    set_linear(&s->models);
    for (int i = 0; i < 6; i++) {
        const int drawn = view_patch(p, i);
        bool open = p->edge == OPEN_ENDED && !(drawn < 2 && p->walls_along) && !p->gate[drawn].shut;
        s->rules[i] = (struct patch_rules){.density = {.type = NULL}};
        s->rules[i].density.type = s->rules[i].temperature.type = boundary_find("zeroGradient");
        s->rules[i].velocity.type = boundary_find(open ? "zeroGradient" : "slip");
        if (!open && p->wall[drawn].velocity) set_wall(&p->wall[drawn], drawn / 2, &s->rules[i]);
        if (open && p->gate[drawn].velocity) set_gate(&p->gate[drawn], &s->rules[i]);
        struct rule *u = &s->rules[i].velocity;
        view_turn(p, u->uniform);
        if (u->type != boundary_find("JohnsonJacksonSlip")) view_turn(p, u->params.room);
        view_rules(p, &s->rules[i]);
    }
}

/* Widths grow along x by `stretch` in all; y and z are squashed; one corner in four moves most of the way to the next
 * one along x, so that slivers and tiny cells lie beside large ones. */
static void spoil_points(const struct problem *p, struct polymesh *m, double sliver) {
    struct seed s = seed_start(1000 + p->family, p->seed);
    const int across = p->n[0] + 1, up = p->n[1] + 1, layer = across * up;
    double factor = p->stretch > 1.001 ? power(p->stretch, 1. / p->n[0]) : 1;
    for (int i = 0; i < layer * (p->n[2] + 1); i++) {
        int at[3] = {i % across, i / across % up, i / layer};
        bool inner = at[0] > 0 && at[0] + 1 < p->n[0] && at[1] > 0 && at[1] < p->n[1] &&
                     (p->dim == 2 || (at[2] > 0 && at[2] < p->n[2]));
        bool twin = p->dim == 2 && at[2] > 0;
        double *x = m->points + 3 * i;
        if (!inner && p->edge == PERIODIC) /* halves must match */
            for (int k = 0; k < p->dim; k++) x[k] = (double)at[k] / p->n[k];
        if (twin) {
            for (int k = 0; k < 2; k++) x[k] = m->points[3 * (i - layer) + k];
            continue;
        }
        if (inner && sliver > 0 && at[0] % 2 == 0 && at[1] % 2 == 0 && seed_chance(&s, 0.5))
            for (int k = 0; k < p->dim; k++) x[k] += sliver * (m->points[3 * (i + 1) + k] - x[k]);
    }
    for (int i = 0; i < layer * (p->n[2] + 1); i++) {
        double *x = m->points + 3 * i, place = x[0] * p->n[0];
        if (factor > 1) x[0] = (power(factor, place) - 1) / (power(factor, p->n[0]) - 1);
        for (int k = 1; k < p->dim; k++) x[k] /= p->squash;
    }
}

/* Radial cells stand for a body around the third axis. */
static struct revolution round_of(const struct problem *p) {
    if (p->radial < 0) return (struct revolution){.on = false};
    return (struct revolution){
        .on = true, .axial = p->dim == 2 ? 1 - p->radial : 2, .radial = p->radial, .at = -p->inner, .depth = 1};
}

static status sort_cyclic(const struct problem *p, struct polymesh *m) {
    int *patch, *neighbour; /* as long as polymesh_order wants it */
    TRY(allocate(&neighbour, m->nfaces, sizeof *neighbour, "faces"));
    memcpy(neighbour, m->neighbour, (size_t)m->ninternal * sizeof *neighbour);
    free(m->neighbour);
    m->neighbour = neighbour;
    TRY(allocate(&patch, m->nfaces, sizeof *patch, "faces"));
    for (int i = 0; i < m->npatches; i++) {
        struct patch *q = &m->patch[i];
        for (int f = q->start; f < q->start + q->nfaces; f++) {
            patch[f] = i;
            m->neighbour[f] = -1;
        }
        if (i / 2 >= p->dim || !is_periodic(p, i / 2)) continue;
        free(q->type);
        q->type = strdup("cyclic");
        q->neighbour = strdup(m->patch[i ^ 1].name);
    }
    status s = polymesh_order(m, patch);
    free(patch);
    return s;
}

static status make_sample(const struct problem *p, double sliver, struct sample *sample) {
    const double length[3] = {1, 1, 1};
    TRY(sample_make(sample, p->shape, p->n, length, p->noise));
    spoil_points(p, sample->mesh, sliver);
    if (p->edge == PERIODIC) TRY(sort_cyclic(p, sample->mesh));
    return polymesh_check(sample->mesh);
}

/* Where a corner cannot go so far, it goes less far. */
static status make_polyhedra(struct scene *s) {
    double sliver = s->problem->sliver;
    status fault = OK;
    for (int tries = 0; tries < 8; tries++, sliver *= tries < 7 ? 0.7 : 0) {
        status_free(fault);
        fault = make_sample(view_origin(s->problem), sliver, &s->sample);
        if (!fault) break;
        sample_free(&s->sample);
        s->sample = (struct sample){.mesh = NULL};
    }
    TRY(fault);
    struct polymesh *m = s->sample.mesh;
    m->round = round_of(s->problem);
    double *face;
    s->cells = m->ncells;
    TRY(allocate(&face, 6L * m->nfaces, sizeof *face, "faces"));
    status e = allocate(&s->centre, 7L * m->ncells, sizeof *s->centre, "cells");
    if (!e) {
        s->volume = s->centre + 3L * m->ncells;
        s->place = s->volume + m->ncells;
        polymesh_face_geometry(m, face, face + 3L * m->nfaces);
        e = polymesh_cell_geometry(m, face, face + 3L * m->nfaces, s->place, s->volume);
    }
    if (!e) e = view_mesh(s->problem, m, s->place);
    if (!e) {
        polymesh_face_geometry(m, face, face + 3L * m->nfaces);
        e = polymesh_cell_geometry(m, face, face + 3L * m->nfaces, s->centre, s->volume);
    }
    free(face);
    TRY(e);
    return grid_make(NULL, m, s->centre, s->comm, s->models.polynomial->rings, s->models.stepper->local, &s->grid);
}

static status make_lattice(struct scene *s) {
    const struct problem *p = s->problem;
    double length[3];
    for (int k = 0; k < 3; k++) length[k] = (view_axis(p, k) == 0 ? 1 : 1 / p->squash) * (p->view ? p->view->m : 1);
    const bool wrapped[3] = {is_periodic(p, 0), is_periodic(p, 1), is_periodic(p, 2)};
    TRY(box_make(&s->box, p->dim, p->n, length, wrapped));
    s->box.mesh.round = round_of(p);
    s->cells = s->box.mesh.ncells;
    return forest_make(&s->box.lattice, &s->box.mesh, s->comm, p->dim == 1 ? 16 : p->dim == 2 ? 8 : 4, &s->forest);
}

static status make_gas(struct scene *s) {
    return s->forest ? gas_make(s->forest, &s->models, 6, s->rules, &s->gas)
                     : gas_make_polyhedral(s->grid, &s->models, 6, s->rules, &s->gas);
}

/* Takes a new gas in place of the one that there is. */
static status restart(struct scene *s) {
    struct kept kept;
    TRY(comm_agree(s->comm, kept_take(&kept, s->gas)));
    gas_free(s->gas);
    s->gas = NULL;
    const status e = comm_agree(s->comm, make_gas(s));
    if (!e) kept_give(&kept, s->gas);
    kept_free(&kept);
    return e;
}

static void scene_free(struct scene *s) {
    gas_free(s->gas);
    forest_free(s->forest);
    if (s->forest) box_free(&s->box);
    grid_free(s->grid);
    if (s->sample.mesh) sample_free(&s->sample);
    free(s->centre);
}

/* The other cell of a lattice along axis 1 - radial. */
static long mirror_cell(const struct problem *p, long cell) {
    const int axial = 1 - p->radial, stride = axial ? p->n[0] : 1, at = (int)(cell / stride % p->n[axial]);
    return cell + (long)stride * (p->n[axial] - 1 - 2 * at);
}

/* cell: of polyhedra, or the one that was drawn. */
static void place_of(const struct scene *s, long cell, double x[3]) {
    const struct problem *p = view_origin(s->problem);
    const long at[3] = {cell % p->n[0], cell / p->n[0] % p->n[1], cell / p->n[0] / p->n[1]};
    for (int k = 0; k < 3; k++) {
        x[k] = s->place ? s->place[3 * cell + k] * (k > 0 ? p->squash : 1) : ((double)at[k] + 0.5) / p->n[k];
        x[k] = smaller(larger(x[k], 0), 1 - 1e-12);
    }
}

static status fill(struct scene *s, double *packed) {
    long n = s->cells;
    double *all, *u[3];
    TRY(allocate(&all, 5 * n, sizeof *all, "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2 + k) * n;
    for (int i = 0; i < n; i++) {
        double x[3], v[3];
        const long drawn = s->place ? i : view_cell(s->problem, n, i);
        place_of(s, s->problem->mirrored ? mirror_cell(s->problem, i) : drawn, x);
        problem_state(view_origin(s->problem), x, &all[i], v, &all[n + i]);
        view_start(s->problem, view_cell(s->problem, n, i), &all[i], v, &all[n + i]);
        if (s->problem->mirrored) v[1 - s->problem->radial] = -v[1 - s->problem->radial];
        *packed = larger(*packed, all[i] / s->gas->limits.most);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    status e = gas_set(s->gas, all, (const double *const *)u, all + n);
    free(all);
    return e;
}

static uint64_t hash_on(uint64_t hash, double value) {
    return (hash ^ bits_of(value)) * 1099511628211u;
}

/* The checksum that a problem and its mirror image have in common; 0 + x makes -0 to 0. */
static uint64_t image_of(const struct problem *p, long n, double *const U[MAX_VAR], int variables) {
    uint64_t hash = 1469598103934665603u;
    for (int v = 0; v < variables; v++)
        for (long i = 0; i < n; i++) {
            const double value = U[v][p->mirrored ? mirror_cell(p, i) : i];
            hash = hash_on(hash, 0 + (p->mirrored && v == 2 - p->radial ? -value : value));
        }
    return hash;
}

/* Root's state and its checksum (FNV-1a), the same on all ranks. */
static status look_at_end(const struct scene *s, bool keep, struct outcome *out) {
    long n = s->cells;
    double *all, *U[MAX_VAR], limit = s->gas->limits.most;
    TRY(allocate(&all, MAX_VAR * n, sizeof *all, "the state"));
    for (int v = 0; v < MAX_VAR; v++) U[v] = all + v * n;
    status e = gas_get_conserved(s->gas, U);
    comm_broadcast(s->comm, all, (long)sizeof *all * MAX_VAR * n);
    out->checksum = 1469598103934665603u;
    for (long i = 0; i < gas_variables(s->gas) * n; i++) out->checksum = hash_on(out->checksum, all[i]);
    if (s->forest && s->problem->radial >= 0) out->image = image_of(s->problem, n, U, gas_variables(s->gas));
    for (long i = 0; i < n; i++) out->packed = larger(out->packed, all[i] / limit);
    out->variables = gas_variables(s->gas);
    if (keep && !e) e = allocate(&out->state, n * out->variables, sizeof *out->state, "the state");
    if (keep && !e) view_end(s->problem, n, out->variables, U, out->state);
    free(all);
    return e;
}

/* The bound: a stage rounds a cell's value a dozen times by eps/2 at most, and not all in one direction. */
#define ROUNDINGS 4
#define EPS       0x1p-52

static bool dilates(const struct scene *s) {
    return transport_terms(s->models.transport, &s->models.transport_params).dilation;
}

/* What walls do to what is conserved. */
struct exchange {
    bool drag;       /* of momentum */
    bool work, loss; /* of energy: either way; to the walls only */
};
static struct exchange exchange_of(const struct scene *s) {
    struct exchange e = {false, false, false};
    for (int i = 0; i < 2 * s->problem->dim; i++) {
        const struct patch_rules *r = &s->rules[i];
        if (is_periodic(s->problem, i / 2) || !patch_is_wall(r)) continue;
        const bool rests = s->problem->wall[i].along == 0;
        const bool lossy = wall_conducts(r) && !r->temperature.type->temperature;
        e.drag |= wall_drags(r);
        e.work |= (wall_works(r) && !rests) || (wall_conducts(r) && !lossy);
        e.loss |= lossy;
    }
    return e;
}

/* What a gas that is compressed or expands loses as inelastic grains do, by its own account. */
static double dilated(const struct scene *s) {
    struct gas_budget b;
    if (!dilates(s)) return 0;
    status e = gas_budget(s->gas, &b);
    const bool known = e == OK;
    status_free(e);
    return known ? b.gained[GAS_DILATION] : NAN;
}

/* Radial momentum is not conserved: p pushes on the sides of each sector. Around the axis, and along it where cells lie
 * along the radius alone, walls slip. */
static bool keeps_momentum(const struct problem *p, int component) {
    if (p->radial < 0) return is_periodic(p, component);
    return component >= p->dim || (component != p->radial && is_periodic(p, component));
}

enum { ANGULAR = CONSERVED }; /* of the sums of a budget */
static void judge_budget(const struct scene *s, const struct watch *w, struct outcome *out) {
    const struct problem *p = s->problem;
    const struct budget *b = &w->budget;
    const bool closed = p->edge != OPEN_ENDED;
    const struct exchange e = exchange_of(s);
    const long double each = ROUNDINGS * EPS * (p->through > 0 ? p->through : 1);
    for (int q = 0; q < CONSERVED; q++) out->drift[q] = out->relative[q] = -1;
    const int components = p->components ? p->components : p->dim;
    for (int v = 0; v < components + 2; v++) {
        int q = v == 0 ? MASS : v <= components ? MOMENTUM : ENERGY;
        const int i = p->swirl && v == p->swirl + 1 ? ANGULAR : q;
        if (!closed || (q == MOMENTUM && (!keeps_momentum(p, v - 1) || e.drag || out->counts.filled))) continue;
        if (i == ANGULAR && out->counts.cells) continue; /* limited cells do without */
        if (q == ENERGY && e.work) continue;
        long double gain = b->gain[v] + (q == ENERGY ? out->counts.energy + dilated(s) : 0); /* counts: of the floor */
        if (q != MOMENTUM) gain += out->counts.fill[q == ENERGY];
        long double off = b->now[v] - b->start[v] - gain;
        off = q == ENERGY && e.loss && off < 0 ? 0 : fabsl(off);
        out->drift[q] = fmax(out->drift[q], (double)(off / (each * b->rounding[i])));
        out->relative[q] = fmax(out->relative[q], (double)(off / b->magnitude[i]));
    }
}

static void set_verdict(struct outcome *out, enum verdict v, const char *why) {
    out->verdict = v;
    snprintf(out->why, sizeof out->why, "%s", why);
    for (char *c = out->why; *c; c++)
        if (*c == '\n') *c = ' ';
}

/* Is it true: does the gas cool, and is it packed, ten times nearer than at first? */
static bool may_collapse(const struct problem *p, const struct outcome *out) {
    return p->source.cooling && p->material.restitution < 1 && p->eos->bounded && out->packed > 0.9 &&
           1 - out->packed < 0.1 * (1 - out->packed_at_first) && out->steps >= 10;
}

/* The largest entry of a budget: hot walls may give, and impacts take, a million times what the gas holds. */
static double booked(const struct gas_budget *b) {
    double most = 0;
    for (int i = 0; i < source_count; i++) most = larger(most, fabs(b->sourced[i]));
    for (int i = 0; i < GAS_CAUSES; i++) most = larger(most, fabs(b->gained[i]));
    return most;
}

/* Beds, and gas that falls in local steps, are judged by their mass between walls, and by the energy that their own
 * budget cannot account for, beside the largest energy there was or that the budget booked. Four stages of the flow,
 * some sixteen of diffusion, and a bed's acoustics and remap round it about ten times each in a step. */
enum { BED_ROUNDINGS = 256 };
/* Stress is elastic below its yield: what friction gives back it took before, but for that. */
#define MOST_RUBBED 0.1
static const char *const conserved_name[CONSERVED] = {"mass", "momentum", "energy"};

/* Of cells whose faces are not plane, the weight on the faces is not quite that of the cell. */
static bool is_warped(const struct problem *p) {
    return p->polyhedral && p->shape == HEXES;
}

static void judge_bed(const struct scene *s, const struct watch *w, struct outcome *out) {
    struct gas_budget b;
    char why[200];
    status e = gas_budget(s->gas, &b);
    const bool known = e == OK;
    status_free(e);
    if (!known) {
        set_verdict(out, FAILED, "the budget has no sum");
        return;
    }
    const long double mass = w->budget.now[0] - w->budget.start[0] - b.filled - b.flowed;
    double strayed = 0;
    for (int k = 0; k < s->gas->components; k++)
        if (k != s->problem->radial && !(s->problem->swirl && k == s->problem->swirl))
            strayed = larger(strayed, fabs(b.strayed[k]));
    out->relative[MOMENTUM] = (double)(strayed / w->budget.magnitude[1]);
    const double steps = BED_ROUNDINGS * EPS * (out->steps + 1.), scale = larger((double)w->budget.largest, booked(&b));
    const long double held = w->budget.now[0] > w->budget.start[0] ? w->budget.now[0] : w->budget.start[0];
    out->relative[MASS] = (double)(fabsl(mass) / (fabsl(b.flowed) > held ? fabsl(b.flowed) : held));
    out->relative[ENERGY] = fabs(b.lost[1]) / scale;
    out->drift[MASS] = out->relative[MASS] / smaller(steps, 1e-12);
    out->drift[MOMENTUM] = (double)(strayed / (BED_ROUNDINGS * EPS * w->budget.rounding[1]));
    out->drift[ENERGY] = out->relative[ENERGY] / steps;
    for (int q = 0; q < CONSERVED; q++) {
        if (out->drift[q] <= 1 || (q == MOMENTUM && is_warped(s->problem))) continue;
        snprintf(why, sizeof why, "%s is off by %.3g of itself after %d steps", conserved_name[q], out->relative[q],
                 out->steps);
        set_verdict(out, FAILED, why);
    }
    if (out->rubbed <= MOST_RUBBED) return;
    snprintf(why, sizeof why, "friction gave %.3g of the energy that there was", out->rubbed);
    set_verdict(out, FAILED, why);
}

/* A round body with open sides: by its budget, too. */
static bool is_open(const struct problem *p) {
    return p->radial >= 0 && p->edge == OPEN_ENDED;
}

/* Is it judged by the budget of the gas? */
static bool has_budget(const struct scene *s) {
    return watch_by_steps(s->gas) || is_open(s->problem);
}

static void judge(const struct scene *s, const struct run_options *o, const struct watch *w, struct outcome *out) {
    char why[200];
    if (out->verdict == COLLAPSED && !may_collapse(s->problem, out)) out->verdict = FAILED;
    if (out->verdict == STATED && !s->problem->stated) out->verdict = FAILED;
    if (o->bare || comm_size(s->comm) > 1 || out->verdict == FAILED) return;
    if (has_budget(s)) {
        judge_bed(s, w, out);
        return;
    }
    judge_budget(s, w, out);
    for (int q = 0; q < CONSERVED; q++) {
        if (!(out->drift[q] > 1) && !isnan(out->drift[q])) continue;
        snprintf(why, sizeof why, "%s is off by %.3g of itself, %.3g times what rounding explains", conserved_name[q],
                 out->relative[q], out->drift[q]);
        set_verdict(out, FAILED, why);
    }
    out->source = w->source;
    if (out->source <= 1) return;
    snprintf(why, sizeof why, "a source step is off by %.3g times what rounding explains", out->source);
    set_verdict(out, FAILED, why);
}

/* The ranks ask each other every 64 stages of diffusion, and where a stage or a step is done again: a bound of work
 * that is the same on all machines. */
static int questions;
static bool worked_enough(void) {
    return --questions < 0;
}

/* What an error of gas_step says: the cause of an end, or something that is none. */
static enum verdict verdict_of(const char *text) {
    static const char *const causes[] = {"is too stiff", "time stands still", "speed of sound is without bound",
                                         "less than is allowed"};
    if (strstr(text, "inelastic collapse")) return COLLAPSED;
    for (int i = 0; i < 4; i++)
        if (strstr(text, causes[i]) && strstr(text, "alpha = ")) return STATED;
    return FAILED;
}

/* What remains may be some last digits of t, a step that gas_step refuses. */
static bool is_end(double t, double end) {
    return t >= end || t + (end - t) / 64 == t;
}

/* The longest step that gravity allows, as solvers/gas/gas_medium.c has it for dense gas; HUGE_VAL: any. */
static double fall_of(const struct scene *s) {
    const struct sources *q = &s->problem->source;
    const struct cells *cells = s->problem->polyhedral ? s->gas->cells : NULL;
    double most = 0;
    for (int i = 0; i < (cells ? cells->polyhedra->nown : 1) && s->problem->acoustics; i++) {
        double pull = 0;
        for (int k = 0; k < s->problem->dim; k++)
            pull +=
                fabs(q->gravity[k]) * (1 + fabs(q->amplitude)) * (cells ? cells->girth[k][i] : 1 / s->forest->width[k]);
        most = larger(most, pull);
    }
    comm_max(s->comm, &most, 1);
    return most > 0 ? 0.2 * sqrt(2 / most) : HUGE_VAL;
}

static double longest_step(const struct scene *s, const struct scheme *scheme, const struct gas_speed *speed,
                           double fall, const char **limit, int *beds) {
    *limit = "sound";
    const double stable = smaller(scheme->courant / speed->rate, fall);
    const double bed = gas_bed_step(s->gas, scheme->courant, speed, fall, limit);
    *beds += bed > 0;
    return bed > 0 ? bed : stable;
}

static void print_step(const struct scene *s, int step, double t, double dt, double stable, const char *limit) {
    struct gas_budget b = {0};
    const struct gas_counts c = gas_counts(s->gas);
    if (s->gas->books.audit) status_free(gas_budget(s->gas, &b));
    if (!comm_root(s->comm)) return;
    printf("  step %d t %.6g dt %.4g of %.4g by %s, rejected %ld", step, t, dt, stable, limit, c.rejected);
    if (s->problem->friction) printf(", friction gave %.3g of %.3g", b.gained[GAS_CONTACTS], b.energy);
    if (s->gas->dense)
        printf(", implicit %ld of %ld cells, lost %.3g, lift %.3g, limited %ld, floored %ld", c.beds, c.bed_cells,
               b.lost[1], c.lift, c.cells, c.floored);
    printf("\n");
}

/* What ends a run, beside an error. */
struct ends {
    double t;     /* s */
    double waves; /* cells that the fastest waves cross, in implicit steps one a step */
    int steps;
};

/* A short run (-short) ends after a part of the time, or when the fastest waves have crossed some cells: a gas that
 * packs gets ever faster waves, and would not come to a given time. It may take twenty times the steps of full length
 * that this needs. */
static struct ends ends_of(const struct problem *p, const struct run_options *o, double rate) {
    const bool timed = p->end > 0;
    const double part = !o->brief ? 1 : timed ? 0.1 : 0.3, waves = timed ? 150 : part * p->duration;
    struct ends e = {.t = part * (timed ? p->end : p->duration / rate), .waves = o->brief ? waves : HUGE_VAL};
    e.steps = o->brief ? 100 + (int)(20 * waves) : o->cap * (p->patience ? p->patience : 1);
    if (o->most && o->most < e.steps) e.steps = o->most;
    return e;
}

static status advance(struct scene *s, const struct scheme *scheme, const struct run_options *o, struct watch *w,
                      struct outcome *out) {
    struct gas *g = s->gas;
    struct gas_speed speed;
    struct contacts rubbed = {0, 0};
    const char *limit;
    double t = 0, crossed = 0;
    gas_speed(g, &speed);
    /* the rate of the shortest local steps: a problem has one end under every time scheme */
    const struct ends bounds = ends_of(s->problem, o, ldexp(speed.rate, speed.levels));
    double end = bounds.t;
    /* minDeltaTFraction; the first state may be dense already: its own time step is no collapse */
    const double fraction = o->fraction * (speed.loose > 0 ? speed.loose / speed.rate : 1);
    const double fall = fall_of(s);
    out->least = 1;
    questions = (o->brief ? 20000 : 2000) + 4 * bounds.steps;
    gas_heed(g, worked_enough);
    for (out->steps = 0; !is_end(t, end) && out->steps < bounds.steps; out->steps++) {
        if (o->restart && out->steps == o->restart) {
            TRY(restart(s));
            g = s->gas;
            gas_heed(g, worked_enough);
        }
        gas_speed(g, &speed);
        if (!(speed.rate > 0)) return fail(ERR_STATE, "wave speed %g", speed.rate);
        double stable = longest_step(s, scheme, &speed, fall, &limit, &out->beds), dt = smaller(stable, end - t),
               asked = dt;
        if (out->steps == 0 && s->problem->steps) end = smaller(end, s->problem->steps * stable);
        TRY(gas_step(g, t, &dt, scheme->courant, 0, fraction, &speed));
        out->left = dt == 0;
        if (out->left) break;
        bool fine = o->bare || watch_step_finish(w, g);
        status seen = fine ? OK : fail(ERR_STATE, "step %d from t = %.9g: %s", out->steps, t, w->why);
        TRY(comm_agree(s->comm, seen));
        if (s->problem->friction && g->dense && !o->bare) TRY(contacts_look(&rubbed, g));
        out->least = smaller(out->least, dt / asked);
        if (o->verbose) print_step(s, out->steps, t, dt, stable, limit);
        t = t + dt > t ? t + dt : end;
        crossed += ldexp(smaller(dt * speed.rate, 1), speed.levels);
        if (crossed >= bounds.waves) end = t;
    }
    out->end = end;
    out->reached = t / end;
    out->rubbed = rubbed.most / larger((double)w->budget.largest, 1e-300);
    out->verdict = is_end(t, end) ? FINISHED : CAPPED;
    return OK;
}

static status run(struct scene *s, const struct scheme *scheme, const struct run_options *o, struct outcome *out) {
    struct watch w = {.before = NULL};
    TRY(s->problem->polyhedral ? make_polyhedra(s) : make_lattice(s));
    TRY(make_gas(s));
    TRY(fill(s, &out->packed_at_first));
    TRY(gas_check(s->gas));
    if (!o->bare) TRY(watch_start(&w, s->gas));
    if (!o->bare && (dilates(s) || has_budget(s))) TRY(gas_audit(s->gas));
    status e = advance(s, scheme, o, &w, out);
    status ended = look_at_end(s, o->keep, out);
    out->cells = s->cells;
    out->counts = gas_counts(s->gas);
    if (e) set_verdict(out, verdict_of(status_text(e)), status_text(e));
    status_free(e);
    if (!ended) judge(s, o, &w, out);
    if (w.inner) s->gas->engine = w.inner; /* that of the watch ends here */
    watch_free(&w);
    return ended;
}

static status run_scene(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                        const struct comm *c, struct outcome *out) {
    struct scene s = {.problem = p, .comm = c};
    *out = (struct outcome){.verdict = FAILED, .drift = {-1, -1, -1}, .relative = {-1, -1, -1}};
    if (!flux_find(scheme->flux) || !reconstruct_find(scheme->reconstruct) || !stepper_find(scheme->stepper) ||
        !polynomial_find(scheme->polynomial))
        return fail(ERR_INPUT, "no scheme %s/%s/%s/%s", scheme->flux, scheme->reconstruct, scheme->polynomial,
                    scheme->stepper);
    set_models(&s, scheme, o);
    status e = run(&s, scheme, o, out);
    scene_free(&s);
    return e;
}

/* A run in which no step was to be implicit must have the bits of an explicit one, of which every stage is judged. */
static status compare_explicit(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                               const struct comm *c, struct outcome *out) {
    struct run_options explicit = *o;
    const struct outcome first = *out;
    explicit.explicit = true;
    TRY(run_scene(p, scheme, &explicit, c, out));
    if (out->verdict != FAILED && (first.checksum != out->checksum || first.steps != out->steps))
        set_verdict(out, FAILED, "no step was implicit, but the bits are not those of explicit acoustics");
    return OK;
}

/* A restart in the middle changes no bit. One into a gas that is near its collapse ends at once (gas_step). */
static status compare_restart(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                              const struct comm *c, struct outcome *out) {
    struct run_options again = *o;
    struct outcome second;
    again.bare = true;
    again.restart = out->steps / 2;
    TRY(run_scene(p, scheme, &again, c, &second));
    const bool ends =
        verdict_of(second.why) == COLLAPSED && out->packed > 0.9; /* so soon that `judge` calls it failed */
    if (!ends && second.verdict != COLLAPSED && (second.checksum != out->checksum || second.steps != out->steps))
        set_verdict(out, FAILED, second.why[0] ? second.why : "a restart changes the bits");
    return OK;
}

/* No bit changes by a restart, by skipping, and in the mirror. */
static status compare_round(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                            const struct comm *c, struct outcome *out) {
    const struct problem mirror = problem_mirrored(p);
    struct run_options again = *o;
    struct outcome second;
    again.bare = true;
    if (out->steps > 1 && !out->left) TRY(compare_restart(p, scheme, o, c, out));
    if (p->polyhedral || out->verdict == FAILED) return OK;
    again.full = true;
    TRY(run_scene(p, scheme, &again, c, &second));
    if (second.checksum != out->checksum || second.steps != out->steps)
        set_verdict(out, FAILED, "uniform regions that are computed change the bits");
    const bool solved = p->diffusion && !p->diffusion->plan; /* PETSc's sums follow the order of the cells */
    if (p->dim < 2 || solved || out->verdict == FAILED) return OK;
    TRY(run_scene(&mirror, scheme, &again, c, &second));
    if (second.image != out->image || second.steps != out->steps)
        set_verdict(out, FAILED, "the mirror image has other bits");
    return OK;
}

status stress_run(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                  const struct comm *c, struct outcome *out) {
    TRY(run_scene(p, scheme, o, c, out));
    if (o->explicit || o->bare || out->verdict == FAILED) return OK;
    if (p->radial >= 0) return compare_round(p, scheme, o, c, out);
    const bool resumes = p->friction || stepper_find(scheme->stepper)->local;
    if (resumes && out->steps > 1 && !out->left) return compare_restart(p, scheme, o, c, out);
    return p->acoustics && !p->friction && !out->beds ? compare_explicit(p, scheme, o, c, out) : OK;
}
