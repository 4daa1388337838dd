/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs LAMMPS in pieces (dem_engine.h). */
#include "solvers/dem/dem_engine.h"

#include "solvers/dem/dem_answer.h"
#include "solvers/dem/dem_deck.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 4096 };
struct dem_engine {
    struct dem_law law;
    struct lammps *lammps;
    double t, dt;   /* s: time of the last dem_engine_pace */
    long step, set; /* steps done; and at that time */
    bool anew;      /* is the next piece set up first? */
    bool begun;     /* has LAMMPS been set up since it read grains? */
    char folder[TEXT];
    int *index; /* room for an answer */
};

status dem_moment_make(int n, struct dem_moment *out) {
    *out = (struct dem_moment){.n = n, .nold = n};
    TRY(allocate(&out->id, n, sizeof(int), "grains"));
    TRY(allocate(&out->x, n, sizeof *out->x, "grains"));
    TRY(allocate(&out->u, n, sizeof *out->u, "grains"));
    TRY(allocate(&out->spin, n, sizeof *out->spin, "grains"));
    for (int i = 0; i < n; i++) out->id[i] = i + 1;
    return OK;
}

void dem_moment_free(struct dem_moment *m) {
    free(m->id);
    free(m->x);
    free(m->u);
    free(m->spin);
    free(m->contact);
    *m = (struct dem_moment){.n = 0};
}

static status keep_text(const char *folder, const char *text) {
    char path[TEXT + 32];
    FILE *f;
    snprintf(path, sizeof path, "%s/in.lammps", folder);
    const int why = file_create_stream(path, &f);
    if (why) return file_error(path, "cannot be written", why);
    fputs(text, f);
    const bool failed = ferror(f);
    return fclose(f) || failed ? fail(ERR_SYSTEM, "%s: cannot be written (disk full?)", path) : OK;
}

static status send_deck(struct dem_engine *e, const char *data, const char *restart, bool keep) {
    char *text = NULL;
    status s = dem_deck(&e->law, e->folder, data, restart, &text);
    if (!s && keep) s = keep_text(e->folder, text);
    if (!s) lammps_send(e->lammps, "%s", text);
    free(text);
    e->begun = false;
    TRY(s);
    return lammps_wait(e->lammps);
}

static status fill(struct dem_engine *e, int ranks, bool (*asked)(void), const char *folder,
                   const struct dem_moment *start, const char *restart, int nold) {
    const struct dem_law *law = &e->law;
    char data[TEXT + 32];
    snprintf(e->folder, sizeof e->folder, "%s", folder);
    snprintf(data, sizeof data, "%s/grains.data", folder);
    TRY(allocate(&e->index, nold + 1, sizeof(int), "grains"));
    TRY(lammps_start(ranks, asked, &e->lammps));
    if (start) TRY(dem_deck_data(law, start, data));
    if (law->walls->facets) TRY(dem_deck_surface(law->walls, folder));
    return send_deck(e, data, restart, true);
}

status dem_engine_make(const struct dem_law *law, int ranks, bool (*asked)(void), const char *folder,
                       const struct dem_moment *start, const char *restart, struct dem_engine **out) {
    *out = NULL;
    TRY(allocate(out, 1, sizeof **out, "grains"));
    **out = (struct dem_engine){.law = *law, .anew = true};
    return fill(*out, ranks, asked, folder, restart ? NULL : start, restart, start->nold);
}

void dem_engine_free(struct dem_engine *e) {
    if (!e) return;
    lammps_free(e->lammps);
    free(e->index);
    free(e);
}

void dem_engine_pace(struct dem_engine *e, double t, double dt, bool anew) {
    if (!anew && !e->anew && fabs(dt - e->dt) < 1e-9 * dt) return;
    e->t = t;
    e->dt = dt;
    e->anew = true;
}

/* Reads all anew as a restart does. LAMMPS must not be set up twice: each time fix wall/gran takes its coefficient of
 * `damping tsuji`, which it has changed into alpha before, for a restitution and changes it once more. */
static status reload(struct dem_engine *e) {
    char restart[TEXT + 32];
    snprintf(restart, sizeof restart, "%s/grains.restart", e->folder);
    lammps_send(e->lammps, "write_restart \"%s\"\nclear", restart);
    return send_deck(e, "", restart, false);
}

status dem_engine_run(struct dem_engine *e, long steps) {
    if (e->anew && e->begun) TRY(reload(e));
    if (e->anew) {
        lammps_send(e->lammps, "timestep %.17g", e->dt);
        lammps_send(e->lammps, "variable begin equal $(step)");
        lammps_send(e->lammps, "variable time equal %.17g+(step-v_begin)*%.17g", e->t, e->dt);
    }
    lammps_send(e->lammps, "run %ld%s post no", steps, e->anew ? "" : " pre no");
    e->anew = false;
    e->begun = true;
    return lammps_wait(e->lammps);
}

status dem_engine_save(struct dem_engine *e, const char *path) {
    lammps_send(e->lammps, "write_restart \"%s\"", path);
    e->anew = true;
    return lammps_wait(e->lammps);
}

/* Lets the dumps write at each step, or never. */
static void set_dumps(struct dem_engine *e, int every) {
    static const char *const names[] = {"grains", "contacts", "walls"};
    for (int i = 0; i < (e->law.walls->n ? 3 : 2); i++)
        lammps_send(e->lammps, "dump_modify %s every %d", names[i], every);
}

status dem_engine_moment(struct dem_engine *e, struct dem_moment *out) {
    set_dumps(e, 1);
    lammps_send(e->lammps, "run 0 pre no post no");
    set_dumps(e, 1000000000);
    const status answered = dem_answer_take(e->lammps, &e->law, e->index, out);
    if (answered && lammps_lives(e->lammps))
        return status_note(answered,
                           "LAMMPS did not answer as it should; if the run, started again, ends alike, take another "
                           "version of LAMMPS");
    TRY(answered);
    return lammps_wait(e->lammps);
}
