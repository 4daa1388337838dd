/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a time folder of the gas (initial.h): the fields, the state in cells, and the rules of the patches, and checks
 * that they agree with each other and with the models. */
#include "solvers/gas/initial.h"

#include "solvers/gas/layers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct flat_layers {   /* of layers without waves */
    bool rests;        /* are they at rest? */
    double background; /* least alpha */
};

struct initial_reader { /* what the functions below share */
    const char *case_dir;
    const struct instant *at;
    const struct field_place *place;
    int dim, components, axis[3];
    const struct gas_models *models;
    struct flat_layers *flat; /* NULL; or layers are read without waves, and this is filled in */
};

static void path_of(const struct initial_reader *r, const char *name, char path[TIME_PATH]) {
    snprintf(path, TIME_PATH, "%s/%s/%s", r->case_dir, r->at->folder, name);
}
static bool there(const struct initial_reader *r, const char *name) {
    char path[TIME_PATH];
    path_of(r, name, path);
    return field_exists(path);
}

static status read_fields(struct initial_reader *r, struct initial *s) {
    struct layers *layers[FIELD_COUNT] = {NULL};
    status e = OK;
    for (int i = 0; i < FIELD_COUNT && !e; i++) {
        char path[TIME_PATH];
        path_of(r, field_kinds[i].name, path);
        if (field_exists(path)) e = layers_read_field(path, (enum field_id)i, r->place, &layers[i], &s->field[i]);
        e = field_agree(r->place, e);
    }
    const enum field_id density = s->field[FIELD_RHO] ? FIELD_RHO : FIELD_ALPHA;
    if (!e && r->flat) r->flat->rests = layers_flatten(layers[density], &r->flat->background);
    if (!e)
        e = layers_apply(layers[density], s->field[density], r->place, r->dim, r->axis, r->models, s->field[FIELD_T]);
    for (int i = 0; i < FIELD_COUNT; i++) layers_free(layers[i]);
    return e;
}

/* Reads the fields. A case gives one of rho and alpha, and one of T and p; a folder that this program wrote has all of
 * them, and is known by its uniform/time. */
/* What a user of OpenFOAM, whose gases have p and T in kelvin, must know. */
#define FROM_OPENFOAM                                                                                                  \
    "; a case of OpenFOAM has p and T in kelvin: there rho = p/(R T), and T becomes R T (docs/fromOpenFOAM.md)"

static status read_files(struct initial_reader *r, struct initial *s) {
    static const enum field_id pairs[2][2] = {{FIELD_RHO, FIELD_ALPHA}, {FIELD_T, FIELD_P}};
    bool written = there(r, "uniform/time");
    s->mapped = !written && r->at->t == 0 && there(r, "rho") && there(r, "alpha") && there(r, "T") && there(r, "p") &&
                there(r, "U") && there(r, "rhoU") && there(r, "rhoE");
    if (s->mapped) return read_fields(r, s); /* rho, U and T count */
    for (int i = 0; i < 2; i++) {
        const char *a = field_kinds[pairs[i][0]].name, *b = field_kinds[pairs[i][1]].name;
        if (there(r, a) && there(r, b) && !written && there(r, "rhoE"))
            return fail(ERR_INPUT,
                        "%s/%s: uniform/time is missing, but a run wrote the rest; start from another time, or keep U "
                        "and one of %s, %s only",
                        r->case_dir, r->at->folder, a, b);
        if (there(r, a) && there(r, b) && !written)
            return fail(ERR_INPUT, "%s/%s: both %s and %s are given; remove one: it follows from the other",
                        r->case_dir, r->at->folder, a, b);
        if (!there(r, a) && !there(r, b))
            return fail(ERR_INPUT, "%s/%s: neither %s nor %s is there; give one of them%s", r->case_dir, r->at->folder,
                        a, b, i == 0 ? FROM_OPENFOAM : "");
    }
    if (!there(r, "U"))
        return fail(ERR_INPUT, "%s/%s/U: no such file; the velocity must be given", r->case_dir, r->at->folder);
    return read_fields(r, s);
}

