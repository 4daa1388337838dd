/* A polyhedral mesh as OpenFOAM stores it: faces with owner and neighbour, internal faces first in upper-triangular
 * order, then the patches. It is the input of every run, whatever engine then solves on it. */
#ifndef MESH_POLYMESH_H
#define MESH_POLYMESH_H

#include "mesh/base/status.h"
#include "mesh/format/foamfile.h"

struct patch {
    char *name;
    char *type;      /* patch wall empty cyclic symmetry symmetryPlane */
    char *neighbour; /* of a cyclic: the name of its other half; else NULL */
    int start;       /* first face */
    int nfaces;
};
struct polymesh {
    int npoints, nfaces, ninternal, ncells, npatches;
    double *points;      /* [npoints][3] m */
    int *face_start;     /* [nfaces + 1] into face_points */
    int *face_points;    /* right-handed about the normal, which points from owner to neighbour, or out */
    int *owner;          /* [nfaces] cell */
    int *neighbour;      /* [ninternal] cell, > owner */
    struct patch *patch; /* [npatches] */
};
void polymesh_free(struct polymesh *m);

/* DIR is the polyMesh folder. Reading takes ascii, binary, .gz, and validates every index and order; errors name file
 * and line. Writing replaces the files one by one, each atomically. */
status polymesh_read(const char *dir, struct polymesh **out);
status polymesh_write(const struct polymesh *m, const char *dir, const struct foam_format *format);

/* Sorts faces to OpenFOAM's order from faces in any order (owner, neighbour = -1 on the boundary, patch_of_face);
 * flips what points the wrong way, pairs cyclic halves by geometry. */
status polymesh_order(struct polymesh *m, const int *patch_of_face);

/* Geometry by decomposition into triangles and pyramids, as OpenFOAM does it. Arrays are the caller's. */
void polymesh_face_geometry(const struct polymesh *m, double *centre /* [nfaces][3] */, double *area /* [nfaces][3] */);
status polymesh_cell_geometry(const struct polymesh *m, const double *face_centre, const double *face_area,
                              double *centre /* [ncells][3] */, double *volume /* [ncells] */);

/* The faces of every cell, ascending: start[ncells + 1] into face[]; both the caller's to free. */
status polymesh_cell_faces(const struct polymesh *m, int **start, int **face);

enum { POLYMESH_SHAPES = 128 };
/* "12 prisms, 3 hexahedra" */
status polymesh_shapes(const struct polymesh *m, char text[POLYMESH_SHAPES]);

/* The axes that `empty` patches leave, ascending; returns how many. For a mesh that passes polymesh_check. */
int polymesh_axes(const struct polymesh *m, int axis[3]);

/* Coordinates whose third powers, the volumes, are finite numbers. */
status polymesh_check_points(const struct polymesh *m);

/* Closed cells, positive volumes, face orientation, `empty` patches that cover every cell exactly twice, cyclic halves
 * that match, no left-over defaultFaces: what a run needs and more. Each defect is an error with number and place. */
status polymesh_check(const struct polymesh *m);

int polymesh_find_patch(const struct polymesh *m, const char *name); /* -1: none */
unsigned long polymesh_checksum(const struct polymesh *m);           /* of points, faces, owner, neighbour, patches */

#endif
