/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes times: the quantities of the medium, grains and uniform/time; one time at once, whole or not at all. */
#ifndef SOLVERS_OUTPUT_H
#define SOLVERS_OUTPUT_H

#include "solvers/case/case.h"

struct output; /* remembers what it wrote, for purgeWrite and for names that differ */
/* Writes what else a restart needs into the time folder of w, and adds the checksums of its files. Collective. */
typedef status output_saver(const void *context, const struct field_writer *w, struct checksums *sums);
/* Makes the writer of a run; it calls save in each output_write, with context as first argument. */
status output_make(const struct setup *s, output_saver *save, const void *context, struct output **out);
void output_free(struct output *o);

/* Writes a time; `written` becomes NAME (on the root). Its files are complete when this returns; a thread of the root
 * then brings them to the disk as CASE/NAME while the run goes on. At most one time is on its way: the next one waits
 * behind its own files. "written: NAME" is printed when a time is on the disk. Collective. */
status output_write(struct output *o, double t, long step, double delta_t, char written[TIME_NAME]);
/* Prints that, if the time that was on its way is on the disk by now. Returns whether it could not be written, which
 * output_settle then reports. On the root. */
bool output_fails(struct output *o);
status output_settle(struct output *o); /* waits until all times are on the disk. Collective */

/* Writes a quantity into another folder, with all patches calculated: each rank its share of the cells. Collective; w
 * is the same on every rank. */
status output_quantity(const struct setup *s, const struct field_writer *w, int quantity, struct file_sum *sum);
/* The same of values of any name (components: 1, 3 or 6) that are spread over the ranks in slices. */
status output_slices(const struct field_writer *w, const struct quantity *q, const struct share *share,
                     const double *slice, struct file_sum *sum);
/* Computes a quantity in the cells of this rank, block by block: *out is [cells][components] with vectors along
 * physical axes; the caller frees it. Collective. */
status output_own(const struct setup *s, int quantity, double **out);
/* Gathers a quantity on the root, [ncells][components] with vectors along physical axes, in `out`, which has room for
 * that there. Collective. */
status output_gather(const struct setup *s, int quantity, double *out);
/* Writes a file of such values in another folder, with all patches calculated. On the root. */
status output_field(const struct setup *s, const struct field_writer *w, int quantity, const double *values);
/* The same for values of any name; components: 1, 3, or 6 of a symmetric tensor (xx xy xz yy yz zz). *sum may be
 * NULL. */
status output_values(const struct setup *s, const struct field_writer *w, const struct quantity *q,
                     const double *values, struct file_sum *sum);

#endif
