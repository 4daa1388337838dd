/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/format/gmsh.h"
#include "tests/fuzz/target.h"

#include <stdio.h>
#include <string.h>

static bool mentions(const uint8_t *data, size_t size, const char *word) {
    size_t n = strlen(word);
    for (size_t i = 0; i + n <= size; i++)
        if (!memcmp(data + i, word, n)) return true;
    return false;
}

/* Patches `left` and `right` are cyclic. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const struct gmsh_rule rules[] = {{"left", "cyclic", "right", "rules:1"},
                                             {"right", "cyclic", "left", "rules:2"}};
    char path[256];
    struct polymesh *m = NULL;
    bool cyclic = mentions(data, size, "\"left\"") && mentions(data, size, "\"right\"");
    scratch_unpack("msh", "m.msh", data, size);
    snprintf(path, sizeof path, "%s/msh/m.msh", scratch());
    bool good = accepted(gmsh_read(path, rules, cyclic ? 2 : 0, &m));
    PROMISE(good == (m != NULL), "there is a mesh if there is no error");
    if (good) try_mesh(m);
    scratch_clear();
    return 0;
}
