"""How much a file from a stranger may ask for before it is refused.

Every reader compares what a *header* claims with these limits before it allocates or decodes
anything, so a 40-byte file that claims 60000×60000 pixels costs 40 bytes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from andon.errors import InputError

__all__ = ["DEFAULT_LIMITS", "Limits", "check_at_most", "check_size"]


@dataclass(frozen=True)
class Limits:
    """Upper bounds on what one file may contain. Raise one by `dataclasses.replace`.

    Attributes
    ----------
    max_pixels : 2²⁷, 16384 × 8192: the largest panoramas in use; 1.5 GiB as float RGB.
    max_side : 32768, what GPU textures, JPEG tools and panoramas stay below by a factor of two.
    max_total_pixels : 2²⁸ over all textures of one mesh file, so that many small compressed
        pictures cannot add up to a large memory.
    max_file_bytes : 1 GiB, above an uncompressed 2²⁷ pixel half-float picture (768 MiB).
    max_text_bytes : 16 MiB of structured text (TOML, glTF's JSON, MTL), which grows tenfold when
        parsed into objects.
    max_mesh_text_bytes : 256 MiB of OBJ or ASCII PLY, about 3 million triangles; its lines grow
        tenfold as Python objects, too.
    max_camera_bytes : 1 MiB; a calibration with all its views has about 100 kB.
    max_vertices : 2²⁴, 1 GiB with normals and texture coordinates in float64.
    max_triangles : 2²⁴, the most that an Embree scene of a few GiB holds.
    max_probes : 2¹⁷ light probes in a volume; a lattice of 50 a side has 125,000.
    max_nodes : 5·10⁵ tables and lists of JSON or YAML, and as many nodes, primitives or materials;
        large exports have some 10⁴ nodes with four lists each.
    max_depth : 64 levels of nesting; Python's own parsers give up at about 1000.
    max_references : 1024 other files (textures, buffers, material libraries) per file.
    max_header_bytes : 64 KiB of text before the pixels of an HDR, PFM, PGM or PLY file.
    """

    max_pixels: int = 2**27
    max_side: int = 32768
    max_total_pixels: int = 2**28
    max_file_bytes: int = 2**30
    max_text_bytes: int = 2**24
    max_mesh_text_bytes: int = 2**28
    max_camera_bytes: int = 2**20
    max_vertices: int = 2**24
    max_triangles: int = 2**24
    max_probes: int = 2**17
    max_nodes: int = 500_000
    max_depth: int = 64
    max_references: int = 1024
    max_header_bytes: int = 2**16


DEFAULT_LIMITS = Limits()


def check_size(width: int, height: int, file: str | Path, limits: Limits = DEFAULT_LIMITS) -> None:
    """Refuse a picture whose header claims an empty or too large size in pixels."""
    if width < 1 or height < 1:
        raise InputError(
            f"must have at least 1×1 pixels, the header says {width}×{height}", file=file
        )
    if width > limits.max_side or height > limits.max_side or width * height > limits.max_pixels:
        raise InputError(
            f"must have sides of at most {limits.max_side} and at most {limits.max_pixels} pixels, "
            f"the header says {width}×{height}",
            file=file,
            remedy="scale the picture down",
        )


def check_at_most(count: int, most: int, what: str, file: str | Path) -> None:
    """Refuse a file that claims `count` > `most` of something."""
    if count > most:
        raise InputError(f"must have at most {most} {what}, the file claims {count}", file=file)
