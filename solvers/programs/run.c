/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time loop of a run: plan a step, advance the medium, log, write, and react to signals and to a changed
 * controlDict (run.h). */
#include "solvers/programs/run.h"

#include "solvers/programs/outlook.h"
#include "solvers/programs/unread.h"

#include "solvers/case/changes.h"
#include "solvers/case/lock.h"
#include "solvers/dict/params.h"
#include "solvers/functions/functions.h"
#include "solvers/output/output.h"
#include "solvers/output/report.h"
#include "solvers/output/timing.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LOOK = 0.05; /* s, clock: how often controlDict is looked at if steps are shorter */

struct run {
    struct lock *lock;
    struct setup *setup;
    struct functions *functions;
    struct output *output;
    struct progress progress;
    struct timing timing;
    struct outlook outlook;
    struct moment now;
    struct pace pace;    /* of the next step */
    bool planned;        /* is it that? */
    double dt;           /* s: the last step, or the step to try next */
    double written_time; /* NAN: none yet */
    double looked;       /* s, clock: when controlDict was last looked at */
    double until;        /* s: a step ends there, at the latest */
    long cut;            /* steps of a fixed deltaT that the time scheme had to cut */
    bool runs;           /* have its steps begun, and none failed? */
    bool stop;
};

static volatile sig_atomic_t asked_to_stop; /* the one variable that a signal handler may touch */
static void on_signal(int number) {
    asked_to_stop = number;
}
static bool is_asked(void) {
    return asked_to_stop != 0;
}
static void catch_signals(void) {
    const int signals[] = {SIGTERM, SIGINT, SIGUSR1, SIGXCPU, SIGHUP};
    struct sigaction action, was;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < 5; i++) {
        bool nohup = !sigaction(signals[i], NULL, &was) && was.sa_handler == SIG_IGN && signals[i] == SIGHUP;
        if (!nohup) sigaction(signals[i], &action, NULL); /* SIGINT, too, which shells let background jobs ignore */
    }
    /* A file-size limit is a failed write, and a closed log is no reason to lose the run. */
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
}

static status read_everything(const char *dir, const struct medium_type *type, struct case_reading how,
                              const struct comm *c, struct setup **s, struct functions **f) {
    *f = NULL;
    status e = case_read(dir, type, how, c, s);
    if (e && comm_root(c)) e = unread_hint(dir, type, how.cures, e);
    TRY(e);
    TRY(unread_warn(*s));
    TRY(functions_make(*s, f));
    return comm_agree(c, dict_check_used((*s)->control->dict));
}

static void print_control(const struct setup *s) {
    const struct control *c = s->control;
    printf("Keys of system/controlDict\n");
    for (int i = 0; i < control_table_size; i++) {
        const struct param *p = &control_table[i];
        char value[PARAM_VALUE];
        if (!param_fills(p)) continue;
        param_value(value, p, c);
        printf("    %-18s %-12s %-9s %s\n", p->name, value, dict_has(c->dict, p->name) ? "read" : "default",
               p->meaning);
    }
}

static void print_keys(const struct setup *s, const struct pace *pace) {
    const struct control *c = s->control;
    const double dt = c->adjust ? fmin(pace->stable, c->max_delta_t) : c->delta_t;
    report_header(stdout, s, true);
    changes_print(stdout, s);
    print_control(s);
    if (!s->medium->type->event_driven) printf("\nfirst time step about %.3g s", dt);
    if (!s->medium->type->event_driven && isfinite(c->end_time))
        printf(", %.3g steps to endTime at that", (c->end_time - s->start.t) / dt);
    printf("\n");
}

/* Refuses a fixed deltaT that the time scheme does not allow at the start. A run that goes on may have been cut. */
static status check_step(const struct setup *s, const struct pace *pace) {
    const struct control *c = s->control;
    if (c->adjust || s->start.step > 0 || c->delta_t <= pace->stable * (1 + 1e-9)) return OK;
    return dict_fail(c->dict, "deltaT",
                     "the time scheme allows %.3g s at most at the start (deltaT has a Courant number of %.3g): lower "
                     "it, or say  adjustTimeStep yes;",
                     pace->stable, c->delta_t * pace->rate);
}

