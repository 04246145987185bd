# SPDX-License-Identifier: GPL-2.0-or-later
"""The program around the chip: its terminal, its socket, its errors, its ways out."""

import os
import select
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from bridge import PROGRAM, FreeRun, LockStep, ask, image, run_to_its_end


def read_exactly(terminal, count):
    received = b""
    end = time.monotonic() + 10
    while len(received) < count and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            received += os.read(terminal, 4096)
    return received


class Free(unittest.TestCase):
    def test_terminal_end_to_end(self):
        data = bytes(range(256)).replace(b"\xb0", b"").replace(b"\xe0", b"") * 4
        for options in ((), ("--fast",)):
            with FreeRun("echo", *options) as board:
                terminal = os.open(board.link, os.O_RDWR | os.O_NOCTTY)
                begin = time.monotonic()
                os.write(terminal, data)
                self.assertEqual(read_exactly(terminal, len(data)), data)
                if not options:  # paced: not before the line could carry it
                    self.assertGreater(time.monotonic() - begin, 0.9 * len(data) * 10 / 57600)
                os.close(terminal)

    def test_clients_of_the_socket(self):
        with FreeRun("echo") as board:
            for level in ("1", "0", "1"):  # one after the other
                with board.connect() as client:
                    self.assertEqual(ask(client, f"set rb0 {level}"), ([], "ok"))
                    time.sleep(0.02)
                    self.assertEqual(ask(client, "get rd1"), ([], f"ok {level}"))
                    self.assertTrue(ask(client, "advance 10")[1].startswith("error "))
            with board.connect() as first, board.connect() as second:  # and side by side
                self.assertEqual(ask(first, "watch rd1"), ([], "ok"))
                self.assertEqual(ask(second, "get rb0"), ([], "ok 1"))
                ask(first, "set rb0 0")
                time.sleep(0.02)
                events, _ = ask(first, "cycles")
                self.assertEqual([event.split(" ")[2:] for event in events], [["rd1", "0"]])
                self.assertEqual(ask(second, "quit"), ([], "ok"))
            self.assertEqual(board.process.wait(timeout=10), 0)

    def test_pace(self):
        with FreeRun("steps") as board, board.connect() as client:
            def sample():
                return time.monotonic(), int(ask(client, "cycles")[1].split(" ")[1])
            (t0, c0), _, (t1, c1) = sample(), time.sleep(1), sample()
        self.assertAlmostEqual((c1 - c0) / (t1 - t0) / 10e6, 1, delta=0.03)

    def test_signals_and_leftovers(self):
        for end in (signal.SIGINT, signal.SIGTERM):
            with FreeRun("echo") as board:
                self.assertTrue(os.path.islink(board.link))
                board.process.send_signal(end)
                self.assertEqual(board.process.wait(timeout=10), 0)
                self.assertEqual(os.listdir(board.folder.name), [])

    def test_stale_leftovers_are_replaced(self):
        with FreeRun("echo") as board:
            board.process.kill()
            board.process.wait()
            self.assertEqual(len(os.listdir(board.folder.name)), 2)
            again = subprocess.Popen([PROGRAM, "--hex", image("echo"), "--pty", board.link, "--control",
                                      board.socket_path], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                time.sleep(0.5)
                with board.connect() as client:
                    self.assertEqual(ask(client, "get mclr"), ([], "ok 1"))
                status, said = run_to_its_end("--hex", image("echo"), "--control", board.socket_path)
                self.assertEqual((status, len(said)), (2, 1))
                self.assertIn("another program listens", said[0])
            finally:
                again.terminate()
                again.wait(timeout=10)
            self.assertEqual(os.listdir(board.folder.name), [])

    def test_foreign_files_are_left_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            foreign = os.path.join(folder, "diary")
            with open(foreign, "w") as file:
                file.write("dear diary")
            link = os.path.join(folder, "link")
            os.symlink(foreign, link)
            for option, path in (("--pty", foreign), ("--control", foreign), ("--pty", link), ("--control", link)):
                status, said = run_to_its_end("--hex", image("echo"), option, path)
                self.assertEqual((status, len(said)), (2, 1), said)
            self.assertEqual(open(foreign).read(), "dear diary")
            self.assertEqual(sorted(os.listdir(folder)), ["diary", "link"])

    def test_limit(self):
        status, said = run_to_its_end("--hex", image("steps"), "--fast", "--limit-s", "0.5")
        self.assertEqual(status, 0)
        self.assertIn("5000000 cycles", said[0])


class Errors(unittest.TestCase):
    def test_options(self):
        echo = image("echo")
        for options in ((), ("--lockstep",), ("--hex", "/nowhere.hex", "--lockstep"), ("--hex", echo),
                        ("--hex", echo, "--lockstep", "--processor", "p18f9999"),
                        ("--hex", echo, "--lockstep", "--processor", "p16f877"),
                        ("--hex", echo, "--lockstep", "--baud", "fast"), ("--hex", echo, "--lockstep", "--pty", "x"),
                        ("--hex", echo, "--lockstep", "--tx-pin", "rz9"), ("--hex", echo, "--lockstep", "--clock-mhz"),
                        ("--hex", echo, "--lockstep", "--symbols", "/nowhere"), ("--hex", echo, "--frob")):
            status, said = run_to_its_end(*options)
            self.assertEqual((status, len(said)), (2, 1), (options, said))
            self.assertTrue(said[0].startswith("rsapien-gpsim: "), said)

    def test_images(self):
        bad = {"no record\n": "no Intel HEX", ":00000001F\n": "no Intel HEX", ":020000000000FF\n": "checksum",
               ":020000000000FE\n": "end record", ":00000001FF\n": "no program",
               ":020000000000FE\n:020000040001F9\n:020000000000FE\n:00000001FF\n": "0x10000",
               ":020000000000FE\n:0200000400F00A\n:020100000000FD\n:00000001FF\n": "0xF00100"}
        for text, why in bad.items():
            with tempfile.NamedTemporaryFile("w", suffix=".hex") as file:
                file.write(text)
                file.flush()
                status, said = run_to_its_end("--hex", file.name, "--lockstep")
                self.assertEqual((status, len(said)), (2, 1), said)
                self.assertIn(why, said[0])

    def test_bad_commands(self):
        commands = ["", " ", "frob", "advance", "advance -1", "advance x", "advance 1 2", "advance 99999999999999",
                    "advance 0x", "get", "get rz0", "set rb0", "set rb0 2", "set rb0 1 1", "send", "send 4", "send 4g",
                    "send 41 x", "send 41 99999999999999999999", "send-framing", "mark 0x21 odd", "mark nowhere x",
                    "mark 0x7FFE blank", "mark 0x999999 far", "unmark none", "register", "register 0x5000",
                    "register 0x700", "register 0x20 256", "eeprom 256", "eeprom 0 256", "reset", "reset hard",
                    "watch", "watch rb0 rz1", "pins all", "symbols x", "cycles 1", "\x00\xff", "get " + "x" * 5000]
        with LockStep("echo") as chip:
            chip.ok("mark 0x20 twice")
            commands.append("mark 0x20 twice")
            for command in commands:
                events, final = chip.ask(command)
                self.assertTrue(final.startswith("error ") and len(final) > 8, (command, final))
                self.assertEqual(events, [])
            self.assertEqual(chip.value("advance 10"), "10")

    def test_a_line_without_end(self):
        with LockStep("echo") as chip:
            _, final = chip.ask("get " + "x" * (3 << 20))
            self.assertTrue(final.startswith("error "))
            self.assertEqual(chip.value("advance 10"), "10")

    def test_a_program_that_runs_astray(self):
        # echo.asm on a chip without port D.
        with LockStep("echo", "--processor", "p18f2321") as chip:
            events, final = chip.ask("advance 1000")
            self.assertTrue(events[-1].startswith("halt "), events)
            self.assertTrue(final.startswith("error gpsim stopped at cycle "), final)
            self.assertEqual(chip.ask("advance 5")[1], final)
            self.assertEqual(chip.value("get rb0"), "1")
            chip.ok("reset power-on")
            self.assertTrue(chip.ask("advance 1000")[1].startswith("error gpsim stopped"))

    def test_stdout_holds_answers_alone(self):
        for option in ((), ("--verbose",)):
            ended = subprocess.run([PROGRAM, "--hex", image("watchdog"), "--lockstep", *option],
                                   input="advance 400000\nquit\n", capture_output=True, text=True, timeout=60)
            self.assertEqual(ended.returncode, 0)
            kinds = {line.split(" ")[0] for line in ended.stdout.splitlines()}
            self.assertEqual(kinds, {"edge", "reset", "ok"})
            self.assertEqual(bool(ended.stderr), bool(option))

    def test_no_file_is_left_where_it_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            ended = subprocess.run([PROGRAM, "--hex", image("watchdog"), "--lockstep"], cwd=folder, text=True,
                                   input="mark 0x20 start\nadvance 400000\nunmark start\nadvance 10\nquit\n",
                                   capture_output=True, timeout=60)
            self.assertEqual(ended.returncode, 0)
            self.assertIn("mark 360003 start", ended.stdout)
            self.assertEqual(os.listdir(folder), [])
