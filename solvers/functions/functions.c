/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the function objects of controlDict, executes those that are due, and opens their files. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct functions {
    struct pool pool;
    int n;
    struct function *all;
};

/* Every type of function object: its own file exports its row. */
extern const struct function_type function_probes, function_sets, function_extremes, function_integral, function_vtk,
    function_budget, function_phases, function_average, function_forces, function_coefficients, function_surface_value,
    function_objects, function_surfaces, function_image;
static const struct function_type *const function_table[] = {
    &function_probes,        &function_sets,    &function_extremes, &function_integral, &function_vtk,
    &function_budget,        &function_phases,  &function_average,  &function_forces,   &function_coefficients,
    &function_surface_value, &function_objects, &function_surfaces, &function_image,
};
enum { TYPES = sizeof function_table / sizeof *function_table };

int quantity_named(const struct offered *m, const char *name) {
    for (int k = 0; k < m->noffered; k++)
        if (!strcmp(m->quantity[k].name, name)) return k;
    return -1;
}

const struct quantity *quantity_of(const struct function *f, int field) {
    return &f->setup->medium->fields.quantity[field];
}

static bool fits(const struct function_type *t, const struct medium_type *m) {
    return !t->of_patches || m->follow;
}

void functions_list(const struct medium_type *m, FILE *f) {
    for (int i = 0; i < TYPES; i++)
        if (fits(function_table[i], m)) fprintf(f, "  %-17s %s\n", function_table[i]->name, function_table[i]->about);
    fprintf(f, "  fields:");
    for (int i = 0; i < m->fields.noffered; i++) fprintf(f, " %s", m->fields.quantity[i].name);
    fprintf(f, "\n");
}

