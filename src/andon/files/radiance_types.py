"""Radiance's types of primitives: what follows their names.

From Radiance's reference manual (``ray/doc/ray.1`` of its sources, "Primitive types"); the types
are those that `oconv` 6.0a knows.
"""

from __future__ import annotations

__all__ = ["COMPILED", "FILES", "LIGHTS", "NUMBERS", "TYPES"]

# Which of its strings, from 0, name files; "." is none.
FILES: dict[bytes, tuple[int, ...]] = {
    b"texfunc": (3,),
    b"texdata": (3, 4, 5, 6),
    b"colorfunc": (3,),
    b"brightfunc": (1,),
    b"specfunc": (1,),
    b"colordata": (3, 4, 5, 6),
    b"brightdata": (1, 2),
    b"specdata": (1, 2),
    b"colorpict": (3, 4),
    b"specpict": (1, 2),
    b"specfile": (0,),
    b"colortext": (0, 1),
    b"brighttext": (0, 1),
    b"mixfunc": (3,),
    b"mixdata": (3, 4),
    b"mixpict": (3, 4),
    b"mixtext": (2, 3),
    b"plasfunc": (1,),
    b"metfunc": (1,),
    b"transfunc": (1,),
    b"BRTDfunc": (9,),
    b"WGMDfunc": (12,),
    b"plasdata": (1, 2),
    b"metdata": (1, 2),
    b"transdata": (1, 2),
    b"BSDF": (1, 5),
    b"aBSDF": (0, 4),
    b"plastic2": (3,),
    b"metal2": (3,),
    b"trans2": (3,),
    b"ashik2": (3,),
    b"prism1": (4,),
    b"prism2": (8,),
    b"instance": (0,),
    b"mesh": (0,),
}

# How many numbers, where that does not depend on the strings.
NUMBERS: dict[bytes, tuple[int, ...]] = {
    b"source": (4,),
    b"sphere": (4,),
    b"bubble": (4,),
    b"cone": (8,),
    b"cup": (8,),
    b"cylinder": (7,),
    b"tube": (7,),
    b"ring": (8,),
    b"instance": (0,),
    b"mesh": (0,),
    b"light": (3,),
    b"illum": (3,),
    b"glow": (4,),
    b"spotlight": (7,),
    b"mirror": (3,),
    b"plastic": (5,),
    b"metal": (5,),
    b"trans": (7,),
    b"plastic2": (6,),
    b"metal2": (6,),
    b"trans2": (8,),
    b"ashik2": (8,),
    b"dielectric": (5,),
    b"interface": (8,),
    b"glass": (3, 4),
    b"antimatter": (0,),
}

LIGHTS = frozenset({b"light", b"illum", b"glow", b"spotlight"})

# Their files hold primitives themselves, in binary.
COMPILED = frozenset({b"instance", b"mesh"})

TYPES = frozenset({*FILES, *NUMBERS, b"polygon", b"mist", b"spectrum"})
