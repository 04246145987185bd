/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* The data EEPROM, while interrupts are off. */
#ifndef RSAPIEN_PIC18_EEPROM_H
#define RSAPIEN_PIC18_EEPROM_H

#include <stdint.h>

/* Where the boot number stands. An erased cell is 255, so the first boot is number 0. */
#define EEPROM_BOOT 0u

uint8_t eeprom_read(uint8_t address);

/* Writes and reads back, up to three times. Takes about 4 ms; 60 ms, which the watchdog bears,
 * when the cell is worn out. */
void eeprom_write(uint8_t address, uint8_t value);

#endif
