"""Where the layers of glass appear, where the eyes look, and what could not be seen, in words."""

from __future__ import annotations

from andon.glass.focus import LayerVergences
from andon.glass.model import Focus
from andon.glass.report import GlassReport

__all__ = ["glass_notes"]

# Parts of the glass below which nobody sees that light had to be made up.
WORTH_SAYING = 0.001
# Dioptres: a kilometre.
INFINITELY_FAR = 1e-3


def glass_notes(report: GlassReport | None, /) -> list[str]:
    """One line each."""
    if report is None:
        return []
    if not report.counts.glass:
        return ["glass: none of it is seen: it is beside the picture, behind the eye, or hidden"]
    return [
        _on_focus(report.focus, report.pupil_mm, report.limit_dioptres),
        *_on_layers(report),
        *_on_counts(report),
    ]


def _on_focus(focus: Focus | None, pupil_mm: float, limit_dioptres: float) -> str:
    if focus is None:
        return "glass: everything is in focus; [gaze] or --gaze says where the eyes look"
    layer = {"surface": "the surface", "background": "the backdrop"}.get(focus.layer, "a distance")
    text = f"glass: the eyes look at {layer}, focused on {_place(focus.dioptres)}, "
    text += f"pupil {pupil_mm:.1f} mm"
    if focus.state == "held":
        text += "; no good sample of the gaze, the last one is held"
    if focus.state == "fallback":
        text += "; no gaze is known, so it is the surface"
    limit = f"; they focus on infinity to {_place(limit_dioptres)}, which it is not within"
    return text + (limit if focus.clamped else "")


def _on_layers(report: GlassReport) -> list[str]:
    seen, blur = report.vergences, report.blur_px
    rest = (
        f"straight it is at {_place(seen.background_straight)}; "
        f"with {_interfaces(3 - report.interfaces)} it would appear at "
        f"{_appears(report.other_vergences)}"
    )
    lines = [
        f"glass: in the middle of {report.name!r} the surface is at {_place(seen.surface)} and the "
        f"backdrop appears at {_appears(seen)}; {rest}",
        f"glass: in the median over all of it the surface is blurred by {blur['surface']:.1f} px, "
        f"the backdrop by {blur['refracted']:.1f} px",
    ]
    if report.lamps_left_out:
        lines.append(f"glass: {report.lamps_left_out} mirrored lamps, the darkest, are left out")
    if report.crossing_dioptres is not None:
        crossing = _place(report.crossing_dioptres)
        lines.append(f"glass: both eyes' rays to the middle of the backdrop cross at {crossing}")
    return lines


def _on_counts(report: GlassReport) -> list[str]:
    counts = report.counts
    told = (
        (counts.lost, "are mirrored inside until they are lost, and black"),
        (counts.missed, "hit no backdrop, and show the light around"),
        (counts.beside, "see what is not in the picture, and show its nearest pixel"),
        (counts.clamped, "are blurred by more than 64 px, and cut there"),
    )
    return [
        f"glass: {count / counts.glass:.1%} of its pixels {what}"
        for count, what in told
        if count > WORTH_SAYING * counts.glass
    ]


def _interfaces(count: int) -> str:
    return "one interface" if count == 1 else "two interfaces"


def _appears(seen: LayerVergences) -> str:
    return _place(seen.background_mean)


def _place(dioptres: float) -> str:
    """Dioptres, and metres where there is such a place in front of the eye."""
    if dioptres != dioptres:
        return "no place"
    if abs(dioptres) < INFINITELY_FAR:
        return "0 D (infinity)"
    if dioptres < 0:
        return f"{dioptres:.2f} D (behind the eye)"
    return f"{dioptres:.2f} D ({1 / dioptres:.2f} m)"
