/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes totals over all grains and writes them as rows of a table (grains_table.h). */
#include "solvers/grains/grains_table.h"

#include <math.h>
#include <string.h>

struct grains_totals grains_totals(const struct grains *g, const struct grain_box *box, double mass) {
    struct grains_totals p = {.t = grains_time(g), .counts = *grains_counted(g), .impulse = grains_impulses(g)};
    const double all = fmax(mass, grains_total_mass(g));
    grains_kinds_T(g, p.kind_T);
    grains_energy(g, &p.kinetic, &p.potential, p.momentum);
    double mean = 0; /* square of the mean velocity */
    for (int k = 0; k < box->dim; k++) mean += p.momentum[k] * p.momentum[k] / (all * all);
    p.T = (2 * p.kinetic / all - mean) / box->dim;
    if (box->shear != 0) p.T = 2 * grains_thermal(g) / (all * box->dim);
    return p;
}

/* Is a patch a wall, which has columns of its own among facets? */
static bool is_wall(const struct patch *p) {
    return strcmp(p->type, "empty") != 0 && strcmp(p->type, "cyclic") != 0;
}

static status write_row(const struct grains_table *table, const struct setup *s, const struct grain_box *b,
                        const struct grains_totals *p) {
    FILE *f = table->file;
    fprintf(f, "%.17g %lld %lld %lld %lld %.17g %.17g %.17g %.17g", p->t, (long long)p->counts.pairs,
            (long long)p->counts.walls, (long long)p->counts.elastic, (long long)p->counts.events, p->T, p->kinetic,
            p->potential, p->counts.lost);
    for (int k = 0; k < b->dim; k++) fprintf(f, " %.17g", p->momentum[k]);
    for (int k = 0; k < b->dim; k++)
        if (!b->periodic[k] && !b->facets)
            fprintf(f, " %.17g %.17g", p->counts.wall_impulse[k][0], p->counts.wall_impulse[k][1]);
    if (b->shear != 0) fprintf(f, " %.17g %.17g", p->impulse[0][0], p->impulse[0][1]);
    for (int w = 0; b->facets && w < s->mesh->npatches; w++)
        for (int k = 0; is_wall(&s->mesh->patch[w]) && k < b->dim; k++) fprintf(f, " %.17g", p->impulse[w][k]);
    for (int w = 0; b->facets && b->facets->opens && w < s->mesh->npatches; w++)
        if (is_wall(&s->mesh->patch[w])) fprintf(f, " %.17g", p->impulse[s->mesh->npatches + w][0]);
    for (int w = 0; b->fed && w < s->mesh->npatches; w++)
        if (is_wall(&s->mesh->patch[w])) fprintf(f, " %.17g", p->impulse[2 * s->mesh->npatches + w][0]);
    for (int k = 0; k < table->kinds; k++) fprintf(f, " %.17g", p->kind_T[k]);
    return case_end_row("grains", f);
}

static status open_table(struct grains_table *p, const struct setup *s, const struct grain_box *b) {
    TRY(case_table(s, "grains", s->start.name, "grains.dat", &p->file));
    fprintf(p->file, "# Counts, lost energy and the impulses given to walls (outwards) are sums since the run of the "
                     "grains began;\n# the rest is of the time, in the frame of the box.\n"
                     "# Time collisions wallCollisions elastic events T kinetic potential lost");
    for (int k = 0; k < b->dim; k++) fprintf(p->file, " momentum_%c", "xyz"[s->axis[k]]);
    for (int k = 0; k < b->dim; k++)
        if (!b->periodic[k] && !b->facets)
            fprintf(p->file, " impulse_%cLow impulse_%cHigh", "xyz"[s->axis[k]], "xyz"[s->axis[k]]);
    if (b->shear != 0) fprintf(p->file, " workFlow workImpacts");
    for (int w = 0; b->facets && w < s->mesh->npatches; w++)
        for (int k = 0; is_wall(&s->mesh->patch[w]) && k < b->dim; k++)
            fprintf(p->file, " impulse_%s_%c", s->mesh->patch[w].name, "xyz"[s->axis[k]]);
    for (int w = 0; b->facets && b->facets->opens && w < s->mesh->npatches; w++)
        if (is_wall(&s->mesh->patch[w])) fprintf(p->file, " left_%s", s->mesh->patch[w].name);
    for (int w = 0; b->fed && w < s->mesh->npatches; w++)
        if (is_wall(&s->mesh->patch[w])) fprintf(p->file, " came_%s", s->mesh->patch[w].name);
    for (int k = 0; k < p->kinds; k++) fprintf(p->file, " T_%s", p->kind_name[k]);
    fprintf(p->file, "\n");
    return write_row(p, s, b, &p->start);
}

status grains_table_row(struct grains_table *p, const struct setup *s, const struct grain_box *box,
                        const struct grains_totals *now) {
    if (!p->file) TRY(open_table(p, s, box));
    return write_row(p, s, box, now);
}

void grains_table_close(struct grains_table *p) {
    if (p->file) fclose(p->file);
    p->file = NULL;
}
