/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes times of a case: fields with their patch entries, processorN parts, grains, provenance, checksums; purges old
 * times (output.h). */
#include "solvers/output/output.h"

#include "libcore/models/boundary.h"
#include "mesh/base/background.h"
#include "solvers/case/checksums.h"
#include "solvers/output/clouds.h"
#include "solvers/output/decompose.h"
#include "solvers/output/edges.h"
#include "solvers/output/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct output;
struct commit { /* a time that is on its way to the disk, by a thread; on the root */
    struct output *o;
    struct instant at;
    char folder[TIME_PATH];    /* where its files are until then */
    int keep;                  /* purgeWrite */
    status result;             /* when the thread has ended */
    struct background *thread; /* NULL: no time is on its way */
};
struct output {
    const struct setup *setup;
    struct commit commit;
    output_saver *save;
    const void *context;         /* of save */
    double last_time;            /* s, of the last time written; NAN: none */
    int precision;               /* digits of time names, widened where needed */
    struct checksums sums;       /* checksums of the time that is being written; root */
    struct edges *edges;         /* values on patches; NULL: those of the cells */
    struct decomposition *parts; /* NULL: no processorN folders; root */
    int nparts;                  /* how many; the same on every rank */
    int nnames, room;
    char (*name)[TIME_NAME]; /* written by this run, oldest first */
};

/* Returns the digits of time names to start with: a restarted run goes on with those of the run before it. */
static int start_precision(const struct setup *s) {
    const struct control *c = s->control;
    char name[TIME_NAME];
    for (int digits = c->time_precision; digits <= 17; digits++) {
        time_name(c->time_format, digits, s->start.t, name);
        if (!strcmp(name, s->start.name)) return digits;
    }
    return c->time_precision;
}

status output_make(const struct setup *s, output_saver *save, const void *context, struct output **out) {
    struct output *o = NULL;
    TRY(allocate(&o, 1, sizeof *o, "output"));
    *out = o;
    o->setup = s;
    o->save = save;
    o->context = context;
    o->last_time = s->start.t;
    o->precision = start_precision(s);
    TRY(edges_make(s, NULL, &o->edges));
    if (!s->control->write_processors) return OK;
    TRY(decompose_make(s, &o->parts));
    if (o->parts) o->nparts = o->parts->n;
    comm_broadcast(s->comm, &o->nparts, sizeof o->nparts);
    return OK;
}

/* ---- values of cells ---- */

/* Copies the values of n cells to the places that cell[n] numbers, NULL: one behind the other; vectors with component
 * axis[k] from line k. */
static void put_scalars(int n, const int *cell, const double *line, double *to) {
    for (int i = 0; i < n; i++) to[cell ? cell[i] : i] = line[i];
}
static void put_vectors(int n, const int *cell, double *const line[3], const int axis[3], double *to) {
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) to[3L * (cell ? cell[i] : i) + axis[k]] = line[k][i];
}

/* Sets out[..][components] to a quantity in the cells of this rank, block by block, with vectors along physical axes,
 * as a restart needs it. They come in the order of the blocks or, with cell[cells of this rank], by those numbers. */
static status own_values(const struct setup *s, int quantity, const int *cell, double *out) {
    const struct medium *m = s->medium;
    const struct grid *g = s->grid;
    const int components = m->fields.quantity[quantity].components;
    double *line[3] = {NULL, NULL, NULL};
    long most = 1, first = 0;
    for (int b = 0; b < g->nblocks; b++)
        if (g->block[b].ncells > most) most = g->block[b].ncells;
    TRY(allocate(&line[0], 3 * most, sizeof(double), "a block to write"));
    line[1] = line[0] + most;
    line[2] = line[1] + most;
    for (int b = 0; b < g->nblocks; first += g->block[b++].ncells) {
        (m->type->exact ? m->type->exact : m->type->block)(m, b, quantity, line);
        const int n = g->block[b].ncells, *numbers = cell ? cell + first : NULL;
        double *to = out + (cell ? 0 : first * components);
        if (components == 1)
            put_scalars(n, numbers, line[0], to);
        else
            put_vectors(n, numbers, line, s->axis, to);
    }
    free(line[0]);
    return OK;
}

static status derive(const struct setup *s, int quantity) {
    return s->medium->type->derive ? s->medium->type->derive(s->medium, quantity) : OK;
}

