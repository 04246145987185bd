/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "reception.h"

#include "controller.h"
#include "crc.h"
#include "inline.h"

#define RING_MASK (RECEIVE_RING_LENGTH - 1u)

/* The classes of line bytes, by their top bits. */
#define IS_DATA(byte) (((byte) & 0x80u) == 0u)
#define IS_HEADER(byte) (((byte) & 0xC0u) == 0xC0u)
#define HEADER_FOR_ME (0xC0u | (CONTROLLER_ADDRESS << 3) | PROTOCOL_VERSION)

#define SORT_BYTE 0u
#define SORT_OF(error) ((uint8_t)((uint8_t)(error) + 1u))

#if (RECEIVE_RING_LENGTH & RING_MASK) != 0u || RECEIVE_RING_LENGTH > 128u
#error "the ring's length is a power of two, at most 128"
#endif

struct reception_ring reception_ring;
struct reception reception;

void reception_reset(void)
{
    uint8_t place;

    for (place = 0; place < RECEIVE_RING_LENGTH; place++) {
        reception_ring.sorts[place] = SORT_BYTE;
    }
    reception_ring.put = 0;
    reception_ring.taken = 0;
    reception_ring.overflowed = false;
    reception.state = RECEPTION_HUNTING;
    reception.silence_ms = 0;
    reception.errors = 0;
    reception.accepted = 0;
    reception.resets = 0;
    reception.crc_errors = 0;
    reception.framing_errors = 0;
    reception.overruns = 0;
}

/* Once a byte is lost the ones behind it are worth nothing: all are dropped until the main
 * routine has seen the end of what came before and told the state machine. */
INLINE bool ring_has_a_place(void)
{
    uint8_t waiting = (uint8_t)(reception_ring.put - reception_ring.taken);

    if (reception_ring.overflowed || (waiting == RECEIVE_RING_LENGTH)) {
        reception_ring.overflowed = true;
        return false;
    }
    return true;
}

void controller_receive_interrupt(void)
{
    if (ring_has_a_place()) {
        reception_ring.bytes[reception_ring.put & RING_MASK] = reception_ring.arrived;
        reception_ring.put++;
    }
}

void controller_receive_error(enum line_error error)
{
    if (ring_has_a_place()) {
        reception_ring.sorts[reception_ring.put & RING_MASK] = SORT_OF(error);
        reception_ring.put++;
    }
}

static void abandon_package(void)
{
    reception.resets++;
    reception.errors++;
    reception.state = RECEPTION_HUNTING;
}

static void line_error(uint8_t sort)
{
    if (sort == SORT_OF(LINE_ERROR_FRAMING)) {
        reception.framing_errors++;
    } else {
        reception.overruns++;
    }
    reception.errors++;
    if (reception.state != RECEPTION_HUNTING) {
        reception.resets++;
        reception.state = RECEPTION_HUNTING;
    }
}

INLINE void take_header(void)
{
    if (reception.state != RECEPTION_HUNTING) {
        abandon_package();
    }
    if (reception.byte == HEADER_FOR_ME) {
        crc_begin();
        crc.byte = reception.byte;
        crc_add();
        reception.content_index = 0;
        reception.content_used = 0;
        reception.state = RECEPTION_SYNCHRONIZATION;
    }
}

INLINE void take_synchronization(void)
{
    reception.top_bits = reception.byte;
    reception.group_index = 0;
    crc.byte = reception.byte;
    crc_add();
    reception.state = RECEPTION_DATA;
}

INLINE void take_data(void)
{
    crc.byte = reception.byte;
    crc_add();
    if ((reception.top_bits & 0x01u) != 0u) {
        reception.byte |= 0x80u;
    }
    reception.top_bits >>= 1;
    reception.content[reception.content_index] = reception.byte;
    reception.content_index++;
    if (reception.byte != 0u) {
        reception.content_used = reception.content_index;
    }
    reception.group_index++;
    if (reception.group_index == GROUP_DATA_LENGTH) {
        reception.state = RECEPTION_SYNCHRONIZATION;
        if (reception.content_index == ACTION_CONTENT_LENGTH) {
            reception.group_index = 0;
            reception.check_differs = false;
            reception.state = RECEPTION_CHECK;
        }
    }
}

/* The check's third byte, with bits 14 and 15; tells whether it completed an intact package. */
INLINE bool take_last_check(void)
{
    if (reception.byte > LAST_CHECK_BYTE_MAX) {
        abandon_package();
        return false;
    }
    reception.state = RECEPTION_HUNTING;
    if (reception.check_differs || (reception.byte != (uint8_t)(crc.high >> 6))) {
        reception.crc_errors++;
        reception.errors++;
        return false;
    }
    reception.accepted++;
    return true;
}

/* The check's first byte, with bits 0 to 6, and its second, with bits 7 to 13. */
INLINE void take_check(void)
{
    uint8_t expected;

    if (reception.group_index == 0u) {
        expected = (uint8_t)(crc.low & 0x7Fu);
    } else {
        expected = (uint8_t)((uint8_t)(crc.high << 1) & 0x7Fu);
        if ((crc.low & 0x80u) != 0u) {
            expected |= 0x01u;
        }
    }
    if (reception.byte != expected) {
        reception.check_differs = true;
    }
    reception.group_index++;
}

/* Takes `reception.byte`; tells whether it completed an intact package. */
static bool take_byte(void)
{
    reception.silence_ms = 0;
    if (IS_DATA(reception.byte)) {
        if (reception.state == RECEPTION_DATA) {
            take_data();
        } else if (reception.state == RECEPTION_CHECK) {
            if (reception.group_index == (CHECK_LENGTH - 1u)) {
                return take_last_check();
            }
            take_check();
        } else if (reception.state == RECEPTION_SYNCHRONIZATION) {
            abandon_package();
        } else {
            /* Another controller's package, or noise. */
        }
    } else if (IS_HEADER(reception.byte)) {
        take_header();
    } else if (reception.state == RECEPTION_SYNCHRONIZATION) {
        take_synchronization();
    } else if (reception.state != RECEPTION_HUNTING) {
        abandon_package();
    } else {
        /* Another controller's package, or noise. */
    }
    return false;
}

bool reception_next_package(void)
{
    if ((reception.silence_ms > GAP_MS_ROBOT) && (reception.state != RECEPTION_HUNTING)) {
        abandon_package();
    }
    while (reception_ring.taken != reception_ring.put) {
        uint8_t place = (uint8_t)(reception_ring.taken & RING_MASK);
        uint8_t sort = reception_ring.sorts[place];

        if (sort != SORT_BYTE) {
            /* Before the place is free: the interrupt marks nothing but errors. */
            reception_ring.sorts[place] = SORT_BYTE;
            reception_ring.taken++;
            line_error(sort);
        } else {
            reception.byte = reception_ring.bytes[place];
            reception_ring.taken++;
            if (take_byte()) {
                return true;
            }
        }
    }
    if (reception_ring.overflowed) {
        reception_ring.overflowed = false;
        line_error(SORT_OF(LINE_ERROR_OVERRUN));
    }
    return false;
}
