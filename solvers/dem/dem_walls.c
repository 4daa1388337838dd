/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups faces of patches by plane, cuts planes into connected pieces and makes rectangles of them, or takes the
 * triangles of each patch as they are (dem_walls.h). */
#include "solvers/dem/dem_walls.h"

#include "libcore/models/boundary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PLANES = 200 };
struct wall_plane {
    int patch;
    double normal[3], offset, restitution, friction, velocity[3];
};
struct work { /* lists of the faces of walls */
    int n, planes;
    int *face, *of; /* [n] face of the mesh, its plane */
    struct wall_plane plane[MOST_PLANES];
    int *parent; /* [points] of the connected pieces of a plane */
    bool *seen;  /* [points] is it the root of a piece that was added? */
    double size; /* m: the longest side of the mesh */
};

/* Returns the physical axis of a computational one; behind the solved ones stands the one that is left. */
static int axis_of(const struct setup *s, int k) {
    return k < s->dim ? s->axis[k] : 3 - s->axis[0] - s->axis[1];
}

static void point(const struct setup *s, int i, double x[3]) {
    for (int k = 0; k < 3; k++) x[k] = s->mesh->points[3L * i + axis_of(s, k)];
}
static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void measure(const struct setup *s, struct dem_walls *w) {
    for (int k = 0; k < 3; k++) {
        w->low[k] = HUGE_VAL;
        w->high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < s->mesh->npoints; i++) {
        double x[3];
        point(s, i, x);
        for (int k = 0; k < 3; k++) {
            w->low[k] = fmin(w->low[k], x[k]);
            w->high[k] = fmax(w->high[k], x[k]);
        }
    }
}

/* The wall's own number, or that of two grains; a wall on which U slips is smooth. */
static struct wall_plane plane_of(const struct grains_models *m, const struct boundary_type *type, int patch) {
    const double rest = boundary_is_smooth(type) ? 0 : m->contact.friction;
    return (struct wall_plane){.patch = patch,
                               .restitution =
                                   m->restitution[patch] < 0 ? m->contact.restitution : m->restitution[patch],
                               .friction = m->friction[patch] < 0 ? rest : m->friction[patch]};
}

/* Takes the velocity of a wall that moves along itself. */
static status take_velocity(const struct setup *s, const struct field *U, struct wall_plane *p) {
    const struct patch_field *q = &U->patch[p->patch];
    int moving = 0;
    if (q->varying && !strcmp(varying_key(q->varying), "omega"))
        return fail(ERR_INPUT,
                    "%s:%d: patch %s: walls of granularDEM do not rotate: give  noSlip;  (a wall at rest) or run "
                    "granularGas",
                    dict_path(U->dict), q->line, s->mesh->patch[p->patch].name);
    if (strcmp(q->type, "translatingWallVelocity") != 0) return OK;
    for (int k = 0; k < 3; k++) {
        p->velocity[k] = q->params.room[axis_of(s, k)];
        moving += p->velocity[k] != 0;
    }
    if (!q->varying && moving <= 1) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: walls of granularDEM move along one axis at a constant velocity: U (1 0 0);",
                dict_path(U->dict), q->line, s->mesh->patch[p->patch].name);
}

static status find_plane(const struct setup *s, struct work *k, const struct wall_plane *made, int *out) {
    const double near = 1e-7 * k->size;
    for (*out = 0; *out < k->planes; ++*out) {
        const struct wall_plane *p = &k->plane[*out];
        if (dot(p->normal, made->normal) > 1 - 1e-9 && fabs(p->offset - made->offset) < near &&
            p->restitution == made->restitution && p->friction == made->friction &&
            !memcmp(p->velocity, made->velocity, sizeof p->velocity))
            return OK;
    }
    if (k->planes == MOST_PLANES)
        return fail(ERR_INPUT,
                    "%s: patch %s is curved, or of too many planes; granularDEM has flat rectangular walls: let the "
                    "patch be a wall of few planes",
                    s->mesh_path, s->mesh->patch[made->patch].name);
    k->plane[k->planes++] = *made;
    return OK;
}