/* Allocates n values of a quantity, and sets them by own_values. */
static status make_values(const struct setup *s, int quantity, long n, const int *cell, double **out) {
    *out = NULL;
    TRY(derive(s, quantity));
    status e = allocate(out, n * s->medium->fields.quantity[quantity].components, sizeof(double), "a field to write");
    if (!e) e = own_values(s, quantity, cell, *out);
    e = comm_agree(s->comm, e);
    if (e) free(*out);
    return e;
}

status output_own(const struct setup *s, int quantity, double **out) {
    long n;
    (void)grid_cells(s->grid, &n);
    return make_values(s, quantity, n, NULL, out);
}

status output_gather(const struct setup *s, int quantity, double *out) {
    const struct share share = share_make(s->comm, s->mesh->ncells);
    double *own;
    long n;
    const int *cell = grid_cells(s->grid, &n);
    if (comm_size(s->comm) == 1) {
        TRY(derive(s, quantity));
        return own_values(s, quantity, cell, out);
    }
    TRY(output_own(s, quantity, &own));
    const status e = share_gather(&share, s->medium->fields.quantity[quantity].components, n, cell, own, out);
    free(own);
    return e;
}

/* Computes a quantity in the cells of this rank's slice. */
static status make_slice(const struct setup *s, int quantity, const struct share *share, double **out) {
    const int components = s->medium->fields.quantity[quantity].components;
    double *own;
    long n;
    const int *cell = grid_cells(s->grid, &n);
    if (comm_size(s->comm) == 1) return make_values(s, quantity, n, cell, out);
    *out = NULL;
    TRY(output_own(s, quantity, &own));
    status e = allocate(out, (share->end - share->first) * components, sizeof(double), "a slice of a field");
    e = comm_agree(s->comm, e);
    if (!e) e = share_store(share, components, n, cell, own, *out);
    free(own);
    return e;
}

/* ---- patches ---- */

struct printing {                /* context of print_patch */
    const struct medium *medium; /* NULL: all patches are calculated */
    int quantity, components;
    const double *values;        /* in the cells of the mesh that is being written; NULL: `face` has those asked for */
    const struct share *share;   /* the slices in which the values are spread over the ranks, or NULL */
    const double *slice;         /* this rank's */
    double *face;                /* [faces] of the present patch; on the root */
    const struct part *part;     /* part of a decomposed case, or NULL */
    const double *across;        /* [faces of processor patches] values on the other side, if there is a part */
    const struct patch *patches; /* patches of the case */
    const struct edges *edges;   /* makes values on patches of those in cells; NULL: they are the same */
};

static void print_list(struct sink *s, const struct foam_format *f, int components, int n, const double *values) {
    sink_printf(s, "nonuniform List<%s> ", field_item(components));
    foam_list_write_doubles(s, f, components, n, values);
    sink_printf(s, ";\n");
}

/* Has a parameter the value that it has if it is not given? */
static bool is_standard(const struct param *p, const double *v) {
    return v[0] == p->standard && (p->kind != PARAM_VECTOR || (v[1] == p->standard && v[2] == p->standard));
}

/* Prints the parameters of a type that are no defaults with all digits, because the next start reads them. */
static void print_parameters(struct sink *s, const struct model *m, const struct patch_field *q) {
    for (int i = 0; i < m->nparam; i++) {
        if (q->varying && !strcmp(varying_key(q->varying), m->param[i].name)) continue; /* the rule is printed */
        const double *v = q->params.room + m->param[i].offset / sizeof(double);
        if (is_standard(&m->param[i], v)) continue;
        sink_printf(s, "        %-15s ", m->param[i].name);
        if (m->param[i].kind == PARAM_VECTOR)
            sink_printf(s, "(%.17g %.17g %.17g);\n", v[0], v[1], v[2]);
        else
            sink_printf(s, "%.17g;\n", v[0]);
    }
}

/* Prints the values that a patch was given with all digits, for the same reason. */
static void print_given(struct sink *s, const struct field_writer *w, int p, const char *key,
                        const struct patch_field *q, const struct printing *c) {
    const struct foam_format exact = {.binary = w->format->binary, .precision = 17};
    const struct patch *patch = &w->mesh->patch[p];
    int m = c->components;
    sink_printf(s, "        %-15s ", key);
    if (!q->values) sink_printf(s, "uniform ");
    if (!q->values && m == 3)
        sink_printf(s, "(%.17g %.17g %.17g);\n", q->uniform[0], q->uniform[1], q->uniform[2]);
    else if (!q->values)
        sink_printf(s, "%.17g;\n", q->uniform[0]);
    if (!q->values) return;
    if (!c->part) {
        print_list(s, &exact, m, patch->nfaces, q->values);
        return;
    }
    for (int i = 0; i < patch->nfaces; i++) {
        const long from = c->part->face[patch->start + i] - c->patches[p].start;
        memcpy(c->face + (long)i * m, q->values + from * m, (size_t)m * sizeof(double));
    }
    print_list(s, &exact, m, patch->nfaces, c->face);
}

