/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds, names, writes, verifies and removes time folders (times.h). */
#include "solvers/case/times.h"

#include "mesh/format/files.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool time_value(const char *name, double *t) {
    char *end;
    if (!strchr("0123456789+-.", name[0]) || strlen(name) >= TIME_NAME) return false;
    *t = strtod(name, &end);
    return end != name && !*end && isfinite(*t) && !strpbrk(name, "xXpP");
}

/* Returns half a unit of the last digit of a time's name: the name was rounded to it. */
static double name_slack(const char *name) {
    const char *dot = strchr(name, '.'), *exponent = strpbrk(name, "eE");
    double decimals = dot ? (double)strspn(dot + 1, "0123456789") : 0;
    return 0.51 * pow(10, (exponent ? strtod(exponent + 1, NULL) : 0) - decimals);
}

/* Reads uniform/time of a folder; if that fails, *at stays as it was. */
static status stamp_read(const char *case_dir, struct instant *at) {
    char path[TIME_PATH];
    snprintf(path, sizeof path, "%s/%s/uniform/time", case_dir, at->name);
    if (access(path, F_OK)) return OK;
    struct dict *d = NULL;
    TRY(dict_read(path, &d));
    long digits = at->digits;
    double index = 0, named = strtod(at->name, NULL);
    struct instant in = *at;
    status s = dict_number(d, "value", NULL, &in.t);
    if (!s && fabs(in.t - named) > name_slack(at->name))
        s = dict_fail(d, "value", "the folder is that of time %s", at->name);
    if (!s) s = dict_number(d, "index", NULL, &index);
    if (!s) s = dict_count_or(d, "index", 0, &in.step);
    if (!s) s = dict_count_or(d, "writePrecision", digits, &digits);
    if (!s && (digits < 1 || digits > 17)) s = dict_fail(d, "writePrecision", "allowed is 1 to 17");
    if (!s) s = dict_number_or(d, "deltaT", NULL, 0, &in.delta_t);
    in.digits = (int)digits;
    if (!s) *at = in;
    dict_free(d);
    return s;
}

static int by_time(const void *a, const void *b) {
    const struct instant *p = a, *q = b;
    return p->t < q->t ? -1 : p->t > q->t;
}

bool time_is_original(const struct instant *at) {
    return strcmp(at->folder, TIME_ORIGINAL) == 0;
}

bool time_original(const char *case_dir, struct instant *out) {
    char path[TIME_PATH];
    struct stat info;
    snprintf(path, sizeof path, "%.4000s/" TIME_ORIGINAL, case_dir);
    if (stat(path, &info) || !S_ISDIR(info.st_mode)) return false;
    *out = (struct instant){.name = "0", .folder = TIME_ORIGINAL, .digits = 6};
    return true;
}

status times_list(const char *case_dir, int *n, struct instant **out) {
    *n = 0;
    *out = NULL;
    DIR *folder = opendir(case_dir);
    if (!folder) return fail(ERR_INPUT, "%s: %s; give the folder of a case (-case DIR)", case_dir, strerror(errno));
    status s = OK;
    int room = 0;
    for (struct dirent *entry; !s && (entry = readdir(folder));) {
        struct instant at = {.digits = 6};
        char path[TIME_PATH];
        struct stat info;
        if (!time_value(entry->d_name, &at.t)) continue;
        snprintf(path, sizeof path, "%s/%s", case_dir, entry->d_name);
        if (stat(path, &info) || !S_ISDIR(info.st_mode)) continue;
        memcpy(at.name, entry->d_name, strlen(entry->d_name) + 1);
        memcpy(at.folder, at.name, sizeof at.name);
        status_free(stamp_read(case_dir, &at)); /* time_verify reports it for the time that is used */
        if (*n == room) {
            struct instant *more = realloc(*out, (size_t)(room = 2 * room + 16) * sizeof *more);
            if (more)
                *out = more;
            else
                s = fail(ERR_SYSTEM, "out of memory");
        }
        if (!s) (*out)[(*n)++] = at;
    }
    closedir(folder);
    if (s) {
        free(*out);
        *out = NULL;
        return s;
    }
    if (*n) qsort(*out, (size_t)*n, sizeof **out, by_time);
    return OK;
}

