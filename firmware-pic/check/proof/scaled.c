/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * That joint.c scales a position exactly, shown for every pair of an old and a new travel time:
 * the position at the last end stop, and one in between that differs from pair to pair.
 */
#include <stdio.h>

#include "../../core/joint.c"

struct step step;

void port_motors(uint8_t towards_first, uint8_t towards_last)
{
    (void)towards_first;
    (void)towards_last;
}

static void scale(uint16_t position_ms, uint16_t old_ms, uint16_t new_ms, unsigned *wrong)
{
    struct joint_drive *drive = &joints.drive[JOINT_RIGHT_ARM];

    drive->full_travel_ms = old_ms;
    drive->position_ms = position_ms;
    joints_configure(JOINT_RIGHT_ARM, new_ms);
    if (drive->position_ms != (uint32_t)position_ms * new_ms / old_ms) {
        (*wrong)++;
        printf("scaled: %u of %u ms becomes %u of %u ms\n", position_ms, old_ms, drive->position_ms,
               new_ms);
    }
}

int main(void)
{
    unsigned wrong = 0;
    uint32_t varying = 1;

    for (unsigned old_ms = TRAVEL_MS_MIN; old_ms <= TRAVEL_MS_MAX; old_ms++) {
        for (unsigned new_ms = TRAVEL_MS_MIN; new_ms <= TRAVEL_MS_MAX && wrong < 10; new_ms++) {
            varying = varying * 1664525u + 1013904223u;
            scale((uint16_t)old_ms, (uint16_t)old_ms, (uint16_t)new_ms, &wrong);
            scale((uint16_t)((varying >> 8) % old_ms), (uint16_t)old_ms, (uint16_t)new_ms, &wrong);
        }
    }
    if (wrong != 0) {
        return 1;
    }
    printf("scaled positions: right for every pair of travel times\n");
    return 0;
}
