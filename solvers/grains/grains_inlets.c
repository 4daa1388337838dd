/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the grains that come in at inlets (grains_inlets.h; docs/physics.md 10.6). */
#include "solvers/grains/grains_inlets.h"

#include "libcore/models/boundary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
enum { TRIES = 1000, STREAM = 3 };
static const double INSIDE = 1e-6; /* radii of a grain: so far from the patch it begins */
static const double FASTEST =
    9; /* deviations: impacts of greater relative speed are as frequent as those of this one */

struct inlet_facet { /* of one kind of grains */
    const struct facet *facet;
    int kind;
    double area;        /* m^2; disks: m */
    double u[3], sigma; /* m/s */
    double n, normal;   /* 1/m^3 (disks: 1/m^2); m/s: density of the grains, u along the normal */
    double fastest;     /* m/s: the largest sigma of all kinds */
    double most;        /* 1/m: the largest push_weight of all kinds */
};
struct grains_inlets {
    struct grains_inflow state;
    const struct setup *setup;
    const struct grains_models *models;
    const struct grain_box *box;
    struct field *density, *U, *T;
    double size;    /* m^3 (disks: m^2) of a grain */
    bool by_alpha;  /* is `density` alpha, or rho? */
    int kinds;      /* 1: all are alike */
    double longest; /* s: values that change in time are renewed as often, at least; HUGE_VAL: they do not change */
    int n;
    struct inlet_facet *list; /* [n] all kinds of a facet, then those of the next one */
    double *sum;              /* [2 n] 1/s: rates of grains that come in and, behind them, of pushes, added up */
};

/* Does a patch give values to what flows in? */
static bool gives(const struct field *f, int p) {
    const struct boundary_type *type = f ? boundary_find(f->patch[p].type) : NULL;
    return type && type->giving != BY_RATE && !boundary_is_wall(type) && boundary_value(type, f->kind->components);
}

static status check_inlet(const struct setup *s, const struct grains_start *start, int p) {
    const struct field *U = start->field[FIELD_U];
    const struct field *density = start->field[start->field[FIELD_ALPHA] ? FIELD_ALPHA : FIELD_RHO];
    if (gives(density, p) && gives(start->field[FIELD_T], p)) return OK;
    return fail(
        ERR_INPUT,
        "%s:%d: patch %s: type is %s, so that grains come in there, and %s says not how: give it on that patch, "
        "too, as by  fixedValue;",
        dict_path(U->dict), U->patch[p].line, s->mesh->patch[p].name, U->patch[p].type,
        gives(density, p) ? "T" : "alpha");
}

status grains_inlets_find(const struct setup *s, const struct grains_start *start, struct grains_models *m, bool *any) {
    *any = false;
    for (int p = 0; p < s->mesh->npatches; p++) {
        m->feeds[p] = s->mesh->patch[p].nfaces > 0 && gives(start->field[FIELD_U], p);
        if (!m->feeds[p]) continue;
        TRY(check_inlet(s, start, p));
        m->open[p] = true;
        *any = true;
    }
    return OK;
}

/* ---- values ---- */

static const double *value_at(const struct field *f, const struct facet *facet, const struct polymesh *m) {
    const struct patch_field *q = &f->patch[facet->wall];
    const long face = facet->face - m->patch[facet->wall].start;
    return q->values ? q->values + face * f->kind->components : q->uniform;
}

/* Diameter, volume and mass of a kind over those of the law; shares of the kinds at a facet, in numbers. */
static double size_of(const struct grains_inlets *in, int kind) {
    return in->models->kinds.n ? in->models->kinds.size[kind] : 1;
}
static double volume_of(const struct grains_inlets *in, int kind) {
    const double size = size_of(in, kind);
    return size * size * (in->box->dim == 2 ? 1 : size);
}
static double mass_of(const struct grains_inlets *in, int kind) {
    return in->models->kinds.n ? in->models->kinds.mass[kind] : 1;
}
static const double *share_at(const struct grains_inlets *in, const struct inlet_facet *f) {
    return in->models->inlet_share[f->facet->wall];
}

/* The gas of all kinds has the velocity U; each kind has the same energy of motion about it, T that of the mean mass.
 */
