/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes starts of hard grains by random sequential addition, growth, Maxwellian velocities; packing.h cites the method.
 *
 * Addition refuses a place more often where it is dense, which would empty dense regions. So cells of (nearly) equal
 * alpha make a level; a level gets its share of the grains, and a grain whose place is refused tries another place in
 * the same level. A uniform field is one level: plain random sequential addition. */
#include "libcore/grains/packing.h"

#include "libcore/grains/random.h"
#include "libcore/models/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846

static const double SLACK = 1e-9;                /* share of the diameter: rounding then leaves no overlap */
enum { PLACES = 1, GROWTH = 2, VELOCITIES = 3 }; /* streams of random numbers */

static double volume_of(int dim, double diameter) {
    return dim == 2 ? PI / 4 * diameter * diameter : PI / 6 * diameter * diameter * diameter;
}

/* Volume of the mean grain over that of the law's. */
static double mean_size(const struct grain_kinds *k, int dim) {
    return k ? grains_mean_size(k, dim) : 1;
}

static int kind_of(const struct grain_kinds *all, int number) {
    int k = 0;
    while (k < all->n - 1 && number >= all->first[k + 1]) k++;
    return k;
}
static double size_of(const struct grain_kinds *all, int number) {
    return all ? all->size[kind_of(all, number)] : 1;
}

static long field_cells(const struct packing_field *f) {
    return f->mesh ? f->mesh->cells : (long)f->n[0] * f->n[1] * f->n[2];
}

double packing_number(const struct grain_box *box, double diameter, const struct packing_field *f) {
    long cells = field_cells(f);
    double sum = 0;
    if (!f->alpha) return 0;
    for (long c = 0; c < cells; c++) sum += f->alpha[c] * (f->mesh ? f->mesh->volume[c] : 1);
    const double filled = f->mesh ? sum : sum / (double)cells * grains_volume(box);
    return floor(filled / (volume_of(box->dim, diameter) * mean_size(f->kinds, box->dim)) + 0.5);
}

/* ---- levels: cells of equal alpha */

struct cell {
    double alpha;
    double room; /* share of the cell that centres of grains can reach; on a mesh its size, as share of the mean */
    long index;
};
struct packing_level {
    long first, end;    /* cell[first .. end) */
    double share, room; /* sums of alpha and of room */
};
struct levels {
    const struct grain_box *box;
    const struct packing_field *field;
    struct packing_field whole; /* one cell, where no alpha is given */
    long cells, count;
    struct cell *cell;           /* [cells], falling alpha */
    double *reach;               /* [cells]: running sum of alpha * room within a level */
    struct packing_level *level; /* [count], each has room for a centre */
    double radius, total;
};

static void levels_free(struct levels *l) {
    free(l->cell);
    free(l->reach);
    free(l->level);
}

