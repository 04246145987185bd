"""Several threads and programs that want one robot."""

import subprocess
import sys
import threading
import time

import pytest

import rsapien

ARMS = rsapien.Action.parse(
    "action arms { repeat 3 { do right-arm-up + left-arm-up for 1s do right-arm-front + left-arm-front for 1s } }"
)
LEAN = rsapien.Action.parse("action lean { do tilt-left for 500ms do tilt-mid for 500ms }")


@pytest.fixture
def robot():
    with rsapien.Robot.virtual(seed=3, fast=True) as robot:
        robot.init()
        yield robot


def in_background(work):
    """Runs work in a thread; a function that waits for what it gives."""
    ended = []
    thread = threading.Thread(target=lambda: ended.append(work()))
    thread.start()

    def wait():
        thread.join()
        return ended[0]

    return wait


def test_policies_between_threads(robot):
    robot.pause()
    begun = threading.Event()
    arms = in_background(lambda: robot.play(ARMS, on_admission=lambda word, text: begun.set()))
    assert begun.wait(10)
    with pytest.raises(rsapien.ControllerHeld, match="both need right-arm"):
        robot.play("wave", policy="merge")
    with pytest.raises(rsapien.ControllerHeld, match="arms of python"):
        robot.do("tilt-left")
    with pytest.raises(ValueError, match="refuse, queue, replace, merge"):
        robot.play(LEAN, policy="push")
    told = []
    robot.resume()
    lean = robot.play(LEAN, policy="merge", on_admission=lambda *words: told.append(words))
    assert lean
    assert arms()
    # The arms may have been done already: their clock is the computer's pace.
    assert told[0][0] in ("beside", "begins")


def test_replacing_ends_the_other(robot):
    robot.pause()
    begun = threading.Event()
    arms = in_background(lambda: robot.play(ARMS, on_admission=lambda word, text: begun.set()))
    assert begun.wait(10)
    told = []

    def admitted(word, text):
        told.append(word)
        robot.resume()

    assert robot.play(LEAN, policy="replace", on_admission=admitted)
    ended = arms()
    assert not ended and "replaced" in ended.text and told == ["replaces"]


def test_a_guest_of_another_program(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    link = str(tmp_path / "robot")
    command = [sys.executable, "-m", "rsapien"]
    simulator = subprocess.Popen([*command, "sim", "--pty", link], stdout=subprocess.PIPE)
    try:
        simulator.stdout.readline()
        assert rsapien.Guest.find(link) is None
        with rsapien.Robot.open(link) as robot:
            robot.init()
            wave = in_background(lambda: robot.play("wave", times=2))
            run = subprocess.run(
                [*command, "--link", link, "do", "tilt-left:300", "tilt-mid", "--policy", "merge"],
                capture_output=True, text=True, timeout=60,
            )
            assert run.returncode == 0, run.stderr
            assert "begins beside wave of python" in run.stdout
            assert wave()
        # Leaving the `with` has let go of the line, though `robot` is still there.
        holder = subprocess.Popen([*command, "--link", link, "play", "wave"])
        deadline = time.monotonic() + 20
        while (guest := rsapien.Guest.find(link)) is None:
            assert time.monotonic() < deadline, "the holder plays for nobody"
            time.sleep(0.05)
        told = []
        outcome = guest.play("bow", policy="queue", on_admission=lambda *words: told.append(words))
        assert outcome and "bow" not in repr(guest)
        assert [word for word, _ in told] in (["waits", "begins"], ["begins"])
        assert holder.wait(30) == 0
    finally:
        simulator.terminate()
        simulator.wait()
