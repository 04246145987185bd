#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks the register table of sfr.h against the assembler's include files of both chips.

    check_sfr.py sfr.h [FOLDER of p18f452.inc and p18f2320.inc]
"""

import re
import sys

INCLUDES = "/usr/share/gputils/header"
CHIPS = {"18f452": ("BOTH", "18F452"), "18f2320": ("BOTH",)}


def lists_of(path):
    """{list: ([(register, address)], [(register, bit, number)])}"""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"[ \t]*\\\n", "\n", file.read())
    lists = {}
    for name, body in re.findall(r"#define SFR_LIST_(\w+)\(REGISTER, BIT\)\n(.*?)\n\n", text, re.S):
        registers = re.findall(r"\bREGISTER\((\w+), (0x\w+)\)", body)
        bits = re.findall(r"\bBIT\((\w+), (\w+), (\d+)\)", body)
        lists[name] = (
            [(register, int(address, 16)) for register, address in registers],
            [(register, bit, int(number)) for register, bit, number in bits],
        )
    return lists


def include_of(path):
    """({register: address}, {(register, bit): number})"""
    registers, bits = {}, {}
    heading = None
    with open(path, encoding="latin-1") as file:
        for line in file:
            if found := re.match(r";-+ ?(\w+) (Bits|Files|Options)", line):
                heading = found.group(1) if found.group(2) == "Bits" else found.group(2)
            elif found := re.match(r"(\w+)\s+EQU\s+H'([0-9A-F]+)'", line):
                name, value = found.group(1), int(found.group(2), 16)
                if heading == "Files":
                    registers[name] = value
                elif heading is not None:
                    bits[heading, name] = value
    return registers, bits


def main(arguments):
    if len(arguments) not in (1, 2):
        sys.exit(__doc__)
    folder = arguments[1] if len(arguments) == 2 else INCLUDES
    lists = lists_of(arguments[0])
    wrong = []
    count = 0
    for chip, parts in CHIPS.items():
        registers, bits = include_of(f"{folder}/p{chip}.inc")
        for part in parts:
            for name, address in lists[part][0]:
                count += 1
                if registers.get(name) != address:
                    wrong.append(f"{chip}: {name} is {registers.get(name)}, not 0x{address:X}")
            for register, name, number in lists[part][1]:
                count += 1
                if bits.get((register, name)) != number:
                    wrong.append(f"{chip}: {register}.{name} is {bits.get((register, name))}, not {number}")
    if wrong or count < 100:
        sys.exit("\n".join([f"check_sfr.py: {arguments[0]}: {count} entries", *wrong]))
    print(f"sfr.h: {count} addresses and bits are those of the assembler's include files")


if __name__ == "__main__":
    main(sys.argv[1:])