/* Takes the values on a patch from those in the cells. */
static void take_faces(const struct field_writer *w, int p, const struct printing *c) {
    const struct patch *patch = &w->mesh->patch[p];
    const int m = c->components;
    for (int i = 0; i < patch->nfaces; i++) {
        double *to = c->face + (long)i * m;
        memcpy(to, c->values + (long)polymesh_patch_cell(w->mesh, p, i) * m, (size_t)m * sizeof *to);
        if (!c->part) continue;
        const int face = (int)(c->part->face[patch->start + i] - c->patches[p].start);
        edges_values(c->edges, c->quantity, p, 1, &face, to);
    }
}

/* Prints the values on a patch or, `across` a processor patch, those of the cells on the other side. */
static void print_cells(struct sink *s, const struct field_writer *w, int p, const struct printing *c, bool across) {
    const struct patch *patch = &w->mesh->patch[p];
    const int m = c->components;
    if (!across && c->values) take_faces(w, p, c);
    sink_printf(s, "        %-15s ", "value");
    print_list(s, w->format, m, patch->nfaces,
               across ? c->across + (long)(patch->start - part_beyond(c->part)) * m : c->face);
}

/* Does OpenFOAM demand a `value` for the type of a patch that no entry gives? */
static bool prints_cells(const struct boundary_type *b, int components) {
    const char *value = boundary_value(b, components);
    return !b || (b->giving != BY_FUNCTION && b->giving != BY_EXPRESSION && boundary_gives(b) &&
                  !(value && !strcmp(value, "value")));
}

static const struct patch_field *given_on(const struct printing *c, int p) {
    return c->medium ? c->medium->type->patch(c->medium, c->quantity, p) : NULL;
}

/* Is it a type of the mesh, which fields have, too? */
static bool is_constraint(const char *type) {
    static const char *const constraints[] = {"empty", "cyclic", "symmetry", "symmetryPlane"};
    for (int i = 0; i < 4; i++)
        if (!strcmp(type, constraints[i])) return true;
    return false;
}

/* Fetches from the ranks' slices the values in the cells at a patch: a patch_preparer. */
static status fetch_patch(const struct field_writer *w, int p, void *context) {
    struct printing *c = context;
    const long n = comm_root(c->share->comm) ? w->mesh->patch[p].nfaces : 0;
    int *cell = NULL;
    if (is_constraint(w->mesh->patch[p].type)) return OK;
    const struct patch_field *given = given_on(c, p);
    if (!prints_cells(given ? boundary_find(given->type) : NULL, c->components)) return OK;
    free(c->face);
    c->face = NULL;
    status e = allocate(&cell, n, sizeof *cell, "a patch to write");
    if (!e) e = allocate(&c->face, n * c->components, sizeof *c->face, "a patch to write");
    e = comm_agree(c->share->comm, e);
    for (long i = 0; !e && i < n; i++) cell[i] = polymesh_patch_cell(w->mesh, p, (int)i);
    if (!e) e = share_fetch(c->share, c->components, c->slice, n, cell, c->face);
    if (!e) edges_values(c->edges, c->quantity, p, (int)n, NULL, c->face);
    free(cell);
    return e;
}

static void print_patch(struct sink *s, const struct field_writer *w, int p, const void *context) {
    const struct printing *c = context;
    const char *type = w->mesh->patch[p].type, *said = w->mesh->patch[p].said;
    const bool beyond = c->part && p >= c->part->npatches;
    if (is_constraint(type) || beyond) {
        sink_printf(s, "        %-15s %s;\n", "type", said ? said : type);
        if (beyond) print_cells(s, w, p, c, true);
        return;
    }
    const struct patch_field *given = given_on(c, p);
    sink_printf(s, "        %-15s %s;\n", "type", given ? given->type : "calculated");
    const struct boundary_type *b = given ? boundary_find(given->type) : NULL;
    const char *value = boundary_value(b, c->components);
    if (b) print_parameters(s, &b->model, given);
    if (value && b->giving == BY_LIST) print_given(s, w, p, value, given, c);
    if (given && given->varying) varying_print(s, given->varying);
    if (b && (b->giving == BY_FUNCTION || b->giving == BY_EXPRESSION))
        print_given(s, w, p, "value", given, c);
    else if (prints_cells(b, c->components))
        print_cells(s, w, p, c, false);
}

