# SPDX-License-Identifier: GPL-2.0-or-later
"""Pins, memories and resets as on the chip."""

import unittest

from bridge import LockStep, bytes_of, image, of_kind

RCON, STKPTR, INTCON2, INTCON, TXSTA, RCSTA, TRISD, LATD, IPR1, PIE1, T2CON = (
    0xFD0, 0xFFC, 0xFF1, 0xFF2, 0xFAC, 0xFAB, 0xF95, 0xF8C, 0xF9F, 0xF9D, 0xFCA)
RESET_WHILE_WAITING = 360_000  # watchdog.asm: 18 ms, postscaler 1:2


class Pins(unittest.TestCase):
    def test_names_and_first_levels(self):
        with LockStep("echo") as chip:
            names = chip.value("pins").split(" ")
            self.assertTrue({"mclr", "ra0", "rb7", "rc6", "rc7", "rd0", "re2"} <= set(names))
            high = {name for name in names if chip.value(f"get {name}") == "1"}
        self.assertEqual(high, {"mclr", "rc6", "rc7", *(n for n in names if n[:2] in ("ra", "rb"))})

    def test_inputs_and_outputs(self):
        with LockStep("echo") as chip:
            self.assertEqual([edge[1:] for edge in of_kind(chip.ok("advance 100"), "edge")], [["rd1", "1"]])
            chip.ok("set rb0 0")
            self.assertEqual([edge[1:] for edge in of_kind(chip.ok("advance 100"), "edge")], [["rd1", "0"]])
            self.assertEqual(chip.value("get rd1"), "0")
            # An output wins against what is wired to it.
            chip.ok("set rd1 1")
            self.assertEqual(chip.value("get rd1"), "0")

    def test_a_closed_switch_wins_against_the_pull_up(self):
        with LockStep("echo") as chip:
            chip.ok("advance 100")
            chip.ok(f"register {INTCON2} 0x75")  # RBPU = 0
            chip.ok("set rb0 0")
            self.assertEqual(chip.value("register 0xF81"), "0xFE")
            self.assertEqual([edge[1:] for edge in of_kind(chip.ok("advance 100"), "edge")], [["rd1", "0"]])

    def test_an_input_does_not_follow_its_latch(self):
        with LockStep("echo") as chip:
            chip.ok("advance 100")
            chip.ok("register 0xF8A 0x00")  # LATB
            self.assertEqual(chip.value("register 0xF81"), "0xFF")  # PORTB


class Memories(unittest.TestCase):
    def test_eeprom(self):
        with LockStep("echo") as chip:
            self.assertEqual(chip.value("eeprom 255"), "0xFF")  # erased
            chip.ok("advance 1000")
            chip.ok("send E0")
            begin = 1000
            stamp = of_kind(chip.ok("advance 60000"), "byte")[0][0]
            self.assertGreater(stamp - begin, 40_000)  # a write takes 4 ms
            self.assertEqual(chip.value("eeprom 0"), "0x00")
            for cause in ("mclr", "power-on", "brown-out"):
                chip.ok(f"reset {cause}")
                chip.ok("advance 1000")
                self.assertEqual(chip.value("eeprom 0"), "0x00")
            chip.ok("eeprom 0 0x41")
            chip.ok("send E0")
            self.assertEqual(bytes_of(chip.ok("advance 60000")), b"\x42")

    def test_registers(self):
        with LockStep("echo") as chip:
            chip.ok("advance 1000")
            self.assertEqual(chip.value(f"register {TXSTA}"), "0x26")
            chip.ok("register 0x10 0xA5")
            self.assertEqual(chip.value("register 0x010"), "0xA5")


