/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The interrupt routines, and the peripherals that call them.
 *
 *   high   USART reception: a byte, or an error, into the core's ring
 *   low    Timer2: the tick; then the mid-arm switches, at each tick and when RB4 or RB5 change;
 *          then USART transmission
 *
 * The routine of high priority comes in between those of low priority. No routine reads a table
 * in program memory, multiplies or divides 16 bits: sdcc's interrupts do not save what that needs.
 */
#ifndef RSAPIEN_PIC18_INTERRUPTS_H
#define RSAPIEN_PIC18_INTERRUPTS_H

#include <stdint.h>

/* Ticks since reset, modulo 256. */
extern volatile uint8_t interrupts_ticks;

/* Starts timer and USART and lets the interrupts come. */
void interrupts_begin(void);

#endif
