/* Ghost layers: lists of boxes to copy, made once. Boxes between tiles of this rank are copied at once; those for other
 * ranks go through packets, one per tile that faces another rank, with room for the layers of all its sides. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/forest_private.h"

static void append(struct copies *list, struct copy c) {
    if (list->item) list->item[list->n] = c;
    list->n++;
}

static long cell_offset(const struct forest *f, const int i[3]) {
    return f->first + i[0] + i[1] * f->stride[1] + i[2] * f->stride[2];
}

/* The offset of cell `layer` along the side's axis, first across it. */
static long layer_offset(const struct forest *f, int side, int layer) {
    int i[3] = {0};
    i[side / 2] = layer;
    return cell_offset(f, i);
}

static int first_ghost(const int *n, int side) {
    return side % 2 ? n[side / 2] : -GHOSTS;
}

/* GHOSTS layers beyond a side of my tile t, from my tile `from`. */
static void plan_local(const struct forest *f, struct copies *list, int t, int from, int side) {
    const int *n = f->tile[t].n, *from_n = f->tile[from].n;
    int k = side / 2, ghost = first_ghost(n, side), thick = from_n[k] < GHOSTS ? 1 : GHOSTS;
    for (int layer = 0; layer < GHOSTS; layer += thick) {
        struct copy c = {.to = t, .from = from, .side = side, .n = {n[0], n[1], n[2]}};
        int source = side % 2 ? layer : from_n[k] - GHOSTS + layer;
        c.n[k] = thick;
        c.to_start = layer_offset(f, side, ghost + layer);
        c.from_start = layer_offset(f, side, (source + GHOSTS * from_n[k]) % from_n[k]);
        append(list, c);
    }
}

/* The layers inside a side of a tile, as others need them: into the tile's packet. */
static void plan_pack(const struct forest *f, struct copies *list, int mirror, int side) {
    int t = f->hidden->trees->mirror[mirror], k = side / 2;
    struct copy c = {.to = mirror, .from = t, .to_start = f->hidden->slab[side]};
    memcpy(c.n, f->tile[t].n, sizeof c.n);
    c.from_start = layer_offset(f, side, side % 2 ? c.n[k] - GHOSTS : 0);
    c.n[k] = GHOSTS;
    append(list, c);
}

static void plan_unpack(const struct forest *f, struct copies *list, int t, int ghost, int side) {
    struct copy c = {.to = t, .from = ghost, .from_start = f->hidden->slab[side ^ 1]};
    memcpy(c.n, f->tile[t].n, sizeof c.n);
    c.to_start = layer_offset(f, side, first_ghost(c.n, side));
    c.n[side / 2] = GHOSTS;
    append(list, c);
}

static int find_ghost(const struct trees *t, int id) {
    for (int low = 0, high = t->nghosts; low < high;) {
        int middle = (low + high) / 2;
        if (t->ghost[middle] == id) return middle;
        if (t->ghost[middle] < id)
            low = middle + 1;
        else
            high = middle;
    }
    return -1;
}

static bool is_mine(const struct trees *t, int id) {
    return id >= t->first && id < t->first + t->count;
}

/* Ids that name neither a tile of mine nor a ghost cannot be: the faces p4est joined are the neighbours used here. */
static void plan_all(struct forest *f) {
    struct forest_private *h = f->hidden;
    const struct trees *trees = h->trees;
    h->local.n = h->pack.n = h->unpack.n = 0;
    for (int t = 0; t < f->ntiles; t++)
        for (int side = 0; side < 2 * f->dim; side++) {
            int id = h->all[trees->first + t].neighbour[side];
            if (id < 0) continue;
            if (is_mine(trees, id)) {
                plan_local(f, &h->local, t, id - trees->first, side);
            } else {
                plan_unpack(f, &h->unpack, t, find_ghost(trees, id), side);
                f->tile[t].remote = true;
            }
        }
    for (int mirror = 0; mirror < trees->nmirrors; mirror++)
        for (int side = 0; side < 2 * f->dim; side++) {
            int id = h->all[trees->first + trees->mirror[mirror]].neighbour[side];
            if (id >= 0 && !is_mine(trees, id)) plan_pack(f, &h->pack, mirror, side);
        }
}

/* A slab per side, each as large as the largest tile needs: the same on all ranks. */
static void size_packets(struct forest *f) {
    struct forest_private *h = f->hidden;
    long most[3] = {1, 1, 1};
    for (int t = 0; t < h->nall; t++)
        for (int k = 0; k < 3; k++)
            if (h->all[t].n[k] > most[k]) most[k] = h->all[t].n[k];
    for (int side = 0; side < 2 * f->dim; side++) {
        h->slab[side] = h->packet_size;
        h->packet_size += GHOSTS * most[(side / 2 + 1) % 3] * most[(side / 2 + 2) % 3];
    }
}

