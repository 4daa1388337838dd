/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quantities of the gas, as the code that all solvers share sees them (medium.h), and those of them that are made
 * of gradients: these are computed on demand, and kept until the state changes.
 *
 *   vorticity = curl u
 *   gradAlpha = grad alpha
 *   Kn        = lambda |grad alpha|/alpha, the Knudsen number of the scale on which the gas itself varies, with
 * Enskog's mean free path lambda (scales.h, docs/physics.md 4.7): hydrodynamics asks for Kn << 1 (Boyd, Chen & Candler,
 * Phys. Fluids 7, 210, 1995, who take it from the gradient of the density; Goldhirsch, Annu. Rev. Fluid Mech. 35, 267,
 * 2003, for grains, where restitution sets that scale)
 *   stressRatio = |tau|/p, the stress of friction over the pressure (docs/physics.md 9.3)
 *
 * Derivatives are those of grid_gradients; along axes that the mesh lacks they are 0. */
#ifndef SOLVERS_GAS_QUANTITIES_H
#define SOLVERS_GAS_QUANTITIES_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"
#include "solvers/case/checksums.h"

/* The quantities that follow those of enum gas_field: those that function objects know, those that a case may carry,
 * then those that are only written. */
enum {
    GAS_VORTICITY = GAS_FIELDS,
    GAS_GRAD_ALPHA,
    GAS_KNUDSEN,
    GAS_STRESS_RATIO,
    GAS_CARRIED, /* the first of those that a case may carry, whose rows are empty here */
    GAS_MOMENTUM = GAS_CARRIED + CARRIED_MOST,
    GAS_ENERGY,
    GAS_QUANTITIES
};
enum { GAS_DERIVED = GAS_CARRIED - GAS_FIELDS };
extern const struct quantity gas_quantity[GAS_QUANTITIES];
extern const int gas_written[], gas_shown[];

struct gas_fields { /* the quantities of a case, with those that it carries */
    struct quantity quantity[GAS_QUANTITIES];
    int written[GAS_QUANTITIES + 1], shown[GAS_QUANTITIES + 1];
};
struct offered gas_fields_offer(struct gas_fields *f, const struct gas_models *models);
/* Returns which carried quantity it is; -1: none. */
static inline int gas_carried(int quantity) {
    return quantity >= GAS_CARRIED && quantity < GAS_MOMENTUM ? quantity - GAS_CARRIED : -1;
}

struct gas_view { /* a gas and its derived quantities */
    const struct setup *setup;
    const struct gas_models *models;
    const struct gas *gas;
    long ncells, *first;          /* of this rank; [blocks] where the cells of a block begin among them */
    double *line[GAS_DERIVED][3]; /* [ncells]; NULL until asked for */
    bool known[GAS_DERIVED];      /* is it that of the state? */
};
void gas_view_free(struct gas_view *v);
void gas_view_forget(struct gas_view *v); /* the state has changed */
/* Returns why a gas of these models has no such quantity; NULL: it has it. */
const char *gas_view_lacks(const struct gas_models *models, int quantity);
/* Computes a derived quantity, unless it is known; does nothing for any other quantity. Collective. */
status gas_view_derive(struct gas_view *v, int quantity);
/* As the hooks block, exact and uniform of a medium; of a derived quantity, after gas_view_derive. */
void gas_view_block(const struct gas_view *v, int block, int quantity, double *const out[3]);
void gas_view_exact(const struct gas_view *v, int block, int quantity, double *const out[3]);
bool gas_view_uniform(const struct gas_view *v, int block, int quantity, double value[3]);

/* As the hook edge of a medium, with its edge_state: rho, U, T. r: of the patch. */
extern const int gas_edge_state[];
void gas_view_edge(const struct gas_view *v, const struct patch_rules *r, int quantity, int patch, int n,
                   const struct edge_face *face, double *values);
/* Is a quantity given on a patch of these rules, whatever is in the cells? p is where rho and T are, on no wall. */
bool gas_rules_give(const struct patch_rules *r, const struct gas_models *models, int quantity);

/* What friction keeps from step to step (docs/physics.md 9.3), in the folder of a time: uniform/frictionPressure, the
 * pressure of each cell in the last step of the bed, and for each side of a cell a file of the stress, a symmetric
 * tensor. Sides of a lattice have the names frictionStressXLow, XHigh, YLow ..; those of polyhedra have numbers, in the
 * order of the polyMesh's faces. A restart goes on with them to the bit. For users there is frictionStress, the mean of
 * a cell's sides that carry stress, and the quantity stressRatio, |tau|/p of that mean, |tau| = sqrt(tau:tau/2), 0
 * below alphaFriction. */
enum { FRICTION_NAME = 40 };
struct friction_files {
    int n;                       /* 1 + sides of a cell; 0: there is no friction */
    char (*name)[FRICTION_NAME]; /* [n] in the folder of a time; the pressure's is the first */
    bool lost;                   /* did the run go on from a time without them? */
};
/* Names the files, and gives the gas what those of the start have. Where one is missing there is no stress. Collective.
 */
status friction_resume(struct friction_files *f, const struct setup *s, struct gas *g);
/* Writes the files of a time, and adds their checksums. Collective. */
status friction_save(const struct friction_files *f, const struct setup *s, const struct gas *g,
                     const struct field_writer *w, struct checksums *sums);
/* Computes stressRatio in the cells of this rank, one block after the other. Local. */
status friction_ratio(const struct setup *s, const struct gas *g, const struct gas_models *models, double *out);
void friction_files_free(struct friction_files *f);

#endif
