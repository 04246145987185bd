#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Compares what cppcheck and its MISRA addon find with the table of deviations in README.md.

    misra.py FINDINGS...            fails at a finding without a place in the table, and at a place
                                    in the table without a finding
    misra.py --update FINDINGS...   brings the table's second column up to date; reasons stay

FINDINGS are what cppcheck printed with the template `{file}:{line}: {id}: {message}`, one file for
each controller. A finding counts once, however many controllers, places of inclusion or
configurations it is seen in.
"""

import collections
import pathlib
import re
import sys

README = pathlib.Path(__file__).with_name("README.md")
FIRMWARE = README.parent.parent
BEGIN, END = "<!-- deviations -->", "<!-- end of deviations -->"
FINDING = re.compile(r"^(?P<file>[^:]+):(?P<line>\d+): (?P<id>[\w.-]+): (?P<message>.*)$")


def rule_of(identifier):
    """`15.5` for cppcheck's `misra-c2012-15.5`; cppcheck's own names stay as they are."""
    return identifier.removeprefix("misra-c2012-")


def read_findings(paths):
    """Lines of findings by (rule, file)."""
    found = collections.defaultdict(dict)
    for path in paths:
        for text in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
            match = FINDING.match(text)
            if not match:
                sys.exit(f"{path}: cppcheck says: {text}")
            file = pathlib.Path(match["file"])
            if file.is_absolute():
                file = file.relative_to(FIRMWARE)
            line = int(match["line"])
            found[rule_of(match["id"]), str(file)][line] = match["message"]
    return found


def read_table(text):
    """Rows as [rule, {file: count}, reason]."""
    rows = []
    for line in text.splitlines()[2:]:
        rule, where, reason = (cell.strip() for cell in line.strip().strip("|").split("|"))
        places = {}
        for place in filter(None, where.split(", ")):
            file, _, count = place.rpartition(" ")
            places[file] = int(count)
        rows.append([rule, places, reason])
    return rows


def update(before, text, after, found):
    rows = read_table(text)
    for row in rows:
        places = sorted((file, len(lines)) for (rule, file), lines in found.items() if rule == row[0])
        row[1] = ", ".join(f"{file} {count}" for file, count in places)
    head = text.splitlines()[:2]
    body = [f"| {rule} | {where} | {reason} |" for rule, where, reason in rows if where]
    README.write_text(before + BEGIN + "\n" + "\n".join(head + body) + "\n" + END + after, "utf-8")
    missing = sorted({rule for rule, _ in found} - {row[0] for row in rows})
    if missing:
        sys.exit(f"no reason in the table yet for: {', '.join(missing)}")


def main(arguments):
    is_update = arguments[:1] == ["--update"]
    found = read_findings(arguments[is_update:])
    before, rest = README.read_text("utf-8").split(BEGIN)
    table, after = rest.split(END)
    if is_update:
        update(before, table.strip(), after, found)
        return
    allowed = {(rule, file): count for rule, places, _ in read_table(table.strip()) for file, count in places.items()}
    wrong = 0
    for key in sorted(found.keys() | allowed.keys()):
        rule, file = key
        lines = found.get(key, {})
        if len(lines) == allowed.get(key, 0):
            continue
        wrong += 1
        print(f"{rule} in {file}: {len(lines)} found, {allowed.get(key, 0)} in the table of README.md")
        for line, message in sorted(lines.items()):
            print(f"    {file}:{line}: {message}")
    if wrong:
        sys.exit("fix it, or give its reason in firmware-pic/check/README.md (make misra-update counts anew)")
    total = sum(map(len, found.values()))
    print(f"misra: {total} deviations from {len({rule for rule, _ in found})} rules, each with its reason")


main(sys.argv[1:])
