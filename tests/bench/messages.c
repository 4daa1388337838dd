/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts the messages of a run: preloaded (LD_PRELOAD), it stands between a program and MPI by MPI's own profiling
 * interface, and the program needs no change. MPI_Finalize writes the table HAFF_MESSAGES as CSV, one row for each
 * rank, call and length of a call: how often the rank made it, and the seconds it spent in it. `bytes` are those that
 * the rank gives to one call: of its message, or of its part of a collective. The row `process` has the most memory
 * that the rank ever had, and its CPU seconds. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { ROWS = 4000, NAME = 24 };
struct row {
    char call[NAME];
    long long bytes, calls;
    double seconds;
};
static struct { /* the table of a process: MPI's functions have no other place for it */
    struct row row[ROWS];
    int rows;
} table;

/* Adds one call, with the time from `begin` till now, to the row of its name and length. */
static void count(const char *call, long long bytes, double begin) {
    int i = 0;
    while (i < table.rows && (table.row[i].bytes != bytes || strcmp(table.row[i].call, call))) i++;
    if (i == ROWS) {
        fprintf(stderr, "haffmessages: more than %d kinds of calls; the table would be wrong\n", ROWS);
        PMPI_Abort(MPI_COMM_WORLD, 3);
    }
    struct row *r = &table.row[i];
    if (i == table.rows) {
        snprintf(r->call, NAME, "%s", call);
        r->bytes = bytes;
        table.rows++;
    }
    r->calls++;
    r->seconds += PMPI_Wtime() - begin;
}

static long long bytes_of(long long n, MPI_Datatype type) {
    int size = 0;
    if (n) PMPI_Type_size(type, &size);
    return n * size;
}

/* One function of MPI: its name, its parameters, how it is called, and the bytes that this rank gives to it. */
#define COUNTED(name, parameters, arguments, bytes)                                                                    \
    int MPI_##name parameters {                                                                                        \
        const double begin = PMPI_Wtime();                                                                             \
        const int code = PMPI_##name arguments;                                                                        \
        count(#name, bytes, begin);                                                                                    \
        return code;                                                                                                   \
    }
#define SEND(name)                                                                                                     \
    COUNTED(name, (const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c), (b, n, t, to, tag, c),          \
            bytes_of(n, t))
#define ISEND(name)                                                                                                    \
    COUNTED(name, (const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request *r),                 \
            (b, n, t, to, tag, c, r), bytes_of(n, t))

SEND(Send)
SEND(Ssend)
SEND(Rsend)
SEND(Bsend)
ISEND(Isend)
ISEND(Issend)
ISEND(Irsend)
ISEND(Ibsend)
COUNTED(Sendrecv,
        (const void *b, int n, MPI_Datatype t, int to, int tag, void *b2, int n2, MPI_Datatype t2, int from, int tag2,
         MPI_Comm c, MPI_Status *s),
        (b, n, t, to, tag, b2, n2, t2, from, tag2, c, s), bytes_of(n, t))
COUNTED(Recv, (void *b, int n, MPI_Datatype t, int from, int tag, MPI_Comm c, MPI_Status *s),
        (b, n, t, from, tag, c, s), 0)
COUNTED(Probe, (int from, int tag, MPI_Comm c, MPI_Status *s), (from, tag, c, s), 0)
COUNTED(Wait, (MPI_Request * r, MPI_Status *s), (r, s), 0)
COUNTED(Waitall, (int n, MPI_Request r[], MPI_Status s[]), (n, r, s), 0)
COUNTED(Waitany, (int n, MPI_Request r[], int *i, MPI_Status *s), (n, r, i, s), 0)
COUNTED(Waitsome, (int n, MPI_Request r[], int *m, int i[], MPI_Status s[]), (n, r, m, i, s), 0)

