/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polyMesh in slices, as one rank of one reads it. */
#include "mesh/spread/spread.h"
#include "mesh/lattice/lattice.h"
#include "tests/fuzz/target.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Have both lattices the same cells and the same faces on patches at all places? */
static void compare_places(const struct lattice *l, const struct polymesh *m, const struct lattice *of_sites,
                           const struct polymesh *outline) {
    int *row = malloc((size_t)l->n[0] * sizeof *row);
    if (!row) return;
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++) {
            at[0] = 0;
            lattice_row(of_sites, at, l->n[0], row);
            PROMISE(accepted(lattice_name(of_sites, l->n[0], row)), "places can be named");
            for (; at[0] < l->n[0]; at[0]++) {
                PROMISE(row[at[0]] == lattice_cell(l, at), "a place has the cell of the whole mesh");
                for (int side = 0; side < 2 * l->dim && row[at[0]] >= 0; side++) {
                    long one, other;
                    PROMISE(lattice_patch(l, m, at, side, &one) == lattice_patch(of_sites, outline, at, side, &other) &&
                                one == other,
                            "a side has the face of the whole mesh");
                }
            }
        }
    free(row);
}

static void compare_lattice(const struct polymesh *outline, const struct polymesh *m) {
    struct lattice *l = NULL, *of_sites = NULL;
    char why[256];
    PROMISE(accepted(lattice_recognise(m, &l, why)) && l, "what has sites is a lattice");
    PROMISE(accepted(lattice_of_sites(outline, &of_sites)), "sites make a lattice");
    PROMISE(l->dim == of_sites->dim && l->thickness == of_sites->thickness &&
                !memcmp(l->axis, of_sites->axis, sizeof l->axis) && !memcmp(l->n, of_sites->n, sizeof l->n) &&
                !memcmp(l->origin, of_sites->origin, sizeof l->origin) &&
                !memcmp(l->width, of_sites->width, sizeof l->width) &&
                !memcmp(l->periodic, of_sites->periodic, sizeof l->periodic),
            "it is the lattice of the whole mesh");
    compare_places(l, m, of_sites, outline);
    lattice_free(l);
    lattice_free(of_sites);
}

static void compare(const struct polymesh *outline, const char *dir) {
    struct polymesh *m = NULL;
    PROMISE(accepted(polymesh_read(dir, &m)) && accepted(polymesh_check(m)), "what slices let pass is a sound mesh");
    PROMISE(polymesh_checksum(m) == polymesh_checksum(outline), "it is the mesh of the files");
    if (outline->outline->sites) compare_lattice(outline, m);
    polymesh_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct comm *alone;
    char dir[256];
    scratch_unpack("polyMesh", "points", data, size);
    snprintf(dir, sizeof dir, "%s/polyMesh", scratch());
    PROMISE(accepted(comm_alone(&alone)), "a rank can be alone");
    for (int lattice = 0; lattice < 2; lattice++) {
        struct polymesh *outline = NULL;
        struct spread *s = NULL;
        if (accepted(spread_read(dir, alone, lattice, false, &s, &outline)) && outline) compare(outline, dir);
        spread_free(s);
        polymesh_free(outline);
    }
    comm_alone_free(alone);
    scratch_clear();
    return 0;
}
