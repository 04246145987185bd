# SPDX-License-Identifier: GPL-2.0-or-later
"""The bridge as its tests use it: a process in lock step, or one that runs free."""

import os
import socket
import subprocess
import sys
import tempfile
import time

OUT = os.path.abspath(os.environ.get("RSAPIEN_GPSIM_OUT", "../../target/firmware/sim"))
PROGRAM = os.path.join(OUT, "rsapien-gpsim")
CYCLES_PER_SECOND = 10_000_000
BAUD = 57_600
BIT = CYCLES_PER_SECOND / BAUD


def image(name):
    return os.path.join(OUT, "tests", name + ".hex")


def run_to_its_end(*options):
    """Runs the bridge with these options; its status and the lines on stderr."""
    ended = subprocess.run([PROGRAM, *options], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    return ended.returncode, ended.stderr.splitlines()


def is_final(line):
    return line.split(" ")[0] in ("ok", "error")


class LockStep:
    """Commands on stdin; each call gives the event lines and the final line."""

    def __init__(self, name, *options):
        self.process = subprocess.Popen(
            [PROGRAM, "--hex", image(name), "--lockstep", *options],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(timeout=10)
        self.process.stdout.close()

    def ask(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        events = []
        while True:
            line = self.process.stdout.readline()
            if not line:
                raise EOFError("the bridge ended at: " + command)
            line = line.rstrip("\n")
            if is_final(line):
                return events, line
            events.append(line)

    def ok(self, command):
        """Event lines of a command that must succeed."""
        events, final = self.ask(command)
        assert final.startswith("ok"), (command, final)
        return events

    def value(self, command):
        """What stands behind `ok`."""
        _, final = self.ask(command)
        assert final.startswith("ok "), (command, final)
        return final[3:]


class FreeRun:
    """A paced bridge with a terminal and a control socket in a folder of its own."""

    def __init__(self, name, *options):
        self.folder = tempfile.TemporaryDirectory()
        self.link = os.path.join(self.folder.name, "line")
        self.socket_path = os.path.join(self.folder.name, "control")
        self.process = subprocess.Popen(
            [PROGRAM, "--hex", image(name), "--pty", self.link, "--control", self.socket_path, *options],
            stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 10
        while not os.path.exists(self.socket_path):
            assert time.monotonic() < end and self.process.poll() is None, "the bridge does not come up"
            time.sleep(0.01)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.terminate()
        self.process.wait(timeout=10)
        self.process.stderr.close()
        self.folder.cleanup()

    def connect(self):
        client = socket.socket(socket.AF_UNIX)
        client.settimeout(10)
        client.connect(self.socket_path)
        return client


def ask(client, command):
    """A command on the control socket: event lines and the final line."""
    client.sendall((command + "\n").encode())
    received = b""
    while not (received.endswith(b"\n") and is_final(received.decode().splitlines()[-1])):
        part = client.recv(65536)
        assert part, "the bridge closed the connection"
        received += part
    lines = received.decode().splitlines()
    return lines[:-1], lines[-1]


def of_kind(events, kind):
    """Events of one kind as lists of words, the cycle as a number."""
    words = [line.split(" ") for line in events]
    return [[int(w[1]), *w[2:]] for w in words if w[0] == kind]


def bytes_of(events):
    return bytes(int(event[1], 16) for event in of_kind(events, "byte"))


if not os.path.exists(PROGRAM):
    sys.exit("the bridge is not built: " + PROGRAM)
