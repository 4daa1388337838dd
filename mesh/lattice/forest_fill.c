/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the ghost layers of a forest (the lattice cut into tiles, forest.h) by lists of boxes to copy, made once. A
 * tile's ghosts are filled just before the tile is computed, while its rows pass through the cache anyway: from other
 * tiles of this rank, or from the one message that every neighbour rank sends. */
#include <string.h>

#include "mesh/lattice/forest_private.h"

static void append(struct copies *list, struct copy c) {
    if (list->item) list->item[list->n] = c;
    list->n++;
}

static long cell_offset(const struct forest *f, const int i[3]) {
    return f->first + i[0] + i[1] * f->stride[1] + i[2] * f->stride[2];
}

/* Returns the offset of the first cell of layer `layer`, counted along the side's axis. */
static long layer_offset(const struct forest *f, int side, int layer) {
    int i[3] = {0};
    i[side / 2] = layer;
    return cell_offset(f, i);
}

static int first_ghost(const int *n, int side) {
    return side % 2 ? n[side / 2] : -GHOSTS;
}

/* Plans the copies of GHOSTS layers beyond a side of my tile t from my tile `from`; layer by layer if that tile is
 * thinner, as it then wraps round. */
static void plan_local(const struct forest *f, struct copies *list, int t, int from, int side) {
    const int *n = f->tile[t].n, *from_n = f->tile[from].n;
    int k = side / 2, ghost = first_ghost(n, side), thick = from_n[k] < GHOSTS ? 1 : GHOSTS;
    for (int layer = 0; layer < GHOSTS; layer += thick) {
        struct copy c = {.to = t, .from = from, .side = side, .link = -1, .n = {n[0], n[1], n[2]}};
        c.beyond = thick == GHOSTS ? 0 : side % 2 ? layer : GHOSTS - 1 - layer;
        int source = side % 2 ? layer : from_n[k] - GHOSTS + layer;
        c.n[k] = thick;
        c.to_start = layer_offset(f, side, ghost + layer);
        c.from_start = layer_offset(f, side, (source + GHOSTS * from_n[k]) % from_n[k]);
        append(list, c);
    }
}

/* Returns the link to the rank that has tile `id`, and adds it if there is none yet. */
static int link_of(struct forest *f, int id) {
    struct forest_private *h = f->hidden;
    int rank = 0, link = 0;
    while (id >= h->trees->start[rank + 1]) rank++;
    while (link < h->nlinks && h->link[link].rank != rank) link++;
    if (link == h->nlinks) h->link[h->nlinks++].rank = rank;
    return link;
}

/* Returns the cells of one layer of a box. Offsets in a message are for one layer of one variable, because each fill
 * chooses how many of both it sends. */
static long layer_cells(const int n[3], int side) {
    return (long)n[(side / 2 + 1) % 3] * n[(side / 2 + 2) % 3];
}

/* Plans the copy of GHOSTS layers beyond a side of my tile t from the message of the rank that has tile `id`. */
static void plan_unpack(struct forest *f, struct copies *list, int t, int id, int side) {
    int link = link_of(f, id);
    struct copy c = {.to = t, .side = side, .link = link, .from_start = f->hidden->arriving[link]};
    memcpy(c.n, f->tile[t].n, sizeof c.n);
    c.to_start = layer_offset(f, side, first_ghost(c.n, side));
    c.n[side / 2] = GHOSTS;
    append(list, c);
    f->hidden->arriving[link] += layer_cells(c.n, side);
    f->tile[t].remote = true;
}

/* Plans the copy of the same layers into the message: the ghosts of tile `id`, beyond `side` of it, are cells of my
 * tile `from`. */
static void plan_pack(struct forest *f, struct copies *list, int id, int from, int side) {
    int link = link_of(f, id), k = side / 2;
    struct copy c = {.from = from, .side = side, .link = link, .to_start = f->hidden->link[link].n};
    memcpy(c.n, f->tile[from].n, sizeof c.n);
    c.from_start = layer_offset(f, side, side % 2 ? 0 : c.n[k] - GHOSTS);
    c.n[k] = GHOSTS;
    append(list, c);
    f->hidden->link[link].n += layer_cells(c.n, side);
}

/* Plans all copies; while the lists are not allocated it only counts them. The layers of a message stand in the order
 * of the tiles that receive them, and of those tiles' sides. */
