/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The proof by induction, for a bounded model checker (ESBMC): each theorem is a function that
 * starts from any state whatever that the invariants allow, lets one event happen and asserts the
 * invariants behind it. With the reset as the first case they hold for ever. The model checker
 * adds that no index leaves its array and that no signed number overflows.
 *
 * Where the main routine gives interrupts room (outside port_lock ... port_unlock) any number of
 * them may come: `interrupts()` puts everything that they write to anything that the invariants
 * allow.
 */
#include <assert.h>

#include "../../core/command.c"
#include "../../core/communication.c"
#include "../../core/crc.c"
#include "../../core/dead_man.c"
#include "../../core/reception.c"
#include "../../core/transmission.c"
#ifdef RSAPIEN_MOTION
#include "../../core/bumper.c"
#include "../../core/joint.c"
#include "../../core/queue.c"
/* Scaling a position is long division, which is too hard for a solver: scaled.c shows for every
 * pair of travel times that it stays between the end stops, and here only that is known of it. */
static void configured(uint8_t joint, uint16_t full_travel_ms);
#define joints_configure configured
#include "../../core/motion.c"
#undef joints_configure
#else
#include "../../core/camera.c"
#endif

void __ESBMC_assume(_Bool condition);

/* Anything at all. */
uint8_t nondet_uint8(void);
uint16_t nondet_uint16(void);
_Bool nondet_bool(void);
unsigned nondet_unsigned(void);
struct crc nondet_crc(void);
struct command nondet_command(void);
struct communication nondet_communication(void);
struct dead_man nondet_dead_man(void);
struct reception nondet_reception(void);
struct reception_ring nondet_reception_ring(void);
struct transmission nondet_transmission(void);
#ifdef RSAPIEN_MOTION
struct bumpers nondet_bumpers(void);
struct joints nondet_joints(void);
struct motion nondet_motion(void);
struct queue nondet_queue(void);
struct step nondet_step(void);
#else
struct camera nondet_camera(void);
#endif

#define REQUIRE(condition) __ESBMC_assume(condition)
#define INVARIANTS(part) assume_##part
#define EACH(index, count) for ((index) = 0; (index) < (count); (index)++)
#include "../invariants.h"

#define REQUIRE(condition) assert(condition)
#define INVARIANTS(part) assert_##part
#define EACH(index, count)                                                                         \
    (index) = nondet_uint8();                                                                      \
    __ESBMC_assume((index) < (count));
#include "../invariants.h"

static bool locked;
/* The theorem is about the main routine: interrupts may come where they are not locked out. */
static bool interruptible;

/* Everything that the timer and input change interrupts write becomes anything. */
static void anything_of_low_interrupts(void)
{
    dead_man.silence_ms = nondet_uint16();
    dead_man.heard = nondet_bool();
    dead_man.trips = nondet_uint16();
    reception.silence_ms = nondet_uint8();
    communication.cause = nondet_unsigned();
#ifdef RSAPIEN_MOTION
    const struct joints joints_before = joints;
    const uint8_t taken = nondet_uint8();
    uint8_t joint;

    bumpers.due = nondet_bool();
    step = nondet_step();
    motion = nondet_motion();
    /* They take steps out, or all of them. */
    __ESBMC_assume(taken <= queue.count);
    queue.first = (uint8_t)((queue.first + taken) % QUEUE_LENGTH);
    queue.count = nondet_bool() ? (uint8_t)(queue.count - taken) : 0;
    joints = nondet_joints();
    for (joint = 0; joint < JOINT_COUNT; joint++) {
        joints.drive[joint].full_travel_ms = joints_before.drive[joint].full_travel_ms;
    }
#else
    struct aim aim = camera.aim;

    camera = nondet_camera();
    camera.aim = aim;
#endif
}

static void assume_of_low_interrupts(void)
{
    assume_transmission();
#ifdef RSAPIEN_MOTION
    assume_joints();
    assume_motion();
#else
    assume_camera();
#endif
}

static void interrupts(void)
{
    if (interruptible && !locked) {
        assert_controller();
        anything_of_low_interrupts();
        assume_of_low_interrupts();
    }
}

void port_lock(void)
{
    assert(!locked);
    interrupts();
    locked = true;
}

void port_unlock(void)
{
    assert(locked);
    locked = false;
    interrupts();
}

void port_transmit_begin(void)
{
    assert(transmission.next == 0);
}

void port_watchdog_clear(void)
{
    interrupts();
}

#ifdef RSAPIEN_MOTION
void port_motors(uint8_t towards_first, uint8_t towards_last)
{
    assert((towards_first & towards_last) == 0);
    assert(towards_first < 1u << JOINT_COUNT && towards_last < 1u << JOINT_COUNT);
    /* Never on in one sense where it was on in the other in this tick or the one before. */
    assert((towards_first & joints.motors.driven_last) == 0);
    assert((towards_last & joints.motors.driven_first) == 0);
}

