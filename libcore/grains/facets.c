/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes and checks facets, finds their distance to a point, and lists those near cells (facets.h). */
#include "libcore/grains/facets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}
static void between(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = b[k] - a[k];
}
static bool make_unit(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++) v[k] /= length;
    return length > 0 && length < HUGE_VAL;
}

/* ---- one facet */

double facet_distance(const struct facet *f, int dim, const double x[3], double normal[3]) {
    double best = HUGE_VAL, r[3], from[3];
    for (int j = 0; j < dim; j++) {
        between(f->corner[j], x, r);
        if (!(dot(r, f->out[j]) > 0)) continue;
        if (dim == 3) { /* the nearest point of that side */
            double side[3], along;
            between(f->corner[j], f->corner[(j + 1) % 3], side);
            along = fmin(fmax(dot(r, side) / dot(side, side), 0), 1);
            for (int k = 0; k < 3; k++) r[k] -= along * side[k];
        }
        double square = dot(r, r);
        if (square >= best) continue;
        best = square;
        memcpy(from, r, sizeof from);
    }
    if (best < HUGE_VAL) {
        double distance = sqrt(best);
        for (int k = 0; k < 3; k++) normal[k] = distance > 0 ? from[k] / distance : f->normal[k];
        return distance;
    }
    between(f->corner[0], x, r);
    double height = dot(r, f->normal);
    for (int k = 0; k < 3; k++) normal[k] = height < 0 ? -f->normal[k] : f->normal[k];
    return fabs(height);
}

/* Sets normals and bounds of a facet; returns whether it has an area. */
static bool complete(struct facet *f, int dim) {
    double side[3][3], area[3];
    for (int j = 0; j < dim; j++) between(f->corner[j], f->corner[(j + 1) % dim], side[j]);
    for (int k = 0; k < 3; k++) {
        f->low[k] = f->high[k] = f->corner[0][k];
        for (int j = 1; j < dim; j++) {
            f->low[k] = fmin(f->low[k], f->corner[j][k]);
            f->high[k] = fmax(f->high[k], f->corner[j][k]);
        }
    }
    if (dim == 2) {
        const double left[3] = {-side[0][1], side[0][0], 0};
        memcpy(f->normal, left, sizeof left);
        memcpy(f->out[0], side[1], sizeof side[1]);
        memcpy(f->out[1], side[0], sizeof side[0]);
        return make_unit(f->normal) && make_unit(f->out[0]) && make_unit(f->out[1]);
    }
    cross(side[0], side[1], area);
    for (int k = 0; k < 3; k++) f->normal[k] = -area[k];
    bool good = make_unit(f->normal);
    for (int j = 0; j < 3 && good; j++) {
        cross(f->normal, side[j], f->out[j]);
        good = make_unit(f->out[j]);
    }
    return good;
}

/* ---- gaps */

struct rim { /* a side of a facet between two corners (dim 2: one corner), the lower one first */
    double end[2][3];
    int turn; /* +1 or -1: which way the facet goes along it */
};

static int compare_points(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}
static int compare_rims(const void *a, const void *b) {
    const struct rim *p = a, *q = b;
    int first = compare_points(p->end[0], q->end[0]);
    return first ? first : compare_points(p->end[1], q->end[1]);
}

static struct rim rim_of(const struct facet *f, int dim, int j) {
    struct rim s = {.turn = 1};
    const double *a = f->corner[j], *b = dim == 2 ? a : f->corner[(j + 1) % 3];
    bool turned = compare_points(a, b) > 0;
    for (int k = 0; k < 3; k++) {
        s.end[0][k] = (turned ? b[k] : a[k]) + 0.0; /* no -0 */
        s.end[1][k] = (turned ? a[k] : b[k]) + 0.0;
    }
    s.turn = dim == 2 ? (j ? -1 : 1) : turned ? -1 : 1;
    return s;
}

