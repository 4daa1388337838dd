/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit acoustics of dense cells: which cells, and when (docs/physics.md 9.2). Near packing sound limits dt to a
 * thousandth and less of what the flow would need. So the bed, dense cells and those around them (enum bed_part), takes
 * one implicit step (libcore/acoustics/bed.h), all others the Runge-Kutta step, and both share the fluxes between them:
 *
 *     half the sources | the diffusion | stages of the others | half the sources | the bed
 *
 * The bed's cells keep their state through the stages. They come last, with the fluxes of the stages towards the
 * others, because a pressure that the sources changed last would be out of balance with the weight. Gravity acts on the
 * bed in the acoustics, on other cells as in explicit steps. Where no cell is dense, or a step would not be much
 * longer, steps are explicit, to the bit; friction then acts on packed gas behind the stages (dense_rub). */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

/* Shares of the limits of dt: the greatest Courant number of what the stages advance, for in longer steps the gas
 * beside a bed at rest is thrown up again and again (settlingColumn: at 0.6 by 0.015 m/s, at 1 by 0.2 m/s, at 0.5 not
 * at all); the part of a cell of the bed that the flow carries; the part of the step that falling gas is given by the
 * explicit scheme. */
static const double BORDER = 0.5, FLOW = 0.4, FALL = 0.5;
/* If cooling limits dt of a bed in a gas that can collapse, steps become explicit once the explicit dt is below CREEP
 * times that of the loose cells: explicit steps let gas_step see the collapse, while a bed's dt would fall for ever. */
static const double CREEP = 1e-3;
/* Cells beside those denser than this fraction of alphaMax are frozen: a surface cell beside packed gas has no part in
 * its weight, and would be pushed away in the stages. */
static const double HARD = 0.98;
/* An implicit step is no gain where it takes more than BLUR of a bed's energy of motion, or LOCAL of that of a block,
 * for gain explicit steps that it saves. Waves lose 0.1 to 1, at 9 steps a period; beds that settle, pour and land 1e-6
 * to 0.01, and their blocks, heaps' surfaces among them, up to 0.03 but for the first steps of a flow. */
static const double BLUR = 0.02, LOCAL = 0.2;
/* A step that is refused costs as much as two to ten explicit ones. So behind it steps are explicit for its length,
 * behind one after the other for LONGER times the pause before, up to this number of explicit steps. */
static const double LONGER = 4, LONGEST_PAUSE = 128;
/* The restitution of grains whose cooling tells how often impacts are faster than the threshold. */
static const double MILD = 0.9;

/* With `automatic` only gases whose beds can come to rest get them, those
 * in which impacts take energy unless they are slow (thresholdSpeed). */
bool gas_may_be_dense(const struct gas_models *m) {
    if (!m->acoustics || !m->acoustics->implicit || !m->eos->bounded) return false;
    if (gas_rubs(m)) return true;
    return !m->acoustics->automatic || (m->material.threshold > 0 && source_cools(&m->source, &m->material));
}

status dense_kept(const struct gas *g) {
    struct dense *d = g->dense;
    if (d) TRY(comm_agree(g->comm, pool_take(&d->pool, &d->seen, d->sides, sizeof *d->seen, "the bed")));
    if (!d || !d->bed.rub) return OK;
    double sides = d->sides;
    comm_max(g->comm, &sides, 1);
    d->sides = (int)sides;
    const long lines = 1 + d->sides * bed_tensors(g->components);
    TRY(allocate(&d->kept, d->blocks, sizeof *d->kept, "friction"));
    TRY(allocate(&d->kept[0], d->blocks * lines * g->size, sizeof(double), "friction"));
    for (int b = 1; b < d->blocks; b++) d->kept[b] = d->kept[0] + b * lines * g->size;
    return OK;
}