static int denser_first(const void *a, const void *b) {
    const struct cell *p = a, *q = b;
    if (p->alpha != q->alpha) return p->alpha > q->alpha ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

/* Finds the part of a cell along axis k that centres can reach, [*from, *to]; returns its length as a share of the
 * cell's. */
static double cell_reach(const struct levels *l, long index, int k, double *from, double *to) {
    const struct grain_box *b = l->box;
    const int *n = l->field->n;
    long place = k == 0 ? index % n[0] : k == 1 ? index / n[0] % n[1] : index / n[0] / n[1];
    double h = (b->high[k] - b->low[k]) / n[k], edge = b->periodic[k] ? 0 : l->radius;
    *from = fmax(b->low[k] + (double)place * h, b->low[k] + edge);
    *to = fmin(b->low[k] + (double)(place + 1) * h, b->high[k] - edge);
    return fmax(*to - *from, 0) / h;
}

/* Groups cells whose alpha is within 2 % into one level; a level without room between the walls is joined to the
 * next. */
static void levels_group(struct levels *l) {
    for (long c = 0; c < l->cells;) {
        struct packing_level v = {.first = c};
        double top = l->cell[c].alpha;
        for (; c < l->cells && (v.room == 0 || l->cell[c].alpha >= 0.98 * top); c++) {
            v.share += l->cell[c].alpha * (l->field->mesh ? l->cell[c].room : 1);
            v.room += l->cell[c].room;
            l->reach[c] = (c > v.first ? l->reach[c - 1] : 0) + l->cell[c].alpha * l->cell[c].room;
        }
        v.end = c;
        l->total += v.share;
        if (v.room == 0 && l->count > 0)
            l->level[l->count - 1].share += v.share;
        else
            l->level[l->count++] = v;
    }
}

static status levels_make(const struct grain_box *box, double diameter, const struct packing_field *f,
                          struct levels *l) {
    long all = f->alpha || f->mesh ? field_cells(f) : 1;
    *l = (struct levels){.box = box, .field = f, .radius = diameter / 2};
    if (!f->alpha && !f->mesh) {
        l->whole = (struct packing_field){.n = {1, 1, 1}, .kinds = f->kinds};
        l->field = &l->whole;
    }
    TRY(allocate(&l->cell, all, sizeof *l->cell, "cells of a packing"));
    TRY(allocate(&l->reach, all, sizeof *l->reach, "cells of a packing"));
    TRY(allocate(&l->level, all, sizeof *l->level, "cells of a packing"));
    for (long c = 0; c < all; c++) {
        struct cell *cell = &l->cell[l->cells];
        *cell = (struct cell){.alpha = f->alpha ? f->alpha[c] : 1, .room = 1, .index = c};
        double from, to;
        for (int k = 0; k < box->dim && !f->mesh; k++) cell->room *= cell_reach(l, c, k, &from, &to);
        if (f->mesh) cell->room = f->mesh->volume[c] * (double)all / grains_volume(box);
        if (cell->alpha > 0) l->cells++;
    }
    qsort(l->cell, (size_t)l->cells, sizeof *l->cell, denser_first);
    levels_group(l);
    if (l->count == 0 || l->level[0].room == 0)
        return fail(ERR_INPUT,
                    "no room for grains: the packing fraction is 0 in all cells that their centres can reach");
    return OK;
}

/* Returns the highest packing fraction that a level will have, counted on the room there is. */
static double levels_densest(const struct levels *l, int n, double diameter) {
    double cell = grains_volume(l->box) / (double)field_cells(l->field), most = 0;
    for (long v = 0; v < l->count; v++) most = fmax(most, l->level[v].share / l->level[v].room);
    return most / l->total * n * volume_of(l->box->dim, diameter) * mean_size(l->field->kinds, l->box->dim) / cell;
}

/* Deals grain `number` to a level, by multiples of the golden ratio: for every n each level has its share of the first
 * n grains, to within a few. */
static const struct packing_level *levels_deal(const struct levels *l, double start, int number) {
    double p = start + number * 0.6180339887498949, sum = 0;
    p = (p - floor(p)) * l->total;
    long v = 0;
    while (v < l->count - 1 && (sum += l->level[v].share) <= p) v++;
    return &l->level[v];
}

/* Draws a place in a cell of a mesh. */
static void draw_in_cell(const struct levels *l, long cell, struct random *r, double x[3]) {
    const struct grain_mesh *m = l->field->mesh;
    const double *low = m->bounds[cell], *high = low + 3;
    bool inside;
    for (int tries = 0; tries < 1000; tries++) {
        for (int k = 0; k < l->box->dim; k++) x[k] = low[k] + random_uniform(r) * (high[k] - low[k]);
        if (m->locate(m, x, &inside) == cell && inside) return;
    }
}

static void levels_draw(const struct levels *l, const struct packing_level *v, struct random *r, double x[3]) {
    double p = random_uniform(r) * l->reach[v->end - 1];
    long low = v->first, high = v->end - 1;
    while (low < high) {
        long middle = (low + high) / 2;
        if (l->reach[middle] > p)
            high = middle;
        else
            low = middle + 1;
    }
    x[2] = 0;
    if (l->field->mesh) {
        draw_in_cell(l, l->cell[low].index, r, x);
        return;
    }
    for (int k = 0; k < l->box->dim; k++) {
        double from, to;
        cell_reach(l, l->cell[low].index, k, &from, &to);
        x[k] = fmin(from + random_uniform(r) * (to - from), to);
    }
}

/* ---- addition */

struct shelf { /* grains by cells of at least one diameter */
    const struct grain_box *box;
    int n[3];
    double size[3], length[3], diameter;
    int32_t *head, *next; /* -1: none */
    double (*x)[3];
    struct facet_cells walls; /* the facets near each cell */
    double radius;            /* m: the least distance of centres to them */
    const struct grain_kinds *kinds;
};

static void shelf_free(struct shelf *s) {
    facet_cells_free(&s->walls);
    free(s->head);
    free(s->next);
}

static status shelf_make(const struct levels *l, double diameter, int n, double (*x)[3], struct shelf *s) {
    const struct grain_box *box = l->box;
    *s = (struct shelf){
        .box = box, .n = {1, 1, 1}, .diameter = diameter, .x = x, .radius = l->radius, .kinds = l->field->kinds};
    double side = fmax(diameter * (1 + 1e-9), power(grains_volume(box) / (4. * n), 1. / box->dim));
    for (int k = 0; k < box->dim; k++) {
        s->length[k] = box->high[k] - box->low[k];
        s->n[k] = (int)fmax(1, fmin(floor(s->length[k] / side), 1e6));
        s->size[k] = s->length[k] / s->n[k];
    }
    long cells = (long)s->n[0] * s->n[1] * s->n[2];
    TRY(allocate(&s->head, cells, sizeof *s->head, "cells of a packing"));
    TRY(allocate(&s->next, n, sizeof *s->next, "cells of a packing"));
    memset(s->head, -1, (size_t)cells * sizeof *s->head);
    if (!box->facets) return OK;
    for (int k = 0; k < 3; k++) {
        s->walls.n[k] = s->n[k];
        s->walls.low[k] = box->low[k];
        s->walls.width[k] = k < box->dim ? s->size[k] : 1;
    }
    return facet_cells_make(box->facets, s->radius, (const double[3]){0}, &s->walls);
}

static void shelf_find(const struct shelf *s, const double x[3], int at[3]) {
    for (int k = 0; k < 3; k++) {
        at[k] = k < s->box->dim ? (int)((x[k] - s->box->low[k]) / s->size[k]) : 0;
        if (at[k] >= s->n[k]) at[k] = s->n[k] - 1;
    }
}

static long shelf_cell(const struct shelf *s, const int at[3]) {
    return at[0] + (long)s->n[0] * (at[1] + (long)s->n[1] * at[2]);
}

/* Would grain `number` at a touch one at b of a size? */
static bool shelf_touches(const struct shelf *s, const double a[3], const double b[3], int number, int other) {
    const double d = s->diameter * 0.5 * (size_of(s->kinds, number) + size_of(s->kinds, other));
    double r2 = 0;
    for (int k = 0; k < s->box->dim; k++) {
        double r = fabs(a[k] - b[k]);
        if (s->box->periodic[k]) r = fmin(r, s->length[k] - r);
        r2 += r * r;
    }
    return r2 < d * d;
}

static bool shelf_has_room(const struct shelf *s, const double x[3], int number) {
    int at[3], near[3], many = s->box->dim == 2 ? 9 : 27;
    if (s->box->facets && facet_cells_nearest(s->box->facets, &s->walls, x, true) < s->radius) return false;
    shelf_find(s, x, at);
    for (int i = 0; i < many; i++) {
        int step[3] = {i % 3 - 1, i / 3 % 3 - 1, s->box->dim == 2 ? 0 : i / 9 - 1};
        bool outside = false;
        for (int k = 0; k < 3; k++) {
            near[k] = at[k] + step[k];
            outside = outside || (k < s->box->dim && !s->box->periodic[k] && (near[k] < 0 || near[k] >= s->n[k]));
            near[k] = (near[k] + s->n[k]) % s->n[k];
        }
        if (outside) continue;
        for (int32_t g = s->head[shelf_cell(s, near)]; g >= 0; g = s->next[g])
            if (shelf_touches(s, x, s->x[g], number, g)) return false;
    }
    return true;
}

static void shelf_put(struct shelf *s, int number) {
    int at[3];
    shelf_find(s, s->x[number], at);
    int32_t *head = &s->head[shelf_cell(s, at)];
    s->next[number] = *head;
    *head = number;
}

/* Adds all n grains, or *added < n if one found no place in TRIES tries. */
static status add(const struct levels *l, double diameter, int n, struct random *r, double (*x)[3], int *added) {
    enum { TRIES = 20000 };
    struct shelf s;
    status result = shelf_make(l, diameter, n, x, &s);
    double start = random_uniform(r);
    for (*added = 0; !result && *added < n; ++*added) {
        const struct packing_level *v = levels_deal(l, start, *added);
        int tries = 0;
        do levels_draw(l, v, r, x[*added]);
        while (!shelf_has_room(&s, x[*added], *added) && ++tries < TRIES);
        if (tries == TRIES) break;
        shelf_put(&s, *added);
    }
    shelf_free(&s);
    return result;
}

/* ---- growth */

struct growing {
    struct grain_box box;  /* the box at rest with elastic walls */
    double diameter, full; /* m */
    double rate;           /* growth of the diameter, in units of the thermal velocity sqrt(T) = full / s */
    int n;
    double (*x)[3], (*u)[3];
    int64_t impacts;
    struct grain_kinds kinds; /* elastic */
};

static double packing_of(const struct growing *w) {
    return w->n * volume_of(w->box.dim, w->diameter) * grains_mean_size(&w->kinds, w->box.dim) / grains_volume(&w->box);
}

/* Sets T back to full^2, because growth heats the grains, and the centre of mass to rest. */
static void rescale(struct growing *w) {
    double mean[3] = {0}, sum = 0;
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k < w->box.dim; k++) mean[k] += w->u[i][k] / w->n;
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k < w->box.dim; k++) {
            w->u[i][k] -= w->n > 1 ? mean[k] : 0;
            sum += w->u[i][k] * w->u[i][k];
        }
    double scale = sum > 0 ? w->full * sqrt((double)w->n * w->box.dim / sum) : 1;
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k < w->box.dim; k++) w->u[i][k] *= scale;
}

