# SPDX-License-Identifier: MIT OR Apache-2.0
"""Reads what the linker writes: Intel hex files and gplink's map."""

import re

CONFIGURATION = 0x300000
PROGRAM_END = 0x8000


def read_hex(path):
    """The bytes of an Intel hex file, by address."""
    memory = {}
    upper = 0
    with open(path, encoding="ascii") as file:
        for line in file:
            record = bytes.fromhex(line.strip()[1:])
            if sum(record) & 0xFF:
                raise ValueError(f"{path}: bad check sum: {line.strip()}")
            length, address, kind = record[0], record[1] << 8 | record[2], record[3]
            if kind == 4:
                upper = record[4] << 24 | record[5] << 16
            elif kind == 0:
                for index in range(length):
                    memory[upper + address + index] = record[4 + index]
    return memory


class Map:
    """gplink's map: sections as (name, type, address, location, bytes), symbols by location."""

    def __init__(self, path):
        self.sections = []
        self.program = {}
        self.data = {}
        section = re.compile(r"\s*(\S+)\s+(\w+)\s+0x([0-9a-f]+)\s+(program|data)\s+0x([0-9a-f]+)")
        symbol = re.compile(r"\s*(\S+)\s+0x([0-9a-f]+)\s+(program|data)\s+(extern|static)\s")
        with open(path, encoding="utf-8") as file:
            for line in file:
                if found := section.match(line):
                    name, kind, address, location, size = found.groups()
                    self.sections.append((name, kind, int(address, 16), location, int(size, 16)))
                elif found := symbol.match(line):
                    name, address, location, _ = found.groups()
                    if not re.fullmatch(r"_\d+_DS_", name):
                        named = self.program if location == "program" else self.data
                        named.setdefault(name, int(address, 16))
