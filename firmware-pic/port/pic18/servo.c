/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "servo.h"

#include "camera.h"
#include "controller.h"
#include "pins.h"
#include "port.h"
#include "sfr.h"

#define FRAME_MS 20u
#define LEAD_US 950u

/* 1500 us in tenths, which 0.01 degree is one of. */
#define NEUTRAL_TENTHS_US 15000

/* Timer1 counts instruction cycles: tenths of a us at 40 MHz, us at 4 MHz. */
#define FRAME_COUNTS ((uint16_t)(FRAME_MS * 250u * (uint32_t)RSAPIEN_CLOCK_MHZ)) /* modulo 65536 */
#define COUNTS_OF_US(us) ((uint16_t)(((us) * RSAPIEN_CLOCK_MHZ) / 4u))
#define TENTHS_US_OF_COUNT (40u / RSAPIEN_CLOCK_MHZ)

/* CCPxM3:0. Off leaves the pin to its latch, which is 0. */
#define COMPARE_OFF 0x00
#define COMPARE_SET_ON_MATCH 0x08
#define COMPARE_CLEAR_ON_MATCH 0x09

_Static_assert((PIN_PORT_OF_PAN_SERVO == PIN_PORT_C) && (PIN_PAN_SERVO == 0x04), "pan is CCP1");
_Static_assert((PIN_PORT_OF_TILT_SERVO == PIN_PORT_C) && (PIN_TILT_SERVO == 0x02), "tilt is CCP2");

struct servo servo;

void servo_begin(void)
{
    servo.frame_ms = 0;
    servo.pulse_begins = false;
    servo.asked = true;
    servo.driven = false;
    servo.rise = COUNTS_OF_US(LEAD_US);
    TMR1H = 0;
    TMR1L = 0;
    T1CON = (uint8_t)(T1CON_RD16 | T1CON_TMR1ON);
}

static void frame_begins(void)
{
    servo.rise += FRAME_COUNTS;
    if (!servo.driven) {
        CCP1CON = COMPARE_OFF;
        CCP2CON = COMPARE_OFF;
        return;
    }
    CCPR1H = (uint8_t)(servo.rise >> 8);
    CCPR1L = (uint8_t)servo.rise;
    CCPR2H = (uint8_t)(servo.rise >> 8);
    CCPR2L = (uint8_t)servo.rise;
    CCP1CON = COMPARE_SET_ON_MATCH;
    CCP2CON = COMPARE_SET_ON_MATCH;
    servo.pulse_begins = true;
}

/* The frame's own pulses, which the main routine may have reckoned anew by now: a servo takes no
 * harm from the newer. The pins are high: setting the mode, which makes them high, changes nothing. */
static void pulse_ends_at_match(void)
{
    uint16_t pan_fall = servo.rise + servo.pan_counts;
    uint16_t tilt_fall = servo.rise + servo.tilt_counts;

    CCPR1H = (uint8_t)(pan_fall >> 8);
    CCPR1L = (uint8_t)pan_fall;
    CCP1CON = COMPARE_CLEAR_ON_MATCH;
    CCPR2H = (uint8_t)(tilt_fall >> 8);
    CCPR2L = (uint8_t)tilt_fall;
    CCP2CON = COMPARE_CLEAR_ON_MATCH;
    servo.pulse_begins = false;
}

void servo_tick(void)
{
    servo.frame_ms++;
    if (servo.frame_ms == FRAME_MS) {
        servo.frame_ms = 0;
        servo.asked = true;
        frame_begins();
    } else if (servo.pulse_begins) {
        pulse_ends_at_match();
    } else {
        /* The units do the rest. */
    }
}

static uint16_t pulse_counts(int16_t centideg)
{
    return (uint16_t)((uint16_t)(NEUTRAL_TENTHS_US + centideg) / TENTHS_US_OF_COUNT);
}

void servo_pass(void)
{
    int16_t pan_centideg;
    int16_t tilt_centideg;
    uint16_t pan_counts;
    uint16_t tilt_counts;

    if (!servo.asked) {
        return;
    }
    port_lock();
    pan_centideg = camera.pan.position_centideg;
    tilt_centideg = camera.tilt.position_centideg;
    port_unlock();
    pan_counts = pulse_counts(pan_centideg);
    tilt_counts = pulse_counts(tilt_centideg);
    port_lock();
    servo.pan_counts = pan_counts;
    servo.tilt_counts = tilt_counts;
    servo.driven = camera.driven;
    servo.asked = false;
    port_unlock();
}
