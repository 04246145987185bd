/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What the bytes of a package's content mean (crates/protocol/SPEC.md, sections 4 and 5). Names
 * and values are those of the Rust crate rsapien-protocol; a test compares them.
 */
#ifndef RSAPIEN_PROTOCOL_H
#define RSAPIEN_PROTOCOL_H

enum kind {
    KIND_HELLO = 0x01,
    KIND_STATE = 0x02,
    KIND_STOP = 0x03,
    KIND_COUNTERS = 0x04,
    KIND_INIT = 0x10,
    KIND_STEP = 0x11,
    KIND_CONFIGURE = 0x12,
    KIND_AIM = 0x20,
    KIND_HOME = 0x21
};

/* Kinds from here on are executed only in their turn. */
#define KIND_NUMBERED_FIRST 0x10u

enum status {
    STATUS_ACCEPTED = 0,
    STATUS_UNKNOWN_KIND = 1,
    STATUS_BAD_ARGUMENT = 2,
    STATUS_QUEUE_FULL = 3,
    STATUS_NO_SESSION = 4,
    STATUS_OUT_OF_SEQUENCE = 5,
    STATUS_HELD = 6,
    STATUS_VERSION_NOT_SPOKEN = 7,
    STATUS_NOT_THIS_CONTROLLERS = 8,
    STATUS_NOT_INITIALISED = 9,
    /* Never told: nothing speaks against the request, the controller is to execute it. */
    STATUS_TO_BE_EXECUTED = 0xFF
};

enum mode {
    MODE_FRESH = 0,
    MODE_INITIALISING = 1,
    MODE_IDLE = 2,
    MODE_EXECUTING = 3,
    MODE_STOPPED = 4,
    MODE_HELD = 5
};

enum stop_cause {
    STOP_CAUSE_NOTHING = 0,
    STOP_CAUSE_DEAD_MAN = 1,
    STOP_CAUSE_BUMPER = 2,
    STOP_CAUSE_POWER_ON = 3,
    STOP_CAUSE_BROWN_OUT = 4,
    STOP_CAUSE_WATCHDOG = 5
};

/* A position of a joint, as a pose word has it. */
enum position {
    POSITION_NONE = 0,
    POSITION_FIRST = 1,
    POSITION_MIDDLE = 2,
    POSITION_LAST = 3
};

/* Joints, as bit numbers. */
enum joint {
    JOINT_RIGHT_ARM = 0,
    JOINT_LEFT_ARM = 1,
    JOINT_RIGHT_HAND = 2,
    JOINT_LEFT_HAND = 3,
    JOINT_TILT = 4,
    JOINT_RIGHT_LEG = 5,
    JOINT_LEFT_LEG = 6
};

/* Offsets in the content of an action package; `_END`: the first unused byte. */
#define ACTION_SESSION 0u
#define ACTION_SEQUENCE 1u
#define ACTION_KIND 2u
#define ACTION_ARGUMENTS 3u
#define HELLO_LOWEST 3u
#define HELLO_HIGHEST 4u
#define HELLO_SESSION 5u
#define HELLO_END 6u
#define STEP_POSE 3u
#define STEP_DURATION 5u
#define STEP_FLAGS 7u
#define STEP_BUMPERS 8u
#define STEP_END 9u
#define CONFIGURE_PARAMETER 3u
#define CONFIGURE_VALUE 4u
#define CONFIGURE_END 6u
#define AIM_PAN 3u
#define AIM_TILT 5u
#define AIM_SPEED 7u
#define AIM_END 9u

#define STEP_FLAG_REPLACE 0x01u
#define STEP_BUMPERS_MASK 0x3Fu
/* Bits 14 and 15 of a pose are none, seen in its high byte. */
#define STEP_POSE_HIGH_MASK 0x3Fu

/* A report is bytes 4..=17 of a synchronization package's content; offsets are from byte 4. */
#define REPORT_LENGTH 14u
#define REPORT_MODE 0u
#define REPORT_INPUTS 1u
#define REPORT_PRESSES 2u
#define REPORT_MOTORS 5u
#define REPORT_POSE_REACHED 6u
#define REPORT_QUEUE_FREE 8u
#define REPORT_STEPS_ENDED 9u
#define REPORT_BOOT 11u
#define REPORT_ERRORS 12u
#define REPORT_CAUSE 13u
#define REPORT_PAN 1u
#define REPORT_TILT 3u
#define REPORT_PAN_TARGET 5u
#define REPORT_TILT_TARGET 7u
#define REPORT_AXES 9u
#define REPORT_HELLO_VERSION 0u
#define REPORT_HELLO_FIRMWARE 1u
#define REPORT_HELLO_CLOCK 4u
#define REPORT_HELLO_QUEUE 5u
#define REPORT_HELLO_DEAD_MAN 6u
#define REPORT_HELLO_LAST_SEQUENCE 8u

#endif
