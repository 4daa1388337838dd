/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One Runge-Kutta stage on polyhedra: mirrors, polynomials, fluxes through the points of faces in their frames, update,
 * admissibility. The fluxes are those of the tiles: the two states of a point are the two cells of a first-order
 * stencil. */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells_points_private.h"

/* The averages of the cells on one side of the n faces of p, in their frames. */
static void side_averages(const struct gas *g, int side, const double *const *U, struct points *p) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const int *of_face = side ? f->right : f->left;
    double at[MAX_VAR][BATCH];
    int cell[BATCH];
    points_cells(p->n, p->face, of_face, cell);
    for (int v = 0; v < g->nvar; v++) points_gather(p->n, cell, U[v], at[v]);
    points_into_frames(g, p, at);
    for (int v = 0; v < g->nvar; v++) memcpy(p->state[v][side ? RIGHT : LEFT], at[v], (size_t)p->n * sizeof(double));
}

/* Are all states admissible by more than round-off? (NaN: no) */
KERNEL static bool all_sound(int n, int dim, double least, double most, const double (*restrict at)[BATCH]) {
    double kinetic[BATCH];
    int sound = 1;
    for (int i = 0; i < n; i++) kinetic[i] = 0;
    for (int k = 1; k <= dim; k++)
        for (int i = 0; i < n; i++) kinetic[i] += 0.5 * (at[k][i] * at[k][i]);
    for (int i = 0; i < n; i++) {
        const double internal = at[dim + 1][i] * at[0][i] - kinetic[i];
        sound &= (at[0][i] > least) & (at[0][i] < most) & (internal > ROUND * kinetic[i]);
    }
    return sound;
}

/* Changes states by what the polynomials do not know, and moves them towards the averages of their cells. */
static void correct_states(const struct gas *g, int side, int from, const double *const *U, const struct points *p,
                           double (*at)[BATCH]) {
    const struct cells *c = g->cells;
    const int *of_face = side ? c->polyhedra->face.right : c->polyhedra->face.left;
    double average[MAX_VAR][BATCH], theta[BATCH];
    int cell[BATCH], point[BATCH];
    for (int i = 0; i < p->n; i++) point[i] = from + i;
    points_cells(p->n, p->face, of_face, cell);
    for (int v = 0; v < g->nvar; v++) points_gather(p->n, cell, U[v], average[v]);
    if (g->models.material.threshold > 0) points_flatten(g, p, U[0], (const double(*)[BATCH])average, at);
    if (c->rest) cells_rest_add(g, point, p->n, cell, at);
    limit_towards(p->n, g->components, g->limits.least, g->limits.most, (const double(*)[BATCH])average, at, theta);
    if (c->rest) cells_rest_note(g, side, from, p->n, p->face, at);
}

/* Fits keep states in the admissible set (fit_keep): only round-off can move them out. */
static void keep_states(const struct gas *g, int side, int from, const double *const *U, const struct points *p,
                        double (*at)[BATCH]) {
    if (g->models.material.threshold > 0 || g->cells->rest ||
        !all_sound(p->n, g->components, g->limits.least, g->limits.most, (const double(*)[BATCH])at))
        correct_states(g, side, from, U, p, at);
}

/* The states of the polynomials on one side of points from <= i < from + n. */
static void side_states(const struct gas *g, int side, int from, const double *const *U, struct points *p) {
    double at[MAX_VAR][BATCH], *out[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) out[v] = at[v];
    fit_points(g->cells->fit, side, from, p->n, U, out);
    keep_states(g, side, from, U, p, at);
    points_into_frames(g, p, at);
    for (int v = 0; v < g->nvar; v++) memcpy(p->state[v][side ? RIGHT : LEFT], at[v], (size_t)p->n * sizeof(double));
}

/* The states beyond the faces of a patch. */
static void states_beyond(const struct gas *g, const double *const *U, struct points *p) {
    double inner[MAX_VAR][BATCH];
    int cell[BATCH];
    const bool reflects = points_reflect(g, p);
    points_cells(p->n, p->face, g->cells->polyhedra->face.left, cell);
    for (int v = 0; v < g->nvar; v++)
        if (reflects)
            memcpy(inner[v], p->state[v][LEFT], (size_t)p->n * sizeof(double));
        else
            points_gather(p->n, cell, U[v], inner[v]);
    if (!reflects) points_into_frames(g, p, inner);
    points_beyond(g, inner, p);
}

