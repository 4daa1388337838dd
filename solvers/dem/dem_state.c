/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads the state of a run of soft grains (dem_state.h). */
#include "solvers/dem/dem_state.h"

#include "solvers/grains/grains_state.h"

#include <string.h>

enum { VERSION = 1 };
struct soft_head { /* sizes that tell how long the rest is */
    char name[8];
    uint64_t order; /* order of bytes */
    int32_t version, n, nold, mark;
    int64_t nsums;
};
static struct soft_head head_of(const struct dem_state *s) {
    return (struct soft_head){"soft",  0x0102030405060708,           VERSION,          s->n,
                              s->nold, sizeof(struct averages_mark), s->averages.nsums};
}

void dem_state_law(const struct dem_law *law, double out[DEM_LAW]) {
    const struct dem_walls *w = law->walls;
    const struct sources *g = law->gravity;
    int n = 0;
    memset(out, 0, DEM_LAW * sizeof *out);
    out[n++] = law->diameter;
    out[n++] = law->mass;
    for (int k = 0; k < 3; k++) {
        out[n++] = w->low[k];
        out[n++] = w->high[k];
        out[n++] = w->periodic[k];
        out[n++] = g->gravity[k];
    }
    out[n++] = g->amplitude;
    out[n++] = g->frequency;
    out[n++] = g->phase;
    out[n++] = w->n;
    for (int i = -1; i < w->n && n + 8 <= DEM_LAW; i++) {
        const struct contact_law *l = i < 0 ? &law->pair : &w->wall[i].law;
        out[n++] = l->k;
        out[n++] = l->eta;
        out[n++] = l->kt;
        out[n++] = l->chi;
        out[n++] = l->friction;
        for (int k = 0; i >= 0 && k < 3; k++) out[n++] = w->wall[i].velocity[k];
    }
}

status dem_state_write(const struct dem_state *s, const char *path, const char *location, bool compress,
                       struct file_sum *sum) {
    const struct foam_format binary = {.binary = true, .precision = 17};
    const struct soft_head head = head_of(s);
    struct sink *o;
    TRY(sink_open(path, compress, &o));
    foam_header_write(o, &binary, "grains", location, "softGrains", "the state of granularDEM, for restarts");
    sink_printf(o, "(");
    sink_write(o, &head, sizeof head);
    sink_write(o, &s->account, sizeof s->account);
    sink_write(o, s->law, sizeof s->law);
    sink_write(o, &s->averages.mark, sizeof s->averages.mark);
    sink_write(o, s->averages.grid, sizeof s->averages.grid);
    sink_write(o, s->id, (size_t)s->n * sizeof *s->id);
    for (int k = 0; k < 3; k++) sink_write(o, s->list[k], 3 * (size_t)s->n * sizeof(double));
    for (int k = 0; k < 2; k++) sink_write(o, s->averages.sums[k], (size_t)s->averages.nsums * sizeof(double));
    sink_printf(o, ")\n");
    return sink_close_sum(o, sum);
}

static status allocate_lists(struct dem_state *s) {
    TRY(pool_take(&s->pool, &s->id, s->n, sizeof *s->id, "grains"));
    for (int k = 0; k < 3; k++) TRY(pool_take(&s->pool, &s->list[k], 3L * s->n, sizeof(double), "grains"));
    for (int k = 0; k < 2; k++)
        TRY(pool_take(&s->pool, &s->averages.sums[k], s->averages.nsums, sizeof(double), "averages"));
    return OK;
}

static bool take_lists(struct bytes *b, struct dem_state *s) {
    bool ok = bytes_take(b, s->id, (size_t)s->n * sizeof *s->id);
    for (int k = 0; k < 3; k++) ok = ok && bytes_take(b, s->list[k], 3 * (size_t)s->n * sizeof(double));
    for (int k = 0; k < 2; k++)
        ok = ok && bytes_take(b, s->averages.sums[k], (size_t)s->averages.nsums * sizeof(double));
    for (int i = 0; ok && i < s->n; i++) ok = s->id[i] > (i ? s->id[i - 1] : 0) && s->id[i] <= s->nold;
    return ok && b->left == 2 && !memcmp(b->at, ")\n", 2);
}

static status parse(const struct source *source, struct bytes *b, void *out) {
    static const char cure[] = "start from another time, or remove it to start from lagrangian/grains or the fields";
    struct dem_state *s = out;
    struct soft_head head, here;
    if (!bytes_take(b, &head, sizeof head)) return fail(ERR_INPUT, "%s: it is cut; %s", source->path, cure);
    s->n = head.n;
    s->nold = head.nold;
    s->averages.nsums = head.nsums;
    here = head_of(s);
    if (memcmp(&head, &here, sizeof head))
        return fail(ERR_INPUT, "%s: it was written by another version, or a machine of other numbers; %s", source->path,
                    cure);
    const double bytes = 76. * head.n + 16. * (double)head.nsums;
    if (head.n < 0 || head.nold < head.n || head.nsums < 0 || bytes > (double)b->left ||
        !bytes_take(b, &s->account, sizeof s->account) || !bytes_take(b, s->law, sizeof s->law) ||
        !bytes_take(b, &s->averages.mark, sizeof s->averages.mark) ||
        !bytes_take(b, s->averages.grid, sizeof s->averages.grid))
        return fail(ERR_INPUT, "%s: it is cut; %s", source->path, cure);
    TRY(allocate_lists(s));
    if (!take_lists(b, s) || !averages_sound(&s->averages))
        return fail(ERR_INPUT, "%s: it is cut or damaged; %s", source->path, cure);
    return OK;
}

status dem_state_read(const char *path, struct dem_state *out) {
    *out = (struct dem_state){.n = 0};
    return state_read(path, parse, out);
}

void dem_state_free(struct dem_state *s) {
    pool_free(&s->pool);
    *s = (struct dem_state){.n = 0};
}
