/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes times of a case: fields with their patch entries, processorN parts, grains, provenance, checksums; purges old
 * times (output.h). */
#include "solvers/output/output.h"

#include "libcore/models/boundary.h"
#include "solvers/case/checksums.h"
#include "solvers/output/clouds.h"
#include "solvers/output/decompose.h"
#include "solvers/output/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct output {
    const struct setup *setup;
    output_saver *save;
    const void *context;         /* of save */
    double *values;              /* root: [ncells][3], while a time is written */
    double last_time;            /* s, of the last time written; NAN: none */
    int precision;               /* digits of time names, widened where needed */
    struct checksums sums;       /* checksums of the time that is being written; root */
    struct decomposition *parts; /* NULL: no processorN folders; root */
    double *part_values;         /* root: [ncells][3], likewise */
    double *patch_values;        /* root: [faces of the largest patch][3], likewise */
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

/* Returns the faces of the largest patch that has values in files. */
static int largest_patch(const struct setup *s, const struct decomposition *d) {
    int n = 0;
    for (int k = -1; k < (d ? d->n : 0); k++) {
        const struct polymesh *m = k < 0 ? s->mesh : d->part[k].mesh;
        for (int p = 0; p < m->npatches; p++)
            if (m->patch[p].nfaces > n && strcmp(m->patch[p].type, "empty") != 0) n = m->patch[p].nfaces;
    }
    return n;
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
    return s->control->write_processors ? decompose_make(s, &o->parts) : OK;
}

/* Makes room for fields to write, on the root. */
static status make_room(struct output *o) {
    const struct setup *s = o->setup;
    const long n = s->mesh->ncells;
    if (!comm_root(s->comm)) return OK;
    TRY(allocate(&o->values, 3 * n, sizeof(double), "a field to write"));
    TRY(allocate(&o->patch_values, 3L * largest_patch(s, o->parts) + 1, sizeof(double), "a patch to write"));
    return o->parts ? allocate(&o->part_values, 3 * n, sizeof(double), "a field to write") : OK;
}

static void drop_room(struct output *o) {
    free(o->part_values);
    free(o->patch_values);
    free(o->values);
    o->part_values = o->patch_values = o->values = NULL;
}

void output_free(struct output *o) {
    if (!o) return;
    decompose_free(o->parts);
    drop_room(o);
    free(o->name);
    free(o);
}

/* Turns lines along computational axes into interleaved components along physical axes. */
static void interleave(const struct setup *s, double *const *line, bool vector, int lines, double *out) {
    long n = s->mesh->ncells;
    if (!vector) {
        memcpy(out, line[0], (size_t)n * sizeof *out);
        return;
    }
    memset(out, 0, (size_t)n * 3 * sizeof *out);
    for (int k = 0; k < lines; k++)
        for (long i = 0; i < n; i++) out[3 * i + s->axis[k]] = line[k][i];
}

status output_gather(const struct setup *s, int quantity, double *out) {
    double *line[3] = {NULL, NULL, NULL};
    const bool vector = s->medium->type->quantity[quantity].components == 3;
    const int lines = setup_lines(s, quantity);
    status e = OK;
    for (int k = 0; !e && k < lines && comm_root(s->comm); k++)
        e = allocate(&line[k], s->mesh->ncells, sizeof(double), "a field to write");
    e = comm_agree(s->comm, e);
    if (!e) e = s->medium->type->gather(s->medium, quantity, line);
    if (!e && comm_root(s->comm)) interleave(s, line, vector, lines, out);
    for (int k = 0; k < 3; k++) free(line[k]);
    return e;
}

struct printing {                /* context of print_patch */
    const struct medium *medium; /* NULL: all patches are calculated */
    int quantity, components;
    const double *values;        /* values in the cells of the mesh that is being written */
    const struct part *part;     /* part of a decomposed case, or NULL */
    const double *all;           /* values in the case's cells, if there is a part */
    const struct patch *patches; /* patches of the case */
    double *room;                /* [largest patch][3] */
};

static void print_list(struct sink *s, const struct foam_format *f, int components, int n, const double *values) {
    sink_printf(s, "nonuniform List<%s>\n", field_item(components));
    foam_list_write_doubles(s, f, components, n, values);
    sink_printf(s, ";\n");
}

