/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "transmission.h"

#include "controller.h"
#include "crc.h"
#include "inline.h"
#include "port.h"

#define HEADER_TO_PC (0xE0u | (CONTROLLER_ADDRESS << 3) | PROTOCOL_VERSION)
#define SYNCHRONIZATION_CLASS 0x80u
#define FIRST_SYNCHRONIZATION 1u
#define GROUP_LINE_LENGTH (GROUP_DATA_LENGTH + 1u)
#define CHECK_PLACE (SYNCHRONIZATION_PACKAGE_LENGTH - CHECK_LENGTH)

/* Where a byte of the content stands among the line bytes, behind its synchronization byte. */
#define PLACE_OF(index) ((index) + ((index) / GROUP_DATA_LENGTH) + 2u)
#define REPORT_BEGIN (SYNCHRONIZATION_CONTENT_LENGTH - REPORT_LENGTH)

struct transmission transmission;

void transmission_reset(void)
{
    transmission.next = SYNCHRONIZATION_PACKAGE_LENGTH;
    transmission.owed = false;
}

void transmission_owe(void)
{
    transmission.owed = true;
}

bool controller_transmit_interrupt(void)
{
    if (transmission_is_idle()) {
        return false;
    }
    transmission.byte = transmission.bytes[transmission.next];
    transmission.next++;
    return true;
}

/* Puts a whole group of the report on its places, its synchronization byte at `place`. */
static void put_group(uint8_t place, uint8_t report_index)
{
    uint8_t to = place;
    uint8_t from = report_index;
    uint8_t top_bits = SYNCHRONIZATION_CLASS;
    uint8_t bit = 0x01u;

    while (bit != (1u << GROUP_DATA_LENGTH)) {
        uint8_t value = transmission.report[from];

        if ((value & 0x80u) != 0u) {
            value &= 0x7Fu;
            top_bits |= bit;
        }
        from++;
        to++;
        transmission.bytes[to] = value;
        bit = (uint8_t)(bit << 1);
    }
    transmission.bytes[place] = top_bits;
}

/* The same for one byte of the first group, which holds the answer as well. */
#define PUT_FIRST(index, value)                                                                    \
    do {                                                                                           \
        transmission.bytes[PLACE_OF(index)] = (uint8_t)((uint8_t)(value) & 0x7Fu);                 \
        if (((uint8_t)(value) & 0x80u) != 0u) {                                                    \
            transmission.bytes[FIRST_SYNCHRONIZATION] |= (uint8_t)(1u << (index));                 \
        }                                                                                          \
    } while (false)

static void put_first_group(void)
{
    transmission.bytes[FIRST_SYNCHRONIZATION] = SYNCHRONIZATION_CLASS;
    PUT_FIRST(0u, transmission.answer.session);
    PUT_FIRST(1u, transmission.answer.sequence);
    PUT_FIRST(2u, transmission.answer.kind);
    PUT_FIRST(3u, transmission.answer.status);
    PUT_FIRST(4u, transmission.report[0]);
    PUT_FIRST(5u, transmission.report[1]);
}

static void put_check(void)
{
    uint8_t received_low = crc.low;
    uint8_t received_high = crc.high;
    uint8_t place;

    crc_begin();
    for (place = 0; place < CHECK_PLACE; place++) {
        crc.byte = transmission.bytes[place];
        crc_add();
    }
    transmission.bytes[CHECK_PLACE] = crc_take_bits();
    transmission.bytes[CHECK_PLACE + 1u] = crc_take_bits();
    transmission.bytes[CHECK_PLACE + 2u] = crc_take_bits();
    crc.low = received_low;
    crc.high = received_high;
}

void transmission_begin(void)
{
    transmission.bytes[0] = HEADER_TO_PC;
    put_first_group();
    put_group(FIRST_SYNCHRONIZATION + GROUP_LINE_LENGTH, GROUP_DATA_LENGTH - REPORT_BEGIN);
    put_group(FIRST_SYNCHRONIZATION + (2u * GROUP_LINE_LENGTH),
              (2u * GROUP_DATA_LENGTH) - REPORT_BEGIN);
    put_check();
    transmission.next = 0;
    port_transmit_begin();
}
