/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory that grows by need and stays (room.h). */
#include "libcore/acoustics/room.h"

#include <stdlib.h>
#include <string.h>

status room_grow(struct room *room, long count, long size, void *out) {
    if (count * size > room->bytes || !room->data) {
        const long bytes = count * size + count * size / 4;
        free(room->data);
        *room = (struct room){NULL, 0};
        TRY(allocate(&room->data, bytes, 1, "a bed"));
        room->bytes = bytes;
    }
    memcpy(out, &room->data, sizeof room->data);
    return OK;
}

void room_forget(struct room *room, int n) {
    for (int i = 0; i < n; i++) free(room[i].data);
}
