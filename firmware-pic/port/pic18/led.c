/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "led.h"

#include <stdint.h>

#include "controller.h"
#include "inline.h"
#include "interrupts.h"
#include "pins.h"
#include "sfr.h"

#ifdef RSAPIEN_MOTION
#define LED_LATCH LATD
_Static_assert(PIN_PORT_OF_LED == PIN_PORT_D, "the LED's latch is that of the pin map");
#else
#define LED_LATCH LATB
_Static_assert(PIN_PORT_OF_LED == PIN_PORT_B, "the LED's latch is that of the pin map");
#endif

/* Bits of the time in 4 ms: they blink by themselves. */
#define HALF_SECONDS 0x80u
#define QUARTER_SECONDS 0x40u
#define SIXTEENTHS_OF_A_SECOND 0x10u
#define ALL_BUT_THE_FLASH 0xF0u

struct led {
    uint8_t ticks;     /* seen so far, in fours */
    uint8_t time_4_ms; /* of the second */
};

static struct led led;

/* The bits of the time that are 0 while the LED is on. */
INLINE uint8_t dark_bits(void)
{
    enum mode mode = controller_mode();

    if (mode == MODE_IDLE) {
        return HALF_SECONDS;
    }
    if (mode == MODE_FRESH) {
        return ALL_BUT_THE_FLASH;
    }
    if (mode == MODE_STOPPED) {
        return QUARTER_SECONDS;
    }
    if (mode == MODE_HELD) {
        return SIXTEENTHS_OF_A_SECOND;
    }
    return 0u; /* initialising, executing */
}

void led_pass(void)
{
    if ((uint8_t)(interrupts_ticks - led.ticks) < 4u) {
        return;
    }
    led.ticks += 4u;
    led.time_4_ms++;
    /* One instruction each: the timer interrupt writes other bits of the same latch. */
    if ((led.time_4_ms & dark_bits()) == 0u) {
        LED_LATCH |= PIN_LED;
    } else {
        LED_LATCH &= (uint8_t)~PIN_LED;
    }
}
