/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A room owns arrays that grow by need, for sizes that change from step to step, and frees them together. */
#ifndef LIBCORE_ROOM_H
#define LIBCORE_ROOM_H

#include "mesh/base/status.h"

struct room { /* zeros are an empty room */
    struct room_array *first;
};
/* Makes room for `count` elements of `size` bytes in an array of the room. *pointer is NULL or what room_grow has set
 * it to. An array that grows gets a quarter more than is needed, and loses what it holds; else it stays as it was. */
status room_grow(struct room *r, void *pointer, long count, long size);
void room_free(struct room *r);
#define ROOM_GROW(room, pointer, count) room_grow(room, &(pointer), count, (long)sizeof *(pointer))

#endif
