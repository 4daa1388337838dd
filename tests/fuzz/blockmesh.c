/* SPDX-License-Identifier: GPL-3.0-or-later */
/* system/blockMeshDict: a mesh of boxes that is taken has the faces of a sound mesh. */
#include "solvers/case/blockmesh.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>

enum { FEW = 2000 }; /* cells of a mesh of which points and faces are made */

static void try_boxes(struct polymesh *m) {
    PROMISE(m->boxes && m->ncells > 0 && m->npatches >= 0, "a mesh of boxes has cells");
    long sides = 0;
    for (int i = 0; i < m->npatches; i++) {
        PROMISE(m->patch[i].name && *m->patch[i].name && m->patch[i].nfaces >= 0, "a patch has a name and faces");
        sides += m->patch[i].nfaces;
    }
    if (m->ncells > FEW || !accepted(polymesh_complete(m))) return;
    PROMISE(m->ninternal + sides == m->nfaces, "all faces on the boundary belong to patches");
    for (long i = 0; i < 3L * m->npoints; i++) PROMISE(fabs(m->points[i]) <= 1e60, "points are bounded");
    PROMISE(accepted(polymesh_check(m)), "what was taken is a sound mesh");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char dir[256];
    struct case_mesh mesh;
    scratch_unpack("case", "system/blockMeshDict", data, size);
    snprintf(dir, sizeof dir, "%s/case", scratch());
    if (accepted(case_mesh_read(dir, &mesh))) {
        try_boxes(mesh.mesh);
        polymesh_free(mesh.mesh);
    }
    scratch_clear();
    return 0;
}
