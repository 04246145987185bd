/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What the port says in sdcc's own words, so that other compilers and checkers can read it too.
 */
#ifndef RSAPIEN_PIC18_COMPILER_H
#define RSAPIEN_PIC18_COMPILER_H

/* The numbers that sdcc has for the two interrupt vectors, 0x0008 and 0x0018. */
#define INTERRUPT_HIGH 1
#define INTERRUPT_LOW 2

#ifdef __SDCC
#define INTERRUPT(priority) __interrupt(priority)
#define CLEAR_WATCHDOG() __asm__("clrwdt")
#else
#define INTERRUPT(priority)
#define CLEAR_WATCHDOG()
#endif

#endif
