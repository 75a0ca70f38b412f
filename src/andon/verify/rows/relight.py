"""Rows of relighting: lamps, shadows, the frame."""

from __future__ import annotations

from typing import Literal

from andon.pipeline import EngineName
from andon.verify.registry import Row
from andon.verify.rows.closed_forms import floor_error, point_reference
from andon.verify.rows.motorcycle import decimation, identity_bytes, parity
from andon.verify.rows.room import against_radiance, paraboloids

__all__ = ["ROWS"]


def _rows(engine: EngineName) -> tuple[Row, ...]:
    return (
        Row(
            f"relight.identity.{engine}",
            "relight",
            0,
            "bytes",
            "the photograph's own bytes",
            lambda: identity_bytes(engine),
        ),
        Row(
            f"relight.scene.median.{engine}",
            "relight",
            0.01,
            "relative",
            "Radiance rtrace -I -ab 0, furnished room, 4 lamps",
            lambda: against_radiance(engine)[0],
        ),
        Row(
            f"relight.scene.p95.{engine}",
            "relight",
            0.03,
            "relative",
            "Radiance rtrace -I -ab 0, furnished room, 4 lamps",
            lambda: against_radiance(engine)[1],
        ),
        Row(
            f"relight.scene.left_out.{engine}",
            "relight",
            None,
            "share",
            "pixels within 2 px of a shadow's or 1 px of an object's edge",
            lambda: against_radiance(engine)[2],
        ),
    )


def _shadow_rows(shadow_filter: Literal["none", "exact"], size: int) -> tuple[Row, ...]:
    name = f"relight.paraboloid.{shadow_filter}_{size}"
    against = f"{RAYS}; {size}² map, filter {shadow_filter}"
    return (
        Row(
            f"{name}.differ",
            "relight",
            0.1,
            "% of pixels",
            against,
            lambda: paraboloids(shadow_filter, size)[0],
        ),
        Row(
            f"{name}.beyond_two_texels",
            "relight",
            0,
            "pixels",
            f"{against}; farther than 2 map texels from a true edge, of 3.3 million",
            lambda: paraboloids(shadow_filter, size)[1],
        ),
        Row(
            f"{name}.seam",
            "relight",
            0,
            "pixels",
            f"{against}; those of them on the seam",
            lambda: paraboloids(shadow_filter, size)[2],
        ),
    )


CLOSED_FORM = "closed forms, horizon included"
RAYS = "Embree shadow rays, room of 13,150 triangles, |cos φ| > 0.05"
TOLERANCE = "the reference engine on the motorcycle, away from shadow edges"

ROWS: tuple[Row, ...] = (
    Row("relight.point.reference", "relight", 1e-6, "relative", CLOSED_FORM, point_reference),
    Row("relight.point.gpu", "relight", 1e-3, "relative", CLOSED_FORM, lambda: floor_error("gpu")),
    *_rows("reference"),
    *_rows("gpu"),
    *_shadow_rows("exact", 2048),
    *_shadow_rows("none", 1024),
    Row(
        "relight.parity.within_5",
        "relight",
        99.9,
        "% of pixels",
        TOLERANCE,
        lambda: parity()[0],
        at_least=True,
    ),
    Row("relight.parity.mean", "relight", 0.5, "codes of 255", TOLERANCE, lambda: parity()[1]),
    Row(
        "relight.parity.left_out",
        "relight",
        None,
        "% of pixels",
        "pixels within 2 map texels of a true shadow's edge, or 1 px of an object's",
        lambda: parity()[2],
    ),
    Row(
        "relight.parity.all_pixels",
        "relight",
        None,
        "% within 5/255",
        "the reference engine on the motorcycle, every pixel",
        lambda: parity()[3],
    ),
    Row(
        "relight.decimation",
        "relight",
        None,
        "% of lit pixels",
        "the same shadows from all 640,000 triangles",
        decimation,
    ),
)
