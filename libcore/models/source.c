/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sources: their exact sub-steps, their table, and the functions that run them in turn. A new source is written
 * here alone. */
#include "libcore/models/source.h"

#define PI 3.14159265358979323846

/* Cooling, by its law (libcore/models/cooling.h; docs/physics.md 3.2). */

static bool cooling_active(const struct sources *all, const struct material *m) {
    return all->cooling && effective_restitution(m) < 1 && m->diameter > 0;
}

static void cooling_step(const struct source_step *s, int n, const double *restrict rho, double *const mom[MAX_DIM],
                         double *restrict eps) {
    (void)mom;
    const struct closure_line cells = {.eos = s->eos,
                                       .material = s->material,
                                       .n = n,
                                       .rho = rho,
                                       .shear_rate = s->shear_rate,
                                       .by_impacts = s->by_impacts,
                                       .late = s->late};
    s->all->cooling->step(&s->all->cooling_params, &cells, s->dt, eps);
}

/* Gravity, constant or shaken (docs/physics.md 3.1): g(t) = gravity (1 + a(t) cos(2 pi frequency t + phase)). */

static bool gravity_active(const struct sources *all, const struct material *m) {
    (void)m;
    return all->gravity[0] != 0 || all->gravity[1] != 0 || all->gravity[2] != 0;
}

bool source_shaken(const struct sources *s) {
    for (int i = 0; i < s->knots; i++)
        if (s->ramp[2 * i + 1] != 0) return true;
    return s->knots == 0 && s->amplitude != 0;
}

/* Returns the integral of cos(omega t + phase) from t to t + dt. */
static double swing(const struct sources *s, double t, double dt) {
    double omega = 2 * PI * s->frequency;
    return omega > 0 ? (sin(omega * (t + dt) + s->phase) - sin(omega * t + s->phase)) / omega : dt * cos(s->phase);
}

/* Returns the integral of (a + slope (t' - t)) cos(omega t' + phase) from t to t + dt, by parts; `swung` is minus the
 * integral of sin(omega t' + phase). */
static double sloping_swing(const struct sources *s, double t, double dt, double a, double slope) {
    double omega = 2 * PI * s->frequency, end = omega * (t + dt) + s->phase;
    if (!(omega > 0)) return (a + 0.5 * slope * dt) * dt * cos(s->phase);
    double swung = (cos(end) - cos(omega * t + s->phase)) / omega;
    return a * swing(s, t, dt) + slope * (dt * sin(end) + swung) / omega;
}

/* Returns the integral of a(t') cos(omega t' + phase) from t to t + dt with the ramp's a, from knot to knot. */
static double ramped_swing(const struct sources *s, double t, double dt) {
    const double(*knot)[2] = (const double(*)[2])s->ramp;
    const int last = s->knots - 1;
    double sum = 0, end = t + dt, from = t;
    for (int i = -1; i <= last && from < end; i++) { /* piece i: between knots i and i + 1 */
        const double *low = knot[i < 0 ? 0 : i], *high = knot[i < last ? i + 1 : last];
        if (i < last && high[0] <= from) continue;
        double to = i < last && high[0] < end ? high[0] : end;
        double slope = high[0] > low[0] ? (high[1] - low[1]) / (high[0] - low[0]) : 0;
        sum += sloping_swing(s, from, to - from, low[1] + slope * (from - low[0]), slope);
        from = to;
    }
    return sum;
}

void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]) {
    double time = dt;
    if (s->knots > 0)
        time += ramped_swing(s, t, dt);
    else if (s->amplitude != 0)
        time += s->amplitude * swing(s, t, dt);
    for (int k = 0; k < MAX_DIM; k++) kick[k] = s->gravity[k] * time;
}

void source_gravity(const struct sources *s, double t, double dt, double gravity[MAX_DIM]) {
    double first[MAX_DIM], second[MAX_DIM];
    source_kick(s, t, 0.5 * dt, first);
    source_kick(s, t + 0.5 * dt, 0.5 * dt, second);
    for (int k = 0; k < MAX_DIM; k++) gravity[k] = (first[k] + second[k]) / dt;
}

bool source_falls(const struct sources *s, int dim) {
    bool falls = false;
    for (int k = 0; k < dim; k++) falls |= s->gravity[k] != 0;
    return falls;
}

