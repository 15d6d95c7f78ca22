"""Sparse stereo depth from line segments and support points, each with the probability of being within 1 px.

    import cv2, linestereo
    left, right = (cv2.imread(name, cv2.IMREAD_GRAYSCALE) for name in ("left.png", "right.png"))
    result = linestereo.match(left, right, max_disparity=64, rig=linestereo.Rig(focal_px=451, baseline_m=0.075))
    if result.is_fit:
        print(result.points["depth"], result.objects(boxes=[[60, 30, 120, 90]]))

Images are numpy arrays of shape (rows, columns) and dtype uint8, with any strides, rectified: a point lies on one row in both. Left is the
reference; disparity is x_left - x_right; x grows right, y down, z forward; whole numbers are pixel centres. What cannot be used raises
`ValueError`, with what to do.
"""

from __future__ import annotations

import copyreg
import enum
import os
from dataclasses import dataclass
from typing import Any, Dict, FrozenSet, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Calibration, Rig, __version__

__all__ = ["BAR", "Calibration", "Fault", "Ground", "Matcher", "Object", "Obstacles", "POINT", "Result", "Rig",
           "SECTOR", "SEGMENT", "SectorState", "match", "rectify"]

def _calibration(image: bytes) -> Calibration:
    return Calibration._decoded(image)


copyreg.pickle(Calibration, lambda calibration: (_calibration, (calibration._encoded(),)))

POINT = np.dtype([("x", "<u2"), ("y", "<u2"), ("disparity", "<f4"), ("confidence", "<f4"), ("segment", "<i4"), ("depth", "<f8")])
"""A pixel of the left image: column and row in px, disparity in px, probability that it is within
1 px, index of its segment (-1: of a bar, or of a side that is not listed, -2: a support point),
depth in m (inf: too far, nan: no rig)."""

SEGMENT = np.dtype([
    ("ends", "<f4", (2, 2)), ("disparity", "<f4", 2), ("sigma", "<f4"), ("confidence", "<f4"), ("owner", "<u4"), ("_", "<u4"),
    ("depth", "<f8", 2), ("depth_sigma", "<f8", 2),
])
"""A line segment of the left image: x, y of both ends in px, disparity at both ends and its standard deviation in px, probability that it is
within 1 px, side that owns the edge (0 left, 1 right, 2 both; left is above where |dx| > 4 |dy|), depth at both ends and its standard deviation
in m (inf: too far, nan: no rig)."""

BAR = np.dtype([
    ("ends", "<f4", (2, 2)), ("width", "<f4"), ("disparity", "<f4", 2), ("sigma", "<f4"),
    ("confidence", "<f4"), ("_", "<u4"), ("depth", "<f8", 2), ("depth_sigma", "<f8", 2),
])
"""A pole, leg or stand of the left image, in front of what is around it: x, y of both ends of its
left edge in px, top first, width from the left to the right edge along a row in px, disparity at
both ends and its standard deviation in px, probability that it is within 1 px, depth at both ends
and its standard deviation in m (inf: too far, nan: no rig)."""


SECTOR = np.dtype([
    ("direction", "<f4"), ("state", "<u4"), ("distance", "<f8"), ("drop_off", "<f8"), ("confidence", "<f4"), ("drop_off_confidence", "<f4"),
    ("age_ms", "<u4"), ("drop_off_age_ms", "<u4"),
])
"""A direction: its middle in degrees clockwise from ahead, -180 to 180, its `SectorState`, distance of the nearest obstacle along the ground in
m (inf: free, nan: unknown, or not in view), distance to where the floor ends in m (nan: no drop-off is known), probability of the obstacle or
that the direction is free, probability of the drop-off, and the time since each of both was seen in ms (0 without one)."""


Valid = Optional[Tuple[Optional[npt.ArrayLike], Optional[npt.ArrayLike]]]


