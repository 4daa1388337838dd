/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums shares of grains and impacts in cells for the three kernels, and turns the sums into fields; coarse.h has the
 * formulas and their sources.
 *
 * On a mesh sums are of cells, and a kernel then spreads them over the cells near each: cell j gives cell i the share
 *
 *   M_ij/V_j,  M_ij = e_i V_i phi(|x_i - x_j|) V_j e_j,  sum_j M_ij = V_i,
 *
 * with the centres x and phi = 1 within the width, or a normal distribution cut at 3 widths. M is symmetric, so the
 * shares of a cell add up to 1, which keeps mass, momentum and energy, and uniform grains give uniform fields in
 * unequal cells and beside walls of any shape. The factors e are found by the iteration e <- sqrt(e/sum V phi e)
 * (Knight, Ruiz & Ucar, SIAM J. Matrix Anal. Appl. 35 (2014) 931). */
#include "libcore/grains/coarse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sums of a cell, one behind the other: the shares of grains, the impulse * branch * psi of their impacts, and for each
 * axis the mean velocity and the sum of shares times squared deviation from it. In a mixture the same follows for each
 * kind; its impacts are not summed. The number of samples stands behind the sums of all cells. */
enum {
    SHARE,
    IMPACTS,
    MEAN,
    DEVIATION,
    PER_AXIS = 2,
    CONTACT = 0,
    CROSS = 6,
    SPIN = 9,
    ROUGH = 12,
    MOST_CELLS = 1 << 24,
    TERMS = 38
};

struct share {
    long cell;
    double w;
};
struct reach { /* the cells that a kernel covers along one axis */
    int n;
    long *offset;  /* part of the cell's index, mirrored or wrapped into the grid */
    double *value; /* Gaussian: share; Heaviside: squared distance of the centre */
    double *s;     /* Gaussian: place of the upper face in widths */
};
struct near { /* the share that a cell gets of another one */
    long cell;
    double share;
};
struct mesh_kernel { /* of a mesh: shares of cell i are near[start[i]] .. near[start[i + 1] - 1] */
    long *start;     /* [cells + 1] */
    struct near *near;
    double *sums; /* spread sums */
};
struct coarse {
    struct grain_observer observer; /* first */
    struct coarse_grid grid;
    long cells, stride[3]; /* stride: of the axes, in cells */
    int size, rough;       /* doubles per cell; the place of those of rough grains, or of the kinds of a mixture */
    double per[3];         /* 1/h */
    double *sums;
    double term[TERMS], half; /* coefficients of bell_integrals; the integral from 0 to 3 */
    struct reach reach[3];
    struct share *shares;      /* shares of the place last spread */
    struct mesh_kernel kernel; /* start NULL: none */
};

static void observe(struct grain_observer *self, const struct grain_impact *i);
static void bell_make(struct coarse *c);
static status make_mesh_kernel(struct coarse *c, enum coarse_kernel kernel);

static status check_width(const struct coarse_grid *g) {
    double longest = 0;
    for (int k = 0; k < g->dim; k++) longest = fmax(longest, g->n[k] * g->h[k]);
    if (g->width > 0 && g->width <= longest) return OK;
    return fail(ERR_INPUT, "the width of the kernel is %g m; it must be positive and at most the box (%g m)", g->width,
                longest);
}

static status too_wide(const struct coarse_grid *g) {
    return fail(ERR_INPUT, "a kernel of width %g m covers more than %d cells; make it narrower", g->width, MOST_CELLS);
}

