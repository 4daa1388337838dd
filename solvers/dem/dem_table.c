/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the table of soft grains (dem_table.h). */
#include "solvers/dem/dem_table.h"

static status open_table(struct dem_table *p, const struct dem_run *r) {
    const struct setup *s = r->setup;
    const struct dem_walls *w = &r->walls;
    TRY(case_table(s, "grains", s->start.name, "grains.dat", &p->file));
    fprintf(p->file,
            "# Energies (J) of the time, relative to the box; what dampers and friction took since the run of the "
            "grains began,\n# by the powers at the samples; forces (N) on the walls at that time.\n"
            "# Time grains contacts T kinetic spin potential normalSpring tangentSpring lostNormal "
            "lostTangential lostFriction wallWork");
    for (int k = 0; k < w->dim; k++) fprintf(p->file, " momentum_%c", "xyz"[s->axis[k]]);
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k < w->dim; k++)
            fprintf(p->file, " force%d_%s_%c", i, s->mesh->patch[w->wall[i].patch].name, "xyz"[s->axis[k]]);
    fprintf(p->file, "\n");
    return OK;
}

status dem_table_row(struct dem_table *p, const struct dem_run *r) {
    const struct dem_sums *s = &r->sums;
    const struct dem_walls *w = &r->walls;
    if (!p->file) TRY(open_table(p, r));
    fprintf(p->file, "%.17g %d %ld", r->moment_t, s->n, s->contacts);
    const double row[] = {s->T,
                          s->kinetic,
                          s->spin,
                          s->potential,
                          s->normal_spring,
                          s->tangent_spring,
                          r->account.normal,
                          r->account.tangent,
                          dem_run_friction(r),
                          r->account.work};
    for (int i = 0; i < (int)(sizeof row / sizeof *row); i++) fprintf(p->file, " %.17g", row[i]);
    for (int k = 0; k < w->dim; k++) fprintf(p->file, " %.17g", s->momentum[k]);
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k < w->dim; k++) fprintf(p->file, " %.17g", s->force[i][k]);
    return case_end_row("grains", p->file);
}

void dem_table_close(struct dem_table *p) {
    if (p->file) fclose(p->file);
    p->file = NULL;
}
