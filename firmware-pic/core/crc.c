/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "crc.h"

#include "constants.h"

struct crc crc;

void crc_begin(void)
{
    crc.low = (uint8_t)(CRC_INITIAL & 0xFFu);
    crc.high = (uint8_t)(CRC_INITIAL >> 8);
}

/*
 * What the table of the usual algorithm has for a byte is the exclusive or of what it has for
 * each of the byte's bits. Eight constants instead of a table: as quick as a table in program
 * memory is on a PIC18, and 512 bytes smaller.
 */
void crc_add(void)
{
    uint8_t index = (uint8_t)(crc.low ^ crc.byte);

    crc.low = crc.high;
    crc.high = 0;
    if ((index & 0x01u) != 0u) {
        crc.low ^= 0x56u;
        crc.high ^= 0x79u;
    }
    if ((index & 0x02u) != 0u) {
        crc.low ^= 0xACu;
        crc.high ^= 0xF2u;
    }
    if ((index & 0x04u) != 0u) {
        crc.low ^= 0x6Du;
        crc.high ^= 0xBCu;
    }
    if ((index & 0x08u) != 0u) {
        crc.low ^= 0xEFu;
        crc.high ^= 0x21u;
    }
    if ((index & 0x10u) != 0u) {
        crc.low ^= 0xDEu;
        crc.high ^= 0x43u;
    }
    if ((index & 0x20u) != 0u) {
        crc.low ^= 0xBCu;
        crc.high ^= 0x87u;
    }
    if ((index & 0x40u) != 0u) {
        crc.low ^= 0x4Du;
        crc.high ^= 0x56u;
    }
    if ((index & 0x80u) != 0u) {
        crc.low ^= 0x9Au;
        crc.high ^= 0xACu;
    }
}

uint8_t crc_take_bits(void)
{
    uint8_t bits = crc.low;

    crc.low = (uint8_t)(crc.high << 1);
    if ((bits & 0x80u) != 0u) {
        crc.low |= 0x01u;
    }
    crc.high = (uint8_t)(crc.high >> 7);
    return (uint8_t)(bits & 0x7Fu);
}
