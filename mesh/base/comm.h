/* The one thin layer over MPI. Every rank calls each function (collective) unless it says otherwise.
 * Only minima and maxima feed back into a run, so results do not depend on the number of ranks. */
#ifndef MESH_COMM_H
#define MESH_COMM_H

#include "mesh/base/status.h"

struct comm;

/* MPI_Init (once per program) and the world communicator. */
status comm_start(int *argc, char ***argv, struct comm **out);
void comm_finish(struct comm *c);
/* This rank by itself, for what it does without the others; comm_alone_free it before comm_finish. */
status comm_alone(struct comm **out);
void comm_alone_free(struct comm *c);

int comm_rank(const struct comm *c);
int comm_size(const struct comm *c);
bool comm_root(const struct comm *c);    /* rank 0? */
void *comm_handle(const struct comm *c); /* pointer to the MPI_Comm, for the libraries of mesh/ (p4est) */

void comm_min(const struct comm *c, double *value, int n); /* in place, elementwise */
void comm_max(const struct comm *c, double *value, int n);
void comm_sum_long(const struct comm *c, long *value, int n);

/* Root gets every rank's count[r] doubles, one rank after the other; all[] is allocated there (NULL elsewhere).
 * gather_int the same for ints. */
status comm_gather(const struct comm *c, const double *mine, long n, double **all, long *total);
status comm_gather_int(const struct comm *c, const int *mine, long n, int **all, long *total);
void comm_broadcast(const struct comm *c, void *data, long bytes); /* from root */

/* Equally long messages to and from some other ranks, again and again. Each rank that is linked to another is linked
 * back. start sends `times` * n doubles of every link's `out`, to be kept until finish, which waits for `in`. */
struct comm_link {
    int rank;
    long n;
    double *out, *in;
};
struct comm_exchange;
status comm_exchange_make(const struct comm *c, int nlinks, const struct comm_link *link, struct comm_exchange **out);
void comm_exchange_free(struct comm_exchange *x);
void comm_exchange_start(struct comm_exchange *x, int times);
void comm_exchange_finish(struct comm_exchange *x);

/* If any rank failed, every rank returns an error (the first failing rank's text); else OK. */
status comm_agree(const struct comm *c, status mine);

#endif
