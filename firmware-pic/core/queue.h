/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The queue of steps: a ring that the main routine fills, locked, and the timer routine empties.
 *
 *              append                     ┌─────┐ append, take
 *   EMPTY ─────────────────────► WAITING ─┘ ◄───┘
 *     ▲                           │   │ ▲
 *     └── take the last, clear ───┘   │ └── take ─── FULL ── append: refused, nothing changes
 *     ▲                               └── 32nd ───► │
 *     └── clear ────────────────────────────────────┘
 *
 * The running step has left the queue, so 32 steps may wait behind it.
 */
#ifndef RSAPIEN_QUEUE_H
#define RSAPIEN_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"

/* What is kept of a step. */
struct step {
    uint8_t pose_low;
    uint8_t pose_high;
    uint8_t duration_low_ms;
    uint8_t duration_high_ms;
    uint8_t ending_bumpers;
};

/* One array for each byte of a step: an index into bytes needs no multiplication. */
struct queue {
    uint8_t first;
    uint8_t count;
    uint8_t pose_low[QUEUE_LENGTH];
    uint8_t pose_high[QUEUE_LENGTH];
    uint8_t duration_low_ms[QUEUE_LENGTH];
    uint8_t duration_high_ms[QUEUE_LENGTH];
    uint8_t ending_bumpers[QUEUE_LENGTH];
};

extern struct queue queue;

/* The step to append, and the one that was taken. */
extern struct step step;

void queue_clear(void);
uint8_t queue_free(void);

/* Appends `step`; false when there is no place. */
bool queue_append(void);

/* Takes the first one into `step`; false when none waits. */
bool queue_take(void);

#endif
