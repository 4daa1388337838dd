/* Written times: the quantities of the medium and uniform/time; one at a time, whole or not at all. */
#ifndef SOLVERS_OUTPUT_H
#define SOLVERS_OUTPUT_H

#include "solvers/case/case.h"

struct output; /* remembers what it wrote, for purgeWrite and for names that differ */
/* Writes what else a restart needs into the time folder of w, and adds the checksums of its files. On the root. */
typedef status output_saver(const void *context, const struct field_writer *w, struct checksums *sums);
/* save is called in each output_write; context is its first argument. */
status output_make(const struct setup *s, output_saver *save, const void *context, struct output **out);
void output_free(struct output *o);

/* Collective; the root writes CASE/NAME. written: the folder's name (on the root). */
status output_write(struct output *o, double t, long step, double delta_t, char written[TIME_NAME]);

/* One field on the root, interleaved [ncells][components] with vectors in physical axes; collective. out: room for
 * 3 ncells doubles on the root. */
status output_gather(const struct setup *s, int quantity, double *out);
/* A file of such values elsewhere, patches calculated. On the root. */
status output_field(const struct setup *s, const struct field_writer *w, int quantity, const double *values);

#endif
