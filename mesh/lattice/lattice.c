/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises a lattice (lattice.h): finds the boxes of the cells, the grid they lie on, the face on each of their
 * sides, and what empty and cyclic patches do to the axes. */
#include "mesh/lattice/lattice.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WHY = 256, HOLES = 64 };       /* HOLES: most places of the grid per cell, so that memory stays in proportion */
static const double TOLERANCE = 1e-6; /* of a cell, where coordinates have all their digits */
enum { DIGITS = 12 };                 /* with more of them rounding is far below the tolerance */
static const double ROUNDED = 0.1;    /* of a cell: the most that rounding may move a point */

struct lattice_search {
    const struct polymesh *m;
    const struct lattice_part *part; /* where m is a part of the mesh; else NULL */
    long ncells;                     /* of the mesh */
    long failed;                     /* where the search ended: at a face, or behind all faces at a cell */
    double *box;                     /* [ncells][6]: low x y z, high x y z */
    int *side;                       /* [ncells][6] face at physical side 2*axis + (0 low, 1 high), or -1 */
    int *at;                         /* [ncells][3] position along the physical axes */
    bool gone[3];                    /* axes that empty patches remove */
    double low[3], extent[3], width[3];
    double tolerance[3]; /* of places, in cells */
    int n[3];
    int *cell; /* [n0*n1*n2] cell at a place of the grid, by physical axes, or -1 */
    bool periodic[3];
    char *why;
};

