/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joins rows along strong links into aggregates: pairs, pairs of pairs and so on, all inside blocks. */
#include "libcore/multigrid/multigrid_private.h"

enum { LARGEST = 16 }; /* rows of an aggregate, at most */

/* Groups of rows, each known by its lowest row g. group[i] = g for every row i of the group; next[i] is the row behind
 * i in the group, or -1; last[g] is the last row, size[g] their number. */
struct groups {
    const struct level *l;
    int *group, *next, *last, *size;
    int *done, *met;  /* [g] the pass that has paired g; the group beside which g was found last */
    int *found;       /* neighbours of a group */
    int *place;       /* [rows] the place of a row in the union of groups that was looked at last */
    double *mass;     /* [g] the sum of the group's diagonal entries of A */
    double *coupling; /* [g] links between g and the group beside which it was found */
    int stamp;
};

/* Two groups are joined only if mu = max (v' D v - (1' D v)^2/1' D 1)/v' A v is at most this in their union, whose
 * links and excess make A, D being the diagonal of the whole matrix. Then the condition of two levels is mu times a
 * constant of the smoother (Napov & Notay 2012). Of equal links in a plane 2 x 4 rows have mu = 6.8, 1 x 4 have 6.8. */
static const double QUALITY = 8;
/* A v that is constant in each of two groups gives a lower bound of mu. Where that is above QUALITY/BOUND in a union of
 * more than two rows, mu is hardly ever small enough, and not computed: of two squares of equal links in a plane mu is
 * 6.8, and the bound 4. */
static const double BOUND = 1.8;
/* Rows whose excess is so much of their links have no part in coarser levels: smoothing alone solves for them, as for
 * rows without links. The strongest of six links w of any other row has w/D >= 1/(6 (1 + ALONE)) > 1/QUALITY, so that
 * it can be paired: rows of more excess might pair with none, and stay on all levels. */
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

/* Lists the rows of group g behind the n rows that are listed; returns the number of all. */
static int list_rows(const struct groups *s, int g, int n, int *row) {
    for (int i = g; i >= 0; i = s->next[i]) {
        s->place[i] = n;
        row[n++] = i;
    }
    return n;
}

/* Is a symmetric matrix positive definite, of which the entries z[a][b], b <= a, are given? They are changed. */
static bool is_positive(int n, double (*z)[LARGEST]) {
    for (int a = 0; a < n; a++) {
        if (!(z[a][a] > 0)) return false;
        const double over = 1 / z[a][a];
        for (int c = a + 1; c < n; c++) {
            const double f = z[c][a] * over;
            for (int b = a + 1; b <= c; b++) z[c][b] -= f * z[b][a];
        }
    }
    return true;
}

/* Is mu (QUALITY) of the union of g and h small enough? Then Z = QUALITY A - D + D 1 1' D/1' D 1 is not negative. As Z
 * 1 is QUALITY times the excess, Z without its last row and column tells it. */
static bool is_good(const struct groups *s, int g, int h) {
    const struct level *l = s->l;
    const double per = 1 / (s->mass[g] + s->mass[h]);
    double z[LARGEST][LARGEST];
    int row[LARGEST];
    if (s->size[g] + s->size[h] > LARGEST) return false;
    const int n = list_rows(s, h, list_rows(s, g, 0, row), row);
    for (int a = 0; a < n - 1; a++) {
        const int i = row[a];
        const double d = l->diagonal[i];
        double sum = l->excess[i];
        for (int b = 0; b < a; b++) z[a][b] = d * per * l->diagonal[row[b]];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 2]; k++) {
            const int to = l->link[k];
            if (s->group[to] != g && s->group[to] != h) continue;
            sum += l->weight[k];
            if (s->place[to] < a) z[a][s->place[to]] -= QUALITY * l->weight[k];
        }
        z[a][a] = QUALITY * sum - d + d * d * per;
    }
    return is_positive(n - 1, z);
}

/* Returns the best neighbour of g to be joined with, among those that this pass has not paired yet; -1 if none is good.
 * The best has the largest w/M_g + w/M_h, which is 1/mu of v that is constant in each group: w is the link between g
 * and h, M their masses. */
static int strongest(const struct groups *s, int g, int n, int pass) {
    for (;;) {
        double best = 0;
        int at = -1;
        for (int f = 0; f < n; f++) {
            const int h = s->found[f];
            if (h < 0 || s->done[h] == pass) continue;
            const double rate = s->coupling[h] * (1 / s->mass[g] + 1 / s->mass[h]);
            if (!(rate > best && rate * QUALITY > (s->size[g] + s->size[h] > 2 ? BOUND : 1))) continue;
            best = rate;
            at = f;
        }
        if (at < 0) return -1;
        const int h = s->found[at];
        if (s->size[g] + s->size[h] == 2 || is_good(s, g, h)) return h;
        s->found[at] = -1;
    }
}

static void join(struct groups *s, int g, int h) {
    for (int i = h; i >= 0; i = s->next[i]) s->group[i] = g;
    s->next[s->last[g]] = h;
    s->last[g] = s->last[h];
    s->size[g] += s->size[h];
}

/* Joins two groups under the lower one of their lowest rows; returns that row. */
static int join_lower(struct groups *s, int g, int h) {
    s->mass[g] = s->mass[h] = s->mass[g] + s->mass[h];
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

/* Joins each group of at most `small` rows to the best neighbour (strongest). */
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
            l->aggregate[i] = s->group[i] < 0 ? DROPPED : s->group[i] == i ? rows++ : l->aggregate[s->group[i]];
    }
    to->block[l->blocks] = rows;
    return rows;
}

static void list_members(struct level *l, int parts) {
    for (int i = 0; i <= parts; i++) l->member_first[i] = 0;
    for (int i = 0; i < l->rows; i++)
        if (l->aggregate[i] >= 0) l->member_first[l->aggregate[i] + 1]++;
    for (int i = 0; i < parts; i++) l->member_first[i + 1] += l->member_first[i];
    for (int i = 0; i < l->rows; i++)
        if (l->aggregate[i] >= 0) l->member[l->member_first[l->aggregate[i]]++] = i;
    for (int i = parts; i > 0; i--) l->member_first[i] = l->member_first[i - 1];
    l->member_first[0] = 0;
}

status multigrid_aggregate(struct level *l, int passes, struct level *to) {
    const long n = l->rows;
    struct groups s = {.l = l};
    TRY(ARRAYS_GROW(&l->arrays, l->aggregate, n + l->ghosts));
    TRY(ARRAYS_GROW(&l->arrays, l->member_first, 2 * n + 1));
    TRY(ARRAYS_GROW(&l->arrays, l->groups, 8 * n));
    TRY(ARRAYS_GROW(&l->arrays, l->masses, 2 * n));
    TRY(ARRAYS_GROW(&to->arrays, to->block, l->blocks + 1L));
    s.coupling = l->masses;
    s.mass = s.coupling + n;
    s.group = l->groups;
    s.next = s.group + n;
    s.last = s.next + n;
    s.size = s.last + n;
    s.done = s.size + n;
    s.met = s.done + n;
    s.found = s.met + n;
    s.place = s.found + n;
    for (int i = 0; i < l->rows; i++) {
        s.group[i] = smooth_alone(l, i) ? DROPPED : i;
        s.next[i] = s.done[i] = s.met[i] = -1;
        s.last[i] = i;
        s.mass[i] = l->diagonal[i];
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
