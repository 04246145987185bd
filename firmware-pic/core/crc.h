/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The check over a package: 16 bits, polynomial 0x5935 processed least significant bit first,
 * initial value 0xFFFF, no final xor (SPEC.md, section 3).
 */
#ifndef RSAPIEN_CRC_H
#define RSAPIEN_CRC_H

#include <stdint.h>

/* A check in the making. */
struct crc {
    uint8_t low;
    uint8_t high;
    uint8_t byte; /* to be taken in next */
};

/* That of the package being received; who makes another one puts it back. Main routine only. */
extern struct crc crc;

void crc_begin(void);

/* Takes `crc.byte` in. */
void crc_add(void);

/* The next seven bits of a finished `crc`, as they go over the line: bits 0-6, 7-13, 14-15. */
uint8_t crc_take_bits(void);

#endif
