/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function object image draws fields of each written time into postProcessing/NAME/TIME.FIELD.png by the command
 * haffPlot, which lies beside the program.
 *
 * The root rank starts it when the time is on disk, and goes on at once. It waits for it before the next time is
 * finished, because purgeWrite may then remove the folder that is being read, and at the end of the run. A picture that
 * cannot be made is a warning, the first time; it never ends a run. */
#define _GNU_SOURCE /* for posix_spawn_file_actions_addclosefrom_np, environ */
#include "solvers/functions/functions_private.h"

#include "mesh/base/build.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_OPTIONS = 32, MOST_PICTURES = 16, MESSAGE = 400, OWN_WORDS = 11 };
struct image {
    const struct function *f;
    int format;
    char place[TIME_PATH + 64]; /* FILE:LINE of the entry, for warnings */
    char program[PLAIN_PATH];   /* haffPlot */
    char fields[1024];          /* with blanks between them */
    char *option[MOST_OPTIONS]; /* [noptions] */
    int noptions;
    pid_t child; /* on the root; 0: none runs */
    int output;  /* of the child: the end of a pipe from which it is read */
    bool missing, warned;
};

static const char *const formats[] = {"png", "pdf", "svg", NULL};
#define PARAM_STRUCT struct image
static const struct param image_param[] = {
    NOTED("fields", "list of words: fields of the time folders, FIELD.x, FIELDMean, grains", NULL,
          "what is drawn, each in a file of its own", "fields (U);"),
    CHOICE("format", format, 0, formats, "of the pictures"),
    NOTED("options", "list of words", "none", "options of haffPlot, which  haffPlot -help  lists",
          "options (-size 1200x800 -log);"),
};

/* Draws one field after the other, so that a run loses one processor at most. $1 .. $7 are as in draw(), the options
 * follow. If the folder of the start was given by the user it may lack fields, which are then not drawn. Variables of
 * the environment by which programs take themselves for ranks of an MPI run are unset, since haffPlot is no rank. */
static const char script[] =
    "program=$1 case=$2 time=$3 stem=$4 kind=$5 fields=$6 given=$7; shift 7; bad=0\n"
    "for v in $(env | sed -n 's/^\\(OMPI_[A-Za-z0-9_]*\\)=.*/\\1/p; s/^\\(PMIX_[A-Za-z0-9_]*\\)=.*/\\1/p'); do\n"
    "  unset \"$v\"\n"
    "done\n"
    "for field in $fields; do\n"
    "  file=\"$case/$time/${field%%.*}\"\n"
    "  if [ $given = no ] || [ $field = grains ] || [ -e \"$file\" ] || [ -e \"$file.gz\" ]; then\n"
    "    \"$program\" \"$case\" \"$field\" -time \"$time\" -o \"$stem.$field.$kind\" \"$@\" || bad=1\n"
    "  fi\n"
    "done\n"
    "exit $bad\n";

/* ---- reading ---- */

