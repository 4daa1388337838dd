/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit acoustics of dense cells (libcore/gas/dense.c; docs/physics.md 9.2): which cells a bed has, their rates, and
 * what goes from the states of the gas to the bed, and back. Engines list the cells as rows, and the faces around them
 * as borders. */
#include "libcore/gas/gas_private.h"

/* ---- the cells ---- */

struct rated { /* cells that lie one behind the other, their states and rates as in struct bed_rates */
    struct row row;
    const double *rho, *part;
    struct row_speeds s;
};

/* Returns the largest rate at which impacts cool the dense cells of a row, by the cooling law over dt. */
static double rate_of_cooling(const struct gas *g, double dt, const struct rated *r) {
    const struct gas_models *m = &g->models;
    double cooled[BATCH], room[BATCH], most = 0;
    if (!source_cools(&m->source, &m->material)) return 0;
    memcpy(cooled, r->s.eps, (size_t)r->row.n * sizeof(double));
    const struct closure_line cells = {.eos = m->eos,
                                       .material = &m->material,
                                       .n = r->row.n,
                                       .rho = r->rho,
                                       .shear_rate =
                                           shear_rate_at(g, m->source.cooling->needs, r->row.block, r->row.at),
                                       .by_impacts = impacts_row(g, r->row.n, r->rho, room)};
    m->source.cooling->step(&m->source.cooling_params, &cells, dt, cooled);
    for (int i = 0; i < r->row.n; i++)
        if (r->part[i] >= BED_DENSE) most = larger(most, (r->s.eps[i] - cooled[i]) / (cooled[i] * dt));
    return most;
}

static void raise_rates(const struct gas *g, double dt, const struct rated *r, struct bed_rates *most) {
    const struct material *m = &g->models.material;
    const double grain = m->diameter / sqrt(packing_per_density(m)); /* sigma sqrt(rho of a grain) */
    bool dense = false;
    for (int i = 0; i < r->row.n; i++) {
        const double part = r->part[i];
        const bool near_void = r->rho[i] < g->dense->thin;
        most->flow = larger(most->flow, part > 0 ? r->s.flow[i] : 0);
        most->thin = larger(most->thin, part < BED_FROZEN ? r->s.thin[i] : 0);
        most->solid = larger(most->solid, part < BED_FROZEN && !near_void ? r->s.thin[i] : 0);
        dense |= part >= BED_DENSE && (near_void || g->dense->cooling == 0);
        if (part >= BED_DENSE && !near_void)
            most->inertia = larger(most->inertia, r->s.flow[i] * grain / sqrt(r->s.p[i]));
    }
    if (dense) most->cooling = larger(most->cooling, rate_of_cooling(g, dt, r));
}

struct rating {
    struct gas *g;
    double dt;
    struct bed_rates most;
    struct first_place *sought;
};

static void find_speeds(struct gas *g, const struct row *row, struct rated *out) {
    out->row = *row;
    out->rho = g->U.block[row->block] + row->at;
    out->part = g->dense->part[row->block] + row->at;
    g->engine->state.speeds(g, &g->U, row, &out->s);
}

static void rate_row(void *rating, const struct row *row) {
    struct rating *r = rating;
    struct rated rated;
    find_speeds(r->g, row, &rated);
    raise_rates(r->g, r->dt, &rated, &r->most);
}

/* Offers the places of those cells of a row that have the rate which refused an implicit step. */
static void seek_row(void *rating, const struct row *row) {
    struct rating *r = rating;
    const struct dense *d = r->g->dense;
    struct rated one;
    for (int i = 0; i < row->n; i++) {
        struct bed_rates most = {0};
        double here[3];
        find_speeds(r->g, &(struct row){row->block, row->at + i, 1}, &one);
        raise_rates(r->g, r->dt, &one, &most);
        const double rate[BED_CAUSES] = {most.thin, most.flow, most.cooling};
        if (rate[d->bound.cause] != d->bound.rate) continue;
        r->g->engine->state.place(r->g, row->block, one.row.at, here);
        first_place_offer(r->sought, here);
    }
}

KERNEL static double bed_largest(int n, const double *restrict rho) {
    double most = 0;
    for (int i = 0; i < n; i++) most = larger(most, rho[i]);
    return most;
}

/* Marks the cells of a row that friction acts on although they are not dense, as they are cold and lie on the bottom of
 * their cells (lying_share of bed.h). */
