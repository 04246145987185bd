#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks the configuration bytes of an image against what the data sheets call them.

    check_config.py 18f452|18f2320 CLOCK_MHZ IMAGE.hex

What is wanted stands here once more, field by field, as (byte, bits, value): PIC18FXX2 data sheet
(DS39564), section 19.1; PIC18F2220/2320/4220/4320 data sheet (DS39599), section 23.1. A bit that no
field names is unimplemented and has to be 0; so has a byte without fields.
"""

import sys

from image import CONFIGURATION, read_hex

CONFIG1H, CONFIG2L, CONFIG2H, CONFIG3H, CONFIG4L = 1, 2, 3, 5, 6
CONFIG5L, CONFIG5H, CONFIG6L, CONFIG6H, CONFIG7L, CONFIG7H = 8, 9, 10, 11, 12, 13
BYTES = 14

XT, HS, HSPLL = 0b001, 0b010, 0b110
OSCILLATOR = {4: XT, 10: HS, 20: HS, 40: HSPLL}

# Bits from the lowest: (name, byte, lowest bit, number of bits, value wanted).
BOTH = [
    ("PWRTEN: power-up timer on", CONFIG2L, 0, 1, 0),
    ("BOREN: brown-out reset on", CONFIG2L, 1, 1, 1),
    ("BORV: 4.2 V", CONFIG2L, 2, 2, 0b01),
    ("WDTEN: watchdog on", CONFIG2H, 0, 1, 1),
    ("CCP2MX: CCP2 at RC1", CONFIG3H, 0, 1, 1),
    ("STVREN: stack overflow resets", CONFIG4L, 0, 1, 1),
    ("LVP: low-voltage programming off", CONFIG4L, 2, 1, 0),
    ("DEBUG: debugger off", CONFIG4L, 7, 1, 1),
    ("CP0-CP3: code not protected", CONFIG5L, 0, 4, 0b1111),
    ("CPB, CPD: boot block and EEPROM not protected", CONFIG5H, 6, 2, 0b11),
    ("WRT0-WRT3: code may be written", CONFIG6L, 0, 4, 0b1111),
    ("WRTC, WRTB, WRTD: the rest may be written", CONFIG6H, 5, 3, 0b111),
    ("EBTR0-EBTR3: tables may be read", CONFIG7L, 0, 4, 0b1111),
    ("EBTRB: the boot block's too", CONFIG7H, 6, 1, 1),
]
ONE = {
    "18f452": [
        ("OSCSEN: no other clock", CONFIG1H, 5, 1, 1),
        ("WDTPS: 18 ms * 8", CONFIG2H, 1, 3, 0b011),
    ],
    "18f2320": [
        ("FOSC3: no internal oscillator", CONFIG1H, 3, 1, 0),
        ("FSCM: no clock monitor", CONFIG1H, 6, 1, 0),
        ("IESO: no two-speed start", CONFIG1H, 7, 1, 0),
        ("WDTPS: 4 ms * 32", CONFIG2H, 1, 4, 0b0101),
        ("PBAD: port B digital", CONFIG3H, 1, 1, 0),
        ("MCLRE: the reset pin resets", CONFIG3H, 7, 1, 1),
    ],
}


def main(arguments):
    if len(arguments) != 3 or arguments[0] not in ONE:
        sys.exit(__doc__)
    chip, clock_mhz, path = arguments[0], int(arguments[1]), arguments[2]
    memory = read_hex(path)
    fields = [("FOSC: oscillator", CONFIG1H, 0, 3, OSCILLATOR[clock_mhz]), *BOTH, *ONE[chip]]
    wrong = []
    implemented = [0] * BYTES
    for name, byte, lowest, bits, value in fields:
        mask = (1 << bits) - 1
        implemented[byte] |= mask << lowest
        found = memory.get(CONFIGURATION + byte, 0) >> lowest & mask
        if found != value:
            wrong.append(f"{name}: {found:0{bits}b} instead of {value:0{bits}b}")
    for byte in range(BYTES):
        if CONFIGURATION + byte not in memory:
            wrong.append(f"byte 0x{CONFIGURATION + byte:x} is missing")
        elif memory[CONFIGURATION + byte] & ~implemented[byte]:
            wrong.append(f"byte 0x{CONFIGURATION + byte:x} has bits that the chip has not")
    if wrong:
        sys.exit("\n".join([f"check_config.py: {path}:", *wrong]))


if __name__ == "__main__":
    main(sys.argv[1:])
