/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the mesh and the walls of granularMD and makes the box in which grains move (grains_box.h). */
#include "solvers/grains/grains_box.h"

#include "libcore/models/boundary.h"

#include <math.h>
#include <string.h>

#define TWO_PI 6.28318530717958647692

status grains_box_check(const struct setup *s) {
    if (s->dim == 1)
        return fail(ERR_INPUT,
                    "%s: one axis is solved; grains are disks on two solved axes or spheres on three: let fewer "
                    "patches be of type empty",
                    s->mesh_path);
    return OK;
}

bool grains_box_open(const struct setup *s, const struct field *U, bool *open) {
    bool any = false;
    for (int p = 0; p < s->mesh->npatches; p++) {
        open[p] = boundary_find(U->patch[p].type) == boundary_find("zeroGradient");
        any = any || open[p];
    }
    return any;
}

static status check_wall(const struct setup *s, const struct grains_models *m, const struct field *U, int p) {
    const struct patch_field *q = &U->patch[p];
    const char *patch = s->mesh->patch[p].name, *file = dict_path(U->dict);
    const struct boundary_type *type = boundary_find(q->type);
    if (boundary_is_smooth(type) || (m->soft && boundary_is_wall(type))) return OK;
    if (type == boundary_find("JohnsonJacksonSlip")) return OK; /* rough */
    if (boundary_is_wall(type))
        return fail(ERR_INPUT,
                    "%s:%d: patch %s: type is %s; walls of grains are smooth or rough: use  slip;  or  "
                    "JohnsonJacksonSlip;",
                    file, q->line, patch, q->type);
    return fail(ERR_INPUT,
                "%s:%d: patch %s: type is %s; allowed are slip, symmetry, symmetryPlane, JohnsonJacksonSlip (walls), "
                "zeroGradient (grains leave), "
                "fixedValue and others that give U (grains come in) and cyclic (with patches of type cyclic)",
                file, q->line, patch, q->type);
}

static int patch_of(const struct polymesh *m, int face) {
    int p = 0;
    while (face >= m->patch[p].start + m->patch[p].nfaces) p++;
    return p;
}

/* Goes over the faces of the box at the end of axis k: sets the restitution of the first; *alike: is it that of all? */
static status look_at_side(const struct setup *s, const struct grains_models *m, const struct field *U, int k, int high,
                           double *restitution, bool *alike) {
    const struct lattice *l = s->lattice;
    int last = -1;
    long stride = 1, cells = (long)l->n[0] * l->n[1] * l->n[2];
    for (int i = 0; i < k; i++) stride *= l->n[i];
    *alike = true;
    for (long i = 0; i < cells; i++) {
        if (i / stride % l->n[k] != (high ? l->n[k] - 1 : 0)) continue;
        const int p = patch_of(s->mesh, l->face[6L * l->cell[i] + 2 * k + high]);
        if (p == last) continue;
        if (U) TRY(check_wall(s, m, U, p));
        if (last < 0) *restitution = m->restitution[p];
        *alike = *alike && m->restitution[p] == *restitution && !(m->rough[p].phi > 0);
        last = p;
    }
    return OK;
}

bool grains_box_is_full(const struct setup *s, const struct grains_models *m) {
    const struct lattice *l = s->lattice;
    bool alike = l && (long)l->n[0] * l->n[1] * l->n[2] == s->mesh->ncells;
    double restitution;
    for (int side = 0; alike && side < 2 * l->dim; side++)
        if (!l->periodic[side / 2]) (void)look_at_side(s, m, NULL, side / 2, side & 1, &restitution, &alike);
    return alike;
}

/* A sheared box is full, and cyclic along all axes. */
static status check_shear(const struct setup *s, const struct grains_models *m, const struct grain_box *b) {
    for (int k = 0; k < b->dim && m->shear != 0; k++)
        if (!b->periodic[k] || !grains_box_is_full(s, m))
            return dict_fail(m->properties, "shearRate",
                             "the mesh must be a box of equal cells, cyclic along all axes; along %c it is not",
                             "xyz"[s->axis[k]]);
    return OK;
}

static status check_forces(const struct setup *s, const struct grains_models *m, const struct grain_box *b) {
    const struct sources *g = &m->forces.source;
    for (int k = 0; k < b->dim; k++)
        if (b->periodic[k] && g->gravity[k] != 0)
            return dict_fail(m->forces.g, "value",
                             "its %c component must be 0: the box is cyclic along %c, so that grains would fall for "
                             "ever",
                             "xyz"[s->axis[k]], "xyz"[s->axis[k]]);
    if (g->knots > 0)
        return dict_fail(
            m->forces.shaking, "amplitude",
            "grains are shaken with a constant amplitude; run to the time of a change (endTime), write the "
            "new number here, and go on");
    return OK;
}

