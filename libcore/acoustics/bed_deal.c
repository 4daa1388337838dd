/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The deal of a bed. A bed lies where gravity puts it, perhaps in the tiles of one rank. So its blocks are dealt to all
 * ranks by the number of their cells, whoever owns the cells of the mesh: each rank is home to the cells of its own
 * mesh (b->home), and computes those that it is dealt (b->set), which have ghosts. Every rank gets the same number of
 * cells: a global sum lies between the stages of the other cells and the bed's step, so that time saved in one of them
 * cannot be used in the other. Lists go out from home when the set has changed, states in every step; results come
 * back. As blocks stay whole the bits of a step do not depend on the deal. A face between cells of two homes is listed
 * twice, even if one rank computes both cells. Homes write the lists behind the first stage, and send them after the
 * last: the home of a bed has more to list and less to do in the stages, and so no rank waits in between. */
#include "libcore/acoustics/bed_private.h"

#include <stdlib.h>

/* What is sent: cells, entries of face_of_cell, faces, those of them that are not BED_INNER, blocks; ghosts are
 * counted. */
enum { CELLS, ENTRIES, FACES, OUTER, BLOCKS, GHOSTS, COUNTS };
enum { RESULTS = 5 }; /* numbers of each block that come back */

struct bed_deal {
    struct bed_set home;
    int ranks, me;
    int *cell_first;                   /* [ranks + 1] numbers of the homes' first cells over all ranks */
    int *work_first;                   /* [ranks + 1] numbers of the first cells that each rank computes */
    int *block_count, *block_first;    /* [ranks], [ranks + 1] blocks of the homes */
    int *count_out, *count_in;         /* [ranks] lengths of messages */
    int (*out)[COUNTS], (*in)[COUNTS]; /* [ranks] what this home deals to each rank; what each home deals here */
    int *size, *number, *rank;         /* [blocks of all ranks] cells, number, who computes it */
    int *face;                         /* [sum of out[FACES]] this home's faces in the order in which they go out */
    int *place;                        /* scratch of list_out */
    int *lists_out, *lists_in;         /* what goes out of the lists, and what comes in */
    double *geometry;                  /* what goes out of the shapes, unless cells are boxes */
    double *message_out, *message_in;  /* of a step */
    int *ghost;                        /* [ghosts] numbers of the ghosts of b->set over all ranks */
    struct bed_shapes shapes;          /* of b->set, unless cells are boxes: a shape for each cell and each face */
    struct bed_round round;            /* what `shapes` has of bodies of revolution */
    struct arrays arrays;
};

static int sum_of(const struct bed *b, int (*count)[COUNTS], int what) {
    int sum = 0;
    for (int r = 0; r < b->deal->ranks; r++) sum += count[r][what];
    return sum;
}

void bed_deal_free(struct bed_deal *d) {
    if (!d) return;
    arrays_free(&d->home.arrays);
    arrays_free(&d->arrays);
    free(d);
}

status bed_deal_make(struct bed *b) {
    const int n = comm_size(b->comm);
    struct bed_deal *d;
    TRY(allocate(&d, 1, sizeof *d, "the bed"));
    b->deal = d;
    b->home = &d->home;
    d->ranks = n;
    d->me = comm_rank(b->comm);
    TRY(ARRAYS_GROW(&d->arrays, d->cell_first, 6L * n + 3));
    TRY(ARRAYS_GROW(&d->arrays, d->out, 2L * n));
    d->work_first = d->cell_first + n + 1;
    d->block_first = d->work_first + n + 1;
    d->block_count = d->block_first + n + 1;
    d->count_out = d->block_count + n;
    d->count_in = d->count_out + n;
    d->in = d->out + n;
    return OK;
}

/* ---- the lists ---- */

/* Deals the blocks of all ranks in the order of their homes, each to the rank in whose part of all cells its middle
 * lies. */
static void deal_blocks(struct bed_deal *d) {
    const int ranks = d->ranks;
    const double part = (double)d->cell_first[ranks] / ranks;
    int r = 0, before = 0;
    d->work_first[0] = 0;
    for (int j = 0; j < d->block_first[ranks]; before += d->size[j++]) {
        while (r < ranks - 1 && before + 0.5 * d->size[j] > (r + 1) * part) d->work_first[++r] = before;
        d->rank[j] = r;
    }
    while (r < ranks) d->work_first[++r] = before;
}

