# SPDX-License-Identifier: GPL-2.0-or-later
"""Time, edges and marks: exact to the cycle and the same at every run."""

import random
import tempfile
import unittest

from bridge import LockStep, of_kind

# tests/steps.asm: RD0 rises first in cycle 4, then every 100 cycles, and is high for 40.
FIRST_EDGE, PERIOD, HIGH = 4, 100, 40


class Time(unittest.TestCase):
    def test_advance_is_exact(self):
        with LockStep("steps") as chip:
            self.assertEqual(chip.value("cycles"), "0")
            expected = 0
            for step in random.Random(5).choices(range(1, 400), k=300):
                expected += step
                self.assertEqual(chip.value(f"advance {step}"), str(expected))
            self.assertEqual(chip.value("advance 0"), str(expected))

    def test_edges_to_the_cycle(self):
        with LockStep("steps") as chip:
            edges = of_kind(chip.ok("advance 100000"), "edge")
        expected = []
        for begin in range(FIRST_EDGE, 100001, PERIOD):
            expected += [[begin, "rd0", "1"], [begin + HIGH, "rd0", "0"]]
        self.assertEqual(edges, [edge for edge in expected if edge[0] <= 100000])

    def test_pieces_tell_what_the_whole_tells(self):
        with LockStep("steps") as whole, LockStep("steps") as pieces:
            expected = whole.ok("advance 5000")
            told = []
            for _ in range(5000):
                told += pieces.ok("advance 1")
        self.assertEqual(told, expected)

    def test_same_commands_same_answers(self):
        commands = ["advance 1000", "mark 0x28 second", "send 4142434445E0", "advance 7003", "set rb0 0",
                    "send-framing 11 12000", "advance 9001", "register 0xFAE", "reset mclr", "advance 777",
                    "send FF00FF", "advance 100003", "eeprom 0", "reset brown-out", "advance 50000"]
        told = []
        for _ in range(2):
            with LockStep("echo") as chip:
                told.append([chip.ask(command) for command in commands])
        self.assertEqual(told[0], told[1])
        self.assertGreater(sum(len(events) for events, _ in told[0]), 20)

    def test_resets_within_any_instruction(self):
        # 7 cycles and 127 a round: every phase of the loop, the inside of two-cycle instructions, too.
        for cause in ("power-on", "brown-out", "mclr"):
            with LockStep("steps") as chip:
                for _ in range(PERIOD):
                    chip.ok("advance 7")
                    [[cycle, told]] = of_kind(chip.ok(f"reset {cause}"), "reset")
                    self.assertEqual(told, cause)
                    rise = of_kind(chip.ok("advance 120"), "edge")[0]
                    self.assertEqual(rise, [cycle + 5, "rd0", "1"])

    def test_watch(self):
        with LockStep("steps") as chip:
            chip.ok("watch rd1")
            self.assertEqual(chip.ok("advance 1000"), [])
            chip.ok("watch rb3 portd0")
            self.assertEqual(len(chip.ok("advance 1000")), 20)
            self.assertEqual(chip.ok("set rb3 0"), [f"edge 2000 rb3 0"])
            chip.ok("watch none")
            self.assertEqual(chip.ok("advance 1000"), [])
            chip.ok("watch outputs")
            self.assertEqual(chip.ok("set rb3 1"), [])
            self.assertEqual(len(chip.ok("advance 1000")), 20)


class Marks(unittest.TestCase):
    def test_cycles_of_marks(self):
        with LockStep("steps") as chip:
            chip.ok("mark 0x24 rise")
            chip.ok("mark 0x24 top")
            marks = of_kind(chip.ok("advance 1000"), "mark")
            self.assertEqual(marks, [[cycle, name] for cycle in range(4, 1000, 100) for name in ("rise", "top")])
            chip.ok("unmark rise")
            self.assertEqual(of_kind(chip.ok("advance 100"), "mark"), [[1004, "top"]])
            chip.ok("unmark top")
            self.assertEqual(of_kind(chip.ok("advance 100"), "mark"), [])

    def test_marks_change_nothing(self):
        # Marks on all instructions: skipped ones, both halves of calls and gotos, the table of vectors.
        with LockStep("echo") as plain, LockStep("echo") as marked:
            count = 0
            for address in [0, *range(0x20, 0xB0, 2)]:
                _, final = marked.ask(f"mark {address} m{address:x}")
                count += final == "ok"
            self.assertGreater(count, 50)
            told = []
            for chip in (plain, marked):
                chip.ok("advance 500")
                chip.ok("send 0102B003E004")
                chip.ok("set rb0 0")
                events = chip.ok("advance 90000")
                told.append([event for event in events if not event.startswith("mark ")])
        self.assertEqual(told[0], told[1])
        self.assertIn("framing", " ".join(told[0]))

    def test_symbols(self):
        gplink_map = ("gplink-1.4.0\n"
                      "                     Name    Address   Location    Storage File\n"
                      "                    _loop   0x000024    program     extern main.c\n"
                      "                   _count   0x000010       data     static main.c\n")
        names = "# places\n_loop 24\n_count 0x0010\n"
        for text, others in ((gplink_map, ["data-symbol _count 0x010"]), (names, ["symbol _count 0x000010"])):
            with tempfile.NamedTemporaryFile("w", suffix=".map") as file:
                file.write(text)
                file.flush()
                with LockStep("steps", "--symbols", file.name) as chip:
                    self.assertEqual(sorted(chip.ok("symbols")), sorted(["symbol _loop 0x000024", *others]))
                    chip.ok("mark _loop rise")
                    self.assertEqual(of_kind(chip.ok("advance 110"), "mark"), [[4, "rise"], [104, "rise"]])
                    chip.ok("register _count 7")
                    self.assertEqual(chip.value("register 0x10"), "0x07")
