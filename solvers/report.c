#include "solvers/report.h"

#include "solvers/changes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifndef HAFF_VERSION
#define HAFF_VERSION "unknown"
#endif
#ifndef HAFF_GIT
#define HAFF_GIT "unknown"
#endif
#ifndef HAFF_FLAGS
#define HAFF_FLAGS ""
#endif
#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#else
#define COMPILER "gcc " __VERSION__
#endif

const char *build_version(void) {
    return HAFF_VERSION " (git " HAFF_GIT ")";
}
const char *build_compiler(void) {
    return COMPILER " " HAFF_FLAGS;
}

double clock_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
double cpu_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void date_and_host(char date[64], char host[256]) {
    time_t now = time(NULL);
    struct tm parts;
    if (gethostname(host, 255)) snprintf(host, 256, "unknown");
    host[255] = 0;
    if (!localtime_r(&now, &parts) || !strftime(date, 64, "%Y-%m-%dT%H:%M:%S%z", &parts)) date[0] = 0;
}

static void print_mesh(FILE *f, const struct setup *s) {
    const struct polymesh *m = s->mesh;
    fprintf(f, "Mesh\n    %d points, %d faces (%d internal), %d cells; checksum %016lx\n", m->npoints, m->nfaces,
            m->ninternal, m->ncells, s->checksum);
    for (int p = 0; p < m->npatches; p++)
        fprintf(f, "    patch %-16s %-14s %d faces\n", m->patch[p].name, m->patch[p].type, m->patch[p].nfaces);
    const struct lattice *l = s->lattice;
    if (s->grid->mosaic) {
        char shapes[POLYMESH_SHAPES];
        status_free(polymesh_shapes(m, shapes)); /* without memory for it, a log without it */
        fprintf(f, "    polyhedral, %dD: %s; %d block%s\n    %s%s\n", s->grid->dim, shapes, s->grid->nblocks_all,
                s->grid->nblocks_all == 1 ? "" : "s",
                l ? "a lattice, but system/fvSchemes says  meshEngine polyhedral;" : "no lattice: ", l ? "" : s->why);
        return;
    }
    fprintf(f, "    lattice, %dD:", l->dim);
    for (int k = 0; k < l->dim; k++)
        fprintf(f, " %c %d cells of %g%s;", "xyz"[l->axis[k]], l -> n[k], l -> width[k],
                l -> periodic[k] ? " (periodic)" : "");
    fprintf(f, " %d tiles\n", s->grid->nblocks_all);
}

static void print_dictionaries(FILE *f, const struct setup *s) {
    const struct dict *all[] = {s->control->dict,      s->models->schemes, s->models->solution,
                                s->models->properties, s->models->g,       s->models->shaking};
    for (int i = 0; i < 6; i++) {
        char *text = all[i] ? dict_print(all[i]) : NULL;
        if (text) fprintf(f, "\n// %s\n%s", dict_path(all[i]), text);
        free(text);
    }
    fprintf(f, "\n");
}

void report_header(FILE *f, const struct setup *s, bool dictionaries) {
    char date[64], host[256];
    date_and_host(date, host);
    fprintf(f, "haff %s\n    compiler  %s\n    started   %s on %s, %d rank%s\n    case      %s\n", build_version(),
            build_compiler(), date, host, comm_size(s->comm), comm_size(s->comm) == 1 ? "" : "s", s->dir);
    print_mesh(f, s);
    models_print(f, s->models, s->grid->mosaic != NULL);
    fprintf(f, "Control\n    from time %s (step %ld) to %g, maxCo %g\n", s->start.name, s->start.step,
            s->control->end_time, s->control->max_co);
    if (dict_has(s->control->dict, "libs")) fprintf(f, "    'libs' is ignored: nothing is loaded at run time\n");
    fprintf(f, "    memory about %.3g MB\n", case_memory(s) / 1e6);
    if (dictionaries) print_dictionaries(f, s);
    fflush(f);
}

status provenance_write(const char *path, const char *location, const struct setup *s) {
    char date[64], host[256];
    struct sink *o;
    const struct foam_format ascii = {.precision = 17};
    date_and_host(date, host);
    TRY(sink_open(path, false, &o));
    foam_header_write(o, &ascii, "dictionary", location, "provenance", NULL);
    sink_printf(o, "version         \"%s\";\ncompiler        \"%s\";\n", build_version(), build_compiler());
    sink_printf(o, "host            \"%s\";\ndate            \"%s\";\nranks           %d;\n", host, date,
                comm_size(s->comm));
    const struct gas_models *g = &s->models->gas;
    bool polyhedral = s->grid->mosaic != NULL;
    sink_printf(o, "equationOfState %s;\nfluxScheme      %s;\ntimeScheme      %s;\n", g->eos->name, g->flux->name,
                g->stepper->name);
    sink_printf(o, "meshEngine      %s;\n%s %s;\n", polyhedral ? "polyhedral" : "lattice",
                polyhedral ? "polyReconstruct" : "reconstruct    ",
                polyhedral ? g->polynomial->name : g->reconstruct->name);
    changes_record(o, s);
    return sink_close(o);
}

status progress_start(struct progress *p, const struct setup *s, struct gas *g) {
    *p = (struct progress){.start_clock = clock_now(), .last_log = -HUGE_VAL, .first_step = s->start.step};
    p->mark_clock = p->start_clock;
    p->mark_time = s->start.t;
    p->counts = gas_counts(g);
    return gas_totals(g, p->totals);
}

