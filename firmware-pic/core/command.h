/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * How the main routine analyses a request: refusals in the order in which they are told,
 * sessions, sequence numbers and duplicates. What is left is executed by the controller.
 *
 *   package ─► kind known? ─► mine? ─► arguments? ─► HELLO: version? ─► opens its session ─► 0
 *                 │ no: 1       │ no: 8    │ no: 2       │ no: 7
 *                 │             │          │
 *                 │             │          └► STATE, STOP, COUNTERS ─► executed ─► 0
 *                 ▼             ▼          └► numbered ─► session? ─► number?
 *                answered with the status,                  │ no: 4     │ last executed: duplicate, 0
 *                nothing executed                           ▼           │ last + 1: the controller's
 *                                                                       │ own checks 9, 6, 3, else 0
 *                                                                       └ else: 5
 */
#ifndef RSAPIEN_COMMAND_H
#define RSAPIEN_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol.h"
#include "reception.h"

struct command {
    uint8_t session;       /* the open one; 0: none */
    uint8_t last_sequence; /* executed last; 0 when `any_executed` is false */
    bool any_executed;
    uint16_t duplicates;
};

extern struct command command;

void command_reset(void);

/* Analyses the package in `reception.content`, up to what only the controller itself can know. */
enum status command_analyse(void);

/* The package in `reception.content` was executed: one that is numbered has used its number up. */
void command_note_executed(void);

/* Words of `reception.content`, low byte first. */
#define COMMAND_WORD(offset)                                                                       \
    ((uint16_t)(reception.content[(offset)] |                                                      \
                (uint16_t)((uint16_t)reception.content[(offset) + 1u] << 8)))

#endif