static void plan_all(struct forest *f) {
    struct forest_private *h = f->hidden;
    const int first = h->trees->first, end = first + h->trees->count;
    h->fill.n = h->pack.n = h->nlinks = 0;
    memset(h->link, 0, (size_t)comm_size(f->comm) * sizeof *h->link);
    memset(h->arriving, 0, (size_t)comm_size(f->comm) * sizeof *h->arriving);
    for (int id = 0; id < h->nall; id++) {
        const bool mine = id >= first && id < end;
        if (mine) h->fill_start[id - first] = h->fill.n;
        for (int side = 0; side < 2 * f->dim; side++) {
            int from = h->all[id].neighbour[side];
            const bool from_mine = from >= first && from < end;
            if (mine && from_mine)
                plan_local(f, &h->fill, id - first, from - first, side);
            else if (mine && from >= 0)
                plan_unpack(f, &h->fill, id - first, from, side);
            else if (from_mine)
                plan_pack(f, &h->pack, id, from - first, side);
        }
    }
    h->fill_start[f->ntiles] = h->fill.n;
}

status fill_make(struct forest *f) {
    struct forest_private *h = f->hidden;
    TRY(pool_take(&h->pool, &h->link, comm_size(f->comm), sizeof *h->link, "the ghost exchange"));
    TRY(pool_take(&h->pool, &h->arriving, comm_size(f->comm), sizeof *h->arriving, "the ghost exchange"));
    TRY(pool_take(&h->pool, &h->fill_start, f->ntiles + 1L, sizeof *h->fill_start, "the ghost exchange plan"));
    plan_all(f);
    TRY(pool_take(&h->pool, &h->fill.item, h->fill.n, sizeof *h->fill.item, "the ghost exchange plan"));
    TRY(pool_take(&h->pool, &h->pack.item, h->pack.n, sizeof *h->pack.item, "the ghost exchange plan"));
    plan_all(f);
    for (int i = 0; i < h->nlinks; i++) {
        long n = h->link[i].n * GHOSTS * FILL_VARIABLES; /* as many layers leave as arrive */
        TRY(pool_take(&h->pool, &h->link[i].out, n, sizeof *h->link[i].out, "the ghost exchange"));
        TRY(pool_take(&h->pool, &h->link[i].in, n, sizeof *h->link[i].in, "the ghost exchange"));
    }
    return comm_exchange_make(f->comm, h->nlinks, h->link, &h->exchange);
}

static void copy_box(double *restrict to, const long to_stride[3], const double *restrict from,
                     const long from_stride[3], const int n[3]) {
    for (int j = 0; j < n[2]; j++)
        for (int i = 0; i < n[1]; i++) {
            double *restrict a = to + j * to_stride[2] + i * to_stride[1];
            const double *restrict b = from + j * from_stride[2] + i * from_stride[1];
            if (n[0] <= GHOSTS)
                for (int g = 0; g < n[0]; g++) a[g] = b[g];
            else
                memcpy(a, b, (size_t)n[0] * sizeof *a);
        }
}

static void packed_strides(const int n[3], long stride[3]) {
    stride[0] = 1;
    stride[1] = n[0];
    stride[2] = (long)n[0] * n[1];
}

static long cells_of(const int n[3]) {
    return (long)n[0] * n[1] * n[2];
}

/* Cuts a box down to the first `layers` beyond its side; *inner is their offset from the start of the whole box in a
 * block. Returns false if nothing is left. */
static bool trim(const struct forest *f, int layers, struct copy *c, long *inner) {
    const int k = c->side / 2;
    *inner = 0;
    if (c->beyond >= layers) return false;
    if (c->n[k] <= layers) return true;
    if (c->side % 2 == 0) *inner = (c->n[k] - layers) * f->stride[k];
    c->n[k] = layers;
    return true;
}

void forest_fill_start(struct forest *f, int layers, int nvar, double *const *data) {
    struct forest_private *h = f->hidden;
    h->layers = layers;
    h->nvar = nvar;
    h->data = data;
    for (int i = 0; i < h->pack.n; i++) {
        struct copy c = h->pack.item[i];
        long stride[3], inner;
        trim(f, layers, &c, &inner);
        packed_strides(c.n, stride);
        for (int v = 0; v < nvar; v++)
            copy_box(h->link[c.link].out + c.to_start * layers * nvar + v * cells_of(c.n), stride,
                     data[c.from] + v * f->size + c.from_start + inner, f->stride, c.n);
    }
    comm_exchange_start(h->exchange, layers * nvar);
}

