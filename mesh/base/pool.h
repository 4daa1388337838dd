/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory of one owner that is freed at once. A zeroed pool is empty. */
#ifndef MESH_POOL_H
#define MESH_POOL_H

#include "mesh/base/status.h"

struct pool_piece;
struct pool {
    struct pool_piece *last;
};
/* Allocates as `allocate` does (status.h); pool_free frees the objects. */
status pool_take(struct pool *p, void *out, long count, long size, const char *what);
void pool_free(struct pool *p);

#endif
