"""The shape of the public API: names, signatures, annotations, docstrings.

`public_api.txt` is what a user may rely on; a change of it is a change of the API and belongs into
CHANGELOG.md. ``pytest tests/architecture --regenerate`` writes it anew.
"""

import dataclasses
import inspect
import typing
from pathlib import Path

import pytest

import andon

from .tree import modules

GOLDEN = Path(__file__).with_name("public_api.txt")


def public(name):
    return getattr(andon, name)


def is_table(thing):
    """A table of the scene file: its keys are published in docs/scene.schema.json, not here."""
    return hasattr(thing, "model_fields")


def parameter_text(parameter):
    text = parameter.name
    if parameter.annotation is not parameter.empty:
        text += f": {parameter.annotation}"
    if parameter.default is not parameter.empty:
        # A default that is built anew each time has no stable text.
        simple = isinstance(parameter.default, str | int | float | tuple | None)
        text += f" = {parameter.default!r}" if simple else " = …"
    return text


def signature_text(function, *, skip_self=False):
    """(a: int, /, b: str = '', *, c: bool) -> None, with annotations as they are written."""
    signature = inspect.signature(function)
    parts, previous = [], None
    for parameter in list(signature.parameters.values())[1 if skip_self else 0 :]:
        if previous == parameter.POSITIONAL_ONLY != parameter.kind:
            parts.append("/")
        if parameter.kind == parameter.KEYWORD_ONLY != previous:
            parts.append("*")
        parts.append(parameter_text(parameter))
        previous = parameter.kind
    if previous == inspect.Parameter.POSITIONAL_ONLY:
        parts.append("/")
    returned = signature.return_annotation
    arrow = "" if returned is inspect.Signature.empty else f" -> {returned}"
    return f"({', '.join(parts)}){arrow}"


def members(cls):
    """(name, member) of what `cls` and its bases in Andon define for others."""
    seen = {}
    for base in reversed(cls.__mro__):
        if base.__module__.startswith("andon"):
            seen |= {k: v for k, v in vars(base).items() if not k.startswith(("_", "model_"))}
    return sorted(seen.items())


def function_lines(name, thing):
    """A function; of a module, its functions and classes."""
    if not inspect.ismodule(thing):
        yield f"{name}{signature_text(thing)}"
        return
    for offered in thing.__all__:
        member = getattr(thing, offered)
        if inspect.isclass(member):
            yield from class_lines(f"{name}.{offered}", member)
        elif inspect.isfunction(member):
            yield f"{name}.{offered}{signature_text(member)}"
        else:
            yield f"{name}.{offered} = {member!r}"


def class_lines(name, cls):
    bases = [base.__name__ for base in cls.__bases__ if base is not object]
    yield f"class {name}({', '.join(bases)})" if bases else f"class {name}"
    if dataclasses.is_dataclass(cls):
        yield from (f"    {field.name}: {field.type}" for field in dataclasses.fields(cls))
    elif not is_table(cls) and "__init__" in vars(cls):
        yield f"    __init__{signature_text(cls.__init__, skip_self=True)}"
    fields = {f.name for f in dataclasses.fields(cls)} if dataclasses.is_dataclass(cls) else set()
    for member_name, member in members(cls):
        if isinstance(member, property):
            returned = inspect.signature(member.fget).return_annotation
            yield f"    {member_name} -> {returned}  (property)"
        elif inspect.isfunction(member) and member_name not in fields:
            yield f"    {member_name}{signature_text(member, skip_self=True)}"


def api_text():
    lines = []
    for name in andon.__all__:
        thing = public(name)
        if inspect.isclass(thing):
            lines += class_lines(name, thing)
        else:
            lines += function_lines(name, thing)
    return "\n".join(lines) + "\n"


def public_functions():
    """(name, function) of every public function and of every method of a public class."""
    for name in andon.__all__:
        thing = public(name)
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.ismodule(thing):
            offered = {f"{name}.{own}": getattr(thing, own) for own in thing.__all__}
            yield from ((n, member) for n, member in offered.items() if inspect.isfunction(member))
        else:
            for member_name, member in members(thing):
                function = member.fget if isinstance(member, property) else member
                if inspect.isfunction(function):
                    yield f"{name}.{member_name}", function


FUNCTIONS = dict(public_functions())
CLASSES = [name for name in andon.__all__ if inspect.isclass(public(name))]


def test_names_are_sorted_and_there():
    assert list(andon.__all__) == sorted(andon.__all__)
    assert set(andon.__all__) == set(andon._PUBLIC)
    assert set(andon.__all__) <= set(dir(andon))
    for name in andon.__all__:
        path, _, own = andon._PUBLIC[name].partition(":")
        expected = f"andon.{path}" if path == name else own or name
        assert public(name).__name__ == expected


def test_an_unknown_name():
    with pytest.raises(AttributeError, match="'andon' has no attribute 'relit'"):
        _ = andon.relit


def test_golden(regenerate):
    text = api_text()
    if regenerate:
        GOLDEN.write_text(text, encoding="utf-8")
    assert text.splitlines() == GOLDEN.read_text(encoding="utf-8").splitlines(), (
        "the public API has changed; if that is meant: --regenerate, and a line in CHANGELOG.md"
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_function(name):
    function = FUNCTIONS[name]
    assert inspect.getdoc(function), "no docstring"
    signature = inspect.signature(function)
    assert signature.return_annotation is not signature.empty, "what does it return?"
    for parameter in signature.parameters.values():
        if parameter.name != "self":
            assert parameter.annotation is not parameter.empty, parameter.name


@pytest.mark.parametrize("name", CLASSES)
def test_class(name):
    """Every field stands in the docstring of its class or of a base, where its unit is told."""
    cls = public(name)
    own = [base for base in cls.__mro__ if base.__module__.startswith("andon")]
    told = "\n".join(base.__doc__ or "" for base in own)
    assert cls.__doc__, "no docstring"
    if dataclasses.is_dataclass(cls):
        missing = [f.name for f in dataclasses.fields(cls) if f.name not in told]
        assert missing == []


def test_data_are_frozen():
    loose = [
        name
        for name in CLASSES
        if dataclasses.is_dataclass(public(name)) and not public(name).__dataclass_params__.frozen
    ]
    assert loose == []


def test_annotations_can_be_resolved():
    for name in andon.__all__:
        thing = public(name)
        if dataclasses.is_dataclass(thing):
            assert typing.get_type_hints(thing), name


@pytest.mark.parametrize("module", modules(), ids=lambda module: module.__name__)
def test_module(module):
    """What a module offers exists, is its own, and the module says what it is."""
    assert (module.__doc__ or "").strip(), "no docstring"
    offered = getattr(module, "__all__", [])
    assert len(set(offered)) == len(offered)
    for name in offered:
        assert hasattr(module, name), name
