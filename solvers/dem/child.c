/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts a child that ends with its parent; asks /proc for the state and the children of a process (child.h). */
#define _GNU_SOURCE /* execvpe, pipe2 */
#include "solvers/dem/child.h"

#include "mesh/format/files.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT = 4096 };

/* Reads the beginning of a file of /proc, which is empty for a process that has ended. */
__attribute__((format(printf, 2, 3))) static void read_text(char text[TEXT], const char *format, ...) {
    char path[64];
    int file;
    size_t bytes;
    va_list args;
    *text = 0;
    va_start(args, format);
    vsnprintf(path, sizeof path, format, args);
    va_end(args);
    const status e = file_open_read(path, &file, &bytes);
    status_free(e);
    if (e) return;
    const ssize_t n = read(file, text, TEXT - 1);
    text[n > 0 ? n : 0] = 0;
    close(file);
}

/* Is the state behind the name in parentheses T? */
static bool is_stopped(pid_t pid) {
    char text[TEXT];
    read_text(text, "/proc/%d/stat", (int)pid);
    const char *name = strrchr(text, ')');
    return name && !strncmp(name, ") T", 3);
}

static void read_children(pid_t pid, char text[TEXT]) {
    read_text(text, "/proc/%d/task/%d/children", (int)pid, (int)pid);
}

/* Takes the next number from a list; returns 0 behind the last. */
static pid_t next(char **list) {
    return (pid_t)strtol(*list, list, 10);
}

pid_t child_stopped(pid_t pid) {
    char text[TEXT], *list = text;
    pid_t found = is_stopped(pid) ? pid : 0;
    read_children(pid, text);
    for (pid_t one; !found && (one = next(&list));) found = child_stopped(one);
    return found;
}

/* Becomes the program; returns where that fails. It has a group of its own: Ctrl-C is for the parent, which ends it in
 * order. A parent that ended before prctl sends no signal. */
static void become(const struct child *c, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, c->last);
    if (getppid() != parent) raise(SIGKILL);
    setpgid(0, 0);
    signal(SIGPIPE, SIG_DFL);
    dup2(c->in[0], STDIN_FILENO);
    dup2(c->out[1], STDOUT_FILENO);
    for (int k = 0; k < 2; k++) {
        close(c->in[k]);
        close(c->out[k]);
    }
    execvpe(c->command[0], c->command, c->environment);
}

int child_start(const struct child *c, pid_t *pid) {
    const pid_t parent = getpid();
    int failed[2], why = 0; /* a pipe that a program which begins has closed */
    if (pipe2(failed, O_CLOEXEC)) return errno;
    *pid = fork();
    if (*pid == 0) {
        become(c, parent);
        (void)!write(failed[1], &errno, sizeof errno);
        raise(SIGKILL); /* what the parent has buffered is not for the child to write */
    }
    if (*pid < 0) why = errno;
    close(failed[1]);
    if (*pid > 0 && read(failed[0], &why, sizeof why) > 0) waitpid(*pid, NULL, 0);
    close(failed[0]);
    return why;
}

void child_kill(pid_t pid) {
    char text[TEXT], *list = text;
    read_children(pid, text);
    for (pid_t one; (one = next(&list));) child_kill(one);
    kill(pid, SIGKILL);
}