static status make_reach(struct coarse *c) {
    const struct coarse_grid *g = &c->grid;
    const double cut = g->kernel == COARSE_GAUSSIAN ? 3 * g->width : g->width;
    double room = 1;
    TRY(check_width(g));
    for (int k = 0; k < 3; k++) {
        const double most = k < g->dim ? floor(2 * cut / g->h[k]) + 3 : 1;
        room *= most;
        if (room > MOST_CELLS) return too_wide(g);
        TRY(allocate(&c->reach[k].offset, (long)most, sizeof(long), "a kernel"));
        TRY(allocate(&c->reach[k].value, (long)most, sizeof(double), "a kernel"));
        TRY(allocate(&c->reach[k].s, (long)most, sizeof(double), "a kernel"));
        c->reach[k].n = 1; /* remains 1 for axes that are not solved */
        c->reach[k].value[0] = g->kernel == COARSE_GAUSSIAN;
    }
    return allocate(&c->shares, (long)room, sizeof *c->shares, "a kernel");
}

static status fill(struct coarse *c, const struct coarse_grid *grid) {
    c->observer.impact = observe;
    bell_make(c);
    c->grid = *grid;
    c->rough = MEAN + PER_AXIS * grid->dim;
    c->size = c->rough + (grid->rough ? ROUGH : grid->kinds ? grid->kinds->n * c->rough : 0);
    c->cells = 1;
    for (int k = 0; k < grid->dim; k++) {
        if (!(grid->n[k] > 0 && grid->h[k] > 0))
            return fail(ERR_INPUT, "a grid of %d cells of %g m along an axis", grid->n[k], grid->h[k]);
        c->stride[k] = c->cells;
        c->cells *= grid->n[k];
        c->per[k] = 1 / grid->h[k];
    }
    if (grid->mesh) {
        c->cells = grid->mesh->cells;
        c->grid.kernel = COARSE_CELL; /* of the sums */
        if (grid->rough && grid->kernel != COARSE_CELL)
            return fail(ERR_INPUT,
                        "on a mesh of other cells than equal boxes, fields of soft grains are means over cells: "
                        "kernel cell");
    }
    TRY(allocate(&c->sums, coarse_size(c), sizeof(double), "sums of the grains"));
    if (grid->mesh && grid->kernel != COARSE_CELL) TRY(make_mesh_kernel(c, grid->kernel));
    return c->grid.kernel == COARSE_CELL ? allocate(&c->shares, 1, sizeof *c->shares, "a kernel") : make_reach(c);
}

status coarse_make(const struct coarse_grid *grid, struct coarse **out) {
    TRY(allocate(out, 1, sizeof **out, "sums of the grains"));
    status s = fill(*out, grid);
    if (s) {
        coarse_free(*out);
        *out = NULL;
    }
    return s;
}

void coarse_free(struct coarse *c) {
    if (!c) return;
    for (int k = 0; k < 3; k++) {
        free(c->reach[k].offset);
        free(c->reach[k].value);
        free(c->reach[k].s);
    }
    free(c->shares);
    free(c->kernel.start);
    free(c->kernel.near);
    free(c->kernel.sums);
    free(c->sums);
    free(c);
}

struct grain_observer *coarse_observer(struct coarse *c) {
    return &c->observer;
}
long coarse_size(const struct coarse *c) {
    return c->cells * c->size + 1;
}
double *coarse_sums(struct coarse *c) {
    return c->sums;
}
void coarse_clear(struct coarse *c) {
    memset(c->sums, 0, (size_t)coarse_size(c) * sizeof(double));
}

/* Returns floor(v); the library's floor is a call where the instruction set has none. */
static inline int below(double v) {
    const int i = (int)v;
    return i - (v < i);
}

/* Returns the part of the index of the grid's cell of which cell i along axis k, perhaps beyond the grid, is an
 * image. */
static inline long fold(const struct coarse *c, int k, int i) {
    const int n = c->grid.n[k];
    while (i < 0 || i >= n)
        if (c->grid.periodic[k])
            i += i < 0 ? n : -n;
        else
            i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i * c->stride[k];
}

static inline long cell_of(const struct coarse *c, const double x[3]) {
    long cell = 0;
    bool inside;
    if (c->grid.mesh) return c->grid.mesh->locate(c->grid.mesh, x, &inside);
    for (int k = 0; k < c->grid.dim; k++) cell += fold(c, k, below((x[k] - c->grid.low[k]) * c->per[k]));
    return cell;
}

