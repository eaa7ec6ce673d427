# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and preferences."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import blf
import bpy

from . import core, log, ops, passes, props
from .export import air
from .view import overlay, painter

ENGINE = "SFUMATO"
# Blender's own panels that make sense here are those of its plainest engine, and for lights, worlds and materials
# those of EEVEE, which has had three names.
EEVEE = {"BLENDER_EEVEE", "BLENDER_EEVEE_NEXT"}
EEVEE_CONTEXTS = {"data", "world", "material"}
FONT = 0  # Blender's own
# In pixels at a scale of 1: what of a region's width is not a label's text (the tabs or the scroll bar, the panel's
# margins, the icon), and a button beside it.
MARGINS, BUTTON = 78.0, 20.0


def lines_of(text: str, width: float) -> Iterator[str]:
    """A text, in lines that are at most so many pixels wide in the font of Blender's panels; only words that are wider,
    such as paths, are broken."""
    preferences = bpy.context.preferences
    blf.size(FONT, preferences.ui_styles[0].widget.points * preferences.system.ui_scale)
    line = ""
    for word in text.split():
        gap = " " if line else ""
        if line and blf.dimensions(FONT, line + gap + word)[0] > width:
            yield line
            line = gap = ""
        line += gap
        for letter in word:
            if line and blf.dimensions(FONT, line + letter)[0] > width:
                yield line
                line = ""
            line += letter
    yield line


def draw_wrapped(layout: Any, text: str, width: float, icon: str) -> None:
    """A text over as many lines as a region of `width` pixels makes of it, with an icon at the first."""
    column = layout.column(align=True)
    room = width - MARGINS * bpy.context.preferences.system.ui_scale
    for index, part in enumerate(lines_of(text, room)):
        column.label(text=part, icon=icon if index == 0 else "BLANK1")


def draw_notice(layout: Any, group: log.Group, width: float) -> None:
    """What is said of one thing or of many, whose names are told, and which are selected, on demand."""
    known = [name for name in group.names if name in bpy.data.objects]
    if not known:
        draw_wrapped(layout, str(group), width, "INFO")
        return
    row = layout.row(align=True)
    draw_wrapped(row, str(group), width - BUTTON * bpy.context.preferences.system.ui_scale, "INFO")
    select = row.operator(ops.SfumatoSelectNamed.bl_idname, text="", icon="RESTRICT_SELECT_OFF", emboss=False)
    select.names = "\n".join(known)


class NoticesPanel:
    """What is shown otherwise than Cycles would show it, where that matters in what is seen."""

    bl_label = "Shown Differently"
    layout: Any

    @staticmethod
    def sources(context: Any) -> tuple[str, ...]:
        raise NotImplementedError

    @classmethod
    def poll(cls, context: Any) -> bool:
        return not core.problem() and bool(log.notices(*cls.sources(context)))

    def draw(self, context: Any) -> None:
        column = self.layout.column()
        for group in log.grouped(tuple(log.notices(*self.sources(context)))):
            draw_notice(column, group, context.region.width)


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
        settings = props.of(context.scene)
        layout.prop(settings, "viewport_enabled")
        layout.prop(settings, "quality")
        layout.prop(settings, "sorting")
        if context.scene.render.engine == ENGINE:
            layout.prop(settings, "reflections")
            layout.prop(settings, "bounced_light")
        if way := painter.sorted_by():
            draw_wrapped(layout, f"While the view moves: {way}", context.region.width, "INFO")
        if context.scene.render.engine != ENGINE:
            layout.operator(ops.SfumatoAddSmoke.bl_idname)
        if problem := core.problem():
            draw_wrapped(layout, problem, context.region.width, "ERROR")


