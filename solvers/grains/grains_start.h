/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The start of granularMD from its time folder: the fields of the gas's start say where grains are put and how they
 * move, and give the patches of written fields. */
#ifndef SOLVERS_GRAINS_START_H
#define SOLVERS_GRAINS_START_H

#include "libcore/grains/packing.h"
#include "solvers/case/case.h"
#include "solvers/grains/grains_mesh.h"
#include "solvers/grains/grains_models.h"

struct grains_start {
    struct field *field[FIELD_COUNT]; /* NULL: no such file */
    /* [cells] of a box, axis 0 fastest, or of `mesh`; u along computational axes */
    double *alpha, *T, *u[3];
    const struct grains_mesh *mesh; /* NULL: the cells fill a box */
};
void grains_files(struct setup *s, const struct grains_models *m); /* notes what was read */
/* Reads the fields. grains_start_take then takes their values for the start, on a mesh (NULL: a box). saved: the
 * grains' own state is there, so that only the patches count. */
status grains_start_read(const struct setup *s, const struct grains_models *m, bool saved, struct grains_start *out);
status grains_start_take(const struct setup *s, const struct grains_models *m, const struct grains_mesh *mesh,
                         bool saved, struct grains_start *p);
/* Takes the restitution of walls from T, where it is granularWall or JohnsonJacksonSlip, and of hard grains how rough
 * they are from U; fails if particleProperties or the other field says something else. */
status grains_start_walls(const struct setup *s, const struct grains_start *p, struct grains_models *m);
/* Fails if a scalar has another value on a wall. */
status grains_start_check(const struct setup *s, const struct grains_models *m, const struct grains_start *p);
void grains_start_free(struct grains_start *p);
void grains_start_drop(struct grains_start *p); /* frees all but the patches */

struct grain_start {
    int n;
    double (*x)[3], (*u)[3]; /* [n] m, m/s, along computational axes */
    double (*spin)[3];       /* [n] 1/s, if the cloud gives them; else NULL */
    struct packing_report packing;
    bool from_cloud;
};
/* Makes the start from lagrangian/grains of the time folder or, without it, from the fields. The caller frees x, u and
 * spin, also after an error. */
status grain_start_make(const struct setup *s, struct grains_models *m, const struct grain_box *box,
                        const struct grains_start *fields, struct grain_start *out);
/* Makes grains under another box or law, with the places and velocities that `old` has at its time; those that have
 * left stay away. Numbers go by kind, law->kinds gets how many there are of each; `kinds` is the number of kinds of
 * `old`: if the law has another, the numbers of the grains say their kinds. */
status grain_start_anew(const struct grain_box *box, struct grain_law *law, const struct grains *old, int kinds,
                        struct grains **out);

#endif