static void find_lying(const struct gas *g, const struct row *row) {
    const double *U = g->U.block[row->block] + row->at, *volume = g->blocks.volume;
    const struct polyhedra_round *round = volume ? &g->blocks.grid->polyhedra->round : NULL;
    double *part = g->dense->part[row->block] + row->at, square = 0, h = 0;
    for (int k = 0; k < g->dim; k++) {
        const double pulls = g->models.source.gravity[k] * g->models.source.gravity[k];
        square += pulls;
        if (g->forest) h += pulls * g->forest->width[k] * g->forest->width[k];
    }
    for (int i = 0; i < row->n; i++) {
        const double rho = U[i];
        double eps = U[energy_at(g) * g->size + i] / rho;
        for (int k = g->components; k >= 1; k--) eps -= 0.5 * (U[k * g->size + i] / rho) * (U[k * g->size + i] / rho);
        const double flat = volume ? volume[row->at + i] / (round->radial >= 0 ? round->radius[row->at + i] : 1) : 1;
        const double fall = volume ? sqrt(square) * pow(flat, 1. / g->dim) : sqrt(h);
        const double T = (g->models.material.disks ? 1 : 2. / 3) * eps;
        if (part[i] > 0 || !(lying_share(T, fall, rho / g->limits.most) > 0)) continue;
        part[i] = BED_DENSE;
        g->dense->holds[row->block] = true;
    }
}

/* Marks the dense cells of a row. A background that is dense becomes cells, which the rows behind it hold. */
static void find_row(void *gas, const struct row *row) {
    struct gas *g = gas;
    struct dense *d = g->dense;
    const double *rho = g->U.block[row->block] + row->at;
    double *part = d->part[row->block] + row->at;
    const double most = bed_largest(row->n, rho);
    if (g->U.varied && row->at == 0) {
        if (most > (d->bed.rub ? FILLS_LOW * g->limits.most : d->above)) g->engine->state.unfold(g, row->block, &g->U);
        return;
    }
    if (d->bed.rub && most > FILLS_LOW * g->limits.most) find_lying(g, row);
    if (!(most > d->above)) return;
    for (int i = 0; i < row->n; i++) part[i] = rho[i] > d->hard ? BED_HARD : rho[i] > d->above ? BED_DENSE : part[i];
    d->holds[row->block] = true;
}

bool dense_find(struct gas *g) {
    struct dense *d = g->dense;
    double found = 0;
    for (int b = 0; b < d->blocks; b++) {
        if (d->holds[b]) memset(d->part[b], 0, (size_t)g->size * sizeof(double));
        d->holds[b] = false;
    }
    g->engine->state.rows(g, KEPT_STATES, &g->U, find_row, g);
    for (int b = 0; b < d->blocks; b++) found += d->holds[b];
    comm_max(g->comm, &found, 1);
    return found > 0;
}

KERNEL static double bed_smallest(int n, const double *restrict rho) {
    double least = HUGE_VAL;
    for (int i = 0; i < n; i++) least = smaller(least, rho[i]);
    return least;
}

/* Near vacuum in the rings joins the bed from this part of the rate on: the stages fill such a cell from packed gas and
 * let that mass flow on; the bed would have to give it, and does not fill the cell, so that the step fails. */
static const double IN_RINGS = 0.2;

struct inclusion { /* near vacuum of a rate of thin gas above `rate` */
    struct gas *g;
    double rate, found;
};

static void include_row(void *inclusion, const struct row *row) {
    struct inclusion *c = inclusion;
    struct dense *d = c->g->dense;
    double *part = d->part[row->block] + row->at;
    struct rated r;
    if (!(bed_smallest(row->n, c->g->U.block[row->block] + row->at) < d->thin)) return;
    find_speeds(c->g, row, &r);
    for (int i = 0; i < row->n; i++) {
        const double rate = part[i] > 0 ? IN_RINGS * c->rate : c->rate;
        if (part[i] >= BED_FROZEN || !(r.rho[i] < d->thin) || !(r.s.thin[i] > rate)) continue;
        part[i] = BED_DENSE;
        d->holds[row->block] = true;
        c->found++;
    }
}

bool dense_include(struct gas *g, double rate) {
    struct inclusion c = {g, rate, 0};
    g->engine->state.rows(g, VARIED_CELLS, &g->U, include_row, &c);
    comm_max(g->comm, &c.found, 1);
    return c.found > 0;
}

struct ringing { /* marks the ring around the parts above `least` */
    struct gas *g;
    double least, level;
    int block; /* that was looked at last */
    bool near; /* has it, or its ghosts, such a part? */
};

