"""Files from strangers: bounded, path-confined readers and atomic writers.

Whatever a file contains, a reader returns a checked value or raises one `InputError`; it never
allocates what a header merely claims, never opens a file outside the folder of the one that names
it, never runs or unpickles anything. `READERS` lists them all, and the fuzz suite walks that list.

The alternative, one general library per kind (imageio, trimesh, pygltflib), was rejected: each
fails at a point that matters for light or for safety (8-bit HDR, wrong indices, ``../``), and their
failures surface as arbitrary exceptions. Where a library is the best decoder (Pillow, OpenCV,
OpenEXR, PyYAML) it is used behind our checks, and imported only when needed.
"""

from __future__ import annotations

from andon.files.cameras import camera_from_table, read_camera, write_camera
from andon.files.depth import read_depth_array
from andon.files.gaze import DistanceRecording, GazeRecording, PupilRecording, read_gaze
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.meshes import MeshFile, MeshLight, read_mesh
from andon.files.paths import confined, open_bounded
from andon.files.photometry import Distribution, read_photometry
from andon.files.pictures import (
    Picture,
    decode_picture,
    read_picture,
    write_exr,
    write_jpeg,
    write_npy,
    write_picture,
    write_png,
)
from andon.files.reader import Reader
from andon.files.registry import READERS, reader_for
from andon.files.volumes import ProbeVolume, read_volume, write_volume

__all__ = [
    "DEFAULT_LIMITS",
    "READERS",
    "DistanceRecording",
    "Distribution",
    "GazeRecording",
    "Limits",
    "MeshFile",
    "MeshLight",
    "Picture",
    "ProbeVolume",
    "PupilRecording",
    "Reader",
    "camera_from_table",
    "confined",
    "decode_picture",
    "open_bounded",
    "read_camera",
    "read_depth_array",
    "read_gaze",
    "read_mesh",
    "read_photometry",
    "read_picture",
    "read_volume",
    "reader_for",
    "write_camera",
    "write_exr",
    "write_jpeg",
    "write_npy",
    "write_picture",
    "write_png",
    "write_volume",
]
