#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The worst depth of both stacks of an image: return addresses and the compiled code's bytes.

    stack_depth.py IMAGE.hex IMAGE.map

Follows every path through the instructions of the image itself, from reset and from both interrupt
vectors, start-up and library included. The compiled code's stack is what goes through POSTDEC1,
PREINC1 and POSTINC1. The worst case is the main routine's deepest place, interrupted there by the
low-priority routine, that one at its deepest place by the high-priority one.

Refuses what it cannot follow: recursion, jumps to reckoned addresses but for sdcc's tables of
GOTOs, a place that is reached with two depths, a return that leaves bytes behind. Refuses what
sdcc's interrupts do not save: reading tables in program memory, anywhere, and in an interrupt the
compiler's own library (long multiplication and division keep their operands in static memory).
"""

import sys

from image import Map, read_hex

RETURN_LEVELS = 31  # of the chips
POSTDEC1, PREINC1, POSTINC1, FSR1L, FSR1H, PCL = 0xFE5, 0xFE4, 0xFE6, 0xFE1, 0xFE2, 0xFF9
VECTORS = {"main": 0x0000, "high": 0x0008, "low": 0x0018}


class Refused(Exception):
    """The image does what cannot be followed."""


class Image:
    """The program memory as instruction words."""

    def __init__(self, memory, names):
        self.memory = memory
        self.names = {address: name for name, address in names.items()}

    def word(self, address):
        if address not in self.memory:
            raise Refused(f"runs into empty program memory at 0x{address:04x}")
        return self.memory[address] | self.memory[address + 1] << 8

    def name(self, address):
        return self.names.get(address, f"0x{address:04x}")


def signed(value, bits):
    return value - (1 << bits) if value & 1 << (bits - 1) else value


def is_skip(word):
    return word >> 13 == 0b101 or word >> 10 in (
        0b001011, 0b001111, 0b010011, 0b010010  # DECFSZ INCFSZ DCFSNZ INFSNZ
    ) or word >> 9 in (0b0110000, 0b0110001, 0b0110010, 0b0110011)  # CPFSLT CPFSEQ CPFSGT TSTFSZ


def is_file_operation(word):
    """Whether the instruction has a file register in its low byte, with its bank in bit 8."""
    return 0x02 <= word >> 8 <= 0x07 or 0x10 <= word >> 8 <= 0xBF


def decode(image, address):
    """(bytes of the instruction, kind, target, file registers it touches)"""
    word = image.word(address)
    top = word >> 8
    if top in (0xEC, 0xED, 0xEF):
        target = ((image.word(address + 2) & 0xFFF) << 8 | word & 0xFF) << 1
        return 4, "goto" if top == 0xEF else "call", target, []
    if word >> 11 == 0b11010:
        return 2, "goto", address + 2 + 2 * signed(word & 0x7FF, 11), []
    if word >> 11 == 0b11011:
        return 2, "call", address + 2 + 2 * signed(word & 0x7FF, 11), []
    if 0xE0 <= top <= 0xE7:
        return 2, "branch", address + 2 + 2 * signed(word & 0xFF, 8), []
    if word in (0x0010, 0x0011, 0x0012, 0x0013) or top == 0x0C:
        return 2, "return", None, []
    if word == 0x00FF:
        return 2, "reset", None, []
    if word in (0x0005, 0x0006):
        raise Refused(f"PUSH or POP at 0x{address:04x}")
    if 0x0008 <= word <= 0x000F:
        raise Refused(f"a table in program memory is read or written at 0x{address:04x}")
    if top >> 4 == 0xC:
        return 4, "next", None, [word & 0xFFF, image.word(address + 2) & 0xFFF]
    if top == 0xEE:
        return 4, "stack begins" if word >> 4 & 3 == 1 else "next", None, []
    if is_file_operation(word):
        low = word & 0xFF
        register = low + 0xF00 if not word & 0x100 and low >= 0x80 else low
        return 2, "skip" if is_skip(word) else "next", None, [register]
    return 2, "next", None, []


def jump_table(image, address):
    """The targets of the GOTOs that stand behind a write to PCL."""
    targets = []
    while image.memory.get(address + 1) == 0xEF:
        targets.append(decode(image, address)[2])
        address += 4
    if not targets:
        raise Refused(f"a jump to a reckoned address at 0x{address:04x}")
    return targets


def popped_at_once(image, address):
    """MOVLW n, ADDWF FSR1L, F pops n bytes; the bank of the stack never changes."""
    before = image.word(address - 2)
    if image.word(address) == 0x26E1 and before >> 8 == 0x0E:
        return before & 0xFF
    raise Refused(f"FSR1 is changed at 0x{address:04x}")


def depths(image, entry, done, under_way=()):
    """(return levels, stack bytes) that the routine at `entry` needs at most."""
    if entry in done:
        return done[entry]
    if entry in under_way:
        chain = " > ".join(image.name(address) for address in (*under_way, entry))
        raise Refused(f"recursion: {chain}")
    levels_most, bytes_most = 0, 0
    depth_at = {}
    to_do = [(entry, 0)]
    while to_do:
        address, depth = to_do.pop()
        if address in depth_at:
            if depth_at[address] != depth:
                raise Refused(
                    f"{image.name(entry)}: 0x{address:04x} is reached with {depth_at[address]} and "
                    f"with {depth} bytes on the stack"
                )
            continue
        depth_at[address] = depth
        size, kind, target, registers = decode(image, address)
        if kind == "stack begins":
            depth = 0
        for register in registers:
            if register == POSTDEC1:
                depth += 1
            elif register in (PREINC1, POSTINC1):
                depth -= 1
            elif register in (FSR1L, FSR1H) and image.word(address) >> 12 != 0xC:
                depth -= popped_at_once(image, address)
        bytes_most = max(bytes_most, depth)
        following = address + size
        if kind == "return":
            if depth != 0:
                raise Refused(f"{image.name(entry)} returns with {depth} bytes on the stack")
        elif kind == "goto":
            to_do.append((target, depth))
        elif kind == "call":
            levels, stack_bytes = depths(image, target, done, (*under_way, entry))
            levels_most = max(levels_most, 1 + levels)
            bytes_most = max(bytes_most, depth + stack_bytes)
            to_do.append((following, depth))
        elif kind == "branch":
            to_do += [(target, depth), (following, depth)]
        elif kind == "skip":
            skipped = 4 if image.word(following) >> 8 in (0xEC, 0xED, 0xEE, 0xEF) or image.word(
                following) >> 12 == 0xC else 2
            to_do += [(following, depth), (following + skipped, depth)]
        elif PCL in registers:
            to_do += [(target, depth) for target in jump_table(image, following)]
        elif kind != "reset":
            to_do.append((following, depth))
    done[entry] = (levels_most, bytes_most)
    return done[entry]


def measure(memory, names):
    """{"main": (levels, bytes), "low": ..., "high": ..., "worst": ...}"""
    image = Image(memory, names)
    found = {}
    for routine, vector in VECTORS.items():
        reached = {}
        levels, stack_bytes = depths(image, vector, reached)
        library = [image.name(entry) for entry in reached if image.name(entry).startswith("__")]
        if routine != "main" and library:
            raise Refused(f"the {routine}-priority interrupt calls {', '.join(library)}")
        # An interrupt takes a return level itself.
        found[routine] = (levels + (routine != "main"), stack_bytes)
    found["worst"] = tuple(sum(part) for part in zip(*(found[name] for name in VECTORS)))
    return found


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    try:
        found = measure(read_hex(arguments[0]), Map(arguments[1]).program)
    except Refused as why:
        sys.exit(f"stack_depth.py: {arguments[0]}: {why}")
    for routine, (levels, stack_bytes) in found.items():
        print(f"{routine:6} {levels:3} return levels {stack_bytes:4} stack bytes")


if __name__ == "__main__":
    main(sys.argv[1:])
