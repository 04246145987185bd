#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Puts the state of the C modules where a PIC18 reaches it in one instruction.

Each module keeps its state in one struct: `joints.motors.dead_time |= BIT`. sdcc computes with a
member of a struct in a register and writes it back, five instructions; with a plain variable it
works in place, two; and with one at a fixed address in the access bank, one. So between
preprocessor and compiler this makes of

    extern struct motion motion;            extern __at(0x2a) enum mode motion_mode; ...
    motion.mode = MODE_IDLE;                motion_mode = MODE_IDLE;

Names and meaning stay. Only objects are placed of which nothing but members is used: no pointers
to them, no variable index into an array of structs. Anything else is left as it was and then does
not compile.

    place_state.py layout MEMBERS... < all_headers.i > state.layout
        the places, as lines NAME ADDRESS BYTES: scalars in the order of the patterns that name
        them (joints.drive.*.position_ms), from ACCESS_BEGIN up, until the access bank is full
    place_state.py rewrite state.layout < module.i > module.placed.c
"""

import fnmatch
import re
import sys

# Below, sdcc has its registers; the report checks that they end here.
ACCESS_BEGIN = 0x0C
ACCESS_END = 0x80

BYTES = {"uint8_t": 1, "_Bool": 1, "uint16_t": 2, "int16_t": 2}

STRUCT = re.compile(r"\bstruct\s+(\w+)\s*\{([^{}]*)\}\s*;")
MEMBER = re.compile(r"((?:volatile\s+)?)((?:struct|enum)\s+\w+|\w+)\s+(\w+)\s*(?:\[([^\]]*)\])?\s*;")
OBJECT = re.compile(r"^[ \t]*((?:extern|static)[ \t]+)?struct[ \t]+(\w+)[ \t]+(\w+)[ \t]*;", re.M)


class Leaf:
    """One scalar, or array of scalars, of an object: `joints.drive[1].state`."""

    def __init__(self, path, of_type, array):
        self.path = path
        self.name = "_".join(path)
        self.of_type = of_type
        self.array = array

    def bytes(self):
        plain = self.of_type.replace("volatile ", "")
        return 1 if plain.startswith("enum ") else BYTES[plain]


def read_structs(text):
    structs = {}
    for name, body in STRUCT.findall(text):
        body = re.sub(r"^#.*$", "", body, flags=re.M)
        structs[name] = MEMBER.findall(body)
    return structs


def struct_of(member_type):
    words = member_type.split()
    return words[1] if words[0] == "struct" else None


def leaves_of(structs, struct, path):
    for volatile, member_type, name, array in structs[struct]:
        inner = struct_of(member_type)
        if inner is None:
            suffix = f"[{array}]" if array else ""
            yield Leaf(path + [name], volatile + member_type, suffix)
        elif array:
            for index in range(int(array.rstrip("uU"))):
                yield from leaves_of(structs, inner, path + [name, str(index)])
        else:
            yield from leaves_of(structs, inner, path + [name])


def layout(text, order):
    structs = read_structs(text)
    objects = {name: struct for _, struct, name in OBJECT.findall(text)}
    leaves = [leaf for name in objects for leaf in leaves_of(structs, objects[name], [name])]
    leaves = [leaf for leaf in leaves if not leaf.array]
    placed = set()
    address = ACCESS_BEGIN
    for pattern in order:
        for leaf in leaves:
            matches = fnmatch.fnmatchcase(".".join(leaf.path), pattern)
            if matches and leaf.name not in placed and address + leaf.bytes() <= ACCESS_END:
                print(f"{leaf.name} 0x{address:02X} {leaf.bytes()}")
                placed.add(leaf.name)
                address += leaf.bytes()


def rewrite(text, places):
    structs = read_structs(text)
    objects = {name: struct for _, struct, name in OBJECT.findall(text)}
    if not objects:
        return text
    leaves = {name: list(leaves_of(structs, struct, [name])) for name, struct in objects.items()}
    leaf_names = {leaf.name for some in leaves.values() for leaf in some}

    def declare(match):
        storage = match.group(1) or ""
        declarations = []
        for leaf in leaves[match.group(3)]:
            place = f"__at({places[leaf.name]}) " if leaf.name in places else ""
            declarations.append(f"{storage}{place}{leaf.of_type} {leaf.name}{leaf.array};")
        return " ".join(declarations)

    step = r"(?:\s*\.\s*\w+|\s*\[\s*\d+[uU]?\s*\])"
    use = rf"\b(?:{'|'.join(objects)}){step}*"

    def path_of(expression):
        expression = re.sub(r"\[\s*(\d+)[uU]?\s*\]", r".\1", re.sub(r"\s", "", expression))
        return expression.split(".")

    def struct_at(path):
        struct = objects[path[0]]
        for part in path[1:]:
            if part.isdigit():
                continue
            inner = [struct_of(kind) for _, kind, name, _ in structs[struct] if name == part]
            if not inner or inner[0] is None:
                return None
            struct = inner[0]
        return struct

    def copy(match):
        to, source = path_of(match.group(2)), path_of(match.group(3))
        struct = struct_at(to)
        if struct is None:
            return match.group(0)
        assignments = [
            f"{'_'.join(to)}_{leaf.name} = {'_'.join(source)}_{leaf.name};"
            for leaf in leaves_of(structs, struct, [])
        ]
        return match.group(1) + " ".join(assignments)

    def member(match):
        path = path_of(match.group(0))
        for end in range(len(path), 1, -1):
            name = "_".join(path[:end])
            if name in leaf_names:
                return name + "".join(f"[{index}]" for index in path[end:])
        return match.group(0)

    text = OBJECT.sub(declare, text)
    text = re.sub(rf"([;{{}}]\s*)({use})\s*=\s*({use})\s*;", copy, text)
    return re.sub(use, member, text)


def main(arguments):
    text = sys.stdin.read()
    if arguments[:1] == ["layout"]:
        layout(text, arguments[1:])
    elif arguments[:1] == ["rewrite"] and len(arguments) == 2:
        with open(arguments[1], encoding="utf-8") as file:
            places = dict(line.split()[:2] for line in file)
        sys.stdout.write(rewrite(text, places))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
