/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "communication.h"

#include "command.h"
#include "controller.h"
#include "dead_man.h"
#include "port.h"
#include "reception.h"
#include "transmission.h"

/* Bytes behind one another in the COUNTERS report. */
#define COUNT_ACCEPTED 0u
#define COUNT_RESETS 2u
#define COUNT_CRC_ERRORS 4u
#define COUNT_FRAMING_ERRORS 6u
#define COUNT_OVERRUNS 8u
#define COUNT_DUPLICATES 10u
#define COUNT_DEAD_MAN_TRIPS 12u

#ifdef RSAPIEN_MOTION
#define QUEUE_LENGTH_TOLD QUEUE_LENGTH
#else
#define QUEUE_LENGTH_TOLD 0u
#endif

struct communication communication;

void communication_reset(enum stop_cause cause, uint8_t eeprom_boot)
{
    communication.boot = (uint8_t)(eeprom_boot + 1u);
    communication.cause = cause;
    reception_reset();
    command_reset();
    transmission_reset();
    dead_man_reset();
}

uint8_t controller_boot(void)
{
    return communication.boot;
}

void communication_report_hello(enum status status)
{
    transmission.report[REPORT_HELLO_VERSION] =
        (status == STATUS_ACCEPTED) ? (uint8_t)PROTOCOL_VERSION : 0u;
    transmission.report[REPORT_HELLO_FIRMWARE] = FIRMWARE_VERSION_MAJOR;
    transmission.report[REPORT_HELLO_FIRMWARE + 1u] = FIRMWARE_VERSION_MINOR;
    transmission.report[REPORT_HELLO_FIRMWARE + 2u] = FIRMWARE_VERSION_PATCH;
    transmission.report[REPORT_HELLO_CLOCK] = RSAPIEN_CLOCK_MHZ;
    transmission.report[REPORT_HELLO_QUEUE] = QUEUE_LENGTH_TOLD;
    REPORT_PUT_WORD(REPORT_HELLO_DEAD_MAN, dead_man.timeout_ms);
    transmission.report[REPORT_HELLO_LAST_SEQUENCE] = command.last_sequence;
    transmission.report[REPORT_HELLO_LAST_SEQUENCE + 1u] = 0;
    transmission.report[REPORT_HELLO_LAST_SEQUENCE + 2u] = 0;
    transmission.report[REPORT_BOOT] = communication.boot;
    transmission.report[REPORT_ERRORS] = reception.errors;
    transmission.report[REPORT_CAUSE] = (uint8_t)communication.cause;
}

void communication_report_counters(void)
{
    REPORT_PUT_WORD(COUNT_ACCEPTED, reception.accepted);
    REPORT_PUT_WORD(COUNT_RESETS, reception.resets);
    REPORT_PUT_WORD(COUNT_CRC_ERRORS, reception.crc_errors);
    REPORT_PUT_WORD(COUNT_FRAMING_ERRORS, reception.framing_errors);
    REPORT_PUT_WORD(COUNT_OVERRUNS, reception.overruns);
    REPORT_PUT_WORD(COUNT_DUPLICATES, command.duplicates);
    port_lock();
    REPORT_PUT_WORD(COUNT_DEAD_MAN_TRIPS, dead_man.trips);
    port_unlock();
}

static void take_package(void)
{
    enum status status = command_analyse();

    if (status == STATUS_TO_BE_EXECUTED) {
        status = controller_execute();
        if (status == STATUS_ACCEPTED) {
            command_note_executed();
        }
    }
    transmission.answer.session = reception.content[ACTION_SESSION];
    transmission.answer.sequence = reception.content[ACTION_SEQUENCE];
    transmission.answer.kind = reception.content[ACTION_KIND];
    transmission.answer.status = status;
    transmission_owe();
}

static void respond(void)
{
    if (transmission.answer.kind == (uint8_t)KIND_HELLO) {
        communication_report_hello(transmission.answer.status);
    } else if (transmission.answer.kind == (uint8_t)KIND_COUNTERS) {
        communication_report_counters();
    } else {
        controller_report();
    }
    transmission_begin();
}

void communication_pass(void)
{
    port_watchdog_clear();
    if (reception_next_package()) {
        dead_man_package_received();
        take_package();
    }
    if (transmission_take_owed()) {
        respond();
    }
}
