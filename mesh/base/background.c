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
    atomic_int next, threads;
};

/* Starts another thread if two pieces are left, and works. So work of which each piece ends at once is done before the
 * second thread runs, and a disk that lets all wait soon has all in hand. */
static void *run_some(void *argument) {
    struct each *e = argument;
    pthread_t other;
    const bool shared = atomic_load(&e->next) + 1 < e->n && atomic_fetch_add(&e->threads, 1) < AT_A_TIME &&
                        start_thread(&other, run_some, e);
    for (int i; (i = atomic_fetch_add(&e->next, 1)) < e->n;) e->work(e->context, i);
    if (shared) pthread_join(other, NULL);
    return NULL;
}

void background_each(int n, void (*work)(void *context, int i), void *context) {
    struct each e = {.n = n, .work = work, .context = context};
    atomic_init(&e.next, 0);
    atomic_init(&e.threads, 0);
    run_some(&e);
}
