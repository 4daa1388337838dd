/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens a time of another case and interpolates its fields: cell by cell, in columns, and their gradients
 * (segregation_gas.h). */
#include "solvers/segregation/segregation_gas.h"

#include "mesh/grid/search.h"
#include "solvers/case/blockmesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static status find_time(double wanted, struct gas_time *g) {
    struct instant *all;
    int n, found = -1;
    TRY(times_list(g->dir, &n, &all));
    for (int i = 0; i < n; i++)
        if (isnan(wanted) || fabs(wanted - all[i].t) <= 1e-9 * fabs(wanted)) found = i;
    if (found >= 0) memcpy(g->name, all[found].name, TIME_NAME);
    char known[256] = "";
    for (int i = 0; i < n && found < 0 && strlen(known) < 200; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%.60s", i ? " " : "", all[i].name);
    free(all);
    if (found >= 0) return OK;
    return fail(ERR_INPUT, "%s: %s: case %s has no time %.12g%s%s", dict_path(g->asked), g->entry, g->dir, wanted,
                n ? "; it has " : "", known);
}

static status read_mesh(struct gas_time *g) {
    struct case_mesh read;
    const status there = case_mesh_read(g->dir, &read);
    g->mesh = read.mesh;
    TRY(status_note(there, "%s: %s: the mesh of case %s", dict_path(g->asked), g->entry, g->dir));
    TRY(polymesh_complete(g->mesh));
    const status e = status_note(polymesh_check_geometry(g->mesh, &g->geometry), "%s", read.path);
    if (!e) g->dim = polymesh_axes(g->mesh, g->axis);
    return e;
}

status gas_time_open(const struct setup *s, const struct dict *asked, const char *entry, const char *case_dir,
                     double time, struct gas_time *out) {
    *out = (struct gas_time){.asked = asked, .entry = entry};
    if (*case_dir == '/')
        snprintf(out->dir, sizeof out->dir, "%.4000s", case_dir);
    else
        snprintf(out->dir, sizeof out->dir, "%.2000s/%.2000s", s->dir, case_dir);
    if (access(out->dir, F_OK))
        return fail(ERR_INPUT, "%s: %s: there is no case %s", dict_path(asked), entry, out->dir);
    TRY(find_time(time, out));
    return read_mesh(out);
}

void gas_time_close(struct gas_time *g) {
    polymesh_free(g->mesh);
    polymesh_geometry_free(&g->geometry);
}

status gas_time_field(const struct gas_time *g, const char *name, int components, double **out) {
    char path[2 * TIME_PATH];
    int found;
    snprintf(path, sizeof path, "%s/%s/%s", g->dir, g->name, name);
    TRY(status_note(field_read_values(path, g->mesh->ncells, &found, out), "%s: %s", dict_path(g->asked), g->entry));
    return found == components
               ? OK
               : fail(ERR_INPUT, "%s: a %s field is expected", path, components == 1 ? "scalar" : "vector");
}

/* Says which cells lie outside the other mesh: `missing` in this rank's slab, of which this rank's first is cell
 * `first`. The message is the same on all ranks. */
static status check_covered(const struct gas_time *g, const struct segregation_places *p, long missing, double first,
                            long place) {
    double least = first, x[3];
    comm_sum_long(p->share.comm, &missing, 1);
    comm_min(p->share.comm, &least, 1);
    if (!missing) return OK;
    status e = OK;
    if (least == first) {
        segregation_places_centre(p, place, x);
        e = fail(ERR_INPUT,
                 "%s: %s: the mesh of case %s does not cover this one: %ld of %ld cells lie outside, the first is cell "
                 "%.0f at (%g %g %g)",
                 dict_path(g->asked), g->entry, g->dir, missing, p->share.n, first, x[0], x[1], x[2]);
    }
    return comm_agree(p->share.comm, e);
}

status gas_time_cells(const struct gas_time *g, const struct segregation_places *p, int **out) {
    struct search *search = NULL;
    long missing = 0, place = 0;
    double x[3], first = HUGE_VAL;
    status e = allocate(out, p->n, sizeof **out, "the cells of another case");
    if (!e) e = search_make(g->mesh, g->geometry.cell_centre, g->dim, g->axis, &search);
    TRY(comm_agree(p->share.comm, e));
    for (long i = 0; i < p->n; i++) {
        (*out)[i] = -1;
        if (p->cell[i] < 0) continue;
        segregation_places_centre(p, i, x);
        (*out)[i] = search_cell(search, x);
        if ((*out)[i] >= 0 || i < p->own_first || i >= p->own_first + p->nown) continue;
        missing++;
        if (p->cell[i] >= first) continue;
        first = p->cell[i];
        place = i;
    }
    search_free(search);
    return check_covered(g, p, missing, first, place);
}

/* ---- columns ---- */

