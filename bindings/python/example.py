"""Matches a rectified pair and draws what was found: python example.py left.png right.png --focal-px 451 --baseline-m 0.075 --out depth.png"""

import argparse

import matplotlib

import linestereo

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("left")
parser.add_argument("right")
parser.add_argument("--max-disparity", type=int)
parser.add_argument("--focal-px", type=float)
parser.add_argument("--baseline-m", type=float)
parser.add_argument("--out", help="a picture instead of a window")
arguments = parser.parse_args()
if (arguments.focal_px is None) != (arguments.baseline_m is None):
    parser.error("depths need both --focal-px and --baseline-m")
if arguments.out:
    matplotlib.use("Agg")

# %% The pair: grey, 8 bits.
import matplotlib.pyplot as plt
import numpy as np


def grey(path):
    image = plt.imread(path)
    image = image[..., :3] @ [0.299, 0.587, 0.114] if image.ndim == 3 else image
    return np.rint(image if image.max() > 1 else image * 255).astype(np.uint8)


left, right = grey(arguments.left), grey(arguments.right)

# %% Match it.
rig = linestereo.Rig(arguments.focal_px, arguments.baseline_m) if arguments.focal_px else None
result = linestereo.match(left, right, max_disparity=arguments.max_disparity, rig=rig)
print(result, f"{result.milliseconds:.1f} ms")
for line in result.advice:
    print(f"health: {line}")

# %% Points by disparity, segments, and the points from above.
figure, (image, above) = plt.subplots(1, 2, figsize=(12, 5))
image.imshow(left, cmap="gray")
points = result.points
dots = image.scatter(points["x"], points["y"], c=points["disparity"], s=2, cmap="turbo")
for ends in result.segments["ends"]:
    image.plot(ends[:, 0], ends[:, 1], "w", linewidth=0.5)
figure.colorbar(dots, ax=image, label="disparity, px")
seen = points["depth"] if rig else 1 / np.maximum(points["disparity"], 0.5)
above.scatter((points["x"] - left.shape[1] / 2) * seen / (rig.focal_px if rig else left.shape[1]), seen, s=2, c=points["confidence"])
above.set(title="from above", xlabel="m" if rig else "without a rig: to scale", ylabel="m" if rig else "")
if arguments.out:
    figure.savefig(arguments.out)
else:
    plt.show()
