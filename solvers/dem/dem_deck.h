/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands with which LAMMPS moves soft grains. */
#ifndef SOLVERS_DEM_DECK_H
#define SOLVERS_DEM_DECK_H

#include "solvers/dem/dem_engine.h"

/* Writes the commands up to the first run to *out, which the caller frees: from a data file, or from a restart file.
 * Walls of triangles lie in `folder`. */
status dem_deck(const struct dem_law *law, const char *folder, const char *data, const char *restart, char **out);
/* Columns of its dumps `grains`, `walls` and `contacts`. Of grains: number, place, velocity, spin. Of grains that touch
 * a wall: number; per wall: is there a contact, and its force. Of contacts: the two numbers, the force along the
 * normal, the one along the tangent. Without walls there is no dump of them; walls of triangles are one. */
enum { DEM_COLUMNS = 10, DEM_WALL_COLUMNS = 4, DEM_CONTACT_COLUMNS = 8 };
/* Writes the triangles of each wall as FOLDER/wall0.stl .. */
status dem_deck_surface(const struct dem_walls *w, const char *folder);
/* Writes a data file of the grains. */
status dem_deck_data(const struct dem_law *law, const struct dem_moment *grains, const char *path);

#endif
