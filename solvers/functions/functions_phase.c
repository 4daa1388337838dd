/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object phaseAverage writes means of fields at the same phases of a period, summed on the root.
 *
 * Bin j holds the moments start + (k + j/phases) period, k = 0, 1, .... U and T (and the components of T), which are
 * per unit mass, are weighted by rho if the medium has it: sum rho U / sum rho, sum rho T / sum rho (0 where there
 * never was mass), those of one kind of grains by its alpha; all other fields have the plain mean. What is summed is
 * linear in time between the ends of a step, with an error of dt^2/8 times the second derivative: steps do not end at
 * the moments, and the run keeps its bits. The steps of granularMD do, which changes nothing of the grains, and lets
 * means over the past end there. */
#include "solvers/functions/functions_private.h"

#include "solvers/output/output.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PHASES = 1000, MOST_SAMPLES = 10000 /* in one step */ };

struct phases {
    double period, start;         /* s */
    int n;                        /* number of phases, each of which is a bin */
    struct means_weights weights; /* the first is rho, if the medium has it */
    long ncells, size; /* size: doubles of a bin, [ncells][components] of each field, then [ncells] of each weight */
    bool resumed;      /* did the run before count the start? */
    long count[MOST_PHASES];  /* samples in a bin */
    double *sum[MOST_PHASES]; /* on the root: the sums of a bin; NULL: it has no samples yet */
    double *values;           /* on the root: [3 ncells] a field */
    int nlines;
    double *before, *now, *between; /* [nlines][cells of this rank] what is summed, at both ends of a step, inside */
    struct means_cells cells;       /* of this rank */
    double *weight_now;             /* [weights.n][cells of the largest block] */
    char file[128];                 /* file of the sums in a time folder */
};

#define PARAM_STRUCT struct phases
static const struct param phases_param[] = {
    NUMBER("period", period, USUALLY(0, "that of constant/shaking, else required"), POSITIVE, UNIT(0, 0, 1),
           "of the average"),
    NUMBER("start", start, 0, ANY_NUMBER, UNIT(0, 0, 1), "time of the first phase"),
    WHOLE("phases", n, 20, FROM_TO(1, MOST_PHASES), "of a period, at equal distances"),
};

static void phases_free(void *own) {
    struct phases *p = own;
    for (int j = 0; j < p->n; j++) free(p->sum[j]);
}

/* Returns the place of the weight of field k among the weights, which has been added; -1: it has none. */
static int weight_of(const struct function *f, int k) {
    struct means_weights known = ((const struct phases *)f->own)->weights;
    return means_weight(f, f->field[k], &known);
}

static double moment_of(const struct phases *p, double index) {
    return p->start + index * p->period / p->n;
}
/* Has t reached the target? As for all triggers, round-off of a few additions of steps is no difference. */
static bool reached(double t, double target) {
    return t >= target - 1e-12 * fabs(target);
}
/* Returns the index of the first moment after t; INFINITY: moments are too close to be told from t. */
static double next_index(const struct phases *p, double t) {
    if (!(p->period / p->n > 4e-12 * fmax(fabs(t), fabs(p->start)))) return HUGE_VAL;
    double index = fmax(0, floor((t - p->start) / p->period * p->n) - 1);
    while (reached(t, moment_of(p, index))) index += 1;
    return index;
}

static double phases_next(const struct function *f, double t) {
    const struct phases *p = f->own;
    const double index = next_index(p, t);
    return isfinite(index) ? moment_of(p, index) : HUGE_VAL;
}

static status make_bin(const struct function *f, int bin) {
    struct phases *p = f->own;
    if (!p->values) TRY(pool_take(f->pool, &p->values, 3 * p->ncells, sizeof(double), "a field of the averages"));
    return p->sum[bin] ? OK : allocate(&p->sum[bin], p->size, sizeof(double), "sums of the averages");
}

