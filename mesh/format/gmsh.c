/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a polyMesh of a .msh file that gmsh_file.c has read: drops unused nodes, extrudes 1D and 2D meshes by one cell,
 * joins cells by their faces, turns physical groups into patches. */
#include "mesh/format/gmsh.h"

#include "mesh/format/gmsh_file.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const COMMAND[] = {"Physical Point", "Physical Curve", "Physical Surface", "Physical Volume"};

/* ---- a table of sets of nodes: finds the face or cell with the same nodes in any order --------------------------- */

struct table {
    int width; /* nodes of an entry; a set of fewer nodes is filled up with -1 */
    long n;
    int *key;  /* [n][width], each sorted */
    int *slot; /* [mask + 1] entry + 1, or 0 */
    unsigned long mask;
};

static status table_make(struct table *t, int width, long most) {
    *t = (struct table){.width = width, .mask = 15};
    while (t->mask < 2 * (unsigned long)most) t->mask = 2 * t->mask + 1;
    TRY(allocate(&t->key, most * width, sizeof *t->key, "faces"));
    status s = allocate(&t->slot, (long)t->mask + 1, sizeof *t->slot, "faces");
    if (s) {
        free(t->key);
        t->key = NULL;
    }
    return s;
}

static void table_free(struct table *t) {
    free(t->key);
    free(t->slot);
}

/* Returns the entry with these nodes; if there is none, adds it and sets *is_new, or returns -1 where is_new is
 * NULL. */
static long table_find(struct table *t, const int *node, int n, bool *is_new) {
    int key[8];
    for (int i = 0; i < t->width; i++) {
        int v = i < n ? node[i] : -1, j = i;
        for (; j > 0 && key[j - 1] > v; j--) key[j] = key[j - 1];
        key[j] = v;
    }
    uint64_t hash = 0;
    for (int i = 0; i < t->width; i++)
        hash = (hash ^ (uint64_t)(uint32_t)key[i]) * 0x9E3779B97F4A7C15u, hash ^= hash >> 29;
    unsigned long at = (unsigned long)hash & t->mask;
    size_t bytes = (size_t)t->width * sizeof *key;
    for (; t->slot[at]; at = (at + 1) & t->mask)
        if (memcmp(t->key + (long)t->width * (t->slot[at] - 1), key, bytes) == 0) {
            if (is_new) *is_new = false;
            return t->slot[at] - 1;
        }
    if (!is_new) return -1;
    *is_new = true;
    memcpy(t->key + t->width * t->n, key, bytes);
    t->slot[at] = (int)++t->n;
    return t->n - 1;
}

/* ---- what is in the file: dimension, groups, used nodes ---------------------------------------------------------- */

static int element_dim(const struct gmsh_element *e) {
    return gmsh_shapes[e->kind].dim;
}

static status find_dim(const struct gmsh_file *f, int *dim) {
    long count[4] = {0}, grouped = 0;
    for (long i = 0; i < f->nelements; i++) {
        count[element_dim(&f->element[i])]++;
        grouped += f->element[i].group >= 0;
    }
    for (*dim = 3; *dim > 0 && count[*dim] == 0; --*dim) {}
    if (*dim == 0) return fail(ERR_INPUT, "%s: only points, no mesh; call gmsh with -1, -2 or -3", f->path);
    for (int g = 0; g < f->ngroups; g++)
        if (f->group[g].dim > *dim)
            return fail(ERR_INPUT,
                        "%s: group '%s' of %s has no elements; call gmsh with -%d; an Extrude of quadrangles needs "
                        "Recombine",
                        f->path, f->group[g].name ? f->group[g].name : "", COMMAND[f->group[g].dim], f->group[g].dim);
    if (!grouped)
        return fail(ERR_INPUT,
                    "%s: no physical groups; name the boundary with %s(\"NAME\") = {...} and the inside with "
                    "%s(\"NAME\") = {...} in the .geo file",
                    f->path, COMMAND[*dim - 1], COMMAND[*dim]);
    return OK;
}

