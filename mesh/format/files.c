/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens files for reading and writing, and makes, renames and removes files and folders (files.h). */
#define _GNU_SOURCE /* O_PATH, sync_file_range */
#include "mesh/format/files.h"

#include "mesh/base/background.h"
#include "mesh/format/foamfile.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- reading ----------------------------------------------------------------------------------------------------- */

size_t file_most(void) {
    const size_t most = (size_t)16 << 30;
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 && (size_t)pages < most / (size_t)page ? (size_t)pages * (size_t)page : most;
}

static status check_kind(const char *path, const struct stat *info, bool pieces) {
    const mode_t m = info->st_mode;
    const char *kind = S_ISDIR(m)                 ? "a folder"
                       : S_ISFIFO(m)              ? "a pipe"
                       : S_ISCHR(m) || S_ISBLK(m) ? "a device"
                                                  : "a socket";
    if (!S_ISREG(m)) return fail(ERR_INPUT, "%s: is no file but %s; put the file there, or a link to it", path, kind);
    if (pieces || (size_t)info->st_size <= file_most()) return OK;
    return fail(ERR_INPUT,
                "%s: the file has %.3g GiB; at most %.3g GiB are read (16 GiB, or the memory of this machine): is it "
                "the right file? With  writeFormat binary;  fields are smaller",
                path, (double)info->st_size / (1 << 30), (double)file_most() / (1 << 30));
}

/* A device is not even opened, because that can have effects; O_NONBLOCK is for a pipe that took the file's place. */
static status open_read(const char *path, bool pieces, int *out, size_t *bytes) {
    struct stat info;
    *out = -1;
    if (stat(path, &info)) return fail(ERR_INPUT, "%s: cannot open: %s", path, strerror(errno));
    TRY(check_kind(path, &info, pieces));
    int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) return fail(ERR_INPUT, "%s: cannot open: %s", path, strerror(errno));
    status s = fstat(file, &info) ? fail(ERR_INPUT, "%s: cannot open: %s", path, strerror(errno))
                                  : check_kind(path, &info, pieces);
    if (s) {
        close(file);
        return s;
    }
    *out = file;
    *bytes = (size_t)info.st_size;
    return OK;
}

status file_open_read(const char *path, int *out, size_t *bytes) {
    return open_read(path, false, out, bytes);
}

status file_single(const char *path) {
    struct stat plain, zipped;
    char other[PATH_MAX];
    const int n = snprintf(other, sizeof other, "%s.gz", path);
    if (n < 0 || (size_t)n >= sizeof other || stat(path, &plain) || stat(other, &zipped)) return OK;
    const bool later = zipped.st_mtim.tv_sec > plain.st_mtim.tv_sec || (zipped.st_mtim.tv_sec == plain.st_mtim.tv_sec &&
                                                                        zipped.st_mtim.tv_nsec > plain.st_mtim.tv_nsec);
    return fail(ERR_INPUT, "%s: %s stands beside it, and only one of both can be meant: remove the other (%s is newer)",
                path, other, later ? other : path);
}

status file_open_pieces(const char *path, int *out, size_t *bytes) {
    return open_read(path, true, out, bytes);
}

int path_case(const char *path) {
    const char *end = strrchr(path, '/');
    int length = end ? (int)(end - path) + 1 : 0;
    for (const char *p = path, *next; (next = strchr(p, '/')); p = next + 1) {
        double time;
        char part[64];
        snprintf(part, sizeof part, "%.*s", (int)(next - p), p);
        const char *rest = foam_number(part, &time);
        const bool folder = !strcmp(part, "system") || !strcmp(part, "constant") || !strcmp(part, "0.orig");
        if (folder || (rest && !*rest)) length = (int)(p - path);
    }
    return length;
}

bool file_is_foreign(const char *path, int length) {
    char folder[PATH_MAX];
    if (snprintf(folder, sizeof folder, "%.*s", length, path) >= (int)sizeof folder) return true;
    char *real = realpath(path, NULL), *top = realpath(length ? folder : ".", NULL);
    const size_t n = top ? strlen(top) : 0;
    const bool inside = real && top && !strncmp(real, top, n) && (real[n] == '/' || !strcmp(top, "/"));
    free(real);
    free(top);
    return !inside;
}

/* ---- the way to what is changed ---------------------------------------------------------------------------------- */

static bool is_link(int at, const char *name) {
    struct stat info;
    return !fstatat(at, name, &info, AT_SYMLINK_NOFOLLOW) && S_ISLNK(info.st_mode);
}

/* Opens the folder `name` of the folder `at`, which is closed. Returns -1 with errno. */
static int enter(int at, const char *name, bool make) {
    const int flags = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    int next = openat(at, name, flags), why = errno;
    if (next < 0 && why == ENOENT && make) {
        next = mkdirat(at, name, 0777) && errno != EEXIST ? -1 : openat(at, name, flags);
        why = errno;
    }
    if (next < 0 && why == ENOTDIR && is_link(at, name)) why = ELOOP;
    close(at);
    errno = why;
    return next;
}

