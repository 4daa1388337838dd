/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes cells and facets for grains from the polyMesh of a case (grains_mesh.h). */
#include "solvers/grains/grains_mesh.h"

#include "solvers/grains/cell_sides.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The axis of a plane mesh that is not solved. */
static int flat_axis(const struct setup *s) {
    return 3 - s->axis[0] - s->axis[1];
}

/* ---- cells */

static long nearest_cell(const struct setup *s, const double point[3]) {
    double least = HUGE_VAL;
    long nearest = 0;
    for (long c = 0; c < s->mesh->ncells; c++) {
        double square = 0;
        for (int k = 0; k < s->dim; k++) {
            const double r = s->centre[3 * c + s->axis[k]] - point[s->axis[k]];
            square += r * r;
        }
        if (square >= least) continue;
        least = square;
        nearest = c;
    }
    return nearest;
}

static long locate(const struct grain_mesh *self, const double x[3], bool *inside) {
    const struct grains_mesh *m = (const struct grains_mesh *)self;
    const struct setup *s = m->setup;
    double point[3] = {s->centre[0], s->centre[1], s->centre[2]}, wrapped[3] = {0};
    for (int k = 0; k < s->dim; k++) {
        const double length = m->high[k] - m->low[k];
        double at = x[k];
        if (m->periodic[k]) at -= length * floor((at - m->low[k]) / length);
        wrapped[k] = at;
        point[s->axis[k]] = at;
    }
    const long cell = m->sides ? cell_sides_find(m->sides, wrapped, inside) : search_cell(m->search, point);
    if (!m->sides) *inside = cell >= 0;
    return cell >= 0 ? cell : nearest_cell(s, point);
}

static void widen(const struct setup *s, const double *point, double bounds[6]) {
    for (int k = 0; k < s->dim; k++) {
        bounds[k] = fmin(bounds[k], point[s->axis[k]]);
        bounds[3 + k] = fmax(bounds[3 + k], point[s->axis[k]]);
    }
}

static status make_cells(struct grains_mesh *m) {
    const struct setup *s = m->setup;
    const struct polymesh *mesh = s->mesh;
    double(*bounds)[6], (*centre)[3], *volume, low[3], high[3], depth = 1;
    TRY(pool_take(&m->pool, &bounds, mesh->ncells, sizeof *bounds, "cells"));
    TRY(pool_take(&m->pool, &centre, mesh->ncells, sizeof *centre, "cells"));
    TRY(pool_take(&m->pool, &volume, mesh->ncells, sizeof *volume, "cells"));
    polymesh_bounds(mesh, low, high);
    if (s->dim == 2) depth = high[flat_axis(s)] - low[flat_axis(s)];
    for (int k = 0; k < s->dim; k++) {
        m->low[k] = low[s->axis[k]];
        m->high[k] = high[s->axis[k]];
    }
    for (int c = 0; c < mesh->ncells; c++) {
        volume[c] = s->volume[c] / depth;
        for (int k = 0; k < s->dim; k++) centre[c][k] = s->centre[3L * c + s->axis[k]];
        for (int k = 0; k < 3; k++) {
            bounds[c][k] = HUGE_VAL;
            bounds[c][3 + k] = -HUGE_VAL;
        }
    }
    for (int f = 0; f < mesh->nfaces; f++)
        for (int i = mesh->face_start[f]; i < mesh->face_start[f + 1]; i++) {
            const double *point = mesh->points + 3L * mesh->face_points[i];
            widen(s, point, bounds[mesh->owner[f]]);
            if (f < mesh->ninternal) widen(s, point, bounds[mesh->neighbour[f]]);
        }
    m->base = (struct grain_mesh){mesh->ncells, volume, (const double(*)[3])centre, (const double(*)[6])bounds, locate};
    TRY(cell_sides_make(mesh, s->dim, s->axis, m->base.bounds, &m->sides));
    return m->sides ? OK : search_make(mesh, s->centre, s->dim, s->axis, &m->search);
}

/* ---- facets */

struct gathering { /* facets as they are found; list NULL: they are counted only */
    const struct grains_mesh *mesh;
    struct facet *list;
    int n;
};

static const double *point_of(const struct polymesh *m, int face, int i) {
    return m->points + 3L * m->face_points[m->face_start[face] + i];
}

/* Adds a segment: the side of the face on the lower one of its two empty sides, turned so that the grains, from which
 * the face's area vector leads away, are on its left. */
static void add_segment(struct gathering *g, int face, int patch) {
    const struct setup *s = g->mesh->setup;
    const struct polymesh *m = s->mesh;
    const int n = m->face_start[face + 1] - m->face_start[face], flat = flat_axis(s);
    double centre[3], area[3];
    const double *end[2] = {NULL, NULL};
    polymesh_one_face(m, face, centre, area);
    for (int i = 0; i < n; i++) {
        const double *p = point_of(m, face, i);
        if (p[flat] > centre[flat]) continue;
        end[end[0] ? 1 : 0] = p;
    }
    if (!end[1]) return;
    if (g->list) {
        const double dx = end[1][s->axis[0]] - end[0][s->axis[0]], dy = end[1][s->axis[1]] - end[0][s->axis[1]];
        const bool turned = -dy * area[s->axis[0]] + dx * area[s->axis[1]] > 0;
        struct facet *f = &g->list[g->n];
        *f = (struct facet){.wall = patch, .face = face, .open = g->mesh->open[patch]};
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++) f->corner[j][k] = end[turned ? 1 - j : j][s->axis[k]];
    }
    g->n++;
}

