"""Who is cited in the code stands in the bibliography, and the papers of the package agree."""

import re
import tomllib
import unicodedata

import pytest

import andon

from .tree import PACKAGE, ROOT

# "Garland & Heckbert 1997", "Meyer et al. 2010", "Brabec, Annen & Seidel 2002"
NAME = r"[A-Z]\w+(?:[- ][A-Z]\w+)?"
CITATION = re.compile(rf"({NAME})(?:(?:, {NAME})* & {NAME}| et al\.?),? ((?:19|20)\d\d)")

TEX_ACCENT = re.compile(r"\\[\"'v`c]\{?(\w)\}?")


def plain(text):
    """Without accents, as letters only."""
    bare = unicodedata.normalize("NFKD", text)
    return "".join(c for c in bare if not unicodedata.combining(c)).lower()


def entries():
    """{key: text} of the bibliography."""
    text = (ROOT / "BIBLIOGRAPHY.bib").read_text(encoding="utf-8")
    parts = re.split(r"^@\w+\{", text, flags=re.MULTILINE)[1:]
    return {part.partition(",")[0]: TEX_ACCENT.sub(r"\1", part).replace("{", "") for part in parts}


def citations():
    files = [path for suffix in ("*.py", "*.wgsl") for path in PACKAGE.rglob(suffix)]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    return sorted(set(CITATION.findall(text)))


def test_the_pattern():
    found = CITATION.findall(
        "Brabec, Annen & Seidel 2002; Meyer et al. 2010, Kannala & Brandt 2006"
    )
    assert found == [("Brabec", "2002"), ("Meyer", "2010"), ("Kannala", "2006")]
    assert ("Brabec", "2002") in citations()


@pytest.mark.parametrize(("name", "year"), citations())
def test_cited_is_listed(name, year):
    known = [plain(text) for text in entries().values()]
    assert any(plain(name) in text and year in text for text in known)


def test_keys_are_unique():
    text = (ROOT / "BIBLIOGRAPHY.bib").read_text(encoding="utf-8")
    assert len(entries()) == len(re.findall(r"^@", text, re.MULTILINE))
    assert text.count("{") == text.count("}")


def test_one_version():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert project["version"] == andon.__version__
    assert re.search(r"^version: (\S+)$", citation, re.MULTILINE)[1] == andon.__version__
    assert andon.__version__ in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_one_licence():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "Apache License" in text
    assert "Version 2.0, January 2004" in text
    notice = (ROOT / "NOTICE").read_text(encoding="utf-8")
    for name in ("Middlebury", "Scharstein", "scikit-image", "photo.png"):
        assert name in notice
