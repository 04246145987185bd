# SPDX-License-Identifier: GPL-2.0-or-later
"""The serial line, bit by bit."""

import random
import unittest

from bridge import BIT, LockStep, bytes_of, of_kind

CHIP_BIT = 172  # SPBRG 42 at 40 MHz: 58140 baud


def cycle_at(time):
    """The nearest cycle, the later one of two."""
    return int(time + 0.5)


class Line(unittest.TestCase):
    def test_echo_at_full_speed(self):
        # Both directions at once, without a gap, nothing lost; the chip is 0.94 % faster than the line.
        choice = random.Random(1)
        data = bytes(choice.choice([b for b in range(256) if b not in (0xB0, 0xE0)]) for _ in range(5000))
        with LockStep("echo") as chip:
            chip.ok("advance 1000")
            chip.ok("send " + data.hex())
            events = chip.ok(f"advance {round(5010 * 10 * BIT)}")
        self.assertEqual(bytes_of(events), data)
        heard = [cycle for [cycle] in of_kind(events, "heard")]
        self.assertEqual(len(heard), len(data))
        # Fractions of a cycle do not add up: each byte is where the line's rate puts it.
        for number, cycle in enumerate(heard):
            self.assertLessEqual(abs(cycle - (1001 + (10 * number + 9.5) * BIT)), 1)
        self.assertEqual(of_kind(events, "framing"), [])

    def test_stamps_are_the_middle_of_the_stop_bit(self):
        with LockStep("echo") as chip:
            chip.ok("watch rc6 rc7")
            chip.ok("advance 1000")
            chip.ok("send 55 3000")
            events = chip.ok("advance 8000")
        in_edges = [event[0] for event in of_kind(events, "edge") if event[1] == "rc7"]
        out_edges = [event[0] for event in of_kind(events, "edge") if event[1] == "rc6"]
        self.assertEqual(in_edges, [cycle_at(3000 + bit * BIT) for bit in range(10)])
        self.assertEqual(of_kind(events, "heard"), [[cycle_at(3000 + 9.5 * BIT)]])
        self.assertEqual([b - a for a, b in zip(out_edges, out_edges[1:])], [CHIP_BIT] * 9)
        [[stamp, byte]] = of_kind(events, "byte")
        self.assertEqual(byte, "55")
        self.assertEqual(stamp, cycle_at(out_edges[0] + 9.5 * BIT))

    def test_framing_errors_towards_the_chip(self):
        with LockStep("echo") as chip:
            chip.ok("advance 1000")
            chip.ok("send 41")
            chip.ok("send-framing 42")
            chip.ok("send 43")
            events = chip.ok("advance 10000")
            self.assertEqual(bytes_of(events), bytes([0x41, 0xEE, 0x43]))
            # The line idles for one bit after the missing stop bit.
            heard = [cycle for [cycle] in of_kind(events, "heard")]
            self.assertEqual([round((b - a) / BIT) for a, b in zip(heard, heard[1:])], [10, 11])

    def test_framing_errors_from_the_chip(self):
        with LockStep("echo") as chip:
            chip.ok("advance 1000")
            chip.ok("send B0")
            events = chip.ok("advance 30000")
            self.assertEqual(len(of_kind(events, "framing")), 1)
            chip.ok("send 44")
            self.assertEqual(bytes_of(chip.ok("advance 10000")), b"\x44")

    def test_a_wrong_rate_is_noticed(self):
        with LockStep("echo", "--baud", "54900") as chip:  # 5.9 % slower than the chip
            chip.ok("advance 1000")
            chip.ok("send 55AA00FF")
            events = chip.ok("advance 20000")
        self.assertNotEqual(bytes_of(events), bytes([0x55, 0xAA, 0x00, 0xFF]))

    def test_at_cycle_and_queue(self):
        with LockStep("echo") as chip:
            chip.ok("send 01 5000")
            chip.ok("send 02")       # behind the one before
            chip.ok("send 03 20000")
            heard = [cycle for [cycle] in of_kind(chip.ok("advance 25000"), "heard")]
        self.assertEqual(heard, [cycle_at(5000 + 9.5 * BIT), cycle_at(5000 + 19.5 * BIT), cycle_at(20000 + 9.5 * BIT)])

    def receive_unread(self, *commands):
        """What `fifo` finds in the registers after bytes that nothing read: FERR and RCREG twice, then OERR."""
        with LockStep("fifo") as chip:
            chip.ok("advance 100")
            for command in commands:
                chip.ok(command)
            chip.ok("advance 10000")
            chip.ok("set rb0 0")
            chip.ok("advance 100")
            status = [int(chip.value(f"register {0x20 + i}"), 16) for i in range(3)]
            data = [int(chip.value(f"register {0x10 + i}"), 16) for i in range(2)]
            # Two more bytes behind it: not received while OERR stands.
            chip.ok("send 5152")
            chip.ok("advance 6000")
            more = int(chip.value("register 0xF9E"), 16) & 0x20  # RCIF
            return [(bool(s & 4), d) for s, d in zip(status, data)], bool(status[2] & 2), bool(more)

    def test_fifo_and_overrun(self):
        good, bad = False, True
        self.assertEqual(self.receive_unread("send 4142"), ([(good, 0x41), (good, 0x42)], False, True))
        self.assertEqual(self.receive_unread("send-framing C1", "send 42"), ([(bad, 0xC1), (good, 0x42)], False, True))
        self.assertEqual(self.receive_unread("send 41", "send-framing 82"), ([(good, 0x41), (bad, 0x82)], False, True))
        self.assertEqual(self.receive_unread("send 414243"), ([(good, 0x41), (good, 0x42)], True, False))

    def test_a_byte_written_when_the_one_before_ends(self):
        # pair.asm writes the second byte in each cycle of the time in which the first one's stop bit begins and ends.
        with LockStep("pair") as chip:
            chip.ok("advance 1000")
            for later in range(9 * CHIP_BIT - 50, 11 * CHIP_BIT):
                chip.ok(f"register 0x20 {later // 12}")
                chip.ok(f"register 0x21 {later % 12}")
                chip.ok("set rb0 0")
                chip.ok("advance 10")
                chip.ok("set rb0 1")
                self.assertEqual(bytes_of(chip.ok("advance 5507")), b"AB", later)

    def test_other_clocks_and_rates(self):
        data = bytes(byte for byte in range(256) if byte not in (0xB0, 0xE0))
        for clock_mhz, baud, divisor in ((4, 19200, 12), (10, 38400, 15), (20, 57600, 21), (40, 115200, 21),
                                         (40, 19200, 129)):
            with LockStep("echo", "--clock-mhz", str(clock_mhz), "--baud", str(baud)) as chip:
                chip.ok("advance 1000")
                chip.ok(f"register 0xFAF {divisor}")  # SPBRG
                chip.ok("advance 3000")
                chip.ok("send " + data.hex())
                events = chip.ok(f"advance {260 * 10 * clock_mhz * 250_000 // baud}")
                self.assertEqual(bytes_of(events), data, (clock_mhz, baud))
