# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever a function of the module is given instead of one of its arguments, it says in one line which and what."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sfumato

STUB = Path(__file__).resolve().parents[2] / "native" / "module" / "sfumato.pyi"
LONGEST = 250  # letters of a message


def scene() -> sfumato.Scene:
    out = sfumato.Scene()
    out.add_medium(np.ones((2, 2, 2)), np.eye(4), (1, 1, 1), (0, 0, 0))
    out.add_sun((0, 0, -1), (1, 1, 1))
    return out


RAYS = [[0.2, 0.6], [0.3, 0.7]]
QUAD = [(-1, -1, 2), (-1, 1, 2), (1, 1, 2), (1, -1, 2)]
SERIES = sfumato.project(np.full((2, 2, 2), 0.5), np.ones((2, 2, 2)), coefficients=3)
STORAGE = sfumato.choose_basis(RAYS, RAYS)
# What serves each argument, by its name, and by that of its function where that is not the same everywhere.
VALUES: dict[str, Any] = {
    "Sky.__init__.radiance": np.ones((2, 4, 3)),
    "Pattern.__init__.steps": [[1, 0, 0, *[0] * 10]],
    "outputs": [[0, 0]],
    "rows": [[0.5]],
    "Pattern.at.triangle": [0],
    "Pattern.at.u": [0.5],
    "Pattern.at.v": [0.5],
    "pixels": np.full((2, 3, 4), 128, np.uint8),
    "Image.look_up.u": [0.5, 0.7],
    "Image.look_up.v": [0.5, 0.2],
    "view_projection": np.eye(4),
    "scene": scene(),
    "camera": sfumato.Camera(np.eye(4)),
    "cameras": [sfumato.Camera(np.eye(4))],
    "picture": np.zeros((2, 2, 4), np.float32),
    "width": 2,
    "height": 2,
    "points": [0, 0, 0],
    "density": np.ones((2, 2, 2)),
    "depth": RAYS,
    "optical_depth": RAYS,
    "coefficients": SERIES,
    "texels": sfumato.pack(SERIES),
    "position": (0, 0, 3),
    "across": (1, 0, 0),
    "up": (0, 1, 0),
    "radiance": (1, 1, 1),
    "mesh": sfumato.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
    "to_world": np.eye(4),
    "albedo": [[0.5, 0.5, 0.5]],
    "transmittance": [[0.5, 0.5, 0.5]],
    "grid_to_world": np.eye(4),
    "scattering": (1, 1, 1),
    "absorption": (0, 0, 0),
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    "triangles": [[0, 1, 2]],
    "corner_normals": [[[0, 0, 1]] * 3],
    "material": [0],
    "intensity": (1, 1, 1),
    "corners": QUAD,
    "direction": (0, 0, -1),
    "irradiance": (1, 1, 1),
    "origin": (0, 0, 0),
    "centre": (0, 0, 2),
    "u": (0.5, 0, 0),
    "v": (0, 0.5, 0),
    "normal": (0, 0, 1),
    "polygons": QUAD,
    "radius": 0.5,
    "polygon": QUAD,
    "axis": (0, 0, 1),
    "exponent": 4,
    "b": (1, 0, 0),
    "extinction": (1, 1, 1),
    "shape": (2, 2, 2),
    "cos_theta": 0.5,
    "view": (0, 0.6, 0.8),
    "alpha": 0.2,
    "axes": [(0, 0, 1), (0, 0.1, 1)],
    "exponents": [4, 5],
    "start": (0, 0, 0),
    "end": (1, 1, 1),
    "d": [0.5],
    "path": "no such file.vdb",
    "names": ["position", "mist"],
    "opacity": 0.5,
    "Scene.add_particles.points": [[0, 0, 0], [0, 0, 1]],
    "airlight.extinction": 0.1,
    "airlight_of_plate.extinction": 0.1,
    "sunlight.extinction": 0.1,
    "reference.airlight.extinction": 0.1,
    "reference.airlight_of_plate.extinction": 0.1,
    "reference.sunlight.extinction": 0.1,
    "stops": [0, 1],
    "TransferFunction.__init__.colour": [(1, 1, 1), (0, 0, 0)],
    "transfer": sfumato.TransferFunction([0, 1], [0, 2], [(1, 1, 1), (0, 0, 0)]),
    "s": [0.5],
    "front": [0.2],
    "back": [0.7],
    "step": 1.0,
    "steps": [1.0],
    "TransferFunction.__init__.extinction": [0, 2],
    "Scene.add_strands.points": [[0, 0, 0], [0, 0, 1]],
    "Scene.add_strands.radius": [0.01, 0.01],
    "first": [0, 2],
    "Scene.add_fog.emission": (1, 1, 1),
    "Scene.set_air.emission": (1, 1, 1),
    "RayStorage.transmittance.texels": STORAGE.store(RAYS, RAYS),
    "transmittance.coefficients": sfumato.project(RAYS, RAYS),
    "transmittance_before.coefficients": sfumato.project(RAYS, RAYS),
    "reference.transmittance.depth": [0.5],
    "reference.transmittance.alpha": [0.5],
    "depth_ranges.depth": np.full((2, 2, 2), 0.5),
    "depth_ranges.optical_depth": np.ones((2, 2, 2)),
    "filter_map.width": 1.0,
    "colour": np.ones((2, 2, 3)),
    "composite_nearest.alpha": RAYS,
    "composite_fourier.alpha": RAYS,
    "composite_weighted.alpha": RAYS,
    "SolidMap.__init__.depth": np.full((2, 2), np.inf),
    "world_to_map": np.eye(4),
    "distance": np.ones((2, 2)),
    "maps": [sfumato.SolidMap(np.full((2, 2), np.inf), np.eye(4))],
    "shafts.direction": [(0, 0, -1)],
    "shafts.irradiance": [(1, 1, 1)],
}
# These end in an error of their own with what serves: there is no such file.
OF_FILES = {"read_volume", "volume_header", "Grid.from_file"}
WRONG: list[Any] = [None, "wrong", b"wrong", object(), 1j, 0.5, 10**30, [], [[1], [1, 2]], {}, np.array(["text", "more"]),
                    np.zeros((2, 0, 7)), np.zeros(49), np.full((3, 3), np.nan), float("nan"), "ü" * 100]  # fmt: skip


