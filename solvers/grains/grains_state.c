/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads the exact state of a run of grains as binary numbers behind a head that says their sizes
 * (grains_state.h). */
#include "solvers/grains/grains_state.h"

#include <stdlib.h>
#include <string.h>

enum { VERSION = 2, BOX = 24, LAW = 8 };
struct head { /* the head: sizes that tell how long the rest is */
    char name[8];
    uint64_t order; /* order of bytes */
    int32_t version, n;
    int64_t nsums;
    int64_t size[4]; /* bytes of a grain, an event, the counts, the mark */
};
static struct head head_of(const struct grains_state *s) {
    return (struct head){.name = "grains",
                         .order = 0x0102030405060708,
                         .version = VERSION,
                         .n = s->n,
                         .nsums = s->averages.nsums,
                         .size = {sizeof(struct grain), sizeof(struct grain_event), sizeof(struct grain_counts),
                                  sizeof(struct averages_mark)}};
}

void grains_state_walls(const struct grain_box *b, double out[3]) {
    uint32_t sum = 2166136261u; /* FNV-1a */
    out[0] = out[1] = out[2] = 0;
    if (b->shear != 0) {
        out[0] = 1;
        out[1] = b->shear;
        out[2] = -1;
    }
    if (!b->facets) return;
    const size_t bytes = (size_t)b->facets->space.walls * sizeof(double);
    for (size_t i = 0; i < bytes; i++) sum = (sum ^ ((const unsigned char *)b->wall_restitution)[i]) * 16777619u;
    const size_t more = b->rough ? (size_t)b->facets->space.walls * sizeof *b->rough : 0;
    for (size_t i = 0; i < more; i++) sum = (sum ^ ((const unsigned char *)b->rough)[i]) * 16777619u;
    out[0] = (b->fed ? 3. : b->facets->opens ? 2. : 1.) * b->facets->space.walls;
    out[1] = (double)b->facets->sum;
    out[2] = sum;
}

static void box_numbers(const struct grain_box *b, double v[BOX]) {
    int n = 0;
    v[n++] = b->dim;
    for (int k = 0; k < 3; k++) {
        v[n++] = b->low[k];
        v[n++] = b->high[k];
        v[n++] = b->periodic[k];
        v[n++] = b->restitution[k][0];
        v[n++] = b->restitution[k][1];
        v[n++] = b->shake[k];
    }
    v[n++] = b->omega;
    v[n++] = b->phase;
    grains_state_walls(b, v + n);
}
static void numbers_box(const double v[BOX], struct grain_box *b) {
    int n = 0;
    *b = (struct grain_box){.dim = v[0] == 2 ? 2 : v[0] == 3 ? 3 : 0};
    n++;
    for (int k = 0; k < 3; k++) {
        b->low[k] = v[n++];
        b->high[k] = v[n++];
        b->periodic[k] = v[n++] != 0;
        b->restitution[k][0] = v[n++];
        b->restitution[k][1] = v[n++];
        b->shake[k] = v[n++];
    }
    b->omega = v[n++];
    b->phase = v[n++];
}
static void law_numbers(const struct grain_law *l, double v[LAW]) {
    const double numbers[LAW] = {l->diameter,  l->growth,     l->mass,       l->restitution,
                                 l->threshold, l->gravity[0], l->gravity[1], l->gravity[2]};
    memcpy(v, numbers, sizeof numbers);
}
static void numbers_law(const double v[LAW], struct grain_law *l) {
    *l = (struct grain_law){.diameter = v[0],
                            .growth = v[1],
                            .mass = v[2],
                            .restitution = v[3],
                            .threshold = v[4],
                            .gravity = {v[5], v[6], v[7]}};
}
bool grains_state_same(const struct grains_state *s, const struct grain_box *box, const struct grain_law *law) {
    double was[BOX + LAW], is[BOX + LAW];
    box_numbers(&s->box, was);
    memcpy(was + BOX - 3, s->walls, sizeof s->walls);
    law_numbers(&s->law, was + BOX);
    box_numbers(box, is);
    law_numbers(law, is + BOX);
    for (int i = 0; i < BOX + LAW; i++)
        if (was[i] != is[i]) return false;
    return !memcmp(&s->law.kinds, &law->kinds, sizeof law->kinds);
}