static int by_place(const void *a, const void *b) {
    const struct segregation_column *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

static int merge(int n, struct segregation_column *c) {
    qsort(c, (size_t)n, sizeof *c, by_place);
    const double close = 1e-6 * (c[n - 1].at - c[0].at);
    int last = 0;
    for (int i = 1; i < n; i++)
        if (c[i].at - c[last].at > close) {
            c[++last] = c[i];
        } else {
            for (int k = 0; k < 3; k++) c[last].value[k] += c[i].value[k];
            c[last].weight += c[i].weight;
        }
    for (int i = 0; i <= last; i++)
        for (int k = 0; k < 3; k++) c[i].value[k] /= c[i].weight;
    return last + 1;
}

status gas_time_columns(const struct gas_time *g, int axis, int components, const double *values, int *n,
                        struct segregation_column **out) {
    const int cells = g->mesh->ncells;
    TRY(allocate(out, cells, sizeof **out, "columns"));
    for (int i = 0; i < cells; i++) {
        (*out)[i] =
            (struct segregation_column){.at = g->geometry.cell_centre[3L * i + axis], .weight = g->geometry.volume[i]};
        for (int k = 0; k < components; k++)
            (*out)[i].value[k] = g->geometry.volume[i] * values[(long)components * i + k];
    }
    *n = merge(cells, *out);
    if (*n >= 3) return OK;
    return fail(ERR_INPUT, "%s: %s: case %s has %d cells along %c; 3 are needed for a slope", dict_path(g->asked),
                g->entry, g->dir, *n, "xyz"[axis]);
}

double column_value(int n, const struct segregation_column *c, int component, double at) {
    int k = 0;
    while (k < n - 2 && at > c[k + 1].at) k++;
    const double part = fmin(fmax((at - c[k].at) / (c[k + 1].at - c[k].at), 0), 1);
    return c[k].value[component] + part * (c[k + 1].value[component] - c[k].value[component]);
}

double column_slope(int n, const struct segregation_column *c, double y) {
    int k = 0;
    while (k < n - 2 && y > 0.5 * (c[k + 1].at + c[k + 2].at)) k++;
    const double here = (c[k + 1].value[0] - c[k].value[0]) / (c[k + 1].at - c[k].at),
                 at = 0.5 * (c[k].at + c[k + 1].at);
    if (y <= at || k == n - 2) return here;
    const double next = (c[k + 2].value[0] - c[k + 1].value[0]) / (c[k + 2].at - c[k + 1].at);
    return here + (next - here) * (y - at) / (0.5 * (c[k + 1].at + c[k + 2].at) - at);
}

/* ---- gradients ---- */

/* Adds a pair of cells d apart: the sums of d d / |d|^3 and d (q' - q) / |d|^3 of both. */
static void add_pair(double *room, double *out, int dim, const int axis[3], const double d[3], int a, int b,
                     double jump) {
    double square = 0;
    for (int k = 0; k < dim; k++) square += d[axis[k]] * d[axis[k]];
    const double weight = 1 / (square * sqrt(square));
    for (int side = 0; side < 2; side++) {
        double *sums = room + 6L * (side ? b : a), *right = out + 3L * (side ? b : a);
        for (int i = 0, at = 0; i < dim; i++) {
            right[i] += weight * d[axis[i]] * jump;
            for (int j = i; j < dim; j++) sums[at++] += weight * d[axis[i]] * d[axis[j]];
        }
    }
}

/* Solves the symmetric system of a cell, whose upper triangle is sums[] by rows; an axis without neighbours gets 0. */
static void solve_cell(int dim, const int axis[3], const double *sums, double *out) {
    double a[3][3], x[3] = {0}, right[3] = {out[0], out[1], out[2]};
    for (int i = 0, at = 0; i < dim; i++)
        for (int j = i; j < dim; j++) a[i][j] = a[j][i] = sums[at++];
    double whole = 0;
    for (int i = 0; i < dim; i++) whole += a[i][i];
    for (int i = 0; i < dim; i++)
        for (int j = i + 1; j < dim; j++) {
            const double factor = a[i][i] > 1e-9 * whole ? a[j][i] / a[i][i] : 0;
            for (int k = i; k < dim; k++) a[j][k] -= factor * a[i][k];
            right[j] -= factor * right[i];
        }
    for (int i = dim - 1; i >= 0; i--) {
        for (int j = i + 1; j < dim; j++) right[i] -= a[i][j] * x[j];
        x[i] = a[i][i] > 1e-9 * whole ? right[i] / a[i][i] : 0;
    }
    for (int k = 0; k < 3; k++) out[k] = 0;
    for (int i = 0; i < dim; i++) out[axis[i]] = x[i];
}

void cell_gradients(const struct cell_centres *at, int stride, const double *q, double *out, double *room) {
    const struct polymesh *m = at->mesh;
    const double *centre = at->centre, *face_centre = at->face_centre;
    const int dim = at->dim, *axis = at->axis;
    double d[3];
    memset(out, 0, 3 * (size_t)m->ncells * sizeof *out);
    memset(room, 0, 6 * (size_t)m->ncells * sizeof *room);
    for (int f = 0; f < m->ninternal; f++) {
        const int a = m->owner[f], b = m->neighbour[f];
        for (int k = 0; k < 3; k++) d[k] = centre[3L * b + k] - centre[3L * a + k];
        add_pair(room, out, dim, axis, d, a, b, q[(long)stride * b] - q[(long)stride * a]);
    }
    for (int p = 0; p < m->npatches; p++) {
        const int half = m->patch[p].neighbour ? polymesh_find_patch(m, m->patch[p].neighbour) : -1;
        for (int i = 0; i < m->patch[p].nfaces && half > p; i++) {
            const int f = m->patch[p].start + i, g = m->patch[half].start + i, a = m->owner[f], b = m->owner[g];
            for (int k = 0; k < 3; k++)
                d[k] = centre[3L * b + k] - face_centre[3L * g + k] - (centre[3L * a + k] - face_centre[3L * f + k]);
            add_pair(room, out, dim, axis, d, a, b, q[(long)stride * b] - q[(long)stride * a]);
        }
    }
    for (int c = 0; c < m->ncells; c++) solve_cell(dim, axis, room + 6L * c, out + 3L * c);
}
