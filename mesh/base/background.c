/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts threads and waits for them (background.h). */
#include "mesh/base/background.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { AT_A_TIME = 16, STACK_BYTES = 1 << 20 };

struct background {
    pthread_t thread;
    bool started;
    atomic_bool ended;
    void (*work)(void *context);
    void *context;
};

/* Starts a thread that no signal interrupts; returns whether there is one. */
static bool start_thread(pthread_t *thread, void *(*run)(void *), void *argument) {
    pthread_attr_t how;
    sigset_t all, before;
    sigfillset(&all);
    if (pthread_attr_init(&how)) return false;
    pthread_attr_setstacksize(&how, STACK_BYTES);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool started = !pthread_create(thread, &how, run, argument);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&how);
    return started;
}

static void *run_one(void *argument) {
    struct background *b = argument;
    b->work(b->context);
    atomic_store(&b->ended, true);
    return NULL;
}

status background_start(void (*work)(void *context), void *context, struct background **out) {
    TRY(allocate(out, 1, sizeof **out, "work in the background"));
    struct background *b = *out;
    b->work = work;
    b->context = context;
    atomic_init(&b->ended, false);
    b->started = start_thread(&b->thread, run_one, b);
    if (!b->started) run_one(b);
    return OK;
}

bool background_ended(const struct background *b) {
    return atomic_load(&b->ended);
}

void background_finish(struct background *b) {
    if (b->started) pthread_join(b->thread, NULL);
    free(b);
}

struct each {
    int n;
    void (*work)(void *context, int i);
    void *context;
    atomic_int next;
};

static void *run_some(void *argument) {
    struct each *e = argument;
    for (int i; (i = atomic_fetch_add(&e->next, 1)) < e->n;) e->work(e->context, i);
    return NULL;
}

void background_each(int n, void (*work)(void *context, int i), void *context) {
    struct each e = {.n = n, .work = work, .context = context};
    pthread_t thread[AT_A_TIME];
    int started = 0;
    atomic_init(&e.next, 0);
    while (started < AT_A_TIME && started < n - 1 && start_thread(&thread[started], run_some, &e)) started++;
    run_some(&e);
    while (started > 0) pthread_join(thread[--started], NULL);
}
