/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the struct polyhedra of a rank (polyhedra.h): numbers its cells, ghosts and mirrors, lists its faces, and joins
 * cells and faces. */
#include "mesh/polyhedral/polyhedra.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_make_private.h"

static const double CLASSES = 4; /* of sizes, within a factor of two */
/* Marks in `local` until the cells are numbered. */
enum { NOWHERE = -1, MINE = -2, NEAR = -3, FAR = -4, WALKED = -5, ORDERED = -6 };

/* ---- cells ------------------------------------------------------------------------------------------------------- */

static int rank_of(const struct work *w, int cell) {
    return w->cut.rank_of[w->block_of[cell]];
}

static void add_ghost(struct work *w, int cell, int kind) {
    w->local[cell] = kind;
    w->ghost[w->nghosts++] = (struct ghost){kind, rank_of(w, cell), cell};
}

static status list_near(struct polyhedra *m, struct work *w) {
    const struct links *l = &w->links;
    TRY(pool_take(&w->pool, &w->ghost, l->mesh->ncells - m->nown, sizeof *w->ghost, "the ghosts"));
    for (int k = 0; k < m->nown; k++)
        for (int c = w->mine[k], i = l->cell_start[c]; i < l->cell_start[c + 1]; i++) {
            int image, to = links_cross(l, l->cell_link[i], 0, &image);
            if (to >= 0 && w->local[to] == NOWHERE) add_ghost(w, to, NEAR);
        }
    m->nnear = m->nown + w->nghosts;
    return OK;
}

/* Grows the stencil of a cell once to learn its size and its ghosts. */
static status scout(struct work *w, int cell) {
    TRY(grower_run(&w->grower, cell));
    w->members[cell] = w->grower.n - 1;
    for (int i = 1; i < w->grower.n; i++) {
        int member = w->grower.member[i].cell;
        if (member < 0) continue;
        if (w->local[member] == NOWHERE) add_ghost(w, member, FAR);
        if (w->local[member] != MINE) w->waits[cell] = true;
    }
    return OK;
}

static int by_place(const void *a, const void *b) {
    const struct ghost *p = a, *q = b;
    if (p->kind != q->kind) return p->kind > q->kind ? -1 : 1;
    if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
    return (p->cell > q->cell) - (p->cell < q->cell);
}

/* Walks breadth first from the first `in` cells of `order` through my cells that bear a mark; gives them another one,
 * lists them in order. Returns how many. */
static int walk(const struct links *l, int *marks, int in, int mark, int other, int *order) {
    int image;
    for (int i = 0; i < in; i++) marks[order[i]] = other;
    for (int out = 0; out < in; out++)
        for (int c = order[out], k = l->cell_start[c]; k < l->cell_start[c + 1]; k++) {
            const int to = links_cross(l, l->cell_link[k], 0, &image);
            if (to < 0 || marks[to] != mark) continue;
            marks[to] = other;
            order[in++] = to;
        }
    return in;
}

/* The polyMesh face of entry k of cell_link. */
static int face_at(const struct links *l, int k) {
    const int code = l->cell_link[k], link = code < 0 ? ~code : code;
    return code < 0 && l->twin[link] >= 0 ? l->twin[link] : l->face[link];
}

/* Extends a range [low, high] by the centres of a cell's faces along an axis. */
static void reach(const struct links *l, int cell, int axis, double range[2]) {
    for (int k = l->cell_start[cell]; k < l->cell_start[cell + 1]; k++) {
        const double x = l->face_centre[3L * face_at(l, k) + axis];
        range[0] = x < range[0] ? x : range[0];
        range[1] = x > range[1] ? x : range[1];
    }
}

/* Moves those of n listed cells to the front that lie at the upper end of the axis along which they reach farthest;
 * returns how many. A walk from there goes in fronts as short as the mesh is wide; under gravity they are level, as
 * beds are. */
