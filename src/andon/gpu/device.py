"""One device for one renderer."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache
from typing import Any

from andon.errors import MachineError

__all__ = ["Gpu", "adapter_summary", "open_gpu"]

NO_ADAPTER = (
    "install a Vulkan driver (Debian, Ubuntu: apt-get install mesa-vulkan-drivers) "
    "or use --engine reference"
)


# wgpu falls back to OpenGL where there is no Vulkan, Metal or D3D12. It lacks what the rest relies
# on (float render targets), so it counts as no adapter.
OPENGL = "OpenGL"


@dataclass(frozen=True)
class Gpu:
    """An open device and what it says of itself.

    Attributes
    ----------
    device : `wgpu.GPUDevice`.
    adapter_name : as the driver names it, for reports.
    is_software : the adapter is a CPU.
    has_timestamps : the device can time its own passes.
    """

    device: Any
    adapter_name: str
    is_software: bool
    has_timestamps: bool

    def wait(self) -> None:
        """Blocks until the device has done all that was submitted."""
        self.device._poll_wait()


def _request_adapter() -> Any | None:
    # The driver prints a complaint where no desktop session is; there is none to be had here.
    os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
    try:
        import wgpu

        adapter = wgpu.gpu.request_adapter_sync(power_preference="high-performance")
        if adapter.info["backend_type"] != OPENGL:
            return adapter
        others = wgpu.gpu.enumerate_adapters_sync()
        return next((a for a in others if a.info["backend_type"] != OPENGL), None)
    except (RuntimeError, OSError, ImportError):  # wgpu's way of saying that there is none
        return None


def adapter_summary() -> str | None:
    """One line on the adapter that would be used, or None where there is none."""
    adapter = _request_adapter()
    return None if adapter is None else _describe(adapter.info)


def _describe(info: Any) -> str:
    parts = [info["device"], info["description"], info["backend_type"]]
    return ", ".join(dict.fromkeys(part for part in parts if part))


@cache
def open_gpu() -> Gpu:
    """The process's device; made once, since a device is what textures can be shared on.

    Raises `MachineError` where no adapter is found.
    """
    adapter = _request_adapter()
    if adapter is None:
        raise MachineError("no GPU adapter found", remedy=NO_ADAPTER)
    features = [f for f in ("timestamp-query",) if f in adapter.features]
    device = adapter.request_device_sync(label="andon", required_features=features)
    info = adapter.info
    return Gpu(device, _describe(info), info["adapter_type"] == "CPU", bool(features))