static void set_facet(const struct grains_inlets *in, struct inlet_facet *f) {
    const struct polymesh *m = in->setup->mesh;
    const double *U = value_at(in->U, f->facet, m), *share = share_at(in, f);
    double size = 0, mass = 0, least = HUGE_VAL; /* means over the grains, and the least mass */
    for (int k = 0; k < in->kinds; k++) {
        size += share[k] * volume_of(in, k);
        mass += share[k] * mass_of(in, k);
        least = fmin(least, mass_of(in, k));
    }
    const double T = *value_at(in->T, f->facet, m);
    f->sigma = sqrt(T * (mass / mass_of(in, f->kind)));
    f->fastest = sqrt(T * (mass / least));
    const double per = share[f->kind] / (in->by_alpha ? in->size * size : in->models->grain.mass * mass);
    f->n = per * *value_at(in->density, f->facet, m);
    f->normal = 0;
    for (int k = 0; k < in->box->dim; k++) {
        f->u[k] = U[in->setup->axis[k]];
        f->normal += f->u[k] * f->facet->normal[k];
    }
}

/* Returns the pair correlation of grains of the facet's kind and another at contact: of Jenkins & Mancini (1987) for
 * disks, of Boublik (1970) for spheres; with one kind these are Henderson's (1975) and
 * Carnahan & Starling's (1969). */
static double chi_of(const struct grains_inlets *in, const struct inlet_facet *f, int other) {
    const struct inlet_facet *all = f - f->kind;
    const double *share = share_at(in, f), a = size_of(in, f->kind), b = size_of(in, other);
    double alpha = 0, squares = 0, cubes = 0; /* the last two of one dimension less for disks */
    for (int k = 0; k < in->kinds; k++) {
        alpha += all[k].n * (in->size * volume_of(in, k));
        squares += share[k] * volume_of(in, k) / size_of(in, k);
        cubes += share[k] * volume_of(in, k);
    }
    const double gap = 1 - alpha, q = squares / cubes * (2 * a * b / (a + b)); /* 1 of one kind */
    if (in->box->dim == 2) return (1 - (1 - 9. / 16 * q) * alpha) / (gap * gap);
    return (1 - (2 - 1.5 * q) * alpha + (1 - q) * (1 - 0.5 * q) * (alpha * alpha)) / (gap * gap * gap);
}

/* Returns the rate of impacts on one grain of kind `other` by grains of the facet's kind beyond it, over their speed
 * and over the volume of that grain in unit of the law's, if they came from all sides of a half space. */
static double push_weight(const struct grains_inlets *in, const struct inlet_facet *f, int other) {
    const double d = 0.5 * (size_of(in, f->kind) + size_of(in, other)) * in->models->grain.diameter;
    return f->n * chi_of(in, f, other) * (in->box->dim == 2 ? PI * d : 2 * PI * d * d) / volume_of(in, other);
}

/* Returns the rate of candidates for impacts on grains at a facet by grains beyond it, per volume of a grain, as if all
 * of them were as fast as FASTEST deviations and hit the kind that is hit most often. */
static double push_rate(const struct grains_inlets *in, struct inlet_facet *f) {
    f->most = 0;
    for (int k = 0; k < in->kinds; k++) f->most = fmax(f->most, push_weight(in, f, k));
    return f->most * FASTEST * f->fastest;
}

/* Places are drawn in a layer of two diameters at the facet, half a diameter of it beyond: it holds all of each grain
 * whose centre is less than a diameter away, so that all of these are hit alike. */
static double layer_of(const struct grains_inlets *in) {
    return 2 * in->models->grain.diameter;
}

static double total(const struct grains_inlets *in) {
    return in->sum[2 * in->n - 1];
}
static double total_of_grains(const struct grains_inlets *in) {
    return in->sum[in->n - 1];
}

static bool changes(const struct field *f, int p) {
    return f->patch[p].varying && varying_in_time(f->patch[p].varying);
}

/* Gives the facets the values of the patches at time t, and the rates that follow from them. */
static status renew(struct grains_inlets *in, double t) {
    struct field *all[] = {in->density, in->U, in->T};
    double sum = 0;
    for (int p = 0; p < in->setup->mesh->npatches; p++)
        for (int i = 0; in->models->feeds[p] && i < 3; i++)
            if (changes(all[i], p)) TRY(field_renew(all[i], p, t, ERR_STATE));
    for (int j = 0; j < in->n; j++) {
        struct inlet_facet *f = &in->list[j];
        set_facet(in, f);
        in->sum[j] = sum += f->n * f->area * random_inflow_rate(f->normal, f->sigma);
    }
    for (int j = 0; j < in->n; j++) {
        struct inlet_facet *f = &in->list[j];
        in->sum[in->n + j] = sum += push_rate(in, f) * f->area * layer_of(in) / in->size;
    }
    in->state.renewed = t;
    return OK;
}

