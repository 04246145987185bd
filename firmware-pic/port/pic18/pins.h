/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The pin map of both controllers: the one place where it stands. docs/firmware.md's wiring
 * table says the same, which a test compares.
 *
 *     PIN(port, bit, use, NAME, "what it is")
 *
 * use: INPUT; LOW or HIGH: an output, and its level from reset on. Pins that are not named are
 * outputs at 0, so that none floats, but for those of crystal, reset and programmer.
 */
#ifndef RSAPIEN_PIC18_PINS_H
#define RSAPIEN_PIC18_PINS_H

/* PIC18F452, 40 pins. All switches are between the pin and ground with a pull-up: 0 is pressed
 * or closed. */
#define MOTION_PINS(PIN)                                                                           \
    PIN(D, 0, LOW, MOTOR_0_FIRST, "right arm up")                                                  \
    PIN(D, 1, LOW, MOTOR_1_FIRST, "left arm up")                                                   \
    PIN(D, 2, LOW, MOTOR_2_FIRST, "right hand in")                                                 \
    PIN(D, 3, LOW, MOTOR_3_FIRST, "left hand in")                                                  \
    PIN(D, 4, LOW, MOTOR_4_FIRST, "tilt left")                                                     \
    PIN(D, 5, LOW, MOTOR_5_FIRST, "right leg front")                                               \
    PIN(D, 6, LOW, MOTOR_6_FIRST, "left leg front")                                                \
    PIN(D, 7, LOW, LED, "status LED, 1 is on")                                                     \
    PIN(C, 0, LOW, MOTOR_0_LAST, "right arm down")                                                 \
    PIN(C, 1, LOW, MOTOR_1_LAST, "left arm down")                                                  \
    PIN(C, 2, LOW, MOTOR_2_LAST, "right hand open")                                                \
    PIN(C, 3, LOW, MOTOR_3_LAST, "left hand open")                                                 \
    PIN(C, 4, LOW, MOTOR_4_LAST, "tilt right")                                                     \
    PIN(C, 5, LOW, MOTOR_5_LAST, "right leg back")                                                 \
    PIN(E, 0, LOW, MOTOR_6_LAST, "left leg back")                                                  \
    PIN(B, 0, INPUT, BUMPER_0, "left foot front")                                                  \
    PIN(B, 1, INPUT, BUMPER_1, "left foot back")                                                   \
    PIN(B, 2, INPUT, BUMPER_2, "right foot front")                                                 \
    PIN(B, 3, INPUT, BUMPER_3, "right foot back")                                                  \
    PIN(A, 0, INPUT, BUMPER_4, "left hand")                                                        \
    PIN(A, 1, INPUT, BUMPER_5, "right hand")                                                       \
    PIN(B, 4, INPUT, SWITCH_LEFT_ARM, "left mid-arm switch")                                       \
    PIN(B, 5, INPUT, SWITCH_RIGHT_ARM, "right mid-arm switch")                                     \
    PIN(A, 2, INPUT, SUPPLY_GOOD, "supply detector, open drain, 0 below 5 V")                      \
    PIN(E, 1, LOW, TICK, "test point, turns every ms")                                             \
    PIN(C, 6, HIGH, TX, "to the level shifter")                                                    \
    PIN(C, 7, INPUT, RX, "from the level shifter")                                                 \
    PIN(B, 6, INPUT, PGC, "programmer")                                                            \
    PIN(B, 7, INPUT, PGD, "programmer")

/* PIC18F2320, 28 pins. */
#define CAMERA_PINS(PIN)                                                                           \
    PIN(C, 2, LOW, PAN_SERVO, "pan servo, CCP1")                                                   \
    PIN(C, 1, LOW, TILT_SERVO, "tilt servo, CCP2")                                                 \
    PIN(B, 0, LOW, LED, "status LED, 1 is on")                                                     \
    PIN(B, 1, LOW, TICK, "test point, turns every ms")                                             \
    PIN(C, 6, HIGH, TX, "to the level shifter")                                                    \
    PIN(C, 7, INPUT, RX, "from the level shifter")                                                 \
    PIN(B, 6, INPUT, PGC, "programmer")                                                            \
    PIN(B, 7, INPUT, PGD, "programmer")

#ifdef RSAPIEN_MOTION
#define PINS(PIN) MOTION_PINS(PIN)
#else
#define PINS(PIN) CAMERA_PINS(PIN)
#endif

/* Each pin's bit in its port: PIN_LED and so on. */
#define PIN_MASK(port, bit, use, name, text) PIN_##name = 1 << (bit),
enum pin_mask { PINS(PIN_MASK) PIN_MASK_END };

/* Each pin's port: PIN_PORT_OF_LED and so on. */
#define PIN_PORT_OF(port, bit, use, name, text) PIN_PORT_OF_##name = PIN_PORT_##port,
enum pin_port {
    PIN_PORT_A,
    PIN_PORT_B,
    PIN_PORT_C,
    PIN_PORT_D,
    PIN_PORT_E,
    PINS(PIN_PORT_OF)
    PIN_PORT_END
};

enum pin_use { PIN_USE_LOW = 0, PIN_USE_HIGH = 1, PIN_USE_INPUT = 2 };

/* What TRIS (1: input) and LAT of each port are at reset. */
#define PIN_INPUT_OF(of, port, bit, use)                                                           \
    +((PIN_PORT_##port == (of)) && (PIN_USE_##use == PIN_USE_INPUT) ? 1 << (bit) : 0)
#define PIN_HIGH_OF(of, port, bit, use)                                                            \
    +((PIN_PORT_##port == (of)) && (PIN_USE_##use == PIN_USE_HIGH) ? 1 << (bit) : 0)
#define PIN_TRIS_A(port, bit, use, name, text) PIN_INPUT_OF(PIN_PORT_A, port, bit, use)
#define PIN_TRIS_B(port, bit, use, name, text) PIN_INPUT_OF(PIN_PORT_B, port, bit, use)
#define PIN_TRIS_C(port, bit, use, name, text) PIN_INPUT_OF(PIN_PORT_C, port, bit, use)
#define PIN_TRIS_D(port, bit, use, name, text) PIN_INPUT_OF(PIN_PORT_D, port, bit, use)
#define PIN_TRIS_E(port, bit, use, name, text) PIN_INPUT_OF(PIN_PORT_E, port, bit, use)
#define PIN_LAT_C(port, bit, use, name, text) PIN_HIGH_OF(PIN_PORT_C, port, bit, use)

enum pin_reset {
    PIN_RESET_TRISA = 0 PINS(PIN_TRIS_A),
    PIN_RESET_TRISB = 0 PINS(PIN_TRIS_B),
    PIN_RESET_TRISC = 0 PINS(PIN_TRIS_C),
    PIN_RESET_TRISD = 0 PINS(PIN_TRIS_D),
    PIN_RESET_TRISE = 0 PINS(PIN_TRIS_E),
    PIN_RESET_LATC = 0 PINS(PIN_LAT_C)
};

/* All outputs as the map says: motors off, servos without pulses. The start-up calls it before
 * anything else, when there is no stack yet. */
void pins_reset(void);

#endif
