/* The steps of implicit.h, made of the hooks of the engine; a module that the caller of gas_make gave solves the
 * systems. */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

/* The error allowed in a solution, relative to a cell's T, or to the speed of its energy for velocities. */
static const double TOLERANCE = 1e-6;
enum { PASSES = 3 };

struct problem {
    struct gas *gas;
    enum diffusing what;
    double factor; /* gamma dt */
    const struct state *Y0;
    int *place; /* of a link's weight in system.value */
    struct linear_system system;
    struct linear_solver *solver;
};

struct implicit {
    const struct linear_module *module;
    struct links links;
    struct problem problem[2];
    double *mass, *limit, *weight; /* limit: the speed whose energy a cell has, m/s */
    double *q, *moved, *f, *mean;  /* the solution in hand, gamma dt L q/rho; S/dt */
    double *source;                /* what friction makes of T in this step */
    double *b, *d;
};

/* ---- the systems as functions --------------------------------------------------------------------------------------
 */

/* gamma dt L x/rho, of x alone or with what is given at the edges. Scaled so that what rounding q_0 leaves is small. */
static void operate(const struct problem *p, const double *x, bool edges, double *y) {
    const double only[5] = {0, 0, 1, -1, 0}; /* L S/rho, without q_0 */
    struct gas *g = p->gas;
    for (int k = 0; k < p->system.rows; k++) y[k] = p->factor * x[k];
    g->engine->implicit.move(g, p->what, y, true);
    g->engine->diffusion.stage(g, p->what, p->Y0, only, edges ? p->factor : 0);
    g->engine->implicit.move(g, p->what, y, false);
}

static void apply(const void *caller, const double *x, double *y) {
    const struct problem *p = caller;
    const double *mass = p->gas->implicit->mass;
    operate(p, x, false, y);
    for (int i = 0, k = 0; k < p->system.rows; i++)
        for (int c = 0; c < p->system.unknowns; c++, k++) y[k] = mass[i] * (x[k] - y[k]);
}

/* A residual leaves an error of at most residual/mass in a stiff cell (implicit.h). */
static double error_of(const void *caller, const double *x, const double *residual) {
    const struct problem *p = caller;
    const struct implicit *m = p->gas->implicit;
    double most = 0;
    for (int i = 0, k = 0; k < p->system.rows; i++)
        for (int c = 0; c < p->system.unknowns; c++, k++) {
            const double scale = p->what == HEAT ? fabs(m->q[k] + x[k]) : m->limit[i];
            const double error = fabs(residual[k]) / (m->mass[i] * scale * TOLERANCE + 1e-300);
            if (!(error <= most)) most = error == error ? error : HUGE_VAL;
        }
    comm_max(p->gas->comm, &most, 1);
    return most;
}

/* ---- set-up --------------------------------------------------------------------------------------------------------
 */

