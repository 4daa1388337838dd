/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads system/blockMeshDict (blockmesh.h). Whatever in it is no union of boxes of equal cells is refused by name. */
#include "solvers/case/blockmesh.h"

#include "mesh/base/comm.h"
#include "mesh/format/boxes.h"
#include "mesh/spread/spread.h"
#include "mesh/spread/wedge.h"
#include "solvers/dict/params.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BLOCKS = 1000 };
static const double FAR = 1e60; /* m: that of a polyMesh */
#define GO_ON "; OpenFOAM's blockMesh makes a constant/polyMesh of it, which is read in its place"

static const struct param file_param[] = {
    NOTED("scale", "number", "1", "times the coordinates of the vertices: metres", "scale 0.04;"),
    NOTED("convertToMeters", "number", "1", "older name of scale", "convertToMeters 0.04;"),
    NOTED("vertices", "list ((x y z) ..)", NULL, "corners of the blocks",
          "vertices ((0 0 0) (2 0 0) (2 1 0) (0 1 0) (0 0 1) (2 0 1) (2 1 1) (0 1 1));"),
    NOTED("blocks", "list (hex (v0 .. v7) (nx ny nz) simpleGrading (1 1 1) ..)", NULL,
          "boxes along x, y, z, all of equal cells; v0 .. v3 go round the floor, v4 .. v7 in the same order round the "
          "top",
          "blocks (hex (0 1 2 3 4 5 6 7) (40 20 1) simpleGrading (1 1 1));"),
    NOTED("boundary", "list (NAME { .. } ..)", NULL, "the patches",
          "boundary (floor { type wall; faces ((0 1 5 4)); });"),
    NOTED("defaultPatch", "dictionary", "none: no side may be left", "the patch of all sides that `boundary` leaves",
          "defaultPatch { name walls; type wall; }"),
    NOTED("edges", "list: ()", "()", "curved edges: none are allowed", "edges ();"),
    NOTED("faces", "list: ()", "()", "projected faces: none are allowed", "faces ();"),
    NOTED("mergePatchPairs", "list: ()", "()", "patches to be joined: none are allowed", "mergePatchPairs ();"),
    IGNORED("fastMerge", "for blockMesh"),
};
static const struct param patch_param[] = {
    NOTED("type", "word: patch, wall, empty, symmetry, symmetryPlane, cyclic", NULL, "of the patch", "type cyclic;"),
    NOTED("neighbourPatch", "word", "required with cyclic", "the other half of a cyclic patch, which names this one",
          "neighbourPatch right;"),
    NOTED("faces", "list ((a b c d) ..)", NULL, "sides of blocks, by their vertices", "faces ((0 4 7 3));"),
    NOTED("inGroups", "list of words", "()", "groups that it is in, besides that of its type", "inGroups (solid);"),
    IGNORED("transform", "for OpenFOAM's programs: cyclic patches are moved along their axis"),
    IGNORED("matchTolerance", "for OpenFOAM's programs"),
};
static const struct param default_param[] = {
    NOTED("name", "word", NULL, "of the patch", "name walls;"),
    NOTED("type", "word: patch, wall, empty, symmetry, symmetryPlane", NULL, "of that patch", "type wall;"),
};
#define COUNT(table) ((int)(sizeof table / sizeof *table))

void blockmesh_keywords(struct keywords *k) {
    const char *file = "system/blockMeshDict";
    keywords_at(k, file, "", NULL);
    keywords_params(k, file_param, COUNT(file_param));
    keywords_at(k, file, "boundary/PATCH", NULL);
    keywords_params(k, patch_param, COUNT(patch_param));
    keywords_at(k, file, "defaultPatch", NULL);
    keywords_params(k, default_param, COUNT(default_param));
}

struct block_reader {
    struct dict *d;
    int nvertices;
    double *vertex; /* [nvertices][3] m */
    int nblocks;
    struct boxes_block block[BLOCKS];
    int line[BLOCKS]; /* of each block */
    int npatches;
    struct boxes_patch *patch; /* [npatches], then that of all other sides */
    char **groups;             /* [npatches], owned */
    struct boxes *boxes;
};

