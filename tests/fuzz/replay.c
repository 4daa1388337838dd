/* SPDX-License-Identifier: GPL-3.0-or-later */
/* replay FILE|FOLDER...: gives every file to the target, in the order of names. Without sanitizers it bounds memory and
 * time itself, so that a bomb fails and does not take the machine along. */
#include "tests/fuzz/target.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#if defined __SANITIZE_ADDRESS__
#define SANITIZED
#elif defined __has_feature
#if __has_feature(address_sanitizer)
#define SANITIZED
#endif
#endif

enum { PATH = 4096, MOST_KB = 320 * 1024 }; /* the most entries that a dictionary may copy take 260 MB */

/* A library that asks for too much may get it, or say no in good order: neither crashes. */
static void check_memory(void) {
#ifndef SANITIZED
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    PROMISE(used.ru_maxrss < MOST_KB, "a small file is read in little memory");
#endif
}

static long replay(const char *path) {
    struct stat info;
    if (stat(path, &info)) {
        fprintf(stderr, "replay: there is no %s\n", path);
        exit(1);
    }
    if (S_ISDIR(info.st_mode)) {
        struct dirent **list;
        long all = 0;
        int n = scandir(path, &list, NULL, alphasort);
        for (int i = 0; i < n; i++) {
            char inside[PATH];
            snprintf(inside, sizeof inside, "%s/%s", path, list[i]->d_name);
            if (*list[i]->d_name != '.') all += replay(inside);
            free(list[i]);
        }
        if (n >= 0) free(list);
        return all;
    }
    size_t size = (size_t)info.st_size;
    uint8_t *data = malloc(size ? size : 1); /* exact: the sanitizer sees what is read behind it */
    FILE *f = fopen(path, "rb");
    if (!data || !f || fread(data, 1, size, f) != size) {
        fprintf(stderr, "replay: cannot read %s\n", path);
        exit(1);
    }
    fclose(f);
    printf("%s\n", path);
    fflush(stdout);
    LLVMFuzzerTestOneInput(data, size);
    free(data);
    check_memory();
    return 1;
}

int main(int argc, char **argv) {
#ifndef SANITIZED
    struct rlimit memory = {1L << 30, 1L << 30}, seconds = {300, 300};
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CPU, &seconds);
#endif
    LLVMFuzzerInitialize(&argc, &argv);
    long all = 0;
    for (int i = 1; i < argc; i++) all += replay(argv[i]);
    printf("%ld inputs\n", all);
    return all ? 0 : 1;
}