status dense_make(struct gas *g) {
    const struct gas_models *m = &g->models;
    if (!gas_may_be_dense(m)) return OK;
    if (g->patches.fed && !gas_rubs(m) && m->acoustics->automatic) return OK; /* beds cannot be given mass */
    TRY(allocate(&g->dense, 1, sizeof *g->dense, "the bed"));
    struct dense *d = g->dense;
    d->bed = (struct bed){.eos = m->eos,
                          .material = &m->material,
                          .comm = g->comm,
                          .params = acoustics_params(&m->acoustics_params),
                          .dim = g->dim,
                          .components = g->components,
                          .limit = g->limits.most,
                          .carries = m->ncarried > 0};
    if (gas_rubs(m))
        d->bed.friction = (struct friction_use){m->friction, m->friction_params,
                                                m->material.diameter / sqrt(packing_per_density(&m->material))};
    double dense = d->bed.params.dense * m->material.alpha_max;
    if (gas_rubs(m)) dense = smaller(dense, m->friction_params.alpha_friction);
    d->above = dense / packing_per_density(&m->material);
    d->hard = HARD * m->material.alpha_max / packing_per_density(&m->material);
    d->thin = d->bed.params.thin * m->material.alpha_max / packing_per_density(&m->material);
    const int blocks = d->blocks = g->forest ? g->forest->ntiles : 1;
    TRY(allocate(&d->number, blocks, sizeof *d->number, "the bed"));
    TRY(allocate(&d->number[0], blocks * g->size, sizeof(int), "the bed"));
    TRY(allocate(&d->part, blocks, sizeof *d->part, "the bed"));
    TRY(allocate(&d->part[0], blocks * g->size + SLACK, sizeof(double), "the bed"));
    for (int b = 1; b < blocks; b++) {
        d->number[b] = d->number[0] + b * g->size;
        d->part[b] = d->part[0] + b * g->size;
    }
    TRY(allocate(&d->holds, blocks, sizeof *d->holds, "the bed"));
    TRY(pool_take(&d->pool, &d->flux, blocks, sizeof *d->flux, "the bed"));
    return OK;
}

void dense_free(struct gas *g) {
    if (!g->dense) return;
    bed_free(&g->dense->bed);
    arrays_free(&g->dense->arrays);
    pool_free(&g->dense->pool);
    if (g->dense->number) free(g->dense->number[0]);
    if (g->dense->part) free(g->dense->part[0]);
    if (g->dense->kept) free(g->dense->kept[0]);
    free(g->dense->kept);
    free(g->dense->part);
    free(g->dense->number);
    free(g->dense->holds);
    status_free(g->dense->failed);
    free(g->dense);
}

static const char *const cause_name[BED_CAUSES] = {"thin gas", "flow", "cooling of the bed", "free fall",
                                                   "packed gas at an open patch without pressure"};
static const char *const cause_cure[BED_CAUSES + 1] = {
    "sound of gas beside the bed is explicit: a lower `dense` takes more of it into the bed, larger cells there take "
    "longer steps, and a lower `gain` (from 2 on it pays) shorter implicit ones",
    "the bed's sound is so slow beside its flow that little can be gained: a lower `gain` (from 2 on it pays)",
    "hot dense gas keeps its explicit steps, which know its waves; a larger thresholdSpeed lets a bed rest, a larger "
    "`governor` takes longer steps all the same",
    "gravity asks for steps that short in such cells: larger cells, or a lower `gain` (from 2 on it pays)",
    "zeroGradient and inletOutlet leave open how fast packed gas flows out; a void outside says it: fixedValue 1e-6 of "
    "alpha at that patch",
    "near vacuum is that hot or fast: alphaFloor in `limits` keeps thin gas from growing so"};

/* Returns the longest step that the rate of cooling in dense cells allows. In longer ones the sources take all pressure
 * of a bed before the acoustics moves it, so that it falls onto itself and only its density brings the pressure back:
 * it packs, and sound and cooling become so fast that steps are shorter than explicit ones. Where viscous stress heats
 * what cools, a bed bears that: on demand it takes `gain` explicit steps at once even where it cools faster. Hot dense
 * gas has shocks and waves, too, which such steps blur: in grain-sized cells cooling lets sound cross four of them a
 * step at e = 0.9, at any density, until most impacts are slower than the threshold. Less inelastic gas cools more
 * slowly and has the same waves, so that it is held as if e were MILD. */
