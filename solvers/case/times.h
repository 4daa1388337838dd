/* Time folders of a case: found, named, written so that each appears whole or not at all, and purged. */
#ifndef SOLVERS_TIMES_H
#define SOLVERS_TIMES_H

#include "mesh/base/comm.h"
#include "solvers/case/checksums.h"
#include "solvers/case/control.h"

enum { TIME_NAME = 64, TIME_PATH = 4096 };

struct instant { /* a time folder */
    char name[TIME_NAME];
    double t;       /* s: from uniform/time where that is, else the name */
    long step;      /* 0 without uniform/time */
    double delta_t; /* s: the last step; 0 without uniform/time */
    int digits;     /* of ascii numbers; 6 without uniform/time */
};
/* All time folders of the case, ascending; one with a uniform/time that cannot be read goes by its name. *out is
 * malloc'd. */
status times_list(const char *case_dir, int *n, struct instant **out);
/* Are the files of that time as they were written (checksums.h), and does uniform/time fit the folder's name? */
status time_verify(const char *case_dir, const struct instant *at);
/* The folder that startFrom chooses; an error lists those there are. One that is damaged is an error, or, if
 * onCorruptTime says previous, the newest whole one before it is taken and the log says so. */
status times_start(const char *case_dir, const struct control *c, struct instant *out);

/* The folder's name for time t. */
void time_name(enum time_format format, int precision, double t, char name[TIME_NAME]);
/* The same, with as many more digits as tell t from `other` (a time written before; NAN: none). Returns the precision.
 */
int time_name_apart(enum time_format format, int precision, double t, double other, char name[TIME_NAME]);

/* Makes the hidden folder CASE/.NAME.tmp (empty) with a `uniform` folder in it; its path in tmp. */
status time_begin(const char *case_dir, const char *name, char tmp[TIME_PATH]);
/* Puts it in place of CASE/NAME, which a power cut does not undo: all is on the disk before this returns. */
status time_commit(const char *case_dir, const char *name);
/* uniform/time of the folder at `path`; then, unless NULL, uniform/checksums of it and of the files in `sums`. */
status time_stamp_write(const char *path, const struct instant *at, struct checksums *sums);

status remove_folder(const char *path); /* with all in it; missing is fine */
/* CASE/NAME goes, at once for whoever looks. */
status time_remove(const char *case_dir, const char *name);
status make_folders(const char *path); /* with its parents; there already is fine */
/* Hidden folders that a killed run left behind. */
status times_clean(const char *case_dir);

#endif
