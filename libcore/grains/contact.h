/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces of soft spheres in contact (docs/physics.md 10.5), as LAMMPS's pair_style granular has them: a spring and a
 * damper along the normal, a spring with Coulomb's limit along the tangent (Cundall & Strack, Geotechnique 29 (1979)
 * 47).
 *
 *   linear:  F = k delta + eta v                                   k = kn
 *   hertz:   F = k sqrt(R delta) delta + damper                    k = 4/3 E*, E* = E/(2 (1 - nu^2))
 *   dampers of hertz: dissipation A: eta sqrt(R delta) m v         (Brilliantov et al., Phys. Rev. E 53 (1996) 5382)
 *                     restitution e: eta sqrt(m k sqrt(R delta)) v (Tsuji et al., Powder Technol. 71 (1992) 239)
 *   tangent: -kt s - chi gamma v_t, at most mu F; gamma: the damper's factor of v along the normal
 *
 * delta: overlap; v: speed of approach; R, m: radius and mass of the pair (R = d/4, m/2) or of grain and wall (d/2, m).
 * With Tsuji's damper LAMMPS stops a contact at overlap 0, not at force 0, so that its own coefficient gives another
 * restitution than it names; eta here is found from the exact one by inverting Tsuji's fit. */
#ifndef LIBCORE_CONTACT_H
#define LIBCORE_CONTACT_H

#include <stdbool.h>

enum contact_type { CONTACT_HERTZ, CONTACT_LINEAR };
enum contact_tangent { TANGENT_SPRING, TANGENT_MINDLIN };
struct soft_contact {      /* of two grains; a wall may have its own restitution and friction */
    int type, tangent;     /* enum contact_type, contact_tangent */
    double young, poisson; /* Pa, - */
    double stiffness;      /* N/m: kn of linear */
    double restitution;    /* e; < 0: dissipation counts */
    double dissipation;    /* s: A of hertz */
    double friction;       /* mu */
    double kt;             /* N/m, of a mindlin contact N/m^2 (times sqrt(R delta)); < 0: the default */
    double chi;            /* tangential damper over that along the normal */
};
struct contact_law { /* numbers of one kind of contact */
    const struct soft_contact *contact;
    double radius, mass;      /* R, m */
    double k, eta;            /* as above, in the units of LAMMPS's coefficients */
    double kt, chi, friction; /* as above */
    bool tsuji;               /* hertz with restitution below 1 */
};
enum { CONTACT_LEAST = 12 }; /* percent: hertz has no smaller restitution, as Tsuji's fit ends there */

/* Returns the law of two grains or, with `wall`, of a grain and a wall of restitution e and friction mu. */
struct contact_law contact_pair(const struct soft_contact *c, double diameter, double mass);
struct contact_law contact_wall(const struct soft_contact *c, double diameter, double mass, double e, double mu);

/* Returns the duration of an impact (s): 2.87 (m^2/(R E*^2 v))^(1/5), or pi sqrt(m/kn). */
double contact_time(const struct contact_law *l, double speed);
/* Returns the tangential stiffness (N/m) of Mindlin at the largest overlap of an impact; it is that of kt's default. */
double contact_mindlin(const struct soft_contact *c, double diameter, double mass, double speed);
double contact_elastic(const struct contact_law *l, double overlap); /* J: of the normal spring */
double contact_rest(const struct contact_law *l, double force);      /* m: the overlap at rest under a force */
double contact_damper(const struct contact_law *l, double overlap);  /* kg/s: gamma */
double contact_spring(const struct contact_law *l, double overlap);  /* N/m: of the tangent */

#endif
