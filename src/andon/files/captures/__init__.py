"""Other people's captures: folders of pictures with depth, intrinsics and poses.

=========== =============================================== ============= ======================
format      recognised by                                   depth         pose; the world's up
=========== =============================================== ============= ======================
tum         rgb.txt, depth.txt                              PNG, 1/5000 m world from camera; Z
slambook    pose.txt, color/, depth/                        PGM, mm       world from camera; −Y
realsense   camera_intrinsic.json, color/, depth/           PNG, mm       none
realsense   ``*_Color.png``, ``*_Depth.raw``, metadata CSV  uint16, mm    none
record3d    ``metadata``, rgbd/: a folder, or a zip (.r3d)  float32, m    ARKit's camera; Y
stray       camera_matrix.csv, odometry.csv, depth/         PNG, mm       world from camera; Y
arkitscenes lowres_depth/, lowres_wide/, lowres_wide.traj   PNG, mm       camera from world; Z
colmap      sparse/, images/, stereo/depth_maps/            float32       camera from world; −Y
=========== =============================================== ============= ======================

Cameras of all but ARKit's look along +z with y down, as ours do. Worlds are turned so that +Y is
up; slambook's and COLMAP's stand as their first camera did, so level there is what that camera was.
All of this happens here, at the border: a `CaptureFrame` has our axes, metres, and NaN in holes.

Names of files that a capture lists stay inside its folder; sizes are checked before memory is
taken.
"""

from __future__ import annotations

from andon.files.captures.find import FORMATS, open_capture
from andon.files.captures.model import Capture, CaptureFrame, Photo

__all__ = ["FORMATS", "Capture", "CaptureFrame", "Photo", "open_capture"]
