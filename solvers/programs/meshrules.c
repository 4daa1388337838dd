/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the rules for patches of system/meshDict (meshrules.h). */
#include "solvers/programs/meshrules.h"

#include "solvers/dict/dict.h"
#include "solvers/dict/params.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { PATH = 4096 };

#define PARAM_STRUCT struct mesh_rules
static const struct param file_param[] = {
    NUMBER("thickness", thickness, USUALLY(0, "the size of a cell"), POSITIVE, UNIT(0, 1, 0),
           "to which a mesh of surfaces or lines is extruded; forces in a plane are those on this depth"),
    NOTED("patches", "dictionary", "none", "a dictionary for each patch whose type its name does not say",
          "patches { floor { type wall; } }"),
    IGNORED("axis", "for granularGas"),
};
static const struct param patch_param[] = {
    NOTED("type", "word: patch, wall, empty, symmetry, symmetryPlane, cyclic", NULL, "of the patch in the polyMesh",
          "type cyclic;"),
    NOTED("neighbourPatch", "word", "required with cyclic", "the other half of a cyclic patch",
          "neighbourPatch right;"),
};

void mesh_rules_keywords(struct keywords *k, const void *none) {
    (void)none;
    keywords_at(k, "system/meshDict", "", NULL);
    keywords_params(k, file_param, sizeof file_param / sizeof *file_param);
    keywords_at(k, "system/meshDict", "patches/PATCH", NULL);
    keywords_params(k, patch_param, sizeof patch_param / sizeof *patch_param);
}

void mesh_rules_free(struct mesh_rules *r) {
    if (!r) return;
    if (r->dict) dict_free(r->dict);
    free(r->rule);
    free(r->where);
    free(r);
}

static status read_rules(const char *path, struct mesh_rules *r) {
    struct dict *patches, *p;
    TRY(dict_read(path, &r->dict));
    TRY(params_read(r->dict, file_param, sizeof file_param / sizeof *file_param, r));
    TRY(dict_sub_optional(r->dict, "patches", &patches));
    const int n = patches ? dict_count(patches) : 0;
    TRY(allocate(&r->rule, n, sizeof *r->rule, "rules"));
    TRY(allocate(&r->where, n, sizeof *r->where, "rules"));
    for (; r->n < n; r->n++) {
        struct gmsh_rule *rule = &r->rule[r->n];
        rule->patch = dict_key(patches, r->n);
        snprintf(r->where[r->n], sizeof *r->where, "%s:%d", dict_path(patches), dict_line(patches, rule->patch));
        rule->where = r->where[r->n];
        TRY(dict_sub(patches, rule->patch, &p));
        TRY(dict_word(p, "type", &rule->type));
        if (dict_has(p, "neighbourPatch")) TRY(dict_word(p, "neighbourPatch", &rule->neighbour));
    }
    return dict_check_used(r->dict);
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
