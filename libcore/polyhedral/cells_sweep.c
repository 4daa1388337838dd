/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a stage: cells that stand near each other are fitted, the fluxes between them found, and they are
 * updated, turn by turn, while what they share is in L2. */
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

enum { TURN = 128 }; /* cells that are fitted in a turn: whole batches of a fit */

/* Returns the end of the batch of points that begins with a face and lies before `last`. */
static int batch_end(const struct polyhedra_faces *f, int first, int last) {
    int end = first + 1;
    while (end < last && f->point_start[end + 1] - f->point_start[first] <= BATCH) end++;
    return end;
}

/* Turns take those whole batches of faces whose cells are fitted; the last one takes what is left. */
static void plan_faces(const struct polyhedra *m, struct cells_sweep *s) {
    const struct polyhedra_faces *f = &m->face;
    int at = 0;
    for (int turn = 0; turn < s->n; turn++) {
        for (int end; at < f->nlocal; at = end) {
            end = batch_end(f, at, f->nlocal);
            const int l = f->left[end - 1], r = f->right[end - 1];
            if ((l > r ? l : r) >= s->cells[turn]) break;
        }
        s->faces[turn] = at;
    }
}

/* Lists the chunks of BATCH cells by the turn that finds the last of their fluxes. */
static status plan_chunks(const struct polyhedra *m, struct cells_sweep *s) {
    const int chunks = (m->nown + BATCH - 1) / BATCH;
    int *turn, *ready;
    TRY(allocate(&turn, (long)m->face.n + chunks, sizeof *turn, "the order of the cells"));
    ready = turn + m->face.n;
    for (int face = 0, k = 0; face < m->face.n; face++) {
        while (k < s->n && face >= s->faces[k]) k++;
        turn[face] = k;
    }
    for (int i = 0; i < m->nown; i++)
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int k = turn[m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j]];
            if (k > ready[i / BATCH]) ready[i / BATCH] = k;
        }
    for (int chunk = 0; chunk < chunks; chunk++) s->start[ready[chunk] + 2]++;
    for (int k = 0; k <= s->n; k++) s->start[k + 2] += s->start[k + 1];
    for (int chunk = 0; chunk < chunks; chunk++) s->chunk[s->start[ready[chunk] + 1]++] = chunk;
    free(turn);
    return OK;
}

status cells_sweep_make(const struct polyhedra *m, struct fit *fit, struct cells_sweep *s) {
    s->n = (m->ninner + TURN - 1) / TURN;
    TRY(allocate(&s->cells, s->n, sizeof *s->cells, "the order of the cells"));
    TRY(allocate(&s->faces, s->n, sizeof *s->faces, "the order of the cells"));
    TRY(allocate(&s->start, s->n + 3, sizeof *s->start, "the order of the cells"));
    TRY(allocate(&s->chunk, m->nown / BATCH + 1, sizeof *s->chunk, "the order of the cells"));
    for (int k = 0; k < s->n; k++) s->cells[k] = (k + 1) * TURN < m->ninner ? (k + 1) * TURN : m->ninner;
    plan_faces(m, s);
    TRY(plan_chunks(m, s));
    return fit ? fit_turns(fit, s->n, s->cells, s->faces) : OK;
}

void cells_sweep_free(struct cells_sweep *s) {
    free(s->cells);
    free(s->faces);
    free(s->start);
    free(s->chunk);
}

status cells_sides_make(const struct polyhedra *m, struct cells_sides *s) {
    const int chunks = (m->nown + BATCH - 1) / BATCH;
    TRY(allocate(&s->start, chunks + 1, sizeof *s->start, "the faces of the cells"));
    for (int chunk = 0; chunk < chunks; chunk++) {
        int most = 0;
        for (int i = chunk * BATCH; i < m->nown && i < (chunk + 1) * BATCH; i++) {
            const int here = m->face_start[i + 1] - m->face_start[i];
            most = here > most ? here : most;
        }
        s->start[chunk + 1] = s->start[chunk] + most;
    }
    const long room = (long)s->start[chunks] * BATCH;
    TRY(allocate(&s->face, room, sizeof *s->face, "the faces of the cells"));
    TRY(allocate(&s->number, room, sizeof *s->number, "the faces of the cells"));
    for (long i = 0; i < room; i++) s->face[i] = m->face.n;
    for (int i = 0; i < m->nown; i++)
        for (int j = 0; j < m->face_start[i + 1] - m->face_start[i]; j++)
            s->face[((long)s->start[i / BATCH] + j) * BATCH + i % BATCH] = m->face_of_cell[m->face_start[i] + j];
    for (long i = 0; i < room; i++) s->number[i] = s->face[i] < 0 ? ~s->face[i] : s->face[i];
    return OK;
}

status cells_sides_weights(const struct cells *c, const double *weight, double (**out)[BATCH]) {
    const struct polyhedra *m = c->polyhedra;
    const int *start = c->sides.start;
    TRY(allocate(out, start[(m->nown + BATCH - 1) / BATCH], sizeof **out, "the faces of the cells"));
    for (int i = 0; i < m->nown; i++)
        for (int j = 0; j < m->face_start[i + 1] - m->face_start[i]; j++)
            (*out)[start[i / BATCH] + j][i % BATCH] = weight[m->face_start[i] + j];
    return OK;
}

KERNEL static void weigh_sides(int rows, const int (*restrict side)[BATCH], const double (*restrict weight)[BATCH],
                               const double *restrict left, const double *restrict right, double *restrict out) {
    for (int i = 0; i < BATCH; i++) out[i] = 0;
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < BATCH; i++) {
            const int face = side[j][i];
            out[i] += weight[j][i] * (face < 0 ? right[~face] : left[face]);
        }
}

void cells_sides_sum(const struct cells *c, int from, const double (*weight)[BATCH], const double *left,
                     const double *right, double *out) {
    const int *start = c->sides.start + from / BATCH;
    weigh_sides(start[1] - start[0], (const int(*)[BATCH])c->sides.face + start[0], weight + start[0], left, right,
                out);
}

void cells_sides_free(struct cells_sides *s) {
    free(s->start);
    free(s->face);
    free(s->number);
}
