/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Does the steps of implicit diffusion (implicit.h, docs/physics.md 8.3) by the hooks of the engine; a module that the
 * caller of gas_make gave solves the systems. */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

/* The error allowed in a solution if the caller states none, relative to a cell's T, or for velocities to the speed
 * that the cell's energy amounts to. */
static const double TOLERANCE = 1e-6;
enum {
    PASSES = 3,      /* most passes of iterative refinement */
    CORRECTIONS = 20 /* most iterations for the mean of two coupled stages; five are common */
};

struct links { /* links of this rank's cells to the cells across their faces */
    int cells;
    int *first;     /* [cells + 1] where the links of a cell begin in `column` */
    int *column;    /* numbers over all ranks: the cell itself, then the cells it is linked to, perhaps twice */
    bool symmetric; /* is the operator of heat symmetric, on all ranks? */
};

struct problem { /* one of the two linear systems */
    struct gas *gas;
    enum diffusing what;
    double t, factor; /* s: start of the step; gamma dt */
    const struct state *Y0;
    int *place; /* [unknowns * links] place of a link's weight in system.value */
    struct linear_system system;
    struct linear_solver *solver;
};

struct implicit {
    const struct linear_module *module;
    double tolerance; /* error allowed in a solution */
    struct links links;
    struct problem problem[2];     /* VISCOUS, HEAT */
    double *mass, *limit, *weight; /* [cells]; [cells] m/s: speed that a cell's energy amounts to; weights of links */
    double *q, *moved, *f, *mean;  /* [rows] solution of a stage; gamma dt L q/rho; right side; S/dt */
    double *source;                /* [rows] h of implicit.h: change of T by friction less cooling */
    double *b, *d;                 /* [rows] right side and solution of the linear system */
};

static int unknowns_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->components : 1;
}

/* ---- the systems as functions ---- */

struct moving {
    struct gas *g;
    int lines;
    double *x;
    bool to_sums;
};

static void copy_row(void *moving, const struct row *row) {
    struct moving *m = moving;
    for (int c = 0; c < m->lines; c++) {
        double *S = m->g->diffusion.sum[m->g->diffusion.last][row->block] + c * m->g->diffusion.wide + row->at;
        for (int i = 0; i < row->n; i++)
            *(m->to_sums ? &S[i] : &m->x[i * m->lines + c]) = m->to_sums ? m->x[i * m->lines + c] : S[i];
    }
    m->x += row->n * m->lines;
}

/* Copies x [cells][unknowns] to the last S, or from it. */
static void move(struct gas *g, enum diffusing what, double *x, bool to_sums) {
    g->engine->state.rows(g, EVERY_CELL, NULL, copy_row, &(struct moving){g, unknowns_of(g, what), x, to_sums});
}

/* Computes y = gamma dt L x/rho, of x alone or with the values given at the edges. S is gamma dt x, so that the
 * round-off of (q_0 + L S/rho) - q_0 is small beside it. */
static void operate(const struct problem *p, const double *x, bool edges, double *y) {
    const double only[5] = {0, 0, 1, -1, 0}; /* gives L S/rho without q_0 */
    struct gas *g = p->gas;
    for (int k = 0; k < p->system.rows; k++) y[k] = p->factor * x[k];
    move(g, p->what, y, true);
    g->engine->diffusion.stage(g, p->what, p->Y0, only, edges ? p->factor : 0);
    move(g, p->what, y, false);
}

/* Computes y = A x = mass (x - gamma dt L x/rho). */
static void apply(const void *caller, const double *x, double *y) {
    const struct problem *p = caller;
    const double *mass = p->gas->diffusion.implicit->mass;
    operate(p, x, false, y);
    for (int i = 0, k = 0; k < p->system.rows; i++)
        for (int c = 0; c < p->system.unknowns; c++, k++) y[k] = mass[i] * (x[k] - y[k]);
}

/* Returns the largest error of a cell, over all ranks, in units of what is allowed: a residual leaves an error of at
 * most residual/mass in a stiff cell (implicit.h). If the step is left, any error is small enough. */
static double error_of(const void *caller, const double *x, const double *residual) {
    const struct problem *p = caller;
    const struct implicit *m = p->gas->diffusion.implicit;
    struct gas *g = p->gas;
    double most = 0;
    for (int i = 0, k = 0; k < p->system.rows; i++)
        for (int c = 0; c < p->system.unknowns; c++, k++) {
            const double scale = p->what == HEAT ? fabs(m->q[k] + x[k]) : m->limit[i];
            const double error = fabs(residual[k]) / (m->mass[i] * scale * m->tolerance + 1e-300);
            if (!(error <= most)) most = error == error ? error : HUGE_VAL;
        }
    double all[] = {most, g->step.asked && g->step.asked()};
    comm_max(g->comm, all, 2);
    g->step.left |= all[1] > 0;
    return g->step.left ? 0 : all[0];
}

