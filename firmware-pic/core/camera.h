/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The camera controller (paper, section 2): one routine for each axis, one that monitors the
 * global position, and a main routine like that of the motion controller.
 *
 *                     HOME                           at zero, no AIM waits
 *   FRESH, IDLE, ─────────────► INITIALISING ───────────────────────────────► IDLE
 *   EXECUTING,                      │ at zero, an AIM waits              AIM   │  ▲ both axes
 *   STOPPED, HELD                   ▼                                          │  │ arrived
 *       ▲     ▲                 EXECUTING ◄────────────────────────────────────┘  │
 *       │     │ dead-man            │  └──────────────────────────────────────────┘
 *       │ STOP└─────── HELD ◄───────┘          STOPPED ── AIM, if homed ──► EXECUTING
 *    STOPPED                                   HELD ── AIM: refused; HOME and STOP release
 *
 * The axes are hobby servos. At reset they get no pulses and may stand anywhere. The first HOME
 * gives both the pulses of zero and waits HOME_SETTLE_MS, by when the slowest has come from its
 * limit; a later HOME goes to zero at full speed. An AIM that comes during HOME waits for its
 * end; a newer one takes its place. Stopped and held axes keep the pulses of where they are,
 * since a servo without pulses lets the camera sag; before the first HOME has ended they lose
 * them, since only that stops a servo that is on its way from an unknown place.
 */
#ifndef RSAPIEN_CAMERA_H
#define RSAPIEN_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol.h"

/* Angles in 0.01 degree: pan right, tilt up are positive. */
struct axis {
    int16_t position_centideg; /* commanded to the servo */
    int16_t target_centideg;
    uint8_t tenths;
};

/* Where both axes are to go, and how fast, as above. */
struct aim {
    int16_t pan_centideg;
    int16_t tilt_centideg;
    uint8_t step_centideg;
    uint8_t step_tenths;
};

struct camera {
    enum mode mode;
    bool homed;  /* a HOME has ended since reset, so AIM is accepted */
    bool driven; /* the servos get pulses, of the axes' positions */
    bool aim_waits;
    struct axis pan;
    struct axis tilt;
    uint8_t step_centideg; /* speed of the movement under way: so much a tick, */
    uint8_t step_tenths;   /* and tenths of 0.01 degree */
    struct aim aim;        /* asked for last; it waits for the end of HOME if `aim_waits` */
    uint16_t settle_ms; /* ticks that the first HOME waits still */
};

/* The port reads `driven` and the positions in the timer interrupt. */
extern struct camera camera;

#endif
