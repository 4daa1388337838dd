/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests share cores and the disk; CTest preloads this. Ranks that wait for each other sleep: with
 * OMPI_MCA_mpi_yield_when_idle Open MPI calls sched_yield in a loop, and the ranks that compute get every other turn
 * only. What is written goes to the disk when the system likes: no test asks what a machine has after its power failed,
 * but those that preload faults/disk.c. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <sched.h>
#include <time.h>
#include <unistd.h>

int sched_yield(void) {
    return nanosleep(&(struct timespec){.tv_nsec = 50000}, NULL);
}

int fsync(int file) {
    (void)file;
    return 0;
}

int fdatasync(int file) {
    return fsync(file);
}

int sync_file_range(int file, off64_t from, off64_t bytes, unsigned flags) {
    (void)from, (void)bytes, (void)flags;
    return fsync(file);
}