/* Has the folder the conserved fields of an earlier run, which restart it bit by bit? */
static bool continued(const struct initial_reader *r) {
    return there(r, "uniform/time") && there(r, "rho") && there(r, "rhoU") && there(r, "rhoE");
}

static status check_values(const struct initial_reader *r, const struct initial *s) {
    const struct material *m = &r->models->material;
    const double limit[FIELD_COUNT] = {[FIELD_RHO] = density_limit(r->models->eos, m),
                                       [FIELD_ALPHA] = packing_limit(r->models->eos, m),
                                       [FIELD_T] = HUGE_VAL,
                                       [FIELD_P] = HUGE_VAL};
    for (int i = 0; i < FIELD_COUNT; i++)
        /* written with few digits alpha may be rounded to its limit: gas_check checks a state that is continued */
        if (s->field[i] && i != FIELD_U && !(continued(r) && i == FIELD_ALPHA))
            TRY(field_agree(r->place, field_check_range(s->field[i], r->place, 0, limit[i], BELOW_PACKING)));
    return OK;
}

/* Does U lead along axis x, in a cell that is read or on a patch? */
static bool moves_along(const struct field *U, const struct field_place *place, int x) {
    const struct polymesh *m = place->mesh;
    for (long i = 0; i < field_ncells(place); i++)
        if (U->values[3 * i + x] != 0) return true;
    for (int p = 0; p < m->npatches; p++) {
        const struct patch_field *q = &U->patch[p];
        const struct boundary_type *type = boundary_find(q->type);
        for (int i = 0; type && i < type->model.nparam; i++)
            if (type->model.param[i].kind == PARAM_VECTOR &&
                q->params.room[type->model.param[i].offset / sizeof(double) + (size_t)x] != 0)
                return true;
        if (q->varying && varying_leads(q->varying, x)) return true;
        if (!boundary_value(type, 3) || q->varying) continue;
        if (!q->values && q->uniform[x] != 0) return true;
        for (int i = 0; q->values && i < m->patch[p].nfaces; i++)
            if (q->values[3 * (long)i + x] != 0) return true;
    }
    return false;
}

/* Finds the axes that the mesh lacks along which gas moves. */
static void find_components(struct initial_reader *r, const struct field *U, const bool moved[3]) {
    double leads[3] = {0, 0, 0};
    bool solved[3] = {false, false, false};
    r->components = r->dim;
    for (int k = 0; k < r->dim; k++) solved[r->axis[k]] = true;
    for (int x = 0; x < 3; x++) leads[x] = !solved[x] && (moved[x] || moves_along(U, r->place, x));
    if (r->place->share) comm_max(r->place->share->comm, leads, 3);
    for (int x = 0; x < 3; x++)
        if (leads[x] > 0) r->axis[r->components++] = x;
}

static status take_velocity(const struct initial_reader *r, struct initial *s) {
    const struct field *U = s->field[FIELD_U];
    const long n = s->ncells;
    s->components = r->components;
    memcpy(s->axis, r->axis, sizeof s->axis);
    for (int k = 0; k < r->components; k++) {
        TRY(allocate(&s->u[k], n, sizeof(double), "velocity"));
        for (long i = 0; i < n; i++) s->u[k][i] = U->values[3 * i + r->axis[k]];
    }
    return OK;
}

static status take_state(const struct initial_reader *r, struct initial *s) {
    const long n = s->ncells;
    const double per = packing_per_density(&r->models->material);
    TRY(allocate(&s->rho, n, sizeof(double), "density"));
    TRY(allocate(&s->T, n, sizeof(double), "temperature"));
    if (s->field[FIELD_RHO])
        memcpy(s->rho, s->field[FIELD_RHO]->values, (size_t)n * sizeof(double));
    else
        for (long i = 0; i < n; i++) s->rho[i] = s->field[FIELD_ALPHA]->values[i] / per;
    if (s->field[FIELD_T]) {
        memcpy(s->T, s->field[FIELD_T]->values, (size_t)n * sizeof(double));
    } else {
        pressure_per_temperature(r->models->eos, &r->models->material, (int)n, s->rho, s->T);
        for (long i = 0; i < n; i++) s->T[i] = s->field[FIELD_P]->values[i] / s->T[i];
    }
    return take_velocity(r, s);
}