static status no_such_time(const char *case_dir, const struct control *c, int n, const struct instant *list) {
    char names[512] = "";
    for (int i = 0; i < n; i++) {
        size_t length = strlen(names);
        if (length + TIME_NAME + 4 > sizeof names) {
            memcpy(names + length, " ...", 5);
            break;
        }
        snprintf(names + length, sizeof names - length, " %s", list[i].name);
    }
    return dict_fail(c->dict, "startTime", "there is no such time folder in %s; there are:%s", case_dir, names);
}

status time_verify(const char *case_dir, const struct instant *at) {
    char folder[TIME_PATH];
    if (time_is_original(at)) return OK;
    struct instant again = *at;
    snprintf(folder, sizeof folder, "%.4000s/%s", case_dir, at->name);
    TRY(checksums_verify(folder));
    return stamp_read(case_dir, &again);
}

/* Finds the newest whole time before list[*at]; *at < 0: there is none. */
static void find_whole(const char *case_dir, const struct instant *list, int *at) {
    while (--*at >= 0) {
        status s = time_verify(case_dir, &list[*at]);
        if (!s) return;
        status_free(s);
    }
}

/* Chooses another time where list[*at] is damaged, or says how to cure the damage. */
static status fall_back(const char *case_dir, const struct control *c, const struct instant *list, int *at,
                        status damage) {
    const char *name = list[*at].name;
    char cure[300] = "no time before it is whole: put the file back from a copy";
    find_whole(case_dir, list, at);
    if (*at >= 0 && c->previous_if_corrupt) {
        printf("\nnote: time %s is damaged and left aside, as  onCorruptTime previous;  asks:\n    %s\n    The run "
               "goes on from time %s, the newest whole one before it.\n\n",
               name, status_text(damage), list[*at].name);
        status_free(damage);
        return OK;
    }
    if (*at >= 0)
        snprintf(cure, sizeof cure,
                 "start from the time before it (remove or rename the folder %s, or say  onCorruptTime previous;  in "
                 "system/controlDict): %s is whole",
                 name, list[*at].name);
    char path[TIME_PATH], purpose[TIME_PATH + 80] = "";
    snprintf(path, sizeof path, "%.3900s/%s/uniform/checksums", case_dir, name);
    if (!access(path, F_OK))
        snprintf(purpose, sizeof purpose, "; or, if the file was changed on purpose, remove %s", path);
    status s = fail(ERR_INPUT, "%s; %s%s", status_text(damage), cure, purpose);
    status_free(damage);
    return s;
}

/* Looks through the files of TIME_ORIGINAL: when the newest was changed, and which of them another folder lacks. */
static status look_through(const char *case_dir, const char *other, double *newest, double *other_newest,
                           char lacks[TIME_NAME]) {
    char path[TIME_PATH];
    struct stat info;
    *newest = *other_newest = -HUGE_VAL;
    snprintf(path, sizeof path, "%.3900s/" TIME_ORIGINAL, case_dir);
    DIR *folder = opendir(path);
    if (!folder) return file_error(path, "cannot be read", errno);
    for (struct dirent *entry; (entry = readdir(folder));) {
        const char *const folders[] = {TIME_ORIGINAL, other}, *end = strrchr(entry->d_name, '.');
        const int length = (int)(end && !strcmp(end, ".gz") ? end - entry->d_name : (long)strlen(entry->d_name));
        bool found = false;
        if (*entry->d_name == '.' || entry->d_name[strlen(entry->d_name) - 1] == '~') continue;
        for (int k = 0; k < 4; k++) {
            double *to = k < 2 ? newest : other_newest;
            snprintf(path, sizeof path, "%.3000s/%s/%.*s%s", case_dir, folders[k / 2], length, entry->d_name,
                     k % 2 ? ".gz" : "");
            if (stat(path, &info)) continue;
            found |= k >= 2;
            if (S_ISREG(info.st_mode))
                *to = fmax(*to, (double)info.st_mtim.tv_sec + 1e-9 * (double)info.st_mtim.tv_nsec);
        }
        if (!found) snprintf(lacks, TIME_NAME, "%.*s", length, entry->d_name);
    }
    closedir(folder);
    return OK;
}

/* Is a time 0 that no run wrote newer than TIME_ORIGINAL, with all its files? Else it is an error. */
static status check_beside(const char *case_dir, const char *name) {
    double original, newest;
    char lacks[TIME_NAME] = "";
    TRY(look_through(case_dir, name, &original, &newest, lacks));
    if (!*lacks && newest >= original) return OK;
    return fail(ERR_INPUT,
                "%s/%s: " TIME_ORIGINAL
                " is there, too, from which a run writes the time 0, and no run has written this "
                "folder, which %s%s; remove or rename one of the two",
                case_dir, name, *lacks ? "lacks " : "is older", lacks);
}

