/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages between the ranks of a multigrid: their blocks, ghosts' values, sums, the matrix of all rows. */
#include "libcore/multigrid/multigrid_private.h"

#include <stdlib.h>

/* Sorts the blocks of all ranks by their numbers. */
struct numbered {
    int number, j;
};
static int by_number(const void *a, const void *b) {
    const int x = ((const struct numbered *)a)->number, y = ((const struct numbered *)b)->number;
    return (x > y) - (x < y);
}

static status order_blocks(struct multigrid *m, const struct multigrid_rows *rows) {
    struct world *w = &m->world;
    struct numbered *sorted;
    int *all;
    TRY(allocate(&sorted, w->blocks, sizeof *sorted, "the blocks of all ranks"));
    all = w->rows; /* room for as many */
    comm_share_int(m->comm, rows->number, w->count, w->first, all);
    for (int j = 0; j < w->blocks; j++) sorted[j] = (struct numbered){all[j], j};
    qsort(sorted, (size_t)w->blocks, sizeof *sorted, by_number);
    for (int k = 0; k < w->blocks; k++) w->order[k] = sorted[k].j;
    free(sorted);
    return OK;
}

status multigrid_meet(struct multigrid *m, const struct multigrid_rows *rows) {
    struct world *w = &m->world;
    const int n = m->ranks;
    if (n > 1) {
        TRY(ARRAYS_GROW(&w->arrays, w->count, 8L * n + 4));
        w->row_count = w->count + n;
        w->sum_count = w->row_count + n;
        w->pack_count = w->sum_count + n;
        w->first = w->pack_count + n;
        w->row_first = w->first + n + 1;
        w->sum_first = w->row_first + n + 1;
        w->pack_first = w->sum_first + n + 1;
        TRY(comm_share_count(m->comm, rows->blocks, w->count, w->first));
        w->blocks = w->first[n];
    } else {
        w->blocks = rows->blocks;
    }
    status s = ARRAYS_GROW(&w->arrays, w->order, 3L * w->blocks + 1);
    if (!s) s = ARRAYS_GROW(&w->arrays, w->mine, MOST_SUMS * (rows->blocks + 1L));
    if (!s) s = ARRAYS_GROW(&w->arrays, w->sums, (long)MOST_SUMS * w->blocks);
    TRY(comm_agree(m->comm, s));
    w->rows = w->order + w->blocks;
    w->base = w->rows + w->blocks;
    return n > 1 ? comm_agree(m->comm, order_blocks(m, rows)) : OK;
}

status multigrid_count(struct multigrid *m, const struct level *l) {
    struct world *w = &m->world;
    m->total = l->rows;
    if (m->ranks == 1) return OK;
    int *mine = w->base; /* room for as many */
    for (int b = 0; b < l->blocks; b++) mine[b] = l->block[b + 1] - l->block[b];
    comm_share_int(m->comm, mine, w->count, w->first, w->rows);
    int base = 0;
    for (int k = 0; k < w->blocks; k++) {
        w->base[w->order[k]] = base;
        base += w->rows[w->order[k]];
    }
    w->base[w->blocks] = base;
    m->total = base;
    return comm_share_count(m->comm, l->rows, w->row_count, w->row_first);
}

/* Are the rows of the level on their ranks, of which there are several? */
static bool is_spread(const struct multigrid *m, const struct level *l) {
    return m->ranks > 1 && l->spread;
}

void multigrid_send(const struct multigrid *m, const struct level *l, const double *x) {
    if (!is_spread(m, l)) return;
    if (l->own)
        l->own->send(l->own->context, x);
    else
        for (int i = 0; i < l->sent; i++) l->mine[i] = x[l->send[i]];
}

void multigrid_receive(const struct multigrid *m, const struct level *l, double *x) {
    if (!is_spread(m, l)) return;
    if (l->own) {
        l->own->receive(l->own->context, x);
        return;
    }
    comm_share(m->comm, l->mine, l->told_count, l->told_first, l->shared);
    for (int g = 0; g < l->ghosts; g++) x[l->rows + g] = l->shared[l->from[g]];
}