/* ---- set-up ---- */

/* Sets *first to the number, over all ranks, of this rank's first cell. */
static status first_number(const struct gas *g, int cells, long *first) {
    const int size = comm_size(g->comm), rank = comm_rank(g->comm);
    long *count;
    TRY(allocate(&count, size, sizeof *count, "the counts of all ranks"));
    count[rank] = cells;
    comm_sum_long(g->comm, count, size);
    *first = 0;
    for (int r = 0; r < rank; r++) *first += count[r];
    free(count);
    return OK;
}

struct linking { /* context of the visitors of rows that number and link cells */
    const struct gas *g;
    double **number;
    int cells, links; /* their number on this rank, and no less than that of links */
    struct links *out;
};

static void number_row(void *linking, const struct row *row) {
    struct linking *l = linking;
    struct sides s;
    for (int i = 0; i < row->n; i++) l->number[row->block][row->at + i] = l->cells++;
    for (int k = 0; l->g->engine->state.sides(l->g, row, k, &s); k++) l->links += row->n;
}

static void link_row(void *linking, const struct row *row) {
    struct linking *l = linking;
    const double *number = l->number[row->block];
    struct links *out = l->out;
    for (int i = 0; i < row->n; i++) {
        const struct row cell = {row->block, row->at + i, 1};
        struct sides s;
        int n = out->first[out->cells];
        out->column[n++] = (int)number[row->at + i];
        for (int k = 0; l->g->engine->state.sides(l->g, &cell, k, &s); k++)
            if (s.edge[0] < 0) out->column[n++] = (int)number[s.across[0]];
        out->first[++out->cells] = n;
    }
}

/* Lists for each cell of this rank, in the order of rows, the cells that it is linked to. */
static status make_links(const struct gas *g, struct links *out) {
    struct linking l = {.g = g, .out = out};
    double oblique = g->diffusion.oblique;
    long first = 0;
    comm_max(g->comm, &oblique, 1);
    out->symmetric = oblique == 0;
    TRY(line_make(g, &l.number));
    g->engine->state.rows(g, EVERY_CELL, NULL, number_row, &l);
    status s = first_number(g, l.cells, &first);
    if (!s) s = allocate(&out->first, l.cells + 1, sizeof(int), "the links of cells");
    if (!s) s = allocate(&out->column, l.cells + l.links, sizeof(int), "the links of cells");
    for (int b = 0; b < g->blocks.n; b++)
        for (long i = 0; i < g->size; i++) l.number[b][i] += (double)first;
    g->engine->state.fill(g, 1, 1, l.number);
    if (!s) g->engine->state.rows(g, EVERY_CELL, NULL, link_row, &l);
    line_free(g, l.number);
    return s;
}

/* Returns the place of number k among n in ascending order; equal numbers share one place. */
static int place_of(const int *number, int n, int k) {
    int before = 0;
    for (int i = 0; i < n; i++) {
        bool first = number[i] < number[k];
        for (int j = 0; j < i && first; j++) first = number[j] != number[i];
        before += first;
    }
    return before;
}

/* Allocates a system with the links of every unknown in ascending order; p->place remembers where each link went. */
static status problem_make(struct implicit *m, struct gas *g, enum diffusing what) {
    struct problem *p = &m->problem[what];
    struct linear_system *s = &p->system;
    const struct links *l = &m->links;
    const int unknowns = unknowns_of(g, what), links = l->first[l->cells];
    p->gas = g;
    p->what = what;
    *s = (struct linear_system){.comm = comm_handle(g->comm),
                                /* the stress is not, at walls and where viscosities vary */
                                .symmetric = what == HEAT && l->symmetric,
                                .unknowns = unknowns,
                                .rows = l->cells * unknowns,
                                .caller = p,
                                .apply = apply,
                                .error = error_of};
    TRY(allocate(&s->first, s->rows + 1, sizeof(int), "a linear system"));
    TRY(allocate(&s->column, (long)links * unknowns, sizeof(int), "a linear system"));
    TRY(allocate(&s->value, (long)links * unknowns, sizeof(double), "a linear system"));
    TRY(allocate(&p->place, (long)links * unknowns, sizeof(int), "a linear system"));
    for (int i = 0, next = 0, row = 0; i < l->cells; i++)
        for (int c = 0; c < unknowns; c++) {
            const int *link = l->column + l->first[i], n = l->first[i + 1] - l->first[i];
            int end = next;
            for (int k = 0; k < n; k++) {
                const int place = next + place_of(link, n, k);
                s->column[place] = link[k] * unknowns + c;
                p->place[c * links + l->first[i] + k] = place;
                if (end <= place) end = place + 1;
            }
            s->first[++row] = next = end;
        }
    return OK;
}

