/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The queue of grains' events (calendar.h). All times up to the horizon stand sorted in a short line, the earliest
 * last. When the line is empty the horizon moves on, and the line takes the times in between: each GROUP of items, and
 * each GROUP of groups, has a bound below all its times beyond the horizon, so that few groups are opened. A time that
 * changes lowers two bounds; a bound rises when its group is opened. Items that are near in number share the memory of
 * their times and bounds. */
#include "libcore/grains/calendar.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SHIFT = 4, GROUP = 1 << SHIFT, LEVELS = 2, BATCH = 32 /* times in the line that suit best */, MANY = 4 * BATCH };

struct due {
    double t;
    int32_t item;
};
struct calendar {
    int n, groups[LEVELS + 1]; /* numbers of groups; at level 0 of items, filled up to whole groups */
    double *least[LEVELS + 1]; /* bounds of the groups; at level 0 the items' times */
    double horizon, step;
    int dues;
    struct due *due; /* [n] the line; few are in use */
    int32_t *open;   /* [groups[1]] groups to open */
};

status calendar_make(int n, struct calendar **out) {
    struct calendar *c;
    TRY(allocate(&c, 1, sizeof *c, "queue"));
    *c = (struct calendar){.n = n};
    status s = allocate(&c->due, n, sizeof *c->due, "queue");
    for (int level = LEVELS, size = (n - 1) / (GROUP * GROUP) + 1; level >= 0 && !s; level--, size *= GROUP) {
        c->groups[level] = size;
        s = allocate(&c->least[level], size, sizeof *c->least[level], "queue");
        for (int q = 0; q < size && !s; q++) c->least[level][q] = HUGE_VAL;
    }
    if (!s) s = allocate(&c->open, c->groups[1], sizeof *c->open, "queue");
    if (s) {
        calendar_free(c);
        return s;
    }
    calendar_start(c, 0);
    *out = c;
    return OK;
}

void calendar_free(struct calendar *c) {
    if (!c) return;
    for (int level = 0; level <= LEVELS; level++) free(c->least[level]);
    free(c->due);
    free(c->open);
    free(c);
}

static inline bool earlier(struct due a, struct due b) {
    return a.t < b.t || (a.t == b.t && a.item < b.item);
}

/* Puts an item into the line at its place. */
static void line_add(struct calendar *c, struct due new) {
    int at = c->dues++;
    for (; at > 0 && earlier(c->due[at - 1], new); at--) c->due[at] = c->due[at - 1];
    c->due[at] = new;
}

static void line_remove(struct calendar *c, int item) {
    int at = c->dues - 1;
    while (c->due[at].item != item) at--;
    c->dues--;
    memmove(c->due + at, c->due + at + 1, (size_t)(c->dues - at) * sizeof *c->due);
}

static inline void lower_bounds(struct calendar *c, int item, double t) {
    for (int level = 1; level <= LEVELS; level++) {
        double *least = &c->least[level][item >> (level * SHIFT)];
        *least = t < *least ? t : *least;
    }
}

void calendar_set(struct calendar *c, int item, double t) {
    c->least[0][item] = t;
}

void calendar_start(struct calendar *c, double now) {
    double mean = 0;
    int known = 0;
    for (int level = 1; level <= LEVELS; level++)
        for (int q = 0; q < c->groups[level]; q++) c->least[level][q] = HUGE_VAL;
    for (int32_t i = 0; i < c->n; i++) {
        double t = c->least[0][i];
        lower_bounds(c, i, t);
        if (t == HUGE_VAL) continue;
        mean += t - now;
        known++;
    }
    c->horizon = nextafter(now, -HUGE_VAL);
    c->step = known ? BATCH * mean / known / c->n : 1; /* n times that lie `mean` ahead come at the rate n/mean */
    c->dues = 0;
}

void calendar_move(struct calendar *c, int item, double t) {
    if (c->least[0][item] <= c->horizon) line_remove(c, item);
    c->least[0][item] = t;
    if (t <= c->horizon)
        line_add(c, (struct due){t, item});
    else
        lower_bounds(c, item, t);
}

/* Lists the groups that the horizon has passed, and prefetches all of their times at once. */
static int find_groups(struct calendar *c) {
    int m = 0;
    for (int block = 0; block < c->groups[2]; block++) {
        if (!(c->least[2][block] <= c->horizon)) continue;
        double others = HUGE_VAL;
        for (int q = block * GROUP; q < (block + 1) * GROUP; q++) {
            double least = c->least[1][q];
            if (least <= c->horizon) {
                c->open[m++] = q;
                __builtin_prefetch(&c->least[0][q * GROUP]);
                __builtin_prefetch(&c->least[0][q * GROUP + GROUP / 2]);
            } else {
                others = least < others ? least : others;
            }
        }
        c->least[2][block] = others;
    }
    return m;
}

/* Moves the times up to the horizon into the line, the last group first, so that equal times come in the line's order.
 * Returns false if it found too many, unless all are equal. */
static bool open_groups(struct calendar *c) {
    int m = find_groups(c);
    bool good = true;
    while (m > 0) {
        int group = c->open[--m];
        double least = good ? HUGE_VAL : c->least[1][group];
        for (int i = group * GROUP + GROUP - 1; i >= group * GROUP && good; i--) {
            double t = c->least[0][i];
            if (t <= c->horizon)
                line_add(c, (struct due){t, i});
            else
                least = t < least ? t : least;
        }
        c->least[1][group] = least;
        c->least[2][group >> SHIFT] = fmin(least, c->least[2][group >> SHIFT]);
        good = c->dues <= MANY || c->due[0].t == c->due[c->dues - 1].t;
    }
    return good;
}

/* Empties the line again; returns an earlier horizon, up to which only its first times lie. */
static double put_back(struct calendar *c) {
    double first = c->due[c->dues - 1].t, some = c->due[c->dues - BATCH].t, last = c->due[0].t;
    for (int q = 0; q < c->dues; q++) lower_bounds(c, c->due[q].item, c->due[q].t);
    c->dues = 0;
    return some < last ? some : first;
}

/* Moves the horizon on until an item is due; returns false if all times are HUGE_VAL. */
static bool look_ahead(struct calendar *c) {
    for (double to = c->horizon + c->step; c->dues == 0;) {
        c->horizon = to;
        if (!open_groups(c)) {
            to = put_back(c);
            c->step *= 0.5;
        } else if (c->dues == 0) {
            double least = HUGE_VAL;
            for (int q = 0; q < c->groups[LEVELS]; q++) least = fmin(least, c->least[LEVELS][q]);
            if (least == HUGE_VAL) return false;
            to = least + c->step;
        }
    }
    c->step *= fmax(0.5, fmin((double)BATCH / c->dues, 2));
    return true;
}

int calendar_first(struct calendar *c) {
    if (c->dues == 0 && !look_ahead(c)) return 0;
    return c->due[c->dues - 1].item;
}

int calendar_next(const struct calendar *c, int k) {
    return k < c->dues ? c->due[c->dues - 1 - k].item : -1;
}

double calendar_time(const struct calendar *c, int item) {
    return c->least[0][item];
}

double calendar_bytes(int n) {
    return (double)n * (sizeof(double) * (1 + 1. / GROUP + 1. / GROUP / GROUP) + sizeof(struct due));
}