/* Prints "BEFORE2 warnings: NAMES" if there are any, and returns how many. */
static int print_warnings(const struct setup *s, const char *before) {
    char names[500];
    const int n = warnings_said(&s->warnings, names, sizeof names);
    if (n && comm_root(s->comm)) printf("%s%d warning%s: %s\n", before, n, n == 1 ? "" : "s", names);
    return n;
}

static status print_check(struct setup *s) {
    struct pace pace;
    struct outlook outlook = {0};
    TRY(s->medium->type->start(s->medium));
    s->medium->type->plan(s->medium, s->control, &pace);
    TRY(check_step(s, &pace));
    TRY(outlook_control(s, &pace));
    if (comm_root(s->comm) && !s->warnings.cures) print_keys(s, &pace);
    outlook_steps(&outlook, s, &pace, s->start.t);
    TRY(outlook_mesh(s));
    TRY(outlook_ranks(s));
    if (!print_warnings(s, "The case can be run, with ") && comm_root(s->comm)) printf("The case is sound.\n");
    return OK;
}

status run_check(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c) {
    struct setup *s = NULL;
    struct functions *f = NULL;
    status e = read_everything(dir, type, how, c, &s, &f);
    if (!e) e = print_check(s);
    functions_free(f);
    case_free(s);
    return e;
}

static status save_functions(const void *functions, const struct field_writer *w, struct checksums *sums) {
    return functions_save(functions, w, sums);
}

static status start(struct run *r) {
    struct setup *s = r->setup;
    s->medium->asked = is_asked;
    TRY(s->medium->type->start(s->medium));
    s->medium->type->plan(s->medium, s->control, &r->pace);
    r->planned = true;
    TRY(check_step(s, &r->pace));
    TRY(comm_agree(s->comm, output_make(s, save_functions, r->functions, &r->output)));
    r->now = (struct moment){.t = s->start.t, .step = s->start.step, .fields = true};
    r->dt = s->start.delta_t;
    r->written_time = s->start.t;
    TRY(outlook_control(s, &r->pace));
    TRY(outlook_ranks(s));
    if (comm_root(s->comm)) {
        report_header(stdout, s, true);
        changes_print(stdout, s);
    }
    timing_start(&r->timing);
    progress_start(&r->progress, s);
    return functions_collect(r->functions, NULL, &r->now);
}

static status write_now(struct run *r, char name[TIME_NAME]) {
    TRY(output_write(r->output, r->now.t, r->now.step, r->dt, name));
    r->written_time = r->now.t;
    return functions_read_times(r->functions) ? output_settle(r->output) : OK;
}

/* Writes the time 0 if it was read from 0.orig. */
static status write_original(struct run *r) {
    char name[TIME_NAME];
    return time_is_original(&r->setup->start) ? write_now(r, name) : OK;
}

/* Reads a changed controlDict, which replaces the old one; a wrong one is reported and ignored. `functions` stay as
 * they are. */
static status read_again(struct run *r) {
    struct setup *s = r->setup;
    struct control *changed = NULL;
    TRY(comm_agree(s->comm, comm_root(s->comm) ? case_here(s) : OK)); /* or the file is another folder's */
    control_stamp(s->control, s->dir);                                /* a wrong file is reported once */
    status e = control_read(s->dir, s->medium->type->application, &changed);
    if (!e && changed->functions) dict_mark_used(changed->functions);
    if (!e) e = dict_check_used(changed->dict);
    if (!e && s->medium->type->check_control) e = s->medium->type->check_control(s->medium, changed);
    e = comm_agree(s->comm, e);
    if (e) {
        if (comm_root(s->comm)) {
            printf("system/controlDict has changed but is wrong; the old one stays in force\n");
            (void)status_print(e, false);
        }
        status_free(e);
        control_free(changed);
        return OK;
    }
    control_free(s->control);
    s->control = changed;
    s->warnings.accepted = changed->accepted;
    if (comm_root(s->comm)) printf("system/controlDict has changed and was read again\n");
    return OK;
}

