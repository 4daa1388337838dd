/* SPDX-License-Identifier: GPL-3.0-or-later */
/* VTK files in pieces: each rank writes its cells into a .vtu file of its own, and the root an index, .pvtu, that
 * ParaView opens. No rank holds more than its cells. For lattices. */
#ifndef SOLVERS_VTK_PIECES_H
#define SOLVERS_VTK_PIECES_H

#include "solvers/case/case.h"

/* Writes FOLDER/NAME.pvtu with the quantities (ended by -1), and FOLDER/NAME/RANK.vtu of each rank that has cells.
 * Collective. */
status vtk_pieces_write(const struct setup *s, const char *folder, const char *name, double t, long step,
                        const int *quantity);

#endif