/* Computes out[i], the integral of exp(-t^2/2) from 0 to s[i], |s[i]| <= 3, by its series: unlike exp it gives the same
 * bits everywhere. */
static void bell_integrals(const struct coarse *c, int n, const double *restrict s, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = 0;
    for (int k = TERMS - 1; k >= 0; k--)
        for (int i = 0; i < n; i++) out[i] = out[i] * (s[i] * s[i]) + c->term[k];
    for (int i = 0; i < n; i++) out[i] *= s[i];
}

static void bell_make(struct coarse *c) {
    double power = 1;
    for (int k = 0; k < TERMS; k++) {
        c->term[k] = power / (2 * k + 1);
        power *= -0.5 / (k + 1);
    }
    bell_integrals(c, 1, &(const double){3}, &c->half);
}

static int gaussian(struct coarse *c, const double x[3]) {
    const struct coarse_grid *g = &c->grid;
    for (int k = 0; k < g->dim; k++) {
        struct reach *r = &c->reach[k];
        const double from = x[k] - g->low[k];
        const int first = below((from - 3 * g->width) * c->per[k]), last = below((from + 3 * g->width) * c->per[k]);
        double done = -c->half;
        r->n = last + 1 - first;
        for (int i = 0; i < r->n; i++) {
            const double s = ((first + i + 1) * g->h[k] - from) / g->width;
            r->s[i] = s > 3 || i == r->n - 1 ? 3 : s < -3 ? -3 : s;
            r->offset[i] = fold(c, k, first + i);
        }
        bell_integrals(c, r->n, r->s, r->value);
        for (int i = 0; i < r->n; i++) {
            const double to = r->value[i];
            r->value[i] = (to - done) / (2 * c->half);
            done = to;
        }
    }
    int n = 0;
    for (int l = 0; l < c->reach[2].n; l++)
        for (int j = 0; j < c->reach[1].n; j++)
            for (int i = 0; i < c->reach[0].n; i++)
                c->shares[n++] = (struct share){c->reach[0].offset[i] + c->reach[1].offset[j] + c->reach[2].offset[l],
                                                c->reach[0].value[i] * c->reach[1].value[j] * c->reach[2].value[l]};
    return n;
}

static int heaviside(struct coarse *c, const double x[3]) {
    const struct coarse_grid *g = &c->grid;
    for (int k = 0; k < g->dim; k++) {
        struct reach *r = &c->reach[k];
        const int first = below((x[k] - g->width - g->low[k]) * c->per[k]),
                  last = below((x[k] + g->width - g->low[k]) * c->per[k]);
        r->n = 0;
        for (int i = first; i <= last; i++) {
            const double away = g->low[k] + (i + 0.5) * g->h[k] - x[k];
            r->offset[r->n] = fold(c, k, i);
            r->value[r->n++] = away * away;
        }
    }
    int n = 0;
    for (int l = 0; l < c->reach[2].n; l++)
        for (int j = 0; j < c->reach[1].n; j++)
            for (int i = 0; i < c->reach[0].n; i++)
                if (c->reach[0].value[i] + c->reach[1].value[j] + c->reach[2].value[l] < g->width * g->width)
                    c->shares[n++].cell = c->reach[0].offset[i] + c->reach[1].offset[j] + c->reach[2].offset[l];
    if (!n) c->shares[n++].cell = cell_of(c, x);
    for (int i = 0; i < n; i++) c->shares[i].w = 1.0 / n;
    return n;
}

/* Fills c->shares for a place; a cell stands there more than once where images meet. Returns how many. */
static inline int spread(struct coarse *c, const double x[3]) {
    if (c->grid.kernel == COARSE_GAUSSIAN) return gaussian(c, x);
    if (c->grid.kernel == COARSE_HEAVISIDE) return heaviside(c, x);
    *c->shares = (struct share){cell_of(c, x), 1};
    return 1;
}

