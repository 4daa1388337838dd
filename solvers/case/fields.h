/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One field file of a time folder (volScalarField, volVectorField): values in the cells and a rule per patch. */
#ifndef SOLVERS_FIELDS_H
#define SOLVERS_FIELDS_H

#include "libcore/models/param.h"
#include "mesh/base/share.h"
#include "mesh/format/polymesh.h"
#include "mesh/spread/spread.h"
#include "solvers/case/varying.h"
#include "solvers/dict/keywords.h"

enum field_id { FIELD_RHO, FIELD_ALPHA, FIELD_U, FIELD_T, FIELD_P, FIELD_COUNT };
struct field_kind {
    const char *name;
    int components;            /* 1 or 3 */
    signed char dimensions[7]; /* kg m s K mol A cd */
    const char *about;
    /* patch types that it takes besides empty and cyclic, ended by NULL; NULL: those of boundary.h */
    const char *const *types;
    bool varies; /* may values of these types follow rules in time and place? */
};
extern const struct field_kind field_kinds[FIELD_COUNT];

struct patch_field {
    const char *type;         /* owned by the dictionary */
    struct own_params params; /* parameters of the type, vectors along physical axes, as the table of boundary.h asks */
    double uniform[3];        /* the `value` or `inletValue`, if the type needs one and it is uniform */
    double *values;           /* [faces][components] the same if it is not uniform; else NULL */
    int line, value_line;     /* lines of the file: of the type; of its values or first parameter */
    struct varying *varying;  /* the rule that gave params, uniform or values at the last time; NULL: there is none */
};
/* The effect of a program's own entries on the values of the cells, after field_read. */
struct field_plan {
    bool changes;      /* the values will not be those that `expression` or internalField gives */
    const char *fills; /* the entry that gives all of them, so that internalField may be missing; or NULL */
};
struct field {
    const struct field_kind *kind;
    struct dict *dict;
    struct field_plan plan;
    double *values; /* [cells that are read][components] */
    int npatches;
    struct patch_field *patch;  /* [npatches] */
    struct varying_range range; /* of scalars on patches: any, or from field_check_range */
};

/* The mesh, geometry and time (for expressions) that a field is read for, and the cells whose values are read. */
struct field_place {
    const struct polymesh *mesh;
    const double *centre;        /* [ncells of the mesh][3] m; NULL: those of the mesh's boxes or sites */
    double t;                    /* s */
    const struct share *share;   /* the cells of this rank's slice; NULL: every rank reads all cells */
    const struct spread *spread; /* has the centres of that slice where the mesh is spread over the ranks; else NULL */
};
long field_first(const struct field_place *at);  /* the first of the cells that are read */
long field_ncells(const struct field_place *at); /* how many follow one another from there on */
/* Returns the error of one rank on all ranks that read slices (comm_agree): what reads them calls it before the next
 * message is sent. */
status field_agree(const struct field_place *at, status mine);

#define FIELD_FILES "0.orig/alpha, 0.orig/rho, 0.orig/U, 0.orig/T, 0.orig/p"
/* Goes through the keywords of a field's file, or of several alike, with the boundary conditions that are offered
 * (NULL: all). */
struct boundary_type;
const char *boundary_fields(const struct boundary_type *b); /* "scalars, U": which fields may have it */
void fields_keywords(struct keywords *k, const char *file, bool (*offered)(const struct boundary_type *b));

void field_centre(const struct field_place *at, long cell, double x[3]); /* the centre of a cell, m */

/* Is there a file PATH or PATH.gz? */
bool field_exists(const char *path);
/* Reads a field and checks dimensions, sizes, finite values, that each patch and nothing else has an entry, the
 * constraint types in both directions, and types unknown or not allowed for the field. A top-level entry `expression
 * "..."` (vector: three of them in parentheses) wins over internalField. */
status field_read(const char *path, const struct field_kind *kind, const struct field_place *place, struct field **out);
/* Reads a field for a program that gives entries of its own a meaning (as granularGas does settledLayer): `read` takes
 * them from the file's dictionary before the cells' values are read, and says their effect in *plan. */
typedef status field_reader(void *context, struct dict *d, struct field_plan *plan);
status field_read_with(const char *path, const struct field_kind *kind, const struct field_place *place,
                       field_reader *read, void *context, struct field **out);
void field_free(struct field *f);
void field_drop_cells(struct field *f); /* frees the values of the cells, and the text of the file */
/* Reads only the cells' values, of any field whose class is volScalarField or volVectorField; *components is 1 or 3,
 * *out is [ncells][components]. field_read_slice reads those of a slice (NULL: of all). */
status field_read_values(const char *path, int ncells, int *components, double **out);
status field_read_slice(const char *path, int ncells, const struct share *share, int *components, double **out);

/* Is the field given by an expression alone, so that it can be evaluated anywhere? */
bool field_has_expression(const struct field *f);
/* Evaluates such a field at points[npoints][3] (m) and time t: out[npoints][components]. */
status field_evaluate(const struct field *f, long npoints, const double *points, double t, double *out);

/* Checks that every value of cells and patches lies within low .. high, both excluded, those of a table at all times.
 * The error names file, line, cell and place, and ends with the cure if there is a greatest value. cure NULL: both ends
 * are allowed. */
status field_check_range(struct field *f, const struct field_place *place, double low, double high, const char *cure);

/* Gives a patch whose values follow a rule those of time t, and checks them; the error is of the kind given. */
status field_renew(struct field *f, int patch, double t, enum status_kind kind);
/* Fails on a patch whose values change in time, for programs that take them once. */
status field_steady(const struct field *f, const struct polymesh *m);

/* Returns the error "FILE:LINE: cell 7 at (x y z): T is -1; <format...>" of number i of the cells that are read. */
status field_fail(const struct field *f, const struct field_place *place, long i, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Writes a field with a boundaryField entry for each patch. values: [ncells][components]; print(patch) writes what
 * stands between the braces of an entry; location is the folder's name; *sum gets size and checksum of the file. */
struct field_writer {
    const struct polymesh *mesh;
    const struct foam_format *format;
    const char *folder, *location;
};
/* Returns the name of an item of 1, 3 or 6 components: scalar, vector, symmTensor. */
const char *field_item(int components);
typedef void patch_printer(struct sink *s, const struct field_writer *w, int patch, const void *context);
status field_write(const struct field_writer *w, const char *name, int components, const signed char dimensions[7],
                   const double *values, patch_printer *print, const void *context, struct file_sum *sum);
/* The same where the values of the cells are spread over the ranks in slices. `prepare`, which every rank calls, makes
 * ready on the root what `print` needs of a patch. Collective. */
typedef status patch_preparer(const struct field_writer *w, int patch, void *context);
struct patch_entries {
    patch_preparer *prepare;
    patch_printer *print;
    void *context; /* of both */
};
status field_write_shared(const struct field_writer *w, const char *name, int components,
                          const signed char dimensions[7], const struct share *share, const double *slice,
                          const struct patch_entries *entries, struct file_sum *sum);

#endif
