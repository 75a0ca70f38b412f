"""The JSON schema and the reference manual: fresh, valid, complete."""

import tomllib
from pathlib import Path

import pytest

from andon.scene import LAMP_KINDS, json_schema, parse_scene, scene_reference_markdown
from andon.scene.base import Table
from andon.scene.reference import EXAMPLE, EXAMPLES
from andon.scene.schema import publish
from requirements import required

jsonschema = required("jsonschema")

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("path", publish(DOCS), ids=lambda path: path.name)
def test_published_files_are_fresh(path):
    remedy = (
        'run: python -c "from pathlib import Path; from andon.scene.schema import publish; '
        "[p.write_text(t, encoding='utf-8') for p, t in publish(Path('docs')).items()]\""
    )
    assert path.read_text(encoding="utf-8") == publish(DOCS)[path], remedy


@pytest.fixture(scope="module")
def validator():
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_example_is_valid(validator):
    validator.validate(tomllib.loads(EXAMPLE))


@pytest.mark.parametrize("path", EXAMPLES)
def test_the_examples_of_tables_are_scenes_and_published(validator, path):
    text = EXAMPLES[path].split("```toml\n")[1].split("```")[0]
    validator.validate(tomllib.loads(text))
    parse_scene(text)
    assert EXAMPLES[path] in scene_reference_markdown()


def test_shorthands_are_valid(validator):
    validator.validate(
        {
            "capture": {"source": {"left": "a", "right": "b"}, "response": "gamma:2.2"},
            "ambient": {"illuminance_lux": [1, 2, 3], "dimming": 0.5},
            "surface": {"depth": {"file": "d"}, "reflectance": 0.5},
        }
    )


def test_presets_are_valid(validator):
    candle = {"preset": "candle", "position": [0, 1, -2], "flux_lm": 9}
    validator.validate({"lamp": [candle], "ambient": {"source": [candle]}})
    for wrong in ({"preset": "candel"}, {"preset": "candle", "flux": 9}):
        assert not validator.is_valid({"lamp": [wrong]})


def test_dumped_scenes_are_valid(validator):
    validator.validate(tomllib.loads(parse_scene(EXAMPLE).to_toml()))


@pytest.mark.parametrize(
    "tables",
    [
        {"lamps": []},
        {"lamp": [{"kind": "pont"}]},
        {"lamp": [{"kind": "point", "position": [0, 0], "flux_lm": 1}]},
        {"lamp": [{"kind": "point", "position": [0, 0, 0], "radius_m": 1}]},
        {"ambient": {"illuminance_lux": 0}},
        {"observer": {"age": 121}},
    ],
)
def test_the_schema_refuses_what_the_parser_refuses(validator, tables):
    assert not validator.is_valid(tables)


def tables_of(base):
    for table in base.__subclasses__():
        yield table
        yield from tables_of(table)


def test_every_table_and_every_key_is_described():
    for table in tables_of(Table):
        for name, field in table.model_fields.items():
            assert field.description, f"{table.__name__}.{name}"
            assert field.description.endswith("."), f"{table.__name__}.{name}"


def test_the_reference_names_every_key():
    text = scene_reference_markdown()
    for table in tables_of(Table):
        for name in table.model_fields:
            if table.__name__ != "Scene":
                assert f"| `{name}` |" in text, f"{table.__name__}.{name}"
    for kind in LAMP_KINDS:
        assert f'### `kind = "{kind}"`' in text


def test_numbers_with_a_unit_say_so_in_the_name():
    for table in tables_of(Table):
        for name, field in table.model_fields.items():
            description = field.description or ""
            for word, end in (("in lx", "_lux"), ("in cd.", "_cd"), ("in lm", "_lm")):
                if word in description and "E0" not in description:
                    assert name.endswith(end), f"{table.__name__}.{name}"


def test_the_manual_warns_of_what_surprises():
    text = " ".join(scene_reference_markdown().split())
    for words in (
        "facets do not hide one another",
        "reduced to about 64 triangles",
        "its back is black unless two_sided",
        "more than 16 gain little: larger maps do",
        "virtual things take away what they hide of it",
        "`--view` names",
    ):
        assert words in text, words
