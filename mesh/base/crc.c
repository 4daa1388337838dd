/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CRC-32 (crc.h). The data are a polynomial over GF(2), of which the remainder modulo P is wanted, bits reflected. Four
 * lanes of 128 bits are moved on by 512 bits at a time: each half is multiplied by the remainder of the power of x that
 * stands for the way, and added to what comes there (Gopal et al., Fast CRC Computation for Generic Polynomials Using
 * PCLMULQDQ Instruction, Intel 2009). The last 128 bits are given to zlib. */
#include "mesh/base/crc.h"

#include <stdbool.h>
#include <string.h>
#include <zlib.h>

#if defined(__x86_64__)
#include <immintrin.h>

enum { LANES = 4, LANE = 16 }; /* LANE: bytes */

/* Moves a lane on by the way that the two multipliers stand for, and adds what comes there. */
__attribute__((target("pclmul,sse4.1"))) static inline __m128i fold(__m128i lane, __m128i by, const void *next) {
    const __m128i low = _mm_clmulepi64_si128(lane, by, 0x00), high = _mm_clmulepi64_si128(lane, by, 0x11);
    return _mm_xor_si128(_mm_xor_si128(low, high), _mm_loadu_si128(next));
}

/* Returns the CRC of `bytes` of data, at least 64 of them, in whole lanes. */
__attribute__((target("pclmul,sse4.1"))) static unsigned long add_lanes(unsigned long crc, const unsigned char *data,
                                                                        size_t bytes) {
    const __m128i by_four = _mm_set_epi64x(0x01c6e41596, 0x0154442bd4); /* x^(512-32), x^(512+32) mod P */
    const __m128i by_one = _mm_set_epi64x(0x00ccaa009e, 0x01751997d0);  /* x^(128-32), x^(128+32) mod P */
    unsigned char last[LANE];
    __m128i lane[LANES];
    for (int i = 0; i < LANES; i++) lane[i] = _mm_loadu_si128((const void *)(data + LANE * i));
    lane[0] = _mm_xor_si128(lane[0], _mm_cvtsi32_si128((int)~(unsigned)crc));
    size_t at = LANES * LANE;
    for (; bytes - at >= LANES * LANE; at += LANES * LANE)
        for (int i = 0; i < LANES; i++) lane[i] = fold(lane[i], by_four, data + at + LANE * i);
    for (int i = 1; i < LANES; i++) lane[0] = fold(lane[0], by_one, &lane[i]);
    for (; at < bytes; at += LANE) lane[0] = fold(lane[0], by_one, data + at);
    _mm_storeu_si128((void *)last, lane[0]);
    return crc32_z(0xffffffff, last, LANE); /* zlib begins with ~crc, that is with 0 */
}

static bool has_lanes(void) {
    return __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
}
#else
enum { LANES = 1, LANE = 1 };
static unsigned long add_lanes(unsigned long crc, const unsigned char *data, size_t bytes) {
    return crc32_z(crc, data, bytes);
}
static bool has_lanes(void) {
    return false;
}
#endif

unsigned long crc_add(unsigned long crc, const void *data, size_t bytes) {
    const size_t lanes = bytes >= LANES * LANE && has_lanes() ? bytes / LANE * LANE : 0;
    if (lanes) crc = add_lanes(crc, data, lanes);
    return crc32_z(crc, (const unsigned char *)data + lanes, bytes - lanes);
}