class Fault(enum.Enum):
    """Fault of a pair; `remedy` says what to do about it."""

    LEFT_EXPOSURE = "left_exposure"
    RIGHT_EXPOSURE = "right_exposure"
    LEFT_SATURATED = "left_saturated"
    RIGHT_SATURATED = "right_saturated"
    LEFT_DEAD = "left_dead"
    RIGHT_DEAD = "right_dead"
    LEFT_COVERED = "left_covered"
    RIGHT_COVERED = "right_covered"
    LEFT_FROZEN = "left_frozen"
    RIGHT_FROZEN = "right_frozen"
    LEFT_VIEW = "left_view"
    RIGHT_VIEW = "right_view"
    EXPOSURES_DIFFER = "exposures_differ"
    SKEW = "skew"
    ROWS_OFF = "rows_off"
    ROWS_DRIFT = "rows_drift"
    ROWS_UNEVEN = "rows_uneven"
    FEW_MATCHES = "few_matches"
    BEYOND_INFINITY = "beyond_infinity"
    RANGE_SMALL = "range_small"
    NO_PARALLAX = "no_parallax"
    SAME_PIXEL = "same_pixel"
    TORN = "torn"
    ROWS_FAR = "rows_far"
    SEGMENTS_DROPPED = "segments_dropped"
    """The list of segments was full or the budget of work spent: results are good, but not all that the images have."""


    @property
    def remedy(self) -> str:
        """What to do, in a sentence."""
        return _core.remedy(self.value) or ""


_FAULTS = [Fault(name) for name in _core.fault_names()]


class SectorState(enum.IntEnum):
    """State of a direction."""

    OUTSIDE = 0
    """Not in view of the camera."""
    UNKNOWN = 1
    """In view, but without evidence, or with evidence that is too old."""
    FREE = 2
    """Surfaces behind the range are seen, and none within it. Obstacles without texture, such as a blank wall, are not detected."""
    OBSTACLE = 3
    """An obstacle within the range."""


@dataclass(frozen=True)
class Object:
    """The depth of an object or of a pixel."""

    label: int
    """Position in the list of boxes, value or position of a mask."""
    disparity_px: Optional[float]
    """At the object's centre; None where it is not known."""
    sigma_px: float
    """Standard deviation of the disparity, px; 0 without one."""
    depth_m: float
    """nan without a rig or a disparity, inf for what is too far."""
    sigma_m: float
    """Standard deviation of the depth, m; nan where the depth is."""
    nearest_m: float
    """Depth of the nearest credible hypothesis, m; nan where the depth is."""
    support: int
    """Segments and support points behind the answer; 0 of a pixel."""
    confidence: float
    """Probability that the disparity is within 1 px, 0 to 1."""
    reason: Optional[str]
    """Why there is no disparity, in a word, as in the JSON of `linestereo run`."""
    text: Optional[str]
    """The same in a sentence."""

    @classmethod
    def _of(cls, answer: Any) -> Object:
        *numbers, reason = answer
        return cls(*numbers, *(reason or (None, None)))


@dataclass(frozen=True)
class Ground:
    """The ground plane of a pair, disparity = down * y + across * x + origin, and how the left
    camera stands above it."""

    down_px_per_row: float
    """Change of the disparity down the rows: baseline / height of a level camera."""
    across_px_per_column: float
    """Change of the disparity along the columns: roll."""
    origin_px: float
    """Disparity at the left top pixel, px."""
    height_m: float
    """Height of the camera above the ground, m; nan without a rig."""
    pitch_deg: float
    """How far the optical axis points down, degrees; nan without a rig."""
    roll_deg: float
    """How far the camera is rolled, clockwise as it looks, degrees; nan without a rig."""


