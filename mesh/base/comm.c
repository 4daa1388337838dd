/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only source file of mesh/ that calls MPI: start and end, minima and maxima, gathers, and the repeated messages of
 * ghost exchanges (comm.h). */
#include "mesh/base/comm.h"

#include "mesh/base/build.h"

#include <limits.h>
#include <mpi.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 2048, PIECE = 1 << 26 }; /* bytes of a message */

struct comm {
    MPI_Comm world;
    int rank, size;
    bool talks; /* are there other ranks to send messages to? */
};

/* Has something started this process as one of several ranks? Launchers say so in the environment of each: mpirun of
 * Open MPI, PMIx and Slurm, the PMI of MPICH and Intel MPI, and those of some machines. */
static bool is_launched(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK",           "PMI_RANK",    "PMI_SIZE",
                                        "SLURM_PROCID",         "MV2_COMM_WORLD_RANK", "PALS_RANKID", "ALPS_APP_PE",
                                        "JSM_NAMESPACE_RANK",   "FLUX_TASK_RANK",      "MP_CHILD"};
    for (int i = 0; i < (int)(sizeof names / sizeof *names); i++)
        if (getenv(names[i])) return true;
    return false;
}

/* An installation that brings Open MPI (the wheel) has it as a prefix of its own, in another place than it was built
 * for.
 */
static void find_own_mpi(void) {
    char path[4096];
    if (build_companion("openmpi", sizeof path, path)) setenv("OPAL_PREFIX", path, 0);
}

/* Open MPI starts in 9 ms instead of 0.4 s if it needs no daemon and no network, and if hwloc, which it asks for the
 * processors, looks for no devices (PCI, displays) and loads no plugins for them. Programs without mpirun would share
 * one session directory, and remove it. Other MPIs ignore these settings. */
void comm_alone_settings(const char *out[COMM_SETTINGS + 1]) {
    static const char *const all[COMM_SETTINGS] = {"OMPI_MCA_ess_singleton_isolated=1",
                                                   "OMPI_MCA_orte_create_session_dirs=0",
                                                   "OMPI_MCA_btl=self",
                                                   "OMPI_MCA_pml=ob1",
                                                   "HWLOC_COMPONENTS=-linuxio",
                                                   "HWLOC_PLUGINS_PATH=/dev/null"};
    char name[64];
    int n = 0;
    for (int i = 0; i < COMM_SETTINGS; i++) {
        snprintf(name, sizeof name, "%.*s", (int)strcspn(all[i], "="), all[i]);
        if (!getenv(name)) out[n++] = all[i];
    }
    out[n] = NULL;
}

/* Starts MPI in a process that is alone, unless it has started. */
static void start_alone(void) {
    const char *settings[COMM_SETTINGS + 1];
    char name[64];
    int started = 0;
    if (MPI_Initialized(&started) == MPI_SUCCESS && started) return;
    comm_alone_settings(settings);
    for (int i = 0; settings[i]; i++) {
        const size_t end = strcspn(settings[i], "=");
        snprintf(name, sizeof name, "%.*s", (int)end, settings[i]);
        setenv(name, settings[i] + end + 1, 0);
    }
    find_own_mpi();
    int given;
    MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED,
                    &given); /* a failure ends the process, which is the default of MPI */
}

status comm_start(int *argc, char ***argv, struct comm **out) {
    *out = NULL;
    if (!is_launched()) return comm_alone(out);
    find_own_mpi();
    int given; /* threads of background.h call no MPI */
    if (MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS)
        return fail(ERR_SYSTEM, "MPI did not start; check the installation with: mpirun -np 1 true");
    struct comm *c;
    TRY(allocate(&c, 1, sizeof *c, "the communicator"));
    c->world = MPI_COMM_WORLD;
    MPI_Comm_rank(c->world, &c->rank);
    MPI_Comm_size(c->world, &c->size);
    c->talks = c->size > 1;
    *out = c;
    return OK;
}

void comm_finish(struct comm *c) {
    int started = 0;
    free(c);
    if (MPI_Initialized(&started) == MPI_SUCCESS && started) MPI_Finalize();
}

