/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of solvers/functions. A type of function object is one file, which exports its row, and an entry
 * in the table of functions.c. */
#ifndef SOLVERS_FUNCTIONS_PRIVATE_H
#define SOLVERS_FUNCTIONS_PRIVATE_H

#include "mesh/base/pool.h"
#include "solvers/dict/params.h"
#include "solvers/functions/functions.h"

struct function { /* one function object; its members are for all types */
    const struct function_type *type;
    const struct setup *setup;
    char name[128];
    const struct function *earlier; /* [nearlier] those that were made before this one */
    int nearlier;
    struct trigger trigger;
    bool enabled;      /* is it made at all? */
    bool log;          /* are results printed, too? */
    double start, end; /* s: when it writes, both included */
    int nfields;
    int field[MAX_QUANTITIES];   /* [nfields] the fields that it takes, as indices of the medium's quantities */
    bool takes[MAX_QUANTITIES];  /* which it takes at all, elsewhere than in `fields`, too */
    double *block_values;        /* [3][cells of the largest block] room for function_block */
    FILE *table[MAX_QUANTITIES]; /* on the root: its tables; opened by their first rows */
    double last;                 /* s: the last time that function_again was asked of */
    struct pool *pool;           /* has memory that lasts as long as the function objects */
    void *own;                   /* the type's own struct; NULL: it has none */
};
struct function_type {
    const char *name, *about;
    const struct param *param; /* [nparam] the type's own entries; NULL: there are none */
    int nparam;
    void (*keywords)(struct keywords *k); /* goes through those of dictionaries in it; NULL: there are none */
    long size;                            /* bytes of the type's own struct, into which `param` is read */
    /* Reads the rest of the dictionary into f->own. Collective. NULL: there is no rest. */
    status (*make)(struct function *f, struct dict *d);
    /* Writes the results at a time, whose name is for files. Collective. NULL: there are none. */
    status (*execute)(struct function *f, const struct moment *now, const char *time);
    void (*free)(void *own); /* frees what f->own holds elsewhere than in f->pool, even if make failed; NULL: nothing */
    /* The tables that it writes: files postProcessing/<function>/<start>/<table>, NULL: one for each field, by its
     * name. head prints the lines in front of the rows of table i (NULL: there are none); rows begin with the time, in
     * so many characters. */
    const char *table[2];
    void (*head)(const struct function *f, int i, FILE *o);
    int width;
    bool no_fields;   /* does it do without `fields`? */
    bool of_patches;  /* does it need a medium that knows what leaves it through patches? */
    bool all_fields;  /* does it take the fields that the medium shows, if it has no `fields`? */
    bool reads_times; /* does it read the times that are written? */
    bool with_fields; /* is it executed when the fields are written, if nothing else is said? Else after each step */
    /* The hooks of averages, as functions_next, functions_prepare, functions_collect and functions_save; NULL: the type
     * keeps none. next returns its first moment after t; prepare is called at the start of a step that reaches it. */
    double (*next)(const struct function *f, double t);
    status (*prepare)(const struct function *f);
    status (*collect)(struct function *f, const struct moment *before, const struct moment *now);
    status (*save)(const struct function *f, const struct field_writer *w, struct checksums *sums);
};

#define FUNCTION_PARAMS(table) .param = table, .nparam = sizeof(table) / sizeof *(table)
#define FUNCTION_FILE          "system/controlDict"
#define FUNCTION_DICT          "functions/NAME"

/* The index of a quantity among the fields that function objects know; -1: there is none. */
int quantity_named(const struct offered *m, const char *name);
const struct quantity *quantity_of(const struct function *f, int field);
/* Notes that a function object takes a quantity, which is then ready whenever it collects or executes; fails if the
 * case has none such, by the entry `key`. */
status function_take(struct function *f, const struct dict *d, const char *key, int quantity);
/* Does that for the quantity that a word of `key` names; the error suggests one. */
status function_field(struct function *f, const struct dict *d, const char *key, const char *word, int *out);
/* Reads the list `key` of such words into f->field. */
status function_fields(struct function *f, struct dict *d, const char *key);
/* Computes the values of a block's cells in f->block_values; lines[c] are those along computational axis c. */
void function_block(const struct function *f, int block, int field, double *lines[3]);
/* Does that or, where all cells of the block have the same value, to the bit, computes one value only. Returns the
 * number of values: that of the cells, or 1. */
