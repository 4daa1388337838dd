/* Inside of diffusion on polyhedra: the memory of libcore/polyhedral/cells_diffusion.c. */
#ifndef LIBCORE_CELLS_DIFFUSER_H
#define LIBCORE_CELLS_DIFFUSER_H

#include "libcore/polyhedral/cells_gradient.h"

struct cells_diffuser {                  /* lines of [size], a batch longer, or of [faces] */
    double *sum[2][MAX_DIM];             /* S of the last stage, and of the one before */
    double *start[MAX_DIM];              /* q_0 */
    double *gradient[MAX_DIM * MAX_DIM]; /* dS_c/dx_k at k dim + c */
    double *cell[3];                     /* bulk, shear, heat */
    double *T;                           /* T at which the coefficients were taken */
    double *warm;                        /* T of the coefficients, then T(to)/T (diffusion_hooks.ahead) */
    double *drag, *wall;                 /* [mirrors] shares of wall_shares, of drag and of heat; 0 where none */
    double *lift;                        /* [mirrors] what friction on a wall adds to T beyond it */
    bool slides;                         /* does gas slip along any wall that drags it? */
    double *mark;                        /* > 0 in cells that were not admissible */
    double *face[3];                     /* lambda, shear, heat times the area */
    double *inverse;                     /* 1/(n.e) */
    double *share;         /* fraction of the way from the left centre to the right one that lies before the face */
    double *rest[MAX_DIM]; /* r = n - e/(n.e) */
    bool skewed;           /* is any r not 0? */
    bool marked;           /* is any mark up? */
    int last;              /* which of the two sums is that of the last stage */
    struct rows weights;   /* of the gradients */
};

#endif
