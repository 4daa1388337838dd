/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The medium that a run simulates, as the code that all solvers share sees it (run.c, output.c, report.c,
 * functions*.c): a table of quantities and a handful of functions. A solver is one struct medium_type and a main of one
 * line. */
#ifndef SOLVERS_MEDIUM_H
#define SOLVERS_MEDIUM_H

#include "mesh/base/clock.h"
#include "mesh/format/foamfile.h"
#include "solvers/case/control.h"
#include "solvers/case/fields.h"
#include <stdio.h>

enum { MAX_QUANTITIES = 32, MAX_BUDGET = 64, MAX_COLUMNS = 40 };
struct quantity { /* a field of the medium */
    const char *name;
    int components; /* 1 or 3 */
    signed char dimensions[7];
    bool exact; /* is it written with all digits, because a restart reads it? */
};
struct offered { /* the quantities of a medium */
    const struct quantity *quantity;
    int noffered;               /* number of quantities, the first ones, that function objects know */
    const int *written, *shown; /* quantities of a time folder, in this order, and of vtk files; -1 ends both */
};
struct pace {          /* how long the next step may be */
    double stable;     /* s: the largest step allowed: by maxCo, or, for a fixed deltaT, by the time scheme */
    double rate;       /* 1/s: the Courant number is dt * rate */
    const char *limit; /* name of what limits `stable`; NULL: the Courant number, which has a place */
    const char *early; /* name of what may end a step early; NULL: a rejection */
};

struct crossing { /* flow out of the medium by a face of a patch, mean over the last step; vectors: physical axes */
    int patch;
    double area, centre[3], normal[3]; /* m^2, m; unit, out of the medium */
    double mass, energy;               /* kg/s, W: energy by flow, work and heat */
    double pressure[3], viscous[3];    /* N: momentum by pressure and flow, and by viscous stress */
};
typedef void crossing_visitor(void *context, const struct crossing *face);

/* A face of a patch, with the state in the cell beside it. */
enum { EDGE_STATE = 5 };
struct edge_face {
    int face;                 /* within the patch */
    double normal[3], gap;    /* unit, out of the medium; m: from the cell to its mirror image */
    double state[EDGE_STATE]; /* the components of the quantities edge_state, vectors along physical axes */
};

struct budget_row { /* changes of mass, momentum and energy by cause: titles and values of the columns */
    int n;
    const char *title[MAX_BUDGET];
    double value[MAX_BUDGET];
};
struct log_row { /* the numbers of a log entry, as columns of a table: the same titles in every entry */
    int n;
    const char *title[MAX_COLUMNS];
    double value[MAX_COLUMNS];
};
static inline void log_column(struct log_row *row, const char *title, double value) {
    row->title[row->n] = title;
    row->value[row->n++] = value;
}

struct setup;
struct medium;
struct cloud;
struct checksums;
/* What -help says of a medium; the options that all solvers have stand in solvers/programs/solver.c. */
struct medium_help {
    const char *about; /* what it solves */
    const char *usage; /* its own options in the first line */
    const char *own;   /* the same, a line or more each */
    const char *end;   /* signals, exit codes */
};

struct medium_type {
    const char *application; /* name of the program, as controlDict, lock and provenance have it */
    const struct medium_help *help;
    void (*list_models)(FILE *f);
    void (*list_boundaries)(FILE *f);
    void (*keywords)(struct keywords *k); /* goes through those of all files but controlDict */
    struct offered fields;                /* of every case; a medium may have more */
    int axial;         /* the quantity that is a curl, which has three components whatever moves; 0: there is none */
    bool whole;        /* does it read arrays of all cells and faces of the mesh (setup_complete)? */
    bool starts;       /* does -np N go to a program that it starts? It then runs on one rank itself */
    bool seeds;        /* does a run depend on a seed, so that several make an ensemble (-ensemble)? */
    bool slabs;        /* are its cells dealt to the ranks by itself, and not as the grid's blocks are? */
    bool round;        /* does it know bodies of revolution (docs/physics.md 1.4)? */
    bool event_driven; /* a step is no sweep over the cells: no Courant number, no steps per second */

    /* The set-up, called in this order; collective. read makes s->medium from the dictionaries, which it names in
     * s->file. state reads the fields of time s->start, and makes s->grid by setup_grid. start makes the state a run
     * begins with, and checks it. */
    status (*read)(struct setup *s);
    status (*state)(struct setup *s);
    status (*start)(struct medium *m);
    void (*free)(struct medium *m);
    /* fails on a control that the medium forbids; NULL: all are fine */
    status (*check_control)(const struct medium *m, const struct control *c);

    void (*describe)(const struct medium *m, FILE *f);
    void (*provenance)(const struct medium *m, struct sink *o); /* writes its entries of uniform/provenance */
    double (*memory)(const struct medium *m);                   /* bytes, of all ranks, without mesh and fields */

