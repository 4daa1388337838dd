/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the laps of a run and prints them (timing.h). */
#include "solvers/output/timing.h"

void timing_start(struct timing *t) {
    *t = (struct timing){.clock = clock_now()};
}

void timing_lap(struct timing *t, enum lap lap) {
    const double now = clock_now();
    t->spent[lap] += now - t->clock;
    t->clock = now;
}

static void print_line(FILE *f, const char *name, double seconds, double all) {
    if (seconds > 0) fprintf(f, "    %-20s %10.2f s %5.1f %%\n", name, seconds, 100 * seconds / all);
}

void timing_print(const struct timing *t, const struct medium *m, FILE *f) {
    static const char *const name[LAPS] = {"start", "plans of steps", "steps", "log and control", "output"};
    struct part_seconds part[PARTS_TIMED];
    const int parts = m->type->seconds ? m->type->seconds(m, part) : 0;
    double all = 0, rest = t->spent[LAP_STEP];
    for (int i = 0; i < LAPS; i++) all += t->spent[i];
    fprintf(f, "Seconds of the clock, rank 0\n");
    for (int i = 0; i < parts; i++) {
        print_line(f, part[i].name, part[i].seconds, all);
        rest -= part[i].seconds;
    }
    for (int i = 0; i < LAPS; i++)
        print_line(f, parts && i == LAP_STEP ? "rest of steps" : name[i], i == LAP_STEP ? rest : t->spent[i], all);
}
