#include "solvers/meshrules.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { PATH = 4096 };

void mesh_rules_free(struct mesh_rules *r) {
    if (!r) return;
    free(r->rule);
    free(r->where);
    free(r);
}

static status read_rules(const char *path, struct mesh_rules *r) {
    (void)r;
    return fail(ERR_INPUT, "%s: dictionaries are not read yet", path);
}

status mesh_rules_read(const char *dir, struct mesh_rules **out) {
    char path[PATH], zipped[PATH + 8];
    *out = NULL;
    struct mesh_rules *r;
    TRY(allocate(&r, 1, sizeof *r, "rules"));
    snprintf(path, sizeof path, "%s/system/meshDict", dir);
    snprintf(zipped, sizeof zipped, "%s.gz", path);
    status s = OK;
    if (access(path, F_OK) == 0 || access(zipped, F_OK) == 0) s = read_rules(path, r);
    if (s)
        mesh_rules_free(r);
    else
        *out = r;
    return s;
}
