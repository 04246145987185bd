"""Recordings: written by the command and by Robot.record, read as arrays."""

import asyncio
import re
from pathlib import Path

import numpy as np
import pytest

import rsapien
from rsapien._rsapien import run_command

TOP = Path(__file__).resolve().parents[3]


def record(*arguments):
    status = run_command(["rsapien", "record", *map(str, arguments), "--link", "virtual", "--fast"])
    assert status == 0


@pytest.fixture(scope="module")
def look(tmp_path_factory):
    path = tmp_path_factory.mktemp("recordings") / "look.mcap"
    record("--camera", "--detect", path, "look", "--pan", "40", "--tilt", "-20")
    return path


def test_a_recording_as_arrays(look):
    recording = rsapien.Recording(look)
    assert "52 states, 6 frames, 6 detections" in repr(recording) and recording.complete
    assert recording.topics["/rsapien/camera"] == 6
    assert recording.about["link"] == "virtual" and recording.about["controllers"] == "model"
    states = recording.states()
    assert len(states) == 52 and states["mode"][-1] == "fresh"
    assert (np.diff(states["time_ms"].astype(int)) >= 0).all()
    assert recording.time_range[0] <= states["time_ms"][0]
    assert np.isnan(states["pan"][0])  # the camera controller has not been asked yet
    assert states["pan"][1] == 0 and states["pan"][-1] == 40 and states["tilt"][-1] == -20
    assert states["motors"].dtype.names[4] == "tilt" and not states["motors"]["tilt"].any()
    frames = list(recording.frames())
    assert [image.shape for _, image in frames] == [(240, 320, 3)] * 6
    assert frames[0][1].dtype == np.uint8 and frames[0][1].std() > 5
    found = recording.detections()
    assert len(found) and set(found["time_ms"]) <= {time_ms for time_ms, _ in frames}
    assert (found["semi_major"] >= found["semi_minor"]).all() and (found["score"] <= 1).all()


def test_bytes_are_those_of_the_packages(look):
    recording = rsapien.Recording(look)
    for direction in ("to-robot", "to-pc"):
        line = b"".join(data for _, way, data in recording.bytes() if way == direction)
        packages = [it for it in recording.packages() if it["direction"] == direction]
        assert line == b"".join(bytes.fromhex(it["hex"]) for it in packages)
    assert packages[0]["kind"] == "STATE" and "accepted" in packages[0]["words"]


def test_what_was_played(tmp_path):
    record(tmp_path / "wave.mcap", "play", "wave")
    events = rsapien.Recording(tmp_path / "wave.mcap").motion()
    assert [it["event"] for it in events] == ["begin"] + ["step"] * 7 + ["end"]
    assert events[-1]["outcome"] == "done"


def test_a_robot_records_itself(tmp_path):
    file = tmp_path / "here.mcap"
    with rsapien.Robot.virtual(fast=True) as robot:
        robot.init()
        with robot.record(file) as recorder:
            assert "here.mcap" in repr(recorder)
            with pytest.raises(rsapien.RecordingError, match="already"):
                robot.record(tmp_path / "other.mcap")
            robot.do("right-arm-up:800")
        robot.do("right-arm-down:800")
        with pytest.raises(rsapien.RecordingError, match="there already"):
            robot.record(file)
    recording = rsapien.Recording(file)
    states = recording.states()
    assert states["pose"]["right-arm"][-1] == 1 and states["motors"]["right-arm"].any()
    steps = [it for it in recording.packages() if it["kind"] == "STEP" and it["direction"] == "to-robot"]
    assert len(steps) == 1
    # It begins in the middle: the robot that plays it again is brought to where this one was.
    assert run_command(["rsapien", "replay", str(file)]) == 0


def test_a_robot_of_asyncio_records_itself(tmp_path):
    async def main():
        async with rsapien.aio.Robot.virtual(fast=True) as robot:
            with robot.record(tmp_path / "aio.mcap"):
                await robot.init()

    asyncio.run(main())
    packages = rsapien.Recording(tmp_path / "aio.mcap").packages()
    assert "INIT" in {package["kind"] for package in packages}


def test_what_is_no_recording(tmp_path):
    with pytest.raises(rsapien.RecordingError, match="missing.mcap: No such file"):
        rsapien.Recording(tmp_path / "missing.mcap")
    (tmp_path / "text.mcap").write_text("no recording")
    with pytest.raises(rsapien.RecordingError, match="no MCAP file"):
        rsapien.Recording(tmp_path / "text.mcap")


def test_a_cut_recording_is_read_as_far_as_it_goes(look, tmp_path):
    whole = look.read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    cut = rsapien.Recording(tmp_path / "cut.mcap")
    assert not cut.complete and "cut" in repr(cut)


def test_the_page_on_recordings_runs(look, monkeypatch):
    monkeypatch.chdir(look.parent)
    blocks = re.findall(r"```python\n(.*?)```", (TOP / "docs/recording.md").read_text(), re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, "recording.md", "exec"), {"__name__": "document"})
