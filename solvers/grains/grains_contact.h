/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dictionary `contact` of constant/particleProperties: how soft grains repel each other. */
#ifndef SOLVERS_GRAINS_CONTACT_H
#define SOLVERS_GRAINS_CONTACT_H

#include "solvers/grains/grains_models.h"

/* Reads the contact, impactSpeed and timeStepFraction into m; m->grain must be there, whose restitution is the default.
 * Fails with file and line on numbers that do not fit together. */
status grains_contact_read(struct dict *properties, struct grains_models *m);
void grains_contact_list(FILE *f);
void grains_contact_keywords(struct keywords *k, const char *file);
void grains_contact_print(FILE *f, const struct grains_models *m);

#endif
