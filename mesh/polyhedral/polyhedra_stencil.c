/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grows the stencils of a polyhedral mesh: rings of cells across faces, with their images in a periodic domain; finds
 * the corners of cells, members that share a vertex. */
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_private.h"

/* ---- growth ------------------------------------------------------------------------------------------------------ */

status grower_make(struct pool *pool, const struct links *l, int rings, struct grower *g) {
    int coefficients = rings == 1 ? l->dim : l->dim * (l->dim + 3) / 2;
    int wanted = rings == 1 ? 2 * coefficients : (3 * coefficients + 1) / 2;
    *g = (struct grower){.pool = pool, .l = l, .rings = rings, .wanted = wanted, .room = 64};
    TRY(pool_take(pool, &g->seen, l->mesh->ncells, sizeof *g->seen, "the stencils"));
    return pool_take(pool, &g->member, g->room, sizeof *g->member, "the stencils");
}

static bool has_member(const struct grower *g, int cell, int image) {
    if (g->seen[cell] != g->stamp) return false;
    for (int i = 0; i < g->n; i++)
        if (g->member[i].cell == cell && g->member[i].image == image) return true;
    return false;
}

static status add_member(struct grower *g, int cell, int image, int ring) {
    if (g->n == g->room) {
        const struct member *few = g->member;
        TRY(pool_take(g->pool, &g->member, 2L * g->room, sizeof *g->member, "the stencils"));
        memcpy(g->member, few, (size_t)g->n * sizeof *few);
        g->room *= 2;
    }
    if (cell >= 0) g->seen[cell] = g->stamp;
    g->member[g->n++] = (struct member){cell, image, ring};
    return OK;
}

static int by_cell(const void *a, const void *b) {
    const struct member *p = a, *q = b;
    if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
    return (p->image > q->image) - (p->image < q->image);
}

static status add_neighbours(struct grower *g, const struct member of) {
    const struct links *l = g->l;
    for (int i = l->cell_start[of.cell]; i < l->cell_start[of.cell + 1]; i++) {
        int image, code = l->cell_link[i], cell = links_cross(l, code, of.image, &image);
        if (image < 0) continue;
        if (cell < 0) {
            if (of.ring == 0) TRY(add_member(g, ~code, 0, 1));
        } else if (!has_member(g, cell, image)) {
            TRY(add_member(g, cell, image, of.ring + 1));
        }
    }
    return OK;
}

static void sort_ring(struct member *m, int n) {
    if (n > 40) {
        qsort(m, (size_t)n, sizeof *m, by_cell);
        return;
    }
    for (int i = 1; i < n; i++) {
        struct member x = m[i];
        int j = i;
        for (; j > 0 && by_cell(&m[j - 1], &x) > 0; j--) m[j] = m[j - 1];
        m[j] = x;
    }
}

status grower_run(struct grower *g, int cell) {
    g->n = 0;
    g->stamp++;
    TRY(add_member(g, cell, 0, 0));
    for (int ring = 1, from = 0; ring <= MOST_RINGS && (ring <= g->rings || g->n - 1 < g->wanted); ring++) {
        int to = g->n;
        for (; from < to; from++)
            if (g->member[from].cell >= 0) TRY(add_neighbours(g, g->member[from]));
        if (g->n == to) break;
        if (ring > 1) sort_ring(g->member + to, g->n - to);
    }
    return OK;
}

/* ---- corners ----------------------------------------------------------------------------------------------------- */

enum { MOST_ENTRIES = 1024 }; /* pairs of vertex and face of one cell: a polyhedron of 100 faces has about 600 */

struct corners {
    int n;
    struct {
        int point, member;
    } entry[MOST_ENTRIES];
};

/* Adds the vertices of a face in the solved axes: all in 3D, the ends of its edge in 2D, one point in 1D. */
static void add_vertices(const struct links *l, int face, int member, struct corners *k) {
    const struct polymesh *m = l->mesh;
    int pair[2], n = m->face_start[face + 1] - m->face_start[face];
    const int *point = m->face_points + m->face_start[face];
    if (l->dim == 2) {
        n = links_edge(l, face, &pair[0], &pair[1]) ? 2 : 0;
        point = pair;
    } else if (l->dim == 1)
        n = 1;
    for (int i = 0; i < n && k->n < MOST_ENTRIES; i++) {
        k->entry[k->n].point = point[i];
        k->entry[k->n++].member = member;
    }
}

