/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The baud rate generator for RSAPIEN_CLOCK_MHZ and RSAPIEN_BAUD, in its high-speed mode
 * (TXSTA.BRGH = 1): baud rate = clock / (16 * (SPBRG + 1)). A combination whose baud rate is more
 * than 2 % off does not compile: sender and receiver together may differ by 5 % at most.
 */
#ifndef RSAPIEN_PIC18_BAUD_H
#define RSAPIEN_PIC18_BAUD_H

#include "controller.h"

#ifndef RSAPIEN_BAUD
#define RSAPIEN_BAUD 57600
#endif
#if RSAPIEN_BAUD != 19200 && RSAPIEN_BAUD != 38400 && RSAPIEN_BAUD != 57600 && RSAPIEN_BAUD != 115200
#error "RSAPIEN_BAUD is 19200, 38400, 57600 or 115200"
#endif

#define CLOCK_HZ (RSAPIEN_CLOCK_MHZ * 1000000L)

/* The divisor that comes nearest. */
#define BAUD_DIVISOR ((CLOCK_HZ + (8L * RSAPIEN_BAUD)) / (16L * RSAPIEN_BAUD))
#define BAUD_SPBRG (BAUD_DIVISOR - 1)

/* The clock that this divisor would want. */
#define BAUD_CLOCK_HZ (16L * BAUD_DIVISOR * RSAPIEN_BAUD)
#if CLOCK_HZ > BAUD_CLOCK_HZ
#define BAUD_CLOCK_DIFFERENCE_HZ (CLOCK_HZ - BAUD_CLOCK_HZ)
#else
#define BAUD_CLOCK_DIFFERENCE_HZ (BAUD_CLOCK_HZ - CLOCK_HZ)
#endif

#if BAUD_DIVISOR < 1 || BAUD_DIVISOR > 256
#error "the baud rate generator does not reach RSAPIEN_BAUD at RSAPIEN_CLOCK_MHZ"
#endif
#if BAUD_CLOCK_DIFFERENCE_HZ * 50 > BAUD_CLOCK_HZ
#error "RSAPIEN_BAUD would be more than 2 % off at RSAPIEN_CLOCK_MHZ; take a lower one"
#endif

#endif
