/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fuzz target is one file that defines LLVMFuzzerTestOneInput for one reader; choose.c calls that of the program's
 * name. libFuzzer calls it with inputs it makes; replay.c with the files of a folder, on any compiler. A target aborts
 * where the reader breaks a promise; what the sanitizers see aborts by itself. */
#ifndef TESTS_FUZZ_TARGET_H
#define TESTS_FUZZ_TARGET_H

#include "mesh/format/polymesh.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);

/* PROMISE(what holds, "what it means if not") */
#define PROMISE(holds, text)                                                                                           \
    do {                                                                                                               \
        if (!(holds)) promise_broken(text);                                                                            \
    } while (0)
void promise_broken(const char *text) __attribute__((noreturn));

/* A folder of this process, in memory where there is such a place; removed at exit. */
const char *scratch(void);
/* Writes scratch()/NAME, making the folders above it. */
void scratch_write(const char *name, const void *data, size_t size);
/* An input of several files: each starts with a line `@@ NAME`, a file or one in system, constant or 0. What has no
 * such line is one file, `standard`. All go to scratch()/folder, at most 8; scratch_clear removes what was written
 * last. */
void scratch_unpack(const char *folder, const char *standard, const uint8_t *data, size_t size);
void scratch_clear(void);

/* The status of a reader: an error must have a text and no control characters; it is freed. Returns whether it was OK.
 */
bool accepted(status s);
/* What holds of every mesh that a reader lets pass: it can be checked; and if it is sound, written and read again to
 * the bit in all four formats. Frees it. */
void try_mesh(struct polymesh *m);

#endif
