/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts the mesh of a case into one part per rank and writes the parts as OpenFOAM's processorN folders
 * (decompose.h). */
#include "solvers/output/decompose.h"

#include "solvers/case/fields.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct part_face { /* a face of a part; group: INSIDE, a patch of the case, or a processor patch (group_of) */
    int group, face, cell, across;
};
enum { INSIDE = -1 };
struct cutter {                 /* scratch while the parts are made */
    struct pool *pool, scratch; /* that of the decomposition; what has the lists below */
    const struct polymesh *mesh;
    int *owner_part; /* [ncells] part */
    int *local;      /* [ncells] cell in its part */
    int *point;      /* [npoints] point in the part being made, -1: none */
    struct part_face *item;
};

/* Returns the group of a processor patch. Groups come after the case's patches, by neighbour part; a patch through a
 * cyclic patch comes after the direct one. */
static int group_of(const struct polymesh *m, int other, int cyclic) {
    return m->npatches + other * (m->npatches + 1) + cyclic + 1;
}

static int by_group(const void *a, const void *b) {
    const struct part_face *p = a, *q = b;
    return p->group != q->group ? (p->group > q->group) - (p->group < q->group)
                                : (p->face > q->face) - (p->face < q->face);
}

static int collect_inside(const struct cutter *c, int part, int n) {
    const struct polymesh *m = c->mesh;
    for (int f = 0; f < m->ninternal; f++) {
        int a = m->owner[f], b = m->neighbour[f], pa = c->owner_part[a], pb = c->owner_part[b];
        if (pa == part)
            c->item[n++] = (struct part_face){pb == part ? INSIDE : group_of(m, pb, -1), f, a, b};
        else if (pb == part)
            c->item[n++] = (struct part_face){group_of(m, pa, -1), f, b, a};
    }
    return n;
}

static int collect_boundary(const struct cutter *c, int part, int n) {
    const struct polymesh *m = c->mesh;
    for (int p = 0; p < m->npatches; p++) {
        const struct patch *patch = &m->patch[p];
        const struct patch *half = patch->neighbour ? &m->patch[polymesh_find_patch(m, patch->neighbour)] : NULL;
        for (int i = 0; i < patch->nfaces; i++) {
            int cell = m->owner[patch->start + i], behind = half ? m->owner[half->start + i] : cell;
            if (c->owner_part[cell] != part) continue;
            int other = c->owner_part[behind];
            c->item[n++] =
                (struct part_face){other == part ? p : group_of(m, other, p), patch->start + i, cell, behind};
        }
    }
    return n;
}

static status copy_text(const char *text, char **out) {
    TRY(allocate(out, (long)strlen(text) + 1, 1, "a name"));
    memcpy(*out, text, strlen(text) + 1);
    return OK;
}

/* Makes the patches: the case's, even if they have no face here, then one for each further group of the sorted
 * faces. */
static status make_patches(const struct cutter *c, int number, int n, struct polymesh *m) {
    const struct polymesh *all = c->mesh;
    int groups = 0, at = m->ninternal;
    for (int i = at; i < n; i++)
        groups += c->item[i].group >= all->npatches && (i == at || c->item[i].group != c->item[i - 1].group);
    TRY(allocate(&m->patch, all->npatches + groups, sizeof *m->patch, "patches"));
    while (m->npatches < all->npatches + groups) {
        bool given = m->npatches < all->npatches;
        int group = given ? m->npatches : c->item[at].group, beyond = group - all->npatches;
        int other = beyond / (all->npatches + 1), cyclic = beyond % (all->npatches + 1) - 1;
        struct patch *p = &m->patch[m->npatches++];
        char name[512];
        p->start = at;
        while (at < n && c->item[at].group == group) at++;
        p->nfaces = at - p->start;
        if (given) {
            const struct patch *q = &all->patch[group];
            TRY(copy_text(q->name, &p->name));
            TRY(copy_text(q->type, &p->type));
            if (q->neighbour) TRY(copy_text(q->neighbour, &p->neighbour));
            if (q->groups) TRY(copy_text(q->groups, &p->groups));
            continue;
        }
        snprintf(name, sizeof name, "procBoundary%dto%d%s%.400s", number, other, cyclic < 0 ? "" : "through",
                 cyclic < 0 ? "" : all->patch[cyclic].name);
        TRY(copy_text(name, &p->name));
        TRY(copy_text(cyclic < 0 ? "processor" : "processorCyclic", &p->type));
    }
    return OK;
}

