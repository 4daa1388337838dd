/* Everything a case holds, read and checked: what -dry-run and checkCase stop at, and a run starts from. */
#ifndef SOLVERS_CASE_H
#define SOLVERS_CASE_H

#include "mesh/grid.h"
#include "solvers/control.h"
#include "solvers/initial.h"
#include "solvers/models.h"

struct setup { /* the same on every rank, the grid apart */
    const struct comm *comm;
    char dir[TIME_PATH];
    char name[256]; /* of the folder, for file names */
    struct control *control;
    struct polymesh *mesh;
    double *centre, *volume; /* [ncells][3] m, [ncells] m^3 */
    unsigned long checksum;
    struct lattice *lattice; /* NULL: the mesh is none, see why */
    char why[256];
    struct grid *grid; /* of a forest where the mesh is a lattice and fvSchemes does not ask for a mosaic */
    struct case_models *models;
    struct instant start;
    struct initial *initial;
};
/* Is maxCo one that the time scheme allows? */
status case_courant(const struct control *c, const struct stepper *stepper);
/* Collective. */
status case_read(const char *dir, const char *application, const struct comm *c, struct setup **out);
void case_free(struct setup *s);
/* The gas on the case's grid, without a state. Collective. */
status case_gas(const struct setup *s, struct gas **out);
/* Bytes a run needs on all ranks together, about. */
double case_memory(const struct setup *s);

#endif
