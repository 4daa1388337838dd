#include "libcore/calendar.h"

#include <math.h>
#include <stdlib.h>

/* Bucket q holds the times with floor((t - origin)/width) = q. Those of q <= present are in the heap, those up to a
 * ring further in list q modulo the ring, all others in one list more, which is looked through once a round. As the
 * bucket of a time is a monotonic function of it also in floating point, the heap's first is the first of all. */
enum { LOAD = 1 /* times in a bucket that suit best */, LEAST = 16, NOWHERE = -1, HEAP = -1, FIRST = -2 };

struct item {
    double t;
    int32_t next;     /* in its list, or its place in the heap */
    int32_t previous; /* in its list; the first: FIRST - list; in the heap: HEAP */
};
struct calendar {
    int n, ring; /* ring: buckets, a power of two */
    double origin, per_width;
    int64_t present;
    int64_t loaded; /* into the heap in this round of the ring */
    int heaped;
    const char *array[2]; /* prefetched for the items of the next bucket */
    size_t stride[2];
    int32_t *first; /* [ring + 1] of each list */
    int32_t *heap;  /* [n] */
    struct item *item;
};

static int ring_size(int n) {
    int ring = LEAST;
    while (ring < n) ring *= 2;
    return ring;
}

status calendar_make(int n, struct calendar **out) {
    struct calendar *c;
    TRY(allocate(&c, 1, sizeof *c, "queue"));
    *c = (struct calendar){.n = n, .ring = ring_size(n)};
    status s = allocate(&c->first, c->ring + 1, sizeof *c->first, "queue");
    if (!s) s = allocate(&c->heap, n, sizeof *c->heap, "queue");
    if (!s) s = allocate(&c->item, n, sizeof *c->item, "queue");
    if (s) {
        calendar_free(c);
        return s;
    }
    for (int32_t i = 0; i < n; i++) c->item[i].t = HUGE_VAL;
    calendar_start(c, 0);
    *out = c;
    return OK;
}

void calendar_free(struct calendar *c) {
    if (!c) return;
    free(c->first);
    free(c->heap);
    free(c->item);
    free(c);
}

static inline bool earlier(const struct calendar *c, int32_t a, int32_t b) {
    double ta = c->item[a].t, tb = c->item[b].t;
    return ta < tb || (ta == tb && a < b);
}

static inline void heap_set(struct calendar *c, int place, int32_t i) {
    c->heap[place] = i;
    c->item[i].next = place;
}

static void heap_rise(struct calendar *c, int place, int32_t i) {
    while (place > 0) {
        int above = (place - 1) / 2;
        if (!earlier(c, i, c->heap[above])) break;
        heap_set(c, place, c->heap[above]);
        place = above;
    }
    heap_set(c, place, i);
}

static void heap_sink(struct calendar *c, int place, int32_t i) {
    for (;;) {
        int below = 2 * place + 1;
        if (below >= c->heaped) break;
        if (below + 1 < c->heaped && earlier(c, c->heap[below + 1], c->heap[below])) below++;
        if (!earlier(c, c->heap[below], i)) break;
        heap_set(c, place, c->heap[below]);
        place = below;
    }
    heap_set(c, place, i);
}

static void heap_settle(struct calendar *c, int place, int32_t i) {
    if (place > 0 && earlier(c, i, c->heap[(place - 1) / 2]))
        heap_rise(c, place, i);
    else
        heap_sink(c, place, i);
}

static void heap_add(struct calendar *c, int32_t i) {
    c->item[i].previous = HEAP;
    heap_rise(c, c->heaped++, i);
}

static void heap_remove(struct calendar *c, int32_t i) {
    int place = c->item[i].next;
    int32_t last = c->heap[--c->heaped];
    if (last != i) heap_settle(c, place, last);
}

/* The list of a time; NOWHERE: the heap */
static inline int32_t list_of(const struct calendar *c, double t) {
    double q = (t - c->origin) * c->per_width;
    if (!(q < (double)(c->present + c->ring))) return c->ring;
    if (q < (double)(c->present + 1)) return NOWHERE;
    return (int32_t)((int64_t)q & (c->ring - 1));
}

static inline void list_add(struct calendar *c, int32_t list, int32_t i) {
    int32_t next = c->first[list];
    c->item[i].next = next;
    c->item[i].previous = FIRST - list;
    if (next >= 0) c->item[next].previous = i;
    c->first[list] = i;
}

static inline void list_remove(struct calendar *c, int32_t i) {
    int32_t next = c->item[i].next, previous = c->item[i].previous;
    if (next >= 0) c->item[next].previous = previous;
    if (previous >= 0)
        c->item[previous].next = next;
    else
        c->first[FIRST - previous] = next;
}