static void gravity_plan(struct source_step *s) {
    source_kick(s->all, s->t, s->dt, s->kick);
}

KERNEL static void kick_momentum(int n, double kick, const double *restrict rho, double *restrict mom) {
    for (int i = 0; i < n; i++) mom[i] += rho[i] * kick;
}

KERNEL static bool any_of(int n, const double *restrict falls) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) any |= bits_of(falls[i]);
    return any != 0;
}

KERNEL static void kick_falling(int n, double kick, const double *restrict falls, const double *restrict rho,
                                double *restrict mom) {
    for (int i = 0; i < n; i++) mom[i] += rho[i] * (falls[i] * kick);
}

static void gravity_step(const struct source_step *s, int n, const double *restrict rho, double *const mom[MAX_DIM],
                         double *restrict eps) {
    (void)eps;
    for (int k = 0; k < s->dim; k++)
        if (s->kick[k] != 0) kick_momentum(n, s->kick[k], rho, mom[k]);
}

/* Does what gravity_step does, in the cells in which falls is 1; in the others falls is 0. */
static void fall(const struct source_step *s, int n, const double *falls, const double *rho,
                 double *const mom[MAX_DIM]) {
    for (int k = 0; k < s->dim; k++)
        if (s->kick[k] != 0) kick_falling(n, s->kick[k], falls, rho, mom[k]);
}

/* Linear drag by a gas between the grains, of velocity u_g (docs/physics.md 3.5): du/dt = -rate (u - u_g). It acts on
 * each grain, so that random velocities decay, too, and dT/dt = -2 rate T. */

struct linear_drag {
    double rate, velocity[MAX_DIM];
};
#define PARAM_STRUCT struct linear_drag
static const struct param linear_drag_param[] = {
    NUMBER("rate", rate, REQUIRED, FROM_TO(0, HUGE_VAL), UNIT(0, 0, -1),
           "of the decay of a grain's velocity relative to the gas"),
    VECTOR("velocity", velocity, 0, ANY_NUMBER, UNIT(0, 1, -1), "of the gas between the grains"),
};
#undef PARAM_STRUCT
OWN_PARAMS_FIT(struct linear_drag);

static struct linear_drag linear_drag_of(const struct own_params *params) {
    struct linear_drag own;
    memcpy(&own, params, sizeof own);
    return own;
}

static void linear_drag_plan(struct source_step *s) {
    const struct linear_drag d = linear_drag_of(s->params);
    const double path = smaller(d.rate * s->dt, 300); /* e^-600 of T is left, however long the step is */
    s->number[0] = exponential(-path);
    s->number[1] = s->number[0] * s->number[0];
    for (int k = 0; k < s->dim; k++) s->kick[k] = -d.velocity[k] * exponential_minus_one(-path);
}

/* Computes u_g + (u - u_g) e^(-rate dt) in such a form that gas of the velocity u_g keeps its bits. */
KERNEL static void drag_momentum(int n, double velocity, double decay, const double *restrict rho,
                                 double *restrict mom) {
    for (int i = 0; i < n; i++) {
        double carried = rho[i] * velocity;
        mom[i] = carried + (mom[i] - carried) * decay;
    }
}

KERNEL static void drag_energy(int n, double decay, double *restrict eps) {
    for (int i = 0; i < n; i++) eps[i] *= decay;
}

static void linear_drag_step(const struct source_step *s, int n, const double *restrict rho, double *const mom[MAX_DIM],
                             double *restrict eps) {
    const struct linear_drag d = linear_drag_of(s->params);
    for (int k = 0; k < s->dim; k++) drag_momentum(n, d.velocity[k], s->number[0], rho, mom[k]);
    drag_energy(n, s->number[1], eps);
}

/* Uniform heating, a thermostat that kicks each grain at random (docs/physics.md 3.6): dT/dt = rate. */

struct uniform_heating {
    double rate;
};
#define PARAM_STRUCT struct uniform_heating
static const struct param uniform_heating_param[] = {
    NUMBER("rate", rate, REQUIRED, FROM_TO(0, HUGE_VAL), UNIT(0, 2, -3), "dT/dt by random kicks, T per unit mass"),
};
#undef PARAM_STRUCT
OWN_PARAMS_FIT(struct uniform_heating);

