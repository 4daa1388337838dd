/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/table.h"

#include <stdlib.h>

static struct oracle_row *find_row(struct table *t, const char *scheme, int family) {
    for (int i = 0; i < t->rows; i++)
        if (t->row[i].family == family && !strcmp(t->row[i].scheme, scheme)) return &t->row[i];
    struct oracle_row *more = realloc(t->row, (size_t)(t->rows + 1) * sizeof *more);
    if (!more) abort();
    t->row = more;
    struct oracle_row *r = &t->row[t->rows++];
    *r = (struct oracle_row){.family = family, .least = 1, .relative = {-1, -1, -1}, .drift = {-1, -1, -1}};
    snprintf(r->scheme, sizeof r->scheme, "%s", scheme);
    return r;
}

static void add(struct oracle_row *r, const struct problem *p, const struct scheme *s, const struct outcome *o) {
    r->runs++;
    if (p->acoustics) {
        r->asked[p->acoustics->automatic]++;
        r->made[p->acoustics->automatic] += o->counts.beds > 0;
        r->counts.beds += o->counts.beds;
    }
    r->verdicts[o->verdict]++;
    r->steps += o->steps;
    r->cell_stages += (long)o->steps * o->cells * stepper_find(s->stepper)->stages;
    r->counts.cells += o->counts.cells;
    r->counts.faces += o->counts.faces;
    r->counts.floored += o->counts.floored;
    r->counts.rejected += o->counts.rejected;
    r->counts.halves += o->counts.halves;
    r->counts.repeated += o->counts.repeated;
    r->counts.plain += o->counts.plain;
    r->least = smaller(r->least, o->least);
    r->source = larger(r->source, o->source);
    for (int q = 0; q < CONSERVED; q++) {
        r->relative[q] = larger(r->relative[q], o->relative[q]);
        r->drift[q] = larger(r->drift[q], o->drift[q]);
    }
}

void table_add(struct table *t, const struct problem *p, const struct scheme *s, const struct outcome *o) {
    char name[128];
    bool lattice = strcmp(family_table[p->family].name, "triangles") && !p->polyhedral;
    snprintf(name, sizeof name, "%s/%s/%s/%g", s->flux, lattice ? s->reconstruct : s->polynomial, s->stepper,
             s->courant);
    add(find_row(t, name, p->family), p, s, o);
}

void table_print(FILE *f, const struct table *t) {
    fprintf(f,
            "scheme,problem,runs,finished,capped,collapsed,stated,failed,steps,cell_stages,limited_cells,limited_faces,"
            "floored,rejected,halves,repeated,plain,"
            "least_dt,mass,momentum,energy,mass_bound,momentum_bound,energy_bound,source_bound,"
            "implicit,implicit_made,automatic,automatic_made,beds\n");
    for (int i = 0; i < t->rows; i++) {
        const struct oracle_row *r = &t->row[i];
        fprintf(f, "%s,%s,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%.3g", r->scheme,
                family_table[r->family].name, r->runs, r->verdicts[FINISHED], r->verdicts[CAPPED],
                r->verdicts[COLLAPSED], r->verdicts[STATED], r->verdicts[FAILED], r->steps, r->cell_stages,
                r->counts.cells, r->counts.faces, r->counts.floored, r->counts.rejected, r->counts.halves,
                r->counts.repeated, r->counts.plain, r->least);
        for (int q = 0; q < CONSERVED; q++) fprintf(f, ",%.2g", r->relative[q]);
        for (int q = 0; q < CONSERVED; q++) fprintf(f, ",%.2g", r->drift[q]);
        fprintf(f, ",%.2g,%ld,%ld,%ld,%ld,%ld\n", r->source, r->asked[0], r->made[0], r->asked[1], r->made[1],
                r->counts.beds);
    }
}

void table_summary(FILE *f, const struct table *t) {
    long runs = 0, verdicts[VERDICTS] = {0};
    for (int i = 0; i < t->rows; i++) {
        runs += t->row[i].runs;
        for (int v = 0; v < VERDICTS; v++) verdicts[v] += t->row[i].verdicts[v];
    }
    fprintf(f,
            "%ld problems: %ld ran to their end, %ld were stopped at the bound of steps, %ld ended with a stated cause "
            "(%ld of them a collapse), %ld failed\n",
            runs, verdicts[FINISHED], verdicts[CAPPED], verdicts[COLLAPSED] + verdicts[STATED], verdicts[COLLAPSED],
            verdicts[FAILED]);
}

void table_free(struct table *t) {
    free(t->row);
}