/* Is the fan of triangles from corner 0 the face: flat, convex, without corners on a line? */
static bool is_fan(const struct polymesh *m, int face) {
    const int n = m->face_start[face + 1] - m->face_start[face];
    double centre[3], area[3], square = 0;
    polymesh_one_face(m, face, centre, area);
    for (int k = 0; k < 3; k++) square += area[k] * area[k];
    for (int i = 1; i + 1 < n; i++) {
        const double *o = point_of(m, face, 0), *a = point_of(m, face, i), *b = point_of(m, face, i + 1);
        double part = 0, off = 0;
        for (int k = 0; k < 3; k++) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            part += area[k] * ((a[p] - o[p]) * (b[q] - o[q]) - (a[q] - o[q]) * (b[p] - o[p]));
            off += area[k] * (b[k] - o[k]);
        }
        if (!(part > 1e-6 * square) || fabs(off) > 1e-9 * square / sqrt(sqrt(square))) return false;
    }
    return true;
}

static void add_triangle(struct gathering *g, int face, int patch, const double *const corner[3]) {
    if (g->list) {
        struct facet *f = &g->list[g->n];
        *f = (struct facet){.wall = patch, .face = face, .open = g->mesh->open[patch]};
        for (int j = 0; j < 3; j++) memcpy(f->corner[j], corner[j], sizeof f->corner[j]);
    }
    g->n++;
}

static void add_polygon(struct gathering *g, int face, int patch) {
    const struct polymesh *m = g->mesh->setup->mesh;
    const int n = m->face_start[face + 1] - m->face_start[face];
    const bool fan = is_fan(m, face);
    double centre[3], area[3];
    polymesh_one_face(m, face, centre, area);
    for (int i = fan ? 1 : 0; i < (fan ? n - 1 : n); i++)
        add_triangle(g, face, patch,
                     (const double *const[3]){fan ? point_of(m, face, 0) : centre, point_of(m, face, i),
                                              point_of(m, face, (i + 1) % n)});
}

static bool is_wall(const struct patch *p) {
    return strcmp(p->type, "empty") != 0 && strcmp(p->type, "cyclic") != 0;
}

static void gather(struct gathering *g) {
    const struct setup *s = g->mesh->setup;
    g->n = 0;
    for (int p = 0; p < s->mesh->npatches; p++) {
        const struct patch *patch = &s->mesh->patch[p];
        for (int f = patch->start; is_wall(patch) && f < patch->start + patch->nfaces; f++)
            if (s->dim == 2)
                add_segment(g, f, p);
            else
                add_polygon(g, f, p);
    }
}

/* Finds the periodic axes: both halves of a cyclic patch must lie flat on the two ends of one. */
static status find_periods(struct grains_mesh *m) {
    const struct setup *s = m->setup;
    for (int p = 0; p < s->mesh->npatches; p++) {
        const struct patch *patch = &s->mesh->patch[p];
        for (int f = 0; !strcmp(patch->type, "cyclic") && f < patch->nfaces; f++) {
            double centre[3], area[3];
            int axis = 0;
            polymesh_one_face(s->mesh, patch->start + f, centre, area);
            for (int k = 1; k < s->dim; k++)
                if (fabs(area[s->axis[k]]) > fabs(area[s->axis[axis]])) axis = k;
            const double at = centre[s->axis[axis]], slack = 1e-9 * (m->high[axis] - m->low[axis]);
            if (fmin(fabs(at - m->low[axis]), fabs(at - m->high[axis])) > slack)
                return fail(ERR_INPUT,
                            "%s: patch %s: grains need cyclic patches at both ends of the mesh along an axis; its face "
                            "%d at (%.9g %.9g %.9g) is at none",
                            polymesh_boundary_file(s->mesh), patch->name, f, centre[0], centre[1], centre[2]);
            m->periodic[axis] = true;
        }
    }
    return OK;
}

static status make_facets(struct grains_mesh *m, double diameter) {
    struct gathering g = {.mesh = m};
    struct facet_space space = {
        .dim = m->setup->dim, .reach = 0.5 * diameter * (1 + 1e-6), .walls = m->setup->mesh->npatches};
    TRY(find_periods(m));
    for (int k = 0; k < 3; k++) {
        space.low[k] = m->low[k];
        space.high[k] = m->high[k];
        space.periodic[k] = m->periodic[k];
    }
    for (long c = 0; c < m->base.cells; c++) space.volume += m->base.volume[c];
    gather(&g);
    if (g.n == 0) return OK; /* periodic along all axes */
    TRY(allocate(&g.list, g.n, sizeof *g.list, "facets"));
    gather(&g);
    const status e = status_note(facets_make(&space, g.n, g.list, &m->facets), "%s", m->setup->mesh_path);
    free(g.list);
    return e;
}

status grains_mesh_make(const struct setup *s, double diameter, const bool *open, struct grains_mesh **out) {
    struct grains_mesh *m;
    *out = NULL;
    TRY(allocate(&m, 1, sizeof *m, "cells of grains"));
    m->setup = s;
    m->open = open;
    status e = make_cells(m);
    if (!e) e = make_facets(m, diameter);
    if (e) {
        grains_mesh_free(m);
        return e;
    }
    *out = m;
    return OK;
}

void grains_mesh_free(struct grains_mesh *m) {
    if (!m) return;
    search_free(m->search);
    cell_sides_free(m->sides);
    facets_free(m->facets);
    pool_free(&m->pool);
    free(m);
}