/* Makes room for the blocks of all ranks, and for the lists that go out, at most. */
static status make_room(struct bed *b, long sides) {
    struct bed_deal *d = b->deal;
    const long blocks = d->block_first[d->ranks], cells = b->home->cells;
    TRY(ARRAYS_GROW(&d->arrays, d->size, 3 * blocks));
    TRY(ARRAYS_GROW(&d->arrays, d->face, sides));
    TRY(ARRAYS_GROW(&d->arrays, d->place, 3 * sides));
    TRY(ARRAYS_GROW(&d->arrays, d->lists_out, cells + 5 * sides));
    d->number = d->size + blocks;
    d->rank = d->number + blocks;
    return b->home->shapes->boxes ? OK : ARRAYS_GROW(&d->arrays, d->geometry, 2 * cells + (4 + 5 * b->dim) * sides);
}

status bed_deal_blocks(struct bed *b, int sides) {
    struct bed_deal *d = b->deal;
    struct bed_set *h = b->home;
    if (!d) return OK;
    TRY(comm_share_count(b->comm, h->cells, d->count_out, d->cell_first));
    TRY(comm_share_count(b->comm, h->blocks, d->block_count, d->block_first));
    TRY(comm_agree(b->comm, make_room(b, sides)));
    for (int i = 0; i < h->blocks; i++) d->rank[i] = h->first[i + 1] - h->first[i];
    comm_share_int(b->comm, d->rank, d->block_count, d->block_first, d->size);
    comm_share_int(b->comm, h->number, d->block_count, d->block_first, d->number);
    deal_blocks(d);
    h->low = d->cell_first[d->me];
    return OK;
}

/* Is a number that of a cell which another rank than r computes? */
static bool is_ghost(const struct bed_deal *d, int r, int number) {
    return number >= 0 && (number < d->work_first[r] || number >= d->work_first[r + 1]);
}

/* Lists the faces that go out, each once for every rank that computes one of its cells, and counts what goes out.
 * place[faces]: place of each face among those that its last rank gets. entry[entries]: face_of_cell by these. */
static void list_out(struct bed *b, int *place, int *entry) {
    struct bed_deal *d = b->deal;
    const struct bed_set *h = b->home;
    int *rank = place + h->faces, faces = 0;
    memset(d->out, 0, (size_t)d->ranks * sizeof *d->out);
    for (int f = 0; f < h->faces; f++) rank[f] = -1;
    for (int block = 0; block < h->blocks; block++) {
        const int to = d->rank[d->block_first[d->me] + block];
        int *count = d->out[to];
        count[BLOCKS]++;
        count[CELLS] += h->first[block + 1] - h->first[block];
        for (int j = h->face_start[h->first[block]]; j < h->face_start[h->first[block + 1]]; j++) {
            const int listed = h->face_of_cell[j], face = listed < 0 ? ~listed : listed;
            count[ENTRIES]++;
            if (rank[face] != to) {
                rank[face] = to;
                place[face] = count[FACES]++;
                d->face[faces++] = face;
                count[OUTER] += h->kind[face] != BED_INNER;
                count[GHOSTS] += is_ghost(d, to, h->left[face]) + is_ghost(d, to, h->right[face]);
            }
            entry[j] = listed < 0 ? ~place[face] : place[face];
        }
    }
}

/* Copies n numbers from a line to a message, or back; returns the place behind them in the message. */
static double *move(double *line, long n, double *message, bool out) {
    memcpy(out ? message : line, out ? line : message, (size_t)n * sizeof *line);
    return message + n;
}

/* Does the same with ints, each of which has the room of a double in the message. */
static double *move_ints(int *list, long n, double *message, bool out) {
    memcpy(out ? (void *)message : list, out ? (void *)list : message, (size_t)n * sizeof *list);
    return message + n;
}

/* Numbers of a message for each thing. */
struct per {
    int of[COUNTS];
};

/* Counts what goes from home to those who compute it, or back, per.of[what] numbers of each thing. */
static void count(const struct bed *b, const struct per *per, bool back) {
    const struct bed_deal *d = b->deal;
    for (int r = 0; r < d->ranks; r++) {
        d->count_out[r] = d->count_in[r] = 0;
        for (int k = 0; k < COUNTS; k++) {
            d->count_out[r] += per->of[k] * (back ? d->in : d->out)[r][k];
            d->count_in[r] += per->of[k] * (back ? d->out : d->in)[r][k];
        }
    }
}

static void send(const struct bed *b, const double *out, const struct per *per, bool back) {
    count(b, per, back);
    comm_trade(b->comm, out, b->deal->count_out, b->deal->message_in, b->deal->count_in);
}

/* The lists have the sides of a cell, its entries, and of a face the cells on either side, its kind and its shape;
 * geometry is sent where cells are no boxes. */
