/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes commands and data files of LAMMPS (dem_deck.h). Numbers have all digits: a run has the same bits from them. */
#include "solvers/dem/dem_deck.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.28318530717958647692
#define SLAB   0.02 /* diameters: thickness of the slabs that stand for walls */

/* `hertz` with K is exact for pairs and walls; `hertz/material` makes walls 1 + nu too stiff. */
static void write_law(FILE *f, const struct contact_law *l) {
    const bool linear = l->contact->type == CONTACT_LINEAR;
    fprintf(f, "%s %.17g %.17g tangential ", linear ? "hooke" : "hertz", l->k, l->eta);
    if (l->friction > 0)
        fprintf(f, "%s %.17g %.17g %.17g", l->contact->tangent == TANGENT_MINDLIN ? "mindlin" : "linear_history", l->kt,
                l->chi, l->friction);
    else
        fprintf(f, "linear_nohistory 0 0");
    fprintf(f, " damping %s", linear ? "velocity" : l->tsuji ? "tsuji" : "viscoelastic");
}

static void write_side(FILE *f, const struct dem_walls *w, int i) {
    const struct dem_wall *wall = &w->wall[i];
    const double at = wall->side ? w->high[wall->axis] : w->low[wall->axis];
    fprintf(f, "fix wall%d all wall/gran granular ", i);
    write_law(f, &wall->law);
    if (wall->side)
        fprintf(f, " %cplane NULL %.17g", "xyz"[wall->axis], at);
    else
        fprintf(f, " %cplane %.17g NULL", "xyz"[wall->axis], at);
    for (int k = 0; k < 3; k++)
        if (wall->velocity[k] != 0) fprintf(f, " shear %c %.17g", "xyz"[k], wall -> velocity[k]);
    fprintf(f, " contacts\n");
}

/* Sets the slab behind a rectangle as a prism of LAMMPS: three edges, the first along x, the second in the plane of x
 * and y. One edge of the rectangle lies along `flat`; the slab's thickness along an axis across it. */
static void slab(const struct dem_law *law, const struct dem_wall *wall, double corner[3], double edge[3][3]) {
    const struct dem_walls *w = law->walls;
    int flat = 0, thick = -1;
    for (int k = 1; k < 3; k++)
        if (fabs(wall->edge[1][k]) > fabs(wall->edge[1][flat])) flat = k;
    for (int k = 0; k < 3; k++) /* x first, as a prism's first edge is; y for walls along x */
        if (k != flat && thick < 0 && fabs(wall->normal[k]) > 1e-9) thick = k;
    const int rest = 3 - flat - thick;
    memcpy(corner, wall->corner, sizeof wall->corner);
    memset(edge, 0, 9 * sizeof(double));
    memcpy(edge[flat], wall->edge[1], sizeof *edge);
    memcpy(edge[rest], wall->edge[0], sizeof *edge);
    edge[thick][thick] = SLAB * law->diameter;
    if (wall->normal[thick] < 0) corner[thick] -= edge[thick][thick];
    if (edge[rest][rest] < 0) /* edges lead upwards */
        for (int k = 0; k < 3; k++) {
            corner[k] += edge[rest][k];
            edge[rest][k] *= -1;
        }
    for (int j = 0; j < 2; j++) { /* the slab goes beyond the borders of periodic space */
        const int k = j ? flat : rest, up = wall->edge[j][k] > 0;
        const int low = dem_wall_goes_on(w, wall, j, !up), high = dem_wall_goes_on(w, wall, j, up);
        corner[k] -= low * 2 * law->diameter;
        edge[k][k] += (low + high) * 2 * law->diameter;
    }
}

static void write_slab(FILE *f, const struct dem_law *law, int i) {
    double c[3], e[3][3];
    slab(law, &law->walls->wall[i], c, e);
    const bool block = e[1][0] == 0 && e[2][0] == 0 && e[2][1] == 0;
    fprintf(f, "region wall%d %s", i, block ? "block" : "prism");
    for (int k = 0; k < 3; k++) fprintf(f, " %.17g %.17g", c[k], c[k] + e[k][k]);
    if (!block) fprintf(f, " %.17g %.17g %.17g", e[1][0], e[2][0], e[2][1]);
    fprintf(f, " side out units box\nfix wall%d all wall/gran/region granular ", i);
    write_law(f, &law->walls->wall[i].law);
    fprintf(f, " region wall%d contacts\n", i);
}

/* All walls of triangles (doc/src/fix_surface_global.rst of LAMMPS, 4 Jul 2026): a surface type for each wall, and one
 * molecule, so that triangles of two walls are connected, too. It gives no forces, so two fixes keep those on the
 * grains before and behind it. */
