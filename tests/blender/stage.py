# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that has one of everything, for the tests that set one property after another: what is said of it, and what it
looks like. For the tables of addon/export/known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import harness
from sfumato import log  # type: ignore[attr-defined]
from sfumato.export import scene as export
from sfumato.export.known import Struct, objects, scenes

TABLES: dict[str, Struct] = {table.name: table for table in (*scenes.STRUCTS, *objects.STRUCTS)}


def names_in(groups: dict[str, str]) -> list[str]:
    return [name for names in groups.values() for name in names.split()]


class Stage:
    """A small scene that has one of everything: what is said of it changes with one property at a time."""

    def __init__(self, lamp: str = "POINT") -> None:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        harness.enable()
        self.scene = bpy.context.scene
        render = self.scene.render
        render.engine, render.resolution_percentage = "SFUMATO", 100
        render.resolution_x = render.resolution_y = 8
        self.scene.sfumato.quality = "DRAFT"
        self.layer = bpy.context.view_layer
        self.collection = bpy.data.collections.new("Props")
        self.scene.collection.children.link(self.collection)
        self.scene.world = bpy.data.worlds.new("Sky")
        self.scene.world.use_nodes = True
        self.floor = self.add("Floor", self._square(4.0))
        self.floor_shader = harness.shade(self.floor.data, "ShaderNodeBsdfPrincipled")
        self.glow = self.add("Glow", self._square(0.2), (1.0, 1.0, 1.0))
        harness.shade(self.glow.data, "ShaderNodeEmission")
        self.lamp = self.add("Lamp", bpy.data.lights.new("Lamp", lamp), (0.5, -1.0, 3.0))
        self.lamp.data.energy = 5.0 if lamp == "SUN" else 500.0
        volume = bpy.data.volumes.new("Smoke")
        volume.filepath = str(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
        self.smoke = self.add("Smoke", volume, (0.0, 0.0, 0.2))
        self.smoke.scale = (1.2, 1.2, 1.2)
        self.smoke_shader = harness.shade(volume, "ShaderNodeVolumePrincipled", "Volume")
        self.camera = self.add("Camera", bpy.data.cameras.new("Camera"), (0.0, -4.0, 5.0))
        self.camera.rotation_euler = (0.7, 0.0, 0.0)
        self.scene.camera = self.camera

    def add(self, name: str, data: Any, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Any:
        thing = bpy.data.objects.new(name, data)
        thing.location = place
        self.collection.objects.link(thing)
        return thing

    def _square(self, half: float) -> bpy.types.Mesh:
        mesh = bpy.data.meshes.new("Square")
        corners = [(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)]
        mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
        return mesh

    def owners(self, root: str, kinds: tuple[str, ...]) -> Iterator[tuple[Any, str]]:
        """What a property of a root belongs to here, and its name in a notice; one of each kind."""
        layer_collection = self.layer.layer_collection.children[0]
        things = {
            "LIGHT": self.lamp,
            "GLOWING": self.glow,
            "DARK": self.floor,
            "MESH": self.floor,
            "VOLUME": self.smoke,
        }
        if root == "object":
            yield from ((things[kind], things[kind].name) for kind in kinds or ("MESH",) if kind in things)
            return
        yield {
            "scene": (self.scene, self.scene.name),
            "layer": (self.layer, f"View layer '{self.layer.name}'"),
            "layer_collection": (layer_collection, "Props"),
            "camera": (self.camera.data, "Camera"),
            "world": (self.scene.world, "World"),
            "material": (self.smoke.data.materials[0], "Smoke"),
            "light": (self.lamp.data, "Lamp"),
            "volume": (self.smoke.data, "Smoke"),
        }[root]

    def said(self) -> list[str]:
        """What a render has to say."""
        log.clear()
        bpy.ops.render.render()
        return log.notices()

    def exported(self) -> list[str]:
        """What the export has to say of a view."""
        self.layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return list(dict.fromkeys(export.export(depsgraph).notices))

    def not_heard_once(self, before: list[str], *words: str) -> str:
        """Empty if the export says one thing more than before, and that has all of the words."""
        new = [line for line in self.exported() if line not in before]
        right = len(new) == 1 and all(word in new[0] for word in words)
        return "" if right else f"{words}: {new}"