/* Grows the grains by up to 5 % of the diameter; by less where the impacts are too many, which is how jamming shows. */
static status grow_piece(struct growing *w) {
    struct grain_law law = {
        .diameter = w->diameter, .growth = w->rate * w->full, .mass = 1, .restitution = 1, .kinds = w->kinds};
    double end = fmin(w->full, 1.05 * w->diameter), until = (end - w->diameter) / law.growth;
    struct grains *g = NULL;
    TRY(grains_make(&w->box, &law, w->n, (const double(*)[3])w->x, (const double(*)[3])w->u, 0, &g));
    double t = grains_advance(g, until, (int64_t)(w->n * (30 / w->rate + 100)), NULL);
    grains_at(g, t, w->x, w->u);
    w->impacts += grains_counted(g)->pairs + grains_counted(g)->walls;
    grains_free(g);
    w->diameter = t >= until ? end : w->diameter + law.growth * t;
    return OK;
}

/* Grows the grains to their full size: fast at first, so that dense regions have no time to spread; near jamming more
 * slowly, or the grains jam early. */
static status grow(struct growing *w) {
    static const double rates[] = {3, 0.1, 0.03};
    double wanted =
        w->n * volume_of(w->box.dim, w->full) * grains_mean_size(&w->kinds, w->box.dim) / grains_volume(&w->box);
    for (int k = 0; w->diameter < w->full;) {
        double before = w->diameter;
        if (k == 0 && packing_of(w) > (w->box.dim == 2 ? 0.7 : 0.5)) k = 1;
        w->rate = rates[k];
        rescale(w);
        TRY(grow_piece(w));
        if (w->diameter < w->full && w->diameter < 1.002 * before && ++k == 3)
            return fail(ERR_INPUT,
                        "the grains jam at a packing fraction of %.3f, before the %.3f that %d of them need; disks can "
                        "be brought to about 0.84, spheres to about 0.62; take fewer or smaller grains or a larger box",
                        packing_of(w), wanted, w->n);
    }
    return OK;
}