static void write_surface(FILE *f, const struct dem_walls *w, const char *folder) {
    fprintf(f, "fix before all store/force\nfix surface all surface/global");
    for (int i = 0; i < w->n; i++) fprintf(f, " &\n    input stl %d 1 \"%s/wall%d.stl\"", i + 1, folder, i);
    for (int i = 0; i < w->n; i++) {
        fprintf(f, " &\n    model 1 %d granular ", i + 1);
        write_law(f, &w->wall[i].law);
    }
    fprintf(f, "\nfix after all store/force\n");
}

static void write_gravity(FILE *f, const struct dem_law *law) {
    const struct sources *s = law->gravity;
    const double *g = s->gravity;
    const double size = sqrt(g[0] * g[0] + g[1] * g[1] + (law->walls->dim > 2 ? g[2] * g[2] : 0));
    if (size == 0) return;
    fprintf(f, "variable gravity equal %.17g*(1+%.17g*cos(%.17g*v_time+%.17g))\n", size, s->amplitude,
            TWO_PI * s->frequency, s->phase);
    fprintf(f, "fix gravity all gravity %s vector %.17g %.17g %.17g\n",
            s->amplitude != 0 ? "v_gravity" : "$(v_gravity:%.17g)", g[0], g[1], law->walls->dim > 2 ? g[2] : 0);
}

static void write_start(FILE *f, const struct dem_law *law, const char *data, const char *restart) {
    const struct dem_walls *w = law->walls;
    fprintf(f, "# Written by granularDEM: soft grains on the case in the folder above. SI units.\n"
               "units si\natom_style sphere\natom_modify map array\nnewton off\n");
    if (w->dim == 2) fprintf(f, "dimension 2\n");
    fprintf(f, "boundary %s %s %s\n", w->periodic[0] ? "p" : "f", w->periodic[1] ? "p" : "f",
            w->periodic[2] || w->dim == 2 ? "p" : "f");
    fprintf(f, "variable time equal 0\n");
    fprintf(f, restart ? "read_restart \"%s\"\n" : "read_data \"%s\"\n", restart ? restart : data);
    fprintf(f, "comm_modify vel yes\nneighbor %.17g bin\nneigh_modify delay 0 every 1 check yes\n",
            0.2 * law->diameter);
}

/* The rows of the grains that touch a surface: number, 1, force. */
static void write_surface_dump(FILE *f, const char *how) {
    for (int k = 1; k <= 3; k++) fprintf(f, "variable force%d atom f_after[%d]-f_before[%d]\n", k, k, k);
    fprintf(f,
            "variable touch atom \"v_force1 != 0 || v_force2 != 0 || v_force3 != 0\"\n"
            "dump walls all custom 1 /dev/stdout id v_touch v_force1 v_force2 v_force3\n"
            "dump_modify walls sort id thresh v_touch > 0 %s\n",
            how);
}

static void write_walls_dump(FILE *f, const struct dem_walls *w, const char *how) {
    fprintf(f, "variable touch atom f_wall0[1]");
    for (int i = 1; i < w->n; i++) fprintf(f, "+f_wall%d[1]", i);
    fprintf(f, "\ndump walls all custom 1 /dev/stdout id");
    for (int i = 0; i < w->n; i++)
        for (int k = 1; k <= DEM_WALL_COLUMNS; k++) fprintf(f, " f_wall%d[%d]", i, k);
    fprintf(f, "\ndump_modify walls sort id thresh v_touch > 0 %s\n", how);
}

/* The dumps of a moment, which dem_engine.c asks for: all computing for them is then, as no thermo output needs it.
 * Hexadecimal numbers are exact, and quicker than 17 decimal digits. The rows of walls are long, but few grains touch
 * one. */
static void write_dumps(FILE *f, const struct dem_walls *w) {
    const char *how = "format float %a every v_never";
    fprintf(f,
            "variable never equal 1e15\n"
            "compute names all property/local patom1 patom2 cutoff radius\n"
            "compute forces all pair/local fx fy fz p1 p2 p3 cutoff radius\n"
            "dump grains all custom 1 /dev/stdout id x y z vx vy vz omegax omegay omegaz\n"
            "dump_modify grains sort id %s\n",
            how);
    if (w->n && w->facets)
        write_surface_dump(f, how);
    else if (w->n)
        write_walls_dump(f, w, how);
    fprintf(f, "dump contacts all local 1 /dev/stdout c_names[1] c_names[2]");
    for (int k = 1; k <= 6; k++) fprintf(f, " c_forces[%d]", k);
    fprintf(f, "\ndump_modify contacts %s\n", how);
}

