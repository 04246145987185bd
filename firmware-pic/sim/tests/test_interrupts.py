# SPDX-License-Identifier: GPL-2.0-or-later
"""Interrupts seen from outside: what a measurement of the firmware's timing rests on."""

import unittest

from bridge import BIT, LockStep, bytes_of, of_kind

TICK = 10_000  # cycles of 1 ms


class Interrupts(unittest.TestCase):
    def setUp(self):
        self.chip = LockStep("interrupts")
        self.addCleanup(self.chip.__exit__)
        for address, name in ((0x08, "high"), (0x18, "low"), (0x40, "low-end"), (0x60, "high-end")):
            self.chip.ok(f"mark {address} {name}")

    def test_tick(self):
        events = self.chip.ok(f"advance {20 * TICK + 100}")
        entries = [cycle for cycle, name in of_kind(events, "mark") if name == "low"]
        edges = [cycle for cycle, *_ in of_kind(events, "edge")]
        self.assertEqual([cycle - entries[0] for cycle in entries], [TICK * n for n in range(20)])
        # btfss, bcf (skipped onto), btg: the edge comes in the fourth cycle of the routine.
        self.assertEqual([edge - entry for entry, edge in zip(entries, edges)], [3] * 20)

    def test_reception_interrupts_quickly(self):
        self.chip.ok("advance 1000")
        self.chip.ok("send 414243")
        events = self.chip.ok("advance 8000")
        self.assertEqual(bytes_of(events), b"ABC")
        heard = [cycle for [cycle] in of_kind(events, "heard")]
        entries = [cycle for cycle, name in of_kind(events, "mark") if name == "high"]
        for stop_bit, entry in zip(heard, entries):
            self.assertTrue(0 < entry - stop_bit < BIT / 2, (stop_bit, entry))

    def test_change_of_a_pin(self):
        self.chip.ok("advance 1000")
        for level in (0, 1, 0):
            now = int(self.chip.value("cycles"))
            self.chip.ok(f"set rb4 {level}")
            entries = [cycle for cycle, name in of_kind(self.chip.ok("advance 100"), "mark") if name == "low"]
            self.assertEqual(len(entries), 1)
            self.assertLessEqual(entries[0] - now, 4)
        self.chip.ok("set rb0 0")  # causes none
        self.assertEqual(of_kind(self.chip.ok("advance 100"), "mark"), [])

    def test_high_priority_interrupts_low(self):
        """A byte that comes while the tick's routine runs does not wait for its end."""
        first = self.chip.ok(f"advance {2 * TICK}")
        tick = next(cycle for cycle, name in of_kind(first, "mark") if name == "low")
        latencies, within = set(), 0
        for number in range(1, 41):
            # The cause comes about 40 cycles around the entry of tick number `2 * number`.
            at = tick + 2 * number * TICK - int(9.75 * BIT) - 20 + number
            self.chip.ok(f"send 41 {at}")
            events = self.chip.ok(f"advance {tick + (2 * number + 1) * TICK - int(self.chip.value('cycles'))}")
            [[heard]] = of_kind(events, "heard")
            names = of_kind(events, "mark")
            [entry] = [cycle for cycle, name in names if name == "high"]
            latencies.add(entry - heard)
            around = [name for cycle, name in names if abs(cycle - entry) < 60]
            within += "low" in around and around.index("low") < around.index("high") < around.index("low-end")
        self.assertGreater(within, 3)
        self.assertLessEqual(max(latencies) - min(latencies), 4, sorted(latencies))
