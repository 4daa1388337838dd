/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the weights of fits on polyhedral meshes (polynomial.h) by least squares: of whole stencils, of the sectors of
 * CWENO3, of gradients; and the places of face points. */
#include "libcore/schemes/polynomial_fit.h"

#include <stdlib.h>
#include <string.h>

/* A column of a least-squares problem that depends on the ones before it up to this fraction gets no coefficient. */
static const double DEPENDENT = 1e-2;
static const double FLAT_SECTOR = 0.1; /* the fraction for the members of a sector, which is then left out */
static const double CONE = 0.55;       /* cosine of the half-angle of the cone of a sector beyond a face */
static const double CENTRAL = 1e3;     /* linear weight of the quadratic against that of one sector */

/* Groups of members: the first ring, parts of the second one, all others. */
enum { GROUPS = MAX_DIM + 3 };

struct point_list { /* face points of the cells */
    int *start;     /* [nnear + 1] */
    int *entry;     /* 2 point + side */
};

/* A logarithm has other last digits in another unit: the root of 1/2 to 4 times a power of 8 has not, but for that. */
static double cube_root(double volume) {
    int exponent;
    const double part = frexp(volume, &exponent);
    const int over = (exponent % 3 + 3) % 3;
    return ldexp(power(ldexp(part, over), 1. / 3), (exponent - over) / 3);
}

static double unit(const struct polyhedra *m, int i) { /* h = volume^(1/dim), the same bits everywhere */
    double volume = m->round.radial >= 0 ? m->volume[i] / m->round.radius[i] : m->volume[i];
    return m->dim == 1 ? volume : m->dim == 2 ? sqrt(volume) : cube_root(volume);
}
static int smallest(int a, int b) {
    return a < b ? a : b;
}

/* Makes the memory of lists with the given numbers of entries per cell. All entries are empty: the cell itself with
 * weight 0. */
static status entries_make(const struct fit *f, const int *length, int width, bool cells, struct entries *r) {
    int n = f->polyhedra->nnear;
    r->width = width;
    TRY(allocate(&r->start, f->nbatches + 1, sizeof *r->start, "rows of a fit"));
    for (int b = 0; b < f->nbatches; b++) {
        int most = 0;
        for (int i = b * LANES; i < smallest(n, (b + 1) * LANES); i++) most = length[i] > most ? length[i] : most;
        r->start[b + 1] = r->start[b] + most;
    }
    long entries = r->start[f->nbatches];
    TRY(allocate(&r->data, entries * width * LANES, sizeof *r->data, "weights of a fit"));
    if (!cells) return OK;
    TRY(allocate(&r->cell, entries * LANES, sizeof *r->cell, "members of a fit"));
    for (int b = 0; b < f->nbatches; b++)
        for (long j = (long)r->start[b] * LANES; j < (long)r->start[b + 1] * LANES; j++)
            r->cell[j] = b * LANES + (b * LANES + (int)(j % LANES) < n ? (int)(j % LANES) : 0);
    return OK;
}
void entries_free(struct entries *r) {
    free(r->start);
    free(r->cell);
    free(r->data);
}
static long place_of_entry(const struct entries *r, int cell, int entry) {
    return r->start[cell / LANES] + entry;
}
static void put(struct entries *r, int cell, int entry, int k, double x) {
    r->data[(place_of_entry(r, cell, entry) * r->width + k) * LANES + cell % LANES] = x;
}
static void put_cell(struct entries *r, int cell, int entry, int member) {
    r->cell[place_of_entry(r, cell, entry) * LANES + cell % LANES] = member;
}

/* Computes the solution operator W[k][n] of the least-squares problem w_j (sum_k A[k][j] a_k - d_j) -> 0, a = W d, by
 * Gram-Schmidt (orthogonalised twice, which is enough; A is overwritten). Returns how many coefficients are 0 because
 * their columns depend on others. */
