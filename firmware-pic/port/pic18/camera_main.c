/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The camera controller on its chip: start, then one pass of the main routine after the other. */
#include "controller.h"
#include "eeprom.h"
#include "interrupts.h"
#include "led.h"
#include "reset_cause.h"
#include "servo.h"

int main(void)
{
    controller_reset(reset_cause(), eeprom_read(EEPROM_BOOT));
    eeprom_write(EEPROM_BOOT, controller_boot());
    servo_begin();
    interrupts_begin();
    for (;;) {
        controller_main_routine();
        servo_pass();
        led_pass();
    }
}