static status make_faces(const struct cutter *c, int n, struct part *part) {
    const struct polymesh *all = c->mesh;
    struct polymesh *m = part->mesh;
    long corners = 0;
    for (int i = 0; i < n; i++) corners += all->face_start[c->item[i].face + 1] - all->face_start[c->item[i].face];
    TRY(allocate(&m->face_start, n + 1L, sizeof(int), "faces"));
    TRY(allocate(&m->face_points, corners, sizeof(int), "faces"));
    TRY(allocate(&m->owner, n, sizeof(int), "faces"));
    TRY(allocate(&m->neighbour, n, sizeof(int), "faces"));
    TRY(pool_take(c->pool, &part->face, n, sizeof(int), "faces"));
    TRY(pool_take(c->pool, &part->across, n, sizeof(int), "faces"));
    m->nfaces = n;
    for (int i = 0; i < n; i++) {
        const struct part_face *t = &c->item[i];
        const int *from = all->face_points + all->face_start[t->face];
        int size = all->face_start[t->face + 1] - all->face_start[t->face], *to = m->face_points + m->face_start[i];
        bool flipped = all->owner[t->face] != t->cell; /* the normal points out of the part */
        for (int k = 0; k < size; k++) to[k] = c->point[from[flipped && k ? size - k : k]];
        m->face_start[i + 1] = m->face_start[i] + size;
        m->owner[i] = c->local[t->cell];
        if (t->group == INSIDE) m->neighbour[m->ninternal++] = c->local[t->across];
        part->face[i] = t->face;
        part->across[i] = t->across;
    }
    return OK;
}

static status make_points(const struct cutter *c, int n, struct part *part) {
    const struct polymesh *all = c->mesh;
    struct polymesh *m = part->mesh;
    memset(c->point, -1, (size_t)all->npoints * sizeof(int));
    for (int i = 0; i < n; i++)
        for (int k = all->face_start[c->item[i].face]; k < all->face_start[c->item[i].face + 1]; k++)
            c->point[all->face_points[k]] = 0;
    for (int i = 0; i < all->npoints; i++)
        if (c->point[i] == 0) c->point[i] = m->npoints++;
    TRY(allocate(&m->points, 3L * m->npoints, sizeof(double), "points"));
    TRY(pool_take(c->pool, &part->point, m->npoints, sizeof(int), "points"));
    for (int i = 0; i < all->npoints; i++) {
        if (c->point[i] < 0) continue;
        memcpy(m->points + 3L * c->point[i], all->points + 3L * i, 3 * sizeof(double));
        part->point[c->point[i]] = i;
    }
    return OK;
}