static int least_squares(int n, int ncoef, double *A, const double *w, double dependent, double *W) {
    double R[MAX_COEFFICIENT][MAX_COEFFICIENT] = {{0}}, longest = 0;
    int dropped = 0;
    for (int k = 0; k < ncoef; k++) {
        double *q = A + (long)k * n, square = 0;
        for (int j = 0; j < n; j++) {
            q[j] *= w[j];
            square += q[j] * q[j];
        }
        longest = larger(longest, square); /* a column may be nothing but round-off: the members lie in a plane */
    }
    for (int k = 0; k < ncoef; k++) {
        double *q = A + (long)k * n, after = 0;
        for (int i = 0; i < 2 * k; i++) {
            const double *p = A + (long)(i % k) * n;
            double dot = 0;
            for (int j = 0; j < n; j++) dot += p[j] * q[j];
            for (int j = 0; j < n; j++) q[j] -= dot * p[j];
            R[i % k][k] += dot;
        }
        for (int j = 0; j < n; j++) after += q[j] * q[j];
        bool kept = sqrt(after) > dependent * sqrt(longest);
        R[k][k] = kept ? sqrt(after) : 0;
        dropped += !kept;
        for (int j = 0; j < n; j++) q[j] = kept ? q[j] / R[k][k] : 0;
    }
    for (int k = ncoef - 1; k >= 0; k--)
        for (int j = 0; j < n; j++) {
            double a = A[(long)k * n + j];
            for (int i = k + 1; i < ncoef; i++) a -= R[k][i] * W[(long)i * n + j];
            W[(long)k * n + j] = R[k][k] > 0 ? a / R[k][k] : 0;
        }
    for (long j = 0; j < (long)ncoef * n; j++) W[j] *= w[j % n];
    return dropped;
}

/* Computes the means A[k][n] of the basis functions of cell i over n members, and weights w = 1/distance. */
static void member_means(const struct polyhedra *m, int i, int degree, int n, const int *member, double *A, double *w) {
    double h = unit(m, i);
    for (int j = 0; j < n; j++) {
        int at = m->stencil_start[i] + member[j], k = m->dim;
        double x[MAX_DIM], square = 0;
        for (int a = 0; a < m->dim; a++) {
            A[(long)a * n + j] = x[a] = m->offset[a][at] / h;
            square += x[a] * x[a];
        }
        for (int a = 0; degree > 1 && a < m->dim; a++)
            for (int b = a; b < m->dim; b++, k++) {
                const double *moment = m->moment[k - m->dim];
                A[(long)k * n + j] = x[a] * x[b] + (moment[m->stencil[at]] - moment[i]) / (h * h);
            }
        w[j] = 1 / sqrt(square);
    }
}

/* Sets the weight of members whose values are unknown to 0. */
static void leave_out(const struct polyhedra *m, const bool *unknown, int i, int n, const int *member, double *w) {
    for (int j = 0; j < n && unknown; j++) {
        const int cell = m->stencil[m->stencil_start[i] + member[j]];
        if (cell >= m->ncells && unknown[cell - m->ncells]) w[j] = 0;
    }
}

static int most_members(const struct polyhedra *m) {
    int most = 1;
    for (int i = 0; i < m->nnear; i++) {
        int n = m->stencil_start[i + 1] - m->stencil_start[i];
        most = n > most ? n : most;
    }
    return most;
}

static int nearest_members(const struct polyhedra *m, int i) {
    int n = 0, first = m->stencil_start[i];
    while (first + n < m->stencil_start[i + 1] && m->ring[first + n] == 1) n++;
    return n;
}

/* The cosine of the angle between the offsets of two members. */
static double cosine(const struct polyhedra *m, int i, int a, int b) {
    double dot = 0, aa = 0, bb = 0;
    for (int k = 0; k < m->dim; k++) {
        const double *offset = m->offset[k] + m->stencil_start[i];
        dot += offset[a] * offset[b];
        aa += offset[a] * offset[a];
        bb += offset[b] * offset[b];
    }
    return dot / sqrt(aa * bb);
}

