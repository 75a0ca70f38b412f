"""Device, textures, host structs and WGSL imports."""

import numpy as np
import pytest

from andon.errors import MachineError
from andon.gpu import device
from andon.gpu.layout import HostStruct
from andon.gpu.textures import make_texture
from andon.gpu.wgsl import all_modules, resolve


@pytest.mark.parametrize("width", [1, 7, 16, 65])
@pytest.mark.parametrize(
    ("format", "dtype", "channels"),
    [
        ("rgba8unorm", "u1", 4),
        ("rgba16float", "f2", 4),
        ("rgba32uint", "u4", 4),
        ("r32float", "f4", 1),
    ],
)
def test_textures_give_back_what_was_written(gpu, format, dtype, channels, width):
    values = np.random.default_rng(0).integers(0, 200, (5, width, channels)).astype(dtype)
    texture = make_texture(gpu, format, width, 5)
    texture.write(values)
    back = texture.read()
    assert back.dtype == np.dtype(dtype)
    assert (back == values).all()


def test_layers_are_apart(gpu):
    texture = make_texture(gpu, "r32float", 3, 2, layers=2)
    texture.write(np.full((2, 3), 1.0), 0)
    texture.write(np.full((2, 3), 2.0), 1)
    assert texture.read(0).max() == 1
    assert texture.read(1).min() == 2


def test_a_texture_beyond_the_adapter_is_the_machines_fault(gpu):
    limit = gpu.device.limits["max-texture-dimension-2d"]
    with pytest.raises(MachineError, match="--engine reference"):
        make_texture(gpu, "r32float", limit + 1, 1)


def test_no_adapter_is_said_with_a_remedy(monkeypatch):
    monkeypatch.setattr(device, "_request_adapter", lambda: None)
    assert device.adapter_summary() is None
    with pytest.raises(MachineError, match=r"mesa-vulkan-drivers.*reference"):
        device.open_gpu.__wrapped__()


def test_host_structs_have_wgsls_alignment():
    """WGSL specification, 14.4.1: offsets of a struct of every kind of member, by hand."""
    struct = HostStruct(
        "Mixed",
        (
            ("a", "f32"),
            ("b", "vec2f"),
            ("c", "vec3f"),
            ("d", "f32"),
            ("e", "mat4x4f"),
            ("f", "u32"),
        ),
    )
    offsets = [struct.dtype.fields[name][1] for name in "abcdef"]
    assert offsets == [0, 8, 16, 28, 32, 96]
    assert struct.dtype.itemsize == 112
    assert struct.wgsl().splitlines()[1:3] == ["  a: f32,", "  b: vec2f,"]


def test_matrices_are_transposed_on_the_way():
    matrix = np.arange(16.0).reshape(4, 4)
    record = HostStruct("M", (("m", "mat4x4f"),)).pack(m=matrix)
    # WGSL reads columns one after the other.
    assert record.view("f4").tolist()[:4] == matrix[:, 0].tolist()


def test_imports_come_once_and_before_those_who_need_them():
    text = resolve("a", variants={
        "a": "//!import b\n//!import c\nfn a() {}", "b": "//!import c\nfn b() {}", "c": "fn c() {}",
    })  # fmt: skip
    assert [text.count(f"fn {name}()") for name in "abc"] == [1, 1, 1]
    assert text.index("fn c()") < text.index("fn b()") < text.index("fn a()")
    assert "//!import" not in text


def test_a_struct_is_declared_where_it_is_asked_for():
    struct = HostStruct("Lamp", (("x", "f32"),))
    text = resolve("a", {"Lamp": struct}, {"a": "//!struct Lamp\nfn a() {}"})
    assert text.count("struct Lamp {") == 1


def test_cycles_and_strangers_are_refused():
    cycle = {"a": "//!import b\n", "b": "//!import a\n"}
    with pytest.raises(ValueError, match="cycle: a → b → a"):
        resolve("a", variants=cycle)
    for path in ("andon/../secret.wgsl", "/etc/x.wgsl", "other/x.wgsl"):
        with pytest.raises(ValueError, match=r"inside andon/"):
            resolve(path)


def test_all_modules_are_found():
    modules = all_modules()
    assert {"andon/frame.wgsl", "andon/gbuffer/projections/fisheye.wgsl"} <= set(modules)
    assert len(modules) == len(set(modules)) >= 12