status grains_state_write(const struct grains_state *s, const char *path, const char *location, bool compress,
                          struct file_sum *sum) {
    const struct foam_format binary = {.binary = true, .precision = 17};
    const struct head head = head_of(s);
    const size_t n = (size_t)s->n;
    double box[BOX], law[LAW];
    struct sink *o;
    box_numbers(&s->box, box);
    memcpy(box + BOX - 3, s->walls, sizeof s->walls);
    law_numbers(&s->law, law);
    TRY(sink_open(path, compress, &o));
    foam_header_write(o, &binary, "grains", location, "grains", "the exact state of granularMD, for restarts");
    sink_printf(o, "(");
    sink_write(o, &head, sizeof head);
    sink_write(o, box, sizeof box);
    sink_write(o, law, sizeof law);
    sink_write(o, &s->t, sizeof s->t);
    sink_write(o, &s->energy, sizeof s->energy);
    sink_write(o, &s->counts, sizeof s->counts);
    sink_write(o, &s->averages.mark, sizeof s->averages.mark);
    sink_write(o, s->averages.grid, sizeof s->averages.grid);
    sink_write(o, s->grain, n * sizeof *s->grain);
    sink_write(o, s->event, n * sizeof *s->event);
    sink_write(o, s->id, n * sizeof *s->id);
    for (int k = 0; k < 2; k++) sink_write(o, s->averages.sums[k], (size_t)s->averages.nsums * sizeof(double));
    if (s->walls[0] > 0) sink_write(o, s->impulse, (size_t)s->walls[0] * sizeof *s->impulse);
    if (s->fed) sink_write(o, &s->inflow, sizeof s->inflow);
    if (s->law.kinds.n) {
        sink_write(o, &s->law.kinds, sizeof s->law.kinds);
        sink_write(o, s->kind, n * sizeof *s->kind);
    }
    sink_printf(o, ")\n");
    return sink_close_sum(o, sum);
}

static bool take_numbers(struct bytes *b, struct grains_state *s) {
    double box[BOX], law[LAW];
    if (!bytes_take(b, box, sizeof box) || !bytes_take(b, law, sizeof law) || !bytes_take(b, &s->t, sizeof s->t) ||
        !bytes_take(b, &s->energy, sizeof s->energy) || !bytes_take(b, &s->counts, sizeof s->counts) ||
        !bytes_take(b, &s->averages.mark, sizeof s->averages.mark) ||
        !bytes_take(b, s->averages.grid, sizeof s->averages.grid))
        return false;
    numbers_box(box, &s->box);
    memcpy(s->walls, box + BOX - 3, sizeof s->walls);
    numbers_law(law, &s->law);
    return true;
}

/* Takes what stands behind the lists: of grains that come in, and of a mixture. */
static bool take_more(struct bytes *b, struct grains_state *s) {
    const size_t kinds = sizeof s->law.kinds + (size_t)s->n * sizeof *s->kind;
    s->fed = b->left == 2 + sizeof s->inflow || b->left == 2 + sizeof s->inflow + kinds;
    if (s->fed && !bytes_take(b, &s->inflow, sizeof s->inflow)) return false;
    if (b->left == 2) return true;
    return bytes_take(b, &s->law.kinds, sizeof s->law.kinds) && bytes_take(b, s->kind, kinds - sizeof s->law.kinds);
}

static bool take_lists(struct bytes *b, struct grains_state *s) {
    const size_t n = (size_t)s->n, sums = (size_t)s->averages.nsums * sizeof(double);
    const size_t walls = (size_t)s->walls[0] * sizeof *s->impulse;
    return bytes_take(b, s->grain, n * sizeof *s->grain) && bytes_take(b, s->event, n * sizeof *s->event) &&
           bytes_take(b, s->id, n * sizeof *s->id) && bytes_take(b, s->averages.sums[0], sums) &&
           bytes_take(b, s->averages.sums[1], sums) && (walls == 0 || bytes_take(b, s->impulse, walls)) &&
           take_more(b, s) && b->left == 2 && !memcmp(b->at, ")\n", 2);
}

