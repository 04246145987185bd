"""detect() on pictures that the tests draw."""

import math
import threading

import numpy as np
import pytest

import rsapien

TRUTH = (101.5, 78.0, 60.0, 37.0, 0.253)


def draw(height=180, width=220, ellipse=TRUTH, rim=4.0):
    """A dark rim on light ground, anti-aliased from a first-order distance."""
    cx, cy, a, b, theta = ellipse
    y, x = np.mgrid[0:height, 0:width].astype(float)
    c, s = math.cos(theta), math.sin(theta)
    u, v = (x - cx) * c + (y - cy) * s, -(x - cx) * s + (y - cy) * c
    r = np.hypot(u / a, v / b)
    slope = np.maximum(np.hypot(u / a**2, v / b**2), 1e-9)
    distance = np.abs((r - 1) * r / slope)
    ink = np.clip(0.5 - (distance - rim / 2), 0, 1)
    return np.rint(220 - 180 * ink).astype(np.uint8)


def assert_found(detection):
    assert len(detection) == 1, detection
    x, y, a, b, theta = detection[0]
    assert (x, y) == pytest.approx(TRUTH[:2], abs=3)
    assert (a, b) == pytest.approx(TRUTH[2:4], abs=6)
    assert math.remainder(theta - TRUTH[4], math.pi) == pytest.approx(0, abs=0.15)


def test_finds_a_drawn_ellipse():
    detection = rsapien.detect(draw())
    assert_found(detection)
    assert detection.to_array().shape == (1, 5)
    assert detection.statistics["search_point_pairs"] == 2 * detection.statistics["edge_points"]
    assert "semi_major" in repr(detection[0]) and "1 ellipses" in repr(detection)


def test_colour_and_strided_pictures_give_the_same():
    grey = draw()
    expected = rsapien.detect(grey).to_array()
    rgb = np.repeat(grey[:, :, None], 3, axis=2)
    rgba = np.concatenate([rgb, np.full_like(grey, 255)[:, :, None]], axis=2)
    padded = np.zeros((grey.shape[0], grey.shape[1] * 2), np.uint8)
    padded[:, ::2] = grey
    for picture in (rgb, rgba, padded[:, ::2], np.asfortranarray(grey), rgb[:, :, ::-1]):
        assert np.array_equal(rsapien.detect(picture).to_array(), expected)


def test_a_seed_decides_on_any_thread():
    picture = draw()
    expected = rsapien.detect(picture, seed=7).to_array()
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(rsapien.detect(picture, seed=7).to_array()))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(np.array_equal(other, expected) for other in found)


@pytest.mark.parametrize("shape", [(1, 1), (2, 300), (240, 320)])
@pytest.mark.parametrize("value", [0, 255])
def test_nothing_to_see_is_an_empty_list(shape, value):
    detection = rsapien.detect(np.full(shape, value, np.uint8))
    assert len(detection) == 0 and detection.to_array().shape == (0, 5)


@pytest.mark.parametrize(
    "wrong",
    [np.zeros((4, 4)), np.zeros((4, 4, 2), np.uint8), np.zeros(4, np.uint8), [[1, 2]], None, "cup.png"],
)
def test_another_type_says_what_is_wanted(wrong):
    with pytest.raises(TypeError, match="uint8 and shape"):
        rsapien.detect(wrong)


def test_bad_values_name_field_and_range():
    with pytest.raises(ValueError, match="semi_major"):
        rsapien.detect(draw(), semi_major=(50, 10))
    with pytest.raises(ValueError, match="preset"):
        rsapien.detect(draw(), preset="magic")
    with pytest.raises(ValueError):
        rsapien.detect(np.zeros((0, 5), np.uint8))