/* Fails if U or T differ from the conserved fields: these win, so that a change by the user would be ignored. */
static status check_agreement(const struct initial_reader *r, const struct initial *s) {
    const double *const *q = (const double *const *)s->conserved;
    double tolerance = fmax(1e-9, 10 * pow(10, -r->at->digits)), fastest = 0;
    for (long i = 0; i < s->ncells; i++)
        for (int k = 0; k < r->components; k++) fastest = fmax(fastest, fabs(q[1 + k][i] / q[0][i]));
    if (s->sliced) comm_max(s->share.comm, &fastest, 1);
    for (long i = 0; i < s->ncells; i++) {
        double kinetic = 0;
        for (int k = 0; k < r->components; k++) {
            double u = q[1 + k][i] / q[0][i];
            kinetic += u * u / 2;
            if (fabs(u - s->u[k][i]) > tolerance * fastest)
                return field_fail(s->field[FIELD_U], r->place, i,
                                  "rhoU/rho is %g along %c; to start from a changed U remove rhoU and rhoE", u,
                                  "xyz"[r->axis[k]]);
        }
        double E = q[1 + r->components][i] / q[0][i], T = temperature_of(&r->models->material, E - kinetic);
        if (s->field[FIELD_T] && fabs(T - s->T[i]) > tolerance * T + 1e-13 * E)
            return field_fail(s->field[FIELD_T], r->place, i,
                              "rhoE says %g; to start from a changed T remove rhoU and rhoE", T);
    }
    return OK;
}

static status read_raw(const struct initial_reader *r, const char *name, int components, double **out) {
    char path[TIME_PATH];
    int found;
    path_of(r, name, path);
    TRY(field_agree(r->place, field_read_slice(path, r->place->mesh->ncells, r->place->share, &found, out)));
    if (found == components) return OK;
    free(*out);
    *out = NULL;
    return fail(ERR_INPUT, "%s: it has %d component%s; %d expected", path, found, found == 1 ? "" : "s", components);
}

static status take_conserved(const struct initial_reader *r, struct initial *s) {
    if (there(r, "rhoU") != there(r, "rhoE"))
        return fail(ERR_INPUT, "%s/%s: %s is there without %s; remove it to start from U and T", r->case_dir,
                    r->at->folder, there(r, "rhoU") ? "rhoU" : "rhoE", there(r, "rhoU") ? "rhoE" : "rhoU");
    if (!continued(r)) return OK;
    double *momentum = NULL;
    TRY(read_raw(r, "rhoE", 1, &s->conserved[1 + r->components]));
    TRY(read_raw(r, "rhoU", 3, &momentum));
    status e = OK;
    for (int k = 0; !e && k < 1 + r->components; k++) {
        e = allocate(&s->conserved[k], s->ncells, sizeof(double), "conserved variables");
        for (long i = 0; !e && i < s->ncells; i++)
            s->conserved[k][i] = k ? momentum[3 * i + r->axis[k - 1]] : s->rho[i];
    }
    free(momentum);
    TRY(field_agree(r->place, e));
    return field_agree(r->place, check_agreement(r, s));
}

/* Returns the parameters of a type as a rule has them, with vectors along the components of u. */
static struct own_params take_parameters(const struct initial *s, const struct patch_field *q,
                                         const struct boundary_type *type) {
    struct own_params own = q->params;
    for (int i = 0; type && i < type->model.nparam; i++) {
        const size_t at = type->model.param[i].offset / sizeof(double);
        for (int k = 0; k < s->components && type->model.param[i].kind == PARAM_VECTOR; k++)
            own.room[at + (size_t)k] = q->params.room[at + (size_t)s->axis[k]];
    }
    return own;
}

static struct rule *rule_of(const struct initial *s, int p, int i) {
    struct patch_rules *r = &s->rules[p];
    return i == 0 ? &r->density : i == 1 ? &r->velocity : &r->temperature;
}

/* Takes what rule i of a patch (density, velocity, temperature) has from its field: densities from packing fractions,
 * vectors along the components of u, nonuniform values into s->values. */
