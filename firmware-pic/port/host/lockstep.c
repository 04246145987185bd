/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * One controller behind a pipe, for comparing it with the reference model: events come on stdin,
 * and each is answered on stdout with what can be seen of the controller after it. Bytes:
 *
 *     01 b    receive interrupt           06 n   transmit interrupt, n times
 *     02 e    receive error               07 c   reset for cause c
 *     03 p s  tick                        08     the main routine hangs
 *     04 p s  one pass of the main        09 b   anew, as after power-on with boot number b
 *             routine alone               0A     timer interrupt alone
 *     05 p s  input change alone          00     flush stdout; has no answer
 *
 * p: bumpers pressed; s: bit 0 left, bit 1 right mid-arm switch closed, bit 2 supply low.
 * The answer: motors towards first, motors towards last (camera: servos driven, 0), session,
 * transmitting, boot number, the 14 bytes of the report, the 14 bytes of the counters (camera:
 * then pan and tilt as commanded, two words), how many bytes were handed out, those bytes.
 */
#include <stdio.h>
#include <stdlib.h>

#include "command.h"
#include "communication.h"
#include "host.h"
#include "transmission.h"

#ifdef RSAPIEN_CAMERA
#include "camera.h"
#endif

enum event {
    EVENT_FLUSH = 0x00,
    EVENT_RECEIVE = 0x01,
    EVENT_ERROR = 0x02,
    EVENT_TICK = 0x03,
    EVENT_MAIN = 0x04,
    EVENT_INPUT_CHANGE = 0x05,
    EVENT_TRANSMIT = 0x06,
    EVENT_RESET = 0x07,
    EVENT_HANG = 0x08,
    EVENT_ANEW = 0x09,
    EVENT_TIMER = 0x0A
};

static uint8_t handed_out[255];
static uint8_t handed_out_count;

static uint8_t argument(void)
{
    int byte = getchar();

    if (byte == EOF) {
        fputs("lockstep: the input ends within an event\n", stderr);
        exit(2);
    }
    return (uint8_t)byte;
}

static struct host_pins pins_argument(void)
{
    struct host_pins pins = {.bumpers = argument(), .switches = 0, .supply_low = false};
    uint8_t others = argument();

    pins.switches = (uint8_t)(others & 3u);
    pins.supply_low = (others & 4u) != 0;
    return pins;
}

static void transmit(uint8_t times)
{
    while (times > 0 && controller_transmit_interrupt()) {
        handed_out[handed_out_count] = transmission.byte;
        handed_out_count++;
        times--;
    }
}

static void put(uint8_t byte)
{
    putchar(byte);
}

static void put_report(void)
{
    fwrite(transmission.report, 1, REPORT_LENGTH, stdout);
}

#ifdef RSAPIEN_CAMERA
static void put_word(int16_t value)
{
    put((uint8_t)((uint16_t)value & 0xFFu));
    put((uint8_t)((uint16_t)value >> 8));
}
#endif

static void answer(void)
{
#ifdef RSAPIEN_MOTION
    put(host_chip.motors_towards_first);
    put(host_chip.motors_towards_last);
#else
    put(camera.driven);
    put(0);
#endif
    put(command.session);
    put(transmission.next < SYNCHRONIZATION_PACKAGE_LENGTH);
    put(controller_boot());
    controller_report();
    put_report();
    communication_report_counters();
    put_report();
#ifdef RSAPIEN_CAMERA
    put_word(camera.pan.position_centideg);
    put_word(camera.tilt.position_centideg);
#endif
    put(handed_out_count);
    fwrite(handed_out, 1, handed_out_count, stdout);
}

static void handle(int event)
{
    struct host_pins pins;

    handed_out_count = 0;
    switch (event) {
    case EVENT_FLUSH:
        fflush(stdout);
        return;
    case EVENT_RECEIVE:
        host_receive_interrupt(argument());
        break;
    case EVENT_ERROR:
        controller_receive_error((enum line_error)(argument() & 1u));
        break;
    case EVENT_TICK:
        pins = pins_argument();
        host_tick(&pins);
        break;
    case EVENT_MAIN:
        pins = pins_argument();
        host_main_routine(&pins);
        break;
    case EVENT_INPUT_CHANGE:
        pins = pins_argument();
        host_input_change_interrupt(&pins);
        break;
    case EVENT_TRANSMIT:
        transmit(argument());
        break;
    case EVENT_RESET:
        host_reset((enum stop_cause)argument());
        break;
    case EVENT_HANG:
        host_hang();
        break;
    case EVENT_ANEW:
        host_power_on(argument());
        break;
    case EVENT_TIMER:
        host_timer_interrupt();
        break;
    default:
        fprintf(stderr, "lockstep: 0x%02X is no event\n", (unsigned)event);
        exit(2);
    }
    answer();
}

int main(void)
{
    static char output[1 << 16];
    int event;

    setvbuf(stdout, output, _IOFBF, sizeof output);
    host_power_on(0);
    for (event = getchar(); event != EOF; event = getchar()) {
        handle(event);
    }
    return 0;
}
