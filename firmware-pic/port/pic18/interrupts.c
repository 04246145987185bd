/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "interrupts.h"

#include "baud.h"
#include "clock.h"
#include "compiler.h"
#include "controller.h"
#include "inline.h"
#include "pins.h"
#include "port.h"
#include "reception.h"
#include "sfr.h"
#include "transmission.h"

#ifdef RSAPIEN_MOTION
#define TICK_LATCH LATE
_Static_assert(PIN_PORT_OF_TICK == PIN_PORT_E, "the test point's latch is that of the pin map");
#define SWITCH_PINS (PIN_SWITCH_LEFT_ARM | PIN_SWITCH_RIGHT_ARM)
#define SWITCH_SHIFT 4
_Static_assert((PIN_SWITCH_LEFT_ARM >> SWITCH_SHIFT) == SWITCH_LEFT, "switches stand in order");
_Static_assert((PIN_SWITCH_RIGHT_ARM >> SWITCH_SHIFT) == SWITCH_RIGHT, "switches stand in order");
#else
#include "servo.h"
#define TICK_LATCH LATB
_Static_assert(PIN_PORT_OF_TICK == PIN_PORT_B, "the test point's latch is that of the pin map");
#endif

volatile uint8_t interrupts_ticks;

#ifdef RSAPIEN_MOTION
/* The switches' pins as the core knows them. */
static uint8_t switch_pins;

/* Looks at the switches at each tick too: a change in the very cycle in which the main routine
 * reads the bumpers of the same port makes no interrupt. */
INLINE void switches_test(void)
{
    uint8_t pins = PORTB & SWITCH_PINS;

    if (pins != switch_pins) {
        switch_pins = pins;
        controller_input_change_interrupt((uint8_t)((uint8_t)(pins ^ SWITCH_PINS) >> SWITCH_SHIFT));
    }
}
#endif

void interrupt_receive(void) INTERRUPT(INTERRUPT_HIGH)
{
    /* FERR belongs to the byte that RCREG gives next, and reading RCREG clears RCIF. */
    if ((RCSTA & RCSTA_FERR) != 0) {
        (void)RCREG;
        controller_receive_error(LINE_ERROR_FRAMING);
    } else {
        reception_ring.arrived = RCREG;
        controller_receive_interrupt();
    }
    if ((RCSTA & RCSTA_OERR) != 0) {
        RCSTA &= (uint8_t)~RCSTA_CREN;
        RCSTA |= RCSTA_CREN;
        controller_receive_error(LINE_ERROR_OVERRUN);
    }
}

void interrupt_low(void) INTERRUPT(INTERRUPT_LOW)
{
    if ((PIR1 & PIR1_TMR2IF) != 0) {
        PIR1 &= (uint8_t)~PIR1_TMR2IF;
        TICK_LATCH ^= PIN_TICK;
        interrupts_ticks++;
#ifdef RSAPIEN_CAMERA
        servo_tick();
#endif
        controller_timer_interrupt();
#ifdef RSAPIEN_MOTION
        switches_test();
#endif
    }
#ifdef RSAPIEN_MOTION
    if ((INTCON & INTCON_RBIF) != 0) {
        /* Reading the port before the flag is cleared ends the mismatch that set it. */
        switches_test();
        INTCON &= (uint8_t)~INTCON_RBIF;
    }
#endif
    if (((PIE1 & PIE1_TXIE) != 0) && ((PIR1 & PIR1_TXIF) != 0)) {
        if (controller_transmit_interrupt()) {
            TXREG = transmission.byte;
        } else {
            PIE1 &= (uint8_t)~PIE1_TXIE;
        }
    }
}

void interrupts_begin(void)
{
#ifdef RSAPIEN_MOTION
    switch_pins = SWITCH_PINS;
    INTCON2 &= (uint8_t)~INTCON2_NOT_RBPU;
    INTCON2 &= (uint8_t)~INTCON2_RBIP;
    INTCON |= INTCON_RBIE;
#endif
    PR2 = TICK_PR2;
    T2CON = TICK_T2CON;

    SPBRG = (uint8_t)BAUD_SPBRG;
    TXSTA = (uint8_t)(TXSTA_BRGH | TXSTA_TXEN);
    RCSTA = (uint8_t)(RCSTA_SPEN | RCSTA_CREN);

    IPR1 = IPR1_RCIP;
    PIE1 = (uint8_t)(PIE1_RCIE | PIE1_TMR2IE);
    RCON |= RCON_IPEN;
    INTCON |= INTCON_GIEL;
    INTCON |= INTCON_GIEH;
}

void port_lock(void)
{
    /* An interrupt that comes with this very instruction switches them on again when it returns. */
    do {
        INTCON &= (uint8_t)~INTCON_GIEL;
    } while ((INTCON & INTCON_GIEL) != 0);
}

void port_unlock(void)
{
    INTCON |= INTCON_GIEL;
}

void port_transmit_begin(void)
{
    PIE1 |= PIE1_TXIE;
}

void port_watchdog_clear(void)
{
    CLEAR_WATCHDOG();
}