static inline void insert(struct calendar *c, int32_t i) {
    int32_t list = list_of(c, c->item[i].t);
    if (list == NOWHERE)
        heap_add(c, i);
    else
        list_add(c, list, i);
}

/* Puts all items into new buckets of the given width, or of the smallest that time resolves. */
static void spread(struct calendar *c, double now, double width) {
    c->origin = now;
    c->per_width = 1 / fmax(width, fmax(4e-16 * fabs(now), 1e-290));
    c->present = c->loaded = 0;
    c->heaped = 0;
    for (int q = 0; q <= c->ring; q++) c->first[q] = NOWHERE;
    for (int32_t i = 0; i < c->n; i++) insert(c, i);
}

void calendar_set(struct calendar *c, int item, double t) {
    c->item[item].t = t;
}

void calendar_start(struct calendar *c, double now) {
    double mean = 0;
    int known = 0;
    for (int32_t i = 0; i < c->n; i++)
        if (c->item[i].t < HUGE_VAL) {
            mean += c->item[i].t - now;
            known++;
        }
    spread(c, now, known ? LOAD * mean / known / c->n : 1); /* n times that lie `mean` ahead come at the rate n/mean */
}

void calendar_move(struct calendar *c, int item, double t) {
    struct item *e = &c->item[item];
    e->t = t;
    int32_t list = list_of(c, t);
    if (e->previous == HEAP && list == NOWHERE) {
        heap_settle(c, e->next, item);
        return;
    }
    if (e->previous == HEAP)
        heap_remove(c, item);
    else
        list_remove(c, item);
    if (list == NOWHERE)
        heap_add(c, item);
    else
        list_add(c, list, item);
}

/* A round is over: buckets get another width when their load has changed much, else only the times that were beyond
 * the ring are looked through. */
static void next_round(struct calendar *c) {
    double width = 1 / c->per_width, load = (double)c->loaded / c->ring;
    if (load < LOAD / 2. || load > LOAD * 2.) {
        spread(c, c->origin + (double)c->present * width, width * fmin(LOAD / fmax(load, 1e-3), 1e3));
        return;
    }
    c->loaded = 0;
    int32_t i = c->first[c->ring];
    c->first[c->ring] = NOWHERE;
    while (i >= 0) {
        int32_t next = c->item[i].next;
        insert(c, i);
        i = next;
    }
}

/* All buckets of the ring were empty: goes on at the earliest of the times beyond it; false: all are never. */
static bool leap(struct calendar *c) {
    double t = HUGE_VAL;
    for (int32_t i = 0; i < c->n; i++) t = fmin(t, c->item[i].t);
    if (t == HUGE_VAL) return false;
    spread(c, t, 1 / c->per_width);
    return true;
}

/* Memory takes as long as an event: the next bucket's items and the first of the one after it are asked for now. */
static void prefetch(const struct calendar *c) {
    int32_t far = c->first[(c->present + 2) & (c->ring - 1)];
    if (far >= 0) __builtin_prefetch(&c->item[far], 1);
    for (int32_t i = c->first[(c->present + 1) & (c->ring - 1)]; i >= 0; i = c->item[i].next)
        for (int a = 0; a < 2 && c->array[a]; a++) __builtin_prefetch(c->array[a] + (size_t)i * c->stride[a], 1);
}

static void load_next(struct calendar *c) {
    c->present++;
    if ((c->present & (c->ring - 1)) == 0) next_round(c);
    int32_t list = (int32_t)(c->present & (c->ring - 1)), i = c->first[list];
    prefetch(c);
    c->first[list] = NOWHERE;
    while (i >= 0) {
        int32_t next = c->item[i].next;
        c->loaded++;
        heap_add(c, i);
        i = next;
    }
}

int calendar_first(struct calendar *c) {
    for (int empty = 0; c->heaped == 0; empty++) {
        if (empty > c->ring) {
            if (!leap(c)) return 0;
            empty = 0;
        }
        load_next(c);
    }
    return c->heap[0];
}

void calendar_attach(struct calendar *c, int which, const void *array, size_t stride) {
    c->array[which] = array;
    c->stride[which] = stride;
}

int calendar_second(const struct calendar *c) {
    if (c->heaped > 2) return c->heap[earlier(c, c->heap[2], c->heap[1]) ? 2 : 1];
    return c->heaped > 1 ? c->heap[1] : c->first[(c->present + 1) & (c->ring - 1)];
}

double calendar_time(const struct calendar *c, int item) {
    return c->item[item].t;
}

double calendar_bytes(int n) {
    return (double)n * (sizeof(struct item) + sizeof(int32_t)) + ((double)ring_size(n) + 1) * sizeof(int32_t);
}