/* dt/dx of each point's face: dt A (1/V_l + 1/V_r)/2, on a lattice dt over the width. */
static void set_paces(const struct gas *g, struct points *p) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct polyhedra_faces *f = &m->face;
    for (int i = 0; i < (p->n + 7) / 8 * 8; i++) {
        const int face = p->face[i < p->n ? i : p->n - 1];
        p->pace[i] =
            0.5 * (g->step.dt * f->area[face]) * (1 / m->volume[f->left[face]] + 1 / m->volume[f->right[face]]);
    }
}

/* Gives the batch the rules of its faces. */
static void set_rules(const struct gas *g, int from, struct points *p, struct faces *faces) {
    for (int side = 0; side < 2; side++) cells_rules_pressures(g, side, from, p->n, p->face, p->p[side ? RIGHT : LEFT]);
    for (int i = p->n; i < faces->n; i++) {
        p->rule[i] = NO_RULE;
        p->p[LEFT][i] = p->p[RIGHT][i] = p->p[LEFT][p->n - 1];
    }
    faces->rule = p->rule;
    faces->p = p->p[LEFT];
}

/* flux <- the area times the sum over the points of each face; sum_single: each face has one point, of weight 1;
 * sum_alike: each has as many. */
KERNEL static void sum_single(int n, const double *restrict area, const double *restrict out, double *restrict flux) {
    for (int i = 0; i < n; i++) flux[i] = area[i] * (0 + out[i]);
}
ALWAYS_INLINE void sum_each(int each, int n, const double *restrict area, const double *restrict weight,
                            const double *restrict out, double *restrict flux) {
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int k = 0; k < each; k++) sum += weight[i * each + k] * out[i * each + k];
        flux[i] = area[i] * sum;
    }
}
KERNEL static void sum_alike(int each, int n, const double *area, const double *weight, const double *out,
                             double *flux) {
    if (each == 2) sum_each(2, n, area, weight, out, flux);
    if (each == 3) sum_each(3, n, area, weight, out, flux);
}
static void sum_points(const struct polyhedra *m, int first, int last, const double *weight, const double *out,
                       double *flux) {
    const int *start = m->face.point_start;
    for (int face = first; face < last; face++) {
        double sum = 0;
        for (int i = start[face]; i < start[face + 1]; i++) sum += weight[i] * out[i - start[first]];
        flux[face] = m->face.area[face] * sum;
    }
}

/* The number of points of each of the faces first <= i < last, if it is 2 or 3 and the same; else 0. */
static int points_of_each(const struct polyhedra_faces *f, int first, int last) {
    const int each = f->point_start[first + 1] - f->point_start[first];
    for (int i = first; i < last; i++)
        if (f->point_start[i + 1] - f->point_start[i] != each) return 0;
    return each == 2 || each == 3 ? each : 0;
}

/* Notes what the sides of the cells of round bodies push with. */
static void note_push(const struct gas *g, int first, int last, const struct points *p) {
    const int swirl = g->models.swirl;
    double push[2][BATCH];
    const double *of_side[2] = {p->p[LEFT], p->p[RIGHT]};
    for (int side = 0; side < 2 && swirl; side++) {
        const int at = side ? RIGHT : LEFT;
        for (int i = 0; i < p->n; i++)
            push[side][i] = p->p[at][i] + p->state[swirl + 1][at][i] * p->velocity[swirl][at][i];
        of_side[side] = push[side];
    }
    cells_round_note(g, first, last, of_side[0], of_side[1]);
}

/* Sums up the fluxes of the points, which begin with `from`, over faces first <= i < last. */
static void sum_fluxes(const struct gas *g, int first, int last, int from, const struct points *p) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    const int each = m->point.n == m->face.n ? 1 : points_of_each(&m->face, first, last);
    for (int v = 0; v < g->nvar; v++) {
        const bool swirls = g->models.swirl && v == g->models.swirl + 1;
        const double *weight = swirls && each != 1 ? cells_round_weights(g) : m->point.weight;
        if (each == 1)
            sum_single(p->n, m->face.area + first, p->out[v], c->flux[v] + first);
        else if (each)
            sum_alike(each, last - first, m->face.area + first, weight + from, p->out[v], c->flux[v] + first);
        else
            sum_points(m, first, last, weight, p->out[v], c->flux[v]);
    }
}