/* Keeps every cell once and the boundary elements that have a group; drops nodes that no cell uses. */
static status keep_used(struct gmsh_file *f, int dim) {
    struct table cells;
    int *moved;
    long cell_count = 0, kept = 0, used = 0;
    for (long i = 0; i < f->nelements; i++) cell_count += element_dim(&f->element[i]) == dim;
    TRY(table_make(&cells, 8, cell_count));
    status s = allocate(&moved, f->npoints, sizeof *moved, "nodes");
    for (long i = 0; i < f->nelements && !s; i++) {
        struct gmsh_element *e = &f->element[i];
        bool is_new = element_dim(e) == dim - 1 && e->group >= 0;
        if (element_dim(e) == dim) table_find(&cells, e->node, 8, &is_new);
        if (is_new) f->element[kept++] = *e;
        for (int k = 0; element_dim(e) == dim && k < gmsh_shapes[e->kind].nodes; k++) moved[e->node[k]] = 1;
    }
    table_free(&cells);
    if (s) return s;
    f->nelements = kept;
    for (long p = 0; p < f->npoints; p++) {
        if (moved[p]) memmove(f->points + 3 * used, f->points + 3 * p, 3 * sizeof *f->points);
        moved[p] = moved[p] ? (int)used++ : -1;
    }
    f->npoints = used;
    for (long i = 0; i < kept && !s; i++) {
        struct gmsh_element *e = &f->element[i];
        for (int k = 0; k < gmsh_shapes[e->kind].nodes; k++) {
            e->node[k] = moved[e->node[k]];
            if (e->node[k] < 0 && !s)
                s = fail(ERR_INPUT,
                         "%s: group '%s' has a %s that belongs to no cell; take it out of the group, or put the cells "
                         "at it into a %s",
                         f->path, f->group[e->group].name ? f->group[e->group].name : "(no name)",
                         gmsh_shapes[e->kind].name, COMMAND[dim]);
        }
    }
    free(moved);
    return s;
}

static status check_name(const struct gmsh_file *f, int g) {
    const char *name = f->group[g].name, *command = COMMAND[f->group[g].dim];
    if (!name || !*name)
        return fail(ERR_INPUT, "%s: %s(%d) has no name; write %s(\"NAME\", %d) = {...}", f->path, command,
                    f->group[g].tag, command, f->group[g].tag);
    bool good = isalpha((unsigned char)*name) || *name == '_';
    for (const char *c = name; *c; c++)
        good = good && (isalnum((unsigned char)*c) || *c == '_' || *c == '-' || *c == '.');
    if (good) return OK;
    char better[64];
    snprintf(better, sizeof better, "%s%s", isalpha((unsigned char)*name) ? "" : "patch", name);
    for (char *c = better; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '.') *c = '_';
    return fail(ERR_INPUT,
                "%s: %s(\"%s\"): allowed in a patch name are letters, digits, _ - . and a letter first; "
                "rename it, to \"%s\" perhaps",
                f->path, command, name, better);
}

static status check_groups(const struct gmsh_file *f, int dim) {
    for (long i = 0; i < f->nelements; i++)
        if (element_dim(&f->element[i]) == dim - 1) return OK;
    if (dim == 3)
        return fail(ERR_INPUT, "%s: no part of the boundary is in a physical group; add %s(\"NAME\") = {...}", f->path,
                    COMMAND[dim - 1]);
    return fail(ERR_INPUT,
                "%s: the mesh has %s only, and their boundary is in no physical group; if %s are missing, add "
                "%s(\"NAME\") = {...} (gmsh saves only what is in groups) and call gmsh with -%d; if not, add "
                "%s(\"NAME\") = {...}",
                f->path, dim == 2 ? "surfaces" : "lines", dim == 2 ? "volumes" : "surfaces", COMMAND[dim + 1], dim + 1,
                COMMAND[dim - 1]);
}

/* ---- extrusion by one cell --------------------------------------------------------------------------------------- */

static status find_flat_axes(struct gmsh_file *f, int dim, int flat[2]) {
    double low[3], high[3], size = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY, high[k] = -INFINITY;
        for (long p = 0; p < f->npoints; p++) {
            low[k] = fmin(low[k], f->points[3 * p + k]);
            high[k] = fmax(high[k], f->points[3 * p + k]);
        }
        size = fmax(size, high[k] - low[k]);
    }
    int n = 0;
    for (int k = 0; k < 3; k++)
        if (high[k] - low[k] <= 1e-9 * size && n < 2) flat[n++] = k;
    if (n == 3 - dim) {
        for (int i = 0; i < n; i++)
            for (long p = 0; p < f->npoints; p++) f->points[3 * p + flat[i]] = low[flat[i]];
        return OK;
    }
    const char *what = dim == 2 ? "surfaces only, and they lie in no plane normal to x, y or z"
                                : "lines only, and they do not lie along x, y or z";
    return fail(
        ERR_INPUT,
        "%s: the mesh has %s (extent %g x %g x %g); if volumes or surfaces are missing, add %s(\"NAME\") = {...} "
        "(gmsh saves only what is in groups) and call gmsh with -%d",
        f->path, what, high[0] - low[0], high[1] - low[1], high[2] - low[2], COMMAND[dim + 1], dim + 1);
}

