/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What a fuzz input means: a list of events, each a byte that says what happens (its low four
 * bits) and how (its high four), and the bytes that belong to it. Whatever the bytes are, they
 * are some list of events; what is missing at the end counts as zero.
 */
#ifndef RSAPIEN_CHECK_EVENTS_H
#define RSAPIEN_CHECK_EVENTS_H

#include <stddef.h>
#include <stdint.h>

/* Runs the events from power-on. Ends the program by abort() when something is not as it must be. */
void run_events(const uint8_t *bytes, size_t length);

#endif
