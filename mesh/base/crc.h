/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CRC-32 as zlib has it, of large pieces by products without carries where the processor has them: some five times as
 * fast. */
#ifndef MESH_CRC_H
#define MESH_CRC_H

#include <stddef.h>

/* Returns the CRC of what `crc` is that of, followed by the data; 0: of nothing. */
unsigned long crc_add(unsigned long crc, const void *data, size_t bytes);

#endif