static double cell_measure(const struct gmsh_file *f, const struct gmsh_element *e) {
    double sum[3] = {0}, u[3], v[3];
    int n = gmsh_shapes[e->kind].nodes;
    const double *a = f->points + 3L * e->node[0];
    for (int i = 1; i < n; i++) {
        const double *b = f->points + 3L * e->node[i], *c = f->points + 3L * e->node[i + 1 < n ? i + 1 : i];
        for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
        if (n == 2) return sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (int k = 0; k < 3; k++) sum[k] += 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    }
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

static double typical_size(const struct gmsh_file *f, int dim) {
    double sum = 0;
    long n = 0;
    for (long i = 0; i < f->nelements; i++)
        if (element_dim(&f->element[i]) == dim) sum += cell_measure(f, &f->element[i]), n++;
    return dim == 2 ? sqrt(sum / (double)n) : sum / (double)n;
}

static struct gmsh_element raised(const struct gmsh_element *e, int npoints) {
    static const int up[GMSH_KINDS] = {
        [GMSH_POINT] = GMSH_LINE, [GMSH_LINE] = GMSH_QUAD, [GMSH_TRIANGLE] = GMSH_PRISM, [GMSH_QUAD] = GMSH_HEX};
    struct gmsh_element r = {up[e->kind], e->group, {-1, -1, -1, -1, -1, -1, -1, -1}};
    int n = gmsh_shapes[e->kind].nodes;
    for (int i = 0; i < n; i++) {
        r.node[i] = e->node[i];
        r.node[e->kind == GMSH_LINE ? 2 * n - 1 - i : n + i] = e->node[i] + npoints;
    }
    return r;
}

/* Extrudes cells of dimension dim to cells of dim + 1 between the plane and plane + thickness, boundary elements
 * likewise. Copies of the cells in both planes become the new boundary, in the groups low and high. */
static status extrude(struct gmsh_file *f, int dim, int axis, double thickness, int low, int high) {
    long n = f->nelements, np = f->npoints;
    if (np > INT_MAX / 4) return fail(ERR_INPUT, "%s: %ld nodes are too many", f->path, np);
    double *points;
    TRY(allocate(&points, 6 * np, sizeof *points, "nodes"));
    memcpy(points, f->points, (size_t)np * 3 * sizeof *points);
    memcpy(points + 3 * np, f->points, (size_t)np * 3 * sizeof *points);
    for (long p = 0; p < np; p++) points[3 * (np + p) + axis] += thickness;
    free(f->points);
    f->points = points;
    f->npoints = 2 * np;
    for (long i = 0; i < n; i++) {
        struct gmsh_element e = f->element[i];
        if (element_dim(&e) == dim) {
            struct gmsh_element side = e;
            side.group = low;
            TRY(gmsh_file_add(f, &side));
            for (int k = 0; k < gmsh_shapes[e.kind].nodes; k++) side.node[k] += (int)np;
            side.group = high;
            TRY(gmsh_file_add(f, &side));
        }
        f->element[i] = raised(&e, (int)np);
    }
    return OK;
}

static status add_group(struct gmsh_file *f, const char *name, int *index) {
    for (int g = 0; g < f->ngroups; g++)
        for (long i = 0; i < f->nelements && f->group[g].name && strcmp(f->group[g].name, name) == 0; i++)
            if (f->element[i].group == g)
                return fail(ERR_INPUT,
                            "%s: the group '%s' has the name of the patch that the extrusion to 3D adds; rename it",
                            f->path, name);
    int tag = 0;
    for (bool used = true; used;) {
        used = false;
        tag++;
        for (int g = 0; g < f->ngroups; g++) used = used || f->group[g].tag == tag;
    }
    TRY(gmsh_file_group(f, 2, tag, index));
    f->group[*index].name = strdup(name);
    return f->group[*index].name ? OK : fail(ERR_SYSTEM, "no memory for a name");
}

/* Extrudes the mesh until it is 3D. Groups from *first_added on were added by the extrusion. */
static status make_3d(struct gmsh_file *f, int dim, int *first_added) {
    *first_added = INT_MAX;
    if (dim == 3 && f->thickness > 0)
        return fail(ERR_INPUT, "%s: the mesh has a depth of its own: take `thickness` out of system/meshDict", f->path);
    if (dim == 3) return OK;
    int flat[2], low, high;
    TRY(find_flat_axes(f, dim, flat));
    const double thickness = f->thickness > 0 ? f->thickness : typical_size(f, dim);
    if (dim == 1) {
        TRY(add_group(f, "sides", &low));
        TRY(extrude(f, 1, flat[0], thickness, low, low));
        TRY(extrude(f, 2, flat[1], thickness, low, low));
    } else {
        TRY(add_group(f, "back", &low));
        TRY(add_group(f, "front", &high));
        TRY(extrude(f, 2, flat[0], thickness, low, high));
    }
    *first_added = low;
    return OK;
}

/* ---- faces ------------------------------------------------------------------------------------------------------- */

struct faces {
    const struct gmsh_file *file;
    struct polymesh *m;
    struct table table;
    int *group; /* [nfaces] group of the boundary element on the face, or -1 */
};

static void face_centre(const struct faces *b, long face, double c[3]) {
    const struct polymesh *m = b->m;
    int n = m->face_start[face + 1] - m->face_start[face];
    for (int k = 0; k < 3; k++) {
        c[k] = 0;
        for (int i = 0; i < n; i++) c[k] += m->points[3L * m->face_points[m->face_start[face] + i] + k] / n;
    }
}

static status add_face(struct faces *b, const int *node, int n, int cell) {
    struct polymesh *m = b->m;
    bool is_new;
    long face = table_find(&b->table, node, n, &is_new);
    if (is_new) {
        memcpy(m->face_points + m->face_start[face], node, (size_t)n * sizeof *node);
        m->face_start[face + 1] = m->face_start[face] + n;
        m->owner[face] = cell;
        m->neighbour[face] = -1;
        b->group[face] = -1;
        m->nfaces++;
        return OK;
    }
    if (m->neighbour[face] < 0 && m->owner[face] != cell) {
        m->neighbour[face] = cell;
        return OK;
    }
    double c[3];
    face_centre(b, face, c);
    return fail(ERR_INPUT, "%s: the face at (%g, %g, %g) belongs to three cells; do volumes or surfaces overlap?",
                b->file->path, c[0], c[1], c[2]);
}

static status add_cells(struct faces *b) {
    for (long i = 0; i < b->file->nelements; i++) {
        const struct gmsh_element *e = &b->file->element[i];
        const struct gmsh_shape *shape = &gmsh_shapes[e->kind];
        for (int k = 0; k < shape->faces; k++) {
            int node[4], n = shape->face[k][3] < 0 ? 3 : 4;
            for (int j = 0; j < n; j++) node[j] = e->node[(int)shape->face[k][j]];
            TRY(add_face(b, node, n, b->m->ncells));
        }
        b->m->ncells += shape->dim == 3;
    }
    return OK;
}

static status add_boundary(struct faces *b) {
    const struct gmsh_file *f = b->file;
    for (long i = 0; i < f->nelements; i++) {
        const struct gmsh_element *e = &f->element[i];
        if (element_dim(e) != 2) continue;
        const char *name = f->group[e->group].name;
        long face = table_find(&b->table, e->node, gmsh_shapes[e->kind].nodes, NULL);
        double c[3] = {0};
        if (face >= 0) face_centre(b, face, c);
        if (face < 0) {
            for (int k = 0; k < 3; k++) c[k] = f->points[3L * e->node[0] + k];
            return fail(ERR_INPUT,
                        "%s: group '%s' has an element at (%g, %g, %g) that is no face of a cell; is the mesh "
                        "of the boundary older than that of the inside?",
                        f->path, name, c[0], c[1], c[2]);
        }
        if (b->m->neighbour[face] >= 0)
            return fail(ERR_INPUT,
                        "%s: group '%s' has a face inside the mesh, at (%g, %g, %g); only the boundary may be "
                        "in it: take the inner curve or surface out",
                        f->path, name, c[0], c[1], c[2]);
        if (b->group[face] >= 0 && b->group[face] != e->group)
            return fail(ERR_INPUT, "%s: the face at (%g, %g, %g) is in two groups, '%s' and '%s'; put it into one",
                        f->path, c[0], c[1], c[2], f->group[b->group[face]].name, name);
        b->group[face] = e->group;
    }
    return OK;
}

static status check_covered(const struct faces *b, int dim) {
    long missing = 0, all = 0;
    double c[3], first[3] = {0}, low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (long i = 0; i < b->m->nfaces; i++) {
        all += b->m->neighbour[i] < 0;
        if (b->m->neighbour[i] >= 0 || b->group[i] >= 0) continue;
        face_centre(b, i, c);
        if (missing++ == 0) memcpy(first, c, sizeof c);
        for (int k = 0; k < 3; k++) low[k] = fmin(low[k], c[k]), high[k] = fmax(high[k], c[k]);
    }
    if (!missing) return OK;
    return fail(ERR_INPUT,
                "%s: %ld of %ld boundary faces are in no physical group, the first at (%g, %g, %g), all between "
                "(%g, %g, %g) and (%g, %g, %g); put that part of the boundary into a %s(\"NAME\"); if it lies inside, "
                "points are double there: use Coherence",
                b->file->path, missing, all, first[0], first[1], first[2], low[0], low[1], low[2], high[0], high[1],
                high[2], COMMAND[dim - 1]);
}

/* ---- patches ----------------------------------------------------------------------------------------------------- */

static status copy_text(const char *text, char **out) {
    *out = strdup(text);
    return *out ? OK : fail(ERR_SYSTEM, "no memory for a name");
}

static status set_type(const char *path, struct patch *p, bool added, const struct gmsh_rule *rule) {
    static const char *const known[] = {"patch", "wall", "empty", "cyclic", "symmetry", "symmetryPlane"};
    if (!rule) {
        if (strncmp(p->name, "cyclic", 6) == 0)
            return fail(ERR_INPUT,
                        "%s: patch '%s': a cyclic patch needs its other half named; write  patches { %s { type cyclic; "
                        "neighbourPatch OTHER; } OTHER { type cyclic; neighbourPatch %s; } }  in system/meshDict",
                        path, p->name, p->name, p->name);
        return copy_text(added || strncmp(p->name, "empty", 5) == 0 ? "empty"
                         : strncmp(p->name, "wall", 4) == 0         ? "wall"
                                                                    : "patch",
                         &p->type);
    }
    size_t i = 0;
    while (i < sizeof known / sizeof *known && strcmp(known[i], rule->type) != 0) i++;
    if (i == sizeof known / sizeof *known)
        return fail(ERR_INPUT,
                    "%s: type '%s' of patch '%s'; allowed are patch wall empty cyclic symmetry symmetryPlane",
                    rule->where, rule->type, p->name);
    if (added && strcmp(rule->type, "empty") != 0)
        return fail(ERR_INPUT, "%s: patch '%s' comes from the extrusion and can only be empty; it is '%s'", rule->where,
                    p->name, rule->type);
    if ((strcmp(rule->type, "cyclic") == 0) != (rule->neighbour != NULL))
        return fail(ERR_INPUT, "%s: patch '%s' of type %s: a cyclic patch, and only it, has a neighbourPatch",
                    rule->where, p->name, rule->type);
    if (rule->neighbour) TRY(copy_text(rule->neighbour, &p->neighbour));
    return copy_text(rule->type, &p->type);
}

static status check_rules(const struct polymesh *m, const struct gmsh_rule *rules, int n) {
    char names[512] = "";
    for (int i = 0; i < m->npatches; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, " %s", m->patch[i].name);
    }
    for (int i = 0; i < n; i++)
        if (polymesh_find_patch(m, rules[i].patch) < 0)
            return fail(ERR_INPUT, "%s: the mesh has no patch '%s'; it has%s", rules[i].where, rules[i].patch, names);
    return OK;
}

