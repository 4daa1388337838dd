/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polyhedral mesh as OpenFOAM stores it: faces with owner and neighbour, internal faces first in upper-triangular
 * order, then the patches. It is the input of every run, whatever engine then solves on it. A mesh that is said by
 * boxes (boxes.h) has counts and patches only, until polymesh_complete makes the rest for what reads it; so has a mesh
 * that is spread over the ranks (outline). */
#ifndef MESH_POLYMESH_H
#define MESH_POLYMESH_H

#include "mesh/base/status.h"
#include "mesh/format/foamfile.h"

struct patch {
    char *name;
    char *type;      /* patch wall empty cyclic symmetry symmetryPlane; as read also wedge (mesh/spread/wedge.h) */
    char *neighbour; /* name of a cyclic patch's other half; else NULL */
    int start;       /* first face */
    int nfaces;
    char *groups;     /* the groups that it is in by inGroups, with blanks between; NULL: none */
    const char *said; /* the type in the files, where that is another one; else NULL */
};
struct boxes;
struct sites;
struct narrowest {
    long cell;
    double width; /* m: its V/A, A without `empty` faces: the least of all */
    double ratio; /* of that to the median; where it is above 1e-3, a lower bound */
};
/* What is known of a mesh whose arrays are spread over the ranks (mesh/spread/spread.h), the same on every rank. */
struct outline {
    char *dir; /* the folder that it is read from once more where the arrays are wanted (polymesh_complete) */
    double low[3], high[3]; /* corners of the box around all points, m */
    bool closed[3];         /* axes that `empty` patches close */
    unsigned long sum;      /* CRC-32 of points, faces, owner, neighbour */
    long shape[5];          /* cells of each shape (polymesh_shapes) */
    int **cell;             /* [patches][faces] cell at a face of a patch that is not empty */
    double **face;          /* [patches][faces][6] its centre (m) and area vector (m^2) */
    struct sites *sites;    /* of a mesh that is a lattice: where its cells lie; else NULL */
};
/* The body of revolution that a mesh in a plane of (axial, radial) cells, or one of radial cells, stands for
 * (docs/physics.md 1.4). */
struct revolution {
    bool on;           /* else the mesh is what it is, and the rest is 0 */
    int axial, radial; /* physical axes (0 x, 1 y, 2 z) */
    double at, depth;  /* m: where the axis lies along `radial`; the extent of the mesh along the third axis */
};
/* Returns by how much an area or a volume of the mesh with the centre x (m) is larger in a full turn: exact, by
 * Pappus's theorem. */
static inline double round_turn(const struct revolution *r, const double x[3]) {
    return r->on ? 6.283185307179586477 * (x[r->radial] - r->at) / r->depth : 1;
}
struct polymesh {
    /* before polymesh_complete npoints is 0, and numbers of faces beyond INT_MAX are INT_MAX */
    int npoints, nfaces, ninternal, ncells, npatches;
    double *points;      /* [npoints][3] m */
    int *face_start;     /* [nfaces + 1] into face_points */
    int *face_points;    /* [face_start[nfaces]] right-handed about the normal, which points from owner to neighbour, or
                            out */
    int *owner;          /* [nfaces] cell */
    int *neighbour;      /* [ninternal] cell, > owner */
    struct patch *patch; /* [npatches] */
    struct boxes *boxes; /* NULL: the mesh was read from a polyMesh */
    struct outline *outline; /* NULL: the arrays are here, or those of boxes */
    struct revolution round; /* set by who reads the case */
};
void polymesh_free(struct polymesh *m);

/* Read and write the polyMesh folder `dir`. Reading takes ascii, binary and .gz, and validates every index and order;
 * errors name file and line. Writing replaces the files one by one, each atomically. */
status polymesh_read(const char *dir, struct polymesh **out);
status polymesh_write(const struct polymesh *m, const char *dir, const struct foam_format *format);
/* Reads the patches alone, of a mesh whose counts are known. */
status polymesh_read_patches(const char *dir, struct polymesh *m);

/* Sorts faces that come in any order (owner, neighbour = -1 on the boundary, patch_of_face) to OpenFOAM's order, flips
 * those that point the wrong way, and pairs cyclic halves by geometry. */
status polymesh_order(struct polymesh *m, const int *patch_of_face);

/* Compute centres (m), area vectors (m^2) and volumes (m^3) by decomposition into triangles and pyramids, as OpenFOAM
 * does. The arrays are the caller's; only memory can be missing. */