static status read_vertices(struct block_reader *r) {
    const double *given;
    double scale = 1, most = 0;
    TRY(dict_number_or(r->d, "convertToMeters", NULL, 1, &scale));
    TRY(dict_number_or(r->d, "scale", NULL, scale, &scale));
    if (!(scale > 0))
        return dict_fail(r->d, dict_has(r->d, "scale") ? "scale" : "convertToMeters", "it must be above 0");
    TRY(status_note(dict_vectors(r->d, "vertices", &r->nvertices, &given), "vertices are a list of points (x y z)"));
    TRY(allocate(&r->vertex, 3L * r->nvertices + 1, sizeof(double), "vertices"));
    for (long i = 0; i < 3L * r->nvertices; i++) {
        r->vertex[i] = scale * given[i];
        if (!(fabs(r->vertex[i]) <= FAR))
            return dict_fail(r->d, "vertices", "vertex %ld lies beyond %g m: volumes would be no numbers", i / 3, FAR);
        most = fmax(most, fabs(r->vertex[i]));
    }
    if (most < LEAST_NUMBER)
        return dict_fail(r->d, "vertices", "all lie within %g m: volumes would be 0; is the scale right?",
                         LEAST_NUMBER);
    return OK;
}

/* Reads `( n n .. )`, n whole numbers of low .. high. */
static status read_labels(struct lexer *l, int n, int low, int high, const char *what, int *out) {
    struct token t;
    TRY(lexer_expect(l, '('));
    for (int i = 0; i < n; i++) {
        TRY(lexer_next(l, &t));
        if (t.kind != TOKEN_NUMBER || !(t.number >= low && t.number <= high) || t.number != (int)t.number)
            return lexer_fail(l, &t, "%s: whole numbers from %d to %d, %d of them", what, low, high, n);
        out[i] = (int)t.number;
    }
    return lexer_expect(l, ')');
}

/* Reads `simpleGrading (1 1 1)` or `edgeGrading (1 .. 1)`. */
static status read_grading(struct lexer *l) {
    struct token t;
    TRY(lexer_next(l, &t));
    const int n = token_is(&t, "simpleGrading") ? 3 : token_is(&t, "edgeGrading") ? 12 : 0;
    if (!n) return lexer_fail(l, &t, "simpleGrading (1 1 1) follows the numbers of cells");
    TRY(lexer_expect(l, '('));
    for (int i = 0; i < n; i++) {
        TRY(lexer_next(l, &t));
        if (t.kind != TOKEN_NUMBER || t.number != 1)
            return lexer_fail(l, &t, "all cells must be equal, so that only gradings of 1 are read" GO_ON);
    }
    return lexer_expect(l, ')');
}

static status read_block(struct block_reader *r, struct lexer *l, const struct token *hex) {
    struct boxes_block *b = &r->block[r->nblocks];
    struct token t;
    if (r->nblocks == BLOCKS) return lexer_fail(l, hex, "there are more than %d blocks" GO_ON, BLOCKS);
    r->line[r->nblocks] = hex->line;
    TRY(read_labels(l, 8, 0, r->nvertices - 1, "vertices of a hex", b->vertex));
    TRY(lexer_peek(l, &t));
    if (t.kind == TOKEN_WORD) TRY(lexer_next(l, &t)); /* the name of a zone */
    TRY(read_labels(l, 3, 1, INT_MAX, "cells along the edges 0-1, 1-2 and 0-4", b->n));
    TRY(read_grading(l));
    r->nblocks++;
    return OK;
}

static status read_blocks(struct block_reader *r) {
    struct lexer l;
    struct token t;
    TRY(dict_raw(r->d, "blocks", &l));
    TRY(lexer_expect(&l, '('));
    for (;;) {
        TRY(lexer_next(&l, &t));
        if (token_is(&t, ")")) break;
        if (!token_is(&t, "hex"))
            return lexer_fail(&l, &t, "blocks are  hex (v0 .. v7) (nx ny nz) simpleGrading (1 1 1)");
        TRY(read_block(r, &l, &t));
    }
    if (!r->nblocks) return dict_fail(r->d, "blocks", "a mesh needs at least one block");
    int culprit;
    const status s = boxes_place(r->vertex, r->nblocks, r->block, &r->boxes, &culprit);
    return status_note(s, "%s:%d", dict_path(r->d), r->line[culprit]);
}

