/* The lines of coefficients in struct diffuser's `face` (libcore/lattice/tiles.h). */
#ifndef LIBCORE_TILES_FACES_H
#define LIBCORE_TILES_FACES_H

/* Of a face of an axis, h the width of a cell there: (lambda + 2 mu)/h^2, mu/h^2, heat/h^2. */
enum { NORMAL, SHEAR, CONDUCTION, FACE_LINES };

#endif
