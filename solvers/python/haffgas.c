/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haffgas.so: a run of granularGas whose steps another program asks for; Python loads it (haff/runs/gas.py). One
 * process, one rank. Each function returns 0, or the kind of an error (status.h) with its text in `error`, unless its
 * comment says otherwise. */
#include "mesh/base/build.h"
#include "solvers/output/output.h"
#include "solvers/programs/program.h"
#include "solvers/programs/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN __attribute__((visibility("default")))
enum { ERROR = 4096 };

struct stepped {
    struct comm *comm;
    struct run *run;
};
struct stepped_state { /* what Python reads at one call */
    double t;          /* s */
    long step, cells;
    int ended;
};

SHOWN int haff_open(const char *dir, const char *programs, struct stepped **out, char error[ERROR]);
SHOWN int haff_close(struct stepped *s, char error[ERROR]);
SHOWN int haff_step(struct stepped *s, double until, char error[ERROR]);
SHOWN int haff_write(struct stepped *s, char error[ERROR]);
SHOWN void haff_state(const struct stepped *s, struct stepped_state *out);
SHOWN int haff_fields(const struct stepped *s);
SHOWN const char *haff_field(const struct stepped *s, int quantity, int *components);
SHOWN int haff_values(const struct stepped *s, int quantity, double *out, char error[ERROR]);

static int tell(status e, char error[ERROR]) {
    if (!e) return 0;
    const int kind = (int)status_kind(e);
    snprintf(error, ERROR, "%s", status_text(e));
    status_free(e);
    return kind;
}

static status open_case(const char *dir, struct stepped *s) {
    char plain[PLAIN_PATH];
    TRY(case_folder(dir));
    TRY(folder_plain(dir, plain));
    TRY(comm_alone(&s->comm));
    return run_open(plain, &gas_medium, (struct case_reading){.strict = false}, s->comm, &s->run);
}

static void free_case(struct stepped *s) {
    comm_alone_free(s->comm);
    free(s);
}

/* Opens a case and makes all ready for its first step; programs: the folder of granularGas. */
int haff_open(const char *dir, const char *programs, struct stepped **out, char error[ERROR]) {
    *out = NULL;
    setenv(BUILD_PROGRAMS, programs, 1);
    status e = allocate(out, 1, sizeof **out, "a run");
    if (e) return tell(e, error);
    if (!(e = open_case(dir, *out))) return 0;
    free_case(*out);
    *out = NULL;
    return tell(e, error);
}

int haff_close(struct stepped *s, char error[ERROR]) {
    const status e = run_close(s->run);
    free_case(s);
    return tell(e, error);
}

/* Takes a step, which ends at `until` (s) at the latest; not after the end. */
int haff_step(struct stepped *s, double until, char error[ERROR]) {
    return tell(run_step(s->run, until), error);
}

/* Writes the time now, unless that is done. */
int haff_write(struct stepped *s, char error[ERROR]) {
    return tell(run_write(s->run), error);
}

void haff_state(const struct stepped *s, struct stepped_state *out) {
    const struct moment *now = run_now(s->run);
    *out = (struct stepped_state){now->t, now->step, run_setup(s->run)->mesh->ncells, run_ended(s->run)};
}

/* Returns the number of fields. */
int haff_fields(const struct stepped *s) {
    return run_setup(s->run)->medium->fields.noffered;
}

/* Returns the name of a field of this case, or NULL, and sets the numbers that it has in a cell: 1 or 3. */
const char *haff_field(const struct stepped *s, int quantity, int *components) {
    const struct medium *m = run_setup(s->run)->medium;
    const struct quantity *q = &m->fields.quantity[quantity];
    *components = q->components;
    return m->type->lacks && m->type->lacks(m, quantity) ? NULL : q->name;
}

/* Computes a field in out[cells][components], in the order of the polyMesh; vectors along x, y, z. */
int haff_values(const struct stepped *s, int quantity, double *out, char error[ERROR]) {
    return tell(output_gather(run_setup(s->run), quantity, out), error);
}
