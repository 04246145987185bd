/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The routines of one joint. joint.c includes this file once for each joint, with its number as
 * JOINT: the places of its drive and of its bits are then constants, which a PIC18 reaches in one
 * instruction where a variable number takes ten.
 *
 * JOINT_SWITCH is the bit of the joint's mid-arm switch; not defined for a joint without one.
 */

#define DRIVE joints.drive[JOINT]
#define BIT ((uint8_t)(1u << JOINT))
#define NOT_BIT ((uint8_t) ~(1u << JOINT))
#define JOIN(name, joint) name##_##joint
#define NAME_FOR(name, joint) JOIN(name, joint)
#define NAME(name) NAME_FOR(name, JOINT)

/* Where the joint stands in a pose word. */
#if JOINT < 4
#define POSE_SENT step.pose_low
#define POSE_SHIFT (2u * JOINT)
#else
#define POSE_SENT step.pose_high
#define POSE_SHIFT (2u * (JOINT - 4u))
#endif
#define POSE_MASK ((uint8_t)(3u << POSE_SHIFT))
#define POSE_OF(position) ((uint8_t)((uint8_t)(position) << POSE_SHIFT))

static void NAME(take_travel)(void)
{
    DRIVE.full_travel_ms = travel.full_ms;
    DRIVE.middle_ms = travel.middle_ms;
    DRIVE.overrun_ms = travel.overrun_ms;
    DRIVE.run_ms = travel.run_ms;
    DRIVE.position_ms = travel.position_ms;
}

/* Takes a new full travel time; the position keeps its place between the end stops. */
static void NAME(configure)(void)
{
    travel.position_ms = DRIVE.position_ms;
    scale_position(DRIVE.full_travel_ms);
    NAME(take_travel)();
}

/* Resting somewhere, from now on. */
INLINE void NAME(forget)(void)
{
    DRIVE.target = POSITION_NONE;
}

/* The joint has arrived where it was sent. */
static void NAME(arrive)(void)
{
    joints.motors.towards_first &= NOT_BIT;
    joints.motors.towards_last &= NOT_BIT;
    joints.motors.dead_time &= NOT_BIT;
    joints.motors.start_first &= NOT_BIT;
    joints.motors.start_last &= NOT_BIT;
}

/* The motor's other bits follow for all joints at once, in joints_start(). */
static void NAME(go_to_middle)(void)
{
    DRIVE.state = JOINT_STATE_TRAVELLING;
    if (DRIVE.position_ms < DRIVE.middle_ms) {
        DRIVE.remaining_ms = (uint16_t)(DRIVE.middle_ms - DRIVE.position_ms);
        joints.motors.start_last |= BIT;
    } else {
        DRIVE.remaining_ms = (uint16_t)(DRIVE.position_ms - DRIVE.middle_ms);
        joints.motors.start_first |= BIT;
    }
#ifdef JOINT_SWITCH
    /* A closed switch far from the reckoned middle is stuck: it is not believed. */
    if (((joints.switches_closed & JOINT_SWITCH) != 0u) &&
        (DRIVE.remaining_ms <= DRIVE.overrun_ms)) {
        NAME(arrive)();
    } else if (DRIVE.remaining_ms == 0u) {
        DRIVE.state = JOINT_STATE_SEARCHING;
        DRIVE.remaining_ms = DRIVE.overrun_ms;
        joints.motors.start_first &= NOT_BIT;
        joints.motors.start_last |= BIT;
    } else {
        /* On its way. */
    }
#else
    if (DRIVE.remaining_ms == 0u) {
        NAME(arrive)();
    }
#endif
}

/* The way to the end stop that the joint is going to, from where it is. */
INLINE void NAME(reckon_way_to_first)(void)
{
    DRIVE.remaining_ms = (uint16_t)(DRIVE.position_ms + DRIVE.overrun_ms);
}

INLINE void NAME(reckon_way_to_last)(void)
{
    DRIVE.remaining_ms = (uint16_t)(DRIVE.run_ms - DRIVE.position_ms);
}

/* Sends the joint where `step` says, if it says so, unless it is there or already going there. */
INLINE void NAME(send)(void)
{
    uint8_t target = (uint8_t)(POSE_SENT & POSE_MASK);

    if ((target != 0u) && (target != DRIVE.target)) {
        DRIVE.target = target;
        /* By single bits: first is 1, middle 2, last 3. */
        if ((target & POSE_OF(POSITION_FIRST)) == 0u) {
            NAME(go_to_middle)();
        } else if ((target & POSE_OF(POSITION_MIDDLE)) == 0u) {
            DRIVE.state = JOINT_STATE_TRAVELLING;
            NAME(reckon_way_to_first)();
            joints.motors.start_first |= BIT;
        } else {
            DRIVE.state = JOINT_STATE_TRAVELLING;
            NAME(reckon_way_to_last)();
            joints.motors.start_last |= BIT;
        }
    }
}

