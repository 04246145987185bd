/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The tick: Timer2 divides the instruction clock (a quarter of RSAPIEN_CLOCK_MHZ) by prescaler,
 * period and postscaler, so that its interrupt comes every 1 ms to the cycle.
 */
#ifndef RSAPIEN_PIC18_CLOCK_H
#define RSAPIEN_PIC18_CLOCK_H

#include "controller.h"

#define TICK_PERIOD 250u
#if RSAPIEN_CLOCK_MHZ == 40
#define TICK_PRESCALER 4
#define TICK_POSTSCALER 10
#elif RSAPIEN_CLOCK_MHZ == 20
#define TICK_PRESCALER 4
#define TICK_POSTSCALER 5
#elif RSAPIEN_CLOCK_MHZ == 10
#define TICK_PRESCALER 1
#define TICK_POSTSCALER 10
#else
#define TICK_PRESCALER 1
#define TICK_POSTSCALER 4
#endif

#if TICK_PERIOD * TICK_PRESCALER * TICK_POSTSCALER != RSAPIEN_CLOCK_MHZ * 250
#error "the tick is not 1 ms"
#endif

#define TICK_PR2 ((uint8_t)(TICK_PERIOD - 1u))
/* TOUTPS3:0, TMR2ON, T2CKPS1:0 (1 to 4: 01, no prescaler: 00). */
#define TICK_T2CON (((TICK_POSTSCALER - 1) << 3) | (1 << 2) | ((TICK_PRESCALER == 4) ? 1 : 0))

#endif
