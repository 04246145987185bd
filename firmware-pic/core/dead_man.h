/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The dead-man: silence ends motion.
 *
 *              intact package to this controller: silence = 0
 *            ┌──────────┐
 *            ▼          │
 *        LISTENING ─────┴── tick: silence + 1; silence = dead-man time, and something moves
 *            ▲                                                  │ trip: all off, queue emptied,
 *            └──────────────────────────────────────────────────┘       held
 *
 * The timer routine counts and trips, so a hung main routine cannot keep the motors on.
 */
#ifndef RSAPIEN_DEAD_MAN_H
#define RSAPIEN_DEAD_MAN_H

#include <stdbool.h>
#include <stdint.h>

#include "inline.h"

struct dead_man {
    uint16_t timeout_ms; /* 0: off; set by CONFIGURE, locked */
    uint16_t silence_ms; /* at most 65535; the timer routine's alone */
    volatile bool heard; /* a package came since the last tick */
    uint16_t trips;
};

extern struct dead_man dead_man;

void dead_man_reset(void);

/* Timer routine. */
INLINE void dead_man_tick(void)
{
    if (dead_man.heard) {
        dead_man.heard = false;
        dead_man.silence_ms = 0;
    }
    dead_man.silence_ms++;
    if (dead_man.silence_ms == 0u) {
        dead_man.silence_ms = 0xFFFFu;
    }
}

/* Timer routine: whether the silence has lasted the dead-man time, so that it trips if something
 * moves; then it is to be counted in `trips`. */
INLINE bool dead_man_is_due(void)
{
    return (dead_man.silence_ms >= dead_man.timeout_ms) && (dead_man.timeout_ms != 0u);
}

/* Main routine: the silence is over. The timer routine begins to count anew, so that nothing needs
 * to be locked for it. */
INLINE void dead_man_package_received(void)
{
    dead_man.heard = true;
}

#endif
