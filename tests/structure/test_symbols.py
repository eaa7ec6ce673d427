# SPDX-License-Identifier: GPL-3.0-or-later
"""Code for newer processors cannot stand in for its twin in code that runs on every processor.

Inline functions and templates leave weak symbols in every object that needs them, and the linker keeps whichever comes
first. So of the objects that are linked, none for one instruction set may share such a symbol with any other.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable
from itertools import permutations
from pathlib import Path

import pytest

BUILD = Path(__file__).resolve().parents[2] / "build"
EVERYWHERE = "every processor"
SHARED = "VWu"  # nm's letters of weak and unique symbols
DEFINED = "ABCDGRSTVWu"


def instruction_set(file: str) -> str:
    """What an object is compiled for."""
    found = re.search(r"lanes_(\w+?)(?:\.o|\.dir/)", file)
    return found[1] if found else EVERYWHERE


def linked_objects() -> list[Path]:
    """What the module is linked from."""
    if not (BUILD / "build.ninja").exists():
        pytest.skip("nothing is built in build/")
    text = (BUILD / "build.ninja").read_text().replace("$\n", " ")
    line = re.search(r"^build python/sfumato\S*: \S+ (.+)$", text, re.MULTILINE)
    assert line, "build.ninja does not say how the module is linked"
    return sorted({BUILD / file for file in line[1].split() if file.endswith(".o")})


def compiled_objects() -> list[Path]:
    """What the compiler made of the files that are compiled for each instruction set."""
    objects = sorted((BUILD / "CMakeFiles").glob("sfumato_lanes_*.dir/**/*.o"))
    return objects + [path for path in linked_objects() if instruction_set(str(path)) == EVERYWHERE]


def symbols(objects: Iterable[Path], kinds: str) -> dict[str, set[str]]:
    """Of each instruction set, the global symbols of these kinds that its objects define."""
    found: dict[str, set[str]] = {}
    for path in objects:
        listed = subprocess.run(["nm", "--defined-only", path], capture_output=True, text=True, check=True).stdout
        names = found.setdefault(instruction_set(str(path)), set())
        names.update(
            name for _, kind, name in (line.split(maxsplit=2) for line in listed.splitlines()) if kind in kinds
        )
    return found


def stand_ins(objects: list[Path]) -> list[str]:
    shared, defined = symbols(objects, SHARED), symbols(objects, DEFINED)
    return sorted(
        f"{name}: {one}, {other}"
        for one, other in permutations(shared, 2)
        if one != EVERYWHERE
        for name in shared[one] & defined[other]
    )


def test_no_symbol_is_shared_between_instruction_sets() -> None:
    objects = linked_objects()
    sets = {instruction_set(str(path)) for path in objects}
    assert EVERYWHERE in sets and "baseline" in sets, sets
    assert not stand_ins(objects)


def test_what_the_compiler_made_shares_some() -> None:
    """Else the other test would prove nothing."""
    assert stand_ins(compiled_objects())
