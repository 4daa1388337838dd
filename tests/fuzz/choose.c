/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One program holds all targets, for each one would be linked as long. Its links, fuzz_NAME or replay_NAME, say which.
 */
#include "tests/fuzz/target.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define T(name) int fuzz_##name(const uint8_t *data, size_t size);
TARGETS
#undef T
#define T(name) {#name, fuzz_##name},

static const struct {
    const char *name;
    int (*call)(const uint8_t *data, size_t size);
} target[] = {TARGETS};

static int (*chosen)(const uint8_t *data, size_t size);

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc;
    const char *name = strrchr(**argv, '_');
    for (size_t i = 0; name && i < sizeof target / sizeof *target; i++)
        if (!strcmp(name + 1, target[i].name)) chosen = target[i].call;
    if (chosen) return 0;
    fprintf(stderr, "%s: the name of this program must end with that of a target, as fuzz_dict\n", **argv);
    exit(1);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return chosen(data, size);
}