static status grow_from(const struct levels *l, double small, double full, int n, uint64_t seed, double (*x)[3],
                        struct packing_report *report) {
    const struct grain_box *box = l->box;
    struct growing w = {.box = *box, .diameter = small, .full = full, .n = n, .x = x};
    if (l->field->kinds) w.kinds = *l->field->kinds;
    for (int a = 0; a < w.kinds.n; a++) /* grains of one mass, which all move at the same speed */
        for (int b = 0; b < w.kinds.n; b++) w.kinds.mass[a] = w.kinds.restitution[a][b] = 1;
    w.box.wall_restitution = NULL;
    w.box.shear = 0;
    w.box.shut = true;
    w.box.rough = NULL;
    for (int k = 0; k < 3; k++) {
        w.box.restitution[k][0] = w.box.restitution[k][1] = 1;
        w.box.shake[k] = 0;
    }
    struct random r = random_make(seed, GROWTH);
    TRY(allocate(&w.u, n, sizeof *w.u, "velocities of a packing"));
    for (int i = 0; i < n; i++)
        for (int k = 0; k < box->dim; k++) w.u[i][k] = random_normal(&r);
    status result = grow(&w);
    report->impacts = w.impacts;
    free(w.u);
    return result;
}

/* ---- */

static status check_room(const struct grain_box *box, double diameter, const struct grain_kinds *kinds, int n) {
    bool disks = box->dim == 2;
    double packing = n * volume_of(box->dim, diameter) * mean_size(kinds, box->dim) / grains_volume(box);
    const double most = kinds ? 1 : disks ? 0.9069 : 0.7405;
    for (int k = 0; k < box->dim; k++) {
        double length = box->high[k] - box->low[k], least = diameter * (box->periodic[k] ? 3 : 1);
        if (!(length > least * (1 + 2 * SLACK)))
            return fail(ERR_INPUT, "the box is %g m long along axis %d, which %s; grains of %g m need more than %g m",
                        length, k, box->periodic[k] ? "is periodic" : "has walls", diameter, least);
    }
    if (packing > most)
        return fail(ERR_INPUT,
                    "%d %s of diameter %g m cannot fit: a packing fraction of %.4f in this box, where close packing is "
                    "%.4f; take fewer or smaller grains or a larger box",
                    n, disks ? "disks" : "spheres", diameter, packing, most);
    return OK;
}