void polymesh_one_face(const struct polymesh *m, int face, double centre[3], double area[3]);
void polymesh_face_geometry(const struct polymesh *m, double *centre /* [nfaces][3] */, double *area /* [nfaces][3] */);
status polymesh_cell_geometry(const struct polymesh *m, const double *face_centre, const double *face_area,
                              double *centre /* [ncells][3] */, double *volume /* [ncells] */);

struct polymesh_geometry {           /* all of that, as computed by the functions above */
    double *face_centre, *face_area; /* [nfaces][3] */
    double *cell_centre, *volume;    /* [ncells][3], [ncells] */
};
/* The caller frees g, also after an error. */
status polymesh_geometry_make(const struct polymesh *m, struct polymesh_geometry *g);
void polymesh_geometry_free(struct polymesh_geometry *g);
/* Makes the arrays of a mesh of boxes, or reads those of a mesh that is spread, if they are not there yet; local. */
status polymesh_complete(struct polymesh *m);
void polymesh_drop(struct polymesh *m); /* frees the arrays of a mesh that is spread */
/* The cell at face i of a patch; centre (m) and area vector (m^2) of that face. They need no arrays of a mesh of
 * boxes, nor of one that is spread if the patch is not empty. */
int polymesh_patch_cell(const struct polymesh *m, int patch, int i);
void polymesh_patch_face(const struct polymesh *m, int patch, int i, double centre[3], double area[3]);

/* Lists the faces of every cell, ascending: start[ncells + 1] into face[]. The caller frees both, also after an
 * error. */
status polymesh_cell_faces(const struct polymesh *m, int **start, int **face);

enum { POLYMESH_SHAPES = 128 };
/* Counts cells by shape and writes for example "12 prisms, 3 hexahedra". */
status polymesh_shapes(const struct polymesh *m, char text[POLYMESH_SHAPES]);
/* Counts the cells of each shape, those of `counted` (NULL: all). */
status polymesh_count_shapes(const struct polymesh *m, const bool *counted, long total[5]);

/* Finds the axes (0 x, 1 y, 2 z) that `empty` patches leave, ascending; returns how many. The mesh must pass
 * polymesh_check. */
int polymesh_axes(const struct polymesh *m, int axis[3]);

/* Widens the box from low to high (m) to one that holds n points, too. */
void points_bounds(long n, const double *points, double low[3], double high[3]);
/* Finds the corners of the box around all points, m. */
void polymesh_bounds(const struct polymesh *m, double low[3], double high[3]);
/* The file that says the patches, for messages: constant/polyMesh/boundary or system/blockMeshDict. */
const char *polymesh_boundary_file(const struct polymesh *m);

/* Fails on coordinates so large that volumes would overflow. */
status polymesh_check_points(const struct polymesh *m);

/* Sets width[ncells] to the V/A of the cells. Finds the narrowest cell. Area and volume are those of
 * polymesh_face_geometry and polymesh_cell_geometry. */
void polymesh_widths(const struct polymesh *m, const double *area, const double *volume, double *width);
status polymesh_narrowest(const struct polymesh *m, const double *area, const double *volume, struct narrowest *out);

/* Checks what a run needs and more: closed cells, positive volumes, none 1e-12 times as narrow as the others, face
 * orientation, `empty` patches that cover every cell exactly twice, cyclic halves that match. Each defect is an error
 * with number and place. A mesh of boxes has none of them. */
status polymesh_check(const struct polymesh *m);
/* Does that and leaves the geometry on which it rests in g, which the caller frees, also after an error. A mesh of
 * boxes must be complete (polymesh_complete). */
status polymesh_check_geometry(const struct polymesh *m, struct polymesh_geometry *g);

/* Checks a part of a mesh in that way, but for how narrow cells are: the cells that are `whole`, and the faces between
 * any. In g centres of all cells must be right; closed: axes that empty patches of the whole mesh close; offset:
 * [npatches] from the first face of a cyclic patch to that of its other half, m. */
status polymesh_check_part(const struct polymesh *m, const struct polymesh_geometry *g, const bool *whole,
                           const bool closed[3], const double (*offset)[3]);

/* Is a patch in a group (OpenFOAM's inGroups)? Each is in that of its type, but those of type `patch`. */
bool patch_in_group(const struct patch *p, const char *group);
void patch_write_groups(struct sink *s, const struct patch *p);      /* the entry inGroups of a boundary file */
int polymesh_find_patch(const struct polymesh *m, const char *name); /* -1: none */
unsigned long polymesh_checksum(const struct polymesh *m); /* CRC-32 of points, faces, owner, neighbour, patches */

#endif