/* Gives each row of `to` on this rank its name, the row that it is in the order of all rows: name[rows]. */
static void name_rows(const struct multigrid *m, const struct level *to, int *name) {
    const struct world *w = &m->world;
    const int first = w->first[comm_rank(m->comm)];
    for (int b = 0; b < to->blocks; b++)
        for (int i = to->block[b]; i < to->block[b + 1]; i++) name[i] = w->base[first + b] + i - to->block[b];
}

/* Are the rows lines, so numbered that a row of the factors has few numbers in the mean? */
bool multigrid_narrow(struct multigrid *m, const struct multigrid_rows *rows, double *name) {
    const struct world *w = &m->world;
    double most = 0;
    long entries = 0;
    for (int i = 0; i < rows->rows; i++) most = larger(most, rows->link_first[i + 1] - rows->link_first[i]);
    comm_max(m->comm, &most, 1);
    if (most > 2) return false;
    for (int b = 0; b < rows->blocks; b++) {
        const int base = m->ranks > 1 ? w->base[w->first[comm_rank(m->comm)] + b] : rows->first[b];
        for (int i = rows->first[b]; i < rows->first[b + 1]; i++) name[i] = base + i - rows->first[b];
    }
    if (m->ranks > 1) {
        rows->send(rows->context, name);
        rows->receive(rows->context, name);
    }
    for (int i = 0; i < rows->rows; i++) {
        double low = name[i];
        for (int k = rows->link_first[i]; k < rows->link_first[i + 1]; k++) low = smaller(low, name[rows->link[k]]);
        entries += (long)(name[i] - low);
    }
    comm_sum_long(m->comm, &entries, 1);
    return entries <= 16 * m->total;
}

/* Finds the aggregates of ghosts: their owners name them. fine NULL: `to` has the ghosts already. */
status multigrid_name_ghosts(struct multigrid *m, struct level *fine, struct level *to) {
    const struct level *l = fine ? fine : to;
    int *name, *ghost = NULL;
    if (m->ranks == 1) {
        to->ghosts = 0;
        return OK;
    }
    status s = ARRAYS_GROW(&to->arrays, to->name, 2L * to->rows + 2L * l->ghosts);
    if (!s && fine) s = allocate(&ghost, m->total, sizeof *ghost, "the ghosts of aggregates");
    TRY(comm_agree(m->comm, s));
    name = to->name + l->ghosts;
    name_rows(m, to, name);
    for (int i = 0; i < l->rows; i++)
        l->x[i] = !fine ? name[i] : fine->aggregate[i] < 0 ? -1 : name[fine->aggregate[i]];
    multigrid_send(m, l, l->x);
    multigrid_receive(m, l, l->x);
    if (fine) to->ghosts = 0;
    for (int g = 0; g < l->ghosts; g++) {
        const int n = (int)l->x[l->rows + g];
        if (!fine) {
            to->name[g] = n;
        } else if (n < 0) {
            fine->aggregate[l->rows + g] = DROPPED;
        } else {
            if (!ghost[n]) to->name[to->ghosts++] = n, ghost[n] = to->ghosts;
            fine->aggregate[l->rows + g] = to->rows + ghost[n] - 1;
        }
    }
    free(ghost);
    return OK;
}

/* Lists the rows that are sent: those with links to ghosts are ghosts of other ranks, as links are mutual. */
static void find_sent(const struct multigrid *m, struct level *l) {
    l->sent = 0;
    for (int e = 0; e < l->edges && m->ranks > 1; e++) {
        const int i = l->edge[e];
        bool out = false;
        for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) out |= l->link[k] >= l->rows;
        if (out) l->send[l->sent++] = i;
    }
}