static int begin_at_end(const struct links *l, int n, int *order) {
    double length = -1, end = 0;
    int axis = 0, in = 0;
    for (int a = 0; a < l->dim; a++) {
        double range[2] = {HUGE_VAL, -HUGE_VAL};
        for (int i = 0; i < n; i++) reach(l, order[i], l->axis[a], range);
        if (range[1] - range[0] < length) continue;
        axis = l->axis[a];
        length = range[1] - range[0];
        end = range[1] - 1e-6 * length;
    }
    for (int i = 0; i < n; i++) {
        double range[2] = {HUGE_VAL, -HUGE_VAL};
        reach(l, order[i], axis, range);
        if (range[1] >= end) order[in++] = order[i];
    }
    return in;
}

/* The area of the faces of a cell over its volume, in the plane of round meshes: the rate of sound in it per speed. */
static double rate_of(const struct links *l, int cell) {
    const double *middle = NULL;
    double area = 0, volume = 0;
    for (int k = l->cell_start[cell]; k < l->cell_start[cell + 1]; k++) {
        const int face = face_at(l, k), code = l->cell_link[k];
        const double *A = l->face_area + 3L * face, *x = l->face_centre + 3L * face;
        const double sign = code < 0 && l->twin[~code] < 0 ? -1 : 1;
        double square = 0;
        if (!middle) middle = x;
        for (int a = 0; a < l->dim; a++) {
            const int axis = l->axis[a];
            square += A[axis] * A[axis];
            volume += sign * A[axis] * (x[axis] - middle[axis]) / l->dim;
        }
        area += sqrt(square);
    }
    return area / volume;
}

struct sized { /* a cell */
    int class, place, cell;
};
static int by_size(const void *a, const void *b) {
    const struct sized *p = a, *q = b;
    if (p->class != q->class) return p->class < q->class ? -1 : 1;
    return (p->place > q->place) - (p->place < q->place);
}

/* Sorts n cells by classes of their sizes, the largest ones first. */
static status sort_sizes(const struct work *w, int n, int *order) {
    struct sized *s;
    TRY(allocate(&s, n, sizeof *s, "the cells"));
    for (int i = 0; i < n; i++)
        s[i] = (struct sized){(int)floor(CLASSES * log2(rate_of(&w->links, order[i]))), i, order[i]};
    qsort(s, (size_t)n, sizeof *s, by_size);
    for (int i = 0; i < n; i++) order[i] = s[i].cell;
    free(s);
    return OK;
}

/* Numbers my cells, those that wait last, in the order of their sizes if that is wanted, and of walks through each part
 * of them that hangs together. A walk starts at an end of it: so the neighbours of a cell stand little before or behind
 * it. */
static status number_mine(struct polyhedra *m, struct work *w) {
    int *order, n = 0, first = 0;
    TRY(allocate(&order, m->nown, sizeof *order, "the cells"));
    for (int k = 0; k < m->nown; k++)
        if (w->local[w->mine[k]] == MINE) {
            order[first] = w->mine[k];
            const int here = walk(&w->links, w->local, 1, MINE, WALKED, order + first);
            const int begin = begin_at_end(&w->links, here, order + first);
            first += walk(&w->links, w->local, begin, WALKED, ORDERED, order + first);
        }
    status e = w->sized && m->nown ? sort_sizes(w, m->nown, order) : OK;
    for (int waits = 0; waits < 2; waits++) {
        for (int k = 0; k < m->nown; k++)
            if (w->waits[order[k]] == waits) m->cell[n++] = order[k];
        if (!waits) m->ninner = n;
    }
    free(order);
    return e;
}

static status scout_all(struct polyhedra *m, struct work *w) {
    const int near = m->nnear - m->nown;
    for (int k = 0; k < m->nown; k++) TRY(scout(w, w->mine[k]));
    for (int k = 0; k < near; k++) TRY(scout(w, w->ghost[k].cell));
    return OK;
}