status comm_alone(struct comm **out) {
    *out = NULL;
    TRY(allocate(out, 1, sizeof **out, "the communicator"));
    **out = (struct comm){MPI_COMM_SELF, 0, 1, false};
    return OK;
}

status comm_pretend(int rank, int size, struct comm **out) {
    *out = NULL;
    TRY(allocate(out, 1, sizeof **out, "the communicator"));
    **out = (struct comm){MPI_COMM_SELF, rank, size, false};
    return OK;
}

bool comm_pretends(const struct comm *c) {
    return c->size > 1 && !c->talks;
}

void comm_alone_free(struct comm *c) {
    free(c);
}

int comm_rank(const struct comm *c) {
    return c->rank;
}
int comm_size(const struct comm *c) {
    return c->size;
}
bool comm_root(const struct comm *c) {
    return c->rank == 0;
}
void *comm_handle(const struct comm *c) {
    if (!c->talks) start_alone();
    return (void *)&c->world;
}

static void reduce(const struct comm *c, void *value, int n, MPI_Datatype type, MPI_Op op) {
    if (c->talks) MPI_Allreduce(MPI_IN_PLACE, value, n, type, op, c->world);
}

void comm_min(const struct comm *c, double *value, int n) {
    reduce(c, value, n, MPI_DOUBLE, MPI_MIN);
}
void comm_max(const struct comm *c, double *value, int n) {
    reduce(c, value, n, MPI_DOUBLE, MPI_MAX);
}
void comm_sum_long(const struct comm *c, long *value, int n) {
    reduce(c, value, n, MPI_LONG, MPI_SUM);
}

/* Sends to the other rank, or receives from there, in pieces. */
static void hand(const struct comm *c, bool send, int other, void *data, long bytes) {
    char *next = data;
    while (bytes > 0) {
        const int piece = bytes < PIECE ? (int)bytes : PIECE;
        if (send)
            MPI_Send(next, piece, MPI_BYTE, other, 1, c->world);
        else
            MPI_Recv(next, piece, MPI_BYTE, other, 1, c->world, MPI_STATUS_IGNORE);
        next += piece;
        bytes -= piece;
    }
}

void comm_to_root(const struct comm *c, int from, void *data, long bytes) {
    hand(c, c->rank > 0, c->rank ? 0 : from, data, bytes);
}

void comm_from_root(const struct comm *c, int to, void *data, long bytes) {
    hand(c, c->rank == 0, c->rank ? 0 : to, data, bytes);
}

void comm_put(const struct comm *c, int to, const double *values, long n) {
    MPI_Send(values, (int)n, MPI_DOUBLE, to, 2, c->world);
}

void comm_get(const struct comm *c, int from, double *values, long n) {
    MPI_Recv(values, (int)n, MPI_DOUBLE, from, 2, c->world, MPI_STATUS_IGNORE);
}

void comm_take_turn(const struct comm *c, double *value, int n) {
    if (c->talks && c->rank > 0) comm_get(c, c->rank - 1, value, n);
}

void comm_end_turn(const struct comm *c, double *value, int n) {
    if (!c->talks) return;
    if (c->rank < c->size - 1) comm_put(c, c->rank + 1, value, n);
    MPI_Bcast(value, n, MPI_DOUBLE, c->size - 1, c->world);
}

/* Gathers fewer bytes than MPI's counts and displacements, which are ints, can tell. */
static void gather_at_once(const struct comm *c, const void *mine, long bytes, char *all, const long *count,
                           long each) {
    int size[c->size], start[c->size];
    for (int r = 0, at = 0; c->rank == 0 && r < c->size; at += size[r++]) {
        size[r] = (int)(count[r] * each);
        start[r] = at;
    }
    MPI_Gatherv(mine, (int)bytes, MPI_BYTE, all, size, start, MPI_BYTE, 0, c->world);
}

