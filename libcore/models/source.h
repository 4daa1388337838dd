/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source terms: a table of terms that change velocity and temperature of a cell without its neighbours, integrated
 * exactly at frozen density. Gravity is a source of cold cells alone; elsewhere it acts within the stages of the flow,
 * so that it balances the pressure of gas at rest there (libcore/gas/gas_private.h, `falls`; docs/physics.md 3.1).
 *
 * A source is one row of source_table with the functions it names, all in source.c: reading, listing, both mesh
 * engines, diffusion, and the budget of energy work by the row. A step applies the sources over half of its time
 * in the order of the table, then the flow, then the sources over the other half in the opposite order. It is the same
 * forwards and backwards, hence of second order also where sources depend on each other, as cooling and heating do. */
#ifndef LIBCORE_SOURCE_H
#define LIBCORE_SOURCE_H

#include "libcore/models/cooling.h"
#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"

enum { SOURCE_MOST = 16 }; /* the most rows that source_table may have */

struct sources {                        /* zeroed: no source is on, which costs nothing */
    const struct cooling *cooling;      /* the cooling law, NULL: none; it has no effect where impacts are elastic */
    struct own_params cooling_params;   /* parameters of the cooling law */
    double gravity[MAX_DIM];            /* m/s^2, along computational axes */
    double amplitude, frequency, phase; /* g(t) = gravity (1 + amplitude cos(2 pi frequency t + phase)); -, Hz, rad */
    int knots;                          /* number of knots, between which the amplitude is linear; 0: constant */
    const double *ramp;                 /* [knots][2] time in rising order (s), amplitude; not owned */
    bool on[SOURCE_MOST];               /* was the row of source_table chosen by name? */
    struct own_params params[SOURCE_MOST]; /* parameters of those rows, vectors along computational axes */
};

struct source_type;
struct source_step { /* one source over one sub-step: the numbers that are the same in all cells */
    const struct source_type *row;
    const struct sources *all;
    const struct own_params *params; /* parameters of the row */
    const struct eos *eos;
    const struct material *material;
    int dim;      /* components of velocity */
    double t, dt; /* s, from t to t + dt */
    /* Of the cells in hand, as in struct closure_line; NULL unless a source asks for the shear rate. */
    const double *shear_rate, *by_impacts;
    /* The row's plan sets: */
    double kick[MAX_DIM]; /* m/s: the velocity that gas at rest gains */
    double number[4];     /* further numbers that the row's step needs */
    bool late;            /* as in struct closure_line */
};

struct source_type {
    struct model model; /* its parameters, numbers and vectors, fill a struct of the row's own */
    const char *cause;  /* title of the column in which the budget books its energy */
    bool pushes;        /* does it change the velocity? */
    bool cools, heats;  /* may it lower T? may it raise T? */
    /* Is the source on? For sources that have an entry outside `sources (..)`. NULL: it is on if its name stands
     * there. */
    bool (*active)(const struct sources *all, const struct material *m);
    void (*plan)(struct source_step *s); /* sets kick and number; NULL: the step needs neither */
    /* Advances n <= BATCH cells by dt: momentum mom[dim] by components, internal energy eps > 0 per mass. The result of
     * a cell depends on that cell alone. */
    void (*step)(const struct source_step *s, int n, const double *restrict rho, double *const mom[MAX_DIM],
                 double *restrict eps);
    /* Returns the energy that the step adds to gas of the mass totals[0] and, if the row pushes, of the momentum in
     * totals[1] .. before the step. NULL: mass and momentum do not determine it, and the budget measures it. */
    double (*gained)(const struct source_step *s, const double totals[MAX_VAR]);
};
extern const struct source_type source_table[];
extern const int source_count;

/* Is the row on? Is any row on? */
bool source_row_active(const struct sources *s, const struct material *m, int row);
bool source_active(const struct sources *s, const struct material *m);
/* Is gravity modulated in time? */
bool source_shaken(const struct sources *s);
/* The needs (libcore/models/closure.h) of the sources that are on. */
unsigned source_needs(const struct sources *s, const struct material *m);
/* Do impacts take energy? */
bool source_cools(const struct sources *s, const struct material *m);
/* May the sources chosen change T? May they raise T? The answer looks at the choice alone, so that Haff's law counts
 * where impacts are elastic, too. */
bool source_thermal(const struct sources *s);
bool source_heats(const struct sources *s);

/* Computes the velocity (m/s) that gravity gives from t to t + dt, the exact integral of g(t). */
void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]);
/* Computes the mean acceleration (m/s^2) from t to t + dt, of the kicks of both halves. The stages of a step have it
 * throughout: gas that falls then gains the exact velocity, and every Runge-Kutta scheme of order 2 or more keeps its T
 * to round-off. With an acceleration that changes from stage to stage, the work u.g of a step is not the energy of
 * motion that gas gains. */
void source_gravity(const struct sources *s, double t, double dt, double gravity[MAX_DIM]);
int source_gravity_row(void); /* its place in source_table */
/* Has gravity a component along one of the first `dim` axes? */
bool source_falls(const struct sources *s, int dim);

/* J/kg: no source leaves a state less internal energy. It lies far below what any gas has, and far above where products
 * of energies and densities would underflow: at eps = 0 there is no sound, and a state that cannot be read again. */
#define SOURCE_COLDEST 1e-100

struct source_plan { /* the active sources over one sub-step, in the order in which they act */
    int n;
    struct source_step step[SOURCE_MOST];
    bool gravity_alone; /* is gravity the only source? */
    double warm; /* J/kg: source_apply finds which cells gravity acts on, those of eps below `warm`; < 0: the caller
                    knows */
};
/* Plans the active sources from t to t + dt, in the order of the table, or `backwards`. */
void source_plan(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 bool backwards, struct source_plan *out);
/* Leaves of a plan gravity alone, or all but gravity. */
void source_plan_part(struct source_plan *plan, bool gravity);
/* Computes the mean acceleration (m/s^2) of gas at rest from t to t + dt, which pulls gas onto walls. */
void source_pull(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 double pull[MAX_DIM]);

/* Advances n <= BATCH cells by the plan: U[v] = rho, rho u .., E. E is put together once, at the end. falls: [n] 1
 * where gravity acts, else 0, in or out as plan->warm says; NULL: it acts on all cells. Cells on which nothing acts
 * keep their bits; eps is held at SOURCE_COLDEST. shear_rate: [n], or NULL, as source_needs says; by_impacts, which
 * counts with it: as in struct closure_line. Returns whether falls is 1 anywhere. */
bool source_apply(const struct source_plan *plan, int n, double *const U[MAX_VAR], double *falls,
                  const double *shear_rate, const double *by_impacts);

#endif