/* Moves all but the `most` members that are nearest to the face of a group to the last group. Returns how many stay. */
static int thin_group(int n, int k, int most, int *group, const double *best) {
    for (int left = 0;; left = 0) {
        int farthest = -1;
        for (int j = 0; j < n; j++) {
            if (group[j] != k) continue;
            left++;
            if (farthest < 0 || best[j] < best[farthest]) farthest = j;
        }
        if (left <= most) return left;
        group[farthest] = GROUPS - 1;
    }
}

/* Finds the groups of the members of cell i: 0: the first ring; if the cell is a simplex, 1 + k: of the second ring the
 * dim members nearest to the direction of face k, as a simplex there has, filled up with those that found no room; the
 * last one: all others. best: room for one number a member. */
static void find_groups(const struct polyhedra *m, int i, int *group, double *best) {
    const int *ring = m->ring + m->stencil_start[i], n = m->stencil_start[i + 1] - m->stencil_start[i];
    const int faces = nearest_members(m, i) > m->dim + 1 ? 0 : nearest_members(m, i);
    for (int j = 0; j < n; j++) {
        group[j] = ring[j] == 1 ? 0 : GROUPS - 1;
        best[j] = -2;
        for (int k = 0; k < faces && ring[j] == 2; k++) {
            const double here = cosine(m, i, k, j);
            if (here > best[j]) {
                best[j] = here;
                group[j] = 1 + k;
            }
        }
    }
    int left[GROUPS];
    for (int k = 1; k <= faces; k++) left[k] = thin_group(n, k, m->dim, group, best);
    for (int j = 0; j < n; j++)
        for (int k = 1; k <= faces && ring[j] == 2 && group[j] == GROUPS - 1; k++)
            if (left[k] < m->dim) {
                left[k]++;
                group[j] = k;
            }
}

/* Gives each member of a stencil its entry in the batch, entry[stencil_start[nnear]], and the cells the number of
 * entries, length[nnear]. A group has the same entries in all cells of a batch: sectors, which have members of few
 * groups, then use few entries. The order of a cell's members is the same in any batch. */
static void order_members(const struct polyhedra *m, int *length, int *entry, double *work) {
    for (int first = 0; first < m->nnear; first += LANES) {
        const int end = smallest(m->nnear, first + LANES);
        int longest[GROUPS] = {0}, start[GROUPS + 1] = {0};
        for (int i = first; i < end; i++) {
            int n[GROUPS] = {0};
            find_groups(m, i, entry + m->stencil_start[i], work);
            for (int j = m->stencil_start[i]; j < m->stencil_start[i + 1]; j++)
                if (++n[entry[j]] > longest[entry[j]]) longest[entry[j]]++;
        }
        for (int k = 0; k < GROUPS; k++) start[k + 1] = start[k] + longest[k];
        for (int i = first; i < end; i++) {
            int at[GROUPS];
            memcpy(at, start, sizeof at);
            length[i] = start[GROUPS] > 0 ? start[GROUPS] : 1;
            for (int j = m->stencil_start[i]; j < m->stencil_start[i + 1]; j++) entry[j] = at[entry[j]]++;
        }
    }
}

/* Puts the weight of a member's value in coefficient k. */
static void put_weight(struct entries *r, int cell, int entry, int k, double x) {
    const int batch = cell / LANES, lane = cell % LANES, part = PART(r->width);
    const long first = r->start[batch], n = r->start[batch + 1] - first;
    const long run = (lane / VECTOR * (r->width / part) + k / part) * n + entry;
    r->data[first * r->width * LANES + (run * part + k % part) * VECTOR + lane % VECTOR] = x;
}