static int find_member(const struct grower *g, int code) {
    int image, cell = links_cross(g->l, code, 0, &image), i = 1;
    if (cell < 0) cell = ~code;
    while (g->member[i].cell != cell || (cell >= 0 && g->member[i].image != image)) i++;
    return i - 1;
}

static void list_corners(const struct grower *g, struct corners *k) {
    const struct links *l = g->l;
    int cell = g->member[0].cell;
    k->n = 0;
    for (int i = l->cell_start[cell]; i < l->cell_start[cell + 1]; i++) {
        bool outward;
        int code = l->cell_link[i], face = links_face(l, code, &outward);
        add_vertices(l, face, find_member(g, code), k);
    }
}

/* Takes the members at the vertex of entry `first` off the list into member[], each once; returns how many. Vertices
 * with fewer members than axes are no corners and return 0. */
static int take_corner(struct corners *k, int first, int dim, int *member) {
    int point = k->entry[first].point, n = 0;
    if (point < 0) return 0;
    for (int i = first; i < k->n; i++) {
        if (k->entry[i].point != point) continue;
        k->entry[i].point = -1;
        bool known = false;
        for (int j = 0; j < n; j++) known = known || member[j] == k->entry[i].member;
        if (!known) member[n++] = k->entry[i].member;
    }
    return n < dim ? 0 : n;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

struct room { /* room in the lists, which grow cell by cell */
    long corners, members;
};

static status grow_list(int **list, long wanted, long *room) {
    if (wanted <= *room) return OK;
    long size = 2 * wanted + 1024;
    int *more = realloc(*list, (size_t)size * sizeof *more);
    if (!more) return fail(ERR_SYSTEM, "no memory for %ld corners of cells", size);
    *list = more;
    *room = size;
    return OK;
}

static status add_corners(struct polyhedra *m, int cell, const struct grower *g, struct corners *k, struct room *room) {
    int member[MOST_ENTRIES], ncorners = m->corner_start[cell];
    list_corners(g, k);
    for (int first = 0; first < k->n; first++) {
        int n = take_corner(k, first, m->dim, member), to = m->corner_first[ncorners];
        if (n == 0) continue;
        TRY(grow_list(&m->corner_first, ncorners + 2L, &room->corners));
        TRY(grow_list(&m->corner_member, to + (long)n, &room->members));
        for (int i = 0; i < n; i++) m->corner_member[to + i] = member[i];
        m->corner_first[++ncorners] = to + n;
    }
    m->corner_start[cell + 1] = ncorners;
    return OK;
}

static void fill_stencil(struct polyhedra *m, int cell, const struct grower *g, const int *local,
                         const int *mirror_of) {
    int *stencil = m->stencil + m->stencil_start[cell], *ring = m->ring + m->stencil_start[cell];
    for (int i = 1; i < g->n; i++) {
        const struct member *x = &g->member[i];
        int to = x->cell >= 0 ? local[x->cell] : m->ncells + mirror_of[~x->cell];
        stencil[i - 1] = to;
        ring[i - 1] = x->ring;
        for (int k = 0; k < m->dim; k++)
            m->offset[k][m->stencil_start[cell] + i - 1] =
                m->centre[k][to] + g->l->image[x->image][k] - m->centre[k][cell];
    }
}

static status fill_all(struct polyhedra *m, struct grower *g, const int *local, const int *mirror_of,
                       struct corners *k) {
    struct room room = {0};
    TRY(grow_list(&m->corner_first, 1, &room.corners));
    m->corner_first[0] = 0;
    for (int c = 0; c < m->nnear; c++) {
        TRY(grower_run(g, m->cell[c]));
        fill_stencil(m, c, g, local, mirror_of);
        TRY(add_corners(m, c, g, k, &room));
    }
    return OK;
}

status stencil_make(struct polyhedra *m, struct grower *g, const int *local, const int *mirror_of) {
    long n = m->stencil_start[m->nnear];
    TRY(pool_take(&m->pool, &m->stencil, n, sizeof *m->stencil, "the stencils"));
    TRY(pool_take(&m->pool, &m->ring, n, sizeof *m->ring, "the stencils"));
    TRY(lines_make(m, m->offset, m->dim, n, "the stencils"));
    TRY(pool_take(&m->pool, &m->corner_start, m->nnear + 1L, sizeof *m->corner_start, "the corners"));
    struct corners *k;
    TRY(allocate(&k, 1, sizeof *k, "the corners"));
    status s = fill_all(m, g, local, mirror_of, k);
    free(k);
    return s;
}