static inline void add(double *sum, int dim, double w, const double u[3]) {
    if (w == 0) return;
    const double part = w / (sum[SHARE] += w);
    for (int k = 0; k < dim; k++) {
        double *mean = sum + MEAN + PER_AXIS * k, *deviation = sum + DEVIATION + PER_AXIS * k;
        const double away = u[k] - *mean;
        *mean = part == 1 ? u[k] : *mean + part * away;
        *deviation += w * away * (u[k] - *mean);
    }
}

void coarse_sample(struct coarse *c, int n, const double (*x)[3], const double (*u)[3], const uint8_t *kinds) {
    const struct grain_kinds *all = c->grid.kinds;
    for (int i = 0; i < n; i++) {
        const int kind = all ? kinds[i] : 0;
        if (isnan(x[i][0])) continue; /* it has left */
        const int m = spread(c, x[i]);
        for (int j = 0; j < m; j++) {
            double *sum = c->sums + c->size * c->shares[j].cell;
            if (all) add(sum + (kind + 1) * c->rough, c->grid.dim, c->shares[j].w, u[i]);
            add(sum, c->grid.dim, all ? c->shares[j].w * all->mass[kind] : c->shares[j].w, u[i]);
        }
    }
    c->sums[c->cells * c->size] += 1;
}

static const int pair_of[3][2] = {{0, 1}, {0, 2}, {1, 2}}; /* axes of the components beside the diagonal */

/* Adds a grain with its spin; products of deviations are kept as the squares are. */
static void add_rough(const struct coarse *c, double *sum, double w, const double u[3], const double spin[3]) {
    double away[3] = {0}, *rough = sum + c->rough;
    if (w == 0) return;
    for (int k = 0; k < c->grid.dim; k++) away[k] = u[k] - sum[MEAN + PER_AXIS * k];
    add(sum, c->grid.dim, w, u);
    for (int p = 0; p < 3; p++) {
        const int a = pair_of[p][0], b = pair_of[p][1];
        if (b < c->grid.dim) rough[CROSS + p] += w * away[a] * (u[b] - sum[MEAN + PER_AXIS * b]);
        rough[SPIN + p] += w * spin[p];
    }
}

void coarse_rough(struct coarse *c, int n, const double (*x)[3], const double (*u)[3], const double (*spin)[3]) {
    for (int i = 0; i < n; i++) {
        const int m = spread(c, x[i]);
        for (int j = 0; j < m; j++) add_rough(c, c->sums + c->size * c->shares[j].cell, c->shares[j].w, u[i], spin[i]);
    }
    c->sums[c->cells * c->size] += 1;
}

void coarse_contacts(struct coarse *c, long n, const struct coarse_contact *contact) {
    for (long i = 0; i < n; i++) {
        const double *l = contact[i].branch, *f = contact[i].force;
        for (int point = 0; point < 3; point++) { /* Simpson's rule along the branch */
            double x[3];
            for (int k = 0; k < 3; k++) x[k] = contact[i].x[k] - 0.5 * point * l[k];
            const int m = spread(c, x);
            for (int j = 0; j < m; j++) {
                double *sum = c->sums + c->size * c->shares[j].cell, *rough = sum + c->rough;
                const double w = c->shares[j].w * (point == 1 ? 4 : 1) / 6;
                for (int k = 0; k < 3; k++) {
                    rough[CONTACT + k] += w * f[k] * l[k];
                    rough[CONTACT + 3 + k] +=
                        w * 0.5 * (f[pair_of[k][0]] * l[pair_of[k][1]] + f[pair_of[k][1]] * l[pair_of[k][0]]);
                    if (k < c->grid.dim) sum[IMPACTS] += w * f[k] * l[k];
                }
            }
        }
    }
}

