/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes run.dat (runtable.h). */
#include "solvers/output/runtable.h"

/* Prints words as one. */
static void print_word(FILE *f, const char *words) {
    for (const char *c = words; *c; c++) fputc(*c == ' ' || *c == '\t' ? '_' : *c, f);
}

/* Returns the number of parts that have columns. */
static int find_parts(const struct run_table_file *table, const struct medium *m,
                      struct part_seconds part[PARTS_TIMED]) {
    return table->parts && m->type->seconds ? m->type->seconds(m, part) : 0;
}

static status open_table(struct run_table_file *table, const struct setup *s, const struct log_row *row) {
    struct part_seconds part[PARTS_TIMED];
    TRY(case_table(s, "run", s->start.name, "run.dat", &table->file));
    table->parts = s->control->run_table_parts;
    fprintf(table->file, "# Time\tstep\tdt\tlimiter\tCourant");
    for (int i = 0; i < row->n; i++) fprintf(table->file, "\t%s", row->title[i]);
    fprintf(table->file, "\tclockTime\tcpuTime");
    for (int i = 0, n = find_parts(table, s->medium, part); i < n; i++) {
        fprintf(table->file, "\tseconds_");
        print_word(table->file, part[i].name);
    }
    fprintf(table->file, "\n");
    return OK;
}

status run_table_row(struct run_table_file *table, const struct setup *s, const struct run_moment *now,
                     const struct log_row *row) {
    struct part_seconds part[PARTS_TIMED];
    if (!table->file) TRY(open_table(table, s, row));
    FILE *f = table->file;
    fprintf(f, "%.15g\t%ld\t%.15g\t", now->t, now->step, now->dt);
    print_word(f, now->limit);
    fprintf(f, "\t%.6g", now->courant);
    for (int i = 0; i < row->n; i++) fprintf(f, "\t%.15g", row->value[i]);
    fprintf(f, "\t%.3f\t%.3f", now->clock, now->cpu);
    for (int i = 0, n = find_parts(table, s->medium, part); i < n; i++) fprintf(f, "\t%.3f", part[i].seconds);
    return case_end_row("run", f);
}