uint8_t port_bumpers(void)
{
    return (uint8_t)(nondet_uint8() & ((1u << BUMPER_COUNT) - 1u));
}

bool port_supply_is_low(void)
{
    return nondet_bool();
}
#endif

static void anything_allowed(void)
{
    crc = nondet_crc();
    command = nondet_command();
    communication = nondet_communication();
    dead_man = nondet_dead_man();
    reception = nondet_reception();
    reception_ring = nondet_reception_ring();
    transmission = nondet_transmission();
#ifdef RSAPIEN_MOTION
    bumpers = nondet_bumpers();
    joints = nondet_joints();
    motion = nondet_motion();
    queue = nondet_queue();
    step = nondet_step();
#else
    camera = nondet_camera();
#endif
    assume_controller();
}

/* The invariants hold behind a reset, whatever was before. */
void theorem_reset(void)
{
    enum stop_cause cause = STOP_CAUSE_POWER_ON + nondet_uint8() % 3u;
    bool warm = nondet_bool();

    if (warm) {
        anything_allowed();
    }
    controller_reset(cause, nondet_uint8());
    assert_controller();
    assert(reception.state == RECEPTION_HUNTING);
    assert(controller_mode() == MODE_FRESH);
    assert(command.session == 0);
}

void theorem_receive_interrupt(void)
{
    uint8_t before;
    uint8_t byte = nondet_uint8();
    bool overflowed;

    anything_allowed();
    before = (uint8_t)(reception_ring.put - reception_ring.taken);
    overflowed = reception_ring.overflowed;
    if (nondet_bool()) {
        reception_ring.arrived = byte;
        controller_receive_interrupt();
    } else {
        controller_receive_error(nondet_bool() ? LINE_ERROR_FRAMING : LINE_ERROR_OVERRUN);
    }
    assert_controller();
    /* One place more is taken, or the loss is known. */
    if (before == RECEIVE_RING_LENGTH || overflowed) {
        assert(reception_ring.overflowed);
        assert((uint8_t)(reception_ring.put - reception_ring.taken) == before);
    } else {
        assert(!reception_ring.overflowed);
        assert((uint8_t)(reception_ring.put - reception_ring.taken) == before + 1u);
    }
}

void theorem_transmit_interrupt(void)
{
    uint8_t before;

    anything_allowed();
    before = transmission.next;
    if (controller_transmit_interrupt()) {
        assert(before < SYNCHRONIZATION_PACKAGE_LENGTH);
        assert(transmission.byte == transmission.bytes[before]);
        assert(transmission.next == before + 1u);
    } else {
        assert(transmission.next == before);
    }
    assert_controller();
}

void theorem_timer_interrupt(void)
{
    anything_allowed();
    controller_timer_interrupt();
    assert_controller();
}

#ifdef RSAPIEN_MOTION
void theorem_input_change_interrupt(void)
{
    anything_allowed();
    controller_input_change_interrupt(nondet_uint8() & (SWITCH_LEFT | SWITCH_RIGHT));
    assert_controller();
}
#endif

/* What the state machine of reception does, as a table: the state behind a byte of a class. */
enum byte_class { CLASS_DATA, CLASS_SYNCHRONIZATION, CLASS_HEADER_FOR_ME, CLASS_OTHER_HEADER };

static enum byte_class class_of(uint8_t byte)
{
    const uint8_t header_for_me = 0xC0u | CONTROLLER_ADDRESS << 3 | 1u;

    if (byte < 0x80u) {
        return CLASS_DATA;
    }
    if (byte < 0xC0u) {
        return CLASS_SYNCHRONIZATION;
    }
    return byte == header_for_me ? CLASS_HEADER_FOR_ME : CLASS_OTHER_HEADER;
}

#define HUNTING RECEPTION_HUNTING
#define SYNCHRONIZATION RECEPTION_SYNCHRONIZATION
#define DATA RECEPTION_DATA
#define CHECK RECEPTION_CHECK

struct transition {
    enum reception_state next;
    bool is_reset; /* counted as a reset of reception */
};

static const struct transition table[4][4] = {
    /* in HUNTING: data, synchronization byte, header for me, another header */
    {{HUNTING, false}, {HUNTING, false}, {SYNCHRONIZATION, false}, {HUNTING, false}},
    /* in SYNCHRONIZATION */
    {{HUNTING, true}, {DATA, false}, {SYNCHRONIZATION, true}, {HUNTING, true}},
    /* in DATA */
    {{DATA, false}, {HUNTING, true}, {SYNCHRONIZATION, true}, {HUNTING, true}},
    /* in CHECK */
    {{CHECK, false}, {HUNTING, true}, {SYNCHRONIZATION, true}, {HUNTING, true}},
};

