/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ascending lists of numbers from 0 on, each of which stands once: the names, in a whole mesh, of what a rank has. */
#ifndef MESH_SORTED_H
#define MESH_SORTED_H

#include "mesh/base/status.h"

/* Sorts v[n], numbers from 0 on, and takes out those that stand again; *n is how many are left. */
status sorted_make(int *v, long *n);
/* Where x stands in v[n], or -1. */
long sorted_find(const int *v, long n, int x);
/* Replaces names[m], which all stand in v[n], by their places there. */
status sorted_places(const int *v, long n, int *names, long m);

#endif
