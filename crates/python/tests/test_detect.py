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


def disc(height=200, width=240, center=(120.3, 98.6), radius=50.0):
    """A black disc on grey ground, each pixel of the edge as dark as the share of it that is covered."""
    steps = (np.arange(8) - 3.5) / 8
    y, x = np.mgrid[0:height, 0:width].astype(float)
    covered = np.zeros((height, width))
    for dy in steps:
        for dx in steps:
            covered += np.hypot(x + dx - center[0], y + dy - center[1]) < radius
    return np.rint(128 * (1 - covered / 64)).astype(np.uint8)


def assert_found(detection):
    assert len(detection) == 1, detection
    x, y, a, b, theta = detection[0]
    assert (x, y) == pytest.approx(TRUTH[:2], abs=3)
    assert (a, b) == pytest.approx(TRUTH[2:4], abs=6)
    assert math.remainder(theta - TRUTH[4], math.pi) == pytest.approx(0, abs=0.15)


def test_a_disc_is_found_between_pixels_with_what_speaks_for_it():
    detection = rsapien.detect(disc(), support_points=True, covariance=True)
    assert len(detection) == len(detection.ellipses) == 1 and not detection.truncated, detection
    ellipse = detection[0]
    assert ellipse.center == pytest.approx((120.3, 98.6), abs=0.1)
    assert (ellipse.semi_major, ellipse.semi_minor) == pytest.approx((50, 50), abs=0.1)
    assert 0.9 < ellipse.support_share <= 1 and 0.9 < ellipse.gradient_agreement <= 1
    assert detection.scores == pytest.approx([ellipse.score]) and 0.8 < ellipse.score <= 1
    assert ellipse.log10_false_alarms < -10 and ellipse.residual < 0.5
    assert ellipse.stroke_width is None and ellipse.quality is None
    assert ellipse.covariance.shape == (5, 5) and (np.diag(ellipse.covariance) > 0).all()
    radii = np.hypot(*(ellipse.support_points[:, :2] - np.float32(ellipse.center)).T)
    assert len(radii) > 100 and radii == pytest.approx(50, abs=1.5)
    row = detection.to_structured()[0]
    assert [row[name] for name in ("center_x", "center_y", "semi_major", "semi_minor", "theta")] == list(ellipse)
    assert row["score"] == ellipse.score
    drawn = detection.draw()
    assert drawn.shape == (200, 240, 3) and drawn.dtype == np.uint8
    assert tuple(drawn[round(98.6), round(120.3 + 50)]) != (128, 128, 128)
    assert rsapien.detect(disc(), region=(0, 0, 60, 200)).to_array().shape == (0, 5)
    assert rsapien.detect(disc(), semi_axis_max=40).to_structured().shape == (0,)


def test_a_ring_is_its_middle_line_or_both_its_edges():
    ring = draw(rim=6.0)
    (middle,) = rsapien.detect(ring)
    assert list(middle)[2:4] == pytest.approx(TRUTH[2:4], abs=0.3)
    assert middle.stroke_width == pytest.approx(6, abs=0.5)
    edges = rsapien.detect(ring, strokes="edges")
    assert sorted(round(ellipse.semi_minor) for ellipse in edges) == [34, 40]


def test_colour_16_bits_and_strides_give_the_default_detector_the_same():
    grey = disc()
    expected = rsapien.detect(grey).to_array()
    rgb = np.repeat(grey[:, :, None], 3, axis=2)
    padded = np.zeros((grey.shape[0], grey.shape[1] * 2), np.uint8)
    padded[:, ::2] = grey
    for picture in (rgb, padded[:, ::2], np.asfortranarray(grey), grey.astype(np.uint16) * 257):
        assert np.array_equal(rsapien.detect(picture).to_array(), expected)


