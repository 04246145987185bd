/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "line.h"

#include <stddef.h>

#define GROUP 6

/* Bit by bit, as the specification words it. */
static uint16_t check_of(const uint8_t *bytes, int length)
{
    uint16_t check = 0xFFFF;

    for (int index = 0; index < length; index++) {
        for (int bit = 0; bit < 8; bit++) {
            const unsigned differs = (check ^ (unsigned)(bytes[index] >> bit)) & 1u;

            check = (uint16_t)((check >> 1) ^ (differs != 0 ? 0xAC9Au : 0u));
        }
    }
    return check;
}

static void put_check(uint8_t *bytes, int length)
{
    const uint16_t check = check_of(bytes, length);

    bytes[length] = check & 0x7Fu;
    bytes[length + 1] = (uint8_t)((check >> 7) & 0x7Fu);
    bytes[length + 2] = (uint8_t)(check >> 14);
}

void line_encode(uint8_t address, const uint8_t content[LINE_ACTION_CONTENT],
                 uint8_t bytes[LINE_ACTION_LENGTH])
{
    int place = 0;

    bytes[place++] = (uint8_t)(0xC1u | (unsigned)(address << 3));
    for (int index = 0; index < LINE_ACTION_CONTENT; index++) {
        if (index % GROUP == 0) {
            uint8_t top_bits = 0;

            for (int bit = 0; bit < GROUP; bit++) {
                top_bits |= (uint8_t)((content[index + bit] >> 7) << bit);
            }
            bytes[place++] = 0x80u | top_bits;
        }
        bytes[place++] = content[index] & 0x7Fu;
    }
    put_check(bytes, place);
}

const char *line_decode(uint8_t address, const uint8_t bytes[LINE_ANSWER_LENGTH],
                        uint8_t content[LINE_ANSWER_CONTENT])
{
    uint8_t check[LINE_ANSWER_LENGTH];
    int place = 0;

    if (bytes[place++] != (0xE1u | (unsigned)(address << 3))) {
        return "the answer's header";
    }
    for (int index = 0; index < LINE_ANSWER_CONTENT; index++) {
        const int bit = index % GROUP;
        const uint8_t top_bits = bytes[1 + index / GROUP * (GROUP + 1)];

        if (bit == 0) {
            if ((top_bits & 0xC0u) != 0x80u) {
                return "the class of a synchronization byte of the answer";
            }
            place++;
        }
        if (bytes[place] >= 0x80u) {
            return "the class of a data byte of the answer";
        }
        content[index] = (uint8_t)(bytes[place++] | (unsigned)((top_bits >> bit) & 1u) << 7);
    }
    for (int index = 0; index < place; index++) {
        check[index] = bytes[index];
    }
    put_check(check, place);
    for (int index = place; index < LINE_ANSWER_LENGTH; index++) {
        if (bytes[index] != check[index]) {
            return "the check of the answer";
        }
    }
    return NULL;
}
