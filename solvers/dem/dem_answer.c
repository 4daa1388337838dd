/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes grains and contacts from the dumps of LAMMPS (dem_answer.h). */
#include "solvers/dem/dem_answer.h"

#include "solvers/dem/dem_deck.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WALL_ROW = 1 + DEM_WALL_COLUMNS * DEM_MOST_WALLS };
struct answer {
    struct lammps *from;
    const struct dem_law *law;
    int *index; /* [nold + 1] of a number; -1: the grain has left */
};

static void wrap(const struct dem_walls *w, double x[3]) {
    for (int k = 0; k < w->dim; k++) {
        const double length = w->high[k] - w->low[k];
        if (!w->periodic[k]) continue;
        if (x[k] < w->low[k]) x[k] += length;
        if (x[k] >= w->high[k]) x[k] -= length;
    }
}

/* Is x no more than the length of the box away from it? LAMMPS drops a grain, or ends, far closer. */
static bool is_near(const struct dem_walls *w, const double x[3]) {
    bool near = true;
    for (int k = 0; k < w->dim; k++) {
        const double length = w->high[k] - w->low[k];
        near = near && x[k] >= w->low[k] - length && x[k] <= w->high[k] + length;
    }
    return near;
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

/* Have the centres of a contact a distance, so that it has a normal? */
static bool has_normal(const struct dem_contact *c) {
    return c->branch[0] * c->branch[0] + c->branch[1] * c->branch[1] + c->branch[2] * c->branch[2] > 0;
}

/* The grain of a number, or -1 if it has left, or there is none. */
static int grain_of(const struct answer *a, const struct dem_moment *m, double number) {
    return number >= 1 && number <= m->nold ? a->index[(int)number] : -1;
}

/* How many walls give forces of their own? Those of triangles give the sum of their forces on a grain. */
static int columns_of(const struct dem_walls *w) {
    return w->facets ? 1 : w->n;
}

static status take_wall_row(const struct answer *a, const double *row, struct dem_moment *m) {
    const struct dem_walls *w = a->law->walls;
    const int i = grain_of(a, m, row[0]);
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
        if (!has_normal(c)) return fail(ERR_SYSTEM, "LAMMPS has the centre of grain %d on a wall", m->id[i]);
        split(c, 0.5 * a->law->diameter, force + 1);
        if (c->overlap <= 0) m->ncontacts--;
    }
    return OK;
}

/* Takes the grains that touch a wall, which are few: their rows are long. */
static status take_walls(const struct answer *a, struct dem_moment *m) {
    double row[WALL_ROW];
    long n;
    if (!a->law->walls->n) return OK;
    TRY(lammps_dump(a->from, &n));
    for (long i = 0; i < n; i++) {
        TRY(lammps_row(a->from, 1 + DEM_WALL_COLUMNS * columns_of(a->law->walls), row));
        TRY(take_wall_row(a, row, m));
    }
    return OK;
}

static status take_grain(const struct answer *a, const double row[DEM_COLUMNS], int i, struct dem_moment *m) {
    if (!(row[0] > (i ? m->id[i - 1] : 0) && row[0] <= m->nold && row[0] == floor(row[0])))
        return fail(ERR_SYSTEM, "LAMMPS has a grain of number %g where one of %d to %d is next", row[0],
                    i ? m->id[i - 1] + 1 : 1, m->nold);
    m->id[i] = (int)row[0];
    a->index[m->id[i]] = i;
    for (int k = 0; k < 3; k++) {
        m->x[i][k] = row[1 + k];
        m->u[i][k] = row[4 + k];
        m->spin[i][k] = row[7 + k];
    }
    if (!is_near(a->law->walls, m->x[i]))
        return fail(ERR_SYSTEM, "LAMMPS has grain %d at (%g %g %g), far outside of the box", m->id[i], row[1], row[2],
                    row[3]);
    wrap(a->law->walls, m->x[i]);
    return OK;
}

static status take_grains(const struct answer *a, struct dem_moment *m) {
    double row[DEM_COLUMNS];
    long n;
    TRY(lammps_dump(a->from, &n));
    if (n > m->nold || (n < m->nold && !a->law->walls->open))
        return fail(ERR_SYSTEM, "LAMMPS has %ld grains; at the start there were %d%s", n, m->nold,
                    n > m->nold ? "" : ", and none can leave");
    for (int i = 0; i <= m->nold; i++) a->index[i] = -1;
    m->n = (int)n;
    for (int i = 0; i < n; i++) {
        TRY(lammps_row(a->from, DEM_COLUMNS, row));
        TRY(take_grain(a, row, i, m));
    }
    return OK;
}

static status take_contact(const struct answer *a, const double row[DEM_CONTACT_COLUMNS], struct dem_moment *m) {
    const struct dem_walls *w = a->law->walls;
    struct dem_contact *c = NULL;
    const int one = grain_of(a, m, row[0]), other = grain_of(a, m, row[1]);
    if (one < 0 || other < 0) return OK;
    TRY(next_contact(m, &c));
    *c = (struct dem_contact){.a = one, .b = other};
    for (int k = 0; k < 3; k++) {
        const double length = w->high[k] - w->low[k];
        c->branch[k] = m->x[one][k] - m->x[other][k];
        if (w->periodic[k]) c->branch[k] -= length * round(c->branch[k] / length);
        c->push[k] = row[2 + k];
        c->drag[k] = row[5 + k];
    }
    if (!has_normal(c)) return fail(ERR_SYSTEM, "LAMMPS has grains %g and %g at one place", row[0], row[1]);
    split(c, a->law->diameter, NULL);
    return OK;
}

static status take_contacts(const struct answer *a, struct dem_moment *m) {
    double row[DEM_CONTACT_COLUMNS];
    long n;
    TRY(lammps_dump(a->from, &n));
    for (long i = 0; i < n; i++) {
        TRY(lammps_row(a->from, DEM_CONTACT_COLUMNS, row));
        if (!(row[0] >= 1 && row[0] <= m->nold && row[1] >= 1 && row[1] <= m->nold))
            return fail(ERR_SYSTEM, "LAMMPS has a contact of the grains %g and %g", row[0], row[1]);
        TRY(take_contact(a, row, m));
    }
    return OK;
}

status dem_answer_take(struct lammps *from, const struct dem_law *law, int *index, struct dem_moment *out) {
    const struct answer a = {from, law, index};
    out->ncontacts = 0;
    TRY(take_grains(&a, out));
    TRY(take_walls(&a, out));
    return take_contacts(&a, out);
}
