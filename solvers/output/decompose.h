/* processorN folders beside the reconstructed case, as OpenFOAM's decomposePar makes them: for reconstructPar and for
 * readers of decomposed cases. A part is what one rank computes; ranks without cells have none. Lives on the root. */
#ifndef SOLVERS_DECOMPOSE_H
#define SOLVERS_DECOMPOSE_H

#include "solvers/case/case.h"

struct part {
    struct polymesh *mesh; /* patches of the case, then those of type processor and processorCyclic */
    int npatches;          /* of the case */
    int *cell;             /* [ncells] of the case, ascending */
    int *face;             /* [nfaces] of the case */
    int *point;            /* [npoints] of the case, ascending */
    int *across;           /* [nfaces] cell of the case on the other side; used for processor patches */
    char dir[TIME_PATH];   /* CASE/processorN */
    char tmp[TIME_PATH];   /* where a time is being written */
    struct checksums sums; /* of its files so far */
};
struct decomposition {
    int n;
    struct part *part;
};
/* Collective; NULL on all but the root. Writes the parts' meshes with their ProcAddressing; folders of another
 * decomposition are an error that leaves them as they are. */
status decompose_make(const struct setup *s, struct decomposition **out);
void decompose_free(struct decomposition *d);

/* A time in all parts: begun (each part's tmp), put in place with its uniform/time, given up, taken away. */
status decompose_begin(struct decomposition *d, const char *name);
status decompose_commit(struct decomposition *d, const struct instant *at);
status decompose_remove(struct decomposition *d, const char *name);

#endif
