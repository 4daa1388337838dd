/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory that grows by need and stays, for sizes that change from step to step. */
#ifndef LIBCORE_ROOM_H
#define LIBCORE_ROOM_H

#include "mesh/base/status.h"

struct room {
    void *data;
    long bytes;
};
/* Makes room for `count` elements and sets the pointer *out to it. When memory grows its content is lost; else it stays
 * as it was. */
status room_grow(struct room *room, long count, long size, void *out);
void room_forget(struct room *room, int n); /* frees n of them */

#endif
