/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses patches for function objects, and sums over their faces (functions_patches.h). */
#include "solvers/functions/functions_patches.h"

#include "solvers/dict/dict_parts.h"

#include <stdlib.h>
#include <string.h>

/* Why a patch has no faces that gas could touch; NULL: it has some. */
static const char *objection(const struct patch *p) {
    if (!strcmp(p->type, "empty")) return "is empty: nothing is solved across it";
    if (!strncmp(p->type, "cyclic", 6)) return "is cyclic: gas goes through it and does not leave";
    return NULL;
}

/* Takes the patches of a group; returns whether there are any. */
static bool take_group(const struct polymesh *m, const char *group, bool *takes) {
    bool found = false;
    for (int p = 0; p < m->npatches; p++) {
        if (!patch_in_group(&m->patch[p], group) || objection(&m->patch[p])) continue;
        takes[p] = found = true;
    }
    return found;
}

/* Takes the patches that a regular expression matches as a whole. */
static status take_pattern(const struct function *f, struct dict *d, const char *key, const char *word, bool *takes) {
    const struct polymesh *m = f->setup->mesh;
    const char *names[64];
    char why[128];
    regex_t pattern;
    int found = 0, closed = 0, n = 0;
    if (!pattern_compile(&pattern, word, why, sizeof why))
        return dict_fail(d, key, "'%s' is no regular expression: %s", word, why);
    for (int p = 0; p < m->npatches; p++) {
        if (n < 64) names[n++] = m->patch[p].name;
        if (regexec(&pattern, m->patch[p].name, 0, NULL, 0)) continue;
        takes[p] = !objection(&m->patch[p]);
        *(takes[p] ? &found : &closed) += 1;
    }
    regfree(&pattern);
    if (closed && !found) return dict_fail(d, key, "all patches that '%s' fits are empty or cyclic", word);
    return found ? OK : dict_unknown(d, key, word, names, n);
}

status patches_read(const struct function *f, struct dict *d, const char *key, struct patch_choice *out) {
    const struct polymesh *m = f->setup->mesh;
    const char *const *words;
    int n;
    TRY(pool_take(f->pool, &out->takes, m->npatches, sizeof *out->takes, "patches"));
    TRY(status_note(dict_words(d, key, &n, &words), "'%s' lists patches: (NAME ..)", key));
    if (!n) return dict_fail(d, key, "it is empty; give (NAME ..)");
    for (int i = 0; i < n; i++) {
        const int p = polymesh_find_patch(m, words[i]);
        const char *why = p < 0 ? NULL : objection(&m->patch[p]);
        if (why) return dict_fail(d, key, "patch '%s' %s; leave it out", words[i], why);
        if (p >= 0)
            out->takes[p] = true;
        else if (!take_group(m, words[i], out->takes))
            TRY(take_pattern(f, d, key, words[i], out->takes));
    }
    for (int p = 0; p < m->npatches; p++) out->n += out->takes[p];
    return OK;
}

status patches_follow(const struct function *f, double *dt) {
    struct medium *m = f->setup->medium;
    return m->type->follow(m, dt);
}

struct summing { /* context of sum_face */
    const struct patch_choice *choice;
    patch_adder *add;
    const void *context;
    double *sum;
};

static void sum_face(void *summing, const struct crossing *face) {
    const struct summing *s = summing;
    if (s->choice->takes[face->patch]) s->add(s->context, face, s->sum);
}

/* Adds the sums of all blocks in the order of their numbers, on the root; rows of `all` are a number and n sums. */
static status add_blocks(const struct grid *g, int n, const double *all, double out[PATCH_SUMS]) {
    int *place;
    TRY(allocate(&place, g->nblocks_all, sizeof *place, "sums of blocks"));
    for (int i = 0; i < g->nblocks_all; i++) place[(int)all[(long)i * (n + 1)]] = i;
    for (int b = 0; b < g->nblocks_all; b++)
        for (int k = 0; k < n; k++) out[k] += all[(long)place[b] * (n + 1) + 1 + k];
    free(place);
    return OK;
}

static status gather_sums(const struct grid *g, int n, const double *rows, double out[PATCH_SUMS]) {
    double *all = NULL;
    TRY(comm_gather(g->comm, rows, (long)g->nblocks * (n + 1), &all, NULL));
    const status s = comm_agree(g->comm, all ? add_blocks(g, n, all, out) : OK);
    free(all);
    TRY(s);
    comm_broadcast(g->comm, out, n * (long)sizeof *out);
    return OK;
}

status patches_sum(const struct function *f, const struct patch_choice *c, patch_adder *add, const void *context, int n,
                   double out[PATCH_SUMS]) {
    const struct grid *g = f->setup->grid;
    struct medium *m = f->setup->medium;
    double *rows = NULL;
    for (int k = 0; k < n; k++) out[k] = 0;
    TRY(comm_agree(g->comm, allocate(&rows, (long)(g->nblocks + 1) * (n + 1), sizeof *rows, "sums of blocks")));
    for (int b = 0; b < g->nblocks; b++) {
        double *row = rows + (long)b * (n + 1);
        row[0] = g->block[b].id;
        m->type->crossings(m, b, sum_face, &(struct summing){c, add, context, row + 1});
    }
    const status s = gather_sums(g, n, rows, out);
    free(rows);
    return s;
}

struct lever { /* context of add_force */
    const double *centre;
    const struct revolution *round;
    double pressure;
};

/* Makes of the force on a face of a body of revolution the one on its ring: it keeps the axial component, which acts on
 * the axis, and has a moment about the axis, which is returned. */
static double take_ring(const struct lever *l, const double place[3], double arm[3], double force[3]) {
    const struct revolution *r = l->round;
    const int third = 3 - r->axial - r->radial;
    const double swing = (place[r->radial] - r->at) * force[third];
    arm[r->radial] = r->at - l->centre[r->radial];
    force[r->radial] = force[third] = 0;
    return (r->axial + 1) % 3 == r->radial ? swing : -swing;
}

static void add_force(const void *lever, const struct crossing *face, double *sum) {
    const struct lever *l = lever;
    double arm[3], part[FORCE_PARTS][3];
    for (int k = 0; k < 3; k++) {
        arm[k] = face->centre[k] - l->centre[k];
        part[PRESSURE][k] = face->pressure[k] - l->pressure * face->area * face->normal[k];
        part[VISCOUS][k] = face->viscous[k];
    }
    for (int i = 0; i < FORCE_PARTS && l->round->on; i++)
        sum[6 + 3 * i + l->round->axial] += take_ring(l, face->centre, arm, part[i]);
    for (int i = 0; i < FORCE_PARTS; i++)
        for (int k = 0; k < 3; k++) {
            const int next = (k + 1) % 3, last = (k + 2) % 3;
            sum[3 * i + k] += part[i][k];
            sum[6 + 3 * i + k] += arm[next] * part[i][last] - arm[last] * part[i][next];
        }
}

status patches_force(const struct function *f, const struct patch_choice *c, const double centre[3], double pressure,
                     struct force *out) {
    double sum[PATCH_SUMS];
    TRY(patches_sum(f, c, add_force, &(struct lever){centre, &f->setup->mesh->round, pressure}, 12, sum));
    memcpy(out->force, sum, sizeof out->force);
    memcpy(out->moment, sum + 6, sizeof out->moment);
    return OK;
}