status multigrid_links_lay(struct multigrid *m, struct level *l) {
    int *place = NULL, *all = NULL, *mine = NULL;
    const int n = m->ranks;
    if (n == 1) return OK;
    status s = ARRAYS_GROW(&l->arrays, l->send, (long)l->edges + l->ghosts + 2L * n + 1);
    if (!s) s = ARRAYS_GROW(&l->arrays, l->mine, l->edges);
    TRY(comm_agree(m->comm, s));
    l->from = l->send + l->edges;
    l->told_count = l->from + l->ghosts;
    l->told_first = l->told_count + n;
    find_sent(m, l);
    TRY(comm_share_count(m->comm, l->sent, l->told_count, l->told_first));
    s = ARRAYS_GROW(&l->arrays, l->shared, l->told_first[n]);
    if (!s) s = allocate(&place, m->total, sizeof *place, "the ghosts of aggregates");
    if (!s) s = allocate(&all, l->told_first[n] + (long)l->sent + l->rows, sizeof *all, "the ghosts of aggregates");
    s = comm_agree(m->comm, s);
    if (!s) {
        mine = all + l->told_first[n];
        name_rows(m, l, mine + l->sent);
        for (int i = 0; i < l->sent; i++) mine[i] = mine[l->sent + l->send[i]];
        comm_share_int(m->comm, mine, l->told_count, l->told_first, all);
        for (int i = 0; i < l->told_first[n]; i++) place[all[i]] = i;
        for (int g = 0; g < l->ghosts; g++) l->from[g] = place[l->name[g]];
    }
    free(place);
    free(all);
    return s;
}

/* Packs the columns of each row by their names, behind their number. */
static void pack_links(const struct multigrid *m, const struct level *l, int *pack, int *name) {
    name_rows(m, l, name);
    for (int i = 0; i < l->rows; i++) {
        *pack++ = l->first[3 * i + 3] - l->first[3 * i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 3]; k++)
            *pack++ = l->link[k] < l->rows ? name[l->link[k]] : l->name[l->link[k] - l->rows];
    }
}

/* Finds where each row begins in the numbers that all ranks have packed. */
static void find_rows(struct world *w, const int *packed) {
    int at = 0;
    for (int j = 0; j < w->blocks; j++)
        for (int i = 0; i < w->rows[j]; i++) {
            w->at[w->base[j] + i] = at;
            at += 1 + packed[at];
        }
}

static void unpack_links(struct world *w, int rows, const int *packed) {
    int links = 0;
    for (int i = 0; i < rows; i++) {
        const int *row = packed + w->at[i];
        w->first_link[i] = links;
        for (int k = 0; k < row[0]; k++) w->link[links++] = row[1 + k];
    }
    w->first_link[rows] = links;
}

status multigrid_gather_lay(struct multigrid *m) {
    struct world *w = &m->world;
    struct level *l = &m->local;
    const int n = m->ranks, rows = (int)m->total;
    int *pack = NULL, *packed;
    if (n == 1) return OK;
    TRY(comm_share_count(m->comm, (long)l->rows + l->links, w->pack_count, w->pack_first));
    const long numbers = w->pack_first[n];
    status s = ARRAYS_GROW(&w->arrays, w->at, 2L * rows + 1 + numbers);
    if (!s) s = ARRAYS_GROW(&w->arrays, w->weight, numbers + rows);
    if (!s) s = ARRAYS_GROW(&w->arrays, w->packed, numbers + l->links + l->rows);
    if (!s) s = ARRAYS_GROW(&w->arrays, w->residual, rows);
    if (!s) s = allocate(&pack, numbers + l->links + 2L * l->rows, sizeof *pack, "a matrix of all ranks");
    s = comm_agree(m->comm, s);
    if (!s) {
        w->first_link = w->at + rows;
        w->link = w->first_link + rows + 1;
        w->excess = w->weight + numbers;
        w->pack = w->packed + numbers;
        packed = pack + l->links + 2L * l->rows;
        pack_links(m, l, pack, pack + l->links + l->rows);
        comm_share_int(m->comm, pack, w->pack_count, w->pack_first, packed);
        find_rows(w, packed);
        unpack_links(w, rows, packed);
    }
    free(pack);
    return s;
}

