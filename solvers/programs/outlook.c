/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foretells the end of a run (outlook.h). */
#include "solvers/programs/outlook.h"

#include <math.h>
#include <stdlib.h>

static const double MANY = 1e6;       /* steps, of which a note tells */
static const double FAR_TOO = 1e7;    /* steps, of which a warning tells */
static const double FALLEN = 1000;    /* steps foretold now, beside those foretold first */
static const double FEW = 100;        /* a run of fewer steps may take many more without being long */
static const double MORE = 10;        /* times the steps foretold: more are not due to their length */
static const double NARROW = 1e-6;    /* V/A of a cell beside the median */
static const double MANY_TIMES = 1e5; /* that are written */
enum { PLACE = 400 };

static void say(const struct setup *s, const struct pace *pace, double t, double dt, double left, double first) {
    char bound[PLACE] = "";
    const struct medium *m = s->medium;
    const bool limits = s->control->adjust && pace->stable <= s->control->max_delta_t;
    if (limits && !pace->limit && m->type->bound) m->type->bound(s->medium, bound, sizeof bound);
    if (!comm_root(s->comm)) return;
    printf("    note: %.3g steps from t = %.10g to endTime %g at deltaT = %.3g s", left, t, s->control->end_time, dt);
    if (first > 0) printf(", %.3g times as many as the first step foretold", left / first);
    printf("\n      deltaT is limited by: %s%s\n",
           !limits       ? "controlDict"
           : pace->limit ? pace->limit
                         : "Courant",
           *bound ? bound : "");
}

void outlook_steps(struct outlook *o, const struct setup *s, const struct pace *pace, double t) {
    const struct control *c = s->control;
    const double dt = c->adjust ? fmin(pace->stable, c->max_delta_t) : c->delta_t, left = (c->end_time - t) / dt;
    if (s->medium->type->event_driven || !isfinite(left) || c->stop_at != STOP_END_TIME) return;
    const bool first = o->too_many == 0;
    if (left > (first ? MANY : o->too_many)) {
        if (!first || left <= FAR_TOO) say(s, pace, t, dt, left, o->first);
        o->too_many = HUGE_VAL;
    }
    if (!first) return;
    o->first = left;
    o->too_many = FALLEN * fmax(left, FEW);
}

static status check_steps(struct setup *s, const struct pace *pace, double dt, double left) {
    const struct control *c = s->control;
    char bound[PLACE] = "";
    if (!(left > FAR_TOO)) return OK;
    const bool limits = c->adjust && pace->stable <= c->max_delta_t;
    if (limits && !pace->limit && s->medium->type->bound) s->medium->type->bound(s->medium, bound, sizeof bound);
    return warn(&s->warnings, WARN_MANY_STEPS,
                "%s:%d: endTime %g is %.3g steps away at deltaT = %.3g s, which is limited by %s%s: lower endTime, or "
                "lift that limit",
                dict_path(c->dict), dict_line(c->dict, "endTime"), c->end_time, left, dt,
                !limits       ? "controlDict"
                : pace->limit ? pace->limit
                              : "Courant",
                bound);
}

/* Warns if there are enough times to fill a disk; `steps` is how many steps there will be, about. */
static status check_number(struct setup *s, double span, double steps) {
    const struct control *c = s->control;
    const struct trigger *w = &c->write;
    const bool by_time = w->control == WRITE_ADJUSTABLE || w->control == WRITE_RUN_TIME;
    const double n = by_time ? span / w->interval : w->control == WRITE_TIME_STEP ? steps / w->interval : 0;
    if (!(n > MANY_TIMES) || c->purge) return OK;
    return warn(
        &s->warnings, WARN_MANY_WRITES,
        "%s:%d: writeInterval %g makes some %.3g times, each a folder with the fields of %d cells: raise it, or "
        "keep the last ones alone, with  purgeWrite 10;",
        dict_path(c->dict), dict_line(c->dict, "writeInterval"), w->interval, n, s->mesh->ncells);
}

