"""Matches one pair by OpenCV's StereoBM and StereoSGBM: python opencv.py LEFT RIGHT DISPARITIES RUNS OUT

Writes OUT/NAME.i16 (disparities in 1/16 px, native order) for each method and prints their times as JSON: {"NAME": milliseconds}.
"""
import json
import statistics
import sys
import time

try:
    import cv2
except ImportError as error:
    sys.exit(f"no cv2: {error}")


def block(texture, uniqueness, count):
    matcher = cv2.StereoBM_create(count, 15)
    matcher.setTextureThreshold(texture)
    matcher.setUniquenessRatio(uniqueness)
    return matcher


def semi_global(uniqueness, count, mode=cv2.STEREO_SGBM_MODE_SGBM):
    # Penalties as OpenCV's documentation recommends them; everything else as its sample
    # stereo_match has it.
    side = 5
    return cv2.StereoSGBM_create(
        minDisparity=0, numDisparities=count, blockSize=side, P1=8 * side * side, P2=32 * side * side, disp12MaxDiff=1,
        preFilterCap=63, uniquenessRatio=uniqueness, speckleWindowSize=100, speckleRange=32, mode=mode)


def main(left, right, count, runs, out):
    cv2.setNumThreads(1)
    left, right = (cv2.imread(path, cv2.IMREAD_GRAYSCALE) for path in (left, right))
    matchers = {
        "opencv-bm": block(10, 15, count),
        "opencv-bm-strict": block(3000, 90, count),
        "opencv-sgbm": semi_global(10, count),
        "opencv-sgbm-strict": semi_global(80, count),
        "opencv-sgbm8": semi_global(10, count, cv2.STEREO_SGBM_MODE_HH),
        "opencv-sgbm8-strict": semi_global(95, count, cv2.STEREO_SGBM_MODE_HH),
    }
    times = {}
    for name, matcher in matchers.items():
        measured = []
        for _ in range(runs):
            start = time.perf_counter()
            found = matcher.compute(left, right)
            measured.append(1e3 * (time.perf_counter() - start))
        found.astype("int16").tofile(f"{out}/{name}.i16")
        times[name] = statistics.median(measured)
    json.dump({"version": cv2.__version__, "milliseconds": times}, sys.stdout)


main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]), sys.argv[5])
