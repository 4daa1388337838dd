/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The deal of a bed. A bed lies where gravity puts it, perhaps in the tiles of one rank. So its blocks are dealt to all
 * ranks by the number of their cells, whoever owns the cells of the mesh: each rank is home to the cells of its own
 * mesh, and works on those that it is dealt, which are a bed of their own with ghosts of their own. All get alike
 * many: the stages of the rest and the bed's step have sums of all ranks between them, so that a rank that has less of
 * the one cannot make up for it in the other. Lists go out from home when the set has changed, states in every step;
 * results come back. As blocks stay whole the bits of a step do not depend on the deal. A face between the cells of two
 * homes is there twice, also if one rank works on both cells. Homes write the lists behind the first stage, and send
 * them after the last: the home of a bed has more to list and less to do in the stages, and so nobody waits in between.
 */
#include "libcore/acoustics/bed_private.h"
#include "libcore/multigrid/room.h"

#include <stdlib.h>

/* What is sent: cells, entries of face_of_cell, faces, those of them that are not BED_INNER, blocks. */
enum { CELLS, ENTRIES, FACES, OUTER, BLOCKS, COUNTS };
enum { RESULTS = 4 }; /* numbers of each block that come back */

struct bed_deal {
    struct bed worker;                 /* the cells that this rank is dealt */
    int *cell_first;                   /* [ranks + 1] numbers of the homes' first cells over all ranks */
    int *work_first;                   /* [ranks + 1] numbers of the first cells that each rank works on */
    int *scratch;                      /* [ranks] */
    int *block_count, *block_first;    /* [ranks], [ranks + 1] blocks of the homes */
    int *count_out, *count_in;         /* [ranks] lengths of messages */
    int (*out)[COUNTS], (*in)[COUNTS]; /* [ranks] what this home deals to each rank; what each home deals here */
    int *size, *number, *rank;         /* [blocks of all ranks] cells, number, who works on it */
    int *face;                         /* [sum of out[FACES]] this home's faces in the order in which they go out */
    int *lists_out, *lists_in;         /* what goes out of the lists, and what comes in */
    double *geometry;                  /* what goes out of the shapes, unless cells are boxes */
    const double *ghost;               /* [ghosts] numbers of this home's ghosts; NULL: no lists wait to be written */
    bool written;                      /* are there lists that have not been sent? */
    status failed;                     /* the error because of which they could not be written */
    double *message_out, *message_in;  /* of a step */
    struct bed_shapes shapes;          /* of worker, unless cells are boxes: a shape for each cell and each face */
    int *places;                       /* scratch of list_out */
    struct room room;                  /* the memory of a set of cells */
};

static int sum_of(const struct bed *b, int (*count)[COUNTS], int what) {
    int sum = 0;
    for (int r = 0; r < comm_size(b->comm); r++) sum += count[r][what];
    return sum;
}

void bed_deal_free(struct bed_deal *d) {
    if (!d) return;
    room_free(&d->room);
    status_free(d->failed);
    bed_free(&d->worker);
    free(d->cell_first);
    free(d->out);
    free(d);
}

status bed_deal_make(struct bed *b) {
    const int ranks = comm_size(b->comm);
    struct bed_deal *d;
    TRY(allocate(&d, 1, sizeof *d, "the bed"));
    d->worker = *b;
    d->worker.lines = NULL;
    b->deal = d;
    TRY(allocate(&d->cell_first, 7L * ranks + 3, sizeof(int), "the bed"));
    d->work_first = d->cell_first + ranks + 1;
    d->block_first = d->work_first + ranks + 1;
    d->scratch = d->block_first + ranks + 1;
    d->block_count = d->scratch + ranks;
    d->count_out = d->block_count + ranks;
    d->count_in = d->count_out + ranks;
    TRY(allocate(&d->out, 2L * ranks, sizeof *d->out, "the bed"));
    d->in = d->out + ranks;
    TRY(allocate(&d->worker.lines, 1, sizeof *d->worker.lines, "the bed"));
    return multigrid_make(b->comm, &d->worker.multigrid);
}

status bed_number(struct bed *b, int cells, long *first) {
    *first = 0;
    if (!b->deal) return OK;
    TRY(comm_share_count(b->comm, cells, b->deal->scratch, b->deal->cell_first));
    *first = b->deal->cell_first[comm_rank(b->comm)];
    return OK;
}

