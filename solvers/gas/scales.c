/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the grains and the temperature of a start with its other sizes and speeds (scales.h). */
#include "solvers/gas/scales.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double SHARE = 0.1;            /* of the mass, that may sit in cells that are no hydrodynamics */
static const double RAREFIED = 0.1;         /* Knudsen number */
static const double HOT = 100, COLD = 1e-9; /* T over the square of another speed */
static const double ROUND_OFF = 1 + 1e-12;  /* by which sums may differ on other numbers of ranks */
static const double HEAVY = 3e4, LIGHT = 1; /* kg/m^3: osmium has 22,590, air 1.2 */
static const double NOTICED = 0.01;         /* diameters, by which a plate must move for a grain to notice it */
static const double STILL = 1e-6;           /* the same of the mean flow over T: less is what waves leave over */
/* The part of the time in which gas at rest falls through a cell that a step may last: it falls through 4 % of it. */
static const double FALL_PART = 0.2;

struct scales {
    double extent[3];              /* m, of the domain */
    double shortest;               /* m: least extent along a solved axis */
    double room;                   /* m: least extent along one that is not periodic; if all are, their greatest */
    double thickness;              /* m^(3 - dim): of the mesh along the axes that it lacks */
    double mass, T;                /* kg, or kg/m of disks: of all cells; m^2/s^2: its mean */
    double small, few, rarefied;   /* the parts of the mass in cells that are such */
    double width, number, knudsen; /* means of the mass: m; grains in a cube of the cell's width; path over `room` */
    double momentum[3];            /* kg m/s, along the components of u */
};

/* Does a cyclic pair of patches close the axis, its halves as far apart as the domain is long? */
static bool is_periodic(const struct polymesh *m, int axis, double extent) {
    for (int p = 0; p < m->npatches; p++) {
        const int q = m->patch[p].neighbour ? polymesh_find_patch(m, m->patch[p].neighbour) : -1;
        double a[3], b[3], area[3];
        if (q < 0 || !m->patch[p].nfaces || !m->patch[q].nfaces) continue;
        polymesh_patch_face(m, p, 0, a, area);
        polymesh_patch_face(m, q, 0, b, area);
        if (fabs(a[axis] - b[axis]) > 0.999 * extent) return true;
    }
    return false;
}

static void measure_domain(const struct setup *s, struct scales *q) {
    double low[3], high[3];
    polymesh_bounds(s->mesh, low, high);
    double period = 0;
    q->shortest = q->room = HUGE_VAL;
    for (int x = 0; x < 3; x++) q->extent[x] = high[x] - low[x];
    q->thickness = q->extent[0] * q->extent[1] * q->extent[2];
    for (int k = 0; k < s->dim; k++) {
        const double extent = q->extent[s->axis[k]];
        q->shortest = fmin(q->shortest, extent);
        q->thickness /= extent;
        if (is_periodic(s->mesh, s->axis[k], extent))
            period = fmax(period, extent);
        else
            q->room = fmin(q->room, extent);
    }
    if (isinf(q->room)) q->room = period;
}

/* Returns Enskog's mean free path (docs/physics.md 4.7). */
double free_path(const struct gas_models *models, double rho) {
    const struct material *m = &models->material;
    double contact;
    models->eos->contact(m, 1, &rho, &contact);
    return m->diameter * (m->disks ? PI / 8 : 1. / 6) / (sqrt(2) * contact);
}

/* Adds up what the ranks have of n sums, where each has a slice of the cells. */
static status add_ranks(const struct initial *i, int n, double *const sum[]) {
    double mine[16], *all = NULL;
    for (int k = 0; k < n; k++) mine[k] = *sum[k];
    if (!i->sliced || comm_size(i->share.comm) == 1) return OK;
    TRY(comm_gather(i->share.comm, mine, n, &all, NULL));
    for (int k = 0; all && k < n; k++) mine[k] = 0;
    for (int r = 0; all && r < comm_size(i->share.comm); r++)
        for (int k = 0; k < n; k++) mine[k] += all[r * n + k];
    free(all);
    comm_broadcast(i->share.comm, mine, n * (long)sizeof *mine);
    for (int k = 0; k < n; k++) *sum[k] = mine[k];
    return OK;
}