static bool no(struct lattice_search *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool no(struct lattice_search *s, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(s->why, WHY, format, args);
    va_end(args);
    return false;
}

/* The number of a cell in the whole mesh. */
static int name_of(const struct lattice_search *s, long cell) {
    return s->part ? s->part->cell[cell] : (int)cell;
}

static bool is_whole(const struct lattice_search *s, long cell) {
    return !s->part || s->part->whole[cell];
}

/* Widens a box so that it holds another one. */
static void widen(double *restrict box, const double *restrict by) {
    for (int k = 0; k < 3; k++) {
        box[k] = by[k] < box[k] ? by[k] : box[k];
        box[3 + k] = by[3 + k] > box[3 + k] ? by[3 + k] : box[3 + k];
    }
}

static void find_boxes(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    const double nowhere[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (long c = 0; c < m->ncells; c++) memcpy(s->box + 6 * c, nowhere, sizeof nowhere);
    for (int f = 0; f < m->nfaces; f++) {
        double face[6];
        memcpy(face, nowhere, sizeof face);
        for (int i = m->face_start[f]; i < m->face_start[f + 1]; i++)
            for (int k = 0; k < 3; k++) {
                const double x = m->points[3L * m->face_points[i] + k];
                face[k] = x < face[k] ? x : face[k];
                face[3 + k] = x > face[3 + k] ? x : face[3 + k];
            }
        widen(s->box + 6L * m->owner[f], face);
        if (f < m->ninternal) widen(s->box + 6L * m->neighbour[f], face);
    }
}

/* Finds the ends of the boxes along an axis, and the sum of their lengths, over all ranks that have parts. */
static status find_ends(const struct lattice_search *s, int k, double *low, double *high, double *sum) {
    *low = INFINITY;
    *high = -INFINITY;
    *sum = 0;
    for (long c = 0; c < s->m->ncells; c++) {
        const double *box = s->box + 6 * c + k;
        if (!is_whole(s, c)) continue;
        *low = box[0] < *low ? box[0] : *low;
        *high = box[3] > *high ? box[3] : *high;
        *sum += box[3] - box[0];
    }
    double *all = NULL;
    if (!s->part) return OK;
    comm_min(s->part->comm, low, 1);
    comm_max(s->part->comm, high, 1);
    TRY(comm_gather(s->part->comm, sum, 1, &all, NULL));
    for (int r = 1; all && r < comm_size(s->part->comm); r++) *sum += all[r];
    free(all);
    comm_broadcast(s->part->comm, sum, sizeof *sum);
    return OK;
}

/* Finds the grid on which the boxes would lie: the number of cells from the boxes' mean size, then the width from the
 * whole extent. */
static status find_grid(struct lattice_search *s, bool *found) {
    *found = true;
    for (int k = 0; k < 3 && *found; k++) {
        double low, high, sum;
        TRY(find_ends(s, k, &low, &high, &sum));
        double cells = (high - low) / (sum / (double)s->ncells);
        if (!(cells < INT_MAX / 2)) *found = no(s, "cells have no extent along %c", "xyz"[k]);
        if (!*found) continue;
        s->low[k] = low;
        s->extent[k] = high - low;
        s->n[k] = (int)(cells + 0.5) > 1 ? (int)(cells + 0.5) : 1;
        s->width[k] = s->extent[k] / s->n[k];
        s->tolerance[k] = TOLERANCE;
    }
    return OK;
}

/* Counts the significant digits that the coordinates have as decimals, up to DIGITS + 1. */
static int count_digits(const struct polymesh *m) {
    char text[32];
    int digits = 1;
    for (long i = 0; i < 3L * m->npoints && digits <= DIGITS; i++) do {
            snprintf(text, sizeof text, "%.*g", digits, m->points[i]);
        } while (strtod(text, NULL) != m->points[i] && ++digits <= DIGITS);
    return digits;
}

/* Widens the tolerance to what rounding may do where the mesh was written with few digits. A point, and the ends of the
 * grid, are then beside their places by half a unit of the last digit of the largest coordinate. Returns false where
 * they have all their digits, or where rounding could hide that cells differ. Collective for parts. */
static bool loosen(struct lattice_search *s) {
    double digits = count_digits(s->m);
    bool wider = false;
    if (s->part) comm_max(s->part->comm, &digits, 1);
    for (int k = 0; k < 3 && digits <= DIGITS; k++) {
        const double largest = fmax(fabs(s->low[k]), fabs(s->low[k] + s->extent[k]));
        const double half = 0.5 * pow(10, floor(log10(largest)) + 1 - digits), most = 2.02 * half / s->width[k];
        if (most > ROUNDED) return false;
        wider |= most > TOLERANCE;
        s->tolerance[k] = fmax(most, TOLERANCE);
    }
    return wider;
}

static bool place_cells(struct lattice_search *s) {
    double places = (double)s->n[0] * s->n[1] * s->n[2];
    s->failed = s->part ? s->part->nfaces : s->m->nfaces; /* behind the faces */
    if (places > INT_MAX || places > HOLES * (double)s->ncells + 1e6)
        return no(s, "%ld cells would be scattered over a grid of %d x %d x %d", s->ncells, s->n[0], s->n[1], s->n[2]);
    for (int c = 0; c < s->m->ncells; c++)
        for (int k = 0; k < 3 && is_whole(s, c); k++) {
            const double *box = s->box + 6L * c;
            double x = (box[k] - s->low[k]) / s->width[k], size = (box[3 + k] - box[k]) / s->width[k];
            int i = (int)(x + 0.5); /* x >= 0 */
            s->at[3L * c + k] = i;
            s->failed = (s->part ? s->part->nfaces : s->m->nfaces) + name_of(s, c);
            if (fabs(size - 1) > s->tolerance[k])
                return no(s, "cell %d at (%g, %g, %g) is %g long along %c, the mean cell is %g", name_of(s, c),
                          0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), 0.5 * (box[2] + box[5]),
                          box[3 + k] - box[k], "xyz"[k], s -> width[k]);
            if (fabs(x - i) > s->tolerance[k])
                return no(s, "cell %d at (%g, %g, %g) is off the grid along %c by %g of a cell", name_of(s, c),
                          0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), 0.5 * (box[2] + box[5]), "xyz"[k], x - i);
        }
    return true;
}

/* Returns the side (2*axis + 0/1) of the cell's box that a face of four points fills, or -1. There are no branches,
 * because what comes next cannot be guessed. */
