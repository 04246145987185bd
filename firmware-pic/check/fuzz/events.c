/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "events.h"

#include <stdbool.h>
#include <string.h>

#include "bench.h"
#include "command.h"
#include "line.h"
#include "reception.h"

/* An input may ask for so many ticks in all, so that each ends soon. */
#define TICKS_MAX 8000u
#define HEARTBEAT_MS 100u
/* More than the dead-man can count. */
#define LONG_SILENCE_MS 65600u
#define OTHER_ADDRESS (3u - CONTROLLER_ADDRESS)

enum event {
    EVENT_NOISE,        /* high bits + 1 bytes come, whatever they are */
    EVENT_ERROR,        /* high bits: framing or overrun */
    EVENT_TICK,         /* 1 ms */
    EVENT_TICKS,        /* a number of ms */
    EVENT_ALIVE,        /* the same, with a STATE every HEARTBEAT_MS */
    EVENT_PINS,         /* bumpers, switches */
    EVENT_TRANSMIT,     /* high bits + 1 bytes leave */
    EVENT_ANSWER,       /* whatever is to be sent leaves */
    EVENT_PACKAGE,      /* high bits: session and number; kind, count of arguments, arguments */
    EVENT_DAMAGED,      /* the same, with one to four bits wrong */
    EVENT_HELLO,        /* opens the session of the number that follows, if not 0 */
    EVENT_OTHERS,       /* a package to the other controller */
    EVENT_INTERRUPTS,   /* what comes into the gaps of the next main routine */
    EVENT_MAIN,         /* one pass of the main routine alone */
    EVENT_INTERRUPT,    /* high bits: input change, timer, or once a long silence of the main routine */
    EVENT_RESET,        /* high bits: the cause */
    EVENT_COUNT
};

struct input {
    const uint8_t *bytes;
    size_t length;
};

static struct input input;
static unsigned ticks_left;
static unsigned silence_left_ms;

static uint8_t next(void)
{
    uint8_t byte;

    if (input.length == 0) {
        return 0;
    }
    byte = *input.bytes;
    input.bytes++;
    input.length--;
    return byte;
}

static void tick(void)
{
    if (ticks_left > 0) {
        ticks_left--;
        bench_tick();
    }
}

/* The main routine takes out what has come. */
static void drain(void)
{
    unsigned passes;

    for (passes = 0; passes <= RECEIVE_RING_LENGTH && reception_ring.put != reception_ring.taken;
         passes++) {
        bench_main_routine();
    }
    bench_main_routine();
    CHECK(reception_ring.put == reception_ring.taken);
    CHECK(!reception_ring.overflowed);
}

/* Line bytes come, each seen by the main routine; tells how many packages were accepted. */
static unsigned receive(const uint8_t bytes[LINE_ACTION_LENGTH])
{
    unsigned before;
    unsigned index;

    drain();
    before = reception.accepted;
    for (index = 0; index < LINE_ACTION_LENGTH; index++) {
        CHECK(reception.accepted == before);
        bench_receive(bytes[index]);
        bench_main_routine();
    }
    return (uint16_t)(reception.accepted - before);
}

static void send(const uint8_t content[LINE_ACTION_CONTENT])
{
    uint8_t bytes[LINE_ACTION_LENGTH];

    line_encode(CONTROLLER_ADDRESS, content, bytes);
    /* Whatever came before, an intact package is accepted at its last byte. */
    CHECK(receive(bytes) == 1);
}

static void send_kind(uint8_t kind)
{
    uint8_t content[LINE_ACTION_CONTENT] = {0};

    content[ACTION_KIND] = kind;
    send(content);
    bench_transmit(LINE_ANSWER_LENGTH);
}

static void many_ticks(bool is_alive)
{
    const uint8_t wanted = next();
    const unsigned count = (wanted & 0x80u) != 0 ? (wanted & 0x7Fu) * 32u : wanted;
    unsigned index;

    for (index = 0; index < count && ticks_left > 0; index++) {
        if (is_alive && index % HEARTBEAT_MS == 0) {
            send_kind(KIND_STATE);
        }
        tick();
    }
}