/* ---- the lists ---- */

/* Learns of the blocks of all ranks. */
static status share_blocks(struct bed *b) {
    struct bed_deal *d = b->deal;
    TRY(comm_share_count(b->comm, b->blocks, d->block_count, d->block_first));
    const int blocks = d->block_first[comm_size(b->comm)];
    TRY(comm_agree(b->comm, ROOM_GROW(&d->room, d->size, 3L * blocks + 1)));
    d->number = d->size + blocks;
    d->rank = d->number + blocks;
    for (int i = 0; i < b->blocks; i++) d->rank[i] = b->first[i + 1] - b->first[i];
    comm_share_int(b->comm, d->rank, d->block_count, d->block_first, d->size);
    comm_share_int(b->comm, b->number, d->block_count, d->block_first, d->number);
    return OK;
}

/* Deals the blocks of all ranks in the order of their homes, each to the rank in whose part of all cells its middle
 * lies. */
static void deal_blocks(struct bed *b) {
    struct bed_deal *d = b->deal;
    const int ranks = comm_size(b->comm);
    const double part = (double)d->cell_first[ranks] / ranks;
    int r = 0, before = 0;
    d->work_first[0] = 0;
    for (int j = 0; j < d->block_first[ranks]; before += d->size[j++]) {
        while (r < ranks - 1 && before + 0.5 * d->size[j] > (r + 1) * part) d->work_first[++r] = before;
        d->rank[j] = r;
    }
    while (r < ranks) d->work_first[++r] = before;
}

/* Lists the faces that go out, each once for every rank that works on one of its cells, and counts what goes out.
 * place[faces]: place of each face among those that its last rank gets. entry[entries]: face_of_cell by these. */
static void list_out(struct bed *b, int *place, int *entry) {
    struct bed_deal *d = b->deal;
    const int first = d->block_first[comm_rank(b->comm)];
    int *rank = place + b->faces, faces = 0;
    memset(d->out, 0, (size_t)comm_size(b->comm) * sizeof *d->out);
    for (int f = 0; f < b->faces; f++) rank[f] = -1;
    for (int block = 0; block < b->blocks; block++) {
        const int to = d->rank[first + block], begin = b->face_start[b->first[block]];
        int *count = d->out[to];
        count[BLOCKS]++;
        count[CELLS] += b->first[block + 1] - b->first[block];
        for (int j = begin; j < b->face_start[b->first[block + 1]]; j++) {
            const struct bed_side s = bed_side(b, j);
            count[ENTRIES]++;
            if (rank[s.face] != to) {
                rank[s.face] = to;
                place[s.face] = count[FACES]++;
                d->face[faces++] = s.face;
                count[OUTER] += b->kind[s.face] != BED_INNER;
            }
            entry[j] = s.right ? ~place[s.face] : place[s.face];
        }
    }
}

/* Copies n numbers from a line to a message, or back; returns the place behind them in the message. */
static double *move(double *line, long n, double *message, bool out) {
    memcpy(out ? message : line, out ? line : message, (size_t)n * sizeof *line);
    return message + n;
}

/* Numbers of a message for each thing. */
struct per {
    int of[COUNTS];
};

