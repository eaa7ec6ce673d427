# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that Blender is told about, and told to forget."""

from __future__ import annotations

import bpy

from . import core, engine, frames, log, passes, props, ui
from .view import overlay


def register() -> None:
    props.register()
    passes.register()
    bpy.utils.register_class(engine.SfumatoEngine)
    ui.register()
    frames.register()
    if problem := core.problem():
        log.replace("start", [problem])
    if not bpy.app.background:
        overlay.enable()


def unregister() -> None:
    overlay.disable()
    frames.unregister()
    ui.unregister()
    bpy.utils.unregister_class(engine.SfumatoEngine)
    passes.unregister()
    props.unregister()
    log.clear()
    core.end_threads()