static void write_deck(FILE *f, const struct dem_law *law, const char *folder, const char *data, const char *restart) {
    const struct dem_walls *w = law->walls;
    write_start(f, law, data, restart);
    fprintf(f, "pair_style granular\npair_coeff * * ");
    write_law(f, &law->pair);
    fprintf(f, "\n");
    if (w->facets) write_surface(f, w, folder);
    for (int i = 0; i < w->n && !w->facets; i++)
        if (w->wall[i].axis >= 0)
            write_side(f, w, i);
        else
            write_slab(f, law, i);
    write_gravity(f, law);
    fprintf(f, "fix move all nve/sphere%s\n", w->dim == 2 ? " disc" : "");
    if (w->dim == 2) fprintf(f, "fix plane all enforce2d\n");
    write_dumps(f, w);
    fprintf(f,
            "thermo_style custom step atoms\nthermo 0\n"
            "thermo_modify norm no flush no lost %s\n",
            w->open ? "ignore" : "error");
}

/* Does LAMMPS take a path between quotation marks as it stands? In names of files * is the step and % a rank. It drops
 * or replaces bytes beyond ASCII before it reads a line. */
static bool lammps_opens(const char *path) {
    for (const char *p = path; *p; p++)
        if (*p < ' ' || *p > '~' || strchr("\"*%", *p)) return false;
    return true;
}

status dem_deck(const struct dem_law *law, const char *folder, const char *data, const char *restart, char **out) {
    size_t size;
    const char *path = restart ? restart : data;
    *out = NULL;
    if (!lammps_opens(path))
        return fail(
            ERR_INPUT,
            "%s: LAMMPS cannot open a path with \" * %% or letters beyond ASCII in it; start granularDEM in the folder "
            "of the case, or rename the folder",
            path);
    FILE *f = open_memstream(out, &size);
    if (!f) return fail(ERR_SYSTEM, "no memory for the commands of LAMMPS");
    write_deck(f, law, folder, data, restart);
    return fclose(f) ? fail(ERR_SYSTEM, "no memory for the commands of LAMMPS") : OK;
}

static void write_triangle(FILE *f, const struct facet *t) {
    fprintf(f, "facet normal %.9g %.9g %.9g\nouter loop\n", t->normal[0], t->normal[1], t->normal[2]);
    for (int j = 0; j < 3; j++)
        fprintf(f, "vertex %.17g %.17g %.17g\n", t->corner[j][0], t->corner[j][1], t->corner[j][2]);
    fprintf(f, "endloop\nendfacet\n");
}

status dem_deck_surface(const struct dem_walls *w, const char *folder) {
    for (int i = 0; i < w->n; i++) {
        char path[4096];
        FILE *f;
        snprintf(path, sizeof path, "%s/wall%d.stl", folder, i);
        const int why = file_create_stream(path, &f);
        if (why) return file_error(path, "cannot be written", why);
        fprintf(f, "solid wall%d\n", i);
        for (int j = 0; j < w->facets->own; j++)
            if (w->facets->facet[j].wall == w->wall[i].patch) write_triangle(f, &w->facets->facet[j]);
        fprintf(f, "endsolid wall%d\n", i);
        const bool failed = ferror(f);
        if (fclose(f) || failed) return fail(ERR_SYSTEM, "%s: cannot be written (disk full?)", path);
    }
    return OK;
}

static void write_data(FILE *f, const struct dem_law *law, const struct dem_moment *g) {
    const struct dem_walls *w = law->walls;
    const double d = law->diameter, density = law->mass / (TWO_PI / 12 * d * d * d);
    fprintf(f, "grains of granularDEM\n\n%d atoms\n1 atom types\n\n", g->n);
    for (int k = 0; k < 3; k++) {
        const bool flat = k >= w->dim;
        const double beyond = w->periodic[k] || w->open ? 0 : d, half = 0.5 * (w->low[k] + w->high[k]);
        fprintf(f, "%.17g %.17g %clo %chi\n", flat ? half - d / 2 : w->low[k] - beyond,
                flat ? half + d / 2 : w->high[k] + beyond, "xyz"[k], "xyz"[k]);
    }
    fprintf(f, "\nAtoms # sphere\n\n");
    for (int i = 0; i < g->n; i++)
        fprintf(f, "%d 1 %.17g %.17g %.17g %.17g %.17g\n", g->id[i], d, density, g->x[i][0], g->x[i][1], g->x[i][2]);
    fprintf(f, "\nVelocities\n\n");
    for (int i = 0; i < g->n; i++)
        fprintf(f, "%d %.17g %.17g %.17g %.17g %.17g %.17g\n", g->id[i], g->u[i][0], g->u[i][1], g->u[i][2],
                g->spin[i][0], g->spin[i][1], g->spin[i][2]);
}

status dem_deck_data(const struct dem_law *law, const struct dem_moment *grains, const char *path) {
    FILE *f;
    const int why = file_create_stream(path, &f);
    if (why) return file_error(path, "cannot be written", why);
    write_data(f, law, grains);
    const bool failed = ferror(f);
    return fclose(f) || failed ? fail(ERR_SYSTEM, "%s: cannot be written (disk full?)", path) : OK;
}
