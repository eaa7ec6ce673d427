# SPDX-License-Identifier: GPL-3.0-or-later
"""Sfumato: smoke, its light and its shadow, in the viewport and in the render.

The numeric module answers under this package's name: `import sfumato; sfumato.transmittance(...)`.
"""

from __future__ import annotations

import sys
from typing import Any

from . import core

bl_info = {
    "name": "Sfumato",
    "description": "Smoke that shadows itself and the scene, in the viewport and in renders",
    "author": "The Sfumato developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render engine menu, and the Sfumato tab of the 3D viewport's sidebar",
    "category": "Render",
}


def __dir__() -> list[str]:
    """What Python's console and help() list: the numeric module's names, and the package's own."""
    return sorted({*globals(), *_public_names()})


def _public_names() -> list[str]:
    return [] if core.problem() else [name for name in dir(core.module()) if not name.startswith("_")]


def __getattr__(name: str) -> Any:
    if name == "__all__" and (names := _public_names()):
        return names
    if name.startswith("__"):
        raise AttributeError(name)
    try:
        return getattr(core.module(), name)
    except core.Missing as error:  # the import system asks for attributes too, and knows only this exception
        raise AttributeError(f"sfumato.{name}: {error}") from error


def register() -> None:
    from . import register_all

    register_all.register()
    # An extension's package has a longer name; the console still says `import sfumato`.
    sys.modules.setdefault("sfumato", sys.modules[__name__])


def unregister() -> None:
    from . import register_all

    register_all.unregister()
    if sys.modules.get("sfumato") is sys.modules[__name__] and __name__ != "sfumato":
        del sys.modules["sfumato"]