static status solver_make(struct implicit *m, struct problem *p) {
    const char *text = m->module->make(&p->system, &p->solver);
    return text ? fail(ERR_SYSTEM, "PETSc: %s", text) : OK;
}

static status make_parts(struct implicit *m, struct gas *g) {
    m->module = g->models.linear;
    m->tolerance = g->models.linear_error > 0 ? g->models.linear_error : TOLERANCE;
    if (!m->module)
        return fail(ERR_INPUT, "diffusion implicit: it wants a solver of linear systems, and none was given");
    TRY(make_links(g, &m->links));
    const long cells = m->links.cells, rows = cells * g->components;
    TRY(allocate(&m->weight, m->links.first[cells] * (long)g->components, sizeof(double), "a linear system"));
    TRY(allocate(&m->mass, cells, sizeof(double), "a linear system"));
    TRY(allocate(&m->limit, cells, sizeof(double), "a linear system"));
    double **lines[] = {&m->q, &m->moved, &m->f, &m->mean, &m->b, &m->d, &m->source};
    for (int i = 0; i < 7; i++) TRY(allocate(lines[i], rows, sizeof(double), "a linear system"));
    for (int what = 0; what < 2; what++) {
        TRY(problem_make(m, g, (enum diffusing)what));
        TRY(solver_make(m, &m->problem[what]));
    }
    return OK;
}

status implicit_make(struct gas *g, struct implicit **out) {
    TRY(allocate(out, 1, sizeof **out, "implicit diffusion"));
    return make_parts(*out, g);
}

void implicit_free(struct implicit *m) {
    if (!m) return;
    for (int what = 0; what < 2; what++) {
        struct problem *p = &m->problem[what];
        if (p->solver) m->module->free(p->solver);
        free(p->place);
        free(p->system.first);
        free(p->system.column);
        free(p->system.value);
    }
    void *lines[] = {m->mass, m->limit, m->weight, m->q,           m->moved,        m->f,
                     m->mean, m->b,     m->d,      m->links.first, m->links.column, m->source};
    for (int i = 0; i < 12; i++) free(lines[i]);
    free(m);
}

/* ---- one step ---- */

struct weighing { /* context of matrix_row: the entries of unknown c, and where the next ones go */
    const struct problem *p;
    int c;
    double per, *mass, *energy, *weight;
};

/* Writes the weights of the links of a cell. */
static void weigh_cell(struct weighing *w, int block, long at, double mass) {
    const struct problem *p = w->p;
    const struct row cell = {block, at, 1};
    double *self = w->weight++, sum = mass;
    struct sides s;
    for (int k = 0; p->gas->engine->state.sides(p->gas, &cell, k, &s); k++) {
        const double weight = p->gas->engine->diffusion.weight(p->gas, p->what, w->per, block, at, k, w->c);
        sum += weight;
        if (s.edge[0] < 0) *w->weight++ = -weight;
    }
    *self = sum;
}

static void matrix_row(void *weighing, const struct row *row) {
    struct weighing *w = weighing;
    const struct gas *g = w->p->gas;
    double room[BATCH];
    const double *U = w->p->Y0->block[row->block], *radius = row_radius(g, row->block, row->at, row->n, room);
    for (int i = 0; i < row->n; i++) {
        const long at = row->at + i;
        const double volume = g->blocks.volume ? g->blocks.volume[at] : radius ? radius[i] : 1;
        *w->energy++ = volume * U[energy_at(g) * g->size + at];
        *w->mass = volume * U[at];
        weigh_cell(w, row->block, at, *w->mass++);
    }
}

/* Computes A = diag(mass) - factor V L, without the coupling between the components of a velocity; on a lattice, whose
 * volumes V are all the same, without V, or with the radius for V. For each unknown, for each cell, the entry of the
 * cell itself comes first, then those of its links; m->limit gets the energy of a cell. The last S is free at this
 * time. */