class Resets(unittest.TestCase):
    def resets(self, chip, cycles):
        return [tuple(event) for event in of_kind(chip.ok(f"advance {cycles}"), "reset")]

    def test_watchdog(self):
        with LockStep("watchdog") as chip:
            told = self.resets(chip, 1_000_000)
            self.assertEqual(told, [(RESET_WHILE_WAITING, "watchdog"), (2 * RESET_WHILE_WAITING, "watchdog")])
            self.assertEqual(chip.value("register 0x20"), "0x03")
            # LATD is RCON at the start: TO is 0 after the watchdog, POR and BOR as the program set them.
            self.assertEqual(int(chip.value(f"register {LATD}"), 16) & 0x0F, 0b0111)

    def test_watchdog_time(self):
        with LockStep("watchdog", "--watchdog-ms", "9") as chip:
            self.assertEqual(len(self.resets(chip, 1_000_000)), 5)

    def test_watchdog_off_in_a_record_at_an_odd_address(self):
        with open(image("odd_records")) as file:
            self.assertIn("300001"[2:], [line[3:7] for line in file])
        with LockStep("odd_records", "--watchdog-ms", "1") as chip:
            self.assertEqual(self.resets(chip, 5_000_000), [])

    def test_outputs_fall_with_the_reset(self):
        with LockStep("watchdog") as chip:
            chip.ok("advance 1000")
            edges = of_kind(chip.ok(f"advance {RESET_WHILE_WAITING - 999}"), "edge")
            self.assertEqual(edges[:3], [[RESET_WHILE_WAITING, pin, "0"] for pin in ("rd2", "rd3", "rd4")])

    def test_stack_and_reset_instruction(self):
        with LockStep("watchdog") as chip:
            chip.ok("set rb0 0")
            told = self.resets(chip, 200)
            self.assertEqual(told[0][1], "stack-overflow")
            self.assertEqual(int(chip.value(f"register {STKPTR}"), 16) & 0x80, 0x80)
        with LockStep("watchdog") as chip:
            chip.ok("set rb1 0")
            self.assertEqual(self.resets(chip, 20)[0][1], "instruction")
            self.assertEqual(int(chip.value(f"register {LATD}"), 16) & 0x10, 0)  # RI as found at the start

    def test_registers_after_a_reset(self):
        for cause in ("mclr", "brown-out", "power-on"):
            with LockStep("echo") as chip:
                chip.ok("advance 1000")
                for register in (INTCON, PIE1, T2CON):
                    chip.ok(f"register {register} 0xC0")
                chip.ok(f"register {IPR1} 0")
                chip.ok("register 0x20 0x77")
                chip.ok(f"reset {cause}")
                found = {r: int(chip.value(f"register {r}"), 16) for r in
                         (INTCON, PIE1, T2CON, IPR1, TXSTA, RCSTA, TRISD)}
                self.assertEqual(found, {INTCON: 0, PIE1: 0, T2CON: 0, IPR1: 0xFF, TXSTA: 2, RCSTA: 0, TRISD: 0xFF})
                if cause != "power-on":
                    self.assertEqual(chip.value("register 0x20"), "0x77")

    def test_brown_out_and_power_on_can_be_told_apart(self):
        with LockStep("watchdog") as chip:
            for cause, bits in (("brown-out", 0b1110), ("power-on", 0b1100)):
                chip.ok("advance 100")
                chip.ok(f"reset {cause}")
                self.assertEqual(int(chip.value(f"register {RCON}"), 16) & 0x0F, bits)

    def test_the_line_works_after_a_reset_while_sending(self):
        with LockStep("echo") as chip:
            chip.ok("advance 1000")
            for wait in (1700, 1900, 2300, 2811, 3300):
                chip.ok("send 55AA")
                chip.ok(f"advance {wait}")
                chip.ok("reset mclr")
                chip.ok("advance 10000")
                chip.ok("send 41")
                self.assertEqual(bytes_of(chip.ok("advance 10000")), b"A", wait)

    def test_mclr_pin_holds(self):
        with LockStep("steps") as chip:
            chip.ok("advance 1000")
            self.assertEqual(of_kind(chip.ok("set mclr 0"), "reset"), [[1000, "mclr"]])
            self.assertEqual(chip.ok("advance 10000"), [])
            chip.ok("set mclr 1")
            self.assertEqual(len(chip.ok("advance 1000")), 20)


class Compare(unittest.TestCase):
    def test_edges_of_the_compare_units(self):
        with LockStep("servo", "--processor", "p18f2321") as chip:
            edges = of_kind(chip.ok("advance 500000"), "edge")
        rise = edges[0][0]
        expected = []
        for begin in range(rise, 500_001, 6500):
            expected += [[begin, "rc2", "1"], [begin + 100, "rc1", "1"],
                         [begin + 1500, "rc2", "0"], [begin + 1600, "rc1", "0"]]
        self.assertEqual(edges, [edge for edge in expected if edge[0] <= 500_000])
        self.assertGreater(len(edges), 300)
