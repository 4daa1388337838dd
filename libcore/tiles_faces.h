/* The lines of coefficients in struct diffuser's `face` (libcore/state.h). */
#ifndef LIBCORE_TILES_FACES_H
#define LIBCORE_TILES_FACES_H

/* Of a face of an axis, h the width of a cell there: (lambda + 2 mu)/h^2, lambda/h, mu/h^2, mu/h, heat/h^2. Jumps take
 * the squares, and the others the sum of both sides' tangential derivatives halved, as `gradient` holds them. */
enum { NORMAL, CROSS, SHEAR, TWIST, CONDUCTION, FACE_LINES };

#endif
