/* Grains as an OpenFOAM cloud, TIME/lagrangian/grains: `positions` (Cloud<passiveParticle>, always ascii) and fields
 * U, id, d beside it, which foamToVTK and ParaView read. */
#ifndef SOLVERS_CLOUDS_H
#define SOLVERS_CLOUDS_H

#include "mesh/format/polymesh.h"
#include "solvers/case/checksums.h"

struct cloud { /* zeroed: none */
    int n;
    double (*x)[3];  /* m, physical axes, as all here */
    double (*u)[3];  /* m/s; NULL: not there */
    int *cell;       /* polyMesh's */
    int *id;         /* NULL: 0 .. n-1 */
    double diameter; /* m; 0: not known */
};
status cloud_make(int n, struct cloud *out); /* all but id, not filled */
void cloud_free(struct cloud *c);

/* Into the folder of a time that is being written; location: the time's name. */
status cloud_write(const struct cloud *c, const char *folder, const char *location, const struct foam_format *f,
                   struct checksums *sums);
bool cloud_exists(const char *time_folder); /* is there lagrangian/grains/positions? */
/* ERR_INPUT names file and line: what is no number, a cell that the mesh has not, fields of another length. */
status cloud_read(const char *time_folder, int ncells, struct cloud *out);
/* Legacy VTK POLYDATA; series: vtk_series_write with the name NAME-grains. */
status cloud_write_vtk(const struct cloud *c, const char *folder, const char *name, const char *time, bool ascii,
                       double t, long step);

#endif
