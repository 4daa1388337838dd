/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lattice of a mesh of boxes or of one with sites, and the places of cells and patches on any lattice (lattice.h).
 */
#include "mesh/lattice/lattice.h"

#include <stdlib.h>
#include <string.h>

void lattice_free(struct lattice *l) {
    if (!l) return;
    free(l->cell);
    free(l->face);
    free(l);
}

static long index_of(const struct lattice *l, const int at[3]) {
    return at[0] + l->n[0] * (at[1] + (long)l->n[1] * at[2]);
}

/* Turns a place along computational axes into one along x, y, z. */
static void turn(const struct lattice *l, const int at[3], int place[3]) {
    for (int k = 0; k < 3; k++) place[l->axis[k]] = at[k];
}

bool lattice_is_local(const struct lattice *l) {
    return l->cell || !l->sites;
}

long lattice_cell(const struct lattice *l, const int at[3]) {
    int place[3];
    if (l->cell) return l->cell[index_of(l, at)];
    turn(l, at, place);
    return boxes_cell(l->boxes, place);
}

void lattice_row(const struct lattice *l, const int at[3], int n, int *cell) {
    if (l->cell) {
        memcpy(cell, l->cell + index_of(l, at), (size_t)n * sizeof *cell);
        return;
    }
    for (int i = 0; l->sites && i < n; i++) cell[i] = (int)index_of(l, at) + i;
    for (int i = 0; l->boxes && i < n;) {
        const int here[3] = {at[0] + i, at[1], at[2]};
        int place[3], step = 0, many = 1;
        turn(l, here, place);
        const int found = boxes_find(l->boxes, place);
        if (found >= 0) {
            const struct brick *b = &l->boxes->box[found];
            const int k = l->axis[0];
            many = b->low[k] + b->n[k] - place[k];
            step = b->cell.down[k] ? -1 : 1;
            for (int a = 0; b->cell.axis[a] != k; a++) step *= b->n[b->cell.axis[a]];
        }
        const int first = found < 0 ? -1 : (int)boxes_cell(l->boxes, place);
        for (int j = 0; j < many && i < n; j++) cell[i++] = first + j * step;
    }
}

int lattice_patch(const struct lattice *l, const struct polymesh *m, const int at[3], int side, long *face) {
    *face = -1;
    if (l->face) {
        const int f = l->face[6L * l->cell[index_of(l, at)] + side];
        int p = 0;
        if (f < m->ninternal) return -1;
        while (f >= m->patch[p].start + m->patch[p].nfaces) p++;
        *face = f - m->patch[p].start;
        return p;
    }
    int place[3];
    turn(l, at, place);
    side = 2 * l->axis[side / 2] + side % 2;
    return l->sites ? sites_patch(l->sites, place, side, face) : boxes_patch(l->boxes, place, side, face);
}

status lattice_name(const struct lattice *l, long n, int *cell) {
    return lattice_is_local(l) ? OK : sites_name(l->sites, n, cell);
}

status lattice_before(const struct lattice *l, int k, int *before) {
    const struct sites *s = l->sites;
    const long n = s->cells.end - s->cells.first;
    int at[3], x = l->axis[k];
    for (long i = 0; i < n; i++) { /* the cell itself stands for none, until it has its name */
        sites_at(s, s->place[i], at);
        at[x] -= at[x] > 0;
        before[i] = (int)sites_place(s, at);
    }
    TRY(sites_name(s, n, before));
    for (long i = 0; i < n; i++)
        if (before[i] == s->cells.first + i) before[i] = -1;
    return OK;
}

double lattice_volume(const struct lattice *l) {
    double volume = 1;
    for (int k = 0; k < 3; k++) volume *= l->width[k];
    return volume;
}

void lattice_centres(const struct lattice *l, double *centre) {
    const int *c = l->cell;
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++)
            for (at[0] = 0; at[0] < l->n[0]; at[0]++, c++)
                for (int k = 0; k < l->dim && *c >= 0; k++)
                    centre[3L * *c + l->axis[k]] = l->origin[k] + l->width[k] * (at[k] + 0.5);
}

bool lattice_may_be_uniform(const struct lattice *l, const struct polymesh *m, int k) {
    return l->periodic[k] && l->n[k] > 1 && m->ncells == (long)l->n[0] * l->n[1] * l->n[2];
}

void lattice_drop_faces(struct lattice *l) {
    free(l->face);
    l->face = NULL;
}

void lattice_drop(struct lattice *l) {
    lattice_drop_faces(l);
    free(l->cell);
    l->cell = NULL;
}

void lattice_at(const struct lattice *l, long cell, int at[3]) {
    int place[3];
    if (l->sites)
        sites_at(l->sites, l->sites->place[cell - l->sites->cells.first], place);
    else
        boxes_at(l->boxes, cell, place);
    for (int k = 0; k < 3; k++) at[k] = place[l->axis[k]];
}