static bool on_periodic_end(const struct facet_space *s, const struct rim *side) {
    for (int k = 0; k < s->dim; k++) {
        double slack = 1e-9 * (s->high[k] - s->low[k]);
        for (int high = 0; high < 2 && s->periodic[k]; high++) {
            double end = high ? s->high[k] : s->low[k];
            if (fabs(side->end[0][k] - end) <= slack && fabs(side->end[1][k] - end) <= slack) return true;
        }
    }
    return false;
}

static status check_gaps(const struct facets *f) {
    const int dim = f->space.dim, n = f->own * dim;
    struct rim *side;
    status e = OK;
    TRY(allocate(&side, n, sizeof *side, "sides of facets"));
    for (int i = 0; i < n; i++) side[i] = rim_of(&f->facet[i / dim], dim, i % dim);
    qsort(side, (size_t)n, sizeof *side, compare_rims);
    for (int i = 0; i < n && !e;) {
        const struct rim *first = &side[i];
        int turns = 0;
        for (; i < n && compare_rims(first, &side[i]) == 0; i++) turns += side[i].turn;
        const double *a = first->end[0], *b = first->end[1];
        if (turns != 0 && !on_periodic_end(&f->space, first))
            e = dim == 2
                    ? fail(ERR_INPUT, "the walls leave a gap: no facet goes on at the corner (%.9g %.9g)", a[0], a[1])
                    : fail(ERR_INPUT,
                           "the walls leave a gap: no facet goes on at the edge from (%.9g %.9g %.9g) to (%.9g "
                           "%.9g %.9g)",
                           a[0], a[1], a[2], b[0], b[1], b[2]);
    }
    free(side);
    return e;
}

/* ---- all facets */

static unsigned long checksum(const struct facets *f) { /* FNV-1a, of 32 bits */
    uint32_t sum = 2166136261u;
    for (int i = 0; i < f->own; i++) {
        unsigned char bytes[sizeof f->facet[i].corner + sizeof(int)];
        const int wall = f->facet[i].open ? -1 - f->facet[i].wall : f->facet[i].wall;
        memcpy(bytes, f->facet[i].corner, sizeof f->facet[i].corner);
        memcpy(bytes + sizeof f->facet[i].corner, &wall, sizeof(int));
        for (size_t k = 0; k < sizeof bytes; k++) sum = (sum ^ bytes[k]) * 16777619u;
    }
    return sum;
}

/* Adds the image of facet i, shifted by `by` periods along each axis, if a grain in the box can touch it. */
static bool image_of(const struct facets *f, int i, const int by[3], struct facet *out) {
    const struct facet_space *s = &f->space;
    bool shifted = false;
    *out = f->facet[i];
    for (int k = 0; k < s->dim; k++) {
        double move = by[k] * (s->high[k] - s->low[k]), reach = s->reach * (1 + 1e-6);
        if (by[k] != 0 && !s->periodic[k]) return false;
        shifted = shifted || by[k] != 0;
        for (int j = 0; j < s->dim; j++) out->corner[j][k] += move;
        out->low[k] += move;
        out->high[k] += move;
        if (out->low[k] > s->high[k] + reach || out->high[k] < s->low[k] - reach) return false;
    }
    return shifted;
}

/* Counts the images, or, if list is not NULL, writes them there. */
static int images(const struct facets *f, struct facet *list) {
    int count = 0;
    for (int i = 0; i < f->own; i++)
        for (int q = 0; q < 27; q++) {
            const int by[3] = {q % 3 - 1, q / 3 % 3 - 1, q / 9 - 1};
            struct facet image;
            if ((f->space.dim == 2 && by[2] != 0) || !image_of(f, i, by, &image)) continue;
            if (list) list[count] = image;
            count++;
        }
    return count;
}

