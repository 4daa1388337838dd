/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes surfaces and samples fields on them (functions_pieces.h). */
#include "solvers/functions/functions_pieces.h"

#include "mesh/grid/slices.h"
#include "solvers/output/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A least squares matrix with a pivot below this part of its entries has no gradient along that axis. */
static const double FLAT = 1e-10;

struct making { /* a surface being made */
    const struct function *f;
    struct surface *out;
    int *slot_of;              /* [cells] -1: not wanted yet */
    int *face_start, *face_of; /* of cells: polymesh_cell_faces; NULL for patches */
    double point[3], normal[3];
    double *above; /* [points] distance from the plane; 0 on it */
    int room, near, near_room;
};

static status grow(void *list, int count, int *room, size_t size) {
    void **items = list;
    if (count < *room) return OK;
    const int more = *room ? 2 * *room : 256;
    void *wider = realloc(*items, (size_t)more * size);
    if (!wider) return fail(ERR_SYSTEM, "out of memory: a surface");
    *items = wider;
    *room = more;
    return OK;
}

static int slot_for(struct making *m, int cell) {
    if (m->slot_of[cell] < 0) m->slot_of[cell] = m->out->picks.slots++;
    return m->slot_of[cell];
}

static status add_piece(struct making *m, const struct piece *p) {
    TRY(grow(&m->out->piece, m->out->n, &m->room, sizeof *p));
    m->out->piece[m->out->n++] = *p;
    m->out->area += p->area;
    return OK;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- a cut through a cell ---- */

struct cut {
    double area[3], centre[3]; /* vector of the area, with the sign by which the cell's faces go around; its centre */
    bool any;
};

/* Adds the triangle from `origin` over the segment from a to b. */
static void add_triangle(struct cut *c, const double normal[3], const double origin[3], const double a[3],
                         const double b[3]) {
    double u[3], v[3], area[3];
    for (int k = 0; k < 3; k++) {
        u[k] = a[k] - origin[k];
        v[k] = b[k] - origin[k];
    }
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        area[k] = 0.5 * (u[next] * v[last] - u[last] * v[next]);
        c->area[k] += area[k];
    }
    const double size = dot(area, normal);
    for (int k = 0; k < 3; k++) c->centre[k] += size * (origin[k] + a[k] + b[k]) / 3;
}

/* Where the edge between two points crosses the plane. */
static void crossing_of(const struct making *m, int p, int q, double out[3]) {
    const double a = m->above[p], b = m->above[q], share = a / (a - b);
    for (int k = 0; k < 3; k++) {
        const double from = m->f->setup->mesh->points[3 * (long)p + k], to = m->f->setup->mesh->points[3 * (long)q + k];
        out[k] = from + share * (to - from);
    }
}

/* Adds the segments in which the plane crosses a face of a cell. turn: +-1, as the outline of the face goes around seen
 * from the cell. */
static void cut_face(const struct making *m, int face, double turn, const double origin[3], struct cut *c) {
    struct slice_segment s;
    double down[3], up[3];
    for (int at = 0; slice_face(m->f->setup->mesh, m->above, face, &at, &s);) {
        crossing_of(m, s.down[0], s.down[1], down);
        crossing_of(m, s.up[0], s.up[1], up);
        add_triangle(c, m->normal, origin, turn > 0 ? down : up, turn > 0 ? up : down);
        c->any = true;
    }
}

/* ---- gradients ---- */

/* Solves M x = b for n unknowns, M symmetric; x replaces b and M is changed. Along directions in which M is singular x
 * is
 * 0. */
static void solve(int n, double M[3][3], double b[3]) {
    double most = 0;
    for (int k = 0; k < n; k++) most = fmax(most, M[k][k]);
    for (int k = 0; k < n; k++) {
        const bool flat = !(M[k][k] > FLAT * most);
        if (flat) b[k] = 0;
        for (int i = k + 1; i < n; i++) {
            const double factor = flat ? 0 : M[i][k] / M[k][k];
            for (int j = k; j < n; j++) M[i][j] -= factor * M[k][j];
            b[i] -= factor * b[k];
        }
        if (flat) M[k][k] = HUGE_VAL;
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) b[k] -= M[k][j] * b[j];
        b[k] /= M[k][k];
    }
}

