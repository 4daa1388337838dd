/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of ints, each for one rank: delivery_begin makes room for them, the caller fills `rank` and `record`,
 * delivery_send sends them. delivery_free comes after success and failure. All are collective. */
#ifndef MESH_DELIVERY_H
#define MESH_DELIVERY_H

#include "mesh/base/comm.h"

struct delivery {
    const struct comm *comm;
    const char *what;      /* the records, for errors */
    int ints;              /* of a record */
    long n, arrived;       /* number of records sent here, arrived here */
    int *rank, *record;    /* [n] the rank that a record is for; [n][ints]; NULL once they are sent */
    int *order;            /* [n] the records in the order of sending: rank by rank, else as they stood */
    int *count, *arriving; /* [ranks] ints for each rank, and from each rank */
    int *in;               /* [arrived][ints] what the ranks sent here, one after the other */
};
status delivery_begin(const struct comm *c, long n, int ints, const char *what, struct delivery *out);
status delivery_send(struct delivery *d);
void delivery_free(struct delivery *d);

#endif
