/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads files in OpenFOAM's grammar: the whole file into memory (unzipped), numbers, tokens with their lines, the
 * FoamFile header. foamlist.c reads lists, foamwrite.c writes. */
#include "mesh/format/files.h"
#include "mesh/format/foamfile_private.h"

#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

/* ---- source ---- */

void source_free(struct source *s) {
    if (!s) return;
    if (s->file >= 0) close(s->file);
    free(s->part);
    free(s->path);
    free(s->text);
    free(s);
}

void source_drop_text(struct source *s) {
    char *less = realloc(s->text, 1);
    if (less) s->text = less;
    s->text[0] = 0;
    s->size = s->gap_bytes = 0;
    if (s->file >= 0) close(s->file);
    s->file = -1;
}

status source_fail(const struct source *s, int line, const char *format, ...) {
    char text[1600];
    va_list args;
    if (s->foreign)
        return fail(
            ERR_INPUT,
            "%s:%d: this line cannot be read as it should; its text comes from a file outside of the case (a link "
            "leads there) and is not shown: replace the link by a copy to see what is wrong",
            s->path, line);
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return fail(ERR_INPUT, "%s:%d: %s", s->path, line, text);
}

/* A file that unzips to more than UNZIPPED bytes may not grow by more than RATIO: sound data seldom do, a gzip bomb
 * does. */
static const size_t UNZIPPED = (size_t)1 << 30, RATIO = 100;

enum { LONG_LIST = 4096 }; /* bytes */

bool find_list(const struct source *head, struct long_list *out) {
    struct lexer l = lexer_start(head);
    struct token t = {.kind = TOKEN_WORD};
    status s = foam_header_read(&l, &out->header);
    bool found = false;
    while (!s && t.kind != TOKEN_END && !found) {
        s = lexer_next(&l, &t);
        found = !s && token_is(&t, "nonuniform");
    }
    if (!s && found) s = lexer_next(&l, &t);
    out->components = s || !found                        ? 0
                      : token_is(&t, "List<scalar>")     ? 1
                      : token_is(&t, "List<vector>")     ? 3
                      : token_is(&t, "List<symmTensor>") ? 6
                                                         : 0;
    if (!s && out->components) s = lexer_next(&l, &t);
    found = !s && out->components && t.kind == TOKEN_NUMBER && t.number > 0 && t.number <= INT_MAX &&
            t.number == floor(t.number);
    out->count = found ? (long)t.number : 0;
    if (found) s = lexer_expect(&l, '(');
    out->at = l.position;
    out->line = l.line;
    found = found && !s && out->count * out->components * (long)sizeof(double) >= LONG_LIST;
    status_free(s);
    return found;
}

