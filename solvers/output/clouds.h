/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains as an OpenFOAM cloud, TIME/lagrangian/grains: `positions` (Cloud<passiveParticle>, always ascii) and fields
 * U, id, d, of rough grains also omega, of a mixture also species, beside it, which foamToVTK and ParaView read. */
#ifndef SOLVERS_CLOUDS_H
#define SOLVERS_CLOUDS_H

#include "mesh/format/polymesh.h"
#include "solvers/case/checksums.h"
#include "solvers/output/vtk.h"

struct cloud { /* a zeroed cloud has no grains */
    int n;
    double (*x)[3];    /* [n] m, along physical axes */
    double (*u)[3];    /* [n] m/s; NULL: the file is not there */
    double (*spin)[3]; /* [n] 1/s; NULL: the grains are smooth, or the file is not there */
    int *cell;         /* [n] polyMesh cell */
    int *id;           /* [n]; NULL: 0 .. n-1 */
    double diameter;   /* m; 0: not known */
    double *size;      /* [n] diameters over that; NULL: all are alike */
    int *species;      /* [n] number of the kind, from 0; NULL: all are alike, or the file is not there */
};
status cloud_make(int n, struct cloud *out); /* allocates x, u and cell */
void cloud_free(struct cloud *c);

/* Writes the cloud into the folder of a time that is being written; location is the time's name. */
status cloud_write(const struct cloud *c, const char *folder, const char *location, const struct foam_format *f,
                   struct checksums *sums);
bool cloud_exists(const char *time_folder); /* is there lagrangian/grains/positions? */
/* Reads a cloud. Fails with ERR_INPUT, file and line on words that are no numbers, on cells that the mesh does not
 * have, and on fields of another length. */
status cloud_read(const char *time_folder, int ncells, struct cloud *out);
/* Writes VTK of the grains; for the series call vtk_series_write with the name NAME-grains. */
status cloud_write_vtk(const struct cloud *c, const char *folder, const char *name, const char *time,
                       enum vtk_form form, double t, long step);

#endif
