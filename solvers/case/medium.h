/* What is simulated, as the code that all solvers share sees it (run.c, output.c, report.c, functions*.c): a table of
 * quantities and a handful of functions. A solver is one struct medium_type and a main of one line. */
#ifndef SOLVERS_MEDIUM_H
#define SOLVERS_MEDIUM_H

#include "mesh/format/foamfile.h"
#include "solvers/case/control.h"
#include "solvers/case/fields.h"
#include <stdio.h>

enum { MAX_QUANTITIES = 16, MAX_BUDGET = 16 };
struct quantity { /* a field of the medium */
    const char *name;
    int components; /* 1 or 3 */
    signed char dimensions[7];
    bool exact; /* written with all digits: a restart reads it */
};
struct pace {          /* of the step to come */
    double stable;     /* s: the largest allowed */
    double rate;       /* 1/s: the Courant number is dt * rate */
    const char *limit; /* what `stable` comes from; NULL: the Courant number, which has a place */
    const char *early; /* what may end a step before its time; NULL: a rejection */
};

struct setup;
struct medium;
struct cloud;
struct checksums;
struct medium_type {
    const char *application; /* as controlDict, lock and provenance name it */
    const char *help;
    void (*list_models)(FILE *f);
    void (*list_boundaries)(FILE *f);
    const struct quantity *quantity;
    int noffered;               /* function objects know the first so many */
    const int *written, *shown; /* of a time folder in this order; vtk's choice; -1 ends them */
    bool event_driven;          /* a step is no sweep over the cells: no Courant number, no steps per second */

    /* Collective, in this order; each fills s->medium. read: the dictionaries, which it names in s->file. state: the
     * fields of time s->start, and s->grid by setup_grid. start: the state a run begins with, checked. */
    status (*read)(struct setup *s);
    status (*state)(struct setup *s);
    status (*start)(struct medium *m);
    void (*free)(struct medium *m);
    status (*check_control)(const struct medium *m, const struct control *c); /* is it allowed? NULL: always */

    void (*describe)(const struct medium *m, FILE *f);
    void (*provenance)(const struct medium *m, struct sink *o); /* entries of the dictionary */
    double (*memory)(const struct medium *m);                   /* bytes, of all ranks, without mesh and fields */

    void (*plan)(struct medium *m, const struct control *c, struct pace *out);
    void (*place)(struct medium *m, double place[3]); /* of the cell that gave the last plan's rate */
    /* From t by *dt or, where that cannot be, by less; ERR_STATE: the state is the last good one. */
    status (*step)(struct medium *m, const struct control *c, double t, double *dt);
    status (*after)(struct medium *m, const struct moment *now); /* tables of its own; NULL: none */
    status (*log)(struct medium *m, FILE *f);                    /* its lines of a log entry; the root prints */
    status (*finish)(struct medium *m, FILE *f);                 /* its lines at the end; NULL: none */

    /* Values along computational axes: of a block of this rank, gathered to the root in polyMesh order. */
    void (*block)(const struct medium *m, int block, int quantity, double *const out[3]);
    status (*gather)(const struct medium *m, int quantity, double *const out[3]);
    bool (*present)(const struct medium *m, int quantity); /* is it written? NULL: always */
    /* The entry that the start folder gives, or NULL: calculated. */
    const struct patch_field *(*patch)(const struct medium *m, int quantity, int patch);
    /* What has changed mass and energy since the first call, by cause, as the titles say; NULL ends these. Collective.
     * NULL: no such account is kept. */
    const char *const *budget_titles;
    status (*budget)(struct medium *m, double row[MAX_BUDGET]);
    /* Of a medium of grains, else NULL: the grains (n = 0: none to be written), to be freed; what besides fields a
     * restart needs, written into the folder of a time. The root's. */
    status (*cloud)(const struct medium *m, struct cloud *out);
    status (*save)(const struct medium *m, const char *folder, const char *location, struct checksums *sums);
};
struct medium { /* first member of each medium's own struct */
    const struct medium_type *type;
    struct setup *setup;
    double next; /* s: uniform/time's deltaT, where a restart needs the step to try next; 0: the last step */
    double end;  /* s: where the step to come ends if it is not shortened, which t + dt may miss by a bit */
};

extern const struct medium_type gas_medium, segregation_medium, grains_medium;

#endif
