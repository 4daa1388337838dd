/* Source terms, a table: what moves velocity and temperature of a cell by itself, integrated exactly at frozen density.
 *
 * A source is one row of source_table with the functions it names, all in source.c: reading, listing, both mesh
 * engines, diffusion, and the budget of energy work by the row. A step takes half of its time through all sources in
 * the order of the table, the flow, and the other half in the opposite order: the same forwards and backwards, hence of
 * second order also where sources depend on each other, as cooling and heating do. */
#ifndef LIBCORE_SOURCE_H
#define LIBCORE_SOURCE_H

#include "libcore/models/cooling.h"
#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"

enum { SOURCE_MOST = 16 }; /* rows of source_table, at most */

struct sources {                        /* zeroed: no source, which costs nothing */
    const struct cooling *cooling;      /* NULL: none; without effect where impacts are elastic */
    struct own_params cooling_params;   /* parameters of the cooling law */
    double gravity[MAX_DIM];            /* m/s^2, computational axes */
    double amplitude, frequency, phase; /* g(t) = gravity (1 + amplitude cos(2 pi frequency t + phase)); -, Hz, rad */
    int knots;                          /* > 0: amplitude is linear between them, and constant before and beyond */
    const double *ramp;                 /* [knots][2] time in rising order (s), amplitude; not owned */
    bool on[SOURCE_MOST];               /* rows of source_table that were chosen by name, and their parameters, */
    struct own_params params[SOURCE_MOST]; /* vectors along computational axes */
};

struct source_type;
struct source_step { /* one source over one sub-step: what is the same in all cells */
    const struct source_type *row;
    const struct sources *all;
    const struct own_params *params; /* of the row */
    const struct eos *eos;
    const struct material *material;
    int dim;
    double t, dt; /* s, from t to t + dt */
    /* Set by the row's plan: */
    double kick[MAX_DIM]; /* m/s, the velocity that gas at rest gains */
    double number[4];     /* what else its step needs */
};

struct source_type {
    struct model model; /* its parameters: members of a struct of the row's own, numbers and vectors */
    const char *cause;  /* under which the budget books its energy: the column's title */
    bool pushes;        /* It changes the velocity; */
    bool cools, heats;  /* it may lower T; it may raise T. */
    /* Is it on, by what stands elsewhere than in `sources (..)`? NULL: it is where its name stands there. */
    bool (*active)(const struct sources *all, const struct material *m);
    void (*plan)(struct source_step *s); /* NULL: the step needs nothing but what it is given */
    /* Moves n <= BATCH cells over dt: momentum mom[dim] by components, internal energy eps > 0 per mass. A cell's
     * result depends on that cell alone. */
    void (*step)(const struct source_step *s, int n, const double *restrict rho, double *const mom[MAX_DIM],
                 double *restrict eps);
    /* The energy that the step adds to gas of the mass totals[0] and, if the row pushes, the momentum totals[1 + k]
     * before the step. NULL: these do not tell, and the budget measures the energy. */
    double (*gained)(const struct source_step *s, const double totals[MAX_VAR]);
};
extern const struct source_type source_table[];
extern const int source_count;

bool source_row_active(const struct sources *s, const struct material *m, int row);
bool source_active(const struct sources *s, const struct material *m); /* any row */
bool source_shaken(const struct sources *s);
/* Do impacts take energy? */
bool source_cools(const struct sources *s, const struct material *m);
/* May T change; may it rise? Asked of what is chosen, so that Haff's law counts where impacts are elastic, too. */
bool source_thermal(const struct sources *s);
bool source_heats(const struct sources *s);

/* Velocity gained from gravity from t to t + dt: the exact integral of g(t), m/s. */
void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]);

struct source_plan { /* the active sources over one sub-step, in the order in which they act */
    int n;
    struct source_step step[SOURCE_MOST];
};
/* In the order of the table, or `backwards`. */
void source_plan(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 bool backwards, struct source_plan *out);
/* Mean acceleration of gas at rest from t to t + dt, m/s^2: what pulls gas onto walls. */
void source_pull(const struct sources *s, const struct eos *eos, const struct material *m, int dim, double t, double dt,
                 double pull[MAX_DIM]);

/* n <= BATCH cells: U[v] = rho, rho u .., E are moved through the plan; E is put together once, at the end. */
void source_apply(const struct source_plan *plan, int n, double *const U[MAX_VAR]);

#endif