static double renewal(const struct grains_inlets *in) {
    return in->state.renewed + fmin(in->longest, in->longest < HUGE_VAL ? 1 / total_of_grains(in) : HUGE_VAL);
}

static void wait(struct grains_inlets *in, double t) {
    in->state.next = total(in) > 0 ? t + random_waiting(&in->state.random) / total(in) : HUGE_VAL;
}

/* ---- making ---- */

static double area_of(const struct facet *f, int dim) {
    double a[3] = {0}, b[3] = {0}, square = 0;
    for (int k = 0; k < dim; k++) {
        a[k] = f->corner[1][k] - f->corner[0][k];
        b[k] = f->corner[2][k] - f->corner[0][k];
    }
    if (dim == 2) return sqrt(a[0] * a[0] + a[1] * a[1]);
    for (int k = 0; k < 3; k++) {
        const double c = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        square += c * c;
    }
    return 0.5 * sqrt(square);
}

static status fill(struct grains_inlets *in, const struct grains_inflow *saved, double t) {
    const struct facets *all = in->box->facets;
    for (int pass = 0; pass < 2; pass++) {
        if (pass) TRY(allocate(&in->list, in->n, sizeof *in->list, "inlets"));
        if (pass) TRY(allocate(&in->sum, 2L * in->n, sizeof *in->sum, "inlets"));
        in->n = 0;
        for (int i = 0; i < all->own; i++) {
            const struct facet *f = &all->facet[i];
            if (!in->models->feeds[f->wall]) continue;
            for (int k = 0; pass && k < in->kinds; k++)
                in->list[in->n + k] = (struct inlet_facet){.facet = f, .kind = k, .area = area_of(f, in->box->dim)};
            in->n += in->kinds;
        }
    }
    for (int p = 0; p < in->setup->mesh->npatches; p++)
        if (in->models->feeds[p] && (changes(in->density, p) || changes(in->U, p) || changes(in->T, p)))
            in->longest = (in->models->window > 0 ? in->models->window : 1) / 200;
    if (saved) {
        in->state = *saved;
        return renew(in, saved->renewed);
    }
    in->state.random = random_make((uint64_t)in->models->seed, STREAM);
    TRY(renew(in, t));
    wait(in, t);
    return OK;
}

status grains_inlets_make(const struct setup *s, const struct grains_models *m, const struct grains_start *start,
                          const struct grain_box *box, double t, const struct grains_inflow *saved,
                          struct grains_inlets **out) {
    const double d = m->grain.diameter, size = box->dim == 2 ? PI / 4 * d * d : PI / 6 * d * d * d;
    const bool alpha = start->field[FIELD_ALPHA] != NULL;
    TRY(allocate(out, 1, sizeof **out, "inlets"));
    **out = (struct grains_inlets){.setup = s,
                                   .models = m,
                                   .box = box,
                                   .density = start->field[alpha ? FIELD_ALPHA : FIELD_RHO],
                                   .U = start->field[FIELD_U],
                                   .T = start->field[FIELD_T],
                                   .size = size,
                                   .by_alpha = alpha,
                                   .kinds = m->kinds.n ? m->kinds.n : 1,
                                   .longest = HUGE_VAL};
    return fill(*out, saved, t);
}

void grains_inlets_free(struct grains_inlets *in) {
    if (!in) return;
    free(in->list);
    free(in->sum);
    free(in);
}

/* ---- grains ---- */

double grains_inlets_next(const struct grains_inlets *in) {
    return fmin(in->state.next, renewal(in));
}