/* Counts what goes from home to those who work on it, or back, per.of[what] numbers of each thing. */
static void count(const struct bed *b, const struct per *per, bool back) {
    const struct bed_deal *d = b->deal;
    for (int r = 0; r < comm_size(b->comm); r++) {
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
    return (struct per){{[CELLS] = 1, [FACES] = 3 + 3 * b->dim}};
}

/* Returns how many numbers go out, or come in. */
static long sum_all(const struct bed *b, const struct per *per, int (*n)[COUNTS]) {
    long sum = 0;
    for (int k = 0; k < COUNTS; k++) sum += (long)per->of[k] * sum_of(b, n, k);
    return sum;
}

/* Calls the lines of the geometry of a face one after the other: 3 + 3 dim. */
static int face_lines(const struct bed_shapes *s, int dim, double *line[3 + 3 * MAX_DIM]) {
    int n = 0;
    line[n++] = s->area;
    for (int side = 0; side < 2; side++) line[n++] = s->depth[side];
    for (int k = 0; k < dim; k++) {
        line[n++] = s->normal[k];
        for (int side = 0; side < 2; side++) line[n++] = s->arm[side][k];
    }
    return n;
}

static int *write_face(const struct bed *b, int face, int *to) {
    const int side[2] = {b->left[face], b->right[face]}, first = b->deal->cell_first[comm_rank(b->comm)];
    for (int i = 0; i < 2; i++)
        *to++ = side[i] < 0 ? -1 : side[i] < b->cells ? first + side[i] : (int)b->deal->ghost[side[i] - b->cells];
    *to++ = b->kind[face];
    *to++ = b->shape[face];
    return to;
}

static void write_lists(const struct bed *b, const int *entry) {
    const struct bed_deal *d = b->deal;
    const int *face = d->face;
    int *to = d->lists_out;
    for (int r = 0, cell = 0; r < comm_size(b->comm); r++) {
        const int end = cell + d->out[r][CELLS], entries = b->face_start[end] - b->face_start[cell];
        for (int i = cell; i < end; i++) *to++ = b->face_start[i + 1] - b->face_start[i];
        memcpy(to, entry + b->face_start[cell], (size_t)entries * sizeof *to);
        to += entries;
        for (int k = 0; k < d->out[r][FACES]; k++) to = write_face(b, *face++, to);
        cell = end;
    }
}

static void write_geometry(const struct bed *b) {
    const struct bed_deal *d = b->deal;
    const int *face = d->face;
    double *line[3 + 3 * MAX_DIM], *to = d->geometry;
    const int lines = face_lines(b->shapes, b->dim, line);
    for (int r = 0, cell = 0; r < comm_size(b->comm); r++) {
        for (const int end = cell + d->out[r][CELLS]; cell < end; cell++) *to++ = b->shapes->volume[b->body[cell]];
        for (int k = 0; k < d->out[r][FACES]; k++, face++)
            for (int i = 0; i < lines; i++) *to++ = line[i][b->shape[*face]];
    }
}

/* Counts the ends of faces that are cells of other ranks. */
static int count_ghosts(const struct bed *b) {
    const struct bed_deal *d = b->deal;
    const int me = comm_rank(b->comm), low = d->work_first[me], high = d->work_first[me + 1];
    const int *from = d->lists_in;
    int ghosts = 0;
    for (int r = 0; r < comm_size(b->comm); r++) {
        from += d->in[r][CELLS] + d->in[r][ENTRIES];
        for (int k = 0; k < d->in[r][FACES]; k++, from += of_lists.of[FACES])
            for (int i = 0; i < 2; i++) ghosts += from[i] >= 0 && (from[i] < low || from[i] >= high);
    }
    return ghosts;
}

/* Makes the shapes of the worker's cells and faces. */
static status make_geometry(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    const long cells = (long)w->cells + w->ghosts;
    double *next;
    w->shapes = b->shapes;
    w->balanced = b->balanced;
    if (b->shapes->boxes) return OK;
    w->shapes = &d->shapes;
    TRY(ROOM_GROW(&d->room, d->shapes.volume, cells + (3L + 3 * b->dim) * w->faces));
    next = d->shapes.volume + cells;
    d->shapes.area = next;
    for (int side = 0; side < 2; side++) d->shapes.depth[side] = next += w->faces;
    for (int k = 0; k < b->dim; k++) {
        d->shapes.normal[k] = next += w->faces;
        for (int side = 0; side < 2; side++) d->shapes.arm[side][k] = next += w->faces;
    }
    return OK;
}

/* Reads a face of the worker; each end that is a cell of another rank is a ghost of its own. number[ghosts]: their
 * numbers, of which `ghosts` are known. */
static const int *read_face(struct bed *w, const int range[2], int face, int *ghosts, double *number, const int *from) {
    int *const side[2] = {w->left + face, w->right + face};
    for (int i = 0; i < 2; i++) {
        const int name = *from++;
        *side[i] = name < 0 ? -1 : name - range[0];
        if (name < 0 || (name >= range[0] && name < range[1])) continue;
        number[*ghosts] = name;
        *side[i] = w->cells + (*ghosts)++;
    }
    w->kind[face] = (unsigned char)*from++;
    w->shape[face] = w->shapes->boxes ? *from : face;
    return from + 1;
}

static void read_lists(struct bed *b, double *number) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    const int *from = d->lists_in;
    int cell = 0, entry = 0, face = 0, ghosts = 0;
    for (int r = 0; r < comm_size(b->comm); r++) {
        const int end = cell + d->in[r][CELLS], last = entry + d->in[r][ENTRIES], before = face;
        for (int at = entry; cell < end; cell++) {
            w->face_start[cell] = at;
            at += *from++;
        }
        for (; entry < last; entry++) {
            const int at = *from++;
            w->face_of_cell[entry] = at < 0 ? ~(before + ~at) : before + at;
        }
        for (; face < before + d->in[r][FACES]; face++)
            from = read_face(w, d->work_first + comm_rank(b->comm), face, &ghosts, number, from);
    }
    w->face_start[cell] = entry;
    for (int i = 0; i < w->cells + w->ghosts; i++) w->body[i] = b->shapes->boxes ? 0 : i;
}