static struct uniform_heating uniform_heating_of(const struct own_params *params) {
    struct uniform_heating own;
    memcpy(&own, params, sizeof own);
    return own;
}

static void uniform_heating_plan(struct source_step *s) {
    s->number[0] = eps_of(s->material, uniform_heating_of(s->params).rate * s->dt);
}

KERNEL static void heat_energy(int n, double rise, double *restrict eps) {
    for (int i = 0; i < n; i++) eps[i] += rise;
}

static void uniform_heating_step(const struct source_step *s, int n, const double *restrict rho,
                                 double *const mom[MAX_DIM], double *restrict eps) {
    (void)rho, (void)mom;
    heat_energy(n, s->number[0], eps);
}

static double uniform_heating_gained(const struct source_step *s, const double totals[MAX_VAR]) {
    return s->number[0] * totals[0];
}

/* The budget adds up in this order, so new rows go behind the others: the sums of the oldest cases keep their bits. */
const struct source_type source_table[] = {
    {.model = MODEL("cooling", "what impacts take, by the law of `cooling`"),
     .cause = "cooling",
     .cools = true,
     .active = cooling_active,
     .step = cooling_step},
    {.model = MODEL("gravity", "constant/g, modulated by constant/shaking"),
     .cause = "gravity",
     .pushes = true,
     .active = gravity_active,
     .plan = gravity_plan,
     .step = gravity_step},
    {.model = MODEL_WITH("linearDrag",
                         "a gas between the grains drags each of them: du/dt = -rate (u - velocity), dT/dt = -2 rate T",
                         linear_drag_param),
     .cause = "linearDrag",
     .pushes = true,
     .cools = true,
     .plan = linear_drag_plan,
     .step = linear_drag_step},
    {.model = MODEL_WITH("uniformHeating", "a thermostat that kicks each grain at random: dT/dt = rate",
                         uniform_heating_param),
     .cause = "uniformHeating",
     .heats = true,
     .plan = uniform_heating_plan,
     .step = uniform_heating_step,
     .gained = uniform_heating_gained},
};
const int source_count = sizeof source_table / sizeof *source_table;
_Static_assert(sizeof source_table / sizeof *source_table <= SOURCE_MOST, "struct sources has room for every row");

int source_gravity_row(void) {
    int row = 0;
    while (source_table[row].step != gravity_step) row++;
    return row;
}

bool source_row_active(const struct sources *s, const struct material *m, int row) {
    const struct source_type *r = &source_table[row];
    return r->active ? r->active(s, m) : s->on[row];
}

bool source_active(const struct sources *s, const struct material *m) {
    for (int i = 0; i < source_count; i++)
        if (source_row_active(s, m, i)) return true;
    return false;
}

unsigned source_needs(const struct sources *s, const struct material *m) {
    return cooling_active(s, m) ? s->cooling->needs : 0;
}

bool source_cools(const struct sources *s, const struct material *m) {
    return cooling_active(s, m);
}

bool source_heats(const struct sources *s) {
    for (int i = 0; i < source_count; i++)
        if (s->on[i] && source_table[i].heats) return true;
    return false;
}

bool source_thermal(const struct sources *s) {
    bool cools = s->cooling != NULL;
    for (int i = 0; i < source_count; i++) cools |= s->on[i] && source_table[i].cools;
    return cools || source_heats(s);
}

void source_plan(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 bool backwards, struct source_plan *out) {
    out->n = 0;
    out->warm = -1;
    for (int i = 0; i < source_count; i++) {
        const int row = backwards ? source_count - 1 - i : i;
        const struct source_type *r = &source_table[row];
        if (!source_row_active(s, m, row)) continue;
        struct source_step *step = &out->step[out->n++];
        *step = (struct source_step){.row = r,
                                     .all = s,
                                     .params = &s->params[row],
                                     .eos = eos,
                                     .material = m,
                                     .dim = dim,
                                     .t = t,
                                     .dt = dt,
                                     .late = backwards};
        if (r->plan) r->plan(step);
    }
    out->gravity_alone = out->n == 1 && out->step[0].row->step == gravity_step;
}

void source_plan_part(struct source_plan *plan, bool gravity) {
    int kept = 0;
    for (int i = 0; i < plan->n; i++)
        if ((plan->step[i].row->step == gravity_step) == gravity) plan->step[kept++] = plan->step[i];
    plan->n = kept;
    plan->gravity_alone = gravity && kept > 0;
}

