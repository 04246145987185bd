/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The firmware of one controller of the robot, without the chip.
 *
 *     controller_reset(STOP_CAUSE_POWER_ON, boot_number_in_eeprom);
 *     for (;;) {
 *         controller_main_routine();
 *     }
 *
 * and from the interrupts, by priority:
 *
 *     high  controller_receive_interrupt(), controller_receive_error(error)
 *     low   controller_timer_interrupt(), every ms; then
 *           controller_input_change_interrupt(switches_closed), at each change and each ms
 *     low   controller_transmit_interrupt(), whenever the UART can take a byte
 *
 * Which controller it is, is said when it is compiled: RSAPIEN_MOTION (PIC18F452, seven motors)
 * or RSAPIEN_CAMERA (PIC18F2320, pan and tilt). One program is one controller, so each module
 * keeps its state in one struct at a fixed address: on a PIC18 that takes one instruction to
 * reach where a pointer takes ten.
 *
 * It does what the reference model in Rust does (crates/firmware-model), to the tick and to the
 * byte, with the same names of routines, states and constants.
 */
#ifndef RSAPIEN_CONTROLLER_H
#define RSAPIEN_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#include "constants.h"
#include "protocol.h"

#if defined(RSAPIEN_MOTION) == defined(RSAPIEN_CAMERA)
#error "define RSAPIEN_MOTION or RSAPIEN_CAMERA: which controller is it?"
#endif

/* The clock that the firmware is built for, in MHz; HELLO tells it. */
#ifndef RSAPIEN_CLOCK_MHZ
#define RSAPIEN_CLOCK_MHZ 40
#endif
#if RSAPIEN_CLOCK_MHZ != 4 && RSAPIEN_CLOCK_MHZ != 10 && RSAPIEN_CLOCK_MHZ != 20 && \
    RSAPIEN_CLOCK_MHZ != 40
#error "RSAPIEN_CLOCK_MHZ is 4, 10, 20 or 40"
#endif

#ifdef RSAPIEN_MOTION
#define CONTROLLER_ADDRESS 1u
#else
#define CONTROLLER_ADDRESS 2u
#endif

/* What the UART could not receive. */
enum line_error {
    LINE_ERROR_FRAMING = 0, /* no stop bit where one belongs */
    LINE_ERROR_OVERRUN = 1  /* a byte was lost because nobody fetched the one before */
};

/* The controller as it leaves a reset for one of the causes power-on, brown-out and watchdog.
 * `eeprom_boot` is the boot number that the EEPROM kept; controller_boot() is then one more and
 * is to be written back. Motors off, no pulses; interrupts are not on yet. */
void controller_reset(enum stop_cause cause, uint8_t eeprom_boot);
uint8_t controller_boot(void);

/* The UART has received the byte that the port has put into `reception_ring.arrived`. */
void controller_receive_interrupt(void);
void controller_receive_error(enum line_error error);

/* Whether there is a byte to send, which is then in `transmission.byte`; if not, the interrupt
 * is to be switched off. */
bool controller_transmit_interrupt(void);

/* 1 ms has passed. */
void controller_timer_interrupt(void);

enum mode controller_mode(void);

#ifdef RSAPIEN_MOTION
/* Mid-arm switches that are closed. */
#define SWITCH_LEFT 0x01u
#define SWITCH_RIGHT 0x02u

/* The mid-arm switches are closed as the bits SWITCH_LEFT and SWITCH_RIGHT say. */
void controller_input_change_interrupt(uint8_t switches_closed);

#endif

/* One pass of the main routine. */
void controller_main_routine(void);

#endif
