/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object fieldAverage writes means over time and mean squares of fluctuations into the time folders.
 *
 * With base time they are integrals over time of the second order: fields are linear within a step (the trapezoidal
 * rule), so that each step of length dt counts with the fields at both of its ends, by dt/2 each. Of a step that
 * timeStart or timeEnd cuts, the part within counts, by the same linear fields: no step ends there, and the run keeps
 * its bits. With base iter each step that ends within counts with the fields at its end, by 1. The fields of granularMD
 * are means over the past, of which the right end is the integral; its steps end at timeStart and timeEnd.
 *
 * U and T, which are per unit mass, are weighted by rho, too (of one kind of grains by its alpha): with weights w and
 * fields f
 *
 *   fMean = sum w f / sum w,   fPrime2Mean = sum w (f - fMean)(f - fMean) / sum w
 *
 * where w contains that for them. Both are carried on by West's recursion, which does not lose small fluctuations about
 * a large mean: W += w, d = f - mean, mean += (w/W) d, squares += w (1 - w/W) d d. Each rank keeps those of its cells,
 * and the fields at the last time, which a restart has again from its state.
 */
#include "solvers/functions/functions_private.h"

#include "libcore/models/kernel.h"
#include "solvers/output/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LINES = 1 + 3 + 6 };
struct item { /* one entry of `fields` */
    int field;
    bool mean, squared; /* are they written? */
    int base;           /* 0: time, 1: iter */
    bool weighted;
    int by;                  /* place of what weighs in `weights` */
    int components, squares; /* of the mean; of the mean square: 0, 1, or 6 (xx xy xz yy yz zz) */
    double total;            /* sum of w without rho: s, or steps */
    double *weight;          /* [cells] sum of w if it is weighted; else NULL */
    double *line[MOST_LINES];
    /* [nlines][cells of this rank]: weight (if weighted), mean, squares; each is one after another of the same memory
     */
    int nlines;
    double *last[3]; /* [lines of the field][cells of this rank] its values at the last time; behind `line` */
    char mean_name[48], squared_name[48];
};
struct average {
    double start, end; /* s */
    bool weighs, afresh, output_afresh;
    struct means_weights weights;
    int n;
    struct item *item;        /* [n] */
    struct means_cells cells; /* of this rank */
    double *rho_last;         /* [weights.n][cells of this rank] what weighs */
    double *rho_now;          /* [weights.n][cells of the largest block] */
    double *part, *keep;      /* [cells of the largest block] */
    double *all, *out;        /* on the root, for writing: [lines][ncells_all], [6 ncells_all] */
    char file[128];
};

