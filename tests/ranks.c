/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ranks of tests that wait for each other sleep: CTest preloads this, as tests run on more ranks than there are cores.
 * With OMPI_MCA_mpi_yield_when_idle Open MPI calls sched_yield in a loop; the ranks that compute get every other turn
 * only. */
#define _GNU_SOURCE
#include <sched.h>
#include <time.h>

int sched_yield(void) {
    return nanosleep(&(struct timespec){.tv_nsec = 50000}, NULL);
}