static const struct per of_lists = {{[CELLS] = 1, [ENTRIES] = 1, [FACES] = 4}};
static struct per of_geometry(const struct bed *b) {
    const bool round = b->home->shapes->round != NULL;
    return (struct per){{[CELLS] = 1 + round, [FACES] = 3 + 3 * b->dim + (round ? 1 + 2 * b->dim : 0)}};
}

/* Returns how many numbers go out, or come in. */
static long sum_all(const struct bed *b, const struct per *per, int (*n)[COUNTS]) {
    long sum = 0;
    for (int k = 0; k < COUNTS; k++) sum += (long)per->of[k] * sum_of(b, n, k);
    return sum;
}

enum { MOST_LINES = 4 + 5 * MAX_DIM }; /* of a face */
/* Calls the lines of the geometry of a face one after the other; round: those that `s` has besides, or NULL. */
static int face_lines(struct bed_shapes *s, struct bed_round *round, int dim, double **line[MOST_LINES]) {
    int n = 0;
    line[n++] = &s->area;
    for (int side = 0; side < 2; side++) line[n++] = &s->depth[side];
    for (int k = 0; k < dim; k++) {
        line[n++] = &s->normal[k];
        for (int side = 0; side < 2; side++) line[n++] = &s->arm[side][k];
        for (int side = 0; side < 2 && round; side++) line[n++] = &round->mid[side][k];
    }
    if (round) line[n++] = &round->flat;
    return n;
}

/* Moves geometry between a message and the shapes of a set: home, whose faces `face` lists, or what is computed, face
 * NULL. */
static void move_geometry(const struct bed *b, const struct bed_set *s, const int *face, double *at, bool out) {
    struct bed_shapes shapes = *s->shapes;
    struct bed_round round = shapes.round ? *shapes.round : (struct bed_round){0};
    double **line[MOST_LINES];
    const int lines = face_lines(&shapes, shapes.round ? &round : NULL, b->dim, line);
    int(*const n)[COUNTS] = face ? b->deal->out : b->deal->in;
    for (int r = 0, cell = 0, i = 0; r < b->deal->ranks; r++) {
        for (const int end = cell + n[r][CELLS]; cell < end; cell++) {
            at = move(shapes.volume + s->body[cell], 1, at, out);
            if (shapes.round) at = move(round.radius + s->body[cell], 1, at, out);
        }
        for (const int end = i + n[r][FACES]; i < end; i++)
            for (int k = 0; k < lines; k++) at = move(*line[k] + s->shape[face ? face[i] : i], 1, at, out);
    }
}

static void write_lists(const struct bed *b, const int *entry) {
    const struct bed_deal *d = b->deal;
    const struct bed_set *h = b->home;
    const int *face = d->face;
    int *to = d->lists_out;
    for (int r = 0, cell = 0; r < d->ranks; r++) {
        const int end = cell + d->out[r][CELLS], entries = h->face_start[end] - h->face_start[cell];
        for (int i = cell; i < end; i++) *to++ = h->face_start[i + 1] - h->face_start[i];
        memcpy(to, entry + h->face_start[cell], (size_t)entries * sizeof *to);
        to += entries;
        for (const int *last = face + d->out[r][FACES]; face < last; face++) {
            *to++ = h->left[*face];
            *to++ = h->right[*face];
            *to++ = h->kind[*face];
            *to++ = h->shape[*face];
        }
        cell = end;
    }
}

void bed_write(struct bed *b) {
    struct bed_deal *d = b->deal;
    if (b->stage != BED_NEW) return;
    b->stage = BED_WRITTEN;
    if (!d) return;
    int *const entry = d->place + 2 * b->home->faces;
    list_out(b, d->place, entry);
    write_lists(b, entry);
    if (!b->home->shapes->boxes) move_geometry(b, b->home, d->face, d->geometry, true);
}

/* Makes the shapes of the cells and faces of b->set. */
static status make_geometry(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed_set *s = &b->set;
    const long cells = (long)s->cells + s->ghosts;
    const struct bed_round *round = b->home->shapes->round;
    double **line[MOST_LINES];
    const int lines = face_lines(&d->shapes, round ? &d->round : NULL, b->dim, line);
    s->shapes = b->home->shapes;
    if (s->shapes->boxes) return OK;
    s->shapes = &d->shapes;
    TRY(ARRAYS_GROW(&d->arrays, d->shapes.volume, (round ? 2 : 1) * cells + (long)lines * s->faces));
    double *const of_faces = d->shapes.volume + (round ? 2 : 1) * cells;
    for (int i = 0; i < lines; i++) *line[i] = of_faces + (long)i * s->faces;
    if (!round) return OK;
    d->round.radial = round->radial;
    d->round.radius = d->shapes.volume + cells;
    d->shapes.round = &d->round;
    return OK;
}

