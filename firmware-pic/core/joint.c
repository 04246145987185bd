/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "joint.h"

#include "controller.h"
#include "inline.h"
#include "port.h"
#include "queue.h"

/* Bits of a full travel time. */
#define TRAVEL_BITS 14u
#if TRAVEL_MS_MAX >= (1u << TRAVEL_BITS)
#error "a full travel time has more bits"
#endif
#if DEAD_TIME_MS != 1
#error "a bit a joint keeps one tick of dead time"
#endif

/* No pins are like this, so the next time they are written in any case. */
#define PINS_UNKNOWN 0xFFu

struct joints joints;

/* The travel time that a joint is about to get. Main routine only. */
static struct travel travel;

static void set_travel(uint16_t full_travel_ms)
{
    travel.full_ms = full_travel_ms;
    travel.middle_ms = (uint16_t)(full_travel_ms >> 1);
    travel.overrun_ms = (uint16_t)(full_travel_ms >> OVERRUN_SHIFT);
    travel.run_ms = (uint16_t)(full_travel_ms + travel.overrun_ms);
}

/* Scales `travel.position_ms` from a travel time of `old_travel_ms`, at least as much, to
 * `travel.full_ms`, rounding down: long multiplication and long division at once, a bit of the
 * factor a turn. What is left over stays below `old_travel_ms`, so three times TRAVEL_MS_MAX is the
 * most that 16 bits ever hold here. */
static void scale_position(uint16_t old_travel_ms)
{
    uint16_t factor = (uint16_t)(travel.full_ms << (16u - TRAVEL_BITS));
    uint16_t quotient = 0;
    uint16_t left_over = 0;
    uint8_t bits;

    for (bits = 0; bits < TRAVEL_BITS; bits++) {
        quotient = (uint16_t)(quotient << 1);
        left_over = (uint16_t)(left_over << 1);
        if ((factor & 0x8000u) != 0u) {
            left_over += travel.position_ms;
        }
        factor = (uint16_t)(factor << 1);
        while (left_over >= old_travel_ms) {
            left_over -= old_travel_ms;
            quotient++;
        }
    }
    travel.position_ms = quotient;
}

#define JOINT 0
#define JOINT_SWITCH SWITCH_RIGHT
#include "joint_routines.h"

#define JOINT 1
#define JOINT_SWITCH SWITCH_LEFT
#include "joint_routines.h"

#define JOINT 2
#include "joint_routines.h"

#define JOINT 3
#include "joint_routines.h"

#define JOINT 4
#include "joint_routines.h"

#define JOINT 5
#include "joint_routines.h"

#define JOINT 6
#include "joint_routines.h"

/* Whether a joint's bit is set in a byte of joints. */
#define HAS(byte, joint) (((byte) & (uint8_t)(1u << (joint))) != 0u)

static void motors_off(void)
{
    joints.motors.towards_first = 0;
    joints.motors.towards_last = 0;
    joints.motors.dead_time = 0;
}

void joints_reset(void)
{
    travel.position_ms = 0;
    set_travel(FULL_TRAVEL_MS_RIGHT_ARM);
    take_travel_0();
    forget_0();
    set_travel(FULL_TRAVEL_MS_LEFT_ARM);
    take_travel_1();
    forget_1();
    set_travel(FULL_TRAVEL_MS_RIGHT_HAND);
    take_travel_2();
    forget_2();
    set_travel(FULL_TRAVEL_MS_LEFT_HAND);
    take_travel_3();
    forget_3();
    set_travel(FULL_TRAVEL_MS_TILT);
    take_travel_4();
    forget_4();
    set_travel(FULL_TRAVEL_MS_RIGHT_LEG);
    take_travel_5();
    forget_5();
    set_travel(FULL_TRAVEL_MS_LEFT_LEG);
    take_travel_6();
    forget_6();
    motors_off();
    joints.motors.driven_first = 0;
    joints.motors.driven_last = 0;
    joints.motors.start_first = 0;
    joints.motors.start_last = 0;
    joints.switches_closed = 0;
}

uint8_t joints_moving(void)
{
    return (uint8_t)(joints.motors.towards_first | joints.motors.towards_last);
}

uint8_t joints_pose_reached_low(void)
{
    uint8_t moving = joints_moving();
    uint8_t pose = 0;

    if (!HAS(moving, 0)) {
        pose |= joints.drive[0].target;
    }
    if (!HAS(moving, 1)) {
        pose |= joints.drive[1].target;
    }
    if (!HAS(moving, 2)) {
        pose |= joints.drive[2].target;
    }
    if (!HAS(moving, 3)) {
        pose |= joints.drive[3].target;
    }
    return pose;
}

uint8_t joints_pose_reached_high(void)
{
    uint8_t moving = joints_moving();
    uint8_t pose = 0;

    if (!HAS(moving, 4)) {
        pose |= joints.drive[4].target;
    }
    if (!HAS(moving, 5)) {
        pose |= joints.drive[5].target;
    }
    if (!HAS(moving, 6)) {
        pose |= joints.drive[6].target;
    }
    return pose;
}

