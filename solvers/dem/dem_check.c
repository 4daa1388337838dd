/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks a case of soft grains, reads its start and chooses the time step (dem_run.h). */
#include "solvers/dem/dem_run.h"
#include "solvers/gas/scales.h"
#include "solvers/grains/grains_box.h"

#include <math.h>

/* A case can be checked where there is no LAMMPS; a run fails when it starts it. */
static status warn_program(struct setup *s, struct dem_run *r) {
    struct lammps_abilities can;
    status e = lammps_ask(&can);
    r->lammps = !e;
    if (!e) return OK;
    const status said = warn(&s->warnings, WARN_NO_LAMMPS, "%s", status_text(e));
    status_free(e);
    return said;
}

/* Makes the cells and the facets of a mesh that is no lattice. */
static status make_mesh(const struct setup *s, struct dem_run *r) {
    (void)grains_box_open(s, r->start.field[FIELD_U], r->models->open);
    return s->lattice ? OK : grains_mesh_make(s, r->models->grain.diameter, r->models->open, &r->mesh);
}

/* Pieces of space that repeat must hold three grains, so that a grain does not meet its own image. */
static status check_space(const struct setup *s, const struct dem_walls *w, double diameter) {
    const char *names = "xyz";
    for (int k = 0; k < w->dim; k++)
        if (w->periodic[k] && w->high[k] - w->low[k] < 3 * diameter)
            return fail(ERR_INPUT, "%s: the mesh is %g m wide along its cyclic axis %c; it must be 3 diameters (%g m)",
                        s->mesh_path, w->high[k] - w->low[k], names[s->axis[k]], 3 * diameter);
    return OK;
}

static status check_forces(const struct setup *s, const struct grains_models *m) {
    if (m->forces.source.knots == 0) return OK;
    (void)s;
    return dict_fail(m->forces.shaking, "amplitude",
                     "grains are shaken with a constant amplitude; run to the time of a change (endTime), write the "
                     "new number here, and go on");
}

static long cells_of(const struct setup *s, const struct dem_run *r) {
    return r->mesh ? s->mesh->ncells : (long)s->lattice->n[0] * s->lattice->n[1] * s->lattice->n[2];
}

/* Returns the fastest of what the start and the forces have (m/s). */
static double fastest(const struct setup *s, const struct dem_run *r) {
    double most = scales_fall(s, &r->models->forces.source);
    for (long c = 0; r->start.T && c < cells_of(s, r); c++) {
        double square = 0;
        for (int k = 0; k < s->dim; k++) square += r->start.u[k][c] * r->start.u[k][c];
        most = fmax(most, sqrt(square) + 3 * sqrt(r->start.T[c]));
    }
    return most;
}

/* Chooses impactSpeed, which a restart takes from the state, the tangential spring and the longest step. */
static status choose_step(const struct setup *s, struct dem_run *r) {
    struct grains_models *m = r->models;
    struct soft_contact *c = &m->contact;
    double speed = m->speed > 0 ? m->speed : r->saved.nold ? r->saved.account.speed : fastest(s, r);
    if (!(speed > 0))
        return fail(ERR_INPUT,
                    "%s: contact: nothing moves at the start, so that the speed of impacts is not known: give  "
                    "impactSpeed 0.1;",
                    dict_path(m->properties));
    r->account.speed = speed;
    if (c->type == CONTACT_HERTZ && c->tangent == TANGENT_SPRING && c->kt < 0)
        c->kt = contact_mindlin(c, m->grain.diameter, m->grain.mass, speed);
    r->law.pair = contact_pair(c, m->grain.diameter, m->grain.mass);
    r->longest = m->fraction * contact_time(&r->law.pair, speed);
    return OK;
}

static double weight_of(const struct setup *s, const struct dem_run *r, double *area) {
    const double *g = r->models->forces.source.gravity;
    double volume = 0, size = 0, total = 1, d = r->law.diameter;
    int down = 0;
    for (int k = 0; k < s->dim; k++) {
        size += g[k] * g[k];
        if (fabs(g[k]) > fabs(g[down])) down = k;
        total *= r->walls.high[k] - r->walls.low[k];
    }
    for (long c = 0; r->start.alpha && c < cells_of(s, r); c++)
        volume += r->start.alpha[c] * (r->mesh ? r->mesh->base.volume[c] : total / (double)cells_of(s, r));
    *area = total / (r->walls.high[down] - r->walls.low[down]) / (s->dim == 2 ? d : d * d);
    return volume / (s->dim == 2 ? 0.785398 * d * d : 0.523599 * d * d * d) * r->law.mass * sqrt(size);
}

