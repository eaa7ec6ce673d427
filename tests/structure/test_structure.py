# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of dependency and of the shared shader text, grepped.

Each rule comes with a breach, a line that it must catch in a file that it must look at: a rule that catches nothing
would pass for ever.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon", "blend_samples", "native", "packaging", "shaders", "tests", ".ci")
CODE = {".cpp", ".hpp", ".inc", ".glsl", ".py", ".sh", ""}
NOT_OURS = {"__pycache__", "plume_cache", "out", "goldens"}


@dataclass(frozen=True)
class Rule:
    """No code (comments and Python's docstrings aside) in files that match `where` but not `home` matches `never`."""

    name: str
    where: str
    home: str
    never: str
    breach: tuple[str, str]  # file, line


NOWHERE = r"(?!)"  # matches no file
ANY_FLOAT = r"(?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+"

RULES = [
    Rule("one home for Blender's version", r"addon/", r"addon/compat\.py", r"bpy\.app\.version",
         ("addon/export/smoke.py", "if bpy.app.version >= (4, 0, 0):")),
    Rule("one home for the GPU", r"addon/", r"addon/gpu/", r"^\s*(import|from) gpu",
         ("addon/engine.py", "    import gpu")),
    # At the top of the file it would break background mode in some Blenders: in 3.4 gpu.state without a context is a
    # crash that nothing catches.
    Rule("the GPU is imported late", r"addon/", NOWHERE, r"^(import|from) gpu", ("addon/engine.py", "import gpu")),
    Rule("one home for pybind11", r"native/", r"native/module", r"pybind11",
         ("native/frame/frame.cpp", "#include <pybind11/numpy.h>")),
    Rule("one home for OpenImageIO", r"native/", r"native/scene/picture_file\.", r"OpenImageIO|OIIO",
         ("native/frame/frame.cpp", "#include <OpenImageIO/imageio.h>")),
    # It corrupts memory on some damaged files, so it writes and judges in tests and reads nothing of an artist's.
    Rule("OpenVDB is the tests' alone", r"(native/|CMakeLists)", NOWHERE, r"(?i)openvdb(/|::|\})",
         ("native/scene/volume_file.cpp", "#include <openvdb/openvdb.h>")),
    Rule("native knows no Blender", r"native/", NOWHERE, r"(?i)\bbpy\b|blender",
         ("native/scene/scene.hpp", "struct BlenderObject;")),
    Rule("methods do not know the module", r"native/", r"native/module", r'#include "module/',
         ("native/frame/frame.cpp", '#include "module/arguments.hpp"')),
    Rule("methods do not know the reference", r"native/", r"native/(module|reference)", r'#include "reference/',
         ("native/maps/light_map.cpp", '#include "reference/reference.hpp"')),
    # Dependencies point one way: module, frame, then maps, lights, media and solids, then rays, then text and scene.
    Rule("text and scene know no room above", r"native/(text|scene)/", r"native/text/(dispatch\.cpp|kernels\.hpp)",
         r'#include "(?!\.\.|(text|scene)/)', ("native/scene/camera.cpp", '#include "rays/series.hpp"')),
    Rule("rays know no room above", r"native/rays/", NOWHERE, r'#include "(?!\.\.|(rays|text|scene)/)',
         ("native/rays/basis.cpp", '#include "maps/light_map.hpp"')),
    Rule("textures know no room above", r"native/textures/", NOWHERE, r'#include "(?!\.\.|(textures|text|scene)/)',
         ("native/textures/image.cpp", '#include "media/medium.hpp"')),
    Rule("maps, lights, media and solids know no frame", r"native/(maps|lights|media|solids)/", NOWHERE,
         r'#include "(?!\.\.|(maps|lights|media|solids|textures|rays|text|scene)/)',
         ("native/maps/light_map.cpp", '#include "frame/frame.hpp"')),
    Rule("a light's kind is the business of its room", r"native/",
         r"native/(scene/light\.hpp|lights/|module/scene\.cpp|reference/)", r"\b(LightKind|Light::Kind)\b",
         ("native/frame/surfaces_lanes.cpp", "if (light.kind == LightKind::SUN) {")),
    Rule("the frame knows no module", r"native/frame/", NOWHERE, r'#include "(module|reference)/',
         ("native/frame/frame.cpp", '#include "module/arguments.hpp"')),
    Rule("the export knows neither the GPU nor a view", r"addon/export/", NOWHERE,
         r"^\s*(from|import)\s.*\b(gpu|view|viewport)\b",
         ("addon/export/scene.py", "from ..view import viewport")),
    Rule("the GPU knows neither the export nor a view", r"addon/gpu/", NOWHERE,
         r"^\s*(from|import)\s.*\b(export|view|viewport)\b", ("addon/gpu/shader.py", "from ..export import scene")),
    Rule("the reference knows the scene alone", r"native/reference", NOWHERE, r'#include "(?!scene/scene\.hpp|reference/)',
         ("native/reference/reference.cpp", '#include "text/rays_text.hpp"')),
    Rule("the reference includes no shader", r"native/reference", NOWHERE, r"\.glsl|_text\.hpp",
         ("native/reference/medium.cpp", '#include "../../shaders/media/phase.glsl"')),
    Rule("inputs and outputs are the viewport's", r"shaders/", r"shaders/viewport/",
         r"^\s*(in|out)\s|\b(uniform|layout)\b|sampler|gl_", ("shaders/media/phase.glsl", "uniform sampler3D density;")),
    Rule("results by return value", r"shaders/", r"shaders/viewport/", r"\b(in)?out\s+\w",
         ("shaders/media/phase.glsl", "float phase(float g, out float norm)")),
    Rule("float literals end in f", r"shaders/", r"shaders/viewport/", rf"(?<![\w.])({ANY_FLOAT})(?![\d.eEf])",
         ("shaders/media/phase.glsl", "return 0.5 * g;")),
    Rule("no swizzles", r"shaders/", r"shaders/viewport/", r"\.[xyzwrgba]{2,4}\b",
         ("shaders/camera.glsl", "vec2 p = ray.origin.xy;")),
]  # fmt: skip
NAMES = [rule.name for rule in RULES]


