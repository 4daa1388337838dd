/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a .msh file into memory, section by section, as the gmsh reference manual describes the formats 2.2 and 4.1:
 * $MeshFormat, $PhysicalNames, $Entities, $Nodes or $ParametricNodes, $Elements; other sections are skipped. Every
 * count is checked against the size of the file before memory is allocated. */
#include "mesh/format/gmsh_file.h"

#include "mesh/format/foamfile.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct gmsh_shape gmsh_shapes[GMSH_KINDS] = {
    [GMSH_POINT] = {"point", 15, 0, 1, 0, {{0}}},
    [GMSH_LINE] = {"line", 1, 1, 2, 0, {{0}}},
    [GMSH_TRIANGLE] = {"triangle", 2, 2, 3, 0, {{0}}},
    [GMSH_QUAD] = {"quadrangle", 3, 2, 4, 0, {{0}}},
    [GMSH_TET] = {"tetrahedron", 4, 3, 4, 4, {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}},
    [GMSH_HEX] = {"hexahedron",
                  5,
                  3,
                  8,
                  6,
                  {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    [GMSH_PRISM] = {"prism", 6, 3, 6, 5, {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    [GMSH_PYRAMID] =
        {"pyramid", 7, 3, 5, 5, {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
};

enum { MAX_GROUPS = 10000, MAX_NAME = 255 };

/* ---- a place in the file ----------------------------------------------------------------------------------------- */

struct cursor {
    const struct source *source;
    const char *path, *text;
    size_t size, at;
    bool binary;
    const char *section; /* name of the section, for messages */
};

static status cursor_fail(const struct cursor *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
static status cursor_fail(const struct cursor *c, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    int line = 1;
    for (size_t i = 0; i < c->at && i < c->size; i++) line += c->text[i] == '\n';
    if (c->source->foreign || !c->binary) return source_fail(c->source, line, "in $%s: %s", c->section, text);
    return fail(ERR_INPUT, "%s: byte %zu, in $%s: %s", c->path, c->at, c->section, text);
}

static status cursor_end(const struct cursor *c) {
    return cursor_fail(c, "the file ends here: it is truncated, or a count in it is too large; make the mesh again");
}

static void skip_blanks(struct cursor *c) {
    while (c->at < c->size && isspace((unsigned char)c->text[c->at])) c->at++;
}

static status found(struct cursor *c, const char *wanted) {
    int n = 0;
    while (n < 40 && c->at + (size_t)n < c->size && isgraph((unsigned char)c->text[c->at + (size_t)n])) n++;
    return cursor_fail(c, "found '%.*s'; expected %s", n, c->text + c->at, wanted);
}

static status take_bytes(struct cursor *c, void *to, size_t n) {
    if (c->size - c->at < n) return cursor_end(c);
    memcpy(to, c->text + c->at, n);
    c->at += n;
    return OK;
}

static status take_text_long(struct cursor *c, long *out) {
    skip_blanks(c);
    if (c->at == c->size) return cursor_end(c);
    size_t i = c->at;
    bool minus = c->text[i] == '-';
    i += minus || c->text[i] == '+';
    long v = 0;
    size_t first = i;
    for (; i < c->size && isdigit((unsigned char)c->text[i]) && v < LONG_MAX / 100; i++)
        v = 10 * v + (c->text[i] - '0');
    if (i == first || (i < c->size && !isspace((unsigned char)c->text[i]))) return found(c, "a whole number");
    c->at = i;
    *out = minus ? -v : v;
    return OK;
}

/* Reads a whole number; `bytes` is its size in a binary file, 4 or 8. */
static status take_long(struct cursor *c, int bytes, long *out) {
    if (!c->binary) return take_text_long(c, out);
    int32_t small = 0;
    int64_t large = 0;
    TRY(bytes == 4 ? take_bytes(c, &small, 4) : take_bytes(c, &large, 8));
    *out = bytes == 4 ? small : (long)large;
    return OK;
}

static status take_int(struct cursor *c, int *out) {
    long v;
    TRY(take_long(c, 4, &v));
    if (v < -INT_MAX || v > INT_MAX) return cursor_fail(c, "the number %ld is too large", v);
    *out = (int)v;
    return OK;
}

static status take_double(struct cursor *c, double *out) {
    if (c->binary) {
        TRY(take_bytes(c, out, 8));
    } else {
        skip_blanks(c);
        if (c->at == c->size) return cursor_end(c);
        char *end;
        *out = strtod(c->text + c->at, &end);
        if (end == c->text + c->at || (*end && !isspace((unsigned char)*end))) return found(c, "a number");
        if (!isfinite(*out)) return found(c, "a finite number");
        c->at = (size_t)(end - c->text);
    }
    if (!isfinite(*out)) return cursor_fail(c, "found %g; expected a finite number", *out);
    return OK;
}

/* Checks a count of things that take at least `least` bytes each: what is left of the file bounds it. */
static status check_count(struct cursor *c, long n, size_t least, const char *what) {
    if (n < 0 || n > INT_MAX || (size_t)n > (c->size - c->at) / least)
        return cursor_fail(c, "%ld %s cannot be: %zu bytes are left; the file is truncated or the count is wrong", n,
                           what, c->size - c->at);
    return OK;
}

static status take_count(struct cursor *c, size_t least, const char *what, long *n) {
    TRY(take_long(c, 8, n));
    return check_count(c, *n, least, what);
}

/* Reads the count before a binary block of format 2.2: it is text and ends with one newline. */
static status take_line_count(struct cursor *c, size_t least, const char *what, long *n) {
    TRY(take_text_long(c, n));
    if (c->binary && c->at < c->size) c->at++;
    return check_count(c, *n, least, what);
}

/* ---- sections ---------------------------------------------------------------------------------------------------- */

struct entity {
    int dim, tag, first, count; /* first, count: its groups are owned[first .. first + count) */
};
struct gmsh_reader {
    struct cursor c;
    struct gmsh_file *file;
    bool new_format; /* 4.1 */
    int nentities, nowned;
    struct entity *entity;
    int *owned; /* [nowned] the groups of all entities, entity by entity */
    long *tag;  /* [npoints] the nodes' numbers in the file */
    long max_tag;
    int *index_of_tag;      /* [max_tag + 1] index + 1, 0: no such node; NULL where numbers are sparse */
    struct node_tag *pairs; /* [npoints] sorted by tag, where numbers are sparse; else NULL */
};
struct node_tag {
    long tag;
    int index;
};

void gmsh_file_free(struct gmsh_file *f) {
    if (!f) return;
    for (int i = 0; i < f->ngroups; i++) free(f->group[i].name);
    free(f->group);
    free(f->element);
    free(f->points);
    free(f->path);
    free(f);
}

status gmsh_file_group(struct gmsh_file *f, int dim, int tag, int *index) {
    for (int i = f->ngroups - 1; i >= 0; i--)
        if (f->group[i].dim == dim && f->group[i].tag == tag) {
            *index = i;
            return OK;
        }
    if (f->ngroups == MAX_GROUPS)
        return fail(ERR_INPUT, "%s: more than %d physical groups; use fewer", f->path, (int)MAX_GROUPS);
    struct gmsh_group *grown = realloc(f->group, (size_t)(f->ngroups + 1) * sizeof *grown);
    if (!grown) return fail(ERR_SYSTEM, "no memory for physical groups");
    f->group = grown;
    f->group[f->ngroups] = (struct gmsh_group){.dim = dim, .tag = tag};
    *index = f->ngroups++;
    return OK;
}

status gmsh_file_add(struct gmsh_file *f, const struct gmsh_element *e) {
    if (f->nelements == f->capacity) {
        long capacity = f->capacity ? 2 * f->capacity : 1024;
        struct gmsh_element *grown = realloc(f->element, (size_t)capacity * sizeof *grown);
        if (!grown) return fail(ERR_SYSTEM, "no memory for %ld elements", capacity);
        f->element = grown;
        f->capacity = capacity;
    }
    f->element[f->nelements++] = *e;
    return OK;
}

static status read_format(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    double version;
    long binary, bytes;
    TRY(take_double(c, &version));
    TRY(take_text_long(c, &binary));
    TRY(take_text_long(c, &bytes));
    r->new_format = version == 4.1;
    if (!r->new_format && !(version >= 2 && version <= 2.2))
        return cursor_fail(c, "format %g; read are 2.2 and 4.1; write the mesh with `gmsh -format msh41` or msh22",
                           version);
    if (bytes != 8)
        return cursor_fail(c, "numbers of %ld bytes; read are 8; write the mesh on a 64-bit machine", bytes);
    if (binary != 0 && binary != 1)
        return cursor_fail(c, "file type %ld; allowed are 0 (ascii) and 1 (binary)", binary);
    if (!binary) return OK;
    while (c->at < c->size && c->text[c->at] != '\n') c->at++;
    c->at += c->at < c->size;
    c->binary = true;
    int32_t one = 0;
    TRY(take_bytes(c, &one, 4));
    if (one != 1)
        return cursor_fail(c,
                           "the mark of byte order is %d, not 1: the file comes from a machine of other byte order; "
                           "write it again here, or as ascii",
                           (int)one);
    return OK;
}

static status read_name(struct cursor *c, char **out) {
    while (c->at < c->size && (c->text[c->at] == ' ' || c->text[c->at] == '\t')) c->at++;
    if (c->at == c->size || c->text[c->at] != '"') return found(c, "a name in quotes");
    const char *start = c->text + c->at + 1, *end = memchr(start, '"', c->size - c->at - 1);
    if (!end) return cursor_end(c);
    size_t n = (size_t)(end - start);
    if (n > MAX_NAME || memchr(start, '\n', n)) return cursor_fail(c, "a name without closing quote, or too long");
    char *name = calloc(n + 1, 1);
    if (!name) return fail(ERR_SYSTEM, "no memory for a name");
    memcpy(name, start, n);
    c->at += n + 2;
    *out = name;
    return OK;
}

static status read_names(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    long n, dim, tag;
    TRY(take_text_long(c, &n));
    TRY(check_count(c, n, 4, "names"));
    for (long i = 0; i < n; i++) {
        TRY(take_text_long(c, &dim));
        TRY(take_text_long(c, &tag));
        if (dim < 0 || dim > 3 || tag < 0 || tag > INT_MAX)
            return cursor_fail(c, "physical group %ld of dimension %ld; allowed are 0 to 3", tag, dim);
        int index;
        TRY(gmsh_file_group(r->file, (int)dim, (int)tag, &index));
        struct gmsh_group *g = &r->file->group[index];
        if (g->name) return cursor_fail(c, "physical group %ld of dimension %ld is named twice", tag, dim);
        TRY(read_name(c, &g->name));
    }
    return OK;
}

static int entity_order(const void *a, const void *b) {
    const struct entity *p = a, *q = b;
    if (p->dim != q->dim) return p->dim < q->dim ? -1 : 1;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

static status grow(void *array, long have, long more, size_t size) {
    void *old;
    memcpy(&old, array, sizeof old);
    void *grown = realloc(old, (size_t)(have + more) * size + 1);
    if (!grown) return fail(ERR_SYSTEM, "no memory for a mesh file");
    memcpy(array, &grown, sizeof grown);
    return OK;
}

static status read_entity(struct gmsh_reader *r, int dim, struct entity *e) {
    struct cursor *c = &r->c;
    double box;
    long n;
    *e = (struct entity){.dim = dim, .first = r->nowned};
    TRY(take_int(c, &e->tag));
    for (int k = 0; k < (dim == 0 ? 3 : 6); k++) TRY(take_double(c, &box));
    TRY(take_count(c, 2, "physical groups", &n));
    TRY(grow(&r->owned, r->nowned, n, sizeof *r->owned));
    for (long i = 0; i < n; i++) {
        int tag = 0;
        TRY(take_int(c, &tag));
        TRY(gmsh_file_group(r->file, dim, abs(tag), &r->owned[r->nowned++]));
        e->count++;
    }
    if (dim == 0) return OK;
    TRY(take_count(c, 2, "bounding entities", &n));
    for (int tag; n > 0; n--) TRY(take_int(c, &tag));
    return OK;
}

static status read_entities(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    long n[4];
    for (int dim = 0; dim < 4; dim++) TRY(take_count(c, 5, "entities", &n[dim]));
    for (int dim = 0; dim < 4; dim++) {
        TRY(check_count(c, n[dim], 5, "entities"));
        TRY(grow(&r->entity, r->nentities, n[dim], sizeof *r->entity));
        for (long i = 0; i < n[dim]; i++) TRY(read_entity(r, dim, &r->entity[r->nentities++]));
    }
    if (r->nentities) qsort(r->entity, (size_t)r->nentities, sizeof *r->entity, entity_order);
    return OK;
}

/* ---- nodes ------------------------------------------------------------------------------------------------------- */

static status nodes_start(struct gmsh_reader *r, long n) {
    if (r->file->points) return cursor_fail(&r->c, "a second $Nodes section; allowed is one");
    r->file->npoints = n;
    TRY(allocate(&r->file->points, 3 * n, sizeof(double), "nodes"));
    return allocate(&r->tag, n, sizeof *r->tag, "node numbers");
}

/* Passes over what a node of $ParametricNodes has more: dimension and number of its entity, parameters on it. */
static status pass_parameters(struct cursor *c) {
    double parameter;
    int dim, entity;
    TRY(take_int(c, &dim));
    TRY(take_int(c, &entity));
    if (dim < 0 || dim > 3) return cursor_fail(c, "a node on an entity of dimension %d; allowed are 0 to 3", dim);
    for (int k = 0; k < dim && dim < 3; k++) TRY(take_double(c, &parameter));
    return OK;
}

static status read_nodes_old(struct gmsh_reader *r, bool parametric) {
    struct cursor *c = &r->c;
    long n;
    TRY(take_line_count(c, 8, "nodes", &n));
    TRY(nodes_start(r, n));
    for (long i = 0; i < n; i++) {
        TRY(take_long(c, 4, &r->tag[i]));
        for (int k = 0; k < 3; k++) TRY(take_double(c, &r->file->points[3 * i + k]));
        if (parametric) TRY(pass_parameters(c));
    }
    return OK;
}

static status read_nodes_new(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    long blocks, n, range, done = 0;
    TRY(take_count(c, 8, "blocks of nodes", &blocks));
    TRY(take_count(c, 8, "nodes", &n));
    TRY(take_long(c, 8, &range));
    TRY(take_long(c, 8, &range));
    TRY(nodes_start(r, n));
    for (long b = 0; b < blocks; b++) {
        int dim, tag, parametric;
        long m;
        TRY(take_int(c, &dim));
        TRY(take_int(c, &tag));
        TRY(take_int(c, &parametric));
        TRY(take_long(c, 8, &m));
        if (m < 0 || m > n - done)
            return cursor_fail(c, "a block of %ld nodes; the section announced %ld, %ld are left", m, n, n - done);
        for (long i = 0; i < m; i++) TRY(take_long(c, 8, &r->tag[done + i]));
        for (long i = 0; i < m; i++) {
            double skipped;
            for (int k = 0; k < 3; k++) TRY(take_double(c, &r->file->points[3 * (done + i) + k]));
            for (int k = 0; parametric && k < dim; k++) TRY(take_double(c, &skipped));
        }
        done += m;
    }
    if (done != n) return cursor_fail(c, "%ld nodes; the section announced %ld", done, n);
    return OK;
}

static int pair_order(const void *a, const void *b) {
    const struct node_tag *p = a, *q = b;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

static status index_nodes(struct gmsh_reader *r) {
    long n = r->file->npoints;
    for (long i = 0; i < n; i++) {
        if (r->tag[i] < 0) return cursor_fail(&r->c, "node number %ld; allowed are numbers from 0", r->tag[i]);
        if (r->tag[i] > r->max_tag) r->max_tag = r->tag[i];
    }
    if (r->max_tag > 8 * n + 1024) {
        TRY(allocate(&r->pairs, n, sizeof *r->pairs, "node numbers"));
        for (long i = 0; i < n; i++) r->pairs[i] = (struct node_tag){r->tag[i], (int)i};
        if (n) qsort(r->pairs, (size_t)n, sizeof *r->pairs, pair_order);
        for (long i = 1; i < n; i++)
            if (r->pairs[i].tag == r->pairs[i - 1].tag)
                return cursor_fail(&r->c, "node number %ld stands twice", r->pairs[i].tag);
        return OK;
    }
    TRY(allocate(&r->index_of_tag, r->max_tag + 1, sizeof *r->index_of_tag, "node numbers"));
    for (long i = 0; i < n; i++) {
        int *slot = &r->index_of_tag[r->tag[i]];
        if (*slot) return cursor_fail(&r->c, "node number %ld stands twice", r->tag[i]);
        *slot = (int)i + 1;
    }
    return OK;
}

static status find_node(const struct gmsh_reader *r, long tag, int *index) {
    *index = -1;
    if (r->index_of_tag) {
        if (tag >= 0 && tag <= r->max_tag) *index = r->index_of_tag[tag] - 1;
    } else if (r->pairs) {
        struct node_tag key = {tag, 0};
        const struct node_tag *p = bsearch(&key, r->pairs, (size_t)r->file->npoints, sizeof key, pair_order);
        if (p) *index = p->index;
    }
    if (*index < 0)
        return cursor_fail(&r->c, "an element has node %ld, which is not among the %ld of $Nodes", tag,
                           r->file->npoints);
    return OK;
}

/* ---- elements ---------------------------------------------------------------------------------------------------- */

static status find_kind(const struct cursor *c, long type, int *kind) {
    static const char *const names[] = {[8] = "line of 3 nodes",         [9] = "triangle of 6 nodes",
                                        [10] = "quadrangle of 9 nodes",  [11] = "tetrahedron of 10 nodes",
                                        [12] = "hexahedron of 27 nodes", [13] = "prism of 18 nodes",
                                        [14] = "pyramid of 14 nodes",    [15] = NULL,
                                        [16] = "quadrangle of 8 nodes",  [17] = "hexahedron of 20 nodes",
                                        [18] = "prism of 15 nodes",      [19] = "pyramid of 13 nodes",
                                        [20] = "triangle of 9 nodes",    [21] = "triangle of 10 nodes"};
    for (*kind = 0; *kind < GMSH_KINDS; ++*kind)
        if (gmsh_shapes[*kind].type == type) return OK;
    const char *name = type >= 8 && type < (long)(sizeof names / sizeof *names) ? names[type] : "of high order";
    return cursor_fail(c,
                       "element of type %ld (%s); read are point, line, triangle, quadrangle, tetrahedron, hexahedron, "
                       "prism, pyramid of first order: set Mesh.ElementOrder = 1",
                       type, name);
}

static status read_element_nodes(struct gmsh_reader *r, int bytes, struct gmsh_element *e) {
    for (int k = 0; k < 8; k++) e->node[k] = -1;
    for (int k = 0; k < gmsh_shapes[e->kind].nodes; k++) {
        long tag = 0;
        TRY(take_long(&r->c, bytes, &tag));
        TRY(find_node(r, tag, &e->node[k]));
        for (int j = 0; j < k; j++)
            if (e->node[j] == e->node[k])
                return cursor_fail(&r->c, "a %s has node %ld twice; make the mesh without degenerate elements",
                                   gmsh_shapes[e->kind].name, tag);
    }
    return OK;
}

static status read_element_old(struct gmsh_reader *r, struct gmsh_element *e, int ntags) {
    struct cursor *c = &r->c;
    int dim = gmsh_shapes[e->kind].dim;
    e->group = -1;
    for (int i = 0; i < ntags; i++) {
        int tag = 0;
        TRY(take_int(c, &tag));
        if (i == 0 && tag != 0) TRY(gmsh_file_group(r->file, dim, abs(tag), &e->group));
    }
    TRY(read_element_nodes(r, 4, e));
    return gmsh_file_add(r->file, e);
}

static status read_elements_old(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    struct gmsh_element e;
    long n, number, done = 0;
    TRY(take_line_count(c, 6, "elements", &n));
    while (done < n) {
        int type, ntags, block = 1;
        if (!c->binary) TRY(take_long(c, 4, &number));
        TRY(take_int(c, &type));
        if (c->binary) TRY(take_int(c, &block));
        TRY(take_int(c, &ntags));
        TRY(find_kind(c, type, &e.kind));
        if (block < 1 || block > n - done || ntags < 0 || ntags > 1000)
            return cursor_fail(c,
                               "a block of %d elements with %d tags; the section announced %ld elements, %ld are left",
                               block, ntags, n, n - done);
        for (int i = 0; i < block; i++, done++) {
            if (c->binary) TRY(take_long(c, 4, &number));
            TRY(read_element_old(r, &e, ntags));
        }
    }
    return OK;
}

static status read_block(struct gmsh_reader *r, long left, long *m) {
    struct cursor *c = &r->c;
    struct gmsh_element e = {.group = -1};
    struct entity key = {0};
    int type;
    long number;
    TRY(take_int(c, &key.dim));
    TRY(take_int(c, &key.tag));
    TRY(take_int(c, &type));
    TRY(take_long(c, 8, m));
    TRY(find_kind(c, type, &e.kind));
    if (*m < 0 || *m > left)
        return cursor_fail(c, "a block of %ld elements; %ld are left of those announced", *m, left);
    const struct entity *where =
        r->nentities ? bsearch(&key, r->entity, (size_t)r->nentities, sizeof key, entity_order) : NULL;
    for (long i = 0; i < *m; i++) {
        TRY(take_long(c, 8, &number));
        TRY(read_element_nodes(r, 8, &e));
        /* two copies are enough to tell that the element is in more than one group */
        int copies = where && where->count > 1 ? 2 : 1;
        for (int g = 0; g < copies; g++) {
            e.group = where && where->count ? r->owned[where->first + g] : -1;
            TRY(gmsh_file_add(r->file, &e));
        }
    }
    return OK;
}

static status read_elements_new(struct gmsh_reader *r) {
    struct cursor *c = &r->c;
    long blocks, n, range, m, done = 0;
    TRY(take_count(c, 8, "blocks of elements", &blocks));
    TRY(take_count(c, 4, "elements", &n));
    TRY(take_long(c, 8, &range));
    TRY(take_long(c, 8, &range));
    for (long b = 0; b < blocks; b++, done += m) TRY(read_block(r, n - done, &m));
    if (done != n) return cursor_fail(c, "%ld elements; the section announced %ld", done, n);
    return OK;
}

static status read_elements(struct gmsh_reader *r) {
    if (!r->file->points) return cursor_fail(&r->c, "$Elements before $Nodes");
    if (r->file->nelements) return cursor_fail(&r->c, "a second $Elements section; allowed is one");
    if (!r->index_of_tag && !r->pairs) TRY(index_nodes(r));
    return r->new_format ? read_elements_new(r) : read_elements_old(r);
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static status read_partitioned(struct gmsh_reader *r) {
    return cursor_fail(&r->c, "the mesh is partitioned; write it without partitions (Mesh.PartitionSplitMeshFiles and "
                              "PartitionMesh off): the solver cuts it itself");
}

static status read_nodes(struct gmsh_reader *r) {
    return r->new_format ? read_nodes_new(r) : read_nodes_old(r, false);
}

/* The nodes of format 2.2 with their parameters on the geometry (Mesh.SaveParametric). */
static status read_parametric(struct gmsh_reader *r) {
    return read_nodes_old(r, true);
}

static status read_first_format(struct gmsh_reader *r) {
    return cursor_fail(&r->c, "this is gmsh's format 1, which has no names of groups; mesh the geometry anew: gmsh -3 "
                              "-format msh41 MESH.geo -o MESH.msh");
}

static const struct {
    const char *name;
    status (*read)(struct gmsh_reader *);
} sections[] = {{"MeshFormat", read_format}, {"PhysicalNames", read_names},
                {"Entities", read_entities}, {"PartitionedEntities", read_partitioned},
                {"Nodes", read_nodes},       {"ParametricNodes", read_parametric},
                {"Elements", read_elements}, {"NOD", read_first_format}};
enum { FORMAT_1 = sizeof sections / sizeof *sections - 1 };

static status skip_section(struct cursor *c, const char *name, int length) {
    for (const char *p = c->text + c->at; (p = memchr(p, '$', (size_t)(c->text + c->size - p))); p++)
        if (strncmp(p, "$End", 4) == 0 && strncmp(p + 4, name, (size_t)length) == 0) {
            c->at = (size_t)(p - c->text);
            return OK;
        }
    return cursor_fail(c, "section $%.*s has no end: the file is truncated", length, name);
}

static status read_section(struct gmsh_reader *r, bool *first) {
    struct cursor *c = &r->c;
    if (c->text[c->at] != '$') return found(c, "a section ($Nodes, $Elements, ...): is this a .msh file?");
    const char *name = c->text + ++c->at;
    int length = 0;
    while (isalnum((unsigned char)name[length])) length++;
    c->at += (size_t)length;
    if (c->at < c->size && c->text[c->at] == '\r') c->at++;
    if (c->at < c->size && c->text[c->at] == '\n') c->at++;
    size_t which = 0, count = sizeof sections / sizeof *sections;
    while (which < count &&
           (strncmp(sections[which].name, name, (size_t)length) != 0 || sections[which].name[length] != 0))
        which++;
    c->section = which < count ? sections[which].name : "(other)";
    if (which < FORMAT_1 && *first != (which == 0)) /* a section of another name, as $Comments, may stand anywhere */
        return cursor_fail(c, "the first section of a .msh file, and only it, is $MeshFormat");
    *first &= which >= count;
    TRY(which < count ? sections[which].read(r) : skip_section(c, name, length));
    skip_blanks(c);
    if (c->size - c->at < 4 + (size_t)length) return cursor_end(c);
    if (strncmp(c->text + c->at, "$End", 4) != 0 || strncmp(c->text + c->at + 4, name, (size_t)length) != 0)
        return cursor_fail(c, "expected $End%.*s here: a count is wrong", length, name);
    c->at += 4 + (size_t)length;
    return OK;
}

static status read_all(struct gmsh_reader *r) {
    bool first = true;
    for (skip_blanks(&r->c); r->c.at < r->c.size; skip_blanks(&r->c)) TRY(read_section(r, &first));
    if (first)
        return fail(ERR_INPUT, "%s: the file %s; a .msh file of format 2.2 or 4.1 is needed", r->c.path,
                    r->c.size ? "has no $MeshFormat" : "is empty");
    if (r->file->nelements == 0)
        return fail(ERR_INPUT, "%s: no elements; the file is truncated, or gmsh was called without -1, -2 or -3",
                    r->c.path);
    return OK;
}

status gmsh_file_read(const char *path, struct gmsh_file **out) {
    *out = NULL;
    struct source *source;
    TRY(source_open_named(path, &source));
    struct gmsh_reader r = {.c = {.source = source,
                                  .path = source->path,
                                  .text = source->text,
                                  .size = source->size,
                                  .section = "MeshFormat"}};
    r.file = calloc(1, sizeof *r.file);
    status s = r.file ? OK : fail(ERR_SYSTEM, "no memory");
    if (!s && !(r.file->path = strdup(path))) s = fail(ERR_SYSTEM, "no memory");
    if (!s) s = read_all(&r);
    if (s) {
        gmsh_file_free(r.file);
        r.file = NULL;
    }
    free(r.entity);
    free(r.owned);
    free(r.tag);
    free(r.index_of_tag);
    free(r.pairs);
    source_free(source);
    *out = r.file;
    return s;
}