/* Adds an impact with the kernel COARSE_CELL. Where both ends of the branch lie in one cell, so does the middle. */
static void observe_in_cells(struct coarse *c, const struct grain_impact *i, double branch) {
    long cell[3] = {0};
    for (int point = 0; point < 3 && c->grid.mesh; point++) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = i->x[0][k] + 0.5 * point * branch * i->normal[k];
        cell[point] = cell_of(c, x);
    }
    for (int k = 0; k < c->grid.dim && !c->grid.mesh; k++) {
        const double from = (i->x[0][k] - c->grid.low[k]) * c->per[k], by = branch * i->normal[k] * c->per[k];
        for (int point = 0; point < 3; point++) cell[point] += fold(c, k, below(from + 0.5 * point * by));
    }
    const double sixth = i->impulse * branch / 6;
    if (cell[0] == cell[2]) {
        c->sums[c->size * cell[0] + IMPACTS] += 6 * sixth;
        return;
    }
    c->sums[c->size * cell[0] + IMPACTS] += sixth;
    c->sums[c->size * cell[1] + IMPACTS] += 4 * sixth;
    c->sums[c->size * cell[2] + IMPACTS] += sixth;
}

static void observe(struct grain_observer *self, const struct grain_impact *i) {
    struct coarse *c = (struct coarse *)self;
    const double whole = c->grid.kinds ? i->branch : c->grid.diameter;
    const double branch = i->b < 0 && !c->grid.kinds ? 0.5 * whole : whole, amount = i->impulse * branch;
    if (c->grid.kernel == COARSE_CELL) {
        observe_in_cells(c, i, branch);
        return;
    }
    for (int point = 0; point < 3; point++) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = i->x[0][k] + 0.5 * point * branch * i->normal[k];
        const int m = spread(c, x);
        for (int j = 0; j < m; j++)
            c->sums[c->size * c->shares[j].cell + IMPACTS] += amount * (point == 1 ? 4 : 1) / 6 * c->shares[j].w;
    }
}

/* ---- kernels on a mesh ---- */

struct bins { /* cells of the mesh by their centres, in boxes as wide as a kernel reaches */
    int n[3];
    double low[3], per[3]; /* m, 1/m */
    long *start, *cell;    /* [boxes + 1], [cells] */
};

static long bin_of(const struct bins *b, const double x[3], int shift[3]) {
    long at = 0;
    for (int k = 2; k >= 0; k--) {
        const int i = below((x[k] - b->low[k]) * b->per[k]);
        shift[k] = i < 0 ? 0 : i >= b->n[k] ? b->n[k] - 1 : i;
        at = at * b->n[k] + shift[k];
    }
    return at;
}

/* Sorts the cells into boxes; the caller frees the lists, also after an error. */
static status make_bins(const struct coarse *c, double reach, struct bins *b) {
    const struct coarse_grid *g = &c->grid;
    long boxes = 1;
    int at[3];
    for (int k = 0; k < 3; k++) {
        const double length = k < g->dim ? g->n[k] * g->h[k] : 1;
        b->n[k] = k < g->dim ? (int)fmax(1, fmin(floor(length / reach), 256)) : 1;
        b->low[k] = k < g->dim ? g->low[k] : -0.5;
        b->per[k] = b->n[k] / length;
        boxes *= b->n[k];
    }
    TRY(allocate(&b->start, boxes + 2, sizeof *b->start, "a kernel"));
    TRY(allocate(&b->cell, c->cells, sizeof *b->cell, "a kernel"));
    for (long i = 0; i < c->cells; i++) b->start[bin_of(b, g->mesh->centre[i], at) + 2]++;
    for (long i = 2; i < boxes + 2; i++) b->start[i] += b->start[i - 1];
    for (long i = 0; i < c->cells; i++) b->cell[b->start[bin_of(b, g->mesh->centre[i], at) + 1]++] = i;
    return OK;
}