/* Is a flux found for each face, and not for each of its points? On two points of a line that gains too little for the
 * noise that it adds behind shocks. */
static bool whole_faces(const struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    return g->models.flux->means && m->dim > 2 && m->point.n > m->face.n && !g->cells->rest && !g->cells->round;
}

/* The means over the points of faces first <= i < last, on both sides. */
static void find_means(const struct gas *g, int first, int last, const double *const *U, const struct points *p,
                       struct point_means mean[2]) {
    const int *start = g->cells->polyhedra->face.point_start;
    struct point_states s;
    double *out[MAX_VAR];
    int most = 0;
    for (int v = 0; v < g->nvar; v++) out[v] = s.at[v];
    for (int i = first; i < last; i++) most = start[i + 1] - start[i] > most ? start[i + 1] - start[i] : most;
    for (int k = 0; k < most; k++) {
        points_list(g->cells->polyhedra, first, last, k, &s);
        for (int side = 0; side < 2; side++) {
            fit_faces(g->cells->fit, side, p->n, s.point, U, out);
            keep_states(g, side, 0, U, p, s.at);
            points_add(g, p, k == 0, &s, &mean[side]);
        }
    }
}

/* Fluxes through internal faces first <= i < last, at most BATCH: the waves are those of the mean states of the points,
 * which the means of their fluxes pass. */
static void mean_fluxes(const struct gas *g, int first, int last, const double *const *U, struct points *p) {
    struct cells *c = g->cells;
    struct point_means mean[2];
    p->n = (last - first + 7) / 8 * 8; /* whole vectors, filled up with the last face */
    for (int i = 0; i < p->n; i++) p->face[i] = first + i < last ? first + i : last - 1;
    points_frames(c->polyhedra, p);
    find_means(g, first, last, U, p, mean);
    struct faces faces = points_of_means(g, mean, p);
    if (cells_fronts_floor(g, p->n, p->face, p->floor)) points_floors(p, &faces);
    g->models.flux->through(&faces, g->models.eos, &g->models.material, g->limits.first_order);
    points_out_of_frames(g, p, p->out);
    for (int v = 0; v < g->nvar; v++)
        sum_single(last - first, c->polyhedra->face.area + first, p->out[v], c->flux[v] + first);
}

/* Fluxes through faces first <= i < last, whose points fit a batch; all of one patch, or all internal. */
static void batch_fluxes(const struct gas *g, int first, int last, const double *const *U, struct points *p) {
    struct cells *c = g->cells;
    const struct polyhedra_faces *f = &c->polyhedra->face;
    const bool single = c->polyhedra->point.n == f->n; /* Has each face one point? It then has the face's number. */
    const int from = single ? first : f->point_start[first];
    p->n = single ? last - first : f->point_start[last] - from;
    for (int i = 0; i < p->n; i++) p->face[i] = single ? from + i : c->polyhedra->point.face[from + i];
    points_frames(c->polyhedra, p);
    p->ruled = c->rules && first < f->ninternal && cells_rules_find(g, p->n, p->face, U, p->rule);
    side_states(g, 0, from, U, p);
    if (first < f->ninternal)
        side_states(g, 1, from, U, p);
    else
        states_beyond(g, U, p);
    if (g->models.flux->paced) set_paces(g, p);
    struct faces faces = points_primitives(g, p);
    if (c->round) note_push(g, first, last, p);
    if (p->ruled) set_rules(g, from, p, &faces);
    if (cells_fronts_floor(g, p->n, p->face, p->floor)) points_floors(p, &faces);
    g->models.flux->through(&faces, g->models.eos, &g->models.material, g->limits.first_order);
    points_out_of_frames(g, p, p->out);
    sum_fluxes(g, first, last, from, p);
}

/* Finds the fluxes through those of the faces first <= i < last that follow rules, point by point. */
static void ruled_fluxes(const struct gas *g, int first, int last, const double *const *U, struct points *p) {
    unsigned char rule[BATCH];
    int face[BATCH];
    for (int i = first; i < last; i++) face[i - first] = i;
    if (!g->cells->rules || !cells_rules_find(g, last - first, face, U, rule)) return;
    for (int i = first; i < last; i++)
        if (rule[i - first] != NO_RULE) batch_fluxes(g, i, i + 1, U, p);
}