static void read_geometry(struct bed *b) {
    struct bed_deal *d = b->deal;
    const double *from = d->message_in;
    double *line[3 + 3 * MAX_DIM];
    const int lines = face_lines(&d->shapes, b->dim, line);
    for (int r = 0, cell = 0, face = 0; r < comm_size(b->comm); r++) {
        for (const int end = cell + d->in[r][CELLS]; cell < end; cell++) d->shapes.volume[cell] = *from++;
        for (const int end = face + d->in[r][FACES]; face < end; face++)
            for (int i = 0; i < lines; i++) line[i][face] = *from++;
    }
}

static void read_blocks(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    const int me = comm_rank(b->comm);
    int n = 0;
    w->first[0] = 0;
    for (int j = 0; j < d->block_first[comm_size(b->comm)]; j++) {
        if (d->rank[j] != me) continue;
        w->number[n++] = d->number[j];
        w->first[n] = w->first[n - 1] + d->size[j];
    }
}

/* Makes room for messages: those of geometry, of states and of results. */
static status make_messages(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct per most = of_geometry(b);
    most.of[CELLS] = 2 * (b->components + 2);
    most.of[OUTER] = 2 * (b->components + 2) + 1;
    most.of[BLOCKS] = RESULTS;
    const long all = sum_all(b, &most, d->out) + sum_all(b, &most, d->in);
    TRY(ROOM_GROW(&d->room, d->message_out, 2 * all));
    d->message_in = d->message_out + all;
    return ROOM_GROW(&d->room, d->lists_in, sum_all(b, &of_lists, d->in));
}

static status make_lists(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    TRY(bed_size(w, sum_of(b, d->in, BLOCKS), sum_of(b, d->in, CELLS), count_ghosts(b), sum_of(b, d->in, FACES),
                 sum_of(b, d->in, ENTRIES)));
    return make_geometry(b);
}

static status write_here(struct bed *b) {
    struct bed_deal *d = b->deal;
    const long sides = b->face_start[b->cells];
    const struct per shapes = of_geometry(b);
    TRY(ROOM_GROW(&d->room, d->face, 2 * sides));
    TRY(ROOM_GROW(&d->room, d->places, 2L * b->faces + sides));
    int *const entry = d->places + 2 * b->faces;
    list_out(b, d->places, entry);
    const long numbers = b->shapes->boxes ? 0 : sum_all(b, &shapes, d->out), ints = sum_all(b, &of_lists, d->out);
    TRY(ROOM_GROW(&d->room, d->geometry, numbers + (ints + 1) / 2));
    d->lists_out = (int *)(d->geometry + numbers);
    write_lists(b, entry);
    if (!b->shapes->boxes) write_geometry(b);
    return OK;
}

void bed_link(struct bed *b, const double *number) {
    if (b->deal) b->deal->ghost = number;
}

void bed_write(struct bed *b) {
    struct bed_deal *d = b->deal;
    if (!d || !d->ghost) return;
    status_free(d->failed);
    d->failed = write_here(b);
    d->ghost = NULL;
    d->written = true;
}

/* Sends what bed_write has written, and makes the worker's lists of it. */
static status deal_out(struct bed *b) {
    struct bed_deal *d = b->deal;
    const status failed = d->failed;
    d->failed = OK;
    TRY(comm_agree(b->comm, failed));
    for (int r = 0; r < comm_size(b->comm); r++) d->count_out[r] = d->count_in[r] = COUNTS;
    comm_trade_int(b->comm, d->out[0], d->count_out, d->in[0], d->count_in);
    TRY(comm_agree(b->comm, make_messages(b)));
    count(b, &of_lists, false);
    comm_trade_int(b->comm, d->lists_out, d->count_out, d->lists_in, d->count_in);
    TRY(comm_agree(b->comm, make_lists(b)));
    read_blocks(b);
    read_lists(b, d->worker.U[0]);
    TRY(bed_halo_link(&d->worker, d->work_first, d->worker.U[0]));
    if (!b->shapes->boxes) {
        const struct per shapes = of_geometry(b);
        send(b, d->geometry, &shapes, false);
        read_geometry(b);
        bed_fill(&d->worker, 1, &d->shapes.volume);
    }
    d->written = false;
    return OK;
}