/* Computes what is summed of the present state, in the cells of this rank. */
static void evaluate(const struct function *f, double *restrict out) {
    const struct phases *p = f->own;
    const struct setup *s = f->setup;
    for (int b = 0; b < s->grid->nblocks; b++) {
        const size_t n = (size_t)s->grid->block[b].ncells;
        double *lines[3], *at = out + p->cells.first[b];
        for (int w = 0; w < p->weights.n; w++) {
            function_block(f, b, p->weights.quantity[w], lines);
            memcpy(p->weight_now + w * p->cells.largest, lines[0], n * sizeof(double));
        }
        for (int k = 0; k < f->nfields; k++) {
            const int w = weight_of(f, k);
            const double *weight = w < 0 ? NULL : p->weight_now + w * p->cells.largest;
            function_block(f, b, f->field[k], lines);
            for (int l = 0; l < setup_lines(s, f->field[k]); l++, at += p->cells.n)
                for (size_t i = 0; i < n; i++) at[i] = (weight ? weight[i] : 1) * lines[l][i];
        }
        for (int w = 0; w < p->weights.n; w++, at += p->cells.n)
            memcpy(at, p->weight_now + w * p->cells.largest, n * sizeof(double));
    }
}

/* Adds a line of this rank's cells to component c of m in a field of a bin's sums (NULL: this is not the root).
 * Collective. */
static status add_line(const struct function *f, const double *line, int c, int m, double *sum) {
    const struct phases *p = f->own;
    TRY(grid_gather(f->setup->grid, line, sum ? p->values : NULL));
    for (long i = 0; sum && i < p->ncells; i++) sum[m * i + c] += p->values[i];
    return OK;
}

/* Adds the lines of a moment to a bin. Collective. */
static status take(const struct function *f, int bin, const double *line) {
    struct phases *p = f->own;
    const struct setup *s = f->setup;
    const bool root = comm_root(s->comm);
    TRY(comm_agree(s->comm, root ? make_bin(f, bin) : OK));
    double *sum = root ? p->sum[bin] : NULL;
    for (int k = 0; k < f->nfields; k++) {
        const int m = quantity_of(f, f->field[k])->components;
        for (int l = 0; l < setup_lines(s, f->field[k]); l++, line += p->cells.n)
            TRY(add_line(f, line, m == 3 ? s->axis[l] : 0, m, sum));
        if (root) sum += p->ncells * m;
    }
    for (int w = 0; w < p->weights.n; w++, line += p->cells.n) {
        TRY(add_line(f, line, 0, 1, sum));
        if (root) sum += p->ncells;
    }
    p->count[bin]++;
    return OK;
}

/* Takes the moment of this index, which the step that ends now reaches. Collective. */
static status take_moment(const struct function *f, double index, const struct moment *before,
                          const struct moment *now) {
    const struct phases *p = f->own;
    const double at = moment_of(p, index);
    const long size = p->nlines * p->cells.n;
    if (!reached(at, now->t)) {
        const double part = (at - before->t) / (now->t - before->t);
        double *restrict between = p->between;
        for (long i = 0; i < size; i++) between[i] = fma(part, p->now[i] - p->before[i], p->before[i]);
    }
    return take(f, (int)fmod(index, p->n), reached(at, now->t) ? p->now : p->between);
}

static status phases_prepare(const struct function *f) {
    const struct phases *p = f->own;
    evaluate(f, p->before);
    return OK;
}

/* Returns the index of the first moment that may be due; a run that goes on has counted its start already. */
static double first_index(const struct phases *p, const struct moment *before, const struct moment *now) {
    if (before) return next_index(p, before->t);
    const double index = fmax(0, floor((now->t - p->start) / p->period * p->n + 0.5));
    return p->resumed || !reached(moment_of(p, index), now->t) ? HUGE_VAL : index;
}

static status phases_collect(struct function *f, const struct moment *before, const struct moment *now) {
    const struct phases *p = f->own;
    double index = first_index(p, before, now);
    if (!isfinite(index) || !reached(now->t, moment_of(p, index))) return OK;
    const double samples = (now->t - moment_of(p, index)) / p->period * p->n;
    if (samples > MOST_SAMPLES)
        return fail(
            ERR_INPUT,
            "system/controlDict: functions: %s: the step to t = %.9g s holds %.3g samples, %d are allowed: give a "
            "longer period, fewer phases, or maxDeltaT",
            f->name, now->t, samples, MOST_SAMPLES);
    evaluate(f, p->now);
    for (; reached(now->t, moment_of(p, index)); index += 1) TRY(take_moment(f, index, before, now));
    return OK;
}

/* ---- results ---- */

/* Computes the mean of field k in a bin. */
static void mean_of(const struct function *f, int bin, int k, double *out) {
    const struct phases *p = f->own;
    const double *sum = p->sum[bin], *weights = p->sum[bin] + p->size - p->weights.n * p->ncells;
    const int w = weight_of(f, k), m = quantity_of(f, f->field[k])->components;
    for (int j = 0; j < k; j++) sum += p->ncells * quantity_of(f, f->field[j])->components;
    for (long i = 0; i < p->ncells * m; i++) {
        const double by = w >= 0 ? weights[w * p->ncells + i / m] : (double)p->count[bin];
        out[i] = by > 0 ? sum[i] / by : 0;
    }
}

