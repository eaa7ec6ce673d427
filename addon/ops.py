# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist can ask for beyond settings."""

from __future__ import annotations

from typing import Any

import bpy

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
