/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object energyBudget writes what changed the medium's mass, energy and momentum, by cause. */
#include "solvers/functions/functions_private.h"

static status budget_make(struct function *f, struct dict *d) {
    if (f->setup->medium->type->budget) return OK;
    return dict_fail(d, "type", "%s keeps no budget by cause; granularGas does", f->setup->medium->type->application);
}

static void budget_head(const struct function *f, int i, FILE *o) {
    const struct budget_row *row = f->own;
    (void)i;
    fprintf(o, "# In the whole mesh; changes since the first row.\n# Time          ");
    for (int k = 0; k < row->n; k++) fprintf(o, "\t%s", row->title[k]);
    fprintf(o, "\n");
}

static status write_row(struct function *f, double t) {
    const struct budget_row *row = f->own;
    FILE *o;
    TRY(function_row(f, 0, t, &o));
    for (int i = 0; o && i < row->n; i++) {
        function_value(o, '\t', 17, 1, &row->value[i]);
        if (f->log) printf("%s%s %.6g", i ? "  " : "    ", row->title[i], row->value[i]);
    }
    if (o && f->log) printf("\n");
    return function_end_row(f, o);
}

static status budget_execute(struct function *f, const struct moment *now, const char *time) {
    struct medium *m = f->setup->medium;
    (void)time;
    TRY(m->type->budget(m, f->own));
    return comm_agree(f->setup->comm, write_row(f, now->t));
}

const struct function_type function_budget = {
    .name = "energyBudget",
    .about =
        "mass, energy and momentum, and what changed them: impacts, gravity, walls, open patches, floors; no `fields`",
    .size = sizeof(struct budget_row),
    .make = budget_make,
    .execute = budget_execute,
    .table = {"energyBudget.dat"},
    .head = budget_head,
    .width = 16,
    .no_fields = true,
};