/* Prints the parameters of a type with all digits, because the next start reads them. */
static void print_parameters(struct sink *s, const struct model *m, const struct patch_field *q) {
    for (int i = 0; i < m->nparam; i++) {
        if (q->varying && !strcmp(varying_key(q->varying), m->param[i].name)) continue; /* the rule is printed */
        const double *v = q->params.room + m->param[i].offset / sizeof(double);
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
    for (int i = 0; i < patch->nfaces; i++) {
        int from = c->part ? c->part->face[patch->start + i] - c->patches[p].start : i;
        memcpy(c->room + (long)i * m, q->values + (long)from * m, (size_t)m * sizeof(double));
    }
    print_list(s, &exact, m, patch->nfaces, c->room);
}

/* Prints as value of each face that of the cell inside or, `across` a processor patch, of the cell on the other
 * side. */
static void print_cells(struct sink *s, const struct field_writer *w, int p, const struct printing *c, bool across) {
    const struct patch *patch = &w->mesh->patch[p];
    int m = c->components;
    for (int i = 0; i < patch->nfaces; i++) {
        const double *v = across ? c->all + (long)c->part->across[patch->start + i] * m
                                 : c->values + (long)polymesh_patch_cell(w->mesh, p, i) * m;
        memcpy(c->room + (long)i * m, v, (size_t)m * sizeof *v);
    }
    sink_printf(s, "        %-15s ", "value");
    print_list(s, w->format, m, patch->nfaces, c->room);
}

static void print_patch(struct sink *s, const struct field_writer *w, int p, const void *context) {
    const struct printing *c = context;
    const char *type = w->mesh->patch[p].type;
    static const char *const constraints[] = {"empty", "cyclic", "symmetry", "symmetryPlane"};
    for (int i = 0; i < 4; i++)
        if (!strcmp(type, constraints[i])) {
            sink_printf(s, "        %-15s %s;\n", "type", type);
            return;
        }
    if (c->part && p >= c->part->npatches) {
        sink_printf(s, "        %-15s %s;\n", "type", type);
        print_cells(s, w, p, c, true);
        return;
    }
    const struct patch_field *given = c->medium ? c->medium->type->patch(c->medium, c->quantity, p) : NULL;
    sink_printf(s, "        %-15s %s;\n", "type", given ? given->type : "calculated");
    const struct boundary_type *b = given ? boundary_find(given->type) : NULL;
    const char *value = boundary_value(b, c->components);
    if (b) print_parameters(s, &b->model, given);
    if (value && b->giving == BY_LIST) print_given(s, w, p, value, given, c);
    if (given && given->varying) varying_print(s, given->varying);
    if (b && (b->giving == BY_FUNCTION || b->giving == BY_EXPRESSION))
        print_given(s, w, p, "value", given, c);
    else if (!b || (boundary_gives(b) && !(value && !strcmp(value, "value"))))
        print_cells(s, w, p, c, false); /* OpenFOAM demands a `value` for this type */
}

status output_values(const struct setup *s, const struct field_writer *w, const struct quantity *q,
                     const double *values, struct file_sum *sum) {
    struct printing c = {.components = q->components, .values = values};
    struct file_sum unasked;
    TRY(allocate(&c.room, (long)q->components * largest_patch(s, NULL) + 1, sizeof(double), "a patch to write"));
    status e = field_write(w, q->name, q->components, q->dimensions, values, print_patch, &c, sum ? sum : &unasked);
    free(c.room);
    return e;
}

status output_field(const struct setup *s, const struct field_writer *w, int quantity, const double *values) {
    return output_values(s, w, &s->medium->type->quantity[quantity], values, NULL);
}

/* Writes o->values into the case's folder, then each part's share into its own. */
static status write_one(struct output *o, const struct field_writer *writer, int quantity) {
    const struct quantity *q = &o->setup->medium->type->quantity[quantity];
    const int components = q->components;
    const char *name = q->name;
    struct printing c = {o->setup->medium,      quantity,       components, o->values, NULL, o->values,
                         o->setup->mesh->patch, o->patch_values};
    struct foam_format exact = *writer->format;
    struct field_writer all_digits = *writer;
    exact.precision = 17;
    all_digits.format = &exact;
    const struct field_writer *w = q->exact ? &all_digits : writer;
    struct file_sum sum;
    TRY(field_write(w, name, components, q->dimensions, o->values, print_patch, &c, &sum));
    TRY(checksums_add(&o->sums, name, sum));
    for (int k = 0; o->parts && k < o->parts->n; k++) {
        struct part *part = &o->parts->part[k];
        const struct field_writer there = {part->mesh, w->format, part->tmp, w->location};
        for (int i = 0; i < part->mesh->ncells; i++)
            memcpy(o->part_values + (long)i * components, o->values + (long)part->cell[i] * components,
                   (size_t)components * sizeof(double));
        c.part = part;
        c.values = o->part_values;
        TRY(field_write(&there, name, components, q->dimensions, o->part_values, print_patch, &c, &sum));
        TRY(checksums_add(&part->sums, name, sum));
    }
    return OK;
}

/* Writes all fields. Each rank takes part in each gather, even if the root could not write the field before. */
static status write_fields(struct output *o, const struct field_writer *w) {
    const struct setup *s = o->setup;
    const struct medium *m = s->medium;
    status e = OK;
    TRY(comm_agree(s->comm, make_room(o)));
    for (const int *q = m->type->written; *q >= 0; q++) {
        if (m->type->present && !m->type->present(m, *q)) continue;
        status gathered = output_gather(s, *q, o->values);
        if (!gathered && !e && comm_root(s->comm)) e = write_one(o, w, *q);
        if (gathered) status_free(e), e = gathered;
    }
    drop_room(o);
    return comm_agree(s->comm, e);
}

static status purge(struct output *o, const char *name) {
    int keep = o->setup->control->purge;
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
    TRY(time_stamp_write(folder, at, &o->sums));
    TRY(case_here(o->setup));
    TRY(decompose_commit(o->parts, at)); /* parts first: a time of the case is then in all its parts */
    TRY(time_commit(o->setup->dir, at->name));
    return purge(o, at->name);
}

static status begin(struct output *o, const char *name, char folder[TIME_PATH]) {
    o->sums.n = 0;
    TRY(case_here(o->setup));
    TRY(time_begin(o->setup->dir, name, folder));
    return decompose_begin(o->parts, name);
}

static status write_all(struct output *o, const struct instant *at, char folder[TIME_PATH]) {
    const struct setup *s = o->setup;
    bool root = comm_root(s->comm);
    const struct field_writer w = {s->mesh, &s->control->format, folder, at->name};
    TRY(comm_agree(s->comm, root ? begin(o, at->name, folder) : OK));
    TRY(write_fields(o, &w));
    TRY(o->save(o->context, &w, &o->sums));
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
    status e = write_all(o, &at, folder);
    if (e) {
        if (*folder) remove_half(o, folder);
        return status_note(e, "while writing time %s; earlier times are intact", at.name);
    }
    o->last_time = t;
    memcpy(written, at.name, TIME_NAME);
    return OK;
}
