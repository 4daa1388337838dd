/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thousands of small random problems, each of which must end well: see README.md. */
#include "tests/stress/run.h"
#include "tests/stress/table.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const char usage[] =
    "stress [-problem NAME [-seed N]] [-scheme S] [-count N] [-from N] [-list FILE] [-table DIR] [-checksums] [-bare] "
    "[-full] [-explicit] [-views] [-short]\n"
    "       [-cap STEPS] [-most STEPS] [-fraction F] [-verbose] [-names]\n"
    "  runs problems of all families (or of one), seeds from N on, COUNT of them, or those of a file, and fails if "
    "one\n"
    "  fails; S is default, or flux/reconstruct/polynomial/timeScheme/maxCo\n";

static const struct scheme standard = {"common", "WPENO5", "CWENO3", "SSPRK43", 1};

struct request {
    struct run_options run;
    struct scheme scheme;
    const char *problem, *list, *table;
    uint64_t from;
    long count, schemes;           /* schemes: problems with each of the others */
    bool checksums, export, views; /* views: compares with other ways to see it (view.c) */
};

static bool parse_scheme(char *text, struct scheme *s) {
    char *part[5] = {0};
    int n = 0;
    if (!strcmp(text, "default")) return true;
    for (char *p = strtok(text, "/"); p && n < 5; p = strtok(NULL, "/")) part[n++] = p;
    if (n < 5) return false;
    *s = (struct scheme){part[0], part[1], part[2], part[3], atof(part[4])};
    return s->courant > 0;
}

static bool parse(int argc, char **argv, struct request *r) {
    for (int i = 1; i < argc; i++) {
        const char *a = argv[i];
        char *next = i + 1 < argc ? argv[i + 1] : NULL;
        bool used = true;
        if (!strcmp(a, "-bare"))
            r->run.bare = true, used = false;
        else if (!strcmp(a, "-full"))
            r->run.full = true, used = false;
        else if (!strcmp(a, "-explicit"))
            r->run.explicit = true, used = false;
        else if (!strcmp(a, "-verbose"))
            r->run.verbose = true, used = false;
        else if (!strcmp(a, "-short"))
            r->run.brief = true, used = false;
        else if (!strcmp(a, "-views"))
            r->views = true, used = false;
        else if (!strcmp(a, "-checksums"))
            r->checksums = true, used = false;
        else if (!strcmp(a, "-export"))
            r->export = true, used = false;
        else if (!next)
            return false;
        else if (!strcmp(a, "-problem"))
            r->problem = next;
        else if (!strcmp(a, "-seed"))
            r->from = strtoull(next, NULL, 10), r->count = 1;
        else if (!strcmp(a, "-from"))
            r->from = strtoull(next, NULL, 10);
        else if (!strcmp(a, "-count"))
            r->count = atol(next);
        else if (!strcmp(a, "-schemes"))
            r->schemes = atol(next);
        else if (!strcmp(a, "-cap"))
            r->run.cap = atoi(next);
        else if (!strcmp(a, "-most"))
            r->run.most = atoi(next);
        else if (!strcmp(a, "-fraction"))
            r->run.fraction = atof(next);
        else if (!strcmp(a, "-list"))
            r->list = next;
        else if (!strcmp(a, "-table"))
            r->table = next;
        else if (strcmp(a, "-scheme") != 0 || !parse_scheme(next, &r->scheme))
            return false;
        i += used;
    }
    return !r->problem || family_find(r->problem) >= 0;
}

static void print_transport(const struct problem *p, const struct outcome *o) {
    const struct model *law = &p->transport->model;
    printf("  %s by %s:", law->name, p->diffusion->model.name);
    for (int i = 0; i < law->nparam; i++) {
        const struct param *q = &law->param[i];
        const void *own = (const char *)&p->transport_params + q->offset;
        if (q->kind == PARAM_CHOICE)
            printf(" %s %s", q->name, q->words[*(const int *)own]);
        else
            printf(" %s %.3g", q->name, *(const double *)own);
    }
    printf("; cooling %s", p->source.cooling ? p->source.cooling->model.name : "none");
    for (int i = 0; i < source_count; i++)
        if (p->source.on[i]) printf(", %s %.3g", source_table[i].model.name, p->source.params[i].room[0]);
    printf("; floor %.2g; %ld halves, %ld repeated, %ld cells plain, stages %ld %ld\n  walls", p->alpha_floor,
           o->counts.halves, o->counts.repeated, o->counts.plain, o->counts.stages[0], o->counts.stages[1]);
    for (int i = 0; i < 2 * p->dim && p->wall[i].velocity; i++)
        printf(" (%s %s)", p->wall[i].velocity, p->wall[i].temperature);
    printf("\n");
}

static void print_friction(const struct problem *p, const struct outcome *o) {
    const struct friction_params *f = &p->friction_params;
    printf("  %s mu %.3g to %.3g, I0 %.3g, s from %.3g to %.3g, G %.3g, cohesion %.3g, %.3g, heats %.3g: gave %.3g;"
           " %d components, walls",
           p->friction->model.name, f->mu_static, f->mu_dynamic, f->I0, f->alpha_friction, f->alpha_solid, f->modulus,
           f->cohesion, f->surface_cohesion, f->heating, o->rubbed, p->components ? p->components : p->dim);
    for (int i = 0; i < 2 * p->dim; i++)
        printf(" (%s %.2g %.2g)", p->wall[i].velocity, p->wall[i].mu, p->wall[i].along);
    printf("\n");
}