static status add_patch(const struct setup *s, struct wall_plane of, struct work *k) {
    const struct patch *patch = &s->mesh->patch[of.patch];
    for (int i = 0; i < patch->nfaces; i++) {
        double centre[3], area[3];
        const int face = patch->start + i;
        polymesh_one_face(s->mesh, face, centre, area);
        const double size = sqrt(dot(area, area));
        of.offset = dot(centre, area) / size;
        for (int a = 0; a < 3; a++) of.normal[a] = area[axis_of(s, a)] / size;
        TRY(find_plane(s, k, &of, &k->of[k->n]));
        k->face[k->n++] = face;
    }
    return OK;
}

/* Notes a cyclic patch, whose normal must lie along an axis. */
static status add_cyclic(const struct setup *s, int p, struct dem_walls *w) {
    double centre[3], area[3];
    polymesh_one_face(s->mesh, s->mesh->patch[p].start, centre, area);
    const double size = sqrt(dot(area, area));
    for (int k = 0; k < w->dim; k++)
        if (fabs(area[s->axis[k]]) > (1 - 1e-9) * size) {
            w->periodic[k] = true;
            return OK;
        }
    return fail(ERR_INPUT, "%s: patch %s is cyclic and lies across no axis; granularDEM repeats space along axes alone",
                s->mesh_path, s->mesh->patch[p].name);
}

/* ---- triangles ---- */

static struct contact_law law_of(const struct grains_models *m, const struct wall_plane *p) {
    return contact_wall(&m->contact, m->grain.diameter, m->grain.mass, p->restitution, p->friction);
}

static status add_surface(const struct setup *s, const struct grains_models *m, const struct wall_plane *of,
                          struct dem_walls *w) {
    const char *name = s->mesh->patch[of->patch].name;
    if (dot(of->velocity, of->velocity) > 0)
        return fail(
            ERR_INPUT,
            "%s: patch %s: it moves, and walls of the mesh are no rectangles; granularDEM moves whole sides of a box "
            "alone: let it be at rest",
            s->mesh_path, name);
    if (w->n == DEM_MOST_WALLS)
        return fail(ERR_INPUT, "%s: there are more than %d patches of walls; join some", s->mesh_path, DEM_MOST_WALLS);
    w->wall[w->n++] = (struct dem_wall){.patch = of->patch, .axis = -1, .law = law_of(m, of)};
    return OK;
}

/* Grains that leave go on to the border of the box around the mesh, where LAMMPS takes them away. */
static status check_outlet(const struct setup *s, int p, const struct dem_walls *w) {
    const struct patch *patch = &s->mesh->patch[p];
    for (int f = patch->start; f < patch->start + patch->nfaces; f++) {
        double centre[3], area[3];
        bool side = false;
        polymesh_one_face(s->mesh, f, centre, area);
        for (int k = 0; k < w->dim; k++) {
            const double size = sqrt(dot(area, area)), at = centre[s->axis[k]];
            side |= fabs(area[s->axis[k]]) > (1 - 1e-9) * size &&
                    fmin(fabs(at - w->low[k]), fabs(at - w->high[k])) < 1e-7 * (w->high[k] - w->low[k]);
        }
        if (!side)
            return fail(ERR_INPUT,
                        "%s: patch %s: grains leave there, and it lies on no side of the box around the mesh; let it "
                        "lie on one",
                        s->mesh_path, patch->name);
    }
    return OK;
}

static status check_surface(const struct setup *s, const struct dem_walls *w) {
    for (int k = 0; k < w->dim; k++)
        if (w->periodic[k])
            return fail(ERR_INPUT,
                        "%s: walls are no rectangles, and patches are cyclic: LAMMPS does not document its surfaces in "
                        "periodic space; use a mesh whose walls are flat rectangles",
                        s->mesh_path);
    return OK;
}