static int find_side(const double *box, const double tolerance[3], const double *const x[4]) {
    int corners = 0, all = 7, any = 0;
    int inside = 0;
    for (int i = 0; i < 4; i++) {
        int corner = 0;
        for (int k = 0; k < 3; k++) {
            const int high = x[i][k] - box[k] > tolerance[k];
            inside |= high & (box[3 + k] - x[i][k] > tolerance[k]);
            corner |= high << k;
        }
        corners |= 1 << corner;
        all &= corner;
        any |= corner;
    }
    const int flat = 7 & ~(all ^ any); /* the axes along which all corners are on the same side */
    for (int i = 0; i < 3; i++) corners &= corners - 1;
    const bool four = corners && !(corners & (corners - 1)); /* four of them before three were taken away */
    if (inside || !four || (flat & (flat - 1)) || !flat) return -1;
    const int k = flat >> 1; /* 0, 1, 2 of 1, 2, 4 */
    return 2 * k + (all >> k & 1);
}

static bool find_sides(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    double tolerance[3];
    const double *x[4];
    for (long i = 0; i < 6L * m->ncells; i++) s->side[i] = -1;
    for (int k = 0; k < 3; k++) tolerance[k] = s->tolerance[k] * s->width[k];
    for (int f = 0; f < m->nfaces; f++) {
        const int *p = m->face_points + m->face_start[f], n = m->face_start[f + 1] - m->face_start[f];
        for (int i = 0; i < 4; i++) x[i] = m->points + 3L * p[i < n ? i : 0];
        for (int half = 0; half < (f < m->ninternal ? 2 : 1); half++) {
            const int c = half ? m->neighbour[f] : m->owner[f];
            const double *b = s->box + 6L * c;
            if (!is_whole(s, c)) continue;
            s->failed = s->part ? s->part->face[f] : f;
            const int side = n == 4 ? find_side(b, tolerance, x) : -1;
            if (side < 0 || s->side[6L * c + side] >= 0)
                return no(s, "cell %d at (%g, %g, %g) is no box with faces normal to x, y, z", name_of(s, c),
                          0.5 * (b[0] + b[3]), 0.5 * (b[1] + b[4]), 0.5 * (b[2] + b[5]));
            s->side[6L * c + side] = f;
        }
    }
    for (long i = 0; i < 6L * m->ncells; i++)
        if (s->side[i] < 0 && is_whole(s, i / 6)) {
            const double *b = s->box + i / 6 * 6;
            s->failed = (s->part ? s->part->nfaces : m->nfaces) + name_of(s, i / 6);
            return no(s, "cell %d at (%g, %g, %g) is no box: side %ld has no face", name_of(s, i / 6),
                      0.5 * (b[0] + b[3]), 0.5 * (b[1] + b[4]), 0.5 * (b[2] + b[5]), i % 6);
        }
    return true;
}

static long place_of(const struct lattice_search *s, const int *at) {
    return at[0] + s->n[0] * (at[1] + (long)s->n[1] * at[2]);
}

/* Puts each cell in its place, one per place. Neighbours on the grid must share a face, else a wall without thickness
 * stands between them. */
static bool fill_places(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    for (int c = 0; c < m->ncells; c++) {
        int *slot = &s->cell[place_of(s, s->at + 3L * c)];
        const double *b = s->box + 6L * c;
        if (*slot >= 0) return no(s, "cells %d and %d lie on each other at (%g, %g, %g)", *slot, c, b[0], b[1], b[2]);
        *slot = c;
    }
    for (int c = 0; c < m->ncells; c++)
        for (int k = 0; k < 3; k++) {
            int at[3] = {s->at[3L * c], s->at[3L * c + 1], s->at[3L * c + 2]}, f = s->side[6L * c + 2 * k + 1];
            const double *b = s->box + 6L * c;
            int next = ++at[k] < s->n[k] ? s->cell[place_of(s, at)] : -1;
            if (next >= 0 && f != s->side[6L * next + 2 * k])
                return no(s, "cells %d and %d meet at (%g, %g, %g) but share no face: a wall without thickness", c,
                          next, b[3], b[4], b[5]);
        }
    return true;
}

/* ---- empty and cyclic patches ------------------------------------------------------------------------------------ */

static int side_of(const struct lattice_search *s, int face) {
    for (int i = 0; i < 6; i++)
        if (s->side[6L * s->m->owner[face] + i] == face) return i;
    return -1;
}