status fill_make(struct forest *f) {
    struct forest_private *h = f->hidden;
    size_packets(f);
    plan_all(f);
    struct copies *list[3] = {&h->local, &h->pack, &h->unpack};
    for (int i = 0; i < 3; i++)
        TRY(allocate(&list[i]->item, list[i]->n, sizeof *list[i]->item, "the ghost exchange plan"));
    plan_all(f);
    long packet = h->packet_size * FILL_VARIABLES;
    TRY(allocate(&h->leaving, packet * h->trees->nmirrors, sizeof *h->leaving, "the ghost exchange"));
    TRY(allocate(&h->arriving, packet * h->trees->nghosts, sizeof *h->arriving, "the ghost exchange"));
    return allocate(&h->packet, h->trees->nmirrors, sizeof *h->packet, "the ghost exchange");
}

void fill_free(struct forest_private *h) {
    free(h->local.item);
    free(h->pack.item);
    free(h->unpack.item);
    free(h->leaving);
    free(h->arriving);
    free(h->packet);
}

static void copy_box(double *to, const long to_stride[3], const double *from, const long from_stride[3],
                     const int n[3]) {
    for (int j = 0; j < n[2]; j++)
        for (int i = 0; i < n[1]; i++) {
            double *a = to + j * to_stride[2] + i * to_stride[1];
            const double *b = from + j * from_stride[2] + i * from_stride[1];
            if (n[0] == GHOSTS)
                for (int g = 0; g < GHOSTS; g++) a[g] = b[g];
            else
                memcpy(a, b, (size_t)n[0] * sizeof *a);
        }
}

static void pack_strides(const int n[3], long stride[3]) {
    stride[0] = 1;
    stride[1] = n[0];
    stride[2] = (long)n[0] * n[1];
}

static void copy_local(const struct forest *f, int nvar, double *const *data, const bool *leave) {
    const struct copies *list = &f->hidden->local;
    for (int i = 0; i < list->n; i++) {
        const struct copy *c = &list->item[i];
        if (leave && leave[6 * c->to + c->side]) continue;
        for (int v = 0; v < nvar; v++)
            copy_box(data[c->to] + v * f->size + c->to_start, f->stride, data[c->from] + v * f->size + c->from_start,
                     f->stride, c->n);
    }
}

static void pack(const struct forest *f, int nvar, double *const *data) {
    struct forest_private *h = f->hidden;
    for (int m = 0; m < h->trees->nmirrors; m++) h->packet[m] = h->leaving + m * nvar * h->packet_size;
    for (int i = 0; i < h->pack.n; i++) {
        const struct copy *c = &h->pack.item[i];
        double *packet = h->packet[c->to];
        long stride[3];
        pack_strides(c->n, stride);
        for (int v = 0; v < nvar; v++)
            copy_box(packet + v * h->packet_size + c->to_start, stride, data[c->from] + v * f->size + c->from_start,
                     f->stride, c->n);
    }
}

static void unpack(const struct forest *f, int nvar, double *const *data) {
    const struct forest_private *h = f->hidden;
    for (int i = 0; i < h->unpack.n; i++) {
        const struct copy *c = &h->unpack.item[i];
        const double *packet = h->arriving + (long)c->from * nvar * h->packet_size;
        long stride[3];
        pack_strides(c->n, stride);
        for (int v = 0; v < nvar; v++)
            copy_box(data[c->to] + v * f->size + c->to_start, f->stride, packet + v * h->packet_size + c->from_start,
                     stride, c->n);
    }
}

void forest_fill_start(struct forest *f, int nvar, double *const *data, const bool *leave) {
    struct forest_private *h = f->hidden;
    if (nvar > FILL_VARIABLES) {
        fprintf(stderr, "forest_fill_start: %d variables at once, at most %d\n", nvar, FILL_VARIABLES);
        abort();
    }
    h->nvar = nvar;
    h->data = data;
    pack(f, nvar, data);
    trees_send(h->trees, nvar * h->packet_size * (long)sizeof *h->leaving, h->packet, h->arriving);
    copy_local(f, nvar, data, leave);
}

void forest_fill_finish(struct forest *f) {
    struct forest_private *h = f->hidden;
    trees_receive(h->trees);
    unpack(f, h->nvar, h->data);
}
