"""Probe volumes: light probes and the space between them, in one open file."""

from __future__ import annotations

from andon.files.volumes.model import Cells, Distances, ProbeRole, ProbeVolume, Zone

__all__ = ["Cells", "Distances", "ProbeRole", "ProbeVolume", "Zone"]