/* Returns the faces of the largest patch that has values in files. */
static int largest_patch(const struct polymesh *m) {
    int n = 1;
    for (int p = 0; p < m->npatches; p++)
        if (m->patch[p].nfaces > n && strcmp(m->patch[p].type, "empty") != 0) n = m->patch[p].nfaces;
    return n;
}

status output_values(const struct setup *s, const struct field_writer *w, const struct quantity *q,
                     const double *values, struct file_sum *sum) {
    struct printing c = {.components = q->components, .values = values};
    struct file_sum unasked;
    TRY(allocate(&c.face, (long)q->components * largest_patch(s->mesh), sizeof(double), "a patch to write"));
    status e = field_write(w, q->name, q->components, q->dimensions, values, print_patch, &c, sum ? sum : &unasked);
    free(c.face);
    return e;
}

status output_field(const struct setup *s, const struct field_writer *w, int quantity, const double *values) {
    return output_values(s, w, &s->medium->fields.quantity[quantity], values, NULL);
}

/* ---- a field of a time ---- */

struct writing { /* a field that is being written; what the functions below share */
    struct output *o;
    const struct quantity *q;
    const struct field_writer *w;
    struct printing *print;
};

/* Fetches the values of cells from the ranks' slices to the root. */
static status fetch_cells(const struct printing *c, long n, const int *cell, double **out) {
    *out = NULL;
    TRY(comm_agree(c->share->comm, allocate(out, n * c->components, sizeof **out, "a part of a field")));
    return share_fetch(c->share, c->components, c->slice, n, cell, *out);
}

/* Writes the share of a part into its folder. */
static status write_part(const struct writing *x, struct part *part) {
    const struct polymesh *m = part ? part->mesh : NULL;
    const int beyond = m ? part_beyond(part) : 0;
    struct printing c = *x->print;
    double *values = NULL, *across = NULL;
    status e = fetch_cells(&c, m ? m->ncells : 0, m ? part->cell : NULL, &values);
    if (!e) e = fetch_cells(&c, m ? m->nfaces - beyond : 0, m ? part->across + beyond : NULL, &across);
    c.face = NULL;
    c.part = part;
    c.values = values;
    c.across = across;
    if (m && !e) e = allocate(&c.face, (long)c.components * largest_patch(m), sizeof *c.face, "a patch to write");
    if (m && !e) {
        const struct field_writer there = {m, x->w->format, part->tmp, x->w->location};
        struct file_sum sum;
        e = field_write(&there, x->q->name, c.components, x->q->dimensions, values, print_patch, &c, &sum);
        if (!e) e = checksums_add(&part->sums, x->q->name, sum);
    }
    free(values);
    free(across);
    free(c.face);
    return comm_agree(c.share->comm, e);
}

/* Writes a quantity with the entries of its patches, or with all patches calculated. */
static status write_shared(const struct field_writer *w, const struct quantity *q, struct printing *c,
                           struct file_sum *sum) {
    const struct patch_entries entries = {fetch_patch, print_patch, c};
    return field_write_shared(w, q->name, q->components, q->dimensions, c->share, c->slice, &entries, sum);
}

status output_quantity(const struct setup *s, const struct field_writer *w, int quantity, struct file_sum *sum) {
    const struct share share = share_make(s->comm, s->mesh->ncells);
    struct printing c = {
        .quantity = quantity, .components = s->medium->fields.quantity[quantity].components, .share = &share};
    struct edges *edges;
    double *slice = NULL;
    status e = edges_make(s, NULL, &edges);
    if (!e) e = edges_find(edges);
    c.edges = edges;
    if (!e) e = make_slice(s, quantity, &share, &slice);
    c.slice = slice;
    if (!e) e = write_shared(w, &s->medium->fields.quantity[quantity], &c, sum);
    edges_free(edges);
    free(slice);
    free(c.face);
    return e;
}

status output_slices(const struct field_writer *w, const struct quantity *q, const struct share *share,
                     const double *slice, struct file_sum *sum) {
    struct printing c = {.components = q->components, .share = share, .slice = slice};
    const status e = write_shared(w, q, &c, sum);
    free(c.face);
    return e;
}

