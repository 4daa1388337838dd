/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes limiter.dat, with a row for each step whose state had to be kept admissible, takes its counts over restarts,
 * and says what limits steps (limiter.h). */
#include "solvers/gas/limiter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fraction of alphaMax beyond which it is packing that makes c large. */
static const double DENSE = 0.9;

/* The log tells of this number of explicit steps in a row in dense gas: before the first implicit one, and later. */
enum { FIRST_BED = 100, NEXT_BED = 1000, PLACE = 200 };

/* A bed that lands damps sound in a step or two among many. So there is a warning while a run goes on if more of its
 * steps than LANDING have done so, and MOST of all; at its end if MOST have. */
enum { LANDING = 2 };
static const double MOST = 0.05;

static status open_table(struct limiter_table *l, const struct setup *s) {
    TRY(case_table(s, "limiter", s->start.name, "limiter.dat", &l->file));
    fprintf(l->file,
            "# Steps in which fluxes were limited, steps rejected and halved, or energies raised to the\n"
            "# round-off floor, by `energy`; (x y z) is a cell limited last.\n"
            "%s# Time step cells faces rejected floored energy x y z%s\n",
            l->fills ? "# At the end: cells raised to the density floor, and the mass and energy that added.\n" : "",
            l->fills ? " filled fillMass fillEnergy" : "");
    return OK;
}

static status write_row(struct limiter_table *l, const struct setup *s, const struct gas_counts *n,
                        const struct moment *now) {
    const struct gas_counts *was = &l->counts;
    if (!l->file) TRY(open_table(l, s));
    fprintf(l->file, "%.12g %ld %ld %ld %ld %ld %.6g %.8g %.8g %.8g", now->t, now->step, n->cells - was->cells,
            n->faces - was->faces, n->rejected - was->rejected, n->floored - was->floored, n->energy - was->energy,
            n->place[0], n->place[1], n->place[2]);
    if (l->fills)
        fprintf(l->file, " %ld %.12g %.12g", n->filled - was->filled, n->fill[0] - was->fill[0],
                n->fill[1] - was->fill[1]);
    return case_end_row("limiter", l->file);
}

status limiter_record(struct limiter_table *l, const struct setup *s, const struct gas *g, const struct moment *now) {
    const struct gas_counts n = gas_counts(g), *was = &l->counts;
    if (n.cells == was->cells && n.rejected == was->rejected && n.floored == was->floored) return OK;
    status e = comm_root(s->comm) ? write_row(l, s, &n, now) : OK;
    l->counts = n;
    return comm_agree(s->comm, e);
}

status limiter_save(const struct gas *g, const char *folder, const char *location, struct checksums *sums) {
    const struct gas_counts n = gas_counts(g);
    const struct foam_format ascii = {.precision = 17};
    char path[2 * TIME_PATH], where[TIME_NAME + 16];
    struct file_sum sum;
    struct sink *o;
    if (!n.cells && !n.rejected && !n.floored && !n.filled && !n.repeated && !n.pause[1]) return OK;
    snprintf(path, sizeof path, "%s/uniform/limiter", folder);
    snprintf(where, sizeof where, "%s/uniform", location);
    TRY(sink_open(path, false, &o));
    foam_header_write(o, &ascii, "dictionary", where, "limiter", "counts so far, for restarts");
    sink_printf(o, "cells           %ld;\nfaces           %ld;\nrejected        %ld;\n", n.cells, n.faces, n.rejected);
    sink_printf(o, "floored         %ld;\nenergy          %.17g;\n", n.floored, n.energy);
    sink_printf(o, "filled          %ld;\nfillMass        %.17g;\nfillEnergy      %.17g;\n", n.filled, n.fill[0],
                n.fill[1]);
    sink_printf(o, "repeated        %ld;\nplain           %ld;\n", n.repeated, n.plain);
    if (n.pause[1] > 0) sink_printf(o, "pause           %.17g;\npaused          %.17g;\n", n.pause[0], n.pause[1]);
    sink_printf(o, "place           (%.17g %.17g %.17g);\n", n.place[0], n.place[1], n.place[2]);
    TRY(sink_close_sum(o, &sum));
    return checksums_add(sums, "uniform/limiter", sum);
}

static status read_counts(struct dict *d, struct gas_counts *n) {
    const struct {
        const char *key;
        long *out;
    } counts[] = {{"cells", &n->cells},     {"faces", &n->faces},   {"rejected", &n->rejected},
                  {"floored", &n->floored}, {"filled", &n->filled}, {"repeated", &n->repeated},
                  {"plain", &n->plain}};
    for (int i = 0; i < 7; i++) {
        TRY(dict_count_or(d, counts[i].key, 0, counts[i].out));
        if (*counts[i].out < 0) return dict_fail(d, counts[i].key, "a count is not negative");
    }
    TRY(dict_number(d, "energy", NULL, &n->energy));
    TRY(dict_number(d, "fillMass", NULL, &n->fill[0]));
    TRY(dict_number(d, "fillEnergy", NULL, &n->fill[1]));
    TRY(dict_number_or(d, "pause", NULL, 0, &n->pause[0]));
    TRY(dict_number_or(d, "paused", NULL, 0, &n->pause[1]));
    TRY(dict_vector(d, "place", NULL, n->place));
    return dict_check_used(d);
}

