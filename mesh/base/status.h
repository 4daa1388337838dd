/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors as values. A function that can fail returns a `status`: OK, or an error that says what is wrong, what is
 * allowed and what to do. The caller passes it up with TRY or owns it (status_print, then status_free). */
#ifndef MESH_STATUS_H
#define MESH_STATUS_H

#include <stdbool.h>

enum status_kind {
    ERR_INPUT = 1, /* the user's case or command line is wrong: exit code 1 */
    ERR_STATE = 2, /* the run left the admissible states: exit code 2 */
    ERR_SYSTEM = 3 /* disk, memory, MPI: exit code 3 */
};

struct error;
typedef struct error *status;
#define OK ((status)0)

/* Returns a new error with the text of a printf format. The text reads "FILE:LINE: what was found; what is allowed; the
 * cure". */
status fail(enum status_kind kind, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Puts a line of context in front of an error ("while reading ..."); OK stays OK. */
status status_note(status s, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Records one place (file, line) on the error's way up, which -debug shows; returns s. */
status status_up(status s, const char *file, int line);

enum status_kind status_kind(status s); /* s is an error */
const char *status_text(status s);      /* s is an error */

/* Prints an error to stderr, with its way up if `trail`; returns the exit code (0 for OK). Does not free the error. */
int status_print(status s, bool trail);
void status_free(status s); /* OK is allowed */

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        status try_status_ = (call);                                                                                   \
        if (try_status_) return status_up(try_status_, __FILE__, __LINE__);                                            \
    } while (0)

/* Sets *out, a pointer to any type, to `count` zeroed objects of `size` bytes, aligned to 64 bytes; the caller calls
 * free(). The error names the objects by `what`. */
status allocate(void *out, long count, long size, const char *what);
/* As allocate, but the values are not set: for a large buffer of which a small file fills little. Each page that is
 * first written costs a page fault, which takes as long as a thousand operations. */
status allocate_unset(void *out, long count, long size, const char *what);
/* Gives memory that was freed back to the machine, where the C library keeps it for later: behind a part of the set-up
 * that takes more than it leaves. */
void release_freed(void);

#endif