static void print_outcome(const struct problem *p, const struct scheme *s, const struct outcome *o) {
    static const char *const words[] = {"finished", "capped", "collapsed", "stated", "FAILED"};
    printf("%s seed %llu %s/%s/%s/%s/%g: %s, %d steps, %d cells; limited %ld cells %ld faces, floored %ld, rejected "
           "%ld, least dt %.3g, packed 1 - %.3g, reached %.3g of the time\n",
           family_table[p->family].name, (unsigned long long)p->seed, s->flux, s->reconstruct, s->polynomial,
           s->stepper, s->courant, words[o->verdict], o->steps, o->cells, o->counts.cells, o->counts.faces,
           o->counts.floored, o->counts.rejected, o->least, 1 - o->packed, o->reached);
    printf("  drift over its bound: mass %.3g momentum %.3g energy %.3g; source %.3g\n", o->drift[0], o->drift[1],
           o->drift[2], o->source);
    printf("  %s e %.4g, cooling %d, threshold %.3g, alphaMax %.4g, sigma %.3g, gamma %.4g, g %.3g, %s, %dD %s\n",
           p->eos->model.name, p->material.restitution, p->source.cooling != NULL, p->material.threshold,
           p->material.alpha_max, p->material.diameter, p->material.gamma, p->source.gravity[0],
           p->edge == CLOSED     ? "closed"
           : p->edge == PERIODIC ? "periodic"
                                 : "open",
           p->dim,
           !p->polyhedral                              ? "lattice"
           : p->shape == TRIANGLES || p->shape == TETS ? "simplices"
                                                       : "boxes");
    if (p->acoustics)
        printf("  %ld implicit steps, %.3g Newton a step, %.3g linear each, lifted %ld\n", o->counts.beds,
               (double)o->counts.newton / larger((double)o->counts.beds, 1),
               (double)o->counts.linear / larger((double)o->counts.newton, 1), o->counts.lifted);
    if (p->friction) print_friction(p, o);
    if (p->radial >= 0)
        printf("  round, radius along axis %d from %.3g, swirl %.3g\n", p->radial, p->inner,
               p->swirl ? p->wave[4][p->swirl] : 0);
    if (p->transport) print_transport(p, o);
    if (o->why[0]) printf("  %s\n", o->why);
}

/* dim, cells along the axes, gamma, end time of the run just made; a line of rho, u, T per cell. Lattices only. */
static void export(const struct problem *p, double end) {
    printf("%d %d %d %d %.17g %.17g\n", p->dim, p->n[0], p->n[1], p->n[2], p->material.gamma, end);
    for (int i = 0; i < p->cells; i++) {
        const int at[3] = {i % p->n[0], i / p->n[0] % p->n[1], i / p->n[0] / p->n[1]};
        double x[3], rho, u[3], T;
        for (int k = 0; k < 3; k++) x[k] = (at[k] + 0.5) / p->n[k];
        problem_state(p, x, &rho, u, &T);
        printf("%.17g %.17g %.17g %.17g %.17g\n", rho, u[0], u[1], u[2], T);
    }
}

/* A problem that hangs ends them all, and says its name. It is given seconds of the processor: the clock goes on while
 * other programs have it. */
enum { MOST_SECONDS = 600 };
static char at_work[100];
static void on_alarm(int number) {
    (void)number;
    (void)!write(STDOUT_FILENO, at_work, strlen(at_work));
    _exit(1);
}
static void set_alarm(long seconds) {
    (void)setitimer(ITIMER_PROF, &(struct itimerval){.it_value.tv_sec = seconds}, NULL);
}
static void watch_clock(const char *family, uint64_t seed) {
    (void)signal(SIGPROF, on_alarm);
    snprintf(at_work, sizeof at_work, "%s seed %llu: no end after %d s of processor time\n", family,
             (unsigned long long)seed, MOST_SECONDS);
    set_alarm(MOST_SECONDS);
}

/* Takes from a problem what time scheme `local` is not there for; false: it is not there for what remains. */
static bool suits(struct problem *p, const struct scheme *s) {
    const struct stepper *stepper = stepper_find(s->stepper);
    const struct polynomial *polynomial = polynomial_find(s->polynomial);
    const struct flux *flux = flux_find(s->flux);
    if (!stepper || !stepper->local || !polynomial || !flux) return true;
    return polynomial->degree < 2 && !flux->paced && problem_spare(p);
}

