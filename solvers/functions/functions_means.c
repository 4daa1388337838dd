/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What averages over time share: which fields are weighted by the density, lines of the cells of a rank, and the file
 * of their sums in a time folder, from which a restart goes on. */
#include "solvers/functions/functions_private.h"

#include <string.h>

int means_density(const struct function *f) {
    return quantity_named(&f->setup->medium->fields, "rho");
}

int means_weight(const struct function *f, int field, struct means_weights *w) {
    const char *name = quantity_of(f, field)->name, *kind = strchr(name, '.');
    const size_t length = kind ? (size_t)(kind - name) : strlen(name);
    char own[64];
    int i = 0;
    if (strncmp(name, "U", length) != 0 && strncmp(name, "T", length) != 0 &&
        (kind || strcmp(name, "TComponents") != 0))
        return -1;
    snprintf(own, sizeof own, "alpha%s", kind ? kind : "");
    const int weight = kind ? quantity_named(&f->setup->medium->fields, own) : means_density(f);
    if (weight < 0) return -1;
    while (i < w->n && w->quantity[i] != weight) i++;
    w->quantity[i] = weight;
    if (i == w->n) w->n++;
    return i;
}

status means_cells_make(const struct function *f, struct means_cells *out) {
    const struct grid *grid = f->setup->grid;
    *out = (struct means_cells){.largest = 1};
    TRY(pool_take(f->pool, &out->first, grid->nblocks + 1, sizeof *out->first, "averages"));
    for (int b = 0; b < grid->nblocks; b++) {
        out->first[b] = out->n;
        out->n += grid->block[b].ncells;
        if (grid->block[b].ncells > out->largest) out->largest = grid->block[b].ncells;
    }
    return OK;
}

status means_file(const struct function *f, struct dict *d, char file[128]) {
    if (snprintf(file, 128, "uniform/%s.%s", f->type->name, f->name) < 90) return OK;
    return fail(ERR_INPUT, "%s: the name '%s' is too long for a file of its sums; give it a shorter one", dict_path(d),
                f->name);
}

status means_open(const struct field_writer *w, const char *file, struct foam_format *exact, struct sink **out) {
    char path[2 * TIME_PATH], location[TIME_NAME + 16];
    *exact = (struct foam_format){w->format->binary, w->format->compress, 17};
    snprintf(path, sizeof path, "%s/%s", w->folder, file);
    snprintf(location, sizeof location, "%s/uniform", w->location);
    TRY(sink_open(path, exact->compress, out));
    foam_header_write(*out, exact, "dictionary", location, file + strlen("uniform/"), NULL);
    return OK;
}

status means_read(const struct function *f, const char *file, struct dict **out) {
    char path[2 * TIME_PATH];
    *out = NULL;
    snprintf(path, sizeof path, "%s/%s/%s", f->setup->dir, f->setup->start.folder, file);
    return field_exists(path) ? dict_read(path, out) : OK;
}

status means_list(struct dict *d, const char *key, long size, double **out) {
    struct lexer l;
    struct token t;
    long n;
    TRY(dict_raw(d, key, &l));
    TRY(lexer_next(&l, &t));
    TRY(lexer_next(&l, &t));
    TRY(foam_list_read_doubles(&l, dict_header(d), 1, size, &n, out));
    return n == size ? OK : dict_fail(d, key, "it holds %ld numbers, not %ld", n, size);
}
