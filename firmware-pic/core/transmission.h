/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The response on its way, and the answer that is owed.
 *
 *              main routine: an answer is owed
 *        IDLE ────────────────────────────────► TRANSMITTING ──┐ transmit interrupt:
 *          ▲     (report as of this moment)          ▲         │ next byte handed out
 *          │                                         └─────────┤
 *          └───────────── 25th byte handed out ────────────────┘
 *
 * A response is never cut off. A package that comes while one is on its way is executed at once
 * and answered as soon as the transmitter is idle; a newer answer takes an older one's place.
 */
#ifndef RSAPIEN_TRANSMISSION_H
#define RSAPIEN_TRANSMISSION_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"
#include "inline.h"
#include "protocol.h"

/* What an answer echoes, and the status. */
struct answer {
    uint8_t session;
    uint8_t sequence;
    uint8_t kind;
    enum status status;
};

struct transmission {
    uint8_t bytes[SYNCHRONIZATION_PACKAGE_LENGTH];
    volatile uint8_t next; /* to be handed out; the package's length when idle */
    uint8_t byte;          /* handed out by controller_transmit_interrupt() */
    bool owed;
    struct answer answer;            /* owed, or just taken */
    uint8_t report[REPORT_LENGTH];   /* to be filled before transmission_begin() */
};

extern struct transmission transmission;

void transmission_reset(void);

/* Main routine: the answer in `transmission.answer` is owed. */
void transmission_owe(void);

INLINE bool transmission_is_idle(void)
{
    return transmission.next >= SYNCHRONIZATION_PACKAGE_LENGTH;
}

/* Main routine: whether an answer is owed and can be initiated now; then it is owed no more. */
INLINE bool transmission_take_owed(void)
{
    if (!transmission.owed || !transmission_is_idle()) {
        return false;
    }
    transmission.owed = false;
    return true;
}

/* Main routine: sends `transmission.answer` with `transmission.report`. */
void transmission_begin(void);

/* Puts a word into the report, low byte first. */
#define REPORT_PUT_WORD(offset, word)                                                              \
    do {                                                                                           \
        transmission.report[(offset)] = (uint8_t)((word) & 0xFFu);                                 \
        transmission.report[(offset) + 1u] = (uint8_t)((word) >> 8);                               \
    } while (false)

#endif
