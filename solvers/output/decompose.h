/* SPDX-License-Identifier: GPL-3.0-or-later */
/* processorN folders beside the reconstructed case, as OpenFOAM's decomposePar makes them: for reconstructPar and for
 * readers of decomposed cases. A part is what one rank computes; ranks without cells have none. Lives on the root. */
#ifndef SOLVERS_DECOMPOSE_H
#define SOLVERS_DECOMPOSE_H

#include "mesh/base/pool.h"
#include "solvers/case/case.h"

struct part {
    struct polymesh *mesh; /* patches of the case, then those of type processor and processorCyclic */
    int npatches;          /* number of the case's patches, which come first */
    int *cell;             /* [ncells] cell of the case, ascending */
    int *face;             /* [nfaces] face of the case */
    int *point;            /* [npoints] point of the case, ascending */
    int *across;           /* [nfaces] cell of the case on the other side; used for processor patches */
    char dir[TIME_PATH];   /* CASE/processorN */
    char tmp[TIME_PATH];   /* folder where a time is being written */
    struct checksums sums; /* checksums of the files written there so far */
};
/* The first face of the processor patches, behind which there are no others. */
static inline int part_beyond(const struct part *p) {
    return p->npatches < p->mesh->npatches ? p->mesh->patch[p->npatches].start : p->mesh->nfaces;
}
struct decomposition {
    struct pool pool; /* has the lists */
    int n;
    struct part *part;
};
/* Writes the parts' meshes with their ProcAddressing; *out is NULL on all ranks but the root. Folders of another
 * decomposition are an error that leaves them as they are. Collective. */
status decompose_make(const struct setup *s, struct decomposition **out);
void decompose_free(struct decomposition *d);

/* A time in all parts: begin makes each part's tmp, commit puts it in place with its uniform/time, remove takes a
 * written time away. */
status decompose_begin(struct decomposition *d, const char *name);
status decompose_commit(struct decomposition *d, const struct instant *at);
status decompose_remove(struct decomposition *d, const char *name);

#endif