class Result:
    """A matched pair."""

    points: npt.NDArray[np.void]
    """Structured array of dtype `POINT`, one a pixel at most: support points, then those of bars,
    then those of segments, most probable first."""
    segments: npt.NDArray[np.void]
    """Structured array of dtype `SEGMENT`, most confident first."""
    bars: npt.NDArray[np.void]
    """Structured array of dtype `BAR`, by the first row."""
    health: FrozenSet[Fault]
    """Faults of this pair, or of one shortly before; empty when all is well."""
    is_fit: bool
    """False when results may be wrong or outdated: then there are no points, no segments and no
    bars, and no object and no pixel has a depth."""

    ground: Optional[Ground]
    """The ground plane that was found, or that the camera's pose states; None where there is none,
    and of a pair that is not fit."""

    def __init__(self, matched: _core.Matched) -> None:
        self._matched: Optional[_core.Matched] = matched
        self._rest = (matched.size, matched.milliseconds, matched.segments_found)
        self.points = matched.take_points().view(POINT)
        self.segments = matched.take_segments().view(SEGMENT)
        self.bars = matched.take_bars().view(BAR)
        ground = matched.ground
        self.ground = Ground(*ground) if ground is not None else None
        bits, self.is_fit, is_cut = matched.health
        faults = [fault for bit, fault in enumerate(_FAULTS) if bits >> bit & 1]
        self.health = frozenset(faults + [Fault.SEGMENTS_DROPPED] * is_cut)

    @property
    def size(self) -> Tuple[int, int]:
        """Columns and rows of the images, px."""
        return self._rest[0]

    @property
    def milliseconds(self) -> float:
        """Time that the core took for the pair and its points, ms."""
        return self._rest[1]

    @property
    def segments_found(self) -> int:
        """Number of segments found in the left image, with a disparity or without."""
        return self._rest[2]

    @property
    def xyz(self) -> npt.NDArray[np.float64]:
        """Places of the points in m, shape (n, 3): x right, y down, z forward of the left camera; nan where the depth is infinite, or a number of the point nan. Needs a rig."""
        points = self.points
        return self._pair.xyz(np.stack([points[name].astype(np.float32) for name in ("x", "y", "disparity")], axis=1))

    @property
    def advice(self) -> List[str]:
        """A line for each fault, with what to do; empty when all is well."""
        return [f"{fault.value}: {fault.remedy}" for fault in Fault if fault in self.health]

    @property
    def _pair(self) -> _core.Matched:
        if self._matched is None:
            raise ValueError("this result was pickled or copied, without its images: ask the first one for objects, pixels and places")
        return self._matched

    def __getstate__(self) -> Dict[str, Any]:
        """Numbers, without the images that questions need."""
        return {**self.__dict__, "_matched": None}

    def objects(self, boxes: Optional[npt.ArrayLike] = None, masks: Optional[npt.ArrayLike] = None) -> List[Object]:
        """The depth of each object, in the order given; of a mask, in the order of labels.

        boxes: shape (n, 4), left, top, right, bottom in px, the last two exclusive; cut to the image.
        masks: bool of shape (n, rows, columns), or one image of labels, integers of shape (rows, columns), 0 to 65535, 0 for what is no object.
        """
        if (boxes is None) == (masks is None):
            raise ValueError("give either boxes or masks")
        if boxes is not None:
            boxes = np.asarray(boxes)
            if boxes.dtype.kind not in "iuf":
                raise ValueError(f"boxes have dtype {boxes.dtype}: give numbers")
            boxes = np.require(boxes, np.float64, ["A", "C"])  # fields of records lie anywhere
            if boxes.size == 0:
                return []
            if boxes.ndim != 2 or boxes.shape[1] != 4:
                raise ValueError(f"boxes have shape {boxes.shape}: give (n, 4), left, top, right, bottom")
            return [Object._of(answer) for answer in self._pair.boxes(boxes)]
        masks = np.asarray(masks)
        if masks.dtype == np.bool_ and masks.ndim == 3:
            found = (self._of_labels(mask, index) for index, mask in enumerate(masks))
            return [answer for answers in found for answer in answers]
        if masks.dtype == np.bool_ and masks.ndim == 2:
            return self._of_labels(masks, 0)
        if masks.dtype.kind not in "iu" or masks.ndim != 2:
            raise ValueError(f"masks have shape {masks.shape} and dtype {masks.dtype}: give bool of (n, rows, columns), or labels of (rows, columns)")
        if masks.size and not (0 <= masks.min() and masks.max() <= 65535):
            raise ValueError("masks: labels are outside 0 to 65535")
        return [Object._of(answer) for answer in self._pair.labels(np.require(masks, np.uint16, ["A", "C"]))]

    def _of_labels(self, mask: npt.NDArray[Any], label: int) -> List[Object]:
        answers = self._pair.labels(mask.astype(np.uint16))
        if not answers:
            raise ValueError(f"masks[{label}]: a region without pixels")
        return [Object._of((label, *answer[1:])) for answer in answers]

    def pixel(self, x: int, y: int) -> Object:
        """The depth of a pixel of the left image, on a segment or not; `reason` says why there is none."""
        width, height = self.size
        if not (0 <= x < width and 0 <= y < height):
            raise ValueError(f"pixel {x},{y} is outside of the image of {width}x{height}")
        return Object._of(self._pair.pixel(x, y))

    def sectors(self, **parameters: Any) -> npt.NDArray[np.void]:
        """Nearest obstacle and nearest drop-off of each direction by this pair alone: a structured array of dtype `SECTOR`, the sectors of a turn
        from ahead on, clockwise. Parameters are those of `Obstacles`, which keeps them from pair to pair. Needs a rig."""
        return Obstacles(**parameters).update(self, 0)

    def __repr__(self) -> str:
        health = "+".join(sorted(fault.value for fault in self.health)) or "good"
        return f"Result({len(self.points)} points, {len(self.segments)} segments, health: {health})"