/* Gathers any number of bytes: the ranks send one after the other, in pieces. */
static void gather_in_turn(const struct comm *c, const void *mine, long bytes, char *all, const long *count,
                           long each) {
    if (c->rank > 0) {
        comm_to_root(c, c->rank, (void *)(uintptr_t)mine, bytes);
        return;
    }
    if (bytes) memcpy(all, mine, (size_t)bytes);
    all += bytes;
    for (int r = 1; r < c->size; all += count[r++] * each) comm_to_root(c, r, all, count[r] * each);
}

static status gather(const struct comm *c, const void *mine, long n, void *all, long *total, long bytes) {
    long sum = n, *count = NULL;
    comm_sum_long(c, &sum, 1);
    char *array = NULL;
    status s = OK;
    if (c->rank == 0) s = allocate(&array, sum, bytes, "an array gathered from all ranks");
    if (c->rank == 0 && !s) s = allocate(&count, c->size, sizeof *count, "the counts of all ranks");
    s = comm_agree(c, s);
    if (s) {
        free(array);
        free(count);
        return s;
    }
    if (c->talks) MPI_Gather(&n, 1, MPI_LONG, count, 1, MPI_LONG, 0, c->world);
    if (!c->talks && array && n) memcpy(array, mine, (size_t)(n * bytes));
    if (c->talks) (sum <= INT_MAX / bytes ? gather_at_once : gather_in_turn)(c, mine, n * bytes, array, count, bytes);
    free(count);
    memcpy(all, &array, sizeof array);
    if (total) *total = c->rank == 0 ? sum : 0;
    return OK;
}

status comm_gather(const struct comm *c, const double *mine, long n, double **all, long *total) {
    *all = NULL;
    return gather(c, mine, n, all, total, sizeof **all);
}

status comm_gather_int(const struct comm *c, const int *mine, long n, int **all, long *total) {
    *all = NULL;
    return gather(c, mine, n, all, total, sizeof **all);
}

status comm_share_count(const struct comm *c, long n, int *count, int *first) {
    long sum = n;
    comm_sum_long(c, &sum, 1);
    if (sum > INT_MAX) return fail(ERR_SYSTEM, "%ld values on one rank; at most %d can be shared", sum, INT_MAX);
    int mine = (int)n;
    if (c->talks)
        MPI_Allgather(&mine, 1, MPI_INT, count, 1, MPI_INT, c->world);
    else
        for (int r = 0; r < c->size; r++) count[r] = r == c->rank ? mine : 0;
    first[0] = 0;
    for (int r = 0; r < c->size; r++) first[r + 1] = first[r] + count[r];
    return OK;
}

static void share(const struct comm *c, const void *mine, const int *count, const int *first, void *all,
                  MPI_Datatype type, size_t bytes) {
    if (c->talks)
        MPI_Allgatherv(mine, count[c->rank], type, all, count, first, type, c->world);
    else if (count[c->rank])
        memcpy(all, mine, (size_t)count[c->rank] * bytes);
}

void comm_share(const struct comm *c, const double *mine, const int *count, const int *first, double *all) {
    share(c, mine, count, first, all, MPI_DOUBLE, sizeof *all);
}

void comm_share_int(const struct comm *c, const int *mine, const int *count, const int *first, int *all) {
    share(c, mine, count, first, all, MPI_INT, sizeof *all);
}

void comm_broadcast(const struct comm *c, void *data, long bytes) {
    char *next = data;
    while (c->talks && bytes > 0) {
        int piece = bytes < PIECE ? (int)bytes : PIECE;
        MPI_Bcast(next, piece, MPI_BYTE, 0, c->world);
        next += piece;
        bytes -= piece;
    }
}

void comm_trade_counts(const struct comm *c, const int *count_out, int *count_in) {
    if (c->talks)
        MPI_Alltoall(count_out, 1, MPI_INT, count_in, 1, MPI_INT, c->world);
    else
        for (int r = 0; r < c->size; r++) count_in[r] = r == c->rank ? count_out[r] : 0;
}

