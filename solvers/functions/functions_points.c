/* Function objects that sample cells at points: probes and sets. */
#include "solvers/functions/functions_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void bounding_box(const struct polymesh *m, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = HUGE_VAL;
        high[a] = -HUGE_VAL;
        for (int i = 0; i < m->npoints; i++) {
            low[a] = fmin(low[a], m->points[3 * (long)i + a]);
            high[a] = fmax(high[a], m->points[3 * (long)i + a]);
        }
        double slack = 1e-9 * (high[a] - low[a]);
        low[a] -= slack;
        high[a] += slack;
    }
}

status function_place(struct function *f, struct dict *d, const char *key, int n, const double *points,
                      bool allow_outside) {
    struct spot *more = realloc(f->spot, (size_t)(f->nspots + n + 1) * sizeof *more);
    if (!more) return fail(ERR_SYSTEM, "out of memory");
    f->spot = more;
    double low[3], high[3]; /* grid_locate looks at the solved axes only */
    bounding_box(f->setup->mesh, low, high);
    for (int i = 0; i < n; i++) {
        struct spot *p = &f->spot[f->nspots++];
        memcpy(p->x, points + 3 * (long)i, sizeof p->x);
        grid_locate(f->setup->grid, p->x, &p->block, &p->cell);
        double found = p->block >= 0;
        for (int a = 0; a < 3; a++)
            if (p->x[a] < low[a] || p->x[a] > high[a]) found = 0;
        if (found == 0) p->block = -1;
        comm_max(f->setup->comm, &found, 1);
        p->inside = found > 0;
        if (!p->inside && !allow_outside)
            return dict_fail(d, key, "the point (%g %g %g) lies outside the mesh%s", p->x[0], p->x[1], p->x[2],
                             f->type->make == probes_make ? "; move it, or say  allowOutside yes;" : "");
    }
    return OK;
}

status function_sample(const struct function *f, int field, double **out) {
    const struct grid *grid = f->setup->grid;
    int m = quantity_of(f, field)->components;
    double *lines[3];
    TRY(allocate(out, (long)(f->nspots + 1) * m, sizeof(double), "samples"));
    for (long i = 0; i < (long)f->nspots * m; i++) (*out)[i] = -HUGE_VAL;
    for (int b = 0; b < grid->nblocks; b++) {
        bool wanted = false;
        for (int i = 0; i < f->nspots; i++) wanted |= f->spot[i].block == b;
        if (!wanted) continue;
        function_block(f, b, field, lines);
        for (int i = 0; i < f->nspots; i++) {
            if (f->spot[i].block != b) continue;
            double *to = *out + (long)i * m;
            if (m == 1)
                *to = lines[0][f->spot[i].cell];
            else
                for (int x = 0; x < 3; x++) to[x] = 0;
            for (int k = 0; m == 3 && k < grid->dim; k++) to[grid->axis[k]] = lines[k][f->spot[i].cell];
        }
    }
    comm_max(f->setup->comm, *out, f->nspots * m); /* one rank has each value, the others -infinity */
    for (int i = 0; i < f->nspots; i++)
        for (int c = 0; c < m && !f->spot[i].inside; c++) (*out)[(long)i * m + c] = -1e300; /* as OpenFOAM writes */
    return OK;
}

status probes_make(struct function *f, struct dict *d) {
    const double *points;
    int n;
    bool outside;
    static const char *const schemes[] = {"cell"};
    int scheme;
    TRY(dict_switch_or(d, "allowOutside", false, &outside));
    if (dict_has(d, "interpolationScheme")) TRY(dict_choice(d, "interpolationScheme", schemes, 1, &scheme));
    if (dict_has(d, "fixedLocations")) TRY(dict_switch_or(d, "fixedLocations", true, &(bool){false}));
    TRY(dict_vectors(d, "probeLocations", &n, &points));
    if (n < 1) return dict_fail(d, "probeLocations", "it is empty; give ((x y z) ...)");
    return function_place(f, d, "probeLocations", n, points, outside);
}

static status probes_open(struct function *f, int field) {
    TRY(function_open(f, f->setup->start.name, quantity_of(f, f->field[field])->name, &f->file[field]));
    for (int i = 0; i < f->nspots; i++)
        fprintf(f->file[field], "# Probe %d (%.12g %.12g %.12g)%s\n", i, f->spot[i].x[0], f->spot[i].x[1],
                f->spot[i].x[2], f->spot[i].inside ? "" : "  # Not Found");
    fprintf(f->file[field], "#       Time\n");
    return OK;
}

status probes_execute(struct function *f, const struct moment *now, const char *time) {
    (void)time;
    for (int k = 0; k < f->nfields; k++) {
        double *values;
        int m = quantity_of(f, f->field[k])->components;
        TRY(function_sample(f, f->field[k], &values));
        status s = OK;
        if (comm_root(f->setup->comm)) {
            if (!f->file[k]) s = probes_open(f, k);
            if (!s) fprintf(f->file[k], "%.12g", now->t);
            for (int i = 0; !s && i < f->nspots; i++)
                if (m == 1)
                    fprintf(f->file[k], " %.12g", values[i]);
                else
                    fprintf(f->file[k], " (%.12g %.12g %.12g)", values[3 * i], values[3 * i + 1], values[3 * i + 2]);
            if (!s && (fprintf(f->file[k], "\n") < 0 || fflush(f->file[k])))
                s = fail(ERR_SYSTEM, "postProcessing/%s: cannot be written (disk full?)", f->name);
        }
        free(values);
        TRY(comm_agree(f->setup->comm, s));
    }
    return OK;
}

