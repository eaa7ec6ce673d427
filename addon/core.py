# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads the native module, or explains why it cannot."""

from __future__ import annotations

import functools
import hashlib
import importlib
import importlib.machinery
import platform
import re
import sys
from pathlib import Path
from types import ModuleType

_HERE = Path(__file__).resolve().parent
_NATIVE = _HERE / "_native"
_AGAIN = "Remove the add-on, restart Blender and install its archive again (see the README)."
_FOR_THIS = "Install the archive that was made for this Blender, or build it with this Python (see the README)."


class Missing(RuntimeError):
    """The native module cannot be used; the message says why and what to do."""


def module() -> ModuleType:
    """The numeric module. Raises Missing where it cannot be used."""
    loaded = _load()
    if isinstance(loaded, str):
        raise Missing(loaded)
    return loaded


def problem() -> str:
    """Why the native module cannot be used, or nothing."""
    loaded = _load()
    return loaded if isinstance(loaded, str) else ""


def end_threads() -> None:
    """Those of the native module, if it was loaded."""
    loaded = sys.modules.get(f"{__package__}._native.sfumato")
    if loaded is not None and hasattr(loaded, "end_threads"):
        loaded.end_threads()


@functools.cache
def _load() -> ModuleType | str:
    """The module, or why it cannot be used. Asked once: a native module stays in its process until that ends."""
    if damage := _damage():
        return f"The native module is not loaded, since the add-on in {_HERE} is not whole: {damage}. {_AGAIN}"
    if stranger := _stranger():
        return f"The native module does not load: {stranger}. {_FOR_THIS}"
    try:
        native = importlib.import_module("._native.sfumato", __package__)
    except ImportError as error:
        return f"The native module does not load in {_host()}: {error}. {_FOR_THIS}"
    if getattr(native, "interface", "") != hashlib.sha256((_NATIVE / "sfumato.pyi").read_bytes()).hexdigest():
        return (
            f"The native module {native.__file__} is not of the same version as the add-on. After an update Blender "
            f"still has the old one until it is restarted: restart it. If that changes nothing: {_AGAIN}"
        )
    if foreign := native.library_problem():
        return f"The native module is not used, since its pictures would be wrong: {foreign}. {_AGAIN}"
    return native


def _host() -> str:
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    return f"Python {version} on {platform.system()} {platform.machine()}"


def _damage() -> str:
    """What is missing of the add-on or cut short, by the listing that an archive holds, or nothing."""
    listing = _HERE / "contents.txt"
    if not (_NATIVE / "sfumato.pyi").exists():
        return f"{_NATIVE / 'sfumato.pyi'} is not there"
    if not listing.exists():  # the add-on as it is built
        return ""
    for line in listing.read_text(encoding="utf-8").splitlines():
        size, _, name = line.partition(" ")
        path = _HERE / name
        if not path.exists():
            return f"{path} is not there"
        if path.stat().st_size != int(size):
            return f"{path} has {path.stat().st_size} bytes instead of {size}"
    return ""


def _stranger() -> str:
    """Which Pythons and machines the native modules are for that are there, if none of them is for this one."""
    suffixes = tuple(f"sfumato{suffix}" for suffix in importlib.machinery.EXTENSION_SUFFIXES)
    found = sorted(path.name for path in _NATIVE.glob("sfumato.*") if path.suffix in {".so", ".pyd"})
    if any(name in suffixes for name in found):
        return ""
    if not found:
        return f"there is none in {_NATIVE}"
    made_for = [
        f"Python {tag[1]}.{tag[2]} on {tag[3]}"
        if (tag := re.search(r"\.cp(?:ython-)?(\d)(\d+)-(.+)\.", name))
        else name
        for name in found
    ]
    return f"this is {_host()}, and those in {_NATIVE} are for {', '.join(made_for)}"