static status check_facet(const struct facet_space *s, const struct facet *f, int i) {
    if (f->wall < 0 || f->wall >= s->walls) return fail(ERR_INPUT, "facet %d has no wall", i);
    for (int k = 0; k < s->dim; k++) {
        double slack = 1e-9 * (s->high[k] - s->low[k]);
        if (!(f->low[k] >= s->low[k] - slack && f->high[k] <= s->high[k] + slack))
            return fail(ERR_INPUT, "facet %d at (%.9g %.9g %.9g) lies beyond the box around the walls", i,
                        f->corner[0][0], f->corner[0][1], f->corner[0][2]);
    }
    return OK;
}

static status fill(struct facets *f, const struct facet *list) {
    const struct facet_space *s = &f->space;
    struct facet *all;
    TRY(allocate(&f->facet, f->own, sizeof *f->facet, "facets"));
    for (int i = 0; i < f->own; i++) {
        struct facet *p = &f->facet[i];
        *p = list[i];
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) p->corner[j][k] = k < s->dim && j < s->dim ? p->corner[j][k] : 0;
        if (!complete(p, s->dim))
            return fail(ERR_INPUT, "facet %d at (%.9g %.9g %.9g) has no area", i, p->corner[0][0], p->corner[0][1],
                        p->corner[0][2]);
        TRY(check_facet(s, p, i));
        f->opens = f->opens || p->open;
    }
    TRY(check_gaps(f));
    f->sum = checksum(f);
    f->n = f->own + images(f, NULL);
    TRY(allocate(&all, f->n, sizeof *all, "facets"));
    memcpy(all, f->facet, (size_t)f->own * sizeof *all);
    images(f, all + f->own);
    free(f->facet);
    f->facet = all;
    return OK;
}

status facets_make(const struct facet_space *space, int n, const struct facet *list, struct facets **out) {
    *out = NULL;
    if (n < 1) return fail(ERR_INPUT, "there are no walls");
    TRY(allocate(out, 1, sizeof **out, "facets"));
    (*out)->space = *space;
    (*out)->own = (*out)->n = n;
    status e = fill(*out, list);
    if (!e) return OK;
    facets_free(*out);
    *out = NULL;
    return e;
}

void facets_free(struct facets *f) {
    if (!f) return;
    free(f->facet);
    free(f);
}

/* ---- cells */

static int cell_along(const struct facet_cells *c, int k, double x) {
    return (int)fmax(0, fmin(floor((x - c->low[k]) / c->width[k]), c->n[k] - 1));
}
long facet_cells_at(const struct facet_cells *c, int dim, const double x[3]) {
    long cell = 0;
    for (int k = dim - 1; k >= 0; k--) cell = cell * c->n[k] + cell_along(c, k, x[k]);
    return cell;
}

/* Can a point of the cell at `at`, widened by the swing, have the plane of facet f within the radius? */
static bool plane_is_near(const struct facet *f, const struct facet_cells *c, const int at[3], int dim, double radius,
                          const double swing[3]) {
    double middle = 0, half = 0;
    for (int k = 0; k < dim; k++) {
        middle += f->normal[k] * (c->low[k] + (at[k] + 0.5) * c->width[k] - f->corner[0][k]);
        half += fabs(f->normal[k]) * (0.5 * c->width[k] * (1 + 1e-9) + swing[k]);
    }
    return fabs(middle) <= half + radius;
}

/* Counts the facets of the cells in next[] or, if `list` is not NULL, writes them where next[] points. */
static void list_facets(const struct facets *f, double radius, const double swing[3], const struct facet_cells *c,
                        int32_t *next, int32_t *list) {
    const int dim = f->space.dim;
    for (int i = 0; i < f->n; i++) {
        int from[3] = {0}, to[3] = {0}, at[3];
        for (int k = 0; k < dim; k++) {
            double reach = radius + swing[k] + 1e-9 * c->width[k];
            from[k] = cell_along(c, k, f->facet[i].low[k] - reach);
            to[k] = cell_along(c, k, f->facet[i].high[k] + reach);
        }
        for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
            for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
                for (at[0] = from[0]; at[0] <= to[0]; at[0]++) {
                    if (!plane_is_near(&f->facet[i], c, at, dim, radius, swing)) continue;
                    int32_t *entry = &next[at[0] + c->n[0] * (at[1] + (long)c->n[1] * at[2])];
                    if (list) list[*entry] = i;
                    ++*entry;
                }
    }
}