/* Makes a patch of every group that has faces, fills patch_of_group[ngroups] (-1: a group without faces), and replaces
 * the faces' groups by their patches. */
static status make_patches(struct faces *b, int first_added, const struct gmsh_rule *rules, int nrules,
                           int *patch_of_group) {
    const struct gmsh_file *f = b->file;
    struct polymesh *m = b->m;
    for (int g = 0; g < f->ngroups; g++) patch_of_group[g] = -1;
    for (long i = 0; i < m->nfaces; i++)
        if (b->group[i] >= 0) patch_of_group[b->group[i]] = 0;
    TRY(allocate(&m->patch, f->ngroups, sizeof *m->patch, "patches"));
    for (int g = 0; g < f->ngroups; g++) {
        if (patch_of_group[g] < 0) continue;
        TRY(check_name(f, g));
        const char *name = f->group[g].name;
        if (polymesh_find_patch(m, name) >= 0)
            return fail(ERR_INPUT, "%s: two physical groups have the name '%s'; rename one", f->path, name);
        const struct gmsh_rule *rule = NULL;
        for (int i = 0; i < nrules; i++)
            if (strcmp(rules[i].patch, name) == 0) rule = &rules[i];
        patch_of_group[g] = m->npatches;
        struct patch *p = &m->patch[m->npatches++];
        TRY(copy_text(name, &p->name));
        TRY(set_type(f->path, p, g >= first_added, rule));
    }
    for (long i = 0; i < m->nfaces; i++)
        if (b->group[i] >= 0) b->group[i] = patch_of_group[b->group[i]];
    return check_rules(m, rules, nrules);
}

