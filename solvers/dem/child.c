/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks /proc for the state and the children of a process (child.h). */
#include "solvers/dem/child.h"

#include "mesh/format/files.h"

#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
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

void child_kill(pid_t pid) {
    char text[TEXT], *list = text;
    read_children(pid, text);
    for (pid_t one; (one = next(&list));) child_kill(one);
    kill(pid, SIGKILL);
}
