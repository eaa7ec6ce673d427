# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist can ask for beyond settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy

from . import compositor, props
from .export import air

NAMES_TOLD = 30  # in a tooltip, a line each


class SfumatoSelectNamed(bpy.types.Operator):
    """Select the objects that a notice is about"""

    bl_idname = "sfumato.select_named"
    bl_label = "Select What Is Named"
    bl_options = {"REGISTER", "UNDO"}

    names: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # type: ignore[valid-type]  # a line each

    @classmethod
    def description(cls, _context: Any, properties: Any) -> str:
        names = properties.names.splitlines()
        more = len(names) - NAMES_TOLD
        listed = "\n".join(names[:NAMES_TOLD] + ([f"and {more} more"] if more > 0 else []))
        return f"Select these objects, in Object Mode:\n{listed}"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(context.mode == "OBJECT")

    def execute(self, context: Any) -> set[str]:
        for thing in context.selected_objects:
            thing.select_set(False)
        here = context.view_layer.objects
        found = [here[name] for name in self.names.splitlines() if name in here]
        for thing in found:
            thing.select_set(True)
        if found:
            here.active = found[0]
        missing = len(self.names.splitlines()) - len(found)
        if missing:
            self.report(
                {"WARNING"}, f"{missing} of them are not in this view layer: they come from instanced collections"
            )
        return {"FINISHED"} if found else {"CANCELLED"}


class SfumatoAddSmoke(bpy.types.Operator):
    """Have EEVEE or Cycles render this scene without its smoke, and Sfumato the smoke and its shadow, joined in the
    compositor.

    Makes a second scene of the same objects, and moves the smoke to a collection that only that one shows. Once more
    brings the second scene up to date: its camera, its frames, and objects that were added
    """

    bl_idname = "sfumato.add_smoke"
    bl_label = "Add Smoke to This Scene"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        scene = context.scene
        if scene.render.engine == "SFUMATO":
            self.report({"WARNING"}, "This scene is rendered by Sfumato, smoke and all: choose EEVEE or Cycles first")
            return {"CANCELLED"}
        if not compositor.smoke_objects(scene) and props.of(scene).smoke_scene is None:
            self.report({"WARNING"}, "The scene has no smoke: no gas domain and no Volume object")
            return {"CANCELLED"}
        other = compositor.add_smoke(scene, context.view_layer)
        self.report({"INFO"}, f"The smoke is in the scene '{other.name}' now, and over the picture of each render")
        return {"FINISHED"}


@dataclass(frozen=True)
class _Preset:
    label: str
    description: str
    values: dict[str, Any]


_EVEN = {"color": (1.0, 1.0, 1.0), "scale_height": 0.0}
AIRS = {
    "CLEAR": _Preset(
        "Clear Day",
        "Air at sea level, as one sees it over many kilometres: of Intel's sample Light Scattering (Yusov 2013)",
        {**_EVEN, "visibility": air.UNSEEN / 2e-5, "rayleigh": 1.0, "anisotropy": 0.98, "phase": "henyey-greenstein"},
    ),
    "HAZE": _Preset(
        "Haze",
        "Damp air in which one sees 5 km far, thinner with height",
        {**_EVEN, "visibility": 5e3, "rayleigh": 1.0, "anisotropy": 0.76, "phase": "cornette-shanks",
         "scale_height": 1200.0},
    ),
    "DUST": _Preset(
        "Dusty Room",
        "Air that shows the light of a window or a lamp in a room",
        {**_EVEN, "visibility": 100.0, "rayleigh": 0.0, "anisotropy": 0.6, "phase": "henyey-greenstein"},
    ),
}  # fmt: skip


class SfumatoSetAir(bpy.types.Operator):
    """Set what fills the world to one of these"""

    bl_idname = "sfumato.set_air"
    bl_label = "Presets"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Preset", items=tuple((name, each.label, each.description) for name, each in AIRS.items())
    )

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.scene.world is not None

    def execute(self, context: Any) -> set[str]:
        own = props.of_air(context.scene.world)
        for name, value in AIRS[self.preset].values.items():
            setattr(own, name, value)
        own.shown = True
        return {"FINISHED"}
