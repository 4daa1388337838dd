/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object vtk writes VTK files of fields and grains, legacy or XML, with a series file that ParaView opens. */
#include "solvers/functions/functions_private.h"

#include "solvers/output/clouds.h"
#include "solvers/output/output.h"
#include "solvers/output/vtk.h"
#include "solvers/output/vtk_pieces.h"

#include <stdlib.h>

struct vtk {
    bool ascii, legacy, pieces;
    enum vtk_form form;
    struct vtk_grid *grid; /* on the root; made by the first execution, as is values */
    double *values;        /* on the root: [fields][3 cells] */
};

static const char *const formats[] = {"binary", "ascii", NULL};
#define PARAM_STRUCT struct vtk
static const struct param vtk_param[] = {
    EITHER("writeFormat", ascii, false, formats, "of legacy files"),
    SWITCH("legacy", legacy, true,
           "legacy VTK (.vtk), which every reader knows; no: XML files (.vtu), whose arrays are compressed"),
    SWITCH("pieces", pieces, false,
           "a .vtu for each rank and an index .pvtu, binary, instead of one .vtk: no rank holds the whole; lattices"),
};

static status vtk_make(struct function *f, struct dict *d) {
    struct vtk *v = f->own;
    if (v->pieces && v->ascii) return dict_fail(d, "writeFormat", "pieces are binary; leave the key out");
    if (!v->legacy && v->ascii)
        return dict_fail(d, "writeFormat", "files of  legacy no;  are binary; leave the key out");
    v->form = !v->legacy ? VTK_XML : v->ascii ? VTK_ASCII : VTK_BINARY;
    if (!v->pieces || f->setup->grid->forest) return OK;
    return dict_fail(d, "pieces", "they are for lattices, and this run is on polyhedra; leave the key out");
}

static status write_cloud(const struct function *f, const struct moment *now, const char *folder, const char *time) {
    const struct vtk *v = f->own;
    const struct setup *s = f->setup;
    struct cloud cloud;
    char name[sizeof s->name + 16];
    if (!s->medium->type->cloud) return OK;
    status e = s->medium->type->cloud(s->medium, &cloud);
    const bool any = !e && cloud.n > 0;
    if (any) e = cloud_write_vtk(&cloud, folder, s->name, time, v->form, now->t, now->step);
    cloud_free(&cloud);
    TRY(e);
    snprintf(name, sizeof name, "%s-grains", s->name);
    return any ? vtk_series_write(folder, name, vtk_ending(v->form), now->t) : OK;
}

static status write_file(const struct function *f, const struct moment *now, const char *time,
                         const struct vtk_field *fields) {
    const struct vtk *v = f->own;
    char folder[TIME_PATH + 8], path[2 * TIME_PATH];
    snprintf(folder, sizeof folder, "%s/VTK", f->setup->dir);
    TRY(case_make_folders(f->setup, folder));
    snprintf(path, sizeof path, "%s/%s_%s%s", folder, f->setup->name, time, vtk_ending(v->form));
    TRY(vtk_write(v->grid, path, v->form, now->t, now->step, f->nfields, fields));
    TRY(write_cloud(f, now, folder, time));
    return vtk_series_write(folder, f->setup->name, vtk_ending(v->form), now->t);
}

static status write_pieces(const struct function *f, const struct moment *now, const char *time) {
    const struct setup *s = f->setup;
    char folder[TIME_PATH + 8], name[sizeof s->name + TIME_NAME];
    int quantity[MAX_QUANTITIES + 1];
    memcpy(quantity, f->field, (size_t)f->nfields * sizeof *quantity);
    quantity[f->nfields] = -1;
    snprintf(folder, sizeof folder, "%s/VTK", s->dir);
    snprintf(name, sizeof name, "%s_%s", s->name, time);
    TRY(vtk_pieces_write(s, folder, name, now->t, now->step, quantity));
    status e = comm_root(s->comm) ? write_cloud(f, now, folder, time) : OK;
    if (!e && comm_root(s->comm)) e = vtk_series_write(folder, s->name, ".pvtu", now->t);
    return comm_agree(s->comm, e);
}

static status vtk_execute(struct function *f, const struct moment *now, const char *time) {
    struct vtk_field fields[MAX_QUANTITIES];
    struct vtk *v = f->own;
    const struct setup *s = f->setup;
    long n = s->mesh->ncells, lines = 0;
    bool root = comm_root(s->comm);
    status e = OK;
    if (v->pieces) return write_pieces(f, now, time);
    for (int k = 0; k < f->nfields; k++) lines += quantity_of(f, f->field[k])->components;
    if (root) e = polymesh_complete(s->mesh); /* its geometry is not asked for */
    if (root && !e && !v->grid) e = vtk_grid_make(s->mesh, &v->grid);
    if (root && !e && !v->values) e = pool_take(f->pool, &v->values, n * lines, sizeof(double), "VTK fields");
    TRY(comm_agree(s->comm, e));
    double *values = root ? v->values : NULL;
    for (int k = 0; k < f->nfields; k++) {
        const struct quantity *q = quantity_of(f, f->field[k]);
        TRY(output_gather(s, f->field[k], values));
        fields[k] = (struct vtk_field){q->name, q->components, values};
        if (root) values += n * q->components;
    }
    return comm_agree(s->comm, root ? write_file(f, now, time, fields) : OK);
}

static void vtk_free(void *own) {
    vtk_grid_free(((struct vtk *)own)->grid);
}

const struct function_type function_vtk = {
    .name = "vtk",
    .about = "VTK files in VTK/, with a series for ParaView",
    FUNCTION_PARAMS(vtk_param),
    .size = sizeof(struct vtk),
    .make = vtk_make,
    .execute = vtk_execute,
    .free = vtk_free,
    .all_fields = true,
};
