/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads uniform/totals (totals.h). */
#include "solvers/output/totals.h"

#define FILE_NAME "uniform/totals"

status totals_save(const struct first_total *first, int n, const char *folder, const char *location,
                   struct checksums *sums) {
    const struct foam_format ascii = {.precision = 17};
    char path[2 * TIME_PATH], where[TIME_NAME + 16];
    struct file_sum sum;
    struct sink *o;
    snprintf(path, sizeof path, "%s/" FILE_NAME, folder);
    snprintf(where, sizeof where, "%s/uniform", location);
    TRY(sink_open(path, false, &o));
    foam_header_write(o, &ascii, "dictionary", where, "totals", "at the start of the case, for the changes in the log");
    for (int i = 0; i < n; i++) sink_printf(o, "%-15s %.17g;\n", first[i].name, first[i].value);
    TRY(sink_close_sum(o, &sum));
    return checksums_add(sums, FILE_NAME, sum);
}

static status read_totals(const char *path, struct first_total *first, int n) {
    struct dict *d = NULL;
    status e = dict_read(path, &d);
    for (int i = 0; !e && i < n; i++) {
        e = dict_number(d, first[i].name, NULL, &first[i].value);
        if (!e && first[i].value < 0) e = dict_fail(d, first[i].name, "it is not negative; remove the file");
    }
    if (!e) e = dict_check_used(d);
    dict_free(d);
    return e;
}

status totals_resume(const struct setup *s, struct first_total *first, int n) {
    char path[2 * TIME_PATH];
    snprintf(path, sizeof path, "%s/%s/" FILE_NAME, s->dir, s->start.folder);
    status e = comm_root(s->comm) && field_exists(path) ? read_totals(path, first, n) : OK;
    TRY(comm_agree(s->comm, e));
    for (int i = 0; i < n; i++) comm_broadcast(s->comm, &first[i].value, sizeof first[i].value);
    return OK;
}