/* The answers that only the root knows, for all ranks: clocks, and whether to log, to stop or to read controlDict
 * again. */
struct word {
    double signal, log, changed, cpu, clock, fails;
};
static struct word root_says(struct run *r) {
    const struct setup *s = r->setup;
    struct word w = {.signal = is_asked()};
    if (comm_root(s->comm)) {
        const double clock = clock_now();
        long steps = r->now.step - s->start.step, every = s->control->log_interval;
        w.fails = output_fails(r->output);
        w.clock = clock - r->progress.start_clock;
        w.cpu = cpu_now();
        w.log = steps <= 3 || (every ? r->now.step % every == 0 : clock - r->progress.last_log > 1);
        if (s->control->modifiable && clock - r->looked > LOOK) {
            w.changed = control_changed(s->control, s->dir);
            r->looked = clock;
        }
    }
    comm_max(s->comm, &w.signal, 6);
    return w;
}

/* Writes what is due at the end of a step, and finds out whether the run ends here. */
static status after_step(struct run *r, const struct moment *before, const struct word *w) {
    const struct control *c = r->setup->control;
    char name[TIME_NAME];
    struct moment *now = &r->now;
    bool ended = control_ended(c, now->t), at_once = w->signal != 0 || c->stop_at == STOP_WRITE_NOW;
    bool due = trigger_due(&c->write, before, now);
    r->stop = ended || at_once || c->stop_at == STOP_NO_WRITE_NOW || (due && c->stop_at == STOP_NEXT_WRITE);
    now->fields = due || at_once || (ended && c->write.control != WRITE_NONE);
    if (c->stop_at == STOP_NO_WRITE_NOW && !at_once) now->fields = false;
    TRY(functions_collect(r->functions, before, now));
    if (now->fields)
        TRY(write_now(r, name));
    else
        time_name(c->time_format, c->time_precision, now->t, name);
    TRY(functions_execute(r->functions, before, now, name));
    if (r->stop) TRY(output_settle(r->output));
    if (r->stop && !ended && comm_root(r->setup->comm)) printf("stopped as asked at time %.10g\n", now->t);
    return OK;
}

/* Writes the state that the medium holds, unless it is on disk already. */
static status write_last(struct run *r) {
    char name[TIME_NAME];
    if (r->now.t == r->written_time) return OK;
    TRY(write_now(r, name));
    r->now.fields = true;
    return functions_execute(r->functions, NULL, &r->now, name);
}

/* Ends the run at the start of a step that was left because of a signal. */
static status end_early(struct run *r) {
    r->stop = true;
    if (comm_root(r->setup->comm)) printf("stopped as asked at time %.10g, within a step from there\n", r->now.t);
    TRY(write_last(r));
    return output_settle(r->output);
}

/* Warns of the first step of a fixed deltaT that the time scheme cuts to dt. */
static status note_cut(struct run *r, double dt) {
    const struct control *c = r->setup->control;
    if (r->cut++) return OK;
    return warn(&r->setup->warnings, WARN_LONG_STEP,
                "%s:%d: deltaT %g is longer than the time scheme allows: the step from t = %.10g is cut to %.3g s, "
                "and so are others like it; lower deltaT, or say  adjustTimeStep yes;",
                dict_path(c->dict), dict_line(c->dict, "deltaT"), c->delta_t, r->now.t, dt);
}

/* Plans the next step, unless that was done: a plan may depend on those before. */
static struct pace plan(struct run *r) {
    struct medium *m = r->setup->medium;
    if (!r->planned) m->type->plan(m, r->setup->control, &r->pace);
    r->planned = false;
    return r->pace;
}

/* Returns the next time at which a table of values has a knot. Steps end there: a stepper of second order then
 * integrates the table exactly, and sees its pulses. */
static double next_knot(const struct run *r) {
    const struct medium *m = r->setup->medium;
    return r->setup->control->adjust && m->type->knot ? m->type->knot(m, r->now.t) : HUGE_VAL;
}

