/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * How the main routine tests the bumpers, once a tick.
 *
 *  each bumper:   differs from what is believed ─► differing + 1 ─► = 5: believed; a press is counted
 *                 as believed                   ─► differing = 0
 *
 * A change is believed when BUMPER_DEBOUNCE_TESTS tests in a row have seen it. At reset no bumper
 * is believed to be pressed: one that is counts as a press.
 */
#ifndef RSAPIEN_BUMPER_H
#define RSAPIEN_BUMPER_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"

struct bumpers {
    volatile bool due;  /* the timer routine ran since the last test */
    uint8_t pressed;    /* as believed; read by the timer routine */
    uint8_t unsettled;  /* those that the last test saw differ: no other's `differing` is not 0 */
    uint8_t differing[BUMPER_COUNT];
    uint8_t presses[BUMPER_COUNT]; /* modulo 16 */
};

extern struct bumpers bumpers;

void bumpers_reset(void);

/* Main routine: the pins are as in `pins`. */
void bumpers_test(uint8_t pins);

#endif
