/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The fourteen outputs of the seven motors. */
#include "controller.h"
#include "pins.h"
#include "port.h"
#include "sfr.h"

/* Towards first: one port, in the order of the joints. Towards last: joints 0 to 5 on another,
 * joint 6 on a third. */
#define FIRST_PINS 0x7F
#define LAST_PINS_C 0x3F
#define JOINT_6 0x40

#define IS_FIRST_IN_PLACE(joint)                                                                   \
    ((PIN_PORT_OF_MOTOR_##joint##_FIRST == PIN_PORT_D) &&                                          \
     (PIN_MOTOR_##joint##_FIRST == (1 << (joint))))
#define IS_LAST_IN_PLACE(joint)                                                                    \
    ((PIN_PORT_OF_MOTOR_##joint##_LAST == PIN_PORT_C) && (PIN_MOTOR_##joint##_LAST == (1 << (joint))))
_Static_assert(IS_FIRST_IN_PLACE(0) && IS_FIRST_IN_PLACE(1) && IS_FIRST_IN_PLACE(2) &&
                   IS_FIRST_IN_PLACE(3) && IS_FIRST_IN_PLACE(4) && IS_FIRST_IN_PLACE(5) &&
                   IS_FIRST_IN_PLACE(6),
               "towards first: port D, in the order of the joints");
_Static_assert(IS_LAST_IN_PLACE(0) && IS_LAST_IN_PLACE(1) && IS_LAST_IN_PLACE(2) &&
                   IS_LAST_IN_PLACE(3) && IS_LAST_IN_PLACE(4) && IS_LAST_IN_PLACE(5),
               "towards last: port C, in the order of the joints");
_Static_assert(PIN_PORT_OF_MOTOR_6_LAST == PIN_PORT_E, "towards last: joint 6 on port E");

/* What goes off goes off before anything goes on, so no motor ever has both outputs on. Ands and
 * ors of whole latches are one instruction each: LED, test point and TX keep theirs.
 *
 * When a motor's sense turns, the core calls this with both off and, at the next tick, with the
 * other sense. The tick may come right behind the main routine's call: still, from off to on the
 * way is at least out of the locked part, into the interrupt and through its routine to here:
 * README.md has the number of cycles. */
void port_motors(uint8_t towards_first, uint8_t towards_last)
{
    towards_first |= (uint8_t)~FIRST_PINS;
    LATD &= towards_first;
    if ((towards_last & JOINT_6) != 0) {
        LATE |= PIN_MOTOR_6_LAST;
    } else {
        LATE &= (uint8_t)~PIN_MOTOR_6_LAST;
    }
    towards_last |= (uint8_t)~LAST_PINS_C;
    LATC &= towards_last;
    towards_last &= LAST_PINS_C;
    LATC |= towards_last;
    towards_first &= FIRST_PINS;
    LATD |= towards_first;
}