/* Computes the weights of the polynomials of whole stencils. */
static void member_weights(struct fit *f, const bool *unknown, const int *entry, int *all, double *A, double *w,
                           double *W) {
    const struct polyhedra *m = f->polyhedra;
    for (int i = 0; i < m->nnear; i++) {
        const int first = m->stencil_start[i], n = m->stencil_start[i + 1] - first, ncoef = f->member.width;
        for (int j = 0; j < n; j++) all[j] = j;
        member_means(m, i, f->kind->degree, n, all, A, w);
        leave_out(m, unknown, i, n, all, w);
        least_squares(n, ncoef, A, w, DEPENDENT, W);
        for (int j = 0; j < n; j++) {
            put_cell(&f->member, i, entry[first + j], m->stencil[first + j]);
            for (int k = 0; k < ncoef; k++) put_weight(&f->member, i, entry[first + j], k, W[(long)k * n + j]);
        }
    }
}

/* Sectors of a cell are sets of members for linear polynomials. Wherever a shock passes, one sector should lie on the
 * cell's side of it. The members at a corner make a sector. In a cell with dim + 1 neighbours a shock may cut two
 * members of every corner: there the members of the first two rings beyond a face make a sector, too. */
static int find_sector(const struct polyhedra *m, int i, int sector, int *member) { /* returns its length, -1: none */
    int ncorners = m->corner_start[i + 1] - m->corner_start[i], first = m->stencil_start[i], n = 0;
    int members = m->stencil_start[i + 1] - first, faces = nearest_members(m, i);
    if (sector < ncorners) {
        const int *at = m->corner_first + m->corner_start[i] + sector;
        for (int j = at[0]; j < at[1]; j++) member[n++] = m->corner_member[j];
        return n;
    }
    if (faces > m->dim + 1 || sector - ncorners >= faces) return -1;
    for (int j = 0; j < members; j++)
        if (m->ring[first + j] <= 2 && cosine(m, i, sector - ncorners, j) > CONE) member[n++] = j;
    return n;
}

/* Computes the weights of the sectors' gradients, and which sectors count. place: room for one number an entry. */
static void sector_weights(struct fit *f, const bool *unknown, const int *entry, int *member, int *place, double *A,
                           double *w, double *W) {
    const struct polyhedra *m = f->polyhedra;
    struct sectors *all = &f->sector;
    for (int i = 0; i < m->nnear; i++) {
        const int first = all->start[i / LANES], lane = i % LANES;
        int counted = 0;
        for (int s = first, n; (n = find_sector(m, i, s - first, member)) >= 0; s++) {
            member_means(m, i, 1, n, member, A, w);
            leave_out(m, unknown, i, n, member, w);
            if (n < m->dim || least_squares(n, m->dim, A, w, FLAT_SECTOR, W) > 0) continue;
            counted++;
            all->share[(long)s * LANES + lane] = 1;
            for (int j = all->first[s]; j < all->first[s + 1]; j++) place[all->used[j]] = j;
            for (int j = 0; j < n; j++) {
                const long at = place[entry[m->stencil_start[i] + member[j]]];
                for (int k = 0; k < m->dim; k++)
                    all->data[(at * m->dim + k) * LANES + lane] = (float)W[(long)k * n + j];
            }
        }
        for (int s = first; s < all->start[i / LANES + 1]; s++)
            all->share[(long)s * LANES + lane] /= (float)(CENTRAL + counted);
    }
}

/* Lists in used (NULL: counts) the entries of `member` that a sector of a batch has in any of its cells, upwards.
 * member, counted: room for one number an entry. Returns how many these are. */