/* Limits the fluxes through the n faces of p, all of one patch or all internal: each as a whole, between averages. */
static void limit_batch(struct gas *g, const double *const *U, struct points *p) {
    struct cells *c = g->cells;
    const struct polyhedra_faces *f = &c->polyhedra->face;
    double theta[BATCH];
    points_frames(c->polyhedra, p);
    side_averages(g, 0, U, p);
    if (p->face[0] < f->ninternal)
        side_averages(g, 1, U, p);
    else
        states_beyond(g, U, p);
    struct faces faces = points_primitives(g, p);
    faces.n = p->n;
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < p->n; i++) p->out[v][i] = c->flux[v][p->face[i]] / f->area[p->face[i]];
    points_into_frames(g, p, p->out);
    limit_faces(&faces, g->limits.least, g->limits.most, theta);
    points_out_of_frames(g, p, p->out);
    for (int i = 0; i < p->n; i++) {
        const int face = p->face[i];
        if (theta[i] == 1) continue;
        g->limits.faces += f->left[face] < c->polyhedra->nown;
        for (int v = 0; v < g->nvar; v++) c->flux[v][face] = f->area[face] * p->out[v][i];
    }
}

/* Gives the fluxes through faces first <= i < last of a patch the mass that it gives. */
static void feed(struct gas *g, int first, int last, const double *const *U) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    double flux[MAX_VAR][BATCH];
    int face[BATCH];
    for (int i = 0; i < last - first; i++) face[i] = first + i;
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < last - first; i++) flux[v][i] = g->cells->flux[v][first + i] / f->area[first + i];
    points_feed(g, last - first, face, U[0], flux);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < last - first; i++) g->cells->flux[v][first + i] = flux[v][i] * f->area[first + i];
}

/* Limits the fluxes through faces first <= i < last, all of one patch or all internal, of flagged cells. */
static void limit_run(struct gas *g, int first, int last, const double *const *U, struct points *p) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const double *flag = g->limits.flags.cells[0];
    p->n = 0;
    for (int face = first; face < last; face++)
        if (flag[f->left[face]] + flag[f->right[face]] > 0) p->face[p->n++] = face;
    if (p->n) limit_batch(g, U, p);
}

struct idle {                   /* cells that want no flux between them; both NULL: all do */
    const double *part;         /* as a bed keeps them as they are */
    const unsigned char *still; /* as nothing is found for them */
};
static bool is_idle(const struct idle *idle, int l, int r) {
    if (idle->part) return idle->part[l] >= BED_FROZEN && idle->part[r] >= BED_FROZEN;
    return idle->still && idle->still[l] && idle->still[r];
}

/* Returns the end of the batch of inner faces that begins with `first`: before a run of IDLE faces between idle cells.
 * *from: its first face, behind those. */
static int wanted_end(const struct gas *g, int first, int last, int *from) {
    enum { IDLE = 16 }; /* fewer cost less than a shorter batch */
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct idle idle = {cells_kept(g), fit_still(g->cells->fit)};
    const bool some = idle.part || idle.still, whole = g->cells->polyhedra->point.n == f->n || whole_faces(g);
    int end, n = 0;
    while (some && first < last && is_idle(&idle, f->left[first], f->right[first])) first++;
    *from = first;
    if (whole && !some) return first + BATCH < last ? first + BATCH : last;
    for (end = first; end < last; end++) {
        if ((whole ? end + 1 - first : f->point_start[end + 1] - f->point_start[first]) > BATCH) break;
        n = some && is_idle(&idle, f->left[end], f->right[end]) ? n + 1 : 0;
        if (n == IDLE) return end + 1 - IDLE;
    }
    return end;
}

