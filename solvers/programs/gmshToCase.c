/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gmshToCase: a .msh file becomes constant/polyMesh of a case. */
#include "mesh/format/gmsh.h"
#include "mesh/lattice/lattice.h"
#include "solvers/programs/meshrules.h"
#include "solvers/programs/program.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char HELP[] =
    "usage: gmshToCase MESH.msh -case DIR [-ascii | -binary] [-compress]\n"
    "\n"
    "Makes DIR/constant/polyMesh from a gmsh file (.msh 2.2 or 4.1, ascii or binary). Physical groups become patches.\n"
    "A mesh of surfaces is extruded by one cell (patches front and back, empty), one of lines twice (sides, empty).\n"
    "  -ascii      numbers as text with 17 digits (default)\n"
    "  -binary     numbers as they are in memory\n"
    "  -compress   files are gzipped\n"
    "  -keywords [NAME]  every keyword of system/meshDict, or that one\n"
    "  -help       this text\n"
    "  -version    version, compiler, licence\n"
    "\n"
    "Types of patches: names that begin with wall or empty have that type, all others are patch, unless\n"
    "DIR/system/meshDict says else (names that sound like walls are noted):\n"
    "  patches { bottom { type symmetryPlane; } left { type cyclic; neighbourPatch right; } right { ... } }\n"
    "Exit code 0: written; 1: the mesh or the command line is wrong, the old mesh is untouched; 3: disk, memory.\n";

enum { PATH = 4096 };

struct mesh_request {
    const char *mesh, *dir;
    char plain[PLAIN_PATH]; /* dir without links */
    struct foam_format format;
    bool help, version;
    struct lookup keywords;
};

static status parse(int argc, char **argv, struct mesh_request *o) {
    static const char *const names[] = {"MESH.msh",  "-case",     "-ascii", "-binary",
                                        "-compress", "-keywords", "-help",  "-version"};
    *o = (struct mesh_request){.format = {.precision = 17}};
    for (int i = 1; i < argc; i++) {
        const char *a = argv[i];
        if (lookup_option(argc, argv, &i, &o->keywords)) continue;
        if (strcmp(a, "-case") == 0)
            TRY(option_value(argc, argv, &i, &o->dir));
        else if (strcmp(a, "-ascii") == 0)
            o->format.binary = false;
        else if (strcmp(a, "-binary") == 0)
            o->format.binary = true;
        else if (strcmp(a, "-compress") == 0)
            o->format.compress = true;
        else if (strcmp(a, "-help") == 0)
            o->help = true;
        else if (strcmp(a, "-version") == 0 || strcmp(a, "--version") == 0)
            o->version = true;
        else if (*a == '-' || o->mesh)
            return option_unknown(a, names, 8);
        else
            o->mesh = a;
    }
    if (o->help || o->version || o->keywords.asked) return OK;
    if (!o->mesh || !o->dir) return fail(ERR_INPUT, "usage: gmshToCase MESH.msh -case DIR (more with -help)");
    struct stat st;
    if (stat(o->dir, &st) != 0 || !S_ISDIR(st.st_mode))
        return fail(ERR_INPUT, "-case %s: no such folder; make it first", o->dir);
    TRY(folder_plain(o->dir, o->plain));
    o->dir = o->plain;
    return OK;
}

/* ---- summary ----------------------------------------------------------------------------------------------------- */

static status print_shapes(const struct polymesh *m) {
    char shapes[POLYMESH_SHAPES];
    TRY(polymesh_shapes(m, shapes));
    printf("cells    %d: %s\nfaces    %d, inside %d; points %d\n", m->ncells, shapes, m->nfaces, m->ninternal,
           m->npoints);
    return OK;
}

static bool sounds_solid(const char *name) {
    static const char *const words[] = {"wall",  "solid", "floor",    "ground", "ceiling",  "roof",   "lid",
                                        "plate", "body",  "obstacle", "hull",   "cylinder", "sphere", "airfoil"};
    char small[64];
    size_t n = 0;
    for (; name[n] && n + 1 < sizeof small; n++) small[n] = (char)tolower((unsigned char)name[n]);
    small[n] = 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strstr(small, words[i])) return true;
    return false;
}

