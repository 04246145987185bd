/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "motion.h"

#include "bumper.h"
#include "command.h"
#include "communication.h"
#include "controller.h"
#include "dead_man.h"
#include "inline.h"
#include "joint.h"
#include "port.h"
#include "queue.h"
#include "reception.h"
#include "transmission.h"

#define MOTORS_SUPPLY_LOW 0x80u
#define INPUTS_SWITCHES_SHIFT 6u

struct motion motion;

void controller_reset(enum stop_cause cause, uint8_t eeprom_boot)
{
    joints_reset();
    joints_drive_pins();
    communication_reset(cause, eeprom_boot);
    queue_clear();
    queue.first = 0;
    bumpers_reset();
    motion.mode = MODE_FRESH;
    motion.initialised = false;
    motion.step_remaining_ms = 0;
    motion.step_ending_bumpers = 0;
    motion.steps_ended = 0;
}

enum mode controller_mode(void)
{
    return motion.mode;
}

static void all_off(enum mode mode)
{
    joints_stop();
    queue_clear();
    motion.mode = mode;
}

static void hold(enum stop_cause cause)
{
    communication.cause = cause;
    all_off(MODE_HELD);
}

/* Starts `step`, unless a bumper that ends it is pressed. */
static void start_step(void)
{
    if ((bumpers.pressed & step.ending_bumpers) != 0u) {
        hold(STOP_CAUSE_BUMPER);
        return;
    }
    motion.mode = MODE_EXECUTING;
    motion.step_remaining_ms = step.duration_low_ms;
    motion.step_remaining_ms |= (uint16_t)((uint16_t)step.duration_high_ms << 8);
    motion.step_ending_bumpers = step.ending_bumpers;
    joints_send();
}

/* Starts the next step, or is idle when none waits. */
static void start_next_step(void)
{
    if (queue_take()) {
        start_step();
    } else {
        motion.mode = MODE_IDLE;
    }
}

static bool is_moving(void)
{
    return (motion.mode == MODE_INITIALISING) || (motion.mode == MODE_EXECUTING) ||
           (joints_moving() != 0u);
}

void controller_timer_interrupt(void)
{
    communication_tick();
    bumpers.due = true;
    joints_advance();
    if (dead_man_is_due() && is_moving()) {
        dead_man.trips++;
        hold(STOP_CAUSE_DEAD_MAN);
    }
    if (motion.mode == MODE_EXECUTING) {
        motion.step_remaining_ms--;
        if (motion.step_remaining_ms == 0u) {
            motion.steps_ended++;
            start_next_step();
        }
    } else if ((motion.mode == MODE_INITIALISING) && (joints_moving() == 0u)) {
        motion.initialised = true;
        start_next_step();
    } else {
        /* Nothing that time brings to an end. */
    }
    joints_drive_changed_pins();
}

void controller_input_change_interrupt(uint8_t switches_closed)
{
    if (switches_closed != joints.switches_closed) {
        joints_switches_changed(switches_closed);
        joints_drive_pins();
    }
}

static void initialise(void)
{
    queue_clear();
    motion.initialised = false;
    motion.steps_ended = 0;
    motion.mode = MODE_INITIALISING;
    joints_home();
}

INLINE enum status accept_step(void)
{
    uint8_t replaces = (uint8_t)(reception.content[STEP_FLAGS] & STEP_FLAG_REPLACE);

    if (!motion.initialised && (motion.mode != MODE_INITIALISING)) {
        return STATUS_NOT_INITIALISED;
    }
    if (motion.mode == MODE_HELD) {
        return STATUS_HELD;
    }
    if (replaces != 0u) {
        queue_clear();
    }
    step.pose_low = reception.content[STEP_POSE];
    step.pose_high = reception.content[STEP_POSE + 1u];
    step.duration_low_ms = reception.content[STEP_DURATION];
    step.duration_high_ms = reception.content[STEP_DURATION + 1u];
    step.ending_bumpers = reception.content[STEP_BUMPERS];
    if ((motion.mode == MODE_INITIALISING) || ((motion.mode == MODE_EXECUTING) && (replaces == 0u))) {
        return queue_append() ? STATUS_ACCEPTED : STATUS_QUEUE_FULL;
    }
    /* No step waits in any other mode, so this one is the next. */
    start_step();
    return STATUS_ACCEPTED;
}

