"""Small probe volumes whose cells are known by hand."""

from dataclasses import replace

import numpy as np

from andon.files.volumes import Cells, Distances, ProbeVolume, Zone, plain_volume

__all__ = ["bipyramid", "flat_volume", "light", "two_rooms"]

SEED = 11
FACES = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])  # seen from outside


def light(count, order=2, seed=SEED, mean=100.0):
    """(count, k, 3) coefficients in cd/m² with a positive mean luminance."""
    values = np.random.default_rng(seed).normal(0, 0.2 * mean, (count, (order + 1) ** 2, 3))
    values[:, 0] = np.abs(values[:, 0]) + mean
    return values


def bipyramid(shift=0.0):
    """(5, 3) positions, two tetrahedra over one face, and their hull of six facets."""
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 0, -1], [0.3, 1, -0.3], [0.3, -1, -0.3]], float)
    corners = np.array([[0, 2, 1, 3], [0, 1, 2, 4]])
    keys = [[frozenset(face) for face in row] for row in corners[:, FACES].tolist()]
    flat = [key for row in keys for key in row]
    neighbours = np.full((2, 4), -1)
    facets, behind = [], []
    for cell in range(2):
        for side in range(4):
            if flat.count(keys[cell][side]) == 2:
                neighbours[cell, side] = 1 - cell
            else:
                neighbours[cell, side] = -1 - len(facets)
                facets.append(corners[cell][FACES[side]])
                behind.append(cell)
    facets = np.array(facets)
    around = np.full((len(facets), 3), -1)
    for f, facet in enumerate(facets):
        for i in range(3):
            edge = {facet[j] for j in range(3) if j != i}
            around[f, i] = next(
                g for g, other in enumerate(facets) if g != f and edge <= set(other.tolist())
            )
    cells = Cells(
        corners.astype(np.int32),
        neighbours.astype(np.int32),
        facets.astype(np.int32),
        around.astype(np.int32),
        np.array(behind, np.int32),
        np.array([[0, 2]], np.int32),
        np.array([[0, 6]], np.int32),
    )
    return positions + shift, cells


def two_rooms(order=2):
    """A volume with all there is: two zones, roles, ranges, two states, distances, notes."""
    positions, cells = bipyramid()
    count = len(positions)
    both = Cells(
        np.concatenate([cells.corners, cells.corners + count]),
        np.concatenate([cells.neighbours, np.where(
            cells.neighbours < 0, cells.neighbours - 6, cells.neighbours + 2)]),
        np.concatenate([cells.facets, cells.facets + count]),
        np.concatenate([cells.facet_neighbours, cells.facet_neighbours + 6]),
        np.concatenate([cells.facet_cells, cells.facet_cells + 2]),
        np.array([[0, 2], [2, 2]], np.int32),
        np.array([[0, 6], [6, 6]], np.int32),
    )  # fmt: skip
    places = np.concatenate([positions, positions + np.array([5.0, 0.1, 0.0])])
    moments = np.random.default_rng(SEED).uniform(0.5, 3, (2 * count, 4, 4)).astype(np.float32)
    return ProbeVolume(
        places,
        places + np.array([0, 0, 0.01]),
        (*(f"probe {i}" for i in range(2 * count - 1)), "門"),
        ("sky", "bounce", "bleeding", *(("general",) * (2 * count - 3))),
        np.array([3.0] + [np.inf] * (2 * count - 1)),
        {"day": light(2 * count, order), "night": light(2 * count, order, seed=5, mean=2.0)},
        (
            Zone("west", np.arange(count, dtype=np.int32), np.array([[[-2, -2, -2], [2, 2, 2.0]]])),
            Zone(
                "east",
                np.arange(count, 2 * count, dtype=np.int32),
                np.array([[[3, -2, -2], [7, 2, 2.0]], [[7, 0, 0], [8.1, 1, 1]]]),
            ),
        ),
        both,
        Distances(moments, moments**2 * np.float32(1.1), 100.0),
        "absolute",
        {"generator": "a test", "scene": "zwei Räume"},
    )


def flat_volume(kind):
    """Volumes without tetrahedra: ``plane``, ``line`` or ``point``; or without ``cells``."""
    counts = {"plane": 4, "line": 3, "point": 1, "cells": 2}
    positions = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 1]], float)[: counts[kind]]
    facets = {
        "plane": ([[0, 1, 3], [1, 2, 3]], [[1, -1, -1], [-1, 0, -1]]),
        "line": ([[0, 1, 1], [1, 2, 2]], [[1, -1, -1], [-1, 0, -1]]),
        "point": ([[0, 0, 0]], [[-1, -1, -1]]),
    }
    volume = plain_volume(positions, light(len(positions)), photometry="relative")
    if kind == "cells":
        return volume
    none = np.zeros((0, 4), np.int32)
    corners, around = (np.array(values, np.int32) for values in facets[kind])
    cells = Cells(
        none,
        none,
        corners,
        around,
        np.full(len(corners), -1, np.int32),
        np.zeros((1, 2), np.int32),
        np.array([[0, len(corners)]], np.int32),
    )
    return replace(volume, cells=cells)