void forest_fill_finish(struct forest *f) {
    comm_exchange_finish(f->hidden->exchange);
}

void forest_fill_tile(const struct forest *f, int t, const bool *leave) {
    const struct forest_private *h = f->hidden;
    for (int i = h->fill_start[t]; i < h->fill_start[t + 1]; i++) {
        struct copy c = h->fill.item[i];
        long packed[3], inner;
        if ((leave && c.link < 0 && leave[c.side]) || !trim(f, h->layers, &c, &inner)) continue;
        packed_strides(c.n, packed);
        for (int v = 0; v < h->nvar; v++) {
            const long line = v * f->size;
            double *to = h->data[t] + line + c.to_start + inner;
            if (c.link < 0)
                copy_box(to, f->stride, h->data[c.from] + line + c.from_start + inner, f->stride, c.n);
            else
                copy_box(to, f->stride, h->link[c.link].in + c.from_start * h->layers * h->nvar + v * cells_of(c.n),
                         packed, c.n);
        }
    }
}

void forest_fill_layers(struct forest *f, int layers, int nvar, double *const *data) {
    forest_fill_start(f, layers, nvar, data);
    forest_fill_finish(f);
    for (int t = 0; t < f->ntiles; t++) forest_fill_tile(f, t, NULL);
}

void forest_fill(struct forest *f, int nvar, double *const *data) {
    forest_fill_layers(f, GHOSTS, nvar, data);
}

/* The cells along a side of a tile are those beyond the other side of its neighbour: copy.side is the neighbour's. */
void forest_fill_sheets(struct forest *f, int lines, double *const *data) {
    struct forest_private *h = f->hidden;
    for (int i = 0; i < h->pack.n; i++) {
        const struct copy *c = &h->pack.item[i];
        const long cells = layer_cells(c->n, c->side);
        for (int v = 0; v < lines; v++)
            memcpy(h->link[c->link].out + c->to_start * lines + v * cells,
                   data[c->from] + forest_sheet(f, c->side ^ 1, lines, v), (size_t)cells * sizeof(double));
    }
    comm_exchange_start(h->exchange, lines);
    comm_exchange_finish(h->exchange);
    for (int i = 0; i < h->fill.n; i++) {
        const struct copy *c = &h->fill.item[i];
        const long cells = layer_cells(c->n, c->side);
        for (int v = 0; v < lines && c->beyond == 0; v++)
            memcpy(data[c->to] + forest_sheet(f, 2 * f->dim + c->side, lines, v),
                   c->link < 0 ? data[c->from] + forest_sheet(f, c->side ^ 1, lines, v)
                               : h->link[c->link].in + c->from_start * lines + v * cells,
                   (size_t)cells * sizeof(double));
    }
}

static void copy_ints(int *to, const long to_stride[3], const int *from, const long from_stride[3], const int n[3]) {
    for (int j = 0; j < n[2]; j++)
        for (int i = 0; i < n[1]; i++)
            memcpy(to + j * to_stride[2] + i * to_stride[1], from + j * from_stride[2] + i * from_stride[1],
                   (size_t)n[0] * sizeof *to);
}

/* In a message an int has the room of a double. */
void forest_fill_int(struct forest *f, int *const *data) {
    const struct forest_private *h = f->hidden;
    long packed[3], inner;
    for (int i = 0; i < h->pack.n; i++) {
        struct copy c = h->pack.item[i];
        trim(f, 1, &c, &inner);
        packed_strides(c.n, packed);
        copy_ints((int *)h->link[c.link].out + c.to_start, packed, data[c.from] + c.from_start + inner, f->stride, c.n);
    }
    comm_exchange_start(h->exchange, 1);
    comm_exchange_finish(h->exchange);
    for (int i = 0; i < h->fill.n; i++) {
        struct copy c = h->fill.item[i];
        if (!trim(f, 1, &c, &inner)) continue;
        packed_strides(c.n, packed);
        int *to = data[c.to] + c.to_start + inner;
        if (c.link < 0)
            copy_ints(to, f->stride, data[c.from] + c.from_start + inner, f->stride, c.n);
        else
            copy_ints(to, f->stride, (int *)h->link[c.link].in + c.from_start, packed, c.n);
    }
}
