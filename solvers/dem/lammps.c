/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts LAMMPS, sends it commands and reads its answers (lammps.h). */
#define _GNU_SOURCE /* environ, fopencookie */
#include "solvers/dem/lammps_private.h"

#include "mesh/base/build.h"
#include "mesh/base/comm.h"
#include "solvers/dem/child.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WORDS = 32, MOST_LINES = 1000000 }; /* of no use, one after the other */
enum { LOOK = 256 };                       /* ms of silence, after which it is looked whether LAMMPS is stopped */
static const char marker[] = "haff: done";
static const char go_on[] = "the times written before are whole: start the run again, and it goes on from the last";

static status missing(void) {
    return fail(
        ERR_SYSTEM,
        "system/controlDict: application granularDEM runs LAMMPS, and the program lmp was not found in PATH: on "
        "Debian, run  apt-get install lammps");
}

/* The environment of this process; alone: with the settings of a program without mpirun. The caller frees it. */
static char **environment_of(bool alone) {
    const char **all;
    size_t n = 0;
    while (environ[n]) n++;
    if (allocate(&all, n + COMM_SETTINGS + 1, sizeof *all, "the environment of LAMMPS")) return NULL;
    memcpy(all, environ, n * sizeof *all);
    if (alone) comm_alone_settings(all + n);
    return (char **)all;
}

/* Says once that LAMMPS is stopped. Returns false if it is, and the run is to end: LAMMPS is left then. */
static bool look(struct lammps *l) {
    const pid_t stopped = child_stopped(l->pid);
    if (stopped && !l->told)
        printf("LAMMPS (pid %d) is stopped;  kill -CONT %d  lets the run go on\n", (int)stopped, (int)stopped);
    l->told = stopped;
    l->left = stopped && l->asked && l->asked();
    return !l->left;
}

/* Waits until the end of a pipe can be read or written. A signal ends poll, so that a wish to stop is heard at once.
 */
static bool await(const struct lammps_pipe *p, short event) {
    struct pollfd at = {.fd = p->file, .events = event};
    while (poll(&at, 1, LOOK) < 1)
        if (!look(p->of)) return false;
    p->of->told = false;
    return true;
}

static ssize_t take(void *cookie, char *text, size_t size) {
    const struct lammps_pipe *p = cookie;
    return await(p, POLLIN) ? read(p->file, text, size) : 0;
}

/* Writes all. As much as PIPE_BUF goes into a pipe that poll calls free, without a wait. */
static ssize_t give(void *cookie, const char *text, size_t size) {
    const struct lammps_pipe *p = cookie;
    for (size_t done = 0; done < size;) {
        const size_t left = size - done, piece = left < PIPE_BUF ? left : PIPE_BUF;
        const ssize_t n = await(p, POLLOUT) ? write(p->file, text + done, piece) : 0;
        if (n <= 0) return 0;
        done += (size_t)n;
    }
    return (ssize_t)size;
}

static int shut(void *cookie) {
    return close(((struct lammps_pipe *)cookie)->file);
}

/* Makes the streams over the ends of the pipes. */
static void make_streams(struct lammps *l, int to, int from) {
    l->pipe[0] = (struct lammps_pipe){l, to};
    l->pipe[1] = (struct lammps_pipe){l, from};
    l->to = fopencookie(&l->pipe[0], "w", (cookie_io_functions_t){.write = give, .close = shut});
    l->from = fopencookie(&l->pipe[1], "r", (cookie_io_functions_t){.read = take, .close = shut});
}

/* If this process is killed, LAMMPS ends, even one that is stopped. mpirun is sent SIGTERM, by which it ends its ranks
 * and removes their files. */
static status launch(char *const command[], bool alone, struct lammps *l) {
    struct child c = {.command = command, .last = alone ? SIGKILL : SIGTERM};
    if (pipe(c.in)) return fail(ERR_SYSTEM, "%s: no pipe can be made", command[0]);
    if (pipe(c.out)) {
        close(c.in[0]);
        close(c.in[1]);
        return fail(ERR_SYSTEM, "%s: no pipe can be made", command[0]);
    }
    char **environment = environment_of(alone);
    c.environment = environment;
    const int why = environment ? child_start(&c, &l->pid) : ENOMEM;
    free(environment);
    if (why) l->pid = 0;
    close(c.in[0]);
    close(c.out[1]);
    make_streams(l, c.in[1], c.out[0]);
    if (why == ENOENT && !strcmp(command[0], "lmp")) return missing();
    if (why || !l->to || !l->from) return fail(ERR_SYSTEM, "%s: it cannot be started: %s", command[0], strerror(why));
    return OK;
}

static bool read_line(struct lammps *l) {
    if (!fgets(l->line, sizeof l->line, l->from)) return false;
    l->line[strcspn(l->line, "\n")] = 0;
    return true;
}

/* Waits until the process has ended, and looks at it ever more seldom. */
static int reap(struct lammps *l) {
    int code = 0;
    for (int pause = 1; waitpid(l->pid, &code, WNOHANG) == 0; pause = pause < LOOK ? 2 * pause : LOOK) {
        if (l->left || (pause == LOOK && !look(l))) child_kill(l->pid);
        poll(NULL, 0, pause);
    }
    return code;
}

/* Waits for its end; returns its exit code, or 128 and the number of the signal that ended it. */
static int end(struct lammps *l) {
    if (l->to) fclose(l->to);
    if (l->from) fclose(l->from);
    l->to = l->from = NULL;
    const int code = l->pid > 0 ? reap(l) : 0;
    l->pid = 0;
    return WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code);
}