/* ---- all together ------------------------------------------------------------------------------------------------ */

static status faces_make(struct faces *b) {
    long n = 0;
    for (long i = 0; i < b->file->nelements; i++) n += gmsh_shapes[b->file->element[i].kind].faces;
    if (n > INT_MAX / 8) return fail(ERR_INPUT, "%s: %ld faces are too many for 32-bit labels", b->file->path, n);
    struct polymesh *m = b->m;
    m->npoints = (int)b->file->npoints;
    TRY(allocate(&m->points, 3L * m->npoints, sizeof *m->points, "points"));
    memcpy(m->points, b->file->points, (size_t)m->npoints * 3 * sizeof *m->points);
    TRY(allocate(&m->face_start, n + 1, sizeof *m->face_start, "faces"));
    TRY(allocate(&m->face_points, 4 * n, sizeof *m->face_points, "faces"));
    TRY(allocate(&m->owner, n, sizeof *m->owner, "faces"));
    TRY(allocate(&m->neighbour, n, sizeof *m->neighbour, "faces"));
    TRY(allocate(&b->group, n, sizeof *b->group, "faces"));
    return table_make(&b->table, 4, n);
}

static status build(struct faces *b, int dim, int first_added, const struct gmsh_rule *rules, int nrules) {
    TRY(faces_make(b));
    TRY(status_note(polymesh_check_points(b->m), "%s:", b->file->path));
    TRY(add_cells(b));
    TRY(add_boundary(b));
    TRY(check_covered(b, dim));
    int *patch_of_group;
    TRY(allocate(&patch_of_group, b->file->ngroups, sizeof *patch_of_group, "patches"));
    status s = make_patches(b, first_added, rules, nrules, patch_of_group);
    free(patch_of_group);
    TRY(s);
    return status_note(polymesh_order(b->m, b->group), "%s:", b->file->path);
}

static status convert(struct gmsh_file *f, const struct gmsh_rule *rules, int nrules, struct polymesh **out) {
    int dim, first_added;
    TRY(find_dim(f, &dim));
    TRY(keep_used(f, dim));
    TRY(check_groups(f, dim));
    TRY(make_3d(f, dim, &first_added));
    struct faces b = {.file = f};
    TRY(allocate(&b.m, 1, sizeof *b.m, "a mesh"));
    status s = build(&b, dim, first_added, rules, nrules);
    table_free(&b.table);
    free(b.group);
    if (s)
        polymesh_free(b.m);
    else
        *out = b.m;
    return s;
}

status gmsh_read(const char *path, const struct gmsh_rule *rules, int nrules, struct polymesh **out) {
    return gmsh_read_thick(path, rules, nrules, 0, out);
}

status gmsh_read_thick(const char *path, const struct gmsh_rule *rules, int nrules, double thickness,
                       struct polymesh **out) {
    *out = NULL;
    struct gmsh_file *file;
    TRY(gmsh_file_read(path, &file));
    file->thickness = thickness;
    status s = convert(file, rules, nrules, out);
    gmsh_file_free(file);
    return s;
}
