"""The virtual robot from Python, on its virtual clock."""

import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import rsapien


@pytest.fixture
def robot():
    with rsapien.Robot.virtual(seed=3, fast=True) as robot:
        yield robot


def test_init_play_and_state(robot):
    assert robot.state()["mode"] == "fresh"
    robot.init()
    state = robot.state()
    assert state["mode"] == "idle" and state["motors"] == []
    assert set(state["positions"].values()) == {"front", "mid"}
    told = []
    outcome = robot.play("wave", on_progress=lambda ended, total: told.append((ended, total)))
    assert outcome and outcome.kind == "done" and "done" in outcome.text
    assert outcome.steps_ended == outcome.steps_total == robot.state()["steps_ended"]
    assert told[0][0] == 0 and told[-1][0] == outcome.steps_total
    assert told == sorted(told)


def test_a_firmware_that_cannot_run_is_told_of(tmp_path):
    with pytest.raises(ValueError, match="no firmware of the motion controller"):
        rsapien.Robot.virtual(firmware=tmp_path)
    for name in ("motion-18f452", "camera-18f2320"):
        (tmp_path / f"rsapien-{name}-40mhz-57600.hex").touch()
    with pytest.raises(rsapien.RsapienError, match="make -C firmware-pic/sim"):
        rsapien.Robot.virtual(firmware=str(tmp_path), simulator=tmp_path / "none")


def test_do_takes_the_short_forms(robot):
    robot.init()
    assert robot.do("right-arm-up+left-arm-up:1200", "13:600")
    positions = robot.state()["positions"]
    assert (positions["right-arm"], positions["left-arm"], positions["tilt"]) == ("up", "up", "left")
    for wrong in ("right-arm-sideways:10", "1+2", "right-arm-up:0"):
        with pytest.raises(ValueError):
            robot.do(wrong)
    assert robot.state()["positions"] == positions


def test_looking_and_seeing(robot):
    assert robot.look(30, -10) == (30.0, -10.0)
    state = robot.state()
    assert (state["pan"], state["tilt"]) == (30.0, -10.0)
    picture = robot.snapshot()
    assert picture.shape == (240, 320, 3) and picture.dtype == np.uint8 and picture.std() > 5
    with pytest.raises(ValueError, match="range"):
        robot.look(91, 0)


def test_the_head_is_homed_when_it_has_to_be(robot):
    robot.stop()
    assert robot.look(10, 5) == (10.0, 5.0)
    robot.stop()
    assert robot.look(-10, 5) == (-10.0, 5.0)


def test_refusals_are_typed(robot):
    outcome = robot.do("tilt-left")
    assert not outcome and outcome.kind == "refused" and "INIT" in outcome.text
    robot.init()
    with pytest.raises(rsapien.UnknownAction, match="wave"):
        robot.play("wawe")
    with pytest.raises(ValueError):
        rsapien.Robot.open("nonsense:")
    with pytest.raises(ValueError, match="demo"):
        rsapien.Robot.virtual(world="mars")
    with pytest.raises(rsapien.LinkError):
        rsapien.Robot.open("/dev/no-such-port")
    assert issubclass(rsapien.LinkTimeout, rsapien.RsapienError)


def test_the_same_seed_gives_the_same_run():
    def run():
        with rsapien.Robot.virtual(seed=5, fast=True) as robot:
            robot.init()
            robot.play("walk-forward")
            robot.look(45, -20)
            return robot.state(), robot.snapshot()

    (first, first_picture), (second, second_picture) = run(), run()
    assert first == second
    assert np.array_equal(first_picture, second_picture)


def test_a_closed_robot_says_so(robot):
    robot.close()
    with pytest.raises(rsapien.RsapienError, match="open"):
        robot.state()
    robot.close()
    assert "closed" in repr(robot)


def test_stop_from_another_thread_interrupts():
    with rsapien.Robot.virtual(seed=3) as robot:
        robot.init()
        threading.Timer(0.5, robot.stop).start()
        started = time.monotonic()
        outcome = robot.play("dance", times=10)
        assert time.monotonic() - started < 5
        assert outcome.kind == "interrupted" and "STOP" in outcome.text
        assert robot.state()["motors"] == [] and robot.state()["mode"] == "stopped"


def test_python_runs_while_the_robot_moves():
    with rsapien.Robot.virtual(seed=3) as robot:
        counted = 0
        done = threading.Event()
        thread = threading.Thread(target=lambda: (robot.init(), done.set()))
        thread.start()
        while not done.is_set():
            counted += 1
            time.sleep(0.005)
        thread.join()
        assert counted > 50


def test_ctrl_c_stops_the_motors_first():
    program = """
import rsapien, sys
with rsapien.Robot.virtual() as robot:
    robot.init()
    print("playing", flush=True)
    try:
        robot.play("dance", times=20)
    except KeyboardInterrupt:
        print(robot.state()["mode"], robot.state()["motors"])
        sys.exit(42)
"""
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "playing\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    assert child.wait(timeout=10) == 42
    assert child.stdout.read() == "stopped []\n"


def test_the_wheel_carries_the_command():
    asked = subprocess.run(
        [sys.executable, "-m", "rsapien", "--version"], capture_output=True, text=True, check=True
    )
    assert asked.stdout.strip() == f"rsapien {rsapien.__version__}"
    wrong = subprocess.run([sys.executable, "-m", "rsapien", "fly"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "fly" in wrong.stderr