void lammps_free(struct lammps *l) {
    if (!l) return;
    (void)end(l);
    free(l);
}

bool lammps_lives(const struct lammps *l) {
    return l->pid > 0;
}

/* Does a line of the lists that `lmp -h` prints hold a style? */
static bool lists(const char *line, const char *style) {
    const size_t n = strlen(style);
    for (const char *at = line; (at = strstr(at, style)); at += n)
        if ((at == line || at[-1] == ' ') && (at[n] == ' ' || at[n] == 0)) return true;
    return false;
}

status lammps_ask(struct lammps_abilities *out) {
    char *const command[] = {"lmp", "-h", NULL};
    static const char title[] = "Simulator - ";
    struct lammps *l;
    bool pair = false, wall = false, region = false;
    *out = (struct lammps_abilities){.version = ""};
    TRY(allocate(&l, 1, sizeof *l, "LAMMPS"));
    status e = launch(command, true, l);
    while (!e && read_line(l)) {
        const char *version = strstr(l->line, title);
        if (version) snprintf(out->version, sizeof out->version, "%s", version + strlen(title));
        pair |= lists(l->line, "granular");
        wall |= lists(l->line, "wall/gran");
        region |= lists(l->line, "wall/gran/region");
        out->surface |= lists(l->line, "surface/global");
    }
    (void)end(l);
    lammps_free(l);
    TRY(e);
    if (pair && wall && region) return OK;
    return fail(
        ERR_SYSTEM,
        "system/controlDict: application granularDEM needs LAMMPS with its package GRANULAR, which this lmp (%s) "
        "lacks: on Debian, run  apt-get install lammps",
        *out->version ? out->version : "of no version");
}

status lammps_start(int ranks, bool (*asked)(void), struct lammps **out) {
    char number[16], wrapper[4096];
    char *command[WORDS];
    int n = 0;
    TRY(allocate(out, 1, sizeof **out, "LAMMPS"));
    (*out)->asked = asked;
    if (ranks > 1) {
        snprintf(number, sizeof number, "%d", ranks);
        setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0); /* ranks that wait leave their core to the others */
        command[n++] = build_companion("mpirun", sizeof wrapper, wrapper) ? wrapper : "mpirun";
        command[n++] = "-np";
        command[n++] = number;
    }
    static char *const rest[] = {"stdbuf", "-oL", "lmp", "-log", "none", "-nocite", "-echo", "none", NULL};
    for (int i = 0; i < 9; i++) command[n++] = rest[i];
    return launch(command, ranks == 1, *out);
}

void lammps_send(struct lammps *l, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vfprintf(l->to, format, args);
    va_end(args);
    fputc('\n', l->to);
}

/* Fails with what it said last. */
static status died(struct lammps *l) {
    const int code = end(l);
    if (l->left)
        return fail(ERR_SYSTEM, "the run was asked to end while LAMMPS was stopped, and ends without its state; %s",
                    go_on);
    if (*l->error) return fail(ERR_SYSTEM, "LAMMPS ended: %s", l->error);
    if (code == 127) return missing();
    if (code > 128) /* also of a shell or mpirun, whose child a signal ended */
        return fail(ERR_SYSTEM, "LAMMPS was ended by signal %d (%s); %s", code - 128, strsignal(code - 128), go_on);
    return fail(ERR_SYSTEM, "LAMMPS ended with code %d and said no reason; %s", code, go_on);
}

static status endless(void) {
    return fail(ERR_SYSTEM, "LAMMPS prints lines without end and no answer; %s", go_on);
}

/* Keeps an error. */
static void note(struct lammps *l) {
    if (!strncmp(l->line, "ERROR", 5)) snprintf(l->error, sizeof l->error, "%.400s", l->line);
    if (*l->error && !strncmp(l->line, "Last command", 12)) {
        const size_t used = strlen(l->error);
        snprintf(l->error + used, sizeof l->error - used, "; %.400s", l->line);
    }
}

status lammps_wait(struct lammps *l) {
    lammps_send(l, "print \"%s\"", marker);
    fflush(l->to);
    for (int i = 0; i < MOST_LINES; i++) {
        if (!read_line(l)) return died(l);
        if (!strcmp(l->line, marker)) return OK;
        note(l);
    }
    return endless();
}

status lammps_dump(struct lammps *l, long *n) {
    bool count = false;
    *n = -1;
    fflush(l->to);
    for (int i = 0; i < MOST_LINES; i++) {
        if (!read_line(l)) return died(l);
        if (count) *n = atol(l->line);
        count = !strncmp(l->line, "ITEM: NUMBER OF", 15);
        if (!strncmp(l->line, "ITEM: ATOMS", 11) || !strncmp(l->line, "ITEM: ENTRIES", 13))
            return *n >= 0 ? OK : fail(ERR_SYSTEM, "LAMMPS gave a dump without a number of rows");
        note(l);
    }
    return endless();
}

status lammps_row(struct lammps *l, int columns, double *row) {
    if (!read_line(l)) return died(l);
    char *at = l->line, *rest;
    for (int k = 0; k < columns; k++, at = rest) {
        row[k] = strtod(at, &rest);
        if (rest == at || !isfinite(row[k]))
            return fail(ERR_SYSTEM, "LAMMPS gave a row that is not of %d finite numbers: %.200s", columns, l->line);
    }
    return OK;
}