int function_values(const struct function *f, int block, int field, double *lines[3]);
/* Checks the key `name` of a dictionary, which names a file or a folder below postProcessing/: it must not lead out. */
status function_name(struct dict *d, const char *name);
/* Opens postProcessing/<function>/<folder>/<file>, and makes its folders. On the root. */
status function_open(const struct function *f, const char *folder, const char *file, FILE **out);
/* Shared by averages (functions_means.c): the quantities that weigh others. U and T, which are per unit mass, are
 * weighted by rho, those of one kind of grains (U.big) by the alpha of that kind. */
struct means_weights {
    int n, quantity[MAX_QUANTITIES];
};
int means_density(const struct function *f); /* the quantity rho; -1: the medium has none */
/* Returns the place in w of the quantity that weighs `field`, which is added if need be; -1: none does. */
int means_weight(const struct function *f, int field, struct means_weights *w);
struct means_cells { /* the cells of this rank, of which averages keep lines, block after block */
    long n, largest; /* largest: cells of the largest block, at least 1 */
    long *first;     /* [blocks] the block's first cell among them */
};
status means_cells_make(const struct function *f, struct means_cells *out);
/* Sets `file` to uniform/<type>.<function>, the file of the sums in a time folder. */
status means_file(const struct function *f, struct dict *d, char file[128]);
/* Opens that file in the folder that w writes, with its header; numbers have all digits: *exact. On the root. */
status means_open(const struct field_writer *w, const char *file, struct foam_format *exact, struct sink **out);
/* Reads the file in the folder of the start; *out = NULL: there is none. On the root. */
status means_read(const struct function *f, const char *file, struct dict **out);
/* Reads a list of `size` numbers, which was written as such; *out is malloc'd. */
status means_list(struct dict *d, const char *key, long size, double **out);
/* Begins a row of table i. *out is NULL on the other ranks, for which function_value and function_end_row do nothing.
 */
status function_row(struct function *f, int i, double t, FILE **out);
/* Prints a number, or a vector (x y z), with that number of digits, behind a blank or a tab. */
void function_value(FILE *o, char blank, int digits, int components, const double *v);
/* Ends a row of a table and hands it to the system; fails if that has no room for it. */
status function_end_row(const struct function *f, FILE *o);
/* Was the last call for this time, too? */
bool function_again(struct function *f, double t);

struct pick { /* a cell of this rank whose value is wanted */
    int block, cell, slot;
};
struct picks { /* of all ranks, for `slots` values that every rank gets */
    int slots, n;
    struct pick *pick; /* [n] of this rank, block by block */
};
/* Picks the cells that have slots: slot_of[cell of the mesh] >= 0. */
status picks_make(const struct function *f, int slots, const int *slot_of, struct picks *out);
/* Gathers a quantity's values on every rank: out[slots][components], along physical axes. Collective. */
void picks_gather(const struct picks *p, const struct function *f, int quantity, double *out);

struct spot {    /* a point and the cell that holds it */
    double x[3]; /* m */
    bool inside; /* is it in the mesh? */
    int block;   /* block of this rank; -1: the point is on another rank, or outside */
    int cell;    /* index in the block */
};
enum { MOST_SPOTS = 1000000 }; /* of one function object */
struct spots {
    int n;
    struct spot *at;          /* [n] */
    struct spots_linear *fit; /* NULL: values are those of the cells that hold the spots */
};
/* Appends spots for n points. A point outside the mesh is an error unless allowed. Collective. */
status spots_add(struct spots *s, const struct function *f, struct dict *d, const char *key, int n,
                 const double *points, bool allow_outside);
/* Lets spots_sample give values that are linear in the simplices of cells (mesh/grid/vicinity.h), when all spots are
 * there. Collective. */
status spots_interpolate(struct spots *s, const struct function *f);
/* Gathers a field's values at the spots on the root: [spots][components], along physical axes; malloc'd on all ranks.
 * Collective. */
status spots_sample(const struct spots *s, const struct function *f, int field, double **out);
void spots_free(struct spots *s);
extern const char *const spot_schemes[]; /* values of interpolationScheme: */
enum { SPOT_CELL, SPOT_CELL_POINT };

#endif
