# SPDX-License-Identifier: GPL-3.0-or-later
"""Notices of what Cycles would show and we do not, made of the tables of known/.

Looks at what is cheap to look at: a scene at its defaults costs next to nothing, however many objects it has.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any

import bpy

from .known import RENDER, Named, Node, nodes, objects, scenes

_TABLES = (*scenes.STRUCTS, *objects.STRUCTS)
_NODES: dict[str, Node] = {node.name: node for node in nodes.FOLLOWED}
# A disabled Cycles takes its settings with it: what is not there says nothing.
_ABSENT = object()


@functools.cache
def _named(root: str) -> tuple[tuple[str, Named], ...]:
    """What is said of a root, by the path to it."""
    return tuple(
        (table.path(named), named)
        for table in _TABLES
        if table.root == root
        for named in table.named
        if not named.elsewhere
    )


def of(root: str, owner: Any, name: str, notices: list[str], kind: str = "", render: bool = False) -> None:
    """Name what `owner`, one of `kind`, is set to and we do not show; in a `render`, also what matters in none but that."""
    for path, named in _named(root):
        if (named.only == RENDER and not render) or (named.kinds and kind not in named.kinds):
            continue
        value = _value(owner, path)
        if value is _ABSENT or _is_neutral(value, named.neutral):
            continue
        if all(_value(owner, other) == needed for other, needed in named.when):
            notices.append(f"{name}: {named.says.format(value=_shown(owner, path, value))}")


def _value(owner: Any, path: str) -> Any:
    for part in path.split("."):
        owner = getattr(owner, part, _ABSENT)
    return len(owner) if isinstance(owner, bpy.types.bpy_prop_collection) else owner


def _is_neutral(value: Any, neutral: tuple[Any, ...]) -> bool:
    if isinstance(value, float):
        return any(isinstance(other, float) and abs(value - other) < 1e-6 for other in neutral)
    return value in neutral


def _shown(owner: Any, path: str, value: Any) -> str:
    """A value as Blender's interface writes it."""
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, bpy.types.ID):
        return f"'{value.name}'"
    *way, name = path.split(".")
    for part in way:
        owner = getattr(owner, part)
    prop = owner.bl_rna.properties[name]
    return str(prop.enum_items[value].name if prop.type == "ENUM" else value)


def lies_over(space: Any) -> bool:
    """Whether a 3D view shows Blender's own picture, with our smoke over it."""
    return space is not None and space.shading.type != "RENDERED"


def of_frame(depsgraph: Any, world: Any | None, space: Any, notices: list[str], camera: Any = None) -> None:
    """What the scene, its view layer, its camera and its world are set to, as far as a 3D view, if there is one, shows it:
    a camera matters where one looks through it: the scene's, where it is no other."""
    if lies_over(space):
        return
    scene, layer, render = depsgraph.scene_eval, depsgraph.view_layer_eval, depsgraph.mode == "RENDER"
    of("scene", scene, scene.name, notices, render=render)
    camera = camera or _camera_of(space) or scene.camera
    if camera is not None and (space is None or _looks_through(space)):
        of("camera", camera.data, camera.name, notices)
    if world is not None and not scene.render.film_transparent and layer.use_sky:
        of("world", world, "World", notices)


def _camera_of(space: Any) -> Any | None:
    """The camera of a 3D view's own."""
    return space.camera if space is not None and space.use_local_camera else None


def _looks_through(space: Any) -> bool:
    return space.region_3d is not None and space.region_3d.view_perspective == "CAMERA"


def of_copy(thing: Any, glows: bool, notices: list[str]) -> None:
    """What an object is set to that shares its mesh with another."""
    of("object", thing, thing.name, notices, "GLOWING" if glows else "DARK")


_PASSES_OF_SURFACES = ("z", "mist", "position", "normal", "object_index", "material_index", "shadow")


def of_hair(names: Iterable[str], depsgraph: Any, over_smoke: bool, notices: list[str]) -> None:
    """What is not done for hair: in passes; and in a view whose hair Blender draws, where there is smoke."""
    layer = depsgraph.view_layer_eval
    asked = depsgraph.mode == "RENDER" and any(getattr(layer, f"use_pass_{name}") for name in _PASSES_OF_SURFACES)
    for name in names:
        if asked:
            notices.append(f"{name}: passes tell of what is behind its hair")
        if over_smoke:
            notices.append(f"{name}: its hair does not hide the smoke behind it here")