#define ANY_TIME(entry) ANY_NUMBER, .example = entry
#define PARAM_STRUCT    struct average
static const struct param average_param[] = {
    NUMBER("timeStart", start, USUALLY(-HUGE_VAL, "the start"), ANY_TIME("timeStart 1;"), UNIT(0, 0, 1),
           "from which steps count"),
    NUMBER("timeEnd", end, HUGE_VAL, ANY_TIME("timeEnd 2;"), UNIT(0, 0, 1), "to which steps count"),
    SWITCH("weighted", weighs, true,
           "are U and T, which are per unit mass, weighted by rho (U.big of a kind by alpha.big)?"),
    SWITCH("restartOnRestart", afresh, false, "does a restart begin the averages anew?"),
    SWITCH("restartOnOutput", output_afresh, false, "do they begin anew after each write?"),
    NOTED("fields", "list of dictionaries", NULL, "fields and what is wanted of each",
          "fields ( U { mean on; prime2Mean on; base time; } );"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct item
static const char *const bases[] = {"time", "iter", NULL};
static const struct param item_param[] = {
    SWITCH("mean", mean, true, "is NAMEMean written?"),
    SWITCH("prime2Mean", squared, false, "is NAMEPrime2Mean written, the mean square of the fluctuations?"),
    CHOICE("base", base, 0, bases, "what a step counts by: its length, or 1"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static void average_keywords(struct keywords *k) {
    keywords_at(k, FUNCTION_FILE, FUNCTION_DICT "/fields/FIELD", NULL);
    keywords_params(k, item_param, COUNT(item_param));
}

/* ---- steps ---- */

static double average_next(const struct function *f, double t) {
    const struct average *a = f->own;
    const double beyond = t + 2e-12 * fabs(t);
    return a->start > beyond ? a->start : a->end > beyond ? a->end : HUGE_VAL;
}

/* Computes w/W and w (1 - w/W) of n cells, whose rho is given if it weighs, and adds w to W. */
KERNEL static void weigh(int n, double w, const double *restrict rho, double *restrict sum, double *restrict part,
                         double *restrict keep) {
    for (int i = 0; i < n; i++) {
        const double own = w * rho[i], all = sum[i] + own;
        sum[i] = all;
        part[i] = all > 0 ? own / all : 0;
        keep[i] = own * (1 - part[i]);
    }
}
/* Turns values into deviations from the mean, and moves the mean. */
KERNEL static void move_mean(int n, const double *restrict part, double *restrict mean, double *restrict value) {
    for (int i = 0; i < n; i++) {
        value[i] -= mean[i];
        mean[i] += part[i] * value[i];
    }
}
KERNEL static void add_squares(int n, const double *restrict keep, const double *a, const double *b,
                               double *restrict squares) {
    for (int i = 0; i < n; i++) squares[i] += keep[i] * (a[i] * b[i]);
}

static int square_index(int x, int y) {
    static const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    return index[x][y];
}

struct ends { /* weights of the fields at both ends of a step, without rho */
    double before, now;
};
static struct ends ends_of(const struct function *f, const struct item *it, const struct moment *before,
                           const struct moment *now) {
    const struct average *a = f->own;
    const bool past = f->setup->medium->type->event_driven;
    const double dt = now->t - before->t, close = 1e-9 * dt;
    const double from = fmax(a->start - before->t, 0), to = fmin(a->end - before->t, dt), within = to - from;
    const double late = past ? 1 : 0.5 * (from + to) / dt;
    if (!(within > close)) return (struct ends){0, 0};
    if (it->base) return (struct ends){0, dt - to <= close ? 1 : 0};
    return (struct ends){within * (1 - late), within * late};
}

struct sample {    /* fields of a block at one moment */
    double weight; /* without rho */
    const double *rho;
    double *const *lines; /* they are lost */
};
/* Adds a sample of a block to an item, whose `total` contains its weight. */
static void take_sample(const struct function *f, const struct item *it, int b, const struct sample *x, double total) {
    const struct average *a = f->own;
    const struct setup *s = f->setup;
    const int n = s->grid->block[b].ncells, components = setup_lines(s, it->field);
    const long at = a->cells.first[b];
    double *const *mean = it->line + it->weighted, *const *squares = mean + it->components;
    if (!(x->weight > 0)) return;
    if (it->weighted)
        weigh(n, x->weight, x->rho, it->weight + at, a->part, a->keep);
    else
        for (int i = 0; i < n; i++) {
            a->part[i] = x->weight / total;
            a->keep[i] = x->weight * (1 - a->part[i]);
        }
    for (int k = 0; k < components; k++)
        move_mean(n, a->part, mean[it->components == 3 ? s->axis[k] : 0] + at, x->lines[k]);
    for (int k = 0; it->squares && k < components; k++)
        for (int l = 0; l <= k; l++)
            add_squares(n, a->keep, x->lines[k], x->lines[l],
                        squares[it->squares == 6 ? square_index(s->axis[k], s->axis[l]) : 0] + at);
}

/* Adds a step of a block to an item, and keeps the present fields for the next one. w: NULL at the start. */
static void take_block(const struct function *f, const struct item *it, int b, const struct ends *w) {
    const struct average *a = f->own;
    const long at = a->cells.first[b];
    const double *rho_last = a->rho_last + it->by * a->cells.n + at, *rho_now = a->rho_now + it->by * a->cells.largest;
    double *lines[3], *last[3] = {NULL};
    for (int k = 0; k < setup_lines(f->setup, it->field); k++) last[k] = it->last[k] + at;
    if (w) take_sample(f, it, b, &(struct sample){w->before, rho_last, last}, it->total + w->before);
    function_block(f, b, it->field, lines);
    for (int k = 0; k < 3 && last[k]; k++)
        memcpy(last[k], lines[k], (size_t)f->setup->grid->block[b].ncells * sizeof(double));
    if (w) take_sample(f, it, b, &(struct sample){w->now, rho_now, lines}, it->total + (w->before + w->now));
}

static status average_collect(struct function *f, const struct moment *before, const struct moment *now) {
    struct average *a = f->own;
    struct ends w;
    if (before && before->t >= a->end) return OK;
    for (int b = 0; b < f->setup->grid->nblocks; b++) {
        const size_t size = (size_t)f->setup->grid->block[b].ncells * sizeof(double);
        double *lines[3];
        for (int k = 0; k < a->weights.n; k++) {
            function_block(f, b, a->weights.quantity[k], lines);
            memcpy(a->rho_now + k * a->cells.largest, lines[0], size);
        }
        for (int i = 0; i < a->n; i++) {
            if (before) w = ends_of(f, &a->item[i], before, now);
            take_block(f, &a->item[i], b, before ? &w : NULL);
        }
        for (int k = 0; k < a->weights.n; k++)
            memcpy(a->rho_last + k * a->cells.n + a->cells.first[b], a->rho_now + k * a->cells.largest, size);
    }
    for (int i = 0; before && i < a->n; i++) {
        w = ends_of(f, &a->item[i], before, now);
        a->item[i].total += w.before + w.now;
    }
    return OK;
}

static void begin_anew(struct average *a) {
    for (int i = 0; i < a->n; i++) {
        a->item[i].total = 0;
        memset(a->item[i].line[0], 0, (size_t)(a->item[i].nlines * a->cells.n) * sizeof(double));
    }
}

static status average_execute(struct function *f, const struct moment *now, const char *time) {
    struct average *a = f->own;
    (void)now;
    (void)time;
    if (a->output_afresh) begin_anew(a);
    return OK;
}

/* ---- time folders ---- */

static status make_room(const struct function *f, struct average *a) {
    const long ncells_all = f->setup->grid->ncells_all;
    int most = 1;
    for (int i = 0; i < a->n; i++)
        if (a->item[i].nlines > most) most = a->item[i].nlines;
    if (!a->all) TRY(pool_take(f->pool, &a->all, most * ncells_all, sizeof(double), "averages to write"));
    return a->out ? OK : pool_take(f->pool, &a->out, 6 * ncells_all, sizeof(double), "averages to write");
}

static status gather_item(const struct function *f, const struct item *it) {
    struct average *a = f->own;
    const struct grid *grid = f->setup->grid;
    for (int l = 0; l < it->nlines; l++)
        TRY(grid_gather(grid, it->line[l], a->all ? a->all + (long)l * grid->ncells_all : NULL));
    return OK;
}

/* Writes one field of a gathered item: `components` lines from `first` on, divided by the weight or, as a mean is,
 * not. */
static status write_field(const struct function *f, const struct field_writer *w, const struct item *it, bool squares,
                          struct checksums *sums) {
    const struct average *a = f->own;
    const long n = f->setup->grid->ncells_all;
    const int m = squares ? it->squares : it->components, first = it->weighted + (squares ? it->components : 0);
    struct quantity q = {squares ? it->squared_name : it->mean_name, m, {0}, false};
    struct file_sum sum;
    for (int k = 0; k < 7; k++)
        q.dimensions[k] = (signed char)((squares ? 2 : 1) * quantity_of(f, it->field)->dimensions[k]);
    for (int c = 0; c < m; c++)
        for (long i = 0; i < n; i++) {
            const double by = !squares ? 1 : it->weighted ? a->all[i] : it->total;
            a->out[m * i + c] = by > 0 ? a->all[(first + c) * n + i] / by : 0;
        }
    TRY(output_values(f->setup, w, &q, a->out, &sum));
    return checksums_add(sums, q.name, sum);
}

static status write_item(const struct function *f, const struct field_writer *w, const struct item *it,
                         const struct foam_format *exact, struct sink *o, struct checksums *sums) {
    const struct average *a = f->own;
    sink_printf(o, "%s\n{\n    total %.17g;\n    lines nonuniform List<scalar> ", quantity_of(f, it->field)->name,
                it->total);
    foam_list_write_doubles(o, exact, 1, (long)it->nlines * f->setup->grid->ncells_all, a->all);
    sink_printf(o, ";\n}\n");
    if (it->mean) TRY(write_field(f, w, it, false, sums));
    return it->squared ? write_field(f, w, it, true, sums) : OK;
}

/* Prints what tells whether sums belong to the same averages. */
static void print_identity(struct sink *o, const struct function *f) {
    const struct average *a = f->own;
    sink_printf(o, "averages        (");
    for (int i = 0; i < a->n; i++)
        sink_printf(o, " %s-%s-%d-%s", quantity_of(f, a->item[i].field)->name, bases[a->item[i].base],
                    a->item[i].squares, a->item[i].weighted ? "weighted" : "plain");
    sink_printf(o, " );\n");
}

static bool has_samples(const struct average *a) {
    bool any = false;
    for (int i = 0; i < a->n; i++) any |= a->item[i].total > 0;
    return any;
}

/* Writes means, and the sums from which a restart goes on. Each rank takes part in each gather, even if the root cannot
 * write. */
static status average_save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    struct average *a = f->own;
    const struct setup *s = f->setup;
    const bool root = comm_root(s->comm);
    struct foam_format exact;
    struct sink *o = NULL;
    struct file_sum sum;
    if (!has_samples(a)) return OK;
    status e = root ? make_room(f, a) : OK;
    if (root && !e) e = means_open(w, a->file, &exact, &o);
    TRY(comm_agree(s->comm, e));
    if (root) print_identity(o, f);
    for (int i = 0; i < a->n; i++) {
        const status gathered = gather_item(f, &a->item[i]);
        if (root && !e && !gathered) e = write_item(f, w, &a->item[i], &exact, o, sums);
        if (gathered && e) status_free(gathered);
        if (gathered && !e) e = gathered;
    }
    const status closed = root ? sink_close_sum(o, &sum) : OK;
    if (closed && e) status_free(closed);
    if (!e) e = closed;
    if (root && !e) e = checksums_add(sums, a->file, sum);
    return comm_agree(s->comm, e);
}

/* ---- restarts ---- */

static bool same_averages(const struct function *f, int n, const char *const *words) {
    const struct average *a = f->own;
    bool same = n == a->n;
    for (int i = 0; same && i < n; i++) {
        char text[128];
        snprintf(text, sizeof text, "%s-%s-%d-%s", quantity_of(f, a->item[i].field)->name, bases[a->item[i].base],
                 a->item[i].squares, a->item[i].weighted ? "weighted" : "plain");
        same = !strcmp(text, words[i]);
    }
    return same;
}

/* Reads the sums of an item on the root, and hands each rank those of its cells. Collective; d is NULL on the other
 * ranks. */
static status take_item(const struct function *f, struct dict *d, struct item *it) {
    const struct average *a = f->own;
    const struct grid *grid = f->setup->grid;
    const long n = grid->ncells_all;
    struct dict *own = NULL;
    double *all = NULL;
    status e = d ? dict_sub(d, quantity_of(f, it->field)->name, &own) : OK;
    if (d && !e) e = dict_number(own, "total", NULL, &it->total);
    if (d && !e && !(it->total >= 0 && it->total < HUGE_VAL))
        e = dict_fail(own, "total", "a sum of weights is not below 0");
    if (d && !e) e = means_list(own, "lines", it->nlines * n, &all);
    if (!d) e = allocate(&all, it->nlines * n, sizeof(double), "averages");
    e = comm_agree(f->setup->comm, e);
    if (!e) comm_broadcast(f->setup->comm, &it->total, sizeof it->total);
    if (!e) comm_broadcast(f->setup->comm, all, (long)sizeof(double) * it->nlines * n);
    for (int l = 0; !e && l < it->nlines; l++)
        for (int b = 0; b < grid->nblocks; b++)
            for (int i = 0; i < grid->block[b].ncells; i++)
                it->line[l][a->cells.first[b] + i] = all[l * n + grid->block[b].cell[i]];
    free(all);
    return e;
}

/* Finds the saved sums on the root; *d = NULL: there are none, or they are not those of these averages. */
static status find_sums(const struct function *f, struct dict **d) {
    const struct average *a = f->own;
    const char *const *words;
    int n;
    TRY(means_read(f, a->file, d));
    if (!*d) return OK;
    TRY(dict_words(*d, "averages", &n, &words));
    if (same_averages(f, n, words)) return OK;
    printf("function object '%s': its fields or their settings are not those of %s, the averages begin anew\n", f->name,
           dict_path(*d));
    dict_free(*d);
    *d = NULL;
    return OK;
}

static status load(const struct function *f) {
    struct average *a = f->own;
    const struct comm *comm = f->setup->comm;
    struct dict *d = NULL;
    status e = comm_agree(comm, comm_root(comm) ? find_sums(f, &d) : OK);
    double found = d != NULL;
    if (!e) comm_max(comm, &found, 1);
    for (int i = 0; !e && found > 0 && i < a->n; i++) e = take_item(f, d, &a->item[i]);
    dict_free(d);
    return e;
}

/* ---- the dictionary ---- */

/* Two objects that write the same file would overwrite each other's. */
static status check_other(const struct function *f, struct dict *d, const char *key) {
    for (int i = 0; i < f->nearlier; i++) {
        const struct function *other = &f->earlier[i];
        const struct average *a = other->type == f->type ? other->own : NULL;
        for (int k = 0; a && k < a->n; k++)
            if (!strcmp(quantity_of(f, a->item[k].field)->name, key))
                return dict_fail(d, key, "'%s' averages it already, and %sMean can be there once only", other->name,
                                 key);
    }
    return OK;
}

static status make_item(struct function *f, struct dict *fields, const char *key, struct item *it) {
    struct average *a = f->own;
    struct dict *d;
    TRY(function_field(f, fields, key, key, &it->field));
    TRY(check_other(f, fields, key));
    TRY(dict_sub(fields, key, &d));
    TRY(params_read(d, item_param, COUNT(item_param), it));
    if (!it->mean && !it->squared) return dict_fail(fields, key, "neither mean nor prime2Mean is on");
    it->components = quantity_of(f, it->field)->components;
    it->squares = !it->squared ? 0 : it->components == 3 ? 6 : 1;
    const int by = a->weighs ? means_weight(f, it->field, &a->weights) : -1;
    it->weighted = by >= 0;
    it->by = by >= 0 ? by : 0;
    it->nlines = it->weighted + it->components + it->squares;
    snprintf(it->mean_name, sizeof it->mean_name, "%.30sMean", key);
    snprintf(it->squared_name, sizeof it->squared_name, "%.30sPrime2Mean", key);
    TRY(pool_take(f->pool, &it->line[0], (it->nlines + 3) * a->cells.n + 1, sizeof(double), "averages"));
    for (int l = 1; l < it->nlines; l++) it->line[l] = it->line[0] + l * a->cells.n;
    for (int k = 0; k < 3; k++) it->last[k] = it->line[0] + (it->nlines + k) * a->cells.n;
    it->weight = it->weighted ? it->line[0] : NULL;
    return OK;
}

static status make_memory(const struct function *f) {
    struct average *a = f->own;
    TRY(pool_take(f->pool, &a->rho_last, a->weights.n * a->cells.n + 1, sizeof(double), "averages"));
    TRY(pool_take(f->pool, &a->rho_now, (a->weights.n + 1) * a->cells.largest, sizeof(double), "averages"));
    TRY(pool_take(f->pool, &a->part, a->cells.largest, sizeof(double), "averages"));
    return pool_take(f->pool, &a->keep, a->cells.largest, sizeof(double), "averages");
}

static status average_make(struct function *f, struct dict *d) {
    struct dict *fields;
    struct average *a = f->own;
    if (a->end <= a->start) return dict_fail(d, "timeEnd", "it is not behind timeStart");
    if (!f->trigger.with_fields)
        return dict_fail(d, "writeControl", "means stand in the time folders of the fields: leave it out");
    TRY(means_file(f, d, a->file));
    TRY(status_note(dict_sub(d, "fields", &fields),
                    "'fields' of fieldAverage says what is wanted of each: ( U { mean on; prime2Mean on; } )"));
    TRY(means_cells_make(f, &a->cells));
    const int n = dict_count(fields);
    if (!n) return dict_fail(d, "fields", "it is empty");
    TRY(pool_take(f->pool, &a->item, n, sizeof *a->item, "averages"));
    status e = OK;
    for (int i = 0; !e && i < n; i++) {
        a->n = i + 1;
        e = make_item(f, fields, dict_key(fields, i), &a->item[i]);
    }
    TRY(comm_agree(f->setup->comm, e));
    TRY(make_memory(f));
    return a->afresh || a->output_afresh ? OK : load(f);
}

const struct function_type function_average = {
    .name = "fieldAverage",
    .about = "means over time, and of squared fluctuations, in the time folders: UMean, UPrime2Mean, ..",
    FUNCTION_PARAMS(average_param),
    .size = sizeof(struct average),
    .keywords = average_keywords,
    .make = average_make,
    .execute = average_execute,
    .no_fields = true,
    .with_fields = true,
    .next = average_next,
    .collect = average_collect,
    .save = average_save,
};
