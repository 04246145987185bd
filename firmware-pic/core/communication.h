/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What both controllers have in common: one pass of the main routine up to the response, and the
 * reports that do not depend on what moves.
 *
 *   watchdog cleared
 *         ▼
 *   package complete? ── yes ─► analysed ── in its turn ─► executed ─► an answer is owed
 *         │ no                     └── refused, duplicate ──────────►     │
 *         ▼                                                               │
 *   answer owed, transmitter idle? ◄──────────────────────────────────────┘
 *         │ no       └── yes ─► response initiated, with the report of this moment
 *         ▼                        │
 *   bumpers tested (motion) ◄──────┘
 */
#ifndef RSAPIEN_COMMUNICATION_H
#define RSAPIEN_COMMUNICATION_H

#include <stdint.h>

#include "dead_man.h"
#include "inline.h"
#include "protocol.h"
#include "reception.h"

struct communication {
    uint8_t boot;
    enum stop_cause cause; /* why the controller was held or reset last */
};

extern struct communication communication;

void communication_reset(enum stop_cause cause, uint8_t eeprom_boot);

/* Timer routine. */
INLINE void communication_tick(void)
{
    reception_tick();
    dead_man_tick();
}

/* Main routine: everything but what the controller tests by itself. */
void communication_pass(void);

/* The reports, into `transmission.report`. */
void communication_report_hello(enum status status);
void communication_report_counters(void);

/* What communication_pass() asks of the controller: to execute the request in
 * `reception.content`, whose arguments are right and whose turn it is, and to report. */
enum status controller_execute(void);
void controller_report(void);

#endif
