/* Everything a case holds, read and checked: what -dry-run and checkCase stop at, and a run starts from. */
#ifndef SOLVERS_CASE_H
#define SOLVERS_CASE_H

#include "mesh/grid/grid.h"
#include "solvers/case/medium.h"
#include "solvers/case/times.h"

enum { MAX_FILES = 8 };
struct setup_file { /* a dictionary of the case */
    const char *folder, *name;
    const struct dict *dict; /* NULL: not there */
};
struct setup { /* the same on every rank, the grid apart */
    const struct comm *comm;
    char dir[TIME_PATH];
    char name[256]; /* of the folder, for file names */
    struct control *control;
    struct polymesh *mesh;
    double *centre, *volume; /* [ncells][3] m, [ncells] m^3 */
    unsigned long checksum;
    int dim, axis[3];        /* the solved axes */
    struct lattice *lattice; /* NULL: the mesh is none, see why */
    char why[256];
    struct grid *grid; /* of a forest where the mesh is a lattice and the medium does not ask for polyhedra */
    int nfiles;
    struct setup_file file[MAX_FILES]; /* the medium's dictionaries, for log, provenance and changes.h */
    struct medium *medium;
    struct instant start;
};
/* Collective. */
status case_read(const char *dir, const struct medium_type *type, const struct comm *c, struct setup **out);
void case_free(struct setup *s);
/* s->grid, of the given rings where it is polyhedral. Collective. */
status setup_grid(struct setup *s, bool polyhedral, int rings);
/* Bytes a run needs on all ranks together, about. */
double case_memory(const struct setup *s);

#endif
