/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "bumper.h"

struct bumpers bumpers;

void bumpers_reset(void)
{
    uint8_t index;

    bumpers.due = false;
    bumpers.pressed = 0;
    bumpers.unsettled = 0;
    for (index = 0; index < BUMPER_COUNT; index++) {
        bumpers.differing[index] = 0;
        bumpers.presses[index] = 0;
    }
}

static void believe(uint8_t index, uint8_t bit)
{
    bumpers.differing[index] = 0;
    bumpers.pressed ^= bit;
    if ((bumpers.pressed & bit) != 0u) {
        bumpers.presses[index] = (uint8_t)((uint8_t)(bumpers.presses[index] + 1u) & 0x0Fu);
    }
}

void bumpers_test(uint8_t pins)
{
    uint8_t changed = (uint8_t)(pins ^ bumpers.pressed);
    uint8_t bit = 0x01u;
    uint8_t index;

    bumpers.unsettled = changed;
    for (index = 0; index < BUMPER_COUNT; index++) {
        if ((changed & bit) == 0u) {
            bumpers.differing[index] = 0;
        } else {
            bumpers.differing[index]++;
            if (bumpers.differing[index] == BUMPER_DEBOUNCE_TESTS) {
                believe(index, bit);
            }
        }
        bit = (uint8_t)(bit << 1);
    }
}
