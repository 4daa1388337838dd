/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers are changed as numbers: bytes changed at random seldom leave a mesh a mesh. Half of the time libFuzzer's own.
 */
#include "mesh/format/foamfile.h"
#include "tests/fuzz/target.h"

#include <stdio.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned seed);

struct span {
    size_t start, length;
    double value;
};

static unsigned next(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static bool is_part(uint8_t c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e';
}

/* The first number behind `from`, or none. */
static bool find_number(const uint8_t *data, size_t size, size_t from, struct span *out) {
    for (size_t i = from; i < size; i++) {
        if (!is_part(data[i]) || (i && (is_part(data[i - 1]) || data[i - 1] > '@'))) continue;
        char text[32] = "";
        size_t n = 0;
        while (n < 30 && i + n < size && is_part(data[i + n])) n++;
        memcpy(text, data + i, n);
        *out = (struct span){i, n, 0};
        if (foam_number(text, &out->value)) return true;
    }
    return false;
}

static double other_value(double v, double second, unsigned *seed) {
    static const double edges[] = {0, 1, -1, 2147483647, -2147483648.0, 4294967296, 1099511627776, 1e-9, 1e30, 1e308};
    switch (next(seed) % 7) {
    case 0:
        return v + 1;
    case 1:
        return v - 1;
    case 2:
        return -v;
    case 3:
        return v * (1 + ((int)(next(seed) % 2001) - 1000) * 1e-4);
    case 4:
        return edges[next(seed) % 10];
    default:
        return second;
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned seed) {
    struct span a, b;
    char text[32];
    if (!size || next(&seed) % 2 || !find_number(data, size, next(&seed) % size, &a))
        return LLVMFuzzerMutate(data, size, room);
    double second = find_number(data, size, next(&seed) % size, &b) ? b.value : 7;
    size_t n = (size_t)snprintf(text, sizeof text, "%.12g", other_value(a.value, second, &seed));
    if (size - a.length + n > room) return LLVMFuzzerMutate(data, size, room);
    memmove(data + a.start + n, data + a.start + a.length, size - a.start - a.length);
    memcpy(data + a.start, text, n);
    return size - a.length + n;
}