/* Reads a face; each end that is a cell of another rank is a ghost of its own, of which `ghosts` are known. */
static const int *read_face(struct bed *b, int face, int *ghosts, const int *from) {
    struct bed_set *s = &b->set;
    const int low = b->deal->work_first[b->deal->me];
    int *const side[2] = {s->left + face, s->right + face};
    for (int i = 0; i < 2; i++) {
        const int number = *from++;
        *side[i] = number < 0 ? -1 : number - low;
        if (!is_ghost(b->deal, b->deal->me, number)) continue;
        b->deal->ghost[*ghosts] = number;
        *side[i] = s->cells + (*ghosts)++;
    }
    s->kind[face] = (unsigned char)*from++;
    s->shape[face] = s->shapes->boxes ? *from : face;
    return from + 1;
}

static void read_lists(struct bed *b) {
    const struct bed_deal *d = b->deal;
    struct bed_set *s = &b->set;
    const int *from = d->lists_in;
    int cell = 0, entry = 0, face = 0, ghosts = 0;
    for (int r = 0; r < d->ranks; r++) {
        const int end = cell + d->in[r][CELLS], last = entry + d->in[r][ENTRIES], before = face;
        for (int at = entry; cell < end; cell++) {
            s->face_start[cell] = at;
            at += *from++;
        }
        for (; entry < last; entry++) {
            const int at = *from++;
            s->face_of_cell[entry] = at < 0 ? ~(before + ~at) : before + at;
        }
        for (; face < before + d->in[r][FACES]; face++) from = read_face(b, face, &ghosts, from);
    }
    s->face_start[cell] = entry;
    for (int i = 0; i < s->cells + s->ghosts; i++) s->body[i] = s->shapes->boxes ? 0 : i;
    if (s->shapes->boxes && s->shapes->round) bed_find_bodies(s);
}

static void read_blocks(struct bed *b) {
    const struct bed_deal *d = b->deal;
    struct bed_set *s = &b->set;
    int n = 0;
    s->first[0] = 0;
    for (int j = 0; j < d->block_first[d->ranks]; j++) {
        if (d->rank[j] != d->me) continue;
        s->number[n++] = d->number[j];
        s->first[n] = s->first[n - 1] + d->size[j];
    }
}

/* What friction adds to states, or to results. */
static struct per of_friction(const struct bed *b, bool results) {
    if (!b->rub) return (struct per){{0}};
    const int tensors = bed_tensors(b->components);
    return (struct per){{[CELLS] = 1, [FACES] = results ? tensors : tensors + b->components + 1}};
}

/* Makes room for messages: those of geometry, of states and of results. */
static status make_messages(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct per most = of_geometry(b);
    const struct per friction = of_friction(b, false);
    most.of[CELLS] = 2 * (b->components + 2) + friction.of[CELLS];
    most.of[FACES] = most.of[FACES] > 2 + friction.of[FACES] ? most.of[FACES] : 2 + friction.of[FACES];
    most.of[OUTER] = 2 * (b->components + 2) + 1;
    most.of[BLOCKS] = RESULTS;
    const long all = sum_all(b, &most, d->out) + sum_all(b, &most, d->in);
    TRY(ARRAYS_GROW(&d->arrays, d->message_out, 2 * all));
    d->message_in = d->message_out + all;
    return ARRAYS_GROW(&d->arrays, d->lists_in, sum_all(b, &of_lists, d->in));
}

/* Makes the lists of b->set from what has come in. */
static status make_set(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed_set *s = &b->set;
    s->blocks = sum_of(b, d->in, BLOCKS);
    s->cells = sum_of(b, d->in, CELLS);
    s->faces = sum_of(b, d->in, FACES);
    s->ghosts = sum_of(b, d->in, GHOSTS);
    TRY(bed_set_blocks(s, s->blocks));
    TRY(bed_set_size(b, s, s->faces, sum_of(b, d->in, ENTRIES)));
    TRY(make_geometry(b));
    TRY(ARRAYS_GROW(&d->arrays, d->ghost, s->ghosts));
    read_blocks(b);
    read_lists(b);
    return bed_halo_link(b, d->work_first, d->ghost);
}

