/* A bidisperse mixture on a line as a medium (medium.h) of granularSegregation: phi, the concentration of the small
 * grains. Every rank computes the whole line: it is too short to share. */
#include "solvers/report.h"
#include "solvers/segregation_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mixture {
    struct medium base;
    struct segregation_models *models;
    struct segregation_setup line;
    struct field *field;
    struct segregation *solver;
    double *phi;                      /* [n] along the line */
    double mass;                      /* at the start */
    double rate;                      /* 1/s: Courant number of percolation / dt */
    long steps;                       /* since the start of the case */
    struct segregation_counts counts; /* at the last log entry */
};
static struct mixture *of(const struct medium *m) {
    return (struct mixture *)(uintptr_t)m;
}

enum { PHI, PERCOLATION, DIFFUSIVITY, QUANTITIES };
static const struct quantity quantities[] = {
    [PHI] = {"phi", 1, {0, 0, 0, 0, 0, 0, 0}, true},
    [PERCOLATION] = {"percolation", 1, {0, 1, -1, 0, 0, 0, 0}, false},
    [DIFFUSIVITY] = {"diffusivity", 1, {0, 2, -1, 0, 0, 0, 0}, false},
};
static const int written[] = {PHI, -1};
static const char *const walls[] = {"noFlux", NULL};
static const struct field_kind phi_kind = {"phi", 1, {0, 0, 0, 0, 0, 0, 0}, "concentration of the small grains", walls};

static status mixture_read(struct setup *s) {
    struct mixture *x;
    TRY(allocate(&x, 1, sizeof *x, "the mixture"));
    x->base = (struct medium){.type = &segregation_medium, .setup = s};
    s->medium = &x->base;
    TRY(segregation_models_read(s->dir, &x->models));
    s->file[s->nfiles++] = (struct setup_file){"system", "fvSchemes", x->models->schemes};
    s->file[s->nfiles++] = (struct setup_file){"system", "fvSolution", x->models->solution};
    s->file[s->nfiles++] = (struct setup_file){"constant", "segregationProperties", x->models->properties};
    return OK;
}

static status mixture_state(struct setup *s) {
    struct mixture *x = of(s->medium);
    char path[2 * TIME_PATH];
    TRY(segregation_setup_make(s, x->models, &x->line));
    TRY(segregation_setup_laws(s, &x->line));
    const struct field_place place = {s->mesh, x->line.centre, s->start.t};
    snprintf(path, sizeof path, "%s/%s/phi", s->dir, s->start.name);
    TRY(field_read(path, &phi_kind, &place, &x->field));
    for (int i = 0; i < s->mesh->ncells; i++)
        if (!(x->models->scheme.unbounded && s->start.step > 0) &&
            !(x->field->values[i] >= 0 && x->field->values[i] <= 1))
            return field_fail(x->field, &place, i, "it must lie between 0 and 1");
    return setup_grid(s, false, 1);
}

static status mixture_start(struct medium *m) {
    struct mixture *x = of(m);
    const struct setup *s = m->setup;
    const struct segregation_line *l = &x->line.line;
    TRY(allocate(&x->phi, l->n, sizeof(double), "phi"));
    TRY(segregation_make(l, &x->models->scheme, &x->solver));
    for (int i = 0; i < l->n; i++) {
        x->phi[i] = x->field->values[x->line.cell[i]];
        x->rate = fmax(x->rate, fabs(l->speed[i]) / (l->face[i + 1] - l->face[i]));
    }
    free(x->field->values);
    x->field->values = NULL;
    x->mass = segregation_mass(x->solver, x->phi);
    x->steps = s->start.step;
    if (s->control->adjust) m->next = s->start.delta_t;
    return OK;
}

static void mixture_free(struct medium *m) {
    struct mixture *x = of(m);
    segregation_free(x->solver);
    segregation_setup_free(&x->line);
    segregation_models_free(x->models);
    field_free(x->field);
    free(x->phi);
    free(x);
}

static void mixture_describe(const struct medium *m, FILE *f) {
    segregation_models_print(f, of(m)->models);
}

static void mixture_provenance(const struct medium *m, struct sink *o) {
    const struct segregation_models *models = of(m)->models;
    sink_printf(o, "closure         %s;\niteration       %s;\n", segregation_closure_name(models),
                segregation_iteration_name(models));
}

static double mixture_memory(const struct medium *m) {
    return 40. * 8 * m->setup->mesh->ncells * comm_size(m->setup->comm);
}

/* Without a step to go on from: a Courant number of 1, which the error estimate then corrects. */
static void mixture_plan(struct medium *m, const struct control *c, struct pace *out) {
    (void)c;
    const struct mixture *x = of(m);
    const double first = x->rate > 0 ? 1 / x->rate : 1;
    *out = (struct pace){.stable = m->next > 0 ? m->next : first, .rate = x->rate, .limit = "timeTolerance"};
}