static void configure(void)
{
    uint8_t parameter = reception.content[CONFIGURE_PARAMETER];
    uint16_t value = COMMAND_WORD(CONFIGURE_VALUE);

    if (parameter == 0u) {
        dead_man.timeout_ms = value;
    } else {
        joints_configure((uint8_t)(parameter - 1u), value);
    }
}

enum status controller_execute(void)
{
    enum status status = STATUS_ACCEPTED;

    port_lock();
    /* STEP is looked at first: motors wait for it. */
    if (reception.content[ACTION_KIND] == (uint8_t)KIND_STEP) {
        status = accept_step();
    } else if (reception.content[ACTION_KIND] == (uint8_t)KIND_STOP) {
        all_off(MODE_STOPPED);
    } else if (reception.content[ACTION_KIND] == (uint8_t)KIND_INIT) {
        initialise();
    } else if (reception.content[ACTION_KIND] == (uint8_t)KIND_CONFIGURE) {
        configure();
    } else {
        /* STATE and COUNTERS ask for nothing but their answer. */
    }
    joints_drive_pins();
    port_unlock();
    return status;
}

/* Presses of two bumpers, four bits each. */
#define PRESSES_OF(first)                                                                          \
    ((uint8_t)(bumpers.presses[(first)] | (uint8_t)(bumpers.presses[(first) + 1u] << 4)))

void controller_report(void)
{
    port_lock();
    transmission.report[REPORT_MODE] = (uint8_t)motion.mode;
    transmission.report[REPORT_INPUTS] =
        (uint8_t)(bumpers.pressed | (uint8_t)(joints.switches_closed << INPUTS_SWITCHES_SHIFT));
    transmission.report[REPORT_MOTORS] = joints_moving();
    transmission.report[REPORT_POSE_REACHED] = joints_pose_reached_low();
    transmission.report[REPORT_POSE_REACHED + 1u] = joints_pose_reached_high();
    transmission.report[REPORT_QUEUE_FREE] = queue_free();
    REPORT_PUT_WORD(REPORT_STEPS_ENDED, motion.steps_ended);
    transmission.report[REPORT_CAUSE] = (uint8_t)communication.cause;
    port_unlock();
    if (port_supply_is_low()) {
        transmission.report[REPORT_MOTORS] |= MOTORS_SUPPLY_LOW;
    }
    transmission.report[REPORT_PRESSES] = PRESSES_OF(0u);
    transmission.report[REPORT_PRESSES + 1u] = PRESSES_OF(2u);
    transmission.report[REPORT_PRESSES + 2u] = PRESSES_OF(4u);
    transmission.report[REPORT_BOOT] = communication.boot;
    transmission.report[REPORT_ERRORS] = reception.errors;
}

static void test_bumpers(void)
{
    uint8_t pins = port_bumpers();

    /* Nearly always there is nothing to test: no change, and none that was about to be believed. */
    if (((pins ^ bumpers.pressed) | bumpers.unsettled) != 0u) {
        bumpers_test(pins);
    }
    if (bumpers.pressed != 0u) {
        port_lock();
        if ((motion.mode == MODE_EXECUTING) &&
            ((bumpers.pressed & motion.step_ending_bumpers) != 0u)) {
            hold(STOP_CAUSE_BUMPER);
            joints_drive_pins();
        }
        port_unlock();
    }
}

void controller_main_routine(void)
{
    communication_pass();
    if (bumpers.due) {
        bumpers.due = false;
        test_bumpers();
    }
}
