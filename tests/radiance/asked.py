"""A folder of files and points in it that Radiance is asked about."""

import tempfile
from pathlib import Path

import numpy as np

from andon.bake.tasks import write_bundle
from andon.files.radiance_programs import run_radiance
from andon.surface.objects import joined
from andon.transport.direct import reference
from andon.transport.direct.casters import Casters, ShadowRays
from worlds import ball, block

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


def open_room():
    """Floor and two walls (light may come from outside), a block and a ball."""
    floor = block((6, 0.2, 6), (0, -0.1, 0))
    back = block((6, 3, 0.2), (0, 1.5, -2.6))
    side = block((0.2, 3, 6), (-2.6, 1.5, 0))
    return joined(
        [floor, back, side, block((0.6, 1.0, 0.6), (-0.6, 0.5, -0.8)), ball(0.4, (0.6, 0.4, 0), 8)]
    )


def points_on(geometry, count, seed=1):
    """(count, 3) points spread evenly over the triangles, and the normals there."""
    random = np.random.default_rng(seed)
    corners = geometry.positions[geometry.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    chosen = random.choice(len(corners), count, p=area / area.sum())
    points = np.einsum("ij,ijk->ik", random.dirichlet((1, 1, 1), count), corners[chosen])
    return points, across[chosen] / area[chosen][:, None]


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