KERNEL static void bed_around(int n, const struct sides *restrict s, const double *restrict part,
                              double *restrict most) {
    const int first = s->across[0];
    if (s->line)
        for (int i = 0; i < n; i++) most[i] = larger(most[i], part[first + i]);
    else
        for (int i = 0; i < n; i++) most[i] = larger(most[i], part[s->across[i]]);
}

/* Gives `level` to those of n <= BATCH cells without a part beside which there is more than `least`; returns whether
 * any has a part. */
KERNEL static bool bed_ring(int n, double least, double level, const double *restrict most, double *restrict part) {
    uint64_t found = 0; /* the bits of parts, which are not negative: a loop over them is one of vectors */
    for (int i = 0; i < n; i++) {
        part[i] = select_double((part[i] == 0) & (most[i] > least), level, part[i]);
        found |= bits_of(part[i]);
    }
    return found != 0;
}

static void ring_row(void *ringing, const struct row *row) {
    struct ringing *r = ringing;
    double *part = r->g->dense->part[row->block], most[BATCH] = {0};
    struct sides s;
    if (row->block != r->block) r->near = bed_largest((int)r->g->size, part) > r->least;
    r->block = row->block;
    if (!r->near) return;
    if (bed_smallest(row->n, part + row->at) > 0) { /* no cell is left to mark */
        r->g->dense->holds[row->block] = true;
        return;
    }
    for (int k = 0; r->g->engine->state.sides(r->g, row, k, &s); k++) bed_around(row->n, &s, part, most);
    if (bed_ring(row->n, r->least, r->level, most, part + row->at)) r->g->dense->holds[row->block] = true;
}

/* Marks the frozen, live and outer cells around the dense ones (enum bed_part). Ghosts beyond patches have no part. No
 * cell is left out as uniform in a step with a bed. */
static void mark_rings(struct gas *g) {
    for (int level = BED_FROZEN; level >= BED_OUTER; level--) {
        struct ringing r = {g, level == BED_FROZEN ? BED_DENSE : level, level, -1, false};
        g->engine->state.fill(g, 1, 1, g->dense->part);
        g->engine->state.rows(g, EVERY_CELL, NULL, ring_row, &r);
    }
    g->engine->state.fill(g, 1, 1, g->dense->part);
    spans_unfold(g, &g->U, NULL);
}

struct bed_rates dense_rates(struct gas *g, double plain) {
    struct dense *d = g->dense;
    struct rating r = {.g = g, .dt = plain};
    if (sources_ask(g)) g->engine->state.shear_rate(g, &g->U);
    for (int b = 0; b < d->blocks; b++)
        for (long i = 0; i < g->size && d->holds[b]; i++)
            d->part[b][i] = select_double(d->part[b][i] < BED_DENSE, 0, d->part[b][i]);
    mark_rings(g);
    g->engine->state.rows(g, VARIED_CELLS, &g->U, rate_row, &r);
    d->cooling = larger(d->cooling, r.most.cooling);
    double most[] = {r.most.thin, r.most.solid, r.most.flow, d->cooling, r.most.inertia};
    comm_max(g->comm, most, 5);
    d->inertia = most[4];
    return (struct bed_rates){
        .thin = most[0], .solid = most[1], .flow = most[2], .cooling = most[3], .inertia = most[4]};
}

void dense_seek(struct gas *g, double place[3]) {
    struct first_place first = {.order = HUGE_VAL};
    struct rating r = {g, g->dense->bound.dt, .sought = &first};
    g->dense->cooling = 0; /* all dense cells are to find their rates of cooling again */
    if (sources_ask(g)) g->engine->state.shear_rate(g, &g->U);
    g->engine->state.rows(g, VARIED_CELLS, &g->U, seek_row, &r);
    first_place_agree(g, &first, place);
}

/* ---- to and from the bed ---- */

/* Are the cells of the bed others than those that have numbers? */
KERNEL static bool bed_differs(long n, const double *restrict part, const int *restrict number) {
    int differs = 0;
    for (long i = 0; i < n; i++) differs |= (part[i] > 0) != (number[i] > 0);
    return differs;
}

/* Is the bed that of the last list, on all ranks? */
static bool is_listed(const struct gas *g) {
    double changed = 0;
    for (int b = 0; b < g->dense->blocks && changed == 0; b++)
        changed = bed_differs(g->size, g->dense->part[b], g->dense->number[b]);
    comm_max(g->comm, &changed, 1);
    return changed == 0;
}