COUNTED(Barrier, (MPI_Comm c), (c), 0)
COUNTED(Bcast, (void *b, int n, MPI_Datatype t, int root, MPI_Comm c), (b, n, t, root, c), bytes_of(n, t))
COUNTED(Allreduce, (const void *b, void *to, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (b, to, n, t, o, c),
        bytes_of(n, t))
COUNTED(Reduce, (const void *b, void *to, int n, MPI_Datatype t, MPI_Op o, int root, MPI_Comm c),
        (b, to, n, t, o, root, c), bytes_of(n, t))
COUNTED(Scan, (const void *b, void *to, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (b, to, n, t, o, c),
        bytes_of(n, t))
COUNTED(Exscan, (const void *b, void *to, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (b, to, n, t, o, c),
        bytes_of(n, t))
COUNTED(Gather, (const void *b, int n, MPI_Datatype t, void *to, int m, MPI_Datatype u, int root, MPI_Comm c),
        (b, n, t, to, m, u, root, c), bytes_of(n, t))
COUNTED(Gatherv,
        (const void *b, int n, MPI_Datatype t, void *to, const int m[], const int at[], MPI_Datatype u, int root,
         MPI_Comm c),
        (b, n, t, to, m, at, u, root, c), bytes_of(n, t))
COUNTED(Scatter, (const void *b, int n, MPI_Datatype t, void *to, int m, MPI_Datatype u, int root, MPI_Comm c),
        (b, n, t, to, m, u, root, c), bytes_of(n, t))
COUNTED(Scatterv,
        (const void *b, const int n[], const int at[], MPI_Datatype t, void *to, int m, MPI_Datatype u, int root,
         MPI_Comm c),
        (b, n, at, t, to, m, u, root, c), bytes_of(m, u))
COUNTED(Allgather, (const void *b, int n, MPI_Datatype t, void *to, int m, MPI_Datatype u, MPI_Comm c),
        (b, n, t, to, m, u, c), bytes_of(n, t))
COUNTED(Allgatherv,
        (const void *b, int n, MPI_Datatype t, void *to, const int m[], const int at[], MPI_Datatype u, MPI_Comm c),
        (b, n, t, to, m, at, u, c), bytes_of(n, t))
COUNTED(Alltoall, (const void *b, int n, MPI_Datatype t, void *to, int m, MPI_Datatype u, MPI_Comm c),
        (b, n, t, to, m, u, c), bytes_of(n, t))

static long long sum_of(const int n[], MPI_Datatype t, MPI_Comm c) {
    int ranks;
    long long all = 0;
    PMPI_Comm_size(c, &ranks);
    for (int r = 0; r < ranks; r++) all += n[r];
    return bytes_of(all, t);
}
COUNTED(Alltoallv,
        (const void *b, const int n[], const int at[], MPI_Datatype t, void *to, const int m[], const int at2[],
         MPI_Datatype u, MPI_Comm c),
        (b, n, at, t, to, m, at2, u, c), sum_of(n, t, c))

static void write_rows(FILE *f, int rank, const struct row *row, int n) {
    for (int i = 0; i < n; i++)
        fprintf(f, "%d,%s,%lld,%lld,%.6f\n", rank, row[i].call, row[i].bytes, row[i].calls, row[i].seconds);
}

/* Writes the rows of rank 0, which calls this, and those that the others send to it. */
static void write_table(const char *path, int ranks) {
    FILE *f = fopen(path, "w");
    if (!f) {
        perror(path);
        PMPI_Abort(MPI_COMM_WORLD, 3);
        return;
    }
    fprintf(f, "rank,call,bytes,calls,seconds\n");
    write_rows(f, 0, table.row, table.rows);
    for (int r = 1; r < ranks; r++) {
        MPI_Status s;
        int bytes;
        PMPI_Recv(table.row, (int)sizeof table.row, MPI_BYTE, r, 0, MPI_COMM_WORLD, &s);
        PMPI_Get_count(&s, MPI_BYTE, &bytes);
        write_rows(f, r, table.row, bytes / (int)sizeof *table.row);
    }
    if (fclose(f)) perror(path);
}

static double seconds_of(struct timeval t) {
    return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

int MPI_Finalize(void) {
    const char *path = getenv("HAFF_MESSAGES");
    int rank, ranks;
    struct rusage use;
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    PMPI_Comm_size(MPI_COMM_WORLD, &ranks);
    getrusage(RUSAGE_SELF, &use);
    count("process", 1024LL * use.ru_maxrss, PMPI_Wtime() - seconds_of(use.ru_utime) - seconds_of(use.ru_stime));
    if (path && rank == 0) write_table(path, ranks);
    if (path && rank > 0) PMPI_Send(table.row, table.rows * (int)sizeof *table.row, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
    return PMPI_Finalize();
}