static double limit_of_cooling(const struct gas *g, double plain, double rate) {
    const struct acoustics_params *p = &g->dense->bed.params;
    const double e = g->models.material.restitution, loss = 1 - e * e, mild = 1 - MILD * MILD;
    if (!(rate > 0)) return HUGE_VAL;
    if (!g->models.acoustics->automatic && g->models.transport) return larger(p->governor / rate, p->gain * plain);
    return p->governor / (rate * larger(1, mild / loss));
}

/* Finds the limits of dt; thick: without near vacuum. */
static void find_limits(const struct gas *g, const struct bed_rates *rates, double maxCo, double plain, double fall,
                        bool thick, double limit[BED_CAUSES]) {
    limit[BY_THIN] = smaller(maxCo, BORDER) / (thick ? rates->solid : rates->thin);
    limit[BY_FLOW] = FLOW / rates->flow;
    limit[BY_COOLING] = limit_of_cooling(g, plain, rates->cooling);
    limit[BY_FALL] = FALL * fall;
    limit[BY_OUTLET] = HUGE_VAL;
}

static int least_of(const double limit[BED_CAUSES]) {
    int least = 0;
    for (int i = 1; i < BED_CAUSES; i++)
        if (limit[i] < limit[least]) least = i;
    return least;
}

/* Notes why the next step is explicit although gas is dense. */
static double refuse(struct dense *d, enum bed_cause cause, double steps, double rate, double dt) {
    d->bound =
        (struct gas_bed_bound){.cause = cause, .steps = steps, .gain = d->bed.params.gain, .rate = rate, .dt = dt};
    return 0;
}

/* Plans the next step, as gas.h says. Near vacuum above a bed is hot: where it would limit dt, `include` makes it a
 * part of the bed. */
double gas_bed_step(struct gas *g, double maxCo, const struct gas_speed *speed, double fall, const char **limit) {
    struct dense *d = g->dense;
    if (!d) return 0;
    const double plain = smaller(maxCo / speed->rate, fall), gain = d->bed.params.gain;
    /* The steps that implicit ones are compared with. A small maxCo asks for accuracy, not for implicit steps. */
    const double usual = g->models.acoustics->automatic ? smaller(larger(maxCo, 1) / speed->rate, fall) : plain;
    double step[BED_CAUSES];
    d->longest = d->cooling = 0;
    d->plain = plain;
    d->usual = usual;
    d->bound = (struct gas_bed_bound){.cause = BED_CAUSES};
    d->rubs = false;
    if (!dense_find(g)) return 0;
    d->rubs = d->bed.rub != NULL;
    const bool falls = FALL * fall < gain * usual;
    if ((d->pause > 0 || falls) && d->rubs) (void)dense_rates(g, plain); /* marks what friction acts on */
    if (d->pause > 0) return d->leans ? refuse(d, BY_OUTLET, 1, 0, plain) : 0;
    if (falls) return refuse(d, BY_FALL, FALL * fall / usual, 0, plain);
    struct bed_rates rates = dense_rates(g, plain);
    find_limits(g, &rates, maxCo, plain, fall, d->thin > 0, step);
    if (d->thin > 0) {
        if (dense_include(g, smaller(maxCo, BORDER) / step[least_of(step)])) rates = dense_rates(g, plain);
        find_limits(g, &rates, maxCo, plain, fall, false, step);
    }
    const int least = least_of(step);
    const double rate[] = {rates.thin, rates.flow, rates.cooling, 0};
    if (!(step[least] >= gain * usual && step[least] > plain) ||
        (least == BY_COOLING && gas_can_collapse(g) && speed->rate * CREEP > speed->loose))
        return refuse(d, least, step[least] / usual, rate[least], plain);
    *limit = cause_name[least];
    d->beside = rates.thin;
    return d->longest = step[least];
}