/* Adds the grains as large as is easy, to 0.45 for disks and 0.28 for spheres (addition ends at 0.547 and 0.384), then
 * grows them. */
static status place(const struct levels *l, double diameter, int n, uint64_t seed, double (*x)[3],
                    struct packing_report *report) {
    int dim = l->box->dim, added = 0;
    struct random r = random_make(seed, PLACES);
    double full = diameter * (1 + SLACK);
    double share = fmin(1, power((dim == 2 ? 0.45 : 0.28) / levels_densest(l, n, full), 1. / dim));
    for (;; share *= 0.95) {
        TRY(add(l, share * full, n, &r, x, &added));
        if (added == n) break;
    }
    report->added = share;
    return share < 1 ? grow_from(l, share * full, full, n, seed, x, report) : OK;
}

status packing_places(const struct grain_box *box, double diameter, const struct packing_field *f, int n, uint64_t seed,
                      double (*x)[3], struct packing_report *report) {
    clock_t start = clock();
    struct levels l;
    *report = (struct packing_report){.added = 1};
    if (n == 0) return OK;
    TRY(check_room(box, diameter, f->kinds, n));
    status result = levels_make(box, diameter * (1 + SLACK), f, &l);
    if (!result) result = place(&l, diameter, n, seed, x, report);
    levels_free(&l);
    report->seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    return result;
}

/* ---- velocities */

static long cell_of(const struct grain_box *box, const struct packing_field *f, const double x[3]) {
    long index = 0;
    bool inside;
    if (f->mesh) return f->mesh->locate(f->mesh, x, &inside);
    for (int k = box->dim - 1; k >= 0; k--) {
        int at = (int)floor((x[k] - box->low[k]) / (box->high[k] - box->low[k]) * f->n[k]);
        at = at < 0 ? 0 : at >= f->n[k] ? f->n[k] - 1 : at;
        index = index * f->n[k] + at;
    }
    return index;
}

/* Mass of a grain over the mean mass. */
static double mass_of(const struct grain_kinds *all, int number) {
    double sum = 0;
    if (!all) return 1;
    for (int k = 0; k < all->n; k++) sum += (all->first[k + 1] - all->first[k]) * all->mass[k];
    return all->mass[kind_of(all, number)] * all->first[all->n] / sum;
}

/* Draws peculiar velocities c = sqrt(T/m) (normal - mean), so that the sum of m c is 0, and scales them by the factor
 * that solves sum m |u + factor c|^2 = sum m |u|^2 + dim T; m = 1 where all are alike. */
void packing_velocities(const struct grain_box *box, const struct packing_field *f, int n, uint64_t seed,
                        const double (*x)[3], double (*u)[3]) {
    struct random r = random_make(seed, VELOCITIES);
    double sum[3] = {0}, width = 0, mixed = 0, square = 0, wanted = 0;
    for (int i = 0; i < n; i++) {
        const double m = mass_of(f->kinds, i);
        double s = f->T ? sqrt(f->T[cell_of(box, f, x[i])] / m) : 0;
        width += m * s;
        for (int k = 0; k < 3; k++) sum[k] += m * (u[i][k] = k < box->dim ? s * random_normal(&r) : 0);
    }
    for (int i = 0; i < n && width > 0; i++) {
        const double m = mass_of(f->kinds, i);
        long cell = cell_of(box, f, x[i]);
        double s = f->T ? sqrt(f->T[cell] / m) : 0;
        for (int k = 0; k < box->dim; k++) {
            u[i][k] -= sum[k] * s / width;
            mixed += m * (u[i][k] * (f->u[k] ? f->u[k][cell] : 0));
            square += m * (u[i][k] * u[i][k]);
        }
        wanted += m * (box->dim * s * s);
    }
    double factor = square > 0 ? (sqrt(mixed * mixed + square * wanted) - mixed) / square : 0;
    for (int i = 0; i < n; i++) {
        long cell = cell_of(box, f, x[i]);
        for (int k = 0; k < box->dim; k++) u[i][k] = factor * u[i][k] + (f->u[k] ? f->u[k][cell] : 0);
    }
}
