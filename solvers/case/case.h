/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case that is read and checked: a run starts from it, -dry-run and checkCase stop at it. */
#ifndef SOLVERS_CASE_H
#define SOLVERS_CASE_H

#include "mesh/format/files.h"
#include "mesh/grid/grid.h"
#include "solvers/case/medium.h"
#include "solvers/case/times.h"
#include "solvers/case/warnings.h"

enum { MAX_FILES = 8 };
struct setup_file { /* one dictionary of the case */
    const char *folder, *name;
    struct dict *dict; /* NULL: the file is not there */
};
struct setup { /* the same on every rank, but for the grid */
    const struct comm *comm;
    int ranks; /* of a program that the medium starts */
    char dir[TIME_PATH];
    struct folder_mark mark; /* of that folder */
    char name[256];          /* name of the folder, for file names */
    struct control *control;
    struct warnings warnings;
    struct polymesh *mesh;
    struct dict *mesh_dict;    /* system/meshDict; NULL: there is none */
    char mesh_path[TIME_PATH]; /* of the folder or file that says it */
    struct spread *spread;     /* of a mesh that is spread over the ranks, until setup_release; else NULL */
    /* [ncells][3] m, [ncells] m^3: of the cells. On lattices, and of a mesh that is spread, they are there after
     * setup_complete; setup_volume and setup_place do without. */
    double *centre, *volume;
    bool wanted;       /* has someone asked for them for the whole run? */
    bool kept;         /* did the one rank keep the arrays of a lattice's polyMesh, for who draws it? */
    double first[3];   /* m: the centre of cell 0, for axes of one cell */
    double *face_area; /* [nfaces][3] m^2 of a mesh that is no lattice, as polymesh_face_geometry; NULL once the state
                        * is read */
    unsigned long checksum;
    int dim, axis[3]; /* the solved axes; behind them those along which the medium moves all the same, then the rest */
    int components;   /* of a vector, along axis[]; dim unless the medium sets it in `state` */
    struct lattice *lattice; /* NULL: the mesh is no lattice, and `why` says the reason */
    char why[256];
    /* a forest (the lattice cut into tiles) if the mesh is a lattice and the medium does not ask for polyhedra; else
     * polyhedra */
    struct grid *grid;
    int nfiles;
    struct setup_file file[MAX_FILES]; /* the medium's dictionaries, for log, provenance and changes.h */
    struct medium *medium;
    struct instant start;
};
struct case_reading {
    bool strict;         /* are warnings errors? */
    bool afresh;         /* does the run start from 0.orig, whatever startFrom says? */
    struct cures *cures; /* gets those of the warnings; NULL: none are wanted */
    int ranks;           /* of a program that the medium starts (medium_type.starts); 0: one */
};
/* Reads and checks the case in `dir` for a type of medium, and the state it starts from. Collective. */
status case_read(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c,
                 struct setup **out);
void case_free(struct setup *s);
/* Returns the number of lines, along axis[], that a quantity's values have in the medium's `block`. */
int setup_lines(const struct setup *s, int quantity);
/* Makes the arrays of the mesh, of its lattice (but for faces after setup_grid) and of its cells that are not there,
 * for what reads them; local. */
status setup_complete(const struct setup *s);
/* The same for the start of a run alone: setup_release, when that is over, frees them again where the mesh is spread.
 * Before the medium takes its memory, when function objects have found their points, setup_settle frees what is needed
 * no more but volumes of cells. */
status setup_borrow(const struct setup *s);
void setup_settle(struct setup *s);
void setup_release(struct setup *s);
/* Of a cell, m^3. Where the mesh is spread, the cell must be of this rank's slice. */
double setup_volume(const struct setup *s, long cell);
void setup_place(const struct setup *s, long cell, double x[3]); /* the centre of any cell (m). Collective */
/* Makes s->grid; a polyhedral one has stencils of `rings` rings and, if `sized`, its cells in the order
 * of their sizes. Collective. */
status setup_grid(struct setup *s, bool polyhedral, int rings, bool sized);
/* Before anything is made in the case: fails if its folder is gone, or another one stands in its place. */
status case_here(const struct setup *s);
status case_make_folders(const struct setup *s, const char *path); /* the same, then makes the folder and its parents */
/* Opens CASE/postProcessing/OWNER/FOLDER/FILE for writing, and makes its folders. On the root. */
status case_table(const struct setup *s, const char *owner, const char *folder, const char *file, FILE **out);
/* Ends a row of such a file and hands it to the system; fails if that has no room for it. */
status case_end_row(const char *owner, FILE *file);

/* ---- bodies of revolution (solvers/case/round.c; docs/physics.md 1.4) ---- */

/* Reads `axis { origin (0 0 0); direction (1 0 0); }` of system/meshDict: sets s->mesh->round and s->mesh_dict, behind
 * the axes of the mesh. Refuses, by line, an axis that is none of the mesh: oblique, of 3D cells, across the plane; and
 * a mesh across it or below it, cyclic across the radius, or with another patch than a symmetry plane on it. */
status round_read(struct setup *s);
/* Returns the error of `what`, which the solver does not know in round flow; cure: what to do. */
status round_refuse(const struct setup *s, const char *what, const char *cure);
struct keywords;
void round_keywords(struct keywords *k);

/* Returns about how many bytes a run needs on all ranks together. */
double case_memory(const struct setup *s);

#endif