static status add_patches(const struct setup *s, const struct grains_models *m, const struct field *U,
                          struct dem_walls *w, struct work *k) {
    for (int p = 0; p < s->mesh->npatches; p++) {
        const struct patch *patch = &s->mesh->patch[p];
        const struct patch_field *q = &U->patch[p];
        const struct boundary_type *type = boundary_find(q->type);
        if (!patch->nfaces || !strcmp(patch->type, "empty")) continue;
        if (!strcmp(patch->type, "cyclic"))
            TRY(add_cyclic(s, p, w));
        else if (boundary_is_wall(type)) {
            struct wall_plane plane = plane_of(m, type, p);
            TRY(take_velocity(s, U, &plane));
            TRY(w->facets ? add_surface(s, m, &plane, w) : add_patch(s, plane, k));
        } else if (!strcmp(q->type, "zeroGradient")) {
            w->open = true;
            if (!s->lattice) TRY(check_outlet(s, p, w));
        } else
            return fail(ERR_INPUT,
                        "%s:%d: patch %s: type is %s; granularDEM has walls (noSlip, slip, symmetry), cyclic patches "
                        "and zeroGradient, which lets grains out: use one of them",
                        dict_path(U->dict), q->line, patch->name, q->type);
    }
    return OK;
}

/* ---- pieces ---- */