static status make_part(const struct cutter *c, int number, struct part *part) {
    const struct polymesh *all = c->mesh;
    TRY(allocate(&part->mesh, 1, sizeof *part->mesh, "a part of the mesh"));
    part->npatches = all->npatches;
    for (int i = 0; i < all->ncells; i++) part->mesh->ncells += c->owner_part[i] == number;
    TRY(pool_take(c->pool, &part->cell, part->mesh->ncells, sizeof(int), "cells"));
    for (int i = 0, k = 0; i < all->ncells; i++)
        if (c->owner_part[i] == number) {
            part->cell[k] = i;
            c->local[i] = k++;
        }
    int n = collect_boundary(c, number, collect_inside(c, number, 0));
    qsort(c->item, (size_t)n, sizeof *c->item, by_group);
    TRY(make_points(c, n, part));
    TRY(make_faces(c, n, part));
    return make_patches(c, number, n, part->mesh);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static status write_labels(const char *dir, const char *name, const struct foam_format *f, int n, const int *values) {
    char path[TIME_PATH + 64];
    struct sink *s;
    snprintf(path, sizeof path, "%s/%s", dir, name);
    TRY(sink_open(path, f->compress, &s));
    foam_header_write(s, f, "labelList", "constant/polyMesh", name, NULL);
    foam_list_write_labels(s, f, n, values);
    foam_end_write(s);
    return sink_close(s);
}

/* Writes the ProcAddressing files. Face numbers start at 1 and are negative where the part's face is turned round. */
static status write_addressing(const struct polymesh *all, const struct part *part, const struct foam_format *f,
                               const char *dir) {
    const struct polymesh *m = part->mesh;
    int *list;
    TRY(allocate(&list, m->nfaces + m->npatches + 1L, sizeof(int), "addressing"));
    for (int i = 0; i < m->nfaces; i++)
        list[i] = all->owner[part->face[i]] == part->cell[m->owner[i]] ? part->face[i] + 1 : -(part->face[i] + 1);
    status e = write_labels(dir, "faceProcAddressing", f, m->nfaces, list);
    for (int p = 0; p < m->npatches; p++) list[p] = p < part->npatches ? p : -1;
    if (!e) e = write_labels(dir, "boundaryProcAddressing", f, m->npatches, list);
    free(list);
    TRY(e);
    TRY(write_labels(dir, "pointProcAddressing", f, m->npoints, part->point));
    return write_labels(dir, "cellProcAddressing", f, m->ncells, part->cell);
}

/* Writes the file `boundary` once more, with the entries of processor patches, which polymesh_write does not know. */
static status write_boundary(const struct part *part, const struct foam_format *f, const char *dir) {
    const struct polymesh *m = part->mesh;
    const struct foam_format ascii = {.precision = f->precision};
    char path[TIME_PATH + 64];
    struct sink *s;
    snprintf(path, sizeof path, "%s/boundary", dir);
    TRY(sink_open(path, f->compress, &s));
    foam_header_write(s, &ascii, "polyBoundaryMesh", "constant/polyMesh", "boundary", NULL);
    sink_printf(s, "\n%d\n(\n", m->npatches);
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        int mine = 0, other = 0;
        sink_printf(s, "    %s\n    {\n        type            %s;\n", p->name, p->type);
        patch_write_groups(s, p);
        sink_printf(s, "        nFaces          %d;\n        startFace       %d;\n", p->nfaces, p->start);
        if (p->neighbour || i >= part->npatches)
            sink_printf(s, "        matchTolerance  0.0001;\n        transform       unknown;\n");
        if (p->neighbour) sink_printf(s, "        neighbourPatch  %s;\n", p->neighbour);
        if (i >= part->npatches && sscanf(p->name, "procBoundary%dto%d", &mine, &other) == 2)
            sink_printf(s, "        myProcNo        %d;\n        neighbProcNo    %d;\n", mine, other);
        const char *through = i >= part->npatches ? strstr(p->name, "through") : NULL;
        if (through) sink_printf(s, "        referPatch      %s;\n", through + strlen("through"));
        sink_printf(s, "    }\n");
    }
    sink_printf(s, ")\n");
    foam_end_write(s);
    return sink_close(s);
}

static bool is_folder(const char *path) {
    struct stat info;
    return !stat(path, &info) && S_ISDIR(info.st_mode);
}

static status read_cells(const char *path, long most, long *n, int **out) {
    struct source *file;
    struct foam_header h;
    TRY(source_open(path, &file));
    struct lexer l = lexer_start(file);
    status e = foam_header_read(&l, &h);
    if (!e) e = foam_list_read_labels(&l, &h, most, n, out);
    source_free(file);
    return e;
}

/* Refuses folders of another decomposition: times of both would be put together wrongly. */
static status check_folders(const struct setup *s, const struct decomposition *d) {
    for (int k = 0;; k++) {
        char path[TIME_PATH + 64];
        long n = -1;
        int *cells = NULL;
        snprintf(path, sizeof path, "%s/processor%d", s->dir, k);
        if (!is_folder(path)) return OK;
        snprintf(path, sizeof path, "%s/processor%d/constant/polyMesh/cellProcAddressing", s->dir, k);
        bool same = k < d->n;
        if (same && field_exists(path)) {
            TRY(read_cells(path, d->part[k].mesh->ncells, &n, &cells));
            same = n == d->part[k].mesh->ncells && !memcmp(cells, d->part[k].cell, (size_t)n * sizeof *cells);
            free(cells);
        }
        if (!same)
            return fail(ERR_INPUT,
                        "%s/processor%d: it belongs to another decomposition of the case than that of the present "
                        "%d rank%s; remove the processor folders (rm -r %s/processor*), or say  writeProcessors no;",
                        s->dir, k, comm_size(s->comm), comm_size(s->comm) == 1 ? "" : "s", s->dir);
    }
}