static void take_values(const struct initial *s, int p, int i, int nfaces) {
    const struct field *f = s->field[s->from[p][i]];
    const struct patch_field *q = &f->patch[p];
    const double scale = s->from[p][i] == FIELD_ALPHA ? 1 / s->packing_per_density : 1;
    const int m = f->kind->components == 3 ? s->components : 1;
    struct rule *rule = rule_of(s, p, i);
    double *values = s->values[3 * p + i];
    rule->params = take_parameters(s, q, rule->type);
    for (int k = 0; k < m; k++) rule->uniform[k] = scale * q->uniform[f->kind->components == 1 ? 0 : s->axis[k]];
    for (long face = 0; face < nfaces && values; face++)
        for (int k = 0; k < m; k++)
            values[face * m + k] =
                scale * (f->kind->components == 1 ? q->values[face] : q->values[3 * face + s->axis[k]]);
    rule->values = values;
}

/* Takes rule i of a patch. */
static status take_rule(const struct initial_reader *r, struct initial *s, int p, int i) {
    const struct field *f = s->field[s->from[p][i]];
    const struct patch_field *q = &f->patch[p];
    const int m = f->kind->components == 3 ? s->components : 1, nfaces = r->place->mesh->patch[p].nfaces;
    rule_of(s, p, i)->type = boundary_find(q->type);
    rule_of(s, p, i)->volume = q->varying && varying_is_volumetric(q->varying);
    if (q->values) TRY(pool_take(&s->pool, &s->values[3 * p + i], (long)nfaces * m, sizeof(double), "boundary values"));
    rule_of(s, p, i)->changes = q->varying && varying_in_time(q->varying);
    s->varies |= rule_of(s, p, i)->changes;
    take_values(s, p, i, nfaces);
    return OK;
}

const struct varying *initial_varying(const struct initial *s, int patch, int i) {
    return s->rules[patch].velocity.type ? s->field[s->from[patch][i]]->patch[patch].varying : NULL;
}

static status renew_patch(struct initial *s, int p, double t) {
    for (int i = 0; i < 3; i++) {
        const struct varying *v = initial_varying(s, p, i);
        if (!v || !varying_in_time(v)) continue;
        TRY(field_renew(s->field[s->from[p][i]], p, t, ERR_STATE));
        take_values(s, p, i, s->mesh->patch[p].nfaces);
    }
    return carried_start_renew(&s->carried, p, t);
}

double initial_knot(const struct initial *s, double t) {
    double knot = HUGE_VAL;
    for (int p = 0; p < s->npatches && s->varies; p++) {
        for (int i = 0; i < 3; i++)
            if (initial_varying(s, p, i)) knot = fmin(knot, varying_knot(initial_varying(s, p, i), t));
        knot = fmin(knot, carried_start_knot(&s->carried, p, t));
    }
    return knot;
}

status initial_renew(void *initial, double t) {
    struct initial *s = initial;
    if (t == s->t) return OK;
    for (int p = 0; p < s->npatches; p++) TRY(renew_patch(s, p, t));
    s->t = t;
    return OK;
}

/* Finds which of two fields gives a patch's rule: the first that is there and not `calculated`. */
static status which(const struct initial_reader *r, const struct initial *s, int p, enum field_id a, enum field_id b,
                    enum field_id *out) {
    const enum field_id both[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        *out = both[i];
        if (s->field[both[i]] && strcmp(s->field[both[i]]->patch[p].type, "calculated")) return OK;
    }
    const struct field *f = s->field[a] ? s->field[a] : s->field[b];
    return fail(ERR_INPUT, "%s:%d: patch %s of %s is 'calculated', which says nothing; give its type here%s%s",
                dict_path(f->dict), f->patch[p].line, r->place->mesh->patch[p].name, f->kind->name,
                s->field[a] && s->field[b] ? " or in " : "", s->field[a] && s->field[b] ? field_kinds[b].name : "");
}