    void (*plan)(struct medium *m, const struct control *c, struct pace *out);
    double (*knot)(const struct medium *m, double t); /* s: the first kink in time after t; NULL: there is none */
    /* cell says which cell, in which state, gave the last plan's rate: ", cell at .."; bound also what can be done
     * about it. Collective; NULL: they cannot. */
    void (*cell)(struct medium *m, char *text, size_t size);
    void (*bound)(struct medium *m, char *text, size_t size);
    /* Advances from t by *dt or, where that fails, by less, which *dt then says: 0 if the step took long and was left
     * because a rank had been asked to. After ERR_STATE the state is the last good one. */
    status (*step)(struct medium *m, const struct control *c, double t, double *dt);
    status (*after)(struct medium *m, const struct moment *now); /* writes tables of its own; NULL: it has none */
    /* Sets *row to the numbers of a log entry (on the root) and, unless f is NULL, prints its lines, on the root.
     * Collective. */
    status (*log)(struct medium *m, FILE *f, struct log_row *row);
    /* Sets out[] to the seconds that each part of the steps took on this rank, and returns their number. NULL: steps
     * have no parts. */
    int (*seconds)(const struct medium *m, struct part_seconds out[PARTS_TIMED]);
    /* prints its lines at the end, on the root; collective; NULL: it has none */
    status (*finish)(struct medium *m, FILE *f);

    /* Returns why there is no such quantity in this case; NULL: there is. NULL instead of the function: there always
     * is. derive makes ready what `block` gives of a quantity at this state. Collective; NULL: all are ready. */
    const char *(*lacks)(const struct medium *m, int quantity);
    status (*derive)(struct medium *m, int quantity);
    /* Values along computational axes: of a block of this rank, of a quantity that function objects know or of rhoE,
     * where all three lines of `out` are needed. exact gives them of any quantity, as a restart needs them. NULL: as
     * `block`. */
    void (*block)(const struct medium *m, int block, int quantity, double *const out[3]);
    void (*exact)(const struct medium *m, int block, int quantity, double *const out[3]);
    /* Is a quantity known to have the same bits in all cells of a block? Then value[line] gets them. NULL: it never
     * is. */
    bool (*uniform)(const struct medium *m, int block, int quantity, double value[3]);
    bool (*present)(const struct medium *m, int quantity); /* is the quantity written? NULL: always */
    /* Returns the patch entry that the start folder gives, or NULL: the patch is calculated. */
    const struct patch_field *(*patch)(const struct medium *m, int quantity, int patch);
    /* Replaces a quantity's values in the cells beside n faces of a patch, [n][components], by those on the faces,
     * which follow from the quantities of edge_state (-1 ends them) in these cells. NULL: both are the same. */
    void (*edge)(const struct medium *m, int quantity, int patch, int n, const struct edge_face *face, double *values);
    const int *edge_state;
    /* Is the quantity given on the patch, whatever is in the cells? Then `edge` replaces NAN, too. NULL as `edge`. */
    bool (*gives)(const struct medium *m, int quantity, int patch);
    /* Lets the medium note from the next step on what leaves it through patches; *dt is the length of the last step
     * that it noted (s), 0 before. Collective. NULL: the medium does not know it. */
    status (*follow)(struct medium *m, double *dt);
    /* Visits the faces of patches that a block of this rank has, in an order that does not depend on the ranks. */
    void (*crossings)(const struct medium *m, int block, crossing_visitor *visit, void *context);
    /* Sets *out to the changes of mass, momentum and energy since the first call, by cause, with the same columns in
     * every call. Collective. NULL: the medium keeps no such account. */
    status (*budget)(struct medium *m, struct budget_row *out);
    /* Sets *out to the grains, which the caller frees; n = 0: there are none to be written. On the root. NULL: the
     * medium has no grains. */
    status (*cloud)(const struct medium *m, struct cloud *out);
    /* Writes what a restart needs besides fields into the folder of a time. On the root. NULL: fields are enough. */
    status (*save)(const struct medium *m, const char *folder, const char *location, struct checksums *sums);
    /* Writes what such a restart needs of cells into the folder of a time, and adds its checksums. Collective. NULL:
     * the quantities are enough. */
    status (*keep)(const struct medium *m, const struct field_writer *w, struct checksums *sums);
};
struct medium { /* the first member of each medium's own struct */
    const struct medium_type *type;
    struct setup *setup;
    struct offered fields; /* where `read` sets none: those of the type */
    double next;           /* s: step to try next, which uniform/time keeps as deltaT for a restart; 0: the last step */
    double end;            /* s: end of the next step if it is not shortened, which t + dt may miss by a bit */
    bool (*asked)(void);   /* shall this rank end the run? NULL: never */
};

extern const struct medium_type gas_medium, segregation_medium, grains_medium, dem_medium;

#endif
