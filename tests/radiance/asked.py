"""A folder of files and points in it that Radiance is asked about."""

import tempfile
from pathlib import Path

import numpy as np

from andon.bake.tasks import write_bundle
from andon.files.radiance_programs import run_radiance
from andon.transport.direct import reference
from andon.transport.direct.casters import Casters, ShadowRays

# Every lamp at its tiles' middles, no light lost: what is left is what the files say.
EXACT = ["-dt", "0", "-dc", "1", "-dj", "0", "-ds", "0", "-lw", "1e-8", "-lr", "-20"]
# `rtrace -I` measures this far above the point that it is given.
RTRACE_LIFT_M = 1e-4


def lux_of(bundle, points, normals, bounces=0, *options):
    """(n, 3) illuminance in lux, 0.01 mm above the points."""
    rays = np.concatenate([points - (RTRACE_LIFT_M - 1e-5) * normals, normals], axis=1)
    return _traced(bundle, rays, ["-I", "-ab", str(bounces), *options])


def luminance_of(bundle, origins, directions):
    """(n, 3) cd/m² of what rays meet, in direct light."""
    return _traced(bundle, np.concatenate([origins, directions], axis=1), ["-ab", "0"])


def _traced(bundle, rays, options):
    with tempfile.TemporaryDirectory() as name:
        write_bundle(Path(name), bundle)
        words = ["-h", "-w", "-fdd", "-n", "1", "-u-", *EXACT, *options, "scene.oct"]
        feed = np.ascontiguousarray(rays, float).tobytes()
        answer = run_radiance("rtrace", words, feed, 120, cwd=Path(name))
    return np.frombuffer(answer).reshape(-1, 3) * 179


def our_direct(lamps, groups, points, normals):
    """(n, 3) lux of `andon.transport.direct.reference`, and (n,) where some shadow has its edge."""
    rays = ShadowRays(Casters(tuple(groups)))
    lifted = points + 1e-4 * normals
    lux, edge = np.zeros_like(points), np.zeros(len(points), bool)
    for lamp in lamps:
        lux += reference.arriving(lamp, points, normals, lifted, rays)
        share = reference.seen_share(lamp, points, normals, lifted, rays)
        edge |= (share.min(axis=1) < 1) & (share.max(axis=1) > 0)
    return lux, edge


def errors(ours, truth, kept):
    """Median and 95th percentile of the relative error where there is light, and its ratio."""
    lit = kept & (truth.max(axis=1) > 1e-3 * truth.max())
    error = np.abs(ours - truth).max(axis=1)[lit] / truth.max(axis=1)[lit]
    ratio = ours[kept].sum() / truth[kept].sum()
    return float(np.median(error)), float(np.percentile(error, 95)), float(ratio)
