/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The part of the timer routine that moves the joints: dead reckoning by travel time.
 *
 * A position is the time in ms that the motor takes to it from the end stop of the first
 * position: 0 there, T / 2 at the middle, the full travel time T at the end stop of the last. All
 * divisions are by powers of two and round down.
 *
 *                                  remaining = 0 (first, last: on the end stop by now;
 *             sent somewhere       middle without a switch, or with its switch closed)
 *   RESTING ─────────────────► TRAVELLING ──────────────────────────────────────► RESTING, reached
 *    ▲ │  ▲                        │ arm, remaining = 0 at the reckoned middle,
 *    │ │  │ switch closes          ▼ switch open
 *    │ │  ├─────────────────── SEARCHING       goes on for T / 8
 *    │ │  │                        │ remaining = 0
 *    │ │  │ switch closes          ▼
 *    │ │  └─────────────────── SEARCHING_BACK  turns, goes T / 4
 *    │ │                           │ remaining = 0
 *    │ │                           └─────────────────────────────────────────────► RESTING, not reached
 *    │ │ INIT        remaining = T + T / 8
 *    │ └──────► HOMING ── remaining = 0: position = 0, sent to the middle ──► TRAVELLING
 *    └── all off, from any state: reached nothing, the reckoned position stays
 *
 * Sent to an end stop a motor overruns by T / 8, so that the joint surely stands there. A joint
 * sent where it has arrived, or where it is already going, goes on as it is. When the sense
 * turns, both outputs are off until the next tick, even when the motor had arrived just before.
 *
 * The secondary routine for the middle arm position runs when a mid-arm switch changes:
 *
 *   switch changes ─► motor off or homing ──────────────────────────────────► nothing
 *                  ─► more than T / 4 from the reckoned middle ─────────────► nothing (not believed)
 *                  ─► on the way to the middle, closes ─► position = edge, motor off, reached
 *                  ─► on the way to the middle, opens  ─────────────────────► nothing
 *                  ─► on the way to an end stop ─► position = edge, the rest of the way anew
 *
 *   edges:   first ──────────────[ T/2 - T/32      closed      T/2 + T/32 ]────────────── last
 *                    towards last: closes here                  opens here
 *                    towards first: opens here                  closes here
 */
#ifndef RSAPIEN_JOINT_H
#define RSAPIEN_JOINT_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"
#include "protocol.h"

/* What a joint is doing. A joint whose motor is off is resting (0 in Rust): that is told by the
 * motors' bits alone, and its drive's state is what it did before. */
enum joint_state {
    JOINT_STATE_HOMING = 1,
    JOINT_STATE_TRAVELLING = 2,
    JOINT_STATE_SEARCHING = 3,
    JOINT_STATE_SEARCHING_BACK = 4
};

/* What is reckoned of one joint. */
struct joint_drive {
    enum joint_state state;
    /* Where it is going, or where it rests if it arrived there: an enum position, where the
     * joint's bits are in a pose word. POSITION_NONE: it rests anywhere. */
    uint8_t target;
    uint16_t full_travel_ms;
    uint16_t middle_ms;  /* half of it, */
    uint16_t overrun_ms; /* an eighth of it: both kept, since a PIC18 shifts slowly */
    uint16_t run_ms;     /* all of it and the overrun */
    uint16_t position_ms;
    uint16_t remaining_ms; /* ticks until the movement under way ends */
};

/* A full travel time, and what is reckoned from it once. */
struct travel {
    uint16_t full_ms;
    uint16_t middle_ms;
    uint16_t overrun_ms;
    uint16_t run_ms;
    uint16_t position_ms; /* of the joint that gets it */
};

/* The motors, bit j for joint j in each byte, so that one instruction reaches all of them. */
struct motors {
    uint8_t towards_first; /* the sense commanded; */
    uint8_t towards_last;  /* in neither: off */
    uint8_t dead_time;     /* both outputs stay off until the next tick */
    uint8_t driven_first;  /* on the pins last, in the present tick or the one before; */
    uint8_t driven_last;   /* in neither: off for a whole tick */
    uint8_t pins_first;    /* what stands on the pins */
    uint8_t pins_last;
    uint8_t start_first;   /* to be switched on when all joints have been looked at */
    uint8_t start_last;
};

struct joints {
    struct joint_drive drive[JOINT_COUNT];
    struct motors motors;
    uint8_t switches_closed; /* SWITCH_LEFT, SWITCH_RIGHT */
};

extern struct joints joints;

void joints_reset(void);

/* Joints whose motor is on, or will be after its dead time. */
uint8_t joints_moving(void);

/* Pose word of where joints rest, if they arrived there. */
uint8_t joints_pose_reached_low(void);
uint8_t joints_pose_reached_high(void);

/* Puts the motors' outputs on the pins, whatever stands there. */
void joints_drive_pins(void);

/* The same for the timer routine, which runs so often: only if they have changed, or if motors
 * were stopped. */
void joints_drive_changed_pins(void);

/* Timer routine: 1 ms has passed. */
void joints_advance(void);

/* Timer routine, and main routine, locked: sends the joints that `step` names. */
void joints_send(void);

/* Input change routine: the mid-arm switches are closed as SWITCH_LEFT and SWITCH_RIGHT say. */
void joints_switches_changed(uint8_t switches_closed);

/* Main routine, locked: INIT; every motor off; a new full travel time for one joint. */
void joints_home(void);
void joints_stop(void);
void joints_configure(uint8_t joint, uint16_t full_travel_ms);

#endif
