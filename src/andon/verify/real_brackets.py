"""Real exposure series: a church on film, a canal by hand."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.camera import CameraCalibration, calibrate_camera
from andon.capture.align import align
from andon.capture.brackets import Bracket, bracket_of
from andon.capture.merge import merge
from andon.files.exposures import read_exposures
from andon.files.pictures import read_picture
from andon.verify.registry import NotShown

__all__ = ["against_reconstruction", "canal", "church"]

Float = NDArray[np.float64]

CHURCH, CANAL = "brackets_memorial", "brackets_piccante/venice"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def _folder(name: str) -> Path:
    root = os.environ.get("ANDON_DATA")
    if not root:
        raise NotShown(f"ANDON_DATA is not set: the folder that holds {name}")
    if not (Path(root) / name).is_dir():
        raise NotShown(f"{Path(root) / name} is missing")
    return Path(root) / name


@cache
def _church_bracket() -> Bracket:
    entries = read_exposures(_folder(CHURCH) / "image_list.txt")
    pictures = [read_picture(entry.path).values for entry in entries]
    names = [entry.path.name for entry in entries]
    return bracket_of(names, pictures, [entry.seconds for entry in entries])


@cache
def church() -> CameraCalibration:
    """Debevec & Malik's sixteen photographs of 1997, with the times that they published.

    Registered by them: what alignment there is stands in the files.
    """
    return calibrate_camera(_church_bracket())


@cache
def canal() -> CameraCalibration:
    """Three photographs taken by hand, with the times of their EXIF, aligned."""
    paths = sorted(_folder(CANAL).glob("*.jpg"))
    pictures = [read_picture(path) for path in paths]
    seconds = [float(picture.attributes["exposure_seconds"]) for picture in pictures]
    bracket = bracket_of([p.name for p in paths], [p.values for p in pictures], seconds)
    return calibrate_camera(align(bracket, "auto")[0])


@cache
def against_reconstruction(name: str, /) -> tuple[float, float, float]:
    """The church's merged light against another program's: in ln luminance over its pixels.

    Returns correlation, slope of ours over theirs (1: the same contrast), and the median distance
    in EV after one common factor.
    """
    bracket = _church_bracket()
    seen = np.logical_and.reduce(list(bracket.seen))
    theirs = read_picture(_folder(CHURCH) / f"third_party_recon_{name}.hdr").values[seen]
    ours = np.log2(np.maximum(merge(bracket).linear[seen] @ LUMINANCE, 1e-12))
    other = np.log2(np.maximum(theirs @ LUMINANCE, 1e-12))
    slope = float(np.polyfit(other, ours, 1)[0])
    apart = ours - other
    distance = float(np.median(np.abs(apart - np.median(apart))))
    return float(np.corrcoef(ours, other)[0, 1]), slope, distance
