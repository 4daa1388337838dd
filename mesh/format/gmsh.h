/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads gmsh's .msh files (2.2 and 4.1, ascii and binary) and makes a polyMesh of them.
 *
 * Volume elements give a 3D mesh, physical surfaces its patches. A file with surface elements only must lie in a plane
 * normal to an axis and is extruded by one cell towards that axis (thickness sqrt(area / cells)), physical curves
 * become the patches, `back` (lower) and `front` (upper) are added as `empty`. A file with lines only must lie along an
 * axis and is extruded twice (thickness length / cells), physical points become the end patches, `sides` is added as
 * `empty`. Patches stand in the order of $PhysicalNames; groups of cells are not kept.
 *
 * The type of a patch comes from the rule of that name; without a rule a name that begins with `wall` gives wall, a
 * name that begins with `empty` gives empty, all other names patch. cyclic always needs rules (each half names the
 * other). */
#ifndef MESH_GMSH_H
#define MESH_GMSH_H

#include "mesh/format/polymesh.h"

struct gmsh_rule {
    const char *patch;
    const char *type;      /* patch wall empty cyclic symmetry symmetryPlane */
    const char *neighbour; /* the other half of a cyclic patch; else NULL */
    const char *where;     /* "FILE:LINE" for messages */
};

/* Reads the mesh in the file `path`. Fails, and says the cure, on everything that gmsh lets pass although it would make
 * another mesh than the one meant: no physical groups, a boundary without a group or with two, names that no dictionary
 * can hold, elements of higher order, missing volume elements, format 4.0, truncated files, wrong counts, cyclic halves
 * that do not match. */
status gmsh_read(const char *path, const struct gmsh_rule *rules, int nrules, struct polymesh **out);
/* The same with the length, m, by which meshes of surfaces and lines are extruded (0: as above). */
status gmsh_read_thick(const char *path, const struct gmsh_rule *rules, int nrules, double thickness,
                       struct polymesh **out);

#endif
