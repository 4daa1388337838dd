/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `functions` of system/controlDict on a gas of six cells: they are made, collect, write and save over three moments.
 * What they write stays below postProcessing and VTK of the case. */
#include "solvers/functions/functions.h"
#include "solvers/case/checksums.h"
#include "solvers/case/times.h"
#include "tests/fuzz/target.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { X = 3, Y = 2, CELLS = X * Y, FACES = 7 + 10 + 2 * CELLS, MOMENTS = 3 };

static struct {
    char path[200];
    struct comm *comm;
    struct setup *setup;
} gas; /* the same for all inputs */

struct sheet { /* a mesh being made */
    int n, points[4 * FACES], start[FACES + 1], owner[FACES], neighbour[FACES];
};

static int corner(int i, int j, int k) {
    return i + (X + 1) * (j + (Y + 1) * k);
}

static void add_face(struct sheet *s, int cell, int other, const int p[4][3]) {
    for (int c = 0; c < 4; c++) s->points[4 * s->n + c] = corner(p[c][0], p[c][1], p[c][2]);
    s->owner[s->n] = cell;
    s->neighbour[s->n++] = other;
    s->start[s->n] = 4 * s->n;
}

/* Adds the faces of a cell that lie inside, on the walls, or in front and behind. */
static void add_faces(struct sheet *s, int i, int j, int part) {
    const int c = i + X * j, a = i + 1, b = j + 1;
    if (part == 0 && a < X) add_face(s, c, c + 1, (const int[4][3]){{a, j, 0}, {a, b, 0}, {a, b, 1}, {a, j, 1}});
    if (part == 0 && b < Y) add_face(s, c, c + X, (const int[4][3]){{i, b, 0}, {i, b, 1}, {a, b, 1}, {a, b, 0}});
    if (part == 1 && a == X) add_face(s, c, -1, (const int[4][3]){{a, j, 0}, {a, b, 0}, {a, b, 1}, {a, j, 1}});
    if (part == 1 && b == Y) add_face(s, c, -1, (const int[4][3]){{i, b, 0}, {i, b, 1}, {a, b, 1}, {a, b, 0}});
    if (part == 1 && i == 0) add_face(s, c, -1, (const int[4][3]){{i, j, 0}, {i, j, 1}, {i, b, 1}, {i, b, 0}});
    if (part == 1 && j == 0) add_face(s, c, -1, (const int[4][3]){{i, j, 0}, {a, j, 0}, {a, j, 1}, {i, j, 1}});
    if (part == 2) add_face(s, c, -1, (const int[4][3]){{i, j, 0}, {i, b, 0}, {a, b, 0}, {a, j, 0}});
    if (part == 2) add_face(s, c, -1, (const int[4][3]){{i, j, 1}, {a, j, 1}, {a, b, 1}, {i, b, 1}});
}

static void write_mesh(const char *folder) {
    static char walls[] = "walls", wall[] = "wall", sides[] = "sides", empty[] = "empty";
    static struct sheet s;
    double points[3 * (X + 1) * (Y + 1) * 2];
    for (int k = 0; k < 2; k++)
        for (int j = 0; j <= Y; j++)
            for (int i = 0; i <= X; i++)
                memcpy(points + 3 * corner(i, j, k), (double[3]){0.1 * i, 0.1 * j, 0.1 * k}, 3 * sizeof(double));
    for (int part = 0; part < 3; part++)
        for (int c = 0; c < CELLS; c++) add_faces(&s, c % X, c / X, part);
    struct patch patch[] = {{walls, wall, NULL, 7, 10, NULL, NULL}, {sides, empty, NULL, 17, 2 * CELLS, NULL, NULL}};
    const struct polymesh m = {.npoints = (X + 1) * (Y + 1) * 2,
                               .nfaces = FACES,
                               .ninternal = 7,
                               .ncells = CELLS,
                               .npatches = 2,
                               .points = points,
                               .face_start = s.start,
                               .face_points = s.points,
                               .owner = s.owner,
                               .neighbour = s.neighbour,
                               .patch = patch};
    PROMISE(s.n == FACES && accepted(polymesh_write(&m, folder, &(struct foam_format){.precision = 17})),
            "a mesh is made");
}

static void write_text(const char *name, const char *text) {
    scratch_write(name, text, strlen(text));
}

