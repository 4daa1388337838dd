/* One field file of a time folder (volScalarField, volVectorField): values in the cells and a rule per patch. */
#ifndef SOLVERS_FIELDS_H
#define SOLVERS_FIELDS_H

#include "mesh/format/polymesh.h"
#include "solvers/dict/dict.h"

enum field_id { FIELD_RHO, FIELD_ALPHA, FIELD_U, FIELD_T, FIELD_P, FIELD_COUNT };
struct field_kind {
    const char *name;
    int components;            /* 1 or 3 */
    signed char dimensions[7]; /* kg m s K mol A cd */
    const char *about;
    const char *const *types; /* patch types it takes besides empty and cyclic, NULL ends them; NULL: boundary.h's */
};
extern const struct field_kind field_kinds[FIELD_COUNT];

struct patch_field {
    const char *type;  /* owned by the dictionary */
    double uniform[3]; /* its value, inletValue where it needs one */
    double *values;    /* [faces][components], or NULL */
    int line, value_line;
};
/* What entries of a program's own do to the values of the cells, after field_read. */
struct field_plan {
    bool changes;      /* the values will not be those that `expression` or internalField gives */
    const char *fills; /* the entry that gives all of them, so that internalField may be missing; or NULL */
};
struct field {
    const struct field_kind *kind;
    struct dict *dict;
    struct field_plan plan;
    double *values; /* [ncells][components] */
    int npatches;
    struct patch_field *patch; /* [npatches] */
};

/* What a field is read against: mesh, geometry and time (for expressions). */
struct field_place {
    const struct polymesh *mesh;
    const double *centre; /* [ncells][3] m */
    double t;             /* s */
};

/* Is there PATH or PATH.gz? */
bool field_exists(const char *path);
/* Reads and checks dimensions, sizes, finite values, one entry for each patch and none besides, the constraint types in
 * both directions, and types unknown or not allowed for the field. A top-level entry `expression "..."` (vector: three
 * of them in parentheses) wins over internalField. */
status field_read(const char *path, const struct field_kind *kind, const struct field_place *place, struct field **out);
/* The same for a program that gives entries of its own a meaning (as granularGas does settledLayer): `read` takes them
 * from the file's dictionary before the cells' values are read, and says what will come of them. */
typedef status field_reader(void *context, struct dict *d, struct field_plan *plan);
status field_read_with(const char *path, const struct field_kind *kind, const struct field_place *place,
                       field_reader *read, void *context, struct field **out);
void field_free(struct field *f);
/* The cells' values alone, of any field whose class is volScalarField or volVectorField; *components is 1 or 3. */
status field_read_values(const char *path, int ncells, int *components, double **out);

bool field_has_expression(const struct field *f); /* alone, so that it can be evaluated anywhere */
/* Of such a field the values at points[npoints][3]: out[npoints][components]. */
status field_evaluate(const struct field *f, long npoints, const double *points, double t, double *out);

/* Every value within low .. high, both excluded: else an error with file, line, cell and place. */
status field_check_range(const struct field *f, const struct field_place *place, double low, double high);

/* "FILE:LINE: cell 7 at (x y z): T is -1; <format...>" */
status field_fail(const struct field *f, const struct field_place *place, int cell, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Writing: a boundaryField entry for each patch. values: [ncells][components]; entry(patch) writes what stands between
 * the braces; location is the folder's name; sum: of what was written. */
struct field_writer {
    const struct polymesh *mesh;
    const struct foam_format *format;
    const char *folder, *location;
};
typedef void patch_printer(struct sink *s, const struct field_writer *w, int patch, const void *context);
status field_write(const struct field_writer *w, const char *name, int components, const signed char dimensions[7],
                   const double *values, patch_printer *print, const void *context, struct file_sum *sum);

#endif
