/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function objects forces and forceCoeffs. forces writes force and moment on patches, by pressure and by viscous
 * stress, in the files force.dat and moment.dat of OpenFOAM. A force is what the last step took out of the gas by its
 * own fluxes, over the length of the step, so that the sum of force times dt is the momentum that the gas has lost, to
 * round-off. forceCoeffs writes their coefficients in the file coefficient.dat of OpenFOAM. With drag along e1, side
 * force along e2 = e3 x e1, lift along e3, and q = rhoInf magUInf^2/2,
 *     C = force/(q Aref),  Cm = moment/(q Aref lRef),
 * roll, pitch and yaw about e1, e2, e3; of the front half and the rear half as OpenFOAM has them: C/2 +- Cm. */
#include "solvers/functions/functions_patches.h"

#include <math.h>
#include <stdlib.h>

struct force_table {
    struct patch_choice patches;
    double centre[3], pressure; /* m, Pa */
    /* Of forceCoeffs: */
    double lift[3], drag[3], pitch[3];        /* as given; pitch is checked only */
    double axis[3][3];                        /* e1, e2, e3 */
    double speed, density, length, reference; /* m/s, kg/m^3, m, m^2 */
};

static const char *const rho_words[] = {"rho", NULL}, *const p_words[] = {"p", NULL}, *const U_words[] = {"U", NULL},
                         *const no_words[] = {"no", "off", "false", NULL};
#define PARAM_STRUCT struct force_table
#define ITS_PITCH    0, .usual = "liftDir x dragDir", .example = "pitchAxis (0 0 -1);"
#define OF_PATCHES                                                                                                     \
    NOTED("patches", "list of words", NULL, "names, groups, or quoted regular expressions", "patches (\".*\");")
#define OF_CENTRE VECTOR("CofR", centre, REQUIRED, ANY_NUMBER, UNIT(0, 1, 0), "the point that moments are taken about")
#define OF_PRESSURE                                                                                                    \
    NUMBER("pRef", pressure, 0, ANY_NUMBER, UNIT(1, -1, -2), "a uniform pressure whose force is left out")
#define OF_OPENFOAM                                                                                                    \
    ONLY("p", 0, p_words, "the pressure on the faces, as the step had it"), ONLY("U", 0, U_words, "of the gas"),       \
        ONLY("porosity", 0, no_words, "there are no porous media"),                                                    \
        ONLY("directForceDensity", 0, no_words, "the force is what the step took out of the gas")
static const struct param forces_param[] = {
    OF_PATCHES,  OF_CENTRE,
    OF_PRESSURE, ONLY("rho", 0, rho_words, "the gas has its own density: rhoInf is not used"),
    OF_OPENFOAM, IGNORED("rhoInf", "for OpenFOAM's incompressible solvers"),
};
static const struct param coefficients_param[] = {
    OF_PATCHES,
    NUMBER("magUInf", speed, REQUIRED, POSITIVE, UNIT(0, 1, -1), "speed of the flow far away"),
    NUMBER("rhoInf", density, REQUIRED, POSITIVE, UNIT(1, -3, 0), "density of the flow far away"),
    NUMBER("lRef", length, REQUIRED, POSITIVE, UNIT(0, 1, 0), "length that moments are divided by"),
    NUMBER("Aref", reference, REQUIRED, POSITIVE, UNIT(0, 2, 0), "area that forces are divided by"),
    OF_CENTRE,
    VECTOR("dragDir", drag, REQUIRED_AS("dragDir (1 0 0);"), ANY_NUMBER, NO_UNIT,
           "direction of the drag, of any length"),
    VECTOR("liftDir", lift, REQUIRED_AS("liftDir (0 1 0);"), ANY_NUMBER, NO_UNIT,
           "direction of the lift, at right angles to it"),
    VECTOR("pitchAxis", pitch, ITS_PITCH, ANY_NUMBER, NO_UNIT, "axis of the pitch: liftDir x dragDir, if it is given"),
    OF_PRESSURE,
    ONLY("rho", 0, rho_words, "the gas has its own density"),
    OF_OPENFOAM,
};

static status forces_make(struct function *f, struct dict *d) {
    struct force_table *o = f->own;
    return patches_read(f, d, "patches", &o->patches);
}

/* Finds what the patches took in the step that ends, and hands it to `write`. */
static status forces_find(struct function *f, const struct moment *now,
                          status (*write)(struct function *f, double t, const struct force *all)) {
    const struct force_table *o = f->own;
    struct force all;
    double dt;
    TRY(patches_follow(f, &dt));
    if (dt == 0 || function_again(f, now->t)) return OK;
    TRY(patches_force(f, &o->patches, o->centre, o->pressure, &all));
    return comm_agree(f->setup->comm, write(f, now->t, &all));
}

/* ---- forces ---- */

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
static status write_row(struct function *f, int i, double t, const double (*part)[3]) {
    double total[3];
    FILE *o;
    TRY(function_row(f, i, t, &o));
    for (int k = 0; k < 3; k++) total[k] = part[PRESSURE][k] + part[VISCOUS][k];
    function_value(o, '\t', 15, 3, total);
    for (int k = 0; k < FORCE_PARTS; k++) function_value(o, '\t', 15, 3, part[k]);
    return function_end_row(f, o);
}

static status forces_write(struct function *f, double t, const struct force *all) {
    const double *p = all->force[PRESSURE], *v = all->force[VISCOUS];
    TRY(write_row(f, 0, t, all->force));
    TRY(write_row(f, 1, t, all->moment));
    if (f->log && comm_root(f->setup->comm))
        printf("    %s: pressure (%.6g %.6g %.6g) viscous (%.6g %.6g %.6g)\n", f->name, p[0], p[1], p[2], v[0], v[1],
               v[2]);
    return OK;
}

