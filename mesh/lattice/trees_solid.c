#include <p4est_to_p8est.h>

#include "mesh/lattice/trees_flat.c"
