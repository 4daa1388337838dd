/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads system/meshDict: the types of patches and the depth of a plane, which a mesh generator's file cannot say.
 *   thickness 1; patches { front { type empty; } left { type cyclic; neighbourPatch right; } ... } */
#ifndef SOLVERS_MESHRULES_H
#define SOLVERS_MESHRULES_H

#include "mesh/format/gmsh.h"
#include "solvers/dict/keywords.h"

/* Rules for patches, with the dictionary that owns their words. */
struct mesh_rules {
    int n;
    struct gmsh_rule *rule;
    double thickness;  /* m: of a mesh that is extruded; 0: the file does not say */
    struct dict *dict; /* owns the words; NULL without a file */
    /* [n] "FILE:LINE" of each rule. */
    char (*where)[4200];
};
/* Reads the rules of the case in `dir`; n = 0 if it has no system/meshDict. */
status mesh_rules_read(const char *dir, struct mesh_rules **out);
void mesh_rules_free(struct mesh_rules *r);
void mesh_rules_keywords(struct keywords *k, const void *none); /* goes through the keywords of the file */

#endif