static int list_used(const struct fit *f, int batch, int sector, const int *entry, int *member, int *counted,
                     int *used) {
    const struct polyhedra *m = f->polyhedra;
    const int entries = f->member.start[batch + 1] - f->member.start[batch];
    int n = 0;
    for (int j = 0; j < entries; j++) counted[j] = 0;
    for (int i = batch * LANES; i < smallest(m->nnear, (batch + 1) * LANES); i++)
        for (int j = find_sector(m, i, sector, member) - 1; j >= 0; j--)
            counted[entry[m->stencil_start[i] + member[j]]]++;
    for (int j = 0; j < entries; j++)
        if (counted[j]) {
            if (used) used[n] = j;
            n++;
        }
    return n;
}

static status make_sectors(struct fit *f, const int *entry, int most, int *member, int *counted) {
    const struct polyhedra *m = f->polyhedra;
    struct sectors *s = &f->sector;
    int longest = 1;
    TRY(allocate(&s->start, f->nbatches + 1, sizeof *s->start, "sectors of a fit"));
    for (int b = 0; b < f->nbatches; b++) {
        int n = 0;
        for (int i = b * LANES; i < smallest(m->nnear, (b + 1) * LANES); i++)
            while (find_sector(m, i, n, member) >= 0) n++;
        s->start[b + 1] = s->start[b] + n;
        longest = n > longest ? n : longest;
    }
    const int n = s->start[f->nbatches];
    TRY(allocate(&s->first, n + 1, sizeof *s->first, "sectors of a fit"));
    for (int b = 0; b < f->nbatches; b++)
        for (int at = s->start[b]; at < s->start[b + 1]; at++)
            s->first[at + 1] = s->first[at] + list_used(f, b, at - s->start[b], entry, member, counted, NULL);
    TRY(allocate(&s->used, s->first[n], sizeof *s->used, "sectors of a fit"));
    for (int b = 0; b < f->nbatches; b++)
        for (int at = s->start[b]; at < s->start[b + 1]; at++)
            list_used(f, b, at - s->start[b], entry, member, counted, s->used + s->first[at]);
    const long each = (long)m->dim * LANES;
    TRY(allocate(&s->share, (long)n * LANES, sizeof *s->share, "shares of sectors"));
    TRY(allocate(&s->data, s->first[n] * each, sizeof *s->data, "weights of sectors"));
    TRY(allocate(&s->change, (long)most * f->nvar * LANES, sizeof *s->change, "values of members"));
    TRY(allocate(&s->taken, (long)most * f->nvar * LANES, sizeof *s->taken, "values of members"));
    TRY(allocate(&s->gradient, longest * f->nvar * each, sizeof *s->gradient, "gradients of sectors"));
    return allocate(&s->weight, (long)longest * LANES, sizeof *s->weight, "weights of sectors");
}

static status make_moments(struct fit *f, int *length) {
    const struct polyhedra *m = f->polyhedra;
    int nmoments = m->dim * (m->dim + 1) / 2;
    for (int i = 0; i < m->nnear; i++) length[i] = 1;
    TRY(entries_make(f, length, nmoments, false, &f->moment));
    for (int i = 0; i < m->nnear; i++)
        for (int k = 0; k < nmoments; k++) put(&f->moment, i, 0, k, m->moment[k][i] / (unit(m, i) * unit(m, i)));
    return OK;
}

/* Lists half the offsets to the members of the first ring. */
static status make_halfway(struct fit *f, int *length) {
    const struct polyhedra *m = f->polyhedra;
    for (int i = 0; i < m->nnear; i++) {
        length[i] = 0;
        for (int j = m->stencil_start[i]; j < m->stencil_start[i + 1]; j++) length[i] += m->ring[j] == 1;
    }
    TRY(entries_make(f, length, m->dim, false, &f->halfway));
    for (int i = 0; i < m->nnear; i++)
        for (int j = 0; j < length[i]; j++)
            for (int k = 0; k < m->dim; k++)
                put(&f->halfway, i, j, k, 0.5 * m->offset[k][m->stencil_start[i] + j] / unit(m, i));
    return OK;
}

