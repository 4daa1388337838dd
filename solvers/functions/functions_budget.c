/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object energyBudget writes what changed the medium's mass, energy and momentum, by cause. */
#include "solvers/functions/functions_private.h"

#include <stdlib.h>

struct budget {
    FILE *file; /* on the root; opened by the first execution */
};

static status budget_make(struct function *f, struct dict *d) {
    if (f->setup->medium->type->budget) return allocate(&f->own, 1, sizeof(struct budget), "a budget");
    return dict_fail(d, "type", "%s keeps no budget by cause; granularGas does", f->setup->medium->type->application);
}

static status open_table(const struct function *f, struct budget *b, const struct budget_row *row) {
    TRY(function_open(f, f->setup->start.name, "energyBudget.dat", &b->file));
    fprintf(b->file, "# In the whole mesh; changes since the first row.\n# Time          ");
    for (int i = 0; i < row->n; i++) fprintf(b->file, "\t%s", row->title[i]);
    fprintf(b->file, "\n");
    return OK;
}

static status write_row(const struct function *f, const struct budget *b, const struct moment *now,
                        const struct budget_row *row) {
    fprintf(b->file, "%-16.12g", now->t);
    for (int i = 0; i < row->n; i++) {
        fprintf(b->file, "\t%.17g", row->value[i]);
        if (f->log) printf("%s%s %.6g", i ? "  " : "    ", row->title[i], row->value[i]);
    }
    if (f->log) printf("\n");
    return function_end_row(f, b->file);
}

static status budget_execute(struct function *f, const struct moment *now, const char *time) {
    struct budget *b = f->own;
    struct medium *m = f->setup->medium;
    struct budget_row row;
    status s = OK;
    (void)time;
    TRY(m->type->budget(m, &row));
    if (comm_root(f->setup->comm)) {
        if (!b->file) s = open_table(f, b, &row);
        if (!s) s = write_row(f, b, now, &row);
    }
    return comm_agree(f->setup->comm, s);
}

static void budget_free(void *own) {
    struct budget *b = own;
    if (b->file) fclose(b->file);
    free(b);
}

const struct function_type function_budget = {
    .name = "energyBudget",
    .about =
        "mass, energy and momentum, and what changed them: impacts, gravity, walls, open patches, floors; no `fields`",
    .make = budget_make,
    .execute = budget_execute,
    .free = budget_free,
    .no_fields = true,
};