/* Fails if the velocity u of a wall leads through the face with this centre (m) and area vector. */
static status check_motion(const struct initial_reader *r, const struct field *U, int p, const double u[3],
                           const double centre[3], const double area[3]) {
    const double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    if (leads_along(3, u, (u[0] * area[0] + u[1] * area[1] + u[2] * area[2]) / size)) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: U (%g %g %g) leads through the wall, as at (%g %g %g); it may lead along it only",
                dict_path(U->dict), U->patch[p].value_line, r->place->mesh->patch[p].name, u[0], u[1], u[2], centre[0],
                centre[1], centre[2]);
}

/* Fails unless a wall that moves leads along each face of its patch. */
static status check_tangential(const struct initial_reader *r, const struct field *U, int p) {
    const struct polymesh *m = r->place->mesh;
    const struct patch_field *q = &U->patch[p];
    struct patch_rules given = {
        .velocity = {.type = boundary_find(q->type), .params = q->params, .values = q->values}}; /* in axes x, y, z */
    double u[3], centre[3], area[3];
    memcpy(given.velocity.uniform, q->uniform, sizeof q->uniform);
    for (int i = 0; i < m->patch[p].nfaces; i++) {
        wall_velocity(&given, 3, i, u);
        polymesh_patch_face(m, p, i, centre, area);
        TRY(check_motion(r, U, p, u, centre, area));
    }
    return OK;
}

/* Fails on a patch that gives mass to a gas that was to have implicit acoustics: there open patches hold the pressure.
 * Automatic acoustics are explicit then. */
static status check_feed(const struct initial_reader *r, const struct initial *s, int p) {
    const struct field *U = s->field[FIELD_U];
    const struct acoustics *a = r->models->acoustics;
    if (!patch_feeds(&s->rules[p]) || !a->implicit || a->automatic) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: a flow rate is for explicit acoustics; give a velocity, or  acoustics { type "
                "explicit; }  in system/fvSolution",
                dict_path(U->dict), U->patch[p].line, r->place->mesh->patch[p].name);
}

/* Finds how the velocity that is given on a patch leads, at all times. */
static struct varying_lead lead_of(const struct polymesh *m, const struct patch_field *U, int p) {
    struct varying_lead out = {false, false, false};
    if (U->varying) return varying_lead(U->varying);
    for (int i = 0; i < m->patch[p].nfaces; i++) {
        double centre[3], normal[3];
        polymesh_patch_face(m, p, i, centre, normal);
        const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int k = 0; k < 3; k++) normal[k] /= size;
        varying_lead_note(&out, U->values ? U->values + 3L * i : U->uniform, normal);
    }
    return out;
}

/* A velocity that is given and leads along a patch everywhere, at all times, lets nothing through: that is a wall, and
 * has the row of one. Only where alpha and T are given, too, is it the state of the gas outside, and the side open. */
static status check_along(const struct initial_reader *r, struct initial *s, int p) {
    struct patch_rules *rules = &s->rules[p];
    const struct field *U = s->field[FIELD_U];
    if (!rule_fixes(&rules->velocity)) return OK;
    const struct varying_lead lead = lead_of(r->place->mesh, &U->patch[p], p);
    const bool outside = patch_gives_outside(rules);
    rules->velocity.shuts = lead.through && (outside ? lead.still : lead.along);
    s->outside[p] = outside && !lead.through;
    if (lead.through || outside) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: U is '%s' and leads along the patch, so that nothing is to flow through it, but the "
                "type lets gas through: a wall is  type %s;  (for a state outside give alpha and T, too)",
                dict_path(U->dict), U->patch[p].line, r->place->mesh->patch[p].name, U->patch[p].type,
                r->models->transport ? "noSlip;  or  type translatingWallVelocity" : "slip");
}

static status check_viscous(const struct initial_reader *r, const struct field *f, int p) {
    const struct boundary_type *type = boundary_find(f->patch[p].type);
    if (!type || !type->transport || r->models->transport) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: %s is '%s', which is nothing to a gas without viscosity and heat conduction; give "
                "`transport` in constant/granularProperties",
                dict_path(f->dict), f->patch[p].line, r->place->mesh->patch[p].name, f->kind->name, type->model.name);
}

