/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads controlDict and chooses time steps, write times and the end of a run from it (control.h). */
#include "solvers/case/control.h"

#include "solvers/dict/params.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

enum { PATH = 4096 };
#define COUNT(table) ((int)(sizeof table / sizeof *table))

static const char *const starts[] = {"firstTime", "startTime", "latestTime", NULL};
static const char *const stops[] = {"endTime", "writeNow", "noWriteNow", "nextWrite", NULL};
static const char *const formats[] = {"ascii", "binary", NULL};
static const char *const times[] = {"general", "fixed", "scientific", NULL};
static const char *const errors[] = {"abort", "write", NULL};
static const char *const tables[] = {"printedSteps", "everyStep", "none", NULL};
static const char *const corrupt[] = {"stop", "previous", NULL};
static const char *const zips[] = {"off", "on", "no", "yes",          "false",      "true", "n",
                                   "y",   "f",  "t",  "uncompressed", "compressed", NULL};

#define PARAM_STRUCT struct control
const struct param control_table[] = {
    NOTED("application", "word: granularGas, granularMD, granularDEM, granularSegregation", "the program that runs",
          "whose case it is: the others refuse it", "application granularGas;"),
    NOTED("haffVersion", "version: 0.3, 0.3.0", "none: as these programs",
          "version of haff that the case was written for: a newer one is refused, and where an entry that is left out "
          "meant another thing there, the warning olderVersion says so",
          "haffVersion 0.3;"),
    CHOICE("startFrom", start_from, START_LATEST, starts,
           "time folder to start from; startTime: that of the keyword startTime"),
    NUMBER("startTime", start_time, 0, ANY_NUMBER, UNIT(0, 0, 1), "time to start from, with startFrom startTime"),
    CHOICE("stopAt", stop_at, STOP_END_TIME, stops,
           "when to stop: at endTime, now, now without a write, at the next write; a running program follows"),
    NUMBER("endTime", end_time, USUALLY(HUGE_VAL, "required with stopAt endTime"), FROM_TO(-HUGE_VAL, HUGE_VAL),
           UNIT(0, 0, 1), "time to stop at"),
    SWITCH("adjustTimeStep", adjust, true, "are steps as long as maxCo allows? no: all are deltaT"),
    NUMBER("maxCo", max_co, 1, FROM_TO(1e-6, 6), NO_UNIT, "largest Courant number; timeScheme says what it allows"),
    NUMBER("deltaT", delta_t, USUALLY(HUGE_VAL, "required with adjustTimeStep no"), POSITIVE, UNIT(0, 0, 1),
           "of all steps with adjustTimeStep no, else the longest that the first may be"),
    NUMBER("maxDeltaT", max_delta_t, HUGE_VAL, POSITIVE, UNIT(0, 0, 1),
           "largest time step; with adjustTimeStep no it does not count"),
    NUMBER("minDeltaT", min_delta_t, 0, FROM_TO(0, HUGE_VAL), UNIT(0, 0, 1),
           "a smaller step than this (not one that hits a write time) ends the run"),
    WHOLE("purgeWrite", purge, 0, FROM_TO(0, 1e9), "written times to keep (0: all)"),
    EITHER("writeFormat", format.binary, false, formats, "of the fields"),
    WHOLE("writePrecision", format.precision, 6, FROM_TO(1, 17), "digits of ascii numbers"),
    EITHER("writeCompression", format.compress, false, zips, "are files gzipped?"),
    CHOICE("timeFormat", time_format, TIME_GENERAL, times, "of the names of time folders"),
    WHOLE("timePrecision", time_precision, 6, FROM_TO(1, 17), "digits of time names"),
    SWITCH("writeProcessors", write_processors, false,
           "are fields written to processorN folders, too, as decomposePar does?"),
    SWITCH("runTimeModifiable", modifiable, true, "is this file read again when it changes?"),
    WHOLE("logInterval", log_interval, 0, FROM_TO(0, 1e9), "steps between log entries (0: about one a second)"),
    CHOICE("runTable", run_table, TABLE_PRINTED, tables,
           "rows of postProcessing/run/START/run.dat, the log as a table: a row for each entry of the log, for each "
           "step, or no table"),
    SWITCH("runTableParts", run_table_parts, false, "has run.dat a column of seconds for each part of the steps, too?"),
    EITHER("onError", write_on_error, true, errors, "what becomes of the last good state when the run fails"),
    EITHER("onCorruptTime", previous_if_corrupt, false, corrupt,
           "if the time to start from is damaged: end, or start from the time before"),
    NOTED("acceptWarnings", "list of words", "()", "warnings that are no errors with the option -strict",
          "acceptWarnings (fewGrains);"),
    NOTED("functions", "dictionary", "none", "function objects by their names, which are yours",
          "functions { p1 { type probes; fields (alpha); probeLocations ((0.01 0.02 0)); } }"),
    IGNORED("libs", "for OpenFOAM: nothing is loaded at run time"),
    IGNORED("graphFormat", "for OpenFOAM"),
    IGNORED("cycleWrite", "for OpenFOAM: purgeWrite says how many times are kept"),
    IGNORED("secondaryWriteControl", "for OpenFOAM"),
    IGNORED("secondaryWriteInterval", "for OpenFOAM"),
    IGNORED("secondaryPurgeWrite", "for OpenFOAM"),
    IGNORED("maxAlphaCo", "for OpenFOAM: maxCo counts"),
    IGNORED("maxDi", "for OpenFOAM: the time scheme knows how far diffusion lets a step go"),
    IGNORED("maxDeltaTFact", "for OpenFOAM"),
    IGNORED("beginTime", "for OpenFOAM"),
    IGNORED("userTime", "for OpenFOAM: times are in the unit of the case"),
    IGNORED("solver", "for OpenFOAM: `application` says the program"),
    IGNORED("subSolvers", "for OpenFOAM"),
    IGNORED("fileHandler", "for OpenFOAM"),
    IGNORED("writeVersion", "for OpenFOAM"),
    IGNORED("printExecutionFormat", "for OpenFOAM"),
    IGNORED("profiling", "for OpenFOAM"),
    IGNORED("DimensionedConstants", "for OpenFOAM"),
    IGNORED("DebugSwitches", "for OpenFOAM"),
    IGNORED("InfoSwitches", "for OpenFOAM"),
    IGNORED("OptimisationSwitches", "for OpenFOAM"),
};
const int control_table_size = COUNT(control_table);