static status measure_mass(const struct setup *s, const struct gas_models *models, const struct initial *i,
                           struct scales *q) {
    const struct material *m = &models->material;
    const long first = i->sliced ? i->share.first : 0;
    for (long c = 0; c < i->ncells; c++) {
        const double volume = setup_volume(s, first + c), mass = i->rho[c] * volume;
        const double width = pow(volume / q->thickness, 1. / s->dim);
        const double number = i->rho[c] / m->mass * pow(width, m->disks ? 2 : 3);
        const double knudsen = free_path(models, i->rho[c]) / q->room;
        q->mass += mass;
        q->T += mass * i->T[c];
        q->width += mass * width;
        q->number += mass * number;
        q->knudsen += mass * fmin(knudsen, 1e3);
        q->small += width < (1 - 1e-9) * m->diameter ? mass : 0;
        q->few += number < 1 ? mass : 0;
        q->rarefied += knudsen > RAREFIED ? mass : 0;
        for (int k = 0; k < i->components; k++) q->momentum[k] += i->rho[c] * volume * i->u[k][c];
    }
    double *const sums[] = {&q->T,        &q->width,       &q->number,      &q->knudsen,     &q->small, &q->few,
                            &q->rarefied, &q->momentum[0], &q->momentum[1], &q->momentum[2], &q->mass};
    TRY(add_ranks(i, 11, sums));
    for (int k = 0; k < 7; k++) *sums[k] /= q->mass;
    return OK;
}

static status check_grains(struct setup *s, const struct dict *d, const struct gas_models *models,
                           const struct scales *q) {
    const double size = models->material.diameter;
    if (size > q->shortest)
        return warn(&s->warnings, WARN_GRAIN_SIZE, "%s:%d: a grain of diameter %g m is wider than the domain, %.3g m",
                    dict_path(d), dict_line(d, "grain"), size, q->shortest);
    const bool small = q->small > SHARE * ROUND_OFF; /* then cells have few grains, too */
    if (small)
        TRY(warn(&s->warnings, WARN_GRAIN_SIZE,
                 "%s:%d: grains of diameter %g m are wider than the cells in which %.3g %% of the mass sits (%.3g m "
                 "in the mean): a flow that varies within a grain is no flow of grains",
                 dict_path(d), dict_line(d, "grain"), size, 100 * q->small, q->width));
    if (q->few > SHARE * ROUND_OFF && !small)
        TRY(warn(&s->warnings, WARN_FEW_GRAINS,
                 "%s:%d: %.3g %% of the mass sits in cells with less than one grain (%.3g in the mean, in a cube "
                 "of the cell's width): fields are means of many runs there, not of one",
                 dict_path(d), dict_line(d, "grain"), 100 * q->few, q->number));
    if (q->rarefied > SHARE * ROUND_OFF)
        TRY(warn(&s->warnings, WARN_RAREFIED,
                 "%s:%d: %.3g %% of the mass sits where the mean free path is above a tenth of the domain's least "
                 "extent, %.3g m (Knudsen number %.3g in the mean; periodic axes do not count beside others): grains "
                 "hit the walls rather than each other there, and hydrodynamics does not hold",
                 dict_path(d), dict_line(d, "grain"), 100 * q->rarefied, q->room, q->knudsen));
    return OK;
}

/* Widens low .. high to the square of a speed, if there is that speed. */
static void include(double square, double *low, double *high) {
    if (!(square > 0)) return;
    *low = fmin(*low, square);
    *high = fmax(*high, square);
}

/* Includes the fall through the domain along a computational axis, and the plate's greatest speed along it. */
static void include_axis(const struct sources *g, int k, double extent, double *low, double *high) {
    include(fabs(g->gravity[k]) * extent, low, high);
    if (g->frequency > 0) include(pow(g->gravity[k] * g->amplitude / (2 * PI * g->frequency), 2), low, high);
}

