/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faults of disks and machines, for tests: preloaded (LD_PRELOAD), it counts the calls that change files below the
 * folder HAFF_FAULT_FOLDER, and at call number N of HAFF_FAULT="KIND:N" lets one happen.
 *
 *   count    none; standard error gets the number of calls when the program ends
 *   kill     the process dies (SIGKILL) in place of the call
 *   power    the same, and what was not brought to the disk (fsync) is lost: contents of files, names in folders
 *   torn     the same, but names stay, and of contents the first half; the rest are zeros
 *   full     from this call on nothing can be created or written: ENOSPC
 *   denied   from this call on no name can be made, changed or removed: EACCES
 *   rename   from this call on no rename is done: EXDEV
 *   error    this one call fails: EIO
 *   unsaid   this one call is done, and fails: EIO, as if the answer of a server were lost
 *   slow     each fsync takes N ms, and is done
 *   clock    each N-th reading of the date jumps by ten years, forwards and back in turn
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MOST = 4096, GROWS = 1, NAMES = 2, RENAMES = 4 }; /* what a call does: takes room on the disk, changes names */
struct unsynced { /* a file whose contents, or a name whose folder, is not on the disk yet */
    dev_t device;
    ino_t inode;
    int file;        /* a copy of its descriptor; -1: a name */
    char *from, *to; /* of a rename */
};
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER; /* threads of a program */
static struct { /* the state of the machine; one per process, hence static */
    long calls, dates;
    int count;
    struct unsynced list[MOST];
} disk;

#define REAL(name, type, ...)                                                                                          \
    type (*real)(__VA_ARGS__);                                                                                         \
    *(void **)&real = dlsym(RTLD_NEXT, #name)

static bool below(const char *path) {
    const char *folder = getenv("HAFF_FAULT_FOLDER");
    return folder && !strncmp(path, folder, strlen(folder));
}

static void name_of(int file, char path[PATH_MAX]) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t n = readlink(link, path, PATH_MAX - 1);
    path[n > 0 ? n : 0] = 0;
}

static bool below_file(int file) {
    char path[PATH_MAX];
    name_of(file, path);
    return below(path);
}

/* The path of a name in a folder that is open. */
static const char *join(int at, const char *name, char path[PATH_MAX]) {
    if (at == AT_FDCWD || *name == '/') return name;
    name_of(at, path);
    size_t n = strlen(path);
    snprintf(path + n, PATH_MAX - n, "/%s", name);
    return path;
}

static void lose_power(bool torn) {
    REAL(rename, int, const char *, const char *);
    while (disk.count--) {
        struct unsynced *u = &disk.list[disk.count];
        struct stat info;
        if (u->file >= 0 && fstat(u->file, &info)) abort();
        if (u->file >= 0 && ftruncate(u->file, torn ? info.st_size / 2 : 0)) abort();
        if (u->file >= 0 && torn && ftruncate(u->file, info.st_size)) abort();
        if (u->file < 0 && u->from && !torn) (void)real(u->to, u->from); /* the name it had */
    }
}

static bool is(const char *fault, const char *kind) {
    return !strncmp(fault, kind, strlen(kind));
}

/* 0, or the errno with which a call fails that does `what`; below 0: it is done, and fails with minus that. */
static int happen(int what) {
    const char *fault = getenv("HAFF_FAULT"), *number = fault ? strchr(fault, ':') : NULL;
    long at = number ? atol(number + 1) : -1;
    disk.calls++;
    if (at < 0 || disk.calls < at || is(fault, "slow") || is(fault, "clock")) return 0;
    if (is(fault, "full")) return what & GROWS ? ENOSPC : 0;
    if (is(fault, "denied")) return what & NAMES ? EACCES : 0;
    if (is(fault, "rename")) return what & RENAMES ? EXDEV : 0;
    if (disk.calls > at) return 0;
    if (is(fault, "error")) return EIO;
    if (is(fault, "unsaid")) return -EIO;
    if (is(fault, "power") || is(fault, "torn")) lose_power(is(fault, "torn"));
    kill(getpid(), SIGKILL);
    return EIO;
}

static int happens(int what) {
    pthread_mutex_lock(&one_at_a_time);
    const int why = happen(what);
    pthread_mutex_unlock(&one_at_a_time);
    return why;
}

/* The result of a call that was done: its own, or failure. */
static long said(int why, long result) {
    if (!why) return result;
    errno = -why;
    return -1;
}

static void note(int file, const char *folder_of, const char *from, const char *to) {
    struct stat info;
    char folder[PATH_MAX] = "";
    if (folder_of) snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(folder_of, '/') - folder_of), folder_of);
    if (file >= 0 ? fstat(file, &info) : stat(folder, &info)) return;
    for (int i = 0; file >= 0 && i < disk.count; i++)
        if (disk.list[i].file >= 0 && disk.list[i].inode == info.st_ino && disk.list[i].device == info.st_dev) return;
    if (disk.count == MOST) abort();
    disk.list[disk.count++] = (struct unsynced){info.st_dev, info.st_ino, file >= 0 ? dup(file) : -1,
                                                from ? strdup(from) : NULL, to ? strdup(to) : NULL};
}

