/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gives the sides of blocks (boxes.h) their patches, checks empty and cyclic ones, and makes the mesh: at first its
 * numbers and patches, and points and faces on demand. */
#include "mesh/format/boxes.h"

#include "mesh/format/polymesh.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct bounding {
    struct boxes *b;
    const struct boxes_block *block;
    int npatches;
    const struct boxes_patch *patch;
    struct polymesh *mesh;
    long *faces; /* [npatches] so far */
};

/* Do two quadruples hold the same vertices? */
static bool same_vertices(const int a[4], const int b[4]) {
    for (int i = 0; i < 4; i++) {
        int here = 0, there = 0;
        for (int j = 0; j < 4; j++) {
            here += a[j] == a[i];
            there += b[j] == a[i];
        }
        if (here != there) return false;
    }
    return true;
}

/* Finds the side of a block that has four vertices; *own is its number by the block's own axes. */
static struct brick_name find_side(const struct bounding *d, const int vertex[4], int *own) {
    for (int i = 0; i < 6 * d->b->nboxes; i++) {
        int corner[4];
        for (int c = 0; c < 4; c++) corner[c] = d->block[i / 6].vertex[boxes_corner[i % 6][c]];
        if (!same_vertices(corner, vertex)) continue;
        const struct brick *x = &d->b->box[i / 6];
        const int k = x->cell.axis[i % 6 / 2];
        *own = i % 6;
        return (struct brick_name){i / 6, 2 * k + ((i % 2 != 0) != x->cell.down[k])};
    }
    return (struct brick_name){-1, -1};
}

/* Gives a side to a patch. blockMesh numbers the faces of own sides 0, 1 along own axes 1 and then 2, of sides 2, 3
 * along 2 and then 0, of sides 4, 5 along 1 and then 0. */
static status give(const struct bounding *d, struct brick_name name, int own, int patch) {
    static const int order[3][3] = {{1, 2, 0}, {2, 0, 1}, {1, 0, 2}};
    struct boxes *b = d->b;
    const struct brick *x = &b->box[name.box];
    struct brick_side *side = &b->box[name.box].side[name.side];
    struct brick_numbers *m = &side->face;
    side->patch = patch;
    m->start = d->faces[patch];
    long n = 1;
    for (int a = 0; a < 3; a++) {
        m->axis[a] = x->cell.axis[order[own / 2][a]];
        m->down[a] = x->cell.down[a];
        if (a != name.side / 2) n *= x->n[a];
    }
    d->faces[patch] += n;
    if (d->faces[patch] > INT_MAX)
        return fail(ERR_INPUT, "patch '%s': it has more than %d faces", d->patch[patch].name, INT_MAX);
    b->side[b->nsides++] = name;
    return OK;
}

static status give_named(const struct bounding *d, int patch) {
    const struct boxes_patch *p = &d->patch[patch];
    for (int f = 0; f < p->nfaces; f++) {
        const int *v = p->face[f];
        int own;
        const struct brick_name name = find_side(d, v, &own);
        if (name.box < 0)
            return fail(ERR_INPUT, "patch '%s': (%d %d %d %d) are not the vertices of a side of a block", p->name, v[0],
                        v[1], v[2], v[3]);
        const struct brick_side *side = &d->b->box[name.box].side[name.side];
        if (side->next >= 0)
            return fail(ERR_INPUT, "patch '%s': the side (%d %d %d %d) lies inside, between blocks %d and %d", p->name,
                        v[0], v[1], v[2], v[3], name.box, side->next);
        if (side->patch >= 0)
            return fail(ERR_INPUT, "patch '%s': the side (%d %d %d %d) belongs to patch '%s' already", p->name, v[0],
                        v[1], v[2], v[3], d->patch[side->patch].name);
        TRY(give(d, name, own, patch));
    }
    return OK;
}

/* Gives the sides that are left to the last patch. */
static status give_others(const struct bounding *d) {
    struct boxes *b = d->b;
    for (int i = 0; i < 6 * b->nboxes; i++) {
        const struct brick *x = &b->box[i / 6];
        const int k = x->cell.axis[i % 6 / 2], side = 2 * k + ((i % 2 != 0) != x->cell.down[k]);
        if (x->side[side].next < 0 && x->side[side].patch < 0)
            TRY(give(d, (struct brick_name){i / 6, side}, i % 6, d->npatches - 1));
    }
    return OK;
}