/* Says which patches sound like walls and are none, unless a rule of meshDict makes them so. */
static void print_open(const struct polymesh *m, const struct mesh_rules *rules) {
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        bool asked = false;
        for (int k = 0; k < rules->n; k++) asked |= !strcmp(rules->rule[k].patch, p->name);
        if (asked || strcmp(p->type, "patch") != 0 || !sounds_solid(p->name)) continue;
        printf(
            "note     patch %s sounds like a wall, but is of type patch, as its name does not begin with wall: if it "
            "is one, write  patches { %s { type wall; } }  in system/meshDict\n",
            p->name, p->name);
    }
}

static status print_summary(const struct polymesh *m, const struct lattice *l, const char *why) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY, high[k] = -INFINITY;
        for (long p = 0; p < m->npoints; p++) {
            low[k] = fmin(low[k], m->points[3 * p + k]);
            high[k] = fmax(high[k], m->points[3 * p + k]);
        }
    }
    TRY(print_shapes(m));
    printf("box      (%g %g %g) to (%g %g %g)\n", low[0], low[1], low[2], high[0], high[1], high[2]);
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        printf("patch    %-20s %-14s %d faces%s%s\n", p->name, p->type, p->nfaces, p->neighbour ? ", other half " : "",
               p->neighbour ? p->neighbour : "");
    }
    if (l)
        printf("lattice  yes: %dD, %d x %d x %d cells of %g x %g x %g\n", l->dim, l->n[0], l->n[1], l->n[2],
               l->width[0], l->width[1], l->width[2]);
    else
        printf("lattice  no: %s\n", why);
    return OK;
}

/* ---- the case ---------------------------------------------------------------------------------------------------- */

/* Removes zones and sets of an older mesh: they hold its numbers and would make OpenFOAM's tools fail. */
static void remove_stale(const char *mesh_dir) {
    static const char *const names[] = {"cellZones",    "faceZones",    "pointZones",
                                        "cellZones.gz", "faceZones.gz", "pointZones.gz"};
    char path[PATH + 32];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", mesh_dir, names[i]);
        if (!file_remove(path)) printf("removed  %s of the mesh before\n", path);
    }
}

static status touch_foam(const char *dir) {
    char path[PATH + 32];
    snprintf(path, sizeof path, "%s/case.foam", dir);
    int fd, why = file_touch(path, &fd);
    if (why) return file_error(path, "cannot be made", why);
    close(fd);
    return OK;
}

static status write_case(const struct mesh_request *o, const struct mesh_rules *rules, const struct polymesh *m) {
    char why[256] = "", mesh_dir[PATH];
    struct lattice *l = NULL;
    TRY(polymesh_check(m));
    TRY(lattice_recognise(m, &l, why));
    if (snprintf(mesh_dir, sizeof mesh_dir, "%s/constant/polyMesh", o->dir) >= PATH) {
        lattice_free(l);
        return fail(ERR_INPUT, "the path %.60s... is too long", o->dir);
    }
    status s = polymesh_write(m, mesh_dir, &o->format);
    if (!s) remove_stale(mesh_dir);
    if (!s) s = print_summary(m, l, why);
    if (!s) print_open(m, rules);
    lattice_free(l);
    TRY(s);
    printf("written  %s\n", mesh_dir);
    return touch_foam(o->dir);
}

static status run(const struct mesh_request *o) {
    struct mesh_rules *rules = NULL;
    struct polymesh *m = NULL;
    status s = mesh_rules_read(o->dir, &rules);
    if (!s) s = gmsh_read_thick(o->mesh, rules->rule, rules->n, rules->thickness, &m);
    if (!s) s = write_case(o, rules, m);
    mesh_rules_free(rules);
    polymesh_free(m);
    return s;
}

int main(int argc, char **argv) {
    struct mesh_request o;
    status s = parse(argc, argv, &o);
    if (!s && (o.help || o.version)) {
        if (o.version) program_version(argv[0]);
        if (o.help) fputs(HELP, stdout);
        return 0;
    }
    if (!s) s = o.keywords.asked ? lookup_print(&o.keywords, mesh_rules_keywords, NULL) : run(&o);
    int code = status_print(s, false);
    status_free(s);
    return code;
}
