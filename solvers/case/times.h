/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time folders of a case: they are found, named, purged, and written so that each appears whole or not at all. */
#ifndef SOLVERS_TIMES_H
#define SOLVERS_TIMES_H

#include "mesh/base/comm.h"
#include "solvers/case/checksums.h"
#include "solvers/case/control.h"

enum { TIME_NAME = 64, TIME_PATH = 4096 };

/* The folder 0.orig holds a start as its user writes it: by expressions, settledLayer, perturbation. A run that begins
 * there writes the folder 0, the state that it starts from, as any other time, for all who read it. */
#define TIME_ORIGINAL "0.orig"

struct instant { /* a time folder */
    char name[TIME_NAME];
    char folder[TIME_NAME]; /* the folder that the state is read from: the same, or TIME_ORIGINAL */
    double t;               /* s: from uniform/time where that file is, else from the name */
    long step;              /* 0 without uniform/time */
    double delta_t;         /* s: length of the last step; 0 without uniform/time */
    int digits;             /* digits of ascii numbers; 6 without uniform/time */
    bool beside;            /* is it the time 0 of a user, beside TIME_ORIGINAL? */
};
/* Lists all time folders of the case, ascending; a folder with a uniform/time that cannot be read goes by its name.
 * *out is malloc'd. */
status times_list(const char *case_dir, int *n, struct instant **out);
bool time_is_original(const struct instant *at); /* is it read from TIME_ORIGINAL? */
/* Sets *out to the start of TIME_ORIGINAL; *out keeps its value, and false is returned, if there is no such folder. */
bool time_original(const char *case_dir, struct instant *out);
/* Are the files of that time as they were written (checksums.h), and does uniform/time fit the folder's name? */
status time_verify(const char *case_dir, const struct instant *at);
/* Finds the folder that startFrom chooses, or TIME_ORIGINAL if `afresh`. TIME_ORIGINAL stands for the time 0 that a run
 * wrote from it. A time 0 that no run wrote, as setFields makes it of a copy, counts in its place if it is newer and
 * has all its fields (out->beside), else it is an error. The error lists the folders that are there. A damaged folder
 * is an error, or, if onCorruptTime says previous, the newest whole one before it is taken and the log says so. */
status times_start(const char *case_dir, const struct control *c, bool afresh, struct instant *out);

/* Writes the folder's name for time t. */
void time_name(enum time_format format, int precision, double t, char name[TIME_NAME]);
/* Writes the name with as many more digits as tell t from `other` (a time written before; NAN: none). Returns the
 * precision. */
int time_name_apart(enum time_format format, int precision, double t, double other, char name[TIME_NAME]);

/* Makes the hidden folder CASE/.NAME.tmp (empty) with a `uniform` folder in it; tmp is its path. */
status time_begin(const char *case_dir, const char *name, char tmp[TIME_PATH]);
/* Puts that folder in place of CASE/NAME. A power cut does not undo it: all is on the disk before this returns. */
status time_commit(const char *case_dir, const char *name);
/* Writes uniform/time of the folder at `path`; then, if sums is not NULL, uniform/checksums of that file and of the
 * files in `sums`. */
status time_stamp_write(const char *path, const struct instant *at, struct checksums *sums);

status remove_folder(const char *path); /* removes a folder with all in it; a missing folder is fine */
/* Removes CASE/NAME, at once in the eyes of other programs. */
status time_remove(const char *case_dir, const char *name);
status make_folders(const char *path); /* makes a folder and its parents; an existing folder is fine */
/* Removes hidden folders that a killed run left behind, or puts the only copy of a time back. */
status times_clean(const char *case_dir);

#endif
