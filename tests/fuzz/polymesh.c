/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/fuzz/target.h"

#include <stdio.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char dir[256];
    struct polymesh *m = NULL;
    scratch_unpack("polyMesh", "points", data, size);
    snprintf(dir, sizeof dir, "%s/polyMesh", scratch());
    bool good = accepted(polymesh_read(dir, &m));
    PROMISE(good == (m != NULL), "there is a mesh if there is no error");
    if (good) try_mesh(m);
    scratch_clear();
    return 0;
}