static status number_cells(struct polyhedra *m, struct work *w) {
    int n = m->nown;
    if (w->nghosts) qsort(w->ghost, (size_t)w->nghosts, sizeof *w->ghost, by_place);
    m->ncells = m->nown + w->nghosts;
    TRY(pool_take(&m->pool, &m->cell, m->ncells, sizeof *m->cell, "the cells"));
    TRY(pool_take(&m->pool, &m->block_cell, m->nown, sizeof *m->block_cell, "the cells"));
    TRY(pool_take(&w->pool, &w->ghost_rank, w->nghosts, sizeof *w->ghost_rank, "the ghosts"));
    TRY(pool_take(&m->pool, &m->stencil_start, m->nnear + 1L, sizeof *m->stencil_start, "the stencils"));
    TRY(number_mine(m, w));
    for (int k = 0; k < w->nghosts; k++) {
        m->cell[n++] = w->ghost[k].cell;
        w->ghost_rank[k] = w->ghost[k].rank;
    }
    for (int i = 0; i < m->ncells; i++) w->local[m->cell[i]] = i;
    for (int i = 0; i < m->nnear; i++) m->stencil_start[i + 1] = m->stencil_start[i] + w->members[m->cell[i]];
    for (int k = 0; k < m->nown; k++) m->block_cell[k] = w->local[w->mine[k]];
    return OK;
}

/* Starts anew to list ghosts. */
static status begin_cells(struct polyhedra *m, struct work *w, int rings) {
    const int n = w->links.mesh->ncells;
    TRY(pool_take(&w->pool, &w->local, n, sizeof *w->local, "the cells"));
    TRY(pool_take(&w->pool, &w->members, n, sizeof *w->members, "the cells"));
    TRY(pool_take(&w->pool, &w->waits, n, sizeof *w->waits, "the cells"));
    for (int c = 0; c < n; c++) w->local[c] = NOWHERE;
    for (int k = 0; k < m->nown; k++) w->local[w->mine[k]] = MINE;
    return grower_make(&w->pool, &w->links, rings, &w->grower);
}

status work_cells(struct polyhedra *m, struct work *w, int rings) {
    m->dim = w->links.dim;
    m->thickness = w->links.thickness;
    memcpy(m->axis, w->links.axis, sizeof m->axis);
    TRY(begin_cells(m, w, rings));
    TRY(list_near(m, w));
    return scout_all(m, w);
}

/* ---- faces ------------------------------------------------------------------------------------------------------- */

/* Lists faces of cell i: with `local` (i is inner) those to lower cells, so that all faces of the cells up to any one
 * are the first ones of the list; else those to higher cells (ghosts are higher than all of mine) that are not both
 * inner. They stand in the order of those cells. */
static void list_inside(struct polyhedra *m, struct work *w, int i, bool local) {
    const struct links *l = &w->links;
    const int first = m->face.n, *number = w->local;
    for (int c = m->cell[i], k = l->cell_start[c]; k < l->cell_start[c + 1]; k++) {
        int image, code = l->cell_link[k], to = links_cross(l, code, 0, &image);
        if (to < 0 || (number[to] == i && code < 0)) continue;
        if (local ? number[to] > i : number[to] < i || number[to] < m->ninner) continue;
        int link = code < 0 ? ~code : code, at = m->face.n++;
        for (; at > first; at--) {
            int before = w->link_of[at - 1], other = l->left[before] == c ? l->right[before] : l->left[before];
            if (number[other] <= number[to]) break;
            w->link_of[at] = before;
        }
        w->link_of[at] = link;
    }
}

