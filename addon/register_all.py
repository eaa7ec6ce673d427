# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that Blender is told about, and told to forget."""

from __future__ import annotations

import bpy

from . import engine, props


def register() -> None:
    props.register()
    bpy.utils.register_class(engine.SfumatoEngine)


def unregister() -> None:
    bpy.utils.unregister_class(engine.SfumatoEngine)
    props.unregister()