/* Puts `original` in place of the times 0 of the list, which runs wrote from it; the list has room for one more. */
static status put_original(const char *case_dir, const struct instant *original, int *n, struct instant *list) {
    int left = 0;
    bool beside = false;
    for (int i = 0; i < *n; i++) {
        char path[TIME_PATH];
        snprintf(path, sizeof path, "%.3900s/%s/uniform/time", case_dir, list[i].name);
        const bool own = list[i].t == 0 && access(path, F_OK);
        if (own) TRY(check_beside(case_dir, list[i].name));
        list[i].beside = own;
        beside |= own;
        if (own || list[i].t != 0) list[left++] = list[i];
    }
    *n = left + !beside;
    if (beside) return OK;
    list[left] = *original;
    qsort(list, (size_t)*n, sizeof *list, by_time);
    return OK;
}

/* Lists the times that a run can start from. */
static status list_starts(const char *case_dir, const struct control *c, int *n, struct instant **out) {
    struct instant original, *more;
    TRY(times_list(case_dir, n, out));
    if (!time_original(case_dir, &original)) return OK;
    time_name(c->time_format, c->time_precision, 0, original.name);
    more = realloc(*out, (size_t)(*n + 1) * sizeof *more);
    if (more) *out = more;
    status s = more ? put_original(case_dir, &original, n, *out) : fail(ERR_SYSTEM, "out of memory");
    if (s) free(*out);
    return s;
}

/* Fails if the time 0 that a run wrote from TIME_ORIGINAL was changed since: the run that starts would lose the change.
 */
static status check_made(const char *case_dir, const struct instant *at) {
    char folder[TIME_PATH];
    snprintf(folder, sizeof folder, "%.4000s/%s", case_dir, at->name);
    return status_note(access(folder, F_OK) ? OK : checksums_verify(folder),
                       "%s: a run writes it anew from " TIME_ORIGINAL ": make changes there and remove this folder, or "
                       "remove " TIME_ORIGINAL " to start from this folder as it is",
                       folder);
}

status times_start(const char *case_dir, const struct control *c, bool afresh, struct instant *out) {
    int n;
    struct instant *list;
    TRY(list_starts(case_dir, c, &n, &list));
    if (!n)
        return fail(ERR_INPUT,
                    "%s: no time folder to start from; the initial fields belong in %s/" TIME_ORIGINAL
                    ", from which a run writes %s/0",
                    case_dir, case_dir, case_dir);
    int found = c->start_from == START_LATEST ? n - 1 : c->start_from == START_FIRST ? 0 : -1;
    for (int i = 0; i < n && c->start_from == START_TIME; i++)
        if (fabs(list[i].t - c->start_time) <= 1e-9 * fmax(fabs(c->start_time), fabs(list[i].t)) ||
            strtod(list[i].name, NULL) == c->start_time)
            found = i;
    bool beside = false;
    for (int i = 0; i < n && afresh; i++) {
        beside |= list[i].beside;
        if (time_is_original(&list[i])) found = i;
    }
    if (afresh && (found < 0 || !time_is_original(&list[found]))) {
        free(list);
        return fail(ERR_INPUT, "%s: there is no folder " TIME_ORIGINAL " to write the time 0 from%s", case_dir,
                    beside ? ", but a 0 that no run wrote and that counts: rename one of the two" : "");
    }
    status s = found < 0 ? no_such_time(case_dir, c, n, list) : time_verify(case_dir, &list[found]);
    if (s && found >= 0) s = fall_back(case_dir, c, list, &found, s);
    if (!s && time_is_original(&list[found])) s = check_made(case_dir, &list[found]);
    if (!s) *out = list[found];
    free(list);
    return s;
}

void time_name(enum time_format format, int precision, double t, char name[TIME_NAME]) {
    if (t == 0) t = 0; /* no "-0" */
    const char *forms[] = {"%.*g", "%.*f", "%.*e"};
    if (format == TIME_FIXED && fabs(t) >= 1e30) format = TIME_GENERAL;
    snprintf(name, TIME_NAME, forms[format], precision, t);
}

int time_name_apart(enum time_format format, int precision, double t, double other, char name[TIME_NAME]) {
    char second[TIME_NAME];
    for (;; precision++) {
        time_name(format, precision, t, name);
        time_name(format, precision, other, second);
        if (isnan(other) || t == other || strcmp(name, second) || precision >= 20) return precision;
    }
}