status facet_cells_make(const struct facets *f, double radius, const double swing[3], struct facet_cells *c) {
    const long cells = (long)c->n[0] * c->n[1] * c->n[2];
    radius *= 1 + 1e-9;
    TRY(allocate(&c->start, cells + 2, sizeof *c->start, "facets of cells"));
    list_facets(f, radius, swing, c, c->start + 2, NULL);
    for (long i = 1; i <= cells; i++) {
        if (c->start[i] > INT32_MAX - c->start[i + 1])
            return fail(ERR_INPUT, "the walls have too many facets for so small grains; take a coarser mesh");
        c->start[i + 1] += c->start[i];
    }
    TRY(allocate(&c->list, c->start[cells + 1], sizeof *c->list, "facets of cells"));
    list_facets(f, radius, swing, c, c->start + 1, c->list);
    return OK;
}

void facet_cells_free(struct facet_cells *c) {
    free(c->start);
    free(c->list);
    c->start = c->list = NULL;
}

double facet_cells_nearest(const struct facets *f, const struct facet_cells *c, const double x[3], bool shut) {
    const long cell = facet_cells_at(c, f->space.dim, x);
    double least = HUGE_VAL, normal[3];
    for (int32_t q = c->start[cell]; q < c->start[cell + 1]; q++) {
        const struct facet *p = &f->facet[c->list[q]];
        if (shut || !p->open) least = fmin(least, facet_distance(p, f->space.dim, x, normal));
    }
    return least;
}

/* Returns where the line through x along axis k crosses facet f; HUGE_VAL: it does not. */
static double crossing(const struct facet *f, int dim, int k, const double x[3]) {
    double r[3], at[3] = {x[0], x[1], x[2]};
    if (f->normal[k] == 0) return HUGE_VAL;
    between(f->corner[0], x, r);
    at[k] = x[k] - dot(r, f->normal) / f->normal[k];
    for (int j = 0; j < dim; j++) {
        between(f->corner[j], at, r);
        if (dot(r, f->out[j]) > 0) return HUGE_VAL;
    }
    return at[k];
}

/* Looks from x along axis k for the first facet: +1 if its front is seen, -1 if its back is, 0 if there is none. */
static int look(const struct facets *f, const struct facet_cells *c, int k, const double x[3]) {
    double at[3] = {x[0], x[1], x[2]};
    for (int q = cell_along(c, k, x[k]); q < c->n[k]; q++) {
        double first = HUGE_VAL;
        int seen = 0;
        at[k] = c->low[k] + (q + 0.5) * c->width[k];
        const long cell = facet_cells_at(c, f->space.dim, at);
        for (int32_t i = c->start[cell]; i < c->start[cell + 1]; i++) {
            const struct facet *p = &f->facet[c->list[i]];
            double where = crossing(p, f->space.dim, k, x);
            if (!(where >= x[k] && where < first) || cell_along(c, k, where) != q) continue;
            first = where;
            seen = p->normal[k] < 0 ? 1 : -1;
        }
        if (seen) return seen;
    }
    return 0;
}

/* The whole ball of radius `free` is on one side of all facets, so a point of it is as good as its centre: one from
 * which no line along an axis meets corners that lie on a lattice with x. */
bool facet_cells_inside(const struct facets *f, const struct facet_cells *c, const double x[3], double free) {
    const double aside[3] = {0.1271 * free, 0.2113 * free, 0.1789 * free};
    double from[3] = {0};
    for (int k = 0; k < f->space.dim; k++) from[k] = x[k] + aside[k];
    for (int k = 0; k < f->space.dim; k++) {
        int seen = look(f, c, k, from);
        if (seen || !f->space.periodic[k]) return seen > 0;
    }
    return true; /* periodic, and there is no wall along any axis */
}