status implicit_first(const struct gas *g, int cells, long *first) {
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

/* The place of number k among n in ascending order; equal ones share one. */
static int place_of(const int *number, int n, int k) {
    int before = 0;
    for (int i = 0; i < n; i++) {
        bool first = number[i] < number[k];
        for (int j = 0; j < i && first; j++) first = number[j] != number[i];
        before += first;
    }
    return before;
}

/* The links of every unknown, in ascending order; `place` remembers where each went. */
static status problem_make(struct implicit *m, struct gas *g, enum diffusing what) {
    struct problem *p = &m->problem[what];
    struct linear_system *s = &p->system;
    const struct links *l = &m->links;
    const int unknowns = what == VISCOUS ? g->dim : 1, links = l->first[l->cells];
    p->gas = g;
    p->what = what;
    *s = (struct linear_system){.comm = comm_handle(g->comm),
                                /* not stress: at walls, and where viscosities vary */
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
    if (!m->module)
        return fail(ERR_INPUT, "diffusion implicit: it wants a solver of linear systems, and none was given");
    TRY(g->engine->implicit.pattern(g, &m->links));
    const long cells = m->links.cells, rows = cells * g->dim;
    TRY(allocate(&m->weight, m->links.first[cells] * (long)g->dim, sizeof(double), "a linear system"));
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

/* ---- one step ------------------------------------------------------------------------------------------------------
 */

static const char *prepare(struct implicit *m, struct problem *p) {
    struct gas *g = p->gas;
    const int links = m->links.first[m->links.cells] * p->system.unknowns;
    g->engine->implicit.matrix(g, p->what, p->Y0, p->factor, m->mass, m->limit, m->weight);
    for (int i = 0; i < m->links.cells; i++) m->limit[i] = sqrt(2 * fabs(m->limit[i]) / m->mass[i]);
    memset(p->system.value, 0, (size_t)links * sizeof(double));
    for (int i = 0; i < links; i++) p->system.value[p->place[i]] += m->weight[i];
    return m->module->prepare(p->solver);
}

/* A d = b; the iterations, or < 0 on all ranks: it was not solved. */
static int solve(struct implicit *m, struct problem *p) {
    int iterations;
    memset(m->d, 0, (size_t)p->system.rows * sizeof *m->d);
    if (m->module->solve(p->solver, m->b, m->d, &iterations)) return -1;
    if (iterations > 0) p->gas->counts.stages[p->what] += iterations;
    return iterations;
}

/* Solves q = f + moved(q) from a first guess q, whose moved(q) is in m->moved, before and after. Iterative refinement:
 * in a hot thin cell the round-off of what the cell loses exceeds what it keeps, so the residual is solved for once
 * more. */
static bool stage(struct implicit *m, struct problem *p, const double *f, double *q) {
    const int rows = p->system.rows, unknowns = p->system.unknowns;
    for (int pass = 0; pass < PASSES; pass++) {
        for (int k = 0; k < rows; k++) m->b[k] = m->mass[k / unknowns] * (f[k] + m->moved[k] - q[k]);
        const int iterations = solve(m, p);
        if (iterations <= 0) return iterations == 0;
        for (int k = 0; k < rows; k++) q[k] += m->d[k];
        operate(p, q, true, m->moved);
    }
    return true;
}

/* S/dt */
static bool stages(struct implicit *m, struct problem *p, double gamma, bool monotone) {
    const int rows = p->system.rows;
    for (int k = 0; k < rows; k++) m->f[k] = m->q[k] + gamma * m->source[k];
    operate(p, m->q, true, m->moved);
    if (!stage(m, p, m->f, m->q)) return false;
    for (int k = 0; k < rows; k++) m->mean[k] = m->q[k];
    if (monotone) return true;
    for (int k = 0; k < rows; k++) m->f[k] += (1 - gamma) / gamma * m->moved[k] + (1 - gamma) * m->source[k];
    if (!stage(m, p, m->f, m->q)) return false;
    for (int k = 0; k < rows; k++) m->mean[k] += gamma * (m->q[k] - m->mean[k]);
    return true;
}

/* q_0 and the source. */
static void take_start(struct implicit *m, struct problem *p, const struct lapse *l) {
    const struct engine *engine = p->gas->engine;
    engine->diffusion.begin(p->gas, p->what, p->Y0, 1, 0);
    engine->implicit.move(p->gas, p->what, m->source, false);
    engine->diffusion.begin(p->gas, p->what, p->Y0, 1, l->rest);
    engine->implicit.move(p->gas, p->what, m->q, false);
    for (int k = 0; k < p->system.rows; k++)
        m->source[k] = l->rest > 0 ? l->part / l->rest * (m->source[k] - m->q[k]) : 0;
}

long implicit_step(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to,
                   const struct lapse *l, bool monotone) {
    struct implicit *m = g->implicit;
    struct problem *p = &m->problem[what];
    const double gamma = monotone ? 1 : 1 - sqrt(0.5);
    p->factor = gamma * l->dt;
    p->Y0 = Y0;
    take_start(m, p, l);
    const bool solved = !prepare(m, p) && stages(m, p, gamma, monotone);
    for (int k = 0; k < p->system.rows; k++) m->mean[k] = solved ? l->dt * m->mean[k] : NAN;
    g->engine->implicit.move(g, what, m->mean, true);
    return g->engine->diffusion.end(g, what, Y0, to, l->dt, l->dt);
}