def functions(body: list[ast.stmt], owner: str = "") -> Iterator[tuple[str, list[str], int]]:
    """Of each function of the stub: its name, its arguments, and how many of these have no default."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from functions(node.body, f"{node.name}.")
        elif isinstance(node, ast.FunctionDef) and not any(
            isinstance(mark, ast.Name) and mark.id == "property" for mark in node.decorator_list
        ):
            names = [argument.arg for argument in node.args.args if argument.arg != "self"]
            yield owner + node.name, names, len(names) - len(node.args.defaults)


PARSED = ast.parse(STUB.read_text(encoding="utf-8"))
FUNCTIONS = {name: (arguments, needed) for name, arguments, needed in functions(PARSED.body)}


def call(name: str, arguments: dict[str, Any]) -> Any:
    owner, _, own = name.rpartition(".")
    if own == "__init__":
        return getattr(sfumato, owner)(**arguments)
    made: dict[str, Callable[[], Any]] = {
        "": lambda: sfumato,
        "Scene": scene,
        "Frame": lambda: sfumato.Frame(scene(), coefficients=3),
        "RayStorage": lambda: STORAGE,
        "Image": lambda: sfumato.Image(VALUES["pixels"]),
        "Pattern": lambda: sfumato.Pattern(VALUES["Pattern.__init__.steps"], VALUES["outputs"]),
        "Sky": lambda: sfumato.Sky(VALUES["Sky.__init__.radiance"]),
        "TransferFunction": lambda: VALUES["transfer"],
        "PreintegratedTable": lambda: sfumato.PreintegratedTable(VALUES["transfer"], [1.0], entries=8),
    }
    return getattr(made[owner]() if owner in made else getattr(sfumato, owner), own)(**arguments)


def serving(name: str) -> dict[str, Any]:
    arguments, needed = FUNCTIONS[name]
    return {each: VALUES.get(f"{name}.{each}", VALUES.get(each)) for each in arguments[:needed]}


def said_by(name: str, arguments: dict[str, Any]) -> str:
    """What a call is refused with, or nothing."""
    try:
        call(name, arguments)
    except (ValueError, TypeError) as error:
        return str(error)
    return ""


def told(value: Any) -> str:
    """The beginning of what a message may say of a value, other than its shape."""
    return "an array" if isinstance(value, np.ndarray) else repr(value)[:20]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_serves_is_taken(name: str) -> None:
    if name in OF_FILES:
        assert said_by(name, serving(name)).startswith("path 'no such file.vdb'")
    else:
        call(name, serving(name))


@pytest.mark.filterwarnings("ignore:The truth value of an empty array")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_argument_is_named_in_one_line(name: str) -> None:
    """Or another, where it is their shapes that do not fit each other."""
    faults = []
    arguments = FUNCTIONS[name][0]
    for argument in arguments:
        for value in WRONG:
            message = said_by(name, {**serving(name), argument: value})
            named = message.startswith(("path", argument)) or (
                message.startswith(tuple(f"{other} has shape (" for other in arguments)) and f"({len(value)}" in message
            )
            if message and not named or "\n" in message or len(message) > LONGEST:
                faults.append(f"{argument} = {told(value)}: {message}")
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if name != "content_hash"])
def test_what_is_no_value_of_an_argument_is_told(name: str) -> None:
    """An object of no kind at all is refused wherever it stands."""
    nothing = object()
    for argument in FUNCTIONS[name][0]:
        message = said_by(name, {**serving(name), argument: nothing})
        if "True or False" not in message:  # of which everything in Python is one
            assert message.startswith(f"{argument} is {nothing!r}, but must be "), message


def test_a_call_that_fits_no_signature_says_what_it_lacks() -> None:
    module: Any = sfumato  # which mypy knows too well for this
    cases: dict[str, Callable[[], Any]] = {
        "depth is missing: project takes depth, optical_depth, ": lambda: module.project(),
        "project has no argument 'tau'; it takes depth, ": lambda: module.project(1, 1, tau=1),
        "depth is given twice to project": lambda: module.project(1, depth=1),
        "end_threads was given 1 arguments, but takes no": lambda: module.end_threads(1),
        "scene is missing: Frame takes scene, ": lambda: module.Frame(),
        "direction is missing: add_sun takes direction, ": lambda: module.Scene().add_sun(),
    }
    for message, wrong in cases.items():
        with pytest.raises(TypeError) as error:
            wrong()
        assert str(error.value).startswith(message)