/* The space that facets bound, with the box around it. */
static status make_space(const struct setup *s, const struct grains_models *m, const struct field *U,
                         const struct grains_mesh *mesh, struct grain_box *out) {
    for (int p = 0; p < s->mesh->npatches; p++)
        if (strcmp(s->mesh->patch[p].type, "empty") != 0 && strcmp(s->mesh->patch[p].type, "cyclic") != 0)
            if (!m->open[p]) TRY(check_wall(s, m, U, p));
    for (int k = 0; k < s->dim; k++) {
        out->low[k] = mesh->low[k];
        out->high[k] = mesh->high[k];
        out->periodic[k] = mesh->periodic[k];
    }
    out->facets = mesh->facets;
    out->wall_restitution = m->restitution;
    for (int p = 0; p < s->mesh->npatches; p++)
        if (m->rough[p].phi > 0) out->rough = m->rough;
    out->seed = (uint64_t)m->seed;
    for (int p = 0; p < s->mesh->npatches; p++) out->fed = out->fed || m->feeds[p];
    return OK;
}

static status make_box(const struct setup *s, const struct grains_models *m, const struct field *U,
                       struct grain_box *out) {
    const struct lattice *l = s->lattice;
    bool alike;
    for (int k = 0; k < l->dim; k++) {
        out->low[k] = l->origin[k];
        out->high[k] = l->origin[k] + l->n[k] * l->width[k];
        out->periodic[k] = l->periodic[k];
        for (int side = 0; side < 2 && !l->periodic[k]; side++)
            TRY(look_at_side(s, m, U, k, side, &out->restitution[k][side], &alike));
    }
    return OK;
}

/* Beyond that a phase has lost its digits (grains_phase_cos), and walls move further between two times than can be
 * followed. */
static const double MOST_PHASE = 1e9; /* rad */

static status check_phase(const struct setup *s, const struct grains_models *m, const struct grain_box *box) {
    const double end = fabs(s->control->end_time), last = (isfinite(end) ? box->omega * end : 0) + fabs(box->phase);
    if (last <= MOST_PHASE || m->soft) return OK;
    return fail(ERR_INPUT,
                "%s/constant/shaking: the phase is %.3g rad at endTime, %g at most can be followed: lower "
                "frequency, phase, or endTime",
                s->dir, last, MOST_PHASE);
}

status grains_box_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                       const struct grains_mesh *mesh, struct grain_box *out) {
    const struct sources *g = &m->forces.source;
    *out = (struct grain_box){.dim = s->dim};
    TRY(mesh ? make_space(s, m, U, mesh, out) : make_box(s, m, U, out));
    TRY(check_shear(s, m, out));
    out->shear = m->shear;
    if (g->amplitude != 0) {
        out->omega = TWO_PI * g->frequency;
        out->phase = g->phase;
        for (int k = 0; k < s->dim; k++) out->shake[k] = g->gravity[k] * g->amplitude / (out->omega * out->omega);
        TRY(check_phase(s, m, out));
    }
    return check_forces(s, m, out);
}

static void print_facets(FILE *f, const struct polymesh *m, const struct grains_models *models,
                         const struct facets *all) {
    fprintf(f, "    %-22s %d facets\n", "walls", all->own);
    for (int p = 0; p < m->npatches; p++) {
        const struct patch *patch = &m->patch[p];
        if (!strcmp(patch->type, "empty") || !strcmp(patch->type, "cyclic")) continue;
        if (models->open[p])
            fprintf(f, "    %-22s grains %s\n", patch->name, models->feeds[p] ? "come in" : "leave");
        else
            fprintf(f, "    %-22s restitution %g", patch->name, models->restitution[p]);
        if (models->rough[p].phi > 0) fprintf(f, ", %g of the impacts are diffuse", models->rough[p].phi);
        if (!models->open[p]) fprintf(f, "\n");
    }
}

void grains_box_print(FILE *f, const struct setup *s, const struct grains_models *m, const struct grain_box *b) {
    for (int k = 0; k < b->dim; k++) {
        const char axis = "xyz"[s->axis[k]];
        if (b->periodic[k])
            fprintf(f, "    %c %-20s periodic\n", axis, "");
        else if (!b->facets)
            fprintf(f, "    %c %-20s walls, restitution %g and %g\n", axis, "", b->restitution[k][0],
                    b->restitution[k][1]);
    }
    if (b->facets) print_facets(f, s->mesh, m, b->facets);
}

long grains_box_cell(const struct setup *s, const struct grains_mesh *mesh, const double x[3]) {
    const struct lattice *l = s->lattice;
    long index = 0;
    bool inside;
    if (mesh) return mesh->base.locate(&mesh->base, x, &inside);
    for (int k = l->dim; k--;) {
        double i = floor((x[k] - l->origin[k]) / l->width[k]);
        i = i < 0 ? 0 : i > l->n[k] - 1 ? l->n[k] - 1 : i;
        index = index * l->n[k] + (long)i;
    }
    return l->cell[index];
}

void grains_box_place(const struct setup *s, const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = s->centre[a];
    for (int k = 0; k < s->dim; k++) out[s->axis[k]] = x[k];
}
