/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one place that opens files and that makes, renames and removes files and folders.
 *
 * Reading goes through links, to regular files of a bounded size. Nothing is written, renamed or removed through a
 * link: the way to what is changed is walked folder by folder, and each is opened without following links. The folder
 * of a case may itself be reached by links: folder_plain replaces its name by one without them. */
#ifndef MESH_FILES_H
#define MESH_FILES_H

#include "mesh/base/status.h"
#include <stdio.h>
#include <sys/types.h>

/* ---- reading ---- */

/* Opens a file for reading; fails, without opening it, on what is no regular file and on one too large to be read. */
status file_open_read(const char *path, int *out, size_t *bytes);
/* The same of a file of any size, for who reads it in pieces. */
status file_open_pieces(const char *path, int *out, size_t *bytes);
/* Fails if PATH and PATH.gz are both there: OpenFOAM's writers leave one, and it is not clear which is meant. */
status file_single(const char *path);
size_t file_most(void); /* bytes of a file that are read at most: 16 GiB, or the memory of this machine */
/* Returns the length of the part of `path` that names the case: the folder above the last `system`, `constant` or time
 * folder, with its '/'; else the file's own folder. */
int path_case(const char *path);
/* Does the file, links followed, lie outside of the folder that the first `length` characters of its path name, which
 * is that of the case? Messages show no text of such a file. */
bool file_is_foreign(const char *path, int length);

/* ---- writing: each returns 0 or an errno; ELOOP: a link stands in the way; EMLINK: the file has other names ---- */

int file_create(const char *path, int *out); /* opens a new, empty file for writing; one that was there is removed */
int file_create_stream(const char *path, FILE **out);
int file_touch(const char *path, int *out); /* opens a file for reading and writing, and makes it if it is missing */
int file_open_again(const char *path, int *out); /* opens a file that file_create made, on another rank */
int file_rename(const char *from, const char *to);
int file_remove(const char *path);
int folder_make(const char *path);       /* makes a folder and its parents; an existing folder is fine */
int folder_remove(const char *path);     /* removes a folder with all in it, or a file; a missing one is fine */
int folder_sync(const char *path);       /* brings a folder with all in it to the disk */
int folder_sync_names(const char *path); /* brings its list of names to the disk */
/* Returns the error for such an errno: "PATH: WHAT: reason", or which link stands in the way, and the cure. */
status file_error(const char *path, const char *what, int reason);
bool path_is_link(const char *path);
status file_link_error(const char *link); /* the error for a link in the way of writing */

/* ---- the folder of a case ---- */

enum { PLAIN_PATH = 4096 };
/* Writes the folder's name to out: as it is, or, where a link is part of it, its real path. */
status folder_plain(const char *dir, char out[PLAIN_PATH]);

struct folder_mark { /* tells a folder from another one that stands under its name later */
    dev_t device;
    ino_t inode;
};
status folder_mark(const char *dir, struct folder_mark *out);
/* Fails if the folder is gone, or another one stands in its place. */
status folder_check(const char *dir, const struct folder_mark *m);

#endif
