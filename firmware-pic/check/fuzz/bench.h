/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The controller on a bench: a chip that does nothing but check what the core asks of it, and
 * that may let interrupts come wherever the main routine gives them room.
 */
#ifndef RSAPIEN_CHECK_BENCH_H
#define RSAPIEN_CHECK_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "controller.h"

/* How many gaps of the main routine interrupts can be planned for. */
#define BENCH_GAPS 8

struct bench {
    uint8_t bumpers;  /* the input pins */
    uint8_t switches;
    bool supply_low;
    uint8_t gaps[BENCH_GAPS]; /* what comes into the next gaps of the main routine; 0: nothing */
};

extern struct bench bench;

/* Prints what is wrong, and aborts. */
void bench_fail(const char *what, const char *file, int line);

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            bench_fail(#condition, __FILE__, __LINE__);                                            \
        }                                                                                          \
    } while (0)

/* Cleared memory, so that an input does the same whatever ran before it, and a reset. */
void bench_power_on(void);
void bench_reset(enum stop_cause cause, uint8_t eeprom_boot);

/* Timer interrupt, input change interrupt, main routine. */
void bench_tick(void);
void bench_timer_interrupt(void);
void bench_input_change_interrupt(void);
void bench_main_routine(void);
void bench_receive(uint8_t byte);

/* The UART can take `count` bytes. Each complete answer is read and checked. */
void bench_transmit(unsigned count);

/* Every invariant of the controller. */
void bench_check(void);

#endif