/* Reads n bytes of a file, from `at` on. Returns whether they are there. */
static bool read_at(int file, char *to, size_t n, size_t at) {
    while (n) {
        const ssize_t got = pread(file, to, n < 1 << 30 ? n : 1 << 30, (off_t)at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        to += got;
        at += (size_t)got;
        n -= (size_t)got;
    }
    return true;
}

/* Reads a file but for the entries of a long list, if it has one in its head. Sets nothing otherwise: the file is then
 * read whole, which also finds what is wrong with it. */
static status read_around(struct source *s) {
    struct source head = {.file = -1};
    int file;
    TRY(file_open_pieces(s->path, &file, &s->size));
    const size_t size = s->size, n = size < HEAD ? size : HEAD;
    char end = 0;
    s->size = 0;
    status e = allocate(&head.text, (long)n + 1, 1, "the head of a file");
    struct long_list list;
    head.size = n;
    if (!e && read_at(file, head.text, n, 0) && strncmp(head.text, "\x1f\x8b", 2) != 0 && find_list(&head, &list) &&
        list.header.binary) {
        s->gap = list.at;
        s->gap_bytes = (size_t)list.count * (size_t)(list.components * list.header.scalar_bytes);
    }
    const size_t gap_end = s->gap + s->gap_bytes;
    if (!s->gap_bytes || gap_end >= size || !read_at(file, &end, 1, gap_end) || end != ')')
        s->gap_bytes = 0;
    else
        e = allocate(&s->text, (long)(size - s->gap_bytes + 1), 1, s->path);
    if (!e && s->gap_bytes) {
        memcpy(s->text, head.text, s->gap);
        s->size = size - s->gap_bytes;
        s->file = file;
        if (!read_at(file, s->text + s->gap, size - gap_end, gap_end))
            e = fail(ERR_INPUT, "%s: cannot be read", s->path);
    }
    if (s->file < 0) close(file);
    free(head.text);
    return e;
}

/* Reads the whole file; gzread passes a file that is not gzipped through unchanged. */
static status read_all(struct source *s) {
    size_t guess = 0;
    int file;
    TRY(file_open_read(s->path, &file, &guess));
    gzFile f = gzdopen(file, "rb");
    if (!f) {
        close(file);
        return fail(ERR_SYSTEM, "%s: no memory to read it", s->path);
    }
    size_t room = guess + 1;
    int got = 0;
    do {
        if (s->size + 1 >= room) room = 2 * room + 4096;
        char *text = realloc(s->text, room);
        if (!text) {
            gzclose(f);
            return fail(ERR_SYSTEM, "%s: no memory to read %zu bytes", s->path, room);
        }
        s->text = text;
        size_t want = room - s->size - 1;
        got = gzread(f, s->text + s->size, want > 1 << 30 ? 1 << 30 : (unsigned)want);
        if (got > 0) s->size += (size_t)got;
        if (s->size > UNZIPPED && s->size / RATIO > guess) {
            gzclose(f);
            return fail(ERR_INPUT, "%s: unzips to more than %zu times its size; if that is meant, gunzip it", s->path,
                        RATIO);
        }
        if (s->size > file_most()) {
            gzclose(f);
            return fail(ERR_INPUT, "%s: it holds more than %.3g GiB; so much is not read", s->path,
                        (double)file_most() / (1 << 30));
        }
    } while (got > 0);
    int code = 0;
    char why[160];
    snprintf(why, sizeof why, "%s", gzerror(f, &code));
    if (code == Z_ERRNO) snprintf(why, sizeof why, "%s", strerror(errno));
    int closed = gzclose(f);
    if (got < 0) return fail(ERR_INPUT, "%s: cannot read: %s", s->path, why);
    if (closed == Z_BUF_ERROR) return fail(ERR_INPUT, "%s: the gzip file ends too early", s->path);
    s->text[s->size] = 0;
    return OK;
}

static status source_make(const char *path, const char *ending, struct source **out) {
    struct source *s = calloc(1, sizeof *s);
    size_t length = strlen(path) + strlen(ending) + 1;
    if (s) s->file = -1;
    if (s) s->path = malloc(length);
    if (!s || !s->path) {
        free(s);
        return fail(ERR_SYSTEM, "no memory for %s", path);
    }
    snprintf(s->path, length, "%s%s", path, ending);
    *out = s;
    return OK;
}

status source_name(const char *path, struct source **out) {
    *out = NULL;
    struct source *s = NULL;
    TRY(source_make(path, "", &s));
    if (access(s->path, F_OK)) {
        int why = errno;
        source_free(s);
        TRY(source_make(path, ".gz", &s));
        if (access(s->path, F_OK)) {
            source_free(s);
            return fail(ERR_INPUT, "%s: cannot open (nor %s.gz): %s", path, path, strerror(why));
        }
    }
    s->foreign = file_is_foreign(s->path, path_case(s->path));
    *out = s;
    return OK;
}

status source_open(const char *path, struct source **out) {
    *out = NULL;
    TRY(file_single(path));
    return source_open_named(path, out);
}

status source_open_named(const char *path, struct source **out) {
    *out = NULL;
    struct source *s = NULL;
    TRY(source_name(path, &s));
    status e = read_around(s);
    if (!e && !s->gap_bytes) e = read_all(s);
    if (e) {
        source_free(s);
        return e;
    }
    *out = s;
    return OK;
}

status source_from_text(const char *name, const char *text, struct source **out) {
    *out = NULL;
    struct source *s = NULL;
    TRY(source_make(name, "", &s));
    s->size = strlen(text);
    s->text = malloc(s->size + 1);
    if (!s->text) {
        source_free(s);
        return fail(ERR_SYSTEM, "no memory for %s", name);
    }
    memcpy(s->text, text, s->size + 1);
    *out = s;
    return OK;
}

/* ---- numbers ---- */

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static bool ends_token(const char *p) {
    switch (*p) {
    case '(':
    case ')':
    case '[':
    case ']':
    case '{':
    case '}':
    case ';':
    case ',':
    case '"':
    case '\'':
        return true;
    case '/':
        return p[1] == '/' || p[1] == '*';
    default:
        return (unsigned char)*p <= ' ';
    }
}

/* Calls strtod, which wants the decimal point of the locale; a library may have set one with a comma. */
static double slow_number(const char *text, size_t length) {
    char copy[128];
    memcpy(copy, text, length);
    copy[length] = 0;
    char *point = strchr(copy, '.');
    if (point) *point = localeconv()->decimal_point[0];
    return strtod(copy, NULL);
}

typedef unsigned wide __attribute__((mode(TI))); /* 128 bits */

enum { EXACT_POWER = 22, WIDE_POWER = 27 }; /* 10^22 is an exact double; 5^27 < 2^63 */

/* Returns m 2^e of a whole number m > 0, rounded to the nearest double, or to the even one of two; `more`: a part
 * between 0 and 1 is to be added to m. The result is far from the least and the largest double. */
static double rounded(wide m, int e, bool more) {
    const uint64_t high = (uint64_t)(m >> 64), low = (uint64_t)m;
    const int drop = (high ? 128 - __builtin_clzll(high) : 64 - __builtin_clzll(low)) - 53;
    double scale;
    if (drop > 0) {
        const wide half = (wide)1 << (drop - 1), rest = m & (2 * half - 1);
        m >>= drop;
        m += rest > half || (rest == half && (more || (m & 1)));
        e += drop;
    }
    const uint64_t bits = (uint64_t)(1023 + e) << 52;
    memcpy(&scale, &bits, sizeof scale);
    return (double)(uint64_t)m * scale;
}

/* Returns m 10^exponent, correctly rounded. Whole numbers up to 2^53 and powers of ten up to 10^22 are exact doubles,
 * so that one division or product of them rounds once (Clinger 1990). All others with |exponent| <= WIDE_POWER are
 * products or quotients of whole numbers: m 5^exponent, or the quotient of m 2^s by 5^-exponent, which has 62 or 63
 * binary digits, so that one division instruction finds it, with the knowledge whether a rest is left. */
static double scaled(uint64_t m, int exponent) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    static const uint64_t five_to[WIDE_POWER / 2 + 2] = {
        1, 5, 25, 125, 625, 3125, 15625, 78125, 390625, 1953125, 9765625, 48828125, 244140625, 1220703125, 6103515625};
    if (m == 0) return 0;
    if (m <= UINT64_C(1) << 53 && abs(exponent) <= EXACT_POWER)
        return exponent < 0 ? (double)m / power[-exponent] : (double)m * power[exponent];
    const int n = abs(exponent);
    const uint64_t five = five_to[n / 2] * five_to[n - n / 2];
    if (exponent >= 0) return rounded((wide)m * five, exponent, false);
    const int s = 62 + __builtin_clzll(m) - __builtin_clzll(five);
    const wide dividend = (wide)m << s, quotient = dividend / five;
    return rounded(quotient, exponent - s, quotient * five != dividend);
}