/* Returns the cell on the other side of a face; -1: there is none. */
static int across(const struct polymesh *m, int face, int cell) {
    if (face >= m->ninternal) return -1;
    return m->owner[face] == cell ? m->neighbour[face] : m->owner[face];
}

/* The weights of the neighbours of a cell in the value at a place of it: value = q + a . sum_j d_j (q_j - q)/|d_j|^2
 * with M a = place - centre, M = sum_j d_j d_j/|d_j|^2. */
static status weigh_neighbours(struct making *m, int cell, const double place[3], struct piece *piece) {
    const struct setup *s = m->f->setup;
    double M[3][3] = {{0}}, a[3] = {0};
    piece->first = m->near;
    for (int k = 0; k < s->dim; k++) a[k] = place[s->axis[k]] - s->centre[3 * (long)cell + s->axis[k]];
    for (int pass = 0; pass < 2; pass++) {
        for (int j = m->face_start[cell]; j < m->face_start[cell + 1]; j++) {
            const int other = across(s->mesh, m->face_of[j], cell);
            double d[3] = {0}, square = 0, along = 0;
            if (other < 0) continue;
            for (int k = 0; k < s->dim; k++) {
                d[k] = s->centre[3 * (long)other + s->axis[k]] - s->centre[3 * (long)cell + s->axis[k]];
                square += d[k] * d[k];
            }
            for (int i = 0; i < s->dim && pass == 0; i++)
                for (int k = 0; k < s->dim; k++) M[i][k] += d[i] * d[k] / square;
            if (pass == 0) continue;
            int room = m->near_room;
            TRY(grow(&m->out->near, m->near, &room, sizeof *m->out->near));
            TRY(grow(&m->out->weight, m->near, &m->near_room, sizeof *m->out->weight));
            for (int k = 0; k < s->dim; k++) along += a[k] * d[k] / square;
            m->out->near[m->near] = slot_for(m, other);
            m->out->weight[m->near++] = along;
        }
        if (pass == 0) solve(s->dim, M, a);
    }
    piece->count = m->near - piece->first;
    return OK;
}

static status cut_cell(struct making *m, int cell) {
    const struct polymesh *mesh = m->f->setup->mesh;
    const double *centre = m->f->setup->centre + 3 * (long)cell;
    struct cut c = {.any = false};
    double origin[3], off = 0;
    for (int k = 0; k < 3; k++) off += (centre[k] - m->point[k]) * m->normal[k];
    for (int k = 0; k < 3; k++) origin[k] = centre[k] - off * m->normal[k];
    for (int j = m->face_start[cell]; j < m->face_start[cell + 1]; j++)
        cut_face(m, m->face_of[j], mesh->owner[m->face_of[j]] == cell ? 1 : -1, origin, &c);
    const double size = dot(c.area, m->normal);
    if (!c.any || size == 0) return OK;
    for (int k = 0; k < 3; k++) c.centre[k] /= size;
    struct piece piece = {.slot = slot_for(m, cell), .area = fabs(size) * round_turn(&mesh->round, c.centre)};
    memcpy(piece.normal, m->normal, sizeof piece.normal);
    TRY(weigh_neighbours(m, cell, c.centre, &piece));
    return add_piece(m, &piece);
}

/* ---- the whole surface ---- */

static status begin(struct making *m, const struct function *f, struct surface *out) {
    const struct polymesh *mesh = f->setup->mesh;
    m->f = f;
    m->out = out;
    TRY(allocate(&m->slot_of, mesh->ncells, sizeof *m->slot_of, "a surface"));
    for (int i = 0; i < mesh->ncells; i++) m->slot_of[i] = -1;
    return OK;
}

