#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Prints what is reached of core/, and compares what is not with unreached.txt.

    check.py COVERAGE.json...      one of each controller, as gcovr writes them

A source that is included once for each joint or axis counts once: gcovr adds its inclusions up. A
source of both controllers is reached where either reaches it. unreached.txt names one place a line:

    FILE | line, or branch of N | the source line, blanks squeezed | reason
"""

import collections
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).parent
CORE = HERE.parent.parent / "core"
LIST = HERE / "unreached.txt"


def read(paths):
    """Counts by (file, line), and by (file, line, branch)."""
    lines, branches = collections.Counter(), collections.Counter()
    for path in paths:
        for file in json.loads(pathlib.Path(path).read_text("utf-8"))["files"]:
            name = pathlib.Path(file["file"]).name
            for line in file["lines"]:
                if line.get("gcovr/noncode"):
                    continue
                key = name, line["line_number"]
                lines[key] += line["count"]
                for index, branch in enumerate(line["branches"]):
                    branches[*key, index] += branch["count"]
    return lines, branches


def unreached(lines, branches):
    """(file, what, source line) of every place that nothing reaches."""
    sources = {}
    places = collections.Counter()
    for key, count in [*lines.items(), *branches.items()]:
        name, number, *branch = key
        if count or branch and not lines[name, number]:
            continue
        if name not in sources:
            sources[name] = (CORE / name).read_text("utf-8").splitlines()
        text = " ".join(sources[name][number - 1].split())
        places[name, "branch" if branch else "line", text] += 1
    return places


def read_list():
    places = collections.Counter()
    for line in LIST.read_text("utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        name, what, rest = (cell.strip() for cell in line.split(" | ", 2))
        text, reason = (cell.strip() for cell in rest.rsplit(" | ", 1))
        if not reason:
            sys.exit(f"{LIST.name}: no reason: {line}")
        places[name, what, text] += 1
    return places


def main(paths):
    lines, branches = read(paths)
    print(f"{'core/':20} {'lines':>11} {'branches':>11}")
    for name in [*sorted({key[0] for key in lines}), "all"]:
        row = ""
        for counts in (lines, branches):
            of = [count for key, count in counts.items() if name in ("all", key[0])]
            row += f" {sum(map(bool, of)):>5}/{len(of):<5}"
        print(f"{name:20}{row}")
    found, listed = unreached(lines, branches), read_list()
    for place in sorted((found - listed).elements()):
        print(f"not reached, and not in coverage/unreached.txt: {' | '.join(place)}")
    for place in sorted((listed - found).elements()):
        print(f"in coverage/unreached.txt, but reached: {' | '.join(place)}")
    if found != listed:
        sys.exit(1)
    print(f"coverage: {sum(found.values())} places are not reached, each with its reason")


main(sys.argv[1:])