static int root(int *parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins the points of each face of a plane: the pieces are what is not joined. */
static void join(const struct polymesh *mesh, const struct work *k, int plane) {
    for (int i = 0; i < mesh->npoints; i++) {
        k->parent[i] = i;
        k->seen[i] = false;
    }
    for (int i = 0; i < k->n; i++) {
        if (k->of[i] != plane) continue;
        const int *first = mesh->face_points + mesh->face_start[k->face[i]];
        const int n = mesh->face_start[k->face[i] + 1] - mesh->face_start[k->face[i]];
        for (int j = 1; j < n; j++) k->parent[root(k->parent, first[j])] = root(k->parent, first[0]);
    }
}

/* The points of a piece that lie farthest one way: where edges are parallel to e and f, two directions off both tell
 * the four corners. */
struct extent {
    double low[2], high[2], area;
};
static void span(const struct setup *s, const struct work *k, int plane, int piece, const double e[2][3],
                 struct extent *x) {
    *x = (struct extent){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, 0};
    for (int i = 0; i < k->n; i++) {
        const struct polymesh *mesh = s->mesh;
        const int start = mesh->face_start[k->face[i]], end = mesh->face_start[k->face[i] + 1];
        if (k->of[i] != plane || root(k->parent, mesh->face_points[start]) != piece) continue;
        double centre[3], area[3];
        polymesh_one_face(mesh, k->face[i], centre, area);
        x->area += sqrt(dot(area, area));
        for (int j = start; j < end; j++) {
            double at[3];
            point(s, mesh->face_points[j], at);
            for (int a = 0; a < 2; a++) {
                x->low[a] = fmin(x->low[a], dot(at, e[a]));
                x->high[a] = fmax(x->high[a], dot(at, e[a]));
            }
        }
    }
}

/* Sets unit vectors along the rectangle: one axis that lies in the plane, and the direction across it. */
static bool along(const double normal[3], double e[2][3]) {
    int axis = -1;
    for (int k = 0; k < 3; k++)
        if (fabs(normal[k]) < 1e-9 && (axis < 0 || k > axis)) axis = k;
    if (axis < 0) return false;
    for (int k = 0; k < 3; k++) e[1][k] = k == axis;
    for (int k = 0; k < 3; k++)
        e[0][k] = e[1][(k + 1) % 3] * normal[(k + 2) % 3] - e[1][(k + 2) % 3] * normal[(k + 1) % 3];
    return true;
}

/* Is the rectangle a whole side of the box? */
static void find_side(const struct dem_walls *w, double size, struct dem_wall *wall) {
    wall->axis = -1;
    for (int k = 0; k < 3; k++) {
        if (fabs(wall->normal[k]) < 1 - 1e-9) continue;
        wall->side = wall->normal[k] > 0;
        const double at = wall->side ? w->high[k] : w->low[k];
        bool whole = fabs(wall->corner[k] - at) < 1e-7 * size;
        for (int a = 0; a < 3; a++) {
            const double length = fabs(wall->edge[0][a]) + fabs(wall->edge[1][a]);
            if (a != k) whole &= fabs(length - (w->high[a] - w->low[a])) < 1e-7 * size;
        }
        if (whole) wall->axis = k;
    }
}

static status add_piece(const struct setup *s, const struct grains_models *m, const struct work *k, int plane,
                        int piece, struct dem_walls *w) {
    const struct wall_plane *p = &k->plane[plane];
    const char *name = s->mesh->patch[p->patch].name;
    double e[2][3];
    struct extent x;
    if (!along(p->normal, e))
        return fail(ERR_INPUT,
                    "%s: patch %s: a wall leans along all three axes; granularDEM has walls that an axis lies in",
                    s->mesh_path, name);
    span(s, k, plane, piece, (const double(*)[3])e, &x);
    if (fabs(x.area - (x.high[0] - x.low[0]) * (x.high[1] - x.low[1])) > 1e-7 * x.area)
        return fail(ERR_INPUT,
                    "%s: patch %s: a flat wall is no rectangle; granularDEM has rectangular walls: let the patch have "
                    "other shapes as several rectangles that do not lie in one plane",
                    s->mesh_path, name);
    if (w->n == DEM_MOST_WALLS)
        return fail(ERR_INPUT,
                    "%s: there are more than %d flat walls; each costs as much as a grain's neighbour: let the walls "
                    "have fewer planes",
                    s->mesh_path, DEM_MOST_WALLS);
    struct dem_wall *out = &w->wall[w->n++];
    *out = (struct dem_wall){.patch = p->patch};
    for (int a = 0; a < 3; a++) {
        out->normal[a] = p->normal[a];
        out->corner[a] = p->offset * p->normal[a] + x.low[0] * e[0][a] + x.low[1] * e[1][a];
        for (int j = 0; j < 2; j++) out->edge[j][a] = (x.high[j] - x.low[j]) * e[j][a];
    }
    out->law = law_of(m, p);
    find_side(w, k->size, out);
    memcpy(out->velocity, p->velocity, sizeof out->velocity);
    if (out->axis >= 0 || dot(p->velocity, p->velocity) == 0) return OK;
    return fail(ERR_INPUT,
                "%s: patch %s: it moves and is no whole side of the box; granularDEM moves whole sides alone",
                s->mesh_path, name);
}

static status add_pieces(const struct setup *s, const struct grains_models *m, const struct work *k, int plane,
                         struct dem_walls *w) {
    join(s->mesh, k, plane);
    for (int i = 0; i < k->n; i++) {
        if (k->of[i] != plane) continue;
        const int piece = root(k->parent, s->mesh->face_points[s->mesh->face_start[k->face[i]]]);
        if (!k->seen[piece]) TRY(add_piece(s, m, k, plane, piece, w));
        k->seen[piece] = true;
    }
    return OK;
}

/* Fails where two rectangles of one plane touch: their laws differ, or they were one piece. */
static status check_joints(const struct setup *s, const struct grains_models *m, const struct dem_walls *w,
                           double size) {
    for (int i = 0; i < w->n; i++)
        for (int j = 0; j < i; j++) {
            const struct dem_wall *a = &w->wall[i], *b = &w->wall[j];
            double at[3], near[3], middle[3], away = 0;
            if (fabs(dot(a->normal, b->normal)) < 1 - 1e-9) continue;
            for (int k = 0; k < 3; k++) middle[k] = b->corner[k] + 0.5 * (b->edge[0][k] + b->edge[1][k]);
            dem_wall_nearest(w, i, middle, at);
            dem_wall_nearest(w, j, at, near);
            for (int k = 0; k < 3; k++) away = fmax(away, fabs(near[k] - at[k]));
            if (away > 1e-7 * size) continue;
            return fail(ERR_INPUT,
                        "%s: walls: patches %s and %s meet in one plane and differ in restitution, friction or "
                        "velocity, so that "
                        "grains would feel their joint twice: let them be alike",
                        m->properties ? dict_path(m->properties) : s->dir, s->mesh->patch[b->patch].name,
                        s->mesh->patch[a->patch].name);
        }
    return OK;
}

static status make(const struct setup *s, const struct grains_models *m, const struct field *U, struct dem_walls *w,
                   struct work *k) {
    int faces = 0;
    for (int p = 0; p < s->mesh->npatches; p++) faces += s->mesh->patch[p].nfaces;
    TRY(allocate(&k->face, faces, sizeof(int), "walls"));
    TRY(allocate(&k->of, faces, sizeof(int), "walls"));
    TRY(allocate(&k->parent, s->mesh->npoints, sizeof(int), "walls"));
    TRY(allocate(&k->seen, s->mesh->npoints, sizeof(bool), "walls"));
    for (int a = 0; a < 3; a++) k->size = fmax(k->size, w->high[a] - w->low[a]);
    TRY(add_patches(s, m, U, w, k));
    if (w->facets) return check_surface(s, w);
    for (int i = 0; i < k->planes; i++) TRY(add_pieces(s, m, k, i, w));
    return check_joints(s, m, w, k->size);
}

status dem_walls_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                      const struct facets *facets, struct dem_walls *out) {
    struct work k = {.n = 0};
    *out = (struct dem_walls){.dim = s->dim, .facets = facets};
    TRY(setup_complete(s));
    measure(s, out);
    const status e = make(s, m, U, out, &k);
    free(k.face);
    free(k.of);
    free(k.parent);
    free(k.seen);
    return e;
}