/* Writes the name of a bin's folder: the phase, in periods. */
static void phase_name(const struct phases *p, int bin, char name[TIME_NAME]) {
    time_name(TIME_GENERAL, 6, (double)bin / p->n, name);
}

static status write_bin(const struct function *f, int bin) {
    const struct phases *p = f->own;
    const struct setup *s = f->setup;
    char folder[2 * TIME_PATH], name[TIME_NAME];
    phase_name(p, bin, name);
    snprintf(folder, sizeof folder, "%s/postProcessing/%s/%s/%s", s->dir, f->name, s->start.name, name);
    TRY(case_make_folders(s, folder));
    const struct field_writer w = {s->mesh, &s->control->format, folder, folder + strlen(s->dir) + 1};
    for (int k = 0; k < f->nfields; k++) {
        mean_of(f, bin, k, p->values);
        TRY(output_field(s, &w, f->field[k], p->values));
    }
    return OK;
}

static status write_counts(const struct function *f, double t) {
    const struct phases *p = f->own;
    FILE *file;
    TRY(function_open(f, f->setup->start.name, "phaseAverage.dat", &file));
    fprintf(file, "# Period : %.12g s from %.12g s; samples up to %.12g s\n# Phase\tsamples\n", p->period, p->start, t);
    for (int j = 0; j < p->n; j++) {
        char name[TIME_NAME];
        phase_name(p, j, name);
        fprintf(file, "%s\t%ld\n", name, p->count[j]);
    }
    const bool wrong = ferror(file) != 0;
    return fclose(file) || wrong ? fail(ERR_SYSTEM, "phaseAverage.dat: cannot be written (disk full?)") : OK;
}

static status phases_execute(struct function *f, const struct moment *now, const char *time) {
    const struct phases *p = f->own;
    (void)time;
    status s = OK;
    const bool root = comm_root(f->setup->comm);
    for (int j = 0; root && !s && j < p->n; j++)
        if (p->count[j]) s = write_bin(f, j);
    if (root && !s) s = write_counts(f, now->t);
    return comm_agree(f->setup->comm, s);
}

/* ---- restarts ---- */

/* Prints what tells whether sums belong to the same averages, and the counts. */
static void print_identity(struct sink *o, const struct function *f) {
    const struct phases *p = f->own;
    sink_printf(o, "period          %.17g;\nstart           %.17g;\nfields          (", p->period, p->start);
    for (int k = 0; k < f->nfields; k++) sink_printf(o, " %s", quantity_of(f, f->field[k])->name);
    for (int w = 1; w < p->weights.n; w++) sink_printf(o, " %s", quantity_of(f, p->weights.quantity[w])->name);
    sink_printf(o, " );\ncounts          (");
    for (int j = 0; j < p->n; j++) sink_printf(o, " %ld", p->count[j]);
    sink_printf(o, " );\n");
}

static status save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    const struct phases *p = f->own;
    struct foam_format exact;
    struct sink *o;
    struct file_sum sum;
    TRY(means_open(w, p->file, &exact, &o));
    print_identity(o, f);
    for (int j = 0; j < p->n; j++) {
        if (!p->count[j]) continue;
        sink_printf(o, "sum%d nonuniform List<scalar> ", j);
        foam_list_write_doubles(o, &exact, 1, p->size, p->sum[j]);
        sink_printf(o, ";\n");
    }
    TRY(sink_close_sum(o, &sum));
    return checksums_add(sums, p->file, sum);
}

static status phases_save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    return comm_agree(f->setup->comm, comm_root(f->setup->comm) ? save(f, w, sums) : OK);
}

static status same_fields(const struct function *f, struct dict *d, bool *same) {
    const char *const *words;
    int n;
    TRY(dict_words(d, "fields", &n, &words));
    const struct means_weights *w = &((const struct phases *)f->own)->weights;
    *same &= n == f->nfields + (w->n > 1 ? w->n - 1 : 0);
    for (int k = 0; *same && k < n; k++) {
        const int field = k < f->nfields ? f->field[k] : w->quantity[k - f->nfields + 1];
        *same = !strcmp(words[k], quantity_of(f, field)->name);
    }
    return OK;
}