static status warn_of(struct setup *s, const struct dem_run *r) {
    const struct grains_models *m = r->models;
    double area;
    const double weight = weight_of(s, r, &area), rest = contact_rest(&r->law.pair, weight / area);
    if (m->fraction > 1. / 30)
        TRY(warn(
            &s->warnings, WARN_LONG_CONTACT_STEP,
            "%s:%d: timeStepFraction %g gives fewer than 30 steps to a contact, so that restitution is off by some "
            "1e-3; say  timeStepFraction 0.02;",
            dict_path(m->properties), dict_line(m->properties, "contact"), m->fraction));
    if (rest > 1e-2 * r->law.diameter)
        TRY(warn(
            &s->warnings, WARN_SOFT_GRAINS,
            "%s:%d: grains at the bottom of the bed overlap by %.2g diameters at rest; make the contact stiffer, to "
            "less than 0.01",
            dict_path(m->properties), dict_line(m->properties, "contact"), rest / r->law.diameter));
    if (m->grain.threshold > 0)
        TRY(warn(&s->warnings, WARN_SOFT_THRESHOLD,
                 "%s:%d: thresholdSpeed is of hard grains; soft ones come to rest by themselves",
                 dict_path(m->granular), dict_line(m->granular, "grain")));
    return OK;
}

/* Makes rectangles of the walls; where they are none, it takes triangles, if LAMMPS can: on three axes, as LAMMPS
 * documents no file of lines. Without LAMMPS, which is warned of, the case is taken as one for a LAMMPS that can. */
static status find_walls(const struct setup *s, struct dem_run *r) {
    const struct field *U = r->start.field[FIELD_U];
    struct lammps_abilities can;
    status flat = dem_walls_make(s, r->models, U, NULL, &r->walls);
    if (!flat || !r->mesh || !r->mesh->facets || s->dim == 2) return flat;
    status e = dem_walls_make(s, r->models, U, r->mesh->facets, &r->walls);
    status missing = e ? OK : lammps_ask(&can);
    if (e || missing || can.surface) {
        status_free(flat);
        status_free(missing);
        return e;
    }
    e = fail(ERR_INPUT,
             "%s. Other walls need fix surface/global of LAMMPS (package GRANSURF, in 4 Jul 2026 and later), "
             "which this lmp (%s) lacks",
             status_text(flat), can.version);
    status_free(flat);
    return e;
}

status dem_run_state(struct setup *s, struct dem_run *r) {
    struct grains_models *m = r->models;
    char path[2 * TIME_PATH];
    r->setup = s;
    TRY(grains_box_check(s));
    TRY(grains_check_shape(s, m));
    snprintf(path, sizeof path, "%s/%s/uniform/softGrains", s->dir, s->start.folder);
    const bool saved = field_exists(path);
    TRY(grains_start_read(s, m, saved, &r->start));
    for (int i = 0; i < FIELD_COUNT; i++) TRY(warn_field(&s->warnings, r->start.field[i], time_is_original(&s->start)));
    TRY(grains_start_walls(s, &r->start, m));
    TRY(make_mesh(s, r));
    TRY(grains_start_take(s, m, r->mesh, saved, &r->start));
    TRY(grains_start_check(s, m, &r->start));
    TRY(check_forces(s, m));
    if (saved) TRY(dem_state_read(path, &r->saved));
    TRY(choose_step(s, r));
    TRY(find_walls(s, r));
    TRY(check_space(s, &r->walls, m->grain.diameter));
    r->law.diameter = m->grain.diameter;
    r->law.mass = m->grain.mass;
    r->law.walls = &r->walls;
    r->law.gravity = &m->forces.source;
    TRY(warn_of(s, r));
    TRY(warn_program(s, r));
    return setup_grid(s, r->mesh != NULL, 1, false);
}
