# SPDX-License-Identifier: GPL-3.0-or-later
"""Sfumato: smoke, its light and its shadow, in the viewport and in the render.

The numeric module answers under this package's name: `import sfumato; sfumato.transmittance(...)`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
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


_HERE = Path(__file__).resolve().parent
switched_on = False


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


class _Console(ModuleType):
    """What `import sfumato` finds where the package has the longer name of an extension. Were it the package itself,
    Blender would take it for an older Sfumato of the shorter name when it is to switch that one on, and switch it off.
    """

    def __init__(self, package: ModuleType) -> None:
        super().__init__("sfumato", package.__doc__)
        self.package = package
        self.__file__, self.__path__ = package.__file__, package.__path__
        self.__time__ = (_HERE / "__init__.py").stat().st_mtime  # else Blender reads the file again, under this name

    def __dir__(self) -> list[str]:
        return dir(self.package)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and name != "__all__":  # such as Blender's own mark of what is switched on
            raise AttributeError(name)
        return getattr(self.package, name)

    def register(self) -> None:
        raise RuntimeError(_twice(_HERE))


def _twice(folder: Path) -> str:
    return (
        f"Sfumato is switched on already, the one in {folder}, and two at once would take each other's places. "
        "Remove one of them and restart Blender."
    )


def register() -> None:
    from . import register_all

    global switched_on
    other = sys.modules.get("sfumato")
    if other is not None and other is not sys.modules[__name__] and getattr(other, "switched_on", False):
        raise RuntimeError(_twice(Path(str(other.__file__)).parent))
    register_all.register()
    switched_on = True
    if __name__ != "sfumato":
        sys.modules["sfumato"] = _Console(sys.modules[__name__])


def unregister() -> None:
    from . import register_all

    global switched_on
    if not switched_on:
        return
    switched_on = False
    register_all.unregister()
    if isinstance(console := sys.modules.get("sfumato"), _Console) and console.package is sys.modules[__name__]:
        del sys.modules["sfumato"]