/* Computes exp(-t) for 0 <= t < 8 by the series of exp(-t/16): unlike exp it has the same bits everywhere. */
static double falling(double t) {
    double sum = 1;
    for (int k = 16; k > 0; k--) sum = 1 - t / 16 / k * sum;
    for (int k = 0; k < 4; k++) sum *= sum;
    return sum;
}

/* Returns phi of the kernel between two cells; 0: they are too far apart. */
static double phi_of(const struct coarse_grid *g, enum coarse_kernel kernel, long i, long j) {
    double square = 0;
    for (int k = 0; k < g->dim; k++) {
        const double length = g->n[k] * g->h[k];
        double r = fabs(g->mesh->centre[i][k] - g->mesh->centre[j][k]);
        if (g->periodic[k]) r = fmin(r, length - r);
        square += r * r;
    }
    const double t = square / (g->width * g->width);
    if (i == j) return 1;
    return kernel == COARSE_HEAVISIDE ? t < 1 : t < 9 ? falling(0.5 * t) : 0;
}

/* Lists the cells near cell i with phi, if `out` is there; returns how many. */
static long list_near(const struct coarse *c, enum coarse_kernel kernel, const struct bins *b, long i,
                      struct near *out) {
    const struct coarse_grid *g = &c->grid;
    long n = 0;
    int at[3], q[3];
    (void)bin_of(b, g->mesh->centre[i], at);
    for (int s = 0; s < 27; s++) {
        const int step[3] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
        bool there = true;
        for (int k = 0; k < 3; k++) { /* of few boxes each is there once */
            const bool around = k < g->dim && g->periodic[k];
            q[k] = at[k] + step[k];
            there = there && step[k] >= (around && b->n[k] < 3 ? 0 : -1) && step[k] <= (around && b->n[k] < 2 ? 0 : 1);
            if (around) q[k] = (q[k] + b->n[k]) % b->n[k];
            there = there && q[k] >= 0 && q[k] < b->n[k];
        }
        if (!there) continue;
        const long bin = (q[2] * (long)b->n[1] + q[1]) * b->n[0] + q[0];
        for (long p = b->start[bin]; p < b->start[bin + 1]; p++) {
            const double phi = phi_of(g, kernel, i, b->cell[p]);
            if (phi > 0 && out) out[n] = (struct near){b->cell[p], phi};
            n += phi > 0;
        }
    }
    return n;
}

static status find_near(struct coarse *c, enum coarse_kernel kernel, const struct bins *b) {
    struct mesh_kernel *m = &c->kernel;
    for (long i = 0; i < c->cells; i++) {
        m->start[i + 1] = m->start[i] + list_near(c, kernel, b, i, NULL);
        if (m->start[i + 1] > 16L * MOST_CELLS) return too_wide(&c->grid);
    }
    TRY(allocate(&m->near, m->start[c->cells], sizeof *m->near, "a kernel"));
    for (long i = 0; i < c->cells; i++) (void)list_near(c, kernel, b, i, m->near + m->start[i]);
    return OK;
}

/* Turns phi into shares. What the iteration leaves, far below round-off of the fields, goes to the cell itself. */
static void balance(const struct coarse *c, double *e) {
    enum { STEPS = 400 };
    const struct mesh_kernel *m = &c->kernel;
    const double *V = c->grid.mesh->volume;
    for (long i = 0; i < c->cells; i++) e[i] = 1 / sqrt(V[i]);
    double *next = e + c->cells, off = 1;
    for (int step = 0; step < STEPS && off > 1e-13; step++) {
        off = 0;
        for (long i = 0; i < c->cells; i++) {
            double sum = 0;
            for (long p = m->start[i]; p < m->start[i + 1]; p++)
                sum += V[m->near[p].cell] * m->near[p].share * e[m->near[p].cell];
            off = fmax(off, fabs(e[i] * sum - 1));
            next[i] = sqrt(e[i] / sum);
        }
        memcpy(e, next, (size_t)c->cells * sizeof *e);
    }
    for (long i = 0; i < c->cells; i++) {
        double others = 0;
        for (long p = m->start[i]; p < m->start[i + 1]; p++) {
            m->near[p].share *= e[i] * V[i] * e[m->near[p].cell]; /* M_ij/V_j */
            if (m->near[p].cell != i) others += m->near[p].share * V[m->near[p].cell];
        }
        for (long p = m->start[i]; p < m->start[i + 1]; p++)
            if (m->near[p].cell == i) m->near[p].share = 1 - others / V[i];
    }
}

