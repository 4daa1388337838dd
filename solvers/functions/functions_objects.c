/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object writeObjects writes fields that are made of the state, as Ma and vorticity, into the time folders. A
 * restart does not read them. */
#include "solvers/functions/functions_private.h"

#include "solvers/output/output.h"

#include <string.h>

static const struct param objects_param[] = {
    NOTED("objects", "list of words: as fields", "required, or fields", "fields that it writes into the time folders",
          "objects (U);"),
    IGNORED("writeOption", "for OpenFOAM: fields are written with the others"),
};

/* Does each time folder have the field anyway? */
static bool is_written(const struct function *f, int field) {
    const int *q = f->setup->medium->fields.written;
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
    if (!f->trigger.with_fields)
        return dict_fail(d, "writeControl", "its fields stand in the time folders of the others: leave it out");
    if (dict_has(d, "objects") && dict_has(d, "fields"))
        return dict_fail(d, "fields", "that is another word for `objects`, which is there, too");
    if (!dict_has(d, "objects") && !dict_has(d, "fields"))
        return dict_missing(d, "objects", "the fields that it writes: objects (Ma vorticity);");
    TRY(function_fields(f, d, key));
    return check_others(f, d, key);
}

static status objects_save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    const struct setup *s = f->setup;
    for (int k = 0; k < f->nfields; k++) {
        struct file_sum sum;
        if (is_written(f, f->field[k])) continue;
        TRY(output_quantity(s, w, f->field[k], &sum));
        TRY(comm_agree(s->comm, comm_root(s->comm) ? checksums_add(sums, quantity_of(f, f->field[k])->name, sum) : OK));
    }
    return OK;
}

const struct function_type function_objects = {
    .name = "writeObjects",
    .about = "fields made of the state, in the time folders: Ma, vorticity, ..",
    FUNCTION_PARAMS(objects_param),
    .make = objects_make, /* all is written when the fields are saved */
    .no_fields = true,
    .with_fields = true,
    .save = objects_save,
};