bool dem_wall_goes_on(const struct dem_walls *w, const struct dem_wall *wall, int j, int end) {
    const double *e = wall->edge[j];
    int axis = 0; /* the axis that the edge leads along most */
    for (int k = 1; k < 3; k++)
        if (fabs(e[k]) > fabs(e[axis])) axis = k;
    if (axis >= w->dim) return true;
    if (!w->periodic[axis] || hypot(e[(axis + 1) % 3], e[(axis + 2) % 3]) > 1e-9 * fabs(e[axis])) return false;
    const double border = (e[axis] > 0) == (end == 1) ? w->high[axis] : w->low[axis];
    return fabs(wall->corner[axis] + end * e[axis] - border) < 1e-7 * (w->high[axis] - w->low[axis]);
}

/* Is the box around a facet farther from x than `away`? */
static bool is_beyond(const struct facet *f, int dim, const double x[3], double away) {
    for (int k = 0; k < dim; k++)
        if (x[k] < f->low[k] - away || x[k] > f->high[k] + away) return true;
    return false;
}

static void nearest_facet(const struct dem_walls *w, int wall, const double x[3], double out[3]) {
    double least = HUGE_VAL, normal[3];
    for (int i = 0; i < w->facets->n; i++) {
        const struct facet *f = &w->facets->facet[i];
        if (f->wall != w->wall[wall].patch || is_beyond(f, w->dim, x, least)) continue;
        const double away = facet_distance(f, w->dim, x, normal);
        if (away >= least) continue;
        least = away;
        for (int k = 0; k < 3; k++) out[k] = x[k] - away * normal[k];
    }
}

int dem_wall_at(const struct dem_walls *w, const double x[3]) {
    double least = HUGE_VAL;
    int wall = 0;
    for (int j = 0; j < w->n; j++) {
        double at[3], square = 0;
        dem_wall_nearest(w, j, x, at);
        for (int k = 0; k < w->dim; k++) square += (x[k] - at[k]) * (x[k] - at[k]);
        if (square >= least) continue;
        least = square;
        wall = j;
    }
    return wall;
}

void dem_wall_nearest(const struct dem_walls *w, int wall, const double x[3], double out[3]) {
    const struct dem_wall *a = &w->wall[wall];
    double from[3];
    if (w->facets) {
        nearest_facet(w, wall, x, out);
        return;
    }
    for (int k = 0; k < 3; k++) {
        from[k] = x[k] - a->corner[k];
        out[k] = a->corner[k];
    }
    for (int j = 0; j < 2; j++) {
        const double *e = a->edge[j];
        double part = dot(from, e) / dot(e, e);
        if (part < 0 && !dem_wall_goes_on(w, a, j, 0)) part = 0;
        if (part > 1 && !dem_wall_goes_on(w, a, j, 1)) part = 1;
        for (int k = 0; k < 3; k++) out[k] += e[k] * part;
    }
}
