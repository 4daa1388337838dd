/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays that grow by need, for sizes that change from step to step, with one owner, which frees them together. */
#ifndef LIBCORE_ARRAYS_H
#define LIBCORE_ARRAYS_H

#include "mesh/base/status.h"

struct arrays { /* zeros: there are none */
    struct grown_array *first;
};
/* Makes room for `count` elements of `size` bytes in one of the arrays. *pointer is NULL or what arrays_grow has set
 * it to. An array that grows gets a quarter more than is needed, and loses what it holds; else it stays as it was. */
status arrays_grow(struct arrays *r, void *pointer, long count, long size);
void arrays_free(struct arrays *r);
#define ARRAYS_GROW(arrays, pointer, count) arrays_grow(arrays, &(pointer), count, (long)sizeof *(pointer))

#endif