static void remember(int file, const char *folder_of, const char *from, const char *to) {
    pthread_mutex_lock(&one_at_a_time);
    note(file, folder_of, from, to);
    pthread_mutex_unlock(&one_at_a_time);
}

static void forget(int file) {
    struct stat info;
    if (fstat(file, &info)) return;
    int kept = 0;
    pthread_mutex_lock(&one_at_a_time);
    for (int i = 0; i < disk.count; i++) {
        struct unsynced *u = &disk.list[i];
        if (u->inode != info.st_ino || u->device != info.st_dev) {
            disk.list[kept++] = *u;
            continue;
        }
        if (u->file >= 0) close(u->file);
        free(u->from);
        free(u->to);
    }
    disk.count = kept;
    pthread_mutex_unlock(&one_at_a_time);
}

/* Waits as long as a slow disk takes for a call. */
static void wait_for_disk(void) {
    const char *fault = getenv("HAFF_FAULT");
    if (!fault || strncmp(fault, "slow:", 5) != 0) return;
    const long ms = atol(fault + 5);
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

#define BEGIN(what)                                                                                                    \
    const int why = happens(what);                                                                                     \
    if (why > 0) {                                                                                                     \
        errno = why;                                                                                                   \
        return -1;                                                                                                     \
    }

int openat(int at, const char *name, int flags, ...) {
    char room[PATH_MAX];
    REAL(openat, int, int, const char *, int, ...);
    va_list args;
    va_start(args, flags);
    mode_t mode = flags & O_CREAT ? va_arg(args, mode_t) : 0;
    va_end(args);
    if (!(flags & O_CREAT) || !below(join(at, name, room))) return real(at, name, flags, mode);
    BEGIN(GROWS | NAMES)
    return (int)said(why, real(at, name, flags, mode));
}

ssize_t write(int file, const void *data, size_t bytes) {
    REAL(write, ssize_t, int, const void *, size_t);
    if (!below_file(file)) return real(file, data, bytes);
    BEGIN(GROWS)
    remember(file, NULL, NULL, NULL);
    return said(why, real(file, data, bytes));
}

int fsync(int file) {
    REAL(fsync, int, int);
    if (!below_file(file)) return real(file);
    BEGIN(0)
    wait_for_disk();
    forget(file);
    return (int)said(why, 0); /* the power cut is ours: the real disk need not be waited for */
}

int renameat(int from_at, const char *from, int to_at, const char *to) {
    char from_room[PATH_MAX], to_room[PATH_MAX];
    const char *old = join(from_at, from, from_room), *new = join(to_at, to, to_room);
    REAL(renameat, int, int, const char *, int, const char *);
    if (!below(new)) return real(from_at, from, to_at, to);
    BEGIN(NAMES | RENAMES)
    int done = real(from_at, from, to_at, to);
    if (!done) remember(-1, new, old, new);
    return (int)said(why, done);
}

int mkdirat(int at, const char *name, mode_t mode) {
    char room[PATH_MAX];
    REAL(mkdirat, int, int, const char *, mode_t);
    if (!below(join(at, name, room))) return real(at, name, mode);
    BEGIN(GROWS | NAMES)
    return (int)said(why, real(at, name, mode));
}

int unlinkat(int at, const char *name, int flags) {
    char room[PATH_MAX];
    REAL(unlinkat, int, int, const char *, int);
    if (!below(join(at, name, room))) return real(at, name, flags);
    BEGIN(NAMES)
    return (int)said(why, real(at, name, flags));
}

/* By how much the date is wrong, s. */
static time_t jump(void) {
    const char *fault = getenv("HAFF_FAULT");
    if (!fault || !is(fault, "clock:")) return 0;
    const long every = atol(fault + 6);
    pthread_mutex_lock(&one_at_a_time);
    const long turn = disk.dates++ / (every > 0 ? every : 1);
    pthread_mutex_unlock(&one_at_a_time);
    return turn % 2 ? 0 : turn % 4 ? -315576000 : 315576000;
}

time_t time(time_t *out) {
    REAL(time, time_t, time_t *);
    const time_t now = real(NULL) + jump();
    if (out) *out = now;
    return now;
}

int clock_gettime(clockid_t clock, struct timespec *out) {
    REAL(clock_gettime, int, clockid_t, struct timespec *);
    const int done = real(clock, out);
    if (!done && clock == CLOCK_REALTIME) out->tv_sec += jump();
    return done;
}

__attribute__((destructor)) static void tell(void) {
    const char *fault = getenv("HAFF_FAULT");
    if (fault && !strncmp(fault, "count", 5) && disk.calls) fprintf(stderr, "%ld calls\n", disk.calls);
}