/* Writes a quantity into the case's folder, then each part's share into its own. */
static status write_one(struct output *o, const struct field_writer *writer, int quantity) {
    const struct setup *s = o->setup;
    const struct quantity *q = &s->medium->fields.quantity[quantity];
    const struct share share = share_make(s->comm, s->mesh->ncells);
    struct printing c = {.medium = s->medium,
                         .quantity = quantity,
                         .components = q->components,
                         .share = &share,
                         .patches = s->mesh->patch,
                         .edges = o->edges};
    struct foam_format exact = *writer->format;
    struct field_writer all_digits = *writer;
    exact.precision = 17;
    all_digits.format = &exact;
    const struct field_writer *w = q->exact ? &all_digits : writer;
    const struct writing x = {o, q, w, &c};
    double *slice;
    struct file_sum sum;
    status e = make_slice(s, quantity, &share, &slice);
    c.slice = slice;
    if (!e) e = write_shared(w, q, &c, &sum);
    if (!e && comm_root(s->comm)) e = checksums_add(&o->sums, q->name, sum);
    e = comm_agree(s->comm, e);
    for (int k = 0; k < o->nparts && !e; k++) e = write_part(&x, o->parts ? &o->parts->part[k] : NULL);
    free(slice);
    free(c.face);
    return e;
}

static status write_fields(struct output *o, const struct field_writer *w) {
    const struct medium *m = o->setup->medium;
    TRY(edges_find(o->edges));
    for (const int *q = m->fields.written; *q >= 0; q++)
        if (!m->type->present || m->type->present(m, *q)) TRY(write_one(o, w, *q));
    return OK;
}

static status purge(struct output *o, const char *name, int keep) {
    if (time_is_original(&o->setup->start) && !strcmp(name, o->setup->start.name)) return OK; /* the start stays */
    for (int i = 0; i < o->nnames; i++)
        if (!strcmp(o->name[i], name)) return OK; /* the time was written again */
    if (o->nnames == o->room) {
        void *more = realloc(o->name, (size_t)(o->room = 2 * o->room + 16) * sizeof *o->name);
        if (!more) return fail(ERR_SYSTEM, "out of memory");
        o->name = more;
    }
    memcpy(o->name[o->nnames++], name, TIME_NAME);
    while (keep > 0 && o->nnames > keep) {
        TRY(time_remove(o->setup->dir, o->name[0]));
        TRY(decompose_remove(o->parts, o->name[0]));
        memmove(o->name, o->name + 1, (size_t)--o->nnames * sizeof *o->name);
    }
    return OK;
}

static status write_grains(struct output *o, const char *folder, const char *name) {
    const struct medium *m = o->setup->medium;
    struct cloud cloud;
    if (m->type->save) TRY(m->type->save(m, folder, name, &o->sums));
    if (!m->type->cloud) return OK;
    status e = m->type->cloud(m, &cloud);
    if (!e) e = cloud_write(&cloud, folder, name, &o->setup->control->format, &o->sums);
    cloud_free(&cloud);
    return e;
}

static status finish(struct output *o, const char *folder, const struct instant *at) {
    char path[TIME_PATH + 32], location[TIME_NAME + 16];
    snprintf(path, sizeof path, "%s/uniform/provenance", folder);
    snprintf(location, sizeof location, "%s/uniform", at->name);
    TRY(provenance_write(path, location, o->setup));
    TRY(write_grains(o, folder, at->name));
    return time_stamp_write(folder, at, &o->sums);
}

static status begin(struct output *o, const char *name, char folder[TIME_PATH]) {
    o->sums.n = 0;
    TRY(case_here(o->setup));
    TRY(time_begin(o->setup->dir, name, folder));
    return decompose_begin(o->parts, name);
}

/* Brings to the disk what a rank has written into the root's files. The root does so at the end, but may be on another
 * machine. */
static status sync_slices(const struct output *o, const char *folder) {
    const struct foam_format *f = &o->setup->control->format;
    if (comm_root(o->setup->comm) || !f->binary || f->compress) return OK;
    const int why = folder_sync(folder);
    return why ? file_error(folder, "cannot be brought to the disk", why) : OK;
}

static status write_all(struct output *o, const struct instant *at, char folder[TIME_PATH]) {
    const struct setup *s = o->setup;
    bool root = comm_root(s->comm);
    const struct field_writer w = {s->mesh, &s->control->format, folder, at->name};
    TRY(comm_agree(s->comm, root ? begin(o, at->name, folder) : OK));
    comm_broadcast(s->comm, folder, TIME_PATH);
    TRY(write_fields(o, &w));
    if (s->medium->type->keep) TRY(s->medium->type->keep(s->medium, &w, &o->sums));
    TRY(o->save(o->context, &w, &o->sums));
    TRY(comm_agree(s->comm, OK)); /* the root has closed all files and given them their names */
    TRY(comm_agree(s->comm, sync_slices(o, folder)));
    return comm_agree(s->comm, root ? finish(o, folder, at) : OK);
}