/* Fails unless a list is empty or not there. */
static status check_none(struct dict *d, const char *key) {
    struct lexer l;
    struct token t[2];
    if (!dict_has(d, key)) return OK;
    TRY(dict_raw(d, key, &l));
    for (int i = 0; i < 2; i++) TRY(lexer_next(&l, &t[i]));
    if (token_is(&t[0], "(") && token_is(&t[1], ")")) return OK;
    return lexer_fail(&l, &t[1], "%s are not read: blocks are boxes along the axes that share whole sides" GO_ON, key);
}

/* ---- patches ---- */

static status read_faces(struct block_reader *r, struct dict *d, struct boxes_patch *p) {
    struct lexer l, ahead;
    struct token t;
    int most = 0;
    TRY(dict_raw(d, "faces", &l));
    ahead = l;
    for (t.kind = TOKEN_PUNCTUATION; t.kind != TOKEN_END; most++) TRY(lexer_next(&ahead, &t));
    TRY(allocate(&p->face, most, sizeof *p->face, "faces of a patch"));
    TRY(lexer_expect(&l, '('));
    for (;;) {
        TRY(lexer_peek(&l, &t));
        if (token_is(&t, ")")) return OK;
        TRY(read_labels(&l, 4, 0, r->nvertices - 1, "vertices of a face", p->face[p->nfaces]));
        p->nfaces++;
    }
}

static status read_type(struct dict *d, const char **out) {
    static const char *const names[] = {"patch", "wall", "empty", "symmetry", "symmetryPlane", "cyclic"};
    int index;
    TRY(dict_choice(d, "type", names, 6, &index));
    *out = names[index];
    return OK;
}

static status read_groups(struct dict *d, char **out) {
    const char *const *words;
    int n = 0;
    long room = 1;
    if (!dict_has(d, "inGroups")) return OK;
    TRY(dict_words(d, "inGroups", &n, &words));
    for (int i = 0; i < n; i++) room += (long)strlen(words[i]) + 1;
    TRY(allocate(out, room, 1, "the groups of a patch"));
    for (int i = 0; i < n; i++) sprintf(*out + strlen(*out), "%s%s", **out ? " " : "", words[i]);
    return OK;
}

static status read_patch(struct block_reader *r, struct dict *all, const char *name) {
    char **groups = &r->groups[r->npatches];
    struct boxes_patch *p = &r->patch[r->npatches++];
    struct dict *d;
    p->name = name;
    TRY(dict_sub(all, name, &d));
    TRY(read_type(d, &p->type));
    if (!strcmp(p->type, "cyclic")) TRY(dict_word(d, "neighbourPatch", &p->neighbour));
    TRY(params_read(d, patch_param, COUNT(patch_param), p));
    TRY(read_groups(d, groups));
    p->groups = *groups;
    return read_faces(r, d, p);
}

static status read_default(struct block_reader *r) {
    struct boxes_patch *p = &r->patch[r->npatches];
    struct dict *d;
    p->name = "defaultFaces";
    p->type = "patch";
    TRY(dict_sub_optional(r->d, "defaultPatch", &d));
    if (!d) return OK;
    TRY(dict_word(d, "name", &p->name));
    TRY(read_type(d, &p->type));
    for (int i = 0; i < r->npatches; i++)
        if (!strcmp(r->patch[i].name, p->name)) return dict_fail(d, "name", "`boundary` has a patch of that name, too");
    if (strcmp(p->type, "cyclic") != 0) return OK;
    return dict_fail(d, "type", "cyclic patches stand in `boundary`, with their neighbourPatch");
}

/* Are the faces of a patch all those across an axis along which the mesh is one cell thick? */
static bool is_layer(const struct polymesh *m, int patch) {
    int axis = -1;
    for (long i = 0; i < m->patch[patch].nfaces; i++) {
        int at[3], side;
        boxes_face_at(m->boxes, patch, i, at, &side);
        if (axis >= 0 && side / 2 != axis) return false;
        axis = side / 2;
    }
    return axis >= 0 && m->boxes->n[axis] == 1 && m->patch[patch].nfaces == 2L * m->ncells;
}

