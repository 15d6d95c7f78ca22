"""Worker of `linestereo-lab bench`: reads pairs, damages them, and matches them by OpenCV.

Each line of stdin is a request:

  {"pairs": [{"left": FILE, "right": FILE, "disparities": N}, ...],
   "damage": "none" | "gain" | "blurS" | "noiseS", "generator_per_pair": BOOL, "cache": FOLDER or null}

For each pair stdout has a line of JSON, {"width": W, "height": H, "answered": N}, and behind it in native byte order:

  left, right    u8   W * H each: the pixels, damaged
  sgbm, bm       i16  W * H each: disparities in 1/16 px with uniqueness 15 and a speckle filter, <= 0 is a gap
  disparity      i16  W * H: of SGBM with the largest uniqueness ratio that a pixel survives
  level          u8   W * H: that ratio plus 1, 0 is a gap
  ties           f64  N: in [0, 1), which decides between pixels of one level, for each pixel with a level, row by row

Everything that is drawn comes from one generator in the order of the pairs (or from a new one for each pair).
"""
import hashlib
import json
import os
import sys

try:
    import cv2
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}; pip install opencv-python-headless numpy")

UNIQUENESS = (0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95)
MAPS = ("sgbm", "bm", "disparity", "level")


def damaged(left, right, damage, generator):
    def noisy(image, sigma):
        return np.clip(image + generator.normal(0, sigma, image.shape), 0, 255).astype(np.uint8)

    if damage == "gain":
        right = np.clip(right * 0.8 + 8, 0, 255).astype(np.uint8)
    elif damage.startswith("noise"):
        sigma = int(damage.removeprefix("noise"))
        left = noisy(left, sigma)
        right = noisy(right, sigma)
    elif damage.startswith("blur"):
        sigma = int(damage.removeprefix("blur"))
        left, right = (cv2.GaussianBlur(image, (0, 0), sigma) for image in (left, right))
    return left, right


def semi_global(count, uniqueness, **filter):
    return cv2.StereoSGBM_create(0, count, 5, P1=200, P2=800, disp12MaxDiff=1, uniquenessRatio=uniqueness, **filter)


def block(count):
    matcher = cv2.StereoBM_create(count, 15)
    matcher.setUniquenessRatio(15)
    matcher.setTextureThreshold(10)
    matcher.setDisp12MaxDiff(1)
    matcher.setSpeckleWindowSize(60)
    matcher.setSpeckleRange(1)
    return matcher


def matched(left, right, count):
    disparity = np.zeros(left.shape, np.int16)
    level = np.zeros(left.shape, np.uint8)
    for uniqueness in UNIQUENESS:
        found = semi_global(count, uniqueness).compute(left, right)
        answered = found > 0
        disparity[answered] = found[answered]
        level[answered] = uniqueness + 1
    sgbm = semi_global(count, 15, speckleWindowSize=60, speckleRange=1).compute(left, right)
    return {"sgbm": sgbm, "bm": block(count).compute(left, right), "disparity": disparity, "level": level}


def cached(left, right, count, folder):
    if folder is None:
        return matched(left, right, count)
    settings = f"{cv2.__version__} {count} {left.shape} {UNIQUENESS} 1"
    key = hashlib.sha256(settings.encode() + left.tobytes() + right.tobytes()).hexdigest()[:32]
    path = os.path.join(folder, key + ".npz")
    try:
        with np.load(path) as stored:
            return {name: stored[name] for name in MAPS}
    except (OSError, ValueError, KeyError):
        maps = matched(left, right, count)
    os.makedirs(folder, exist_ok=True)
    temporary = f"{path}.{os.getpid()}"
    with open(temporary, "wb") as file:
        np.savez_compressed(file, **maps)
    os.replace(temporary, path)
    return maps


def read(path):
    image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if image is None:
        sys.exit(f"OpenCV cannot read {path}")
    return image


def answer(pair, request, generator, out):
    left, right = read(pair["left"]), read(pair["right"])
    left, right = damaged(left, right, request["damage"], generator)
    maps = cached(left, right, pair["disparities"], request["cache"])
    answered = int(np.count_nonzero(maps["level"]))
    ties = generator.random(answered)
    height, width = left.shape
    out.write(json.dumps({"width": width, "height": height, "answered": answered}).encode() + b"\n")
    for array in (left, right, *(maps[name] for name in MAPS), ties):
        out.write(np.ascontiguousarray(array).tobytes())
    out.flush()


def main():
    cv2.setNumThreads(1)
    for line in sys.stdin:
        request = json.loads(line)
        generator = np.random.default_rng(1)
        for pair in request["pairs"]:
            if request["generator_per_pair"]:
                generator = np.random.default_rng(1)
            answer(pair, request, generator, sys.stdout.buffer)


if __name__ == "__main__":
    main()