/* Removes the unfinished folder of a time, to make room on a full disk; else the next run would remove it. */
static void remove_half(struct output *o, const char *folder) {
    status gone = case_here(o->setup);
    if (!gone) status_free(remove_folder(folder));
    for (int k = 0; !gone && o->parts && k < o->parts->n; k++)
        if (*o->parts->part[k].tmp) status_free(remove_folder(o->parts->part[k].tmp));
    status_free(gone);
}

/* ---- to the disk ---- */

static status put_in_place(const struct commit *c) {
    TRY(case_here(c->o->setup));
    TRY(decompose_commit(c->o->parts, &c->at)); /* parts first: a time of the case is then in all its parts */
    TRY(time_commit(c->o->setup->dir, c->at.name));
    return purge(c->o, c->at.name, c->keep);
}

static void commit(void *context) {
    struct commit *c = context;
    c->result = put_in_place(c);
}

static status fail_writing(struct output *o, const char *folder, const char *name, status e) {
    if (*folder && comm_root(o->setup->comm)) remove_half(o, folder);
    return status_note(e, "while writing time %s; earlier times are intact", name);
}

/* Waits for the time that is on its way to the disk, if there is one. On the root. */
static status arrive(struct output *o) {
    struct commit *c = &o->commit;
    if (!c->thread) return OK;
    background_finish(c->thread);
    c->thread = NULL;
    if (c->result) return fail_writing(o, c->folder, c->at.name, c->result);
    printf("    written: %s\n", c->at.name);
    return OK;
}

/* Returns the error of the time before, which is on its way to the disk, rather than e; that one if it arrives. */
static status fail_first(struct output *o, status e) {
    const status before = comm_root(o->setup->comm) ? arrive(o) : OK;
    if (!before) return e;
    status_free(e);
    return before;
}

bool output_fails(struct output *o) {
    const struct commit *c = &o->commit;
    if (!c->thread || !background_ended(c->thread)) return false;
    if (c->result) return true;
    status_free(arrive(o));
    return false;
}

status output_settle(struct output *o) {
    return comm_agree(o->setup->comm, comm_root(o->setup->comm) ? arrive(o) : OK);
}

/* Waits for the time before where the next one needs its place: the same name, or the folders of parts. On the root. */
static status make_way(struct output *o, const char *name) {
    return o->parts || !strcmp(o->commit.at.name, name) ? arrive(o) : OK;
}

/* Sends a time whose files are complete to the disk, behind the time before. On the root. */
static status hand_over(struct output *o, const struct instant *at, const char *folder) {
    const status e = arrive(o);
    if (e) {
        remove_half(o, folder);
        return e;
    }
    o->commit = (struct commit){.o = o, .at = *at, .keep = o->setup->control->purge};
    memcpy(o->commit.folder, folder, TIME_PATH);
    return background_start(commit, &o->commit, &o->commit.thread);
}

status output_write(struct output *o, double t, long step, double delta_t, char written[TIME_NAME]) {
    const struct setup *s = o->setup;
    const struct control *c = s->control;
    struct instant at = {
        .t = t, .step = step, .delta_t = delta_t, .digits = c->format.binary ? 17 : c->format.precision};
    char folder[TIME_PATH] = "";
    int digits = time_name_apart(c->time_format, o->precision, t, o->last_time, at.name);
    if (digits > o->precision && comm_root(s->comm))
        printf("timePrecision %d would give two times the name of one; it is now %d\n", o->precision, digits);
    o->precision = digits;
    TRY(comm_agree(s->comm, comm_root(s->comm) ? make_way(o, at.name) : OK));
    status e = write_all(o, &at, folder);
    if (e) return fail_first(o, fail_writing(o, folder, at.name, e));
    TRY(comm_agree(s->comm, comm_root(s->comm) ? hand_over(o, &at, folder) : OK));
    o->last_time = t;
    memcpy(written, at.name, TIME_NAME);
    return OK;
}

void output_free(struct output *o) {
    if (!o) return;
    status_free(arrive(o)); /* another error ends the run: else output_settle has returned this one */
    decompose_free(o->parts);
    edges_free(o->edges);
    free(o->name);
    free(o);
}
