/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The status LED. Its second is 1024 ms.
 *
 *     fresh                     a flash of 64 ms once a second
 *     initialising, executing   on
 *     idle                      half a second on, half a second off
 *     stopped                   twice a second
 *     held                      eight times a second
 *     (off: no power, no clock, or no firmware)
 */
#ifndef RSAPIEN_PIC18_LED_H
#define RSAPIEN_PIC18_LED_H

/* Main routine, at least every 250 ms. */
void led_pass(void);

#endif