/* Smallest and largest value of a scalar field over all ranks. */
static status extremes(const struct setup *s, const struct gas *g, enum gas_field field, double range[2]) {
    const struct grid *grid = s->grid;
    double pair[2] = {HUGE_VAL, HUGE_VAL};
    for (int b = 0; b < grid->nblocks; b++) {
        int n = grid->block[b].ncells;
        double *values = NULL;
        TRY(allocate(&values, n, sizeof(double), "a block's field"));
        double *const out[3] = {values, NULL, NULL};
        gas_block_field(g, b, field, out);
        for (int i = 0; i < n; i++) {
            pair[0] = fmin(pair[0], values[i]);
            pair[1] = fmin(pair[1], -values[i]);
        }
        free(values);
    }
    comm_min(s->comm, pair, 2);
    range[0] = pair[0];
    range[1] = -pair[1];
    return OK;
}

/* What must stay, drifts; what flows in or out or is taken by a source, changes. */
static const char *word_for(const struct setup *s, bool energy) {
    for (int p = 0; p < s->mesh->npatches; p++) {
        const struct boundary_type *type = s->initial->rules[p].velocity.type;
        if (type && !type->reflects) return "change";
    }
    return energy && source_active(&s->models->gas.source, &s->models->gas.material) ? "change" : "drift";
}

static void print_totals(FILE *f, const struct progress *p, const struct setup *s, const double now[MAX_VAR]) {
    int dim = s->grid->dim;
    const double *was = p->totals;
    fprintf(f, "    mass %.10g (%s %+.2e)  momentum (", now[0], word_for(s, false), now[0] / was[0] - 1);
    for (int k = 0; k < dim; k++) fprintf(f, "%s%.6g", k ? " " : "", now[1 + k]);
    fprintf(f, ")  energy %.10g (%s %+.2e)\n", now[1 + dim], word_for(s, true), now[1 + dim] / was[1 + dim] - 1);
}

static void print_duration(FILE *f, double seconds) {
    long n = lround(fmin(seconds, 1e15));
    if (n < 120)
        fprintf(f, "%ld s", n);
    else if (n < 7200)
        fprintf(f, "%ld min %02ld s", n / 60, n % 60);
    else
        fprintf(f, "%ld h %02ld min", n / 3600, n % 3600 / 60);
}

/* The first steps are no measure: set-up, a deltaT of their own. */
static void print_pace(FILE *f, struct progress *p, const struct step_entry *e) {
    double clock = clock_now(), spent = clock - p->start_clock;
    long steps = e->step - p->first_step;
    if (steps < 1) return;
    fprintf(f, "    wall %.1f s, %.3g s/step", spent, spent / (double)steps);
    if (clock - p->mark_clock > 0.5 || steps <= 10) {
        p->pace = (clock - p->mark_clock) / (e->t - p->mark_time);
        p->mark_clock = clock;
        p->mark_time = e->t;
    }
    if (isfinite(e->end_time) && e->end_time > e->t && steps > 1) {
        fprintf(f, ", ETA ");
        print_duration(f, (e->end_time - e->t) * p->pace);
    }
    fprintf(f, "\n");
}

static const char *plural(long n) {
    return n == 1 ? "" : "s";
}

/* What was done since the entry before to keep the state admissible. */
static void print_limited(FILE *f, const struct gas_counts *was, const struct gas_counts *n) {
    const long faces = n->faces - was->faces, cells = n->cells - was->cells, rejected = n->rejected - was->rejected;
    const long floored = n->floored - was->floored;
    if (cells > 0)
        fprintf(f, "    limited: %ld face%s of %ld cell%s, the last at (%.6g %.6g %.6g) (in all %ld, %ld)\n", faces,
                plural(faces), cells, plural(cells), n->place[0], n->place[1], n->place[2], n->faces, n->cells);
    if (rejected > 0) fprintf(f, "    rejected: %ld step%s (in all %ld)\n", rejected, plural(rejected), n->rejected);
    if (floored > 0)
        fprintf(f, "    round-off floor: %ld cell%s, energy +%.3g (in all %ld, +%.3g)\n", floored, plural(floored),
                n->energy - was->energy, n->floored, n->energy);
}

status progress_print(struct progress *p, const struct setup *s, struct gas *g, const struct step_entry *e) {
    double alpha[2], T[2], mach[2], totals[MAX_VAR];
    TRY(extremes(s, g, GAS_ALPHA, alpha));
    TRY(extremes(s, g, GAS_T, T));
    TRY(extremes(s, g, GAS_MACH, mach));
    TRY(gas_totals(g, totals));
    p->last_log = clock_now();
    struct gas_counts n = gas_counts(g), was = p->counts;
    p->counts = n;
    if (!comm_root(s->comm)) return OK;
    printf("Time = %.10g  step %ld  deltaT = %.6g (limited by: %s", e->t, e->step, e->dt, e->limit);
    if (e->at_cell) printf(", cell at (%.6g %.6g %.6g)", e->place[0], e->place[1], e->place[2]);
    printf(")  Courant %.4f\n", e->courant);
    printf("    alpha %.6g .. %.6g  T %.6g .. %.6g  Ma %.6g .. %.6g\n", alpha[0], alpha[1], T[0], T[1], mach[0],
           mach[1]);
    print_totals(stdout, p, s, totals);
    print_limited(stdout, &was, &n);
    print_pace(stdout, p, e);
    fflush(stdout);
    return OK;
}
