/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object forces writes force and moment on patches, by pressure and by viscous stress, in the files force.dat
 * and moment.dat of OpenFOAM. A force is what the last step took out of the gas by its own fluxes, over the length of
 * the step, so that the sum of force times dt is the momentum that the gas has lost, to round-off. */
#include "solvers/functions/functions_patches.h"

#include <stdlib.h>

struct forces {
    struct patch_choice patches;
    double centre[3], pressure; /* m, Pa */
    double written;             /* s: time of the last row */
    FILE *file[2];              /* force and moment; on the root, opened by the first row */
};

static const char *const rho_words[] = {"rho", NULL}, *const p_words[] = {"p", NULL}, *const U_words[] = {"U", NULL},
                         *const no_words[] = {"no", "off", "false", NULL};
#define PARAM_STRUCT struct forces
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
    struct forces *o;
    if (!f->setup->medium->type->follow)
        return dict_fail(d, "type", "%s knows no forces on patches; granularGas does",
                         f->setup->medium->type->application);
    TRY(allocate(&o, 1, sizeof *o, "forces"));
    f->own = o;
    o->written = -HUGE_VAL;
    TRY(params_read(d, f->type->param, f->type->nparam, o));
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

static status open_table(const struct function *f, struct forces *o, int i) {
    static const char *const files[] = {"force.dat", "moment.dat"}, *const titles[] = {"Force", "Moment"};
    TRY(function_open(f, f->setup->start.name, files[i], &o->file[i]));
    fprintf(o->file[i], "# %s\n# %-12s: (%.12g %.12g %.12g)\n", titles[i], "CofR", o->centre[0], o->centre[1],
            o->centre[2]);
    print_depth(f, o->file[i]);
    fprintf(o->file[i], "# %-12s", "Time");
    fprintf(o->file[i], "\t(total_x total_y total_z)\t(pressure_x pressure_y pressure_z)\t(viscous_x viscous_y "
                        "viscous_z)\n");
    return OK;
}

static status write_row(const struct function *f, FILE *file, double t, double part[FORCE_PARTS][3]) {
    double total[3];
    for (int k = 0; k < 3; k++) total[k] = part[PRESSURE][k] + part[VISCOUS][k];
    const double *const columns[] = {total, part[PRESSURE], part[VISCOUS]};
    fprintf(file, "%-14.12g", t);
    for (int i = 0; i < 3; i++) fprintf(file, "\t(%.15g %.15g %.15g)", columns[i][0], columns[i][1], columns[i][2]);
    return function_end_row(f, file);
}

static status forces_write(struct function *f, double t, struct force *all) {
    struct forces *o = f->own;
    for (int i = 0; i < 2; i++) {
        if (!o->file[i]) TRY(open_table(f, o, i));
        TRY(write_row(f, o->file[i], t, i ? all->moment : all->force));
    }
    if (f->log)
        printf("    %s: pressure (%.6g %.6g %.6g) viscous (%.6g %.6g %.6g)\n", f->name, all->force[PRESSURE][0],
               all->force[PRESSURE][1], all->force[PRESSURE][2], all->force[VISCOUS][0], all->force[VISCOUS][1],
               all->force[VISCOUS][2]);
    return OK;
}

static status forces_execute(struct function *f, const struct moment *now, const char *time) {
    struct forces *o = f->own;
    struct force all;
    double dt;
    (void)time;
    TRY(patches_follow(f, &dt));
    if (dt == 0 || now->t == o->written) return OK;
    o->written = now->t;
    TRY(patches_force(f, &o->patches, o->centre, o->pressure, &all));
    return comm_agree(f->setup->comm, comm_root(f->setup->comm) ? forces_write(f, now->t, &all) : OK);
}

static void forces_free(void *own) {
    struct forces *o = own;
    for (int i = 0; i < 2; i++)
        if (o->file[i]) fclose(o->file[i]);
    free(o->patches.takes);
    free(o);
}

const struct function_type function_forces = {
    .name = "forces",
    .about = "force and moment on patches by pressure and viscous stress, mean over the step; no `fields`",
    FUNCTION_PARAMS(forces_param),
    .make = forces_make,
    .execute = forces_execute,
    .free = forces_free,
    .no_fields = true,
    .of_patches = true,
};
