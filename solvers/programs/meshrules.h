/* system/meshDict: the types of patches that a mesh generator's file cannot say.
 *   patches { front { type empty; } left { type cyclic; neighbourPatch right; } ... } */
#ifndef SOLVERS_MESHRULES_H
#define SOLVERS_MESHRULES_H

#include "mesh/format/gmsh.h"

struct mesh_rules {
    int n;
    struct gmsh_rule *rule;
    struct dict *dict; /* owns the words */
    char (*where)[4200];
};
/* n = 0 if DIR has no system/meshDict. */
status mesh_rules_read(const char *dir, struct mesh_rules **out);
void mesh_rules_free(struct mesh_rules *r);

#endif