/* A rank's own numbers are copied while those of others travel, which MPI_Alltoallv does one after the other. */
static void trade(const struct comm *c, const void *out, const int *count_out, void *in, const int *count_in,
                  MPI_Datatype type, size_t bytes) {
    MPI_Request request[2 * c->size];
    const char *from = out, *own = out;
    char *to = in, *kept = in;
    int n = 0;
    for (int r = 0; r < c->size; to += (size_t)count_in[r++] * bytes) {
        if (r == c->rank)
            kept = to;
        else if (count_in[r] && c->talks)
            MPI_Irecv(to, count_in[r], type, r, 3, c->world, &request[n++]);
    }
    for (int r = 0; r < c->size; from += (size_t)count_out[r++] * bytes) {
        if (r == c->rank)
            own = from;
        else if (count_out[r] && c->talks)
            MPI_Isend(from, count_out[r], type, r, 3, c->world, &request[n++]);
    }
    if (count_out[c->rank]) memcpy(kept, own, (size_t)count_out[c->rank] * bytes);
    if (n) MPI_Waitall(n, request, MPI_STATUSES_IGNORE);
}

void comm_trade(const struct comm *c, const double *out, const int *count_out, double *in, const int *count_in) {
    trade(c, out, count_out, in, count_in, MPI_DOUBLE, sizeof *in);
}

void comm_trade_int(const struct comm *c, const int *out, const int *count_out, int *in, const int *count_in) {
    trade(c, out, count_out, in, count_in, MPI_INT, sizeof *in);
}

status comm_deliver_int(const struct comm *c, const int *out, const int *count_out, int **in, int *count_in) {
    long sum = 0;
    *in = NULL;
    comm_trade_counts(c, count_out, count_in);
    for (int r = 0; r < c->size; r++) sum += count_in[r];
    status s = sum > INT_MAX ? fail(ERR_SYSTEM, "%ld numbers for one rank; at most %d can be sent", sum, INT_MAX) : OK;
    if (!s) s = allocate(in, sum, sizeof **in, "what other ranks send");
    TRY(comm_agree(c, s));
    comm_trade_int(c, out, count_out, *in, count_in);
    return OK;
}

struct comm_exchange {
    MPI_Comm world;
    int nlinks;
    const struct comm_link *link; /* borrowed */
    MPI_Request request[];        /* [2 * nlinks] first the receives, then the sends */
};

status comm_exchange_make(const struct comm *c, int nlinks, const struct comm_link *link, struct comm_exchange **out) {
    struct comm_exchange *x;
    *out = NULL;
    TRY(allocate(&x, 1, (long)sizeof *x + 2L * nlinks * (long)sizeof *x->request, "messages between the ranks"));
    x->world = c->world;
    x->nlinks = nlinks;
    x->link = link;
    for (int i = 0; i < 2 * nlinks; i++) x->request[i] = MPI_REQUEST_NULL;
    *out = x;
    return OK;
}

void comm_exchange_free(struct comm_exchange *x) {
    free(x);
}

void comm_exchange_start(struct comm_exchange *x, int times) {
    for (int i = 0; i < x->nlinks; i++) {
        const struct comm_link *l = &x->link[i];
        MPI_Irecv(l->in, (int)l->n * times, MPI_DOUBLE, l->rank, 0, x->world, &x->request[i]);
        MPI_Isend(l->out, (int)l->n * times, MPI_DOUBLE, l->rank, 0, x->world, &x->request[x->nlinks + i]);
    }
}

void comm_exchange_finish(struct comm_exchange *x) {
    if (x->nlinks) MPI_Waitall(2 * x->nlinks, x->request, MPI_STATUSES_IGNORE);
}

status comm_agree(const struct comm *c, status mine) {
    if (!c->talks) return mine;
    int first = mine ? c->rank : c->size;
    reduce(c, &first, 1, MPI_INT, MPI_MIN);
    if (first == c->size) return OK;
    struct {
        int kind;
        char text[TEXT];
    } message = {0};
    if (first == c->rank) {
        message.kind = (int)status_kind(mine);
        strncpy(message.text, status_text(mine), TEXT - 1);
    }
    MPI_Bcast(&message, sizeof message, MPI_BYTE, first, c->world);
    if (first == c->rank) return mine;
    status_free(mine);
    return fail((enum status_kind)message.kind, "%s", message.text);
}
