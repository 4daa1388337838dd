/* SPDX-License-Identifier: GPL-3.0-or-later */
/* system/controlDict: when a run starts, steps, writes and stops. All choices depend on the state, the time, the step
 * number and the dictionary only, so that a restarted run takes the steps of one that went through. */
#ifndef SOLVERS_CONTROL_H
#define SOLVERS_CONTROL_H

#include "libcore/models/param.h"
#include "mesh/format/foamfile.h"
#include "solvers/case/version.h"
#include "solvers/case/warnings.h"
#include "solvers/dict/keywords.h"

enum start_from { START_FIRST, START_TIME, START_LATEST };
enum stop_at { STOP_END_TIME, STOP_WRITE_NOW, STOP_NO_WRITE_NOW, STOP_NEXT_WRITE };
enum write_control { WRITE_TIME_STEP, WRITE_RUN_TIME, WRITE_ADJUSTABLE, WRITE_CPU_TIME, WRITE_CLOCK_TIME, WRITE_NONE };
enum run_table { TABLE_PRINTED, TABLE_EVERY_STEP, TABLE_NONE };
enum time_format { TIME_GENERAL, TIME_FIXED, TIME_SCIENTIFIC };

struct trigger { /* when something is written: the fields, or a function object's output */
    enum write_control control;
    double interval;  /* steps or s */
    bool with_fields; /* writeControl writeTime (outputTime): whenever the fields are written */
};

struct control {
    struct dict *dict;
    struct dict *functions; /* NULL: none; owned by dict */
    struct version written; /* haffVersion; 0.0: the case does not say */
    enum start_from start_from;
    enum stop_at stop_at;
    bool adjust;                     /* is dt chosen from the Courant number? */
    double start_time, end_time;     /* s */
    double delta_t;                  /* s: of every step if !adjust, else the most for step 0 */
    double max_co;                   /* Courant number */
    double max_delta_t, min_delta_t; /* s */
    struct trigger write;
    int purge; /* number of written times that are kept; 0: all */
    struct foam_format format;
    enum time_format time_format;
    int time_precision;
    bool modifiable;          /* is the file read again when it changes? */
    bool write_on_error;      /* onError write: the last good state is written */
    bool previous_if_corrupt; /* onCorruptTime previous: start from the time before; else stop */
    bool write_processors;    /* processorN folders are written, too */
    int log_interval;         /* steps between log entries; 0: about one a second */
    enum run_table run_table; /* steps that have a row in run.dat */
    bool run_table_parts;     /* has a row the seconds of each part of the steps? */
    bool accepted[WARNINGS];  /* warnings of acceptWarnings */
    long stamp[2];            /* time of the file's last change when it was read: seconds, nanoseconds */
};

/* Reads CASE/system/controlDict. Keys of programs other than `application` are accepted; see dict_check_used. */
status control_read(const char *case_dir, const char *application, struct control **out);
bool control_has(const struct control *c, const char *type); /* is there a function object of a type? */
void control_free(struct control *c);
extern const struct param control_table[]; /* of the file; offsets in struct control */
extern const int control_table_size;
void control_keywords(struct keywords *k); /* all of the file but the function objects */
void trigger_keywords(struct keywords *k); /* those of trigger_read for a function object */

/* Has the file changed since it was read? Not collective: ask on the root. */
bool control_changed(const struct control *c, const char *case_dir);
void control_stamp(struct control *c, const char *case_dir); /* takes note of the change */

/* Reads `writeControl` and `writeInterval` of d; if d has neither, *out is *standard. */
status trigger_read(struct dict *d, const struct trigger *standard, bool fields_allowed, struct trigger *out);
/* Returns the first multiple of the interval after t at which a step must end; INFINITY if the trigger asks for
 * none. */
double trigger_next(const struct trigger *g, double t);
/* Does the trigger count time, and is its first output behind the end of a run from t on? */
bool trigger_late(const struct trigger *g, double t, double end);
struct moment { /* the end of a step */
    double t;   /* s */
    long step;
    double cpu, clock; /* s since the start of the run */
    bool fields;       /* are the fields written now? */
};
/* Is the trigger's output due at the end of the step from `before` to `now`? */
bool trigger_due(const struct trigger *g, const struct moment *before, const struct moment *now);

/* Returns the step to take at time t (s), `stable` being the largest that maxCo allows (s), or, for a fixed deltaT, the
 * time scheme (DT_STABLE: deltaT was cut to that). *end is the time after the
 * step: a multiple of a write interval or endTime exactly where the step was cut to hit it. next_event comes from
 * trigger_next. */
enum dt_limit { DT_COURANT, DT_FIXED, DT_STABLE, DT_MAXIMUM, DT_FIRST, DT_WRITE, DT_END };
double control_step(const struct control *c, double t, long step, double stable, double next_event, double *end,
                    enum dt_limit *limit);
bool control_ended(const struct control *c, double t); /* has t reached endTime? */
const char *dt_limit_name(enum dt_limit limit);

#endif
