/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the log of a run and writes its provenance (report.h). */
#include "solvers/output/report.h"

#include "mesh/base/build.h"
#include "solvers/case/changes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static void date_and_host(char date[64], char host[256]) {
    time_t now = time(NULL);
    struct tm parts;
    if (gethostname(host, 255)) snprintf(host, 256, "unknown");
    host[255] = 0;
    if (!localtime_r(&now, &parts) || !strftime(date, 64, "%Y-%m-%dT%H:%M:%S%z", &parts)) date[0] = 0;
}

static void print_mesh(FILE *f, const struct setup *s) {
    const struct polymesh *m = s->mesh;
    if (m->boxes)
        fprintf(f, "Mesh\n    system/blockMeshDict: %d block%s, %ld faces (%ld internal), %d cells; checksum %016lx\n",
                m->boxes->nboxes, m->boxes->nboxes == 1 ? "" : "s", m->boxes->nfaces, m->boxes->ninternal, m->ncells,
                s->checksum);
    else
        fprintf(f, "Mesh\n    %d points, %d faces (%d internal), %d cells; checksum %016lx\n", m->npoints, m->nfaces,
                m->ninternal, m->ncells, s->checksum);
    for (int p = 0; p < m->npatches; p++)
        fprintf(f, "    patch %-16s %-14s %d faces\n", m->patch[p].name, m->patch[p].type, m->patch[p].nfaces);
    const struct lattice *l = s->lattice;
    if (s->grid->polyhedra) {
        char shapes[POLYMESH_SHAPES];
        status_free(polymesh_shapes(m, shapes)); /* on an error the log goes on without the shapes */
        fprintf(f, "    polyhedral, %dD: %s; %d block%s\n    %s%s\n", s->grid->dim, shapes, s->grid->nblocks_all,
                s->grid->nblocks_all == 1 ? "" : "s",
                !l                              ? "no lattice: "
                : s->medium->type->event_driven ? "a lattice, in whose walls grains see facets"
                                                : "a lattice, but system/fvSchemes says  meshEngine polyhedral;",
                l ? "" : s->why);
        return;
    }
    fprintf(f, "    lattice, %dD:", l->dim);
    for (int k = 0; k < l->dim; k++)
        fprintf(f, " %c %d cells of %g%s;", "xyz"[l->axis[k]], l -> n[k], l -> width[k],
                l -> periodic[k] ? " (periodic)" : "");
    fprintf(f, " %d tiles\n", s->grid->nblocks_all);
    const long images = s->grid->forest->images;
    if (images == 1) return;
    for (int k = 0, n = 0; k < l->dim; k++)
        if (l->uniform[k]) fprintf(f, "%s %c", n++ ? " and" : "    uniform along", "xyz"[l->axis[k]]);
    fprintf(f, ": %ld of %d cells are computed\n", m->ncells / images, m->ncells);
}

static void print_dictionaries(FILE *f, const struct setup *s) {
    for (int i = -1; i < s->nfiles; i++) {
        const struct dict *d = i < 0 ? s->control->dict : s->file[i].dict;
        char *text = d ? dict_print(d) : NULL;
        if (text) fprintf(f, "\n// %s\n%s", dict_path(d), text);
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
    s->medium->type->describe(s->medium, f);
    fprintf(f, "Control\n    from time %s (step %ld) to %g", s->start.name, s->start.step, s->control->end_time);
    if (!s->medium->type->event_driven) fprintf(f, ", maxCo %g", s->control->max_co);
    fprintf(f, "\n");
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
    s->medium->type->provenance(s->medium, o);
    changes_record(o, s);
    return sink_close(o);
}

void progress_start(struct progress *p, const struct setup *s) {
    *p = (struct progress){.start_clock = clock_now(), .last_log = -HUGE_VAL, .first_step = s->start.step};
    p->mark_clock = p->start_clock;
    p->mark_time = s->start.t;
    p->first_cpu = cpu_now();
}

void progress_end(struct progress *p) {
    if (p->table.file) fclose(p->table.file);
    p->table.file = NULL;
}

double relative_change(double now, double first) {
    const double scale = fmax(now, first);
    return scale > 0 ? (now - first) / scale : 0;
}

/* Puts the magnitudes of vectors in the place of their first components. */
static void magnitudes(int components, int n, double *const out[3]) {
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = 0; k < components; k++) square += out[k][i] * out[k][i];
        out[0][i] = sqrt(square);
    }
}