static void hidden(const char *case_dir, const char *name, const char *ending, char out[TIME_PATH]) {
    snprintf(out, TIME_PATH, "%s/.%s.%s", case_dir, name, ending);
}

status remove_folder(const char *path) {
    int why = folder_remove(path);
    return why ? file_error(path, "cannot be removed", why) : OK;
}

status make_folders(const char *path) {
    int why = folder_make(path);
    return why ? file_error(path, "cannot be made", why) : OK;
}

status time_begin(const char *case_dir, const char *name, char tmp[TIME_PATH]) {
    char inner[TIME_PATH + 16];
    hidden(case_dir, name, "tmp", tmp);
    TRY(remove_folder(tmp));
    snprintf(inner, sizeof inner, "%s/uniform", tmp);
    return make_folders(inner);
}

status time_commit(const char *case_dir, const char *name) {
    char tmp[TIME_PATH], old[TIME_PATH], path[TIME_PATH];
    hidden(case_dir, name, "tmp", tmp);
    hidden(case_dir, name, "old", old);
    snprintf(path, sizeof path, "%s/%s", case_dir, name);
    int why = folder_sync(tmp);
    if (why) return file_error(tmp, "cannot be brought to the disk", why);
    TRY(remove_folder(old));
    why = file_rename(path, old);
    if (why && why != ENOENT) return file_error(path, "cannot be replaced", why);
    why = file_rename(tmp, path);
    if (why) {
        (void)file_rename(old, path);
        return file_error(path, "cannot be put in place", why);
    }
    why = folder_sync_names(case_dir);
    if (why) return file_error(case_dir, "cannot be brought to the disk", why);
    return remove_folder(old);
}

status time_remove(const char *case_dir, const char *name) {
    char tmp[TIME_PATH], path[TIME_PATH];
    hidden(case_dir, name, "tmp", tmp);
    snprintf(path, sizeof path, "%s/%s", case_dir, name);
    TRY(remove_folder(tmp));
    int why = file_rename(path, tmp);
    if (why && why != ENOENT) return file_error(path, "cannot be removed", why);
    return remove_folder(tmp);
}

status time_stamp_write(const char *path, const struct instant *at, struct checksums *sums) {
    char file[TIME_PATH + 16], location[TIME_NAME + 16];
    struct sink *s;
    const struct foam_format ascii = {.precision = 17};
    snprintf(file, sizeof file, "%s/uniform/time", path);
    snprintf(location, sizeof location, "%s/uniform", at->name);
    TRY(sink_open(file, false, &s));
    foam_header_write(s, &ascii, "dictionary", location, "time", NULL);
    sink_printf(s, "value           %.17g;\nname            \"%s\";\nindex           %ld;\n", at->t, at->name,
                at->step);
    sink_printf(s, "deltaT          %.17g;\ndeltaT0         %.17g;\n", at->delta_t, at->delta_t);
    sink_printf(s, "writePrecision  %d;\n", at->digits);
    struct file_sum sum;
    TRY(sink_close_sum(s, &sum));
    if (!sums) return OK;
    TRY(checksums_add(sums, "uniform/time", sum));
    return checksums_write(sums, path, at->name);
}

status times_clean(const char *case_dir) {
    DIR *folder = opendir(case_dir);
    if (!folder) return OK; /* times_list reports it */
    status s = OK;
    for (struct dirent *entry; !s && (entry = readdir(folder));) {
        char name[TIME_NAME], path[TIME_PATH];
        size_t length = strlen(entry->d_name);
        double t;
        if (entry->d_name[0] != '.' || length < 6 || length >= sizeof name) continue;
        if (strcmp(entry->d_name + length - 4, ".tmp") && strcmp(entry->d_name + length - 4, ".old")) continue;
        memcpy(name, entry->d_name + 1, length - 5);
        name[length - 5] = 0;
        if (!time_value(name, &t)) continue;
        snprintf(path, sizeof path, "%s/%s", case_dir, entry->d_name);
        /* A run that was killed between the two renames of time_commit left its only copy here. */
        char place[TIME_PATH];
        snprintf(place, sizeof place, "%s/%s", case_dir, name);
        if (!strcmp(entry->d_name + length - 4, ".old") && access(place, F_OK))
            (void)file_rename(path, place);
        else
            s = remove_folder(path);
    }
    closedir(folder);
    return s;
}
