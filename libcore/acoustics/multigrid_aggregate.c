/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joins rows along strong links into aggregates: pairs, pairs of pairs and so on, all inside blocks. */
#include "libcore/acoustics/multigrid_private.h"

/* Groups of rows, each known by its lowest row g. group[i] = g for every row i of the group; next[i] is the row behind
 * i in the group, or -1; last[g] is the last row, size[g] their number. */
struct groups {
    const struct level *l;
    int *group, *next, *last, *size;
    int *done, *met;  /* [g] the pass that has paired g; the group beside which g was found last */
    int *found;       /* neighbours of a group */
    double *sum;      /* [g] the group's links to other groups, and its excess */
    double *coupling; /* [g] links between g and the group beside which it was found */
    int stamp;
};

/* Two groups are paired if errors within the pair are smoothed at this rate at least (strongest). Measured; equal links
 * in a line have the rate 1/2, in a plane 1/4, in space 1/6. */
static const double LEAST_RATE = 0.13;
/* Rows whose excess is so much of their links have no part in coarser levels: smoothing alone solves for them, as for
 * rows without links. A cell in space with six equal links w has the rate w/D = 1/(6 (1 + ALONE)) = LEAST_RATE then:
 * rows of more excess would pair with none, and stay on all levels. */
static const double ALONE = 0.28;

static bool smooth_alone(const struct level *l, int i) {
    double sum = 0;
    for (int k = l->first[3 * i]; k < l->first[3 * i + 3]; k++) sum += l->weight[k];
    return !(l->excess[i] < ALONE * sum);
}

/* Finds the neighbours of group g in its block; returns their number. */
static int neighbours(struct groups *s, int g) {
    const struct level *l = s->l;
    int n = 0;
    s->stamp++;
    for (int i = g; i >= 0; i = s->next[i])
        for (int k = l->first[3 * i]; k < l->first[3 * i + 2]; k++) {
            const int h = s->group[l->link[k]];
            if (h < 0 || h == g) continue;
            if (s->met[h] != s->stamp) {
                s->met[h] = s->stamp;
                s->coupling[h] = 0;
                s->found[n++] = h;
            }
            s->coupling[h] += l->weight[k];
        }
    return n;
}

/* Returns the best neighbour of g to be paired with, among those that this pass has not paired yet; -1 if none is good.
 * Good is a high rate w/min(D_g, D_h) at which errors within the pair are smoothed: w is the link between g and h, D
 * the sum of one's links to others and of its excess. */
static int strongest(const struct groups *s, int g, int n, int pass) {
    double best = LEAST_RATE;
    int found = -1;
    for (int f = 0; f < n; f++) {
        const int h = s->found[f];
        const double rate = s->coupling[h] / smaller(s->sum[g], s->sum[h]);
        if (s->done[h] != pass && rate > best) {
            best = rate;
            found = h;
        }
    }
    return found;
}

static void join(struct groups *s, int g, int h) {
    for (int i = h; i >= 0; i = s->next[i]) s->group[i] = g;
    s->next[s->last[g]] = h;
    s->last[g] = s->last[h];
    s->size[g] += s->size[h];
}

/* Joins two groups under the lower one of their lowest rows; returns that row. */
static int join_lower(struct groups *s, int g, int h) {
    s->sum[g] = s->sum[h] = s->sum[g] + s->sum[h] - 2 * s->coupling[h];
    if (h < g) {
        join(s, h, g);
        return h;
    }
    join(s, g, h);
    return g;
}

static void pair_all(struct groups *s, int pass) {
    for (int i = 0; i < s->l->rows; i++) {
        if (s->group[i] != i || s->done[i] == pass) continue;
        const int h = strongest(s, i, neighbours(s, i), pass);
        if (h >= 0) s->done[join_lower(s, i, h)] = pass;
    }
}

/* Joins each group of at most `small` rows to the neighbour with which it has the highest rate (strongest). */
static void join_small(struct groups *s, int small) {
    for (int i = 0; i < s->l->rows; i++) {
        if (s->group[i] != i || s->size[i] > small) continue;
        const int h = strongest(s, i, neighbours(s, i), -1);
        if (h >= 0) join_lower(s, i, h);
    }
}

/* Numbers the groups in the order of their lowest rows, block by block. */
static int number(const struct groups *s, struct level *l, struct level *to) {
    int rows = 0;
    for (int b = 0; b < l->blocks; b++) {
        to->block[b] = rows;
        for (int i = l->block[b]; i < l->block[b + 1]; i++)
            l->part[i] = s->group[i] < 0 ? DROPPED : s->group[i] == i ? rows++ : l->part[s->group[i]];
    }
    to->block[l->blocks] = rows;
    return rows;
}

static void list_members(struct level *l, int parts) {
    for (int i = 0; i <= parts; i++) l->member_first[i] = 0;
    for (int i = 0; i < l->rows; i++)
        if (l->part[i] >= 0) l->member_first[l->part[i] + 1]++;
    for (int i = 0; i < parts; i++) l->member_first[i + 1] += l->member_first[i];
    for (int i = 0; i < l->rows; i++)
        if (l->part[i] >= 0) l->member[l->member_first[l->part[i]]++] = i;
    for (int i = parts; i > 0; i--) l->member_first[i] = l->member_first[i - 1];
    l->member_first[0] = 0;
}

status multigrid_aggregate(struct level *l, int passes, struct level *to) {
    const long n = l->rows;
    struct groups s = {.l = l};
    TRY(room_grow(&l->room[9], n + l->ghosts, sizeof(int), &l->part));
    TRY(room_grow(&l->room[10], 2 * n + 1, sizeof(int), &l->member_first));
    TRY(room_grow(&l->room[11], 7 * n, sizeof(int), &s.group));
    TRY(room_grow(&l->room[12], 2 * n, sizeof(double), &s.coupling));
    TRY(room_grow(&to->room[13], l->blocks + 1L, sizeof(int), &to->block));
    s.sum = s.coupling + n;
    s.next = s.group + n;
    s.last = s.next + n;
    s.size = s.last + n;
    s.done = s.size + n;
    s.met = s.done + n;
    s.found = s.met + n;
    for (int i = 0; i < l->rows; i++) {
        s.group[i] = smooth_alone(l, i) ? DROPPED : i;
        s.next[i] = s.done[i] = s.met[i] = -1;
        s.last[i] = i;
        s.sum[i] = l->diagonal[i];
        s.size[i] = 1;
    }
    for (int pass = 0; pass < passes; pass++) pair_all(&s, pass);
    join_small(&s, passes > 2 ? 2 : 1);
    to->blocks = l->blocks;
    to->rows = number(&s, l, to);
    l->member = l->member_first + to->rows + 1;
    list_members(l, to->rows);
    return OK;
}