/* Lists the boundary faces patch by patch, in the order of the cells. */
static status list_boundary(struct polyhedra *m, struct work *w) {
    const struct links *l = &w->links;
    const int npatches = l->mesh->npatches;
    int *start;
    TRY(allocate(&start, npatches + 2L, sizeof *start, "the patches"));
    for (int fill = 0; fill < 2; fill++)
        for (int i = 0; i < m->nown; i++)
            for (int c = m->cell[i], k = l->cell_start[c]; k < l->cell_start[c + 1]; k++) {
                int link = l->cell_link[k];
                if (link < 0 || l->patch[link] < 0) continue;
                if (fill)
                    w->link_of[m->face.ninternal + start[l->patch[link] + 1]++] = link;
                else
                    for (int p = l->patch[link]; p < npatches; p++) start[p + 2]++;
            }
    m->face.n = m->face.ninternal + start[npatches];
    free(start);
    return OK;
}

static status list_faces(struct polyhedra *m, struct work *w) {
    const struct links *l = &w->links;
    long room = 0;
    for (int i = 0; i < m->nown; i++) room += l->cell_start[m->cell[i] + 1] - l->cell_start[m->cell[i]];
    TRY(pool_take(&w->pool, &w->link_of, room, sizeof *w->link_of, "the faces"));
    for (int i = 0; i < m->ninner; i++) list_inside(m, w, i, true);
    m->face.nlocal = m->face.n;
    for (int i = 0; i < m->nown; i++) list_inside(m, w, i, false);
    m->face.ninternal = m->face.n;
    return list_boundary(m, w);
}

static status list_mirrors(struct polyhedra *m, struct work *w) {
    const struct links *l = &w->links;
    struct polyhedra_mirrors *mirror = &m->mirror;
    long room = m->face.n - m->face.ninternal;
    for (int i = m->nown; i < m->nnear; i++) room += l->cell_start[m->cell[i] + 1] - l->cell_start[m->cell[i]];
    TRY(pool_take(&w->pool, &w->mirror_link, room, sizeof *w->mirror_link, "the mirrors"));
    for (int i = m->face.ninternal; i < m->face.n; i++) w->mirror_link[mirror->n++] = w->link_of[i];
    for (int i = m->nown; i < m->nnear; i++)
        for (int c = m->cell[i], k = l->cell_start[c]; k < l->cell_start[c + 1]; k++)
            if (l->cell_link[k] >= 0 && l->patch[l->cell_link[k]] >= 0) w->mirror_link[mirror->n++] = l->cell_link[k];
    TRY(pool_take(&m->pool, &mirror->cell, mirror->n, sizeof *mirror->cell, "the mirrors"));
    TRY(pool_take(&m->pool, &mirror->patch, mirror->n, sizeof *mirror->patch, "the mirrors"));
    TRY(pool_take(&m->pool, &mirror->place, mirror->n, sizeof *mirror->place, "the mirrors"));
    for (int i = 0; i < mirror->n; i++) {
        int link = w->mirror_link[i];
        mirror->cell[i] = w->local[l->left[link]];
        mirror->patch[i] = l->patch[link];
        mirror->place[i] = links_face_name(l, l->face[link]) - l->all->patch[l->patch[link]].start;
        w->mirror_of[link] = i;
    }
    m->face.patch = mirror->patch;
    m->face.place = mirror->place;
    m->size = m->ncells + mirror->n;
    return OK;
}

static status join_cells(struct polyhedra *m, struct work *w) {
    const struct links *l = &w->links;
    TRY(pool_take(&m->pool, &m->face.left, m->face.n, sizeof *m->face.left, "the faces"));
    TRY(pool_take(&m->pool, &m->face.right, m->face.n, sizeof *m->face.right, "the faces"));
    for (int i = 0; i < m->face.n; i++) {
        int link = w->link_of[i], right = l->right[link];
        w->face_of[link] = i;
        m->face.left[i] = w->local[l->left[link]];
        m->face.right[i] = right >= 0 ? w->local[right] : m->ncells + w->mirror_of[link];
    }
    TRY(pool_take(&m->pool, &m->face_start, m->nown + 1L, sizeof *m->face_start, "the faces of the cells"));
    for (int i = 0; i < m->nown; i++)
        m->face_start[i + 1] = m->face_start[i] + l->cell_start[m->cell[i] + 1] - l->cell_start[m->cell[i]];
    TRY(pool_take(&m->pool, &m->face_of_cell, m->face_start[m->nown], sizeof *m->face_of_cell,
                  "the faces of the cells"));
    for (int i = 0; i < m->nown; i++)
        for (int k = m->face_start[i]; k < m->face_start[i + 1]; k++) {
            int code = l->cell_link[l->cell_start[m->cell[i]] + k - m->face_start[i]];
            m->face_of_cell[k] = code < 0 ? ~w->face_of[~code] : w->face_of[code];
        }
    return OK;
}

