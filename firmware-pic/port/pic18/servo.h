/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * Pulses for the two servos of the camera head: every 20 ms one of 1500 us, and 10 us more for
 * each degree to the right or up. Both edges are made by the CCP units in compare mode on Timer1,
 * so they are exact to the instruction cycle whatever the interrupts do:
 *
 *   tick    0                        1                                     20
 *           |- 950 us -+=============|==== pulse ====+                     |
 *      set on match at        clear on match at
 *      Timer1 + 950 us        the rising edge + pulse
 *
 * The tick at which the second match is set comes 50 us after the rising edge; the shortest pulse is
 * 600 us, so that tick may be 550 us late. Frames begin every 20 ms of Timer1, to the cycle.
 */
#ifndef RSAPIEN_PIC18_SERVO_H
#define RSAPIEN_PIC18_SERVO_H

#include <stdbool.h>
#include <stdint.h>

struct servo {
    uint8_t frame_ms;
    bool pulse_begins;   /* this frame has a pulse whose end is not set yet */
    volatile bool asked; /* the interrupt wants the next frame's pulses */
    bool driven;
    uint16_t pan_counts; /* pulses, in counts of Timer1 */
    uint16_t tilt_counts;
    uint16_t rise; /* of Timer1, this frame */
};

extern struct servo servo;

/* Right before the tick begins: Timer1 and the tick, which divide the same clock, then keep step. */
void servo_begin(void);

/* Low-priority interrupt, every ms, before anything that takes a varying time. */
void servo_tick(void);

/* Main routine: reckons the pulses of the next frame when they are asked for. */
void servo_pass(void);

#endif
