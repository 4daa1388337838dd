/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/contact.h"

#include <stdlib.h>

struct wall_work { /* context of work_face */
    const struct gas *g;
    double sum;
};

/* Pressure does no work at a wall, so what passes there in a bed is the work of friction. */
static void work_face(void *work, const struct gas_face *face) {
    struct wall_work *w = work;
    if (patch_is_wall(&w->g->patches.rules[face->patch])) w->sum -= face->energy * gas_tally_step(w->g);
}

status contacts_look(struct contacts *c, const struct gas *g) {
    struct gas_budget b;
    struct wall_work w = {.g = g};
    for (int i = 0; i < grid_blocks(g); i++) gas_tally_faces(g, i, work_face, &w);
    c->worked += w.sum;
    TRY(gas_budget(g, &b));
    c->most = larger(c->most, b.gained[GAS_CONTACTS] - c->worked);
    return OK;
}

static long cells_of(const struct gas *g, int block) {
    const int *n = g->forest ? g->forest->block[block].n : NULL;
    return n ? (long)n[0] * n[1] * n[2] : g->blocks.grid->block[block].ncells;
}

static long cells_here(const struct gas *g) {
    long sum = 0;
    for (int b = 0; b < grid_blocks(g); b++) sum += cells_of(g, b);
    return sum;
}

/* The field GAS_LIMITED stands behind the conserved variables, and friction behind that. */
status kept_take(struct kept *k, const struct gas *g) {
    const int sides = gas_friction_sides(g);
    *k = (struct kept){.cells = cells_here(g), .variables = gas_variables(g), .counts = gas_counts(g)};
    k->friction = sides > 0 ? 1 + sides * bed_tensors(g->components) : 0;
    const int lines = k->variables + 1 + k->friction;
    double **at;
    TRY(allocate(&k->lines, lines * k->cells, sizeof(double), "a restart"));
    TRY(allocate(&at, lines, sizeof *at, "a restart"));
    for (int i = 0; i < lines; i++) at[i] = k->lines + i * k->cells;
    for (int b = 0; b < grid_blocks(g); b++) {
        gas_block_variables(g, b, 0, k->variables, at);
        gas_block_field(g, b, GAS_LIMITED, at + k->variables);
        if (k->friction) gas_block_friction(g, b, 0, k->friction, at + k->variables + 1);
        for (int i = 0; i < lines; i++) at[i] += cells_of(g, b);
    }
    free(at);
    return OK;
}

void kept_give(const struct kept *k, struct gas *g) {
    const double *U[MAX_VAR] = {NULL};
    for (int v = 0; v < k->variables; v++) U[v] = k->lines + v * k->cells;
    gas_set_own_conserved(g, U);
    gas_resume(g, &k->counts, k->lines + k->variables * k->cells);
    for (int i = 0; i < k->friction; i++) {
        const double *line = k->lines + (k->variables + 1 + i) * k->cells;
        gas_set_friction(g, i, 1, &line);
    }
}

void kept_free(struct kept *k) {
    free(k->lines);
}