static status make_mesh_kernel(struct coarse *c, enum coarse_kernel kernel) {
    struct bins b = {.start = NULL};
    double *e = NULL;
    TRY(check_width(&c->grid));
    TRY(allocate(&c->kernel.start, c->cells + 1, sizeof *c->kernel.start, "a kernel"));
    TRY(allocate(&c->kernel.sums, coarse_size(c), sizeof(double), "sums of the grains"));
    status s = make_bins(c, kernel == COARSE_GAUSSIAN ? 3 * c->grid.width : c->grid.width, &b);
    if (!s) s = find_near(c, kernel, &b);
    if (!s) s = allocate(&e, 2 * c->cells, sizeof *e, "a kernel");
    if (!s) balance(c, e);
    free(b.start);
    free(b.cell);
    free(e);
    return s;
}

/* Spreads one set of sums, of all grains or of a kind, to cell i. */
static void spread_set(const struct coarse *c, long i, int set) {
    const struct mesh_kernel *m = &c->kernel;
    double *out = m->sums + c->size * i + set, share = 0, impacts = 0;
    for (long p = m->start[i]; p < m->start[i + 1]; p++) {
        const double *from = c->sums + c->size * m->near[p].cell + set;
        share += m->near[p].share * from[SHARE];
        impacts += m->near[p].share * from[IMPACTS];
    }
    out[SHARE] = share;
    out[IMPACTS] = impacts;
    for (int k = 0; k < c->grid.dim; k++) {
        const int mean = MEAN + PER_AXIS * k, deviation = DEVIATION + PER_AXIS * k;
        double base = NAN, away = 0, square = 0; /* about the mean of a cell, so that a cold stream has T = 0 */
        for (long p = m->start[i]; p < m->start[i + 1]; p++) {
            const double *from = c->sums + c->size * m->near[p].cell + set, part = m->near[p].share * from[SHARE];
            if (part > 0 && isnan(base)) base = from[mean];
            if (part > 0) away += part * (from[mean] - base);
        }
        out[mean] = share > 0 ? base + away / share : 0;
        for (long p = m->start[i]; p < m->start[i + 1]; p++) {
            const double *from = c->sums + c->size * m->near[p].cell + set, off = from[mean] - out[mean];
            square += m->near[p].share * (from[deviation] + from[SHARE] * off * off);
        }
        out[deviation] = square;
    }
}

/* Returns the sums of which the fields are. */
static const double *spread_sums(const struct coarse *c) {
    if (!c->kernel.start) return c->sums;
    const int sets = c->grid.kinds ? 1 + c->grid.kinds->n : 1;
    for (long i = 0; i < c->cells; i++)
        for (int set = 0; set < sets; set++) spread_set(c, i, set * c->rough);
    c->kernel.sums[c->cells * c->size] = c->sums[c->cells * c->size];
    return c->kernel.sums;
}

static double cell_volume(const struct coarse *c, long cell) {
    double box = 1;
    if (c->grid.mesh) return c->grid.mesh->volume[cell];
    for (int k = 0; k < c->grid.dim; k++) box *= c->grid.h[k];
    return box;
}

static double grain_volume(const struct coarse *c) {
    const double d = c->grid.diameter;
    return acos(-1) * (c->grid.dim == 2 ? d * d / 4 : d * d * d / 6);
}