bool gas_bed_refused(const struct gas *g) {
    return g->dense && g->dense->bound.cause < BED_CAUSES;
}

void gas_bed_bound(struct gas *g, struct gas_bed_bound *out) {
    struct dense *d = g->dense;
    if (d->bound.rate > 0) {
        dense_seek(g, d->bound.cell.place);
        look_at(g, &d->bound.cell);
    }
    *out = d->bound;
    out->name = cause_name[out->cause];
    const bool near_void = out->rate > 0 && out->cell.alpha < d->bed.params.thin * g->models.material.alpha_max;
    out->cure = cause_cure[near_void ? BED_CAUSES : out->cause];
}

double gas_inertia(const struct gas *g) {
    return g->dense && g->dense->longest > 0 ? g->dense->inertia : HUGE_VAL;
}

/* Finds the place of a cell of the bed. */
static void seat_of(const struct dense *d, int cell, struct row *out) {
    const struct row *r = d->row;
    for (; cell >= r->n; r++) cell -= r->n;
    *out = (struct row){r->block, r->at + cell, 1};
}

/* Finds the centre of the cell that loses most of its sound in the step of the bed. */
static void find_peak(const struct gas *g, double place[3]) {
    const struct bed_set *b = g->dense->bed.home;
    struct first_place first = {.order = HUGE_VAL};
    double most = 0;
    for (int i = 0; i < b->blocks; i++) most = larger(most, b->peak[i]);
    comm_max(g->comm, &most, 1);
    for (int i = 0; i < b->blocks; i++) {
        struct row seat;
        double here[3];
        if (!(b->peak[i] == most) || b->first[i + 1] == b->first[i]) continue;
        seat_of(g->dense, b->first[i] + b->peak_cell[i], &seat);
        g->engine->state.place(g, seat.block, seat.at, here);
        first_place_offer(&first, here);
    }
    first_place_agree(g, &first, place);
}

/* Does a step of dt damp what moves by sound? Then it is counted. The measure is the energy that it takes, and from
 * twice gain explicit steps on that energy per explicit step saved: a bed whose sound crosses it many times in a step
 * has none to lose; what changes then is the slow flow, at a small part of the cost of explicit steps. A step that ends
 * early, at a time to be written, counts as if it had gone on: L is as dt^2. */
static bool damps(struct gas *g, double dt) {
    const struct dense *d = g->dense;
    const struct bed_blur *part = &d->bed.blur;
    const double saved = dt / (d->bed.params.gain * d->usual), worth = larger(smaller(saved * saved, 1), 0.5 * saved);
    if (!(part->whole > BLUR * worth || part->local > LOCAL * worth)) return false;
    g->counts.now.damped++;
    if (part->local > g->counts.now.damping) {
        g->counts.now.damping = part->local;
        find_peak(g, g->counts.now.damped_at);
    }
    return true;
}

/* Does packed gas lean on an open patch that gives no pressure? Then a step of the bed is wrong: gas on such a face
 * moves as its cell did at the start, whatever p becomes, and gas that is pushed back in brings the pressure of the
 * bed. */
static bool leans(const struct gas *g) {
    const struct dense *d = g->dense;
    const struct bed_set *b = d->bed.home;
    double found = 0;
    for (int i = 0; i < d->borders; i++) {
        const int f = d->border[i].face, inside = (b->left[f] < 0 ? b->right[f] : b->left[f]) - b->low;
        if (b->kind[f] == BED_OPEN && b->holds[f] == 0 && b->U[0][inside] > d->above) found = 1;
    }
    comm_max(g->comm, &found, 1);
    return found > 0;
}

