/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locks a case by a POSIX record lock on CASE/.haff.lock (lock.h). */
#include "solvers/case/lock.h"

#include "mesh/format/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { PATH = 4096 + 16, OWNER = 512 };

struct lock {
    char path[PATH];
    int file;
};

static void name_owner(const char *program, char out[OWNER]) {
    char host[256], date[64] = "";
    time_t now = time(NULL);
    struct tm parts;
    if (gethostname(host, sizeof host - 1)) snprintf(host, sizeof host, "unknown host");
    host[sizeof host - 1] = 0;
    if (localtime_r(&now, &parts)) strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S%z", &parts);
    snprintf(out, OWNER, "%s, pid %ld on %s since %s", program, (long)getpid(), host, date);
}

static status held(const char *case_dir, int file) {
    char owner[OWNER] = "";
    ssize_t n = pread(file, owner, sizeof owner - 1, 0);
    owner[n > 0 ? (size_t)n : 0] = 0;
    owner[strcspn(owner, "\n")] = 0;
    return fail(ERR_INPUT,
                "%s: another run works on this case: %s; wait for its end or stop it (SIGTERM: it writes first), or "
                "run a copy of the case",
                case_dir, *owner ? owner : "it has just started");
}

static status unwritable(const char *case_dir, int reason) {
    bool closed = reason == EACCES || reason == EROFS || reason == EPERM;
    return fail(ERR_SYSTEM, "%s: this folder cannot be written to: %s; %s", case_dir, strerror(reason),
                closed ? "a run writes its times there: allow it (chmod u+w), or run a copy of the case (checkCase and "
                         "-dry-run only read)"
                       : "nothing was run");
}

/* Does the path still name the file that is open? The last holder of a lock removes it, and a case may be moved. */
static bool still_there(const struct lock *l) {
    struct stat mine, named;
    return !fstat(l->file, &mine) && !stat(l->path, &named) && named.st_ino == mine.st_ino &&
           named.st_dev == mine.st_dev;
}

/* Locks the file; returns 0 or an errno. EINTR: the path names another file by now. */
static int lock_file(const struct lock *l) {
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(l->file, F_SETLK, &whole)) return errno;
    return still_there(l) ? 0 : EINTR;
}

static status take(struct lock *l, const char *case_dir, const char *program) {
    char owner[OWNER];
    int reason = EINTR;
    while (reason == EINTR) {
        if (l->file >= 0) close(l->file);
        reason = file_touch(l->path, &l->file);
        if (reason == ELOOP || reason == EMLINK || reason == EINVAL) return file_error(l->path, "is no file", reason);
        if (reason) return unwritable(case_dir, reason);
        reason = lock_file(l);
    }
    if (reason == EACCES || reason == EAGAIN) return held(case_dir, l->file);
    if (reason) {
        printf("note: %s cannot be locked (%s): see to it that no other run works on this case\n", l->path,
               strerror(reason));
        (void)file_remove(l->path);
        close(l->file);
        l->file = -1;
        return OK;
    }
    name_owner(program, owner);
    size_t n = strlen(owner);
    owner[n++] = '\n';
    /* on a full disk the lock holds, without a name */
    if (ftruncate(l->file, 0) || write(l->file, owner, n) < 0) return OK;
    return OK;
}

status lock_take(const char *case_dir, const char *program, struct lock **out) {
    struct lock *l = NULL;
    *out = NULL;
    TRY(allocate(&l, 1, sizeof *l, "the lock of a case"));
    l->file = -1;
    snprintf(l->path, sizeof l->path, "%.4000s/.haff.lock", case_dir);
    status s = take(l, case_dir, program);
    if (!s && l->file >= 0) {
        *out = l;
        return OK;
    }
    if (l->file >= 0) close(l->file);
    free(l);
    return s;
}

void lock_release(struct lock *l) {
    if (!l) return;
    if (still_there(l))
        (void)file_remove(l->path); /* before the lock is dropped, or the file might belong to the next run */
    close(l->file);
    free(l);
}
