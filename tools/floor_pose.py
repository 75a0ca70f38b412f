"""Finds the pose of a camera above a floor: fits a plane to a region of its depth image.

    python tools/floor_pose.py            # prints world_from_camera of the demonstration

The floor becomes y = 0, up +Y; the camera stands above the origin and looks along −Z.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from andon.spaces import View
from andon.surface.depth import DepthEncoding, depth_from_raw

DATA = Path(__file__).parents[1] / "src/andon/data/motorcycle"


def main() -> None:
    """Prints the matrix as TOML."""
    raw = np.load(DATA / "disparity.npz")["arr_0"].astype(float)
    view = View("pinhole", 741, 500, 994.978, 994.978, 311.193, 254.877)
    depth = depth_from_raw(
        raw, view, DepthEncoding("disparity", baseline_m=0.193001, doffs_px=31.086)
    )
    points = (view.rays_planar() * depth[..., None])[400:, 20:720].reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    for _ in range(20):  # least squares, outliers (tyres, stand) dropped
        centre = points.mean(axis=0)
        normal = np.linalg.svd(points - centre, full_matrices=False)[2][2]
        distance = (points - centre) @ normal
        points = points[np.abs(distance) < max(0.005, 2 * np.median(np.abs(distance)))]
    up = -normal * np.sign(normal[1])  # camera y points down
    height = -centre @ up
    back = -np.array([0, 0, 1.0])
    back -= (back @ up) * up
    back /= np.linalg.norm(back)
    rotation = np.stack([np.cross(up, back), up, back])  # rows: world axes in the camera
    pose = np.eye(4)
    pose[:3, :3], pose[1, 3] = rotation, height
    print("world_from_camera = [")
    for row in pose:
        print("  [" + ", ".join(f"{x:.6f}" for x in row) + "],")
    print("]")


if __name__ == "__main__":
    main()
