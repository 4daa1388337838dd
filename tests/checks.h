/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of statuses, and cmocka with the headers it needs. Include this file last: cmocka's macro `fail` hides
 * ours. */
#ifndef TESTS_CHECKS_H
#define TESTS_CHECKS_H

#include "mesh/base/status.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { SKIPPED = 77 }; /* exit code of a program that cannot run its tests here: CTest shows them as skipped */

static inline void ok(status s) {
    if (s) fail_msg("%s", status_text(s));
}

/* The error must hold every part of `parts`, which '|' separates. */
static inline void says(status s, const char *parts) {
    char copy[512];
    if (!s) fail_msg("no error; expected '%s'", parts);
    snprintf(copy, sizeof copy, "%s", parts);
    for (char *p = strtok(copy, "|"); p; p = strtok(NULL, "|"))
        if (!strstr(status_text(s), p)) fail_msg("'%s' does not hold '%s'", status_text(s), p);
    status_free(s);
}

#endif