/* Checks the name of a field of the time folders, of which a component may be asked for. */
static status check_field(const struct function *f, struct dict *d, const char *word) {
    const struct offered *m = &f->setup->medium->fields;
    const char *names[MAX_QUANTITIES + 1];
    const size_t length = strcspn(word, ".");
    int n = 0;
    for (; n < m->noffered; n++) names[n] = m->quantity[n].name;
    names[n++] = "grains";
    for (const char *c = word; *c; c++)
        if (!strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.", *c) || *word == '.')
            return dict_fail(d, "fields", "'%s' is no name of a field", word);
    for (int k = 0; k < n; k++)
        if (strlen(names[k]) == length && !strncmp(word, names[k], length)) return OK;
    return length > 4 && !strncmp(word + length - 4, "Mean", 4) ? OK : dict_unknown(d, "fields", word, names, n);
}

static status read_fields(struct image *x, struct dict *d) {
    const char *const *words;
    int n;
    TRY(dict_words(d, "fields", &n, &words));
    if (!n) return dict_fail(d, "fields", "it is empty");
    if (n > MOST_PICTURES) return dict_fail(d, "fields", "%d at most", MOST_PICTURES);
    for (int i = 0; i < n; i++) {
        const size_t used = strlen(x->fields);
        TRY(check_field(x->f, d, words[i]));
        for (int j = 0; j < i; j++)
            if (!strcmp(words[i], words[j])) return dict_fail(d, "fields", "'%s' is listed twice", words[i]);
        if (used + strlen(words[i]) + 2 > sizeof x->fields) return dict_fail(d, "fields", "the names are too long");
        snprintf(x->fields + used, sizeof x->fields - used, "%s%s", i ? " " : "", words[i]);
    }
    return OK;
}

/* Takes one word or number of the list as it stands. */
static status take_option(struct image *x, const struct lexer *l, const struct token *t) {
    static const char *const taken[] = {"-o", "-time", "-help", "-h"};
    const size_t length = (size_t)t->length;
    if (t->kind != TOKEN_WORD && t->kind != TOKEN_STRING && t->kind != TOKEN_NUMBER)
        return lexer_fail(l, t, "'options' is a list of words and numbers: options (-size 1200x800 -log);");
    for (int k = 0; k < 4; k++)
        if (token_is(t, taken[k]))
            return lexer_fail(l, t, "that is not for 'options': each written time goes to a file of its own");
    if (x->noptions == MOST_OPTIONS) return lexer_fail(l, t, "'options' takes %d words at most", MOST_OPTIONS);
    TRY(pool_take(x->f->pool, &x->option[x->noptions], t->length + 1L, 1, "options"));
    memcpy(x->option[x->noptions++], t->text, length);
    return OK;
}

static status read_options(struct image *x, struct dict *d) {
    struct lexer l;
    struct token t;
    if (!dict_has(d, "options")) return OK;
    TRY(dict_raw(d, "options", &l));
    TRY(lexer_expect(&l, '('));
    TRY(lexer_next(&l, &t));
    while (!token_is(&t, ")")) {
        TRY(take_option(x, &l, &t));
        TRY(lexer_next(&l, &t));
    }
    return lexer_expect(&l, ';');
}

static status image_make(struct function *f, struct dict *d) {
    struct image *x = f->own;
    x->f = f;
    if (!f->trigger.with_fields)
        return dict_fail(d, "writeControl", "pictures are of the times that are written: leave it out");
    TRY(read_fields(x, d));
    TRY(read_options(x, d));
    snprintf(x->place, sizeof x->place, "%s:%d", dict_path(d), dict_line(d, "fields"));
    build_companion("haffPlot", sizeof x->program, x->program);
    double missing = access(x->program, X_OK) != 0;
    comm_max(f->setup->comm, &missing, 1);
    x->missing = missing > 0;
    if (!x->missing) return OK;
    return warn(&((struct setup *)(uintptr_t)f->setup)->warnings, WARN_PICTURE,
                "%s: '%s' draws nothing: %s is not there; build or install haff as a whole, with its commands",
                x->place, f->name, x->program);
}

/* ---- pictures ---- */

/* Warns of the first picture that failed; -strict, too, goes on with the run. */
static void warn_once(struct image *x, const char *reason) {
    struct warnings *w = &((struct setup *)(uintptr_t)x->f->setup)->warnings;
    if (x->warned) return;
    x->warned = true;
    struct warnings said = *w;
    said.strict = false;
    status_free(warn(&said, WARN_PICTURE, "%s: '%s' could not draw all its pictures, the run goes on: %s", x->place,
                     x->f->name, reason));
    memcpy(w->said, said.said, sizeof w->said);
}

/* Leaves the last message of haffPlot, in one line, or the last line of anything else. */
static void shorten(char reason[MESSAGE]) {
    const char *from = reason, *at;
    for (at = strstr(reason, "haffPlot: "); at; at = strstr(at + 1, "haffPlot: ")) from = at;
    if (from == reason && strncmp(reason, "haffPlot: ", 10)) from = (at = strrchr(reason, '\n')) ? at + 1 : reason;
    memmove(reason, from, strlen(from) + 1);
    for (char *c = reason; *c; c++)
        if (*c == '\n') *c = ' ';
}

/* Waits for the child, if there is one, and keeps the end of its messages. Returns whether it failed. On the root. */
static bool wait_for_child(struct image *x, char reason[MESSAGE]) {
    char more[MESSAGE];
    size_t length = 0;
    ssize_t n;
    int result = 0;
    *reason = 0;
    if (x->child <= 0) return false;
    while ((n = read(x->output, more, sizeof more / 2)) > 0 || (n < 0 && errno == EINTR)) {
        if (n < 0) continue;
        const size_t add = (size_t)n, over = length + add > MESSAGE - 1 ? length + add - (MESSAGE - 1) : 0;
        memmove(reason, reason + over, length - over);
        memcpy(reason + length - over, more, add);
        length += add - over;
        reason[length] = 0;
    }
    close(x->output);
    while (waitpid(x->child, &result, 0) < 0 && errno == EINTR) continue;
    x->child = 0;
    while (length > 0 && reason[length - 1] == '\n') reason[--length] = 0;
    shorten(reason);
    return !WIFEXITED(result) || WEXITSTATUS(result) != 0;
}

/* Waits for the pictures in hand, and lets every rank know of a failure. Collective. */
static void finish_pictures(struct image *x) {
    char reason[MESSAGE] = "";
    double failed = comm_root(x->f->setup->comm) && wait_for_child(x, reason);
    comm_max(x->f->setup->comm, &failed, 1);
    if (failed > 0) warn_once(x, reason);
}

/* Starts the script in a process group of its own, which an interrupt of the run leaves alone; all files of the run are
 * closed there, the lock of the case among them. Returns 0 or an errno. */
static int start(struct image *x, char *const *words) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t how;
    sigset_t usual;
    int ends[2];
    if (pipe(ends)) return errno;
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGXFSZ);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    posix_spawnattr_init(&how);
    posix_spawnattr_setsigdefault(&how, &usual);
    posix_spawnattr_setpgroup(&how, 0);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    const int e = posix_spawn(&x->child, "/bin/sh", &files, &how, words, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    close(ends[1]);
    if (e) close(ends[0]);
    if (e) x->child = 0;
    x->output = ends[0];
    return e;
}

