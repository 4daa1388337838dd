/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays that grow by need (room.h): a list of them, each with its head in the 64 bytes before its elements. */
#include "libcore/multigrid/room.h"

#include <stdlib.h>
#include <string.h>

enum { HEAD = 64 };
struct room_array {
    struct room_array *next;
    long bytes;
};
_Static_assert(sizeof(struct room_array) <= HEAD, "elements are aligned as their array is");

static void forget(struct room *r, struct room_array *a) {
    struct room_array **at = &r->first;
    while (*at != a) at = &(*at)->next;
    *at = a->next;
    free(a);
}

status room_grow(struct room *r, void *pointer, long count, long size) {
    struct room_array *a;
    char *elements;
    memcpy(&elements, pointer, sizeof elements);
    const long bytes = count * size;
    if (elements) {
        a = (struct room_array *)(elements - HEAD);
        if (bytes <= a->bytes) return OK;
        forget(r, a);
        memset(pointer, 0, sizeof elements);
    }
    TRY(allocate(&a, HEAD + bytes + bytes / 4, 1, "a bed"));
    *a = (struct room_array){r->first, bytes + bytes / 4};
    r->first = a;
    elements = (char *)a + HEAD;
    memcpy(pointer, &elements, sizeof elements);
    return OK;
}

void room_free(struct room *r) {
    while (r->first) forget(r, r->first);
}
