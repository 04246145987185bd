"""Tracker and pose on what the tests draw."""

import math

import numpy as np
import pytest

import rsapien
from rsapien.pose import CirclePose, Intrinsics, ball_position, circle_poses, project_ball, project_circle

CAMERA = Intrinsics.from_field_of_view(640, 480, math.radians(60))


def disc(x, y, radius=30.0, height=160, width=240):
    """A bright disc on dark ground, its edge as wide as a pixel."""
    rows, columns = np.mgrid[0:height, 0:width].astype(float)
    cover = np.clip(radius + 0.5 - np.hypot(columns - x, rows - y), 0, 1)
    return np.rint(50 + 150 * cover).astype(np.uint8)


def test_a_disc_is_followed_through_a_gap_by_one_number():
    tracker = rsapien.Tracker(rsapien.Detector(score_min=0.6), misses_max=3)
    for number in range(12):
        is_shown = number != 8
        picture = disc(60 + 3 * number, 70 + number) if is_shown else np.full((160, 240), 50, np.uint8)
        (track,) = tracker.update(picture, number / 25)
        assert (track.id, track.age, track.misses) == (0, number + 1, 0 if is_shown else 1)
        assert track.state == ("predicted" if not is_shown else "confirmed" if number else "tentative")
        assert track.ellipse.center == pytest.approx((60 + 3 * number, 70 + number), abs=1.5)
    assert track.velocity == pytest.approx((75, 25), abs=5)
    assert track.sightings == 11 and 0.6 <= track.score <= 1 and max(track.center_deviation) < 1
    assert track.ellipse.semi_minor == pytest.approx(30, abs=0.3)
    assert repr(track).startswith('Track(id=0, state="confirmed", center=(9'), track
    assert repr(tracker) == "Tracker(1 track, fresh_every=8, confirmations=2, misses_max=3)"
    assert [again.id for again in tracker.tracks] == [0]
    tracker.reset()
    assert tracker.tracks == []


def test_a_tracker_refuses_what_is_out_of_range_or_no_picture():
    with pytest.raises(ValueError, match="tracker.overlap_min is 2, allowed is 0.05 to 0.95"):
        rsapien.Tracker(overlap_min=2)
    with pytest.raises(TypeError, match="detector"):
        rsapien.Tracker({"score_min": 0.5})
    with pytest.raises(TypeError, match="uint8"):
        rsapien.Tracker().update(np.zeros((4, 4)), 0)


def test_a_ball_and_a_circle_come_back_from_what_is_seen_of_them():
    place = np.array([-0.1, 0.15, 0.5])
    ball = ball_position(project_ball(place, 0.033, CAMERA), CAMERA, 0.033)
    assert ball.center == pytest.approx(place, abs=1e-6) and ball.misfit < 1e-6
    rim = CirclePose(center=(0.05, 0.1, 0.8), normal=(0, -0.8, -0.6))
    poses = circle_poses(project_circle(rim, 0.04, CAMERA), CAMERA, 0.04)
    assert len(poses) == 2
    assert poses[0].center == pytest.approx(rim.center, abs=1e-6)
    assert poses[0].normal == pytest.approx(rim.normal, abs=1e-6)
    assert project_ball((0, 0, -1), 0.1, CAMERA) is None
    assert repr(CAMERA) == "Intrinsics(focal_x=554.26, focal_y=554.26, center_x=319.50, center_y=239.50)"
    assert repr(ball).startswith("BallPosition(center=(-0.1000, 0.1500, 0.5000), misfit=")


def test_what_cannot_be_is_refused_by_name():
    with pytest.raises(ValueError, match="focal_x_px is 0"):
        Intrinsics(0, 500, 320, 240)
    with pytest.raises(ValueError, match="the radius is -1 m"):
        ball_position(rsapien.Ellipse(100, 100, 20, 20), CAMERA, -1)