static bool check_empty(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        for (int f = p->start; f < p->start + p->nfaces && strcmp(p->type, "empty") == 0; f++)
            s->gone[side_of(s, f) / 2] = true;
    }
    for (int k = 0; k < 3; k++)
        if (s->gone[k] && s->n[k] != 1)
            return no(s, "empty patches close the %c axis, but the mesh is %d cells thick there", "xyz"[k], s -> n[k]);
    return true;
}

/* Checks that both halves fill opposite ends of the whole grid: face i at (0, j, k) belongs to face i at (n - 1, j,
 * k). */
static bool check_cyclic(struct lattice_search *s, const struct patch *p, const struct patch *q) {
    int axis = -1;
    for (int i = 0; i < p->nfaces; i++) {
        int a = s->m->owner[p->start + i], b = s->m->owner[q->start + i], side = side_of(s, p->start + i);
        int k = side / 2, end = s->n[k] - 1;
        bool good = side_of(s, q->start + i) == (side ^ 1) && (axis < 0 || k == axis);
        for (int j = 0; j < 3; j++) {
            int pa = s->at[3L * a + j], pb = s->at[3L * b + j];
            good = good && (j != k ? pa == pb : pa == (side & 1 ? end : 0) && pb == end - pa);
        }
        if (!good)
            return no(s, "cyclic patches '%s' and '%s' do not wrap the whole mesh along one axis (cells %d and %d)",
                      p->name, q->name, a, b);
        axis = k;
    }
    if (axis >= 0) s->periodic[axis] = true;
    return true;
}

/* Checks that a cyclic axis is cyclic everywhere: no other patch lies at its ends. */
static bool check_ends(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        for (int f = p->start; f < p->start + p->nfaces && strcmp(p->type, "cyclic") != 0; f++) {
            int side = side_of(s, f), k = side / 2, at = s->at[3L * m->owner[f] + k];
            if (s->periodic[k] && at == (side & 1 ? s->n[k] - 1 : 0))
                return no(s, "the %c axis is cyclic only in part: patch '%s' (%s) is at its end, too", "xyz"[k],
                          p -> name, p -> type);
        }
    }
    return true;
}

static bool check_patches(struct lattice_search *s) {
    const struct polymesh *m = s->m;
    if (!check_empty(s)) return false;
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        if (strcmp(p->type, "cyclic") != 0) continue;
        int j = p->neighbour ? polymesh_find_patch(m, p->neighbour) : -1;
        if (j < 0 || m->patch[j].nfaces != p->nfaces)
            return no(s, "cyclic patch '%s' has no equal other half", p->name);
        if (!check_cyclic(s, p, &m->patch[j])) return false;
    }
    return check_ends(s);
}

/* ---- the lattice ------------------------------------------------------------------------------------------------- */

static void set_axes(const struct lattice_search *s, struct lattice *l) {
    int gone = 0;
    for (int k = 0; k < 3; k++) gone += s->gone[k];
    l->thickness = 1;
    for (int k = 0, out = 3 - gone; k < 3; k++) {
        int to = s->gone[k] ? out++ : l->dim++;
        l->axis[to] = k;
        l->n[to] = s->n[k];
        l->origin[to] = s->low[k] + 0.0; /* no -0: which of both zeros is the least depends on the order */
        l->width[to] = s->width[k];
        l->periodic[to] = s->periodic[k];
        if (s->gone[k]) l->thickness *= s->extent[k];
    }
}

/* Makes the lattice in computational axes. Empty axes have one cell, so places keep their order when the axes are
 * renamed. */
static status make_lattice(const struct lattice_search *s, struct lattice *l) {
    const struct polymesh *m = s->m;
    set_axes(s, l);
    if (l->dim == 0)
        return fail(ERR_INPUT, "mesh: empty patches close x, y and z; an axis to solve along must be left");
    long places = (long)l->n[0] * l->n[1] * l->n[2];
    TRY(allocate(&l->cell, places, sizeof *l->cell, "the lattice"));
    memcpy(l->cell, s->cell, (size_t)places * sizeof *l->cell);
    TRY(allocate(&l->face, 6L * m->ncells, sizeof *l->face, "the lattice"));
    for (long c = 0; c < m->ncells; c++)
        for (int i = 0; i < 6; i++)
            l->face[6 * c + i] = i / 2 < l->dim ? s->side[6 * c + 2 * l->axis[i / 2] + i % 2] : -1;
    return OK;
}

