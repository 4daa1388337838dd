/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIME/uniform/softGrains: what a restart of granularDEM needs beside the restart file of LAMMPS, uniform/lammps: the
 * grains, sums of the averages, energies. The file has a header as OpenFOAM's, then native binary. */
#ifndef SOLVERS_DEM_STATE_H
#define SOLVERS_DEM_STATE_H

#include "mesh/base/pool.h"
#include "mesh/format/foamfile.h"
#include "solvers/dem/dem_engine.h"
#include "solvers/grains/grains_averages.h"

struct dem_account {              /* since the run of the grains began */
    double t;                     /* s: time reached */
    double speed;                 /* m/s: impactSpeed */
    double energy;                /* J: all that the grains had at the start */
    double normal, tangent, drag; /* J: integrals of the losses in struct dem_sums */
    double work;                  /* J: of walls that move */
};
enum { DEM_LAW = 512 };
struct dem_state {
    int n, nold;
    struct dem_account account;
    double law[DEM_LAW]; /* numbers of box, contacts and gravity, as dem_state_law gives them */
    int *id;             /* [n] */
    double *list[3];     /* [n][3]: places, velocities, spins */
    struct averages_saved averages;
    struct pool pool; /* has the lists of a state that was read */
};
void dem_state_law(const struct dem_law *law, double out[DEM_LAW]);
status dem_state_write(const struct dem_state *s, const char *path, const char *location, bool compress,
                       struct file_sum *sum);
/* Reads a state; the caller calls dem_state_free, also after an error. */
status dem_state_read(const char *path, struct dem_state *out);
void dem_state_free(struct dem_state *s);

#endif