/* As the table says, but for the last byte of a group, of the content, and of the check. */
static struct transition expected(enum reception_state state, uint8_t byte)
{
    struct transition transition = table[state][class_of(byte)];

    if (class_of(byte) == CLASS_DATA && state == DATA && reception.group_index == 5) {
        transition.next = reception.content_index == 11 ? CHECK : SYNCHRONIZATION;
    }
    if (class_of(byte) == CLASS_DATA && state == CHECK && reception.group_index == 2) {
        transition.next = HUNTING;
        transition.is_reset = byte > 3;
    }
    return transition;
}

/* For every state, every silence and every entry of the ring the next state is the table's and no
 * other, and everything is counted once. What is proven of one entry is proven of as many as
 * wait, since each leaves a state that the invariants allow. */
void theorem_reception(void)
{
    struct reception before;
    enum reception_state state;
    uint16_t resets = 0;
    uint16_t framing_errors = 0;
    uint16_t overruns = 0;
    uint16_t errors;
    bool ends = false;
    bool complete;
    bool overflowed;

    anything_allowed();
    __ESBMC_assume((uint8_t)(reception_ring.put - reception_ring.taken) <= 1);
    before = reception;
    state = reception.state;
    overflowed = reception_ring.overflowed;
    if (reception.silence_ms > 20 && state != HUNTING) {
        state = HUNTING;
        resets++;
    }
    errors = resets;
    if (reception_ring.put != reception_ring.taken) {
        const uint8_t place = reception_ring.taken % RECEIVE_RING_LENGTH;
        const uint8_t byte = reception_ring.bytes[place];

        if (reception_ring.sorts[place] == 0) {
            const struct transition transition = expected(state, byte);

            ends = state == CHECK && reception.group_index == 2 && byte <= 3;
            state = transition.next;
            resets += transition.is_reset;
            errors += transition.is_reset;
        } else {
            framing_errors += reception_ring.sorts[place] == 1;
            overruns += reception_ring.sorts[place] == 2;
            resets += state != HUNTING;
            errors++;
            state = HUNTING;
        }
    }

    complete = reception_next_package();

    assert_controller();
    assert(!complete || ends);
    if (overflowed && !complete) {
        overruns++;
        resets += state != HUNTING;
        errors++;
        state = HUNTING;
    }
    errors += ends && !complete;
    assert(reception_ring.put == reception_ring.taken);
    assert(reception_ring.overflowed == (overflowed && complete));
    assert(reception.state == state);
    assert(reception.resets == (uint16_t)(before.resets + resets));
    assert(reception.framing_errors == (uint16_t)(before.framing_errors + framing_errors));
    assert(reception.overruns == (uint16_t)(before.overruns + overruns));
    assert(reception.crc_errors == (uint16_t)(before.crc_errors + (ends && !complete)));
    assert(reception.accepted == (uint16_t)(before.accepted + complete));
    assert(reception.errors == (uint8_t)(before.errors + errors));
}

/* A package of any content whatever is analysed and executed. */
void theorem_package(void)
{
    anything_allowed();
    interruptible = true;
    dead_man_package_received();
    take_package();
    assert(!locked);
    assert(transmission.answer.status <= STATUS_NOT_INITIALISED);
    assert_controller();
}

void theorem_response(void)
{
    anything_allowed();
    interruptible = true;
    if (transmission_take_owed()) {
        respond();
        assert(transmission.next == 0);
    }
    assert(!locked);
    assert_controller();
}

#ifdef RSAPIEN_MOTION
void theorem_bumpers(void)
{
    anything_allowed();
    interruptible = true;
    test_bumpers();
    assert(!locked);
    assert_controller();
}
#endif

#ifdef RSAPIEN_MOTION
static void configured(uint8_t joint, uint16_t full_travel_ms)
{
    assert(joint < JOINT_COUNT);
    assert(full_travel_ms >= TRAVEL_MS_MIN && full_travel_ms <= TRAVEL_MS_MAX);
    travel.position_ms = nondet_uint16();
    __ESBMC_assume(travel.position_ms <= full_travel_ms);
    set_travel(full_travel_ms);
    switch (joint) {
    case 0:
        take_travel_0();
        break;
    case 1:
        take_travel_1();
        break;
    case 2:
        take_travel_2();
        break;
    case 3:
        take_travel_3();
        break;
    case 4:
        take_travel_4();
        break;
    case 5:
        take_travel_5();
        break;
    default:
        take_travel_6();
        break;
    }
}
#endif