void lattice_centre(const struct lattice *l, long cell, double x[3]) {
    int at[3] = {0};
    if (!l->cell) {
        lattice_at(l, cell, at);
    } else {
        long i = 0;
        while (l->cell[i] != cell) i++;
        at[0] = (int)(i % l->n[0]);
        at[1] = (int)(i / l->n[0] % l->n[1]);
        at[2] = (int)(i / l->n[0] / l->n[1]);
    }
    for (int k = 0; k < l->dim; k++) x[l->axis[k]] = l->origin[k] + l->width[k] * (at[k] + 0.5);
}

/* ---- meshes without tables ---- */

/* Puts the closed axes behind the others. */
static void set_axes(const struct polymesh *m, const int n[3], const double low[3], const double extent[3],
                     const double width[3], struct lattice *l) {
    int taken[3] = {0, 0, 0};
    l->dim = polymesh_axes(m, l->axis);
    for (int k = 0; k < l->dim; k++) taken[l->axis[k]] = 1;
    for (int x = 0, k = l->dim; x < 3; x++)
        if (!taken[x]) l->axis[k++] = x;
    l->thickness = 1;
    for (int k = 0; k < 3; k++) {
        const int x = l->axis[k];
        l->n[k] = n[x];
        l->origin[k] = low[x] + 0.0; /* no -0 */
        l->width[k] = width[x];
        if (k >= l->dim) l->thickness *= extent[x];
    }
}

static void wrap_axes(const struct polymesh *m, struct lattice *l) {
    const struct boxes *b = m->boxes;
    for (int p = 0; p < m->npatches; p++) {
        if (strcmp(m->patch[p].type, "cyclic") != 0 || b->first[p] == b->first[p + 1]) continue;
        for (int k = 0; k < 3; k++)
            if (l->axis[k] == b->side[b->first[p]].side / 2) l->periodic[k] = true;
    }
}

status lattice_of_boxes(const struct polymesh *m, struct lattice **out) {
    struct lattice *l;
    const struct boxes *b = m->boxes;
    const double extent[3] = {b->high[0] - b->low[0], b->high[1] - b->low[1], b->high[2] - b->low[2]};
    *out = NULL;
    TRY(allocate(&l, 1, sizeof *l, "the lattice"));
    l->boxes = b;
    set_axes(m, b->n, b->low, extent, b->width, l);
    wrap_axes(m, l);
    *out = l;
    return OK;
}

status lattice_of_sites(const struct polymesh *m, struct lattice **out) {
    struct lattice *l;
    const struct sites *s = m->outline->sites;
    *out = NULL;
    TRY(allocate(&l, 1, sizeof *l, "the lattice"));
    l->sites = s;
    set_axes(m, s->n, s->low, s->extent, s->width, l);
    for (int k = 0; k < l->dim; k++) l->periodic[k] = s->periodic[l->axis[k]];
    *out = l;
    return OK;
}

/* Sets the faces of all cells, at the sides of the solved axes, from owner, neighbour and the patches. */
static void take_faces(struct lattice *l, const struct polymesh *m) {
    for (long i = 0; i < 6L * m->ncells; i++) l->face[i] = -1;
    for (int f = 0; f < m->ninternal; f++) {
        int from[3], to[3];
        boxes_at(l->boxes, m->owner[f], from);
        boxes_at(l->boxes, m->neighbour[f], to);
        for (int k = 0; k < l->dim; k++) {
            const int step = to[l->axis[k]] - from[l->axis[k]];
            if (!step) continue;
            l->face[6L * m->owner[f] + 2 * k + (step > 0)] = f;
            l->face[6L * m->neighbour[f] + 2 * k + (step < 0)] = f;
        }
    }
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            int at[3], side;
            boxes_face_at(l->boxes, p, i, at, &side);
            for (int k = 0; k < l->dim; k++)
                if (l->axis[k] == side / 2)
                    l->face[6L * m->owner[m->patch[p].start + i] + 2 * k + side % 2] = m->patch[p].start + i;
        }
}

/* Takes the tables of the lattice that is recognised in the whole mesh. */
static status take_tables(struct lattice *l, const struct polymesh *m) {
    struct lattice *known;
    char why[256];
    TRY(lattice_recognise(m, &known, why));
    if (!known) return fail(ERR_INPUT, "%s: it is no lattice any more: %s", m->outline->dir, why);
    l->cell = known->cell;
    l->face = known->face;
    known->cell = known->face = NULL;
    lattice_free(known);
    return OK;
}

status lattice_complete(struct lattice *l, struct polymesh *m) {
    TRY(polymesh_complete(m));
    if (l->cell) return OK;
    if (l->sites) return take_tables(l, m);
    int *cell;
    TRY(allocate(&l->face, 6L * m->ncells, sizeof *l->face, "the lattice"));
    TRY(allocate(&cell, (long)l->n[0] * l->n[1] * l->n[2], sizeof *cell, "the lattice"));
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++) lattice_row(l, at, l->n[0], cell + index_of(l, at));
    take_faces(l, m);
    l->cell = cell;
    return OK;
}
