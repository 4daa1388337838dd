/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clocks of this process. */
#ifndef MESH_CLOCK_H
#define MESH_CLOCK_H

double clock_now(void); /* s, wall clock: never goes back */
double cpu_now(void);   /* s, CPU time of this process */

enum { PARTS_TIMED = 12 };
struct part_seconds { /* what a part of something took */
    const char *name;
    double seconds;
};

#endif
