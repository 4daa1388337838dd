/* Writes limiter.dat, with a row for each step whose state had to be kept admissible (limiter.h). */
#include "solvers/gas/limiter.h"

static status open_table(struct limiter_table *l, const struct setup *s) {
    char folder[TIME_NAME + 16];
    snprintf(folder, sizeof folder, "limiter/%s", s->start.name);
    TRY(case_table(s, folder, "limiter.dat", &l->file));
    fprintf(l->file,
            "# Steps in which fluxes were limited, steps rejected and halved, or energies raised to the\n"
            "# round-off floor, by `energy`; (x y z) is a cell limited last.\n"
            "%s# Time step cells faces rejected floored energy x y z%s\n",
            l->fills ? "# At the end: cells raised to the density floor, and the mass and energy that added.\n" : "",
            l->fills ? " filled fillMass fillEnergy" : "");
    return OK;
}

static status write_row(struct limiter_table *l, const struct setup *s, const struct gas_counts *n,
                        const struct moment *now) {
    const struct gas_counts *was = &l->counts;
    if (!l->file) TRY(open_table(l, s));
    fprintf(l->file, "%.12g %ld %ld %ld %ld %ld %.6g %.8g %.8g %.8g", now->t, now->step, n->cells - was->cells,
            n->faces - was->faces, n->rejected - was->rejected, n->floored - was->floored, n->energy - was->energy,
            n->place[0], n->place[1], n->place[2]);
    if (l->fills)
        fprintf(l->file, " %ld %.12g %.12g", n->filled - was->filled, n->fill[0] - was->fill[0],
                n->fill[1] - was->fill[1]);
    fprintf(l->file, "\n");
    if (fflush(l->file)) return fail(ERR_SYSTEM, "postProcessing/limiter: cannot be written (disk full?)");
    return OK;
}

status limiter_record(struct limiter_table *l, const struct setup *s, const struct gas *g, const struct moment *now) {
    const struct gas_counts n = gas_counts(g), *was = &l->counts;
    if (n.cells == was->cells && n.rejected == was->rejected && n.floored == was->floored) return OK;
    status e = comm_root(s->comm) ? write_row(l, s, &n, now) : OK;
    l->counts = n;
    return comm_agree(s->comm, e);
}

void limiter_close(struct limiter_table *l) {
    if (l->file) fclose(l->file);
    l->file = NULL;
}
