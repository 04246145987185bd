/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "transmission.h"

#include "controller.h"
#include "crc.h"
#include "inline.h"
#include "port.h"

#define HEADER_TO_PC (0xE0u | (CONTROLLER_ADDRESS << 3) | PROTOCOL_VERSION)
#define SYNCHRONIZATION_CLASS 0x80u
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

INLINE bool is_idle(void)
{
    return transmission.next >= SYNCHRONIZATION_PACKAGE_LENGTH;
}

bool transmission_take_owed(void)
{
    if (!transmission.owed || !is_idle()) {
        return false;
    }
    transmission.owed = false;
    return true;
}

bool controller_transmit_interrupt(void)
{
    if (is_idle()) {
        return false;
    }
    transmission.byte = transmission.bytes[transmission.next];
    transmission.next++;
    return true;
}

static void put_content(void)
{
    uint8_t index;
    uint8_t place = PLACE_OF(REPORT_BEGIN);

    transmission.bytes[PLACE_OF(0u)] = transmission.answer.session;
    transmission.bytes[PLACE_OF(1u)] = transmission.answer.sequence;
    transmission.bytes[PLACE_OF(2u)] = transmission.answer.kind;
    transmission.bytes[PLACE_OF(3u)] = (uint8_t)transmission.answer.status;
    for (index = 0; index < REPORT_LENGTH; index++) {
        /* The places of the synchronization bytes are left free. */
        if ((place == PLACE_OF(6u) - 1u) || (place == PLACE_OF(12u) - 1u)) {
            place++;
        }
        transmission.bytes[place] = transmission.report[index];
        place++;
    }
}

/* Moves the top bits of a group into the synchronization byte at `place`. */
static void put_synchronization(uint8_t place)
{
    uint8_t top_bits = 0;
    uint8_t bit = 0x01u;
    uint8_t at = place;

    while (bit != (1u << GROUP_DATA_LENGTH)) {
        at++;
        if ((transmission.bytes[at] & 0x80u) != 0u) {
            transmission.bytes[at] &= 0x7Fu;
            top_bits |= bit;
        }
        bit = (uint8_t)(bit << 1);
    }
    transmission.bytes[place] = (uint8_t)(SYNCHRONIZATION_CLASS | top_bits);
}

static void put_check(void)
{
    uint8_t received_low = crc.low;
    uint8_t received_high = crc.high;
    uint8_t place;

    crc_begin();
    for (place = 0; place < CHECK_PLACE; place++) {
        crc_add(transmission.bytes[place]);
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
    put_content();
    put_synchronization(1u);
    put_synchronization(1u + GROUP_LINE_LENGTH);
    put_synchronization(1u + (2u * GROUP_LINE_LENGTH));
    put_check();
    transmission.next = 0;
    port_transmit_begin();
}
