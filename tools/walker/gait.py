"""One second of walking: turns of the joints that come back to where they began.

Angles are smooth periodic curves through what textbooks on gait show for adults: the hip swings
30° forward to 10° backward; the knee bends by 18° under load and by 60° in swing; the foot lands
on its heel, is flat from 8 % to 40 % of the cycle, and leaves by its toes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from walker.bones import NAMES, REST, posed, quaternion

__all__ = ["CYCLE_SECONDS", "Gait", "gait"]

Float = NDArray[np.float64]
Gait = tuple[Float, dict[str, Float], Float, float]

CYCLE_SECONDS = 1.0
KEYS = 24
# Corners of the sole, from the ankle: heel and toe.
SOLE = np.array([(0.0, -0.085, -0.058), (0.0, -0.085, 0.15), (0.0, -0.080, 0.19)])
# Harmonics of a step, two to the cycle, that the height of the hips is made of: soles then are
# within 3 mm of the floor.
BOB_HARMONICS = 2


def _bump(phase: Float, at: float, width: float) -> Float:
    """A bell at `at`, in cycles, that repeats every cycle."""
    away = (phase - at + 0.5) % 1 - 0.5
    return np.exp(-((away / width) ** 2))


def _leg(phase: Float) -> tuple[Float, Float, Float]:
    """Turns of hip, knee and ankle around +X in degrees; forward is negative."""
    hip = 9 + 20 * np.cos(2 * np.pi * (phase - 0.02))
    knee = 4 + 13 * _bump(phase, 0.14, 0.075) + 57 * _bump(phase, 0.71, 0.14)
    pitch = 18 * _bump(phase, 0.985, 0.055) - 50 * _bump(phase, 0.66, 0.085)
    return -hip, knee, hip - knee - pitch


def _product(a: Float, b: Float) -> Float:
    """Quaternions (..., 4): first b, then a."""
    ax, ay, az, aw = np.moveaxis(a, -1, 0)
    bx, by, bz, bw = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )


def _turns(phase: Float) -> dict[str, Float]:
    swing = np.cos(2 * np.pi * phase)  # 1: the left leg is in front
    sway = np.sin(2 * np.pi * phase)  # 1: the left leg stands
    turns = {
        "hips": _product(quaternion("y", -6 * swing), quaternion("z", 2.5 * sway)),
        "spine": _product(quaternion("y", 5 * swing), quaternion("z", -3.0 * sway)),
        "chest": _product(quaternion("y", 8 * swing), quaternion("x", 2.0 + 0 * swing)),
        "neck": quaternion("y", -4 * swing),
        "head": _product(quaternion("y", -3 * swing), quaternion("x", -2.0 + 0 * swing)),
    }
    for side, shift, sign in (("left", 0.0, 1.0), ("right", 0.5, -1.0)):
        hip, knee, ankle = _leg((phase + shift) % 1)
        turns[f"{side} thigh"] = quaternion("x", hip)
        turns[f"{side} shin"] = quaternion("x", knee)
        turns[f"{side} foot"] = quaternion("x", ankle)
        forward = -4 - 20 * np.cos(2 * np.pi * (phase + shift + 0.5 - 0.03))
        turns[f"{side} upper arm"] = _product(
            quaternion("x", forward + 8), quaternion("z", 2.0 * sign + 0 * forward)
        )
        bend = 20 + 12 * np.cos(2 * np.pi * (phase + shift + 0.5 - 0.08))
        turns[f"{side} forearm"] = quaternion("x", -bend)
        turns[f"{side} hand"] = quaternion("x", -4 + 0 * bend)
    return turns


def gait() -> Gait:
    """Times (k,), turns (k, 4) of joints, places of the hips (k, 3), and the speed in m/s.

    The hips are as high as keeps the lower sole on the floor; the speed is that of the standing
    foot under them.
    """
    phase = np.linspace(0, 1, KEYS + 1)
    turns = _turns(phase)
    hips = np.tile(REST[0], (len(phase), 1))
    hips[:, 0] += 0.018 * np.sin(2 * np.pi * phase)
    soles = _soles(posed(turns, hips))
    lift = soles[..., 1].min(axis=(1, 2))
    hips[:, 1] -= _smooth(lift[:-1])[np.r_[0:KEYS, 0]]
    # Between a tenth and four tenths of the cycle the left foot is flat on the floor.
    flat = (phase >= 0.10) & (phase <= 0.40)
    heel = soles[flat, 0, 0, 2]
    speed = -float(np.polyfit(phase[flat] * CYCLE_SECONDS, heel, 1)[0])
    return phase * CYCLE_SECONDS, turns, hips, speed


def _soles(world: Float) -> Float:
    """(k, 2, 3, 3) heel, ball and toe of both feet."""
    feet = [NAMES.index(f"{side} foot") for side in ("left", "right")]
    frames = world[:, feet]
    return np.einsum("kfij,sj->kfsi", frames[..., :3, :3], SOLE) + frames[:, :, None, :3, 3]


def _smooth(values: Float) -> Float:
    """The first harmonics of one cycle: steps that are not abrupt."""
    spectrum = np.fft.rfft(values)
    spectrum[2 * BOB_HARMONICS + 1 :] = 0
    return np.fft.irfft(spectrum, len(values))