static status list_points(const struct polyhedra *m, struct point_list *l) {
    TRY(allocate(&l->start, m->nnear + 2, sizeof *l->start, "face points of the cells"));
    TRY(allocate(&l->entry, 2L * m->point.n, sizeof *l->entry, "face points of the cells"));
    for (int pass = 0; pass < 2; pass++) { /* pass 0 counts, two places on; pass 1 puts in and moves the starts back */
        for (int e = 0; e < 2 * m->point.n; e++) {
            int face = m->point.face[e / 2], cell = e % 2 ? m->face.right[face] : m->face.left[face];
            if (cell >= m->nnear) continue;
            if (pass == 0) l->start[cell + 2]++;
            if (pass == 1) l->entry[l->start[cell + 1]++] = e;
        }
        for (int i = 0; pass == 0 && i < m->nnear; i++) l->start[i + 2] += l->start[i + 1];
    }
    return OK;
}

/* Gives the entries that a cell lacks beside others of its batch its first point once more, so that what is found over
 * all entries does not depend on the other cells. */
static void repeat_points(struct fit *f, const int *length) {
    const struct entries *r = &f->point;
    for (int i = 0; i < f->polyhedra->nnear; i++) {
        const int b = i / LANES, entries = r->start[b + 1] - r->start[b];
        for (int j = length[i]; j < entries && length[i] > 0; j++)
            for (int k = 0; k < r->width; k++)
                r->data[(place_of_entry(r, i, j) * r->width + k) * LANES + i % LANES] =
                    r->data[(place_of_entry(r, i, 0) * r->width + k) * LANES + i % LANES];
    }
}

static int rim_of(const struct polyhedra *m, int i, int *first) {
    if (i < m->nown) return 0;
    *first = m->rim.start[i - m->nown];
    return m->rim.start[i - m->nown + 1] - *first;
}

static status make_points(struct fit *f, const struct point_list *l, int *length) {
    const struct polyhedra *m = f->polyhedra;
    int rim = 0;
    for (int side = 0; side < 2; side++)
        TRY(allocate(&f->place[side], m->point.n, sizeof *f->place[side], "face points of a fit"));
    for (int i = 0; i < m->nnear; i++) length[i] = l->start[i + 1] - l->start[i] + rim_of(m, i, &rim);
    TRY(entries_make(f, length, m->dim, false, &f->point));
    for (int i = 0; i < m->nnear; i++) {
        const int mine = length[i] - rim_of(m, i, &rim);
        for (int j = mine; j < length[i]; j++)
            for (int k = 0; k < m->dim; k++) put(&f->point, i, j, k, m->rim.arm[k][rim + j - mine] / unit(m, i));
        for (int j = 0; j < mine; j++) {
            int point = l->entry[l->start[i] + j] / 2, side = l->entry[l->start[i] + j] % 2;
            bool whole = f->kind->cells == NULL;
            f->place[side][point] = whole ? i : (int)place_of_entry(&f->point, i, j) * LANES + i % LANES;
            for (int k = 0; k < m->dim; k++) put(&f->point, i, j, k, m->point.arm[side][k][point] / unit(m, i));
        }
    }
    repeat_points(f, length);
    TRY(allocate(&f->slot, f->nbatches, sizeof *f->slot, "values at face points"));
    for (int b = 0; b < f->nbatches; b++) f->slot[b] = f->point.start[b];
    f->nvalues = f->kind->cells ? (long)f->point.start[f->nbatches] * LANES : 0;
    return allocate(&f->value, f->nvar * f->nvalues, sizeof *f->value, "values at face points");
}