bool dense_refused(struct gas *g, double *dt) {
    struct dense *d = g->dense;
    if (!d || !d->refused) return false;
    d->refused = g->step.hybrid = false;
    d->longest = 0;
    d->paused = d->pause = larger(*dt, smaller(LONGER * d->paused, LONGEST_PAUSE * d->usual));
    /* the last two steps before an event share what is left (solvers/case/control.c), as if this had been planned */
    *dt = *dt < 2 * d->plain ? 0.5 * *dt : d->plain;
    flags_clear(g);
    return true;
}

void dense_pass(struct gas *g, double dt) {
    if (g->dense) g->dense->pause = larger(g->dense->pause - dt, 0);
}

void dense_keep(struct gas *g, double weight) {
    const struct dense *d = g->dense;
    const struct bed_set *bed = d->bed.home;
    for (int i = 0; i < d->borders; i++) {
        const struct dense_border *b = &d->border[i];
        const double *flux = d->flux[b->block] + b->through, area = g->blocks.area ? g->blocks.area[b->through] : 1;
        if (bed->kind[b->face] != BED_KEPT) continue;
        for (int v = 0; v < g->nvar; v++) bed->kept[v][b->face] += weight * flux[v * g->blocks.faces] / area;
    }
    bed_write(&g->dense->bed);
}

bool dense_rub(struct gas *g, double t, double dt, const struct state *to) {
    struct dense *d = g->dense;
    bool done = false;
    d->failed = dense_listed(g);
    if (d->failed) return false;
    source_kick(&g->models.source, t, dt, d->kick);
    for (int k = 0; k < MAX_DIM; k++) d->kick[k] /= dt;
    spans_unfold(g, to, d->holds);
    dense_take(g, to);
    dense_take_friction(g);
    d->failed = bed_rub_alone(&d->bed, dt, d->kick, &done);
    if (d->failed || !done) return false;
    double bad = (double)dense_put(g, to);
    comm_max(g->comm, &bad, 1);
    return bad == 0;
}

bool dense_advance(struct gas *g, double t, double dt, bool guarded, const struct state *to) {
    struct dense *d = g->dense;
    bool done = false;
    d->refused = d->leans = leans(g);
    if (d->refused) return false;
    source_kick(&g->models.source, t, dt, d->kick);
    for (int k = 0; k < MAX_DIM; k++) d->kick[k] /= dt;
    d->failed = bed_step(&d->bed, dt, d->kick, &done);
    if (d->failed || !done) return false;
    /* a bed at rest by friction has no motion to compare with */
    d->refused = !d->bed.rub && damps(g, dt) && g->models.acoustics->automatic;
    if (d->refused) return false;
    double bad = (double)dense_put(g, to);
    comm_max(g->comm, &bad, 1);
    g->floors.share = 1;
    d->begun = false; /* from here on the floors count the cells that they raise */
    if (bad > 0 && guarded) bad = (double)floors_apply(g, to);
    comm_max(g->comm, &bad, 1);
    return bad == 0;
}

void dense_spread(const struct gas *g, const double *per_block, double *raised) {
    memset(raised, 0, (size_t)g->floors.places * sizeof *raised);
    for (int b = 0; b < g->dense->bed.home->blocks; b++) {
        const int place = g->dense->place[b];
        raised[place] += per_block[b] / (g->blocks.volume ? g->blocks.volume[place] : 1);
    }
}

status dense_count(struct gas *g) {
    struct dense *d = g->dense;
    long count[2] = {d->bed.lifted, d->bed.set.cells};
    double sum;
    comm_sum_long(g->comm, count, 2);
    d->paused = 0;
    g->counts.now.beds++;
    g->counts.now.newton += d->bed.newton;
    g->counts.now.linear += d->bed.linear;
    g->counts.now.lifted += count[0];
    g->counts.now.bed_cells = count[1];
    if (count[0] == 0) return OK;
    dense_spread(g, d->bed.home->lift, g->floors.raised);
    TRY(sum_raised(g, g->floors.raised, &sum));
    g->counts.now.lift += sum;
    return OK;
}