def of_pane(name: str, found: list[Any], space: Any, notices: list[str]) -> None:
    """What surfaces that let light through do over Blender's picture, which shows them clear in Material Preview alone."""
    if space.shading.type == "MATERIAL" and any(surface.lets_through for surface in found):
        notices.append(f"{name}: light passes through it, but in Material Preview it hides the smoke behind it")


def of_glass(names: Iterable[str], sharp: Iterable[str], depsgraph: Any, notices: list[str]) -> None:
    """What Cycles makes otherwise of light through glass, as the scene is set; `sharp` are lamps without a size."""
    scene, layer = depsgraph.scene, depsgraph.view_layer_eval
    asked = depsgraph.mode == "RENDER" and any(getattr(layer, f"use_pass_{name}") for name in _PASSES_OF_SURFACES)
    dark = _value(scene, "cycles.caustics_refractive") is False
    # A quarter to a half darker, behind clear flat panes in a lamp's light (5.0.1).
    darker = not dark and (_value(scene, "cycles.blur_glossy") or 0.0) > 0.0
    opaque = scene.render.film_transparent and _value(scene, "cycles.film_transparent_glass") is False
    any_glass = False
    for name in names:
        any_glass = True
        if dark:
            notices.append(f"{name}: its glass casts a shadow in its color, though Refractive Caustics is off")
        if darker:
            notices.append(
                f"{name}: its glass takes no light for Filter Glossy, by which Cycles' shadow of it is darker"
            )
        if opaque:
            notices.append(f"{name}: the transparent film is seen through its glass, though Transparent Glass is off")
        if asked:
            notices.append(f"{name}: passes tell of what is behind its glass")
    if any_glass and not dark:
        notices += [f"{name}: its light passes through glass, though without a size it would not" for name in sharp]


def of_surface(thing: Any, glows: bool, depsgraph: Any, notices: list[str]) -> None:
    """What one object with surfaces is set to, beyond the switches of all; `glows` if it emits."""
    of_copy(thing, glows, notices)
    last = None
    for modifier in thing.modifiers:
        if not (modifier.show_render if depsgraph.mode == "RENDER" else modifier.show_viewport):
            continue
        last = modifier
    if last is not None and last.type == "SUBSURF" and _is_adaptive(thing, last, depsgraph.scene):
        notices.append(f"{thing.name}: its Adaptive Subdivision is not followed; it is subdivided as in other engines")


def _is_adaptive(thing: Any, modifier: Any, scene: Any) -> bool:
    """By Cycles' experimental features before 5.0, by the modifier since."""
    own = getattr(modifier, "use_adaptive_subdivision", None)
    if own is not None:
        return bool(own)
    wanted = _value(thing, "cycles.use_adaptive_subdivision") is True
    return wanted and _value(scene, "cycles.feature_set") == "EXPERIMENTAL"


def of_type(thing: Any, notices: list[str]) -> None:
    """An object of a type that we do not show at all."""
    if thing.type in objects.UNSHOWN:
        notices.append(f"{thing.name}: {objects.UNSHOWN[thing.type]}")


def of_smoke(thing: Any, notices: list[str]) -> None:
    """How Cycles would take the voxels of a body of smoke."""
    for slot in thing.material_slots:
        if slot.material is not None:
            of("material", slot.material, thing.name, notices, "SMOKE")


def of_node(node: Any, owner: str, notices: list[str]) -> None:
    """The inputs of a followed node that are not followed."""
    table = _NODES.get(node.bl_idname)
    for socket in table.named if table is not None else ():
        found = node.inputs.get(socket.name)
        if found is None or not found.enabled:
            continue
        if socket.unless is not None and _is_neutral(_constant(node.inputs.get(socket.unless[0])), socket.unless[1:]):
            continue
        if found.is_linked:
            notices.append(
                f"{owner}: the link into {node.bl_rna.name}'s {socket.name} is not followed; {socket.instead}"
            )
        elif socket.neutral and not _is_neutral(value := _constant(found), socket.neutral):
            notices.append(f"{owner}: {node.bl_rna.name}'s {socket.name}{_of(value)} is not shown; {socket.instead}")


def _of(value: Any) -> str:
    """A constant, as it stands in a sentence."""
    if isinstance(value, bool):
        return ""
    return f" of {value:.3g}" if isinstance(value, float) else f" of ({', '.join(f'{part:.3g}' for part in value)})"


def _constant(socket: Any) -> Any:
    value = socket.default_value
    return value if isinstance(value, (bool, int, float, str)) else tuple(round(part, 6) for part in value[:3])
