/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads, checks, lists and prints the contact of soft grains (grains_contact.h). */
#include "solvers/grains/grains_contact.h"

#include "solvers/dict/params.h"

#define COUNT(table) ((int)(sizeof table / sizeof *table))

static const char *const type_names[] = {"hertz", "linear", NULL};
static const char *const type_about[] = {"F = 4/3 E* sqrt(R delta) delta, E* = E/(2 (1 - nu^2)), with its damper",
                                         "F = stiffness delta, with a damper in proportion to the speed"};
static const char *const tangent_names[] = {"spring", "mindlin", NULL};
static const char *const tangent_about[] = {"of constant stiffness tangentialStiffness",
                                            "of Mindlin's stiffness 8 G* sqrt(R delta), which hertz alone has"};
#define PARAM_STRUCT struct contact
static const struct param contact_param[] = {
    CHOICE("type", type, REQUIRED_AS("type hertz;"), type_names, "the normal spring"),
    NUMBER("youngsModulus", young, USUALLY(0, "required with hertz"), POSITIVE, UNIT(1, -1, -2),
           "of the material of grains and walls"),
    NUMBER("poissonsRatio", poisson, 0.3, FROM_TO(0, 0.5), NO_UNIT, "of that material"),
    NUMBER("stiffness", stiffness, USUALLY(0, "required with linear"), POSITIVE, UNIT(1, 0, -2),
           "of the linear spring"),
    NUMBER("restitution", restitution, USUALLY(-1, "that of grain in granularProperties, without dissipation"),
           FROM_TO(0.01, 1), NO_UNIT, "of normal impacts at any speed; from 0.12 on with hertz"),
    NUMBER("dissipation", dissipation, USUALLY(-1, "none: restitution counts"), FROM_TO(0, 1), UNIT(0, 0, 1),
           "A of viscoelastic spheres: restitution falls as the speed rises; with hertz alone"),
    NUMBER("friction", friction, 0, FROM_TO(0, 1e3), NO_UNIT, "Coulomb's coefficient"),
    CHOICE("tangential", tangent, 0, tangent_names, "the tangential spring"),
    NUMBER("tangentialStiffness", kt,
           USUALLY(-1, "linear: 2/7 stiffness; hertz: Mindlin's at an impact of impactSpeed"), POSITIVE, UNIT(1, 0, -2),
           "of spring"),
    NUMBER("tangentialDamping", chi, 0, FROM_TO(0, 10), NO_UNIT, "tangential damper over that along the normal"),
};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct grains_models
static const struct param step_param[] = {
    NUMBER("impactSpeed", speed, USUALLY(0, "the largest of the start, of free fall and of the plate"), POSITIVE,
           UNIT(0, 1, -1), "of the fastest normal impact: it sets the time step"),
    NUMBER("timeStepFraction", fraction, 0.02, BETWEEN(0, 1. / 15), NO_UNIT,
           "time step over the duration of an impact of impactSpeed"),
};
static const struct param soft_param[] = {
    NOTED("contact", "dictionary", NULL, "the forces between soft grains",
          "contact { type hertz; youngsModulus 5e9; friction 0.5; }"),
};

static status check_hertz(struct dict *d, const struct contact *c) {
    if (dict_has(d, "stiffness")) return dict_fail(d, "stiffness", "a contact of type hertz has youngsModulus");
    if (!(c->young > 0)) return dict_missing(d, "youngsModulus", "a contact of type hertz needs it");
    if (c->restitution >= 0 && c->dissipation >= 0)
        return dict_fail(d, "dissipation", "restitution is given, too; remove one of them");
    return OK;
}

static status check_linear(struct dict *d, const struct contact *c) {
    static const char *const foreign[] = {"youngsModulus", "poissonsRatio", "dissipation"};
    for (int i = 0; i < 3; i++)
        if (dict_has(d, foreign[i]))
            return dict_fail(d, foreign[i], "a contact of type linear has stiffness and restitution");
    if (!(c->stiffness > 0)) return dict_missing(d, "stiffness", "a contact of type linear needs it");
    if (c->tangent == TANGENT_MINDLIN) return dict_fail(d, "tangential", "a contact of type linear has a spring");
    return OK;
}

status grains_contact_read(struct dict *properties, struct grains_models *m) {
    struct dict *d = NULL;
    struct contact *c = &m->contact;
    TRY(dict_sub_optional(properties, "contact", &d));
    if (!d)
        return dict_missing(properties, "contact",
                            "granularDEM needs it: contact { type hertz; youngsModulus 5e9; friction 0.5; }");
    TRY(params_read(d, contact_param, COUNT(contact_param), c));
    TRY(params_read(d, step_param, COUNT(step_param), m));
    TRY(c->type == CONTACT_HERTZ ? check_hertz(d, c) : check_linear(d, c));
    if (c->tangent == TANGENT_MINDLIN && dict_has(d, "tangentialStiffness"))
        return dict_fail(d, "tangentialStiffness", "tangential mindlin; follows from youngsModulus; remove it");
    const bool own = c->restitution >= 0;
    if (!own && c->dissipation < 0) c->restitution = m->grain.restitution;
    if (c->type == CONTACT_LINEAR && c->restitution < 0.01)
        return fail(ERR_INPUT, "%s: contact: restitution is %g; a linear spring allows 0.01 .. 1: give it here",
                    dict_path(d), c->restitution);
    if (c->type == CONTACT_HERTZ && c->dissipation < 0 && c->restitution < 0.01 * CONTACT_LEAST)
        return fail(ERR_INPUT, "%s:%d: restitution is %g; contacts of type hertz allow 0.12 .. 1: use type linear",
                    dict_path(own ? d : m->granular), dict_line(own ? d : m->granular, own ? "restitution" : "grain"),
                    c->restitution);
    return OK;
}

void grains_contact_list(FILE *f) {
    fprintf(f, "\ncontact { }: the forces of soft grains\n");
    params_print(f, contact_param, COUNT(contact_param));
    params_print(f, step_param, COUNT(step_param));
    for (int i = 0; type_names[i]; i++) fprintf(f, "  type %-13s %s\n", type_names[i], type_about[i]);
    for (int i = 0; tangent_names[i]; i++) fprintf(f, "  tangential %-7s %s\n", tangent_names[i], tangent_about[i]);
}

void grains_contact_keywords(struct keywords *k, const char *file) {
    keywords_params(k, soft_param, COUNT(soft_param));
    keywords_at(k, file, "contact", NULL);
    keywords_params(k, contact_param, COUNT(contact_param));
    keywords_words(k, "type", type_names, type_about);
    keywords_words(k, "tangential", tangent_names, tangent_about);
    keywords_params(k, step_param, COUNT(step_param));
}

void grains_contact_print(FILE *f, const struct grains_models *m) {
    const struct contact *c = &m->contact;
    fprintf(f, "    %-22s %s", "contact", type_names[c->type]);
    if (c->type == CONTACT_HERTZ)
        fprintf(f, ", youngsModulus %.6g Pa, poissonsRatio %g", c->young, c->poisson);
    else
        fprintf(f, ", stiffness %.6g N/m", c->stiffness);
    if (c->dissipation >= 0)
        fprintf(f, ", dissipation %g s", c->dissipation);
    else
        fprintf(f, ", restitution %g", c->restitution);
    fprintf(f, "\n    %-22s %g, %s", "friction", c->friction, tangent_names[c->tangent]);
    if (c->kt > 0) fprintf(f, " of %.6g N/m", c->kt);
    if (c->chi > 0) fprintf(f, ", tangentialDamping %g", c->chi);
    fprintf(f, "\n");
}