/* INIT: to the first end stop from an unknown position, then to the middle. */
INLINE void NAME(home)(void)
{
    DRIVE.target = POSE_OF(POSITION_MIDDLE);
    DRIVE.state = JOINT_STATE_HOMING;
    DRIVE.remaining_ms = DRIVE.run_ms;
    joints.motors.start_first |= BIT;
}

static void NAME(travel_ended)(void)
{
    if (DRIVE.target == POSE_OF(POSITION_FIRST)) {
        DRIVE.position_ms = 0;
    } else if (DRIVE.target == POSE_OF(POSITION_LAST)) {
        DRIVE.position_ms = DRIVE.full_travel_ms;
    } else {
        DRIVE.position_ms = DRIVE.middle_ms;
#ifdef JOINT_SWITCH
        if ((joints.switches_closed & JOINT_SWITCH) == 0u) {
            DRIVE.state = JOINT_STATE_SEARCHING;
            DRIVE.remaining_ms = DRIVE.overrun_ms;
            return;
        }
#endif
    }
    NAME(arrive)();
}

#ifdef JOINT_SWITCH
INLINE void NAME(search_back)(void)
{
    DRIVE.state = JOINT_STATE_SEARCHING_BACK;
    DRIVE.remaining_ms = (uint16_t)(DRIVE.overrun_ms << 1);
    if ((joints.motors.towards_last & BIT) != 0u) {
        joints.motors.start_first |= BIT;
    } else {
        joints.motors.start_last |= BIT;
    }
}
#endif

static void NAME(movement_ended)(void)
{
    if (DRIVE.state == JOINT_STATE_TRAVELLING) {
        NAME(travel_ended)();
    } else if (DRIVE.state == JOINT_STATE_HOMING) {
        DRIVE.position_ms = 0;
        NAME(go_to_middle)();
    } else {
#ifdef JOINT_SWITCH
        if (DRIVE.state == JOINT_STATE_SEARCHING) {
            NAME(search_back)();
        } else {
            NAME(arrive)();
            NAME(forget)();
        }
#endif
    }
}

/* Timer routine, for a joint whose outputs are on: 1 ms has passed. */
INLINE void NAME(advance)(void)
{
    if ((joints.motors.towards_last & BIT) != 0u) {
        if (DRIVE.position_ms < DRIVE.full_travel_ms) {
            DRIVE.position_ms++;
        }
    } else if (DRIVE.position_ms != 0u) {
        DRIVE.position_ms--;
    } else {
        /* On its end stop by reckoning, and running on to be sure. */
    }
    DRIVE.remaining_ms--;
    if (DRIVE.remaining_ms == 0u) {
        NAME(movement_ended)();
    }
}

#ifdef JOINT_SWITCH
/* Whether a change of the switch is believed: not far from where it ought to be. */
static bool NAME(is_near_middle)(void)
{
    uint16_t way_ms;

    if (DRIVE.position_ms < DRIVE.middle_ms) {
        way_ms = (uint16_t)(DRIVE.middle_ms - DRIVE.position_ms);
    } else {
        way_ms = (uint16_t)(DRIVE.position_ms - DRIVE.middle_ms);
    }
    return way_ms <= (uint16_t)(DRIVE.full_travel_ms >> BELIEVED_SHIFT);
}

INLINE void NAME(set_first_edge)(void)
{
    DRIVE.position_ms = (uint16_t)(DRIVE.full_travel_ms >> SWITCH_HALF_WINDOW_SHIFT);
    DRIVE.position_ms = (uint16_t)(DRIVE.middle_ms - DRIVE.position_ms);
}

INLINE void NAME(set_last_edge)(void)
{
    DRIVE.position_ms = (uint16_t)(DRIVE.full_travel_ms >> SWITCH_HALF_WINDOW_SHIFT);
    DRIVE.position_ms += DRIVE.middle_ms;
}

static void NAME(switch_changed)(void)
{
    bool is_closed = (joints.switches_closed & JOINT_SWITCH) != 0u;
    bool is_to_middle = (DRIVE.target == POSE_OF(POSITION_MIDDLE));

    if (((joints_moving() & BIT) == 0u) || (DRIVE.state == JOINT_STATE_HOMING) ||
        (is_to_middle && !is_closed) || !NAME(is_near_middle)()) {
        return;
    }
    if ((joints.motors.towards_last & BIT) != 0u) {
        if (is_closed) {
            NAME(set_first_edge)();
        } else {
            NAME(set_last_edge)();
        }
        NAME(reckon_way_to_last)();
    } else {
        if (is_closed) {
            NAME(set_last_edge)();
        } else {
            NAME(set_first_edge)();
        }
        NAME(reckon_way_to_first)();
    }
    if (is_to_middle) {
        NAME(arrive)();
    }
}
#endif

#undef DRIVE
#undef BIT
#undef NOT_BIT
#undef JOIN
#undef NAME_FOR
#undef NAME
#undef POSE_SENT
#undef POSE_SHIFT
#undef POSE_MASK
#undef POSE_OF
#undef JOINT
#undef JOINT_SWITCH