/* Returns what limited a step: one that was shortened, one that ended at the knot of a table, or any other. */
static const char *limit_name(const struct pace *p, enum dt_limit limit, bool shortened, bool knot) {
    if (shortened) return p->early ? p->early : "a rejected step";
    if (limit == DT_WRITE && knot) return "a table of a patch";
    return limit == DT_COURANT && p->limit ? p->limit : dt_limit_name(limit);
}

/* Logs the step that has ended now: dt, Courant number and limiter are given. */
static status log_step(struct run *r, struct step_entry *e, bool print) {
    const struct control *c = r->setup->control;
    e->t = r->now.t;
    e->step = r->now.step;
    e->end_time = c->stop_at == STOP_END_TIME ? c->end_time : HUGE_VAL;
    return progress_step(&r->progress, r->setup, e, print);
}

/* Writes the row of the start into the table of the log. */
static status tabulate_start(struct run *r) {
    struct step_entry e = {.limit = "start"};
    return r->setup->control->run_table == TABLE_NONE ? OK : log_step(r, &e, false);
}

static status step_once(struct run *r) {
    struct setup *s = r->setup;
    struct medium *m = s->medium;
    struct step_entry e = {0};
    enum dt_limit limit;
    double end;
    const struct control *c = s->control;
    const struct pace pace = plan(r);
    timing_lap(&r->timing, LAP_PLAN);
    outlook_steps(&r->outlook, s, &pace, r->now.t);
    const double due = fmin(trigger_next(&c->write, r->now.t), functions_next(r->functions, r->now.t));
    const double next = fmin(due, r->until);
    const double knot = next_knot(r);
    double dt = control_step(c, r->now.t, r->now.step, pace.stable, fmin(next, knot), &end, &limit), planned = dt;
    if (limit == DT_STABLE) TRY(note_cut(r, dt));
    bool event = limit == DT_WRITE || limit == DT_END;
    struct word w = root_says(r);
    if (w.fails > 0) return output_settle(r->output);
    if (w.log > 0 && limit == DT_COURANT && !pace.limit) m->type->cell(m, e.cell, sizeof e.cell);
    TRY(functions_prepare(r->functions, r->now.t, end));
    m->end = end;
    timing_lap(&r->timing, LAP_LOG);
    TRY(m->type->step(m, c, r->now.t, &dt));
    timing_lap(&r->timing, LAP_STEP);
    if (dt == 0) return end_early(r);
    const struct moment before = r->now;
    r->now = (struct moment){
        .t = dt < planned ? before.t + dt : end, .step = before.step + 1, .cpu = w.cpu, .clock = w.clock};
    r->dt = m->next > 0 ? m->next : dt;
    if (m->type->after) TRY(m->type->after(m, &r->now));
    const bool print = w.log > 0 || (event && r->now.t == end && trigger_due(&c->write, &before, &r->now)) ||
                       control_ended(c, r->now.t);
    if (print || c->run_table == TABLE_EVERY_STEP) {
        e.dt = dt;
        e.courant = m->type->event_driven ? 0 : dt * pace.rate;
        e.limit = limit_name(&pace, limit, dt < planned, knot < next);
        TRY(log_step(r, &e, print));
    }
    if (w.changed > 0) TRY(read_again(r));
    timing_lap(&r->timing, LAP_LOG);
    TRY(after_step(r, &before, &w));
    timing_lap(&r->timing, LAP_OUTPUT);
    return OK;
}

/* Writes the last good state for a look at it. */
static status keep_last(struct run *r, status cause) {
    if (status_kind(cause) != ERR_STATE || !r->output || !r->setup->control->write_on_error) return cause;
    if (r->now.step != r->setup->start.step) status_free(write_last(r));
    return cause;
}

