/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The memory of friction in a bed (bed_friction_private.h). */
#include "libcore/acoustics/bed_friction_private.h"

#include <stdlib.h>

static double *cut(double *at, long n, double **line) {
    *line = at;
    return at + n;
}

static status make_askew(const struct bed *b, struct bed_friction *r) {
    const struct bed_set *s = &b->set;
    const long cells = (long)s->cells + s->ghosts;
    TRY(ARRAYS_GROW(&r->arrays, r->askew_cells, bed_tensors(b->dim) * cells));
    TRY(ARRAYS_GROW(&r->arrays, r->askew_faces, (long)(b->components + (1 + LINES) * r->tensors) * s->faces));
    TRY(ARRAYS_GROW(&r->arrays, r->askew, s->faces));
    TRY(ARRAYS_GROW(&r->arrays, r->back, s->face_start[s->cells]));
    double *at = r->askew_cells;
    for (int i = 0; i < bed_tensors(b->dim); i++) at = cut(at, cells, &r->inverse[i]);
    at = r->askew_faces;
    for (int k = 0; k < b->components; k++) at = cut(at, s->faces, &r->value[k]);
    for (int i = 0; i < r->tensors; i++) at = cut(at, s->faces, &r->tensor[i]);
    for (int j = 0; j < LINES; j++)
        for (int i = 0; i < r->tensors; i++) at = cut(at, s->faces, &r->mean[j][i]);
    return OK;
}

status bed_friction_room(const struct bed *b, struct bed_friction *r) {
    const struct bed_set *s = &b->set;
    const long cells = (long)s->cells + s->ghosts, sides = s->face_start[s->cells];
    const int C = b->components;
    TRY(ARRAYS_GROW(&r->arrays, r->cells, (3 + C * (2 + LINES) + b->dim * C) * cells));
    TRY(ARRAYS_GROW(&r->arrays, r->sides, b->dim * sides));
    TRY(ARRAYS_GROW(&r->arrays, r->of_faces, (4L + r->tensors + C + LINES * (C + 1)) * s->faces));
    TRY(ARRAYS_GROW(&r->arrays, r->face, s->faces));
    double *at = cut(cut(cut(r->cells, cells, &r->share), cells, &r->p), cells, &r->held);
    for (int k = 0; k < C; k++) {
        at = cut(cut(at, cells, &r->drive[k]), cells, &r->V[k]);
        for (int i = 0; i < LINES; i++) at = cut(at, cells, &r->gain[i][k]);
        for (int a = 0; a < b->dim; a++) at = cut(at, cells, &r->gradient[a][k]);
    }
    at = r->sides;
    for (int k = 0; k < b->dim; k++) at = cut(at, sides, &r->fit[k]);
    if (!s->shapes->boxes) TRY(make_askew(b, r));
    at = cut(cut(cut(r->of_faces, s->faces, &r->stiff), s->faces, &r->part), s->faces, &r->bears);
    for (int i = 0; i < r->tensors; i++) at = cut(at, s->faces, &r->base[i]);
    for (int k = 0; k < C; k++) {
        at = cut(at, s->faces, &r->traction[k]);
        for (int i = 0; i < LINES; i++) at = cut(at, s->faces, &r->through[i][k]);
    }
    if (!s->shapes->round) return OK;
    at = cut(at, s->faces, &r->hoop);
    for (int i = 0; i < LINES; i++) at = cut(at, s->faces, &r->through[i][C]); /* of the hoop stress */
    return OK;
}

status bed_friction_make(struct bed *b) {
    if (!b->friction.law || !b->friction.law->on) return OK;
    TRY(allocate(&b->rub, 1, sizeof *b->rub, "friction"));
    b->rub->tensors = bed_tensors(b->components);
    return OK;
}

void bed_friction_free(struct bed_friction *r) {
    if (r) arrays_free(&r->arrays);
    free(r);
}
