/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "host.h"

#include <assert.h>

#include "port.h"
#include "reception.h"

#ifdef RSAPIEN_MOTION
#define WATCHDOG_MS MOTION_WATCHDOG_MS
#else
#define WATCHDOG_MS CAMERA_WATCHDOG_MS
#endif

struct host_chip host_chip;

void port_lock(void)
{
    assert(!host_chip.locked);
    host_chip.locked = true;
}

void port_unlock(void)
{
    assert(host_chip.locked);
    host_chip.locked = false;
}

void port_transmit_begin(void)
{
    /* Nothing to switch on: whoever drives the controller asks it for bytes. */
}

void port_watchdog_clear(void)
{
    host_chip.watchdog_ms = 0;
}

#ifdef RSAPIEN_MOTION
void port_motors(uint8_t towards_first, uint8_t towards_last)
{
    assert((towards_first & towards_last) == 0);
    host_chip.motors_towards_first = towards_first;
    host_chip.motors_towards_last = towards_last;
}

uint8_t port_bumpers(void)
{
    return host_chip.pins.bumpers;
}

bool port_supply_is_low(void)
{
    return host_chip.pins.supply_low;
}
#endif

void host_power_on(uint8_t eeprom_boot)
{
    host_chip = (struct host_chip){0};
    controller_reset(STOP_CAUSE_POWER_ON, eeprom_boot);
}

void host_reset(enum stop_cause cause)
{
    uint8_t eeprom_boot = controller_boot();

    host_chip = (struct host_chip){0};
    controller_reset(cause, eeprom_boot);
}

void host_receive_interrupt(uint8_t byte)
{
    reception_ring.arrived = byte;
    controller_receive_interrupt();
}

void host_timer_interrupt(void)
{
    host_chip.watchdog_ms++;
    if (host_chip.watchdog_ms == WATCHDOG_MS) {
        host_reset(STOP_CAUSE_WATCHDOG);
    } else {
        controller_timer_interrupt();
    }
}

void host_input_change_interrupt(const struct host_pins *pins)
{
#ifdef RSAPIEN_MOTION
    controller_input_change_interrupt(pins->switches);
#else
    (void)pins;
#endif
}

void host_main_routine(const struct host_pins *pins)
{
    if (host_chip.hung) {
        return;
    }
    host_chip.pins = *pins;
    controller_main_routine();
}

void host_tick(const struct host_pins *pins)
{
    host_timer_interrupt();
    host_input_change_interrupt(pins);
    host_main_routine(pins);
}

void host_hang(void)
{
    host_chip.hung = true;
}
