/* What p4est does for the forest: deals the tiles (one tree each, in the order of their ids) to the ranks, finds which
 * of them face another rank, and carries a packet of equal length for each of those. Private to forest*.c. */
#ifndef MESH_TREES_H
#define MESH_TREES_H

#include "mesh/comm.h"

struct trees_tile {   /* all tiles, on every rank */
    int low[3], n[3]; /* lattice position and cells */
    int neighbour[6]; /* tile id beyond side 2*k + (0 low, 1 high), itself for its own periodic image; -1: a patch */
};
struct trees_engine;
struct trees {
    const struct trees_engine *engine;
    int first, count; /* my tiles: ids first .. first + count - 1 */
    int nghosts;      /* tiles of other ranks that face mine: */
    int *ghost;       /* [nghosts] their ids; packets arrive in this order, without gaps */
    int nmirrors;     /* my tiles that face other ranks: */
    int *mirror;      /* [nmirrors] their numbers on this rank, ascending */
    struct trees_state *state;
};
struct trees_engine { /* p4est in two dimensions (and one), p8est in three */
    status (*start)(struct trees *t, const struct comm *c, const struct trees_tile *all, int nall);
    void (*stop)(struct trees *t);
    void (*send)(struct trees *t, long bytes, void **packet /* [nmirrors] */, void *arriving);
    void (*receive)(struct trees *t);
};
extern const struct trees_engine trees_flat, trees_solid;

status trees_make(const struct comm *c, int dim, const struct trees_tile *all, int nall, struct trees **out);
void trees_free(struct trees *t);

/* Sends packet[m], `bytes` long, of every mirror m to the ranks that face it; receive waits until `arriving`
 * [nghosts][bytes] is there. Between the two the caller must keep `arriving`, not the packets. */
void trees_send(struct trees *t, long bytes, void **packet, void *arriving);
void trees_receive(struct trees *t);

#endif