class SfumatoViewportNoticesPanel(NoticesPanel, bpy.types.Panel):
    bl_idname = "SFUMATO_PT_viewport_notices"
    bl_parent_id = "SFUMATO_PT_viewport"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sfumato"

    @staticmethod
    def sources(context: Any) -> tuple[str, ...]:
        """What the view shows: smoke over Blender's picture, ours alone, or neither."""
        shading = context.space_data.shading.type
        if shading == "RENDERED":
            return ("start", "view", "sorting") if context.engine == ENGINE else ("start",)
        drawn = shading in overlay.SHADING_TYPES and props.of(context.scene).viewport_enabled
        return ("start", "viewport", "sorting") if drawn else ("start",)


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
        settings = props.of(context.scene)
        named = layout.column()
        named.use_property_split = True  # which would leave no room for the names of switches
        named.prop(settings, "quality")
        layout.prop(settings, "viewport_enabled")
        layout.prop(settings, "missing_is_error")
        if problem := core.problem():
            draw_wrapped(layout, problem, context.region.width, "ERROR")


class SfumatoRenderNoticesPanel(NoticesPanel, bpy.types.Panel):
    bl_idname = "SFUMATO_PT_render_notices"
    bl_parent_id = "SFUMATO_PT_render"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @staticmethod
    def sources(_context: Any) -> tuple[str, ...]:
        return "start", "render", "passes", "frames", "view"


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


class SfumatoParticlesPanel(bpy.types.Panel):
    """In whatever engine: the smoke is over Solid mode in each."""

    bl_idname = "SFUMATO_PT_particles"
    bl_label = "Sfumato: Smoke Particles"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "particle"

    @classmethod
    def poll(cls, context: Any) -> bool:
        system = context.particle_system
        return system is not None and system.settings.type != "HAIR" and system.settings.render_type == "HALO"

    def draw_header(self, context: Any) -> None:
        self.layout.prop(props.of_particles(context.particle_system.settings), "shown", text="")

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        own = props.of_particles(context.particle_system.settings)
        layout.active = own.shown
        for name in ("size", "opacity", "color", "anisotropy"):
            layout.prop(own, name)


class SfumatoAirPanel(bpy.types.Panel):
    """In whatever engine, as that of particles."""

    bl_idname = "SFUMATO_PT_air"
    bl_label = "Sfumato: Air"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "world"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.scene.world is not None

    def draw_header(self, context: Any) -> None:
        self.layout.prop(props.of_air(context.scene.world), "shown", text="")

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        own = props.of_air(context.scene.world)
        has_own = air.has_volume(context.scene.world)
        if has_own:
            draw_wrapped(
                layout, "The world's own nodes have a volume, which is shown instead", context.region.width, "INFO"
            )
        column = layout.column()
        column.active = own.shown and not has_own
        column.operator_menu_enum(ops.SfumatoSetAir.bl_idname, "preset")
        for name in ("visibility", "color", "anisotropy", "phase", "rayleigh", "scale_height"):
            column.prop(own, name)
        ground = column.column()
        ground.active = own.scale_height > 0.0
        ground.prop(own, "ground")


class SfumatoShaftsPanel(bpy.types.Panel):
    """Of that of air, of which it says that it is no more what air does."""

    bl_idname = "SFUMATO_PT_shafts"
    bl_parent_id = "SFUMATO_PT_air"
    bl_label = "Art-Directed Shafts"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(props.of_air(context.scene.world), "directed", text="")

    def draw(self, context: Any) -> None:
        layout = self.layout
        layout.use_property_split = True
        own = props.of_air(context.scene.world)
        if own.directed:
            said = "Not as air does: what it scatters is multiplied, and what it takes of light is not"
            draw_wrapped(layout, said, context.region.width, "ERROR")
        column = layout.column()
        column.active = own.directed
        column.prop(own, "shaft_strength")
        column.prop(own, "shaft_color")


class SfumatoPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, context: Any) -> None:
        problem = core.problem()
        if problem:
            draw_wrapped(self.layout, problem, context.region.width, "ERROR")
        else:
            self.layout.label(text=f"Ready, using {core.module().instruction_set} instructions", icon="CHECKMARK")


CLASSES = (
    ops.SfumatoSelectNamed,
    ops.SfumatoAddSmoke,
    ops.SfumatoSetAir,
    SfumatoViewportPanel,
    SfumatoViewportNoticesPanel,
    SfumatoViewportStagesPanel,
    SfumatoRenderPanel,
    SfumatoRenderNoticesPanel,
    SfumatoRenderStagesPanel,
    SfumatoPassesPanel,
    SfumatoParticlesPanel,
    SfumatoAirPanel,
    SfumatoShaftsPanel,
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
