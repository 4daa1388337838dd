#include <p4est_to_p8est.h>

#include "mesh/trees_flat.c"
