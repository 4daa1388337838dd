/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiles trees_flat.c for p8est: the trees of 3D lattices. */
#include <p4est_to_p8est.h>

#include "mesh/lattice/trees_flat.c"
