/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one thin layer over MPI. Every rank calls each function (collective) unless its comment says otherwise. Only
 * minima and maxima feed back into a run, so results do not depend on the number of ranks. */
#ifndef MESH_COMM_H
#define MESH_COMM_H

#include "mesh/base/status.h"

struct comm;

/* comm_start makes the communicator of all ranks (once per program), comm_finish frees it. MPI starts where a launcher
 * has started the process, which the environment tells; a process that is alone starts MPI when a library asks for
 * comm_handle, as a rule never. If the environment of several ranks told nothing, each would be alone, and the case's
 * lock (solvers/case/lock.h) refuses all but one. */
status comm_start(int *argc, char ***argv, struct comm **out);
void comm_finish(struct comm *c);
/* Makes a communicator of this rank alone, for work that it does without the others. comm_alone_free frees it, before
 * comm_finish. */
status comm_alone(struct comm **out);
/* Makes a communicator in which this process is `rank` of `size` and the others are not there, to measure what the
 * set-up of one rank takes: no message is sent, and what is gathered, shared or reduced is this rank's alone. Freed
 * likewise. */
status comm_pretend(int rank, int size, struct comm **out);
bool comm_pretends(const struct comm *c);
void comm_alone_free(struct comm *c);

/* The settings NAME=value of Open MPI with which a program that is alone starts at once, without those that the
 * environment has already; NULL behind the last. comm_handle sets them here; who starts such a program gives it them.
 */
enum { COMM_SETTINGS = 6 };
void comm_alone_settings(const char *out[COMM_SETTINGS + 1]);

int comm_rank(const struct comm *c);
int comm_size(const struct comm *c);
bool comm_root(const struct comm *c);    /* is this rank 0? */
void *comm_handle(const struct comm *c); /* pointer to the MPI_Comm, for libraries (p4est, PETSc); starts MPI */

/* Replace value[n] by the minimum (maximum, sum) over all ranks, element by element. */
void comm_min(const struct comm *c, double *value, int n);
void comm_max(const struct comm *c, double *value, int n);
void comm_sum_long(const struct comm *c, long *value, int n);

/* Gathers every rank's mine[n] on the root, in the order of the ranks: *all holds *total values there (the caller frees
 * it) and is NULL on the other ranks. comm_gather_int does the same for ints. */
status comm_gather(const struct comm *c, const double *mine, long n, double **all, long *total);
status comm_gather_int(const struct comm *c, const int *mine, long n, int **all, long *total);
/* Every rank gets all ranks' numbers, in the order of the ranks. comm_share_count tells how many each rank has, in
 * count[size], and where they begin, in first[size + 1]; it fails on every rank if there are more than an int can
 * count. comm_share and comm_share_int then copy mine[count[rank]] of every rank to all[first[size]]. */
status comm_share_count(const struct comm *c, long n, int *count, int *first);
void comm_share(const struct comm *c, const double *mine, const int *count, const int *first, double *all);
void comm_share_int(const struct comm *c, const int *mine, const int *count, const int *first, int *all);
void comm_broadcast(const struct comm *c, void *data, long bytes); /* copies the root's data to all ranks */
/* Sends doubles to every rank: count_out[r] of `out` to rank r, those of rank 0 first. *in, with room for the
 * sum of count_in, gets what the ranks send here, in their order. comm_trade_counts tells count_in beforehand.
 * comm_trade_int does the same for ints. The sums are at most INT_MAX. */
void comm_trade_counts(const struct comm *c, const int *count_out, int *count_in);
void comm_trade(const struct comm *c, const double *out, const int *count_out, double *in, const int *count_in);
void comm_trade_int(const struct comm *c, const int *out, const int *count_out, int *in, const int *count_in);
/* Sends ints as comm_trade_int does, to ranks that do not know beforehand what arrives: *in, which the caller frees,
 * holds count_in[r] ints of each rank r in turn. Fails on every rank if one would get more than an int can count. */
status comm_deliver_int(const struct comm *c, const int *out, const int *count_out, int **in, int *count_in);
/* Sends bytes from one rank to the root, which is another, or the other way; called by these two alone. */
void comm_to_root(const struct comm *c, int from, void *data, long bytes);
void comm_from_root(const struct comm *c, int to, void *data, long bytes);
/* Sends n doubles to another rank, which gets them by comm_get; called by these two alone. */
void comm_put(const struct comm *c, int to, const double *values, long n);
void comm_get(const struct comm *c, int from, double *values, long n);
/* Let the ranks add to the same sums one after the other, so that these have the bits of one rank's: comm_take_turn
 * gets value[n] from the rank before, comm_end_turn hands it on and then gets what the last rank had. */
void comm_take_turn(const struct comm *c, double *value, int n);
void comm_end_turn(const struct comm *c, double *value, int n);

/* Messages of the same lengths between the same ranks, again and again. Links are mutual: a rank linked to another is
 * linked back. comm_exchange_start sends `times` * n doubles of every link's `out`, which must not change until
 * comm_exchange_finish has waited for every link's `in`. */
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