/* Draws a time; returns an errno. On the root. */
static int draw(struct image *x, const char *time, const char *folder, bool given) {
    char stem[2 * TIME_PATH], *words[OWN_WORDS + MOST_OPTIONS + 1];
    snprintf(stem, sizeof stem, "%s/%s", folder, time);
    const char *const own[OWN_WORDS] = {"sh",
                                        "-c",
                                        script,
                                        "sh",
                                        x->program,
                                        x->f->setup->dir,
                                        time,
                                        stem,
                                        formats[x->format],
                                        x->fields,
                                        given ? "yes" : "no"};
    for (int i = 0; i < OWN_WORDS; i++) words[i] = (char *)(uintptr_t)own[i];
    for (int i = 0; i < x->noptions; i++) words[OWN_WORDS + i] = x->option[i];
    words[OWN_WORDS + x->noptions] = NULL;
    return start(x, words);
}

static status image_execute(struct function *f, const struct moment *now, const char *time) {
    struct image *x = f->own;
    char folder[TIME_PATH + sizeof f->name + 32];
    double failed = 0;
    if (x->missing) return OK;
    finish_pictures(x);
    snprintf(folder, sizeof folder, "%s/postProcessing/%s", f->setup->dir, f->name);
    const bool root = comm_root(f->setup->comm);
    TRY(comm_agree(f->setup->comm, root ? case_make_folders(f->setup, folder) : OK));
    if (root) failed = draw(x, time, folder, now->step == f->setup->start.step);
    comm_max(f->setup->comm, &failed, 1);
    if (failed > 0) warn_once(x, strerror((int)failed));
    return OK;
}

/* Before older times may be removed. */
static status image_save(const struct function *f, const struct field_writer *w, struct checksums *sums) {
    (void)w;
    (void)sums;
    finish_pictures(f->own);
    return OK;
}

/* The last pictures: other ranks do not wait for them. */
static void image_free(void *own) {
    struct image *x = own;
    char reason[MESSAGE];
    if (wait_for_child(x, reason)) warn_once(x, reason);
}

const struct function_type function_image = {
    .name = "image",
    .about = "pictures of the written times, by haffPlot",
    FUNCTION_PARAMS(image_param),
    .size = sizeof(struct image),
    .make = image_make,
    .execute = image_execute,
    .free = image_free,
    .no_fields = true,
    .with_fields = true,
    .reads_times = true,
    .save = image_save,
};