/* ---- empty and cyclic patches ---- */

static bool is_empty(const struct bounding *d, int patch) {
    return patch >= 0 && !strcmp(d->patch[patch].type, "empty");
}

/* Fails unless empty patches close whole axes, which are one cell thick. */
static status check_empty(const struct bounding *d) {
    const struct boxes *b = d->b;
    bool closed[3] = {false};
    for (int i = 0; i < b->nsides; i++)
        if (is_empty(d, b->box[b->side[i].box].side[b->side[i].side].patch)) closed[b->side[i].side / 2] = true;
    if (closed[0] && closed[1] && closed[2])
        return fail(ERR_INPUT, "empty patches close x, y and z; an axis to solve along must be left");
    for (int i = 0; i < b->nboxes; i++)
        for (int k = 0; k < 3; k++) {
            const struct brick *x = &b->box[i];
            if (!closed[k] || (is_empty(d, x->side[2 * k].patch) && is_empty(d, x->side[2 * k + 1].patch) &&
                               x->n[k] == 1 && b->n[k] == 1))
                continue;
            return fail(ERR_INPUT,
                        "empty patches close %c, but not on both sides of block %d, or it is more than one cell thick "
                        "there: all sides across %c must be in empty patches",
                        "xyz"[k], i, "xyz"[k]);
        }
    return OK;
}

/* Is the side the mirror image of another at the opposite end of the whole mesh, with the same numbers of faces? */
static bool is_opposite(const struct boxes *b, struct brick_name one, struct brick_name other) {
    const struct brick *x = &b->box[one.box], *y = &b->box[other.box];
    const struct brick_numbers *p = &x->side[one.side].face, *q = &y->side[other.side].face;
    const int k = one.side / 2;
    if (other.side != (one.side ^ 1) || p->start != q->start) return false;
    const struct brick *lower = one.side % 2 ? y : x, *upper = one.side % 2 ? x : y;
    if (lower->low[k] != 0 || upper->low[k] + upper->n[k] != b->n[k]) return false;
    long first = -1, second = -1; /* the axes along which the numbers rise, but for those of one cell */
    for (int a = 0; a < 3; a++) {
        if (a != k && (x->low[a] != y->low[a] || x->n[a] != y->n[a])) return false;
        if (a != k && x->n[a] > 1 && p->down[a] != q->down[a]) return false;
    }
    for (int a = 2; a >= 0; a--) {
        if (p->axis[a] != k && x->n[p->axis[a]] > 1) first = p->axis[a];
        if (q->axis[a] != k && x->n[q->axis[a]] > 1) second = q->axis[a];
    }
    return first == second;
}

/* Fails unless a cyclic patch and its other half are opposite ends of the whole mesh, face by face. */
static status check_cyclic(const struct bounding *d, int p) {
    const struct boxes *b = d->b;
    const struct boxes_patch *here = &d->patch[p];
    int q = 0;
    while (q < d->npatches && strcmp(d->patch[q].name, here->neighbour) != 0) q++;
    const bool mutual =
        q < d->npatches && q != p && d->patch[q].neighbour && !strcmp(d->patch[q].neighbour, here->name);
    if (!mutual)
        return fail(ERR_INPUT, "patch '%s': its neighbourPatch '%s' is no cyclic patch that names '%s' in turn",
                    here->name, here->neighbour, here->name);
    const int n = b->first[p + 1] - b->first[p];
    bool good = n == b->first[q + 1] - b->first[q];
    for (int i = 0; good && i < n; i++)
        good = is_opposite(b, b->side[b->first[p] + i], b->side[b->first[q] + i]) &&
               b->side[b->first[p] + i].side == b->side[b->first[p]].side;
    if (good) return OK;
    return fail(ERR_INPUT,
                "patch '%s': it and '%s' are not opposite ends of the whole mesh, side by side in the same order; list "
                "the sides of both in one order, or run blockMesh and use its polyMesh",
                here->name, here->neighbour);
}

