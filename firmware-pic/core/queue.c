/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "queue.h"

#define QUEUE_MASK (QUEUE_LENGTH - 1u)

#if (QUEUE_LENGTH & QUEUE_MASK) != 0u || QUEUE_LENGTH > 128u
#error "the queue's length is a power of two, at most 128"
#endif

struct queue queue;
struct step step;

void queue_clear(void)
{
    queue.count = 0;
}

uint8_t queue_free(void)
{
    return (uint8_t)(QUEUE_LENGTH - queue.count);
}

bool queue_append(void)
{
    uint8_t place = (uint8_t)((uint8_t)(queue.first + queue.count) & QUEUE_MASK);

    if (queue.count == QUEUE_LENGTH) {
        return false;
    }
    queue.pose_low[place] = step.pose_low;
    queue.pose_high[place] = step.pose_high;
    queue.duration_low_ms[place] = step.duration_low_ms;
    queue.duration_high_ms[place] = step.duration_high_ms;
    queue.ending_bumpers[place] = step.ending_bumpers;
    queue.count++;
    return true;
}

bool queue_take(void)
{
    uint8_t place = (uint8_t)(queue.first & QUEUE_MASK);

    if (queue.count == 0u) {
        return false;
    }
    step.pose_low = queue.pose_low[place];
    step.pose_high = queue.pose_high[place];
    step.duration_low_ms = queue.duration_low_ms[place];
    step.duration_high_ms = queue.duration_high_ms[place];
    step.ending_bumpers = queue.ending_bumpers[place];
    queue.first = (uint8_t)(place + 1u);
    queue.count--;
    return true;
}
