/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * Reception: the ring between the receive interrupt and the main routine, and the state machine
 * that finds intact packages in what comes out of it.
 *
 *              header for me                sync byte            sixth data byte, group left
 *  HUNTING ───────────────────► SYNCHRONIZATION ─────► DATA ──────────────► SYNCHRONIZATION
 *     ▲                                                  │ sixth data byte, last group
 *     │  wrong class, gap, line error (counted)          ▼
 *     ├───────────────────────────────────────────────  CHECK ── third byte: package or
 *     │                                                   │       CRC error
 *     └───────────────────────────────────────────────────┘
 *
 * A header byte in any state abandons what was under way and starts afresh.
 */
#ifndef RSAPIEN_RECEPTION_H
#define RSAPIEN_RECEPTION_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"
#include "inline.h"

enum reception_state {
    RECEPTION_HUNTING = 0,
    RECEPTION_SYNCHRONIZATION = 1,
    RECEPTION_DATA = 2,
    RECEPTION_CHECK = 3
};

/* The ring. `put` and `taken` run on modulo 256; `put` and `overflowed` are set by the
 * interrupt, `taken` by the main routine, which alone clears `overflowed`. */
struct reception_ring {
    uint8_t arrived; /* received now; the receive interrupt's alone */
    uint8_t bytes[RECEIVE_RING_LENGTH];
    uint8_t sorts[RECEIVE_RING_LENGTH]; /* 0: a byte; else an enum line_error + 1 */
    volatile uint8_t put;
    uint8_t taken;
    volatile bool overflowed;
};

struct reception {
    enum reception_state state;
    uint8_t top_bits;    /* of the group under way, the next byte's lowest */
    uint8_t group_index; /* bytes of the group, or of the check, that have come */
    uint8_t content_index;
    uint8_t content_used; /* bytes of the content up to its last that is not zero */
    uint8_t byte;         /* the one under consideration */
    bool check_differs;
    volatile uint8_t silence_ms; /* ticks since a byte was taken out, at most 255 */
    uint8_t errors;              /* modulo 256, each event once */
    uint16_t accepted;
    uint16_t resets;
    uint16_t crc_errors;
    uint16_t framing_errors;
    uint16_t overruns;
    uint8_t content[ACTION_CONTENT_LENGTH]; /* intact after reception_next_package() said so */
};

extern struct reception_ring reception_ring;
extern struct reception reception;

void reception_reset(void);

/* Timer routine. */
INLINE void reception_tick(void)
{
    if (reception.silence_ms != 0xFFu) {
        reception.silence_ms++;
    }
}

/* Main routine: takes bytes out until a package is complete, which is told, or the ring is
 * empty. Bytes behind a complete package wait for the next pass, so that no answer is lost. */
bool reception_next_package(void);

#endif