/* Returns the square of the speed of the whole mass. */
static double mean_flow(const struct scales *q) {
    double square = 0;
    for (int k = 0; k < 3; k++) square += q->momentum[k] * q->momentum[k] / (q->mass * q->mass);
    return square;
}

double scales_fall(const struct setup *s, const struct sources *g) {
    double low[3], high[3], least = HUGE_VAL, most = 0;
    polymesh_bounds(s->mesh, low, high);
    for (int k = 0; k < s->dim; k++) include_axis(g, k, high[s->axis[k]] - low[s->axis[k]], &least, &most);
    return sqrt(most);
}

/* Computes the largest g(t) along physical axes of the mesh (m/s^2), shaking included, and *beyond, its size along
 * those that the mesh lacks. */
static void largest_gravity(const struct setup *s, const struct case_models *m, double out[3], double *beyond) {
    const struct sources *q = &m->gas.source;
    double most = fabs(q->amplitude), rest[3];
    for (int i = 0; i < q->knots; i++) most = fmax(most, fabs(q->ramp[2 * i + 1]));
    memcpy(rest, m->forces.gravity, sizeof rest);
    for (int k = 0; k < 3; k++) out[k] = 0;
    for (int k = 0; k < s->dim; k++) {
        out[s->axis[k]] = q->gravity[k] * (1 + most);
        rest[s->axis[k]] = 0;
    }
    *beyond = (1 + most) * sqrt(rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]);
}

status scales_longest_fall(const struct setup *s, const struct case_models *models, double *out) {
    const struct spread *spread = s->spread;
    const struct polymesh *m = spread ? &spread->home.mesh : s->mesh;
    const double *area = spread ? spread->geometry.face_area : s->face_area,
                 *volume = spread ? spread->geometry.volume : s->volume;
    const struct lattice *l = s->lattice;
    double g[3], beyond, *through = NULL, most = 0, flat = 0;
    largest_gravity(s, models, g, &beyond);
    beyond = friction_acts(models->gas.friction) ? beyond / s->dim : 0;
    for (int k = 0; l && k < l->dim; k++) {
        most += fabs(g[l->axis[k]]) / l->width[k];
        flat += beyond / l->width[k];
    }
    most = fmax(most, flat);
    *out = most > 0 ? FALL_PART * sqrt(2 / most) : HUGE_VAL;
    if (l) return OK;
    TRY(allocate(&through, 2L * m->ncells, sizeof(double), "cells"));
    for (int f = 0; f < m->nfaces; f++) {
        const double *A = area + 3L * f;
        double square = 0;
        for (int k = 0; k < s->dim; k++) square += A[s->axis[k]] * A[s->axis[k]];
        const double part[] = {fabs(g[0] * A[0] + g[1] * A[1] + g[2] * A[2]), beyond * sqrt(square)};
        for (int i = 0; i < 2; i++) {
            through[2L * m->owner[f] + i] += part[i];
            if (f < m->ninternal) through[2L * m->neighbour[f] + i] += part[i];
        }
    }
    for (int i = 0; i < m->ncells; i++)
        if (!spread || spread->home.whole[i])
            most = fmax(most, fmax(through[2L * i], through[2L * i + 1]) / (2 * volume[i]));
    free(through);
    if (spread) comm_max(s->comm, &most, 1);
    *out = most > 0 ? FALL_PART * sqrt(2 / most) : HUGE_VAL;
    return OK;
}

static void include_patch(const struct patch_rules *r, int components, double *low, double *high) {
    double u[3] = {0}, square = 0;
    if (!r->velocity.type) return;
    wall_velocity(r, components, 0, u);
    for (int k = 0; k < components; k++) square += u[k] * u[k];
    for (int k = 0; k < components && rule_holds(&r->velocity); k++) square += pow(r->velocity.uniform[k], 2);
    include(square, low, high);
    if (rule_holds(&r->temperature) && !r->pressure && !r->temperature.values)
        include(r->temperature.uniform[0], low, high);
}

