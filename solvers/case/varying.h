/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of one patch of a field by a rule: expressions in x, y, z, t at the centres of its faces, a function of time,
 * or the rate of a flow through it. They may change in time or from face to face.
 *
 *     fixedValue inletOutlet JohnsonJacksonSlip   expression "..", of a vector ("..", "..", ".."), beside their values
 *     translatingWallVelocity                     the same beside U; or U is  table ((t (ux uy uz)) ..)
 *     rotatingWallVelocity                        omega (rad/s), a function of time or an expression of t, with origin
 *                                                 and axis; so may JohnsonJacksonSlip and frictionalSlip, in U
 *     uniformFixedValue uniformInletOutlet        a constant or  table ((t v) ..), linear in between, constant outside
 *     exprFixedValue                              valueExpr "..", in OpenFOAM's grammar (solvers/dict/expr.h)
 *     flowRateInletVelocity                       massFlowRate (kg/s) or volumetricFlowRate (m^3/s), >= 0, as a
 * function of time
 *
 * The values of flowRateInletVelocity are rho u, the same mass per area on each face along its normal, or u. */
#ifndef SOLVERS_VARYING_H
#define SOLVERS_VARYING_H

#include "libcore/models/boundary.h"
#include "mesh/format/polymesh.h"
#include "solvers/dict/dict.h"
#include "solvers/dict/keywords.h"

/* Goes through the keywords of rules that a type may have (k->only, for U alone, is left changed); writes to an entry
 * of the type what its value needs besides. */
void varying_keywords(struct keywords *k, const struct boundary_type *type);
void varying_entry(char entry[KEYWORD_TEXT], const struct boundary_type *type);

struct varying;
/* Reads what a patch of a field with that number of components gives besides its type; *out is NULL if that is none of
 * the above. The dictionary must live as long as *out. */
status varying_read(struct dict *d, int components, const struct boundary_type *type, const struct polymesh *m,
                    int patch, struct varying **out);
void varying_free(struct varying *v);

bool varying_in_time(const struct varying *v);
bool varying_in_space(const struct varying *v);              /* else all faces have one value */
bool varying_leads(const struct varying *v, int x);          /* may component x be other than 0? */
bool varying_alike(const struct varying *v, long a, long b); /* are two faces the same at any time? */
/* May a velocity lead through a face of the patch at some time? May it lead along one? May it be 0 at one? */
struct varying_lead {
    bool through, along, still;
};
/* Notes the velocity u (m/s) at a face of that unit normal. */
void varying_lead_note(struct varying_lead *lead, const double u[3], const double normal[3]);
struct varying_lead varying_lead(const struct varying *v);
bool varying_is_volumetric(const struct varying *v); /* is it a flowRateInletVelocity that gives u? */
const char *varying_key(const struct varying *v);    /* the entry that gives the rule */
/* Returns the first time of a table after t, beyond round-off; HUGE_VAL: there is none. */
double varying_knot(const struct varying *v, double t);
/* Computes the values at time t: out[faces if varying_in_space, else 1][components]. */
void varying_at(const struct varying *v, double t, double *out);
struct varying_range { /* what values may be */
    double low, high;  /* both excluded */
    char allowed[300]; /* "be greater than 0" */
};
/* Checks values of time t: none beyond MOST_NUMBER, of scalars within the range, along the wall of walls, rates of a
 * flow not negative. The error, of the kind given, names file, line, patch, face and time. */
status varying_check(const struct varying *v, double t, const double *values, const struct varying_range *range,
                     enum status_kind kind);
/* Checks the values at each time of a table; the values in between, which are linear, are then right, too. */
status varying_check_table(const struct varying *v, const struct varying_range *range);
/* Prints the entry as it was given; numbers have all digits. */
void varying_print(struct sink *s, const struct varying *v);

#endif
