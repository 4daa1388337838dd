/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Averages an initial state that is given by expressions over the cells: its conserved variables, which are products of
 * the fields and differ from the products of the averages at second order. */
#include "mesh/grid/quadrature.h"
#include "solvers/gas/initial.h"

#include <math.h>
#include <stdlib.h>

enum { CHUNK = 512 }; /* cells that are averaged at a time */

struct averager { /* what the functions below share: the averages so far, and the points of some cells */
    struct initial *s;
    const struct field_place *place;
    const struct gas_models *models;
    struct quadrature *quadrature;
    int dim;
    long n;                                            /* points of the present cells */
    int *cell;                                         /* [n] the cell of a point */
    double (*x)[3], *weight, *values, *rho, *T, *u[3]; /* [n]: of the points; values[n][3]: of a field */
};

/* Sets a->values to a field at the points. */
static status take_values(struct averager *a, const struct field *f) {
    const int m = f->kind->components;
    if (field_has_expression(f)) return field_evaluate(f, a->n, a->x[0], a->place->t, a->values);
    for (long i = 0; i < a->n; i++)
        for (int k = 0; k < m; k++) a->values[i * m + k] = f->values[(long)a->cell[i] * m + k];
    return OK;
}

/* Does the same for a scalar, and fails unless all values lie between 0 and `most`. */
static status take_range(struct averager *a, const struct field *f, double most) {
    TRY(take_values(a, f));
    for (long i = 0; i < a->n; i++)
        if (!(a->values[i] > 0 && a->values[i] < most))
            return fail(ERR_INPUT, "%s:%d: it gives %s = %g at (%g %g %g); it must lie between 0 and %g%s",
                        dict_path(f->dict), dict_line(f->dict, "expression"), f->kind->name, a->values[i], a->x[i][0],
                        a->x[i][1], a->x[i][2], most, isfinite(most) ? BELOW_PACKING : "");
    return OK;
}

/* Computes rho, T and u at the points. */
static status take_states(struct averager *a) {
    struct field *const *field = a->s->field;
    const struct material *m = &a->models->material;
    const bool density = field[FIELD_RHO] != NULL, thermal = field[FIELD_T] != NULL;
    const double limit = density_limit(a->models->eos, m), per = packing_per_density(m);
    TRY(take_range(a, field[density ? FIELD_RHO : FIELD_ALPHA], density ? limit : packing_limit(a->models->eos, m)));
    for (long i = 0; i < a->n; i++) a->rho[i] = density ? a->values[i] : a->values[i] / per;
    if (!thermal) pressure_per_temperature(a->models->eos, m, (int)a->n, a->rho, a->T);
    TRY(take_range(a, field[thermal ? FIELD_T : FIELD_P], HUGE_VAL));
    for (long i = 0; i < a->n; i++) a->T[i] = thermal ? a->values[i] : a->values[i] / a->T[i];
    TRY(take_values(a, field[FIELD_U]));
    for (int k = 0; k < a->s->components; k++)
        for (long i = 0; i < a->n; i++) a->u[k][i] = a->values[3 * i + a->s->axis[k]];
    return OK;
}

/* Adds the points' conserved variables, times their weights, to their cells. */
static void add_states(struct averager *a) {
    for (long i = 0; i < a->n; i++) {
        const double w = a->weight[i] * a->rho[i];
        double square = 0;
        for (int k = 0; k < a->s->components; k++) {
            a->s->conserved[1 + k][a->cell[i]] += w * a->u[k][i];
            square += a->u[k][i] * a->u[k][i];
        }
        a->s->conserved[0][a->cell[i]] += w;
        a->s->conserved[1 + a->s->components][a->cell[i]] += w * (eps_of(&a->models->material, a->T[i]) + 0.5 * square);
    }
}

/* Weighs the points of a cell by their radius in a body of revolution. */
static void weigh_round(const struct revolution *r, int n, double (*x)[3], double *weight) {
    double sum = 0;
    if (!r->on) return;
    for (int i = 0; i < n; i++) sum += weight[i] *= x[i][r->radial] - r->at;
    for (int i = 0; i < n; i++) weight[i] /= sum;
}

static status run(struct averager *a) {
    const struct spread *spread = a->place->spread;
    const int ncells = (int)a->s->ncells, base = spread ? spread->base : 0;
    TRY(quadrature_make(spread ? &spread->home.mesh : a->place->mesh,
                        spread ? spread->geometry.cell_centre : a->place->centre, a->dim, a->s->axis, &a->quadrature));
    const long room = (long)CHUNK * a->quadrature->most;
    TRY(allocate(&a->x, room, sizeof *a->x, "points of the cells"));
    TRY(allocate(&a->cell, room, sizeof *a->cell, "points of the cells"));
    TRY(allocate(&a->weight, 9 * room, sizeof *a->weight, "points of the cells"));
    a->rho = a->weight + room;
    a->T = a->rho + room;
    for (int k = 0; k < 3; k++) a->u[k] = a->T + (k + 1) * room;
    a->values = a->u[2] + room;
    for (int v = 0; v < a->s->components + 2; v++)
        TRY(allocate(&a->s->conserved[v], ncells, sizeof(double), "averages"));
    for (int from = 0; from < ncells; from += CHUNK) {
        a->n = 0;
        for (int c = from; c < ncells && c < from + CHUNK; c++) {
            int points = quadrature_cell(a->quadrature, base + c, a->x + a->n, a->weight + a->n);
            weigh_round(&a->place->mesh->round, points, a->x + a->n, a->weight + a->n);
            while (points--) a->cell[a->n++] = c;
        }
        TRY(take_states(a));
        add_states(a);
    }
    return OK;
}

status initial_average(struct initial *s, const struct field_place *place, int dim, const struct gas_models *models) {
    struct averager a = {.s = s, .place = place, .models = models, .dim = dim};
    bool any = false;
    for (int i = 0; i < FIELD_COUNT; i++) any = any || (s->field[i] && field_has_expression(s->field[i]));
    if (!any || s->conserved[0]) return OK;
    status e = run(&a);
    quadrature_free(a.quadrature);
    free(a.x);
    free(a.cell);
    free(a.weight);
    return e;
}
