/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choices in the dictionaries of granularMD and granularDEM: `grain` of constant/granularProperties, which a gas
 * shares, constant/g and shaking, and constant/particleProperties, which may be missing: every key has a default. */
#ifndef SOLVERS_GRAINS_MODELS_H
#define SOLVERS_GRAINS_MODELS_H

#include "libcore/grains/coarse.h"
#include "libcore/grains/contact.h"
#include "mesh/format/polymesh.h"
#include "solvers/case/control.h"
#include "solvers/gas/models.h"

enum { KIND_NAME = 40 }; /* characters of the name of a kind, at most */
struct grains_models {
    struct dict *granular, *properties; /* properties: NULL without the file */
    struct forces forces;
    struct material grain; /* diameter, mass, restitution, threshold */
    int number, seed;      /* number 0: it follows from the field alpha or rho */
    double shear;          /* 1/s: shear rate of a periodic box */
    bool write_cloud;
    struct grain_kinds kinds;  /* of a mixture; then `grain` is the largest of it. Numbers by grains_models_count */
    double share[GRAIN_KINDS]; /* of each kind in the number of grains */
    const char *kind_name[GRAIN_KINDS];
    double (*inlet_share)[GRAIN_KINDS]; /* [npatches] the same of what comes in there */
    int *inlet_line;                    /* [npatches] where that was given, in constant/particleProperties; 0: not */
    enum coarse_kernel kernel;
    double width, window;      /* m, s; window 0: fields are of a moment */
    int samples;               /* moments in a window */
    bool *open;                /* [npatches] do grains leave there? set by grains_box_open */
    bool *feeds;               /* [npatches] do grains come in there, too? set by grains_inlets_find */
    double *restitution;       /* [npatches] of impacts on each wall */
    struct grain_rough *rough; /* [npatches] of hard grains; set by grains_start_walls */
    int *restitution_line;     /* [npatches] in constant/particleProperties; 0: not given */
    bool soft;                 /* are the grains soft? Then the rest counts; restitution < 0: that of two grains */
    double *friction;          /* [npatches]; < 0: that of two grains, or 0 where U slips */
    struct soft_contact contact;
    double speed, fraction; /* m/s, -: impactSpeed (0: it is estimated), timeStepFraction */
};
/* Reads the models of hard or soft grains; the write interval of `control` is the default of the window. */
status grains_models_read(const char *case_dir, const struct polymesh *mesh, int dim, const int axis[3],
                          const struct control *control, bool soft, struct grains_models **out);
void grains_models_count(struct grains_models *m, int n); /* deals n grains to the kinds of a mixture */
void grains_models_free(struct grains_models *m);
void grains_models_list(FILE *f);
void grains_models_keywords(struct keywords *k); /* goes through all that a run of hard grains reads */
void grains_models_list_soft(FILE *f);           /* the same of soft grains */
void grains_models_keywords_soft(struct keywords *k);
void grains_boundaries_list(FILE *f);
void grains_models_print(FILE *f, const struct grains_models *m);
const char *grains_kernel_name(const struct grains_models *m);

#endif
