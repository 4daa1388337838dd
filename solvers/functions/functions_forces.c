/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object forces writes force and moment on patches, by pressure and by viscous stress, in the files force.dat
 * and moment.dat of OpenFOAM. A force is what the last step took out of the gas by its own fluxes, over the length of
 * the step, so that the sum of force times dt is the momentum that the gas has lost, to round-off. */
#include "solvers/functions/functions_patches.h"

struct force_table {
    struct patch_choice patches;
    double centre[3], pressure; /* m, Pa */
};

static const char *const rho_words[] = {"rho", NULL}, *const p_words[] = {"p", NULL}, *const U_words[] = {"U", NULL},
                         *const no_words[] = {"no", "off", "false", NULL};
#define PARAM_STRUCT struct force_table
static const struct param forces_param[] = {
    NOTED("patches", "list of words", NULL, "names, groups, or quoted regular expressions", "patches (\".*\");"),
    VECTOR("CofR", centre, REQUIRED, ANY_NUMBER, UNIT(0, 1, 0), "the point that moments are taken about"),
    NUMBER("pRef", pressure, 0, ANY_NUMBER, UNIT(1, -1, -2), "a uniform pressure whose force is left out"),
    ONLY("rho", 0, rho_words, "the gas has its own density: rhoInf is not used"),
    ONLY("p", 0, p_words, "the pressure on the faces, as the step had it"),
    ONLY("U", 0, U_words, "of the gas"),
    ONLY("porosity", 0, no_words, "there are no porous media"),
    ONLY("directForceDensity", 0, no_words, "the force is what the step took out of the gas"),
    IGNORED("rhoInf", "for OpenFOAM's incompressible solvers"),
};

static status forces_make(struct function *f, struct dict *d) {
    struct force_table *o = f->own;
    return patches_read(f, d, "patches", &o->patches);
}

/* Says the depth, or the section, of a mesh that does not resolve all axes, in a line that is empty in OpenFOAM's
 * files: the forces are those on it. */
static void print_depth(const struct function *f, FILE *file) {
    const struct setup *s = f->setup;
    double low[3], high[3], depth = 1;
    polymesh_bounds(s->mesh, low, high);
    for (int k = s->dim; k < 3; k++) depth *= high[s->axis[k]] - low[s->axis[k]];
    if (s->dim == 3)
        fprintf(file, "# \n");
    else
        fprintf(file, "# %-12s: %.12g\n", s->dim == 2 ? "thickness" : "section", depth);
}

static void forces_head(const struct function *f, int i, FILE *o) {
    static const char *const titles[] = {"Force", "Moment"};
    const double *centre = ((const struct force_table *)f->own)->centre;
    fprintf(o, "# %s\n# %-12s: (%.12g %.12g %.12g)\n", titles[i], "CofR", centre[0], centre[1], centre[2]);
    print_depth(f, o);
    fprintf(o,
            "# %-12s\t(total_x total_y total_z)\t(pressure_x pressure_y pressure_z)\t(viscous_x viscous_y viscous_z)\n",
            "Time");
}

/* part: [FORCE_PARTS] */
static status write_row(struct function *f, int i, double t, double (*part)[3]) {
    double total[3];
    FILE *o;
    TRY(function_row(f, i, t, &o));
    for (int k = 0; k < 3; k++) total[k] = part[PRESSURE][k] + part[VISCOUS][k];
    function_value(o, '\t', 15, 3, total);
    for (int k = 0; k < FORCE_PARTS; k++) function_value(o, '\t', 15, 3, part[k]);
    return function_end_row(f, o);
}

static status forces_write(struct function *f, double t, struct force *all) {
    const double *p = all->force[PRESSURE], *v = all->force[VISCOUS];
    TRY(write_row(f, 0, t, all->force));
    TRY(write_row(f, 1, t, all->moment));
    if (f->log && comm_root(f->setup->comm))
        printf("    %s: pressure (%.6g %.6g %.6g) viscous (%.6g %.6g %.6g)\n", f->name, p[0], p[1], p[2], v[0], v[1],
               v[2]);
    return OK;
}

static status forces_execute(struct function *f, const struct moment *now, const char *time) {
    struct force_table *o = f->own;
    struct force all;
    double dt;
    (void)time;
    TRY(patches_follow(f, &dt));
    if (dt == 0 || function_again(f, now->t)) return OK;
    TRY(patches_force(f, &o->patches, o->centre, o->pressure, &all));
    return comm_agree(f->setup->comm, forces_write(f, now->t, &all));
}

const struct function_type function_forces = {
    .name = "forces",
    .about = "force and moment on patches by pressure and viscous stress, mean over the step; no `fields`",
    FUNCTION_PARAMS(forces_param),
    .size = sizeof(struct force_table),
    .make = forces_make,
    .execute = forces_execute,
    .table = {"force.dat", "moment.dat"},
    .head = forces_head,
    .width = 14,
    .no_fields = true,
    .of_patches = true,
};