status bed_meet(struct bed *b) {
    if (!b->deal) return OK;
    TRY(share_blocks(b));
    deal_blocks(b);
    return OK;
}

/* ---- states and results ---- */

/* Moves what a step starts from, or its results, between a message and a bed: that of home, whose faces `face` lists,
 * or the worker's, face NULL. n: what goes to, or comes from, each rank. */
static void move_all(struct bed *b, int (*n)[COUNTS], const int *face, bool results, double *at, bool out) {
    const int last = b->components + 1;
    for (int r = 0, cell = 0, block = 0, before = 0; r < comm_size(b->comm); r++) {
        for (int v = 0; v <= last; v++) at = move(b->U[v] + cell, n[r][CELLS], at, out);
        for (int v = 0; v <= last && !results; v++) at = move(b->start[v] + cell, n[r][CELLS], at, out);
        for (int i = before; i < before + n[r][FACES]; i++) {
            const int f = face ? face[i] : i;
            for (int side = 0; side < 2 && b->balanced && !results; side++) at = move(b->balance[side] + f, 1, at, out);
            if (b->kind[f] == BED_INNER) continue;
            double kind = b->kind[f];
            if (!results) at = move(&kind, 1, at, out);
            b->kind[f] = (unsigned char)kind;
            for (int v = 0; v <= last && !results; v++) at = move(b->outside[v] + f, 1, at, out);
            for (int v = 0; v <= last; v++) at = move(b->kept[v] + f, 1, at, out);
        }
        double *const line[RESULTS] = {b->lift, b->work, b->peak, b->peak_cell};
        for (int i = 0; i < RESULTS && results; i++) at = move(line[i] + block, n[r][BLOCKS], at, out);
        cell += n[r][CELLS];
        block += n[r][BLOCKS];
        before += n[r][FACES];
    }
}

/* Takes the results home, where the fluxes through faces go to the lines of `kept`. */
static void take_results(struct bed *b) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    const int variables = b->components + 2;
    for (int f = 0; f < w->faces; f++) {
        double flux[MAX_VAR];
        if (w->kind[f] == BED_INNER) continue;
        bed_face_flux(w, f, flux);
        for (int v = 0; v < variables; v++) w->kept[v][f] = flux[v];
    }
    move_all(w, d->in, NULL, true, d->message_out, true);
    send(b, d->message_out, &(struct per){{[CELLS] = variables, [OUTER] = variables, [BLOCKS] = RESULTS}}, true);
    move_all(b, d->out, d->face, true, d->message_in, false);
}

status bed_deal_step(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done) {
    struct bed_deal *d = b->deal;
    struct bed *w = &d->worker;
    const int variables = b->components + 2;
    const struct per per = {{[CELLS] = 2 * variables, [FACES] = b->balanced ? 2 : 0, [OUTER] = 2 * variables + 1}};
    bed_write(b);
    if (d->written) TRY(deal_out(b));
    w->balanced = b->balanced;
    move_all(b, d->out, d->face, false, d->message_out, true);
    send(b, d->message_out, &per, false);
    move_all(w, d->in, NULL, false, d->message_in, false);
    TRY(bed_step(w, dt, gravity, done));
    b->newton = w->newton;
    b->linear = w->linear;
    b->lifted = w->lifted;
    b->worked = w->worked;
    b->blur = w->blur;
    if (*done) take_results(b);
    return OK;
}

void bed_deal_push(struct bed *b, double dt, const double gravity[MAX_DIM], int axis) {
    struct bed_deal *d = b->deal;
    bed_push(&d->worker, dt, gravity, axis);
    memcpy(d->message_out, d->worker.pushed, (size_t)d->worker.blocks * sizeof(double));
    send(b, d->message_out, &(struct per){{[BLOCKS] = 1}}, true);
    memcpy(b->pushed, d->message_in, (size_t)b->blocks * sizeof(double));
}
