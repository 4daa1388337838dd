/* SPDX-License-Identifier: GPL-3.0-or-later */
/* system/controlDict and system/meshDict: what a dictionary's numbers and words are used for. */
#include "solvers/case/control.h"
#include "solvers/programs/meshrules.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>

static void try_trigger(const struct trigger *g, double t) {
    struct moment before = {.t = t, .step = 7, .cpu = 1, .clock = 1};
    struct moment now = {.t = t + 0.5, .step = 8, .cpu = 2, .clock = 3, .fields = true};
    double next = trigger_next(g, t);
    PROMISE(next > t, "what is due next lies ahead");
    (void)trigger_due(g, &before, &now);
}

static void try_control(const struct control *c) {
    const double times[] = {0, 1, 1e9, isfinite(c->start_time) ? c->start_time : -1};
    PROMISE(c->format.precision >= 1 && c->format.precision <= 17, "numbers have 1 to 17 digits");
    PROMISE(c->purge >= 0, "times kept are a number of them");
    for (int i = 0; i < 4; i++) {
        double end;
        enum dt_limit limit;
        double next = trigger_next(&c->write, times[i]);
        try_trigger(&c->write, times[i]);
        if (control_ended(c, times[i])) continue;
        double dt = control_step(c, times[i], i, 0.001, next, &end, &limit);
        PROMISE(dt > 0 && end >= times[i], "time goes on");
        PROMISE(dt_limit_name(limit), "a step has a reason");
    }
    struct trigger g;
    struct dict *one;
    for (int i = 0; c->functions && i < dict_count(c->functions) && i < 8; i++)
        if (accepted(dict_sub(c->functions, dict_key(c->functions, i), &one)) &&
            accepted(trigger_read(one, &c->write, true, &g)))
            try_trigger(&g, 0.25);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char dir[256];
    struct control *c;
    struct mesh_rules *r;
    scratch_unpack("case", "system/controlDict", data, size);
    snprintf(dir, sizeof dir, "%s/case", scratch());
    if (accepted(control_read(dir, "granularGas", &c))) {
        try_control(c);
        (void)accepted(dict_check_used(c->dict));
        control_free(c);
    }
    if (accepted(mesh_rules_read(dir, &r))) {
        for (int i = 0; i < r->n; i++) PROMISE(r->rule[i].patch && r->rule[i].type, "a rule has a patch and a type");
        mesh_rules_free(r);
    }
    scratch_clear();
    return 0;
}