/* Draws one of the first `n` rates, by their size. */
static int draw(struct grains_inlets *in, int n) {
    const double at = random_uniform(&in->state.random) * in->sum[n - 1];
    int low = 0, high = n - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (in->sum[middle] > at)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Draws a place above a facet, at a height (m): even in a triangle, folded from a parallelogram. */
static void draw_place(struct grains_inlets *in, const struct facet *f, double height, double x[3]) {
    const int dim = in->box->dim;
    double a = random_uniform(&in->state.random), b = dim == 2 ? 0 : random_uniform(&in->state.random);
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    for (int k = 0; k < 3; k++) x[k] = 0;
    for (int k = 0; k < dim; k++) {
        x[k] = f->corner[0][k] + a * (f->corner[1][k] - f->corner[0][k]) + height * f->normal[k];
        if (dim == 3) x[k] += b * (f->corner[2][k] - f->corner[0][k]);
    }
}

/* Draws the velocity of a candidate; is it accepted? */
static bool draw_velocity(struct grains_inlets *in, const struct inlet_facet *f, double u[3]) {
    struct random *r = &in->state.random;
    const double *normal = f->facet->normal;
    double has = 0, speed;
    for (int k = 0; k < 3; k++) u[k] = 0;
    for (int k = 0; k < in->box->dim; k++) {
        u[k] = f->u[k] + f->sigma * random_normal(r);
        has += u[k] * normal[k];
    }
    const bool accepted = random_inflow(r, f->normal, f->sigma, &speed);
    for (int k = 0; k < in->box->dim; k++) u[k] += (speed - has) * normal[k];
    return accepted;
}

/* Draws grains of the kind until one finds room. */
static void enter(struct grains_inlets *in, struct grains *g, const struct inlet_facet *f, double u[3]) {
    const double height = INSIDE * 0.5 * in->models->grain.diameter;
    const int kind = f->kind;
    for (int i = 0; i < TRIES; i++) {
        double x[3];
        draw_place(in, f->facet, height, x);
        if (grains_enter(g, x, u, kind, f->facet->wall)) return;
        do f = &in->list[draw(in, in->n)];
        while (f->kind != kind || !draw_velocity(in, f, u));
    }
    in->state.blocked++;
}

/* Draws a unit vector k of the half space that the normal leads to. */
static void draw_direction(struct grains_inlets *in, const double normal[3], double k[3]) {
    double square = 0, along = 0;
    for (int a = 0; a < 3; a++) {
        k[a] = a < in->box->dim ? random_normal(&in->state.random) : 0;
        square += k[a] * k[a];
        along += k[a] * normal[a];
    }
    for (int a = 0; a < 3; a++) k[a] *= (along < 0 ? -1 : 1) / sqrt(square);
}

/* Draws a grain near the facet and an impact on it by one beyond, along k from the centre of that one; it is refused
 * with the probability that makes all rates those of the gas. */
static void push(struct grains_inlets *in, struct grains *g, const struct inlet_facet *f) {
    const struct grains_models *m = in->models;
    const double *normal = f->facet->normal;
    double x[3], at[3], u[3], k[3], speed, relative = 0, height = 0, along = 0;
    draw_place(in, f->facet, (random_uniform(&in->state.random) - 0.25) * layer_of(in), x);
    const int i = grains_covering(g, x, at, u);
    if (i < 0) return;
    draw_direction(in, normal, k);
    for (int a = 0; a < in->box->dim; a++) {
        height += (at[a] - f->facet->corner[0][a]) * normal[a];
        along += k[a] * normal[a];
        relative += (f->u[a] - u[a]) * k[a];
    }
    const int kind = grains_kind_of(g, i);
    const double reach = 0.5 * (size_of(in, f->kind) + size_of(in, kind)) * m->grain.diameter;
    if (height > reach * along) return; /* that centre would not lie beyond */
    const double part = push_weight(in, f, kind) / f->most;
    if (random_uniform(&in->state.random) * FASTEST * f->fastest > part * random_inflow_rate(relative, f->sigma))
        return;
    if (!random_inflow(&in->state.random, relative, f->sigma, &speed)) return;
    const double own = mass_of(in, kind), other = mass_of(in, f->kind);
    const double given = m->kinds.n ? m->kinds.restitution[kind][f->kind] : m->grain.restitution;
    const double e = speed < m->grain.threshold ? 1 : given;
    for (int a = 0; a < 3; a++) k[a] *= 0.5 * (1 + e) * speed * (2 * other / (own + other));
    grains_push(g, i, k, f->facet->wall);
}

status grains_inlets_take(struct grains_inlets *in, struct grains **g) {
    double u[3];
    if (renewal(in) <= in->state.next) {
        TRY(renew(in, renewal(in)));
        wait(in, in->state.renewed);
        return OK;
    }
    const double t = in->state.next;
    const int q = draw(in, 2 * in->n);
    const struct inlet_facet *f = &in->list[q % in->n];
    if (q >= in->n) {
        push(in, *g, f);
    } else if (draw_velocity(in, f, u)) {
        if (grains_is_full(*g)) TRY(grains_grow(g, grains_number(*g) + grains_number(*g) / 2 + 64));
        enter(in, *g, f, u);
    }
    wait(in, t);
    return OK;
}

const struct grains_inflow *grains_inlets_state(const struct grains_inlets *in) {
    return &in->state;
}
