/* Function object energyBudget: what changed the medium's mass and energy, by cause. */
#include "solvers/functions/functions_private.h"

status budget_make(struct function *f, struct dict *d) {
    if (f->setup->medium->type->budget) return OK;
    return dict_fail(d, "type", "%s keeps no budget by cause; granularGas does", f->setup->medium->type->application);
}

static status open_table(struct function *f) {
    const char *const *titles = f->setup->medium->type->budget_titles;
    TRY(function_open(f, f->setup->start.name, "energyBudget.dat", &f->file[0]));
    fprintf(f->file[0], "# In the whole mesh; changes since the first row.\n# Time          ");
    for (int i = 0; titles[i]; i++) fprintf(f->file[0], "\t%s", titles[i]);
    fprintf(f->file[0], "\n");
    return OK;
}

static status write_row(const struct function *f, const struct moment *now, const double *row) {
    const char *const *titles = f->setup->medium->type->budget_titles;
    fprintf(f->file[0], "%-16.12g", now->t);
    for (int i = 0; titles[i]; i++) {
        fprintf(f->file[0], "\t%.17g", row[i]);
        if (f->log) printf("%s%s %.6g", i ? "  " : "    ", titles[i], row[i]);
    }
    if (f->log) printf("\n");
    if (fprintf(f->file[0], "\n") < 0 || fflush(f->file[0]))
        return fail(ERR_SYSTEM, "postProcessing/%s: cannot be written (disk full?)", f->name);
    return OK;
}

status budget_execute(struct function *f, const struct moment *now, const char *time) {
    struct medium *m = f->setup->medium;
    double row[MAX_BUDGET];
    status s = OK;
    (void)time;
    TRY(m->type->budget(m, row));
    if (comm_root(f->setup->comm)) {
        if (!f->file[0]) s = open_table(f);
        if (!s) s = write_row(f, now, row);
    }
    return comm_agree(f->setup->comm, s);
}