static status make_weights(struct fit *f, const bool *unknown, int *length) {
    const struct polyhedra *m = f->polyhedra;
    const int ncoef = m->dim + (f->kind->degree > 1 ? m->dim * (m->dim + 1) / 2 : 0);
    int members = most_members(m), most = members, *entry, *member = NULL;
    double *work = NULL;
    TRY(allocate(&entry, m->stencil_start[m->nnear], sizeof *entry, "the stencils"));
    status s = allocate(&work, (2L * ncoef + 1) * most, sizeof *work, "a least-squares problem");
    if (!s) order_members(m, length, entry, work);
    for (int i = 0; i < m->nnear; i++) most = length[i] > most ? length[i] : most;
    if (!s) s = entries_make(f, length, ncoef, true, &f->member);
    if (!s) s = allocate(&f->change, (long)most * f->nvar * LANES, sizeof *f->change, "values of members");
    if (!s) s = f->kind->degree == 1 ? make_halfway(f, length) : make_moments(f, length);
    if (!s) s = allocate(&member, 2L * most, sizeof *member, "a stencil");
    if (!s) {
        double *W = work + (long)ncoef * members, *w = W + (long)ncoef * members;
        member_weights(f, unknown, entry, member, work, w, W);
        if (f->kind->degree == 2) s = make_sectors(f, entry, most, member, member + most);
        if (f->kind->degree == 2 && !s) sector_weights(f, unknown, entry, member, member + most, work, w, W);
    }
    free(entry);
    free(member);
    free(work);
    return s;
}

static status fill(struct fit *f, const bool *unknown) {
    struct point_list l = {0};
    int *length = NULL;
    TRY(allocate(&f->ahead, 1, sizeof *f->ahead, "a fit"));
    status s = allocate(&length, f->polyhedra->nnear, sizeof *length, "lengths of lists");
    if (!s) s = list_points(f->polyhedra, &l);
    if (!s) s = make_points(f, &l, length);
    if (!s && f->kind->cells) s = make_weights(f, unknown, length);
    free(length);
    free(l.start);
    free(l.entry);
    return s;
}

/* last[nbatches] <- the turn that reads the values of a batch last; n: they are read or made after the turns. */
static void find_last_turns(const struct fit *f, int n, const int *cells, const int *faces, int *last) {
    const struct polyhedra *m = f->polyhedra;
    for (int face = 0, turn = 0; face < m->face.n; face++) {
        const int side[2] = {m->face.left[face], m->face.right[face]};
        while (turn < n && face >= faces[turn]) turn++;
        for (int k = 0; k < 2; k++)
            if (side[k] < m->nnear && last[side[k] / LANES] < turn) last[side[k] / LANES] = turn;
    }
    for (int b = n ? cells[n - 1] / LANES : 0; b < f->nbatches; b++) last[b] = n;
}

/* Deals slots of that number of entries to the batches, again those of batches that have had their last turn; the
 * latest of these first, as it is still in the cache. work[nbatches + n + 1]. Returns the number of slots. */
static int deal_slots(struct fit *f, int n, const int *cells, const int *last, int entries, int *work) {
    int *next = work, *first = work + f->nbatches, slots = 0, b = 0, empty = -1; /* lists of batches */
    for (int turn = 0; turn <= n; turn++) first[turn] = -1;
    for (int turn = 0; turn <= n; turn++) {
        const int end = turn < n ? (cells[turn] + LANES - 1) / LANES : f->nbatches;
        for (; b < end; b++) {
            const int from = empty;
            if (from >= 0) empty = next[from];
            f->slot[b] = from >= 0 ? f->slot[from] : entries * slots++;
            next[b] = first[last[b]];
            first[last[b]] = b;
        }
        for (int at = first[turn], after; at >= 0; at = after) {
            after = next[at];
            next[at] = empty;
            empty = at;
        }
    }
    return slots;
}

static void move_places(struct fit *f) {
    const struct polyhedra *m = f->polyhedra;
    for (int point = 0; point < m->point.n; point++) {
        const int face = m->point.face[point], side[2] = {m->face.left[face], m->face.right[face]};
        for (int k = 0; k < 2; k++) {
            const int b = side[k] / LANES;
            if (side[k] < m->nnear) f->place[k][point] += (f->slot[b] - f->point.start[b]) * LANES;
        }
    }
}