static status mixture_step(struct medium *m, const struct control *c, double t, double *dt) {
    struct mixture *x = of(m);
    double next = 0;
    status e = c->adjust ? segregation_advance(x->solver, x->models->time_tolerance, dt, &next, x->phi)
                         : segregation_step(x->solver, *dt, x->steps < x->models->damped, x->phi);
    if (e) return status_note(e, "at t = %.10g", t);
    m->next = next;
    x->steps++;
    return OK;
}

static status mixture_log(struct medium *m, FILE *f) {
    struct mixture *x = of(m);
    const struct segregation_counts n = segregation_counts(x->solver), was = x->counts;
    const double mass = segregation_mass(x->solver, x->phi);
    double low = x->phi[0], high = x->phi[0];
    for (int i = 1; i < x->line.line.n; i++) {
        low = fmin(low, x->phi[i]);
        high = fmax(high, x->phi[i]);
    }
    x->counts = n;
    if (!comm_root(m->setup->comm)) return OK;
    fprintf(f, "    phi %.6g .. %.6g  small grains %.10g (drift %+.2e)  iterations %ld in %ld solves\n", low, high,
            mass, mass / x->mass - 1, n.iterations - was.iterations, n.steps - was.steps);
    if (n.corrected > was.corrected)
        fprintf(f, "    bounded: %ld faces of %ld solves (in all %ld)\n", n.corrected - was.corrected,
                n.bounded - was.bounded, n.corrected);
    if (n.rejected > was.rejected)
        fprintf(f, "    rejected: %ld steps (in all %ld)\n", n.rejected - was.rejected, n.rejected);
    return OK;
}

static status mixture_finish(struct medium *m, FILE *f) {
    const struct segregation_counts n = segregation_counts(of(m)->solver);
    if (comm_root(m->setup->comm) && n.steps)
        fprintf(f, "%ld solves, %.3g iterations each; %ld with bounds; %ld steps rejected\n", n.steps,
                (double)n.iterations / (double)n.steps, n.bounded, n.rejected);
    return OK;
}

static double value_at(const struct mixture *x, int quantity, int i) {
    const struct segregation_setup *l = &x->line;
    if (quantity == PHI) return x->phi[i];
    if (quantity == PERCOLATION) return l->speed[i];
    return segregation_diffusivity(l, l->node[i], x->phi[i]);
}

static void mixture_block(const struct medium *m, int block, int quantity, double *const out[3]) {
    const struct mixture *x = of(m);
    const struct grid_block *b = &m->setup->grid->block[block];
    for (int i = 0; i < b->ncells; i++) out[0][i] = value_at(x, quantity, x->line.place[b->cell[i]]);
}

static status mixture_gather(const struct medium *m, int quantity, double *const out[3]) {
    const struct mixture *x = of(m);
    for (int i = 0; comm_root(m->setup->comm) && i < x->line.line.n; i++)
        out[0][x->line.cell[i]] = value_at(x, quantity, i);
    return OK;
}

static const struct patch_field *mixture_patch(const struct medium *m, int quantity, int patch) {
    return quantity == PHI ? &of(m)->field->patch[patch] : NULL;
}

static const char help[] =
    "granularSegregation -case DIR [-np N] [-dry-run] [-debug] [-listModels] [-listBCs] [-help]\n\n"
    "Solves the segregation of small from large grains on the line of cells of the case in DIR (default: here):\n\n"
    "    d phi/dt + d/dy (f phi (1 - phi)) = d/dy (D d phi/dy), without flux through the walls,\n\n"
    "by the implicit scheme of Christov (2018), second order in time and space, conservative and bounded.\n\n"
    "  -np N        on N ranks: the line is computed by each, the results are the same\n"
    "  -dry-run     reads and checks everything, says what a run would do, writes nothing (see checkCase)\n"
    "  -listModels  models, schemes and function objects with their parameters\n"
    "  -listBCs     boundary conditions\n"
    "  -debug       the way an error took through the program\n\n"
    "Signals, stopAt, the lock and the exit codes are those of granularGas.\n";

const struct medium_type segregation_medium = {
    .application = "granularSegregation",
    .help = help,
    .list_models = segregation_models_list,
    .list_boundaries = segregation_boundaries_list,
    .quantity = quantities,
    .noffered = QUANTITIES,
    .written = written,
    .shown = written,
    .read = mixture_read,
    .state = mixture_state,
    .start = mixture_start,
    .free = mixture_free,
    .describe = mixture_describe,
    .provenance = mixture_provenance,
    .memory = mixture_memory,
    .plan = mixture_plan,
    .step = mixture_step,
    .log = mixture_log,
    .finish = mixture_finish,
    .block = mixture_block,
    .gather = mixture_gather,
    .patch = mixture_patch,
};