/* Returns the volume of the grains of one kind in a cell over that of a grain of the law, summed over the samples. */
static double kind_share(const struct coarse *c, const double *sum, int kind) {
    return sum[(kind + 1) * c->rough + SHARE] * pow(c->grid.kinds->size[kind], c->grid.dim);
}

/* Returns the same of all grains. */
static double volume_share(const struct coarse *c, const double *sum) {
    double all = 0;
    if (!c->grid.kinds) return sum[SHARE];
    for (int k = 0; k < c->grid.kinds->n; k++) all += kind_share(c, sum, k);
    return all;
}

static double variance(const double *sum, int dim) {
    double deviation = 0;
    for (int k = 0; k < dim; k++) deviation += sum[DEVIATION + PER_AXIS * k];
    return sum[SHARE] > 0 ? deviation / (dim * sum[SHARE]) : 0;
}

void coarse_kind(const struct coarse *c, int kind, enum coarse_field f, double *const out[3]) {
    const int dim = c->grid.dim;
    const double *sums = spread_sums(c), samples = sums[c->cells * c->size], one = grain_volume(c);
    for (long i = 0; i < c->cells; i++) {
        const double *all = sums + c->size * i, *sum = all + (kind + 1) * c->rough;
        if (f == COARSE_ALPHA)
            out[0][i] = samples > 0 ? kind_share(c, all, kind) / (samples * cell_volume(c, i)) * one : 0;
        if (f == COARSE_T) out[0][i] = variance(sum, dim);
        for (int k = 0; f == COARSE_U && k < dim; k++) out[k][i] = sum[MEAN + PER_AXIS * k];
    }
}

/* Computes the fields of rough grains alone, in a cell. */
static void rough_value(const struct coarse *c, const double *sum, double per, enum coarse_field f, double value[3]) {
    const double *rough = sum + c->rough, m = c->grid.mass;
    for (int k = 0; k < 3; k++) {
        value[k] = 0;
        if (f == COARSE_SPIN) value[k] = sum[SHARE] > 0 ? rough[SPIN + k] / sum[SHARE] : 0;
        if (f == COARSE_P_AXES && k < c->grid.dim)
            value[k] = (m * sum[DEVIATION + PER_AXIS * k] + rough[CONTACT + k]) * per;
        if (f == COARSE_P_SHEAR) value[k] = (m * rough[CROSS + k] + rough[CONTACT + 3 + k]) * per;
    }
}

void coarse_value(const struct coarse *c, double tau, enum coarse_field f, double *const out[3]) {
    const struct coarse_grid *g = &c->grid;
    const double *sums = spread_sums(c), samples = sums[c->cells * c->size], one = grain_volume(c);
    for (long i = 0; i < c->cells; i++) {
        const double volume = cell_volume(c, i), *sum = sums + c->size * i;
        const double number = samples > 0 ? sum[SHARE] / (samples * volume) : 0, T = variance(sum, g->dim);
        const double collisional = tau > 0 ? sum[IMPACTS] / (g->dim * tau * volume) : 0;
        if (f > COARSE_T_AXES) {
            double value[3];
            rough_value(c, sum, samples > 0 ? 1 / (samples * volume) : 0, f, value);
            for (int k = 0; k < 3; k++)
                if (f == COARSE_SPIN || k < g->dim) out[k][i] = value[k];
            continue;
        }
        if (f == COARSE_RHO) out[0][i] = number * g->mass;
        if (f == COARSE_ALPHA) out[0][i] = samples > 0 ? volume_share(c, sum) / (samples * volume) * one : 0;
        if (f == COARSE_T) out[0][i] = T;
        if (f == COARSE_P) out[0][i] = number * g->mass * T + collisional;
        for (int k = 0; f == COARSE_U && k < g->dim; k++) out[k][i] = sum[MEAN + PER_AXIS * k];
        for (int k = 0; f == COARSE_T_AXES && k < g->dim; k++)
            out[k][i] = sum[SHARE] > 0 ? sum[DEVIATION + PER_AXIS * k] / sum[SHARE] : 0;
    }
}
