/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays that grow by need (arrays.h): a list of them, each with its head in the 64 bytes before its elements. */
#include "libcore/multigrid/arrays.h"

#include <stdlib.h>
#include <string.h>

enum { HEAD = 64 };
struct grown_array {
    struct grown_array *next;
    long bytes;
};
_Static_assert(sizeof(struct grown_array) <= HEAD, "elements are aligned as their array is");

static void forget(struct arrays *r, struct grown_array *a) {
    struct grown_array **at = &r->first;
    while (*at != a) at = &(*at)->next;
    *at = a->next;
    free(a);
}

status arrays_grow(struct arrays *r, void *pointer, long count, long size) {
    struct grown_array *a;
    char *elements;
    memcpy(&elements, pointer, sizeof elements);
    const long bytes = count * size;
    if (elements) {
        a = (struct grown_array *)(elements - HEAD);
        if (bytes <= a->bytes) return OK;
        forget(r, a);
        memset(pointer, 0, sizeof elements);
    }
    TRY(allocate(&a, HEAD + bytes + bytes / 4, 1, "a bed"));
    *a = (struct grown_array){r->first, bytes + bytes / 4};
    r->first = a;
    elements = (char *)a + HEAD;
    memcpy(pointer, &elements, sizeof elements);
    return OK;
}

void arrays_free(struct arrays *r) {
    while (r->first) forget(r, r->first);
}
