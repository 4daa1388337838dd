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
#define PARAM_STRUCT struct soft_contact
static const struct param contact_param[] = {
    CHOICE("type", type, REQUIRED_AS("type hertz;"), type_names, "the normal spring"),
    NUMBER("restitution", restitution, USUALLY(-1, "that of grain in granularProperties, without dissipation"),
           FROM_TO(0.01, 1), NO_UNIT, "of normal impacts at any speed; from 0.12 on with hertz"),
    NUMBER("friction", friction, 0, FROM_TO(0, 1e3), NO_UNIT, "Coulomb's coefficient"),
    NUMBER("tangentialStiffness", kt,
           USUALLY(-1, "linear: 2/7 stiffness; hertz: Mindlin's at an impact of impactSpeed"), POSITIVE, UNIT(1, 0, -2),
           "of the tangential spring"),
    NUMBER("tangentialDamping", chi, 0, FROM_TO(0, 10), NO_UNIT, "tangential damper over that along the normal"),
};
static const struct param hertz_param[] = {
    NUMBER("youngsModulus", young, REQUIRED_AS("youngsModulus 5e9;"), POSITIVE, UNIT(1, -1, -2),
           "of the material of grains and walls"),
    NUMBER("poissonsRatio", poisson, 0.3, FROM_TO(0, 0.5), NO_UNIT, "of that material"),
    NUMBER("dissipation", dissipation, USUALLY(-1, "none: restitution counts"), FROM_TO(0, 1), UNIT(0, 0, 1),
           "A of viscoelastic spheres; it replaces restitution, which then falls as the speed rises"),
    CHOICE("tangential", tangent, 0, tangent_names, "the tangential spring"),
};
static const struct param linear_param[] = {
    NUMBER("stiffness", stiffness, REQUIRED_AS("stiffness 500;"), POSITIVE, UNIT(1, 0, -2), "of the normal spring"),
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

/* Chooses between dissipation and restitution, whose default is that of hard grains. */
static status choose_damper(struct dict *d, struct grains_models *m) {
    struct soft_contact *c = &m->contact;
    const bool hertz = c->type == CONTACT_HERTZ;
    if (c->restitution >= 0 && c->dissipation >= 0)
        return dict_fail(d, "dissipation", "restitution is given, too; remove one of them");
    if (c->dissipation >= 0) return OK;
    if (c->restitution < 0) c->restitution = m->grain.restitution;
    if (c->restitution >= (hertz ? 0.01 * CONTACT_LEAST : 0.01)) return OK;
    if (dict_has(d, "restitution")) return dict_fail(d, "restitution", "a contact of type hertz allows 0.12 .. 1");
    return dict_fail(m->granular, "grain",
                     "its restitution is %g; a contact of type %s allows %g .. 1: give another one in "
                     "contact of constant/particleProperties",
                     c->restitution, type_names[c->type], hertz ? 0.01 * CONTACT_LEAST : 0.01);
}

status grains_contact_read(struct dict *properties, struct grains_models *m) {
    struct dict *d = NULL;
    struct soft_contact *c = &m->contact;
    TRY(dict_sub_optional(properties, "contact", &d));
    if (!d)
        return dict_missing(properties, "contact",
                            "granularDEM needs it: contact { type hertz; youngsModulus 5e9; friction 0.5; }");
    TRY(params_read(d, contact_param, COUNT(contact_param), c));
    TRY(params_read(d, step_param, COUNT(step_param), m));
    c->dissipation = -1;
    if (c->type == CONTACT_HERTZ)
        TRY(params_read(d, hertz_param, COUNT(hertz_param), c));
    else
        TRY(params_read(d, linear_param, COUNT(linear_param), c));
    if (c->tangent == TANGENT_MINDLIN && c->kt > 0)
        return dict_fail(d, "tangentialStiffness",
                         "with  tangential mindlin;  it follows from youngsModulus: remove it");
    return choose_damper(d, m);
}

void grains_contact_list(FILE *f) {
    fprintf(f, "\ncontact { }: the forces of soft grains\n");
    params_print(f, contact_param, COUNT(contact_param));
    params_print(f, step_param, COUNT(step_param));
    fprintf(f, "\ncontact { type hertz; }\n");
    params_print(f, hertz_param, COUNT(hertz_param));
    fprintf(f, "\ncontact { type linear; }\n");
    params_print(f, linear_param, COUNT(linear_param));
    for (int i = 0; type_names[i]; i++) fprintf(f, "  type %-13s %s\n", type_names[i], type_about[i]);
    for (int i = 0; tangent_names[i]; i++) fprintf(f, "  tangential %-7s %s\n", tangent_names[i], tangent_about[i]);
}

void grains_contact_keywords(struct keywords *k, const char *file) {
    keywords_params(k, soft_param, COUNT(soft_param));
    keywords_at(k, file, "contact", NULL);
    keywords_params(k, contact_param, COUNT(contact_param));
    keywords_params(k, step_param, COUNT(step_param));
    keywords_word(k, "type", "hertz", type_about[0], "type hertz; youngsModulus 5e9;");
    keywords_word(k, "type", "linear", type_about[1], "type linear; stiffness 500;");
    keywords_at(k, file, "contact", "hertz");
    keywords_params(k, hertz_param, COUNT(hertz_param));
    for (int i = 0; tangent_names[i]; i++) {
        char entry[80];
        snprintf(entry, sizeof entry, "type hertz; youngsModulus 5e9; tangential %s;", tangent_names[i]);
        keywords_word(k, "tangential", tangent_names[i], tangent_about[i], entry);
    }
    keywords_at(k, file, "contact", "linear");
    keywords_params(k, linear_param, COUNT(linear_param));
}

void grains_contact_print(FILE *f, const struct grains_models *m) {
    const struct soft_contact *c = &m->contact;
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
