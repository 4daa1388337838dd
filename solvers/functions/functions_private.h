/* What the files of solvers/functions share. A type of function object is one file, which exports its row, and an entry
 * in the table of functions.c. */
#ifndef SOLVERS_FUNCTIONS_PRIVATE_H
#define SOLVERS_FUNCTIONS_PRIVATE_H

#include "solvers/functions/functions.h"

struct function { /* what all types share */
    const struct function_type *type;
    const struct setup *setup;
    char name[128];
    struct trigger trigger;
    bool log;
    int nfields;
    int field[MAX_QUANTITIES];
    double *block_values; /* [3][largest block], for function_block */
    void *own;            /* the type's own struct: made by its make, freed by its free */
};
struct function_type {
    const char *name, *about;
    /* Reads the type's own entries and allocates f->own, which free gets even where make failed. Collective. */
    status (*make)(struct function *f, struct dict *d);
    status (*execute)(struct function *f, const struct moment *now, const char *time); /* collective */
    void (*free)(void *own);
    bool no_fields;   /* it takes no `fields` */
    bool all_fields;  /* without `fields` it takes those that the medium shows */
    bool with_fields; /* executed when the fields are written, if nothing else is said; else each step */
    /* For averages, as in functions.h; NULL: the type keeps none. */
    double (*next)(const struct function *f, double t);
    status (*collect)(struct function *f, const struct moment *before, const struct moment *now);
    status (*save)(const struct function *f, const struct field_writer *w, struct checksums *sums);
};

const struct quantity *quantity_of(const struct function *f, int field);
/* Values of a block's cells in f->block_values; lines[c] for computational axis c. */
void function_block(const struct function *f, int block, int field, double *lines[3]);
/* postProcessing/<function>/<folder>/<file>, made with its folders; on the root. */
status function_open(const struct function *f, const char *folder, const char *file, FILE **out);
/* Ends a row of a table and hands it to the system, which may have no room for it. */
status function_end_row(const struct function *f, FILE *file);

/* Points and the cells that hold them. */
struct spot {
    double x[3];
    bool inside;
    int block; /* -1: on another rank, or outside */
    int cell;  /* in the block */
};
struct spots {
    int n;
    struct spot *at; /* [n] */
};
/* Appends spots for n points; outside the mesh: an error unless allowed. Collective. */
status spots_add(struct spots *s, const struct function *f, struct dict *d, const char *key, int n,
                 const double *points, bool allow_outside);
/* A field's values at the spots on every rank: [spots][components], physical axes; malloc'd. Collective. */
status spots_sample(const struct spots *s, const struct function *f, int field, double **out);
void spots_free(struct spots *s);

#endif