/* Warns of a first time of writing that lies behind the end. */
static status check_writes(struct setup *s, double span, double steps) {
    const struct control *c = s->control;
    const struct trigger *w = &c->write;
    const bool by_step = w->control == WRITE_TIME_STEP && w->interval > MORE * steps;
    char instead[40], beyond[80];
    if (s->start.step > 0) return OK;
    if (!by_step && !trigger_late(w, s->start.t, c->end_time)) return check_number(s, span, steps);
    snprintf(instead, sizeof instead, "%.3g", by_step ? ceil(steps / 10) : span / 10);
    snprintf(beyond, sizeof beyond, by_step ? "the %.3g steps or so of the run" : "endTime %.6g",
             by_step ? steps : c->end_time);
    const char *path = dict_path(c->dict);
    const int line = dict_line(c->dict, "writeInterval");
    warn_cure(&s->warnings, WARN_NOTHING_WRITTEN, CURE_VALUE, path, line, "writeInterval", instead);
    return warn(&s->warnings, WARN_NOTHING_WRITTEN,
                "%s:%d: writeInterval %g reaches beyond %s: nothing is written before the end; say for example  "
                "writeInterval %s;",
                path, line, w->interval, beyond, instead);
}

status outlook_control(struct setup *s, const struct pace *pace) {
    const struct control *c = s->control;
    const double dt = c->adjust ? fmin(pace->stable, c->max_delta_t) : c->delta_t,
                 left = (c->end_time - s->start.t) / dt;
    if (!c->adjust && c->max_delta_t < c->delta_t) {
        const int line = dict_line(c->dict, "maxDeltaT");
        warn_cure(&s->warnings, WARN_FIXED_STEP, CURE_ENTRY, dict_path(c->dict), line, "maxDeltaT", NULL);
        TRY(warn(&s->warnings, WARN_FIXED_STEP,
                 "%s:%d: maxDeltaT %g does not count, for adjustTimeStep is no: all steps are deltaT %g; remove it, or "
                 "say  adjustTimeStep yes;",
                 dict_path(c->dict), line, c->max_delta_t, c->delta_t));
    }
    if (c->stop_at == STOP_NO_WRITE_NOW)
        return warn(
            &s->warnings, WARN_NOTHING_WRITTEN,
            "%s:%d: stopAt noWriteNow ends the run behind its first step, and nothing is written: it stops a run "
            "that is going on; to begin one say  stopAt endTime;",
            dict_path(c->dict), dict_line(c->dict, "stopAt"));
    if (c->stop_at != STOP_END_TIME || !(left > 0)) return OK;
    if (!s->medium->type->event_driven && isfinite(left)) TRY(check_steps(s, pace, dt, left));
    return check_writes(s, c->end_time - s->start.t, s->medium->type->event_driven ? NAN : left);
}

status outlook_mesh(struct setup *s) {
    const struct polymesh *m = s->mesh;
    struct narrowest n;
    double *face;
    if (s->lattice || s->mesh->outline) return OK; /* all cells are equal, or were compared (spread_read) */
    TRY(allocate(&face, 6L * m->nfaces, sizeof *face, "faces"));
    polymesh_face_geometry(m, face, face + 3L * m->nfaces);
    status e = polymesh_narrowest(m, face + 3L * m->nfaces, s->volume, &n);
    free(face);
    TRY(e);
    const double *x = s->centre + 3 * n.cell;
    if (n.ratio > NARROW) return OK;
    return warn(&s->warnings, WARN_NARROW,
                "%s: cell %ld at (%.6g %.6g %.6g) has V/A = %.3g m, %.3g of the median of all: "
                "it alone makes the steps short, and with transport many more stages; make the mesh even there "
                "(1e-12 is refused)",
                s->mesh_path, n.cell, x[0], x[1], x[2], n.width, n.ratio);
}

status outlook_ranks(struct setup *s) {
    const struct forest *f = s->grid->forest;
    const int ranks = comm_size(s->comm), parts = f ? f->ntiles_all : s->grid->nblocks_all;
    const char *what = f ? "tile" : "block", *plural = parts == 1 ? "" : "s";
    const struct medium_type *type = s->medium->type;
    if (ranks <= parts || type->whole || type->slabs)
        return OK; /* a medium that is computed as a whole is everywhere */
    return warn(&s->warnings, WARN_IDLE,
                "%s: the mesh of %d cells is dealt to the ranks in %d %s%s of %s: %d of %d ranks have nothing to do; "
                "give  -np %d  at most",
                s->mesh_path, s->mesh->ncells, parts, what, plural,
                !f           ? "some 500 cells"
                : f->dim < 3 ? "at most 60 cells a side"
                             : "at most 24 cells a side",
                ranks - parts, ranks, parts);
}