/* Finds the least and the greatest square of a speed other than sqrt(T): flow, patches, free fall, shaking. */
static void other_speeds(const struct setup *s, const struct gas_models *models, const struct initial *i,
                         const struct scales *q, double *low, double *high) {
    const struct sources *g = &models->source;
    *low = HUGE_VAL;
    *high = 0;
    const double flow = mean_flow(q);
    if (flow > STILL * q->T * ROUND_OFF) include(flow, low, high);
    for (int k = 0; k < s->dim; k++) include_axis(g, k, q->extent[s->axis[k]], low, high);
    for (int p = 0; p < i->npatches; p++) include_patch(&i->rules[p], i->components, low, high);
}

static status check_temperature(struct setup *s, const struct gas_models *models, const struct initial *i,
                                const struct scales *q) {
    double low, high;
    other_speeds(s, models, i, q, &low, &high);
    if (!(high > 0) || (q->T <= HOT * high * ROUND_OFF && q->T * ROUND_OFF >= COLD * low)) return OK;
    const struct field *f = i->field[FIELD_T] ? i->field[FIELD_T] : i->field[FIELD_P];
    return warn(&s->warnings, WARN_TEMPERATURE,
                "%s:%d: T is %.3g m^2/s^2 in the mean, so that grains fly about at %.3g m/s, but every other speed "
                "(of flow, walls, free fall, shaking) lies between %.3g and %.3g m/s: T is no kelvin, but the "
                "square of the speed of grains along an axis",
                dict_path(f->dict), dict_line(f->dict, "internalField"), q->T, sqrt(q->T), sqrt(low), sqrt(high));
}

/* Warns of impacts that take no energy, though restitution is below 1, or a law of cooling is given. Sources may warm
 * the gas later. */
static status check_elastic(struct setup *s, struct dict *d, const struct gas_models *models, const struct initial *i,
                            const struct scales *q) {
    const struct material *m = &models->material;
    double low, high;
    struct dict *grain;
    TRY(dict_sub(d, "grain", &grain));
    if (models->source.cooling && !dict_has(grain, "restitution"))
        return warn(
            &s->warnings, WARN_ELASTIC,
            "%s:%d: restitution is not given, so that it is 1 and `cooling` takes no energy: add, for example,  "
            "restitution 0.9;",
            dict_path(d), dict_line(d, "grain"));
    if (!(m->restitution < 1)) return OK;
    if (!models->source.cooling)
        return warn(&s->warnings, WARN_ELASTIC,
                    "%s:%d: cooling is none, so that no impact takes energy, but restitution is %g: say  cooling "
                    "GarzoDufty;  or  restitution 1;",
                    dict_path(d), dict_line(d, "cooling"), m->restitution);
    if (source_heats(&models->source)) return OK;
    other_speeds(s, models, i, q, &low, &high);
    return scales_threshold(s, d, m, q->T, sqrt(high));
}

status scales_threshold(struct setup *s, const struct dict *properties, const struct material *m, double T,
                        double fastest) {
    if (!(m->restitution < 1) || !(m->threshold > fmax(sqrt(T), fastest) * ROUND_OFF)) return OK;
    return warn(
        &s->warnings, WARN_ELASTIC,
        "%s:%d: thresholdSpeed %g m/s is above every speed: grains fly about at %.3g m/s, and flow, walls, free "
        "fall and shaking have at most %.3g m/s. Slower impacts are elastic, so that none takes energy: lower "
        "it, to a hundredth of these speeds or less",
        dict_path(properties), dict_line(properties, "grain"), m->threshold, sqrt(T), fastest);
}

