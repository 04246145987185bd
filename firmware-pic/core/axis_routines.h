/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The routine that positions one axis of the camera (paper, section 2: one routine for each
 * axis): every tick the commanded position goes on towards the target by what the speed allows.
 *
 *              sent elsewhere
 *   ARRIVED ───────────────────► MOVING ──┐ tick: tenths += step_tenths; step = step_centideg,
 *      ▲                           ▲      │       one more when tenths >= 10 (less 10)
 *      │ distance <= step          └──────┤
 *      └──────────────────────────────────┘
 *
 * One degree per second is a tenth of 0.01 degree a tick, so whole steps and tenths make any
 * speed exact without a division in the interrupt.
 *
 * camera.c includes this file once for each axis, which is AXIS, a member of `camera`: as joint.c
 * does with joint_routines.h, and for the same reason.
 */

#define DRIVE camera.AXIS
#define JOIN(name, axis) name##_##axis
#define NAME_FOR(name, axis) JOIN(name, axis)
#define NAME(name) NAME_FOR(name, AXIS)

static bool NAME(is_moving)(void)
{
    return DRIVE.position_centideg != DRIVE.target_centideg;
}

/* Sends the axis to its angle of `camera.aim`. */
static void NAME(send)(void)
{
    DRIVE.target_centideg = camera.aim.AXIS_TARGET;
    DRIVE.tenths = 0;
}

static void NAME(stop)(void)
{
    DRIVE.target_centideg = DRIVE.position_centideg;
}

/* Timer routine, for an axis that is moving: 1 ms has passed. */
static void NAME(advance)(void)
{
    uint8_t step_centideg = camera.step_centideg;
    uint16_t distance_centideg;
    bool is_upwards = DRIVE.target_centideg > DRIVE.position_centideg;

    DRIVE.tenths += camera.step_tenths;
    if (DRIVE.tenths >= 10u) {
        DRIVE.tenths = (uint8_t)(DRIVE.tenths - 10u);
        step_centideg++;
    }
    if (is_upwards) {
        distance_centideg = (uint16_t)(DRIVE.target_centideg - DRIVE.position_centideg);
    } else {
        distance_centideg = (uint16_t)(DRIVE.position_centideg - DRIVE.target_centideg);
    }
    if (distance_centideg <= step_centideg) {
        DRIVE.position_centideg = DRIVE.target_centideg;
    } else if (is_upwards) {
        DRIVE.position_centideg = (int16_t)(DRIVE.position_centideg + (int16_t)step_centideg);
    } else {
        DRIVE.position_centideg = (int16_t)(DRIVE.position_centideg - (int16_t)step_centideg);
    }
}

#undef DRIVE
#undef JOIN
#undef NAME_FOR
#undef NAME
#undef AXIS
#undef AXIS_TARGET