static const char *const axis_names[] = {"x", "y", "z", "distance", "xyz"};

static status set_make(struct function *f, const char *name, struct dict *d) {
    static const char *const types[] = {"uniform"};
    struct line *l = &f->line[f->nlines];
    double start[3], end[3], *points;
    long n;
    int index;
    TRY(dict_choice(d, "type", types, 1, &index));
    TRY(dict_choice(d, "axis", axis_names, 5, &l->axis));
    TRY(dict_vector(d, "start", NULL, start));
    TRY(dict_vector(d, "end", NULL, end));
    TRY(dict_count_or(d, "nPoints", 0, &n));
    if (n < 2 || n > 10000000) return dict_fail(d, "nPoints", "give a number from 2 to 10000000");
    snprintf(l->name, sizeof l->name, "%s", name);
    l->first = f->nspots;
    l->n = (int)n;
    TRY(allocate(&points, 3 * n, sizeof(double), "points of a line"));
    for (long i = 0; i < n; i++)
        for (int x = 0; x < 3; x++)
            points[3 * i + x] = i == n - 1 ? end[x] : start[x] + (end[x] - start[x]) * (double)i / (double)(n - 1);
    status s =
        function_place(f, d, "start", (int)n, points, true); /* points off the mesh are left out, as OpenFOAM does */
    free(points);
    f->nlines++;
    bool any = false;
    for (int i = 0; !s && i < (int)n; i++) any |= f->spot[l->first + i].inside;
    return s ? s : any ? OK : dict_fail(d, "start", "no point of the line lies in the mesh");
}

status sets_make(struct function *f, struct dict *d) {
    static const char *const formats[] = {"raw"}, *const schemes[] = {"cell"};
    struct dict *sets, *one;
    int index;
    if (dict_has(d, "setFormat")) TRY(dict_choice(d, "setFormat", formats, 1, &index));
    if (dict_has(d, "interpolationScheme")) TRY(dict_choice(d, "interpolationScheme", schemes, 1, &index));
    TRY(dict_sub(d, "sets", &sets));
    int n = dict_count(sets);
    if (!n) return dict_fail(d, "sets", "it is empty");
    TRY(allocate(&f->line, n, sizeof *f->line, "lines"));
    for (int i = 0; i < n; i++) {
        TRY(dict_sub(sets, dict_key(sets, i), &one));
        TRY(set_make(f, dict_key(sets, i), one));
    }
    return OK;
}

static void print_place(FILE *file, const struct line *l, const struct spot *first, const struct spot *p) {
    double away = hypot(hypot(p->x[0] - first->x[0], p->x[1] - first->x[1]), p->x[2] - first->x[2]);
    if (l->axis == 4)
        fprintf(file, "%.12g\t%.12g\t%.12g", p->x[0], p->x[1], p->x[2]);
    else
        fprintf(file, "%.12g", l->axis == 3 ? away : p->x[l->axis]);
}

/* One file for all scalars (a_alpha_T.xy), one for each vector (a_U.xy). */
static status write_line(const struct function *f, const struct line *l, double *const *values, const char *time,
                         bool vectors, int only) {
    char name[512];
    FILE *file;
    int length = snprintf(name, sizeof name, "%s", l->name);
    for (int k = 0; k < f->nfields; k++)
        if (vectors ? k == only : quantity_of(f, f->field[k])->components == 1)
            length += snprintf(name + length, sizeof name - (size_t)length, "_%s", quantity_of(f, f->field[k])->name);
    snprintf(name + length, sizeof name - (size_t)length, ".xy");
    TRY(function_open(f, time, name, &file));
    for (int i = l->first; i < l->first + l->n; i++) {
        if (!f->spot[i].inside) continue;
        print_place(file, l, &f->spot[l->first], &f->spot[i]);
        for (int k = 0; k < f->nfields; k++) {
            if (!vectors && quantity_of(f, f->field[k])->components == 1) fprintf(file, "\t%.12g", values[k][i]);
            for (int x = 0; vectors && k == only && x < 3; x++) fprintf(file, "\t%.12g", values[k][3 * (long)i + x]);
        }
        fprintf(file, "\n");
    }
    bool bad = ferror(file);
    return fclose(file) || bad ? fail(ERR_SYSTEM, "postProcessing/%s/%s/%s: cannot be written", f->name, time, name)
                               : OK;
}

status sets_execute(struct function *f, const struct moment *now, const char *time) {
    (void)now;
    double *values[MAX_QUANTITIES] = {NULL};
    bool scalars = false;
    status s = OK;
    for (int k = 0; k < f->nfields; k++) {
        status sampled = function_sample(f, f->field[k], &values[k]);
        if (!s) s = sampled;
        scalars |= quantity_of(f, f->field[k])->components == 1;
    }
    for (int i = 0; !s && comm_root(f->setup->comm) && i < f->nlines; i++) {
        if (scalars) s = write_line(f, &f->line[i], values, time, false, -1);
        for (int k = 0; !s && k < f->nfields; k++)
            if (quantity_of(f, f->field[k])->components == 3) s = write_line(f, &f->line[i], values, time, true, k);
    }
    for (int k = 0; k < f->nfields; k++) free(values[k]);
    return comm_agree(f->setup->comm, s);
}
