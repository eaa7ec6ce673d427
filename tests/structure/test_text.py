# SPDX-License-Identifier: GPL-3.0-or-later
"""The shared text of the shaders says what it needs of itself, and every list of it has that before."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SHADERS = ROOT / "shaders"
# Texts of one program, in order: classes of the text, and the add-on's lists of files.
LISTS = sorted((ROOT / "native" / "text").glob("*_text.hpp")) + sorted((ROOT / "addon").rglob("*.py"))
DEFINITION = re.compile(r"^(?:struct (?P<type>\w+)|\w+ (?P<function>\w+)(?=\()|#define (?P<macro>\w+))", re.MULTILINE)


def shared_text() -> dict[str, str]:
    """By stem; what is under viewport/ has inputs and outputs, and is Blender's alone."""
    return {path.stem: path.read_text() for path in SHADERS.rglob("*.glsl") if path.parent.name != "viewport"}


def needs_of(text: str) -> set[str]:
    found = re.search(r"^// needs: (.+)$", text, re.MULTILINE)
    return set(found[1].split()) if found else set()


def used_by(stem: str, texts: dict[str, str]) -> set[str]:
    """The texts that define what this one speaks of."""
    bare = re.sub(r"//.*", "", texts[stem])
    used = set()
    for other, text in texts.items():
        for definition in DEFINITION.finditer(text) if other != stem else ():
            call = r"\s*\(" if definition["function"] else ""
            name = definition["type"] or definition["function"] or definition["macro"]
            if re.search(rf"\b{name}\b{call}", bare):
                used.add(other)
    return used


def lists_in(path: Path, text: str) -> Iterator[list[str]]:
    """The stems of each list of shader files, in order."""
    for block in [text] if path.suffix == ".hpp" else re.findall(r"\[[^\[\]]*\]", text):
        stems = re.findall(r'"(?:\.\./\.\./shaders/)?(?:\w+/)?(\w+)\.glsl"', block)
        if stems:
            yield stems


def out_of_order(stems: list[str], texts: dict[str, str]) -> list[str]:
    return [
        f"{stem} before {need}, or without it"
        for place, stem in enumerate(stems)
        for need in sorted(needs_of(texts.get(stem, "")) - set(stems[:place]))
    ]


@pytest.mark.parametrize("stem", sorted(shared_text()))
def test_a_text_names_what_it_needs(stem: str) -> None:
    texts = shared_text()
    assert needs_of(texts[stem]) == used_by(stem, texts)


@pytest.mark.parametrize("path", LISTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_is_needed_comes_before(path: Path) -> None:
    texts = shared_text()
    wrong = [fault for stems in lists_in(path, path.read_text()) for fault in out_of_order(stems, texts)]
    assert not wrong


def test_every_text_is_in_a_class_of_the_text() -> None:
    listed = {
        stem for path in LISTS if path.suffix == ".hpp" for stems in lists_in(path, path.read_text()) for stem in stems
    }
    assert listed == set(shared_text())


def test_a_wrong_order_and_a_missing_need_are_seen() -> None:
    texts = {
        "a": "struct Arc {\n};\n",
        "b": "// needs: a\nArc arc()\n{\n}\n",
        "c": "float c()\n{\n  return arc();\n}\n",
    }
    assert out_of_order(["a", "b"], texts) == []
    assert out_of_order(["b", "a"], texts) == ["b before a, or without it"]
    assert used_by("b", texts) == {"a"}
    assert used_by("c", texts) == {"b"} != needs_of(texts["c"])
    assert list(lists_in(Path("x.py"), 'files = ["camera.glsl", "rays/opacity.glsl"]')) == [["camera", "opacity"]]
