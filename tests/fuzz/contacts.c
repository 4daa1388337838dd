/* SPDX-License-Identifier: GPL-3.0-or-later */
/* constant/particleProperties with `grain` of constant/granularProperties, constant/g and shaking: contacts, walls,
 * kinds and coarse graining of soft and of hard grains, and the laws that follow from them. */
#include "solvers/grains/grains_models.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>

enum { PATCHES = 2 };

static void promise_number(double x, double low, double high, const char *text) {
    PROMISE(isfinite(x) && x >= low && x <= high, text);
}

/* Are numbers such that products of some of them are numbers, too? */
static bool is_tame(double x) {
    return x > 1e-30 && x < 1e30;
}

static void try_law(const struct contact_law *l, double diameter) {
    static const double part[] = {0, 1e-9, 1e-3, 0.1};
    promise_number(l->k, 1e-300, HUGE_VAL, "a contact has a spring");
    promise_number(l->eta, 0, HUGE_VAL, "a damper takes energy");
    promise_number(l->friction, 0, HUGE_VAL, "friction is not negative");
    promise_number(contact_time(l, 1), 1e-300, HUGE_VAL, "an impact has a duration");
    for (int i = 0; i < 4; i++) {
        const double overlap = part[i] * diameter;
        promise_number(contact_elastic(l, overlap), 0, HUGE_VAL, "springs hold energy");
        promise_number(contact_damper(l, overlap), 0, HUGE_VAL, "a damper takes energy");
        promise_number(contact_spring(l, overlap), 0, HUGE_VAL, "the spring along the tangent is one");
    }
}

static void try_soft(const struct grains_models *m) {
    const struct soft_contact *c = &m->contact;
    const double d = m->grain.diameter, stiff = c->type == CONTACT_HERTZ ? c->young : c->stiffness;
    promise_number(c->friction, 0, 1e3, "friction is in range");
    PROMISE((c->restitution >= 0.01 && c->restitution <= 1) != (c->dissipation >= 0),
            "either the restitution or the dissipation counts");
    PROMISE(m->fraction > 0 && m->fraction < 1. / 15, "a step is a part of an impact");
    if (!is_tame(d) || !is_tame(m->grain.mass) || !is_tame(stiff) || (c->kt > 0 && !is_tame(c->kt)) ||
        (c->dissipation > 0 && !is_tame(c->dissipation)))
        return;
    const struct contact_law pair = contact_pair(c, d, m->grain.mass);
    try_law(&pair, d);
    for (int p = 0; p < PATCHES; p++) {
        const double e = m->restitution[p], mu = m->friction[p];
        const struct contact_law wall = contact_wall(c, d, m->grain.mass, e >= 0 ? e : c->restitution, fmax(mu, 0));
        try_law(&wall, d);
    }
}

static void try_models(struct grains_models *m) {
    const struct grain_kinds *k = &m->kinds;
    double sum = 0;
    promise_number(m->grain.diameter, 0, HUGE_VAL, "grains have a size");
    promise_number(m->grain.mass, 0, HUGE_VAL, "grains have a mass");
    promise_number(m->width, 0, HUGE_VAL, "coarse graining has a width");
    promise_number(m->window, 0, HUGE_VAL, "a window is no negative time");
    for (int a = 0; a < k->n; a++) {
        sum += m->share[a];
        promise_number(m->share[a], 0, 1, "a share is one");
        promise_number(k->size[a], 0, 1, "the first kind is the largest");
        promise_number(k->mass[a], 0, HUGE_VAL, "a kind has a mass");
        for (int b = 0; b < k->n; b++) {
            promise_number(k->restitution[a][b], 0, 1, "a restitution is one");
            PROMISE(k->restitution[a][b] == k->restitution[b][a], "impacts are the same for both");
        }
        for (int p = 0; p < PATCHES; p++) promise_number(m->inlet_share[p][a], 0, 1, "a share at an inlet is one");
    }
    PROMISE(!k->n || fabs(sum - 1) < 1e-9, "shares are all grains");
    grains_models_count(m, 1000);
    for (int a = 0; a < k->n; a++)
        PROMISE(k->first[a] >= 0 && k->first[a] <= k->first[a + 1] && k->first[a + 1] <= 1000,
                "kinds follow each other");
    if (m->soft) try_soft(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static char floor_name[] = "floor", lid[] = "lid", wall[] = "wall";
    static struct patch patch[PATCHES] = {{.name = floor_name, .type = wall}, {.name = lid, .type = wall}};
    static const int axis[3] = {0, 1, 2};
    const struct polymesh mesh = {.npatches = PATCHES, .patch = patch};
    const struct control control = {.end_time = 1, .write = {WRITE_RUN_TIME, 0.1, false}};
    char path[256];
    FILE *nowhere = fopen("/dev/null", "w");
    scratch_unpack("case", "constant/particleProperties", data, size);
    snprintf(path, sizeof path, "%s/case", scratch());
    for (int soft = 0; soft < 2; soft++)
        for (int dim = 2; dim <= 3; dim++) {
            struct grains_models *m;
            if (!accepted(grains_models_read(path, &mesh, dim, axis, &control, soft, &m))) continue;
            try_models(m);
            if (nowhere) grains_models_print(nowhere, m);
            grains_models_free(m);
        }
    if (nowhere) fclose(nowhere);
    scratch_clear();
    return 0;
}