static void write_field(const char *name, const char *dimensions, const char *kind, const char *value) {
    char path[64], text[600];
    snprintf(path, sizeof path, "gas/0/%s", name);
    snprintf(
        text, sizeof text,
        "FoamFile { version 2.0; format ascii; class vol%sField; object %s; } dimensions %s; internalField uniform %s; "
        "boundaryField { walls { type %s; } sides { type empty; } }\n",
        kind, name, dimensions, value, *kind == 'V' ? "slip" : "zeroGradient");
    write_text(path, text);
}

static void make_gas(void) {
    char path[256];
    if (gas.setup) return;
    snprintf(gas.path, sizeof gas.path, "%s/gas", scratch());
    snprintf(path, sizeof path, "%s/constant/polyMesh", gas.path);
    write_mesh(path);
    write_text("gas/system/controlDict", "application granularGas; endTime 1; writeControl none;");
    write_text("gas/system/fvSchemes", "meshEngine polyhedral;");
    write_text("gas/system/fvSolution", "");
    write_text("gas/constant/granularProperties",
               "grain { diameter 0.1; restitution 0.9; } equationOfState TorquatoSpheres; cooling Haff;");
    write_text("gas/constant/g", "dimensions [0 1 -2 0 0 0 0]; value (0 -1 0);");
    write_text("gas/constant/shaking", "type sinusoidal; frequency 4; amplitude 0;");
    write_field("rho", "[1 -3 0 0 0 0 0]", "Scalar", "100");
    write_field("T", "[0 2 -2 0 0 0 0]", "Scalar", "1");
    write_field("U", "[0 1 -1 0 0 0 0]", "Vector", "(0.1 0.2 0)");
    PROMISE(accepted(comm_alone(&gas.comm)), "there is memory");
    status s = case_read(gas.path, &gas_medium, (struct case_reading){.strict = false}, gas.comm, &gas.setup);
    if (s) fprintf(stderr, "%s\n", status_text(s));
    PROMISE(!s, "the case is sound");
    PROMISE(accepted(gas.setup->medium->type->start(gas.setup->medium)), "the gas is sound");
}

/* Counts what stands in a folder. */
static int entries(const char *folder) {
    DIR *d = opendir(folder);
    int n = 0;
    while (d && readdir(d)) n++;
    if (d) closedir(d);
    return n;
}

static void run(struct functions *f) {
    struct moment before = {.t = 0}, now = {.t = 0, .fields = true};
    const struct foam_format format = {.precision = 6};
    char folder[256], name[TIME_NAME] = "0";
    const struct field_writer w = {gas.setup->mesh, &format, folder, "0"};
    struct checksums sums = {.n = 0};
    snprintf(folder, sizeof folder, "%s/saved", gas.path);
    for (int k = 0; k < MOMENTS; k++) {
        const bool good = accepted(functions_collect(f, k ? &before : NULL, &now)) &&
                          accepted(functions_execute(f, k ? &before : NULL, &now, name));
        if (!good) return;
        const double next = functions_next(f, now.t);
        PROMISE(next > now.t, "what is due next lies ahead");
        before = now;
        now = (struct moment){.t = fmin(next, now.t + 0.3), .step = k + 1, .cpu = k, .clock = k, .fields = k == 1};
        time_name(TIME_GENERAL, 17, now.t, name);
    }
    (void)accepted(functions_save(f, &w, &sums));
}

static void clean(void) {
    static const char *const made[] = {"postProcessing", "VTK", "saved"};
    char path[256];
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", gas.path, made[i]);
        PROMISE(accepted(remove_folder(path)), "what was written can be removed");
    }
    snprintf(path, sizeof path, "%s/saved/uniform", gas.path);
    PROMISE(accepted(make_folders(path)), "a folder can be made");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    struct dict *d = NULL;
    struct functions *f = NULL;
    make_gas();
    clean();
    const int around = entries(scratch()), inside = entries(gas.path);
    scratch_write("functions", data, size);
    snprintf(path, sizeof path, "%s/functions", scratch());
    if (accepted(dict_read(path, &d))) {
        gas.setup->control->functions = d;
        const bool good = accepted(functions_make(gas.setup, &f));
        PROMISE(good == (f != NULL), "there are function objects if there is no error");
        if (good) run(f);
        functions_free(f);
        (void)accepted(dict_check_used(d));
        gas.setup->control->functions = NULL;
    }
    dict_free(d);
    remove(path);
    snprintf(path, sizeof path, "%s/postProcessing", gas.path);
    int made = !access(path, 0);
    snprintf(path, sizeof path, "%s/VTK", gas.path);
    made += !access(path, 0);
    PROMISE(entries(scratch()) == around && entries(gas.path) == inside + made, "nothing is written elsewhere");
    return 0;
}
