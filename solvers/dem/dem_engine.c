/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs LAMMPS in pieces and takes grains and contacts from its dumps (dem_engine.h). */
#include "solvers/dem/dem_engine.h"

#include "solvers/dem/dem_deck.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WALL_ROW = 1 + DEM_WALL_COLUMNS * DEM_MOST_WALLS, TEXT = 4096 };
struct dem_engine {
    struct dem_law law;
    struct lammps *lammps;
    double t, dt;   /* s: time of the last dem_engine_pace */
    long step, set; /* steps done; and at that time */
    bool anew;      /* is the next piece set up first? */
    bool begun;     /* has LAMMPS been set up since it read grains? */
    char folder[TEXT];
    int nold;
    int *index; /* [nold + 1] of a number; -1: the grain has left */
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

static status fill(struct dem_engine *e, int ranks, const char *folder, const struct dem_moment *start,
                   const char *restart, int nold) {
    const struct dem_law *law = &e->law;
    char data[TEXT + 32];
    snprintf(e->folder, sizeof e->folder, "%s", folder);
    snprintf(data, sizeof data, "%s/grains.data", folder);
    e->nold = nold;
    TRY(allocate(&e->index, nold + 1, sizeof(int), "grains"));
    TRY(lammps_start(ranks, &e->lammps));
    if (start) TRY(dem_deck_data(law, start, data));
    if (law->walls->facets) TRY(dem_deck_surface(law->walls, folder));
    return send_deck(e, data, restart, true);
}

status dem_engine_make(const struct dem_law *law, int ranks, const char *folder, const struct dem_moment *start,
                       const char *restart, struct dem_engine **out) {
    *out = NULL;
    TRY(allocate(out, 1, sizeof **out, "grains"));
    **out = (struct dem_engine){.law = *law, .anew = true};
    return fill(*out, ranks, folder, restart ? NULL : start, restart, start->nold);
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

/* ---- dumps ---- */

static void wrap(const struct dem_walls *w, double x[3]) {
    for (int k = 0; k < w->dim; k++) {
        const double length = w->high[k] - w->low[k];
        if (!w->periodic[k]) continue;
        if (x[k] < w->low[k]) x[k] += length;
        if (x[k] >= w->high[k]) x[k] -= length;
    }
}

static status next_contact(struct dem_moment *m, struct dem_contact **out) {
    if (m->ncontacts == m->room) {
        const long room = 2 * m->room + 64;
        struct dem_contact *more = realloc(m->contact, (size_t)room * sizeof *more);
        if (!more) return fail(ERR_SYSTEM, "no memory for %ld contacts of grains", room);
        m->contact = more;
        m->room = room;
    }
    *out = &m->contact[m->ncontacts++];
    return OK;
}

/* Sets overlap and the parts of the force of a contact from its branch and, of walls, the whole force. */
static void split(struct dem_contact *c, double touch, const double *force) {
    double r = 0, along = 0;
    for (int k = 0; k < 3; k++) r += c->branch[k] * c->branch[k];
    r = sqrt(r);
    c->overlap = touch - r;
    if (!force) return;
    for (int k = 0; k < 3; k++) along += force[k] * c->branch[k] / r;
    for (int k = 0; k < 3; k++) {
        c->push[k] = along * c->branch[k] / r;
        c->drag[k] = force[k] - c->push[k];
    }
}

/* How many walls give forces of their own? Those of triangles give the sum of their forces on a grain. */
static int columns_of(const struct dem_walls *w) {
    return w->facets ? 1 : w->n;
}

static status take_wall_row(struct dem_engine *e, const double *row, struct dem_moment *m) {
    const struct dem_walls *w = e->law.walls;
    const int i = row[0] >= 1 && row[0] <= e->nold ? e->index[(int)row[0]] : -1;
    if (i < 0) return fail(ERR_SYSTEM, "LAMMPS has a contact of grain %g with a wall", row[0]);
    for (int j = 0; j < columns_of(w); j++) {
        const int wall = w->facets ? dem_wall_at(w, m->x[i]) : j;
        const double *force = row + 1 + (long)DEM_WALL_COLUMNS * j;
        struct dem_contact *c = NULL;
        double near[3];
        if (force[0] == 0) continue;
        dem_wall_nearest(w, wall, m->x[i], near);
        TRY(next_contact(m, &c));
        *c = (struct dem_contact){.a = i, .b = -1 - wall};
        for (int k = 0; k < w->dim; k++) c->branch[k] = m->x[i][k] - near[k];
        split(c, 0.5 * e->law.diameter, force + 1);
        if (c->overlap <= 0) m->ncontacts--;
    }
    return OK;
}

/* Takes the grains that touch a wall, which are few: their rows are long. */
static status take_walls(struct dem_engine *e, struct dem_moment *m) {
    double row[WALL_ROW];
    long n;
    if (!e->law.walls->n) return OK;
    TRY(lammps_dump(e->lammps, &n));
    for (long i = 0; i < n; i++) {
        TRY(lammps_row(e->lammps, 1 + DEM_WALL_COLUMNS * columns_of(e->law.walls), row));
        TRY(take_wall_row(e, row, m));
    }
    return OK;
}

static status take_grains(struct dem_engine *e, struct dem_moment *m) {
    double row[DEM_COLUMNS];
    long n;
    TRY(lammps_dump(e->lammps, &n));
    if (n > m->nold) return fail(ERR_SYSTEM, "LAMMPS has %ld grains, more than the %d of the start", n, m->nold);
    for (int i = 0; i <= e->nold; i++) e->index[i] = -1;
    m->n = (int)n;
    for (int i = 0; i < n; i++) {
        TRY(lammps_row(e->lammps, DEM_COLUMNS, row));
        if (!(row[0] >= 1 && row[0] <= e->nold)) return fail(ERR_SYSTEM, "LAMMPS has a grain of number %g", row[0]);
        m->id[i] = (int)row[0];
        e->index[m->id[i]] = i;
        for (int k = 0; k < 3; k++) {
            m->x[i][k] = row[1 + k];
            m->u[i][k] = row[4 + k];
            m->spin[i][k] = row[7 + k];
        }
        wrap(e->law.walls, m->x[i]);
    }
    return OK;
}

static status take_contact(struct dem_engine *e, const double row[DEM_CONTACT_COLUMNS], struct dem_moment *m) {
    const struct dem_walls *w = e->law.walls;
    struct dem_contact *c = NULL;
    const int a = e->index[(int)row[0]], b = e->index[(int)row[1]];
    if (a < 0 || b < 0) return OK;
    TRY(next_contact(m, &c));
    *c = (struct dem_contact){.a = a, .b = b};
    for (int k = 0; k < 3; k++) {
        const double length = w->high[k] - w->low[k];
        c->branch[k] = m->x[a][k] - m->x[b][k];
        if (w->periodic[k]) c->branch[k] -= length * round(c->branch[k] / length);
        c->push[k] = row[2 + k];
        c->drag[k] = row[5 + k];
    }
    split(c, e->law.diameter, NULL);
    return OK;
}

static status take_contacts(struct dem_engine *e, struct dem_moment *m) {
    double row[DEM_CONTACT_COLUMNS];
    long n;
    TRY(lammps_dump(e->lammps, &n));
    for (long i = 0; i < n; i++) {
        TRY(lammps_row(e->lammps, DEM_CONTACT_COLUMNS, row));
        if (!(row[0] >= 1 && row[0] <= e->nold && row[1] >= 1 && row[1] <= e->nold))
            return fail(ERR_SYSTEM, "LAMMPS has a contact of the grains %g and %g", row[0], row[1]);
        TRY(take_contact(e, row, m));
    }
    return OK;
}

/* Lets the dumps write at each step, or never. */
static void set_dumps(struct dem_engine *e, int every) {
    static const char *const names[] = {"grains", "contacts", "walls"};
    for (int i = 0; i < (e->law.walls->n ? 3 : 2); i++)
        lammps_send(e->lammps, "dump_modify %s every %d", names[i], every);
}

status dem_engine_moment(struct dem_engine *e, struct dem_moment *out) {
    out->ncontacts = 0;
    set_dumps(e, 1);
    lammps_send(e->lammps, "run 0 pre no post no");
    set_dumps(e, 1000000000);
    TRY(take_grains(e, out));
    TRY(take_walls(e, out));
    TRY(take_contacts(e, out));
    return lammps_wait(e->lammps);
}
