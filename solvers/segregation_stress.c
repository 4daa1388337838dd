/* The percolation velocity from the kinetic stress rho T of a granularGas run. */
#include "solvers/segregation_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct column { /* the mean stress of all cells whose centres share a coordinate */
    double at, stress, weight;
};
static int by_place(const void *a, const void *b) {
    const struct column *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

static status find_time(const struct segregation_models *m, const char *dir, char name[TIME_NAME]) {
    struct instant *all;
    int n, found = -1;
    TRY(times_list(dir, &n, &all));
    for (int i = 0; i < n; i++)
        if (!strcmp(m->time, "latestTime") || !strcmp(m->time, all[i].name)) found = i;
    if (found >= 0) memcpy(name, all[found].name, TIME_NAME);
    free(all);
    return found >= 0
               ? OK
               : fail(ERR_INPUT, "%s: percolation: case %s has no time %s", dict_path(m->properties), dir, m->time);
}

static status read_scalar(const char *dir, const char *time, const char *name, int ncells, double **out) {
    char path[2 * TIME_PATH];
    int components;
    snprintf(path, sizeof path, "%s/%s/%s", dir, time, name);
    TRY(field_read_values(path, ncells, &components, out));
    return components == 1 ? OK : fail(ERR_INPUT, "%s: a scalar field is expected", path);
}

static status read_columns(const char *dir, const char *time, int axis, int *n, struct column **out) {
    char path[2 * TIME_PATH];
    struct polymesh *m = NULL;
    double *room = NULL, *rho = NULL, *T = NULL;
    snprintf(path, sizeof path, "%s/constant/polyMesh", dir);
    TRY(polymesh_read(path, &m));
    status e = allocate(&room, 6L * m->nfaces + 4L * m->ncells, sizeof(double), "geometry");
    if (!e) e = allocate(out, m->ncells, sizeof **out, "columns");
    if (!e) e = read_scalar(dir, time, "rho", m->ncells, &rho);
    if (!e) e = read_scalar(dir, time, "T", m->ncells, &T);
    if (!e) {
        double *area = room + 3L * m->nfaces, *centre = area + 3L * m->nfaces, *volume = centre + 3L * m->ncells;
        polymesh_face_geometry(m, room, area);
        polymesh_cell_geometry(m, room, area, centre, volume);
        for (int i = 0; i < m->ncells; i++)
            (*out)[i] = (struct column){centre[3L * i + axis], volume[i] * rho[i] * T[i], volume[i]};
        *n = m->ncells;
    }
    polymesh_free(m);
    free(room);
    free(rho);
    free(T);
    return e;
}

static int merge(int n, struct column *c) {
    qsort(c, (size_t)n, sizeof *c, by_place);
    const double close = 1e-6 * (c[n - 1].at - c[0].at);
    int last = 0;
    for (int i = 1; i < n; i++)
        if (c[i].at - c[last].at > close) {
            c[++last] = c[i];
        } else {
            c[last].stress += c[i].stress;
            c[last].weight += c[i].weight;
        }
    for (int i = 0; i <= last; i++) c[i].stress /= c[i].weight;
    return last + 1;
}

/* Slopes between the columns, linear between the middles of these, constant beyond the first and the last. */
static double slope_at(int n, const struct column *c, double y) {
    int k = 0;
    while (k < n - 2 && y > 0.5 * (c[k + 1].at + c[k + 2].at)) k++;
    const double here = (c[k + 1].stress - c[k].stress) / (c[k + 1].at - c[k].at), at = 0.5 * (c[k].at + c[k + 1].at);
    if (y <= at || k == n - 2) return here;
    const double next = (c[k + 2].stress - c[k + 1].stress) / (c[k + 2].at - c[k + 1].at);
    return here + (next - here) * (y - at) / (0.5 * (c[k + 1].at + c[k + 2].at) - at);
}

status stress_velocity(const struct setup *s, const struct segregation_models *m, int axis, int n, const double *node,
                       double *out) {
    char dir[TIME_PATH], time[TIME_NAME];
    struct column *c = NULL;
    int columns = 0;
    if (*m->case_dir == '/')
        snprintf(dir, sizeof dir, "%.4000s", m->case_dir);
    else
        snprintf(dir, sizeof dir, "%.2000s/%.2000s", s->dir, m->case_dir);
    TRY(find_time(m, dir, time));
    status e = read_columns(dir, time, axis, &columns, &c);
    if (!e) columns = merge(columns, c);
    if (!e && columns < 3)
        e = fail(ERR_INPUT, "%s: percolation: case %s has %d cells along %c; 3 are needed for a slope",
                 dict_path(m->properties), dir, columns, "xyz"[axis]);
    for (int i = 0; !e && i < n; i++) out[i] = m->q / m->rho * slope_at(columns, c, node[i]);
    free(c);
    return e;
}
