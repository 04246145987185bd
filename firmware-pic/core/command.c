/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "command.h"

#include "controller.h"
#include "inline.h"
#include "reception.h"

#define CONTENT reception.content

/* What one content byte asks of the next. */
#define PARAMETER_DEAD_MAN 0u

struct command command;

void command_reset(void)
{
    command.session = 0;
    command.last_sequence = 0;
    command.any_executed = false;
    command.duplicates = 0;
}

/* Whether the bytes from `end` on, which the kind does not use, are 0. */
#define ENDS_AT(end) (reception.content_used <= (end))

INLINE bool is_hello_valid(void)
{
    return (CONTENT[HELLO_SESSION] != 0u) && (CONTENT[HELLO_LOWEST] <= CONTENT[HELLO_HIGHEST]);
}

static bool is_configure_valid(void)
{
    uint8_t parameter = CONTENT[CONFIGURE_PARAMETER];
    uint16_t value = COMMAND_WORD(CONFIGURE_VALUE);

    if (parameter == PARAMETER_DEAD_MAN) {
        return (value == 0u) || ((value >= DEAD_MAN_MS_MIN) && (value <= DEAD_MAN_MS_MAX));
    }
#ifdef RSAPIEN_MOTION
    return (parameter <= JOINT_COUNT) && (value >= TRAVEL_MS_MIN) && (value <= TRAVEL_MS_MAX);
#else
    return false;
#endif
}

#ifdef RSAPIEN_MOTION
INLINE bool is_step_valid(void)
{
    return ((CONTENT[STEP_POSE + 1u] & (uint8_t)~STEP_POSE_HIGH_MASK) == 0u) &&
           ((CONTENT[STEP_DURATION] | CONTENT[STEP_DURATION + 1u]) != 0u) &&
           ((CONTENT[STEP_FLAGS] & (uint8_t)~STEP_FLAG_REPLACE) == 0u) &&
           ((CONTENT[STEP_BUMPERS] & (uint8_t)~STEP_BUMPERS_MASK) == 0u);
}
#else
static bool is_aim_valid(void)
{
    int16_t pan_centideg = (int16_t)COMMAND_WORD(AIM_PAN);
    int16_t tilt_centideg = (int16_t)COMMAND_WORD(AIM_TILT);

    return (pan_centideg >= -PAN_CENTIDEG_MAX) && (pan_centideg <= PAN_CENTIDEG_MAX) &&
           (tilt_centideg >= -TILT_CENTIDEG_MAX) && (tilt_centideg <= TILT_CENTIDEG_MAX);
}
#endif

/* Whether kind, controller and arguments are right: unknown kind, not this controller's, bad
 * argument, or to be executed. */
INLINE enum status analyse_request(void)
{
#ifdef RSAPIEN_MOTION
    /* Looked at first: motors wait for it. */
    if (CONTENT[ACTION_KIND] == (uint8_t)KIND_STEP) {
        return (ENDS_AT(STEP_END) && is_step_valid()) ? STATUS_TO_BE_EXECUTED
                                                      : STATUS_BAD_ARGUMENT;
    }
#endif
    switch (CONTENT[ACTION_KIND]) {
#ifdef RSAPIEN_MOTION
    case KIND_INIT:
#else
    case KIND_AIM:
        if (!ENDS_AT(AIM_END) || !is_aim_valid()) {
            return STATUS_BAD_ARGUMENT;
        }
        break;
    case KIND_HOME:
#endif
    case KIND_STATE:
    case KIND_STOP:
    case KIND_COUNTERS:
        if (!ENDS_AT(ACTION_ARGUMENTS)) {
            return STATUS_BAD_ARGUMENT;
        }
        break;
    case KIND_HELLO:
        if (!ENDS_AT(HELLO_END) || !is_hello_valid()) {
            return STATUS_BAD_ARGUMENT;
        }
        break;
    case KIND_CONFIGURE:
        if (!ENDS_AT(CONFIGURE_END) || !is_configure_valid()) {
            return STATUS_BAD_ARGUMENT;
        }
        break;
#ifdef RSAPIEN_MOTION
    case KIND_AIM:
    case KIND_HOME:
#else
    case KIND_INIT:
    case KIND_STEP:
#endif
        return STATUS_NOT_THIS_CONTROLLERS;
    default:
        return STATUS_UNKNOWN_KIND;
    }
    return STATUS_TO_BE_EXECUTED;
}

INLINE enum status open_session(void)
{
    if ((PROTOCOL_VERSION < CONTENT[HELLO_LOWEST]) || (PROTOCOL_VERSION > CONTENT[HELLO_HIGHEST])) {
        return STATUS_VERSION_NOT_SPOKEN;
    }
    if (CONTENT[HELLO_SESSION] != command.session) {
        command.session = CONTENT[HELLO_SESSION];
        command.last_sequence = 0;
        command.any_executed = false;
    }
    return STATUS_ACCEPTED;
}

INLINE enum status analyse_turn(void)
{
    uint8_t sequence = CONTENT[ACTION_SEQUENCE];

    if ((command.session == 0u) || (CONTENT[ACTION_SESSION] != command.session)) {
        return STATUS_NO_SESSION;
    }
    if (command.any_executed && (sequence == command.last_sequence)) {
        command.duplicates++;
        return STATUS_ACCEPTED;
    }
    if (sequence != (uint8_t)(command.last_sequence + 1u)) {
        return STATUS_OUT_OF_SEQUENCE;
    }
    return STATUS_TO_BE_EXECUTED;
}

enum status command_analyse(void)
{
    enum status status = analyse_request();

    if (status == STATUS_TO_BE_EXECUTED) {
        if (CONTENT[ACTION_KIND] == (uint8_t)KIND_HELLO) {
            status = open_session();
        } else if (CONTENT[ACTION_KIND] >= KIND_NUMBERED_FIRST) {
            status = analyse_turn();
        } else {
            /* STATE, STOP and COUNTERS have no turn. */
        }
    }
    return status;
}

void command_note_executed(void)
{
    if (CONTENT[ACTION_KIND] >= KIND_NUMBERED_FIRST) {
        command.last_sequence = CONTENT[ACTION_SEQUENCE];
        command.any_executed = true;
    }
}
