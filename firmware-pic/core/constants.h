/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * The numbers of both controllers. Each stands in Rust as well, in rsapien-protocol or in
 * rsapien-firmware-model, and a test compares them: one line, one name, one plain value.
 */
#ifndef RSAPIEN_CONSTANTS_H
#define RSAPIEN_CONSTANTS_H

/* The firmware's version that HELLO tells. */
#define FIRMWARE_VERSION_MAJOR 0u
#define FIRMWARE_VERSION_MINOR 1u
#define FIRMWARE_VERSION_PATCH 0u

/* The link: lengths in bytes, values of line bytes. */
#define PROTOCOL_VERSION 1u
#define ACTION_CONTENT_LENGTH 12u
#define SYNCHRONIZATION_CONTENT_LENGTH 18u
#define SYNCHRONIZATION_PACKAGE_LENGTH 25u
#define GROUP_DATA_LENGTH 6u
#define CHECK_LENGTH 3u
#define LAST_CHECK_BYTE_MAX 3u
#define CRC_POLYNOMIAL_REVERSED 0xAC9Au
#define CRC_INITIAL 0xFFFFu
#define GAP_MS_ROBOT 20u
#define RECEIVE_RING_LENGTH 32u

/* The dead-man and CONFIGURE, in ms. */
#define DEAD_MAN_MS_DEFAULT 500u
#define DEAD_MAN_MS_MIN 100u
#define DEAD_MAN_MS_MAX 10000u
#define TRAVEL_MS_MIN 100u
#define TRAVEL_MS_MAX 10000u

/* Motion. Times in ms. */
#define JOINT_COUNT 7u
#define BUMPER_COUNT 6u
#define QUEUE_LENGTH 32u
#define DEAD_TIME_MS 1u
#define BUMPER_DEBOUNCE_TESTS 5u
#define FULL_TRAVEL_MS_RIGHT_ARM 1000u
#define FULL_TRAVEL_MS_LEFT_ARM 1000u
#define FULL_TRAVEL_MS_RIGHT_HAND 400u
#define FULL_TRAVEL_MS_LEFT_HAND 400u
#define FULL_TRAVEL_MS_TILT 500u
#define FULL_TRAVEL_MS_RIGHT_LEG 600u
#define FULL_TRAVEL_MS_LEFT_LEG 600u
/* Shares of the full travel time, as powers of two: T / 8, T / 4, T / 32. */
#define OVERRUN_SHIFT 3u
#define BELIEVED_SHIFT 2u
#define SWITCH_HALF_WINDOW_SHIFT 5u
#define MOTION_WATCHDOG_MS 144u

/* Camera. Angles in 0.01 degree, speeds in degrees per second. */
#define PAN_CENTIDEG_MAX 9000
#define TILT_CENTIDEG_MAX 4500
#define AXIS_SPEED_MAX_DEG_PER_S 180u
#define HOME_SETTLE_MS 750u
#define CAMERA_WATCHDOG_MS 128u

#endif