void joints_drive_pins(void)
{
    uint8_t on = (uint8_t)~joints.motors.dead_time;

    joints.motors.pins_first = (uint8_t)(joints.motors.towards_first & on);
    joints.motors.pins_last = (uint8_t)(joints.motors.towards_last & on);
    port_motors(joints.motors.pins_first, joints.motors.pins_last);
}

void joints_drive_changed_pins(void)
{
    uint8_t on = (uint8_t)~joints.motors.dead_time;

    if (((joints.motors.towards_first & on) != joints.motors.pins_first) ||
        ((joints.motors.towards_last & on) != joints.motors.pins_last)) {
        joints_drive_pins();
    }
}

/* Switches the motors on that were started. One whose sense turns rests until the next tick. */
INLINE void joints_start(void)
{
    uint8_t turning = (uint8_t)((joints.motors.start_first & joints.motors.driven_last) |
                                (joints.motors.start_last & joints.motors.driven_first));

    joints.motors.dead_time &= (uint8_t)~joints.motors.start_first;
    joints.motors.dead_time &= (uint8_t)~joints.motors.start_last;
    joints.motors.towards_first &= (uint8_t)~joints.motors.start_last;
    joints.motors.towards_first |= joints.motors.start_first;
    joints.motors.towards_last &= (uint8_t)~joints.motors.start_first;
    joints.motors.towards_last |= joints.motors.start_last;
    if (turning != 0u) {
        joints.motors.dead_time |= turning;
        joints.motors.start_first &= (uint8_t)~turning;
        joints.motors.start_last &= (uint8_t)~turning;
    }
    joints.motors.driven_first |= joints.motors.start_first;
    joints.motors.driven_last |= joints.motors.start_last;
    joints.motors.start_first = 0;
    joints.motors.start_last = 0;
}

void joints_advance(void)
{
    /* The ms in which both outputs are off is not reckoned. */
    uint8_t driven = (uint8_t)((joints.motors.towards_first | joints.motors.towards_last) &
                               (uint8_t)~joints.motors.dead_time);

    joints.motors.dead_time = 0;
    joints.motors.driven_first = joints.motors.towards_first;
    joints.motors.driven_last = joints.motors.towards_last;
    if (driven == 0u) {
        return;
    }
    if (HAS(driven, 0)) {
        advance_0();
    }
    if (HAS(driven, 1)) {
        advance_1();
    }
    if (HAS(driven, 2)) {
        advance_2();
    }
    if (HAS(driven, 3)) {
        advance_3();
    }
    if (HAS(driven, 4)) {
        advance_4();
    }
    if (HAS(driven, 5)) {
        advance_5();
    }
    if (HAS(driven, 6)) {
        advance_6();
    }
    if ((joints.motors.start_first | joints.motors.start_last) != 0u) {
        joints_start();
    }
}

void joints_send(void)
{
    send_0();
    send_1();
    send_2();
    send_3();
    send_4();
    send_5();
    send_6();
    joints_start();
}

void joints_switches_changed(uint8_t switches_closed)
{
    uint8_t changed = (uint8_t)(joints.switches_closed ^ switches_closed);

    joints.switches_closed = switches_closed;
    if ((changed & SWITCH_RIGHT) != 0u) {
        switch_changed_0();
    }
    if ((changed & SWITCH_LEFT) != 0u) {
        switch_changed_1();
    }
}

void joints_home(void)
{
    home_0();
    home_1();
    home_2();
    home_3();
    home_4();
    home_5();
    home_6();
    joints_start();
}

void joints_stop(void)
{
    uint8_t moving = joints_moving();

    if (HAS(moving, 0)) {
        forget_0();
    }
    if (HAS(moving, 1)) {
        forget_1();
    }
    if (HAS(moving, 2)) {
        forget_2();
    }
    if (HAS(moving, 3)) {
        forget_3();
    }
    if (HAS(moving, 4)) {
        forget_4();
    }
    if (HAS(moving, 5)) {
        forget_5();
    }
    if (HAS(moving, 6)) {
        forget_6();
    }
    motors_off();
    joints.motors.pins_first = PINS_UNKNOWN;
}

void joints_configure(uint8_t joint, uint16_t full_travel_ms)
{
    set_travel(full_travel_ms);
    switch (joint) {
    case JOINT_RIGHT_ARM:
        configure_0();
        break;
    case JOINT_LEFT_ARM:
        configure_1();
        break;
    case JOINT_RIGHT_HAND:
        configure_2();
        break;
    case JOINT_LEFT_HAND:
        configure_3();
        break;
    case JOINT_TILT:
        configure_4();
        break;
    case JOINT_RIGHT_LEG:
        configure_5();
        break;
    default:
        configure_6();
        break;
    }
}