static void find_matrix(struct implicit *m, struct problem *p) {
    struct gas *g = p->gas;
    struct weighing w = {.p = p, .per = p->factor, .weight = m->weight};
    if (p->what == HEAT) w.per = temperature_of(&g->models.material, p->factor);
    for (w.c = 0; w.c < p->system.unknowns; w.c++) {
        w.mass = m->mass;
        w.energy = m->limit;
        g->engine->state.rows(g, EVERY_CELL, NULL, matrix_row, &w);
    }
}

/* Computes the matrix at Y0 and hands it to the module; returns NULL or the text of an error. */
static const char *prepare(struct implicit *m, struct problem *p) {
    const int links = m->links.first[m->links.cells] * p->system.unknowns;
    find_matrix(m, p);
    for (int i = 0; i < m->links.cells; i++) m->limit[i] = sqrt(2 * fabs(m->limit[i]) / m->mass[i]);
    memset(p->system.value, 0, (size_t)links * sizeof(double));
    for (int i = 0; i < links; i++) p->system.value[p->place[i]] += m->weight[i];
    return m->module->prepare(p->solver);
}

/* Solves A d = b; returns the number of iterations, or < 0 on all ranks if it was not solved. */
static int solve(struct implicit *m, struct problem *p) {
    int iterations;
    memset(m->d, 0, (size_t)p->system.rows * sizeof *m->d);
    if (m->module->solve(p->solver, m->b, m->d, &iterations)) return -1;
    if (iterations > 0) p->gas->counts.now.stages[p->what] += iterations;
    return iterations;
}

/* Solves q = f + moved(q) from a first guess q; m->moved is moved(q) before and after. Iterative refinement: in a hot
 * thin cell the round-off of what the cell loses exceeds what it keeps, so the residual is solved for again. */
static bool stage(struct implicit *m, struct problem *p, const double *f, double *q) {
    const int rows = p->system.rows, unknowns = p->system.unknowns;
    for (int pass = 0; pass < PASSES; pass++) {
        for (int k = 0; k < rows; k++) m->b[k] = m->mass[k / unknowns] * (f[k] + m->moved[k] - q[k]);
        const int iterations = solve(m, p);
        if (iterations <= 0 || p->gas->step.left) return iterations == 0 && !p->gas->step.left;
        for (int k = 0; k < rows; k++) q[k] += m->d[k];
        operate(p, q, true, m->moved);
    }
    return true;
}

/* Solves the one stage of the midpoint rule, or with gamma = 1 of backward Euler: q = q_0 + gamma (dt L q/rho + h), S =
 * dt q. */
static bool one_stage(struct implicit *m, struct problem *p, double gamma) {
    const int rows = p->system.rows;
    renew_patches(p->gas, p->t + p->factor);
    for (int k = 0; k < rows; k++) m->f[k] = m->q[k] + gamma * m->source[k];
    operate(p, m->q, true, m->moved);
    if (!stage(m, p, m->f, m->q)) return false;
    for (int k = 0; k < rows; k++) m->mean[k] = m->q[k];
    return true;
}

/* Solves both stages of SDIRK. */
static bool two_stages(struct implicit *m, struct problem *p, double gamma) {
    const int rows = p->system.rows;
    if (!one_stage(m, p, gamma)) return false;
    for (int k = 0; k < rows; k++) m->f[k] += (1 - gamma) / gamma * m->moved[k] + (1 - gamma) * m->source[k];
    if (p->gas->patches.renew) {
        renew_patches(p->gas, p->t + p->factor / gamma);
        operate(p, m->q, true, m->moved);
    }
    if (!stage(m, p, m->f, m->q)) return false;
    for (int k = 0; k < rows; k++) m->mean[k] += gamma * (m->q[k] - m->mean[k]);
    return true;
}

/* Does one iteration for m, which is m->q; s Z m is m->moved, q_0 m->mean. Returns whether it was good enough already;
 * < 0: it was not solved. */
static int correct_mean(struct implicit *m, struct problem *p, double s) {
    const int rows = p->system.rows, unknowns = p->system.unknowns;
    const double weight = 8 / (6 + sqrt(3));
    for (int k = 0; k < rows; k++) {
        const double e = m->moved[k] + s * m->source[k];
        m->b[k] = m->mass[k / unknowns] * (m->mean[k] - m->q[k] + (sqrt(3) - 1) * e);
    }
    if (solve(m, p) < 0) return -1;
    for (int k = 0; k < rows; k++) {
        const double e = m->moved[k] + s * m->source[k];
        m->b[k] = m->mass[k / unknowns] * (e + m->d[k]);
        m->d[k] = 0;
    }
    if (error_of(p, m->d, m->b) <= 1) return true;
    if (solve(m, p) < 0) return -1;
    for (int k = 0; k < rows; k++) m->q[k] += weight * m->d[k];
    operate(p, m->q, true, m->moved);
    return false;
}

