/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A queue of one time for each of n items, the earliest first, equal times by the item's number (so that the order does
 * not depend on how the queue is built). Moving an item costs the same however many there are. The next ~32 items stand
 * in a sorted line; the line is refilled once per ~32 events, at n/256 comparisons. */
#ifndef LIBCORE_CALENDAR_H
#define LIBCORE_CALENDAR_H

#include "mesh/base/status.h"

#include <stddef.h>
#include <stdint.h>

struct calendar;
status calendar_make(int n, struct calendar **out); /* all items at HUGE_VAL */
void calendar_free(struct calendar *c);

/* calendar_set gives an item its time (HUGE_VAL: never) before calendar_start, which sorts them all; t >= now. */
void calendar_set(struct calendar *c, int item, double t);
void calendar_start(struct calendar *c, double now);
void calendar_move(struct calendar *c, int item, double t); /* t: not before the first item's time */
int calendar_first(struct calendar *c);                     /* returns the earliest item, which stays in */
int calendar_next(const struct calendar *c, int k);         /* the k-th item after the first; < 0: not known yet */
double calendar_time(const struct calendar *c, int item);
/* Memory of a queue of n items. */
double calendar_bytes(int n);

#endif