static const signed char seconds[3] = UNIT(0, 0, 1);

static status interval_read(struct dict *d, struct trigger *g) {
    if (g->control == WRITE_NONE || g->with_fields) {
        (void)dict_has(d, "writeInterval");
        return OK;
    }
    if (g->control == WRITE_TIME_STEP && !dict_has(d, "writeInterval")) {
        g->interval = 1;
        return OK;
    }
    TRY(dict_number(d, "writeInterval", g->control == WRITE_TIME_STEP ? NULL : seconds, &g->interval));
    if (!(g->interval > 0)) return dict_fail(d, "writeInterval", "it must be greater than 0");
    if (g->control == WRITE_TIME_STEP && (g->interval != floor(g->interval) || g->interval > 1e15))
        return dict_fail(d, "writeInterval", "with writeControl timeStep it is a whole number of steps");
    return OK;
}

enum { WITH_FIELDS = 7 }; /* the first word for which output goes with the fields */
struct write_word {
    int index;
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct write_word
static const char *const own_times[] = {"timeStep",  "runTime", "adjustableRunTime", "cpuTime",
                                        "clockTime", "none",    "adjustable",        NULL};
static const char *const any_times[] = {"timeStep", "runTime",    "adjustableRunTime", "cpuTime",    "clockTime",
                                        "none",     "adjustable", "writeTime",         "outputTime", NULL};
#define INTERVAL                                                                                                       \
    NOTED("writeInterval", "number: steps with timeStep, else s", "required; 1 with timeStep",                         \
          "what lies between two writes", "writeInterval 10;")
static const struct param fields_trigger[] = {
    CHOICE("writeControl", index, USUALLY(0, "required"), own_times,
           "what writeInterval counts: steps, time of the run (adjustable: steps end on it), of processor or clock"),
    INTERVAL,
};
static const struct param function_trigger[] = {
    CHOICE("writeControl", index, USUALLY(0, "that of the type"), any_times,
           "what writeInterval counts, as for the fields; writeTime: whenever fields are written"),
    INTERVAL,
    NOTED("outputControl", "as writeControl", "none", "older name of writeControl", "outputControl timeStep;"),
    NOTED("outputInterval", "as writeInterval", "none", "older name of writeInterval", "outputInterval 10;"),
};

/* Takes OpenFOAM's names of before 2.4, which count where the others are not given. */
static void take_old_names(struct dict *d) {
    if (dict_has(d, "outputControl")) dict_rename(d, "outputControl", "writeControl");
    if (dict_has(d, "outputInterval")) dict_rename(d, "outputInterval", "writeInterval");
}

status trigger_read(struct dict *d, const struct trigger *standard, bool fields_allowed, struct trigger *out) {
    static const enum write_control kinds[] = {WRITE_TIME_STEP,  WRITE_RUN_TIME, WRITE_ADJUSTABLE, WRITE_CPU_TIME,
                                               WRITE_CLOCK_TIME, WRITE_NONE,     WRITE_ADJUSTABLE};
    struct write_word word;
    *out = *standard;
    if (fields_allowed) take_old_names(d);
    if (!dict_has(d, "writeControl") && !dict_has(d, "writeInterval")) return OK;
    TRY(params_read(d, fields_allowed ? function_trigger : fields_trigger, COUNT(fields_trigger), &word));
    out->with_fields = word.index >= WITH_FIELDS;
    out->control = out->with_fields ? WRITE_NONE : kinds[word.index];
    return interval_read(d, out);
}

void control_keywords(struct keywords *k) {
    char entry[KEYWORD_TEXT];
    keywords_at(k, "system/controlDict", "", NULL);
    for (int i = 0; i < control_table_size; i++) {
        const char *name = control_table[i].name;
        if (!strcmp(name, "purgeWrite")) keywords_params(k, fields_trigger, COUNT(fields_trigger));
        keywords_params(k, &control_table[i], 1);
        for (int w = 0; w < WARNINGS && !strcmp(name, "acceptWarnings"); w++) {
            snprintf(entry, sizeof entry, "%s (%s);", name, warning_names[w]);
            keywords_word(k, name, warning_names[w], warning_meanings[w], entry);
        }
    }
}
void trigger_keywords(struct keywords *k) {
    keywords_params(k, function_trigger, COUNT(function_trigger));
}

static status together(struct dict *d, const struct control *c) {
    if (c->stop_at == STOP_END_TIME && !dict_has(d, "endTime"))
        return dict_missing(d, "endTime", "add  endTime <seconds>;  or another stopAt");
    if (!c->adjust && !dict_has(d, "deltaT"))
        return dict_fail(d, "adjustTimeStep", "then the time step must be given: add  deltaT <seconds>;");
    if (c->start_from == START_TIME && dict_has(d, "endTime") && c->end_time < c->start_time)
        return dict_fail(d, "endTime", "it lies before startTime %g", c->start_time);
    if (c->adjust && c->min_delta_t > c->max_delta_t)
        return dict_fail(d, "minDeltaT", "it is greater than maxDeltaT %g", c->max_delta_t);
    return OK;
}

/* Fails if controlDict names another of our solvers: that one word turns a case of gas into one of grains, but no
 * solver can restart from the folders of another. */
static status check_application(struct dict *d, const char *application) {
    static const char *const ours[] = {"granularGas", "granularMD", "granularDEM", "granularSegregation"};
    int i;
    if (!dict_has(d, "application")) return OK;
    TRY(dict_choice(d, "application", ours, 4, &i));
    if (!strcmp(ours[i], application)) return OK;
    return dict_fail(d, "application", "this is %s: write  application %s;  there, or run %s", application, application,
                     ours[i]);
}

/* Reads the names of the warnings that the user accepts. */
static status accept_warnings(struct dict *d, struct control *c) {
    const char *const *names;
    int n = 0;
    if (dict_has(d, "acceptWarnings")) TRY(dict_words(d, "acceptWarnings", &n, &names));
    for (int i = 0; i < n; i++) {
        int k = 0;
        while (k < WARNINGS && strcmp(names[i], warning_names[k])) k++;
        if (k == WARNINGS) return dict_unknown(d, "acceptWarnings", names[i], warning_names, WARNINGS);
        c->accepted[k] = true;
    }
    return OK;
}

static status read_all(struct control *c, const char *application) {
    struct dict *d = c->dict;
    TRY(version_read(d, &c->written)); /* first: a newer case may have keywords that are not known here */
    TRY(check_application(d, application));
    TRY(params_read(d, control_table, control_table_size, c));
    TRY(accept_warnings(d, c));
    const struct trigger each_step = {WRITE_TIME_STEP, 1, false};
    TRY(trigger_read(d, &each_step, false, &c->write));
    if (!dict_has(d, "writeControl") && !dict_has(d, "writeInterval"))
        return dict_missing(d, "writeControl",
                            "add  writeControl adjustableRunTime;  writeInterval <seconds>;  or  writeControl none;");
    TRY(dict_sub_optional(d, "functions", &c->functions));
    return together(d, c);
}

bool control_has(const struct control *c, const char *type) {
    const int n = c->functions ? dict_count(c->functions) : 0;
    bool found = false;
    for (int i = 0; i < n && !found; i++) {
        struct dict *one;
        const char *word = "";
        status e = dict_sub(c->functions, dict_key(c->functions, i), &one);
        if (!e) e = dict_word_or(one, "type", "", &word);
        found = !e && !strcmp(word, type);
        status_free(e); /* who makes the function objects tells what is wrong */
    }
    return found;
}

static bool stamp_of(const char *case_dir, long stamp[2]) {
    char path[PATH];
    struct stat info;
    snprintf(path, sizeof path, "%s/system/controlDict", case_dir);
    if (stat(path, &info)) return false;
    stamp[0] = (long)info.st_mtim.tv_sec;
    stamp[1] = info.st_mtim.tv_nsec;
    return true;
}

status control_read(const char *case_dir, const char *application, struct control **out) {
    char path[PATH];
    *out = NULL;
    struct control *c = NULL;
    TRY(allocate(&c, 1, sizeof *c, "controlDict"));
    snprintf(path, sizeof path, "%s/system/controlDict", case_dir);
    (void)stamp_of(case_dir, c->stamp);
    status s = dict_read(path, &c->dict);
    if (!s) s = read_all(c, application);
    if (s) {
        control_free(c);
        return s;
    }
    *out = c;
    return OK;
}

void control_free(struct control *c) {
    if (!c) return;
    dict_free(c->dict);
    free(c);
}

/* A file that was written to within the last half second may be half written, so it does not count as changed yet. */
bool control_changed(const struct control *c, const char *case_dir) {
    long stamp[2];
    struct timespec now;
    if (!stamp_of(case_dir, stamp) || (stamp[0] == c->stamp[0] && stamp[1] == c->stamp[1])) return false;
    clock_gettime(CLOCK_REALTIME, &now);
    double age = (double)(now.tv_sec - stamp[0]) + 1e-9 * (double)(now.tv_nsec - stamp[1]);
    return age < 0 || age > 0.5;
}

void control_stamp(struct control *c, const char *case_dir) {
    (void)stamp_of(case_dir, c->stamp);
}

/* Has t reached the target? Round-off of a few additions of steps is no difference between two times. */
static bool reached(double t, double target) {
    return t >= target - 1e-12 * fabs(target);
}

double trigger_next(const struct trigger *g, double t) {
    if (g->control != WRITE_ADJUSTABLE) return HUGE_VAL;
    double k = floor(t / g->interval);
    if (!(fabs(k) < 1e15))
        return t + 2e-12 * fabs(t); /* t rounds the interval away: due at the next time that differs from t */
    while (reached(t, k * g->interval)) k += 1;
    return k * g->interval;
}

bool trigger_late(const struct trigger *g, double t, double end) {
    const bool by_time = g->control == WRITE_ADJUSTABLE || g->control == WRITE_RUN_TIME;
    return by_time && (floor(t / g->interval) + 1) * g->interval > end + 1e-9 * fabs(end);
}

static double multiples(double value, double interval) {
    return floor(value / interval * (1 + 1e-12));
}

bool trigger_due(const struct trigger *g, const struct moment *before, const struct moment *now) {
    if (g->with_fields) return now->fields;
    switch (g->control) {
    case WRITE_TIME_STEP:
        return fmod((double)now->step, g->interval) == 0;
    case WRITE_RUN_TIME:
        return multiples(now->t, g->interval) > multiples(before->t, g->interval);
    case WRITE_ADJUSTABLE:
        return reached(now->t, trigger_next(g, before->t));
    case WRITE_CPU_TIME:
        return multiples(now->cpu, g->interval) > multiples(before->cpu, g->interval);
    case WRITE_CLOCK_TIME:
        return multiples(now->clock, g->interval) > multiples(before->clock, g->interval);
    case WRITE_NONE:
        break;
    }
    return false;
}

double control_step(const struct control *c, double t, long step, double stable, double next_event, double *end,
                    enum dt_limit *limit) {
    double dt = c->adjust ? stable : c->delta_t;
    *limit = c->adjust ? DT_COURANT : DT_FIXED;
    if (!c->adjust && stable < dt) {
        dt = stable;
        *limit = DT_STABLE;
    }
    if (c->adjust && c->max_delta_t < dt) {
        dt = c->max_delta_t;
        *limit = DT_MAXIMUM;
    }
    if (c->adjust && step == 0 && c->delta_t < dt) {
        dt = c->delta_t;
        *limit = DT_FIRST;
    }
    double event = next_event;
    enum dt_limit cause = DT_WRITE;
    if (c->stop_at == STOP_END_TIME && !reached(c->end_time, event)) {
        event = c->end_time;
        cause = DT_END;
    }
    /* The last two steps before an event share what is left, so that none is tiny. A step that would end within
     * round-off of the event ends on it. */
    double left = event - t;
    if (left <= dt * (1 + 1e-9)) {
        *limit = left < dt * (1 - 1e-9) ? cause : *limit;
        *end = event;
        return left;
    }
    if (c->adjust && left < 2 * dt) {
        dt = left / 2;
        *limit = cause;
    }
    *end = t + dt;
    return dt;
}

bool control_ended(const struct control *c, double t) {
    return c->stop_at == STOP_END_TIME && reached(t, c->end_time);
}

const char *dt_limit_name(enum dt_limit limit) {
    static const char *const names[] = {
        "Courant",    "deltaT", "the time scheme, below deltaT", "maxDeltaT", "deltaT of the first step",
        "write time", "endTime"};
    return names[limit];
}