class Matcher:
    """A matcher of the consecutive pairs of one rig: health knows those before (a frozen camera, drifting rows)."""

    def __init__(self, max_disparity: Optional[int] = None, rig: Union[Rig, Calibration, None] = None, *, min_disparity: int = 0,
                 min_confidence: Optional[float] = None) -> None:
        """max_disparity: end of the disparities searched, px; 8 to 256 above min_disparity, below the width; 64 without, or what a narrower image
        allows. focal length in px * baseline in m / (max_disparity - 1.5) is the nearest depth.
        rig: a `Rig` gives depths; a `Calibration` rectifies raw pairs first.
        min_disparity: first disparity searched, px; -32 to 0.
        min_confidence: least probability of points and segments, 0.1 to 0.99; 0.9 without.
        """
        limits = {"max_disparity": (max_disparity, 0, 65535), "min_disparity": (min_disparity, -32768, 32767)}
        for name, (value, low, high) in limits.items():
            if value is not None and not low <= value <= high:
                raise ValueError(f"{name} is {value}, outside {low} to {high}")
        self._parameters = (max_disparity, rig, min_disparity, min_confidence)
        self._matcher = _core.Matcher(*self._parameters)

    def __getstate__(self) -> Tuple[Any, ...]:
        """Parameters alone: a matcher that is unpickled knows no pair before, and no pose."""
        return self._parameters

    def __setstate__(self, state: Tuple[Any, ...]) -> None:
        self._parameters = state
        self._matcher = _core.Matcher(*state)

    def expect_ground(self, height_m: float, pitch_deg: float, roll_deg: float = 0.0) -> None:
        """States the camera's pose for the pairs that follow: measured by an IMU before each pair,
        or once, as it is mounted. The ground is looked for there alone, and taken as stated where
        it is not seen. Needs a rig. A refused pose changes nothing.

        height_m: of the left camera above the ground, m; 0.01 to 100, and a quarter of the baseline
            or more.
        pitch_deg: how far the optical axis points down, degrees; -80 to 80.
        roll_deg: how far the camera is rolled, clockwise as it looks, degrees; -80 to 80.
        """
        self._matcher.expect_ground((height_m, pitch_deg, roll_deg))

    def forget_ground(self) -> None:
        """The camera's pose is not known, as at first: the ground is looked for in the images."""
        self._matcher.expect_ground(None)

    def match(self, left: npt.ArrayLike, right: npt.ArrayLike, times_us: Optional[Tuple[int, int]] = None, valid: Valid = None) -> Result:
        """Matches the next pair. Other threads run meanwhile; this matcher must not be used by two.

        left, right: grey images, dtype uint8, shape (rows, columns), 16x16 to 1280x1280.
        times_us: times of capture, left and right, us of one clock: more than 1 ms apart are refused (`Fault.SKEW`).
        valid: pixels of the left and of the right image that show anything, None where all do: bool of (rows, columns), in one piece along each
        row, or of each row the first and the one behind the last, integers of (rows, 2). Nothing is matched beyond them, nor next to them.
        """
        images = _image(left, "left"), _image(right, "right")
        if valid is not None and (isinstance(valid, np.ndarray) or len(valid) != 2):
            raise ValueError("valid: give two, one of the left and one of the right image, None where all of it is valid")
        if valid is not None and isinstance(self._parameters[1], Calibration):
            raise ValueError("valid: a raw pair is rectified first, and the calibration knows which pixels that leaves; leave valid out")
        if times_us is not None and min(times_us) < 0:
            raise ValueError(f"times_us are {tuple(times_us)} but must be 0 or more")
        first, second = valid or (None, None)
        return Result(self._matcher.match(*images, times_us, (_spans(first, images[0], "left"), _spans(second, images[1], "right"))))