/* Reads the digits at p into *m, as long as 19 of them fit, and returns the character behind all of them; *lost: the
 * digits that did not fit. */
static const char *read_digits(const char *p, uint64_t *m, int *lost) {
    for (; is_digit(*p); p++) {
        if (*m < UINT64_C(1000000000000000000))
            *m = 10 * *m + (uint64_t)(*p - '0');
        else
            ++*lost;
    }
    return p;
}

/* strtod reads the numbers with more than 19 digits, or exponents that `scaled` does not know. */
const char *foam_number(const char *text, double *out) {
    const char *p = text;
    const bool minus = *p == '-';
    if (*p == '-' || *p == '+') p++;
    const char *first = p;
    uint64_t mantissa = 0;
    int lost = 0, scale = 0, exponent = 0, digits;
    p = read_digits(p, &mantissa, &lost);
    digits = p > first;
    if (*p == '.') {
        first = p + 1;
        p = read_digits(first, &mantissa, &lost);
        scale = (int)(first - p);
        digits |= p > first;
    }
    if (!digits) return NULL;
    if (*p == 'e' || *p == 'E') {
        bool negative = *++p == '-';
        if (*p == '-' || *p == '+') p++;
        if (!is_digit(*p)) return NULL;
        for (; is_digit(*p); p++)
            if (exponent < 100000) exponent = 10 * exponent + (*p - '0');
        if (negative) exponent = -exponent;
    }
    if (!ends_token(p) || p - text >= 128) return NULL;
    exponent += scale;
    if (!lost && abs(exponent) <= WIDE_POWER)
        *out = minus ? -scaled(mantissa, exponent) : scaled(mantissa, exponent);
    else
        *out = slow_number(text, (size_t)(p - text));
    return p;
}

/* ---- tokens ---- */

