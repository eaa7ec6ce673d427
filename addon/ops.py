# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist can ask for beyond settings."""

from __future__ import annotations

from typing import Any

import bpy

from . import compositor, props
from .export import smoke

THINNEST = 0.001  # the smallest thickness that a domain can have in the viewport


class SfumatoHideOwnSmoke(bpy.types.Operator):
    """Make the smoke that Solid mode draws by itself invisible, so that it does not show through Sfumato's.

    Sets the viewport thickness of every gas domain to its minimum; renders do not read it
    """

    bl_idname = "sfumato.hide_own_smoke"
    bl_label = "Hide Blender's Own Smoke"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        domains = [settings for thing in context.scene.objects if (settings := smoke.domain_settings(thing))]
        for settings in domains:
            settings.display_thickness = THINNEST
        if not domains:
            self.report({"WARNING"}, "The scene has no gas domain")
        return {"FINISHED"} if domains else {"CANCELLED"}


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
