/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What the core asks of the chip. A port (port/pic18, port/host) provides these functions and
 * calls those of controller.h.
 */
#ifndef RSAPIEN_PORT_H
#define RSAPIEN_PORT_H

#include <stdbool.h>
#include <stdint.h>

/* The main routine enters or leaves a part that the timer, input change and transmit interrupts
 * must not come into. Never nested, and at most some hundred instructions long. The receive
 * interrupt goes on. */
void port_lock(void);
void port_unlock(void);

/* A response waits in the transmission: the transmit interrupt is to be switched on. */
void port_transmit_begin(void);

/* The main routine is alive. */
void port_watchdog_clear(void);

#ifdef RSAPIEN_MOTION
/* Puts the outputs of all seven motors on the pins, bit j for joint j. No motor is in both
 * words; one in neither is off. Called by interrupts and, locked, by the main routine. */
void port_motors(uint8_t towards_first, uint8_t towards_last);

/* The bumpers that are pressed now, bits 0 to 5, not debounced: asked once a tick. */
uint8_t port_bumpers(void);

/* Whether the supply is below 5 V: asked for a report. */
bool port_supply_is_low(void);
#endif

#endif
