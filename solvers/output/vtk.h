/* SPDX-License-Identifier: GPL-3.0-or-later */
/* VTK files of a polyMesh with cell data, and the series that list them: legacy files (version 3.0, binary big-endian
 * or ascii), or XML files (.vtu) whose arrays are compressed. */
#ifndef SOLVERS_VTK_H
#define SOLVERS_VTK_H

#include "mesh/format/polymesh.h"

/* The mesh as VTK cells: tetrahedra, pyramids, wedges and hexahedra are recognised, all other cells are polyhedra. */
struct vtk_grid;
status vtk_grid_make(const struct polymesh *m, struct vtk_grid **out); /* borrows m */
void vtk_grid_free(struct vtk_grid *g);

enum vtk_form { VTK_BINARY, VTK_ASCII, VTK_XML };
const char *vtk_ending(enum vtk_form form); /* of the name of a file: ".vtk" or ".vtu" */

struct vtk_field {
    const char *name;
    int components;       /* 1 or 3 */
    const double *values; /* [ncells][components] */
};
/* Writes the mesh with fields, to a temporary name that is then renamed; t in s. */
status vtk_write(const struct vtk_grid *g, const char *path, enum vtk_form form, double t, long step, int nfields,
                 const struct vtk_field *fields);

/* Writes n points x[n][3], each a vertex, with fields values[n][components]; POLYDATA where the file is legacy. */
status vtk_write_points(const char *path, enum vtk_form form, double t, long step, int n, const double *x, int nfields,
                        const struct vtk_field *fields);

struct vtk_polygons {
    int npoints, n;
    const double *x;           /* [npoints][3] m */
    const int *start, *around; /* [n + 1] into around; points of each polygon. start may be NULL for n = 0 */
};
/* Writes POLYDATA of polygons, with fields at their points or, if `in_polygons`, in them. */
status vtk_write_polygons(const char *path, bool ascii, double t, long step, const struct vtk_polygons *p,
                          bool in_polygons, int nfields, const struct vtk_field *fields);

/* Stands in the second line of a file, before its time with all digits. */
#define VTK_TITLE "haff, time "
/* Writes FOLDER/NAME.vtk.series of the files FOLDER/NAME_*.vtk (ending: ".vtk", or another) whose time is at most
 * `latest`, ascending: files left by an earlier run that went further stay out. */
status vtk_series_write(const char *folder, const char *name, const char *ending, double latest);

#endif
