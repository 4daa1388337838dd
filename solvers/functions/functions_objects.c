/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object writeObjects writes fields that are made of the state, as Ma and vorticity, into the time folders. A
 * restart does not read them. */
#include "solvers/functions/functions_private.h"

#include "solvers/output/output.h"

#include <stdlib.h>
#include <string.h>

struct objects {
    double *values; /* on the root: [ncells][3]; made by the first writing */
};

static const struct param objects_param[] = {
    NOTED("objects", "list of words: as fields", "required, or fields", "fields that it writes into the time folders",
          "objects (U);"),
    IGNORED("writeOption", "for OpenFOAM: fields are written with the others"),
};

/* Does each time folder have the field anyway? */
static bool is_written(const struct function *f, int field) {
    const int *q = f->setup->medium->type->written;
    while (*q >= 0 && *q != field) q++;
    return *q >= 0;
}

/* Two objects that write the same file would overwrite each other's. */
static status check_others(const struct function *f, struct dict *d, const char *key) {
    for (int i = 0; i < f->nearlier; i++) {
        const struct function *other = &f->earlier[i];
        for (int j = 0; other->type == f->type && j < other->nfields; j++)
            for (int k = 0; k < f->nfields; k++)
                if (other->field[j] == f->field[k])
                    return dict_fail(d, key, "'%s' writes %s already", other->name, quantity_of(f, f->field[k])->name);
    }
    return OK;
}

static status objects_make(struct function *f, struct dict *d) {
    const char *key = dict_has(d, "objects") ? "objects" : "fields";
    TRY(allocate(&f->own, 1, sizeof(struct objects), "fields to write"));
    TRY(params_read(d, f->type->param, f->type->nparam, f->own));
    if (!f->trigger.with_fields)
        return dict_fail(d, "writeControl", "its fields stand in the time folders of the others: leave it out");
    if (dict_has(d, "objects") && dict_has(d, "fields"))
        return dict_fail(d, "fields", "that is another word for `objects`, which is there, too");
    if (!dict_has(d, "objects") && !dict_has(d, "fields"))
        return dict_missing(d, "objects", "the fields that it writes: objects (Ma vorticity);");
    TRY(function_fields(f, d, key));
    return check_others(f, d, key);
}

static status objects_execute(struct function *f, const struct moment *now, const char *time) {
    (void)f;
    (void)now;
    (void)time;
    return OK; /* all is done when the fields are saved */
}

static status write_field(const struct function *f, const struct field_writer *w, int field, struct checksums *sums) {
    const struct objects *o = f->own;
    const struct quantity *q = quantity_of(f, field);
    struct file_sum sum;
    TRY(output_values(f->setup, w, q, o->values, &sum));
    return checksums_add(sums, q->name, sum);
}

/* Each rank takes part in each gather, even if the root cannot write. */
static status objects_save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    struct objects *o = f->own;
    const struct setup *s = f->setup;
    const bool root = comm_root(s->comm);
    status e = OK;
    if (root && !o->values) e = allocate(&o->values, 3L * s->mesh->ncells, sizeof(double), "a field to write");
    TRY(comm_agree(s->comm, e));
    for (int k = 0; k < f->nfields; k++) {
        if (is_written(f, f->field[k])) continue;
        const status gathered = output_gather(s, f->field[k], o->values);
        if (root && !e && !gathered) e = write_field(f, w, f->field[k], sums);
        if (gathered && e) status_free(gathered);
        if (gathered && !e) e = gathered;
    }
    return comm_agree(s->comm, e);
}

static void objects_free(void *own) {
    struct objects *o = own;
    free(o->values);
    free(o);
}

const struct function_type function_objects = {
    .name = "writeObjects",
    .about = "fields made of the state, in the time folders: Ma, vorticity, ..",
    FUNCTION_PARAMS(objects_param),
    .make = objects_make,
    .execute = objects_execute,
    .free = objects_free,
    .no_fields = true,
    .with_fields = true,
    .save = objects_save,
};
