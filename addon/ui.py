# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and preferences."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from . import core, log, ops, passes, props

ENGINE = "SFUMATO"
# Blender's own panels that make sense here are those of its plainest engine, and for lights, worlds and materials
# those of EEVEE, which has had three names.
EEVEE = {"BLENDER_EEVEE", "BLENDER_EEVEE_NEXT"}
EEVEE_CONTEXTS = {"data", "world", "material"}


def draw_wrapped(layout: Any, text: str, letters: int, icon: str) -> None:
    """A text over as many lines as it takes, with an icon at the first."""
    for index, part in enumerate(textwrap.wrap(text, letters)):
        layout.label(text=part, icon=icon if index == 0 else "BLANK1")


def draw_notices(layout: Any, width: int) -> None:
    """What cannot be shown and why, wrapped to `width` pixels."""
    lines = [problem] if (problem := core.problem()) else log.notices()
    for line in lines:
        draw_wrapped(layout.box().column(align=True), line, max(20, width // 8), "INFO")


class StagesPanel:
    """What the last frame did, and what that took: closed until somebody asks."""

    bl_label = "Stages"
    bl_options = {"DEFAULT_CLOSED"}
    layout: Any

    def draw(self, context: Any) -> None:
        column = self.layout.column(align=True)
        for name, seconds in log.stages().items():
            row = column.row()
            row.label(text=name.capitalize())
            row.label(text=f"{1e3 * seconds:.1f} ms")
        if not log.stages():
            column.label(text="Nothing was drawn yet")


class SfumatoViewportPanel(bpy.types.Panel):
    bl_idname = "SFUMATO_PT_viewport"
    bl_label = "Smoke"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sfumato"

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = props.of(context.scene)
        layout.prop(settings, "viewport_enabled")
        layout.prop(settings, "quality")
        layout.operator(ops.SfumatoHideOwnSmoke.bl_idname)
        if context.scene.render.engine != ENGINE:
            layout.operator(ops.SfumatoAddSmoke.bl_idname)
        draw_notices(layout, context.region.width)


class SfumatoViewportStagesPanel(StagesPanel, bpy.types.Panel):
    bl_idname = "SFUMATO_PT_viewport_stages"
    bl_parent_id = "SFUMATO_PT_viewport"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sfumato"


class SfumatoRenderPanel(bpy.types.Panel):
    bl_idname = "SFUMATO_PT_render"
    bl_label = "Smoke"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(context.engine == ENGINE)

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = props.of(context.scene)
        layout.prop(settings, "quality")
        layout.prop(settings, "viewport_enabled")
        layout.prop(settings, "missing_is_error")
        draw_notices(layout, context.region.width)


class SfumatoRenderStagesPanel(StagesPanel, bpy.types.Panel):
    bl_idname = "SFUMATO_PT_render_stages"
    bl_parent_id = "SFUMATO_PT_render"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}


class SfumatoPassesPanel(bpy.types.Panel):
    bl_idname = "SFUMATO_PT_passes"
    bl_label = "Passes"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "view_layer"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(context.engine == ENGINE)

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        view_layer = context.view_layer
        column = layout.column(heading="Smoke", align=True)
        column.prop(passes.of(view_layer), "smoke")
        column.prop(passes.of(view_layer), "smoke_shadow")
        column = layout.column(heading="Data", align=True)
        for each in passes.PASSES:
            if not each.own:
                column.prop(view_layer, each.switch)


class SfumatoPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, context: Any) -> None:
        problem = core.problem()
        if problem:
            draw_wrapped(self.layout, problem, 90, "ERROR")
        else:
            self.layout.label(text=f"Ready, using {core.module().instruction_set} instructions", icon="CHECKMARK")


CLASSES = (
    ops.SfumatoHideOwnSmoke,
    ops.SfumatoAddSmoke,
    SfumatoViewportPanel,
    SfumatoViewportStagesPanel,
    SfumatoRenderPanel,
    SfumatoRenderStagesPanel,
    SfumatoPassesPanel,
    SfumatoPreferences,
)


def borrowed_panels() -> list[Any]:
    """Blender's panels that our engine shows too."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ())
        or (EEVEE & set(getattr(panel, "COMPAT_ENGINES", ())) and getattr(panel, "bl_context", "") in EEVEE_CONTEXTS)
    ]


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for panel in borrowed_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    for panel in borrowed_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