/* Faces first <= i < last, in batches; those of flagged cells limited. */
static void face_fluxes(struct gas *g, int first, int last, const double *const *U) {
    const struct cells *c = g->cells;
    const struct polyhedra_faces *f = &c->polyhedra->face;
    struct points p;
    for (int end; first < last; first = end) {
        const int patch = first < f->ninternal ? -1 : f->patch[first - f->ninternal];
        if (patch < 0)
            end = wanted_end(g, first, last, &first);
        else
            for (end = first + 1; end < last && f->point_start[end + 1] - f->point_start[first] <= BATCH; end++)
                if (f->patch[end - f->ninternal] != patch) break;
        if (first == end) continue;
        if (patch < 0 && whole_faces(g)) {
            mean_fluxes(g, first, end, U, &p);
            ruled_fluxes(g, first, end, U, &p);
        } else {
            batch_fluxes(g, first, end, U, &p);
        }
        if (g->limits.flags.blocks[0]) limit_run(g, first, end, U, &p);
        if (g->patches.fed && patch >= 0 && patch_feeds(&g->patches.rules[patch])) feed(g, first, end, U);
    }
}

/* The sides that a cell lacks beside others of its chunk count 0, which changes no bit, as no sum is ever -0. */
ALWAYS_INLINE void sum_rows(int rows, int n, const int (*restrict side)[BATCH], const int (*restrict number)[BATCH],
                            const double *restrict flux, const double *restrict inverse, double *restrict out) {
    for (int i = 0; i < n; i++) {
        double sum = 0;
        UNROLL
        for (int j = 0; j < rows; j++) {
            const double q = flux[number[j][i]];
            sum += side[j][i] < 0 ? q : -q;
        }
        out[i] = sum * inverse[i];
    }
}
KERNEL static void sum_sides(int rows, int n, const int (*restrict side)[BATCH], const int (*restrict number)[BATCH],
                             const double *restrict flux, const double *restrict inverse, double *restrict out) {
    double sum[BATCH];
    if (rows == 3) sum_rows(3, n, side, number, flux, inverse, out);
    if (rows == 4) sum_rows(4, n, side, number, flux, inverse, out);
    if (rows == 3 || rows == 4) return;
    for (int i = 0; i < BATCH; i++) sum[i] = 0;
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < BATCH; i++) {
            const double q = flux[number[j][i]];
            sum[i] += side[j][i] < 0 ? q : -q;
        }
    for (int i = 0; i < n; i++) out[i] = sum[i] * inverse[i];
}
void cells_residuals(const struct cells *c, int from, int n, const double *flux, double *residual) {
    const int *start = c->sides.start + from / BATCH;
    sum_sides(start[1] - start[0], n, (const int(*)[BATCH])c->sides.face + start[0],
              (const int(*)[BATCH])c->sides.number + start[0], flux, c->inverse_volume + from, residual);
}

struct stage { /* of cells_stage and cells_redo */
    struct gas *g;
    const struct state *U0, *from, *to;
    const double *const *U; /* lines of from */
    double a, dt;
    long count; /* inadmissible cells */
};

/* Does a bed keep n cells as they are, whatever flows through their faces? */
static bool all_kept(const struct gas *g, int at, int n) {
    const double *part = cells_kept(g);
    int i = 0;
    while (part && i < n && part[at + i] >= BED_FROZEN) i++;
    return part && i == n;
}

static void update_chunk(struct stage *t, int at) {
    struct gas *g = t->g;
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    const int n = m->nown - at < BATCH ? m->nown - at : BATCH;
    double residuals[MAX_VAR][BATCH];
    const double *falls = g->falling.cells && g->falling.blocks[0] ? g->falling.cells[0] + at : NULL,
                 *flag = g->limits.flags.blocks[0] ? g->limits.flags.cells[0] + at : NULL,
                 *part = g->step.hybrid ? g->dense->part[0] + at : NULL;
    const struct advance s = {.U0 = t->U0->block[0] + at,
                              .from = t->from->block[0] + at,
                              .residual = residuals[0],
                              .each = BATCH,
                              .to = t->to->block[0] + at,
                              .a = t->a,
                              .dt = t->dt};
    const bool out = cells_left_out(g, at), none = out || all_kept(g, at, n);
    const double *in[MAX_VAR];
    double *residual[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) {
        residual[v] = residuals[v];
        in[v] = s.from + v * m->size;
        if (none)
            memset(residual[v], 0, sizeof residuals[v]);
        else
            cells_residuals(c, at, n, c->flux[v], residual[v]);
    }
    if (!none) cells_still(g, at, n, t->dt, s.from, residuals);
    g->counts.computed += out ? 0 : n;
    if (c->round) cells_round_push(g, at, n, s.from, flag, residual);
    if (g->falling.cells) weigh_row(g, n, in, falls, flag, residual);
    if (c->rest) cells_rest_weigh(g, at, n, falls, flag, residual);
    update_rows(g, n, &s);
    if (g->falling.cells && flag) drop_row(g, n, &s, falls, flag, part, g->falling.dropped + at);
    if (part) freeze_row(g, n, &s, part);
    t->count += row_limited(g, n, s.from, s.to, g->limits.flags.cells[0] + at);
}

