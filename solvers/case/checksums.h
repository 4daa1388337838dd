/* TIME/uniform/checksums: size and CRC-32 of each file that a run wrote into a time folder, so that none is taken up
 * again that was cut, lost or changed on the disk. */
#ifndef SOLVERS_CHECKSUMS_H
#define SOLVERS_CHECKSUMS_H

#include "mesh/format/foamfile.h"

enum { CHECKSUMS_MOST = 64 };
struct checksums { /* collected while a time is written; sum[i] belongs to name[i], relative to the folder */
    int n;
    int part;                         /* N + 1 of a folder of processorN; 0: of the case */
    const char *name[CHECKSUMS_MOST]; /* static */
    struct file_sum sum[CHECKSUMS_MOST];
};
status checksums_add(struct checksums *c, const char *name, struct file_sum sum);
/* FOLDER/uniform/checksums. The same results give the same file, compressed or not, by whatever machine. */
status checksums_write(const struct checksums *c, const char *folder, const char *time_name);
/* Every file it lists is there and has its contents; OK also in a folder that has no uniform/checksums, or that of a
 * part, which reconstructPar copies. The error names the file and what is wrong, without a cure. */
status checksums_verify(const char *folder);

#endif