/* Fails on a coefficient of friction of a wall in a gas that has no friction. */
static status check_friction(const struct initial_reader *r, const struct field *f, int p, const struct rule *rule) {
    if (!rule_rubs(rule) || friction_acts(r->models->friction)) return OK;
    return fail(ERR_INPUT,
                "%s:%d: patch %s: %s is '%s' with muWall, which is nothing to a gas without friction; give  friction { "
                "type muI; }  in constant/granularProperties, or here slip, or a wall without muWall",
                dict_path(f->dict), f->patch[p].line, r->place->mesh->patch[p].name, f->kind->name,
                rule->type->model.name);
}

/* Fails on a patch that is no wall by U if it is one in the mesh, or if a scalar's type belongs to walls, as
 * granularWall does. */
static status check_open(const struct initial_reader *r, struct initial *s, int p, enum field_id density,
                         enum field_id thermal) {
    const enum field_id scalars[2] = {density, thermal};
    const struct field *U = s->field[FIELD_U];
    if (!strcmp(r->place->mesh->patch[p].type, "wall"))
        return fail(ERR_INPUT,
                    "%s:%d: patch %s: U is '%s', which lets gas through, but the patch is of type wall in "
                    "%s: say here  type %s;  or, if it is open, type patch there",
                    dict_path(U->dict), U->patch[p].line, r->place->mesh->patch[p].name, U->patch[p].type,
                    polymesh_boundary_file(r->place->mesh), r->models->transport ? "noSlip" : "slip");
    for (int i = 0; i < 2; i++) {
        const struct field *f = s->field[scalars[i]];
        const struct boundary_type *type = boundary_find(f->patch[p].type);
        if (type && type->transport)
            return fail(ERR_INPUT, "%s:%d: patch %s: %s is '%s', but U is '%s', no wall; give U slip or noSlip there",
                        dict_path(f->dict), f->patch[p].line, r->place->mesh->patch[p].name, f->kind->name,
                        type->model.name, s->field[FIELD_U]->patch[p].type);
    }
    return check_along(r, s, p);
}

/* Fails on a scalar's type that gives values at a wall: there scalars are mirrored, but for T if heat crosses. */
static status check_wall(const struct initial_reader *r, const struct initial *s, int p, enum field_id density,
                         enum field_id thermal) {
    const enum field_id scalars[2] = {density, thermal};
    for (int i = 0; i < 2; i++) {
        const struct field *f = s->field[scalars[i]];
        const struct boundary_type *scalar = boundary_find(f->patch[p].type);
        const bool heated = scalars[i] == FIELD_T && r->models->transport && scalar && scalar->heat;
        if (boundary_gives(scalar) && !heated)
            return fail(ERR_INPUT,
                        "%s:%d: patch %s: U is '%s', a wall that reflects; %s cannot be '%s' there, use zeroGradient%s",
                        dict_path(f->dict), f->patch[p].line, r->place->mesh->patch[p].name,
                        s->rules[p].velocity.type->model.name, f->kind->name, scalar->model.name,
                        r->models->transport ? " (or fixedValue or granularWall for T)" : "");
    }
    return OK;
}

/* Fails if the type of a rule objects to the other rules of the patch. */
static status check_rules(const struct initial_reader *r, const struct initial *s, int p, enum field_id id,
                          const struct rule *rule) {
    const struct field *f = s->field[id];
    const char *objection = rule->type && rule->type->objection ? rule->type->objection(&s->rules[p]) : NULL;
    if (!objection) return OK;
    return fail(ERR_INPUT, "%s:%d: patch %s: %s is '%s'; %s", dict_path(f->dict), f->patch[p].line,
                r->place->mesh->patch[p].name, f->kind->name, rule->type->model.name, objection);
}

