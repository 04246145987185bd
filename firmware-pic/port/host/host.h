/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * One controller on a PC: the core with a chip that only keeps what it is told. It is driven by
 * the functions of core/controller.h and by these:
 *
 *     host_power_on(0);
 *     host_receive_interrupt(byte);
 *     host_tick(pins);
 *     while (controller_transmit_interrupt()) { use(transmission.byte); }
 */
#ifndef RSAPIEN_HOST_H
#define RSAPIEN_HOST_H

#include <stdbool.h>
#include <stdint.h>

#include "controller.h"

/* The input pins of the motion controller. The camera controller has none. */
struct host_pins {
    uint8_t bumpers;  /* bits 0 to 5: pressed */
    uint8_t switches; /* SWITCH_LEFT, SWITCH_RIGHT: closed */
    bool supply_low;
};

/* The chip's side of the controller. */
struct host_chip {
    uint8_t motors_towards_first; /* the outputs, bit j for joint j */
    uint8_t motors_towards_last;
    uint8_t watchdog_ms; /* ticks since the main routine cleared the watchdog */
    struct host_pins pins;       /* as in the last pass of the main routine */
    bool hung;           /* the main routine no longer runs */
    bool locked;
};

extern struct host_chip host_chip;

/* As with an EEPROM that kept this boot number. */
void host_power_on(uint8_t eeprom_boot);

void host_reset(enum stop_cause cause);

void host_receive_interrupt(uint8_t byte);

/* The timer interrupt, with the watchdog, which counts ticks of its nominal time. */
void host_timer_interrupt(void);
void host_input_change_interrupt(const struct host_pins *pins);
void host_main_routine(const struct host_pins *pins);

/* 1 ms: timer interrupt, input change interrupt, one pass of the main routine. */
void host_tick(const struct host_pins *pins);

/* A fault: the main routine does not run until a reset. */
void host_hang(void);

#endif
