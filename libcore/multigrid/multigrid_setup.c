/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares a multigrid for a matrix: its levels from the finest to the coarsest, and the factors of that. */
#include "libcore/multigrid/multigrid_private.h"

#include <stdlib.h>

enum {
    DIRECT = 200,      /* rows of a system that is solved directly, at most */
    COARSEST = 64,     /* rows of the coarsest level, at most */
    SHARED = 20000,    /* behind a level of more rows there is another one with its rows on their ranks */
    SPREAD_PASSES = 3, /* levels with rows on their ranks are coarsened 8 times, so that others cost little */
    PASSES = 2
};

status multigrid_make(const struct comm *c, struct multigrid **out) {
    TRY(allocate(out, 1, sizeof **out, "a multigrid"));
    (*out)->comm = c;
    (*out)->ranks = comm_size(c);
    return OK;
}

void multigrid_free(struct multigrid *m) {
    if (!m) return;
    for (int l = 0; l < MOST_LEVELS; l++) arrays_free(&m->level[l].arrays);
    arrays_free(&m->local.arrays);
    arrays_free(&m->direct.arrays);
    arrays_free(&m->world.arrays);
    arrays_free(&m->arrays);
    free(m);
}

static struct matrix callers_matrix(struct multigrid *m, const struct multigrid_rows *rows) {
    for (int i = 0; i < rows->rows; i++) {
        double sum = 0;
        for (int k = rows->link_first[i]; k < rows->link_first[i + 1]; k++) sum += rows->weight[k];
        m->excess[i] = larger(rows->diagonal[i] - sum, 0);
    }
    return (struct matrix){.rows = rows->rows,
                           .ghosts = rows->ghosts,
                           .blocks = rows->blocks,
                           .stride = 1,
                           .block = rows->first,
                           .first = rows->link_first,
                           .link = rows->link,
                           .weight = rows->weight,
                           .excess = m->excess};
}

/* Lays out a level that has the rows of `a`. */
static status copy_lay(const struct matrix *a, struct level *to) {
    to->rows = a->rows;
    to->ghosts = a->ghosts;
    to->blocks = a->blocks;
    TRY(ARRAYS_GROW(&to->arrays, to->block, a->blocks + 1L));
    memcpy(to->block, a->block, (size_t)(a->blocks + 1) * sizeof *to->block);
    TRY(multigrid_lay(a, NULL, to));
    return multigrid_vectors(to);
}

/* Makes the level behind `l`, whose rows lie on their ranks. */
static status coarsen_spread(struct multigrid *m, struct level *l, struct level *to) {
    const struct matrix a = multigrid_matrix(l);
    to->own = NULL;
    to->spread = true;
    TRY(comm_agree(m->comm, multigrid_aggregate(l, SPREAD_PASSES, to)));
    TRY(multigrid_count(m, to));
    TRY(multigrid_name_ghosts(m, l, to));
    status s = multigrid_lay(&a, l, to);
    if (!s) s = multigrid_vectors(to);
    TRY(comm_agree(m->comm, s));
    multigrid_sum(&a, l->aggregate, to);
    multigrid_smoother(to, NULL);
    return OK;
}

static status coarsen(struct level *l, struct level *to) {
    const struct matrix a = multigrid_matrix(l);
    TRY(multigrid_aggregate(l, PASSES, to));
    to->ghosts = 0;
    to->spread = false;
    TRY(multigrid_lay(&a, l, to));
    TRY(multigrid_vectors(to));
    multigrid_sum(&a, l->aggregate, to);
    multigrid_smoother(to, NULL);
    return OK;
}

/* Makes the levels that are on every rank, from `local` on. */
static status lay_shared(struct multigrid *m) {
    int block[2];
    TRY(multigrid_gather_lay(m));
    struct matrix a = multigrid_gather(m, block);
    struct level *l = &m->level[m->spread];
    l->own = NULL;
    l->spread = false;
    TRY(copy_lay(&a, l));
    multigrid_sum(&a, NULL, l);
    multigrid_smoother(l, NULL);
    m->levels = m->spread + 1;
    while (m->spread > 0 && l->rows > COARSEST && m->levels < MOST_LEVELS) {
        TRY(coarsen(l, l + 1));
        l++;
        m->levels++;
    }
    TRY(multigrid_direct_lay(l, &m->direct));
    multigrid_factor(l, &m->direct);
    return OK;
}

static status lay(struct multigrid *m, const struct multigrid_rows *rows, const struct matrix *a, bool direct) {
    struct level *to = direct ? &m->local : &m->level[0];
    to->own = rows;
    to->spread = true;
    TRY(comm_agree(m->comm, copy_lay(a, to)));
    multigrid_sum(a, NULL, to);
    multigrid_smoother(to, rows->diagonal);
    if (direct) TRY(multigrid_name_ghosts(m, NULL, to));
    for (m->spread = 0; to != &m->local; m->spread++) {
        struct level *const l = to;
        to = m->spread + 1 < SPREAD_LEVELS && m->total > SHARED ? l + 1 : &m->local;
        TRY(coarsen_spread(m, l, to));
        if (to != &m->local) TRY(multigrid_links_lay(m, to));
    }
    return comm_agree(m->comm, lay_shared(m));
}

/* Computes the numbers of all levels anew. */
static void refill(struct multigrid *m, const struct multigrid_rows *rows, const struct matrix *first) {
    int block[2];
    struct matrix a = *first;
    for (int l = 0; l <= m->spread; l++) {
        struct level *to = l == m->spread ? &m->local : &m->level[l];
        multigrid_sum(&a, l ? m->level[l - 1].aggregate : NULL, to);
        multigrid_smoother(to, l ? NULL : rows->diagonal);
        a = multigrid_matrix(to);
    }
    a = multigrid_gather(m, block);
    for (int l = m->spread; l < m->levels; l++) {
        multigrid_sum(&a, l > m->spread ? m->level[l - 1].aggregate : NULL, &m->level[l]);
        multigrid_smoother(&m->level[l], NULL);
        a = multigrid_matrix(&m->level[l]);
    }
    multigrid_factor(&m->level[m->levels - 1], &m->direct);
}

/* Learns of all ranks' blocks and decides how to solve. */
static status begin(struct multigrid *m, const struct multigrid_rows *rows, bool *direct) {
    struct level counted = {.rows = rows->rows, .blocks = rows->blocks};
    TRY(multigrid_meet(m, rows));
    TRY(comm_agree(m->comm, ARRAYS_GROW(&m->arrays, m->block, rows->blocks + 1L)));
    counted.block = m->block;
    memcpy(counted.block, rows->first, ((size_t)rows->blocks + 1) * sizeof *counted.block);
    TRY(multigrid_count(m, &counted));
    *direct = m->total <= DIRECT || multigrid_narrow(m, rows, m->p);
    return OK;
}

status multigrid_setup(struct multigrid *m, const struct multigrid_rows *rows, bool same_links) {
    const bool known = same_links && m->prepared;
    const long n = (long)rows->rows + rows->ghosts;
    m->prepared = false;
    status s = ARRAYS_GROW(&m->arrays, m->excess, rows->rows);
    if (!s) s = ARRAYS_GROW(&m->arrays, m->p, 2 * n);
    TRY(comm_agree(m->comm, s));
    m->q = m->p + n;
    const struct matrix a = callers_matrix(m, rows);
    if (known) {
        (m->spread ? &m->level[0] : &m->local)->own = rows;
        refill(m, rows, &a);
    } else {
        bool direct = false;
        TRY(begin(m, rows, &direct));
        TRY(lay(m, rows, &a, direct));
    }
    m->prepared = true;
    return OK;
}