/* Opens the folder that the first `length` characters of a path name. Returns -1 with errno. */
static int walk(const char *path, size_t length, bool make) {
    int at = open(*path == '/' ? "/" : ".", O_PATH | O_DIRECTORY | O_CLOEXEC);
    for (size_t i = 0, n; at >= 0 && i < length; i += n + 1) {
        char part[NAME_MAX + 1];
        n = strcspn(path + i, "/");
        if (n > length - i) n = length - i;
        if (n > NAME_MAX) {
            close(at);
            errno = ENAMETOOLONG;
            return -1;
        }
        memcpy(part, path + i, n);
        part[n] = 0;
        if (n && strcmp(part, ".") != 0) at = enter(at, part, make);
    }
    return at;
}

/* Opens the folder that holds the file; *name is the file's name in it. */
static int walk_to(const char *path, const char **name) {
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    return walk(path, (size_t)(*name - path), false);
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* Makes a new file. A file of that name is removed, not emptied: it may have other names, in a copy made by `cp -al`,
 * whose content must stay. */
int file_create(const char *path, int *out) {
    const char *name;
    int at = walk_to(path, &name), why = EEXIST;
    *out = -1;
    if (at < 0) return errno;
    for (int i = 0; i < 2 && why == EEXIST; i++) {
        *out = openat(at, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        why = *out < 0 ? errno : 0;
        if (why == EEXIST && is_link(at, name)) why = ELOOP;
        if (why == EEXIST && i == 0 && unlinkat(at, name, 0) && errno != ENOENT) why = errno;
    }
    close(at);
    return why;
}

int file_create_stream(const char *path, FILE **out) {
    int file, why = file_create(path, &file);
    *out = why ? NULL : fdopen(file, "w");
    if (why || *out) return why;
    why = errno;
    close(file);
    return why;
}

static int open_old(const char *path, int flags, int *out) {
    const char *name;
    struct stat info;
    int at = walk_to(path, &name), why = 0;
    *out = -1;
    if (at < 0) return errno;
    int file = openat(at, name, flags | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666);
    if (file < 0 || fstat(file, &info))
        why = errno;
    else if (!S_ISREG(info.st_mode))
        why = EINVAL;
    else if (info.st_nlink > 1)
        why = EMLINK;
    close(at);
    if (!why) *out = file;
    if (why && file >= 0) close(file);
    return why;
}

int file_touch(const char *path, int *out) {
    return open_old(path, O_RDWR | O_CREAT, out);
}

int file_open_again(const char *path, int *out) {
    return open_old(path, O_WRONLY, out);
}

int file_rename(const char *from, const char *to) {
    const char *old, *new;
    int a = walk_to(from, &old), why = errno;
    if (a < 0) return why;
    const char *slash = strrchr(to, '/');
    const size_t folder = slash ? (size_t)(slash + 1 - to) : 0;
    const bool same = folder == (size_t)(old - from) && !strncmp(from, to, folder);
    int b = same ? a : walk_to(to, &new);
    if (same) new = to + folder;
    why = b < 0 || renameat(a, old, b, new) ? errno : 0;
    close(a);
    if (b >= 0 && !same) close(b);
    return why;
}

int file_remove(const char *path) {
    const char *name;
    int at = walk_to(path, &name);
    if (at < 0) return errno;
    int why = unlinkat(at, name, 0) ? errno : 0;
    close(at);
    return why;
}

int folder_make(const char *path) {
    int at = walk(path, strlen(path), true);
    if (at < 0) return errno;
    close(at);
    return 0;
}

/* Does something to each entry of a folder, the descriptor of which is closed; stops at the first errno. */
static int each_entry(int folder, int (*act)(int at, const char *name, void *context), void *context) {
    DIR *list = fdopendir(folder);
    int why = 0;
    if (!list) {
        why = errno;
        close(folder);
        return why;
    }
    for (struct dirent *entry; !why && (entry = readdir(list));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            why = act(folder, entry->d_name, context);
    closedir(list);
    return why;
}

static int remove_at(int at, const char *name, void *unused) {
    struct stat info;
    if (fstatat(at, name, &info, AT_SYMLINK_NOFOLLOW)) return errno == ENOENT ? 0 : errno;
    if (!S_ISDIR(info.st_mode)) return unlinkat(at, name, 0) ? errno : 0;
    int folder = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0) return errno;
    int why = each_entry(folder, remove_at, unused);
    return why ? why : unlinkat(at, name, AT_REMOVEDIR) ? errno : 0;
}

int folder_remove(const char *path) {
    const char *name;
    int at = walk_to(path, &name);
    if (at < 0) return errno == ENOENT ? 0 : errno;
    int why = remove_at(at, name, NULL);
    close(at);
    return why;
}

enum { TOGETHER = 64 };
struct syncing { /* files, and folders with their lists of names, that are brought to the disk together */
    int n, file[TOGETHER], why[TOGETHER];
};

static void sync_one(void *context, int i) {
    struct syncing *s = context;
    s->why[i] = fsync(s->file[i]) ? errno : 0;
    if (close(s->file[i]) && !s->why[i]) s->why[i] = errno;
}

/* Waits for all at the same time: a disk takes several in hand, and a journal writes one entry for them. */
static int sync_all(struct syncing *s) {
    int why = 0;
    background_each(s->n, sync_one, s);
    for (int i = 0; i < s->n && !why; i++) why = s->why[i];
    s->n = 0;
    return why;
}

static int gather_one(int at, const char *name, struct syncing *s) {
    const int why = s->n == TOGETHER ? sync_all(s) : 0;
    const int file = why ? -1 : openat(at, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return why ? why : errno;
    s->file[s->n++] = file;
    return 0;
}

/* Gathers a file, or a folder with all in it. The system begins to write each file here: it may then give all of them
 * their place on the disk at once, and not one by one as each is synced. That is a hint, failures are those of sync_one
 * to report. */
static int gather(int at, const char *name, void *context) {
    struct syncing *s = context;
    struct stat info;
    int why = gather_one(at, name, s);
    if (why || fstat(s->file[s->n - 1], &info)) return why ? why : errno;
    if (!S_ISDIR(info.st_mode)) {
        (void)sync_file_range(s->file[s->n - 1], 0, 0, SYNC_FILE_RANGE_WRITE);
        return 0;
    }
    const int folder = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    return folder < 0 ? errno : each_entry(folder, gather, s);
}

static int sync_path(const char *path, bool with_all) {
    struct syncing s = {.n = 0};
    int at = walk(path, strlen(path), false);
    if (at < 0) return errno;
    const int missed = with_all ? gather(at, ".", &s) : gather_one(at, ".", &s), why = sync_all(&s);
    close(at);
    return missed ? missed : why;
}

int folder_sync(const char *path) {
    return sync_path(path, true);
}

int folder_sync_names(const char *path) {
    return sync_path(path, false);
}

/* Finds the first link in a path. */
static bool find_link(const char *path, char out[PATH_MAX]) {
    struct stat info;
    if (snprintf(out, PATH_MAX, "%s", path) >= PATH_MAX) return false;
    for (char *end = out + (*out == '/');; *end++ = '/') {
        end += strcspn(end, "/");
        const bool last = !*end;
        *end = 0;
        if (!lstat(out, &info) && S_ISLNK(info.st_mode)) return true;
        if (last) return false;
    }
}

status file_link_error(const char *link) {
    return fail(ERR_INPUT,
                "%s: this is a link, and nothing is written through a link: remove it, or put what it leads to in its "
                "place (rm the link, mv the original there)",
                link);
}

bool path_is_link(const char *path) {
    return is_link(AT_FDCWD, path);
}

status file_error(const char *path, const char *what, int reason) {
    char link[PATH_MAX];
    if (reason == ELOOP && find_link(path, link)) return file_link_error(link);
    if (reason == EMLINK)
        return fail(
            ERR_INPUT,
            "%s: this file has another name elsewhere (a hard link), and what is written here would show there: "
            "remove it here",
            path);
    return fail(ERR_SYSTEM, "%s: %s: %s", path, what, strerror(reason));
}

/* ---- the folder of a case ---------------------------------------------------------------------------------------- */

status folder_plain(const char *dir, char out[PLAIN_PATH]) {
    char link[PATH_MAX];
    char *real = find_link(dir, link) ? realpath(dir, NULL) : NULL;
    const bool fits = snprintf(out, PLAIN_PATH, "%s", real ? real : dir) < PLAIN_PATH;
    free(real);
    return fits ? OK : fail(ERR_INPUT, "%.200s...: the path is too long", dir);
}

status folder_mark(const char *dir, struct folder_mark *out) {
    struct stat info;
    if (stat(dir, &info)) return fail(ERR_INPUT, "%s: %s; give the folder of a case", dir, strerror(errno));
    *out = (struct folder_mark){info.st_dev, info.st_ino};
    return OK;
}

status folder_check(const char *dir, const struct folder_mark *m) {
    struct stat info;
    if (stat(dir, &info))
        return fail(
            ERR_SYSTEM,
            "%s: this folder is gone (%s): it was removed or renamed while the run was at work in it; if it was "
            "moved, a run there goes on from its last time",
            dir, strerror(errno));
    if (info.st_dev == m->device && info.st_ino == m->inode) return OK;
    return fail(ERR_SYSTEM,
                "%s: another folder stands here than the one in which the run began, which was moved or removed while "
                "the run was at work in it; nothing is written into the new one; if the old one was moved, a run there "
                "goes on from its last time",
                dir);
}