struct lexer lexer_start(const struct source *s) {
    bool mark = s->size >= 3 && !memcmp(s->text, "\xEF\xBB\xBF", 3);
    return (struct lexer){.source = s, .position = mark ? 3 : 0, .line = 1};
}

bool token_is(const struct token *t, const char *text) {
    return t->kind != TOKEN_END && strlen(text) == (size_t)t->length && !memcmp(t->text, text, (size_t)t->length);
}

status lexer_fail(const struct lexer *l, const struct token *found, const char *format, ...) {
    char text[1024], name[48];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    int shown = found->length < 40 ? found->length : 40;
    snprintf(name, sizeof name, "%.*s%s", shown, found->text ? found->text : "", shown < found->length ? "..." : "");
    for (char *c = name; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
    if (found->kind == TOKEN_END) return source_fail(l->source, found->line, "the file ends; %s", text);
    return source_fail(l->source, found->line, "found '%s'; %s", name, text);
}

static status skip_blanks(struct lexer *l) {
    const char *text = l->source->text, *p = text + l->position;
    for (;;) {
        if (*p == '\n') {
            l->line++;
            p++;
        } else if (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\f' || *p == '\v') {
            p++;
        } else if (p[0] == '/' && p[1] == '/') {
            while (*p && *p != '\n') p++;
        } else if (p[0] == '/' && p[1] == '*') {
            int start = l->line;
            for (p += 2; *p && !(p[0] == '*' && p[1] == '/'); p++) l->line += *p == '\n';
            if (!*p) return source_fail(l->source, start, "the comment /* is not closed");
            p += 2;
        } else {
            break;
        }
    }
    l->position = (size_t)(p - text);
    return OK;
}

static status read_string(struct lexer *l, const char *p, struct token *t) {
    t->kind = TOKEN_STRING;
    t->text = ++p;
    for (; *p != '"'; p++) {
        if (*p == '\\' && p[1])
            p++;
        else if (*p == '\n' || !*p)
            return source_fail(l->source, t->line, "the string \"%.*s is not closed on its line",
                               (int)strcspn(t->text, "\r\n"), t->text);
        if ((unsigned char)*p < ' ' && !strchr("\t\r\n", *p))
            return source_fail(l->source, l->line, "found byte 0x%02x in a string", (unsigned char)*p);
        l->line += *p == '\n';
    }
    t->length = (int)(p - t->text);
    l->position = (size_t)(p + 1 - l->source->text);
    return OK;
}

static status read_verbatim(struct lexer *l, const char *p, struct token *t) {
    t->kind = TOKEN_VERBATIM;
    t->text = p + 2;
    for (p += 2; *p && !(p[0] == '#' && p[1] == '}'); p++) l->line += *p == '\n';
    if (!*p) return source_fail(l->source, t->line, "'#{' is not closed by '#}'");
    t->length = (int)(p - t->text);
    l->position = (size_t)(p + 2 - l->source->text);
    return OK;
}

static status read_word(struct lexer *l, const char *p, struct token *t) {
    int depth = 0;
    t->kind = TOKEN_WORD;
    t->text = p;
    if (p[0] == '$' && p[1] == '{') {
        int braces = 0;
        do {
            braces += (*p == '{') - (*p == '}');
            if (!*p || *p == '\n') return source_fail(l->source, t->line, "'${' is not closed by '}'");
        } while (*++p && (braces > 0 || p == t->text + 1));
    }
    for (;; p++) {
        if (*p == '(')
            depth++;
        else if (*p == ')' && depth-- == 0)
            break;
        else if (*p != '(' && *p != ')' && !(*p == ',' && depth) && ends_token(p))
            break;
    }
    if (depth > 0)
        return source_fail(l->source, t->line,
                           "word '%.*s' has an open '('; close it, or set a blank before the list it starts",
                           (int)(p - t->text), t->text);
    t->length = (int)(p - t->text);
    l->position = (size_t)(p - l->source->text);
    return OK;
}

status lexer_next(struct lexer *l, struct token *t) {
    TRY(skip_blanks(l));
    const char *p = l->source->text + l->position;
    *t = (struct token){.text = p, .line = l->line, .first_on_line = l->line != l->last_line};
    const char *end = foam_number(p, &t->number);
    if (l->position >= l->source->size) {
        t->kind = TOKEN_END;
    } else if (end) {
        t->kind = TOKEN_NUMBER;
        t->length = (int)(end - p);
        l->position += (size_t)t->length;
        if (!isfinite(t->number)) return lexer_fail(l, t, "the number is out of range");
    } else if (*p == '"') {
        TRY(read_string(l, p, t));
    } else if (p[0] == '#' && p[1] == '{') {
        TRY(read_verbatim(l, p, t));
    } else if (*p && strchr("()[]{};,'", *p)) {
        t->kind = TOKEN_PUNCTUATION;
        t->length = 1;
        l->position++;
    } else if ((unsigned char)*p < ' ') {
        return source_fail(l->source, l->line, "found byte 0x%02x in text; is 'format' of the header wrong?",
                           (unsigned char)*p);
    } else {
        TRY(read_word(l, p, t));
    }
    l->last_line = l->line;
    return OK;
}

status lexer_peek(const struct lexer *l, struct token *t) {
    struct lexer copy = *l;
    return lexer_next(&copy, t);
}

status lexer_expect(struct lexer *l, char punctuation) {
    struct token t;
    TRY(lexer_next(l, &t));
    if (t.kind != TOKEN_PUNCTUATION || t.text[0] != punctuation) return lexer_fail(l, &t, "expected '%c'", punctuation);
    return OK;
}

/* ---- header ---- */

static status copy_text(const struct lexer *l, const struct token *t, char *to, size_t room, const char *key) {
    if ((size_t)t->length >= room) return lexer_fail(l, t, "'%s' of the header is too long", key);
    memcpy(to, t->text, (size_t)t->length);
    to[t->length] = 0;
    return OK;
}

/* Reads the sizes of numbers from the value of `arch`, for example "LSB;label=32;scalar=64". */
static status read_arch(const struct lexer *l, const struct token *t, struct foam_header *h) {
    char arch[128];
    TRY(copy_text(l, t, arch, sizeof arch, "arch"));
    if (strstr(arch, "MSB")) return lexer_fail(l, t, "only little-endian (LSB) files can be read");
    const char *label = strstr(arch, "label="), *scalar = strstr(arch, "scalar=");
    int label_bits = label ? atoi(label + 6) : 32, scalar_bits = scalar ? atoi(scalar + 7) : 64;
    if ((label_bits != 32 && label_bits != 64) || (scalar_bits != 32 && scalar_bits != 64))
        return lexer_fail(l, t, "label and scalar have 32 or 64 bits");
    h->label_bytes = label_bits / 8;
    h->scalar_bytes = scalar_bits / 8;
    return OK;
}

static status read_header_entry(struct lexer *l, const struct token *key, struct foam_header *h) {
    struct token value;
    TRY(lexer_next(l, &value));
    if (value.kind == TOKEN_END || value.kind == TOKEN_PUNCTUATION)
        return lexer_fail(l, &value, "expected a value for '%.*s' in FoamFile", key->length, key->text);
    if (token_is(key, "format")) {
        h->binary = token_is(&value, "binary");
        if (!h->binary && !token_is(&value, "ascii")) return lexer_fail(l, &value, "'format' is ascii or binary");
    } else if (token_is(key, "arch")) {
        TRY(read_arch(l, &value, h));
    } else if (token_is(key, "class")) {
        h->class_line = value.line;
        TRY(copy_text(l, &value, h->class_name, sizeof h->class_name, "class"));
    } else if (token_is(key, "object")) {
        h->object_line = value.line;
        TRY(copy_text(l, &value, h->object, sizeof h->object, "object"));
    } else if (token_is(key, "location")) {
        TRY(copy_text(l, &value, h->location, sizeof h->location, "location"));
    } else if (token_is(key, "note")) {
        TRY(copy_text(l, &value, h->note, sizeof h->note, "note"));
    }
    struct token end;
    TRY(lexer_next(l, &end));
    if (token_is(&end, ";")) return OK;
    return lexer_fail(l, &value, "expected ';' behind this value of '%.*s', not '%.*s'", key->length, key->text,
                      end.length, end.text);
}

status foam_header_read(struct lexer *l, struct foam_header *h) {
    *h = (struct foam_header){.label_bytes = 4, .scalar_bytes = 8};
    struct token t;
    TRY(lexer_peek(l, &t));
    if (t.kind != TOKEN_WORD || !token_is(&t, "FoamFile")) return OK;
    h->present = true;
    TRY(lexer_next(l, &t));
    TRY(lexer_expect(l, '{'));
    for (;;) {
        TRY(lexer_next(l, &t));
        if (token_is(&t, "}")) return OK;
        if (t.kind != TOKEN_WORD) return lexer_fail(l, &t, "expected a keyword or '}' of FoamFile");
        TRY(read_header_entry(l, &t, h));
    }
}