status fit_turns(struct fit *f, int n, const int *cells, const int *faces) {
    int *work, entries = 0;
    if (!f->kind->cells) return OK;
    for (int b = 0; b < f->nbatches; b++) {
        const int here = f->point.start[b + 1] - f->point.start[b];
        entries = here > entries ? here : entries;
    }
    TRY(allocate(&work, 2L * f->nbatches + n + 1, sizeof *work, "values at face points"));
    find_last_turns(f, n, cells, faces, work);
    f->nvalues = (long)entries * deal_slots(f, n, cells, work, entries, work + f->nbatches) * LANES;
    free(work);
    move_places(f);
    free(f->value);
    f->value = NULL;
    return allocate(&f->value, f->nvar * f->nvalues, sizeof *f->value, "values at face points");
}

/* Computes the weights of the gradient of cell i from its first n members; returns whether these span the axes. */
static bool gradient_weights(const struct polyhedra *m, int i, int n, const int *all, double *work, double *W) {
    double *w = work + (long)m->dim * n;
    member_means(m, i, 1, n, all, work, w);
    return n >= m->dim && least_squares(n, m->dim, work, w, DEPENDENT, W) == 0;
}

static status put_gradients(const struct polyhedra *m, int *length, int *all, double *work, double *W,
                            const struct fit *f, struct entries *r) {
    const int most = most_members(m);
    for (int j = 0; j < most; j++) all[j] = j;
    for (int i = 0; i < m->nnear; i++) {
        length[i] = nearest_members(m, i);
        if (!gradient_weights(m, i, length[i], all, work, W)) length[i] = m->stencil_start[i + 1] - m->stencil_start[i];
    }
    TRY(entries_make(f, length, m->dim, true, r));
    for (int i = 0; i < m->nnear; i++) {
        (void)gradient_weights(m, i, length[i], all, work, W);
        for (int j = 0; j < length[i]; j++) {
            put_cell(r, i, j, m->stencil[m->stencil_start[i] + j]);
            for (int k = 0; k < m->dim; k++) put(r, i, j, k, W[(long)k * length[i] + j] / unit(m, i));
        }
    }
    return OK;
}

status fit_gradients(const struct fit *f, struct entries *r) {
    const struct polyhedra *m = f->polyhedra;
    const int most = most_members(m);
    int *list;
    double *work;
    TRY(allocate(&list, m->nnear + most, sizeof *list, "the members of gradients"));
    status s = allocate(&work, (2L * m->dim + 1) * most, sizeof *work, "a least-squares problem");
    if (!s) {
        s = put_gradients(m, list, list + m->nnear, work, work + (m->dim + 1L) * most, f, r);
        free(work);
    }
    free(list);
    return s;
}

status fit_make(const struct polyhedra *m, const struct polynomial *p, int components, const bool *unknown,
                struct fit **out) {
    TRY(allocate(out, 1, sizeof **out, "a fit"));
    **out = (struct fit){.polyhedra = m, .kind = p, .nvar = components + 2, .nbatches = (m->nnear + LANES - 1) / LANES};
    status s = fill(*out, unknown);
    if (s) {
        fit_free(*out);
        *out = NULL;
    }
    return s;
}

static void sectors_free(struct sectors *s) {
    free(s->start);
    free(s->share);
    free(s->first);
    free(s->used);
    free(s->data);
    free(s->change);
    free(s->taken);
    free(s->gradient);
    free(s->weight);
}

void fit_free(struct fit *f) {
    if (!f) return;
    struct entries *all[] = {&f->member, &f->halfway, &f->moment, &f->point};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) entries_free(all[i]);
    sectors_free(&f->sector);
    calm_free(f->calm);
    free(f->ahead);
    free(f->change);
    free(f->value);
    free(f->slot);
    free(f->held);
    free(f->place[0]);
    free(f->place[1]);
    free(f);
}
