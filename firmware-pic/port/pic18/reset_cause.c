/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "reset_cause.h"

#include "sfr.h"

enum stop_cause reset_cause(void)
{
    enum stop_cause cause = STOP_CAUSE_POWER_ON;

    /* At power-on the other marks tell nothing. */
    if ((RCON & RCON_NOT_POR) != 0) {
        if ((RCON & RCON_NOT_BOR) == 0) {
            cause = STOP_CAUSE_BROWN_OUT;
        } else if (((RCON & RCON_NOT_TO) == 0) || ((RCON & RCON_NOT_RI) == 0) ||
                   ((STKPTR & STKPTR_STKFUL) != 0) || ((STKPTR & STKPTR_STKUNF) != 0)) {
            cause = STOP_CAUSE_WATCHDOG;
        } else {
            /* The reset button. */
        }
    }
    RCON |= RCON_NOT_POR;
    RCON |= RCON_NOT_BOR;
    RCON |= RCON_NOT_RI;
    STKPTR &= (unsigned char)~STKPTR_STKFUL;
    STKPTR &= (unsigned char)~STKPTR_STKUNF;
    return cause;
}