/* Updates the chunks that turns from <= k < to of the sweep make ready. */
static void update_chunks(struct stage *t, int from, int to) {
    const struct cells_sweep *s = &t->g->cells->sweep;
    for (int i = s->start[from]; i < s->start[to]; i++) update_chunk(t, BATCH * s->chunk[i]);
}

/* Does what needs no other rank: fits the inner cells, and finds the fluxes through the local faces; updates cells if
 * no face is limited, as an update raises the flags that ask for that. */
static void sweep(struct stage *t) {
    const struct cells *c = t->g->cells;
    const struct cells_sweep *s = &c->sweep;
    for (int k = 0; k < s->n; k++) {
        fit_cells(c->fit, k ? s->cells[k - 1] : 0, s->cells[k], t->U);
        face_fluxes(t->g, k ? s->faces[k - 1] : 0, s->faces[k], t->U);
        if (!t->g->limits.flags.blocks[0]) update_chunks(t, k, k + 1);
    }
}

/* Does what is left of a stage, once the ghosts and the mirrors beyond them are known. */
static long finish_sweep(struct stage *t) {
    struct gas *g = t->g;
    const struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    fit_cells(c->fit, m->ninner, m->nnear, t->U);
    face_fluxes(g, m->face.nlocal, m->face.ninternal, t->U);
    face_fluxes(g, m->face.ninternal, m->face.n, t->U);
    update_chunks(t, g->limits.flags.blocks[0] ? 0 : c->sweep.n, c->sweep.n + 1);
    if (g->carried) cells_carry(g);
    if (g->books.tally) cells_tally_stage(g);
    g->counts.all += m->nown;
    return t->count;
}

long cells_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt, struct ending *ending) {
    (void)ending; /* the parts of the step do it */
    struct cells *c = g->cells;
    struct polyhedra *m = c->polyhedra;
    const int own_mirrors = m->face.n - m->face.ninternal;
    double *line[MAX_VAR];
    cells_lines(g, from, line);
    const double *const *U = (const double *const *)line;
    struct stage t = {g, U0, from, to, U, a, dt, 0};
    polyhedra_fill_start(m, g->nvar, line);
    cells_mirrors(g, 0, own_mirrors, line);
    cells_weigh(g, true, line);
    if (c->rest) cells_rest_find(g, 0, m->nown, U, NULL);
    if (c->rules) {
        cells_rules_note(g, 0, m->nown, U);
        cells_rules_note(g, m->ncells, m->ncells + own_mirrors, U);
        cells_rules_look(g, 0, m->ninner);
    }
    cells_still_look(g, U, false);
    cells_spare(g);
    sweep(&t);
    polyhedra_fill_finish(m);
    cells_mirrors(g, own_mirrors, m->mirror.n, line);
    cells_weigh(g, false, line);
    if (c->rest) cells_rest_find(g, m->nown, m->nnear, U, NULL);
    if (c->rules) {
        cells_rules_note(g, m->nown, m->ncells, U);
        cells_rules_note(g, m->ncells, m->size, U);
        cells_rules_look(g, m->ninner, m->nnear);
    }
    cells_still_look(g, U, true);
    return finish_sweep(&t);
}

void cells_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt) {
    double *line[MAX_VAR];
    cells_lines(g, from, line);
    struct stage t = {g, U0, from, to, (const double *const *)line, a, dt, 0};
    g->limits.faces = 0;
    drop_begin(g);
    cells_still_look(g, t.U, false);
    cells_still_look(g, t.U, true);
    cells_spare(g);
    sweep(&t);
    (void)finish_sweep(&t);
}
