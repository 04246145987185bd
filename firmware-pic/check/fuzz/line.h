/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The other end of the line: packages to the controller are made and its answers are read by code
 * that shares nothing with the core, straight from SPEC.md, sections 2 and 3.
 */
#ifndef RSAPIEN_CHECK_LINE_H
#define RSAPIEN_CHECK_LINE_H

#include <stdbool.h>
#include <stdint.h>

#define LINE_ACTION_LENGTH 18
#define LINE_ANSWER_LENGTH 25
#define LINE_ACTION_CONTENT 12
#define LINE_ANSWER_CONTENT 18

/* The line bytes of an action package with this content. */
void line_encode(uint8_t address, const uint8_t content[LINE_ACTION_CONTENT],
                 uint8_t bytes[LINE_ACTION_LENGTH]);

/* Reads an answer; NULL, or what is wrong with its line bytes. */
const char *line_decode(uint8_t address, const uint8_t bytes[LINE_ANSWER_LENGTH],
                        uint8_t content[LINE_ANSWER_CONTENT]);

#endif