static status make_room(struct lattice_search *s) {
    const long n = s->m->ncells;
    TRY(allocate(&s->box, 6 * n, sizeof *s->box, "the lattice"));
    TRY(allocate(&s->side, 6 * n, sizeof *s->side, "the lattice"));
    return allocate(&s->at, 3 * n, sizeof *s->at, "the lattice");
}

static status fill_within(struct lattice_search *s, bool *is_lattice) {
    if (!find_sides(s) || !place_cells(s)) return OK;
    long places = (long)s->n[0] * s->n[1] * s->n[2];
    TRY(allocate(&s->cell, places, sizeof *s->cell, "the lattice"));
    for (long i = 0; i < places; i++) s->cell[i] = -1;
    *is_lattice = fill_places(s) && check_patches(s);
    return OK;
}

static status fill(struct lattice_search *s, bool *is_lattice) {
    bool found;
    if (s->m->ncells == 0) return fail(ERR_INPUT, "mesh: no cells");
    TRY(make_room(s));
    find_boxes(s);
    TRY(find_grid(s, &found));
    if (!found) return OK;
    TRY(fill_within(s, is_lattice));
    return *is_lattice || s->cell || !loosen(s) ? OK : fill_within(s, is_lattice); /* cells: all lie on the grid */
}

status lattice_recognise(const struct polymesh *m, struct lattice **out, char why[WHY]) {
    struct lattice_search s = {.m = m, .ncells = m->ncells, .why = why};
    struct lattice *l = NULL;
    bool is_lattice = false;
    why[0] = 0;
    *out = NULL;
    status st = fill(&s, &is_lattice);
    if (is_lattice) why[0] = 0; /* of the first try */
    if (!st && is_lattice) {
        st = allocate(&l, 1, sizeof *l, "the lattice");
        if (!st) st = make_lattice(&s, l);
        if (st) {
            lattice_free(l);
            l = NULL;
        }
    }
    free(s.box);
    free(s.side);
    free(s.at);
    free(s.cell);
    *out = l;
    return st;
}

/* ---- parts of a mesh --------------------------------------------------------------------------------------------- */

/* Gives all ranks the reason of the rank that found the first one; `failed` says where a rank did. */
static void share_reason(const struct comm *c, double failed, char why[WHY], bool *found) {
    double first = failed, rank = HUGE_VAL;
    comm_min(c, &first, 1);
    *found = isfinite(first);
    if (!*found) return;
    if (failed == first) rank = comm_rank(c);
    comm_min(c, &rank, 1);
    if (rank > 0 && (comm_rank(c) == (int)rank || comm_root(c))) comm_to_root(c, (int)rank, why, WHY);
    comm_broadcast(c, why, WHY);
}

static void rule_out_within(struct lattice_search *s, bool *ruled_out) {
    share_reason(s->part->comm, find_sides(s) ? HUGE_VAL : (double)s->failed, s->why, ruled_out);
    if (!*ruled_out) share_reason(s->part->comm, place_cells(s) ? HUGE_VAL : (double)s->failed, s->why, ruled_out);
}

status lattice_rule_out(const struct lattice_part *part, bool *ruled_out, char why[WHY]) {
    struct lattice_search s = {.m = part->mesh, .part = part, .ncells = part->ncells, .why = why};
    bool found = false;
    why[0] = 0;
    *ruled_out = false;
    status e = comm_agree(part->comm, make_room(&s));
    if (!e) find_boxes(&s);
    if (!e) e = find_grid(&s, &found);
    if (!e && !found) *ruled_out = true; /* on all ranks */
    if (!e && found) rule_out_within(&s, ruled_out);
    if (!e && found && *ruled_out && loosen(&s)) rule_out_within(&s, ruled_out);
    free(s.box);
    free(s.side);
    free(s.at);
    return e;
}
