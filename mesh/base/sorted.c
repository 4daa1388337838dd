/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts lists of numbers (sorted.h) by their low and then by their high 16 bits, in time that grows as their length. */
#include "mesh/base/sorted.h"

#include <stdlib.h>

enum { DIGITS = 1 << 16, SPARSE = 8 };

static void sort_by(int shift, const int *from, long n, long *next, int *to) {
    for (int d = 0; d <= DIGITS; d++) next[d] = 0;
    for (long i = 0; i < n; i++) next[(from[i] >> shift) % DIGITS + 1]++;
    for (int d = 0; d < DIGITS; d++) next[d + 1] += next[d];
    for (long i = 0; i < n; i++) to[next[(from[i] >> shift) % DIGITS]++] = from[i];
}

status sorted_make(int *v, long *n) {
    long *next = NULL, unique = 0;
    int *other = NULL;
    status e = allocate(&next, DIGITS + 1L, sizeof *next, "a sorted list");
    if (!e) e = allocate(&other, *n, sizeof *other, "a sorted list");
    if (!e) sort_by(0, v, *n, next, other);
    if (!e) sort_by(16, other, *n, next, v);
    free(next);
    free(other);
    TRY(e);
    for (long i = 0; i < *n; i++)
        if (unique == 0 || v[i] != v[unique - 1]) v[unique++] = v[i];
    *n = unique;
    return OK;
}

long sorted_find(const int *v, long n, int x) {
    long low = 0;
    for (long high = n; low < high;) {
        const long middle = low + (high - low) / 2;
        if (v[middle] < x)
            low = middle + 1;
        else
            high = middle;
    }
    return low < n && v[low] == x ? low : -1;
}

/* Looks names up in a table where they lie so dense that it is small, else in the list. */
status sorted_places(const int *v, long n, int *names, long m) {
    int *table = NULL;
    const long range = n ? (long)v[n - 1] - v[0] + 1 : 0;
    if (range <= SPARSE * n) TRY(allocate(&table, range, sizeof *table, "a list of names"));
    for (long i = 0; table && i < n; i++) table[v[i] - v[0]] = (int)i;
    for (long i = 0; i < m; i++) names[i] = table ? table[names[i] - v[0]] : (int)sorted_find(v, n, names[i]);
    free(table);
    return OK;
}