static status allocate_lists(struct grains_state *s) {
    TRY(pool_take(&s->pool, &s->grain, s->n, sizeof *s->grain, "grains"));
    TRY(pool_take(&s->pool, &s->event, s->n, sizeof *s->event, "events"));
    TRY(pool_take(&s->pool, &s->id, s->n, sizeof *s->id, "grains"));
    TRY(pool_take(&s->pool, &s->kind, s->n, sizeof *s->kind, "grains"));
    TRY(pool_take(&s->pool, &s->impulse, (long)s->walls[0], sizeof *s->impulse, "walls"));
    TRY(pool_take(&s->pool, &s->averages.sums[0], s->averages.nsums, sizeof(double), "averages"));
    return pool_take(&s->pool, &s->averages.sums[1], s->averages.nsums, sizeof(double), "averages");
}

/* Is the state sound: does each grain have a place of its own, and a partner that exists? */
static bool sound(const struct grains_state *s) {
    bool ok = s->box.dim == 2 || s->box.dim == 3;
    char *seen = calloc((size_t)s->n, 1);
    for (int i = 0; ok && seen && i < s->n; i++) {
        ok = s->id[i] >= 0 && s->id[i] < s->n && !seen[s->id[i]] && s->event[i].partner < s->n;
        if (ok) seen[s->id[i]] = 1;
    }
    free(seen);
    ok = ok && s->law.kinds.n >= 0 && s->law.kinds.n <= GRAIN_KINDS;
    for (int i = 0; ok && s->law.kinds.n && i < s->n; i++) ok = s->kind[i] < s->law.kinds.n;
    if (s->fed) ok = ok && s->inflow.next >= s->t && s->inflow.renewed <= s->t;
    return ok && averages_sound(&s->averages);
}

static status parse(const struct source *source, struct bytes *b, void *out) {
    static const char cure[] = "start from another time, or remove it to start from lagrangian/grains or the fields";
    struct grains_state *s = out;
    struct head head, here;
    if (!bytes_take(b, &head, sizeof head)) return fail(ERR_INPUT, "%s: it is cut; %s", source->path, cure);
    s->n = head.n;
    s->averages.nsums = head.nsums;
    here = head_of(s);
    if (memcmp(&head, &here, sizeof head))
        return fail(ERR_INPUT, "%s: it was written by another version, or a machine of other numbers; %s", source->path,
                    cure);
    const double bytes = 80. * head.n + 16. * (double)head.nsums;
    if (head.n < 1 || head.nsums < 0 || bytes > (double)b->left || !take_numbers(b, s) ||
        !(s->walls[0] >= 0 && s->walls[0] <= (double)b->left))
        return fail(ERR_INPUT, "%s: it is cut; %s", source->path, cure);
    TRY(allocate_lists(s));
    if (!take_lists(b, s) || !sound(s)) return fail(ERR_INPUT, "%s: it is cut or damaged; %s", source->path, cure);
    return OK;
}

static status parse_source(const struct source *source, state_parser *take, void *out) {
    struct lexer l = lexer_start(source);
    struct foam_header h;
    TRY(foam_header_read(&l, &h));
    TRY(lexer_expect(&l, '('));
    struct bytes b = {source->text + l.position, source->size - l.position};
    return take(source, &b, out);
}

status state_read(const char *path, state_parser *take, void *out) {
    struct source *source = NULL;
    TRY(source_open(path, &source));
    const status e = parse_source(source, take, out);
    source_free(source);
    return e;
}

status grains_state_read(const char *path, struct grains_state *out) {
    *out = (struct grains_state){.n = 0};
    return state_read(path, parse, out);
}

void grains_state_free(struct grains_state *s) {
    pool_free(&s->pool);
    *s = (struct grains_state){.n = 0};
}