status scales_grain(struct setup *s, const struct dict *properties, const struct material *m) {
    if (!(m->diameter > 0) || m->mass == 1) return OK;
    const double density = 1 / packing_per_density(m), volume = m->mass / density;
    if (density <= HEAVY && density * ROUND_OFF >= LIGHT) return OK;
    return warn(
        &s->warnings, WARN_DENSITY,
        "%s:%d: a grain of diameter %g m and mass %g %s has a density of %.3g kg/m^3, %s: `mass` is that of one "
        "grain, of 2500 kg/m^3 %.4g here; mass 1 counts grains",
        dict_path(properties), dict_line(properties, "grain"), m->diameter, m->mass, m->disks ? "kg/m" : "kg", density,
        density > HEAVY ? "more than any metal" : "less than air", 2500 * volume);
}

/* Warns of gravity that points upwards. Along a single axis there is no up. */
static status check_gravity(struct setup *s, const struct forces *f) {
    const int up = s->axis[s->dim - 1];
    const double *g = f->gravity;
    double others = 0;
    for (int x = 0; x < 3; x++)
        if (x != up) others = fmax(others, fabs(g[x]));
    if (s->dim == 1 || !(g[up] > others * (1 + 1e-6))) return OK;
    return warn(
        &s->warnings, WARN_UPWARDS,
        "%s:%d: gravity (%g %g %g) points upwards, along +%c: things fall to the top of the mesh; say  value (%g "
        "%g %g);",
        dict_path(f->g), dict_line(f->g, "value"), g[0], g[1], g[2], "xyz"[up], up == 0 ? -g[0] : g[0],
        up == 1 ? -g[1] : g[1], up == 2 ? -g[2] : g[2]);
}

/* Is the frequency a round number of turns in 2 pi s, and not round itself? So is 628 rad/s, which are 100 Hz. */
static bool is_angular(double frequency) {
    const double turns = frequency / (2 * PI), power = pow(10, floor(log10(turns) + 1e-3));
    const double digit = round(turns / power), own = frequency / pow(10, floor(log10(frequency)) - 1);
    return fabs(turns / (digit * power) - 1) < 1e-3 && fabs(own - round(own)) > 1e-6;
}

static status check_shaking(struct setup *s, const struct forces *f, const struct material *m) {
    const struct plate p = forces_plate(f);
    const struct dict *d = f->shaking;
    const double frequency = f->source.frequency;
    if (!(p.acceleration > 0)) return OK;
    if (p.amplitude < 1)
        return warn(&s->warnings, WARN_SHAKING,
                    "%s:%d: amplitude %g is the greatest acceleration of the plate over that of gravity: below 1 the "
                    "layer never leaves it (it moves by +-%.3g m); if %g m are meant, say  amplitude %.6g;",
                    dict_path(d), dict_line(d, "amplitude"), p.amplitude, p.way, p.amplitude,
                    p.amplitude * p.amplitude / p.way);
    if (!(p.way < NOTICED * m->diameter) && !is_angular(frequency)) return OK;
    return warn(
        &s->warnings, WARN_SHAKING,
        "%s:%d: frequency %g is in Hz: the plate moves by +-%.3g m, and grains have a diameter of %g m; if %g rad/s "
        "are meant, say  frequency %.6g;",
        dict_path(d), dict_line(d, "frequency"), frequency, p.way, m->diameter, frequency, frequency / (2 * PI));
}

status scales_forces(struct setup *s, const struct forces *f, const struct material *m) {
    if (f->g) TRY(check_gravity(s, f));
    return f->shaken ? check_shaking(s, f, m) : OK;
}

status scales_check(struct setup *s, const struct gas_models *models, const struct initial *i) {
    struct dict *properties = NULL;
    struct scales q = {.mass = 0};
    for (int k = 0; k < s->nfiles; k++)
        if (!strcmp(s->file[k].name, "granularProperties")) properties = s->file[k].dict;
    measure_domain(s, &q);
    TRY(measure_mass(s, models, i, &q));
    TRY(check_temperature(s, models, i, &q));
    TRY(check_elastic(s, properties, models, i, &q));
    return models->eos->bounded && models->material.diameter > 0 ? check_grains(s, properties, models, &q) : OK;
}