/* Reads the field of this rank's cells; it must be one of scalars. */
static status read_limited(const char *path, const struct setup *s, int *components, double **out) {
    const struct share share = share_make(s->comm, s->mesh->ncells);
    double *slice = NULL;
    long n;
    const int *cell = grid_cells(s->grid, &n);
    status e = field_read_slice(path, s->mesh->ncells, &share, components, &slice);
    if (!e) e = allocate(out, n, sizeof **out, "the field limited");
    e = comm_agree(s->comm, e);
    if (!e && *components == 1) e = share_fetch(&share, 1, slice, n, cell, *out);
    free(slice);
    return e;
}

status limiter_resume(struct limiter_table *l, const struct setup *s, struct gas *g) {
    char path[2 * TIME_PATH];
    struct dict *d = NULL;
    struct gas_counts counts = {.cells = 0};
    double *limited = NULL;
    int components = 1;
    snprintf(path, sizeof path, "%s/%s/uniform/limiter", s->dir, s->start.folder);
    if (!field_exists(path)) return OK;
    TRY(dict_read(path, &d));
    status e = read_counts(d, &counts);
    dict_free(d);
    TRY(e);
    snprintf(path, sizeof path, "%s/%s/limited", s->dir, s->start.folder);
    if (field_exists(path)) TRY(read_limited(path, s, &components, &limited));
    if (components == 1) gas_resume(g, &counts, limited);
    l->counts = gas_counts(g);
    free(limited);
    return components == 1 ? OK : fail(ERR_INPUT, "%s: it is a field of vectors; remove it", path);
}

static void print_cell(char *text, size_t size, const struct gas_cell *q) {
    snprintf(text, size, ", cell at (%.6g %.6g %.6g) with alpha = %.6g, T = %.6g, c = %.6g", q->place[0], q->place[1],
             q->place[2], q->alpha, q->T, q->c);
}

double limiter_cell(struct gas *g, const struct gas_speed *speed, char *text, size_t size) {
    struct gas_cell q;
    gas_fastest_cell(g, speed, &q);
    print_cell(text, size, &q);
    return q.alpha;
}

void limiter_bound(struct gas *g, const struct gas_speed *speed, const struct gas_models *m, char *text, size_t size) {
    const double alpha = limiter_cell(g, speed, text, size), most = m->material.alpha_max;
    const size_t n = strlen(text);
    snprintf(text + n, size - n, "\n      %s",
             most > 0 && alpha > DENSE * most && source_cools(&m->source, &m->material)
                 ? "near packing c has no bound: thresholdSpeed in `grain` keeps grains from collapsing, and larger "
                   "cells there take longer steps"
                 : "hot or fast gas, or a narrow cell (checkCase names such a cell): larger cells there take longer "
                   "steps; alphaFloor keeps thin gas from growing hot");
}

void limiter_note_beds(long *steps, struct gas *g, bool aloud) {
    char cell[PLACE] = "";
    struct gas_bed_bound b;
    if (*steps < 0) return;
    *steps = gas_bed_refused(g) ? *steps + 1 : 0;
    if (*steps < (gas_counts(g).beds > 0 ? NEXT_BED : FIRST_BED)) return;
    gas_bed_bound(g, &b);
    if (b.rate > 0) print_cell(cell, sizeof cell, &b.cell);
    if (aloud)
        printf("    note: gas is dense, but the last %ld steps had no implicit acoustics. Such a step would be limited "
               "by: "
               "%s%s\n      to %.3g explicit steps, and `gain` of `acoustics` asks for %g\n      %s\n",
               *steps, b.name, cell, b.steps, b.gain, b.cure);
    *steps = -1;
}

status limiter_note_damped(bool *said, struct setup *s, const struct case_models *models, const struct gas_counts *n,
                           FILE *f) {
    const bool automatic = models->gas.acoustics->automatic, often = n->damped > (f ? LANDING : 0);
    const double *at = n->damped_at, percent = 100 * fmin(n->damping, 1);
    if (*said || n->damped == 0) return OK;
    if (!automatic && !(often && (double)n->damped > MOST * (double)n->beds)) return OK;
    *said = true;
    if (!automatic)
        return warn(&s->warnings, WARN_DAMPED,
                    "%s:%d: implicit steps damp waves in dense gas: one takes %.3g %% of the motion around (%.6g %.6g "
                    "%.6g); acoustics automatic, or explicit, keeps waves",
                    dict_path(models->solution), dict_line(models->solution, "acoustics"), percent, at[0], at[1],
                    at[2]);
    if (f && comm_root(s->comm))
        fprintf(f,
                "    implicit steps of the bed are left out: they would take %.3g %% of its motion by sound, most at "
                "(%.6g %.6g %.6g)\n",
                percent, at[0], at[1], at[2]);
    return OK;
}

void limiter_close(struct limiter_table *l) {
    if (l->file) fclose(l->file);
    l->file = NULL;
}
