/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cloud, lagrangian/grains (positions, U, id, d), and uniform/grains, the exact state, here as a file `state` beside.
 */
#include "solvers/grains/grains_state.h"
#include "solvers/output/clouds.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { CELLS = 16 };

static void try_cloud(const char *folder) {
    struct cloud c;
    if (!cloud_exists(folder)) return;
    if (!accepted(cloud_read(folder, CELLS, &c))) {
        PROMISE(!c.n && !c.x && !c.u && !c.cell && !c.id, "a cloud that was refused is not there");
        return;
    }
    PROMISE(c.n > 0, "a cloud has grains");
    for (int i = 0; i < c.n; i++) {
        PROMISE(c.cell[i] >= 0 && c.cell[i] < CELLS, "grains lie in cells of the mesh");
        for (int k = 0; k < 3; k++) PROMISE(isfinite(c.x[i][k]) && (!c.u || isfinite(c.u[i][k])), "numbers are finite");
    }
    cloud_free(&c);
}

static void try_state(const char *path) {
    struct grains_state s;
    if (accepted(grains_state_read(path, &s))) {
        PROMISE(s.n > 0 && s.averages.nsums >= 0, "a state has grains");
        for (int i = 0; i < s.n; i++)
            PROMISE(s.id[i] >= 0 && s.id[i] < s.n && s.event[i].partner < s.n, "grains and partners are there");
        PROMISE(s.averages.mark.taken >= 0 && s.averages.mark.taken <= s.averages.mark.samples,
                "no more moments than a window has");
    }
    grains_state_free(&s);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char folder[256], path[300];
    scratch_unpack("time/lagrangian/grains", "positions", data, size);
    snprintf(folder, sizeof folder, "%s/time", scratch());
    try_cloud(folder);
    snprintf(path, sizeof path, "%s/lagrangian/grains/state", folder);
    if (!access(path, F_OK)) try_state(path);
    scratch_clear();
    return 0;
}
