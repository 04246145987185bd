/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "communication.h"
#include "dead_man.h"
#include "line.h"
#include "port.h"
#include "reception.h"
#include "transmission.h"
#ifdef RSAPIEN_MOTION
#include "bumper.h"
#include "joint.h"
#include "motion.h"
#include "queue.h"
#else
#include "camera.h"
#endif

struct bench bench;

static bool locked;
static bool in_main_routine;
static unsigned next_gap;

/* What the controller has sent of an answer. */
static uint8_t answer[LINE_ANSWER_LENGTH];
static unsigned answer_length;

#define REQUIRE(condition) CHECK(condition)
#define INVARIANTS(part) check_##part
#define EACH(index, count) for ((index) = 0; (index) < (count); (index)++)
#include "../invariants.h"

void bench_fail(const char *what, const char *file, int line)
{
    fprintf(stderr, "%s:%d: not so: %s\n", file, line, what);
    abort();
}

void bench_check(void)
{
    check_controller();
}

/* The main routine stands where interrupts may come. */
static void gap(void)
{
    uint8_t what;

    if (!in_main_routine || locked || next_gap == BENCH_GAPS) {
        return;
    }
    what = bench.gaps[next_gap];
    next_gap++;
    if (what == 0) {
        return;
    }
    check_controller();
    switch (what & 7u) {
    case 1:
        bench_timer_interrupt();
        break;
    case 2:
        bench_input_change_interrupt();
        break;
    case 3:
        bench_transmit(1u + (what >> 3));
        break;
    case 4:
        bench_receive(what);
        break;
    case 5:
        controller_receive_error((what & 8u) != 0 ? LINE_ERROR_OVERRUN : LINE_ERROR_FRAMING);
        break;
    default:
        break;
    }
    check_controller();
}

void port_lock(void)
{
    CHECK(!locked);
    gap();
    locked = true;
}

void port_unlock(void)
{
    CHECK(locked);
    locked = false;
    gap();
}

void port_transmit_begin(void)
{
    CHECK(transmission.next == 0);
    gap();
}

void port_watchdog_clear(void)
{
    CHECK(!locked);
    gap();
}

#ifdef RSAPIEN_MOTION
void port_motors(uint8_t towards_first, uint8_t towards_last)
{
    CHECK((towards_first & towards_last) == 0);
    CHECK((towards_first | towards_last) < 1u << JOINT_COUNT);
    /* Never on in one sense where it was on in the other in this tick or the one before. */
    CHECK((towards_first & joints.motors.driven_last) == 0);
    CHECK((towards_last & joints.motors.driven_first) == 0);
    CHECK(!in_main_routine || locked);
}

uint8_t port_bumpers(void)
{
    return bench.bumpers;
}

bool port_supply_is_low(void)
{
    return bench.supply_low;
}
#endif

void bench_power_on(void)
{
    memset(&bench, 0, sizeof bench);
    memset(&command, 0, sizeof command);
    memset(&communication, 0, sizeof communication);
    memset(&dead_man, 0, sizeof dead_man);
    memset(&reception, 0, sizeof reception);
    memset(&reception_ring, 0, sizeof reception_ring);
    memset(&transmission, 0, sizeof transmission);
#ifdef RSAPIEN_MOTION
    memset(&bumpers, 0, sizeof bumpers);
    memset(&joints, 0, sizeof joints);
    memset(&motion, 0, sizeof motion);
    memset(&queue, 0, sizeof queue);
    memset(&step, 0, sizeof step);
#else
    memset(&camera, 0, sizeof camera);
#endif
    bench_reset(STOP_CAUSE_POWER_ON, 0);
}

void bench_reset(enum stop_cause cause, uint8_t eeprom_boot)
{
    locked = false;
    in_main_routine = false;
    answer_length = 0;
    controller_reset(cause, eeprom_boot);
    CHECK(controller_boot() == (uint8_t)(eeprom_boot + 1u));
    CHECK(controller_mode() == MODE_FRESH);
    check_controller();
}

void bench_timer_interrupt(void)
{
    const bool in_main = in_main_routine;

    in_main_routine = false;
    controller_timer_interrupt();
    in_main_routine = in_main;
}

void bench_input_change_interrupt(void)
{
#ifdef RSAPIEN_MOTION
    const bool in_main = in_main_routine;

    in_main_routine = false;
    controller_input_change_interrupt(bench.switches);
    in_main_routine = in_main;
#endif
}

void bench_receive(uint8_t byte)
{
    reception_ring.arrived = byte;
    controller_receive_interrupt();
}

void bench_main_routine(void)
{
    in_main_routine = true;
    next_gap = 0;
    controller_main_routine();
    in_main_routine = false;
    memset(bench.gaps, 0, sizeof bench.gaps);
    CHECK(!locked);
}

void bench_tick(void)
{
    bench_timer_interrupt();
    bench_input_change_interrupt();
    bench_main_routine();
    check_controller();
}

static void check_answer(void)
{
    uint8_t content[LINE_ANSWER_CONTENT];
    const char *wrong = line_decode(CONTROLLER_ADDRESS, answer, content);
    const uint8_t *report = &content[4];

    if (wrong != NULL) {
        bench_fail(wrong, __FILE__, __LINE__);
    }
    CHECK(content[3] <= STATUS_NOT_INITIALISED);
    if (content[2] == KIND_COUNTERS) {
        return;
    }
    CHECK(report[REPORT_CAUSE] <= STOP_CAUSE_WATCHDOG);
    if (content[2] == KIND_HELLO) {
        CHECK(report[REPORT_HELLO_CLOCK] == RSAPIEN_CLOCK_MHZ);
        return;
    }
    CHECK(report[REPORT_MODE] <= MODE_HELD);
#ifdef RSAPIEN_MOTION
    CHECK(report[REPORT_QUEUE_FREE] <= QUEUE_LENGTH);
    CHECK(report[REPORT_MODE] <= MODE_EXECUTING || (report[REPORT_MOTORS] & 0x7Fu) == 0);
    for (unsigned joint = 0; joint < JOINT_COUNT; joint++) {
        const unsigned place = 3u << (2 * (joint % 4));

        /* What runs has not arrived. */
        CHECK((report[REPORT_MOTORS] & (1u << joint)) == 0 ||
              (report[REPORT_POSE_REACHED + joint / 4] & place) == 0);
    }
    CHECK(report[REPORT_POSE_REACHED + 1] <= STEP_POSE_HIGH_MASK);
#else
    CHECK(report[REPORT_AXES] <= 0x0F && report[REPORT_AXES + 1] == 0);
#endif
}

void bench_transmit(unsigned count)
{
    while (count > 0 && controller_transmit_interrupt()) {
        CHECK(answer_length < LINE_ANSWER_LENGTH);
        answer[answer_length] = transmission.byte;
        answer_length++;
        if (answer_length == LINE_ANSWER_LENGTH) {
            check_answer();
            answer_length = 0;
        }
        count--;
    }
}