/* Runs and counts one; those that do not suit the scheme are left out. */
static status one(const struct request *r, const struct comm *c, int family, uint64_t seed, const struct scheme *s,
                  struct table *t, long *failed) {
    struct outcome o;
    struct problem p = problem_draw(family, seed);
    if (!suits(&p, s)) return OK;
    watch_clock(family_table[family].name, seed);
    TRY(stress_run(&p, s, &r->run, c, &o));
    if (r->views) TRY(views_compare(&p, s, &r->run, c, &o));
    set_alarm(0);
    table_add(t, &p, s, &o);
    *failed += o.verdict == FAILED;
    if (r->export) {
        export(&p, o.end);
        return OK;
    }
    if (!comm_root(c)) return OK;
    if (o.verdict == FAILED || r->run.verbose || r->count == 1) print_outcome(&p, s, &o);
    if (r->checksums)
        printf("%s %llu %d %d %016llx\n", family_table[family].name, (unsigned long long)seed, (int)o.verdict, o.steps,
               (unsigned long long)o.checksum);
    fflush(stdout);
    return OK;
}

/* Lines: NAME SEED SCHEME # why it is here */
static status run_list(const struct request *r, const struct comm *c, struct table *t, long *failed) {
    char line[300], name[64], scheme[128];
    unsigned long long seed;
    FILE *f = fopen(r->list, "r");
    status e = f ? OK : fail(ERR_INPUT, "%s: cannot be read", r->list);
    while (!e && fgets(line, sizeof line, f)) {
        struct scheme s = r->scheme;
        if (line[0] == '#' || line[0] == '\n') continue;
        if (sscanf(line, "%63s %llu %127s", name, &seed, scheme) != 3 || family_find(name) < 0 ||
            !parse_scheme(scheme, &s))
            e = fail(ERR_INPUT, "%s: not a problem: %s", r->list, line);
        else
            e = one(r, c, family_find(name), seed, &s, t, failed);
    }
    if (f) (void)fclose(f);
    return e;
}

/* Family after family in turn. */
static status run_many(const struct request *r, const struct comm *c, struct table *t, long *failed) {
    for (long i = 0; i < r->count; i++) {
        int family = r->problem ? family_find(r->problem) : (int)(i % FAMILIES);
        uint64_t seed = r->from + (uint64_t)(r->problem ? i : i / FAMILIES);
        TRY(one(r, c, family, seed, &r->scheme, t, failed));
    }
    return OK;
}

/* Problems of the families below `polyhedral`, or from it on, in turn. */
static status run_scheme(const struct request *r, const struct comm *c, const struct scheme *s, bool cells,
                         struct table *t, long *failed) {
    const int first = family_find("triangles"), from = cells ? first : 0, many = cells ? FAMILIES - first : first;
    for (long i = 0; i < r->schemes; i++)
        TRY(one(r, c, from + (int)(i % many), r->from + (uint64_t)(i / many), s, t, failed));
    return OK;
}

/* Every row of the tables with every other, at the largest Courant number its time scheme states. */
static status run_schemes(const struct request *r, const struct comm *c, struct table *t, long *failed) {
    for (int f = 0; f < flux_count; f++)
        for (int i = 0; i < stepper_count; i++) {
            const struct stepper *p = &stepper_table[i];
            struct scheme s = {flux_table[f].model.name, standard.reconstruct, standard.polynomial, p->model.name,
                               p->courant};
            for (int j = 0; j < reconstruct_count; j++) {
                s.reconstruct = reconstruct_table[j].model.name;
                TRY(run_scheme(r, c, &s, false, t, failed));
            }
            for (int j = 0; j < polynomial_count; j++) {
                s.polynomial = polynomial_table[j].model.name;
                TRY(run_scheme(r, c, &s, true, t, failed));
            }
        }
    return OK;
}

static status write_table(const char *path, const struct table *t) {
    FILE *f = fopen(path, "w");
    if (!f) return fail(ERR_SYSTEM, "%s: cannot be written", path);
    table_print(f, t);
    return fclose(f) ? fail(ERR_SYSTEM, "%s: cannot be written", path) : OK;
}

static status run_all(const struct request *r, const struct comm *c) {
    struct table t = {.rows = 0};
    long failed = 0;
    status e = OK;
    if (r->list) e = run_list(r, c, &t, &failed);
    if (!e && r->count) e = run_many(r, c, &t, &failed);
    if (!e && r->schemes) e = run_schemes(r, c, &t, &failed);
    if (!e && comm_root(c) && r->table) e = write_table(r->table, &t);
    if (!e && comm_root(c) && !r->checksums && !r->export) table_summary(stdout, &t);
    table_free(&t);
    if (!e && failed) e = fail(ERR_STATE, "%ld problems failed", failed);
    return e;
}

int main(int argc, char **argv) {
    struct comm *c;
    struct request r = {.run = {.cap = 120, .fraction = 1e-3}, .scheme = standard};
    status s = comm_start(&argc, &argv, &c);
    if (s) return status_print(s, true);
    if (argc == 2 && !strcmp(argv[1], "-names")) {
        for (int i = 0; i < FAMILIES; i++) printf("%-12s %s\n", family_table[i].name, family_table[i].about);
    } else {
        s = parse(argc, argv, &r) ? run_all(&r, c) : fail(ERR_INPUT, "%s", usage);
    }
    int code = comm_root(c) ? status_print(s, false) : s != OK;
    status_free(s);
    comm_finish(c);
    return code;
}
