"""Flare needles: the fine rays of a star around a small bright source, seen by one eye.

What
    Needles begin at the source's outline and lie on great circles through it. Their number, length
    and azimuth follow from light, size, background, mist, glasses, pupil and the Gaussian noise of
    the eye (`determinants`): the paper's equations 6 to 8 are lost, and this is a *reconstruction*
    from the list of their arguments. Below a contrast of 40 there are none (`andon.glare.gate`).
Why this way
    The pattern belongs to the eye: its azimuths are those of the camera's frame, the same around
    every source, so they roll with the head, and left and right differ. Its random numbers are
    drawn once (`pattern`), so light that changes fades needles in and out and moves none.
Energy
    Needles take a stated share of the source's light, at most `NeedleModel.share`, and the share
    of a needle is its own, whether others are seen or not. `Needles.share` is to be taken from
    what stays in the source.
Colour
    Needles are diffraction: the same grain of the lens throws light of another wavelength λ in
    proportion to λ farther, so a needle is a spectrum drawn out along itself (van den Berg et al.
    2005). Each channel's length is λ/568 nm times the stated one, with the same light in each:
    feet are bluish, tips reddish, and the whole as white as the source.
Instead of what
    A texture of a star, as games have, has no outline to begin at, does not answer to light or
    pupil, and aliases. Rays through a model of the eye's optics (Ritschel et al. 2009) cost a
    Fourier transform a frame.

Drawn as thin quads around each needle; the pixels compute their angles from their own direction, so
pinhole, fisheye and latlong pictures agree. What is thinner than a pixel is drawn as wide as one
with the same light.

Sources: the glare paper, equations 5 to 8 and figures 5 and 6; van den Berg et al. 2005; Ritschel
et al. 2009; Spencer et al. 1995 (wavelengths); Owen 1995 (scrambling).
"""

from __future__ import annotations

from andon.glare.needles.determinants import needles_of
from andon.glare.needles.model import NeedleModel, Needles

__all__ = ["NeedleModel", "Needles", "needles_of"]