void source_pull(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 double pull[MAX_DIM]) {
    struct source_plan plan;
    source_plan(s, eos, m, dim, t, dt, false, &plan);
    for (int k = 0; k < MAX_DIM; k++) {
        pull[k] = 0;
        for (int i = 0; i < plan.n; i++) pull[k] += plan.step[i].kick[k];
        pull[k] /= dt;
    }
}

KERNEL static void internal_energy(int n, int dim, double *const U[MAX_VAR], double *restrict eps) {
    const double *restrict rho = U[0], *restrict E = U[dim + 1];
    for (int i = 0; i < n; i++) eps[i] = 0;
    for (int k = dim; k >= 1; k--) {
        const double *restrict mom = U[k];
        for (int i = 0; i < n; i++) eps[i] += mom[i] * mom[i];
    }
    for (int i = 0; i < n; i++) {
        double inverse = 1 / rho[i];
        eps[i] = (E[i] - 0.5 * eps[i] * inverse) * inverse;
    }
}

KERNEL static void total_energy(int n, int dim, double *const U[MAX_VAR], const double *restrict eps) {
    const double *restrict rho = U[0];
    double *restrict E = U[dim + 1];
    for (int i = 0; i < n; i++) E[i] = 0;
    for (int k = dim; k >= 1; k--) {
        const double *restrict mom = U[k];
        for (int i = 0; i < n; i++) E[i] += mom[i] * mom[i];
    }
    for (int i = 0; i < n; i++) E[i] = rho[i] * eps[i] + 0.5 * E[i] / rho[i];
}

/* Drag takes eps to 0 within some 370 of its times. eps < 0 stays, for the check of states to see. */
KERNEL static void hold_energy(int n, double *restrict eps) {
    for (int i = 0; i < n; i++) {
        const bool cold = (eps[i] >= 0) & (eps[i] < SOURCE_COLDEST);
        eps[i] = cold ? SOURCE_COLDEST : eps[i];
    }
}

KERNEL static bool find_falling(int n, double warm, const double *restrict eps, double *restrict falls) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        falls[i] = eps[i] < warm ? 1 : 0;
        any |= bits_of(falls[i]);
    }
    return any != 0;
}

/* E = before in the cells that do not fall: no bit of a cell may depend on those that share its row. */
KERNEL static void keep_energy(int n, const double *restrict falls, const double *restrict before, double *restrict E) {
    for (int i = 0; i < n; i++) E[i] = falls[i] > 0 ? E[i] : before[i];
}

/* Has the plan a step that acts on one of the cells? drops: gravity does. */
static bool acts(const struct source_plan *plan, bool drops) {
    for (int i = 0; i < plan->n; i++)
        if (plan->step[i].row->step != gravity_step || drops) return true;
    return false;
}

bool source_apply(const struct source_plan *plan, int n, double *const U[MAX_VAR], double *falls,
                  const double *shear_rate, const double *by_impacts) {
    double eps[BATCH], before[BATCH];
    struct source_step seeing;
    const bool find = falls && plan->warm >= 0, keeps = falls && plan->gravity_alone;
    bool falling = falls && !find && any_of(n, falls);
    if (plan->n == 0 || (!find && !acts(plan, !falls || falling))) return falling;
    const int dim = plan->step[0].dim;
    internal_energy(n, dim, U, eps);
    if (find) falling = find_falling(n, plan->warm, eps, falls);
    if (find && !acts(plan, falling)) return falling;
    if (keeps) memcpy(before, U[dim + 1], (size_t)n * sizeof *before);
    for (int i = 0; i < plan->n; i++) {
        const struct source_step *step = &plan->step[i];
        if (shear_rate) {
            seeing = *step;
            seeing.shear_rate = shear_rate;
            seeing.by_impacts = by_impacts;
            step = &seeing;
        }
        if (!falls || step->row->step != gravity_step)
            step->row->step(step, n, U[0], U + 1, eps);
        else if (falling)
            fall(step, n, falls, U[0], U + 1);
    }
    hold_energy(n, eps);
    total_energy(n, dim, U, eps);
    if (keeps) keep_energy(n, falls, before, U[dim + 1]);
    return falling;
}
