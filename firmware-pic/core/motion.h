/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The motion controller (paper, section 2): its timer routine and its main routine.
 *
 *   reset ──► FRESH
 *   any mode ── INIT ──► INITIALISING
 *   any mode ── STOP ──► STOPPED
 *   any mode in which something moves ── dead-man trips ──► HELD
 *
 *                   every joint rests, no step waits
 *   INITIALISING ───────────────────────────────────────► IDLE
 *        │                                                │  ▲
 *        │ every joint rests,                        STEP │  │ duration over, no step waits
 *        │ a step waits                                   ▼  │
 *        └────────────────────────────────────────────► EXECUTING ─┐ duration over, a step waits:
 *                                                         ▲  │ ▲   │ it starts; STEP, replace:
 *   STOPPED ── STEP, if INIT has ended since reset ───────┘  │ └───┘ the new one starts
 *                                                            │
 *   HELD ◄── ending bumper pressed, or pressed when its step ┘
 *            starts
 *
 * The mode tells of the queue: a motor whose joint has not arrived runs on while the mode is
 * already idle, until the joint arrives. The dead-man watches such a motor too.
 */
#ifndef RSAPIEN_MOTION_H
#define RSAPIEN_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol.h"

struct motion {
    enum mode mode;
    bool initialised;            /* INIT has ended since reset and no other was begun */
    uint16_t step_remaining_ms;  /* a step runs exactly in mode executing */
    uint8_t step_ending_bumpers; /* of the running step */
    uint16_t steps_ended;
};

extern struct motion motion;

#endif