static void end(struct making *m) {
    void *const all[] = {m->slot_of, m->face_start, m->face_of, m->above};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

static status take_faces(struct making *m, const struct patch_choice *c) {
    const struct polymesh *mesh = m->f->setup->mesh;
    TRY(pool_take(m->f->pool, &m->out->run, mesh->npatches, sizeof *m->out->run, "a surface"));
    for (int p = 0; p < mesh->npatches; p++) {
        if (c->takes[p]) m->out->run[m->out->nruns++] = (struct patch_run){p, mesh->patch[p].nfaces};
        for (int i = 0; i < mesh->patch[p].nfaces && c->takes[p]; i++) {
            double centre[3], area[3];
            polymesh_patch_face(mesh, p, i, centre, area);
            const double size = sqrt(dot(area, area));
            struct piece piece = {.slot = slot_for(m, polymesh_patch_cell(mesh, p, i)),
                                  .area = size * round_turn(&mesh->round, centre)};
            for (int k = 0; k < 3; k++) piece.normal[k] = area[k] / size;
            TRY(add_piece(m, &piece));
        }
    }
    return picks_make(m->f, m->out->picks.slots, m->slot_of, &m->out->picks);
}

status surface_of_patches(const struct function *f, const struct patch_choice *c, struct surface *out) {
    struct making m = {.room = 0};
    status s = begin(&m, f, out);
    if (!s) s = take_faces(&m, c);
    end(&m);
    TRY(comm_agree(f->setup->comm, s));
    return edges_make(f->setup, c->takes, &out->edges);
}

static status take_cells(struct making *m, const double point[3], const double normal[3]) {
    const struct polymesh *mesh = m->f->setup->mesh;
    const double size = sqrt(dot(normal, normal));
    for (int k = 0; k < 3; k++) {
        m->point[k] = point[k];
        m->normal[k] = normal[k] / size;
    }
    TRY(setup_complete(m->f->setup));
    TRY(slice_distances(mesh, point, m->normal, &m->above));
    TRY(polymesh_cell_faces(mesh, &m->face_start, &m->face_of));
    for (int cell = 0; cell < mesh->ncells; cell++) TRY(cut_cell(m, cell));
    return picks_make(m->f, m->out->picks.slots, m->slot_of, &m->out->picks);
}

status surface_of_plane(const struct function *f, const double point[3], const double normal[3], struct surface *out) {
    struct making m = {.room = 0};
    status s = begin(&m, f, out);
    if (!s) s = take_cells(&m, point, normal);
    end(&m);
    return comm_agree(f->setup->comm, s);
}

static double value_of(const struct surface *s, const struct piece *p, const double *slots, int components, int k) {
    const double here = slots[(long)p->slot * components + k];
    double low = here, high = here, value = here;
    for (int j = p->first; j < p->first + p->count; j++) {
        const double there = slots[(long)s->near[j] * components + k];
        value += s->weight[j] * (there - here);
        low = fmin(low, there);
        high = fmax(high, there);
    }
    return fmin(fmax(value, low), high);
}

status surface_renew(struct surface *s) {
    return edges_find(s->edges);
}

status surface_sample(const struct surface *s, const struct function *f, int quantity, double **out) {
    const int m = f->setup->medium->fields.quantity[quantity].components;
    double *slots = NULL;
    *out = NULL;
    status e = allocate(&slots, (s->picks.slots + 1L) * m, sizeof(double), "samples");
    if (!e) picks_gather(&s->picks, f, quantity, slots);
    if (!e) e = allocate(out, (s->n + 1L) * m, sizeof **out, "samples");
    for (int i = 0; !e && i < s->n; i++)
        for (int k = 0; k < m; k++) (*out)[(long)i * m + k] = value_of(s, &s->piece[i], slots, m, k);
    double *values = *out;
    for (int i = 0; !e && i < s->nruns; values += (long)s->run[i++].n * m)
        edges_values(s->edges, quantity, s->run[i].patch, s->run[i].n, NULL, values);
    free(slots);
    return e;
}

void surface_free(struct surface *s) {
    edges_free(s->edges);
    free(s->piece);
    free(s->near);
    free(s->weight);
}
