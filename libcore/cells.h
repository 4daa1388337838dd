/* Inside of the gas on a mosaic: what cells.c, cells_edge.c and cells_stage.c share. */
#ifndef LIBCORE_CELLS_H
#define LIBCORE_CELLS_H

#include "libcore/polynomial.h"
#include "libcore/state.h"

struct cells { /* lines are [size] of the mosaic, or [faces] */
    struct mosaic *mosaic;
    const struct grid *grid;
    struct fit *fit;
    double *inverse_volume; /* [nown] 1/m^dim */
    double *girth[MAX_DIM]; /* [dim][nown] sum over the faces of A |n_k| / (2 V), 1/m */
    double *total_girth;    /* [nown] the same of A */
    double *flux[MAX_VAR];  /* [faces] through the whole face, from left to right, in the axes of the mosaic */
    double *flag;           /* [size] > 0 where faces are to be limited */
    double *limited;        /* [nown] how often that was so */
    bool flagged;           /* is any flag up that this rank sees? */
    double *sums;           /* [nblocks] */
    double *line;           /* [nown] */
    double **by_block;      /* [nblocks] into `line` */
};

/* Lines of a state's variables. */
void cells_lines(const struct gas *g, const struct state *s, double *line[MAX_VAR]);

/* Writes the mirrors from <= i < to of the mosaic into U. */
void cells_mirrors(const struct gas *g, int from, int to, double *const U[MAX_VAR]);
/* States beyond n points of a patch's faces: q -> ghost, conserved variables in the frames of the faces (normal first);
 * face, place: of each point. */
void cells_beyond(const struct gas *g, int patch, int n, const int *face, const int *place, double (*q)[BATCH],
                  double (*ghost)[BATCH]);

long cells_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt);
long cells_share_flags(struct gas *g);
void cells_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt);
void cells_clear_flags(struct gas *g);

#endif
