/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIME/uniform/checksums: size and CRC-32 of each file that a run wrote into a time folder, so that no run starts again
 * from a file that was cut, lost or changed on the disk. */
#ifndef SOLVERS_CHECKSUMS_H
#define SOLVERS_CHECKSUMS_H

#include "mesh/format/foamfile.h"

enum { CHECKSUMS_MOST = 128 };
struct checksums { /* collected while a time is written; sum[i] belongs to name[i], relative to the folder */
    int n;
    int part;                         /* N + 1 for a time of processorN, 0 for one of the case */
    const char *name[CHECKSUMS_MOST]; /* static strings */
    struct file_sum sum[CHECKSUMS_MOST];
};
status checksums_add(struct checksums *c, const char *name, struct file_sum sum);
/* Writes FOLDER/uniform/checksums. The same results give the same file, compressed or not, on any machine. */
status checksums_write(const struct checksums *c, const char *folder, const char *time_name);
/* Checks that every file listed is there and has its contents. OK also in a folder without uniform/checksums, or with
 * that of a part, which reconstructPar copies. The error names the file and what is wrong, without a cure. */
status checksums_verify(const char *folder);

#endif