static status forces_execute(struct function *f, const struct moment *now, const char *time) {
    (void)time;
    return forces_find(f, now, forces_write);
}

/* ---- forceCoeffs ---- */

static const double RIGHT = 1e-6; /* sine by which angles may miss a right one */

/* Makes e = a/|a|; returns whether a has a length. */
static bool unit(const double a[3], double e[3]) {
    const double size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int k = 0; k < 3; k++) e[k] = a[k] / size;
    return size > 0 && isfinite(size);
}

static double along(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static status find_axes(struct force_table *c, struct dict *d) {
    double pitch[3];
    if (!unit(c->drag, c->axis[0])) return dict_fail(d, "dragDir", "a direction has a length");
    if (!unit(c->lift, c->axis[2])) return dict_fail(d, "liftDir", "a direction has a length");
    if (fabs(along(c->axis[0], c->axis[2])) > RIGHT)
        return dict_fail(d, "liftDir", "it is not at right angles to dragDir");
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        c->axis[1][k] = c->axis[2][next] * c->axis[0][last] - c->axis[2][last] * c->axis[0][next];
    }
    if (dict_has(d, "pitchAxis") && !(unit(c->pitch, pitch) && fabs(along(pitch, c->axis[1]) - 1) < RIGHT))
        return dict_fail(
            d, "pitchAxis",
            "it follows from the others, as in OpenFOAM: liftDir x dragDir = (%.6g %.6g %.6g); leave it out",
            c->axis[1][0], c->axis[1][1], c->axis[1][2]);
    return OK;
}

static status coefficients_make(struct function *f, struct dict *d) {
    TRY(find_axes(f->own, d));
    return forces_make(f, d);
}

static void write_vector(FILE *file, const char *name, const double v[3]) {
    fprintf(file, "# %-12s: (%.12g %.12g %.12g)\n", name, v[0], v[1], v[2]);
}

static void coefficients_head(const struct function *f, int which, FILE *o) {
    static const char *const names[] = {"dragDir", "sideDir", "liftDir", "rollAxis", "pitchAxis", "yawAxis"};
    const struct force_table *c = f->own;
    (void)which;
    fprintf(o, "# Force coefficients\n");
    for (int i = 0; i < 6; i++) write_vector(o, names[i], c->axis[i % 3]);
    fprintf(o, "# %-12s: %.12g\n# %-12s: %.12g\n# %-12s: %.12g\n", "magUInf", c->speed, "lRef", c->length, "Aref",
            c->reference);
    write_vector(o, "CofR", c->centre);
    fprintf(o, "# \n# %-12s\tCd\tCs\tCl\tCmRoll\tCmPitch\tCmYaw\tCd(f)\tCd(r)\tCs(f)\tCs(r)\tCl(f)\tCl(r)\n", "Time");
}

static status coefficients_write(struct function *f, double t, const struct force *all) {
    const struct force_table *c = f->own;
    const double per = 1 / (0.5 * c->density * c->speed * c->speed * c->reference);
    double total[2][3], C[3], Cm[3];
    FILE *o;
    TRY(function_row(f, 0, t, &o));
    for (int k = 0; k < 3; k++) {
        total[0][k] = all->force[PRESSURE][k] + all->force[VISCOUS][k];
        total[1][k] = all->moment[PRESSURE][k] + all->moment[VISCOUS][k];
    }
    for (int k = 0; k < 3; k++) {
        C[k] = per * along(total[0], c->axis[k]);
        Cm[k] = per / c->length * along(total[1], c->axis[k]);
    }
    const double turn[3] = {Cm[0], Cm[2], Cm[1]}; /* of drag, side force, lift: roll, yaw, pitch */
    for (int k = 0; k < 3; k++) function_value(o, '\t', 15, 1, &C[k]);
    for (int k = 0; k < 3; k++) function_value(o, '\t', 15, 1, &Cm[k]);
    for (int k = 0; k < 3; k++) {
        function_value(o, '\t', 15, 1, &(double){0.5 * C[k] + turn[k]});
        function_value(o, '\t', 15, 1, &(double){0.5 * C[k] - turn[k]});
    }
    if (o && f->log)
        printf("    %s: Cd %.6g Cs %.6g Cl %.6g CmRoll %.6g CmPitch %.6g CmYaw %.6g\n", f->name, C[0], C[1], C[2],
               Cm[0], Cm[1], Cm[2]);
    return function_end_row(f, o);
}

static status coefficients_execute(struct function *f, const struct moment *now, const char *time) {
    (void)time;
    return forces_find(f, now, coefficients_write);
}

#define OF_BOTH .size = sizeof(struct force_table), .width = 14, .no_fields = true, .of_patches = true
const struct function_type function_forces = {
    .name = "forces",
    .about = "force and moment on patches by pressure and viscous stress, mean over the step; no `fields`",
    FUNCTION_PARAMS(forces_param),
    OF_BOTH,
    .make = forces_make,
    .execute = forces_execute,
    .table = {"force.dat", "moment.dat"},
    .head = forces_head,
};
const struct function_type function_coefficients = {
    .name = "forceCoeffs",
    .about = "coefficients of force and moment on patches: drag, side force, lift, roll, pitch, yaw; no `fields`",
    FUNCTION_PARAMS(coefficients_param),
    OF_BOTH,
    .make = coefficients_make,
    .execute = coefficients_execute,
    .table = {"coefficient.dat"},
    .head = coefficients_head,
};