struct listing { /* of the bed, in two passes */
    struct gas *g;
    bool numbers;           /* the second pass: the rows of cells and their numbers; else blocks, and the counts */
    int cells, rows, sides; /* counts so far */
};

/* Counts n cells of the bed that lie one behind the other, or lists them. */
static void list_run(struct listing *l, int block, long at, int n) {
    struct gas *g = l->g;
    struct dense *d = g->dense;
    const struct row run = {block, at, n};
    struct sides s;
    const int first = l->cells;
    l->cells += n;
    if (l->numbers) {
        d->row[l->rows++] = run;
        for (int i = 0; i < n; i++) d->number[block][at + i] = d->bed.home->low + first + i + 1;
        return;
    }
    l->rows++;
    for (int k = 0; g->engine->state.sides(g, &run, k, &s); k++)
        for (int i = 0; i < n; i++) l->sides += s.face[i] != NO_SIDE;
}

static void list_block(void *listing, int number, int place, const struct row *row) {
    struct listing *l = listing;
    struct dense *d = l->g->dense;
    struct bed_set *bed = d->bed.home;
    const double *part = d->part[row->block] + row->at;
    if (!l->numbers && (bed->blocks == 0 || bed->number[bed->blocks - 1] != number)) {
        d->place[bed->blocks] = place;
        bed->number[bed->blocks++] = number;
    }
    for (int i = 0, end; i < row->n; i = end + 1) {
        for (end = i; end < row->n && part[end] > 0; end++) continue;
        if (end > i) list_run(l, row->block, row->at + i, end - i);
    }
    if (!l->numbers) bed->first[bed->blocks] = l->cells;
}

/* Makes memory for rows, sides and fluxes of a new list, and forgets the numbers of cells. What needs other ranks comes
 * first: a rank with more of the bed has more to list, and less to do in the stages. */
static status begin_list(struct gas *g) {
    struct dense *d = g->dense;
    struct listing l = {.g = g};
    d->bed.home->blocks = d->bed.home->first[0] = 0;
    g->engine->bed.blocks(g, list_block, &l);
    status s = ARRAYS_GROW(&d->arrays, d->row, l.rows);
    if (!s) s = ARRAYS_GROW(&d->arrays, d->border, l.sides);
    for (int b = 0; b < d->blocks && !s; b++)
        if (d->holds[b] && !d->flux[b])
            s = pool_take(&d->pool, &d->flux[b], g->nvar * g->blocks.faces + SLACK, sizeof(double), "the bed");
    TRY(comm_agree(g->comm, s));
    TRY(bed_list(&d->bed, l.sides));
    for (int b = 0; b < d->blocks; b++) memset(d->number[b], 0, (size_t)g->size * sizeof **d->number);
    double outside = d->bed.home->cells < d->own;
    comm_max(g->comm, &outside, 1);
    d->alone = outside == 0;
    d->borders = d->bed.home->faces = 0;
    d->relisted = true;
    return OK;
}

/* The shapes of cells and faces (struct bed_shapes): on polyhedra each has its own, on a lattice they follow from the
 * place along the radius and the axis. */
static int shape_of_cell(const struct gas *g, int block, long at) {
    if (!g->forest) return (int)at;
    return g->forest->radial < 0 ? 0 : forest_place_along(g->forest, block, at, g->forest->radial);
}
static int shape_of_face(const struct gas *g, int block, int face) {
    const struct forest *f = g->forest;
    if (!f) return face;
    const int axis = (int)(face / f->size);
    return f->radial < 0 ? axis : axis + f->dim * forest_place_along(f, block, face % f->size, f->radial);
}

/* Sets what the lists say of single cells. */
static void list_cells(struct gas *g) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    struct sides s;
    bed->face_start[0] = 0;
    for (int r = 0, cell = 0; r < d->rows; cell += d->row[r++].n) {
        const struct row *row = &d->row[r];
        for (int i = 0; i < row->n; i++) {
            bed->body[cell + i] = shape_of_cell(g, row->block, row->at + i);
            bed->face_start[cell + i + 1] = 0;
        }
        for (int k = 0; g->engine->state.sides(g, row, k, &s); k++)
            for (int i = 0; i < row->n; i++) bed->face_start[cell + i + 1] += s.face[i] != NO_SIDE;
        for (int i = 0; i < row->n; i++) bed->face_start[cell + i + 1] += bed->face_start[cell + i];
    }
}

