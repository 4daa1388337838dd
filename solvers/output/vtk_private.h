/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the writers of legacy and of XML files of VTK share. */
#ifndef SOLVERS_VTK_PRIVATE_H
#define SOLVERS_VTK_PRIVATE_H

#include "mesh/format/foamfile.h"
#include "solvers/output/vtk.h"

enum { VERTEX = 1, TETRAHEDRON = 10, HEXAHEDRON = 12, WEDGE = 13, PYRAMID = 14, POLYHEDRON = 42 };

struct vtk_grid {
    const struct polymesh *mesh;
    int *cell_start, *cell_faces; /* [ncells + 1]; faces of each cell */
    int *type;                    /* [ncells] VTK's cell type */
    int *start;                   /* [ncells + 1] into ids */
    int *ids;                     /* of each cell the number of its points, then these; or VTK's face stream */
};

/* Writes the first lines of an XML file, whose second line has the time, as that of a legacy file has. */
void vtu_head(struct sink *o, const char *kind, bool compressed, double t, long step);

/* Write what vtk_write and vtk_write_points write, as compressed UnstructuredGrid; points are cells of one vertex. */
status vtu_write(const struct vtk_grid *g, const char *path, double t, long step, int nfields,
                 const struct vtk_field *fields);
status vtu_write_points(const char *path, double t, long step, int n, const double *x, int nfields,
                        const struct vtk_field *fields);

#endif
