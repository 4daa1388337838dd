/* A queue of one time for each of n items, the earliest first, equal times by the item's number (so that its order does
 * not depend on how it is built). Moving an item costs the same however many there are; taking the first costs n/256
 * comparisons for some 32 that are taken. */
#ifndef LIBCORE_CALENDAR_H
#define LIBCORE_CALENDAR_H

#include "mesh/base/status.h"

#include <stddef.h>
#include <stdint.h>

struct calendar;
status calendar_make(int n, struct calendar **out); /* all items at HUGE_VAL */
void calendar_free(struct calendar *c);

/* Items before calendar_start, which sorts them all: t >= now; HUGE_VAL: never. */
void calendar_set(struct calendar *c, int item, double t);
void calendar_start(struct calendar *c, double now);
void calendar_move(struct calendar *c, int item, double t); /* to a time not before that of the first */
int calendar_first(struct calendar *c);                     /* stays in */
int calendar_next(const struct calendar *c, int k);         /* the k-th after the first; < 0: not known yet */
double calendar_time(const struct calendar *c, int item);
double calendar_bytes(int n);

#endif
