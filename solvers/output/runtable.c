/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes run.dat (runtable.h). */
#include "solvers/output/runtable.h"

static status open_table(FILE **file, const struct setup *s, const struct log_row *row) {
    TRY(case_table(s, "run", s->start.name, "run.dat", file));
    fprintf(*file, "# Time\tstep\tdt\tlimiter\tCourant");
    for (int i = 0; i < row->n; i++) fprintf(*file, "\t%s", row->title[i]);
    fprintf(*file, "\tclockTime\tcpuTime\n");
    return OK;
}

/* Prints words as one. */
static void print_word(FILE *f, const char *words) {
    for (const char *c = words; *c; c++) fputc(*c == ' ' || *c == '\t' ? '_' : *c, f);
}

status run_table_row(FILE **file, const struct setup *s, const struct run_moment *now, const struct log_row *row) {
    if (!*file) TRY(open_table(file, s, row));
    FILE *f = *file;
    fprintf(f, "%.15g\t%ld\t%.15g\t", now->t, now->step, now->dt);
    print_word(f, now->limit);
    fprintf(f, "\t%.6g", now->courant);
    for (int i = 0; i < row->n; i++) fprintf(f, "\t%.15g", row->value[i]);
    fprintf(f, "\t%.3f\t%.3f", now->clock, now->cpu);
    return case_end_row("run", f);
}
