/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "dead_man.h"

#include "constants.h"

struct dead_man dead_man;

void dead_man_reset(void)
{
    dead_man.timeout_ms = DEAD_MAN_MS_DEFAULT;
    dead_man.silence_ms = 0;
    dead_man.heard = false;
    dead_man.trips = 0;
}
