/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object vtk writes legacy VTK files of fields and grains, with a series file that ParaView opens. */
#include "solvers/functions/functions_private.h"

#include "solvers/output/clouds.h"
#include "solvers/output/output.h"
#include "solvers/output/vtk.h"

#include <stdlib.h>

struct vtk {
    bool ascii;
    struct vtk_grid *grid; /* on the root; made by the first execution, as is values */
    double *values;        /* on the root: [fields][3 cells] */
};

static const char *const formats[] = {"binary", "ascii", NULL};
#define PARAM_STRUCT struct vtk
static const struct param vtk_param[] = {
    EITHER("writeFormat", ascii, false, formats, "of the VTK files"),
};

static status vtk_make(struct function *f, struct dict *d) {
    struct vtk *v;
    TRY(allocate(&v, 1, sizeof *v, "VTK files"));
    f->own = v;
    return params_read(d, f->type->param, f->type->nparam, v);
}

static status write_cloud(const struct function *f, const struct moment *now, const char *folder, const char *time) {
    const struct vtk *v = f->own;
    const struct setup *s = f->setup;
    struct cloud cloud;
    char name[sizeof s->name + 16];
    if (!s->medium->type->cloud) return OK;
    status e = s->medium->type->cloud(s->medium, &cloud);
    const bool any = !e && cloud.n > 0;
    if (any) e = cloud_write_vtk(&cloud, folder, s->name, time, v->ascii, now->t, now->step);
    cloud_free(&cloud);
    TRY(e);
    snprintf(name, sizeof name, "%s-grains", s->name);
    return any ? vtk_series_write(folder, name, now->t) : OK;
}

static status write_file(const struct function *f, const struct moment *now, const char *time,
                         const struct vtk_field *fields) {
    const struct vtk *v = f->own;
    char folder[TIME_PATH + 8], path[2 * TIME_PATH];
    snprintf(folder, sizeof folder, "%s/VTK", f->setup->dir);
    TRY(case_make_folders(f->setup, folder));
    snprintf(path, sizeof path, "%s/%s_%s.vtk", folder, f->setup->name, time);
    TRY(vtk_write(v->grid, path, v->ascii, now->t, now->step, f->nfields, fields));
    TRY(write_cloud(f, now, folder, time));
    return vtk_series_write(folder, f->setup->name, now->t);
}

static status vtk_execute(struct function *f, const struct moment *now, const char *time) {
    struct vtk_field fields[MAX_QUANTITIES];
    struct vtk *v = f->own;
    const struct setup *s = f->setup;
    long n = s->mesh->ncells;
    bool root = comm_root(s->comm);
    status e = OK;
    if (root) e = setup_complete(s);
    if (root && !e && !v->grid) e = vtk_grid_make(s->mesh, &v->grid);
    if (root && !e && !v->values) e = allocate(&v->values, 3 * n * f->nfields, sizeof(double), "VTK fields");
    TRY(comm_agree(s->comm, e));
    for (int k = 0; k < f->nfields; k++) {
        double *values = root ? v->values + 3 * n * k : NULL;
        TRY(output_gather(s, f->field[k], values));
        fields[k] =
            (struct vtk_field){quantity_of(f, f->field[k])->name, quantity_of(f, f->field[k])->components, values};
    }
    return comm_agree(s->comm, root ? write_file(f, now, time, fields) : OK);
}

static void vtk_free(void *own) {
    struct vtk *v = own;
    vtk_grid_free(v->grid);
    free(v->values);
    free(v);
}

const struct function_type function_vtk = {
    .name = "vtk",
    .about = "legacy VTK files in VTK/, with a .vtk.series",
    FUNCTION_PARAMS(vtk_param),
    .make = vtk_make,
    .execute = vtk_execute,
    .free = vtk_free,
    .all_fields = true,
};
