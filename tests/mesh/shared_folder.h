/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder that the ranks of a test share: made before its group of tests, and removed with all in it behind them. The
 * test sets `world` first. Include after the standard headers. */
#ifndef TESTS_MESH_SHARED_FOLDER_H
#define TESTS_MESH_SHARED_FOLDER_H

#include "mesh/base/comm.h"
#include "mesh/format/files.h"

static struct comm *world;
static char folder[64];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/haffXXXXXX");
    const bool made = !comm_root(world) || mkdtemp(folder);
    comm_broadcast(world, folder, sizeof folder);
    return made ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    return comm_root(world) ? folder_remove(folder) : 0;
}

#endif