/* Goes on with saved sums if period, start, phases and fields are the same; else the averages begin anew. */
static status take_up(const struct function *f, struct dict *d) {
    struct phases *p = f->own;
    const double *counts;
    double period, start;
    int n;
    TRY(dict_number(d, "period", NULL, &period));
    TRY(dict_number(d, "start", NULL, &start));
    TRY(dict_numbers(d, "counts", &n, &counts));
    bool same = period == p->period && start == p->start && n == p->n;
    TRY(same_fields(f, d, &same));
    if (!same) {
        printf(
            "function object '%s': its period, start, phases or fields are not those of %s, the averages begin anew\n",
            f->name, dict_path(d));
        return OK;
    }
    for (int j = 0; j < n; j++) {
        if (!(counts[j] >= 0 && counts[j] < 1e15))
            return dict_fail(d, "counts", "%g is no number of samples", counts[j]);
        p->count[j] = (long)counts[j];
        char key[32];
        snprintf(key, sizeof key, "sum%d", j);
        if (p->count[j]) TRY(means_list(d, key, p->size, &p->sum[j]));
    }
    p->resumed = true;
    return OK;
}

static status load(const struct function *f) {
    const struct phases *p = f->own;
    struct dict *d = NULL;
    TRY(means_read(f, p->file, &d));
    if (!d) return OK;
    status s = take_up(f, d);
    dict_free(d);
    if (!s && !p->values) s = make_bin(f, 0);
    return s;
}

/* ---- the dictionary ---- */

/* Takes the period that is not given from constant/shaking, if the medium has that file. */
static status shaken_period(const struct function *f, struct dict *d, double *out) {
    static const signed char second[3] = {0, 0, 1}, hertz[3] = {0, 0, -1};
    const struct setup *s = f->setup;
    for (int i = 0; i < s->nfiles; i++) {
        const struct dict *shaking = s->file[i].dict;
        if (strcmp(s->file[i].name, "shaking") || !shaking || !dict_has(shaking, "frequency")) continue;
        TRY(dict_number((struct dict *)(uintptr_t)shaking, "frequency", hertz, out));
        if (*out > 0) *out = 1 / *out;
        if (*out > 0) return OK;
    }
    return status_note(dict_number(d, "period", second, out),
                       "'period' is that of the average, by default of constant/shaking");
}

static status make_lines(const struct function *f) {
    struct phases *p = f->own;
    TRY(means_cells_make(f, &p->cells));
    p->nlines = p->weights.n;
    for (int k = 0; k < f->nfields; k++) p->nlines += setup_lines(f->setup, f->field[k]);
    const long size = p->nlines * p->cells.n + 1;
    TRY(pool_take(f->pool, &p->weight_now, (p->weights.n + 1) * p->cells.largest, sizeof(double), "averages"));
    TRY(pool_take(f->pool, &p->before, size, sizeof(double), "averages"));
    TRY(pool_take(f->pool, &p->now, size, sizeof(double), "averages"));
    return pool_take(f->pool, &p->between, size, sizeof(double), "averages");
}

static status phases_make(struct function *f, struct dict *d) {
    struct phases *p = f->own;
    if (p->period == 0) TRY(shaken_period(f, d, &p->period));
    TRY(means_file(f, d, p->file));
    const int rho = means_density(f);
    p->weights = (struct means_weights){.n = rho >= 0, .quantity = {rho}};
    for (int k = 0; k < f->nfields; k++) (void)means_weight(f, f->field[k], &p->weights);
    p->ncells = f->setup->mesh->ncells;
    for (int k = 0; k < f->nfields; k++) p->size += p->ncells * quantity_of(f, f->field[k])->components;
    p->size += p->weights.n * p->ncells;
    TRY(make_lines(f));
    TRY(comm_agree(f->setup->comm, comm_root(f->setup->comm) ? load(f) : OK));
    double resumed = p->resumed;
    comm_max(f->setup->comm, &resumed, 1);
    p->resumed = resumed > 0;
    return OK;
}

const struct function_type function_phases = {
    .name = "phaseAverage",
    .about = "means at the same phases of a period: period (of constant/shaking), start (0), phases (20)",
    FUNCTION_PARAMS(phases_param),
    .size = sizeof(struct phases),
    .make = phases_make,
    .execute = phases_execute,
    .free = phases_free,
    .with_fields = true,
    .next = phases_next,
    .prepare = phases_prepare,
    .collect = phases_collect,
    .save = phases_save,
};
