/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIME/uniform/grains: the exact state of a run of grains, from which it continues to the bit: grains with their own
 * clocks, the event queue, counts, and the sums of the averages. The file has a header as OpenFOAM's, then native
 * binary; 80 bytes and some per grain. */
#ifndef SOLVERS_GRAINS_STATE_H
#define SOLVERS_GRAINS_STATE_H

#include "libcore/grains/random.h"
#include "mesh/base/pool.h"
#include "mesh/format/foamfile.h"
#include "solvers/grains/grains_averages.h"

#include <string.h>

struct grains_inflow { /* of grains that come in (grains_inlets.h); saved as it is */
    struct random random;
    double next, renewed; /* s: when the next candidate comes; when the values of the patches were taken */
    int64_t blocked;      /* grains for which there was no room */
};
struct grains_state {
    struct grain_box box; /* box and law under which the events were predicted; a state that was read has neither
                           * facets nor shear */
    struct grain_law law;
    int n;
    double t;      /* s: time reached */
    double energy; /* J: kinetic, potential and lost when counting began */
    struct grain_counts counts;
    struct grain *grain;       /* [n], by index */
    struct grain_event *event; /* [n] */
    int32_t *id;               /* [n] */
    uint8_t *kind;             /* [n] of a mixture */
    double walls[3];           /* of grains_state_walls */
    double (*impulse)[3];      /* [walls[0]] of grains_impulses */
    bool fed;                  /* do grains come in? */
    struct grains_inflow inflow;
    struct averages_saved averages;
    struct pool pool; /* has the lists of a state that was read */
};
/* Turns walls of facets into numbers: how many (twice with open ones, three times if they are fed), checksums of their
 * shape and of their restitution and roughness. A sheared box has 1, the shear rate, -1; any other zeros. */
void grains_state_walls(const struct grain_box *b, double out[3]);
/* Were the events predicted under this box and law? */
bool grains_state_same(const struct grains_state *s, const struct grain_box *box, const struct grain_law *law);

struct bytes {
    const char *at;
    size_t left;
};
/* Copies the next bytes to out; returns false if there are fewer. */
static inline bool bytes_take(struct bytes *b, void *out, size_t bytes) {
    if (bytes > b->left) return false;
    memcpy(out, b->at, bytes);
    b->at += bytes;
    b->left -= bytes;
    return true;
}
/* Opens a file of a state and hands the bytes behind its header and `(` to `parse`. */
typedef status state_parser(const struct source *source, struct bytes *b, void *out);
status state_read(const char *path, state_parser *parse, void *out);
/* Writes the state to `path`; *sum gets size and checksum of the file. */
status grains_state_write(const struct grains_state *s, const char *path, const char *location, bool compress,
                          struct file_sum *sum);
/* Reads a state; the caller calls grains_state_free, also after an error. Fails with ERR_INPUT on a file that is cut or
 * that this machine does not write. */
status grains_state_read(const char *path, struct grains_state *out);
void grains_state_free(struct grains_state *s);

#endif
