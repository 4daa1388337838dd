/* What the files of solvers/functions/functions*.c share. */
#ifndef SOLVERS_FUNCTIONS_PRIVATE_H
#define SOLVERS_FUNCTIONS_PRIVATE_H

#include "solvers/functions/functions.h"

struct spot { /* a point and the cell that holds it */
    double x[3];
    bool inside;
    int block; /* -1: on another rank, or outside */
    int cell;  /* in the block */
};
struct line { /* one entry of `sets` */
    char name[128];
    int axis;     /* 0 x, 1 y, 2 z, 3 distance, 4 xyz */
    int first, n; /* spots */
};
struct function {
    const struct function_type *type;
    const struct setup *setup;
    char name[128];
    struct trigger trigger;
    bool log;
    int nfields;
    int field[MAX_QUANTITIES];
    int operation; /* volFieldValue */
    int nspots;
    struct spot *spot;
    int nlines;
    struct line *line;
    bool ascii;                 /* vtk */
    struct vtk_grid *grid;      /* vtk, on the root */
    FILE *file[MAX_QUANTITIES]; /* root; opened by the first execution */
    double *block_values;       /* [3][largest block] */
    double *all_values;         /* vtk: root's [nfields][3 ncells] */
    struct phases *phases;      /* phaseAverage */
};
struct function_type {
    const char *name, *about;
    status (*make)(struct function *f, struct dict *d);
    status (*execute)(struct function *f, const struct moment *now, const char *time);
    bool no_fields;   /* it takes none */
    bool with_fields; /* executed when the fields are written, if nothing else is said; else each step */
    /* Of averages, as in functions.h; NULL: none. */
    double (*next)(const struct function *f, double t);
    status (*collect)(struct function *f, const struct moment *before, const struct moment *now);
    status (*save)(const struct function *f, const struct field_writer *w, struct checksums *sums);
};

const struct quantity *quantity_of(const struct function *f, int field);
/* Values of a block's cells in f->block_values; lines[c] for computational axis c. */
void function_block(const struct function *f, int block, int field, double *lines[3]);
/* postProcessing/<function>/<folder>/<file>, made with its folders; on the root. */
status function_open(const struct function *f, const char *folder, const char *file, FILE **out);
/* Appends spots for n points; outside the mesh: an error unless allowed. Collective. */
status function_place(struct function *f, struct dict *d, const char *key, int n, const double *points,
                      bool allow_outside);
/* Values at the spots on every rank: [nspots][components], physical axes; malloc'd. */
status function_sample(const struct function *f, int field, double **out);

status probes_make(struct function *f, struct dict *d);
status probes_execute(struct function *f, const struct moment *now, const char *time);
status sets_make(struct function *f, struct dict *d);
status sets_execute(struct function *f, const struct moment *now, const char *time);
status extremes_make(struct function *f, struct dict *d);
status extremes_execute(struct function *f, const struct moment *now, const char *time);
status integral_make(struct function *f, struct dict *d);
status integral_execute(struct function *f, const struct moment *now, const char *time);
status vtk_make(struct function *f, struct dict *d);
status vtk_execute(struct function *f, const struct moment *now, const char *time);
status budget_make(struct function *f, struct dict *d);
status budget_execute(struct function *f, const struct moment *now, const char *time);
status phases_make(struct function *f, struct dict *d);
status phases_execute(struct function *f, const struct moment *now, const char *time);
double phases_next(const struct function *f, double t);
status phases_collect(struct function *f, const struct moment *before, const struct moment *now);
status phases_save(const struct function *f, const struct field_writer *w, struct checksums *sums);
void phases_free(struct phases *p);

#endif
