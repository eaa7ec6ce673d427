# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/followed.md, the page of what is followed and what is named, from the tables of the add-on:

python3 docs/followed.py >docs/followed.md
"""

from __future__ import annotations

import importlib
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon" / "export"))
nodes, objects, scenes = (importlib.import_module(f"known.{name}") for name in ("nodes", "objects", "scenes"))

KINDS = {
    "Scenes and renders": ("Scene", "RenderSettings", "CyclesRenderSettings", "CyclesCurveRenderSettings"),
    "View layers and collections": ("ViewLayer", "CyclesRenderLayerSettings", "LayerCollection"),
    "Objects": ("Object", "CyclesObjectSettings", "ObjectLightLinking", "CyclesMeshSettings"),
    "Lamps": ("Light", "CyclesLightSettings", "PointLight", "SpotLight", "SunLight", "AreaLight"),
    "Cameras": ("Camera", "CyclesCameraSettings", "CyclesCustomCameraSettings", "CameraDOFSettings"),
    "Worlds": ("World", "CyclesWorldSettings", "CyclesVisibilitySettings"),
    "Volume objects": ("Volume", "VolumeRender", "VolumeDisplay"),
    "Materials": ("Material", "CyclesMaterialSettings"),
}
INTRODUCTION = """
# What is followed, and what is named

Every property that Cycles reads of a scene is **followed**: Sfumato shows what Cycles shows; or **named**: where it is set
to what we do not show, the panel and the terminal say so, with the owner's name, the value and what is shown instead; or
it makes **no difference** to our picture. Made from the tables in `addon/export/known/` by `docs/followed.py`.
`tests/blender/background/walk.py` and `walk_nodes.py` go through the lists of properties of the Blender that they run in,
3.4 to 5.3, and fail at one that is not here. What a Blender does not have yet, or no more, counts for nothing in it.

Of every scene, and therefore said here alone: **light is shown as it comes from lamps**, once scattered by smoke or once
reflected. What surfaces and smoke pass on to others, as Cycles does up to its *Max Bounces*, is not shown. **Fire** is a lamp,
too: a few spheres fitted to it light surfaces, and smoke where *Volume* bounces would let it. Cycles' black bodies emit
negative blue below some 1900 K, and green below 950 K: here that is 0.
"""


def page() -> Iterator[str]:
    yield INTRODUCTION.strip()
    tables = {table.name: table for table in (*scenes.STRUCTS, *objects.STRUCTS)}
    for title, names in KINDS.items():
        yield f"\n## {title}"
        yield from kind([tables.pop(name) for name in names], title)
    if tables:
        raise SystemExit(f"docs/followed.py: {', '.join(tables)} belong to no kind")
    yield "\n## Shader nodes"
    yield from of_nodes()


def kind(tables: list[Any], title: str) -> Iterator[str]:
    followed = list(dict.fromkeys(label for table in tables for label in table.followed))
    if followed:
        yield "\nFollowed:\n"
        yield from bullets(followed)
    said = {sentence(named): None for table in tables for named in table.named}
    unshown = dict.fromkeys(objects.UNSHOWN.values()) if title == "Objects" else {}
    if title == "Objects":
        said.update((f"*{re.sub('{[a-z]+}', '…', words)}*", None) for words in objects.POINTS.values())
    if said or unshown:
        yield "\nNamed, in these words:\n"
        yield from bullets([*unshown, *said])
    idle: dict[str, list[str]] = {}
    for table in tables:
        for reason, names in table.idle.items():
            idle.setdefault(reason, []).extend(names.split())
    if idle:
        yield "\n<details><summary>No difference</summary>\n"
        yield from bullets(f"{reason}: {code(dict.fromkeys(names))}" for reason, names in idle.items())
        yield "\n</details>"


def sentence(named: Any) -> str:
    where = " (in renders)" if named.only else ""
    return f"*{named.says.format(value='…')}*{where}"


def of_nodes() -> Iterator[str]:
    for node in nodes.FOLLOWED:
        links = "as are links from the nodes below" if "ShaderNodeVolume" in node.name else "and links into them named"
        yield f"\n**{title_of(node.name)}**: {', '.join(node.followed)} are followed, {links}."
        said = [f"*{socket.name}*: {socket.instead}" for socket in node.named]
        said += [f"*{name}*" for name in node.elsewhere]
        if said:
            yield "Named where they matter, and shown so instead:\n"
            yield from bullets(said)
        idle = [f"{reason}: {', '.join(names)}" for reason, names in node.idle.items() if "hidden" not in reason]
        if idle:
            yield "\nNo difference:\n"
            yield from bullets(idle)
    yield "\nThe others:\n"
    yield from bullets(f"{what}: {', '.join(names.split())}" for what, names in nodes.OTHERS.items())


def title_of(name: str) -> str:
    """As an artist reads it."""
    titles = {
        "ShaderNodeBsdfPrincipled": "Principled BSDF",
        "ShaderNodeBsdfDiffuse": "Diffuse BSDF",
        "ShaderNodeBsdfGlossy": "Glossy BSDF (before 4.0)",
        "ShaderNodeBsdfAnisotropic": "Glossy BSDF, Anisotropic BSDF",
        "ShaderNodeVolumePrincipled": "Principled Volume",
        "ShaderNodeVolumeScatter": "Volume Scatter",
        "ShaderNodeVolumeAbsorption": "Volume Absorption",
        "ShaderNodeVolumeCoefficients": "Volume Coefficients",
        "ShaderNodeOutputMaterial": "Material Output",
        "ShaderNodeOutputWorld": "World Output",
        "ShaderNodeOutputLight": "Light Output",
    }
    return titles.get(name, name.removeprefix("ShaderNode"))


def code(names: Any) -> str:
    return ", ".join(f"`{name}`" for name in names)


def bullets(lines: Any) -> Iterator[str]:
    for line in lines:
        yield textwrap.fill(
            line, 120, initial_indent="- ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
        )


if __name__ == "__main__":
    print("\n".join(page()))
