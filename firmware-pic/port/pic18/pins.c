/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "pins.h"

#include "sfr.h"

/* All pins digital. The two chips count differently. */
#ifdef RSAPIEN_MOTION
#define ADCON1_ALL_DIGITAL 0x06
#else
#define ADCON1_ALL_DIGITAL 0x0F
#endif

/* Constants only: the build checks that this needs no stack. Latches first, so that no output
 * shows what a latch holds by chance. */
void pins_reset(void)
{
#ifdef RSAPIEN_MOTION
    LATD = 0;
    LATE = 0;
#endif
    LATC = PIN_RESET_LATC;
    LATA = 0;
    LATB = 0;
#ifdef RSAPIEN_MOTION
    TRISD = PIN_RESET_TRISD;
    TRISE = PIN_RESET_TRISE;
#endif
    TRISC = PIN_RESET_TRISC;
    ADCON1 = ADCON1_ALL_DIGITAL;
    TRISA = PIN_RESET_TRISA;
    TRISB = PIN_RESET_TRISB;
}