#define PARAM_STRUCT struct function
static const struct param any_param[] = {
    SWITCH("enabled", enabled, true, "is it executed? If not, nothing of it is read"),
    SWITCH("log", log, false, "are results printed, too?"),
    IGNORED("libs", "for OpenFOAM"),
    IGNORED("functionObjectLibs", "for OpenFOAM"),
    IGNORED("writeFields", "for OpenFOAM"),
    IGNORED("region", "for OpenFOAM"),
    IGNORED("executeControl", "for OpenFOAM: writeControl says when"),
    IGNORED("executeInterval", "for OpenFOAM: writeInterval says when"),
    IGNORED("executeAtStart", "for OpenFOAM"),
    IGNORED("writeAtEnd", "for OpenFOAM"),
    IGNORED("errors", "for OpenFOAM"),
    IGNORED("useUserTime", "for OpenFOAM"),
};
/* Of types without averages, which have their own timeStart and timeEnd, or none. */
static const struct param window_param[] = {
    NUMBER("timeStart", start, USUALLY(-HUGE_VAL, "the start"), ANY_NUMBER, UNIT(0, 0, 1),
           "time from which it writes; fieldAverage: from which steps count"),
    NUMBER("timeEnd", end, HUGE_VAL, ANY_NUMBER, UNIT(0, 0, 1), "time to which it writes, or steps count"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

/* The word of a type, with a whole function object of that type; fields: the entry for those that it takes. */
static void type_word(struct keywords *k, const struct function_type *t, const char *fields) {
    char entry[KEYWORD_TEXT];
    snprintf(entry, sizeof entry, "type %s;%s%s", t->name, t->no_fields ? "" : " ", t->no_fields ? "" : fields);
    keywords_entries(entry, t->param, t->nparam);
    keywords_word(k, "type", t->name, t->about, entry);
}

void functions_keywords(struct keywords *k, const struct medium_type *m) {
    char type[KEYWORD_TEXT] = "list of words", entry[80];
    for (int i = 0; i < m->fields.noffered; i++)
        snprintf(type + strlen(type), sizeof type - strlen(type), "%s%s", i ? ", " : ": ", m->fields.quantity[i].name);
    snprintf(entry, sizeof entry, "fields (%s U);", m->fields.quantity[0].name);
    const struct param first[] = {
        NOTED("type", "word", NULL, "what it does", "type probes;"),
        NOTED("fields", type, "required, but for some types; vtk: all that are shown", "fields that it takes", entry),
    };
    keywords_at(k, FUNCTION_FILE, FUNCTION_DICT, NULL);
    keywords_params(k, first, 1);
    for (int i = 0; i < TYPES; i++)
        if (fits(function_table[i], m)) type_word(k, function_table[i], entry);
    keywords_params(k, first + 1, 1);
    trigger_keywords(k);
    keywords_params(k, any_param, COUNT(any_param));
    keywords_params(k, window_param, COUNT(window_param));
    for (int i = 0; i < TYPES; i++) {
        if (!fits(function_table[i], m)) continue;
        keywords_at(k, FUNCTION_FILE, FUNCTION_DICT, function_table[i]->name);
        keywords_params(k, function_table[i]->param, function_table[i]->nparam);
        if (function_table[i]->keywords) function_table[i]->keywords(k);
    }
}

/* Prints the names of all fields. */
static void list_fields(const struct offered *m, char known[256]) {
    *known = 0;
    for (int k = 0; k < m->noffered; k++)
        snprintf(known + strlen(known), 256 - strlen(known), "%s%s", k ? " " : "", m->quantity[k].name);
}

status function_take(struct function *f, const struct dict *d, const char *key, int quantity) {
    const struct medium *m = f->setup->medium;
    const char *reason = m->type->lacks ? m->type->lacks(m, quantity) : NULL;
    if (reason) return dict_fail(d, key, "there is no field '%s' here: %s", m->fields.quantity[quantity].name, reason);
    f->takes[quantity] = true;
    return OK;
}

status function_field(struct function *f, const struct dict *d, const char *key, const char *word, int *out) {
    const struct offered *m = &f->setup->medium->fields;
    const char *names[MAX_QUANTITIES];
    char known[256];
    char meant[MEANT];
    *out = quantity_named(m, word);
    if (*out >= 0) return function_take(f, d, key, *out);
    for (int k = 0; k < m->noffered; k++) names[k] = m->quantity[k].name;
    list_fields(m, known);
    return dict_fail(d, key, "there is no field '%s'; known are %s%s", word, known,
                     name_question(word, names, m->noffered, meant));
}

status function_fields(struct function *f, struct dict *d, const char *key) {
    const char *const *words;
    char known[256];
    int n;
    list_fields(&f->setup->medium->fields, known);
    TRY(status_note(dict_words(d, key, &n, &words), "'%s' lists some of %s", key, known));
    for (int i = 0; i < n; i++) {
        int k;
        TRY(function_field(f, d, key, words[i], &k));
        for (int j = 0; j < f->nfields; j++)
            if (f->field[j] == k) return dict_fail(d, key, "'%s' is listed twice", words[i]);
        f->field[f->nfields++] = k;
    }
    return n ? OK : dict_fail(d, key, "it is empty; known are %s", known);
}

static status read_fields(struct function *f, struct dict *d) {
    const struct offered *m = &f->setup->medium->fields;
    for (const int *q = m->shown; f->type->all_fields && !dict_has(d, "fields") && *q >= 0; q++)
        f->field[f->nfields++] = *q;
    return f->nfields ? OK : function_fields(f, d, "fields");
}

/* Warns of a function object whose first output lies behind the end. */
static status check_late(const struct function *f, const struct dict *d) {
    struct setup *s = (struct setup *)(uintptr_t)f->setup;
    const struct control *c = s->control;
    char instead[40];
    if (c->stop_at != STOP_END_TIME || s->start.step > 0 || !trigger_late(&f->trigger, s->start.t, c->end_time))
        return OK;
    const int line = dict_line(d, "writeInterval");
    snprintf(instead, sizeof instead, "%.3g", (c->end_time - s->start.t) / 10);
    warn_cure(&s->warnings, WARN_NOTHING_WRITTEN, CURE_VALUE, dict_path(d), line, "writeInterval", instead);
    return warn(&s->warnings, WARN_NOTHING_WRITTEN,
                "%s:%d: function object '%s': writeInterval %g reaches beyond endTime %g: it writes nothing behind the "
                "start; say for example  writeInterval %s;",
                dict_path(d), line, f->name, f->trigger.interval, c->end_time, instead);
}

static status make_one(struct function *f, struct dict *d) {
    const char *names[TYPES];
    int index;
    long largest = 1;
    for (int i = 0; i < TYPES; i++) names[i] = function_table[i]->name;
    TRY(dict_choice(d, "type", names, TYPES, &index));
    f->type = function_table[index];
    if (!fits(f->type, f->setup->medium->type))
        return dict_fail(d, "type", "%s does not know what leaves it through patches; granularGas does",
                         f->setup->medium->type->application);
    TRY(params_read(d, any_param, COUNT(any_param), f));
    f->start = -HUGE_VAL;
    f->end = HUGE_VAL;
    if (!f->type->collect && !f->type->save) TRY(params_read(d, window_param, COUNT(window_param), f));
    const struct trigger standard = {f->type->with_fields ? WRITE_NONE : WRITE_TIME_STEP, 1, f->type->with_fields};
    TRY(trigger_read(d, &standard, true, &f->trigger));
    TRY(check_late(f, d));
    if (!f->type->no_fields) TRY(read_fields(f, d));
    if (f->type->size) TRY(pool_take(f->pool, &f->own, 1, f->type->size, f->type->name));
    if (f->type->nparam) TRY(params_read(d, f->type->param, f->type->nparam, f->own));
    if (f->type->make) TRY(f->type->make(f, d));
    for (int b = 0; b < f->setup->grid->nblocks; b++)
        if (f->setup->grid->block[b].ncells > largest) largest = f->setup->grid->block[b].ncells;
    return pool_take(f->pool, &f->block_values, 3 * largest, sizeof(double), "a block's field");
}

status function_name(struct dict *d, const char *name) {
    enum { LONGEST = sizeof((struct function *)0)->name - 1 };
    if (!*name || strchr(name, '/') || *name == '.')
        return dict_fail(d, name, "the name of a file or a folder below postProcessing/: no '/' and no '.' in front");
    if (strlen(name) > LONGEST) return dict_fail(d, name, "longer than %d letters", (int)LONGEST);
    return OK;
}

status functions_make(const struct setup *s, struct functions **out) {
    struct functions *f = NULL;
    struct dict *all = s->control->functions, *one;
    *out = NULL;
    TRY(allocate(&f, 1, sizeof *f, "function objects"));
    status e =
        all && dict_count(all) ? pool_take(&f->pool, &f->all, dict_count(all), sizeof *f->all, "function objects") : OK;
    for (int i = 0; !e && all && i < dict_count(all); i++) {
        struct function *g = &f->all[f->n];
        const char *name = dict_key(all, i);
        e = dict_sub(all, name, &one);
        if (!e) e = function_name(all, name);
        if (!e) e = params_read(one, any_param, 1, g); /* enabled */
        if (!e && !g->enabled) {
            dict_mark_used(one);
            continue;
        }
        g->setup = s;
        g->pool = &f->pool;
        g->last = -HUGE_VAL;
        g->earlier = f->all;
        g->nearlier = f->n;
        snprintf(g->name, sizeof g->name, "%s", name);
        f->n++;
        if (!e) e = status_note(make_one(g, one), "function object '%s'", name);
    }
    e = comm_agree(s->comm, e);
    if (e) {
        functions_free(f);
        return e;
    }
    *out = f;
    return OK;
}

void functions_free(struct functions *f) {
    if (!f) return;
    for (int i = 0; i < f->n; i++) {
        struct function *g = &f->all[i];
        if (g->own && g->type->free) g->type->free(g->own);
        for (int k = 0; k < MAX_QUANTITIES; k++)
            if (g->table[k]) fclose(g->table[k]);
    }
    pool_free(&f->pool);
    free(f);
}

/* Makes the fields ready that a function object takes. */
static status make_ready(const struct function *f) {
    struct medium *m = f->setup->medium;
    for (int k = 0; k < m->fields.noffered && m->type->derive; k++)
        if (f->takes[k]) TRY(m->type->derive(m, k));
    return OK;
}

/* Makes them ready and lets it take in the end of a step, or write results. */
static status collect(struct function *f, const struct moment *before, const struct moment *now) {
    TRY(make_ready(f));
    return f->type->collect(f, before, now);
}
static status execute(struct function *f, const struct moment *now, const char *name) {
    TRY(make_ready(f));
    return f->type->execute ? f->type->execute(f, now, name) : OK;
}

double functions_next(const struct functions *f, double t) {
    double next = HUGE_VAL;
    for (int i = 0; i < f->n; i++) {
        const struct function *one = &f->all[i];
        next = fmin(next, trigger_next(&one->trigger, t));
        if (one->type->next && one->setup->medium->type->event_driven) next = fmin(next, one->type->next(one, t));
    }
    return next;
}

status functions_prepare(const struct functions *f, double t, double end) {
    for (int i = 0; i < f->n; i++) {
        const struct function *one = &f->all[i];
        if (!one->type->prepare || one->setup->medium->type->event_driven || one->type->next(one, t) > end) continue;
        TRY(make_ready(one));
        TRY(status_note(one->type->prepare(one), "function object '%s'", one->name));
    }
    return OK;
}

status functions_collect(struct functions *f, const struct moment *before, const struct moment *now) {
    for (int i = 0; i < f->n; i++)
        if (f->all[i].type->collect)
            TRY(status_note(collect(&f->all[i], before, now), "function object '%s'", f->all[i].name));
    return OK;
}

status functions_save(const struct functions *f, const struct field_writer *w, struct checksums *sums) {
    for (int i = 0; i < f->n; i++)
        if (f->all[i].type->save) TRY(f->all[i].type->save(&f->all[i], w, sums));
    return OK;
}

status functions_execute(struct functions *f, const struct moment *before, const struct moment *now, const char *name) {
    for (int i = 0; i < f->n; i++) {
        struct function *one = &f->all[i];
        if (before && !trigger_due(&one->trigger, before, now)) continue;
        const double slack = 1e-12 * fabs(now->t); /* as in control.c: round-off of a few additions of steps */
        if (now->t < one->start - slack || now->t > one->end + slack) continue;
        TRY(status_note(execute(one, now, name), "function object '%s'", one->name));
    }
    return OK;
}

bool functions_read_times(const struct functions *f) {
    bool any = false;
    for (int i = 0; i < f->n; i++) any |= f->all[i].type->reads_times;
    return any;
}

void function_block(const struct function *f, int block, int field, double *lines[3]) {
    for (int c = 0; c < 3; c++) lines[c] = f->block_values + (long)c * f->setup->grid->block[block].ncells;
    f->setup->medium->type->block(f->setup->medium, block, field, lines);
}

int function_values(const struct function *f, int block, int field, double *lines[3]) {
    const struct medium *m = f->setup->medium;
    for (int c = 0; c < 3; c++) lines[c] = f->block_values + c;
    if (m->type->uniform && m->type->uniform(m, block, field, f->block_values)) return 1;
    function_block(f, block, field, lines);
    return f->setup->grid->block[block].ncells;
}

status function_open(const struct function *f, const char *folder, const char *file, FILE **out) {
    return case_table(f->setup, f->name, folder, file, out);
}

status function_row(struct function *f, int i, double t, FILE **out) {
    const struct function_type *type = f->type;
    *out = NULL;
    if (!comm_root(f->setup->comm)) return OK;
    if (!f->table[i]) {
        const char *file = type->table[0] ? type->table[i] : quantity_of(f, f->field[i])->name;
        TRY(function_open(f, f->setup->start.name, file, &f->table[i]));
        if (type->head) type->head(f, i, f->table[i]);
    }
    *out = f->table[i];
    fprintf(*out, "%-*.12g", type->width, t);
    return OK;
}

void function_value(FILE *o, char blank, int digits, int components, const double *v) {
    if (!o) return;
    if (components == 3)
        fprintf(o, "%c(%.*g %.*g %.*g)", blank, digits, v[0], digits, v[1], digits, v[2]);
    else
        fprintf(o, "%c%.*g", blank, digits, *v);
}

status function_end_row(const struct function *f, FILE *o) {
    return o ? case_end_row(f->name, o) : OK;
}

bool function_again(struct function *f, double t) {
    const bool again = t == f->last;
    f->last = t;
    return again;
}