def test_many_pictures_come_back_in_their_order_on_any_number_of_threads():
    radii = [20.0, 60.0, 30.0, 50.0, 40.0, 25.0]
    pictures = [disc(radius=radius) for radius in radii]
    detector = rsapien.Detector(semi_axis_min=10)
    alone = [detector.detect(picture).to_array() for picture in pictures]
    assert [rows[0, 2] for rows in alone] == pytest.approx(radii, abs=0.1)
    for threads in (None, 1, 2, 8):
        found = detector.detect_many(pictures, threads=threads)
        assert all(np.array_equal(one.to_array(), other) for one, other in zip(found, alone))
    assert detector.detect_many([]) == []
    with pytest.raises(TypeError, match=r"images\[1\].*uint8 and shape"):
        detector.detect_many([pictures[0], np.zeros((3, 3))])
    with pytest.raises(ValueError, match="threads"):
        detector.detect_many(pictures, threads=0)
    assert "semi_axis_min=10" in repr(detector)


def test_an_ellipse_goes_to_other_packages_and_back():
    ellipse = rsapien.Ellipse(10.0, 20.0, 4.0, 7.0, 0.5)
    assert (ellipse.semi_major, ellipse.semi_minor) == (7, 4)
    assert ellipse.theta == pytest.approx(0.5 + math.pi / 2) and ellipse.score is None
    (center, sides, angle) = ellipse.to_rotated_rect()
    assert (center, sides, angle) == ((10, 20), (14, 8), pytest.approx(math.degrees(ellipse.theta)))
    assert list(rsapien.Ellipse.from_rotated_rect((center, sides, angle))) == pytest.approx(list(ellipse))
    upright = rsapien.Ellipse.from_rotated_rect(((1, 2), (6, 10), 0))       # as cv2.fitEllipse gives it
    assert list(upright) == pytest.approx([1, 2, 5, 3, math.pi / 2])
    assert rsapien.Ellipse(*ellipse).overlap(ellipse) == 1
    with pytest.raises(ValueError, match="semi_minor"):
        rsapien.Ellipse(1, 2, 3, 0)
    from matplotlib import patches
    patch = ellipse.patch(color="lime")
    assert isinstance(patch, patches.Ellipse) and not patch.get_fill()
    assert (patch.center, patch.width, patch.height) == ((10, 20), 14, 8)


def test_the_papers_detector_finds_a_drawn_ellipse():
    detection = rsapien.detect(draw(), preset="paper")
    assert_found(detection)
    assert detection.to_array().shape == (1, 5) and np.isnan(detection.scores).all()
    assert detection.statistics["search_point_pairs"] == 2 * detection.statistics["edge_points"]
    assert "quality" in repr(detection[0]) and "1 ellipses" in repr(detection)
    assert detection.draw().shape == (180, 220, 3)


def test_colour_and_strided_pictures_give_the_papers_detector_the_same():
    grey = draw()
    expected = rsapien.detect(grey, preset="paper").to_array()
    assert len(expected) == 1
    rgb = np.repeat(grey[:, :, None], 3, axis=2)
    rgba = np.concatenate([rgb, np.full_like(grey, 255)[:, :, None]], axis=2)
    padded = np.zeros((grey.shape[0], grey.shape[1] * 2), np.uint8)
    padded[:, ::2] = grey
    for picture in (rgb, rgba, padded[:, ::2], np.asfortranarray(grey), rgb[:, :, ::-1]):
        assert np.array_equal(rsapien.detect(picture, preset="paper").to_array(), expected)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_a_seed_decides_on_any_thread(preset):
    picture = draw()

    def look():
        return rsapien.detect(picture, preset=preset, seed=7).to_array()

    expected = look()
    found = []
    threads = [threading.Thread(target=lambda: found.append(look())) for _ in range(4)]
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
        rsapien.detect(draw(), preset="paper", semi_major=(50, 10))
    with pytest.raises(ValueError, match='quality needs preset="paper"'):
        rsapien.detect(draw(), quality=250)
    with pytest.raises(ValueError, match='region needs preset="default"'):
        rsapien.detect(draw(), preset="paper", region=(0, 0, 5, 5))
    with pytest.raises(ValueError, match="semi_axis_min_px is 1, allowed is 1.5"):
        rsapien.Detector(semi_axis_min=1)
    with pytest.raises(ValueError, match="edges"):
        rsapien.detect(draw(), strokes="both")
    with pytest.raises(ValueError, match="preset"):
        rsapien.detect(draw(), preset="magic")
    with pytest.raises(ValueError):
        rsapien.detect(np.zeros((0, 5), np.uint8))