status report_extremes(const struct setup *s, int quantity, double range[2]) {
    const struct grid *grid = s->grid;
    const bool vector = s->medium->fields.quantity[quantity].components == 3;
    double pair[2] = {HUGE_VAL, HUGE_VAL};
    for (int b = 0; b < grid->nblocks; b++) {
        const long n = grid->block[b].ncells;
        double *values = NULL;
        TRY(allocate(&values, 3 * n, sizeof(double), "a block's field"));
        double *const out[3] = {values, values + n, values + 2 * n};
        double *const first[3] = {values, values + 1, values + 2}, *const *lines = first;
        const bool uniform = s->medium->type->uniform && s->medium->type->uniform(s->medium, b, quantity, values);
        if (!uniform) s->medium->type->block(s->medium, b, quantity, lines = out);
        if (vector) magnitudes(setup_lines(s, quantity), uniform ? 1 : (int)n, lines);
        for (int i = 0; i < (uniform ? 1 : n); i++) {
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

static void print_duration(FILE *f, double seconds) {
    long n = lround(fmin(seconds, 1e15));
    if (n < 120)
        fprintf(f, "%ld s", n);
    else if (n < 7200)
        fprintf(f, "%ld min %02ld s", n / 60, n % 60);
    else
        fprintf(f, "%ld h %02ld min", n / 3600, n % 3600 / 60);
}

/* Prints the pace and the time left. The first steps are no measure of it: they contain set-up, or a deltaT of their
 * own. */
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

/* Says it once when the folder of the case is gone or replaced: the next write will fail, unless it is put back. */
static void tell_lost(struct progress *p, const struct setup *s) {
    status e = case_here(s);
    if (e && !p->lost) printf("note: %s; the next write fails unless the folder is put back\n", status_text(e));
    p->lost = e != OK;
    status_free(e);
}

/* Writes the row of a step. The processors' time is that of all ranks. */
static status write_row(struct progress *p, const struct setup *s, const struct step_entry *e,
                        const struct log_row *row) {
    long micro = lround(1e6 * (cpu_now() - p->first_cpu));
    comm_sum_long(s->comm, &micro, 1);
    const struct run_moment now = {
        e->t, e->dt, e->courant, e->step, e->limit, clock_now() - p->start_clock, 1e-6 * (double)micro};
    return comm_agree(s->comm, comm_root(s->comm) ? run_table_row(&p->table, s, &now, row) : OK);
}

static void print_step(const struct setup *s, const struct step_entry *e) {
    printf("Time = %.10g  step %ld  deltaT = %.6g (limited by: %s%s", e->t, e->step, e->dt, e->limit, e->cell);
    printf(s->medium->type->event_driven ? ")\n" : ")  Courant %.4f\n", e->courant);
}

status progress_step(struct progress *p, const struct setup *s, const struct step_entry *e, bool print) {
    const bool root = comm_root(s->comm);
    struct log_row row = {0};
    if (print) p->last_log = clock_now();
    if (print && root) print_step(s, e);
    TRY(s->medium->type->log(s->medium, print ? stdout : NULL, &row));
    if (s->control->run_table != TABLE_NONE) TRY(write_row(p, s, e, &row));
    if (!print || !root) return OK;
    print_pace(stdout, p, e);
    tell_lost(p, s);
    fflush(stdout);
    return OK;
}
