/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "camera.h"

#include "command.h"
#include "communication.h"
#include "controller.h"
#include "dead_man.h"
#include "port.h"
#include "reception.h"
#include "transmission.h"

#define AXES_PAN_MOVING 0x01u
#define AXES_TILT_MOVING 0x02u
#define AXES_PAN_AT_LIMIT 0x04u
#define AXES_TILT_AT_LIMIT 0x08u

struct camera camera;

#define AXIS pan
#define AXIS_TARGET pan_centideg
#include "axis_routines.h"

#define AXIS tilt
#define AXIS_TARGET tilt_centideg
#include "axis_routines.h"

void controller_reset(enum stop_cause cause, uint8_t eeprom_boot)
{
    communication_reset(cause, eeprom_boot);
    camera.mode = MODE_FRESH;
    camera.homed = false;
    camera.driven = false;
    camera.aim_waits = false;
    camera.pan.position_centideg = 0;
    camera.pan.target_centideg = 0;
    camera.tilt.position_centideg = 0;
    camera.tilt.target_centideg = 0;
    camera.settle_ms = 0;
}

enum mode controller_mode(void)
{
    return camera.mode;
}

/* Sends both axes to `camera.aim`. */
static void send_axes(void)
{
    camera.step_centideg = camera.aim.step_centideg;
    camera.step_tenths = camera.aim.step_tenths;
    send_pan();
    send_tilt();
}

static void stop_axes(enum mode mode)
{
    stop_pan();
    stop_tilt();
    camera.settle_ms = 0;
    camera.aim_waits = false;
    camera.driven = camera.homed;
    camera.mode = mode;
}

/* HOME has ended, or both axes have arrived. */
static void arrived(void)
{
    camera.homed = true;
    if (camera.aim_waits) {
        camera.aim_waits = false;
        camera.mode = MODE_EXECUTING;
        send_axes();
    } else {
        camera.mode = MODE_IDLE;
    }
}

/* The routine that monitors the global position of the camera (paper, section 2). */
static void monitor_global_position(void)
{
    bool moving = (camera.mode == MODE_INITIALISING) || (camera.mode == MODE_EXECUTING);

    if (camera.settle_ms != 0u) {
        camera.settle_ms--;
    }
    if (dead_man_is_due() && moving) {
        dead_man.trips++;
        communication.cause = STOP_CAUSE_DEAD_MAN;
        stop_axes(MODE_HELD);
    } else if (moving && (camera.settle_ms == 0u) && !is_moving_pan() && !is_moving_tilt()) {
        arrived();
    } else {
        /* On the way, or nothing to do. */
    }
}

void controller_timer_interrupt(void)
{
    communication_tick();
    if (is_moving_pan()) {
        advance_pan();
    }
    if (is_moving_tilt()) {
        advance_tilt();
    }
    monitor_global_position();
}

static void home(void)
{
    camera.mode = MODE_INITIALISING;
    camera.driven = true;
    camera.aim_waits = false;
    if (!camera.homed) {
        camera.settle_ms = HOME_SETTLE_MS;
    }
    camera.aim.pan_centideg = 0;
    camera.aim.tilt_centideg = 0;
    camera.aim.step_centideg = AXIS_SPEED_MAX_DEG_PER_S / 10u;
    camera.aim.step_tenths = AXIS_SPEED_MAX_DEG_PER_S % 10u;
    send_axes();
}

/* Reads the AIM in `reception.content`. */
static void read_aim(void)
{
    uint16_t speed_deg_per_s = COMMAND_WORD(AIM_SPEED);
    uint8_t speed = AXIS_SPEED_MAX_DEG_PER_S;
    uint8_t step_centideg = 0;

    if ((speed_deg_per_s != 0u) && (speed_deg_per_s < AXIS_SPEED_MAX_DEG_PER_S)) {
        speed = (uint8_t)speed_deg_per_s;
    }
    while (speed >= 10u) {
        speed = (uint8_t)(speed - 10u);
        step_centideg++;
    }
    camera.aim.pan_centideg = (int16_t)COMMAND_WORD(AIM_PAN);
    camera.aim.tilt_centideg = (int16_t)COMMAND_WORD(AIM_TILT);
    camera.aim.step_centideg = step_centideg;
    camera.aim.step_tenths = speed;
}

static enum status accept_aim(void)
{
    if (!camera.homed && (camera.mode != MODE_INITIALISING)) {
        return STATUS_NOT_INITIALISED;
    }
    if (camera.mode == MODE_HELD) {
        return STATUS_HELD;
    }
    read_aim();
    if (camera.mode == MODE_INITIALISING) {
        camera.aim_waits = true;
    } else {
        camera.mode = MODE_EXECUTING;
        send_axes();
    }
    return STATUS_ACCEPTED;
}

enum status controller_execute(void)
{
    enum status status = STATUS_ACCEPTED;

    port_lock();
    switch (reception.content[ACTION_KIND]) {
    case KIND_STOP:
        stop_axes(MODE_STOPPED);
        break;
    case KIND_HOME:
        home();
        break;
    case KIND_AIM:
        status = accept_aim();
        break;
    case KIND_CONFIGURE:
        /* The camera controller has one parameter. */
        dead_man.timeout_ms = COMMAND_WORD(CONFIGURE_VALUE);
        break;
    default:
        /* STATE and COUNTERS ask for nothing but their answer. */
        break;
    }
    port_unlock();
    return status;
}

static uint8_t axis_flags(void)
{
    uint8_t flags = 0;

    if ((camera.settle_ms != 0u) || is_moving_pan()) {
        flags |= AXES_PAN_MOVING;
    }
    if ((camera.settle_ms != 0u) || is_moving_tilt()) {
        flags |= AXES_TILT_MOVING;
    }
    if ((camera.pan.position_centideg >= PAN_CENTIDEG_MAX) ||
        (camera.pan.position_centideg <= -PAN_CENTIDEG_MAX)) {
        flags |= AXES_PAN_AT_LIMIT;
    }
    if ((camera.tilt.position_centideg >= TILT_CENTIDEG_MAX) ||
        (camera.tilt.position_centideg <= -TILT_CENTIDEG_MAX)) {
        flags |= AXES_TILT_AT_LIMIT;
    }
    return flags;
}

void controller_report(void)
{
    port_lock();
    transmission.report[REPORT_MODE] = (uint8_t)camera.mode;
    REPORT_PUT_WORD(REPORT_PAN, (uint16_t)camera.pan.position_centideg);
    REPORT_PUT_WORD(REPORT_TILT, (uint16_t)camera.tilt.position_centideg);
    REPORT_PUT_WORD(REPORT_PAN_TARGET, (uint16_t)camera.pan.target_centideg);
    REPORT_PUT_WORD(REPORT_TILT_TARGET, (uint16_t)camera.tilt.target_centideg);
    transmission.report[REPORT_AXES] = axis_flags();
    transmission.report[REPORT_CAUSE] = (uint8_t)communication.cause;
    port_unlock();
    transmission.report[REPORT_AXES + 1u] = 0;
    transmission.report[REPORT_BOOT] = communication.boot;
    transmission.report[REPORT_ERRORS] = reception.errors;
}

void controller_main_routine(void)
{
    communication_pass();
}