static status take_patch(const struct initial_reader *r, struct initial *s, int p) {
    struct patch_rules *rules = &s->rules[p];
    enum field_id density, thermal;
    const char *type = r->place->mesh->patch[p].type;
    if (!strcmp(type, "empty") || !strcmp(type, "cyclic")) return OK; /* the mesh gives the rule */
    TRY(which(r, s, p, FIELD_RHO, FIELD_ALPHA, &density));
    TRY(which(r, s, p, FIELD_T, FIELD_P, &thermal));
    s->from[p][0] = density;
    s->from[p][1] = FIELD_U;
    s->from[p][2] = thermal;
    for (int i = 0; i < 3; i++) TRY(take_rule(r, s, p, i));
    rules->pressure = thermal == FIELD_P;
    TRY(check_viscous(r, s->field[FIELD_U], p));
    TRY(check_viscous(r, s->field[thermal], p));
    if (!rules->velocity.type) return OK;
    TRY(check_friction(r, s->field[FIELD_U], p, &rules->velocity));
    TRY(check_friction(r, s->field[thermal], p, &rules->temperature));
    TRY(check_feed(r, s, p));
    if (!patch_is_wall(rules)) return check_open(r, s, p, density, thermal);
    if (rules->velocity.type->velocity) TRY(check_tangential(r, s->field[FIELD_U], p));
    TRY(check_wall(r, s, p, density, thermal));
    TRY(check_rules(r, s, p, FIELD_U, &rules->velocity));
    return check_rules(r, s, p, thermal, &rules->temperature);
}

static status read_all(struct initial_reader *r, const bool moved[3], struct initial *s) {
    char folder[TIME_PATH];
    if (r->place->share) s->share = *r->place->share;
    s->sliced = r->place->share != NULL;
    s->ncells = field_ncells(r->place);
    TRY(read_files(r, s));
    find_components(r, s->field[FIELD_U], moved);
    TRY(check_values(r, s));
    TRY(field_agree(r->place, take_state(r, s)));
    TRY(take_conserved(r, s));
    snprintf(folder, sizeof folder, "%s/%s", r->case_dir, r->at->folder);
    TRY(carried_start_read(folder, r->place, r->models, &s->carried));
    TRY(pool_take(&s->pool, &s->rules, s->npatches, sizeof *s->rules, "boundary rules"));
    TRY(pool_take(&s->pool, &s->from, s->npatches, sizeof *s->from, "boundary rules"));
    TRY(pool_take(&s->pool, &s->values, 3L * s->npatches, sizeof *s->values, "boundary values"));
    TRY(pool_take(&s->pool, &s->outside, s->npatches, sizeof *s->outside, "boundary rules"));
    s->packing_per_density = packing_per_density(&r->models->material);
    s->mesh = r->place->mesh;
    s->t = r->place->t;
    for (int p = 0; p < s->npatches; p++) TRY(take_patch(r, s, p));
    s->varies |= carried_start_varies(&s->carried, s->npatches);
    return carried_start_rules(&s->carried, &s->pool, s->npatches, s->rules);
}

status initial_read(const char *case_dir, const struct instant *at, const struct field_place *place, int dim,
                    const int axis[3], const bool moved[3], const struct gas_models *models, struct initial **out) {
    struct initial_reader r = {case_dir, at, place, dim, dim, {axis[0], axis[1], axis[2]}, models, NULL};
    struct initial *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "initial state"));
    s->npatches = place->mesh->npatches;
    const status e = read_all(&r, moved, s);
    if (e)
        initial_free(s);
    else
        *out = s;
    return e;
}

status initial_warn(const struct initial *s, bool transport, struct warnings *w) {
    const struct field *U = s->field[FIELD_U];
    if (s->mapped)
        TRY(warn(
            w, WARN_BESIDE,
            "%s:1: the folder has all fields of a written time, though no run wrote it, as mapFields makes it: rho, U "
            "and T are the start; alpha, p, rhoU and rhoE are left aside",
            dict_path(s->field[FIELD_RHO]->dict)));
    for (int p = 0; p < s->npatches; p++)
        if (s->outside[p])
            TRY(warn(w, WARN_OUTSIDE,
                     "%s:%d: patch %s: U is '%s' and leads along the patch; with alpha and T that is the state of the "
                     "gas outside, and gas flows through; a wall is  type %s;",
                     dict_path(U->dict), U->patch[p].line, s->mesh->patch[p].name, U->patch[p].type,
                     transport ? "noSlip;  or  type translatingWallVelocity" : "slip"));
    return OK;
}