struct matrix multigrid_gather(struct multigrid *m, int *block) {
    struct world *w = &m->world;
    const struct level *l = &m->local;
    struct matrix a = multigrid_matrix(l);
    block[0] = 0;
    block[1] = m->ranks == 1 ? l->rows : w->base[w->blocks];
    a.block = block;
    a.blocks = 1;
    if (m->ranks == 1) return a;
    double *to = w->pack;
    for (int i = 0; i < l->rows; i++) {
        *to++ = l->excess[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 3]; k++) *to++ = l->weight[k];
    }
    comm_share(m->comm, w->pack, w->pack_count, w->pack_first, w->packed);
    for (int i = 0; i < block[1]; i++) {
        const double *row = w->packed + w->at[i];
        const int first = w->first_link[i];
        w->excess[i] = row[0];
        for (int k = first; k < w->first_link[i + 1]; k++) w->weight[k] = row[1 + k - first];
    }
    a = (struct matrix){.rows = block[1], .blocks = 1, .stride = 1, .block = block};
    a.first = w->first_link;
    a.link = w->link;
    a.weight = w->weight;
    a.excess = w->excess;
    return a;
}

void multigrid_gather_residual(struct multigrid *m) {
    const struct world *w = &m->world;
    double *r = m->level[m->spread].r;
    comm_share(m->comm, m->local.r, w->row_count, w->row_first, w->residual);
    for (int j = 0, at = 0; j < w->blocks; at += w->rows[j++])
        for (int i = 0; i < w->rows[j]; i++) r[w->base[j] + i] = w->residual[at + i];
}

void multigrid_take_correction(struct multigrid *m) {
    const struct world *w = &m->world;
    const struct level *l = &m->local;
    const double *c = m->level[m->spread].c;
    const int first = w->first[comm_rank(m->comm)];
    for (int b = 0; b < l->blocks; b++)
        for (int i = l->block[b]; i < l->block[b + 1]; i++) l->c[i] = c[w->base[first + b] + i - l->block[b]];
    for (int g = 0; g < l->ghosts; g++) l->c[l->rows + g] = c[l->name[g]];
}

static double dot(int n, const double *a, const double *b) {
    double s[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int k = 0; k < 8; k++) s[k] += a[i + k] * b[i + k];
    for (; i < n; i++) s[0] += a[i] * b[i];
    return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
}

void multigrid_add(const struct multigrid *m, const struct level *l, int n, double *sum) {
    const struct world *w = &m->world;
    const bool spread = is_spread(m, l);
    for (int d = 0; d < n; d++) sum[d] = 0;
    for (int k = 0; k < l->blocks && !spread; k++)
        for (int d = 0; d < n; d++) sum[d] += w->mine[k * n + d];
    if (!spread) return;
    for (int r = 0; r < m->ranks; r++) w->sum_count[r] = n * w->count[r];
    for (int r = 0; r <= m->ranks; r++) w->sum_first[r] = n * w->first[r];
    comm_share(m->comm, w->mine, w->sum_count, w->sum_first, w->sums);
    for (int k = 0; k < w->blocks; k++)
        for (int d = 0; d < n; d++) sum[d] += w->sums[w->order[k] * n + d];
}

void multigrid_dots(const struct multigrid *m, const struct level *l, int n, const double *const a[],
                    const double *const b[], double *sum) {
    for (int k = 0; k < l->blocks; k++)
        for (int d = 0; d < n; d++)
            m->world.mine[k * n + d] = dot(l->block[k + 1] - l->block[k], a[d] + l->block[k], b[d] + l->block[k]);
    multigrid_add(m, l, n, sum);
}

void multigrid_sum_blocks(struct multigrid *m, int blocks, int n, const double *per_block, double *sum) {
    const struct level all = {.blocks = blocks, .spread = true};
    memcpy(m->world.mine, per_block, (size_t)(n * blocks) * sizeof *per_block);
    multigrid_add(m, &all, n, sum);
}