static status write_mesh(const struct setup *s, const struct part *part) {
    const struct foam_format format = {s->control->format.binary, s->control->format.compress, 17};
    char dir[TIME_PATH + 32];
    snprintf(dir, sizeof dir, "%s/constant/polyMesh", part->dir);
    TRY(make_folders(dir));
    TRY(times_clean(part->dir));
    TRY(polymesh_write(part->mesh, dir, &format));
    TRY(write_boundary(part, &format, dir));
    return write_addressing(s->mesh, part, &format, dir);
}

static status make_all(const struct setup *s, struct cutter *c, struct decomposition *d) {
    const struct polymesh *m = s->mesh;
    TRY(pool_take(&c->scratch, &c->local, m->ncells, sizeof(int), "cells"));
    TRY(pool_take(&c->scratch, &c->point, m->npoints, sizeof(int), "points"));
    TRY(pool_take(&c->scratch, &c->item, m->nfaces, sizeof *c->item, "faces"));
    TRY(pool_take(&d->pool, &d->part, d->n, sizeof *d->part, "parts of the mesh"));
    for (int k = 0; k < d->n; k++) {
        snprintf(d->part[k].dir, TIME_PATH, "%.4000s/processor%d", s->dir, k);
        TRY(make_part(c, k, &d->part[k]));
    }
    TRY(check_folders(s, d));
    for (int k = 0; k < d->n; k++) TRY(write_mesh(s, &d->part[k]));
    return OK;
}

/* Finds the part of every cell, on the root, from the ranks' lists one after the other. */
static status find_parts(const struct setup *s, struct cutter *c, struct decomposition *d) {
    const struct grid *g = s->grid;
    long n = 0, total, ranks;
    for (int b = 0; b < g->nblocks; b++) n += g->block[b].ncells;
    int *mine, *cells = NULL, *counts = NULL, count = (int)n;
    status e = allocate(&mine, n, sizeof(int), "cells");
    e = comm_agree(s->comm, e);
    if (e) return e;
    n = 0;
    for (int b = 0; b < g->nblocks; b++)
        for (int i = 0; i < g->block[b].ncells; i++) mine[n++] = g->block[b].cell[i];
    e = comm_gather_int(s->comm, mine, n, &cells, &total);
    if (!e) e = comm_gather_int(s->comm, &count, 1, &counts, &ranks);
    if (!e && comm_root(s->comm)) e = pool_take(&c->scratch, &c->owner_part, total, sizeof(int), "cells");
    for (long r = 0, at = 0; !e && comm_root(s->comm) && r < ranks; r++) {
        for (int i = 0; i < counts[r]; i++) c->owner_part[cells[at++]] = d->n;
        d->n += counts[r] > 0;
    }
    free(mine);
    free(cells);
    free(counts);
    return e;
}

status decompose_make(const struct setup *s, struct decomposition **out) {
    struct cutter c = {.mesh = s->mesh};
    struct decomposition *d = NULL;
    *out = NULL;
    TRY(allocate(&d, 1, sizeof *d, "parts of the mesh"));
    c.pool = &d->pool;
    status e = comm_agree(s->comm, setup_complete(s));
    if (!e) e = find_parts(s, &c, d);
    if (!e && comm_root(s->comm)) e = make_all(s, &c, d);
    pool_free(&c.scratch);
    e = comm_agree(s->comm, e);
    if (!e && comm_root(s->comm))
        *out = d;
    else
        decompose_free(d);
    return e;
}

void decompose_free(struct decomposition *d) {
    if (!d) return;
    for (int k = 0; d->part && k < d->n; k++) polymesh_free(d->part[k].mesh);
    pool_free(&d->pool);
    free(d);
}

status decompose_begin(struct decomposition *d, const char *name) {
    for (int k = 0; d && k < d->n; k++) {
        d->part[k].sums.n = 0;
        TRY(time_begin(d->part[k].dir, name, d->part[k].tmp));
    }
    return OK;
}

status decompose_commit(struct decomposition *d, const struct instant *at) {
    for (int k = 0; d && k < d->n; k++) {
        d->part[k].sums.part = k + 1;
        TRY(time_stamp_write(d->part[k].tmp, at, &d->part[k].sums));
    }
    for (int k = 0; d && k < d->n; k++) TRY(time_commit(d->part[k].dir, at->name));
    return OK;
}

status decompose_remove(struct decomposition *d, const char *name) {
    for (int k = 0; d && k < d->n; k++) TRY(time_remove(d->part[k].dir, name));
    return OK;
}