static status read_rest(struct initial_reader *r, struct initial *s) {
    const int n = r->place->mesh->ncells;
    s->ncells = n;
    TRY(read_files(r, s));
    if (!r->flat->rests) return OK;
    TRY(check_values(r, s));
    TRY(take_state(r, s));
    TRY(pool_take(&s->pool, &s->rests, n, sizeof *s->rests, "state at rest"));
    const double per = packing_per_density(&r->models->material), least = r->flat->background * (1 + 1e-12);
    for (int i = 0; i < n; i++) s->rests[i] = per * s->rho[i] > least;
    return r->models->polynomial->degree > 1 ? initial_average(s, r->place, r->dim, r->models) : OK;
}

status initial_rest(const char *case_dir, const struct instant *at, const struct field_place *place, int dim,
                    int components, const int axis[3], const struct gas_models *models, struct initial **out) {
    struct flat_layers flat = {0};
    struct initial_reader r = {case_dir, at, place, dim, components, {axis[0], axis[1], axis[2]}, models, &flat};
    struct initial *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "state at rest"));
    const status e = read_rest(&r, s);
    if (!e && flat.rests)
        *out = s;
    else
        initial_free(s);
    return e;
}

/* Replaces the slices of n arrays by the values in the cells of this rank. */
static status fetch_own(const struct initial *s, const struct grid *grid, int n, double **const array[]) {
    long ncells;
    const int *cell = grid_cells(grid, &ncells);
    for (int i = 0; i < n; i++) {
        double *own = NULL;
        status e = comm_agree(s->share.comm, allocate(&own, ncells, sizeof *own, "the state of this rank"));
        if (!e) e = share_fetch(&s->share, 1, *array[i], ncells, cell, own);
        free(*array[i]);
        *array[i] = own;
        TRY(e);
    }
    return OK;
}

/* Gives the gas the quantities that it carries. */
static status set_carried(struct initial *s, const struct grid *grid, struct gas *g) {
    double **array[CARRIED_MOST];
    for (int i = 0; i < s->carried.n; i++) array[i] = &s->carried.phi[i];
    if (s->sliced) TRY(fetch_own(s, grid, s->carried.n, array));
    for (int i = 0; i < s->carried.n; i++) gas_set_carried(g, i, s->sliced, *array[i]);
    return OK;
}

status initial_set(struct initial *s, const struct grid *grid, struct gas *g) {
    double **array[MAX_VAR];
    const int n = s->components + 2;
    const bool exact = s->conserved[0] != NULL;
    long ncells;
    for (int v = 0; v < n; v++)
        array[v] = exact ? &s->conserved[v] : v == 0 ? &s->rho : v + 1 == n ? &s->T : &s->u[v - 1];
    if (s->sliced) TRY(fetch_own(s, grid, n, array));
    TRY(set_carried(s, grid, g));
    (void)grid_cells(grid, &ncells);
    if (exact && s->sliced)
        gas_set_own_conserved(g, (const double *const *)s->conserved);
    else if (exact)
        gas_set_conserved(g, (const double *const *)s->conserved);
    else
        return s->sliced ? gas_set_own(g, ncells, s->rho, (const double *const *)s->u, s->T)
                         : gas_set(g, s->rho, (const double *const *)s->u, s->T);
    return OK;
}

void initial_drop_fields(struct initial *s) {
    for (int i = 0; i < FIELD_COUNT; i++)
        if (s->field[i]) field_drop_cells(s->field[i]);
}

void initial_drop_cells(struct initial *s) {
    double **all[2 + 3 + MAX_VAR] = {&s->rho, &s->T};
    int n = 2;
    for (int k = 0; k < 3; k++) all[n++] = &s->u[k];
    for (int v = 0; v < MAX_VAR; v++) all[n++] = &s->conserved[v];
    initial_drop_fields(s);
    carried_start_drop(&s->carried);
    while (n--) {
        free(*all[n]);
        *all[n] = NULL;
    }
}

void initial_free(struct initial *s) {
    if (!s) return;
    initial_drop_cells(s);
    for (int i = 0; i < FIELD_COUNT; i++) field_free(s->field[i]);
    carried_start_free(&s->carried);
    pool_free(&s->pool);
    free(s);
}
