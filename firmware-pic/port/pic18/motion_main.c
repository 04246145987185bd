/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The motion controller on its chip: start, then one pass of the main routine after the other. */
#include "controller.h"
#include "eeprom.h"
#include "interrupts.h"
#include "led.h"
#include "pins.h"
#include "port.h"
#include "reset_cause.h"
#include "sfr.h"

#define FOOT_BUMPERS (PIN_BUMPER_0 | PIN_BUMPER_1 | PIN_BUMPER_2 | PIN_BUMPER_3)
_Static_assert((PIN_BUMPER_0 == 0x01) && (PIN_BUMPER_1 == 0x02) && (PIN_BUMPER_2 == 0x04) &&
                   (PIN_BUMPER_3 == 0x08),
               "the feet's bumpers stand in order");

#define BUMPER_4 0x10u
#define BUMPER_5 0x20u

uint8_t port_bumpers(void)
{
    uint8_t pressed = (uint8_t)~PORTB & FOOT_BUMPERS;

    if ((PORTA & PIN_BUMPER_4) == 0) {
        pressed |= BUMPER_4;
    }
    if ((PORTA & PIN_BUMPER_5) == 0) {
        pressed |= BUMPER_5;
    }
    return pressed;
}

bool port_supply_is_low(void)
{
    return (PORTA & PIN_SUPPLY_GOOD) == 0;
}

int main(void)
{
    controller_reset(reset_cause(), eeprom_read(EEPROM_BOOT));
    eeprom_write(EEPROM_BOOT, controller_boot());
    interrupts_begin();
    for (;;) {
        controller_main_routine();
        led_pass();
    }
}