/* Reads a content: how its session and number stand to the controller's, kind and arguments. */
static void read_content(uint8_t turn, uint8_t content[LINE_ACTION_CONTENT])
{
    unsigned count;
    unsigned index;

    memset(content, 0, LINE_ACTION_CONTENT);
    content[ACTION_SESSION] = command.session;
    content[ACTION_SEQUENCE] = (uint8_t)(command.last_sequence + ((turn & 1u) != 0 ? 0u : 1u));
    if ((turn & 2u) != 0) {
        content[ACTION_SESSION] ^= next();
    }
    if ((turn & 4u) != 0) {
        content[ACTION_SEQUENCE] ^= next();
    }
    content[ACTION_KIND] = next();
    count = next() % (LINE_ACTION_CONTENT - ACTION_ARGUMENTS + 1u);
    for (index = 0; index < count; index++) {
        content[ACTION_ARGUMENTS + index] = next();
    }
}

static void send_damaged(uint8_t turn)
{
    uint8_t content[LINE_ACTION_CONTENT];
    uint8_t bytes[LINE_ACTION_LENGTH];
    bool damaged[LINE_ACTION_LENGTH * 8] = {false};
    unsigned flips = 1u + (next() & 3u);

    read_content(turn, content);
    line_encode(CONTROLLER_ADDRESS, content, bytes);
    while (flips > 0) {
        const unsigned place = next() % (LINE_ACTION_LENGTH * 8u);

        flips--;
        if (!damaged[place]) {
            damaged[place] = true;
            bytes[place / 8] ^= (uint8_t)(1u << (place % 8));
        }
    }
    /* Up to four wrong bits are always seen. */
    CHECK(receive(bytes) == 0);
}

static void send_hello(void)
{
    uint8_t content[LINE_ACTION_CONTENT] = {0};

    content[ACTION_KIND] = KIND_HELLO;
    content[HELLO_LOWEST] = PROTOCOL_VERSION;
    content[HELLO_HIGHEST] = PROTOCOL_VERSION;
    content[HELLO_SESSION] = next();
    send(content);
    CHECK(content[HELLO_SESSION] == 0 || command.session == content[HELLO_SESSION]);
}

static void send_to_other(void)
{
    uint8_t content[LINE_ACTION_CONTENT];
    uint8_t bytes[LINE_ACTION_LENGTH];

    read_content(0, content);
    line_encode(OTHER_ADDRESS, content, bytes);
    CHECK(receive(bytes) == 0);
}

static void handle(uint8_t event)
{
    const uint8_t how = event >> 4;
    unsigned index;

    switch (event % EVENT_COUNT) {
    case EVENT_NOISE:
        for (index = 0; index <= how; index++) {
            bench_receive(next());
        }
        break;
    case EVENT_ERROR:
        controller_receive_error((how & 1u) != 0 ? LINE_ERROR_OVERRUN : LINE_ERROR_FRAMING);
        break;
    case EVENT_TICK:
        tick();
        break;
    case EVENT_TICKS:
        many_ticks(false);
        break;
    case EVENT_ALIVE:
        many_ticks(true);
        break;
    case EVENT_PINS:
        bench.bumpers = next() & 0x3Fu;
        bench.switches = how & 3u;
        bench.supply_low = (how & 4u) != 0;
        break;
    case EVENT_TRANSMIT:
        bench_transmit(how + 1u);
        break;
    case EVENT_ANSWER:
        bench_transmit(LINE_ANSWER_LENGTH);
        break;
    case EVENT_PACKAGE: {
        uint8_t content[LINE_ACTION_CONTENT];

        read_content(how, content);
        send(content);
        break;
    }
    case EVENT_DAMAGED:
        send_damaged(how);
        break;
    case EVENT_HELLO:
        send_hello();
        break;
    case EVENT_OTHERS:
        send_to_other();
        break;
    case EVENT_INTERRUPTS:
        for (index = 0; index < BENCH_GAPS; index++) {
            bench.gaps[index] = next();
        }
        bench_main_routine();
        break;
    case EVENT_MAIN:
        bench_main_routine();
        break;
    case EVENT_INTERRUPT:
        if ((how & 1u) != 0) {
            bench_input_change_interrupt();
        } else if (how == 8) {
            while (silence_left_ms > 0) {
                silence_left_ms--;
                bench_timer_interrupt();
            }
        } else if (ticks_left > 0) {
            ticks_left--;
            bench_timer_interrupt();
        }
        break;
    default:
        bench_reset((enum stop_cause)(STOP_CAUSE_POWER_ON + how % 3u), controller_boot());
        break;
    }
    bench_check();
}

void run_events(const uint8_t *bytes, size_t length)
{
    input.bytes = bytes;
    input.length = length;
    ticks_left = TICKS_MAX;
    silence_left_ms = LONG_SILENCE_MS;
    bench_power_on();
    while (input.length > 0) {
        handle(next());
    }
}
