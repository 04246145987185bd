/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "eeprom.h"

#include "controller.h"
#include "sfr.h"

#define WRITE_TRIES 3u

/* Turns of the waiting loop in about 20 ms; a write takes 4 ms, 10 ms at the most. */
#define WRITE_PATIENCE (RSAPIEN_CLOCK_MHZ * 1000u)

uint8_t eeprom_read(uint8_t address)
{
    EEADR = address;
    /* Not program memory, not configuration. The read must not follow EEADR at once, and EEDATA
     * is right only in the instruction behind RD (errata of the PIC18FXX2, DS80122). */
    EECON1 = 0;
    EECON1 |= EECON1_RD;
    return EEDATA;
}

void eeprom_write(uint8_t address, uint8_t value)
{
    uint8_t tries = WRITE_TRIES;

    while ((tries != 0u) && (eeprom_read(address) != value)) {
        uint16_t patience = WRITE_PATIENCE;

        tries--;
        EEADR = address;
        EEDATA = value;
        EECON1 = EECON1_WREN;
        EECON2 = 0x55;
        EECON2 = 0xAA;
        EECON1 |= EECON1_WR;
        while (((EECON1 & EECON1_WR) != 0u) && (patience != 0u)) {
            patience--;
        }
        EECON1 = 0;
    }
}