/* Notes a face of the bed, that of lane i of a row, as a border if a side of it is none of the bed; sets its kind. */
static void note_border(struct gas *g, const struct row *row, const struct sides *s, int i, int f) {
    struct dense *d = g->dense;
    struct bed_set *bed = d->bed.home;
    const struct patch_face patch = s->edge[i] < 0 ? (struct patch_face){-1, 0} : s->patch[i];
    bed->kind[f] = BED_INNER;
    if (bed->left[f] >= 0 && bed->right[f] >= 0) return;
    bed->kind[f] = patch.patch < 0 ? BED_KEPT : patch_is_wall(&g->patches.rules[patch.patch]) ? BED_WALL : BED_OPEN;
    d->border[d->borders++] = (struct dense_border){.face = f,
                                                    .block = row->block,
                                                    .inside = row->at + i,
                                                    .beyond = s->across[i],
                                                    .through = s->face[i] < 0 ? ~s->face[i] : s->face[i],
                                                    .edge = s->edge[i],
                                                    .patch = patch};
}

/* Lists the k-th face of a cell, lane i of a row, unless it has been listed as a face of the cell across: on a lattice
 * the cell below a face lists it, else the first of both. */
static void list_side(struct gas *g, const struct row *row, const struct sides *s, int i, int cell, int k) {
    struct bed_set *bed = g->dense->bed.home;
    const bool right = s->face[i] < 0, boxes = bed->shapes->boxes;
    const int other = g->dense->number[row->block][s->across[i]] - 1, shape = right ? ~s->face[i] : s->face[i];
    const bool own = other >= bed->low && other < bed->low + bed->cells;
    int *entry = bed->face_of_cell + bed->face_start[cell] + k;
    int *across = own ? bed->face_of_cell + bed->face_start[other - bed->low] : NULL;
    if (own && boxes && right) return;
    if (own && !boxes && other - bed->low <= cell) {
        const int *end = other - bed->low < cell ? bed->face_of_cell + bed->face_start[other - bed->low + 1] : entry;
        for (; across < end && bed->shape[*across < 0 ? ~*across : *across] != shape; across++) continue;
        if (across < end) *entry = ~*across;
        if (across < end) return;
    }
    const int f = bed->faces++;
    bed->left[f] = right ? other : bed->low + cell;
    bed->right[f] = right ? bed->low + cell : other;
    bed->shape[f] = shape_of_face(g, row->block, shape);
    *entry = right ? ~f : f;
    if (own && boxes) across[k - 1] = ~f;
    note_border(g, row, s, i, f);
}

/* On a lattice axis by axis, the face above a cell first, so that cells one behind the other have faces so; else cell
 * by cell. */
static void list_faces(struct gas *g) {
    struct dense *d = g->dense;
    const bool boxes = d->bed.home->shapes->boxes;
    const int each = boxes ? 2 : d->sides;
    for (int axis = 0; axis < (boxes ? g->dim : 1); axis++)
        for (int r = 0, cell = 0; r < d->rows; cell += d->row[r++].n) {
            int k[2] = {2 * axis + 1, 2 * axis}, n = 0;
            while (n < each && g->engine->state.sides(g, &d->row[r], boxes ? k[n] : n, &d->seen[n])) n++;
            for (int i = 0; i < d->row[r].n; i++)
                for (int j = 0; j < n; j++)
                    if (d->seen[j].face[i] != NO_SIDE)
                        list_side(g, &d->row[r], &d->seen[j], i, cell + i, boxes ? k[j] : j);
        }
}

/* Lists the bed. Collective. */
static status list_bed(struct gas *g) {
    struct dense *d = g->dense;
    struct listing l = {.g = g, .numbers = true};
    TRY(begin_list(g));
    g->engine->bed.blocks(g, list_block, &l);
    d->rows = l.rows;
    if (g->forest)
        forest_fill_int(g->forest, d->number);
    else
        polyhedra_fill_int(g->blocks.grid->polyhedra, d->number[0]);
    list_cells(g);
    list_faces(g);
    return OK;
}

/* Copies the bed's cells from a state, or to it. On polyhedra most rows are single cells. */
static void copy(const struct gas *g, const struct state *s, bool out) {
    const struct dense *d = g->dense;
    for (int v = 0; v < g->nvar; v++) {
        double *U = d->bed.home->U[v];
        for (int r = 0; r < d->rows; U += d->row[r++].n) {
            double *line = s->block[d->row[r].block] + v * g->size + d->row[r].at;
            for (int i = 0; i < d->row[r].n; i++) *(out ? line + i : U + i) = out ? U[i] : line[i];
        }
    }
}

void dense_take(struct gas *g, const struct state *from) {
    copy(g, from, false);
}