/* Patches whose values change in time give the stages of Gauss & Legendre different heat, dt h_1 and dt h_2 with a mean
 * of the middle: in the equation of the mean, q_0 has -s dt (h_2 - h_1)/2 besides, a twelfth of the change over dt. */
static void change_edges(struct implicit *m, struct problem *p, double s) {
    const int rows = p->system.rows;
    const double dt = p->factor / s;
    memset(m->d, 0, (size_t)rows * sizeof *m->d);
    renew_patches(p->gas, p->t);
    operate(p, m->d, true, m->b);
    renew_patches(p->gas, p->t + dt);
    operate(p, m->d, true, m->moved);
    for (int k = 0; k < rows; k++) m->mean[k] -= (m->moved[k] - m->b[k]) / (12 * s);
    renew_patches(p->gas, p->t + 0.5 * dt);
}

/* Solves the two stages of Gauss & Legendre. The first guess is their mean by the midpoint rule with s for 1/2. */
static bool gauss_stages(struct implicit *m, struct problem *p, double s) {
    const int rows = p->system.rows;
    memcpy(m->mean, m->q, (size_t)rows * sizeof *m->mean);
    if (p->gas->patches.renew) change_edges(m, p, s);
    for (int k = 0; k < rows; k++) m->f[k] = m->q[k] + s * m->source[k];
    operate(p, m->q, true, m->moved);
    if (!stage(m, p, m->f, m->q)) return false;
    for (int pass = 0; pass < CORRECTIONS; pass++) {
        const int done = correct_mean(m, p, s);
        if (done < 0 || p->gas->step.left) return false;
        if (!done) continue;
        memcpy(m->mean, m->q, (size_t)rows * sizeof *m->mean);
        return true;
    }
    return false;
}

/* Returns gamma of a scheme, the share of dt in its matrix. */
static double share_of(enum implicit_scheme scheme) {
    return scheme == BY_SDIRK ? 1 - sqrt(0.5) : scheme == BY_MIDPOINT ? 0.5 : sqrt(3) / 6;
}

/* Does the stages of a scheme; m->mean becomes S/dt. */
static bool stages(struct implicit *m, struct problem *p, enum implicit_scheme scheme, double gamma) {
    if (gamma == 1 || scheme == BY_MIDPOINT) return one_stage(m, p, gamma);
    return scheme == BY_GAUSS ? gauss_stages(m, p, gamma) : two_stages(m, p, gamma);
}

/* Sets m->q to q_0, and m->source. */
static void take_start(struct implicit *m, struct problem *p, const struct lapse *l) {
    const struct engine *engine = p->gas->engine;
    engine->diffusion.begin(p->gas, p->what, p->Y0, 1, 0);
    move(p->gas, p->what, m->source, false);
    engine->diffusion.begin(p->gas, p->what, p->Y0, 1, l->pending);
    move(p->gas, p->what, m->q, false);
    for (int k = 0; k < p->system.rows; k++)
        m->source[k] = l->pending > 0 ? l->part / l->pending * (m->source[k] - m->q[k]) : 0;
}

long implicit_step(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to,
                   const struct lapse *l, bool monotone) {
    struct implicit *m = g->diffusion.implicit;
    struct problem *p = &m->problem[what];
    const enum implicit_scheme scheme = g->models.diffusion->implicit;
    const double gamma = monotone ? 1 : share_of(scheme);
    p->factor = gamma * l->dt;
    p->Y0 = Y0;
    p->t = l->t;
    renew_patches(g, l->t + 0.5 * l->dt);
    take_start(m, p, l);
    const bool solved = !prepare(m, p) && stages(m, p, scheme, gamma);
    for (int k = 0; k < p->system.rows; k++) m->mean[k] = solved ? l->dt * m->mean[k] : NAN;
    move(g, what, m->mean, true);
    if (!monotone) renew_patches(g, l->t + 0.5 * l->dt); /* the mean of all stages acts at the middle */
    return g->engine->diffusion.end(g, what, Y0, to, l->dt, l->dt);
}