static status make_faces(struct polyhedra *m, struct work *w) {
    TRY(pool_take(&w->pool, &w->face_of, w->links.n, sizeof *w->face_of, "the faces"));
    TRY(pool_take(&w->pool, &w->mirror_of, w->links.n, sizeof *w->mirror_of, "the mirrors"));
    TRY(list_faces(m, w));
    TRY(list_mirrors(m, w));
    return join_cells(m, w);
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static void work_free(struct work *w) {
    pool_free(&w->pool);
    cut_cells_free(&w->cut);
    free(w->mine);
}

status work_local(struct polyhedra *m, struct work *w, int rings) {
    TRY(number_cells(m, w));
    TRY(make_faces(m, w));
    TRY(geometry_make(m, &w->links, w->local, w->link_of, w->mirror_link, rings == 1 ? 1 : 3));
    TRY(stencil_make(m, &w->grower, w->local, w->mirror_of));
    for (int i = 0; i < m->ncells; i++) m->cell[i] = links_cell_name(&w->links, m->cell[i]);
    return OK;
}

/* Makes room for blocks of which this rank has those in block[n][2], pairs of block and cell in ascending order. */
static status list_blocks(struct polyhedra *m, struct work *w, long n, const int (*block)[2]) {
    m->nblocks_all = w->cut.nblocks;
    m->nown = (int)n;
    TRY(pool_take(&m->pool, &m->block_id, n, sizeof *m->block_id, "the blocks"));
    TRY(pool_take(&m->pool, &m->block_start, n + 1, sizeof *m->block_start, "the blocks"));
    TRY(allocate(&w->mine, n, sizeof *w->mine, "the cells"));
    for (long i = 0; i < n; i++) {
        if (i == 0 || block[i][0] != block[i - 1][0]) m->block_id[m->nblocks++] = block[i][0];
        m->block_start[m->nblocks] = (int)i + 1;
        w->mine[i] = block[i][1];
    }
    return OK;
}

static int by_block(const void *a, const void *b) {
    const int *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

status work_blocks(struct polyhedra *m, struct work *w, long n, int (*block)[2]) {
    if (n) qsort(block, (size_t)n, sizeof *block, by_block);
    return list_blocks(m, w, n, (const int(*)[2])block);
}

/* ---- where each rank has the whole mesh -------------------------------------------------------------------------- */

static status cut_whole(struct work *w, const struct comm *c, const struct comm *alone) {
    const struct links *l = &w->links;
    const struct polymesh *mesh = l->mesh;
    struct cut_mesh m = {.mesh = mesh, .cells = share_make(alone, mesh->ncells), .dim = l->dim};
    double *centre = NULL, *volume = NULL;
    memcpy(m.axis, l->axis, sizeof m.axis);
    polymesh_bounds(mesh, m.low, m.high);
    status s = allocate(&centre, 3L * mesh->ncells, sizeof *centre, "the blocks");
    if (!s) s = allocate(&volume, mesh->ncells, sizeof *volume, "the blocks");
    if (!s) s = polymesh_cell_geometry(mesh, l->face_centre, l->face_area, centre, volume);
    free(volume);
    m.centre = centre;
    s = comm_agree(c, s);
    if (!s) s = cut_cells(&m, c, &w->cut);
    free(centre);
    return s;
}

/* Takes the cells of my blocks out of all. */
static status take_mine(struct polyhedra *m, struct work *w) {
    const int n = w->links.mesh->ncells, me = comm_rank(m->comm);
    int(*block)[2];
    long mine = 0;
    TRY(pool_take(&w->pool, &w->block_of, n, sizeof *w->block_of, "the blocks"));
    TRY(allocate(&block, n, sizeof *block, "the blocks"));
    memcpy(w->block_of, w->cut.block, (size_t)n * sizeof *w->block_of);
    for (int c = 0; c < n; c++) {
        if (rank_of(w, c) != me) continue;
        block[mine][0] = w->block_of[c];
        block[mine++][1] = c;
    }
    const status s = work_blocks(m, w, mine, block);
    free(block);
    return s;
}

static status make_whole(struct polyhedra *m, const struct polymesh *mesh, struct work *w, int rings) {
    struct comm *alone = NULL;
    status s = links_make(&w->pool, mesh, NULL, &w->links);
    if (!s && (rings < 1 || rings > 2)) s = fail(ERR_INPUT, "stencils of %d rings; 1 or 2 are allowed", rings);
    if (!s) s = comm_alone(&alone);
    s = comm_agree(m->comm, s);
    if (!s) s = cut_whole(w, m->comm, alone);
    comm_alone_free(alone);
    TRY(s);
    s = take_mine(m, w);
    if (!s) s = work_cells(m, w, rings);
    return comm_agree(m->comm, s ? s : work_local(m, w, rings));
}

/* ---- either way ----------------------------------------------------------------------------------------------------
 */

static status make(const struct polymesh *mesh, const struct comm *c, int rings, struct work *w,
                   struct polyhedra **out) {
    struct polyhedra *m = NULL;
    *out = NULL;
    status s = allocate(&m, 1, sizeof *m, "the polyhedra");
    if (!s) s = pool_take(&m->pool, &m->hidden, 1, sizeof *m->hidden, "the polyhedra");
    s = comm_agree(c, s);
    if (!s) {
        m->comm = c;
        m->ncells_all = mesh->ncells;
        s = w->spread ? work_spread(m, mesh, w, rings) : make_whole(m, mesh, w, rings);
    }
    if (!s) s = halo_make(m, w->ghost_rank);
    work_free(w);
    if (s) {
        polyhedra_free(m);
        return status_up(s, __FILE__, __LINE__);
    }
    *out = m;
    return OK;
}

status polyhedra_make(const struct polymesh *mesh, const struct comm *c, int rings, struct polyhedra **out) {
    struct work w = {.spread = NULL};
    return make(mesh, c, rings, &w, out);
}

status polyhedra_make_sized(const struct polymesh *mesh, const struct comm *c, int rings, struct polyhedra **out) {
    struct work w = {.sized = true};
    return make(mesh, c, rings, &w, out);
}

status polyhedra_make_spread(const struct polymesh *mesh, const struct spread *spread, int rings, bool sized,
                             struct mesh_part *part, struct polyhedra **out) {
    struct work w = {.spread = spread, .part = part, .sized = sized};
    *part = (struct mesh_part){.mesh.nfaces = 0};
    return make(mesh, spread->comm, rings, &w, out);
}

void polyhedra_place(const struct polyhedra *m, long cell, double place[3]) {
    for (int k = 0; k < 3; k++) place[k] = HUGE_VAL;
    for (int i = 0; i < m->nown; i++)
        if (m->cell[i] == cell) memcpy(place, m->middle[i], sizeof m->middle[i]);
    comm_min(m->comm, place, 3);
}

void polyhedra_free(struct polyhedra *m) {
    if (!m) return;
    if (m->hidden) comm_exchange_free(m->hidden->exchange);
    free(m->corner_first);
    free(m->corner_member);
    pool_free(&m->pool);
    free(m);
}