long dense_put(struct gas *g, const struct state *to) {
    const struct dense *d = g->dense;
    double *const *U = d->bed.home->U, mark[BATCH];
    long bad = 0;
    spans_unfold(g, to, d->holds);
    copy(g, to, true);
    for (int at = 0, cells = d->bed.home->cells; at < cells; at += BATCH) {
        const int n = cells - at < BATCH ? cells - at : BATCH;
        if (!find_bad(n, g->components, U[1] - U[0], g->limits.least, g->limits.most, U[0] + at, mark)) continue;
        for (int i = 0; i < n; i++) bad += mark[i] > 0;
    }
    return bad;
}

/* Copies what friction keeps of a cell, at its place in the lines of a block, to the bed's cell i, or back. */
static void copy_kept(const struct gas *g, double *kept, int i, bool out) {
    const struct bed_set *bed = g->dense->bed.home;
    const int tensors = bed_tensors(g->components), first = bed->face_start[i];
    *(out ? kept : &bed->pressure[i]) = *(out ? &bed->pressure[i] : kept);
    for (int j = first; j < bed->face_start[i + 1]; j++)
        for (int t = 0; t < tensors; t++) {
            const int f = bed->face_of_cell[j] < 0 ? ~bed->face_of_cell[j] : bed->face_of_cell[j];
            double *line = kept + (1 + (j - first) * tensors + t) * g->size;
            *(out ? line : &bed->stress[t][f]) = *(out ? &bed->stress[t][f] : line);
        }
}

static void copy_all_kept(const struct gas *g, bool out) {
    const struct dense *d = g->dense;
    for (int r = 0, i = 0; r < d->rows; r++)
        for (int n = 0; n < d->row[r].n; n++, i++) copy_kept(g, d->kept[d->row[r].block] + d->row[r].at + n, i, out);
}

void dense_take_friction(struct gas *g) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    if (!d->kept) return;
    copy_all_kept(g, false);
    for (int k = 0; k < g->components; k++) memset(bed->wall_speed[k], 0, (size_t)bed->faces * sizeof(double));
    memset(bed->wall_friction, 0, (size_t)bed->faces * sizeof(double));
    for (int i = 0; i < d->borders; i++) {
        const struct dense_border *b = &d->border[i];
        double speed[3];
        if (bed->kind[b->face] != BED_WALL) continue;
        const struct patch_rules *r = &g->patches.rules[b->patch.patch];
        bed->wall_friction[b->face] = wall_friction(r);
        wall_velocity(r, g->components, b->patch.face, speed);
        for (int k = 0; k < g->components; k++) bed->wall_speed[k][b->face] = speed[k];
    }
}

void dense_keep_friction(struct gas *g) {
    struct dense *d = g->dense;
    const long lines = 1 + d->sides * bed_tensors(g->components);
    if (!d->kept) return;
    for (int b = 0; b < d->blocks && d->relisted; b++)
        memset(d->kept[b], 0, (size_t)(lines * g->size) * sizeof(double));
    d->relisted = false;
    copy_all_kept(g, true);
}

/* Takes the gas beyond the borders. An open patch whose ghosts have the cell's own state lets it out freely. */
static void take_beyond(struct gas *g, const struct state *from) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    for (int i = 0; i < d->borders; i++) {
        const struct dense_border *b = &d->border[i];
        const double *U = from->block[b->block];
        bool same = true;
        if (bed->kind[b->face] == BED_WALL) continue;
        for (int v = 0; v < g->nvar; v++, U += g->size) {
            same &= bits_of(U[b->inside]) == bits_of(U[b->beyond]);
            bed->outside[v][b->face] = U[b->beyond];
            bed->kept[v][b->face] = 0;
        }
        bed->holds[b->face] = !same;
    }
}

status dense_listed(struct gas *g) {
    return is_listed(g) ? OK : list_bed(g);
}

status dense_begin(struct gas *g, const struct state *from) {
    g->engine->state.ghosts(g, from);
    TRY(dense_listed(g));
    dense_take(g, &g->U);
    bed_note_start(&g->dense->bed);
    dense_take(g, from);
    if (g->U.varied) { /* stages leave frozen cells of V and W as they are; on polyhedra they write them */
        copy(g, &g->V, true);
        copy(g, &g->W, true);
    }
    take_beyond(g, from);
    dense_take_friction(g);
    if (g->engine->bed.balance) g->engine->bed.balance(g, from);
    g->dense->begun = true;
    return OK;
}
