#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks a linked image against its budget, and tells its sizes.

    report.py motion|camera BUILD_FOLDER NAME LAYOUT

BUILD_FOLDER holds image.hex, image.map and the compiler's .asm files. Writes the line of the table
to standard output and NAME ADDRESS lines, program memory first, to BUILD_FOLDER/image.symbols.

Fails when flash or RAM is over budget, when a stack may be deeper than what is there, when there is
initialised data (the start-up copies none) or a generic pointer (three bytes and a call each), when
the stack lies across two banks, or when a variable is not where and as large as it was placed.
"""

import glob
import re
import sys

from image import PROGRAM_END, Map, read_hex
from place_state import ACCESS_BEGIN
from stack_depth import RETURN_LEVELS, Refused, measure

BUDGET = {"motion": (12288, 900), "camera": (6144, 350)}
SPECIAL_FUNCTION_REGISTERS = range(0xF80, 0x1000)
NEEDS_NO_STACK = "_pins_reset"
STACK_REGISTERS = ("POSTDEC1", "PREINC1", "POSTINC1", "FSR1L", "FSR2L", "PLUSW2", "CALL")


def placed_differently(build, layout):
    """Variables of the layout that the compiler made larger or smaller than was reckoned."""
    reserved = {}
    for path in glob.glob(f"{build}/*.asm"):
        with open(path, encoding="utf-8") as file:
            reserved.update(re.findall(r"^_(\w+)\s+res\s+(\d+)", file.read(), re.M))
    with open(layout, encoding="utf-8") as file:
        for name, _, size in (line.split() for line in file):
            if int(reserved.get(name, "0")) != int(size):
                yield f"{name} takes {reserved.get(name)} bytes, placed for {size}"


def code_of(build, name):
    for path in glob.glob(f"{build}/*.asm"):
        with open(path, encoding="utf-8") as file:
            if found := re.search(rf"^{name}:\n(.*?)\tRETURN", file.read(), re.M | re.S):
                return re.sub(r"^;.*$", "", found.group(1), flags=re.M)
    return None


def main(arguments):
    if len(arguments) != 4 or arguments[0] not in BUDGET:
        sys.exit(__doc__)
    controller, build, name, layout = arguments
    flash_most, ram_most = BUDGET[controller]
    memory = read_hex(f"{build}/image.hex")
    linked = Map(f"{build}/image.map")
    data = [section for section in linked.sections if section[3] == "data"]
    flash = sum(address < PROGRAM_END for address in memory)
    ram = sum(size for _, _, _, _, size in data)
    wrong = list(placed_differently(build, layout))
    if flash > flash_most:
        wrong.append(f"{flash} bytes of flash; the budget is {flash_most}")
    if ram > ram_most:
        wrong.append(f"{ram} bytes of RAM; the budget is {ram_most}")
    for section, kind, _, _, size in linked.sections:
        if "idata" in (kind, section) and size:
            wrong.append("there is initialised data (.idata in the map)")
        if section == ".registers" and size > ACCESS_BEGIN:
            wrong.append(f"the compiler's registers take {size} bytes: ACCESS_BEGIN is too low")
    wrong += [f"generic pointers: {symbol}" for symbol in linked.program if "gptr" in symbol]
    wrong += [
        f"a local variable in static memory, no routine is to have one: {symbol}"
        for symbol in linked.data
        if re.fullmatch(r"_\w+_\d+_\d+", symbol) and not symbol.startswith("__")
    ]
    begin, end = linked.data["_stack"], linked.data["_stack_end"]
    if begin >> 8 != end >> 8:
        wrong.append(f"the stack, 0x{begin:03x} to 0x{end:03x}, lies across two banks")
    code = code_of(build, NEEDS_NO_STACK)
    if code is None or any(word in code for word in STACK_REGISTERS):
        wrong.append(f"{NEEDS_NO_STACK} needs a stack: it runs before there is one")
    try:
        levels, stack_bytes = measure(memory, linked.program)["worst"]
    except Refused as why:
        sys.exit(f"report.py: {name}: {why}")
    if levels > RETURN_LEVELS:
        wrong.append(f"{levels} return levels; the chip has {RETURN_LEVELS}")
    if stack_bytes > end - begin + 1:
        wrong.append(f"up to {stack_bytes} bytes of stack; reserved are {end - begin + 1}")
    with open(f"{build}/image.symbols", "w", encoding="utf-8") as file:
        for symbols, left_out in ((linked.program, ()), (linked.data, SPECIAL_FUNCTION_REGISTERS)):
            for symbol, address in sorted(symbols.items(), key=lambda item: (item[1], item[0])):
                if address not in left_out:
                    file.write(f"{symbol} 0x{address:04x}\n")
    print(f"| {name} | {flash} | {flash_most} | {ram} | {ram_most} | {levels} of {RETURN_LEVELS} "
          f"| {stack_bytes} of {end - begin + 1} |")
    if wrong:
        sys.exit("\n".join([f"report.py: {name}:", *wrong]))


if __name__ == "__main__":
    main(sys.argv[1:])
