/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#ifndef RSAPIEN_PIC18_RESET_CAUSE_H
#define RSAPIEN_PIC18_RESET_CAUSE_H

#include "protocol.h"

/* Why the chip was reset: power-on (the reset button too), brown-out, or watchdog, which a stack
 * beyond its end and a RESET instruction count as too: the program went astray. Makes the marks
 * ready for the next reset, so it tells it once. */
enum stop_cause reset_cause(void);

#endif
