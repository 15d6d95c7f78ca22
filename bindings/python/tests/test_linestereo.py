"""Calls from numpy and OpenCV, right and wrong."""

import copy
import importlib.util
import json
import os
import pathlib
import pickle
import shutil
import statistics
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import linestereo
from linestereo import Fault

TOP = pathlib.Path(__file__).resolve().parents[3]
cv2 = pytest.importorskip("cv2")


def wall(disparity, rows=240, columns=320):
    """A wall with bars of many widths, at this disparity. Each changes its colour at rows of its own: one row for all would be a tear."""
    y, x = np.mgrid[:rows, :columns]
    x = x + disparity
    bar = x * x // 4000
    bars = np.where((bar + (y + 11 * bar) // 30) % 2 == 0, 60, 190)
    return (bars + (x * 7 + y * 13) % 9).astype(np.uint8)


def pole():
    """A wall with a grain, at 8 px, and a dark pole of 5 px before it, at 24 px."""
    grain = np.random.default_rng(1).integers(60, 190, (122, 172))
    grain = cv2.resize(grain.astype(np.uint8), None, fx=2, fy=2, interpolation=cv2.INTER_LINEAR)
    images = [np.ascontiguousarray(grain[:240, 8 * eye:320 + 8 * eye]) for eye in (0, 1)]
    for image, start in zip(images, (150, 126)):
        image[30:210, start:start + 5] = 30
    return images


@pytest.fixture(scope="module")
def pair():
    return wall(0), wall(12)


@pytest.fixture(scope="module")
def result(pair):
    return linestereo.match(*pair, max_disparity=32, rig=linestereo.Rig(200, 0.06))


def same(a, b):
    lists = ("points", "segments", "bars")
    return all(getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in lists)


def test_a_wall_is_where_it_is(result):
    assert result.is_fit and result.health == frozenset() and result.size == (320, 240)
    assert len(result.points) > 3000 and len(result.segments) > 30 and result.segments_found >= len(result.segments)
    for found in (result.points["disparity"], result.segments["disparity"]):  # 1 px is promised; ends of near-horizontal ones use it
        assert np.abs(found - 12).max() < 1 and np.median(np.abs(found - 12)) < 0.2
    assert abs(np.median(result.points["depth"]) - 1) < 0.01  # 200 px * 0.06 m / 12 px
    assert (result.points["confidence"] >= 0.9).all() and (result.points["confidence"] < 1).all()
    assert result.points["segment"].max() < len(result.segments)
    assert "points" in repr(result)


def test_a_pole_is_a_bar():
    pair = pole()
    bars = linestereo.match(*pair, max_disparity=32, rig=linestereo.Rig(200, 0.06)).bars
    assert len(bars) > 0 and (bars["confidence"] >= 0.9).all()
    assert np.abs(bars["disparity"] - 24).max() < 1 and np.abs(bars["width"] - 5).max() < 1
    assert np.abs(bars["ends"][:, :, 0] - 149.5).max() < 1
    assert np.abs(bars["depth"] - 0.5).max() < 0.02 and (bars["depth_sigma"] > 0).all()
    assert np.isnan(linestereo.match(*pair, max_disparity=32).bars["depth"]).all()


def test_depths_need_a_rig(pair):
    alone = linestereo.match(*pair, max_disparity=32)
    assert np.isnan(alone.points["depth"]).all() and np.isnan(alone.segments["depth"]).all()
    assert np.isnan(alone.objects(boxes=[[60, 30, 120, 90]])[0].depth_m)


def test_objects(result):
    [whole, out] = result.objects(boxes=[[60, 30, 120, 90], [300.4, 200, 400, 300]])
    assert abs(whole.depth_m - 1) < 0.03 and whole.reason is None and whole.support > 3 and whole.label == 0
    assert out.label == 1
    mask = np.zeros((2, 240, 320), bool)
    mask[0, 30:90, 60:120] = mask[1, 100:200, 100:200] = True
    labels = mask[0] * 7 + mask[1] * 9
    by_mask, by_label = result.objects(masks=mask), result.objects(masks=labels)
    assert [found.depth_m for found in by_mask] == [found.depth_m for found in by_label]
    assert [found.label for found in by_label] == [7, 9] and abs(by_mask[1].depth_m - 1) < 0.03
    assert result.objects(boxes=np.empty((0, 4))) == [] and result.objects(masks=labels * 0) == []
    assert abs(result.pixel(97, 61).depth_m - 1) < 0.03
    assert result.pixel(0, 0).reason is not None and result.pixel(0, 0).text


def test_directions(result):
    sectors = result.sectors()
    assert len(sectors) == 72 and sectors.dtype == linestereo.SECTOR and sectors["direction"][[0, 1, 36, 71]].tolist() == [0, 5, -180, -5]
    states = set(sectors["state"])
    assert sectors["state"][0] == linestereo.SectorState.OBSTACLE and sectors["state"][36] == linestereo.SectorState.OUTSIDE
    assert abs(sectors["distance"][0] - 1) < 0.05 and sectors["confidence"][0] > 0.99 and sectors["age_ms"][0] == 0
    assert np.isnan(sectors["distance"][36]) and np.isnan(sectors["drop_off"]).all() and states <= {0, 1, 3}
    turned = result.sectors(yaw_deg=90, sectors=4)
    assert turned["state"].tolist() == [0, 3, 0, 0] and turned["direction"].tolist() == [0, 90, -180, -90]
    near = result.sectors(range_m=0.5)
    assert near["state"][0] == linestereo.SectorState.FREE and near["distance"][0] == np.inf

    obstacles = linestereo.Obstacles(keep_ms=300)
    with pytest.raises(ValueError, match="no pair yet"):
        obstacles.sectors(0)
    assert obstacles.update(result, 1_000_000).tobytes() == sectors.tobytes()
    assert obstacles.sectors(1_200_000)["age_ms"][0] == 200
    assert obstacles.sectors(1_400_000)["state"][0] == linestereo.SectorState.UNKNOWN


def floor(edge_row):
    """A textured floor, 0.4 px of disparity a row below row 80, that goes on deeper above `edge_row`, with other
    texture: the same, moved in one image, would be a tear."""
    grain = np.random.default_rng(3).integers(40, 210, (240, 900)).astype(np.float32)
    grain = cv2.GaussianBlur(grain, None, 1.2)
    y, x = np.mgrid[:240, :320].astype(np.float32)
    disparity = 0.4 * np.maximum(y - 80, 8) * np.where(y < edge_row, 0.25 / 0.55, 1)
    column = x + np.where(y < edge_row, 450, 0).astype(np.float32)
    images = [cv2.remap(grain, column + moves * disparity.astype(np.float32), y, cv2.INTER_CUBIC) for moves in (0, 1)]
    return [np.clip(np.rint(2 * image - 125), 0, 255).astype(np.uint8) for image in images]


def test_where_the_floor_ends(tmp_path):
    rig = linestereo.Rig(300, 0.1, 0, (159.5, 80))
    result = linestereo.match(*floor(130), max_disparity=80, rig=rig)
    sectors = result.sectors()
    edge = 300 * 0.1 / (0.4 * (130 - 80))
    assert abs(sectors["drop_off"][0] - edge) < 0.1 * edge and sectors["drop_off_confidence"][0] >= 0.99
    assert sectors["state"][0] == linestereo.SectorState.UNKNOWN  # not free
    assert np.isnan(result.sectors(drop_m=None)["drop_off"]).all()
    assert np.isnan(linestereo.match(*floor(0), max_disparity=80, rig=rig).sectors()["drop_off"]).all()


@pytest.mark.parametrize("parameters, text", [
    ({"sectors": 3}, "sectors is 3"),
    ({"sectors": 300}, "sectors is 300"),
    ({"keep_ms": -1}, "keep_ms is -1"),
    ({"range_m": 0}, "range"),
    ({"yaw_deg": 200}, "yaw"),
    ({"heights_m": (1, 0)}, "height"),
    ({"drop_m": -1}, "drop-off"),
])
def test_parameters_of_directions_are_refused(pair, result, parameters, text):
    with pytest.raises(ValueError, match=text):
        linestereo.Obstacles(**parameters)
    with pytest.raises(ValueError, match="rig"):
        linestereo.match(*pair, max_disparity=32).sectors()
    with pytest.raises(ValueError, match="pickled"):
        pickle.loads(pickle.dumps(result)).sectors()


@pytest.mark.parametrize("boxes, masks, text", [
    (None, None, "either"),
    ([[1, 2, 3]], None, "shape"),
    ([[1, 2, np.nan, 4]], None, "finite"),
    ([[200, 100, 60, 90]], None, "without pixels; give left, top, right, bottom"),  # corner and size
    ([[500, 9, 600, 20]], None, "outside"),
    ([["a", "b", "c", "d"]], None, "dtype"),
    (None, np.zeros((240, 320)), "dtype"),
    (None, np.ones((3, 4), bool), "a mask is 4x3, the pair 320x240"),
    (None, np.zeros((1, 240, 320), bool), "without pixels"),
    (None, np.full((240, 320), 70000), "65535"),
])
def test_regions_that_are_none_are_refused(result, boxes, masks, text):
    with pytest.raises(ValueError, match=text):
        result.objects(boxes=boxes, masks=masks)


def test_any_strides_are_right(pair, result):
    left, right = pair
    wide = np.zeros((240, 700), np.uint8)
    wide[:, :320], wide[:, 350:670] = left, right
    doubled = np.repeat(np.repeat(left, 2, 0), 3, 1)
    frozen = left.copy()
    frozen.flags.writeable = False
    reader = memoryview(left)
    for view, other in [
        (wide[:, :320], wide[:, 350:670]),
        (np.asfortranarray(left), np.asfortranarray(right)),
        (doubled[::2, ::3], right),
        (left[::-1, ::-1].copy()[::-1, ::-1], right),
        (frozen, right),
        (reader, right),
        (cv2.UMat(left).get(), right),
        (cv2.merge([left, left, left])[:, :, 1], right),
        (left.tolist() and np.array(left.tolist(), np.uint8), right),
    ]:
        assert same(linestereo.match(view, other, max_disparity=32, rig=linestereo.Rig(200, 0.06)), result)


@pytest.mark.parametrize("make, text", [
    (lambda image: image.astype(np.uint16), "left has dtype uint16"),
    (lambda image: image.astype(np.int8), "left has dtype int8"),
    (lambda image: image > 100, "left has dtype bool"),
    (lambda image: np.full(image.shape, np.nan), "left has dtype float64"),
    (lambda image: image.astype(object), "left has dtype object"),
    (lambda image: cv2.merge([image] * 3), "left has shape .240, 320, 3.: give grey"),
    (lambda image: image.ravel(), "left has shape"),
    (lambda image: image[:10], "left: an image of 320x10 is outside 16x16 to 1280x1280"),
    (lambda image: np.zeros((0, 0), np.uint8), "left: an image of 0x0"),
    (lambda image: np.zeros((16, 70000), np.uint8), "left: an image of 65535x16"),
    (lambda image: image[:, :300], "left is 300x240, right is 320x240: both have to be of one size"),
    (lambda image: "left.png", "left is str: give its pixels, as by cv2.imread"),
    (lambda image: pathlib.Path("left.png"), "give its pixels, as by cv2.imread"),
    (lambda image: None, "left is None: cv2.imread gives that for a file that it cannot read"),
    (lambda image: cv2.imread("there/is/no/such.png", cv2.IMREAD_GRAYSCALE), "left is None"),
    (lambda image: (image / 255).astype(np.float32), "left has dtype float32: give uint8, 0 to 255; .255 . image..round.."),
])
def test_what_is_no_image_is_refused(pair, make, text):
    with pytest.raises(ValueError, match=text):
        linestereo.match(make(pair[0]), pair[1])


@pytest.mark.parametrize("parameters, text", [
    ({"max_disparity": 500}, "max_disparity is 500 but must be 8 to 256"),
    ({"max_disparity": -1}, "max_disparity is -1"),
    ({"max_disparity": 2**40}, "max_disparity is"),
    ({"min_disparity": -40}, "min_disparity is -40 but must be -32 to 0"),
    ({"min_confidence": 0.05}, "min_confidence .percent. is 5 but must be 10 to 99"),
    ({"min_confidence": float("nan")}, "min_confidence"),
    ({"rig": 3}, "neither a Rig nor a Calibration"),
])
def test_parameters_outside_their_ranges_are_refused(pair, parameters, text):
    with pytest.raises(ValueError, match=text):
        linestereo.match(*pair, **parameters)
    with pytest.raises(ValueError, match="focal length -1 px is outside"):
        linestereo.Rig(-1, 0.1)


def test_health_is_a_set_and_knows_the_pairs_before(pair):
    assert [fault.value for fault in Fault] == [*linestereo._core.fault_names(), "segments_dropped"]
    dead = linestereo.match(pair[0], np.full_like(pair[1], 90), max_disparity=32)
    assert Fault.RIGHT_DEAD in dead.health and not dead.is_fit
    [refused] = dead.objects(boxes=[[60, 30, 120, 90]])
    assert refused.reason == "unhealthy_pair" and refused.disparity_px is None and "not fit" in refused.text
    twice = linestereo.match(pair[0], pair[0], max_disparity=32)  # one camera delivered twice
    assert Fault.NO_PARALLAX in twice.health and not twice.is_fit
    assert len(twice.points) == len(twice.segments) == 0
    assert twice.pixel(80, 60).reason == "unhealthy_pair"
    matcher = linestereo.Matcher(32)
    assert matcher.match(*pair).health == frozenset()
    assert {Fault.LEFT_FROZEN, Fault.RIGHT_FROZEN} <= matcher.match(*pair).health
    assert Fault.SKEW in matcher.match(*pair, times_us=(0, 5000)).health
    with pytest.raises(ValueError, match="times_us are .-1, 5. but must be 0 or more"):
        matcher.match(*pair, times_us=(-1, 5))
    with pytest.raises(ValueError, match="time_us is -1 but must be 0 or more"):
        linestereo.Obstacles().update(dead, -1)
    assert len(matcher.match(*pair, times_us=(0, 5000)).points) == 0


def test_every_fault_has_a_remedy(pair):
    assert all(fault.remedy and fault.remedy.isprintable() for fault in Fault)
    dead = linestereo.match(pair[0], np.full_like(pair[1], 90))
    assert "right_dead: right image has one grey level: check the camera's cable and power" in dead.advice
    fit = linestereo.match(*pair)
    assert fit.is_fit and all(len(result.advice) == len(result.health) for result in (dead, fit))


def test_points_have_places_in_space(result):
    xyz, points = result.xyz, result.points
    assert xyz.shape == (len(points), 3) and xyz.dtype == np.float64
    z = points["depth"]
    assert np.allclose(xyz[:, 2], z)
    assert np.allclose(xyz[:, 0], (points["x"] - 159.5) * z / 200, atol=2e-3) and np.allclose(xyz[:, 1], (points["y"] - 119.5) * z / 200, atol=2e-3)
    points["disparity"][0], before = np.nan, points["disparity"][0]
    assert np.isnan(result.xyz[0]).all()
    points["disparity"][0] = before
    with pytest.raises(ValueError, match="places in space need a rig"):
        linestereo.match(wall(0), wall(12), max_disparity=32).xyz


def test_nothing_is_matched_beyond_the_valid_pixels(pair):
    mask = np.zeros((240, 320), bool)
    mask[40:200, 60:300] = True
    spans = np.zeros((240, 2), int)
    spans[40:200] = 60, 300
    by_mask, by_spans = (linestereo.match(*pair, max_disparity=32, valid=(valid, None)) for valid in (mask, spans))
    assert same(by_mask, by_spans) and 500 < len(by_mask.points)
    points = by_mask.points
    assert points["x"].min() >= 60 and points["x"].max() < 300 and points["y"].min() >= 40 and points["y"].max() < 200
    whole = np.ones((240, 320), bool)
    assert same(linestereo.match(*pair, max_disparity=32, valid=(whole, whole)), linestereo.match(*pair, max_disparity=32))
    holed = mask.copy()
    holed[100, 150] = False
    for valid, text in [
        ((holed, None), "row 100 of the left image has valid pixels in more than one piece"),
        ((None, mask[:9]), "valid of the right image has shape .9, 320. and dtype bool"),
        ((mask.astype(float), None), "dtype float64"),
        ((spans * 9, None), "valid"),
        ((spans - 9, None), "outside 0 to 65535"),
        ((mask,), "give two"),
        ((mask, mask, mask), "give two"),
        (mask, "give two"),
    ]:
        with pytest.raises(ValueError, match=text):
            linestereo.match(*pair, valid=valid)


def test_what_is_not_said_fits_the_image(pair):
    small = [np.ascontiguousarray(image[:48, :64]) for image in pair]
    assert same(linestereo.match(*small), linestereo.match(*small, max_disparity=63))
    with pytest.raises(ValueError, match="max_disparity is 64"):
        linestereo.match(*small, max_disparity=64)
    assert same(linestereo.match(*pair), linestereo.match(*pair, max_disparity=64))


def test_results_and_parameters_can_be_pickled(pair, result, rig_file):
    again = pickle.loads(pickle.dumps(result))
    assert same(again, result) and (again.health, again.is_fit, again.size) == (result.health, result.is_fit, result.size)
    assert (again.milliseconds, again.segments_found) == (result.milliseconds, result.segments_found)
    with pytest.raises(ValueError, match="pickled"):
        again.objects(boxes=[[60, 30, 120, 90]])
    [found] = result.objects(boxes=[[60, 30, 120, 90]])
    assert pickle.loads(pickle.dumps(found)) == found and pickle.loads(pickle.dumps(Fault.SKEW)) is Fault.SKEW
    rig = linestereo.Rig(200.3, 0.0601, 1.5, (150, 100.25))
    calibration = linestereo.Calibration.load(rig_file)
    for parameters in (rig, calibration.rig, calibration):
        copies = pickle.loads(pickle.dumps(parameters)), copy.deepcopy(parameters)
        expected = linestereo.match(*pair, max_disparity=32, rig=parameters)
        assert all(same(linestereo.match(*pair, max_disparity=32, rig=made), expected) for made in copies)
    matcher = linestereo.Matcher(32, rig)
    matcher.match(*pair)
    assert same(pickle.loads(pickle.dumps(matcher)).match(*pair), linestereo.match(*pair, max_disparity=32, rig=rig))


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="no mypy: pip install mypy")
def test_arrays_have_types(tmp_path):
    (tmp_path / "user.py").write_text(
        "import numpy as np\nimport numpy.typing as npt\nimport linestereo\n"
        "image: npt.NDArray[np.uint8] = np.zeros((48, 64), np.uint8)\n"
        "result = linestereo.match(image, image, rig=linestereo.Rig(200, 0.1), valid=(image > 0, None))\n"
        "points: npt.NDArray[np.void] = result.points\nplaces: npt.NDArray[np.float64] = result.xyz\n"
        "reveal_type(result.health)\nresult.points.nonsense\n")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "user.py"]
    said = subprocess.run(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    assert len(said) == 2 and "frozenset[linestereo.Fault]" in said[0] and "nonsense" in said[1], said


def test_what_was_cut_is_said():
    dense = (np.indices((240, 320)).sum(axis=0) % 3 * 60 + 60).astype(np.uint8)
    assert Fault.SEGMENTS_DROPPED in linestereo.match(dense, dense, max_disparity=32).health


def test_results_stay_when_others_are_matched(pair, result):
    matcher = linestereo.Matcher(32, linestereo.Rig(200, 0.06))
    first = matcher.match(*pair)
    before = first.points.copy()
    matcher.match(pair[1], pair[0])
    pair[0].copy()[:] = 0
    assert (first.points == before).all() and same(first, result)
    assert first.objects(boxes=[[60, 30, 120, 90]]) == result.objects(boxes=[[60, 30, 120, 90]])
    points = first.points
    del first, matcher
    assert (points == before).all() and points.flags.writeable


def test_other_threads_run_meanwhile():
    """The GIL is released: a thread that counts goes on while a large pair is matched."""
    left, right = wall(0, 1280, 1280), wall(12, 1280, 1280)
    counts, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counts[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    before = counts[0]
    linestereo.match(left, right, max_disparity=128)
    after = counts[0]
    stop.set()
    thread.join()
    assert after - before > 100


def test_threads_share_a_result(result):
    boxes, answers, start = [[60, 30, 120, 90]] * 500, [], threading.Barrier(4)

    def ask():
        start.wait()
        answers.append(result.objects(boxes=boxes))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [result.objects(boxes=boxes)] * 4


def test_a_matcher_in_use_says_so(pair):
    large = wall(0, 1280, 1280), wall(12, 1280, 1280)
    matcher, stop = linestereo.Matcher(128), threading.Event()

    def match():
        while not stop.is_set():
            try:
                matcher.match(*large)
            except RuntimeError:
                pass  # the other thread came first

    thread = threading.Thread(target=match)
    thread.start()
    try:
        with pytest.raises(RuntimeError, match="the Matcher is in use .* give each thread one of its own"):
            for _ in range(1000):
                matcher.match(*pair)
    finally:
        stop.set()
        thread.join()


POSES = (
    ((0.0, 0), r"height \(m\) of the camera is 0 but must be 0.01 to 100"),
    ((0.01, 0), "baseline / height of the camera is 6.* but must be 0 to 4"),
    ((0.15, 90), r"pitch \(degrees\) of the camera is 90 but must be -80 to 80"),
    ((0.15, 0, -81), r"roll \(degrees\) of the camera is -81"),
    ((np.nan, 0), "height"),
)


def test_the_ground_is_where_the_pose_says(pair):
    """Of a wall, which hides the floor, the stated plane is taken."""
    matcher = linestereo.Matcher(32, linestereo.Rig(200, 0.06))
    matcher.expect_ground(0.15, 10.0, 4.0)
    for pose, text in POSES:
        with pytest.raises(ValueError, match=text):
            matcher.expect_ground(*pose)
    ground = matcher.match(*pair).ground
    found = ground.height_m, ground.pitch_deg, ground.roll_deg
    assert np.allclose(found, (0.15, 10, 4), rtol=0, atol=(0.0005, 0.15, 0.15))
    pitch, roll = np.radians([10, 4])
    found = ground.down_px_per_row, ground.across_px_per_column
    assert np.allclose(found, 0.4 * np.cos(pitch) * np.array([np.cos(roll), np.sin(roll)]), atol=0.002)
    assert pickle.loads(pickle.dumps(ground)) == ground
    forgetful = linestereo.Matcher(32, linestereo.Rig(200, 0.06))
    forgetful.expect_ground(0.15, 10.0)
    forgetful.forget_ground()
    assert forgetful.match(*pair).ground is None
    with pytest.raises(ValueError, match="needs a rig"):
        linestereo.Matcher(32).expect_ground(0.15, 0)


def test_what_is_asked_for_at_a_prompt_is_said():
    rig = linestereo.Rig(182.5, 0.05, 3.0, (100, 90))
    assert repr(rig) == "Rig(focal_px=182.5, baseline_m=0.05, disparity_offset_px=3, principal_point_px=(100, 90))"
    assert repr(linestereo.Rig(250, 0.06)) == "Rig(focal_px=250, baseline_m=0.06)"
    assert (rig.disparity_offset_px, rig.principal_point_px) == (3.0, (100.0, 90.0))
    for item, text in ((linestereo.Rig, "0.0001 to 10"), (linestereo.Calibration.load, "translation_unit"), (linestereo.Calibration.rectify, "linestereo.rectify")):
        assert text in item.__doc__


RIG = """version = 1
[left]
size = [320, 240]
focal_px = [250.0, 250.0]
centre_px = [159.5, 119.5]
lens = { model = "brown-conrady", k = [-0.1, 0.0, 0.0], p = [0.0, 0.0] }
[right]
size = [320, 240]
focal_px = [250.0, 250.0]
centre_px = [159.5, 119.5]
lens = { model = "brown-conrady", k = [-0.1, 0.0, 0.0], p = [0.0, 0.0] }
[pose]
rotation_rad = [0.0, 0.0, 0.0]
translation_m = [-0.06, 0.0, 0.0]
"""


@pytest.fixture
def rig_file(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(RIG)
    return path


def test_a_calibration_rectifies(pair, rig_file):
    calibration = linestereo.Calibration.load(rig_file)
    assert calibration.size == calibration.raw_size == (320, 240) and abs(calibration.rig.baseline_m - 0.06) < 1e-4
    left, right = linestereo.rectify(*pair, calibration)
    assert left.shape == (240, 320) and left.dtype == np.uint8 and (left != pair[0]).any()
    raw = linestereo.match(*pair, max_disparity=32, rig=calibration)
    assert same(raw, linestereo.match(left, right, max_disparity=32, rig=calibration.rig, valid=calibration.valid))
    with pytest.raises(ValueError, match="leave valid out"):
        linestereo.match(*pair, rig=calibration, valid=calibration.valid)
    assert raw.is_fit and same(raw, linestereo.match(left, right, max_disparity=32, rig=calibration.rig))
    small = linestereo.Calibration.load(str(rig_file), size=(160, 120))
    assert linestereo.rectify(*pair, small)[0].shape == (120, 160)
    with pytest.raises(ValueError, match="these are 320x200; give images of 320x240"):
        linestereo.rectify(pair[0][:200], pair[1][:200], calibration)


def test_files_that_are_no_rig_are_refused(rig_file):
    with pytest.raises(ValueError, match="none.toml: cannot be read"):
        linestereo.Calibration.load(rig_file.parent / "none.toml")
    rig_file.write_text(RIG.replace("size = [320, 240]", "size = [320, -3]", 1))
    with pytest.raises(ValueError, match="line 3"):
        linestereo.Calibration.load(rig_file)
    rig_file.write_text(RIG)
    with pytest.raises(ValueError, match="lpha"):
        linestereo.Calibration.load(rig_file, alpha=2.0)


OPENCV = """%YAML:1.0
M1: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [250., 0., 159.5, 0., 250., 119.5, 0., 0., 1.]}
D1: !!opencv-matrix {rows: 1, cols: 5, dt: d, data: [-0.1, 0., 0., 0., 0.]}
M2: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [250., 0., 159.5, 0., 250., 119.5, 0., 0., 1.]}
D2: !!opencv-matrix {rows: 1, cols: 5, dt: d, data: [-0.1, 0., 0., 0., 0.]}
R: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [1., 0., 0., 0., 1., 0., 0., 0., 1.]}
T: !!opencv-matrix {rows: 3, cols: 1, dt: d, data: [-60., 0., 0.]}
"""

SENSOR = """sensor_type: camera
T_BS: {rows: 4, cols: 4, data: [1, 0, 0, %s, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}
resolution: [320, 240]
camera_model: pinhole
intrinsics: [250, 250, 159.5, 119.5]
distortion_model: radial-tangential
distortion_coefficients: [-0.1, 0, 0, 0]
"""

KALIBR_CAMERA = """%s:
  camera_model: pinhole
  intrinsics: [250.0, 250.0, 159.5, 119.5]
  distortion_model: radtan
  distortion_coeffs: [-0.1, 0.0, 0.0, 0.0]
  resolution: [320, 240]
"""

KALIBR = KALIBR_CAMERA % "cam0" + KALIBR_CAMERA % "cam1" + """\
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.06]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
"""

# The fourth number of the right projection is minus focal length times baseline: 250 px * 0.06 m.
CAMERA_INFO = """image_width: 320
image_height: 240
camera_name: %s
camera_matrix: {rows: 3, cols: 3, data: [250, 0, 159.5, 0, 250, 119.5, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0, 0, 0, 0]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [250, 0, 159.5, %s, 0, 250, 119.5, 0, 0, 0, 1, 0]}
"""


def test_calibrations_of_other_programs_are_read(pair, rig_file, tmp_path):
    expected = linestereo.Calibration.load(rig_file)
    opencv = tmp_path / "stereo.yml"
    opencv.write_text(OPENCV)
    found = linestereo.Calibration.load(opencv, raw_size=(320, 240))
    assert found.size == (320, 240) and any("mm" in note for note in found.notes)
    sensors = [tmp_path / "left.yaml", str(tmp_path / "right.yaml")]
    for path, place in zip(sensors, ("0", "0.06")):
        with open(path, "w") as file:
            file.write(SENSOR % place)
    infos = [tmp_path / "left_info.yaml", tmp_path / "right_info.yaml"]
    for path, side, along in zip(infos, ("left", "right"), ("0", "-15")):
        path.write_text(CAMERA_INFO % (side, along))
    kalibr = tmp_path / "camchain.yaml"
    kalibr.write_text(KALIBR)
    others = [linestereo.Calibration.load(files) for files in (sensors, infos, kalibr)]
    for calibration in (found, *others):
        assert calibration.size == calibration.raw_size == (320, 240)
        assert abs(calibration.rig.baseline_m - 0.06) < 1e-4
        for a, b in zip(linestereo.rectify(*pair, calibration), linestereo.rectify(*pair, expected)):
            assert (a == b).all()
    with pytest.raises(ValueError, match="convert-rig"):
        linestereo.Calibration.load(opencv)
    with pytest.raises(ValueError, match="for another image size"):
        linestereo.Calibration.load(opencv, raw_size=(160, 120))
    with pytest.raises(ValueError, match="metres"):
        linestereo.Calibration.load(opencv, raw_size=(320, 240), translation_unit="m")
    with pytest.raises(ValueError, match="translation_unit"):
        linestereo.Calibration.load(opencv, raw_size=(320, 240), translation_unit="inch")


def test_a_baseline_in_millimetres_is_refused():
    with pytest.raises(ValueError, match="mm"):
        linestereo.Rig(712, 60)


def test_an_offset_moves_infinity():
    """Of cameras that look apart what is far away has a negative disparity: that is no fault of theirs."""
    def health(rig):
        return linestereo.match(wall(0), wall(-10), max_disparity=16, min_disparity=-24, rig=rig).health

    assert Fault.BEYOND_INFINITY in health(linestereo.Rig(200, 0.06))
    assert Fault.BEYOND_INFINITY not in health(linestereo.Rig(200, 0.06, 20.0))


def program():
    found = os.environ.get("LINESTEREO_PROGRAM") or TOP / "target/release/linestereo"
    return found if pathlib.Path(found).is_file() else shutil.which("linestereo")


def five_decimals(value):
    """As the program rounds; None for what is infinite."""
    return None if value == np.inf else np.floor(value * 1e5 + 0.5) / 1e5


@pytest.mark.skipif(program() is None, reason="no program of the PC: cargo build --release, or LINESTEREO_PROGRAM")
@pytest.mark.parametrize("kind", ["drawn", "raw", "teddy", "pole", "stated"])
def test_numbers_are_those_of_the_program(pair, rig_file, tmp_path, kind):
    if kind == "teddy":
        folder = pathlib.Path(os.environ.get("LINESTEREO_FRAMES", TOP.parent / "shared/frames")) / "qvga/teddy"
        if not folder.is_dir():
            pytest.skip("no captured frames; set LINESTEREO_FRAMES")
        pair = [cv2.imread(str(folder / name), cv2.IMREAD_GRAYSCALE) for name in ("left.png", "right.png")]
    pair = pole() if kind == "pole" else pair
    for name, image in zip(("left.png", "right.png"), pair):
        cv2.imwrite(str(tmp_path / name), image)
    command = [program(), "run", "left.png", "right.png", "--max-disparity", "32", "--quiet", "--sectors", "--json", "-"]
    command += ["--rig", "rig.toml"] if kind == "raw" else ["--focal-px", "200", "--baseline-m", "0.06"]
    if kind == "stated":
        command += ["--camera-height", "0.15", "--camera-pitch", "-10", "--camera-roll", "4"]
    listing = json.loads(subprocess.run(command, cwd=tmp_path, check=True, stdout=subprocess.PIPE).stdout)
    rig = linestereo.Calibration.load(rig_file) if kind == "raw" else linestereo.Rig(200, 0.06)
    matcher = linestereo.Matcher(32, rig)
    if kind == "stated":
        matcher.expect_ground(0.15, -10, 4)
    result = matcher.match(*pair)
    points = [(int(p["x"]), int(p["y"]), float(p["disparity"]), five_decimals(float(p["confidence"]))) for p in result.points]
    assert points == [tuple(point) for point in listing["points"]]
    assert result.segments["ends"].tolist() == [segment["left"] for segment in listing["segments"]]
    assert result.segments["disparity"].tolist() == [segment["disparity_px"] for segment in listing["segments"]]
    depths = [[five_decimals(z) for z in depth] for depth in result.segments["depth"].tolist()]
    assert depths == [segment["depth_m"] for segment in listing["segments"]]
    assert result.bars["ends"].tolist() == [bar["left"] for bar in listing["bars"]]
    for name in ("width", "disparity", "sigma"):
        assert result.bars[name].tolist() == [bar[f"{name}_px"] for bar in listing["bars"]]
    names = "down_px_per_row", "across_px_per_column", "origin_px", "height_m", "pitch_deg", "roll_deg"
    ground = result.ground and [five_decimals(getattr(result.ground, name)) for name in names]
    assert ground == (listing.get("ground") and [listing["ground"][name.replace("height", "camera_height")] for name in names])
    assert ground or kind != "stated"
    sectors = result.sectors()
    assert [linestereo.SectorState(state).name.lower() for state in sectors["state"]] == [sector["state"] for sector in listing["sectors"]]
    for name, field in (("distance", "distance_m"), ("drop_off", "drop_off_m")):
        assert [None if not np.isfinite(z) else z for z in sectors[name].tolist()] == [sector[field] for sector in listing["sectors"]]
    assert sorted(fault.value for fault in result.health) == sorted(listing["health"]["flags"])


def test_python_adds_little_to_the_time_of_the_core(pair):
    matcher = linestereo.Matcher(64, linestereo.Rig(200, 0.06))

    def ratio():
        start = time.perf_counter()
        result = matcher.match(*pair)
        return (time.perf_counter() - start) * 1e3 / result.milliseconds

    ratio()
    assert statistics.median(ratio() for _ in range(101)) < 1.25  # 1.1 on a quiet machine