static status read_patches(struct block_reader *r, struct polymesh **out) {
    struct dict *all;
    TRY(dict_sub(r->d, "boundary", &all));
    const int n = dict_count(all);
    TRY(allocate(&r->patch, n + 1L, sizeof *r->patch, "patches"));
    TRY(allocate(&r->groups, n + 1L, sizeof *r->groups, "patches"));
    for (int i = 0; i < n; i++) TRY(read_patch(r, all, dict_key(all, i)));
    TRY(read_default(r));
    struct polymesh *m;
    TRY(status_note(boxes_mesh(r->boxes, r->block, n + 1, r->patch, &m), "%s:%d", dict_path(r->d),
                    dict_line(r->d, "boundary")));
    r->boxes = NULL; /* the mesh has them */
    *out = m;
    if (m->npatches == n || dict_has(r->d, "defaultPatch")) return OK;
    return dict_fail(
        r->d, "boundary",
        "it leaves %d faces to no patch (of which blockMesh would make 'defaultFaces'): name those sides, or "
        "say  defaultPatch { name %s; }",
        m->patch[n].nfaces, is_layer(m, n) ? "frontAndBack; type empty" : "walls; type wall");
}

static status read_all(struct block_reader *r, const char *path, struct polymesh **out) {
    TRY(dict_read(path, &r->d));
    TRY(read_vertices(r));
    TRY(read_blocks(r));
    TRY(check_none(r->d, "edges"));
    TRY(check_none(r->d, "faces"));
    TRY(check_none(r->d, "mergePatchPairs"));
    TRY(params_read(r->d, file_param, COUNT(file_param), r));
    TRY(read_patches(r, out));
    return dict_check_used(r->d);
}

static status read_dictionary(const char *path, struct polymesh **out) {
    struct block_reader *r;
    TRY(allocate(&r, 1, sizeof *r, "blocks"));
    const status s = read_all(r, path, out);
    for (int i = 0; r->patch && i < r->npatches; i++) free(r->patch[i].face);
    for (int i = 0; r->groups && i < r->npatches; i++) free(r->groups[i]);
    free(r->groups);
    free(r->patch);
    free(r->vertex);
    boxes_free(r->boxes);
    if (r->d) dict_free(r->d);
    free(r);
    if (!s) return OK;
    polymesh_free(*out);
    *out = NULL;
    return s;
}

/* ---- which of both ---- */

/* Finds PATH or PATH.gz, and when it was changed. */
static bool find(char path[MESH_PATH], struct timespec *changed) {
    struct stat info;
    const size_t length = strlen(path);
    if (stat(path, &info)) {
        if (length + 4 > MESH_PATH) return false;
        strcpy(path + length, ".gz");
        if (stat(path, &info)) return false;
    }
    path[length] = 0;
    *changed = info.st_mtim;
    return true;
}

/* Reads the polyMesh in out->path; c: the ranks over which it may be spread, or NULL; arrays: see spread_read. */
static status read_polymesh(const struct comm *c, bool arrays, struct case_mesh *out) {
    if (c && !comm_pretends(c)) TRY(spread_read(out->path, c, true, arrays, &out->spread, &out->mesh));
    if (out->mesh) return OK;
    TRY(polymesh_read(out->path, &out->mesh));
    return wedge_flatten(out->mesh, out->path);
}

static status read_mesh(const char *dir, const struct comm *c, bool arrays, struct case_mesh *out) {
    char boundary[MESH_PATH], blocks[MESH_PATH];
    struct timespec made, said;
    *out = (struct case_mesh){.mesh = NULL};
    snprintf(out->path, sizeof out->path, "%.4000s/constant/polyMesh", dir);
    snprintf(boundary, sizeof boundary, "%.4000s/constant/polyMesh/boundary", dir);
    snprintf(blocks, sizeof blocks, "%.4000s/system/blockMeshDict", dir);
    const bool dictionary = find(blocks, &said), polymesh = !access(out->path, F_OK);
    if (polymesh) {
        out->older = dictionary && find(boundary, &made) &&
                     (said.tv_sec > made.tv_sec || (said.tv_sec == made.tv_sec && said.tv_nsec > made.tv_nsec));
        return read_polymesh(c, arrays, out);
    }
    if (!dictionary)
        return fail(ERR_INPUT,
                    "%s: no mesh; make it with  gmshToCase MESH.msh -case %.1000s  or give system/blockMeshDict",
                    out->path, dir);
    memcpy(out->path, blocks, sizeof blocks);
    return read_dictionary(blocks, &out->mesh);
}

status case_mesh_read(const char *dir, struct case_mesh *out) {
    return read_mesh(dir, NULL, false, out);
}

status case_mesh_spread(const char *dir, const struct comm *c, bool arrays, struct case_mesh *out) {
    return read_mesh(dir, c, arrays, out);
}