class Obstacles:
    """Nearest obstacle and nearest drop-off of each direction over consecutive pairs of one rig. Heights are counted from the floor where its
    plane is found: it is then no obstacle, and where it ends there is a drop-off."""

    def __init__(self, *, yaw_deg: float = 0.0, sectors: int = 72, range_m: float = 10.0, heights_m: Tuple[float, float] = (-1000.0, 1000.0),
                 drop_m: Optional[float] = 0.05, keep_ms: int = 500, error_probability: float = 0.01) -> None:
        """yaw_deg: direction of the optical axis, degrees clockwise from ahead, -180 to 180.
        sectors: of a full turn, 4 to 72.
        range_m: obstacles and drop-offs at this distance or farther are ignored, 0.1 to 600 m.
        heights_m: lowest and highest height of obstacles, m above the camera, -1000 to 1000.
        drop_m: least depth of a drop-off below the floor, 0 to 100 m; None for a vehicle that flies.
        keep_ms: time for which a state is kept when it is not seen again, 0 to 65535 ms.
        error_probability: largest probability that all evidence of a state is wrong, 0.00002 to 0.5.
        """
        for name, value, low, high in (("sectors", sectors, 4, 72), ("keep_ms", keep_ms, 0, 65535)):
            if not low <= value <= high:
                raise ValueError(f"{name} is {value} but must be {low} to {high}")
        low_m, high_m = heights_m
        self._obstacles = _core.Obstacles(yaw_deg, sectors, range_m, [low_m, high_m], drop_m, keep_ms, error_probability)

    def update(self, result: Result, time_us: int) -> npt.NDArray[np.void]:
        """Takes a matched pair, captured at `time_us` of a steady clock, and returns `sectors(time_us)`. A pair that is not fit to be used changes
        nothing but ages; after a pair of another rig or size only that one is known."""
        if time_us < 0:
            raise ValueError(f"time_us is {time_us} but must be 0 or more")
        self._obstacles.update(result._pair, time_us)
        return self.sectors(time_us)

    def sectors(self, time_us: int) -> npt.NDArray[np.void]:
        """What is known at this time: a structured array of dtype `SECTOR`, the sectors of a turn from ahead on, clockwise."""
        return self._obstacles.sectors(time_us).view(SECTOR)


def match(left: npt.ArrayLike, right: npt.ArrayLike, max_disparity: Optional[int] = None, rig: Union[Rig, Calibration, None] = None, *,
          valid: Valid = None, **parameters: Any) -> Result:
    """Matches one pair that stands alone; parameters and images as those of `Matcher`."""
    return Matcher(max_disparity, rig, **parameters).match(left, right, valid=valid)


def rectify(left: npt.ArrayLike, right: npt.ArrayLike, calibration: Calibration) -> Tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """Rectifies a raw pair: two uint8 images of `calibration.size`. What has no source is black: `match` them with `valid=calibration.valid`, or the
    raw ones with the calibration as the rig."""
    first, second = calibration.rectify(_image(left, "left"), _image(right, "right"))
    return first, second


def _image(image: Any, name: str) -> npt.NDArray[Any]:
    if image is None:
        raise ValueError(f"{name} is None: cv2.imread gives that for a file that it cannot read; check its path")
    if isinstance(image, (str, os.PathLike)):
        raise ValueError(f"{name} is {type(image).__name__}: give its pixels, as by cv2.imread({name}, cv2.IMREAD_GRAYSCALE)")
    return np.asarray(image)


def _spans(valid: Any, image: npt.NDArray[Any], side: str) -> Optional[npt.NDArray[np.uint16]]:
    """Of each row the first valid pixel and the one behind the last."""
    if valid is None:
        return None
    given = np.asarray(valid)
    rows = image.shape[0] if image.ndim else 0
    if given.dtype == np.bool_ and given.shape == image.shape and given.ndim == 2:
        steps = np.diff(np.pad(given, ((0, 0), (1, 1))).astype(np.int8), axis=1)
        pieces = (steps == 1).sum(axis=1)
        if (pieces > 1).any():
            raise ValueError(f"valid: row {int(np.argmax(pieces > 1))} of the {side} image has valid pixels in more than one piece; give the widest one")
        ends = np.stack([steps.argmax(axis=1), steps.argmin(axis=1)], axis=1)
        return np.where(pieces[:, None] == 1, ends, 0).astype(np.uint16)
    if given.dtype.kind in "iu" and given.shape == (rows, 2):
        if given.size and not (0 <= given.min() and given.max() <= 65535):
            raise ValueError(f"valid: a column of the {side} image is outside 0 to 65535")
        return given.astype(np.uint16)
    raise ValueError(f"valid of the {side} image has shape {given.shape} and dtype {given.dtype}: give bool of {image.shape}, or integers of ({rows}, 2)")