status bed_deal_lists(struct bed *b) {
    struct bed_deal *d = b->deal;
    if (!d) return OK;
    for (int r = 0; r < d->ranks; r++) d->count_out[r] = d->count_in[r] = COUNTS;
    comm_trade_int(b->comm, d->out[0], d->count_out, d->in[0], d->count_in);
    TRY(comm_agree(b->comm, make_messages(b)));
    count(b, &of_lists, false);
    comm_trade_int(b->comm, d->lists_out, d->count_out, d->lists_in, d->count_in);
    TRY(comm_agree(b->comm, make_set(b)));
    if (b->home->shapes->boxes) return OK;
    const struct per shapes = of_geometry(b);
    send(b, d->geometry, &shapes, false);
    move_geometry(b, &b->set, NULL, d->message_in, false);
    bed_fill(b, 1, &d->shapes.volume);
    if (d->shapes.round) bed_fill(b, 1, &d->round.radius);
    return OK;
}

/* ---- states and results ---- */

static double *move_friction(const struct bed *b, struct bed_set *s, int f, bool results, double *at, bool out) {
    for (int i = 0; i < bed_tensors(b->components); i++) at = move(s->stress[i] + f, 1, at, out);
    for (int k = 0; k < b->components && !results; k++) at = move(s->wall_speed[k] + f, 1, at, out);
    return results ? at : move(s->wall_friction + f, 1, at, out);
}

/* Moves what a step starts from, or its results, between a message and a set: home, whose faces `face` lists, or what
 * is computed, face NULL. n: what goes to, or comes from, each rank. */
static void move_all(const struct bed *b, struct bed_set *s, const int *face, bool results, double *at, bool out) {
    const int last = b->components + 1;
    int(*const n)[COUNTS] = face ? b->deal->out : b->deal->in;
    for (int r = 0, cell = 0, block = 0, before = 0; r < b->deal->ranks; r++) {
        for (int v = 0; v <= last; v++) at = move(s->U[v] + cell, n[r][CELLS], at, out);
        for (int v = 0; v <= last && !results; v++) at = move(s->start[v] + cell, n[r][CELLS], at, out);
        if (b->rub) at = move(s->pressure + cell, n[r][CELLS], at, out);
        for (int i = before; i < before + n[r][FACES]; i++) {
            const int f = face ? face[i] : i;
            if (b->rub) at = move_friction(b, s, f, results, at, out);
            for (int side = 0; side < 2 && s->balanced && !results; side++) at = move(s->balance[side] + f, 1, at, out);
            if (b->carries && results) at = move(s->kept[0] + f, 1, at, out);
            if (s->kind[f] == BED_INNER) continue;
            if (!results) at = move(s->holds + f, 1, at, out);
            for (int v = 0; v <= last && !results; v++) at = move(s->outside[v] + f, 1, at, out);
            for (int v = 0; v <= last; v++) at = move(s->kept[v] + f, 1, at, out);
        }
        double *const line[] = {s->lift, s->work, s->rubbed, s->peak};
        for (int i = 0; i < RESULTS - 1 && results; i++) at = move(line[i] + block, n[r][BLOCKS], at, out);
        if (results) at = move_ints(s->peak_cell + block, n[r][BLOCKS], at, out);
        cell += n[r][CELLS];
        block += n[r][BLOCKS];
        before += n[r][FACES];
    }
}

void bed_deal_states(struct bed *b) {
    struct bed_deal *d = b->deal;
    const int variables = b->components + 2;
    if (!d) return;
    b->set.balanced = b->home->balanced;
    const struct per friction = of_friction(b, false);
    move_all(b, b->home, d->face, false, d->message_out, true);
    send(b, d->message_out,
         &(struct per){{[CELLS] = 2 * variables + friction.of[CELLS],
                        [FACES] = (b->set.balanced ? 2 : 0) + friction.of[FACES],
                        [OUTER] = 2 * variables + 1}},
         false);
    move_all(b, &b->set, NULL, false, d->message_in, false);
}

void bed_deal_results(struct bed *b) {
    struct bed_deal *d = b->deal;
    const int variables = b->components + 2;
    if (!d) return;
    const struct per friction = of_friction(b, true);
    move_all(b, &b->set, NULL, true, d->message_out, true);
    send(b, d->message_out,
         &(struct per){{[CELLS] = variables + friction.of[CELLS],
                        [FACES] = friction.of[FACES] + b->carries,
                        [OUTER] = variables,
                        [BLOCKS] = RESULTS}},
         true);
    move_all(b, b->home, d->face, true, d->message_in, false);
}

void bed_deal_pushed(struct bed *b) {
    struct bed_deal *d = b->deal;
    if (!d) return;
    memcpy(d->message_out, b->set.pushed, (size_t)b->set.blocks * sizeof(double));
    send(b, d->message_out, &(struct per){{[BLOCKS] = 1}}, true);
    memcpy(b->home->pushed, d->message_in, (size_t)b->home->blocks * sizeof(double));
}