static void print_end(const struct run *r) {
    const struct setup *s = r->setup;
    double spent = clock_now() - r->progress.start_clock;
    long steps = r->now.step - s->start.step;
    timing_print(&r->timing, s->medium, stdout);
    printf("end at time %.10g: %ld steps in %.2f s", r->now.t, steps, spent);
    if (!s->medium->type->event_driven)
        printf(", %.4g million cell steps per second", 1e-6 * (double)steps * s->mesh->ncells / spent);
    printf("\n");
    if (r->cut) printf("%ld steps were shorter than deltaT, by the limit of the time scheme\n", r->cut);
}

/* Begins the steps; a case whose start has reached endTime has none. */
static status begin(struct run *r) {
    struct setup *s = r->setup;
    TRY(start(r));
    TRY(write_original(r));
    TRY(functions_execute(r->functions, NULL, &r->now, s->start.name));
    if (control_ended(s->control, r->now.t)) {
        r->stop = true;
        if (comm_root(s->comm))
            printf("nothing to do: time %s has reached endTime %g\n", s->start.name, s->control->end_time);
        return OK;
    }
    TRY(tabulate_start(r));
    timing_lap(&r->timing, LAP_START);
    r->runs = true;
    return OK;
}

/* Prints what is known at the end of the steps. */
static status end(struct run *r) {
    struct setup *s = r->setup;
    if (!r->runs) return OK;
    if (comm_root(s->comm)) print_end(r);
    if (s->medium->type->finish) TRY(s->medium->type->finish(s->medium, stdout));
    print_warnings(s, "");
    return OK;
}

status run_step(struct run *r, double until) {
    r->until = until;
    const status e = step_once(r);
    if (!e) return OK;
    r->stop = true;
    r->runs = false;
    return keep_last(r, e);
}

static status loop(struct run *r) {
    TRY(begin(r));
    while (!r->stop) TRY(run_step(r, HUGE_VAL));
    return end(r);
}

/* Locks the case and removes what a killed run left half written, on the root. The lock comes first: only then no other
 * run can be at work on it. */
static status lock_and_clean(const char *dir, const char *application, struct lock **lock) {
    TRY(lock_take(dir, application, lock));
    return times_clean(dir);
}

/* Locks and reads a case. */
static status take(struct run *r, const char *dir, const struct medium_type *type, struct case_reading how,
                   const struct comm *c) {
    *r = (struct run){.written_time = NAN, .until = HUGE_VAL};
    TRY(comm_agree(c, comm_root(c) ? lock_and_clean(dir, type->application, &r->lock) : OK));
    return read_everything(dir, type, how, c, &r->setup, &r->functions);
}

static void leave(struct run *r) {
    progress_end(&r->progress);
    output_free(r->output);
    functions_free(r->functions);
    case_free(r->setup);
    lock_release(r->lock);
}

/* Reads a case, locked, and does something with it. */
static status with_case(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c,
                        status (*action)(struct run *r)) {
    struct run r;
    status e = take(&r, dir, type, how, c);
    if (!e) e = action(&r);
    if (!e) e = output_settle(r.output);
    leave(&r);
    return e;
}

static status start_only(struct run *r) {
    TRY(start(r));
    return write_original(r);
}

status run_initial(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c) {
    how.afresh = true;
    return with_case(dir, type, how, c, start_only);
}

status run_case(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c) {
    catch_signals();
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    return with_case(dir, type, how, c, loop);
}

status run_open(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c,
                struct run **out) {
    struct run *r;
    *out = NULL;
    TRY(allocate(&r, 1, sizeof *r, "a run"));
    status e = take(r, dir, type, how, c);
    if (!e) e = begin(r);
    if (e) {
        leave(r);
        free(r);
        return e;
    }
    *out = r;
    return OK;
}

const struct moment *run_now(const struct run *r) {
    return &r->now;
}

bool run_ended(const struct run *r) {
    return r->stop;
}

const struct setup *run_setup(const struct run *r) {
    return r->setup;
}

status run_write(struct run *r) {
    TRY(write_last(r));
    return output_settle(r->output);
}

status run_close(struct run *r) {
    status e = end(r);
    if (!e) e = output_settle(r->output);
    leave(r);
    free(r);
    return e;
}
