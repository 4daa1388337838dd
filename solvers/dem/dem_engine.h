/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Soft spheres that LAMMPS moves (lammps.h): the commands of a run, pieces of it, the grains and their contacts at a
 * moment, and its restart files. Lengths and axes are those of dem_walls.h; velocities are relative to the box, whose
 * shaking is a change of gravity. */
#ifndef SOLVERS_DEM_ENGINE_H
#define SOLVERS_DEM_ENGINE_H

#include "solvers/dem/dem_walls.h"
#include "solvers/dem/lammps.h"

struct dem_contact {
    int a, b;                /* indices of the grains; b < 0: -1 - wall */
    double branch[3];        /* m: to the centre of a from that of b, or from the nearest point of the wall */
    double overlap;          /* m */
    double push[3], drag[3]; /* N, on a: along the normal and along the tangent */
};
struct dem_moment {                      /* all grains and contacts at one time */
    int n, nold;                         /* grains; and at the start of the run of the grains: numbers are 1 .. nold */
    int *id;                             /* [nold], ascending */
    double (*x)[3], (*u)[3], (*spin)[3]; /* [nold] m, m/s, 1/s */
    long ncontacts, room;
    struct dem_contact *contact;
};
status dem_moment_make(int n, struct dem_moment *out); /* without contacts */
void dem_moment_free(struct dem_moment *m);

struct dem_law { /* what moves the grains; walls and gravity outlive the engine */
    double diameter, mass;
    struct contact_law pair;
    const struct dem_walls *walls;
    const struct sources *gravity; /* constant amplitude */
};
struct dem_engine;
/* Starts LAMMPS on some ranks (asked: as lammps_start) from grains, for which it writes FOLDER/grains.data, or from a
 * restart file (start NULL). The commands are kept as FOLDER/in.lammps, with which lmp runs without haff. */
status dem_engine_make(const struct dem_law *law, int ranks, bool (*asked)(void), const char *folder,
                       const struct dem_moment *start, const char *restart, struct dem_engine **out);
void dem_engine_free(struct dem_engine *e);

/* Sets the time (s) and the length of the steps that follow. With a new length, or `anew`, LAMMPS begins once more from
 * a restart file of its own, FOLDER/grains.restart. */
void dem_engine_pace(struct dem_engine *e, double t, double dt, bool anew);
status dem_engine_run(struct dem_engine *e, long steps);
status dem_engine_moment(struct dem_engine *e, struct dem_moment *out);
/* Writes a restart file. The run then goes on from one of its own, so that it has the bits of one that starts there. */
status dem_engine_save(struct dem_engine *e, const char *path);

#endif
