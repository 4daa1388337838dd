/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The run of soft grains behind the medium granularDEM: start, pieces of time, samples, account of the energy. */
#ifndef SOLVERS_DEM_RUN_H
#define SOLVERS_DEM_RUN_H

#include "solvers/case/case.h"
#include "solvers/dem/dem_state.h"
#include "solvers/dem/dem_sums.h"
#include "solvers/grains/grains_medium.h"
#include "solvers/grains/grains_start.h"
#include "solvers/grains/grains_state.h"

struct dem_span { /* steps of one length up to a time at which something is due */
    double from, to, dt;
    long n, done;
};
struct dem_run {
    const struct setup *setup;
    struct grains_models *models;
    struct grains_start start;
    struct grains_mesh *mesh; /* NULL: a lattice of equal boxes */
    struct dem_walls walls;
    struct dem_law law;
    struct dem_state saved;        /* n = 0: the start has none; freed once it is used */
    bool kept, changed;            /* do averages go on? have laws or box changed since the saved state? */
    bool lammps;                   /* is it there, with all that it needs? */
    bool from_cloud;               /* were the grains read from lagrangian/grains? */
    struct packing_report packing; /* else: how they were placed */
    struct dem_engine *engine;     /* NULL before the first step */
    struct averages *averages;
    struct dem_account account;
    struct dem_moment moment; /* grains at the time moment_t */
    double moment_t;
    struct coarse_contact *stress; /* [stresses] its contacts */
    long stresses;
    struct dem_sums sums; /* of that moment */
    struct dem_span span;
    double longest; /* s: the longest step allowed */
    double spent;   /* s of the clock in LAMMPS, without samples; steps: done in them */
    double pace;    /* steps a second of the clock in the last piece: LAMMPS may have been stopped in one before */
    double sampled; /* s of the clock in samples */
    long steps;
};
/* Checks case and laws and reads the start. */
status dem_run_state(struct setup *s, struct dem_run *r);
status dem_run_start(struct dem_run *r); /* places the grains; starts no LAMMPS */
void dem_run_free(struct dem_run *r);
double dem_run_energy(const struct dem_run *r);   /* J: all that the grains had at the moment */
double dem_run_friction(const struct dem_run *r); /* J: what friction took up to there */

/* Advances one piece of at most some tenths of a second of the clock towards `until`. *sampled: was a sample taken? */
status dem_run_piece(struct dem_run *r, double until, bool *sampled);
status dem_run_look(struct dem_run *r); /* takes the present moment, unless it is there */
status dem_run_save(struct dem_run *r, const char *folder, const char *location, struct checksums *sums);
struct averages_moment dem_run_averaged(const struct dem_run *r);

#endif