/* Fails if an axis is cyclic in part only. */
static status check_ends(const struct bounding *d) {
    const struct boxes *b = d->b;
    const char *cyclic[3] = {NULL};
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < b->nsides; i++) {
            const struct brick *x = &b->box[b->side[i].box];
            const int side = b->side[i].side, k = side / 2;
            const struct boxes_patch *p = &d->patch[x->side[side].patch];
            const bool end = side % 2 ? x->low[k] + x->n[k] == b->n[k] : x->low[k] == 0;
            if (p->neighbour)
                cyclic[k] = p->name;
            else if (round && end && cyclic[k])
                return fail(
                    ERR_INPUT,
                    "patch '%s': the %c axis is cyclic only in part: patch '%s' is at its end, too; one of both "
                    "must take the whole end",
                    cyclic[k], "xyz"[k], p -> name);
        }
    return OK;
}

/* ---- the mesh ---- */

static status copy_word(const char *word, char **out) {
    if (!word) return OK;
    TRY(allocate(out, (long)strlen(word) + 1, 1, "a word"));
    strcpy(*out, word);
    return OK;
}

static int capped(long n) {
    return n < INT_MAX ? (int)n : INT_MAX;
}

static void count_faces(struct boxes *b, struct polymesh *m) {
    long inside = 0, joined = 0, cells = 0, outside = 0;
    for (int i = 0; i < b->nboxes; i++) {
        const int *n = b->box[i].n;
        const long all = (long)n[0] * n[1] * n[2];
        cells += all;
        for (int side = 0; side < 6; side++) {
            const long across = all / n[side / 2];
            inside += side % 2 ? all - across : 0;
            joined += b->box[i].side[side].next >= 0 ? across : 0;
            outside += b->box[i].side[side].next >= 0 ? 0 : across;
        }
    }
    b->ninternal = inside + joined / 2;
    b->nfaces = b->ninternal + outside;
    m->ncells = (int)cells;
    m->ninternal = capped(b->ninternal);
    m->nfaces = capped(b->nfaces);
}

static status make_patches(const struct bounding *d) {
    struct polymesh *m = d->mesh;
    const int last = d->npatches - 1, n = d->faces[last] ? d->npatches : last;
    long start = d->b->ninternal;
    TRY(allocate(&m->patch, n, sizeof *m->patch, "patches"));
    for (; m->npatches < n; m->npatches++) {
        const struct boxes_patch *p = &d->patch[m->npatches];
        struct patch *to = &m->patch[m->npatches];
        TRY(copy_word(p->name, &to->name));
        TRY(copy_word(p->type, &to->type));
        TRY(copy_word(p->neighbour, &to->neighbour));
        TRY(copy_word(p->groups, &to->groups));
        to->start = capped(start);
        to->nfaces = (int)d->faces[m->npatches];
        start += to->nfaces;
    }
    return OK;
}

static status bound(const struct bounding *d) {
    struct boxes *b = d->b;
    TRY(allocate(&b->side, 6L * b->nboxes, sizeof *b->side, "sides of blocks"));
    TRY(allocate(&b->first, d->npatches + 1L, sizeof *b->first, "patches"));
    for (int p = 0; p < d->npatches; p++) {
        b->first[p] = b->nsides;
        TRY(p < d->npatches - 1 ? give_named(d, p) : give_others(d));
        b->first[p + 1] = b->nsides;
    }
    b->npatches = d->npatches;
    TRY(check_empty(d));
    for (int p = 0; p < d->npatches; p++)
        if (d->patch[p].neighbour) TRY(check_cyclic(d, p));
    TRY(check_ends(d));
    count_faces(b, d->mesh);
    return make_patches(d);
}

status boxes_mesh(struct boxes *b, const struct boxes_block *block, int npatches, const struct boxes_patch *patch,
                  struct polymesh **out) {
    struct bounding d = {.b = b, .block = block, .npatches = npatches, .patch = patch};
    *out = NULL;
    TRY(allocate(&d.mesh, 1, sizeof *d.mesh, "the mesh"));
    status s = allocate(&d.faces, npatches, sizeof *d.faces, "patches");
    if (!s) s = bound(&d);
    free(d.faces);
    if (s) {
        polymesh_free(d.mesh);
        return s;
    }
    d.mesh->boxes = b;
    *out = d.mesh;
    return OK;
}
