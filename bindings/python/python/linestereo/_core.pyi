"""The compiled part: `linestereo` says what is for use."""

from os import PathLike
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

__version__: str

class Rig:
    """A rectified pair: depth = focal_px * baseline_m / (disparity + disparity_offset_px)."""
    def __new__(cls, focal_px: float, baseline_m: float, disparity_offset_px: float = 0.0,
                principal_point_px: Optional[Tuple[float, float]] = None) -> Rig:
        """focal_px: 1 to 100000; baseline_m: 0.0001 to 10; disparity_offset_px: column of the principal point on the right minus that on the
        left, -4096 to 4096; principal_point_px: column and row in the left image, -2048 to 2048, its centre without."""
    @property
    def focal_px(self) -> float:
        """Focal length, px."""
    @property
    def baseline_m(self) -> float:
        """Distance of the cameras, m."""
    @property
    def disparity_offset_px(self) -> float:
        """Added to every disparity, px."""
    @property
    def principal_point_px(self) -> Optional[Tuple[float, float]]:
        """Principal point of the left image, px; None for its centre."""

class Calibration:
    """Two calibrated cameras, and the view that their images are rectified to."""
    @staticmethod
    def load(path: Union[str, PathLike[str], Sequence[Union[str, PathLike[str]]]],
             size: Optional[Tuple[int, int]] = None, alpha: float = 0.0, focal_px: Optional[float] = None,
             raw_size: Optional[Tuple[int, int]] = None,
             translation_unit: Union[str, float, None] = None) -> Calibration:
        """Of a `rig.toml`, or of files of OpenCV, Kalibr, ROS or EuRoC: a list of two, the left camera's first, where each has its own.

        size: columns and rows of rectified images, those of raw ones without. alpha: 0 keeps no pixel without a source, 1 every raw pixel.
        focal_px: focal length of rectified images, px, instead of alpha. raw_size: columns and rows of raw images, where a file of OpenCV does
        not say them. translation_unit: of OpenCV's T: "m", "mm", or the side of the board's squares in mm; it is assumed without."""
    @property
    def notes(self) -> List[str]:
        """What had to be assumed, a sentence each."""
    @property
    def size(self) -> Tuple[int, int]:
        """Columns and rows of rectified images, px."""
    @property
    def raw_size(self) -> Tuple[int, int]:
        """Columns and rows of raw images, px."""
    @property
    def rig(self) -> Rig:
        """The rig of the rectified images."""
    @staticmethod
    def _decoded(image: bytes) -> Calibration: ...
    def _encoded(self) -> bytes: ...
    @property
    def valid(self) -> Tuple[npt.NDArray[np.uint16], npt.NDArray[np.uint16]]:
        """Of each row of the left and the right rectified image the first pixel with a source and the one behind the last."""
    def rectify(self, left: npt.NDArray[Any], right: npt.NDArray[Any]) -> Tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
        """As `linestereo.rectify`."""

class Matcher:
    def __new__(cls, max_disparity: Optional[int], rig: Union[Rig, Calibration, None], min_disparity: int,
                min_confidence: Optional[float]) -> Matcher: ...
    def expect_ground(self, pose: Optional[Tuple[float, float, float]]) -> None: ...
    def match(self, left: npt.NDArray[Any], right: npt.NDArray[Any], times_us: Optional[Tuple[int, int]],
              valid: Tuple[Optional[npt.NDArray[np.uint16]], ...]) -> Matched: ...

class Matched:
    def take_points(self) -> npt.NDArray[np.uint8]: ...
    def take_segments(self) -> npt.NDArray[np.uint8]: ...
    def take_bars(self) -> npt.NDArray[np.uint8]: ...
    @property
    def milliseconds(self) -> float: ...
    @property
    def size(self) -> Tuple[int, int]: ...
    @property
    def health(self) -> Tuple[int, bool, bool]: ...
    @property
    def ground(self) -> Optional[List[float]]: ...
    @property
    def segments_found(self) -> int: ...
    def xyz(self, points: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]: ...
    def boxes(self, boxes: npt.NDArray[np.float64]) -> List[Any]: ...
    def labels(self, labels: npt.NDArray[np.uint16]) -> List[Any]: ...
    def pixel(self, x: int, y: int) -> Any: ...

class Obstacles:
    def __new__(cls, yaw_deg: float, sectors: int, range_m: float, heights_m: List[float], drop_m: Optional[float], keep_ms: int,
                error_probability: float) -> Obstacles: ...
    def update(self, pair: Matched, time_us: int) -> None: ...
    def sectors(self, time_us: int) -> npt.NDArray[np.uint8]: ...

def fault_names() -> List[str]: ...
def remedy(name: str) -> Optional[str]: ...