def sources() -> Iterator[Path]:
    yield ROOT / "CMakeLists.txt"
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in CODE and not NOT_OURS & set(path.parts):
                yield path


def bare(text: str, suffix: str) -> str:
    """The text without comments and docstrings; line numbers stay."""

    def blank(match: re.Match[str]) -> str:
        return "\n" * match[0].count("\n")

    if suffix == ".py":
        return re.sub(r'"""[\s\S]*?"""|#.*', blank, text)
    return re.sub(r"/\*[\s\S]*?\*/|//.*", blank, text)


def offences(rule: Rule, name: str, text: str) -> list[str]:
    if not re.match(rule.where, name) or re.match(rule.home, name):
        return []
    lines = bare(text, Path(name).suffix).splitlines()
    return [f"{name}:{number}: {line}" for number, line in enumerate(lines, 1) if re.search(rule.never, line)]


@pytest.mark.parametrize("rule", RULES, ids=NAMES)
def test_rule_holds(rule: Rule) -> None:
    found: list[str] = []
    for path in sources():
        found += offences(rule, path.relative_to(ROOT).as_posix(), path.read_text())
    assert not found, "\n".join(found)


@pytest.mark.parametrize("rule", RULES, ids=NAMES)
def test_rule_catches_its_breach(rule: Rule) -> None:
    assert offences(rule, *rule.breach)
    assert (ROOT / rule.breach[0]).exists(), "the breach should be in a file that is there"


def test_every_source_states_its_licence() -> None:
    silent = [
        str(path) for path in sources() if "SPDX-License-Identifier: GPL-3.0-or-later" not in path.read_text()[:200]
    ]
    assert not silent


def test_files_that_the_documentation_names_are_there() -> None:
    named = re.compile(
        r"`((?:addon|blend_samples|docs|native|packaging|shaders|tests)/[\w./-]*|\.ci/run)[^`]*`|\]\(([\w./]+)\)"
    )
    missing = []
    for page in [ROOT / "README.md", ROOT / "ARCHITECTURE.md", *sorted((ROOT / "docs").glob("*.md"))]:
        for ours, link in named.findall(page.read_text(encoding="utf-8")):
            if not (ROOT / ours if ours else page.parent / link).exists():
                missing.append(f"{page.name}: {ours or link}")
    assert not missing, "\n".join(missing)
