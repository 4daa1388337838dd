/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit acoustics of dense cells: what goes from the states of a gas to its bed, and back. The engines list the
 * cells as rows, and the faces around them as borders. */
#include "libcore/gas/gas_private.h"

static int blocks_of(const struct gas *g) {
    return g->forest ? g->forest->ntiles : 1;
}

/* Are the cells of the bed others than those that have numbers? */
KERNEL static bool bed_differs(long n, const double *restrict part, const int *restrict number) {
    int differs = 0;
    for (long i = 0; i < n; i++) differs |= (part[i] > 0) != (number[i] > 0);
    return differs;
}

/* Is the bed that of the last list, on all ranks? */
static bool is_listed(const struct gas *g) {
    double changed = 0;
    for (int b = 0; b < blocks_of(g) && changed == 0; b++)
        changed = bed_differs(g->size, g->dense->part[b], g->dense->number[b]);
    comm_max(g->comm, &changed, 1);
    return changed == 0;
}

status dense_list(struct gas *g, status s, long rows, int sides) {
    struct dense *d = g->dense;
    if (!s) s = ROOM_GROW(&d->room, d->row, rows);
    if (!s) s = ROOM_GROW(&d->room, d->border, sides);
    TRY(comm_agree(g->comm, s));
    TRY(bed_list(&d->bed, sides));
    for (int b = 0; b < blocks_of(g); b++) memset(d->number[b], 0, (size_t)g->size * sizeof **d->number);
    double rest = d->bed.home->cells < d->own;
    comm_max(g->comm, &rest, 1);
    d->alone = rest == 0;
    d->rows = d->borders = d->bed.home->faces = 0;
    return OK;
}

/* Copies the bed's cells from a state, or to it. */
static void copy(const struct gas *g, const struct state *s, bool out) {
    const struct dense *d = g->dense;
    double *const *U = d->bed.home->U;
    for (int r = 0, i = 0; r < d->rows; i += d->row[r++].n)
        for (int v = 0; v < g->nvar; v++) {
            double *line = s->block[d->row[r].block] + v * g->size + d->row[r].at;
            memcpy(out ? line : U[v] + i, out ? U[v] + i : line, (size_t)d->row[r].n * sizeof *line);
        }
}

void dense_take(struct gas *g, const struct state *from) {
    copy(g, from, false);
}

long dense_put(struct gas *g, const struct state *to) {
    const struct dense *d = g->dense;
    long bad = 0;
    if (g->engine->bed.unfold) g->engine->bed.unfold(g, to);
    copy(g, to, true);
    for (int r = 0; r < d->rows; r++)
        bad += row_inadmissible(g, to->block[d->row[r].block], d->row[r].at, d->row[r].n, NULL);
    return bad;
}

/* Takes the gas beyond the borders. An open patch whose ghosts have the cell's own state lets it out freely. */
static void take_beyond(struct gas *g, const struct state *from) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    for (int i = 0; i < d->borders; i++) {
        const struct dense_border *b = &d->border[i];
        const double *U = from->block[b->block];
        bool same = true;
        if (bed->kind[b->face] == BED_WALL) continue;
        for (int v = 0; v < g->nvar; v++, U += g->size) {
            same &= bits_of(U[b->inside]) == bits_of(U[b->beyond]);
            bed->outside[v][b->face] = U[b->beyond];
            bed->kept[v][b->face] = 0;
        }
        bed->holds[b->face] = !same;
    }
}

status dense_begin(struct gas *g, const struct state *from) {
    const struct bed_hooks *engine = &g->engine->bed;
    engine->fill(g, from);
    if (!is_listed(g)) TRY(engine->list(g));
    dense_take(g, &g->U);
    bed_note_start(&g->dense->bed);
    dense_take(g, from);
    if (engine->unfold) {
        copy(g, &g->V, true);
        copy(g, &g->W, true);
    }
    take_beyond(g, from);
    if (engine->balance) engine->balance(g, from);
    g->dense->begun = true;
    return OK;
}
